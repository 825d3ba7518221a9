"""Every message that concerns a wedge: its code, its first line, its exit code, all faults at once."""

import re
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.explanations import explanations
from slopekit.kinds.wedge.design import wedge_design

DIPS = ("45/115", "45/245")
HEAD = (0.0, 20.0, 34.0)

# code, inputs, what the first line must say
BAD_INPUT = [
    ("E101", {"dips": ("95/115", "45/245")}, "dip of J1 is 95, a dip lies between 0 and 90"),
    ("E101", {"dips": ("-5/115", "45/245")}, "dip of J1 is -5"),
    ("E102", {"dips": ("45/115", "45/400")}, "dip direction of J2 is 400"),
    ("E102", {"face": "60/-20"}, "dip direction of face is -20"),
    ("E103", {"dips": ("115/45", "45/245")}, "J1 is 115/45: dip and dip direction look swapped"),
    ("E104", {"dips": ("N25E 45SE", "45/245")}, "a plane is written dip/dip direction"),
    ("E104", {"dips": ("45", "45/245")}, "a plane is written dip/dip direction"),
    ("E104", {"upper": "flat"}, "upper is 'flat'"),
    ("E104", {"dips": ((45, 115, 3), "45/245")}, "a plane is written dip/dip direction"),
    ("E105", {"dips": ((float("nan"), 115), "45/245")}, "not a finite number"),
    ("E105", {"height": float("inf")}, "not a finite number"),
    ("E106", {"height": "tall"}, "height is 'tall', a number is needed"),
    ("E106", {"c": "fifty"}, "a number is needed"),
    ("E106", {"height": True}, "a number is needed"),
    ("E107", {"c": "50 kN"}, "c of J1 has the unit kN, which measures a force, not a pressure"),
    ("E107", {"unit_weight": "2600 kg/m3"}, "that is a density"),
    ("E107", {"density": "26 kN/m3"}, "that is a unit weight"),
    ("E108", {"height": "65 furlong"}, "unknown unit 'furlong'"),
    ("E109", {"dips": ("45/115",)}, "a wedge has two joints"),
    ("E109", {"dips": None}, "the two joints are missing"),
    ("E109", {"c": (1, 2, 3)}, "c has 3 values"),
    ("E109", {"water": (1, 2, 3)}, "3 water pressures given"),
    ("E109", {"origin": (5e5, 4e6)}, "three coordinates"),
    ("E110", {"unit_weight": 2650}, "unit weight is 2650 kN/m³, out of range"),
    ("E110", {"unit_weight": 2.65}, "unit weight is 2.65 kN/m³, out of range"),
    ("E111", {"density": 2.65}, "density is 2.65 kg/m³, out of range"),
    ("E111", {"density": 26}, "density is 26 kg/m³, out of range"),
    ("E112", {"density": 2600, "unit_weight": 25.5}, "both given"),
    ("E113", {"phi": 0.35}, "looks like radians"),
    ("E113", {"phi": 1.57}, "looks like radians"),
    ("E114", {"c": -5}, "cohesion is never negative"),
    ("E114", {"tension": -1}, "a strength is never negative"),
    ("E115", {"phi": 90}, "a friction angle lies from 0 to below 90"),
    ("E115", {"phi": (20, -3)}, "phi of J2 is -3°"),
    ("E116", {"height": 0}, "height is 0, it must be more than 0"),
    ("E115", {"phi": 20, "dilation": 25}, "dilation of J1 is 25°"),
    ("E118", {"water": "120%"}, "more than all"),
    ("E118", {"water": 5.0}, "more than all"),
    ("E118", {"water": "wet"}, "not understood"),
    ("E118", {"water": (-1.0, 0.0)}, "never negative"),
    ("E120", {"crack": "80/180"}, "it is written 80/180@5m"),
    ("E120", {"crack": "80/180@0"}, "crack distance is 0"),
    ("E122", {"seismic": 9.81}, "it lies between 0 and 2"),
    ("E122", {"seismic": "0.1@400"}, "trend of seismic is 400"),
    ("E123", {"forces": "100 kN"}, "force is 100 kN"),
    ("E123", {"forces": "100@180"}, "it is written trend/plunge"),
    ("E124", {"bolts": "200"}, "bolt is 200"),
    ("E124", {"bolts": "200@000/10,strong"}, "it is active or passive"),
    ("E124", {"bolts": "200@000/100"}, "plunge of bolt is 100"),
    (
        "E124",
        {"bolts": {"force": 200, "toward": "000/10", "length": 9}},
        "a bolt with a length needs its head",
    ),
    ("E126", {"criterion": "all_pairs"}, "it is limit or all-pairs"),
    ("E127", {"accept": -1}, "accept is -1"),
    ("E142", {"hieght": 10}, "hieght is not an input of a wedge"),
    ("E127", {"gravity": 0}, "gravity is 0"),
    ("E137", {"refine": 1.5}, "whole number"),
    ("E127", {"shear_stiffness": 0}, "shear stiffness is 0"),
]
NO_BLOCK = [
    ("E201", {"dips": ("45/115", "45/115")}, "J1 and J2 are parallel"),
    (
        "E203",
        {"face": "20/180"},
        "the line plunges 22.9°, steeper than the face (20°): it does not daylight",
    ),
    ("E204", {"face": "60/000", "upper": "0/000"}, "into the slope"),
    ("E205", {"upper": "25/180"}, "flatter than the upper slope (25°)"),
    ("E206", {"dips": ("60/180", "45/245")}, "J1 and the face are parallel"),
    (
        "E206",
        {"dips": ("45/180", "80/245"), "face": "60/180"},
        "the trace of J1 on the face is horizontal",
    ),
    ("E207", {"crack": "80/180@300m"}, "the wedge ends at 209.373 m"),
    ("E207", {"crack": "10/180@30m"}, "parallel to the upper slope"),
    ("E207", {"crack": "22.909807125143665/180@30m"}, "parallel to the line of intersection"),
    ("E207", {"crack": "15/180@30m"}, "does not cross the line of intersection"),
    (
        "E208",
        {"dips": ("30/105", "40/215"), "face": "70/180", "crack": "70/190@5", "height": 10},
        "the crack cuts the wedge in two below its crest",
    ),
    ("E209", {"face": "60/180", "upper": "60/180"}, "there is no crest"),
    (
        "E211",
        {"bolts": {"force": 200, "toward": "000/10", "head": (500, 0, 0)}},
        "bolt 1 misses the block",
    ),
    ("E211", {"bolts": {"force": 200, "toward": "180/10", "head": HEAD}}, "through a free face"),
    (
        "E212",
        {"bolts": {"force": 200, "toward": "000/10", "head": HEAD, "length": 2}},
        "it is too short",
    ),
]


