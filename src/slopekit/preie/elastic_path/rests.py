"""Whether all blocks come to rest just before a factor, and whether they are at their limit there.

What was found another way than along the path, by a group, is held against this.
"""

import math
from collections.abc import Iterator

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.flow import THICK, Flow, relaxed, stepped
from slopekit.preie.elastic_path.lagged import lagged_flow, lagged_rest
from slopekit.preie.elastic_path.path_limit import PathLimit
from slopekit.preie.solvers.work_limit import WorkSpentError, part
from slopekit.preie.tolerances import MOBILISED, RUNS, TINY

_FIRST, JUST = 0.1, 1e-3  # gaps to a factor at which all have to come to rest: first, last
_CLOSER = 0.5  # from one gap to the next
#: Unknowns from which a lagged rest is looked for first (of 304 blocks Newton's method and viscous flow take no longer,
#: of 501 eight times as long), and up to which it is looked for just before the factor: of 7,251 that takes minutes.
_LAGGED, _LAGGED_FAR = 2000, 30000
_FAR = 5.0  # times the work: another rest is far away
_CLOSE_BY = 0.8  # ratio from which on viscous flow is tried
_OF_LEFT = 0.7  # of the work that is left
_TO_REST, _LET_GO, _BEYOND = 250, 600, 1e-2  # factorisations on the way to a rest, and at a limit; how far beyond it


def rest_at(bed: Bed, at: Floats, parameter: float) -> Flow | None:
    """All blocks at rest at one strength, from a displacement (N,); of thousands, from joints that stick, a lagged one.

    None where they are not.
    """
    rest = lagged_rest(bed, parameter) if _is_large(bed) else None
    if rest is not None or bed.size > _LAGGED_FAR:
        return rest
    flow = relaxed(bed, at, parameter, 1.0, runs_at=RUNS, patience=_LET_GO)
    return flow if flow.ended == "rest" else None


def _is_large(bed: Bed) -> bool:
    """Return whether a lagged rest is looked for first: it knows neither curved laws nor cohesion."""
    return bed.tangents > 1 and not bed.strengths.curved and bed.cells is None and bed.size > _LAGGED


def rests_before(bed: Bed, factor: float, near: float = JUST) -> tuple[Flow, float]:
    """All blocks towards a factor from the strong side.

    Parameters
    ----------
    near : a rest that is nearer in parts of the factor is an answer where slivers do not settle any nearer

    Returns
    -------
    their rest just before it, or the flow that shows who moves; how near to the factor it is, in parts of it

    Raises
    ------
    WorkSpentError
        Most of the work that is left was done, and no rest is so near.
    """
    known: tuple[Flow, float] | None = None
    try:
        with part(_OF_LEFT):
            for known in _nearer_rests(bed, factor, near):  # noqa: B007
                pass
    except WorkSpentError:
        if known is None or known[1] > near:
            raise WorkSpentError(None if known is None else factor * (1.0 - known[1])) from None
    assert known is not None
    return known


def _nearer_rests(bed: Bed, factor: float, near: float) -> Iterator[tuple[Flow, float]]:
    """The last rest each time, and how near to the factor it is; at the end what `rests_before` returns."""
    gap = _FIRST
    if _is_large(bed):
        for trial in (JUST, near) if bed.size <= _LAGGED_FAR else (near,):
            lagged = lagged_rest(bed, 1.0 / (factor * (1.0 - trial)))
            if lagged is not None:
                yield lagged, trial
                return
    flow = relaxed(bed, bed.elastic_displacement, 1.0 / (factor * (1.0 - gap)), 1.0, runs_at=RUNS, patience=_TO_REST)
    stride, moved, width = _CLOSER, np.zeros(bed.size), gap  # `moved` on the way from the gap + `width`
    yield flow, gap
    while flow.ended == "rest" and gap > JUST:
        trial = gap * stride
        parameter, ahead = 1.0 / (factor * (1.0 - trial)), flow.at + (gap - trial) / width * moved
        step = stepped(bed, ahead, ahead, parameter, 0.0)
        ahead_of_it = Flow(step.at, step.forces, "rest", flow.at, 0.0)
        # Newton's method may have jumped to another rest far away
        if not (step.settled and abs(float(bed.working @ step.at)) < _FAR * abs(float(bed.working @ flow.at))):
            if stride < _CLOSE_BY:
                stride = math.sqrt(stride)
                continue
            ahead_of_it = relaxed(bed, flow.at, parameter, THICK, runs_at=RUNS, patience=_TO_REST)
        if ahead_of_it.ended in ("slow", "lost") and gap < near:
            return
        moved, width = ahead_of_it.at - flow.at, gap - trial
        flow, gap, stride = ahead_of_it, trial, max(stride * stride, _CLOSER)
        yield flow, gap


def at_their_limit(bed: Bed, flow: Flow, limit: PathLimit) -> bool:
    """Whether blocks at rest just before a limit are at it: theirs is not far above.

    They are where the strength along its motion (N,) is used up to a twentieth: between what it needs and that strength
    lie what is not used up, and normal forces where the motion opens. Else they are let go beyond it, and have to run.
    """
    assert limit.parameter is not None
    _, slip = bed.motion(limit.motion, limit.parameter)
    resists = float((flow.forces.strength * np.sqrt((slip * slip).sum(axis=1))).sum()) * limit.parameter
    if abs(float(bed.drive.load @ limit.motion) / max(resists, TINY) - 1.0) < MOBILISED:
        return True
    beyond = (1.0 - _BEYOND) * limit.parameter
    if flow.rounding:  # what it says of the strength of a few blocks is rounded too
        lagged = lagged_flow(bed, beyond)
        return lagged is not None and lagged.ended == "runs"
    return relaxed(bed, flow.at, beyond, THICK, runs_at=RUNS, patience=_LET_GO).ended == "runs"
