"""Steps of the interior-point method towards the static bound of many blocks in space, compiled.

The program, at one λ: forces that balance, and short of strength by s w_g at most,

    minimise 1 + s + M σ + ε/2 fᵀ C f:    Bᵀ f + (1 - σ) P = 0,    N, σ >= 0,    |T_g| <= λ (c_g + μ_g Σ N) + s w_g

σ sheds load where nothing balances it all; ε C, the give of an even elastic bed, makes the forces unique. The
multipliers are velocities of the blocks. A passive bolt, 0 <= T <= λ r, is a force λ r/2 beside the loads, and a
friction force of strength r/2 about it.
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.kernels import compiled
from slopekit.preie.solvers.fronts import Solver
from slopekit.preie.solvers.stiffness import SparseStiffness
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.patterns import ContactPattern
from slopekit.preie.tolerances import DIAGONAL_SHIFT, LIGHTEST, TINY
from slopekit.strength.mohr_coulomb import line

PAIR = 24  # numbers that the kernels keep of a pair
_MOST_LOAD = 1e3  # M: load is shed rather than strength raised more than so often
_GIVE = 1e-11  # ε, of the elastic give: a thousand times as much moves the bound of 941 blocks by 7e-6
_LARGE = 10.0  # forces and s to begin with, in parts of the loads: half or twice as much take as many steps
_LIFTED = 1.0  # least of them about the forces of an elastic bed, in parts of the loads; three times as much is as good
_TO_BOUNDARY = 0.99  # part of the way to where a force or its multiplier is nothing
_LEAST_CENTRING = 1e-6  # products fall to so little in a step at most


def determinant(point: Floats) -> Floats:
    """x0² - |x1|² of each row (x0, x1), kept above zero."""
    size: Floats = np.maximum(point[:, 0] ** 2 - (point[:, 1:] * point[:, 1:]).sum(axis=1), TINY)
    return size


@dataclass(frozen=True)
class Iterate:
    """A point of the method, or a change of one.

    Attributes
    ----------
    normal : (m,) normal forces N; friction : (g, t) friction forces T
    load_factor : 1 + s; shed : σ
    strength : (g, 1 + t) points of the friction cones: what is allowed, and T
    velocity : (n u,) of the blocks
    gap : (m,) multipliers of N; slip : (g, 1 + t) of the cones; shed_slack : of σ
    """

    normal: Floats
    friction: Floats
    load_factor: float
    shed: float
    strength: Floats
    velocity: Floats
    gap: Floats
    slip: Floats
    shed_slack: float

    def longest(self, at: "Iterate", most: float) -> float:
        """How far the step may go, at most 1; `most` is what its pairs and cones allow."""
        singles = (
            (at.shed, self.shed),
            (at.shed_slack, self.shed_slack),
            (at.load_factor, self.load_factor),
        )
        return min(1.0, _TO_BOUNDARY * min([most, *(-value / change for value, change in singles if change < 0.0)]))

    def taken(self, at: "Iterate", length: float) -> "Iterate":
        """The iterate after so much of the step."""
        return Iterate(
            at.normal + length * self.normal, at.friction + length * self.friction,
            at.load_factor + length * self.load_factor, at.shed + length * self.shed,
            at.strength + length * self.strength, at.velocity + length * self.velocity, at.gap + length * self.gap,
            at.slip + length * self.slip, at.shed_slack + length * self.shed_slack,
        )  # fmt: skip


class Shortfall:
    """The program of this module for one model, at the λ that was set last."""

    def __init__(self, model: AssemblyModel) -> None:
        self.model = model
        self.solver, self.pattern = SparseStiffness(model), ContactPattern(model)
        self.give, self.group_give = 1.0 / model.control_area, 1.0 / model.by_group(model.control_area)
        cohesion = model.by_group(model.cohesion)
        self.cohesion = np.where(model.bolted, 0.5 * cohesion, cohesion)  # about the middle of what a bolt pulls
        self.own_load, self.pulls = model.load.ravel(), model.mean_pulls
        own = np.sqrt((model.load * model.load).sum(axis=1))
        own = np.maximum(own, LIGHTEST * float(own.max()))
        self.least_load = np.repeat(own, model.unknowns)
        lighter = np.minimum(own[model.plus], np.where(model.minus < 0, np.inf, own[model.minus]))
        self.weight, self.pair_weight = lighter[model.group_contact], lighter[model.pair_contact]
        self.cones = len(self.pair_weight) + len(self.weight) + 1
        self.set_reduction(1.0)

    def set_reduction(self, reduction: float) -> None:
        """Set λ."""
        self.load = self.own_load + reduction * self.pulls
        self.friction = reduction * self.model.tan_friction
        self.apart = reduction * self.cohesion - self.weight

    def begun(self) -> Iterate:
        """A start in which every cone has its middle."""
        pairs, (groups, tangents) = len(self.pair_weight), self.model.slip_rows.shape[:2]
        none, unit = np.zeros((groups, tangents)), _LARGE / (2.0 * pairs)
        normal, room = _LARGE * self.pair_weight, _LARGE * self.weight[:, None]
        return Iterate(
            normal, none, _LARGE, unit / _MOST_LOAD, np.hstack([room, none]), np.zeros(len(self.load)), unit / normal,
            np.hstack([unit / room, none]), _MOST_LOAD,
        )  # fmt: skip

    def begun_elastic(self, reduction: float) -> Iterate:
        """The same about the forces of an elastic bed, which is nearer to a λ that is known to be good."""
        model = self.model
        tangents = np.eye(model.slip_rows.shape[1]) / self.group_give[:, None, None]
        local = self.pattern.stiffness(model.control_area, tangents)
        opening, slips = model.opening_and_slip(self.solver.factored(local, DIAGONAL_SHIFT)(self.own_load))
        normal, friction = -model.control_area * opening, -slips / self.group_give[:, None]
        normal = np.maximum(normal, _LIFTED * self.pair_weight)
        room = reduction * model.tan_friction * model.by_group(normal) + self.weight
        size = np.sqrt((friction * friction).sum(axis=1))
        friction = friction * np.minimum(1.0, 0.5 * room / np.maximum(size, TINY))[:, None]
        strength = np.hstack([room[:, None], friction])
        slip = strength / determinant(strength)[:, None]
        slip[:, 1:] *= -1.0
        unit = 1.0 / float(self.weight @ slip[:, 0])
        return Iterate(
            normal, friction, 2.0, unit / _MOST_LOAD, strength, np.zeros(len(self.load)), unit / normal, unit * slip,
            _MOST_LOAD,
        )  # fmt: skip

    def falls(self, at: Iterate) -> float:
        """ds/dλ."""
        strength = line(self.cohesion, self.model.tan_friction, self.model.by_group(at.normal))
        return float(self.pulls @ at.velocity) - float(strength @ at.slip[:, 0])

    def inertia(self, gap: float) -> Floats:
        """Hardly anything of the stiffness of each block, (n u,): of slivers too, which the mean would hold."""
        small: Floats = (DIAGONAL_SHIFT * self.cones / gap) * self.least_load * self.least_load
        return small

    def laws(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Elastic give of the pairs, and of their friction; tangents; strength per unit of the load factor."""
        return _GIVE * self.give, _GIVE * self.group_give, self.friction, self.weight


