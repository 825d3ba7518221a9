"""Elastic blocks at rest at a strength reduction factor.

Newton's method on (γ, w). Full steps first, even where the residual rises; against dashpots only after. Pairs
that have parted keep in mind where: else they would go round between open and closed. Open pairs have soft springs on
the way, which lead blocks in flight back; a rest is one without them, so nothing hangs on what is open.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.elastic.condensed import Condensed, ElasticModel, Place
from slopekit.preie.system.contact import CloughDuncan, ContactMode, JointStiffness, Tractions, breaks, tractions

BALANCED = 1e-8  # residual, in parts of the load and of the first displacement, that counts as rest
_AIM = 1e-10  # where Newton's method stops
_FULL = 12  # steps of Newton's method
_LOOK, _FALLEN = 4, 0.5  # full steps after which the residual is looked at, and what it has to be then
_ROUNDS, _ROUND = 12, 16  # of steps against dashpots, and in each
_FLOWS = 5e-4  # residual that is left after half of the rounds where blocks do not rest: no more are made
_DASHPOT = 0.1  # of the normal stiffness
_LIGHT_ROUNDS = 10  # of them, after those, against dashpots that are soon lighter
_IDLE = 2  # of those rounds, one after the other, that bring nothing: no more are made
_FAR = 1e3  # times as far as at the start: blocks flow, and lighter dashpots are no help
_NEARLY = 3e-3  # residual at which dashpots at all pairs are no help any more
_RELEASES = 120  # rounds of pairs that part
_MOST_STEPS = 600  # of Newton's method, to a state at rest
_WORK = 1.2e7  # steps times rows: two minutes, whatever the number of blocks
_LOST = 1e7  # a residual that has nothing to do with the answer any more
_FIRST = (1.0, 0.6, 0.3, 0.1, 0.03)  # of the factor: where to begin, with more strength than asked for
_HARDLY = 1e-9  # of the normal stiffness: springs of open pairs on the way to rest
_LET_GO = 0.5  # pairs in more than this part of the worst tension part together
_CROWD, _WORST = 100, 0.25  # where more pairs than that are in tension, so many of them part at least
_SHORTEST = 1e-5  # stride of ln F, at which there is no rest farther on


@dataclass(frozen=True)
class Rest:
    """Blocks at rest, or the last that Newton's method saw of them.

    Attributes
    ----------
    factor : strength reduction factor
    relative : (n, 3) m of the pairs; motion : (N,) of the blocks; bent : (k,) m of the nodes of the bodies beside
        it; forces : (3n,) kN
    modes : (n,) ContactMode; parted : (n,) pairs whose bond is gone; memory : (n, 2) slip at which they parted
    residual : in parts of the load and of the first displacement; steps : of Newton's method, to get there
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
    def stands(self) -> bool:
        """Whether forces and displacements agree."""
        return self.residual <= BALANCED

    def opened(self, model: ElasticModel) -> Bools:
        """Pairs (n,) whose bond is gone, and of those that never had one those that are open."""
        return np.where(model.unbonded, self.modes == ContactMode.DEBOND, self.parted)

    @property
    def failed_pairs(self) -> int:
        """Pairs that slip or are open."""
        return int((self.modes != ContactMode.STICK).sum())


class _RestState(NamedTuple):
    """Blocks somewhere on the way to rest: what is off there, its size, and the law."""

    size: float
    at: Rest
    off: Floats
    law: Tractions


class _Dashpots(NamedTuple):
    """Of all pairs, in parts of the normal stiffness: what a step that brings the residual down leaves of them at most,
    their ends, and the residual at which they are left out."""

    falling: float
    least: float
    most: float
    nearly: float


_HEAVY = _Dashpots(1.0, 0.01 * _DASHPOT, 10.0 * _DASHPOT, _NEARLY)
_LIGHT = _Dashpots(0.5, 1e-4 * _DASHPOT, 10.0 * _DASHPOT, _NEARLY)
_EVERYWHERE = _LIGHT._replace(nearly=0.0)


