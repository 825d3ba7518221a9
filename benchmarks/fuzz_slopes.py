"""Designs that `benchmarks.fuzz` mutates, and values of their keys: what decides about a bench or a cut.

Load cases and partial factors, basal joints, limits of size, water tables and ponds, surcharges, cracks at the worst
place, columns made from a slope, rock bridges, residual strength, curved laws, joint sets.
"""

#: Designs by name.
SLOPES = {
    "basal wedge": """\
slopekit: 1
kind: wedge
project: {name: Route 7, client: R. Office, number: 12-4, author: A, checker: B, revision: 2, date: 2026-11-22}
slope: {face: 70/180, upper: 5/180, height: 20 m}
joints: {J1: {plane: 80/100, strength: joint}, J2: {plane: 78/262, strength: joint}}
basal: {plane: 28/185, height: 4 m, strength: bedding}
crack: {plane: 85/180, distance: 8 m}
strength: {joint: {c: 0, phi: 32}, bedding: {c: 10 kPa, phi: 24, residual: {c: 0, phi: 20}}}
rock: {unit_weight: 26 kN/m3}
water: {pressures: {basal: 10 kPa, crack: 8 kPa, J1: 2}}
acceptance: {rules: ["fos >= 1.3"]}
""",
    "basal wedge under a table": """\
slopekit: 1
kind: wedge
slope: {face: 70/180, upper: 5/180, height: 20 m}
joints: {J1: {plane: 80/100}, J2: {plane: 78/262}}
basal: {plane: 20/175, height: -2 m}
strength: {joint: {law: bridged, c: 0, phi: 30, c_rock: 500 kPa, phi_rock: 45, persistence: 0.97}}
rock: {unit_weight: 26}
water: {mode: table, plane: 5/180@8m, pond: 3 m}
loads: {surcharge: 15 kPa, seismic: 0.05}
""",
    "limited wedge": """\
slopekit: 1
kind: wedge
slope: {face: 65/180, upper: 3/180, height: 25 m}
joints: {J1: {plane: 50/130}, J2: {plane: 55/240}}
strength: {fill: {c: 12 kPa, phi: 28, residual: {c: 0, phi: 25}, waviness: 3}}
rock: {unit_weight: 26}
limits: {trace_length: {J1: 15, J2: 20}, persistence: 30 m, slope_length: 40, bench_width: 8 m, max_volume: 2000 m3,
         min_volume: 1, by: scale}
water: {fill: 40 %}
cases:
  wet: {set: {water: full}, accept: "fos >= 1.1"}
  whole: {set: {limits: {max_volume: 1e5, by: filter}}}
""",
    "wedge with a table": """\
slopekit: 1
kind: wedge
slope: {face: 65/185, upper: 12/195, height: 30 m}
joints: {J1: {plane: 45/105, strength: a}, J2: {plane: 70/235, strength: b}}
crack: {plane: 80/185, distance: worst}
strength:
  a: {law: barton-bandis, jrc: 8, jcs: 50 MPa, phi_r: 25, length: 10 m, length_0: 0.2 m, waviness: 2}
  b: {law: bilinear, phi: 25, i: 15, sigma_t: 300 kPa}
rock: {unit_weight: 26}
water: {mode: table, points: [[0, 0], [15, 9], [40, 20]], unit_weight: 10}
loads: {surcharge: 10 kPa, seismic: {k: 0.05, toward: 185}}
""",
    "cracked wedge": """\
slopekit: 1
kind: wedge
slope: {face: 60/180, upper: 10/180, height: 30 m}
joints: {J1: {plane: 45/115}, J2: {plane: 45/245}}
crack: {plane: 80/180, distance: worst, water: 60 %}
strength: {joint: {law: power, a: 1.5, b: 0.8, d: 3}}
rock: {density: 2600}
water: {fill: 50 %}
analysis: {partial_factors: {set: DA1-C1, tan_phi: 1.2, c: 1.2}}
""",
    "factored wedge": """\
slopekit: 1
kind: wedge
slope: {face: 65/180, upper: 0/180, height: 15 m}
joints: {J1: {plane: 48/125}, J2: {plane: 55/240}}
strength: {joint: {c: 20 kPa, phi: 35, tension: 2}}
rock: {unit_weight: 26}
loads: {forces: [100 kN@180/10, {force: 50, toward: {trend: 175, plunge: 5}}], surcharge: 5}
support: {bolts: ["300 kN@000/10,passive"]}
analysis:
  partial_factors: {permanent_unfavourable: 1.35, permanent_favourable: 1, variable_unfavourable: 1.5,
                    variable_favourable: 0, tan_phi: 1.1, c: 1.2, unit_weight: 1, resistance: 1.1, forces: variable}
cases:
  DA1-C1: {set: {analysis.partial_factors: DA1-C1}}
  DA1-C2: {set: {analysis.partial_factors: {set: DA1-C2, forces: permanent}}, accept: ["fos >= 1", "fos.limit > 0.9"]}
  DA3: {set: {analysis.partial_factors.set: DA3, water: {fill: 0.2}}}
  own: {set: {analysis.partial_factors: office.yaml}, accept: "fos >= 1"}
""",
    "plane under a table": """\
slopekit: 1
kind: plane
slope: {face: 65/180, height: 18 m, upper: 8/180}
joints: {J1: {plane: 33/180}}
crack: {distance: worst}
strength: {bedding: {law: bridged, c: 5 kPa, phi: 30, c_rock: 1 MPa, phi_rock: 45, persistence: 0.99}}
rock: {unit_weight: 26}
water: {mode: table, depth: 3 m, pond: 2 m}
loads: {surcharge: 20 kPa}
""",
    "plane with points": """\
slopekit: 1
kind: plane
slope: {face: 60/180, height: 12 m, upper: 0/180}
joints: {J1: {plane: 35/180}}
crack: {depth: 4.35 m, water: 50 %}
strength: {bedding: {c: 25 kPa, phi: 37, residual: {c: 2 kPa, phi: 33}}}
rock: {unit_weight: 26}
loads: {seismic: 0.1, surcharge: 5}
cases:
  table: {set: {water: {mode: table, points: [[0, 0], [20, 9]]}, crack: {depth: 4 m}}}
  pond: {set: {water: {mode: table, pond: 4 m}, crack: null}}
  worst: {set: {crack: {distance: worst, water: 30 %}}, accept: "fos > 1"}
""",
    "tube under a table": """\
slopekit: 1
kind: surface
slope: {profile: [[60, 0], [40, 0], [0, 40], [-20, 40]]}
slip: {shape: cylinder, centre: [50, 50], radius: 48, length: 6 m, edge: 9}
strength: {zone: {c: 40 kPa, phi: 25}}
rock: {unit_weight: 20}
water: {mode: table, points: [[-20, 20], [10, 12], [50, 1]], pond: 2}
cases: {dry: {set: {water: null}, accept: "fos >= 1.2"}, deep: {set: {water: {mode: table, depth: 5}}}}
""",
    "topple from a slope": """\
slopekit: 1
kind: topple
slope: {height: 20 m, face: 65, upper: 5}
columns: {dip: 65, width: 4 m, base_angle: 32, thickness: 2, base: slate, sides: joint}
strength: {slate: {c: 0, phi: 38}, joint: {law: barton-bandis, jrc: 6, jcs: 40 MPa, phi_r: 30}}
rock: {unit_weight: 25}
water: {mode: table, plane: 10/180@4m}
loads: {surcharge: {C2: 5}}
analysis: {mechanisms: 2}
cases:
  dry: {set: {water: null}, accept: "fos >= 1.2"}
  step: {set: {columns.base_angle: null, columns.base_step: 0.5}}
""",
    "bench under a table": """\
slopekit: 1
kind: bench
slope: {face: 70/180, height: 8 m, upper: 0/180, length: 16 m, depth: 8 m}
sets:
  S1: {plane: 35/175, spacing: 4 m, strength: joint}
  S2: {plane: 85/265, spacing: 5 m, strength: joint, scatter: 2}
  S3: {plane: 75/350, spacing: 5 m, strength: joint, spacing_scatter: 0.1}
strength: {joint: {c: 2, phi: 34, residual: {c: 0, phi: 30}}}
rock: {unit_weight: 26}
cut: {max_blocks: 400, min_volume: 0.02, seed: 3}
water: {mode: table, depth: 2 m, pond: 1}
loads: {surcharge: 5}
""",
    "blocks under a table": """\
slopekit: 1
kind: blocks
blocks:
  base: {polygon: [[-7, 7], [0, 0], [12, 0], [12, -2], [-7, -2]], fixed: true}
  B1: {polygon: [[0, 0], [0, 5], [-5, 5]]}
  B2: {polygon: [[0, 0], [10, 0], [10, 5], [0, 5]]}
strength: {joint: {c: 0, phi: 30}}
interfaces: {default: joint}
rock: {unit_weight: 25}
water: {mode: table, points: [[-7, 4], [12, 1]], pond: 0.5}
loads: {surcharge: {B2: 3}}
support: {bolts: [{force: 20, toward: 090/00, block: B2}]}
cases: {dry: {set: {water: null}}, quake: {set: {loads.seismic: 0.05@90}, accept: "fos >= 1"}}
""",
}

