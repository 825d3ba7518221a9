"""The bolts that hold a block when its planes move, the same for the closed form and for PRE-IE.

A bolt stays on its line. In samples of a slope its head stands on the free face that the line meets, as it was laid
out: it gives no force where the line does not pass from a free face through a joint, or where it ends within the block.
In other designs its head stays where it is, as in a run, which refuses a bolt that gives no force.
"""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.design.parts import Bolt
from slopekit.geometry.polytopes import Polytopes, polytopes

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


def has_heads(bolts: Sequence[Bolt]) -> bool:
    """Return whether any bolt has a head."""
    return any(bolt.head_m is not None for bolt in bolts)


def head_offset(bounds: Bounds, bolts: Sequence[Bolt]) -> Floats:
    """Return the distance (b,) m of each bolt head before its free face; 0 where the bolt does not enter by one."""
    return holding_bolts(bounds, bolts, np.zeros(len(bolts)))[1][:, 0]


def holding_bolts(
    bounds: Bounds, bolts: Sequence[Bolt], head_offsets: Floats | None
) -> tuple[Bools, Floats]:
    """Return which bolts (b, n) hold n blocks, and the shifts (b, n) m of their heads along them.

    Bolts without a head always hold.

    Parameters
    ----------
    head_offsets : (b,) as `head_offset` returns them; None where heads stay where they are
    """
    # lengths and directions that scatter are arrays, planes that do not are one for all
    reaches: list[Any] = [np.inf if bolt.length_m is None else bolt.length_m for bolt in bolts]
    numbers = [
        (bounds.offsets[0], reach, *astuple(bolt.toward), *(bolt.head_m or ()))
        for reach, bolt in zip(reaches, bolts, strict=True)
    ]
    count = max((np.broadcast(*row).size for row in numbers), default=bounds.offsets.shape[1])
    holds, shifts = np.ones((len(bolts), count), dtype=bool), np.zeros((len(bolts), count))
    for k, bolt in enumerate(bolts):
        if bolt.head_m is not None:
            head = np.stack(np.broadcast_arrays(*bolt.head_m), axis=-1) - bounds.origin
            line = _line_through(bounds, head, bolt.toward.vector(), head_offsets is None)
            holds[k] = line.is_anchored
            if head_offsets is not None:
                holds[k] &= line.is_from_face
                shifts[k] = np.where(holds[k], line.enters - head_offsets[k], 0.0)
            holds[k] &= line.sound - shifts[k] < reaches[k]
    return holds, shifts


def bolt_exit(bounds: Bounds, heads: Floats, direction: Floats) -> tuple[Floats, Bools]:
    """Return where bolts of any length leave one block, from heads (m, 3) along a direction (3,), and their anchorage.

    Returns
    -------
    how far (m,) from its head each comes out of the block, drawn on behind a tension crack: nan where it misses the
    block, inf where it never does; whether (m,) it does so through a joint: sound rock begins there
    """
    line = _line_through(bounds, heads, direction, True)
    return np.where(line.meets, line.sound, math.nan), line.is_anchored


@dataclass(frozen=True)
class _Line:
    """Lines (n,) through blocks, in m from a point of each.

    Attributes
    ----------
    enters : where it goes into the block; is_from_face : whether through a free face
    sound : where it goes out, drawn on behind a tension crack; is_anchored : whether it meets the block and goes out
        through a joint
    meets : whether a part of it lies within the block
    """

    enters: Floats
    is_from_face: Bools
    sound: Floats
    is_anchored: Bools
    meets: Bools


def _line_through(bounds: Bounds, points: Floats, direction: Floats, from_points: bool) -> _Line:
    """Return lines along a direction (3,) or (n, 3) through points (n, 3), from the origin of the blocks.

    Parameters
    ----------
    from_points : only what lies ahead of the points meets a block
    """
    gap = bounds.offsets - (bounds.outward * points).sum(axis=2)  # (planes, n)
    slope = (bounds.outward * direction).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = gap / slope
    is_parallel = np.abs(slope) < 1e-12
    going_in = np.where((slope < 0.0) & ~is_parallel, distances, -np.inf)
    going_out = np.where((slope > 0.0) & ~is_parallel, distances, np.inf)
    planes = np.arange(len(bounds.offsets))
    is_free, is_joint = np.isin(planes, bounds.free), np.isin(planes, bounds.joints)
    # rock behind a tension crack hangs on the same joints: it holds a bolt behind them
    onward = np.where((is_free | is_joint)[:, None], going_out, np.inf)
    enters, sound = going_in.max(axis=0), onward.min(axis=0)
    begins = np.maximum(enters, 0.0) if from_points else enters
    misses = (is_parallel & (gap < -_CLEAR * bounds.size)).any(axis=0)
    meets = ~misses & (going_out.min(axis=0) - begins > _CLEAR * bounds.size)
    is_anchored = meets & np.isfinite(sound) & is_joint[onward.argmin(axis=0)]
    return _Line(enters, is_free[going_in.argmax(axis=0)], sound, is_anchored, meets)


def pulling(bolt: Bolt, holds: Any) -> Bolt:
    """Return a bolt with its force in those of n blocks that it holds (n,), and none in the others."""
    return replace(bolt, force_kn=bolt.force_kn * holds)


# -- bounds from planes ------------------------------------------------------------------------------------------------


def upward(dip_deg: Any, direction_deg: Any) -> Floats:
    """Return the upward unit normals (n, 3) of planes whose angles are numbers or arrays."""
    dip, direction = np.broadcast_arrays(
        np.radians(np.atleast_1d(dip_deg)), np.radians(np.atleast_1d(direction_deg))
    )
    return np.stack(
        [np.sin(dip) * np.sin(direction), np.sin(dip) * np.cos(direction), np.cos(dip)], axis=-1
    )


def bounds_of(
    normals: Sequence[Floats],
    offsets: Sequence[Any],
    origin: Floats,
    joints: tuple[int, ...],
    free: tuple[int, ...],
    size: Any,
) -> Bounds:
    """Return the bounds of blocks from planes `normal · x <= offset` about a local origin.

    Parameters
    ----------
    normals : of each plane (1, 3) or (n, 3), out of the block; offsets : of each, a number or (n,)
    """
    count = max(len(np.atleast_1d(values)) for values in (*normals, *offsets, size))
    outward = np.stack([np.broadcast_to(normal, (count, 3)) for normal in normals])
    distances = np.stack(
        [np.broadcast_to(np.asarray(offset, dtype=np.float64), count) for offset in offsets]
    )
    return Bounds(outward, distances, origin, joints, free, np.broadcast_to(size, count))


def blocks_within(bounds: Bounds, count: int) -> Polytopes:
    """Return the blocks of n designs; of a slope that goes on alike along itself a metre, with the ends last."""
    outward, offsets = list(bounds.outward), list(bounds.offsets)
    if bounds.along is not None:
        outward += [bounds.along, -bounds.along]
        offsets += [np.full(1, 0.5)] * 2
    return polytopes(
        np.stack([np.broadcast_to(normals, (count, 3)) for normals in outward], axis=1),
        np.stack([np.broadcast_to(offset, count) for offset in offsets], axis=1),
        np.broadcast_to(bounds.size, count),
    )
