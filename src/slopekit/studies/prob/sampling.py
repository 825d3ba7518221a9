"""Samples of what scatters in a design: Monte Carlo or Latin hypercube, correlated by a Gaussian copula.

They are drawn in blocks, each with random numbers of its own.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Literal, TypeAlias

import numpy as np

from slopekit.core.arrays import Floats, NDArray
from slopekit.core.orientation import Line, Plane
from slopekit.design.common import Pair
from slopekit.design.reading.nodes import as_text
from slopekit.design.scatter.distributions import Angles, Distribution, Fisher, Variable
from slopekit.studies.marginals import Marginal, marginal, standard_normal
from slopekit.studies.prob import sources
from slopekit.studies.prob.sources import fisher, folded_lines, folded_planes

Method: TypeAlias = Literal["monte-carlo", "latin-hypercube"]
METHODS: tuple[Method, ...] = ("monte-carlo", "latin-hypercube")
#: Samples of a Monte Carlo block, which is the most of a Latin hypercube.
BLOCK = 8192
REPLICATES, FEWEST_IN_REPLICATE, MOST_REPLICATES = 16, 8, 32767
_PIECE = 4096  # samples whose angles stay in the innermost cache


@dataclass(frozen=True)
class Samples:
    """Values drawn for what scatters.

    Attributes
    ----------
    variables : that were drawn
    names : of the columns, k of them: the path of a number; two of an orientation, `<path>.dip` and
        `<path>.dip_direction` (of a line `<path>.trend` and `<path>.plunge`), also where only one of them scatters
    values : (n, k), each column contiguous, read-only
    replicate : (n,) int16, which of the independent replicates each sample belongs to; Monte Carlo: all 0
    """

    variables: tuple[Variable, ...]
    names: tuple[str, ...]
    values: Floats
    replicate: NDArray[np.int16]

    def settings(self, row: int) -> dict[str, float | str]:
        """A sample as values by dotted path, as `slopekit.design.reading.files.with_values` takes them."""
        by_path: dict[str, float | str] = {}
        column = 0
        for variable in self.variables:
            of, first = variable.of, float(self.values[row, column])
            if of is None:
                by_path[variable.path] = first
            else:
                second = float(self.values[row, column + 1])
                by_path[variable.path] = as_text(Plane(first, second) if of == "plane" else Line(first, second))
            column += len(variable.columns)
        return by_path


def samples(
    variables: Iterable[Variable], correlation: Iterable[Pair], n: int, seed: int, method: Method = "monte-carlo"
) -> Samples:
    """All samples of what scatters.

    The same seed gives the same numbers. With Monte Carlo a longer run begins with the samples of a shorter one.

    >>> friction = Variable("strength.weak.phi", Distribution("normal", {"mean": 20.0, "sd": 2.0}, "angle"))
    >>> drawn = samples([friction], (), 10000, 1)
    >>> drawn.values.shape, round(float(drawn.values.mean()), 1), round(float(drawn.values.std()), 1)
    ((10000, 1), 20.0, 2.0)

    Parameters
    ----------
    correlation : rank correlations between coordinates of the variables (`Variable.coordinates`), as they were read:
        of these alone, and without contradictions
    n : samples, at least 1. Latin hypercubes divide them among 16 replicates, fewer below 128 samples, more where a
        replicate would pass 8192
    seed : whole number from 0
    """
    made, pairs = tuple(variables), tuple(correlation)
    coordinates = [name for variable in made for name in variable.coordinates]
    marginals = [one for variable in made for one in _marginals(variable)]
    source = sources.source(method, coordinates, pairs, seed)
    names = tuple(name for variable in made for name in variable.columns)
    columns, replicate = np.empty((len(names), n)), np.zeros(n, dtype=np.int16)
    for block, (start, stop) in enumerate(pairwise(ends_of_blocks(n, method))):
        # a block of Monte Carlo is drawn whole: a longer run begins with a shorter one
        column = source(block, BLOCK if method == "monte-carlo" else stop - start)
        _fill(columns[:, start:stop], made, (column(k, own)[: stop - start] for k, own in enumerate(marginals)))
        replicate[start:stop] = 0 if method == "monte-carlo" else block
    columns.setflags(write=False)
    replicate.setflags(write=False)
    return Samples(made, names, columns.T, replicate)


def ends_of_blocks(n: int, method: Method) -> list[int]:
    """The ends of the blocks that are drawn each by itself, from 0: Monte Carlo's 8192 samples, or replicates.

    >>> ends_of_blocks(20000, "monte-carlo"), ends_of_blocks(100, "latin-hypercube")[-3:]
    ([0, 8192, 16384, 20000], [84, 92, 100])
    """
    if method == "monte-carlo":
        return [*range(0, n, BLOCK), n]
    replicates = max(min(REPLICATES, n // FEWEST_IN_REPLICATE), min(-(-n // BLOCK), MOST_REPLICATES), 1)
    size, larger = divmod(n, replicates)
    return [block * size + min(block, larger) for block in range(replicates + 1)]


def _marginals(variable: Variable) -> Sequence[Marginal]:
    """Of the coordinates of a variable."""
    own = variable.distribution
    if isinstance(own, Distribution):
        return [marginal(own)]
    if isinstance(own, Fisher):
        return [standard_normal(), standard_normal()]
    return [marginal(angle) for angle in (own.steep, own.direction) if isinstance(angle, Distribution)]


def _fill(columns: Floats, variables: Iterable[Variable], drawn: Iterator[Floats]) -> None:
    """Columns (k, count) of a block, from what is drawn of each coordinate."""
    count, k = columns.shape[1], 0
    for variable in variables:
        own = variable.distribution
        if isinstance(own, Distribution):
            columns[k] = next(drawn)
        else:
            steep, direction = (k, k + 1) if variable.of == "plane" else (k + 1, k)
            turn, parts = _turning(own)
            first, second = (next(drawn) if part is None else np.full(count, part) for part in parts)
            for begin in range(0, count, _PIECE):
                piece = slice(begin, begin + _PIECE)
                columns[steep, piece], columns[direction, piece] = turn(first[piece], second[piece])
        k += len(variable.columns)


def _turning(own: Fisher | Angles) -> tuple[Callable[[Floats, Floats], tuple[Floats, Floats]], list[float | None]]:
    """From what is drawn of an orientation to its angles, and those of the two that are not drawn."""
    if isinstance(own, Fisher):
        return partial(fisher, own.mean, own.k), [None, None]
    fixed = [angle if isinstance(angle, float) else None for angle in (own.steep, own.direction)]
    return (folded_planes if own.of == "plane" else folded_lines), fixed
