"""Samples of a design as rows of a study: each row is the design with the values drawn for one sample."""

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
from slopekit.studies.evaluation.vectorised import DesignRows, vectorised
from slopekit.studies.outcomes import UNJUDGED, ByMethod, Outcomes
from slopekit.studies.points import WITHOUT_FORCE, Point
from slopekit.studies.prob.sampling import Samples, settings_of
from slopekit.studies.prob.verdicts import IMPOSSIBLE

_TRIAL_ROWS = 8  # samples that are read, beside those at the ends of every column


class SampleRows(Rows):
    """Samples of a design, evaluated on arrays where its kind allows that, else design by design.

    Parameters
    ----------
    samples : the drawn values

    Attributes
    ----------
    columns : evaluates all samples on arrays, None where each is read as a design
    """

    def __init__(self, design: Design, samples: Samples) -> None:
        super().__init__(design, (), True)
        ends = [piece[[*piece.argmin(axis=0), *piece.argmax(axis=0)]] for piece in samples.pieces()]
        values = np.unique(
            np.concatenate([samples.rows(0, min(_TRIAL_ROWS, samples.count)), *ends]), axis=0
        )
        self.samples = samples
        self.columns = vectorised(
            design, values, lambda row: settings_of(design.variables, values[row])
        )
        self.is_on_arrays = self.columns is not None

    def __len__(self) -> int:
        return self.samples.count

    def inputs(self) -> list[object]:
        design, samples = self.design, self.samples
        sample_inputs = [
            repr(design.variables),
            repr(design.correlation),
            samples.count,
            samples.method,
            samples.seed,
        ]
        return [*super().inputs(), *sample_inputs]

    def piece(self, start: int, stop: int) -> tuple[Rows, int, int]:
        return self, start, stop  # each worker draws its own samples

    def at_once(self, start: int, stop: int, pre_ie: bool) -> tuple[Ints, Outcomes | None]:
        if self.columns is None:
            return np.arange(0), None
        rows = self.columns.rows(self.samples.rows(start, stop))
        return np.arange(stop - start), outcomes_on_arrays(rows, self._closed_form(rows), pre_ie)[0]

    def point(self, row: int, pre_ie: bool) -> Point:
        point = super().point(row, pre_ie)
        notes = (WITHOUT_FORCE,) * (
            WITHOUT_FORCE in point.notes
        )  # the design at its means has the other notices
        return (
            point
            if point.factors is None
            else replace(point, factors=replace(point.factors, notes=notes))
        )

    def whole(self, row: int, point: Point) -> WithoutBasal | None:
        if (
            point.factors is not None
            or not point.code.startswith(("E2", "E44"))
            or point.code in UNJUDGED
        ):
            return point.also
        try:
            sample = with_values(self.design, self.settings_at(row))
            return kind_of(sample).without_basal(sample)
        except SlopekitError:
            return None

    def settings_at(self, row: int) -> dict[str, float | str]:
        return self.samples.settings(row)

    def sizes(self, start: int, stop: int, forms: Bools) -> dict[str, Floats]:
        """Return the block sizes of samples `start` to `stop` by key, nan without a block; empty where not known.

        Parameters
        ----------
        forms : (stop - start,) whether a sample forms a block
        """
        return (
            {}
            if self.columns is None
            else self.columns.rows(self.samples.rows(start, stop)).sizes(forms)
        )

    def without_force(self, outcomes: Outcomes, forms: Bools) -> Ints:
        """Return the number of bolts (n,) that give no force to the block of each sample, 0 without a block.

        Samples that are read one by one have 1 for any number of bolts.
        """
        if self.columns is None:
            return (forms & [WITHOUT_FORCE in notes for notes in outcomes.notes]).astype(np.int64)
        pieces = [(~self.columns.rows(piece).holds).sum(axis=0) for piece in self.samples.pieces()]
        return np.where(forms, np.concatenate(pieces), 0)

    def _closed_form(self, rows: DesignRows) -> ByMethod:
        """Return outcomes and factors of the closed form; values that no design can have are `IMPOSSIBLE`."""
        closed, design = rows.closed_form, self.design
        names, outcome, impossible = (
            (*closed.names, IMPOSSIBLE),
            closed.outcome,
            rows.dilation()[1].copy(),
        )
        root = None if design.source is None else design.source.root
        for column, path in zip(
            rows.values.T, self.samples.names, strict=False
        ):  # the distance of a crack is not checked
            field = field_in(type(design), root, path)
            if field is not None and not field.turns:
                impossible |= (column < field.least) | (column > field.most)
        outcome = np.where(impossible, len(names) - 1, outcome).astype(np.int16)
        return ByMethod(names, outcome, np.where(impossible, np.nan, closed.factor))
