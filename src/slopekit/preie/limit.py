"""The limit factor of safety: the largest F at which the blocks still stand when slip does not dilate the joints.

Three steps, each only where the one before does not settle it:

1. every pair closed, every bond whole: `intact_limit_state`, exact;
2. the forces alone (no turning): the load splits in one way only into a pull along an admissible velocity and
   pushes on the joints (Moreau's decomposition), whatever their strength: this is what closed forms compute;
3. passes: friction frozen at the normal forces of the last pass, the cheapest mechanism of a convex program, new
   normal forces. A pair that the mechanism opens loses its cohesion in the next pass and gets it back if it closes
   again; one that opens twice has lost it. Aitken's rule steers the passes, `settled_limit_state` ends them.

Turning may lower the limit below what the forces alone give, and then governs. Where turning wedges the block and
would raise it, the forces alone stand: no credit is taken for an arrangement that only moments hold together.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.preie.bound import static_bound
from slopekit.preie.limit_state import (
    LimitState,
    dilating_limit_state,
    elastic_displacement,
    intact_limit_state,
    settled_limit_state,
)
from slopekit.preie.linear import bounded_least_squares
from slopekit.preie.mechanism import COLD, WARM, cheapest_mechanism
from slopekit.preie.model import Model

_OPENS = 1e-5  # opening above this part of the largest slip is the mechanism's, not the penalty's
_MOST_PASSES = 300
_STAGE_PASSES = 120  # passes with the same bonds before what opens is let go all the same
_MOST_RELEASES = 2
_AITKEN_PASSES = 30
_PATIENT_STEP = 0.1
_WINDOW = 20  # passes over which the factor must keep still ...
_STEADY = 1e-5  # ... to this part, where the normal forces do not settle
_MOMENTS = 1e-6  # a limit lower than that of the forces alone by more than this part is governed by moments
_NO_FORCE = 1e-12  # a force this small (in parts of the load) is none
_STRONGEST = 1e6  # strength multiplied by this much holds whatever can be held
_STRIDE = 1.05  # steps of λ on the way to the first loss
_NO_NUMBER = 0.5  # a range of factors wider than this part of the highest is none
_NOTHING = 1e-9  # strength, or work, that counts as none (in parts of the load)


class Outcome(Enum):
    """How a limit analysis ended; every one of them is an answer but the last."""

    SLIDES = "the blocks slide, or slide and turn, when the strength is divided by the factor"
    NO_STRENGTH = "the blocks move with nothing to hold them: no strength is called on"
    LIFTED = "the loads pull the blocks off every joint"
    NO_DRIVING_FORCE = "nothing drives the blocks: they stand without strength"
    NOT_CONVERGED = "the passes did not settle"


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit factor with its evidence.

    Attributes
    ----------
    outcome : how it ended
    factor : F, None unless something slides or turns
    velocity : (u,) the mechanism, of unit length; normal_force : (n,); bond : (n,) cohesion left, 0 or 1
    passes, steps : work done; change : relative change of the factor in the last pass (0: solved exactly)
    """

    outcome: Outcome
    factor: float | None
    velocity: Floats
    normal_force: Floats
    bond: Floats
    passes: int
    steps: int
    change: float

    def settled_to(self, relative: float) -> bool:
        """Whether the factor is one number to that part: not a range that the passes swung through, nor none."""
        return self.outcome is not Outcome.NOT_CONVERGED and self.change <= relative

    def velocity_of(self, model: Model) -> Floats:
        """The mechanism in the unknowns of `model`: a limit of forces alone does not turn."""
        return np.concatenate([self.velocity, np.zeros(model.unknowns - len(self.velocity))])


@dataclass(frozen=True, slots=True)
class LimitAnalysis:
    """The limit with turning and that of the forces alone (None where the first step settled both)."""

    governing: Limit
    forces_only: Limit
    with_turning: Limit
    moments_govern: bool


