"""What can be proved about the factor of many blocks: the static bound, and the range of one mechanism.

**Static bound** S = 1/λ: the smallest λ for which some admissible forces balance the loads,

    B_nᵀ N + B_tᵀ T + P = 0,    N >= 0,    |T_g| <= λ (c_g + μ_g Σ N)

over all blocks that can move, none held. The products λ N make it no cone program, but for each λ the forces form a
convex set that grows with λ, so that whatever satisfies the first-order conditions is the smallest. Newton on λ and
the forces together (`Strengths.normality`) gets there at once in sections and for few blocks; else Newton on how far
forces are at one λ (`programs.distance`) finds where they fit.

**Range**: the factors that one mechanism v can have under any admissible forces, N = 0 where it opens and
T = -λ r in the direction of its slip (METHOD-3.md §13, M): where how far forces are from it is no more than nothing.
"""

import math

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.onlooker import say
from slopekit.preie.programs.bound import StaticBound, is_proved
from slopekit.preie.programs.bound_of_many import bound_in_one_run
from slopekit.preie.programs.distance import Distance, bound_by_programs
from slopekit.preie.programs.program import BlockProgram, ProgramResult, Strengths
from slopekit.preie.solvers.linear import bounded_least_squares
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import (
    BOUND_ACCURACY,
    BOUND_ROUGHLY,
    CARRIES,
    CLOSE,
    EACH_BALANCED,
    EQUILIBRIUM,
    LEAST_STRENGTH,
    LIFTED_BALANCED,
    LIFTED_SHED,
    LIGHTEST,
    MOVES,
    NEAR,
    PARALLEL,
    SOLVED,
    WIDEST_RANGE,
)
from slopekit.strength.mohr_coulomb import line

_FEW, _MOST_PROGRAMS = 10, 600  # moving blocks in space: fewer settle at once as a rule, more take minutes
_CLEANED = 1500  # unknowns up to which a motion is cleaned onto its exact kinematics
_HELD = 120  # unknowns up to which normal forces that hold all blocks are looked for: a dense problem


def static_bound(model: AssemblyModel) -> StaticBound:
    """The static bound of all blocks of a model."""
    say("static bound")
    size = len(model.load)
    few, asked = size <= _MOST_PROGRAMS, False
    if model.unknowns == 6 and size > _FEW:
        exact_bound, asked = bound_in_one_run(model, BOUND_ACCURACY if few else BOUND_ROUGHLY), few
        if exact_bound is None and few:
            exact_bound = bound_by_programs(model)
        if exact_bound is not None:
            return exact_bound
    program = BlockProgram(model)
    at_once = program.solve(Strengths(model.tan_dilation, normality=1.0), program.start, CLOSE)
    at, steps = at_once.at, at_once.steps
    if _is_lifted(at_once):
        normal = held_by_normals(model, model.load.ravel())
        if normal is not None:  # flat wedges in slots: their forces are many times the load
            return StaticBound(None, False, True, at.velocity, normal, steps)
        return StaticBound(None, True, False, program.release(), at.normal, steps)
    if at_once.settled and at_once.unbalanced < BOUND_ACCURACY:
        locked = at.load_factor < LEAST_STRENGTH
        known = StaticBound(None if locked else 1.0 / at.load_factor, False, locked, at.velocity, at.normal, steps)
        if locked or not few or (model.unknowns == 3 and is_proved(model, known)):
            return known
        # where blocks jam it settles a little low, or anywhere where they are locked; each bound has forces that prove
        # it, so the higher holds
        exact = bound_by_programs(model, at.load_factor, steps)
        higher = exact is not None and (exact.locked or (exact.factor or 0.0) > (1.0 - BOUND_ACCURACY) / at.load_factor)
        return exact if exact is not None and higher else known
    # programs that did not close would end as they did
    exact_bound = bound_by_programs(model, steps=steps) if few and not asked else None
    if exact_bound is not None:
        return exact_bound
    if size == 1 and not len(model.bolts):
        lifted = _falls_off(model)
    else:
        summed = model.by_group(program.start.normal)
        frozen = line(program.cohesion, model.tan_friction, summed)
        dilating = Strengths(model.tan_friction, frozen, -model.tan_friction * summed)
        lifted = _is_lifted(program.solve(dilating, program.start, CLOSE))
    normal = held_by_normals(model, model.load.ravel())
    if normal is not None:
        return StaticBound(None, False, True, at.velocity, normal, steps)
    return StaticBound(None, lifted, False, program.release() if lifted else at.velocity, at.normal, steps)


def _is_lifted(solution: ProgramResult) -> bool:
    """Whether no strength however high balances the loads."""
    return solution.at.shed > LIFTED_SHED and solution.unbalanced < LIFTED_BALANCED


