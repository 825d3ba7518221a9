"""Find where a function of one number crosses zero: brackets on a grid, all narrowed together, round by round.

A "place" is a value of the argument, a "level" the value of the function there. An interval is bisected where its
ends have levels of opposite sign, where the function is defined at one end only, and where it could reach zero between
them: it turns around there, or changes its label, by as much as it is from zero. Nothing here depends on slopes.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Generic, Literal, TypeVar

T = TypeVar("T")
_LEAST_TURN_WIDTH = (
    1e-5  # relative width of an interval below which no turning point or change of label is sought
)
_STRETCH_DIVISIONS = 8  # intervals of a stretch of one label, which may be narrower than the grid
_LEAST_JUMP = 0.02  # least difference of levels across a narrow bracket that is a jump,
_LARGEST_ROOT_LEVEL = 1e-4  # unless one of the levels is this near to zero
_DECADES = 1e3  # ratio of the range to the present value from which it spans decades
_SIZE_OF_ZERO = 1.0  # size that is assumed for a number that is zero


@dataclass(frozen=True)
class Sample(Generic[T]):
    """The function at one place: its level (None where it is undefined), a label of its branch, and what gave it."""

    place: float
    level: float | None
    label: str
    evaluation: T


@dataclass(frozen=True)
class Crossing(Generic[T]):
    """A change of sign of the level between two samples.

    Attributes
    ----------
    how : root (the level is near zero there), jump (it passes zero without being near it), gap (it is undefined there)
    lower, upper : the samples below and above the crossing, the ends of the narrowed bracket
    best : the sample whose level is nearest to zero
    """

    how: Literal["root", "jump", "gap"]
    lower: Sample[T]
    upper: Sample[T]
    best: Sample[T]

    @property
    def rises(self) -> bool:
        """Whether the level rises with the place at the crossing."""
        return level_at(self.upper) > level_at(self.lower)


class RootSearch(Generic[T]):
    """A search for all zeros of one function: its samples, and the brackets between them.

    Parameters
    ----------
    evaluate : returns the samples at some places at once, in their order; span : the length of the range
    resolution : the least relative width of a bracket; all widths are relative to the place, or to 1e-6 of the span
        near zero
    near : a level that counts as zero
    level_tolerance : the largest difference of levels across a narrow bracket that is a root, no jump
    jump : the width of a bracket at which levels far apart are a jump, which is narrowed no further
    edge : the width to which the ends of the domain are found, beyond which the function is undefined
    reach : the tolerance of the least and the greatest level where none is zero
    """

    def __init__(
        self,
        evaluate: Callable[[Sequence[float]], list[Sample[T]]],
        span: float,
        *,
        resolution: float = 4e-16,
        near: float = 0.0,
        level_tolerance: float = 1e-7,
        jump: float = 0.0,
        edge: float = 1e-10,
        reach: float = 1e-6,
    ) -> None:
        self._evaluate, self.span = evaluate, span
        self.resolution, self.near, self.level_tolerance = resolution, near, level_tolerance
        self.jump, self.edge, self.reach = jump, edge, reach
        self._samples_by_place: dict[float, Sample[T]] = {}  # in the order of evaluation

    @property
    def samples(self) -> list[Sample[T]]:
        """All samples in rising order of their places."""
        return sorted(self._samples_by_place.values(), key=lambda sample: sample.place)

    @property
    def defined(self) -> list[Sample[T]]:
        """The samples at which the function is defined."""
        return [sample for sample in self.samples if sample.level is not None]

    @property
    def reaches_zero(self) -> bool:
        """Whether a sample is zero, or two samples have levels of opposite sign."""
        levels = [level_at(sample) for sample in self.defined] or [math.inf]
        return min(map(abs, levels)) <= self.near or min(levels) * max(levels) < 0.0

    def add(self, places: Iterable[float]) -> None:
        """Evaluate the function at places that have no sample yet."""
        new = [place for place in dict.fromkeys(places) if place not in self._samples_by_place]
        self._samples_by_place.update(
            (sample.place, sample) for sample in (self._evaluate(new) if new else ())
        )

    def search_grid(self, places: Iterable[float]) -> None:
        """Sample a grid and narrow all intervals that may hold a zero, also within narrow stretches of one label."""
        self.add(places)
        self._narrow(self._places_to_bisect)
        for run in self.stretches():
            if self._width(run[0], run[-1]) > _LEAST_TURN_WIDTH:
                self.add(
                    run[0].place + (run[-1].place - run[0].place) * division / _STRETCH_DIVISIONS
                    for division in range(1, _STRETCH_DIVISIONS)
                )
        self._narrow(self._places_to_bisect)

    def search_outwards(self, places: Iterable[float], start: float) -> None:
        """Sample a grid from one place outwards, on the side whose level is nearer to zero, until zero is passed.

        Once zero is passed only its brackets are narrowed, not the turning points.
        """
        self.add([start])
        grid = sorted(set(places))
        directions = [
            [place for place in reversed(grid) if place < start],
            [place for place in grid if place > start],
        ]
        while any(directions) and not self.reaches_zero:
            ends = self.samples[0], self.samples[-1]
            levels = [math.inf if end.level is None else abs(end.level) for end in ends]
            nearest = min(
                level for level, direction in zip(levels, directions, strict=True) if direction
            )
            for level, direction in zip(levels, directions, strict=True):
                if direction and level <= nearest:
                    self.add([direction.pop(0)])
        self._narrow(self._bracket_places if self.reaches_zero else self._places_to_bisect)

    # -- where to look next -----------------------------------------------------------------------

    def _narrow(self, open_places: Callable[[], Iterator[float]]) -> None:
        while places := [place for place in open_places() if place not in self._samples_by_place]:
            self.add(places)

    def _places_to_bisect(self) -> Iterator[float]:
        """Yield the next place in each bracket, and the middle of intervals with a possible zero or edge."""
        yield from self._bracket_places()
        yield from self._domain_edge_places(self.samples)
        turning = self._turning_places()
        for a, b in pairwise(self.samples):
            least = min(abs(level_at(a)), abs(level_at(b)))
            changes = a.label != b.label and abs(level_at(a) - level_at(b)) > least > self.near
            if (
                level_at(a) * level_at(b) > 0.0
                and self._width(a, b) > _LEAST_TURN_WIDTH
                and (changes or {a.place, b.place} & turning)
            ):
                yield 0.5 * (a.place + b.place)

    def _domain_edge_places(self, samples: Sequence[Sample[T]]) -> Iterator[float]:
        """Yield the middle of every interval at one end of which the function is undefined."""
        for a, b in pairwise(samples):
            if (a.level is None) is not (b.level is None) and self._width(a, b) > self.edge:
                yield 0.5 * (a.place + b.place)

    def _turning_places(self) -> set[float]:
        """Return places at which the level turns around and could reach zero; its extremes too while none is passed."""
        defined, turning = self.defined, set[float]()
        outermost = set[float]()
        if defined and not self.reaches_zero:
            outermost = {min(defined, key=level_at).place, max(defined, key=level_at).place}
        for a, b, c in zip(defined, defined[1:], defined[2:], strict=False):
            low, middle, high = level_at(a), level_at(b), level_at(c)
            rise = max(abs(low - middle), abs(high - middle))
            is_nearest = (
                abs(middle) < min(abs(low), abs(high))
                and low * middle > 0.0
                and middle * high > 0.0
            )
            least = self.reach if b.place in outermost else abs(middle) if is_nearest else math.inf
            if (middle - low) * (high - middle) < 0.0 and rise > least:
                turning.add(b.place)
        return turning

    def _bracket_places(self) -> Iterator[float]:
        """Yield the next place in each bracket not yet narrow: by Chandrupatla's rule (1997), or at an edge in it."""
        samples = self.samples
        rank = {place: k for k, place in enumerate(self._samples_by_place)}
        numbers = [k for k, sample in enumerate(samples) if sample.level is not None]
        for k, following in pairwise(numbers):
            a, b = samples[k], samples[following]
            least, width = min(abs(level_at(a)), abs(level_at(b))), self._width(a, b)
            is_jump = (
                width <= self.jump
                and least > _LARGEST_ROOT_LEVEL
                and abs(level_at(b) - level_at(a)) > _LEAST_JUMP
            )
            if (
                not level_at(a) * level_at(b) < 0.0
                or least <= self.near
                or width <= self.resolution
            ):
                continue
            if following > k + 1:
                yield from self._domain_edge_places(samples[k : following + 1])
            elif not is_jump:
                newest, opposite, previous_number = (
                    (a, b, k - 1) if rank[a.place] > rank[b.place] else (b, a, k + 2)
                )
                previous = [
                    sample
                    for sample in samples[max(previous_number, 0) : previous_number + 1]
                    if sample.level is not None
                ]
                fraction = (
                    _chandrupatla_fraction(
                        newest, opposite, previous[0], min(0.5, 0.5 * self.resolution / width)
                    )
                    if previous
                    else 0.5
                )
                yield newest.place + fraction * (opposite.place - newest.place)

    def _width(self, a: Sample[T], b: Sample[T]) -> float:
        return abs(b.place - a.place) / max(abs(a.place), abs(b.place), 1e-6 * self.span)

    # -- results ---------------------------------------------------------------------------

    def stretches(self) -> list[list[Sample[T]]]:
        """Return runs of neighbouring samples that have a level and the same label."""
        runs = groupby(
            self.samples, key=lambda sample: None if sample.level is None else sample.label
        )
        return [list(run) for label, run in runs if label is not None]

    def crossings(self) -> list[Crossing[T]]:
        """Return every change of sign between neighbouring samples, and every level that counts as zero, by place."""
        defined, crossings = self.defined, list[Crossing[T]]()
        for is_zero, run in groupby(
            range(len(defined)), key=lambda k: abs(level_at(defined[k])) <= self.near
        ):
            numbers = [*run]
            zeros = [defined[k] for k in numbers]
            lower, upper = (
                defined[max(numbers[0] - 1, 0)],
                defined[min(numbers[-1] + 1, len(defined) - 1)],
            )
            if is_zero and self._width(zeros[0], zeros[-1]) <= _LEAST_TURN_WIDTH:
                zeros = [min(zeros, key=lambda sample: abs(level_at(sample)))]
            if is_zero:
                crossings += [
                    Crossing("root", lower, upper, zero)
                    for zero in zeros[:: max(len(zeros) - 1, 1)]
                ]
        for a, b in pairwise(defined):
            if (
                level_at(a) * level_at(b) < 0.0
                and min(abs(level_at(a)), abs(level_at(b))) > self.near
            ):
                best = min(a, b, key=lambda sample: abs(level_at(sample)))
                is_root = abs(level_at(b) - level_at(a)) <= self.level_tolerance
                is_gap = any(
                    a.place < sample.place < b.place
                    for sample in self.samples
                    if sample.level is None
                )
                crossings.append(
                    Crossing("gap" if is_gap else "root" if is_root else "jump", a, b, best)
                )
        return sorted(crossings, key=lambda crossing: crossing.best.place)


