"""The mechanism that costs least: one convex program in the block velocities.

For frozen friction forces r and tan ψ (the tangent of the dilation) it finds

    minimise    Σ r |v_t|  +  Σ T <ė>  +  κ/2 Σ a <tan ψ |v_t| - v_n>²      subject to   P·v = 1,

v_n and v_t the opening and slip of the node pairs, T and ė the passive bolts and how fast they are drawn out. The
penalty κ keeps the blocks out of each other: its gradient is the normal force. |v_t| is rounded off within
`rounding` of zero. This is the dual of "the smallest load factor at which admissible forces balance the loads"; one
block has six unknowns. Newton's method, with a line search on the slope: close to the answer the energy is flat to
rounding errors long before the forces are exact.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import DIAGONAL_SHIFT, NO_FORCE, ROUNDING, TINY

Stages = Sequence[tuple[float, float, float]]

_EYE2 = np.eye(2)
#: (penalty, rounding, relative residual) from a cold start, and the last of them for a warm one.
COLD: Stages = (
    (1e1, 1e-1, 1e-2),
    (1e3, 1e-2, 1e-2),
    (1e5, 1e-4, 1e-2),
    (1e7, 1e-6, 1e-8),
)
WARM = COLD[-1:]
_MOST_STEPS = 60  # of Newton's method, a stage
_LONGEST = 30.0  # a step is at most this many times the velocity: flat directions have no natural length


@dataclass(frozen=True)
class LeastWorkMechanism:
    """A velocity (u,) with P·v = 1 and its load factor.

    `normal_force` (n,), `friction_force` (n, 2) and `bolt_pull` (b,) are those at that factor.
    """

    velocity: Floats
    load_factor: float
    normal_force: Floats
    friction_force: Floats
    bolt_pull: Floats


@dataclass(frozen=True)
class _TrialVelocity:
    """The program at one velocity."""

    gradient: Floats
    normal_force: Floats
    strength: Floats
    direction: Floats
    slip: Floats
    overlap: Floats
    pull: Floats
    pull_slope: Floats


def least_work_mechanism(
    model: Model, friction: Floats, tan_dilation: Floats, start: Floats, stages: Stages = COLD
) -> LeastWorkMechanism:
    """Solve the program of this module.

    Parameters
    ----------
    friction : (n,) frozen r
    tan_dilation : (n,)
    start : (u,) with P·v not zero
    stages : (penalty relative to Σ r, rounding, relative residual) one after the other
    """
    load = model.load
    velocity = start / float(load @ start)
    factor = 0.0
    scale = max(float(friction.sum() + model.bolt_capacity.sum()), NO_FORCE)
    unknowns = model.unknowns
    bordered = np.zeros((unknowns + 1, unknowns + 1))
    for penalty, rounding, residual in stages:
        kappa = penalty * scale
        at = _evaluate(model, friction, tan_dilation, velocity, kappa, rounding)
        for _ in range(_MOST_STEPS):
            curvature = _curvature(model, at, tan_dilation, kappa)
            diagonal = np.diag(curvature)
            unit = 1.0 / np.sqrt(np.maximum(diagonal, ROUNDING * float(np.abs(diagonal).sum()) or 1.0))
            bordered[:unknowns, :unknowns] = curvature * unit[:, None] * unit
            bordered[np.arange(unknowns), np.arange(unknowns)] += DIAGONAL_SHIFT
            bordered[:unknowns, unknowns] = bordered[unknowns, :unknowns] = -load * unit
            solved = np.linalg.solve(bordered, np.append(-at.gradient * unit, 0.0))
            step, factor = solved[:unknowns] * unit, float(solved[unknowns])
            longest = _LONGEST * math.sqrt(float(velocity @ velocity))
            step *= min(1.0, longest / max(math.sqrt(float(step @ step)), TINY))
            forces = float(at.strength.sum() + at.normal_force.sum() + at.pull.sum())
            if float(np.abs(at.gradient - factor * load).max()) < residual * forces:
                break
            slope, length = float(at.gradient @ step), 1.0
            if not slope < 0.0:  # downhill is below rounding: this is the bottom
                break
            for _ in range(30):
                after = _evaluate(model, friction, tan_dilation, velocity + length * step, kappa, rounding)
                slope_after = float(after.gradient @ step)
                if slope_after <= 0.5 * abs(slope):
                    break
                length *= min(0.6, max(0.1, -slope / (slope_after - slope)))
            velocity, at = velocity + length * step, after
    return LeastWorkMechanism(velocity, factor, at.normal_force, -at.strength[:, None] * at.direction, at.pull)


def _evaluate(
    model: Model, friction: Floats, tan_dilation: Floats, velocity: Floats, kappa: float, rounding: float
) -> _TrialVelocity:
    motion = model.relative(velocity)
    tangential = motion[:, 1:]
    slip = np.sqrt((tangential * tangential).sum(axis=1) + rounding * rounding)
    overlap = np.maximum(tan_dilation * (slip - rounding) - motion[:, 0], 0.0)
    direction = tangential / slip[:, None]
    normal_force = kappa * model.control_area * overlap
    strength = friction + normal_force * tan_dilation
    forces = np.empty_like(motion)
    forces[:, 0] = -normal_force
    forces[:, 1:] = strength[:, None] * direction
    gradient = forces.ravel() @ model.flat_rows
    bolts = model.bolt_capacity
    if len(bolts) == 0:
        return _TrialVelocity(gradient, normal_force, strength, direction, slip, overlap, bolts, bolts)
    drawn = -model.bolt_rows @ velocity
    rounded = np.sqrt(drawn * drawn + rounding * rounding)
    pull = bolts * 0.5 * (1.0 + drawn / rounded)
    pull_slope = bolts * 0.5 * rounding * rounding / rounded**3
    return _TrialVelocity(
        gradient - pull @ model.bolt_rows, normal_force, strength, direction, slip, overlap, pull, pull_slope
    )


def _curvature(model: Model, at: _TrialVelocity, tan_dilation: Floats, kappa: float) -> Floats:
    touching = np.where(at.overlap > 0.0, kappa * model.control_area, 0.0)
    across = at.direction[:, :, None] * at.direction[:, None, :]
    blocks = np.empty((len(touching), 3, 3))
    blocks[:, 0, 0] = touching
    dilating = touching * tan_dilation
    blocks[:, 0, 1:] = blocks[:, 1:, 0] = -dilating[:, None] * at.direction
    blocks[:, 1:, 1:] = (at.strength / at.slip)[:, None, None] * (_EYE2 - across)
    blocks[:, 1:, 1:] += (dilating * tan_dilation)[:, None, None] * across
    curvature: Floats = model.flat_rows.T @ np.matmul(blocks, model.rows).reshape(-1, model.unknowns)
    if len(at.pull_slope):
        curvature = curvature + (model.bolt_rows.T * at.pull_slope) @ model.bolt_rows
    return curvature