def held_by_normals(model: AssemblyModel, load: Floats) -> Floats | None:
    """Normal forces (m,) that balance a load (N,) without friction, cohesion or bolts; None where there are none.

    Where there are any nothing moves at any strength: no motion in which no contact closes has work of the load,

        P·v = -N·(B_n v) <= 0    as    B_n v >= 0.

    Not looked for where the blocks are many.
    """
    if len(load) > _HELD:
        return None
    pairs, joints = len(model.control_area), model.joint_pairs.stop
    by_normals = model.statics[:, :joints].toarray()
    least = LIGHTEST * float(np.abs(load).max())
    own = np.maximum(np.abs(load.reshape(model.load.shape)).max(axis=1), least)
    parts = 1.0 / np.repeat(own, model.unknowns)
    found, left = bounded_least_squares(parts[:, None] * by_normals, -parts * load, np.full(joints, np.inf))
    if float(np.abs(left).max(initial=0.0)) > EQUILIBRIUM:
        return None
    return np.concatenate([found, np.zeros(pairs - joints)])


def _falls_off(model: AssemblyModel) -> bool:
    """Whether nothing balances the load of one block: N >= 0, and any friction where its joints have strength.

    What friction cannot do at any strength is left to the normal forces alone.
    """
    statics, pairs = model.statics.toarray(), len(model.control_area)
    strong = np.repeat((model.tan_friction > 0.0) | (model.by_group(model.cohesion) > 0.0), model.slip_rows.shape[1])
    ways, sizes, _ = np.linalg.svd(statics[:, pairs:][:, strong])
    rank = int((sizes > PARALLEL * float(sizes.max(initial=0.0))).sum())
    beyond = ways[:, rank:].T
    _, left = bounded_least_squares(beyond @ statics[:, :pairs], -beyond @ model.load.ravel(), np.full(pairs, np.inf))
    return float(np.abs(left).max(initial=0.0)) > EQUILIBRIUM


# -- the range of one mechanism ---------------------------------------------------------------------------------------


def mechanism_range(
    model: AssemblyModel,
    velocity: Floats,
    factor: float,
    bond: Floats,
    forces: tuple[Floats, Floats],
    top: float | None = None,
) -> tuple[float | None, float | None] | None:
    """The lowest and highest factor of a mechanism under any admissible forces; None where it has none itself.

    Parameters
    ----------
    velocity : (N,); bond : (m,) 0 where a pair has lost its cohesion; forces : normal (m,) and friction (g, t) there
    top : a factor that none exceeds, None where there is none

    Returns
    -------
    (lowest, highest); an end is None where it lies beyond fifty times (a fiftieth of) the factor, or `top`.
    """
    say("range of the mechanism")
    away = Distance(model, _cleaned(model, velocity, forces, factor), bond, 1.0 / factor)
    if away.at(1.0 / factor).distance > EACH_BALANCED:
        return None
    high = _end(away, 1.0 / factor, 1.0, math.inf)  # λ up: the lowest factor
    low = _end(away, 1.0 / factor, -1.0, 0.0 if top is None else 1.0 / top)
    return (1.0 / high if high else None), (1.0 / low if low else None)


def _end(away: Distance, inside: float, way: float, last: float) -> float | None:
    """The λ at which the forces leave the mechanism, above (`way` 1) or below; None where not before the `last`."""
    outside, stride = inside, 1.02
    while True:
        outside *= stride**way
        far = away.at(outside)
        if far.distance > SOLVED:
            break
        inside = outside
        if (inside - last) * way > 0.0:
            return None
        if not 1.0 / WIDEST_RANGE < outside * stride**way / inside < WIDEST_RANGE or stride > WIDEST_RANGE:
            return None
        stride = stride * stride
    margin = 0.5 * NEAR
    while True:
        trial = outside - far.distance / far.slope if far.slope * way > 0.0 else inside
        if min(abs(trial / outside - 1.0), abs(outside / inside - 1.0)) < NEAR:
            return trial if inside * way < trial * way < outside * way else inside
        if not min(inside, outside) < trial < max(inside, outside):  # Newton came out just inside: look beside it
            trial, margin = inside * min(1.0 + margin, math.sqrt((outside / inside) ** way)) ** way, 16 * margin
        there = away.at(trial)
        if there.distance > SOLVED:
            outside, far, margin = trial, there, 0.5 * NEAR
        else:
            inside = trial


def _cleaned(model: AssemblyModel, velocity: Floats, forces: tuple[Floats, Floats], factor: float) -> Floats:
    """The motion (N,) made exact: what is pressed does not open, and what carries less than its strength sticks.

    Parameters
    ----------
    forces : normal (m,) and friction (g, t) of the limit state
    """
    if model.tan_dilation.any() or model.load.size > _CLEANED:
        return velocity
    normal, friction = forces
    pressed = normal > CARRIES * float(normal.max(initial=0.0))
    opening, slip = model.opening_and_slip(velocity)
    size, carried = (np.sqrt((of * of).sum(axis=1)) for of in (slip, friction))
    hardly = MOVES * max(float(np.abs(opening).max()), float(size.max()))
    strength = line(model.by_group(model.cohesion), model.tan_friction, model.by_group(normal)) / factor
    sticks = (carried < (1.0 - MOVES) * strength) & (size < hardly)
    sticks &= ~model.bolted | (carried > MOVES * strength)  # a slack bolt may get shorter
    still = np.concatenate([pressed & (np.abs(opening) < hardly), np.repeat(sticks, slip.shape[1])])
    rows = model.kinematics[np.flatnonzero(still)].toarray()
    change, *_ = np.linalg.lstsq(rows, rows @ velocity, rcond=1e-10)
    cleaned: Floats = velocity - change
    return cleaned
