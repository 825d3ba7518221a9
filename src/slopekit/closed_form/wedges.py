"""Hoek & Bray's wedge over arrays of designs: as the scalar functions say, some hundred times as fast.

For Monte Carlo, sweeps and pairs of surveyed joints. The formulas of `wedge_algebra` say of which wedges they cannot
vouch; `wedge_steps` takes those, and all that have a tension crack, step by step.
"""

from collections.abc import Callable, Iterator
from dataclasses import fields
from functools import partial
from typing import Any, Final

import numpy as np

from slopekit.closed_form.given import CHUNK, Codes, Columns, Floats, Indices, chunks, selected
from slopekit.closed_form.tape import Player, Step, Tape
from slopekit.closed_form.wedge_algebra import (
    UNSURE,
    alone_on,
    cut_of,
    forces_of,
    forms,
    modes_of,
    refused,
    slides_on_one,
    turns_of,
)
from slopekit.closed_form.wedge_arrays import (
    NUMBER_OF,
    OUTCOMES,
    ClosedFormWedges,
    WedgeArrays,
    WedgeShapes,
    wedge_columns,
)
from slopekit.closed_form.wedge_steps import shapes_in_steps, wedges_in_steps

__all__ = ["OUTCOMES", "ClosedFormWedges", "WedgeArrays", "WedgeShapes", "hoek_bray_wedges"]
_FEW: Final = 0.005  # of a chunk: the sure way with them takes less time than a hundred calls for them
_MOST: Final = 1e60  # heights and unit weights beyond it, or below 1 / it: a volume may overflow


def hoek_bray_wedges(wedges: WedgeArrays, *, details: bool = False) -> ClosedFormWedges:
    """Outcome and factor of safety of many wedges.

    Parameters
    ----------
    wedges : what is given of them
    details : whether their shapes are wanted as well

    Raises
    ------
    ValueError
        The arrays do not fit together.

    Outcomes are those of `geometry.rockmass.wedge_rock_mass` and then `hoek_bray_wedge`, factors equal the scalar ones
    to 1e-12. Formulas: `wedge_algebra`; sources: `wedge`.

    >>> wedges = WedgeArrays(
    ...     joint1_dip_deg=[45.0, 45.0, 80.0], joint1_dip_direction_deg=115.0,
    ...     joint2_dip_deg=[45.0, 45.0, 80.0], joint2_dip_direction_deg=245.0,
    ...     face_dip_deg=60.0, face_dip_direction_deg=180.0, upper_dip_deg=10.0, upper_dip_direction_deg=180.0,
    ...     height_m=64.89, cohesion1_kpa=50.0, cohesion2_kpa=50.0, friction1_deg=20.0, friction2_deg=20.0,
    ...     unit_weight_kn_m3=25.506, fill=[0.0, 1.0, 0.0],
    ... )
    >>> found = hoek_bray_wedges(wedges)
    >>> [OUTCOMES[outcome] for outcome in found.outcome], found.factor.round(4).tolist()
    (['slides_on_both', 'slides_on_both', 'E203'], [1.5574, 1.039, nan])
    """
    columns, count = wedge_columns(wedges)
    outcome, factor = np.empty(count, dtype=np.int8), np.empty(count)
    with np.errstate(all="ignore"):
        unsure = np.arange(count) if "crack_dip_deg" in columns else _by_algebra(columns, outcome, factor)
        for some in chunks(unsure):
            outcome[some], factor[some] = wedges_in_steps(selected(columns, some), some.size)
        shapes = _shapes(columns, outcome) if details else None
    return ClosedFormWedges(outcome, factor, shapes)


def _shapes(columns: Columns, outcome: Codes) -> WedgeShapes:
    """The shapes of the wedges that the planes cut, nan of the others."""
    found = {
        field.name: np.full((outcome.size, 3) if field.name == "areas_m2" else outcome.size, np.nan)
        for field in fields(WedgeShapes)
    }
    for some in chunks(np.flatnonzero(outcome < NUMBER_OF["E201"])):
        part = shapes_in_steps(selected(columns, some), some.size)
        for name, values in found.items():
            values[some] = getattr(part, name)
    return WedgeShapes(**found)


