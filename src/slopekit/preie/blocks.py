"""The limit factor of safety of an assembly of blocks, and its static bound.

1. The static bound (joints that dilate with their reduced friction angle): one run of the interior-point method.
2. Passes: each pair's friction is frozen at the normal forces of the last, and the smallest load factor found anew
   (METHOD.md §4). A pass starts from an iterate of the last one that lies as far inside as its forces have changed.
3. Between the passes, Newton on everything at once: strengths follow the normal forces, slip does not dilate. It is
   not a convex program and is tried from where the passes are; where it settles it is exact.

Where normal forces are not unique (hyperstatic walls) the load factor may depend on them: they are those of an even
elastic bed, by its energy in the program.

Pairs that the mechanism opens lose their cohesion, once the passes have settled, and do not get it back; then all is
done again.
"""

from dataclasses import dataclass, replace

import numpy as np

from slopekit.arrays import Bools, Floats, frozen
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.iterates import Iterate
from slopekit.preie.passes import Outcome
from slopekit.preie.program import BlockProgram, ProgramResult, Strengths

_MOST_PASSES = 36
_MOST_ROUNDS = 12  # of cohesion lost
_BOUND_STEPS, _PASS_STEPS, _NEWTON_STEPS = 150, 80, 50
_CLOSE = 3e-7  # complementarity of a settled load factor
_INSIDE = 3.0  # how far inside a pass starts, in parts of what changed
_SHED = 1e-3  # of the load: nothing balances it
_BALANCED = 2e-2  # largest unbalanced force of a bound that says so
_ABOVE = 1e-3  # a limit so far above its bound is none
_LOCKED = 100.0  # times the limit
_HARDLY = 1e-3  # of the elastic give: the bound needs none
_BOUND_PASSES, _SETTLED = 8, 1e-6
_ACCURATE = 1e-5  # of the bound
_NO_STRENGTH = 1e-6  # tangent of a friction angle that stands for none
_ROUGH_STRENGTH = 10.0  # of one that holds whatever friction can hold
_NOTHING = 1e-6  # a load factor below this: nothing drives it
_OPENS = 1e-4  # of the fastest motion
_PRESSED = 10.0  # an open pair opens so much more, in parts of the motion, than it carries, in parts of the mean
_ROUGH = 2e-3  # a limit wanted no better need not be consistent: it tells the mechanism, not the number
_CONSISTENT = 2e-2  # friction on a block that frozen strengths let exceed the true ones, in parts of its load
_UNBALANCED = 1e-3  # of a block's load: forces that leave more are not those of a limit
_STEADY = 3  # passes that agree
_ROUGHLY = 1e-2  # how well they have to while bonds still break
#: Passes, and how well they have to agree up to there: what swings on is not unique, and its swing is reported.
_ACCEPT = {3: ((10, 0.0), (_MOST_PASSES, 1e-3)), 6: ((10, 0.0), (20, 1e-3), (_MOST_PASSES, 1e-2))}
_SETTLING = 16  # passes after which they are averaged, in space
#: Passes after which Newton is tried, by unknowns of a block: in a section it is cheap, and long chains need it.
_SEARCHES = {3: (0, 1, 3, 6, 10, 15, 21, 28), 6: (0, 4, 10)}


@dataclass(frozen=True, slots=True)
class BlocksLimit:
    """The limit of an assembly.

    Attributes
    ----------
    outcome, factor : the factor is None where there is none
    change : relative change of the factor between the last passes, 0 where Newton settled
    velocity : (n, u) of the mechanism, its largest motion 1
    normal_force : (m,); friction : (g, t); in parts of the force scale
    bond : (m,) 0 where a pair has lost its cohesion
    static_bound : None where none was found
    passes, steps : work done, for the limit; bound_steps : for the bound
    """

    outcome: Outcome
    factor: float | None
    change: float
    velocity: Floats
    normal_force: Floats
    friction: Floats
    bond: Floats
    static_bound: float | None
    passes: int
    steps: int
    bound_steps: int


