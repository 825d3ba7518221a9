"""What can be proved about the factor of many blocks: the static bound, and the range of one mechanism.

**Static bound** S = 1/λ: the smallest λ for which some admissible forces balance the loads,

    B_nᵀ N + B_tᵀ T + P = 0,    N >= 0,    |T_g| <= λ (c_g + μ_g Σ N)

over all blocks that can move, none held. The products λ N make it no cone program, but for each λ the forces form a
convex set that grows with λ, so that whatever satisfies the first-order conditions is the smallest. Newton on λ and
the forces together (`Strengths.normality`) gets there at once in sections and for few blocks; else how far forces are
at one λ is a linear program in a section and a cone program in space, and Newton with its dual finds where they fit.

**Range**: the factors that one mechanism v can have under any admissible forces, N = 0 where it opens and
T = -λ r in the direction of its slip (METHOD-3.md §13, M). One linear program in a section and cone program in space
measures how far forces are from it at one λ; Newton with the dual finds the ends.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.arrays import Floats
from slopekit.onlooker import say
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.program import BlockProgram, ProgramResult, Strengths

_CLOSE = 3e-7  # complementarity of a settled load factor, in parts of it, and of a bracket
_BALANCES = 1e-4  # unbalanced force of a bound, in parts of the load of the block it acts on
_STEPS = 150  # of the interior-point method; it settles in 60 if it does
_FEW, _MOST_PROGRAMS = 10, 600  # moving blocks in space: fewer settle at once as a rule, more take minutes
_MOST_TRIALS = 60  # of λ
_SOLVED_ROUGHLY, _SOLVED, _ROUGHLY = 1e-4, 1e-9, 2e-2  # tolerances of a cone program, and changes of λ above the first
_SPARE = -1.0  # of the lighter block's load, that friction may fall short of its strength everywhere
_HARDLY = 1e-3  # of the elastic energy of the program: the bound needs hardly any
_SHED = 1e-3  # of the load: nothing balances it
_BALANCED = 2e-2  # largest unbalanced force of a bound that says so
_NOTHING = 1e-6  # λ below this: forces balance without friction; above its inverse: at none
_HARDLY_MOVES, _CARRIES, _CLEANED = 1e-3, 1e-6, 1500  # parts that are none: of motions, forces; unknowns cleaned
_MOVES = 1e-6  # opening or slip of a mechanism in parts of its fastest that is none
_REACHES = 1e-9  # distance from the mechanism's forces, in parts of the load, that is none
_NEAR = 1e-5  # how near an end of the range is found, in parts of the factor
_WIDEST = 50.0  # times the factor: a range that goes on is cut there


@dataclass(frozen=True, slots=True)
class StaticBound:
    """The static bound of a model.

    Attributes
    ----------
    factor : None where there is none: nothing balances the loads (`lifted`), forces balance at any friction
        (`locked`), or the search gave up
    velocity : (N,) of the blocks, as joints that dilate would let them go, or as they set off where they are lifted
    steps : of the interior-point method
    """

    factor: float | None
    lifted: bool
    locked: bool
    velocity: Floats
    steps: int


def static_bound(model: AssemblyModel) -> StaticBound:
    """The static bound of all blocks of a model."""
    say("static bound")
    size = len(model.load)
    if model.unknowns == 6 and _FEW < size <= _MOST_PROGRAMS:
        found = _by_programs(model, 0)
        if found is not None:
            return found
    program = BlockProgram(model)
    program.elastic *= _HARDLY
    at_once = program.solve(Strengths(model.tan_dilation, normality=1.0), program.start, _CLOSE, _STEPS)
    at, steps = at_once.at, at_once.steps
    if _is_lifted(at_once):
        return StaticBound(None, True, False, program.release(), steps)
    if at_once.settled and at_once.unbalanced < _BALANCES:
        locked = at.load_factor < _NOTHING
        return StaticBound(None if locked else 1.0 / at.load_factor, False, locked, at.velocity, steps)
    found = _by_programs(model, steps) if size <= _MOST_PROGRAMS else None
    if found is not None:
        return found
    summed = model.by_group(program.start.normal)
    dilating = Strengths(model.tan_friction, program.cohesion + model.tan_friction * summed, summed)
    lifted = _is_lifted(program.solve(dilating, program.start, _CLOSE, _STEPS))
    return StaticBound(None, lifted, False, program.release() if lifted else at.velocity, steps)


def _is_lifted(found: ProgramResult) -> bool:
    """Whether no strength however high balances the loads."""
    return found.at.shed > _SHED and found.unbalanced < _BALANCED


def _by_programs(model: AssemblyModel, steps: int) -> StaticBound | None:
    """The bound by Newton on how far admissible forces are at one λ, bracketed; None where that does not close.

    Far less is to spare just above a λ where blocks jam than just below it: the bracket is halved there.
    """
    away = _distance(model, np.zeros(model.load.size), np.ones(len(model.control_area)), _SPARE)
    still, tolerance = np.zeros(model.load.size), _SOLVED_ROUGHLY
    reduction, low, high = 1.0, 0.0, math.inf
    for _ in range(_MOST_TRIALS):
        steps += 1
        far, slope = away(reduction, tolerance)
        newton = slope < 0.0 and math.isfinite(far)
        trial = reduction - far / slope if newton else 10.0 * reduction
        if tolerance > _SOLVED and newton and abs(trial / reduction - 1.0) < _ROUGHLY:
            reduction, tolerance = trial, _SOLVED
            continue
        if far > 0.0:  # also where the program gave up: it did not find any
            low = reduction
        else:
            high = reduction
        if newton and abs(trial / reduction - 1.0) < _NEAR:
            return StaticBound(1.0 / trial, False, False, still, steps)
        if high < low * (1.0 + _CLOSE):
            return StaticBound(1.0 / high, False, False, still, steps)
        if reduction < _NOTHING:
            return StaticBound(None, False, True, still, steps)
        if low > 1.0 / _NOTHING:
            break
        if not low < trial < high:
            trial = math.sqrt(low * high) if low > 0.0 else 0.1 * high
        reduction = trial
    return None


# -- the range of one mechanism ---------------------------------------------------------------------------------------


def mechanism_range(
    model: AssemblyModel, velocity: Floats, factor: float, bond: Floats, forces: tuple[Floats, Floats]
) -> tuple[float | None, float | None] | None:
    """The lowest and highest factor of a mechanism under any admissible forces; None where it has none itself.

    Parameters
    ----------
    velocity : (N,); bond : (m,) 0 where a pair has lost its cohesion; forces : normal (m,) and friction (g, t) there

    Returns
    -------
    (lowest, highest); an end is None where it lies beyond fifty times (a fiftieth of) the factor.
    """
    say("range of the mechanism")
    away = _distance(model, _cleaned(model, velocity, forces, factor), bond)
    if away(1.0 / factor)[0] > 1e3 * _REACHES:
        return None
    ends = []
    for way in (1.0, -1.0):  # λ up: the lowest factor
        ends.append(_end(away, 1.0 / factor, way))
    high, low = ends
    return (1.0 / high if high else None), (1.0 / low if low else None)


def _end(away: Callable[..., tuple[float, float]], inside: float, way: float) -> float | None:
    """The λ at which the forces leave the mechanism, above (`way` 1) or below; None where they do not."""
    outside, stride = inside, 1.02
    while True:
        outside *= stride**way
        far, slope = away(outside)
        if far > _REACHES:
            break
        inside = outside
        if not 1.0 / _WIDEST < outside * stride**way / inside < _WIDEST or stride > _WIDEST:
            return None
        stride = stride * stride
    while abs(outside / inside - 1.0) > _NEAR:
        trial = outside - far / slope if slope * way > 0.0 else inside
        if abs(trial / outside - 1.0) < 0.1 * _NEAR:
            return trial
        if not min(inside, outside) < trial < max(inside, outside):
            trial = math.sqrt(inside * outside)
        there, its_slope = away(trial)
        if there > _REACHES:
            outside, far, slope = trial, there, its_slope
        else:
            inside = trial
    return inside


def _distance(
    model: AssemblyModel, velocity: Floats, bond: Floats, least_far: float = 0.0
) -> Callable[..., tuple[float, float]]:
    """How far (in parts of the load) admissible forces are from those of a mechanism at λ, and its slope in λ.

    No less than `least_far`: below zero there is so much to spare. A tolerance may follow λ (of a cone program).
    """
    from scipy import sparse

    opening, slip = model.opening_and_slip(velocity)
    size = np.sqrt((slip * slip).sum(axis=1))
    fastest = max(float(np.abs(opening).max()), float(size.max()), 1e-300)
    pairs, groups, tangents = len(opening), *slip.shape
    dilation = (model.tan_dilation * size)[model.group_of_pair]
    closed = opening - dilation <= _MOVES * fastest
    closed[model.joint_pairs.stop :] = False
    slips = size > _MOVES * fastest
    direction = np.where(slips[:, None], slip / np.maximum(size, 1e-300)[:, None], 0.0)
    cohesion = model.by_group(model.cohesion * bond)
    cohesion = np.where(model.bolted, 0.5 * cohesion, cohesion)  # about the middle of what a bolt may pull
    gather = sparse.csr_matrix((np.ones(pairs), (model.group_of_pair, np.arange(pairs))), shape=(groups, pairs))
    pressed = sparse.diags(model.tan_friction) @ gather  # μ ΣN
    # T = -λ r e + x, |x| <= s where it slips; |T| <= λ r + s elsewhere: the unknowns are N, x or T, and s
    along = sparse.csr_matrix(
        (direction.ravel(), (np.arange(groups * tangents), np.repeat(np.arange(groups), tangents))),
        shape=(groups * tangents, groups),
    )
    own = np.sqrt((model.load * model.load).sum(axis=1))
    lighter = np.minimum(own[model.plus], np.where(model.minus < 0, np.inf, own[model.minus]))[model.group_contact]
    weight = np.maximum(lighter, 1e-9 * float(own.max()))[:, None]  # and each contact by that of the lighter one
    parts = 1.0 / np.repeat(np.maximum(own, 1e-9 * float(own.max())), model.unknowns)  # each block by its own load
    statics = (sparse.diags(parts) @ model.statics).tocsc()
    of_normal, of_slip = statics[:, :pairs], statics[:, pairs:]
    load, middle = parts * model.load.ravel(), parts * model.mean_pulls
    stick = (~slips).astype(float)
    upper = np.where(closed, np.inf, 0.0)
    solve = _linear if tangents == 1 else _conic

    def away(reduction: float, tolerance: float = _SOLVED) -> tuple[float, float]:
        carried = reduction * (of_slip @ along)  # what r puts on the blocks, less the sign
        balance = sparse.hstack([of_normal - carried @ pressed, of_slip, sparse.csr_matrix((len(load), 1))])
        right = -load - reduction * middle + carried @ cohesion
        room = sparse.hstack([
            -reduction * (sparse.diags(stick) @ pressed), sparse.csr_matrix((groups, groups * tangents)), -weight,
        ])  # fmt: skip
        least = reduction * stick * cohesion
        x, of_balance, of_room = solve(
            balance.tocsr(), right, room.tocsr(), least, upper, tangents, least_far, tolerance
        )
        if x is None:
            return math.inf, 0.0
        strength = pressed @ x[:pairs] + cohesion
        # dual: how s falls with the right side and the matrix, both of which move with λ
        slope = float(of_balance @ (of_slip @ (along @ strength) - middle)) - float(of_room @ (stick * strength))
        return float(x[-1]), slope

    return away


def _cleaned(model: AssemblyModel, velocity: Floats, forces: tuple[Floats, Floats], factor: float) -> Floats:
    """The motion (N,) made exact: what is pressed does not open, and what carries less than its strength sticks.

    Parameters
    ----------
    forces : normal (m,) and friction (g, t) of the limit state
    """
    if model.tan_dilation.any() or model.load.size > _CLEANED:
        return velocity
    normal, friction = forces
    pressed = normal > _CARRIES * float(normal.max(initial=0.0))
    opening, slip = model.opening_and_slip(velocity)
    size, carried = (np.sqrt((of * of).sum(axis=1)) for of in (slip, friction))
    hardly = _HARDLY_MOVES * max(float(np.abs(opening).max()), float(size.max()))
    strength = (model.by_group(model.cohesion) + model.tan_friction * model.by_group(normal)) / factor
    sticks = (carried < (1.0 - _HARDLY_MOVES) * strength) & (size < hardly)
    sticks &= ~model.bolted | (carried > _HARDLY_MOVES * strength)  # a slack bolt may get shorter
    still = np.concatenate([pressed & (np.abs(opening) < hardly), np.repeat(sticks, slip.shape[1])])
    rows = model.kinematics[np.flatnonzero(still)].toarray()
    change, *_ = np.linalg.lstsq(rows, rows @ velocity, rcond=1e-10)
    cleaned: Floats = velocity - change
    return cleaned


Solved = tuple[Floats | None, Floats, Floats]


def _linear(
    balance: Any, right: Floats, room: Any, least: Floats, upper: Floats, tangents: int, least_far: float,
    tolerance: float,
) -> Solved:  # fmt: skip
    """min s with |T| <= room, by a linear program (HiGHS)."""
    from scipy import sparse
    from scipy.optimize import linprog

    groups, pairs = room.shape[0], len(upper)
    pick = sparse.hstack([sparse.csr_matrix((groups, pairs)), sparse.eye(groups), sparse.csr_matrix((groups, 1))])
    inequality = sparse.vstack([room + pick, room - pick])
    cost = np.zeros(pairs + groups + 1)
    cost[-1] = 1.0
    bounds = np.empty((len(cost), 2))
    bounds[:, 0], bounds[:, 1] = -np.inf, np.inf
    bounds[:pairs, 0], bounds[:pairs, 1] = 0.0, upper
    bounds[-1, 0] = least_far
    found = linprog(
        cost, A_ub=inequality, b_ub=np.concatenate([least, least]), A_eq=balance, b_eq=right, bounds=bounds,
        method="highs",
    )  # fmt: skip
    if found.status != 0:
        return None, right, least
    marginal = -found.ineqlin.marginals
    return found.x, found.eqlin.marginals, marginal[:groups] + marginal[groups:]


def _conic(
    balance: Any, right: Floats, room: Any, least: Floats, upper: Floats, tangents: int, least_far: float,
    tolerance: float,
) -> Solved:  # fmt: skip
    """The same by a cone program (Clarabel)."""
    import clarabel
    from scipy import sparse

    groups, pairs = room.shape[0], len(upper)
    width = pairs + groups * tangents + 1
    shut = np.flatnonzero(upper == 0.0)
    eye = sparse.eye(width, format="csr")
    heads = room.tocsr()
    cones = np.empty(groups * (1 + tangents), dtype=np.int64)  # rows of (room, T) group by group
    cones.shape = (groups, 1 + tangents)
    cones[:, 0] = np.arange(groups)
    cones[:, 1:] = groups + np.arange(groups * tangents).reshape(groups, tangents)
    tails = -eye[pairs : pairs + groups * tangents]
    friction = sparse.vstack([heads, tails]).tocsr()[cones.ravel()]
    of_friction = np.concatenate([least, np.zeros(groups * tangents)])[cones.ravel()]
    rows = sparse.vstack([balance, eye[shut], -eye[:pairs], -eye[width - 1 :], friction]).tocsc()
    ends = np.concatenate([right, np.zeros(len(shut) + pairs), [-least_far], of_friction])
    kinds = [
        clarabel.ZeroConeT(len(right) + len(shut)), clarabel.NonnegativeConeT(pairs + 1),
        *[clarabel.SecondOrderConeT(1 + tangents)] * groups,
    ]  # fmt: skip
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    settings.max_threads = 1
    settings.direct_solve_method = "qdldl"  # for these programs its fastest, from 1 to 600 blocks
    cost = np.zeros(width)
    cost[-1] = 1.0
    found = clarabel.DefaultSolver(sparse.csc_matrix((width, width)), cost, rows, ends, kinds, settings).solve()
    if not str(found.status).startswith(("Solved", "AlmostSolved")):
        return None, right, least
    dual = np.array(found.z)
    first = len(right) + len(shut) + pairs + 1
    return np.array(found.x), -dual[: len(right)], dual[first :: 1 + tangents]
