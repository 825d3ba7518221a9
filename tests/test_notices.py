"""Every notice: what brings it about, and what it says first. Then: no code is without a test."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from benchmarks.ordinary_cuts import notices_of_sheets, sheets_of_cuts
from slopekit.core.errors import SolverError
from slopekit.core.explanations import explanations
from slopekit.design.templates import path_of
from slopekit.geometry.interfaces import node_pairs
from slopekit.kinds import cut, kind_of
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block.one_block import block_notices
from slopekit.kinds.single_block.one_block_limit import FoundLimit
from slopekit.kinds.wedge.design import wedge_design
from slopekit.loads import Loads
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.system.model import JointStrength, build_model
from tests.commands import slopekit
from tests.support import result_of

DIPS = ("45/115", "45/245")
#: cases.json, 9_single-plane: slides on J1 alone
ONE_PLANE = {
    "dips": ("40/160", "80/220"),
    "face": "65/180",
    "upper": "0/180",
    "height": 10,
    "c": 20,
    "phi": 30,
    "unit_weight": 26,
}
# code, inputs of a wedge, what the notice says
OF_A_WEDGE = [
    (
        "W301",
        {"dips": ("45/178", "45/182")},
        "less or more dip of J1 the factor of safety is 0.5794 or 0.5791",
    ),
    (
        "W301",
        {"dips": ("45/178", "45.3/178.4"), "water": "full"},
        "it is not settled by the digits of the planes",
    ),
    ("W302", {"unit_weight": 100}, "a unit weight of 100 kN/m³ is not that of rock"),
    ("W307", ONE_PLANE, "J2 has lost contact"),
    ("W308", {"c": 0, "phi": 0}, "the joints have no strength"),
    ("W310", {"dilation": 5}, "the closed form knows no dilation"),
    ("W328", {"seismic": "0.1@000"}, "the seismic load acts against the movement"),
    ("W329", {"tension": 100}, "the tensile strength acts in the displacements only"),
    ("W311", {"bolts": "200@000/10"}, "bolts without a head"),
    ("W311", {"bolts": "200@180/22.909807,passive"}, "the passive bolts add nothing"),
    ("W302", {"c": 50000}, "a cohesion of 50000 kPa is that of intact rock: is 50 kPa meant?"),
    ("W302", {"phi": 80}, "a friction angle of 80° is that of no joint"),
    ("W419", {"crack": "80/180@5m", "water": (5, 5)}, "the crack is dry"),
    (
        "W302",
        {"height": 15000},
        "m high, higher than nearly any rock slope: was a length typed in mm?",
    ),
    ("W302", {"height": 0.01}, "m high, lower than any slope: was a length typed in km?"),
    (
        "W302",
        {"water": "u=5000kPa"},
        "a mean water pressure of 5000 kPa is that of 509.7 m of water, on blocks 100 m",
    ),
    (
        "W379",
        {"face": "65/180"},
        "not given, taken from the paper's wedge: upper, height, c, phi, density",
    ),
]
# code, template, changes, what the notice says
OF_A_FILE = [
    (
        "W419",
        "wedge",
        {"crack": {"plane": "80/180", "distance": 5, "water": "full"}},
        "the crack holds water",
    ),
    (
        "W320",
        "wedge",
        {"strength.weak.c": {"dist": "uniform", "min": 40, "max": 60}},
        "distributions are taken at",
    ),
    (
        "W322",
        "paper-ellipsoid",
        {"slope.profile": [[80, 20], [62, 20], [60, 0], [40, 0], [0, 40], [-20, 40]]},
        "the slip surface cuts 2 pieces",
    ),
    (
        "W323",
        "plane",
        {"support": {"bolts": [{"force": 10, "toward": "090/0"}]}},
        "bolts or forces act along the slo",
    ),
    (
        "W324",
        "paper-ellipsoid",
        {"loads": {"forces": [[10, 0, 0]]}},
        "the methods of columns are left out: they know",
    ),
    ("W325", "paper-ellipsoid", {"slip.radii": [40, 28, 36]}, "the normals were turned by"),
    (
        "W328",
        "surface",
        {"loads": {"seismic": "0.1@180"}},
        "the seismic load acts across the movement",
    ),
    (
        "W324",
        "surface",
        {"acceptance": {"rules": ["fos >= 1.362"]}},
        "the limit meets fos >= 1.362, Fellenius",
    ),
    ("W322", "sphere", {"slope.profile": [[5, -8.09017], [-30, 9.4098301]]}, "the mass reaches"),
    (
        "W332",
        "sphere",
        {"acceptance": {"rules": ["fos.static_bound >= 1.3"]}},
        "a rule judges the upper bound",
    ),
    (
        "W323",
        "plane",
        {"loads": {"seismic": "0.2@270"}},
        "the seismic load acts off the section: 0 % of it",
    ),
    ("W302", "footing", {"weak_plane.length": 8000}, "the blocks are 5142 m high, higher"),
    (
        "W302",
        "blocks",
        {
            "blocks": {
                "base": {"polygon": [[0, 0], [9000, 0], [9000, -1000], [0, -1000]], "fixed": True},
                "B1": {"polygon": [[0, 0], [2000, 0], [2000, 3000], [0, 3000]]},
            },
            "interfaces": {"default": "joint"},
            "strength": {"joint": {"c": 0, "phi": 30}},
        },
        "the blocks are 4000 m high",
    ),
    (
        "W302",
        "blocks",
        {"water": {"pressures": {"base/B1": 900}}},
        "a mean water pressure of 900 kPa is that of 91.7",
    ),
    (
        "W302",
        "topple",
        {"water": {"pressures": {"base": 2000}}},
        "a mean water pressure of 2000 kPa is that",
    ),
    (
        "W302",
        "wedge",
        {"strength.weak": {"law": "power", "a": 200, "b": 0.75}},
        "power curve 200 σ^0.75 kPa resists 6",
    ),
]


@pytest.mark.parametrize(("code", "inputs", "says"), OF_A_WEDGE, ids=lambda value: str(value)[:30])
def test_notices_of_a_wedge(code, inputs, says) -> None:
    said = [
        notice.message
        for notice in sk.wedge(**{"dips": DIPS, **inputs}).warnings
        if notice.code == code
    ]
    assert any(says in message for message in said)


@pytest.mark.parametrize(
    ("code", "template", "changes", "says"), OF_A_FILE, ids=lambda value: str(value)[:30]
)
def test_notices_of_a_design_file(code, template, changes, says) -> None:
    said = [
        notice.message
        for notice in sk.run(path_of(template), set=changes).warnings
        if notice.code == code
    ]
    assert any(message.startswith(says) for message in said)


def test_a_plain_design_is_told_nothing() -> None:
    for name in ("wedge", "plane", "footing", "paper-ellipsoid", "sphere"):
        assert result_of(name).warnings == ()


def facts(**changes) -> tuple[set[str], str]:
    """The codes said of the paper's wedge with some of the facts changed, and all that was said."""
    given = {
        "face": "60/180",
        "upper": "10/180",
        "height": 64.89,
        "c": 50,
        "phi": 20,
        "density": 2600,
    }
    design = wedge_design({"dips": DIPS} | given)
    made = cut(design)
    scene = made.scene_at(0)
    analysis = pairs_limit(scene.model)
    if "swings" in changes:
        governing = replace(analysis.governing, change=changes.pop("swings"))
        analysis = replace(analysis, governing=governing)
    found = replace(FoundLimit(scene, scene, analysis), **changes)
    said = list(block_notices(design, made, found, ClosedForm(None, ""), kind_of(design).words))
    return {notice.code for notice in said}, "\n".join(map(str, said))


