"""Water and surcharge on one block: one model for every kind, read from its design and integrated over its faces.

On each face the pressure is linear piece by piece, whatever says it: even (given means), falling from a peak (full
water), falling from the crack in which it stands, or hydrostatic below a table or a pond. PRE-IE gets the resultants
where they act, a closed form the mean pressure of each joint and the sum of the rest as a force: moments are beyond it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import Fault, MisfitError
from slopekit.core.orientation import coordinates
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.geometry.pressure import Height, Pieces, Pressure, even, in_strips, plane_table, resultant, under_planes
from slopekit.geometry.rock.cutting import Block
from slopekit.kinds.single_block.closed_forms import Arguments
from slopekit.loads import PointForce

_ABOVE = 1e-6  # of the height: a table that lies no more above the ground is on it
_ON = 1e-9  # of the size of the block: a corner this near to a plane lies on it
_BRIM = 1e-9  # of the depth of the crack: water that stands no higher does not run out
_GIVE_MEANS = "Give the mean pressures: water: {pressures: ...}."


@dataclass(frozen=True)
class LocalSlope:
    """The block in its slope, in local axes with the toe at the origin and z up.

    Attributes
    ----------
    joints : faces of rock on rock; crack : the one of the tension crack, which the block need not have
    free : the face and the upper slope, that one last
    normals, offsets : of these two, `normal · x = offset`, outward
    axes : (3, 3) rows are the local axes in east, north, up; into : (3,) level unit vector into the slope
    full : the pressures of full water on joints and crack, by face
    level : elevation of the toe, m; in_section : nothing changes along the slope
    """

    block: Block
    joints: Sequence[int]
    crack: int
    free: tuple[int, int]
    normals: Floats
    offsets: Floats
    axes: Floats
    into: Floats
    full: Callable[["LocalSlope"], Mapping[int, Pieces]]
    level: float = 0.0
    in_section: bool = False

    @property
    def interfaces(self) -> list[int]:
        """The faces of rock on rock that the block has, the crack last."""
        return [face for face in (*self.joints, self.crack) if face in self.block.faces]


def pressure_below(
    design: Design, axes: Floats, into: Floats, level: float, at_depth: Callable[[float], tuple[Height, ...]],
    in_section: bool = False,
) -> Pressure:  # fmt: skip
    """The pressure below the table and the pond of a design.

    Parameters
    ----------
    axes : (3, 3) rows are the local axes in east, north, up; level : elevation of the origin, m
    into : (3,) level unit vector that the places of points count along
    at_depth : the table so many metres below the ground
    """
    water, heights = design.water, tuple[Height, ...]()
    if water.table_depth_m is not None:
        heights = at_depth(water.table_depth_m)
    elif water.table_points_m is not None:
        places, levels = zip(*water.table_points_m, strict=True)
        heights = in_strips(into, places, [one - level for one in levels])
    elif water.table_plane is not None:
        plane = water.table_plane
        heights = plane_table(axes @ plane.plane.normal(), plane.level_m - level, in_section)
    return Pressure(heights, None if water.pond_m is None else water.pond_m - level, design.water_unit_weight_kn_m3)


def refuse_above(water: Pressure, free: Sequence[Floats], size: float, axes: Floats) -> None:
    """E456 where the table stands above the ground and no pond does.

    Parameters
    ----------
    free : polygons (k, 3) of the ground; size : m, of what it is the ground of; axes : as of `pressure_below`
    """
    over, at = max((water.above(polygon) for polygon in free), key=lambda excess: excess[0], default=(0.0, np.zeros(3)))
    if over > _ABOVE * size:
        message = f"the water table lies {over:.4g} m above the ground at {coordinates(at @ axes)}"
        advice = "Give a table at or below the ground; open water at the toe is a pond."
        raise MisfitError([Fault("E456", message, "", advice)])


def pushes(design: SlopeDesign, slope: LocalSlope) -> dict[str, PointForce]:
    """What water and surcharge do to the block, by the names that loads have for them: `water 0`, `surcharge`.

    Raises
    ------
    GeometryError
        E207 the crack is not so deep, E456 the table lies above the ground, or a joint or the crack ends in the rock.
    """
    faces = slope.block.faces
    loads = thrusts(faces, _pressures(design, slope))
    upper = faces.get(slope.free[1])
    if design.surcharge_kpa and upper is not None:
        a, b, c = upper[:1], upper[1:-1], upper[2:]
        plan = cross(b - a, c - a)[:, 2] / 2.0
        at = plan @ (a + b + c) / (3.0 * plan.sum())
        loads["surcharge"] = PointForce(np.array([0.0, 0.0, -design.surcharge_kpa * float(plan.sum())]), at)
    return loads


def thrusts(faces: Mapping[int, Floats], by_face: Mapping[int, Pieces]) -> dict[str, PointForce]:
    """What pressures on faces of a block do to it, by the names that loads have for water: `water 0`."""
    loads: dict[str, PointForce] = {}
    for face, pieces in by_face.items():
        thrust, at = resultant(pieces, faces[face])
        if thrust:
            loads[f"water {face}"] = PointForce(-thrust * outward_normal(faces[face]), at)
    return loads


def _pressures(design: SlopeDesign, slope: LocalSlope) -> Mapping[int, Pieces]:
    """The pressures on the faces of the block that are wet."""
    water, faces = design.water, slope.block.faces
    by_face: Mapping[int, Pieces] = {}
    if water.has_table:
        by_face = _below_table(design, slope)
    elif water.crack_water_m:
        by_face = standing_in_crack(slope, water.crack_water_m, design.water_unit_weight_kn_m3)
    elif water.mode == "pressures":
        given = zip(slope.interfaces, water.pressures_kpa, strict=False)
        by_face = {face: even(faces[face], mean) for face, mean in given}
    elif water.mode == "full":
        by_face = _scaled(slope.full(slope), water.fill)
    if water.crack_fill is not None and slope.crack in faces:
        by_face = {**by_face, **_scaled({slope.crack: slope.full(slope)[slope.crack]}, water.crack_fill)}
    return by_face


def _scaled(full: Mapping[int, Pieces], part: float) -> dict[int, Pieces]:
    return {face: [(polygon, part * pressures) for polygon, pressures in pieces] for face, pieces in full.items()}


def _below_table(design: SlopeDesign, slope: LocalSlope) -> Mapping[int, Pieces]:
    """The pressures of a table on joints and crack, and of a pond on the ground too."""
    faces = slope.block.faces
    water = pressure_below(
        design, slope.axes, slope.into, slope.level,
        lambda depth: under_planes(slope.normals, slope.offsets, depth), slope.in_section,
    )  # fmt: skip
    free = [face for face in slope.free if face in faces]
    refuse_above(water, [faces[face] for face in free], float(np.ptp(slope.block.corners[:, 2])), slope.axes)
    by_face = {face: list(water.pieces(faces[face])) for face in slope.interfaces}
    if water.pond is None:
        return by_face
    outside = Pressure((), water.pond, water.unit_weight)
    return by_face | {face: list(outside.pieces(faces[face])) for face in free}


def standing_in_crack(slope: LocalSlope, depth: float | None, unit_weight: float) -> dict[int, Pieces]:
    """The pressures of water that stands in the tension crack, as a plane failure has it.

    In the crack it is still water. On a joint the pressure falls from the wet edge that it shares with the crack to
    nothing on its other edges, linearly over the triangles from the lower end of that edge: uplift of a plane failure,
    and of a full crack whose upper edge is level Hoek & Bray's pyramids (mean γ_w h₅/3 on all three; 1981, ch. 8).

    Parameters
    ----------
    depth : over the lowest point of the crack, m; None for a full one; unit_weight : of the water, kN/m³

    Raises
    ------
    GeometryError
        E207 the crack is not so deep, E456 a joint has a corner inside the rock away from the crack, or the crack has
        no edge on the slope.
    """
    faces = slope.block.faces
    if slope.crack not in faces:
        return {}
    polygon, size = faces[slope.crack], float(np.ptp(slope.block.corners, axis=0).max())
    ground = [faces[face] for face in slope.free if face in faces]
    at_ground = np.array([any(_lies_on(face, corner, size) for face in ground) for corner in polygon])
    if not at_ground.any():
        message = "the crack ends inside the rock, below the slope: how high water stands in it is not told"
        raise MisfitError([Fault("E456", message, "", _GIVE_MEANS)])
    lowest = float(polygon[:, 2].min())
    holds = float(polygon[at_ground, 2].min()) - lowest
    if depth is not None and depth > holds * (1.0 + _BRIM):
        message = f"the water stands {depth:.6g} m deep in a crack of {holds:.6g} m"
        raise MisfitError([Fault("E207", message, "", "Give at most its depth where its upper edge is lowest.")])
    level = lowest + (holds if depth is None else depth)
    by_face = {joint: _from_crack(slope, joint, level, unit_weight, [*ground, polygon], size) for joint in slope.joints}
    return by_face | {slope.crack: list(Pressure((), level, unit_weight).pieces(polygon))}


def _from_crack(
    slope: LocalSlope, joint: int, level: float, unit_weight: float, known: Sequence[Floats], size: float
) -> Pieces:
    """The pressures on one joint; none where its edge at the crack is dry.

    Parameters
    ----------
    level : of the water in the crack; known : faces on which the pressure is known, the crack last
    """
    polygon = slope.block.faces[joint]
    at_crack = np.array([_lies_on(known[-1], corner, size) for corner in polygon])
    if not all(any(_lies_on(face, corner, size) for face in known) for corner in polygon):
        message = "the joints meet inside the rock, away from the crack: how high its water stands there is not told"
        raise MisfitError([Fault("E456", message, "", _GIVE_MEANS)])
    heads = np.where(at_crack, level - polygon[:, 2], 0.0)
    if at_crack.sum() != 2 or float(heads.max()) <= 0.0:
        return []
    low, high = sorted(np.flatnonzero(at_crack).tolist(), key=lambda k: float(polygon[k, 2]))
    if heads[high] < 0.0:  # the water ends on the edge: above it the joint is dry
        share = heads[low] / (heads[low] - heads[high])
        polygon, heads = polygon.copy(), heads.copy()
        polygon[high], heads[high] = polygon[low] + share * (polygon[high] - polygon[low]), 0.0
    return [(np.roll(polygon, -low, axis=0), unit_weight * np.roll(heads, -low))]


def _lies_on(polygon: Floats, corner: Floats, size: float) -> bool:
    """Whether a point lies on the plane of a face of the block."""
    return abs(float((corner - polygon[0]) @ outward_normal(polygon))) <= _ON * size


def outward_normal(polygon: Floats) -> Floats:
    """The unit normal of a face anticlockwise from outside (Newell)."""
    whole = cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(axis=0)
    unit: Floats = whole / np.sqrt(float(whole @ whole))
    return unit


def for_closed_form(design: SlopeDesign, slope: LocalSlope, force: Arguments) -> tuple[list[float | None], Arguments]:
    """Mean pressures of the joints and the crack (kPa), and the force (east, north, up) with the sum of all else."""
    loads = pushes(design, slope)
    faces = (*slope.joints, slope.crack)
    on_joints = {face: loads.pop(f"water {face}") for face in faces if f"water {face}" in loads}
    means: list[float | None] = [
        float(np.linalg.norm(on_joints[face].force)) / slope.block.areas[face] if face in on_joints else 0.0
        for face in faces
    ]
    rest = np.sum([np.zeros(3), *(push.force for push in loads.values())], axis=0) @ slope.axes
    if not rest.any():
        return means, force
    return means, {name: (value or 0.0) + float(more) for (name, value), more in zip(force.items(), rest, strict=True)}
