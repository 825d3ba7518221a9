"""The cracked base: one block on an elastic bed without tension, followed until its motion runs.

The contacts are flat polygons with springs (normal 1, tangential `SHEAR_TO_NORMAL`) spread evenly over them. With the
block's displacement u the opening g = B_n u and the slip s = B_t u vary linearly over a polygon. What is pressed
(g < 0) carries σ = -g and has all of its cohesion; what is open has none and carries nothing:

    N = -g a,   T = -k s a, cut back to λ (c + σ tan φ) a,   ∫ (B_nᵀ N + B_tᵀ T) + P + λ P_bolts = 0,   λ = 1/F

a is area. Pressed parts are clipped out of their polygons along the line of zero traction, so that the normal forces
and their moments are exact; the shear is summed over triangles (vertices 1/12, middle 3/4: exact where all of a contact
slips one way). From a strength that holds the block λ goes down, u is followed by arc length. F = 1/λ at the least λ:
either λ passes through a least value (the pressed part shrinks faster than its traction grows) or it settles while
the motion runs; then Newton's method finds the running state itself, as `limit_state` does with all pairs closed:

    g = B_n Y w,   direction of slip = B_t Z v,   unknowns w, v (|v| = 1), λ.

Forces scale with the stiffness, displacements against it: F depends on the ratio of the two springs only.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from slopekit.arrays import Floats, Ints, cross
from slopekit.preie.linear import split_space
from slopekit.preie.model import Model, local_axes

SHEAR_TO_NORMAL = 0.4  # k_t / k_n, that of the elastic path (METHOD-3 §13)
_SPLIT = 2  # each triangle of a pressed part is split in four so often
_MOST_NEWTON = 14  # steps to one point of the path; where it takes more, the step along it was too long
_BALANCED = 1e-11  # unbalanced force in parts of the load
_MOST_POINTS = 400  # of the path
_RUNS = 1e4  # times the first displacement: what has moved so far runs
_TURNED = 1.2  # λ so far above its least value does not come back
_SHORTEST = 1e-6  # a step along the path as short as this, in parts of the displacement, meets a corner
_LEAST_PART = 1e-6  # of λ: no rest even at so little less strength is the end of the path
_LEVEL = 1e-7  # slope of ln λ along the path that counts as none: λ is within its square of the least
_FLOWS = 30.0  # times the displacement: what flows so far runs
_MOST_FLOW = 40  # steps of viscous flow
_STIFFEST = 1e3  # viscous resistance, in parts of the bonded stiffness, that Newton's method must manage
_STRONG = 4.0  # the path starts at this many times the strength that the limit needs, or at more
_HARDEST = 1024.0  # times that strength: what does not rest then, does not rest
_BOLT_GIVE = 1e-2  # passive bolts pull fully once drawn out by this part of the first displacement
_TURNS = 1e-7  # opening above this part of the slip is the motion's, not rounding


@dataclass(frozen=True, slots=True)
class Bed:
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


@dataclass(frozen=True, slots=True)
class CrackedBase:
    """The limit of a block on its cracked base.

    Attributes
    ----------
    factor : F, None where it is not at rest at any strength, or the path was lost
    why_not : a sentence where there is none
    runs : the motion runs at a settled λ; False: λ went through its least value with the block still at rest
    displacement, velocity : (u,) elastic displacement and unit motion at the limit
    pressed : per contact the corners (k, 3) of its pressed part, scaled; no rows where all is open
    pressed_share : (m,) of the area; resultant : (m, 3) where the normal forces act, scaled, NaN where there are none
    normal_force : (m,) in parts of the load
    residual : unbalanced force in parts of the load; points : of the path
    """

    factor: float | None
    why_not: str
    runs: bool
    displacement: Floats
    velocity: Floats
    pressed: tuple[Floats, ...]
    pressed_share: Floats
    resultant: Floats
    normal_force: Floats
    residual: float
    points: int


def bed_of(model: Model, polygons: Mapping[int, Floats], centroid: Floats) -> Bed:
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
    return Bed(
        tuple(corners), np.array(axes), np.array(area), per_share, model.tan_friction[first], keys, model.load,
        model.bolt_rows, model.bolt_capacity, columns,
    )  # fmt: skip


def cracked_base(bed: Bed, guess: float, split: int = _SPLIT) -> CrackedBase:
    """Follow the block on its elastic bed from a strength that holds it to the least that does.

    Parameters
    ----------
    guess : a factor of safety of about the right size; the path starts at a quarter of it or less
    split : how often the triangles of the pressed parts are split in four for the shear
    """
    path = _Path(bed, split)
    rest = path.start(_STRONG / guess)
    if rest is None:
        return path.none("the block does not rest on its bed at any strength")
    return path.follow(*rest)


@dataclass(frozen=True, slots=True)
class _Forces:
    """Unbalanced forces (u,) and their slopes by g (u, u), by s (u, u) and by λ (u,)."""

    out: Floats
    by_opening: Floats
    by_slip: Floats
    by_reduction: Floats


@dataclass(frozen=True, slots=True)
class _Point:
    """A point of the path: u, ln λ, and the unit tangent of the two."""

    u: Floats
    log_reduction: float
    tangent: Floats


class _Path:
    """The elastic path of one bed."""

    def __init__(self, bed: Bed, split: int) -> None:
        self.bed = bed
        self.rows = []  # (k, 3, u) motions of the corners
        for corners, axes in zip(bed.corners, bed.axes, strict=True):
            turning = np.stack([cross(corners, axis) for axis in axes], axis=1)
            shifting = np.broadcast_to(axes, turning.shape)
            self.rows.append(np.concatenate([shifting, turning], axis=2)[:, :, bed.columns])
        self.templates = {2: _line_template(split), 3: _triangle_template(split)}
        self.bonded = np.zeros((len(bed.load), len(bed.load)))  # stiffness with every point bonded
        self.first = 1.0  # length of the first displacement
        self.points = 0

    # -- the forces ---------------------------------------------------------------------------------------

    def forces(self, opening: Floats, slip: Floats, reduction: float, running: bool, sticks: bool = False) -> _Forces:
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
                grows = length * (bed.area[k] / max(steep, 1e-300))
            across = at[:, 1:] @ slip
            size = np.sqrt((across * across).sum(axis=1))
            strength = bed.cohesion[k] + bed.tan_friction[k] * normal
            elastic = SHEAR_TO_NORMAL * size
            if sticks:
                slides = np.zeros(len(size), dtype=bool)
            elif running:
                slides = np.ones(len(size), dtype=bool)
            else:
                slides = elastic > reduction * strength
            direction = across / np.maximum(size, 1e-300)[:, None]
            shear = np.where(slides, reduction * strength, elastic)
            n = len(area)
            normal_rows, shear_rows = at[:n, 0], at[:n, 1:]
            along = np.einsum("qt,qtu->qu", direction, at[:, 1:])
            out += (area * normal[:n]) @ normal_rows - (area * shear[:n]) @ along[:n]
            by_opening -= (normal_rows.T * area) @ normal_rows
            sliding = area * slides[:n]
            by_opening += (along[:n].T * (sliding * reduction * bed.tan_friction[k])) @ normal_rows
            by_reduction -= (sliding * strength[:n]) @ along[:n]
            turning = area * np.where(slides[:n], shear[:n] / np.maximum(size[:n], 1e-300), SHEAR_TO_NORMAL)
            flat = shear_rows.reshape(-1, count)
            by_slip -= (flat.T * np.repeat(turning, 2)) @ flat
            by_slip += (along[:n].T * np.where(slides[:n], turning, 0.0)) @ along[:n]
            if chord is not None:
                by_opening += (along[n:].T * (grows * shear[n:])) @ at[n:, 0]
        if len(bed.bolt_capacity):
            drawn = -bed.bolt_rows @ slip
            if running:
                pull, spring = np.where(drawn > _TURNS, 1.0, 0.0), np.zeros(len(drawn))
                out += (reduction * bed.bolt_capacity * pull) @ bed.bolt_rows
                by_reduction += (bed.bolt_capacity * pull) @ bed.bolt_rows
            else:
                give = _BOLT_GIVE * self.first
                stiff = bed.bolt_capacity / give
                full = drawn * stiff > reduction * bed.bolt_capacity
                if sticks:
                    full = np.zeros(len(drawn), dtype=bool)
                spring = np.where((drawn > 0.0) & ~full, stiff, 0.0)
                out += (np.where(full, reduction * bed.bolt_capacity, spring * drawn)) @ bed.bolt_rows
                by_reduction += np.where(full, bed.bolt_capacity, 0.0) @ bed.bolt_rows
            by_slip -= (bed.bolt_rows.T * spring) @ bed.bolt_rows
        return _Forces(out, by_opening, by_slip, by_reduction)

    def _cells(self, k: int, rows: Floats, corners: Floats) -> tuple[Floats, Floats]:
        """Motions (q, 3, u) and areas (q,) at the points of a pressed part."""
        count = rows.shape[2]
        if len(corners) == 2:
            points, weights = self.templates[2]
            size = math.sqrt(float(((corners[1] - corners[0]) ** 2).sum())) * float(self.bed.area[k])
            return (points @ rows.reshape(2, -1)).reshape(-1, 3, count), weights * size
        points, weights = self.templates[3]
        fan = np.arange(1, len(corners) - 1)
        which = np.stack([np.zeros_like(fan), fan, fan + 1], axis=1)
        sides = corners[which[:, 1:]] - corners[:1]
        double = cross(sides[:, 0], sides[:, 1])
        size = np.sqrt((double * double).sum(axis=1)) * (0.5 * float(self.bed.area[k]))
        at = points @ rows[which].reshape(len(fan), 3, -1)
        return at.reshape(-1, 3, count), (size[:, None] * weights).ravel()

    # -- the path -----------------------------------------------------------------------------------------

    def start(self, reduction: float) -> tuple[Floats, float] | None:
        """The block at rest at a λ of this size, or at the least multiple of it where it is found to rest."""
        bed = self.bed
        for k, rows in enumerate(self.rows):
            at, area = self._cells(k, rows, bed.corners[k])
            flat = at.reshape(-1, len(bed.load))
            self.bonded += (flat.T * np.outer(area, [1.0, SHEAR_TO_NORMAL, SHEAR_TO_NORMAL]).ravel()) @ flat
        try:
            bonded = np.linalg.solve(self.bonded, bed.load)
        except np.linalg.LinAlgError:
            return None
        self.first = math.sqrt(float(bonded @ bonded))
        stuck = self._rest(bonded, reduction, sticks=True)
        most = reduction * _HARDEST
        while reduction < most:
            for guess in (bonded, stuck):
                found = None if guess is None else self._rest(guess, reduction)
                if found is not None:
                    return found, reduction
            found = self._flow(bonded, reduction)
            if found is not None:
                return found, reduction
            reduction *= 4.0
        return None

    def _rest(self, u: Floats, reduction: float, sticks: bool = False, slow: float = 0.0) -> Floats | None:
        """Newton's method at one λ; with `slow` the block is held back from u by that part of its bonded stiffness."""
        begin, drag = u, slow * self.bonded
        at = self.forces(u, u, reduction, False, sticks)
        out = at.out
        size = float(np.abs(out).max())
        for _ in range(2 * _MOST_NEWTON):
            if size < _BALANCED * max(1.0, reduction):
                return u
            try:
                step = -np.linalg.solve(at.by_opening + at.by_slip - drag, out)
            except np.linalg.LinAlgError:
                return None
            length = 1.0
            while True:
                trial = u + length * step
                after = self.forces(trial, trial, reduction, False, sticks)
                out_after = after.out - drag @ (trial - begin)
                size_after = float(np.abs(out_after).max())
                if size_after < size * (1.0 - 0.1 * length):
                    break
                length *= 0.5
                if length < 0.05:
                    return None
            u, at, out, size = trial, after, out_after, size_after
        return None

    def _flow(self, u: Floats, reduction: float) -> Floats | None:
        """Where the block comes to rest at one λ if it may move slowly from u (implicit viscous flow); None if not."""
        slow, far = 1.0, _FLOWS * max(self.first, math.sqrt(float(u @ u)))
        for _ in range(_MOST_FLOW):
            found = self._rest(u, reduction, slow=slow)
            if found is None:
                slow *= 4.0
                if slow > _STIFFEST:
                    return None
                continue
            moved = found - u
            u, slow = found, slow * 0.2
            rest = self._rest(u, reduction)
            if rest is not None:
                return rest
            if math.sqrt(float(u @ u)) > far or not float(np.abs(moved).max()) > 0.0:
                return None
        return None

    def _tangent(self, at: _Forces, reduction: float, scale: float, before: Floats) -> Floats | None:
        """Unit tangent (u + 1,) in u / scale and ln λ, the way `before` points."""
        count = len(self.bed.load)
        matrix = np.empty((count + 1, count + 1))
        matrix[:count, :count] = (at.by_opening + at.by_slip) * scale
        matrix[:count, count] = at.by_reduction * reduction
        matrix[count] = before
        try:
            tangent = np.linalg.solve(matrix, np.append(np.zeros(count), 1.0))
        except np.linalg.LinAlgError:
            return None
        return np.asarray(tangent / math.sqrt(float(tangent @ tangent)), dtype=np.float64)

    def _step(self, point: _Point, length: float) -> tuple[_Point, int] | None:
        """The point of the path that lies `length` along the tangent, in parts of the displacement so far."""
        scale = math.sqrt(float(point.u @ point.u))
        count = len(point.u)
        goal = np.append(point.u / scale, point.log_reduction)
        y = goal + length * point.tangent
        matrix = np.empty((count + 1, count + 1))
        matrix[count] = point.tangent
        last = math.inf
        for used in range(_MOST_NEWTON):
            u, reduction = y[:count] * scale, math.exp(float(y[count]))
            at = self.forces(u, u, reduction, False)
            size = float(np.abs(at.out).max())
            if size < _BALANCED * max(1.0, reduction):
                tangent = self._tangent(at, reduction, scale, point.tangent)
                if tangent is None or float(tangent @ point.tangent) < 0.0:
                    return None
                # the next step is measured in this point's own displacement
                renewed = np.append(tangent[:count] * scale, tangent[count])
                renewed[:count] /= math.sqrt(float(u @ u))
                return _Point(u, float(y[count]), renewed / math.sqrt(float(renewed @ renewed))), used
            if used > 4 and size > last:
                return None
            last = size
            matrix[:count, :count] = (at.by_opening + at.by_slip) * scale
            matrix[:count, count] = at.by_reduction * reduction
            try:
                step = -np.linalg.solve(matrix, np.append(at.out, float(point.tangent @ (y - goal)) - length))
            except np.linalg.LinAlgError:
                return None
            if not float(np.abs(step).max()) < 10.0 * max(length, 0.1):
                return None
            y = y + step
        return None

    def follow(self, u: Floats, reduction: float) -> CrackedBase:
        """The path from a state of rest to the least λ."""
        begun = self._begin(u, reduction)
        if begun is None:
            return self.none("the elastic path could not be followed")
        point = best = begun
        length, start, is_fold, ended = 0.1, math.sqrt(float(u @ u)), False, False
        for self.points in range(1, _MOST_POINTS + 1):
            found = self._step(point, length)
            if found is None:
                length /= 4.0
                if length > _SHORTEST:
                    continue
                onward = self._march(best)  # a corner of the path: by lowering λ, from the last state that rests
                if onward is None:
                    is_fold = ended = True
                    break
                after, length = onward, 0.01
            else:
                after, used = found
                if point.tangent[-1] < 0.0 < after.tangent[-1]:
                    fold = self._least(point, length)
                    if fold.log_reduction < best.log_reduction:
                        best, is_fold = fold, True
                length = min(length * (2.0 if used < 5 else 1.0), 1.0)
            if after.log_reduction < best.log_reduction:
                best, is_fold = after, False
            point = after
            if math.sqrt(float(point.u @ point.u)) > _RUNS * start:
                ended = True
                break
            if point.log_reduction > best.log_reduction + math.log(_TURNED):
                ended = True
                break
        if not ended:
            return self.none("the elastic path has no end")
        running = None if is_fold else self._running(best)
        if running is not None:
            return running
        return self._found(best.u, best.u, best.tangent[:-1], math.exp(best.log_reduction), not is_fold)

    def _begin(self, u: Floats, reduction: float) -> _Point | None:
        """A state of rest as a point of the path that goes on toward less strength."""
        at = self.forces(u, u, reduction, False)
        down = np.append(np.zeros(len(u)), -1.0)
        tangent = self._tangent(at, reduction, math.sqrt(float(u @ u)), down)
        return None if tangent is None else _Point(u, math.log(reduction), tangent)

    def _march(self, point: _Point) -> _Point | None:
        """On from a state of rest by lowering λ alone: the farthest state that is found; None where there is none."""
        part, reached = 0.05, None
        while part > _LEAST_PART:
            reduction = math.exp(point.log_reduction) * (1.0 - part)
            rest = self._flow(point.u, reduction)
            begun = None if rest is None else self._begin(rest, reduction)
            if begun is not None:
                reached = begun
                break
            part /= 5.0
        return reached

    def _least(self, point: _Point, length: float) -> _Point:
        """The least λ within a step: where its tangent turns up, by regula falsi (Illinois)."""
        low, high, best = 0.0, length, point
        at_low, at_high = float(point.tangent[-1]), 1.0
        side = 0
        for count in range(30):
            at = (low * at_high - high * at_low) / (at_high - at_low) if count else 0.5 * length
            found = self._step(point, at)
            if found is None:
                break
            turns = float(found[0].tangent[-1])
            if found[0].log_reduction < best.log_reduction:
                best = found[0]
            if turns > 0.0:
                high, at_high, at_low = at, turns, at_low * (0.5 if side == 1 else 1.0)
                side = 1
            else:
                low, at_low, at_high = at, turns, at_high * (0.5 if side == -1 else 1.0)
                side = -1
            if abs(turns) < _LEVEL or high - low < _LEVEL * length:
                break
        return best

    # -- the running state --------------------------------------------------------------------------------

    def _running(self, point: _Point) -> CrackedBase | None:
        """The state that the path settles to, by Newton's method; None where there is none near."""
        motion = point.tangent[:-1] / math.sqrt(float(point.tangent[:-1] @ point.tangent[:-1]))
        closed = []
        for rows in self.rows:
            if (rows[:, 0] @ point.u).min() < 0.0:
                closed.append(rows[:, 0])
        free, rest = split_space(np.concatenate(closed)) if closed else (np.eye(len(motion)), None)
        if rest is None or free.shape[1] == 0 or rest.shape[1] == 0:
            return None
        along, elastic = free.T @ motion, rest.T @ point.u
        if float(along @ along) < 0.5:
            return None
        along = along / math.sqrt(float(along @ along))
        reduction = math.exp(point.log_reduction)
        first, count = free.shape[1], len(motion)
        matrix = np.zeros((count + 1, count + 1))
        for _ in range(3 * _MOST_NEWTON):
            v, w = free @ along, rest @ elastic
            at = self.forces(w, v, reduction, True)
            out = np.append(at.out, 0.5 * (float(along @ along) - 1.0))
            size = float(np.abs(out).max())
            if size < 1e-13 * max(1.0, reduction):
                break
            matrix[:count, :first] = at.by_slip @ free
            matrix[:count, first:count] = at.by_opening @ rest
            matrix[:count, count] = at.by_reduction
            matrix[count, :first] = along
            unit = 1.0 / np.maximum(np.abs(matrix).max(axis=0), 1e-300)
            try:
                step = -np.linalg.solve(matrix * unit, out) * unit
            except np.linalg.LinAlgError:
                return None
            along, elastic = along + step[:first], elastic + step[first:count]
            reduction += float(step[count])
            if not (reduction > 0.0 and float(np.abs(step).max()) < 1e9):
                return None
        else:
            if size > 1e-9 * max(1.0, reduction):
                return None
        if abs(reduction / math.exp(point.log_reduction) - 1.0) > 0.05:
            return None
        return self._found(w, v, v, reduction, True)

    def _found(self, opening: Floats, slip: Floats, velocity: Floats, reduction: float, runs: bool) -> CrackedBase:
        bed = self.bed
        exact = runs and slip is velocity
        at = self.forces(opening, slip, reduction, exact)
        parts, shares, places, pushes = [], [], [], []
        for k, rows in enumerate(self.rows):
            weights, _ = _pressed(rows[:, 0] @ opening)
            if weights is None:
                parts.append(np.zeros((0, 3)))
                shares.append(0.0)
                places.append(np.full(3, math.nan))
                pushes.append(0.0)
                continue
            corners = weights @ bed.corners[k]
            motions, area = self._cells(k, np.tensordot(weights, rows, 1), corners)
            push = -(motions[:, 0] @ opening) * area
            where, _ = self._cells_at(corners)
            parts.append(corners)
            shares.append(_size(corners) / _size(bed.corners[k]))
            places.append((push @ where) / push.sum())
            pushes.append(float(push.sum()))
        return CrackedBase(
            1.0 / reduction, "", runs, opening, velocity / math.sqrt(float(velocity @ velocity)), tuple(parts),
            np.array(shares), np.array(places), np.array(pushes), float(np.abs(at.out).max()), self.points,
        )  # fmt: skip

    def _cells_at(self, corners: Floats) -> tuple[Floats, None]:
        if len(corners) == 2:
            return self.templates[2][0] @ corners, None
        fan = np.arange(1, len(corners) - 1)
        which = np.stack([np.zeros_like(fan), fan, fan + 1], axis=1)
        return (self.templates[3][0] @ corners[which]).reshape(-1, 3), None

    def none(self, why: str) -> CrackedBase:
        """No limit, and why."""
        count, unknowns = len(self.rows), len(self.bed.load)
        return CrackedBase(
            None, why, False, np.zeros(unknowns), np.zeros(unknowns), (np.zeros((0, 3)),) * count, np.zeros(count),
            np.full((count, 3), math.nan), np.zeros(count), math.nan, self.points,
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
    found: dict[tuple[float, ...], float] = {}
    for cell in cells:
        for point, weight in (*((corner, 1.0 / 12.0) for corner in cell), (cell.mean(axis=0), 3.0 / 4.0)):
            key = tuple(np.round(point, 12).tolist())
            found[key] = found.get(key, 0.0) + weight * share
    points = np.array(list(found))
    return points / points.sum(axis=1)[:, None], np.array(list(found.values()))


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
