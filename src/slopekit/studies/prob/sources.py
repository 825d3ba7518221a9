"""Sources of random numbers for Monte Carlo and Latin hypercube sampling, block by block, coordinate by coordinate.

A source is a callable (block, size) that gives a callable (coordinate, marginal), which gives the column of one
coordinate. Coordinates are drawn in their order, once each, or not at all. All random numbers of a block come from
its own stream, SFC64 seeded by (seed, block).

Orientations scatter by Fisher's distribution about a mean; angles out of range are folded back to the same plane.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
from scipy.special import ndtri

from slopekit.core.arrays import Floats
from slopekit.core.orientation import Line, Plane
from slopekit.design.common import Pair
from slopekit.design.scatter.copula import factor, normal_correlation
from slopekit.studies.marginals import Marginal

Column: TypeAlias = Callable[[int, Marginal], Floats]
Source: TypeAlias = Callable[[int, int], Column]
_PIECE = 8192  # samples of all coordinates that stay in the cache, and are had without asking the system for pages
_HALF_STEP = 2.0**-54  # half a step of uniform numbers, so that no tail is 0
_CONCENTRATED = 100.0  # k from which exp(-2k) is beyond all digits of any sample


@dataclass(frozen=True)
class Copula:
    """A Gaussian copula of the correlated coordinates.

    Attributes
    ----------
    members : numbers of the coordinates; factor : (members, rank) of the correlation matrix of their normals
    copies : (member, original, 1 or -1) of each member that equals another, or is its opposite
    """

    members: tuple[int, ...]
    factor: Floats
    copies: tuple[tuple[int, int, float], ...]

    @property
    def rank(self) -> int:
        """Number of independent normals behind the members."""
        return int(self.factor.shape[1])

    @property
    def originals(self) -> dict[int, tuple[int, float]]:
        """The original and 1 or -1 of each coordinate that equals another, or is its opposite."""
        return {
            self.members[member]: (self.members[original], sign)
            for member, original, sign in self.copies
        }

    def correlated_normals(self, normals: Floats) -> dict[int, Floats]:
        """Return the correlated normals of each member (n,) from independent normals (rank, n)."""
        correlated = np.empty((len(self.members), normals.shape[1]))
        for first in range(0, normals.shape[1], _PIECE):
            piece = slice(first, first + _PIECE)
            np.matmul(self.factor, normals[:, piece], out=correlated[:, piece])
        for member, original, sign in self.copies:
            correlated[member] = (
                sign * correlated[original]
            )  # a copy, no matrix product: ranks stay the same to the last digit
        return dict(zip(self.members, correlated, strict=True))


def copula(coordinates: Sequence[str], pairs: Sequence[Pair]) -> Copula:
    """Return the copula of rank correlations that do not contradict each other.

    >>> copula(["a", "b", "c"], [("a", "c", -1.0)])
    Copula(members=(0, 2), factor=array([[ 1.],
           [-1.]]), copies=((1, 0, -1.0),))
    """
    correlated_names = {name for a, b, value in pairs if value for name in (a, b)}
    members = tuple(k for k, name in enumerate(coordinates) if name in correlated_names)
    place = {coordinates[k]: i for i, k in enumerate(members)}
    ranks = np.eye(len(members))
    for a, b, value in pairs:
        if value:
            ranks[place[a], place[b]] = ranks[place[b], place[a]] = value
    copies = []
    for i in range(len(members)):
        original = next((j for j in range(i) if abs(ranks[i, j]) == 1.0), None)
        copies += [] if original is None else [(i, original, float(ranks[i, original]))]
    matrix = factor(normal_correlation(ranks)) if members else np.empty((0, 0))
    return Copula(members, matrix, tuple(copies))


def source(method: str, coordinates: Sequence[str], pairs: Sequence[Pair], seed: int) -> Source:
    """Return the source of a sampling method, `monte-carlo` or `latin-hypercube`."""
    correlation = copula(coordinates, pairs)
    if method == "monte-carlo":
        return partial(_monte_carlo, correlation, seed)
    return partial(_latin_hypercube, correlation, seed)


def _random_stream(seed: int, block: int) -> np.random.Generator:
    return np.random.Generator(np.random.SFC64(np.random.SeedSequence(seed, spawn_key=(block,))))


# -- Monte Carlo ------------------------------------------------------------------------------------------------------


def _monte_carlo(correlation: Copula, seed: int, block: int, size: int) -> Column:
    rng = _random_stream(seed, block)
    normals = correlation.correlated_normals(rng.standard_normal((correlation.rank, size)))

    def column(coordinate: int, marginal: Marginal) -> Floats:
        if coordinate in normals:
            return marginal.of_normal(normals[coordinate])
        if marginal.is_normal:
            return marginal.of_normal(rng.standard_normal(size))
        return marginal.of_tail(*_nearer_tails(rng.random(size)))

    return column


def _nearer_tails(uniform: Floats) -> tuple[Floats, Floats]:
    """Return the nearer tail of uniform numbers on multiples of 2⁻⁵³, and its side; the numbers are overwritten.

    Each is moved to the middle of its step, so that no tail is 0; nothing is rounded.

    >>> tail, side = _nearer_tails(np.array([0.0, 0.5, 1.0 - 2.0**-53]))
    >>> (tail * 2.0**54).tolist(), np.sign(side).tolist()
    ([1.0, 9007199254740991.0, 1.0], [-1.0, 1.0, 1.0])
    """
    side = uniform
    side *= 2.0
    side -= 1.0
    side += 2.0**-53
    tail = np.abs(side)
    np.subtract(1.0, tail, out=tail)
    tail *= 0.5
    return tail, side


# -- Latin hypercube --------------------------------------------------------------------------------------------------


def _latin_hypercube(correlation: Copula, seed: int, block: int, size: int) -> Column:
    """Return the columns of a Latin hypercube: one sample in each of `size` strata per coordinate (McKay et al. 1979).

    The position in a stratum is drawn for the lower half of them; the upper half is its mirror image, and a coordinate
    that equals another, or is its opposite, takes the positions of that one. Strata are shuffled at random, and those
    of correlated coordinates follow the ranks of their normals (Stein 1987, Technometrics 29).
    """
    rng = _random_stream(seed, block)
    normals = correlation.correlated_normals(rng.standard_normal((correlation.rank, size)))
    half, strata = size // 2, np.arange((size + 1) // 2, dtype=np.float64)
    originals, drawn_positions = correlation.originals, dict[int, Floats]()
    mirrored_originals = {original for original, _ in originals.values()}

    def column(coordinate: int, marginal: Marginal) -> Floats:
        position = (
            _mirrored_positions(drawn_positions, *originals[coordinate], size)
            if coordinate in originals
            else rng.random(len(strata))
        )
        if coordinate in mirrored_originals:
            drawn_positions[coordinate] = position
        values = np.empty(size)  # ascending
        if marginal.is_normal:
            lower = ndtri((position + (strata + _HALF_STEP)) / size)
            values[: len(lower)] = lower
            values[len(lower) :] = -lower[:half][::-1]
            values = marginal.of_normal(values)
        else:
            tail = (position + (strata + _HALF_STEP)) / size
            values[: len(tail)] = marginal.of_tail(tail, -1.0)
            values[len(tail) :] = marginal.of_tail(tail[:half][::-1], 1.0)
        if coordinate not in normals:
            rng.shuffle(values)
            return values
        ranked_values = np.empty(size)
        ranked_values[np.argsort(normals[coordinate])] = values
        return ranked_values

    return column


def _mirrored_positions(
    drawn_positions: Mapping[int, Floats], original: int, sign: float, size: int
) -> Floats:
    """Return the stratum positions of a coordinate's original; of an opposite the middle of an odd number is 1 - u."""
    position = drawn_positions[original]
    if sign < 0.0 and size % 2:
        position = position.copy()
        position[-1] = 1.0 - position[-1]
    return position


