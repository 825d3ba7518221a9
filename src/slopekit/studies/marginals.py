"""How one number scatters, as a function of a standard normal or of a tail probability, exact in both tails; and how
much of it lies beyond what a design takes: cohesion below 0, a friction angle of 90° and more.

A tail probability p is that of the nearer end, with the side it is of: 1 - p is never formed where p is tiny.
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

#: The largest share that is left to a study, which counts such samples as impossible.
MOST_BEYOND = 0.01
NEVER = 1e-9  # a share that no study draws: nothing is said of that end
_BEYOND_DRAWING = 8.5  # standard deviations: no sample lies out there (2⁻⁵⁴ is 8.3 of them)


@dataclass(frozen=True)
class Marginal:
    """A distribution as two functions that give the same numbers.

    Attributes
    ----------
    quantiles : of standard normals (n,) where `is_normal`, the shorter way there; else of tail probabilities and sides
    """

    quantiles: Callable[..., Floats]
    is_normal: bool

    def of_normal(self, normal: Floats) -> Floats:
        """The values at standard normals (n,)."""
        return self.quantiles(normal) if self.is_normal else self.quantiles(ndtr(-np.abs(normal)), normal)

    def of_tail(self, p: Floats, side: Floats | float) -> Floats:
        """The values at tail probabilities (n,), more than 0 and about one half at most, on the side each is of.

        Parameters
        ----------
        side : below 0 the lower end, above 0 the upper one (0 counts by its sign); one for all, or (n,)
        """
        return self.quantiles(_toward(ndtri(p), side)) if self.is_normal else self.quantiles(p, side)


def marginal(distribution: Distribution) -> Marginal:
    """The functions of a distribution.

    >>> pressure = marginal(Distribution("uniform", {"min": 10.0, "max": 30.0}, "pressure"))
    >>> pressure.of_normal(np.array([0.0])).tolist(), pressure.of_tail(np.array([0.25]), 1.0).tolist()
    ([20.0], [25.0])
    """
    given = distribution.parameters
    if distribution.name == "uniform":
        return Marginal(partial(_uniform, given["min"], given["max"]), is_normal=False)
    if distribution.name == "triangular":
        return Marginal(partial(_triangular, given["min"], given["mode"], given["max"]), is_normal=False)
    if given["sd"] == 0.0:
        return Marginal(partial(_normal, given["mean"], 0.0, False, (-math.inf, math.inf)), is_normal=True)
    mean, sd, low, high = _standard(distribution)
    bounds = (given.get("min", -math.inf), given.get("max", math.inf))
    of_normal = partial(_normal, mean, sd, distribution.name == "lognormal", bounds)
    if low < -_BEYOND_DRAWING and high > _BEYOND_DRAWING:
        return Marginal(of_normal, is_normal=True)
    return Marginal(partial(_truncated, low, high, of_normal), is_normal=False)


def standard_normal() -> Marginal:
    """The standard normal itself: what drives the angles of an orientation.

    >>> standard_normal().of_tail(np.array([0.5]), -1.0).tolist()
    [0.0]
    """
    return Marginal(partial(_normal, 0.0, 1.0, False, (-math.inf, math.inf)), is_normal=True)


def tails(distribution: Distribution, least: float, most: float) -> tuple[float, float]:
    """The shares of a distribution below one value and above another.

    >>> tails(Distribution("uniform", {"min": -1.0, "max": 9.0}, "pressure"), 0.0, math.inf)
    (0.1, 0.0)
    """
    from scipy import stats

    given = distribution.parameters
    if "sd" not in given:
        low, width = given["min"], given["max"] - given["min"]
        mode = (given["mode"] - low) / width if "mode" in given else None
        spread = stats.uniform(low, width) if mode is None else stats.triang(mode, low, width)
        return float(spread.cdf(least)), float(spread.sf(most))
    if given["sd"] == 0.0:
        return float(given["mean"] < least), float(given["mean"] > most)
    mean, sd, low, high = _standard(distribution)
    if distribution.name == "lognormal":
        least, most = _log(least), _log(most)
    spread = stats.truncnorm(low, high, mean, sd)
    return float(spread.cdf(least)), float(spread.sf(most))


# -- beyond the limits of a design -------------------------------------------------------------------------------------


def checked_limits(design: Design) -> None:
    """Refuse variables of which more than 1 % lies beyond the values that a design takes.

    Nothing of an orientation is beyond: past 90° it is a plane written otherwise. Limits that depend on other values
    (dilation below φ, a step lower than the columns) are seen in samples only.

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
        own, limits = variable.distribution, field_in(type(design), root, variable.path) or declare(variable.path)
        if isinstance(own, Distribution) and not limits.turns:
            below, above = tails(own, limits.least, limits.most)
            if below + above > MOST_BEYOND:
                faults.append(_fault(variable, own, (below, limits.least), (above, limits.most)))
    if faults:
        raise DesignError(faults)


