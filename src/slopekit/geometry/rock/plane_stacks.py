"""Many planes at once: stacks of slabs that cut a body in two, each half a set of pieces that do not touch.

Planes that do not meet within the body, in order, leave slabs between them. Every second slab, all in one mesh, is a
stack: one split with it does the work of all its planes. After a few splits every piece of a half lies a whole slab
away from the next one, so the pieces are the connected parts of the mesh, and which slab of each stack a piece lies in
says which piece it is.
"""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from manifold3d import Manifold

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.geometry.rock.cutting import BOX_TRIANGLES, far_box, half_space, tagged
from slopekit.geometry.tolerances import LEAST_GAP, LEAST_RISE

_SLAB_WIDTH = 1.05  # the slabs are this much wider than the body


@dataclass(frozen=True)
class Soup:
    """The triangles of all pieces of a cut body; pieces share no vertices.

    Attributes
    ----------
    vertices : (v, 3); triangles : (t, 3) outward; plane : (t,) which plane made each
    half : (t, number of stacks) whether the triangle belongs to a piece in the slabs of the stack or between them
    """

    vertices: Floats
    triangles: Ints
    plane: Ints
    half: Bools


#: Planes that do not meet near the body: (m,) indices from below upward along an axis (3,).
PlaneStack: TypeAlias = tuple[Ints, Floats]


def ascending(normals: Floats, offsets: Floats, groups: Ints) -> tuple[Floats, Floats]:
    """Return the planes with all normals of a group on the same side: those against the mean are reversed."""
    signs = np.ones(len(offsets))
    for group in np.unique(groups):
        members = np.flatnonzero(groups == group)
        signs[members[normals[members] @ _mean_axis(normals[members]) < 0.0]] = -1.0
    return normals * signs[:, None], offsets * signs


def stacks_of_planes(
    normals: Floats, offsets: Floats, groups: Ints, corners: Floats
) -> list[PlaneStack]:
    """Divide planes into stacks of planes that do not meet near the body, greedily: each to the first that takes it.

    Parameters
    ----------
    normals, offsets : (p, 3), (p,) as `ascending` gives them
    groups : (p,) only planes of one group (joint set) come into one stack
    corners : (c, 3) of the body, about the origin

    Returns
    -------
    the stacks, smaller ones first: the last splits cost most, and least when they add most
    """
    stacks: list[PlaneStack] = []
    for group in np.unique(groups):
        members = np.flatnonzero(groups == group)
        axis = _mean_axis(normals[members])
        rise = normals[members] @ axis
        stacks += [
            (members[k : k + 1], normals[members[k]]) for k in np.flatnonzero(rise < LEAST_RISE)
        ]
        members = members[rise >= LEAST_RISE]
        heights = _crossings(normals[members], offsets[members], axis, corners)
        chains: list[list[int]] = []
        for k in np.argsort(heights.mean(axis=1), kind="stable").tolist():
            for chain in chains:
                if float((heights[k] - heights[chain[-1]]).min()) > LEAST_GAP:
                    chain.append(k)
                    break
            else:
                chains.append([k])
        stacks += [(members[np.array(chain)], axis) for chain in chains]
    return sorted(stacks, key=lambda stack: len(stack[0]))


def cut_with_stacks(
    faces: tuple[Floats, Floats],
    normals: Floats,
    offsets: Floats,
    stacks: list[PlaneStack],
    corners: Floats,
) -> tuple[Manifold, Soup]:
    """Cut a convex body with the stacks of planes.

    Parameters
    ----------
    faces : normals (k, 3) and offsets (k,) of the body's own planes; their ids follow those of the p planes
    corners : (c, 3) of the body, within -1 and 1

    Returns
    -------
    the whole body and its pieces
    """
    count = len(offsets)
    back = count + len(faces[1])
    body = far_box(3.0, back)
    for k, (normal, offset) in enumerate(zip(*faces, strict=True)):
        body = body.split(half_space(normal, float(offset), count + k, back))[1]
    pieces: list[tuple[Manifold, int]] = [(body, 0)]
    for k, stack in enumerate(stacks):
        cutter = _cutter(stack, normals, offsets, back, corners)
        halved: list[tuple[Manifold, int]] = []
        for piece, halves in pieces:
            inside, outside = piece.split(cutter)
            if not inside.is_empty():
                halved.append((inside, halves | (1 << k)))
            if not outside.is_empty():
                halved.append((outside, halves))
        pieces = halved
    return body, _soup(pieces, len(stacks))


