"""Rank correlation by a Gaussian copula: which coefficients are possible, and the nearest ones that are.

Two values whose ranks shall have the correlation ρ (Spearman) are driven by two standard normals with the correlation
r = 2 sin(π ρ / 6) (Kruskal 1958, Ordinal measures of association, J. Am. Stat. Assoc. 53). The matrix of all r must
have no negative eigenvalue.
"""

import numpy as np

from slopekit.core.arrays import Bools, Floats

#: An eigenvalue this far below 0 is rounding.
EIGENVALUE_TOLERANCE = 1e-9
_PASSES = 20_000
_SETTLED = 1e-13
_PIVOT = 1e-12
_DIGITS = 3


def normal_correlation(rank_correlation: Floats) -> Floats:
    """r of the normals for ρ of the ranks, -1 and 1 exactly.

    >>> normal_correlation(np.array([-1.0, 0.0, 0.8, 1.0])).round(6).tolist()
    [-1.0, 0.0, 0.813473, 1.0]
    """
    ranks = np.asarray(rank_correlation, dtype=np.float64)
    return np.where(np.abs(ranks) == 1.0, ranks, 2.0 * np.sin(np.pi / 6.0 * ranks))


def rank_correlation(normal_correlation: Floats) -> Floats:
    """ρ of the ranks for r of the normals.

    >>> rank_correlation(np.array([-1.0, 0.813473, 1.0])).round(6).tolist()
    [-1.0, 0.8, 1.0]
    """
    return 6.0 / np.pi * np.arcsin(np.clip(normal_correlation, -1.0, 1.0) / 2.0)


def smallest_eigenvalue(ranks: Floats) -> float:
    """Of the normals' matrix; below 0 these rank correlations, (k, k) with unit diagonal, cannot be.

    >>> round(smallest_eigenvalue(np.array([[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]])), 4)
    -0.816
    """
    return float(np.linalg.eigvalsh(normal_correlation(ranks))[0])


def nearest_correlation(matrix: Floats, is_free: Bools) -> Floats:
    """The nearest correlation matrix: no negative eigenvalue, unit diagonal, least Frobenius distance.

    Parameters
    ----------
    matrix : (k, k), symmetric
    is_free : (k, k), which entries may change; the others become 0, those of the diagonal 1

    Notes
    -----
    min ‖X - A‖ over X ⪰ 0 with X_ii = 1 and X_ij = 0 where it is not free, by alternating projections onto the two
    sets, the cone's with Dykstra's correction.

    Source: Higham (2002), Computing the nearest correlation matrix, IMA J. Numer. Anal. 22, algorithm 3.3; his example:

    >>> example = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]])
    >>> nearest_correlation(example, np.ones((3, 3), dtype=bool)).round(4).tolist()
    [[1.0, 0.7607, 0.1573], [0.7607, 1.0, 0.7607], [0.1573, 0.7607, 1.0]]
    """
    count = len(matrix)
    nearest, correction = np.array(matrix, dtype=np.float64), np.zeros((count, count))
    for _ in range(_PASSES):
        start = nearest - correction
        values, vectors = np.linalg.eigh((start + start.T) / 2.0)
        inside = (vectors * np.maximum(values, 0.0)) @ vectors.T
        correction = inside - start
        nearest = np.where(is_free, inside, 0.0)
        np.fill_diagonal(nearest, 1.0)
        if np.linalg.norm(nearest - inside) < _SETTLED * count:
            break
    return nearest


def nearest_ranks(ranks: Floats, is_given: Bools) -> Floats:
    """The nearest rank correlations that can be, in as few digits as can be typed, and possible as they are printed.

    Parameters
    ----------
    ranks : (k, k) symmetric, unit diagonal
    is_given : (k, k), the pairs that have a coefficient; the others stay 0

    Nearest is meant for the normals' coefficients r. Rounding may leave what is possible: then all come closer to 0 by
    a thousandth, until they do not.
    """
    nearest = rank_correlation(nearest_correlation(normal_correlation(ranks), is_given))
    off = ~np.eye(len(ranks), dtype=bool)
    for less in range(1000):
        rounded = np.where(off, np.round(nearest * (1.0 - less / 1000.0), _DIGITS) + 0.0, 1.0)
        if smallest_eigenvalue(rounded) >= -EIGENVALUE_TOLERANCE:
            return rounded
    return np.eye(len(ranks))


def factor(correlation: Floats) -> Floats:
    """L with L Lᵀ = R for a correlation matrix of the normals, singular ones too.

    Parameters
    ----------
    correlation : (k, k), symmetric, unit diagonal, no eigenvalue below -`EIGENVALUE_TOLERANCE`

    Returns
    -------
    (k, rank) array: Cholesky's, its columns of a pivot that is 0 left out, its rows of unit length

    >>> factor(np.array([[1.0, -1.0], [-1.0, 1.0]])).tolist()
    [[1.0], [-1.0]]
    """
    rest = np.array(correlation, dtype=np.float64)
    columns = []
    for k in range(len(rest)):
        if rest[k, k] > _PIVOT:
            column = rest[:, k] / np.sqrt(rest[k, k])
            column[:k] = 0.0
            rest -= np.outer(column, column)
            columns.append(column)
    lower = np.stack(columns, axis=1)
    return np.asarray(lower / np.linalg.norm(lower, axis=1, keepdims=True))