@dataclass(frozen=True)
class Residuals:
    """What is off at an iterate, one part for each equation; `gap` is what the multipliers still earn."""

    normal: Floats
    slip: Floats
    strength: Floats
    factor: float
    balance: Floats
    shed: float
    gap: float

    @classmethod
    def of(cls, program: Shortfall, at: Iterate) -> "Residuals":
        """What is off at an iterate."""
        count, balance = len(at.normal), (1.0 - at.shed) * program.load
        of_normal, of_slip, of_strength = np.empty(count), np.empty((count, 2)), np.empty((count, 3))
        work, gaps, _ = compiled().cone_residuals(
            program.pattern.contacts, *program.laws(), program.apart, at.normal, at.friction, at.gap, at.strength,
            at.slip, at.velocity, at.load_factor, of_normal, of_slip, of_strength, balance,
        )  # fmt: skip
        return cls(
            of_normal, of_slip, of_strength, 1.0 - work, balance,
            _MOST_LOAD - float(program.load @ at.velocity) - at.shed_slack, gaps + at.shed * at.shed_slack,
        )  # fmt: skip

    def worth(self, at: Iterate) -> float:
        """What is off at an iterate may be worth to s, but for the cones."""
        forces = float(np.abs(self.normal * at.normal).sum()) + float(np.abs(self.slip * at.friction).sum())
        return forces + abs(float(self.balance @ at.velocity)) + abs(self.factor * (at.load_factor - 1.0))

    def outside(self, program: Shortfall) -> float:
        """How far forces are from balance and cones off at most, in parts of the loads."""
        cones = float((np.abs(self.strength).max(axis=1) / program.weight).max())
        return max(float((np.abs(self.balance) / program.least_load).max()), cones)


