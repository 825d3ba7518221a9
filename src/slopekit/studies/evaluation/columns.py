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

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import DesignError, Notice
from slopekit.design.common import Design
from slopekit.design.fields import field_in
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import kind_of
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, motion_toward
from slopekit.kinds.single_block.held_bolts import nearly_parallel
from slopekit.kinds.single_block.one_block import DILATES
from slopekit.kinds.single_block.one_block_notices import dilating, lost_contact, shaking, without_strength
from slopekit.studies.evaluation.rows import Rows, outcomes_on_arrays
from slopekit.studies.evaluation.vectorised import Vectorised, vectorised
from slopekit.studies.keys import Key, values_of
from slopekit.studies.outcomes import NO_BLOCK, ByMethod, Outcomes
from slopekit.studies.points import UNSETTLED, WITHOUT_FORCE, Point, status_of

#: What a run says because of its answer; all else that it says follows from the inputs.
_OF_ANSWERS = ("W307", "W308", "W310", "W328")
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
        if len(self.places) > _FEW and may_be_on_arrays(design):
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
        columns = array_columns(design, keys, places)
        of_inputs = {
            tuple(
                note
                for note in _renamed(point.notes, point.also, _WHOLE)
                if note.code not in _OF_ANSWERS and note != WITHOUT_FORCE
            )
            for point in self.points.values()
            if point.factors is not None
        }
        if columns is None or len(of_inputs) != 1:
            return
        self.notices = of_inputs.pop()
        single = single_rows(columns, design, keys, places, self.keeps_bolts)
        compared = [row for row in self.points if not single[row]]
        if compared:
            outcomes = self._outcomes(columns, places[compared], pre_ie)
            if not all(map(_alike, outcomes.points, (self.points[row] for row in compared))):
                return
        single[probes] = True
        self.columns, self.single, self.is_on_arrays = columns, single, True

    def _outcomes(self, columns: Vectorised, places: Floats, pre_ie: bool) -> Outcomes:
        outcomes, limits, forming = outcomes_on_arrays(columns, places, closed_forms_of(columns, places), pre_ie)
        notes: list[tuple[Notice, ...]] = [()] * len(places)
        if limits is not None:
            of_answers = self._notes(columns, places[forming], limits)
            for row in forming[limits.rows].tolist():
                notes[row] = (*self.notices, *next(of_answers))
            wholes = outcomes.wholes()
            notes = [_renamed(notes[row], _WHOLE, wholes[row]) for row in range(len(places))]
        return replace(outcomes, notes=notes)

    def _notes(self, columns: Vectorised, places: Floats, limits: LimitsOfMany) -> Iterator[tuple[Notice, ...]]:
        """Yield what a run says of each answer at places."""
        design, strengths = columns.at(places)
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
            shows = answered & (shaken[:, 0] > 0.0)
            along[shows] = motion_toward(design, columns.on_arrays, limits)[shows]
        joints, block = design.wet_interfaces, kind_of(design).words.block
        hold = np.broadcast_to(columns.holds(places).all(axis=0), count)[rows]
        dilates = columns.dilation(places)[0][rows]
        for lost, cosine, nothing, holds, is_dilating, is_pressed in zip(
            loses, along.tolist(), bare, hold, dilates, found.dilates, strict=True
        ):
            yield (
                *(() if holds else (WITHOUT_FORCE,)),
                *(lost_contact(joints[k]) for k in np.flatnonzero(lost)),
                *(() if np.isnan(cosine) else shaking(cosine)),
                *([without_strength(block)] if nothing else ()),
                *([dilating(DILATES, is_pressed)] if is_dilating else ()),
            )


def may_be_on_arrays(design: Design) -> bool:
    """Whether rows of a design may be taken on arrays: none whose crack is looked for are."""
    return kind_of(design).on_arrays is not None and not getattr(design, "crack_searched", "")


def array_columns(design: Design, keys: Sequence[Key], places: Floats) -> Vectorised | None:
    """The columns of a design on arrays, None where its kind, or one of these values, does not take them.

    Parameters
    ----------
    places : (n, k) values of the keys
    """

    def settings_at(row: int) -> Mapping[str, object]:
        return values_of(design, keys, places[row].tolist())

    for row in np.argsort(-places[:, 0])[:: -(-len(places) // _FEW)].tolist():
        try:  # with whatever has to be written first
            fullest = with_values(design, settings_at(row))
        except DesignError:
            continue
        return vectorised(fullest, places, settings_at, [key.path for key in keys])
    return None


def single_rows(
    columns: Vectorised, design: Design, keys: Sequence[Key], places: Floats, keeps_bolts: bool = False
) -> Bools:
    """Which rows (n,) are designs of their own: nearly parallel joints, values that the reader of files refuses.

    So are those with a bolt that does not hold the block, but where that gives no force there.
    """
    with np.errstate(divide="ignore", invalid="ignore"):  # at places whose planes cut no block
        single = nearly_parallel(columns.on_arrays.bounds(columns.at(places)[0]), len(places))
        single |= not keeps_bolts and ~columns.holds(places).all(axis=0)
    single |= columns.dilation(places)[1]
    for key, values in zip(keys, places.T, strict=True):
        refused = [value for value in np.unique(values).tolist() if _is_refused(design, key, value)]
        single |= np.isin(values, refused)
    return single


def closed_forms_of(columns: Vectorised, places: Floats) -> ByMethod:
    """What the closed form says of rows on arrays; no strength at all is a status, no number."""
    forms = columns(places)
    return ByMethod(forms.names, forms.outcome.astype(np.int16), np.where(forms.factor > 0.0, forms.factor, np.nan))


def points_on_arrays(
    columns: Vectorised, design: Design, keys: Sequence[Key], places: Floats, pre_ie: bool
) -> list[Point | None]:
    """The points of rows on arrays, without notices and reasons; None of rows that are designs of their own."""
    points: list[Point | None] = [None] * len(places)
    rows = np.flatnonzero(~single_rows(columns, design, keys, places))
    if len(rows):
        outcomes = outcomes_on_arrays(columns, places[rows], closed_forms_of(columns, places[rows]), pre_ie)[0]
        for row, point in zip(rows.tolist(), outcomes.points, strict=True):
            points[row] = None if status_of(point, "pre_ie") == UNSETTLED else point
    return points


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
