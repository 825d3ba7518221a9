"""What `benchmarks.fuzz` mutates: the templates, richer designs, extreme values by key, and wrong ones."""

from pathlib import Path

import numpy as np
import trimesh

from benchmarks.fuzz_slopes import FACTOR_FILES, SECTIONS, SLOPES, VALUES
from benchmarks.fuzz_slopes import FRAGMENTS as _OF_SLOPES
from slopekit.design.templates import names, path_of
from slopekit.geometry.solids.shapes import profile_prism

_RICH = {
    "rich wedge": """\
slopekit: 1
kind: wedge
title: Nordwand — φ, ° and 岩
slope: {face: 70/185, upper: 12/180, height: 40 m, origin: [500100, 4649000, 812]}
joints:
  J1: {plane: {dist: fisher, mean: 47/120, k: 200}, strength: rough}
  J2: {plane: [55, 240], strength: clay}
crack: {plane: 80/180, distance: 6 m, water: full}
strength:
  rough:
    c: {dist: lognormal, mean: 40 kPa, sd: 8}
    phi: {dist: normal, mean: 32, sd: 2, min: 20, max: 45}
    dilation: 3
    stiffness: {normal: 5 GPa/m}
  clay: {c: 0.02 MPa, phi: {dist: triangular, min: 15, mode: 18, max: 25}, tension: 5 kPa, stiffness: {normal: 5 GPa/m}}
correlation: {rough.c/rough.phi: -0.4, J1.phi/J2.phi: 0.3}
rock: {unit_weight: 26 kN/m3, gravity: 9.81}
water: {mode: full, unit_weight: 10}
loads:
  seismic: {k: 0.1, toward: 180}
  forces: [500 kN@180/10, [0, -200, 50], {force: 300 kN, toward: 180/20}]
support:
  bolts: ["200 kN@000/05,passive", {force: 400 kN, toward: 350/-10, acts: active}]
analysis: {criterion: limit, agree_within: 2 %, refine: 1, factors: [1, 1.5]}
acceptance: {rules: [fos >= 1.3, fos.closed_form > 1.1]}
""",
    "pressed wedge": """\
slopekit: 1
kind: wedge
slope: {face: 65/180, upper: 0/180, height: 25 m}
joints:
  A: {plane: 50/130}
  B: {plane: 60/250}
crack: {plane: 75/175, distance: 4 m, water: 20 kPa}
strength:
  fill: {c: 15 kPa, phi: 25, stiffness: {normal: 2e6, shear: {law: clough-duncan, k1: 4000, n: 0.5, Rf: 0.7, phi: 30}}}
rock: {density: 2.7 t/m3}
water: {pressures: {A: 10 kPa, B: 5 kPa}}
support: {bolts: [{force: 300 kN, toward: 000/10, acts: passive}]}
analysis: {criterion: all-pairs, factors: [0.9, 1.0, 1.1, 1.2]}
acceptance: {rules: fos >= 1.2}
""",
    "survey wedge": """\
slopekit: 1
kind: wedge
slope: {face: 65/180, upper: 5/180, height: 30 m}
joints: {csv: joints.csv, pick: [A1, B1], strength: joint}
strength:
  joint: {c: 20 kPa, phi: 30}
rock: {density: 2650 kg/m3}
water: {fill: 40 %}
acceptance: {rules: ["fos >= 1.5"]}
""",
    "strike wedge": """\
slopekit: 1
kind: wedge
slope: {face: 65/180, upper: 5/180, height: 30 m}
joints: {csv: strikes.csv, convention: right-hand-rule}
strength: {joint: {c: 20 kPa, phi: 30}}
rock: {density: 2650 kg/m3}
""",
    "rich plane": """\
slopekit: 1
kind: plane
slope: {face: 75/090, upper: 10/090, height: 20 m}
joints:
  bedding: {plane: 38/095}
crack: {distance: 4 m}
strength:
  clay: {c: {dist: uniform, min: 20, max: 60}, phi: 24, dilation: 2, tension: 1}
rock: {unit_weight: 25}
water: {mode: full}
loads: {seismic: 0.08, forces: [{force: 50 kN, toward: 090/10, at: [-2, 0, 15]}]}
support: {bolts: [{force: 150 kN, toward: 270/20, head: [-3.5, 0, 15], length: 12 m, acts: passive}]}
analysis: {refine: 1, factors: [0.8, 1.0, 1.3]}
acceptance: {rules: ["fos >= 1.2"]}
""",
    "pressed plane": """\
slopekit: 1
kind: plane
slope: {face: 60/180, height: 12 m, upper: 0/180}
joints: {J1: {plane: 35/180}}
crack: {depth: 4.35 m}
strength: {bedding: {c: 25 kPa, phi: 37}}
rock: {unit_weight: 26 kN/m3}
water: {pressures: [10 kPa, 20 kPa]}
analysis: {criterion: all-pairs}
""",
    "cases plane": """\
slopekit: 1
kind: plane
slope: {face: 60/180, height: 12 m, upper: 0/180}
joints: {J1: {plane: 35/180}}
strength: {bedding: {c: 25 kPa, phi: 37}}
rock: {unit_weight: 26 kN/m3}
loads: {surcharge: 10 kPa}
acceptance: {rules: "fos >= 1.3"}
cases:
  static: {accept: ["fos >= 1.5", "fos.closed_form >= 1.4"]}
  quake: {set: {loads.seismic.k: 0.1, water: {fill: 50 %}}, accept: "fos >= 1.1"}
  code: {set: {analysis.partial_factors: DA1-C2, support.bolts: [200 kN@000/10]}}
  own: {set: {analysis.partial_factors: {set: DA2, tan_phi: 1.1, forces: variable}}}
""",
    "rich footing": """\
slopekit: 1
kind: footing
footing: {load: {dist: normal, mean: 2000 kN, sd: 200}, at: 2.5 m}
weak_plane: {dip: 40, length: 8 m, strength: seam, pairs: 21}
strength: {seam: {c: 120 kPa, phi: 25, dilation: 5, stiffness: {normal: 2e5, shear: clough-duncan}}}
rock: {unit_weight: 24}
analysis: {criterion: all-pairs, factors: [0.5, 1, 1.5]}
""",
    "wet footing": """\
slopekit: 1
kind: footing
footing: {load: 1500 kN, at: 2 m}
weak_plane: {dip: 30, length: 8 m, strength: seam}
strength: {seam: {c: 100 kPa, phi: 25}}
uplift: {toe: 40 kPa, heel: 10 kPa, drain: 25 %}
""",
    "deep crack": """\
slopekit: 1
kind: wedge
slope: {face: 65/185, upper: 0/185, height: 20 m}
joints: {J1: {plane: 45/105}, J2: {plane: 60/235}}
crack: {plane: 85/185, distance: 4 m, water: 3 m}
strength: {j: {c: 20 kPa, phi: 30}}
rock: {unit_weight: 26, modulus: 20 GPa, poisson: 0.25}
analysis: {elastic: {edge: 5 m, bedrock: rigid}}
""",
    "sheet surface": """\
slopekit: 1
kind: surface
slope: {profile: [[30, 0], [20, 0], [0, 20], [-20, 22]]}
slip: {mesh: sheet.stl, up: z}
strength: {zone: {c: 10 kPa, phi: 30}}
rock: {unit_weight: 22}
water: {pressures: 3 kPa}
""",
    "ground surface": """\
slopekit: 1
kind: surface
slope: {mesh: ground.stl}
slip: {shape: sphere, centre: [20, 0, 22], radius: 20, edge: 3}
strength: {zone: {c: 10 kPa, phi: 30, dilation: 1}}
rock: {unit_weight: 22}
loads: {seismic: {k: 0.1, toward: 90}, forces: [{force: [10, 0, -500], at: [0, 0, 20]}]}
support: {bolts: ["300@270/-10,passive"]}
""",
    "facet surface": """\
slopekit: 1
kind: surface
slope: {profile: [[60, 0], [40, 0], [0, 40], [-20, 40]]}
slip: {shape: ellipsoid, centre: [40, 0, 40], radii: [40, 30, 40], normals: smoothed, edge: 8 m}
strength: {zone: {c: 30 kPa, phi: 30}}
rock: {density: 2200}
loads: {seismic: 0.1}
analysis: {factors: [1, 1.2]}
acceptance: {rules: ["fos >= 1.1", fos.static_bound >= 1]}
""",
    "tube surface": """\
slopekit: 1
kind: surface
slope: {profile: [[60, 0], [40, 0], [40, 12], [30, 12], [0, 40], [-20, 40]]}
slip: {shape: cylinder, centre: [45, 45], radius: 45, length: 8 m, edge: 5}
strength: {zone: {c: 60 kPa, phi: 0}}
rock: {unit_weight: 20}
water: {pressures: {slip: 8 kPa}}
""",
}
_RICH |= {
    "rich topple": """\
slopekit: 1
kind: topple
columns: {dip: 65, width: 2 m, heights: [4, 6, 8, 7, 5, 3], base_step: 0.5 m, thickness: 1 m, base: slate, sides: joint}
strength:
  slate: {c: 0, phi: {dist: normal, mean: 36, sd: 2}}
  joint: {c: 5 kPa, phi: 40}
rock: {unit_weight: 25}
water: {pressures: {base: 5 kPa, sides: 2}}
loads: {seismic: 0.1, forces: [{force: 20 kN, toward: 270/00, block: C1, at: [1, 0, 2]}]}
support: {bolts: [{force: 200 kN, toward: 090/20, acts: passive, block: C2}]}
analysis: {mechanisms: 2, smallest_block: 3 %}
""",
    "rich bench": """\
slopekit: 1
kind: bench
slope: {face: 70/180, height: 8 m, upper: 5/180, length: 16 m, depth: 8 m, origin: [1000, 2000, 300]}
sets:
  S1: {plane: 30/175, spacing: {dist: lognormal, mean: 3 m, sd: 0.5}, scatter: 3, strength: rough}
  S2: {plane: 85/265, spacing: 4 m, offset: 0.5 m, strength: joint, spacing_scatter: 20 %}
  S3: {plane: 75/350, spacing: 4 m, strength: joint}
strength: {rough: {c: 5 kPa, phi: 32}, joint: {c: 0, phi: 38}}
rock: {density: 2600 kg/m3}
cut: {max_blocks: 500, min_volume: 0.01 m3, seed: 7}
water: {pressures: {S1: 2 kPa}}
loads: {seismic: 0.05, forces: [{force: 50 kN, toward: 180/00, at: [1000, 2001, 306]}]}
""",
    "rich blocks": """\
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
""",
}
SEEDS = {name: path_of(name).read_text(encoding="utf-8") for name in names()} | _RICH | SLOPES

