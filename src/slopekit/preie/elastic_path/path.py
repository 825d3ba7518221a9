"""The limit of the elastic path: the factor of safety of many blocks (docs/theory/many-blocks.md).

Joints are elastic without tension (`elastic_path.contact_model`). Gravity comes on at a strength well above the static
bound, then

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
from slopekit.core.progress import report_stage
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState
from slopekit.preie.elastic_path.flow import (
    THICK,
    VISCOSITY_REDUCTION,
    Flow,
    viscous_relaxation,
    viscous_step,
)
from slopekit.preie.elastic_path.path_limit import (
    BORDERED,
    PathLimit,
    PathOutcome,
    limit_state,
    result_of,
)
from slopekit.preie.programs.bounds import frictionless_equilibrium
from slopekit.preie.solvers.work_limit import WorkSpentError
from slopekit.preie.tolerances import FAR, FARTHEST, LEAST_STRENGTH, RUNS, SAME_LIMIT, VISCOUS_LEFT

START = 2.0  # times the strength of the static bound, or of a known limit, at which a path begins
_STRIDE = 0.85  # of the strength, a step of stage A
_BRACKET = 2e-2  # width of the bracket that A ends with
_NARROW_BRACKETS = (3e-3, 3e-4, 3e-5, 1e-6)  # widths after it, where C did not settle
#: In space, and where cohesion acts on the pressed part of contacts: such peaks need no more digits.
_COARSE_BRACKETS = (3e-3, 1e-4)
_PATIENCE = 60  # factorisations in which a step of A should be at rest or run
MAX_DOUBLINGS = 7  # of the strength to start from
_FIRST_LOADS = 4  # first loads, each a tenth of the one before
# of ln λ: a limit so far below the last state at rest, 0.6 times it, is that of another motion
_MAX_LOG_DROP = 0.5
_MAX_FAILED_STEPS = 7
_BORDERED_EARLY = 600  # unknowns in space up to which stage L is tried before C has settled
_BORDERED_AGAIN = 100  # unknowns in space up to which stage L is tried with the same modes again


def trace_limit(bed: ElasticContactModel, start: float) -> PathLimit:
    """Return the limit of one assembly on its elastic joints.

    Parameters
    ----------
    start : strength (λ) at which gravity comes on, or the first load multiplier

    Raises
    ------
    WorkSpentError
        The allowed work was done before the limit was found.
    """
    path = _Path(bed, start)
    try:
        limit = path.limit()
    except WorkSpentError:
        raise WorkSpentError(
            1.0 / path.stable if path.stable and bed.drive.ramp is None else None
        ) from None
    if limit.is_limit or limit.outcome is PathOutcome.STANDS or bed.drive.ramp is not None:
        return limit
    normal = frictionless_equilibrium(bed.model, bed.drive.load)
    if normal is None:
        return limit
    # a wedge in a slot settles so far on elastic joints that it seemed to run
    friction, no_motion = np.zeros_like(limit.friction), np.zeros_like(limit.motion)
    return replace(
        limit,
        outcome=PathOutcome.STANDS,
        parameter=None,
        peak=None,
        motion=no_motion,
        normal=normal,
        friction=friction,
    )


class _Path:
    """The states at rest of one assembly, from a strength that holds it, or its first load, to its limit.

    Attributes
    ----------
    stable : the last parameter at rest, None before the first; state : the flow that came to rest there
    last_near : the last parameter at rest within `RUNS` elastic displacements
    """

    def __init__(self, bed: ElasticContactModel, start: float) -> None:
        self.bed, self.start = bed, start
        self.is_strength = bed.drive.ramp is None
        self.stable: float | None = None
        self.last_near = math.nan
        self.failed: Flow | None = None  # the last flow whose forces did not settle
        cohesion = bed.cells is not None
        self.brackets = (
            _BRACKET,
            *(_COARSE_BRACKETS if cohesion or bed.tangents > 1 else _NARROW_BRACKETS),
        )
        self.limit_state_brackets = (
            1 if cohesion and bed.tangents > 1 else len(self.brackets)
        )  # brackets with a try at a limit state

    def limit(self) -> PathLimit:
        """Return the limit state, an elastic peak, or why the path has none."""
        bed = self.bed
        parameter, flow = first_equilibrium(bed, self.start, MAX_DOUBLINGS)
        if flow.ended != "rest":
            outcome = PathOutcome.GAVE_UP if flow.ended == "lost" else PathOutcome.NO_REST
            return result_of(
                bed,
                outcome,
                None,
                None,
                flow.displacement,
                flow.displacement - flow.previous,
                flow.forces,
            )
        self.first_parameter = parameter
        self._accept_rest(parameter, flow)
        limit = self._narrow_bracket()
        return replace(limit, last_near=self.last_near) if has_crept(bed, self.state) else limit

    def _narrow_bracket(self) -> PathLimit:
        """Return the limit in the bracket between the last state at rest and a parameter at which the blocks run."""
        bed, brackets = self.bed, self.brackets
        assert self.stable is not None
        # parameters at which nothing was found at rest, the worst first, and the work of the state they were tried from
        unstable_trials: list[tuple[float, Flow, float]] = []
        ratio, bracket_index = _STRIDE, 0
        while True:
            if (
                unstable_trials
                and 1.0 - bed.drive.parameter_ratio(unstable_trials[-1][0], self.stable)
                < brackets[bracket_index]
            ):
                unstable, flow, tried_work = unstable_trials.pop()
                if (
                    bed.relative_work(self.state.displacement) > tried_work + 1.0
                ):  # they have crept on since
                    flow = next_equilibrium(bed, self.state.displacement, unstable)
                if flow.ended in ("slow", "lost"):
                    flow = viscous_relaxation(
                        bed, flow.displacement, unstable, max(flow.viscosity, THICK), runs_at=RUNS
                    )
                continued = flow
                if not self._rests(flow):
                    limit = (
                        self._running_limit(flow, unstable)
                        if bracket_index < self.limit_state_brackets
                        else None
                    )
                    if limit is not None:
                        return replace(limit, peak=(self.stable, unstable))
                    if flow.ended == "runs":
                        continued = viscous_relaxation(
                            bed, flow.displacement, unstable, flow.viscosity, runs_at=FAR
                        )
                if self._rests(continued):
                    self._accept_rest(unstable, continued)
                    bracket_index = 0
                    continue
                unstable_trials.append((unstable, flow, bed.relative_work(self.state.displacement)))
                bracket_index += 1
                if bracket_index == len(brackets):
                    motion, peak = flow.displacement - flow.previous, (self.stable, unstable)
                    displacement, forces = self.state.displacement, self.state.forces
                    return result_of(
                        bed, PathOutcome.BRACKET, self.stable, peak, displacement, motion, forces
                    )
                continue
            if unstable_trials:
                ratio = math.sqrt(bed.drive.parameter_ratio(unstable_trials[-1][0], self.stable))
            trial = bed.drive.worsened(self.stable, ratio)
            report_stage(
                "path, strength divided by" if self.is_strength else "path, load times",
                1.0 / trial if self.is_strength else trial,
            )
            trial_flow = next_equilibrium(bed, self.state.displacement, trial)
            if not self._rests(trial_flow):
                unstable_trials.append(
                    (trial, trial_flow, bed.relative_work(self.state.displacement))
                )
                continue
            self._accept_rest(trial, trial_flow)
            if (
                (trial < LEAST_STRENGTH * self.first_parameter)
                if self.is_strength
                else (trial > FARTHEST)
            ):
                return result_of(
                    bed,
                    PathOutcome.STANDS,
                    None,
                    None,
                    trial_flow.displacement,
                    trial_flow.displacement,
                    trial_flow.forces,
                )
            if not unstable_trials:
                ratio = max(ratio * _STRIDE, 0.5)

    def _accept_rest(self, parameter: float, flow: Flow) -> None:
        """Make a state at rest the last one of the path."""
        self.stable, self.state = parameter, flow
        if not has_crept(self.bed, flow):
            self.last_near = parameter

    def _running_limit(self, flow: Flow, unstable: float) -> PathLimit | None:
        """Return the limit of a running motion; None where its forces settle nowhere between rest and running.

        Of cohesive contacts that of the cohesion that acts at the last state at rest, where a motion that opens them
        has no limit between that state and itself; and none that lies beyond that state, which would then run before.
        """
        bed = self.bed
        assert self.stable is not None
        limit = None
        if flow is not self.failed:  # a second try would end the same
            self.failed = flow
            limit = _remove_viscosity(bed, flow, unstable)
        least, most = (
            bed.drive.parameter_ratio(unstable, self.stable) * (1.0 - SAME_LIMIT),
            math.exp(_MAX_LOG_DROP),
        )
        if bed.cells is None:
            return self._bounded_limit(limit, least, most)
        pressed_limit = self._bounded_limit(limit, least, 1.0 + SAME_LIMIT)
        if pressed_limit is not None:
            return pressed_limit
        bonded = bed.with_pressed_cohesion(self.state.displacement, self.stable)
        flow = viscous_relaxation(bonded, self.state.displacement, unstable, THICK, runs_at=RUNS)
        return (
            self._bounded_limit(_remove_viscosity(bonded, flow, unstable), 1.0, most)
            if flow.ended == "runs"
            else None
        )

    def _bounded_limit(
        self, limit: PathLimit | None, least: float, most: float
    ) -> PathLimit | None:
        """Return the limit if its λ is `least` to `most` times that of the last state at rest; else None."""
        assert self.stable is not None
        if limit is None or limit.parameter is None:
            return None
        return (
            limit
            if least < self.bed.drive.parameter_ratio(limit.parameter, self.stable) < most
            else None
        )

    def _rests(self, flow: Flow) -> bool:
        """Return whether blocks are at rest within `FAR` elastic displacements."""
        return flow.ended == "rest" and self.bed.relative_work(flow.displacement) <= FAR


def first_equilibrium(bed: ElasticContactModel, start: float, doublings: int) -> tuple[float, Flow]:
    """Return the first parameter and state at rest of a path.

    Gravity comes on at a strength that holds the blocks near where they are, or the first load is raised.
    """
    no_displacement = np.zeros(bed.size)
    if bed.drive.ramp is not None:
        step = viscous_step(bed, bed.elastic_displacement, bed.elastic_displacement, 0.0, 0.0)
        flow = Flow(
            step.displacement,
            step.forces,
            "rest" if step.settled else "lost",
            step.displacement,
            0.0,
        )
        flow = (
            flow
            if step.settled
            else viscous_relaxation(bed, no_displacement, 0.0, 1.0, runs_at=1e9)
        )
        for parameter in start * 0.1 ** np.arange(_FIRST_LOADS):
            trial_flow = (
                next_equilibrium(bed, flow.displacement, float(parameter))
                if flow.ended == "rest"
                else flow
            )
            if trial_flow.ended == "rest":
                return float(parameter), trial_flow
        return start, flow
    parameter, crept = start, list[tuple[float, Flow]]()
    flow = Flow(no_displacement, bed.forces(no_displacement, start), "lost", no_displacement, 0.0)
    for _ in range(doublings + 1):
        step = viscous_step(bed, bed.elastic_displacement, bed.elastic_displacement, parameter, 0.0)
        is_balanced = step.settled and step.forces.balanced(step.forces.residual)
        if is_balanced and abs(float(bed.drive.load @ step.displacement)) < 5.0 * bed.elastic_work:
            return parameter, Flow(step.displacement, step.forces, "rest", step.displacement, 0.0)
        flow = viscous_relaxation(bed, no_displacement, parameter, 1.0, runs_at=3e2)
        if flow.ended == "rest":
            if not has_crept(bed, flow):
                return parameter, flow
            crept.append((parameter, flow))  # stronger joints may hold them nearer
        parameter *= 2.0
    return [*crept, (parameter, flow)][0]


def has_crept(bed: ElasticContactModel, flow: Flow) -> bool:
    """Return whether blocks at rest have moved by more than `RUNS` elastic displacements."""
    return bed.relative_work(flow.displacement) > RUNS


def next_equilibrium(bed: ElasticContactModel, displacement: Floats, parameter: float) -> Flow:
    """Return the flow from a state at rest (N,) at a worse parameter, by Newton's method or viscous."""
    flow = viscous_relaxation(bed, displacement, parameter, 0.0, runs_at=RUNS, patience=_PATIENCE)
    if (
        flow.ended == "rest"
        and flow.viscosity == 0.0
        and bed.relative_work(flow.displacement) > 5.0 * max(bed.relative_work(displacement), 1.0)
    ):
        return viscous_relaxation(
            bed, displacement, parameter, 0.3, runs_at=RUNS, patience=_PATIENCE
        )  # Newton jumped to a far state
    return flow


