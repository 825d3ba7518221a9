"""The wedges that pairs of joints cut from a slope, and how far limits of size scale them down.

One height serves every pair: the slope's own, vertical, from the toe of a wedge to the crest straight up the dip of
the face. Where the crest is level, that is the height of every trace too. Where it is not, the heights of traces differ
(Hoek & Bray's H1 is the height at the trace of joint 1), so that of each trace follows from the one given.

A wedge that a limit makes smaller keeps its shape and its crest: its toe moves up the face.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slopekit.arrays import Floats, Ints
from slopekit.errors import Fault, GeometryError
from slopekit.orientation import Plane

#: What made a wedge smaller.
LIMITED_BY = ("", "persistence", "bench width", "max volume")
_PARALLEL = 1e-6  # as in geometry.rockmass


@dataclass(frozen=True, slots=True)
class SizeLimits:
    """Limits of size, None where there is none.

    Attributes
    ----------
    persistence_m : the longest edge that the face of a joint has in a wedge: traces and line of intersection
    bench_width_m : how far behind the crest a wedge reaches, horizontally and square to the crest
    max_volume_m3 : wedges are scaled down to it; min_volume_m3 : smaller ones are left out
    """

    persistence_m: float | None = None
    bench_width_m: float | None = None
    max_volume_m3: float | None = None
    min_volume_m3: float | None = None

    def to_dict(self) -> dict[str, float | None]:
        """As JSON values."""
        return {
            "persistence_m": self.persistence_m, "bench_width_m": self.bench_width_m,
            "max_volume_m3": self.max_volume_m3, "min_volume_m3": self.min_volume_m3,
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class PairShapes:
    """Pairs of joints as wedges.

    Attributes
    ----------
    first, second : (m,) indices of the joints, in the order in which the height is that of the first one's trace
    height_m : (m,) of that trace at the wedge's own size, 0 or less where neither trace climbs to the crest
    scale : (m,) of lengths, 1 for the full slope; limited_by : (m,) indices into `LIMITED_BY`
    """

    first: Ints
    second: Ints
    height_m: Floats
    scale: Floats
    limited_by: NDArray[np.int8]


def crest_offset(face: Plane, upper: Plane, height_m: float) -> float:
    """Offset of the upper slope from the toe of a wedge: normal · x at the crest.

    Raises
    ------
    GeometryError
        E209 face and upper slope make no crest above the toe.
    """
    edge = np.cross(face.normal(), upper.normal())
    if math.sqrt(float(edge @ edge)) < _PARALLEL:
        raise GeometryError([Fault("E209", "face and upper slope have the same orientation: there is no crest")])
    offset = float(upper.normal() @ _crest_point(face, height_m))
    if not offset > _PARALLEL * height_m or math.hypot(edge[0], edge[1]) < _PARALLEL:
        message = f"the upper slope ({upper}) climbs as fast as the face ({face}): they make no crest above the toe"
        raise GeometryError([Fault("E209", message)])
    return offset


def pair_shapes(
    normals: Floats, first: Ints, second: Ints, face: Plane, upper: Plane, height_m: float, limits: SizeLimits
) -> PairShapes:
    """The size of the wedge of every pair; of pairs that cut no wedge it means nothing.

    Parameters
    ----------
    normals : (n, 3) upward, of the joints; first, second : (m,) indices
    height_m : vertical, up the dip of the face from the toe to the crest

    Raises
    ------
    GeometryError
        As `crest_offset`.
    """
    offset = crest_offset(face, upper, height_m)
    top = upper.normal()
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        traces = np.cross(normals, face.normal())
        climb = traces @ top
        flat = (np.abs(climb) < _PARALLEL) | (np.abs(traces[:, 2]) < _PARALLEL)
        crests = traces * np.where(flat, 0.0, offset / climb)[:, None]
        heights = crests[:, 2]
        swap = (heights[first] <= 0.0) & (heights[second] > 0.0)
        one, two = np.where(swap, second, first), np.where(swap, first, second)
        scale, by = np.ones(len(one)), np.zeros(len(one), dtype=np.int8)
        if limits.persistence_m or limits.bench_width_m or limits.max_volume_m3:
            line = np.cross(normals[one], normals[two])
            back = line * (offset / (line @ top))[:, None]
            for kind, factor in enumerate(_factors(crests, one, two, back, face, top, height_m, limits), 1):
                less = factor < scale
                scale, by = np.where(less, factor, scale), np.where(less, np.int8(kind), by)
    return PairShapes(one, two, heights[one] * scale, scale, by)


def _factors(
    crests: Floats, one: Ints, two: Ints, back: Floats, face: Plane, top: Floats, height_m: float, limits: SizeLimits
) -> list[Floats]:
    """How much smaller each limit makes each wedge, in the order of `LIMITED_BY`."""
    none = np.full(len(one), np.inf)
    found = [none, none, none]
    if limits.persistence_m:
        lengths = _length(crests)
        longest = np.maximum(lengths[one], lengths[two])
        for edge in (back, crests[one] - back, crests[two] - back):
            longest = np.maximum(longest, _length(edge))
        found[0] = limits.persistence_m / longest
    if limits.bench_width_m:
        edge = np.cross(face.normal(), top)
        across = np.array([-edge[1], edge[0], 0.0]) / math.hypot(edge[0], edge[1])
        found[1] = limits.bench_width_m / np.abs((back - _crest_point(face, height_m)) @ across)
    if limits.max_volume_m3:
        volume = np.abs(np.einsum("ij,ij->i", crests[one], np.cross(crests[two], back))) / 6.0
        found[2] = np.cbrt(limits.max_volume_m3 / volume)
    return found


def _crest_point(face: Plane, height_m: float) -> Floats:
    """The crest straight up the dip of the face from the toe, (3,)."""
    dip, direction = math.radians(face.dip_deg), math.radians(face.dip_direction_deg)
    back = math.cos(dip) / math.sin(dip) if face.dip_deg > 0.0 else math.inf
    return height_m * np.array([-math.sin(direction) * back, -math.cos(direction) * back, 1.0])


def _length(vectors: Floats) -> Floats:
    length: Floats = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    return length
