"""Loads that come on last: weight and water first, the others after them, at one strength after the other.

F is where they just all fit on, exactly, with the modes found there. Where they fit on at no strength there is none,
but the part of them that full strength carries, and the motion that tips the blocks whatever the friction, if one does.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.bed import Bed, Drive
from slopekit.preie.bound import StaticBound
from slopekit.preie.flow import relaxed
from slopekit.preie.path import follow
from slopekit.preie.path_limit import PathLimit, PathOutcome, limit_state
from slopekit.preie.tolerances import ADMISSIBLE, LIMIT_BALANCED, LOADS_BRACKET, LOADS_FIT, NO_MOTION

FIRST_LOAD = 1e-3  # part of the loads beside weight to begin with
STRONGER = (1.05, 1.5, 2.5, 5.0, 10.0)  # times the strength of the static bound, at which the loads may fit on
_SCANNED = 16  # strengths up to the last, at which they have to fit on too, or may
_COMES_ON = (0.0, 0.25, 0.5, 0.75, 0.9, 1.0)  # parts of those loads, one after the other, at the strength that holds
_UNKNOWN = 2.0  # the static bound to go by where none is known


@dataclass(frozen=True, slots=True)
class LoadsOn:
    """How the loads beside weight and water came on: `loads_last`, `carried`, `tips` and `begun` of a limit."""

    last: bool = False
    carried: float | None = None
    tips: tuple[float, float] | None = None
    begun: float | None = None


def loads_last(
    model: AssemblyModel, unit: float, bond: Floats, bound: StaticBound, ratio: float
) -> tuple[PathLimit, LoadsOn, int]:
    """F where the loads beside weight and water, coming on last, all fit on; no rest where they do at no strength.

    A motion at a part of them that slips nowhere is a limit state at any greater strength: there they may fit on, or
    not, as it comes, and where the search does not end in a limit they do not.

    Returns
    -------
    limit (its parameter is λ), with what full strength carries and what tips where they fit on at none; factorisations
    """
    whole, live = model.load.ravel(), model.live.ravel()
    work, tip = 0, None

    def loaded(reduction: float) -> PathLimit:
        nonlocal work
        bed = Bed(model, Drive(whole - live, live, reduction), bond, ratio)
        overloaded = follow(bed, FIRST_LOAD)
        work += bed.factorisations
        return overloaded

    def carried(reduction: float) -> PathLimit:
        nonlocal tip
        overloaded = loaded(reduction)
        if _tips(model, overloaded) and (tip is None or reduction < tip.reduction):
            tip = overloaded
        return overloaded

    def without_rest(overloaded: PathLimit, full: PathLimit) -> tuple[PathLimit, LoadsOn, int]:
        """No rest, what full strength carries, and the motion that tips the blocks where there is one."""
        at = None if tip is None else (float(tip.parameter or 0.0), 1.0 / tip.reduction)
        none = replace(tip or overloaded, outcome=PathOutcome.NO_REST, parameter=None)
        return none, LoadsOn(True, full.parameter, at), work

    def exact(path_end: PathLimit, reduction: float) -> PathLimit | None:
        """The limit state in λ, at the whole load, of the modes of one in the load."""
        if not path_end.found or abs((path_end.parameter or 0.0) - 1.0) > LOADS_FIT:
            return None
        bed = Bed(model, Drive(whole), bond, ratio)
        return limit_state(bed, path_end.displacement, path_end.motion, reduction)

    def fits_on(path_end: PathLimit) -> bool:
        return path_end.outcome is PathOutcome.STANDS or (path_end.parameter or 0.0) >= 1.0

    def come_on(path_end: PathLimit) -> bool:
        return fits_on(path_end) or (path_end.peak is not None and path_end.peak[0] >= 1.0)

    def narrowed(holds: float, fails: float, held: Callable[[PathLimit], bool]) -> tuple[float, float]:
        """Strengths λ at which the loads are held and not, next to each other."""
        while holds / fails - 1.0 > LOADS_BRACKET:
            middle = math.sqrt(holds * fails)
            holds, fails = (middle, fails) if held(carried(middle)) else (holds, middle)
        return holds, fails

    least = 1.0 / (bound.factor or _UNKNOWN)  # below the strength of the static bound nothing fits on
    fails, fits = least, None
    overloaded: PathLimit | None = None
    for times in STRONGER:
        last = carried(times * least)
        if fits_on(last):
            fits = times * least
            break
        fails, overloaded = times * least, last
    if fits is None:
        assert overloaded is not None
        return without_rest(overloaded, loaded(unit))
    while fits / fails - 1.0 > LOADS_BRACKET:
        state = None if overloaded is None else exact(overloaded, fails)
        if state is not None and fails * (1.0 - 1e-9) <= (state.parameter or 0.0) <= fits * (1.0 + 1e-9):
            return state, LoadsOn(True), work
        middle = math.sqrt(fits * fails)
        trial = carried(middle)
        if fits_on(trial):
            fits, last = middle, trial
        else:
            fails, overloaded = middle, trial
    # where blocks snap from rest to rest the loads may fit on, not fit on at more strength, and fit on again; and they
    # may all be on, the blocks at rest, where less than all of them makes them run on
    reached, stride = fits, STRONGER[-1] ** (1.0 / _SCANNED)
    tried = [(more := least * stride**part, carried(more)) for part in range(1, _SCANNED + 1)]
    below = [more for more, trial in tried if more < reached and come_on(trial)]
    above = [one for one in tried[:-1] if one[0] > fits and one[1].parameter is not None and not fits_on(one[1])]
    less = below[0] / stride if below else fails / stride
    reached = narrowed(below[0] if below else fails if come_on(carried(fails)) else fits, less, come_on)[0]
    if above:
        fails, overloaded = above[-1]
        fits, fails = narrowed(fails * stride, fails, fits_on)
    # the mechanism changes there: the loads fit on at `fits`, where the blocks are at rest under all of them
    bed = Bed(model, Drive(whole), bond, ratio)
    at = Bed(model, Drive(whole - live, live, fits), bond, ratio)
    rested = at.elastic_displacement
    for share in _COMES_ON:
        flow = relaxed(at, rested, share, 0.0)
        if flow.ended != "rest":
            break
        rested = flow.at
    forces = bed.forces(rested, fits)
    settled = forces.residual < LIMIT_BALANCED * bed.load_size
    if not settled and tip is not None and not fits_on(full := loaded(unit)):
        return without_rest(overloaded or last, full)
    outcome = PathOutcome.BRACKET if settled else PathOutcome.GAVE_UP
    peak = replace(
        overloaded or last, outcome=outcome, parameter=fits, peak=(fits, fails), normal=forces.normal,
        friction=forces.friction, residual=forces.residual / bed.load_size, reached=reached,
    )  # fmt: skip
    return peak, LoadsOn(True), work


def _tips(model: AssemblyModel, overloaded: PathLimit) -> bool:
    """Whether blocks under a part of the loads move without slip where forces act: no strength hinders that."""
    if overloaded.outcome is not PathOutcome.LIMIT or not 0.0 < (overloaded.parameter or 0.0) < 1.0:
        return False
    opening, slip = model.opening_and_slip(overloaded.motion)
    size = np.sqrt((slip * slip).sum(axis=1))
    forces = model.by_group(np.abs(overloaded.normal)) + np.abs(overloaded.friction).sum(axis=1)
    acts = forces > ADMISSIBLE * float(np.abs(model.load).max())
    return bool(size[acts].max(initial=0.0) < NO_MOTION * max(float(np.abs(opening).max()), float(size.max())))
