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
    refuse,
    size_faults,
    widest_rounding,
)
from slopekit.geometry.patches import Assembly, Patches
from slopekit.geometry.rock.box_search import box_pairs
from slopekit.geometry.sections.clipping import are_apart, clip_convex, polygon_sums
from slopekit.geometry.tolerances import DOUBT, NEARLY_TOUCHES, OPPOSITE, OUTLINE_CLEAN, TINY, TURNED_BY_ROUNDING

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
    corners = corners[np.where(areas[block] < 0.0, start[block] + start[block + 1] - 1 - index, index)]
    tolerance = contact_tolerance(tolerance, np.sqrt(np.abs(areas)), rounding)
    corners, start = _cleaned(corners, start, max(OUTLINE_CLEAN * tolerance, rounding / 8.0))
    refuse(
        [
            Fault("E227", f"the outline of {names[k]} encloses no area")
            for k in np.flatnonzero(np.diff(start) < 3).tolist()
        ]
    )
    return Outlines(origin, corners, start, np.abs(areas), centroids), tolerance


def check_outlines(outlines: Outlines, tolerance: float, crossing: Ints, names: Sequence[str]) -> None:
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


def section_assembly(
    polygons: Sequence[Floats], fixed: Bools, thickness: float, tolerance: float | None = None,
    names: Sequence[str] | None = None,
) -> BlocksCut:  # fmt: skip
    """The blocks of a section and their contacts.

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
    called = list(names) if names is not None else [f"block {k + 1}" for k in range(len(polygons))]
    outlines, usual = clean_outlines(polygons, tolerance, called)
    unit = corner_unit(np.concatenate([np.ravel(polygon) for polygon in polygons])) if tolerance is None else 0.0
    bedrock = np.asarray(fixed, dtype=bool)
    sizes = np.sqrt(outlines.areas)
    reach = NEARLY_TOUCHES * float(sizes.mean())
    edges = _OutlineEdges(outlines, bedrock)
    around = np.bincount(edges.block, edges.length)
    widest = widest_rounding(sizes, 2.0 * outlines.areas / around)
    first, second = edges.candidates(max(reach, DOUBT * max(usual, widest)))
    own = edges.block[first] == edges.block[second]
    crossing = edges.crossing(first[own], second[own], OUTLINE_CLEAN * usual / 2.0)
    check_outlines(outlines, usual, crossing, called)
    first, second = first[~own], second[~own]

    faced = edges.facing(first, second)
    movable = ~bedrock[faced.plus] | ~bedrock[faced.minus]
    contact = fitting_tolerance(usual, unit, 2, widest, faced, movable)
    tolerance = contact.distance
    touches = faced.touches(tolerance, tolerance)
    patches = _patches(faced, touches, outlines.origin, thickness)
    pieces, counts, owner = convex_pieces(outlines)
    near = movable & faced.nearly_touches(tolerance, reach)
    near[near] = ~_filled(faced, near, pieces, owner, tolerance)
    empty = np.zeros((0, 3))
    centroids = _in_space(outlines.centroids + outlines.origin)
    assembly = Assembly(
        frozen(outlines.areas * thickness), frozen(centroids), bedrock, patches, True, frozen(empty),
        empty.astype(np.int64), np.zeros(0, dtype=np.int64),
    )  # fmt: skip
    return BlocksCut(
        assembly,
        contact,
        float(faced.breadth[touches].sum()),
        _overlaps(pieces, counts, owner, bedrock, tolerance),
        Misfits(faced.pairs[near], frozen(faced.breadth[near]), frozen(faced.most[near])),
        tuple(frozen(outlines.outline(k)) for k in range(len(outlines))),
        edges.point_contacts(first, second, tolerance, patches),
    )


@dataclass(frozen=True)
class _FacingEdges(Facing):
    """Pairs of edges that run opposite ways beside each other.

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
        self.after, self.block, self.fixed = outlines.after, outlines.block, fixed
        self.start = outlines.corners
        self.end = self.start[self.after]
        along = self.end - self.start
        self.length = np.sqrt((along * along).sum(axis=1))
        self.direction = along / self.length[:, None]
        self.convex = outlines.are_convex()[self.block]

    def candidates(self, reach: float) -> tuple[Ints, Ints]:
        """Pairs of edges whose boxes come within `reach`, but for those of one convex block."""
        low, high = np.minimum(self.start, self.end) - reach / 2.0, np.maximum(self.start, self.end) + reach / 2.0
        first, second = box_pairs(low, high)
        wanted = (self.block[first] != self.block[second]) | ~self.convex[first]
        return first[wanted], second[wanted]

    def crossing(self, first: Ints, second: Ints, distance: float) -> Ints:
        """Blocks of which two edges that are not neighbours cross or come within `distance`."""
        apart = (self.after[first] != second) & (self.after[second] != first)
        a, b = first[apart], second[apart]
        ends = [(a, self.start[b]), (a, self.end[b]), (b, self.start[a]), (b, self.end[a])]
        sides = [self._across(edge, point) for edge, point in ends]
        meets = (sides[0] * sides[1] < 0.0) & (sides[2] * sides[3] < 0.0)
        for edge, point in ends:
            meets |= self._distance(edge, point) <= distance
        return np.unique(self.block[a[meets]])

    def facing(self, first: Ints, second: Ints) -> _FacingEdges:
        """What pairs of edges share that run opposite ways."""
        opposite = (self.direction[first] * self.direction[second]).sum(axis=1) < OPPOSITE
        first, second = first[opposite], second[opposite]
        later = self.block[first] > self.block[second]
        turned = np.where(self.fixed[self.block[first]] == self.fixed[self.block[second]], later,
                          ~self.fixed[self.block[first]])  # fmt: skip
        plus, minus = np.where(turned, first, second), np.where(turned, second, first)
        along, back = self.direction[minus], -self.direction[plus]
        is_turned = np.abs(along[:, 0] * back[:, 1] - along[:, 1] * back[:, 0]) > TURNED_BY_ROUNDING
        # of two edges that rounded corners have turned that of the longer above all: it is turned less
        power = np.where(is_turned, 2.0, 0.0)
        mean = (self.length[minus] ** power)[:, None] * along + (self.length[plus] ** power)[:, None] * back
        mean /= np.sqrt((mean * mean).sum(axis=1))[:, None]
        normal = np.stack([mean[:, 1], -mean[:, 0]], axis=1)  # out of the minus block, to the right of its edge
        base = self.start[minus]
        reach = [((corner - base) * mean).sum(axis=1) for corner in (self.end[minus], self.end[plus], self.start[plus])]
        lower, upper = np.maximum(0.0, reach[1]), np.minimum(reach[0], reach[2])
        shared = upper > lower
        plus, minus, mean, normal, base = plus[shared], minus[shared], mean[shared], normal[shared], base[shared]
        places = np.stack([lower[shared], upper[shared]], axis=1)
        off_minus = places * self._slope(minus, mean, normal)[:, None]
        far = self.end[plus] - base
        off_plus = (far * normal).sum(axis=1)[:, None] + (places - (far * mean).sum(axis=1)[:, None]) * (
            self._slope(plus, mean, normal)[:, None]
        )
        apart = off_plus - off_minus
        middle = (off_plus + off_minus) / 2.0
        ends = base[:, None] + places[:, :, None] * mean[:, None] + middle[:, :, None] * normal[:, None]
        return _FacingEdges(
            self.block[plus], self.block[minus], apart.min(axis=1), apart.max(axis=1), places[:, 1] - places[:, 0],
            ends, normal,
        )  # fmt: skip

    def point_contacts(self, first: Ints, second: Ints, tolerance: float, patches: Patches) -> int:
        """How many pairs of blocks touch in a corner and share no patch."""
        count = len(self.fixed)
        edge, other = np.concatenate([first, second]), np.concatenate([second, first])
        touches = self._distance(edge, self.start[other]) <= tolerance
        a, b = self.block[edge[touches]], self.block[other[touches]]
        with_patch = np.minimum(patches.plus, patches.minus) * count + np.maximum(patches.plus, patches.minus)
        return len(np.setdiff1d(np.minimum(a, b) * count + np.maximum(a, b), with_patch))

    def _slope(self, edge: Ints, mean: Floats, normal: Floats) -> Floats:
        """How much an edge rises along `normal` per length along `mean`."""
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
        away = step - place[:, None] * self.direction[edge]
        distance: Floats = np.sqrt((away * away).sum(axis=1))
        return distance


