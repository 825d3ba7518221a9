"""Two small pieces of linear algebra: a null space and non-negative least squares."""

import numpy as np

from slopekit.core.arrays import Bools, Floats
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


def non_negative_least_squares(matrix: Floats, target: Floats) -> tuple[Floats, Floats]:
    """The x >= 0 that brings A x nearest to b, and what is left of b.

    Lawson & Hanson (1974), ch. 23. SciPy has the same, at the price of importing scipy.optimize for a system of three
    or six rows.

    Parameters
    ----------
    matrix : (m, n); target : (m,)

    Returns
    -------
    x : (n,), residual : (m,) b - A x

    >>> x, left = non_negative_least_squares(np.eye(3), np.array([3.0, -1.0, 2.0]))
    >>> x.tolist(), left.tolist()
    ([3.0, 0.0, 2.0], [0.0, -1.0, 0.0])
    """
    count = matrix.shape[1]
    solution = np.zeros(count)
    free: Bools = np.zeros(count, dtype=bool)
    scale = np.maximum(np.sqrt((matrix * matrix).sum(axis=0) * float(target @ target)), TINY)
    for _ in range(max(_MOST, _TIMES * count)):
        gain = np.where(free, -np.inf, (matrix.T @ (target - matrix @ solution)) / scale)
        best = int(np.argmax(gain))
        if not gain[best] > ROUNDING:
            break
        free[best] = True
        while free.any():
            trial = np.zeros(count)
            trial[free] = np.linalg.lstsq(matrix[:, free], target, rcond=None)[0]
            below = free & (trial <= 0.0)
            if not below.any():
                solution = trial
                break
            step = float((solution[below] / (solution[below] - trial[below])).min())
            solution = solution + max(step, 0.0) * (trial - solution)
            at_floor = solution <= ROUNDING * max(float(solution.max()), TINY)
            solution = np.where(at_floor, 0.0, solution)
            free &= ~at_floor
    return solution, target - matrix @ solution
