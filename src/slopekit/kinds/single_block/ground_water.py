"""A water table, a pond and a surcharge on a block in a slope: pushes for PRE-IE, means and forces for closed forms.

Both get the same pressures, integrated over the faces of the block: PRE-IE the resultants where they act, a closed form
the mean pressure of each joint and the sum of the rest as a force. Moments are beyond it, as always.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import Fault, MisfitError
from slopekit.core.orientation import coordinates
from slopekit.core.records import dataclass
from slopekit.design.ground_water import TABLE, GroundWater, SlopeDesign
from slopekit.geometry.pressure import Height, Pressure, in_strips, plane_table, under_planes
from slopekit.geometry.rock.cutting import Block
from slopekit.kinds.single_block.closed_forms import Arguments
from slopekit.loads import PointForce

_ABOVE = 1e-6  # of the height: a table that lies no more above the ground is on it


@dataclass(frozen=True, slots=True)
class LocalSlope:
    """The block in its slope, in local axes with the toe at the origin and z up.

    Attributes
    ----------
    joints : faces of rock on rock, the crack among them; free : the face and the upper slope, that one last
    normals, offsets : of these two, `normal · x = offset`, outward
    axes : (3, 3) rows are the local axes in east, north, up; into : (3,) level unit vector into the slope
    level : elevation of the toe, m; in_section : nothing changes along the slope
    """

    block: Block
    joints: Sequence[int]
    free: tuple[int, int]
    normals: Floats
    offsets: Floats
    axes: Floats
    into: Floats
    level: float = 0.0
    in_section: bool = False


def pressure_of(design: SlopeDesign, ground: LocalSlope) -> Pressure | None:
    """The water of a design; None without a table or a pond.

    Raises
    ------
    GeometryError
        E456 the table lies above the ground.
    """
    if design.water.mode != TABLE:
        return None
    heights = heights_of(design, ground.axes, ground.into, ground.level, ground.in_section)
    if design.table_depth_m is not None:
        heights = under_planes(ground.normals, ground.offsets, design.table_depth_m)
    water = pressure(design, heights, ground.level)
    free = [ground.block.faces[face] for face in ground.free if face in ground.block.faces]
    refuse_above(water, free, float(np.ptp(ground.block.corners[:, 2])), ground.axes)
    return water


def pressure(design: GroundWater, heights: tuple[Height, ...], level: float) -> Pressure:
    """The pressure below a table, and a design's pond; `level`: elevation of the origin, m."""
    return Pressure(heights, None if design.pond_m is None else design.pond_m - level, design.water_unit_weight_kn_m3)


def heights_of(
    design: GroundWater, axes: Floats, into: Floats, level: float, in_section: bool = False
) -> tuple[Height, ...]:
    """A table through points or one that is a plane, in local axes.

    Parameters
    ----------
    axes : (3, 3) rows are the local axes in east, north, up; level : elevation of the origin, m
    into : (3,) level unit vector that the places of points count along
    """
    if design.table_points_m is not None:
        places, levels = zip(*design.table_points_m, strict=True)
        return in_strips(into, places, [one - level for one in levels])
    if design.table_plane is not None:
        return plane_table(axes @ design.table_plane.plane.normal(), design.table_plane.level_m - level, in_section)
    return ()


def refuse_above(water: Pressure, free: Sequence[Floats], size: float, axes: Floats) -> None:
    """E456 where the table stands above the ground and no pond does.

    Parameters
    ----------
    free : polygons (k, 3) of the ground; size : m, of what it is the ground of; axes : as of `heights_of`
    """
    over, at = max((water.above(polygon) for polygon in free), key=lambda excess: excess[0], default=(0.0, np.zeros(3)))
    if over > _ABOVE * size:
        message = f"the water table lies {over:.4g} m above the ground at {coordinates(at @ axes)}"
        advice = "Give a table at or below the ground; open water at the toe is a pond."
        raise MisfitError([Fault("E456", message, "", advice)])


def pushes(
    design: SlopeDesign, ground: LocalSlope, in_crack: Mapping[str, PointForce] | None = None
) -> dict[str, PointForce]:
    """What water and surcharge do to the block, by the names that loads have for them: `water 0`, `surcharge`.

    `in_crack`: what water in the crack alone does, in place of a table.
    """
    loads: dict[str, PointForce] = dict(in_crack or {})
    water = pressure_of(design, ground)
    if water is not None:
        outside = Pressure((), water.pond, water.unit_weight)
        for face in (*ground.joints, *ground.free):
            if face in ground.block.faces and (face in ground.joints or water.pond is not None):
                polygon = ground.block.faces[face]
                thrust, at = (water if face in ground.joints else outside).on(polygon)
                if thrust:
                    loads[f"water {face}"] = PointForce(-thrust * outward_of(polygon), at)
    upper = ground.block.faces.get(ground.free[1])
    if design.surcharge_kpa and upper is not None:
        a, b, c = upper[:1], upper[1:-1], upper[2:]
        plan = cross(b - a, c - a)[:, 2] / 2.0
        at = plan @ (a + b + c) / (3.0 * plan.sum())
        loads["surcharge"] = PointForce(np.array([0.0, 0.0, -design.surcharge_kpa * float(plan.sum())]), at)
    return loads


def outward_of(polygon: Floats) -> Floats:
    """The unit normal of a face anticlockwise from outside (Newell)."""
    whole = cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(axis=0)
    unit: Floats = whole / np.sqrt(float(whole @ whole))
    return unit


def for_closed_form(
    design: SlopeDesign, ground: LocalSlope, in_crack: Mapping[str, PointForce] | None = None
) -> tuple[Mapping[int, float], Floats]:
    """Mean pressures of the joints (kPa) by face, and the sum of all else in east, north, up (kN)."""
    loads = pushes(design, ground, in_crack)
    means = {
        face: float(np.linalg.norm(loads[f"water {face}"].force)) / ground.block.areas[face]
        if f"water {face}" in loads else 0.0
        for face in ground.joints if face in ground.block.faces
    }  # fmt: skip
    rest = [push.force for name, push in loads.items() if name not in {f"water {face}" for face in ground.joints}]
    return means, np.sum([np.zeros(3), *rest], axis=0) @ ground.axes


def added(force: Arguments, rest: Floats) -> Arguments:
    """The force of a closed form, east, north and up, with what is added."""
    if not rest.any():
        return force
    return {name: (value or 0.0) + float(more) for (name, value), more in zip(force.items(), rest, strict=True)}