_DIPS = ("0", "0.01", "1", "12", "25", "35", "45", "50", "60", "75", "89", "89.9", "89.99", "90")
_DIRECTIONS = (
    "000",
    "90",
    "115",
    "150",
    "175",
    "179.99",
    "180",
    "180.01",
    "185",
    "210",
    "245",
    "270",
    "359.99",
    "360",
)
_PLANES = tuple(f"{dip}/{way}" for dip in _DIPS for way in _DIRECTIONS)
_LENGTHS = ("1e6", "1e-3", "1e-6", "0.5 m", "3 m", "10", "30 m", "0.1 km", "200 ft", "1000", "1e7")
_FORCES = ("0", "1e-6", "100", "5e3 kN", "2 MN", "1e5", "1e6 kN", "1e9", "1e12", "1e17")
_POINTS = (
    ["0", "0", "0"],
    ["-5", "0", "8"],
    ["1e6", "1e6", "1e3"],
    ["40", "0", "40"],
    ["44.3", "3", "41"],
)
#: Values that a key may have: sound ones, extreme ones, and some just outside.
EXTREMES: dict[str, tuple[object, ...]] = {
    "plane": _PLANES,
    "face": _PLANES,
    "upper": _PLANES,
    "height": _LENGTHS,
    "distance": (*_LENGTHS, "-1", "0", "4.1", "worst"),
    "depth": (*_LENGTHS, "4.4"),
    "c": ("0", "1e-6", "1", "20 kPa", "1 MPa", "1e6", "1e12"),
    "phi": ("0", "2", "15", "30", "45", "60", "80", "89", "89.9", "89.999"),
    "dilation": ("0", "1", "20", "0.5", "25"),
    "tension": ("0", "10", "1e6"),
    "normal": ("1", "1e3", "1e7", "1e12", "1e17"),
    "shear": ("clough-duncan", "1", "1e3", "1e9", "1e15"),
    "k1": ("1", "1e9"),
    "n": ("0", "2"),
    "Rf": ("0", "1"),
    "density": ("500", "2000", "10000"),
    "unit_weight": ("5", "10", "20", "30", "400"),
    "gravity": ("1e-3", "1.62", "9.81", "24.8", "1e3"),
    "mode": ("dry", "full"),
    "fill": ("0", "1 %", "0.5", "100 %"),
    "pressures": ("0", "5 kPa", "50", "100", "1e3", "1e6"),
    "A": ("0", "30", "200", "1e5"),
    "B": ("0", "30", "200", "1e5"),
    "slip": ("0", "30", "200", "1e5"),
    "k": ("0", "0.2", "0.5", "1", "2"),
    "seismic": ("0", "0.3", "2", "0.2@90", "1@000"),
    "toward": ("000/90", "180/-90", "90/0", "270/45", "000/10", "180", "0", "90", "360"),
    "force": _FORCES,
    "forces": _FORCES,
    "load": _FORCES,
    "bolts": ("1e4@000/0,passive", "1e7@180/0,active"),
    "at": ("0", "middle", "1e-3", "2.5", "5", "6.128355", "1e3"),
    "dip": ("0.01", "1", "30", "45", "60", "80", "89.9"),
    "length": _LENGTHS,
    "pairs": ("3", "9", "101", "2001"),
    "radius": ("1e-3", "5", "20", "40", "44", "60", "1e3", "1e6"),
    "radii": ("1", "10", "28", "40", "41", "60", "1e4"),
    "centre": ("-50", "0", "20", "30", "40", "42", "60", "1e3", "1e6"),
    "profile": ("-50", "0", "10", "20", "30", "40", "60", "1e3", "1e6"),
    "edge": ("0.5", "1", "2", "5", "20", "1e3"),
    "normals": ("true", "smoothed", "facet"),
    "shape": ("sphere", "ellipsoid", "cylinder"),
    "criterion": ("limit", "all-pairs"),
    "agree_within": ("1e-9", "0.5", "99 %"),
    "refine": ("0", "1", "2", "3"),
    "factors": ("1e-6", "0.1", "1", "2", "100", "1e9"),
    "origin": ("0", "1e6", "-1e7", "1e12"),
    "mesh": (
        "sheet.stl",
        "ground.stl",
        "open.stl",
        "ball.stl",
        "folded.stl",
        "inside-out.stl",
        "broken.stl",
        "flat.stl",
    ),
    "up": ("y", "z", "x"),
    "csv": ("joints.csv", "strikes.csv", "bad.csv"),
    "rules": ("fos >= 1", "fos < 2", "fos.static_bound >= 1.2", "1.5"),
    "acts": ("active", "passive"),
    "pick": ("A1", "A2", "B1", "B2"),
    "strength": ("rough", "weak", "joint", "clay"),
    "modulus": ("1e3", "20 GPa", "20", "1e9", "1e10"),
    "poisson": ("0", "0.49", "0.5", "-0.1"),
    "mean": ("1", "20", "30", "1e3"),
    "sd": ("0", "1", "100"),
    "min": ("0", "10", "25"),
    "max": ("30", "50", "1e3"),
    "title": ("", "a: b", "\u200b", "\U0001f4a5 x", "'", "x" * 300),
    "head": ("0", "-4", "15", "1e3"),
} | VALUES

