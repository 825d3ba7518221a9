"""Samples of a design as rows of columns, judged piece by piece by both methods, all rows of a piece at once."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.design.common import Design
from slopekit.design.fields import field_in
from slopekit.studies.outcomes import COMPARED, ByMethod, agreement
from slopekit.studies.prob.bolts import holding
from slopekit.studies.prob.cracks import crack_search, placed
from slopekit.studies.prob.judged import IMPOSSIBLE
from slopekit.studies.prob.sampling import Samples, settings_of
from slopekit.studies.prob.vectorised import Vectorised, vectorised
from slopekit.studies.running import Record

_FIRST = 8  # samples that are read, beside those at the ends of every column


class SampleRows(Sequence[Mapping[str, object]]):
    """Samples of a design, and how they are taken; one of them is its values, as `with_values` takes them.

    Attributes
    ----------
    samples : as drawn; design : with its crack at a place, where `search` finds one for each sample
    fast : takes many at once, None where they are read one by one
    """

    def __init__(self, design: Design, samples: Samples) -> None:
        ends = [piece[[*piece.argmin(axis=0), *piece.argmax(axis=0)]] for piece in samples.pieces()]
        values = np.concatenate([samples.rows(0, min(_FIRST, samples.count)), *ends])
        self.samples, self.design, self.search = samples, design, None
        search = crack_search(design, values)
        if search is not None:
            self.design, self.search = search
            values = placed(self.search, values)[0]
        variables = self.design.variables
        self.fast = vectorised(self.design, values, lambda row: settings_of(variables, values[row]))

    def __len__(self) -> int:
        return self.samples.count

    def __getitem__(self, row: Any) -> Any:
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

    def without_force(self, rows: slice, forms: Bools) -> Any:
        """How many bolts do not hold the block of some samples (m,), 0 where none forms."""
        if self.fast is None:
            holds = holding(self.design, [self[row] for row in range(rows.start, rows.stop)])
        else:
            holds = self.fast.holds(self.values(rows.start, rows.stop))
        return (~holds & forms).sum(axis=0)


def judged_piece(rows: SampleRows, pre_ie: bool, piece: tuple[int, int]) -> Record:
    """Return what both methods say of a piece of samples, from its first to its end, or the closed form alone.

    The record has `closed_form` and `limit` as `ByMethod.record` names them, `also` where acceptance is held against
    more, `nowhere`, and what `Outcomes` has, by its names.
    """
    fast, (values, nowhere) = rows.fast, rows.placed(*piece)
    assert fast is not None
    record: dict[str, Any] = {"nowhere": nowhere}
    closed, also = _closed_form(rows, fast, values), fast.also(values)
    if also is not None:
        record |= ByMethod(also.names, also.outcome.astype(np.int16), also.factor).record("also")
    if pre_ie:
        forming = np.flatnonzero(~closed.among("E", IMPOSSIBLE))
        words = np.array(closed.names, dtype=object)[closed.outcome]
        factor, forces = np.full((2, len(words)), np.nan)
        if len(forming):
            limits = fast.limits(values[forming])
            words[forming], factor[forming], forces[forming] = limits.status, limits.limit, limits.forces
        limit, closed = ByMethod.of(words.tolist(), factor), closed.refused(words)
        outcomes = agreement(limit, forces, closed, rows.design.analysis.agree_within)
        record |= limit.record("limit") | {name: getattr(outcomes, name) for name in COMPARED}
    return record | closed.record("closed_form")


def _closed_form(rows: SampleRows, fast: Vectorised, values: Floats) -> ByMethod:
    """Return what the closed form says of samples (n, k), also of values that no design can have."""
    forms, design = fast(values), rows.design
    names, outcome, factor = (*forms.names, IMPOSSIBLE), forms.outcome.astype(np.int16), forms.factor
    root = None if design.source is None else design.source.root
    for drawn, path in zip(values.T, rows.samples.names, strict=False):  # the place of a crack fits
        field = field_in(type(design), root, path)
        if field is not None and not field.limits.turns:
            impossible = (drawn < field.limits.least) | (drawn > field.limits.most)
            outcome[impossible], factor[impossible] = len(names) - 1, np.nan
    factor[factor == 0.0] = np.nan  # no strength at all: a status, no number (UX.md rule 2)
    return ByMethod(names, outcome, factor)
