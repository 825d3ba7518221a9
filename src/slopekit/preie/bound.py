"""The static bound: the largest F at which *some* admissible forces balance the loads.

It is the limit of joints that dilate by their whole (reduced) friction angle and keep their cohesion: an upper bound
on the limit factor, unsafe as an answer. Its dual: the largest λ = 1/F for which a velocity v exists with

    v_n >= λ tan φ |v_t|  on every pair,     P·v + λ (bolts drawn out) >= λ Σ c A |v_t|.

Both sides are used: a mechanism proposes λ, and forces that balance the loads at that λ prove it.
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.arrays import Floats
from slopekit.preie.linear import nonnegative_least_squares
from slopekit.preie.mechanism import cheapest_mechanism
from slopekit.preie.model import Model

_MOST_STEPS = 40
_MOST_SLICES = 15
_PROVED = 1e-9


@dataclass(frozen=True, slots=True)
class StaticBound:
    """The bound (None: not found), whether a mechanism and forces prove it, the work done, and the mechanism (u,)."""

    factor: float | None
    proved: bool
    steps: int
    velocity: Floats


def static_bound(model: Model, velocity: Floats, limit: float) -> StaticBound:
    """The static bound of a model whose limit factor and mechanism are known.

    Parameters
    ----------
    velocity : (u,) the limit mechanism; limit : the limit factor, a lower bound of the static bound
    """
    if not len(model.bolt_capacity):
        translating = _two_joint_bound(model, velocity, limit)
        if translating is not None:
            return translating
    return _general_bound(model, velocity, limit)


def _two_joint_bound(model: Model, velocity: Floats, limit: float) -> StaticBound | None:
    """Both joints of a wedge opening along their friction cones without turning: three equations, then the proof."""
    normals, which = np.unique(model.normal_rows[:, :3].round(12), axis=0, return_index=True)
    if len(normals) != 2:
        return None
    rows = model.rows[which, :, :3]
    tan_friction = model.tan_friction[which]
    cohesion = np.array([model.cohesion[model.interface == model.interface[k]].sum() for k in which])
    load = model.load[:3]
    v, reduction = velocity[:3] / math.sqrt(float(velocity[:3] @ velocity[:3])), 1.0 / limit
    steps = 0
    while steps < _MOST_STEPS:
        steps += 1
        motion = rows @ v
        slip = np.sqrt((motion[:, 1:] ** 2).sum(axis=1))
        if slip.min() <= 1e-12:
            return None
        slip_slope = np.einsum("kt,ktu->ku", motion[:, 1:] / slip[:, None], rows[:, 1:, :])
        out = np.array([
            *(motion[:, 0] - reduction * tan_friction * slip),
            float(load @ v) - reduction * float(cohesion @ slip),
            (float(v @ v) - 1.0) / 2.0,
        ])  # fmt: skip
        if np.abs(out).max() < 1e-14:
            break
        matrix = np.zeros((4, 4))
        matrix[:2, :3] = rows[:, 0, :] - (reduction * tan_friction)[:, None] * slip_slope
        matrix[:2, 3] = -tan_friction * slip
        matrix[2, :3] = load - reduction * (cohesion @ slip_slope)
        matrix[2, 3] = -float(cohesion @ slip)
        matrix[3, :3] = v
        try:
            step = -np.linalg.solve(matrix, out)
        except np.linalg.LinAlgError:
            return None
        v, reduction = v + step[:3], reduction + float(step[3])
    else:
        return None
    if not 0.0 < reduction <= (1.0 + _PROVED) / limit:
        return None
    if not _balances(model, v, reduction):
        return None
    return StaticBound(1.0 / reduction, True, steps, np.concatenate([v, np.zeros(model.unknowns - 3)]))


def _balances(model: Model, v: Floats, reduction: float) -> bool:
    """Whether forces on the edges of the friction cones, against v, balance the loads with their moments."""
    motion = np.einsum("ntu,u->nt", model.rows[:, 1:, :3], v)
    direction = motion / np.sqrt((motion * motion).sum(axis=1))[:, None]
    against = np.einsum("nt,ntu->nu", direction, model.rows[:, 1:, :])
    columns = model.normal_rows - (reduction * model.tan_friction)[:, None] * against
    target = -model.load + (reduction * model.cohesion) @ against
    _, rest = nonnegative_least_squares(columns.T, target)
    return float(np.abs(rest).max()) < _PROVED


def _general_bound(model: Model, velocity: Floats, limit: float) -> StaticBound:
    """The root of φ(λ), the least energy of dilating mechanisms on the slice q·v = 1, by Newton's method.

    The penalty of the convex program shifts the root by a part proportional to 1/κ: two penalties and Richardson's
    extrapolation take that away.
    """
    v, reduction, steps = velocity, 1.0 / limit, 0
    found = []
    for stages in (((1e2, 1e-2, 1e-2),), ((1e4, 1e-4, 1e-3),), ((1e5, 1e-6, 1e-8),), ((1e6, 1e-7, 1e-8),)):
        v = v / math.sqrt(float(v @ v))
        slice_ = v + 0.1 * model.load  # through the best mechanism yet, so that penalties keep their scale
        for _ in range(_MOST_SLICES):
            here = cheapest_mechanism(
                model, reduction * model.cohesion, reduction * model.tan_friction, v, model.load, slice_,
                reduction * model.bolt_capacity, _relative(stages, model, reduction),
            )  # fmt: skip
            v, steps = here.velocity, steps + here.steps
            slope = float((model.cohesion + model.tan_friction * here.normal_force) @ here.slip)
            if len(model.bolt_capacity):
                slope += float(model.bolt_capacity @ np.maximum(-model.bolt_rows @ v, 0.0))
            if not slope > 0.0:
                return StaticBound(None, False, steps, v)
            renewed = min(max(reduction - here.energy / slope, 0.3 * reduction), 3.0 * reduction)
            done = abs(renewed - reduction) <= stages[0][2] * 0.1 * reduction
            reduction = renewed
            if done:
                break
        found.append(reduction)
    reduction = found[-1] + (found[-1] - found[-2]) / 9.0
    if not here.settled:
        return StaticBound(None, False, steps, v)
    return StaticBound(max(1.0 / reduction, limit), False, steps, v)


def _relative(
    stages: tuple[tuple[float, float, float], ...], model: Model, reduction: float
) -> tuple[tuple[float, float, float], ...]:
    """The stages with their penalty in parts of the load, not of the (reduced) cohesion."""
    scale = max(reduction * float(model.cohesion.sum() + model.bolt_capacity.sum()), 1e-12)
    return tuple((penalty / scale, rounding, residual) for penalty, rounding, residual in stages)
