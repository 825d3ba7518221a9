"""One block on an elastic bed without tension: the forces of flat contacts that are pressed on part of their polygon.

Springs (normal 1, tangential k) are spread evenly over the polygons. With the block's displacement u the opening
g = B_n u and the slip s = B_t u vary linearly over a polygon. What is pressed (g < 0) carries σ = -g and has all of its
cohesion; what is open has none and carries nothing:

    N = -g a,   T = -k s a, cut back to λ τ(σ) a,   ∫ (B_nᵀ N + B_tᵀ T) + P + λ P_bolts = 0,   λ = 1/F

a is area. Pressed parts are clipped out of their polygons along the line of zero traction, so that the normal forces
and their moments are exact; the shear is summed over triangles (vertices 1/12, middle 3/4: exact where all of a contact
slips one way). Where the pressed part grows its shear grows with it: the slopes have a term along the zero line.
"""

import math
from collections.abc import Mapping, Sequence
from functools import cache, cached_property
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.core.records import dataclass
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.system.model import Model, local_axes
from slopekit.preie.system.patch_pairs import fan_rule
from slopekit.preie.tolerances import LEAST_TRACTION, NO_MOTION, TINY
from slopekit.strength.mohr_coulomb import line
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw

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
    length_scale : m, root mean square distance of the corners from the centroid
    laws : of each contact, None where its strength is a line; empty where all are
    stress_scale : kPa of a traction of one
    shear_ratio : tangential to normal stiffness
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
    length_scale: float = 1.0
    laws: "tuple[StrengthLaw | None, ...]" = ()
    stress_scale: float = 1.0
    shear_ratio: float = SHEAR_TO_NORMAL

    def in_units_of(self, model: Model, motion: Floats) -> Floats:
        """Return a motion (u,) of the bed in the units of a model: turns are per length of each."""
        moved = motion.copy()
        moved[model.translations :] *= model.length_scale / self.length_scale
        return moved

    def corner_rows(self, k: int) -> Floats:
        """Motions (j, 3, u) of the corners of one contact per unknown: opening and two slips."""
        corners, axes = self.corners[k], self.axes[k]
        turning = np.stack([cross(corners, axis) for axis in axes], axis=1)
        return np.concatenate([np.broadcast_to(axes, turning.shape), turning], axis=2)[:, :, self.columns]


@dataclass(frozen=True, slots=True)
class Beds:
    """The flat contacts of n single blocks, each block in scaled units of its own.

    Attributes
    ----------
    contact : (n + 1,) first contact of each block; corner : (m + 1,) first corner of each contact
    rows : (m, 9, u) opening, first and second slip of each contact by 1, ξ and η of its plane per unknown
    plane : (q, 2) corners in the planes of their contacts
    line : (m, 3) control area per unit of area, cohesion per control area, tan φ
    load : (n, u) P; bolt_rows : (n, b, u); bolt_capacity : (n, b)
    shear_ratio : tangential to normal stiffness
    laws, stress_scale : as of `PolygonBed`, of a single block
    """

    contact: Ints
    corner: Ints
    rows: Floats
    plane: Floats
    line: Floats
    load: Floats
    bolt_rows: Floats
    bolt_capacity: Floats
    shear_ratio: float = SHEAR_TO_NORMAL
    laws: "tuple[StrengthLaw | None, ...]" = ()
    stress_scale: float = 1.0

    def gaps(self, block: Ints, opening: Floats) -> Floats:
        """Return by 1, ξ and η how far each contact (m,) is open, with openings (n, u) of the blocks; (m, 3)."""
        moved: Floats = (self.rows[:, :3] @ opening[block][:, :, None])[:, :, 0]
        return moved

    def following(self) -> Ints:
        """Return the corner (q,) that follows each corner on its contact."""
        after = np.arange(1, len(self.plane) + 1)
        after[self.corner[1:] - 1] = self.corner[:-1]
        return after

    def contact_of_corners(self) -> Ints:
        """Return the contact (q,) of each corner."""
        return np.repeat(np.arange(len(self.rows)), np.diff(self.corner))

    def area(self) -> Floats:
        """Return the control area (m,) of each contact of an area."""
        here, there = self.plane, self.plane[self.following()]
        double = np.add.reduceat(here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0], self.corner[:-1])
        area: Floats = 0.5 * np.abs(double) * self.line[:, 0]
        return area


