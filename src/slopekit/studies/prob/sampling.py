"""Samples of the random variables of a design: Monte Carlo or Latin hypercube, correlated by a Gaussian copula.

Samples are drawn in blocks on demand, each block from a random stream of its own.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from itertools import count, pairwise
from typing import Literal, TypeAlias

import numpy as np

from slopekit.core.arrays import Floats, Ints, NDArray
from slopekit.core.orientation import Line, Plane
from slopekit.design.common import Pair
from slopekit.design.reading.nodes import as_text
from slopekit.design.scatter.distributions import Distribution, Fisher, Variable
from slopekit.studies.marginals import Marginal, marginal, standard_normal
from slopekit.studies.prob import sources
from slopekit.studies.prob.sources import fisher, folded_lines, folded_planes

Method: TypeAlias = Literal["monte-carlo", "latin-hypercube"]
METHODS: tuple[Method, ...] = ("monte-carlo", "latin-hypercube")
#: Samples of a Monte Carlo block, which is the most of a Latin hypercube.
BLOCK = 8192
REPLICATES, MIN_SAMPLES_PER_REPLICATE, MAX_REPLICATES = 16, 8, 32767
_CACHED_BLOCKS = 16  # blocks: of no more than 131,072 samples none is drawn twice
_PIECE = 4096  # samples whose angles stay in the innermost cache


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of random variables, drawn anew on each access: only the source of their random numbers is stored.

    Attributes
    ----------
    variables : the random variables
    names : of the columns, k of them: the path of a number; two of an orientation, `<path>.dip` and
        `<path>.dip_direction` (of a line `<path>.trend` and `<path>.plunge`), also where only one of them scatters
    count : n, number of samples; source : of the numbers of each block, by its number and size; seed : of the source
    """

    variables: tuple[Variable, ...]
    names: tuple[str, ...]
    count: int
    method: Method
    source: sources.Source
    seed: int

    def rows(self, start: int, stop: int) -> Floats:
        """Return the values of samples `start` to `stop`, (stop - start, k), each column contiguous, read-only."""
        ends = self.ends
        blocks = range(bisect_right(ends, start) - 1, bisect_left(ends, stop))
        block_columns = [
            _block_columns(self, block)[:, max(start - ends[block], 0) : stop - ends[block]]
            for block in blocks
        ]
        columns = (
            block_columns[0] if len(block_columns) == 1 else np.concatenate(block_columns, axis=1)
        )
        columns.setflags(write=False)
        return columns.T

    def pieces(self) -> Iterator[Floats]:
        """Yield the values of all samples, block by block."""
        return (self.rows(*block) for block in pairwise(self.ends))

    def select(self, rows: Ints) -> Floats:
        """Return the values (m, k) of the samples whose numbers `rows` (m,) are in rising order."""
        spans = zip(pairwise(self.ends), pairwise(np.searchsorted(rows, self.ends)), strict=True)
        blocks = (
            self.rows(start, stop)[rows[first:end] - start]
            for (start, stop), (first, end) in spans
            if first < end
        )
        return np.concatenate(list(blocks))

    @cached_property
    def ends(self) -> Sequence[int]:
        """The ends of the blocks of samples, from 0."""
        return ends_of_blocks(self.count, self.method)

    @cached_property
    def values(self) -> Floats:
        """The values of all samples (n, k), each column contiguous, read-only."""
        return self.rows(0, self.count)

    @cached_property
    def replicate(self) -> NDArray[np.int16]:
        """Which of the independent replicates each sample belongs to (n,); Monte Carlo: all 0."""
        if self.method == "monte-carlo":
            return np.zeros(self.count, dtype=np.int16)
        return np.repeat(np.arange(len(self.ends) - 1, dtype=np.int16), np.diff(self.ends))

    def settings(self, row: int) -> dict[str, float | str]:
        """Return a sample as values by dotted path, as `slopekit.design.reading.files.with_values` takes them."""
        return settings_of(self.variables, self.rows(row, row + 1)[0])


