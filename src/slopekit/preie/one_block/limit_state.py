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
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.solvers.linear import split_space
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import (
    CARRIES,
    EQUILIBRIUM,
    FARTHEST,
    NO_FORCE,
    NO_MOTION,
    OPENS_ROUGHLY,
    PARALLEL,
    ROUNDING,
    TINY,
)
from slopekit.strength.mohr_coulomb import line

_EYE2 = np.eye(2)
_MOST_STEPS = 30  # of Newton's method
_MOST_CHANGES = 12  # of contact modes, on the way from approximate ones
_MOST_TURNS = 200  # of the motion, whose slip opens the joints that dilate


@dataclass(frozen=True)
class LimitState:
    """An equilibrium at the limit.

    Attributes
    ----------
    reduction : λ = 1/F
    normal_force : (n,); velocity : (u,) of unit length; displacement : (u,) elastic
    forces : (n, 3) normal and two tangents, at the reduced strength
    pulls : (b,) of the passive bolts
    """

    reduction: float
    normal_force: Floats
    velocity: Floats
    displacement: Floats
    forces: Floats
    pulls: Floats


def elastic_displacement(model: Model) -> Floats:
    """Displacement under the load with every pair bonded, springs of stiffness a in all directions: (u,)."""
    stiffness = model.flat_rows.T @ (np.repeat(model.control_area, 3)[:, None] * model.flat_rows)
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
    if free.shape[1] == 0 or pull < NO_FORCE:
        return None
    displacement = elastic_displacement(model)
    normal = np.maximum(-model.control_area * (model.normal_rows @ displacement), 0.0)
    strength = float(line(model.cohesion, model.tan_friction, normal).sum() + model.bolt_capacity.sum())
    if strength < NO_FORCE:
        return None
    state = limit_state(
        model, free @ along, pull / strength, closed, ~closed, np.ones(len(closed)), displacement=displacement
    )
    return None if state is None or state.reduction <= 0.0 or state.normal_force.min() < 0.0 else state


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
        if size.min() <= ROUNDING:
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
        if moved < ROUNDING:
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
    closed: Bools = normal_force > CARRIES * float(normal_force.sum())
    for _ in range(_MOST_CHANGES):
        if not closed.any():
            return None
        state = limit_state(model, velocity, reduction, closed, closed & (slip < OPENS_ROUGHLY * slip.max()), bond)
        if state is None or state.reduction <= 0.0:
            return None
        opening = model.normal_rows @ state.velocity
        pulled = closed & (state.normal_force < -EQUILIBRIUM * np.abs(state.normal_force).sum())
        pushed = ~closed & (opening < -PARALLEL)
        if not pulled.any() and not pushed.any():
            # pairs that the mechanism leaves at rest must be open in the elastic displacement
            pushed = ~closed & (np.abs(opening) <= PARALLEL) & (model.normal_rows @ state.displacement < -NO_FORCE)
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
    modes = _Modes(model, velocity, closed, hinged, bond, model.normal_rows if gap_rows is None else gap_rows)
    count = modes.free.shape[1]
    if len(modes.sliding) == 0 or count == 0:
        return None
    along = modes.free.T @ velocity
    length = float(np.sqrt(along @ along))
    if length < NO_MOTION:
        return None
    along = along / length
    elastic = np.zeros(model.unknowns - count) if displacement is None else modes.rest.T @ displacement
    for steps in range(_MOST_STEPS):
        slips = modes.slips(along)
        if slips is None:
            return None
        direction, size = slips
        normal = modes.springs @ elastic
        strength = line(modes.cohesion, modes.tan_friction, normal)
        forces = np.concatenate([normal[:, None], (-reduction * strength)[:, None] * direction], axis=1)
        out = modes.unbalanced(forces, elastic, reduction)
        norm = (float(along @ along) - 1.0) / 2.0
        scale = 1.0 + abs(reduction) * float(np.abs(strength).sum())
        residual = float(np.abs(out).max())
        if steps and max(residual, abs(norm)) < ROUNDING * scale:
            break
        matrix = modes.slopes(along, direction, size, strength, reduction)
        unit = 1.0 / np.maximum(np.abs(matrix).max(axis=0), TINY)
        try:
            step = -np.linalg.solve(matrix * unit, np.append(out, norm)) * unit
        except np.linalg.LinAlgError:
            return None
        along = along + step[:count]
        elastic = elastic + step[count : model.unknowns]
        reduction = reduction + float(step[model.unknowns])
        if not np.abs(step).max() < FARTHEST:
            return None
    else:
        if residual > EQUILIBRIUM * scale:
            return None
    at_hinges, carried = modes.at_hinges(elastic), modes.bolt_springs @ elastic
    if not modes.bolts_hold(carried, along, reduction) or not modes.hinges_hold(at_hinges, reduction):
        return None
    all_forces = np.zeros((len(closed), 3))
    all_forces[modes.sliding] = forces
    all_forces[modes.hinges] = at_hinges
    pulls = reduction * model.bolt_capacity * modes.full
    pulls[modes.square] = carried
    return LimitState(reduction, all_forces[:, 0].copy(), modes.free @ along, modes.rest @ elastic, all_forces, pulls)


