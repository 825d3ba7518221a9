"""A water table, a pond and a surcharge on a block in a slope: pushes for PRE-IE, means and forces for closed forms.

Both get the same pressures, integrated over the faces of the block: PRE-IE the resultants where they act, a closed form
the mean pressure of each joint and the sum of the rest as a force. Moments are beyond it, as always.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import Fault, GeometryError, Notice
from slopekit.core.orientation import number
from slopekit.core.records import dataclass
from slopekit.design.ground_water import TABLE, SlopeDesign
from slopekit.geometry.cutting import Block
from slopekit.geometry.pressure import Height, Pressure, in_strips, under_planes
from slopekit.kinds.closed_forms import Arguments
from slopekit.loads import PointForce

_ABOVE = 1e-6  # of the height: a table that lies no more above the ground is on it


@dataclass(frozen=True, slots=True)
class Ground:
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


def pressure_of(design: SlopeDesign, ground: Ground) -> Pressure | None:
    """The water of a design; None without a table or a pond.

    Raises
    ------
    GeometryError
        E456 the table lies above the ground.
    """
    if design.water.mode != TABLE:
        return None
    pond = None if design.pond_m is None else design.pond_m - ground.level
    found = Pressure(_table(design, ground), pond, design.water_unit_weight_kn_m3)
    _refuse_above(found, ground)
    return found


def _table(design: SlopeDesign, ground: Ground) -> tuple[Height, ...]:
    if design.table_depth_m is not None:
        return under_planes(ground.normals, ground.offsets, design.table_depth_m)
    if design.table_points_m is not None:
        places, levels = zip(*design.table_points_m, strict=True)
        return in_strips(ground.into, places, [level - ground.level for level in levels])
    if design.table_plane is not None:
        x, y, z = ground.axes @ design.table_plane.plane.normal()
        slope = np.array([-x / z, 0.0 if ground.in_section else -y / z, 0.0])
        return (Height(slope, design.table_plane.level_m - ground.level),)
    return ()


def _refuse_above(water: Pressure, ground: Ground) -> None:
    """E456 where the table stands above the ground over the block and no pond does."""
    corners = np.concatenate([ground.block.faces[face] for face in ground.free if face in ground.block.faces])
    size = float(np.ptp(ground.block.corners[:, 2]))
    for height in water.heights:
        within = np.ones(len(corners), dtype=bool)
        for normal, offset, _ in height.borders:
            within &= corners @ normal - offset <= _ABOVE * size
        over = np.where(within, height.at(corners) - corners[:, 2], 0.0)
        if water.pond is not None:
            over = np.where(corners[:, 2] < water.pond, 0.0, over)
        worst = int(over.argmax())
        if over[worst] > _ABOVE * size:
            x, y, z = corners[worst] @ ground.axes
            message = f"the water table lies {over[worst]:.4g} m above the ground at ({x:.4g}, {y:.4g}, {z:.4g})"
            advice = "Give a table at or below the ground; open water at the toe is a pond."
            raise GeometryError([Fault("E456", message, "", advice)])


def pushes(design: SlopeDesign, ground: Ground) -> dict[str, PointForce]:
    """What water and surcharge do to the block, by the names that loads have for them: `water 0`, `surcharge`."""
    found: dict[str, PointForce] = {}
    water = pressure_of(design, ground)
    if water is not None:
        outside = Pressure((), water.pond, water.unit_weight)
        for face in (*ground.joints, *ground.free):
            if face in ground.block.faces and (face in ground.joints or water.pond is not None):
                polygon = ground.block.faces[face]
                thrust, at = (water if face in ground.joints else outside).on(polygon)
                if thrust:
                    found[f"water {face}"] = PointForce(-thrust * _outward(polygon), at)
    upper = ground.block.faces.get(ground.free[1])
    if design.surcharge_kpa and upper is not None:
        a, b, c = upper[:1], upper[1:-1], upper[2:]
        plan = cross(b - a, c - a)[:, 2] / 2.0
        at = plan @ (a + b + c) / (3.0 * plan.sum())
        found["surcharge"] = PointForce(np.array([0.0, 0.0, -design.surcharge_kpa * float(plan.sum())]), at)
    return found


def _outward(polygon: Floats) -> Floats:
    """The unit normal of a face anticlockwise from outside (Newell)."""
    whole = cross(polygon - polygon[0], np.roll(polygon, -1, axis=0) - polygon[0]).sum(axis=0)
    unit: Floats = whole / np.sqrt(float(whole @ whole))
    return unit


def for_closed_form(design: SlopeDesign, ground: Ground) -> tuple[Mapping[int, float], Floats]:
    """Mean pressures of the joints (kPa) by face, and the sum of all else in east, north, up (kN)."""
    found = pushes(design, ground)
    means = {
        face: float(np.linalg.norm(found[f"water {face}"].force)) / ground.block.areas[face]
        if f"water {face}" in found else 0.0
        for face in ground.joints if face in ground.block.faces
    }  # fmt: skip
    rest = [push.force for name, push in found.items() if name not in {f"water {face}" for face in ground.joints}]
    return means, np.sum([np.zeros(3), *rest], axis=0) @ ground.axes


def in_words(design: SlopeDesign) -> list[str]:
    """Water table, pond and surcharge as the sheet prints them."""
    said = []
    if design.water.mode == TABLE:
        if design.table_depth_m is not None:
            said.append(f"water table {number(design.table_depth_m)} m below the ground")
        elif design.table_points_m is not None:
            first, last = design.table_points_m[0], design.table_points_m[-1]
            said.append(
                f"water table through {len(design.table_points_m)} points, from {number(first[1])} m at "
                f"{number(first[0])} m to {number(last[1])} m at {number(last[0])} m into the slope"
            )
        elif design.table_plane is not None:
            said.append(f"water table {design.table_plane.plane}, {number(design.table_plane.level_m)} m at the toe")
        if design.pond_m is not None:
            said.append(f"pond to {number(design.pond_m)} m")
    if design.surcharge_kpa:
        said.append(f"surcharge {number(design.surcharge_kpa)} kPa on the plan of the upper slope")
    return said


def notices(design: SlopeDesign, toe_m: float, crest_m: float) -> Iterator[Notice]:
    """What a reader must know of the pond, by the elevations of toe and crest."""
    if design.water.mode != TABLE or design.pond_m is None:
        return
    if design.pond_m <= toe_m:
        yield Notice("W419", f"the pond stands at {number(design.pond_m)} m, at or below the toe: it wets nothing")
    elif design.pond_m > crest_m:
        over = number(round(design.pond_m - crest_m, 6))
        yield Notice("W420", f"the pond stands {over} m above the crest: is that a reservoir?")


def ponded(design: SlopeDesign, face: int, upper: int) -> dict[int, str]:
    """The free faces that a pond presses on, by name."""
    wet = design.water.mode == TABLE and design.pond_m is not None
    return {face: "face", upper: "upper slope"} if wet else {}


def added(force: Arguments, rest: Floats) -> Arguments:
    """The force of a closed form, east, north and up, with what is added."""
    if not rest.any():
        return force
    return {name: (value or 0.0) + float(more) for (name, value), more in zip(force.items(), rest, strict=True)}
