"""Polygons as one flat array of corners: cleaned, turned anticlockwise, measured, checked, cut into convex pieces."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from manifold3d import triangulate

from slopekit.arrays import Bools, Floats, Ints
from slopekit.errors import Fault
from slopekit.geometry.fit import contact_tolerance, refuse, size_faults

_LARGEST_PIECE = 8  # corners of a convex polygon that is clipped whole; more are cut into triangles
_SAME = 1e-3  # of the contact tolerance: corners nearer than this to each other or to the line past them are dropped


@dataclass(frozen=True, slots=True)
class Outlines:
    """Outlines of blocks in a section, anticlockwise.

    Attributes
    ----------
    origin : (2,) taken from all coordinates, so that map coordinates lose no digits in areas and moments
    corners : (c, 2) m, without origin; start : (n + 1,) outline i has the corners start[i] to start[i + 1]
    areas : (n,) m²; centroids : (n, 2) m, without origin
    """

    origin: Floats
    corners: Floats
    start: Ints
    areas: Floats
    centroids: Floats

    def __len__(self) -> int:
        return len(self.areas)

    @property
    def block(self) -> Ints:
        """(c,) the block of each corner, and of the edge that begins there."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    @property
    def after(self) -> Ints:
        """(c,) the next corner of each."""
        return _neighbours(self.start)[1]

    def outline(self, block: int) -> Floats:
        """(k, 2) corners of a block where the user has them."""
        return np.asarray(self.corners[self.start[block] : self.start[block + 1]] + self.origin, dtype=np.float64)

    def are_convex(self) -> Bools:
        """Whether each outline turns left at every corner and once round in all."""
        before, after = _neighbours(self.start)
        along, last = self.corners[after] - self.corners, self.corners - self.corners[before]
        turn = np.arctan2(
            last[:, 0] * along[:, 1] - last[:, 1] * along[:, 0], last[:, 0] * along[:, 0] + last[:, 1] * along[:, 1]
        )
        once = np.add.reduceat(turn, self.start[:-1]) < 3.0 * np.pi
        return np.asarray(once & (np.minimum.reduceat(turn, self.start[:-1]) > 0.0))


def clean_outlines(polygons: Sequence[Floats], tolerance: float | None, names: Sequence[str]) -> tuple[Outlines, float]:
    """Outlines without repeated corners and corners on a straight line, and the tolerance.

    Parameters
    ----------
    polygons : (k, 2) x and z of each block in m, either way round
    tolerance : m; None for 1e-5 of the mean size (square root of the area) of the blocks

    Raises
    ------
    GeometryError
        E228 an outline has fewer than three corners, or a corner that is no number; E230 the tolerance is not more than
        0, or no smaller than a tenth of a block.
    """
    arrays = [np.asarray(polygon, dtype=np.float64) for polygon in polygons]
    faults = [
        Fault("E228", f"the outline of {name} is no list of three corners x, z or more, all of them numbers")
        for name, array in zip(names, arrays, strict=True)
        if array.ndim != 2 or array.shape[1:] != (2,) or len(array) < 3 or not np.isfinite(array).all()
    ]
    if not arrays:
        faults.append(Fault("E228", "there are no blocks"))
    refuse(faults)
    corners = np.concatenate(arrays)
    start = np.concatenate([[0], np.cumsum([len(array) for array in arrays])])
    origin = np.round((corners.min(axis=0) + corners.max(axis=0)) / 2.0)
    rounding = 8.0 * float(np.spacing(np.abs(corners).max()))
    corners = corners - origin
    areas, centroids = _areas(corners, start)
    block = np.repeat(np.arange(len(arrays)), np.diff(start))
    # the corners of a clockwise outline in reverse order
    index = np.arange(len(corners))
    corners = corners[np.where(areas[block] < 0.0, start[block] + start[block + 1] - 1 - index, index)]
    tolerance = contact_tolerance(tolerance, np.sqrt(np.abs(areas)), rounding)
    corners, start = _cleaned(corners, start, max(_SAME * tolerance, rounding / 8.0))
    refuse(
        [
            Fault("E228", f"the outline of {names[k]} encloses no area")
            for k in np.flatnonzero(np.diff(start) < 3).tolist()
        ]
    )
    return Outlines(origin, corners, start, np.abs(areas), centroids), tolerance


