"""A limit that is found at once, without following the path: all blocks have to rest just before it."""

import math

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.onlooker import say
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import NewtonStep
from slopekit.preie.elastic_path.flow import stepped
from slopekit.preie.elastic_path.path_limit import PathLimit, PathOutcome, result_of
from slopekit.preie.elastic_path.rests import rests_before
from slopekit.preie.programs.program import BlockProgram, Strengths
from slopekit.preie.tolerances import EACH_BALANCED, FARTHEST, LEAST_STRENGTH, SAME_LIMIT, SOLVED

_FAR_DOWN, _MOST_STEPS = (1e-1, 1e-2, 1e-4, 1e-6), 100  # ε of proposals, and steps of their programs
_FAR = 1e3  # displacement in parts of the elastic, from which on a motion may have settled


def proposed(bed: Bed, bond: Floats, ratio: float) -> PathLimit | None:
    """The limit from one state of the elastic joints far down the path, found at once; None where there is none.

    The interior-point program with strengths that follow the normal forces has for its conditions those of the elastic
    joints at a displacement v / ε, λ free. Where it gets there the law itself has to hold, at ten times the
    displacement again and again: λ goes like the limit plus a part of 1/t. And the path has to get there: the blocks
    rest at a little more strength.
    """
    say("limit far down the path")
    model = bed.model
    program = BlockProgram(model, ratio)
    program.cohesion = program.carried(model.cohesion * bond)
    last: NewtonStep | None = None
    for part in _FAR_DOWN:
        program.elastic = part
        solution = program.solve(Strengths(model.tan_dilation), program.start, SOLVED, _MOST_STEPS)
        if solution.at.shed > EACH_BALANCED or solution.at.load_factor < LEAST_STRENGTH:
            continue
        at = solution.at.velocity / part
        step = stepped(bed, at, at, solution.at.load_factor, 0.0, float(bed.working @ at))
        if not step.settled:
            continue
        limit = _climbed(bed, step)
        if limit is None and last is not None and abs(step.parameter / last.parameter - 1.0) < 1e-2 * SAME_LIMIT:
            # a hundred times the displacement and the same factor, though Newton's method finds no way on
            limit = result_of(bed, PathOutcome.SETTLED, step.parameter, None, step.at, step.at - last.at, step.forces)
        last = step
        if limit is not None and limit.parameter is not None:
            flow, _ = rests_before(bed, 1.0 / limit.parameter)
            return limit if flow.ended == "rest" else None
    return None


def _climbed(bed: Bed, step: NewtonStep) -> PathLimit | None:
    """From a state of the elastic joints on to ever more work, λ free; None where Newton's method does not get far.

    λ goes like the limit plus a part of 1 / work, so a step that adds a part of the work has to change λ by no more
    than that part of what may be off: after a short one λ is always the same.
    """
    working = bed.working
    grows, fails, gained, far = 3.0, 0, bed.elastic_work, float(np.abs(bed.elastic_displacement).max())
    while True:
        motion = bed.onward(step)
        if motion is None:
            return None
        more = float(working @ step.at) + gained
        ahead = stepped(bed, step.at + gained * motion, step.at, step.parameter, 0.0, more)
        if not ahead.settled or not 0.3 < ahead.parameter / step.parameter < 3.0:
            gained, grows, fails = 0.3 * gained, math.sqrt(grows), fails + 1
            if fails > 6:
                return None
            continue
        changed = abs(ahead.parameter / step.parameter - 1.0)
        ratio = more / float(working @ step.at)
        before, step = step, ahead
        steady = changed < SAME_LIMIT * min(ratio - 1.0, 1.0)
        if steady and step.taken <= 3 and float(np.abs(step.at).max()) > _FAR * far:
            break
        gained *= grows
        grows = min(grows * grows, 10.0)
        if float(np.abs(step.at).max()) > FARTHEST * _FAR * far:
            return None
    settled = step.parameter + (step.parameter - before.parameter) / (ratio - 1.0)
    return result_of(bed, PathOutcome.SETTLED, settled, None, step.at, step.at - before.at, step.forces)
