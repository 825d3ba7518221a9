"""Lists of oriented core and of AGS 4, rows of units, degrees and minutes, single blanks."""

import math
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.app.surveys import read_joints_text
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Line, Plane
from slopekit.design.survey import JointList, read_frame, read_joints
from slopekit.design.survey.oriented_core import plane_on_core

FIRST, SECOND = Plane(45.0, 115.0), Plane(60.5, 245.0)


def survey_of(folder: Path, text: str, name: str = "joints.csv", sizes: bool = False) -> JointList:
    path = folder / name
    path.write_bytes(text.encode())
    return read_joints(path, sizes=sizes)


def planes_of(folder: Path, text: str, name: str = "joints.csv") -> list[Plane]:
    return [joint.plane for joint in survey_of(folder, text, name).joints]


def refusal(folder: Path, text: str, name: str = "joints.csv") -> tuple[str, str]:
    with pytest.raises(DesignError) as caught:
        survey_of(folder, text, name)
    return caught.value.codes[0], caught.value.faults[0].message


def measured_on_core(plane: Plane, hole: Line, is_from_bottom: bool) -> tuple[float, float]:
    """alpha and beta of a plane by vectors: the angle between line and plane, and the place of the lowest point.

    The ellipse is sampled: a point of the core's surface at each angle, pushed along the axis into the plane.
    """
    axis, normal = hole.vector(), plane.normal()
    alpha = math.degrees(math.asin(abs(float(axis @ normal))))
    bottom = np.array([0.0, 0.0, -1.0]) + axis * axis[2]
    start = bottom if is_from_bottom else -bottom
    start /= np.linalg.norm(start)
    right = np.cross(axis, start)  # clockwise of it, as one looks down the hole
    angles = np.arange(0.0, 360.0, 0.01)
    around = np.radians(angles)[:, None]
    surface = np.cos(around) * start + np.sin(around) * right
    down_hole = -(surface @ normal) / float(axis @ normal)
    return alpha, float(angles[int(np.argmax(down_hole))])


# -- oriented core -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_from_bottom", [True, False])
@pytest.mark.parametrize(
    "hole", [Line(140.0, 60.0), Line(213.0, 85.0), Line(20.0, 0.0), Line(305.0, 35.0)], ids=str
)
@pytest.mark.parametrize(
    "plane", [Plane(45.0, 115.0), Plane(78.0, 20.0), Plane(10.0, 300.0)], ids=str
)
def test_planes_come_back_from_their_angles_on_core(plane, hole, is_from_bottom) -> None:
    """Measured on a sampled ellipse, to the 0.01° of its samples."""
    found = plane_on_core(*measured_on_core(plane, hole, is_from_bottom), hole, is_from_bottom)
    assert abs(float(found.normal() @ plane.normal())) == pytest.approx(1.0, abs=1e-7)


def test_a_worked_example_by_vectors() -> None:
    """A hole that plunges 60° to the north, alpha 30, beta 0 from the bottom.

    The axis is (0, cos 60, -sin 60), the bottom of the core (0, -sin 60, -cos 60). The ellipse's lower end lies on the
    bottom: its long axis is a cos 30 + b sin 30 = (0, 0, -1). The joint is vertical and strikes across the hole. From
    the top the long axis is (0, sin 60, -cos 60): a plane that dips 30° to the north.
    """
    hole = Line(0.0, 60.0)
    vertical = plane_on_core(30.0, 0.0, hole, is_from_bottom=True)
    assert vertical.dip_deg == pytest.approx(90.0)
    assert vertical.dip_direction_deg % 180.0 == pytest.approx(0.0)
    flatter = plane_on_core(30.0, 0.0, hole, is_from_bottom=False)
    assert (flatter.dip_deg, flatter.dip_direction_deg) == pytest.approx((30.0, 0.0))


def test_rows_as_the_package_drillcore_transformations_reads_them(tmp_path) -> None:
    """drillcore-transformations 0.3.0: calc_global_normal_vector(alpha, beta - 180, trend, -plunge), bottom line."""
    rows = (
        "BH1,12.0,58,315,140,60,bottom\nBH1,18.0,15,167,140,60,bottom\nBH2,3,14,42,213,85,bottom\n"
    )
    survey = survey_of(tmp_path, "hole,depth,alpha,beta,trend,plunge,reference\n" + rows)
    found = [
        angle
        for joint in survey.joints
        for angle in (joint.plane.dip_deg, joint.plane.dip_direction_deg)
    ]
    expected = [56.833325, 293.407797, 45.994416, 122.416729, 79.737636, 74.285386]
    assert found == pytest.approx(expected, abs=1e-4)
    assert "clockwise, looking down the hole, from the reference line" in survey.read_as[0]


