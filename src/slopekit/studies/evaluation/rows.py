"""Rows of one design: other values in each, and what both methods say of them, piece by piece.

rows -> pieces -> outcomes of each, on arrays where the kind takes them, else design by design -> outcomes of all
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from slopekit.core.arrays import Ints
from slopekit.core.errors import fail
from slopekit.core.options import Workplace
from slopekit.design.common import Design
from slopekit.evidence import WithoutBasal
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany
from slopekit.studies.evaluation.vectorised import DesignRows
from slopekit.studies.outcomes import NO_BLOCK, ByMethod, Outcomes, agreement, merged, outcomes_from_points
from slopekit.studies.points import GIVEN_UP, Point, map_rows, point_with
from slopekit.studies.running import Crew, Record, RowArrays

#: Rows of a task that are taken at once, by both methods and by the closed form alone: what stays small in memory.
PIECE, PIECE_OF_CLOSED_FORMS = 2**11, 2**15


class Rows:
    """Designs that are one with other values, row by row; each is read and analysed by itself.

    Parameters
    ----------
    design : that they are; settings : (n) values of each row, as `with_values` takes them
    keeps_bolts : as `points.point_with` has it

    Attributes
    ----------
    is_on_arrays : whether any rows are taken at once
    """

    is_on_arrays = False

    def __init__(self, design: Design, settings: Sequence[Mapping[str, object]], keeps_bolts: bool = False) -> None:
        self.design, self.settings, self.keeps_bolts = design, settings, keeps_bolts

    def __len__(self) -> int:
        return len(self.settings)

    def inputs(self) -> list[object]:
        """Return everything that the outcomes depend on, as JSON values."""
        source, settings = self.design.source, [list(values.items()) for values in self.settings]
        return [None if source is None else source.root.plain(), self.design.input_hash(), settings]

    def settings_at(self, row: int) -> Mapping[str, object]:
        """Return the values of a row, as `with_values` takes them."""
        return self.settings[row]

    def part(self, start: int, stop: int) -> tuple["Rows", int, int]:
        """Return some rows as a worker gets them: rows, and which of these, from the first to an end."""
        if self.is_on_arrays:
            return self, start, stop
        return Rows(self.design, [*map(self.settings_at, range(start, stop))], self.keeps_bolts), 0, stop - start

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        """Return which of some rows are taken at once, counted from the first of them, and what is said of those."""
        return np.arange(0), None

    def point(self, row: int, pre_ie: bool) -> Point:
        """Return what both methods say of a row that is a design of its own, or the closed form alone."""
        return point_with(self.design, pre_ie, self.keeps_bolts, self.settings_at(row))

    def whole(self, row: int, point: Point) -> WithoutBasal | None:
        """Return what acceptance of such a row is held against too, by its point."""
        return point.also


class BlockRows(Rows):
    """Blocks that all form, on arrays that a study has itself.

    Parameters
    ----------
    closed : (n) what the closed form says of them; source : what they depend on, as JSON values
    limits : what PRE-IE says of some of them (m,), by their numbers
    """

    is_on_arrays = True

    def __init__(
        self, design: Design, closed: ByMethod, source: list[object], limits: Callable[[Ints], LimitsOfMany]
    ) -> None:
        super().__init__(design, ())
        self.closed, self.source, self.limits = closed, source, limits

    def __len__(self) -> int:
        return len(self.closed.outcome)

    def inputs(self) -> list[object]:
        return self.source

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        rows = np.arange(start, stop)
        found, within = self.limits(rows), self.design.analysis.agree_within
        limit = ByMethod.of(found.status.tolist(), found.limit)
        return rows - start, agreement(limit, found.forces, self.closed.take(rows), within)


def chosen_methods(design: Design, closed_form: bool) -> str:
    """What the document says of the methods: both, or closed-form; E313 where the kind has none to be asked alone."""
    if closed_form and not design.HAS_CLOSED_FORM:
        fail(
            "E313",
            f"a {design.kind} has no closed form that could be asked alone",
            "",
            "Leave --closed-form out: PRE-IE answers.",
        )
    return "closed-form" if closed_form else "both"


def evaluated(
    rows: Rows, study: str, crew: Crew, desk: Workplace, pre_ie: bool = True, label: str = "points"
) -> Outcomes:
    """Return what both methods say of all rows, or the closed form alone; a journal keeps what is done.

    Parameters
    ----------
    study, label : names of the journal and of the bar
    """
    size = 1 if not rows.is_on_arrays else PIECE if pre_ie else PIECE_OF_CLOSED_FORMS
    given_up = outcomes_from_points([GIVEN_UP], [None], pre_ie).record() if size == 1 else None
    columns = RowArrays([*range(0, len(rows), size), len(rows)])
    tasks = [rows.part(*piece) for piece in columns.pieces]
    handed_out = 8 if size == 1 and rows.design.HAS_CLOSED_FORM else 1
    run, label = [*rows.inputs(), pre_ie], label if size == 1 else f"pieces of {size} {label}"
    map_rows(partial(outcomes_of_part, pre_ie), tasks, columns, crew, desk, study, label, run, handed_out, given_up)
    return Outcomes.joined(columns, pre_ie)


def outcomes_of_part(pre_ie: bool, part: tuple[Rows, int, int]) -> Record:
    """Return the outcomes of a part of rows as their record: what a worker does."""
    rows, start, stop = part
    taken, outcomes = rows.at_once(start, stop, pre_ie)
    single = np.setdiff1d(np.arange(stop - start), taken)
    parts = [] if outcomes is None else [(taken, outcomes)]
    if len(single):
        points = [rows.point(start + row, pre_ie) for row in single.tolist()]
        parts.append(
            (single, outcomes_from_points(points, [*map(rows.whole, (start + single).tolist(), points)], pre_ie))
        )
    return merged(parts).record()


def outcomes_on_arrays(rows: DesignRows, closed: ByMethod, pre_ie: bool) -> tuple[Outcomes, LimitsOfMany | None, Ints]:
    """Return what both methods say of rows on arrays, all that PRE-IE says, and of which rows (b,) it says it.

    Parameters
    ----------
    closed : what the closed form says of them
    """
    whole, forming = rows.without_basal(), np.flatnonzero(~closed.among(*NO_BLOCK))
    if not pre_ie:
        return Outcomes.by_closed_form(closed, whole), None, forming
    words = np.array(closed.names, dtype=object)[closed.outcome]
    factor, forces = np.full((2, len(words)), np.nan)
    limits = rows.of(forming).limits() if len(forming) else None
    if limits is not None:
        words[forming], factor[forming], forces[forming] = limits.status, limits.limit, limits.forces
    limit = ByMethod.of(words.tolist(), factor)
    within, is_compared = rows.columns.design.analysis.agree_within, ~rows.dilation()[0]
    return agreement(limit, forces, closed.refused(words), within, whole=whole, compared=is_compared), limits, forming
