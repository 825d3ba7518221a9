"""The place of a tension crack with the lowest factor of the closed form: `crack: {distance: worst}`.

A sweep of the whole range finds the valley, ever narrower sweeps its bottom. A place where nothing holds the block (it
is lifted, or falls) has no factor and is worse than any that has one: the farthest of them is taken. For a dry plane
below level ground Hoek & Bray (1981, ch. 7) give it in closed form: b_c / H = sqrt(cot ψ_f cot ψ_p) - cot ψ_f.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np

from slopekit.core.arrays import Floats, NDArray
from slopekit.core.errors import DesignError, Fault, GeometryError
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength, Water
from slopekit.kinds.single_block.closed_forms import ClosedForms, OnArrays

#: Position of the lowest factor: inside the range, at its end toward the crest, everywhere, where nothing holds the
#: block, nowhere, at its end away from the crest. Places without a factor are outside of the range.
WHERE = ("inside", "end", "flat", "free", "none", "back")
_INSIDE, _END, _FLAT_OF, _FREE_OF, _NONE_OF, _BACK = range(6)
_FINE_SWEEPS, _COARSE_SWEEPS = (
    (401, 10),
    (31, 5),
)  # places of the first sweep, narrower sweeps: fewer where blocks are cut
_CHUNK_SIZE = 256  # designs: of more the columns leave the cache
_SWEEP_PLACES = 11
_ENDS = 1e-6  # of the range: nearer to its ends there is no crack
_FLAT = 1e-9
_FREE = ("lifted", "falls")
ENDLESS = "E443"
"""The code of a block that goes on without end where no crack closes it."""

D = TypeVar("D", bound=SlopeDesign)
#: Designs whose numbers may be arrays, and the strengths of their joints.
Cracked: TypeAlias = tuple[SlopeDesign, Sequence[Strength]]
#: Some of n designs with the crack of each at places (m, k), m k in all.
CrackedAt: TypeAlias = Callable[[slice, Floats], Cracked]


def lowest_of_many(
    factors_at: Callable[[Floats], Floats], reach: Floats, count: int, rounds: int = 8
) -> tuple[Floats, NDArray[np.int8]]:
    """Return the places (n,) of the lowest factor of n designs in (0, reach), and indices (n,) into `WHERE`.

    Parameters
    ----------
    factors_at : factors at places (n, k), of each design at its own; nan where there is none, -inf where nothing holds
        the block ("free")
    reach : (n,); count : places of the first sweep; rounds : narrower sweeps, each a fifth of the one before

    >>> places, where = lowest_of_many(lambda x: (x - np.array([[2.0], [9.0]])) ** 2, np.array([10.0, 5.0]), 50)
    >>> places.round(6).tolist(), [WHERE[one] for one in where]
    ([2.0, 4.999995], ['inside', 'back'])
    """
    rows = np.arange(len(reach))
    places = np.linspace(_ENDS, 1.0 - _ENDS, count) * np.asarray(reach)[:, None]
    factors = factors_at(places)
    unknown = np.isnan(factors)
    # where nothing has a factor, any will do
    k = np.argmin(np.where(unknown, np.inf, factors), axis=1)
    place, factor = places[rows, k], factors[rows, k]
    low, high = places[rows, np.maximum(k - 1, 0)], places[rows, np.minimum(k + 1, count - 1)]
    most = np.where(unknown, -np.inf, factors).max(axis=1)
    valley_kind = np.select([k == 0, k == count - 1], [_END, _BACK], _INSIDE).astype(np.int8)
    first, last = np.argmin(unknown, axis=1), count - 1 - np.argmin(unknown[:, ::-1], axis=1)
    with np.errstate(invalid="ignore"):
        valley_kind[most - factor <= _FLAT * np.abs(factor)] = _FLAT_OF
    free = np.isneginf(factors)
    farthest = count - 1 - np.argmax(free[:, ::-1], axis=1)
    is_free = free.any(axis=1)
    valley_kind[is_free], place[is_free] = _FREE_OF, places[rows, farthest][is_free]
    valley_kind[unknown.all(axis=1)] = _NONE_OF
    place[valley_kind == _NONE_OF] = np.nan
    inside = valley_kind == _INSIDE
    is_edge = inside & ((k == first) | (k == last))
    far_place = np.where(k == last, high, low)
    for _ in range(rounds if inside.any() else 0):
        places = np.linspace(low, high, _SWEEP_PLACES, axis=1)
        factors = factors_at(places)
        k = np.argmin(np.where(np.isnan(factors), np.inf, factors), axis=1)
        better = inside & (factors[rows, k] <= factor)
        place, factor = (
            np.where(better, places[rows, k], place),
            np.where(better, factors[rows, k], factor),
        )
        low, high = (
            places[rows, np.maximum(k - 1, 0)],
            places[rows, np.minimum(k + 1, _SWEEP_PLACES - 1)],
        )
    if is_edge.any():  # of the places that have a factor: a valley rises again before them
        factors = factors_at(np.linspace(place, far_place, _SWEEP_PLACES, axis=1))
        with np.errstate(invalid="ignore"):
            rises = (
                np.where(np.isnan(factors), -np.inf, factors).max(axis=1) - factor
            ) > _FLAT * np.abs(factor)
        valley_kind[is_edge & ~rises] = np.where(far_place > place, _BACK, _END)[is_edge & ~rises]
    return place, valley_kind


def worst_of_many(
    design: SlopeDesign, on_arrays: OnArrays[Any], cracked: CrackedAt, reach: Floats
) -> tuple[Floats, NDArray[np.int8]]:
    """Return the crack distances (n,) m with the lowest closed-form factor of n designs, and indices into `WHERE`.

    Parameters
    ----------
    design : of which the n differ in numbers
    reach : (n,) the longest distances, nan where there is no block
    """
    chunks = []
    for start in range(0, len(reach), _CHUNK_SIZE):
        rows = slice(start, start + _CHUNK_SIZE)
        factors = partial(_factors, on_arrays, partial(cracked, rows))
        chunks.append(
            lowest_of_many(
                factors, reach[rows], *(_COARSE_SWEEPS if design.is_cut_for_loads else _FINE_SWEEPS)
            )
        )
    places, valley_kinds = zip(*chunks, strict=True)
    return np.concatenate(places), np.concatenate(valley_kinds)


def _factors(
    on_arrays: OnArrays[Any], cracked: Callable[[Floats], Cracked], places: Floats
) -> Floats:
    """Return the factors (n, k) of designs with the crack at places (n, k); nan without one, -inf if nothing holds."""
    forms = on_arrays.forms(*cracked(places))
    free = np.isin(
        forms.outcome, [number for number, name in enumerate(forms.names) if name in _FREE]
    )
    factors: Floats = np.where(free, -math.inf, forms.factor)
    return np.broadcast_to(factors, places.size).reshape(places.shape)


def reach_of_many(
    design: SlopeDesign, on_arrays: OnArrays[Any], strengths: Sequence[Strength]
) -> tuple[ClosedForms, Floats]:
    """Return the closed forms of dry designs without their cracks, and the largest crack distances (n,) m.

    What acts on the ground behind a crack may not fit the block without it: a water table that lies above the ground.

    Parameters
    ----------
    design : whose numbers may be arrays; strengths : of its joints, likewise
    """
    dry: dict[str, Any] = {"crack": None, "water": Water(), "surcharge_kpa": 0.0}
    arguments = on_arrays.arguments(replace(design, **dry)) | on_arrays.strength_arguments(
        strengths
    )
    arguments |= dict.fromkeys(name for name in arguments if "crack" in name)
    return on_arrays.closed_forms(arguments, ()), on_arrays.crack_reach_m(design)


def with_worst_crack(design: D, on_arrays: OnArrays[D], place: str) -> D:
    """Return the design with its crack where the closed form is lowest; without it where planes form no block.

    Parameters
    ----------
    design : with a crack; place : in the file, for messages

    Raises
    ------
    DesignError
        E459 no place gives a factor.
    """
    holder: Any = design
    uncracked, reach = reach_of_many(design, on_arrays, design.joint_strengths)
    try:
        uncracked.form()
    except GeometryError as error:
        if ENDLESS in error.codes:  # a crack would close the block, however far it is
            message = (
                "without the crack the block goes on without end: the worst place has no farthest"
            )
            raise DesignError([Fault("E459", message, place, "Give its distance.")]) from None
        # which says the same where it is cut
        return cast("D", replace(holder, crack=None, crack_searched=WHERE[_NONE_OF]))

    def cracked_at(_: slice, places: Floats) -> Cracked:
        cracked = replace(holder, crack=replace(holder.crack, distance_m=places[0]))
        return cracked, design.joint_strengths

    (distance,), (valley_kind,) = worst_of_many(design, on_arrays, cracked_at, reach)
    if valley_kind == _NONE_OF:
        message = (
            "no place of the crack behind the crest gives a factor of safety: none is the worst"
        )
        raise DesignError(
            [Fault("E459", message, place, "Give its distance, or leave the crack out.")]
        )
    crack = replace(holder.crack, distance_m=float(distance))
    return cast("D", replace(holder, crack=crack, crack_searched=WHERE[valley_kind]))
