"""Rows of a design whose columns are numbers of it: on arrays where its kind takes them.

A few rows and the extreme ones are analysed as designs of their own, and those with a value that the reader of files
refuses, or with nearly parallel joints. Where a run says of the inputs of one of a few what it does not say of all,
what it says is asked of each row; where arrays find another answer there, no row is taken on arrays.
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
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import kind_of
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, motion_toward
from slopekit.kinds.single_block.closed_forms import DILATES
from slopekit.kinds.single_block.held_bolts import nearly_parallel
from slopekit.kinds.single_block.one_block import dilating, lost_contact, shaking, without_strength
from slopekit.notices import bolt_notices, common_notices, those_of_factors, undrawn_notice
from slopekit.studies.evaluation.rows import Rows, outcomes_on_arrays
from slopekit.studies.evaluation.vectorised import DesignRows, Vectorised, vectorised
from slopekit.studies.keys import Key, values_of
from slopekit.studies.outcomes import NO_BLOCK, Outcomes
from slopekit.studies.points import UNSETTLED, WITHOUT_FORCE, Point, point_of, status_of

_OF_ANSWERS, _OF_BOLTS = ("W307", "W308", "W310", "W328"), (WITHOUT_FORCE, undrawn_notice())
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
        for key, values in zip(keys, self.places.T, strict=True):
            if key.period is not None:
                values[(values < 0.0) | (values > key.period)] %= key.period
        self.points = dict[int, Point]()  # of rows that are designs of their own, so far
        self.columns: Vectorised | None = None
        self.notices: tuple[Notice, ...] | None = None  # that a run gives of the inputs, where of all rows the same
        if len(self.places) > _FEW and kind_of(design).on_arrays is not None:
            self._try_arrays(pre_ie)

    def __len__(self) -> int:
        return len(self.places)

    def inputs(self) -> list[object]:
        places = hashlib.sha256(self.places.tobytes()).hexdigest()
        return [*super().inputs(), [key.path for key in self.keys], places]

    def settings_at(self, row: int) -> Mapping[str, object]:
        return values_of(self.design, self.keys, self.places[row].tolist())

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        if self.columns is None:
            return np.arange(0), None
        at = self.places[start:stop]
        taken, rows = rows_at_once(self.columns, self.keys, at, self.keeps_bolts)
        new = np.flatnonzero(~np.isin(start + taken, [*self.points]))
        if not len(new):
            return new, None
        outcomes = self._outcomes(rows.of(new), pre_ie)
        # rows without an answer, or without a reason why no block forms, are designs of their own
        has_reason = np.array([bool(notes) for notes in outcomes.notes])
        forms, settled = ~outcomes.limit.among(*NO_BLOCK), ~outcomes.limit.among(UNSETTLED)
        known = np.flatnonzero(settled & (forms | has_reason))
        return taken[new[known]], outcomes.of(known)

    def point(self, row: int, pre_ie: bool) -> Point:
        return self.points[row] if row in self.points else super().point(row, pre_ie)

    def _try_arrays(self, pre_ie: bool) -> None:
        """Take rows on arrays where these say of a few what runs say of them."""
        places, keys, design = self.places, self.keys, self.design
        few = np.linspace(0, len(places) - 1, _FEW).astype(np.int64)
        probes = sorted({int(row) for row in (*few, *places.argmin(axis=0), *places.argmax(axis=0))})
        self.points.update((row, self.point(row, pre_ie)) for row in probes)
        columns = array_columns(design, keys, places)
        if columns is None:
            return
        of_inputs = {
            tuple(note for note in _renamed(point.notes, point.also, _WHOLE) if not _is_of_answer(note))
            for point in self.points.values()
            if point.factors is not None
        }
        # where the place of a crack lies is said of each
        self.notices = of_inputs.pop() if len(of_inputs) == 1 and not columns.searches_crack else None
        taken, rows = rows_at_once(columns, keys, places[probes], self.keeps_bolts)
        runs = [self.points[probes[row]] for row in taken.tolist()]
        if not runs or all(map(_alike, self._outcomes(rows, pre_ie).points, runs)):
            self.columns, self.is_on_arrays = columns, True

    def _outcomes(self, rows: DesignRows, pre_ie: bool) -> Outcomes:
        outcomes, limits, forming = outcomes_on_arrays(rows, rows.closed_form, pre_ie)
        notes: list[tuple[Notice, ...]] = [()] * len(rows)
        if limits is not None:
            wholes = outcomes.wholes()
            of_answers = _notices_of_answers(rows.of(forming), limits)
            for row in forming[limits.rows].tolist():
                notes[row] = (*self._notices_of_inputs(rows, row, wholes[row]), *next(of_answers))
        words = outcomes.limit.words
        for row in np.flatnonzero(outcomes.limit.among(*NO_BLOCK)).tolist():
            point = point_of(rows.design_at(row)[0], {}, pre_ie)
            notes[row] = (Notice(point.code, point.message),) * (point.code == words[row])
        return replace(outcomes, notes=notes)

    def _notices_of_inputs(self, rows: DesignRows, row: int, whole: WithoutBasal | None) -> Iterable[Notice]:
        """Return what a run says of the numbers of a row."""
        if self.notices is not None:
            return _renamed(self.notices, _WHOLE, whole)
        design, strengths = rows.design_at(row)
        of_kind = kind_of(design).notices(design, None, None, ClosedForm(None, ""))
        return those_of_factors((*of_kind, *common_notices(design, strengths), *bolt_notices(design)))


def _is_of_answer(note: Notice) -> bool:
    """Whether a run says it because of its answer; all else that it says follows from the inputs."""
    return note.code in _OF_ANSWERS or note in _OF_BOLTS


def _notices_of_answers(rows: DesignRows, limits: LimitsOfMany) -> Iterator[tuple[Notice, ...]]:
    """Yield what a run says of each answer among rows that form blocks."""
    (design, strengths), on_arrays = rows.numbers, rows.columns.on_arrays
    found, answers, count = limits.found, limits.rows, len(rows)
    if found is None:
        return
    cohesion, friction, shaken = (
        np.stack([np.broadcast_to(number, count)[answers] for number in numbers], axis=1)
        for numbers in (
            [strength.cohesion_kpa for strength in strengths],
            [strength.friction_angle_deg for strength in strengths], [design.seismic.coefficient],
        )
    )  # fmt: skip
    answered = ~np.isnan(found.factor)
    loses = (answered & ~found.moments_govern)[:, None] & (found.normal == 0.0) & (cohesion > 0.0)
    bare = np.all((cohesion == 0.0) & (friction == 0.0), axis=1) & ~limits.has_bolts
    along = np.full(len(answers), np.nan)
    if shaken.any():
        shows = answered & (shaken[:, 0] > 0.0)
        along[shows] = motion_toward(design, on_arrays, limits)[shows]
    joints, block = design.wet_interfaces, kind_of(design).words.block
    hold = np.broadcast_to(rows.holds.all(axis=0), count)[answers]
    undrawn = answered & limits.has_bolts & ~limits.draws_bolts
    for lost, cosine, holds, is_undrawn, nothing, is_dilating, is_pressed in zip(
        loses, along.tolist(), hold, undrawn, bare, rows.dilation()[0][answers], found.dilates, strict=True
    ):
        yield (
            *(() if holds else (WITHOUT_FORCE,)),
            *(lost_contact(joints[k]) for k in np.flatnonzero(lost)),
            *(() if np.isnan(cosine) else shaking(cosine)),
            *([undrawn_notice()] if is_undrawn else ()),
            *([without_strength(block)] if nothing else ()),
            *([dilating(DILATES, is_pressed)] if is_dilating else ()),
        )


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


def rows_at_once(
    columns: Vectorised, keys: Sequence[Key], places: Floats, keeps_bolts: bool = False
) -> tuple[Ints, DesignRows]:
    """Which rows are taken on arrays, and these: no nearly parallel joints, no values that the reader of files refuses.

    Neither are those with a bolt that does not hold the block, but where that gives no force there.

    Parameters
    ----------
    keys : of the columns that a file has
    """
    rows = columns.rows(places)
    with np.errstate(divide="ignore", invalid="ignore"):  # at places whose planes cut no block
        single = nearly_parallel(columns.on_arrays.bounds(rows.numbers[0]), len(places))
        single |= not keeps_bolts and ~rows.holds.all(axis=0)
    single |= rows.dilation()[1]
    for key, values in zip(keys, places.T, strict=False):
        refused = [value for value in np.unique(values).tolist() if _is_refused(columns.design, key, value)]
        single |= np.isin(values, refused)
    taken = np.flatnonzero(~single)
    return taken, rows.of(taken)


def points_on_arrays(columns: Vectorised, keys: Sequence[Key], places: Floats, pre_ie: bool) -> list[Point | None]:
    """The points of rows on arrays, without notices and reasons; None of rows that are designs of their own."""
    points: list[Point | None] = [None] * len(places)
    taken, rows = rows_at_once(columns, keys, places)
    if len(taken):
        outcomes = outcomes_on_arrays(rows, rows.closed_form, pre_ie)[0]
        for row, point in zip(taken.tolist(), outcomes.points, strict=True):
            points[row] = None if status_of(point, "pre_ie") == UNSETTLED else point
    return points


def _is_refused(design: Design, key: Key, value: float) -> bool:
    """Whether the reader of files refuses a value: a friction angle that looks like radians."""
    assert design.source is not None  # of which the key is one
    field = field_in(type(design), design.source.root, key.path)
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