@pytest.mark.parametrize(
    ("code", "changes", "says"),
    [
        ("W312", {"change": 0.03}, "still moved the limit by 3.0 %"),
        (
            "W317",
            {"swings": 0.01},
            "a limit state: the block rests at 1.557 and runs at 1.573; the lower is printed",
        ),
    ],
)
def test_notices_of_what_the_solver_met(code, changes, says) -> None:
    codes, said = facts(**changes)
    assert codes == {code}
    assert says in said


def test_bugs_of_ours_have_codes() -> None:
    """E599 guards the arrays between the stages; a design cannot bring them about."""
    square = {0: np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])}
    pairs, none = node_pairs(square), np.zeros((0, 3))
    strength = JointStrength(np.ones(1), np.ones(1), np.zeros(1), np.zeros(1))
    weightless = Loads(np.zeros(3), np.zeros(3), {"weight": np.zeros(3)}, none, none)
    heavy = replace(
        weightless, force=np.array([0.0, 0, -1]), components={"weight": np.array([0.0, 0, -1])}
    )
    with pytest.raises(SolverError) as caught:
        build_model(pairs, weightless, np.zeros(3), strength)
    assert caught.value.codes == ("E599",)
    with pytest.raises(SolverError) as caught:
        build_model(replace(pairs, normals=pairs.normals * 1.01), heavy, np.zeros(3), strength)
    assert caught.value.codes == ("E599",)
    bow_tie = {0: np.array([[0.0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1.5, 0]])}
    with pytest.raises(SolverError) as caught:
        node_pairs(bow_tie)
    assert caught.value.codes == ("E599",)


