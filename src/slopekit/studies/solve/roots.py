"""Where a function of one number crosses zero: all places that a grid shows, jumps told from roots, gaps named.

The function may be undefined in places (no block can be formed there), may jump, and may have several zeros. Nothing
here knows of slopes.
"""

import math
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Generic, Literal, TypeVar

T = TypeVar("T")
_MOST_STEPS = 200
_GOLDEN = (3.0 - math.sqrt(5.0)) / 2.0
_CROWD = 8  # changes of sign: where there are more, those in rounding beside an edge are not narrowed down,
_NOISE = 3e-8  # that is where samples so near to each other (in parts of the place) lie far on both sides of zero
_TURN = 1e-5  # of a place: between samples so near no turning point or change of label is looked for
_ROUNDING = 1e-9  # levels that differ by less do not turn around
_REACH, _TIMES = 0.25, 5.0  # of the range, or times the present value: what is near by
_UNKNOWN = 1.0  # the size of a number that is nothing now
_NOT_NEAR = 1e-4  # a level beyond this is not that of a root nearby
_MOST_SPLITS = 8  # of an interval in which places turn out to be undefined


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
        return (self.after.level or 0.0) > (self.before.level or 0.0)


class RootSearch(Generic[T]):
    """Samples of one function, and the crossings between them.

    Parameters
    ----------
    sample : the function at some places at once, in their order
    span : the length of the range; resolution : the least distance worth while, in parts of the place (or of 1e-6 of
        the span, near zero)
    near : a level that counts as zero: the search for a root stops there
    same : a difference of levels across a narrow bracket that is no jump
    jump : (width, difference): a bracket that narrow (in parts of the place) with levels that far apart is a jump, and
        is narrowed down no further
    """

    def __init__(
        self, sample: Callable[[Sequence[float]], list[Sample[T]]], span: float, *, resolution: float = 4e-16,
        near: float = 0.0, same: float = 1e-7, jump: tuple[float, float] = (0.0, math.inf),
    ) -> None:  # fmt: skip
        self._sample = sample
        self.span, self.resolution, self.near, self.same, self.jump = span, resolution, near, same, jump
        self.samples: list[Sample[T]] = []
        self._known: dict[float, Sample[T]] = {}

    # -- samples ----------------------------------------------------------------------------------

    def add(self, places: Iterable[float]) -> list[Sample[T]]:
        """Sample these places, each once."""
        wanted = list(dict.fromkeys(places))
        new = [place for place in wanted if place not in self._known]
        for new_sample in self._sample(new) if new else []:
            self._known[new_sample.at] = new_sample
            self.samples.insert(bisect_left(self.samples, new_sample.at, key=lambda sample: sample.at), new_sample)
        return [self._known[place] for place in wanted]

    def at(self, place: float) -> Sample[T]:
        """The function at one place."""
        return self._known.get(place) or self.add([place])[0]

    @property
    def defined(self) -> list[Sample[T]]:
        """The samples that have a level."""
        return [sample for sample in self.samples if sample.level is not None]

    def narrow(self, a: float, b: float) -> bool:
        """Whether two places are as near as is worth while."""
        return abs(b - a) <= self.resolution * self._size(a, b)

    def _size(self, a: float, b: float) -> float:
        return max(abs(a), abs(b), 1e-6 * self.span)

    def _jumps(self, a: Sample[T], b: Sample[T]) -> bool:
        width, difference = self.jump
        is_narrow = abs(b.at - a.at) <= width * self._size(a.at, b.at)
        far = min(abs(_level(a)), abs(_level(b))) > _NOT_NEAR and abs(_level(b) - _level(a)) > difference
        return is_narrow and far

    # -- a finer look -----------------------------------------------------------------------------

    def find_edges(self, width: float) -> None:
        """Halve every interval of which one end is undefined, until it is narrower than `width` of the place."""
        for a, b in list(pairwise(self.samples)):
            if (a.level is None) != (b.level is None):
                self._halve(a, b, width, lambda sample: sample.level is None)

    def find_changes(self, width: float) -> None:
        """Halve every interval over which the label changes."""
        for a, b in list(pairwise(self.samples)):
            wide = b.at - a.at > _TURN * self._size(a.at, b.at)
            if wide and a.level is not None and b.level is not None and a.label != b.label:
                self._halve(a, b, width, lambda sample: sample.label)

    def _halve(self, a: Sample[T], b: Sample[T], width: float, side: Callable[[Sample[T]], object]) -> None:
        of_a = side(a)
        while b.at - a.at > width * self._size(a.at, b.at):
            middle = self.at(0.5 * (a.at + b.at))
            if middle.at in (a.at, b.at):
                return
            a, b = (middle, b) if side(middle) == of_a else (a, middle)

    def find_extremes(self, steps: int, within: float = math.inf, ends: bool = True) -> None:
        """Where the level turns around short of zero, look whether it does reach it: golden sections.

        Parameters
        ----------
        within : levels that are further from zero are let be
        ends : also at the highest and lowest of all, so that the range of the function is known
        """
        defined = self.defined
        if len(defined) < 3:
            return
        outermost = {min(defined, key=_level).at, max(defined, key=_level).at} if ends else set()
        for a, b, c in list(zip(defined, defined[1:], defined[2:], strict=False)):
            low, middle, high = _level(a), _level(b), _level(c)
            narrow = c.at - a.at <= _TURN * self._size(a.at, c.at)
            if narrow or max(low, middle, high) - min(low, middle, high) < _ROUNDING:
                continue
            turns = (middle - low) * (high - middle) < 0.0
            towards = abs(middle) < min(abs(low), abs(high)) and middle * low > 0.0 and middle * high > 0.0
            if turns and ((towards and abs(middle) < within) or b.at in outermost):
                self._section(a, b, c, 1.0 if middle < low else -1.0, steps)

    def _section(self, a: Sample[T], b: Sample[T], c: Sample[T], sign: float, steps: int) -> None:
        for _ in range(steps):
            right = c.at - b.at > b.at - a.at
            place = b.at + _GOLDEN * ((c.at - b.at) if right else (a.at - b.at))
            new = self.at(place)
            if new.level is None or place in (a.at, b.at, c.at):
                return
            if sign * _level(new) < sign * _level(b):
                a, b, c = (b, new, c) if right else (a, new, b)
            else:
                a, c = (a, new) if right else (new, c)
            if _level(b) * _level(a) < 0.0 or self.narrow(a.at, c.at):
                return

    # -- crossings --------------------------------------------------------------------------------

    def crossings(self) -> list[Crossing[T]]:
        """Every change of sign between neighbouring samples, narrowed down; a level that counts as zero is one too."""
        sign_changes: list[Crossing[T]] = []
        pairs = [(a, b) for a, b in pairwise(self.defined) if _level(a) * _level(b) < 0.0]
        for a, b in pairs:
            noise = len(pairs) > _CROWD and b.at - a.at <= _NOISE * self._size(a.at, b.at)
            if noise and min(abs(_level(a)), abs(_level(b))) > _NOT_NEAR:
                sign_changes.append(self._crossing(a, b))
            else:
                sign_changes += self._narrowed(a, b, _MOST_SPLITS)
        known = {one.at for crossing in sign_changes for one in (crossing.before, crossing.after)}
        defined = self.defined
        for k, zero in enumerate(defined):
            if abs(_level(zero)) <= self.near and zero.at not in known:
                before, after = defined[max(k - 1, 0)], defined[min(k + 1, len(defined) - 1)]
                sign_changes.append(Crossing("root", before, after, zero))
        return sorted(sign_changes, key=lambda crossing: crossing.best.at)

    def _narrowed(self, a: Sample[T], b: Sample[T], splits: int) -> Iterator[Crossing[T]]:
        """One change of sign, narrowed down to a root, a jump or a gap."""
        if any(sample.level is None for sample in self._between(a, b)):
            yield from self._across_gaps(a, b, splits)
            return
        before, after = self._polish(a, b)
        if any(sample.level is None for sample in self._between(before, after)) and splits:
            self.find_edges(1e-9)
            for c, d in list(pairwise([a, *self._between(a, b), b])):
                if c.level is not None and d.level is not None and c.level * d.level < 0.0:
                    yield from self._narrowed(c, d, splits - 1)
            yield from self._across_gaps(before, after, 0)
            return
        yield self._crossing(before, after)

    def _crossing(self, before: Sample[T], after: Sample[T]) -> Crossing[T]:
        best = min(before, after, key=lambda sample: abs(_level(sample)))
        is_root = abs(_level(best)) <= self.near or abs(_level(after) - _level(before)) <= self.same
        return Crossing("root" if is_root else "jump", before, after, best)

    def _across_gaps(self, a: Sample[T], b: Sample[T], splits: int) -> Iterator[Crossing[T]]:
        """The sides of a stretch that is undefined: what changes its sign beside it, and across it."""
        last: Sample[T] | None = None
        for c, d in pairwise([a, *self._between(a, b), b]):
            if c.level is not None:
                last = c
            if c.level is not None and d.level is not None and c.level * d.level < 0.0 and splits:
                yield from self._narrowed(c, d, splits - 1)
            if c.level is None and d.level is not None and last is not None and _level(last) * d.level < 0.0:
                yield replace(self._crossing(last, d), how="gap")

    def _between(self, a: Sample[T], b: Sample[T]) -> list[Sample[T]]:
        low = bisect_left(self.samples, a.at, key=lambda sample: sample.at)
        return [sample for sample in self.samples[low:] if a.at < sample.at < b.at]

    def _polish(self, a: Sample[T], b: Sample[T]) -> tuple[Sample[T], Sample[T]]:
        """The bracket (lower place first) narrowed down by Chandrupatla's rule (1997)."""
        one, two, three = b, a, b  # one: the newest; one and two have the root between them
        part = 0.5
        for _ in range(_MOST_STEPS if min(abs(_level(a)), abs(_level(b))) > self.near else 0):
            place = one.at + part * (two.at - one.at)
            if place in (one.at, two.at):
                break
            new = self.at(place)
            if new.level is None:
                break
            if (new.level > 0.0) == (_level(one) > 0.0):
                three = one
            else:
                three, two = two, one
            one = new
            if abs(_level(one)) <= self.near or self.narrow(one.at, two.at) or self._jumps(one, two):
                break
            least = self.resolution * self._size(one.at, two.at) / abs(two.at - one.at)
            part = _next_part(one, two, three, min(0.5, 0.5 * least))
        return (one, two) if one.at < two.at else (two, one)