_FACTORS = ("0", "1e-6", "0.9", "1", "1.25", "1.35", "10", "11")
_SIZES = ("1e-9", "0.5", "5 m", "20", "1e3", "1e9")
#: Values of their keys.
VALUES: dict[str, tuple[object, ...]] = {
    "by": ("scale", "filter"),
    "trace_length": _SIZES,
    "slope_length": _SIZES,
    "bench_width": _SIZES,
    "persistence": ("0", "1e-9", "0.5", "0.97", "1", "99 %", "25"),
    "max_volume": ("1e-9", "1", "100 m3", "1e12"),
    "min_volume": ("0", "1e-9", "1", "1e12"),
    "pond": ("-100", "-1e-9", "0", "1e-6", "3 m", "12", "20", "1e4"),
    "points": ("-1e6", "-5", "0", "9", "15", "20", "1e6"),
    "surcharge": ("0", "1e-9", "10 kPa", "1e3", "1e12"),
    "base_angle": ("0.01", "10", "24", "25", "30", "45", "89"),
    "base_step": ("0", "1e-6", "0.5", "2", "50"),
    "heights": ("1e-6", "0.5", "4", "40", "1e5"),
    "width": ("1e-3", "0.5", "2", "10", "1e4"),
    "thickness": ("1e-3", "1", "100"),
    "mechanisms": ("1", "2", "5"),
    "waviness": ("0", "1", "15", "40", "89"),
    "jrc": ("0", "1", "8", "20", "25"),
    "jcs": ("1e-6", "1 MPa", "50 MPa", "1e9"),
    "phi_r": ("0", "15", "30", "60", "69.9"),
    "a": ("0", "0.1", "2", "1000"),
    "d": ("0", "5", "1e6"),
    "i": ("0", "5", "15", "45", "60"),
    "sigma_t": ("1e-6", "1", "300 kPa", "1e9"),
    "c_rock": ("0", "1 MPa", "1e9"),
    "phi_rock": ("0", "45", "89.9"),
    "length_0": ("1e-3", "0.1", "1 m", "1e4"),
    "law": ("mohr-coulomb", "barton-bandis", "power", "bilinear", "bridged"),
    "set": ("DA1-C1", "DA1-C2", "DA2", "DA3"),
    "partial_factors": ("DA1-C1", "DA2", "DA3", "office.yaml", "gone.yaml"),
    "accept": ("fos >= 1", "fos >= 5", "fos.closed_form > 0.1", "fos.static_bound >= 1"),
    "spacing": ("1e-3", "0.5", "3 m", "50"),
    "scatter": ("0", "1e-6", "5", "45"),
    "offset": ("-5", "0", "0.3", "1e3"),
    "spacing_scatter": ("0", "10 %", "1"),
    "max_blocks": ("1", "20", "500"),
    "seed": ("0", "7", "9223372036854775807"),
    "tan_phi": _FACTORS,
    "resistance": _FACTORS,
    "permanent_unfavourable": _FACTORS,
    "permanent_favourable": _FACTORS,
    "variable_unfavourable": _FACTORS,
    "variable_favourable": _FACTORS,
}