def _remove_viscosity(bed: ElasticContactModel, flow: Flow, parameter: float) -> PathLimit | None:
    """Return the limit of running blocks as viscosity is removed, with the work prescribed and λ free (stage C).

    None where their forces do not settle.
    """
    working = bed.working
    displacement, forces, viscosity = (
        flow.displacement,
        bed.forces(flow.displacement, parameter),
        flow.viscosity,
    )
    work = float(working @ displacement)
    motion, work_done = displacement - flow.previous, work - float(working @ flow.previous)
    if work_done == 0.0 or work == 0.0:
        return None
    reduction, growth, steps, n_failed = VISCOSITY_REDUCTION, 1.5, 0, 0
    prediction = motion / work_done
    failed_state: ContactState | None = None  # the modes that stage L was tried with last
    while steps < 60 and n_failed < _MAX_FAILED_STEPS:
        work_step = work * (growth - 1.0)
        next_viscosity = reduction * viscosity * work_done / work_step
        step = viscous_step(
            bed,
            displacement + work_step * prediction,
            displacement,
            parameter,
            next_viscosity,
            work + work_step,
        )
        if not step.settled or not 0.3 < step.parameter / parameter < 3.0:
            reduction, growth, n_failed = (
                min(math.sqrt(reduction), 0.98),
                max(growth**0.6, 1.003),
                n_failed + 1,
            )
            prediction = motion / work_done
            continue
        steps, n_failed = steps + 1, 0
        has_same_modes, parameter_change = (
            step.forces.same_modes(forces),
            abs(step.parameter / parameter - 1.0),
        )
        motion, work_done, viscosity = step.displacement - displacement, work_step, next_viscosity
        displacement, parameter, forces, work = (
            step.displacement,
            step.parameter,
            step.forces,
            work + work_step,
        )
        viscous = forces.residual / bed.load_size
        tangent = bed.tangent_direction(step) if viscous < SAME_LIMIT else None
        prediction = motion / work_done if tangent is None else tangent
        if step.n_steps <= 4:
            growth, reduction = min(growth**1.5, 10.0), max(0.3 * reduction, 1e-3)
        is_far = work > 1e3 * bed.elastic_work
        is_steady, is_slow = parameter_change < 1e-2 * SAME_LIMIT, parameter_change < SAME_LIMIT
        settled = viscous < SAME_LIMIT and (
            (has_same_modes and (is_steady or (is_slow and is_far))) or (is_steady and is_far)
        )
        is_small = bed.size <= (BORDERED if bed.tangents == 1 else _BORDERED_EARLY)
        tries_limit_state = (
            (has_same_modes or failed_state is None) and is_small and viscous < VISCOUS_LEFT
        )
        if failed_state is not None and forces.same_modes(failed_state):
            tries_limit_state = tries_limit_state and (
                bed.tangents == 1 or bed.size <= _BORDERED_AGAIN
            )
        if tries_limit_state or (settled and bed.size <= BORDERED):
            limit = limit_state(bed, displacement, motion, parameter)
            if limit is not None:
                return limit
            failed_state = forces
        if settled:
            return result_of(
                bed, PathOutcome.SETTLED, parameter, None, displacement, motion, forces
            )
        if work > FARTHEST**2 * bed.elastic_work:
            break
    return None
