"""Curved strength in the models: the straight line of every node pair, found again until the tractions stay.

A model knows cohesion and tan φ of each node pair. Where a law is curved they are the line through its strength at no
traction and at the pair's own normal traction (`strength.protocol.secant`). The limit on those lines has other normal
tractions, they give other lines, and so on: at the end every pair carries τ(σ) / F of its own σ, and the limit state
is that of the law. Cohesion, which contacts that open lose, is τ(0) and never moves.

Many blocks come to that state on a path that asks the laws themselves (`system.joint_strengths`); their lines are drawn
at its end. Only where joints might dilate by their friction angle does their path have lines, and rounds of them.

Friction forces that several pairs share (a flat contact in a section) have the sum of the strengths of their pairs.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from slopekit.core.arrays import Floats, Ints, frozen
from slopekit.preie.many_blocks.blocks import bound_of, load_limit
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit, Proposal
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.solvers.work_limit import WorkSpentError
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import BOUND_ACCURACY, LEAST_TRACTION, NO_FORCE, ROUNDING, SAME_LIMIT, TINY
from slopekit.strength.mohr_coulomb import line
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw, secant, tangent

_MOST_ROUNDS = 120  # of lines drawn anew
_MOST_ROUGH = 40  # rounds whose limit is known to some part alone: each may take seconds
_STANDS = 1e-7  # a factor known to some part that moves by no more from round to round stands
_MEMORY = 6  # rounds that Anderson's mixing remembers, and before it begins
_MIX, _LONGEST = 0.3, 0.7  # its relaxation, and the longest step of ln tan φ
_PRESSED = 10.0  # tractions in parts of the mean, up to which joints are taken not to dilate by their friction angle
_FRUITLESS = 12  # rounds without gain: then the last alone is mixed, and after as many again the lines do not settle

AnyModel = TypeVar("AnyModel", Model, AssemblyModel)
Found = TypeVar("Found")


@dataclass(frozen=True, eq=False)
class StrengthLines:
    """Where the lines of a model were drawn.

    Attributes
    ----------
    laws : of each joint, None where it is straight
    joint : (n,) of each node pair, -1 where it has none (bolts)
    normal : (n,) normal forces, in parts of the load, that the lines were drawn at
    rounds : how often they were drawn
    followed : whether elastic joints ask the laws themselves (`joint_strengths`), and not the lines
    """

    laws: tuple[StrengthLaw | None, ...]
    joint: Ints
    normal: Floats
    rounds: int = 0
    followed: bool = False

    def chosen(self, pairs: Ints) -> "StrengthLines":
        """Those of some node pairs."""
        return replace(self, joint=self.joint[pairs], normal=self.normal[pairs])

    def reduced(self, factor: float) -> "StrengthLines":
        """Those of the laws with their strength divided by a factor."""
        return replace(self, laws=tuple(None if law is None else law.reduced(factor) for law in self.laws))

    def with_bolts(self, count: int) -> "StrengthLines":
        """The same with bolts as the last node pairs."""
        return replace(
            self, joint=np.append(self.joint, np.full(count, -1)), normal=np.append(self.normal, np.zeros(count))
        )


def first_lines(
    laws: Sequence[StrengthLaw | None], joint: Ints, model: AnyModel, mean_kpa: float
) -> AnyModel:  # fmt: skip
    """A model with lines at one traction all over, to begin with; the same model where every law is straight.

    Many blocks ask the laws themselves from there on.
    """
    if not any(laws):
        return model
    normal = model.control_area * (mean_kpa * model.area_scale / model.force_scale)
    model = drawn(replace(model, lines=StrengthLines(tuple(laws), joint, normal)), normal)
    assert model.lines is not None
    return replace(model, lines=replace(model.lines, followed=isinstance(model, AssemblyModel)))


def drawn(model: AnyModel, normal: Floats) -> AnyModel:
    """The model with its lines at other normal forces (n,), those of straight joints as they are."""
    assert model.lines is not None
    slopes, _, _ = _at(model, normal, secant)
    lines = replace(model.lines, normal=frozen(normal), rounds=model.lines.rounds + 1)
    return replace(model, tan_friction=frozen(_shared(model, slopes, normal)), lines=lines)


def outer(model: AnyModel) -> AnyModel:
    """The model with the tangents of its laws in place of the lines: what concave laws allow lies within.

    A bound on it is a bound of the laws.
    """
    if model.lines is None:
        return model
    slopes, cohesion, curved = _at(model, model.lines.normal, tangent)
    _, none, _ = _at(model, model.lines.normal, secant)
    area = model.control_area * (model.area_scale / model.force_scale)
    bonds = np.where(curved, (cohesion - none) * area, 0.0) + model.cohesion  # less what is lost of τ(0)
    shared = _shared(model, slopes, model.lines.normal)
    return replace(model, tan_friction=frozen(shared), cohesion=frozen(bonds), lines=None)


def _at(
    model: AnyModel, normal: Floats, line: Callable[[StrengthLaw, Floats, float], tuple[Floats, Floats]]
) -> tuple[Floats, Floats, Floats]:
    """Tan φ (n,) and cohesion (n,) kPa of the node pairs, and which are curved."""
    lines = model.lines
    assert lines is not None
    given = model.tan_friction if isinstance(model, Model) else model.tan_friction[model.group_of_pair]
    slopes, cohesion, curved = given.copy(), np.zeros(len(normal)), np.zeros(len(normal), dtype=bool)
    traction = np.maximum(normal, 0.0) / model.control_area * (model.force_scale / model.area_scale)
    real = lines.joint >= 0
    mean = float(normal[real].sum() / model.control_area[real].sum()) * model.force_scale / model.area_scale
    least = max(LEAST_KPA, LEAST_TRACTION * mean)
    for key, law in enumerate(lines.laws):
        on = lines.joint == key
        if law is not None and on.any():
            cohesion[on], slopes[on] = line(law, traction[on], least)
            curved |= on
    return slopes, cohesion, curved


def _shared(model: AnyModel, slopes: Floats, normal: Floats) -> Floats:
    """Tan φ of the friction forces, from those of their pairs by what they carry."""
    if isinstance(model, Model) or len(model.group_first) == len(slopes):
        return slopes
    # a pair that carries nothing has the steepest line of all: it may weigh nothing beside one that does
    weight = np.maximum(normal, ROUNDING * float(normal.mean()) * model.control_area)
    weight = np.maximum(weight, TINY)
    return model.by_group(slopes * weight) / model.by_group(weight)


# -- rounds -------------------------------------------------------------------------------------------


def _rounds(
    model: AssemblyModel,
    solve: Callable[[AssemblyModel], Found],
    forces: Callable[[Found], tuple[Floats, float, float] | None],
) -> tuple[AssemblyModel, Found, float]:
    """Solve, draw the lines anew, solve again, until they stay; mixed after Anderson where that takes long.

    Parameters
    ----------
    forces : normal forces (n,) and factor of what was found, and how exact they are; None where there is no limit

    Returns
    -------
    The model, what was found on it, and by which part of the strength its lines are off those of its own forces. Where
    they do not stay (on other lines the blocks come to another limit state, and back) the lowest factor of the last
    rounds, and how far the others lie above it.
    """
    steps: list[tuple[Floats, Floats]] = []
    rounds: list[tuple[float, AssemblyModel, Found]] = []
    best, fruitless, rough = math.inf, 0, 0
    while len(rounds) < _MOST_ROUNDS and fruitless < 2 * _FRUITLESS and rough < _MOST_ROUGH:
        limit = solve(model)
        carries = forces(limit)
        if carries is None:
            return model, limit, 0.0
        normal, factor, exact = carries
        new = drawn(model, normal)
        carried, bonds = new.by_group(normal), new.by_group(new.cohesion)
        strength = float(line(bonds, new.tan_friction, carried).sum())
        off = float(np.abs(new.tan_friction - model.tan_friction) @ carried) / max(strength, TINY)
        if off <= max(ROUNDING, exact):
            return model, limit, off
        rounds.append((factor, model, limit))
        rough += exact > 0.0
        if rough >= _MEMORY and (swing := _swing(rounds[-_MEMORY:])) <= _STANDS:
            return model, limit, swing  # the limits leave more of the forces than the lines could still gain
        best, fruitless = (off, 0) if off < best else (best, fruitless + 1)
        if len(rounds) > _MEMORY:
            at = np.log(np.maximum(model.tan_friction, NO_FORCE))
            last = (at, np.log(np.maximum(new.tan_friction, NO_FORCE)) - at)
            # modes that trade places lead the mixing astray: then the last round alone
            steps = [*steps[-_MEMORY:], last] if fruitless < _FRUITLESS else [last]
            new = replace(new, tan_friction=frozen(np.where(new.tan_friction > NO_FORCE, np.exp(_mixed(steps)), 0.0)))
        model = new
    last_ones = rounds[-_FRUITLESS:]
    lowest = min(last_ones, key=lambda one: one[0])
    return lowest[1], lowest[2], _swing(last_ones)


def _swing(rounds: Sequence[tuple[float, AssemblyModel, Found]]) -> float:
    """How far the highest factor of some rounds lies above the lowest."""
    factors = [one[0] for one in rounds]
    return max(factors) / min(factors) - 1.0


def _mixed(steps: Sequence[tuple[Floats, Floats]]) -> Floats:
    """Anderson's next point from the last ones and what each was off by."""
    at, off = steps[-1]
    if len(steps) == 1:
        return at + _MIX * off
    moves = np.stack([at - one for one, _ in steps[:-1]], axis=1)
    turns = np.stack([off - one for _, one in steps[:-1]], axis=1)
    parts = np.linalg.lstsq(turns, off, rcond=1e-10)[0]
    step = _MIX * off - (moves + _MIX * turns) @ parts
    longest = float(np.abs(step).max())
    return at + step * min(1.0, _LONGEST / max(longest, TINY))


