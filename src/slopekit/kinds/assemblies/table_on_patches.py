"""A water table, a pond and surcharges on many blocks: on each contact and on the free faces of the blocks.

Free faces need no outlines of their own: they are the whole surface of a block less its contacts. The pond presses on
the whole of a closed surface with γ_w times what lies under water, upward.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross, frozen
from slopekit.core.errors import Fault, MisfitError, Notice
from slopekit.core.orientation import number
from slopekit.geometry.patches import Assembly
from slopekit.geometry.pressure import Pressure, table_below_planes
from slopekit.geometry.rock.bench import ConvexBody
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign, NamedDesign
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene, with_pushes
from slopekit.kinds.water import pressure_below, raise_misfit, table_above_ground
from slopekit.loads import BlockLoad, PointForce

_ROUNDING = 1e-9  # of the water that a block displaces: a push of that size is rounding
_IN_PLANE = 1e-6  # of the size of a block: its faces nearer than that lie in the upper slope
_OPEN_WATER_SHARE = (
    1e-2  # of the water that a block displaces: what presses by less is a table drawn along a face
)
_SLOPING = 1e-9  # of an area: a smaller plan is that of an upright face


def with_water(
    design: AssemblyDesign, scene: AssemblyScene, into: Floats, outside: ConvexBody | None = None
) -> AssemblyScene:
    """Return the scene with the water of a table and a pond on its contacts and free faces, where the design has them.

    Parameters
    ----------
    into : (3,) level unit vector that the distances of points count along, from the origin
    outside : the rock that the blocks were cut from, its face and upper slope first; None: all that is known of the
        ground is that the highest block bears no water

    Raises
    ------
    GeometryError
        E456 the table lies above the ground.
    """
    if not design.water.has_table:
        return scene
    level, assembly = float(scene.origin[2]), scene.assembly
    water = pressure_below(
        design,
        into,
        level,
        lambda depth: (
            ()
            if outside is None
            else table_below_planes(outside.normals[:2], outside.offsets[:2], depth)
        ),
        np.array([0.0, 1.0, 0.0]) if assembly.in_section else None,
    )
    if outside is not None:
        faces = outside.corners[[0, 1, 5, 4]], outside.corners[[1, 2, 6, 5]]
        height = max(float(np.ptp(face[:, 2])) for face in faces)
        raise_misfit(table_above_ground(design, water, np.stack(faces)[:, None], height))
    elif water.heights:
        _refuse_over_highest(replace(water, pond=None), scene)
    means, points = _patch_pressures(water, assembly, np.ones(len(assembly.patches), dtype=bool))
    notices = scene.notices
    if outside is None and water.heights:
        notices = (*notices, *_open_water(water, scene, means))
    pond = (
        ()
        if water.pond is None
        else tuple(_pond_loads(Pressure((), water.pond, water.unit_weight), scene))
    )
    if water.pond is not None and not pond:
        message = f"the pond stands at {number(water.pond + level)} m: it wets no face of a block that can move"
        notices = (*notices, Notice("W419", message))
    wet = replace(scene, pressures=frozen(means), water_points=frozen(points), notices=notices)
    return with_pushes(wet, pond)


def _refuse_over_highest(water: Pressure, scene: AssemblyScene) -> None:
    corners = scene.assembly.vertices
    if scene.assembly.in_section:
        corners = np.concatenate(
            [np.insert(outline, 1, 0.0, axis=1) for outline in scene.outlines.values()]
        )
    highest = corners[int(corners[:, 2].argmax())]
    head = float(water.pressure((highest - [0.0, 0.0, 1e-6])[None, :])[0])
    if head > 1e-4:
        message = f"the water table lies {head / water.unit_weight:.4g} m above the highest block"
        raise MisfitError([Fault("E456", message, "", "Give a table at or below the ground.")])


def _open_water(water: Pressure, scene: AssemblyScene, means: Floats) -> Iterator[Notice]:
    """Yield W419 where a table stands above free faces of moving blocks: it acts on contacts alone.

    Parameters
    ----------
    means : (k,) kPa on the patches
    """
    assembly = scene.assembly
    patches, pond = assembly.patches, Pressure((), water.pond, water.unit_weight)
    worst, least = -1, _OPEN_WATER_SHARE * water.unit_weight
    for block in np.flatnonzero(~assembly.fixed).tolist():
        surface = _surface(scene, block)[0]
        push_on_surface = float((water.resultants(surface)[0] - pond.resultants(surface)[0]).sum())
        touching, _ = _patches_of_block(assembly, block)
        if push_on_surface <= least * float(assembly.volumes[block]):
            continue
        push_on_contacts = float(
            (means * patches.areas)[touching].sum()
            - pond.resultants(_polygons(assembly, touching))[0].sum()
        )
        excess = (push_on_surface - push_on_contacts) / float(assembly.volumes[block])
        if excess > least:
            worst, least = block, excess
    if worst >= 0:
        push = least * float(assembly.volumes[worst])
        yield Notice(
            "W419",
            f"the water table stands above faces of {scene.names[worst]} that touch nothing, where "
            f"{push:.4g} kN of water would press: a table presses on contacts alone, open water is a pond",
        )


def _polygons(assembly: Assembly, numbers: Ints) -> Floats:
    """Return patches by index as polygons (n, k, 3) m, the first corner repeated where a patch has fewer than k.

    A contact of a section is a rectangle: its length times the thickness.
    """
    patches = assembly.patches
    first, counts = patches.first[numbers], patches.first[numbers + 1] - patches.first[numbers]
    if assembly.in_section:
        start, end = patches.corners[first], patches.corners[first + 1]
        return _rectangles(
            start, end, patches.areas[numbers] / np.sqrt(((end - start) ** 2).sum(axis=1))
        )
    corners = np.arange(int(counts.max(initial=3)))
    return patches.corners[first[:, None] + np.where(corners < counts[:, None], corners, 0)]


def _patch_pressures(water: Pressure, assembly: Assembly, chosen: Bools) -> tuple[Floats, Floats]:
    """Return the mean pressures (k,) kPa on chosen patches (k,) and the points (k, 3) they act through."""
    patches = assembly.patches
    means, points = np.zeros(len(patches)), patches.centroids.copy()
    numbers = np.flatnonzero(chosen)
    thrusts, centres = water.resultants(_polygons(assembly, numbers))
    is_wet = thrusts > 0.0
    wet = numbers[is_wet]
    means[wet], points[wet] = thrusts[is_wet] / patches.areas[wet], centres[is_wet]
    return means, points


def _rectangles(start: Floats, end: Floats, thickness: Any) -> Floats:
    """Return the rectangles (n, 4, 3) m of lines in a section with a thickness."""
    half = np.asarray(thickness)[..., None] * np.array([0.0, 0.5, 0.0])
    return np.stack([start - half, end - half, end + half, start + half], axis=1)


def _surface(scene: AssemblyScene, block: int) -> tuple[Floats, Floats]:
    """Return the flat pieces (n, k, 3) of the surface of a block and their outward normals; in a section no sides."""
    assembly = scene.assembly
    if assembly.in_section:
        ring = np.insert(scene.polygons[block], 1, 0.0, axis=1)
        runs = ring - np.roll(ring, 1, axis=0)
        normals = (
            np.sign(cross(runs, ring - ring[0])[:, 1].sum()) * runs[:, [2, 1, 0]] * [1.0, 0.0, -1.0]
        )
        polygons = _rectangles(ring - runs, ring, scene.thickness or 1.0)
    else:
        polygons = assembly.vertices[assembly.triangles[assembly.triangle_block == block]]
        normals = cross(polygons[:, 1] - polygons[:, 0], polygons[:, 2] - polygons[:, 0])
    sizes = np.sqrt((normals * normals).sum(axis=1))
    return polygons[sizes > 0.0], normals[sizes > 0.0] / sizes[sizes > 0.0, None]


def _patches_of_block(assembly: Assembly, block: int) -> tuple[Ints, Floats]:
    """Return the indices (n,) of the patches of a block, and their normals (n, 3) out of it."""
    patches = assembly.patches
    sides = [
        (np.flatnonzero(side == block), sign)
        for side, sign in ((patches.plus, -1.0), (patches.minus, 1.0))
    ]
    normals = [sign * patches.normals[numbers] for numbers, sign in sides]
    return np.concatenate([numbers for numbers, _ in sides]), np.concatenate(normals)


def _pond_loads(pond: Pressure, scene: AssemblyScene) -> Iterator[BlockLoad]:
    """Yield the loads of a pond on the free faces of the blocks that can move."""
    assembly = scene.assembly
    patches = assembly.patches
    level = pond.pond
    assert level is not None
    moving = np.flatnonzero(~assembly.fixed)
    surfaces = ((k, *_surface(scene, k)) for k in moving.tolist())
    wet = [surface for surface in surfaces if float(surface[1][..., 2].min()) < level]
    is_wet = np.zeros(len(assembly) + 1, dtype=bool)
    is_wet[[k for k, _, _ in wet]] = True
    means, points = _patch_pressures(pond, assembly, is_wet[patches.plus] | is_wet[patches.minus])
    for block, polygons, outward in wet:
        displaced = pond.unit_weight * float(assembly.volumes[block])
        centre = assembly.centroids[block]
        force, couple = np.array([0.0, 0.0, displaced]), np.zeros(3)
        if float(polygons[..., 2].max()) > level:
            thrusts, centres = pond.resultants(polygons)
            pushes = -thrusts[:, None] * outward
            force, couple = pushes.sum(axis=0), cross(centres - centre, pushes).sum(axis=0)
        touching, normals = _patches_of_block(assembly, block)
        pushes = (means * patches.areas)[touching, None] * normals
        force += pushes.sum(axis=0)
        couple += cross(points[touching] - centre, pushes).sum(axis=0)
        if float(np.sqrt(force @ force)) > _ROUNDING * displaced:
            yield BlockLoad("water", block, PointForce(force, None, couple), is_live=False)


def with_surcharge(
    scene: AssemblyScene, pressure_kpa: float | None, outside: ConvexBody
) -> AssemblyScene:
    """Return the scene with a surcharge on the block faces in the upper slope."""
    if not pressure_kpa:
        return scene
    assembly = scene.assembly
    normal, offset = outside.normals[1], float(outside.offsets[1])
    corners = assembly.vertices[assembly.triangles]
    size = np.ptp(corners.reshape(-1, 3), axis=0).max()
    on_top = (np.abs(corners @ normal - offset) <= _IN_PLANE * size).all(axis=1)
    plan = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2.0 * on_top
    loaded = []
    for block in np.unique(assembly.triangle_block[plan > 0.0]).tolist():
        if not assembly.fixed[block]:
            is_loaded = (assembly.triangle_block == block) & (plan > 0.0)
            loaded.append(
                _surcharge_load(
                    block, pressure_kpa, plan[is_loaded], corners[is_loaded].mean(axis=1)
                )
            )
    return with_pushes(scene, loaded)


def with_surcharges(design: NamedDesign, scene: AssemblyScene) -> AssemblyScene:
    """Return the scene with surcharges on the free upward faces of the named blocks.

    Raises
    ------
    GeometryError
        E461 the block has no such face.
    """
    assembly, pressures = scene.assembly, dict(design.surcharges_kpa)
    loaded = []
    for block, name in enumerate(scene.names):
        if not pressures.get(name):
            continue
        polygons, outward = _surface(scene, block)
        polygons = polygons[outward[:, 2] > _SLOPING]
        a, b, c = polygons[:, :1], polygons[:, 1:-1], polygons[:, 2:]
        plans, middles = (
            (cross(b - a, c - a)[..., 2] / 2.0).ravel(),
            ((a + b + c) / 3.0).reshape(-1, 3),
        )
        total_plan = float(np.abs(plans).sum())
        touching, outward = _patches_of_block(assembly, block)
        covered, outward = touching[outward[:, 2] > _SLOPING], outward[outward[:, 2] > _SLOPING]
        plans = np.append(np.abs(plans), -assembly.patches.areas[covered] * outward[:, 2])
        middles = np.append(middles, assembly.patches.centroids[covered], axis=0)
        if not float(plans.sum()) > _IN_PLANE * total_plan:
            message = f"the surcharge on {name} has nothing to stand on: no part of it looks up and touches no other"
            raise MisfitError(
                [Fault("E461", message, "", "Name the block on top, or give a force.")]
            )
        loaded.append(_surcharge_load(block, pressures[name], plans, middles))
    return with_pushes(scene, loaded)


def _surcharge_load(block: int, pressure_kpa: float, plans: Floats, middles: Floats) -> BlockLoad:
    """Return the load of a surcharge on plan areas (k,) m² of a block with middles (k, 3)."""
    total = float(plans.sum())
    return BlockLoad(
        "surcharge",
        block,
        PointForce(np.array([0.0, 0.0, -pressure_kpa * total]), plans @ middles / total),
    )
