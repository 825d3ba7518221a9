"""The static bound: the largest F at which *some* admissible forces balance the loads.

It is the limit of joints that dilate by their whole (reduced) friction angle and keep their cohesion: an upper bound
on the limit factor, unsafe as an answer. Its dual: the largest λ = 1/F for which a velocity v exists with

    v_n >= λ tan φ |v_t|  on every pair,     P·v + λ (bolts drawn out) >= λ Σ c A |v_t|.

Both sides are used: a mechanism proposes λ, and forces that balance the loads at that λ prove it.
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.solvers.linear import non_negative_least_squares
from slopekit.preie.solvers.work_limit import UNITS_PER_SECOND, WorkSpentError, work_budget
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import (
    BOUND_ACCURACY,
    BOUND_BEYOND,
    EQUILIBRIUM,
    PARALLEL,
    ROUNDING,
    SAME_LIMIT,
)

if TYPE_CHECKING:
    from slopekit.preie.system.assembly import AssemblyModel

_MOST_STEPS = 40  # of Newton's method
_MOST_PAIRS = 7_500  # node pairs, beyond which cone programs take minutes
_WORK = 5.0 * UNITS_PER_SECOND  # for the bound of one block, which is only reported


@dataclass(frozen=True)
class StaticBound:
    """The static bound: the largest F at which *some* admissible forces balance the loads.

    Attributes
    ----------
    factor : None where there is none: nothing balances the loads (`lifted`), forces balance at any friction
        (`locked`), or the search gave up
    velocity : (N,) of the blocks on joints with associated flow, or their first acceleration where they are lifted
    normal_force : (m,) of the node pairs at the bound
    steps : programs, or steps of the interior-point method
    """

    factor: float | None
    lifted: bool
    locked: bool
    velocity: Floats
    normal_force: Floats
    steps: int


def is_proved(model: "AssemblyModel", bound: StaticBound, accuracy: float = BOUND_ACCURACY) -> bool:
    """Return whether the motion of a bound has associated flow: then no forces balance the loads beyond the bound.

    Two conditions, to an accuracy. Contacts close by a negligible part of what slip opens, or with negligible work of
    the forces of the bound or the loads of the blocks; the work of the loads is at least that of cohesion. Work is
    compared with that of friction under the load of the lighter block of each contact. Where blocks are locked, or jam
    just above another bound, an interior-point method may end anywhere below with very large forces: its motion is no
    proof there.
    """
    assert bound.factor is not None
    reduction, joints, velocity = 1.0 / bound.factor, model.joint_pairs, bound.velocity.ravel()
    opening, slip = model.opening_and_slip(velocity)
    size = np.sqrt((slip * slip).sum(axis=1))
    fastest = max(float(np.abs(opening[joints]).max(initial=0.0)), float(size.max(initial=0.0)))
    closing = np.maximum(
        (reduction * model.tan_friction * size)[model.group_of_pair] - opening, 0.0
    )[joints]
    block_loads = np.sqrt((model.load * model.load).sum(axis=1))
    lighter = np.minimum(
        block_loads[model.plus], np.where(model.minus < 0, np.inf, block_loads[model.minus])
    )
    negligible_work = accuracy * reduction * float(lighter[model.group_contact] @ size)
    lost_work = float(np.maximum(bound.normal_force, lighter[model.pair_contact])[joints] @ closing)
    cohesion = model.by_group(model.cohesion)
    cohesion = np.where(model.bolted, 0.5 * cohesion, cohesion)  # about the mean pull of a bolt
    work = float(
        (model.load.ravel() + reduction * model.mean_pulls) @ velocity
    ) - reduction * float(cohesion @ size)
    is_dilating = (
        lost_work <= negligible_work
        or float(closing.max(initial=0.0)) <= accuracy * reduction * fastest
    )
    return is_dilating and work >= -negligible_work


def static_bound(
    model: Model, velocity: Floats, limit: float, counts_cohesion: bool = True
) -> StaticBound:
    """Return the static bound of one block whose limit factor and mechanism are known.

    Parameters
    ----------
    velocity : (u,) the limit mechanism; limit : the limit factor, a lower bound of the static bound
    counts_cohesion : the limit includes all cohesion that its motion mobilises; where it does not, as on a cracked
        base, the motion is no candidate for the bound
    """
    if model.lines is not None:
        from slopekit.preie.system.strength_lines import (
            with_tangents,  # only curved laws pay for it
        )

        return _by_programs(with_tangents(model), velocity, limit)
    translating = _translating_bound(model, velocity, limit) if counts_cohesion else None
    return _by_programs(model, velocity, limit) if translating is None else translating


def _translating_bound(model: Model, velocity: Floats, limit: float) -> StaticBound | None:
    """Return the static bound of a block that does not turn, in closed form and proved by balanced forces; or None.

    Without friction, where nothing opens, the limit's mechanism is the bound's. On one plane its normal force is known,
    and the bound is the limit: with v_n = λ tan φ |v_t| the load works N λ tan φ |v_t| less, which is what friction
    would have taken. Two joints of a wedge open along their friction cones.
    """
    translations, reduction, steps = model.translations, 1.0 / limit, 0
    if not model.tan_friction.any():
        slip = float(model.slip(velocity).max())
        if float(np.abs(model.normal_rows @ velocity).max()) <= PARALLEL * slip:
            return StaticBound(limit, False, False, velocity, np.zeros(len(model.control_area)), 0)
    turning = float(np.abs(velocity[translations:]).max(initial=0.0))
    size = math.sqrt(float(velocity[:translations] @ velocity[:translations]))
    if len(model.bolt_capacity) or size == 0.0:
        return None
    v, normals = velocity[:translations] / size, model.normal_rows[:, :translations]
    flat = np.abs(normals - normals[0]).max() <= PARALLEL and len(np.unique(model.interface)) == 1
    if not flat or turning > PARALLEL:
        opening = _opening_of_wedge(model, v, reduction)
        if opening is None:
            return None
        v, reduction, steps = opening
    if not 0.0 < reduction <= (1.0 + EQUILIBRIUM) / limit:
        return None
    normal_force = _balancing_normals(model, v, reduction)
    if normal_force is None:
        return None
    moves = np.concatenate([v, np.zeros(model.unknowns - translations)])
    return StaticBound(limit if flat else 1.0 / reduction, False, False, moves, normal_force, steps)


def _opening_of_wedge(
    model: Model, v: Floats, reduction: float
) -> tuple[Floats, float, int] | None:
    """Return the unit motion (3,) that opens both joints of a wedge along their friction cones, its λ, and steps."""
    normals, pairs = np.unique(model.normal_rows[:, :3].round(12), axis=0, return_index=True)
    if len(normals) != 2 or model.translations != 3:
        return None
    rows = model.rows[pairs, :, :3]
    tan_friction = model.tan_friction[pairs]
    cohesion = np.array(
        [model.cohesion[model.interface == model.interface[k]].sum() for k in pairs]
    )
    load = model.load[:3]
    for steps in range(1, _MOST_STEPS + 1):
        motion = rows @ v
        slip = np.sqrt((motion[:, 1:] ** 2).sum(axis=1))
        if slip.min() <= ROUNDING:
            return None
        slip_slope = np.einsum("kt,ktu->ku", motion[:, 1:] / slip[:, None], rows[:, 1:, :])
        residual = np.array(
            [
                *(motion[:, 0] - reduction * tan_friction * slip),
                float(load @ v) - reduction * float(cohesion @ slip),
                (float(v @ v) - 1.0) / 2.0,
            ]
        )
        if np.abs(residual).max() < ROUNDING:
            return v, reduction, steps
        matrix = np.zeros((4, 4))
        matrix[:2, :3] = rows[:, 0, :] - (reduction * tan_friction)[:, None] * slip_slope
        matrix[:2, 3] = -tan_friction * slip
        matrix[2, :3] = load - reduction * (cohesion @ slip_slope)
        matrix[2, 3] = -float(cohesion @ slip)
        matrix[3, :3] = v
        try:
            step = -np.linalg.solve(matrix, residual)
        except np.linalg.LinAlgError:
            return None
        v, reduction = v + step[:3], reduction + float(step[3])
    return None


def _balancing_normals(model: Model, v: Floats, reduction: float) -> Floats | None:
    """Return normal forces (n,) that balance loads and moments with full friction against a velocity; None without."""
    motion = np.einsum("ntu,u->nt", model.rows[:, 1:, : len(v)], v)
    direction = motion / np.sqrt((motion * motion).sum(axis=1))[:, None]
    against = np.einsum("nt,ntu->nu", direction, model.rows[:, 1:, :])
    columns = model.normal_rows - (reduction * model.tan_friction)[:, None] * against
    target = -model.load + (reduction * model.cohesion) @ against
    normal_force, rest = non_negative_least_squares(columns.T, target)
    return normal_force if float(np.abs(rest).max()) < EQUILIBRIUM else None


def _by_programs(model: Model, velocity: Floats, limit: float) -> StaticBound:
    """Return the static bound by cone programs, as for many blocks, from 1/limit, at which the limit state balances.

    The bound has no factor where the programs exceed their work limit.
    """
    none = StaticBound(None, False, False, velocity, np.zeros(len(model.control_area)), 0)
    if len(model.control_area) > _MOST_PAIRS:
        return none
    from slopekit.preie.programs.distance import bound_by_programs
    from slopekit.preie.system.assembly import (
        one_block,
    )  # SciPy and Clarabel are loaded only where moments govern

    try:
        with work_budget(_WORK):
            bound = bound_by_programs(one_block(model), 1.0 / limit)
    except WorkSpentError:
        return none
    if bound is None or bound.factor is None or bound.factor >= BOUND_BEYOND * limit:
        return none
    # a bound below the limit is reported as it is: it shows that the limit is wrong
    factor = max(bound.factor, limit) if bound.factor > (1.0 - SAME_LIMIT) * limit else bound.factor
    return replace(bound, factor=factor, normal_force=bound.normal_force[: len(model.control_area)])
