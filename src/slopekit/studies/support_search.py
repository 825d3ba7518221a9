"""The least force at which a method gives a wanted factor of safety: any method, asked as a black box."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slopekit.studies.support_site import Answer

_DOWN = (1.0 - 1e-6, 0.999, 0.97, 0.85, 0.6, 0.3, 0.1, 0.01)
_UP = (1.0 + 1e-6, 1.003, 1.03, 1.12, 1.3, 1.7, 2.5, 4.0, 7.0, 12.0)
_SHARES = (0.01, 0.1, 0.3, 0.6, 0.9)  # of the range of forces that the closed form allows
_MOST_ASKED = 24
_NARROW = 1e-10  # a bracket this narrow (in parts of the force) in which the factor still changes is a jump ...
_LEAP, _LEAPS_WITHIN = 1.05, 1e-3  # ... and one this narrow in which it changes that much


@dataclass(frozen=True, slots=True)
class Found:
    """What a search found.

    Attributes
    ----------
    force : None where no force that was tried reaches the target; answer : at that force, else the best that was met
    best_force : of that answer
    below : the level just under the force where the factor jumps over the target, None where it rises to it
    slope : change of the level with the force there, per kN; None where it is not known
    """

    force: float | None
    answer: Answer
    best_force: float
    below: float | None
    slope: float | None


def least_force(
    ask: Callable[[float], Answer], target: float, within: float, guess: float, at_zero: float, most: float,
    slope: float | None = None, upward: Sequence[float] | None = None,
) -> Found:  # fmt: skip
    """The least force near a guess that gives a level of `target` to `target (1 + 2 within)`.

    Parameters
    ----------
    ask : force to answer
    guess : where to begin; most : a force that is not passed (inf: none)
    at_zero : the level without the force, less than the target
    slope : change of the level with the force, per kN, near the guess; None where it is not known
    upward : forces to try where the guess is not enough; None for a choice of them
    """
    tried: dict[float, Answer] = {}

    def level(force: float) -> float:
        if force not in tried:
            tried[force] = ask(force)
        found = tried[force].level
        return 0.0 if math.isnan(found) else found

    def met(force: float) -> bool:
        return target <= level(force) <= target * (1.0 + 2.0 * within)

    def found(force: float, below: float | None = None) -> Found:
        others = [other for other in tried if other != force and 0.0 < level(other) < math.inf]
        near = min(others, key=lambda other: abs(other - force), default=0.0)
        other = level(near) if near else at_zero
        rate = (level(force) - other) / (force - near) if force != near and math.isfinite(level(force)) else None
        return Found(force, tried[force], force, below, rate if rate and rate > 0.0 else slope)

    low, high = 0.0, math.inf
    if met(guess):
        return found(guess)
    if level(guess) >= target:
        high = guess
        for force in _downward(guess, level(guess), target, slope):
            if level(force) < target:
                low = force
                break
            high = force
    else:
        low = guess
        for force in _upward(guess, level(guess), at_zero, target, most, slope) if upward is None else upward:
            if level(force) >= target:
                high = force
                break
            low = force
    if not math.isfinite(high):
        best = max(tried, key=level)
        return Found(None, tried[best], best, None, None)
    aim = target * (1.0 + within)
    ends = [(low, _height(level(low) if low else at_zero, aim)), (high, _height(level(high), aim))]
    path = sorted(ends, key=lambda end: -abs(end[1]))  # what was tried, the latest last
    while not met(high) and high - low > _NARROW * high and len(tried) < _MOST_ASKED:
        if high - low <= _LEAPS_WITHIN * high and level(high) > _LEAP * (level(low) if low else at_zero):
            break
        (one, before), (two, last) = path[-2:]
        middle = two - last * (two - one) / (last - before) if math.isfinite(last - before) and last != before else 0.0
        slow = len(path) > 3 and abs(last) > 0.5 * abs(path[-3][1])
        if slow or not low < middle < high:
            middle = 0.5 * (low + high)
        path.append((middle, _height(level(middle), aim)))
        if level(middle) < target:
            low = middle
        else:
            high = middle
    return found(high, None if met(high) else level(low) if low else at_zero)


def _downward(guess: float, level: float, target: float, slope: float | None) -> list[float]:
    """Forces below a guess to try in turn."""
    forces = [guess * share for share in _DOWN]
    straight = guess - 1.05 * (level - target) / slope if slope and math.isfinite(level) else 0.0
    if not 0.0 < straight < guess:
        return forces
    return [straight, *(force for force in forces if force < 0.99 * straight)]


def _upward(guess: float, level: float, at_zero: float, target: float, most: float, slope: float | None) -> list[float]:
    """Forces above a guess to try in turn: where a straight line leads, then further and further."""
    forces = [guess * factor for factor in _UP]
    straight = 0.0
    if slope:
        straight = guess + 1.05 * (target - level) / slope
    elif level > at_zero and math.isfinite(level):
        straight = guess + 1.05 * guess * (target - level) / (level - at_zero)
    if straight > guess:
        forces = [straight, *(force for force in forces if force > 1.01 * straight)]
    if not math.isfinite(most):
        return forces
    return sorted({force for force in forces if force < most} | {guess + share * (most - guess) for share in _SHARES})


def _height(level: float, aim: float) -> float:
    return math.log(level / aim) if 0.0 < level < math.inf else math.copysign(math.inf, level - aim)