_WATER = (
    "dry",
    "full",
    "30 %",
    "{mode: full}",
    "{fill: 0.7}",
    "{pressures: 40 kPa}",
    "{mode: full, unit_weight: 100}",
    "{pressures: [500, 10]}",
    "{pressures: 1e4}",
)
_LOADS = (
    "{seismic: 2.0}",
    "{seismic: {k: 2, toward: 0}}",
    "{forces: [1e6@000/0]}",
    "{forces: [1e5 kN@000/-90]}",
    "{forces: [[0, 0, 1e7]]}",
    "{seismic: 0.3, forces: [{force: 1e4, toward: 90/0, at: [-3, 1, 9]}]}",
    "{forces: [{force: [0, 0, 0], at: [1, 2, 3]}]}",
)
_BOLTS = (
    '{bolts: ["1e6@000/0,passive"]}',
    "{bolts: [1e6@000/0]}",
    "{bolts: [1e8@000/-30]}",
    '{bolts: ["5e4@180/0,passive"]}',
    "{bolts: [{force: 100, toward: 000/10, head: [-2, -2, 8], length: 0.5}]}",
    '{bolts: ["1e3@000/0,passive", 1e3@180/0]}',
    "{bolts: [{force: 3000, toward: 000/10, head: [0, 4, 8], length: 90, acts: passive}]}",
)
_STRENGTHS = (
    "{s: {c: 0, phi: 0}}",
    "{s: {c: 0, phi: 30}}",
    "{s: {c: 50, phi: 0}}",
    "{s: {c: 5, phi: 30, dilation: 30}}",
    "{s: {c: 0, phi: 0, tension: 10}}",
    "{s: {c: 1e9, phi: 89.9}}",
    "{s: {c: 0, phi: 89.99, dilation: 89.99}}",
    "{s: {c: 1, phi: 20, stiffness: {normal: 1, shear: 1e12}}}",
)
_ANALYSES = ("{criterion: all-pairs}", "{factors: [0.1, 1, 10]}", "{agree_within: 1e-9}")
_COMMON = tuple(
    (key, text)
    for key, texts in (
        ("water", _WATER),
        ("loads", _LOADS),
        ("support", _BOLTS),
        ("strength", _STRENGTHS),
        ("analysis", _ANALYSES),
    )
    for text in texts
)
_PROFILES = (
    "[[60, 0], [40, 0], [40, 40], [-20, 40]]",
    "[[60, 0], [0, 0.001], [-20, 0.002]]",
    "[[0, 0], [1, 0]]",
    "[[-60, 0], [-40, 0], [0, 40], [20, 40]]",
    "[[60, 0], [30, 0], [35, 20], [0, 40], [-20, 40]]",
    "[[60, 0], [40, 0], [40, 10], [40, 20], [20, 20], [20, 40], [0, 40]]",
    "[[60, 40], [40, 0], [0, 40], [-20, 0]]",
    "[[60, 0], [40, 0], [30, 20], [20, 0], [10, 25], [0, 0], [-20, 40]]",
    "[[60, 50], [-60, 50]]",
    "[[6e5, 0], [4e5, 0], [0, 4e5], [-2e5, 4e5]]",
    "[[60, 0], [40, 0], [0, 40], [-20, 40], [-20, 40.000001]]",
    "[[40, 0], [40, 40]]",
    "[[60, 0], [40, 0], [0, 40], [0, 40.0000001], [-20, 40]]",
)
_SLIPS = (
    "{shape: sphere, centre: [40, 0, 40], radius: 40}",
    "{shape: sphere, centre: [20, 0, 10], radius: 5}",
    "{shape: sphere, centre: [40, 0, 40], radius: 28.2842713}",
    "{shape: sphere, centre: [20, 0, 60], radius: 10}",
    "{shape: sphere, centre: [20, 0, 20], radius: 1e-3}",
    "{shape: sphere, centre: [1e4, 0, 1e4], radius: 14142}",
    "{shape: ellipsoid, centre: [40, 0, 40], radii: [40, 1e-3, 40]}",
    "{shape: ellipsoid, centre: [40, 0, 40], radii: [40, 1e4, 40]}",
    "{shape: ellipsoid, centre: [20, 5, 30], radii: [30, 10, 12], normals: facet}",
    "{shape: cylinder, centre: [40, 40], radius: 41}",
    "{shape: cylinder, centre: [40, 40], radius: 41, length: 1e5}",
    "{shape: cylinder, centre: [40, 40], radius: 41, length: 1e-4}",
    "{shape: sphere, centre: [40, 0, 40], radius: 41, edge: 0.2}",
    "{shape: sphere, centre: [40, 0, 40], radius: 41, edge: 1e-6}",
    "{shape: ellipsoid, centre: [40, 0, 40], radii: [40, 28, 40], edge: 0.01, normals: smoothed}",
    "{shape: sphere, centre: [20, 0, 20], radius: 25, normals: facet, edge: 4}",
    "{mesh: sheet.stl, edge: 0.1}",
    "{mesh: ball.stl}",
    "{mesh: ground.stl}",
    "{mesh: folded.stl}",
    "{mesh: short.stl}",
    "{mesh: open.stl, normals: facet}",
    "{mesh: flat.stl}",
    "{mesh: sheet.stl, normals: facet}",
    "{mesh: inside-out.stl}",
    "{mesh: gone.stl}",
    "{mesh: broken.stl}",
)
#: Sections to put in the place of a design's own, by kind.
SPICES: dict[str, tuple[tuple[str, str], ...]] = {
    "wedge": (
        *_COMMON,
        *_COMMON,
        *(
            ("crack", text)
            for text in (
                "{plane: 80/180, distance: 5 m}",
                "{plane: 90/180, distance: 0.1}",
                "{plane: 70/190, distance: 20}",
                "{plane: 80/000, distance: 10}",
                "{plane: 85/150, distance: 15, water: full}",
                "{plane: 60/180, distance: 1e-6}",
            )
        ),
        *(
            ("slope", text)
            for text in (
                "{face: 90/180, upper: 0/180, height: 20}",
                "{face: 89.9/180, upper: 0/0, height: 1e6}",
                "{face: 60/180, upper: 10/000, height: 1e-3}",
                "{face: 60/200, upper: 20/150, height: 12}",
                "{face: 85/180, upper: 22/180, height: 30, origin: [1e7, 1e7, 0]}",
            )
        ),
        *(
            ("joints", text)
            for text in (
                "{A: {plane: 89.9/100}, B: {plane: 45/250}}",
                "{A: {plane: 45/178}, B: {plane: 46/181}}",
                "{A: {plane: 90/140}, B: {plane: 90/220}}",
                "{A: {plane: 50/091}, B: {plane: 50/269}}",
                "{A: {plane: 10/120}, B: {plane: 85/240}}",
                "{A: {plane: 40/175}, B: {plane: 80/265}}",
                "{csv: joints.csv, pick: [A2, B2]}",
                "{csv: joints.csv}",
                "{csv: bad.csv}",
            )
        ),
    ),
    "plane": (
        *_COMMON,
        *(
            ("crack", text)
            for text in (
                "{depth: 1e-6}",
                "{distance: 0}",
                "{distance: 3, water: 1}",
                "{depth: 4, water: full}",
                "{distance: -1}",
                "{distance: 1e-9}",
                "{depth: 3, distance: 6.2}",
                "{depth: 3, water: 0}",
            )
        ),
        *(
            ("slope", text)
            for text in (
                "{face: 90/180, height: 10}",
                "{face: 60/180, height: 1e6}",
                "{face: 60/180, height: 1e-3}",
                "{face: 89.9/180, upper: 5/000, height: 10}",
                "{face: 60/180, upper: 34.99/180, height: 9}",
            )
        ),
        *(
            ("joints", f"{{J1: {{plane: {plane}}}}}")
            for plane in ("35/180", "0.01/180", "59.99/180", "35/199", "59/180", "2/180")
        ),
    ),
    "footing": (
        *(part for part in _COMMON if part[0] in ("strength", "analysis")),
        ("footing", "{load: 1e-6, at: 0}"),
        ("footing", "{load: 1e12}"),
        ("footing", "{load: 100, at: 4}"),
        ("weak_plane", "{dip: 89.9, length: 5}"),
        ("weak_plane", "{dip: 0.01, length: 5}"),
        ("rock", "{unit_weight: 400}"),
        ("weak_plane", "{dip: 60, length: 1e6, pairs: 2001}"),
        ("weak_plane", "{dip: 60, length: 1e-3, pairs: 3}"),
    ),
    "surface": (
        *_COMMON,
        *(("slope", f"{{profile: {profile}}}") for profile in _PROFILES),
        *(("slip", text) for text in _SLIPS),
        *(
            ("slope", f"{{mesh: {name}.stl}}")
            for name in ("ground", "open", "ball", "inside-out", "broken")
        ),
    ),
}
SPICES |= {kind: (*SPICES.get(kind, ()), *sections) for kind, sections in SECTIONS.items()}
#: Values that fit no key, or the wrong ones.
WRONG: dict[str, tuple[str | None, ...]] = {
    "numbers": (
        "nan",
        ".nan",
        "inf",
        "-inf",
        ".inf",
        "1e308",
        "-1e308",
        "1e400",
        "1e-400",
        "1e19",
        "0",
        "-0.0",
        "-1",
        "-1e-9",
        "0x10",
        "010",
        "1_000",
        "1,5",
        "1e",
        "1.2.3",
        "+5",
        ".5",
        "5.",
        "١٢",
        "½",
        "1/2",
        "5 5",
        "5±1",
    ),
    "texts": (
        "",
        "weak",
        "full",
        "true",
        "null",
        "~",
        "φ",
        "岩盤",
        "\u202e5",
        "e\u0301",
        "\U0001f4a5",
        " ",
        "a b",
        "x" * 500,
        "../../etc/passwd",
        "/",
        ".",
        "-",
        "?",
        "fos",
        "45",
        "45/115/3",
        "/",
        "@",
        "%",
        "kPa",
        "J1",
        "slip.stl",
    ),
    "planes": (
        "95/115",
        "115/45",
        "45/-5",
        "nan/115",
        "45/400",
        "N25E 45SE",
        "45/",
        "/115",
        "45",
        "1e400/1",
    ),
    "nothing": (None,),
    "rules": (
        "fos = 1",
        "fos >= x",
        "fos >= -1",
        "fos.limt >= 1",
        ">= 1.5",
        "1.5 < fos",
        "fos >= nan",
    ),
    "forces": (
        "5@",
        "@5",
        "5@180",
        "5@180/100",
        "5@nan/1",
        "1e18@180/0",
        "-5@180/0",
        "5@180/0,glued",
    ),
    "units": (
        "5 kg",
        "5 kN",
        "5 kPa",
        "5 m",
        "5 furlong",
        "5 %",
        "500 %",
        "0.5 rad",
        "2650 kN/m3",
        "2.6",
        "5 m/s2",
    ),
}
#: Keys with values, to stand where they may not belong.
FRAGMENTS = (
    "water: {mode: full}",
    "crack: {depth: 3 m}",
    "crack: {plane: 80/180, distance: 5}",
    "c: 5",
    "phi: 20",
    "dist: normal",
    "mean: 5",
    "strength: weak",
    "kind: plane",
    "slip: {shape: sphere}",
    "mesh: ball.stl",
    "loads: {seismic: 0.2}",
    "at: middle",
    "csv: joints.csv",
    "pick: [A1]",
    "edge: 1",
    "<<: {a: 1}",
    "a.b: 1",
    "J3: {plane: 50/180}",
    "spare: {c: 1, phi: 5}",
    "correlation: {J1.phi/J2.phi: 2}",
    "correlation: {a/b: 0.1, b/a: 0.2}",
    "rock: {density: 2600}",
    "length: 5",
    "unit_weight: 25",
    "fill: 10 %",
    "pressures: 5",
    "tension: 3",
    "dilation: 2",
    "origin: [1, 2, 3]",
    "refine: 2",
    "head: [0, 0, 5]",
    "title: x",
    *_OF_SLOPES,
)


