"""Curved strength in the models: the secant of every node pair, updated until the normal tractions are stationary.

A model has cohesion and tan φ of each node pair. For a curved law they are the line through its strength at zero
traction and at the pair's own normal traction (`strength.protocol.secant`). The limit on those lines has other normal
tractions, which give other lines, and so on: at the end every pair carries τ(σ) / F of its own σ, and the limit state
is that of the law. Cohesion, which contacts lose as they open, is τ(0) and does not change.

Many blocks reach that state on a path that evaluates the laws (`system.joint_strengths`); their lines are drawn at its
end. Only where joints might dilate by their friction angle does the path use lines, in rounds.

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
from slopekit.preie.tolerances import (
    BOUND_ACCURACY,
    LEAST_TRACTION,
    NO_FORCE,
    ROUNDING,
    SAME_LIMIT,
    TINY,
)
from slopekit.strength.mohr_coulomb import line
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw, secant, tangent

_MAX_ROUNDS = 120  # updates of the lines
_MAX_ROUGH_ROUNDS = 40  # updates with a limit of finite accuracy: each may take seconds
_SETTLED_RANGE = (
    1e-7  # relative range of the last factors of finite accuracy that counts as stationary
)
_MIXING_MEMORY = 6  # rounds that Anderson's mixing uses, and rounds before it starts
_RELAXATION, _MAX_STEP = 0.3, 0.7  # its relaxation, and the longest step of ln tan φ
#: Tractions, in units of the mean, up to which joints are checked for dilation by their friction angle.
_HIGH_TRACTION = 10.0
#: Rounds without progress: then only the last round is mixed, and after as many more the lines do not settle.
_MAX_IDLE_ROUNDS = 12

AnyModel = TypeVar("AnyModel", Model, AssemblyModel)
Limit = TypeVar("Limit")


@dataclass(frozen=True, eq=False)
class StrengthLines:
    """The curved laws of a model and the normal forces at which its straight lines replace them.

    Attributes
    ----------
    laws : of each joint, None for a straight law
    joint : (n,) joint of each node pair, -1 for a bolt
    normal : (n,) normal forces of the lines, in units of the load
    rounds : how often the lines were updated
    follows_laws : whether elastic joints evaluate the laws (`joint_strengths`) instead of the lines
    """

    laws: tuple[StrengthLaw | None, ...]
    joint: Ints
    normal: Floats
    rounds: int = 0
    follows_laws: bool = False

    def restricted_to(self, pairs: Ints) -> "StrengthLines":
        """Return the lines of some node pairs."""
        return replace(self, joint=self.joint[pairs], normal=self.normal[pairs])

    def reduced(self, factor: float) -> "StrengthLines":
        """Return the lines of the same laws with their strength divided by a factor."""
        return replace(
            self, laws=tuple(None if law is None else law.reduced(factor) for law in self.laws)
        )

    def with_bolts(self, count: int) -> "StrengthLines":
        """Return the lines with `count` bolts added as the last node pairs."""
        return replace(
            self,
            joint=np.append(self.joint, np.full(count, -1)),
            normal=np.append(self.normal, np.zeros(count)),
        )


def with_initial_lines(
    laws: Sequence[StrengthLaw | None], joint: Ints, model: AnyModel, mean_kpa: float
) -> AnyModel:
    """Return a model with initial lines at one mean traction (kPa); the same model where every law is straight.

    Many blocks follow the laws themselves from there on.
    """
    if not any(laws):
        return model
    normal = model.control_area * (mean_kpa * model.area_scale / model.force_scale)
    model = with_secants(replace(model, lines=StrengthLines(tuple(laws), joint, normal)), normal)
    assert model.lines is not None
    return replace(model, lines=replace(model.lines, follows_laws=isinstance(model, AssemblyModel)))


def with_secants(model: AnyModel, normal: Floats) -> AnyModel:
    """Return the model with the secants of its curved laws at other normal forces (n,)."""
    assert model.lines is not None
    slopes, _, _ = _line_parameters(model, normal, secant)
    lines = replace(model.lines, normal=frozen(normal), rounds=model.lines.rounds + 1)
    return replace(model, tan_friction=frozen(_group_friction(model, slopes, normal)), lines=lines)


def with_tangents(model: AnyModel) -> AnyModel:
    """Return the model with the tangents of its laws instead of secants: upper bounds of the strength of concave laws.

    An upper bound of the factor on the tangents is one of the laws.
    """
    if model.lines is None:
        return model
    slopes, cohesion, curved = _line_parameters(model, model.lines.normal, tangent)
    _, secant_cohesion, _ = _line_parameters(model, model.lines.normal, secant)
    area = model.control_area * (model.area_scale / model.force_scale)
    # model.cohesion may have lost part of τ(0)
    cohesion_forces = np.where(curved, (cohesion - secant_cohesion) * area, 0.0) + model.cohesion
    friction = _group_friction(model, slopes, model.lines.normal)
    return replace(
        model, tan_friction=frozen(friction), cohesion=frozen(cohesion_forces), lines=None
    )


def _line_parameters(
    model: AnyModel,
    normal: Floats,
    line: Callable[[StrengthLaw, Floats, float], tuple[Floats, Floats]],
) -> tuple[Floats, Floats, Floats]:
    """Return tan φ (n,) and cohesion (n,) kPa of the node pairs, and which (n,) have curved laws.

    `line` gives cohesion and tan φ of a law at tractions (kPa), of which none is below a least one.
    """
    lines = model.lines
    assert lines is not None
    friction = (
        model.tan_friction if isinstance(model, Model) else model.tan_friction[model.group_of_pair]
    )
    slopes, cohesion, curved = (
        friction.copy(),
        np.zeros(len(normal)),
        np.zeros(len(normal), dtype=bool),
    )
    traction = np.maximum(normal, 0.0) / model.control_area * (model.force_scale / model.area_scale)
    real = lines.joint >= 0
    mean = (
        float(normal[real].sum() / model.control_area[real].sum())
        * model.force_scale
        / model.area_scale
    )
    least = max(LEAST_KPA, LEAST_TRACTION * mean)
    for key, law in enumerate(lines.laws):
        on_law = lines.joint == key
        if law is not None and on_law.any():
            cohesion[on_law], slopes[on_law] = line(law, traction[on_law], least)
            curved |= on_law
    return slopes, cohesion, curved


def _group_friction(model: AnyModel, slopes: Floats, normal: Floats) -> Floats:
    """Return tan φ (g,) of the friction forces: the mean of their node pairs (n,), weighted by normal force (n,)."""
    if isinstance(model, Model) or len(model.group_first) == len(slopes):
        return slopes
    # a pair without normal force has the steepest line of all: its weight must vanish against that of a loaded pair
    weight = np.maximum(normal, ROUNDING * float(normal.mean()) * model.control_area)
    weight = np.maximum(weight, TINY)
    return model.by_group(slopes * weight) / model.by_group(weight)


# -- rounds -------------------------------------------------------------------------------------------


def _rounds_of_lines(
    model: AssemblyModel,
    solve: Callable[[AssemblyModel], Limit],
    forces: Callable[[Limit], tuple[Floats, float, float] | None],
) -> tuple[AssemblyModel, Limit, float]:
    """Solve for the limit and update the lines in turn until they are stationary, with Anderson's mixing if slow.

    Parameters
    ----------
    solve : the limit of a model
    forces : normal forces (n,), factor and relative accuracy of a limit; None where there is no limit

    Returns
    -------
    The model, its limit, and the relative mismatch of strength between its lines and those of the limit's forces.
    Where the lines do not settle (the blocks alternate between limit states) the lowest factor of the last rounds, and
    the relative range of the others above it.
    """
    steps: list[tuple[Floats, Floats]] = []
    rounds: list[tuple[float, AssemblyModel, Limit]] = []
    best, idle, rough = math.inf, 0, 0
    while len(rounds) < _MAX_ROUNDS and idle < 2 * _MAX_IDLE_ROUNDS and rough < _MAX_ROUGH_ROUNDS:
        limit = solve(model)
        limit_forces = forces(limit)
        if limit_forces is None:
            return model, limit, 0.0
        normal, factor, accuracy = limit_forces
        new = with_secants(model, normal)
        group_normal, group_cohesion = new.by_group(normal), new.by_group(new.cohesion)
        strength = float(line(group_cohesion, new.tan_friction, group_normal).sum())
        mismatch = float(np.abs(new.tan_friction - model.tan_friction) @ group_normal) / max(
            strength, TINY
        )
        if mismatch <= max(ROUNDING, accuracy):
            return model, limit, mismatch
        rounds.append((factor, model, limit))
        rough += accuracy > 0.0
        if (
            rough >= _MIXING_MEMORY
            and (factor_range := _factor_range(rounds[-_MIXING_MEMORY:])) <= _SETTLED_RANGE
        ):
            # the accuracy of the limits is coarser than the change of the lines
            return model, limit, factor_range
        best, idle = (mismatch, 0) if mismatch < best else (best, idle + 1)
        if len(rounds) > _MIXING_MEMORY:
            log_friction = np.log(np.maximum(model.tan_friction, NO_FORCE))
            last = (log_friction, np.log(np.maximum(new.tan_friction, NO_FORCE)) - log_friction)
            # alternating modes mislead the mixing: use only the last round
            steps = [*steps[-_MIXING_MEMORY:], last] if idle < _MAX_IDLE_ROUNDS else [last]
            new = replace(
                new,
                tan_friction=frozen(
                    np.where(new.tan_friction > NO_FORCE, np.exp(_anderson_mixed(steps)), 0.0)
                ),
            )
        model = new
    last_rounds = rounds[-_MAX_IDLE_ROUNDS:]
    lowest = min(last_rounds, key=lambda entry: entry[0])
    return lowest[1], lowest[2], _factor_range(last_rounds)


def _factor_range(rounds: Sequence[tuple[float, AssemblyModel, Limit]]) -> float:
    """Return the relative range of the factors of some rounds: highest over lowest, minus 1."""
    factors = [entry[0] for entry in rounds]
    return max(factors) / min(factors) - 1.0


def _anderson_mixed(steps: Sequence[tuple[Floats, Floats]]) -> Floats:
    """Return Anderson's next point from the last points and their residuals, (point, residual) each."""
    point, residual = steps[-1]
    if len(steps) == 1:
        return point + _RELAXATION * residual
    point_differences = np.stack([point - previous for previous, _ in steps[:-1]], axis=1)
    residual_differences = np.stack([residual - previous for _, previous in steps[:-1]], axis=1)
    coefficients = np.linalg.lstsq(residual_differences, residual, rcond=1e-10)[0]
    step = (
        _RELAXATION * residual
        - (point_differences + _RELAXATION * residual_differences) @ coefficients
    )
    longest = float(np.abs(step).max())
    return point + step * min(1.0, _MAX_STEP / max(longest, TINY))