def level_at(sample: Sample[T]) -> float:
    """Return the level of a sample, NaN where the function is undefined."""
    return math.nan if sample.level is None else sample.level


def _chandrupatla_fraction(
    newest: Sample[T], opposite: Sample[T], previous: Sample[T], least: float
) -> float:
    """Return the next place in a bracket as a fraction of the way from its newest end to the opposite one.

    Inverse quadratic interpolation where Chandrupatla's criterion (1997) allows it, else bisection.

    Parameters
    ----------
    newest, opposite : the ends of the bracket
    previous : the sample beside the newest end, outside the bracket
    least : the least fraction from either end
    """
    f1, f2, f3 = level_at(newest), level_at(opposite), level_at(previous)
    if f3 in (f1, f2):
        return 0.5
    xi = (newest.place - opposite.place) / (previous.place - opposite.place)
    phi = (f1 - f2) / (f3 - f2)
    if not (phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi):
        return 0.5
    fraction = f1 / (f2 - f1) * f3 / (f2 - f3)
    fraction += (
        (previous.place - newest.place)
        / (opposite.place - newest.place)
        * f1
        / (f3 - f1)
        * f2
        / (f3 - f2)
    )
    return min(1.0 - least, max(least, fraction))


def refined_grid(
    low: float, high: float, present_value: float | None, *, even: int, close: float
) -> list[float]:
    """Return a grid over a range that is fine near the present value, and towards zero too where it spans decades.

    Parameters
    ----------
    present_value : the present value, None where there is none
    even : how many places lie evenly over the range
    close : relative distance of the nearest places to the present value

    >>> refined_grid(0.0, 80.0, 20.0, even=3, close=0.5)
    [0.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0]
    """
    span, centre = high - low, low if present_value is None else present_value
    halvings = max(0, math.ceil(math.log2(span / (close * (abs(centre) or _SIZE_OF_ZERO)))))
    fractions = [0.5**k for k in range(1, halvings + 1)]
    grid = {centre, *(low + span * k / (even - 1) for k in range(even))}
    grid |= {centre + side * fraction * span for fraction in fractions for side in (-1, 1)}
    if span > _DECADES * abs(centre):
        grid |= {centre * fraction for fraction in fractions}
    return sorted(place for place in grid if low <= place <= high)
