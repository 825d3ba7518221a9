"""The seismic gain of blocks at their limit: the derivative of their acceleration by the load.

At the limit the mechanism v is possible at any speed. A small increase δk R of the growing load accelerates it by
δα v and changes the joint forces by δf. Both are in balance (B maps motions to openings and slips, M the mass):

    Bᵀ δf + δk R = δα M v,    δf of the modes: open pairs none, sticking ones any, slipping ones δT = -λ tan φ δN

The mechanism is the null vector of the stiffness K of these modes. So with K u - δk R = -δα M v for any elastic u
orthogonal to v, δk is the load that δα takes: the gain is δα / δk. On a plane it is cos(β - φ) / cos φ.

Contacts may change just above the limit, and the gain with them: the load of a small acceleration is found on the
elastic path too, and its gain is taken where it differs.
"""

from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState, Drive
from slopekit.preie.elastic_path.path_limit import BORDERED
from slopekit.preie.many_blocks.blocks import load_limit
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.ravelling import SolvedComponent
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import CARRIES, MOVES, NO_MOTION, OPENS_ROUGHLY, TINY
from slopekit.strength.mohr_coulomb import line

_SAME_MOTION = (
    10.0  # times the tolerance of no motion, to which the null vector of the modes is the mechanism
)
_LOAD_INCREASE, _LEAST_LOAD = (
    0.01,
    0.1,
)  # of the load multiplier; least multiplier of which it is a part
_GAIN_CHANGE = 0.01  # relative change of a gain above which it has another value above the limit


@dataclass(frozen=True)
class SeismicGain:
    """The seismic gain of a mechanism.

    Attributes
    ----------
    factor : acceleration of the centroid of the block that moves farthest, in parts of gravity, per unit of the load
    block : that block, an index in the assembly
    first : gain of the modes at the limit, where these change just above it; None otherwise
    """

    factor: float
    block: int
    first: float | None = None


def seismic_gain(
    component: SolvedComponent, multiplier: float, weights: Floats, gyration: Floats
) -> SeismicGain | None:
    """Return the seismic gain of a component at its critical load; None without a single motion that the load drives.

    Parameters
    ----------
    component : its model has the growing load as live load
    weights : (b,) kN of the blocks of the assembly; gyration : (b, 3, 3) m², inertia about the centroid per mass

    Where the motion did not settle, that of the flowing blocks is used as it is, with all others fixed.
    """
    model, limit = component.model, component.limit
    if limit.factor is None:
        return None
    mass = mass_of(model, weights, gyration)
    settled = limit.basis is not Basis.PEAK
    gain = (
        _gain_of_assembly(model, mass, limit)
        if settled and model.load.size <= BORDERED
        else _gain_of_movers(model, mass, limit)
    )
    if gain is not None:
        block = int(model.moving[gain[1]])
        above = _gain_above_limit(model, mass, limit, multiplier, gain) if settled else None
        if above is None or abs(above / gain[0] - 1.0) < _GAIN_CHANGE:
            return SeismicGain(gain[0], block)
        return SeismicGain(above, block, gain[0])
    return None


def _gain_above_limit(
    model: AssemblyModel,
    mass: Floats,
    limit: BlocksLimit,
    multiplier: float,
    gain: tuple[float, int],
) -> float | None:
    """Return the gain between the limit and a load slightly above it; None where that limit does not settle.

    The load is that of the limit with a small acceleration, whose inertia is applied as a load.
    """
    assert limit.factor is not None
    factor, fastest = gain
    moves = limit.velocity[fastest, : 2 if model.unknowns == 3 else 3]
    faster = factor * _LOAD_INCREASE * max(multiplier, _LEAST_LOAD)
    inertia = np.matmul(mass, limit.velocity[:, :, None])[:, :, 0] / float(np.sqrt(moves @ moves))
    faster_limit = load_limit(
        replace(model, load=model.load - faster * inertia), model.live, 1.0 / limit.factor
    )
    further = (faster_limit.multiplier or 0.0) - multiplier
    return faster / further if faster_limit.basis is not Basis.PEAK and further > 0.0 else None


def mass_of(model: AssemblyModel, weights: Floats, gyration: Floats) -> Floats:
    """Return the masses (n, u, u) of the moving blocks in model units: a unit force moves a unit by 1 g."""
    masses, inertias = (
        weights[model.moving] / model.force_scale,
        gyration[model.moving] / model.length_scale**2,
    )
    section = model.unknowns == 3
    translations = 2 if section else 3
    mass = np.zeros((len(masses), model.unknowns, model.unknowns))
    mass[:, :translations, :translations] = masses[:, None, None] * np.eye(translations)
    mass[:, translations:, translations:] = masses[:, None, None] * (
        inertias[:, 1:2, 1:2] if section else inertias
    )
    return mass


