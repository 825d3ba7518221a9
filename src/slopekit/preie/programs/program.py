"""The smallest load factor of an assembly: one cone program, solved by our own interior-point method.

For friction strengths r (frozen) and tangents t of the dilation it finds the smallest λ = 1/F for which

    Bᵀ f + (1 - σ) P = 0,    N >= 0,    |T_g| <= λ r_g + t_g (Σ N - N̂),    σ >= 0

balance: minimise λ + M σ + ε/2 fᵀ C f. σ sheds load where nothing balances it all (the blocks fall, whatever their
strength); ε C, the give of an even elastic bed, makes the forces unique. The multipliers are the velocities of the
mechanism. Strengths that follow the normal forces, r = c A + μ Σ N, make it the equations of the limit state (slip
does not dilate: no convex program, and its Jacobian is not symmetric) or those of the static bound (normality).

A passive bolt, 0 <= T <= λ r, is a force λ r/2 beside the loads, and a friction force of strength r/2 about it.

Why not a general solver: without the forces of its contacts a block has 3 or 6 unknowns in a narrow band, a next pass
starts from the iterates of the last, strengths may follow the normal forces, and the bound's λ needs no bisection.
"""

import math
from collections.abc import Callable

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import SolverError
from slopekit.core.records import dataclass
from slopekit.preie.programs.cones import Scaling, determinant, product, quotient, scaling
from slopekit.preie.programs.iterates import Iterate, IterateStep
from slopekit.preie.programs.springs import Coupling, Springs
from slopekit.preie.solvers.stiffness import SparseStiffness
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.patterns import ContactPattern
from slopekit.preie.tolerances import (
    DIAGONAL_SHIFT,
    EACH_BALANCED,
    LIGHTEST,
    MOTION_RESIDUAL,
    NO_FORCE,
    NO_MOTION,
    PARALLEL,
    TINY,
)
from slopekit.strength.mohr_coulomb import line

MOST_STEPS = 150  # it takes 20 to 60
MOST_LOAD = 1e3  # M: load is shed rather than strength raised more than so often
GIVE = 1e-8  # ε: a thousandth of it moves the static bound of few blocks by less than it is known to
_START = 0.1  # least normal force to start from, in parts of the mean
CRAWL, STALLED = 0.01, 8  # so many steps as short as that: the boundary holds it
_FRUITLESS = 25  # steps in which the complementarity has not fallen by a fifth
_RELEASES, _ROUGH = 40, 1e6  # rounds of letting go; springs of contacts in parts of the inertia
_LEAST_CENTRING = 1e-6  # products fall to so little in a step at most


@dataclass(frozen=True, slots=True)
class Strengths:
    """What friction carries.

    Attributes
    ----------
    dilation : (g,) tangents
    frozen : (g,) r, or None where it follows the normal forces
    apart : (g,) what friction carries beside λ r + t Σ N: t times less than none, -t N̂, where r was frozen at sums N̂
    normality : where r follows them: the share of normality by which slip opens at least, 1 for the static bound
    """

    dilation: Floats
    frozen: Floats | None = None
    apart: Floats | None = None
    normality: float = 0.0

    @property
    def symmetric(self) -> bool:
        """Whether the equations are those of a minimum."""
        return self.frozen is not None or self.normality == 1.0


@dataclass(frozen=True, slots=True)
class ProgramResult:
    """The last iterate, whether it settled, and steps taken.

    `unbalanced` is the largest unbalanced force in parts of the load of the block it acts on.
    """

    at: Iterate
    settled: bool
    steps: int
    unbalanced: float


