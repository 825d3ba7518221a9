"""Intersections of lines with triangles, for the blocks that a bolt passes through."""

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross

_EDGE_TOLERANCE = 1e-9  # of a triangle: a line through its edge meets it
_PARALLEL_COSINE = 1e-12  # a cosine: a line this near to the plane of a triangle does not meet it


def line_triangle_intersections(
    start: Floats, direction: Floats, corners: Floats
) -> tuple[Floats, Ints]:
    """Return the intersections of a line with triangles: distances (k,) in lengths of `direction`, and triangles (k,).

    Parameters
    ----------
    start, direction : (3,) m; corners : (t, 3, 3) m

    >>> triangle = np.eye(3)[None] * [1.0, 1.0, 0.0]
    >>> line_triangle_intersections(np.array([0.2, 0.2, 5.0]), np.array([0.0, 0.0, -1.0]), triangle)
    (array([5.]), array([0]))
    """
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = (normals * normals).sum(axis=1)
    slope = normals @ direction
    hits = np.flatnonzero(
        np.abs(slope) > _PARALLEL_COSINE * np.sqrt(size * float(direction @ direction))
    )
    arms, normals, size = corners[hits] - start, normals[hits], size[hits]
    distances = (arms[:, 0] * normals).sum(axis=1) / slope[hits]
    points = arms - distances[:, None, None] * direction
    barycentric = [
        (cross(points[:, k], points[:, (k + 1) % 3]) * normals).sum(axis=1) / size for k in range(3)
    ]
    inside: Bools = np.min(barycentric, axis=0) > -_EDGE_TOLERANCE
    return distances[inside], hits[inside]
