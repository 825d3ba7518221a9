"""One wedge on two joints cut out of its planes, and what acts on it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.arrays import Floats, cross, frozen
from slopekit.core.orientation import Line, line_of
from slopekit.extents import WedgeGeometry
from slopekit.geometry.interfaces import node_pairs
from slopekit.geometry.rock.cutting import Block, cut_wedge
from slopekit.geometry.rock.rockmass import CRACK, J1, J2, PLANE_NAMES, RockMass, wedge_rock_mass
from slopekit.kinds.single_block.one_block import left_out_of_slope
from slopekit.kinds.single_block.one_block_limit import Cut, Interface
from slopekit.kinds.single_block.one_block_states import Bedding
from slopekit.kinds.sizes import Crest, sizes_of_faces
from slopekit.kinds.solver_inputs import bolt_forces, joint_strength, point_force
from slopekit.kinds.wedge import limits
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.loads import Hull, Loads, PointForce, block_loads
from slopekit.preie.system.model import build_model

if TYPE_CHECKING:
    from slopekit.kinds.water import LocalSlope, OnFaces


@dataclass(frozen=True)
class Shape:
    """A wedge cut out of its planes, on two joints or on a basal joint too, with what is said of it by its planes.

    Attributes
    ----------
    block : its faces by plane id; planes : names by id: the joints, face, upper slope, crack
    line : (3,) unit vector down the intersection of J1 and J2; line_length_m : of it that bounds the block
    corners_m : (3,) each by name
    trend_deg : that an earthquake without a trend acts toward; stays : in words, what is left out of it alone
    """

    block: Block
    planes: tuple[str, ...]
    line: Floats
    line_length_m: float
    corners_m: Mapping[str, Floats]
    trend_deg: float
    stays: tuple[str, ...] = ()


def shape_of(design: WedgeDesign) -> Shape:
    """The wedge cut out of its planes. Raises GeometryError where they cut no such wedge."""
    if design.basal is not None:
        from slopekit.kinds.wedge import basal

        return basal.shape_of(design)
    rock = rock_mass(design)
    block, line = cut_wedge(rock), rock.line_of_intersection
    back = rock.back
    if CRACK in block.faces:
        back = rock.back * float(rock.offsets[CRACK] / (rock.normals[CRACK] @ rock.back))
    corners = {"toe": rock.toe, "back": back, "crest_J1": rock.crest1, "crest_J2": rock.crest2}
    return Shape(
        block, PLANE_NAMES, line, math.sqrt(float(back @ back)), corners, line_of(line).trend_deg,
    )  # fmt: skip


def cut(design: WedgeDesign) -> Cut:
    """Cut the wedge and load it. Raises GeometryError where the planes cut no such wedge."""
    shape = shape_of(design)
    block, joints = shape.block, range(len(design.strengths))
    face, upper, crack = range(joints.stop, joints.stop + 3)

    @cache  # which a block without bolts does not need
    def hull() -> Hull:
        return Hull.of(block, joints, crack)

    acting = _loads(design, shape, hull)
    polygons = {joint: block.faces[joint] for joint in joints}
    strength = joint_strength(design.strengths)
    bedding = Bedding(polygons, block.centroid, lambda pairs: build_model(pairs, acting, block.centroid, strength))
    interfaces = {plane: shape.planes[plane] for plane in block.faces if plane not in (face, upper)}
    left_out = ["deformation of the rock", *shape.stays]
    return Cut(
        block, acting, lambda refine: bedding.scene(node_pairs(polygons, refine)),
        [Interface(joint, interfaces[joint], own) for joint, own in zip(joints, design.strengths, strict=True)],
        lambda: _geometry(design, shape, interfaces),
        left_out_of_slope(left_out, crack in interfaces, design.strengths),
        interfaces | design.ponded(face, upper), face, hull, design.refine, origin=np.array(design.origin_m),
    )  # fmt: skip


def rock_mass(design: WedgeDesign) -> RockMass:
    joints = np.array([plane.normal() for plane in design.joints])
    crack = design.crack
    return wedge_rock_mass(
        joints, design.face.normal(), design.upper.normal(), limits.slope_height(design),
        crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip


def _loads(design: WedgeDesign, shape: Shape, hull: Callable[[], Hull]) -> Loads:
    block, origin = shape.block, np.array(design.origin_m)
    trend = shape.trend_deg if design.seismic.trend_deg is None else design.seismic.trend_deg
    active, passive = bolt_forces(design, origin, lambda head, way: hull().meets(head, way))
    pushes: dict[str, PointForce] = {}
    if design.is_wet or design.is_cut_for_loads:  # plain wedges do not pay
        from slopekit.kinds.water import pushes_on
        from slopekit.kinds.wedge import bounds

        pushes = pushes_on(design, bounds(design), full_water, np.eye(3))
    return block_loads(
        block, design.rock.unit_weight_kn_m3, design.seismic.coefficient * Line(trend, 0.0).vector(),
        [point_force(force, origin) for force in design.forces], active, passive, pushes,
    )  # fmt: skip


def full_water(slope: "LocalSlope", unit_weight: Any) -> "list[OnFaces]":
    """Full water on the joints and the crack: Hoek & Bray's pyramids; above a basal joint even over each face.

    The mean is γ_w H/6, highest half way along the line of intersection; with a crack γ_w h₅/3, highest where the crack
    meets the line, h₅ below the upper slope.
    """
    from slopekit.geometry.pressure import even, pyramid  # plain wedges do not pay

    planes = slope.interfaces
    faces = slope.faces[planes]
    normal, offset = slope.normals[1], slope.offsets[1]
    if slope.crack is not None:
        corners = slope.faces[slope.crack]
        depths = (offset[:, None] - (corners * normal[:, None]).sum(axis=2)) / normal[:, 2:]
        mean = unit_weight * depths.max(axis=1) / 3.0
        apex = np.take_along_axis(corners, depths.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    else:
        mean = unit_weight * slope.extents[:, 2] / 6.0
        line = cross(*slope.normals_and_areas[0][[J1, J2]])
        with np.errstate(divide="ignore", invalid="ignore"):
            apex = line * (offset / (line * normal).sum(axis=1))[:, None] / 2.0
    return [(planes, even(faces, mean) if len(slope.joints) > 2 else pyramid(faces, mean, apex))]


def _geometry(design: WedgeDesign, shape: Shape, interfaces: Mapping[int, str]) -> WedgeGeometry:
    block, line, origin = shape.block, line_of(shape.line), np.array(design.origin_m)
    areas = {name: block.areas[plane] for plane, name in interfaces.items()}
    faces = {shape.planes[plane]: polygon for plane, polygon in block.faces.items()}
    crest = Crest(shape.corners_m["crest_J1"], design.face.normal(), design.upper.normal())
    return WedgeGeometry(
        block.volume, float(np.ptp(block.corners[:, 2])), areas, line.trend_deg, line.plunge_deg, shape.line_length_m,
        {name: frozen(point + origin) for name, point in shape.corners_m.items()}, frozen(block.centroid + origin),
        {name: frozen(polygon + origin) for name, polygon in faces.items()}, sizes_of_faces(faces, areas, crest),
        limits.scaled(design),
    )  # fmt: skip
