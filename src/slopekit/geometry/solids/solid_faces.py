"""Closed triangle meshes as one flat array: checked, turned outward, measured, and their flat faces put together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import Fault
from slopekit.geometry.fit import contact_tolerance, raise_faults, size_faults
from slopekit.geometry.tolerances import BENT, FACE_FLAT, TINY

_MOST_CORNERS = 12  # of a convex face that stays one polygon; larger ones stay in triangles


@dataclass(frozen=True)
class ClosedMeshes:
    """Closed meshes of blocks, their triangles anticlockwise seen from outside.

    Attributes
    ----------
    origin : (3,) taken from all coordinates; vertices : (v, 3) m, without origin
    triangles : (t, 3); block : (t,) of each triangle; vertex_block : (v,)
    volumes : (n,) m³; centroids : (n, 3) m, without origin
    shells : (n,) closed surfaces of each block that hang together in nothing
    """

    origin: Floats
    vertices: Floats
    triangles: Ints
    block: Ints
    vertex_block: Ints
    volumes: Floats
    centroids: Floats
    shells: Ints


@dataclass(frozen=True)
class Pieces:
    """Flat convex pieces of the blocks' faces.

    Attributes
    ----------
    corners : (p, k, 3) m, anticlockwise seen from outside, short ones filled up with their last corner
    counts : (p,) how many of the k; normals : (p, 3) unit, outward; block : (p,)
    """

    corners: Floats
    counts: Ints
    normals: Floats
    block: Ints

    def areas(self) -> Floats:
        """Return the areas (p,) of the pieces in m²."""
        sides = self.corners[:, 1:] - self.corners[:, :1]
        return np.asarray(_size(np.cross(sides[:, :-1], sides[:, 1:]).sum(axis=1)) / 2.0)


def clean_solids(
    meshes: Sequence[tuple[Floats, Ints]], tolerance: float | None, names: Sequence[str]
) -> tuple[ClosedMeshes, float]:
    """Return the meshes with equal vertices merged and every triangle turned outward, and the contact tolerance (m).

    Parameters
    ----------
    meshes : vertices (v, 3) m and triangles (t, 3) of each block
    tolerance : m; None for 1e-5 of the mean size (cube root of the volume) of the blocks

    Raises
    ------
    GeometryError
        E227 a mesh encloses no volume; E216 it is not closed, or some of its triangles are turned inward; E230 the
        tolerance is no smaller than a tenth of a block.
    """
    count = len(meshes)
    vertices = np.concatenate([np.asarray(points, dtype=np.float64) for points, _ in meshes])
    first = np.cumsum([0] + [len(points) for points, _ in meshes])
    triangles = np.concatenate(
        [np.asarray(t, dtype=np.int64) + k for (_, t), k in zip(meshes, first, strict=False)]
    )
    block = np.repeat(np.arange(count), [len(corners) for _, corners in meshes])
    rounding = 8.0 * float(np.spacing(np.abs(vertices).max()))
    origin = np.round((vertices.min(axis=0) + vertices.max(axis=0)) / 2.0)
    vertices, triangles, block, vertex_block = _merged(vertices - origin, triangles, block, first)
    raise_faults(_closure_faults(triangles, block, len(vertices), names))
    shell = _components(len(vertices), triangles[:, [0, 1]], triangles[:, [1, 2]])
    used = np.unique(triangles)
    shells = np.bincount(
        vertex_block[used[np.unique(shell[used], return_index=True)[1]]], minlength=count
    )
    apex = vertices[triangles[np.searchsorted(block, np.arange(count)), 0]]
    a, b, c = (vertices[triangles[:, k]] - apex[block] for k in range(3))
    tetrahedra = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
    volumes = np.bincount(block, tetrahedra, minlength=count)
    size = np.cbrt(np.abs(volumes))
    tolerance = contact_tolerance(tolerance, size, rounding)
    empty = np.flatnonzero(size <= tolerance).tolist()
    raise_faults([Fault("E227", f"the mesh of {names[k]} encloses no volume") for k in empty])
    raise_faults(size_faults(size, tolerance, names))
    moment = np.stack(
        [
            np.bincount(block, m, minlength=count)
            for m in (tetrahedra[:, None] * (a + b + c)).T / 4.0
        ],
        axis=1,
    )
    triangles = np.where((volumes < 0.0)[block][:, None], triangles[:, ::-1], triangles)
    return ClosedMeshes(
        origin,
        vertices,
        triangles,
        block,
        vertex_block,
        np.abs(volumes),
        moment / volumes[:, None] + apex,
        shells,
    ), tolerance


def convex_faces(solids: ClosedMeshes, tolerance: float) -> Pieces:
    """Return the flat faces of solids: coplanar triangles united where they make a convex polygon, the others alone."""
    vertices, triangles = solids.vertices, solids.triangles
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    vector = np.cross(b - a, c - a)
    length = np.sqrt((vector * vector).sum(axis=1))
    longest = np.maximum(np.maximum(_size(b - a), _size(c - b)), _size(a - c))
    solid = (
        length > longest * tolerance * 1e-3
    )  # needles have no reliable normal, and no area to touch with
    normal = np.where(solid[:, None], vector / np.where(solid, length, 1.0)[:, None], 0.0)
    edge, partner = _partners(triangles, len(vertices))
    opposite = vertices[triangles[partner % len(triangles), (partner // len(triangles) + 2) % 3]]
    first, second = edge % len(triangles), partner % len(triangles)
    plane_distance = np.abs(np.einsum("ni,ni->n", opposite - a[first], normal[first]))
    flat = (
        solid[first]
        & (plane_distance <= FACE_FLAT * tolerance)
        & ((normal[first] * normal[second]).sum(axis=1) > 0.9)
    )
    flat &= solid[second]
    face = _components(len(triangles), first[flat], second[flat])
    groups = int(face.max()) + 1
    # the plane of a face has its mean normal and passes through its first corner; its corners must lie in it
    total: Floats = np.stack(
        [np.bincount(face, vector[:, k], minlength=groups) for k in range(3)], axis=1
    )
    unit = total / np.maximum(_size(total), TINY)[:, None]
    base = np.zeros(groups, dtype=np.int64)
    base[face[::-1]] = np.arange(len(triangles))[::-1]
    height = [
        np.abs(((vertices[triangles[:, k]] - a[base[face]]) * unit[face]).sum(axis=1))
        for k in range(3)
    ]
    uneven = (
        np.bincount(face, np.max(height, axis=0) > 2.0 * FACE_FLAT * tolerance, minlength=groups)
        > 0
    )
    inner = np.zeros(3 * len(triangles), dtype=bool)
    inner[edge[face[first] == face[second]]] = True
    outline, counts, simple = _outlines(triangles, face, inner, groups, vertices, unit)
    is_polygon = simple & ~uneven & (_size(total) > 0.0)
    is_polygon &= (counts >= 3) & (counts <= _MOST_CORNERS)
    loose = np.flatnonzero(~is_polygon[face] & solid)
    width = max(int(counts[is_polygon].max(initial=3)), 3)
    outline = np.pad(outline, ((0, 0), (0, max(width - outline.shape[1], 0))))
    place = np.minimum(np.arange(width), counts[is_polygon][:, None] - 1)
    corners = np.concatenate(
        [
            np.take_along_axis(outline[is_polygon], place, axis=1),
            np.pad(triangles[loose], ((0, 0), (0, width - 3)), mode="edge"),
        ]
    )
    return Pieces(
        vertices[corners],
        np.concatenate([counts[is_polygon], np.full(len(loose), 3)]),
        np.concatenate([unit[is_polygon], normal[loose]]),
        np.concatenate([solids.block[base[is_polygon]], solids.block[loose]]),
    )


def _size(vectors: Floats) -> Floats:
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=1)))


def _components(count: int, first: Ints, second: Ints) -> Ints:
    first, second = first.ravel(), second.ravel()
    links = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(count, count))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)


def _merged(
    vertices: Floats, triangles: Ints, block: Ints, first: Ints
) -> tuple[Floats, Ints, Ints, Ints]:
    """Merge the equal vertices of each block, and drop triangles that have a vertex twice."""
    owner = np.repeat(np.arange(len(first) - 1), np.diff(first)).astype(np.float64)
    order = np.lexsort((vertices[:, 2], vertices[:, 1], vertices[:, 0], owner))
    rows = np.column_stack([owner, vertices])[order]
    new = np.ones(len(rows), dtype=bool)
    new[1:] = (rows[1:] != rows[:-1]).any(axis=1)
    index = np.empty(len(rows), dtype=np.int64)
    index[order] = np.cumsum(new) - 1
    triangles = index[triangles]
    is_kept = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    merged = rows[new]
    return (
        np.ascontiguousarray(merged[:, 1:]),
        triangles[is_kept],
        block[is_kept],
        merged[:, 0].astype(np.int64),
    )


def _half_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Return start and end of the half edges: the first of every triangle, then the second, then the third."""
    return triangles.T.ravel(), np.roll(triangles, -1, axis=1).T.ravel()