# -- many blocks --------------------------------------------------------------------------------------


def limit_on_curved_laws(
    model: AssemblyModel, limit_of: Callable[..., BlocksLimit], proposal: Proposal | None = None
) -> tuple[AssemblyModel, BlocksLimit]:
    """Return the limit of an assembly under curved laws, and the model with the secants at its tractions.

    The path follows the laws. No joint dilates by more than the reduced friction angle of its line: where one might,
    the path uses lines, updated until they are stationary.

    Parameters
    ----------
    limit_of : the limit of a model as it is, and with a `proposal`
    """
    if not _might_dilate_by_friction(model):
        limit = limit_of(model, proposal=proposal)
        model_at_limit = following_lines(
            with_secants(model, limit.normal_force) if limit.factor else model
        )
        if not limit.factor or not _dilates_by_friction(model_at_limit, limit.factor):
            return model_at_limit, _with_bound(model_at_limit, limit, limit.static_bound)
    steps = 0

    def solve(drawn_model: AssemblyModel) -> BlocksLimit:
        nonlocal steps
        at_limit = limit_of(drawn_model)
        steps += at_limit.steps
        return at_limit

    accuracy = SAME_LIMIT if model.unknowns == 6 else 0.0
    model_at_limit, limit, mismatch = _rounds_of_lines(
        following_lines(model),
        solve,
        lambda at_limit: (
            (at_limit.normal_force, at_limit.factor, accuracy) if at_limit.factor else None
        ),
    )
    if limit.factor:
        limit = replace(
            limit,
            change=max(limit.change, mismatch if mismatch > max(ROUNDING, accuracy) else 0.0),
            steps=steps,
        )
    return model_at_limit, _with_bound(model_at_limit, limit, None)