def beds_of(beds: Sequence[PolygonBed]) -> Beds:
    """Return the contacts of several blocks with as many unknowns, bolts and the same shear stiffness each."""
    contacts = [len(bed.corners) for bed in beds]
    corners = [corner for bed in beds for corner in bed.corners]
    first = np.cumsum([0, *(len(corner) for corner in corners)])
    axes, columns = np.concatenate([bed.axes for bed in beds]), beds[0].columns
    rows, plane = contact_rows(np.concatenate(corners), first, axes, columns)
    return Beds(
        contact=np.cumsum([0, *contacts]),
        corner=first,
        rows=rows,
        plane=plane,
        line=np.concatenate([np.stack([bed.area, bed.cohesion, bed.tan_friction], axis=1) for bed in beds]),
        load=np.stack([bed.load for bed in beds]),
        bolt_rows=np.stack([bed.bolt_rows for bed in beds]),
        bolt_capacity=np.stack([bed.bolt_capacity for bed in beds]),
        shear_ratio=beds[0].shear_ratio,
        laws=beds[0].laws,
        stress_scale=beds[0].stress_scale,
    )


def contact_rows(corners: Floats, first: Ints, axes: Floats, columns: Ints) -> tuple[Floats, Floats]:
    """Return what moves in the planes of m contacts, (m, 9, u) as of `Beds`, and their corners (q, 2) there.

    Parameters
    ----------
    corners : (q, 3) arms; first : (m + 1,) corner of each contact; axes : (m, 3, 3)
    columns : (u,) which of the six motions are unknowns
    """
    count = np.diff(first)
    middle = np.add.reduceat(corners, first[:-1]) / count[:, None]
    moved = np.zeros((len(count), 3, 3, 6))
    moved[:, :, 0, :3], moved[:, :, 0, 3:] = axes, cross(middle[:, None], axes)
    for j in (1, 2):
        moved[:, :, j, 3:] = cross(axes[:, j, None], axes)
    contact = np.repeat(np.arange(len(count)), count)
    plane = ((corners - middle[contact])[:, None] * axes[contact, 1:]).sum(axis=2)
    return np.ascontiguousarray(moved[..., columns].reshape(len(count), 9, -1)), plane


@dataclass(frozen=True, slots=True)
class Unbalanced:
    """Unbalanced forces (n, u) of blocks and their slopes by g (n, u, u), by s (n, u, u) and by λ (n, u)."""

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


