"""Design files of many blocks: each slip with its code and place, good files to their dataclasses, large files."""

import json
import time
from pathlib import Path

import pytest

import slopekit as sk
from slopekit.core.orientation import Line, Plane
from slopekit.core.units import quantity
from slopekit.design.parts import Strength, Water
from slopekit.design.templates import path_of
from slopekit.geometry.sections.polygons import fault_of_polygon
from slopekit.kinds.bench import BenchDesign, JointSetInput
from slopekit.kinds.blocks import BlocksDesign
from slopekit.kinds.topple import ToppleDesign

TOPPLE = """\
slopekit: 1
kind: topple
columns: {dip: 60, width: 10 m, heights: [4, 10, 16], base_step: 1 m, base: slate, sides: joint}
strength:
  slate: {c: 5, phi: 38.15}
  joint: {c: 0, phi: 30}
rock: {unit_weight: 25}
water: {pressures: {base: 5 kPa}}
loads: {seismic: 0.1, forces: [{force: 2013 kN, toward: 270/00, block: C1, at: [1, 0, 2]}]}
support: {bolts: [{force: 200 kN, toward: 090/20, acts: passive, block: C2}]}
analysis: {mechanisms: 3, criterion: all-pairs}
"""
BENCH = """\
slopekit: 1
kind: bench
slope: {face: 70/180, height: 15 m, upper: 5/180, length: 40 m, depth: 12 m}
sets:
  S1: {plane: 45/170, spacing: 2 m, offset: 0.5 m, strength: rough, scatter: 3, spacing_scatter: 20 %}
  S2: {plane: 80/350, spacing: 3 m, strength: joint}
strength:
  rough: {c: 5 kPa, phi: 35}
  joint: {c: 0, phi: 30}
rock: {density: 2600}
cut: {max_blocks: 500, min_volume: 0.01 m3, seed: 7}
water: {mode: dry}
loads: {forces: []}
support: {bolts: []}
analysis: {agree_within: 1 %}
"""
BLOCKS = """\
slopekit: 1
kind: blocks
section: {thickness: 2 m}
contact_tolerance: 1 mm
blocks:
  base: {polygon: [[-7, 7], [0, 0], [12, 0], [12, -2], [-7, -2]], fixed: true}
  B1: {polygon: [[0, 0], [0, 5], [-5, 5]], unit_weight: 20}
  B2: {polygon: [[0, 0], [10, 0], [10, 5], [0, 5]]}
strength: {joint: {c: 0, phi: 30}, smooth: {c: 0, phi: 0}}
interfaces: {default: joint, B2/B1: smooth}
rock: {unit_weight: 25}
water: {pressures: {base/B1: 5 kPa}}
loads: {seismic: {k: 0.1, toward: 090}, forces: [{force: 10, toward: 090/00, block: B1}]}
support: {bolts: []}
analysis: {mechanisms: 1}
"""
DESIGNS = {"topple": TOPPLE, "bench": BENCH, "blocks": BLOCKS}

