"""One block on an elastic bed without tension: the forces of flat contacts that are pressed on part of their polygon.

Springs (normal 1, tangential `SHEAR_TO_NORMAL`) are spread evenly over the polygons. With the block's displacement u
the opening g = B_n u and the slip s = B_t u vary linearly over a polygon. What is pressed (g < 0) carries σ = -g and
has all of its cohesion; what is open has none and carries nothing:

    N = -g a,   T = -k s a, cut back to λ (c + σ tan φ) a,   ∫ (B_nᵀ N + B_tᵀ T) + P + λ P_bolts = 0,   λ = 1/F

a is area. Pressed parts are clipped out of their polygons along the line of zero traction, so that the normal forces
and their moments are exact; the shear is summed over triangles (vertices 1/12, middle 3/4: exact where all of a contact
slips one way). Where the pressed part grows its shear grows with it: the slopes have a term along the zero line.
"""

import math
from collections.abc import Iterator, Mapping
from functools import cache

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.core.records import dataclass
from slopekit.preie.contact import SHEAR_TO_NORMAL
from slopekit.preie.model import Model, local_axes
from slopekit.preie.tolerances import NOT_DRAWN_ON_BED, TINY
from slopekit.strength.mohr_coulomb import line

BOLT_GIVE = 1e-2  # passive bolts pull fully once drawn out by this part of the bonded displacement


@dataclass(frozen=True, slots=True)
class PolygonBed:
    """Flat contacts of one block in the scaled units of its model.

    Attributes
    ----------
    corners : per contact (k, 3), arms about the centroid; k = 2 is a line of a vertical section
    axes : (m, 3, 3) normal (into the block) and two tangents of each contact
    area : (m,) control area per unit of area (of length, in a section)
    cohesion : (m,) per control area, in parts of the load; tan_friction : (m,)
    keys : (m,) interface of each contact
    load : (u,) P; bolt_rows : (b, u); bolt_capacity : (b,)
    columns : (u,) which of the six motions are unknowns
    """

    corners: tuple[Floats, ...]
    axes: Floats
    area: Floats
    cohesion: Floats
    tan_friction: Floats
    keys: Ints
    load: Floats
    bolt_rows: Floats
    bolt_capacity: Floats
    columns: Ints

    def corner_rows(self, k: int) -> Floats:
        """Motions (j, 3, u) of the corners of one contact per unknown: opening and two slips."""
        corners, axes = self.corners[k], self.axes[k]
        turning = np.stack([cross(corners, axis) for axis in axes], axis=1)
        return np.concatenate([np.broadcast_to(axes, turning.shape), turning], axis=2)[:, :, self.columns]


@dataclass(frozen=True, slots=True)
class Unbalanced:
    """Unbalanced forces (u,) and their slopes by g (u, u), by s (u, u) and by λ (u,)."""

    out: Floats
    by_opening: Floats
    by_slip: Floats
    by_reduction: Floats


@dataclass(frozen=True, slots=True)
class PointForces:
    """What the points (q) of a bed carry, scaled: `shear` (q, 2) in the local tangents, `pulls` (b,) of the bolts."""

    points: Floats
    area: Floats
    contact: Ints
    normal: Floats
    shear: Floats
    pressed: Bools
    pulls: Floats


