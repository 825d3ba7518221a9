"""What the factor of a design is at values of one number, asked by either method, and what came of asking."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import groupby
from typing import TypeAlias

from slopekit.core.errors import Notice
from slopekit.design.common import Design
from slopekit.kinds import kind_of
from slopekit.studies.keys import Key, values_of
from slopekit.studies.points import UNSETTLED, Method, Point, factor_at, point_of, point_with, status_of
from slopekit.studies.protocol import Advance
from slopekit.studies.running import ALONE, Crew, run_all
from slopekit.studies.solve.roots import Crossing, RootSearch, Sample, near_by, places
from slopekit.studies.solve.solutions import ALIKE, NO_CONVERGENCE, Answers, SolvedValue, reason_of

_ROUGH = 9, 1, 1  # evenly over the range, closer to the present value, to a decade
_JUMP = 1e-5, 0.02  # so near to each other, levels that far apart are a jump: PRE-IE takes long beside one
#: Resolution of values, level that counts as zero, and what is a jump: where a closed form is beside, where a factor
#: takes long, and of a load on many blocks.
_QUICK, _SLOW, _IN_LOAD = (1e-10, 1e-11, _JUMP), (1e-8, 2e-8, _JUMP), (1e-7, 4e-7, (1e-4, 0.02))
_ONE_JUMP = 1e-5  # of a value: jumps so near to each other are one
_SLOW_EDGE = 1e-3
_LOAD = re.compile(r"loads\.seismic\.k|loads\.forces\.\d+\.force")  # what the path of many blocks may drive
SAME = 2e-3
"""A step that other node pairs make in the factor of PRE-IE: no jump."""
Samples: TypeAlias = list[Sample[Point]]


def level_of(factor: float, target: float) -> float:
    """How far a factor lies above a target: -1 at 0, 0 at the target, 1 at infinity; smooth in between.

    >>> level_of(3.0, 1.0), level_of(math.inf, 1.0)
    (0.5, 1.0)
    """
    return 1.0 if math.isinf(factor) else (factor - target) / (factor + target)


@dataclass(frozen=True)
class FactorRequest:
    """A number of a design between two values, the factor that is wanted, and what was found at values so far."""

    design: Design
    key: Key
    low: float
    high: float
    target: float
    crew: Crew
    advance: Advance
    points: dict[float, Point] = field(default_factory=dict)

    def search(self, method: Method, slow: bool = False) -> RootSearch[Point]:
        """One by a method, none sampled yet; `slow`: as finely as a factor that takes long is asked for."""
        sample, span = partial(self.samples, method), self.high - self.low
        if method == "closed_form":
            return RootSearch(sample, span)
        resolution, near, jump = _IN_LOAD if slow and self.drives_blocks else _SLOW if slow else _QUICK
        return RootSearch(sample, span, resolution=resolution, near=near, same=SAME, jump=jump)

    @property
    def drives_blocks(self) -> bool:
        """Whether it is a load on many blocks, which their path may drive."""
        return _LOAD.fullmatch(self.key.path) is not None and kind_of(self.design).at_load is not None

    def samples(self, method: Method, values: Sequence[float]) -> Samples:
        """What a method says at values, as many at a time as the crew is."""
        work = partial(point_with, self.design, method == "pre_ie", False)
        tasks = [values_of(self.design, [self.key], [value]) for value in values]
        crew = self.crew if len(tasks) > 1 and method == "pre_ie" else ALONE
        points = run_all(work, tasks, crew, advance=self.advance, at_once=1)
        sampled = []
        for value, point in zip(values, points, strict=True):
            if method == "pre_ie":
                self.points[value] = point
            factor = factor_at(point, method)
            level = None if factor is None else level_of(factor, self.target)
            sampled.append(Sample(value, level, status_of(point, method), point))
        return sampled

    def both(self, value: float) -> Point:
        """What both methods say at a value."""
        if value not in self.points:
            self.samples("pre_ie", [value])
        return self.points[value]

    def before(self) -> Point:
        """The design as it is."""
        known = None if self.key.value is None else self.points.get(self.key.value)
        if known is not None and factor_at(known, "pre_ie") is not None:
            return known  # else what was left of the work may have been too little
        return point_of(self.design, {})

    def grid(self, even: int, close: int, each_decade: float) -> list[float]:
        """Values between the two: evenly, closer to the present one, and to a decade."""
        return places(self.low, self.high, self.key.value, even=even, close=close, each_decade=each_decade,
                      around_zero=self.key.role == "coordinate")  # fmt: skip


def runs_of(samples: Samples, kind: Callable[[Sample[Point]], object]) -> Iterator[Samples]:
    """Neighbouring samples of one kind together; not those of which nothing is said."""
    for key, run in groupby(samples, key=kind):
        if key:
            yield list(run)


def level_at(sample: Sample[Point]) -> float:
    """Its level, 0 where it has none."""
    return sample.level or 0.0


def crossings_of(search: RootSearch[Point]) -> list[Crossing[Point]]:
    """Where the target is passed."""
    levels = [sample.level for sample in search.samples if sample.level is not None]
    if len(levels) > 1 and max(levels) - min(levels) <= ALIKE:
        return []  # it does not depend on the value: nothing is passed
    return search.crossings()


def look_roughly(search: RootSearch[Point], asked: FactorRequest, whole: bool) -> list[Crossing[Point]]:
    """Where PRE-IE alone answers, and takes its time: first about the present value, then further off.

    Parameters
    ----------
    whole : look at all of the range at once
    """
    grid = asked.grid(*_ROUGH)
    if not whole:
        search.add(near_by(grid, asked.low, asked.high, asked.key.value))
        crossings = crossings_of(search)
        if crossings:
            return crossings
    search.add(grid)
    crossings = crossings_of(search)
    if not crossings:
        search.find_edges(_SLOW_EDGE)
        crossings = crossings_of(search)
    return crossings


def factor_notices(asked: FactorRequest, value: float, there: Point) -> Iterator[Notice]:
    """What a run says of the factor at a value; of a load the value is named: a load's own numbers are loads."""
    for notice in there.notes:
        if _LOAD.fullmatch(asked.key.path):
            where = f"of the factor of safety at {asked.key.path} = {asked.key.shown(value, 4)}: "
            notice = Notice(notice.code, where + notice.message)
        yield notice