def limit_of_blocks(
    model: AssemblyModel, stop_when: float = 1e-4, bounded: bool = True, after: BlocksLimit | None = None
) -> BlocksLimit:
    """The limit factor of an assembly, with its static bound.

    Parameters
    ----------
    stop_when : passes whose factors agree within this part have settled
    bounded : whether the static bound is wanted; `with_bound` adds it later
    after : a rougher limit of the same model to go on from
    """
    if not model.tan_friction.any() and not model.cohesion.any():
        return _without_strength(model, stop_when)
    program = BlockProgram(model)
    in_section = model.unknowns == 3
    bound = _bound(program) if bounded or (in_section and after is None) else None
    if bound is not None and _is_lifted(bound):
        return _ended(model, Outcome.LIFTED, _released(program, bound.at), bound_steps=bound.steps)
    bond, begin, rough = np.ones(len(model.control_area)), program.start, True
    if in_section and bound is not None and bound.settled:  # where blocks topple it is near
        begin = replace(begin, normal=bound.at.normal)
    if after is not None:
        bond, begin, rough = after.bond, replace(begin, normal=after.normal_force), False
    steps = passes = 0
    state = _State(begin, False, np.inf, 0, 0)
    for _ in range(_MOST_ROUNDS):
        program.cohesion = model.by_group(model.cohesion * bond)
        bonded = (bond > 0.0) & (model.cohesion > 0.0)
        state = _settled(program, state.at, _ROUGHLY if rough and bonded.any() else stop_when)
        steps, passes = steps + state.steps, passes + state.passes
        if not state.settled and stop_when <= _ROUGH:
            # once more, from the forces of the static bound, or in a section of an elastic bed
            bound = bound or _bound(program)
            other = program.start if in_section else replace(program.start, normal=bound.at.normal)
            again = _settled(program, other, stop_when)
            steps, passes = steps + again.steps, passes + again.passes
            state = again if again.change < state.change else state
        opened = _opened(model, state.at) & bonded
        if state.at.load_factor < _NOTHING or state.at.shed > _SHED or not (opened.any() or (rough and bonded.any())):
            break
        rough = bool(opened.any())  # while bonds break their number need not be exact
        bond = np.where(opened, 0.0, bond)
    else:
        state = replace(state, settled=False, change=max(state.change, _ROUGHLY))  # bonds still break
    at = state.at
    if at.shed > _SHED:
        program.cohesion = model.by_group(model.cohesion * bond)
        whole = bound if bound is not None and bond.all() else _bound(program)
        if state.settled or _is_lifted(whole) or (not whole.settled and whole.at.shed > _SHED / 10.0):
            return _ended(model, Outcome.LIFTED, _released(program, whole.at), bond, passes, steps, whole.steps)
        return _ended(model, Outcome.NOT_CONVERGED, at, bond, passes, steps, whole.steps)
    if at.load_factor < _NOTHING:
        return _ended(model, Outcome.NO_DRIVING_FORCE, at, bond, passes, steps)
    settled = state.settled
    if settled and stop_when < _ROUGH:  # light blocks between heavy ones: the program balances the heavy ones
        settled = float(np.abs(model.unbalanced(at.normal, at.friction)).max()) < _UNBALANCED
    outcome = Outcome.SLIDES if settled else Outcome.NOT_CONVERGED
    limit = BlocksLimit(
        outcome, 1.0 / at.load_factor, state.change, _unit(model, at), frozen(at.normal), frozen(at.friction),
        frozen(bond), None, passes, steps, 0,
    )  # fmt: skip
    return _bounded(limit, bound) if bounded and bound is not None else limit


def _without_strength(model: AssemblyModel, stop_when: float) -> BlocksLimit:
    """No strength at all: whatever drives wins, and there is no factor; what no strength would hold falls.

    The blocks set off as frictionless ones do.
    """
    slick = replace(model, tan_friction=np.full(len(model.tan_friction), _NO_STRENGTH))
    found = limit_of_blocks(slick, stop_when, bounded=False)
    if found.outcome is not Outcome.LIFTED:
        return found
    rough = BlockProgram(replace(model, tan_friction=np.full(len(model.tan_friction), _ROUGH_STRENGTH)))
    return found if _is_lifted(_bound(rough)) else replace(found, outcome=Outcome.NO_STRENGTH)


def with_bound(model: AssemblyModel, limit: BlocksLimit) -> BlocksLimit:
    """A limit with the static bound of a model: of the same, or of one with contacts that the limit leaves idle."""
    if limit.factor is None or len(model.control_area) == 0:
        return limit
    return _bounded(limit, _bound(BlockProgram(model)))


