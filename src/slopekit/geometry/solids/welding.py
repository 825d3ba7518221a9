"""Surfaces of blocks made up of several cells, closed: the corners that cells have in common become one."""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.geometry.tolerances import SAME_CORNER


def open_edges(triangles: Ints, block: Ints) -> tuple[Ints, Ints]:
    """Edges (e, 2) that run more often one way than the other round the triangles of their block, and the blocks (e,).

    A closed surface, each triangle anticlockwise seen from outside, has none.

    >>> tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> open_edges(tetrahedron, np.zeros(4, int))[0].tolist()
    []
    >>> open_edges(tetrahedron[1:], np.zeros(3, int))[0].tolist()
    [[0, 1], [1, 2], [2, 0]]
    """
    corners = triangles.astype(np.int64)
    start, end = corners.ravel(), corners[:, [1, 2, 0]].ravel()
    of = np.repeat(block.astype(np.int64), 3)
    count = int(corners.max(initial=0)) + 1
    low, high = np.minimum(start, end), np.maximum(start, end)
    key, at = np.unique((of * count + low) * count + high, return_inverse=True)
    balance = np.bincount(at.ravel(), np.where(start < end, 1.0, -1.0), len(key))
    key, forward = key[balance != 0.0], balance[balance != 0.0] > 0.0
    low, high = key // count % count, key % count
    ends = np.stack([np.where(forward, low, high), np.where(forward, high, low)], axis=1)
    return ends[np.lexsort((ends[:, 1], ends[:, 0]))], key // count // count


def welded(vertices: Floats, triangles: Ints, block: Ints) -> tuple[Floats, Ints, Ints]:
    """The same surfaces with those of the blocks closed that were not.

    Corners of open edges nearer than 1e-6 of the block's size become one, and what then lies on itself goes. Closed
    blocks stay as they are, triangle by triangle.

    Parameters
    ----------
    vertices : (v, 3); triangles : (t, 3); block : (t,) whose they are
    """
    _, wanting = open_edges(triangles, block)
    if not len(wanting):
        return vertices, triangles, block
    wrong = np.isin(block, wanting)
    kept, of = [triangles[~wrong]], [block[~wrong]]
    for one in np.unique(wanting).tolist():
        used, local = np.unique(triangles[block == one], return_inverse=True)
        own = _closed(vertices[used], local.reshape(-1, 3))
        kept.append(used[own])
        of.append(np.full(len(own), one))
    closed_triangles = np.concatenate(kept)
    used, index = np.unique(closed_triangles, return_inverse=True)
    owner = np.concatenate(of)
    order = np.argsort(owner, kind="stable")
    return vertices[used], index.reshape(-1, 3)[order], owner[order]


def _closed(points: Floats, triangles: Ints) -> Ints:
    """The triangles of one block, the corners at its open edges merged."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    near = SAME_CORNER * float(np.ptp(points, axis=0).max())
    rim = np.unique(open_edges(triangles, np.zeros(len(triangles), dtype=np.int64))[0])
    pairs = rim[cKDTree(points[rim]).query_pairs(near, output_type="ndarray")]
    graph = coo_array((np.ones(len(pairs), dtype=np.bool_), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    groups, group = connected_components(graph, directed=False)
    first = np.full(groups, len(points))
    np.minimum.at(first, group, np.arange(len(points)))
    return _sound(first[group][triangles])


def _sound(triangles: Ints) -> Ints:
    """Without triangles that have lost their area, and without pairs that are each other's backs."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    low = triangles.argmin(axis=1)
    turned = triangles[np.arange(len(triangles))[:, None], (low[:, None] + np.arange(3)) % 3]
    back = turned[:, [0, 2, 1]]
    index = {tuple(one): k for k, one in enumerate(turned.tolist())}
    gone = {k for k, one in enumerate(back.tolist()) if index.get(tuple(one)) is not None}
    return triangles[[k for k in range(len(triangles)) if k not in gone]]
