"""The limit of the motion with which cohesive blocks run whose strength falls.

Gravity comes on while the joints stick. The strength falls, the blocks come to rest again each time, and a contact that
no node pair presses then has lost its cohesion from there on; they come to rest once more without it, or run. The same
with a load that grows.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.flow import THICK, Flow, relaxed
from slopekit.preie.elastic_path.path import ROUGHER, Ran, at_rest_first, at_rest_next, follow
from slopekit.preie.elastic_path.path_limit import MANY, PathLimit, PathOutcome, result_of
from slopekit.preie.tolerances import FARTHEST, LEAST_STRENGTH, LIMIT_BALANCED, RUNS

# Counts are of the random benches 1 to 140 with 5 kPa, of which 104 have a factor.
# Times the strength of a path's start, where hardly anything slips. With 64 seven of the first 35 move, five of them by
# less than a thousandth, one from 0.645 to 0.464 (3: what it opens does two thirds of its work); less leaves bonds
# whole that histories break.
_STUCK = 32.0
_STRIDE = 0.05  # of ln λ, a step: in longer ones contacts open and touch again
NEAR_RUNNING = _STRIDE / 16.0  # how near the last rest comes to where the blocks run
# How far from there the limit of the motion may lie in space: with 0.01 the peak stands for the limit of two benches,
# without an end one has the limit of another motion (bench 50: 1.96 for 2.44); of the first 35 from 0.03 to 0.3 none
# moves.
_DROPS = 0.1


def fall(bed: Bed, start: float, brief: bool = False) -> PathLimit:
    """The limit of the path with the bonds that are left where the blocks run: no farther than there.

    Parameters
    ----------
    start, brief : of the path (`elastic_path.path.follow`), which is followed without a history where none begins

    Raises
    ------
    WorkSpentError
        The work that is allowed is done.
    """
    if brief and at_rest_first(bed, start, 0)[1].ended != "rest":
        return follow(bed, start, brief)
    begun = _begun(bed, start * _STUCK if bed.drive.ramp is None else start)
    if begun is None:
        return follow(bed, start, brief)
    left, parameter, flow = begun
    if flow.ended != "rest":  # what held them was cohesion of contacts that do not touch
        moved = flow.at - flow.before
        return replace(result_of(left, PathOutcome.NO_REST, None, None, flow.at, moved, flow.forces), started=start)
    left, ran, snaps = _fallen(left, parameter, flow)
    if ran.flow.ended == "rest":
        stands = result_of(left, PathOutcome.STANDS, None, None, ran.flow.at, ran.flow.at, ran.flow.forces)
        return replace(stands, started=start)
    ended = follow(left, start, brief or bed.size > MANY, ran)
    bed.factorisations = left.factorisations
    if not _is_there(left, ran, ended, snaps):
        moved = ran.flow.at - ran.flow.before
        peak = ran.parameter, ran.bad
        ended = result_of(left, PathOutcome.BRACKET, ran.parameter, peak, ran.rest.at, moved, ran.rest.forces)
    return replace(ended, started=start)


def history(bed: Bed, start: float) -> tuple[float, float | None] | None:
    """The last parameter at rest and the first at which blocks run whose slip stays.

    Joints spring back by their elastic slip alone, from rest to rest, where on a path they do by all of it: another law
    on the way, the same at the limit of one motion. The second is None where the blocks come neither to rest nor to
    run; both where they rest at no strength to begin with, or stand without any.

    Parameters
    ----------
    start : the parameter at which gravity, or the first load, comes on: of strength, of a path, as in `fall`

    Raises
    ------
    WorkSpentError
        The work that is allowed is done.
    """
    begun = _begun(bed, start * _STUCK if bed.drive.ramp is None else start)
    if begun is None or begun[2].ended != "rest":
        return None
    _, ran, _ = _fallen(*begun, stays=True)
    if ran.flow.ended == "rest":
        return None
    return ran.parameter, ran.bad if ran.flow.ended == "runs" else None


def _is_there(bed: Bed, ran: Ran, ended: PathLimit, snaps: bool) -> bool:
    """Whether a limit or a peak is no farther than where the blocks run, and a limit needs no pair that pulls.

    Farther on, as where blocks under a load that grows have snapped to another rest, bonds would break that the path
    leaves whole. Nor is a limit nearer, where bonds broke as they ran (`snaps`): without those the blocks would have
    run before. Nor far nearer in space, where a flow that goes on leads to another motion, as that of blocks without
    any cohesion.
    """
    if ended.parameter is None:
        return False  # stands
    past = bed.drive.gap(ended.parameter, ran.bad) - 1.0
    if not ended.found:
        return past >= -NEAR_RUNNING
    _, load = bed.drive.at(ended.parameter)
    model = replace(bed.model, load=load.reshape(bed.model.load.shape))
    off = model.unbalanced(np.maximum(ended.normal, 0.0), ended.friction)
    drops = NEAR_RUNNING if snaps else _DROPS if bed.tangents > 1 else math.inf
    return -NEAR_RUNNING <= past <= drops and float(np.abs(off).max()) < LIMIT_BALANCED


def _begun(bed: Bed, start: float) -> tuple[Bed, float, Flow] | None:
    """The joints, the parameter and the flow that a history begins with; None where they rest at none with all bonds.

    Contacts that are open all over at that rest have lost their bonds. Where the blocks run without them, the history
    begins at more strength, until they rest so too, or at none.
    """
    parameter, flow = at_rest_first(bed, start, ROUGHER)
    if flow.ended != "rest":
        return None
    bed, flow = _broken(bed, flow, parameter)
    for _ in range(ROUGHER if bed.drive.ramp is None else 0):
        if flow.ended == "rest":
            break
        parameter, flow = at_rest_first(bed, 2.0 * parameter, 0)
        bed, flow = _broken(bed, flow, parameter)
    return bed, parameter, flow


def _fallen(bed: Bed, parameter: float, flow: Flow, stays: bool = False) -> tuple[Bed, Ran, bool]:
    """The joints as they are where the blocks run, or stand without strength, and whether bonds broke as they ran.

    Parameters
    ----------
    parameter, flow : at rest to begin with, no bond left on contacts that are open all over
    stays : slip is there to stay
    """
    start = parameter
    bed = bed.with_slip_of(flow.at, flow.forces) if stays else bed
    stride = _STRIDE
    while True:
        trial = bed.drive.harder(parameter, math.exp(-stride))
        left, found = _broken(bed, _next(bed, flow, trial), trial)
        if found.ended != "rest":
            if stride <= NEAR_RUNNING:
                return left, Ran(parameter, flow, trial, found), left is not bed
            stride *= 0.5
            continue
        parameter, flow = trial, found
        bed = left.with_slip_of(flow.at, flow.forces) if stays else left
        if parameter < LEAST_STRENGTH * start if bed.drive.ramp is None else parameter > FARTHEST:
            return bed, Ran(parameter, flow, parameter, flow), False


def open_all_over(bed: Bed, flow: Flow) -> Floats | None:
    """The bonds (m,) that are left at a rest, where those of contacts that no pair presses go; None where none do."""
    contact = bed.model.pair_contact
    opens = _bonded(bed) & (np.bincount(contact, flow.forces.touching, bed.contacts) == 0)
    return np.where(opens[contact], 0.0, bed.bond) if (opens[contact] & (bed.bond > 0.0)).any() else None


def _bonded(bed: Bed) -> Bools:
    """Contacts (k,) that can lose their bond; a bolt has no pair that could be pressed."""
    joints = bed.model.joint_pairs
    bonded: Bools = np.bincount(bed.model.pair_contact[joints], bed.model.cohesion[joints], bed.contacts) > 0.0
    return bonded


def _broken(bed: Bed, flow: Flow, parameter: float) -> tuple[Bed, Flow]:
    """From a rest to one that leaves no bond on contacts that are open all over, or running."""
    while flow.ended == "rest" and (left := open_all_over(bed, flow)) is not None:
        bed = bed.with_bonds(left)
        flow = _next(bed, flow, parameter)
    return bed, flow


def _next(bed: Bed, flow: Flow, parameter: float) -> Flow:
    """From a rest on, until the blocks rest or run."""
    tried = at_rest_next(bed, flow.at, parameter)
    if tried.ended in ("rest", "runs"):
        return tried
    return relaxed(bed, tried.at, parameter, max(tried.viscosity, THICK), runs_at=RUNS)
