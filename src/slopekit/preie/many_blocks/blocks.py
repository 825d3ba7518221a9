"""The limit of an assembly: the static bound, the path, the bonds it breaks, and the range of its mechanism.

    S   the static bound of all blocks (`programs.bounds`): what exceeds it is no factor
    F   the limit of the elastic path (`elastic_path.path`) from the strength 2/S downwards
    B   a contact that is open all over at rest as strength falls, and a flat one that the limit's motion opens
        anywhere, which touches along a line at most, lose all their cohesion: the path starts again
        (`many_blocks.bonds`)
    M   [lowest, highest]: what the same mechanism can have under any admissible forces

Where the blocks come to rest at no strength with all loads on at once, or where their motion does not settle, the loads
beside weight and water (earthquake, forces) come on afterwards, at one strength after the other: F is where they just
all fit on, exactly, with the modes found there. Where they fit on at no strength the blocks topple whatever the
friction: there is no factor, but the part of the loads that they carry at full strength.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.onlooker import told_times
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.falling import fall
from slopekit.preie.elastic_path.loads_last import FIRST_LOAD, LoadsOn, loads_last
from slopekit.preie.elastic_path.path import START, first_peak, follow
from slopekit.preie.elastic_path.path_limit import MANY, PathLimit, PathOutcome, result_of
from slopekit.preie.elastic_path.proposal import proposed
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit, Proposal, Span
from slopekit.preie.many_blocks.bonds import with_bonds
from slopekit.preie.one_block.passes import Outcome
from slopekit.preie.programs.bound import StaticBound, is_proved
from slopekit.preie.programs.bounds import mechanism_range, static_bound
from slopekit.preie.solvers.work_limit import MOST, WorkSpentError, allowed, part
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.tolerances import (
    BOUND_ACCURACY,
    LIMIT_BALANCED,
    SAME_FACTOR,
    TINY,
)

_STRONGEST = 100.0  # a path starts at no more than this times what friction angles and cohesions suggest
_LOCKED = 8.0  # times the strength of the static bound: a rest that needs more lives on jammed corners
_OF_BOUND = 0.3  # of the work that is left, for a static bound
_BITS = 40  # of a strength in parts of the largest: 12 digits
_RANGED = 120  # moving blocks in space up to which the range is found: it takes a score of cone programs


def limit_of_blocks(
    model: AssemblyModel, ranged: bool = True, ratio: float = SHEAR_TO_NORMAL, proposal: Proposal | None = None,
    bond: Floats | None = None,
) -> BlocksLimit:  # fmt: skip
    """The limit factor of an assembly with its static bound.

    Parameters
    ----------
    ranged : whether the range of the mechanism is wanted
    ratio : k_t / k_n of the elastic joints
    proposal : what is tried before the path
    bond : (m,) 0 where a pair has lost its cohesion between other node pairs of the same contacts
    """
    with allowed(MOST):
        limit = _limit_within(model, ratio, proposal, bond)
        return with_range(model, limit, proposal) if ranged else limit


def _limit_within(model: AssemblyModel, ratio: float, proposal: Proposal | None, bond: Floats | None) -> BlocksLimit:
    """The limit with the work that is allowed."""
    model, unit = _in_unit_strength(model)
    strong = unit > 0.0
    bound = _bound(_bounding(model) if strong else replace(model, tan_friction=np.full(len(model.tan_friction), 10.0)))
    if bound.lifted:
        return _ended(model, Outcome.LIFTED, bound.velocity, bound)
    if not strong:
        return _without_strength(model, bound)
    limit = _limit_of(model, unit, bound, ratio, proposal, bond)
    return replace(
        limit, factor=_times(limit.factor, unit), static_bound=_times(limit.static_bound, unit),
        lowest=_times(limit.lowest, unit), highest=_times(limit.highest, unit), rested=_times(limit.rested, unit),
        held=None if limit.held is None else (unit * limit.held[0], limit.held[1]),
        by_turns=None if limit.by_turns is None else (unit * limit.by_turns[0], unit * limit.by_turns[1]),
        tips=None if limit.tips is None else (limit.tips[0], unit * limit.tips[1]), begun=_times(limit.begun, unit),
        fit_on=_times(limit.fit_on, unit),
    )  # fmt: skip


def _bounding(model: AssemblyModel) -> AssemblyModel:
    """The model whose static bound is one: of laws that the path follows their tangents at the first tractions."""
    if model.lines is None or not model.lines.followed:
        return model
    from slopekit.preie.system.strength_lines import outer  # only curved laws pay for it

    return outer(model)


def _bound(model: AssemblyModel) -> StaticBound:
    """The static bound; none where it takes too much of the work that is allowed."""
    try:
        with part(_OF_BOUND):
            return static_bound(model)
    except WorkSpentError:
        return StaticBound(None, False, False, np.zeros(model.load.size), np.zeros(len(model.control_area)), 0)


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
        tan_friction, bonds = _rounded(tan_friction), _rounded(bonds / model.control_area) * model.control_area
    lines = model.lines
    if lines is not None and lines.followed:
        lines = lines.reduced(unit)
    return replace(model, tan_friction=frozen(tan_friction), cohesion=frozen(bonds), lines=lines), unit


def _rounded(values: Floats) -> Floats:
    """To 12 digits, in binary."""
    digits, exponent = np.frexp(values)
    rounded: Floats = np.ldexp(np.round(digits * 2.0**_BITS) / 2.0**_BITS, exponent)
    return rounded


def _limit_of(
    model: AssemblyModel, unit: float, bound: StaticBound, ratio: float, proposal: Proposal | None,
    bond: Floats | None,
) -> BlocksLimit:  # fmt: skip
    """The limit of a model in unit strength; a proposal is in the strength of the design."""
    steps, loads, drive = 0, LoadsOn(), Drive(model.load.ravel())
    snapped: set[bytes] = set()  # bonds with which a peak was taken for a round

    def once(bond: Floats, falls: bool, vouched: bool) -> tuple[PathLimit, bool]:
        nonlocal steps, loads
        loads = LoadsOn()
        settled = None
        if proposal is not None and not vouched:
            own = proposal.limit_alone(bond, falls)
            if own is not None and (own.found or own.outcome is PathOutcome.BRACKET):
                if not own.found:
                    snapped.add(bond.tobytes())
                return _weaker(own, 1.0 / unit), False
        try:
            if proposal is not None:
                settled = proposal.limit(bond, falls, unit * (bound.factor or math.inf), bond.tobytes() in snapped)
        except WorkSpentError as spent:
            raise spent.times(1.0 / unit) from None
        if settled is not None and _off(model, settled) < LIMIT_BALANCED:
            steps += settled.factorisations
            return _weaker(settled, 1.0 / unit), True
        peak = None if proposal is None or bond.tobytes() in snapped else proposal.peak()
        if proposal is not None and peak is not None and model.has_cohesion:  # it may break bonds
            snapped.add(bond.tobytes())
            proposal.begins_with(peak.motion)
            return _weaker(peak, 1.0 / unit), False
        with told_times(unit, "divided by"):
            path_end, loads, work = _on_path(model, unit, bond, bound, ratio, falls)
        steps += work
        if proposal is not None and path_end.parameter:
            proposal.begins_with(path_end.motion)
        return path_end, True

    if proposal is not None and bound.factor is not None and model.has_cohesion:
        proposal.begins_with(bound.velocity.ravel())
    try:
        ended = with_bonds(model, once, drive.working, False, bond)
    except WorkSpentError as spent:
        unsettled = _ended(model, Outcome.NOT_CONVERGED, np.zeros(model.load.size), bound, steps)
        whole = model.lines is None and not model.has_cohesion  # a rest says little where cohesion may yet be lost
        held = proposal.held() if whole and proposal is not None else None
        return replace(
            unsettled, static_bound=bound.factor, spent=True, rested=spent.rested if whole else None,
            held=None if held is None else (held[0] / unit, held[1]),
        )  # fmt: skip
    return _without_share(_limit(model, ended.limit, bound, steps, loads), ended.share)


def with_range(model: AssemblyModel, limit: BlocksLimit, proposal: Proposal | None = None) -> BlocksLimit:
    """The limit of an assembly with the range of its mechanism's factors, where that does not take too long.

    Parameters
    ----------
    proposal : the one that the limit was found with
    """
    factor = limit.factor
    if factor is None:
        return limit
    if model.lines is not None:
        return limit  # where laws are curved other forces mean other tractions, and other lines
    try:
        span = _span(model, limit, proposal)
    except WorkSpentError:
        span = None
    if span is None:
        return limit
    low, high = span
    top = limit.static_bound if high is None else min(high, limit.static_bound or high)
    reached = limit.highest or factor
    lowest = min(low or 0.0, factor, limit.lowest or factor)
    return replace(limit, lowest=lowest, highest=None if top is None else max(top, reached))


def _span(model: AssemblyModel, limit: BlocksLimit, proposal: Proposal | None) -> Span | None:
    """The range of the mechanism of a limit; None where it takes too long.

    Of a limit without the work of cohesion that is kept, that of the limit with it, as much lower.
    """
    assert limit.factor is not None
    span, times = None, 1.0 - limit.kept_share
    if limit.group and proposal is not None:
        span = proposal.span(limit.velocity)
    elif model.unknowns == 3 or len(model.load) <= _RANGED:
        model, unit = _in_unit_strength(model)
        factor, forces = limit.factor / unit / times, (limit.normal_force, limit.friction)
        span, times = mechanism_range(model, limit.velocity.ravel(), factor, limit.bond, forces), times * unit
    return None if span is None else (_times(span[0], times), _times(span[1], times))


def _limit(model: AssemblyModel, path_end: PathLimit, bound: StaticBound, steps: int, loads: LoadsOn) -> BlocksLimit:
    """What the path says, once every block has vouched for it; of a peak the range has what other ways to it give."""
    factor = 1.0 / path_end.parameter if path_end.parameter else None
    outcome, basis, change = Outcome.SLIDES, Basis.NONE, 0.0
    highest: float | None = None
    normal = np.maximum(path_end.normal, 0.0)  # a limit state may pull by what it is admissible to
    top = bound.factor
    if path_end.outcome is PathOutcome.STANDS:
        moves = top is not None and is_proved(model, bound)  # at any strength lower than that
        outcome = Outcome.NOT_CONVERGED if moves else Outcome.NO_DRIVING_FORCE
    elif path_end.outcome is PathOutcome.NO_REST or factor is None:
        outcome = Outcome.NO_REST if path_end.outcome is PathOutcome.NO_REST else Outcome.NOT_CONVERGED
    else:
        basis = {PathOutcome.LIMIT: Basis.LIMIT, PathOutcome.SETTLED: Basis.SETTLED}.get(path_end.outcome, Basis.PEAK)
        if path_end.peak is not None and basis is Basis.PEAK:
            change = abs(path_end.peak[0] / path_end.peak[1] - 1.0)  # to the factor at which they run
            highest = max(factor * (1.0 + change), 1.0 / (path_end.reached or math.inf))
        off = _off(model, path_end)
        if top is not None and factor > top > factor * (1.0 - BOUND_ACCURACY):
            top = factor  # its forces are admissible: the bound is no lower, to the accuracy of its search
        if path_end.outcome is PathOutcome.GAVE_UP or off > LIMIT_BALANCED or (top is not None and factor > top):
            outcome = Outcome.NOT_CONVERGED
    by_turns: tuple[float, float] | None = None
    if outcome is Outcome.NOT_CONVERGED and loads.last and factor is not None and path_end.reached:
        by_turns = factor, 1.0 / path_end.reached
    if outcome is not Outcome.SLIDES or factor is None:
        factor, highest, basis = None, None, Basis.NONE
    elif highest is not None:
        highest = max(factor, min(highest, top or highest))
        change = max(change, highest / factor - 1.0)
    velocity = frozen(path_end.motion.reshape(model.load.shape))
    return BlocksLimit(
        outcome, factor, basis, change, velocity, frozen(normal), frozen(path_end.friction), frozen(path_end.bond), top,
        None if highest is None else factor, highest, loads.carried, loads.last, steps, bound.steps, path_end.group,
        path_end.width, path_end.rounding, by_turns=by_turns, tips=loads.tips, begun=loads.begun,
        fit_on=loads.fit_on, locked=bound.locked,
    )  # fmt: skip


def _without_share(limit: BlocksLimit, share: float) -> BlocksLimit:
    """Return a limit that leaves out a share of its motion's work: that of the cohesion which the motion opens."""
    if not share or limit.factor is None:
        return limit
    basis = Basis.SETTLED if limit.basis is Basis.LIMIT else limit.basis  # a part of its work is taken away
    return replace(limit, basis=basis, kept_share=share)


