"""The limit state at infinite slip, exact: Newton's method once it is known which pairs touch, slip and stick.

Where slip does not dilate the joints, a block that slides for ever keeps its closed pairs closed: its velocity v
lies in the null space Z of their normals. The normal forces come from an elastic displacement g in the rest Y of the
space, however small the springs' give: N = -a B_n Y g. With λ = 1/F the unknowns are the direction of v within Z, g
and λ: as many as the block has, and one.

    Bᵀ f + P + λ P_bolts = 0,    f_n = N,    f_t = -λ (χ c A + N tan φ) v_t / |v_t|,    |v| = 1

χ is 0 for pairs that have lost their cohesion. Hinges (closed pairs that do not slip) are springs in all
directions, within their strength.
"""

import math

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.records import dataclass
from slopekit.preie.linear import split_space
from slopekit.preie.model import Model
from slopekit.preie.tolerances import LOST_STEP, NOT_DRAWN, TINY
from slopekit.strength.mohr_coulomb import line

_EYE2 = np.eye(2)
_MOST_STEPS = 30  # of Newton's method
_MOST_CHANGES = 12  # of contact modes, on the way from approximate ones
_MOST_TURNS = 200  # of the motion, whose slip opens the joints that dilate


@dataclass(frozen=True, slots=True)
class LimitState:
    """An equilibrium at the limit.

    Attributes
    ----------
    reduction : λ = 1/F
    normal_force : (n,); velocity : (u,) of unit length; displacement : (u,) elastic
    forces : (n, 3) normal and two tangents, at the reduced strength
    pulls : (b,) of the passive bolts
    residual : largest unbalanced generalised force in parts of the load
    """

    reduction: float
    normal_force: Floats
    velocity: Floats
    displacement: Floats
    forces: Floats
    pulls: Floats
    residual: float


def elastic_displacement(model: Model) -> Floats:
    """Displacement under the load with every pair bonded, springs of stiffness a in all directions: (u,)."""
    weighted = np.repeat(model.control_area, 3)[:, None] * model.flat_rows
    stiffness = model.flat_rows.T @ weighted
    try:
        return np.asarray(np.linalg.solve(stiffness, model.load), dtype=np.float64)
    except np.linalg.LinAlgError:  # a sheet a thousand million times as long as thick has no stiffness against turning
        return np.asarray(np.linalg.lstsq(stiffness, model.load)[0], dtype=np.float64)


def intact_limit_state(model: Model) -> LimitState | None:
    """The limit state with every pair closed and every cohesion whole, or None where there is no such state.

    This is the whole answer for a wedge that slides on both its joints and presses on all of both.
    """
    closed: Bools = np.ones(len(model.control_area), dtype=bool)
    free, _ = split_space(model.normal_rows)
    along = free.T @ model.load
    pull = float(np.sqrt(along @ along))
    if free.shape[1] == 0 or pull < 1e-12:
        return None
    displacement = elastic_displacement(model)
    normal = np.maximum(-model.control_area * (model.normal_rows @ displacement), 0.0)
    strength = float(line(model.cohesion, model.tan_friction, normal).sum() + model.bolt_capacity.sum())
    if strength < 1e-14:
        return None
    state = limit_state(
        model, free @ along, pull / strength, closed, ~closed, np.ones(len(closed)), displacement=displacement
    )
    if state is None or state.reduction <= 0.0 or state.normal_force.min() < 0.0:
        return None
    return state