def _dilates_by_friction(model: AssemblyModel, factor: float) -> bool:
    """Return whether a loaded joint would dilate by more than its line's friction angle at a factor."""
    assert model.lines is not None
    return bool(
        (model.tan_dilation > model.tan_friction / factor)[
            model.by_group(model.lines.normal) > 0.0
        ].any()
    )


def _might_dilate_by_friction(model: AssemblyModel) -> bool:
    """Return whether a joint would dilate by more than its friction angle at high traction and the static bound."""
    if not model.tan_dilation.any():
        return False
    highest_factor = bound_of(model)
    assert model.lines is not None
    return highest_factor is None or _dilates_by_friction(
        with_secants(model, _HIGH_TRACTION * model.lines.normal), highest_factor
    )


def following_lines(model: AssemblyModel) -> AssemblyModel:
    """Return the model with joints that use its lines, not the curved laws."""
    assert model.lines is not None
    return replace(model, lines=replace(model.lines, follows_laws=False))


def following_laws(model: AssemblyModel) -> AssemblyModel:
    """Return the model before any limit: joints follow their curved laws, with lines at one uniform traction."""
    assert model.lines is not None
    joints = model.joint_pairs
    uniform = np.zeros(len(model.control_area))
    uniform[joints] = model.control_area[joints] * (
        len(model.load) / float(model.control_area[joints].sum())
    )
    initial = with_secants(replace(model, lines=replace(model.lines, rounds=0)), uniform)
    assert initial.lines is not None
    return replace(initial, lines=replace(initial.lines, follows_laws=True))