def test_top_and_bottom_differ_by_half_a_turn(tmp_path) -> None:
    bottom = planes_of(tmp_path, "alpha,beta (bottom),trend,plunge\n58,315,140,60\n")
    top = planes_of(tmp_path, "alpha,beta_top,hole_trend,hole_plunge\n58,135,140,60\n")
    drillers = planes_of(tmp_path, "alpha,beta,reference,azimuth,dip\n58,315,BOH,140,-60\n")
    assert top == drillers == bottom


def test_a_joint_square_to_the_core_has_no_beta(tmp_path) -> None:
    (plane,) = planes_of(tmp_path, "alpha,beta,trend,plunge,reference\n90,,140,60,top\n")
    assert (plane.dip_deg, plane.dip_direction_deg) == pytest.approx((30.0, 320.0))


def test_the_nearest_survey_station_counts(tmp_path) -> None:
    header = "hole,depth,alpha,beta,trend,plunge,reference\n"
    stations = "A,0,,,140,60,\nA,30,,,150,50,\nB,14,,,20,40,\n"
    survey = survey_of(
        tmp_path,
        header + stations + "A,14,58,315,,,bottom\nA,16,58,315,,,bottom\nB,40,58,315,,,bottom\n",
    )
    expected = [
        plane_on_core(58, 315, hole, True) for hole in (Line(140, 60), Line(150, 50), Line(20, 40))
    ]
    for joint, plane in zip(survey.joints, expected, strict=True):
        assert float(joint.plane.normal() @ plane.normal()) == pytest.approx(1.0, abs=1e-10)
    assert survey.read_as[-1].endswith(
        "nearest of 3 survey stations, at most 26 m away along the hole"
    )
    code, message = refusal(tmp_path, header + stations + "C,14,58,315,,,bottom\n")
    assert (code, message) == ("E193", "J1 has no hole trend and no hole plunge")


NO_PLANES = [
    (
        "E191",
        "hole,depth,trend,plunge\nBH1,1,140,60\n",
        "may be those of the hole (column hole) or of poles",
    ),
    (
        "E191",
        "depth,trend,plunge\n1,140,60\n",
        "may be those of the hole (column depth) or of poles",
    ),
    ("E191", "alpha,trend,plunge\n50,140,60\n", "no column for beta: core that is not oriented"),
    ("E191", "alpha,beta,reference\n50,20,top\n", "no column for trend and plunge of the hole"),
    (
        "E191",
        "alpha,beta,azimuth,dip,reference\n50,20,140,60,top\n",
        "azimuth and dip of joints.csv may be those of the hole",
    ),
    (
        "E191",
        "alpha,beta,hole_azimuth,hole_dip,ref\n50,20,140,60,top\n50,20,140,-60,top\n",
        "negative in 1 of 2 rows",
    ),
    ("E192", "alpha,beta,trend,plunge\n50,20,140,60\n", "beta has two meanings"),
    (
        "E192",
        "alpha,beta,trend,plunge,reference\n50,20,140,60,left\n",
        "it is the bottom or the top of the core",
    ),
    ("E193", "alpha,beta,trend,plunge,reference\n50,20,140,60,\n", "has no reference"),
    ("E101", "alpha,beta,trend,plunge,reference\n95,20,140,60,top\n", "alpha of J1 is 95"),
    ("E102", "alpha,beta,trend,plunge,reference\n50,400,140,60,top\n", "beta of J1 is 400"),
    ("E101", "alpha,beta,trend,plunge,reference\n50,20,140,-60,top\n", "hole plunge of J1 is -60"),
    ("E101", "alpha,beta,trend,plunge,reference\n50,20,140,90,top\n", "the hole of J1 is vertical"),
    (
        "E113",
        "alpha,beta,trend,plunge,reference\n0.5,2.5,140,60,top\n0.6,2.1,140,60,top\n",
        "looks like radians",
    ),
]


