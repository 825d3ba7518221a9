"""Two small pieces of linear algebra: a null space and non-negative least squares."""

import numpy as np

from slopekit.arrays import Bools, Floats


def split_space(rows: Floats, relative: float = 1e-9) -> tuple[Floats, Floats]:
    """Orthonormal bases of the motions that the rows leave free and of the rest.

    Parameters
    ----------
    rows : (m, u)
    relative : singular values below this part of the largest count as nothing

    Returns
    -------
    free : (u, k), rest : (u, u - k)

    >>> free, rest = split_space(np.array([[0.0, 2.0]]))
    >>> np.abs(free).tolist(), np.abs(rest).tolist()
    ([[1.0], [0.0]], [[0.0], [1.0]])
    """
    unknowns = rows.shape[1]
    if len(rows) == 0:
        return np.eye(unknowns), np.zeros((unknowns, 0))
    _, sizes, basis = np.linalg.svd(rows, full_matrices=True)
    rank = int((sizes > relative * sizes[0]).sum())
    return basis[rank:].T, basis[:rank].T


def nonnegative_least_squares(matrix: Floats, target: Floats, most: int = 400) -> tuple[Floats, Floats]:
    """The x >= 0 that brings A x nearest to b, and what is left of b.

    Lawson & Hanson (1974), ch. 23. SciPy has the same, at the price of importing scipy.optimize for a 6-row system.

    Parameters
    ----------
    matrix : (m, n); target : (m,)

    Returns
    -------
    x : (n,), residual : (m,) b - A x

    >>> x, left = nonnegative_least_squares(np.eye(2), np.array([3.0, -1.0]))
    >>> x.tolist(), left.tolist()
    ([3.0, 0.0], [0.0, -1.0])
    """
    count = matrix.shape[1]
    solution = np.zeros(count)
    passive: Bools = np.zeros(count, dtype=bool)
    scale = np.sqrt((matrix * matrix).sum(axis=0)) * max(float(np.sqrt(target @ target)), 1e-300)
    for _ in range(most):
        gain = np.where(passive, -np.inf, (matrix.T @ (target - matrix @ solution)) / np.maximum(scale, 1e-300))
        best = int(np.argmax(gain))
        if not gain[best] > 1e-13:
            break
        passive[best] = True
        while passive.any():
            trial = np.zeros(count)
            trial[passive] = np.linalg.lstsq(matrix[:, passive], target, rcond=None)[0]
            if trial[passive].min() > 0.0:
                solution = trial
                break
            wrong = passive & (trial <= 0.0)
            step = float((solution[wrong] / (solution[wrong] - trial[wrong])).min())
            solution = solution + step * (trial - solution)
            passive &= solution > 1e-14 * max(float(solution.max()), 1e-300)
            solution[~passive] = 0.0
    return solution, target - matrix @ solution
