"""Water pressure in space, linear piece by piece: below a water table it grows with depth, p = γ_w (h - z), h >= z.

A table is a height h over the ground plan that is linear in strips or under planes; a pond raises it to one level where
it lies lower. Within a piece the pressure is linear, so that its integral over a flat polygon and the moment of it are
exact: of a triangle of area A with corners x_i and pressures p_i

    ∫ p dA = A Σp / 3        ∫ p x dA = A (Σp Σx + Σ p_i x_i) / 12

Polygons come n at a time, (n, k, 3), or several faces of n blocks, (f, n, k, 3); the first corner stands again where a
polygon has fewer than k. Slopes, levels, borders and ponds are one for all or one for each of the n.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from slopekit.core.arrays import Floats, cross

_ON_EDGE = 1e-12  # of the size of a polygon: a polygon nearer to a border lies in it
_UPRIGHT_HEIGHT = 1e12  # m, the ground below an upright plane: it never bounds the table

#: Flat convex polygons (n, k, 3) with the pressures (n, k) at their corners, linear in each triangle from the first of
#: them; not numbers where nothing of a polygon is wet.
Pieces: TypeAlias = Iterable[tuple[Floats, Floats]]


@dataclass(frozen=True)
class Height:
    """A height h = slope · x + level over some of the ground plan.

    Attributes
    ----------
    slope : (3,) or (n, 3), nothing along z; level : m, a number or (n,)
    borders : normals and offsets, shaped as slope and level, with `normal · x <= offset`, and whether the half-space is
        open: the border itself then belongs to the neighbouring height
    """

    slope: Floats
    level: Any
    borders: tuple[tuple[Floats, Any, bool], ...] = ()

    def elevation(self, points: Floats) -> Floats:
        """Return the elevation z (m) of the table over points (k, 3) or (n, k, 3), borders ignored: (k,) or (n, k)."""
        return _signed_distance(points, self.slope, np.negative(self.level))


def _signed_distance(points: Floats, normals: Floats, offsets: Any) -> Floats:
    """Return the distance (n, k) of points (n, k, 3) from planes `normal · x = offset` (n,), positive beyond them."""
    x, y, z = (points[..., k] * normals[..., k, None] for k in range(3))
    distance: Floats = x + y + z - np.asarray(offsets)[..., None]
    return distance


def table_below_planes(normals: Floats, offsets: Floats, depth: Any) -> tuple[Height, ...]:
    """Return a water table at a vertical depth below the lowest of the planes `normal · x = offset` of the ground.

    Upright planes bound nothing.

    Parameters
    ----------
    normals : (p, 3) or (p, n, 3); offsets : (p,) or (p, n) m; depth : m, a number or (n,)
    """
    is_upright = normals[..., 2] <= _ON_EDGE
    steepness = np.where(is_upright, 1.0, normals[..., 2])
    slopes = np.where(
        is_upright[..., None], 0.0, normals * [-1.0, -1.0, 0.0] / steepness[..., None]
    )
    levels = np.where(is_upright, _UPRIGHT_HEIGHT, offsets / steepness)
    heights = []
    for k, (slope, level) in enumerate(zip(slopes, levels, strict=True)):
        borders = tuple(
            (slope - slopes[neighbour], levels[neighbour] - level, k > neighbour)
            for neighbour in range(len(slopes))
            if neighbour != k
        )
        heights.append(Height(slope, level - depth, borders))
    return tuple(heights)


def table_through_points(
    along: Floats, places: Sequence[float], levels: Sequence[float]
) -> tuple[Height, ...]:
    """Return a water table through points of a section, horizontal beyond its ends.

    Parameters
    ----------
    along : (3,) or (n, 3) level unit vector that the places of points are counted along
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


def plane_table(normal: Floats, level: Any, along: Floats | None) -> tuple[Height, ...]:
    """Return a water table that is a plane with the normal (3,), at a level (m) over the origin.

    Parameters
    ----------
    along : (3,) or (n, 3) unit vector along a slope of which only the section counts, where the table has its trace
    """
    slope: Floats = normal * [-1.0, -1.0, 0.0] / normal[2]
    if along is not None:
        slope = slope - (slope * along).sum(axis=-1)[..., None] * along
    return (Height(slope, level),)


