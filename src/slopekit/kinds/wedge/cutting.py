"""Wedges by their bounding planes, one or n at once, and the shape and loads of a single wedge."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.arrays import Floats, cross, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.orientation import line_of
from slopekit.extents import WedgeGeometry
from slopekit.geometry.interfaces import node_pairs
from slopekit.geometry.polytopes import Block
from slopekit.geometry.rock.rockmass import wedge_corners
from slopekit.kinds.single_block.held_bolts import Bounds, blocks_within, bounds_of, upward
from slopekit.kinds.single_block.one_block import left_out_of_slope
from slopekit.kinds.single_block.one_block_limit import Cut, Interface, bedding_on
from slopekit.kinds.sizes import Crest, sizes_of_faces
from slopekit.kinds.solver_inputs import loads_in_slope
from slopekit.kinds.wedge import limits
from slopekit.kinds.wedge.design import WedgeDesign

if TYPE_CHECKING:
    from slopekit.kinds.water import LocalSlope, OnFaces

J1, J2, BASAL = range(3)
_CREST_TOLERANCE = 1e-12  # of the size of a wedge: its crest is on the crack


def plane_names(design: WedgeDesign) -> tuple[str, ...]:
    """Return the names of the planes, in the order of `bounds`."""
    return (
        "J1",
        "J2",
        *(() if design.basal is None else ("basal",)),
        "face",
        "upper slope",
        "crack",
    )


def heights(design: WedgeDesign) -> tuple[Any, Any]:
    """Return the height (m) of a wedge whose numbers may be arrays, and which of `limits.CODES` refuses its size.

    The latter is below 0 where none does, and None where nothing limits the size.
    """
    if design.limits is None:
        return design.height_m, None
    fit = limits.fitted(design)
    scaled, misfit = np.asarray(design.height_m) * fit.scale, fit.refusal.astype(np.int64) - 1
    return (scaled, misfit) if len(misfit) > 1 else (float(scaled[0]), int(misfit[0]))


def crest_geometry(design: WedgeDesign) -> tuple[list[Floats], list[Floats], Floats, Floats]:
    """Return normals, traces, crest point and upper slope's offset of the wedges of a design.

    The numbers of the design may be arrays. The upward normals are those of J1, J2, face and upper slope, (n, 3) each;
    the traces are those of the joints on the face, (n, 3); the crest point is that of J1's trace, (n, 3) m.
    """
    planes = (*design.joints, design.face, design.upper)
    normals = [upward(plane.dip_deg, plane.dip_direction_deg) for plane in planes]
    traces = [np.cross(joint, normals[2]) for joint in normals[:2]]
    with np.errstate(divide="ignore", invalid="ignore"):
        crest = traces[0] * (np.atleast_1d(heights(design)[0]) / traces[0][:, 2])[:, None]
    return normals, traces, crest, dots(normals[3], crest)


def basal_at(design: WedgeDesign) -> tuple[Floats, Floats]:
    """Return the upward normals (n, 3) of basal joints, and the points (n, 3) m on the trace of J1 that they pass."""
    basal = design.basal
    assert basal is not None
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.atleast_1d(basal.height_m) / np.atleast_1d(design.height_m)
        return upward(basal.plane.dip_deg, basal.plane.dip_direction_deg), crest_geometry(design)[
            2
        ] * share[:, None]


def bounds(design: WedgeDesign) -> Bounds:
    """Return the planes that bound the block: joints, basal joint, face, upper slope, crack.

    Two joints and the face meet in the origin. The block lies above the basal joint, between the traces; where the
    height of the basal joint is below 0, it lies under the origin (a socket wedge). Of planes that cut no block they
    are not numbers, or mean nothing.
    """
    (first, second, face, upper), traces, crest1, offset = crest_geometry(design)
    joints = 2 if design.basal is None else 3
    below: Any = (
        1.0
        if design.basal is None
        else np.where(np.atleast_1d(design.basal.height_m) < 0.0, -1.0, 1.0)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        line = np.cross(first, second)
        crest2, back = (
            direction * (offset / dots(upper, direction))[:, None]
            for direction in (traces[1], line)
        )
        sides = [
            np.copysign(1.0, dots(first, crest2)) * below,
            np.copysign(1.0, dots(second, crest1)) * below,
        ]
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
            if (
                design.basal is None
            ):  # it must not cut the crest off: both parts would be free to leave the rock (E208)
                behind = [
                    sign * dots(crack, crest) / place > 1.0 + _CREST_TOLERANCE
                    for crest in (crest1, crest2)
                ]
                place = np.where(behind[0] | behind[1], np.nan, place)
            outward, offsets = [*outward, sign[:, None] * crack], [*offsets, place]
    corners = (back,) if design.basal is None else (crest1, crest2)
    size = np.sqrt(
        np.max(np.broadcast_arrays(*(dots(corner, corner) for corner in corners)), axis=0)
    )
    origin = np.array(design.origin_m)
    return bounds_of(outward, offsets, origin, tuple(range(joints)), (joints, joints + 1), size)


def trace_behind(joint: Floats, face: Floats, upper: Floats) -> Floats:
    """Return the unit vectors (n, 3) along J1's traces on the upper slope, away from the crest."""
    trace = np.cross(joint, upper)
    unit: Floats = trace / (np.copysign(np.sqrt(dots(trace, trace)), -dots(face, trace)))[:, None]
    return unit


