"""Two joints of a wedge that are nearly parallel: how much hangs on a degree of them."""

import math

import numpy as np

from slopekit.core.orientation import Plane
from slopekit.kinds.wedge.design import WedgeDesign


def parallel_note(design: WedgeDesign, apart: float) -> str:
    """How far one degree of one joint moves the line of intersection."""
    first, second = design.joints
    normals = second.normal()
    line = np.cross(first.normal(), normals)
    moved = 0.0
    for dip, direction in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        other = np.cross(Plane(first.dip_deg + dip, first.dip_direction_deg + direction).normal(), normals)
        sizes = math.sqrt(float(line @ line) * float(other @ other))
        if sizes > 0.0:
            moved = max(moved, math.degrees(math.acos(min(1.0, abs(float(line @ other)) / sizes))))
    return (
        f"J1 and J2 are only {apart:.3g}° apart: one degree on J1 moves the line of intersection by up to {moved:.0f}°"
    )
