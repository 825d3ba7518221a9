"""Single blocks of an assembly: whether one slides out by itself, and how deep it lies below the free surface."""

import math

import numpy as np

from slopekit.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import Assembly
from slopekit.loads import AssemblyLoads
from slopekit.preie.model import JointStrength

_PARALLEL = 1e-9
_FREE = 1e-6  # free surface of a block, in parts of its whole, that counts


def slide_alone(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, gone: Bools, free: Ints, below: float
) -> list[int]:
    """Blocks among `free` whose factor against sliding out alone lies below a factor, the lowest first.

    Parameters
    ----------
    gone : (b,) blocks that have been taken away
    """
    patches = assembly.patches
    out = np.append(gone, False)
    there = np.flatnonzero(~out[patches.plus] & ~out[patches.minus])
    owner = np.concatenate([patches.plus[there], patches.minus[there]])
    patch, sign = np.concatenate([there, there]), np.repeat([1.0, -1.0], len(there))
    order = np.argsort(owner, kind="stable")
    owner, patch, sign = owner[order], patch[order], sign[order]
    first, last = np.searchsorted(owner, free), np.searchsorted(owner, free, side="right")
    found = []
    for block, start, end in zip(free.tolist(), first.tolist(), last.tolist(), strict=True):
        at = patch[start:end]
        joint = patches.joint[at]
        factor = sliding_factor(
            sign[start:end, None] * patches.normals[at], loads.forces[block],
            strength.cohesion[joint] * patches.areas[at], strength.tan_friction[joint],
        )  # fmt: skip
        if factor < below:
            found.append((factor, block))
    return [block for _, block in sorted(found)]


def sliding_factor(normals: Floats, force: Floats, cohesion: Floats, tan_friction: Floats) -> float:
    """Factor of safety of one block that slides on one or two of its faces, without turning; infinite if it cannot.

    Faces in one plane count together; faces that open lose their cohesion (Goodman & Shi 1985, ch. 9).

    Parameters
    ----------
    normals : (f, 3) unit, into the block; force : (3,) kN on the block; cohesion : (f,) kN; tan_friction : (f,)

    >>> up, none = np.array([[0.0, 0.0, 1.0]]), np.zeros(1)
    >>> sliding_factor(up, np.array([3.0, 0.0, -4.0]), none, np.array([0.75]))
    1.0
    """
    lowest = math.inf
    for a in range(len(normals)):
        for b in range(a, len(normals)):
            if a == b:
                press = -float(force @ normals[a])
                along = force + press * normals[a]
                carried = np.array([press])
            else:
                line = np.cross(normals[a], normals[b])
                size = float(line @ line)
                if size < _PARALLEL:
                    continue
                along = line * (float(force @ line) / size)
                carried = np.linalg.lstsq(np.stack([normals[a], normals[b]], axis=1), along - force, rcond=None)[0]
            pull = math.sqrt(float(along @ along))
            if carried.min() < 0.0 or pull < _PARALLEL * math.sqrt(float(force @ force)):
                continue
            opening = normals @ along / pull
            if opening.min() < -_PARALLEL:
                continue
            on = opening < _PARALLEL
            strength = float(cohesion[on].sum())
            strength += float(carried[0]) * float(tan_friction[a]) + (
                float(carried[1]) * float(tan_friction[b]) if a != b else 0.0
            )
            lowest = min(lowest, strength / pull)
    return lowest


def depths(assembly: Assembly, gone: Bools, blocks: Ints) -> Ints:
    """How many blocks lie between each of `blocks` and the free surface: 0 at the surface."""
    a, b, c = (assembly.vertices[assembly.triangles[:, k]] for k in range(3))
    sizes = np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1)) / 2.0
    count = len(assembly)
    surface = np.bincount(assembly.triangle_block, sizes, count)
    patches = assembly.patches
    out = np.append(gone, False)
    touching = ~out[patches.plus] & ~out[patches.minus]
    covered = np.zeros(count)
    for side in (patches.plus, patches.minus):
        at = touching & (side >= 0)
        covered += np.bincount(side[at], patches.areas[at], count)
    inside = np.zeros(count + 1, dtype=bool)
    inside[blocks] = True
    both = inside[patches.plus] & inside[patches.minus] & (patches.plus >= 0) & (patches.minus >= 0)
    plus, minus = patches.plus[both], patches.minus[both]
    depth = np.full(count, count)
    at_surface = blocks[surface[blocks] - covered[blocks] > _FREE * surface[blocks]]
    depth[at_surface] = 0
    level, reached = 0, len(at_surface)
    while reached:
        neighbours = np.concatenate([minus[depth[plus] == level], plus[depth[minus] == level]])
        fresh = np.unique(neighbours[depth[neighbours] == count])
        level, reached = level + 1, len(fresh)
        depth[fresh] = level
    known = depth[blocks] < count
    found: Ints = np.where(known, depth[blocks], depth[blocks][known].max(initial=0) + 1)
    return found
