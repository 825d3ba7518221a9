"""What can be proved about the factor of many blocks: the static bound, and the range of one mechanism.

**Static bound** S = 1/λ: the smallest λ for which some admissible forces balance the loads,

    B_nᵀ N + B_tᵀ T + P = 0,    N >= 0,    |T_g| <= λ (c_g + μ_g Σ N)

over all blocks that can move, none held. The products λ N make it no cone program, but for each λ the forces form a
convex set that grows with λ: Newton's method on how far forces are at one λ (`programs.distance`) finds where they fit,
in space of more than ten blocks with λ on its way in one run (`programs.bound_of_many`).

**Range**: the factors that one mechanism v can have under any admissible forces, N = 0 where it opens and
T = -λ r in the direction of its slip (docs/theory/many-blocks.md): where forces at no distance from it exist.
"""

import math
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.onlooker import say
from slopekit.preie.programs.bound import StaticBound
from slopekit.preie.programs.bound_of_many import bound_in_one_run
from slopekit.preie.programs.distance import Distance, bound_by_programs
from slopekit.preie.solvers.stiffness import SparseStiffness
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.patterns import ContactPattern
from slopekit.preie.tolerances import (
    BOUND_ACCURACY,
    BOUND_ROUGHLY,
    CARRIES,
    EQUILIBRIUM,
    LIGHTEST,
    LIMIT_BALANCED,
    MOVES,
    NEAR,
    NO_FORCE,
    NO_MOTION,
    PARALLEL,
    TINY,
    WIDEST_RANGE,
)
from slopekit.strength.mohr_coulomb import line

_FEW, _FEW_PAIRS = 10, 100  # moving blocks in space, and their pairs, for which programs at one λ take no longer
_MOST_PROGRAMS = 600  # and from which they take minutes
_CLEANED = 1500  # unknowns up to which a motion is cleaned onto its exact kinematics
_RELEASES, _ROUGH = 40, 1e6  # rounds of letting go; springs of contacts in parts of the inertia
_OUTSIDE = 1e-7  # of a block's own load: forces so far from a mechanism are not its; programs end within some 1e-9
_BESIDE = 0.1  # of the bracket of an end, where Newton's method came out inside
_HELD = 120  # unknowns up to which normal forces that hold all blocks are looked for: a dense problem


def static_bound(model: AssemblyModel) -> StaticBound:
    """The static bound of all blocks of a model."""
    say("static bound")
    found: StaticBound | None = None
    if model.unknowns == 6 and (len(model.load) > _FEW or len(model.control_area) > _FEW_PAIRS):
        found = bound_in_one_run(model, BOUND_ACCURACY if len(model.load) <= _MOST_PROGRAMS else BOUND_ROUGHLY)
    found = found or bound_by_programs(model)
    if found is not None and not found.lifted:
        return found
    normal = held_by_normals(model, model.load.ravel())
    if normal is not None:  # flat wedges in slots: their forces are many times the load
        return StaticBound(None, False, True, np.zeros(model.load.size), normal, 0)
    if found is None:
        return StaticBound(None, False, False, np.zeros(model.load.size), np.zeros(len(model.control_area)), 0)
    return replace(found, velocity=_first_acceleration(model))


def _first_acceleration(model: AssemblyModel) -> Floats:
    """How blocks set off that nothing balances, (N,): the acceleration of least constraint, contacts rough.

    Every kind of motion has the same inertia here (scaled by the size of the blocks); contacts that would pull are let
    go, one round after the other, and bolts that would push.
    """
    solver, pattern = SparseStiffness(model), ContactPattern(model)
    load = model.load.ravel()
    roughness = _ROUGH * ((model.tan_friction > NO_FORCE) | model.bolted)
    pressed, taut = np.ones(len(model.control_area), dtype=bool), np.ones(len(roughness), dtype=bool)
    velocity = load
    for _ in range(_RELEASES):
        springs = np.where(pressed, _ROUGH * model.control_area, 0.0)
        held = roughness * taut * (model.by_group(springs) > 0.0)
        rough = np.eye(model.slip_rows.shape[1]) * held[:, None, None]
        velocity = solver.factored(pattern.stiffness(springs, rough), 0.0, inertia=np.ones(len(load)))(load)
        opening, slip = model.opening_and_slip(velocity)
        fastest = max(float(np.abs(velocity).max()), TINY)
        pulled = pressed & (opening > PARALLEL * fastest)
        pushed = ~pressed & (opening < -NO_MOTION * fastest)
        slack = taut & model.bolted & (slip[:, 0] > PARALLEL * fastest)
        drawn = ~taut & (slip[:, 0] < -NO_MOTION * fastest)
        if not (pulled.any() or pushed.any() or slack.any() or drawn.any()):
            break
        pressed, taut = (pressed & ~pulled) | pushed, (taut & ~slack) | drawn
    return velocity


def held_by_normals(model: AssemblyModel, load: Floats) -> Floats | None:
    """Normal forces (m,) that balance a load (N,) without friction, cohesion or bolts; None where there are none.

    Where there are any nothing moves at any strength: no motion in which no contact closes has work of the load,

        P·v = -N·(B_n v) <= 0    as    B_n v >= 0.

    Not looked for where the blocks are many.
    """
    if len(load) > _HELD:
        return None
    from scipy.optimize import nnls  # takes a tenth of a second to load, and most designs never ask

    pairs, joints = len(model.control_area), model.joint_pairs.stop
    by_normals = model.statics[:, :joints].toarray()
    least = LIGHTEST * float(np.abs(load).max())
    own = np.maximum(np.abs(load.reshape(model.load.shape)).max(axis=1), least)
    parts = 1.0 / np.repeat(own, model.unknowns)
    matrix, target = parts[:, None] * by_normals, -parts * load
    try:
        found, _ = nnls(matrix, target)
    except RuntimeError:  # it took too many steps
        return None
    if float(np.abs(target - matrix @ found).max(initial=0.0)) > EQUILIBRIUM:
        return None
    return np.concatenate([found, np.zeros(pairs - joints)])


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
    if away.at(1.0 / factor).distance > LIMIT_BALANCED:
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
        if far.distance > _OUTSIDE:
            break
        inside = outside
        if (inside - last) * way > 0.0:
            return None
        if not 1.0 / WIDEST_RANGE < outside * stride**way / inside < WIDEST_RANGE or stride > WIDEST_RANGE:
            return None
        stride = stride * stride
    beside = _BESIDE
    while True:
        trial = outside - far.distance / far.slope if far.slope * way > 0.0 else inside
        if min(abs(trial / outside - 1.0), abs(outside / inside - 1.0)) < NEAR:
            return trial if inside * way < trial * way < outside * way else inside
        if not min(inside, outside) < trial < max(inside, outside):  # Newton came out just inside: look beside it
            trial, beside = inside + beside * (outside - inside), min(4.0 * beside, 0.5)
        there = away.at(trial)
        if there.distance > _OUTSIDE:
            outside, far, beside = trial, there, _BESIDE
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
