"""The limit factor of safety of the forces of one block alone, and which of two limits governs.

Forces alone (no turning): the load splits in one way only into a pull along an admissible velocity and pushes on the
joints (Moreau's decomposition), whatever their strength: this is what closed forms compute. On flat joints `flat_limit`
sets that of the elastic bed beside it; on node pairs moments are balanced by `pairs_limit`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.outcome import Limit, Outcome
from slopekit.preie.solvers.linear import bounded_least_squares
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import FARTHEST, NO_FORCE, SAME_LIMIT, TINY
from slopekit.strength.mohr_coulomb import line

_STRIDE = 1.05  # steps of λ on the way to the first loss
_BEYOND = 1e-3  # of a bracket: so far on either side of where a straight line across it meets zero


@dataclass(frozen=True)
class LimitAnalysis:
    """The limit that governs, that of the forces alone, and that with turning; all the same where there is one limit.

    `model`: where laws are curved, the model with the line of each pair at its own traction; None where none is.
    """

    governing: Limit
    forces_only: Limit
    with_turning: Limit
    moments_govern: bool
    model: Model | None = None

    @property
    def balanced(self) -> Limit:
        """The limit whose forces balance the moments too, where there is one.

        Where the forces alone govern although the block could be held to more by its moments, the state with turning
        is that one: it stands at a higher factor, so at the limit too.
        """
        turning, factor = self.with_turning, self.governing.factor
        if factor is None or turning.factor is None or turning.outcome is not Outcome.SLIDES:
            return self.governing
        return turning if turning.factor >= factor * (1.0 - SAME_LIMIT) else self.governing


def governed(model: Model, alone: Limit, turning: Limit) -> LimitAnalysis:
    """Which of two limits governs, that of the forces alone or that with turning (it has a factor)."""
    assert turning.factor is not None
    if alone.factor is None or turning.factor < alone.factor * (1.0 - SAME_LIMIT):
        return LimitAnalysis(turning, alone, turning, True)
    if turning.factor < alone.factor * (1.0 + SAME_LIMIT):
        # the same slide with its moments balanced: the factor of the forces, the normal forces of the moments
        return LimitAnalysis(replace(turning, factor=alone.factor), alone, turning, False)
    return LimitAnalysis(replace(alone, velocity=alone.full_velocity(model)), alone, turning, False)


@dataclass(frozen=True)
class _Resultant:
    """The load split at one reduction λ: velocity (3,) with the driving force as its length, pushes, bolt pulls."""

    pull: Floats
    driving: float
    resisting: float
    normal_force: Floats
    touching: Bools
    bolt_pulls: Floats


def forces_only_limit(model: Model) -> Limit:
    """The limit of a block that may move but not turn: `model` without rotations or in its full form.

    At a reduction λ the joints push with N >= 0 and the passive bolts pull with 0 <= T <= λ capacity so as to leave
    the least of the load: that is the driving force, and its direction the velocity. The block stands where
    λ (c A + N tan φ) is more. Falling λ (rising F) is followed to the first loss.
    """
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import averaged  # only curved laws pay for it

        model = averaged(model)
    held = model if model.unknowns == model.translations else model.without_rotation()
    _, first, which = np.unique(held.normal_rows.round(12), axis=0, return_index=True, return_inverse=True)
    normals, which = held.normal_rows[first], which.ravel()
    share = held.control_area / np.bincount(which, held.control_area)[which]
    # bolts that pull one way are one of all their capacity
    _, alike, bolt = np.unique(held.bolt_rows.round(12), axis=0, return_index=True, return_inverse=True)
    pulling, bolt = held.bolt_rows[alike], bolt.ravel()
    capacity = np.bincount(bolt, held.bolt_capacity, minlength=len(pulling)).astype(np.float64)
    bolt_share = held.bolt_capacity / np.maximum(capacity[bolt], TINY)
    columns = np.concatenate([normals, pulling]).T
    # all that slips along one normal slips alike
    cohesion: Floats = np.bincount(which, held.cohesion).astype(np.float64)
    tan_friction: Floats = np.bincount(which, held.tan_friction * share).astype(np.float64)
    tangents = held.rows[first, 1:]
    pattern: Ints | None = None

    def at(reduction: float, near: bool = True) -> _Resultant:
        nonlocal pattern
        upper = np.concatenate([np.full(len(normals), np.inf), reduction * capacity])
        pushes, rest = bounded_least_squares(columns, -held.load, upper, pattern=pattern if near else None)
        pattern = np.where(pushes <= 0.0, 0, np.where(pushes >= upper, 2, 1))
        pushes, pulls = pushes[: len(normals)], pushes[len(normals) :]
        driving = math.sqrt(float(rest @ rest))
        touching = pushes > 0.0
        strength = line(touching * cohesion, tan_friction, pushes)
        is_driven = driving > NO_FORCE
        slips = np.sqrt(((tangents @ rest) ** 2).sum(axis=1)) / driving if is_driven else np.ones(len(normals))
        return _Resultant(
            -rest, driving, float(strength @ slips), pushes[which] * share, touching[which], pulls[bolt] * bolt_share
        )

    def limit(outcome: Outcome, factor: float | None, push: _Resultant) -> Limit:
        bond = push.touching.astype(np.float64)
        velocity = push.pull / push.driving if push.driving > NO_FORCE else np.zeros(held.unknowns)
        friction = pulls = None
        if factor:
            strength = line(bond * held.cohesion, held.tan_friction, push.normal_force) / factor
            slip = np.maximum(held.slip(velocity), NO_FORCE)
            friction = -(strength / slip)[:, None] * held.relative(velocity)[:, 1:]
            pulls = push.bolt_pulls
        return Limit(outcome, factor, velocity, push.normal_force, bond, 0, 0.0, friction, pulls)

    alone = at(0.0)
    if alone.driving < NO_FORCE:
        return limit(Outcome.NO_DRIVING_FORCE, None, alone)
    if not len(held.bolt_capacity):
        if not alone.touching.any():
            return limit(Outcome.LIFTED, None, alone)
        return limit(Outcome.SLIDES, alone.resisting / alone.driving, alone)
    guess = alone.driving / max(alone.resisting, NO_FORCE)
    return _first_loss(at, limit, float(held.bolt_capacity.sum()), guess if alone.touching.any() else 0.0)


def _first_loss(
    at: Callable[..., _Resultant],
    limit: Callable[[Outcome, float | None, _Resultant], Limit],
    capacity: float,
    bare: float,
) -> Limit:
    """With passive bolts: walk λ down from where all stands to the first λ at which it does not, then bisect.

    `bare` is λ without bolts, 0 where there is none; far above it the walk takes longer steps.
    """

    def stands(push: _Resultant, reduction: float) -> bool:
        return push.driving < NO_FORCE or reduction * push.resisting >= push.driving

    low = high = FARTHEST / capacity
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
        if low < 1.0 / FARTHEST:
            return limit(Outcome.NO_DRIVING_FORCE, None, at(low))

    def lacks(push: _Resultant, reduction: float) -> float:
        return push.driving - reduction * push.resisting

    at_low, at_high = lacks(at(low), low), lacks(at(high), high)
    for count in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if count % 3 and at_low > 0.0 > at_high:  # a straight line, then a little beyond where it meets zero
            line_zero = low + at_low / (at_low - at_high) * (high - low)
            beyond = _BEYOND * (high - low) if count % 3 == 1 else -_BEYOND * (high - low)
            middle = min(max(line_zero + beyond, math.nextafter(low, high)), math.nextafter(high, low))
        push = at(middle)
        if stands(push, middle):
            high, at_high = middle, lacks(push, middle)
        else:
            low, at_low = middle, lacks(push, middle)
    return limit(Outcome.SLIDES, 1.0 / high, at(low, near=False))


def stands_without_strength(model: Model) -> bool:
    """Whether pushes on the joints alone balance the forces and the moments."""
    _, rest = bounded_least_squares(model.normal_rows.T, -model.load, np.full(len(model.control_area), np.inf))
    return float(np.abs(rest).max()) < NO_FORCE