# -- many blocks --------------------------------------------------------------------------------------


def settled_blocks(
    model: AssemblyModel, limit_of: Callable[..., BlocksLimit], proposal: Proposal | None = None
) -> tuple[AssemblyModel, BlocksLimit]:
    """The limit of an assembly with every pair on the line of its own traction, and the model with those lines.

    The path follows the laws. No joint dilates by more than the friction angle that is left of its line: where one
    might, the path has lines, drawn anew until they stay.

    Parameters
    ----------
    limit_of : the limit of a model as it is, and with a `proposal`
    """
    if not _might_dilate_by_friction(model):
        limit = limit_of(model, proposal=proposal)
        ended = by_lines(drawn(model, limit.normal_force) if limit.factor else model)
        if not limit.factor or not _dilates_by_friction(ended, limit.factor):
            return ended, _with_bound(ended, limit, limit.static_bound)
    steps = 0

    def solve(drawn_model: AssemblyModel) -> BlocksLimit:
        nonlocal steps
        at_limit = limit_of(drawn_model)
        steps += at_limit.steps
        return at_limit

    exact = SAME_LIMIT if model.unknowns == 6 else 0.0
    ended, limit, off = _rounds(
        by_lines(model), solve,
        lambda at_limit: (at_limit.normal_force, at_limit.factor, exact) if at_limit.factor else None,
    )  # fmt: skip
    if limit.factor:
        limit = replace(limit, change=max(limit.change, off if off > max(ROUNDING, exact) else 0.0), steps=steps)
    return ended, _with_bound(ended, limit, None)


