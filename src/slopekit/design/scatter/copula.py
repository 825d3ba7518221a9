"""Rank correlation by a Gaussian copula: conversion of the coefficients and a check that they are possible.

Two random variables with the rank correlation ρ (Spearman) are functions of two standard normals with the correlation
r = 2 sin(π ρ / 6) (Kruskal 1958, Ordinal measures of association, J. Am. Stat. Assoc. 53). The matrix of all r must
have no negative eigenvalue.
"""

import numpy as np

from slopekit.core.arrays import Floats

#: An eigenvalue down to minus this is rounding.
EIGENVALUE_TOLERANCE = 1e-9
_PIVOT = 1e-12


def normal_correlation(rank_correlation: Floats) -> Floats:
    """Return the correlation r of the normals for the rank correlation ρ; exact for -1 and 1.

    >>> normal_correlation(np.array([-1.0, 0.0, 0.8, 1.0])).round(6).tolist()
    [-1.0, 0.0, 0.813473, 1.0]
    """
    ranks = np.asarray(rank_correlation, dtype=np.float64)
    return np.where(np.abs(ranks) == 1.0, ranks, 2.0 * np.sin(np.pi / 6.0 * ranks))


def smallest_eigenvalue(ranks: Floats) -> float:
    """Return the smallest eigenvalue of the normals' correlation matrix; negative for impossible rank correlations.

    ranks : (k, k) rank correlations with unit diagonal

    >>> round(smallest_eigenvalue(np.array([[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]])), 4)
    -0.816
    """
    return float(np.linalg.eigvalsh(normal_correlation(ranks))[0])


def factor(correlation: Floats) -> Floats:
    """Return a factor L with L Lᵀ = R of a correlation matrix R of the normals, which may be singular.

    Parameters
    ----------
    correlation : (k, k), symmetric, unit diagonal, no eigenvalue below -`EIGENVALUE_TOLERANCE`

    Returns
    -------
    (k, rank) array: the Cholesky factor without the columns of zero pivots, with rows of unit length

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
