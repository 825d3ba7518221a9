"""Joint lists whose columns are swapped, unnamed or shared, and planes whose side need not be said: issue 40, A3, A5.

The planes are those of the same list written with its columns in order.
"""

import json
from pathlib import Path

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane, parse_plane
from slopekit.design.survey import JointList, read_joints

#: Dip and dip direction of 15 joints in three sets: five of them have directions up to 90, as dips have.
ROWS = [
    (76, 196),
    (68, 178),
    (74, 199),
    (76, 185),
    (68, 185),
    (60, 55),
    (67, 52),
    (54, 64),
    (53, 62),
    (63, 60),
    (69, 297),
    (67, 294),
    (60, 304),
    (65, 297),
    (71, 306),
]
PLANES = [Plane(float(dip), float(direction)) for dip, direction in ROWS]
SWAPPED = "".join(f"{direction},{dip}\n" for dip, direction in ROWS)


class Frame:
    """Columns by their names, as frames of pandas and polars have them."""

    def __init__(self, **columns: list[object]) -> None:
        self._columns = columns

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    def __getitem__(self, name: str) -> list[object]:
        return self._columns[name]


def written(folder: Path, content: str) -> Path:
    path = folder / "joints.csv"
    path.write_text(content, encoding="utf-8")
    return path


def planes(survey: JointList) -> list[Plane]:
    return [joint.plane for joint in survey.joints]


def refused(folder: Path, content: str, skip_bad: bool = False) -> DesignError:
    with pytest.raises(DesignError) as caught:
        read_joints(written(folder, content), skip_bad=skip_bad, option="--convention")
    return caught.value


# -- swapped columns ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("header", ["dip,dip_direction\n", ""])
def test_swapped_columns_are_said_once_and_never_skipped(header, tmp_path) -> None:
    (fault,) = refused(tmp_path, header + SWAPPED).faults
    assert fault.code == "E103"
    assert fault.message.startswith(
        "dip directions over 90 stand in the column dip: columns swapped? (10 of 15 rows"
    )
    assert fault.advice == "If so: --columns dip_direction,dip."
    assert fault.where.count("joints.csv:") == 3
    skipped = refused(tmp_path, header + SWAPPED, skip_bad=True)
    assert skipped.codes == ("E193", "E103")
    assert (
        skipped.faults[0].message
        == "10 of 15 rows of joints.csv are bad: more than a tenth is not skipped"
    )


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (
            "strike (RHR),dip\n" + "".join(f"{dip},{strike}\n" for dip, strike in ROWS),
            "strikes over 90 stand in",
        ),
        (
            "trend,plunge\n" + "".join(f"{dip},{trend}\n" for dip, trend in ROWS),
            "trends over 90 stand in",
        ),
        (
            "orientation\n" + "".join(f"{way}/{dip}\n" for dip, way in ROWS),
            "dip directions over 90 stand in front",
        ),
        (
            "clar\n" + "".join(f"{dip}/{way}\n" for dip, way in ROWS),
            "dip directions over 90 stand in the place of",
        ),
    ],
)
def test_other_notations_are_swapped_too(content, says, tmp_path) -> None:
    (fault,) = refused(tmp_path, content).faults
    assert (fault.code, fault.message.startswith(says)) == ("E103", True)
    assert "--columns" in fault.advice


def test_the_user_names_the_columns(tmp_path) -> None:
    for header in ("", "dip,dip_direction\n", "a,b\n"):
        path = written(tmp_path, header + SWAPPED)
        assert planes(read_joints(path, columns="dip_direction,dip")) == PLANES
        assert planes(read_joints(path, columns=["dip direction", "dip"])) == PLANES
    three = written(tmp_path, "".join(f"{way};{dip};rough\n" for dip, way in ROWS))
    survey = read_joints(three, columns="dd,dip")
    assert (planes(survey), survey.left_out) == (PLANES, ("column 3",))
    (fault,) = refused(tmp_path, "A;196;76\nB;178;68\n").faults
    assert fault.code == "E191"
    assert fault.advice.endswith(" Or --columns name,dip,dip_direction.")
    with pytest.raises(DesignError) as caught:
        read_joints(written(tmp_path, SWAPPED), columns="name,dd,dip")
    assert caught.value.codes == ("E191",)