class RestSearch:
    """Rest at one factor after the other."""

    def __init__(self, model: ElasticModel, stiffness: JointStiffness) -> None:
        self.model = model
        self.stiffness = replace(stiffness, debonded=_HARDLY * stiffness.normal)
        self.bare = replace(stiffness, debonded=0.0)
        self.steps, self.most = 0, int(min(_MOST_STEPS, _WORK / model.rows.shape[0]))
        self.releases = _RELEASES
        self.equations = Condensed(model)
        self.rounding = 1e-9 * self.equations.weight / float(model.area.sum())
        self.first = self._linear()

    @property
    def spent(self) -> bool:
        """Whether the steps of Newton's method that it may take are taken."""
        return self.steps > self.most

    def _linear(self) -> Place:
        """Where springs at the pairs that neither slip nor part bring the blocks."""
        model, law = self.model, self.stiffness.tangential
        shear = law if isinstance(law, float | int) else law.modulus_number * law.water_unit_weight
        slopes = np.tile(-np.diag([self.stiffness.normal, shear, shear]), (len(model.area), 1, 1))
        off = self.equations.off(np.zeros(self.equations.bent), np.zeros(model.rows.shape[0]), model.load)
        return self._solved(slopes, off, np.zeros(len(model.bolt_capacity)))

    def rest(self, factor: float) -> Rest:
        """Rest at a factor; where there is none the last that was seen."""
        n, size, unbonded = len(self.model.area), self.model.rows.shape[0], self.model.unbonded
        fresh = Rest(
            factor, self.first[0].reshape(-1, 3), *self.first[1:], np.zeros(size), np.zeros(n, dtype=np.int64),
            unbonded, np.zeros((n, 2)), math.inf, 0,
        )  # fmt: skip
        state = fresh
        for part in _FIRST:
            state = self.settled(fresh, part * factor)
            if state.stands:
                break
        if not state.stands or state.factor == factor:
            return replace(state, steps=self.steps)
        onward = self.onward(state, factor)
        return replace(onward or replace(state, factor=factor, residual=math.inf), steps=self.steps)

    def onward(self, here: Rest, factor: float) -> Rest | None:
        """Rest at a higher factor, from a state at rest; None where no step leads on."""
        stride = math.log(factor / here.factor)
        while here.factor < factor:
            left = math.log(factor / here.factor)
            trial = self.settled(here, factor if stride >= left else here.factor * math.exp(stride))
            if trial.stands:
                here, stride = trial, 2.0 * stride
            else:
                stride = min(stride, left) / 3.0
                if stride < _SHORTEST:
                    return None
        return here

    # -- one factor ---------------------------------------------------------------------------------------------------

    def settled(self, here: Rest, factor: float) -> Rest:
        """Newton's method until forces balance, again while pairs part (Table 2); a bond once broken stays so."""
        state = replace(here, factor=factor, residual=math.inf)
        tension = self.model.tension
        for _ in range(self.releases):
            if self.spent:  # no rest: pairs might still part
                return replace(state, residual=math.inf)
            state, law = self._newton(state)
            broken = ~state.parted & breaks(law, tension, factor, self.rounding)
            if not state.stands or not broken.any():
                break
            pulled = law.tractions[:, 0] + tension / factor
            bound = _LET_GO * float(pulled[broken].min())
            if int(broken.sum()) > _CROWD:
                bound = max(bound, float(np.quantile(pulled[broken], _WORST)))
            new = broken & (pulled < bound)
            memory = state.memory.copy()
            memory[new] = state.relative[new, 1:]
            state = replace(state, parted=state.parted | new, memory=memory)
        else:  # pairs are in tension still
            return replace(state, residual=math.inf)
        if state.stands and (state.modes == ContactMode.DEBOND).any():  # what topples hangs on springs of open pairs
            return self._newton(state, self.bare)[0]
        return state

    def _state(self, at: Rest, stiffness: JointStiffness) -> "_RestState":
        """What is off of displacements and of balance, the law there, and the size of it."""
        model = self.model
        relative = at.relative.copy()
        relative[:, 1:] -= at.memory
        law = tractions(
            relative, stiffness, model.cohesion, model.tan_friction, model.tan_dilation, at.factor, at.parted
        )
        forces = (law.tractions * model.area[:, None]).ravel()
        loads = model.load + model.pulls(at.motion, at.factor)[0] @ model.bolt_rows
        off = self.equations.off(at.bent, forces, loads)
        return _RestState(self.equations.size(off), at, off, law)

    def _newton(self, at: Rest, stiffness: JointStiffness | None = None) -> tuple[Rest, Tractions]:
        given = stiffness or self.stiffness
        here = self._state(at, given)
        best = self._full(here, given)
        if best.size > BALANCED:
            best = self._relaxed(here, given)
        forces = (best.law.tractions * self.model.area[:, None]).ravel()
        return replace(best.at, forces=forces, modes=best.law.modes, residual=best.size), best.law

    def _full(self, here: "_RestState", given: JointStiffness) -> "_RestState":
        """Full steps, even where the residual rises; no more where it has not fallen after a few."""
        best, first = here, here.size
        for k in range(_FULL):
            if here.size <= _AIM or not here.size < _LOST:
                break
            if k >= _LOOK and best.size > _FALLEN * first:
                break
            here = self._state(self._moved(here.at, self._step(here)), given)
            best = min(best, here, key=lambda one: one.size)
        return best

    def _relaxed(self, here: "_RestState", given: JointStiffness) -> "_RestState":
        """Steps against dashpots at the pairs, in rounds; between them what has slipped stays where it is.

        First at all pairs, fewer as the residual falls, then at those that change between stick, slip and open alone:
        elsewhere the steps are full ones. The dashpots do no work at rest. Where the residual creeps down, step by step
        a little, they are stronger than they need be: at last they are halved with each step that brings it down.
        """
        least, first, best = math.inf, here, here
        for k in range(_ROUNDS):
            began, (here, best, _) = here, self._round(here, given, _DASHPOT, _HEAVY)
            least = min(least, best.size)
            if best.size <= BALANCED or self.spent or (k >= _ROUNDS // 2 and least > _FLOWS):
                break
            here = self._state(self._slipped(here if best is began else best, given), given)
        if best.size <= BALANCED:
            return best
        return self._lightened(best, given, _FAR * np.abs(first.at.relative).max())

    def _lightened(self, best: "_RestState", given: JointStiffness, far: float) -> "_RestState":
        """More rounds, as long as they bring something and nothing has gone farther than `far`, which flows."""
        every, idle = _DASHPOT, 0
        for _ in range(_LIGHT_ROUNDS):
            if self.spent or idle == _IDLE or np.abs(best.at.relative).max() > far:
                break
            bounds = _LIGHT if not idle else _EVERYWHERE
            began, (_, best, every) = best, self._round(best, given, every if not idle else _DASHPOT, bounds)
            if best.size <= BALANCED:
                break
            idle = idle + 1 if best is began else 0
            best = self._state(self._slipped(best, given), given)
        return best

    def _round(
        self, here: "_RestState", given: JointStiffness, every: float, bounds: "_Dashpots"
    ) -> tuple["_RestState", "_RestState", float]:
        """Some steps against dashpots: the last state, the best, and the dashpots of all pairs at the end."""
        best, dashpots = here, np.zeros(len(self.model.area))
        for _ in range(_ROUND):
            if best.size <= _AIM or not here.size < _LOST or self.spent:
                break
            braked = np.maximum(dashpots, every if here.size > bounds.nearly else 0.0)
            trial = self._state(self._moved(here.at, self._step(here, braked)), given)
            changed = trial.law.modes != here.law.modes
            dashpots = np.where(changed, np.clip(2.0 * dashpots, 3.0 * _DASHPOT, 100.0 * _DASHPOT), 0.3 * dashpots)
            dashpots[dashpots < 0.1 * _DASHPOT] = 0.0
            ratio = trial.size / here.size
            every *= min(ratio, bounds.falling) if ratio < 1.0 else 4.0
            every = min(max(every, bounds.least), bounds.most)
            here = trial
            best = min(best, here, key=lambda one: one.size)
        return here, best, every

    def _slipped(self, here: "_RestState", given: JointStiffness) -> Rest:
        """What slips has no more elastic shear than its strength, what is open none."""
        at, law, shear = here.at, here.law, given.tangential
        memory, slips = at.memory.copy(), law.modes == ContactMode.SLIP
        if isinstance(shear, CloughDuncan) or self.model.tan_dilation.any():
            return at
        memory[slips] = at.relative[slips, 1:] + law.tractions[slips, 1:] / shear
        open_ = law.modes == ContactMode.DEBOND
        memory[open_] = at.relative[open_, 1:]
        return replace(at, memory=memory)

    def _moved(self, at: Rest, step: Place) -> Rest:
        old = at.relative.ravel(), at.motion, at.bent
        relative, motion, bent = (own + by for own, by in zip(old, step, strict=True))
        relative, motion, bent = self.equations.fitting((relative, motion, bent))
        return replace(at, relative=relative.reshape(-1, 3), motion=motion, bent=bent)

    def _step(self, here: "_RestState", dashpots: Floats | None = None) -> Place:
        """The changes that take away what is off; dashpots (n,) at the pairs, in parts of the normal stiffness."""
        slopes = here.law.slopes
        if dashpots is not None:
            slopes = slopes - (self.stiffness.normal * dashpots)[:, None, None] * np.eye(3)
        return self._solved(slopes, here.off, self.model.pulls(here.at.motion, here.at.factor)[1])

    def _solved(self, slopes: Floats, off: Floats, springs: Floats) -> Place:
        self.steps += 1
        return self.equations.step(slopes * self.model.area[:, None, None], off, springs)
