"""Bolts in a scene: where each begins and ends, the face that its plate lies on, and rods and plates as triangles."""

import math
from collections.abc import Sequence

import numpy as np

from slopekit.block_scene import Bolts, Shapes
from slopekit.core.arrays import Floats, Ints, cross
from slopekit.design.parts import Bolt
from slopekit.geometry.rays import line_triangle_intersections

_ON_FACE_TOLERANCE = 1e-9  # of the size of the blocks: a head this near to a face lies on it
_ROD_SIDES = 12  # of a rod


def bolts_with_heads(bolts: Sequence[Bolt], shapes: Shapes) -> Bolts | None:
    """The bolts of a design that have a head, in a scene; None without any.

    Each belongs to the block that the design names, else to the first that it passes through from its head on.
    """
    headed_bolts = [
        (k, bolt, np.array(bolt.head_m))
        for k, bolt in enumerate(bolts, 1)
        if bolt.head_m is not None
    ]
    if not headed_bolts:
        return None
    names = {name: k for k, name in enumerate(shapes.names)}
    solids = shapes.solids
    free = ~shapes.fixed[solids.block]
    corners, owner = solids.vertices[solids.triangles[free]], solids.block[free]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = float(np.ptp(solids.vertices, axis=0).max())
    blocks, ends, plates = [], [], []
    for _, bolt, head in headed_bolts:
        direction = bolt.toward.vector()
        block, normal, exit_distance = _block_crossing(
            head, direction, corners, normals, owner, size, names.get(bolt.block or "", -1)
        )
        blocks.append(block)
        ends.append(head + (exit_distance if bolt.length_m is None else bolt.length_m) * direction)
        plates.append(-direction if normal is None else normal)
    return Bolts(
        np.array([k for k, _, _ in headed_bolts]),
        np.array(blocks),
        np.array([head for _, _, head in headed_bolts]),
        np.array(ends),
        np.array(plates),
        np.array([bolt.acts == "passive" for _, bolt, _ in headed_bolts]),
        np.array([bolt.force_kn for _, bolt, _ in headed_bolts]),
        np.array(
            [math.nan if bolt.length_m is None else bolt.length_m for _, bolt, _ in headed_bolts]
        ),
    )


def _block_crossing(
    head: Floats,
    direction: Floats,
    corners: Floats,
    normals: Floats,
    owner: Ints,
    size: float,
    design_block: int,
) -> tuple[int, Floats | None, float]:
    """Return the block that a bolt crosses (-1: none), the normal (3,) where it enters, and the exit distance, m.

    Parameters
    ----------
    corners : (t, 3, 3) and normals : (t, 3) of the triangles of the blocks `owner` (t,)
    design_block : the block that the design names for the bolt, -1 for none; size : m
    """
    distances, crossed = line_triangle_intersections(head, direction, corners)
    is_entry = (normals[crossed] @ direction) < 0.0
    first: dict[int, float] = {}
    for block in np.unique(owner[crossed]).tolist() if design_block < 0 else [design_block]:
        on_block = owner[crossed] == block
        if (distances[on_block] > _ON_FACE_TOLERANCE * size).any():
            first[block] = max(float(distances[on_block].min()), 0.0)
    if not first:
        return design_block, None, 0.0
    block = min(
        first,
        key=lambda candidate: (first[candidate] > _ON_FACE_TOLERANCE * size) * first[candidate],
    )
    on_block = owner[crossed] == block
    exit_distances = distances[
        on_block & ~is_entry & (distances > first[block] + _ON_FACE_TOLERANCE * size)
    ]
    entries = np.flatnonzero(on_block & is_entry)
    exit_distance = (
        float(exit_distances.min()) if len(exit_distances) else float(distances[on_block].max())
    )
    if len(entries) == 0:
        return block, None, exit_distance
    normal = normals[crossed[entries[np.argmin(np.abs(distances[entries]))]]]
    return block, normal / math.sqrt(float(normal @ normal)), exit_distance


def nearest(points: Floats) -> float:
    """The least distance between two of the points (n, 3) that are not the same, m; inf where there are none."""
    from scipy.spatial import cKDTree

    distinct = np.unique(points, axis=0)
    return (
        float(cKDTree(distinct).query(distinct, k=2)[0][:, 1].min())
        if len(distinct) > 1
        else math.inf
    )


