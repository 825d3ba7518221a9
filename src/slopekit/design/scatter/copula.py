"""Rank correlation by a Gaussian copula: which coefficients are possible.

Two values whose ranks shall have the correlation ρ (Spearman) are driven by two standard normals with the correlation
r = 2 sin(π ρ / 6) (Kruskal 1958, Ordinal measures of association, J. Am. Stat. Assoc. 53). The matrix of all r must
have no negative eigenvalue.
"""

import numpy as np

from slopekit.core.arrays import Floats

#: An eigenvalue this far below 0 is rounding.
EIGENVALUE_TOLERANCE = 1e-9
_PIVOT = 1e-12


def normal_correlation(rank_correlation: Floats) -> Floats:
    """r of the normals for ρ of the ranks, -1 and 1 exactly.

    >>> normal_correlation(np.array([-1.0, 0.0, 0.8, 1.0])).round(6).tolist()
    [-1.0, 0.0, 0.813473, 1.0]
    """
    ranks = np.asarray(rank_correlation, dtype=np.float64)
    return np.where(np.abs(ranks) == 1.0, ranks, 2.0 * np.sin(np.pi / 6.0 * ranks))


def smallest_eigenvalue(ranks: Floats) -> float:
    """Of the normals' matrix; below 0 these rank correlations, (k, k) with unit diagonal, cannot be.

    >>> round(smallest_eigenvalue(np.array([[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]])), 4)
    -0.816
    """
    return float(np.linalg.eigvalsh(normal_correlation(ranks))[0])


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
