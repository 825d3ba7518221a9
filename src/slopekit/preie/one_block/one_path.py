"""The limit of the elastic path of one block where moments govern: which of its limit states is the number.

A block on rigid joints may have several limit states: the same forces balanced on other node pairs, or another motion.
The passes find one of them. Which one an elastic block comes to, from a rest at high strength, is what the path says
(METHOD-3.md §13, `path`): that is the limit, as for many blocks. Where they agree the exact state of the passes stands.
"""

from dataclasses import replace

import numpy as np

from slopekit.core.arrays import frozen
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.path import ROUGHER, START, follow
from slopekit.preie.elastic_path.path_limit import PathOutcome
from slopekit.preie.one_block.limit import LimitAnalysis, governed
from slopekit.preie.one_block.limit_state import settled_limit_state
from slopekit.preie.one_block.passes import Limit, Outcome, exact_limit, unit
from slopekit.preie.programs.bounds import mechanism_range, static_bound
from slopekit.preie.system.assembly import one_block
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import POLISHED, SAME_FACTOR, SAME_LIMIT

STRONGEST = START * 2.0**ROUGHER  # times the strength that is needed is the most that is tried
_RANGED = 400  # node pairs up to which the range of a mechanism is found in a fraction of a second


def by_path(model: Model, analysis: LimitAnalysis) -> LimitAnalysis:
    """The analysis with the limit of the elastic path, where moments govern; the same where the two agree.

    Where the path comes to no end, neither at rest nor in a motion that settles, what the passes found stands: it is
    `without_path`.

    Parameters
    ----------
    model : one block on flat contacts, six unknowns, no dilation
    """
    limit = analysis.governing
    lost = np.isin(model.interface, model.interface[limit.bond == 0.0]) & (limit.outcome is Outcome.NO_STRENGTH)
    held = replace(model, cohesion=frozen(np.where(lost, 0.0, model.cohesion)))
    path_end = path_limit(held, limit.factor)
    if path_end is None or (path_end.factor is None and limit.factor is None):
        return analysis if limit.factor is None else replace(analysis, without_path=True)
    if path_end.factor is None:
        return LimitAnalysis(path_end, analysis.forces_only, path_end, True)
    if limit.factor is not None and abs(path_end.factor / limit.factor - 1.0) < SAME_FACTOR:
        return analysis
    return governed(model, analysis.forces_only, replace(path_end, bond=np.where(lost, 0.0, 1.0), passes=limit.passes))


def path_limit(model: Model, guess: float | None) -> Limit | None:
    """The limit of the path with bonds as they are; without a factor where the block rests at no strength.

    Parameters
    ----------
    guess : a limit factor, none above the static bound; where there is none the bound itself says where to start, and
        what does not rest there is not looked for at more strength
    """
    whole = one_block(model)
    known = guess or static_bound(whole).factor
    if not known:
        return None
    path_end = follow(Bed(whole, Drive(model.load)), START / known, brief=guess is None)
    pairs, bond = len(model.control_area), np.ones(len(model.control_area))
    velocity = unit(path_end.motion)
    if path_end.outcome is PathOutcome.NO_REST:
        return Limit(Outcome.NO_REST, None, velocity, np.zeros(pairs), bond, 0, 0.0)
    if not path_end.found or path_end.parameter is None:
        return None
    normal = np.maximum(path_end.normal[:pairs], 0.0)
    state = settled_limit_state(model, velocity, path_end.parameter, normal, bond)
    if state is not None and abs(state.reduction / path_end.parameter - 1.0) < POLISHED:
        return exact_limit(state, bond, 0)
    change = 0.0 if path_end.outcome is PathOutcome.LIMIT else SAME_LIMIT
    return Limit(
        Outcome.SLIDES, 1.0 / path_end.parameter, velocity, normal, bond, 0, change, path_end.friction[:pairs],
        path_end.friction[pairs:, 0],
    )  # fmt: skip


def range_of(model: Model, limit: Limit) -> tuple[float | None, float | None]:
    """The lowest and highest factor of a limit's mechanism, whatever forces are locked in; none where not found."""
    if not limit.factor or limit.friction is None or limit.pulls is None or len(model.control_area) > _RANGED:
        return None, None
    friction = np.zeros((len(limit.friction) + len(limit.pulls), 2))
    friction[: len(limit.friction)], friction[len(limit.friction) :, 0] = limit.friction, limit.pulls
    bolts = np.ones(len(limit.pulls))
    normal, bond = np.append(limit.normal_force, 0.0 * bolts), np.append(limit.bond, bolts)
    span = mechanism_range(one_block(model), limit.velocity_of(model), limit.factor, bond, (normal, friction))
    if span is None:
        return None, None
    lowest, highest = span
    return min(lowest or 0.0, limit.factor), None if highest is None else max(highest, limit.factor)
