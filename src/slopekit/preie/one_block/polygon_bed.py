"""Single blocks on elastic beds without tension: the forces of flat contacts that are pressed on part of their polygon.

Springs (normal 1, tangential k) are spread evenly over the polygons. With the block's displacement u the opening
g = B_n u and the slip s = B_t u vary linearly over a polygon. What is pressed (g < 0) carries σ = -g and has all of its
cohesion; what is open has none and carries nothing:

    N = -g a,   T = -k s a, cut back to λ τ(σ) a,   ∫ (B_nᵀ N + B_tᵀ T) + P + λ P_bolts = 0,   λ = 1/F

a is area. Pressed parts are clipped out of their polygons along the line of zero traction, so that the normal forces
and their moments are exact; the shear is summed over triangles (vertices 1/12, middle 3/4: exact where all of a contact
slips one way). Where the pressed part grows its shear grows with it: the slopes have a term along the zero line.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.system.model import Model, local_axes
from slopekit.preie.system.patch_pairs import fan_rule
from slopekit.preie.tolerances import LEAST_TRACTION, NO_MOTION, TINY
from slopekit.strength.mohr_coulomb import line
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw

BOLT_GIVE = 1e-2  # passive bolts pull fully once drawn out by this part of the bonded displacement
_STEP = 1e-30  # imaginary step of complex-step differentiation: its square vanishes


@dataclass(frozen=True)
class Beds:
    """The flat contacts of n single blocks, each block in scaled units of its own.

    Attributes
    ----------
    contact : (n + 1,) first contact of each block; corner : (m + 1,) first corner of each contact
    axes : (m, 3, 3) normal (into the block) and two tangents of each contact; middle : (m, 3) arm of its middle
    rows : (m, 9, u) opening, first and second slip of each contact by 1, ξ and η of its plane per unknown
    plane : (q, 2) corners in the planes of their contacts, from the middles
    line : (m, 3) control area per unit of area (of length, in a section), cohesion per control area, tan φ
    load : (n, u) P; bolt_rows : (n, b, u); bolt_capacity : (n, b)
    length : (n,) m, root mean square distance of the corners from the centroid
    shear_ratio : tangential to normal stiffness
    laws : of each contact, None where its strength is a line; empty where all are
    stress_scale : (m,) kPa of a traction of one on each contact; used with laws alone
    tan_dilation : (m,) of the contacts; used with joints that dilate alone
    """

    contact: Ints
    corner: Ints
    axes: Floats
    middle: Floats
    rows: Floats
    plane: Floats
    line: Floats
    load: Floats
    bolt_rows: Floats
    bolt_capacity: Floats
    length: Floats
    shear_ratio: float = SHEAR_TO_NORMAL
    laws: "tuple[StrengthLaw | None, ...]" = ()
    stress_scale: Floats = field(default_factory=lambda: np.ones(0))
    tan_dilation: Floats = field(default_factory=lambda: np.zeros(0))

    @property
    def translations(self) -> int:
        """Number of translations, which are the first unknowns."""
        return 2 if self.rows.shape[2] == 3 else 3

    @property
    def following(self) -> Ints:
        """The next corner (q,) of each corner on its contact."""
        corners = np.arange(1, len(self.plane) + 1)
        corners[self.corner[1:] - 1] = self.corner[:-1]
        return corners

    @property
    def contact_of_corners(self) -> Ints:
        """The contact (q,) of each corner."""
        return np.repeat(np.arange(len(self.rows)), np.diff(self.corner))

    def motions(self, motion: Floats, most: int = 3) -> Floats:
        """Return opening, first and second slip (q, 3), or fewer, at all corners, with motions (n, u) of the blocks."""
        block, contact = (
            np.repeat(np.arange(len(motion)), np.diff(self.contact)),
            self.contact_of_corners,
        )
        coefficients = (self.rows[:, : 3 * most] @ motion[block][:, :, None]).reshape(-1, most, 3)[
            contact
        ]
        values: Floats = coefficients[:, :, 0] + (coefficients[:, :, 1:] * self.plane[:, None]).sum(
            axis=2
        )
        return values

    def moments(self) -> Floats:
        """Return ∫ φ_i φ_j (m, 3, 3) over each contact, φ = (1, ξ, η), times control area per area: exact."""
        basis = np.concatenate([np.ones((len(self.plane), 1)), self.plane], axis=1)
        next_basis, is_line = (
            basis[self.following],
            (np.diff(self.corner) == 2)[self.contact_of_corners],
        )
        # triangles with a third corner in the middle of the contact; a line counts in both directions
        corners = np.stack([basis, next_basis, np.outer(~is_line, [1.0, 0.0, 0.0])], axis=1)
        total = corners.sum(axis=1)
        products = corners.transpose(0, 2, 1) @ corners + total[:, :, None] * total[:, None]
        length = np.sqrt(((next_basis - basis) ** 2).sum(axis=1))
        size = np.where(is_line, length / 12.0, cross_2d(basis[:, 1:], next_basis[:, 1:]) / 24.0)
        moments = np.add.reduceat(size[:, None, None] * products, self.corner[:-1])
        return np.asarray(moments * (np.sign(moments[:, 0, 0]) * self.line[:, 0])[:, None, None])

    @cached_property
    def contact_moments(self) -> Floats:
        """(m, 3, 3) moments of the whole contacts."""
        return self.moments()

    @cached_property
    def stiffness(self) -> Floats:
        """Elastic stiffness (n, u, u) with every point bonded."""
        rows = self.rows.reshape(len(self.contact_moments), 3, 3, -1)
        springs = np.array([1.0, self.shear_ratio, self.shear_ratio])[:, None, None]
        by_contact = (
            rows.transpose(0, 1, 3, 2) @ (self.contact_moments[:, None] @ rows) * springs
        ).sum(axis=1)
        return np.add.reduceat(by_contact, self.contact[:-1])

    @cached_property
    def bonded(self) -> Floats:
        """Displacement (n, u) under the loads with every point bonded."""
        try:
            return np.asarray(
                np.linalg.solve(self.stiffness, self.load[:, :, None])[:, :, 0], dtype=np.float64
            )
        except (
            np.linalg.LinAlgError
        ):  # a sheet a thousand million times as long as thick does not resist turning
            systems = zip(self.stiffness, self.load, strict=True)
            return np.stack(
                [np.linalg.lstsq(matrix, load, rcond=None)[0] for matrix, load in systems]
            )

    @cached_property
    def elastic_size(self) -> Floats:
        """Size (n,) of the bonded displacement: one elastic displacement."""
        size: Floats = np.sqrt((self.bonded * self.bonded).sum(axis=1))
        return size

    @cached_property
    def bolt_springs(self) -> Floats:
        """Stiffness (n, b) of the passive bolts."""
        if not self.bolt_capacity.shape[1]:
            return self.bolt_capacity
        return self.bolt_capacity / (BOLT_GIVE * self.elastic_size)[:, None]

    def places(self, k: int, positions: Floats) -> Floats:
        """Return points (q, 2) in the plane of a contact of a single block as arms (q, 3) from its centroid, m."""
        return np.asarray((self.middle[k] + positions @ self.axes[k, 1:]) * self.length[0])

    def in_units_of(self, model: Model, motion: Floats) -> Floats:
        """Return a motion (u,) of a single block in the units of a model, whose rotations have another length scale."""
        return (
            np.where(
                np.arange(len(motion)) < model.translations,
                1.0,
                model.length_scale / self.length[0],
            )
            * motion
        )


def contact_rows(
    arms: Floats, corner: Ints, axes: Floats, columns: Ints
) -> tuple[Floats, Floats, Floats]:
    """Return middle (m, 3), rows (m, 9, u) and plane (q, 2) of m contacts, as of `Beds`.

    Parameters
    ----------
    arms : (q, 3) of the corners; corner : (m + 1,) first of each contact; axes : (m, 3, 3)
    columns : (u,) which of the six motions are unknowns
    """
    count = np.diff(corner)
    middle = np.add.reduceat(arms, corner[:-1]) / count[:, None]
    motions = np.zeros((len(count), 3, 3, 6))
    motions[:, :, 0, :3], motions[:, :, 0, 3:] = axes, cross(middle[:, None], axes)
    for j in (1, 2):
        motions[:, :, j, 3:] = cross(axes[:, j, None], axes)
    contact = np.repeat(np.arange(len(count)), count)
    plane = ((arms - middle[contact])[:, None] * axes[contact, 1:]).sum(axis=2)
    return middle, np.ascontiguousarray(motions[..., columns].reshape(len(count), 9, -1)), plane


@dataclass(frozen=True)
class Unbalanced:
    """Unbalanced forces (n, u) of blocks and their slopes by g (n, u, u), by s (n, u, u) and by λ (n, u)."""

    force: Floats
    by_opening: Floats
    by_slip: Floats
    by_reduction: Floats


@dataclass(frozen=True)
class PointForces:
    """Scaled forces at the points (q) of a bed: `shear` (q, 2) in the local tangents, `pulls` (b,) of the bolts.

    `points` (q, 3) m from the centroid; `pressed` (q,) which points are in compression.
    """

    points: Floats
    area: Floats
    contact: Ints
    normal: Floats
    shear: Floats
    pressed: Bools
    pulls: Floats


class BedSprings:
    """The springs under n blocks, their shear summed over triangles that are split in four `split` times."""

    def __init__(self, beds: Beds, split: int) -> None:
        self.beds, self.split = beds, split
        places, (shares,), _, _ = fan_rule(3, split)
        self.templates = {2: _line_template(split), 3: (places, shares)}

    def finer(self) -> "BedSprings":
        """Return the springs of the same beds, each triangle split once more."""
        return BedSprings(self.beds, self.split + 1)

    @cached_property
    def kernels(self) -> Any:
        """The compiled kernels; None where NumPy does their work."""
        from slopekit.preie.kernels import (
            compiled,
        )  # not needed for a block whose joints are fully pressed

        return compiled(solvers=False)

    @cached_property
    def polygons(self) -> Any:
        """The beds as an object of the compiled kernels."""
        beds = self.beds
        unknowns, templates = (
            beds.load.shape[1],
            [array.T.copy() for size in (2, 3) for array in self.templates[size]],
        )
        shapes = beds.contact, beds.corner, beds.rows, beds.plane, beds.line
        laws = _laws_for_kernels(beds, max(len(templates[1]), len(templates[3])))
        bolts = (
            np.ascontiguousarray(beds.bolt_rows),
            np.ascontiguousarray(beds.bolt_capacity),
            beds.bolt_springs,
        )
        return self.kernels.polygons(
            unknowns, beds.shear_ratio, TINY, *shapes, *templates, *laws, *bolts, NO_MOTION
        )

    def unbalanced(
        self,
        blocks: Ints,
        opening: Floats,
        slip: Floats,
        reduction: Floats,
        running: bool = False,
        sticks: bool = False,
    ) -> Unbalanced:
        """Return the unbalanced forces of blocks that open by one motion (n, u) and slip by another (n, u).

        Parameters
        ----------
        blocks : (n,) their numbers; reduction : (n,) λ
        running : every pressed point slips, however small the slip; sticks : none does
        """
        residual, size = self.beds.load[blocks], opening.shape[1]
        slopes = (
            np.zeros((len(residual), size, size)),
            np.zeros((len(residual), size, size)),
            np.zeros((len(residual), size)),
        )
        if self.kernels is not None:
            arrays = (
                np.ascontiguousarray(opening),
                np.ascontiguousarray(slip),
                np.ascontiguousarray(reduction),
            )
            self.kernels.pressed(self.polygons, blocks, *arrays, running, sticks, residual, *slopes)
            return Unbalanced(residual, *slopes)
        states = np.concatenate([opening, slip, reduction[:, None]], axis=1)
        for row, block in enumerate(blocks.tolist()):
            state = states[row] + 1j * _STEP * np.eye(
                2 * size + 1
            )  # slopes are the imaginary parts
            forces = np.zeros((len(state), size), dtype=complex)
            for k in range(*self.beds.contact[block : block + 2].tolist()):
                forces += self._forces(k, state, running, sticks)
            residual[row] += forces[0].real
            change = forces.imag.T / _STEP
            slopes[0][row], slopes[1][row], slopes[2][row] = (
                change[:, :size],
                change[:, size:-1],
                change[:, -1],
            )
        if self.beds.bolt_capacity.shape[1]:
            rows, capacity = self.beds.bolt_rows[blocks], self.beds.bolt_capacity[blocks]
            pull, spring, full = self.pulls(blocks, slip, reduction, running, sticks)
            residual += (pull[:, None] @ rows)[:, 0]
            slopes[1][:] -= (rows.transpose(0, 2, 1) * spring[:, None]) @ rows
            slopes[2][:] += ((full * capacity)[:, None] @ rows)[:, 0]
        return Unbalanced(residual, *slopes)

    def pulls(
        self, blocks: Ints, slip: Floats, reduction: Floats, running: bool, sticks: bool = False
    ) -> tuple[Floats, Floats, Bools]:
        """Return the pulls (n, b) of the passive bolts, their springs (n, b), and which bolts yield (n, b)."""
        rows, capacity = self.beds.bolt_rows[blocks], self.beds.bolt_capacity[blocks]
        extension, most = -(rows @ slip[:, :, None])[:, :, 0], reduction[:, None] * capacity
        if running:
            full = extension > NO_MOTION
            return most * full, np.zeros_like(extension), full
        stiff = self.beds.bolt_springs[blocks]
        full = np.zeros(extension.shape, dtype=bool) if sticks else extension * stiff > most
        spring = stiff * ((extension > 0.0) & ~full)
        return np.where(full, most, spring * extension), spring, full

    def first_slip(self, blocks: Ints, u: Floats) -> Floats:
        """Return λ (n,) below which a first corner of a pressed part slips, or a first bolt yields."""
        beds, displacements = self.beds, np.zeros_like(self.beds.load)
        displacements[blocks] = u
        gap, first, second = beds.motions(displacements).T
        line, normal = beds.line[beds.contact_of_corners], np.maximum(-gap, 0.0)
        strength = line[:, 1] + line[:, 2] * normal
        for k in range(len(beds.laws)):
            corners = slice(*beds.corner[k : k + 2])
            strength[corners] = self._resistance(k, normal[corners])
        slip = np.sqrt(first * first + second * second) * (gap < 0.0)
        utilisation = beds.shear_ratio * slip / np.maximum(strength, TINY)
        most = np.maximum.reduceat(utilisation, beds.corner[beds.contact[:-1]])[blocks]
        if beds.bolt_capacity.shape[1]:
            extension = -(beds.bolt_rows[blocks] @ u[:, :, None])[:, :, 0] * (
                beds.bolt_capacity[blocks] > 0.0
            )
            most = np.maximum(most, extension.max(axis=1) / (BOLT_GIVE * beds.elastic_size[blocks]))
        return most

    def point_forces(
        self, opening: Floats, slip: Floats, reduction: float, running: bool
    ) -> PointForces:
        """Return the forces of a single block at its points: of each contact the pressed part, then the open one."""
        state, regions = (
            np.concatenate([opening, slip, [reduction]])[None],
            list[tuple[Floats, ...]](),
        )
        for k in range(len(self.beds.rows)):
            for pressed in (True, False):
                region = self._clipped_region(k, state[:, : len(opening)], pressed)
                if region is None:
                    continue
                real = region[1][0] > 0.0  # a corner that hardly opens has triangles of no area
                positions, area = region[0][0, real], region[1][0, real]
                normal, first, second = (
                    pressed
                    * self._tractions(k, positions[None], state, running, False)[:, 0]
                    * area
                )
                normal = np.maximum(normal, 0.0)
                contact, is_pressed = np.full(len(area), k), np.full(len(area), pressed)
                shear = -np.stack([first, second], axis=1)
                regions.append(
                    (self.beds.places(k, positions), area, contact, normal, shear, is_pressed)
                )
        pulls, _, _ = self.pulls(np.zeros(1, dtype=np.int64), slip[None], state[:, -1], running)
        points, areas, contacts, normal, shear, inside = (
            np.concatenate(region) for region in zip(*regions, strict=True)
        )
        return PointForces(points, areas, contacts, normal, shear, inside, pulls[0])

    def _forces(self, k: int, state: Floats, running: bool, sticks: bool) -> Floats:
        """Return the forces (d, u) of a contact on its block in states (d, 2 u + 1): opening, slip, λ."""
        region = self._clipped_region(k, state[:, : self.beds.load.shape[1]])
        if region is None:
            return np.zeros((len(state), self.beds.load.shape[1]))
        positions, area = region
        tractions = (
            self._tractions(k, positions, state, running, sticks)
            * np.array([1.0, -1.0, -1.0])[:, None, None]
            * area
        )
        moments = np.stack(
            [
                tractions.sum(axis=2),
                *(tractions[:, :, None] @ positions)[:, :, 0].transpose(2, 0, 1),
            ],
            axis=1,
        )
        return np.asarray(moments.reshape(9, len(state)).T @ self.beds.rows[k])

    def _clipped_region(
        self, k: int, opening: Floats, pressed: bool = True
    ) -> tuple[Floats, Floats] | None:
        """Return points (d, q, 2) and areas (d, q) of the pressed (or the open) part of a contact; None without one."""
        beds = self.beds
        plane = beds.plane[beds.corner[k] : beds.corner[k + 1]]
        across = np.stack([np.ones(len(plane)), *plane.T])
        gaps = (opening @ beds.rows[k, :3].T @ across) * (1.0 if pressed else -1.0)
        inside = gaps[0].real < 0.0
        count, corners = len(plane), list[Floats]()
        for corner in range(count):
            next_corner = (corner + 1) % count
            if inside[corner]:
                corners.append(np.broadcast_to(plane[corner], (len(gaps), 2)))
            if inside[corner] != inside[next_corner] and (count > 2 or corner == 0):
                share = (gaps[:, corner] / (gaps[:, corner] - gaps[:, next_corner]))[:, None]
                corners.append((1.0 - share) * plane[corner] + share * plane[next_corner])
        if not inside.any():
            return None
        clipped = np.stack(corners, axis=1)
        if count == 2:
            cells, size = (
                clipped[:, None],
                np.sqrt(((clipped[:, 1] - clipped[:, 0]) ** 2).sum(axis=1))[:, None],
            )
        else:
            cells, size = _fan(clipped)
        points, weights = self.templates[min(count, 3)]
        area = (size * beds.line[k, 0])[:, :, None] * weights
        return (points @ cells).reshape(len(gaps), -1, 2), area.reshape(len(gaps), -1)

    def _tractions(
        self, k: int, positions: Floats, state: Floats, running: bool, sticks: bool
    ) -> Floats:
        """Return normal traction and both shear tractions along the slip (3, d, q) at points of a contact."""
        beds, unknowns = self.beds, self.beds.load.shape[1]
        rows = beds.rows[k].reshape(3, 3, -1)
        fields = [
            state[:, :unknowns] @ rows[0].T,
            *(state[:, unknowns:-1] @ rows[j].T for j in (1, 2)),
        ]
        gap, first, second = (
            coefficients[:, :1] + (positions @ coefficients[:, 1:, None])[:, :, 0]
            for coefficients in fields
        )
        slip = np.sqrt(first * first + second * second)
        most = state[:, -1:] * self._resistance(k, -gap)
        slides = (beds.shear_ratio * slip.real > np.maximum(most.real, TINY)) & (
            not sticks
        ) | running
        spring = np.where(slides, most / np.where(slip.real > TINY, slip, np.inf), beds.shear_ratio)
        return np.stack([-gap, spring * first, spring * second])

    def _resistance(self, k: int, normal: Floats) -> Floats:
        """Return the shear strength of a contact at normal tractions, both in the scaled units of its block."""
        strength, slope = strength_and_slope(self.beds, k, normal.real)
        return (
            np.asarray(strength + 1j * slope * normal.imag) if np.iscomplexobj(normal) else strength
        )


def strength_and_slope(beds: Beds, k: int, normal: Floats) -> tuple[Floats, Floats]:
    """Return the shear strength of a contact and its slope at normal tractions, in the scaled units of its block."""
    law = beds.laws[k] if beds.laws else None
    if law is None:
        return line(beds.line[k, 1], beds.line[k, 2], normal), np.full_like(normal, beds.line[k, 2])
    # below a least traction, a part of the mean, the law is replaced by a line through its value there
    scale = float(beds.stress_scale[k])
    stress, least = normal * scale, max(LEAST_KPA, LEAST_TRACTION * scale)
    above = np.maximum(stress, least)
    none, lowest = law.resistance(np.array([0.0, least]))
    steep = (lowest - none) / least
    strength = np.where(stress < least, none + steep * stress, law.resistance(above)) / scale
    return strength, np.where(stress < least, steep, law.slope(above))


def _laws_for_kernels(beds: Beds, points: int) -> tuple[Any, Bools, Floats]:
    """Return a function that evaluates curved laws, which contacts have one (m,), and its arrays (3, n).

    Parameters
    ----------
    points : of a triangle, or of a line
    """
    curved = np.array([law is not None for law in beds.laws], dtype=bool)
    most = (
        int(np.diff(beds.corner).max()) + 2
    )  # corners: where a polygon is cut it gains one or two
    normal, strength, slope = arrays = np.zeros((3, most * points if curved.any() else 0))

    def evaluate_law(contact: int, count: int) -> None:
        strength[:count], slope[:count] = strength_and_slope(beds, contact, normal[:count])

    return evaluate_law if curved.any() else None, curved, arrays


def elastic_bed(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> Beds:
    """Return the contacts of one block on bedrock as an elastic bed, in the order of their interfaces.

    Parameters
    ----------
    model : of the block, from node pairs on these polygons, for its strengths, loads and units
    polygons : interface -> (k, 3) corners in m, as for `node_pairs`, or (2, 3) ends of a line in a section
    centroid : (3,) m
    """
    keys = sorted(polygons)
    first, moves = (
        [int(np.flatnonzero(model.interface == key)[0]) for key in keys],
        model.translations,
    )
    columns = np.array([0, 2, 4])[: model.unknowns] if moves == 2 else np.arange(model.unknowns)
    arms = np.concatenate([polygons[key] for key in keys]) - centroid
    corner, normals = (
        np.cumsum([0, *(len(polygons[key]) for key in keys)]),
        np.zeros((len(keys), 3)),
    )
    normals[:, columns[:moves]] = model.rows[first, 0, :moves]
    axes = local_axes(normals)
    length = math.sqrt(float((arms * arms).sum()) / len(arms))
    middle, rows, plane = contact_rows(arms / length, corner, axes, columns)
    to_bed = np.where(np.arange(model.unknowns) < moves, 1.0, model.length_scale / length)
    ones, straight = np.ones(len(keys)), model.tan_friction[first]
    laws = (
        ()
        if model.lines is None
        else tuple(model.lines.laws[int(joint)] for joint in model.lines.joint[first])
    )
    bed = Beds(
        contact=np.array([0, len(keys)]),
        corner=corner,
        axes=axes,
        middle=middle,
        rows=rows,
        plane=plane,
        line=np.stack([ones, model.cohesion[first] / model.control_area[first], straight], axis=1),
        load=(model.load * to_bed)[None],
        bolt_rows=(model.bolt_rows * to_bed)[None],
        bolt_capacity=model.bolt_capacity[None],
        length=np.array([length]),
        laws=laws,
        stress_scale=np.full(len(keys), model.force_scale / model.area_scale),
        tan_dilation=model.tan_dilation[first],
    )
    bed.line[:, 0] = [
        model.control_area[model.interface == key].sum() for key in keys
    ] / bed.moments()[:, 0, 0]
    return bed


def _fan(corners: Floats) -> tuple[Floats, Floats]:
    """Return triangles (d, j, 3, 2) of polygons (d, j, 2) about their centroids, and their areas (d, j).

    A corner that appears or vanishes at the cut has a triangle of zero area, so that points move continuously.
    """
    next_corners, middle = np.roll(corners, -1, axis=1), corners.mean(axis=1, keepdims=True)
    double = cross_2d(corners - middle, next_corners - middle)
    total = double.sum(axis=1)[:, None, None]
    moment = double[:, None] @ (corners + next_corners - 2.0 * middle)
    middle = middle + moment / (3.0 * np.where(np.abs(total) > 0.0, total, 1.0))
    cells = np.stack([np.broadcast_to(middle, corners.shape), corners, next_corners], axis=2)
    return cells, 0.5 * np.sign(total[:, 0].real) * cross_2d(
        corners - middle, next_corners - middle
    )


def cross_2d(first: Floats, second: Floats) -> Floats:
    """Return the cross products (...) of vectors (..., 2) in a plane."""
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]


@cache
def _line_template(split: int) -> tuple[Floats, Floats]:
    """Return points (q, 2) and shares (q,) of a line by Simpson's rule on each of its parts."""
    elements = 2**split * 4
    weights = np.where(np.arange(2 * elements + 1) % 2 == 1, 4.0, 2.0)
    weights[[0, -1]] = 1.0
    positions = np.linspace(0.0, 1.0, 2 * elements + 1)
    return np.stack([1.0 - positions, positions], axis=1), weights / (6.0 * elements)
