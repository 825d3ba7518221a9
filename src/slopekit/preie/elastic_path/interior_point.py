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
from slopekit.core.progress import report_stage
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState
from slopekit.preie.elastic_path.flow import Flow
from slopekit.preie.kernels import compiled
from slopekit.preie.programs.cone_steps import PAIR, determinant
from slopekit.preie.solvers.fronts import Solver
from slopekit.preie.tolerances import DIAGONAL_SHIFT, LAGGED_ROUNDING, SPRING_ROUNDING, TINY
from slopekit.strength.mohr_coulomb import line

#: To begin with: the least normal force in parts of the lighter block's load, the barrier in parts of the mean energy
#: of a pair, friction in parts of what it may be.
_FIRST_NORMAL, _BARRIER, _FIRST_FRICTION = 0.3, 0.3, 0.5
_MAX_STEPS, _TO_BOUNDARY = 250, 0.9  # steps; part of the way to where a force or gap is nothing
#: What the barrier falls to in a step, by how long the last one was.
_BARRIER_REDUCTIONS = (0.5, 0.25), (0.1, 0.5), (0.0, 0.8)
#: The barrier stays above a fraction of what ẑ lags by: the largest first, halved down to the least where that lag has
#: not fallen to `_PROGRESS` of itself in `_PATIENCE` steps. The least all along takes twice as many steps far from one.
_LARGEST_FRACTION, _LEAST_FRACTION, _PROGRESS, _PATIENCE = 0.3, 0.1, 0.8, 12
#: Corrections of a step at most, how long it has to be to need none, how much farther it is to go, and what that is
#: worth; products of a force and its gap then, in parts of the barrier: the inverse is the largest. Of 3,199 blocks a
#: factorisation takes ten times as long as a correction, and with two of them there are twice as many steps.
_MAX_CORRECTIONS, _LONG_STEP, _LENGTH_GAIN, _LEAST_GAIN, _LEAST_PRODUCT = 8, 0.95, 0.3, 0.01, 0.1
_SLIVER_FRACTION, _BALANCE_INTERVAL = (
    0.01,
    5,
)  # part of the blocks out of balance, and steps after which their forces are tried
_RUNNING_GROWTH, _RUNNING_AFTER = (
    10.0,
    30,
)  # what ẑ lags by grows to so many times its least, after so many steps: they do not rest


@dataclass
class _Point:
    """A point of the method: u (N,), N (m,), T (m, 2), G (m,), cones (m, 3) and their multipliers (m, 3)."""

    displacement: Floats
    normal: Floats
    friction: Floats
    gap: Floats
    cone: Floats
    slip: Floats

    def stepped_by(self, step: "_Point", length: float) -> "_Point":
        """The point after so much of a step."""
        return _Point(
            self.displacement + length * step.displacement,
            self.normal + length * step.normal,
            self.friction + length * step.friction,
            self.gap + length * step.gap,
            self.cone + length * step.cone,
            self.slip + length * step.slip,
        )


def interior_point_equilibrium(bed: ElasticContactModel, parameter: float) -> Flow | None:
    """All blocks at rest at one strength λ, the law of their joints rounded by what the flow says.

    None where they do not come to rest this way. Only of joints that do not dilate, without bolts, and with compiled
    kernels: they have the steps.
    """
    flow = interior_point_flow(bed, parameter)
    return flow if flow is not None and flow.ended == "rest" else None


def interior_point_flow(bed: ElasticContactModel, parameter: float) -> Flow | None:
    """Return the flow of all blocks at one strength λ, at rest or running; None where neither is seen."""
    if compiled() is None or bed.dilates or bed.bolted is not None or bed.tangents == 1:
        return None
    report_stage("rest of all blocks but for a rounding, strength divided by", 1.0 / parameter)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return _iterate(_Law(bed, parameter))


class _Law:
    """The joints of a bed at one strength."""

    def __init__(self, bed: ElasticContactModel, parameter: float) -> None:
        self.bed, self.contacts = bed, bed.stiffness.contacts
        self.normal_compliance, self.shear_compliance, self.shift = (
            1.0 / bed.area,
            1.0 / bed.spring,
            DIAGONAL_SHIFT,
        )
        self.friction, self.cohesion = parameter * bed.friction, parameter * bed.cohesion
        self.zeros = np.zeros(bed.pairs)
        _, self.load = bed.drive.strength_and_load(parameter)

    def rigid(self) -> "_Law":
        """Return the same strengths on rigid joints, without compliance."""
        rigid_law = copy.copy(self)
        rigid_law.normal_compliance, rigid_law.shear_compliance, rigid_law.shift = (
            self.zeros,
            self.zeros,
            0.0,
        )
        return rigid_law

    def first_point(self) -> _Point:
        """Joints that stick, their normal forces kept above nothing."""
        bed, model = self.bed, self.bed.model
        opening, slip = model.opening_and_slip(bed.elastic_displacement)
        block_loads = bed.unbalanced_at_most[:: model.unknowns] / float(
            bed.unbalanced_at_most.max()
        )
        block_loads *= float(np.sqrt((model.load * model.load).sum(axis=1)).max())
        lighter = np.minimum(
            block_loads[model.plus], np.where(model.minus < 0, np.inf, block_loads[model.minus])
        )[model.pair_contact]
        normal = np.maximum(-bed.area * opening, _FIRST_NORMAL * lighter)
        friction = -bed.spring[:, None] * slip
        room = line(self.cohesion, self.friction, normal)
        size = np.sqrt((friction * friction).sum(axis=1))
        friction *= np.minimum(1.0, _FIRST_FRICTION * room / np.maximum(size, TINY))[:, None]
        barrier = _BARRIER * float((self.normal_compliance * normal * normal).mean())
        cone = np.hstack([room[:, None], friction])
        slips = barrier * cone / determinant(cone)[:, None]
        slips[:, 1:] *= -1.0
        return _Point(
            bed.elastic_displacement.copy(), normal, friction, barrier / normal, cone, slips
        )