@pytest.mark.parametrize(
    ("arguments", "starts"),
    [
        (("wedge", "--nonsense", "1"), "E100 "),
        (("wedge", "--dips", *DIPS, "--c", "5", "--c", "6"), "E100 --c is given twice"),
        (
            ("wedge", "--dips", *DIPS, "--picture", "wedge.jpg"),
            "E141 the picture wedge.jpg is not a .png, .glb or",
        ),
    ],
)
def test_faults_of_the_command_line(arguments, starts, tmp_path) -> None:
    run = slopekit(*arguments, "--json", cwd=tmp_path)
    assert run.returncode == 2
    assert run.stderr.startswith(starts)
    fault = json.loads(run.stdout)["errors"][0]
    assert fault["code"] == starts[:4]
    if fault["code"] == "E141":
        assert fault["advice"] == "Give it one of these endings: .png, .glb, .gltf."


@pytest.mark.parametrize(
    ("arguments", "starts"),
    [
        (("--dips", "45/115", "--quiet"), "E100 --dips takes 2 values, and --quiet is an option"),
        (("--dips=45/115", "--json"), "E100 --dips takes 2 values, and --json is an option"),
        (("--dips", *DIPS, "-o", "--quiet"), "E100 -o takes a value, and --quiet is an option"),
        (("--dips", *DIPS, "--c", "--phi=20"), "E100 --c takes a value, and --phi=20 is an option"),
        (("--dips", *DIPS, "--c", "-o", "x"), "E100 --c takes a value, and -o is an option"),
        (("--dips", *DIPS, "--seismic", "-0.1"), "E122 seismic coefficient is -0.1"),
    ],
)
def test_an_option_is_no_value_of_the_option_before_it(arguments, starts, tmp_path) -> None:
    """`--dips 45/115 --quiet` took --quiet for a plane, `-o --quiet` made a folder of that name."""
    run = slopekit("wedge", *arguments, cwd=tmp_path)
    assert run.returncode == 2
    assert run.stderr.startswith(starts)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("missing", ["pyvista", "matplotlib"])
def test_drawing_without_its_extra_says_which(monkeypatch, tmp_path, missing) -> None:
    from slopekit.core import extras
    from slopekit.views.solid.scenes import draw

    found = extras.find_spec
    monkeypatch.setattr(extras, "find_spec", lambda name: None if name == missing else found(name))
    with pytest.raises(sk.DesignError) as caught:
        draw(sk.wedge(dips=DIPS).to_dict(), "scene", tmp_path / "wedge.png")
    assert caught.value.codes == ("E140",)
    assert f"plot ({missing})" in caught.value.faults[0].message


def test_every_code_has_a_test() -> None:
    tests = "".join(path.read_text() for path in Path(__file__).parent.rglob("*.py"))
    assert explanations().keys() - set(re.findall(r"\b[EW][0-9]{3}\b", tests)) - {"E599"} == set()


def test_there_are_few_codes() -> None:
    codes = explanations().keys()
    assert len(codes) <= 250
    assert sum(code.startswith("W") for code in codes) <= 60


def test_most_sheets_of_ordinary_cuts_have_no_notice() -> None:
    """30 random cuts; 500 of them: `python -m benchmarks.ordinary_cuts`."""
    sheets, without = notices_of_sheets(sheets_of_cuts(30, 7))
    assert without >= 2 / 3 * 30
    assert max(sheets.values()) <= 30 / 5


@pytest.mark.parametrize("height", [0.3, 15.0, 900.0])
def test_heights_of_models_and_of_slopes_are_no_slips(height) -> None:
    assert "W302" not in {notice.code for notice in sk.wedge(dips=DIPS, height=height).warnings}


@pytest.mark.parametrize("height", [0.3, 15.0, 900.0])
def test_water_that_stands_little_above_the_blocks_is_no_slip(height) -> None:
    """Heads of 2.9 and 3.1 times the height of the blocks: what lifts a block is a result as any other."""
    total = sk.wedge(dips=DIPS, height=height).geometry.total_height_m
    said = [
        {
            notice.code
            for notice in sk.wedge(
                dips=DIPS, height=height, water=(times * 9.81 * total,) * 2
            ).warnings
        }
        for times in (2.9, 3.1)
    ]
    assert ["W302" in codes for codes in said] == [False, True]


