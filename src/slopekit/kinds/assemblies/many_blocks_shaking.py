"""Inertia of the blocks of an assembly, for earthquakes."""

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene
from slopekit.preie.motion.shaking import inertia_of


def gyration(scene: AssemblyScene) -> Floats:
    """Inertia about the centroid per unit of mass (b, 3, 3) m² of the blocks of a scene.

    Of a section that about its y axis alone.
    """
    assembly = scene.assembly
    inertia_per_mass = np.zeros((len(assembly), 3, 3))
    if assembly.in_section:
        for block, (outline, centroid) in enumerate(zip(scene.polygons, assembly.centroids, strict=True)):
            inertia_per_mass[block, 1, 1] = _of_outline(outline - centroid[[0, 2]])
        return inertia_per_mass
    for block in np.flatnonzero(~assembly.fixed).tolist():
        faces = assembly.vertices[assembly.triangles[assembly.triangle_block == block]]
        volume, inertia = inertia_of(list(faces), assembly.centroids[block])
        inertia_per_mass[block] = inertia / volume
    return inertia_per_mass


def _of_outline(outline: Floats) -> float:
    """Polar moment of area of a polygon (k, 2) about the origin, per unit of area."""
    after = np.roll(outline, -1, axis=0)
    twice = outline[:, 0] * after[:, 1] - outline[:, 1] * after[:, 0]
    squares = (outline * outline + outline * after + after * after).sum(axis=1)
    return float((twice * squares).sum() / (6.0 * twice.sum()))
