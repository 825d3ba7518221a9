"""Evaluate rows of a design whose columns are values of its keys, on arrays where its kind has them.

A few probe rows and the extreme ones are analysed one by one, as are rows with a value that the reader of files refuses
and rows with nearly parallel joints. Where the notices on the inputs differ between probes they are found for each row;
where the arrays differ from the runs of the probes no row is evaluated on arrays.
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
from slopekit.notices import bolt_notices, common_notices, factor_notices, undrawn_notice
from slopekit.studies.evaluation.rows import Rows, outcomes_on_arrays
from slopekit.studies.evaluation.vectorised import DesignRows, Vectorised, vectorised
from slopekit.studies.keys import Key, values_of
from slopekit.studies.outcomes import NO_BLOCK, Outcomes
from slopekit.studies.points import UNSETTLED, WITHOUT_FORCE, Point, point_of, status_of

_ANSWER_CODES, _BOLT_NOTICES = ("W307", "W308", "W310", "W328"), (WITHOUT_FORCE, undrawn_notice())
_SUBJECT_MARK = "{whole}"  # stands in a notice for the wedge without basal plane, whose factor is a number of the row
_FACTOR_TOLERANCE = (
    1e-6  # relative difference of factors of the same design, on arrays and by a run
)
_PROBE_ROWS = 9


class ColumnRows(Rows):
    """Rows with other values of some keys of a design.

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
        self.points = dict[int, Point]()  # of rows analysed one by one so far
        self.columns: Vectorised | None = None
        self.notices: tuple[Notice, ...] | None = (
            None  # on the inputs, where all rows have the same
        )
        if len(self.places) > _PROBE_ROWS and kind_of(design).on_arrays is not None:
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
        places = self.places[start:stop]
        array_rows, rows = rows_at_once(self.columns, self.keys, places, self.keeps_bolts)
        new = np.flatnonzero(~np.isin(start + array_rows, [*self.points]))
        if not len(new):
            return new, None
        outcomes = self._outcomes(rows.take(new), pre_ie)
        # rows that did not converge, or have no reason why no block forms, are analysed one by one
        has_reason = np.array([bool(notes) for notes in outcomes.notes])
        forms, settled = (
            ~outcomes.limit.starts_with(*NO_BLOCK),
            ~outcomes.limit.starts_with(UNSETTLED),
        )
        answered = np.flatnonzero(settled & (forms | has_reason))
        return array_rows[new[answered]], outcomes.take(answered)

    def point(self, row: int, pre_ie: bool) -> Point:
        return self.points[row] if row in self.points else super().point(row, pre_ie)

    def _try_arrays(self, pre_ie: bool) -> None:
        """Use arrays where they give the factors of the runs of the probe rows."""
        places, keys, design = self.places, self.keys, self.design
        spaced_rows = np.linspace(0, len(places) - 1, _PROBE_ROWS).astype(np.int64)
        probes = sorted(
            {int(row) for row in (*spaced_rows, *places.argmin(axis=0), *places.argmax(axis=0))}
        )
        self.points.update((row, self.point(row, pre_ie)) for row in probes)
        columns = array_columns(design, keys, places)
        if columns is None:
            return
        of_inputs = {
            tuple(
                note
                for note in _with_subject(point.notes, point.also, _SUBJECT_MARK)
                if not _depends_on_answer(note)
            )
            for point in self.points.values()
            if point.factors is not None
        }
        # each row has its own notice on the place of the crack
        self.notices = (
            of_inputs.pop() if len(of_inputs) == 1 and not columns.searches_crack else None
        )
        array_rows, rows = rows_at_once(columns, keys, places[probes], self.keeps_bolts)
        runs = [self.points[probes[row]] for row in array_rows.tolist()]
        if not runs or all(map(_agrees_with_run, self._outcomes(rows, pre_ie).points, runs)):
            self.columns, self.is_on_arrays = columns, True

    def _outcomes(self, rows: DesignRows, pre_ie: bool) -> Outcomes:
        outcomes, limits, forming = outcomes_on_arrays(rows, rows.closed_form, pre_ie)
        notes: list[tuple[Notice, ...]] = [()] * len(rows)
        if limits is not None:
            without_basal = outcomes.wedges_without_basal()
            of_answers = _notices_of_answers(rows.take(forming), limits)
            for row in forming[limits.rows].tolist():
                notes[row] = (
                    *self._notices_of_inputs(rows, row, without_basal[row]),
                    *next(of_answers),
                )
        words = outcomes.limit.words
        for row in np.flatnonzero(outcomes.limit.starts_with(*NO_BLOCK)).tolist():
            point = point_of(rows.design_at(row)[0], {}, pre_ie)
            notes[row] = (Notice(point.code, point.message),) * (point.code == words[row])
        return replace(outcomes, notes=notes)

    def _notices_of_inputs(
        self, rows: DesignRows, row: int, without_basal: WithoutBasal | None
    ) -> Iterable[Notice]:
        """Return the notices of a run on the inputs of a row."""
        if self.notices is not None:
            return _with_subject(self.notices, _SUBJECT_MARK, without_basal)
        design, strengths = rows.design_at(row)
        of_kind = kind_of(design).notices(design, None, None, ClosedForm(None, ""))
        return factor_notices((*of_kind, *common_notices(design, strengths), *bolt_notices(design)))


