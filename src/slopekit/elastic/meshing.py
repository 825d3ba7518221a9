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

_SAME = 1e-9  # corners nearer than this part of the size are one
_CONVEX = 1e-6  # of the size of a body: by so much its hull may be larger
_FLAT = 1e-12  # volume of a cell, in parts of the cube of the size, that is none


def required() -> None:
    """Raise E140 where scikit-fem is not installed."""
    try:
        import skfem  # noqa: F401
    except ImportError:
        advice = "pip install 'slopekit[elastic]'"
        raise DesignError([Fault("E140", "elastic blocks need the extra elastic (scikit-fem)", "", advice)]) from None


def numbered(polygons: Iterable[Floats]) -> tuple[Floats, list[list[int]]]:
    """The corners of polygons, each once, and the polygons by their numbers, in the order in which they appear.

    Parameters
    ----------
    polygons : (k, d) corners each

    >>> points, faces = numbered([np.eye(3), np.vstack([np.eye(3)[1:], np.zeros(3)])])
    >>> len(points), faces
    (4, [[0, 1, 2], [1, 2, 3]])
    """
    polygons = list(polygons)
    corners = np.concatenate(polygons)
    near = _SAME * float(np.ptp(corners, axis=0).max())
    points: list[Floats] = []
    faces = []
    for polygon in polygons:
        face: list[int] = []
        for corner in polygon:
            at = next((k for k, one in enumerate(points) if float(np.abs(one - corner).max()) <= near), len(points))
            if at == len(points):
                points.append(corner)
            if at not in face:
                face.append(at)
        faces.append(face)
    return np.array(points), faces


def fanned(faces: Iterable[Sequence[int]]) -> Ints:
    """Triangles (t, 3) of convex faces, from their lowest-numbered corners.

    >>> fanned([[2, 3, 0, 1]]).tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    out = []
    for face in faces:
        k = int(np.argmin(np.array(face)))
        turned = [*face[k:], *face[:k]]
        out += [(turned[0], a, b) for a, b in pairwise(turned[1:])]
    return np.array(out, dtype=np.int64).reshape(-1, 3)


def cells_of(points: Floats, triangles: Ints) -> Ints:
    """Tetrahedra (c, 4) of a convex body: the cone from its lowest-numbered corner over its boundary (t, 3)."""
    apex = int(triangles.min())
    over = triangles[(triangles != apex).all(axis=1)]
    cells = np.concatenate([np.full((len(over), 1), apex), over], axis=1)
    size = float(np.ptp(points[np.unique(triangles)], axis=0).max())
    return cells[np.abs(measures(points, cells)) > _FLAT * size**3]


def measures(points: Floats, cells: Ints) -> Floats:
    """Signed volumes of tetrahedra, or areas of triangles in the plane, (c,)."""
    sides = points[cells[:, 1:]] - points[cells[:, :1]]
    sizes: Floats = np.linalg.det(sides) / (6.0 if cells.shape[1] == 4 else 2.0)
    return sizes


def mesh_of(points: Floats, cells: Ints) -> Any:
    """The mesh of cells, tetrahedra or triangles in the plane."""
    from skfem import MeshTet, MeshTri

    used, numbers = np.unique(cells, return_inverse=True)
    kind = MeshTet if points.shape[1] == 3 else MeshTri
    return kind(np.ascontiguousarray(points[used].T), np.ascontiguousarray(numbers.reshape(cells.shape).T))


def convex_mesh(polygons: Iterable[Floats], size: float) -> Any:
    """The mesh of a convex body by its faces (k, 3), or of a convex outline (k, 2) alone; None where it is not convex.

    Parameters
    ----------
    size : its volume, m³, or its area, m²
    """
    points, faces = numbered(polygons)
    if ConvexHull(points - points.mean(axis=0)).volume > size * (1.0 + _CONVEX):
        return None
    triangles = fanned(faces)
    return mesh_of(points, triangles if points.shape[1] == 2 else cells_of(points, triangles))


def edges_of(mesh: Any) -> Floats:
    """The longest edge of each cell, (c,)."""
    corners = np.asarray(mesh.p)[:, np.asarray(mesh.t)]  # (d, k, c)
    squares = [((corners - corners[:, k][:, None]) ** 2).sum(axis=0).max(axis=0) for k in range(len(mesh.t))]
    longest: Floats = np.sqrt(np.stack(squares).max(axis=0))
    return longest


def halvings(mesh: Any, edge: float) -> int:
    """How often the edges of a mesh are halved until none is longer than `edge` (m): a cell becomes 8, 4 in a plane."""
    return max(0, math.ceil(math.log2(float(edges_of(mesh).max()) / edge * (1.0 - 1e-9))))