@pytest.mark.parametrize(("code", "inputs", "says"), BAD_INPUT, ids=lambda value: str(value)[:40])
def test_bad_input(code, inputs, says) -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.wedge(**{"dips": DIPS, **inputs})
    first = caught.value.faults[0]
    assert first.code == code
    assert says in first.message
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("inputs", [{"phi": 1.575}, {"phi": 20, "dilation": 20}], ids=str)
def test_values_just_within_their_limits(inputs) -> None:
    """In radians 1.575 would be more than upright; a joint may dilate by all of its friction angle."""
    design = wedge_design({"dips": DIPS, **inputs})
    assert design.friction_angle_deg == (inputs["phi"],) * 2
    assert [one.dilation_deg for one in design.strengths] == [inputs.get("dilation", 0.0)] * 2


@pytest.mark.parametrize(("code", "inputs", "says"), NO_BLOCK, ids=lambda value: str(value)[:40])
def test_no_block_can_be_formed(code, inputs, says) -> None:
    with pytest.raises(sk.GeometryError) as caught:
        sk.wedge(**{"dips": DIPS, **inputs})
    assert caught.value.codes == (code,)
    assert says in caught.value.faults[0].message
    is_misfit = code in ("E211", "E212")  # a block there is, and no bolt in it
    assert caught.value.exit_code == (2 if is_misfit else 3)


def test_all_faults_are_reported_at_once() -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.wedge(
            dips=("95/115", "45/400"),
            phi=0.35,
            height=-3,
            water="wet",
            unit_weight=2650,
            bolts=["1", "2"],
        )
    assert caught.value.codes == ("E101", "E102", "E116", "E113", "E118", "E110", "E124", "E124")


def test_advice_says_what_to_type_instead() -> None:
    def advice(**inputs) -> str:
        with pytest.raises(sk.DesignError) as caught:
            sk.wedge(**{"dips": DIPS, **inputs})
        return caught.value.faults[0].advice

    assert (
        advice(dips=("95/115", "45/245")) == "A plane that dips 95° toward 115 is written 85/295."
    )
    assert "45/115?" in advice(dips=("115/45", "45/245"))
    assert "20.1°" in advice(phi=0.35)
    assert "2.65 t/m3" in advice(unit_weight=2.65)
    assert "unit_weight" in advice(density=26)
    assert "write 45/115" in advice(dips=("N25E 45SE", "45/245"))
    assert "where it is the strike, 45/115 or 45/295" in advice(dips=("N25E/45", "45/245"))
    assert advice(hieght=1) == "Did you mean height?"


def test_inputs_of_every_ordinary_kind_mean_the_same() -> None:
    plain = sk.wedge(dips=DIPS, c=(50, 50), height=64.89, density=2600)
    for same in (
        {"dips": ((45, 115), (45, 245)), "height": "64.89 m"},
        {"dips": np.array([[45.0, 115.0], [45.0, 245.0]]), "c": np.array([50.0, 50.0])},
        {"dips": (" 45 / 115 ", "45°/245°"), "c": "50kPa", "density": "2.6 t/m3"},
        {"dips": DIPS, "c": "50, 50", "phi": "20 deg", "unit_weight": 25.506},
    ):
        assert sk.wedge(**same).fos == plain.fos


def test_every_code_that_the_program_can_say_is_explained() -> None:
    source = "".join(path.read_text() for path in Path(sk.__file__).parent.rglob("*.py"))
    said = set(re.findall(r'"([EW]\d{3})"', source)) | {"E599"}
    assert said == explanations().keys()