@dataclass
class _Residuals:
    """Residuals of a point: (m,), (m, 2), (m, 3), (N,); remaining products, the lag of ẑ, the energy."""

    normal: Floats
    slip: Floats
    cone: Floats
    balance: Floats
    products: float
    lag: float
    energy: float

    @classmethod
    def at_point(cls, law: _Law, point: _Point) -> "_Residuals":
        normal, slip, cone = (
            np.empty_like(point.normal),
            np.empty_like(point.friction),
            np.empty_like(point.cone),
        )
        balance = law.load.copy()
        _, products, _ = compiled().cone_residuals(
            law.contacts,
            law.normal_compliance,
            law.shear_compliance,
            law.friction,
            law.zeros,
            law.cohesion,
            point.normal,
            point.friction,
            point.gap,
            point.cone,
            point.slip,
            point.displacement,
            0.0,
            normal,
            slip,
            cone,
            balance,
        )
        normal += law.friction * point.slip[:, 0]  # ẑ is what z was before this step
        lag = float(np.abs(normal * point.normal).sum() + np.abs(slip * point.friction).sum())
        energy = float(
            (law.normal_compliance * point.normal**2).sum()
            + (law.shear_compliance[:, None] * point.friction**2).sum()
        )
        return cls(normal, slip, cone, balance, products, lag, energy)

    @property
    def rounding(self) -> float:
        """The rounding of the law of the joints, in parts of the elastic energy."""
        return max(self.products, self.lag) / self.energy


def _iterate(law: _Law) -> Flow | None:
    bed, previous = law.bed, law.first_point()
    point = previous
    length, least_lag, fraction, last_lag, last_progress = 1.0, np.inf, _LARGEST_FRACTION, np.inf, 0
    for step_number in range(_MAX_STEPS):
        residuals = _Residuals.at_point(law, point)
        if residuals.rounding < LAGGED_ROUNDING:
            rest = _balanced_flow(law, point, residuals, step_number % _BALANCE_INTERVAL == 0)
            if rest is not None:
                return rest
        least_lag = min(least_lag, residuals.lag)
        if residuals.lag < _PROGRESS * last_lag:
            last_lag, last_progress = residuals.lag, step_number
        elif step_number - last_progress > _PATIENCE:
            fraction, last_lag, last_progress = (
                max(0.5 * fraction, _LEAST_FRACTION),
                residuals.lag,
                step_number,
            )
        if not np.isfinite(residuals.products):
            break
        if step_number > _RUNNING_AFTER and residuals.lag > _RUNNING_GROWTH * least_lag:
            return Flow(
                point.displacement,
                _contact_state(law, point, residuals),
                "runs",
                previous.displacement,
                0.0,
                residuals.rounding,
            )
        falls = next(falls for at_least, falls in _BARRIER_REDUCTIONS if length >= at_least)
        target = max(
            falls * residuals.products,
            fraction * min(residuals.lag, _RUNNING_GROWTH * residuals.products),
        )
        try:
            step, length = _Equations(law, point, residuals).step(target / (2.0 * bed.pairs))
        except SolverError:
            break
        previous, point = point, point.stepped_by(step, length)
    return None


def _balanced_flow(
    law: _Law, point: _Point, residuals: _Residuals, to_nearest: bool
) -> Flow | None:
    """The rest at a point where all blocks balance, or, `to_nearest`, all but slivers; None where they do not."""
    bed = law.bed
    is_unbalanced = np.abs(residuals.balance) >= bed.unbalanced_at_most
    if (
        is_unbalanced.any()
        and to_nearest
        and is_unbalanced.reshape(-1, bed.model.unknowns).any(axis=1).mean() < _SLIVER_FRACTION
    ):
        zeros = (
            np.zeros_like(residuals.normal),
            np.zeros_like(residuals.slip),
            np.zeros_like(residuals.cone),
        )
        balance_only = replace(residuals, normal=zeros[0], slip=zeros[1], cone=zeros[2])
        try:
            step, _ = _Equations(law.rigid(), point, balance_only).direction(zeros[0], zeros[2])
        except SolverError:
            return None
        point = replace(
            point, normal=point.normal + step.normal, friction=point.friction + step.friction
        )
        residuals = _Residuals.at_point(law, point)
        is_unbalanced = np.abs(residuals.balance) >= bed.unbalanced_at_most
        room = line(law.cohesion, law.friction, point.normal) - np.sqrt(
            (point.friction * point.friction).sum(axis=1)
        )
        is_unbalanced |= bool(
            point.normal.min() <= 0.0 or room.min() <= 0.0 or residuals.rounding >= LAGGED_ROUNDING
        )
    if is_unbalanced.any():
        return None
    return Flow(
        point.displacement,
        _contact_state(law, point, residuals),
        "rest",
        point.displacement,
        0.0,
        residuals.rounding,
    )


