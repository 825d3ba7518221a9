"""Blocks of elastic joints brought to rest: Newton's method, and implicit viscous flow where it does not get there.

A step of the flow adds η K_e (u - u_before) to what the forces have to balance; with η large enough it always has one
solution, and η falls from step to step. In space, where benches hold slivers a millionth of their largest block,
Newton's method stops as a rule with a few blocks out of balance: those are brought to rest with all others held where
they are, and it goes on with all (nonlinear elimination: Cai & Keyes 2002, SIAM J. Sci. Comput. 24, 183).
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState, NewtonStep

#: Factors on the viscosity after a converged step (after a failed one the inverse), and on its lower bound.
VISCOSITY_REDUCTION, _GENTLE_REDUCTION = 0.2, 0.5
THICK = 1e-2  # viscosity to restart with, in parts of the elastic stiffness
LEAST_VISCOSITY = 1e-8
_MAX_FAILED_STEPS = 6  # in a row
_MANY_BLOCKS = 12  # blocks in space from which unbalanced ones are eliminated
_MAX_LOCAL_FRACTION = 0.3  # of the blocks that are eliminated at once
_MAX_ROUNDS = 8  # of elimination
_LOCAL_FACTORISATIONS = 60  # of the eliminated blocks in a round
_UNBALANCED_FROM = 0.3  # of the allowed imbalance: blocks below it are not eliminated
_REQUIRED_REDUCTION = 0.5  # of the imbalance between rounds, else the elimination ends


@dataclass
class Flow:
    """Blocks in viscous flow: displacement, the one before, the viscosity of the last step, and how it ended.

    `rounding` is what the law of the joints is rounded by there, in parts of their elastic energy
    (`elastic_path.interior_point`).
    """

    displacement: Floats
    forces: ContactState
    ended: str  # rest, runs, slow, lost
    previous: Floats
    viscosity: float
    rounding: float = 0.0


def viscous_relaxation(
    bed: ElasticContactModel,
    displacement: Floats,
    parameter: float,
    viscosity: float,
    max_steps: int = 80,
    runs_at: float = 1e2,
    patience: int = 10000,
) -> Flow:
    """Return blocks in viscous flow from a displacement (N,) until they rest or run.

    Viscosity 0 tries Newton's method first.

    Parameters
    ----------
    runs_at : work from where they are, in parts of the elastic, at which they run
    patience : factorisations after which the flow is given up as slow
    """
    previous, last_viscosity, n_failed, least_viscosity = (
        displacement,
        viscosity,
        0,
        LEAST_VISCOSITY,
    )
    runs_at += bed.relative_work(displacement)
    patience += bed.factorisations
    for _ in range(max_steps):
        if bed.factorisations > patience:
            break
        step = viscous_step(bed, displacement, displacement, parameter, viscosity)
        if not step.settled:
            viscosity, n_failed = max(1.0 / VISCOSITY_REDUCTION * viscosity, THICK), n_failed + 1
            least_viscosity = (
                viscosity if bed.tangents > 1 else LEAST_VISCOSITY
            )  # of many blocks in space it goes slowly from there
            if n_failed > _MAX_FAILED_STEPS:
                return Flow(
                    displacement,
                    bed.forces(displacement, parameter),
                    "lost",
                    previous,
                    last_viscosity,
                )
            continue
        previous, displacement, last_viscosity, n_failed = (
            displacement,
            step.displacement,
            viscosity,
            0,
        )
        if viscosity == 0.0 or step.forces.balanced(step.forces.residual):
            return Flow(displacement, step.forces, "rest", previous, last_viscosity)
        if bed.relative_work(displacement) > runs_at:
            return Flow(displacement, step.forces, "runs", previous, last_viscosity)
        least_viscosity = max(_GENTLE_REDUCTION * least_viscosity, LEAST_VISCOSITY)
        viscosity = max(VISCOSITY_REDUCTION * viscosity, least_viscosity)
    return Flow(displacement, bed.forces(displacement, parameter), "slow", previous, last_viscosity)


def viscous_step(
    bed: ElasticContactModel,
    displacement: Floats,
    previous: Floats,
    parameter: float,
    viscosity: float,
    work: float | None = None,
) -> NewtonStep:
    """Return the balance of joint, load and viscous forces after one viscous step away from `previous` (N,).

    Newton's method downhill; where it stalls, elimination of a few blocks, and then full steps, which may climb.

    Parameters
    ----------
    work : of the driving load, to be met by changing the parameter as well; None: the parameter stays
    """
    step = bed.newton(displacement, previous, parameter, viscosity, work, downhill=True)
    has_many_blocks = bed.tangents > 1 and len(bed.model.load) >= _MANY_BLOCKS
    if has_many_blocks and work is None and not step.settled:
        step = _nonlinear_elimination(bed, step, previous, viscosity)
    if step.settled or (viscosity == 0.0 and work is None):
        return step
    return bed.newton(displacement, previous, parameter, viscosity, work, downhill=False)


def _nonlinear_elimination(
    bed: ElasticContactModel, last_step: NewtonStep, previous: Floats, viscosity: float
) -> NewtonStep:
    """Return a step of Newton's method on all blocks, the unbalanced ones settled first with all others held.

    Even rounds take the unbalanced blocks alone, odd rounds with their neighbours.
    """
    size, last_worst = bed.model.unknowns, np.inf
    for round_number in range(_MAX_ROUNDS):
        _, imbalance = bed.unbalanced_forces(
            last_step.displacement, previous, last_step.parameter, viscosity
        )
        imbalance = np.abs(imbalance / bed.unbalanced_at_most).reshape(-1, size).max(axis=1)
        is_unbalanced = imbalance > _UNBALANCED_FROM
        worst = float(imbalance.max())
        if not 0 < int(is_unbalanced.sum()) <= _MAX_LOCAL_FRACTION * len(is_unbalanced) or (
            round_number > 1 and worst > _REQUIRED_REDUCTION * last_worst
        ):
            break
        last_worst = worst
        if round_number % 2:
            is_unbalanced = bed.model.touching(is_unbalanced)
        blocks = np.flatnonzero(is_unbalanced)
        if len(blocks) > _MAX_LOCAL_FRACTION * len(is_unbalanced):
            break
        unknowns = (blocks[:, None] * size + np.arange(size)).ravel()
        restricted = bed.restricted_to(blocks, last_step.displacement)
        if viscosity:
            step = viscous_step(
                restricted,
                last_step.displacement[unknowns],
                previous[unknowns],
                last_step.parameter,
                viscosity,
            )
            settled, local_displacement = step.settled, step.displacement
        else:
            flow = viscous_relaxation(
                restricted,
                last_step.displacement[unknowns],
                last_step.parameter,
                0.0,
                runs_at=1e6,
                patience=_LOCAL_FACTORISATIONS,
            )
            settled, local_displacement = flow.ended == "rest", flow.displacement
        if not settled:
            if round_number % 2:
                break
            continue
        displacement = last_step.displacement.copy()
        displacement[unknowns] = local_displacement
        last_step = bed.newton(
            displacement, previous, last_step.parameter, viscosity, None, downhill=True
        )
        if last_step.settled:
            break
    return last_step
