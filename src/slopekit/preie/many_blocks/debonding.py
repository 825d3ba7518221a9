"""Progressive slip and debonding: the limit of blocks whose slip stays, and whose contacts stay open once they opened.

Gravity comes on while the joints stick. The strength falls step by step; at each rest joints keep the slip beyond their
elastic one, and cohesive contacts that nothing presses have lost their cohesion from there on (docs/method.md).
"""

import math

import numpy as np

from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.flow import THICK, Flow, viscous_relaxation
from slopekit.preie.elastic_path.path import (
    MAX_DOUBLINGS,
    START,
    first_equilibrium,
    next_equilibrium,
)
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import LEAST_STRENGTH, RUNS

_STUCK = 32.0  # times the strength of a path's start, where hardly anything slips
_STRIDE, _NARROWEST = 0.05, 0.05 / 16.0  # of ln λ, the longest and the shortest step


def debonding_limit(model: AssemblyModel, limit: float) -> tuple[float, float | None] | None:
    """Return the last stable and the first unstable factor with progressive slip and debonding.

    The second is None where the blocks come neither to rest nor to run. None where they rest at no strength to begin
    with, or stand without any.

    Parameters
    ----------
    limit : the factor of safety of the path

    Raises
    ------
    WorkSpentError
        The work that is allowed is done.
    """
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    strength, flow = first_equilibrium(bed, _STUCK * START / limit, MAX_DOUBLINGS)
    if flow.ended != "rest":
        return None
    begun, stride = strength, _STRIDE
    bed = _with_history_of(bed, flow)
    while strength > LEAST_STRENGTH * begun:
        trial = strength * math.exp(-stride)
        tried = next_equilibrium(bed, flow.displacement, trial)
        if tried.ended not in ("rest", "runs"):
            tried = viscous_relaxation(
                bed, tried.displacement, trial, max(tried.viscosity, THICK), runs_at=RUNS
            )
        if tried.ended == "rest":
            strength, flow = trial, tried
            bed = _with_history_of(bed, flow)
        elif stride > _NARROWEST:
            stride *= 0.5
        else:
            return 1.0 / strength, 1.0 / trial if tried.ended == "runs" else None
    return None


def _with_history_of(bed: ElasticContactModel, flow: Flow) -> ElasticContactModel:
    """Return the contact model with the slip and the lost cohesion of a state at rest."""
    bed = bed.with_plastic_slip(flow.displacement, flow.forces)
    pressed = flow.forces.pressed
    if pressed is None:
        return bed
    opened = np.bincount(bed.model.group_contact, pressed.share, bed.contacts) == 0.0
    return bed.without_cohesion_where(
        opened if bed.have_opened is None else np.logical_or(opened, bed.have_opened)
    )
