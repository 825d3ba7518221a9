"""The limit of the elastic path: the factor of safety of many blocks (docs/theory/many-blocks.md).

Joints are elastic without tension (`elastic_path.bed`). Gravity comes on at a strength well above the static bound,
then

    A   the strength goes down, λ x 0.85 a step, until the blocks run: implicit viscous flow shows that they do;
    C   while they run, viscosity is taken away and λ set free, the work of the load prescribed and raised;
    L   once the modes of the contacts have settled, Newton on them and λ: the limit state, exact.

That limit is the factor. Where C or L do not get there the path starts again nearer to the last state at rest; where
nothing helps the elastic peak, the factor at which the blocks were last at rest, stands for it, and says so.
With the load instead of the strength as what changes (`Drive.ramp`) the same gives a load multiplier.

Blocks that run are let flow on, where their motion has no limit there: if they come to rest once more within `FAR`
elastic displacements of where they set off, the path goes on from there, in strength and in loads, with cohesion
and without. Blocks that creep are followed as far, and one block is too.
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
from slopekit.preie.programs.bounds import held_by_normals
from slopekit.preie.solvers.work_limit import WorkSpentError
from slopekit.preie.tolerances import FAR, FARTHEST, LEAST_STRENGTH, RUNS, SAME_LIMIT, VISCOUS_LEFT

START = 2.0  # times the strength of the static bound, or of a known limit, at which a path begins
_STRIDE = 0.85  # of the strength, a step of stage A
_BRACKET = 2e-2  # how near A comes to the strength at which they run
_NEARER = (3e-3, 3e-4, 3e-5, 1e-6)  # and how near when C did not settle
_NEARLY = (3e-3, 1e-4)  # in space, and where cohesion acts on what is pressed: such peaks need no more digits
_PATIENCE = 60  # factorisations in which a step of A should be at rest or run
ROUGHER = 7  # doublings of the strength to start from
_LIGHTER = 4  # first loads, each a tenth of the one before
# of ln λ: a limit so far below the last rest, 0.6 times it, is that of another motion
_OTHER = 0.5
_FAILS = 7
_BORDERED_AS_WELL = 600  # unknowns in space up to which stage L is tried before C has settled: its matrix is dense
_CHEAPLY = 100  # and up to which it is tried with the same modes again


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
    last_near : the last parameter at rest within `RUNS` elastic displacements
    """

    def __init__(self, bed: Bed, start: float) -> None:
        self.bed, self.start = bed, start
        self.is_strength = bed.drive.ramp is None
        self.stable: float | None = None
        self.last_near = math.nan
        self.failed: Flow | None = None  # the last flow whose forces did not settle
        cohesion = bed.cells is not None
        self.brackets = (_BRACKET, *(_NEARLY if cohesion or bed.tangents > 1 else _NEARER))
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
        return replace(ended, last_near=self.last_near) if has_crept(bed, self.state) else ended

    def _narrowed(self) -> PathLimit:
        """Return the limit between a state at rest and ever nearer parameters at which the blocks run."""
        bed, brackets = self.bed, self.brackets
        assert self.stable is not None
        # parameters at which nothing was found at rest, the worst first, and the work of the state they were tried from
        runs: list[tuple[float, Flow, float]] = []
        ratio, place = _STRIDE, 0
        while True:
            if runs and 1.0 - bed.drive.gap(runs[-1][0], self.stable) < brackets[place]:
                unstable, flow, tried_work = runs.pop()
                if bed.worked(self.state.at) > tried_work + 1.0:  # they have crept on since
                    flow = at_rest_next(bed, self.state.at, unstable)
                if flow.ended in ("slow", "lost"):
                    flow = relaxed(bed, flow.at, unstable, max(flow.viscosity, THICK), runs_at=RUNS)
                onward = flow
                if not self._rests(flow):
                    ended = self._running_limit(flow, unstable) if place < self.tried else None
                    if ended is not None:
                        return replace(ended, peak=(self.stable, unstable))
                    if flow.ended == "runs":
                        onward = relaxed(bed, flow.at, unstable, flow.viscosity, runs_at=FAR)
                if self._rests(onward):
                    self._accept_rest(unstable, onward)
                    place = 0
                    continue
                runs.append((unstable, flow, bed.worked(self.state.at)))
                place += 1
                if place == len(brackets):
                    moved, peak = flow.at - flow.before, (self.stable, unstable)
                    at, forces = self.state.at, self.state.forces
                    return result_of(bed, PathOutcome.BRACKET, self.stable, peak, at, moved, forces)
                continue
            if runs:
                ratio = math.sqrt(bed.drive.gap(runs[-1][0], self.stable))
            trial = bed.drive.harder(self.stable, ratio)
            say("path, strength divided by" if self.is_strength else "path, load times",
                1.0 / trial if self.is_strength else trial)  # fmt: skip
            tried = at_rest_next(bed, self.state.at, trial)
            if not self._rests(tried):
                runs.append((trial, tried, bed.worked(self.state.at)))
                continue
            self._accept_rest(trial, tried)
            if (trial < LEAST_STRENGTH * self.begun) if self.is_strength else (trial > FARTHEST):
                return result_of(bed, PathOutcome.STANDS, None, None, tried.at, tried.at, tried.forces)
            if not runs:
                ratio = max(ratio * _STRIDE, 0.5)

    def _accept_rest(self, parameter: float, flow: Flow) -> None:
        """Go on from a state at rest."""
        self.stable, self.state = parameter, flow
        if not has_crept(self.bed, flow):
            self.last_near = parameter

    def _running_limit(self, flow: Flow, unstable: float) -> PathLimit | None:
        """Return the limit of the motion that runs, None where its forces do not settle, or only beyond where it runs.

        Of cohesive contacts that of the cohesion that acts at the last state at rest, where a motion that opens them
        has no limit between that state and itself; and none that lies beyond that state, which would then run before.
        """
        bed = self.bed
        assert self.stable is not None
        ended = None
        if flow is not self.failed:  # the same again ends the same
            self.failed = flow
            ended = _eased(bed, flow, unstable)
        least, most = bed.drive.gap(unstable, self.stable) * (1.0 - SAME_LIMIT), math.exp(_OTHER)
        if bed.cells is None:
            return self._bounded_limit(ended, least, most)
        while_pressed = self._bounded_limit(ended, least, 1.0 + SAME_LIMIT)
        if while_pressed is not None:
            return while_pressed
        bonded = bed.with_cohesion_at(self.state.at, self.stable)
        flow = relaxed(bonded, self.state.at, unstable, THICK, runs_at=RUNS)
        return self._bounded_limit(_eased(bonded, flow, unstable), 1.0, most) if flow.ended == "runs" else None

    def _bounded_limit(self, ended: PathLimit | None, least: float, most: float) -> PathLimit | None:
        """Return a limit whose λ is so many times that of the last rest, at least and at most; None where it is not."""
        assert self.stable is not None
        if ended is None or ended.parameter is None:
            return None
        return ended if least < self.bed.drive.gap(ended.parameter, self.stable) < most else None

    def _rests(self, flow: Flow) -> bool:
        """Return whether blocks are at rest, and no farther off than those that run."""
        return flow.ended == "rest" and self.bed.worked(flow.at) <= FAR


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
    """Return whether blocks are so far from where they set off that they have all but failed."""
    return bed.worked(flow.at) > RUNS