class _Flat:
    """One contact in coordinates (ξ, η) of its own plane: what moves there is linear in φ = (1, ξ, η).

    rows : (9, u) opening, first and second slip by 1, ξ and η; plane : (j, 2) its corners
    """

    def __init__(self, beds: Beds, k: int) -> None:
        self.rows: Floats = beds.rows[k]
        self.plane: Floats = beds.plane[beds.corner[k] : beds.corner[k + 1]]
        self.corners: Floats = np.concatenate([np.ones((len(self.plane), 1)), self.plane], axis=1)
        self.share, self.cohesion, self.tan_friction = beds.line[k].tolist()
        self.law = beds.laws[k] if beds.laws else None
        self.stress_scale = beds.stress_scale
        # a mean traction is one part of the load on all contacts; steeper laws are lines below the least traction
        self.least = max(LEAST_KPA, LEAST_TRACTION * beds.stress_scale)

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength (q,) at normal tractions (q,), both in the scaled units of the bed."""
        if self.law is None:
            return line(self.cohesion, self.tan_friction, normal)
        stress = normal * self.stress_scale
        none, least = self.law.resistance(np.array([0.0, self.least]))
        curve = self.law.resistance(np.maximum(stress, self.least))
        strength: Floats = np.where(stress < self.least, none + (least - none) / self.least * stress, curve)
        return strength / self.stress_scale

    def slope(self, normal: Floats) -> Floats:
        """Return how that strength grows with the normal traction, (q,)."""
        if self.law is None:
            return np.full(len(normal), self.tan_friction)
        stress = normal * self.stress_scale
        none, least = self.law.resistance(np.array([0.0, self.least]))
        slope = self.law.slope(np.maximum(stress, self.least))
        return np.where(stress < self.least, (least - none) / self.least, slope)


@dataclass(frozen=True, slots=True)
class _Grown:
    """What the points of a cut contact do as the ends (a) of its zero line move along the sides they lie on.

    points : (a, q, 2) how they move; area : (a, q) how theirs grows; ends : (a, 3) how the ends move with the gap by
    1, ξ and η
    """

    points: Floats
    area: Floats
    ends: Floats


class BedSprings:
    """The springs under n blocks, their shear summed over triangles that are split in four `split` times.

    The forces are moments of the tractions by 1, ξ and η in the plane of each contact, their slopes second moments.
    """

    def __init__(self, beds: Beds, split: int) -> None:
        self.beds, self.split = beds, split
        self.templates = {2: _line_template(split), 3: _triangle_template(split)}

    def finer(self) -> "BedSprings":
        """Return the springs of the same beds, each triangle split once more."""
        return BedSprings(self.beds, self.split + 1)

    @cached_property
    def kernels(self) -> Any:
        """The compiled kernels; None where NumPy does their work."""
        from slopekit.preie.kernels import compiled  # not for a block whose base is whole

        return None if any(self.beds.laws) else compiled(solvers=False)

    @cached_property
    def polygons(self) -> Any:
        """The beds as the compiled kernels take them."""
        beds = self.beds
        return self.kernels.polygons(
            beds.load.shape[1], beds.shear_ratio, TINY, beds.contact, beds.corner, beds.rows, beds.plane, beds.line,
            *self.templates[2], *self.templates[3],
        )  # fmt: skip

    @cached_property
    def flats(self) -> list[_Flat]:
        """The contacts, for NumPy."""
        return [_Flat(self.beds, k) for k in range(len(self.beds.rows))]

    @cached_property
    def _whole(self) -> list[tuple[Floats, Floats, Floats]]:
        whole = []
        for flat in self.flats:
            at, area = self._points(flat, flat.plane)
            powers = _powers(at)
            whole.append((np.ascontiguousarray(powers[:, :3].T), powers, area))
        return whole

    def unbalanced(
        self, blocks: Ints, opening: Floats, slip: Floats, reduction: Floats, running: bool = False,
        sticks: bool = False,
    ) -> Unbalanced:  # fmt: skip
        """Return the unbalanced forces of some blocks with openings (n, u) of one motion and slips of another.

        Parameters
        ----------
        blocks : (n,) their numbers; reduction : (n,) λ
        running : every pressed point slips, however small the slip; sticks : none does
        """
        count, unknowns = opening.shape
        out = self.beds.load[blocks]
        slopes = (
            np.zeros((count, unknowns, unknowns)), np.zeros((count, unknowns, unknowns)), np.zeros((count, unknowns)),
        )  # fmt: skip
        if self.kernels is not None:
            at = np.ascontiguousarray(opening), np.ascontiguousarray(slip), np.ascontiguousarray(reduction)
            self.kernels.pressed(self.polygons, blocks, *at, running, sticks, out, *slopes)
        else:
            for row, block in enumerate(blocks.tolist()):
                each = out[row], *(slope[row] for slope in slopes)
                self._add_pressed(block, opening[row], slip[row], reduction[row], running, sticks, *each)
        if self.beds.bolt_capacity.shape[1]:
            self._add_bolts(blocks, slip, reduction, running, sticks, out, *slopes[1:])
        return Unbalanced(out, *slopes)

    def _add_pressed(
        self, block: int, opening: Floats, slip: Floats, reduction: float, running: bool, sticks: bool, out: Floats,
        by_opening: Floats, by_slip: Floats, by_reduction: Floats,
    ) -> None:  # fmt: skip
        """What the contacts of one block carry, and its slopes."""
        spring = self.beds.shear_ratio
        field = np.empty((3, 3))  # normal traction and slips, each by 1, ξ and η
        for k in range(self.beds.contact[block], self.beds.contact[block + 1]):
            flat = self.flats[k]
            gap = flat.rows[:3] @ opening
            part = self._pressed_part(k, gap)
            if part is None:
                continue
            (phi, powers, area), grown = part
            field[0], field[1:] = -gap, (flat.rows[3:] @ slip).reshape(2, 3)
            normal, first, second = field @ phi
            size = np.sqrt(first * first + second * second)
            strength = flat.resistance(normal)
            allowed, elastic = reduction * strength, spring * size
            size = np.maximum(size, TINY)
            first, second = first / size, second / size
            if sticks:
                sliding, shear = np.zeros(len(size)), elastic
            elif running:
                sliding, shear = area, allowed
            else:
                slides = elastic > allowed
                sliding, shear = area * slides, np.where(slides, allowed, elastic)
            turning = shear / size
            turning[elastic == 0.0] = 0.0 if running else spring
            turning *= area
            slips = turning if running else turning * (sliding > 0.0)
            weights = np.empty((10, len(area)))
            np.negative(area, out=weights[0])
            drags = sliding * (reduction * flat.slope(normal))
            weights[1], weights[2] = drags * first, drags * second
            turned = slips * first
            weights[3], weights[4] = turning - turned * first, -turned * second
            weights[5] = turning - slips * second * second
            carried = area * shear
            weights[6], weights[7] = carried * first, carried * second
            lost = sliding * strength
            weights[8], weights[9] = lost * first, lost * second
            moments = weights @ powers
            second_moments = moments[:6, _SECOND]
            across = flat.rows[3:]
            out += (second_moments[0] @ gap) @ flat.rows[:3] - moments[6:8, :3].ravel() @ across
            by_opening += (flat.rows.T @ second_moments[:3].reshape(9, 3)) @ flat.rows[:3]
            turns = second_moments[_TURNS].transpose(0, 2, 1, 3).reshape(6, 6)
            by_slip -= across.T @ turns @ across
            by_reduction -= moments[8:, :3].ravel() @ across
            if grown is not None:  # where the pressed part grows its points move, and its shear with them
                slipped, pressed = grown.points @ field[1:, 1:].T, grown.points @ -gap[1:]
                along = (slipped[:, :, 0] * first + slipped[:, :, 1] * second) * slips - drags * pressed
                gained = np.empty((len(pressed), 2, len(area)))
                more = grown.area * shear - along
                gained[:, 0] = more * first + turning * slipped[:, :, 0]
                gained[:, 1] = more * second + turning * slipped[:, :, 1]
                by_ends = gained @ phi.T
                by_ends[:, :, 1:] += weights[6:8] @ grown.points
                by_opening -= (across.T @ by_ends.reshape(-1, 6).T) @ (grown.ends @ flat.rows[:3])

    def _add_bolts(
        self, blocks: Ints, slip: Floats, reduction: Floats, running: bool, sticks: bool, out: Floats, by_slip: Floats,
        by_reduction: Floats,
    ) -> None:  # fmt: skip
        """Add what the passive bolts pull with, and its slopes."""
        rows, capacity = self.beds.bolt_rows[blocks], self.beds.bolt_capacity[blocks]
        pull, spring, full = self.pulls(blocks, slip, reduction, running, sticks)
        out += (pull[:, None] @ rows)[:, 0]
        by_reduction += ((full * capacity)[:, None] @ rows)[:, 0]
        by_slip -= (rows.transpose(0, 2, 1) * spring[:, None]) @ rows

    def pulls(
        self, blocks: Ints, slip: Floats, reduction: Floats, running: bool, sticks: bool = False
    ) -> tuple[Floats, Floats, Bools]:
        """Return the pulls of the passive bolts (n, b), their springs (n, b), and which pull fully."""
        rows, capacity = self.beds.bolt_rows[blocks], self.beds.bolt_capacity[blocks]
        drawn, most = -(rows @ slip[:, :, None])[:, :, 0], reduction[:, None] * capacity
        if running:
            full = drawn > NO_MOTION
            return most * full, np.zeros_like(drawn), full
        stiff = capacity / (BOLT_GIVE * self.first[blocks])[:, None]
        full = np.zeros(drawn.shape, dtype=bool) if sticks else drawn * stiff > most
        spring = stiff * ((drawn > 0.0) & ~full)
        return np.where(full, most, spring * drawn), spring, full

    @cached_property
    def whole(self) -> Floats:
        """Second moments of 1, ξ and η over the whole of each contact, (m, 3, 3)."""
        beds = self.beds
        here, there = (
            np.concatenate([np.ones((len(at), 1)), at], axis=1) for at in (beds.plane, beds.plane[beds.following()])
        )
        middle = here + there
        both = here[:, :, None] * here[:, None] + there[:, :, None] * there[:, None]
        # a triangle with a corner at the origin, φ = (1, 0, 0) there
        middle[:, 0] += 1.0
        origin = np.zeros((3, 3))
        origin[0, 0] = 1.0
        each = middle[:, :, None] * middle[:, None] + both + origin
        size = (here[:, 1] * there[:, 2] - here[:, 2] * there[:, 1]) / 24.0
        middle[:, 0] -= 1.0
        # a line, there and back: Simpson's rule
        lines = (np.diff(beds.corner) == 2)[beds.contact_of_corners()]
        line = (middle[:, :, None] * middle[:, None] + both) * (
            np.sqrt(((there - here) ** 2).sum(axis=1)) / 12.0 * lines
        )[:, None, None]
        moments = np.add.reduceat(np.where(lines, 0.0, size)[:, None, None] * each + line, beds.corner[:-1])
        return moments * (np.sign(moments[:, 0, 0]) * beds.line[:, 0])[:, None, None]

    @cached_property
    def stiffness(self) -> Floats:
        """(n, u, u) with every point bonded."""
        beds, whole = self.beds, self.whole
        rows = beds.rows.reshape(len(whole), 3, 3, -1)
        springs = np.array([1.0, beds.shear_ratio, beds.shear_ratio])[:, None, None]
        each = (rows.transpose(0, 1, 3, 2) @ (whole[:, None] @ rows) * springs).sum(axis=1)
        stiffness: Floats = np.add.reduceat(each, beds.contact[:-1])
        return stiffness

    @cached_property
    def bonded(self) -> Floats:
        """(n, u) displacement under the loads with every point bonded."""
        try:
            return np.asarray(np.linalg.solve(self.stiffness, self.beds.load[:, :, None])[:, :, 0], dtype=np.float64)
        except np.linalg.LinAlgError:  # a sheet a thousand million times as long as thick does not resist turning
            each = zip(self.stiffness, self.beds.load, strict=True)
            return np.stack([np.linalg.lstsq(matrix, load, rcond=None)[0] for matrix, load in each])

    @cached_property
    def first(self) -> Floats:
        """(n,) the size of that displacement."""
        size: Floats = np.sqrt((self.bonded * self.bonded).sum(axis=1))
        return size

    def first_slip(self, blocks: Ints, u: Floats) -> Floats:
        """Return λ (n,) at which a first corner of a pressed part, or a first bolt, yields if none did at more."""
        beds, every = self.beds, np.zeros((len(self.beds.load), u.shape[1]))
        every[blocks] = u
        contact = beds.contact_of_corners()
        block = np.repeat(np.arange(len(every)), np.diff(beds.contact))
        moved = (beds.rows @ every[block][:, :, None]).reshape(-1, 3, 3)[contact]
        gap, first, second = (moved[:, :, 0] + (moved[:, :, 1:] * beds.plane[:, None]).sum(axis=2)).T
        strength = beds.line[contact, 1] - beds.line[contact, 2] * gap
        if beds.laws:
            strength = np.concatenate(
                [flat.resistance(np.maximum(-flat.corners @ (flat.rows[:3] @ u[0]), 0.0)) for flat in self.flats]
            )
        called = beds.shear_ratio * np.sqrt(first * first + second * second) * (gap < 0.0) / np.maximum(strength, TINY)
        most = np.maximum.reduceat(called, beds.corner[beds.contact[:-1]])[blocks]
        if beds.bolt_capacity.shape[1]:
            drawn = -(beds.bolt_rows[blocks] @ u[:, :, None])[:, :, 0].max(axis=1)
            most = np.maximum(most, drawn / (BOLT_GIVE * self.first[blocks]))
        return most

    def carried(self, bed: PolygonBed, opening: Floats, slip: Floats, reduction: float, running: bool) -> "PointForces":
        """Return the forces of one block point by point: of the pressed part of each contact, then of its open part."""
        by_contact: list[tuple[Floats, ...]] = []
        for k, flat in enumerate(self.flats):
            gap = flat.rows[:3] @ opening
            for open_part in (False, True):
                clipped, _ = _pressed(flat.corners @ (-gap if open_part else gap), flat.plane)
                if clipped is None:
                    continue
                at, area = self._points(flat, clipped)
                at, area = at[area > 0.0], area[area > 0.0]  # a corner that hardly opens has triangles of no area
                phi = _powers(at)[:, :3]
                places = bed.corners[k].mean(axis=0) + at @ bed.axes[k, 1:]
                normal = np.zeros(len(area)) if open_part else np.maximum(-phi @ gap, 0.0)
                across = phi @ (flat.rows[3:] @ slip).reshape(2, 3).T
                size = np.maximum(np.sqrt((across * across).sum(axis=1)), TINY)
                cap = reduction * flat.resistance(normal)
                shear = cap if running else np.minimum(bed.shear_ratio * size, cap)
                shear = np.zeros(len(area)) if open_part else shear * area
                by_contact.append((
                    places, area, np.full(len(area), k), normal * area,
                    -(shear / size)[:, None] * across, np.full(len(area), not open_part),
                ))  # fmt: skip
        points, area, contact, normal, shear, pressed = (np.concatenate(part) for part in zip(*by_contact, strict=True))
        pulls, _, _ = self.pulls(np.zeros(1, dtype=np.int64), slip[None], np.array([reduction]), running)
        return PointForces(points, area, contact, normal, shear, pressed, pulls[0])

    def _pressed_part(self, k: int, gap: Floats) -> "tuple[tuple[Floats, Floats, Floats], _Grown | None] | None":
        """φ (3, q), its products (q, 6) and area (q,) at points of what is pressed, and how they move with g.

        None where nothing is pressed; nothing moves where all of it is.
        """
        flat = self.flats[k]
        gaps = flat.corners @ gap
        clipped, chord = _pressed(gaps, flat.plane)
        if clipped is None:
            return None
        if chord is None:
            return self._whole[k], None
        edges = [edge for _, edge in chord]
        after = [(edge + 1) % len(gaps) for edge in edges]
        here, there = gaps[edges, None], gaps[after, None]
        ends = (here * flat.corners[after] - there * flat.corners[edges]) / (here - there) ** 2
        ways = flat.plane[after] - flat.plane[edges]
        at = [corner for corner, _ in chord]
        if len(clipped) == 2:
            points, weights = self.templates[2]
            part = clipped[1] - clipped[0]
            length = math.hypot(float(part[0]), float(part[1]))
            places, area = points @ clipped, (length * flat.share) * weights
            moves = points[:, at[0], None] * ways
            growth = float(part @ ways[0]) / length * (1.0 if at[0] else -1.0)
            grown = _Grown(moves[None], (growth * flat.share * weights)[None], ends)
        else:
            points, weights = self.templates[3]
            cells, size = _fan(clipped)
            places, area = (points @ cells).reshape(-1, 2), ((size * flat.share)[:, None] * weights).ravel()
            cells_move, grows = _fan_moves(clipped, cells, at, ways)
            count = len(at)
            grown = _Grown(
                (points @ cells_move).reshape(count, -1, 2),
                ((grows * flat.share)[:, :, None] * weights).reshape(count, -1), ends,
            )  # fmt: skip
        powers = _powers(places)
        return (np.ascontiguousarray(powers[:, :3].T), powers, area), grown

    def _points(self, flat: _Flat, corners: Floats) -> tuple[Floats, Floats]:
        """Points (q, 2) and areas (q,) of a part of a contact by its corners."""
        if len(corners) == 2:
            points, weights = self.templates[2]
            way = corners[1] - corners[0]
            return points @ corners, (math.hypot(float(way[0]), float(way[1])) * flat.share) * weights
        points, weights = self.templates[3]
        cells, size = _fan(corners)
        return (points @ cells).reshape(-1, 2), ((size * flat.share)[:, None] * weights).ravel()


def rms_length(arms: Floats) -> float:
    """Return the root mean square length of arms (k, 3)."""
    return math.sqrt(float((arms * arms).sum()) / len(arms))


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
    length = rms_length(np.concatenate([polygons[int(key)] for key in keys]) - centroid)
    to_bed = np.where(np.arange(unknowns) < model.translations, 1.0, model.length_scale / length)
    for key, at in zip(keys, first, strict=True):
        scaled = (np.asarray(polygons[int(key)]) - centroid) / length
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
    laws: tuple[StrengthLaw | None, ...] = ()
    if model.lines is not None:
        laws = tuple(model.lines.laws[int(joint)] for joint in model.lines.joint[first])
    return PolygonBed(
        corners=tuple(corners),
        axes=np.array(axes),
        area=np.array(area),
        cohesion=model.cohesion[first] / model.control_area[first],
        tan_friction=model.tan_friction[first],
        keys=keys,
        load=model.load * to_bed,
        bolt_rows=model.bolt_rows * to_bed,
        bolt_capacity=model.bolt_capacity,
        columns=columns,
        length_scale=length,
        laws=laws,
        stress_scale=model.force_scale / model.area_scale,
    )


# -- polygons -----------------------------------------------------------------------------------------------


_SECOND = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])  # which of the products of `_powers` φ_i φ_j is
_TURNS = np.array([[3, 4], [4, 5]])


def _powers(at: Floats) -> Floats:
    """1, ξ, η, ξξ, ξη, ηη (q, 6) at points."""
    powers = np.empty((len(at), 6))
    powers[:, 0], powers[:, 1:3] = 1.0, at
    np.multiply(at, at[:, :1], out=powers[:, 3:5])
    np.multiply(at[:, 1], at[:, 1], out=powers[:, 5])
    return powers


def _pressed(gaps: Floats, plane: Floats) -> tuple[Floats | None, list[tuple[int, int]] | None]:
    """The pressed part (g < 0) of a convex polygon (k, 2): its corners (j, 2), and which are the ends of its new edge.

    Those with the side of the polygon that they lie on. A new edge has two ends, one where a line (k = 2) is cut; None
    where nothing is cut off.
    """
    at, count = gaps.tolist(), len(gaps)
    if max(at) <= 0.0:
        return plane, None
    if min(at) >= 0.0:
        return None, None
    corners: list[list[float]] = []
    chord: list[tuple[int, int]] = []
    places = plane.tolist()
    for k in range(count):
        after = (k + 1) % count
        if at[k] < 0.0:
            corners.append(places[k])
        if (at[k] < 0.0) != (at[after] < 0.0) and (count > 2 or k == 0):
            part = at[k] / (at[k] - at[after])
            chord.append((len(corners), k))
            (x, y), (to_x, to_y) = places[k], places[after]
            corners.append([(1.0 - part) * x + part * to_x, (1.0 - part) * y + part * to_y])
    return np.array(corners), chord


def _fan(corners: Floats) -> tuple[Floats, Floats]:
    """Triangles (j, 3, 2) of a polygon about its centroid, and their areas (j,).

    A corner that comes, or goes, where it is cut has a triangle of no area: the points move without a jump.
    """
    middle = corners.mean(axis=0)
    after = np.concatenate([corners[1:], corners[:1]])
    one, other = corners - middle, after - middle
    double = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    whole = float(double.sum())
    if whole:
        middle = middle + (double @ (one + other)) / (3.0 * whole)
        one, other = corners - middle, after - middle
        double = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    cells = np.empty((len(corners), 3, 2))
    cells[:, 0], cells[:, 1], cells[:, 2] = middle, corners, after
    return cells, 0.5 * np.abs(double)


def _fan_moves(corners: Floats, cells: Floats, ends: list[int], ways: Floats) -> tuple[Floats, Floats]:
    """How the triangles of `_fan` move (a, j, 3, 2) and grow (a, j) as a corner (a) of the new edge moves its way.

    The part gains a sliver along the new edge then, as wide as the way at that corner and closed at the other.
    """
    middle, count = cells[0, 0], len(corners)
    one, other = cells[:, 1] - middle, cells[:, 2] - middle
    double = float((one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum())
    moves, grows = np.zeros((len(ends), count, 3, 2)), np.empty((len(ends), count))
    for m, (k, far) in enumerate(zip(ends, reversed(ends), strict=True)):
        way, across = ways[m], cells[k, 2] - corners[k - 1]
        sliver = (2.0 * corners[k] + corners[far]) / 3.0
        moved = (float(way[0] * across[1] - way[1] * across[0]) / double) * (sliver - middle)
        moves[m, :, 0] = moved
        moves[m, k, 1] = moves[m, k - 1, 2] = way
        a, b = moves[m, :, 1] - moved, moves[m, :, 2] - moved
        grows[m] = a[:, 0] * other[:, 1] - a[:, 1] * other[:, 0] + one[:, 0] * b[:, 1] - one[:, 1] * b[:, 0]
    return moves, grows * math.copysign(0.5, double)


@cache
def _triangle_template(split: int) -> tuple[Floats, Floats]:
    """Points (q, 3) and shares (q,) of a triangle that is split in four so often."""
    places, (shares,), _, _ = fan_rule(3, split)
    return places, shares


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
