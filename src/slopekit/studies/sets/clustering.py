"""Joint sets among poles: fuzzy K-means on the sphere, the number of sets by likelihood, joints of no set left alone.

Fuzzy K-means as of Hammah & Curran (1998, Int. J. Rock Mech. Min. Sci. 35, 889-905): the distance of a pole x from the
mean v of a set is its sine, d² = 1 - (x · v)²; x belongs to set i with the share u_i = d_i⁻² / Σ d_k⁻² (fuzziness 2),
and the mean of a set is the first eigenvector of Σ w u² x xᵀ. Several starts, of which the least Σ w u² d² is kept.

A joint is of the set it has the greatest share in, unless it is likelier one of those that lie anywhere: where the
density π K exp(-K (1 - cos θ)) / 2π of its set (Fisher) is below π₀ / 2π of joints without any order, K and the parts π
being the likeliest ones. The sets are then found again without those, until none changes. The likelihood of this
mixture gives the number of sets: the least

    BIC = -2 ln L + p ln N,    p = 4 m (mean, K and part of each of m sets)

(Schwarz 1978, Ann. Stat. 6, 461-464 (m)); 0 sets are joints without any order. docs/studies.md counts how often
it finds the number that was drawn; (m): remembered, not looked up.
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats, Ints

MAX_SETS = 8
MIN_JOINTS = 4  # of a set that is found
_STARTS = 8
_SAMPLE = 500  # joints that the starts are tried on
_ROUNDS, _STEPS, _FIRST_STEPS = 20, 100, 30
_CONVERGED = 1e-9
_MIN_SQUARED_SINE = 1e-12  # squared sine of a pole on the mean of a set
_MAX_K = 1e4  # a scatter below 0.8° is rounding of compass readings
_NO_SET = -1
_FIT_TOLERANCE = 1e-4  # of ln K, and of the part of joints of no set
_INITIAL_NO_SET_FRACTION = 0.1  # of joints of no set, before they are counted


@dataclass(frozen=True)
class Clusters:
    """Poles divided among sets.

    Attributes
    ----------
    means : (m, 3) downward unit vectors, the largest set first
    labels : (n,) the set of each pole, -1 of none
    bic : see above
    """

    means: Floats
    labels: Ints
    bic: float

    def __len__(self) -> int:
        return len(self.means)


def clusters_of(
    poles: Floats, weights: Floats, sets: int | None, rng: np.random.Generator
) -> list[Clusters]:
    """Divide poles among a number of sets, or among 0, 1, 2, ... sets.

    Parameters
    ----------
    poles : (n, 3) unit vectors of either sign; weights : (n,) above 0, mean 1
    sets : how many; None: from 0 to 8, as far as there are joints for them

    Returns
    -------
    the one asked for, or all of them by their number

    >>> rng = np.random.default_rng(1)
    >>> about = np.repeat([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], 30, axis=0) + 0.1 * rng.normal(size=(60, 3))
    >>> poles = about / np.sqrt((about * about).sum(axis=1))[:, None]
    >>> found = clusters_of(poles, np.ones(60), None, rng)
    >>> least_bic(found), sorted(np.bincount(found[2].labels).tolist())
    (2, [30, 30])
    """
    if sets is not None:
        return [_clustered(poles, weights, sets, rng)]
    return [
        _clustered(poles, weights, count, rng)
        for count in range(min(MAX_SETS, len(poles) // MIN_JOINTS) + 1)
    ]


def least_bic(clusterings: list[Clusters]) -> int:
    """Return the index of the clustering with the least BIC."""
    return int(np.argmin([clusters.bic for clusters in clusterings]))


def _clustered(poles: Floats, weights: Floats, sets: int, rng: np.random.Generator) -> Clusters:
    n = len(poles)
    none = np.full(n, _NO_SET)
    if sets == 0:
        return Clusters(np.zeros((0, 3)), none, 0.0)
    means = _initial_means(poles, weights, sets, rng)
    labels, visited = none, set[bytes]()
    for _ in range(_ROUNDS):
        inside = labels != _NO_SET if visited else np.ones(n, dtype=np.bool_)
        if not inside.any():
            break
        means = _converged_means(poles[inside], weights[inside], means)
        nearest = _memberships(poles, means).argmax(axis=1)
        mixture = _fitted_mixture(poles, weights, nearest, means)
        labels = np.where(
            mixture.densities(poles, nearest) > mixture.no_set_fraction, nearest, _NO_SET
        )
        if labels.tobytes() in visited:
            break
        visited.add(labels.tobytes())
    order = np.lexsort(
        (np.arange(sets), -np.bincount(labels[labels >= 0], weights[labels >= 0], minlength=sets))
    )
    labels = np.where(labels == _NO_SET, _NO_SET, np.argsort(order)[labels])
    means = means[order]
    means = np.where(means[:, 2:] > 0.0, -means, means)
    return Clusters(means, labels, _bic(poles, weights, mixture))


# -- fuzzy K-means ----------------------------------------------------------------------------------------------------


def _squared_sines(poles: Floats, means: Floats) -> Floats:
    """Squared sines (n, m) between poles and means."""
    return np.maximum(1.0 - (poles @ means.T) ** 2, _MIN_SQUARED_SINE)


def _memberships(poles: Floats, means: Floats) -> Floats:
    inverse_squares = 1.0 / _squared_sines(poles, means)
    return np.asarray(inverse_squares / inverse_squares.sum(axis=1, keepdims=True))


def _converged_means(poles: Floats, weights: Floats, means: Floats, steps: int = _STEPS) -> Floats:
    """Return the means (m, 3) to which fuzzy K-means converges from other means."""
    products = (poles[:, :, None] * poles[:, None, :]).reshape(-1, 9)
    for _ in range(steps):
        squared = _memberships(poles, means) ** 2 * weights[:, None]
        new = np.linalg.eigh((squared.T @ products).reshape(-1, 3, 3))[1][:, :, -1]
        change = 1.0 - np.abs(np.einsum("mi,mi->m", new, means)).min()
        means = new
        if change < _CONVERGED:
            break
    return means


def _initial_means(poles: Floats, weights: Floats, sets: int, rng: np.random.Generator) -> Floats:
    """The best of several starts far from each other (Arthur & Vassilvitskii 2007), on a sample of many joints."""
    if len(poles) > _SAMPLE:
        sample = rng.choice(len(poles), _SAMPLE, replace=False)
        poles, weights = poles[sample], weights[sample]
    tries = []
    for _ in range(_STARTS if sets > 1 else 1):
        means = poles[rng.choice(len(poles), p=weights / weights.sum())][None]
        while len(means) < sets:
            squared_distances = _squared_sines(poles, means).min(axis=1) * weights
            means = np.concatenate(
                [
                    means,
                    poles[rng.choice(len(poles), p=squared_distances / squared_distances.sum())][
                        None
                    ],
                ]
            )
        tries.append(_converged_means(poles, weights, means, _FIRST_STEPS))
    # Σ w u² d² = Σ w / Σ d⁻²
    return min(
        tries,
        key=lambda means: float((weights / (1.0 / _squared_sines(poles, means)).sum(axis=1)).sum()),
    )


# -- joints of no set -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Mixture:
    """Sets of Fisher's distribution among joints without any order: means (m, 3), K (m,), parts (m,), that of none."""

    means: Floats
    k: Floats
    fractions: Floats
    no_set_fraction: float

    def densities(self, poles: Floats, labels: Ints) -> Floats:
        """The density (n,) of each pole's own set on the hemisphere, times 2π and its part."""
        k, gap = self.k[labels], 1.0 - np.abs(np.einsum("ni,ni->n", poles, self.means[labels]))
        return np.asarray(self.fractions[labels] * k * np.exp(-k * gap) / -np.expm1(-k))


