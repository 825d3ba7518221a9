"""The limit of the elastic path: the factor of safety of many blocks (METHOD-3.md §13).

Joints are elastic without tension (`elastic_path.bed`). Gravity comes on at a strength well above the static bound,
then

    A   the strength goes down, λ x 0.85 a step, until the blocks run: implicit viscous flow shows that they do;
    C   while they run, viscosity is taken away and λ set free, the work of the load prescribed and raised;
    L   once the modes of the contacts have settled, Newton on them and λ: the limit state, exact.

That limit is the factor. Where C or L do not get there the path starts again nearer to the last state at rest; where
nothing helps the elastic peak, the factor at which the blocks were last at rest, stands for it, and says so.
With the load instead of the strength as what changes (`Drive.ramp`) the same gives a load multiplier. There a peak is
passed where blocks that flow slowly from the last state at rest come to another: a sliver has snapped, nothing failed.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.onlooker import say
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces
from slopekit.preie.elastic_path.flow import EASES, THICK, Flow, relaxed, stepped
from slopekit.preie.elastic_path.path_limit import BORDERED, PathLimit, PathOutcome, limit_state, result_of
from slopekit.preie.elastic_path.traced import traced
from slopekit.preie.programs.bounds import held_by_normals
from slopekit.preie.solvers.work_limit import WorkSpentError
from slopekit.preie.tolerances import FARTHEST, LEAST_STRENGTH, RUNS, SAME_LIMIT, VISCOUS_LEFT

START = 2.0  # times the strength of the static bound, or of a known limit, at which a path begins
_STRIDE = 0.85  # of the strength, a step of stage A
_BRACKET = 2e-2  # how near A comes to the strength at which they run
_NEARER = (3e-3, 3e-4, 3e-5, 1e-6)  # and how near when C did not settle
_COHESIVE = (3e-3, 1e-4)  # and where cohesion acts on what is pressed, whose peaks need no more digits
_PATIENCE = 60  # factorisations in which a step of A should be at rest or run
ROUGHER = 7  # doublings of the strength to start from
_LIGHTER = 4  # first loads, each a tenth of the one before
# of ln λ: a limit so far below the last rest, 0.6 times it, or a step of stage A above it is that of another motion
_OTHER = 0.5
_FAILS = 7
_BORDERED_AS_WELL = 600  # unknowns in space up to which stage L is tried before C has settled: its matrix is dense
_CHEAPLY = 100  # and up to which it is tried with the same modes again
_SNAPS, _FARTHER, _SLOWLY = 20, 1e3, 4000  # of a path in the load; work at which they run; factorisations


def follow(bed: Bed, start: float) -> PathLimit:
    """Return the limit of one assembly on its elastic joints.

    Parameters
    ----------
    start : strength (λ) at which gravity comes on, or the first load multiplier

    Raises
    ------
    WorkSpentError
        The work that is allowed is done.
    """
    path = _Path(bed, start)
    try:
        ended = path.limit()
    except WorkSpentError:
        raise WorkSpentError(1.0 / path.stable if path.stable and bed.drive.ramp is None else None) from None
    if ended.found or ended.outcome is PathOutcome.STANDS or bed.drive.ramp is not None:
        return ended
    normal = held_by_normals(bed.model, bed.drive.load)
    if normal is None:
        return ended
    # a wedge in a slot settles so far on elastic joints that it seemed to run
    friction, still = np.zeros_like(ended.friction), np.zeros_like(ended.motion)
    return replace(
        ended, outcome=PathOutcome.STANDS, parameter=None, peak=None, motion=still, normal=normal, friction=friction
    )


class _Path:
    """The states at rest of one assembly, from a strength that holds it, or its first load, to its limit.

    Attributes
    ----------
    stable : the last parameter at rest, None before the first; state : the flow that came to rest there
    last_near : the last at rest within so many elastic displacements as a motion that runs has; has_crept : whether
        blocks rest farther off
    """

    def __init__(self, bed: Bed, start: float) -> None:
        self.bed, self.start = bed, start
        self.is_strength = bed.drive.ramp is None
        self.stable: float | None = None
        self.last_near, self.has_crept = math.nan, False
        self.failed: Flow | None = None  # the last flow whose forces did not settle
        cohesion = bed.cells is not None
        self.rounds = self.is_strength and not bed.dilates and not cohesion and bed.tangents > 1
        self.brackets = (_BRACKET, *(_COHESIVE if cohesion else _NEARER[: None if bed.tangents == 1 else 2]))
        self.tried = 1 if cohesion and bed.tangents > 1 else len(self.brackets)  # brackets with a try at a limit state

    def limit(self) -> PathLimit:
        """Return the limit, a peak, or why there is none."""
        bed = self.bed
        parameter, flow = at_rest_first(bed, self.start, ROUGHER)
        if flow.ended != "rest":
            outcome = PathOutcome.GAVE_UP if flow.ended == "lost" else PathOutcome.NO_REST
            return result_of(bed, outcome, None, None, flow.at, flow.at - flow.before, flow.forces)
        self.begun = parameter
        self._accept_rest(parameter, flow)
        ended = self._narrowed()
        return replace(ended, last_near=self.last_near) if self.has_crept else ended

    def _narrowed(self) -> PathLimit:
        """Return the limit between a state at rest and ever nearer parameters at which the blocks run."""
        bed, brackets = self.bed, self.brackets
        assert self.stable is not None
        # parameters at which nothing was found at rest, the worst first, and the work of the state they were tried from
        runs: list[tuple[float, Flow, float]] = []
        ratio, place, snaps = _STRIDE, 0, 0 if self.is_strength else _SNAPS
        while True:
            if runs and 1.0 - bed.drive.gap(runs[-1][0], self.stable) < brackets[place]:
                unstable, flow, work_before = runs.pop()
                if self.is_strength and self._work_done() > work_before + bed.elastic_work:  # they have crept on since
                    nearer = at_rest_next(bed, self.state.at, unstable)
                    if nearer.ended == "rest":
                        self._accept_rest(unstable, nearer)
                        place = 0
                        continue
                    flow = nearer
                if flow.ended != "runs":
                    flow = relaxed(bed, flow.at, unstable, max(flow.viscosity, THICK), runs_at=RUNS)
                if flow.ended != "rest":
                    ended = self._running_limit(flow, unstable) if place < self.tried else None
                    if ended is not None:
                        return replace(ended, peak=(self.stable, unstable))
                    runs.append((unstable, flow, self._work_done()))
                    place += 1
                    if place < len(brackets):
                        continue
                    slow = flow
                    if snaps:
                        slow = relaxed(bed, self.state.at, unstable, THICK, runs_at=_FARTHER, patience=_SLOWLY)
                    if slow.ended != "rest":
                        moved, peak = flow.at - flow.before, (self.stable, unstable)
                        at, forces = self.state.at, self.state.forces
                        return result_of(bed, PathOutcome.BRACKET, self.stable, peak, at, moved, forces)
                    flow, snaps, ratio = slow, snaps - 1, _STRIDE  # they only snapped, to another rest
                    runs.clear()
                    place = 0
                self._accept_rest(unstable, flow)
            if runs:
                ratio = math.sqrt(bed.drive.gap(runs[-1][0], self.stable))
            trial = bed.drive.harder(self.stable, ratio)
            say("path, strength divided by" if self.is_strength else "path, load times",
                1.0 / trial if self.is_strength else trial)  # fmt: skip
            tried = at_rest_next(bed, self.state.at, trial)
            if tried.ended != "rest":
                runs.append((trial, tried, self._work_done()))
                continue
            self._accept_rest(trial, tried)
            if (trial < LEAST_STRENGTH * self.begun) if self.is_strength else (trial > FARTHEST):
                return result_of(bed, PathOutcome.STANDS, None, None, tried.at, tried.at, tried.forces)
            if not runs:
                ratio = max(ratio * _STRIDE, 0.5)

    def _accept_rest(self, parameter: float, flow: Flow) -> None:
        """Go on from a state at rest."""
        self.stable, self.state = parameter, flow
        self.has_crept = has_crept(self.bed, flow)
        if not self.has_crept:
            self.last_near = parameter

    def _work_done(self) -> float:
        """Return the work of the load that drives, up to the last state at rest."""
        return abs(float(self.bed.working @ self.state.at))

    def _running_limit(self, flow: Flow, unstable: float) -> PathLimit | None:
        """Return the limit of the motion that runs, None where its forces do not settle.

        Of cohesive contacts that of the cohesion that acts at the last state at rest, where a motion that opens them
        has no limit between that state and itself; and none that lies beyond that state, which would then run before.
        """
        bed = self.bed
        assert self.stable is not None
        ended = None if flow is self.failed else _run(bed, flow, unstable)
        self.failed = flow  # the same again ends the same
        if ended is None and self.rounds:
            ended, self.rounds = traced(bed, self.state.at, self.stable), False
        if bed.cells is None or (ended is not None and self._is_between(ended, unstable)):
            return self._checked_motion(ended)
        bonded = bed.with_cohesion_at(self.state.at, self.stable)
        flow = relaxed(bonded, self.state.at, unstable, THICK, runs_at=RUNS)
        ended = self._checked_motion(_run(bonded, flow, unstable)) if flow.ended == "runs" else None
        if ended is None or ended.parameter is None or bed.drive.gap(ended.parameter, self.stable) < 1.0:
            return None
        return ended

    def _checked_motion(self, ended: PathLimit | None) -> PathLimit | None:
        """Return a limit that is that of the motion which ends the last rest; None where it is another's."""
        assert self.stable is not None
        if ended is None or ended.parameter is None:
            return None
        return ended if _STRIDE < self.bed.drive.gap(ended.parameter, self.stable) < math.exp(_OTHER) else None

    def _is_between(self, ended: PathLimit, unstable: float) -> bool:
        """Return whether a limit lies between the last state at rest and a parameter at which the blocks run."""
        assert self.stable is not None
        low, high = sorted((self.stable, unstable))
        return ended.parameter is not None and low * (1.0 - SAME_LIMIT) <= ended.parameter <= high * (1.0 + SAME_LIMIT)