def _in_space(points: Floats) -> Floats:
    """x and z (..., 2) as x, y = 0 and z."""
    return np.stack([points[..., 0], np.zeros(points.shape[:-1]), points[..., 1]], axis=-1)


def _patches(faced: _FacingEdges, touches: Bools, origin: Floats, thickness: float) -> Patches:
    order = np.flatnonzero(touches)
    order = order[np.lexsort((faced.plus[order], faced.minus[order]))]
    corners = _in_space(faced.ends[order] + origin)
    count = len(order)
    return Patches(
        faced.plus[order], faced.minus[order], np.zeros(count, dtype=np.int64), frozen(_in_space(faced.normal[order])),
        frozen(faced.breadth[order] * thickness), frozen(corners.mean(axis=1)), frozen(corners.reshape(-1, 3)),
        2 * np.arange(count + 1),
    )  # fmt: skip


def _filled(faced: _FacingEdges, near: Bools, pieces: Floats, owner: Ints, tolerance: float) -> Bools:
    """Whether the middle of a gap lies in a third block: what fills a thin joint is no gap."""
    middle = faced.ends[near].mean(axis=1)
    filled = np.zeros(len(middle), dtype=bool)
    if len(middle):
        lowest = np.concatenate([pieces.min(axis=1), middle])
        highest = np.concatenate([pieces.max(axis=1), middle])
        piece, point = box_pairs(lowest, highest)
        mixed = (piece < len(pieces)) & (point >= len(pieces))
        piece, point = piece[mixed], point[mixed] - len(pieces)
        third = (owner[piece] != faced.plus[near][point]) & (owner[piece] != faced.minus[near][point])
        piece, point = piece[third], point[third]
        filled[point[~are_apart(pieces[piece], middle[point][:, None], tolerance)]] = True
    return filled


def _overlaps(pieces: Floats, counts: Ints, owner: Ints, fixed: Bools, tolerance: float) -> Misfits:
    lowest, highest = pieces.min(axis=1) + tolerance / 2.0, pieces.max(axis=1) - tolerance / 2.0
    first, second = box_pairs(lowest, np.maximum(lowest, highest))
    a, b = owner[first], owner[second]
    wanted = (a != b) & ~(fixed[a] & fixed[b])
    first, second = first[wanted], second[wanted]
    wanted = ~are_apart(pieces[first], pieces[second], tolerance)
    first, second = first[wanted], second[wanted]
    shared, corners = clip_convex(pieces[first], counts[first], pieces[second])
    areas, _, around = polygon_sums(shared, corners)
    a, b = np.minimum(owner[first], owner[second]), np.maximum(owner[first], owner[second])
    pair, which = np.unique(a * len(fixed) + b, return_inverse=True)
    area: Floats = np.bincount(which, areas, minlength=len(pair)).astype(np.float64)
    boundary = np.bincount(which, around, minlength=len(pair))
    depth = area / np.maximum(boundary / 2.0, TINY)
    return Misfits(np.stack([pair // len(fixed), pair % len(fixed)], axis=1), frozen(area), frozen(depth))
