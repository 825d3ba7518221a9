"""Blocks of elastic joints brought to rest: Newton's method, and implicit viscous flow where it does not get there.

A step of the flow adds η K_e (u - u_before) to what the forces have to balance; with η large enough it always has one
solution, and η falls from step to step. In space, where benches hold slivers a millionth of their largest block,
Newton's method stops as a rule with a few blocks out of balance: those are brought to rest with all others held where
they are, and it goes on with all (nonlinear elimination: Cai & Keyes 2002, SIAM J. Sci. Comput. 24, 183).
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces, NewtonStep

#: Viscosity after a step that went well (after one that did not the inverse), and in large steps.
EASES, _GENTLY = 0.2, 0.5
THICK = 1e-2  # viscosity in parts of the elastic stiffness, to go on with
THIN = 1e-8  # the least
_FAILS = 6  # steps in a row
_MANY = 12  # blocks in space
_FEW, _ROUNDS, _WORK = 0.3, 8, 60  # part of the blocks that are settled by themselves, how often, factorisations
_ENOUGH = 0.3  # of what may stay unbalanced: blocks that are less out of balance are left alone
_LESS = 0.5  # of what was out of balance, that has to go


@dataclass
class Flow:
    """Blocks in viscous flow: displacement, the one before, the viscosity of the last step, and how it ended.

    `rounding` is what the law of the joints is rounded by there, in parts of their elastic energy
    (`elastic_path.lagged`).
    """

    at: Floats
    forces: BedForces
    ended: str  # rest, runs, slow, lost
    before: Floats
    viscosity: float
    rounding: float = 0.0


def relaxed(
    bed: Bed,
    at: Floats,
    parameter: float,
    viscosity: float,
    most: int = 80,
    runs_at: float = 1e2,
    patience: int = 10000,
) -> Flow:
    """Let the blocks flow until they rest or run; viscosity 0 tries Newton's method first.

    Parameters
    ----------
    runs_at : work from where they are, in parts of the elastic, at which they run
    patience : factorisations after which it is left for later
    """
    before, last, fails, least = at, viscosity, 0, THIN
    runs_at += bed.worked(at)
    patience += bed.factorisations
    for _ in range(most):
        if bed.factorisations > patience:
            break
        step = stepped(bed, at, at, parameter, viscosity)
        if not step.settled:
            viscosity, fails = max(1.0 / EASES * viscosity, THICK), fails + 1
            least = viscosity if bed.tangents > 1 else THIN  # of many blocks in space it goes slowly from there
            if fails > _FAILS:
                return Flow(at, bed.forces(at, parameter), "lost", before, last)
            continue
        before, at, last, fails = at, step.at, viscosity, 0
        if viscosity == 0.0 or step.forces.balanced(step.forces.residual):
            return Flow(at, step.forces, "rest", before, last)
        if bed.worked(at) > runs_at:
            return Flow(at, step.forces, "runs", before, last)
        least = max(_GENTLY * least, THIN)
        viscosity = max(EASES * viscosity, least)
    return Flow(at, bed.forces(at, parameter), "slow", before, last)


def stepped(
    bed: Bed, at: Floats, before: Floats, parameter: float, viscosity: float, work: float | None = None
) -> NewtonStep:
    """Balance of the forces and of viscous flow away from `before`.

    Newton downhill; where that stalls a few blocks by themselves, and full steps, which may climb.

    Parameters
    ----------
    work : of the driving load, to be met by changing the parameter as well; None: the parameter stays
    """
    step = bed.newton(at, before, parameter, viscosity, work, downhill=True)
    many = bed.tangents > 1 and len(bed.model.load) >= _MANY
    if many and work is None and not step.settled:
        step = _eliminated(bed, step, before, viscosity)
    if step.settled or (viscosity == 0.0 and work is None):
        return step
    return bed.newton(at, before, parameter, viscosity, work, downhill=False)


def _eliminated(bed: Bed, last_step: NewtonStep, before: Floats, viscosity: float) -> NewtonStep:
    """Newton's method on all blocks, with those out of balance settled first while all others are held.

    By turns those alone, and with their neighbours.
    """
    size, last = bed.model.unknowns, np.inf
    for turn in range(_ROUNDS):
        _, off = bed.unbalanced_parts(last_step.at, before, last_step.parameter, viscosity)
        off = np.abs(off / bed.unbalanced_at_most).reshape(-1, size).max(axis=1)
        out = off > _ENOUGH
        worst = float(off.max())
        if not 0 < int(out.sum()) <= _FEW * len(out) or (turn > 1 and worst > _LESS * last):
            break
        last = worst
        if turn % 2:
            out = bed.model.touching(out)
        blocks = np.flatnonzero(out)
        if len(blocks) > _FEW * len(out):
            break
        those = (blocks[:, None] * size + np.arange(size)).ravel()
        few = bed.among(blocks, last_step.at)
        if viscosity:
            step = stepped(few, last_step.at[those], before[those], last_step.parameter, viscosity)
            settled, there = step.settled, step.at
        else:
            flow = relaxed(few, last_step.at[those], last_step.parameter, 0.0, runs_at=1e6, patience=_WORK)
            settled, there = flow.ended == "rest", flow.at
        if not settled:
            if turn % 2:
                break
            continue
        at = last_step.at.copy()
        at[those] = there
        last_step = bed.newton(at, before, last_step.parameter, viscosity, None, downhill=True)
        if last_step.settled:
            break
    return last_step