def limit_analysis(model: Model) -> LimitAnalysis:
    """The limit factor of one block, and whether moments govern it."""
    state = intact_limit_state(model)
    if state is not None and model.dilates:
        state = dilating_limit_state(model, state)
    if state is not None:
        limit = _exact(state, np.ones(len(model.control_area)), 0)
        return LimitAnalysis(limit, limit, limit, False)
    alone = forces_only_limit(model)
    if alone.outcome is Outcome.LIFTED:
        return LimitAnalysis(alone, alone, alone, False)
    if alone.outcome is Outcome.NO_DRIVING_FORCE and _stands_without_strength(model):
        return LimitAnalysis(alone, alone, alone, False)
    if alone.factor == 0.0:
        return LimitAnalysis(alone, alone, alone, False)
    if model.dilates and (associated := _associated_limit(model)) is not None:
        return LimitAnalysis(associated, associated, associated, False)
    start = alone.velocity_of(model)
    may_bond: Bools = np.ones(len(alone.bond), dtype=bool)
    turning = _passes(model, start, alone.normal_force, alone.bond, may_bond)
    if turning.outcome is Outcome.NO_STRENGTH and model.dilates:
        turning = replace(turning, outcome=Outcome.NOT_CONVERGED)  # dilation itself resists: the passes lost their way
    if turning.outcome is Outcome.NO_STRENGTH:
        return LimitAnalysis(turning, alone, turning, True)
    if turning.outcome is Outcome.NOT_CONVERGED:
        return LimitAnalysis(turning, alone, turning, False)
    assert turning.factor is not None
    governs = alone.factor is None or turning.factor < alone.factor * (1.0 - _MOMENTS)
    if governs:
        return LimitAnalysis(turning, alone, turning, True)
    if alone.factor is not None and turning.factor < alone.factor * (1.0 + _MOMENTS):
        # the same slide with its moments balanced: the factor of the forces, the normal forces of the moments
        return LimitAnalysis(replace(turning, factor=alone.factor), alone, turning, False)
    return LimitAnalysis(_turned(alone, model), alone, turning, False)


def curved_limit_analysis(model: Model) -> LimitAnalysis:
    """The limit factor of one block on a curved surface, where a block that may not turn cannot slide either.

    There are no forces alone to compare with: `moments_govern` is false.
    """
    every: Bools = np.ones(len(model.control_area), dtype=bool)
    bond = np.ones(len(every))

    def alike(limit: Limit) -> LimitAnalysis:
        return LimitAnalysis(limit, limit, limit, False)

    state = intact_limit_state(model)
    if state is not None and model.dilates:
        state = dilating_limit_state(model, state)
    if state is not None:
        return alike(_exact(state, bond, 0))
    none = np.zeros(model.unknowns)
    if float((model.normal_rows @ model.load).min()) > 0.0:  # the load itself moves it off every pair
        return alike(Limit(Outcome.LIFTED, None, none, np.zeros(len(every)), 0.0 * bond, 0, 0, 0.0))
    if _stands_without_strength(model):
        return alike(Limit(Outcome.NO_DRIVING_FORCE, None, none, np.zeros(len(every)), bond, 0, 0, 0.0))
    if model.dilates and (associated := _associated_curved_limit(model)) is not None:
        return alike(associated)
    start = elastic_displacement(model)
    normal = np.maximum(-model.control_area * (model.normal_rows @ start), 0.0)
    limit = _passes(model, start, normal, bond, every)
    if model.dilates and (limit.outcome is Outcome.NO_STRENGTH or limit.change > _NO_NUMBER):
        # dilation itself resists: the passes lost their way
        limit = replace(limit, outcome=Outcome.NOT_CONVERGED, factor=None)
    return alike(limit)


def passes_limit(model: Model, passes: int) -> float:
    """The factor after that many frozen-friction passes from a cold start, every bond whole: effort against error."""
    normal = np.maximum(-model.control_area * (model.normal_rows @ elastic_displacement(model)), 0.0)
    velocity, stages, factor = model.load, COLD, 0.0
    for _ in range(passes):
        friction = model.cohesion + model.tan_friction * normal
        found = cheapest_mechanism(
            model, friction, np.zeros(len(normal)), velocity, np.zeros(model.unknowns), model.load,
            model.bolt_capacity, stages,
        )  # fmt: skip
        velocity, factor, stages = found.velocity, found.load_factor, WARM
        normal = found.normal_force / factor
    return factor


