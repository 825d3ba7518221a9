"""The user's own blocks as polygons of a vertical section: where they touch, overlap, or nearly touch.

Edges of two blocks that run opposite ways along one line share a contact: a segment patch. The candidates come from
the boxes of the edges (`box_search`), everything else is done for all of them at once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from manifold3d import triangulate

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import Fault
from slopekit.geometry.fit import (
    BlocksCut,
    Facing,
    Misfits,
    contact_tolerance,
    corner_unit,
    fitting_tolerance,
    raise_faults,
    size_faults,
    widest_rounding,
)
from slopekit.geometry.patches import Assembly, Patches
from slopekit.geometry.rock.box_search import box_pairs
from slopekit.geometry.sections.clipping import are_separate, clip_convex, polygon_sums
from slopekit.geometry.tolerances import (
    DOUBT,
    NEARLY_TOUCHES,
    OPPOSITE,
    OUTLINE_CLEAN,
    TINY,
    TURNED_BY_ROUNDING,
)

_LARGEST_PIECE = 8  # corners of a convex polygon that is clipped whole; more are cut into triangles


@dataclass(frozen=True)
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
        """The block of each corner, and of the edge that begins there, (c,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    @property
    def following(self) -> Ints:
        """The next corner of each corner, (c,)."""
        return _neighbours(self.start)[1]

    def outline(self, block: int) -> Floats:
        """Return the corners (k, 2) m of a block in the user's coordinates."""
        return np.asarray(
            self.corners[self.start[block] : self.start[block + 1]] + self.origin, dtype=np.float64
        )

    def are_convex(self) -> Bools:
        """Return whether each outline (n,) turns left at every corner and once round in all."""
        previous, following = _neighbours(self.start)
        along, last = self.corners[following] - self.corners, self.corners - self.corners[previous]
        turn = np.arctan2(
            last[:, 0] * along[:, 1] - last[:, 1] * along[:, 0],
            last[:, 0] * along[:, 0] + last[:, 1] * along[:, 1],
        )
        turns_once = np.add.reduceat(turn, self.start[:-1]) < 3.0 * np.pi
        return np.asarray(turns_once & (np.minimum.reduceat(turn, self.start[:-1]) > 0.0))


def clean_outlines(
    polygons: Sequence[Floats], tolerance: float | None, names: Sequence[str]
) -> tuple[Outlines, float]:
    """Return outlines without repeated corners and corners on a straight edge, and the contact tolerance (m).

    Parameters
    ----------
    polygons : (k, 2) x and z of each block in m, either way round
    tolerance : m; None for 1e-5 of the mean size (square root of the area) of the blocks

    Raises
    ------
    GeometryError
        E227 an outline encloses no area.
    """
    arrays = [np.asarray(polygon, dtype=np.float64) for polygon in polygons]
    corners = np.concatenate(arrays)
    start = np.concatenate([[0], np.cumsum([len(array) for array in arrays])])
    origin = np.round((corners.min(axis=0) + corners.max(axis=0)) / 2.0)
    rounding = 8.0 * float(np.spacing(np.abs(corners).max()))
    corners = corners - origin
    areas, centroids = _areas(corners, start)
    block = np.repeat(np.arange(len(arrays)), np.diff(start))
    # the corners of a clockwise outline in reverse order
    index = np.arange(len(corners))
    corners = corners[
        np.where(areas[block] < 0.0, start[block] + start[block + 1] - 1 - index, index)
    ]
    tolerance = contact_tolerance(tolerance, np.sqrt(np.abs(areas)), rounding)
    corners, start = _cleaned(corners, start, max(OUTLINE_CLEAN * tolerance, rounding / 8.0))
    raise_faults(
        [
            Fault("E227", f"the outline of {names[k]} encloses no area")
            for k in np.flatnonzero(np.diff(start) < 3).tolist()
        ]
    )
    return Outlines(origin, corners, start, np.abs(areas), centroids), tolerance


def check_outlines(
    outlines: Outlines, tolerance: float, crossing: Ints, names: Sequence[str]
) -> None:
    """Refuse outlines that cross themselves (`crossing`: their blocks), enclose nothing or less than the tolerance.

    Raises
    ------
    GeometryError
        E227, E230.
    """
    crosses = np.zeros(len(outlines), dtype=bool)
    crosses[crossing] = True
    empty = ~crosses & (outlines.areas <= tolerance * tolerance)
    advice = "The corners go round the block once, each edge to the next corner."
    faults = [
        Fault("E227", f"the outline of {names[block]} crosses or touches itself", "", advice)
        for block in np.flatnonzero(crosses).tolist()
    ]
    small = f"Up to {tolerance * tolerance:.3g} m² count as none: the contact tolerance is {tolerance:.3g} m."
    faults += [
        Fault("E227", f"the outline of {names[block]} encloses no area", "", small)
        for block in np.flatnonzero(empty).tolist()
    ]
    raise_faults(
        faults
        + size_faults(np.where(crosses | empty, np.inf, np.sqrt(outlines.areas)), tolerance, names)
    )


def convex_pieces(outlines: Outlines) -> tuple[Floats, Ints, Ints]:
    """Return convex pieces of the blocks: corners (p, k, 2) padded with the last, their counts (p,) and blocks (p,).

    A convex block of few corners is its own piece, others are cut into triangles.
    """
    sizes = np.diff(outlines.start)
    is_whole = outlines.are_convex() & (sizes <= _LARGEST_PIECE)
    rows = []
    blocks = [np.flatnonzero(is_whole)]
    counts = [sizes[is_whole]]
    for block in np.flatnonzero(~is_whole).tolist():
        first, last = outlines.start[block], outlines.start[block + 1]
        triangles = np.asarray(triangulate([outlines.corners[first:last]]), dtype=np.int64)
        rows.append(triangles + first)
        blocks.append(np.full(len(triangles), block))
        counts.append(np.full(len(triangles), 3))
    count = np.concatenate(counts)
    width = int(count.max())
    place = (
        np.minimum(np.arange(width), sizes[is_whole][:, None] - 1)
        + outlines.start[:-1][is_whole][:, None]
    )
    split = [np.pad(row, ((0, 0), (0, width - 3)), mode="edge") for row in rows]
    return outlines.corners[np.concatenate([place, *split])], count, np.concatenate(blocks)


def _neighbours(start: Ints) -> tuple[Ints, Ints]:
    """Return the previous and the next corner of each corner round its outline."""
    index = np.arange(start[-1])
    previous, following = index - 1, index + 1
    used = np.diff(start) > 0
    first, last = start[:-1][used], start[1:][used] - 1
    previous[first], following[last] = last, first
    return previous, following


def _areas(corners: Floats, start: Ints) -> tuple[Floats, Floats]:
    """Return the areas (n,) m², positive anticlockwise, and centroids (n, 2) m of outlines."""
    base = np.repeat(corners[start[:-1]], np.diff(start), axis=0)
    arm, next_arm = corners - base, corners[_neighbours(start)[1]] - base
    cross = arm[:, 0] * next_arm[:, 1] - arm[:, 1] * next_arm[:, 0]
    doubled = np.add.reduceat(cross, start[:-1])
    moment = np.add.reduceat((arm + next_arm) * cross[:, None], start[:-1]) / 3.0
    safe = np.where(doubled == 0.0, 1.0, doubled)
    return doubled / 2.0, moment / safe[:, None] + corners[start[:-1]]


def _cleaned(corners: Floats, start: Ints, distance: float) -> tuple[Floats, Ints]:
    """Drop repeated corners, corners on a straight line and spikes; never two neighbours at once."""
    phase, idle = 0, 0
    while idle < 3:
        previous, following = _neighbours(start)
        step, span = corners[following] - corners, corners[following] - corners[previous]
        length = np.sqrt((span * span).sum(axis=1))
        across = np.abs(span[:, 0] * step[:, 1] - span[:, 1] * step[:, 0])
        repeated = (step * step).sum(axis=1) <= distance * distance
        block = np.repeat(np.arange(len(start) - 1), np.diff(start))
        index = np.arange(len(corners))
        # even corners, odd corners, and the last alone: it may be even, and its neighbour is the first
        turn = np.where(start[block + 1] - 1 == index, 2, (index - start[block]) % 2)
        dropped = (repeated | (across <= distance * length)) & (turn == phase)
        corners = corners[~dropped]
        start = np.concatenate(
            [[0], np.cumsum(np.bincount(block[~dropped], minlength=len(start) - 1))]
        )
        idle = 0 if dropped.any() else idle + 1
        phase = (phase + 1) % 3
    return corners, start


def section_assembly(
    polygons: Sequence[Floats],
    fixed: Bools,
    thickness: float,
    tolerance: float | None = None,
    names: Sequence[str] | None = None,
) -> BlocksCut:
    """Return the blocks of a section and their contacts.

    Parameters
    ----------
    polygons : (k, 2) x and z of each block in m, either way round, convex or not
    fixed : (n,) blocks that are bedrock
    thickness : m, along y
    tolerance : m, edges nearer than this touch; None for 1e-5 of the mean size (square root of the area) of the
        blocks, or √2 units of the last decimal of the corners where that loses contacts
    names : of the blocks, for messages

    Raises
    ------
    GeometryError
        E227 an outline crosses itself or encloses no area, E230 the tolerance is as large as a block.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> cut = section_assembly([square, square + [0.5, 1.0]], np.array([True, False]), thickness=2.0)
    >>> cut.assembly.patches.areas.tolist(), cut.assembly.patches.normals.tolist()
    ([1.0], [[0.0, 0.0, 1.0]])
    """
    block_names = (
        list(names) if names is not None else [f"block {k + 1}" for k in range(len(polygons))]
    )
    outlines, exact_tolerance = clean_outlines(polygons, tolerance, block_names)
    unit = (
        corner_unit(np.concatenate([np.ravel(polygon) for polygon in polygons]))
        if tolerance is None
        else 0.0
    )
    bedrock = np.asarray(fixed, dtype=bool)
    sizes = np.sqrt(outlines.areas)
    reach = NEARLY_TOUCHES * float(sizes.mean())
    edges = _OutlineEdges(outlines, bedrock)
    perimeters = np.bincount(edges.block, edges.length)
    widest = widest_rounding(sizes, 2.0 * outlines.areas / perimeters)
    first, second = edges.candidates(max(reach, DOUBT * max(exact_tolerance, widest)))
    is_same_block = edges.block[first] == edges.block[second]
    crossing = edges.crossing(
        first[is_same_block], second[is_same_block], OUTLINE_CLEAN * exact_tolerance / 2.0
    )
    check_outlines(outlines, exact_tolerance, crossing, block_names)
    first, second = first[~is_same_block], second[~is_same_block]

    facing = edges.facing(first, second)
    movable = ~bedrock[facing.plus] | ~bedrock[facing.minus]
    contact = fitting_tolerance(exact_tolerance, unit, 2, widest, facing, movable)
    tolerance = contact.distance
    touches = facing.touches(tolerance, tolerance)
    patches = _patches(facing, touches, outlines.origin, thickness)
    pieces, counts, owner = convex_pieces(outlines)
    is_gap = movable & facing.nearly_touches(tolerance, reach)
    is_gap[is_gap] = ~_filled(facing, is_gap, pieces, owner, tolerance)
    empty = np.zeros((0, 3))
    centroids = _in_space(outlines.centroids + outlines.origin)
    assembly = Assembly(
        frozen(outlines.areas * thickness),
        frozen(centroids),
        bedrock,
        patches,
        True,
        frozen(empty),
        empty.astype(np.int64),
        np.zeros(0, dtype=np.int64),
    )
    return BlocksCut(
        assembly,
        contact,
        float(facing.breadth[touches].sum()),
        _overlaps(pieces, counts, owner, bedrock, tolerance),
        Misfits(facing.pairs[is_gap], frozen(facing.breadth[is_gap]), frozen(facing.most[is_gap])),
        tuple(frozen(outlines.outline(k)) for k in range(len(outlines))),
        edges.point_contacts(first, second, tolerance, patches),
    )


@dataclass(frozen=True)
class _FacingEdges(Facing):
    """Pairs of nearly parallel edges of two blocks that run opposite ways.

    Attributes
    ----------
    ends : (n, 2, 2) m, the ends of the length that they share, halfway between them
    normal : (n, 2) unit, into the plus block
    """

    ends: Floats
    normal: Floats


class _OutlineEdges:
    """All edges of all outlines, the block to the left of each."""

    def __init__(self, outlines: Outlines, fixed: Bools) -> None:
        self.following, self.block, self.fixed = outlines.following, outlines.block, fixed
        self.start = outlines.corners
        self.end = self.start[self.following]
        along = self.end - self.start
        self.length = np.sqrt((along * along).sum(axis=1))
        self.direction = along / self.length[:, None]
        self.convex = outlines.are_convex()[self.block]

    def candidates(self, reach: float) -> tuple[Ints, Ints]:
        """Return pairs of edges whose boxes come within `reach` (m), without pairs of the same convex block."""
        low, high = (
            np.minimum(self.start, self.end) - reach / 2.0,
            np.maximum(self.start, self.end) + reach / 2.0,
        )
        first, second = box_pairs(low, high)
        is_candidate = (self.block[first] != self.block[second]) | ~self.convex[first]
        return first[is_candidate], second[is_candidate]

    def crossing(self, first: Ints, second: Ints, distance: float) -> Ints:
        """Return the blocks of which two edges that are not neighbours cross or come within `distance` (m)."""
        is_separate = (self.following[first] != second) & (self.following[second] != first)
        a, b = first[is_separate], second[is_separate]
        ends = [(a, self.start[b]), (a, self.end[b]), (b, self.start[a]), (b, self.end[a])]
        sides = [self._across(edge, point) for edge, point in ends]
        meets = (sides[0] * sides[1] < 0.0) & (sides[2] * sides[3] < 0.0)
        for edge, point in ends:
            meets |= self._distance(edge, point) <= distance
        return np.unique(self.block[a[meets]])

    def facing(self, first: Ints, second: Ints) -> _FacingEdges:
        """Return the pairs of edges that run opposite ways, with the length that they share."""
        opposite = (self.direction[first] * self.direction[second]).sum(axis=1) < OPPOSITE
        first, second = first[opposite], second[opposite]
        later = self.block[first] > self.block[second]
        is_first_plus = np.where(
            self.fixed[self.block[first]] == self.fixed[self.block[second]],
            later,
            ~self.fixed[self.block[first]],
        )
        plus, minus = np.where(is_first_plus, first, second), np.where(is_first_plus, second, first)
        along, back = self.direction[minus], -self.direction[plus]
        is_turned = np.abs(along[:, 0] * back[:, 1] - along[:, 1] * back[:, 0]) > TURNED_BY_ROUNDING
        # rounding of the corners turns a longer edge less: its direction weighs more
        power = np.where(is_turned, 2.0, 0.0)
        mean = (self.length[minus] ** power)[:, None] * along + (self.length[plus] ** power)[
            :, None
        ] * back
        mean /= np.sqrt((mean * mean).sum(axis=1))[:, None]
        normal = np.stack(
            [mean[:, 1], -mean[:, 0]], axis=1
        )  # out of the minus block, to the right of its edge
        base = self.start[minus]
        reach = [
            ((corner - base) * mean).sum(axis=1)
            for corner in (self.end[minus], self.end[plus], self.start[plus])
        ]
        lower, upper = np.maximum(0.0, reach[1]), np.minimum(reach[0], reach[2])
        shared = upper > lower
        plus, minus, mean, normal, base = (
            plus[shared],
            minus[shared],
            mean[shared],
            normal[shared],
            base[shared],
        )
        places = np.stack([lower[shared], upper[shared]], axis=1)
        minus_height = places * self._slope(minus, mean, normal)[:, None]
        arm = self.end[plus] - base
        plus_height = (arm * normal).sum(axis=1)[:, None] + (
            places - (arm * mean).sum(axis=1)[:, None]
        ) * (self._slope(plus, mean, normal)[:, None])
        gap = plus_height - minus_height
        middle = (plus_height + minus_height) / 2.0
        ends = (
            base[:, None]
            + places[:, :, None] * mean[:, None]
            + middle[:, :, None] * normal[:, None]
        )
        return _FacingEdges(
            self.block[plus],
            self.block[minus],
            gap.min(axis=1),
            gap.max(axis=1),
            places[:, 1] - places[:, 0],
            ends,
            normal,
        )

    def point_contacts(self, first: Ints, second: Ints, tolerance: float, patches: Patches) -> int:
        """Return how many pairs of blocks touch in a corner and share no patch."""
        count = len(self.fixed)
        edge, opposite = np.concatenate([first, second]), np.concatenate([second, first])
        touches = self._distance(edge, self.start[opposite]) <= tolerance
        a, b = self.block[edge[touches]], self.block[opposite[touches]]
        with_patch = np.minimum(patches.plus, patches.minus) * count + np.maximum(
            patches.plus, patches.minus
        )
        return len(np.setdiff1d(np.minimum(a, b) * count + np.maximum(a, b), with_patch))

    def _slope(self, edge: Ints, mean: Floats, normal: Floats) -> Floats:
        """Return the rise of edges along `normal` per length along `mean`, (n,)."""
        direction = self.direction[edge]
        slope: Floats = (direction * normal).sum(axis=1) / (direction * mean).sum(axis=1)
        return slope

    def _across(self, edge: Ints, point: Floats) -> Floats:
        step, along = point - self.start[edge], self.direction[edge]
        across: Floats = along[:, 0] * step[:, 1] - along[:, 1] * step[:, 0]
        return across

    def _distance(self, edge: Ints, point: Floats) -> Floats:
        step = point - self.start[edge]
        place = np.clip((step * self.direction[edge]).sum(axis=1), 0.0, self.length[edge])
        offset = step - place[:, None] * self.direction[edge]
        distance: Floats = np.sqrt((offset * offset).sum(axis=1))
        return distance


def _in_space(points: Floats) -> Floats:
    """Return points x, z (..., 2) of the section as points x, y = 0, z (..., 3) in space."""
    return np.stack([points[..., 0], np.zeros(points.shape[:-1]), points[..., 1]], axis=-1)


def _patches(facing: _FacingEdges, touches: Bools, origin: Floats, thickness: float) -> Patches:
    order = np.flatnonzero(touches)
    order = order[np.lexsort((facing.plus[order], facing.minus[order]))]
    corners = _in_space(facing.ends[order] + origin)
    count = len(order)
    return Patches(
        facing.plus[order],
        facing.minus[order],
        np.zeros(count, dtype=np.int64),
        frozen(_in_space(facing.normal[order])),
        frozen(facing.breadth[order] * thickness),
        frozen(corners.mean(axis=1)),
        frozen(corners.reshape(-1, 3)),
        2 * np.arange(count + 1),
    )


def _filled(
    facing: _FacingEdges, is_gap: Bools, pieces: Floats, owner: Ints, tolerance: float
) -> Bools:
    """Return whether the middle of each gap lies in a third block: a filled joint is no gap."""
    middle = facing.ends[is_gap].mean(axis=1)
    filled = np.zeros(len(middle), dtype=bool)
    if len(middle):
        lowest = np.concatenate([pieces.min(axis=1), middle])
        highest = np.concatenate([pieces.max(axis=1), middle])
        piece, point = box_pairs(lowest, highest)
        mixed = (piece < len(pieces)) & (point >= len(pieces))
        piece, point = piece[mixed], point[mixed] - len(pieces)
        third = (owner[piece] != facing.plus[is_gap][point]) & (
            owner[piece] != facing.minus[is_gap][point]
        )
        piece, point = piece[third], point[third]
        filled[point[~are_separate(pieces[piece], middle[point][:, None], tolerance)]] = True
    return filled


def _overlaps(pieces: Floats, counts: Ints, owner: Ints, fixed: Bools, tolerance: float) -> Misfits:
    lowest, highest = pieces.min(axis=1) + tolerance / 2.0, pieces.max(axis=1) - tolerance / 2.0
    first, second = box_pairs(lowest, np.maximum(lowest, highest))
    a, b = owner[first], owner[second]
    is_candidate = (a != b) & ~(fixed[a] & fixed[b])
    first, second = first[is_candidate], second[is_candidate]
    is_candidate = ~are_separate(pieces[first], pieces[second], tolerance)
    first, second = first[is_candidate], second[is_candidate]
    shared, corners = clip_convex(pieces[first], counts[first], pieces[second])
    areas, _, perimeters = polygon_sums(shared, corners)
    a, b = np.minimum(owner[first], owner[second]), np.maximum(owner[first], owner[second])
    pair, index = np.unique(a * len(fixed) + b, return_inverse=True)
    area: Floats = np.bincount(index, areas, minlength=len(pair)).astype(np.float64)
    boundary = np.bincount(index, perimeters, minlength=len(pair))
    depth = area / np.maximum(boundary / 2.0, TINY)
    return Misfits(
        np.stack([pair // len(fixed), pair % len(fixed)], axis=1), frozen(area), frozen(depth)
    )