class BedSprings:
    """The springs of a bed, their shear summed over triangles that are split in four `split` times."""

    def __init__(self, bed: PolygonBed, split: int) -> None:
        self.bed = bed
        self.rows = [bed.corner_rows(k) for k in range(len(bed.corners))]
        self.templates = {2: _line_template(split), 3: _triangle_template(split)}
        unknowns = len(bed.load)
        stiffness = np.zeros((unknowns, unknowns))
        for k, rows in enumerate(self.rows):
            at, area = self._cells(k, rows, bed.corners[k])
            flat = at.reshape(-1, unknowns)
            stiffness += (flat.T * np.outer(area, [1.0, SHEAR_TO_NORMAL, SHEAR_TO_NORMAL]).ravel()) @ flat
        #: (u, u) stiffness with every point bonded, and the displacement under the loads then
        self.stiffness = stiffness
        self.bonded = np.asarray(np.linalg.lstsq(stiffness, bed.load, rcond=None)[0], dtype=np.float64)
        self.first = math.sqrt(float(self.bonded @ self.bonded))

    def unbalanced(
        self, opening: Floats, slip: Floats, reduction: float, running: bool, sticks: bool = False
    ) -> Unbalanced:
        """The unbalanced forces with openings of one motion and slips of another (the same, unless it runs).

        Parameters
        ----------
        running : every pressed point slips, however small the slip; sticks : none does
        """
        bed, count = self.bed, len(opening)
        out = bed.load.copy()
        by_opening, by_slip, by_reduction = np.zeros((count, count)), np.zeros((count, count)), np.zeros(count)
        turn = np.zeros(6)
        turn[bed.columns] = opening
        for k, rows in enumerate(self.rows):
            gaps = rows[:, 0] @ opening
            weights, chord = _pressed(gaps)
            if weights is None:
                continue
            own = rows if len(weights) == len(rows) and chord is None else np.tensordot(weights, rows, 1)
            at, area = self._cells(k, own, weights @ bed.corners[k])
            normal = -at[:, 0] @ opening
            if chord is not None:
                steep = math.sqrt(float((cross(bed.axes[k, 0], turn[3:]) ** 2).sum()))
                ends = weights[chord] @ bed.corners[k]
                edge, length = _chord(own[chord], ends)
                at = np.concatenate([at, edge])
                normal = np.concatenate([normal, np.zeros(len(edge))])
                # the pressed part grows by -δg / |∇g| along its zero line, and its shear with it
                grows = length * (bed.area[k] / max(steep, TINY))
            across = at[:, 1:] @ slip
            size = np.sqrt((across * across).sum(axis=1))
            strength = line(float(bed.cohesion[k]), float(bed.tan_friction[k]), normal)
            elastic = SHEAR_TO_NORMAL * size
            if sticks:
                slides = np.zeros(len(size), dtype=bool)
            elif running:
                slides = np.ones(len(size), dtype=bool)
            else:
                slides = elastic > reduction * strength
            direction = across / np.maximum(size, TINY)[:, None]
            shear = np.where(slides, reduction * strength, elastic)
            n = len(area)
            normal_rows, shear_rows = at[:n, 0], at[:n, 1:]
            along = np.einsum("qt,qtu->qu", direction, at[:, 1:])
            out += (area * normal[:n]) @ normal_rows - (area * shear[:n]) @ along[:n]
            by_opening -= (normal_rows.T * area) @ normal_rows
            sliding = area * slides[:n]
            by_opening += (along[:n].T * (sliding * reduction * bed.tan_friction[k])) @ normal_rows
            by_reduction -= (sliding * strength[:n]) @ along[:n]
            turning = area * np.where(slides[:n], shear[:n] / np.maximum(size[:n], TINY), SHEAR_TO_NORMAL)
            flat = shear_rows.reshape(-1, count)
            by_slip -= (flat.T * np.repeat(turning, 2)) @ flat
            by_slip += (along[:n].T * np.where(slides[:n], turning, 0.0)) @ along[:n]
            if chord is not None:
                by_opening += (along[n:].T * (grows * shear[n:])) @ at[n:, 0]
        if len(bed.bolt_capacity):
            drawn = -bed.bolt_rows @ slip
            if running:
                pull, spring = np.where(drawn > NOT_DRAWN_ON_BED, 1.0, 0.0), np.zeros(len(drawn))
                out += (reduction * bed.bolt_capacity * pull) @ bed.bolt_rows
                by_reduction += (bed.bolt_capacity * pull) @ bed.bolt_rows
            else:
                give = BOLT_GIVE * self.first
                stiff = bed.bolt_capacity / give
                full = drawn * stiff > reduction * bed.bolt_capacity
                if sticks:
                    full = np.zeros(len(drawn), dtype=bool)
                spring = np.where((drawn > 0.0) & ~full, stiff, 0.0)
                out += (np.where(full, reduction * bed.bolt_capacity, spring * drawn)) @ bed.bolt_rows
                by_reduction += np.where(full, bed.bolt_capacity, 0.0) @ bed.bolt_rows
            by_slip -= (bed.bolt_rows.T * spring) @ bed.bolt_rows
        return Unbalanced(out, by_opening, by_slip, by_reduction)

    def carried(self, opening: Floats, slip: Floats, reduction: float, running: bool) -> "PointForces":
        """The forces point by point, pressed parts first to last contact, then the points of their open parts."""
        bed, none = self.bed, np.zeros(0)
        by_contact: list[tuple[Floats, ...]] = []
        for k, rows in enumerate(self.rows):
            gaps = rows[:, 0] @ opening
            for open_part in (False, True):
                weights, _ = _pressed(-gaps if open_part else gaps)
                if weights is None:
                    continue
                corners = weights @ bed.corners[k]
                at, area = self._cells(k, np.tensordot(weights, rows, 1), corners)
                normal = np.zeros(len(area)) if open_part else np.maximum(-at[:, 0] @ opening, 0.0)
                across = at[:, 1:] @ slip
                size = np.maximum(np.sqrt((across * across).sum(axis=1)), TINY)
                cap = reduction * (line(float(bed.cohesion[k]), float(bed.tan_friction[k]), normal))
                shear = cap if running else np.minimum(SHEAR_TO_NORMAL * size, cap)
                shear = np.zeros(len(area)) if open_part else shear * area
                by_contact.append((
                    self._places(corners), area, np.full(len(area), k), normal * area,
                    -(shear / size)[:, None] * across, np.full(len(area), not open_part),
                ))  # fmt: skip
        points, area, contact, normal, shear, pressed = (np.concatenate(part) for part in zip(*by_contact, strict=True))
        pulls = none
        if len(bed.bolt_capacity):
            drawn, most = -bed.bolt_rows @ slip, reduction * bed.bolt_capacity
            stiff = bed.bolt_capacity / (BOLT_GIVE * self.first)
            pulls = np.where(drawn > NOT_DRAWN_ON_BED, most, 0.0) if running else np.clip(stiff * drawn, 0.0, most)
        return PointForces(points, area, contact, normal, shear, pressed, pulls)

    def _places(self, corners: Floats) -> Floats:
        """Where the points of `_cells` lie."""
        cells = _fan(corners)
        return (self.templates[cells.shape[1]][0] @ cells).reshape(-1, 3)

    def _cells(self, k: int, rows: Floats, corners: Floats) -> tuple[Floats, Floats]:
        """Motions (q, 3, u) and areas (q,) at the points of a pressed part."""
        cells = _fan(corners)
        points, weights = self.templates[cells.shape[1]]
        sides = cells[:, 1:] - cells[:, :1]
        if cells.shape[1] == 2:
            size = np.sqrt((sides * sides).sum(axis=(1, 2)))
        else:
            double = cross(sides[:, 0], sides[:, 1])
            size = 0.5 * np.sqrt((double * double).sum(axis=1))
        at = points @ _fan(rows.reshape(len(rows), -1))
        return at.reshape(-1, 3, rows.shape[2]), ((size * self.bed.area[k])[:, None] * weights).ravel()