def _with_bound(model: AssemblyModel, limit: BlocksLimit, path_bound: float | None) -> BlocksLimit:
    """Return the limit with the static bound of the tangents at its tractions, or with `path_bound` if that is lower.

    Forces within the laws lie within any tangents, so a bound below the factor by more than its accuracy shows that
    the limit did not converge.
    """
    if limit.static_bound is None or not limit.factor:
        return limit
    try:
        bound = static_bound(with_tangents(model)).factor
    except WorkSpentError:
        bound = None
    if bound is not None and bound < limit.factor * (1.0 - BOUND_ACCURACY):
        return replace(
            limit, outcome=Outcome.NOT_CONVERGED, factor=None, basis=Basis.NONE, static_bound=bound
        )
    bounds = [candidate for candidate in (bound, path_bound) if candidate is not None]
    return replace(limit, static_bound=max(min(bounds), limit.factor) if bounds else None)


def load_limit_on_curved_laws(
    model: AssemblyModel, reduction: float
) -> tuple[AssemblyModel, BlocksLimit]:
    """Return the limit in the live load under curved laws, and the model with the secants at its tractions."""

    def forces(limit: BlocksLimit) -> tuple[Floats, float, float] | None:
        accuracy = SAME_LIMIT if model.unknowns == 6 else 0.0
        return (
            None if limit.multiplier is None else (limit.normal_force, limit.multiplier, accuracy)
        )

    if not _might_dilate_by_friction(model):
        limit = load_limit(model, model.live, reduction)
        model_at_limit = following_lines(with_secants(model, limit.normal_force))
        if limit.multiplier is None or not _dilates_by_friction(model_at_limit, 1.0 / reduction):
            return model_at_limit, limit
    model_at_limit, limit, _ = _rounds_of_lines(
        following_lines(model),
        lambda drawn_model: load_limit(drawn_model, drawn_model.live, reduction),
        forces,
    )
    return model_at_limit, limit
