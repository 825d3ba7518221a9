"""Convex blocks by the planes that bound them, n at once: their faces, volumes and centroids.

A corner is where three planes meet and no other plane cuts it off; a face is the corners on its plane, in the order of
their angles about the middle of them.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from slopekit.core.arrays import Floats, Ints, cross, frozen

_PLANE_TOLERANCE = 1e-10  # of the size of a block: a corner that little beyond a plane lies on it
_CORNER_TOLERANCE = 1e-12  # of the farthest corner: corners nearer to each other coincide


@dataclass(frozen=True)
class Block:
    """A block: its faces as polygons by the plane that made them.

    Attributes
    ----------
    faces : plane id -> (k, 3) corners in m, anticlockwise seen from outside
    areas : plane id -> area in m²
    volume : m³
    centroid : (3,) m
    """

    faces: Mapping[int, Floats]
    areas: Mapping[int, float]
    volume: float
    centroid: Floats

    @property
    def corners(self) -> Floats:
        """All corners of all faces, (n, 3), repeated where faces share them."""
        return np.concatenate(list(self.faces.values()))


@dataclass(frozen=True)
class Polytopes:
    """The blocks that p planes bound, n of them.

    Attributes
    ----------
    outward : (n, p, 3) unit normals; offsets : (n, p) m: `outward · x <= offset` within a block
    faces : (n, p, c, 3) m, corners of each face anticlockwise as seen from outside; the first again where there are
        fewer than c
    counts : (n, p) corners of each face, 0 where a plane has no face
    volume : (n,) m³; centroid : (n, 3) m; not a number where the planes bound no block
    """

    outward: Floats
    offsets: Floats
    faces: Floats
    counts: Ints
    volume: Floats
    centroid: Floats

    def corners(self) -> Floats:
        """Return the corners of the blocks, (n, p c, 3) m, face by face; nan without a face."""
        corners = np.where((self.counts > 0)[:, :, None, None], self.faces, np.nan)
        return corners.reshape(len(corners), -1, 3)

    def block(self) -> Block:
        """Return the first of the blocks.

        Corners in which more than three planes meet are one; each face begins at its lowest corner.
        """
        used = np.arange(self.faces.shape[2]) < self.counts[0][:, None]
        points, plane_of_point = self.faces[0][used], np.nonzero(used)[0]
        count = len(points)
        coincides = np.abs(points[:, None] - points).max(axis=2) <= _CORNER_TOLERANCE * np.abs(
            points
        ).max(initial=0.0)
        corner_index = np.where(coincides, np.arange(count), count).min(
            axis=1, initial=count
        )  # the first of coinciding corners
        corners = {
            plane: list(dict.fromkeys(corner_index[plane_of_point == plane].tolist()))
            for plane in np.unique(plane_of_point).tolist()
        }
        faces = {
            plane: frozen(
                np.roll(points[numbers], -int(points[numbers, 2].argmin()), axis=0)
            )  # from the lowest corner
            for plane, numbers in corners.items()
            if len(numbers) > 2
        }
        areas = {plane: _area(polygon) for plane, polygon in faces.items()}
        return Block(faces, areas, float(self.volume[0]), frozen(self.centroid[0]))


def polytopes(outward: Floats, offsets: Floats, size: Floats) -> Polytopes:
    """Return the blocks below planes `outward · x <= offset`.

    Parameters
    ----------
    outward : (n, p, 3) unit normals; offsets : (n, p) m; size : (n,) m, about that of the blocks

    >>> cube = np.concatenate([np.eye(3), -np.eye(3)])[None]
    >>> block = polytopes(cube, np.array([[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]]), np.ones(1))
    >>> block.volume.round(12), block.counts, block.centroid.round(12)
    (array([1.]), array([[4, 4, 4, 4, 4, 4]]), array([[0.5, 0.5, 0.5]]))
    """
    planes = offsets.shape[1]
    triples = np.array(list(combinations(range(planes), 3)))
    first, second, third = (outward[:, triples[:, k]] for k in range(3))
    triple_offsets = offsets[:, triples, None]
    edges = cross(second, third), cross(third, first), cross(first, second)
    determinant = (first * edges[0]).sum(axis=2)
    with np.errstate(
        divide="ignore", over="ignore", invalid="ignore"
    ):  # planes that are nearly parallel
        points = (
            sum(triple_offsets[:, :, k] * edge for k, edge in enumerate(edges))
            / determinant[:, :, None]
        )
        excess = points @ outward.transpose(0, 2, 1) - offsets[:, None]
    rows = np.arange(len(triples))[:, None]
    excess[:, rows, triples] = 0.0
    with np.errstate(invalid="ignore"):
        inside = (excess <= _PLANE_TOLERANCE * size[:, None, None]).all(axis=2) & (
            determinant != 0.0
        )
    points = np.where(inside[:, :, None], points, 0.0)
    on_plane = [np.flatnonzero((triples == plane).any(axis=1)) for plane in range(planes)]
    candidates = np.stack(on_plane)  # as many triples on every plane
    is_corner, corners = inside[:, candidates], points[:, candidates]
    counts = is_corner.sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = corners.sum(axis=2) / counts[:, :, None]
    tangents = _tangents(outward)
    arms = corners - middle[:, :, None]
    angles = np.arctan2(
        (arms * cross(outward, tangents)[:, :, None]).sum(axis=3),
        (arms * tangents[:, :, None]).sum(axis=3),
    )
    order = np.argsort(np.where(is_corner, angles, np.inf), axis=2)[
        :, :, : max(int(counts.max(initial=0)), 3)
    ]
    faces = np.take_along_axis(corners, order[..., None], axis=2)
    used = np.arange(faces.shape[2]) < counts[:, :, None]
    faces = np.where(used[..., None], faces, faces[:, :, :1])
    counts = np.where(counts > 2, counts, 0)
    volume, centroid = _volumes(outward, offsets, faces, counts)
    return Polytopes(outward, offsets, faces, counts, volume, centroid)


def _area(polygon: Floats) -> float:
    arms = polygon[1:] - polygon[0]
    turns: Floats = cross(arms[:-1], arms[1:]).sum(axis=0)
    return math.sqrt(float(turns @ turns)) / 2.0


def _tangents(normals: Floats) -> Floats:
    """Return unit vectors in planes with these unit normals (n, p, 3)."""
    direction = cross(normals, np.eye(3)[np.abs(normals).argmin(axis=2)])
    tangents: Floats = direction / np.sqrt((direction * direction).sum(axis=2))[..., None]
    return tangents


def _volumes(
    outward: Floats, offsets: Floats, faces: Floats, counts: Ints
) -> tuple[Floats, Floats]:
    """Return volumes (n,) and centroids (n, 3), by pyramids on the faces from the corner nearest to the origin."""
    rows, (is_face, corners) = np.arange(len(faces)), (counts > 0, faces.reshape(len(faces), -1, 3))
    distance = np.where(
        np.repeat(is_face, faces.shape[2], axis=1), (corners * corners).sum(axis=2), np.inf
    )
    apex = corners[rows, distance.argmin(axis=1)]
    heights = np.where(is_face, offsets - (outward @ apex[:, :, None])[:, :, 0], 0.0)
    first, second, third = (
        np.broadcast_to(faces[:, :, :1], faces[:, :, 2:].shape),
        faces[:, :, 1:-1],
        faces[:, :, 2:],
    )
    doubled = (cross(second - first, third - first) * outward[:, :, None]).sum(axis=3)
    tetrahedra = doubled * heights[:, :, None] / 6.0
    volume = tetrahedra.sum(axis=(1, 2))
    volume = np.where(volume > 0.0, volume, np.nan)
    middles = (first + second + third + apex[:, None, None]) / 4.0
    return volume, (tetrahedra[..., None] * middles).sum(axis=(1, 2)) / volume[:, None]
