"""Frozen-friction passes: the third step to the limit factor, where neither an exact state nor forces alone settle it.

The friction is frozen at the normal forces of the last pass, the mechanism of least work of a convex program gives new
ones. A pair that the mechanism opens loses its cohesion in the next pass and gets it back if it closes again; one that
opens twice has lost it. Aitken's rule steers the passes, `settled_limit_state` ends them.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.one_block.limit_state import LimitState, settled_limit_state
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import DRIVEN, EQUILIBRIUM, NO_FORCE, OPENS_IN_PASSES, PASSES_STEADY, TINY
from slopekit.strength.mohr_coulomb import line

if TYPE_CHECKING:  # most limits need no passes
    from slopekit.preie.programs.mechanism import LeastWorkMechanism

STEERED = 300  # passes by Aitken's rule; as many damped ones follow where those do not settle: on curved surfaces
_DAMPED_STEP = 0.1  # part of the way to the new friction that a damped pass takes
_STAGE_PASSES = 120  # passes with the same bonds before what opens is let go all the same; they say how far F swings
MOST_RELEASES = 2  # a pair that opens so often has lost its cohesion; with 1 some factors move by 20 %
_WINDOW = 30  # passes by his rule, before longer and shorter steps feel the way; then the factor must keep still


class Outcome(Enum):
    """How a limit analysis ended; every one of them is an answer but the last."""

    SLIDES = "the blocks slide, or slide and turn, when the strength is divided by the factor"
    NO_STRENGTH = "the blocks move with nothing to hold them: no strength is called on"
    LIFTED = "the loads pull the blocks off every joint"
    NO_REST = "the blocks come to rest at no strength: they topple whatever the friction"
    NO_DRIVING_FORCE = "nothing drives the blocks: they stand without strength"
    NOT_CONVERGED = "the passes did not settle"


@dataclass(frozen=True)
class Limit:
    """A limit factor with its evidence.

    Attributes
    ----------
    outcome : how it ended
    factor : F, None unless something slides or turns
    velocity : (u,) the mechanism, of unit length; normal_force : (n,); bond : (n,) cohesion left, 0 or 1
    passes : work done; change : relative change of the factor in the last pass (0: solved exactly)
    friction : (n, 2) tangential forces and pulls : (b,) those of the bolts, at the reduced strength; None without a
        factor
    """

    outcome: Outcome
    factor: float | None
    velocity: Floats
    normal_force: Floats
    bond: Floats
    passes: int
    change: float
    friction: Floats | None = None
    pulls: Floats | None = None

    def settled_to(self, relative: float) -> bool:
        """Whether the factor is one number to that part: not a range that the passes swung through, nor none."""
        return self.outcome is not Outcome.NOT_CONVERGED and self.change <= relative

    def velocity_of(self, model: Model) -> Floats:
        """The mechanism in the unknowns of `model`: a limit of forces alone does not turn."""
        return np.concatenate([self.velocity, np.zeros(model.unknowns - len(self.velocity))])


def settle_by_passes(model: Model, velocity: Floats, normal_force: Floats, bond: Floats) -> Limit:
    """Frozen-friction passes from a first guess.

    Bonds change only when the passes have settled: what opens on the way there is the guess's doing. Where they do not
    settle the lowest factor of the last ones stands, and `change` says how far they swing.
    """
    from slopekit.preie.programs.mechanism import COLD, WARM, least_work_mechanism

    releases = np.zeros(len(bond))
    friction = line(bond * model.cohesion, model.tan_friction, normal_force)
    if not float(velocity @ model.load) > DRIVEN * math.sqrt(float((velocity @ velocity) * (model.load @ model.load))):
        velocity = model.load
    stages, weight = COLD, 1.0
    last: Floats | None = None
    factor, change, calm, quiet = math.inf, math.inf, 0, 0
    recent: list[float] = []
    for count in range(1, 2 * STEERED + 1):
        total = float(friction.sum() + model.bolt_capacity.sum())
        if total < EQUILIBRIUM * EQUILIBRIUM:
            return Limit(Outcome.NO_STRENGTH, None, unit(velocity), normal_force, bond, count, 0.0)
        tan_dilation = np.minimum(model.tan_dilation, model.tan_friction / max(factor, NO_FORCE))
        mechanism = least_work_mechanism(model, friction, tan_dilation, velocity, stages)
        velocity, stages = mechanism.velocity, WARM
        factor_before, factor = factor, mechanism.load_factor
        without = not factor > EQUILIBRIUM * total
        if not without:
            normal_force = mechanism.normal_force / factor
        # the program adds N tan ψ at the load factor by itself: what is frozen is the rest of c A + N tan φ
        rest = np.maximum(model.tan_friction - factor * tan_dilation, 0.0)
        excess = line(bond * model.cohesion, rest, normal_force) - friction
        change = float(np.abs(excess).sum()) / total
        moved = abs(factor - factor_before) / factor if factor > 0.0 else 0.0
        calm += 1
        quiet = quiet + 1 if moved < 1e-7 and change < 1e-3 else 0
        state: LimitState | None = None
        settled = (change < 1e-7 and (moved < 1e-7 or not model.dilates)) or quiet >= 3
        if settled and change < 1e-7 and not model.dilates:
            moved = change  # the strength is what the program took: its factor is exact, whatever the last bonds gave
        recent = [*recent[1 - _STAGE_PASSES :], factor]
        swing = max(recent[-_WINDOW:]) - min(recent[-_WINDOW:])
        if calm > 2 * _WINDOW and change < 3e-3 and swing < PASSES_STEADY * factor:
            # averaging creeps: the normal forces still trade places, the factor no longer moves
            settled, moved = True, swing / factor
        if not settled and not without and not model.dilates and change < 0.3 and (calm < 4 or calm % 4 == 0):
            state = settled_limit_state(model, velocity, 1.0 / factor, normal_force, bond)
        if settled or state is not None or without or calm >= _STAGE_PASSES:
            at = velocity if state is None else state.velocity
            renewed, releases = release(model, at, tan_dilation, bond, releases)
            if (renewed == bond).all():
                if without:
                    return Limit(Outcome.NO_STRENGTH, None, unit(velocity), normal_force, bond, count, 0.0)
                if state is not None:
                    return exact_limit(state, bond, count)
                if settled:
                    return Limit(
                        Outcome.SLIDES, factor, unit(velocity), normal_force, bond, count, moved,
                        *_carried(mechanism),
                    )  # fmt: skip
            else:
                if state is not None:
                    normal_force = np.maximum(state.normal_force, 0.0)
                bond = renewed
                friction = bond * model.cohesion + rest * normal_force
                last, calm, quiet, weight = None, 0, 0, 1.0
                continue
        if last is not None:
            weight = _next_weight(weight, last, excess, calm) if count < STEERED else _DAMPED_STEP
        last = excess
        friction = np.maximum(friction + weight * excess, 0.0)
    lowest, highest = min(recent), max(recent)
    if lowest > EQUILIBRIUM and (bond == 0.0).any():
        # what opens and what holds keep trading places: the lowest factor they came to, and how far they swing
        return Limit(
            Outcome.SLIDES, lowest, unit(velocity), normal_force, bond, count, 1.0 - lowest / highest,
            *_carried(mechanism),
        )  # fmt: skip
    return Limit(Outcome.NOT_CONVERGED, None, unit(velocity), normal_force, bond, count, change)


def _next_weight(weight: float, last: Floats, excess: Floats, calm: int) -> float:
    """How much of the excess the next pass takes, by this one's and the last one's: Aitken's for the first passes."""
    if calm > _WINDOW:  # feel the way: longer steps while they agree, shorter where they turn about
        return min(max(weight * (1.5 if float(last @ excess) > 0.0 else 0.5), 0.02), 5.0)
    turn = excess - last
    weight = -weight * float(last @ turn) / max(float(turn @ turn), TINY)
    return min(max(weight, 0.1), 20.0) if weight > 0.0 else 0.5


