"""What a path ends in: its limit, and the limit state of the contact modes that its motion has (stage L), exact."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.linalg import lapack

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces
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

BORDERED = 1000  # unknowns up to which it is tried: its matrix is dense
_TURNS = 12  # how often directions of slip in space follow the motion


class PathOutcome(StrEnum):
    """How the path ended."""

    LIMIT = "limit state"
    SETTLED = "the running forces stopped changing"
    BRACKET = "last state at rest"
    STANDS = "stands without strength"
    NO_REST = "comes to rest at no strength"
    GAVE_UP = "the search gave up"


@dataclass(frozen=True)
class PathLimit:
    """What the path found.

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
    def found(self) -> bool:
        """Whether it is a limit state."""
        return self.outcome in (PathOutcome.LIMIT, PathOutcome.SETTLED)


def result_of(
    bed: Bed, outcome: PathOutcome, parameter: float | None, peak: tuple[float, float] | None, at: Floats,
    motion: Floats, forces: BedForces,
) -> PathLimit:  # fmt: skip
    fastest = max(float(np.abs(motion).max(initial=0.0)), TINY)
    return PathLimit(
        outcome, parameter, peak, at, motion / fastest, forces.normal, forces.friction,
        bed.drive.at(parameter or 1.0)[0], forces.residual / bed.load_size, bed.factorisations,
        bed.bond if forces.pressed is None else forces.pressed.share[bed.model.group_of_pair],
    )  # fmt: skip


def limit_state(bed: Bed, at: Floats, moved: Floats, parameter: float) -> PathLimit | None:
    """Stage L: the exact limit state of the contact modes at a displacement; None where there is none.

    The displacement is t v + w: v the motion, along which nothing changes, w what the joints have given. Newton on w
    and the parameter, modes held; accepted only if residual, N >= 0, |T| <= λ r, and the motion all agree. In space
    the directions of slip are those of the motion found, until they stay.
    """
    modes = bed.forces(at, parameter)
    v = moved / np.sqrt(float(moved @ moved))
    at = at - v * (float((across := bed.viscous(v)) @ at) / float(across @ v))
    for _ in range(1 if bed.tangents == 1 else _TURNS):
        opened = bed.opened_by(v, parameter, OPENS_ROUGHLY)
        state = _of_modes(bed.with_opened(opened), modes, at, v, parameter)
        if state is None:
            return None
        before = parameter
        at, parameter, here, v, agrees = state
        if agrees and (bed.opened_by(v, parameter, NO_MOTION) != opened).any():
            return None
        # what opens with the slip moves the parameter by as much as its directions are off, else by the square of that
        turns = bed.dilates and bed.tangents > 1 and abs(parameter - before) > ROUGHLY_SETTLED * parameter
        if agrees and not turns:
            return result_of(bed, PathOutcome.LIMIT, parameter, None, at, v, here)
        if bed.tangents == 1:
            return None
        modes = bed.turned(modes, v)
    return None


def _of_modes(
    bed: Bed, modes: BedForces, w: Floats, v: Floats, parameter: float
) -> tuple[Floats, float, BedForces, Floats, bool] | None:
    """Displacement w, parameter, forces and motion of the modes, and whether the motion has them; None: inadmissible"""
    across = bed.viscous(v)
    along = float(across @ v)
    for _ in range(8):
        here = bed.forces(w, parameter, modes=modes)
        solver = _bordered(bed, here, parameter, across)
        if solver is None:
            return None
        change = solver(np.append(here.unbalanced, -float(across @ w)))
        if not np.isfinite(change).all():
            return None
        w, parameter = w + change[:-1], parameter + float(change[-1])
        if abs(float(change[-1])) < 1e-13 * abs(parameter) and float(np.abs(change[:-1]).max()) < 1e-12 * float(
            np.abs(w).max()
        ):
            break
    here = bed.forces(w, parameter, modes=modes)
    reduction, _ = bed.drive.at(parameter)
    spare = reduction * here.strength - np.sqrt((here.friction * here.friction).sum(axis=1))
    outside = -min(float(here.normal.min()), float(spare.min()))
    if bed.bolted is not None:
        outside = max(outside, -float(here.friction[bed.bolted, 0].min()))
    is_off = here.residual > EQUILIBRIUM * max(modes.largest, here.largest)
    if parameter <= 0.0 or is_off or outside > ADMISSIBLE * bed.load_size:
        return None
    solver = _bordered(bed, here, parameter, across)
    if solver is not None:  # the null vector of the stiffness
        motion = solver(np.append(np.zeros(bed.size), along))
        if abs(float(motion[-1])) < NO_MOTION * abs(parameter) and _moves(bed, here, motion[:-1], parameter, NO_MOTION):
            return w, parameter, here, motion[:-1], True
        if bed.tangents > 1 and abs(float(motion[-1])) < SAME_LIMIT * abs(parameter):
            several = _moves(bed, here, v, parameter, NO_MOTION)  # and the flow is one of them
            return w, parameter, here, v if several else motion[:-1], several
    agrees = _moves(bed, here, v, parameter, 1e-4)  # there are several: the flow itself
    return (w, parameter, here, v, True) if agrees else None


def _bordered(bed: Bed, here: BedForces, parameter: float, across: Floats) -> Callable[[Floats], Floats] | None:
    """A solver of the modes' stiffness with the parameter as one more unknown and `across` as one more equation."""
    size = bed.size
    matrix = np.zeros((size + 1, size + 1))
    local = bed.tangent(here, parameter, turning=False) + MODES_SHIFT * bed.elastic
    matrix[:-1, :-1] = bed.stiffness.dense(local)
    matrix[:-1, -1] = -bed.by_parameter(here, parameter)
    matrix[-1, :-1] = across
    lu, pivots, info = lapack.dgetrf(matrix)
    if info != 0:
        return None

    def solve(right: Floats) -> Floats:
        solution: Floats = lapack.dgetrs(lu, pivots, right)[0]
        return solution

    return solve


def _moves(bed: Bed, modes: BedForces, motion: Floats, parameter: float, part: float) -> bool:
    """Whether a motion opens, slips and holds what the modes say, up to a part of its fastest."""
    opening, slip = bed.motion(motion, parameter)
    forward = (slip * modes.direction).sum(axis=1)
    aside = np.abs(slip - forward[:, None] * modes.direction).max(axis=1)
    aside[~modes.slips] = np.abs(slip[~modes.slips]).max(axis=1)
    most = part * max(float(np.abs(opening).max()), float(np.abs(slip).max()))
    return (
        float(opening.min()) > -most
        and float(opening[modes.touching].max(initial=0.0)) < most
        and float(forward[modes.slips].min(initial=0.0)) > -most
        and float(aside.max()) < most
    )