def _next_part(one: Sample[T], two: Sample[T], three: Sample[T], least: float) -> float:
    """Where between the newest place and the other side to look next, in parts of the way."""
    f1, f2, f3 = _level(one), _level(two), _level(three)
    if f3 == f2 or three.at == two.at or f1 in (f2, f3):
        return 0.5
    xi = (one.at - two.at) / (three.at - two.at)
    phi = (f1 - f2) / (f3 - f2)
    if not (phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi):
        return 0.5
    part = f1 / (f2 - f1) * f3 / (f2 - f3)
    part += (three.at - one.at) / (two.at - one.at) * f1 / (f3 - f1) * f2 / (f3 - f2)
    return min(1.0 - least, max(least, part))


def _level(sample: Sample[T]) -> float:
    return sample.level if sample.level is not None else math.nan


def places(
    low: float, high: float, own: float | None, *, even: int, close: int, each_decade: float, around_zero: bool = False
) -> list[float]:
    """A grid over a range that is fine near the present value.

    Parameters
    ----------
    own : the present value, None where there is none
    even : places evenly over the range, where it does not span decades
    close : more places towards the present value, on each side
    each_decade : places to a decade, where the range spans several
    around_zero : the range reaches far to both sides of what matters, as that of a coordinate does

    >>> places(0.0, 90.0, 20.0, even=4, close=1, each_decade=2)
    [0.0, 5.0, 20.0, 30.0, 35.0, 60.0, 90.0]
    """
    grid = {low, high}
    inside = own is not None and low <= own <= high
    if around_zero and own is not None and high - low > 100.0 * max(abs(own), 1.0):
        size = max(abs(own), 1.0) * 1e-2
        for k in range(1 + int(each_decade * math.log10((high - low) / size))):
            step = size * 10.0 ** (k / each_decade)
            grid |= {own - step, own + step}
    elif _spans_decades(low, high, own):
        least = low if low > 0.0 else (own or high * 1e-8) * (1e-6 if own else 1.0)
        middle = own if own and inside else least
        count = math.ceil(each_decade * math.log10(high / least)) + 1
        grid |= {middle * 10.0 ** (k / each_decade) for k in range(-count, count + 1)}
        if own and inside:
            grid |= {own * 10.0 ** (side * k / (each_decade * (close + 1))) for k in range(1, 2 * close + 2)
                     for side in (-1, 1)}  # fmt: skip
    else:
        grid |= {low + (high - low) * k / (even - 1) for k in range(even)}
        if own is not None and inside:
            step = (high - low) / (even - 1)
            grid |= {own + side * step * 0.5**k for k in range(1, close + 1) for side in (-1, 1)}
    if own is not None:
        grid.add(own)
    return sorted(place for place in grid if low <= place <= high)


def _spans_decades(low: float, high: float, own: float | None) -> bool:
    return low >= 0.0 and high > 1e3 * max(low, own or _UNKNOWN)


def near_by(grid: Sequence[float], low: float, high: float, own: float | None) -> list[float]:
    """Of a grid what lies about the present value, with the ends of that stretch; nothing where there is none.

    >>> near_by([0.0, 10.0, 20.0, 30.0, 60.0, 90.0], 0.0, 90.0, 20.0)
    [10.0, 20.0, 30.0, 42.5]
    """
    if own is None or not low <= own <= high:
        return []
    reach = _REACH * (high - low)
    first, last = max(own - reach, 0.5 * (own + low)), min(own + reach, 0.5 * (own + high))
    if own > 0.0 and _spans_decades(low, high, own):
        first, last = max(own / _TIMES, low), min(own * _TIMES, high)
    return sorted({first, *(place for place in grid if first < place < last), last})