def _closure_faults(triangles: Ints, block: Ints, count: int, names: Sequence[str]) -> list[Fault]:
    """Return the faults of meshes with edges that do not have exactly one partner of opposite direction."""
    start, end = _half_edges(triangles)
    owner = np.tile(block, 3)
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge_index, times = np.unique(low * count + high, return_inverse=True, return_counts=True)
    forward = np.bincount(edge_index, start < end)
    unpaired, many = times == 1, times > 2
    same_way = (times == 2) & (forward != 1)
    faults = []
    kinds = (
        (unpaired, "is not closed", "edges bound one triangle only"),
        (many, "is not the surface of one body", "edges bound more than two triangles"),
        (same_way, "has triangles turned inward", "edges lie between triangles of opposite sense"),
    )
    for bad, defect, evidence in kinds:
        if bad.any():
            edges = np.bincount(
                owner[bad[edge_index]],
                1.0 / times[edge_index[bad[edge_index]]],
                minlength=len(names),
            )
            faults += [
                Fault(
                    "E216", f"the mesh of {names[k]} {defect}: {round(float(edges[k]))} {evidence}"
                )
                for k in np.flatnonzero(edges).tolist()
            ]
    missing = np.setdiff1d(np.arange(len(names)), block).tolist()
    return faults + [Fault("E227", f"the mesh of {names[k]} encloses no volume") for k in missing]