def test_every_study_takes_the_names_of_columns(tmp_path) -> None:
    path = written(tmp_path, SWAPPED)
    right = sk.kinematic(ROWS, face="75/180", phi=30)
    assert (
        sk.kinematic(path, face="75/180", phi=30, columns="dip_direction,dip").counts
        == right.counts
    )
    assert len(sk.sets(path, columns="dip_direction,dip", n=3).sets) == 3
    pairs = sk.combos(
        path, face="75/180", c=0, phi=30, closed_form=True, columns="dip_direction,dip"
    )
    assert pairs.counts == sk.combos(ROWS, face="75/180", c=0, phi=30, closed_form=True).counts
    frame = Frame(dip=[way for _, way in ROWS], dip_direction=[dip for dip, _ in ROWS])
    with pytest.raises(DesignError) as caught:
        sk.kinematic(frame, face="75/180")
    assert caught.value.faults[0].advice == 'If so: columns = "dip_direction,dip".'
    assert (
        sk.kinematic(frame, face="75/180", phi=30, columns="dip_direction,dip").counts
        == right.counts
    )


@pytest.mark.parametrize("columns", ["[dip_direction, dip]", '"dip_direction,dip"'])
def test_a_design_names_the_columns(columns, tmp_path) -> None:
    written(tmp_path, SWAPPED)
    design = tmp_path / "wall.yaml"
    design.write_text(
        "slopekit: 1\nkind: wedge\nslope: {face: 65/205, upper: 10/205, height: 20}\nrock: {density: 2600}\n"
        f"joints: {{csv: joints.csv, pick: [J1, J7], columns: {columns}}}\nstrength: {{joint: {{c: 7, phi: 28}}}}\n",
        encoding="utf-8",
    )
    assert sk.load(design).joints == (PLANES[0], PLANES[6])


# -- no header ----------------------------------------------------------------------------------------------------


def test_without_a_header_the_order_is_not_guessed(tmp_path) -> None:
    (fault,) = refused(tmp_path, "45,60\n50,30\n").faults
    assert (fault.code, fault.message) == (
        "E191",
        "joints.csv has no header, and no number over 90 says which of its two columns is the dip",
    )
    assert fault.advice.endswith("--columns dip,dip_direction, or --columns dip_direction,dip.")
    assert planes(read_joints(written(tmp_path, "45,60\n50,130\n"))) == [
        Plane(45.0, 60.0),
        Plane(50.0, 130.0),
    ]


@pytest.mark.parametrize(
    "content",
    [
        "# dip_direction,dip\n55,60\n52,67\n",
        "#dip_direction;dip\n55;60\n52;67\n",
        "# by A. Miner\n# dip_direction dip\n55 60\n52 67\n",
        "* name, Dip direction, Dip\nA, 55, 60\nB, 52, 67\n",
        "#,dip_direction,dip\n1,55,60\n2,52,67\n",
    ],
)
def test_a_header_behind_a_mark_is_a_header(content, tmp_path) -> None:
    assert planes(read_joints(written(tmp_path, content))) == [Plane(60.0, 55.0), Plane(67.0, 52.0)]


def test_a_frame_with_a_header_behind_a_mark() -> None:
    """As pandas reads a file whose header begins so."""
    found = sk.kinematic(Frame(**{"# dip_direction": [55, 52], "dip": [60, 67]}), face="75/180")
    assert planes(JointList("", found.joints.joints)) == [Plane(60.0, 55.0), Plane(67.0, 52.0)]


# -- bad rows -----------------------------------------------------------------------------------------------------


def test_faults_of_one_kind_are_one(tmp_path) -> None:
    content = (
        "name,dip,dip_direction\n"
        + "".join(f"A{k},{k % 90},x{k}\n" for k in range(5000))
        + "B,45,400\n"
    )
    error = refused(tmp_path, content)
    assert error.codes == ("E104", "E102")
    assert error.faults[0].message.endswith(", and 4999 rows more like it")
    assert [part[:13] for part in error.faults[0].where.split("; ")] == [
        f"joints.csv:{k} " for k in (2, 3, 4)
    ]