# -- as triangles -----------------------------------------------------------------------------------------------------


def rods(heads: Floats, ends: Floats, radius: float) -> tuple[Floats, Ints]:
    """Round rods (b) from `heads` (b, 3) to `ends` (b, 3), m: vertices and triangles, closed.

    The last two vertices of each rod are the middles of its ends: its head and its end.

    >>> vertices, triangles = rods(np.zeros((1, 3)), np.array([[0.0, 0.0, 4.0]]), 0.05)
    >>> vertices[-2:].tolist()
    [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0]]
    """
    lengths = np.sqrt(((ends - heads) ** 2).sum(axis=1))
    return revolved(
        heads,
        ends,
        np.stack([np.zeros_like(lengths), lengths], axis=1),
        np.full((len(lengths), 2), radius),
    )


def revolved(starts: Floats, ends: Floats, along: Floats, radii: Floats) -> tuple[Floats, Ints]:
    """Bodies of revolution (b) between `starts` and `ends` (b, 3), m: vertices and triangles, closed.

    Rings of `radii` (b, s) at the distances `along` (b, s) from the start; cones close them to the two ends, which are
    the last two vertices of each body.
    """
    axis, u, v = _axes(ends - starts)
    angle = np.arange(_ROD_SIDES) * (2.0 * math.pi / _ROD_SIDES)
    spokes = (
        np.cos(angle)[None, :, None] * u[:, None, :] + np.sin(angle)[None, :, None] * v[:, None, :]
    )
    middles = starts[:, None, :] + along[:, :, None] * axis[:, None, :]
    rings = middles[:, :, None, :] + radii[:, :, None, None] * spokes[:, None, :, :]
    count, stations = along.shape
    points = np.concatenate(
        [rings.reshape(count, -1, 3), starts[:, None, :], ends[:, None, :]], axis=1
    )
    n, corner = _ROD_SIDES, np.arange(_ROD_SIDES)
    next_corner, last = (corner + 1) % n, n * (stations - 1)
    faces = [
        (next_corner, corner, np.full(n, n * stations)),
        (corner + last, next_corner + last, np.full(n, n * stations + 1)),
    ]
    for first in range(0, last, n):
        faces += [
            (corner + first, next_corner + first, corner + first + n),
            (next_corner + first, next_corner + first + n, corner + first + n),
        ]
    return _repeated_triangles(
        points, np.concatenate([np.stack(triangle, axis=1) for triangle in faces])
    )


def plates(heads: Floats, normals: Floats, edge: float) -> tuple[Floats, Ints]:
    """Square plates (b) at `heads` (b, 3), their faces square to `normals` (b, 3), `edge` m wide: closed boxes."""
    normal, u, v = _axes(normals)
    half, thick = 0.5 * edge, 0.2 * edge
    square = half * np.stack([u + v, v - u, -u - v, u - v], axis=1)
    base = heads[:, None, :] + square
    points = np.concatenate([base, base + thick * normal[:, None, :]], axis=1)
    sides = [(k, (k + 1) % 4, k + 4) for k in range(4)] + [
        ((k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)
    ]
    return _repeated_triangles(
        points, np.array([(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), *sides])
    )


def _axes(directions: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors (b, 3) along `directions` (b, 3), and two square to each, right-handed."""
    lengths = np.sqrt((directions * directions).sum(axis=1))
    along = np.where(
        lengths[:, None] > 0.0,
        directions / np.where(lengths > 0.0, lengths, 1.0)[:, None],
        [0.0, 0.0, 1.0],
    )
    reference = np.where(np.abs(along[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    u = cross(reference, along)
    u /= np.sqrt((u * u).sum(axis=1))[:, None]
    return along, u, cross(along, u)


def _repeated_triangles(points: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Points (b, k, 3) of bodies that all have the same triangles, as one set."""
    count, size = points.shape[:2]
    return points.reshape(-1, 3), (np.arange(count)[:, None, None] * size + triangles).reshape(
        -1, 3
    )