def at_rest_first(bed: Bed, start: float, rougher: int) -> tuple[float, Flow]:
    """Gravity on at a strength that holds the blocks near where they are, or the load before it is raised."""
    none = np.zeros(bed.size)
    if bed.drive.ramp is not None:
        step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, 0.0, 0.0)
        flow = Flow(step.at, step.forces, "rest" if step.settled else "lost", step.at, 0.0)
        flow = flow if step.settled else relaxed(bed, none, 0.0, 1.0, runs_at=1e9)
        for parameter in start * 0.1 ** np.arange(_LIGHTER):
            tried = at_rest_next(bed, flow.at, float(parameter)) if flow.ended == "rest" else flow
            if tried.ended == "rest":
                return float(parameter), tried
        return start, flow
    parameter, far = start, list[tuple[float, Flow]]()
    flow = Flow(none, bed.forces(none, start), "lost", none, 0.0)
    for _ in range(rougher + 1):
        step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, parameter, 0.0)
        is_balanced = step.settled and step.forces.balanced(step.forces.residual)
        if is_balanced and abs(float(bed.drive.load @ step.at)) < 5.0 * bed.elastic_work:
            return parameter, Flow(step.at, step.forces, "rest", step.at, 0.0)
        flow = relaxed(bed, none, parameter, 1.0, runs_at=3e2)
        if flow.ended == "rest":
            if not has_crept(bed, flow):
                return parameter, flow
            far.append((parameter, flow))  # stronger joints may hold them nearer
        parameter *= 2.0
    return [*far, (parameter, flow)][0]