def _associated_limit(model: Model) -> Limit | None:
    """The limit where every joint dilates by all its reduced friction angle: there it is the static bound."""
    rigid = replace(model, tan_dilation=np.zeros_like(model.tan_dilation))
    without = limit_analysis(rigid).governing
    if not without.factor:
        return None
    bound = static_bound(rigid, without.velocity_of(rigid), without.factor)
    if bound.factor is None or (model.tan_dilation * bound.factor < model.tan_friction * (1.0 - _NOTHING)).any():
        return None
    bond = np.ones(len(model.control_area))
    return Limit(Outcome.SLIDES, bound.factor, _unit(bound.velocity), bound.normal_force, bond, 0, bound.steps, 0.0)


def _associated_curved_limit(model: Model) -> Limit | None:
    """The same on a curved surface, where the mechanism opens pairs beyond their dilation: those lose cohesion."""
    bond = np.ones(len(model.control_area))
    releases = np.zeros(len(bond))
    for _ in range(_MOST_RELEASES * _WINDOW):
        rigid = replace(model, tan_dilation=np.zeros_like(bond), cohesion=bond * model.cohesion)
        without = curved_limit_analysis(rigid).governing
        if not without.factor:
            return None
        bound = static_bound(rigid, without.velocity, without.factor)
        if bound.factor is None or (model.tan_dilation * bound.factor < model.tan_friction * (1.0 - _NOTHING)).any():
            return None
        renewed, releases = _release(model, bound.velocity, model.tan_friction / bound.factor, bond, releases)
        if (renewed == bond).all():
            return Limit(
                Outcome.SLIDES, bound.factor, _unit(bound.velocity), bound.normal_force, bond, 0, bound.steps, 0.0
            )
        bond = renewed
    return None


@dataclass(frozen=True, slots=True)
class _Push:
    """The load split at one reduction λ: velocity (3,) with the driving force as its length, pushes, bolt pulls."""

    pull: Floats
    driving: float
    resisting: float
    normal_force: Floats
    touching: Bools


def forces_only_limit(model: Model) -> Limit:
    """The limit of a block that may move but not turn: `model` without rotations or in its full form.

    At a reduction λ the joints push with N >= 0 and the passive bolts pull with 0 <= T <= λ capacity so as to leave
    the least of the load: that is the driving force, and its direction the velocity. The block stands where
    λ (c A + N tan φ) is more. Falling λ (rising F) is followed to the first loss.
    """
    held = model if model.unknowns == model.translations else model.without_rotation()
    normals, which = np.unique(held.normal_rows.round(12), axis=0, return_inverse=True)
    which = which.ravel()
    share = held.control_area / np.bincount(which, held.control_area)[which]
    columns = np.concatenate([normals, held.bolt_rows]).T

    def at(reduction: float) -> _Push:
        upper = np.concatenate([np.full(len(normals), np.inf), reduction * held.bolt_capacity])
        pushes, rest = bounded_least_squares(columns, -held.load, upper)
        pushes = pushes[: len(normals)]
        driving = math.sqrt(float(rest @ rest))
        touching: Bools = (pushes > 0.0)[which]
        normal = pushes[which] * share
        strength = touching * held.cohesion + held.tan_friction * normal
        slip = held.slip(rest) / driving if driving > _NO_FORCE else np.ones(len(share))
        return _Push(-rest, driving, float(strength @ slip), normal, touching)

    def limit(outcome: Outcome, factor: float | None, push: _Push) -> Limit:
        bond = push.touching.astype(np.float64)
        velocity = push.pull / push.driving if push.driving > _NO_FORCE else np.zeros(held.unknowns)
        return Limit(outcome, factor, velocity, push.normal_force, bond, 0, 0, 0.0)

    alone = at(0.0)
    if alone.driving < _NO_FORCE:
        return limit(Outcome.NO_DRIVING_FORCE, None, alone)
    if not len(held.bolt_capacity):
        if not alone.touching.any():
            return limit(Outcome.LIFTED, None, alone)
        if held.dilates:
            may_bond: Bools = np.ones(len(share), dtype=bool)
            velocity = alone.pull / alone.driving
            return _passes(held, velocity, alone.normal_force, alone.touching.astype(np.float64), may_bond)
        return limit(Outcome.SLIDES, alone.resisting / alone.driving, alone)
    guess = alone.driving / max(alone.resisting, _NO_FORCE)
    return _first_loss(at, limit, float(held.bolt_capacity.sum()), guess if alone.touching.any() else 0.0)


