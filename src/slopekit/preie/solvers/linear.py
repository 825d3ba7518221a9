"""Two small pieces of linear algebra: a null space and non-negative least squares."""

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.tolerances import PARALLEL, ROUNDING, TINY

_MOST, _TIMES = 400, 3  # columns let in, one after the other: at least so many, and so many times all there are


def split_space(rows: Floats) -> tuple[Floats, Floats]:
    """Orthonormal bases of the motions that the rows leave free and of the rest.

    Parameters
    ----------
    rows : (m, u); singular values below `PARALLEL` of the largest count as nothing

    Returns
    -------
    free : (u, k), rest : (u, u - k)

    >>> free, rest = split_space(np.array([[0.0, 2.0]]))
    >>> np.abs(free).tolist(), np.abs(rest).tolist()
    ([[1.0], [0.0]], [[0.0], [1.0]])
    """
    square = np.asarray(np.linalg.qr(rows, mode="r")) if len(rows) > rows.shape[1] else rows  # the same row space
    _, sizes, basis = np.linalg.svd(square, full_matrices=True)
    rank = int((sizes > PARALLEL * sizes[0]).sum())
    return basis[rank:].T, basis[:rank].T


def bounded_least_squares(
    matrix: Floats, target: Floats, upper: Floats, pattern: Ints | None = None
) -> tuple[Floats, Floats]:
    """The x with 0 <= x <= upper that brings A x nearest to b, and what is left of b.

    Stark & Parker (1995), after Lawson & Hanson (1974), ch. 23. SciPy has the same, at the price of importing
    scipy.optimize for a system of three or six rows.

    Parameters
    ----------
    matrix : (m, n); target : (m,); upper : (n,), infinite where there is no bound
    pattern : (n,) of the answer to a problem near this one, tried first: 0 where x was nothing, 2 where it was `upper`

    Returns
    -------
    x : (n,), residual : (m,) b - A x

    >>> x, left = bounded_least_squares(np.eye(3), np.array([3.0, -1.0, 2.0]), np.array([np.inf, np.inf, 0.5]))
    >>> x.tolist(), left.tolist()
    ([3.0, 0.0, 0.5], [0.0, -1.0, 1.5])
    """
    count = matrix.shape[1]
    solution = np.zeros(count)
    free: Bools = np.zeros(count, dtype=bool)
    scale = np.maximum(np.sqrt((matrix * matrix).sum(axis=0) * float(target @ target)), TINY)
    if pattern is not None:
        free = pattern == 1
        known = np.where(pattern == 2, upper, 0.0)
        if free.any():
            known[free] = np.linalg.lstsq(matrix[:, free], target - matrix @ known, rcond=None)[0]
        rest = target - matrix @ known
        gain = (matrix.T @ rest) / scale
        gain = np.where(pattern == 2, -gain, gain)
        if not (gain[~free & (upper > 0.0)] > ROUNDING).any() and ((known > 0.0) & (known < upper))[free].all():
            return known, rest
        free = np.zeros(count, dtype=bool)
    for _ in range(max(_MOST, _TIMES * count)):
        gain = (matrix.T @ (target - matrix @ solution)) / scale
        gain = np.where(free, -np.inf, np.where(solution >= upper, -gain, gain))
        gain[upper <= 0.0] = -np.inf
        best = int(np.argmax(gain))
        if not gain[best] > ROUNDING:
            break
        free[best] = True
        while free.any():
            trial = solution.copy()
            fixed = target - matrix[:, ~free] @ solution[~free]
            trial[free] = np.linalg.lstsq(matrix[:, free], fixed, rcond=None)[0]
            below, above = free & (trial <= 0.0), free & (trial >= upper)
            if not below.any() and not above.any():
                solution = trial
                break
            step = 1.0
            if below.any():
                step = min(step, float((solution[below] / (solution[below] - trial[below])).min()))
            if above.any():
                step = min(step, float(((upper - solution)[above] / (trial - solution)[above]).min()))
            solution = solution + max(step, 0.0) * (trial - solution)
            size = max(float(solution.max()), TINY)
            at_floor, at_top = solution <= ROUNDING * size, solution >= upper * (1.0 - ROUNDING)
            solution = np.where(at_floor, 0.0, np.where(at_top, upper, solution))
            free &= ~at_floor & ~at_top
    return solution, target - matrix @ solution