def write_files(folder: Path) -> None:
    """The joint lists, meshes and partial factors that the seeds name."""
    for name, text in FACTOR_FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "joints.csv").write_text(
        "name,dip,dip direction,c,phi\nA1,45,120,,\nA2,50,125,10,30\nB1,55,245,,\nB2,60,240,20,35\n",
        encoding="utf-8",
    )
    (folder / "strikes.csv").write_text("name;dip;strike\nA;45;30\nB;50,5;155\n", encoding="utf-8")
    (folder / "bad.csv").write_text(
        "name,dip,dip_direction\nA,95,120\nB,x,30\nB,40,30,5\n", encoding="utf-8"
    )
    line = np.array([[35.0, 0.0], [20.0, 0.0], [0.0, 20.0], [-25.0, 22.0]])
    ground = profile_prism(line, -20.0, 30.0, (-25.0, 35.0))
    _write(folder / "ground.stl", ground.vertices, ground.triangles)
    _write(folder / "open.stl", ground.vertices, ground.triangles[:-2])
    ball = trimesh.creation.icosphere(3, 20.0)
    middle = np.array([20.0, 0.0, 22.0])
    _write(folder / "ball.stl", ball.vertices + middle, ball.faces)
    _write(folder / "inside-out.stl", ball.vertices + middle, ball.faces[:, ::-1])
    for name, reach, bowl in (
        ("sheet", 30.0, 1.0),
        ("short", 8.0, 1.0),
        ("folded", 30.0, 1.0),
        ("flat", 60.0, 0.0),
    ):
        vertices, triangles = _sheet(reach, bowl)
        if name == "folded":
            vertices[40:60, 0] += 8.0
        _write(folder / f"{name}.stl", vertices, triangles)
    (folder / "broken.stl").write_bytes(b"solid nothing\nfacet normal x y z\n\x00\xff")


def _write(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    trimesh.Trimesh(vertices, triangles, process=False).export(path)


def _sheet(reach: float, bowl: float, count: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """A bowl (or a level floor) over a square of `count` by `count` points."""
    x, y = (part.ravel() for part in np.meshgrid(*[np.linspace(-reach, reach, count)] * 2))
    z = bowl * (x * x + y * y) / 35.0 - 2.0 + 7.0 * (1.0 - bowl)
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    lower = np.stack([corner, corner + 1, corner + count], axis=1)
    upper = np.stack([corner + 1, corner + count + 1, corner + count], axis=1)
    return np.stack([x + 12.0, y, z], axis=1), np.concatenate([lower, upper])
