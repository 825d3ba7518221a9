"""The limit and the static bound against exact slides, Clarabel, and each other."""

import math
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.orientation import Plane
from slopekit.geometry.interfaces import node_pairs
from slopekit.kinds import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.loads import Loads
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs.bound import static_bound
from slopekit.preie.system.model import JointStrength, Model, build_model
from tests.preie import conic_oracle
from tests.support import random_wedge


def block_on_incline(
    dip: float,
    c: float,
    phi: float,
    psi: float = 0.0,
    height: float = 1.0,
    push: float = 0.0,
    refine: int = 0,
) -> Model:
    """A 2 m x 2 m block of the given height on a plane dipping toward +x, weight 20 kN, pushed downhill."""
    a = math.radians(dip)
    down, across, up = (
        np.array([math.cos(a), 0, -math.sin(a)]),
        np.array([0.0, 1.0, 0.0]),
        np.array([math.sin(a), 0, math.cos(a)]),
    )
    square = np.array([down * x + across * y for x, y in ((-1, -1), (-1, 1), (1, 1), (1, -1))])
    centroid = up * height / 2
    weight = np.array([0.0, 0.0, -20.0])
    force = weight + push * down
    none = np.zeros((0, 3))
    loads = Loads(force, np.zeros(3), {"weight": weight, "push": push * down}, none, none)
    one = np.ones(1)
    strength = JointStrength(
        c * one, math.tan(math.radians(phi)) * one, math.tan(math.radians(psi)) * one, 0.0 * one
    )
    return build_model(node_pairs({0: square}, refine), loads, centroid, strength)


@pytest.mark.parametrize("refine", [0, 2])
@pytest.mark.parametrize(
    ("dip", "c", "phi"), [(30, 0, 35), (30, 2, 20), (10, 0.5, 5), (60, 10, 40)]
)
def test_block_on_an_incline_slides(dip, c, phi, refine) -> None:
    """F = (c A + W cos α tan φ) / W sin α, exact for a flat block: its moments open nothing that counts."""
    a = math.radians(dip)
    exact = (c * 4.0 + 20.0 * math.cos(a) * math.tan(math.radians(phi))) / (20.0 * math.sin(a))
    found = pairs_limit(block_on_incline(dip, c, phi, height=0.2, refine=refine)).governing
    assert found.factor == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(("height", "tips"), [(1.99, False), (2.01, True)])
def test_a_block_tips_at_its_geometric_limit(height, tips) -> None:
    """On a 45° plane a block 2 m long tips over its lower edge when it is higher than 2 m, whatever the friction."""
    found = pairs_limit(block_on_incline(45.0, 0.0, 60.0, height=height))
    assert (found.governing.outcome is Outcome.NO_STRENGTH) == tips
    if not tips:
        assert found.governing.factor == pytest.approx(math.tan(math.radians(60.0)), rel=1e-9)


def test_a_block_on_a_horizontal_plane_is_driven_by_nothing() -> None:
    assert (
        pairs_limit(block_on_incline(0.0, 0.0, 30.0)).governing.outcome is Outcome.NO_DRIVING_FORCE
    )


@pytest.mark.parametrize("psi", [5.0, 15.0, 30.0])
def test_dilation_of_one_plane(psi) -> None:
    """Dilation does not change the limit of a block on one plane: its shear force opposes the slip all the same.

    Forces: along the plane only, so F = tan φ / tan α for any ψ <= φ/F (Davis 1968 for this kinematics).
    """
    found = pairs_limit(block_on_incline(20.0, 0.0, 30.0, psi=psi, height=0.2)).governing
    assert found.factor == pytest.approx(
        math.tan(math.radians(30)) / math.tan(math.radians(20)), rel=1e-6
    )


def paper_model(c=(50, 50), phi=(20, 20), **more) -> Model:
    return (
        cut(wedge_design({"dips": ("45/115", "45/245"), "c": c, "phi": phi, **more}))
        .scene_at(0)
        .model
    )


@pytest.mark.parametrize("c", [50.0, 0.0])
def test_full_dilation_gives_the_static_bound(c) -> None:
    """ψ = φ, reduced with it, is associated flow: the limit is the static bound (METHOD.md §3: 1.5868)."""
    full = pairs_limit(paper_model((c, c), dilation=20.0)).governing.factor
    model = paper_model((c, c))
    bound = static_bound(
        model, pairs_limit(model).governing.velocity, pairs_limit(model).governing.factor
    )
    assert full == pytest.approx(bound.factor, rel=2e-6)


@pytest.mark.parametrize("psi", [2.0, 10.0, 19.0, 20.0])
def test_a_twisted_square_that_dilates_has_cohesion_where_it_touches_alone(psi) -> None:
    """It rises by the slip of its corners, which leaves all else behind: R λ (N tan φ + c A_corners) = M, by hand.

    Whatever the dilation, and as well where that is all of the reduced friction angle (F = 5: tan 20° / 5 < tan 10°):
    there the limit was the static bound, with c on all of the square, of which the corners' pairs are a quarter.
    """
    model = block_on_incline(0.0, 20.0, 20.0, psi=psi)
    weight, area, corner = (
        -model.load[2],
        model.control_area.sum(),
        math.sqrt(2.0) / model.length_scale,
    )
    torque = 0.3 * weight
    model = replace(model, load=np.array([0.0, 0.0, -weight, 0.0, 0.0, torque]))
    cohesion = 20.0 * area * model.area_scale / model.force_scale
    found = pairs_limit(model).governing
    by_hand = corner * (weight * math.tan(math.radians(20.0)) + cohesion / 4.0) / torque
    assert found.factor == pytest.approx(by_hand, rel=1e-7)
    assert static_bound(model, found.velocity, found.factor).factor > 1.5 * by_hand
    assert found.bond @ model.control_area == pytest.approx(area / 4.0, rel=1e-12)