def _gain_of_assembly(
    model: AssemblyModel, mass: Floats, limit: BlocksLimit
) -> tuple[float, int] | None:
    """Return the gain at a limit, and the moving block with the largest displacement; None without a gain."""
    assert limit.factor is not None
    speed_tolerance = NO_MOTION if limit.basis is Basis.LIMIT else OPENS_ROUGHLY
    bed = ElasticContactModel(
        model, Drive(model.load.ravel(), model.live.ravel(), 1.0 / limit.factor), limit.bond
    )
    tried = (
        _gain_of_motion(bed, mass, limit, speed_tolerance, used_up) for used_up in (True, False)
    )
    return next((gain for gain in tried if gain is not None), None)


def _gain_of_movers(
    model: AssemblyModel, mass: Floats, limit: BlocksLimit
) -> tuple[float, int] | None:
    """Return the gain at a limit, and the fastest block, with all blocks fixed that do not move; None without one."""
    fast = np.abs(limit.velocity).max(axis=1)
    movers: Ints = np.flatnonzero(fast > MOVES * float(fast.max()))
    assembly, _, pairs, groups = model.restricted_to(movers)
    if assembly.load.size > BORDERED:
        return None
    movers_limit = replace(
        limit,
        velocity=limit.velocity[movers],
        normal_force=limit.normal_force[pairs],
        bond=limit.bond[pairs],
        friction=limit.friction[groups],
    )
    gain = _gain_of_assembly(assembly, mass[movers], movers_limit)
    return None if gain is None else (gain[0], int(movers[gain[1]]))


def _gain_of_motion(
    bed: ElasticContactModel,
    mass: Floats,
    limit: BlocksLimit,
    speed_tolerance: float,
    used_up: bool,
) -> tuple[float, int] | None:
    """Return the gain with the contact modes of a motion, and its fastest block; None where the modes do not fit it.

    Parameters
    ----------
    speed_tolerance : speed that counts as no motion, in parts of the fastest
    used_up : contacts at their strength that do not move are about to slip; otherwise they stick
    """
    v = limit.velocity.ravel() / float(np.abs(limit.velocity).max())
    across = bed.viscous(v)
    along = float(across @ v)
    matrix = np.zeros((bed.size + 1, bed.size + 1))
    matrix[:-1, :-1] = bed.stiffness.dense(
        bed.tangent(_modes(bed, v, limit, speed_tolerance, used_up), 1.0, turning=False)
    )
    matrix[:-1, -1] = -bed.drive.working
    matrix[-1, :-1] = across

    def solved(right: Floats, last: float) -> Floats | None:
        try:
            solution = np.linalg.solve(matrix, np.append(right, last))
        except np.linalg.LinAlgError:
            return None
        return solution if np.isfinite(solution).all() else None

    motion = solved(np.zeros(bed.size), along)
    if (
        motion is None
        or abs(float(motion[-1])) > speed_tolerance
        or float(np.abs(motion[:-1] - v).max()) > _SAME_MOTION * speed_tolerance
    ):
        return None  # several motions at one load, or none
    motions = motion[:-1].reshape(len(mass), -1)
    priced = solved(-np.matmul(mass, motions[:, :, None]).ravel(), 0.0)
    moves = motions[:, : 2 if bed.tangents == 1 else 3]
    speeds = np.sqrt((moves * moves).sum(axis=1))
    alike = speeds > (1.0 - speed_tolerance) * speeds.max()
    fastest = int(np.argmax(np.where(alike, mass[:, 0, 0], 0.0)))  # the heaviest of them
    if priced is None or not priced[-1] > 0.0:
        return None
    return float(speeds[fastest]) / float(priced[-1]), fastest


def _modes(
    bed: ElasticContactModel, v: Floats, limit: BlocksLimit, speed_tolerance: float, used_up: bool
) -> ContactState:
    """Return the contact modes of a motion v (N,), whose fastest entry is 1.

    Pressed contacts that do not open touch; moving contacts slip, with `used_up` also those at their strength.
    """
    normal, friction = limit.normal_force, limit.friction
    opening, slip = bed.motion(v, 0.0)
    size = np.sqrt((slip * slip).sum(axis=1))
    none = speed_tolerance * max(float(np.abs(opening).max()), float(size.max()))
    touching = (normal > CARRIES * float(normal.max(initial=0.0))) & (opening < none)
    moves: Bools = size > none
    shear = np.sqrt((friction * friction).sum(axis=1))
    summed: Floats = np.bincount(bed.group_of_pair, normal, bed.groups).astype(np.float64)
    full = shear >= bed.drive.strength * line(bed.cohesion, bed.friction, summed) * (
        1.0 - speed_tolerance
    )
    along = np.where(moves[:, None], slip, -friction)
    direction = along / np.maximum(np.sqrt((along * along).sum(axis=1)), TINY)[:, None]
    return ContactState(
        normal,
        np.zeros((bed.groups, bed.tangents)),
        np.zeros(bed.groups),
        touching,
        moves | (full & used_up),
        direction,
        size,
        np.zeros(bed.size),
        1.0,
        0.0,
    )
