"""Rows of a design whose columns are numbers of it: on arrays where its kind takes them.

A few rows and the extreme ones are analysed as designs of their own, and those with a value that the reader of files
refuses, or with nearly parallel joints. Where a run says of the inputs of one of a few what it does not say of all, or
arrays find another answer there, no row is taken on arrays.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import DesignError, Notice
from slopekit.design.common import Design
from slopekit.design.fields import field_in
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, shaken_toward
from slopekit.kinds.single_block.held_bolts import nearly_parallel
from slopekit.kinds.single_block.one_block_notices import lost_contact, shaking, without_strength
from slopekit.studies.evaluation.rows import Rows, outcomes_on_arrays
from slopekit.studies.evaluation.vectorised import Vectorised, vectorised
from slopekit.studies.keys import Key, values_of
from slopekit.studies.outcomes import NO_BLOCK, ByMethod, Outcomes
from slopekit.studies.points import UNSETTLED, Point

#: What a run says because of its answer; all else that it says follows from the inputs.
_OF_ANSWERS = ("W307", "W308", "W328")
_WHOLE = "{whole}"  # stands in a notice for what acceptance is held against too
_SAME = 1e-6  # of a factor: what arrays and a run make of the same design
_FEW = 9


class ColumnRows(Rows):
    """Rows that give some keys of a design other values.

    Parameters
    ----------
    keys : (k); places : (n, k) their values
    """

    def __init__(self, design: Design, keys: Sequence[Key], places: Any, pre_ie: bool) -> None:
        super().__init__(design, (), not any(key.path.startswith("support.") for key in keys))
        self.keys, self.places = keys, np.array(places, dtype=np.float64)
        self.points = dict[int, Point]()  # of rows that are designs of their own, so far
        self.columns: Vectorised | None = None
        self.notices: tuple[Notice, ...] = ()  # that a run gives of the inputs
        self.single = np.ones(len(self.places), dtype=bool)  # rows that are designs of their own
        is_laid_out = any(bolt.head_m is not None for bolt in design.bolts)
        is_searched = bool(getattr(design, "crack_searched", ""))
        if kind_of(design).on_arrays is not None and len(self.places) > _FEW and not is_laid_out and not is_searched:
            self._try_arrays(pre_ie)

    def __len__(self) -> int:
        return len(self.places)

    def inputs(self) -> list[object]:
        places = hashlib.sha256(self.places.tobytes()).hexdigest()
        return [*super().inputs(), [key.path for key in self.keys], places]

    def settings_at(self, row: int) -> Mapping[str, object]:
        return values_of(self.design, self.keys, self.places[row].tolist())

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        # rows without a block or an answer are designs of their own, which say why
        rows = np.flatnonzero(~self.single[start:stop])
        if self.columns is None or not len(rows):
            return rows[:0], None
        outcomes = self._outcomes(self.columns, self.places[start + rows], pre_ie)
        formed = np.flatnonzero(~outcomes.limit.among(*NO_BLOCK, UNSETTLED))
        return rows[formed], outcomes.of(formed)

    def point(self, row: int, pre_ie: bool) -> Point:
        return self.points[row] if row in self.points else super().point(row, pre_ie)

    def _try_arrays(self, pre_ie: bool) -> None:
        """Take rows on arrays where these say of a few what runs say of them."""
        places, keys, design = self.places, self.keys, self.design
        few = np.linspace(0, len(places) - 1, _FEW).astype(np.int64)
        probes = sorted({int(row) for row in (*few, *places.argmin(axis=0), *places.argmax(axis=0))})
        self.points.update((row, self.point(row, pre_ie)) for row in probes)
        try:  # with whatever has to be written first
            fullest = with_values(design, self.settings_at(int(places[:, 0].argmax())))
        except DesignError:
            return
        columns = vectorised(fullest, places, self.settings_at, [key.path for key in keys])
        of_inputs = {
            tuple(note for note in _renamed(point.notes, point.also, _WHOLE) if note.code not in _OF_ANSWERS)
            for point in self.points.values()
            if point.factors is not None
        }
        if columns is None or not columns.takes(pre_ie) or len(of_inputs) != 1:
            return
        self.notices = of_inputs.pop()
        with np.errstate(divide="ignore", invalid="ignore"):  # at places whose planes cut no block
            single = nearly_parallel(columns.on_arrays.bounds(columns.at(places)[0]), len(places))
        for key, values in zip(keys, places.T, strict=True):
            refused = [value for value in np.unique(values).tolist() if _is_refused(design, key, value)]
            single |= np.isin(values, refused)
        compared = [row for row in self.points if not single[row]]
        if compared:
            outcomes = self._outcomes(columns, places[compared], pre_ie)
            if not all(map(_alike, outcomes.points, (self.points[row] for row in compared))):
                return
        single[probes] = True
        self.columns, self.single, self.is_on_arrays = columns, single, True

    def _outcomes(self, columns: Vectorised, places: Floats, pre_ie: bool) -> Outcomes:
        forms = columns(places)
        factor = np.where(forms.factor > 0.0, forms.factor, np.nan)
        closed = ByMethod(forms.names, forms.outcome.astype(np.int16), factor)
        outcomes, limits, forming = outcomes_on_arrays(columns, places, closed, pre_ie)
        notes: list[tuple[Notice, ...]] = [()] * len(places)
        if limits is not None:
            of_answers = self._notes(columns, *columns.at(places[forming]), limits)
            for row in forming[limits.rows].tolist():
                notes[row] = (*self.notices, *next(of_answers))
            wholes = outcomes.wholes()
            notes = [_renamed(notes[row], _WHOLE, wholes[row]) for row in range(len(places))]
        return replace(outcomes, notes=notes)

    def _notes(
        self, columns: Vectorised, design: SlopeDesign, strengths: Sequence[Strength], limits: LimitsOfMany
    ) -> Iterator[tuple[Notice, ...]]:
        """Yield what a run says of each answer."""
        found, rows, count = limits.found, limits.rows, len(limits.status)
        if found is None:
            return
        cohesion, friction, shaken = (
            np.stack([np.broadcast_to(number, count)[rows] for number in numbers], axis=1)
            for numbers in (
                [strength.cohesion_kpa for strength in strengths],
                [strength.friction_angle_deg for strength in strengths], [design.seismic.coefficient],
            )
        )  # fmt: skip
        answered = ~np.isnan(found.factor)
        loses = (answered & ~found.moments_govern)[:, None] & (found.normal == 0.0) & (cohesion > 0.0)
        bare = np.all((cohesion == 0.0) & (friction == 0.0), axis=1)
        along = np.full(len(rows), np.nan)
        if shaken.any():
            velocity = found.velocity[:, :3]
            size = np.sqrt((velocity * velocity).sum(axis=1))
            ways = shaken_toward(design, columns.on_arrays, count)[rows]
            shows = answered & (shaken[:, 0] > 0.0) & (size > 0.0)
            along[shows] = (ways * velocity).sum(axis=1)[shows] / size[shows]
        joints, block = design.wet_interfaces, kind_of(design).words.block
        for lost, cosine, nothing in zip(loses, along.tolist(), bare, strict=True):
            yield (
                *(lost_contact(joints[k]) for k in np.flatnonzero(lost)),
                *(() if np.isnan(cosine) else shaking(cosine)),
                *([without_strength(block)] if nothing else ()),
            )


def _is_refused(design: Design, key: Key, value: float) -> bool:
    """Whether the reader of files refuses a value: a friction angle that looks like radians."""
    field = None if design.source is None else field_in(type(design), design.source.root, key.path)
    try:
        return field is not None and field.checked(value, key.path, "", key.written(value)) is None
    except DesignError:
        return True


def _renamed(
    notes: Iterable[Notice], of: WithoutBasal | str | None, other: WithoutBasal | str | None
) -> tuple[Notice, ...]:
    """Return notices with the words of one thing in place of those of another; as they are without either."""
    old, new = (name.in_words() if isinstance(name, WithoutBasal) else name for name in (of, other))
    if old is None or new is None:
        return tuple(notes)
    return tuple(replace(note, message=note.message.replace(old, new)) for note in notes)


def _alike(point: Point, run: Point) -> bool:
    """Whether arrays say what a run says."""
    ours, runs = point.factors, run.factors
    if ours is None or runs is None:
        return ours is runs
    (a, b), (c, d) = (
        ([of.limit or np.nan, of.closed_form or np.nan],
         (of.status, of.closed_status, of.agree, of.moments_govern, set(of.notes)))
        for of in (ours, runs)
    )  # fmt: skip
    return b == d and np.allclose(a, c, rtol=_SAME, atol=0.0, equal_nan=True)
