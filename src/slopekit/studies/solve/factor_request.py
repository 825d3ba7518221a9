"""What the factor of a design is at values of one number, by either method: on arrays where the kind takes them."""

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
from slopekit.studies.roots import RootSearch, Sample, level_at, places
from slopekit.studies.running import ALONE, Crew, run_all

#: Places of the grid evenly over the range, and how near to the present value; where PRE-IE alone answers.
FINE, ROUGH = (33, 2e-3), (9, 0.2)
_LOAD = re.compile(r"loads\.seismic\.k|loads\.forces\.\d+\.force")  # what the path of many blocks may drive
SAME = 2e-3
"""A step that other node pairs make in the factor of PRE-IE: no jump."""
#: How finely PRE-IE is looked at, and where its factor takes long, as `RootSearch` has it.
_PRE_IE = {"resolution": 1e-10, "near": 1e-11, "same": SAME, "jump": 1e-5, "edge": 1e-3}
_ALONE = {"resolution": 1e-8, "near": 2e-8, "same": SAME, "jump": 1e-5, "edge": 1e-4, "reach": math.inf}
_SAME_LEVEL = 1e-6  # what arrays and a run make of the same design
Samples: TypeAlias = list[Sample[Point]]


def level_of(factor: float, target: float) -> float:
    """How far a factor lies above a target: -1 at 0, 0 at the target, 1 at infinity; smooth in between.

    >>> level_of(3.0, 1.0), level_of(math.inf, 1.0)
    (0.5, 1.0)
    """
    return 1.0 if math.isinf(factor) else (factor - target) / (factor + target)


def level_sample(at: float, point: Point, method: Method, target: float) -> Sample[Point]:
    """What a method says at a value, by the level of its factor above a target."""
    factor = factor_at(point, method)
    return Sample(at, None if factor is None else level_of(factor, target), status_of(point, method), point)


@dataclass(frozen=True)
class FactorRequest:
    """A number of a design between two values, the factor that is wanted, and what was found at values so far.

    `points` are those of designs of their own by both methods; `columns` take values on arrays, None where none do.
    `forces` act on the design beside those of its file.
    """

    design: Design
    key: Key
    low: float
    high: float
    target: float
    crew: Crew
    advance: Advance
    points: dict[float, Point] = field(default_factory=dict)
    columns: Vectorised | None = None
    forces: tuple[Force, ...] = ()

    def search(self, method: Method) -> RootSearch[Point]:
        """One by a method, none sampled yet."""
        precision = {} if method == "closed_form" else _PRE_IE if self.design.HAS_CLOSED_FORM else _ALONE
        return RootSearch(partial(self.samples, method), self.high - self.low, **precision)

    @property
    def drives_blocks(self) -> bool:
        """Whether it is a load on many blocks, which their path may drive."""
        return _LOAD.fullmatch(self.key.path) is not None and kind_of(self.design).MOVES_MANY

    @property
    def on_arrays(self) -> Vectorised | None:
        """The columns of its values, where the kind of the design takes them."""
        grid = np.array(self.grid(*FINE))[:, None]
        return array_columns(self.design, [self.key], grid)

    def samples(self, method: Method, values: Sequence[float]) -> Samples:
        """What a method says at values: all at once on arrays, else as many at a time as the crew is."""
        pre_ie, found = method == "pre_ie", dict[float, Point]()
        if self.columns is not None:
            columns = replace(self.columns, forces=self.forces)
            points = points_on_arrays(columns, [self.key], np.array(values)[:, None], pre_ie)
            found = {value: point for value, point in zip(values, points, strict=True) if point is not None}
            self.advance(1)
        rest = [value for value in values if value not in found]
        tasks = [values_of(self.design, [self.key], [value]) for value in rest]
        crew = self.crew if len(tasks) > 1 and pre_ie else ALONE
        work = partial(point_of, self.design, pre_ie=pre_ie, also=partial(under_forces, self.forces))
        alone = dict(zip(rest, run_all(work, tasks, crew, advance=self.advance, at_once=1), strict=True))
        if pre_ie:
            self.points.update(alone)
        found |= alone
        return [level_sample(value, found[value], method, self.target) for value in values]

    def both(self, value: float) -> Point:
        """What both methods say at a value, as a design of its own."""
        if value not in self.points:
            replace(self, columns=None).samples("pre_ie", [value])
        return self.points[value]

    def confirms(self, method: Method, search: RootSearch[Point]) -> bool:
        """Whether designs of their own say what a search has at its crossings, its least and its greatest."""
        by_level = sorted(search.defined, key=level_at)
        samples = [*by_level[:1], *by_level[-1:], *(crossing.best for crossing in search.crossings())]
        alone = [level_sample(sample.at, self.both(sample.at), method, self.target) for sample in samples]
        return all(
            abs((one.level or 0.0) - (other.level or 0.0)) <= _SAME_LEVEL
            for one, other in zip(samples, alone, strict=True)
        )

    def before(self) -> Point:
        """The design as it is."""
        known = None if self.key.value is None else self.points.get(self.key.value)
        if known is not None and factor_at(known, "pre_ie") is not None:
            return known  # else what was left of the work may have been too little
        return point_of(self.design, {})

    def grid(self, even: int, close: float) -> list[float]:
        """Values between the two, as `places` has them."""
        return places(self.low, self.high, self.key.value, even=even, close=close)


def under_forces(forces: tuple[Force, ...], design: Design) -> Design:
    """Return a design with more forces than those of its file."""
    return replace(design, forces=(*design.forces, *forces))


def factor_notices(asked: FactorRequest, value: float, there: Point) -> Iterator[Notice]:
    """What a run says of the factor at a value; of a load the value is named: a load's own numbers are loads."""
    for notice in there.notes:
        if _LOAD.fullmatch(asked.key.path):
            where = f"of the factor of safety at {asked.key.path} = {asked.key.shown(value, 4)}: "
            notice = Notice(notice.code, where + notice.message)
        yield notice
