"""Numbers that others print of bench and cut design, each read where its source says; none of them is from memory.

Sources read in November 2026: the examples page of Lythos Kinematic (Altuntaş, GitHub hdaltuntas/lythoskinematic and
its pages), an independent program; xslope (Jones, GitHub njones61/xslope), its description of problem 2.45 of the
GeoStudio Slope Stability Verification Manual (October 2022), which is the example on p. 202 of the Designers' Guide to
Eurocode 7; PmagPy's documentation of `fisher_mean`; Ryan & Pryor (2000), Designing catch benches and interramp slopes,
as quoted with its eq. 3.1 in the notes of a model of an open pit on GitHub.

Looked for and not found with all inputs: a published pentahedral wedge, a worked number of Jennings' equation, traces
and persistence of SWedge's tutorial 5, a spill width of Gibson et al. (2006). Their tests rest on formulas and on other
ways to the same number (`tests/kinds/test_basal.py`, `tests/strength/test_bridged_and_residual.py`).
"""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.closed_form.berms import catch_width, inter_ramp_angle
from slopekit.closed_form.sizes import plane_sizes, wedge_sizes
from slopekit.closed_form.toppling import ColumnSlope, toppling_table
from slopekit.studies.axes import axes_of

# -- partial factors -------------------------------------------------------------------------------------------------


def test_a_cutting_in_clay_by_design_approach_3() -> None:
    """GeoStudio 2.45: over-design factors of SLOPE/W 1.173 (Bishop) and 1.174 (Spencer); the book has 1.193 (Bishop).

    The circle is SLOPE/W's own. Its 35 kPa from x = 52 to 62 m stand here as 1.75 m of the clay itself (W324: columns
    know no forces): 0.15 % more, as slices of a few lines say. The rigid body lies 3 % higher, as without factors.
    """
    design = {
        "slopekit": 1,
        "kind": "surface",
        "strength": {"clay": {"c": 10, "phi": 28}},
        "rock": {"unit_weight": 20},
        "slope": {
            "profile": [
                [80, 15],
                [62, 15],
                [62, 16.75],
                [52, 16.75],
                [52, 15],
                [50, 15],
                [30, 5],
                [0, 5],
            ]
        },
        "slip": {"shape": "cylinder", "centre": [35.4, 25.467], "radius": 22.099, "edge": 2.0},
        "water": {
            "mode": "table",
            "points": [[0, 5], [30, 5], [45.5, 9], [70, 12], [82, 12]],
            "unit_weight": 9.807,
        },
        "analysis": {"partial_factors": "DA3"},
    }
    found = sk.run(design)
    assert found.methods["bishop"] == pytest.approx(1.173, rel=2e-3)
    assert found.fos.limit == pytest.approx(1.174, rel=0.035)
    plain = sk.run(
        design | {"analysis": {}}
    )  # M2 alone acts: both divided by 1.25, and so is the factor
    assert plain.methods["bishop"] == pytest.approx(1.25 * found.methods["bishop"], rel=1e-6)


# -- sizes -----------------------------------------------------------------------------------------------------------

PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "72/180", "height": 20, "upper": "0/180"},
    "joints": {"J1": {"plane": "34/180"}},
    "crack": {"distance": 6},
    "strength": {"s": {"c": 0, "phi": 31}},
    "rock": {"unit_weight": 25},
}


def test_a_block_on_a_plane_as_lythos_prints_it() -> None:
    """132.302 m², W 3307.54, N 2742.07, driving 1849.55, resisting 1647.60 kN, 15.076 m of plane, crack 11.57 m."""
    found = sk.run(PLANE)
    geometry, forces = found.geometry, found.forces
    assert (round(geometry.volume_m3, 3), round(geometry.areas_m2["J1"], 3)) == (132.302, 15.076)
    assert (round(geometry.areas_m2["crack"], 2), round(geometry.setback_m, 6)) == (11.57, 6.0)
    printed = forces.weight, forces.normal["J1"], forces.driving, forces.resisting
    assert [round(value, 2) for value in printed] == [3307.54, 2742.07, 1849.55, 1647.60]
    sizes = plane_sizes(34.0, 72.0, 0.0, 20.0, 6.0)
    assert (round(float(sizes.area_m2[0]), 3), round(float(sizes.length_m[0]), 3)) == (
        132.302,
        15.076,
    )


