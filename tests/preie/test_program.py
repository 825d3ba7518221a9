"""The cone program of many blocks against Clarabel, on small scenes in a section and in space."""

from dataclasses import replace

import numpy as np
import pytest

from slopekit.preie.programs import program as program_module
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.programs.program import MOST_LOAD, BlockProgram, Strengths
from tests.preie import assembly_oracle
from tests.preie.block_scenes import GOODMAN_BRAY, active_passive, bench, boxes_in_space, columns, stack, wall

MODELS = {
    "stack": lambda psi: stack(4, width=9.0).model(35.0, 0.0, psi),
    "wall": lambda psi: wall(4, 4).model(35.0, 0.0, psi),
    "wall with cohesion": lambda psi: wall(5, 3).model(25.0, 3.0, psi),
    "columns": lambda psi: columns(GOODMAN_BRAY).model(38.15, 0.0, psi),
    "two blocks": lambda psi: active_passive(10.0).model([30.0, 30.0, 0.0], [5.0, 5.0, 0.0], [psi, psi, 0.0]),
    "boxes": lambda psi: boxes_in_space((2, 2, 3), (2.0, 3.0, 1.0), 25.0, 0.3).model([30.0, 35.0], 0.5, psi),
    "bench": lambda psi: bench((("45/170", 7.0), ("80/350", 8.0), ("85/80", 8.0))).model(30.0, 0.0, psi),
}


def elastic_strength(program: BlockProgram) -> np.ndarray:
    """Strengths at the normal forces of an elastic bed."""
    return program.cohesion + program.model.tan_friction * program.model.by_group(program.start.normal)


@pytest.mark.parametrize("psi", [0.0, 8.0])
@pytest.mark.parametrize("name", MODELS)
def test_frozen_strengths_against_clarabel(name, psi) -> None:
    """The cost of the convex program to 1e-6 (tolerances 1e-9 and 1e-10), at a point that both conditions hold.

    The forces are compared through the cost: where it is flat they may differ.
    """
    model = MODELS[name](psi)
    program = BlockProgram(model)
    strength = elastic_strength(program)
    reference, dilation = 0.9 * model.by_group(program.start.normal), 0.4 * model.tan_dilation
    ours = program.solve(Strengths(dilation, strength, -dilation * reference), program.start, 1e-9, 120)
    exact = assembly_oracle.FrozenFriction(model, program.elastic, MOST_LOAD).solved(
        strength, dilation, reference, tolerance=1e-10
    )
    assert ours.settled
    at = ours.at
    assert at.load_factor == pytest.approx(exact.load_factor, rel=2e-6)
    group_area = model.by_group(model.control_area)[:, None]
    energy = program.elastic * float((at.normal**2 / model.control_area).sum() + (at.friction**2 / group_area).sum())
    assert at.load_factor + MOST_LOAD * at.shed + energy / 2.0 == pytest.approx(exact.cost, rel=1e-6)
    assert ours.unbalanced < 1e-6
    assert (at.normal > 0.0).all()
    limit = at.load_factor * strength + dilation * (model.by_group(at.normal) - reference)
    assert (np.sqrt((at.friction**2).sum(axis=1)) <= limit + 1e-6).all()


@pytest.mark.parametrize("name", MODELS)
def test_a_softer_bed_against_clarabel(name) -> None:
    """The same with a bed a million times as soft: there the energy decides the forces, to 1e-4 of the largest."""
    model = MODELS[name](0.0)
    program = BlockProgram(model)
    program.elastic = 1e-2
    strength = elastic_strength(program)
    ours = program.solve(Strengths(0.0 * strength, strength), program.start, 1e-9, 120)
    exact = assembly_oracle.FrozenFriction(model, program.elastic, MOST_LOAD).solved(strength, tolerance=1e-11)
    assert ours.at.load_factor == pytest.approx(exact.load_factor, rel=1e-5)
    assert ours.at.normal == pytest.approx(exact.normal, abs=1e-3 * exact.normal.max())
    assert ours.at.friction == pytest.approx(exact.friction, abs=1e-3 * exact.normal.max())


@pytest.mark.parametrize("name", MODELS)
def test_the_multipliers_are_a_mechanism(name) -> None:
    """The conditions of the convex program (Karush, Kuhn & Tucker) at the velocities, with d = B v + ε C f:

    no pair closes, d_n >= 0; N d_n = 0; the strengths earn 1, Σ r |d_t| = 1; the loads earn λ + ε fᵀ C f.
    """
    model = MODELS[name](0.0)
    program = BlockProgram(model)
    strength = elastic_strength(program)
    at = program.solve(Strengths(0.0 * strength, strength), program.start, 1e-9, 120).at
    give = program.elastic / model.control_area
    group_give = program.elastic / model.by_group(model.control_area)[:, None]
    opening, slip = model.opening_and_slip(at.velocity)
    fastest = float(np.abs(at.velocity).max())
    apart = opening + give * at.normal
    size = np.sqrt(((slip + group_give * at.friction) ** 2).sum(axis=1))
    assert apart.min() > -1e-6 * fastest
    assert np.abs(apart * at.normal).max() < 1e-6
    assert float(strength @ size) == pytest.approx(1.0, abs=1e-4)
    energy = float((give * at.normal**2).sum() + (group_give * at.friction**2).sum())
    assert float(model.load.ravel() @ at.velocity.ravel()) == pytest.approx(at.load_factor + energy, rel=1e-4)


