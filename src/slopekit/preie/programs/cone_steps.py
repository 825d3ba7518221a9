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

PAIR = 24  # numbers per node pair in the arrays of the kernels
_MOST_LOAD = 1e3  # M: penalty of shed load
_GIVE = (
    1e-11  # ε, of the elastic give: a thousand times as much moves the bound of 941 blocks by 7e-6
)
_LARGE = 10.0  # forces and s to begin with, in parts of the loads: half or twice as much take as many steps
_LIFTED = 1.0  # least of them about the forces of an elastic bed, in parts of the loads; three times as much is as good
_TO_BOUNDARY = 0.99  # part of the way to where a force or its multiplier is nothing
_LEAST_CENTRING = 1e-6  # products fall to so little in a step at most


def determinant(point: Floats) -> Floats:
    """Return the determinant x0² - |x1|² of cone points (g, 1 + t), kept above zero."""
    size: Floats = np.maximum(point[:, 0] ** 2 - (point[:, 1:] * point[:, 1:]).sum(axis=1), TINY)
    return size


@dataclass(frozen=True)
class Iterate:
    """An iterate of the interior-point method, or a step between two.

    Attributes
    ----------
    normal : (m,) normal forces N; friction : (g, t) friction forces T
    load_factor : 1 + s; shed : σ
    strength : (g, 1 + t) points of the friction cones: available strength, and T
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

    def longest(self, iterate: "Iterate", most: float) -> float:
        """Return the length of this step from an iterate, at most 1; `most` is the limit by its pairs and cones."""
        singles = (
            (iterate.shed, self.shed),
            (iterate.shed_slack, self.shed_slack),
            (iterate.load_factor, self.load_factor),
        )
        return min(
            1.0,
            _TO_BOUNDARY
            * min([most, *(-value / change for value, change in singles if change < 0.0)]),
        )

    def advanced(self, iterate: "Iterate", length: float) -> "Iterate":
        """Return the iterate after a length of this step."""
        return Iterate(
            iterate.normal + length * self.normal,
            iterate.friction + length * self.friction,
            iterate.load_factor + length * self.load_factor,
            iterate.shed + length * self.shed,
            iterate.strength + length * self.strength,
            iterate.velocity + length * self.velocity,
            iterate.gap + length * self.gap,
            iterate.slip + length * self.slip,
            iterate.shed_slack + length * self.shed_slack,
        )


class Shortfall:
    """The program of this module for one model, at the λ that was set last."""

    def __init__(self, model: AssemblyModel) -> None:
        self.model = model
        self.solver, self.pattern = SparseStiffness(model), ContactPattern(model)
        self.give, self.group_give = (
            1.0 / model.control_area,
            1.0 / model.by_group(model.control_area),
        )
        cohesion = model.by_group(model.cohesion)
        self.cohesion = np.where(
            model.bolted, 0.5 * cohesion, cohesion
        )  # about the mean pull of a bolt
        self.own_load, self.pulls = model.load.ravel(), model.mean_pulls
        block_loads = np.sqrt((model.load * model.load).sum(axis=1))
        block_loads = np.maximum(block_loads, LIGHTEST * float(block_loads.max()))
        self.least_load = np.repeat(block_loads, model.unknowns)
        lighter = np.minimum(
            block_loads[model.plus], np.where(model.minus < 0, np.inf, block_loads[model.minus])
        )
        self.weight, self.pair_weight = lighter[model.group_contact], lighter[model.pair_contact]
        self.cones = len(self.pair_weight) + len(self.weight) + 1
        self.set_reduction(1.0)

    def set_reduction(self, reduction: float) -> None:
        """Set the strength reduction λ of the program."""
        self.load = self.own_load + reduction * self.pulls
        self.friction = reduction * self.model.tan_friction
        self.cone_offset = reduction * self.cohesion - self.weight

    def start(self) -> Iterate:
        """Return a first iterate in the middle of every cone."""
        pairs, (groups, tangents) = len(self.pair_weight), self.model.slip_rows.shape[:2]
        none, unit = np.zeros((groups, tangents)), _LARGE / (2.0 * pairs)
        normal, room = _LARGE * self.pair_weight, _LARGE * self.weight[:, None]
        return Iterate(
            normal,
            none,
            _LARGE,
            unit / _MOST_LOAD,
            np.hstack([room, none]),
            np.zeros(len(self.load)),
            unit / normal,
            np.hstack([unit / room, none]),
            _MOST_LOAD,
        )

    def elastic_start(self, reduction: float) -> Iterate:
        """Return a first iterate near the forces of an elastic bed, for a λ close to the bound."""
        model = self.model
        tangents = np.eye(model.slip_rows.shape[1]) / self.group_give[:, None, None]
        local = self.pattern.stiffness(model.control_area, tangents)
        opening, slips = model.opening_and_slip(
            self.solver.factored(local, DIAGONAL_SHIFT)(self.own_load)
        )
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
            normal,
            friction,
            2.0,
            unit / _MOST_LOAD,
            strength,
            np.zeros(len(self.load)),
            unit / normal,
            unit * slip,
            _MOST_LOAD,
        )

    def slope(self, iterate: Iterate) -> float:
        """Return ds/dλ at an iterate."""
        strength = line(self.cohesion, self.model.tan_friction, self.model.by_group(iterate.normal))
        return float(self.pulls @ iterate.velocity) - float(strength @ iterate.slip[:, 0])

    def inertia(self, gap: float) -> Floats:
        """Return a regularisation (n u,), a small part of the stiffness of each block, slivers included."""
        small: Floats = (DIAGONAL_SHIFT * self.cones / gap) * self.least_load * self.least_load
        return small

    def laws(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return elastic compliances of pairs (m,) and friction (g,), λ tan φ (g,), strength per load factor (g,)."""
        return _GIVE * self.give, _GIVE * self.group_give, self.friction, self.weight


