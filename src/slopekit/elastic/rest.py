"""Elastic blocks at rest at a strength reduction factor, and the bracket where they no longer come to rest.

Newton's method on (d, γ), d eliminated. Full steps first, even where the residual rises; damped ones only after. Pairs
that have parted keep in mind where: else they would go round between open and closed. Open pairs have soft springs on
the way, which lead blocks in flight back; a rest is one without them, so nothing hangs on what is open.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass
from slopekit.elastic.condensed import Condensed
from slopekit.elastic.model import ElasticModel
from slopekit.preie.contact import ContactMode, JointStiffness, Tractions, breaks, tractions

BALANCED = 1e-8  # residual, in parts of the load and of the first displacement, that counts as rest
_AIM = 1e-10  # where Newton's method stops
_FULL, _DAMPED = 12, 40  # steps of Newton's method
_RELEASES = 60  # rounds, of many blocks _MORE times as many, of pairs that part
_MOST_STEPS, _MOST_OF_BRACKET = 300, 3000  # of Newton's method, to a state at rest and to the ends of a bracket
_MORE = 2  # times as many steps for many blocks, of which more part one after the other
_WORK, _WORK_OF_BRACKET = 1.2e7, 3e7  # steps times rows: two minutes, and five, whatever the number of blocks
_LOST = 1e7  # a residual that has nothing to do with the answer any more
_FIRST = (1.0, 0.6, 0.3, 0.1, 0.03)  # of the factor: where to begin, with more strength than asked for
_HARDLY = 1e-9  # of the normal stiffness: springs of open pairs on the way to rest
_LET_GO = 0.5  # pairs in more than this part of the worst tension part together
_SHORTEST = 1e-5  # stride of ln F, at which there is no rest farther on


@dataclass(frozen=True, slots=True)
class Rest:
    """Blocks at rest, or the last that Newton's method saw of them.

    Attributes
    ----------
    factor : strength reduction factor
    relative : (n, 3) m of the pairs; motion : (N,) of the blocks; forces : (3n,) kN
    modes : (n,) ContactMode; parted : (n,) pairs whose bond is gone; memory : (n, 2) slip at which they parted
    residual : in parts of the load and of the first displacement; steps : of Newton's method, to get there
    """

    factor: float
    relative: Floats
    motion: Floats
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

    @property
    def failed_pairs(self) -> int:
        """Pairs that slip or are open."""
        return int((self.modes != ContactMode.STICK).sum())


class Search:
    """Rest at one factor after the other."""

    def __init__(self, model: ElasticModel, stiffness: JointStiffness) -> None:
        self.model = model
        self.stiffness = replace(stiffness, debonded=_HARDLY * stiffness.normal)
        self.bare = replace(stiffness, debonded=0.0)
        self.weight = float(np.sqrt(model.load @ model.load)) + float(model.bolt_capacity.sum())
        self.rounding = 1e-9 * self.weight / float(model.area.sum())
        self.steps, self.most = 0, _MOST_STEPS
        self.releases = _RELEASES
        if not model.is_dense:
            self.most = int(min(_MORE * _MOST_STEPS, _WORK / model.rows.shape[0]))
            self.releases *= _MORE
        self.condensed: Condensed | None = None
        self.start, self.first = self._linear()
        self.unit = math.sqrt(float(self.first @ self.first) / len(self.first)) or 1.0

    @property
    def spent(self) -> bool:
        """Whether the steps of Newton's method that it may take are taken."""
        return self.steps > self.most

    def _linear(self) -> tuple[Floats, Floats]:
        """Motion and relative displacements with springs at the pairs that neither slip nor part."""
        model, law = self.model, self.stiffness.tangential
        shear = law if isinstance(law, float | int) else law.modulus_number * law.water_unit_weight
        k = np.tile([self.stiffness.normal, shear, shear], len(model.area)) * np.repeat(model.area, 3)
        slopes = np.zeros((len(model.area), 3, 3))
        slopes[:, [0, 1, 2], [0, 1, 2]] = -k.reshape(-1, 3)
        off = -self._given(model.load)
        relative, motion = self._step(slopes, off, model.load, np.zeros(len(model.bolt_capacity)))
        return motion, relative

    def _given(self, loads: Floats) -> Floats:
        """What the loads alone do to the pairs of elastic blocks."""
        if self.model.give_load is None:
            return np.zeros(self.model.rows.shape[0])
        found: Floats = self.model.give_load @ loads
        return found

    def rest(self, factor: float) -> Rest:
        """Rest at a factor; where there is none the last that was seen."""
        n, size = len(self.model.area), self.model.rows.shape[0]
        fresh = Rest(
            factor, self.first.reshape(-1, 3), self.start, np.zeros(size), np.zeros(n, dtype=np.int64),
            np.zeros(n, dtype=bool), np.zeros((n, 2)), math.inf, 0,
        )  # fmt: skip
        found = fresh
        for part in _FIRST:
            found = self.settled(fresh, part * factor)
            if found.stands:
                break
        if not found.stands or found.factor == factor:
            return replace(found, steps=self.steps)
        onward = self.onward(found, factor)
        return replace(onward or replace(found, factor=factor, residual=math.inf), steps=self.steps)

    def onward(self, here: Rest, factor: float, shortest: float = _SHORTEST) -> Rest | None:
        """Rest at a higher factor, from a state at rest; None where no step leads on."""
        stride = math.log(factor / here.factor)
        while here.factor < factor:
            left = math.log(factor / here.factor)
            target = factor if stride >= left else here.factor * math.exp(stride)
            trial = self.settled(here, target)
            if trial.stands:
                here, stride = trial, 2.0 * stride
            else:
                stride = min(stride, left) / 3.0
                if stride < shortest:
                    return None
        return here

    def bracket(self, here: Rest, guess: float, within: float = 1e-4) -> tuple[Rest, float, bool]:
        """The last state at rest, a factor not farther on than `within` at which there is none, and if it gave up.

        Where the steps that are allowed do not suffice it gave up: the factor is one that was not decided then.
        """
        low, high = here, math.inf
        self.most = self.steps + int(min(_MOST_OF_BRACKET, _WORK_OF_BRACKET / self.model.rows.shape[0]))
        target = max(guess * (1.0 - 5.0 * within), here.factor * (1.0 + within))
        while not math.isfinite(high) or high - low.factor > within * low.factor:
            found = self.onward(low, target, within / 3.0)
            if found is None and self.spent:
                return low, target, True
            if found is None:
                high = target
            else:
                low = found
            if math.isfinite(high):
                target = 0.5 * (low.factor + high)
            else:
                far = 1e-3 if low.factor < guess * 1.01 else 0.05
                target = max(guess * (1.0 + 5.0 * within), low.factor * (1.0 + far))
        return low, high, False

    # -- one factor ---------------------------------------------------------------------------------------------------

    def settled(self, here: Rest, factor: float) -> Rest:
        """Newton's method until forces balance, again while pairs part (Table 2); a bond once broken stays so."""
        found = replace(here, factor=factor, residual=math.inf)
        tension = self.model.tension
        for _ in range(self.releases):
            if self.spent:  # no rest: pairs might still part
                return replace(found, residual=math.inf)
            found, law = self._newton(found)
            if not found.stands and found.parted.any():  # what has parted slides on from where it is
                memory = found.memory.copy()
                memory[found.parted] = found.relative[found.parted, 1:]
                found, law = self._newton(replace(found, memory=memory))
            broken = ~found.parted & breaks(law, tension, factor, self.rounding)
            if not found.stands or not broken.any():
                break
            pulled = law.tractions[:, 0] + tension / factor
            new = broken & (pulled < _LET_GO * float(pulled[broken].min()))
            memory = found.memory.copy()
            memory[new] = found.relative[new, 1:]
            found = replace(found, parted=found.parted | new, memory=memory)
        else:  # pairs are in tension still
            return replace(found, residual=math.inf)
        if found.stands and (found.modes == ContactMode.DEBOND).any():  # what topples hangs on springs of open pairs
            return self._newton(found, self.bare)[0]
        return found

    def _state(self, at: Rest, stiffness: JointStiffness) -> tuple[Floats, Floats, Tractions, float]:
        """What is off of displacements (3n,) and of balance (N,), the law there, and the size of both."""
        model = self.model
        relative = at.relative.copy()
        relative[:, 1:] -= at.memory
        law = tractions(
            relative, stiffness, model.cohesion, model.tan_friction, model.tan_dilation, at.factor, at.parted
        )
        forces = (law.tractions * model.area[:, None]).ravel()
        loads = model.load
        if len(model.bolt_capacity):
            loads = loads + model.pulls(at.motion, at.factor)[0] @ model.bolt_rows
        off = at.relative.ravel() - model.rows @ at.motion
        if model.give is not None:
            off = off - model.give @ forces - model.give_load @ loads
        balance = model.rows.T @ forces + loads
        size = math.hypot(
            math.sqrt(float(off @ off) / len(off)) / self.unit, math.sqrt(float(balance @ balance)) / self.weight
        )
        return off, balance, law, size

    def _newton(self, at: Rest, stiffness: JointStiffness | None = None) -> tuple[Rest, Tractions]:
        given = stiffness or self.stiffness
        off, balance, law, size = self._state(at, given)
        best = (size, at, law)
        for damped, most in ((False, _FULL), (True, _DAMPED)):
            if damped and best[0] > _AIM:
                at = best[1]
                off, balance, law, size = self._state(at, given)
            for _ in range(most):
                if size <= _AIM or not size < _LOST:
                    break
                slopes = law.slopes * self.model.area[:, None, None]
                springs = self.model.pulls(at.motion, at.factor)[1]
                by_relative, by_motion = self._step(slopes, off, balance, springs)
                length = 1.0
                while True:
                    trial = replace(
                        at, relative=at.relative + length * by_relative.reshape(-1, 3),
                        motion=at.motion + length * by_motion,
                    )  # fmt: skip
                    new = self._state(trial, given)
                    if not damped or new[3] < size * (1.0 - 0.1 * length) or length < 1e-3:
                        break
                    length *= 0.5
                if damped and length < 1e-3:
                    break
                at, (off, balance, law, size) = trial, new
                if size < best[0]:
                    best = (size, at, law)
            if best[0] <= BALANCED:
                break
        size, at, law = best
        forces = (law.tractions * self.model.area[:, None]).ravel()
        return replace(at, forces=forces, modes=law.modes, residual=size), law

    def _step(self, slopes: Floats, off: Floats, balance: Floats, springs: Floats) -> tuple[Floats, Floats]:
        """The changes of d and γ that take away what is off."""
        self.steps += 1
        return (self._dense_step if self.model.is_dense else self._sparse_step)(slopes, off, balance, springs)

    def _dense_step(self, slopes: Floats, off: Floats, balance: Floats, springs: Floats) -> tuple[Floats, Floats]:
        model = self.model
        size, rows = len(off), model.rows
        by_motion = rows
        bolts = -(model.bolt_rows.T * springs) @ model.bolt_rows  # dq/dγ
        if model.give is not None:
            matrix = -np.matmul(
                np.ascontiguousarray(model.give.reshape(size, -1, 3).transpose(1, 0, 2)), slopes
            ).transpose(1, 0, 2).reshape(size, size)  # fmt: skip
            matrix[np.arange(size), np.arange(size)] += 1.0
            by_motion = rows + model.give_load @ bolts if len(springs) else rows
            right = np.concatenate([by_motion, -off[:, None]], axis=1)
            solved = lu_solve(
                lu_factor(matrix, check_finite=False, overwrite_a=True), right, check_finite=False
            )  # fmt: skip
        else:
            solved = np.concatenate([by_motion, -off[:, None]], axis=1)
        stiff = (rows.reshape(-1, 3, rows.shape[1]).transpose(0, 2, 1) @ slopes).transpose(1, 0, 2).reshape(
            rows.shape[1], size
        )  # fmt: skip
        small = stiff @ solved[:, :-1] + bolts
        motion = _solved(small, -balance - stiff @ solved[:, -1])
        return solved[:, -1] + solved[:, :-1] @ motion, motion

    def _sparse_step(self, slopes: Floats, off: Floats, balance: Floats, springs: Floats) -> tuple[Floats, Floats]:
        model, size = self.model, len(off)
        law = sparse.bsr_matrix(
            (slopes, np.arange(len(slopes)), np.arange(len(slopes) + 1)), shape=(size, size)
        ).tocsr()  # fmt: skip
        self.condensed = self.condensed or Condensed(model)
        short = self.condensed.step(law, off, balance, springs)
        if short is not None:
            return short
        bolts: Any = sparse.csr_matrix(-(model.bolt_rows.T * springs) @ model.bolt_rows) if len(springs) else None
        upper, right = sparse.identity(size, format="csr"), -model.rows
        if model.give is not None:
            upper = upper - model.give @ law
            right = right if bolts is None else right - model.give_load @ bolts
        whole = sparse.bmat([[upper, right], [model.rows.T @ law, bolts]], format="csc")
        try:
            found: Floats = splu(whole).solve(np.concatenate([-off, -balance]))
        except RuntimeError:  # singular
            found = np.zeros(size + len(balance))
        return found[:size], found[size:]


def _solved(matrix: Floats, right: Floats) -> Floats:
    """A small system, where nothing holds a block the shortest of its answers."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0], dtype=np.float64)