def test_few_bad_rows_are_skipped_by_kind(tmp_path) -> None:
    good = "".join(f"G{k},{k},200\n" for k in range(60))
    bad = "".join(f"B{k},45,{400 + k}\n" for k in range(5))
    survey = read_joints(
        written(tmp_path, f"name,dip,dip_direction\n{bad}{good}X,45,east\n"), skip_bad=True
    )
    assert len(survey.joints) == 60
    assert survey.left_out == (
        "lines 2, 3, 4 and 2 more (E102 dip direction of B0 is 400, a direction lies between 0 and 360)",
        "line 67 (E104 X is '45/east', a plane is written dip/dip direction, for example 45/115)",
    )
    found = sk.kinematic(
        written(tmp_path, f"name,dip,dip_direction\n{bad}{good}"), face="65/180", skip_bad=True
    )
    assert found.line.endswith("  W366")
    assert "W366" in json.dumps(found.to_dict()["warnings"])


def test_a_tenth_of_the_rows_may_be_bad(tmp_path) -> None:
    nine = "dip,dip_direction\n" + "45,200\n" * 9
    assert len(read_joints(written(tmp_path, nine + "x,200\n"), skip_bad=True).joints) == 9
    assert refused(tmp_path, nine + "x,200\n,45\n", skip_bad=True).codes == ("E193", "E104", "E193")


# -- names and headings -------------------------------------------------------------------------------------------


def test_names_that_repeat_are_sets(tmp_path) -> None:
    content = "joint,dip,dip_direction\n" + "".join(
        f"K{k // 5},{dip},{way}\n" for k, (dip, way) in enumerate(ROWS)
    )
    survey = read_joints(written(tmp_path, content))
    assert planes(survey) == PLANES
    assert [joint.set_name for joint in survey.joints] == [f"K{k // 5}" for k in range(15)]
    assert survey.read_as == ("column joint is taken as the set: its names stand more than once",)


def test_a_name_that_stands_twice_gets_a_number(tmp_path) -> None:
    content = "name,dip,dip_direction\nA,45,115\nB,50,200\nC,45,245\nD,50,20\nA,60,100\n"
    survey = read_joints(written(tmp_path, content))
    assert [joint.name for joint in survey.joints] == ["A", "B", "C", "D", "A-2"]
    assert survey.read_as == ("1 name that stands more than once got a number behind it",)
    design = tmp_path / "wall.yaml"
    text = (
        "slopekit: 1\nkind: wedge\nslope: {face: 65/205, upper: 10/205, height: 20}\nrock: {density: 2600}\n"
        "joints: {csv: joints.csv, pick: [A, C]}\nstrength: {joint: {c: 7, phi: 28}}\n"
    )
    design.write_text(text, encoding="utf-8")
    with pytest.raises(DesignError) as caught:
        sk.load(design)
    assert caught.value.codes == ("E151",)
    design.write_text(text.replace("[A, C]", "[B, C]"), encoding="utf-8")
    assert sk.load(design).joints == (Plane(50.0, 200.0), Plane(45.0, 245.0))


def test_an_azimuth_is_said_to_be_read_as_the_dip_direction(tmp_path) -> None:
    path = written(tmp_path, "dip,Azimuth\n45,115\n60,245\n")
    assert read_joints(path).read_as == ("Azimuth is read as the dip direction",)
    assert "Azimuth is read as the dip direction" in str(sk.kinematic(path, face="65/180"))
    assert read_joints(written(tmp_path, "dip,dip_azimuth\n45,115\n")).read_as == ()


# -- planes whose side need not be said ---------------------------------------------------------------------------

NO_SIDE = [
    ("N-S", 90, "", "90/090"),
    ("E-W", 90, "", "90/180"),
    ("EW", 90, "", "90/180"),
    ("N", 90, "", "90/090"),
    ("000", 0, "", "0/090"),
    ("N30W", 90, "", "90/060"),
    ("NW-SE", 90, "", "90/045"),
    ("N40E", 50, "SE", "50/130"),
]


