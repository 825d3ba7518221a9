"""Joint lists of other programs and notations: each a file written for these tests, its planes worked by hand.

All but a few hold the planes 45/115 and 60.5/245. Quadrants and poles are also compared with mplstereonet.
"""

import random
import sys
import warnings
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane, parse_plane, parse_quadrants
from slopekit.design.joint_lists import joint_list
from slopekit.design.survey import JointList, read_joints

HERE = Path(__file__).parent / "joint_lists"
NO_QUADRANTS = (
    "N25E/45NE",
    "N95E/45SE",
    "N25E/95SE",
    "N25E/45",
    "E25N/45S",
    "45/115",
    "NE/45SE",
    "",
)
FIRST, SECOND = Plane(45.0, 115.0), Plane(60.5, 245.0)


@pytest.fixture(scope="module")
def mplstereonet():
    """An independent program; its import warns of what matplotlib will do away with."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("mplstereonet")


def planes(survey: JointList) -> list[Plane]:
    return [joint.plane for joint in survey.joints]


def refused(path: Path, convention: str | None = None, option: str = "--convention") -> DesignError:
    with pytest.raises(DesignError) as caught:
        read_joints(path, convention, option=option)
    return caught.value


def written(folder: Path, content: str) -> Path:
    path = folder / "joints.csv"
    path.write_text(content, encoding="utf-8")
    return path


def test_quadrants_beside_dip_and_direction_in_one_column(tmp_path) -> None:
    """Each word by itself: east of north toward the south-east, west of north toward the south-west."""
    found = read_joints(written(tmp_path, "orientation\nN25E/45SE\n45/115\nN30W/60SW\n"))
    assert planes(found) == [Plane(45.0, 115.0), Plane(45.0, 115.0), Plane(60.0, 240.0)]


# -- Dips -------------------------------------------------------------------------------------------------------------


def test_a_text_of_dips_with_its_preamble() -> None:
    survey = read_joints(HERE / "dips.txt")
    # strike by the right hand, turned back by 7.5° of declination
    assert planes(survey) == [Plane(45.0, 107.5), Plane(60.5, 237.5), Plane(80.0, 22.5)]
    assert [joint.quantity for joint in survey.joints] == [3.0, 1.0, 2.0]
    assert survey.left_out == (
        "column Traverse",
        "column ROUGHNESS",
        "lines 2 to 8 (above the columns)",
        "2 traverses (no joint is weighted by them)",
        "line 14 (quantity 0)",
    )
    assert survey.read_as == (
        "strikes are right-hand-rule, as the preamble says",
        "a declination of -7.5° is added to all azimuths",
    )


def test_a_text_of_dips_without_names_of_columns() -> None:
    survey = read_joints(HERE / "dips-bare.txt")
    assert planes(survey) == [FIRST, SECOND]
    assert [joint.quantity for joint in survey.joints] == [2.0, 1.0]
    assert survey.left_out == ("column 4", "lines 1 to 7 (above the columns)")
    assert survey.read_as == (
        "trend and plunge are of poles: dip = 90 - plunge, dip direction = trend + 180",
    )


def test_a_format_that_leaves_the_convention_open(tmp_path) -> None:
    path = written(tmp_path, "Wall 4\nSTRIKE/DIP\n25 45\n155 60.5\n")
    assert refused(path).codes == ("E192",)
    assert planes(read_joints(path, "RHR")) == [FIRST, SECOND]
    path = written(tmp_path, "Wall 4\nDIP/DIPDIRECTION\n45,115\n60.5,245\n")
    assert planes(read_joints(path)) == [FIRST, SECOND]


def test_two_formats_in_one_list_are_refused(tmp_path) -> None:
    error = refused(HERE / "dips-mixed.txt")
    assert error.codes == ("E192",)
    assert "STRIKE/DIPR and DIP/DIPDIRECTION" in error.faults[0].message
    core = written(
        tmp_path, "Traverse 1: oriented core\nDIP/DIPDIRECTION\ndip\tdip direction\n45\t115\n"
    )
    assert "alpha and beta on core" in refused(core).faults[0].message


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["STRIKE(Left)/DIP", "7 (Declination)"], (("strike", "dip"), "left-hand-rule", 7.0)),
        (["Strike / Dip"], (("strike", "dip"), None, 0.0)),
        (["Dip / Dip Direction", "declination = 2,5"], (("dip", "dip_direction"), None, 2.5)),
        (["Survey of 12 May", "45 joints"], ((), None, 0.0)),
    ],
)
def test_what_a_preamble_says(lines, expected) -> None:
    from slopekit.design.survey.columns import preamble_of

    found = preamble_of(lines)
    assert (found.columns, found.convention, found.declination_deg) == expected


def test_a_list_and_its_user_may_not_contradict_each_other(tmp_path) -> None:
    for header in ("strike (RHR)", "Strike (right)", "strike_rhr"):
        path = written(tmp_path, f"{header},dip\n25,45\n")
        assert planes(read_joints(path)) == [FIRST]
        assert planes(read_joints(path, "RHR")) == [FIRST]
        error = refused(path, "lhr")
        assert error.codes == ("E192",)
        assert (
            error.faults[0].message
            == "strikes are right-hand-rule by joints.csv, left-hand-rule by --convention"
        )


# -- quantities -------------------------------------------------------------------------------------------------------


def test_quantities_weigh_percentages_as_that_many_joints_do(tmp_path) -> None:
    """A list with quantities against the list in which each row stands as often: identical joints meet in no line."""
    rows = [(40, 175, 3), (35, 90, 1), (75, 10, 2), (50, 230, 4), (55, 130, 1), (70, 5, 2)]
    content = "dip,dd,Quantity\n" + "".join(f"{dip},{dd},{n}\n" for dip, dd, n in rows)
    found = sk.kinematic(written(tmp_path, content), face="65/180", phi=30)
    repeated = sk.kinematic(
        [(dip, dd) for dip, dd, n in rows for _ in range(n)], face="65/180", phi=30
    )
    once = sk.kinematic([(dip, dd) for dip, dd, _ in rows], face="65/180", phi=30)
    assert found.percent == pytest.approx(repeated.percent, rel=1e-13)
    assert found.counts == once.counts
    assert found.percent["planar"] == pytest.approx(100.0 * 3 / 13)
    assert found.percent["planar"] != once.percent["planar"]
    assert found.input_hash() != once.input_hash()
    document = found.to_dict()
    assert document["survey"]["quantity"] == 13.0
    assert [notice["code"] for notice in document["warnings"]] == ["W373"]
    assert "1 of 6 (23.1 % by quantity) joints slide within the lateral limit" in str(found)


def test_pairs_stand_once_and_it_is_said(tmp_path) -> None:
    plain = "dip,dd\n45,115\n45,245\n50,240\n"
    weighed = (
        plain.replace("dd\n", "dd,Anzahl\n").replace("115\n", "115,4\n").replace("245\n", "245,2\n")
    )
    found = sk.combos(written(tmp_path, weighed), face="65/180", c=10, phi=30)
    assert [notice.code for notice in found.warnings if notice.code == "W373"] == ["W373"]
    assert "3 joints, 7 by quantity" in found.warnings[-1].message
    assert found.counts == sk.combos(written(tmp_path, plain), face="65/180", c=10, phi=30).counts


@pytest.mark.parametrize("quantity", ["-1", "many", "3°", "inf"])
def test_quantities_that_are_none(quantity, tmp_path) -> None:
    error = refused(written(tmp_path, f"dip,dd,Quantity\n45,115,{quantity}\n"))
    assert error.codes == ("E193",)


def test_quantity_goes_before_weight(tmp_path) -> None:
    survey = read_joints(written(tmp_path, "dip,dd,Weight,Quantity\n45,115,1.7,2\n60.5,245,1.2,\n"))
    assert [joint.quantity for joint in survey.joints] == [2.0, 1.0]
    assert survey.left_out == ("column Weight",)


# -- notations --------------------------------------------------------------------------------------------------------


def test_poles_as_trend_and_plunge(mplstereonet) -> None:
    survey = read_joints(HERE / "poles.csv")
    assert planes(survey) == [FIRST, SECOND, Plane(90.0, 0.0), Plane(0.0, 190.0)]
    for joint, (trend, plunge) in zip(
        survey.joints, [(295, 45), (65, 29.5), (180, 0)], strict=False
    ):
        strike, dip = (float(angle[0]) for angle in mplstereonet.plunge_bearing2pole(plunge, trend))
        assert joint.plane.normal() == pytest.approx(
            Plane(dip, (strike + 90.0) % 360.0).normal(), abs=1e-12
        )
    assert survey.read_as == (
        "trend and plunge are of poles: dip = 90 - plunge, dip direction = trend + 180",
    )


def test_studies_say_how_a_list_was_read() -> None:
    for found in (
        sk.kinematic(HERE / "poles.csv", face="65/180", phi=30),
        sk.combos(HERE / "poles.csv", face="65/180", c=5, phi=30, top=1),
    ):
        said = [notice.message for notice in found.warnings if notice.code == "W373"]
        assert said == [f"read of poles.csv: {part}" for part in found.joints.read_as]


def test_poles_that_point_up(tmp_path) -> None:
    path = written(tmp_path, "trend,plunge\n295,-45\n295,95\n400,45\n")
    assert refused(path).codes == ("E101", "E101", "E102")


def test_quadrants_and_sides() -> None:
    survey = read_joints(HERE / "quadrants.csv")
    expected = [FIRST, SECOND, Plane(45.0, 295.0), Plane(30.0, 80.0), FIRST, Plane(70.0, 180.0)]
    assert planes(survey) == expected
    assert survey.left_out == ("column remark",)
    assert planes(read_joints(HERE / "sides.csv")) == [FIRST, SECOND, FIRST]


@pytest.mark.filterwarnings("ignore:Arrays of 2-dimensional vectors:DeprecationWarning")
@given(
    st.sampled_from("NS"),
    st.integers(1, 89),
    st.sampled_from("EW"),
    st.integers(1, 89),
    st.sampled_from(["N", "E", "S", "W"]),
)
def test_quadrants_are_those_of_mplstereonet(mplstereonet, end, angle, turn, dip, side) -> None:
    plane = parse_quadrants(f"{end}{angle}{turn}/{dip}{side}")
    strike, steep = mplstereonet.parse_strike_dip(f"{end}{angle}{turn}", f"{dip}{side}")
    assert plane is not None
    assert plane.normal() == pytest.approx(Plane(steep, (strike + 90.0) % 360.0).normal(), abs=1e-9)


@pytest.mark.parametrize("text", NO_QUADRANTS)
def test_words_that_are_no_quadrants(text) -> None:
    assert parse_quadrants(text) is None


def test_a_strike_whose_dip_has_no_side(tmp_path) -> None:
    assert planes(read_joints(written(tmp_path, "strike,dip\n25,45SE\nN25W,60.5SW\n"))) == [
        FIRST,
        SECOND,
    ]
    error = refused(
        written(tmp_path, "strike,dip\nN25E,45SE\nN25E,45\nN25E,45N\nN25E,45NE\n"), "rhr"
    )
    assert error.codes == ("E104", "E104")
    assert "is not said" in error.faults[0].message
    assert "does not lie beside the strike" in error.faults[1].message
    error = refused(written(tmp_path, "strike,dip\n25,45\n"))
    assert error.codes == ("E192",)
    advice = "Say --convention right-hand-rule (RHR: dip direction = strike + 90) or left-hand-rule (LHR: strike - 90)."
    assert error.faults[0].advice == advice


def test_strikes_in_one_column_need_a_convention(tmp_path) -> None:
    path = written(tmp_path, "strike/dip\n025/45\n155/60.5\n")
    assert refused(path).codes == ("E192", "E192")
    assert planes(read_joints(path, "RHR")) == [FIRST, SECOND]
    assert planes(read_joints(path, "LHR")) == [Plane(45.0, 295.0), Plane(60.5, 65.0)]


def test_planes_in_one_column(tmp_path) -> None:
    path = written(tmp_path, "name;Orientation\nA;45/115\nB;N25W/60,5SW\nC;60,5 / 245\n")
    error = refused(path)  # a comma in a quadrant is none of decimals
    assert error.codes == ("E104",)
    path.write_text(path.read_text(encoding="utf-8") + "D;45/115\n" * 7, encoding="utf-8")
    assert planes(read_joints(path, skip_bad=True)) == [FIRST, SECOND, *[FIRST] * 7]


def test_german_headers_and_decimal_commas() -> None:
    survey = read_joints(HERE / "deutsch.csv")
    assert planes(survey) == [FIRST, SECOND]
    first, second = survey.joints
    assert (first.name, first.set_name, first.cohesion_kpa, first.friction_angle_deg) == (
        "K1",
        "S1",
        12.5,
        30.0,
    )
    assert (second.cohesion_kpa, second.friction_angle_deg, first.quantity) == (None, 28.5, 2.0)
    assert survey.left_out == ("column Öffnung (mm)",)
    assert planes(read_joints(HERE / "clar.csv")) == [FIRST, SECOND]
    quoted = read_joints(HERE / "quoted.csv")
    assert planes(quoted) == [FIRST, SECOND]
    assert [joint.cohesion_kpa for joint in quoted.joints] == [7.5, 10.0]


def test_a_comma_that_may_part_thousands(tmp_path) -> None:
    assert refused(written(tmp_path, 'dip,dd,c\n45,115,"1,200"\n')).codes == ("E193",)


def test_angles_in_radians() -> None:
    error = refused(HERE / "radians.csv")
    assert error.codes == ("E113",)
    assert (
        error.faults[0].message
        == "no angle of radians.csv is beyond 1.056 and 4.276: that looks like radians"
    )


@pytest.mark.parametrize(
    ("text", "is_refused"), [("0.79/2.01", True), ("1.2/3.5", False), ("0.79/20.01", False)]
)
def test_a_plane_in_radians(text, is_refused) -> None:
    if not is_refused:
        assert str(parse_plane(text, "J1")).startswith(text.partition("/")[0])
        return
    with pytest.raises(DesignError) as caught:
        parse_plane(text, "J1")
    assert caught.value.codes == ("E113",)
    assert caught.value.faults[0].advice.startswith("In degrees that would be 45.3/115.2")


def test_flat_beds_are_no_radians(tmp_path) -> None:
    path = written(tmp_path, "dip,dd\n1.2,3.5\n0.8,5.25\n1.5,212\n")
    assert len(read_joints(path).joints) == 3


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        (
            "115/45",
            "Dip comes first: did you mean 45/115? If 115 is a strike by the right-hand rule, it is 45/205. "
            "An overturned plane is written 65/225.",
        ),
        ("N25E/45SE", "This looks like a strike and the side of the dip: write 45/115."),
        (
            "N25E/45",
            "write 45/025; where it is the strike, 45/115 or 45/295, by the side it dips to.",
        ),
        ("N25E", "dip direction = strike + 90 by the right-hand rule, - 90 by the left-hand rule."),
    ],
)
def test_hints_hold_for_those_who_write_strikes(text, advice) -> None:
    with pytest.raises(DesignError) as caught:
        parse_plane(text, "J1")
    assert caught.value.faults[0].advice.endswith(advice)


# -- CloudCompare -----------------------------------------------------------------------------------------------------


def test_planes_of_cloudcompare_compass() -> None:
    survey = read_joints(HERE / "compass_planes.csv")
    assert planes(survey) == [FIRST, SECOND, Plane(80.0, 90.0)]
    assert [joint.name for joint in survey.joints] == [
        "wall.faults.Plane",
        "wall.faults.Plane-2",
        "wall.Plane",
    ]
    assert survey.left_out == (
        "12 columns (Cx, Cy, Cz, Nx, Ny, Nz, Sample_Radius, RMS, Gx, Gy, Gz, Length)",
        "column strike (the dip direction is given)",
    )
    assert survey.read_as == ("1 name that stands more than once got a number behind it",)


def test_lines_of_cloudcompare_are_no_poles() -> None:
    error = refused(HERE / "compass_lineations.csv")
    assert error.codes == ("E191",)
    assert "lineations" in error.faults[0].message


def test_facets_of_cloudcompare(tmp_path) -> None:
    survey = read_joints(HERE / "facets.csv")
    assert planes(survey) == [FIRST, SECOND, Plane(80.0, 0.0)]
    assert [(joint.name, joint.set_name) for joint in survey.joints] == [
        ("0", "1"),
        ("1", "2"),
        ("2", "2"),
    ]
    assert survey.left_out[0].startswith("12 columns (CenterX, CenterY, CenterZ, NormalX")
    # facets of two extractions in one file: the index is no name
    twice = (HERE / "facets.csv").read_text(encoding="utf-8").replace("\n1;", "\n0;")
    survey = read_joints(written(tmp_path, twice))
    assert [joint.name for joint in survey.joints] == ["J1", "J2", "J3"]
    assert survey.left_out[-1] == "column Index (its numbers stand more than once)"


# -- workbooks and frames ---------------------------------------------------------------------------------------------


def workbook(folder: Path, rows: list[list[object]], *others: str) -> Path:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    for title in others:
        book.create_sheet(title)
    path = folder / "joints.xlsx"
    book.save(path)
    return path


ROWS: list[list[object]] = [
    ["Road cut km 12"],
    [],
    ["Name", "Dip", "Dip direction", "c", "Remark"],
    ["A", 45, 115.0, None, "rough"],
    [None, None, None, None, None],
    ["B", 60.5, "245,0", 5, None],
]


def test_a_workbook(tmp_path) -> None:
    survey = read_joints(workbook(tmp_path, ROWS, "Notes", "Photos"))
    assert planes(survey) == [FIRST, SECOND]
    assert [(joint.name, joint.line, joint.cohesion_kpa) for joint in survey.joints] == [
        ("A", 4, None),
        ("B", 6, 5.0),
    ]
    assert survey.left_out == ("sheets Notes, Photos", "column Remark", "row 1 (above the columns)")
    error = refused(workbook(tmp_path, [*ROWS, ["C", 195, 115]]))
    assert (error.codes, error.faults[0].where) == (("E101",), "joints.xlsx:7  C; 195; 115")


def test_workbooks_that_cannot_be_read(tmp_path, monkeypatch) -> None:
    path = workbook(tmp_path, ROWS)
    path.write_bytes(path.read_bytes()[:300])
    assert refused(path).codes == ("E159",)
    path.write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(100))
    assert refused(path).faults[0].message == "joints.xlsx is a workbook of before 2007"
    workbook(tmp_path, ROWS)
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    error = refused(path)
    assert error.codes == ("E140",)
    assert "pip install 'slopekit[survey]'" in error.faults[0].advice


def test_mutated_workbooks_give_faults_and_no_traceback(tmp_path) -> None:
    path = workbook(tmp_path, ROWS)
    whole, rng, codes = path.read_bytes(), random.Random(5), list[str]()
    for _ in range(60):
        content = bytearray(whole)
        for _ in range(rng.randint(1, 4)):
            content[rng.randrange(4, len(content))] ^= 1 << rng.randrange(8)
        path.write_bytes(content)
        try:
            assert planes(read_joints(path)) == [FIRST, SECOND]
        except DesignError as error:
            codes += error.codes
    assert set(codes) >= {"E159"}


class Frame:
    """Columns by their names, as frames of pandas and polars have them."""

    def __init__(self, columns: dict[str, list[object]]) -> None:
        self._columns = columns

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    def __getitem__(self, name: str) -> list[object]:
        return self._columns[name]


COLUMNS: dict[str, list[object]] = {
    "Dip": [45.0, 60.5],
    "Dip direction": [115, 245],
    "Quantity": [2, float("nan")],
    "phi": [None, 28.5],
    "remark": ["rough", "x"],
}


def test_a_frame_is_a_joint_list() -> None:
    found = joint_list(Frame(COLUMNS))
    assert planes(JointList("", found.joints)) == [FIRST, SECOND]
    assert [(joint.quantity, joint.friction_angle_deg) for joint in found.joints] == [
        (2.0, None),
        (1.0, 28.5),
    ]
    assert found.left_out == ("column remark",)
    with pytest.raises(DesignError) as caught:
        joint_list(Frame({"strike": [25.0], "dip": [45.0]}))
    assert caught.value.codes == ("E192",)
    assert "Say convention = right-hand-rule" in caught.value.faults[0].advice
    assert joint_list(Frame({"strike": [25.0], "dip": [45.0]}), "RHR").joints[0].plane == FIRST


def test_a_frame_of_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(COLUMNS)
    assert sk.kinematic(frame, face="65/180", phi=30).joints == joint_list(Frame(COLUMNS))
    assert joint_list(frame.set_index("remark")).left_out == ("index remark",)
    frame["Quantity"] = pandas.array([2, None], dtype="Int64")
    assert joint_list(frame).joints == joint_list(Frame(COLUMNS)).joints


def test_a_frame_of_polars() -> None:
    polars = pytest.importorskip("polars")
    assert (
        joint_list(polars.DataFrame(COLUMNS, strict=False)).joints
        == joint_list(Frame(COLUMNS)).joints
    )


# -- designs ----------------------------------------------------------------------------------------------------------


def test_a_design_says_how_its_list_was_read(tmp_path) -> None:
    written(tmp_path, "trend,plunge,Quantity\n295,45,2\n115,45,1\n")
    design = tmp_path / "wall.yaml"
    design.write_text(
        "slopekit: 1\nkind: wedge\nslope: {face: 65/205, upper: 10/205, height: 20}\njoints: {csv: joints.csv}\n"
        "strength: {joint: {c: 7, phi: 28}}\nrock: {density: 2600}\n",
        encoding="utf-8",
    )
    found = sk.load(design)
    assert found.joints == (FIRST, Plane(45.0, 295.0))
    assert found.reading.left_out == ("quantities of joints.csv",)
    assert len(found.reading.read_as) == 1
    assert found.reading.read_as[0].startswith("joints.csv: trend and plunge are of poles")
    assert "read_as" not in found.inputs()