def _by_algebra(columns: Columns, outcome: Codes, factor: Floats) -> Indices:
    """Fill in outcomes and factors; returns the wedges that are too close to call."""
    if not outcome.size:
        return np.arange(0)
    tape = Tape()
    given = tape.given(columns)
    turns = turns_of(given)
    cut = cut_of(turns)
    formed, forces = forms(cut), forces_of(given, cut)
    modes = modes_of(forces)
    alone = alone_on(forces, 0), alone_on(forces, 1)
    otherwise = ~(formed & modes.on_both)
    kept = [otherwise, formed, *_flat(modes), *_flat((turns, *alone))]

    length = min(CHUNK, outcome.size)
    player = Player(tape, length, kept)
    formulas = (partial(slides_on_one, 0), alone[0]), (partial(slides_on_one, 1), alone[1]), (refused, turns)
    later = [_Later(formula, record, player, length, outcome, factor) for formula, record in formulas]
    left = [_extreme(columns, outcome.size)]
    arrays = {name: value for name, value in columns.items() if not isinstance(value, float)}
    for start in range(0, outcome.size, length):
        first = min(start, outcome.size - length)  # the last one reaches back: all are as long as the player's rows
        chunk = slice(first, first + length)
        player.play({name: value[chunk] for name, value in arrays.items()})
        factor[chunk] = player.of(modes.factor)
        outcome[chunk] = NUMBER_OF["slides_on_both"]
        if modes.upward is not False:
            outcome[chunk][player.of(modes.upward)] = NUMBER_OF["slides_up"]
        others = np.flatnonzero(_taken(player.of(otherwise), slice(length)))
        if others.size <= _FEW * length:
            left.append(first + others)
            continue
        forms_one, on_first = (_taken(player.of(mask), others) for mask in (formed, modes.on_first))
        for wedges, those in zip(later, (forms_one & on_first, forms_one & ~on_first, ~forms_one), strict=True):
            wedges.add(first, others[np.flatnonzero(those)])
    return np.unique(np.concatenate([*left, *(wedges.unsure() for wedges in later)]))


class _Later:
    """Wedges of several chunks for one formula: for a few the calls would take as long as for thousands.

    Parameters
    ----------
    formula : takes a record, returns outcomes (as floats) and factors
    record : of what the player keeps
    length : of the chunks
    outcome, factor : (n,), written to
    """

    def __init__(
        self, formula: Callable[[Any], tuple[Any, Any]], record: Any, player: Player, length: int, outcome: Codes,
        factor: Floats,
    ) -> None:  # fmt: skip
        self._formula, self._record, self._outcome, self._factor = formula, record, outcome, factor
        self._sources = [player.of(value) for value in _flat(record) if isinstance(value, Step)]
        self._rows = np.empty((len(self._sources), length))
        self._where = np.empty(length, dtype=np.intp)
        self._filled = 0
        self._play: Callable[[], tuple[Any, Any]] | None = None
        self._unsure: list[Indices] = []

    def add(self, first: int, at: Indices) -> None:
        """Wedges `at` of the chunk that begins at `first`."""
        while at.size:
            now, at = np.split(at, [self._where.size - self._filled])
            part = slice(self._filled, self._filled + now.size)
            self._where[part] = first + now
            for source, row in zip(self._sources, self._rows, strict=True):
                source.take(now, out=row[part], mode="clip")  # with "raise" it would go by a copy
            self._filled = part.stop
            if self._filled == self._where.size:
                self._play = self._play or self._player()
                self._store(*self._play())

    def unsure(self) -> Indices:
        """Take what is left; which of all are too close to call."""
        if self._filled:
            rows = iter(self._rows[:, : self._filled])
            record = _mapped(lambda value: next(rows) if isinstance(value, Step) else value, self._record)
            self._store(*self._formula(record))
        return np.concatenate([np.arange(0), *self._unsure])

    def _player(self) -> Callable[[], tuple[Any, Any]]:
        """The formula on a tape of its own, for rows that are full."""
        tape, rows = Tape(), {str(number): row for number, row in enumerate(self._rows)}
        given = iter(tape.given(rows).values())
        said = self._formula(_mapped(lambda value: next(given) if isinstance(value, Step) else value, self._record))
        player = Player(tape, self._where.size, said)

        def play() -> tuple[Any, Any]:
            player.play(rows)
            return player.of(said[0]), player.of(said[1])

        return play

    def _store(self, outcome: Any, factor: Any) -> None:
        where, self._filled = self._where[: self._filled].copy(), 0
        self._outcome[where], self._factor[where] = outcome, factor
        self._unsure.append(where[np.flatnonzero(np.broadcast_to(outcome, where.size) == UNSURE)])


def _mapped(function: Callable[[Any], Any], record: Any) -> Any:
    """A record with `function` of each of its values, in their order."""
    if not isinstance(record, tuple):
        return function(record)
    parts = [_mapped(function, value) for value in record]
    return type(record)(*parts) if hasattr(record, "_fields") else tuple(parts)


def _flat(record: Any) -> Iterator[Any]:
    """The values of a record."""
    if isinstance(record, tuple):
        for part in record:
            yield from _flat(part)
    else:
        yield record


def _taken(mask: Any, at: Indices | slice) -> Any:
    """The part of a mask; one that all share as often as there are others."""
    return mask[at] if np.ndim(mask) else np.full(at.stop if isinstance(at, slice) else at.size, mask)


def _extreme(columns: Columns, count: int) -> Indices:
    """Wedges whose heights or unit weights are not positive, or such that a volume may overflow."""
    extreme = np.zeros(count, dtype=np.bool_)
    for name in ("height_m", "unit_weight_kn_m3"):
        value = np.asarray(columns[name])
        if not (value.min() > 1.0 / _MOST and value.max() < _MOST):
            extreme |= ~((value > 1.0 / _MOST) & (value < _MOST))
    return np.flatnonzero(extreme)
