"""The cracked base: one block on an elastic bed without tension (`polygon_bed`), followed until its motion runs.

From a strength that holds the block λ = 1/F goes down and the displacement u is followed by arc length in (u, ln λ).
F = 1/λ at the least λ. Either λ passes through a least value while the block is still at rest (the pressed part, and
its cohesion with it, then goes faster than strength is called on), or it settles while the motion runs; there Newton's
method finds the running state itself, as `limit_state` does with all pairs closed:

    g = B_n Y w,   direction of slip = B_t Z v,   unknowns w, v (|v| = 1), λ

(Z: motions that keep the pressed contacts closed, Y: the rest). Where the path has a corner λ is lowered by itself and
the block flows (dashpots, implicit steps) until it rests or runs. Forces scale with the stiffness, displacements
against it: F depends on the ratio of the two springs only.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.one_block.polygon_bed import BedSprings, PointForces, PolygonBed, Unbalanced, beds_of
from slopekit.preie.solvers.linear import split_space
from slopekit.preie.solvers.newton import balanced
from slopekit.preie.tolerances import (
    EQUILIBRIUM,
    FARTHEST,
    FINER_PRESSED,
    LEVEL,
    PATH_ENDS,
    POLISHED,
    ROUNDING,
    SETTLED,
    TINY,
)

_SPLIT, _MOST_SPLIT = 3, 4  # each triangle of a pressed part is split in four so often, and at most so often
_MOST_NEWTON = 14  # steps to one point of the path; where it takes more, the step along it was too long
_MOST_STUCK = 150  # steps to where every point sticks: a hundred where a millionth of the load is left before tipping
_MOST_WORK = 3000  # times the forces are summed; a second or two, after which the last state of rest is the limit
_RUNS = 1e4  # times the first displacement: what has moved so far runs
_TURNED = 1.2  # λ so far above its least value does not come back
_MARCH = 0.05  # of λ: the first step by λ alone; each next is a fifth of it
_FIRST, _LONGEST = 0.1, 4.0  # steps along the path, in parts of the displacement so far and of λ
_TURNS, _STRAYS = 0.8, 0.5  # cosine of the angle that a step may turn by, and parts of it that it may leave the tangent
_STRAIGHT, _STRAIGHTER = 0.98, 0.9999  # where the path turns by less, the next step is twice or four times as long
_LEAST_LEARNT = 0.2  # a step of Newton's method may be so much shorter, or longer, by what the last one missed
_CORNER = 1e-3  # steps may turn by more where they are as short: the path has corners where a point begins to slip
_STRONG = 4.0  # the path starts at this many times the strength that the guess needs, or at more
_HARDEST = 1024.0  # times that strength: what does not rest then, does not rest
#: So many times the strength that forces in balance need is the most that is tried.
STRONGEST = _STRONG * _HARDEST
_FLOWS = 30.0  # times the displacement: what flows so far runs
_SETTLES = 5.0  # times its slope: λ of a path that runs is as near to that of the running state
_CALMER = 0.7  # of what drove it: a block that flows and is driven by less may come to rest
_MOST_FLOW = 40  # steps of viscous flow
_SNAP = 10.0  # elastic displacements: a block that comes to rest again within them has not failed
EARLY = 30.0  # elastic displacements, beyond which a path that creeps has all but failed
_STIFFEST = 1e3  # viscous resistance, in parts of the bonded stiffness, that Newton's method must manage


@dataclass(frozen=True, slots=True)
class CrackedBase:
    """The limit of a block on its cracked base.

    Attributes
    ----------
    factor : F, None where it is not at rest at any strength, or the path was lost
    why_not : a sentence where there is none
    runs : the motion runs at a settled λ; False: λ went through its least value with the block still at rest
    creeps : it runs, but about an edge: F is that of the last point, below what a line of contact gives in the end
    opening, velocity : (u,) elastic displacement and unit motion at the limit
    forces : of the points of the bed
    change : what splitting the triangles once more does to F, in parts of it (first order)
    residual : unbalanced force in parts of the load; points : of the path
    early_factor : the largest F reached within `EARLY` elastic displacements, where the limit lies farther; else None
    is_unstable : the block rests at no strength
    """

    factor: float | None
    why_not: str
    runs: bool = False
    creeps: bool = False
    opening: Floats | None = None
    velocity: Floats | None = None
    forces: PointForces | None = None
    change: float = 0.0
    residual: float = 0.0
    points: int = 0
    early_factor: float | None = None
    is_unstable: bool = False


def cracked_base(bed: PolygonBed, guess: float) -> CrackedBase:
    """Follow the block on its elastic bed from a strength that holds it to the least that does.

    Parameters
    ----------
    guess : a factor of safety of about the right size; the path starts at a quarter of it or less
    """
    for split in range(_SPLIT, _MOST_SPLIT + 1):
        base = cracked_limit(bed, guess, split)
        if base.factor is None or base.change < FINER_PRESSED:
            break
    return base


def cracked_limit(bed: PolygonBed, guess: float, split: int) -> CrackedBase:
    """The same, on triangles that are split in four `split` times."""
    path = _Path(bed, split)
    begun = path.start(_STRONG / guess)
    if begun is None:
        return CrackedBase(None, "the block does not rest on its bed at any strength", is_unstable=True)
    return path.follow(*begun)


@dataclass(frozen=True, slots=True)
class _PathPoint:
    """A point of the path: u, ln λ, and the unit tangent of the two."""

    u: Floats
    log_reduction: float
    tangent: Floats

    @property
    def displacement(self) -> float:
        """The size of u."""
        return math.sqrt(float(self.u @ self.u))


@dataclass(frozen=True, slots=True)
class _Fold:
    """A step of the path on which λ stops falling, from one point to the next; `length` along the tangent."""

    before: _PathPoint
    after: _PathPoint
    length: float

    @property
    def lowest(self) -> float:
        """ln λ is not less on it, as far as its ends say."""
        return _meet(self.before, self.after, self.length)[1]


class _Path:
    """The elastic path of one bed."""

    def __init__(self, bed: PolygonBed, split: int) -> None:
        self.bed, self.split = bed, split
        self.springs = BedSprings(beds_of([bed]), split)
        self.points = self.work = 0

    def forces(
        self, opening: Floats, slip: Floats, reduction: float, running: bool, sticks: bool = False
    ) -> Unbalanced:
        """The unbalanced forces, counted."""
        self.work += 1
        return of_one(self.springs, opening, slip, reduction, running, sticks)

    def start(self, reduction: float) -> tuple[Floats, float] | None:
        """The block at rest where a first point slips; else at a λ of this size or the least multiple with a rest."""
        begin, most = self.springs.bonded[0], reduction * _HARDEST
        stuck = self._stuck(reduction)
        if stuck is not None:
            first = self.springs.first_slip(stuck)
            if most / _HARDEST**2 < first < most:
                return stuck, first
            begin = stuck
        while reduction < most:
            for rests in (self._rest, self._flow):
                rest = rests(begin, reduction)
                if rest is not None:
                    return rest, reduction
            reduction *= 4.0
        return None

    def _rest(self, u: Floats, reduction: float, slow: float = 0.0) -> Floats | None:
        """Newton's method at one λ; `slow` parts of the bonded stiffness hold the block back to u."""
        drag, small = slow * self.springs.stiffness[0], SETTLED * max(1.0, reduction)

        def forces(at: Floats) -> tuple[Floats, Unbalanced]:
            there = self.forces(at, at, reduction, False)
            return there.out - drag @ (at - u), there

        rest, _, size = balanced(forces, lambda _, there: there.by_opening + there.by_slip - drag, u, small)
        return rest if size <= small else None

    def _stuck(self, reduction: float) -> Floats | None:
        """The block at rest with every point stuck, by Newton's method from the bonded displacement; None without one.

        Full steps: each takes a third of a pressed part that is too large, however little of it the load leaves.
        """
        u, small = self.springs.bonded[0], SETTLED * max(1.0, reduction)
        for _ in range(_MOST_STUCK):
            at = self.forces(u, u, reduction, False, sticks=True)
            if float(np.abs(at.out).max()) <= small:
                return u
            try:
                u = u - np.linalg.solve(at.by_opening + at.by_slip, at.out)
            except np.linalg.LinAlgError:
                return None
        return None

    def _flow(self, u: Floats, reduction: float) -> Floats | None:
        """Where the block comes to rest at one λ if it may move slowly from u (implicit viscous flow); None if not."""
        slow, pushed, far = 1.0, math.inf, _FLOWS * max(self.springs.first[0], math.sqrt(float(u @ u)))
        for _ in range(_MOST_FLOW):
            if self.work > _MOST_WORK:
                return None
            at_rest = self._rest(u, reduction, slow=slow)
            if at_rest is None:
                slow *= 4.0
                if slow > _STIFFEST:
                    return None
                continue
            moved = at_rest - u
            push = slow * float(np.abs(self.springs.stiffness[0] @ moved).max())
            u, slow = at_rest, slow * 0.2
            # where what drives the block grows as it goes there is no rest near
            rest = self._rest(u, reduction) if push < _CALMER * pushed else None
            if rest is not None:
                return rest
            pushed = push
            if math.sqrt(float(u @ u)) > far or not float(np.abs(moved).max()) > 0.0:
                return None
        return None

    def _tangent(self, at: Unbalanced, reduction: float, scale: float, before: Floats) -> Floats | None:
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

    def _step(self, point: _PathPoint, length: float, smooth: bool = True) -> tuple[_PathPoint, float] | None:
        """The point of the path that lies `length` along the tangent, in parts of the displacement so far.

        And the cosine of the angle by which the path turns on the way. `smooth`: None where it turns or leaves the
        tangent by too much for the step to be one along the same path.
        """
        scale = math.sqrt(float(point.u @ point.u))
        count = len(point.u)
        goal = np.append(point.u / scale, point.log_reduction)
        y = ahead = goal + length * point.tangent
        matrix = np.empty((count + 1, count + 1))
        matrix[count] = point.tangent
        last, part, before = math.inf, 1.0, goal
        for used in range(_MOST_NEWTON):
            u, reduction = y[:count] * scale, math.exp(float(y[count]))
            at = self.forces(u, u, reduction, False)
            size = float(np.abs(at.out).max())
            if size < SETTLED * max(1.0, reduction):
                tangent = self._tangent(at, reduction, scale, point.tangent)
                if tangent is None:
                    return None
                turned, off = float(tangent @ point.tangent), y - ahead
                strays = turned < _TURNS or float(off @ off) > (_STRAYS * length) ** 2
                if smooth and length > _CORNER and strays:
                    return None
                # the next step is measured in this point's own displacement
                renewed = np.append(tangent[:count] * scale, tangent[count])
                renewed[:count] /= math.sqrt(float(u @ u))
                return _PathPoint(u, float(y[count]), renewed / math.sqrt(float(renewed @ renewed))), turned
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
            if used:
                # the slopes know nothing of how the points of a sum move: what they miss is learnt from step to step
                change = step - before
                learnt = -part * float(before @ change) / max(float(change @ change), TINY)
                part = learnt if _LEAST_LEARNT < learnt < 1.0 / _LEAST_LEARNT else 1.0
            y, before = y + part * step, step
        return None

    def follow(self, u: Floats, reduction: float) -> CrackedBase:
        """The path from a state of rest to the least λ."""
        begun = self._begin(u, reduction)
        if begun is None:
            return CrackedBase(None, "the elastic path could not be followed")
        point = best = begun
        folds: list[_Fold] = []
        last = point, _FIRST
        elastic = math.sqrt(float(u @ u))
        length, most, is_fold, ended = _FIRST, _RUNS * elastic, False, False
        early = begun.log_reduction
        while not ended:
            self.points += 1
            if self.work > _MOST_WORK:
                is_fold = True
                break
            stepped = self._step(point, length)
            if stepped is None:
                length /= 4.0
                if length > PATH_ENDS:
                    continue
                best, is_fold = self._lowest(folds, best, is_fold)
                onward = self._snapped(best, elastic)  # a corner of the path
                if onward is None:
                    is_fold = True
                    break
                after, length, folds = onward, _FIRST / 10.0, []
            else:
                after, turned = stepped
                if length > _CORNER and _misses(point, after, length):
                    length /= 4.0
                    continue
                if point.tangent[-1] < 0.0 < after.tangent[-1]:
                    folds.append(_Fold(point, after, length))
                longer = 4.0 if turned > _STRAIGHTER else 2.0 if turned > _STRAIGHT else 1.0
                last, length = (point, length), min(length * longer, _LONGEST)
            early = min(early, _within(point, after, EARLY * elastic))
            if after.log_reduction < best.log_reduction:
                best, is_fold = after, False
            point = after
            ended = point.displacement > most
            if not ended and point.log_reduction > best.log_reduction + math.log(_TURNED):
                best, is_fold = self._lowest(folds, best, is_fold)
                onward = self._snapped(best, elastic, 0.5 * _MARCH)
                ended = onward is None
                if onward is not None:
                    point = best = onward
                    length, is_fold, folds = _FIRST / 10.0, False, []
        best, is_fold = self._lowest(folds, best, is_fold)
        # far along a path that settles λ changes by no more than its slope there
        slope = 0.0 if is_fold else abs(float(best.tangent[-1]))
        running = self._running(best, POLISHED + _SETTLES * slope)
        if running is None and ended and best is point:
            best = self._landed(*last, point, most)
        limit = running or self._at_rest(best, not is_fold)
        return replace(limit, early_factor=math.exp(-early)) if best.displacement > EARLY * elastic else limit

    def _snapped(self, point: _PathPoint, elastic: float, least: float = PATH_ENDS) -> _PathPoint | None:
        """Lower λ alone from a state of rest; None where the block runs, or rests only too far off to be at rest."""
        onward = self._march(point, least)
        if onward is None:
            return None
        moved = onward.u - point.u
        return onward if math.sqrt(float(moved @ moved)) <= _SNAP * elastic else None

    def _landed(self, before: _PathPoint, length: float, after: _PathPoint, most: float) -> _PathPoint:
        """Where between two points of a path that creeps the displacement is `most`, however long the steps were."""
        for _ in range(_MOST_NEWTON):
            start, end = before.displacement, after.displacement
            if abs(end / most - 1.0) < PATH_ENDS:
                break
            length *= (most - start) / (end - start)
            landed = self._step(before, length, smooth=False)
            if landed is None:
                break
            after = landed[0]
        return after

    def _lowest(self, folds: "list[_Fold]", best: _PathPoint, is_fold: bool) -> tuple[_PathPoint, bool]:
        """The point of least λ, on the folds passed as well, and whether it is on one of them."""
        for fold in sorted(folds, key=lambda fold: fold.lowest):
            if fold.lowest >= best.log_reduction - SETTLED:
                break
            least = self._least(fold)
            if least.log_reduction <= best.log_reduction:
                best, is_fold = least, True
        folds.clear()
        return best, is_fold

    def _begin(self, u: Floats, reduction: float) -> _PathPoint | None:
        """A state of rest as a point of the path that goes on toward less strength."""
        at = self.forces(u, u, reduction, False)
        down = np.append(np.zeros(len(u)), -1.0)
        tangent = self._tangent(at, reduction, math.sqrt(float(u @ u)), down)
        return None if tangent is None else _PathPoint(u, math.log(reduction), tangent)

    def _march(self, point: _PathPoint, least: float = PATH_ENDS) -> _PathPoint | None:
        """On from a state of rest by lowering λ alone: the farthest state that is found; None where there is none."""
        part = _MARCH
        while part > least:
            reduction = math.exp(point.log_reduction) * (1.0 - part)
            rest = self._flow(point.u, reduction)
            begun = None if rest is None else self._begin(rest, reduction)
            if begun is not None:
                return begun
            part /= 5.0
        return None

    def _least(self, fold: "_Fold") -> _PathPoint:
        """The least λ on a fold: where the cubic by its ends is least, or at a corner, where their tangents meet."""
        low, high, span = fold.before, fold.after, fold.length
        for count in range(60):
            best = min(low, high, key=lambda point: point.log_reduction)
            at, least = _meet(low, high, span)
            if best.log_reduction - least < LEVEL**2 or span < LEVEL * fold.length:
                break
            at = at if count % 2 else _bottom(low, high, span)
            if count % 6 == 5 or not 0.0 < at < span:
                at = 0.5 * span
            step = self._step(low, at, smooth=False)
            if step is None:
                break
            if abs(step[0].tangent[-1]) < LEVEL:
                return step[0]
            if step[0].tangent[-1] < 0.0:
                low = step[0]
                span = _along(low, high)
            else:
                high, span = step[0], at
        return best

    # -- the running state --------------------------------------------------------------------------------

    def _running(self, point: _PathPoint, near: float) -> CrackedBase | None:
        """The state that the path settles to, by Newton's method; None where there is none as near as that in λ."""
        motion = _motion(point)
        closed = []
        for rows in map(self.bed.corner_rows, range(len(self.bed.corners))):
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
            if size < ROUNDING * max(1.0, reduction):
                break
            matrix[:count, :first] = at.by_slip @ free
            matrix[:count, first:count] = at.by_opening @ rest
            matrix[:count, count] = at.by_reduction
            matrix[count, :first] = along
            unit = 1.0 / np.maximum(np.abs(matrix).max(axis=0), TINY)
            try:
                step = -np.linalg.solve(matrix * unit, out) * unit
            except np.linalg.LinAlgError:
                return None
            along, elastic = along + step[:first], elastic + step[first:count]
            reduction += float(step[count])
            if not (reduction > 0.0 and float(np.abs(step).max()) < FARTHEST):
                return None
        else:
            if size > EQUILIBRIUM * max(1.0, reduction):
                return None
        if abs(reduction / math.exp(point.log_reduction) - 1.0) > near:
            return None
        velocity, slip = v / math.sqrt(float(v @ v)), v
        change = self._change(lambda springs: of_one(springs, w, slip, reduction, True), matrix)
        return CrackedBase(
            1.0 / reduction, "", True, False, w, velocity, self.springs.carried(self.bed, w, v, reduction, True),
            change / reduction, size, self.points,
        )  # fmt: skip

    def _at_rest(self, point: _PathPoint, creeps: bool) -> CrackedBase:
        """A limit at a point of the path."""
        u, reduction = point.u, math.exp(point.log_reduction)
        scale, count = math.sqrt(float(u @ u)), len(u)
        at = self.forces(u, u, reduction, False)
        matrix = np.empty((count + 1, count + 1))
        matrix[:count, :count] = (at.by_opening + at.by_slip) * scale
        matrix[:count, count] = at.by_reduction * reduction
        matrix[count] = point.tangent
        change = self._change(lambda springs: of_one(springs, u, u, reduction, False), matrix)
        velocity = _motion(point)
        return CrackedBase(
            1.0 / reduction, "", creeps, creeps, u, velocity, self.springs.carried(self.bed, u, u, reduction, False), change,
            float(np.abs(at.out).max()), self.points,
        )  # fmt: skip

    def _change(self, forces: Callable[[BedSprings], Unbalanced], matrix: Floats) -> float:
        """What the last unknown moves by when triangles are split once more, to first order."""
        finer = forces(BedSprings(beds_of([self.bed]), self.split + 1)).out
        try:
            return abs(float(np.linalg.solve(matrix, np.append(finer, 0.0))[-1]))
        except np.linalg.LinAlgError:
            return math.inf


