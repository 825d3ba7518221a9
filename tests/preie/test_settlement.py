"""Blocks at rest on elastic joints: closed forms, the solver of one block, and relaxation with a law of its own."""

import math

import numpy as np
import pytest

from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.motion.equilibrium import equilibrium
from slopekit.preie.motion.settlement import Settlement, settlement
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.contact import JointStiffness
from tests.preie.sections import block_in_space, columns, paper_wedge, polygons, stack, wall

EVEN = JointStiffness(tangential=1e6)
PAPER = JointStiffness()


def in_model_units(model: AssemblyModel, found: Settlement) -> np.ndarray:
    """Its displacement (n, u) as the model has it: lengths in parts of the length scale."""
    u = model.unknowns
    return found.displacement / np.where(np.arange(u) < u // 2 + u % 2, model.length_scale, 1.0)


@pytest.mark.parametrize("stiffness", [EVEN, PAPER], ids=["constant", "clough-duncan"])
@pytest.mark.parametrize(
    "model",
    [stack(1, 25.0, 35.0), block_in_space(25.0, 35.0), wall(4, 3)],
    ids=["2d", "3d", "wall"],
)
def test_a_block_below_its_friction_angle_does_not_creep(model: AssemblyModel, stiffness) -> None:
    """Issue 4. The law knows total displacements only: asking again moves by no more than the secants still do."""
    first = settlement(model, stiffness, 1.2)
    again = first
    for _ in range(20):
        again = settlement(model, stiffness, 1.2, again)
    size = np.abs(first.displacement).max()
    within = 1e-12 if stiffness is EVEN else 2e-3
    assert np.abs(again.displacement - first.displacement).max() <= within * size


def test_the_way_there_does_not_matter_to_one_block() -> None:
    """Up to a factor at which half of the pairs slip and down again."""
    model = block_in_space(25.0, 35.0, height=2.0)
    first = settlement(model, EVEN)
    back = settlement(model, EVEN, 1.0, settlement(model, EVEN, 1.45, first))
    assert back.displacement == pytest.approx(first.displacement, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(
    ("model", "area"), [(stack(1, 25.0, 35.0), 2.0), (block_in_space(25.0, 35.0, height=0.2), 4.0)]
)
def test_a_block_settles_by_its_weight_over_its_stiffness(
    model: AssemblyModel, area: float
) -> None:
    """At the middle of the base: W cos β / (k_n A) into it and W sin β / (k_t A) down it, whatever the moments do."""
    found = settlement(model, EVEN)
    beta, weight = math.radians(25.0), model.force_scale
    opening, slip = model.opening_and_slip(in_model_units(model, found))
    assert (
        opening @ model.control_area / model.control_area.sum() * model.length_scale
        == pytest.approx(-weight * math.cos(beta) / (1e7 * area), rel=1e-9)
    )
    down = np.sqrt(
        (np.average(slip, axis=0, weights=model.by_group(model.control_area)) ** 2).sum()
    )
    assert down * model.length_scale == pytest.approx(
        weight * math.sin(beta) / (1e6 * area), rel=1e-9
    )
    assert found.failed_pairs == 0


@pytest.mark.parametrize("factor", [1.0, 1.5])
@pytest.mark.parametrize(
    ("stiffness", "within"),
    [(JointStiffness(tangential=4e6), 1e-9), (PAPER, 2e-3)],
    ids=["constant", "clough-duncan"],
)
def test_the_wedge_rests_where_the_solver_of_one_block_puts_it(
    stiffness, within: float, factor: float
) -> None:
    """`motion.equilibrium`, another iteration and no assembly; secants end within 1e-3 of the last."""
    assembly, model = paper_wedge()
    ours, theirs = settlement(assembly, stiffness, factor), equilibrium(model, factor, stiffness)
    size = np.abs(theirs.displacement).max()
    assert ours.displacement[0] == pytest.approx(theirs.displacement, rel=within, abs=within * size)
    assert ours.failed_pairs == theirs.failed_pairs


def relaxed(
    model: AssemblyModel, factor: float, k_t: float, steps: int
) -> tuple[np.ndarray, float]:
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

    It lies above their limit of 0.99996: elastic columns lean on each other before they run (the prototype of
    the path has a peak of 1.01 to 1.03).
    """
    model = columns()
    still, left = relaxed(model, 1.01, 1e6, 12000)
    assert left < 1e-9
    found = in_model_units(model, settlement(model, EVEN, 1.01))
    assert found == pytest.approx(still, rel=1e-6, abs=1e-6 * np.abs(still).max())
    away, left = relaxed(model, 1.03, 1e6, 12000)
    assert left > 1e-3
    assert np.abs(away).max() > 3.0 * np.abs(still).max()
    assert settlement(model, EVEN, 1.03) is None


def test_columns_that_lean_open_behind_themselves() -> None:
    model = columns()
    found = settlement(model, EVEN, 0.9)
    assert found.residual < 1e-10
    opening, _ = model.opening_and_slip(found.scaled)
    assert (opening > 0.0).any()
    assert found.slips.any()
    assert not found.slips.all()


@pytest.mark.parametrize(
    "model", [stack(1, 30.0, 35.0, width=1.5, c=30.0), block_in_space(30.0, 35.0, 1.0, 1.0, c=30.0)]
)
def test_a_pair_that_opens_loses_its_cohesion(model: AssemblyModel) -> None:
    """The weight of a block acts outside the middle third, so the upper side of its base opens."""
    found = settlement(model, EVEN)
    opening, _ = model.opening_and_slip(found.scaled)
    assert (opening > 0.0).any()
    forces = ElasticContactModel(model, Drive(model.load.ravel()), ratio=found.ratio).forces(
        found.scaled, 1.0
    )
    whole = model.by_group(model.cohesion) + model.tan_friction * model.by_group(forces.normal)
    assert forces.residual < 1e-9
    assert (forces.strength < whole).all()


def test_what_slides_and_what_is_lifted_off_come_to_no_rest() -> None:
    assert settlement(stack(3, 30.0, 35.0, width=20.0), EVEN, 1.22) is None
    base = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    lifted = polygons(
        [(base, (0.0, 0.0, 1.0))], (0.5, 0.5, 0.5), (0.0, 0.0, 5.0), (0.0, 0.0, 0.0), 30.0
    )
    assert settlement(lifted, EVEN) is None


@pytest.mark.parametrize("tips", [False, True])
def test_a_square_block_tips_at_45_degrees(tips: bool) -> None:
    """Its centre of gravity passes over the lower edge at β = 45°, issue 4: just about there; φ is 60°."""
    found = settlement(stack(1, 45.0 + (1e-3 if tips else -1e-3), 60.0, width=1.0), EVEN)
    assert (found is None) is tips


@pytest.mark.parametrize("slides", [False, True])
def test_a_joint_that_the_hyperbola_lets_creep_still_reaches_its_strength(slides: bool) -> None:
    """Clough and Duncan's τ -> σ tan φ₁ / R_f = σ tan 44.5°; the block of φ = 60° stands up to 60° all the same."""
    found = settlement(stack(1, 60.0 + (0.1 if slides else -0.1), 60.0, width=4.0), PAPER)
    assert (found is None) is slides
