"""Node pairs: where the rigid blocks touch, with the area that each pair controls.

Linear contact traction on a rigid interface needs a rule that is exact to degree two. Per triangle, 1/12 of the
area on each vertex and 3/4 on the centroid is: positive, exact for linear traction, and its hull is the polygon, so
that overturning about an edge is exact with the coarsest mesh (docs/theory/preie.md).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from slopekit.core.arrays import Floats, Ints, cross, frozen
from slopekit.core.errors import Fault, SolverError
from slopekit.geometry.tolerances import AREA_SUM, LENGTH_ROUNDING

BEDROCK = -1
_CACHED_BLOCKS = 64  # blocks
_VERTEX_SHARE, _CENTROID_SHARE = 1.0 / 12.0, 3.0 / 4.0


@dataclass(frozen=True)
class NodePairs:
    """Node pairs between blocks.

    Attributes
    ----------
    points : (n, 3) m
    normals : (n, 3) unit, into the block on the plus side
    control_areas : (n,) m²
    interface : (n,) which interface a pair lies on
    plus, minus : (n,) block indices, -1 for bedrock
    """

    points: Floats
    normals: Floats
    control_areas: Floats
    interface: Ints
    plus: Ints
    minus: Ints

    def __len__(self) -> int:
        return len(self.control_areas)


def node_pairs(polygons: Mapping[int, Floats], refine: int = 0) -> NodePairs:
    """Return the node pairs between one block (index 0) and the bedrock.

    Parameters
    ----------
    polygons : interface id -> (k, 3) corners of a flat convex face, anticlockwise seen from outside the block
    refine : how often each triangle is split in four (trimesh); 0 takes the triangles of the polygon

    Raises
    ------
    SolverError
        E599 the control areas do not sum to the interface.
    """
    faces = (
        (int(key), np.asarray(polygon, dtype=np.float64).tobytes())
        for key, polygon in polygons.items()
    )
    return _pairs_of_faces(tuple(faces), refine)


@lru_cache(maxsize=_CACHED_BLOCKS)
def _pairs_of_faces(faces: tuple[tuple[int, bytes], ...], refine: int) -> NodePairs:
    """Return the node pairs on faces, cached by the bytes of their corners: studies mostly vary the strength."""
    points, normals, areas, interface = [], [], [], []
    for key, buffer in faces:
        vertices = np.frombuffer(buffer).reshape(-1, 3)
        corners = np.arange(1, len(vertices) - 1)
        triangles = np.stack([np.zeros_like(corners), corners, corners + 1], axis=1)
        vector_area = _vector_area(vertices, triangles).sum(axis=0)
        if refine:
            vertices, triangles = _subdivided(vertices, triangles, refine)
        nodes, node_areas = _lumped_areas(vertices, triangles)
        total = float(np.sqrt(vector_area @ vector_area))
        rounding = LENGTH_ROUNDING * float(
            (np.ptp(vertices, axis=0) ** 2).sum()
        )  # of the area: a sliver may consist of rounding alone
        if abs(node_areas.sum() - total) > AREA_SUM * total + rounding:
            raise SolverError(
                [
                    Fault(
                        "E599",
                        f"control areas of interface {key} sum to {node_areas.sum()}, not {total} m²",
                    )
                ]
            )
        points.append(nodes)
        areas.append(node_areas)
        normals.append(np.broadcast_to(-vector_area / total, nodes.shape))
        interface.append(np.full(len(nodes), key))
    count = sum(len(face_areas) for face_areas in areas)
    index_arrays = (
        np.concatenate(interface),
        np.zeros(count, dtype=np.int64),
        np.full(count, BEDROCK),
    )
    for numbers in index_arrays:
        numbers.setflags(write=False)
    return NodePairs(
        frozen(np.concatenate(points)),
        frozen(np.concatenate(normals)),
        frozen(np.concatenate(areas)),
        *index_arrays,
    )


def _vector_area(vertices: Floats, triangles: Ints) -> Floats:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return cross(b - a, c - a) / 2.0


def _lumped_areas(vertices: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """Return points (n, 3) m and control areas (n,) m²: the vertices first, then the centroids of the triangles."""
    areas = np.sqrt((_vector_area(vertices, triangles) ** 2).sum(axis=1))
    vertex_areas = np.bincount(
        triangles.ravel(), np.repeat(areas * _VERTEX_SHARE, 3), minlength=len(vertices)
    )
    centroids = vertices[triangles].mean(axis=1)
    return np.concatenate([vertices, centroids]), np.concatenate(
        [vertex_areas, areas * _CENTROID_SHARE]
    )


def _subdivided(vertices: Floats, triangles: Ints, times: int) -> tuple[Floats, Ints]:
    from trimesh.remesh import subdivide  # only a scene that refines pays for trimesh

    for _ in range(times):
        vertices, triangles = subdivide(vertices, triangles)
    return np.asarray(vertices, dtype=np.float64), np.asarray(triangles, dtype=np.int64)
