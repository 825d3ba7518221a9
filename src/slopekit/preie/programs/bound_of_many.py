"""The static bound of many blocks in space by one run of the interior-point method, λ on its way to the bound.

The program of `programs.distance` for no motion: at one λ forces that balance fall short of strength by s w_g at most,

    minimise s:    Bᵀ f + P = 0,    N >= 0,    |T_g| <= λ (c_g + μ_g Σ N) + s w_g,

w the load of the lighter block of a contact. For each λ it is convex; s falls with λ, and is nothing at the bound.
Newton on s(λ) need not wait for s: an iterate whose forces balance and whose velocities are those of its multipliers
says that s lies between what it is and that less its complementarity, and what s does as λ grows. So λ goes with every
step by as much as is known, and the complementarity stays as large as what s may still be.

Of thousands of blocks few move. Blocks about those that might slide out by themselves, all others held, have a bound
that is no lower; their motion says who comes into the next part, until it ends within it. From the λ of that the run
over all blocks has little to find, and the same to prove: λ stays until s is known not to be nothing.

It ends where forces that balance and a motion are so near that λ is known to a fifth of `NEAR`. Steps are those of a
convex program, a score for each program that `programs.distance` would solve; where there is no end, that is the way.
"""

import numpy as np

from slopekit.core.arrays import Bools, Ints
from slopekit.core.errors import SolverError
from slopekit.preie.kernels import compiled
from slopekit.preie.many_blocks.key_blocks import sliding_factors
from slopekit.preie.programs.bound import StaticBound, is_proved
from slopekit.preie.programs.cone_steps import ConeEquations, Residuals, Shortfall
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import BOUND_ACCURACY, EACH_BALANCED, FARTHEST, LEAST_STRENGTH, NEAR

_MOST_STEPS = 150  # it takes 20 to 60
_CRAWL, _STALLED = (
    0.01,
    8,
)  # step length, and steps in a row as short, at which the method is stuck at the boundary
_MANY = 150  # blocks, above which the bound of a subset is solved first
_MAX_SUBSETS, _LAYERS, _LARGEST_SUBSET = (
    6,
    3,
    0.7,
)  # subsets at most; layers of contacts about moving blocks; the largest subset, in parts of all blocks
_MOVING = 1e-5  # speed of a moving block, in parts of the fastest
_START, _LOWER = (
    0.3,
    0.1,
)  # first λ, and the part of λ at which the run is restarted where blocks jam
_LEAST_GAP_MOVING, _LEAST_GAP_FIXED = (
    0.5,
    0.1,
)  # least complementarity in parts of the largest possible s: while λ moves, and while it stays
_KNOWN = 0.5  # work of the residuals, in parts of the complementarity, up to which λ may move
_UNSURE = 3.0  # complementarity, in parts of the largest possible s, from which on λ stays
_SURE = (
    0.2  # of `NEAR`: width of the bracket of λ at the end, 2e-6; s is mostly known ten times better
)
_DOUBT = 10.0  # safety factor on the work of the residuals
_FALLS, _GROWS = 0.7, 2.0  # largest decrease and increase of λ in one step, in parts of it


def bound_in_one_run(model: AssemblyModel, accuracy: float = BOUND_ACCURACY) -> StaticBound | None:
    """Return the static bound of many blocks in space; None where the run does not converge or is not proved.

    It does not converge where no forces balance the loads, or forces do at any strength. It needs compiled kernels.
    """
    if compiled() is None:
        return None
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        start = _bound_of_subset(model) if len(model.load) > _MANY else None
        bound = (
            None if start is None else _proved(model, _run(Shortfall(model), start, True), accuracy)
        )
        return _proved(model, _run(Shortfall(model), _START), accuracy) if bound is None else bound


def _proved(model: AssemblyModel, bound: StaticBound | None, accuracy: float) -> StaticBound | None:
    return bound if bound is not None and is_proved(model, bound, accuracy) else None


def _bound_of_subset(model: AssemblyModel) -> float | None:
    """Return λ of the static bound of a subset of blocks, all others fixed: never above that of all, mostly equal.

    The subset starts with blocks that might slide out by themselves and their neighbours, then is made of the moving
    blocks and their neighbours, until all that move lie inside.
    """
    blocks, reduction = _neighbourhood(model, _sliding_candidates(model)), None
    for _ in range(_MAX_SUBSETS):
        if not 0 < len(blocks) <= _LARGEST_SUBSET * len(model.load):
            break
        bound = _run(Shortfall(model.restricted_to(blocks)[0]), reduction or _START)
        if bound is None or bound.factor is None:
            break
        reduction = 1.0 / bound.factor
        speed = np.abs(bound.velocity.reshape(len(blocks), -1)).max(axis=1)
        moving = np.zeros(len(model.load), dtype=bool)
        moving[blocks[speed > _MOVING * float(speed.max())]] = True
        if np.isin(np.flatnonzero(model.touching(moving)), blocks).all():
            break
        blocks = _neighbourhood(model, moving)
    return reduction


