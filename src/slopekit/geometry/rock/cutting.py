"""Bodies of manifold3d whose faces carry the ids of their planes, to be cut into blocks by many planes.

manifold3d returns the pieces and, by provenance (`face_id`), the plane that made each face.
"""

import math

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from slopekit.core.arrays import Floats, Ints, cross
from slopekit.core.errors import Fault, GeometryError

_REACH = 12.0  # of a half-space
#: The triangles of a box whose corners are numbered around the first face, then around the opposite one.
BOX_TRIANGLES = np.array(
    [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ],
    dtype=np.int64,
)
_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_SQUARE_BOX = np.array([[x, y, z] for z in (-1.0, 1.0) for x, y in _SQUARE.tolist()])


def tagged(vertices: Floats, triangles: Ints, face_ids: Ints) -> Manifold:
    """Return a closed body of (n, 3) vertices and (m, 3) outward triangles, each with its id (m,).

    Raises
    ------
    GeometryError
        E208 the triangles do not close.
    """
    mesh = Mesh64(
        np.ascontiguousarray(vertices),
        triangles.astype(np.uint64),
        face_id=face_ids.astype(np.uint64),
    )
    manifold = Manifold(mesh)
    if manifold.status() != Error.NoError:
        raise GeometryError(
            [Fault("E208", f"the cutter is not a closed body ({manifold.status()})")]
        )
    return manifold


def far_box(half_width: float, first_id: int) -> Manifold:
    """Return a cube about the origin; its faces carry the ids `first_id` to `first_id + 5`."""
    return tagged(
        _SQUARE_BOX * half_width, BOX_TRIANGLES, np.repeat(np.arange(first_id, first_id + 6), 2)
    )


def half_space(normal: Floats, offset: float, plane: int, back: int) -> Manifold:
    """Return the half-space above a plane as a box whose first face lies on it and carries the plane's id.

    The other faces carry the id `back`; they lie more than `_REACH` from the origin.
    """
    axis = np.zeros(3)
    axis[np.argmin(np.abs(normal))] = 1.0
    across = cross(normal, axis)
    across /= math.sqrt(float(across @ across))
    axes = np.array([across, cross(normal, across)])
    base = normal * offset + _REACH * (_SQUARE @ axes)
    ids = np.full(12, back)
    ids[:2] = plane
    return tagged(np.concatenate([base, base + _REACH * normal]), BOX_TRIANGLES, ids)
