"""Where a tension crack lowers the closed form's factor most: `crack: {distance: worst}`.

A sweep of the whole range finds the valley, ever narrower sweeps its bottom. A place where nothing holds the block (it
is lifted, or falls) has no factor and is worse than any that has one: the farthest of them is taken. For a dry plane
below level ground Hoek & Bray (1981, ch. 7) give it in closed form: b_c / H = sqrt(cot ψ_f cot ψ_p) - cot ψ_f.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault, GeometryError
from slopekit.design.ground_water import SlopeDesign
from slopekit.kinds.closed_forms import OnArrays

_MANY, _FEW = 401, 31
_NARROWER = 11
_ENDS = 1e-6  # of the range: nearer to its ends there is no crack
_FLAT = 1e-9
_FREE = ("lifted", "falls")

D = TypeVar("D", bound=SlopeDesign)


def lowest(
    factor_at: Callable[[Floats], Floats], reach: float, count: int, rounds: int = 8
) -> tuple[float, float, str]:
    """The place in (0, reach) with the lowest factor, that factor, and where: "inside", at an "end", "flat", "free".

    Parameters
    ----------
    factor_at : factors at places (n,), nan where there is none, -inf where nothing holds the block ("free")
    count : places of the first sweep
    rounds : narrower sweeps, each a fifth of the one before

    >>> place, _, where = lowest(lambda x: (x - 2.0) ** 2 + 1.0, 10.0, 50)
    >>> round(place, 6), where
    (2.0, 'inside')
    """
    places = np.linspace(_ENDS, 1.0 - _ENDS, count) * reach
    factors = factor_at(places)
    if np.isnan(factors).all():
        return math.nan, math.nan, "none"
    free = np.flatnonzero(np.isneginf(factors))
    if free.size:
        return float(places[free[-1]]), -math.inf, "free"
    k = int(np.nanargmin(factors))
    where = "end" if k in (0, count - 1) else "inside"
    if np.nanmax(factors) - np.nanmin(factors) <= _FLAT * abs(float(factors[k])):
        where = "flat"
    best = (float(places[k]), float(factors[k]))
    low, high = float(places[max(k - 1, 0)]), float(places[min(k + 1, count - 1)])
    for _ in range(rounds if where == "inside" else 0):
        places = np.linspace(low, high, _NARROWER)
        factors = factor_at(places)
        k = int(np.nanargmin(factors))
        best = (float(places[k]), float(factors[k])) if factors[k] <= best[1] else best
        low, high = float(places[max(k - 1, 0)]), float(places[min(k + 1, _NARROWER - 1)])
    return *best, where


def with_worst_crack(design: D, on_arrays: OnArrays[D], at: Callable[[D, float], D], reach: float, place: str) -> D:
    """The design with its crack where the closed form is lowest.

    Parameters
    ----------
    at : the design with its crack at a distance; reach : the longest distance, m; place : in the file, for messages

    Raises
    ------
    DesignError
        E459 no place gives a factor.
    """
    first = at(design, reach / 2.0)
    together = not design.is_cut_for_loads and not any(one.law for one in on_arrays.strengths(design))

    def one(distance: float) -> float:
        try:
            found = on_arrays.of(at(design, distance))
        except GeometryError:
            return math.nan
        if found.status in _FREE:
            return -math.inf
        return math.nan if found.factor is None else found.factor

    def factors(places: Floats) -> Floats:
        if not together:
            return np.array([one(float(place)) for place in places])
        arguments: dict[str, Any] = on_arrays.arguments(first) | {"crack_distance_m": places}
        forms = on_arrays.closed_forms(arguments, on_arrays.bolts(first))
        free = np.isin(forms.outcome, [number for number, name in enumerate(forms.names) if name in _FREE])
        found: Floats = np.where(free, -math.inf, forms.factor)
        return np.broadcast_to(found, places.shape)

    distance, _, where = lowest(factors, reach, *((_MANY, 10) if together else (_FEW, 5)))
    if where == "none":
        message = "no place of the crack behind the crest gives a factor of safety: none is the worst"
        raise DesignError([Fault("E459", message, place, "Give its distance, or leave the crack out.")])
    return replace(at(design, distance), crack_searched=where)
