"""The end of an elastic path: its limit, and the exact limit state of its contact modes (stage L)."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.linalg import lapack

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState
from slopekit.preie.tolerances import (
    ADMISSIBLE,
    EQUILIBRIUM,
    MODES_SHIFT,
    NO_MOTION,
    OPENS_ROUGHLY,
    ROUGHLY_SETTLED,
    SAME_LIMIT,
    TINY,
)

BORDERED = 1000  # unknowns up to which a limit state is solved for: its matrix is dense
_MAX_DIRECTION_UPDATES = 12  # how often directions of slip in space follow the motion


class PathOutcome(StrEnum):
    """The end of an elastic path."""

    LIMIT = "limit state"
    SETTLED = "the running forces stopped changing"
    BRACKET = "last state at rest"
    STANDS = "stands without strength"
    NO_REST = "comes to rest at no strength"
    GAVE_UP = "the search gave up"


@dataclass(frozen=True)
class PathLimit:
    """The limit that an elastic path found, or the state in which it ended.

    Attributes
    ----------
    outcome, parameter : λ = 1/F or the load multiplier, None where there is none
    peak : the last parameter at rest, and the first that runs
    motion : (N,) of the mechanism, its largest part 1; normal : (m,); friction : (g, t)
    bond : (m,) share of the cohesion that acts
    displacement : (N,) of the elastic joints
    reduction : λ of the joints there
    residual : largest unbalanced force in parts of the largest load
    last_near : the last parameter at rest within `RUNS` elastic displacements, where the blocks crept on from there;
        nan where they did not, or were never at rest so near
    group : blocks that were not held when it was found, 0 where none was; width : how much nearer than that, in
        parts of it, all blocks were not seen at rest
    factorisations : work done
    rounding : what the law of the joints is rounded by in that state, in parts of their elastic energy
    touching : (m,) there, where it is rounded; else what presses touches
    """

    outcome: PathOutcome
    parameter: float | None
    peak: tuple[float, float] | None
    displacement: Floats
    motion: Floats
    normal: Floats
    friction: Floats
    reduction: float
    residual: float
    factorisations: int
    bond: Floats
    last_near: float = math.nan
    group: int = 0
    width: float = 0.0
    rounding: float = 0.0
    touching: Bools | None = None

    @property
    def is_limit(self) -> bool:
        """Return whether the path ended in a limit state, not a bracket."""
        return self.outcome in (PathOutcome.LIMIT, PathOutcome.SETTLED)


def result_of(
    bed: ElasticContactModel,
    outcome: PathOutcome,
    parameter: float | None,
    peak: tuple[float, float] | None,
    displacement: Floats,
    motion: Floats,
    forces: ContactState,
) -> PathLimit:
    """Return the end of a path from its state: displacement (N,), motion (N,), forces; the motion is normalised."""
    fastest = max(float(np.abs(motion).max(initial=0.0)), TINY)
    return PathLimit(
        outcome,
        parameter,
        peak,
        displacement,
        motion / fastest,
        forces.normal,
        forces.friction,
        bed.drive.strength_and_load(parameter or 1.0)[0],
        forces.residual / bed.load_size,
        bed.factorisations,
        bed.bond if forces.pressed is None else forces.pressed.share[bed.model.group_of_pair],
    )


def limit_state(
    bed: ElasticContactModel, displacement: Floats, motion: Floats, parameter: float
) -> PathLimit | None:
    """Return the exact limit state of the contact modes at a displacement (stage L); None where there is none.

    The displacement is t v + w: v the motion, along which nothing changes, w the elastic part. Newton on w
    and the parameter, modes held; accepted only if residual, N >= 0, |T| <= λ r, and the motion all agree. In space
    the directions of slip are those of the motion, until they stay the same.
    """
    modes = bed.forces(displacement, parameter)
    direction = motion / np.sqrt(float(motion @ motion))
    displacement = displacement - direction * (
        float((across := bed.viscous(direction)) @ displacement) / float(across @ direction)
    )
    for _ in range(1 if bed.tangents == 1 else _MAX_DIRECTION_UPDATES):
        opens = bed.opening_contacts(direction, parameter, OPENS_ROUGHLY)
        state = _limit_of_modes(
            bed.without_cohesion_where(opens), modes, displacement, direction, parameter
        )
        if state is None:
            return None
        last_parameter = parameter
        displacement, parameter, contact_state, direction, agrees = state
        if agrees and (bed.opening_contacts(direction, parameter, NO_MOTION) != opens).any():
            return None
        # the error of a dilating joint's limit is of first order in its slip direction, else of second order
        is_turning = (
            bed.dilates
            and bed.tangents > 1
            and abs(parameter - last_parameter) > ROUGHLY_SETTLED * parameter
        )
        if agrees and not is_turning:
            return result_of(
                bed, PathOutcome.LIMIT, parameter, None, displacement, direction, contact_state
            )
        if bed.tangents == 1:
            return None
        modes = bed.with_slip_directions(modes, direction)
    return None


def _limit_of_modes(
    bed: ElasticContactModel, modes: ContactState, w: Floats, v: Floats, parameter: float
) -> tuple[Floats, float, ContactState, Floats, bool] | None:
    """Return displacement w, parameter, forces and motion of contact modes, and whether that motion has them.

    None where the state is inadmissible.
    """
    across = bed.viscous(v)
    norm = float(across @ v)
    for _ in range(8):
        contact_state = bed.forces(w, parameter, modes=modes)
        solver = _bordered_solver(bed, contact_state, parameter, across)
        if solver is None:
            return None
        change = solver(np.append(contact_state.unbalanced, -float(across @ w)))
        if not np.isfinite(change).all():
            return None
        w, parameter = w + change[:-1], parameter + float(change[-1])
        if abs(float(change[-1])) < 1e-13 * abs(parameter) and float(
            np.abs(change[:-1]).max()
        ) < 1e-12 * float(np.abs(w).max()):
            break
    contact_state = bed.forces(w, parameter, modes=modes)
    reduction, _ = bed.drive.strength_and_load(parameter)
    spare = reduction * contact_state.strength - np.sqrt(
        (contact_state.friction * contact_state.friction).sum(axis=1)
    )
    outside = -min(float(contact_state.normal.min()), float(spare.min()))
    if bed.bolted is not None:
        outside = max(outside, -float(contact_state.friction[bed.bolted, 0].min()))
    is_off = contact_state.residual > EQUILIBRIUM * max(modes.largest, contact_state.largest)
    if parameter <= 0.0 or is_off or outside > ADMISSIBLE * bed.load_size:
        return None
    solver = _bordered_solver(bed, contact_state, parameter, across)
    if solver is not None:  # the null vector of the stiffness
        motion = solver(np.append(np.zeros(bed.size), norm))
        if abs(float(motion[-1])) < NO_MOTION * abs(parameter) and _motion_has_modes(
            bed, contact_state, motion[:-1], parameter, NO_MOTION
        ):
            return w, parameter, contact_state, motion[:-1], True
        if bed.tangents > 1 and abs(float(motion[-1])) < SAME_LIMIT * abs(parameter):
            has_motion = _motion_has_modes(
                bed, contact_state, v, parameter, NO_MOTION
            )  # and the flow is one of them
            return w, parameter, contact_state, v if has_motion else motion[:-1], has_motion
    agrees = _motion_has_modes(
        bed, contact_state, v, parameter, 1e-4
    )  # there are several: the flow itself
    return (w, parameter, contact_state, v, True) if agrees else None


def _bordered_solver(
    bed: ElasticContactModel, contact_state: ContactState, parameter: float, across: Floats
) -> Callable[[Floats], Floats] | None:
    """Return a solver of the stiffness of contact modes, bordered by the parameter and the equation `across`."""
    size = bed.size
    matrix = np.zeros((size + 1, size + 1))
    local = bed.tangent(contact_state, parameter, turning=False) + MODES_SHIFT * bed.elastic
    matrix[:-1, :-1] = bed.stiffness.dense(local)
    matrix[:-1, -1] = -bed.parameter_derivative(contact_state, parameter)
    matrix[-1, :-1] = across
    lu, pivots, info = lapack.dgetrf(matrix)
    if info != 0:
        return None

    def solve(right: Floats) -> Floats:
        solution: Floats = lapack.dgetrs(lu, pivots, right)[0]
        return solution

    return solve


def _motion_has_modes(
    bed: ElasticContactModel,
    modes: ContactState,
    motion: Floats,
    parameter: float,
    tolerance: float,
) -> bool:
    """Return whether a motion opens, slips and sticks as the modes say, to a tolerance in parts of its fastest."""
    opening, slip = bed.motion(motion, parameter)
    forward = (slip * modes.direction).sum(axis=1)
    transverse = np.abs(slip - forward[:, None] * modes.direction).max(axis=1)
    transverse[~modes.slips] = np.abs(slip[~modes.slips]).max(axis=1)
    threshold = tolerance * max(float(np.abs(opening).max()), float(np.abs(slip).max()))
    return (
        float(opening.min()) > -threshold
        and float(opening[modes.touching].max(initial=0.0)) < threshold
        and float(forward[modes.slips].min(initial=0.0)) > -threshold
        and float(transverse.max()) < threshold
    )
