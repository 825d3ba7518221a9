"""Single blocks of an assembly that can slide out alone: the search in a large assembly begins with them."""

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import Assembly
from slopekit.loads import AssemblyLoads
from slopekit.preie.system.model import JointStrength
from slopekit.preie.tolerances import PARALLEL, SAME_FACTOR, TINY


def blocks_that_slide_alone(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, gone: Bools, free: Ints
) -> tuple[Ints, Floats]:
    """Return the blocks among `free` that would slide out alone, the lowest factor first, and their factors.

    Of factors that are alike that of the heavier block comes first.

    Parameters
    ----------
    gone : (b,) blocks that have been taken away
    """
    blocks, faces = _faces(assembly, loads, strength, gone, free)
    factors = sliding_factors(*faces)
    slides = np.flatnonzero(np.isfinite(factors))
    heavier = -np.sqrt((loads.forces[blocks[slides]] ** 2).sum(axis=1))
    alike = np.floor(np.log(np.maximum(factors[slides], TINY)) / SAME_FACTOR)
    slides = slides[np.lexsort((blocks[slides], heavier, alike))]
    return blocks[slides], factors[slides]


def sliding_direction(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, gone: Bools, block: int
) -> Floats:
    """Return the unit vector (3,) along which a block of `blocks_that_slide_alone` slides."""
    _, faces = _faces(assembly, loads, strength, gone, np.array([block], dtype=np.int64))
    _, factors, directions = _slides(*faces)
    direction: Floats = directions[int(np.argmin(factors))]
    return direction


def _faces(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, gone: Bools, free: Ints
) -> tuple[Ints, tuple[Ints, Floats, Floats, Floats, Floats]]:
    """Return the blocks among `free` that touch any, and the arguments of `sliding_factors` for them."""
    patches = assembly.patches
    is_gone = np.append(gone, False)
    present = np.flatnonzero(~is_gone[patches.plus] & ~is_gone[patches.minus])
    owner = np.concatenate([patches.plus[present], patches.minus[present]])
    patch, sign = np.concatenate([present, present]), np.repeat([1.0, -1.0], len(present))
    order = np.argsort(owner, kind="stable")
    order = order[np.isin(owner[order], free)]
    owner, patch, sign = owner[order], patch[order], sign[order]
    blocks, face_block = np.unique(owner, return_inverse=True)
    joint = patches.joint[patch]
    normals, cohesion = (
        sign[:, None] * patches.normals[patch],
        strength.cohesion[joint] * patches.areas[patch],
    )
    return blocks, (
        face_block,
        normals,
        loads.forces[blocks],
        cohesion,
        strength.tan_friction[joint],
    )


def sliding_factors(
    block: Ints, normals: Floats, forces: Floats, cohesion: Floats, tan_friction: Floats
) -> Floats:
    """Factor of safety (b,) of single blocks that slide on one or two of their faces, without turning.

    Infinite where a block cannot. Faces in one plane count together; faces that open lose their cohesion (Goodman &
    Shi 1985, ch. 9). All blocks, and all pairs of faces of each, at once.

    Parameters
    ----------
    block : (f,) of each face, ascending; normals : (f, 3) unit, into the block; forces : (b, 3) kN on the blocks
    cohesion : (f,) kN; tan_friction : (f,)

    >>> up, face = np.array([[0.0, 0.0, 1.0]]), np.zeros(1, dtype=np.int64)
    >>> sliding_factors(face, up, np.array([[3.0, 0.0, -4.0]]), np.zeros(1), np.array([0.75])).tolist()
    [1.0]
    >>> sliding_factors(face, up, np.array([[0.0, 0.0, 4.0]]), np.zeros(1), np.array([0.75])).tolist()  # is lifted
    [inf]
    """
    slider, factor, _ = _slides(block, normals, forces, cohesion, tan_friction)
    factors = np.full(len(forces), np.inf)
    np.minimum.at(factors, slider, factor)
    return factors


def _slides(
    block: Ints, normals: Floats, forces: Floats, cohesion: Floats, tan_friction: Floats
) -> tuple[Ints, Floats, Floats]:
    """Return each way in which a block can slide: its block, its factor, its direction (3,)."""
    faces = np.arange(len(block))
    ends = np.searchsorted(block, np.arange(len(forces)), side="right")
    first_of_pair, following = _numbered(ends[block] - faces - 1)
    a, b = (
        np.concatenate([faces, first_of_pair]),
        np.concatenate([faces, first_of_pair + 1 + following]),
    )  # one face, then pairs
    force, first, second = forces[block[a]], normals[a], normals[b]
    line = np.cross(first, second)
    size = (line * line).sum(axis=1)
    single = a == b
    on_one = -(force * first).sum(axis=1)
    along = np.where(
        single[:, None],
        force + on_one[:, None] * first,
        line
        * ((force * line).sum(axis=1) / np.where(single, 1.0, np.maximum(size, PARALLEL)))[:, None],
    )
    # what the two faces carry: their normals span what is left of the force
    carried_force, cosine = along - force, (first * second).sum(axis=1)
    of_first, of_second = (carried_force * first).sum(axis=1), (carried_force * second).sum(axis=1)
    sine = np.where(single, 1.0, np.maximum(1.0 - cosine * cosine, PARALLEL))
    on_first = np.where(single, on_one, (of_first - cosine * of_second) / sine)
    on_second = np.where(single, 0.0, (of_second - cosine * of_first) / sine)
    pull, force_size = np.sqrt((along * along).sum(axis=1)), np.sqrt((force * force).sum(axis=1))
    slides = (
        (single | (size >= PARALLEL))
        & (np.minimum(on_first, on_second) >= 0.0)
        & (pull > PARALLEL * force_size)
    )
    a, b, along, pull = a[slides], b[slides], along[slides], pull[slides]
    begins = np.searchsorted(block, block[a])
    direction_number, face_number = _numbered(ends[block[a]] - begins)
    face = begins[direction_number] + face_number
    opening = (normals[face] * along[direction_number]).sum(axis=1) / pull[direction_number]
    blocked = np.bincount(direction_number, opening < -PARALLEL, len(a)) > 0
    resistance = np.bincount(
        direction_number, np.where(opening < PARALLEL, cohesion[face], 0.0), len(a)
    ).astype(np.float64)  # none: ints
    resistance += on_first[slides] * tan_friction[a] + on_second[slides] * tan_friction[b]
    free = ~blocked
    return block[a[free]], resistance[free] / pull[free], along[free] / pull[free, None]


def _numbered(counts: Ints) -> tuple[Ints, Ints]:
    """Number the members of groups of given sizes: the group of each, and its number in the group."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