def _off(model: AssemblyModel, path_end: PathLimit) -> float:
    """Largest unbalanced force in parts of the load of the block it acts on."""
    return float(np.abs(model.unbalanced(np.maximum(path_end.normal, 0.0), path_end.friction)).max())


def _ended(model: AssemblyModel, outcome: Outcome, motion: Floats, bound: StaticBound, steps: int = 0) -> BlocksLimit:
    """No factor, and how the blocks set off."""
    fastest = max(float(np.abs(motion).max(initial=0.0)), TINY)
    pairs = len(model.control_area)
    return BlocksLimit(
        outcome, None, Basis.NONE, 0.0, frozen(motion.reshape(model.load.shape) / fastest), frozen(np.zeros(pairs)),
        frozen(np.zeros(model.slip_rows.shape[:2])), frozen(np.ones(pairs)), None, None, None, None, False, steps,
        bound.steps,
    )  # fmt: skip


def _without_strength(model: AssemblyModel, bound: StaticBound) -> BlocksLimit:
    """No strength at all: the blocks rest on frictionless joints, or there is no factor."""
    try:
        path_end = follow(Bed(model, Drive(model.load.ravel())), 1.0)
    except WorkSpentError:
        return replace(_ended(model, Outcome.NOT_CONVERGED, np.zeros(model.load.size), bound), spent=True)
    outcome = Outcome.NO_DRIVING_FORCE if path_end.outcome is PathOutcome.STANDS else Outcome.NO_STRENGTH
    return replace(
        _ended(model, outcome, path_end.motion, bound, path_end.factorisations), normal_force=frozen(path_end.normal)
    )


