"""Newton's method for forces that are to balance, with steps cut short where they would leave more out of balance."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from slopekit.core.arrays import Floats

_MOST_STEPS = 50  # what needs more has lost its way; 28 give the same on 162 assemblies and wedges
_SHORTEST = 0.05  # part of a step; with 1e-4 the factor of one cracked base of 150 wedges moves by 1.3 %

State = TypeVar("State")


def balanced(
    forces: Callable[[Floats], tuple[Floats, State]], slopes: Callable[[Floats, State], Floats], start: Floats,
    small: float, shortest: float = _SHORTEST,
) -> tuple[Floats, State, float]:  # fmt: skip
    """Where forces balance, what stands there, and the largest of them; it is above `small` where no step leads on.

    A step is halved until the largest force falls by a tenth of it.

    Parameters
    ----------
    forces : at a displacement (u,) what is out of balance (u,), and a state that `slopes` (u, u) are asked for with
    shortest : part of a step that is tried

    >>> at, _, left = balanced(lambda x: (x * x - 2.0, x), lambda x, _: np.diag(2.0 * x), np.array([1.0]), 1e-15)
    >>> round(float(at[0]), 12), left <= 1e-15
    (1.414213562373, True)
    """
    at = start
    out, state = forces(at)
    size = float(np.abs(out).max())
    for _ in range(_MOST_STEPS):
        if size <= small:
            break
        try:
            step = -np.linalg.solve(slopes(at, state), out)
        except np.linalg.LinAlgError:
            break
        length = 1.0
        while length > shortest:
            there = at + length * step
            out_there, state_there = forces(there)
            size_there = float(np.abs(out_there).max())
            if size_there < size * (1.0 - 0.1 * length):
                break
            length *= 0.5
        else:
            break
        at, out, state, size = there, out_there, state_there, size_there
    return at, state, size
