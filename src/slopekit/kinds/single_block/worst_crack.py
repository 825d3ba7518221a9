"""Where a tension crack lowers the closed form's factor most: `crack: {distance: worst}`.

A sweep of the whole range finds the valley, ever narrower sweeps its bottom. A place where nothing holds the block (it
is lifted, or falls) has no factor and is worse than any that has one: the farthest of them is taken. For a dry plane
below level ground Hoek & Bray (1981, ch. 7) give it in closed form: b_c / H = sqrt(cot ψ_f cot ψ_p) - cot ψ_f.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias, TypeVar

import numpy as np

from slopekit.core.arrays import Floats, NDArray
from slopekit.core.errors import DesignError, Fault, GeometryError
from slopekit.design.ground_water import SlopeDesign
from slopekit.kinds.single_block.closed_forms import Arguments, OnArrays

#: Where the lowest factor is: in the range, at its end toward the crest, everywhere, where nothing holds the block,
#: nowhere, at its end away from the crest. Places without a factor are outside of the range.
WHERE = ("inside", "end", "flat", "free", "none", "back")
_INSIDE, _END, _FLAT_OF, _FREE_OF, _NONE_OF, _BACK = range(6)
_CHEAP, _DEAR = (401, 10), (31, 5)  # places of the first sweep, narrower sweeps: fewer where blocks are cut
_AT_ONCE = 256  # designs: of more the columns leave the cache
_NARROWER = 11
_ENDS = 1e-6  # of the range: nearer to its ends there is no crack
_FLAT = 1e-9
_FREE = ("lifted", "falls")

D = TypeVar("D", bound=SlopeDesign)
#: The arguments of some of n designs with the crack of each at places (m, k), m k of those that are not one for all.
ArgumentsAt: TypeAlias = Callable[[slice, Floats], Arguments]


def lowest(factor_at: Callable[[Floats], Floats], reach: float, count: int, rounds: int = 8) -> tuple[float, str]:
    """The place in (0, reach) with the lowest factor, and where it is: one of `WHERE`.

    Parameters
    ----------
    factor_at : factors at places (k,), nan where there is none, -inf where nothing holds the block ("free")
    count, rounds : see `lowest_of_many`

    >>> place, where = lowest(lambda x: (x - 2.0) ** 2 + 1.0, 10.0, 50)
    >>> round(place, 6), where
    (2.0, 'inside')
    """
    places, where = lowest_of_many(lambda places: factor_at(places[0])[None], np.array([reach]), count, rounds)
    return float(places[0]), WHERE[int(where[0])]


def lowest_of_many(
    factors_at: Callable[[Floats], Floats], reach: Floats, count: int, rounds: int = 8
) -> tuple[Floats, NDArray[np.int8]]:
    """The same of n designs, each in its own (0, reach): places (n,), and indices into `WHERE` (n,).

    Parameters
    ----------
    factors_at : factors at places (n, k), of each design at its own
    reach : (n,); count : places of the first sweep; rounds : narrower sweeps, each a fifth of the one before

    >>> places, where = lowest_of_many(lambda x: (x - np.array([[2.0], [9.0]])) ** 2, np.array([10.0, 5.0]), 50)
    >>> places.round(6).tolist(), [WHERE[one] for one in where]
    ([2.0, 4.999995], ['inside', 'back'])
    """
    each = np.arange(len(reach))
    places = np.linspace(_ENDS, 1.0 - _ENDS, count) * np.asarray(reach)[:, None]
    factors = factors_at(places)
    unknown = np.isnan(factors)
    # where nothing has a factor, any will do
    k = np.argmin(np.where(unknown, np.inf, factors), axis=1)
    place, factor = places[each, k], factors[each, k]
    low, high = places[each, np.maximum(k - 1, 0)], places[each, np.minimum(k + 1, count - 1)]
    most = np.where(unknown, -np.inf, factors).max(axis=1)
    where = np.select([k == 0, k == count - 1], [_END, _BACK], _INSIDE).astype(np.int8)
    first, last = np.argmin(unknown, axis=1), count - 1 - np.argmin(unknown[:, ::-1], axis=1)
    with np.errstate(invalid="ignore"):
        where[most - factor <= _FLAT * np.abs(factor)] = _FLAT_OF
    free = np.isneginf(factors)
    farthest = count - 1 - np.argmax(free[:, ::-1], axis=1)
    is_free = free.any(axis=1)
    where[is_free], place[is_free] = _FREE_OF, places[each, farthest][is_free]
    where[unknown.all(axis=1)] = _NONE_OF
    place[where == _NONE_OF] = np.nan
    inside = where == _INSIDE
    at_edge = inside & ((k == first) | (k == last))
    beyond = np.where(k == last, high, low)
    for _ in range(rounds if inside.any() else 0):
        places = np.linspace(low, high, _NARROWER, axis=1)
        factors = factors_at(places)
        k = np.argmin(np.where(np.isnan(factors), np.inf, factors), axis=1)
        better = inside & (factors[each, k] <= factor)
        place, factor = np.where(better, places[each, k], place), np.where(better, factors[each, k], factor)
        low, high = places[each, np.maximum(k - 1, 0)], places[each, np.minimum(k + 1, _NARROWER - 1)]
    if at_edge.any():  # of the places that have a factor: a valley rises again before them
        factors = factors_at(np.linspace(place, beyond, _NARROWER, axis=1))
        with np.errstate(invalid="ignore"):
            rises = (np.where(np.isnan(factors), -np.inf, factors).max(axis=1) - factor) > _FLAT * np.abs(factor)
        where[at_edge & ~rises] = np.where(beyond > place, _BACK, _END)[at_edge & ~rises]
    return place, where


def worst_of_many(design: SlopeDesign, on_arrays: OnArrays[Any], arguments: ArgumentsAt, reach: Floats) -> Floats:
    """Where (n,) the crack of each of n designs lowers the closed form most, as `with_worst_crack` finds it one by one.

    Parameters
    ----------
    design : of which the n differ in numbers, without passive bolts
    reach : (n,) the longest distances, nan where there is no block
    """
    parts = []
    for at in range(0, len(reach), _AT_ONCE):
        part = slice(at, at + _AT_ONCE)
        factors = partial(_factors, on_arrays, partial(arguments, part), ())
        parts.append(lowest_of_many(factors, reach[part], *(_DEAR if design.is_cut_for_loads else _CHEAP))[0])
    return np.concatenate(parts)


def _factors(
    on_arrays: OnArrays[D], arguments: Callable[[Floats], Arguments], bolts: Sequence[Sequence[float]], places: Floats
) -> Floats:
    """Factors of designs with the crack at places (n, k), nan where there is none, -inf where nothing holds."""
    forms = on_arrays.closed_forms(arguments(places), bolts)
    free = np.isin(forms.outcome, [number for number, name in enumerate(forms.names) if name in _FREE])
    factors: Floats = np.where(free, -math.inf, forms.factor)
    return np.broadcast_to(factors, places.size).reshape(places.shape)


def with_worst_crack(design: D, on_arrays: OnArrays[D], reach: float, place: str) -> D:
    """The design with its crack where the closed form is lowest.

    Parameters
    ----------
    design : with a crack; reach : its longest distance, m; place : in the file, for messages

    Raises
    ------
    DesignError
        E459 no place gives a factor.
    """
    holder: Any = design

    def at(distance: Any) -> D:
        cracked: D = replace(holder, crack=replace(holder.crack, distance_m=distance))
        return cracked

    together = not any(one.law for one in on_arrays.strengths(design))

    def arguments(distances: Floats) -> Arguments:
        return on_arrays.arguments(at(distances[0]))

    def one(distance: float) -> float:
        try:
            solution = on_arrays.of(at(distance))
        except GeometryError:
            return math.nan
        if solution.status in _FREE:
            return -math.inf
        return math.nan if solution.factor is None else solution.factor

    def factors(places: Floats) -> Floats:
        if not together:
            return np.array([one(float(place)) for place in places])
        fos: Floats = _factors(on_arrays, arguments, on_arrays.bolts(design), places[None])[0]
        return fos

    distance, where = 0.0, "none"
    if reach > 0.0:
        distance, where = lowest(factors, reach, *(_DEAR if design.is_cut_for_loads or not together else _CHEAP))
    if where == "none":
        message = "no place of the crack behind the crest gives a factor of safety: none is the worst"
        raise DesignError([Fault("E459", message, place, "Give its distance, or leave the crack out.")])
    return replace(at(distance), crack_searched=where)
