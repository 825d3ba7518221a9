"""Newton's method for the equilibrium of forces, with steps halved until the largest residual falls."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from slopekit.core.arrays import Floats

#: A search with more steps does not converge; 28 give the same on 162 assemblies and wedges.
_MAX_STEPS = 50
#: Of a Newton step; with 1e-4 the factor of one cracked base of 150 wedges changes by 1.3 %.
_MIN_STEP_FRACTION = 0.05

State = TypeVar("State")


def newton_equilibrium(
    forces: Callable[[Floats], tuple[Floats, State]],
    slopes: Callable[[Floats, State], Floats],
    start: Floats,
    small: float,
    shortest: float = _MIN_STEP_FRACTION,
) -> tuple[Floats, State, float]:
    """Return the displacement (u,) at which forces balance, the state there, and the largest residual force.

    The residual exceeds `small` where the search ended without equilibrium. A step is halved until the largest
    residual falls by at least a tenth of the step's fraction.

    Parameters
    ----------
    forces : residual (u,) at a displacement (u,), and a state that is handed to `slopes`
    slopes : derivative (u, u) of the residual at a displacement (u,) with that state
    shortest : least fraction of a Newton step that is tried

    >>> root, _, size = newton_equilibrium(lambda x: (x * x - 2.0, x), lambda x, _: np.diag(2.0 * x), np.ones(1), 1e-15)
    >>> round(float(root[0]), 12), size <= 1e-15
    (1.414213562373, True)
    """
    displacement = start
    residual, state = forces(displacement)
    largest = float(np.abs(residual).max())
    for _ in range(_MAX_STEPS):
        if largest <= small:
            break
        try:
            step = -np.linalg.solve(slopes(displacement, state), residual)
        except np.linalg.LinAlgError:
            break
        step_fraction = 1.0
        while step_fraction > shortest:
            trial = displacement + step_fraction * step
            trial_residual, trial_state = forces(trial)
            trial_largest = float(np.abs(trial_residual).max())
            if trial_largest < largest * (1.0 - 0.1 * step_fraction):
                break
            step_fraction *= 0.5
        else:
            break
        displacement, residual, state, largest = trial, trial_residual, trial_state, trial_largest
    return displacement, state, largest
