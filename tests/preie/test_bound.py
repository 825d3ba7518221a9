"""The static bound: planes, spheres with φ = 0, curved surfaces against Clarabel, and what is above it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from slopekit.kinds import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.programs.bound import static_bound
from tests.preie import conic_oracle
from tests.preie.test_limit import block_on_incline
from tests.scenes import COARSE, PAPER, SPHERE, model_of


@pytest.mark.parametrize(("dip", "c", "phi"), [(30, 0, 35), (30, 2, 20), (60, 10, 40), (20, 5, 0)])
def test_on_one_plane_the_bound_is_the_limit(dip, c, phi) -> None:
    """Normal forces are given there: dilation changes nothing (Davis 1968), to rounding."""
    model = block_on_incline(dip, c, phi, height=0.2)
    limit = pairs_limit(model).governing
    found = static_bound(model, limit.velocity, limit.factor)
    a = math.radians(dip)
    exact = (4.0 * c + 20.0 * math.cos(a) * math.tan(math.radians(phi))) / (20.0 * math.sin(a))
    assert found.factor == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("slip", [SPHERE, PAPER], ids=["sphere", "ellipsoid"])
def test_without_friction_a_turning_mass_has_but_one_factor(slip) -> None:
    """φ = 0: limit, bound and moment equilibrium are the same."""
    model = model_of({**slip, **COARSE}, phi=0.0)[0]
    limit = pairs_limit(model).governing
    found = static_bound(model, limit.velocity, limit.factor)
    assert found.factor == pytest.approx(limit.factor, rel=1e-9)
    assert conic_oracle.sparse_shortfall(model, 1.0 / (found.factor * (1.0 - 1e-6))) < 1e-8
    assert conic_oracle.sparse_shortfall(model, 1.0 / (found.factor * (1.0 + 1e-4))) > 1e-6


CYLINDER = {"shape": "cylinder", "centre": [40, 40], "radius": 42, "length": 20}
BOLTS = {"bolts": [{"force": 2e4, "toward": "270/20", "acts": "passive", "head": [20, 0, 20]}]}


@pytest.mark.parametrize(
    ("slip", "more"),
    [
        (CYLINDER, {}),
        (PAPER, {"c": 0.0}),
        (SPHERE, {"water": {"pressures": 30}}),
        (PAPER, {"loads": {"seismic": {"k": 0.15, "toward": 30}}}),
        (SPHERE, {"support": BOLTS}),
        (CYLINDER, {"support": BOLTS}),
    ],
    ids=[
        "plain cylinder",
        "ellipsoid without cohesion",
        "wet sphere",
        "shaken ellipsoid",
        "bolted sphere",
        "bolted",
    ],
)
def test_curved_surfaces_against_clarabel(slip, more) -> None:
    """Forces balance just below the bound (1e-5) and none do just above, by a program with other matrices."""
    model = model_of({**slip, **COARSE}, **more)[0]
    limit = pairs_limit(model).governing
    found = static_bound(model, limit.velocity, limit.factor)
    assert found.factor >= limit.factor
    below, above = (
        conic_oracle.sparse_shortfall(model, 1.0 / (found.factor * by))
        for by in (1.0 - 1e-5, 1.0 + 1e-5)
    )
    assert below < 0.0 < above


def test_the_mechanism_of_the_bound_satisfies_its_dual() -> None:
    """v_n >= λ tan φ |v_t| on every pair, and P·v = λ Σ c A |v_t| there (eq. of the module): to 1e-4 of the slip."""
    model = model_of({**PAPER, **COARSE})[0]
    limit = pairs_limit(model).governing
    found = static_bound(model, limit.velocity, limit.factor)
    slip = model.slip(found.velocity)
    opening = model.normal_rows @ found.velocity
    assert (opening - model.tan_friction / found.factor * slip).min() > -1e-4 * slip.max()
    work, cohesion = float(model.load @ found.velocity), float(model.cohesion @ slip)
    assert work * found.factor == pytest.approx(cohesion, rel=1e-3)


@pytest.mark.parametrize("by", [0.5, 2.0])
def test_strength_times_two_is_bound_times_two(by) -> None:
    model = model_of({**SPHERE, **COARSE})[0]
    limit = pairs_limit(model).governing
    one = static_bound(model, limit.velocity, limit.factor)
    scaled = replace(model, cohesion=by * model.cohesion, tan_friction=by * model.tan_friction)
    two = static_bound(scaled, limit.velocity, by * limit.factor)
    assert two.factor == pytest.approx(by * one.factor, rel=1e-6)
    assert np.isfinite(two.normal_force).all()


JAMS = {
    "dips": [[77.63, 48.29], [48.14, 253.4]],
    "face": [73.67, 312.8],
    "upper": [21.05, 312.8],
    "height": 35.91,
    "c": [30.18, 4.943],
    "phi": [35.26, 16.29],
    "unit_weight": 24.26,
    "water": [807.8, 60.93],
}


def test_where_the_joints_jam_newton_is_not_trusted() -> None:
    """A little more strength and forces however large balance: the distance is a step there. Bisection, to 1e-6."""
    model = cut(wedge_design(JAMS)).scene_at(0).model
    limit = pairs_limit(model).governing
    found = static_bound(model, limit.velocity, limit.factor)
    bound = conic_oracle.sparse_static_bound(model, limit.factor, near=found.factor)
    assert found.factor == pytest.approx(bound, rel=1e-6)
