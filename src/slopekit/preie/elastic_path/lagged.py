"""Thousands of blocks in space at rest on elastic joints but for a rounding, where Newton's method finds no rest.

The law of the joints at one strength λ, as an interior-point method has it, each pair with its own friction:

    N / a = -B_n u + G + λ μ (z - ẑ),    T / (k_t A) = -B_t u + Z,    |T| <= λ (c A + μ N),    N G = b,  (z, Z) ∘ Q = b

G is how far a pair is open, Z its slip and z the size of that, Q = (λ r, T), b a barrier that goes to nothing. With ẑ
nothing slip would dilate by all of its friction angle: the equations of a convex program. With ẑ = z it dilates not at
all. ẑ is the z of the step before (fixed point of Acary, Cadoux, Lemaréchal & Malick 2011, ZAMM 91, 155): every step is
one of a convex program, with one symmetric factorisation. Where blocks rest z - ẑ goes to nothing; where they do not it
grows from step to step, as their slip does.

What is left of N G and of z - ẑ, in parts of the elastic energy, is the rounding of the law. Forces balance, and are
within their strength, as in any rest: where the rounding is small and only slivers are out of balance yet, the forces
go to the nearest that balance, each change in parts of what it may be (Dikin 1967, Soviet Math. Dokl. 8, 674), and what
that adds to the joints counts as rounding. Of 3,199 blocks two slivers are out of balance after twice as many steps.
"""

import copy
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import SolverError
from slopekit.core.onlooker import say
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces
from slopekit.preie.elastic_path.flow import Flow
from slopekit.preie.kernels import compiled
from slopekit.preie.programs.cone_steps import PAIR, determinant
from slopekit.preie.solvers.fronts import Solver
from slopekit.preie.tolerances import DIAGONAL_SHIFT, LAGGED_ROUNDING, SPRING_ROUNDING, TINY
from slopekit.strength.mohr_coulomb import line

#: To begin with: the least normal force in parts of the lighter block's load, the barrier in parts of the mean energy
#: of a pair, friction in parts of what it may be.
_LIFTED, _BARRIER, _HALF = 0.3, 0.3, 0.5
_MOST, _TO_BOUNDARY = 250, 0.9  # steps; part of the way to where a force or gap is nothing
#: What the barrier falls to in a step, by how long the last one was.
_FALLS = (0.5, 0.25), (0.1, 0.5), (0.0, 0.8)
#: The barrier stays above a part of what ẑ lags by: the largest first, half of it at a time where in so many steps what
#: ẑ lags by has not fallen to `_LESS`, down to the least. The least all along takes twice as many steps far from one.
_LARGEST, _LEAST, _LESS, _PATIENCE = 0.3, 0.1, 0.8, 12
#: Corrections of a step at most, how long it has to be to need none, how much farther it is to go, and what that is
#: worth; products of a force and its gap then, in parts of the barrier: the inverse is the largest. Of 3,199 blocks a
#: factorisation takes ten times as long as a correction, and with two of them there are twice as many steps.
_CORRECTIONS, _LONG, _FARTHER, _WORTH, _LEAST_PRODUCT = 8, 0.95, 0.3, 0.01, 0.1
_SLIVERS, _EVERY = 0.01, 5  # part of the blocks out of balance, and steps after which their forces are tried
_RUNS, _SURE = 10.0, 30  # what ẑ lags by grows to so many times its least, after so many steps: they do not rest


@dataclass
class _Point:
    """A point of the method: u (N,), N (m,), T (m, 2), G (m,), cones (m, 3) and their multipliers (m, 3)."""

    moved: Floats
    normal: Floats
    friction: Floats
    gap: Floats
    cone: Floats
    slip: Floats

    def taken(self, step: "_Point", length: float) -> "_Point":
        """The point after so much of a step."""
        return _Point(
            self.moved + length * step.moved, self.normal + length * step.normal,
            self.friction + length * step.friction, self.gap + length * step.gap, self.cone + length * step.cone,
            self.slip + length * step.slip,
        )  # fmt: skip


def lagged_rest(bed: Bed, parameter: float) -> Flow | None:
    """All blocks at rest at one strength λ, the law of their joints rounded by what the flow says.

    None where they do not come to rest this way. Only of joints that do not dilate, without bolts, and with compiled
    kernels: they have the steps.
    """
    flow = lagged_flow(bed, parameter)
    return flow if flow is not None and flow.ended == "rest" else None


def lagged_flow(bed: Bed, parameter: float) -> Flow | None:
    """The same, or that they run: what ẑ lags by grows to `_RUNS` times its least. None where neither is seen."""
    if compiled() is None or bed.dilates or bed.bolted is not None or bed.tangents == 1:
        return None
    say("rest of all blocks but for a rounding, strength divided by", 1.0 / parameter)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return _run(_Law(bed, parameter))


