"""Water pressure in space, linear piece by piece: below a water table it grows with depth, p = γ_w (h - z), h >= z.

A table is a height h over the ground plan that is linear in strips or under planes; a pond raises it to one level where
it lies lower. Within a piece the pressure is linear, so that its integral over a flat polygon and the moment of it are
exact: of a triangle of area A with corners x_i and pressures p_i

    ∫ p dA = A Σp / 3        ∫ p x dA = A (Σp Σx + Σ p_i x_i) / 12
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from slopekit.core.arrays import Floats, cross

_ON_EDGE = 1e-12  # of the size of a polygon: nearer to the border of a piece it lies in it

#: Flat convex polygons (k, 3) with the pressures (k,) at their corners, linear in each triangle from the first of them.
Pieces: TypeAlias = Iterable[tuple[Floats, Floats]]


@dataclass(frozen=True)
class Height:
    """A height h = slope · x + level over some of the ground plan.

    Attributes
    ----------
    slope : (3,), nothing along z; level : m
    borders : (3,) normals and offsets with `normal · x <= offset`, and whether the border itself is left to another
    """

    slope: Floats
    level: float
    borders: tuple[tuple[Floats, float, bool], ...] = ()

    def at(self, points: Floats) -> Floats:
        """The height over points (n, 3), wherever they are: (n,)."""
        heights: Floats = points @ self.slope + self.level
        return heights


def under_planes(normals: Floats, offsets: Floats, depth: float) -> tuple[Height, ...]:
    """A table at a vertical depth below the lowest of planes `normal · x = offset`; vertical ones bound nothing."""
    planes = [(normal, offset) for normal, offset in zip(normals, offsets, strict=True) if normal[2] > _ON_EDGE]
    slopes = [np.array([-normal[0], -normal[1], 0.0]) / normal[2] for normal, _ in planes]
    levels = [float(offset / normal[2]) for normal, offset in planes]
    heights = []
    for k, (slope, level) in enumerate(zip(slopes, levels, strict=True)):
        borders = tuple(
            (slope - slopes[other], levels[other] - level, k > other) for other in range(len(planes)) if other != k
        )
        heights.append(Height(slope, level - depth, borders))
    return tuple(heights)


def in_strips(along: Floats, places: Sequence[float], levels: Sequence[float]) -> tuple[Height, ...]:
    """A table through points in a section, level beyond its ends.

    Parameters
    ----------
    along : (3,) level unit vector that the places are counted along
    places : m, ascending, twice where the table steps; levels : m
    """
    flat = np.zeros(3)
    heights = [Height(flat, levels[0], ((along, places[0], True),))]
    for k in range(len(places) - 1):
        if places[k + 1] == places[k]:
            continue
        rise = (levels[k + 1] - levels[k]) / (places[k + 1] - places[k])
        borders = ((-along, -places[k], False), (along, places[k + 1], True))
        heights.append(Height(rise * along, levels[k] - rise * places[k], borders))
    return (*heights, Height(flat, levels[-1], ((-along, -places[-1], False),)))


def plane_table(normal: Floats, level: float, in_section: bool) -> tuple[Height, ...]:
    """A table that is a plane of this normal (3,), at a level (m) over the origin; of a section its trace there."""
    x, y, z = normal
    return (Height(np.array([-x / z, 0.0 if in_section else -y / z, 0.0]), level),)


@dataclass(frozen=True)
class Pressure:
    """Hydrostatic pressure below a table, kPa.

    Attributes
    ----------
    heights : of the table; none without one
    pond : level of open water (m), None without any; unit_weight : kN/m³
    """

    heights: tuple[Height, ...]
    pond: float | None
    unit_weight: float

    def at(self, points: Floats) -> Floats:
        """The pressure at points (n, 3): (n,) kPa.

        >>> level = Pressure((Height(np.zeros(3), 5.0),), None, 10.0)
        >>> level.at(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 7.0]]))
        array([30.,  0.])
        """
        head = np.full(len(points), -np.inf if self.pond is None else self.pond)
        for height in self.heights:
            within = np.ones(len(points), dtype=bool)
            for normal, offset, is_open in height.borders:
                side = points @ normal - offset
                within &= side < 0.0 if is_open else side <= 0.0
            head = np.where(within, np.maximum(head, height.at(points)), head)
        wet: Floats = self.unit_weight * np.maximum(head - points[:, 2], 0.0)
        return wet

    def on(self, polygon: Floats) -> tuple[float, Floats]:
        """The integral of the pressure over a flat convex polygon (k, 3), kN, and the point it acts through, (3,).

        >>> wall = np.array([[0.0, 0, 0], [0, 1, 0], [0, 1, 6], [0, 0, 6]])
        >>> Pressure((), 6.0, 10.0).on(wall)
        (180.0, array([0. , 0.5, 2. ]))
        """
        return resultant(self.pieces(polygon), polygon)

    def above(self, polygon: Floats) -> tuple[float, Floats]:
        """By how much (m) the table stands above a flat convex polygon, and no pond does, at most, and where (3,)."""
        worst, place = 0.0, np.zeros(3)
        if self.pond is not None:
            polygon = _clipped(polygon, np.array([0.0, 0.0, -1.0]), -self.pond, False)
        for height in self.heights:
            part = polygon
            for normal, offset, is_open in height.borders:
                part = _clipped(part, normal, offset, is_open)
            over = height.at(part) - part[:, 2]
            if len(over) and float(over.max()) > worst:
                worst, place = float(over.max()), part[int(over.argmax())]
        return worst, place

    def pieces(self, polygon: Floats) -> Iterator[tuple[Floats, Floats]]:
        """The wet parts of a polygon on which the pressure is linear, each with the pressures at its corners."""
        level = None if self.pond is None else Height(np.zeros(3), self.pond)
        for height in self.heights:
            part = polygon
            for normal, offset, is_open in height.borders:
                part = _clipped(part, normal, offset, is_open)
            if level is None:
                yield from self._wet(part, height)
                continue
            yield from self._wet(_clipped(part, -height.slope, height.level - level.level, False), height)
            yield from self._wet(_clipped(part, height.slope, level.level - height.level, True), level)
        if level is not None and not self.heights:
            yield from self._wet(polygon, level)

    def _wet(self, part: Floats, height: Height) -> Iterator[tuple[Floats, Floats]]:
        wet = _clipped(part, np.array([0.0, 0.0, 1.0]) - height.slope, height.level, True)
        if len(wet) > 2:
            yield wet, self.unit_weight * np.maximum(height.at(wet) - wet[:, 2], 0.0)


def even(polygon: Floats, mean: float) -> Pieces:
    """The same pressure all over a flat convex polygon (k, 3)."""
    return [(polygon, np.full(len(polygon), mean))]


def pyramid(polygon: Floats, mean: float, apex: Floats) -> Pieces:
    """A pressure that falls linearly from its apex, on the edge or at a corner of a polygon, to nothing on other edges.

    On each triangle (apex, a, b) the mean is a third of the peak.
    """
    peak = np.array([3.0 * mean, 0.0, 0.0])
    return [(np.array([apex, a, b]), peak) for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)]


def resultant(pieces: Pieces, polygon: Floats) -> tuple[float, Floats]:
    """The force (kN) of a pressure on a flat polygon (k, 3), and the point (3,) it acts through: of none its middle."""
    thrust, moment = 0.0, np.zeros(3)
    for part, pressures in pieces:
        force, turning = fan(part, pressures)
        thrust += force
        moment += turning
    return thrust, moment / thrust if thrust > 0.0 else polygon.mean(axis=0)


def fan(polygon: Floats, pressures: Floats) -> tuple[float, Floats]:
    """The integrals of p and p x over a flat convex polygon (k, 3), p linear in each triangle from its first corner.

    Parameters
    ----------
    pressures : (k,) at the corners

    >>> corner = np.array([[0.0, 0, 0], [3, 0, 0], [0, 2, 0]])
    >>> fan(corner, np.array([12.0, 0.0, 0.0]))
    (12.0, array([9., 6., 0.]))
    """
    a, b, c = polygon[:1], polygon[1:-1], polygon[2:]
    areas = np.sqrt((cross(b - a, c - a) ** 2).sum(axis=1)) / 2.0
    corners = np.stack([np.broadcast_to(a, b.shape), b, c])
    at = np.stack([np.broadcast_to(pressures[0], len(b)), pressures[1:-1], pressures[2:]])
    total = at.sum(axis=0)
    moment: Floats = areas / 12.0 @ (total[:, None] * corners.sum(axis=0) + (at[:, :, None] * corners).sum(axis=0))
    return float(areas @ total) / 3.0, moment


def _clipped(polygon: Floats, normal: Floats, offset: float, is_open: bool) -> Floats:
    """The part of a polygon (k, 3) with `normal · x <= offset`; one that lies in the border is of the closed side."""
    if len(polygon) < 3:
        return polygon[:0]
    side = polygon @ normal - offset
    size = float(np.abs(normal).max()) * float(np.abs(polygon).max(initial=0.0)) + abs(offset)
    if float(np.abs(side).max()) <= _ON_EDGE * size:
        return polygon[:0] if is_open else polygon
    corners = []
    for k in range(len(polygon)):
        here, there = side[k - 1], side[k]
        if (here <= 0.0) != (there <= 0.0):
            corners.append(polygon[k - 1] + (here / (here - there)) * (polygon[k] - polygon[k - 1]))
        if there <= 0.0:
            corners.append(polygon[k])
    return np.array(corners).reshape(-1, 3)