def at_rest_next(bed: Bed, at: Floats, parameter: float) -> Flow:
    """From one state at rest to a worse parameter."""
    flow = relaxed(bed, at, parameter, 0.0, runs_at=RUNS, patience=_PATIENCE)
    if flow.ended == "rest" and flow.viscosity == 0.0 and bed.worked(flow.at) > 5.0 * max(bed.worked(at), 1.0):
        return relaxed(bed, at, parameter, 0.3, runs_at=RUNS, patience=_PATIENCE)  # Newton jumped to a far state
    return flow


def _eased(bed: Bed, flow: Flow, parameter: float) -> PathLimit | None:
    """Stage C: viscosity goes, the parameter is free, the work grows."""
    working = bed.working
    at, forces, viscosity = flow.at, bed.forces(flow.at, parameter), flow.viscosity
    work = float(working @ at)
    moved, gained = at - flow.before, work - float(working @ flow.before)
    if gained == 0.0 or work == 0.0:
        return None
    eases, grows, steps, fails = EASES, 1.5, 0, 0
    ahead = moved / gained
    failed: BedForces | None = None  # the modes that stage L was tried with last
    while steps < 60 and fails < _FAILS:
        more = work * (grows - 1.0)
        thinner = eases * viscosity * gained / more
        step = stepped(bed, at + more * ahead, at, parameter, thinner, work + more)
        if not step.settled or not 0.3 < step.parameter / parameter < 3.0:
            eases, grows, fails = min(math.sqrt(eases), 0.98), max(grows**0.6, 1.003), fails + 1
            ahead = moved / gained
            continue
        steps, fails = steps + 1, 0
        same, changed = step.forces.same_modes(forces), abs(step.parameter / parameter - 1.0)
        moved, gained, viscosity = step.at - at, more, thinner
        at, parameter, forces, work = step.at, step.parameter, step.forces, work + more
        viscous = forces.residual / bed.load_size
        tangent = bed.onward(step) if viscous < SAME_LIMIT else None
        ahead = moved / gained if tangent is None else tangent
        if step.taken <= 4:
            grows, eases = min(grows**1.5, 10.0), max(0.3 * eases, 1e-3)
        far = work > 1e3 * bed.elastic_work
        steady, slow = changed < 1e-2 * SAME_LIMIT, changed < SAME_LIMIT
        settled = viscous < SAME_LIMIT and ((same and (steady or (slow and far))) or (steady and far))
        small = bed.size <= (BORDERED if bed.tangents == 1 else _BORDERED_AS_WELL)
        tries = (same or failed is None) and small and viscous < VISCOUS_LEFT
        if failed is not None and forces.same_modes(failed):
            tries = tries and (bed.tangents == 1 or bed.size <= _CHEAPLY)
        if tries or (settled and bed.size <= BORDERED):
            exact = limit_state(bed, at, moved, parameter)
            if exact is not None:
                return exact
            failed = forces
        if settled:
            return result_of(bed, PathOutcome.SETTLED, parameter, None, at, moved, forces)
        if work > FARTHEST**2 * bed.elastic_work:
            break
    return None
