"""Blocks of the user as closed meshes: their contacts, overlaps and gaps.

Opposite flat faces of two blocks in one plane share a contact: their overlap, clipped in that plane,
is a patch (or several, where a face is not convex). Candidates come from the boxes of the faces (`box_search`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.geometry.fit import BlocksCut, Facing, Misfits, fitting_tolerance, widest_rounding
from slopekit.geometry.patches import Assembly, Patches
from slopekit.geometry.rock.box_search import box_pairs, chunks, ragged
from slopekit.geometry.sections.clipping import clip_convex, polygon_sums, without_repeated_corners
from slopekit.geometry.solids.solid_faces import ClosedMeshes, Pieces, clean_solids, convex_faces
from slopekit.geometry.tolerances import DOUBT, NEARLY_TOUCHES, OPPOSITE, TINY

_CHUNK_SIZE = 100_000  # pairs of faces clipped at once: bounds the memory
_MOST_SUPPORTS = (
    100_000  # faces times vertices of a block whose faces are tried as separating planes
)


def mesh_assembly(
    meshes: Sequence[tuple[Floats, Ints]],
    fixed: Bools,
    tolerance: float | None = None,
    names: Sequence[str] | None = None,
    corner_rounding: float = 0.0,
) -> BlocksCut:
    """Return the blocks of closed meshes and their contacts.

    Parameters
    ----------
    meshes : vertices (v, 3) in m and triangles (t, 3) of each block
    fixed : (n,) blocks that are bedrock
    tolerance : m, faces nearer than this touch; None for 1e-5 of the mean size (cube root of the volume) of the
        blocks, or √3 times `corner_rounding` where that loses contacts
    names : of the blocks, for messages
    corner_rounding : m, the unit to which the vertices are rounded, 0 where they are exact

    Raises
    ------
    GeometryError
        E227 a mesh encloses no volume, E216 it is not closed or some of its triangles are turned inward, E230 the
        tolerance is as large as a block.
    """
    block_names = (
        list(names) if names is not None else [f"block {k + 1}" for k in range(len(meshes))]
    )
    solids, exact_tolerance = clean_solids(meshes, tolerance, block_names)
    bedrock = np.asarray(fixed, dtype=bool)
    pieces = convex_faces(solids, exact_tolerance)
    a, b, c = (solids.vertices[solids.triangles[:, k]] for k in range(3))
    surfaces = np.bincount(solids.block, np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1))) / 2.0
    sizes = np.cbrt(solids.volumes)
    reach = NEARLY_TOUCHES * float(sizes.mean())
    widest = widest_rounding(sizes, 2.0 * solids.volumes / surfaces)
    facing = _facing_faces(
        pieces, bedrock, max(reach, DOUBT * max(exact_tolerance, widest)), exact_tolerance
    )
    movable = ~bedrock[facing.plus] | ~bedrock[facing.minus]
    rounding = corner_rounding if tolerance is None else 0.0
    contact = fitting_tolerance(exact_tolerance, rounding, 3, widest, facing, movable)
    tolerance = contact.distance
    patches = _patches(facing, facing.touches(tolerance, tolerance), solids.origin)
    is_gap = movable & facing.nearly_touches(tolerance, reach)
    overlaps, unchecked = _overlaps(solids, pieces, bedrock, tolerance)
    assembly = Assembly(
        frozen(solids.volumes),
        frozen(solids.centroids + solids.origin),
        bedrock,
        patches,
        False,
        frozen(solids.vertices + solids.origin),
        solids.triangles,
        solids.block,
    )
    return BlocksCut(
        assembly,
        contact,
        float(patches.areas.sum()),
        overlaps,
        Misfits(facing.pairs[is_gap], frozen(facing.areas[is_gap]), frozen(facing.most[is_gap])),
        shells=solids.shells,
        unchecked=unchecked,
    )


@dataclass(frozen=True)
class _FacingFaces(Facing):
    """Pairs of opposite faces of two blocks, with the polygon that they share in the plane halfway between them.

    Attributes
    ----------
    normals : (n, 3) unit, into the plus block
    corners : (n, k, 3) m, anticlockwise about the normal; counts : (n,) how many of the k
    areas : (n,) m²; centroids : (n, 3) m
    """

    normals: Floats
    corners: Floats
    counts: Ints
    areas: Floats
    centroids: Floats


def _facing_faces(pieces: Pieces, fixed: Bools, reach: float, tolerance: float) -> _FacingFaces:
    first, second = box_pairs(
        pieces.corners.min(axis=1) - reach / 2.0, pieces.corners.max(axis=1) + reach / 2.0
    )
    is_candidate = pieces.block[first] != pieces.block[second]
    first, second = first[is_candidate], second[is_candidate]
    is_candidate = (pieces.normals[first] * pieces.normals[second]).sum(axis=1) < OPPOSITE
    first, second = first[is_candidate], second[is_candidate]
    a, b = pieces.block[first], pieces.block[second]
    is_first_plus = np.where(fixed[a] == fixed[b], a > b, ~fixed[a])
    plus, minus = np.where(is_first_plus, first, second), np.where(is_first_plus, second, first)
    order = np.lexsort((pieces.block[plus], pieces.block[minus]))
    chunks_of_faces = [
        _shared_polygons(
            pieces,
            plus[order[k : k + _CHUNK_SIZE]],
            minus[order[k : k + _CHUNK_SIZE]],
            reach,
            tolerance,
        )
        for k in range(0, max(len(order), 1), _CHUNK_SIZE)
    ]
    width = max(chunk.corners.shape[1] for chunk in chunks_of_faces)
    corners = [
        np.pad(chunk.corners, ((0, 0), (0, width - chunk.corners.shape[1]), (0, 0)))
        for chunk in chunks_of_faces
    ]

    names = [entry.name for entry in fields(_FacingFaces) if entry.name != "corners"]
    joined = {
        name: np.concatenate([getattr(chunk, name) for chunk in chunks_of_faces]) for name in names
    }
    return _FacingFaces(corners=np.concatenate(corners), **joined)


def _shared_polygons(
    pieces: Pieces, plus: Ints, minus: Ints, reach: float, tolerance: float
) -> _FacingFaces:
    # rounding of the corners turns a larger face less: its normal weighs more
    by_area = pieces.areas()[:, None] * pieces.normals
    normal = by_area[minus] - by_area[plus]
    normal /= np.sqrt((normal * normal).sum(axis=1))[:, None]
    base = pieces.corners[minus, 0]
    # drop faces in parallel planes farther apart than the reach
    heights = np.einsum("nki,ni->nk", pieces.corners[plus] - base[:, None], normal)
    is_candidate = (heights.min(axis=1) <= reach) & (heights.max(axis=1) >= -reach)
    plus, minus, normal, base = (
        plus[is_candidate],
        minus[is_candidate],
        normal[is_candidate],
        base[is_candidate],
    )
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    across = np.cross(axis, normal)
    across /= np.sqrt((across * across).sum(axis=1))[:, None]
    axes = np.stack([across, np.cross(normal, across)], axis=2)
    lower = (pieces.corners[minus] - base[:, None]) @ axes
    upper = ((pieces.corners[plus] - base[:, None]) @ axes)[:, ::-1]  # seen from the other side
    corners, counts = clip_convex(lower, pieces.counts[minus], upper)
    areas, centres, perimeters = polygon_sums(corners, counts)
    width = areas / np.maximum(perimeters / 2.0, TINY)
    is_shared = (counts >= 3) & (width > tolerance)
    plus, minus, normal, base, axes = (
        plus[is_shared],
        minus[is_shared],
        normal[is_shared],
        base[is_shared],
        axes[is_shared],
    )
    areas, centres, width = areas[is_shared], centres[is_shared], width[is_shared]
    corners, counts = without_repeated_corners(
        corners[is_shared], counts[is_shared], 1e-3 * tolerance
    )
    points = corners @ axes.transpose(0, 2, 1)

    def height(piece: Ints, point: Floats) -> Floats:
        """Return the distance (n, k) of a face along `normal` from the points (n, k, 3)."""
        step = (pieces.corners[piece, 0] - base)[:, None] - point
        piece_normal = pieces.normals[piece]
        heights_along: Floats = (
            np.einsum("nki,ni->nk", step, piece_normal)
            / (piece_normal * normal).sum(axis=1)[:, None]
        )
        return heights_along

    above, below = height(plus, points), height(minus, points)
    is_corner = np.arange(corners.shape[1]) < counts[:, None]
    gap = above - below
    middle = np.einsum("nij,nj->ni", axes, centres)[:, None]
    centroids = (
        middle
        + ((height(plus, middle) + height(minus, middle)) / 2.0)[:, :, None] * normal[:, None]
    )
    points = points + ((above + below) / 2.0)[:, :, None] * normal[:, None] + base[:, None]
    return _FacingFaces(
        pieces.block[plus],
        pieces.block[minus],
        np.where(is_corner, gap, np.inf).min(axis=1),
        np.where(is_corner, gap, -np.inf).max(axis=1),
        width,
        normal,
        points,
        counts,
        areas,
        centroids[:, 0] + base,
    )


def _patches(facing: _FacingFaces, touches: Bools, origin: Floats) -> Patches:
    counts = facing.counts[touches]
    corners = facing.corners[touches][np.arange(facing.corners.shape[1]) < counts[:, None]]
    return Patches(
        facing.plus[touches],
        facing.minus[touches],
        np.zeros(len(counts), dtype=np.int64),
        frozen(facing.normals[touches]),
        frozen(facing.areas[touches]),
        frozen(facing.centroids[touches] + origin),
        frozen(corners + origin),
        np.concatenate([[0], np.cumsum(counts)]),
    )


def _overlaps(
    solids: ClosedMeshes, pieces: Pieces, fixed: Bools, tolerance: float
) -> tuple[Misfits, Ints]:
    """Return the overlaps of pairs of blocks, and the pairs (m, 2) whose overlap cannot be computed."""
    count = len(fixed)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, solids.vertex_block, solids.vertices)
    np.maximum.at(high, solids.vertex_block, solids.vertices)
    low, high = low + tolerance / 2.0, high - tolerance / 2.0
    first, second = box_pairs(low, np.maximum(low, high))
    is_candidate = ~(fixed[first] & fixed[second])
    first, second = first[is_candidate], second[is_candidate]
    supports = _supporting_faces(solids, pieces, tolerance)
    for support_side, opposite_side in ((0, 1), (1, 0)):
        pair = (first, second)
        is_separate = _are_separated(
            solids, pieces, supports, pair[support_side], pair[opposite_side], tolerance
        )
        first, second = first[~is_separate], second[~is_separate]
    bodies = {int(k): _manifold(solids, int(k)) for k in np.unique(np.concatenate([first, second]))}
    overlapping, unchecked = [], []
    for a, b in sorted(zip(first.tolist(), second.tolist(), strict=True)):
        body, second_body = bodies[a], bodies[b]
        if body is None or second_body is None:
            unchecked.append((a, b))
            continue
        shared = body ^ second_body
        volume, surface = float(shared.volume()), float(shared.surface_area())
        depth = volume / (surface / 2.0) if surface > 0.0 else 0.0
        if depth > tolerance:
            overlapping.append((a, b, volume, depth))
    table = np.array(overlapping, dtype=np.float64).reshape(-1, 4)
    failed: Ints = np.array(unchecked, dtype=np.int64).reshape(-1, 2)
    return Misfits(table[:, :2].astype(np.int64), frozen(table[:, 2]), frozen(table[:, 3])), failed


def _supporting_faces(solids: ClosedMeshes, pieces: Pieces, tolerance: float) -> Ints:
    """Return the faces with their whole block behind them, in the order of the blocks."""
    vertices, sizes = _block_rows(solids.vertex_block, len(solids.volumes))
    cost = np.bincount(pieces.block, minlength=len(sizes)) * sizes
    order = np.argsort(pieces.block, kind="stable")
    order = order[cost[pieces.block[order]] <= _MOST_SUPPORTS]
    block = pieces.block[order]
    row, vertex = ragged(vertices[block], sizes[block])
    face = order[row]
    heights = ((solids.vertices[vertex] - pieces.corners[face, 0]) * pieces.normals[face]).sum(
        axis=1
    )
    return np.asarray(
        order[np.bincount(row, heights > tolerance, minlength=len(order)) == 0], dtype=np.int64
    )


def _are_separated(
    solids: ClosedMeshes,
    pieces: Pieces,
    supports: Ints,
    supported: Ints,
    opposite: Ints,
    tolerance: float,
) -> Bools:
    """Return whether some face with all of block `supported` behind it has all of block `opposite` in front of it."""
    is_separate = np.zeros(len(supported), dtype=bool)
    faces, face_counts = _block_rows(pieces.block[supports], len(solids.volumes))
    vertices, sizes = _block_rows(solids.vertex_block, len(solids.volumes))
    for chunk in chunks(face_counts[supported] * sizes[opposite]):
        pair, support = ragged(faces[supported[chunk]], face_counts[supported[chunk]])
        face, block = supports[support], opposite[chunk][pair]
        row, vertex = ragged(vertices[block], sizes[block])
        heights = (
            (solids.vertices[vertex] - pieces.corners[face[row], 0]) * pieces.normals[face[row]]
        ).sum(axis=1)
        clear = np.bincount(row, heights < -tolerance, minlength=len(face)) == 0
        is_separate[chunk] = np.bincount(pair, clear, minlength=len(is_separate[chunk])) > 0
    return is_separate


def _block_rows(block: Ints, count: int) -> tuple[Ints, Ints]:
    """Return the first entry of each block in a sorted list of blocks, and the number of its entries."""
    sizes = np.bincount(block, minlength=count)
    return np.cumsum(sizes) - sizes, sizes


def _manifold(solids: ClosedMeshes, block: int) -> Manifold | None:
    triangle_range = slice(*np.searchsorted(solids.block, [block, block + 1]).tolist())
    used, corners = np.unique(solids.triangles[triangle_range], return_inverse=True)
    mesh = Mesh64(
        np.ascontiguousarray(solids.vertices[used]), corners.reshape(-1, 3).astype(np.uint64)
    )
    body = Manifold(mesh)
    return body if body.status() == Error.NoError else None
