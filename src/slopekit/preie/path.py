"""The limit of the elastic path: the factor of safety of many blocks (METHOD-3.md §13).

Joints are elastic without tension (`preie.bed`). Gravity comes on at a strength well above the static bound, then

    R   in a section of many blocks first: joints with rounded corners, whose path is one curve, made sharp far down it;
    A   the strength goes down, λ x 0.85 a step, until the blocks run: implicit viscous flow shows that they do;
    C   while they run, viscosity is taken away and λ set free, the work of the load prescribed and raised;
    L   in a section, once the modes of the contacts have settled, Newton on them and λ: the limit state, exact.

That limit is the factor. Where C or L do not get there the path starts again nearer to the last state at rest; where
nothing helps the elastic peak, the factor at which the blocks were last at rest, stands for it, and says so.
With the load instead of the strength as what changes (`Drive.ramp`) the same gives a load multiplier.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.linalg import lapack

from slopekit.arrays import Floats
from slopekit.onlooker import say
from slopekit.preie.bed import Bed, Forces, Step
from slopekit.preie.flow import EASES, THICK, Flow, relaxed, stepped
from slopekit.preie.program import BlockProgram, Strengths
from slopekit.preie.rounded import RoundedPath
from slopekit.preie.undilated import rest_without_dilation

_STRIDE = 0.85  # of the strength, a step of stage A
_RUNS = 30.0  # work in parts of the elastic: the blocks run
_BRACKET = 2e-2  # how near A comes to the strength at which they run
_NEARER = (3e-3, 3e-4, 3e-5, 1e-6)  # and how near when C did not settle
_PATIENCE = 60  # factorisations in which a step of A should be at rest or run
ROUGHER = 7  # doublings of the strength to start from
_LEAST = 1e-7  # strength in parts of the full: what stands there stands without any
_FARTHEST = 1e6  # load multiplier, or work of C in parts of the elastic
_EXACT = 5e-2  # viscous force in parts of the load below which the limit state of the modes is tried
_FAILS = 5
_EXACT_IN_SPACE = 1e-3  # and in space, where directions have to have settled too
_BORDERED = 1000  # unknowns up to which it is tried: its matrix is dense
_STEADY = 1e-6  # change of λ in a step of C, and viscous force, of a limit in space
_ADMISSIBLE = 1e-7  # forces of a limit state outside their bounds, in parts of the load
_FAR_DOWN, _PROPOSES, _MOST_STEPS = (1e-1, 1e-2, 1e-4, 1e-6), 1e-9, 100  # ε of proposals, how well they settle, steps
_FIRST, _CLOSER, JUST = 0.1, 0.5, 1e-3  # gaps to a factor at which all have to come to rest: first, ratio, last
_THOUSANDS = 4000  # unknowns from which on that first rest is looked for by way of joints that dilate
_CLOSE_BY = 0.8  # ratio from which on viscous flow is tried
_TO_REST, _LET_GO, _BEYOND = 250, 600, 1e-2  # factorisations to come to rest, and to run; how far beyond a limit
_MOBILISED = 5e-2  # of the strength along a motion, that blocks may not need just before its limit
_FAR = 1e3  # displacement in parts of the elastic, from which on a motion may have settled
_SHED = 1e-6  # of the load, that a proposal may leave unbalanced
_STEADIES = 1e-12  # of the elastic stiffness, added to that of the modes: there may be several motions
_ROUNDINGS = (1e-5, 1e-4, 1e-2, 3e-3)  # of the joints in space, one after the other (`preie.rounded`)
_MARKS = (1e3, 1e4, 1e5, 1e6)  # work in parts of the elastic at which they are made sharp
_SURE = 1e-4  # rounding up to which the path is that of the sharp joints: histories agree
_TRACED, _FARTHER, _RESTS = 250, 150, 300  # factorisations to get there, and farther, and to come to rest
_TIMES, _NEARLY = 3.0, 3e-6  # so much farther, and what λ may change by
_MANY = 600  # unknowns of a section from which the path of rounded joints is tried first
_BROADLY, _FINELY = (1.0, 1e-2), (1e-4, 1e-2)  # rounding there, one after the other, and in smaller sections
_SHARPER, _ALIKE = 1e-5, 1e-3  # what is left of it far down, and how much λ may change by that
_FOLLOWED, _SHARPENED = 1000, 150  # factorisations from one mark to the next, and of making joints sharp
_HALVED = 12  # bisections between two points of the rounded path
_GOES = 5  # shorter steps before Newton's method is said not to go on
_JUMP = 0.1  # of the strength, in a step far along a motion: another motion
_TURNS = 12  # how often directions of slip in space follow the motion
_OFF = 1e-9  # its residual, in parts of the largest force
_KINEMATIC = 1e-6  # its motion: what should not open or slip, in parts of the fastest


class PathOutcome(StrEnum):
    """How the path ended."""

    LIMIT = "limit state"
    SETTLED = "the running forces stopped changing"
    BRACKET = "last state at rest"
    STANDS = "stands without strength"
    NO_REST = "comes to rest at no strength"
    GAVE_UP = "the search gave up"


@dataclass(frozen=True, slots=True)
class PathLimit:
    """What the path found.

    Attributes
    ----------
    outcome, parameter : λ = 1/F or the load multiplier, None where there is none
    peak : the last parameter at rest, and the first that runs
    motion : (N,) of the mechanism, its largest part 1; normal : (m,); friction : (g, t); bond : (m,)
    displacement : (N,) of the elastic joints
    reduction : λ of the joints there
    residual : largest unbalanced force in parts of the largest load
    started : the parameter at which gravity, or the first load, was at rest
    group : blocks that were not held when it was found, 0 where none was; width : how much nearer than that, in
        parts of it, all blocks were not seen at rest
    factorisations : work done
    """

    outcome: PathOutcome
    parameter: float | None
    peak: tuple[float, float] | None
    displacement: Floats
    motion: Floats
    normal: Floats
    friction: Floats
    reduction: float
    residual: float
    factorisations: int
    started: float = math.nan
    group: int = 0
    width: float = 0.0

    @property
    def found(self) -> bool:
        """Whether it is a limit state."""
        return self.outcome in (PathOutcome.LIMIT, PathOutcome.SETTLED)


def follow(bed: Bed, start: float, brief: bool = False) -> PathLimit:
    """The limit of one bed.

    Parameters
    ----------
    start : strength (λ) at which gravity comes on, or the first load multiplier
    brief : gives up where gravity does not come to rest there, and after the first bracket that does not settle
    """
    strength = bed.drive.ramp is None
    parameter, flow = _started(bed, start, 0 if brief else ROUGHER)
    if flow.ended != "rest":
        without = PathOutcome.GAVE_UP if flow.ended == "lost" else PathOutcome.NO_REST
        return _result(bed, without, None, None, flow.at, flow.at - flow.before, flow.forces)
    at, begun, first = flow.at, parameter, flow.at
    runs: list[tuple[float, Flow]] = []  # parameters at which nothing was found at rest, the worst first
    ratio = _STRIDE
    nearest = iter((_BRACKET, *_NEARER[: 1 if brief else None if bed.tangents == 1 else 2]))
    near = next(nearest)
    traces = strength and bed.tangents > 1 and not bed.dilates
    smooth = strength and bed.tangents == 1 and not bed.dilates and bed.bolted is None
    if smooth and bed.size > _MANY:
        ended = _traced_in_section(bed, at, parameter, _BROADLY)
        if ended is not None:
            return replace(ended, started=begun)
        smooth = False
    while True:
        if runs and 1.0 - bed.drive.gap(runs[-1][0], parameter) < near:
            bad, flow = runs.pop()
            if flow.ended != "runs":
                flow = relaxed(bed, flow.at, bad, max(flow.viscosity, THICK), far=_RUNS)
            if flow.ended != "rest":
                ended = _run(bed, flow, bad)
                if ended is None and traces:
                    ended, traces = _traced(bed, (first, begun), (at, parameter), bad), False
                if ended is not None:
                    return replace(ended, peak=(parameter, bad), started=begun)
                runs.append((bad, flow))
                near = next(nearest, 0.0)
                if near == 0.0:
                    break
                continue
            parameter, at = bad, flow.at
        if runs:
            ratio = math.sqrt(bed.drive.gap(runs[-1][0], parameter))
        trial = bed.drive.harder(parameter, ratio)
        say("path, strength divided by" if strength else "path, load times", 1.0 / trial if strength else trial)
        tried = _tried(bed, at, trial)
        if tried.ended != "rest":
            runs.append((trial, tried))
            continue
        parameter, at = trial, tried.at
        if (parameter < _LEAST * start) if strength else (parameter > _FARTHEST):
            return _result(bed, PathOutcome.STANDS, None, None, at, at, tried.forces)
        if not runs:
            ratio = max(ratio * _STRIDE, 0.5)
    if smooth and not brief:
        ended = _traced_in_section(bed, first, begun, _FINELY)
        if ended is not None and (ended.parameter or 0.0) >= bad:
            return replace(ended, peak=(parameter, bad), started=begun)
    forces = bed.forces(at, parameter)
    peak = _result(bed, PathOutcome.BRACKET, parameter, (parameter, bad), at, flow.at - flow.before, forces)
    return replace(peak, started=begun)


def _traced(bed: Bed, first: tuple[Floats, float], last: tuple[Floats, float], runs: float) -> PathLimit | None:
    """The limit by way of rounded joints, from states at rest; None where their path is not found or nothing settles.

    Far along it the joints are made sharp, and Newton's method goes on; where it does not, sharp states at ever more
    work have to agree. The blocks have to be at rest, in sharp joints, at a little more strength. Much rounding, from
    the first state at rest, may lead to another motion than little, from the last: a limit found with it is none where
    it is above the factor at which the blocks have run.
    """
    for rounding in _ROUNDINGS:
        curve = RoundedPath(bed, rounding)
        at, parameter = last if rounding <= _SURE else first
        if not curve.begin(at, parameter):
            continue
        for mark in _MARKS:
            if not curve.onto(mark, _TRACED) or curve.reduction < _LEAST * parameter:
                break
            sharp = curve.sharpened(_TRACED)
            if sharp is None:
                break
            there = sharp.displacement
            step = stepped(bed, there, there, sharp.reduction, 0.0, float(bed.working @ there))
            limit = _far(bed, step) if step.settled else None
            if limit is None:
                limit = _farther(bed, sharp)
            if limit is None:
                continue
            if rounding > _SURE and (limit.parameter or 0.0) < runs:
                break
            if _rests_on(bed, limit, curve.passed, there):
                return limit
    return None


def _farther(bed: Bed, sharp: RoundedPath) -> PathLimit | None:
    """The limit of a path of sharp joints whose λ has settled: at three times the work it is the same."""
    work, reduction, before = sharp.work, sharp.reduction, sharp.displacement
    if not sharp.onto(_TIMES * work, _FARTHER):
        return None
    limit = sharp.reduction + (sharp.reduction - reduction) / (sharp.work / work - 1.0)
    if not abs(sharp.reduction / reduction - 1.0) < _NEARLY:
        return None
    # where several blocks slide at one strength their speeds are anyone's, and Newton's method has no state to go to
    return _result(bed, PathOutcome.SETTLED, limit, None, sharp.displacement, sharp.displacement - before, _on(sharp))


def _on(curve: RoundedPath) -> Forces:
    """The forces of a path of nearly sharp joints where it is."""
    bed, (normal, friction) = curve.bed, curve.forces
    unbalanced = bed.columns @ np.concatenate([normal, friction.ravel()]) + bed.drive.load
    there = bed.forces(curve.displacement, curve.reduction)
    return replace(there, normal=normal, friction=friction, unbalanced=unbalanced)


def _traced_in_section(bed: Bed, at: Floats, parameter: float, roundings: tuple[float, ...]) -> PathLimit | None:
    """The limit of a section by way of rounded joints, from the first state at rest; None where nothing settles.

    Between many blocks the sharp path snaps at every few steps. Rounded it is one curve through all of that, and
    only far down it the joints are made sharp, at ever more work: λ goes like the limit plus a part of 1 / work. Where
    Newton on the modes gets there the limit state is exact. Much rounding may lead to another motion: λ must hardly
    change as the joints are made sharp. All blocks have to rest, in sharp joints, at a little more strength, and, after
    much rounding, that strength has to be used up along the motion, or they run beyond it.
    """
    for rounding in roundings:
        curve = RoundedPath(bed, rounding)
        if not curve.begin(at, parameter):
            continue
        before: RoundedPath | None = None
        last, limit = math.inf, None
        for mark in _MARKS:
            sharp = curve.sharpened(_SHARPENED, _SHARPER) if curve.onto(mark, _FOLLOWED) else None
            if sharp is None or not abs(sharp.reduction / curve.reduction - 1.0) < _ALIKE:
                break
            moved = sharp.displacement - (at if before is None else before.displacement)
            limit = limit_state(bed, sharp.displacement, moved, sharp.reduction) if bed.size <= _BORDERED else None
            if limit is None and before is not None:
                settles = sharp.reduction + (sharp.reduction - before.reduction) / (sharp.work / before.work - 1.0)
                if min(abs(settles / last - 1.0), abs(sharp.reduction / before.reduction - 1.0)) < _STEADY:
                    limit = _result(bed, PathOutcome.SETTLED, settles, None, sharp.displacement, moved, _on(sharp))
                last = settles
            if limit is not None:
                break
            before = sharp
        if limit is not None and _rests_along(bed, limit, curve, rounding):
            return limit
    return None


def _rests_along(bed: Bed, limit: PathLimit, curve: RoundedPath, rounding: float) -> bool:
    """Whether sharp joints hold all blocks a thousandth to three before a limit, and the limit is not far above that.

    Looked for by bisection between the points that the rounded path passed before it.
    """
    assert limit.parameter is not None
    strength = limit.parameter / (1.0 - JUST)

    def sharp_at(place: float) -> RoundedPath | None:
        (reduction, one), (less, other) = curve.passed[int(place)], curve.passed[int(place) + 1]
        part, there = place % 1.0, RoundedPath(bed, rounding)
        begun = there.begin(one + part * (other - one), reduction + part * (less - reduction))
        return there.sharpened(_SHARPENED, _SHARPER) if begun else None

    high = float(next((k for k, (reduction, _) in enumerate(curve.passed) if reduction < strength), 0))
    low, sharp = high, None
    while low > 0.0 and (sharp is None or sharp.reduction < strength):
        high, low = low, low - 1.0
        sharp = sharp_at(low)
    for _ in range(_HALVED):
        if sharp is None or sharp.reduction < strength:
            return False
        if sharp.reduction * (1.0 - 3.0 * JUST) < limit.parameter:
            break
        trial = sharp_at(middle := (low + high) / 2.0)
        if trial is None or trial.reduction < strength:
            high = middle
        else:
            low, sharp = middle, trial
    assert sharp is not None
    flow = relaxed(bed, sharp.displacement, sharp.reduction, 0.0, far=_FARTHEST, patience=_RESTS)
    near = sharp.reduction * (1.0 - 3.0 * JUST) < limit.parameter
    if not near or flow.ended != "rest":
        return False
    return rounding <= _SURE or at_their_limit(bed, flow, limit)  # hardly rounded it came past the peak itself


def _far(bed: Bed, step: Step) -> PathLimit | None:
    """From a state of the sharp joints to so much work that λ stays; None where Newton's method does not get there.

    λ goes like the limit plus a part of 1 / work, as long as the same joints touch.
    """
    working = bed.working
    work, ratio, fails, last = float(working @ step.at), 3.0, 0, math.nan
    motion = bed.onward(step)
    while True:
        more = work * (ratio - 1.0)
        ahead = None
        if motion is not None:
            ahead = stepped(bed, step.at + more * motion, step.at, step.parameter, 0.0, work + more)
        if ahead is None or not ahead.settled or abs(ahead.parameter / step.parameter - 1.0) > _JUMP:
            ratio, fails = math.sqrt(ratio), fails + 1
            if fails > _GOES:
                return None
            continue
        limit = ahead.parameter + (ahead.parameter - step.parameter) / (ratio - 1.0)
        before, step, work = step, ahead, work + more
        if work > _FARTHEST * bed.elastic_work:
            if abs(limit / last - 1.0) < _STEADY:
                return _result(bed, PathOutcome.SETTLED, limit, None, step.at, step.at - before.at, step.forces)
            if work > _FARTHEST**2 * bed.elastic_work:
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
    flow = relaxed(bed, near, strength, 0.0, far=_FARTHEST, patience=_RESTS)
    return flow.ended == "rest" or rests_before(bed, 1.0 / limit.parameter)[0].ended == "rest"


def _started(bed: Bed, start: float, rougher: int) -> tuple[float, Flow]:
    """Gravity on at a strength that holds the blocks, or the load before it is raised."""
    none = np.zeros(bed.size)
    if bed.drive.ramp is not None:
        step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, 0.0, 0.0)
        flow = Flow(step.at, step.forces, "rest" if step.settled else "lost", step.at, 0.0)
        return start, flow if step.settled else relaxed(bed, none, 0.0, 1.0, far=1e9)
    parameter = start
    flow = Flow(none, bed.forces(none, start), "lost", none, 0.0)
    for _ in range(rougher + 1):
        step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, parameter, 0.0)
        if step.settled and abs(float(bed.drive.load @ step.at)) < 5.0 * bed.elastic_work:
            return parameter, Flow(step.at, step.forces, "rest", step.at, 0.0)
        flow = relaxed(bed, none, parameter, 1.0, far=3e2)
        if flow.ended == "rest":
            return parameter, flow
        parameter *= 2.0
    return parameter, flow


def _tried(bed: Bed, at: Floats, parameter: float) -> Flow:
    """From one state at rest to a worse parameter."""
    flow = relaxed(bed, at, parameter, 0.0, far=_RUNS, patience=_PATIENCE)
    if flow.ended == "rest" and flow.viscosity == 0.0:
        working = bed.working
        if abs(float(working @ flow.at)) > 5.0 * max(abs(float(working @ at)), bed.elastic_work):
            return relaxed(bed, at, parameter, 0.3, far=_RUNS, patience=_PATIENCE)  # Newton jumped to a far state
    return flow


def _run(bed: Bed, flow: Flow, parameter: float) -> PathLimit | None:
    """The limit of the motion that runs; None where its forces do not settle."""
    if flow.ended != "runs":
        flow = relaxed(bed, flow.at, parameter, max(flow.viscosity, THICK), far=_RUNS)
    far = _RUNS
    for again in range(3 if bed.tangents == 1 else 1):
        found = _eased(bed, flow, parameter)
        if found is not None or again == 2 or bed.tangents > 1:
            return found
        far *= 20.0
        flow = relaxed(bed, flow.at, parameter, max(flow.viscosity, 1e-3), most=25, far=far)
        if flow.ended != "runs":
            return _eased(bed, flow, parameter)
    return None


def _eased(bed: Bed, flow: Flow, parameter: float) -> PathLimit | None:
    """Stage C: viscosity goes, the parameter is free, the work grows."""
    working = bed.working
    at, forces, viscosity = flow.at, bed.forces(flow.at, parameter), flow.viscosity
    work = float(working @ at)
    moved, gained = at - flow.before, work - float(working @ flow.before)
    if gained == 0.0 or work == 0.0:
        return None
    eases, grows, steps, fails = EASES, 1.5, 0, 0
    while steps < 60 and fails < _FAILS:
        more = work * (grows - 1.0)
        thinner = eases * viscosity * gained / more
        step = stepped(bed, at + moved * (more / gained), at, parameter, thinner, work + more)
        if not step.settled or not 0.3 < step.parameter / parameter < 3.0:
            eases, grows, fails = min(math.sqrt(eases), 0.98), max(grows**0.6, 1.003), fails + 1
            continue
        steps, fails = steps + 1, 0
        same, changed = step.forces.same_modes(forces), abs(step.parameter / parameter - 1.0)
        moved, gained, viscosity = step.at - at, more, thinner
        at, parameter, forces, work = step.at, step.parameter, step.forces, work + more
        viscous = forces.residual / bed.load_size
        if step.taken <= 4:
            grows, eases = min(grows**1.5, 10.0), max(0.3 * eases, 1e-3)
        if viscous < (_EXACT if bed.tangents == 1 else _EXACT_IN_SPACE) and bed.size <= _BORDERED:
            exact = limit_state(bed, at, moved, parameter)
            if exact is not None:
                return exact
        far = work > 1e3 * bed.elastic_work
        if same and viscous < _STEADY and (changed < 1e-2 * _STEADY or (changed < _STEADY and far)):
            return _result(bed, PathOutcome.SETTLED, parameter, None, at, moved, forces)
        if work > _FARTHEST * bed.elastic_work:
            break
    return None


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
    last: Step | None = None
    for part in _FAR_DOWN:
        program.elastic = part
        found = program.solve(Strengths(model.tan_dilation), program.start, _PROPOSES, _MOST_STEPS)
        if found.at.shed > _SHED or found.at.load_factor < _LEAST:
            continue
        at = found.at.velocity / part
        step = stepped(bed, at, at, found.at.load_factor, 0.0, float(bed.working @ at))
        if not step.settled:
            continue
        limit = _climbed(bed, step)
        if limit is None and last is not None and abs(step.parameter / last.parameter - 1.0) < 1e-2 * _STEADY:
            # a hundred times the displacement and the same factor, though Newton's method finds no way on
            limit = _result(bed, PathOutcome.SETTLED, step.parameter, None, step.at, step.at - last.at, step.forces)
        last = step
        if limit is not None and limit.parameter is not None:
            flow, _ = rests_before(bed, 1.0 / limit.parameter)
            return limit if flow.ended == "rest" else None
    return None


def rests_before(bed: Bed, factor: float, near: float = JUST) -> tuple[Flow, float]:
    """All blocks towards a factor from the strong side.

    Parameters
    ----------
    near : a rest that is nearer in parts of the factor is an answer where slivers do not settle any nearer

    Returns
    -------
    their rest just before it, or the flow that shows who moves; how near to the factor it is, in parts of it
    """
    gap = _FIRST
    strong = 1.0 / (factor * (1.0 - gap))
    at_once = rest_without_dilation(bed, strong) if bed.size > _THOUSANDS else None
    flow = at_once or relaxed(bed, bed.elastic_displacement, strong, 1.0, far=_RUNS, patience=_TO_REST)
    stride, moved, width = _CLOSER, np.zeros(bed.size), gap  # `moved` on the way from the gap + `width`
    while flow.ended == "rest" and gap > JUST:
        trial = gap * stride
        parameter, ahead = 1.0 / (factor * (1.0 - trial)), flow.at + (gap - trial) / width * moved
        step = stepped(bed, ahead, ahead, parameter, 0.0)
        if step.settled and abs(float(bed.working @ step.at)) < 5.0 * abs(float(bed.working @ flow.at)):
            ahead_of_it = Flow(step.at, step.forces, "rest", flow.at, 0.0)
        elif stride < _CLOSE_BY:
            stride = math.sqrt(stride)
            continue
        else:
            ahead_of_it = relaxed(bed, flow.at, parameter, THICK, far=_RUNS, patience=_TO_REST)
        if ahead_of_it.ended in ("slow", "lost") and gap < near:
            return flow, gap
        moved, width = ahead_of_it.at - flow.at, gap - trial
        flow, gap, stride = ahead_of_it, trial, max(stride * stride, _CLOSER)
    return flow, gap


def at_their_limit(bed: Bed, flow: Flow, limit: PathLimit) -> bool:
    """Whether blocks at rest just before a limit are at it: theirs is not far above.

    They are where the strength along its motion (N,) is used up to a twentieth: between what it needs and that strength
    lie what is not used up, and normal forces where the motion opens. Else they are let go beyond it, and have to run.
    """
    assert limit.parameter is not None
    _, slip = bed.motion(limit.motion, limit.parameter)
    resists = float((flow.forces.strength * np.sqrt((slip * slip).sum(axis=1))).sum()) * limit.parameter
    if abs(float(bed.drive.load @ limit.motion) / max(resists, 1e-300) - 1.0) < _MOBILISED:
        return True
    beyond = (1.0 - _BEYOND) * limit.parameter
    return relaxed(bed, flow.at, beyond, THICK, far=_RUNS, patience=_LET_GO).ended == "runs"


def _climbed(bed: Bed, step: Step) -> PathLimit | None:
    """From a state of the elastic joints on to ever more work, λ free; None where Newton's method does not get far."""
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
        before, step = step, ahead
        if changed < _STEADY and step.taken <= 3 and float(np.abs(step.at).max()) > _FAR * far:
            break
        gained *= grows
        grows = min(grows * grows, 10.0)
        if float(np.abs(step.at).max()) > _FARTHEST * _FAR * far:
            return None
    # λ goes like the limit plus a part of 1 / work
    ratio = float(working @ step.at) / float(working @ before.at)
    settled = step.parameter + (step.parameter - before.parameter) / (ratio - 1.0)
    return _result(bed, PathOutcome.SETTLED, settled, None, step.at, step.at - before.at, step.forces)