def has_crept(bed: Bed, flow: Flow) -> bool:
    """Return whether blocks are farther from where they set off than a motion that runs gets at once."""
    return abs(float(bed.working @ flow.at)) > RUNS * bed.elastic_work


def at_rest_next(bed: Bed, at: Floats, parameter: float) -> Flow:
    """From one state at rest to a worse parameter."""
    flow = relaxed(bed, at, parameter, 0.0, runs_at=RUNS, patience=_PATIENCE)
    if flow.ended == "rest" and flow.viscosity == 0.0:
        working = bed.working
        if abs(float(working @ flow.at)) > 5.0 * max(abs(float(working @ at)), bed.elastic_work):
            return relaxed(bed, at, parameter, 0.3, runs_at=RUNS, patience=_PATIENCE)  # Newton jumped to a far state
    return flow


def _run(bed: Bed, flow: Flow, parameter: float) -> PathLimit | None:
    """The limit of the motion that runs; None where its forces do not settle."""
    if flow.ended != "runs":
        flow = relaxed(bed, flow.at, parameter, max(flow.viscosity, THICK), runs_at=RUNS)
    return _eased(bed, flow, parameter)


def _eased(bed: Bed, flow: Flow, parameter: float) -> PathLimit | None:
    """Stage C: viscosity goes, the parameter is free, the work grows."""
    working = bed.working
    at, forces, viscosity = flow.at, bed.forces(flow.at, parameter), flow.viscosity
    work = float(working @ at)
    moved, gained = at - flow.before, work - float(working @ flow.before)
    if gained == 0.0 or work == 0.0:
        return None
    eases, grows, steps, fails = EASES, 1.5, 0, 0
    failed: BedForces | None = None  # the modes that stage L was tried with last
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
        far = work > 1e3 * bed.elastic_work
        steady, slow = changed < 1e-2 * SAME_LIMIT, changed < SAME_LIMIT
        settled = viscous < SAME_LIMIT and ((same and (steady or (slow and far))) or (steady and far))
        small = bed.size <= (BORDERED if bed.tangents == 1 else _BORDERED_AS_WELL)
        tries = small and viscous < VISCOUS_LEFT
        if failed is not None and forces.same_modes(failed):
            tries = tries and (bed.tangents == 1 or bed.size <= _CHEAPLY)
        if tries or (settled and bed.size <= BORDERED):
            exact = limit_state(bed, at, moved, parameter)
            if exact is not None:
                return exact
            failed = forces
        if settled:
            return result_of(bed, PathOutcome.SETTLED, parameter, None, at, moved, forces)
        if work > FARTHEST * bed.elastic_work:
            break
    return None
