"""The equilibrium of elastic blocks at a strength reduction factor.

Newton's method on (γ, w): full steps first, even where the residual rises, then steps against dashpots. Pairs whose
bond broke remember the slip at which it did, else they would alternate between open and closed. Open pairs have soft
springs during the search, which bring blocks in flight back; the equilibrium itself is found without them.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.elastic.condensed import Condensed, Displacements, ElasticModel
from slopekit.preie.system.contact import (
    CloughDuncan,
    ContactMode,
    JointStiffness,
    Tractions,
    breaks,
    tractions,
)

BALANCED = 1e-8  # residual of a state at rest, as a fraction of the load
_NEWTON_TOLERANCE = 1e-10  # residual at which Newton's method stops
_FULL_STEPS = 12  # most full steps of Newton's method
#: After so many full steps the residual has to be this fraction of the first, or the full steps end.
_TRIAL_STEPS, _REQUIRED_RATIO = 4, 0.5
_ROUNDS, _ROUND_STEPS = 12, 16  # rounds of steps against dashpots, and steps of a round
_FLOW_RESIDUAL = 5e-4  # residual after half of the rounds above which blocks do not come to rest
_DASHPOT = 0.1  # fraction of the normal stiffness
_LIGHT_ROUNDS = 10  # rounds with dashpots that soon get lighter, after the others
_MAX_IDLE_ROUNDS = 2  # such rounds in a row without progress that end them
_FLOW_DISTANCE = (
    1e3  # times the displacement at the start: blocks flow, and lighter dashpots do not help
)
_NEAR_REST = 3e-3  # residual below which dashpots at all pairs do not help
_MAX_RELEASES = 120  # rounds in which bonds break
_MAX_STEPS = 600  # of Newton's method, to a state at rest
_MAX_WORK = 1.2e7  # steps times rows: two minutes, whatever the number of blocks
_DIVERGED = 1e7  # residual at which Newton's method has diverged
#: Fractions of the strength reduction factor at which the search starts, with more strength than at the factor.
_START_FRACTIONS = (1.0, 0.6, 0.3, 0.1, 0.03)
_OPEN_SPRING = (
    1e-9  # stiffness of open pairs during the search, as a fraction of the normal stiffness
)
_RELEASE_FRACTION = (
    0.5  # bonds with more than this fraction of the largest excess tension break together
)
#: Where more pairs than this are in excess tension, at least this quantile of them break together.
_MANY_PAIRS, _RELEASE_QUANTILE = 100, 0.25
_MIN_STRIDE = 1e-5  # stride of ln F below which the search for a higher factor ends


@dataclass(frozen=True)
class Rest:
    """Elastic blocks at rest, or the best state of a search that found no equilibrium.

    Attributes
    ----------
    factor : strength reduction factor
    relative : (n, 3) m, relative displacements of the node pairs
    motion : (N,), rigid motion of the blocks
    bent : (k,) m, displacements of the blocks' nodes relative to that motion
    forces : (3n,) kN
    modes : (n,) ContactMode
    parted : (n,) pairs whose bond is broken; memory : (n, 2) m, slip at which it broke
    residual : as a fraction of the load
    steps : of Newton's method, in all
    """

    factor: float
    relative: Floats
    motion: Floats
    bent: Floats
    forces: Floats
    modes: Ints
    parted: Bools
    memory: Floats
    residual: float
    steps: int

    @property
    def is_balanced(self) -> bool:
        """Whether the state is an equilibrium: its residual does not exceed `BALANCED`."""
        return self.residual <= BALANCED

    def opened(self, model: ElasticModel) -> Bools:
        """Return the pairs (n,) whose bond is broken and, of those without a bond, the open ones."""
        return np.where(model.unbonded, self.modes == ContactMode.DEBOND, self.parted)

    @property
    def failed_pairs(self) -> int:
        """Number of node pairs that slip or are open."""
        return int((self.modes != ContactMode.STICK).sum())


class _RestState(NamedTuple):
    """A trial state of the search: its residual (k,) kN, the norm of that, and the tractions by the contact law."""

    size: float
    rest: Rest
    residual: Floats
    law: Tractions


class _Dashpots(NamedTuple):
    """Control of the dashpot at all node pairs, as fractions of the normal stiffness.

    Attributes
    ----------
    decay : largest ratio of a dashpot to that of the step before, where the residual fell
    least, most : bounds of the dashpot
    switch_residual : residual below which there is no dashpot at all pairs
    """

    decay: float
    least: float
    most: float
    switch_residual: float


_HEAVY = _Dashpots(1.0, 0.01 * _DASHPOT, 10.0 * _DASHPOT, _NEAR_REST)
_LIGHT = _Dashpots(0.5, 1e-4 * _DASHPOT, 10.0 * _DASHPOT, _NEAR_REST)
_LIGHT_AT_ALL_PAIRS = _LIGHT._replace(switch_residual=0.0)


class RestSearch:
    """A search for the equilibrium of an elastic model, at one strength reduction factor after the other."""

    def __init__(self, model: ElasticModel, stiffness: JointStiffness) -> None:
        self.model = model
        self.stiffness = replace(stiffness, debonded=_OPEN_SPRING * stiffness.normal)
        self.rest_stiffness = replace(stiffness, debonded=0.0)
        self.steps, self.max_steps = 0, int(min(_MAX_STEPS, _MAX_WORK / model.rows.shape[0]))
        self.releases = _MAX_RELEASES
        self.equations = Condensed(model)
        self.rounding = 1e-9 * self.equations.weight / float(model.area.sum())
        self.first = self._linear()

    @property
    def spent(self) -> bool:
        """Whether the search has used up its steps of Newton's method."""
        return self.steps > self.max_steps

    def _linear(self) -> Displacements:
        """Return the displacements of the linear model, whose node pairs neither slip nor open."""
        model, law = self.model, self.stiffness.tangential
        shear = law if isinstance(law, float | int) else law.modulus_number * law.water_unit_weight
        slopes = np.tile(-np.diag([self.stiffness.normal, shear, shear]), (len(model.area), 1, 1))
        residual = self.equations.residual(
            np.zeros(self.equations.bent), np.zeros(model.rows.shape[0]), model.load
        )
        return self._solve_step(slopes, residual, np.zeros(len(model.bolt_capacity)))

    def rest(self, factor: float) -> Rest:
        """Return the equilibrium at a factor, or the best state of the search where it finds none."""
        n, size, unbonded = len(self.model.area), self.model.rows.shape[0], self.model.unbonded
        start = Rest(
            factor,
            self.first[0].reshape(-1, 3),
            *self.first[1:],
            np.zeros(size),
            np.zeros(n, dtype=np.int64),
            unbonded,
            np.zeros((n, 2)),
            math.inf,
            0,
        )
        state = start
        for fraction in _START_FRACTIONS:
            state = self.equilibrium(start, fraction * factor)
            if state.is_balanced:
                break
        if not state.is_balanced or state.factor == factor:
            return replace(state, steps=self.steps)
        continued = self.continued(state, factor)
        return replace(
            continued or replace(state, factor=factor, residual=math.inf), steps=self.steps
        )

    def continued(self, rest: Rest, factor: float) -> Rest | None:
        """Return the equilibrium at a higher factor, followed from one at a lower; None where the search ends below."""
        stride = math.log(factor / rest.factor)
        while rest.factor < factor:
            remaining = math.log(factor / rest.factor)
            trial = self.equilibrium(
                rest, factor if stride >= remaining else rest.factor * math.exp(stride)
            )
            if trial.is_balanced:
                rest, stride = trial, 2.0 * stride
            else:
                stride = min(stride, remaining) / 3.0
                if stride < _MIN_STRIDE:
                    return None
        return rest

    # -- one factor ---------------------------------------------------------------------------------------------------

    def equilibrium(self, start: Rest, factor: float) -> Rest:
        """Return the equilibrium at a factor from a start: Newton's method, repeated while bonds break (Table 2)."""
        state = replace(start, factor=factor, residual=math.inf)
        tension = self.model.tension
        for _ in range(self.releases):
            if self.spent:  # no equilibrium: more bonds might break
                return replace(state, residual=math.inf)
            state, law = self._newton(state)
            broken = ~state.parted & breaks(law, tension, factor, self.rounding)
            if not state.is_balanced or not broken.any():
                break
            excess_tension = law.tractions[:, 0] + tension / factor
            bound = _RELEASE_FRACTION * float(excess_tension[broken].min())
            if int(broken.sum()) > _MANY_PAIRS:
                bound = max(bound, float(np.quantile(excess_tension[broken], _RELEASE_QUANTILE)))
            new = broken & (excess_tension < bound)
            memory = state.memory.copy()
            memory[new] = state.relative[new, 1:]
            state = replace(state, parted=state.parted | new, memory=memory)
        else:  # bonds would still break
            return replace(state, residual=math.inf)
        if (
            state.is_balanced and (state.modes == ContactMode.DEBOND).any()
        ):  # what topples hangs on springs of open pairs
            return self._newton(state, self.rest_stiffness)[0]
        return state

    def _state(self, rest: Rest, stiffness: JointStiffness) -> "_RestState":
        """Return the trial state of some displacements, with its residual and its tractions."""
        model = self.model
        relative = rest.relative.copy()
        relative[:, 1:] -= rest.memory
        law = tractions(
            relative,
            stiffness,
            model.cohesion,
            model.tan_friction,
            model.tan_dilation,
            rest.factor,
            rest.parted,
        )
        forces = (law.tractions * model.area[:, None]).ravel()
        loads = model.load + model.pulls(rest.motion, rest.factor)[0] @ model.bolt_rows
        residual = self.equations.residual(rest.bent, forces, loads)
        return _RestState(self.equations.size(residual), rest, residual, law)

    def _newton(
        self, rest: Rest, stiffness: JointStiffness | None = None
    ) -> tuple[Rest, Tractions]:
        joint_stiffness = stiffness or self.stiffness
        state = self._state(rest, joint_stiffness)
        best = self._full_steps(state, joint_stiffness)
        if best.size > BALANCED:
            best = self._damped_rounds(state, joint_stiffness)
        forces = (best.law.tractions * self.model.area[:, None]).ravel()
        return replace(best.rest, forces=forces, modes=best.law.modes, residual=best.size), best.law

    def _full_steps(self, state: "_RestState", joint_stiffness: JointStiffness) -> "_RestState":
        """Return the best state of full Newton steps, made even where the residual rises.

        They end early where the residual has not fallen enough after a few.
        """
        best, first = state, state.size
        for k in range(_FULL_STEPS):
            if state.size <= _NEWTON_TOLERANCE or not state.size < _DIVERGED:
                break
            if k >= _TRIAL_STEPS and best.size > _REQUIRED_RATIO * first:
                break
            state = self._state(self._displaced(state.rest, self._step(state)), joint_stiffness)
            best = min(best, state, key=lambda candidate: candidate.size)
        return best

    def _damped_rounds(self, state: "_RestState", joint_stiffness: JointStiffness) -> "_RestState":
        """Return the best state of Newton steps against dashpots, in rounds; slip is kept from round to round.

        The dashpots act at all pairs first and get weaker as the residual falls; then only at pairs that change
        between stick, slip and open. They do no work at rest. Where the residual only creeps down, dashpots are too
        strong: in the last rounds they are halved with each step that lowers it.
        """
        least, first, best = math.inf, state, state
        for k in range(_ROUNDS):
            previous, (state, best, _) = (
                state,
                self._damped_round(state, joint_stiffness, _DASHPOT, _HEAVY),
            )
            least = min(least, best.size)
            if (
                best.size <= BALANCED
                or self.spent
                or (k >= _ROUNDS // 2 and least > _FLOW_RESIDUAL)
            ):
                break
            state = self._state(
                self._reset_slip_memory(state if best is previous else best, joint_stiffness),
                joint_stiffness,
            )
        if best.size <= BALANCED:
            return best
        return self._lighter_rounds(
            best, joint_stiffness, _FLOW_DISTANCE * np.abs(first.rest.relative).max()
        )

    def _lighter_rounds(
        self, best: "_RestState", joint_stiffness: JointStiffness, flow_distance: float
    ) -> "_RestState":
        """Return the best state of rounds with lighter dashpots.

        They end without progress, or where a pair has moved farther than `flow_distance` (m): the blocks flow.
        """
        uniform_dashpot, idle = _DASHPOT, 0
        for _ in range(_LIGHT_ROUNDS):
            if (
                self.spent
                or idle == _MAX_IDLE_ROUNDS
                or np.abs(best.rest.relative).max() > flow_distance
            ):
                break
            bounds = _LIGHT if not idle else _LIGHT_AT_ALL_PAIRS
            previous, (_, best, uniform_dashpot) = (
                best,
                self._damped_round(
                    best, joint_stiffness, uniform_dashpot if not idle else _DASHPOT, bounds
                ),
            )
            if best.size <= BALANCED:
                break
            idle = idle + 1 if best is previous else 0
            best = self._state(self._reset_slip_memory(best, joint_stiffness), joint_stiffness)
        return best

    def _damped_round(
        self,
        state: "_RestState",
        joint_stiffness: JointStiffness,
        uniform_dashpot: float,
        bounds: "_Dashpots",
    ) -> tuple["_RestState", "_RestState", float]:
        """Return the last and the best state of one round of steps against dashpots, and the dashpot of all pairs."""
        best, dashpots = state, np.zeros(len(self.model.area))
        for _ in range(_ROUND_STEPS):
            if best.size <= _NEWTON_TOLERANCE or not state.size < _DIVERGED or self.spent:
                break
            applied = np.maximum(
                dashpots, uniform_dashpot if state.size > bounds.switch_residual else 0.0
            )
            trial = self._state(
                self._displaced(state.rest, self._step(state, applied)), joint_stiffness
            )
            changed = trial.law.modes != state.law.modes
            dashpots = np.where(
                changed, np.clip(2.0 * dashpots, 3.0 * _DASHPOT, 100.0 * _DASHPOT), 0.3 * dashpots
            )
            dashpots[dashpots < 0.1 * _DASHPOT] = 0.0
            ratio = trial.size / state.size
            uniform_dashpot *= min(ratio, bounds.decay) if ratio < 1.0 else 4.0
            uniform_dashpot = min(max(uniform_dashpot, bounds.least), bounds.most)
            state = trial
            best = min(best, state, key=lambda candidate: candidate.size)
        return state, best, uniform_dashpot

    def _reset_slip_memory(self, state: "_RestState", joint_stiffness: JointStiffness) -> Rest:
        """Return the state with the elastic shear of slipping pairs reset to their strength, of open pairs to none."""
        rest, law, shear = state.rest, state.law, joint_stiffness.tangential
        memory, slips = rest.memory.copy(), law.modes == ContactMode.SLIP
        if isinstance(shear, CloughDuncan) or self.model.tan_dilation.any():
            return rest
        memory[slips] = rest.relative[slips, 1:] + law.tractions[slips, 1:] / shear
        open_ = law.modes == ContactMode.DEBOND
        memory[open_] = rest.relative[open_, 1:]
        return replace(rest, memory=memory)

    def _displaced(self, rest: Rest, step: Displacements) -> Rest:
        values = rest.relative.ravel(), rest.motion, rest.bent
        relative, motion, bent = (
            value + change for value, change in zip(values, step, strict=True)
        )
        relative, motion, bent = self.equations.compatible((relative, motion, bent))
        return replace(rest, relative=relative.reshape(-1, 3), motion=motion, bent=bent)

    def _step(self, state: "_RestState", dashpots: Floats | None = None) -> Displacements:
        """Return the Newton step of a state.

        dashpots : (n,) at the node pairs, as fractions of the normal stiffness
        """
        slopes = state.law.slopes
        if dashpots is not None:
            slopes = slopes - (self.stiffness.normal * dashpots)[:, None, None] * np.eye(3)
        return self._solve_step(
            slopes, state.residual, self.model.pulls(state.rest.motion, state.rest.factor)[1]
        )

    def _solve_step(self, slopes: Floats, residual: Floats, springs: Floats) -> Displacements:
        self.steps += 1
        return self.equations.step(slopes * self.model.area[:, None, None], residual, springs)