class _Law:
    """The joints of a bed at one strength."""

    def __init__(self, bed: Bed, parameter: float) -> None:
        self.bed, self.contacts = bed, bed.stiffness.contacts
        self.give, self.soft, self.shift = 1.0 / bed.area, 1.0 / bed.spring, DIAGONAL_SHIFT
        self.friction, self.cohesion = parameter * bed.friction, parameter * bed.cohesion
        self.none = np.zeros(bed.pairs)
        _, self.load = bed.drive.at(parameter)

    def rigid(self) -> "_Law":
        """The same strengths of joints that do not give."""
        other = copy.copy(self)
        other.give, other.soft, other.shift = self.none, self.none, 0.0
        return other

    def begun(self) -> _Point:
        """Joints that stick, their normal forces kept above nothing."""
        bed, model = self.bed, self.bed.model
        opening, slip = model.opening_and_slip(bed.elastic_displacement)
        own = bed.unbalanced_at_most[:: model.unknowns] / float(bed.unbalanced_at_most.max())
        own *= float(np.sqrt((model.load * model.load).sum(axis=1)).max())
        lighter = np.minimum(own[model.plus], np.where(model.minus < 0, np.inf, own[model.minus]))[model.pair_contact]
        normal = np.maximum(-bed.area * opening, _LIFTED * lighter)
        friction = -bed.spring[:, None] * slip
        room = line(self.cohesion, self.friction, normal)
        size = np.sqrt((friction * friction).sum(axis=1))
        friction *= np.minimum(1.0, _HALF * room / np.maximum(size, TINY))[:, None]
        barrier = _BARRIER * float((self.give * normal * normal).mean())
        cone = np.hstack([room[:, None], friction])
        slips = barrier * cone / determinant(cone)[:, None]
        slips[:, 1:] *= -1.0
        return _Point(bed.elastic_displacement.copy(), normal, friction, barrier / normal, cone, slips)


@dataclass
class _Residuals:
    """What is off at a point: (m,), (m, 2), (m, 3), (N,); what is left of the products, what ẑ lags by, the energy."""

    normal: Floats
    slip: Floats
    cone: Floats
    balance: Floats
    left: float
    lags: float
    energy: float

    @classmethod
    def of(cls, law: _Law, at: _Point) -> "_Residuals":
        normal, slip, cone = np.empty_like(at.normal), np.empty_like(at.friction), np.empty_like(at.cone)
        balance = law.load.copy()
        _, left, _ = compiled().cone_residuals(
            law.contacts, law.give, law.soft, law.friction, law.none, law.cohesion, at.normal, at.friction, at.gap,
            at.cone, at.slip, at.moved, 0.0, normal, slip, cone, balance,
        )  # fmt: skip
        normal += law.friction * at.slip[:, 0]  # ẑ is what z was before this step
        lags = float(np.abs(normal * at.normal).sum() + np.abs(slip * at.friction).sum())
        energy = float((law.give * at.normal**2).sum() + (law.soft[:, None] * at.friction**2).sum())
        return cls(normal, slip, cone, balance, left, lags, energy)

    @property
    def rounding(self) -> float:
        """What the law is rounded by, in parts of the elastic energy."""
        return max(self.left, self.lags) / self.energy


def _run(law: _Law) -> Flow | None:
    bed, before = law.bed, law.begun()
    at = before
    length, least, part, lagged, since = 1.0, np.inf, _LARGEST, np.inf, 0
    for taken in range(_MOST):
        off = _Residuals.of(law, at)
        if off.rounding < LAGGED_ROUNDING:
            rest = _balanced(law, at, off, taken % _EVERY == 0)
            if rest is not None:
                return rest
        least = min(least, off.lags)
        if off.lags < _LESS * lagged:
            lagged, since = off.lags, taken
        elif taken - since > _PATIENCE:
            part, lagged, since = max(0.5 * part, _LEAST), off.lags, taken
        if not np.isfinite(off.left):
            break
        if taken > _SURE and off.lags > _RUNS * least:
            return Flow(at.moved, _forces(law, at, off), "runs", before.moved, 0.0, off.rounding)
        falls = next(falls for at_least, falls in _FALLS if length >= at_least)
        aim = max(falls * off.left, part * min(off.lags, _RUNS * off.left))
        try:
            step, length = _Equations(law, at, off).step(aim / (2.0 * bed.pairs))
        except SolverError:
            break
        before, at = at, at.taken(step, length)
    return None


