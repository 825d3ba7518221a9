"""Where a function of one number crosses zero: brackets on a grid, all narrowed together, a round of places at a time.

An interval is looked into where its ends lie on both sides of zero, where the function is defined at one of them alone,
and where it could reach zero between them: it turns around there, or changes its label, by as much as it is from zero.
Nothing here knows of slopes.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Generic, Literal, TypeVar

T = TypeVar("T")
_TURN = 1e-5  # of a place: between samples so near no turning point or change of label is looked for
_PARTS = 8  # into which a stretch of one label is divided: a narrow one may have no place of the grid
_JUMP = 0.02  # levels that far apart on both sides of zero are a jump where places are near,
_NOT_NEAR = 1e-4  # and neither is that of a root nearby
_DECADES = 1e3  # times the present value: a range as long spans decades
_UNKNOWN = 1.0  # the size of a number that is nothing now


@dataclass(frozen=True)
class Sample(Generic[T]):
    """The function at one place: its level (None where it is undefined), a label of its branch, what else is known."""

    at: float
    level: float | None
    label: str
    found: T


@dataclass(frozen=True)
class Crossing(Generic[T]):
    """A place where the level changes its sign.

    Attributes
    ----------
    how : root (the level is near zero there), jump (it passes zero without being near it), gap (it is undefined there)
    before, after : the samples on both sides, as near to each other as was worth while
    best : the one nearest to zero
    """

    how: Literal["root", "jump", "gap"]
    before: Sample[T]
    after: Sample[T]
    best: Sample[T]

    @property
    def rises(self) -> bool:
        """Whether the level rises there."""
        return level_at(self.after) > level_at(self.before)


class RootSearch(Generic[T]):
    """Samples of one function, and where it crosses zero between them.

    Parameters
    ----------
    ask : the function at some places at once, in their order; span : the length of the range
    resolution : the least width of a bracket, as all widths in parts of the place, or of 1e-6 of the span near zero
    near : a level that counts as zero
    same : a difference of levels across a narrow bracket that is no jump
    jump : a bracket that narrow with levels far apart is a jump, and is narrowed no further
    edge : the width to which the ends of what is defined are found
    reach : how near the least and the greatest level are found where none is zero
    """

    def __init__(
        self, ask: Callable[[Sequence[float]], list[Sample[T]]], span: float, *, resolution: float = 4e-16,
        near: float = 0.0, same: float = 1e-7, jump: float = 0.0, edge: float = 1e-10, reach: float = 1e-6,
    ) -> None:  # fmt: skip
        self._ask, self.span = ask, span
        self.resolution, self.near, self.same = resolution, near, same
        self.jump, self.edge, self.reach = jump, edge, reach
        self._known: dict[float, Sample[T]] = {}  # in the order in which they were asked for

    @property
    def samples(self) -> list[Sample[T]]:
        """All samples, by their places."""
        return sorted(self._known.values(), key=lambda sample: sample.at)

    @property
    def defined(self) -> list[Sample[T]]:
        """The samples that have a level."""
        return [sample for sample in self.samples if sample.level is not None]

    @property
    def passes(self) -> bool:
        """Whether zero is met, or passed, between samples."""
        levels = [level_at(sample) for sample in self.defined] or [math.inf]
        return min(map(abs, levels)) <= self.near or min(levels) * max(levels) < 0.0

    def add(self, places: Iterable[float]) -> None:
        """Sample these places, each once."""
        new = [place for place in dict.fromkeys(places) if place not in self._known]
        self._known.update((sample.at, sample) for sample in (self._ask(new) if new else ()))

    def look(self, places: Iterable[float]) -> None:
        """Sample a grid, and all intervals that may hold a zero until they are narrow, stretches of one label too."""
        self.add(places)
        self._narrow(self._looked_into)
        for run in self.stretches():
            if self._width(run[0], run[-1]) > _TURN:
                self.add(run[0].at + (run[-1].at - run[0].at) * part / _PARTS for part in range(1, _PARTS))
        self._narrow(self._looked_into)

    def look_outwards(self, places: Iterable[float], start: float) -> None:
        """Sample a grid from one place outwards, on the side whose level is nearer to zero, until zero is passed.

        Where that is within the grid nothing else is looked into.
        """
        self.add([start])
        grid = sorted(set(places))
        ways = [[place for place in reversed(grid) if place < start], [place for place in grid if place > start]]
        while any(ways) and not self.passes:
            ends = self.samples[0], self.samples[-1]
            levels = [math.inf if end.level is None else abs(end.level) for end in ends]
            nearest = min(level for level, way in zip(levels, ways, strict=True) if way)
            for level, way in zip(levels, ways, strict=True):
                if way and level <= nearest:
                    self.add([way.pop(0)])
        self._narrow(self._in_brackets if self.passes else self._looked_into)

    # -- where to look next -----------------------------------------------------------------------

    def _narrow(self, looked_into: Callable[[], Iterator[float]]) -> None:
        while places := [place for place in looked_into() if place not in self._known]:
            self.add(places)

    def _looked_into(self) -> Iterator[float]:
        """The middle of every interval that may hold a zero, or the end of what is defined; a place in each bracket."""
        yield from self._in_brackets()
        yield from self._at_edges(self.samples)
        turning = self._turning()
        for a, b in pairwise(self.samples):
            least = min(abs(level_at(a)), abs(level_at(b)))
            changes = a.label != b.label and abs(level_at(a) - level_at(b)) > least > self.near
            if level_at(a) * level_at(b) > 0.0 and self._width(a, b) > _TURN and (changes or {a.at, b.at} & turning):
                yield 0.5 * (a.at + b.at)

    def _at_edges(self, samples: Sequence[Sample[T]]) -> Iterator[float]:
        """The middle of every interval at whose one end alone the function is defined."""
        for a, b in pairwise(samples):
            if (a.level is None) is not (b.level is None) and self._width(a, b) > self.edge:
                yield 0.5 * (a.at + b.at)

    def _turning(self) -> set[float]:
        """Where the level turns around and could reach zero; where nothing is passed, its least and greatest too."""
        defined, turning = self.defined, set[float]()
        outermost = set[float]()
        if defined and not self.passes:
            outermost = {min(defined, key=level_at).at, max(defined, key=level_at).at}
        for a, b, c in zip(defined, defined[1:], defined[2:], strict=False):
            low, middle, high = level_at(a), level_at(b), level_at(c)
            rise = max(abs(low - middle), abs(high - middle))
            is_nearest = abs(middle) < min(abs(low), abs(high)) and low * middle > 0.0 and middle * high > 0.0
            least = self.reach if b.at in outermost else abs(middle) if is_nearest else math.inf
            if (middle - low) * (high - middle) < 0.0 and rise > least:
                turning.add(b.at)
        return turning

    def _in_brackets(self) -> Iterator[float]:
        """The next place in every bracket that is not yet narrow: by Chandrupatla's rule (1997), or where it is cut."""
        samples = self.samples
        rank = {place: k for k, place in enumerate(self._known)}
        numbers = [k for k, sample in enumerate(samples) if sample.level is not None]
        for k, following in pairwise(numbers):
            a, b = samples[k], samples[following]
            least, width = min(abs(level_at(a)), abs(level_at(b))), self._width(a, b)
            is_jump = width <= self.jump and least > _NOT_NEAR and abs(level_at(b) - level_at(a)) > _JUMP
            if not level_at(a) * level_at(b) < 0.0 or least <= self.near or width <= self.resolution:
                continue
            if following > k + 1:
                yield from self._at_edges(samples[k : following + 1])
            elif not is_jump:
                one, two, beyond = (a, b, k - 1) if rank[a.at] > rank[b.at] else (b, a, k + 2)
                known = [sample for sample in samples[max(beyond, 0) : beyond + 1] if sample.level is not None]
                part = _next_part(one, two, known[0], min(0.5, 0.5 * self.resolution / width)) if known else 0.5
                yield one.at + part * (two.at - one.at)

    def _width(self, a: Sample[T], b: Sample[T]) -> float:
        return abs(b.at - a.at) / max(abs(a.at), abs(b.at), 1e-6 * self.span)

    # -- what was found ---------------------------------------------------------------------------

    def stretches(self) -> list[list[Sample[T]]]:
        """Neighbouring samples of one label that have a level."""
        runs = groupby(self.samples, key=lambda sample: None if sample.level is None else sample.label)
        return [list(run) for label, run in runs if label is not None]

    def crossings(self) -> list[Crossing[T]]:
        """Every change of sign between neighbouring samples; a level that counts as zero is one too."""
        defined, found = self.defined, list[Crossing[T]]()
        for is_zero, run in groupby(range(len(defined)), key=lambda k: abs(level_at(defined[k])) <= self.near):
            numbers = [*run]
            zeros = [defined[k] for k in numbers]
            before, after = defined[max(numbers[0] - 1, 0)], defined[min(numbers[-1] + 1, len(defined) - 1)]
            if is_zero and self._width(zeros[0], zeros[-1]) <= _TURN:
                zeros = [min(zeros, key=lambda sample: abs(level_at(sample)))]
            if is_zero:
                found += [Crossing("root", before, after, zero) for zero in zeros[:: max(len(zeros) - 1, 1)]]
        for a, b in pairwise(defined):
            if level_at(a) * level_at(b) < 0.0 and min(abs(level_at(a)), abs(level_at(b))) > self.near:
                best = min(a, b, key=lambda sample: abs(level_at(sample)))
                is_root = abs(level_at(b) - level_at(a)) <= self.same
                is_gap = any(a.at < sample.at < b.at for sample in self.samples if sample.level is None)
                found.append(Crossing("gap" if is_gap else "root" if is_root else "jump", a, b, best))
        return sorted(found, key=lambda crossing: crossing.best.at)