def _first_loss(
    at: Callable[[float], _Push],
    limit: Callable[[Outcome, float | None, _Push], Limit],
    capacity: float,
    bare: float,
) -> Limit:
    """With passive bolts: walk λ down from where all stands to the first λ at which it does not, then bisect.

    `bare` is λ without bolts, 0 where there is none; far above it the walk takes longer steps.
    """

    def stands(push: _Push, reduction: float) -> bool:
        return push.driving < _NO_FORCE or reduction * push.resisting >= push.driving

    low = high = _STRONGEST / capacity
    push = top = at(high)
    # bolts so strong that they would lift the block off pull no more than keeps it on a joint
    hangs = bare > 0.0 and not top.touching.any() and not stands(top, high)
    while hangs and not stands(push, low) and low > 1e-3 * bare:
        high, low = low, low / (2.0 if low > 30.0 * bare else _STRIDE)
        push = at(low)
    if not stands(push, low):
        outcome = Outcome.LIFTED if not top.touching.any() else Outcome.SLIDES
        return limit(outcome, None if outcome is Outcome.LIFTED else 0.0, top)
    while stands(at(low), low):
        high, low = low, low / (2.0 if low > 30.0 * bare > 0.0 else _STRIDE)
        if low < 1.0 / _STRONGEST:
            return limit(Outcome.NO_DRIVING_FORCE, None, at(low))
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (low, middle) if stands(at(middle), middle) else (middle, high)
    return limit(Outcome.SLIDES, 1.0 / high, at(low))


def _turned(limit: Limit, model: Model) -> Limit:
    """The forces-only limit with its velocity in the full model's unknowns."""
    return replace(limit, velocity=limit.velocity_of(model))


def _exact(state: LimitState, bond: Floats, passes: int, steps: int = 0) -> Limit:
    factor = 1.0 / state.reduction
    normal = np.maximum(state.normal_force, 0.0)
    return Limit(Outcome.SLIDES, factor, state.velocity, normal, bond, passes, steps + state.steps, 0.0)


def _stands_without_strength(model: Model) -> bool:
    """Whether pushes on the joints alone balance the forces and the moments."""
    count = len(model.control_area)
    _, rest = bounded_least_squares(model.normal_rows.T, -model.load, np.full(count, np.inf))
    return float(np.abs(rest).max()) < 1e-12


def _passes(model: Model, velocity: Floats, normal_force: Floats, bond: Floats, may_bond: Bools) -> Limit:
    """Passes steered by Aitken's rule, and where those do not settle, patient ones."""
    swift = _steered(model, velocity, normal_force, bond, may_bond, patient=False)
    if swift.outcome is not Outcome.NOT_CONVERGED:
        return swift
    slow = _steered(model, velocity, normal_force, bond, may_bond, patient=True)
    return replace(slow, passes=swift.passes + slow.passes, steps=swift.steps + slow.steps)