_TABLES = (
    "{mode: table, depth: 2 m}",
    "{mode: table, depth: 0}",
    "{mode: table, depth: 1e4}",
    "{mode: table, pond: 5 m}",
    "{mode: table, points: [[0, 0], [10, 6], [30, 12]]}",
    "{mode: table, points: [[0, 50], [30, 50]]}",
    "{mode: table, points: [[0, 5]], pond: 3}",
    "{mode: table, plane: 5/180@2m}",
    "{mode: table, plane: 20/000@9m}",
    "{mode: table, plane: 0/0@-1m, pond: 30}",
    "{mode: table, depth: 1, pond: 8, unit_weight: 15}",
    "{mode: table, points: [[-1e5, 3], [1e5, 9]]}",
    "{mode: table}",
    "{depth: 2}",
)
_OF_LOADS = (
    "{surcharge: 10}",
    "{surcharge: 1e5}",
    "{surcharge: 0}",
    "{surcharge: 50 kPa, seismic: 0.4}",
    "{surcharge: {B1: 9}}",
    "{surcharge: {C1: 20 kPa, C2: 1e4}}",
)
_OF_CASES = (
    '{one: {accept: "fos >= 1.5"}}',
    "{a: {set: {loads.seismic.k: 0.2}}, b: {set: {water: full}}}",
    "{a: {set: {analysis.partial_factors: DA2}}}",
    "{a: {set: {slope.height: 5}}, A: {set: {slope.height: 6}}}",
    "{a: {set: {title: x}}}",
    "{a: {set: {kind: plane}}}",
    "{a: {set: {cases: {b: {}}}}}",
    "{a: {}}",
    "{a: ~}",
    "{a: {set: {support.bolts: [1e5@000/0]}}}",
    "{a: {set: {strength: null}}}",
    "{a: {set: {joints.J1: null}}}",
    "{a: {set: {water.pressures: {J1: 5}, water.fill: 0.5}}}",
    "{../a: {set: {water: full}}}",
    "{a: {set: {acceptance.rules: fos > 2}, accept: fos > 1}}",
    "{a: {set: {crack.distance: worst}}}",
)
_OF_ANALYSIS = (
    "{partial_factors: DA1-C2}",
    "{partial_factors: {set: DA2, forces: variable}}",
    "{partial_factors: {tan_phi: 1e-3}}",
    "{partial_factors: {tan_phi: 1.2, c: 1.4}, criterion: all-pairs}",
    "{partial_factors: office.yaml}",
    "{partial_factors: office.yaml ULS}",
    "{partial_factors: broken.yaml}",
    "{partial_factors: {set: DA1-C1, unit_weight: 1.1, resistance: 5}}",
)
_OF_STRENGTH = (
    "{s: {law: bridged, c: 0, phi: 30, c_rock: 1e3, phi_rock: 50, persistence: 0}}",
    "{s: {law: bridged, c: 0, phi: 0, c_rock: 0, phi_rock: 0, persistence: 1}}",
    "{s: {law: bridged, c: 0, phi: 30, c_rock: 1 MPa, phi_rock: 45, persistence: 0.9, waviness: 5}}",
    "{s: {law: bridged, c: 5, phi: 30, c_rock: 1, phi_rock: 20, persistence: 0.5, residual: {c: 0, phi: 25}}}",
    "{s: {c: 20, phi: 35, residual: {c: 0, phi: 0}}}",
    "{s: {c: 20, phi: 35, residual: {c: 20, phi: 35}}}",
    "{s: {law: power, a: 1, b: 0.7, residual: {c: 0, phi: 20}}}",
    "{s: {law: power, a: 0, b: 1, d: 5}}",
    "{s: {law: barton-bandis, jrc: 20, jcs: 1 MPa, phi_r: 35}}",
    "{s: {law: bilinear, phi: 30, i: 20, sigma_t: 50}}",
)
_COMMON = tuple(
    (key, text)
    for key, texts in (
        ("water", _TABLES),
        ("loads", _OF_LOADS),
        ("cases", _OF_CASES),
        ("analysis", _OF_ANALYSIS),
        ("strength", _OF_STRENGTH),
    )
    for text in texts
)
#: Sections to put in the place of a design's own, by kind.
SECTIONS: dict[str, tuple[tuple[str, str], ...]] = {
    "wedge": (
        *_COMMON,
        *(
            ("basal", text)
            for text in (
                "{plane: 25/180, height: 5}",
                "{plane: 0/0, height: 2}",
                "{plane: 60/000, height: 3}",
                "{plane: 30/180, height: 1e-9}",
                "{plane: 20/150, height: -3}",
                "{plane: 10/200, height: 19.9}",
                "{plane: 45/180, height: 1e5}",
                "{plane: 70/180, height: 4}",
            )
        ),
        *(
            ("limits", text)
            for text in (
                "{trace_length: 5}",
                "{persistence: {J1: 3}}",
                "{bench_width: 1e-6}",
                "{slope_length: 2, by: filter}",
                "{max_volume: 1, min_volume: 2}",
                "{min_volume: 1e9}",
                "{}",
                "{trace_length: {X: 3}}",
                "{by: filter}",
            )
        ),
        *(
            ("crack", text)
            for text in (
                "{plane: 80/180, distance: worst}",
                "{plane: 90/180, distance: worst, water: full}",
                "{plane: 85/200, distance: worst, water: 5 kPa}",
            )
        ),
    ),
    "plane": (
        *_COMMON,
        *(
            ("crack", text)
            for text in (
                "{distance: worst}",
                "{distance: worst, water: full}",
                "{distance: worst, water: 30 %}",
                "{distance: worst, water: 2}",
                "{distance: worst, depth: 3}",
                "{depth: 3, water: 5 kPa}",
            )
        ),
    ),
    "surface": _COMMON,
    "topple": (
        *_COMMON,
        *(
            ("slope", text)
            for text in (
                "{height: 30, face: 60}",
                "{height: 10, face: 40, upper: 10}",
                "{height: 1e-3, face: 80}",
                "{height: 500, face: 70}",
                "{height: 20, face: 20}",
                "{height: 20, face: 60, upper: 60}",
            )
        ),
        *(
            ("columns", text)
            for text in (
                "{dip: 60, width: 3, base_angle: 35}",
                "{dip: 60, width: 3, base_angle: 30}",
                "{dip: 85, width: 2}",
                "{dip: 60, width: 3, base_angle: 20}",
                "{dip: 60, width: 3, heights: [3, 4, 5], base_angle: 33}",
                "{dip: 70, width: 5, base_step: 1}",
            )
        ),
    ),
    "bench": _COMMON,
    "blocks": _COMMON,
}
#: Keys with values, to stand where they may not belong.
FRAGMENTS = (
    "basal: {plane: 25/180, height: 4}",
    "limits: {max_volume: 10}",
    "surcharge: 10 kPa",
    "mode: table",
    "depth: 3 m",
    "pond: 2 m",
    "points: [[0, 0], [9, 5]]",
    "residual: {c: 0, phi: 20}",
    "law: bridged",
    "persistence: 0.9",
    "partial_factors: DA2",
    'cases: {a: {accept: "fos > 1"}}',
    "distance: worst",
    "base_angle: 33",
    "waviness: 4",
    "set: DA1-C1",
    "forces: variable",
    "by: filter",
    "height: 5",
    "trace_length: 4",
    "project: {name: x}",
)
#: Files of partial factors that they name.
FACTOR_FILES = {
    "office.yaml": "title: of the office\nsource: memo 12\ndate: 2026\nsets: {ULS: {tan_phi: 1.3, c: 1.6}}\n",
    "broken.yaml": "title: [of the office\nsets: {ULS: {tan_phi: x, c: -1}, B: 5}\n",
}