def load_limit(model: AssemblyModel, ramp: Floats, reduction: float) -> tuple[PathLimit, BlocksLimit]:
    """The multiplier of a load (n, u), on top of the model's own, at which its strength times λ just holds.

    The limit of the elastic path in the load: its own loads come on first, then the ramp; contacts that open lose
    their cohesion as in the limit of strength. The limit that is returned has the factor 1/λ.
    """
    own, grows = model.load.ravel(), ramp.ravel()
    first = FIRST_LOAD * float(np.abs(own).max()) / float(np.abs(grows).max())

    def once(bond: Floats, falls: bool, _: bool) -> tuple[PathLimit, bool]:
        bed = Bed(model, Drive(own, grows, reduction), bond)
        try:
            return (fall if falls and model.has_cohesion else follow)(bed, first), True
        except WorkSpentError:
            none = np.zeros(bed.size)
            return result_of(bed, PathOutcome.GAVE_UP, None, None, none, none, bed.forces(none, first)), True

    with allowed(MOST):
        ended = with_bonds(model, once, grows, True)
    path_end = ended.limit
    basis = Basis.LIMIT if path_end.outcome is PathOutcome.LIMIT else Basis.SETTLED
    basis = basis if path_end.found else Basis.PEAK
    basis = Basis.SETTLED if ended.share and basis is Basis.LIMIT else basis
    return path_end, BlocksLimit(
        Outcome.SLIDES, 1.0 / reduction, basis, 0.0, frozen(path_end.motion.reshape(model.load.shape)),
        frozen(path_end.normal), frozen(path_end.friction), frozen(path_end.bond), None, None, None, None, False,
        path_end.factorisations, 0, kept_share=ended.share,
    )  # fmt: skip