def dots(first: Floats, second: Floats) -> Floats:
    """Return the scalar products (n,) of vectors (n, 3)."""
    products: Floats = (first * second).sum(axis=-1)
    return products


@dataclass(frozen=True)
class Shape:
    """A wedge cut out of its planes, on two joints and maybe a basal joint, with its line and corners.

    Attributes
    ----------
    bounds : its planes; block : its faces, by the numbers of these
    line : (3,) unit vector down the intersection of J1 and J2; line_length_m : of it that bounds the block
    corners_m : (3,) each by name
    """

    bounds: Bounds
    block: Block
    line: Floats
    line_length_m: float
    corners_m: Mapping[str, Floats]


def shape_of(design: WedgeDesign) -> Shape:
    """Return the wedge cut out of its planes. Raises GeometryError where they cut no such wedge."""
    if design.basal is not None:
        from slopekit.kinds.wedge import basal

        return basal.shape_of(design)
    (back, crest1, crest2), planes = design_corners(design), bounds(design)
    if np.isnan(planes.offsets).any():
        message = (
            "the crack cuts the wedge in two below its crest: both parts are free to leave the rock"
        )
        raise GeometryError([Fault("E208", message)])
    block, names = blocks_within(planes, 1).block(), plane_names(design)
    missing = [names[plane] for plane in range(len(planes.outward)) if plane not in block.faces]
    if {"J1", "J2", "face"} & set(missing):
        raise GeometryError(
            [Fault("E208", "joints and face bound no wedge: one of them does not reach it")]
        )
    if "crack" in missing:
        raise GeometryError(
            [Fault("E207", "the crack does not bound the wedge between the toe and its back")]
        )
    line = -back / math.sqrt(float(back @ back))
    if design.crack is not None:
        back = back * float(planes.offsets[-1, 0] / (planes.outward[-1, 0] @ back))
    corners = {"toe": np.zeros(3), "back": back, "crest_J1": crest1, "crest_J2": crest2}
    return Shape(planes, block, line, math.sqrt(float(back @ back)), corners)


def cut(design: WedgeDesign) -> Cut:
    """Cut the wedge and load it. Raises GeometryError where the planes cut no such wedge."""
    shape = shape_of(design)
    block, joints, names = shape.block, range(len(design.strengths)), plane_names(design)
    face, upper, crack = range(joints.stop, joints.stop + 3)
    acting = loads_in_slope(design, block, shape.bounds, full_water, shaken(design)[0], np.eye(3))
    polygons = {joint: block.faces[joint] for joint in joints}
    bedding = bedding_on(polygons, acting, block.centroid, design.strengths, in_section=False)
    interfaces = {plane: names[plane] for plane in block.faces if plane not in (face, upper)}
    stays = [] if design.basal is None else ["the rock below the basal joint (it stays)"]
    return Cut(
        block,
        acting,
        lambda refine: bedding.scene(node_pairs(polygons, refine)),
        [
            Interface(joint, interfaces[joint], peak)
            for joint, peak in zip(joints, design.strengths, strict=True)
        ],
        lambda: _geometry(design, shape, interfaces),
        left_out_of_slope(
            ["deformation of the rock", *stays], crack in interfaces, design.strengths
        ),
        interfaces | design.ponded(face, upper),
        face,
        shape.bounds,
        design.refine,
        origin=np.array(design.origin_m),
    )