def settings_of(variables: Iterable[Variable], values: Iterable[float]) -> dict[str, float | str]:
    """Return the values (k,) of the columns of variables by dotted path, as `with_values` takes them."""
    by_path, columns = dict[str, float | str](), map(float, values)
    for variable in variables:
        column_values = [next(columns) for _ in variable.columns]
        if variable.orientation_kind is not None:
            by_path[variable.path] = as_text(
                Plane(*column_values)
                if variable.orientation_kind == "plane"
                else Line(*column_values)
            )
        else:
            (by_path[variable.path],) = column_values
    return by_path


@lru_cache(_CACHED_BLOCKS)
def _block_columns(samples: Samples, block: int) -> Floats:
    """Draw the columns (k, count) of a block of samples."""
    size, k, coordinates = samples.ends[block + 1] - samples.ends[block], 0, count()
    columns = np.empty((len(samples.names), size))
    # a block of Monte Carlo is drawn whole: a longer run begins with a shorter one
    column = samples.source(block, BLOCK if samples.method == "monte-carlo" else size)
    for variable in samples.variables:
        coordinate_marginals, to_angles = _coordinate_marginals(variable)
        coordinate_values = [
            column(next(coordinates), distribution)[:size]
            if isinstance(distribution, Marginal)
            else np.full(size, distribution)
            for distribution in coordinate_marginals
        ]
        if to_angles is None:
            columns[k] = coordinate_values[0]
        else:
            steep, direction = (k, k + 1) if variable.orientation_kind == "plane" else (k + 1, k)
            for begin in range(0, size, _PIECE):
                piece = slice(begin, begin + _PIECE)
                columns[steep, piece], columns[direction, piece] = to_angles(
                    *(values[piece] for values in coordinate_values)
                )
        k += len(variable.columns)
    return columns


def _coordinate_marginals(
    variable: Variable,
) -> tuple[list[Marginal | float], Callable[..., tuple[Floats, Floats]] | None]:
    """Return the marginal of each coordinate of a variable (a number where fixed), and the map of two to angles."""
    distribution = variable.distribution
    if isinstance(distribution, Distribution):
        return [marginal(distribution)], None
    if isinstance(distribution, Fisher):
        return [standard_normal(), standard_normal()], partial(
            fisher, distribution.mean, distribution.k
        )
    angles = [
        marginal(angle) if isinstance(angle, Distribution) else angle
        for angle in (distribution.steep, distribution.direction)
    ]
    return angles, folded_planes if distribution.orientation_kind == "plane" else folded_lines


def samples(
    variables: Iterable[Variable],
    correlation: Iterable[Pair],
    n: int,
    seed: int,
    method: Method = "monte-carlo",
) -> Samples:
    """Return the samples of some random variables.

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
    drawn_variables = tuple(variables)
    coordinates = [name for variable in drawn_variables for name in variable.coordinates]
    source = sources.source(method, coordinates, tuple(correlation), seed)
    return Samples(
        drawn_variables,
        tuple(name for variable in drawn_variables for name in variable.columns),
        n,
        method,
        source,
        seed,
    )


def ends_of_blocks(n: int, method: Method) -> list[int]:
    """Return the ends of the blocks of n samples, from 0: Monte Carlo's 8192 samples, or Latin hypercube replicates.

    >>> ends_of_blocks(20000, "monte-carlo"), ends_of_blocks(100, "latin-hypercube")[-3:]
    ([0, 8192, 16384, 20000], [84, 92, 100])
    """
    if method == "monte-carlo":
        return [*range(0, n, BLOCK), n]
    replicates = max(
        min(REPLICATES, n // MIN_SAMPLES_PER_REPLICATE), min(-(-n // BLOCK), MAX_REPLICATES), 1
    )
    size, larger = divmod(n, replicates)
    return [block * size + min(block, larger) for block in range(replicates + 1)]
