"""Proved bounds on the factor of many blocks: the static bound, and the range of one mechanism.

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
from slopekit.core.progress import report_stage
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

_FEW, _FEW_PAIRS = (
    10,
    100,
)  # moving blocks in space, and their pairs, up to which programs at one λ are as fast
_MOST_PROGRAMS = 600  # blocks, above which such programs take minutes
_MOST_UNKNOWNS_EXACT = 1500  # unknowns up to which a motion is cleaned onto its exact kinematics
_RELEASES, _ROUGH = (
    40,
    1e6,
)  # rounds of releasing contacts; springs of contacts in parts of the inertia
_OUTSIDE = 1e-7  # of a block's load: distance at which forces do not belong to a mechanism; programs end near 1e-9
_BRACKET_FRACTION = 0.1  # of the bracket of an end: next trial where a Newton step ends inside
_MOST_UNKNOWNS_NORMALS = (
    120  # unknowns up to which frictionless equilibrium is tried: a dense problem
)


def static_bound(model: AssemblyModel) -> StaticBound:
    """Return the static bound of all blocks of a model."""
    report_stage("static bound")
    bound: StaticBound | None = None
    if model.unknowns == 6 and (len(model.load) > _FEW or len(model.control_area) > _FEW_PAIRS):
        bound = bound_in_one_run(
            model, BOUND_ACCURACY if len(model.load) <= _MOST_PROGRAMS else BOUND_ROUGHLY
        )
    bound = bound or bound_by_programs(model)
    if bound is not None and not bound.lifted:
        return bound
    normal = frictionless_equilibrium(model, model.load.ravel())
    if normal is not None:  # such as flat wedges in slots, whose forces are many times the load
        return StaticBound(None, False, True, np.zeros(model.load.size), normal, 0)
    if bound is None:
        return StaticBound(
            None, False, False, np.zeros(model.load.size), np.zeros(len(model.control_area)), 0
        )
    return replace(bound, velocity=_first_acceleration(model))


def _first_acceleration(model: AssemblyModel) -> Floats:
    """Return the acceleration (N,) of unbalanced blocks at rest, by Gauss' least constraint with rough contacts.

    All motions have the same inertia here (scaled by the size of the blocks); contacts in tension and bolts in
    compression are released, round by round.
    """
    solver, pattern = SparseStiffness(model), ContactPattern(model)
    load = model.load.ravel()
    roughness = _ROUGH * ((model.tan_friction > NO_FORCE) | model.bolted)
    pressed, taut = (
        np.ones(len(model.control_area), dtype=bool),
        np.ones(len(roughness), dtype=bool),
    )
    velocity = load
    for _ in range(_RELEASES):
        springs = np.where(pressed, _ROUGH * model.control_area, 0.0)
        shear_springs = roughness * taut * (model.by_group(springs) > 0.0)
        rough = np.eye(model.slip_rows.shape[1]) * shear_springs[:, None, None]
        velocity = solver.factored(
            pattern.stiffness(springs, rough), 0.0, inertia=np.ones(len(load))
        )(load)
        opening, slip = model.opening_and_slip(velocity)
        fastest = max(float(np.abs(velocity).max()), TINY)
        pulled = pressed & (opening > PARALLEL * fastest)
        pushed = ~pressed & (opening < -NO_MOTION * fastest)
        slack = taut & model.bolted & (slip[:, 0] > PARALLEL * fastest)
        is_stretched = ~taut & (slip[:, 0] < -NO_MOTION * fastest)
        if not (pulled.any() or pushed.any() or slack.any() or is_stretched.any()):
            break
        pressed, taut = (pressed & ~pulled) | pushed, (taut & ~slack) | is_stretched
    return velocity


def frictionless_equilibrium(model: AssemblyModel, load: Floats) -> Floats | None:
    """Return normal forces (m,) that balance a load (N,) without friction, cohesion or bolts; None without any.

    Where they exist the blocks are stable at any strength: no motion in which no contact closes has work of the load,

        P·v = -N·(B_n v) <= 0    as    B_n v >= 0.

    Not tried for many blocks.
    """
    if len(load) > _MOST_UNKNOWNS_NORMALS:
        return None
    from scipy.optimize import (
        nnls,
    )  # takes a tenth of a second to load, and most designs do not need it

    pairs, joints = len(model.control_area), model.joint_pairs.stop
    by_normals = model.statics[:, :joints].toarray()
    least = LIGHTEST * float(np.abs(load).max())
    block_loads = np.maximum(np.abs(load.reshape(model.load.shape)).max(axis=1), least)
    scale = 1.0 / np.repeat(block_loads, model.unknowns)
    matrix, target = scale[:, None] * by_normals, -scale * load
    try:
        normal_forces, _ = nnls(matrix, target)
    except RuntimeError:  # no convergence
        return None
    if float(np.abs(target - matrix @ normal_forces).max(initial=0.0)) > EQUILIBRIUM:
        return None
    return np.concatenate([normal_forces, np.zeros(pairs - joints)])


# -- the range of one mechanism ---------------------------------------------------------------------------------------


def mechanism_range(
    model: AssemblyModel,
    velocity: Floats,
    factor: float,
    bond: Floats,
    forces: tuple[Floats, Floats],
    top: float | None = None,
) -> tuple[float | None, float | None] | None:
    """Return the lowest and highest factor of a mechanism under any admissible forces; None where it has no factor.

    Parameters
    ----------
    velocity : (N,); bond : (m,) 0 where a pair has lost its cohesion; forces : normal (m,) and friction (g, t) there
    top : a factor that none exceeds, None where there is none

    Returns
    -------
    (lowest, highest); an end is None where it lies beyond fifty times (a fiftieth of) the factor, or `top`.
    """
    report_stage("range of the mechanism")
    program = Distance(model, _exact_mechanism(model, velocity, forces, factor), bond, 1.0 / factor)
    if program.evaluate(1.0 / factor).distance > LIMIT_BALANCED:
        return None
    high = _range_end(program, 1.0 / factor, 1.0, math.inf)  # λ up: the lowest factor
    low = _range_end(program, 1.0 / factor, -1.0, 0.0 if top is None else 1.0 / top)
    return (1.0 / high if high else None), (1.0 / low if low else None)


def _range_end(program: Distance, inside: float, direction: float, last: float) -> float | None:
    """Return λ at an end of the range of a mechanism, above (`direction` 1) or below; None beyond the `last` λ."""
    outside, stride = inside, 1.02
    while True:
        outside *= stride**direction
        outer = program.evaluate(outside)
        if outer.distance > _OUTSIDE:
            break
        inside = outside
        if (inside - last) * direction > 0.0:
            return None
        if (
            not 1.0 / WIDEST_RANGE < outside * stride**direction / inside < WIDEST_RANGE
            or stride > WIDEST_RANGE
        ):
            return None
        stride = stride * stride
    fraction = _BRACKET_FRACTION
    while True:
        trial = outside - outer.distance / outer.slope if outer.slope * direction > 0.0 else inside
        if min(abs(trial / outside - 1.0), abs(outside / inside - 1.0)) < NEAR:
            return trial if inside * direction < trial * direction < outside * direction else inside
        if (
            not min(inside, outside) < trial < max(inside, outside)
        ):  # the Newton step ended inside the range
            trial, fraction = inside + fraction * (outside - inside), min(4.0 * fraction, 0.5)
        evaluation = program.evaluate(trial)
        if evaluation.distance > _OUTSIDE:
            outside, outer, fraction = trial, evaluation, _BRACKET_FRACTION
        else:
            inside = trial


def _exact_mechanism(
    model: AssemblyModel, velocity: Floats, forces: tuple[Floats, Floats], factor: float
) -> Floats:
    """Return a motion (N,) made exact: pressed contacts do not open, and those below their strength stick.

    Parameters
    ----------
    forces : normal (m,) and friction (g, t) of the limit state
    """
    if model.tan_dilation.any() or model.load.size > _MOST_UNKNOWNS_EXACT:
        return velocity
    normal, friction = forces
    pressed = normal > CARRIES * float(normal.max(initial=0.0))
    opening, slip = model.opening_and_slip(velocity)
    size, shear = (np.sqrt((vectors * vectors).sum(axis=1)) for vectors in (slip, friction))
    negligible = MOVES * max(float(np.abs(opening).max()), float(size.max()))
    strength = (
        line(model.by_group(model.cohesion), model.tan_friction, model.by_group(normal)) / factor
    )
    sticks = (shear < (1.0 - MOVES) * strength) & (size < negligible)
    sticks &= ~model.bolted | (shear > MOVES * strength)  # a slack bolt may get shorter
    is_fixed = np.concatenate(
        [pressed & (np.abs(opening) < negligible), np.repeat(sticks, slip.shape[1])]
    )
    rows = model.kinematics[np.flatnonzero(is_fixed)].toarray()
    change, *_ = np.linalg.lstsq(rows, rows @ velocity, rcond=1e-10)
    cleaned: Floats = velocity - change
    return cleaned
