"""The static bound of many blocks against bisection by Clarabel, on small scenes in a section and in space."""

from dataclasses import replace

import numpy as np
import pytest

from slopekit.preie.kernels import compiled
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.programs.cone_steps import ConeEquations, Residuals, Shortfall
from tests.preie import assembly_oracle
from tests.preie.block_scenes import (
    GOODMAN_BRAY,
    active_passive,
    bench,
    boxes_in_space,
    columns,
    stack,
    wall,
)

MODELS = {
    "stack": lambda: stack(4, width=9.0).model(35.0),
    "wall": lambda: wall(4, 4).model(35.0),
    "wall with cohesion": lambda: wall(5, 3).model(25.0, 3.0),
    "columns": lambda: columns(GOODMAN_BRAY).model(38.15),
    "two blocks": lambda: active_passive(10.0).model([30.0, 30.0, 0.0], [5.0, 5.0, 0.0]),
    "boxes": lambda: boxes_in_space((2, 2, 3), (2.0, 3.0, 1.0), 25.0, 0.3).model([30.0, 35.0], 0.5),
    "bench": lambda: bench((("45/170", 7.0), ("80/350", 8.0), ("85/80", 8.0))).model(30.0),
}


@pytest.mark.parametrize("name", MODELS)
def test_the_static_bound_against_bisection(name) -> None:
    """The largest factor with admissible forces (associated flow): Clarabel and bisection to 1e-6."""
    model = MODELS[name]()
    bound = static_bound(model).factor
    assert bound == pytest.approx(assembly_oracle.static_bound(model, 1e-7, bound), rel=1e-6)


def test_the_bound_of_the_columns() -> None:
    """16 columns of Goodman & Bray by LP (cases.json): 1.19089 with the contacts against the steps."""
    assert static_bound(columns().model(38.15)).factor == pytest.approx(1.19089, abs=1e-5)


@pytest.mark.parametrize("phi", [35.0, 0.0])
def test_loads_that_nothing_balances_lift(phi) -> None:
    """Pulled off its base by half its weight a stack is held at no strength, and sets off along the pull."""
    scene = stack(2, width=9.0, dip=0.0)
    found = static_bound(replace(scene, forces=-0.5 * scene.forces).model(phi))
    assert found.lifted
    assert found.factor is None
    fastest = np.abs(found.velocity).max()
    assert found.velocity.reshape(2, 3)[:, 1] == pytest.approx(fastest, rel=1e-6)


def test_without_friction_a_stack_on_an_incline_is_held_at_no_strength() -> None:
    """It does not pull at its base, so the programs are feasible; nothing that they find is enough."""
    found = static_bound(stack(2, width=9.0).model(0.0))
    assert found.lifted


@pytest.mark.skipif(compiled() is None, reason="its steps are compiled")
@pytest.mark.parametrize("name", ["boxes", "bench"])
def test_newtons_step_solves_the_linearised_equations(name) -> None:
    """A millionth of a step takes off a millionth of everything that is off (to its square), by definition."""
    program, size = Shortfall(MODELS[name]()), 1e-6
    program.set_reduction(0.8)
    rng, start = np.random.default_rng(1), program.start()
    at = replace(
        start,
        normal=start.normal * rng.uniform(0.9, 1.1, start.normal.shape),
        velocity=1e-3 * rng.normal(size=start.velocity.shape),
    )
    off = Residuals.evaluate(program, at)
    newton = ConeEquations(program, at, off)
    to_normal = rng.normal(size=at.normal.shape) * at.normal * at.gap
    to_shed = 0.1 * at.shed * at.shed_slack
    step, _ = newton.direction(to_normal, np.zeros_like(at.strength), to_shed)
    after = Residuals.evaluate(program, step.advanced(at, size))
    for key in ("normal", "slip", "strength", "factor", "balance", "shed"):
        left = np.asarray(getattr(after, key)) - (1.0 - size) * np.asarray(getattr(off, key))
        # blocks that hardly anything holds move far, and rounding of their stiffness with them
        size_of = {"normal": step.velocity, "slip": step.velocity, "strength": step.strength}
        size_of["balance"] = 1e-3 * step.velocity
        scale = max(
            float(np.abs(part).max()) for part in (getattr(off, key), size_of.get(key, 0.0), 1.0)
        )
        assert np.abs(left).max() / size == pytest.approx(0.0, abs=1e-4 * scale), key
    products = at.gap * step.normal + at.normal * step.gap
    assert products == pytest.approx(to_normal, abs=1e-6 * max(np.abs(to_normal).max(), 1.0))
    assert at.shed_slack * step.shed + at.shed * step.shed_slack == pytest.approx(to_shed, rel=1e-6)