def check_outlines(outlines: Outlines, tolerance: float, crossing: Ints, names: Sequence[str]) -> None:
    """Refuse outlines that cross themselves (`crossing`: their blocks), enclose nothing or less than the tolerance.

    Raises
    ------
    GeometryError
        E227, E228, E230.
    """
    crosses = np.zeros(len(outlines), dtype=bool)
    crosses[crossing] = True
    empty = ~crosses & (outlines.areas <= tolerance * tolerance)
    advice = "The corners go round the block once, each edge to the next corner."
    faults = [
        Fault("E227", f"the outline of {names[block]} crosses or touches itself", "", advice)
        for block in np.flatnonzero(crosses).tolist()
    ]
    faults += [
        Fault("E228", f"the outline of {names[block]} encloses no area") for block in np.flatnonzero(empty).tolist()
    ]
    refuse(faults + size_faults(np.where(crosses | empty, np.inf, np.sqrt(outlines.areas)), tolerance, names))


def convex_pieces(outlines: Outlines) -> tuple[Floats, Ints, Ints]:
    """Convex pieces of the blocks: corners (p, k, 2) filled up with their last, how many (p,), and their blocks (p,).

    A convex block of few corners is its own piece, others are cut into triangles.
    """
    sizes = np.diff(outlines.start)
    whole = outlines.are_convex() & (sizes <= _LARGEST_PIECE)
    rows = []
    blocks = [np.flatnonzero(whole)]
    counts = [sizes[whole]]
    for block in np.flatnonzero(~whole).tolist():
        first, last = outlines.start[block], outlines.start[block + 1]
        triangles = np.asarray(triangulate([outlines.corners[first:last]]), dtype=np.int64)
        rows.append(triangles + first)
        blocks.append(np.full(len(triangles), block))
        counts.append(np.full(len(triangles), 3))
    count = np.concatenate(counts)
    width = int(count.max())
    place = np.minimum(np.arange(width), sizes[whole][:, None] - 1) + outlines.start[:-1][whole][:, None]
    split = [np.pad(row, ((0, 0), (0, width - 3)), mode="edge") for row in rows]
    return outlines.corners[np.concatenate([place, *split])], count, np.concatenate(blocks)


def _neighbours(start: Ints) -> tuple[Ints, Ints]:
    """The corner before and the corner after each."""
    index = np.arange(start[-1])
    before, after = index - 1, index + 1
    used = np.diff(start) > 0
    first, last = start[:-1][used], start[1:][used] - 1
    before[first], after[last] = last, first
    return before, after


def _areas(corners: Floats, start: Ints) -> tuple[Floats, Floats]:
    """Areas, positive anticlockwise, and centroids; each outline about its own first corner."""
    base = np.repeat(corners[start[:-1]], np.diff(start), axis=0)
    here, after = corners - base, corners[_neighbours(start)[1]] - base
    cross = here[:, 0] * after[:, 1] - here[:, 1] * after[:, 0]
    doubled = np.add.reduceat(cross, start[:-1])
    moment = np.add.reduceat((here + after) * cross[:, None], start[:-1]) / 3.0
    safe = np.where(doubled == 0.0, 1.0, doubled)
    return doubled / 2.0, moment / safe[:, None] + corners[start[:-1]]


def _cleaned(corners: Floats, start: Ints, distance: float) -> tuple[Floats, Ints]:
    """Drop repeated corners, corners on a straight line and spikes; never two neighbours at once."""
    phase, idle = 0, 0
    while idle < 3:
        before, after = _neighbours(start)
        step, span = corners[after] - corners, corners[after] - corners[before]
        length = np.sqrt((span * span).sum(axis=1))
        across = np.abs(span[:, 0] * step[:, 1] - span[:, 1] * step[:, 0])
        repeated = (step * step).sum(axis=1) <= distance * distance
        block = np.repeat(np.arange(len(start) - 1), np.diff(start))
        index = np.arange(len(corners))
        # even corners, odd ones, and the last on its own: it may be even and has the first beside it
        turn = np.where(start[block + 1] - 1 == index, 2, (index - start[block]) % 2)
        dropped = (repeated | (across <= distance * length)) & (turn == phase)
        corners = corners[~dropped]
        start = np.concatenate([[0], np.cumsum(np.bincount(block[~dropped], minlength=len(start) - 1))])
        idle = 0 if dropped.any() else idle + 1
        phase = (phase + 1) % 3
    return corners, start
