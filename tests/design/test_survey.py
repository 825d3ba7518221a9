"""Joint lists: delimiters, encodings, headers, strikes, and every bad row with its line."""

import random

import pytest

from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane
from slopekit.design.survey import MeasuredJoint, read_joints

PLAIN = "name,dip,dip_direction\nA,45,115\nB,60.5,245\n"
WANTED = [("A", Plane(45, 115)), ("B", Plane(60.5, 245))]


def written(folder, content: str | bytes):
    path = folder / "joints.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def refused(folder, content, convention=None) -> DesignError:
    with pytest.raises(DesignError) as caught:
        read_joints(written(folder, content), convention)
    return caught.value


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace(",", ";"),
        PLAIN.replace(",", ";").replace("60.5", "60,5"),
        PLAIN.replace(",", "\t").replace("60.5", "60,5"),
        "# Dips export\n\nName , DIP , Dip Direction\n# first\nA,45,115\n\n\nB,60.5,245",
        "ID,Dip (°),DipDir [deg]\nA,45°,115\nB,60.5,245\n",
        "dd,joint,dip\n115,A,45\n245,B,60.5\n",
        "azimuth;set;dip-angle\n115;A;45\n245;B;60.5\n",
        '"name","dip","dip direction"\n"A","45","115"\n"B","60.5","245"\n',
        "name,dip,dip_direction,\nA,45,115,\nB,60.5,245,,\n",
        PLAIN.encode("utf-8-sig"),
        PLAIN.encode("utf-16"),
        PLAIN.encode("utf-16-le"),
        PLAIN.encode("utf-16-be"),
        "name,dip (°),dip_direction\nA,45,115\nB,60.5,245\n".encode("latin-1"),
    ],
    ids=lambda content: repr(content)[:40],
)
def test_the_same_list_in_many_dresses(content, tmp_path) -> None:
    survey = read_joints(written(tmp_path, content))
    assert [(joint.name, joint.plane) for joint in survey.joints] == WANTED
    assert survey.left_out == ()


def test_two_columns_without_a_header(tmp_path) -> None:
    survey = read_joints(written(tmp_path, "# dip, dd\n45,115\n60.5,245\n"))
    assert survey.joints == (
        MeasuredJoint("J1", Plane(45, 115), 2),
        MeasuredJoint("J2", Plane(60.5, 245), 3),
    )


def test_strength_columns_and_what_is_left_out(tmp_path) -> None:
    content = (
        "id,set,dip,dd,strike,c (MPa),phi,remark,empty\nA,1,45,115,25,0.05,20,rough,\n,,,,,,,,\nB,1,60.5,245,0,5 "
        "kPa,,,"
    )
    survey = read_joints(written(tmp_path, content))
    assert survey.joints[0] == MeasuredJoint("A", Plane(45, 115), 2, 50.0, 20.0, "1")
    assert survey.joints[1] == MeasuredJoint("B", Plane(60.5, 245), 4, 5.0, None, "1")
    assert survey.left_out == (
        "column remark",
        "column strike (the dip direction is given)",
        "line 3 (empty cells)",
    )


def test_sets_are_names_only_where_each_stands_once(tmp_path) -> None:
    once = read_joints(written(tmp_path, "set,dip,dd\nA,45,115\nB,60.5,245\n")).joints
    assert [(joint.name, joint.set_name) for joint in once] == [("A", ""), ("B", "")]
    twice = read_joints(written(tmp_path, "set,dip,dd\nA,45,115\nA,60.5,245\n,60,240\n")).joints
    assert [(joint.name, joint.set_name) for joint in twice] == [
        ("J1", "A"),
        ("J2", "A"),
        ("J3", ""),
    ]


def test_bad_rows_are_left_out_and_named_where_that_is_asked_for(tmp_path) -> None:
    good = "".join(f"G{k},50,245,20\n" for k in range(30))
    content = f"name,dip,dd,phi\nA,195,115,\nB,45,115,30\nE,45,x,0.35\nC,45\n{good}"
    survey = read_joints(written(tmp_path, content), skip_bad=True)
    assert [joint.name for joint in survey.joints] == ["B", *(f"G{k}" for k in range(30))]
    assert [part[:13] for part in survey.left_out] == [
        "line 2 (E101 ",
        "line 4 (E104 ",
        "line 5 (E193 ",
    ]
    assert "E113" in survey.left_out[1]
    again = read_joints(
        written(tmp_path, f"name,dip,dd,phi\nA,195,115,\nA,45,115,\n{good}"), skip_bad=True
    )
    assert [(joint.name, joint.line) for joint in again.joints][:2] == [("A", 3), ("G0", 4)]
    assert refused(tmp_path, "dip,richtung\n95,1\n").codes == ("E191",)


@pytest.mark.parametrize(
    ("convention", "direction"), [("right-hand-rule", 115.0), ("left-hand-rule", 295.0)]
)
def test_a_strike_needs_its_convention(convention, direction, tmp_path) -> None:
    content = "name,strike,dip\nA,25,45\n"
    assert read_joints(written(tmp_path, content), convention).joints[0].plane == Plane(
        45, direction
    )
    error = refused(tmp_path, content)
    assert error.codes == ("E192",)
    assert error.faults[0].message == "a strike column has two meanings, its convention is not said"


