"""The stereonet: lower-hemisphere projections of lines and planes, equal area (Schmidt) or equal angle (Wulff).

Vectors are (east, north, up); the net has the radius 1, its x points east, its y north.

>>> project(np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])).tolist()
[[0.0, -1.0], [0.0, 0.0]]
"""

import math
from typing import Literal

import numpy as np

from slopekit.arrays import Floats
from slopekit.orientation import Plane

Net = Literal["area", "angle"]
#: What the two nets are called.
NETS: dict[Net, str] = {"area": "equal area (Schmidt)", "angle": "equal angle (Wulff)"}
_TINY = 1e-15


def lower(vectors: Floats) -> Floats:
    """The vectors (n, 3), those that point up turned round."""
    return np.asarray(np.where(vectors[:, 2:] > 0.0, -vectors, vectors))


def project(vectors: Floats, net: Net = "area") -> Floats:
    """Unit vectors (n, 3) as points (n, 2) of the net; upward ones stand for their opposites.

    With d the downward component the points lie at (east, north) / √(1 + d) on the equal-area net and at
    (east, north) / (1 + d) on the equal-angle net (Snyder 1987, §20 and 24; Lisle & Leyshon 2004).
    """
    down = lower(vectors)
    scale = 1.0 - down[:, 2]
    found: Floats = down[:, :2] / (np.sqrt(scale) if net == "area" else scale)[:, None]
    return found


def unproject(points: Floats, net: Net = "area") -> Floats:
    """The downward unit vectors (n, 3) of points (n, 2) in the net: the inverse of `project`.

    >>> points = np.array([[0.3, -0.4], [0.0, 0.99]])
    >>> bool(np.allclose(project(unproject(points, "angle"), "angle"), points, rtol=0, atol=1e-15))
    True
    """
    square = (points * points).sum(axis=1)
    if net == "area":
        return np.asarray(np.column_stack([points * np.sqrt(2.0 - square)[:, None], square - 1.0]))
    return np.asarray(np.column_stack([2.0 * points, square - 1.0]) / (1.0 + square)[:, None])


def great_circle(plane: Plane, count: int = 181) -> Floats:
    """Vectors (count, 3) from one end of the strike down the dip to the other: evenly spaced in the plane."""
    dip, direction = math.radians(plane.dip_deg), math.radians(plane.dip_direction_deg)
    along = np.array([-math.cos(direction), math.sin(direction), 0.0])
    down = np.array([
        math.sin(direction) * math.cos(dip), math.cos(direction) * math.cos(dip), -math.sin(dip)
    ])  # fmt: skip
    pitch = np.linspace(0.0, math.pi, count)[:, None]
    return np.asarray(np.cos(pitch) * along + np.sin(pitch) * down)


def small_circle(axis: Floats, angle_deg: float, count: int = 361) -> list[Floats]:
    """The cone about a downward axis: one or two arcs (k, 3) in the lower hemisphere, cut where they leave it.

    What the cone has above the horizon stands for the opposite directions, and is an arc of its own.
    """
    turned = cone(axis, angle_deg, np.linspace(0.0, 2.0 * math.pi, count))
    heights = turned[:, 2]
    if (heights <= _TINY).all() or (heights >= -_TINY).all():
        return [lower(turned)]
    # height = A cos t + B: it is level at ± acos(-B / A), as `cone` starts at the top
    top, bottom = float(heights[0]), float(heights[count // 2])
    middle, swing = (top + bottom) / 2.0, (top - bottom) / 2.0
    level = math.acos(min(1.0, max(-1.0, -middle / swing)))
    above = cone(axis, angle_deg, np.linspace(-level, level, count))
    below = cone(axis, angle_deg, np.linspace(level, 2.0 * math.pi - level, count))
    above[:, 2], below[:, 2] = np.maximum(above[:, 2], 0.0), np.minimum(below[:, 2], 0.0)
    return [below, -above]


def cone(axis: Floats, angle_deg: float, turns: Floats) -> Floats:
    """Vectors (n, 3) at an angle about an axis, turned by `turns` (n,) radians from its highest one."""
    up = np.array([0.0, 0.0, 1.0])
    steep = up - axis * axis[2]
    size = float(np.sqrt(steep @ steep))
    steep = steep / size if size > 1e-9 else np.array([0.0, 1.0, 0.0])
    side = np.cross(axis, steep)
    angle, turn = math.radians(angle_deg), turns[:, None]
    return np.asarray(math.cos(angle) * axis + math.sin(angle) * (np.cos(turn) * steep + np.sin(turn) * side))


def daylight_envelope(face: Plane, count: int = 181) -> Floats:
    """Poles (count, 3), downward, of the planes whose dip vector lies in the face: within it planes daylight.

    At an angle θ from the dip direction of the face such a plane has its apparent dip: tan δ = tan β cos θ. The curve
    starts and ends at the middle of the net.
    """
    dip = math.radians(face.dip_deg)
    off = math.pi / 2.0 * np.sin(np.linspace(-math.pi / 2.0, math.pi / 2.0, count))  # dense where it leaves the middle
    apparent = np.arctan2(math.sin(dip) * np.maximum(np.cos(off), 0.0), math.cos(dip))
    toward = math.radians(face.dip_direction_deg) + off
    return -np.stack([np.sin(apparent) * np.sin(toward), np.sin(apparent) * np.cos(toward), np.cos(apparent)], axis=-1)


def trend(vectors: Floats) -> Floats:
    """Trends (n,) in degrees."""
    return np.asarray(np.degrees(np.arctan2(vectors[:, 0], vectors[:, 1])) % 360.0)


def mean_axis(vectors: Floats) -> Floats:
    """The downward unit vector (3,) nearest to axes (n, 3): the first eigenvector of their orientation matrix.

    Source: Woodcock (1977); Fisher, Lewis & Embleton (1987), §3.2.4.
    """
    found: Floats = lower(np.linalg.eigh(vectors.T @ vectors)[1][:, -1][None])[0]
    return found
