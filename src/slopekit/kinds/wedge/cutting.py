"""One wedge on two joints cut out of its planes, and what acts on it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.arrays import Floats, cross, frozen
from slopekit.core.orientation import Line, line_of
from slopekit.extents import WedgeGeometry
from slopekit.geometry.interfaces import node_pairs
from slopekit.geometry.rock.cutting import Block, cut_wedge
from slopekit.geometry.rock.rockmass import CRACK, J1, J2, PLANE_NAMES, UPPER, RockMass, wedge_rock_mass
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

JOINTS = ((J1, "J1"), (J2, "J2"))


@dataclass(frozen=True)
class Shape:
    """A wedge cut out of its planes, on two joints or on a basal joint too, with what is said of it by its planes.

    Attributes
    ----------
    block : its faces by plane id; joints : ids and names of its joints; planes : names of all planes, by id
    offset_m : of the upper slope, upward normal · x; the face passes through the origin
    line : (3,) unit vector down the intersection of J1 and J2; line_length_m : of it that bounds the block
    corners_m : (3,) each by name
    trend_deg : that an earthquake without a trend acts toward; stays : in words, what is left out of it alone
    """

    block: Block
    joints: Sequence[tuple[int, str]]
    planes: tuple[str, ...]
    offset_m: float
    line: Floats
    line_length_m: float
    corners_m: Mapping[str, Floats]
    trend_deg: float
    stays: tuple[str, ...] = ()

    @property
    def ids(self) -> tuple[int, ...]:
        """The plane ids of its joints."""
        return tuple(joint for joint, _ in self.joints)

    @property
    def free(self) -> tuple[int, int]:
        """The plane ids of face and upper slope."""
        return self.planes.index("face"), self.planes.index("upper slope")

    def hull(self) -> Hull:
        """The planes that bolts through the block meet."""
        return Hull.of(self.block, self.ids, self.crack)

    @property
    def crack(self) -> int:
        """The plane id of the crack."""
        return self.planes.index("crack")

    @property
    def interfaces(self) -> dict[int, str]:
        """What bounds it in the rock, by plane id: joints, and the crack where it has a face there."""
        every = (*self.joints, (self.crack, "crack"))
        return {plane: name for plane, name in every if plane in self.block.faces}


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
        block, JOINTS, PLANE_NAMES, float(rock.offsets[UPPER]), line, math.sqrt(float(back @ back)), corners,
        line_of(line).trend_deg,
    )  # fmt: skip


def cut(design: WedgeDesign) -> Cut:
    """Cut the wedge and load it. Raises GeometryError where the planes cut no such wedge."""
    shape = shape_of(design)
    block, face = shape.block, shape.free[0]
    acting = _loads(design, shape)
    polygons = {joint: block.faces[joint] for joint in shape.ids}
    strength = joint_strength(design.strengths)
    bedding = Bedding(polygons, block.centroid, lambda pairs: build_model(pairs, acting, block.centroid, strength))
    left_out = ["deformation of the rock", *shape.stays]
    return Cut(
        block, acting, lambda refine: bedding.scene(node_pairs(polygons, refine)),
        [Interface(joint, name, own) for (joint, name), own in zip(shape.joints, design.strengths, strict=True)],
        lambda: _geometry(design, shape), left_out_of_slope(left_out, shape.crack in block.faces, design.strengths),
        shape.interfaces | design.ponded(*shape.free), face, shape.hull, design.refine,
        origin=np.array(design.origin_m),
    )  # fmt: skip


def rock_mass(design: WedgeDesign) -> RockMass:
    joints = np.array([plane.normal() for plane in design.joints])
    crack = design.crack
    return wedge_rock_mass(
        joints, design.face.normal(), design.upper.normal(), height_of(design),
        crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip


def height_of(design: WedgeDesign) -> float:
    """Of the wedge itself: where limits of size make it smaller, less than the slope's."""
    return design.height_m if design.limits is None else limits.fitted_height(design)


def _loads(design: WedgeDesign, shape: Shape) -> Loads:
    block, origin = shape.block, np.array(design.origin_m)
    trend = shape.trend_deg if design.seismic.trend_deg is None else design.seismic.trend_deg
    hull = cache(shape.hull)  # which a block without bolts does not need
    active, passive = bolt_forces(design, origin, lambda head, way: hull().meets(head, way))
    pushes: dict[str, PointForce] = {}
    if design.is_wet or design.is_cut_for_loads:  # plain wedges do not pay
        from slopekit.kinds.water import LocalSlope, pushes_of_cut

        slope = LocalSlope.of_cut(
            block, shape.ids, shape.crack, shape.free, np.array([[design.face.normal()], [design.upper.normal()]]),
            np.array([[0.0], [shape.offset_m]]), -Line(design.face.dip_direction_deg, 0.0).vector()[None], None,
            full_water, np.eye(3), design.origin_m[2],
        )  # fmt: skip
        pushes = pushes_of_cut(design, slope)
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
    return [(planes, even(faces, mean) if len(slope.joints) > len(JOINTS) else pyramid(faces, mean, apex))]


def _geometry(design: WedgeDesign, shape: Shape) -> WedgeGeometry:
    block, line, origin = shape.block, line_of(shape.line), np.array(design.origin_m)
    areas = {name: block.areas[plane] for plane, name in shape.interfaces.items()}
    faces = {shape.planes[plane]: polygon for plane, polygon in block.faces.items()}
    crest = Crest(shape.corners_m["crest_J1"], design.face.normal(), design.upper.normal())
    return WedgeGeometry(
        block.volume, float(np.ptp(block.corners[:, 2])), areas, line.trend_deg, line.plunge_deg, shape.line_length_m,
        {name: frozen(point + origin) for name, point in shape.corners_m.items()}, frozen(block.centroid + origin),
        {name: frozen(polygon + origin) for name, polygon in faces.items()}, sizes_of_faces(faces, areas, crest),
        size_scale(design),
    )  # fmt: skip


def size_scale(design: WedgeDesign) -> "Mapping[str, Any] | None":
    return None if design.limits is None else limits.scaled(design)