def _steered(
    model: Model, velocity: Floats, normal_force: Floats, bond: Floats, may_bond: Bools, patient: bool
) -> Limit:  # fmt: skip
    """Frozen-friction passes from a first guess; `may_bond` marks the pairs that may have cohesion at all.

    Bonds change only when the passes have settled: what opens on the way there is the guess's doing.
    """
    releases = np.where(may_bond, 0, _MOST_RELEASES)
    friction = bond * model.cohesion + model.tan_friction * normal_force
    if not float(velocity @ model.load) > 1e-6 * math.sqrt(float((velocity @ velocity) * (model.load @ model.load))):
        velocity = model.load
    stages, weight = COLD, 1.0
    last: Floats | None = None
    factor, change, calm, quiet, steps = math.inf, math.inf, 0, 0, 0
    recent: list[float] = []
    nothing = np.zeros(model.unknowns)
    for count in range(1, _MOST_PASSES + 1):
        total = float(friction.sum() + model.bolt_capacity.sum())
        if total < _NOTHING * _NOTHING:
            return Limit(Outcome.NO_STRENGTH, None, _unit(velocity), normal_force, bond, count, steps, 0.0)
        tan_dilation = np.minimum(model.tan_dilation, model.tan_friction / max(factor, _NO_FORCE))
        found = cheapest_mechanism(
            model, friction, tan_dilation, velocity, nothing, model.load, model.bolt_capacity, stages
        )
        velocity, stages, steps = found.velocity, WARM, steps + found.steps
        factor_before, factor = factor, found.load_factor
        without = not factor > _NOTHING * total
        if not without:
            normal_force = found.normal_force / factor
        # the program adds N tan ψ at the load factor by itself: what is frozen is the rest of c A + N tan φ
        rest = np.maximum(model.tan_friction - factor * tan_dilation, 0.0)
        excess = bond * model.cohesion + rest * normal_force - friction
        change = float(np.abs(excess).sum()) / total
        moved = abs(factor - factor_before) / factor if factor > 0.0 else 0.0
        calm += 1
        quiet = quiet + 1 if moved < 1e-7 and change < 1e-3 else 0
        state: LimitState | None = None
        settled = (change < 1e-7 and (moved < 1e-7 or not model.dilates)) or quiet >= 3
        if settled and change < 1e-7 and not model.dilates:
            moved = change  # the strength is what the program took: its factor is exact, whatever the last bonds gave
        recent = [*recent[1 - (5 * _WINDOW if patient else _WINDOW) :], factor]
        if calm > 2 * _WINDOW and change < 3e-3 and max(recent[-_WINDOW:]) - min(recent[-_WINDOW:]) < _STEADY * factor:
            # averaging creeps: the normal forces still trade places, the factor no longer moves
            settled, moved = True, (max(recent[-_WINDOW:]) - min(recent[-_WINDOW:])) / factor
        if not settled and not without and not model.dilates and change < 0.3 and (calm < 4 or calm % 4 == 0):
            state = settled_limit_state(model, velocity, 1.0 / factor, normal_force, bond)
            if state is not None and abs(math.log(state.reduction * factor)) > 0.3:
                state = None
        if settled or state is not None or without or calm >= _STAGE_PASSES:
            at = velocity if state is None else state.velocity
            renewed, releases = _release(model, at, tan_dilation, bond, releases)
            if (renewed == bond).all():
                if without:
                    return Limit(Outcome.NO_STRENGTH, None, _unit(velocity), normal_force, bond, count, steps, 0.0)
                if state is not None:
                    return _exact(state, bond, count, steps)
                if settled:
                    return Limit(Outcome.SLIDES, factor, _unit(velocity), normal_force, bond, count, steps, moved)
            else:
                if state is not None:
                    normal_force = np.maximum(state.normal_force, 0.0)
                bond = renewed
                friction = bond * model.cohesion + rest * normal_force
                last, calm, quiet, weight = None, 0, 0, 1.0
                continue
        if last is not None:
            if patient:
                weight = _PATIENT_STEP
            elif calm <= _AITKEN_PASSES:
                turn = excess - last
                weight = -weight * float(last @ turn) / max(float(turn @ turn), 1e-300)
                weight = min(max(weight, 0.1), 20.0) if weight > 0.0 else 0.5
            else:  # feel the way: longer steps while they agree, shorter where they turn about
                weight = min(max(weight * (1.5 if float(last @ excess) > 0.0 else 0.5), 0.02), 5.0)
        last = excess
        friction = np.maximum(friction + weight * excess, 0.0)
    lowest, highest = min(recent), max(recent)
    if patient and lowest > _NOTHING and (bond == 0.0).any():
        # what opens and what holds keep trading places: the lowest factor they came to, and how far they swing
        return Limit(
            Outcome.SLIDES, lowest, _unit(velocity), normal_force, bond, _MOST_PASSES, steps, 1.0 - lowest / highest
        )
    return Limit(Outcome.NOT_CONVERGED, None, _unit(velocity), normal_force, bond, _MOST_PASSES, steps, change)


def _release(
    model: Model, velocity: Floats, tan_dilation: Floats, bond: Floats, releases: Floats
) -> tuple[Floats, Floats]:
    """Bonds after a pass: gone where the mechanism opens a pair beyond its dilation, back where it is closed again."""
    motion, slip = model.relative(velocity)[:, 0], model.slip(velocity)
    opened = motion - tan_dilation * slip > _OPENS * max(float(slip.max()), float(motion.max()))
    renewed = np.where(opened | (releases >= _MOST_RELEASES), 0.0, 1.0)
    return renewed, releases + ((bond > 0.0) & (renewed == 0.0))


def _unit(vector: Floats) -> Floats:
    unit: Floats = vector / math.sqrt(float(vector @ vector))
    return unit
