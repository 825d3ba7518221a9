"""A water table on the contacts of many blocks: the pressure integrated over each, with the point it acts through."""

from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.patches import Assembly
from slopekit.geometry.pressure import Pressure, in_strips, plane_table
from slopekit.kinds.many_blocks_design import TableDesign
from slopekit.kinds.many_blocks_scene import AssemblyScene


def with_table(design: TableDesign, scene: AssemblyScene, into: Floats) -> AssemblyScene:
    """The scene with the water of the design's table on its contacts, where it has one.

    Parameters
    ----------
    into : (3,) level unit vector that the distances of points count along, from the origin

    Raises
    ------
    GeometryError
        E456 the table lies above the highest block.
    """
    if not design.has_table:
        return scene
    level = float(scene.origin[2])
    if design.table_points_m is not None:
        places, levels = zip(*design.table_points_m, strict=True)
        heights = in_strips(into, places, [one - level for one in levels])
    else:
        assert design.table_plane is not None
        heights = plane_table(
            design.table_plane.plane.normal(), design.table_plane.level_m - level, scene.assembly.in_section
        )
    water = Pressure(heights, None, design.water_unit_weight_kn_m3)
    assembly = scene.assembly
    corners = assembly.vertices if len(assembly.vertices) else assembly.patches.corners
    highest = corners[int(corners[:, 2].argmax())]
    head = float(water.at((highest - [0.0, 0.0, 1e-6])[None, :])[0])
    if head > 1e-4:
        message = f"the water table lies {head / water.unit_weight:.4g} m above the highest block"
        raise GeometryError([Fault("E456", message, "", "Give a table at or below the ground.")])
    means, points = _on_patches(water, assembly)
    return replace(scene, pressures=frozen(means), water_points=frozen(points))


def _on_patches(water: Pressure, assembly: Assembly) -> tuple[Floats, Floats]:
    """Mean pressures (k,) kPa and the points (k, 3) they act through."""
    patches = assembly.patches
    means, points = np.zeros(len(patches)), patches.centroids.copy()
    for k, (first, last) in enumerate(zip(patches.first[:-1], patches.first[1:], strict=True)):
        polygon = patches.corners[first:last]
        if len(polygon) == 2:  # of a section: its length, square to it the thickness
            length = float(np.linalg.norm(polygon[1] - polygon[0]))
            half = np.array([0.0, patches.areas[k] / length / 2.0, 0.0])
            polygon = np.array([polygon[0] - half, polygon[1] - half, polygon[1] + half, polygon[0] + half])
        thrust, at = water.on(polygon)
        if thrust:
            means[k], points[k] = thrust / patches.areas[k], at
    return means, points