def level_at(sample: Sample[T]) -> float:
    """The level of a sample, not a number where it has none."""
    return math.nan if sample.level is None else sample.level


def _next_part(one: Sample[T], two: Sample[T], three: Sample[T], least: float) -> float:
    """Where between the newest place and the other side to look next, in parts of the way.

    Parameters
    ----------
    three : the neighbour of the newest beyond it
    """
    f1, f2, f3 = level_at(one), level_at(two), level_at(three)
    if f3 in (f1, f2):
        return 0.5
    xi = (one.at - two.at) / (three.at - two.at)
    phi = (f1 - f2) / (f3 - f2)
    if not (phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi):
        return 0.5
    part = f1 / (f2 - f1) * f3 / (f2 - f3)
    part += (three.at - one.at) / (two.at - one.at) * f1 / (f3 - f1) * f2 / (f3 - f2)
    return min(1.0 - least, max(least, part))


def places(low: float, high: float, own: float | None, *, even: int, close: float) -> list[float]:
    """A grid over a range that is fine near the present value; over one that spans decades, towards zero too.

    Parameters
    ----------
    own : the present value, None where there is none
    even : places evenly over the range; close : of the present value, how near to it the nearest others are

    >>> places(0.0, 80.0, 20.0, even=3, close=0.5)
    [0.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0]
    """
    span, centre = high - low, low if own is None else own
    halvings = max(0, math.ceil(math.log2(span / (close * (abs(centre) or _UNKNOWN)))))
    parts = [0.5**k for k in range(1, halvings + 1)]
    grid = {centre, *(low + span * k / (even - 1) for k in range(even))}
    grid |= {centre + side * part * span for part in parts for side in (-1, 1)}
    if span > _DECADES * abs(centre):
        grid |= {centre * part for part in parts}
    return sorted(place for place in grid if low <= place <= high)