def dilating_limit_state(model: Model, start: LimitState) -> LimitState | None:
    """The limit state of joints that dilate as they slip, no bond lost, or None.

    A closed pair then keeps v_n = tan ψ |v_t|: its gap grows by (n - tan ψ e)·v, e the direction of its slip. Those
    rows take the normals' place, and are renewed with v (and with λ where ψ is capped by the reduced friction angle).

    Parameters
    ----------
    start : the limit state without dilation
    """
    closed: Bools = np.ones(len(model.control_area), dtype=bool)
    hinged: Bools = np.zeros(len(closed), dtype=bool)
    velocity, state = start.velocity, start
    for _ in range(_MOST_TURNS):
        motion = model.relative(velocity)[:, 1:]
        size = np.sqrt((motion * motion).sum(axis=1))
        if size.min() <= 1e-12:
            return None
        tan_dilation = np.minimum(model.tan_dilation, state.reduction * model.tan_friction)
        along_slip = np.einsum("nt,ntu->nu", motion / size[:, None], model.rows[:, 1:, :])
        gap_rows = model.normal_rows - tan_dilation[:, None] * along_slip
        next_state = limit_state(
            model, velocity, state.reduction, closed, hinged, np.ones(len(closed)), state.displacement, gap_rows
        )
        if next_state is None or next_state.reduction <= 0.0:
            return None
        moved = float(np.abs(next_state.velocity - velocity).max()) + abs(next_state.reduction / state.reduction - 1.0)
        velocity, state = next_state.velocity, next_state
        if moved < 1e-13:
            pulled = closed & (state.normal_force < 0.0)
            if not pulled.any():
                return state
            closed = closed & ~pulled
    return None


def settled_limit_state(
    model: Model, velocity: Floats, reduction: float, normal_force: Floats, bond: Floats
) -> LimitState | None:
    """Polish an approximate mechanism: pairs pulled apart are let go, pairs pushed together are closed.

    Parameters
    ----------
    velocity, reduction, normal_force : from the passes of `limit`
    bond : (n,) χ

    Returns
    -------
    The limit state, or None where the contact modes do not settle.
    """
    velocity = velocity / float(np.sqrt(velocity @ velocity))
    slip = model.slip(velocity)
    total = float(normal_force.sum())
    closed: Bools = normal_force > 1e-6 * total
    for _ in range(_MOST_CHANGES):
        if not closed.any():
            return None
        state = limit_state(model, velocity, reduction, closed, closed & (slip < 1e-4 * slip.max()), bond)
        if state is None or state.reduction <= 0.0:
            return None
        opening = model.normal_rows @ state.velocity
        pulled = closed & (state.normal_force < -1e-10 * np.abs(state.normal_force).sum())
        pushed = ~closed & (opening < -1e-8)
        if not pulled.any() and not pushed.any():
            # pairs that the mechanism leaves at rest must be open in the elastic displacement
            pushed = ~closed & (np.abs(opening) <= 1e-8) & (model.normal_rows @ state.displacement < -1e-12)
            if not pushed.any():
                return state
        closed = (closed & ~pulled) | pushed
    return None


