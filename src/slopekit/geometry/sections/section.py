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
from slopekit.geometry.rock.cutting import Block, cut_convex
from slopekit.geometry.tolerances import PARALLEL_DEG

J1, FACE, UPPER, CRACK, LEFT, RIGHT = range(6)


@dataclass(frozen=True)
class PlaneSection:
    """A block on one plane in its section.

    Attributes
    ----------
    block : faces J1, FACE, UPPER, CRACK where it has them, and its two sides
    bottom : (3,) where the plane ends at the back; length : m of the plane
    crack_depth, crack_distance : m, None without a crack; the distance counts back from the crest
    outline : (k, 2) x and z, anticlockwise from the toe
    """

    block: Block
    bottom: Floats
    length: float
    crack_depth: float | None
    crack_distance: float | None
    outline: Floats


@lru_cache(maxsize=8)  # one design asks for its section several times: cut, closed form, support
def plane_section(
    plane_dip: float, face_dip: float, upper_dip: float, height: float,
    crack_depth: float | None = None, crack_distance: float | None = None,
) -> PlaneSection:  # fmt: skip
    """The block above a plane that daylights at the toe, in front of a vertical crack where there is one.

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
        message = f"the plane dips {plane_dip:.4g}°, as steep as the face ({face_dip:.4g}°) or steeper"
        raise GeometryError([Fault("E203", message + ": it does not daylight", "", "It must come out at the toe.")])
    if upper_dip >= face_dip - PARALLEL_DEG:
        raise GeometryError([Fault("E209", f"the upper slope ({upper_dip:.4g}°) is as steep as the face")])
    plane, face, upper = (math.radians(dip) for dip in (plane_dip, face_dip, upper_dip))
    crest = np.array([-height / math.tan(face) if face_dip < 90.0 else 0.0, 0.0, height])
    normals = [_normal(plane), _normal(face), _normal(upper)]
    offset = float(normals[UPPER] @ crest)
    back = None
    if plane_dip > upper_dip + PARALLEL_DEG:
        along = np.array([-math.cos(plane), 0.0, math.sin(plane)])
        back = along * (offset / float(normals[UPPER] @ along))
    distance = _crack_place(plane, face, upper, crest, back, crack_depth, crack_distance)
    if distance is None and back is None:
        message = f"the plane dips {plane_dip:.4g}°, flatter than the upper slope ({upper_dip:.4g}°): they never meet"
        raise GeometryError([Fault("E205", message, "", "Give a tension crack that ends the block.")])
    below = [-normals[J1], normals[FACE], normals[UPPER]]
    offsets = [0.0, 0.0, offset]
    depth = None
    if distance is not None:
        at = float(crest[0]) - distance
        below.append(np.array([-1.0, 0.0, 0.0]))
        offsets.append(-at)
        bottom = np.array([at, 0.0, -at * math.tan(plane)])
        depth = _surface(at, crest, face, upper) - float(bottom[2])
    else:
        assert back is not None
        below.append(np.array([-1.0, 0.0, 0.0]))  # far behind: bounds nothing
        offsets.append(-float(back[0]) * 2.0)
        bottom = back
    below += [np.array([0.0, -1.0, 0.0]), np.array([0.0, 1.0, 0.0])]
    offsets += [0.5, 0.5]
    span = np.array([[0.0, -0.5, 0.0], [bottom[0], 0.5, height], crest, bottom])
    top = _surface(float(bottom[0]), crest, face, upper)
    span = np.concatenate([span, [[bottom[0], 0.0, top]]])
    block = cut_convex(np.array(below), np.array(offsets), span)
    outline = block.faces[LEFT][:, [0, 2]]
    start = int(np.argmin(np.abs(outline).sum(axis=1)))
    length = math.hypot(float(bottom[0]), float(bottom[2]))
    return PlaneSection(block, frozen(bottom), length, depth, distance, frozen(np.roll(outline, -start, axis=0)))


def footing_section(dip: float, length: float) -> PlaneSection:
    """The block between a plane that daylights at the foot of a vertical face and the level ground above it.

    Parameters
    ----------
    dip : degrees; length : m of the plane
    """
    return plane_section(dip, 90.0, 0.0, length * math.sin(math.radians(dip)))


def line_pairs(section: PlaneSection, elements: int) -> NodePairs:
    """Node pairs along the plane, toe first: Simpson's rule on each element (1/6, 4/6, 1/6).

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
        frozen(points), frozen(np.tile(normal, (count, 1))), frozen(areas), np.zeros(count, dtype=np.int64),
        np.zeros(count, dtype=np.int64), np.full(count, BEDROCK),
    )  # fmt: skip


def _normal(dip: float) -> Floats:
    return np.array([math.sin(dip), 0.0, math.cos(dip)])


def _surface(x: float, crest: Floats, face: float, upper: float) -> float:
    """Height of the ground surface at x <= 0."""
    if x > float(crest[0]):
        return -x * math.tan(face)
    return float(crest[2]) + (float(crest[0]) - x) * math.tan(upper)


def _crack_place(
    plane: float, face: float, upper: float, crest: Floats, back: Floats | None,
    depth: float | None, distance: float | None,
) -> float | None:  # fmt: skip
    """Distance of the crack behind the crest (in front of it: negative), None without one."""
    if depth is None and distance is None:
        return None
    at_crest = float(crest[2]) + float(crest[0]) * math.tan(plane)  # depth of the plane below the crest
    if depth is not None:
        less = math.tan(plane) - math.tan(upper)
        behind = (at_crest - depth) / less if abs(less) > 1e-12 else math.inf
        places = [behind] if 0.0 <= behind < math.inf and depth > 0.0 else []
        if not places:
            one = "every one has" if abs(less) <= 1e-12 else f"the {'deepest' if less > 0.0 else 'shallowest'} has"
            message = f"no vertical crack behind the crest is {depth:.6g} m deep: {one} {at_crest:.6g} m"
            raise GeometryError([Fault("E207", message, "", "For a crack in the face give its distance, negative.")])
        if distance is not None and abs(distance - behind) > 0.02 * max(abs(behind), float(crest[2])):
            message = f"a crack {depth:.6g} m deep lies {behind:.6g} m behind the crest, not {distance:.6g} m"
            raise GeometryError([Fault("E207", message, "", "Give depth or distance.")])
        distance = behind
    assert distance is not None
    reach = -float(back[0]) + float(crest[0]) if back is not None else math.inf
    if distance >= reach * (1.0 - 1e-9):
        message = f"the crack lies {distance:.6g} m behind the crest, the block ends at {reach:.6g} m"
        raise GeometryError([Fault("E207", message, "", "The block has no tension crack there: leave the crack out.")])
    if distance <= float(crest[0]) * (1.0 - 1e-9):
        message = f"the crack lies {-distance:.6g} m in front of the crest, beyond the toe ({-float(crest[0]):.6g} m)"
        raise GeometryError([Fault("E207", message)])
    return distance