@dataclass(frozen=True)
class Pressure:
    """Hydrostatic pressure below a table, kPa.

    Attributes
    ----------
    heights : of the table; none without one
    pond : level of open water (m, a number or (n,)), None without any; unit_weight : kN/m³, a number or (n,)
    """

    heights: tuple[Height, ...]
    pond: Any
    unit_weight: Any

    def pressure(self, points: Floats) -> Floats:
        """Return the water pressure at points (k, 3) or (n, k, 3): (k,) or (n, k) kPa.

        >>> level = Pressure((Height(np.zeros(3), 5.0),), None, 10.0)
        >>> level.pressure(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 7.0]]))
        array([30.,  0.])
        """
        head: Floats = np.asarray(-np.inf if self.pond is None else self.pond)[..., None]
        for height in self.heights:
            is_inside = np.ones(points.shape[:-1], dtype=bool)
            for normal, offset, is_open in height.borders:
                side = _signed_distance(points, normal, offset)
                is_inside = is_inside & (side < 0.0 if is_open else side <= 0.0)
            head = np.where(is_inside, np.maximum(head, height.elevation(points)), head)
        return np.asarray(self.unit_weight)[..., None] * np.maximum(head - points[..., 2], 0.0)

    def resultants(self, polygons: Floats) -> tuple[Floats, Floats]:
        """Return the water thrusts (n,) kN on flat convex polygons (n, k, 3) and the points (n, 3) m they act through.

        >>> wall = np.array([[[0.0, 0, 0], [0, 1, 0], [0, 1, 6], [0, 0, 6]]])
        >>> Pressure((), 6.0, 10.0).resultants(wall)
        (array([180.]), array([[0. , 0.5, 2. ]]))
        """
        return resultant(self.pieces(polygons), polygons)

    def above(self, polygons: Floats) -> tuple[Floats, Floats]:
        """Return the height (n,) m of the table above flat convex polygons outside the pond, and where (n, 3) it is."""
        excess, place = np.zeros(polygons.shape[:-2]), polygons[..., 0, :]
        if self.pond is not None:
            polygons = _clipped(polygons, np.array([0.0, 0.0, -1.0]), np.negative(self.pond), False)
        for height in self.heights:
            corners = self._clipped_to_borders(polygons, height)
            over = height.elevation(corners) - corners[..., 2]
            over = np.where(np.isnan(over), -np.inf, over)
            highest = over.argmax(axis=-1)[..., None]
            corner = np.take_along_axis(corners, highest[..., None], axis=-2)[..., 0, :]
            most = over.max(axis=-1)
            place, excess = (
                np.where((most > excess)[..., None], corner, place),
                np.maximum(most, excess),
            )
        return excess, place

    def pieces(self, polygons: Floats) -> Iterator[tuple[Floats, Floats]]:
        """Yield the wet pieces of polygons (n, k, 3) on which the pressure is linear, with the corner pressures."""
        level = None if self.pond is None else Height(np.zeros(3), self.pond)
        for height in self.heights:
            strip = self._clipped_to_borders(polygons, height)
            if level is None:
                yield from self._wet(strip, height)
                continue
            yield from self._wet(
                _clipped(strip, -height.slope, height.level - level.level, False), height
            )
            yield from self._wet(
                _clipped(strip, height.slope, level.level - height.level, True), level
            )
        if level is not None and not self.heights:
            yield from self._wet(polygons, level)

    def _clipped_to_borders(self, polygons: Floats, height: Height) -> Floats:
        """Return the parts of polygons (n, k, 3) within the borders of a height."""
        for normal, offset, is_open in height.borders:
            polygons = _clipped(polygons, normal, offset, is_open)
        return polygons

    def _wet(self, polygons: Floats, height: Height) -> Iterator[tuple[Floats, Floats]]:
        wet = _clipped(polygons, np.array([0.0, 0.0, 1.0]) - height.slope, height.level, True)
        if not np.isnan(wet[..., 0, 0]).all():
            yield (
                wet,
                np.asarray(self.unit_weight)[..., None]
                * np.maximum(height.elevation(wet) - wet[..., 2], 0.0),
            )


