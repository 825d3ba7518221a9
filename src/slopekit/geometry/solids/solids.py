"""The user's own blocks as closed meshes: where they touch, overlap, or nearly touch.

Flat faces of two blocks that look at each other in one plane share a contact: their overlap, clipped in that plane,
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
from slopekit.geometry.sections.clipping import clip_convex, polygon_sums, without_near
from slopekit.geometry.solids.solid_faces import ClosedMeshes, Pieces, clean_solids, convex_faces
from slopekit.geometry.tolerances import DOUBT, NEARLY_TOUCHES, OPPOSITE, TINY

_AT_ONCE = 100_000  # pairs of faces clipped in one go: bounds the memory
_MOST_SUPPORTS = 100_000  # faces times vertices of a block whose faces are tried as separating planes


def mesh_assembly(
    meshes: Sequence[tuple[Floats, Ints]], fixed: Bools, tolerance: float | None = None,
    names: Sequence[str] | None = None, corner_rounding: float = 0.0,
) -> BlocksCut:  # fmt: skip
    """The blocks of closed meshes and their contacts.

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
    called = list(names) if names is not None else [f"block {k + 1}" for k in range(len(meshes))]
    solids, usual = clean_solids(meshes, tolerance, called)
    bedrock = np.asarray(fixed, dtype=bool)
    pieces = convex_faces(solids, usual)
    a, b, c = (solids.vertices[solids.triangles[:, k]] for k in range(3))
    surfaces = np.bincount(solids.block, np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1))) / 2.0
    sizes = np.cbrt(solids.volumes)
    reach = NEARLY_TOUCHES * float(sizes.mean())
    widest = widest_rounding(sizes, 2.0 * solids.volumes / surfaces)
    faced = _facing(pieces, bedrock, max(reach, DOUBT * max(usual, widest)), usual)
    movable = ~bedrock[faced.plus] | ~bedrock[faced.minus]
    rounding = corner_rounding if tolerance is None else 0.0
    contact = fitting_tolerance(usual, rounding, 3, widest, faced, movable)
    tolerance = contact.distance
    patches = _patches(faced, faced.touches(tolerance, tolerance), solids.origin)
    near = movable & faced.nearly_touches(tolerance, reach)
    overlaps, unchecked = _overlaps(solids, pieces, bedrock, tolerance)
    assembly = Assembly(
        frozen(solids.volumes), frozen(solids.centroids + solids.origin), bedrock, patches, False,
        frozen(solids.vertices + solids.origin), solids.triangles, solids.block,
    )  # fmt: skip
    return BlocksCut(
        assembly,
        contact,
        float(patches.areas.sum()),
        overlaps,
        Misfits(faced.pairs[near], frozen(faced.areas[near]), frozen(faced.most[near])),
        shells=solids.shells,
        unchecked=unchecked,
    )