def exact_limit(state: LimitState, bond: Floats, passes: int) -> Limit:
    normal = np.maximum(state.normal_force, 0.0)
    return Limit(
        Outcome.SLIDES, 1.0 / state.reduction, state.velocity, normal, bond, passes, 0.0, state.forces[:, 1:],
        state.pulls,
    )  # fmt: skip


def _carried(mechanism: "LeastWorkMechanism") -> tuple[Floats, Floats]:
    """Friction and bolt pulls of a pass: those of its program balance the load times its load factor."""
    return mechanism.friction_force / mechanism.load_factor, mechanism.bolt_pull / mechanism.load_factor


def release(
    model: Model, velocity: Floats, tan_dilation: Floats, bond: Floats, releases: Floats
) -> tuple[Floats, Floats]:
    """Bonds after a pass: gone where the mechanism opens a pair beyond its dilation, back where it is closed again."""
    renewed = np.where(opens(model, velocity, tan_dilation) | (releases >= MOST_RELEASES), 0.0, 1.0)
    return renewed, releases + ((bond > 0.0) & (renewed == 0.0))


def opens(model: Model, velocity: Floats, tan_dilation: Floats) -> Bools:
    """Which pairs a motion opens beyond their dilation, (n,)."""
    motion = model.relative(velocity)
    opening, slip = motion[:, 0], np.sqrt((motion[:, 1:] * motion[:, 1:]).sum(axis=1))
    beyond: Bools = opening - tan_dilation * slip > OPENS_IN_PASSES * max(float(slip.max()), float(opening.max()))
    return beyond


def unit(vector: Floats) -> Floats:
    return vector / math.sqrt(float(vector @ vector))