@dataclass(frozen=True)
class Residuals:
    """Residuals of the equations at an iterate, by equation; `gap` is the complementarity."""

    normal: Floats
    slip: Floats
    strength: Floats
    factor: float
    balance: Floats
    shed: float
    gap: float

    @classmethod
    def evaluate(cls, program: Shortfall, iterate: Iterate) -> "Residuals":
        """Return the residuals of a program at an iterate."""
        count, balance = len(iterate.normal), (1.0 - iterate.shed) * program.load
        normal, slip, strength = (
            np.empty(count),
            np.empty((count, 2)),
            np.empty((count, 3)),
        )
        work, gaps, _ = compiled().cone_residuals(
            program.pattern.contacts,
            *program.laws(),
            program.cone_offset,
            iterate.normal,
            iterate.friction,
            iterate.gap,
            iterate.strength,
            iterate.slip,
            iterate.velocity,
            iterate.load_factor,
            normal,
            slip,
            strength,
            balance,
        )
        return cls(
            normal,
            slip,
            strength,
            1.0 - work,
            balance,
            _MOST_LOAD - float(program.load @ iterate.velocity) - iterate.shed_slack,
            gaps + iterate.shed * iterate.shed_slack,
        )

    def work(self, iterate: Iterate) -> float:
        """Return by how much the residuals at an iterate may change s, those of the cones left out."""
        forces = float(np.abs(self.normal * iterate.normal).sum()) + float(
            np.abs(self.slip * iterate.friction).sum()
        )
        return (
            forces
            + abs(float(self.balance @ iterate.velocity))
            + abs(self.factor * (iterate.load_factor - 1.0))
        )

    def outside(self, program: Shortfall) -> float:
        """Return the largest unbalanced force or violation of a cone, in parts of the loads."""
        cones = float((np.abs(self.strength).max(axis=1) / program.weight).max())
        return max(float((np.abs(self.balance) / program.least_load).max()), cones)