def _partners(triangles: Ints, count: int) -> tuple[Ints, Ints]:
    """Return pairs of half edges of opposite direction: indices into the half edges."""
    start, end = _half_edges(triangles)
    forward, backward = np.argsort(start * count + end), np.argsort(end * count + start)
    return forward, backward


def _outlines(
    triangles: Ints, face: Ints, inner: Bools, groups: int, vertices: Floats, unit: Floats
) -> tuple[Ints, Ints, Bools]:
    """Return the corners (g, k) of the faces in order, their counts (g,), and whether each is one convex loop (g,)."""
    start, end = _half_edges(triangles)
    rim = np.flatnonzero(~inner)
    rim_face, start, end = np.tile(face, 3)[rim], start[rim], end[rim]
    count = len(vertices)
    key = rim_face * count + start
    order = np.argsort(key)
    rim_face, start, end, key = rim_face[order], start[order], end[order], key[order]
    sizes = np.bincount(rim_face, minlength=groups)
    begin = np.cumsum(sizes) - sizes
    doubled = (
        np.bincount(rim_face[1:][key[1:] == key[:-1]], minlength=groups) > 0
    )  # a rim that touches itself
    following = np.minimum(np.searchsorted(key, rim_face * count + end), len(key) - 1)
    active = np.flatnonzero((sizes >= 3) & ~doubled & (sizes <= 8 * _MOST_CORNERS))
    simple, early = np.zeros(groups, dtype=bool), np.zeros(groups, dtype=bool)
    walk = np.zeros((groups, int(sizes[active].max(initial=3))), dtype=np.int64)
    current = begin[active].copy()
    for step in range(walk.shape[1]):
        is_walking = step < sizes[active]
        walk[active[is_walking], step] = current[is_walking]
        current[is_walking] = following[current[is_walking]]
        closed = is_walking & (current == begin[active])
        simple[active[closed & (sizes[active] == step + 1)]] = True
        early[active[closed & (sizes[active] != step + 1)]] = True  # a hole or a second loop
    simple &= ~early
    row, column = np.nonzero(np.arange(walk.shape[1]) < np.where(simple, sizes, 0)[:, None])
    edge = walk[row, column]
    last = walk[row, np.where(column > 0, column - 1, sizes[row] - 1)]
    along, previous = (
        vertices[end[edge]] - vertices[start[edge]],
        vertices[end[last]] - vertices[start[last]],
    )
    turn = (np.cross(previous, along) * unit[row]).sum(axis=1) / np.maximum(
        _size(previous) * _size(along), TINY
    )
    folds = (turn < -BENT) | ((np.abs(turn) <= BENT) & ((previous * along).sum(axis=1) < 0.0))
    simple[row[folds]] = False
    corner = turn > BENT
    row, vertex = row[corner], start[edge[corner]]
    counts = np.bincount(row, minlength=groups)
    simple &= _turns_once(row, turn[corner], (previous * along).sum(axis=1)[corner], groups)
    outline = np.zeros((groups, int(counts.max(initial=3))), dtype=np.int64)
    outline[row, np.arange(len(row)) - (np.cumsum(counts) - counts)[row]] = vertex
    return outline, counts, simple


def _turns_once(row: Ints, sine: Floats, product: Floats, groups: int) -> Bools:
    """Return whether convex loops go round once: at most three corners of a convex polygon turn by more than 90°."""
    return np.asarray(np.bincount(row, (product < 0.0) & (sine > 0.0), minlength=groups) <= 3)