def _depends_on_answer(note: Notice) -> bool:
    """Return whether a notice follows from the answer of a run, not from its inputs alone."""
    return note.code in _ANSWER_CODES or note in _BOLT_NOTICES


def _notices_of_answers(rows: DesignRows, limits: LimitsOfMany) -> Iterator[tuple[Notice, ...]]:
    """Yield the notices of a run on each answer among rows that form blocks."""
    (design, strengths), on_arrays = rows.numbers, rows.columns.on_arrays
    solved, answers, count = limits.limits, limits.rows, len(rows)
    if solved is None:
        return
    cohesion, friction, shaken = (
        np.stack([np.broadcast_to(number, count)[answers] for number in numbers], axis=1)
        for numbers in (
            [strength.cohesion_kpa for strength in strengths],
            [strength.friction_angle_deg for strength in strengths],
            [design.seismic.coefficient],
        )
    )
    answered = ~np.isnan(solved.factor)
    loses = (answered & ~solved.moments_govern)[:, None] & (solved.normal == 0.0) & (cohesion > 0.0)
    strengthless = np.all((cohesion == 0.0) & (friction == 0.0), axis=1) & ~limits.has_bolts
    along = np.full(len(answers), np.nan)
    if shaken.any():
        is_shown = answered & (shaken[:, 0] > 0.0)
        along[is_shown] = motion_toward(design, on_arrays, limits)[is_shown]
    joints, block = design.wet_interfaces, kind_of(design).words.block
    hold = np.broadcast_to(rows.holds.all(axis=0), count)[answers]
    undrawn = answered & limits.has_bolts & ~limits.draws_bolts
    for contacts_lost, cosine, holds, is_undrawn, has_no_strength, is_dilating, is_pressed in zip(
        loses,
        along.tolist(),
        hold,
        undrawn,
        strengthless,
        rows.dilation()[0][answers],
        solved.dilates,
        strict=True,
    ):
        yield (
            *(() if holds else (WITHOUT_FORCE,)),
            *(lost_contact(joints[k]) for k in np.flatnonzero(contacts_lost)),
            *(() if np.isnan(cosine) else shaking(cosine)),
            *([undrawn_notice()] if is_undrawn else ()),
            *([without_strength(block)] if has_no_strength else ()),
            *([dilating(DILATES, is_pressed)] if is_dilating else ()),
        )