class _Modes:
    """What stays while the contact modes do: rows and springs of pairs that slip, of hinges, of bolts held square.

    Attributes
    ----------
    sliding, hinges : pairs; square, full : (b,) bolts square to the movement, and those that are drawn
    free, rest : (u, k), (u, u - k) motions that keep what is closed closed, and the others
    """

    def __init__(
        self, model: Model, velocity: Floats, closed: Bools, hinged: Bools, bond: Floats, normal_rows: Floats
    ) -> None:
        self.model, unknowns = model, model.unknowns
        self.sliding = sliding = np.flatnonzero((closed | (bond > 0.0)) & ~hinged)
        self.hinges = hinges = np.flatnonzero(hinged)
        drawn = -model.bolt_rows @ velocity
        self.square = np.abs(drawn) <= NO_MOTION * math.sqrt(float(velocity @ velocity))
        self.held_bolts, self.full = model.bolt_rows[self.square], (drawn > 0.0) & ~self.square
        self.free, self.rest = split_space(
            np.concatenate([normal_rows[closed], *(model.rows[hinges, k] for k in (1, 2)), self.held_bolts])
        )
        self.rows = model.rows[sliding].reshape(-1, unknowns)
        self.slip_rows = model.rows[sliding, 1:, :] @ self.free
        self.springs = -(model.control_area * closed)[sliding, None] * (normal_rows[sliding] @ self.rest)
        self.hinge_rows = model.rows[hinges].reshape(-1, unknowns)
        self.hinge_springs = -np.repeat(model.control_area[hinges], 3)[:, None] * (self.hinge_rows @ self.rest)
        bonds = model.cohesion * bond
        self.tan_friction, self.cohesion, self.hinge_cohesion = (
            model.tan_friction[sliding],
            bonds[sliding],
            bonds[hinges],
        )
        self.bolts = (model.bolt_capacity * self.full) @ model.bolt_rows
        # bolts square to the movement: springs that carry what they must, checked against their capacity at the end
        self.bolt_springs = -(self.held_bolts @ self.rest)

    def slips(self, along: Floats) -> tuple[Floats, Floats] | None:
        """Directions (s, 2) and sizes (s,) of slip; None where a pair that should slip does not."""
        tangential = self.slip_rows @ along
        size = np.sqrt((tangential * tangential).sum(axis=1))
        return None if size.min() <= ROUNDING else (tangential / size[:, None], size)

    def at_hinges(self, elastic: Floats) -> Floats:
        """Forces (h, 3) at the hinges."""
        return (self.hinge_springs @ elastic).reshape(-1, 3)

    def unbalanced(self, forces: Floats, elastic: Floats, reduction: float) -> Floats:
        """The sum (u,) of all that acts."""
        out = forces.ravel() @ self.rows + (self.hinge_springs @ elastic) @ self.hinge_rows
        out = out + self.model.load + reduction * self.bolts
        return out + (self.bolt_springs @ elastic) @ self.held_bolts

    def slopes(
        self, along: Floats, direction: Floats, size: Floats, strength: Floats, reduction: float
    ) -> Floats:  # fmt: skip
        """How the sum and the length of the motion change (u + 1, u + 1): by the motion, by g, by λ."""
        unknowns, count = self.model.unknowns, len(along)
        turning = _EYE2 - direction[:, :, None] * direction[:, None, :]
        softer = (reduction * self.tan_friction[:, None] * self.springs)[:, None, :]
        slope = np.zeros((len(size), 3, unknowns + 1))
        slope[:, 1:, :count] = (turning * (-reduction * strength / size)[:, None, None]) @ self.slip_rows
        slope[:, 0, count:unknowns] = self.springs
        slope[:, 1:, count:unknowns] = -direction[:, :, None] * softer
        slope[:, 1:, unknowns] = -strength[:, None] * direction
        matrix = np.zeros((unknowns + 1, unknowns + 1))
        matrix[:unknowns] = self.rows.T @ slope.reshape(-1, unknowns + 1)
        matrix[:unknowns, count:unknowns] += self.hinge_rows.T @ self.hinge_springs
        matrix[:unknowns, count:unknowns] += self.held_bolts.T @ self.bolt_springs
        matrix[:unknowns, unknowns] += self.bolts
        matrix[unknowns, :count] = along
        return matrix

    def bolts_hold(self, carried: Floats, along: Floats, reduction: float) -> bool:
        """Whether bolts square to the movement carry what they can, and the others are drawn, or not, as assumed."""
        model, square, full = self.model, self.square, self.full
        capacity = reduction * model.bolt_capacity[square]
        spare = EQUILIBRIUM * (1.0 + capacity)
        speed = -model.bolt_rows @ (self.free @ along)
        is_within = not (carried < -spare).any() and not (carried > capacity + spare).any()
        return is_within and not (speed[full] < -NO_MOTION).any() and not (speed[~full & ~square] > NO_MOTION).any()

    def hinges_hold(self, forces: Floats, reduction: float) -> bool:
        """Whether no hinge is pushed beyond its strength: one that would slip is none."""
        most = line(self.hinge_cohesion, self.model.tan_friction[self.hinges], np.maximum(forces[:, 0], 0.0))
        return not (np.sqrt((forces[:, 1:] ** 2).sum(axis=1)) > reduction * most + EQUILIBRIUM).any()
