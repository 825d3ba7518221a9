"""Water and surcharge on single blocks, n at once: one model for every kind, integrated over their faces.

On each face the pressure is linear piece by piece, whatever says it: even (given means), falling from a peak (full
water), falling from the crack in which it stands, or hydrostatic below a table or a pond. PRE-IE gets the resultants
where they act, a closed form the mean pressure of each joint and the sum of the rest as a force: moments are beyond it.

The block of a single run is n = 1.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from slopekit.core.arrays import Bools, Floats, cross
from slopekit.core.errors import Fault, MisfitError
from slopekit.core.orientation import coordinates
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.geometry.pressure import Height, Pieces, Pressure, even, in_strips, plane_table, resultant, under_planes
from slopekit.geometry.rock.cutting import Block
from slopekit.loads import PointForce

_ABOVE = 1e-6  # of the height: a table that lies no more above the ground is on it
_ON = 1e-9  # of the size of the block: a corner this near to a plane lies on it
_TINY = float(np.finfo(np.float64).tiny)  # m²: a face without area
_BRIM = 1e-9  # of the depth of the crack: water that stands no higher does not run out
_GIVE_MEANS = "Give the mean pressures: water: {pressures: ...}."

#: Which (n,) blocks a value does not fit, and the fault of the first of them.
Misfit: TypeAlias = tuple[Bools, Fault]


#: The pressures of full water on the joints and the crack, by face: of a slope and the unit weight of water.
FullWater: TypeAlias = 'Callable[["LocalSlope", Any], Mapping[int, Pieces]]'


@dataclass(frozen=True)
class LocalSlope:
    """Blocks in their slopes, n of them, in local axes with the toe at the origin and z up.

    Attributes
    ----------
    faces : (n, k, 3) m by plane, anticlockwise from outside, the first corner again where there are fewer than k
    corners : (n, m, 3) m of the blocks, nan where there are fewer
    joints : faces of rock on rock; crack : the one of the tension crack, which blocks need not have
    free : the face and the upper slope, that one last
    normals, offsets : of these two, (2, n, 3) and (2, n), `normal · x = offset`, outward
    into : (n, 3) level unit vectors into the slope; along : (n, 3) along it where nothing changes that way, else None
    full : of the kind; axes : (3, 3) rows are the local axes in east, north, up
    level : elevation of the toe, m
    """

    faces: Mapping[int, Floats]
    corners: Floats
    joints: Sequence[int]
    crack: int
    free: tuple[int, int]
    normals: Floats
    offsets: Floats
    into: Floats
    along: Floats | None
    full: "FullWater"
    axes: Floats
    level: float

    @classmethod
    def of_cut(
        cls, block: Block, joints: Sequence[int], crack: int, free: tuple[int, int], normals: Floats, offsets: Floats,
        *others: Any,
    ) -> "LocalSlope":  # fmt: skip
        """One block that was cut; the others as the attributes follow."""
        faces = {face: polygon[None] for face, polygon in block.faces.items()}
        return cls(faces, block.corners[None], joints, crack, free, normals[:, None], offsets[:, None], *others)

    @property
    def interfaces(self) -> list[int]:
        """The faces of rock on rock that the blocks have, the crack last."""
        return [face for face in (*self.joints, self.crack) if face in self.faces]

    @property
    def ground(self) -> list[int]:
        """The free faces that the blocks have."""
        return [face for face in self.free if face in self.faces]

    @cached_property
    def outward(self) -> Mapping[int, Floats]:
        """The outward unit normals (n, 3) of the faces; nothing of a face without area."""
        return {face: outward_normals(polygons)[0] for face, polygons in self.faces.items()}

    @cached_property
    def extents(self) -> Floats:
        """Of each block along the axes, (n, 3) m."""
        extents: Floats = np.fmax.reduce(self.corners, axis=1) - np.fmin.reduce(self.corners, axis=1)
        return extents


def outward_normals(polygons: Floats) -> tuple[Floats, Floats]:
    """The unit normals (n, 3) and areas (n,) of flat polygons (n, k, 3) anticlockwise from outside (Newell)."""
    arms = polygons - polygons[:, :1]
    turns: Floats = cross(arms[:, :-1], arms[:, 1:]).sum(axis=1)
    sizes = np.sqrt((turns * turns).sum(axis=1))
    return turns / np.maximum(sizes, _TINY)[:, None], sizes / 2.0


def pressure_below(
    design: Design, axes: Floats, into: Floats, level: float, at_depth: Callable[[Any], tuple[Height, ...]],
    along: Floats | None = None,
) -> Pressure:  # fmt: skip
    """The pressure below the table and the pond of a design.

    Parameters
    ----------
    axes : (3, 3) rows are the local axes in east, north, up; level : elevation of the origin, m
    into : (3,) or (n, 3) level unit vector that the places of points count along
    at_depth : the table so many metres below the ground; along : as of `LocalSlope`
    """
    water, heights = design.water, tuple[Height, ...]()
    if water.table_depth_m is not None:
        heights = at_depth(water.table_depth_m)
    elif water.table_points_m is not None:
        places, levels = zip(*water.table_points_m, strict=True)
        heights = in_strips(into, places, [one - level for one in levels])
    elif water.table_plane is not None:
        plane = water.table_plane
        heights = plane_table(axes @ plane.plane.normal(), plane.level_m - level, along)
    return Pressure(heights, None if water.pond_m is None else water.pond_m - level, design.water_unit_weight_kn_m3)


def above_ground(water: Pressure, free: Sequence[Floats], size: Any, axes: Floats) -> list[Misfit]:
    """E456 where the table stands above the ground and no pond does.

    Parameters
    ----------
    free : polygons (n, k, 3) of the ground; size : (n,) or m, of what it is the ground of
    axes : as of `pressure_below`
    """
    over, at = (np.stack(own) for own in zip(*map(water.above, free), strict=True))
    face, row = np.unravel_index(int((over / size).argmax()), over.shape)
    message = f"the water table lies {over[face, row]:.4g} m above the ground at {coordinates(at[face, row] @ axes)}"
    advice = "Give a table at or below the ground; open water at the toe is a pond."
    return [((over > _ABOVE * size).any(axis=0), Fault("E456", message, "", advice))]


def refuse(misfits: Sequence[Misfit]) -> None:
    """MisfitError with the first that is one."""
    for where, fault in misfits:
        if where.any():
            raise MisfitError([fault])


def pushes(design: SlopeDesign, slope: LocalSlope) -> tuple[dict[str, PointForce], list[Misfit]]:
    """What water and surcharge do to n blocks, by the names that loads have for them: `water 0`, `surcharge`.

    The forces and points of each are (n, 3). Misfits are E207 where the crack is not so deep, E456 where the table lies
    above the ground, or a joint or the crack ends in the rock.
    """
    by_face, misfits = _pressures(design, slope)
    loads, upper = thrusts(slope.faces, by_face), slope.faces.get(slope.free[1])
    if upper is not None and np.any(design.surcharge_kpa):
        a, b, c = upper[:, :1], upper[:, 1:-1], upper[:, 2:]
        plan = cross(b - a, c - a)[..., 2] / 2.0
        whole = plan.sum(axis=1)[:, None]
        at = (plan[..., None] * (a + b + c)).sum(axis=1) / np.maximum(3.0 * whole, _TINY)
        loads["surcharge"] = PointForce(np.asarray(design.surcharge_kpa)[..., None] * whole * [0.0, 0.0, -1.0], at)
    return loads, misfits


def pushes_of_cut(design: SlopeDesign, slope: LocalSlope) -> dict[str, PointForce]:
    """`pushes` of one block, each (3,).

    Raises
    ------
    MisfitError
        The first misfit.
    """
    loads, misfits = pushes(design, slope)
    refuse(misfits)
    return of_one(loads)


def of_one(loads: Mapping[str, PointForce]) -> dict[str, PointForce]:
    """The loads (1, 3) on one block, each (3,)."""
    return {name: PointForce(push.force[0], None if push.at is None else push.at[0]) for name, push in loads.items()}


def thrusts(faces: Mapping[int, Floats], by_face: Mapping[int, Pieces]) -> dict[str, PointForce]:
    """What pressures on faces of n blocks do to them, by the names that loads have for water: `water 0`."""
    loads: dict[str, PointForce] = {}
    for face, pieces in by_face.items():
        thrust, at = resultant(pieces, faces[face])
        if thrust.any():
            loads[f"water {face}"] = PointForce(-thrust[:, None] * outward_normals(faces[face])[0], at)
    return loads


def _pressures(design: SlopeDesign, slope: LocalSlope) -> tuple[Mapping[int, Pieces], list[Misfit]]:
    """The pressures on the faces of the blocks that are wet."""
    water, faces, weight = design.water, slope.faces, design.water_unit_weight_kn_m3
    by_face: Mapping[int, Pieces] = {}
    misfits = list[Misfit]()
    if water.has_table:
        by_face, misfits = _below_table(design, slope)
    elif np.any(water.crack_water_m):
        by_face = standing_in_crack(slope, weight, water.crack_water_m)
        misfits = beyond_crack(slope, water.crack_water_m)
    elif water.mode == "pressures":
        given = zip(slope.interfaces, water.pressures_kpa, strict=False)
        by_face = {face: even(faces[face], mean) for face, mean in given}
    elif np.any(water.fill):
        by_face = _scaled(slope.full(slope, weight), water.fill)
    if water.crack_fill is not None and slope.crack in faces:
        by_face = {**by_face, **_scaled({slope.crack: slope.full(slope, weight)[slope.crack]}, water.crack_fill)}
    return by_face, misfits


def _scaled(full: Mapping[int, Pieces], part: Any) -> dict[int, Pieces]:
    share = np.asarray(part)[..., None]
    return {face: [(polygon, share * pressures) for polygon, pressures in pieces] for face, pieces in full.items()}


def _below_table(design: SlopeDesign, slope: LocalSlope) -> tuple[Mapping[int, Pieces], list[Misfit]]:
    """The pressures of a table on joints and crack, and of a pond on the ground too."""
    faces = slope.faces
    water = pressure_below(
        design, slope.axes, slope.into, slope.level,
        lambda depth: under_planes(slope.normals, slope.offsets, depth), slope.along,
    )  # fmt: skip
    by_face: dict[int, Pieces] = {face: list(water.pieces(faces[face])) for face in slope.interfaces}
    if water.pond is not None:
        outside = replace(water, heights=())
        by_face |= {face: list(outside.pieces(faces[face])) for face in slope.ground}
    return by_face, above_ground(water, [faces[face] for face in slope.ground], slope.extents[:, 2], slope.axes)


# -- water that stands in the tension crack --------------------------------------------------------------------------


def standing_in_crack(slope: LocalSlope, unit_weight: Any, depth: Any = None) -> dict[int, Pieces]:
    """The pressures of water that stands in the tension crack, as a plane failure has it.

    In the crack it is still water. On a joint the pressure falls from the wet edge that it shares with the crack to
    nothing on its other edges, linearly over the triangles from the lower end of that edge: uplift of a plane failure,
    and of a full crack whose upper edge is level Hoek & Bray's pyramids (mean γ_w h₅/3 on all three; 1981, ch. 8).

    Parameters
    ----------
    unit_weight : of the water, kN/m³; depth : over the lowest point of the crack, m; None for a full one
    """
    if slope.crack not in slope.faces:
        return {}
    lowest, holds = _brim(slope)
    level = lowest + (holds if depth is None else depth)
    by_face = {joint: _from_crack(slope, joint, level, unit_weight) for joint in slope.joints}
    return by_face | {slope.crack: list(Pressure((), level, unit_weight).pieces(slope.faces[slope.crack]))}


def beyond_crack(slope: LocalSlope, depth: Any) -> list[Misfit]:
    """What does not fit water of a depth (m, a number or (n,)) in the tension crack.

    E207 the crack is not so deep, E456 a joint has a corner inside the rock away from the crack, or the crack has no
    edge on the slope.
    """
    if slope.crack not in slope.faces:
        return []
    holds, depth = _brim(slope)[1], np.asarray(depth)
    too_deep = depth > holds * (1.0 + _BRIM)
    first = int(too_deep.argmax())
    own, most = (float(np.broadcast_to(values, too_deep.shape)[first]) for values in (depth, holds))
    known = (*slope.free, slope.crack)
    inside = np.stack([~_lies_on(slope, joint, *known).all(axis=1) for joint in slope.joints]).any(axis=0)
    ends = "the crack ends inside the rock, below the slope: how high water stands in it is not told"
    deep = f"the water stands {own:.6g} m deep in a crack of {most:.6g} m"
    meet = "the joints meet inside the rock, away from the crack: how high its water stands there is not told"
    faults = [
        (np.isinf(holds), Fault("E456", ends, "", _GIVE_MEANS)),
        (too_deep, Fault("E207", deep, "", "Give at most its depth where its upper edge is lowest.")),
        (inside, Fault("E456", meet, "", _GIVE_MEANS)),
    ]
    return [(where & (depth > 0.0), fault) for where, fault in faults]


def _brim(slope: LocalSlope) -> tuple[Floats, Floats]:
    """The lowest elevation of each crack, and how deep water can stand in it: (n,) m, infinite below the slope."""
    heights = slope.faces[slope.crack][..., 2]
    lowest, at_ground = heights.min(axis=1), _lies_on(slope, slope.crack, *slope.free)
    return lowest, np.where(at_ground, heights, np.inf).min(axis=1) - lowest


def _from_crack(slope: LocalSlope, joint: int, level: Floats, unit_weight: Any) -> Pieces:
    """The pressures on a joint of each block; none where its edge at the crack is dry.

    Parameters
    ----------
    level : (n,) of the water in the crack
    """
    polygons = slope.faces[joint]
    at_crack = _lies_on(slope, joint, slope.crack)
    heads = np.where(at_crack, level[:, None] - polygons[..., 2], 0.0)
    rows = np.arange(len(heads))[:, None]
    low = np.where(at_crack, heads, -np.inf).argmax(axis=1)[:, None]
    deepest, arms = heads[rows, low], polygons - polygons[rows, low]
    has_edge = at_crack & ((arms * arms).sum(axis=2) > (_ON * slope.extents.max(axis=1)[:, None]) ** 2)
    is_wet = (deepest > 0.0) & has_edge.any(axis=1)[:, None]
    # where the water ends on the edge the joint is dry above it
    is_above = is_wet & (heads < 0.0)
    share = np.where(is_above, deepest / np.where(is_above, deepest - heads, 1.0), 1.0)
    polygons = polygons[rows, low] + share[..., None] * arms
    around = (np.arange(heads.shape[1]) + low) % heads.shape[1]
    pressures = np.where(is_wet, np.maximum(heads, 0.0), 0.0) * np.asarray(unit_weight)[..., None]
    return [(polygons[rows, around], pressures[rows, around])]


def _lies_on(slope: LocalSlope, face: int, *planes: int) -> Bools:
    """Whether corners of a face (n, k) lie on one of some planes."""
    corners, on = slope.faces[face], np.zeros(slope.faces[face].shape[:2], dtype=bool)
    for plane in planes:
        if plane in slope.free:
            normal, offset = (own[slope.free.index(plane)] for own in (slope.normals, slope.offsets))
        else:
            normal = slope.outward[plane]
            offset = (normal * slope.faces[plane][:, 0]).sum(axis=1)
        on |= (
            np.abs((corners * normal[..., None, :]).sum(axis=2) - offset[..., None])
            <= _ON * slope.extents.max(axis=1)[:, None]
        )
    return on


def means_and_rest(design: SlopeDesign, slope: LocalSlope) -> tuple[list[Any], Floats, list[Misfit]]:
    """Of n blocks the mean pressures of the joints and the crack (kPa), and the sum of all else (n, 3), kN."""
    loads, misfits = pushes(design, slope)
    means: list[Any] = []
    for face in (*slope.joints, slope.crack):
        push = loads.pop(f"water {face}", None)
        force = np.zeros((1, 3)) if push is None else push.force
        area = np.maximum(outward_normals(slope.faces[face])[1], _TINY) if push is not None else 1.0
        means.append(np.sqrt((force * force).sum(axis=1)) / area)
    rest = sum((push.force for push in loads.values()), np.zeros((1, 3))) @ slope.axes
    return means, rest, misfits
