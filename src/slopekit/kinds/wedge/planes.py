"""The planes of wedges, of one or of n at once, and the blocks that they bound."""

from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.kinds.single_block.held_bolts import Bounds, bounds_of, upward
from slopekit.kinds.wedge import limits
from slopekit.kinds.wedge.design import WedgeDesign

J1, J2, BASAL = range(3)
_ON = 1e-12  # of the size of a wedge: its crest is on the crack


def plane_names(design: WedgeDesign) -> tuple[str, ...]:
    """The names of the planes, as `bounds` has them."""
    return ("J1", "J2", *(() if design.basal is None else ("basal",)), "face", "upper slope", "crack")


def heights(design: WedgeDesign) -> tuple[Any, Any]:
    """Return the height (m) of a wedge whose numbers may be arrays, and which of `limits.CODES` refuses its size.

    The latter is below 0 where none does, and None where nothing limits the size.
    """
    if design.limits is None:
        return design.height_m, None
    fit = limits.fitted(design)
    scaled, misfit = np.asarray(design.height_m) * fit.scale, fit.why.astype(np.int64) - 1
    return (scaled, misfit) if len(misfit) > 1 else (float(scaled[0]), int(misfit[0]))


def crest_geometry(design: WedgeDesign) -> tuple[list[Floats], list[Floats], Floats, Floats]:
    """Of the wedges of a design whose numbers may be arrays: upward normals of J1, J2, face and upper slope (n, 3).

    Then the traces of the joints on the face, where that of J1 meets the crest (n, 3), the upper slope's offset (n,).
    """
    planes = (*design.joints, design.face, design.upper)
    normals = [upward(plane.dip_deg, plane.dip_direction_deg) for plane in planes]
    traces = [np.cross(joint, normals[2]) for joint in normals[:2]]
    with np.errstate(divide="ignore", invalid="ignore"):
        crest = traces[0] * (np.atleast_1d(heights(design)[0]) / traces[0][:, 2])[:, None]
    return normals, traces, crest, dots(normals[3], crest)


def basal_at(design: WedgeDesign) -> tuple[Floats, Floats]:
    """The upward normals (n, 3) of basal joints, and where (n, 3) they meet the trace of J1 on the face."""
    basal = design.basal
    assert basal is not None
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.atleast_1d(basal.height_m) / np.atleast_1d(design.height_m)
        return upward(basal.plane.dip_deg, basal.plane.dip_direction_deg), crest_geometry(design)[2] * share[:, None]


def bounds(design: WedgeDesign) -> Bounds:
    """The planes that bound the block: joints, basal joint, face, upper slope, crack.

    Two joints and the face meet in the origin. The block lies above the basal joint, between the traces; where the
    height of the basal joint is below 0, it lies under the origin (a socket wedge). Of planes that cut no block they
    are not numbers, or mean nothing.
    """
    (first, second, face, upper), traces, crest1, offset = crest_geometry(design)
    joints = 2 if design.basal is None else 3
    below: Any = 1.0 if design.basal is None else np.where(np.atleast_1d(design.basal.height_m) < 0.0, -1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        line = np.cross(first, second)
        crest2, back = (way * (offset / dots(upper, way))[:, None] for way in (traces[1], line))
        sides = [np.copysign(1.0, dots(first, crest2)) * below, np.copysign(1.0, dots(second, crest1)) * below]
        outward = [-sides[0][:, None] * first, -sides[1][:, None] * second]
        offsets: list[Any] = [0.0, 0.0]
        if design.basal is not None:
            basal_normal, on_trace = basal_at(design)
            outward, offsets = [*outward, -basal_normal], [*offsets, -dots(basal_normal, on_trace)]
        outward, offsets = [*outward, face, upper], [*offsets, 0.0, offset]
        if design.crack is not None:
            crack = upward(design.crack.plane.dip_deg, design.crack.plane.dip_direction_deg)
            ahead = dots(crack, trace_behind(first, face, upper)) * design.crack.distance_m
            sign = np.where(ahead > 0.0, 1.0, -1.0)  # the crest lies in front of it
            place = sign * (dots(crack, crest1) + ahead)
            if design.basal is None:  # it must not cut the crest off: both parts would be free to leave the rock (E208)
                behind = [sign * dots(crack, crest) / place > 1.0 + _ON for crest in (crest1, crest2)]
                place = np.where(behind[0] | behind[1], np.nan, place)
            outward, offsets = [*outward, sign[:, None] * crack], [*offsets, place]
    corners = (back,) if design.basal is None else (crest1, crest2)
    size = np.sqrt(np.max(np.broadcast_arrays(*(dots(corner, corner) for corner in corners)), axis=0))
    origin = np.array(design.origin_m)
    return bounds_of(outward, offsets, origin, tuple(range(joints)), (joints, joints + 1), size)


def trace_behind(joint: Floats, face: Floats, upper: Floats) -> Floats:
    """The unit vectors (n, 3) along J1's traces on the upper slope, away from the crest."""
    trace = np.cross(joint, upper)
    unit: Floats = trace / (np.copysign(np.sqrt(dots(trace, trace)), -dots(face, trace)))[:, None]
    return unit


def dots(first: Floats, second: Floats) -> Floats:
    """The products (n,) of vectors (n, 3)."""
    products: Floats = (first * second).sum(axis=-1)
    return products
