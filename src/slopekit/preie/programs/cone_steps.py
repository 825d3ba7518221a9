"""Steps of the interior-point method of convex programs in space, compiled: what `programs.program` does with NumPy.

In space each node pair has its own friction, and what `programs.springs` eliminates is a matter of that pair: one loop
over the contacts takes the place of some fifty over arrays. Only for strengths that are frozen, λ r + t (Σ N - N̂).
"""

from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.kernels import compiled
from slopekit.preie.programs.iterates import Iterate, IterateStep
from slopekit.preie.programs.program import (
    MOST_LOAD,
    BlockProgram,
    Residuals,
    Strengths,
    centring,
)
from slopekit.preie.programs.springs import Coupling
from slopekit.preie.solvers.fronts import Solver

PAIR = 24  # numbers that the kernels keep of a pair


def _laws(program: BlockProgram, strengths: Strengths) -> tuple[Floats, Floats, Floats, Any]:
    """Elastic give of the pairs, and of their friction; tangents; strengths that do not follow the normal forces."""
    return program.elastic * program.give, program.elastic * program.group_give, strengths.dilation, strengths.frozen


def residuals(program: BlockProgram, strengths: Strengths, at: Iterate) -> Residuals:
    """What is off at an iterate: `Residuals.of`, but that it does not look whether it is sound."""
    count, balance = len(at.normal), (1.0 - at.shed) * program.load + at.load_factor * program.middle
    of_normal, of_slip, of_strength = np.empty(count), np.empty((count, 2)), np.empty((count, 3))
    none = np.zeros(count)
    work, gaps, _ = compiled().cone_residuals(
        program.pattern.contacts, *_laws(program, strengths), none if strengths.apart is None else strengths.apart,
        at.normal, at.friction, at.gap, at.strength, at.slip, at.velocity, at.load_factor, of_normal, of_slip,
        of_strength, balance,
    )  # fmt: skip
    assert strengths.frozen is not None
    return Residuals(
        Coupling(strengths.frozen, strengths.dilation, strengths.dilation, none, none), of_normal, of_slip, of_strength,
        1.0 - work + float(program.middle @ at.velocity), balance,
        MOST_LOAD - float(program.load @ at.velocity) - at.shed_slack, gaps + at.shed * at.shed_slack,
        float((np.abs(balance) / program.least_load).max()), False,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class ConeEquations:
    """Newton's equations at an iterate: `NewtonEquations` of frozen strengths in space."""

    program: BlockProgram
    start: Iterate
    off: Residuals
    pairs: Floats
    solver: Solver
    border: Floats
    columns: Floats
    system: Floats

    @classmethod
    def at(
        cls, program: BlockProgram, strengths: Strengths, at: Iterate, off: Residuals, inertia: Floats
    ) -> "ConeEquations":
        """Factorise them; parameters and errors are those of `NewtonEquations.at`."""
        load, contacts, unknowns = program.load, len(program.model.plus), program.model.unknowns
        pairs, local = np.empty((len(at.normal), PAIR)), np.empty((contacts, unknowns, unknowns))
        border = -program.middle
        corner = compiled().cone_springs(
            program.pattern.contacts, *_laws(program, strengths), at.normal, at.gap, at.strength, at.slip, pairs,
            local, border,
        )  # fmt: skip
        solver = program.solver.factored(local, 0.0, True, inertia)
        columns = solver(np.stack([border, load], axis=1))
        system = np.array([
            [corner + border @ columns[:, 0], border @ columns[:, 1]],
            [load @ columns[:, 0], at.shed_slack / at.shed + load @ columns[:, 1]],
        ])  # fmt: skip
        return cls(program, at, off, pairs, solver, border, columns, system)

    def step(self, towards: float) -> IterateStep:
        """Mehrotra's step: `NewtonEquations.step`."""
        at, kernels = self.start, compiled()
        middle, of_normal = np.empty_like(at.slip), np.empty_like(at.normal)
        target, to_strength = np.empty_like(at.slip), np.empty_like(at.slip)
        kernels.cone_middle(self.pairs, at.slip, middle)
        ahead, reach = self.direction(-at.gap * at.normal, -middle, -at.shed * at.shed_slack)
        barrier = max(centring(reach) * self.off.gap, towards) / (len(at.normal) + len(at.strength) + 1)
        kernels.cone_targets(
            self.pairs, at.strength, at.slip, ahead.normal, ahead.gap, ahead.strength, ahead.slip, middle, barrier,
            -1.0, barrier, barrier, of_normal, target, to_strength,
        )  # fmt: skip
        of_shed = barrier - at.shed * at.shed_slack - ahead.shed * ahead.shed_slack
        return self.direction(of_normal, to_strength, of_shed)[0]

    def direction(self, to_normal: Floats, to_strength: Floats, to_shed: float) -> tuple[IterateStep, float]:
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
        step = IterateStep(normal, friction, factor, shed, strength, velocity, gap, slip, slack)
        return step, step.longest(at, most)