def _mean_axis(normals: Floats) -> Floats:
    """Return the principal axis (3,) of unit normals, whichever way they point, toward the majority."""
    axis: Floats = np.linalg.eigh(normals.T @ normals)[1][:, 2]
    return axis if float((normals @ axis).sum()) >= 0.0 else -axis


def _frame(axis: Floats, corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Return two directions normal to an axis, along the body, and the corners (4, 2) of a column around the body."""
    flat = corners - np.outer(corners @ axis, axis)
    flat -= flat.mean(axis=0)
    first = np.linalg.svd(flat)[2][0]
    first = first - axis * float(first @ axis)
    first /= math.sqrt(float(first @ first))
    second = np.cross(axis, first)
    across = corners @ np.array([first, second]).T
    low, high = across.min(axis=0), across.max(axis=0)
    centre, half = (low + high) / 2.0, _SLAB_WIDTH * (high - low) / 2.0
    return (
        first,
        second,
        centre + np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half,
    )


def _crossings(normals: Floats, offsets: Floats, axis: Floats, corners: Floats) -> Floats:
    """Return the heights (p, 4) along the axis at which the planes cross the edges of a column around the body."""
    first, second, column = _frame(axis, corners)
    edges = column @ np.array([first, second])
    heights: Floats = (offsets[:, None] - normals @ edges.T) / (normals @ axis)[:, None]
    return heights


def _cutter(
    stack: PlaneStack, normals: Floats, offsets: Floats, back: int, corners: Floats
) -> Manifold:
    """Return every second slab between the planes of a stack, the first above its first plane, as one body."""
    ids, axis = stack
    heights = _crossings(normals[ids], offsets[ids], axis, corners)
    first, second, column = _frame(axis, corners)
    if len(ids) % 2:  # the last slab ends outside the body
        top = max(float(heights.max()), float((corners @ axis).max())) + 1.0
        heights, ids = np.concatenate([heights, np.full((1, 4), top)]), np.append(ids, back)
    points = (column @ np.array([first, second]))[None] + heights[:, :, None] * axis  # (m, 4, 3)
    slabs = len(ids) // 2
    vertices = points.reshape(slabs * 8, 3)
    triangles = (BOX_TRIANGLES[None] + 8 * np.arange(slabs)[:, None, None]).reshape(-1, 3)
    face_ids = np.full((slabs, 12), back)
    face_ids[:, :2], face_ids[:, 2:4] = ids[0::2, None], ids[1::2, None]
    return tagged(vertices, triangles, face_ids.ravel())


def _soup(pieces: list[tuple[Manifold, int]], stacks: int) -> Soup:
    vertices, triangles, planes, halves = [], [], [], []
    shift = 0
    for piece, half in pieces:
        mesh = piece.to_mesh64()
        points = mesh.vert_properties
        vertices.append(points[:, :3])
        triangles.append(mesh.tri_verts + shift)
        planes.append(np.array(mesh.face_id, dtype=np.int64))
        halves.append([bool(half >> k & 1) for k in range(stacks)])
        shift += len(points)
    lengths = [len(piece_planes) for piece_planes in planes]
    return Soup(
        np.concatenate(vertices),
        np.concatenate(triangles).astype(np.int64),
        np.concatenate(planes),
        np.repeat(np.array(halves, dtype=np.bool_).reshape(len(pieces), stacks), lengths, axis=0),
    )
