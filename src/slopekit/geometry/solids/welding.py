"""Closed surfaces of blocks made up of several cells: the common corners of the cells are merged."""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.geometry.tolerances import SAME_CORNER


def open_edges(triangles: Ints, block: Ints) -> tuple[Ints, Ints]:
    """Return the open edges (e, 2) of triangulated blocks and their blocks (e,): they run more often one way than back.

    A closed surface, each triangle anticlockwise seen from outside, has none.

    >>> tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> open_edges(tetrahedron, np.zeros(4, int))[0].tolist()
    []
    >>> open_edges(tetrahedron[1:], np.zeros(3, int))[0].tolist()
    [[0, 1], [1, 2], [2, 0]]
    """
    corners = triangles.astype(np.int64)
    start, end = corners.ravel(), corners[:, [1, 2, 0]].ravel()
    edge_block = np.repeat(block.astype(np.int64), 3)
    count = int(corners.max(initial=0)) + 1
    low, high = np.minimum(start, end), np.maximum(start, end)
    key, edge_index = np.unique((edge_block * count + low) * count + high, return_inverse=True)
    balance = np.bincount(edge_index.ravel(), np.where(start < end, 1.0, -1.0), len(key))
    key, forward = key[balance != 0.0], balance[balance != 0.0] > 0.0
    low, high = key // count % count, key % count
    ends = np.stack([np.where(forward, low, high), np.where(forward, high, low)], axis=1)
    return ends[np.lexsort((ends[:, 1], ends[:, 0]))], key // count // count


def welded(vertices: Floats, triangles: Ints, block: Ints) -> tuple[Floats, Ints, Ints]:
    """Return the surfaces of blocks with the open ones closed.

    Corners of open edges nearer than 1e-6 of the block's size are merged, and triangles that then lie back to back are
    dropped. Closed blocks stay as they are, triangle by triangle.

    Parameters
    ----------
    vertices : (v, 3) m; triangles : (t, 3); block : (t,) the block of each triangle
    """
    _, open_blocks = open_edges(triangles, block)
    if not len(open_blocks):
        return vertices, triangles, block
    is_open = np.isin(block, open_blocks)
    closed_surfaces, owners = [triangles[~is_open]], [block[~is_open]]
    for open_block in np.unique(open_blocks).tolist():
        used, local = np.unique(triangles[block == open_block], return_inverse=True)
        block_triangles = _closed_surface(vertices[used], local.reshape(-1, 3))
        closed_surfaces.append(used[block_triangles])
        owners.append(np.full(len(block_triangles), open_block))
    closed_triangles = np.concatenate(closed_surfaces)
    used, index = np.unique(closed_triangles, return_inverse=True)
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return vertices[used], index.reshape(-1, 3)[order], owner[order]


def _closed_surface(points: Floats, triangles: Ints) -> Ints:
    """Return the triangles (t, 3) of one block with the corners at its open edges merged."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    tolerance = SAME_CORNER * float(np.ptp(points, axis=0).max())
    rim = np.unique(open_edges(triangles, np.zeros(len(triangles), dtype=np.int64))[0])
    pairs = rim[cKDTree(points[rim]).query_pairs(tolerance, output_type="ndarray")]
    graph = coo_array(
        (np.ones(len(pairs), dtype=np.bool_), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2
    )
    groups, group = connected_components(graph, directed=False)
    first = np.full(groups, len(points))
    np.minimum.at(first, group, np.arange(len(points)))
    return _without_degenerate(first[group][triangles])


def _without_degenerate(triangles: Ints) -> Ints:
    """Return triangles (t, 3) without those of two equal corners, and without pairs that lie back to back."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    low = triangles.argmin(axis=1)
    ordered = triangles[np.arange(len(triangles))[:, None], (low[:, None] + np.arange(3)) % 3]
    back = ordered[:, [0, 2, 1]]
    index = {tuple(corners): k for k, corners in enumerate(ordered.tolist())}
    cancelled = {
        k for k, corners in enumerate(back.tolist()) if index.get(tuple(corners)) is not None
    }
    return triangles[[k for k in range(len(triangles)) if k not in cancelled]]