def _fault(variable: Variable, own: Distribution, below: tuple[float, float], above: tuple[float, float]) -> Fault:
    """E281 of a variable: the shares below and above the limits."""
    ends, cures = [], []
    for key, side, (share, limit) in (("min", "below", below), ("max", "above", above)):
        if share > NEVER:
            ends.append(f"{share * 100:.3g} % of {variable.path} lies {side} {number(limit)}")
            cures.append(f"{key}: {number(limit)}")
    verb = "Give it" if any(cure.partition(":")[0] in own.parameters for cure in cures) else "Add"
    to = "" if verb == "Give it" else " to the distribution"
    return Fault(
        "E281",
        f"{', '.join(ends)}, where no design can be",
        variable.where,
        f"{verb} {' and '.join(cures)}{to}, or make it narrower.",
    )


# -- the ways to a value ----------------------------------------------------------------------------------------------


def _toward(lower: Floats, side: Floats | float) -> Floats:
    """Quantiles of the lower tail, those of the upper side mirrored."""
    lower *= -np.copysign(1.0, side)
    return lower


def _normal(mean: float, sd: float, is_log: bool, bounds: tuple[float, float], normal: Floats) -> Floats:
    values = normal * sd
    values += mean
    if is_log:
        np.exp(values, out=values)
    if bounds != (-math.inf, math.inf):
        np.clip(values, *bounds, out=values)  # rounding, and what no sample reaches
    return values


def _truncated(
    low: float, high: float, of_normal: Callable[[Floats], Floats], p: Floats, side: Floats | float
) -> Floats:
    """Between two standard normals: from each end its own tail, and the part p of what lies between."""
    below, above = float(ndtr(low)), float(ndtr(-high))
    if low > 0.0:  # all of it in the upper half: only the upper tail is small
        share = np.where(np.signbit(side), 1.0 - p, p) * _between(low, high)
        return of_normal(-ndtri(share + above))
    share = p * _between(low, high)
    share += np.where(np.signbit(side), below, above)
    return of_normal(_toward(ndtri(share), side))


def _uniform(low: float, high: float, p: Floats, side: Floats | float) -> Floats:
    part = p * (high - low)
    return np.where(np.signbit(side), low + part, high - part)


def _triangular(low: float, mode: float, high: float, p: Floats, side: Floats | float) -> Floats:
    """From the nearer end as long as the mode is not passed: x = min + √(u (max - min) (mode - min))."""
    is_lower = np.signbit(side)
    below, above = np.where(is_lower, p, 1.0 - p), np.where(is_lower, 1.0 - p, p)
    width = high - low
    rising = low + np.sqrt(below * (width * (mode - low)))
    falling = high - np.sqrt(above * (width * (high - mode)))
    return np.where(below * width < mode - low, rising, falling)


# -- numbers of a distribution ----------------------------------------------------------------------------------------


def _standard(distribution: Distribution) -> tuple[float, float, float, float]:
    """Mean and standard deviation of the normal (of the logarithm, of a lognormal), and its bounds in those units."""
    given = distribution.parameters
    mean, sd = given["mean"], given["sd"]
    bounds = [given.get("min", -math.inf), given.get("max", math.inf)]
    if distribution.name == "lognormal":
        variance = math.log1p((sd / mean) ** 2)
        mean, sd = math.log(mean) - variance / 2.0, math.sqrt(variance)
        bounds = [_log(bound) for bound in bounds]
    return mean, sd, (bounds[0] - mean) / sd, (bounds[1] - mean) / sd


def _log(value: float) -> float:
    return math.log(value) if value > 0.0 else -math.inf


def _between(low: float, high: float) -> float:
    """P(low < Z < high) of a standard normal, no digits lost.

    >>> _between(9.0, 10.0) > 0.0
    True
    """
    if low > 0.0:
        return float(ndtr(-low) - ndtr(-high))
    if high < 0.0:
        return float(ndtr(high) - ndtr(low))
    return float(erf(high * math.sqrt(0.5)) + erf(-low * math.sqrt(0.5))) / 2.0