def bed_of(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> PolygonBed:
    """The contacts of one block on bedrock as an elastic bed.

    Parameters
    ----------
    model : of the block, from node pairs on these polygons, for its strengths, loads and units
    polygons : interface -> (k, 3) corners in m, as for `node_pairs`, or (2, 3) ends of a line in a section
    centroid : (3,) m
    """
    keys = np.array(sorted(polygons))
    first = np.array([int(np.flatnonzero(model.interface == key)[0]) for key in keys])
    unknowns, in_section = model.unknowns, model.translations == 2
    columns = np.array([0, 2, 4])[:unknowns] if in_section else np.arange(unknowns)
    corners, axes, area = [], [], []
    for key, at in zip(keys, first, strict=True):
        scaled = (np.asarray(polygons[int(key)]) - centroid) / model.length_scale
        if in_section:
            way = scaled[1] - scaled[0]
            normal = np.array([way[2], 0.0, -way[0]]) / math.sqrt(float(way @ way))
        else:
            normal = -_vector_area(scaled)
            normal = normal / math.sqrt(float(normal @ normal))
        if float(normal[columns[: model.translations]] @ model.rows[at, 0, : model.translations]) < 0.0:
            normal = -normal
        corners.append(scaled)
        axes.append(local_axes(normal[None])[0])
        own = float(model.control_area[model.interface == key].sum())
        area.append(own / _size(scaled))
    per_share = model.cohesion[first] / model.control_area[first]
    if model.lines is not None:
        from slopekit.preie.strength_lines import averaged  # a contact of curved strength: one line all over it

        model = averaged(model)
    return PolygonBed(
        tuple(corners), np.array(axes), np.array(area), per_share, model.tan_friction[first], keys, model.load,
        model.bolt_rows, model.bolt_capacity, columns,
    )  # fmt: skip


# -- polygons -----------------------------------------------------------------------------------------------


def _pressed(gaps: Floats) -> tuple[Floats | None, list[int] | None]:
    """The pressed part (g < 0) of a convex polygon: its corners as weights (j, k) of the old ones, and its new edge.

    The new edge is given by its one or two corners; None where nothing is cut off. A line (k = 2) has one.
    """
    count = len(gaps)
    if gaps.max() <= 0.0:
        return np.eye(count), None
    if gaps.min() >= 0.0:
        return None, None
    rows, chord = [], []
    for k in range(count):
        after = (k + 1) % count
        if gaps[k] < 0.0:
            rows.append(_one(count, k))
        if (gaps[k] < 0.0) != (gaps[after] < 0.0) and (count > 2 or k == 0):
            part = float(gaps[k] / (gaps[k] - gaps[after]))
            chord.append(len(rows))
            rows.append((1.0 - part) * _one(count, k) + part * _one(count, after))
    return np.array(rows), chord


def _fan(corners: Floats) -> Floats:
    """Cells (t, 3, d) of a polygon by its corners (j, d): triangles about their mean, so that no corner is the first.

    A triangle or a line is one cell.
    """
    if len(corners) <= 3:
        return corners[None]
    middle = np.broadcast_to(corners.mean(axis=0), corners.shape)
    return np.stack([middle, corners, np.roll(corners, -1, axis=0)], axis=1)


def _chord(rows: Floats, ends: Floats) -> tuple[Floats, Floats]:
    """Motions and lengths at points of the new edge: Simpson's rule, or the one point of a line."""
    if len(ends) == 1:
        return rows, np.ones(1)
    length = math.sqrt(float(((ends[1] - ends[0]) ** 2).sum()))
    return np.array([rows[0], 0.5 * (rows[0] + rows[1]), rows[1]]), np.array([1.0, 4.0, 1.0]) / 6.0 * length


@cache
def _unit(count: int) -> Floats:
    return np.eye(count)


def _one(count: int, k: int) -> Floats:
    row: Floats = _unit(count)[k]
    return row


@cache
def _triangle_template(split: int) -> tuple[Floats, Floats]:
    """Points (q, 3) in barycentric coordinates and their shares (q,) of a triangle split in four so often."""
    cells = [np.eye(3)]
    for _ in range(split):
        cells = [finer for cell in cells for finer in _quarters(cell)]
    share = 1.0 / len(cells)
    share_at: dict[tuple[float, ...], float] = {}
    for cell in cells:
        for point, weight in (*((corner, 1.0 / 12.0) for corner in cell), (cell.mean(axis=0), 3.0 / 4.0)):
            key = tuple(np.round(point, 12).tolist())
            share_at[key] = share_at.get(key, 0.0) + weight * share
    points = np.array(list(share_at))
    return points / points.sum(axis=1)[:, None], np.array(list(share_at.values()))


def _quarters(cell: Floats) -> Iterator[Floats]:
    a, b, c = cell
    ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
    yield from (np.array(part) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)))


@cache
def _line_template(split: int) -> tuple[Floats, Floats]:
    """Points (q, 2) and shares (q,) of a line by Simpson's rule on each of its parts."""
    elements = 2**split * 4
    count = 2 * elements + 1
    weights = np.where(np.arange(count) % 2 == 1, 4.0, 2.0)
    weights[[0, -1]] = 1.0
    at = np.linspace(0.0, 1.0, count)
    return np.stack([1.0 - at, at], axis=1), weights / (6.0 * elements)


def _vector_area(corners: Floats) -> Floats:
    sides = corners[1:] - corners[0]
    area: Floats = cross(sides[:-1], sides[1:]).sum(axis=0) / 2.0
    return area


def _size(corners: Floats) -> float:
    """Area of a polygon, length of a line."""
    if len(corners) == 2:
        return math.sqrt(float(((corners[1] - corners[0]) ** 2).sum()))
    area = _vector_area(corners)
    return math.sqrt(float(area @ area))