@pytest.mark.parametrize("name", MODELS)
def test_the_static_bound_against_bisection(name) -> None:
    """The largest factor with admissible forces (associated flow): Clarabel and bisection to 1e-6.

    Slivers have to balance to a part of their own load: of the bench the program by itself does not settle.
    """
    model = MODELS[name](0.0)
    program = BlockProgram(model)
    found = program.solve(Strengths(model.tan_dilation, normality=1.0), program.start, 3e-7, 150)
    assert found.settled or name == "bench"  # slivers have to balance to a part of their own load, as in `bounds`
    ours, bound = 1.0 / found.at.load_factor, static_bound(model).factor
    exact = assembly_oracle.static_bound(model, 1e-7, bound)
    assert exact * (1.0 - 1e-5) < ours < exact * (1.0 + 2e-6)
    assert bound == pytest.approx(exact, rel=1e-6)


def test_the_bound_of_the_columns() -> None:
    """16 columns of Goodman & Bray by LP (cases.json): 1.19089 with the contacts against the steps."""
    model = columns().model(38.15)
    assert assembly_oracle.static_bound(model) == pytest.approx(1.19089, abs=1e-5)


def test_loads_that_nothing_balances_are_shed() -> None:
    """Pulled off its base by one and a half times its weight, the stack can be held at no strength: σ = 1."""
    scene = stack(2, width=9.0, dip=0.0)
    model = replace(scene, forces=-0.5 * scene.forces).model(35.0)
    program = BlockProgram(model)
    found = program.solve(Strengths(model.tan_dilation, normality=1.0), program.start, 1e-7, 150)
    assert found.at.shed == pytest.approx(1.0, abs=2e-3)  # the rest is elastic energy


def test_a_next_pass_starts_from_the_last() -> None:
    """Strengths changed by 0.1 %: from an iterate on the way to the last answer it takes fewer steps than anew."""
    model = wall(6, 6).model(35.0)
    program = BlockProgram(model)
    strength = elastic_strength(program)
    inside = program.solve(Strengths(0.0 * strength, strength), program.start, 3e-3, 100).at
    changed = Strengths(0.0 * strength, strength * (1.0 + 1e-3 * np.sin(np.arange(len(strength)))))
    warm = program.solve(changed, inside, 1e-7, 100)
    cold = program.solve(changed, program.start, 1e-7, 100)
    assert warm.settled
    assert cold.settled
    assert warm.at.load_factor == pytest.approx(cold.at.load_factor, rel=1e-6)
    assert warm.steps < cold.steps


KINDS = {
    "frozen": lambda model, at: Strengths(
        0.4 * model.tan_dilation,
        model.by_group(model.cohesion) + model.tan_friction * model.by_group(at.normal),
        -0.4 * model.tan_dilation * model.by_group(at.normal),
    ),
    "limit": lambda model, at: Strengths(0.0 * model.tan_dilation),
    "limit with dilation": lambda model, at: Strengths(0.4 * model.tan_dilation),
    "bound": lambda model, at: Strengths(model.tan_dilation, normality=1.0),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", [name for name in MODELS if name != "stack"])  # one on which rounding is large
def test_newtons_step_solves_the_linearised_equations(name, kind) -> None:
    """A millionth of a step takes off a millionth of everything that is off (to its square), by definition.

    The products of forces and multipliers go where they are sent. Iterates are pushed about so that all is off.
    """
    model = MODELS[name](8.0)
    program = BlockProgram(model)
    rng = np.random.default_rng(1)
    start = program.solve(KINDS["bound"](model, program.start), program.start, 1e-8, 4).at
    at = replace(
        start, load_factor=1.1 * start.load_factor, normal=start.normal * rng.uniform(0.9, 1.1, start.normal.shape),
        friction=start.friction * rng.uniform(0.9, 1.1, start.friction.shape),
        velocity=start.velocity * rng.uniform(0.9, 1.1, start.velocity.shape),
    )  # fmt: skip
    strengths = KINDS[kind](model, at)
    off = program_module.Residuals.of(program, strengths, at)
    newton = program_module.NewtonEquations.at(program, strengths, at, off)
    to_normal, to_shed = rng.normal(size=at.normal.shape) * at.normal * at.gap, 0.1 * at.shed * at.shed_slack
    to_strength = rng.normal(size=at.strength.shape) * np.abs(newton.scale.times(at.slip)).max(axis=1)[:, None]
    step = newton.direction(to_normal, to_strength, to_shed)
    size = 1e-6
    after = program_module.Residuals.of(program, strengths, step.taken(at, size))
    for key in ("normal", "slip", "strength", "factor", "balance", "shed"):
        left = np.asarray(getattr(after, key)) - (1.0 - size) * np.asarray(getattr(off, key))
        # blocks that hardly anything holds move far, and rounding of their stiffness with them
        size_of = {"normal": step.velocity, "slip": step.velocity, "strength": step.strength}
        size_of["balance"] = 1e-3 * step.velocity
        scale = max(float(np.abs(part).max()) for part in (getattr(off, key), size_of.get(key, 0.0), 1.0))
        assert np.abs(left).max() / size == pytest.approx(0.0, abs=1e-4 * scale), key
    products = at.gap * step.normal + at.normal * step.gap
    assert products == pytest.approx(to_normal, abs=1e-6 * max(np.abs(to_normal).max(), 1.0))
    turned = newton.scale.times(step.slip) + newton.scale.over(step.strength)
    assert turned == pytest.approx(to_strength, abs=1e-6 * max(np.abs(to_strength).max(), 1.0))
    assert at.shed_slack * step.shed + at.shed * step.shed_slack == pytest.approx(to_shed, rel=1e-6)
