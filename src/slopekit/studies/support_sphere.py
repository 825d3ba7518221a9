"""Directions over the sphere: spread evenly, around one, and the search for the least of a function of them."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from slopekit.arrays import Floats

_CLOSER = 0.4  # what a grid of nine by nine closes in by
_ALL_ROUNDS, _GO_ON = 6, 2


def sphere(count: int) -> Floats:
    """Directions (count, 3) spread evenly over the sphere (Fibonacci's spiral)."""
    k = np.arange(count) + 0.5
    up = 1.0 - 2.0 * k / count
    angle = math.pi * (1.0 + math.sqrt(5.0)) * k
    flat = np.sqrt(1.0 - up * up)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), up], axis=1)


def around(direction: Floats, angle_deg: float, count: int = 8) -> Floats:
    """Directions (count, 3) that lie a given angle off one."""
    other = np.zeros(3)
    other[int(np.argmin(np.abs(direction)))] = 1.0
    first = np.cross(direction, other)
    first /= math.sqrt(float(first @ first))
    second = np.cross(direction, first)
    turn = 2.0 * math.pi * np.arange(count) / count
    aside = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
    angle = math.radians(angle_deg)
    return math.cos(angle) * direction + math.sin(angle) * aside


def polished(
    force: Callable[[Floats], Floats], starts: Floats, lowest: Sequence[float], highest: Sequence[float]
) -> tuple[Floats, float] | None:
    """The least of a function of two angles within a box, from several starts, by grids that close in on the least.

    Parameters
    ----------
    force : (m, 2) angles to (m,) forces, inf where there is none
    starts : (s, 2)

    Returns
    -------
    angles (2,) and the force there, None where no start has one
    """
    bottom, top = np.array(lowest), np.array(highest)
    steps = np.stack(np.meshgrid(np.linspace(-1.0, 1.0, 9), np.linspace(-1.0, 1.0, 9)), axis=-1).reshape(-1, 2)
    best, reach, rounds = np.clip(starts, bottom, top), 2.0, 0
    while reach > 1e-9:
        tried = np.clip(best[:, None, :] + steps * reach, bottom, top)
        values = force(tried.reshape(-1, 2)).reshape(len(best), -1)
        least = values.argmin(axis=1)
        best = tried[np.arange(len(best)), least]
        reach, rounds = reach * _CLOSER, rounds + 1
        if rounds == _ALL_ROUNDS:  # the most promising go on
            best = best[np.argsort(values.min(axis=1))[:_GO_ON]]
    values = force(best)
    k = int(values.argmin())
    return (best[k], float(values[k])) if math.isfinite(values[k]) else None