class _Equations:
    """Newton's equations at a point, factorised: those of a convex program, after Nesterov & Todd."""

    def __init__(self, law: _Law, point: _Point, residuals: _Residuals) -> None:
        bed, kernels = law.bed, compiled()
        self.law, self.point, self.residuals = law, point, residuals
        self.pairs, local, border = (
            np.empty((bed.pairs, PAIR)),
            np.empty_like(bed.elastic),
            np.zeros(bed.size),
        )
        kernels.cone_springs(
            law.contacts,
            law.normal_compliance,
            law.shear_compliance,
            law.friction,
            law.zeros,
            point.normal,
            point.gap,
            point.cone,
            point.slip,
            self.pairs,
            local,
            border,
        )
        bed.factorisations += 1
        self.solver: Solver = bed.stiffness.factored(local, law.shift, True)

    def step(self, barrier: float) -> tuple[_Point, float]:
        """Towards a barrier, with corrections of the products that would go astray (Gondzio 1996); and its length."""
        point, kernels = self.point, compiled()
        middle, to_normal = np.empty_like(point.slip), np.empty_like(point.normal)
        target, to_cone = np.empty_like(point.slip), np.empty_like(point.slip)
        kernels.cone_middle(self.pairs, point.slip, middle)
        low, high = _LEAST_PRODUCT * barrier, barrier / _LEAST_PRODUCT

        def set_targets(step: _Point, length: float) -> None:
            kernels.cone_targets(
                self.pairs,
                point.cone,
                point.slip,
                step.normal,
                step.gap,
                step.cone,
                step.slip,
                middle,
                barrier,
                length,
                low,
                high,
                to_normal,
                target,
                to_cone,
            )

        zeros = np.zeros_like(point.cone)
        set_targets(
            _Point(point.displacement, self.law.zeros, zeros, self.law.zeros, zeros, zeros), -1.0
        )
        step, length = self.direction(to_normal, to_cone)
        for _ in range(_MAX_CORRECTIONS):
            if length > _LONG_STEP:
                break
            set_targets(step, min(1.0, length + _LENGTH_GAIN))
            corrected, corrected_length = self.direction(to_normal, to_cone)
            last_length = length
            if corrected_length > last_length:
                step, length = corrected, corrected_length
            if corrected_length < last_length + _LEAST_GAIN:
                break
        return step, length

    def direction(self, to_normal: Floats, to_cone: Floats) -> tuple[_Point, float]:
        """The step towards given products of the normal forces (m,) and of the cones (m, 3), and its length."""
        point, residuals, kernels, contacts = (
            self.point,
            self.residuals,
            compiled(),
            self.law.contacts,
        )
        normal, friction, gap = (
            np.empty_like(point.normal),
            np.empty_like(point.friction),
            np.empty_like(point.gap),
        )
        cone, slip, forces = (
            np.empty_like(point.cone),
            np.empty_like(point.slip),
            residuals.balance.copy(),
        )
        residual_arrays = residuals.normal, residuals.slip, residuals.cone
        kernels.cone_sources(
            contacts, self.pairs, to_normal, to_cone, *residual_arrays, normal, friction, forces
        )
        displacement = self.solver(forces)
        max_length = kernels.cone_step(
            contacts,
            self.pairs,
            displacement,
            0.0,
            float(point.normal.mean() / point.gap.mean()),
            to_normal,
            to_cone,
            *residual_arrays,
            point.cone,
            point.slip,
            normal,
            friction,
            cone,
            gap,
            slip,
        )
        return _Point(displacement, normal, friction, gap, cone, slip), min(
            1.0, _TO_BOUNDARY * max_length
        )


def _contact_state(law: _Law, point: _Point, residuals: _Residuals) -> ContactState:
    """The forces of a point that is at rest; pairs touch where they are pressed more than they are open."""
    bed = law.bed
    touching = law.normal_compliance * point.normal > point.gap
    size = np.sqrt((point.friction * point.friction).sum(axis=1))
    slips = point.slip[:, 0] > law.shear_compliance * size  # more than it gives
    return ContactState(
        point.normal,
        point.friction,
        line(bed.cohesion, bed.friction, point.normal),
        touching,
        slips,
        -point.friction / np.maximum(size, TINY)[:, None],
        law.shear_compliance * size + point.slip[:, 0],
        residuals.balance,
        max(bed.load_size, float(point.normal.max())),
        SPRING_ROUNDING * float(point.normal.max()),
    )