_SLIPS = {"rock": {"unit_weight": 100}, "strength.weak.c": 6000, "slope.height": 15000}
_WET = {"water": {"pressures": {"J1": 5000, "J2": 0}}}
_STUDIES = {
    "sweep": lambda design: sk.sweep(design, {"loads.seismic.k": [0.0]}, closed_form=True),
    "tornado": lambda design: sk.tornado(design, {"loads.seismic.k": "0:0.1"}, closed_form=True),
    "solve": lambda design: sk.solve(design, "loads.seismic.k", fos=1.2),
    "prob": lambda design: sk.prob(design, n=100, by="closed-form"),
    "quake": lambda design: sk.quake(design, ["sine:0.5g,1Hz"]),
    "support": lambda design: sk.support(design, fos=1.5, acts="active", toward="000/10"),
    "check": sk.check,
}


@pytest.mark.parametrize("study", _STUDIES)
def test_every_study_says_the_slips_of_a_design_that_its_run_says(study) -> None:
    scatters = (
        {"strength.weak.phi": {"dist": "normal", "mean": 20, "sd": 2}} if study == "prob" else {}
    )
    for slips, count in ((_SLIPS, 3), (_WET, 1)):
        design = sk.load(path_of("wedge"), set=slips | scatters)
        said = unlikely(sk.run(path_of("wedge"), set=slips))
        assert len(said) == count
        if study in ("support", "quake") and slips is _WET:
            continue  # the water pushes the wedge off its joints: there is nothing to hold or to shake
        found = unlikely(_STUDIES[study](design))
        assert all(any(text.endswith(message) for text in found) for message in said)


def unlikely(found) -> set[str]:
    """What is said of inputs that are likelier slips than meant."""
    return {notice.message for notice in found.warnings if notice.code == "W302"}


def test_a_value_that_a_study_replaces_is_no_slip() -> None:
    design = sk.load(path_of("wedge"), set={"slope.height": 15000})
    swept = sk.sweep(design, {"slope.height": [20.0, 30.0]}, closed_form=True)
    assert not swept.warnings


def test_lint_says_the_slips_that_a_run_says() -> None:
    sets = [
        word
        for key, value in (("rock.unit_weight", 100), ("slope.height", 15000))
        for word in ("--set", f"{key}={value}")
    ]
    sets += ["--set", "rock.density="]
    said = slopekit("lint", str(path_of("wedge")), *sets)
    assert said.returncode == 0
    assert [line.split()[0] for line in said.stdout.splitlines()[-2:]] == ["W302", "W302"]
    document = json.loads(slopekit("lint", str(path_of("wedge")), *sets, "--json").stdout)
    assert [one["code"] for one in document["warnings"]] == ["W302", "W302"]


@pytest.mark.parametrize(
    ("toward", "acts", "said"),
    [
        ("180/10", "active", True),
        ("000/10", "active", False),
        ("180/10", "passive", False),
        ("000/-20", "active", False),
    ],
)
def test_an_active_bolt_that_pulls_out_of_the_face_is_said(toward, acts, said) -> None:
    """It drives the block; `toward` is the direction of the force on it, into a face that dips toward 180."""
    result = sk.wedge(dips=("45/115", "45/245"), bolts=[f"800@{toward},{acts}"])
    messages = [notice.message for notice in result.warnings if notice.code == "W311"]
    assert any("bolt 1 pulls out of the face" in message for message in messages) is said
    bare = sk.wedge(dips=("45/115", "45/245")).fos.limit
    assert not said or result.fos.limit < bare


def test_a_turned_wedge_without_a_factor_has_none(monkeypatch) -> None:
    """No wedge forms, or none moves, with a tenth of a degree less: a factor of 0 would be a number nobody found."""
    monkeypatch.setattr(
        "slopekit.kinds.wedge._limit_with_dip_change",
        lambda design, turn: 0.0 if turn < 0.0 else 0.5,
    )
    (said,) = [
        one.message for one in sk.wedge(dips=("45/178", "45/182")).warnings if one.code == "W301"
    ]
    assert said.endswith(
        "the factor of safety is none or 0.5: it is not settled by the digits of the planes"
    )
