"""Which bolts still hold a block when its planes move: the same ones for the closed form and for PRE-IE.

A bolt stays on its line, and its head on the free face that the line meets: it was laid out there. It gives no force
where the line does not pass from a free face through a joint, or where the bolt ends within the block.
"""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any, TypeVar

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.design.common import Design
from slopekit.design.parts import Bolt

D = TypeVar("D", bound=Design)
#: Between the planes of J1 and J2: where they are nearer to each other W301 says so.
NEARLY_PARALLEL_DEG = 5.0
_CLEAR = 1e-9  # of the size of the block: a line that only touches it does not pass


@dataclass(frozen=True)
class Bounds:
    """The planes that bound the convex blocks of n designs.

    Attributes
    ----------
    outward : (k, n, 3) unit normals; offsets : (k, n) m: `outward · (x - origin) <= offset` within a block
    origin : (3,) m, in the coordinates of the user
    joints, free : the planes that rock lies behind, and those that a head may stand on; a crack is neither: a bolt
        goes on behind it
    size : (n,) m of the blocks
    along : (n, 3) or (1, 3) unit vectors along the slope where blocks are a metre of it; None where planes end them all
    """

    outward: Floats
    offsets: Floats
    origin: Floats
    joints: tuple[int, ...]
    free: tuple[int, ...]
    size: Floats
    along: Floats | None = None


def nearly_parallel(bounds: Bounds, count: int) -> Bools:
    """Return which of n blocks stand on two joints so nearly parallel that W301 says so."""
    if len(bounds.joints) < 2:
        return np.zeros(count, dtype=bool)
    first, second = (bounds.outward[joint] for joint in bounds.joints[:2])
    cosine = np.abs((first * second).sum(axis=1))
    return np.broadcast_to(cosine > math.cos(math.radians(NEARLY_PARALLEL_DEG)), count).copy()


def stand_off(bounds: Bounds, bolts: Sequence[Bolt]) -> Floats:
    """How far (m) before its free face the head of each bolt (b,) was laid out; 0 where it does not enter by one."""
    return held(bounds, bolts, np.zeros(len(bolts)))[1][:, 0]


def held(bounds: Bounds, bolts: Sequence[Bolt], before: Floats) -> tuple[Bools, Floats]:
    """Which bolts (b, n) give their force in n blocks, and how far (b, n) their heads move along them, m.

    Those without a head always do.

    Parameters
    ----------
    before : (b,) as `stand_off` has it
    """
    # lengths and directions that scatter are arrays, planes that do not are one for all
    reaches: list[Any] = [np.inf if bolt.length_m is None else bolt.length_m for bolt in bolts]
    numbers = [(bounds.offsets[0], reach, *astuple(bolt.toward)) for reach, bolt in zip(reaches, bolts, strict=True)]
    count = max((np.broadcast(*each).size for each in numbers), default=bounds.offsets.shape[1])
    holds, moved = np.ones((len(bolts), count), dtype=bool), np.zeros((len(bolts), count))
    for k, bolt in enumerate(bolts):
        if bolt.head_m is not None:
            enters, leaves, passes = _passage(bounds, bolt)
            moved[k] = np.where(passes, enters - before[k], 0.0)
            holds[k] = passes & (leaves - moved[k] < reaches[k])
    return holds, moved


def _passage(bounds: Bounds, bolt: Any) -> tuple[Floats, Floats, Bools]:
    """How far (m) from its head a bolt enters each block and reaches sound rock, and whether it holds it, (n,).

    It does where its line goes in through a free face and out through a joint, drawn on behind a tension crack.
    """
    head = np.stack(np.broadcast_arrays(*bolt.head_m), axis=-1) - bounds.origin
    gap = bounds.offsets - (bounds.outward * head).sum(axis=2)  # (planes, n)
    slope = (bounds.outward * bolt.toward.vector()).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = gap / slope
    along = np.abs(slope) < 1e-12
    going_in = np.where((slope < 0.0) & ~along, at, -np.inf)
    going_out = np.where((slope > 0.0) & ~along, at, np.inf)
    planes = np.arange(len(bounds.offsets))
    is_free, is_joint = np.isin(planes, bounds.free), np.isin(planes, bounds.joints)
    onward = np.where((is_free | is_joint)[:, None], going_out, np.inf)
    enters, sound = going_in.max(axis=0), onward.min(axis=0)
    beside = (along & (gap < -_CLEAR * bounds.size)).any(axis=0)
    passes = (
        ~beside & (going_out.min(axis=0) - enters > _CLEAR * bounds.size) & np.isfinite(enters) & np.isfinite(sound)
    )
    passes &= is_free[going_in.argmax(axis=0)] & is_joint[onward.argmin(axis=0)]
    return enters, sound, passes


def pulling(bolt: Bolt, holds: Any) -> Bolt:
    """A bolt that gives its force in those of n blocks that it holds (n,)."""
    return replace(bolt, force_kn=bolt.force_kn * holds)


def with_held(design: D, bounds: Bounds, before: Floats) -> D:
    """One design with the bolts that hold its block, their heads on its face."""
    holding, along = held(bounds, design.bolts, before)
    bolts = []
    for bolt, holds, moved in zip(design.bolts, holding[:, 0], along[:, 0], strict=True):
        if not holds:
            continue
        if bolt.head_m is not None:
            east, north, up = (np.array(bolt.head_m) + moved * bolt.toward.vector()).tolist()
            bolt = replace(bolt, head_m=(east, north, up))
        bolts.append(bolt)
    return replace(design, bolts=tuple(bolts))


# -- bounds from planes ------------------------------------------------------------------------------------------------


def upward(dip_deg: Any, direction_deg: Any) -> Floats:
    """Upward unit normals (n, 3) of planes whose angles are numbers or arrays."""
    dip, direction = np.broadcast_arrays(np.radians(np.atleast_1d(dip_deg)), np.radians(np.atleast_1d(direction_deg)))
    return np.stack([np.sin(dip) * np.sin(direction), np.sin(dip) * np.cos(direction), np.cos(dip)], axis=-1)


def bounds_of(
    normals: Sequence[Floats], offsets: Sequence[Any], within: Floats | None, origin: Floats, joints: tuple[int, ...],
    free: tuple[int, ...], size: Any,
) -> Bounds:  # fmt: skip
    """Bounds from planes `normal · x = offset` about a local origin.

    Parameters
    ----------
    normals : of each plane (1, 3) or (n, 3); offsets : of each, a number or (n,)
    within : (1, 3) or (n, 3) a point of each block, which says on which side of the planes it lies; None where all
        normals point out of it
    """
    count = max(len(np.atleast_1d(one)) for one in (*normals, *offsets, size, () if within is None else within))
    outward = np.stack([np.broadcast_to(normal, (count, 3)) for normal in normals])
    at = np.stack([np.broadcast_to(np.asarray(offset, dtype=np.float64), count) for offset in offsets])
    if within is not None:
        side = np.where((outward * within).sum(axis=-1) > at, -1.0, 1.0)
        outward, at = outward * side[..., None], at * side
    return Bounds(outward, at, origin, joints, free, np.broadcast_to(size, count))
