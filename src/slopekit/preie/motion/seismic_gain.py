"""How fast blocks at their limit gain on shaken ground: the derivative of their acceleration by the load.

At the limit the mechanism v may go on at any speed. With a little more of the load that grows, δk R, it accelerates by
δα v, and the joints carry δf more. All of that is in balance (B maps motions to openings and slips, M the mass):

    Bᵀ δf + δk R = δα M v,    δf of the modes: open pairs none, sticking ones any, slipping ones δT = -λ tan φ δN

The mechanism is the null vector of the stiffness K of these modes. So with K u - δk R = -δα M v for any elastic u,
and u held across v, δk is the price of δα: the gain is δα / δk. On a plane it is cos(β - φ) / cos φ.

Contacts may change a hair above the limit, and the gain with them: the load that a small acceleration takes is looked
for on the path too, and what that says is taken where it is another.
"""

from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces, Drive
from slopekit.preie.elastic_path.path_limit import BORDERED
from slopekit.preie.many_blocks.blocks import load_limit
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.ravelling import Part
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import CARRIES, MOVES, NO_MOTION, OPENS_ROUGHLY, TINY
from slopekit.strength.mohr_coulomb import line

_SAME = 10.0  # times what is no motion: the null vector of the modes is the mechanism
_ABOVE, _LEAST_LOAD = 0.01, 0.1  # of the load, or of that much of it: a little above
_ANOTHER = 0.01  # of a gain: more is another one


@dataclass(frozen=True)
class SeismicGain:
    """The gain of a mechanism.

    Attributes
    ----------
    factor : acceleration of the centroid of the block that moves farthest, in parts of gravity, per unit of the load
    block : that block, an index in the assembly
    first : that of the modes at the limit, where they change just above it and the gain is another; None otherwise
    """

    factor: float
    block: int
    first: float | None = None


def seismic_gain(part: Part, multiplier: float, weights: Floats, gyration: Floats) -> SeismicGain | None:
    """The gain of a part at its critical load; None where its modes have no one motion, or none that drives it.

    Parameters
    ----------
    part : with the load that grows as the live one of its model
    weights : (b,) kN of the blocks of the assembly; gyration : (b, 3, 3) m², inertia about the centroid per mass

    Where the motion did not settle, that of the blocks that flow is tried as it is, with all others held.
    """
    model, limit = part.model, part.limit
    if limit.factor is None:
        return None
    mass = mass_of(model, weights, gyration)
    settled = limit.basis is not Basis.PEAK
    gain = _of_all(model, mass, limit) if settled and model.load.size <= BORDERED else _of_movers(model, mass, limit)
    if gain is not None:
        block = int(model.moving[gain[1]])
        above = _just_above(model, mass, limit, multiplier, gain) if settled else None
        if above is None or abs(above / gain[0] - 1.0) < _ANOTHER:
            return SeismicGain(gain[0], block)
        return SeismicGain(above, block, gain[0])
    return None


def _just_above(
    model: AssemblyModel, mass: Floats, limit: BlocksLimit, multiplier: float, gain: tuple[float, int]
) -> float | None:
    """The gain between the limit and a little above it; None where nothing settles there.

    The load that the motion takes with a small acceleration, its inertia a load of its own.
    """
    assert limit.factor is not None
    factor, fastest = gain
    moves = limit.velocity[fastest, : 2 if model.unknowns == 3 else 3]
    faster = factor * _ABOVE * max(multiplier, _LEAST_LOAD)
    inertia = np.matmul(mass, limit.velocity[:, :, None])[:, :, 0] / float(np.sqrt(moves @ moves))
    faster_limit = load_limit(replace(model, load=model.load - faster * inertia), model.live, 1.0 / limit.factor)
    further = (faster_limit.multiplier or 0.0) - multiplier
    return faster / further if faster_limit.basis is not Basis.PEAK and further > 0.0 else None


def mass_of(model: AssemblyModel, weights: Floats, gyration: Floats) -> Floats:
    """Mass (n, u, u) of the moving blocks in the model's units, of which one is moved by 1 g."""
    own, about = weights[model.moving] / model.force_scale, gyration[model.moving] / model.length_scale**2
    section = model.unknowns == 3
    moves = 2 if section else 3
    mass = np.zeros((len(own), model.unknowns, model.unknowns))
    mass[:, :moves, :moves] = own[:, None, None] * np.eye(moves)
    mass[:, moves:, moves:] = own[:, None, None] * (about[:, 1:2, 1:2] if section else about)
    return mass


