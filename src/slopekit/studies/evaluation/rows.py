"""Evaluate many variants of one design, each with other values, by both methods, piece by piece.

rows -> pieces -> outcomes of each piece, on arrays where the kind has them, else one by one -> outcomes of all
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
from slopekit.studies.outcomes import (
    NO_BLOCK,
    ByMethod,
    Outcomes,
    agreement,
    merged,
    outcomes_from_points,
)
from slopekit.studies.points import GIVEN_UP, Point, map_rows, point_with
from slopekit.studies.running import ExecutorOptions, Record, RowArrays

#: Rows of a task on arrays, by both methods and by the closed form alone, so that memory stays small.
PIECE, PIECE_OF_CLOSED_FORMS = 2**11, 2**15


class Rows:
    """Variants of one design with other values in each row; each is read and analysed by itself.

    Parameters
    ----------
    design : the design that is varied; settings : (n) values of each row, as `with_values` takes them
    keeps_bolts : as `points.point_with` has it

    Attributes
    ----------
    is_on_arrays : whether any rows are evaluated on arrays
    """

    is_on_arrays = False

    def __init__(
        self, design: Design, settings: Sequence[Mapping[str, object]], keeps_bolts: bool = False
    ) -> None:
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

    def piece(self, start: int, stop: int) -> tuple["Rows", int, int]:
        """Return a piece of the rows for a worker: the rows that are sent, and the first and end index within these."""
        if self.is_on_arrays:
            return self, start, stop
        return (
            Rows(self.design, [*map(self.settings_at, range(start, stop))], self.keeps_bolts),
            0,
            stop - start,
        )

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        """Return which rows of a piece are evaluated on arrays, counted from its first, and their outcomes."""
        return np.arange(0), None

    def point(self, row: int, pre_ie: bool) -> Point:
        """Return the point of a row that is analysed by itself, by both methods or the closed form alone."""
        return point_with(self.design, pre_ie, self.keeps_bolts, self.settings_at(row))

    def whole(self, row: int, point: Point) -> WithoutBasal | None:
        """Return the wedge without basal plane of such a row, whose factor acceptance requires too; None without."""
        return point.also


class BlockRows(Rows):
    """Blocks on arrays that a study has made itself, all of which form.

    Parameters
    ----------
    closed : (n) outcomes of the closed form; source : what the blocks depend on, as JSON values
    limits : returns the limits by PRE-IE of blocks with numbers (m,)
    """

    is_on_arrays = True

    def __init__(
        self,
        design: Design,
        closed: ByMethod,
        source: list[object],
        limits: Callable[[Ints], LimitsOfMany],
    ) -> None:
        super().__init__(design, ())
        self.closed, self.source, self.limits = closed, source, limits

    def __len__(self) -> int:
        return len(self.closed.outcome)

    def inputs(self) -> list[object]:
        return self.source

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        rows = np.arange(start, stop)
        analysed, tolerance = self.limits(rows), self.design.analysis.agree_within
        limit = ByMethod.from_words(analysed.status.tolist(), analysed.limit)
        return rows - start, agreement(limit, analysed.forces, self.closed.take(rows), tolerance)


def chosen_methods(design: Design, closed_form: bool) -> str:
    """Return the word for the methods of a study, both or closed-form; E313 where the kind has no closed form."""
    if closed_form and not design.HAS_CLOSED_FORM:
        fail(
            "E313",
            f"a {design.kind} has no closed form that could be asked alone",
            "",
            "Leave --closed-form out: PRE-IE answers.",
        )
    return "closed-form" if closed_form else "both"


def evaluated(
    rows: Rows,
    study: str,
    crew: ExecutorOptions,
    desk: Workplace,
    pre_ie: bool = True,
    label: str = "points",
) -> Outcomes:
    """Return the outcomes of all rows by both methods, or the closed form alone; a journal keeps finished pieces.

    Parameters
    ----------
    study, label : names of the journal and of the progress bar
    """
    size = 1 if not rows.is_on_arrays else PIECE if pre_ie else PIECE_OF_CLOSED_FORMS
    given_up = outcomes_from_points([GIVEN_UP], [None], pre_ie).record() if size == 1 else None
    columns = RowArrays([*range(0, len(rows), size), len(rows)])
    tasks = [rows.piece(*piece) for piece in columns.pieces]
    tasks_at_once = 8 if size == 1 and rows.design.HAS_CLOSED_FORM else 1
    run, label = [*rows.inputs(), pre_ie], label if size == 1 else f"pieces of {size} {label}"
    map_rows(
        partial(outcomes_of_part, pre_ie),
        tasks,
        columns,
        crew,
        desk,
        study,
        label,
        run,
        tasks_at_once,
        given_up,
    )
    return Outcomes.joined(columns, pre_ie)


def outcomes_of_part(pre_ie: bool, piece: tuple[Rows, int, int]) -> Record:
    """Return the record of the outcomes of a piece of rows, the task of a worker."""
    rows, start, stop = piece
    array_rows, outcomes = rows.at_once(start, stop, pre_ie)
    single = np.setdiff1d(np.arange(stop - start), array_rows)
    pieces = [] if outcomes is None else [(array_rows, outcomes)]
    if len(single):
        points = [rows.point(start + row, pre_ie) for row in single.tolist()]
        pieces.append(
            (
                single,
                outcomes_from_points(
                    points, [*map(rows.whole, (start + single).tolist(), points)], pre_ie
                ),
            )
        )
    return merged(pieces).record()


def outcomes_on_arrays(
    rows: DesignRows, closed: ByMethod, pre_ie: bool
) -> tuple[Outcomes, LimitsOfMany | None, Ints]:
    """Return the outcomes of rows on arrays, the limits by PRE-IE, and the numbers (b,) of the rows that have them.

    Parameters
    ----------
    closed : the outcomes of the closed form
    """
    without_basal, forming = rows.without_basal(), np.flatnonzero(~closed.starts_with(*NO_BLOCK))
    if not pre_ie:
        return Outcomes.by_closed_form(closed, without_basal), None, forming
    words = np.array(closed.names, dtype=object)[closed.outcome]
    factor, forces = np.full((2, len(words)), np.nan)
    limits = rows.take(forming).limits() if len(forming) else None
    if limits is not None:
        words[forming], factor[forming], forces[forming] = (
            limits.status,
            limits.limit,
            limits.forces,
        )
    limit = ByMethod.from_words(words.tolist(), factor)
    tolerance, is_compared = rows.columns.design.analysis.agree_within, ~rows.dilation()[0]
    return (
        agreement(
            limit,
            forces,
            closed.refused(words),
            tolerance,
            without_basal=without_basal,
            compared=is_compared,
        ),
        limits,
        forming,
    )