def limit_state(bed: Bed, at: Floats, moved: Floats, parameter: float) -> PathLimit | None:
    """Stage L: the exact limit state of the contact modes at a displacement; None where there is none.

    The displacement is t v + w: v the motion, along which nothing changes, w what the joints have given. Newton on w
    and the parameter, modes held; accepted only if residual, N >= 0, |T| <= λ r, and the motion all agree. In space
    the directions of slip are those of the motion found, until they stay.
    """
    modes = bed.forces(at, parameter)
    v = moved / np.sqrt(float(moved @ moved))
    at = at - v * (float((across := bed.viscous(v)) @ at) / float(across @ v))
    for _ in range(1 if bed.tangents == 1 else _TURNS):
        found = _of_modes(bed, modes, at, v, parameter)
        if found is None:
            return None
        at, parameter, here, v, agrees = found
        if agrees:
            return _result(bed, PathOutcome.LIMIT, parameter, None, at, v, here)
        if bed.tangents == 1:
            return None
        modes = bed.turned(modes, v)
    return None


def _of_modes(
    bed: Bed, modes: Forces, w: Floats, v: Floats, parameter: float
) -> tuple[Floats, float, Forces, Floats, bool] | None:
    """Displacement w, parameter, forces and motion of the modes, and whether the motion has them; None: inadmissible"""
    across = bed.viscous(v)
    along = float(across @ v)
    for _ in range(8):
        here = bed.forces(w, parameter, modes=modes)
        solver = _bordered(bed, here, parameter, across)
        if solver is None:
            return None
        change = solver(np.append(here.unbalanced, -float(across @ w)))
        if not np.isfinite(change).all():
            return None
        w, parameter = w + change[:-1], parameter + float(change[-1])
        if abs(float(change[-1])) < 1e-13 * abs(parameter) and float(np.abs(change[:-1]).max()) < 1e-12 * float(
            np.abs(w).max()
        ):
            break
    here = bed.forces(w, parameter, modes=modes)
    reduction, _ = bed.drive.at(parameter)
    spare = reduction * here.strength - np.sqrt((here.friction * here.friction).sum(axis=1))
    outside = -min(float(here.normal.min()), float(spare.min()))
    if bed.bolted is not None:
        outside = max(outside, -float(here.friction[bed.bolted, 0].min()))
    if parameter <= 0.0 or here.residual > _OFF * max(modes.largest, here.largest):
        return None
    if outside > _ADMISSIBLE * bed.load_size:
        return None
    solver = _bordered(bed, here, parameter, across)
    if solver is not None:  # the null vector of the stiffness
        motion = solver(np.append(np.zeros(bed.size), along))
        if abs(float(motion[-1])) < _KINEMATIC * abs(parameter) and _moves(
            bed, here, motion[:-1], parameter, _KINEMATIC
        ):
            return w, parameter, here, motion[:-1], True
        if bed.tangents > 1 and abs(float(motion[-1])) < _STEADY:
            return w, parameter, here, motion[:-1], False
    agrees = _moves(bed, here, v, parameter, 1e-4)  # there are several: the flow itself
    return (w, parameter, here, v, True) if agrees else None