def fisher(
    mean: Plane | Line, concentration: float, steeper: Floats, clockwise: Floats
) -> tuple[Floats, Floats]:
    """Orientations with Fisher's distribution from two standard normals.

    Parameters
    ----------
    steeper, clockwise : (n,), independent of each other: how far the pole (the line) moves to where the dip (the
        plunge) grows, and square to that to where the direction grows

    Returns
    -------
    steep angle and direction, (n,) degrees: dip 0 to 90 and dip direction of a plane, whose pole may pass the
    horizontal; plunge -90 to 90 and trend of a line

    Notes
    -----
    The density on the sphere is k exp(k cos θ) / (4π sinh k), θ the angle to the mean, all azimuths alike (Fisher 1953,
    Dispersion on a sphere, Proc. R. Soc. A 217). So P(1 - cos θ > t) = (exp(-kt) - exp(-2k)) / (1 - exp(-2k)). Of two
    standard normals with the distance r from 0, S = exp(-r²/2) is uniform and their azimuth is, too; hence

        1 - cos θ = -ln(S + (1 - S) exp(-2k)) / k,      r²/2k where k is not small.

    >>> steep, direction = fisher(Plane(85.0, 115.0), 200.0, np.array([0.0, 2.0]), np.array([1.0, 0.0]))
    >>> steep.round(2).tolist(), direction.round(2).tolist()
    ([85.01, 86.89], [119.07, 295.0])
    """
    half_square = 0.5 * (steeper * steeper + clockwise * clockwise)
    if concentration >= _CONCENTRATED:
        gap = np.minimum(half_square / concentration, 2.0)
        slope = np.sqrt((1.0 - 0.5 * gap) / concentration)  # sin θ / r
    else:
        # 1 - S where S is near 1, S itself where it is small
        log_near_mean = np.log1p(np.expm1(-half_square) * -np.expm1(-2.0 * concentration))
        share = np.exp(-half_square)
        log_far_from_mean = np.log(share + (1.0 - share) * np.exp(-2.0 * concentration))
        gap = np.minimum(
            np.where(half_square < 0.5, log_near_mean, log_far_from_mean) / -concentration, 2.0
        )
        slope = np.sqrt(gap * (1.0 - 0.5 * gap) / (half_square + np.finfo(float).tiny))
    cosine, up_dip, across = 1.0 - gap, slope * steeper, slope * clockwise
    if isinstance(mean, Plane):
        # upward pole: sin β along the dip direction, cos β up
        angle = np.radians(mean.dip_deg)
        along = cosine * np.sin(angle) + up_dip * np.cos(angle)
        up = cosine * np.cos(angle) - up_dip * np.sin(angle)
        steep = np.degrees(np.arctan2(np.sqrt(along * along + across * across), up))
        direction = mean.dip_direction_deg + np.degrees(np.arctan2(across, along))
        return folded_planes(steep, direction)
    angle = np.radians(mean.plunge_deg)
    along = cosine * np.cos(angle) - up_dip * np.sin(angle)
    down = cosine * np.sin(angle) + up_dip * np.cos(angle)
    plunge = np.degrees(np.arctan2(down, np.sqrt(along * along + across * across)))
    return plunge, _wrapped_azimuth(mean.trend_deg + np.degrees(np.arctan2(across, along)))