def _balanced(law: _Law, at: _Point, off: _Residuals, to_nearest: bool) -> Flow | None:
    """The rest at a point where all blocks balance, or, `to_nearest`, all but slivers; None where they do not."""
    bed = law.bed
    out = np.abs(off.balance) >= bed.unbalanced_at_most
    if out.any() and to_nearest and out.reshape(-1, bed.model.unknowns).any(axis=1).mean() < _SLIVERS:
        none = np.zeros_like(off.normal), np.zeros_like(off.slip), np.zeros_like(off.cone)
        alone = replace(off, normal=none[0], slip=none[1], cone=none[2])
        try:
            step, _ = _Equations(law.rigid(), at, alone).direction(none[0], none[2])
        except SolverError:
            return None
        at = replace(at, normal=at.normal + step.normal, friction=at.friction + step.friction)
        off = _Residuals.of(law, at)
        out = np.abs(off.balance) >= bed.unbalanced_at_most
        room = line(law.cohesion, law.friction, at.normal) - np.sqrt((at.friction * at.friction).sum(axis=1))
        out |= bool(at.normal.min() <= 0.0 or room.min() <= 0.0 or off.rounding >= LAGGED_ROUNDING)
    if out.any():
        return None
    return Flow(at.moved, _forces(law, at, off), "rest", at.moved, 0.0, off.rounding)


class _Equations:
    """Newton's equations at a point, factorised: those of a convex program, after Nesterov & Todd."""

    def __init__(self, law: _Law, at: _Point, off: _Residuals) -> None:
        bed, kernels = law.bed, compiled()
        self.law, self.at, self.off = law, at, off
        self.pairs, local, border = np.empty((bed.pairs, PAIR)), np.empty_like(bed.elastic), np.zeros(bed.size)
        kernels.cone_springs(
            law.contacts, law.give, law.soft, law.friction, law.none, at.normal, at.gap, at.cone, at.slip, self.pairs,
            local, border,
        )  # fmt: skip
        bed.factorisations += 1
        self.solver: Solver = bed.stiffness.factored(local, law.shift, True)

    def step(self, barrier: float) -> tuple[_Point, float]:
        """Towards a barrier, with corrections of the products that would go astray (Gondzio 1996); and its length."""
        at, kernels = self.at, compiled()
        middle, of_normal = np.empty_like(at.slip), np.empty_like(at.normal)
        target, to_cone = np.empty_like(at.slip), np.empty_like(at.slip)
        kernels.cone_middle(self.pairs, at.slip, middle)
        low, high = _LEAST_PRODUCT * barrier, barrier / _LEAST_PRODUCT

        def aim(step: _Point, length: float) -> None:
            kernels.cone_targets(
                self.pairs, at.cone, at.slip, step.normal, step.gap, step.cone, step.slip, middle, barrier, length, low,
                high, of_normal, target, to_cone,
            )  # fmt: skip

        none = np.zeros_like(at.cone)
        aim(_Point(at.moved, self.law.none, none, self.law.none, none, none), -1.0)
        step, length = self.direction(of_normal, to_cone)
        for _ in range(_CORRECTIONS):
            if length > _LONG:
                break
            aim(step, min(1.0, length + _FARTHER))
            corrected, now = self.direction(of_normal, to_cone)
            before = length
            if now > before:
                step, length = corrected, now
            if now < before + _WORTH:
                break
        return step, length

    def direction(self, to_normal: Floats, to_cone: Floats) -> tuple[_Point, float]:
        """The step towards given products of the normal forces (m,) and of the cones (m, 3), and its length."""
        at, off, kernels, contacts = self.at, self.off, compiled(), self.law.contacts
        normal, friction, gap = np.empty_like(at.normal), np.empty_like(at.friction), np.empty_like(at.gap)
        cone, slip, forces = np.empty_like(at.cone), np.empty_like(at.slip), off.balance.copy()
        offs = off.normal, off.slip, off.cone
        kernels.cone_sources(contacts, self.pairs, to_normal, to_cone, *offs, normal, friction, forces)
        moved = self.solver(forces)
        most = kernels.cone_step(
            contacts, self.pairs, moved, 0.0, float(at.normal.mean() / at.gap.mean()), to_normal, to_cone, *offs,
            at.cone, at.slip, normal, friction, cone, gap, slip,
        )  # fmt: skip
        return _Point(moved, normal, friction, gap, cone, slip), min(1.0, _TO_BOUNDARY * most)


def _forces(law: _Law, at: _Point, off: _Residuals) -> BedForces:
    """The forces of a point that is at rest; pairs touch where they are pressed more than they are open."""
    bed = law.bed
    touching = law.give * at.normal > at.gap
    size = np.sqrt((at.friction * at.friction).sum(axis=1))
    slips = at.slip[:, 0] > law.soft * size  # more than it gives
    return BedForces(
        at.normal, at.friction, line(bed.cohesion, bed.friction, at.normal), touching, slips,
        -at.friction / np.maximum(size, TINY)[:, None], law.soft * size + at.slip[:, 0], off.balance,
        max(bed.load_size, float(at.normal.max())), SPRING_ROUNDING * float(at.normal.max()),
    )  # fmt: skip