def _fitted_mixture(poles: Floats, weights: Floats, labels: Ints, means: Floats) -> _Mixture:
    """The likeliest mixture, each pole of its set or of none (expectation and maximisation, Dempster et al. 1977).

    It starts with the K of the half that lies nearest to each mean, K (1 - cos θ) = ln 2: joints of no set would hide
    in a K that they have lowered. The part of joints of no set is half a joint at least.
    """
    total_weight, sets = float(weights.sum()), len(means)
    gaps = 1.0 - np.abs(np.einsum("ni,ni->n", poles, means[labels]))
    half = np.array(
        [float(np.median(gaps[labels == k])) if (labels == k).any() else 1.0 for k in range(sets)]
    )
    set_fractions = np.asarray(
        np.bincount(labels, weights, minlength=sets)
        * (1.0 - _INITIAL_NO_SET_FRACTION)
        / total_weight,
        dtype=np.float64,
    )
    mixture = _Mixture(
        means,
        np.minimum(math.log(2.0) / np.maximum(half, _MIN_SQUARED_SINE), _MAX_K),
        set_fractions,
        _INITIAL_NO_SET_FRACTION,
    )
    products = (poles[:, :, None] * poles[:, None, :]).reshape(-1, 9)
    for _ in range(_STEPS):
        set_densities = mixture.densities(poles, labels)
        set_weights = weights * set_densities / (set_densities + mixture.no_set_fraction)
        size = np.bincount(labels, set_weights, minlength=sets)
        tensors = np.stack(
            [np.bincount(labels, set_weights * column, minlength=sets) for column in products.T],
            axis=-1,
        )
        means = np.linalg.eigh(tensors.reshape(-1, 3, 3))[1][:, :, -1]
        gaps = 1.0 - np.abs(np.einsum("ni,ni->n", poles, means[labels]))
        gap = np.bincount(labels, set_weights * gaps, minlength=sets)
        k = np.clip((size - 1.0) / np.maximum(gap, _MIN_SQUARED_SINE), 1.0, _MAX_K)
        new = _Mixture(
            means,
            k,
            size / total_weight,
            max(1.0 - float(size.sum()) / total_weight, 0.5 / total_weight),
        )
        has_converged = (
            np.abs(np.log(new.k / mixture.k)).max() < _FIT_TOLERANCE
            and abs(new.no_set_fraction - mixture.no_set_fraction) < _FIT_TOLERANCE
        )
        mixture = new
        if has_converged:
            break
    return mixture


def _bic(poles: Floats, weights: Floats, mixture: _Mixture) -> float:
    """Return the BIC of a mixture (head of this file); densities are times 2π, that of uniform directions is 1."""
    total = np.full(len(poles), mixture.no_set_fraction)
    for k in range(len(mixture.k)):
        total += mixture.densities(poles, np.full(len(poles), k))
    likelihood = float((weights * np.log(total)).sum())
    return -2.0 * likelihood + 4.0 * len(mixture.k) * math.log(max(float(weights.sum()), 2.0))
