"""Water and surcharge on single blocks, n at once: one model for every kind, integrated over their faces.

On each face the pressure is linear piece by piece, whatever says it: even (given means), falling from a peak (full
water), falling from the crack in which it stands, or hydrostatic below a table or a pond. PRE-IE gets the resultants
where they act, a closed form the mean pressure of each joint and the sum of the rest as a force: moments are beyond it.

The block of a single run is n = 1.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from slopekit.core.arrays import Bools, Floats, cross
from slopekit.core.errors import Fault, MisfitError
from slopekit.core.orientation import coordinates
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.geometry.polytopes import Polytopes
from slopekit.geometry.pressure import (
    Height,
    Pieces,
    Pressure,
    plane_table,
    resultant,
    table_below_planes,
    table_through_points,
    uniform_pieces,
)
from slopekit.kinds.single_block.closed_forms import MISFITS
from slopekit.kinds.single_block.held_bolts import Bounds, blocks_within
from slopekit.loads import PointForce

_ABOVE = 1e-6  # of the height: a table that lies no more above the ground is on it
_ROUNDING = 1e-9  # of the size of a block, the depth of its crack, the water that would fill it
_TINY = float(np.finfo(np.float64).tiny)  # m²: a face without area
_GIVE_MEANS = "Give the mean pressures: water: {pressures: ...}."

#: Which (n,) blocks a value does not fit, and the fault of the first of them.
Misfit: TypeAlias = tuple[Bools, Fault]


#: Pressures on several faces of the blocks, by the planes of these.
OnFaces: TypeAlias = tuple[Sequence[int], Pieces]
#: Those of full water on the joints and the crack: of a slope and the unit weight of water.
FullWater: TypeAlias = 'Callable[["LocalSlope", Any], list[OnFaces]]'


@dataclass(frozen=True)
class LocalSlope:
    """Blocks in their slopes, n of them, in east, north and up from the toe, and the planes that bound them."""

    bounds: Bounds
    solids: Polytopes

    @property
    def crack(self) -> int | None:
        """The plane of the tension crack, None without any."""
        slope = (*self.bounds.joints, *self.bounds.free)
        return next(
            (plane for plane in range(len(self.bounds.outward)) if plane not in slope), None
        )

    @property
    def interfaces(self) -> list[int]:
        """The planes of rock on rock, the crack last."""
        return [*self.bounds.joints, *(() if self.crack is None else (self.crack,))]

    @cached_property
    def faces(self) -> Floats:
        """The faces on each plane, (p, n, k, 3) m as `Polytopes` has them; without area where a block has none."""
        return self.solids.faces.swapaxes(0, 1)

    @cached_property
    def areas(self) -> Floats:
        """The areas (p, n) of the faces, m²."""
        arms = self.faces - self.faces[:, :, :1]
        turns = cross(arms[:, :, :-1], arms[:, :, 1:]).sum(axis=2)  # Newell
        areas: Floats = np.sqrt((turns * turns).sum(axis=2)) / 2.0
        return areas

    @cached_property
    def extents(self) -> Floats:
        """The extents of each block along the axes, (n, 3) m."""
        corners = self.solids.corners()
        extents: Floats = np.fmax.reduce(corners, axis=1) - np.fmin.reduce(corners, axis=1)
        return extents


def pressure_below(
    design: Design,
    into: Floats,
    level: float,
    at_depth: Callable[[Any], tuple[Height, ...]],
    along: Floats | None = None,
) -> Pressure:
    """Return the water pressure below the table and the pond of a design.

    Parameters
    ----------
    into : (3,) or (n, 3) level unit vector that the places of points count along
    level : elevation of the origin, m
    at_depth : the table so many metres below the ground; along : as of `LocalSlope`
    """
    water, heights = design.water, tuple[Height, ...]()
    if water.table_depth_m is not None:
        heights = at_depth(water.table_depth_m)
    elif water.table_points_m is not None:
        places, levels = zip(*water.table_points_m, strict=True)
        heights = table_through_points(into, places, [elevation - level for elevation in levels])
    elif water.table_plane is not None:
        plane = water.table_plane
        heights = plane_table(plane.plane.normal(), plane.level_m - level, along)
    return Pressure(
        heights,
        None if water.pond_m is None else water.pond_m - level,
        design.water_unit_weight_kn_m3,
    )


def table_above_ground(design: Design, water: Pressure, free: Floats, height: Any) -> list[Misfit]:
    """Return the misfit E456 of a water table above the ground outside a pond.

    A table given by its depth below the ground is never above it.

    Parameters
    ----------
    free : polygons (f, n, k, 3) of the ground of n; height : (n,) or m, of what it is the ground of
    """
    if design.water.table_depth_m is not None:
        return []
    over, place = water.above(free)
    face, row = np.unravel_index(int((over / height).argmax()), over.shape)
    corner = coordinates(place[face, row])
    message = f"the water table lies {over[face, row]:.4g} m above the ground at {corner}"
    advice = "Give a table at or below the ground; open water at the toe is a pond."
    return [((over > _ABOVE * height).any(axis=0), Fault("E456", message, "", advice))]


def raise_misfit(misfits: Sequence[Misfit]) -> None:
    """Raise MisfitError with the first misfit that applies to a block."""
    for blocks, fault in misfits:
        if blocks.any():
            raise MisfitError([fault])


def pushes(
    design: SlopeDesign, slope: LocalSlope, full: FullWater
) -> tuple[dict[str, PointForce], list[Misfit]]:
    """Return the forces of water and surcharge on n blocks by their names in loads: `water 0`, `surcharge`.

    The forces and points of each are (n, 3). Misfits are E207 where the crack is not so deep, E456 where the table lies
    above the ground, or a joint or the crack ends in the rock.
    """
    pressures, misfits = _pressures(design, slope, full)
    loads: dict[str, PointForce] = {}
    least = _ROUNDING * design.water_unit_weight_kn_m3 * slope.extents.prod(axis=1)
    for planes, pieces in pressures:
        forces, points = resultant(pieces, slope.faces[list(planes)])
        for plane, force, point in zip(planes, forces, points, strict=True):
            if (force > least).any():
                loads[f"water {plane}"] = PointForce(
                    -force[:, None] * slope.solids.outward[:, plane], point
                )
    upper = slope.bounds.free[1]
    if np.any(design.surcharge_kpa) and slope.areas[upper : upper + 1].any():
        corners = slope.faces[upper]
        a, b, c = corners[:, :1], corners[:, 1:-1], corners[:, 2:]
        plans = cross(b - a, c - a)[..., 2] / 2.0
        total = plans.sum(axis=1)[:, None]
        middle = (plans[..., None] * (a + b + c)).sum(axis=1) / np.maximum(3.0 * total, _TINY)
        loads["surcharge"] = PointForce(
            np.asarray(design.surcharge_kpa)[..., None] * total * [0.0, 0.0, -1.0], middle
        )
    return loads, misfits


def pushes_on(
    design: SlopeDesign, bounds: Bounds, full: FullWater, axes: Floats
) -> dict[str, PointForce]:
    """Return the `pushes` of one block, each (3,) in local axes; `axes` (3, 3) are rows in east, north, up.

    Raises
    ------
    MisfitError
        The first misfit.
    """
    loads, misfits = pushes(design, LocalSlope(bounds, blocks_within(bounds, 1)), full)
    raise_misfit(misfits)
    return {
        name: PointForce(axes @ load.force[0], axes @ load.point[0])
        for name, load in loads.items()
        if load.point is not None
    }


def _pressures(
    design: SlopeDesign, slope: LocalSlope, full: FullWater
) -> tuple[list[OnFaces], list[Misfit]]:
    """Return the water pressures on the wet faces of the blocks, and the misfits."""
    water, faces, weight = design.water, slope.interfaces, design.water_unit_weight_kn_m3
    if water.has_table:
        return _below_table(design, slope)
    if np.any(water.crack_water_m):
        return standing_in_crack(slope, weight, water.crack_water_m), crack_water_misfits(
            slope, water.crack_water_m
        )
    pressures = list[OnFaces]()
    if water.mode == "pressures":
        faces = faces[: len(water.pressures_kpa)]
        pressures = [
            (faces, uniform_pieces(slope.faces[faces], _stacked(water.pressures_kpa[: len(faces)])))
        ]
    shares = dict.fromkeys(slope.interfaces, water.fill)
    if slope.crack is not None and water.crack_fill is not None:
        shares[slope.crack] = water.crack_fill
    if any(np.any(share) for share in shares.values()):
        for planes, pieces in full(slope, weight):
            filled = _stacked([shares[plane] for plane in planes])[..., None]
            pressures.append((planes, [(corners, filled * peak) for corners, peak in pieces]))
    return pressures, []


def _stacked(numbers: Sequence[Any]) -> Floats:
    """Return numbers of f faces, each a number or (n,), as an array (f, 1) or (f, n)."""
    return np.stack(np.broadcast_arrays(*map(np.atleast_1d, numbers)))


def _below_table(design: SlopeDesign, slope: LocalSlope) -> tuple[list[OnFaces], list[Misfit]]:
    """Return the pressures of a water table on joints and crack, and those of a pond also on the ground."""
    bounds, free = slope.bounds, list(slope.bounds.free)
    normals, offsets = slope.solids.outward[:, free].swapaxes(0, 1), slope.solids.offsets[:, free].T
    outward = normals[0] * [1.0, 1.0, 0.0]
    water = pressure_below(
        design,
        -outward / np.sqrt((outward * outward).sum(axis=1))[:, None],
        float(bounds.origin[2]),
        lambda depth: table_below_planes(normals, offsets, depth),
        bounds.along,
    )
    ground = slope.faces[free]
    pressures: list[OnFaces] = [(slope.interfaces, water.pieces(slope.faces[slope.interfaces]))]
    if water.pond is not None:
        pressures.append((free, replace(water, heights=()).pieces(ground)))
    return pressures, table_above_ground(design, water, ground, slope.extents[:, 2])


# -- water that stands in the tension crack --------------------------------------------------------------------------


def standing_in_crack(slope: LocalSlope, unit_weight: Any, depth: Any = None) -> list[OnFaces]:
    """Return the pressures of water in the tension crack and on the joints below it, as in a plane failure.

    In the crack the pressure is hydrostatic. On a joint it falls from the wet edge that it shares with the crack to
    nothing on its other edges, linearly over the triangles from the lower end of that edge: uplift of a plane failure,
    and of a full crack whose upper edge is level Hoek & Bray's pyramids (mean γ_w h₅/3 on all three; 1981, ch. 8).

    Parameters
    ----------
    unit_weight : of the water, kN/m³; depth : over the lowest point of the crack, m; None for a full one
    """
    if slope.crack is None:
        return []
    lowest, capacity = _crack_capacity(slope, slope.crack)
    level = lowest + (capacity if depth is None else depth)
    crack = [slope.crack]
    on_joints = _joint_pressures_from_crack(slope, slope.crack, level, unit_weight)
    return [
        (slope.bounds.joints, on_joints),
        (crack, Pressure((), level, unit_weight).pieces(slope.faces[crack])),
    ]


def crack_water_misfits(slope: LocalSlope, depth: Any) -> list[Misfit]:
    """Return the misfits of water of a depth (m, a number or (n,)) in the tension crack.

    E207 the crack is not so deep, E456 a joint has a corner inside the rock away from the crack, or the crack has no
    edge on the slope.
    """
    if slope.crack is None:
        return []
    capacity, depth = _crack_capacity(slope, slope.crack)[1], np.asarray(depth)
    too_deep = depth > capacity * (1.0 + _ROUNDING)
    first = int(too_deep.argmax())
    depth_m, most = (
        float(np.broadcast_to(values, too_deep.shape)[first]) for values in (depth, capacity)
    )
    inside = ~_lies_on(slope, list(slope.bounds.joints), *slope.bounds.free, slope.crack).all(
        axis=2
    ).all(axis=0)
    ends = (
        "the crack ends inside the rock, below the slope: how high water stands in it is not told"
    )
    deep = f"the water stands {depth_m:.6g} m deep in a crack of {most:.6g} m"
    meet = "the joints meet inside the rock, away from the crack: how high its water stands there is not told"
    faults = [
        (np.isinf(capacity), Fault("E456", ends, "", _GIVE_MEANS)),
        (
            too_deep,
            Fault(
                "E207",
                deep,
                "",
                f"Give at most {most:.6g} m, its depth where its upper edge is lowest.",
            ),
        ),
        (inside, Fault("E456", meet, "", _GIVE_MEANS)),
    ]
    return [(is_misfit & (depth > 0.0), fault) for is_misfit, fault in faults]


def _crack_capacity(slope: LocalSlope, crack: int) -> tuple[Floats, Floats]:
    """Return the lowest elevation of each crack and the largest depth of water in it, (n,) m; infinite below ground."""
    heights = slope.faces[crack][..., 2]
    lowest, is_ground = heights.min(axis=1), _lies_on(slope, crack, *slope.bounds.free)
    return lowest, np.where(is_ground, heights, np.inf).min(axis=1) - lowest


def _joint_pressures_from_crack(
    slope: LocalSlope, crack: int, level: Floats, unit_weight: Any
) -> Pieces:
    """Return the pressures on the joints of each block; none on a joint whose edge at the crack is dry.

    Parameters
    ----------
    level : (n,) of the water in the crack
    """
    joints = list(slope.bounds.joints)
    polygons, in_crack = slope.faces[joints], _lies_on(slope, joints, crack)
    heads = np.where(in_crack, level[:, None] - polygons[..., 2], 0.0)
    low = np.where(in_crack, heads, -np.inf).argmax(axis=2)[..., None]
    deepest, lowest = (
        np.take_along_axis(heads, low, axis=2),
        np.take_along_axis(polygons, low[..., None], axis=2),
    )
    arms = polygons - lowest
    has_edge = in_crack & (
        (arms * arms).sum(axis=3) > (_ROUNDING * slope.extents.max(axis=1)[:, None]) ** 2
    )
    is_wet = (deepest > 0.0) & has_edge.any(axis=2)[..., None]
    # where the water ends on the edge the joint is dry above it
    is_above = is_wet & (heads < 0.0)
    share = np.where(is_above, deepest / np.where(is_above, deepest - heads, 1.0), 1.0)
    polygons = lowest + share[..., None] * arms
    order = (np.arange(heads.shape[2]) + low) % heads.shape[2]
    pressures = np.where(is_wet, np.maximum(heads, 0.0), 0.0) * np.asarray(unit_weight)[..., None]
    return [
        (
            np.take_along_axis(polygons, order[..., None], axis=2),
            np.take_along_axis(pressures, order, axis=2),
        )
    ]


def _lies_on(slope: LocalSlope, faces: Any, *planes: int) -> Bools:
    """Return whether corners of faces ([f,] n, k) lie on any of some planes."""
    corners, nearest = slope.faces[faces], np.inf
    for plane in planes:
        along = (corners * slope.solids.outward[:, plane, None]).sum(axis=-1)
        nearest = np.minimum(nearest, np.abs(along - slope.solids.offsets[:, plane, None]))
    on_plane: Bools = nearest <= _ROUNDING * slope.extents.max(axis=1)[:, None]
    return on_plane


# -- for closed forms ------------------------------------------------------------------------------------------------


def integrated_loads(
    design: SlopeDesign, bounds: Bounds, full: FullWater
) -> tuple[list[Any], list[Any], Any]:
    """Return water and surcharge as the closed form of n designs takes them, each (n,), or a number of one design.

    Parameters
    ----------
    design : whose numbers may be arrays (n,); bounds : the planes of its blocks

    Returns
    -------
    mean pressures of the joints and the crack, kPa; the sum of all else east, north and up, kN; which of `MISFITS`
    refuses a block, below 0 where none does
    """
    solids = blocks_within(bounds, bounds.offsets.shape[1])
    slope, none = LocalSlope(bounds, solids), PointForce(np.zeros((1, 3)))
    with np.errstate(divide="ignore", invalid="ignore"):
        loads, misfits = pushes(design, slope, full)
    forces = [
        loads.pop(f"water {plane}", none).force for plane in (*slope.bounds.joints, slope.crack)
    ]
    areas = [*slope.areas[slope.interfaces], np.ones(1)]
    means = [
        np.sqrt((force * force).sum(axis=1)) / np.maximum(area, _TINY)
        for force, area in zip(forces, areas, strict=False)
    ]
    rest = sum((load.force for load in loads.values()), none.force)
    is_cut = (solids.counts[:, list(bounds.joints)] > 0).any(axis=1)
    codes = ["E208", *(fault.code for _, fault in misfits)]
    misfit = np.select(
        [~is_cut, *(rows for rows, _ in misfits)], [MISFITS.index(code) for code in codes], -1
    )
    values: list[Any] = [*means, *rest.T, misfit]
    values = [value[0] if len(value) == 1 else value for value in values]
    return values[: len(means)], values[len(means) : -1], values[-1]