def folded_planes(dip: Floats, direction: Floats) -> tuple[Floats, Floats]:
    """Return planes (n,) with any dip and direction as dips of 0 to 90 and directions of 0 to 360 degrees.

    >>> folded_planes(np.array([95.0, -5.0, 45.0]), np.array([10.0, 10.0, 370.0]))
    (array([85.,  5., 45.]), array([190., 190.,  10.]))
    """
    is_outside = (dip < 0.0) | (dip > 90.0)
    if is_outside.any():
        dip, direction = dip.copy(), direction.copy()
        folded = dip[is_outside] % 180.0  # a plane and its other side
        is_over = folded > 90.0
        dip[is_outside] = np.where(is_over, 180.0 - folded, folded)
        direction[is_outside] += 180.0 * is_over
    return dip, _wrapped_azimuth(direction)


def folded_lines(plunge: Floats, trend: Floats) -> tuple[Floats, Floats]:
    """Return pointing lines (n,) with any angles as plunges of -90 to 90 and trends of 0 to 360 degrees.

    >>> folded_lines(np.array([95.0, -100.0]), np.array([10.0, 200.0]))
    (array([ 85., -80.]), array([190.,  20.]))
    """
    is_outside = np.abs(plunge) > 90.0
    if is_outside.any():
        plunge, trend = plunge.copy(), trend.copy()
        folded = (plunge[is_outside] + 180.0) % 360.0 - 180.0
        is_over = np.abs(folded) > 90.0
        plunge[is_outside] = np.where(is_over, np.copysign(180.0, folded) - folded, folded)
        trend[is_outside] += 180.0 * is_over
    return plunge, _wrapped_azimuth(trend)


def _wrapped_azimuth(direction: Floats) -> Floats:
    is_outside = (direction < 0.0) | (direction > 360.0)
    if not is_outside.any():
        return direction
    return np.where(is_outside, direction % 360.0, direction)