class ConeEquations:
    """Newton's equations at an iterate, on the central path, scaled after Nesterov & Todd, and factorised."""

    def __init__(self, program: Shortfall, at: Iterate, off: Residuals) -> None:
        """Raises SolverError (E599) where they are singular."""
        self.program, self.start, self.off = program, at, off
        load, contacts, unknowns = program.load, len(program.model.plus), program.model.unknowns
        self.pairs, local = np.empty((len(at.normal), PAIR)), np.empty((contacts, unknowns, unknowns))
        self.border = np.zeros(len(load))
        corner = compiled().cone_springs(
            program.pattern.contacts, *program.laws(), at.normal, at.gap, at.strength, at.slip, self.pairs,
            local, self.border,
        )  # fmt: skip
        self.solver: Solver = program.solver.factored(local, 0.0, True, program.inertia(off.gap))
        self.columns = self.solver(np.stack([self.border, load], axis=1))
        self.system = np.array([
            [corner + self.border @ self.columns[:, 0], self.border @ self.columns[:, 1]],
            [load @ self.columns[:, 0], at.shed_slack / at.shed + load @ self.columns[:, 1]],
        ])  # fmt: skip

    def step(self, towards: float) -> tuple[Iterate, float]:
        """Mehrotra's step, and its length: what a step to the end would do tells how far to aim and what to correct.

        Parameters
        ----------
        towards : no less complementarity than this
        """
        at, kernels = self.start, compiled()
        middle, of_normal = np.empty_like(at.slip), np.empty_like(at.normal)
        target, to_strength = np.empty_like(at.slip), np.empty_like(at.slip)
        kernels.cone_middle(self.pairs, at.slip, middle)
        ahead, reach = self.direction(-at.gap * at.normal, -middle, -at.shed * at.shed_slack)
        centring = max((1.0 - reach) ** 3, _LEAST_CENTRING)
        barrier = max(centring * self.off.gap, towards) / self.program.cones
        kernels.cone_targets(
            self.pairs, at.strength, at.slip, ahead.normal, ahead.gap, ahead.strength, ahead.slip, middle, barrier,
            -1.0, barrier, barrier, of_normal, target, to_strength,
        )  # fmt: skip
        of_shed = barrier - at.shed * at.shed_slack - ahead.shed * ahead.shed_slack
        return self.direction(of_normal, to_strength, of_shed)

    def direction(self, to_normal: Floats, to_strength: Floats, to_shed: float) -> tuple[Iterate, float]:
        """The step towards given products of the normal forces (m,), the cones (m, 3) and the shed load; its length."""
        at, off, kernels, load = self.start, self.off, compiled(), self.program.load
        contacts, offs = self.program.pattern.contacts, (off.normal, off.slip, off.strength)
        normal, friction, gap = np.empty_like(at.normal), np.empty_like(at.friction), np.empty_like(at.gap)
        strength, slip, forces = np.empty_like(at.strength), np.empty_like(at.slip), off.balance.copy()
        earned = kernels.cone_sources(contacts, self.pairs, to_normal, to_strength, *offs, normal, friction, forces)
        first = self.solver(forces)
        of_factor = -off.factor + earned + float(self.border @ first)
        of_shed = -off.shed + to_shed / at.shed + float(load @ first)
        factor, shed = np.linalg.solve(self.system, np.array([of_factor, of_shed])).tolist()
        velocity = first - self.columns @ np.array([factor, shed])
        most = kernels.cone_step(
            contacts, self.pairs, velocity, factor, float(at.normal.mean() / at.gap.mean()), to_normal, to_strength,
            *offs, at.strength, at.slip, normal, friction, strength, gap, slip,
        )  # fmt: skip
        slack = (to_shed - at.shed_slack * shed) / at.shed
        step = Iterate(normal, friction, factor, shed, strength, velocity, gap, slip, slack)
        return step, step.longest(at, most)