def test_its_support_as_lythos_prints_it() -> None:
    """697 kN per metre at -12.2°, Hoek & Bray's optimum tan(ψ + θ) = tan φ / F, raise it from 0.891 to 1.5."""
    dip = math.degrees(math.atan(math.tan(math.radians(31.0)) / 1.5)) - 34.0
    assert round(dip, 1) == -12.2
    found = sk.support(sk.load(PLANE), 1.5, acts="active", toward=f"000/{dip!r}")
    bolts = found.to_dict()["bolts"][0]
    assert [round(found.without["fos"][key], 3) for key in ("limit", "closed_form")] == [
        0.891,
        0.891,
    ]
    assert [round(bolts[key]["force_kn"]) for key in ("closed_form", "pre_ie")] == [697, 697]


def test_a_wedge_as_lythos_prints_it() -> None:
    """13151.053 m³, 328776.31 kN, line 157.7/31.2; F 1.696 dry, 1.065 full of water; its 40 m are up the face."""
    sizes = wedge_sizes(45, 105, 70, 235, 65, 185, 12, 195, 40.0, up_the_face=True)
    assert round(float(sizes.volume_m3[0]), 3) == 13151.053
    height = sizes.trace1_m[0] * _rise(45, 105, 65, 185)
    given = {
        "dips": ("45/105", "70/235"),
        "face": "65/185",
        "upper": "12/195",
        "height": float(height),
        "c": (24, 48),
        "phi": (20, 30),
        "unit_weight": 25,
    }
    dry, wet = sk.wedge(**given), sk.wedge(**given, water="full")
    assert (round(dry.geometry.volume_m3, 3), round(dry.forces.weight, 2)) == (13151.053, 328776.31)
    assert [round(dry.geometry.line[angle], 1) for angle in ("trend_deg", "plunge_deg")] == [
        157.7,
        31.2,
    ]
    assert (round(dry.fos.closed_form, 3), round(wet.fos.closed_form, 3)) == (1.696, 1.065)
    forces_only = wet.comparisons.forces_only
    assert (dry.fos.limit, forces_only) == pytest.approx(
        (dry.fos.closed_form, wet.fos.closed_form), rel=1e-6
    )
    assert 0.97 * forces_only < wet.fos.limit < forces_only  # uplift opens part of a joint


def _rise(dip: float, to: float, face: float, face_to: float) -> float:
    """Height per length of the trace of a joint on a face."""
    one, two = (
        np.array(
            [math.sin(math.radians(a)) * f(math.radians(b)) for f in (math.sin, math.cos)]
            + [math.cos(math.radians(a))]
        )
        for a, b in ((dip, to), (face, face_to))
    )
    trace = np.cross(one, two)
    return abs(float(trace[2])) / float(np.linalg.norm(trace))


# -- kinematics ------------------------------------------------------------------------------------------------------


def test_six_sets_as_lythos_screens_them() -> None:
    """Face 72/230, φ 31°, ±20°: of T2, T1, E3, E1, E2, J6 E3 slides, T2 x E3 is the one wedge of 15, J6 topples."""
    sets = {
        "T2": "73/152",
        "T1": "69/189",
        "E3": "34/232",
        "E1": "28/104",
        "E2": "21/303",
        "J6": "50/060",
    }
    found = sk.kinematic(sets, face="72/230", phi=31, lateral=20, lateral_toppling=20)
    assert (found.joint_names("planar"), found.joint_names("flexural")) == (("E3",), ("J6",))
    steep = np.flatnonzero(found.modes.wedge == 1)  # lines steeper than the friction angle
    names = list(sets)
    pairs = [(names[found.lines.first[k]], names[found.lines.second[k]]) for k in steep]
    assert (pairs, len(found.modes.wedge)) == ([("T2", "E3")], 15)
    assert found.counts["wedge_primary"] == 1


@pytest.mark.parametrize(
    ("one", "other", "plunge", "trend"),
    [
        ("45/105", "70/235", 31.2, 157.7),
        ("45/105", "60/020", 41.9, 78.8),
        ("70/235", "60/020", 32.5, 311.6),
    ],
)
def test_lines_of_intersection_as_lythos_prints_them(one, other, plunge, trend) -> None:
    lines = sk.kinematic([one, other], face="65/185", phi=30).lines
    assert (round(float(lines.plunge_deg[0]), 1), round(float(lines.trend_deg[0]), 1)) == (
        plunge,
        trend,
    )