def _bordered(bed: Bed, here: Forces, parameter: float, across: Floats) -> Callable[[Floats], Floats] | None:
    """A solver of the modes' stiffness with the parameter as one more unknown and `across` as one more equation."""
    size = bed.size
    matrix = np.zeros((size + 1, size + 1))
    local = bed.tangent(here, parameter, turning=False) + _STEADIES * bed.elastic
    matrix[:-1, :-1] = bed.stiffness.dense(local)
    matrix[:-1, -1] = -bed.by_parameter(here, parameter)
    matrix[-1, :-1] = across
    lu, pivots, info = lapack.dgetrf(matrix)
    if info != 0:
        return None

    def solve(right: Floats) -> Floats:
        found: Floats = lapack.dgetrs(lu, pivots, right)[0]
        return found

    return solve


def _moves(bed: Bed, modes: Forces, motion: Floats, parameter: float, part: float) -> bool:
    """Whether a motion opens, slips and holds what the modes say, up to a part of its fastest."""
    opening, slip = bed.motion(motion, parameter)
    forward = (slip * modes.direction).sum(axis=1)
    aside = np.abs(slip - forward[:, None] * modes.direction).max(axis=1)
    aside[~modes.slips] = np.abs(slip[~modes.slips]).max(axis=1)
    most = part * max(float(np.abs(opening).max()), float(np.abs(slip).max()))
    return (
        float(opening.min()) > -most
        and float(opening[modes.touching].max(initial=0.0)) < most
        and float(forward[modes.slips].min(initial=0.0)) > -most
        and float(aside.max()) < most
    )


def _result(
    bed: Bed, outcome: PathOutcome, parameter: float | None, peak: tuple[float, float] | None, at: Floats,
    motion: Floats, forces: Forces,
) -> PathLimit:  # fmt: skip
    fastest = max(float(np.abs(motion).max(initial=0.0)), 1e-300)
    return PathLimit(
        outcome, parameter, peak, at, motion / fastest, forces.normal, forces.friction,
        bed.drive.at(parameter or 1.0)[0], forces.residual / bed.load_size, bed.factorisations,
    )  # fmt: skip