@pytest.mark.parametrize(
    ("code", "text", "says"), NO_PLANES, ids=[says[:30] for _code, _text, says in NO_PLANES]
)
def test_lists_of_core_that_give_no_planes(code, text, says, tmp_path) -> None:
    found, message = refusal(tmp_path, text)
    assert found == code
    assert says in message


def test_poles_beside_a_hole_are_named_so(tmp_path) -> None:
    assert planes_of(tmp_path, "hole,depth,pole_trend,pole_plunge\nBH1,1,140,60\n") == [
        Plane(30.0, 320.0)
    ]
    given = planes_of(
        tmp_path, "hole,alpha,beta,trend,plunge,dip,dip_direction\nBH1,50,20,140,60,45,115\n"
    )
    assert given == [FIRST]


def test_depths_in_several_holes_are_no_positions_along_one_line(tmp_path) -> None:
    rows = "hole,depth,dip,dip_direction\nA,1,45,115\n{},3,60.5,245\n"
    assert [
        joint.position_m for joint in survey_of(tmp_path, rows.format("A"), sizes=True).joints
    ] == [1.0, 3.0]
    several = survey_of(tmp_path, rows.format("B"), sizes=True)
    assert [joint.position_m for joint in several.joints] == [None, None]
    assert "column depth (it runs along 2 holes)" in several.left_out


def test_core_in_commands_frames_and_the_app(tmp_path) -> None:
    text = "alpha,beta,trend,plunge,reference\n58,315,140,60,bottom\n15,167,140,60,bottom\n"
    planes = planes_of(tmp_path, text)
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(tmp_path / "joints.csv")
    assert [joint.plane for joint in read_frame(frame).joints] == planes
    assert [joint.plane for joint in read_joints_text("joints.csv", text).joints] == planes
    kinematic = sk.kinematic(tmp_path / "joints.csv", face="75/180", phi=30)
    assert [joint.plane for joint in kinematic.joints.joints] == planes
    assert any(
        notice.code == "W373" and "oriented core" in notice.message for notice in kinematic.warnings
    )


# -- AGS 4 ---------------------------------------------------------------------------------------------------------

PROJECT = '"GROUP","PROJ"\r\n"HEADING","PROJ_ID"\r\n"UNIT",""\r\n"TYPE","ID"\r\n"DATA","1"\r\n\r\n'
DISC = (
    '"GROUP","DISC"\r\n"HEADING","LOCA_ID","DISC_TOP","FRAC_SET","DISC_NUMB","DISC_DIP","DISC_DIR","DISC_PERS","DISC_REM"'
    '\r\n"UNIT","","m","","","deg","deg","mm",""\r\n"TYPE","ID","2DP","X","X","0DP","0DP","1DP","X"\r\n'
)
ROWS = (
    '"DATA","F1","1.20","J1","1","45","115","2500","says ""open"", wet"\r\n'
    '"DATA","F1","3.20","J2","2","60.5","245","",""\r\n'
    '"DATA","F1","4.20","J2","3","40","","",""\r\n'
    '"DATA","F1","5.00","J3","4","0","","",""\r\n'
)


def test_the_group_of_discontinuities_is_read(tmp_path) -> None:
    survey = survey_of(tmp_path, PROJECT + DISC + ROWS, "survey.ags", sizes=True)
    assert [joint.plane for joint in survey.joints] == [FIRST, SECOND, Plane(0.0, 0.0)]
    assert [joint.set_name for joint in survey.joints] == ["J1", "J2", "J3"]
    assert [joint.name for joint in survey.joints] == ["1", "2", "4"]
    assert survey.joints[0].trace_m == 2.5
    assert survey.joints[1].position_m == 3.2
    assert survey.left_out[:2] == ("group PROJ", "1 row without dip or dip direction (line 13)")
    found = sk.sets(tmp_path / "survey.ags")
    assert len(found.joints) == 3