# code, kind, what of its file is replaced by what, the first line, the line and column it stands at
FAULTS = [
    # columns
    (
        "E101",
        "topple",
        "dip: 60",
        "dip: 95",
        "dip of the columns is 95°, it lies between 0 and 90",
        "3:16",
    ),
    ("E101", "topple", "dip: 60", "dip: 0", "dip of the columns is 0", "3:16"),
    ("E240", "topple", "width: 10 m", "width: 0", "width is 0, it must be more than 0", "3:27"),
    (
        "E240",
        "topple",
        "[4, 10, 16]",
        "[4, -10, 16]",
        "height of C2 is -10, it must be more than 0",
        "3:46",
    ),
    (
        "E240",
        "topple",
        "base_step",
        "thickness: 0 m, base_step",
        "thickness is 0, it must be",
        "3:66",
    ),
    (
        "E240",
        "topple",
        "base_step: 1 m",
        "base_step: -1 m",
        "base_step is -1 m, it lies from 0 to less",
        "3:66",
    ),
    (
        "E240",
        "topple",
        "base_step: 1 m",
        "base_step: 4 m",
        "base_step is 4, it lies from 0 to less than the",
        "3:66",
    ),
    (
        "E109",
        "topple",
        "[4, 10, 16]",
        "[]",
        "columns.heights has no entries, at least 1 needed",
        "3:33",
    ),
    (
        "E176",
        "topple",
        "base: slate",
        "base: slat",
        "base has the strength slat, which is not under",
        "3:77",
    ),
    ("E176", "topple", ", sides: joint", "", "sides names no strength, and there are 2", "3:10"),
    (
        "E195",
        "topple",
        "rock:",
        "  old: {c: 1, phi: 5}\nrock:",
        "the strength old is used by no interface",
        "7:8",
    ),
    (
        "E142",
        "topple",
        "base: 5 kPa}",
        "bases: 5 kPa}",
        "bases is not a key of water.pressures",
        "8:21",
    ),
    (
        "E118",
        "topple",
        "base: 5 kPa}",
        "base: -5 kPa}",
        "water pressure on base is -5 kPa, it is never",
        "8:27",
    ),
    (
        "E107",
        "topple",
        "width: 10 m",
        "width: 10 kPa",
        "width has the unit kPa, which measures a pressure",
        "3:27",
    ),
    ("E143", "topple", "width: 10 m, ", "", "columns.width is missing", "3:1"),
    # benches
    (
        "E116",
        "bench",
        "spacing: 2 m",
        "spacing: 0 m",
        "spacing of S1 is 0, it must be more than 0",
        "5:32",
    ),
    (
        "E116",
        "bench",
        "spacing: 3 m",
        "spacing: -3",
        "spacing of S2 is -3, it must be more than 0",
        "6:32",
    ),
    (
        "E186",
        "bench",
        "scatter: 3,",
        "scatter: -3,",
        "scatter of S1 is -3°, it lies between 0 and 45",
        "5:78",
    ),
    (
        "E186",
        "bench",
        "scatter: 20 %",
        "scatter: 20",
        "spacing_scatter of S1 is 20, it lies between 0 and 1",
        "5:98",
    ),
    (
        "E151",
        "bench",
        "strength:\n",
        "  S3: {plane: 80/350, spacing: 3, strength: joint}\nstrength:\n",
        "S3 has the planes of S2: the same orientation",
        "7:7",
    ),
    (
        "E137",
        "bench",
        "max_blocks: 500",
        "max_blocks: 0.5",
        "max_blocks is 0.5, it must be a whole number",
        "11:19",
    ),
    (
        "E137",
        "bench",
        "max_blocks: 500",
        "max_blocks: 300000",
        "max_blocks is 300000, it must be a whole",
        "11:19",
    ),
    (
        "E137",
        "bench",
        "seed: 7",
        "seed: -1",
        "seed is -1, it must be a whole number from 0",
        "11:51",
    ),
    (
        "E137",
        "bench",
        "agree_within: 1 %",
        "mechanisms: 0",
        "mechanisms is 0, it must be a whole number",
        "15:24",
    ),
    (
        "E137",
        "bench",
        "agree_within: 1 %",
        "mechanisms: 1001",
        "mechanisms is 1001, it must be a whole",
        "15:24",
    ),
    (
        "E116",
        "bench",
        "min_volume: 0.01 m3",
        "min_volume: -1",
        "min_volume is -1 m³, a volume is never",
        "11:36",
    ),
    (
        "E107",
        "bench",
        "min_volume: 0.01 m3",
        "min_volume: 1 m",
        "min_volume has the unit m, which measures a length",
        "11:36",
    ),
    (
        "E109",
        "bench",
        BENCH[BENCH.index("sets:") : BENCH.index("strength:\n")],
        "sets: {}\n",
        "sets has no entries, at least 1 needed",
        "4:1",
    ),
    ("E116", "bench", "height: 15 m", "height: 0", "height is 0, it must be more than 0", "3:31"),
    ("E116", "bench", "depth: 12 m", "depth: -1", "depth is -1, it must be more than 0", "3:72"),
    (
        "E103",
        "bench",
        "plane: 45/170",
        "plane: 170/45",
        "S1 is 170/45: dip and dip direction look swapped",
        "5:15",
    ),
    (
        "E106",
        "bench",
        "depth: 12 m",
        "origin: [1, 2, x]",
        "origin is 'x', a number is needed",
        "3:73",
    ),
    ("E176", "bench", "strength: rough", "strength: rouhg", "S1 has the strength rouhg", "5:62"),
    (
        "E118",
        "bench",
        "mode: dry",
        "mode: full",
        "water is full: in a bench design it is dry, or given by",
        "12:15",
    ),
    ("E118", "bench", "{mode: dry}", "50 %", "water is 50 %: in a bench design it is dry", "12:8"),
    (
        "E118",
        "bench",
        "mode: dry",
        "fill: 50 %",
        "water is 50 %: in a bench design it is dry",
        "12:15",
    ),
    (
        "E112",
        "bench",
        "mode: dry",
        "mode: dry, pressures: {S1: 5}",
        "water has mode and pressures",
        "12:31",
    ),
    (
        "E197",
        "bench",
        "mode: dry",
        "pressures: {S1: 5, S3: 5}",
        "water pressure on S3: there is no such",
        "12:32",
    ),
    (
        "E113",
        "bench",
        "phi: 35",
        "phi: 0.6",
        "phi of rough is 0.6°, that looks like radians",
        "8:26",
    ),
    (
        "E114",
        "bench",
        "c: 5 kPa",
        "c: -5 kPa",
        "c of rough is -5 kPa, cohesion is never negative",
        "8:14",
    ),
    (
        "E115",
        "bench",
        "phi: 35",
        "phi: 90",
        "phi of rough is 90°, a friction angle lies from 0",
        "8:26",
    ),
    (
        "E115",
        "bench",
        "phi: 35",
        "phi: 35, dilation: 40",
        "dilation of rough is 40°, it lies between 0",
        "8:40",
    ),
    ("E143", "bench", "c: 5 kPa, ", "", "strength.rough.c is missing", "8:10"),
    (
        "E112",
        "bench",
        "phi: 35}\n  joint: {c: 0, phi: 30",
        "phi: 35, stiffness: {normal: 1e6}}\n  joint: {c: 0, phi: 30, stiffness: {normal: 2e6}",
        "the strengths have dif",
        "9:37",
    ),
    (
        "E250",
        "bench",
        "forces: []",
        "forces: [5@180/0]",
        "a force does not say where it acts: the bench has many",
        "13:18",
    ),
    (
        "E250",
        "bench",
        "bolts: []",
        "bolts: [200@0/5]",
        "a bolt does not say where it acts",
        "14:19",
    ),
    (
        "E142",
        "bench",
        "agree_within: 1 %",
        "factors: [1, 2]",
        "factors is not a key of analysis",
        "15:12",
    ),
    # the user's own blocks
    (
        "E109",
        "blocks",
        "[[0, 0], [0, 5], [-5, 5]]",
        "[[0, 0], [0, 5]]",
        "blocks.B1.polygon has 2 entries",
        "7:8",
    ),
    (
        "E242",
        "blocks",
        "[0, 5], [-5, 5]]",
        "[0, 5], [0, 7]]",
        "the polygon of B1 bounds no block: it has no area",
        "7:17",
    ),
    (
        "E242",
        "blocks",
        "[0, 5], [-5, 5]]",
        "[0, 0], [-5, 5]]",
        "its points 1 and 2 are the same",
        "7:17",
    ),
    (
        "E242",
        "blocks",
        "[10, 0], [10, 5]",
        "[10, 5], [10, 0]",
        "its sides 1 and 3 cross or touch",
        "8:17",
    ),
    (
        "E106",
        "blocks",
        "[0, 5], [-5, 5]]",
        "[0, five], [-5, 5]]",
        "point 2 of B1 is 'five', a number is",
        "7:30",
    ),
    ("E112", "blocks", ", unit_weight: 20", ", mesh: a.stl", "B1 has polygon and mesh", "7:50"),
    (
        "E112",
        "blocks",
        "polygon: [[0, 0], [0, 5], [-5, 5]]",
        "mesh: a.stl",
        "B1 has a mesh, base has a polygon",
        "7:7",
    ),
    (
        "E143",
        "blocks",
        "polygon: [[0, 0], [0, 5], [-5, 5]], ",
        "",
        "blocks.B1.polygon is missing",
        "7:7",
    ),
    ("E142", "blocks", "B1: {polygon:", "B1: {polygn:", "polygn is not a key of blocks.B1", "7:8"),
    ("E146", "blocks", "  B2:", "  B.2:", "'B.2' under blocks cannot be a name", "8:3"),
    ("E151", "blocks", "  B2:", "  B1:", "blocks.B1 is given twice, in lines 7 and 8", "8:3"),
    ("E126", "blocks", "fixed: true", "fixed: yes", "fixed is 'yes', it is true or false", "6:74"),
    ("E245", "blocks", ", fixed: true", "", "no block is fixed: nothing holds the others", "6:3"),
    (
        "E107",
        "blocks",
        "unit_weight: 20",
        "unit_weight: 2000 kg/m3",
        "unit weight is 2000 kg/m3: that is a density",
        "7:57",
    ),
    (
        "E110",
        "blocks",
        "unit_weight: 20",
        "unit_weight: 2000",
        "unit weight is 2000 kN/m³, out of range",
        "7:57",
    ),
    (
        "E143",
        "blocks",
        "rock: {unit_weight: 25}\n",
        "",
        "B2 has no unit weight, and rock gives none",
        "8:7",
    ),
    (
        "E240",
        "blocks",
        "thickness: 2 m",
        "thickness: 0",
        "thickness is 0, it must be more than 0",
        "3:22",
    ),
    (
        "E116",
        "blocks",
        "tolerance: 1 mm",
        "tolerance: 0",
        "contact_tolerance is 0, it must be more than 0",
        "4:20",
    ),
    ("E247", "blocks", "B2/B1: smooth", "B2/B9: smooth", "B2/B9: there is no block B9", "10:30"),
    (
        "E247",
        "blocks",
        "B2/B1: smooth",
        "B2/B2: smooth",
        "B2/B2: a block has no interface with itself",
        "10:30",
    ),
    ("E247", "blocks", "B2/B1: smooth", "B2-B1: smooth", "B2-B1 is not a pair of blocks", "10:30"),
    (
        "E247",
        "blocks",
        "base/B1: 5 kPa",
        "bass/B1: 5 kPa",
        "bass/B1: there is no block bass",
        "12:21",
    ),
    (
        "E151",
        "blocks",
        "B2/B1: smooth",
        "B2/B1: smooth, B1/B2: joint",
        "B1/B2 is the same interface as B2/B1",
        "10:45",
    ),
    (
        "E176",
        "blocks",
        "default: joint, ",
        "",
        "interfaces.default is missing, and there are 2 strengths",
        "10:13",
    ),
    (
        "E176",
        "blocks",
        "interfaces: {default: joint, B2/B1: smooth}\n",
        "",
        "interfaces.default is missing",
        "9:11",
    ),
    (
        "E176",
        "blocks",
        "default: joint",
        "default: jiont",
        "interfaces.default has the strength jiont",
        "10:23",
    ),
    ("E176", "blocks", "B2/B1: smooth", "B2/B1: smoth", "B2/B1 has the strength smoth", "10:37"),
    (
        "E144",
        "blocks",
        "base/B1: 5 kPa}",
        "base/B1: 5 kPa, base/B2: [5]}",
        "water.pressures.base/B2 is a",
        "12:46",
    ),
    (
        "E250",
        "blocks",
        "block: B1",
        "block: C1",
        "a force acts on C1, there is no such block",
        "13:85",
    ),
    ("E250", "blocks", "block: B1", "block: base", "a force acts on base, which is fixed", "13:85"),
    ("E250", "blocks", ", block: B1", "", "a force names no block, and 2 can move", "13:50"),
    (
        "E252",
        "blocks",
        "toward: 090/00",
        "toward: 180/00",
        "a force leaves the section: x is east, z is up",
        "13:70",
    ),
    (
        "E252",
        "blocks",
        "bolts: []",
        "bolts: [{force: 5, toward: 0/5, block: B1}]",
        "a bolt leaves the section",
        "14:38",
    ),
    (
        "E253",
        "blocks",
        "toward: 090}",
        "toward: 180}",
        "the seismic load acts toward 180, in a section",
        "13:35",
    ),
    ("E253", "blocks", ", toward: 090}", "}", "the seismic load has no direction", "13:18"),
    (
        "E143",
        "blocks",
        "{k: 0.1, toward: 090}",
        "{toward: 090}",
        "loads.seismic.k is missing",
        "13:18",
    ),
    ("E122", "blocks", "toward: 090}", "toward: 900}", "trend of seismic is 900", "13:35"),
    ("E123", "blocks", "force: 10, toward: 090/00, ", "force: 10, ", "force is 10", "13:50"),
    ("E124", "topple", "acts: passive", "acts: both", "it is active or passive", "10:57"),
    (
        "E126",
        "topple",
        "criterion: all-pairs",
        "criterion: pairs",
        "criterion is 'pairs', it is limit or",
        "11:38",
    ),
]


