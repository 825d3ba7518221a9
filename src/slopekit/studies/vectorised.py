"""The closed forms of a design over arrays of samples: which of their arguments follow which column of the samples.

The arguments are found by reading the design at some samples: each has to be the same at all of them, or a straight
line in one column. Where one is neither (a force whose direction scatters, a density times a gravity that both
scatter), there is no such evaluator, and the samples are read one by one.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.arrays import Floats
from slopekit.design.common import Design
from slopekit.design.files import with_values
from slopekit.errors import DesignError
from slopekit.kinds import kind_of
from slopekit.kinds.closed_forms import Arguments, ClosedForms, OnArrays

#: A design's values at a sample: what `with_values` takes.
ValuesAt = Callable[[int], Mapping[str, object]]
_EXACT = 1e-12
_PROBES, _FEWEST = 24, 6


@dataclass(frozen=True, slots=True)
class Line:
    """An argument that follows one column of the samples: constant + slope x."""

    column: int
    constant: float
    slope: float

    def at(self, values: Floats) -> Floats:
        """The argument at samples (n, k)."""
        x: Floats = values[:, self.column]
        return x if (self.constant, self.slope) == (0.0, 1.0) else self.constant + self.slope * x


@dataclass(frozen=True, slots=True)
class Vectorised:
    """A closed form over samples (n, k): arguments that are the same for all, and those that follow a column."""

    on_arrays: OnArrays[Any]
    fixed: Arguments
    lines: Mapping[str, Line]

    def __call__(self, values: Floats) -> ClosedForms:
        """Outcome and factor of every sample."""
        arguments = self.fixed | {name: line.at(values) for name, line in self.lines.items()}
        found = self.on_arrays.closed_forms(arguments, ())
        if len(found.factor) == len(values):
            return found
        # nothing that scatters is an argument: all samples are alike
        return ClosedForms(found.names, np.repeat(found.outcome, len(values)), np.repeat(found.factor, len(values)))


def vectorised(design: Design, values: Floats, values_at: ValuesAt) -> Vectorised | None:
    """The evaluator of a design over its samples, None where there is none.

    Parameters
    ----------
    values : (n, k) samples; values_at : the values of the design's file at one of them, by its number
    """
    kind = kind_of(design)
    on_arrays = kind.on_arrays
    if on_arrays is None or any(bolt.acts == "passive" for bolt in design.bolts):
        return None
    if any(strength.law for strength in kind.strengths(design)):
        # strength is curved: the closed form is asked again and again then, sample by sample
        return None
    rows, read = [], []
    for row in _probes(values):
        try:
            changed = with_values(design, values_at(row))
        except DesignError:
            continue  # a sample that no design can have
        rows.append(row)
        read.append(on_arrays.arguments(changed))
    if len(rows) < min(_FEWEST, len(values)):
        return None
    fixed: Arguments = {}
    lines: dict[str, Line] = {}
    for name, first in read[0].items():
        found = [arguments[name] for arguments in read]
        if all(value == first for value in found):
            fixed[name] = first
            continue
        line = None if None in found else _line(values[rows], np.array(found, dtype=np.float64))
        if line is None:
            return None
        lines[name] = line
    return Vectorised(on_arrays, fixed, lines)


def _probes(values: Floats) -> Iterable[int]:
    """Samples to look at: the first ones, and the extremes of each column, where a line would first show its bend."""
    extremes = [*values.argmin(axis=0).tolist(), *values.argmax(axis=0).tolist()]
    return dict.fromkeys([*range(min(_PROBES, len(values))), *extremes])


def _line(values: Floats, found: Floats) -> Line | None:
    """The column (m, k) that an argument (m,) follows, exactly or in a straight line."""
    for column, x in enumerate(values.T):
        if np.array_equal(x, found):
            return Line(column, 0.0, 1.0)
    for column, x in enumerate(values.T):
        low, high = int(x.argmin()), int(x.argmax())
        if x[low] == x[high]:
            continue
        slope = float((found[high] - found[low]) / (x[high] - x[low]))
        constant = float(found[low] - slope * x[low])
        if abs(constant) <= _EXACT * float(np.abs(found).max()):
            constant, slope = 0.0, float(found[high] / x[high]) if x[high] else slope
        if np.allclose(constant + slope * x, found, rtol=_EXACT, atol=_EXACT * float(np.abs(found).max())):
            return Line(column, constant, slope)
    return None
