"""Where an assembly of blocks comes to rest on its elastic contacts, at one strength reduction factor F.

    Bᵀ f(B γ) + P = 0,    N = k_n A <-opening>,    |T| <= (c A + N tan φ) / F

The law of each friction force is that of `preie.contact`, in total displacements: what is found does not depend on
how often it is asked for, and a block at rest does not creep. Contacts carry no tension; a node pair that is open
where the blocks have come to rest loses its cohesion, and the blocks settle again. Passive bolts are those of one block
(`preie.equilibrium`).

1. Passes: the strengths, and Clough-Duncan's stiffness, are frozen at the normal forces of the last pass. What is
   left is the smallest of a convex energy, which Newton with a line search always finds or follows down for ever.
2. Between the passes Newton on everything at once: quick and exact where it starts near enough, no help elsewhere.

A failure is an answer: `RestOutcome` tells blocks that fall from a search that gave up. Slip does not dilate here.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from slopekit.arrays import Bools, Floats, frozen
from slopekit.errors import SolverError
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.contact import ContactMode, JointStiffness, tractions
from slopekit.preie.equilibrium import BOLT_GIVE_M
from slopekit.preie.stiffness import Stiffness

_STANDS = 1e-10  # unbalanced force in parts of the largest force
_AIM = 1e-13
_ROUNDING, _COARSEST = 2.0**-52, 1e-8
_PASS_AIM = 1e-7  # of a pass: Newton on everything does the rest
_MOST_PASSES = 24
_MOST_STEPS = 40
_MOST_TOGETHER = 40
_FRUITLESS = 12  # steps together that have not come nearer
_LOOK_BACK, _WORSE, _SHORTEST = 6, 3.0, 0.01
_TOGETHER_SHIFT = 1e-14
_MOST_ROUNDS = 30  # of cohesion lost
_MOST_TRIALS = 60  # of a line search
_TOGETHER_AFTER = (0, 1, 3, 5, 8, 11, 15, 19, 23)
_FAR = 1e4  # a displacement so many times the elastic one runs away
_AWAY = 100.0  # times that: what seems to stand there has run away as well
_LEAST_SHIFT, _MOST_SHIFT = 1e-10, 1e-5  # of the stiffness in a pass
_CUT_SHORT, _FULL = 0.1, 0.5  # lengths of a step after which the shift grows and shrinks
_AMPLE = (0.25, 0.5, 0.1, 0.03, 1.0)  # parts of the factor at which strength is more than enough to start from
_SMALLEST_STRIDE = 1e-5  # of ln F: a factor that no shorter step reaches has no equilibrium
_FLAT, _EDGE = 0.7, 0.05  # of a line search: enough of the slope gone; nearest to the ends of its bracket
_UNDER_WAY = 0.7  # part of the new normal forces that later passes take


class RestOutcome(StrEnum):
    """How the blocks are found."""

    STANDS = "stands: the forces balance"
    FALLS = "falls: the displacements run away"
    GAVE_UP = "gave up: the normal forces did not settle"


@dataclass(frozen=True, slots=True)
class AtRest:
    """Blocks at rest, or the last that was seen of them.

    Attributes
    ----------
    outcome, factor : the strength reduction factor
    displacement : (n, u) m and radians
    normal_force : (m,) kN; friction : (g, t) kN
    is_open : (m,) node pairs that do not touch; bonded : (m,) that have kept their cohesion
    sticks, slips : (g,) friction forces below their strength in a closed contact, and at it; neither where it is open
    residual : largest unbalanced generalised force in parts of the largest force
    passes, steps : work done
    scaled : (n, u) the displacements in the model's units
    """

    outcome: RestOutcome
    factor: float
    displacement: Floats
    normal_force: Floats
    friction: Floats
    is_open: Bools
    bonded: Bools
    sticks: Bools
    slips: Bools
    residual: float
    passes: int
    steps: int
    scaled: Floats

    @property
    def stands(self) -> bool:
        """Whether forces and moments balance."""
        return self.outcome is RestOutcome.STANDS

    @property
    def failed(self) -> int:
        """Number of friction forces that do not stick."""
        return int((~self.sticks).sum())


def rest(model: AssemblyModel, factor: float, stiffness: JointStiffness, start: AtRest | None = None) -> AtRest:
    """Let the blocks come to rest with the strength c / F, tan φ / F.

    Parameters
    ----------
    factor : strength reduction factor F > 0
    start : blocks that stand at another factor, to go on from; bonds they have lost stay lost

    Raises
    ------
    SolverError
        E504 the model is too large for memory.
    """
    steps = passes = 0
    for state in ElasticBed(model, stiffness).path(factor, start):
        steps, passes = steps + state.steps, passes + state.passes
    return replace(state, factor=factor, steps=steps, passes=passes)


@dataclass(frozen=True, slots=True)
class _Seen:
    """Forces at one displacement, in the model's units, and their slopes.

    normal : (m,); touching : (m,); friction : (g, t); unbalanced : (n u,)
    size, rounding : of the unbalanced forces, in parts of the largest force, and what rounding leaves of them
    slopes : (g, t, t) less friction per slip; by_normal : (g, t) friction per normal force; yields : (g,)
    """

    normal: Floats
    touching: Bools
    friction: Floats
    unbalanced: Floats
    size: float
    rounding: float
    slopes: Floats
    by_normal: Floats
    yields: Bools


class ElasticBed:
    """A model with the stiffness of its contacts; `rest` may be asked at many factors on one bed.

    Raises
    ------
    SolverError
        E504 the model is too large for memory.
    """

    def __init__(self, model: AssemblyModel, stiffness: JointStiffness) -> None:
        self.model, self.stiffness = model, stiffness
        self.solver = Stiffness(model)
        self.load = model.load.ravel()
        self.group_area = model.by_group(model.control_area) * model.area_scale  # m²
        self.spring = (
            stiffness.normal * model.control_area * (model.area_scale * model.length_scale / model.force_scale)
        )
        self.stiffest = float(self.spring.max())
        self.first_pair = np.searchsorted(model.pair_contact, np.arange(len(model.plus)))
        self.first_group = np.searchsorted(model.group_contact, np.arange(len(model.plus)))
        self.by_pair = self.spring[:, None, None] * model.normal_rows[:, :, None] * model.normal_rows[:, None, :]
        self.elastic = self._bonded_displacement()
        self.far = _FAR * float(np.abs(self.elastic).max())

    # -- forces -------------------------------------------------------------------------------------------------------

    def seen(self, at: Floats, cohesion: Floats, factor: float, frozen_sums: Floats | None = None) -> _Seen:
        """Forces at the displacement (n u,); friction of the normal forces `frozen_sums` (g,), or of those there."""
        model, width = self.model, self.model.slip_rows.shape[1]
        opening, slip = model.opening_and_slip(at)
        touching: Bools = opening < 0.0
        normal = np.where(touching, -self.spring * opening, 0.0)
        pressed = model.by_group(normal) if frozen_sums is None else frozen_sums
        per_area = model.force_scale / self.group_area
        relative = np.zeros((len(pressed), 3))
        relative[:, 0] = pressed * per_area / -self.stiffness.normal
        relative[:, 1 : 1 + width] = slip * model.length_scale
        none = np.zeros(len(pressed))
        law = tractions(
            relative,
            self.stiffness,
            cohesion * per_area,
            model.tan_friction,
            none,
            factor,
            np.zeros(len(none), dtype=bool),
        )
        friction = law.tractions[:, 1 : 1 + width] / per_area[:, None]
        slopes = law.slopes[:, 1 : 1 + width, 1 : 1 + width] * (-model.length_scale / per_area)[:, None, None]
        if len(model.bolts):
            most, at_bolts = cohesion / factor, model.bolted
            stiff = model.by_group(model.cohesion) * model.length_scale / BOLT_GIVE_M
            drawn = -stiff * slip[:, 0]
            friction[at_bolts, 0] = np.clip(drawn, 0.0, most)[at_bolts]
            slopes[at_bolts, 0, 0] = np.where((drawn > 0.0) & (drawn < most), stiff, 0.0)[at_bolts]
        unbalanced = model.forces_on_blocks(normal, friction).ravel() + self.load
        largest = max(float(np.abs(self.load).max()), float(normal.max()))
        return _Seen(
            normal, touching, friction, unbalanced, float(np.abs(unbalanced).max()) / largest,
            min(max(_AIM, _ROUNDING * self.stiffest * float(np.abs(at).max()) / largest), _COARSEST),
            slopes,
            law.slopes[:, 1 : 1 + width, 0] / -self.stiffness.normal, law.modes == ContactMode.SLIP,
        )  # fmt: skip

    def contact_stiffness(self, seen: _Seen, together: bool) -> Floats:
        """Stiffness (k, u, u) of the contacts; `together` counts that friction grows with the normal forces."""
        rows = self.model.slip_rows
        of_pairs = np.where(seen.touching[:, None, None], self.by_pair, 0.0)
        local: Floats = np.add.reduceat(of_pairs, self.first_pair, axis=0)
        transposed = rows.transpose(0, 2, 1)
        of_groups = np.matmul(transposed, np.matmul(seen.slopes, rows))
        if together:
            per_motion = np.where(seen.touching, self.spring, 0.0)[:, None] * self.model.normal_rows
            summed = np.add.reduceat(per_motion, self.model.group_first, axis=0)
            of_groups += np.matmul(transposed, seen.by_normal[:, :, None]) * summed[:, None, :]
        return local + np.add.reduceat(of_groups, self.first_group, axis=0)

    def _bonded_displacement(self) -> Floats:
        """Displacements (n u,) with springs, the normal ones', in all directions and open nowhere."""
        rows = self.model.slip_rows
        spring = self.model.by_group(self.spring)[:, None, None]
        sideways = spring * np.matmul(rows.transpose(0, 2, 1), rows)
        local = np.add.reduceat(self.by_pair, self.first_pair, axis=0)
        return self.solver.factored(local + np.add.reduceat(sideways, self.first_group, axis=0), 1e-12)(self.load)

    # -- rest ---------------------------------------------------------------------------------------------------------

    def path(self, factor: float, start: AtRest | None = None, smallest: float = _SMALLEST_STRIDE) -> Iterator[AtRest]:
        """Blocks at rest on the way to the factor; the last is there, or does not stand.

        Parameters
        ----------
        start : blocks that stand at another factor; none: at a strength that is more than enough
        smallest : stride of ln F, for a factor that no shorter one reaches has no equilibrium
        """
        state = start if start is not None and start.stands else None
        if state is not None and state.factor >= factor:
            trial = self._at(factor, state)
            if trial.stands:
                yield trial
                return
            state = None
        if state is None:
            state = self._at(factor * _AMPLE[0], None)
            for part in _AMPLE[1:]:
                if state.stands:
                    break
                state = self._at(factor * part, None)
            yield state if state.stands else replace(state, factor=factor)
        if not state.stands:
            return
        stride = math.log(factor / state.factor)
        while state.factor < factor:
            remaining = math.log(factor / state.factor)
            trial = self._at(factor if stride >= remaining else state.factor * math.exp(stride), state)
            if trial.stands:
                yield trial
                state, stride = trial, 2.0 * stride
                continue
            stride = min(stride, remaining) / 3.0
            if stride < smallest:
                yield trial
                return

    def _at(self, factor: float, start: AtRest | None) -> AtRest:
        """Blocks at rest, straight from another state or from elastic springs."""
        bonded = np.ones(len(self.spring), dtype=bool) if start is None else start.bonded
        at = self.elastic if start is None else start.scaled.ravel()
        passes = steps = 0
        for k in range(_MOST_ROUNDS):
            cohesion = self.model.by_group(np.where(bonded, self.model.cohesion, 0.0))
            outcome, at, more_passes, more_steps = self._settled(at, cohesion, factor, start is None and k == 0)
            if outcome is RestOutcome.STANDS and float(np.abs(at).max()) > _AWAY * self.far:
                outcome = RestOutcome.FALLS  # rounding balances what has run away
            passes, steps = passes + more_passes, steps + more_steps
            seen = self.seen(at, cohesion, factor)
            parted: Bools = bonded & ~seen.touching & (self.model.cohesion > 0.0)
            parted[self.model.joint_pairs.stop :] = False
            if outcome is not RestOutcome.STANDS or not parted.any():
                break
            bonded = bonded & ~parted
        return self._told(at, seen, bonded, outcome, factor, passes, steps)

    def _told(
        self, at: Floats, seen: _Seen, bonded: Bools, outcome: RestOutcome, factor: float, passes: int, steps: int
    ) -> AtRest:
        model, unknowns = self.model, self.model.unknowns
        to_metres = np.where(np.arange(unknowns) < unknowns // 2 + unknowns % 2, model.length_scale, 1.0)
        closed: Bools = model.by_group(seen.normal) > 0.0
        scaled = frozen(at.reshape(model.load.shape))
        return AtRest(
            outcome, factor, frozen(scaled * to_metres), frozen(seen.normal * model.force_scale),
            frozen(seen.friction * model.force_scale), ~seen.touching, bonded, closed & ~seen.yields,
            closed & seen.yields, seen.size, passes, steps, scaled,
        )  # fmt: skip

    def _settled(
        self, at: Floats, cohesion: Floats, factor: float, afresh: bool
    ) -> tuple[RestOutcome, Floats, int, int]:
        """Passes, and Newton on everything between them."""
        steps = 0
        here = self.seen(at, cohesion, factor)
        if here.size <= here.rounding:
            return RestOutcome.STANDS, at, 0, 0
        sums = self.model.by_group(here.normal)
        if afresh:
            sums = np.maximum(sums, 1.0)  # a block's weight: nothing slips yet
        else:
            stands, found, steps = self._together(at, cohesion, factor)
            if stands:
                return RestOutcome.STANDS, found, 0, steps
        for k in range(_MOST_PASSES):
            falls, at, more = self._pass(at, cohesion, factor, sums)
            steps += more
            if falls:
                return RestOutcome.FALLS, at, k + 1, steps
            if k in _TOGETHER_AFTER:
                stands, found, more = self._together(at, cohesion, factor)
                steps += more
                if stands:
                    return RestOutcome.STANDS, found, k + 1, steps
            after = self.model.by_group(self.seen(at, cohesion, factor).normal)
            sums = after if k < 3 else (1.0 - _UNDER_WAY) * sums + _UNDER_WAY * after
        return RestOutcome.GAVE_UP, at, _MOST_PASSES, steps

    def _pass(self, at: Floats, cohesion: Floats, factor: float, sums: Floats) -> tuple[bool, Floats, int]:
        """The smallest energy with the strengths of the normal forces `sums` (g,): whether it runs away, and where."""
        seen, shift = self.seen(at, cohesion, factor, sums), _LEAST_SHIFT
        for step in range(_MOST_STEPS):
            if seen.size <= max(_PASS_AIM, 4.0 * seen.rounding):
                return False, at, step
            try:
                way = self.solver.factored(self.contact_stiffness(seen, False), shift)(seen.unbalanced)
            except SolverError:  # nothing touches any more
                return True, at, step
            length, seen = self._down(at, way, seen, lambda there: self.seen(there, cohesion, factor, sums))
            at = at + length * way
            if length < _CUT_SHORT:  # where whole courses slip, a step without it says nothing
                shift = min(10.0 * shift, _MOST_SHIFT)
            elif length > _FULL:
                shift = max(0.1 * shift, _LEAST_SHIFT)
            if float(np.abs(at).max()) > _AWAY * self.far:
                return True, at, step + 1
        return False, at, _MOST_STEPS

    def _down(self, at: Floats, way: Floats, seen: _Seen, look: Callable[[Floats], _Seen]) -> tuple[float, _Seen]:
        """A line search down a convex energy: how far, and what is seen there."""
        slope = float(way @ seen.unbalanced)
        low, high, at_low, at_high = 0.0, np.inf, slope, 0.0
        length = trial = 1.0
        for _ in range(_MOST_TRIALS):
            length = trial
            found = look(at + length * way)
            here = float(way @ found.unbalanced)
            if abs(here) <= _FLAT * slope or (here > 0.0 and length * float(np.abs(way).max()) > self.far):
                break
            if here > 0.0:
                low, at_low = length, here
            else:
                high, at_high = length, here
            if np.isinf(high):
                trial = 4.0 * length
            else:
                part = at_low / (at_low - at_high)
                trial = low + (high - low) * min(max(part, _EDGE), 1.0 - _EDGE)
        return length, found

    def _together(self, at: Floats, cohesion: Floats, factor: float) -> tuple[bool, Floats, int]:
        """Newton with friction that follows the normal forces: whether it got there, and where.

        Its steps may make the unbalanced force larger for a while: contacts open and stick again on the way.
        """
        seen = self.seen(at, cohesion, factor)
        best, sizes = (seen.size, at, seen.rounding), [seen.size]
        for _ in range(_MOST_TOGETHER):
            if seen.size <= seen.rounding or min(sizes[-_FRUITLESS:]) > best[0]:
                break
            try:
                way = self.solver.factored(self.contact_stiffness(seen, True), _TOGETHER_SHIFT, False)(seen.unbalanced)
            except SolverError:
                break
            most, length = max(sizes[-_LOOK_BACK:]), 1.0
            there, found = at + way, self.seen(at + way, cohesion, factor)
            least = (found.size, there, found)
            while found.size >= most * (1.0 - 0.01 * length) and length > _SHORTEST:
                length *= 0.5
                there = at + length * way
                found = self.seen(there, cohesion, factor)
                least = min(least, (found.size, there, found), key=lambda each: each[0])
            at, seen = least[1:] if length <= _SHORTEST else (there, found)
            if seen.size > _WORSE * most:
                break
            sizes.append(seen.size)
            best = min(best, (seen.size, at, seen.rounding), key=lambda each: each[0])
        return best[0] <= max(_STANDS, 4.0 * best[2]), best[1], len(sizes) - 1