def _written(folder: Path, text: str) -> Path:
    path = folder / "wall.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def _faults(path: Path, **overrides) -> list:
    with pytest.raises(sk.DesignError) as caught:
        sk.load(path, **overrides)
    return list(caught.value.faults)


@pytest.mark.parametrize(
    ("code", "kind", "old", "new", "says", "place"), FAULTS, ids=lambda value: str(value)[:24]
)
def test_one_slip_gives_one_fault_with_its_place(
    code, kind, old, new, says, place, tmp_path
) -> None:
    assert old in DESIGNS[kind]
    (tmp_path / "a.stl").write_bytes(b"any bytes: a mesh is read when it is cut")
    path = _written(tmp_path, DESIGNS[kind].replace(old, new, 1))
    found = _faults(path)
    (fault,) = [fault for fault in found if fault.code == code and says in fault.message]
    assert fault.where.startswith(f"wall.yaml:{place}  ")
    assert len(found) == 1 or code in ("E146", "E151"), (
        found
    )  # a block of that name is missed elsewhere


def test_all_blocks_fixed(tmp_path) -> None:
    text = BLOCKS.replace("unit_weight: 20}", "fixed: true}").replace(
        "[0, 5]]}", "[0, 5]], fixed: True}"
    )
    text = text.replace("forces: [{force: 10, toward: 090/00, block: B1}]", "forces: []")
    (fault,) = _faults(_written(tmp_path, text))
    assert fault.code == "E245"


