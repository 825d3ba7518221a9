"""Finite elements of convex blocks without a mesher: cut from the lowest corner, then refined by scikit-fem.

Faces are fanned from their lowest-numbered corner and the body is the cone from its lowest-numbered corner over all
faces that do not hold it: blocks that share numbered corners fit together.
"""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import DesignError, Fault

_CORNER_TOLERANCE = 1e-9  # distance of equal corners, as a fraction of the size of the body
_HULL_EXCESS = 1e-6  # by which the hull of a convex body may be larger, as a fraction of its volume
_FLAT_CELL = 1e-12  # volume of a cell that is left out, as a fraction of the cube of the size


def required() -> None:
    """Raise E140 where scikit-fem is not installed."""
    try:
        import skfem  # noqa: F401
    except ImportError:
        advice = "pip install 'slopekit[elastic]'"
        raise DesignError(
            [Fault("E140", "elastic blocks need the extra elastic (scikit-fem)", "", advice)]
        ) from None


def numbered(polygons: Iterable[Floats]) -> tuple[Floats, list[list[int]]]:
    """Return the distinct corners of polygons, numbered in order of appearance, and each polygon as corner numbers.

    Parameters
    ----------
    polygons : (k, d) corners each

    >>> points, faces = numbered([np.eye(3), np.vstack([np.eye(3)[1:], np.zeros(3)])])
    >>> len(points), faces
    (4, [[0, 1, 2], [1, 2, 3]])
    """
    polygons = list(polygons)
    corners = np.concatenate(polygons)
    tolerance = _CORNER_TOLERANCE * float(np.ptp(corners, axis=0).max())
    points: list[Floats] = []
    faces = []
    for polygon in polygons:
        face: list[int] = []
        for corner in polygon:
            number = next(
                (
                    k
                    for k, point in enumerate(points)
                    if float(np.abs(point - corner).max()) <= tolerance
                ),
                len(points),
            )
            if number == len(points):
                points.append(corner)
            if number not in face:
                face.append(number)
        faces.append(face)
    return np.array(points), faces


def fanned(faces: Iterable[Sequence[int]]) -> Ints:
    """Return the triangles (t, 3) of convex faces, fanned from the lowest-numbered corner of each.

    >>> fanned([[2, 3, 0, 1]]).tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    triangles = []
    for face in faces:
        k = int(np.argmin(np.array(face)))
        rotated = [*face[k:], *face[:k]]
        triangles += [(rotated[0], a, b) for a, b in pairwise(rotated[1:])]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def cells_of(points: Floats, triangles: Ints) -> Ints:
    """Return the tetrahedra (c, 4) of a convex body: the cone from its lowest corner number over its boundary."""
    apex = int(triangles.min())
    base_triangles = triangles[(triangles != apex).all(axis=1)]
    cells = np.concatenate([np.full((len(base_triangles), 1), apex), base_triangles], axis=1)
    size = float(np.ptp(points[np.unique(triangles)], axis=0).max())
    return cells[np.abs(measures(points, cells)) > _FLAT_CELL * size**3]


def measures(points: Floats, cells: Ints) -> Floats:
    """Return the signed volumes of tetrahedra, or areas of triangles in the plane, (c,)."""
    sides = points[cells[:, 1:]] - points[cells[:, :1]]
    sizes: Floats = np.linalg.det(sides) / (6.0 if cells.shape[1] == 4 else 2.0)
    return sizes


def mesh_of(points: Floats, cells: Ints) -> Any:
    """Return the scikit-fem mesh of some cells: tetrahedra, or triangles in the plane."""
    from skfem import MeshTet, MeshTri

    corners, numbers = np.unique(cells, return_inverse=True)
    mesh_type = MeshTet if points.shape[1] == 3 else MeshTri
    return mesh_type(
        np.ascontiguousarray(points[corners].T),
        np.ascontiguousarray(numbers.reshape(cells.shape).T),
    )


def convex_mesh(polygons: Iterable[Floats], size: float) -> Any:
    """Return the mesh of a convex body from its faces (k, 3), or of a convex outline (k, 2); None if it is not convex.

    Parameters
    ----------
    size : its volume, m³, or its area, m²
    """
    points, faces = numbered(polygons)
    if ConvexHull(points - points.mean(axis=0)).volume > size * (1.0 + _HULL_EXCESS):
        return None
    triangles = fanned(faces)
    return mesh_of(points, triangles if points.shape[1] == 2 else cells_of(points, triangles))


def edges_of(mesh: Any) -> Floats:
    """Return the longest edge of each cell, (c,) m."""
    corners = np.asarray(mesh.p)[:, np.asarray(mesh.t)]  # (d, k, c)
    squares = [
        ((corners - corners[:, k][:, None]) ** 2).sum(axis=0).max(axis=0)
        for k in range(len(mesh.t))
    ]
    longest: Floats = np.sqrt(np.stack(squares).max(axis=0))
    return longest


def halvings(mesh: Any, edge: float) -> int:
    """Return how often a mesh is halved until no edge exceeds `edge` (m); each time a cell becomes 8 (4 in a plane)."""
    return max(0, math.ceil(math.log2(float(edges_of(mesh).max()) / edge * (1.0 - 1e-9))))
