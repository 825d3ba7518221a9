"""Cells of an arrangement of planes in a convex body: volumes, faces, and which cell lies behind which face.

A cell is known by the planes it lies above. Behind its face on plane p lies the cell that is above the same planes
but for p, so neighbours are found by arithmetic on signatures, exactly, however thin or small the faces are; areas and
centroids of the two sides are compared afterwards as evidence.
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, NDArray, cross
from slopekit.geometry.rock.plane_stacks import PlaneStack, Soup
from slopekit.geometry.tolerances import NO_VOLUME

Hashes = NDArray[np.uint64]


@dataclass(frozen=True)
class Cells:
    """Convex cells, ordered by the slab of each stack they lie in.

    Attributes
    ----------
    volumes : (n,); centroids : (n, 3)
    signature : (n,) uint64, the wrapped sum of the weights of the planes that the cell lies above
    of_triangle : (t,) the cell of each triangle of the soup
    """

    volumes: Floats
    centroids: Floats
    signature: Hashes
    of_triangle: Ints


@dataclass(frozen=True)
class Faces:
    """Faces of cells, one for each cell and plane it lies on.

    Attributes
    ----------
    cell, plane : (f,)
    is_below : (f,) the cell lies below the plane (its outward normal is the plane's)
    areas : (f,); centroids : (f, 3)
    of_triangle : (t,) the face of each triangle
    """

    cell: Ints
    plane: Ints
    is_below: Bools
    areas: Floats
    centroids: Floats
    of_triangle: Ints

    def __len__(self) -> int:
        return len(self.areas)


def plane_weights(count: int) -> Hashes:
    """Return a fixed 64-bit number for each plane (splitmix64), so that sums of them distinguish sets of planes."""
    z = (np.arange(1, count + 1, dtype=np.uint64)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def cells_of(soup: Soup, normals: Floats, offsets: Floats, stacks: list[PlaneStack]) -> Cells:
    """Return the cells of a cut body: its connected pieces, those between the same planes united.

    Parameters
    ----------
    normals, offsets : of the cutting planes, those of a stack ascending along its axis
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    triangles, vertices = soup.triangles, soup.vertices
    ends = triangles[:, :2].T.ravel(), triangles[:, 1:].T.ravel()
    graph = coo_array(
        (np.ones(len(ends[0]), dtype=np.bool_), ends), shape=(len(vertices), len(vertices))
    )
    count, of_vertex = connected_components(graph, directed=False)
    piece = of_vertex[triangles[:, 0]].astype(np.int64)
    # a point inside each piece: the mean of its vertices, whatever its volume is to rounding
    vertex_count = np.bincount(of_vertex, minlength=count)
    inside = (
        np.stack([np.bincount(of_vertex, vertices[:, k], count) for k in range(3)], axis=1)
        / vertex_count[:, None]
    )
    half = np.zeros((count, soup.half.shape[1]), dtype=np.bool_)
    half[piece] = soup.half
    slabs = np.empty((count, len(stacks)), dtype=np.int64)
    for k, (planes, _) in enumerate(stacks):
        slabs[:, k] = _slab(inside @ normals[planes].T - offsets[planes], half[:, k])
    slabs, cell_of_piece = np.unique(slabs, axis=0, return_inverse=True)
    cell_of_piece = cell_of_piece.reshape(count).astype(np.int64)
    weights = plane_weights(len(offsets))
    signature = np.zeros(len(slabs), dtype=np.uint64)
    for k, (planes, _) in enumerate(stacks):
        passed = np.concatenate(
            [np.zeros(1, dtype=np.uint64), np.cumsum(weights[planes], dtype=np.uint64)]
        )
        signature += passed[slabs[:, k]]
    # tetrahedra from a point of each cell to its triangles
    cell = cell_of_piece[piece]
    points = np.zeros((len(slabs), 3))
    points[cell_of_piece] = inside
    apex = points[cell]
    a, b, c = (vertices[triangles[:, k]] - apex for k in range(3))
    tetrahedra = np.einsum("ti,ti->t", a, cross(b, c)) / 6.0
    volumes = np.bincount(cell, tetrahedra, len(slabs)).astype(np.float64)
    moments = _sums(cell, tetrahedra[:, None] * (a + b + c) / 4.0, len(slabs))
    solid = volumes > NO_VOLUME  # the centroid of a cell without volume would be lost to rounding
    centroids = (
        points + np.where(solid[:, None], moments, 0.0) / np.where(solid, volumes, 1.0)[:, None]
    )
    return Cells(volumes, centroids, signature, cell)


def faces_of(soup: Soup, cell: Ints, normals: Floats) -> Faces:
    """Return the faces of cells, on the cutting planes with `normals` and on the planes of the body.

    Parameters
    ----------
    cell : (t,) of each triangle
    """
    plane_count = int(soup.plane.max()) + 1
    keys, of_triangle = np.unique(cell * plane_count + soup.plane, return_inverse=True)
    of_triangle = of_triangle.reshape(-1).astype(np.int64)
    a, b, c = (soup.vertices[soup.triangles[:, k]] for k in range(3))
    doubled_vectors = cross(b - a, c - a)
    vector = _sums(of_triangle, doubled_vectors, len(keys)) / 2.0
    areas = np.sqrt((vector * vector).sum(axis=1))
    unit = vector / np.where(areas > 0.0, areas, 1.0)[:, None]
    doubled_areas = np.einsum("ti,ti->t", doubled_vectors, unit[of_triangle]) / 2.0
    corner = np.zeros((len(keys), 3))
    corner[of_triangle] = a
    base = corner[of_triangle]
    moments = _sums(
        of_triangle,
        doubled_areas[:, None] * ((a - base) + (b - base) + (c - base)) / 3.0,
        len(keys),
    )
    plane = keys % plane_count
    toward = (
        np.einsum("fi,fi->f", vector, normals[np.minimum(plane, len(normals) - 1)])
        if len(normals)
        else areas
    )
    return Faces(
        keys // plane_count,
        plane,
        toward > 0.0,
        areas,
        corner + moments / np.where(areas > 0.0, areas, 1.0)[:, None],
        of_triangle,
    )


def plane_error(soup: Soup, normals: Floats, offsets: Floats) -> float:
    """Return the largest distance of a vertex from the plane that made its triangle."""
    cut = soup.plane < len(offsets)
    planes, corners = soup.plane[cut], soup.triangles[cut]
    if not len(planes):
        return 0.0
    distances = [
        np.einsum("ti,ti->t", normals[planes], soup.vertices[corners[:, k]]) - offsets[planes]
        for k in range(3)
    ]
    return float(np.abs(distances).max())


def opposite_faces(cells: Cells, faces: Faces, count: int) -> Ints:
    """Return, for each face on one of the `count` cutting planes, the face on the other side of the plane, else -1.

    Behind a face below plane p lies the cell whose signature has the weight of p added.
    """
    inner = np.flatnonzero(faces.plane < count)
    weight = plane_weights(count)[faces.plane[inner]]
    neighbour_signature = cells.signature[faces.cell[inner]] + np.where(
        faces.is_below[inner], weight, np.uint64(0) - weight
    )
    order = np.argsort(cells.signature)
    neighbour = order[
        np.searchsorted(cells.signature, neighbour_signature, sorter=order).clip(max=len(order) - 1)
    ]
    is_matched = cells.signature[neighbour] == neighbour_signature
    # faces are sorted by (cell, plane): look up the neighbour's face on the same plane
    plane_count = int(faces.plane.max()) + 1
    keys = faces.cell * plane_count + faces.plane
    neighbour_keys = neighbour * plane_count + faces.plane[inner]
    opposite = np.searchsorted(keys, neighbour_keys).clip(max=len(keys) - 1)
    is_matched &= (keys[opposite] == neighbour_keys) & (
        faces.is_below[opposite] != faces.is_below[inner]
    )
    result = np.full(len(faces), -1, dtype=np.int64)
    result[inner[is_matched]] = opposite[is_matched]
    return result


def corners_of_faces(
    soup: Soup, of_triangle: Ints, chosen: Ints, tolerance: float
) -> tuple[Floats, Ints]:
    """Return the corners of chosen faces, anticlockwise from outside their cells, without those on a straight edge.

    Parameters
    ----------
    of_triangle : (t,) face of each triangle; chosen : (k,) faces
    tolerance : corners nearer to the line between their neighbours, or to the next corner, are no corners

    Returns
    -------
    corners (c, 3) and first (k + 1,): face i has the corners first[i] to first[i + 1]
    """
    rank = np.full(int(of_triangle.max()) + 1, -1, dtype=np.int64)
    rank[chosen] = np.arange(len(chosen))
    face = rank[of_triangle]
    triangles, face = soup.triangles[face >= 0], face[face >= 0]
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    face = np.repeat(face, 3)
    # an edge within a face runs both ways in it; each edge of a closed cell belongs to two triangles only
    count = len(soup.vertices)
    edge = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(edge)
    twin = np.flatnonzero((np.diff(edge[order]) == 0) & (np.diff(face[order]) == 0))
    rim = np.ones(len(edge), dtype=np.bool_)
    rim[order[twin]] = rim[order[twin + 1]] = False
    start, end, face = start[rim], end[rim], face[rim]
    order = np.argsort(face * count + start)
    start, end, face = start[order], end[order], face[order]
    following = np.searchsorted(face * count + start, face * count + end)
    walk = _boundary_walk(face, following, len(chosen))
    points, face = soup.vertices[start[walk]], face[walk]
    for is_redundant in (_repeated_corners, _straight_corners):
        keep = ~is_redundant(points, face, tolerance, len(chosen))
        points, face = points[keep], face[keep]
    return points, _first_corners(face, len(chosen))


def _boundary_walk(face: Ints, following: Ints, count: int) -> Ints:
    """Return the indices of the edges in order round each face, face by face."""
    sizes = np.bincount(face, minlength=count)
    first = np.concatenate([[0], np.cumsum(sizes)])
    walk = np.empty(len(face), dtype=np.int64)
    edge, active = first[:-1].copy(), np.flatnonzero(sizes > 0)
    for step in range(int(sizes.max(initial=0))):
        walk[first[active] + step] = edge[active]
        active = active[sizes[active] > step + 1]
        edge[active] = following[edge[active]]
    return walk


def _first_corners(face: Ints, count: int) -> Ints:
    return np.concatenate([[0], np.cumsum(np.bincount(face, minlength=count))]).astype(np.int64)


def _neighbouring_corners(face: Ints, count: int) -> tuple[Ints, Ints]:
    """Return the indices of the previous and the next corner of each corner, round its face."""
    first = _first_corners(face, count)
    corner = np.arange(len(face))
    previous = np.where(corner == first[face], first[face + 1] - 1, corner - 1)
    return previous, np.where(corner + 1 == first[face + 1], first[face], corner + 1)


def _repeated_corners(points: Floats, face: Ints, tolerance: float, count: int) -> Bools:
    _, following = _neighbouring_corners(face, count)
    step = points[following] - points
    is_repeated: Bools = (step * step).sum(axis=1) < tolerance**2
    return is_repeated


def _straight_corners(points: Floats, face: Ints, tolerance: float, count: int) -> Bools:
    previous, following = _neighbouring_corners(face, count)
    chord, arm = points[following] - points[previous], points - points[previous]
    across = cross(chord, arm)
    is_straight: Bools = (across * across).sum(axis=1) <= tolerance**2 * (chord * chord).sum(axis=1)
    return is_straight


def _slab(heights: Floats, in_stack: Bools) -> Ints:
    """Return the slab of a stack that each point lies in: the number of planes below it, odd within the stack."""
    index = (heights > 0.0).sum(axis=1, dtype=np.int64)
    wrong = np.flatnonzero((index % 2 == 1) != in_stack)
    if len(wrong):  # rounding put a cell without thickness on the wrong side of its nearest plane
        nearest = np.abs(heights[wrong]).argmin(axis=1)
        index[wrong] += np.where(heights[wrong, nearest] > 0.0, -1, 1)
    return np.asarray(index, dtype=np.int64)


def _sums(index: Ints, values: Floats, count: int) -> Floats:
    return np.stack([np.bincount(index, values[:, k], count) for k in range(3)], axis=1)
