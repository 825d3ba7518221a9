"""Design files from text to a checked design: every fault of this layer with its first line and its place."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

import slopekit as sk
from slopekit.core.orientation import Line
from slopekit.design.reading.files import load
from slopekit.design.templates import path_of
from slopekit.geometry.solids import meshes, sliding_mass

WEDGE = """\
slopekit: 1
kind: wedge
slope: {face: 65/185, upper: 12/195, height: 30 m}
joints:
  J1: {plane: 45/105, strength: rough}
  J2: {plane: 70/235, strength: clay}
strength:
  rough: {c: 24 kPa, phi: 30}
  clay: {c: 48, phi: 20}
rock: {unit_weight: 25}
water: {mode: dry}
loads: {seismic: 0, forces: []}
support: {bolts: []}
analysis: {agree_within: 1 %}
acceptance: {rules: ["fos >= 1.3"]}
"""
PLANE = """\
slopekit: 1
kind: plane
slope: {face: 60/180, height: 12 m}
joints: {J1: {plane: 35/180}}
crack: {depth: 4.35 m, water: 3 m}
strength: {bedding: {c: 25 kPa, phi: 37}}
rock: {unit_weight: 26}
"""
FOOTING = """\
slopekit: 1
kind: footing
footing: {load: 2000 kN, at: 2.5 m}
weak_plane: {dip: 40, length: 8 m, pairs: 9}
strength: {seam: {c: 120, phi: 25}}
"""
SURFACE = """\
slopekit: 1
kind: surface
slope: {profile: [[60, 0], [40, 0], [0, 40], [-20, 40]]}
slip: {shape: sphere, centre: [44, 0, 44], radius: 44}
strength: {zone: {c: 25, phi: 28}}
rock: {unit_weight: 22}
"""
DESIGNS = {"wedge": WEDGE, "plane": PLANE, "footing": FOOTING, "surface": SURFACE}
LIST = "name,dip,dip direction,c,phi,remark\nA,45,105,24,30,\nB,70,235,48,20,wet\nC,50,240,,,\n"

# code, kind, what of its file is replaced by what, the first line, the line and column it stands at
FAULTS = [
    # files.py and inputs.py: what the file says of names, versions, files
    (
        "E174",
        "wedge",
        "slopekit: 1",
        "slopekit: 2",
        "slopekit: 2 is not a version of design files",
        "1:11",
    ),
    ("E174", "wedge", "kind: wedge", "kind: wegde", "wegde is not a kind of design", "2:7"),
    ("E174", "wedge", "kind: wedge", "title: x", "kind is missing", "1:1"),
    (
        "E174",
        "wedge",
        "kind: wedge",
        "input_sha256: 10f28a",
        "these are results of slopekit, not a design",
        "1:1",
    ),
    (
        "E174",
        "wedge",
        "kind: wedge",
        "kind: [wedge]",
        "kind is one word, not a list or keys",
        "2:7",
    ),
    (
        "E109",
        "wedge",
        "  J2:",
        "  J3: {plane: 1/1, strength: clay}\n  J2:",
        "a wedge has two joints, 3 are given",
        "5:3",
    ),
    (
        "E109",
        "plane",
        "{J1: {plane: 35/180}}",
        "{A: {plane: 1/2}, B: {plane: 1/2}}",
        "a plane has one joint, 2 are",
        "4:9",
    ),
    (
        "E176",
        "wedge",
        "strength: clay",
        "strength: claye",
        "J2 has the strength claye, which is not under",
        "6:33",
    ),
    ("E176", "wedge", ", strength: clay", "", "J2 names no strength, and there are 2", "6:7"),
    (
        "E195",
        "wedge",
        "rock:",
        "  old: {c: 1, phi: 5}\nrock:",
        "the strength old is used by no interface",
        "10:8",
    ),
    ("E112", "wedge", "phi: 20", "phi: 20, stiffness: {normal: 5}", None, None),
    ("E143", "wedge", "c: 48, ", "", "strength.clay.c is missing", "9:9"),
    ("E143", "footing", "c: 120, ", "", "strength.seam.c is missing", "5:18"),
    ("E143", "plane", "depth: 4.35 m, ", "", "crack.depth is missing", "5:8"),
    (
        "E143",
        "surface",
        "slope: {profile: [[60, 0], [40, 0], [0, 40], [-20, 40]]}\n",
        "",
        "slope is missing",
        "1:1",
    ),
    ("E143", "surface", "shape: sphere, ", "", "slip.shape is missing", "4:7"),
    (
        "E112",
        "surface",
        "shape: sphere",
        "mesh: a.stl, shape: sphere",
        "slip has mesh and shape",
        "4:14",
    ),
    (
        "E197",
        "wedge",
        "mode: dry",
        "pressures: {J1: 5, K2: 6}",
        "water pressure on K2: there is no such",
        "11:32",
    ),
    (
        "E112",
        "wedge",
        "mode: dry",
        "mode: full, pressures: 5",
        "water has mode and pressures",
        "11:32",
    ),
    (
        "E112",
        "plane",
        "rock:",
        "water: {mode: full}\nrock:",
        "crack.water and water both say how full it is",
        "5:31",
    ),
    (
        "E172",
        "surface",
        "shape: sphere, centre: [44, 0, 44], radius: 44",
        "mesh: gone.stl",
        "the mesh gone.stl cannot be read: gone.stl does not exist",
        "4:14",
    ),
    (
        "E172",
        "surface",
        "profile: [[60, 0], [40, 0], [0, 40], [-20, 40]]",
        "mesh: .",
        "the mesh . cannot be read:",
        "3:15",
    ),
    # reading_kinds.py: values of plane, footing and surface
    (
        "E101",
        "footing",
        "dip: 40",
        "dip: 89.95",
        "dip of the weak plane is 89.95°, it lies between 0 and 89.9",
        "4:19",
    ),
    (
        "E116",
        "footing",
        "length: 8 m",
        "length: -8 m",
        "length is -8, it must be more than 0",
        "4:31",
    ),
    ("E123", "footing", "load: 2000 kN", "load: 0", "load is 0, it must be more than 0", "3:17"),
    (
        "E118",
        "footing",
        "at: 2.5 m",
        "at: -1",
        "place of the load is -1 m, it is never negative",
        "3:30",
    ),
    (
        "E137",
        "footing",
        "pairs: 9",
        "pairs: 10",
        "pairs is 10, it must be an odd number from 3",
        "4:43",
    ),
    ("E120", "plane", "depth: 4.35 m", "depth: 0", "depth is 0, it must be more than 0", "5:16"),
    (
        "E118",
        "plane",
        "water: 3 m",
        "water: -3 m",
        "water in the crack is -3 m, it is never negative",
        "5:31",
    ),
    (
        "E109",
        "plane",
        "crack: {depth: 4.35 m, water: 3 m}",
        "water: {pressures: [5, 6]}",
        "2 water pressures given",
        "5:20",
    ),
    (
        "E118",
        "surface",
        "rock:",
        "water: full\nrock:",
        "how full a curved surface is says no pressure",
        "6:8",
    ),
    (
        "E109",
        "surface",
        "[40, 0]",
        "[60, 0]",
        "point 2 of the profile is the same as an earlier",
        "3:28",
    ),
    ("E109", "surface", "[44, 0, 44]", "[44, 44]", "the centre of a sphere is x, y, z", "4:31"),
    (
        "E170",
        "surface",
        "shape: sphere",
        "shape: blob",
        "shape is 'blob', it is ellipsoid or sphere or",
        "4:15",
    ),
    (
        "E170",
        "surface",
        "radius: 44",
        "radius: 44, radii: [1, 2, 3]",
        "slip.radii says nothing of the shape",
        "4:63",
    ),
    (
        "E170",
        "surface",
        "radius: 44",
        "radius: 44, normals: smooth",
        "normals is 'smooth', it is true or",
        "4:65",
    ),
    (
        "E170",
        "surface",
        "shape: sphere, centre: [44, 0, 44], radius: 44",
        "mesh: sheet.stl, radius: 4",
        "slip.radius says nothing beside a mesh",
        "4:33",
    ),
    ("E116", "surface", "radius: 44", "radius: 0 m", "radius is 0, it must be more than 0", "4:52"),
    (
        "E116",
        "surface",
        "radius: 44",
        "radius: 44, edge: -1",
        "edge is -1, it must be more than 0",
        "4:62",
    ),
    # words.py: water, cracks, loads, bolts, rules, stiffness
    (
        "E118",
        "wedge",
        "mode: dry",
        "fill: 120 %",
        "water fills 120 % of the joints, more than all",
        "11:15",
    ),
    ("E118", "wedge", "mode: dry", "mode: wet", "water is 'wet', which is not understood", "11:15"),
    (
        "E118",
        "wedge",
        "mode: dry",
        "pressures: [-5, 0]",
        "water pressure on J1 is -5 kPa, it is never",
        "11:21",
    ),
    (
        "E109",
        "wedge",
        "mode: dry",
        "pressures: [1, 2, 3]",
        "3 water pressures given, there are J1 and J2",
        "11:20",
    ),
    (
        "E120",
        "wedge",
        "rock:",
        "crack: {plane: 80/185, distance: 0}\nrock:",
        "crack distance is 0",
        "10:34",
    ),
    (
        "E122",
        "wedge",
        "seismic: 0",
        "seismic: 3",
        "seismic coefficient is 3, it lies between 0 and 2",
        "12:18",
    ),
    (
        "E122",
        "wedge",
        "seismic: 0",
        "seismic: {k: 0.1, toward: 400}",
        "trend of seismic is 400",
        "12:35",
    ),
    (
        "E123",
        "wedge",
        "forces: []",
        "forces: [1@0/0, 5 kN]",
        "force is 5 kN, it is written 500kN@180/10",
        "12:37",
    ),
    (
        "E123",
        "wedge",
        "forces: []",
        "forces: [5@180]",
        "direction of force is 180, it is written trend/plunge",
        "12:30",
    ),
    (
        "E124",
        "wedge",
        "bolts: []",
        "bolts: [200@000/10, '200@000/100']",
        "plunge of bolt is 100",
        "13:31",
    ),
    (
        "E124",
        "wedge",
        "bolts: []",
        "bolts: [{force: 2, toward: 0/5, acts: on}]",
        "it is active or passive",
        "13:49",
    ),
    ("E127", "wedge", "fos >= 1.3", "fos >= -1", "accept is -1, it must be more than 0", "15:22"),
    ("E169", "wedge", "fos >= 1.3", "fs >= 1.3", "fs is nothing that a rule can judge", "15:22"),
    (
        "E169",
        "wedge",
        "fos >= 1.3",
        "fos is 1.3",
        "the rule 'fos is 1.3' is not understood",
        "15:22",
    ),
    (
        "E127",
        "plane",
        "phi: 37",
        "phi: 37, stiffness: {shear: {k1: 0}}",
        "k1 is 0, it must be more than 0",
        "6:66",
    ),
    (
        "E127",
        "plane",
        "phi: 37",
        "phi: 37, stiffness: {shear: {law: linear}}",
        "linear is no shear law",
        "6:67",
    ),
    (
        "E127",
        "plane",
        "phi: 37",
        "phi: 37, stiffness: {shear: {k1: 100, n: 2.5}}",
        "n is 2.5, it lies between 0 and 2",
        "6:74",
    ),
    # reader.py and units.py: the same words in every kind
    ("E105", "plane", "height: 12 m", "height: nan", "height is nan, not a finite number", "3:31"),
    ("E106", "surface", "c: 25", "c: many", "c of zone is 'many', a number is needed", "5:22"),
    (
        "E107",
        "plane",
        "unit_weight: 26",
        "unit_weight: 2600 kg/m3",
        "unit weight is 2600 kg/m3: that is a density",
        "7:21",
    ),
    (
        "E112",
        "plane",
        "unit_weight: 26",
        "unit_weight: 26, density: 2600",
        "density and unit weight are both given",
        None,
    ),
    (
        "E113",
        "wedge",
        "phi: 30",
        "phi: 0.35",
        "phi of rough is 0.35°, that looks like radians",
        "8:27",
    ),
    (
        "E115",
        "plane",
        "phi: 37",
        "phi: 37, dilation: 40",
        "dilation of bedding is 40°, it lies between 0 and the friction angle",
        "6:52",
    ),
    (
        "E126",
        "plane",
        "rock:",
        "analysis: {criterion: all}\nrock:",
        "criterion is 'all', it is limit or all-pairs",
        "7:23",
    ),
    (
        "E127",
        "plane",
        "rock:",
        "analysis: {factors: [1, 0]}\nrock:",
        "factor is 0, it must be more than 0",
        "7:25",
    ),
    (
        "E137",
        "plane",
        "rock:",
        "analysis: {refine: 9}\nrock:",
        "refine is 9, it must be a whole number",
        "7:20",
    ),
]


def _written(folder: Path, text: str) -> Path:
    path = folder / "wall.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def _faults(path: Path, overrides=()) -> list:
    with pytest.raises(sk.DesignError) as caught:
        load(path, overrides)
    return list(caught.value.faults)


@pytest.mark.parametrize(
    ("code", "kind", "old", "new", "says", "place"), FAULTS, ids=lambda value: str(value)[:24]
)
def test_one_slip_gives_one_fault_with_its_place(
    code, kind, old, new, says, place, tmp_path
) -> None:
    assert old in DESIGNS[kind]
    path = _written(tmp_path, DESIGNS[kind].replace(old, new, 1))
    if says is None:  # allowed
        load(path)
        return
    (tmp_path / "sheet.stl").write_bytes(b"any bytes: a mesh is read when it is cut")
    faults = [fault for fault in _faults(path) if fault.code == code and says in fault.message]
    assert len(faults) == 1
    assert len(_faults(path)) == 1 or code in ("E112", "E174")
    assert faults[0].where.startswith("wall.yaml:")
    if place is not None:
        assert faults[0].where.startswith(f"wall.yaml:{place}  ")


def test_different_stiffness_of_two_strengths_is_refused(tmp_path) -> None:
    text = WEDGE.replace("phi: 30", "phi: 30, stiffness: {normal: 1e6}").replace(
        "phi: 20", "phi: 20, stiffness: {normal: 5}"
    )
    (fault,) = _faults(_written(tmp_path, text))
    assert (fault.code, fault.where[:14]) == ("E112", "wall.yaml:9:37")


def test_every_fault_of_structure_names_and_values_at_once(tmp_path) -> None:
    text = (
        WEDGE.replace("face: 65/185", "face: 185/65")
        .replace("height:", "hieght:")
        .replace("strength: rough", "strength: ruogh")
        .replace("phi: 20", "phi: twenty")
        .replace("unit_weight: 25", "unit_weight: 2650")
        .replace("mode: dry", "mode: wet")
        .replace("fos >= 1.3", "fos > ")
        .replace("bolts: []", "bolts: 5")
        .replace("forces: []", "forces: [[1, 2], 9@0/0, 7]")
    )
    found = [
        (fault.code, fault.where.split("  ")[0].removeprefix("wall.yaml:"))
        for fault in _faults(_written(tmp_path, text))
    ]
    assert sorted(found) == sorted(
        [
            ("E103", "3:15"),
            ("E142", "3:38"),
            ("E176", "5:33"),
            ("E106", "9:22"),
            ("E110", "10:21"),
            ("E118", "11:15"),
            ("E109", "12:30"),
            ("E123", "12:45"),
            ("E144", "13:18"),
            ("E169", "15:22"),
        ]
    )


def test_a_wedge_from_the_file_is_the_wedge_from_the_call(tmp_path) -> None:
    from_file = sk.run(_written(tmp_path, WEDGE))
    called = sk.wedge(
        dips=("45/105", "70/235"),
        face="65/185",
        upper="12/195",
        height=30,
        c=(24, 48),
        phi=(30, 20),
        unit_weight=25,
        accept=1.3,
    )
    assert from_file.fos == called.fos
    assert from_file.design.input_hash() == called.design.input_hash()
    assert from_file.exit_code == called.exit_code


OVERRIDES = [
    ("strength.rough.phi", "25", "phi: 30", "phi: 25"),
    ("water.fill", "50 %", "mode: dry", "fill: 50 %"),
    ("joints.J2.plane", "65/240", "70/235", "65/240"),
    ("support.bolts", "[200@005/10]", "bolts: []", "bolts: [200@005/10]"),
    ("rock.density", "2700 kg/m3", "unit_weight: 25", "density: 2700 kg/m3"),
    (
        "crack",
        "{plane: 80/185, distance: 3 m}",
        "rock:",
        "crack: {plane: 80/185, distance: 3 m}\nrock:",
    ),
]


@pytest.mark.parametrize(
    ("key", "value", "old", "new"), OVERRIDES, ids=lambda value: str(value)[:20]
)
def test_set_is_the_same_as_editing_the_file(key, value, old, new, tmp_path) -> None:
    edited = sk.load(_written(tmp_path, WEDGE.replace(old, new, 1)))
    path = _written(tmp_path, WEDGE)
    assert load(path, [(key, value)]).input_hash() == edited.input_hash()
    assert sk.load(path, set={key: value}).input_hash() == edited.input_hash()
    assert edited.input_hash() != sk.load(path).input_hash()


def test_a_fault_in_a_set_value_names_the_set(tmp_path) -> None:
    (fault,) = _faults(_written(tmp_path, WEDGE), [("strength.rough.phi", "0.3")])
    assert (fault.code, fault.where) == ("E113", "--set strength.rough.phi=0.3")


def test_faults_of_a_set_earthquake_name_their_own_keys_at_once(tmp_path) -> None:
    shaken = WEDGE.replace("seismic: 0", "seismic: {k: 0, toward: 180}")
    faults = _faults(
        _written(tmp_path, shaken), [("loads.seismic.k", "-1"), ("loads.seismic.toward", "500")]
    )
    assert [fault.where for fault in faults] == [
        "--set loads.seismic.k=-1",
        "--set loads.seismic.toward=500",
    ]


def test_a_mapping_takes_the_path_of_the_file(tmp_path) -> None:
    mapping = {
        "slopekit": 1,
        "kind": "plane",
        "slope": {"face": (60, 180), "height": 12},
        "joints": {"J1": {"plane": "35/180"}},
        "crack": {"depth": 4.35, "water": 3},
        "strength": {"bedding": {"c": 25, "phi": 37}},
        "rock": {"unit_weight": 26},
    }
    assert sk.load(mapping).input_hash() == sk.load(_written(tmp_path, PLANE)).input_hash()


def test_distributions_take_their_mean_and_say_so(tmp_path) -> None:
    text = PLANE.replace("phi: 37", "phi: {dist: normal, mean: 37, sd: 2}").replace(
        "c: 25 kPa", "c: {dist: uniform, min: 20 kPa, max: 30 kPa}"
    )
    result, plain = sk.run(_written(tmp_path, text)), sk.run(_written(tmp_path, PLANE))
    assert result.fos == plain.fos
    assert result.design.input_hash() == plain.design.input_hash()
    assert [notice.message for notice in result.warnings if notice.code == "W320"] == [
        "distributions are taken at their means: strength.bedding.c 25, strength.bedding.phi 37",
    ]
    assert result.to_dict()["assumed"] == {"strength.bedding.c": "25", "strength.bedding.phi": "37"}


def test_correlation_is_checked_by_the_names_of_joints_and_strengths(tmp_path) -> None:
    text = WEDGE.replace("phi: 30", "phi: {dist: normal, mean: 30, sd: 2}")
    text = text.replace("phi: 20", "phi: {dist: normal, mean: 20, sd: 2}")
    for pair in ("J1.phi/J2.phi", "rough.phi/clay.phi", "strength.rough.phi/J2.phi"):
        load(_written(tmp_path, f"{text}correlation: {{{pair}: 0.5}}\n"))
    (fault,) = _faults(_written(tmp_path, f"{text}correlation: {{J1.phi/J2.c: 0.5}}\n"))
    assert fault.code == "E168"


SCATTER = WEDGE.replace("phi: 30", "phi: {dist: normal, mean: 30, sd: 2}").replace(
    "phi: 20", "phi: {dist: normal, mean: 20, sd: 2}"
)


def test_a_design_knows_what_of_it_scatters(tmp_path) -> None:
    text = SCATTER.replace("plane: 45/105", "plane: {dist: fisher, mean: 45/105, k: 200}")
    text = text.replace(
        "face: 65/185", "face: {dip: {dist: uniform, min: 60, max: 70}, dip_direction: 185}"
    )
    pairs = "J1.phi/J2.phi: 0.5, J1.plane/slope.face: 0.3, J1.plane.dip_direction/clay.phi: -0.2"
    design = sk.load(_written(tmp_path, f"{text}correlation: {{{pairs}}}\n"))
    assert {
        variable.path: type(variable.distribution).__name__ for variable in design.variables
    } == {
        "slope.face": "Angles",
        "joints.J1.plane": "Fisher",
        "strength.rough.phi": "Distribution",
        "strength.clay.phi": "Distribution",
    }
    assert design.correlation == (
        ("strength.rough.phi", "strength.clay.phi", 0.5),
        ("joints.J1.plane.dip", "slope.face.dip", 0.3),
        ("joints.J1.plane.dip_direction", "strength.clay.phi", -0.2),
    )
    assert dict(design.assumed) == {
        "slope.face.dip": "65",
        "joints.J1.plane": "45/105",
        "strength.rough.phi": "30",
        "strength.clay.phi": "20",
    }
    assert design.variables[0].location.startswith("wall.yaml:3:15")
    assert design == sk.load(_written(tmp_path, WEDGE))
    assert design.input_hash() == sk.load(_written(tmp_path, WEDGE)).input_hash()
    assert design.inputs() == sk.load(_written(tmp_path, WEDGE)).inputs()


def test_pressures_by_name_are_those_of_their_planes(tmp_path) -> None:
    text = WEDGE.replace("rock:", "crack: {plane: 80/185, distance: 3 m}\nrock:")
    for given, of_planes in (
        ("J2: 6 kPa", (0.0, 6.0)),
        ("J1: 5 kPa", (5.0, 0.0)),
        ("crack: 7 kPa, J1: 5", (5.0, 0.0, 7.0)),
    ):
        design = sk.load(_written(tmp_path, text.replace("mode: dry", f"pressures: {{{given}}}")))
        assert design.water.pressures_kpa == of_planes


# kind, what of its file is replaced by what, the path and the columns of the one thing that scatters
ORIENTATIONS = [
    (
        "wedge",
        "65/185",
        "{dip: {dist: normal, mean: 65, sd: 2}, dip_direction: 185}",
        "slope.face",
        0,
    ),
    (
        "wedge",
        "12/195",
        "{dip: 12, dip_direction: {dist: normal, mean: 195, sd: 2}}",
        "slope.upper",
        0,
    ),
    (
        "wedge",
        "45/105",
        "{dip: {dist: normal, mean: 45, sd: 2}, dip_direction: 105 deg}",
        "joints.J1.plane",
        0,
    ),
    (
        "wedge",
        "rock:",
        "crack: {plane: {dip: {dist: normal, mean: 80, sd: 2}, dip_direction: 185}, distance: 3}\nrock:",
        "crack.plane",
        {"crack": "{plane: 80/185, distance: 3}"},
    ),
    (
        "wedge",
        "bolts: []",
        "bolts: [{force: 9, toward: {trend: 5, plunge: {dist: normal, mean: 10, sd: 2}}}]",
        "support.bolts.0.toward",
        {"support.bolts": "[9@5/10]"},
    ),
    (
        "wedge",
        "bolts: []",
        "bolts: [{force: 9, toward: {dist: fisher, mean: 5/-10, k: 9}}]",
        "support.bolts.0.toward",
        {"support.bolts": "[9@5/-10]"},
    ),
    (
        "wedge",
        "forces: []",
        "forces: [{force: 9, toward: {dist: fisher, mean: 5/10, k: 9}}]",
        "loads.forces.0.toward",
        {"loads.forces": "[9@5/10]"},
    ),
    (
        "plane",
        "35/180",
        "{dip: {dist: normal, mean: 35, sd: 2}, dip_direction: 180}",
        "joints.J1.plane",
        0,
    ),
]


@pytest.mark.parametrize(
    ("kind", "old", "new", "path", "same"), ORIENTATIONS, ids=lambda value: str(value)[:24]
)
def test_orientations_whose_angles_scatter_take_their_centre(
    kind, old, new, path, same, tmp_path
) -> None:
    design = sk.load(_written(tmp_path, DESIGNS[kind].replace(old, new, 1)))
    assert [variable.path for variable in design.variables] == [path]
    plain = load(_written(tmp_path, DESIGNS[kind]), tuple((same or {}).items()))
    assert design.input_hash() == plain.input_hash()


ANGLES = [
    ("E143", "{dip: 45}", "joints.J1.plane.dip_direction is missing", "5:8"),
    (
        "E142",
        "{dip: 45, dip_direction: 105, strike: 15}",
        "strike is not a key of joints.J1.plane",
        "5:45",
    ),
    (
        "E144",
        "{dsit: fisher, mean: 45/105, k: 9}",
        "an orientation or a group of keys (dip, dip_direction)",
        "5:15",
    ),
    (
        "E106",
        "{dip: steep, dip_direction: 105}",
        "dip of joints.J1.plane is 'steep', a number is needed",
        "5:16",
    ),
    (
        "E103",
        "{dip: 105, dip_direction: 45}",
        "J1 is 105/45: dip and dip direction look swapped",
        "5:15",
    ),
    (
        "E101",
        "{dip: {dist: uniform, min: 80, max: 120}, dip_direction: 205}",
        "dip of J1 is 100",
        "5:15",
    ),
]


@pytest.mark.parametrize(
    ("code", "new", "says", "place"), ANGLES, ids=lambda value: str(value)[:24]
)
def test_angles_that_cannot_be(code, new, says, place, tmp_path) -> None:
    (fault,) = _faults(_written(tmp_path, WEDGE.replace("45/105", new, 1)))
    assert fault.code == code
    assert says in fault.message
    assert fault.where.startswith(f"wall.yaml:{place}  ")


def test_settings_do_not_scatter(tmp_path) -> None:
    text = WEDGE.replace("agree_within: 1 %", "refine: {dist: uniform, min: 0, max: 2}")
    (fault,) = _faults(_written(tmp_path, text))
    assert (fault.code, fault.message.endswith("a value is needed")) == ("E144", True)


def test_correlation_of_one_strength_with_itself_is_refused(tmp_path) -> None:
    text = re.sub(r"  clay: .*\n", "", SCATTER).replace("strength: clay", "strength: rough")
    (fault,) = _faults(_written(tmp_path, f"{text}correlation: {{J1.phi/J2.phi: 0.5}}\n"))
    assert fault.code == "E167"
    assert "J1.phi and J2.phi are one value, strength.rough.phi" in fault.message


# the key, its spelling in the file, what --set says, the same in one word
TURNED = [
    ("joints.J1.plane.dip", "45/105", "50", "50/105"),
    ("joints.J1.plane.dip", "[45, 105]", "50", "50/105"),
    ("joints.J1.plane.dip", "{dip: 45, dip_direction: 105}", "50", "50/105"),
    ("joints.J1.plane.dip_direction", "{dip: 45, dip_direction: 105}", "110", "45/110"),
    (
        "joints.J1.plane.dip",
        "{dip: {dist: normal, mean: 45, sd: 3}, dip_direction: 105}",
        "50",
        "50/105",
    ),
    ("joints.J1.plane.dip", "45/105", "{dist: normal, mean: 50, sd: 3}", "50/105"),
    ("joints.J1.plane.dip_direction", "[45, 105]", "{dist: normal, mean: 110, sd: 3}", "45/110"),
    ("joints.J1.plane.mean", "{dist: fisher, mean: 45/105, k: 9}", "50/110", "50/110"),
]


@pytest.mark.parametrize(
    ("key", "spelled", "value", "same"), TURNED, ids=lambda value: str(value)[:24]
)
def test_set_of_one_angle_in_every_spelling(key, spelled, value, same, tmp_path) -> None:
    changed = load(_written(tmp_path, WEDGE.replace("45/105", spelled, 1)), [(key, value)])
    assert (
        changed.input_hash()
        == sk.load(_written(tmp_path, WEDGE.replace("45/105", same, 1))).input_hash()
    )


def test_set_of_one_angle_of_a_fisher_distribution_is_refused(tmp_path) -> None:
    path = _written(tmp_path, WEDGE.replace("45/105", "{dist: fisher, mean: 45/105, k: 9}", 1))
    (fault,) = _faults(path, [("joints.J1.plane.dip", "50")])
    assert str(fault) == (
        "E160 joints.J1.plane is a distribution, it has no dip of its own\n     --set joints.J1.plane.dip=50\n"
        "     Set its mean: --set joints.J1.plane.mean=…, or the whole orientation: --set joints.J1.plane=…"
    )


def test_set_of_one_angle_of_a_line(tmp_path) -> None:
    path = _written(tmp_path, WEDGE.replace("bolts: []", "bolts: [{force: 9, toward: 5/10}]", 1))
    assert load(path, [("support.bolts.0.toward.plunge", "20")]).bolts[0].toward == Line(5.0, 20.0)
    (fault,) = _faults(path, [("support.bolts.0.toward.dip", "20")])
    assert fault.code == "E160"


# -- joint lists ------------------------------------------------------------------------------------------------------


def _from_list(tmp_path, joints: str, strength: str = "", rows: str = LIST) -> Path:
    (tmp_path / "joints.csv").write_text(rows, encoding="utf-8")
    text = re.sub(r"joints:\n.*\n.*\n", f"joints: {{csv: joints.csv{joints}}}\n", WEDGE)
    return _written(tmp_path, re.sub(r"strength:\n.*\n.*\n", strength, text))


def test_a_joint_list_gives_planes_and_strengths(tmp_path) -> None:
    picked = sk.run(_from_list(tmp_path, ", pick: [A, B]", "strength: {joint: {c: 1, phi: 1}}\n"))
    assert picked.design.cohesion_kpa == (24.0, 48.0)
    assert picked.design.friction_angle_deg == (30.0, 20.0)
    assert picked.design.joint_names == ("A", "B")
    assert picked.fos == sk.run(_written(tmp_path, WEDGE)).fos
    (said,) = [notice.message for notice in picked.warnings if notice.code == "W366"]
    assert "column remark of joints.csv" in said
    assert "phi of the design for B: joints.csv has its own" in said


def test_joints_without_a_strength_of_their_own_take_that_of_the_design(tmp_path) -> None:
    mixed = sk.load(
        _from_list(tmp_path, ", pick: [A, C]", "strength: {joint: {c: 7, phi: 28, tension: 2}}\n")
    )
    assert mixed.cohesion_kpa == (24.0, 7.0)
    assert mixed.friction_angle_deg == (30.0, 28.0)
    assert [one.tension_kpa for one in mixed.strengths] == [2.0, 2.0]


def test_a_strength_that_neither_list_nor_design_gives(tmp_path) -> None:
    faults = _faults(
        _from_list(tmp_path, ", pick: [A, C]", "strength: {joint: {c: 7, phi: 28, tension: 2}}\n"),
        [("strength", "null")],
    )
    assert {(fault.code, fault.message) for fault in faults} >= {
        ("E143", "c of C is missing in joints.csv"),
        ("E143", "phi of C is missing in joints.csv"),
    }


STRENGTH = "strength: {joint: {c: 7, phi: 28}}\n"
LIST_FAULTS = [
    ("E109", "", LIST, "a wedge takes two joints, 3 come from joints.csv", "wall.yaml:4:15"),
    (
        "E109",
        ", pick: A",
        LIST,
        "a wedge takes two joints, 1 come from joints.csv",
        "wall.yaml:4:33",
    ),
    ("E197", ", pick: [A, D]", LIST, "joints.csv has no joint D", "wall.yaml:4:33"),
    ("E192", "", "dip,strike\n45,15\n70,145\n", "a strike column has two meanings", "joints.csv:1"),
    (
        "E192",
        ", convention: right",
        "dip,strike\n45,15\n70,145\n",
        "the strike convention 'right' is not known",
        "wall.yaml:4:39",
    ),
    ("E101", "", "dip,dip_direction\n195,115\n70,235\n", "dip of J1 is 195", "joints.csv:2"),
]


@pytest.mark.parametrize(
    ("code", "joints", "rows", "says", "place"), LIST_FAULTS, ids=lambda value: str(value)[:24]
)
def test_faults_of_a_joint_list(code, joints, rows, says, place, tmp_path) -> None:
    (fault,) = _faults(_from_list(tmp_path, joints, STRENGTH, rows))
    assert fault.code == code
    assert says in fault.message
    assert fault.where.startswith(place)


@pytest.mark.parametrize(("name", "code"), [("joint.csv", "E147"), (".", "E148")])
def test_a_joint_list_that_cannot_be_opened_is_a_fault_of_the_design(name, code, tmp_path) -> None:
    path = _from_list(tmp_path, "", STRENGTH)
    path.write_text(path.read_text().replace("csv: joints.csv", f"csv: {name}"))
    (fault,) = _faults(path)
    assert fault.code == code
    assert fault.where.startswith("wall.yaml:4:15")


def test_strikes_with_their_convention(tmp_path) -> None:
    rows = "dip,strike\n45,15\n70,145\n"
    design = sk.load(_from_list(tmp_path, ", convention: right-hand-rule", STRENGTH, rows))
    assert [str(plane) for plane in design.joints] == ["45/105", "70/235"]


# -- meshes -----------------------------------------------------------------------------------------------------------


def _mesh_design(tmp_path, content: bytes) -> Path:
    (tmp_path / "slip.stl").write_bytes(content)
    return _written(
        tmp_path,
        SURFACE.replace("shape: sphere, centre: [44, 0, 44], radius: 44", "mesh: slip.stl"),
    )


def _stl(vertices, faces) -> bytes:
    return trimesh.Trimesh(vertices, faces, process=False).export(file_type="stl")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"solid nothing\nfacet normal x y z\n", "the mesh slip.stl "),
        (b"", "the mesh slip.stl "),
        (b"solid a\nendsolid a\n", "the mesh slip.stl "),
        (
            _stl([[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
            "has no triangles that can be used",
        ),
    ],
)
def test_a_mesh_that_cannot_be_read(content, says, tmp_path) -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.run(_mesh_design(tmp_path, content))
    (fault,) = caught.value.faults
    assert fault.code == "E172"
    assert says in fault.message
    assert fault.where.startswith("wall.yaml:4:14")


def test_a_mesh_of_too_many_triangles(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(meshes, "_MOST_TRIANGLES", 100)
    ball = trimesh.creation.icosphere(3, 40.0)
    with pytest.raises(
        sk.DesignError, match=r"E172 the mesh slip\.stl has 1280 triangles, more than 100"
    ):
        sk.run(
            _mesh_design(tmp_path, _stl(ball.vertices + np.array([44.0, 0.0, 44.0]), ball.faces))
        )


@pytest.mark.parametrize("normals", ["true", "smoothed"])
def test_an_edge_too_fine_to_solve_is_refused(normals, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(sliding_mass, "MOST_TRIANGLES", 300)
    text = SURFACE.replace("radius: 44", f"radius: 44, edge: 1 mm, normals: {normals}")
    with pytest.raises(sk.DesignError) as caught:
        sk.run(_written(tmp_path, text))
    (fault,) = caught.value.faults
    assert fault.code == "E125"
    assert "edges of 0.001 m make" in fault.message
    least = float(re.search(r"Give ([\d.]+) m", fault.advice).group(1))
    assert sk.run(_written(tmp_path, text.replace("1 mm", f"{least} m"))).status == "rotates"


# -- acceptance, templates --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rules", "met", "exit_code"),
    [
        ('["fos >= 1.2"]', [True], 0),
        ('["fos >= 1.3"]', [False], 1),
        ('[1.2, "fos.closed_form < 1.3"]', [True, True], 0),
        ('["fos.limit > 1.2", "fos.all_pairs_failed >= 1"]', [True, False], 1),
        ("fos.static_bound >= 1.2", [True], 0),
    ],
)
def test_acceptance_rules(rules, met, exit_code, tmp_path) -> None:
    """The factor of this plane is 1.2467 (Wyllie & Mah, ch. 6)."""
    result = sk.run(_written(tmp_path, PLANE + f"acceptance: {{rules: {rules}}}\n"))
    assert [rule["met"] for rule in result.to_dict()["rules"]] == met
    assert result.exit_code == exit_code


def test_a_template_that_is_not_there() -> None:
    with pytest.raises(sk.DesignError) as caught:
        path_of("wegde")
    assert str(caught.value) == "E197 wegde is not a template\n     Did you mean wedge?"


def test_an_installation_without_templates(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr("slopekit.design.templates._PLACES", (tmp_path,))
    with pytest.raises(sk.DesignError, match="E197 this installation has no templates"):
        path_of("wedge")