def of_one(springs: BedSprings, opening: Floats, slip: Floats, reduction: float, running: bool, sticks: bool = False) -> Unbalanced:
    one = springs.unbalanced(np.zeros(1, dtype=np.int64), opening[None], slip[None], np.array([reduction]), running, sticks)
    return Unbalanced(one.out[0], one.by_opening[0], one.by_slip[0], one.by_reduction[0])


def _within(before: _PathPoint, after: _PathPoint, most: float) -> float:
    """Return the least ln λ of a step of the path up to the displacement `most`; inf where it lies beyond."""
    start, end = before.displacement, after.displacement
    if end <= most:
        return after.log_reduction
    if start >= most:
        return math.inf
    part = (most - start) / (end - start)
    return before.log_reduction + part * (after.log_reduction - before.log_reduction)


def _misses(before: _PathPoint, after: _PathPoint, length: float) -> bool:
    """Whether λ does between two points what its slopes at them cannot make: it turned on the way."""
    slope, after_slope = float(before.tangent[-1]), float(after.tangent[-1])
    change = after.log_reduction - before.log_reduction
    if slope < 0.0 < after_slope:
        return not 0.0 < _meet(before, after, length)[0] < length
    return slope * after_slope > 0.0 > slope * change and abs(change) > POLISHED


