"""Joint sets as planes through a body: regular or scattered spacing, parallel or scattered orientation."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.rock.bench import ConvexBody
from slopekit.geometry.tolerances import SAME_PLANE

_MOST_PLANES = 20_000  # of one set
_LEAST_GAP = 0.1  # of the spacing


@dataclass(frozen=True)
class JointSet:
    """A joint set.

    Attributes
    ----------
    normal : (3,) unit, upward
    spacing : mean distance of its planes, square to them, m
    offset : of one of its planes, `normal · x = offset`, m
    scatter_deg : root mean square angle of the normals to the mean (Fisher's angular standard deviation)
    spacing_scatter : standard deviation of the distances, in parts of the spacing
    """

    normal: Floats
    spacing: float
    offset: float = 0.0
    scatter_deg: float = 0.0
    spacing_scatter: float = 0.0


@dataclass(frozen=True)
class SetPlanes:
    """The planes of all sets that cut a body.

    Attributes
    ----------
    normals : (p, 3) unit; offsets : (p,) m
    joint : (p,) index of the set
    """

    normals: Floats
    offsets: Floats
    joint: Ints

    def __len__(self) -> int:
        return len(self.offsets)


def planes_of_sets(
    sets: Sequence[JointSet], body: ConvexBody, rng: np.random.Generator
) -> SetPlanes:
    """Return the planes of all joint sets through the whole body, set after set and each from below upward.

    The reference plane of a set (at its offset, or the nearest whole number of spacings from it that cuts the body)
    stays where it is; scattered distances are drawn from it upward, then downward, normal and at least a tenth of the
    spacing. Scattered normals follow the Fisher distribution about the mean, each plane turned about its point
    nearest the middle of the body. Sets without scatter draw no random numbers.

    Raises
    ------
    GeometryError
        E220 a set has more than 20,000 planes.

    Examples
    --------
    >>> from slopekit.geometry.rock.bench import bench_body
    >>> body = bench_body(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 10.0, 30.0, 20.0)
    >>> flat = JointSet(np.array([0.0, 0.0, 1.0]), spacing=2.0, offset=101.0)
    >>> planes_of_sets([flat], body, np.random.default_rng(0)).offsets.tolist()
    [1.0, 3.0, 5.0, 7.0, 9.0]
    """
    middle = (body.corners.min(axis=0) + body.corners.max(axis=0)) / 2.0
    corners = body.corners - middle
    normals, offsets = [np.zeros((0, 3))], [np.zeros(0)]
    for index, joint_set in enumerate(sets):
        normal, offset = _planes_of_set(joint_set, middle, corners, rng, index)
        normals.append(normal)
        offsets.append(offset)
    joint = np.repeat(np.arange(len(sets)), [len(set_offsets) for set_offsets in offsets[1:]])
    normal, offset = np.concatenate(normals), np.concatenate(offsets)
    # planes are compared by the heights of the body's corners over them
    heights = normal @ corners.T - offset[:, None]
    tolerance = SAME_PLANE * body.size
    cuts = (heights.min(axis=1) < -tolerance) & (heights.max(axis=1) > tolerance)
    normal, offset, joint, heights = normal[cuts], offset[cuts], joint[cuts], heights[cuts]
    keep = _distinct_planes(heights, tolerance)
    offset = offset + normal @ middle
    return SetPlanes(frozen(normal[keep]), frozen(offset[keep]), joint[keep])


def _planes_of_set(
    joint_set: JointSet, middle: Floats, corners: Floats, rng: np.random.Generator, index: int
) -> tuple[Floats, Floats]:
    """Return normals and offsets, about the middle of the body, of all planes of a set that may reach the body."""
    heights = corners @ joint_set.normal
    low, high = float(heights.min()), float(heights.max())
    spread = math.radians(joint_set.scatter_deg)
    if spread > 0.0:  # a plane beyond the body may be turned into it
        radius = math.sqrt(float((corners * corners).sum(axis=1).max())) / max(
            0.5, math.cos(3.0 * spread)
        )
        low, high = -radius, radius
    spacing = joint_set.spacing
    if not (high - low) / spacing < _MOST_PLANES:
        count = f"{(high - low) / spacing:.3g}"
        message = f"joint set {index + 1} has {count} planes in the bench, more than {_MOST_PLANES}"
        advice = (
            f"Take a spacing above {(high - low) / _MOST_PLANES:.3g} m (it is {spacing:.6g} m)."
        )
        raise GeometryError([Fault("E220", message, "", advice)])
    start = joint_set.offset - float(joint_set.normal @ middle)
    if not low <= start <= high:
        start += spacing * math.ceil((low - start) / spacing)
    if joint_set.spacing_scatter > 0.0:
        upward = _plane_distances(high - start, joint_set, rng)
        positions = np.concatenate(
            [start - _plane_distances(start - low, joint_set, rng)[::-1], [start], start + upward]
        )
    else:
        steps = np.arange(
            math.ceil((low - start) / spacing), math.floor((high - start) / spacing) + 1
        )
        positions = start + spacing * steps
    normals = np.broadcast_to(joint_set.normal, (len(positions), 3))
    if spread == 0.0:
        return normals, positions
    scattered = _fisher_normals(joint_set.normal, spread, len(positions), rng)
    # through the point of the plane that is nearest to the middle of the body: position · mean normal
    return scattered, positions * (scattered @ joint_set.normal)


def _plane_distances(distance: float, joint_set: JointSet, rng: np.random.Generator) -> Floats:
    """Return the distances (m) of the planes from the reference plane on one side of it, up to `distance`."""
    distances = np.zeros(0)
    last = 0.0
    count = max(1, math.ceil(distance / joint_set.spacing))
    while last <= distance:
        gaps = joint_set.spacing * np.maximum(
            rng.normal(1.0, joint_set.spacing_scatter, count), _LEAST_GAP
        )
        distances = np.concatenate([distances, last + np.cumsum(gaps)])
        last = float(distances[-1])
    return distances[distances <= distance]


def _fisher_normals(mean: Floats, spread: float, count: int, rng: np.random.Generator) -> Floats:
    """Draw unit vectors (count, 3) about a mean whose root mean square angle to it is `spread` (rad).

    Fisher (1953): cos θ = 1 + ln(u + (1 - u) exp(-2k)) / k, with k = 2 / spread².
    """
    k = 2.0 / spread**2
    uniform, turn = rng.random(count), 2.0 * math.pi * rng.random(count)
    cosine = np.clip(1.0 + np.log(uniform + (1.0 - uniform) * math.exp(-2.0 * k)) / k, -1.0, 1.0)
    sine = np.sqrt(1.0 - cosine**2)
    axis = np.zeros(3)
    axis[np.argmin(np.abs(mean))] = 1.0
    first = np.cross(mean, axis)
    first /= math.sqrt(float(first @ first))
    second = np.cross(mean, first)
    vectors: Floats = (
        cosine[:, None] * mean
        + (sine * np.cos(turn))[:, None] * first
        + (sine * np.sin(turn))[:, None] * second
    )
    return vectors


def _distinct_planes(heights: Floats, tolerance: float) -> Bools:
    """Return which planes to keep (p,): of planes nearer to each other than `tolerance` over the body, the first."""
    from scipy.spatial import cKDTree

    keep = np.ones(len(heights), dtype=np.bool_)
    both_ways = cKDTree(np.concatenate([heights, -heights]))
    pairs = both_ways.query_pairs(tolerance, p=math.inf, output_type="ndarray") % max(
        1, len(heights)
    )
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    for first, second in pairs[np.argsort(pairs[:, 1], kind="stable")].tolist():
        if first != second and keep[first]:
            keep[second] = False
    return keep
