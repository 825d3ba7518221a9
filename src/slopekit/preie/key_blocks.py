"""Single blocks of an assembly that slide out by themselves: where the search in a large one begins."""

import math

import numpy as np

from slopekit.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import Assembly
from slopekit.loads import AssemblyLoads
from slopekit.preie.model import JointStrength

_PARALLEL = 1e-9


def slide_alone(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, gone: Bools, free: Ints
) -> list[int]:
    """Blocks among `free` that would slide out alone, the lowest factor first.

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
        if factor < math.inf:
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
