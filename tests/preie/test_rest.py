"""Blocks at rest on elastic contacts: closed forms, the solver of one block, and relaxation with a law of its own."""

import math

import numpy as np
import pytest

from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.contact import JointStiffness
from slopekit.preie.equilibrium import equilibrium
from slopekit.preie.rest import RestOutcome, rest
from tests.preie.sections import block_in_space, columns, paper_wedge, polygons, stack, wall

EVEN = JointStiffness(tangential=1e6)
PAPER = JointStiffness()


@pytest.mark.parametrize("stiffness", [EVEN, PAPER], ids=["constant", "clough-duncan"])
@pytest.mark.parametrize(
    "model", [stack(1, 25.0, 35.0), block_in_space(25.0, 35.0), wall(4, 3)], ids=["2d", "3d", "wall"]
)
def test_a_block_below_its_friction_angle_does_not_creep(model: AssemblyModel, stiffness) -> None:
    """Issue 4. The law knows total displacements only, so asking again changes nothing."""
    first = rest(model, 1.2, stiffness)
    assert first.stands
    again = first
    for _ in range(20):
        again = rest(model, 1.2, stiffness, again)
    size = np.abs(first.displacement).max()
    assert np.abs(again.displacement - first.displacement).max() <= 1e-12 * size


def test_the_way_there_does_not_matter_to_one_block() -> None:
    """Up to a factor at which half of the pairs slip and down again."""
    model = block_in_space(25.0, 35.0, height=2.0)
    first = rest(model, 1.0, EVEN)
    back = rest(model, 1.0, EVEN, rest(model, 1.45, EVEN, first))
    assert back.displacement == pytest.approx(first.displacement, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(
    ("model", "area"), [(stack(1, 25.0, 35.0), 2.0), (block_in_space(25.0, 35.0, height=0.2), 4.0)]
)
def test_a_block_settles_by_its_weight_over_its_stiffness(model: AssemblyModel, area: float) -> None:
    """At the middle of the base: W cos β / (k_n A) into it and W sin β / (k_t A) down it, whatever the moments do."""
    found = rest(model, 1.0, EVEN)
    beta, weight = math.radians(25.0), model.force_scale
    opening, slip = model.opening_and_slip(found.scaled)
    assert opening @ model.control_area / model.control_area.sum() * model.length_scale == pytest.approx(
        -weight * math.cos(beta) / (1e7 * area), rel=1e-9
    )
    down = np.sqrt((np.average(slip, axis=0, weights=model.by_group(model.control_area)) ** 2).sum())
    assert down * model.length_scale == pytest.approx(weight * math.sin(beta) / (1e6 * area), rel=1e-9)
    assert found.normal_force.sum() == pytest.approx(weight * math.cos(beta), rel=1e-9)
    assert found.sticks.all()
    assert found.failed == 0


@pytest.mark.parametrize("factor", [1.0, 1.5])
@pytest.mark.parametrize("stiffness", [JointStiffness(tangential=4e6), PAPER], ids=["constant", "clough-duncan"])
def test_the_wedge_rests_where_the_solver_of_one_block_puts_it(stiffness, factor: float) -> None:
    """`preie.equilibrium`, another iteration and no assembly; its residual is 1e-9."""
    assembly, model = paper_wedge()
    ours, theirs = rest(assembly, factor, stiffness), equilibrium(model, factor, stiffness)
    assert ours.stands
    assert ours.displacement[0] == pytest.approx(theirs.displacement, rel=1e-6, abs=1e-12)
    assert ours.normal_force == pytest.approx(theirs.forces[:, 0], rel=1e-6)
    assert ours.friction == pytest.approx(theirs.forces[:, 1:], rel=1e-6, abs=1e-6 * model.force_scale)
    assert ours.failed == theirs.failed_pairs


def relaxed(model: AssemblyModel, factor: float, k_t: float, steps: int) -> tuple[np.ndarray, float]:
    """Viscous flow down the unbalanced forces of a section, dense, with a law of its own: displacement and residual."""
    dense = model.kinematics.toarray()
    pairs, groups = len(model.control_area), len(model.group_first)
    unit = model.area_scale * model.length_scale / model.force_scale
    k_n = 1e7 * unit * model.control_area
    sideways = unit * np.add.reduceat(model.control_area, model.group_first)
    damping = np.linalg.inv(dense.T @ (np.concatenate([k_n, 1e7 * sideways])[:, None] * dense))
    load = model.load.ravel()
    at = damping @ load
    for _ in range(steps):
        moved = dense @ at
        normal = k_n * np.maximum(-moved[:pairs], 0.0)
        strength = model.tan_friction / factor * np.add.reduceat(normal, model.group_first)
        friction = np.clip(-k_t * sideways * moved[pairs:], -strength, strength)
        out = dense.T @ np.concatenate([normal, friction]) + load
        at = at + damping @ out
    assert groups == len(friction)
    return at.reshape(model.load.shape), float(np.abs(out).max() / np.abs(load).max())


def test_toppling_columns_rest_where_relaxation_leaves_them() -> None:
    """Goodman & Bray's columns on an even bed, k_t = 1e6: near their end, which relaxation puts at 1.015 to 1.03.

    It lies above their limit of 0.99996: elastic columns lean on each other before they run (METHOD-3.md §13: a peak
    of 1.01 to 1.03).
    """
    model = columns()
    still, left = relaxed(model, 1.01, 1e6, 12000)
    assert left < 1e-9
    found = rest(model, 1.01, EVEN)
    assert found.stands
    assert found.scaled == pytest.approx(still, rel=1e-6, abs=1e-6 * np.abs(still).max())
    away, left = relaxed(model, 1.03, 1e6, 12000)
    assert left > 1e-3
    assert np.abs(away).max() > 3.0 * np.abs(still).max()
    assert not rest(model, 1.03, EVEN).stands


def test_columns_that_lean_open_behind_themselves() -> None:
    found = rest(columns(), 0.9, EVEN)
    assert found.stands
    assert found.residual < 1e-10
    assert found.is_open.any()
    assert (found.normal_force >= 0.0).all()
    assert (found.normal_force[found.is_open] == 0.0).all()
    assert not (found.sticks & found.slips).any()


@pytest.mark.parametrize(
    "model", [stack(1, 30.0, 35.0, width=1.5, c=30.0), block_in_space(30.0, 35.0, 1.0, 1.0, c=30.0)]
)
def test_a_pair_that_opens_loses_its_cohesion(model: AssemblyModel) -> None:
    """The weight of a block acts outside the middle third, so the upper side of its base opens."""
    found = rest(model, 1.0, EVEN)
    assert found.stands
    assert found.is_open.any()
    assert (found.bonded == ~found.is_open).all()
    slides = np.sqrt((found.friction**2).sum(axis=1))
    kept = model.by_group(np.where(found.bonded, model.cohesion, 0.0)) * model.force_scale
    carried = kept + model.tan_friction * model.by_group(found.normal_force)
    assert (slides <= carried * (1.0 + 1e-9) + 1e-9).all()


def test_what_slides_and_what_is_lifted_off_fall() -> None:
    assert rest(stack(3, 30.0, 35.0, width=20.0), 1.22, EVEN).outcome is RestOutcome.FALLS
    base = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    lifted = polygons([(base, (0.0, 0.0, 1.0))], (0.5, 0.5, 0.5), (0.0, 0.0, 5.0), (0.0, 0.0, 0.0), 30.0)
    found = rest(lifted, 1.0, EVEN)
    assert not found.stands
    assert found.outcome is RestOutcome.FALLS


@pytest.mark.parametrize("tips", [False, True])
def test_a_square_block_tips_at_45_degrees(tips: bool) -> None:
    """Its centre of gravity passes over the lower edge at β = 45°, issue 4: exactly there; φ is 60°."""
    found = rest(stack(1, 45.0 + (1e-6 if tips else -1e-6), 60.0, width=1.0), 1.0, EVEN)
    assert found.stands is not tips


@pytest.mark.parametrize("stands", [True, False])
def test_clough_duncan_carries_no_more_than_its_ceiling(stands: bool) -> None:
    """τ -> σ tan φ₁ / R_f = σ tan 44.5°, however rough the joint: φ is 60°."""
    steepest = math.degrees(math.atan(math.tan(math.radians(36.0)) / 0.74))
    found = rest(stack(1, steepest + (-0.1 if stands else 0.1), 60.0, width=2.0), 1.0, PAPER)
    assert found.stands is stands