def unit_bound(model: AssemblyModel) -> StaticBound:
    """The static bound in parts of what friction angles and cohesions suggest; it has all bonds."""
    return static_bound(_bounding(_in_unit_strength(model)[0]))


def bound_of(model: AssemblyModel) -> float | None:
    """The static bound as a factor; None where the blocks have no strength, or it is not found with its work."""
    model, unit = _in_unit_strength(model)
    if not unit:
        return None
    with allowed(MOST):
        return _times(_bound(_bounding(model)).factor, unit)


def first_limit(
    model: AssemblyModel, bond: Floats, bound: StaticBound, falls: bool, at_once: bool = True
) -> PathLimit | None:
    """The limit of some blocks with bonds (m,) as they are, and their `unit_bound`; None where there is none.

    A peak is that of one way to it: nobody asks how sure it is.

    Parameters
    ----------
    falls : whether more of them break as strength falls
    at_once : whether a limit is proposed before the path, or where it ends in a peak
    """
    model, unit = _in_unit_strength(model)
    if bound.lifted:
        return None
    with told_times(unit or 1.0, "divided by"):
        path_end, *_ = _on_path(model, unit, bond, bound, SHEAR_TO_NORMAL, falls, peaks=False, at_once=at_once)
    return _weaker(path_end, unit or 1.0) if path_end.parameter else None


def _weaker(path_end: PathLimit, unit: float) -> PathLimit:
    """What a path found, its λ that of a strength so many times as high."""
    peak = None if path_end.peak is None else (path_end.peak[0] / unit, path_end.peak[1] / unit)
    return replace(
        path_end, parameter=_times(path_end.parameter, 1.0 / unit), peak=peak, reduction=path_end.reduction / unit,
        started=path_end.started / unit, reached=_times(path_end.reached, 1.0 / unit),
    )  # fmt: skip


