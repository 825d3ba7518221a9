"""Blocks in a vertical section one metre thick: x out of the slope, z up, the toe at the origin.

Their interfaces are lines: node pairs by Simpson's rule, exact for linear traction, with the hinges at the ends.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.interfaces import BEDROCK, NodePairs
from slopekit.geometry.polytopes import Block, polytopes
from slopekit.geometry.tolerances import PARALLEL_DEG

J1, FACE, UPPER, CRACK, LEFT, RIGHT = range(6)


@dataclass(frozen=True)
class PlaneSection:
    """A block on one plane in its section.

    Attributes
    ----------
    block : faces J1, FACE, UPPER, CRACK where it has them, and its two sides
    outline : (k, 2) x and z, anticlockwise from the toe: the last corner is where the plane ends at the back
    crack_distance : m, None without a crack; it counts back from the crest
    """

    block: Block
    outline: Floats
    crack_distance: float | None

    @property
    def bottom(self) -> Floats:
        """The end of the plane at the back of the block, (3,) m."""
        x, z = self.outline[-1]
        return np.array([x, 0.0, z])

    @property
    def ends(self) -> Floats:
        """The ends of the plane, (2, 3) m, the toe first."""
        return np.array([np.zeros(3), self.bottom])

    @property
    def length(self) -> float:
        """The length of the plane, m."""
        return math.hypot(*self.outline[-1])

    @property
    def crack_depth(self) -> float | None:
        """The depth of the tension crack, m; None without one."""
        return None if self.crack_distance is None else float(np.ptp(self.block.faces[CRACK][:, 2]))


@lru_cache(maxsize=8)  # one design asks for its section several times: cut, closed form, support
def plane_section(
    plane_dip: float,
    face_dip: float,
    upper_dip: float,
    height: float,
    crack_depth: float | None = None,
    crack_distance: float | None = None,
) -> PlaneSection:
    """Return the block above a plane that daylights at the toe, in front of a vertical tension crack if there is one.

    Parameters
    ----------
    plane_dip, face_dip, upper_dip : degrees, positive where they dip out of the slope
    height : m, from the toe to the crest
    crack_depth, crack_distance : m, one of the two, or both where they agree

    Raises
    ------
    GeometryError
        E203 the plane is steeper than the face, E204 it does not dip out of the slope, E205 it never meets the upper
        slope, E207 the crack does not cut the block off, E209 the upper slope is as steep as the face.
    """
    if plane_dip <= PARALLEL_DEG:
        message = f"the plane dips {-plane_dip:.4g}° into the slope: nothing on it can slide out"
        if abs(plane_dip) <= PARALLEL_DEG:
            message = "the plane is level: nothing on it can slide out"
        raise GeometryError([Fault("E204", message)])
    if plane_dip >= face_dip - PARALLEL_DEG:
        message = (
            f"the plane dips {plane_dip:.4g}°, as steep as the face ({face_dip:.4g}°) or steeper"
        )
        raise GeometryError(
            [Fault("E203", message + ": it does not daylight", "", "It must come out at the toe.")]
        )
    if upper_dip >= face_dip - PARALLEL_DEG:
        raise GeometryError(
            [Fault("E209", f"the upper slope ({upper_dip:.4g}°) is as steep as the face")]
        )
    plane, face, upper = (math.radians(dip) for dip in (plane_dip, face_dip, upper_dip))
    crest = np.array([-height / math.tan(face) if face_dip < 90.0 else 0.0, 0.0, height])
    normals = [_normal(plane), _normal(face), _normal(upper)]
    offset = float(normals[UPPER] @ crest)
    reach = math.inf  # horizontal, from the toe to where the plane meets the upper slope
    if plane_dip > upper_dip + PARALLEL_DEG:
        along = np.array([-math.cos(plane), 0.0, math.sin(plane)])
        reach = offset / float(normals[UPPER] @ along) * math.cos(plane)
    distance = _crack_distance(plane, upper, crest, reach, crack_depth, crack_distance)
    if distance is None and math.isinf(reach):
        message = f"the plane dips {plane_dip:.4g}°, flatter than the upper slope ({upper_dip:.4g}°): they never meet"
        raise GeometryError(
            [Fault("E205", message, "", "Give a tension crack that ends the block.")]
        )
    end = (
        2.0 * reach if distance is None else distance - float(crest[0])
    )  # far behind it bounds nothing
    across = np.array([0.0, 1.0, 0.0])
    below = np.array(
        [-normals[J1], normals[FACE], normals[UPPER], [-1.0, 0.0, 0.0], -across, across]
    )
    block = polytopes(
        below[None], np.array([[0.0, 0.0, offset, end, 0.5, 0.5]]), np.array([height])
    ).block()
    outline = block.faces[LEFT][:, [0, 2]]
    start = int(np.argmin(np.abs(outline).sum(axis=1)))
    return PlaneSection(block, frozen(np.roll(outline, -start, axis=0)), distance)


def footing_section(dip: float, length: float) -> PlaneSection:
    """Return the block between a plane that daylights at the foot of a vertical face and the level ground above it.

    Parameters
    ----------
    dip : degrees; length : m of the plane
    """
    return plane_section(dip, 90.0, 0.0, length * math.sin(math.radians(dip)))


def line_pairs(section: PlaneSection, elements: int) -> NodePairs:
    """Return the node pairs along the plane, toe first, by Simpson's rule on each element (1/6, 4/6, 1/6).

    Parameters
    ----------
    elements : the plane has 2 elements + 1 node pairs
    """
    count = 2 * elements + 1
    weights = np.where(np.arange(count) % 2 == 1, 4.0, 2.0)
    weights[[0, -1]] = 1.0
    points = np.linspace(0.0, 1.0, count)[:, None] * section.bottom
    x, _, z = section.bottom / section.length
    normal = np.array([z, 0.0, -x])
    areas = weights / (6.0 * elements) * section.length
    return NodePairs(
        frozen(points),
        frozen(np.tile(normal, (count, 1))),
        frozen(areas),
        np.zeros(count, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
        np.full(count, BEDROCK),
    )


def _normal(dip: float) -> Floats:
    return np.array([math.sin(dip), 0.0, math.cos(dip)])


def _crack_distance(
    plane: float,
    upper: float,
    crest: Floats,
    farthest: float,
    depth: float | None,
    distance: float | None,
) -> float | None:
    """Return the distance (m) of the crack behind the crest (in front of it: negative), None without a crack."""
    if depth is None and distance is None:
        return None
    depth_at_crest = float(crest[2]) + float(crest[0]) * math.tan(
        plane
    )  # depth of the plane below the crest
    if depth is not None:
        slope_difference = math.tan(plane) - math.tan(upper)
        depth_distance = (
            (depth_at_crest - depth) / slope_difference
            if abs(slope_difference) > 1e-12
            else math.inf
        )
        if not 0.0 <= depth_distance < math.inf or depth <= 0.0:
            actual_depth = (
                "every one has"
                if abs(slope_difference) <= 1e-12
                else f"the {'deepest' if slope_difference > 0.0 else 'shallowest'} has"
            )
            message = f"no vertical crack behind the crest is {depth:.6g} m deep: {actual_depth} {depth_at_crest:.6g} m"
            raise GeometryError(
                [Fault("E207", message, "", "For a crack in the face give its distance, negative.")]
            )
        if distance is not None and abs(distance - depth_distance) > 0.02 * max(
            abs(depth_distance), float(crest[2])
        ):
            message = f"a crack {depth:.6g} m deep lies {depth_distance:.6g} m behind the crest, not {distance:.6g} m"
            raise GeometryError([Fault("E207", message, "", "Give depth or distance.")])
        distance = depth_distance
    assert distance is not None
    reach = farthest + float(crest[0])
    if distance >= reach * (1.0 - 1e-9):
        message = (
            f"the crack lies {distance:.6g} m behind the crest, the block ends at {reach:.6g} m"
        )
        raise GeometryError(
            [
                Fault(
                    "E207",
                    message,
                    "",
                    "The block has no tension crack there: leave the crack out.",
                )
            ]
        )
    if distance <= float(crest[0]) * (1.0 - 1e-9):
        message = f"the crack lies {-distance:.6g} m in front of the crest, beyond the toe ({-float(crest[0]):.6g} m)"
        raise GeometryError([Fault("E207", message)])
    return distance
