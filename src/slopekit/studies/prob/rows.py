"""Samples of a design as rows: what was drawn of its numbers, and the place of a crack that is looked for in each."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import SlopekitError
from slopekit.design.common import Design
from slopekit.design.fields import field_in
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import kind_of
from slopekit.studies.evaluation.rows import Rows, outcomes_on_arrays
from slopekit.studies.evaluation.vectorised import Vectorised, vectorised
from slopekit.studies.outcomes import UNJUDGED, ByMethod, Outcomes
from slopekit.studies.points import WITHOUT_FORCE, Point
from slopekit.studies.prob.cracks import crack_search, placed
from slopekit.studies.prob.judged import IMPOSSIBLE
from slopekit.studies.prob.sampling import Samples, settings_of

_FIRST = 8  # samples that are read, beside those at the ends of every column
_NO_PLACE = "E459"  # no place of the crack gives a factor


class SampleRows(Rows):
    """Samples of a design, and how they are taken.

    Parameters
    ----------
    samples : as drawn

    Attributes
    ----------
    design : with its crack at a place, where `search` finds one for each sample
    fast : takes all samples at once, None where each is a design of its own
    """

    def __init__(self, design: Design, samples: Samples) -> None:
        ends = [piece[[*piece.argmin(axis=0), *piece.argmax(axis=0)]] for piece in samples.pieces()]
        values = np.unique(np.concatenate([samples.rows(0, min(_FIRST, samples.count)), *ends]), axis=0)
        super().__init__(design, (), True)
        self.samples, self.search = samples, None
        search = crack_search(design, values)
        if search is not None:
            self.design, self.search = search
            values = placed(self.search, values)[0]
        self.fast = vectorised(self.design, values, lambda row: settings_of(self.design.variables, values[row]))
        self.is_on_arrays = self.fast is not None

    def __len__(self) -> int:
        return self.samples.count

    def inputs(self) -> list[object]:
        design, samples = self.design, self.samples
        drawn = [repr(design.variables), repr(design.correlation), samples.count, samples.method, samples.seed]
        return [*super().inputs(), *drawn]

    def part(self, start: int, stop: int) -> tuple[Rows, int, int]:
        return self, start, stop  # each worker draws its own samples

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        if self.fast is None:
            return np.arange(0), None
        values, nowhere = self.placed(start, stop)
        closed = self._closed_form(self.fast, values, nowhere)
        return np.arange(stop - start), outcomes_on_arrays(self.fast, values, closed, pre_ie)[0]

    def point(self, row: int, pre_ie: bool) -> Point:
        point = super().point(row, pre_ie)
        notes = (WITHOUT_FORCE,) * (WITHOUT_FORCE in point.notes)  # all others are said of the means once
        return point if point.factors is None else replace(point, factors=replace(point.factors, notes=notes))

    def whole(self, row: int, point: Point) -> WithoutBasal | None:
        if point.factors is not None or not point.code.startswith(("E2", "E44")) or point.code in UNJUDGED:
            return point.also
        try:
            sample = with_values(self.design, self.settings_at(row))
            return kind_of(sample).without_basal(sample)
        except SlopekitError:
            return None

    def settings_at(self, row: int) -> dict[str, float | str]:
        return settings_of(self.design.variables, self.values(row, row + 1)[0])

    def values(self, start: int, stop: int) -> Floats:
        """The values of some samples, with the place of their crack (stop - start, k)."""
        return self.placed(start, stop)[0]

    def placed(self, start: int, stop: int) -> tuple[Floats, Bools]:
        """The same, and in which of them (stop - start,) no place of the crack gives a factor."""
        drawn = self.samples.rows(start, stop)
        return (drawn, np.zeros(len(drawn), dtype=bool)) if self.search is None else placed(self.search, drawn)

    def pieces(self, forms: Bools) -> Iterator[tuple[slice, Bools]]:
        """The rows of all blocks, and which of them form a block; forms : (n,)."""
        return ((rows, forms[rows]) for rows in map(slice, self.samples.ends, self.samples.ends[1:]))

    def sizes(self, rows: slice, forms: Bools) -> dict[str, Floats]:
        """The sizes of the blocks of some samples (m,) by their keys, nan where none forms; empty: not known."""
        return {} if self.fast is None else self.fast.sizes(self.values(rows.start, rows.stop), forms)

    def without_force(self, outcomes: Outcomes, forms: Bools) -> Ints:
        """How many bolts do not hold the block of each sample (n,), 0 where none forms.

        Of samples that are read one by one, 1 for any number of them.
        """
        if self.fast is None:
            return (forms & [WITHOUT_FORCE in notes for notes in outcomes.notes]).astype(np.int64)
        return np.concatenate(
            [
                (~self.fast.holds(self.values(rows.start, rows.stop)) & forming).sum(axis=0)
                for rows, forming in self.pieces(forms)
            ]
        )

    def _closed_form(self, fast: Vectorised, values: Floats, nowhere: Bools) -> ByMethod:
        """Return what the closed form says of samples (n, k), also of values that no design can have."""
        forms, design = fast(values), self.design
        names, outcome, factor = (*forms.names, IMPOSSIBLE, _NO_PLACE), forms.outcome.astype(np.int16), forms.factor
        root = None if design.source is None else design.source.root
        for drawn, path in zip(values.T, self.samples.names, strict=False):  # the place of a crack fits
            field = field_in(type(design), root, path)
            if field is not None and not field.limits.turns:
                impossible = (drawn < field.limits.least) | (drawn > field.limits.most)
                outcome[impossible] = len(names) - 2
        outcome[fast.dilation(values)[1]] = len(names) - 2
        outcome[nowhere] = len(names) - 1
        factor[(outcome >= len(names) - 2) | (factor == 0.0)] = np.nan  # no strength at all: a status, no number
        return ByMethod(names, outcome, factor)