def uniform_pieces(polygons: Floats, mean: Any) -> Pieces:
    """Return a uniform pressure (kPa, a number or (n,)) over each of flat convex polygons (n, k, 3)."""
    return [(polygons, np.asarray(mean)[..., None] + np.zeros(polygons.shape[:-1]))]


def pyramid_pieces(polygons: Floats, mean: Any, apex: Floats) -> Pieces:
    """Return pressures that fall linearly from a peak at an apex (n, 3) on the rim of a polygon to 0 at its corners.

    On each triangle (apex, a, b) the mean, a number or (n,), is a third of the peak.
    """
    peak = np.broadcast_to(apex[..., None, :], polygons[..., :1, :].shape)
    ring = np.concatenate([peak, polygons, polygons[..., :1, :]], axis=-2)
    pressures = np.zeros(ring.shape[:-1])
    pressures[..., 0] = 3.0 * mean
    return [(ring, pressures)]


def resultant(pieces: Pieces, polygons: Floats) -> tuple[Floats, Floats]:
    """Return the thrusts (n,) kN of pressures on flat polygons (n, k, 3), and the points (n, 3) they act through.

    Where there is no thrust the point is the middle of the polygon.

    >>> corner = np.array([[[0.0, 0, 0], [3, 0, 0], [0, 2, 0]]])
    >>> resultant([(corner, np.array([[12.0, 0.0, 0.0]]))], corner)
    (array([12.]), array([[0.75, 0.5 , 0.  ]]))
    """
    thrust, moment = np.zeros(polygons.shape[:-2]), np.zeros((*polygons.shape[:-2], 3))
    for corners, pressures in pieces:
        a, b, c = corners[..., :1, :], corners[..., 1:-1, :], corners[..., 2:, :]
        p, q, r = pressures[..., :1], pressures[..., 1:-1], pressures[..., 2:]
        normals = cross(b - a, c - a)
        areas, total = np.sqrt((normals * normals).sum(axis=-1)) / 2.0, p + q + r
        weighed = (
            (total + p)[..., None] * a + (total + q)[..., None] * b + (total + r)[..., None] * c
        )
        thrust = thrust + np.nansum(areas * total, axis=-1) / 3.0
        moment = moment + np.nansum(areas[..., None] * weighed, axis=-2) / 12.0
    is_pressed = (thrust > 0.0)[..., None]
    return thrust, np.where(
        is_pressed, moment / np.where(is_pressed, thrust[..., None], 1.0), polygons.mean(axis=-2)
    )


def _clipped(polygons: Floats, normal: Floats, offset: Any, is_open: bool) -> Floats:
    """Return the parts of polygons (n, k, 3) with `normal · x <= offset`; nan where nothing is left of a polygon.

    A polygon that lies in the border belongs to the closed side.
    """
    side = _signed_distance(polygons, normal, offset)
    size = np.abs(normal).max(axis=-1) * np.abs(polygons).max(axis=(-2, -1)) + np.abs(offset)
    side = np.where(
        (np.abs(side).max(axis=-1) <= _ON_EDGE * size)[..., None], 1.0 if is_open else 0.0, side
    )
    polygons = np.broadcast_to(polygons, (*side.shape, 3))
    is_out = side > 0.0
    if not is_out.any():
        return polygons
    if is_out.all():
        return np.full((*side.shape[:-1], 3, 3), np.nan)
    previous = np.arange(-1, side.shape[-1] - 1)
    start, previous_side, is_in = polygons[..., previous, :], side[..., previous], side <= 0.0
    crosses = (previous_side <= 0.0) != is_in
    fraction = np.where(crosses, previous_side / np.where(crosses, previous_side - side, 1.0), 0.0)[
        ..., None
    ]
    crossings = np.stack([start + fraction * (polygons - start), polygons], axis=-2)
    corners = crossings.reshape(*side.shape[:-1], -1, 3)
    is_corner = np.stack([crosses, is_in], axis=-1).reshape(corners.shape[:-1])
    counts = is_corner.sum(axis=-1)[..., None, None]
    most = max(int(counts.max(initial=0)), 3)
    order = np.argsort(~is_corner, axis=-1, kind="stable")[..., :most, None]
    corners = np.take_along_axis(corners, order, axis=-2)
    first = np.where(counts > 0, corners[..., :1, :], np.nan)
    return np.where(np.arange(most)[:, None] < counts, corners, first)