def answers_of(
    method: Method, asked: FactorRequest, search: RootSearch[Point], crossings: list[Crossing[Point]]
) -> Answers:  # fmt: skip
    candidates = [_found(method, asked, crossing) for crossing in crossings]
    own = asked.key.value
    candidates.sort(key=lambda one: one.value if own is None else asked.key.apart(one.value, own))
    # the factor of many blocks may fall past the target at once as a load comes on: they tip, an answer too
    roots = tuple(one for one in candidates if one.how == "root" or (asked.drives_blocks and not one.rises))
    others = tuple(_together([one for one in candidates if one not in roots], search.span))
    reached = [(sample.at, factor_at(sample.found, method) or 0.0) for sample in search.defined]
    least = min(reached, key=lambda end: end[1], default=None)
    most = max(reached, key=lambda end: end[1], default=None)
    refused = tuple(_refused(search.samples))
    span = (asked.low, asked.high)
    reason = None if roots else reason_of(asked.key, asked.target, span, others, least, most, refused)
    looked = (search.samples[0].at, search.samples[-1].at)
    return Answers(method, roots, others, least, most, refused, looked, len(search.samples), reason)


def _together(jumps: list[SolvedValue], span: float) -> list[SolvedValue]:
    """Jumps so near to each other that they are one: beside an edge rounding makes many."""
    kept: list[SolvedValue] = []
    for one in sorted(jumps, key=lambda one: one.value):
        if kept and one.value - kept[-1].value <= _ONE_JUMP * max(abs(one.value), 1e-6 * span):
            kept[-1] = replace(kept[-1], value=one.value, bracket=(kept[-1].bracket[0], one.bracket[1]))
        else:
            kept.append(one)
    return kept


def _found(method: Method, asked: FactorRequest, crossing: Crossing[Point]) -> SolvedValue:
    best = crossing.best
    if crossing.how != "root" and asked.drives_blocks and not crossing.rises:
        best = replace(crossing.before, label=crossing.after.label)  # the last that stands, and how it goes
    ends = [(end.at, factor_at(end.found, method) or 0.0) for end in (crossing.before, crossing.after)]
    factor = factor_at(best.found, method) or 0.0
    notes = tuple(factor_notices(asked, best.at, best.found)) if method == "pre_ie" else ()
    return SolvedValue(
        crossing.how, best.at, factor, best.label, (ends[0], ends[1]), crossing.rises, best.found, notes=notes
    )


def _refused(samples: Samples) -> Iterator[tuple[float, float, str, str]]:
    """Stretches of neighbouring values that are refused for the same reason, with what is said in their middle."""
    for run in runs_of(samples, lambda sample: "" if sample.level is not None else sample.label):
        low, high = run[0].at, run[-1].at
        middle = min(run, key=lambda sample: abs(sample.at - 0.5 * (low + high)))
        yield low, high, middle.label, NO_CONVERGENCE if middle.label == UNSETTLED else middle.found.message
