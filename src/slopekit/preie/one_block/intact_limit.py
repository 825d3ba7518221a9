"""The limit of one block that slides with every node pair pressed, exact: a closed start that proves itself.

A block that slides for ever keeps its pairs closed: its velocity v lies in the null space Z of their normals. The
normal forces come from an elastic displacement g in the rest Y of the space, however small the springs' give:
N = -a B_n Y g. With λ = 1/F the unknowns are v within Z, g and λ: as many as the block has, and one.

    Bᵀ f + P + λ P_bolts = 0,    f_n = N,    f_t = -λ (c A + N tan φ) v_t / |v_t|,    |v| = 1
"""

import math

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.outcome import Limit, Outcome
from slopekit.preie.solvers.linear import split_space
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import FARTHEST, NO_FORCE, NO_MOTION, ROUNDING, TINY
from slopekit.strength.mohr_coulomb import line

_STEPS = 30  # of Newton's method
_EYE = np.eye(2)


def intact_limit(model: Model, displacement: Floats) -> Limit | None:
    """Return the limit of a slide with every node pair pressed and all cohesion; None where there is no such slide.

    Bolts normal to the motion, curved laws and dilation are left to the elastic path.

    Parameters
    ----------
    displacement : (u,) under the load with every pair bonded
    """
    free, rest = split_space(model.normal_rows)
    along = free.T @ model.load
    pull = math.sqrt(float(along @ along))
    if pull < NO_FORCE or model.dilates or model.lines is not None:
        return None
    along, elastic = along / pull, rest.T @ displacement
    springs = -model.control_area[:, None] * (model.normal_rows @ rest)
    extension = -model.bolt_rows @ (free @ along)
    pulls = model.bolt_capacity * (extension > 0.0)
    strength = line(model.cohesion, model.tan_friction, np.maximum(springs @ elastic, 0.0))
    total = float(strength.sum() + pulls.sum())
    if total < NO_FORCE:
        return None
    reduction, slip_rows, bolts = pull / total, model.rows[:, 1:] @ free, pulls @ model.bolt_rows
    for steps in range(_STEPS):
        slip = slip_rows @ along
        size = np.sqrt((slip * slip).sum(axis=1))
        if size.min() <= ROUNDING:
            return None
        direction, normal = slip / size[:, None], springs @ elastic
        strength = line(model.cohesion, model.tan_friction, normal)
        friction = (-reduction * strength)[:, None] * direction
        imbalance = (
            np.column_stack([normal, friction]).ravel() @ model.flat_rows
            + model.load
            + reduction * bolts
        )
        residual = np.append(imbalance, (along @ along - 1.0) / 2.0)
        if steps and np.abs(residual).max() < ROUNDING * (
            1.0 + abs(reduction) * float(np.abs(strength).sum())
        ):
            break
        slopes = np.zeros((len(size), 3, len(residual)))
        turning = (_EYE - direction[:, :, None] * direction[:, None]) * (
            -reduction * strength / size
        )[:, None, None]
        slopes[:, 1:, : len(along)] = turning @ slip_rows
        slopes[:, 0, len(along) : -1] = springs
        softer = (reduction * model.tan_friction)[:, None] * springs
        slopes[:, 1:, len(along) : -1] = -direction[:, :, None] * softer[:, None]
        slopes[:, 1:, -1] = -strength[:, None] * direction
        matrix = np.zeros((len(residual), len(residual)))
        matrix[:-1] = model.flat_rows.T @ slopes.reshape(-1, len(residual))
        matrix[:-1, -1] += bolts
        matrix[-1, : len(along)] = along
        unit = 1.0 / np.maximum(np.abs(matrix).max(axis=0), TINY)
        try:
            step = -np.linalg.solve(matrix * unit, residual) * unit
        except np.linalg.LinAlgError:
            return None
        if not np.abs(step).max() < FARTHEST:
            return None
        along, elastic, reduction = (
            along + step[: len(along)],
            elastic + step[len(along) : -1],
            reduction + step[-1],
        )
    else:
        return None
    velocity = free @ along
    speed = -model.bolt_rows @ velocity
    bolts_agree = (speed[pulls > 0.0] > NO_MOTION).all() and (
        speed[pulls == 0.0] < -NO_MOTION
    ).all()
    if not (reduction > 0.0 and normal.min() >= 0.0 and bolts_agree):
        return None
    return Limit(
        Outcome.SLIDES,
        1.0 / float(reduction),
        velocity,
        normal,
        np.ones(len(normal)),
        0,
        0.0,
        friction,
        reduction * pulls,
    )