class ConeEquations:
    """Newton's equations of the central path at an iterate, in Nesterov-Todd scaling, factorised."""

    def __init__(self, program: Shortfall, iterate: Iterate, residuals: Residuals) -> None:
        """Raises SolverError (E599) where they are singular."""
        self.program, self.start, self.residuals = program, iterate, residuals
        load, contacts, unknowns = program.load, len(program.model.plus), program.model.unknowns
        self.pairs, local = (
            np.empty((len(iterate.normal), PAIR)),
            np.empty((contacts, unknowns, unknowns)),
        )
        self.border = np.zeros(len(load))
        corner = compiled().cone_springs(
            program.pattern.contacts,
            *program.laws(),
            iterate.normal,
            iterate.gap,
            iterate.strength,
            iterate.slip,
            self.pairs,
            local,
            self.border,
        )
        self.solver: Solver = program.solver.factored(
            local, 0.0, True, program.inertia(residuals.gap)
        )
        self.columns = self.solver(np.stack([self.border, load], axis=1))
        self.system = np.array(
            [
                [corner + self.border @ self.columns[:, 0], self.border @ self.columns[:, 1]],
                [
                    load @ self.columns[:, 0],
                    iterate.shed_slack / iterate.shed + load @ self.columns[:, 1],
                ],
            ]
        )

    def step(self, least_gap: float) -> tuple[Iterate, float]:
        """Return the predictor-corrector step of Mehrotra and its length.

        Parameters
        ----------
        least_gap : complementarity that the step aims at, at least
        """
        iterate, kernels = self.start, compiled()
        middle, to_normal = np.empty_like(iterate.slip), np.empty_like(iterate.normal)
        target, to_strength = np.empty_like(iterate.slip), np.empty_like(iterate.slip)
        kernels.cone_middle(self.pairs, iterate.slip, middle)
        predictor, reach = self.direction(
            -iterate.gap * iterate.normal, -middle, -iterate.shed * iterate.shed_slack
        )
        centring = max((1.0 - reach) ** 3, _LEAST_CENTRING)
        barrier = max(centring * self.residuals.gap, least_gap) / self.program.cones
        kernels.cone_targets(
            self.pairs,
            iterate.strength,
            iterate.slip,
            predictor.normal,
            predictor.gap,
            predictor.strength,
            predictor.slip,
            middle,
            barrier,
            -1.0,
            barrier,
            barrier,
            to_normal,
            target,
            to_strength,
        )
        to_shed = (
            barrier - iterate.shed * iterate.shed_slack - predictor.shed * predictor.shed_slack
        )
        return self.direction(to_normal, to_strength, to_shed)

    def direction(
        self, to_normal: Floats, to_strength: Floats, to_shed: float
    ) -> tuple[Iterate, float]:
        """Return the step to target products of normal forces (m,), cones (m, 3) and shed load, and its length."""
        iterate, residuals, kernels, load = (
            self.start,
            self.residuals,
            compiled(),
            self.program.load,
        )
        contacts, cone_residuals = (
            self.program.pattern.contacts,
            (residuals.normal, residuals.slip, residuals.strength),
        )
        normal, friction, gap = (
            np.empty_like(iterate.normal),
            np.empty_like(iterate.friction),
            np.empty_like(iterate.gap),
        )
        strength, slip, forces = (
            np.empty_like(iterate.strength),
            np.empty_like(iterate.slip),
            residuals.balance.copy(),
        )
        earned = kernels.cone_sources(
            contacts, self.pairs, to_normal, to_strength, *cone_residuals, normal, friction, forces
        )
        first = self.solver(forces)
        of_factor = -residuals.factor + earned + float(self.border @ first)
        of_shed = -residuals.shed + to_shed / iterate.shed + float(load @ first)
        factor, shed = np.linalg.solve(self.system, np.array([of_factor, of_shed])).tolist()
        velocity = first - self.columns @ np.array([factor, shed])
        most = kernels.cone_step(
            contacts,
            self.pairs,
            velocity,
            factor,
            float(iterate.normal.mean() / iterate.gap.mean()),
            to_normal,
            to_strength,
            *cone_residuals,
            iterate.strength,
            iterate.slip,
            normal,
            friction,
            strength,
            gap,
            slip,
        )
        slack = (to_shed - iterate.shed_slack * shed) / iterate.shed
        step = Iterate(normal, friction, factor, shed, strength, velocity, gap, slip, slack)
        return step, step.longest(iterate, most)
