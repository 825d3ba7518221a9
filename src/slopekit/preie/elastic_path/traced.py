"""The limit by way of joints with rounded corners (`elastic_path.rounded`): one curve, made sharp far along it.

In space where viscous flow does not settle beyond a peak.
"""

import math

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import NewtonStep
from slopekit.preie.elastic_path.flow import relaxed, stepped
from slopekit.preie.elastic_path.path_limit import BORDERED, PathLimit, PathOutcome, limit_state, result_of
from slopekit.preie.elastic_path.rests import JUST, rests_before
from slopekit.preie.elastic_path.rounded import RoundedPath
from slopekit.preie.tolerances import (
    FARTHEST,
    LEAST_STRENGTH,
    OTHER_MOTION,
    POLISHED,
    SAME_LIMIT,
)

#: Rounding of the joints in space, one after the other: of 140 random benches 22 come to it, none to the second, which
#: one bench under an earthquake needs.
_ROUNDINGS = (1e-5, 1e-4)
_MARKS = (1e3, 1e4, 1e5, 1e6)  # work in parts of the elastic at which they are made sharp
_TRACED, _RESTS = 250, 300  # factorisations to get there, and to come to rest
_MANY = 100  # unknowns from which a rounding that does not get to the first mark is the last
_GOES = 5  # shorter steps before Newton's method is said not to go on


def traced(bed: Bed, at: Floats, parameter: float) -> PathLimit | None:
    """The limit by way of rounded joints, from the last state at rest; None where none is found or nothing settles.

    Far along their path the joints are made sharp, and Newton's method goes on. The blocks have to be at rest, in sharp
    joints, at a little more strength. Of many blocks more rounding than the least that begins is not tried where that
    does not get to the first mark.
    """
    for rounding in _ROUNDINGS:
        curve = RoundedPath(bed, rounding)
        if not curve.begin(at, parameter):
            continue
        for mark in _MARKS:
            if not curve.onto(mark, _TRACED):
                if mark == _MARKS[0] and bed.size > _MANY:
                    return None  # of many blocks no other rounding gets there either
                break
            if curve.reduction < LEAST_STRENGTH * parameter:
                break
            sharp = curve.sharpened(_TRACED)
            if sharp is None:
                break
            there = sharp.displacement
            step = stepped(bed, there, there, sharp.reduction, 0.0, float(bed.working @ there))
            limit = _far(bed, step) if step.settled else None
            if limit is not None and _rests_on(bed, limit, curve.passed, there):
                return _exact(bed, limit)
    return None


def _exact(bed: Bed, limit: PathLimit) -> PathLimit:
    """The limit state that a settled motion comes to, where Newton on its modes gets there: one number by any way."""
    assert limit.parameter is not None
    exact = limit_state(bed, limit.displacement, limit.motion, limit.parameter) if bed.size <= BORDERED else None
    if exact is None or not abs((exact.parameter or 0.0) / limit.parameter - 1.0) < POLISHED:
        return limit
    return exact


def _far(bed: Bed, step: NewtonStep) -> PathLimit | None:
    """From a state of the sharp joints to so much work that λ stays; None where Newton's method does not get there.

    λ goes like the limit plus a part of 1 / work, as long as the same joints touch.
    """
    work, ratio, fails, last = float(bed.working @ step.at), 3.0, 0, math.nan
    motion = bed.onward(step)
    while True:
        more = work * (ratio - 1.0)
        there = None if motion is None else step.at + more * motion
        ahead = None if there is None else stepped(bed, there, step.at, step.parameter, 0.0, work + more)
        if ahead is None or not ahead.settled or abs(ahead.parameter / step.parameter - 1.0) > OTHER_MOTION:
            ratio, fails = math.sqrt(ratio), fails + 1
            if fails > _GOES:
                return None
            continue
        limit = ahead.parameter + (ahead.parameter - step.parameter) / (ratio - 1.0)
        before, step, work = step, ahead, work + more
        if work > FARTHEST * bed.elastic_work:
            if abs(limit / last - 1.0) < SAME_LIMIT:
                return result_of(bed, PathOutcome.SETTLED, limit, None, step.at, step.at - before.at, step.forces)
            if work > FARTHEST**2 * bed.elastic_work:
                return None
        ratio, last, motion = min(ratio * math.sqrt(ratio), 10.0), limit, bed.onward(step)


def _rests_on(bed: Bed, limit: PathLimit, passed: list[tuple[float, Floats]], sharp: Floats) -> bool:
    """Whether all blocks come to rest at a little more strength than that of a limit.

    Looked for near where the path `passed` it (λ and displacement), and near states on the way to the limit.
    """
    assert limit.parameter is not None
    strength = limit.parameter / (1.0 - JUST)
    after = next((k for k, (reduction, _) in enumerate(passed) if reduction < strength), len(passed))
    near = passed[min(after, len(passed) - 1)][1]
    if 0 < after < len(passed):
        (more, one), (less, other) = passed[after - 1], passed[after]
        near = one + (other - one) * ((more - strength) / (more - less))
    if any(stepped(bed, at, at, strength, 0.0).settled for at in (near, sharp, limit.displacement)):
        return True
    flow = relaxed(bed, near, strength, 0.0, runs_at=FARTHEST, patience=_RESTS)
    return flow.ended == "rest" or rests_before(bed, 1.0 / limit.parameter)[0].ended == "rest"