def test_faults_of_every_part_come_together(tmp_path) -> None:
    text = (
        BLOCKS.replace("thickness: 2", "thickness: -2")
        .replace("[-5, 5]", "[-5, x]")
        .replace("phi: 30", "phi: 95")
        .replace("default: joint", "default: jont")
        .replace("5 kPa", "5 kN")
        .replace("block: B1", "block: B7")
        .replace("mechanisms: 1", "mechanisms: one")
        .replace("unit_weight: 25", "unit_weight: 2.5")
    )
    assert sorted(fault.code for fault in _faults(_written(tmp_path, text))) == [
        "E106",
        "E106",
        "E107",
        "E110",
        "E115",
        "E176",
        "E240",
        "E250",
    ]


# -- good files -------------------------------------------------------------------------------------------------------


def test_columns(tmp_path) -> None:
    design = sk.load(_written(tmp_path, TOPPLE))
    assert isinstance(design, ToppleDesign)
    assert (design.dip_deg, design.width_m, design.heights_m, design.base_step_m) == (
        60.0,
        10.0,
        (4.0, 10.0, 16.0),
        1,
    )
    assert (design.base, design.sides, design.pressures_kpa) == ("slate", "joint", (5.0, 0.0))
    assert design.strengths == (("slate", Strength(5.0, 38.15)), ("joint", Strength(0.0, 30.0)))
    assert design.strength("joint").friction_angle_deg == 30.0
    assert (design.mechanisms, design.analysis.criterion, design.thickness_m) == (
        3,
        "all-pairs",
        1.0,
    )
    assert (design.seismic.coefficient, design.seismic.trend_deg) == (0.1, 270.0)
    assert design.water == Water("pressures", 0.0, (5.0, 0.0))
    (force,), (bolt,) = design.forces, design.bolts
    assert force.components_kn == pytest.approx((-2013.0, 0.0, 0.0), abs=1e-9)
    assert (force.at_m, force.block) == ((1.0, 0.0, 2.0), "C1")
    assert (bolt.force_kn, bolt.toward, bolt.acts, bolt.block) == (
        200.0,
        Line(90.0, 20.0),
        "passive",
        "C2",
    )
    assert design.block_names == ("C1", "C2", "C3")


