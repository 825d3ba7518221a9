"""The limit of one block on its node pairs: an assembly of one block, on the elastic path of all assemblies.

It is the answer on a curved surface, on which a block may slide only if it turns.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.path import START, trace_limit
from slopekit.preie.elastic_path.path_limit import PathOutcome
from slopekit.preie.one_block.intact_limit import intact_limit
from slopekit.preie.one_block.limit import LimitAnalysis
from slopekit.preie.outcome import Limit, Outcome, opens, unit
from slopekit.preie.solvers.linear import non_negative_least_squares
from slopekit.preie.solvers.work_limit import UNITS_PER_SECOND, WorkSpentError, work_budget
from slopekit.preie.system.assembly import one_block
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import NO_FORCE
from slopekit.strength.mohr_coulomb import line

_MOST_PARTED = 2  # partings after which a bond is lost for good; with 1 some factors change by 20 %
_WORK = 60.0 * UNITS_PER_SECOND  # of one path: of 9,000 node pairs one takes 5 s


def pairs_limit(model: Model) -> LimitAnalysis:
    """Return the limit of one block on its node pairs: the end of the elastic path of an assembly of one block.

    A pair that the motion opens, beyond what its slip does, has parted: it has no cohesion. There are no forces alone
    to compare with: `moments_govern` is false.
    """
    limit = _bonded_limit(model)
    if model.lines is not None and limit.factor:
        from slopekit.preie.system.strength_lines import with_secants  # only curved laws pay for it

        model = with_secants(model, limit.normal_force)
    return LimitAnalysis(limit, limit, limit, False, None if model.lines is None else model)


def _bonded_limit(model: Model) -> Limit:
    """Return the exact limit with every pair pressed, or that of the elastic path without the bonds that it breaks.

    A pair that closes again regains its cohesion once; one that parts twice has lost it.
    """
    none, bond = np.zeros(model.unknowns), np.ones(len(model.control_area))
    if (
        float((model.normal_rows @ model.load).min()) > 0.0
    ):  # the load itself lifts the block off every pair
        return Limit(Outcome.LIFTED, None, none, 0.0 * bond, 0.0 * bond, 0, 0.0)
    _, rest = non_negative_least_squares(model.normal_rows.T, -model.load)
    if float(np.abs(rest).max()) < NO_FORCE:
        return Limit(Outcome.NO_DRIVING_FORCE, None, none, 0.0 * bond, bond, 0, 0.0)
    displacement = elastic_displacement(model)
    intact = intact_limit(model, displacement)
    if intact is not None:
        return intact
    steps, partings = 0, np.zeros(len(bond))
    while True:  # a bond changes three times at most
        limit = _elastic_path_limit(model, bond * model.cohesion, displacement)
        steps += limit.steps
        dilation = np.minimum(model.tan_dilation, model.tan_friction / (limit.factor or math.inf))
        parted = opens(model, limit.velocity, dilation) & (model.cohesion > 0.0)
        partings += parted & (bond > 0.0)
        renewed = np.where(parted | (partings >= _MOST_PARTED), 0.0, 1.0)
        if limit.factor is None or (renewed == bond).all():
            return replace(limit, bond=bond, steps=steps)
        bond = renewed


def _elastic_path_limit(model: Model, cohesion: Floats, displacement: Floats) -> Limit:
    """Return the limit of the elastic path of one block with the remaining cohesion (n,) of its node pairs."""
    pairs = len(cohesion)
    normal = np.maximum(-model.control_area * (model.normal_rows @ displacement), 0.0)
    strength = float(line(cohesion, model.tan_friction, normal).sum() + model.bolt_capacity.sum())
    if strength < NO_FORCE:
        return Limit(Outcome.NO_STRENGTH, None, unit(displacement), normal, np.ones(pairs), 0, 0.0)
    assembly = one_block(replace(model, cohesion=cohesion))
    try:
        with work_budget(_WORK):
            end = trace_limit(
                ElasticContactModel(assembly, Drive(assembly.load.ravel())), START / strength
            )
    except WorkSpentError:
        return Limit(
            Outcome.NOT_CONVERGED, None, unit(displacement), normal, np.ones(pairs), 0, 0.0
        )
    outcome, factor, change = Outcome.SLIDES, None, 0.0
    if end.outcome is PathOutcome.NO_REST:
        outcome = Outcome.NO_STRENGTH
    elif end.outcome is PathOutcome.STANDS:
        outcome = Outcome.NO_DRIVING_FORCE
    elif end.parameter is None or end.outcome is PathOutcome.GAVE_UP:
        outcome = Outcome.NOT_CONVERGED
    else:
        factor = 1.0 / end.parameter
        change = 0.0 if end.is_limit or end.peak is None else abs(end.peak[0] / end.peak[1] - 1.0)
    friction = end.friction[:pairs]
    if friction.shape[1] == 1:  # in a section it acts along one of the two tangents
        friction = friction * (np.abs(model.rows[:, 1:]).max(axis=2) > 0.0)
    motion = end.motion if end.motion.any() else displacement
    return Limit(
        outcome,
        factor,
        unit(motion),
        np.maximum(end.normal[:pairs], 0.0),
        np.ones(pairs),
        end.factorisations,
        change,
        friction,
        end.friction[pairs:, 0],
    )


def elastic_displacement(model: Model) -> Floats:
    """Return the displacement (u,) under the load with every pair bonded, springs of stiffness a in all directions."""
    stiffness = model.flat_rows.T @ (np.repeat(model.control_area, 3)[:, None] * model.flat_rows)
    # a sheet a thousand million times as long as thick has no stiffness against turning
    return np.asarray(np.linalg.lstsq(stiffness, model.load, rcond=None)[0], dtype=np.float64)