# -- toppling --------------------------------------------------------------------------------------------------------


def test_the_columns_of_wyllie_and_mah_as_lythos_prints_them() -> None:
    """ψ_f 56.6°, ψ_s 4°, ψ_b 35.8°, Δx 10 m, 10 columns below the crest; a₁, a₂ and b are not rounded.

    On columns 5 and 13 P is 3970.2 and 307.4 kN. Its columns 3 and 4 slide, where Goodman & Bray's
    own table has column 4 topple, so that its factor, 1.020, is not compared.
    """
    made = sk.load(
        {
            "slopekit": 1,
            "kind": "topple",
            "columns": {"dip": 60, "width": 10, "base_angle": 35.8},
            "slope": {"height": _height(10), "face": 56.6, "upper": 4},
            "rock": {"unit_weight": 25},
            "strength": {"joint": {"c": 0, "phi": 38.15}},
        }
    )
    heights = np.array(made.heights_m)
    assert len(heights) == 16
    assert np.round(heights[[0, 1, 2, 3, 4, 12, 13]], 2).tolist() == [
        3.99,
        7.98,
        11.98,
        15.97,
        19.96,
        22.24,
        16.35,
    ]
    weights = 25.0 * 10.0 * heights[[0, 1, 2, 3, 4, 12, 13]]
    assert np.round(weights).tolist() == [998, 1996, 2994, 3992, 4990, 5560, 4087]
    table = toppling_table(ColumnSlope(made.heights_m, 10.0, made.base_step_m, 30.0, 25.0, 38.15))
    assert table.force_kn[[4, 12, 13]] == pytest.approx(
        [3970.2, 307.4, 0.0], abs=0.8
    )  # its ψ_b has one decimal
    assert [table.modes[k] for k in (4, 12, 13)] == ["topple", "topple", "stable"]


def _height(columns: int) -> float:
    """From the foot of column 1 to the crest: the outer top corner of the last column below it is on the face."""
    along = (
        10.0 * columns * math.cos(math.radians(30.0)),
        10.0 * columns * math.sin(math.radians(30.0)),
    )
    step = 10.0 * math.tan(math.radians(5.8)) * (columns - 1)
    tall = columns * 10.0 * (math.tan(math.radians(26.6)) - math.tan(math.radians(5.8)))
    return along[1] + (step + tall) * math.cos(math.radians(30.0))


# -- the survey ------------------------------------------------------------------------------------------------------


def test_fisher_statistics_as_pmagpy_prints_them() -> None:
    """Lines 140/21, 127/23, 142/19, 136/22: R 3.98121, k 159.69, α95 7.29°, mean 136.31/21.35.

    The mean is the sum of the vectors; the first eigenvector lies 0.02° off.
    """
    trend, plunge = np.radians([140.0, 127.0, 142.0, 136.0]), np.radians([21.0, 23.0, 19.0, 22.0])
    lines = np.stack(
        [np.cos(plunge) * np.sin(trend), np.cos(plunge) * np.cos(trend), -np.sin(plunge)], axis=1
    )
    found = axes_of(lines, np.ones(4), None, 0.95)
    assert found.resultant * 4 == pytest.approx(3.9812138971889026, rel=1e-10)
    assert found.k == pytest.approx(159.69251473636305, rel=1e-10)
    assert found.cone_deg == pytest.approx(7.292891411309177, rel=1e-10)
    east, north, up = found.mean
    assert math.degrees(math.atan2(east, north)) == pytest.approx(136.30838974272072, abs=0.03)
    assert math.degrees(math.asin(-up)) == pytest.approx(21.347784026899987, abs=0.03)


# -- benches ---------------------------------------------------------------------------------------------------------


def test_a_berm_and_an_inter_ramp_angle_by_ryan_and_pryor() -> None:
    """Eq. 3.1, 0.2 H + 4.5 m: 7.5 m for a bench of 15 m; tan ψ = H / (W + H cot β): 48.10° with 70° and 8.0 m."""
    assert float(catch_width(15.0)) == pytest.approx(7.5, rel=1e-12)
    assert round(float(inter_ramp_angle(15.0, 70.0, 8.0)), 2) == 48.10
