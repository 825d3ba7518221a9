"""Factors of safety of a design at values of one of its numbers, by either method, on arrays where possible."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeAlias

import numpy as np

from slopekit.core.errors import Notice
from slopekit.design.common import Design
from slopekit.design.parts import Force
from slopekit.kinds import kind_of
from slopekit.studies.evaluation.columns import array_columns, points_on_arrays
from slopekit.studies.evaluation.vectorised import Vectorised
from slopekit.studies.keys import Key, values_of
from slopekit.studies.points import Method, Point, factor_at, point_of, status_of
from slopekit.studies.protocol import Advance
from slopekit.studies.roots import RootSearch, Sample, level_at, refined_grid
from slopekit.studies.running import ALONE, ExecutorOptions, run_all

#: Number of even places and relative distance of the places nearest to the present value (`refined_grid`): the grid
#: of the closed form, and the coarse one where PRE-IE alone answers.
FINE_GRID, COARSE_GRID = (33, 2e-3), (9, 0.2)
_LOAD_KEYS = re.compile(
    r"loads\.seismic\.k|loads\.forces\.\d+\.force"
)  # loads along which the equilibrium of many blocks can be traced
NODE_PAIR_STEP = 2e-3
"""Largest step of PRE-IE's factor from other node pairs, which is no jump (relative)."""
#: Options of `RootSearch` for PRE-IE beside the closed form, and for PRE-IE alone, whose factor takes long.
_PRE_IE_PRECISION = {
    "resolution": 1e-10,
    "near": 1e-11,
    "level_tolerance": NODE_PAIR_STEP,
    "jump": 1e-5,
    "edge": 1e-3,
}
_PRE_IE_ONLY_PRECISION = {
    "resolution": 1e-8,
    "near": 2e-8,
    "level_tolerance": NODE_PAIR_STEP,
    "jump": 1e-5,
    "edge": 1e-4,
    "reach": math.inf,
}
_SAME_LEVEL = 1e-6  # largest difference of level between arrays and a run of the same design
Samples: TypeAlias = list[Sample[Point]]


def level_of(factor: float, target: float) -> float:
    """Return how far a factor lies above a target: -1 at 0, 0 at the target, 1 at infinity; smooth in between.

    >>> level_of(3.0, 1.0), level_of(math.inf, 1.0)
    (0.5, 1.0)
    """
    return 1.0 if math.isinf(factor) else (factor - target) / (factor + target)


def level_sample(value: float, point: Point, method: Method, target: float) -> Sample[Point]:
    """Return the sample of a root search at a value: the level of the factor by one method above a target."""
    factor = factor_at(point, method)
    return Sample(
        value, None if factor is None else level_of(factor, target), status_of(point, method), point
    )


@dataclass(frozen=True)
class FactorRequest:
    """The search for the value of one number of a design that gives a target factor, and the points evaluated so far.

    `points` holds the points analysed one by one with both methods; `columns` evaluates values on arrays, None where
    the kind of design has none. `forces` act on the design beside those of its file.
    """

    design: Design
    key: Key
    low: float
    high: float
    target: float
    crew: ExecutorOptions
    advance: Advance
    points: dict[float, Point] = field(default_factory=dict)
    columns: Vectorised | None = None
    forces: tuple[Force, ...] = ()

    def search(self, method: Method) -> RootSearch[Point]:
        """Return a new root search for the target by one method, without samples."""
        precision = (
            {}
            if method == "closed_form"
            else _PRE_IE_PRECISION
            if self.design.HAS_CLOSED_FORM
            else _PRE_IE_ONLY_PRECISION
        )
        return RootSearch(partial(self.samples, method), self.high - self.low, **precision)

    @property
    def drives_blocks(self) -> bool:
        """Whether the number is a load on many blocks, along which their equilibrium can be traced."""
        return _LOAD_KEYS.fullmatch(self.key.path) is not None and kind_of(self.design).MOVES_MANY

    @property
    def on_arrays(self) -> Vectorised | None:
        """The evaluation of all values on arrays, None where the kind of the design has none."""
        grid = np.array(self.grid(*FINE_GRID))[:, None]
        return array_columns(self.design, [self.key], grid)

    def samples(self, method: Method, values: Sequence[float]) -> Samples:
        """Return the samples of a method at values: all at once on arrays, else as many at a time as the crew is."""
        pre_ie, evaluated = method == "pre_ie", dict[float, Point]()
        if self.columns is not None:
            columns = replace(self.columns, forces=self.forces)
            points = points_on_arrays(columns, [self.key], np.array(values)[:, None], pre_ie)
            evaluated = {
                value: point
                for value, point in zip(values, points, strict=True)
                if point is not None
            }
            self.advance(1)
        remaining = [value for value in values if value not in evaluated]
        tasks = [values_of(self.design, [self.key], [value]) for value in remaining]
        crew = self.crew if len(tasks) > 1 and pre_ie else ALONE
        analyse_point = partial(
            point_of, self.design, pre_ie=pre_ie, adjust=partial(with_forces, self.forces)
        )
        analysed = dict(
            zip(
                remaining,
                run_all(analyse_point, tasks, crew, advance=self.advance, at_once=1),
                strict=True,
            )
        )
        if pre_ie:
            self.points.update(analysed)
        evaluated |= analysed
        return [level_sample(value, evaluated[value], method, self.target) for value in values]

    def both(self, value: float) -> Point:
        """Return the point at a value by both methods, analysed one by one, not on arrays."""
        if value not in self.points:
            replace(self, columns=None).samples("pre_ie", [value])
        return self.points[value]

    def confirms(self, method: Method, search: RootSearch[Point]) -> bool:
        """Return whether runs of single designs confirm the levels of a search at its crossings and its extremes."""
        by_level = sorted(search.defined, key=level_at)
        samples = [
            *by_level[:1],
            *by_level[-1:],
            *(crossing.best for crossing in search.crossings()),
        ]
        analysed = [
            level_sample(sample.place, self.both(sample.place), method, self.target)
            for sample in samples
        ]
        return all(
            abs((sample.level or 0.0) - (check.level or 0.0)) <= _SAME_LEVEL
            for sample, check in zip(samples, analysed, strict=True)
        )

    def current_point(self) -> Point:
        """Return the point of the design as it is."""
        point = None if self.key.value is None else self.points.get(self.key.value)
        if point is not None and factor_at(point, "pre_ie") is not None:
            return point  # else the limit on the work may have ended it too early
        return point_of(self.design, {})

    def grid(self, even: int, close: float) -> list[float]:
        """Return values between the two ends, as `refined_grid` spaces them."""
        return refined_grid(self.low, self.high, self.key.value, even=even, close=close)


def with_forces(forces: tuple[Force, ...], design: Design) -> Design:
    """Return a design with further forces beside those of its file."""
    return replace(design, forces=(*design.forces, *forces))


def factor_notices(request: FactorRequest, value: float, point: Point) -> Iterator[Notice]:
    """Yield the notices of a run at a value; for a load the value is named, as these notices speak of loads too."""
    for notice in point.notes:
        if _LOAD_KEYS.fullmatch(request.key.path):
            place = f"of the factor of safety at {request.key.path} = {request.key.value_text(value, 4)}: "
            notice = Notice(notice.code, place + notice.message)
        yield notice