def _dilates_by_friction(model: AssemblyModel, factor: float) -> bool:
    """Whether a joint that carries anything would dilate by more than its line's friction angle at a factor."""
    assert model.lines is not None
    return bool((model.tan_dilation > model.tan_friction / factor)[model.by_group(model.lines.normal) > 0.0].any())


def _might_dilate_by_friction(model: AssemblyModel) -> bool:
    """The same at any traction up to some times the mean, and any factor up to the static bound."""
    if not model.tan_dilation.any():
        return False
    most = bound_of(model)
    assert model.lines is not None
    return most is None or _dilates_by_friction(drawn(model, _PRESSED * model.lines.normal), most)


def by_lines(model: AssemblyModel) -> AssemblyModel:
    """The model with its lines for joints that ask no law."""
    assert model.lines is not None
    return replace(model, lines=replace(model.lines, followed=False))


def by_laws(model: AssemblyModel) -> AssemblyModel:
    """The model as before its limit was found: joints ask their laws, lines are those of one traction all over."""
    assert model.lines is not None
    joints = model.joint_pairs
    even = np.zeros(len(model.control_area))
    even[joints] = model.control_area[joints] * (len(model.load) / float(model.control_area[joints].sum()))
    begun = drawn(replace(model, lines=replace(model.lines, rounds=0)), even)
    assert begun.lines is not None
    return replace(begun, lines=replace(begun.lines, followed=True))


def _with_bound(model: AssemblyModel, limit: BlocksLimit, other: float | None) -> BlocksLimit:
    """The limit with the static bound of the tangents at its own tractions, or of `other` ones if that is lower.

    Forces that the laws allow lie within any tangents: below the factor no such bound can be but by its accuracy.
    """
    if limit.static_bound is None or not limit.factor:
        return limit
    try:
        bound = static_bound(outer(model)).factor
    except WorkSpentError:
        bound = None
    if bound is not None and bound < limit.factor * (1.0 - BOUND_ACCURACY):
        return replace(limit, outcome=Outcome.NOT_CONVERGED, factor=None, basis=Basis.NONE, static_bound=bound)
    known = [one for one in (bound, other) if one is not None]
    return replace(limit, static_bound=max(min(known), limit.factor) if known else None)


def settled_load(model: AssemblyModel, reduction: float) -> tuple[AssemblyModel, BlocksLimit]:
    """The model with every pair on the line of its own traction at the limit in the live load, and that limit."""

    def forces(limit: BlocksLimit) -> tuple[Floats, float, float] | None:
        exact = SAME_LIMIT if model.unknowns == 6 else 0.0
        return None if limit.multiplier is None else (limit.normal_force, limit.multiplier, exact)

    if not _might_dilate_by_friction(model):
        limit = load_limit(model, model.live, reduction)
        ended = by_lines(drawn(model, limit.normal_force))
        if limit.multiplier is None or not _dilates_by_friction(ended, 1.0 / reduction):
            return ended, limit
    ended, limit, _ = _rounds(
        by_lines(model), lambda drawn_model: load_limit(drawn_model, drawn_model.live, reduction), forces
    )
    return ended, limit
