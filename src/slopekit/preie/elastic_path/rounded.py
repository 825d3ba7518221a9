"""The elastic path of joints with rounded corners, followed by its arc length, and made sharp far down it.

Where contacts trade places the path of sharp joints has a corner for each, and Newton's method loses its way. Rounded,

    gap_i = a_i⁻¹ N_i + (B_n u)_i,    N_i gap_i = κ        (sharp, κ = 0: one of the two is zero)
    z_g = (k_t A_g)⁻¹ T_g + (B_t u)_g,    (λ r_g, T_g) ∘ (|z|_g, z_g) = (κ, 0),    r = Σ c + μ Σ N

(∘ of second-order cones: T runs against the slip z that is not elastic, and |T| < λ r) it is one smooth curve through
peaks and snaps. u = W v, W the work of the load, with N, T, gaps, slips and λ as unknowns of their own: products are
nearly linear in them, far along a motion too, where a displacement-only Newton method would have to hit forces of
order one with displacements of many thousand. Then κ goes to nothing at one W; what is left is a state of the joints of
`elastic_path.bed`. (Allgower & Georg 2003, ch. 6, for the step lengths; Alizadeh, Haeberly & Overton 1998 for the
linearised products.)
"""

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import Fault, SolverError
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.tolerances import ALIGNED, EACH_BALANCED, LIGHTEST, SHARP, TINY

_FIRST, _LONGEST, _SHORTEST = 0.3, 2.0, 1e-4  # steps along the curve, 1 being a change of all forces or of W by e
_CORRECTIONS = 8  # of a step
_CENTRED = 0.5  # products, and what is off in the joints, in parts of κ
_KEPT = 0.1  # part of a gap, force or slip that one step leaves at least
_ROOM = 0.3  # part of what is free below the strength that it leaves
_STARTS = 40  # corrections before the first step
_BISECTED = 60
_TURN = 1.5  # the most a correction may go along the curve

_Solver = Callable[["_Residual"], "_CurvePoint"]


def along_rows(a: Floats, b: Floats) -> Floats:
    """The products of the rows of two arrays, (g,)."""
    products: Floats = a[:, 0] * b[:, 0]
    for k in range(1, a.shape[1]):  # two or three: four times as fast as einsum
        products += a[:, k] * b[:, k]
    return products


@dataclass(frozen=True)
class _CurvePoint:
    """A point of the curve, or a change of one: v (N,), N, gaps (m,), T (g, t), |z| (g,), z (g, t), λ."""

    velocity: Floats
    normal: Floats
    gap: Floats
    friction: Floats
    size: Floats
    slip: Floats
    reduction: float

    def plus(self, change: "_CurvePoint", part: float = 1.0) -> "_CurvePoint":
        """The point after a part of a change."""
        return _CurvePoint(*(getattr(self, of.name) + part * getattr(change, of.name) for of in fields(self)))

    def times(self, part: float) -> "_CurvePoint":
        """A part of a change."""
        return _CurvePoint(*(part * getattr(self, of.name) for of in fields(self)))


@dataclass(frozen=True)
class _Residual:
    """Residuals: balance (N,), normal (m,) and shear (g, t) joints, products (m,), (g,), (g, t), and the work."""

    balance: Floats
    opening: Floats
    shear: Floats
    pressing: Floats
    sliding: Floats
    across: Floats
    work: float