def _neighbourhood(model: AssemblyModel, blocks: Bools) -> Ints:
    """Return the indices of blocks (n,) and of those within a few layers of contacts from them."""
    for _ in range(_LAYERS):
        blocks = model.touching(blocks)
    return np.flatnonzero(blocks)


def _sliding_candidates(model: AssemblyModel) -> Bools:
    """Return which blocks (n,) might slide out by themselves, all others fixed."""
    joints = len(model.plus) - len(model.bolts)
    plus, minus = model.plus[:joints], model.minus[:joints]
    both = minus >= 0
    owner = np.concatenate([plus, minus[both]])
    order = np.argsort(owner, kind="stable")
    normals = np.concatenate(
        [model.plus_motion[:joints, 0, :3], model.minus_motion[:joints, 0, :3][both]]
    )[order]
    none = np.zeros(len(order))
    return np.isfinite(sliding_factors(owner[order], normals, model.load[:, :3], none, none + 1.0))


def _run(program: Shortfall, start: float, is_lower_bound: bool = False) -> StaticBound | None:
    """Run the interior-point method from a λ to the static bound; None without convergence.

    is_lower_bound : λ of the bound is known to be no lower than `start`, and hardly higher
    """
    iterate, reduction, low, high, stalled = program.start(), start, 0.0, np.inf, 0
    if is_lower_bound:
        iterate, low = program.elastic_start(start), (1.0 - 2.0 * _SURE * NEAR) * start
    for steps in range(_MOST_STEPS):
        program.set_reduction(reduction)
        residuals = Residuals.evaluate(program, iterate)
        if not np.isfinite(residuals.gap) or not LEAST_STRENGTH < reduction < FARTHEST:
            return None
        shortfall, slope, residual_work = (
            iterate.load_factor - 1.0,
            program.slope(iterate),
            residuals.work(iterate),
        )
        if slope == 0.0:  # no strength at all
            return None
        tolerance, uncertainty = (
            -NEAR * reduction * slope,
            residual_work + float(np.abs(residuals.strength * iterate.slip).sum()),
        )
        admissible = residuals.outside(program) < EACH_BALANCED
        if (
            admissible
            and max(abs(shortfall), uncertainty) < tolerance
            and residuals.gap < _SURE * tolerance
        ):
            return StaticBound(
                1.0 / (reduction - shortfall / slope),
                False,
                False,
                iterate.velocity,
                iterate.normal,
                steps,
            )
        middle, change = shortfall - 0.5 * residuals.gap, 0.0
        if admissible and shortfall < 0.0:
            high = min(high, reduction)
        if shortfall > residuals.gap + _DOUBT * uncertainty:
            low = max(low, reduction)
        farthest = max(residuals.gap, 0.5 * abs(middle))
        near_enough = (
            max(abs(shortfall), abs(middle)) < 0.5 * tolerance
        )  # the remaining change of λ is known by then
        if (
            residual_work < _KNOWN * farthest
            and residuals.gap < _UNSURE * abs(middle)
            and not near_enough
        ):
            change = float(np.clip(-middle / slope, farthest / slope, -farthest / slope))
            change = min(max(change, -_FALLS * reduction), _GROWS * reduction)
            change = min(max(change, 0.5 * (low - reduction)), 0.5 * (high - reduction))
            program.set_reduction(reduction + change)
            residuals = Residuals.evaluate(program, iterate)
        towards = (
            (_LEAST_GAP_MOVING if change else _LEAST_GAP_FIXED) * abs(middle)
            if residual_work < farthest
            else 0.0
        )
        try:
            step, length = ConeEquations(program, iterate, residuals).step(towards)
        except (SolverError, np.linalg.LinAlgError):
            return None
        iterate, reduction = step.advanced(iterate, length), reduction + length * change
        stalled = stalled + 1 if length < _CRAWL else 0
        if stalled > _STALLED and (low > 0.0 or shortfall > 0.0):
            return None
        if stalled > _STALLED:
            iterate, reduction, high, stalled = program.start(), _LOWER * reduction, np.inf, 0
    return None