class BlockProgram:
    """The program of this module for one model; its pattern is made once.

    `cohesion` (g,) may be lowered between solutions, where contacts have opened, and `elastic` (ε) chosen;
    `ratio` is k_t / k_n of the elastic bed.
    """

    def __init__(self, model: AssemblyModel, ratio: float = 1.0) -> None:
        self.model = model
        self.solver = SparseStiffness(model)
        self.of_pair = model.group_of_pair
        self.give = 1.0 / model.control_area
        self.group_give = 1.0 / (ratio * model.by_group(model.control_area))
        self.cohesion = self.carried(model.cohesion)
        self.load = model.load.ravel()
        self.middle = model.mean_pulls
        self.load_size = float(np.abs(self.load).max())
        own = np.sqrt((model.load * model.load).sum(axis=1))
        self.least_load = np.repeat(np.maximum(own, LIGHTEST * float(own.max())), model.unknowns)
        self.pattern = ContactPattern(model)
        self.start, self.elastic = self._elastic_start(), GIVE

    def carried(self, cohesion: Floats) -> Floats:
        """What cohesions (m,) let friction carry, (g,); of bolts half their range."""
        summed = self.model.by_group(cohesion)
        return np.where(self.model.bolted, 0.5 * summed, summed)

    def solve(self, strengths: Strengths, start: Iterate, tolerance: float, most: int = MOST_STEPS) -> ProgramResult:
        """Solve the program; an iterate that runs away ends it.

        Parameters
        ----------
        start : from an earlier solution that was not solved to the end, or `self.start`
        tolerance : complementarity in parts of the load factor
        most : steps
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self._solve(strengths, start, tolerance, most)

    def _solve(self, strengths: Strengths, start: Iterate, tolerance: float, most: int) -> ProgramResult:
        at, last, steps, stalled = start, start, 0, 0
        best, since = math.inf, 0
        while True:
            off = Residuals.of(self, strengths, at)
            if off.sound and off.gap < tolerance * max(at.load_factor, EACH_BALANCED):
                return ProgramResult(at, True, steps, off.unbalanced)
            best, since = (off.gap, 0) if off.gap < 0.8 * best else (best, since + 1)
            if steps >= most or stalled > STALLED or since > _FRUITLESS or not math.isfinite(off.gap):
                break
            try:
                newton = NewtonEquations.at(self, strengths, at, off)
            except (SolverError, np.linalg.LinAlgError):
                break
            step = newton.step()
            length = step.longest(at)
            steps, stalled = steps + 1, stalled + 1 if length < CRAWL else 0
            at = step.taken(at, length)
            last = at if math.isfinite(at.complementarity) else last
        return ProgramResult(last, False, steps, Residuals.of(self, strengths, last).unbalanced)

    def release(self) -> Floats:
        """How blocks set off that nothing balances, (n u,): the acceleration of least constraint, contacts rough.

        Every kind of motion has the same inertia here (scaled by the size of the blocks); contacts that would pull
        are let go, one round after the other, and bolts that would push.
        """
        model = self.model
        roughness = _ROUGH * ((model.tan_friction > NO_FORCE) | model.bolted)
        pressed = np.ones(len(self.give), dtype=bool)
        taut = np.ones(len(roughness), dtype=bool)
        inertia = np.full(len(self.load), 1.0)
        velocity = self.load
        for _ in range(_RELEASES):
            springs = np.where(pressed, _ROUGH * model.control_area, 0.0)
            held = roughness * taut * (model.by_group(springs) > 0.0)
            rough = np.eye(model.slip_rows.shape[1]) * held[:, None, None]
            velocity = self.solver.factored(self.pattern.stiffness(springs, rough), 0.0, inertia=inertia)(self.load)
            opening, slip = model.opening_and_slip(velocity)
            fastest = max(float(np.abs(velocity).max()), TINY)
            pulled = pressed & (opening > PARALLEL * fastest)
            pushed = ~pressed & (opening < -NO_MOTION * fastest)
            slack = taut & model.bolted & (slip[:, 0] > PARALLEL * fastest)
            drawn = ~taut & (slip[:, 0] < -NO_MOTION * fastest)
            if not (pulled.any() or pushed.any() or slack.any() or drawn.any()):
                break
            pressed, taut = (pressed & ~pulled) | pushed, (taut & ~slack) | drawn
        return velocity

    def _elastic_start(self) -> Iterate:
        """A start on the central path from the forces of an elastic bed, normal forces kept above zero."""
        model = self.model
        tangents = np.eye(model.slip_rows.shape[1]) / self.group_give[:, None, None]
        local = self.pattern.stiffness(model.control_area, tangents)
        velocity = self.solver.factored(local, DIAGONAL_SHIFT)(self.load)
        opening, slip = model.opening_and_slip(velocity)
        normal, friction = -model.control_area * opening, -slip / self.group_give[:, None]
        normal = np.maximum(normal, _START * max(float(np.abs(normal).mean()), NO_FORCE))
        carried = line(self.cohesion, model.tan_friction, model.by_group(normal))
        size = np.sqrt((friction * friction).sum(axis=1)) + float(normal.min())
        strength = np.concatenate([np.maximum(carried, 1.5 * size)[:, None], friction], axis=1)
        # every product of a force and its multiplier is the same
        slips = strength / determinant(strength)[:, None]
        slips[:, 1:] *= -1.0
        unit = 1.0 / max(float(carried @ slips[:, 0]), TINY)
        return Iterate(
            normal, friction, 1.0, unit / MOST_LOAD, strength, np.zeros(len(self.load)), unit / normal, unit * slips,
            MOST_LOAD,
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Residuals:
    """What is off at an iterate, one part for each equation; `sound` where only the complementarity may be."""

    coupling: Coupling
    normal: Floats
    slip: Floats
    strength: Floats
    factor: float
    balance: Floats
    shed: float
    gap: float
    unbalanced: float
    sound: bool

    @classmethod
    def of(cls, program: BlockProgram, strengths: Strengths, at: Iterate) -> "Residuals":
        model, load = program.model, program.load
        slips = at.slip[:, 0]
        if strengths.frozen is None:
            primal = at.load_factor * model.tan_friction
            least = strengths.normality * primal
            work = model.tan_friction * slips
            caps, floors = strengths.dilation >= primal, strengths.dilation <= least
            coupling = Coupling(
                line(program.cohesion, model.tan_friction, model.by_group(at.normal)), primal,
                np.clip(strengths.dilation, least, primal), work,
                np.where(caps, work, np.where(floors, strengths.normality * work, 0.0)),
            )  # fmt: skip
            limit = at.load_factor * coupling.strength
        else:
            none = np.zeros(len(slips))
            coupling = Coupling(strengths.frozen, strengths.dilation, strengths.dilation, none, none)
            limit = at.load_factor * strengths.frozen
            if strengths.apart is not None:
                limit = limit + strengths.dilation * model.by_group(at.normal) + strengths.apart
        opening, slip = model.opening_and_slip(at.velocity)
        normal = (
            program.elastic * program.give * at.normal + opening - at.gap - (coupling.dual * slips)[program.of_pair]
        )
        off_slip = program.elastic * program.group_give[:, None] * at.friction + slip - at.slip[:, 1:]
        strength = at.strength.copy()
        strength[:, 0] -= limit
        strength[:, 1:] -= at.friction
        factor = 1.0 - float(coupling.strength @ slips) + float(program.middle @ at.velocity)
        balance = model.forces_on_blocks(at.normal, at.friction).ravel() + (1.0 - at.shed) * load
        balance = balance + at.load_factor * program.middle
        unbalanced = float((np.abs(balance) / program.least_load).max())
        earned = float(np.abs(normal * at.normal).sum()) + float(np.abs(off_slip * at.friction).sum())
        sound = (
            unbalanced < EACH_BALANCED
            and float(np.abs(strength).max()) < EACH_BALANCED * max(1.0, float(limit.max()))
            and earned < MOTION_RESIDUAL * max(at.load_factor, EACH_BALANCED)
            and abs(factor) < MOTION_RESIDUAL
        )
        return cls(
            coupling, normal, off_slip, strength, factor, balance,
            MOST_LOAD - float(load @ at.velocity) - at.shed_slack, at.complementarity, unbalanced, sound,
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class NewtonEquations:
    """Newton's equations at an iterate, on the central path, scaled after Nesterov & Todd."""

    program: BlockProgram
    start: Iterate
    off: Residuals
    scale: Scaling
    springs: Springs
    solver: Callable[[Floats], Floats]
    row: Floats
    columns: Floats
    system: Floats

    @classmethod
    def at(
        cls, program: BlockProgram, strengths: Strengths, at: Iterate, off: Residuals, inertia: Floats | None = None
    ) -> "NewtonEquations":
        """Factorise them.

        Parameters
        ----------
        inertia : (n u,) added to the diagonal of the stiffness, instead of parts of it

        Raises
        ------
        SolverError
            E599 they cannot be.
        """
        model, load = program.model, program.load
        scale = scaling(at.strength, at.slip)
        springs = Springs.of(
            model, program.of_pair, 1.0 / (program.elastic * program.give + at.gap / at.normal),
            program.elastic * program.group_give, scale, off.coupling,
        )  # fmt: skip
        shift = DIAGONAL_SHIFT if inertia is None else 0.0
        solver = program.solver.factored(springs.stiffness(program.pattern), shift, strengths.symmetric, inertia)
        border = model.forces_on_blocks(*springs.of_factor).ravel() - program.middle
        row = border if strengths.symmetric else model.forces_on_blocks(*springs.row).ravel() - program.middle
        columns = solver(np.stack([border, load], axis=1))
        system = np.array([
            [springs.corner + row @ columns[:, 0], row @ columns[:, 1]],
            [load @ columns[:, 0], at.shed_slack / at.shed + load @ columns[:, 1]],
        ])  # fmt: skip
        return cls(program, at, off, scale, springs, solver, row, columns, system)

    def step(self, towards: float | None = None) -> IterateStep:
        """Mehrotra's step: what a step to the end would do tells how far to aim and what to correct.

        Parameters
        ----------
        towards : of a convex program: no less complementarity than this, and all that is of second order corrected;
            else as much as the step to the end may go: columns come to no end without
        """
        at, cones = self.start, len(self.start.normal) + len(self.start.strength) + 1
        middle = self.scale.times(at.slip)
        ahead = self.direction(-at.gap * at.normal, -middle, -at.shed * at.shed_slack)
        reach = ahead.longest(at)
        barrier = max(centring(reach) * self.off.gap, towards or 0.0) / cones
        trust = reach * reach if towards is None else 1.0
        target = -product(middle, middle)
        target -= trust * product(self.scale.over(ahead.strength), self.scale.times(ahead.slip))
        target[:, 0] += barrier
        of_normal = barrier - at.gap * at.normal - trust * ahead.normal * ahead.gap
        of_shed = barrier - at.shed * at.shed_slack - trust * ahead.shed * ahead.shed_slack
        return self.direction(of_normal, quotient(middle, target), of_shed)

    def direction(self, to_normal: Floats, to_strength: Floats, to_shed: float) -> IterateStep:
        """The step towards given products of the normal forces (m,), the cones (g, 1 + t) and the shed load."""
        program, at, off, springs = self.program, self.start, self.off, self.springs
        model, coupling, load = program.model, off.coupling, program.load
        x = off.strength + self.scale.times(to_strength)
        f_normal, f_slip, earned = springs.sources(to_normal / at.normal - off.normal, x, off.slip)
        first = self.solver(off.balance + model.forces_on_blocks(f_normal, f_slip).ravel())
        of_factor = -off.factor + earned + float(self.row @ first)
        of_shed = -off.shed + to_shed / at.shed + float(load @ first)
        factor, shed = np.linalg.solve(self.system, np.array([of_factor, of_shed])).tolist()
        velocity = first - self.columns @ np.array([factor, shed])
        opens, slips = model.opening_and_slip(velocity)
        less_normal, less_slip = springs.times(opens, slips)
        normal = f_normal - less_normal - factor * springs.of_factor[0]
        friction = f_slip - less_slip - factor * springs.of_factor[1]
        strength = -off.strength
        strength[:, 0] += coupling.strength * factor + coupling.primal * model.by_group(normal)
        strength[:, 1:] += friction
        slip = np.empty_like(strength)
        slip[:, 1:] = off.slip + slips + program.elastic * program.group_give[:, None] * friction
        slip[:, 0] = springs.slip_allowed(x[:, 0] - off.strength[:, 0] - strength[:, 0], slip[:, 1:])
        # a pair that opens takes its gap from the blocks' motion, one that presses from the product: each is a large
        # number there, and rounding does not matter
        moved = off.normal + opens + program.elastic * program.give * normal
        moved -= (coupling.dual * slip[:, 0] + coupling.opening_work * factor)[program.of_pair]
        opened = at.gap * float(at.normal.mean()) > at.normal * float(at.gap.mean())
        gap = np.where(opened, moved, (to_normal - at.gap * normal) / at.normal)
        return IterateStep(
            normal, friction, factor, shed, strength, velocity, gap, slip, (to_shed - at.shed_slack * shed) / at.shed
        )


def centring(reach: float) -> float:
    """How far towards the middle a step aims, by how far one to the end may go: Mehrotra's rule."""
    return max((1.0 - reach) ** 3, _LEAST_CENTRING)