@dataclass(frozen=True)
class _FacingFaces(Facing):
    """Pairs of faces that look at each other: what they share, in the plane halfway between them.

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


def _facing(pieces: Pieces, fixed: Bools, reach: float, tolerance: float) -> _FacingFaces:
    first, second = box_pairs(pieces.corners.min(axis=1) - reach / 2.0, pieces.corners.max(axis=1) + reach / 2.0)
    wanted = pieces.block[first] != pieces.block[second]
    first, second = first[wanted], second[wanted]
    wanted = (pieces.normals[first] * pieces.normals[second]).sum(axis=1) < OPPOSITE
    first, second = first[wanted], second[wanted]
    a, b = pieces.block[first], pieces.block[second]
    turned = np.where(fixed[a] == fixed[b], a > b, ~fixed[a])
    plus, minus = np.where(turned, first, second), np.where(turned, second, first)
    order = np.lexsort((pieces.block[plus], pieces.block[minus]))
    parts = [
        _shared(pieces, plus[order[k : k + _AT_ONCE]], minus[order[k : k + _AT_ONCE]], reach, tolerance)
        for k in range(0, max(len(order), 1), _AT_ONCE)
    ]
    width = max(part.corners.shape[1] for part in parts)
    corners = [np.pad(part.corners, ((0, 0), (0, width - part.corners.shape[1]), (0, 0))) for part in parts]

    names = [own.name for own in fields(_FacingFaces) if own.name != "corners"]
    together = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return _FacingFaces(corners=np.concatenate(corners), **together)


def _shared(pieces: Pieces, plus: Ints, minus: Ints, reach: float, tolerance: float) -> _FacingFaces:
    # of the larger face above all: rounding of its corners turns it less
    by_area = pieces.areas()[:, None] * pieces.normals
    normal = by_area[minus] - by_area[plus]
    normal /= np.sqrt((normal * normal).sum(axis=1))[:, None]
    base = pieces.corners[minus, 0]
    # faces that lie beside each other in parallel planes farther apart than what is reported
    far = np.einsum("nki,ni->nk", pieces.corners[plus] - base[:, None], normal)
    wanted = (far.min(axis=1) <= reach) & (far.max(axis=1) >= -reach)
    plus, minus, normal, base = plus[wanted], minus[wanted], normal[wanted], base[wanted]
    other = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    across = np.cross(other, normal)
    across /= np.sqrt((across * across).sum(axis=1))[:, None]
    axes = np.stack([across, np.cross(normal, across)], axis=2)
    lower = (pieces.corners[minus] - base[:, None]) @ axes
    upper = ((pieces.corners[plus] - base[:, None]) @ axes)[:, ::-1]  # seen from the other side
    corners, counts = clip_convex(lower, pieces.counts[minus], upper)
    areas, centres, around = polygon_sums(corners, counts)
    width = areas / np.maximum(around / 2.0, TINY)
    kept = (counts >= 3) & (width > tolerance)
    plus, minus, normal, base, axes = plus[kept], minus[kept], normal[kept], base[kept], axes[kept]
    areas, centres, width = areas[kept], centres[kept], width[kept]
    corners, counts = without_near(corners[kept], counts[kept], 1e-3 * tolerance)
    points = corners @ axes.transpose(0, 2, 1)

    def height(piece: Ints, point: Floats) -> Floats:
        """How far a face lies along `normal` from the points (n, k, 3)."""
        step = (pieces.corners[piece, 0] - base)[:, None] - point
        own = pieces.normals[piece]
        away: Floats = np.einsum("nki,ni->nk", step, own) / (own * normal).sum(axis=1)[:, None]
        return away

    above, below = height(plus, points), height(minus, points)
    there = np.arange(corners.shape[1]) < counts[:, None]
    apart = above - below
    middle = np.einsum("nij,nj->ni", axes, centres)[:, None]
    centroids = middle + ((height(plus, middle) + height(minus, middle)) / 2.0)[:, :, None] * normal[:, None]
    points = points + ((above + below) / 2.0)[:, :, None] * normal[:, None] + base[:, None]
    return _FacingFaces(
        pieces.block[plus], pieces.block[minus], np.where(there, apart, np.inf).min(axis=1),
        np.where(there, apart, -np.inf).max(axis=1), width, normal, points, counts, areas, centroids[:, 0] + base,
    )  # fmt: skip


def _patches(faced: _FacingFaces, touches: Bools, origin: Floats) -> Patches:
    counts = faced.counts[touches]
    corners = faced.corners[touches][np.arange(faced.corners.shape[1]) < counts[:, None]]
    return Patches(
        faced.plus[touches], faced.minus[touches], np.zeros(len(counts), dtype=np.int64),
        frozen(faced.normals[touches]), frozen(faced.areas[touches]), frozen(faced.centroids[touches] + origin),
        frozen(corners + origin), np.concatenate([[0], np.cumsum(counts)]),
    )  # fmt: skip


def _overlaps(solids: ClosedMeshes, pieces: Pieces, fixed: Bools, tolerance: float) -> tuple[Misfits, Ints]:
    """Volumes that pairs of blocks share, and the pairs for which there is none to be had."""
    count = len(fixed)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, solids.vertex_block, solids.vertices)
    np.maximum.at(high, solids.vertex_block, solids.vertices)
    low, high = low + tolerance / 2.0, high - tolerance / 2.0
    first, second = box_pairs(low, np.maximum(low, high))
    wanted = ~(fixed[first] & fixed[second])
    first, second = first[wanted], second[wanted]
    supports = _supports(solids, pieces, tolerance)
    for here, there in ((0, 1), (1, 0)):
        pair = (first, second)
        apart = _behind(solids, pieces, supports, pair[here], pair[there], tolerance)
        first, second = first[~apart], second[~apart]
    bodies = {int(k): _manifold(solids, int(k)) for k in np.unique(np.concatenate([first, second]))}
    overlapping, unchecked = [], []
    for a, b in sorted(zip(first.tolist(), second.tolist(), strict=True)):
        one, two = bodies[a], bodies[b]
        if one is None or two is None:
            unchecked.append((a, b))
            continue
        shared = one ^ two
        volume, surface = float(shared.volume()), float(shared.surface_area())
        depth = volume / (surface / 2.0) if surface > 0.0 else 0.0
        if depth > tolerance:
            overlapping.append((a, b, volume, depth))
    table = np.array(overlapping, dtype=np.float64).reshape(-1, 4)
    failed: Ints = np.array(unchecked, dtype=np.int64).reshape(-1, 2)
    return Misfits(table[:, :2].astype(np.int64), frozen(table[:, 2]), frozen(table[:, 3])), failed


def _supports(solids: ClosedMeshes, pieces: Pieces, tolerance: float) -> Ints:
    """Faces that have all of their block behind them, in the order of the blocks."""
    vertices, sizes = _block_rows(solids.vertex_block, len(solids.volumes))
    cost = np.bincount(pieces.block, minlength=len(sizes)) * sizes
    order = np.argsort(pieces.block, kind="stable")
    order = order[cost[pieces.block[order]] <= _MOST_SUPPORTS]
    block = pieces.block[order]
    row, vertex = ragged(vertices[block], sizes[block])
    face = order[row]
    out = ((solids.vertices[vertex] - pieces.corners[face, 0]) * pieces.normals[face]).sum(axis=1)
    return np.asarray(order[np.bincount(row, out > tolerance, minlength=len(order)) == 0], dtype=np.int64)


def _behind(solids: ClosedMeshes, pieces: Pieces, supports: Ints, own: Ints, other: Ints, tolerance: float) -> Bools:
    """Whether block `other` lies wholly in front of some face behind which all of block `own` lies."""
    apart = np.zeros(len(own), dtype=bool)
    faces, face_counts = _block_rows(pieces.block[supports], len(solids.volumes))
    vertices, sizes = _block_rows(solids.vertex_block, len(solids.volumes))
    for part in chunks(face_counts[own] * sizes[other]):
        pair, support = ragged(faces[own[part]], face_counts[own[part]])
        face, block = supports[support], other[part][pair]
        row, vertex = ragged(vertices[block], sizes[block])
        out = ((solids.vertices[vertex] - pieces.corners[face[row], 0]) * pieces.normals[face[row]]).sum(axis=1)
        clear = np.bincount(row, out < -tolerance, minlength=len(face)) == 0
        apart[part] = np.bincount(pair, clear, minlength=len(apart[part])) > 0
    return apart


def _block_rows(block: Ints, count: int) -> tuple[Ints, Ints]:
    """Where the entries of each block begin in a sorted list of blocks, and how many there are."""
    sizes = np.bincount(block, minlength=count)
    return np.cumsum(sizes) - sizes, sizes


def _manifold(solids: ClosedMeshes, block: int) -> Manifold | None:
    own = slice(*np.searchsorted(solids.block, [block, block + 1]).tolist())
    used, corners = np.unique(solids.triangles[own], return_inverse=True)
    mesh = Mesh64(np.ascontiguousarray(solids.vertices[used]), corners.reshape(-1, 3).astype(np.uint64))
    body = Manifold(mesh)
    return body if body.status() == Error.NoError else None
