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
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces, Drive
from slopekit.preie.elastic_path.flow import relaxed
from slopekit.preie.elastic_path.path import follow
from slopekit.preie.elastic_path.path_limit import PathLimit, PathOutcome, limit_state
from slopekit.preie.programs.bound import StaticBound
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import ADMISSIBLE, LIMIT_BALANCED, LOADS_BRACKET, LOADS_FIT, NO_MOTION, SAME_LIMIT

FIRST_LOAD = 1e-3  # part of the loads beside weight to begin with
STRONGER = (1.05, 1.5, 2.5, 5.0, 10.0)  # times the strength of the static bound, at which the loads may fit on
_SCANNED = 16  # strengths up to the last, at which they have to fit on too, or may
_COMES_ON = (0.0, 0.25, 0.5, 0.75, 0.9, 1.0)  # parts of those loads, one after the other, at the strength that holds
_UNKNOWN = 2.0  # the static bound to go by where none is known


@dataclass(frozen=True, slots=True)
class LoadsOn:
    """How the loads beside weight and water came on: `loads_last`, `carried`, `tips`, `begun`, `fit_on` of a limit."""

    last: bool = False
    carried: float | None = None
    tips: tuple[float, float] | None = None
    begun: float | None = None
    fit_on: float | None = None


def loads_last(
    model: AssemblyModel, unit: float, bond: Floats, bound: StaticBound, ratio: float
) -> tuple[PathLimit, LoadsOn, int]:
    """F where the loads beside weight and water, coming on last, all fit on; no rest where they do at no strength.

    It is exact where the modes of a limit just below it are those at F. Where other modes come in between, but both
    sides end in limits, it is as fine as a path settles.

    A motion at a part of them that slips nowhere is a limit state at any greater strength: there they may fit on, or
    not, as it comes, and where the search does not end in a limit they do not.

    Returns
    -------
    limit (its parameter is λ), with what full strength carries and what tips where they fit on at none; factorisations
    """
    tried = _Strengths(model, bond, ratio)
    least = 1.0 / (bound.factor or _UNKNOWN)  # below the strength of the static bound nothing fits on
    fails, fits = least, None
    overloaded: PathLimit | None = None
    for times in STRONGER:
        last = tried.carried(times * least)
        if _fits_on(last):
            fits = times * least
            break
        fails, overloaded = times * least, last
    if fits is None:
        assert overloaded is not None
        return tried.without_rest(overloaded, tried.loaded(unit))
    while (between := fits / fails - 1.0) > SAME_LIMIT:
        state = None if overloaded is None else tried.exact(overloaded, fails)
        if state is not None and fails * (1.0 - 1e-9) <= (state.parameter or 0.0) <= fits * (1.0 + 1e-9):
            return state, LoadsOn(True), tried.factorisations
        if between < LOADS_BRACKET and not _are_limits(overloaded, last):
            break
        middle = math.sqrt(fits * fails)
        trial = tried.carried(middle)
        if _fits_on(trial):
            fits, last = middle, trial
        else:
            fails, overloaded = middle, trial
    if _are_limits(overloaded, last) and (last.parameter or math.inf) - 1.0 < LIMIT_BALANCED:
        settled = replace(last, outcome=PathOutcome.SETTLED, parameter=fits, peak=(fits, fails))
        return settled, LoadsOn(True), tried.factorisations
    # where blocks snap from rest to rest the loads may fit on, not fit on at more strength, and fit on again; and they
    # may all be on, the blocks at rest, where less than all of them makes them run on
    reached, stride = fits, STRONGER[-1] ** (1.0 / _SCANNED)
    scanned = [(more := least * stride**part, tried.carried(more)) for part in range(1, _SCANNED + 1)]
    below = [more for more, trial in scanned if more < reached and _come_on(trial)]
    above = [one for one in scanned[:-1] if one[0] > fits and one[1].parameter is not None and not _fits_on(one[1])]
    less = below[0] / stride if below else fails / stride
    holds = below[0] if below else fails if _come_on(tried.carried(fails)) else fits
    reached = tried.narrowed(holds, less, _come_on)[0]
    if above:
        fails, overloaded = above[-1]
        fits, fails = tried.narrowed(fails * stride, fails, _fits_on)
    # the mechanism changes there: the loads fit on at `fits`, where the blocks are at rest under all of them
    forces, size = tried.at_rest(fits)
    balanced = forces.residual < LIMIT_BALANCED * size
    if not balanced and tried.tip is not None and not _fits_on(full := tried.loaded(unit)):
        return tried.without_rest(overloaded or last, full)
    outcome = PathOutcome.BRACKET if balanced else PathOutcome.GAVE_UP
    peak = replace(
        overloaded or last, outcome=outcome, parameter=fits, peak=(fits, fails), normal=forces.normal,
        friction=forces.friction, residual=forces.residual / size, reached=reached,
    )  # fmt: skip
    return peak, LoadsOn(True), tried.factorisations


