"""The limit of one block on its node pairs: an assembly of one block, on the elastic path of all assemblies.

On a curved surface, where without turning nothing may slide, it is the answer; on flat joints that dilate it is where
all of them stay pressed.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.path import START, follow
from slopekit.preie.elastic_path.path_limit import PathOutcome
from slopekit.preie.one_block.limit import LimitAnalysis, stands_without_strength
from slopekit.preie.outcome import Limit, Outcome, opens, unit
from slopekit.preie.system.assembly import one_block
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import NO_FORCE
from slopekit.strength.mohr_coulomb import line


def pressed_limit(model: Model) -> Limit | None:
    """Return the limit on node pairs where all of them stay pressed, with the dilation given; None where some open."""
    limit = limit_on_pairs(model).governing
    return limit if limit.factor and bool((limit.normal_force > 0.0).all() and limit.bond.all()) else None


def limit_on_pairs(model: Model) -> LimitAnalysis:
    """Return the limit of one block on its node pairs: the end of the elastic path of an assembly of one block.

    A pair that the motion opens, beyond what its slip does, has parted: it has no cohesion. There are no forces alone
    to compare with: `moments_govern` is false.
    """
    limit = _limit_of_pairs(model)
    if model.lines is not None and limit.factor:
        from slopekit.preie.system.strength_lines import drawn  # only curved laws pay for it

        model = drawn(model, limit.normal_force)
    return LimitAnalysis(limit, limit, limit, False, None if model.lines is None else model)


def _limit_of_pairs(model: Model) -> Limit:
    none, bond = np.zeros(model.unknowns), np.ones(len(model.control_area))
    if float((model.normal_rows @ model.load).min()) > 0.0:  # the load itself moves it off every pair
        return Limit(Outcome.LIFTED, None, none, 0.0 * bond, 0.0 * bond, 0, 0.0)
    if stands_without_strength(model):
        return Limit(Outcome.NO_DRIVING_FORCE, None, none, 0.0 * bond, bond, 0, 0.0)
    normal = np.maximum(-model.control_area * (model.normal_rows @ elastic_displacement(model)), 0.0)
    steps = 0
    while True:
        cohesion = bond * model.cohesion
        strength = float(line(cohesion, model.tan_friction, normal).sum() + model.bolt_capacity.sum())
        if strength < NO_FORCE:
            return Limit(Outcome.NO_STRENGTH, None, unit(model.load), normal, bond, steps, 0.0)
        limit = _path_end(replace(model, cohesion=cohesion), START / strength)
        steps += limit.steps
        parted = (model.cohesion > 0.0) & (bond > 0.0) & opens(model, limit.velocity, _dilation(model, limit.factor))
        if limit.factor is None or not parted.any():
            return replace(limit, bond=bond, steps=steps)
        bond = np.where(parted, 0.0, bond)


def _dilation(model: Model, factor: float | None) -> Floats:
    """Return tan of the dilation angles (n,): no more than the friction angle that is left."""
    return np.minimum(model.tan_dilation, model.tan_friction / (factor or math.inf))


def _path_end(model: Model, start: float) -> Limit:
    """Return the limit of the elastic path of one block from a strength λ downwards."""
    assembly = one_block(model)
    end = follow(Bed(assembly, Drive(assembly.load.ravel())), start)
    pairs = len(model.control_area)
    outcome, factor, change = Outcome.SLIDES, None, 0.0
    if end.outcome is PathOutcome.NO_REST:
        outcome = Outcome.NO_STRENGTH
    elif end.outcome is PathOutcome.STANDS:
        outcome = Outcome.NO_DRIVING_FORCE
    elif end.parameter is None or end.outcome is PathOutcome.GAVE_UP:
        outcome = Outcome.NOT_CONVERGED
    else:
        factor = 1.0 / end.parameter
        change = 0.0 if end.found or end.peak is None else abs(end.peak[0] / end.peak[1] - 1.0)
    friction = end.friction[:pairs]
    if friction.shape[1] == 1:  # in a section it acts along one of the two tangents
        friction = friction * (np.abs(model.rows[:, 1:]).max(axis=2) > 0.0)
    return Limit(
        outcome, factor, unit(end.motion), np.maximum(end.normal[:pairs], 0.0), np.ones(pairs), end.factorisations,
        change, friction, end.friction[pairs:, 0],
    )  # fmt: skip


def elastic_displacement(model: Model) -> Floats:
    """Return the displacement (u,) under the load with every pair bonded, springs of stiffness a in all directions."""
    stiffness = model.flat_rows.T @ (np.repeat(model.control_area, 3)[:, None] * model.flat_rows)
    # a sheet a thousand million times as long as thick has no stiffness against turning
    return np.asarray(np.linalg.lstsq(stiffness, model.load)[0], dtype=np.float64)
