"""Two small pieces of linear algebra: a null space and non-negative least squares."""

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.tolerances import PARALLEL, ROUNDING, TINY

#: Columns that enter the active set, one an iteration: the larger of the two bounds ends the search.
_MIN_ITERATIONS, _ITERATIONS_PER_COLUMN = 400, 3


def split_space(rows: Floats) -> tuple[Floats, Floats]:
    """Return orthonormal bases of the null space of some rows and of their row space.

    Parameters
    ----------
    rows : (m, u); singular values below `PARALLEL` times the largest count as zero

    Returns
    -------
    free : (u, k), rest : (u, u - k)

    >>> free, rest = split_space(np.array([[0.0, 2.0]]))
    >>> np.abs(free).tolist(), np.abs(rest).tolist()
    ([[1.0], [0.0]], [[0.0], [1.0]])
    """
    square = (
        np.asarray(np.linalg.qr(rows, mode="r")) if len(rows) > rows.shape[1] else rows
    )  # the same row space
    _, singular_values, basis = np.linalg.svd(square, full_matrices=True)
    rank = int((singular_values > PARALLEL * singular_values[0]).sum())
    return basis[rank:].T, basis[:rank].T


def non_negative_least_squares(matrix: Floats, target: Floats) -> tuple[Floats, Floats]:
    """Return the x >= 0 that minimises |A x - b|, and the residual b - A x.

    Lawson & Hanson (1974), ch. 23. SciPy has the same method, but importing scipy.optimize takes longer than a system
    of three or six rows is worth.

    Parameters
    ----------
    matrix : (m, n); target : (m,)

    Returns
    -------
    x : (n,), residual : (m,) b - A x

    >>> x, residual = non_negative_least_squares(np.eye(3), np.array([3.0, -1.0, 2.0]))
    >>> x.tolist(), residual.tolist()
    ([3.0, 0.0, 2.0], [0.0, -1.0, 0.0])
    """
    count = matrix.shape[1]
    solution = np.zeros(count)
    free: Bools = np.zeros(count, dtype=bool)
    scale = np.maximum(np.sqrt((matrix * matrix).sum(axis=0) * float(target @ target)), TINY)
    for _ in range(max(_MIN_ITERATIONS, _ITERATIONS_PER_COLUMN * count)):
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
            is_zero = solution <= ROUNDING * max(float(solution.max()), TINY)
            solution = np.where(is_zero, 0.0, solution)
            free &= ~is_zero
    return solution, target - matrix @ solution