def test_bench(tmp_path) -> None:
    design = sk.load(_written(tmp_path, BENCH))
    assert isinstance(design, BenchDesign)
    assert (design.face, design.upper, design.height_m) == (Plane(70, 180), Plane(5, 180), 15.0)
    assert (design.length_m, design.depth_m, design.max_blocks, design.min_volume_m3) == (
        40.0,
        12.0,
        500,
        0.01,
    )
    assert design.seed == 7
    assert design.rock.unit_weight_kn_m3 == pytest.approx(2.6 * 9.81)
    assert design.sets == (
        JointSetInput("S1", Plane(45, 170), 2.0, "rough", 0.5, 3.0, 0.2),
        JointSetInput("S2", Plane(80, 350), 3.0, "joint"),
    )
    assert "upper" not in design.reading.defaults


def test_bench_defaults(tmp_path) -> None:
    text = BENCH.replace(", upper: 5/180, length: 40 m, depth: 12 m", ", origin: [1, 2, 3]")
    text = text.replace(
        "loads: {forces: []}", "loads: {seismic: 0.1, forces: [{force: [0, -5, 0], at: [0, 1, 2]}]}"
    )
    text = text.replace("mode: dry", "pressures: {S2: 0.5 kPa}")
    design = sk.load(_written(tmp_path, text))
    assert (design.upper, design.length_m, design.depth_m, design.origin_m) == (
        Plane(0, 180),
        30.0,
        15.0,
        (1, 2, 3),
    )
    assert set(design.reading.defaults) >= {"upper", "length", "depth", "seismic.trend"}
    assert design.seismic.trend_deg == 180.0
    assert [one.pressure_kpa for one in design.sets] == [0.0, 0.5]
    assert design.forces[0].block is None