def _fits_on(path_end: PathLimit) -> bool:
    return path_end.outcome is PathOutcome.STANDS or (path_end.parameter or 0.0) >= 1.0


def _are_limits(*path_ends: PathLimit | None) -> bool:
    """Whether they are limits of nearly all of the loads, or of little more."""
    return all(one is not None and one.found and abs((one.parameter or 0.0) - 1.0) < LOADS_FIT for one in path_ends)


def _come_on(path_end: PathLimit) -> bool:
    """Whether all of the loads were on at some time, the blocks at rest."""
    return _fits_on(path_end) or (path_end.peak is not None and path_end.peak[0] >= 1.0)


class _Strengths:
    """The loads that come on last, at one strength λ after another.

    Attributes
    ----------
    tip : the motion that tips the blocks at the least strength, None where none did; factorisations : so far
    """

    def __init__(self, model: AssemblyModel, bond: Floats, ratio: float) -> None:
        self.model, self.bond, self.ratio = model, bond, ratio
        self.whole, self.live = model.load.ravel(), model.live.ravel()
        self.factorisations = 0
        self.tip: PathLimit | None = None

    def _bed(self, reduction: float) -> Bed:
        return Bed(self.model, Drive(self.whole - self.live, self.live, reduction), self.bond, self.ratio)

    def loaded(self, reduction: float) -> PathLimit:
        """How far they come on."""
        bed = self._bed(reduction)
        overloaded = follow(bed, FIRST_LOAD)
        self.factorisations += bed.factorisations
        return overloaded

    def carried(self, reduction: float) -> PathLimit:
        """The same, and what tips the blocks is kept."""
        overloaded = self.loaded(reduction)
        if _tips(self.model, overloaded) and (self.tip is None or reduction < self.tip.reduction):
            self.tip = overloaded
        return overloaded

    def without_rest(self, overloaded: PathLimit, full: PathLimit) -> tuple[PathLimit, LoadsOn, int]:
        """No rest, what full strength carries, and the motion that tips the blocks where there is one."""
        tip = self.tip
        at = None if tip is None else (float(tip.parameter or 0.0), 1.0 / tip.reduction)
        none = replace(tip or overloaded, outcome=PathOutcome.NO_REST, parameter=None)
        return none, LoadsOn(True, full.parameter, at), self.factorisations

    def exact(self, path_end: PathLimit, reduction: float) -> PathLimit | None:
        """The limit state in λ, at the whole load, of the modes of one in the load."""
        if not path_end.found or abs((path_end.parameter or 0.0) - 1.0) > LOADS_FIT:
            return None
        bed = Bed(self.model, Drive(self.whole), self.bond, self.ratio)
        return limit_state(bed, path_end.displacement, path_end.motion, reduction)

    def narrowed(self, holds: float, fails: float, held: Callable[[PathLimit], bool]) -> tuple[float, float]:
        """Strengths λ at which the loads are held and not, next to each other."""
        while holds / fails - 1.0 > LOADS_BRACKET:
            middle = math.sqrt(holds * fails)
            holds, fails = (middle, fails) if held(self.carried(middle)) else (holds, middle)
        return holds, fails

    def at_rest(self, reduction: float) -> tuple[BedForces, float]:
        """The forces under all of the loads as they come on part by part, and the size of those loads."""
        bed, at = Bed(self.model, Drive(self.whole), self.bond, self.ratio), self._bed(reduction)
        rested = at.elastic_displacement
        for share in _COMES_ON:
            flow = relaxed(at, rested, share, 0.0)
            if flow.ended != "rest":
                break
            rested = flow.at
        return bed.forces(rested, reduction), bed.load_size


def _tips(model: AssemblyModel, overloaded: PathLimit) -> bool:
    """Whether blocks under a part of the loads move without slip where forces act: no strength hinders that."""
    if overloaded.outcome is not PathOutcome.LIMIT or not 0.0 < (overloaded.parameter or 0.0) < 1.0:
        return False
    opening, slip = model.opening_and_slip(overloaded.motion)
    size = np.sqrt((slip * slip).sum(axis=1))
    forces = model.by_group(np.abs(overloaded.normal)) + np.abs(overloaded.friction).sum(axis=1)
    acts = forces > ADMISSIBLE * float(np.abs(model.load).max())
    return bool(size[acts].max(initial=0.0) < NO_MOTION * max(float(np.abs(opening).max()), float(size.max())))