def design_corners(design: WedgeDesign) -> tuple[Floats, Floats, Floats]:
    """Return `wedge_corners` of a wedge on two joints. Raises GeometryError without one, or beyond its limits."""
    joints = np.array([plane.normal() for plane in design.joints])
    crack = design.crack
    return wedge_corners(
        joints,
        design.face.normal(),
        design.upper.normal(),
        limits.slope_height(design),
        crack.plane.normal() if crack else None,
        crack.distance_m if crack else 0.0,
    )


def full_water(slope: "LocalSlope", unit_weight: Any) -> "list[OnFaces]":
    """Return full water on joints and crack: Hoek & Bray's pyramids, or uniform over each face above a basal joint.

    The mean is γ_w H/6, highest half way along the line of intersection; with a crack γ_w h₅/3, highest where the crack
    meets the line, h₅ below the upper slope.
    """
    from slopekit.geometry.pressure import pyramid_pieces, uniform_pieces  # plain wedges do not pay

    planes = slope.interfaces
    faces = slope.faces[planes]
    upper = slope.bounds.free[1]
    normal, offset = slope.solids.outward[:, upper], slope.solids.offsets[:, upper]
    if slope.crack is not None:
        corners = slope.faces[slope.crack]
        depths = (offset[:, None] - (corners * normal[:, None]).sum(axis=2)) / normal[:, 2:]
        mean = unit_weight * depths.max(axis=1) / 3.0
        apex = np.take_along_axis(corners, depths.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    else:
        mean = unit_weight * slope.extents[:, 2] / 6.0
        line = cross(slope.solids.outward[:, J1], slope.solids.outward[:, J2])
        with np.errstate(divide="ignore", invalid="ignore"):
            apex = line * (offset / (line * normal).sum(axis=1))[:, None] / 2.0
    return [
        (
            planes,
            uniform_pieces(faces, mean)
            if len(slope.bounds.joints) > 2
            else pyramid_pieces(faces, mean, apex),
        )
    ]


def shaken(design: WedgeDesign) -> Floats:
    """Return the direction (n, 3) of a seismic load with no trend: down the line of intersection or out of the face."""
    if design.basal is not None:
        return _level(upward(90.0, design.face.dip_direction_deg))
    first, second = (upward(plane.dip_deg, plane.dip_direction_deg) for plane in design.joints)
    line = cross(first, second)
    return _level(np.where(line[:, 2:] > 0.0, -line, line))


def _level(vectors: Floats) -> Floats:
    """Return the horizontal unit vectors (n, 3) along vectors."""
    level = vectors * [1.0, 1.0, 0.0]
    return np.asarray(level / np.sqrt((level * level).sum(axis=1))[:, None])


def _geometry(design: WedgeDesign, shape: Shape, interfaces: Mapping[int, str]) -> WedgeGeometry:
    block, line, origin = shape.block, line_of(shape.line), np.array(design.origin_m)
    names, areas = (
        plane_names(design),
        {name: block.areas[plane] for plane, name in interfaces.items()},
    )
    faces = {names[plane]: polygon for plane, polygon in block.faces.items()}
    crest = Crest(shape.corners_m["crest_J1"], design.face.normal(), design.upper.normal())
    return WedgeGeometry(
        block.volume,
        float(np.ptp(block.corners[:, 2])),
        areas,
        line.trend_deg,
        line.plunge_deg,
        shape.line_length_m,
        {name: frozen(point + origin) for name, point in shape.corners_m.items()},
        frozen(block.centroid + origin),
        {name: frozen(polygon + origin) for name, polygon in faces.items()},
        sizes_of_faces(faces, areas, crest),
        limits.scaled(design),
    )
