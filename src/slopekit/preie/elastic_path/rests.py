"""Equilibrium of all blocks just below a factor, and whether they are at their limit there.

The limit that a group of blocks proposes is confirmed by this.
"""

import math
from collections.abc import Iterator

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.flow import THICK, Flow, viscous_relaxation, viscous_step
from slopekit.preie.elastic_path.interior_point import (
    interior_point_equilibrium,
    interior_point_flow,
)
from slopekit.preie.elastic_path.path_limit import PathLimit
from slopekit.preie.solvers.work_limit import WorkSpentError, budget_fraction
from slopekit.preie.tolerances import MOBILISED, RUNS, TINY

_FIRST_GAP = 0.1  # to a factor, at which all blocks have to come to rest first
CONFIRMATION_GAP = 1e-3  # to a factor, at which all blocks have to come to rest last
_GAP_RATIO = 0.5  # from one gap to the next
#: Unknowns from which the interior-point method is tried first (of 304 blocks Newton's method and viscous flow take
#: no longer, of 501 eight times as long), and up to which it is tried just below the factor (7,251 take minutes).
_INTERIOR_FROM, _INTERIOR_NEAR_UP_TO = 2000, 30000
_MAX_WORK_RATIO = 5.0  # times the work: another rest is far away
_VISCOUS_FROM_RATIO = 0.8  # ratio from which on viscous flow is tried
_WORK_FRACTION = 0.7  # of the work that is left
_REST_FACTORISATIONS = 250  # on the way to a state at rest
_LIMIT_FACTORISATIONS = 600  # to see whether blocks run
_STRENGTH_LOSS = 1e-2  # below a limit's strength, where blocks at their limit have to run


def equilibrium_at_strength(
    bed: ElasticContactModel, displacement: Floats, parameter: float
) -> Flow | None:
    """Return all blocks at rest at one strength, from a displacement (N,); None where no rest was found.

    Thousands of blocks are solved by the interior-point method, from joints that stick; of more than
    `_INTERIOR_NEAR_UP_TO` unknowns nothing else is tried.
    """
    rest = interior_point_equilibrium(bed, parameter) if _is_large(bed) else None
    if rest is not None or bed.size > _INTERIOR_NEAR_UP_TO:
        return rest
    flow = viscous_relaxation(
        bed, displacement, parameter, 1.0, runs_at=RUNS, patience=_LIMIT_FACTORISATIONS
    )
    return flow if flow.ended == "rest" else None


def _is_large(bed: ElasticContactModel) -> bool:
    """Return whether the interior-point method is tried first: it takes no curved laws and no pressed cohesion."""
    return (
        bed.tangents > 1
        and not bed.strengths.curved
        and bed.cells is None
        and bed.size > _INTERIOR_FROM
    )


def equilibrium_below(
    bed: ElasticContactModel, factor: float, accepted_gap: float = CONFIRMATION_GAP
) -> tuple[Flow, float]:
    """Return the equilibrium of all blocks just below a factor, and its gap to the factor, in parts of it.

    Parameters
    ----------
    accepted_gap : gap, in parts of the factor, that is accepted where slivers do not settle any nearer

    Returns
    -------
    the state at rest just below it, or the flow that shows which blocks move; and the gap

    Raises
    ------
    WorkSpentError
        Most of the work that is left was done, and no state at rest is so near.
    """
    nearest: tuple[Flow, float] | None = None
    try:
        with budget_fraction(_WORK_FRACTION):
            for nearest in _nearer_equilibria(bed, factor, accepted_gap):  # noqa: B007
                pass
    except WorkSpentError:
        if nearest is None or nearest[1] > accepted_gap:
            raise WorkSpentError(None if nearest is None else factor * (1.0 - nearest[1])) from None
    assert nearest is not None
    return nearest


def _nearer_equilibria(
    bed: ElasticContactModel, factor: float, accepted_gap: float
) -> Iterator[tuple[Flow, float]]:
    """Iterate over ever nearer states of all blocks and their gaps to the factor; the last one is the answer."""
    gap = _FIRST_GAP
    if _is_large(bed):
        for trial in (
            (CONFIRMATION_GAP, accepted_gap)
            if bed.size <= _INTERIOR_NEAR_UP_TO
            else (accepted_gap,)
        ):
            interior_flow = interior_point_equilibrium(bed, 1.0 / (factor * (1.0 - trial)))
            if interior_flow is not None:
                yield interior_flow, trial
                return
    flow = viscous_relaxation(
        bed,
        bed.elastic_displacement,
        1.0 / (factor * (1.0 - gap)),
        1.0,
        runs_at=RUNS,
        patience=_REST_FACTORISATIONS,
    )
    # `change` of the displacement on the way from the gap + `width`
    stride, change, width = _GAP_RATIO, np.zeros(bed.size), gap
    yield flow, gap
    while flow.ended == "rest" and gap > CONFIRMATION_GAP:
        trial = gap * stride
        parameter, predicted = (
            1.0 / (factor * (1.0 - trial)),
            flow.displacement + (gap - trial) / width * change,
        )
        step = viscous_step(bed, predicted, predicted, parameter, 0.0)
        next_flow = Flow(step.displacement, step.forces, "rest", flow.displacement, 0.0)
        # Newton's method may have jumped to another rest far away
        if not (
            step.settled
            and abs(float(bed.working @ step.displacement))
            < _MAX_WORK_RATIO * abs(float(bed.working @ flow.displacement))
        ):
            if stride < _VISCOUS_FROM_RATIO:
                stride = math.sqrt(stride)
                continue
            next_flow = viscous_relaxation(
                bed,
                flow.displacement,
                parameter,
                THICK,
                runs_at=RUNS,
                patience=_REST_FACTORISATIONS,
            )
        if next_flow.ended in ("slow", "lost") and gap < accepted_gap:
            return
        change, width = next_flow.displacement - flow.displacement, gap - trial
        flow, gap, stride = next_flow, trial, max(stride * stride, _GAP_RATIO)
        yield flow, gap


def is_at_limit(bed: ElasticContactModel, flow: Flow, limit: PathLimit) -> bool:
    """Return whether blocks at rest just below a proposed limit are at their own limit: it is not far above.

    They are where the strength along its motion (N,) is used up to a twentieth: between what it needs and that strength
    lie what is not used up, and normal forces where the motion opens. Else they are let go beyond it, and have to run.
    """
    assert limit.parameter is not None
    _, slip = bed.motion(limit.motion, limit.parameter)
    resistance = (
        float((flow.forces.strength * np.sqrt((slip * slip).sum(axis=1))).sum()) * limit.parameter
    )
    if abs(float(bed.drive.load @ limit.motion) / max(resistance, TINY) - 1.0) < MOBILISED:
        return True
    weaker_parameter = (1.0 - _STRENGTH_LOSS) * limit.parameter
    if flow.rounding:  # the strength of a few blocks is rounded too
        interior_flow = interior_point_flow(bed, weaker_parameter)
        return interior_flow is not None and interior_flow.ended == "runs"
    return (
        viscous_relaxation(
            bed,
            flow.displacement,
            weaker_parameter,
            THICK,
            runs_at=RUNS,
            patience=_LIMIT_FACTORISATIONS,
        ).ended
        == "runs"
    )
