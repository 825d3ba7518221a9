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
_CRAWL, _STALLED = 0.01, 8  # so many steps as short as that: the boundary holds it
_MANY = 150  # blocks of which parts come first
_PARTS, _LAYERS, _LARGEST = 6, 3, 0.7  # at most; contacts about what moves; the largest, in parts of all blocks
_MOVING = 1e-5  # speed there, in parts of the fastest
_START, _LOWER = 0.3, 0.1  # λ to begin with, and to begin again with, in parts, where blocks jam at that
_AIM, _NO_NEARER = 0.5, 0.1  # of what s may still be: no less complementarity than that where λ moves, and stays
_KNOWN = 0.5  # part of the complementarity that what is off may be worth for λ to move
_UNSURE = 3.0  # complementarity in parts of what s may still be, from which on λ stays
_SURE = 0.2  # of `NEAR`: width of the bracket of λ at the end, 2e-6; s is mostly known ten times better
_DOUBT = 10.0  # how many times what residuals are worth at an iterate they may be worth at the end
_FALLS, _GROWS = 0.7, 2.0  # parts of λ by which it goes down and up at most


def bound_in_one_run(model: AssemblyModel, accuracy: float = BOUND_ACCURACY) -> StaticBound | None:
    """The static bound; None where it comes to no end: nothing balances the loads, anything does, or steps are many.

    Nor where its motion does not prove it to an accuracy, nor without compiled kernels, which have its steps.
    """
    if compiled() is None:
        return None
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        known = _of_parts(model) if len(model.load) > _MANY else None
        bound = None if known is None else _proved(model, _run(Shortfall(model), known, True), accuracy)
        return _proved(model, _run(Shortfall(model), _START), accuracy) if bound is None else bound


def _proved(model: AssemblyModel, bound: StaticBound | None, accuracy: float) -> StaticBound | None:
    return bound if bound is not None and is_proved(model, bound, accuracy) else None


def _of_parts(model: AssemblyModel) -> float | None:
    """The λ of some blocks with all others held, never above that of all; mostly it is that of all.

    First those that might slide out by themselves and some about them, then those that move there and some about them,
    until those that move are inside.
    """
    part, reduction = _about(model, _that_might_slide(model)), None
    for _ in range(_PARTS):
        if not 0 < len(part) <= _LARGEST * len(model.load):
            break
        bound = _run(Shortfall(model.among(part)[0]), reduction or _START)
        if bound is None or bound.factor is None:
            break
        reduction = 1.0 / bound.factor
        speed = np.abs(bound.velocity.reshape(len(part), -1)).max(axis=1)
        moving = np.zeros(len(model.load), dtype=bool)
        moving[part[speed > _MOVING * float(speed.max())]] = True
        if np.isin(np.flatnonzero(model.touching(moving)), part).all():
            break
        part = _about(model, moving)
    return reduction


def _about(model: AssemblyModel, blocks: Bools) -> Ints:
    """Some blocks (n,) and those a few contacts from them."""
    for _ in range(_LAYERS):
        blocks = model.touching(blocks)
    return np.flatnonzero(blocks)


def _that_might_slide(model: AssemblyModel) -> Bools:
    """Blocks (n,) that might slide out by themselves."""
    joints = len(model.plus) - len(model.bolts)
    plus, minus = model.plus[:joints], model.minus[:joints]
    both = minus >= 0
    owner = np.concatenate([plus, minus[both]])
    order = np.argsort(owner, kind="stable")
    normals = np.concatenate([model.plus_motion[:joints, 0, :3], model.minus_motion[:joints, 0, :3][both]])[order]
    none = np.zeros(len(order))
    return np.isfinite(sliding_factors(owner[order], normals, model.load[:, :3], none, none + 1.0))


def _run(program: Shortfall, start: float, known: bool = False) -> StaticBound | None:
    """The run from a λ; `known` where the bound's is no lower, and hardly higher."""
    at, reduction, low, high, stalled = program.begun(), start, 0.0, np.inf, 0
    if known:
        at, low = program.begun_elastic(start), (1.0 - 2.0 * _SURE * NEAR) * start
    for steps in range(_MOST_STEPS):
        program.set_reduction(reduction)
        off = Residuals.of(program, at)
        if not np.isfinite(off.gap) or not LEAST_STRENGTH < reduction < FARTHEST:
            return None
        short, falls, worth = at.load_factor - 1.0, program.falls(at), off.worth(at)
        if falls == 0.0:  # no strength at all
            return None
        most_off, unsure = -NEAR * reduction * falls, worth + float(np.abs(off.strength * at.slip).sum())
        admissible = off.outside(program) < EACH_BALANCED
        if admissible and max(abs(short), unsure) < most_off and off.gap < _SURE * most_off:
            return StaticBound(1.0 / (reduction - short / falls), False, False, at.velocity, at.normal, steps)
        middle, moves = short - 0.5 * off.gap, 0.0
        if admissible and short < 0.0:
            high = min(high, reduction)
        if short > off.gap + _DOUBT * unsure:
            low = max(low, reduction)
        farthest = max(off.gap, 0.5 * abs(middle))
        near_enough = max(abs(short), abs(middle)) < 0.5 * most_off  # what is left to λ is known then
        if worth < _KNOWN * farthest and off.gap < _UNSURE * abs(middle) and not near_enough:
            moves = float(np.clip(-middle / falls, farthest / falls, -farthest / falls))
            moves = min(max(moves, -_FALLS * reduction), _GROWS * reduction)
            moves = min(max(moves, 0.5 * (low - reduction)), 0.5 * (high - reduction))
            program.set_reduction(reduction + moves)
            off = Residuals.of(program, at)
        towards = (_AIM if moves else _NO_NEARER) * abs(middle) if worth < farthest else 0.0
        try:
            step, length = ConeEquations(program, at, off).step(towards)
        except (SolverError, np.linalg.LinAlgError):
            return None
        at, reduction = step.taken(at, length), reduction + length * moves
        stalled = stalled + 1 if length < _CRAWL else 0
        if stalled > _STALLED and (low > 0.0 or short > 0.0):
            return None
        if stalled > _STALLED:
            at, reduction, high, stalled = program.begun(), _LOWER * reduction, np.inf, 0
    return None