@pytest.mark.parametrize(
    "lines",
    [
        ["strike,dip,direction", *(f"{strike},{dip},{side}" for strike, dip, side, _ in NO_SIDE)],
        ["strike,dip", *(f"{strike},{dip}{side}" for strike, dip, side, _ in NO_SIDE)],
        ["strike/dip", *(f"{strike}/{dip}{side}" for strike, dip, side, _ in NO_SIDE)],
        [
            "strike;dip;direction",
            *(f"{strike};{dip},0;{side}" for strike, dip, side, _ in NO_SIDE[:-1]),
        ],
    ],
)
def test_vertical_and_horizontal_planes_need_no_side(lines, tmp_path) -> None:
    survey = read_joints(written(tmp_path, "\n".join(lines)))
    assert [str(plane) for plane in planes(survey)] == [plane for *_, plane in NO_SIDE][
        : len(lines) - 1
    ]


def test_a_horizontal_plane_needs_no_direction(tmp_path) -> None:
    assert planes(read_joints(written(tmp_path, "dip,dip_direction\n0,\n45,115\n"))) == [
        Plane(0.0, 0.0),
        Plane(45.0, 115.0),
    ]
    assert refused(tmp_path, "dip,dip_direction\n90,\n45,115\n").codes == ("E193",)
    error = refused(tmp_path, "strike,dip,direction\nN40E,50,SE\nN40E,50,\n")
    assert [fault.message for fault in error.faults] == [
        "J2 strikes N40E and dips 50: the side it dips to is not said",
    ]


def test_either_side_of_a_vertical_joint_is_the_same_joint() -> None:
    one, other = (
        sk.kinematic(
            [(90, way), (60, 150), (50, 210), (80, 20)], face="70/180", phi=30, lateral_toppling=40
        )
        for way in (30, 210)
    )
    assert one.counts == other.counts


@pytest.mark.parametrize(
    ("text", "meant"), [("N-S/90", "90/090"), ("N30W/90", "90/060"), ("E-W 0", "0/180")]
)
def test_a_command_line_answers_with_the_plane(text, meant) -> None:
    with pytest.raises(DesignError) as caught:
        parse_plane(text, "J1")
    assert caught.value.faults[0].advice.endswith(f"write {meant}.")


# -- overturned planes --------------------------------------------------------------------------------------------


def test_overturned_planes_are_read_where_they_are_certain(tmp_path) -> None:
    survey = read_joints(written(tmp_path, "dip,dip_direction\n95,030\n110,028\n85,205\n95,115\n"))
    assert [str(plane) for plane in planes(survey)] == ["85/210", "70/208", "85/205", "85/295"]
    assert survey.read_as == (
        "3 dips beyond 90° are of overturned planes: 95/030 is 85/210, 110/028 is 70/208, 95/115 is 85/295",
    )
    strikes = read_joints(written(tmp_path, "strike (RHR),dip\n030,95\n210,60\n"))
    assert [str(plane) for plane in planes(strikes)] == ["85/300", "60/300"]


def test_overturned_or_exchanged_is_not_guessed(tmp_path) -> None:
    """112/45 may be 68/225 or 45/112; a list that exchanges columns may write all its numbers with three digits."""
    error = refused(tmp_path, "dip,dip_direction\n112,45\n85,205\n")
    assert error.codes == ("E101",)
    assert (
        "is written 68/225; with dip and dip direction exchanged it is 45/112"
        in error.faults[0].advice
    )
    for swapped in ("178,068\n185,077\n", "196,076\n178,068\n", "110,062\n120,055\n"):
        assert set(refused(tmp_path, f"dip,dip_direction\n{swapped}").codes) == {"E103"}


@pytest.mark.parametrize(
    ("value", "code"), [("95/030", "E101"), ("95/30", "E103"), ((95, 30), "E103")]
)
def test_one_overturned_plane_is_answered_with_the_plane(value, code) -> None:
    with pytest.raises(DesignError) as caught:
        parse_plane(value, "J1")
    assert caught.value.codes == (code,)
    assert "is written 85/210" in caught.value.faults[0].advice