def _of_all(model: AssemblyModel, mass: Floats, limit: BlocksLimit) -> tuple[float, int] | None:
    """The gain at a limit, and the moving block that goes farthest."""
    assert limit.factor is not None
    still = NO_MOTION if limit.basis is Basis.LIMIT else OPENS_ROUGHLY
    bed = Bed(model, Drive(model.load.ravel(), model.live.ravel(), 1.0 / limit.factor), limit.bond)
    tried = (_of_motion(bed, mass, limit, still, used_up) for used_up in (True, False))
    return next((gain for gain in tried if gain is not None), None)


def _of_movers(model: AssemblyModel, mass: Floats, limit: BlocksLimit) -> tuple[float, int] | None:
    """The same with those held that do not move."""
    fast = np.abs(limit.velocity).max(axis=1)
    movers: Ints = np.flatnonzero(fast > MOVES * float(fast.max()))
    few, _, pairs, groups = model.among(movers)
    if few.load.size > BORDERED:
        return None
    own = replace(
        limit,
        velocity=limit.velocity[movers],
        normal_force=limit.normal_force[pairs],
        bond=limit.bond[pairs],
        friction=limit.friction[groups],
    )
    gain = _of_all(few, mass[movers], own)
    return None if gain is None else (gain[0], int(movers[gain[1]]))


def _of_motion(bed: Bed, mass: Floats, limit: BlocksLimit, still: float, used_up: bool) -> tuple[float, int] | None:
    """The gain with the modes of a motion, and the moving block that goes farthest; None where they do not have it.

    Parameters
    ----------
    still : what is no motion, in parts of the fastest
    used_up : contacts that do not move but have used up their strength are on the point of slipping; else they stick
    """
    v = limit.velocity.ravel() / float(np.abs(limit.velocity).max())
    across = bed.viscous(v)
    along = float(across @ v)
    matrix = np.zeros((bed.size + 1, bed.size + 1))
    matrix[:-1, :-1] = bed.stiffness.dense(bed.tangent(_modes(bed, v, limit, still, used_up), 1.0, turning=False))
    matrix[:-1, -1] = -bed.drive.working
    matrix[-1, :-1] = across

    def solved(right: Floats, last: float) -> Floats | None:
        try:
            solution = np.linalg.solve(matrix, np.append(right, last))
        except np.linalg.LinAlgError:
            return None
        return solution if np.isfinite(solution).all() else None

    motion = solved(np.zeros(bed.size), along)
    if motion is None or abs(float(motion[-1])) > still or float(np.abs(motion[:-1] - v).max()) > _SAME * still:
        return None  # several motions at one load, or none
    motions = motion[:-1].reshape(len(mass), -1)
    priced = solved(-np.matmul(mass, motions[:, :, None]).ravel(), 0.0)
    moves = motions[:, : 2 if bed.tangents == 1 else 3]
    speeds = np.sqrt((moves * moves).sum(axis=1))
    alike = speeds > (1.0 - still) * speeds.max()
    fastest = int(np.argmax(np.where(alike, mass[:, 0, 0], 0.0)))  # the heaviest of them
    if priced is None or not priced[-1] > 0.0:
        return None
    return float(speeds[fastest]) / float(priced[-1]), fastest


def _modes(bed: Bed, v: Floats, limit: BlocksLimit, still: float, used_up: bool) -> BedForces:
    """Contact modes of a motion (N,), the fastest 1.

    What presses and does not open touches; what moves slips, and, where `used_up`, what has used up its strength.
    """
    normal, friction = limit.normal_force, limit.friction
    opening, slip = bed.motion(v, 0.0)
    size = np.sqrt((slip * slip).sum(axis=1))
    none = still * max(float(np.abs(opening).max()), float(size.max()))
    touching = (normal > CARRIES * float(normal.max(initial=0.0))) & (opening < none)
    moves: Bools = size > none
    carried = np.sqrt((friction * friction).sum(axis=1))
    summed: Floats = np.bincount(bed.group_of_pair, normal, bed.groups).astype(np.float64)
    full = carried >= bed.drive.strength * line(bed.cohesion, bed.friction, summed) * (1.0 - still)
    along = np.where(moves[:, None], slip, -friction)
    direction = along / np.maximum(np.sqrt((along * along).sum(axis=1)), TINY)[:, None]
    return BedForces(
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