def test_blocks(tmp_path) -> None:
    design = sk.load(_written(tmp_path, BLOCKS))
    assert isinstance(design, BlocksDesign)
    base, first, second = design.blocks
    assert (base.name, base.fixed, first.fixed, first.unit_weight_kn_m3) == (
        "base",
        True,
        False,
        20.0,
    )
    assert first.polygon_m == ((0.0, 0.0), (0.0, 5.0), (-5.0, 5.0))
    assert (second.unit_weight_kn_m3, design.rock.unit_weight_kn_m3, design.in_section) == (
        None,
        25.0,
        True,
    )
    assert (design.default_strength, design.interfaces) == ("joint", (("B2", "B1", "smooth"),))
    assert design.pressures_kpa == (("base", "B1", 5.0),)
    assert (design.thickness_m, design.contact_tolerance_m) == (2.0, 0.001)
    assert design.seismic.trend_deg == 90.0


def test_meshes_are_known_by_their_content(tmp_path) -> None:
    for name in ("ground", "block"):
        (tmp_path / f"{name}.stl").write_bytes(name.encode())
    text = (
        "slopekit: 1\nkind: blocks\nblocks: {ground: {mesh: ground.stl, fixed: true}, B1: {mesh: block.stl}}\n"
        "strength: {joint: {c: 0, phi: 30}}\nrock: {unit_weight: 25}\n"
        "loads: {seismic: 0.1@200, forces: [10@200/5]}\n"
    )
    design = sk.load(_written(tmp_path, text))
    assert not design.in_section
    assert (design.default_strength, design.blocks[1].mesh.name, design.forces[0].block) == (
        "joint",
        "block.stl",
        "B1",
    )
    (fault,) = _faults(_written(tmp_path, text.replace("block.stl", "blok.stl")))
    assert (fault.code, fault.advice.startswith("Did you mean")) == ("E172", True)
    (fault,) = _faults(_written(tmp_path, text + "section: {thickness: 1}\n"))
    assert fault.code == "E112"


def test_blocks_with_weights_of_their_own_need_no_rock(tmp_path) -> None:
    text = BLOCKS.replace("rock: {unit_weight: 25}\n", "").replace(
        "[0, 5]]}", "[0, 5]], unit_weight: 22}"
    )
    assert sk.load(_written(tmp_path, text)).rock.unit_weight_kn_m3 == 20.0


def test_polygons_may_run_either_way_and_close(tmp_path) -> None:
    closed = BLOCKS.replace("[-5, 5]]", "[-5, 5], [0, 0]]")
    assert (
        sk.load(_written(tmp_path, closed)).input_hash()
        == sk.load(_written(tmp_path, BLOCKS)).input_hash()
    )
    sk.load(
        _written(tmp_path, BLOCKS.replace("[[0, 0], [0, 5], [-5, 5]]", "[[-5, 5], [0, 5], [0, 0]]"))
    )


