"""The limit of an assembly: the static bound, the path, and the range of its mechanism.

    S   the static bound of all blocks (`programs.bounds`): what exceeds it is no factor
    F   the limit of the elastic path (`elastic_path.path`) from the strength 2/S downwards
    M   [lowest, highest]: what the same mechanism can have under any admissible forces

Where the blocks come to rest at no strength, the loads beside weight and water (earthquake, forces) come on after them
at twice the strength of the static bound: a motion under a part of those that slips nowhere is a proof that the blocks
topple whatever the friction.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.progress import scaled_values
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.path import START, trace_limit
from slopekit.preie.elastic_path.path_limit import PathLimit, PathOutcome, result_of
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit, Proposal, Span
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs.bound import StaticBound, is_proved
from slopekit.preie.programs.bounds import mechanism_range, static_bound
from slopekit.preie.solvers.work_limit import (
    LIMIT_UNITS,
    WorkSpentError,
    budget_fraction,
    work_budget,
)
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.tolerances import ADMISSIBLE, BOUND_ACCURACY, LIMIT_BALANCED, NO_MOTION, TINY

_STRONGEST = (
    100.0  # a path starts at no more than this times what friction angles and cohesions suggest
)
FIRST_LOAD = 1e-3  # part of the loads that grow to begin with
_LOCKED = (
    8.0  # times the strength of the static bound: a rest that needs more lives on jammed corners
)
_OF_BOUND = 0.3  # of the work that is left, for a static bound
_BITS = 40  # of a strength in parts of the largest: 12 digits
_RANGED = (
    120  # moving blocks in space up to which the range is found: it takes a score of cone programs
)


def limit_of_blocks(
    model: AssemblyModel,
    ranged: bool = True,
    ratio: float = SHEAR_TO_NORMAL,
    proposal: Proposal | None = None,
) -> BlocksLimit:
    """Return the limit factor of an assembly with its static bound.

    Parameters
    ----------
    ranged : whether the range of the mechanism is wanted
    ratio : k_t / k_n of the elastic joints
    proposal : what is tried before the path
    """
    with work_budget(LIMIT_UNITS):
        limit = _limit_within(model, ratio, proposal)
        return with_range(model, limit, proposal) if ranged else limit


def _limit_within(model: AssemblyModel, ratio: float, proposal: Proposal | None) -> BlocksLimit:
    """The limit with the work that is allowed."""
    model, unit = _in_unit_strength(model)
    strong = unit > 0.0
    bound = _bound(
        _bounding(model)
        if strong
        else replace(model, tan_friction=np.full(len(model.tan_friction), 10.0))
    )
    if bound.lifted:
        return _ended(model, Outcome.LIFTED, bound.velocity, bound)
    if not strong:
        return _without_strength(model, bound)
    limit = _limit_of(model, unit, bound, ratio, proposal)
    tips = None if limit.tips is None else (limit.tips[0], unit * limit.tips[1])
    return replace(
        limit,
        factor=_times(limit.factor, unit),
        static_bound=_times(limit.static_bound, unit),
        lowest=_times(limit.lowest, unit),
        highest=_times(limit.highest, unit),
        rested=_times(limit.rested, unit),
        tips=tips,
    )


def _bounding(model: AssemblyModel) -> AssemblyModel:
    """The model whose static bound is one: of laws that the path follows their tangents at the first tractions."""
    if model.lines is None or not model.lines.follows_laws:
        return model
    from slopekit.preie.system.strength_lines import with_tangents  # only curved laws pay for it

    return with_tangents(model)


def _bound(model: AssemblyModel) -> StaticBound:
    """The static bound; none where it takes too much of the work that is allowed."""
    try:
        with budget_fraction(_OF_BOUND):
            return static_bound(model)
    except WorkSpentError:
        return StaticBound(
            None, False, False, np.zeros(model.load.size), np.zeros(len(model.control_area)), 0
        )


def _in_unit_strength(model: AssemblyModel) -> tuple[AssemblyModel, float]:
    """The model with its strength divided by what friction angles and cohesions suggest, and that: 0 where it has none.

    Searches that begin at λ = 1, and what counts as nothing, are then the same whatever the strength is divided by, and
    F(strength / k) k = F. Rounded to 12 digits, so that they are so to the last bit: paths between many blocks may take
    another turn at a rounding.
    """
    friction, cohesion = float(model.tan_friction.max(initial=0.0)), float(model.cohesion.sum())
    unit = max(friction, cohesion / float(np.abs(model.load).sum())) if cohesion else friction
    if not unit > 0.0:
        return model, 0.0
    tan_friction, bonds = model.tan_friction / unit, model.cohesion / unit
    if model.lines is None:  # lines of curved laws settle to more digits
        tan_friction, bonds = (
            _rounded(tan_friction),
            _rounded(bonds / model.control_area) * model.control_area,
        )
    lines = model.lines
    if lines is not None and lines.follows_laws:
        lines = lines.reduced(unit)
    return replace(
        model, tan_friction=frozen(tan_friction), cohesion=frozen(bonds), lines=lines
    ), unit


def _rounded(values: Floats) -> Floats:
    """To 12 digits, in binary."""
    digits, exponent = np.frexp(values)
    return np.ldexp(np.round(digits * 2.0**_BITS) / 2.0**_BITS, exponent)


def _limit_of(
    model: AssemblyModel, unit: float, bound: StaticBound, ratio: float, groups: Proposal | None
) -> BlocksLimit:
    """Return the limit of a model in unit strength; what groups of it find is in the strength of the design."""
    of_groups = groups is not None
    try:
        path_end = None if groups is None else groups.limit(unit * (bound.factor or math.inf))
        if path_end is not None and _largest_unbalanced(model, path_end) < LIMIT_BALANCED:
            return _limit(
                model, _weaker(path_end, 1.0 / unit), bound, path_end.factorisations, None
            )
        of_groups = False
        with scaled_values(unit, "divided by"):
            path_end, tips = _on_path(model, bound, ratio)
        return _limit(model, path_end, bound, path_end.factorisations, tips)
    except WorkSpentError as spent:
        unsettled = _ended(model, Outcome.NOT_CONVERGED, np.zeros(model.load.size), bound)
        rested = None
        if (
            spent.rested is not None and not model.has_cohesion
        ):  # else one block alone may fail before
            rested = spent.rested / (unit if of_groups else 1.0)
        return replace(unsettled, static_bound=bound.factor, spent=True, rested=rested)


def with_range(
    model: AssemblyModel, limit: BlocksLimit, proposal: Proposal | None = None
) -> BlocksLimit:
    """The limit of an assembly with the range of its mechanism's factors; none where that takes too long.

    Parameters
    ----------
    proposal : the one that the limit was found with
    """
    factor = limit.factor
    if factor is None or model.lines is not None:
        return limit  # where laws are curved other forces mean other tractions, and other lines
    try:
        span = _span(model, limit, proposal)
    except WorkSpentError:
        span = None
    if span is None:  # a last rest and where the blocks run are no range of the mechanism
        has_crept = limit.lowest is not None and limit.lowest < factor
        return replace(limit, lowest=limit.lowest if has_crept else None, highest=None)
    low, high = span
    top = limit.static_bound if high is None else min(high, limit.static_bound or high)
    lowest = min(low or 0.0, factor, limit.lowest or factor)
    return replace(
        limit, lowest=lowest, highest=None if top is None else max(top, limit.highest or factor)
    )


def _span(model: AssemblyModel, limit: BlocksLimit, proposal: Proposal | None) -> Span | None:
    """Return the range of the mechanism of a limit; None where it takes too long."""
    assert limit.factor is not None
    if limit.group and proposal is not None:
        return proposal.span(limit.velocity, limit.static_bound)
    if model.unknowns == 6 and len(model.load) > _RANGED:
        return None
    model, unit = _in_unit_strength(model)
    forces = limit.normal_force, limit.friction
    top = None if limit.static_bound is None else limit.static_bound / unit
    span = mechanism_range(
        model, limit.velocity.ravel(), limit.factor / unit, limit.bond, forces, top
    )
    return None if span is None else (_times(span[0], unit), _times(span[1], unit))


def _limit(
    model: AssemblyModel,
    path_end: PathLimit,
    bound: StaticBound,
    steps: int,
    tips: tuple[float, float] | None,
) -> BlocksLimit:
    """Return what the path says."""
    factor = 1.0 / path_end.parameter if path_end.parameter else None
    outcome, basis, change = Outcome.SLIDES, Basis.NONE, 0.0
    highest: float | None = None
    normal = np.maximum(path_end.normal, 0.0)  # a limit state may pull by what it is admissible to
    top = bound.factor
    if path_end.outcome is PathOutcome.STANDS:
        moves = top is not None and is_proved(model, bound)  # at any strength lower than that
        outcome = Outcome.NOT_CONVERGED if moves else Outcome.NO_DRIVING_FORCE
    elif path_end.outcome is PathOutcome.NO_REST or factor is None:
        outcome = (
            Outcome.NO_REST if path_end.outcome is PathOutcome.NO_REST else Outcome.NOT_CONVERGED
        )
    else:
        basis = {PathOutcome.LIMIT: Basis.LIMIT, PathOutcome.SETTLED: Basis.SETTLED}.get(
            path_end.outcome, Basis.PEAK
        )
        if path_end.peak is not None and basis is Basis.PEAK:
            change = abs(
                path_end.peak[0] / path_end.peak[1] - 1.0
            )  # to the factor at which they run
            highest = factor * (1.0 + change)
        if top is not None and factor > top > factor * (1.0 - BOUND_ACCURACY):
            top = factor  # its forces are admissible: the bound is no lower, to the accuracy of its search
        unbalanced = _largest_unbalanced(model, path_end) > LIMIT_BALANCED
        if (
            path_end.outcome is PathOutcome.GAVE_UP
            or unbalanced
            or (top is not None and factor > top)
        ):
            outcome = Outcome.NOT_CONVERGED
    lowest = None if highest is None else factor
    if (
        factor is not None and lowest is not None and path_end.last_near < math.inf
    ):  # they crept on from there
        lowest = min(factor, 1.0 / path_end.last_near)
    if outcome is not Outcome.SLIDES or factor is None:
        factor, lowest, highest, basis = None, None, None, Basis.NONE
    elif highest is not None:
        highest = max(factor, min(highest, top or highest))
    velocity = frozen(path_end.motion.reshape(model.load.shape))
    return BlocksLimit(
        outcome,
        factor,
        basis,
        change,
        velocity,
        frozen(normal),
        frozen(path_end.friction),
        frozen(path_end.bond),
        top,
        lowest,
        highest,
        tips,
        bound.locked,
        steps=steps,
        bound_steps=bound.steps,
        group=path_end.group,
        width=path_end.width,
        rounding=path_end.rounding,
    )


def _largest_unbalanced(model: AssemblyModel, path_end: PathLimit) -> float:
    """Return the largest unbalanced force in parts of the load of the block it acts on."""
    return float(
        np.abs(model.unbalanced(np.maximum(path_end.normal, 0.0), path_end.friction)).max()
    )


def _ended(
    model: AssemblyModel, outcome: Outcome, motion: Floats, bound: StaticBound, steps: int = 0
) -> BlocksLimit:
    """Return a limit without a factor, with the motion in which the blocks set off."""
    fastest = max(float(np.abs(motion).max(initial=0.0)), TINY)
    pairs = len(model.control_area)
    return BlocksLimit(
        outcome,
        None,
        Basis.NONE,
        0.0,
        frozen(motion.reshape(model.load.shape) / fastest),
        frozen(np.zeros(pairs)),
        frozen(np.zeros(model.slip_rows.shape[:2])),
        frozen(np.ones(pairs)),
        steps=steps,
        bound_steps=bound.steps,
    )


def _without_strength(model: AssemblyModel, bound: StaticBound) -> BlocksLimit:
    """No strength at all: the blocks rest on frictionless joints, or there is no factor."""
    try:
        path_end = trace_limit(ElasticContactModel(model, Drive(model.load.ravel())), 1.0)
    except WorkSpentError:
        return replace(
            _ended(model, Outcome.NOT_CONVERGED, np.zeros(model.load.size), bound), spent=True
        )
    outcome = (
        Outcome.NO_DRIVING_FORCE if path_end.outcome is PathOutcome.STANDS else Outcome.NO_STRENGTH
    )
    return replace(
        _ended(model, outcome, path_end.motion, bound, path_end.factorisations),
        normal_force=frozen(path_end.normal),
    )


def load_limit(model: AssemblyModel, ramp: Floats, reduction: float) -> BlocksLimit:
    """Return the multiplier of a load (n, u), on top of the model's own, at which its strength times λ just holds.

    The limit of the elastic path in the load: its own loads come on first, then the ramp. The limit that is returned
    has the factor 1/λ; one that did not converge has neither factor nor multiplier.
    """
    permanent, grows = model.load.ravel(), ramp.ravel()
    first = FIRST_LOAD * float(np.abs(permanent).max()) / float(np.abs(grows).max())
    bed = ElasticContactModel(model, Drive(permanent, grows, reduction))
    with work_budget(LIMIT_UNITS):
        try:
            path_end = trace_limit(bed, first)
        except WorkSpentError:
            none = np.zeros(bed.size)
            path_end = result_of(
                bed, PathOutcome.GAVE_UP, None, None, none, none, bed.forces(none, first)
            )
    factor = 1.0 / reduction
    outcome, known_factor = {
        PathOutcome.STANDS: (Outcome.NO_DRIVING_FORCE, factor),
        PathOutcome.NO_REST: (Outcome.NO_REST, factor),
    }.get(
        path_end.outcome,
        (Outcome.SLIDES, factor) if path_end.parameter else (Outcome.NOT_CONVERGED, None),
    )
    basis = {PathOutcome.LIMIT: Basis.LIMIT, PathOutcome.SETTLED: Basis.SETTLED}.get(
        path_end.outcome, Basis.PEAK
    )
    return BlocksLimit(
        outcome,
        known_factor,
        basis,
        0.0,
        frozen(path_end.motion.reshape(model.load.shape)),
        frozen(path_end.normal),
        frozen(path_end.friction),
        frozen(path_end.bond),
        multiplier=path_end.parameter,
        steps=path_end.factorisations,
    )


def unit_bound(model: AssemblyModel) -> StaticBound:
    """The static bound in parts of what friction angles and cohesions suggest; it has all bonds."""
    return static_bound(_bounding(_in_unit_strength(model)[0]))


def bound_of(model: AssemblyModel) -> float | None:
    """The static bound as a factor; None where the blocks have no strength, or it is not found with its work."""
    model, unit = _in_unit_strength(model)
    if not unit:
        return None
    with work_budget(LIMIT_UNITS):
        return _times(_bound(_bounding(model)).factor, unit)


def first_limit(model: AssemblyModel, bound: StaticBound) -> PathLimit | None:
    """Return the limit of some blocks, whose `unit_bound` this is; None where there is none."""
    model, unit = _in_unit_strength(model)
    if bound.lifted:
        return None
    with scaled_values(unit or 1.0, "divided by"):
        path_end, _ = _on_path(model, bound, SHEAR_TO_NORMAL)
    return _weaker(path_end, unit or 1.0) if path_end.parameter else None


def _weaker(path_end: PathLimit, unit: float) -> PathLimit:
    """Return the end of a path with its λ rescaled to a strength so many times as high."""
    peak = None if path_end.peak is None else (path_end.peak[0] / unit, path_end.peak[1] / unit)
    return replace(
        path_end,
        parameter=_times(path_end.parameter, 1.0 / unit),
        peak=peak,
        reduction=path_end.reduction / unit,
        last_near=path_end.last_near / unit,
    )


def _times(factor: float | None, multiplier: float) -> float | None:
    return None if factor is None else multiplier * factor


# -- the path ---------------------------------------------------------------------------------------------------------


def _on_path(
    model: AssemblyModel, bound: StaticBound, ratio: float
) -> tuple[PathLimit, tuple[float, float] | None]:
    """Return the limit of the path of a model in unit strength, and the part of the loads that tips it and a factor."""
    start = START / min(bound.factor or _STRONGEST, _STRONGEST)
    bed = ElasticContactModel(model, Drive(model.load.ravel()), ratio=ratio)
    path_end = trace_limit(bed, start)
    peak = path_end.parameter if path_end.outcome is PathOutcome.BRACKET else None
    if peak and bed.cells is None and peak * (bound.factor or 0.0) > _LOCKED:
        path_end = replace(path_end, outcome=PathOutcome.NO_REST, parameter=None)
    if (
        path_end.parameter is None
        and path_end.outcome is not PathOutcome.STANDS
        and model.live.any()
    ):
        tips = _tipping(model, start, ratio)
        if tips is not None:
            fraction = float(tips.parameter or 0.0)
            return replace(tips, outcome=PathOutcome.NO_REST, parameter=None), (
                fraction,
                1.0 / start,
            )
    return path_end, None


def _tipping(model: AssemblyModel, reduction: float, ratio: float) -> PathLimit | None:
    """Return the limit state under a part of the loads beside weight and water that no strength hinders.

    Their motion slips nowhere where forces act. None where that part is all of them, or the motion another.
    """
    live = model.live.ravel()
    path_end = trace_limit(
        ElasticContactModel(model, Drive(model.load.ravel() - live, live, reduction), ratio=ratio),
        FIRST_LOAD,
    )
    if path_end.outcome is not PathOutcome.LIMIT or not 0.0 < (path_end.parameter or 0.0) < 1.0:
        return None
    opening, slip = model.opening_and_slip(path_end.motion)
    size = np.sqrt((slip * slip).sum(axis=1))
    forces = model.by_group(np.abs(path_end.normal)) + np.abs(path_end.friction).sum(axis=1)
    acts = forces > ADMISSIBLE * float(np.abs(model.load).max())
    is_still = size[acts].max(initial=0.0) < NO_MOTION * max(
        float(np.abs(opening).max()), float(size.max())
    )
    return path_end if is_still else None
