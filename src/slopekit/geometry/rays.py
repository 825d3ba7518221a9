"""Where a line meets triangles: what a bolt passes through."""

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross

_ON_EDGE = 1e-9  # of a triangle: a line through its edge meets it
_ALONG = 1e-12  # a cosine: a line this near to the plane of a triangle does not meet it


def line_triangle_intersections(start: Floats, way: Floats, corners: Floats) -> tuple[Floats, Ints]:
    """Return where a line meets triangles: how far from its start, in lengths of its way (k,), and which (k,).

    Parameters
    ----------
    start, way : (3,); corners : (t, 3, 3)

    >>> triangle = np.eye(3)[None] * [1.0, 1.0, 0.0]
    >>> line_triangle_intersections(np.array([0.2, 0.2, 5.0]), np.array([0.0, 0.0, -1.0]), triangle)
    (array([5.]), array([0]))
    """
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = (normals * normals).sum(axis=1)
    slope = normals @ way
    met = np.flatnonzero(np.abs(slope) > _ALONG * np.sqrt(size * float(way @ way)))
    arms, normals, size = corners[met] - start, normals[met], size[met]
    at = (arms[:, 0] * normals).sum(axis=1) / slope[met]
    points = arms - at[:, None, None] * way
    parts = [(cross(points[:, k], points[:, (k + 1) % 3]) * normals).sum(axis=1) / size for k in range(3)]
    inside: Bools = np.min(parts, axis=0) > -_ON_EDGE
    return at[inside], met[inside]