def _bound(program: BlockProgram) -> ProgramResult:
    """The static bound: Newton on its load factor, or passes with normality at the last one, which are convex."""
    model, elastic = program.model, program.elastic
    program.elastic = elastic * _HARDLY
    try:
        found = program.solve(Strengths(model.tan_dilation, normality=1.0), program.start, _CLOSE, _BOUND_STEPS)
        if found.settled or _is_lifted(found):
            return found
        steps, moved = found.steps, 1.0
        for _ in range(_BOUND_PASSES):
            at = found.at
            summed = model.by_group(at.normal)
            carried = program.cohesion + model.tan_friction * summed
            normality = Strengths(at.load_factor * model.tan_friction, carried, summed)
            found = program.solve(normality, program.start, _CLOSE, _BOUND_STEPS)
            steps, moved = steps + found.steps, abs(found.at.load_factor / at.load_factor - 1.0)
            if not found.settled or moved < _SETTLED:
                break
        return replace(found, settled=found.settled and moved < _SETTLED, steps=steps)
    finally:
        program.elastic = elastic


def _is_lifted(bound: ProgramResult) -> bool:
    """Whether no strength however high balances the loads."""
    return bound.at.shed > _SHED and bound.unbalanced < _BALANCED


def _released(program: BlockProgram, at: Iterate) -> Iterate:
    """An iterate that balances nothing, moving as the blocks set off."""
    return replace(at, velocity=program.release())


def _bounded(limit: BlocksLimit, bound: ProgramResult) -> BlocksLimit:
    """The limit with what was found of the bound; joints that dilate may wedge the blocks fast: then there is none."""
    if limit.factor is None or not bound.settled or bound.at.load_factor < _NOTHING:
        return replace(limit, bound_steps=bound.steps)
    upper = 1.0 / bound.at.load_factor
    if upper > _LOCKED * limit.factor:  # joints that dilate lock the blocks: no bound worth a number
        return replace(limit, bound_steps=bound.steps)
    if limit.factor > upper > limit.factor * (1.0 - _ACCURATE):
        upper = limit.factor  # the forces of the limit are admissible: the bound is no lower, to the method's accuracy
    if limit.factor > upper * (1.0 + _ACCURATE):  # passes that did not settle: no admissible forces stand so long
        above = limit.factor / upper - 1.0
        outcome = limit.outcome if above < _ABOVE else Outcome.NOT_CONVERGED
        limit = replace(limit, outcome=outcome, factor=upper, change=max(limit.change, above))
    return replace(limit, static_bound=upper, bound_steps=bound.steps)