def _along(before: _PathPoint, after: _PathPoint) -> float:
    """How far a point of the path lies along the tangent at another."""
    moved = (after.u - before.u) / math.sqrt(float(before.u @ before.u))
    ahead = float(before.tangent[-1]) * (after.log_reduction - before.log_reduction)
    return float(before.tangent[:-1] @ moved) + ahead


def _meet(before: _PathPoint, after: _PathPoint, span: float) -> tuple[float, float]:
    """Where between two points on either side of a fold their tangents in ln λ meet, and at which ln λ."""
    down, up = float(before.tangent[-1]), float(after.tangent[-1])
    at = (after.log_reduction - before.log_reduction - up * span) / (down - up)
    return at, before.log_reduction + down * at


def _bottom(before: _PathPoint, after: _PathPoint, span: float) -> float:
    """Where between them the cubic with their ln λ and its slopes is least."""
    down, up = float(before.tangent[-1]), float(after.tangent[-1])
    rise = 3.0 * (before.log_reduction - after.log_reduction) / span + down + up
    root = math.sqrt(max(rise * rise - down * up, 0.0))
    return span * (1.0 - (up + root - rise) / (up - down + 2.0 * root))


def _motion(point: _PathPoint) -> Floats:
    """The unit motion on from a point; that so far where less strength does not move it (all of it sticks)."""
    motion = point.tangent[:-1]
    size = math.sqrt(float(motion @ motion))
    if size < LEVEL:
        motion, size = point.u, math.sqrt(float(point.u @ point.u))
    return np.asarray(motion / size, dtype=np.float64)