def limit_state(
    model: Model, velocity: Floats, reduction: float, closed: Bools, hinged: Bools, bond: Floats,
    displacement: Floats | None = None, gap_rows: Floats | None = None,
) -> LimitState | None:  # fmt: skip
    """Newton's method for given contact modes; None where it does not converge.

    Parameters
    ----------
    velocity, reduction : where to start
    closed : (n,) pairs that carry normal force; hinged : (n,) those of them that do not slip
    bond : (n,) χ
    gap_rows : (n, u) what keeps a closed pair closed, where that is not its normal (dilation)
    """
    unknowns = model.unknowns
    sliding = np.flatnonzero((closed | (bond > 0.0)) & ~hinged)
    hinges = np.flatnonzero(hinged)
    if len(sliding) == 0:
        return None
    normal_rows = model.normal_rows if gap_rows is None else gap_rows
    drawn = -model.bolt_rows @ velocity
    square = np.abs(drawn) <= NOT_DRAWN * math.sqrt(float(velocity @ velocity))
    held_bolts, full = model.bolt_rows[square], (drawn > 0.0) & ~square
    free, rest = split_space(
        np.concatenate([normal_rows[closed], *(model.rows[hinges, k] for k in (1, 2)), held_bolts])
    )
    count = free.shape[1]
    if count == 0:
        return None
    along = free.T @ velocity
    length = float(np.sqrt(along @ along))
    if length < 1e-6:
        return None
    elastic = np.zeros(unknowns - count) if displacement is None else rest.T @ displacement
    rows = model.rows[sliding].reshape(-1, unknowns)
    slip_rows = model.rows[sliding, 1:, :] @ free
    springs = -(model.control_area * closed)[sliding, None] * (normal_rows[sliding] @ rest)
    hinge_rows = model.rows[hinges].reshape(-1, unknowns)
    hinge_springs = -np.repeat(model.control_area[hinges], 3)[:, None] * (hinge_rows @ rest)
    tan_friction, cohesion = model.tan_friction[sliding], (model.cohesion * bond)[sliding]
    bolts = (model.bolt_capacity * full) @ model.bolt_rows
    # bolts square to the movement: springs that carry what they must, checked against their capacity at the end
    bolt_springs = -(held_bolts @ rest)

    along = along / length
    matrix = np.zeros((unknowns + 1, unknowns + 1))
    forces = np.empty((len(sliding), 3))
    slope = np.empty((len(sliding), 3, unknowns + 1))
    scale = 1.0
    for steps in range(_MOST_STEPS):
        tangential = slip_rows @ along
        size = np.sqrt((tangential * tangential).sum(axis=1))
        if size.min() <= 1e-14:
            return None
        direction = tangential / size[:, None]
        normal = springs @ elastic
        strength = line(cohesion, tan_friction, normal)
        forces[:, 0] = normal
        forces[:, 1:] = (-reduction * strength)[:, None] * direction
        hinge_forces = hinge_springs @ elastic
        out = forces.ravel() @ rows + hinge_forces @ hinge_rows + model.load + reduction * bolts
        out = out + (bolt_springs @ elastic) @ held_bolts
        norm = (float(along @ along) - 1.0) / 2.0
        scale = 1.0 + abs(reduction) * float(np.abs(strength).sum())
        residual = float(np.abs(out).max())
        if steps and max(residual, abs(norm)) < 1e-13 * scale:
            break
        turning = (_EYE2 - direction[:, :, None] * direction[:, None, :]) * (-reduction * strength / size)[
            :, None, None
        ]
        slope[:, 0, :count] = 0.0
        slope[:, 1:, :count] = turning @ slip_rows
        slope[:, 0, count:unknowns] = springs
        slope[:, 1:, count:unknowns] = (
            -direction[:, :, None] * (reduction * tan_friction[:, None] * springs)[:, None, :]
        )
        slope[:, 0, unknowns] = 0.0
        slope[:, 1:, unknowns] = -strength[:, None] * direction
        matrix[:unknowns] = rows.T @ slope.reshape(-1, unknowns + 1)
        matrix[:unknowns, count:unknowns] += hinge_rows.T @ hinge_springs
        matrix[:unknowns, count:unknowns] += held_bolts.T @ bolt_springs
        matrix[:unknowns, unknowns] += bolts
        matrix[unknowns, :count] = along
        unit = 1.0 / np.maximum(np.abs(matrix).max(axis=0), TINY)
        try:
            step = -np.linalg.solve(matrix * unit, np.append(out, norm)) * unit
        except np.linalg.LinAlgError:
            return None
        along = along + step[:count]
        elastic = elastic + step[count:unknowns]
        reduction = reduction + float(step[unknowns])
        if not np.abs(step).max() < LOST_STEP:
            return None
    else:
        if residual > 1e-9 * scale:
            return None
    carried, speed = bolt_springs @ elastic, -model.bolt_rows @ (free @ along)
    spare = 1e-9 * (1.0 + reduction * model.bolt_capacity[square])
    if (carried < -spare).any() or (carried > reduction * model.bolt_capacity[square] + spare).any():
        return None
    if (speed[full] < -NOT_DRAWN).any() or (speed[~full & ~square] > NOT_DRAWN).any():
        return None
    at_hinges = hinge_forces.reshape(-1, 3)
    shear = np.sqrt((at_hinges[:, 1:] ** 2).sum(axis=1))
    most = line((model.cohesion * bond)[hinges], model.tan_friction[hinges], np.maximum(at_hinges[:, 0], 0.0))
    if (shear > reduction * most + 1e-9).any():
        return None  # a hinge that would slip is none
    all_forces = np.zeros((len(closed), 3))
    all_forces[sliding] = forces
    all_forces[hinges] = at_hinges
    pulls = reduction * model.bolt_capacity * full
    pulls[square] = carried
    return LimitState(reduction, all_forces[:, 0].copy(), free @ along, rest @ elastic, all_forces, pulls, residual)
