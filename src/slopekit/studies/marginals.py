"""Quantiles of random variables, from standard normals or tail probabilities, exact in both tails.

Also the probability of values that no design has: cohesion below 0, a friction angle of 90° and more.

A tail probability p is that of the nearer end, with its side: 1 - p is never formed where p is tiny.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.special import erf, ndtr, ndtri

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import number
from slopekit.design.common import Design
from slopekit.design.fields import declare, field_in
from slopekit.design.scatter.distributions import Distribution, Variable

#: Largest probability of such values with which a study starts; it counts their samples as impossible.
MOST_BEYOND = 0.01
NEVER = 1e-9  # a probability too small to be sampled: that end is not reported
_FARTHEST_SAMPLE_SD = 8.5  # standard deviations: no sample lies farther out (2⁻⁵⁴ is at 8.3)


@dataclass(frozen=True)
class Marginal:
    """The quantiles of a distribution, from standard normals or from tail probabilities.

    Attributes
    ----------
    quantiles : function of standard normals (n,) where `is_normal`, else of tail probabilities and sides
    """

    quantiles: Callable[..., Floats]
    is_normal: bool

    def of_normal(self, normal: Floats) -> Floats:
        """Return the values at standard normals (n,)."""
        return (
            self.quantiles(normal)
            if self.is_normal
            else self.quantiles(ndtr(-np.abs(normal)), normal)
        )

    def of_tail(self, p: Floats, side: Floats | float) -> Floats:
        """Return the values at tail probabilities (n,), more than 0 and about one half at most, of the given sides.

        Parameters
        ----------
        side : below 0 the lower end, above 0 the upper one (0 counts by its sign); one for all, or (n,)
        """
        return (
            self.quantiles(_mirrored_to_side(ndtri(p), side))
            if self.is_normal
            else self.quantiles(p, side)
        )


def marginal(distribution: Distribution) -> Marginal:
    """Return the quantile functions of a distribution.

    >>> pressure = marginal(Distribution("uniform", {"min": 10.0, "max": 30.0}, "pressure"))
    >>> pressure.of_normal(np.array([0.0])).tolist(), pressure.of_tail(np.array([0.25]), 1.0).tolist()
    ([20.0], [25.0])
    """
    parameters = distribution.parameters
    if distribution.name == "uniform":
        return Marginal(partial(_uniform, parameters["min"], parameters["max"]), is_normal=False)
    if distribution.name == "triangular":
        return Marginal(
            partial(_triangular, parameters["min"], parameters["mode"], parameters["max"]),
            is_normal=False,
        )
    if parameters["sd"] == 0.0:
        return Marginal(
            partial(_normal, parameters["mean"], 0.0, False, (-math.inf, math.inf)), is_normal=True
        )
    mean, sd, low, high = _standard(distribution)
    bounds = (parameters.get("min", -math.inf), parameters.get("max", math.inf))
    of_normal = partial(_normal, mean, sd, distribution.name == "lognormal", bounds)
    if low < -_FARTHEST_SAMPLE_SD and high > _FARTHEST_SAMPLE_SD:
        return Marginal(of_normal, is_normal=True)
    return Marginal(partial(_truncated, low, high, of_normal), is_normal=False)


def standard_normal() -> Marginal:
    """Return the standard normal distribution, from which the angles of an orientation are sampled.

    >>> standard_normal().of_tail(np.array([0.5]), -1.0).tolist()
    [0.0]
    """
    return Marginal(partial(_normal, 0.0, 1.0, False, (-math.inf, math.inf)), is_normal=True)


def tails(distribution: Distribution, least: float, most: float) -> tuple[float, float]:
    """Return the probabilities below one value and above another of a distribution.

    >>> tails(Distribution("uniform", {"min": -1.0, "max": 9.0}, "pressure"), 0.0, math.inf)
    (0.1, 0.0)
    """
    from scipy import stats

    parameters = distribution.parameters
    if "sd" not in parameters:
        low, width = parameters["min"], parameters["max"] - parameters["min"]
        mode = (parameters["mode"] - low) / width if "mode" in parameters else None
        spread = stats.uniform(low, width) if mode is None else stats.triang(mode, low, width)
        return float(spread.cdf(least)), float(spread.sf(most))
    if parameters["sd"] == 0.0:
        return float(parameters["mean"] < least), float(parameters["mean"] > most)
    mean, sd, low, high = _standard(distribution)
    if distribution.name == "lognormal":
        least, most = _log(least), _log(most)
    spread = stats.truncnorm(low, high, mean, sd)
    return float(spread.cdf(least)), float(spread.sf(most))


# -- beyond the limits of a design -------------------------------------------------------------------------------------


def checked_limits(design: Design) -> None:
    """Refuse variables of which more than 1 % lies beyond the values that a design takes.

    Orientations have no limits: past 90° a dip is that of the same plane written otherwise. Limits that depend on other
    values (dilation below φ, a step lower than the columns) are checked in samples only.

    Raises
    ------
    DesignError
        E281 for every variable of which more than 1 % lies beyond its limits.

    >>> from slopekit.design.reading.files import load
    >>> joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    >>> weak = {"c": {"dist": "normal", "mean": 10, "sd": 8}, "phi": 30}
    >>> wedge = load({"slopekit": 1, "kind": "wedge", "joints": joints, "strength": {"weak": weak}})
    >>> checked_limits(wedge)
    Traceback (most recent call last):
    slopekit.core.errors.DesignError: E281 10.6 % of strength.weak.c lies below 0, where no design can be
         design: strength.weak.c = {dist: …, mean: …, sd: …}
         Add min: 0 to the distribution, or make it narrower.
    """
    faults = []
    root = None if design.source is None else design.source.root
    for variable in design.variables:
        distribution, limits = (
            variable.distribution,
            field_in(type(design), root, variable.path) or declare(variable.path),
        )
        if isinstance(distribution, Distribution) and not limits.turns:
            below, above = tails(distribution, limits.least, limits.most)
            if below + above > MOST_BEYOND:
                faults.append(
                    _fault(variable, distribution, (below, limits.least), (above, limits.most))
                )
    if faults:
        raise DesignError(faults)


def _fault(
    variable: Variable,
    distribution: Distribution,
    below: tuple[float, float],
    above: tuple[float, float],
) -> Fault:
    """Return E281 of a variable from the probabilities below and above its limits."""
    ends, cures = [], []
    for key, side, (share, limit) in (("min", "below", below), ("max", "above", above)):
        if share > NEVER:
            ends.append(f"{share * 100:.3g} % of {variable.path} lies {side} {number(limit)}")
            cures.append(f"{key}: {number(limit)}")
    verb = (
        "Give it"
        if any(cure.partition(":")[0] in distribution.parameters for cure in cures)
        else "Add"
    )
    to = "" if verb == "Give it" else " to the distribution"
    return Fault(
        "E281",
        f"{', '.join(ends)}, where no design can be",
        variable.location,
        f"{verb} {' and '.join(cures)}{to}, or make it narrower.",
    )


# -- quantile functions ----------------------------------------------------------------------------------------------


def _mirrored_to_side(lower: Floats, side: Floats | float) -> Floats:
    """Mirror quantiles of the lower tail to the upper side, in place, where `side` is above 0."""
    lower *= -np.copysign(1.0, side)
    return lower


def _normal(
    mean: float, sd: float, is_log: bool, bounds: tuple[float, float], normal: Floats
) -> Floats:
    values = normal * sd
    values += mean
    if is_log:
        np.exp(values, out=values)
    if bounds != (-math.inf, math.inf):
        np.clip(values, *bounds, out=values)  # against rounding, and beyond the farthest sample
    return values


def _truncated(
    low: float, high: float, of_normal: Callable[[Floats], Floats], p: Floats, side: Floats | float
) -> Floats:
    """Return the values of a normal between two bounds, from the tail of each end plus p of the probability between."""
    below, above = float(ndtr(low)), float(ndtr(-high))
    if low > 0.0:  # all of it in the upper half: only the upper tail is small
        share = np.where(np.signbit(side), 1.0 - p, p) * _between(low, high)
        return of_normal(-ndtri(share + above))
    share = p * _between(low, high)
    share += np.where(np.signbit(side), below, above)
    return of_normal(_mirrored_to_side(ndtri(share), side))


def _uniform(low: float, high: float, p: Floats, side: Floats | float) -> Floats:
    distance = p * (high - low)
    return np.where(np.signbit(side), low + distance, high - distance)


def _triangular(low: float, mode: float, high: float, p: Floats, side: Floats | float) -> Floats:
    """Return the values of a triangular distribution, below the mode x = min + √(u (max - min) (mode - min))."""
    is_lower = np.signbit(side)
    below, above = np.where(is_lower, p, 1.0 - p), np.where(is_lower, 1.0 - p, p)
    width = high - low
    rising = low + np.sqrt(below * (width * (mode - low)))
    falling = high - np.sqrt(above * (width * (high - mode)))
    return np.where(below * width < mode - low, rising, falling)


# -- numbers of a distribution ----------------------------------------------------------------------------------------


def _standard(distribution: Distribution) -> tuple[float, float, float, float]:
    """Return mean and standard deviation of the normal (of a lognormal's logarithm), and its standardised bounds."""
    parameters = distribution.parameters
    mean, sd = parameters["mean"], parameters["sd"]
    bounds = [parameters.get("min", -math.inf), parameters.get("max", math.inf)]
    if distribution.name == "lognormal":
        variance = math.log1p((sd / mean) ** 2)
        mean, sd = math.log(mean) - variance / 2.0, math.sqrt(variance)
        bounds = [_log(bound) for bound in bounds]
    return mean, sd, (bounds[0] - mean) / sd, (bounds[1] - mean) / sd


def _log(value: float) -> float:
    return math.log(value) if value > 0.0 else -math.inf


def _between(low: float, high: float) -> float:
    """Return P(low < Z < high) of a standard normal without cancellation.

    >>> _between(9.0, 10.0) > 0.0
    True
    """
    if low > 0.0:
        return float(ndtr(-low) - ndtr(-high))
    if high < 0.0:
        return float(ndtr(high) - ndtr(low))
    return float(erf(high * math.sqrt(0.5)) + erf(-low * math.sqrt(0.5))) / 2.0