@pytest.mark.parametrize("psi", [2.0, 14.0])
def test_a_wedge_that_would_dilate_as_it_twists_slides_on_one_joint(psi) -> None:
    """J2 is not pressed: (c A + W cos δ tan φ) / (W sin δ) on J1 by hand, dilation or not."""
    found = sk.wedge(dips=("40/160", "80/220"), c=100, dilation=psi)
    dip, weight, area = math.radians(40.0), found.forces.weight, found.geometry.areas_m2["J1"]
    by_hand = (100.0 * area + weight * math.cos(dip) * math.tan(math.radians(20.0))) / (
        weight * math.sin(dip)
    )
    assert found.fos.limit == pytest.approx(by_hand, rel=1e-6)
    assert found.fos.static_bound > 1.58


def dilatant_slide(c: float, phi: float, psi: float) -> float:
    """F of the paper's wedge by hand: v leaves both joints at ψ; three force equations in N₁, N₂ and λ, by SciPy."""
    from scipy.optimize import fsolve

    wedge = sk.wedge(dips=("45/115", "45/245"), c=c)
    normals = [Plane(45, direction).normal() for direction in (115, 245)]
    areas, weight = list(wedge.geometry.areas_m2.values()), wedge.forces.weight

    def out(x):
        v, pushes, reduction = np.array([0.0, x[0], x[1]]), x[2:4], x[4]
        slips = [v - (v @ n) * n for n in normals]
        sizes = [math.sqrt(slip @ slip) for slip in slips]
        force = np.array([0.0, 0.0, -1.0])
        for n, slip, size, push, area in zip(normals, slips, sizes, pushes, areas, strict=True):
            strength = c * area / weight + push * math.tan(math.radians(phi))
            force = force + push * n - reduction * strength * slip / size
        opens = normals[0] @ v - math.tan(math.radians(psi)) * sizes[0]
        return [opens, v @ v - 1.0, force[1], force[2], pushes[0] - pushes[1]]

    return 1.0 / fsolve(out, [-0.92, -0.38, 0.6, 0.6, 0.64], xtol=1e-13)[4]


@pytest.mark.parametrize("psi", [2.0, 5.0, 8.0])
@pytest.mark.parametrize("c", [50.0, 10.0, 0.0])
def test_dilation_against_the_forces_by_hand(c, psi) -> None:
    found = pairs_limit(paper_model((c, c), dilation=psi)).governing.factor
    assert found == pytest.approx(dilatant_slide(c, 20.0, psi), rel=1e-8)


def test_dilation_raises_the_limit_steadily() -> None:
    factors = [
        pairs_limit(paper_model(dilation=psi)).governing.factor
        for psi in (0.0, 3.0, 6.0, 9.0, 12.0)
    ]
    assert factors == sorted(factors)
    assert factors[0] == pytest.approx(1.5573963, abs=1e-6)
    assert factors[-1] < 1.58676


def random_models(count: int, seed: int):
    rng = np.random.default_rng(seed)
    while count:
        design = wedge_design({**random_wedge(rng), "bolts": None})
        model = cut(design).scene_at(0).model
        analysis = pairs_limit(model)
        if analysis.governing.factor:
            count -= 1
            yield model, analysis


@pytest.mark.slow
def test_static_bound_against_clarabel() -> None:
    """Other matrices, and bisection: to 1e-6 (Clarabel's margin is 1e-10)."""
    for model, analysis in random_models(25, 11):
        ours = static_bound(model, analysis.governing.velocity, analysis.governing.factor)
        assert ours.factor == pytest.approx(conic_oracle.static_bound(model, ours.factor), rel=1e-6)


@pytest.mark.slow
def test_turning_limit_against_the_conic_sequence() -> None:
    """Where every bond holds, the conic sequence of METHOD.md §4 (Clarabel) must find the same limit."""
    compared = 0
    for model, analysis in random_models(40, 12):
        turning = analysis.with_turning
        if turning.bond.all() and turning.factor and not analysis.moments_govern:
            assert conic_oracle.frozen_friction_limit(model) == pytest.approx(
                turning.factor, rel=2e-4
            )
            compared += 1
    assert compared > 10


def test_reducing_the_strength_by_the_limit_leaves_one() -> None:
    wedge = {
        "dips": ("45/105", "70/235"),
        "face": "65/185",
        "upper": "12/195",
        "height": 30.0,
        "water": "50%",
    }
    first = sk.wedge(**wedge, c=(24, 48), phi=(20, 30)).fos.limit
    reduced = [math.degrees(math.atan(math.tan(math.radians(phi)) / first)) for phi in (20, 30)]
    again = sk.wedge(**wedge, c=(24 / first, 48 / first), phi=reduced).fos.limit
    assert again == pytest.approx(1.0, rel=1e-9)