class RoundedPath:
    """The curve of one bed, from a state at rest onward.

    Attributes
    ----------
    passed : λ and displacement (N,) of every step, the first first
    """

    def __init__(self, bed: Bed, rounding: float) -> None:
        """`rounding` is κ in parts of a mean load of a contact times its elastic displacement."""
        self.bed = bed
        model = bed.model
        own = np.sqrt((model.load * model.load).sum(axis=1))
        lighter = np.append(own, np.inf)
        lighter = np.minimum(lighter[model.plus], lighter[model.minus])
        area = np.bincount(model.pair_contact, bed.area, len(model.plus))
        self._unit = float((lighter * lighter / area).mean())
        self._own = np.repeat(np.maximum(own, LIGHTEST * float(own.max())), model.unknowns)
        self._give, self._shear_give = 1.0 / bed.area, 1.0 / bed.spring
        self._rounding = math.log(rounding)
        self._work = 0.0
        self.passed: list[tuple[float, Floats]] = []

    @property
    def work(self) -> float:
        """Of the load, in parts of the elastic."""
        return math.exp(self._work) / self.bed.elastic_work

    @property
    def displacement(self) -> Floats:
        """(N,)."""
        return self._at.velocity * math.exp(self._work)

    @property
    def forces(self) -> tuple[Floats, Floats]:
        """Normal (m,) and friction (g, t) forces."""
        return self._at.normal, self._at.friction

    @property
    def reduction(self) -> float:
        """λ."""
        return self._at.reduction

    # -- the way along the curve ------------------------------------------------------------------------------------

    def begin(self, displacement: Floats, reduction: float) -> bool:
        """Onto the curve, at the work of a state at rest near it."""
        work = float(self.bed.working @ displacement)
        if not work > 0.0:
            return False
        self._work = math.log(work)
        self._at = self._from_displacement(displacement, reduction)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for _ in range(_STARTS):
                product = self._product(self._work, self._rounding)
                try:
                    residual, solve = self._linear(self._at, self._work, product)
                except SolverError:
                    return False
                if self._on_curve(self._at, residual, product):
                    self.passed.append((self._at.reduction, displacement))
                    return True
                self._at = self._moved(self._at, solve(residual), product)
        return False

    def onto(self, work: float, most: int) -> bool:
        """On to a work, in parts of the elastic; False where `most` factorisations do not get there."""
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            curve_point = self._along(
                self._at, self._work, self._rounding, True, lambda there, _: there > work, most, self.passed
            )
        if curve_point is None:
            return False
        self._at, self._work, self._rounding = curve_point
        return True

    def sharpened(self, most: int, left: float = SHARP) -> "RoundedPath | None":
        """The path of joints whose rounding is `left`, from the same work on; None where `most` factorisations do not
        get there.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            curve_point = self._along(
                self._at, self._work, self._rounding, False, lambda _, there: there < left, most, []
            )
        if curve_point is None:
            return None
        sharp = copy.copy(self)
        sharp._at, sharp._work, sharp._rounding = curve_point
        sharp.passed = [(sharp.reduction, sharp.displacement)]
        return sharp

    def _along(
        self, at: _CurvePoint, work: float, rounding: float, grows: bool, ends: Callable[[float, float], bool],
        most: int, passed: list[tuple[float, Floats]],
    ) -> tuple[_CurvePoint, float, float] | None:  # fmt: skip
        """From a point on the curve until `ends` (W in parts of the elastic, κ): W grows, or κ falls, by steps.

        Steps go along the tangent, corrections square to it.
        """
        most += self.bed.factorisations
        by_work, by_rounding = (1.0, 0.0) if grows else (0.0, -1.0)
        _, solve = self._linear(at, work, self._product(work, rounding))
        length, way, along = _FIRST, None, 0.0
        while self.bed.factorisations < most:
            tangent = self._tangent(at, solve, work, rounding, grows)
            along_it = 1.0 / math.sqrt(self._inner(tangent, tangent, at) + 1.0)
            if way is not None and self._inner(tangent, way, at) + along < 0.0:
                along_it = -along_it
            way, along = tangent.times(along_it), along_it
            while True:
                stepped = self._stepped(at, way, along, length, (work, rounding), grows)
                if stepped is not None or self.bed.factorisations > most:
                    break
                length *= 0.4
                if length < _SHORTEST:
                    return None
            if stepped is None:
                return None
            at, moved, corrections, solve = stepped
            work, rounding = work + by_work * moved, rounding + by_rounding * moved
            if grows:
                passed.append((at.reduction, at.velocity * math.exp(work)))
            if ends(math.exp(work) / self.bed.elastic_work, math.exp(rounding)):
                return at, work, rounding
            longer = 2.0 if corrections <= 2 else 1.4 if corrections == 3 else 1.0 if corrections <= 5 else 0.7
            length = min(_LONGEST, length * longer)
        return None

    def _stepped(
        self,
        start: _CurvePoint,
        way: _CurvePoint,
        along: float,
        length: float,
        before: tuple[float, float],
        grows: bool,
    ) -> tuple[_CurvePoint, float, int, _Solver] | None:
        """A point so far along, how far W or κ went, corrections, and the solver there; None where it is not found."""
        moved = along * length
        by_work, by_rounding = (1.0, 0.0) if grows else (0.0, -1.0)
        at = self._moved(
            start, way.times(length), self._product(before[0] + by_work * moved, before[1] + by_rounding * moved)
        )
        for corrections in range(_CORRECTIONS + 1):
            work, rounding = before[0] + by_work * moved, before[1] + by_rounding * moved
            product = self._product(work, rounding)
            try:
                residual, solve = self._linear(at, work, product)
            except SolverError:
                return None
            if self._on_curve(at, residual, product):
                return at, moved, corrections, solve
            if not np.isfinite(residual.balance).all():
                return None
            change, tangent = solve(residual), self._tangent(at, solve, work, rounding, grows)
            square = self._inner(way, tangent, start) + along
            turn = -self._inner(way, change, start) / square if square else math.inf
            if not abs(turn) < _TURN:
                return None
            moved += turn
            product = self._product(before[0] + by_work * moved, before[1] + by_rounding * moved)
            at = self._moved(at, change.plus(tangent, turn), product)
        return None

    def _inner(self, one: _CurvePoint, other: _CurvePoint, at: _CurvePoint) -> float:
        """Product of two changes, forces, velocities and λ in parts of what they are."""
        forces = float(at.normal @ at.normal) + float((at.friction * at.friction).sum())
        changed = float(one.normal @ other.normal) + float((one.friction * other.friction).sum())
        moved = float(one.velocity @ other.velocity) / float(at.velocity @ at.velocity)
        return changed / forces + moved + one.reduction * other.reduction / at.reduction**2

    # -- the equations ----------------------------------------------------------------------------------------------

    def _product(self, work: float, rounding: float) -> float:
        """κ, of forces and velocities."""
        return math.exp(rounding - work) * self._unit

    def _strength(self, normal: Floats) -> Floats:
        return self.bed.strengths.at(normal, self.bed.cohesion)

    def _motion(self, velocity: Floats) -> tuple[Floats, Floats]:
        relative = self.bed.rows @ velocity
        pairs = self.bed.pairs
        return relative[:pairs], relative[pairs:].reshape(self.bed.groups, self.bed.tangents)

    def _on_blocks(self, normal: Floats, friction: Floats) -> Floats:
        forces: Floats = self.bed.columns @ np.concatenate([normal, friction.ravel()])
        return forces

    def _from_displacement(self, displacement: Floats, reduction: float) -> _CurvePoint:
        """What the rounded law says at a displacement."""
        slow, product = math.exp(-self._work), self._product(self._work, self._rounding)
        opening, slip = self._motion(displacement * slow)
        give = slow * self._give
        root = np.sqrt(opening * opening + 4.0 * give * product)
        pressed = (root - opening) / (2.0 * give)
        gap = np.where(opening < 0.0, product / np.maximum(pressed, TINY), (opening + root) / 2.0)
        normal = product / gap
        allowed, give = reduction * self._strength(normal), slow * self._shear_give
        size = np.sqrt(along_rows(slip, slip))
        low, high = np.zeros_like(size), allowed.copy()
        for _ in range(_BISECTED):
            middle = (low + high) / 2.0
            room = np.maximum((allowed - middle) * (allowed + middle), TINY)
            less = middle * (give + product / room) < size
            low, high = np.where(less, middle, low), np.where(less, high, middle)
        room = np.maximum((allowed - low) * (allowed + low), TINY)
        friction = -slip * (low / np.maximum(size, TINY))[:, None]
        return _CurvePoint(
            displacement * slow, normal, gap, friction, product * allowed / room, -product * friction / room[:, None],
            reduction,
        )  # fmt: skip

    def _on_curve(self, at: _CurvePoint, residual: _Residual, product: float) -> bool:
        """Whether what is off does not matter."""
        allowed = at.reduction * self._strength(at.normal)
        across = np.sqrt(along_rows(residual.across, residual.across)) / (product + ALIGNED * allowed * at.size)
        joints = max(
            float(np.abs(residual.opening * at.normal).max()), float(np.abs(residual.shear * at.friction).max())
        )
        products = max(float(np.abs(residual.pressing).max()), float(np.abs(residual.sliding).max()), joints)
        return (
            products < _CENTRED * product
            and float(across.max()) < _CENTRED
            and float((np.abs(residual.balance) / self._own).max()) < EACH_BALANCED
        )

    def _tangent(self, at: _CurvePoint, solve: _Solver, work: float, rounding: float, grows: bool) -> _CurvePoint:
        """How a point of the curve changes with log W, or with -log κ."""
        product = self._product(work, rounding)
        slow = -math.exp(-work) if grows else 0.0
        return solve(_Residual(
            np.zeros_like(at.velocity), slow * self._give * at.normal, slow * self._shear_give[:, None] * at.friction,
            np.full(len(at.normal), product), np.full(len(at.size), product), np.zeros_like(at.slip), 0.0,
        ))  # fmt: skip

    def _linear(self, at: _CurvePoint, work: float, product: float) -> tuple[_Residual, _Solver]:
        """What is off at a point, and a solver of the linearised equations.

        Raises
        ------
        SolverError
            E599 they are singular.
        """
        bed, slow = self.bed, math.exp(-work)
        give, shear_give = slow * self._give, slow * self._shear_give
        strength = self._strength(at.normal)
        allowed, follows = at.reduction * strength, at.reduction * bed.strengths.slopes(at.normal)
        opening, slip = self._motion(at.velocity)
        residual = _Residual(
            self._on_blocks(at.normal, at.friction) + bed.drive.load,
            give * at.normal + opening - at.gap,
            shear_give[:, None] * at.friction + slip - at.slip,
            at.normal * at.gap - product,
            allowed * at.size + along_rows(at.friction, at.slip) - product,
            allowed[:, None] * at.slip + at.size[:, None] * at.friction,
            float(bed.working @ at.velocity) - 1.0,
        )  # fmt: skip
        # (|z|, T) of each cone from its two equations, z being what the slip and T make it
        lean = at.size + shear_give * allowed
        bent = at.slip + shear_give[:, None] * at.friction
        corner = allowed - along_rows(bent, at.friction) / lean

        def of_cones(first: Floats, rest: Floats) -> tuple[Floats, Floats]:
            size: Floats = (first - along_rows(bent, rest) / lean) / corner
            return size, (rest - at.friction * size[:, None]) / lean[:, None]

        t = bed.tangents
        tangent, by_slip = np.empty((bed.groups, t, t)), np.empty_like(at.slip)
        for k in range(t):
            right = np.zeros_like(at.slip)
            right[:, k] = -allowed
            by_slip[:, k], tangent[:, :, k] = of_cones(-at.friction[:, k], right)
        size_by_strength, by_strength = of_cones(-at.size, -at.slip)
        springs = 1.0 / (give + at.gap / at.normal)
        solver = bed.factored(bed.mixed(springs, tangent, by_strength, follows))
        by_reduction = solver(self._on_blocks(np.zeros_like(at.normal), by_strength * strength[:, None]))
        gained = float(bed.working @ by_reduction)
        if not gained:  # far off any curve, where forces overflow
            raise SolverError([Fault("E599", "the work of the rounded path does not hang on its strength")])
        opened = at.gap * float(at.normal.mean()) > at.normal * float(at.gap.mean())

        def solve(residual: _Residual) -> _CurvePoint:
            pressed = springs * (-residual.pressing / at.normal - residual.opening)
            size, dragged = of_cones(
                -residual.sliding - along_rows(at.friction, residual.shear),
                -residual.across - allowed[:, None] * residual.shear,
            )
            stronger = bed.strengths.followed(follows, pressed)
            velocity = solver(residual.balance + self._on_blocks(pressed, dragged + by_strength * stronger[:, None]))
            reduction = (-residual.work - float(bed.working @ velocity)) / gained
            velocity = velocity + reduction * by_reduction
            opens, slips = self._motion(velocity)
            normal = pressed - springs * opens
            stronger = bed.strengths.followed(follows, normal) + strength * reduction
            friction = dragged + np.matmul(tangent, slips[:, :, None])[:, :, 0] + by_strength * stronger[:, None]
            # each is a large number there, and rounding does not matter
            gap = np.where(
                opened, residual.opening + opens + give * normal, (-residual.pressing - at.gap * normal) / at.normal
            )
            return _CurvePoint(
                velocity, normal, gap, friction, size + along_rows(by_slip, slips) + size_by_strength * stronger,
                residual.shear + slips + shear_give[:, None] * friction, reduction,
            )  # fmt: skip

        return residual, solve

    def _moved(self, at: _CurvePoint, change: _CurvePoint, product: float) -> _CurvePoint:
        """A point after a step, every force, gap and slip kept where it may be, one by one."""
        reduction = max(at.reduction + change.reduction, _KEPT * at.reduction)
        normal = np.maximum(at.normal + change.normal, _KEPT * at.normal)
        gap = np.maximum(at.gap + change.gap, _KEPT * at.gap)
        allowed = reduction * self._strength(normal)
        # a slip may shrink to a part of itself, not turn round
        back, square = along_rows(at.slip, change.slip), along_rows(at.slip, at.slip)
        part = np.where(back < -(1.0 - _KEPT) * square, (1.0 - _KEPT) * square / np.maximum(-back, TINY), 1.0)
        slip = at.slip + part[:, None] * change.slip
        size = np.sqrt(along_rows(slip, slip))
        friction = at.friction + change.friction
        carried = np.sqrt(along_rows(friction, friction))
        # what the product says friction carries with that slip, and some of the room that it leaves
        most = (np.sqrt(product * product + (2.0 * size * allowed) ** 2) - product) / np.maximum(2.0 * size, TINY)
        room = np.maximum(_ROOM * (allowed * allowed - most * most), 1e-14 * allowed * allowed)
        cut = np.where(
            allowed * allowed - carried * carried < room, np.sqrt(np.maximum(allowed * allowed - room, 0.0)), carried
        )
        friction = friction * (cut / np.maximum(carried, TINY))[:, None]
        least = np.sqrt(size * size + (_ROOM * product) ** 2 / np.maximum(allowed * allowed - cut * cut, TINY))
        return _CurvePoint(
            at.velocity + change.velocity, normal, gap, friction, np.maximum(at.size + part * change.size, least),
            slip, reduction,
        )  # fmt: skip
