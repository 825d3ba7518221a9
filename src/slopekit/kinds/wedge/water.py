"""Full water on wedges, n at once."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from slopekit.core.arrays import cross
from slopekit.geometry.pressure import Pieces, even, pyramid
from slopekit.kinds.water import LocalSlope


def full_water(slope: LocalSlope, unit_weight: Any) -> Mapping[int, Pieces]:
    """Full water on the joints and the crack: Hoek & Bray's pyramids; above a basal joint even over each face.

    The mean is γ_w H/6, highest half way along the line of intersection; with a crack γ_w h₅/3, highest where the crack
    meets the line, h₅ below the upper slope.
    """
    faces = {face: slope.faces[face] for face in slope.interfaces}
    normal, offset = slope.normals[1], slope.offsets[1]
    mean = unit_weight * slope.height / 6.0
    if slope.crack in faces:
        corners = faces[slope.crack]
        depths = (offset[:, None] - (corners * normal[:, None]).sum(axis=2)) / normal[:, 2:]
        mean = unit_weight * depths.max(axis=1) / 3.0
        apex = np.take_along_axis(corners, depths.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    if len(slope.joints) > 2:
        return {face: even(polygons, mean) for face, polygons in faces.items()}
    if slope.crack not in faces:
        line = cross(*(slope.outward[joint] for joint in slope.joints))
        apex = line * (offset / (line * normal).sum(axis=1))[:, None] / 2.0
    return {face: pyramid(polygons, mean, apex) for face, polygons in faces.items()}
