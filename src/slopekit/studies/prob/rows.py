"""Samples of a design as rows of columns, judged piece by piece by both methods, all rows of a piece at once."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.design.common import Design
from slopekit.design.fields import field_in
from slopekit.studies.outcomes import ByMethod, agreement
from slopekit.studies.prob.bolts import holding
from slopekit.studies.prob.cracks import CrackSearch, crack_search
from slopekit.studies.prob.judged import IMPOSSIBLE
from slopekit.studies.prob.sampling import Samples, settings_of
from slopekit.studies.prob.vectorised import Vectorised, vectorised
from slopekit.studies.running import Record

_FIRST = 8  # samples that are read, beside those at the ends of every column


@dataclass(frozen=True)
class SampleRows(Sequence[Mapping[str, object]]):
    """Samples of a design, and how they are taken; one of them is its values, as `with_values` takes them.

    Attributes
    ----------
    samples : as drawn; design : with its crack at a place, where `search` finds one for each sample
    places : (n,) of the crack, once they are known
    fast : takes many at once, None where they are read one by one
    """

    samples: Samples
    design: Design
    search: CrackSearch | None
    fast: Vectorised | None
    places: Floats | None = None

    def __len__(self) -> int:
        return self.samples.count

    def __getitem__(self, row: Any) -> Any:
        return settings_of(self.design.variables, self.values(row, row + 1)[0])

    def values(self, start: int, stop: int) -> Floats:
        """The values of some samples, with the place of their crack (stop - start, k)."""
        drawn = self.samples.rows(start, stop)
        if self.places is not None:
            return np.column_stack([drawn, self.places[start:stop]])
        return drawn if self.search is None else self.search(drawn)[0]

    def found(self) -> tuple["SampleRows", Bools]:
        """The same with the places of its cracks known, and the samples (n,) in which no place gives a factor."""
        if self.search is None:
            return self, np.zeros(len(self), dtype=bool)
        placed, nowhere = zip(*(self.search(piece) for piece in self.samples.pieces()), strict=True)
        return replace(self, places=np.concatenate([values[:, -1] for values in placed])), np.concatenate(nowhere)

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


def rows_of(design: Design, samples: Samples) -> SampleRows:
    """Return how the samples of a design are taken: some of them are read to know whether all can be at once."""
    at = _extremes(samples)
    values = samples.at(np.array(at))
    search = crack_search(design, values)
    if search is not None:
        design, values = search.design, search(values)[0]
    fast = vectorised(design, values, lambda row: settings_of(design.variables, values[row]))
    return SampleRows(samples, design, search, fast)


def _extremes(samples: Samples) -> list[int]:
    """Return the first samples and those with the least and the most of every column, in rising order."""
    rows, start = set(range(min(_FIRST, samples.count))), 0
    least, most = np.full((2, len(samples.names)), np.inf)
    lowest, highest = np.zeros((2, len(samples.names)), dtype=np.int64)
    for values in samples.pieces():
        for best, place, signed in ((least, lowest, values), (most, highest, -values)):
            row = signed.argmin(axis=0)
            new = signed.min(axis=0)
            place[new < best], best[new < best] = row[new < best] + start, new[new < best]
        start += len(values)
    return sorted(rows | set(lowest.tolist()) | set(highest.tolist()))


@dataclass(frozen=True)
class PieceJudge:
    """Says of a piece of samples, from its first to its end, what both methods do, or the closed form alone.

    The record has `closed_form` and `limit` as `ByMethod.record` names them, `also` where acceptance is held against
    more, `place` and `nowhere` where a crack is looked for, and what `Outcomes` has, by its names.
    """

    rows: SampleRows
    pre_ie: bool

    def __call__(self, piece: tuple[int, int]) -> Record:
        rows, fast, record = self.rows, self.rows.fast, dict[str, Any]()
        assert fast is not None
        values = rows.samples.rows(*piece)
        if rows.search is not None:
            values, record["nowhere"] = rows.search(values)
            record["place"] = values[:, -1]
        closed, also = self._closed_form(fast, values), fast.also(values)
        if also is not None:
            record |= ByMethod(also.names, also.outcome.astype(np.int16), also.factor).record("also")
        if self.pre_ie:
            forming = np.flatnonzero(~closed.among("E", IMPOSSIBLE))
            words = np.array(closed.names, dtype=object)[closed.outcome]
            factor, forces = np.full((2, len(words)), np.nan)
            if len(forming):
                limits = fast.limits(values[forming])
                words[forming], factor[forming], forces[forming] = limits.status, limits.limit, limits.forces
            limit, closed = ByMethod.of(words.tolist(), factor), closed.refused(words)
            outcomes = agreement(limit, forces, closed, rows.design.analysis.agree_within)
            record |= limit.record("limit")
            record |= {name: getattr(outcomes, name) for name in ("difference", "agree", "moments_govern")}
        return record | closed.record("closed_form")

    def _closed_form(self, fast: Vectorised, values: Floats) -> ByMethod:
        forms = fast(values)
        names, outcome, factor = (*forms.names, IMPOSSIBLE), forms.outcome.astype(np.int16), forms.factor
        impossible = _impossible(self.rows.design, self.rows.samples.names, values)
        outcome[impossible], factor[impossible] = len(names) - 1, np.nan
        factor[factor == 0.0] = np.nan  # no strength at all: a status, no number (UX.md rule 2)
        return ByMethod(names, outcome, factor)


def _impossible(design: Design, names: Sequence[str], values: Floats) -> Bools:
    """Samples (n,) with a value that no design can have."""
    impossible = np.zeros(len(values), dtype=bool)
    root = None if design.source is None else design.source.root
    for drawn, path in zip(values.T, names, strict=False):  # the place of a crack fits
        field = field_in(type(design), root, path)
        if field is not None and not field.limits.turns:
            impossible |= (drawn < field.limits.least) | (drawn > field.limits.most)
    return impossible
