"""Movements as results have them: displacements at strength reduction factors, mechanisms in true proportions."""

import math
from collections.abc import Sequence

from slopekit.arrays import Floats, frozen
from slopekit.preie.contact import JointStiffness
from slopekit.preie.equilibrium import Equilibrium, equilibrium
from slopekit.preie.model import Model
from slopekit.preie.passes import Limit, Outcome
from slopekit.result import Movement, ReductionStep


def series_of(
    model: Model, factors: Sequence[float], stiffness: JointStiffness, bound: float | None
) -> tuple[ReductionStep, ...]:
    """Rest at each factor, from one to the next; above the static bound there is none to look for."""
    steps: list[ReductionStep] = []
    standing: Equilibrium | None = None
    count = len(model.control_area)
    for factor in factors:
        if bound is not None and factor > bound * (1.0 + 1e-7):
            steps.append(ReductionStep(factor, False, None, count))
            continue
        state = equilibrium(model, factor, stiffness, standing)
        if state.stands:
            standing = state
        movement = movement_of(model, state.displacement) if state.stands else None
        steps.append(ReductionStep(factor, state.stands, movement, state.failed_pairs if state.stands else count))
    return tuple(steps)


def movement_of(model: Model, displacement: Floats) -> Movement:
    """A displacement (u,) of the model in m and radians."""
    translation, rotation = model.moved(displacement)
    return Movement(frozen(translation), frozen(rotation))


def turned_back(movement: Movement, turn: Floats | None) -> Movement:
    """A movement in the user's axes."""
    if turn is None:
        return movement
    return Movement(frozen(movement.displacement @ turn), frozen(movement.rotation @ turn))


def turned(movement: Movement | None, turn: Floats | None) -> Movement | None:
    """The same, where there is one."""
    return None if movement is None else turned_back(movement, turn)


def mechanism_of(limit: Limit, model: Model) -> Movement | None:
    """The mechanism in true proportions: displacement of the centroid in m, rotation in radians, largest size 1."""
    if limit.outcome in (Outcome.NO_DRIVING_FORCE, Outcome.NOT_CONVERGED) or not limit.velocity.any():
        return None
    displacement, rotation = model.moved(limit.velocity_of(model))
    rotation = rotation / model.length_scale
    size = math.sqrt(float(displacement @ displacement)) or model.length_scale * math.sqrt(float(rotation @ rotation))
    return Movement(frozen(displacement / size), frozen(rotation / size))