def array_columns(design: Design, keys: Sequence[Key], places: Floats) -> Vectorised | None:
    """Return the columns of a design on arrays, None where its kind or one of the values has no arrays.

    Parameters
    ----------
    places : (n, k) values of the keys
    """

    def settings_at(row: int) -> Mapping[str, object]:
        return values_of(design, keys, places[row].tolist())

    for row in np.argsort(-places[:, 0])[:: -(-len(places) // _PROBE_ROWS)].tolist():
        try:  # a design that has every group that the keys need
            fullest = with_values(design, settings_at(row))
        except DesignError:
            continue
        return vectorised(fullest, places, settings_at, [key.path for key in keys])
    return None


def rows_at_once(
    columns: Vectorised, keys: Sequence[Key], places: Floats, keeps_bolts: bool = False
) -> tuple[Ints, DesignRows]:
    """Return the numbers of the rows that are evaluated on arrays, and these rows.

    Left out are rows with nearly parallel joints, with values that the reader of files refuses, and with a bolt that
    misses the block unless it gives no force then.

    Parameters
    ----------
    keys : those of the columns that stand in a file
    keeps_bolts : a bolt that misses the block gives no force there
    """
    rows = columns.rows(places)
    with np.errstate(divide="ignore", invalid="ignore"):  # where the planes cut no block
        single = nearly_parallel(columns.on_arrays.bounds(rows.numbers[0]), len(places))
        single |= not keeps_bolts and ~rows.holds.all(axis=0)
    single |= rows.dilation()[1]
    for key, values in zip(keys, places.T, strict=False):
        refused = [
            value for value in np.unique(values).tolist() if _is_refused(columns.design, key, value)
        ]
        single |= np.isin(values, refused)
    array_rows = np.flatnonzero(~single)
    return array_rows, rows.take(array_rows)


def points_on_arrays(
    columns: Vectorised, keys: Sequence[Key], places: Floats, pre_ie: bool
) -> list[Point | None]:
    """Return the points of rows on arrays, without notices and reasons; None where a row needs a run of its own."""
    points: list[Point | None] = [None] * len(places)
    array_rows, rows = rows_at_once(columns, keys, places)
    if len(array_rows):
        outcomes = outcomes_on_arrays(rows, rows.closed_form, pre_ie)[0]
        for row, point in zip(array_rows.tolist(), outcomes.points, strict=True):
            points[row] = None if status_of(point, "pre_ie") == UNSETTLED else point
    return points


def _is_refused(design: Design, key: Key, value: float) -> bool:
    """Return whether the reader of files refuses a value, such as a friction angle that looks like radians."""
    assert design.source is not None  # of which the key is one
    field = field_in(type(design), design.source.root, key.path)
    try:
        return field is not None and field.checked(value, key.path, "", key.written(value)) is None
    except DesignError:
        return True


def _with_subject(
    notes: Iterable[Notice],
    old_subject: WithoutBasal | str | None,
    new_subject: WithoutBasal | str | None,
) -> tuple[Notice, ...]:
    """Return notices with the words of one subject replaced by those of another; unchanged where either is None."""
    old_words, new_words = (
        name.in_words() if isinstance(name, WithoutBasal) else name
        for name in (old_subject, new_subject)
    )
    if old_words is None or new_words is None:
        return tuple(notes)
    return tuple(
        replace(note, message=note.message.replace(old_words, new_words)) for note in notes
    )


def _agrees_with_run(point: Point, run: Point) -> bool:
    """Return whether the point on arrays has the factors, statuses and notices of the run."""
    array_factors, run_factors = point.factors, run.factors
    if array_factors is None or run_factors is None:
        return array_factors is run_factors
    (a, b), (c, d) = (
        (
            [factors.limit or np.nan, factors.closed_form or np.nan],
            (
                factors.status,
                factors.closed_status,
                factors.agree,
                factors.moments_govern,
                set(factors.notes),
            ),
        )
        for factors in (array_factors, run_factors)
    )
    return b == d and np.allclose(a, c, rtol=_FACTOR_TOLERANCE, atol=0.0, equal_nan=True)