def _times(factor: float | None, by: float) -> float | None:
    return None if factor is None else by * factor


# -- the path, and the loads that come on last ------------------------------------------------------------------------


def _on_path(
    model: AssemblyModel, unit: float, bond: Floats, bound: StaticBound, ratio: float, falls: bool, peaks: bool = True,
    at_once: bool = True,
) -> tuple[PathLimit, LoadsOn, int]:  # fmt: skip
    """The path with some bonds, how the loads beside weight came on, and the work.

    The model is in unit strength: the design's is `unit` times that. Where loads that come on last end in no limit
    state, and tip nothing, they come on at once again, at more strength. With `peaks` other ways to a peak are tried,
    with `at_once` a limit without the path.
    """
    start = START / min(bound.factor or _STRONGEST, _STRONGEST)
    live = bool(model.live.any())
    bed = Bed(model, Drive(model.load.ravel()), bond, ratio)
    bonded = bed.has_bonds
    falls = falls and bonded
    path_end = _at_once(bed, ratio) if at_once and bed.size > MANY and not bonded else None
    path_end = path_end or (fall if falls else follow)(bed, start, live and bed.tangents == 1)
    # the peak of falling strength has other bonds
    peak = path_end.outcome is PathOutcome.BRACKET and bed.tangents > 1 and not falls
    if (path_end.outcome is PathOutcome.GAVE_UP or peak) and not live and at_once and bed.size <= MANY:
        path_end = _at_once(bed, ratio, 0.0 if path_end.peak is None else path_end.peak[1]) or path_end
    if path_end.found or path_end.outcome is PathOutcome.STANDS:
        return path_end, LoadsOn(), bed.factorisations
    # in space a motion that does not settle says nothing of the order of the loads
    if live and (bed.tangents == 1 or path_end.outcome is not PathOutcome.BRACKET):
        last, loads, work = loads_last(model, unit, bond, bound, ratio)
        tipped = math.inf if loads.tips is None else 1.0 / loads.tips[1]  # and with all greater strengths
        most = min(_LOCKED * start / START, tipped)
        if last.outcome is PathOutcome.LIMIT or bed.tangents > 1 or bed.size > MANY or most < start:
            return last, loads, work + bed.factorisations
        path_end = follow(bed, start)
        settled = path_end.found or last.outcome not in (PathOutcome.BRACKET, PathOutcome.SETTLED)
        if path_end.parameter is None or path_end.parameter > most or not settled:
            return last, loads, work + bed.factorisations
        fit_on = None
        if last.outcome is PathOutcome.SETTLED and last.parameter is not None:
            if path_end.parameter < last.parameter * (1.0 - SAME_FACTOR):  # the lower of the two factors
                return last, loads, work + bed.factorisations
            fit_on = 1.0 / last.parameter
        if peaks and path_end.outcome is PathOutcome.BRACKET:
            path_end = first_peak(bed, path_end)
        begun = 1.0 / path_end.started if path_end.started > start else None
        return path_end, LoadsOn(begun=begun, fit_on=fit_on), work + bed.factorisations
    if path_end.outcome is PathOutcome.BRACKET:
        if not falls and _is_locked(model, path_end, bound):
            path_end = replace(path_end, outcome=PathOutcome.NO_REST, parameter=None)
        elif peaks and path_end.peak is not None and not bonded:
            path_end = first_peak(bed, path_end)
    return path_end, LoadsOn(), bed.factorisations


def _is_locked(model: AssemblyModel, peak: PathLimit, bound: StaticBound) -> bool:
    """Whether a rest needs many times the strength of the static bound with the bonds that are left there."""
    parameter = peak.parameter or 0.0
    if parameter * (bound.factor or 0.0) > _LOCKED and (peak.bond == 0.0).any():
        bound = _bound(_bounding(replace(model, cohesion=frozen(model.cohesion * peak.bond))))
    return parameter * (bound.factor or 0.0) > _LOCKED


def _at_once(bed: Bed, ratio: float, ran: float = 0.0) -> PathLimit | None:
    """The limit that is proposed, in balance, and not below the λ at which the blocks have run."""
    limit = proposed(bed, bed.bond, ratio)
    if limit is None or (limit.parameter or 0.0) < ran or _off(bed.model, limit) > LIMIT_BALANCED:
        return None
    return limit