def _ended(
    model: AssemblyModel, outcome: Outcome, at: Iterate, bond: Floats | None = None, passes: int = 0, steps: int = 0,
    bound_steps: int = 0,
) -> BlocksLimit:  # fmt: skip
    bond = np.ones(len(model.control_area)) if bond is None else bond
    return BlocksLimit(
        outcome, None, 0.0, _unit(model, at), frozen(at.normal), frozen(at.friction), frozen(bond), None,
        passes, steps, bound_steps,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _State:
    at: Iterate
    settled: bool
    change: float
    passes: int
    steps: int


def _settled(program: BlockProgram, last: Iterate, stop_when: float) -> _State:
    """Passes, and Newton between them, for one set of bonds."""
    model = program.model
    normal, factor = last.normal, last.load_factor
    changed, steps, found = 0.3, 0, None
    trail: tuple[Iterate, ...] = ()
    factors: list[float] = []
    live = Strengths(model.tan_dilation)
    for k in range(_MOST_PASSES):
        summed = model.by_group(normal)
        frozen = Strengths(
            np.minimum(model.tan_dilation, factor * model.tan_friction),
            program.cohesion + model.tan_friction * summed, summed,
        )  # fmt: skip
        start = _inside(trail, _INSIDE * changed) if k else None
        tolerance = min(max(1e-2 * changed, 1e-7), 1e-3)
        program.elastic = program.stiffest * min(1.0, factor)  # what it stores counts beside the load factor
        found = program.solve(frozen, start or program.start, tolerance, _PASS_STEPS)
        steps += found.steps
        at = found.at
        if at.shed > _SHED and found.settled:
            if k == 0 or _sheds(program, tolerance):
                # not even friction of an elastic bed, a thousand times over, holds
                return _State(at, True, 0.0, k + 1, steps)
            if factors:  # friction frozen at too little normal force: half way back
                normal = 0.5 * (normal + last.normal)
                trail, changed = (), 0.5
                continue
            return _State(at, False, np.inf, k + 1, steps)
        moved = float(np.abs(at.normal - normal).sum()) / max(float(np.abs(at.normal).sum()), 1e-300)
        changed, trail = max(moved, 1e-6), found.trail
        factor = at.load_factor
        factors.append(factor)
        averaged = model.unknowns == 6 and k >= _SETTLING
        weight = 1.0 if k < 3 else 2.0 / (k - _SETTLING + 3.0) if averaged else 0.7
        normal = normal + weight * (at.normal - normal)
        if factor < _NOTHING and found.settled:  # forces without friction balance the load
            return _State(at, True, 0.0, k + 1, steps)
        if k in _SEARCHES[model.unknowns]:
            begin = _inside(trail, _INSIDE * changed)
            newton = program.solve(live, begin or at, _CLOSE, _NEWTON_STEPS)
            steps += newton.steps
            if newton.settled and newton.at.shed < _SHED:
                return _State(newton.at, True, 0.0, k + 1, steps)
        recent = factors[-_STEADY:]
        change = (max(recent) - min(recent)) / max(*recent, 1e-300)
        accept = next(max(stop_when, least) for most, least in _ACCEPT[model.unknowns] if k < most)
        if (
            len(factors) > _STEADY
            and change < accept
            and found.settled
            and (stop_when > _ROUGH or _excess(program, at) < _CONSISTENT)
        ):
            return _State(at, True, change, k + 1, steps)
    recent = factors[-2 * _STEADY :] or [last.load_factor]
    change = (max(recent) - min(recent)) / max(max(recent), 1e-300)
    at_end = found.at if found else last
    settled = change < _ACCEPT[model.unknowns][-1][1] and _excess(program, at_end) < _CONSISTENT
    return _State(at_end, settled, change, _MOST_PASSES, steps)


def _sheds(program: BlockProgram, tolerance: float) -> bool:
    """Whether nothing balances the load with friction of the normal forces of an elastic bed."""
    model = program.model
    summed = model.by_group(program.start.normal)
    frozen = Strengths(np.zeros(len(summed)), program.cohesion + model.tan_friction * summed, summed)
    found = program.solve(frozen, program.start, tolerance, _PASS_STEPS)
    return found.settled and found.at.shed > 0.5


def _excess(program: BlockProgram, at: Iterate) -> float:
    """Friction beyond what the iterate's own normal forces allow, in parts of the load of the block it weighs most on.

    A light block between heavy ones may be the one that fails.
    """
    model = program.model
    size = np.sqrt((at.friction * at.friction).sum(axis=1))
    allowed = at.load_factor * (program.cohesion + model.tan_friction * model.by_group(at.normal))
    excess = np.bincount(model.group_contact, np.maximum(size - allowed, 0.0), len(model.plus))
    count = len(model.load)
    on = np.bincount(model.plus, excess, count) + np.bincount(model.minus + 1, excess, count + 1)[1:]
    weights = np.sqrt((model.load * model.load).sum(axis=1))
    return float((on / np.maximum(weights, 1e-6 * float(weights.max()))).max())


def _inside(trail: tuple[Iterate, ...], wanted: float) -> Iterate | None:
    """The last iterate whose complementarity is still so large, in parts of its load factor."""
    for at in reversed(trail[1:]):
        if at.complementarity > wanted * at.load_factor:
            return at
    return None


def _opened(model: AssemblyModel, at: Iterate) -> Bools:
    """Pairs that the mechanism opens, (m,), beyond what slip opens by itself."""
    opening, slip = model.opening_and_slip(at.velocity)
    size = np.sqrt((slip * slip).sum(axis=1))
    opening = opening - (model.tan_dilation * size)[model.group_of_pair]
    fastest = max(float(size.max()), float(np.abs(opening).max()))
    pressed = at.normal / max(float(at.normal.mean()), 1e-300)
    opened: Bools = (opening > _OPENS * fastest) & (opening > _PRESSED * pressed * fastest)
    return opened


def _unit(model: AssemblyModel, at: Iterate) -> Floats:
    velocity = at.velocity.reshape(model.load.shape)
    return frozen(velocity / max(float(np.abs(velocity).max()), 1e-300))