OVERRIDES = [
    ("topple", "columns.heights", "[5, 6]", "[4, 10, 16]", "[5, 6]"),
    ("topple", "columns.heights.1", "12", "[4, 10, 16]", "[4, 12, 16]"),
    ("topple", "strength.joint.phi", "25", "phi: 30", "phi: 25"),
    ("bench", "sets.S1.spacing", "3", "spacing: 2 m", "spacing: 3"),
    ("bench", "slope.face.dip", "65", "70/180", "65/180"),
    ("bench", "water.pressures", "{S1: 5}", "mode: dry", "pressures: {S1: 5}"),
    ("bench", "cut.seed", "8", "seed: 7", "seed: 8"),
    ("blocks", "blocks.B1.unit_weight", "21", "unit_weight: 20", "unit_weight: 21"),
    ("blocks", "interfaces.B2/B1", "joint", "B2/B1: smooth}", "B2/B1: joint}"),
    ("blocks", "blocks.B1.polygon.2", "[-4, 4]", "[-5, 5]", "[-4, 4]"),
]


@pytest.mark.parametrize(
    ("kind", "key", "value", "old", "new"), OVERRIDES, ids=lambda value: str(value)[:20]
)
def test_set_is_the_same_as_editing_the_file(kind, key, value, old, new, tmp_path) -> None:
    text = DESIGNS[kind].replace(
        "smooth: {c: 0, phi: 0}", "smooth: {c: 0, phi: 0}" if "B2/B1" not in key else ""
    )
    text = text.replace("B2/B1: smooth}", "B2/B1: joint}") if "interfaces" in key else text
    edited = sk.load(_written(tmp_path, text.replace(old, new, 1)))
    path = _written(tmp_path, text)
    assert sk.load(path, set={key: value}).input_hash() == edited.input_hash()


def test_a_mapping_takes_the_path_of_the_file(tmp_path) -> None:
    mapping = {
        "slopekit": 1,
        "kind": "bench",
        "slope": {
            "face": (70, 180),
            "height": 15,
            "upper": Plane(5, 180),
            "length": 40,
            "depth": 12,
        },
        "sets": {
            "S1": {
                "plane": "45/170",
                "spacing": 2,
                "offset": 0.5,
                "strength": "rough",
                "scatter": 3,
                "spacing_scatter": 0.2,
            },
            "S2": {"plane": "80/350", "spacing": 3, "strength": "joint"},
        },
        "strength": {"rough": {"c": 5, "phi": 35}, "joint": {"c": 0, "phi": 30}},
        "rock": {"density": 2600},
        "cut": {"max_blocks": 500, "min_volume": 0.01, "seed": 7},
    }
    assert sk.load(mapping).input_hash() == sk.load(_written(tmp_path, BENCH)).input_hash()


def test_distributions_take_their_mean_and_say_so(tmp_path) -> None:
    text = BENCH.replace("spacing: 2 m", "spacing: {dist: lognormal, mean: 2 m, sd: 50 cm}")
    text = text.replace("plane: 80/350", "plane: {dist: fisher, mean: 80/350, k: 50}")
    text += "correlation: {}\n"
    design = sk.load(_written(tmp_path, text))
    assert design.input_hash() == sk.load(_written(tmp_path, BENCH)).input_hash()
    assert design.assumed == (("sets.S1.spacing", "2"), ("sets.S2.plane", "80/350"))
    heights = sk.load(
        _written(tmp_path, TOPPLE),
        set={"columns.heights.2": "{dist: uniform, min: 15 m, max: 17 m}"},
    )
    assert heights.heights_m == (4.0, 10.0, 16.0)
    pressed = sk.load(
        _written(tmp_path, TOPPLE),
        set={"water.pressures.base": "{dist: normal, mean: 5 kPa, sd: 1}"},
    )
    assert pressed.pressures_kpa == (5.0, 0.0)


@pytest.mark.parametrize("kind", DESIGNS)
def test_inputs_are_json_and_hashes_follow_them(kind, tmp_path) -> None:
    design = sk.load(_written(tmp_path, DESIGNS[kind]))
    assert design.kind == kind
    assert json.loads(json.dumps(design.inputs(), allow_nan=False)) == design.inputs()
    assert design.inputs()["mechanisms"] == design.mechanisms
    again = sk.load(_written(tmp_path, "# a remark\n" + DESIGNS[kind]))
    assert again.input_hash() == design.input_hash()
    assert again == design
    other = sk.load(_written(tmp_path, DESIGNS[kind]), set={"analysis.mechanisms": 9})
    assert other.input_hash() != design.input_hash()


