"""Bolts in a scene: where each begins and ends, the face that its plate lies on, and rods and plates as triangles."""

import math
from collections.abc import Sequence

import numpy as np

from slopekit.block_scene import Bolts, Shapes
from slopekit.core.arrays import Floats, Ints, cross
from slopekit.design.parts import Bolt
from slopekit.geometry.rays import line_triangle_intersections

_CLEAR = 1e-9  # of the size of the blocks: a head this near to a face lies on it
_SIDES = 12  # of a rod


def placed(bolts: Sequence[Bolt], shapes: Shapes) -> Bolts | None:
    """The bolts of a design that have a head, in a scene; None without any.

    Each belongs to the block that the design names, else to the first that it passes through from its head on.
    """
    kept = [(k, bolt, np.array(bolt.head_m)) for k, bolt in enumerate(bolts, 1) if bolt.head_m is not None]
    if not kept:
        return None
    names = {name: k for k, name in enumerate(shapes.names)}
    solids = shapes.solids
    free = ~shapes.fixed[solids.block]
    corners, owner = solids.vertices[solids.triangles[free]], solids.block[free]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = float(np.ptp(solids.vertices, axis=0).max())
    blocks, ends, plates = [], [], []
    for _, bolt, head in kept:
        way = bolt.toward.vector()
        block, normal, leaves = _through(head, way, corners, normals, owner, size, names.get(bolt.block or "", -1))
        blocks.append(block)
        ends.append(head + (leaves if bolt.length_m is None else bolt.length_m) * way)
        plates.append(-way if normal is None else normal)
    return Bolts(
        np.array([k for k, _, _ in kept]), np.array(blocks), np.array([head for _, _, head in kept]), np.array(ends),
        np.array(plates), np.array([bolt.acts == "passive" for _, bolt, _ in kept]),
        np.array([bolt.force_kn for _, bolt, _ in kept]),
        np.array([math.nan if bolt.length_m is None else bolt.length_m for _, bolt, _ in kept]),
    )  # fmt: skip


def _through(
    head: Floats, way: Floats, corners: Floats, normals: Floats, owner: Ints, size: float, own: int
) -> tuple[int, Floats | None, float]:
    """What a bolt passes through: its block (-1: none), the normal (3,) where it enters, how far off it leaves, m.

    Parameters
    ----------
    corners : (t, 3, 3) and normals : (t, 3) of the triangles of the blocks `owner` (t,); own : the block that is
        known to be its own, -1 for none; size : m
    """
    at, met = line_triangle_intersections(head, way, corners)
    into = (normals[met] @ way) < 0.0
    first: dict[int, float] = {}
    for block in np.unique(owner[met]).tolist() if own < 0 else [own]:
        mine = owner[met] == block
        if (at[mine] > _CLEAR * size).any():
            first[block] = max(float(at[mine].min()), 0.0)
    if not first:
        return own, None, 0.0
    block = min(first, key=lambda one: (first[one] > _CLEAR * size) * first[one])
    mine = owner[met] == block
    beyond = at[mine & ~into & (at > first[block] + _CLEAR * size)]
    enters = np.flatnonzero(mine & into)
    leaves = float(beyond.min()) if len(beyond) else float(at[mine].max())
    if len(enters) == 0:
        return block, None, leaves
    normal = normals[met[enters[np.argmin(np.abs(at[enters]))]]]
    return block, normal / math.sqrt(float(normal @ normal)), leaves


def nearest(points: Floats) -> float:
    """The least distance between two of the points (n, 3) that are not the same, m; inf where there are none."""
    from scipy.spatial import cKDTree

    own = np.unique(points, axis=0)
    return float(cKDTree(own).query(own, k=2)[0][:, 1].min()) if len(own) > 1 else math.inf


# -- as triangles -----------------------------------------------------------------------------------------------------


def rods(heads: Floats, ends: Floats, radius: float) -> tuple[Floats, Ints]:
    """Round rods (b) from `heads` (b, 3) to `ends` (b, 3), m: vertices and triangles, closed.

    The last two vertices of each rod are the middles of its ends: its head and its end.

    >>> vertices, triangles = rods(np.zeros((1, 3)), np.array([[0.0, 0.0, 4.0]]), 0.05)
    >>> vertices[-2:].tolist()
    [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0]]
    """
    far = np.sqrt(((ends - heads) ** 2).sum(axis=1))
    return revolved(heads, ends, np.stack([np.zeros_like(far), far], axis=1), np.full((len(far), 2), radius))


def revolved(starts: Floats, ends: Floats, along: Floats, radii: Floats) -> tuple[Floats, Ints]:
    """Bodies of revolution (b) between `starts` and `ends` (b, 3), m: vertices and triangles, closed.

    Rings of `radii` (b, s) at the distances `along` (b, s) from the start; cones close them to the two ends, which are
    the last two vertices of each body.
    """
    axis, u, v = _axes(ends - starts)
    angle = np.arange(_SIDES) * (2.0 * math.pi / _SIDES)
    spokes = np.cos(angle)[None, :, None] * u[:, None, :] + np.sin(angle)[None, :, None] * v[:, None, :]
    middles = starts[:, None, :] + along[:, :, None] * axis[:, None, :]
    rings = middles[:, :, None, :] + radii[:, :, None, None] * spokes[:, None, :, :]
    count, stations = along.shape
    points = np.concatenate([rings.reshape(count, -1, 3), starts[:, None, :], ends[:, None, :]], axis=1)
    n, here = _SIDES, np.arange(_SIDES)
    after, last = (here + 1) % n, n * (stations - 1)
    faces = [(after, here, np.full(n, n * stations)), (here + last, after + last, np.full(n, n * stations + 1))]
    for first in range(0, last, n):
        faces += [(here + first, after + first, here + first + n), (after + first, after + first + n, here + first + n)]
    return _each(points, np.concatenate([np.stack(three, axis=1) for three in faces]))


def plates(heads: Floats, normals: Floats, edge: float) -> tuple[Floats, Ints]:
    """Square plates (b) at `heads` (b, 3), their faces square to `normals` (b, 3), `edge` m wide: closed boxes."""
    out, u, v = _axes(normals)
    half, thick = 0.5 * edge, 0.2 * edge
    square = half * np.stack([u + v, v - u, -u - v, u - v], axis=1)
    base = heads[:, None, :] + square
    points = np.concatenate([base, base + thick * out[:, None, :]], axis=1)
    sides = [(k, (k + 1) % 4, k + 4) for k in range(4)] + [((k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)]
    return _each(points, np.array([(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), *sides]))


def _axes(ways: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors (b, 3) along `ways` (b, 3), and two square to each, right-handed."""
    lengths = np.sqrt((ways * ways).sum(axis=1))
    along = np.where(lengths[:, None] > 0.0, ways / np.where(lengths > 0.0, lengths, 1.0)[:, None], [0.0, 0.0, 1.0])
    other = np.where(np.abs(along[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    u = cross(other, along)
    u /= np.sqrt((u * u).sum(axis=1))[:, None]
    return along, u, cross(along, u)


def _each(points: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Points (b, k, 3) of bodies that all have the same triangles, as one set."""
    count, size = points.shape[:2]
    return points.reshape(-1, 3), (np.arange(count)[:, None, None] * size + triangles).reshape(-1, 3)
