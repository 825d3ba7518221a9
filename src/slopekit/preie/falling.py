"""What falling strength does to cohesive contacts: blocks at rest, a little less strength, and at rest again.

A contact that no node pair presses as the blocks rest on their elastic joints has lost its cohesion from then on; they
come to rest again at the same strength, or run. The same with a load that grows.
"""

import math

import numpy as np

from slopekit.core.arrays import Bools
from slopekit.core.records import dataclass
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.bed import Bed, Drive
from slopekit.preie.flow import THICK, Flow, relaxed
from slopekit.preie.path import ROUGHER, at_rest_first, at_rest_next
from slopekit.preie.tolerances import FARTHEST, FLOWS, LEAST_STRENGTH, RUNS

_STRIDE = 0.95  # of the strength, a step
NEAR_RUNNING = 3e-3  # how near the last rest comes to where the blocks run


@dataclass(frozen=True, slots=True)
class Fallen:
    """How a history ended.

    Attributes
    ----------
    gone : (k,) contacts that have lost their cohesion, as they were open all over at rest
    parameter, runs : of the last rest, and the first at which the blocks do not come to rest; None where they always do
    broken : (k,) all contacts that had lost their cohesion when they ran; opens : that they opened then
    rest : the last; flow : how they ran
    """

    gone: Bools
    parameter: float
    runs: float | None
    broken: Bools
    opens: Bools
    rest: Flow
    flow: Flow


def fallen(model: AssemblyModel, drive: Drive, ratio: float, start: float, lost: Bools) -> Fallen | None:
    """The history from a parameter on of blocks whose contacts `lost` (k,) have no cohesion.

    None where they rest at no such strength.

    Raises
    ------
    EffortSpentError
        The work that is allowed is done.
    """
    joints = model.joint_pairs  # a bolt has no pair that could be pressed
    bonded = np.bincount(model.pair_contact[joints], model.cohesion[joints], len(lost)) > 0.0

    def bed(gone: Bools) -> Bed:
        return Bed(model, drive, np.where((lost | gone)[model.pair_contact], 0.0, 1.0), ratio)

    def touching(flow: Flow) -> Bools:
        """Contacts (k,) that any pair presses."""
        some: Bools = np.bincount(model.pair_contact, flow.forces.touching, len(lost)) > 0
        return some

    def settled(flow: Flow, parameter: float, gone: Bools) -> tuple[Flow, Bools]:
        """From a rest with some bonds to one that leaves no others open all over, or running."""
        while flow.ended == "rest":
            opens = bonded & ~lost & ~gone & ~touching(flow)
            if not opens.any():
                break
            gone = gone | opens
            flow = _next(bed(gone), flow, parameter)
        return flow, gone

    none = np.zeros_like(lost)
    for _ in range(ROUGHER + 1):
        _, flow = at_rest_first(bed(none), start, 0)
        gone = none
        if flow.ended == "rest":
            flow, gone = settled(flow, start, none)
        if flow.ended == "rest":
            break
        if drive.ramp is not None:
            return None
        start *= 2.0  # less breaks where joints are stronger
    else:
        return None
    parameter, step = start, _STRIDE
    while True:
        trial = drive.harder(parameter, step)
        found, left = settled(_next(bed(gone), flow, trial), trial, gone)
        if found.ended == "rest":
            parameter, flow, gone = trial, found, left
            if parameter < LEAST_STRENGTH * start if drive.ramp is None else parameter > FARTHEST:
                return Fallen(gone, parameter, None, gone, none, flow, flow)
        elif 1.0 - step < NEAR_RUNNING:
            return Fallen(gone, parameter, trial, left, _opened(model, found), flow, found)
        else:
            step = math.sqrt(step)


def _next(bed: Bed, flow: Flow, parameter: float) -> Flow:
    """From a rest on, until the blocks rest or run."""
    tried = at_rest_next(bed, flow.at, parameter)
    if tried.ended in ("rest", "runs"):
        return tried
    return relaxed(bed, tried.at, parameter, max(tried.viscosity, THICK), runs_at=RUNS)


def _opened(model: AssemblyModel, flow: Flow) -> Bools:
    """Contacts (k,) that blocks open as they run."""
    opening, slip = model.opening_and_slip(flow.at - flow.before)
    fastest = max(float(np.abs(opening).max()), float(np.sqrt((slip * slip).sum(axis=1)).max()))
    opens: Bools = np.bincount(model.pair_contact, opening > FLOWS * fastest, len(model.plus)) > 0
    return opens