# code, file, what the first line must say, the line
BAD = [
    ("E101", "dip,dd\n195,115\n", "dip of J1 is 195", 2),
    ("E102", "dip,dd\n45,400\n", "dip direction of J1 is 400", 2),
    ("E103", "dip,dd\n115,45\n", "J1 is 115/45: dip and dip direction look swapped", 2),
    ("E104", "dip,dd\n45,east\n", "J1 is '45/east'", 2),
    ("E105", "dip,dd\n45,nan\n", "not a finite number", 2),
    ("E106", "dip,dd,c\n45,115,soft\n", "c of J1 is 'soft', a number is needed", 2),
    ("E107", "dip,dd,c [m]\n45,115,5\n", "c of J1 has the unit m", 2),
    ("E113", "dip,dd,phi\n45,115,0.35\n", "looks like radians", 2),
    ("E114", "dip,dd,c\n45,115,-5\n", "c of J1 is -5 kPa", 2),
    ("E115", "dip,dd,phi\n45,115,95\n", "phi of J1 is 95°", 2),
    ("E159", "dip,dd\n45,115\x01\n", "joints.csv is not a text file (character U+0001)", None),
    ("E159", b"\xff\xfed\x00\xff", "joints.csv is not a text file", None),
    ("E190", "", "joints.csv holds no joints", None),
    ("E190", "# nothing\n\n", "joints.csv holds no joints", None),
    ("E190", "dip,dd\n", "joints.csv has a header and no joints", None),
    ("E191", "dip,direktion\n45,115\n", "joints.csv has no column for dip direction", 1),
    ("E191", "45 115 3\n60 245 3\n", "joints.csv has no header, and 3 columns of numbers", 1),
    ("E191", "45,115,3\n", "joints.csv has no header, and 3 columns of numbers", 1),
    (
        "E191",
        "dip,dd,dipdir\n45,115,3\n",
        "joints.csv has two columns for dip direction: dd and dipdir",
        1,
    ),
    (
        "E191",
        "dip (rad),dd\n1,2\n",
        "the column dip (rad) is in rad, an orientation is in degrees",
        1,
    ),
    ("E193", "dip,dd\n45,115,7\n", "line 2 has 3 values for 2 columns", 2),
    ("E193", "dip,dd\n45,5,115,0\n", "line 2 has 4 values for 2 columns", 2),
    ("E193", "dip,dd\n45\n", "J1 has no dip direction", 2),
]


@pytest.mark.parametrize(
    ("code", "content", "says", "line"), BAD, ids=lambda value: repr(value)[:40]
)
def test_bad_lists(code, content, says, line, tmp_path) -> None:
    error = refused(tmp_path, content)
    assert error.codes == (code,)
    assert says in error.faults[0].message
    assert error.faults[0].where.startswith(f"joints.csv:{line}  " if line else "joints.csv")


def test_every_bad_row_is_reported(tmp_path) -> None:
    error = refused(tmp_path, "dip,dd\n195,115\n45,115\n45,x\n45\n")
    assert [(fault.code, fault.where) for fault in error.faults] == [
        ("E101", "joints.csv:2  195,115"),
        ("E104", "joints.csv:4  45,x"),
        ("E193", "joints.csv:5  45"),
    ]


def test_strikes_out_of_range_and_unknown_conventions(tmp_path) -> None:
    assert refused(tmp_path, "dip,strike\n45,400\n45,x\n", "right-hand-rule").codes == (
        "E102",
        "E106",
    )
    error = refused(tmp_path, "dip,strike\n45,40\n", "righthand")
    assert error.codes == ("E192",)
    assert error.faults[0].message == "the strike convention 'righthand' is not known"
    assert error.faults[0].advice == "Did you mean right-hand-rule?"


def test_missing_and_oversize_files(tmp_path) -> None:
    written(tmp_path, PLAIN)
    with pytest.raises(DesignError) as caught:
        read_joints(tmp_path / "joint.csv")
    assert caught.value.codes == ("E147",)
    assert caught.value.faults[0].advice.endswith("joints.csv?")
    with pytest.raises(DesignError) as caught:
        read_joints(tmp_path)
    assert caught.value.codes == ("E148",)
    assert refused(tmp_path, "#" * 5_000_001).codes == ("E190",)
    (fault,) = refused(tmp_path, "#" * 50_000_001).faults
    assert (fault.code, fault.message) == ("E149", "joints.csv is larger than 50 MB")
    assert "esh" not in fault.advice


@pytest.mark.slow
def test_a_hundred_thousand_rows(tmp_path) -> None:
    content = "dip,dd\n" + "".join(f"{k % 90},{k % 360}\n" for k in range(100_000))
    survey = read_joints(written(tmp_path, content))
    assert len(survey.joints) == 100_000
    assert survey.joints[-1].name == "J100000"


def test_mutated_lists_give_faults_and_no_traceback(tmp_path) -> None:
    rng, faults, marks = (
        random.Random(4),
        [],
        [b";", b",", b"\n", b'"', b"\x00", b"\xff", b"-", b"e", b""],
    )
    for _ in range(200):
        content = bytearray(
            (
                "# c\nid;dip;dd;c;phi\n" + "".join(f"{k};{k};{k};5 kPa;20\n" for k in range(9))
            ).encode()
        )
        for _ in range(rng.randint(1, 5)):
            k = rng.randrange(len(content))
            content[k : k + rng.randint(0, 3)] = rng.choice(marks)
        try:
            read_joints(written(tmp_path, bytes(content)))
        except DesignError as error:
            faults += error.faults
    assert all(fault.where.startswith("joints.csv") for fault in faults)