def test_rows_that_lost_the_word_data_or_their_quotes(tmp_path) -> None:
    bare = (DISC + ROWS).replace('"DATA",', "")
    survey = survey_of(tmp_path, PROJECT + bare, "survey.ags")
    assert [joint.plane for joint in survey.joints] == [FIRST, SECOND, Plane(0.0, 0.0)]
    assert survey.read_as[0] == "4 rows of DISC without the word DATA are taken for data"
    headings = "GROUP,DISC,,,\nHEADING,LOCA_ID,DISC_DIP,DISC_DIR,FRAC_SET\nUNIT,,deg,deg,\n"
    excel = headings + "DATA,F1,45,115,1\nDATA,F1,60.5,245,2\n"
    assert planes_of(tmp_path, excel) == [FIRST, SECOND]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (PROJECT, "has no column for dip and dip direction"),
        ('"**PROJ"\n"*PROJ_ID"\n"1"\n', "is a file of AGS 3"),
        (
            DISC + ROWS + DISC.replace("FRAC_SET", "DISC_SET") + ROWS,
            "two groups DISC whose headings differ",
        ),
        (DISC.replace('"deg"', '"rad"') + ROWS, "is in rad, an orientation is in degrees"),
    ],
)
def test_ags_that_holds_no_planes(text, says, tmp_path) -> None:
    code, message = refusal(tmp_path, text, "survey.ags")
    assert code == "E191"
    assert says in message


def test_a_list_whose_column_of_sets_is_called_group_is_no_ags(tmp_path) -> None:
    assert planes_of(tmp_path, "GROUP,dip,dd\nA,45,115\n") == [FIRST]


# -- units, minutes, blanks ----------------------------------------------------------------------------------------


def test_a_row_of_units_is_heeded(tmp_path) -> None:
    text = "id,Dip,Dip Direction,trace,c\n-,deg,deg,mm,MPa\nA,45,115,2500,0.05\nB,60.5,245,,\n"
    survey = survey_of(tmp_path, text, sizes=True)
    assert [joint.plane for joint in survey.joints] == [FIRST, SECOND]
    assert (survey.joints[0].trace_m, survey.joints[0].cohesion_kpa) == (2.5, 50.0)
    assert survey.read_as == ("line 2 holds units",)


@pytest.mark.parametrize("unit", ["rad", "gon", "grads"])
def test_other_units_of_orientations_are_refused(unit, tmp_path) -> None:
    code, message = refusal(tmp_path, f"dip,dip_direction\n{unit},{unit}\n45,115\n")
    assert code == "E191"
    assert f"is in {unit}, an orientation is in degrees" in message


def test_a_unit_that_contradicts_its_heading_is_refused(tmp_path) -> None:
    code, message = refusal(tmp_path, "dip,dd,c (kPa)\ndeg,deg,MPa\n45,115,2\n")
    assert code == "E191"
    assert message == "the column c (kPa) is in MPa by the row of units"


def test_grad_is_degrees_in_german_only(tmp_path) -> None:
    assert planes_of(tmp_path, "Fallwinkel [Grad];Fallrichtung [Grad]\n45;115\n") == [FIRST]
    assert refusal(tmp_path, "dip (grad),dip direction (grad)\n45,115\n")[0] == "E191"


@pytest.mark.parametrize(
    "text",
    [
        "dip,dip_direction\n45°0',115°\n60°30',245° 0' 0\"\n",
        "plane\n45°0'/115\n60°30′/245°00′\n",
        "45° 0' 115°0'\n60°30' 245°0'\n",
        "strike,dip\nN25°0'E,45°0'SE\nN25°0'W,60°30'SW\n",
        "pole_trend,pole_plunge\n295°0',45\n65,29°30'\n",
    ],
)
def test_degrees_and_minutes(text, tmp_path) -> None:
    assert planes_of(tmp_path, text) == [FIRST, SECOND]


def test_degrees_and_minutes_in_every_plane_and_angle() -> None:
    wedge = sk.wedge(dips=("45°30'/115", "45/245°15'"), phi="20°30'")
    same = sk.wedge(dips=("45.5/115", "45/245.25"), phi=20.5)
    assert wedge.fos.limit == same.fos.limit


@pytest.mark.parametrize(
    "text",
    [
        "dip dip_direction\n45 115\n60.5 245\n",
        "Dip Dip Direction\n45 115\n60.5 245\n",
        "Name Dip (deg) Dip Direction (deg)\nA 45 115\nB 60.5 245\n",
        "Dip Dip Direction\ndeg deg\n45 115\n60.5 245\n",
        "45 115\n60.5 245\n",
    ],
)
def test_single_blanks_between_columns(text, tmp_path) -> None:
    assert planes_of(tmp_path, text) == [FIRST, SECOND]


def test_a_row_with_a_value_too_few_between_blanks_is_no_shifted_row(tmp_path) -> None:
    assert refusal(tmp_path, "name dip dip_direction\nA 45 115\n60.5 245\n")[0] == "E193"