TEMPLATES = {
    "goodman-bray": (ToppleDesign, 16),
    "topple": (ToppleDesign, 6),
    "bench": (BenchDesign, 3),
    "blocks": (BlocksDesign, 3),
    "wall": (BlocksDesign, 15),
}


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates(name) -> None:
    kind, count = TEMPLATES[name]
    design = sk.load(path_of(name))
    assert type(design) is kind
    parts = {"topple": "heights_m", "bench": "sets", "blocks": "blocks"}[design.kind]
    assert len(getattr(design, parts)) == count


# -- polygons, units, large files -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("points", "says"),
    [
        ([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)], None),  # not convex
        ([(0, 0), (2, 0), (4, 0), (4, 1), (0, 1)], None),  # a point within a side
        ([(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)], "cross or touch"),  # a corner on another side
        ([(0, 0), (4, 0), (2, 0), (2, 2)], "cross or touch"),  # a spike
        (
            [(0, 0), (3, 4), (-2, 1), (4, 1), (-1, 4)],
            "cross or touch",
        ),  # a star turns one way, but twice around
        ([(0, 0), (1, 1)], "fewer than three"),
        ([(1e6, 1e6), (1e6 + 2, 1e6), (1e6 + 2, 1e6 + 1)], None),  # map coordinates
    ],
)
def test_polygons(points, says) -> None:
    for turn in (1, -1):
        found = fault_of_polygon(points[::turn])
        assert (found is None) == (says is None)
        assert says is None or says in found


def test_volumes_have_units() -> None:
    assert quantity("500 dm3", "volume", "v") == 0.5
    assert quantity("0.01 m³", "volume", "v") == 0.01
    with pytest.raises(sk.DesignError) as caught:
        quantity("5 l", "volume", "v")
    assert caught.value.codes == ("E108",)


def _large(count: int) -> str:
    rows = [
        f"  B{k}: {{polygon: [[{k}, 0.5], [{k + 1}, .5], [{k + 1}, 1.5e0], [ {k} ,+1.5]], unit_weight: {20 + k % 5}}}"
        for k in range(count)
    ]
    head = "slopekit: 1\nkind: blocks\ntitle: a [1, 2] b  # of [[1, 2], [3, 4]]\nblocks:\n"
    base = "  base: {polygon: [[0, 0],\n    [9, 0], [9, -1]], fixed: true}\n"
    return (
        head
        + base
        + "\n".join(rows)
        + "\nstrength: {joint: {c: 0, phi: 30}}\nrock: {unit_weight: 25}\n"
    )


def test_a_slip_in_a_large_file_is_found_where_it_stands(tmp_path) -> None:
    text = _large(400)
    (fault,) = _faults(_written(tmp_path, text.replace("B7: {", "B7: [", 1)))
    assert (fault.code, fault.where.split("  ")[0]) == ("E150", "wall.yaml:14:77")
    (fault,) = _faults(_written(tmp_path, text.replace("[8, .5]", "[8, x.5]", 1)))
    assert (fault.code, fault.where.split("  ")[0]) == ("E106", "wall.yaml:14:32")


def test_reading_stays_linear() -> None:
    """From Python, four times the blocks take about four times as long (1.5 s for ten thousand on two cores)."""

    def seconds(count: int) -> float:
        square = [[0, 0], [1, 0], [1, 1], [0, 1]]
        blocks = {f"B{k}": {"polygon": square} for k in range(count)} | {
            "base": {"polygon": square, "fixed": True}
        }
        pairs = {"default": "joint"} | {f"B{k}/B{k + 1}": "joint" for k in range(count - 1)}
        design = {
            "slopekit": 1,
            "kind": "blocks",
            "blocks": blocks,
            "interfaces": pairs,
            "strength": {"joint": {"c": 0, "phi": 30}},
            "rock": {"unit_weight": 25},
        }
        start = time.process_time()
        assert len(sk.load(design).blocks) == count + 1
        return time.process_time() - start

    seconds(50)
    assert seconds(2000) < 12.0 * seconds(500)
