"""Cells too small to be blocks are joined to their neighbours."""

from dataclasses import dataclass

import numpy as np

from slopekit.arrays import Bools, Floats, Ints

__all__ = ["Joined", "join_slivers"]


@dataclass(frozen=True, slots=True)
class Joined:
    """Which block each cell belongs to.

    Attributes
    ----------
    block : (n,) of each cell, -1 where it is left out
    fixed : (count,) blocks; count, joined : how many blocks there are and how many slivers were joined to others
    """

    block: Ints
    fixed: Bools
    count: int
    joined: int


def join_slivers(volumes: Floats, fixed: Bools, first: Ints, second: Ints, areas: Floats, least: float) -> Joined:
    """Join every cell with less than the `least` volume to the neighbour that shares most area with it.

    Slivers that choose each other become one cell and choose again, until all are large enough or have no neighbour.
    A fixed sliver goes to a fixed neighbour where it has one. What they make is fixed if its largest cell is.

    Parameters
    ----------
    volumes, fixed : (n,) of the cells
    first, second, areas : (k,) the cells on the two sides of each patch, and its area

    Examples
    --------
    >>> cells = np.array([1.0, 1e-12, 1.0])
    >>> join_slivers(cells, cells < 0, np.array([0, 1]), np.array([1, 2]), np.array([1.0, 2.0]), 1e-9).block.tolist()
    [0, 1, 1]
    """
    count = len(volumes)
    root = np.arange(count)
    volume = volumes.copy()
    small = volume < least
    while small.any():
        best = _best_neighbour(root[first], root[second], areas, small, fixed)
        going = np.flatnonzero(best >= 0)
        if len(going) == 0:
            break
        root, volume = _merged(root, volume, volumes, going, best[going])
        small = (volume < least) & (root == np.arange(count))
    left_out = small[root]
    hosts, block = np.unique(root[~left_out], return_inverse=True)
    of_cell = np.full(count, -1, dtype=np.int64)
    of_cell[~left_out] = block
    return Joined(of_cell, fixed[hosts], len(hosts), count - len(hosts) - int(left_out.sum()))


def _best_neighbour(first: Ints, second: Ints, areas: Floats, small: Bools, fixed: Bools) -> Ints:
    """For each small cell the neighbour to join, -1 for all others."""
    count = len(small)
    here, there = np.concatenate([first, second]), np.concatenate([second, first])
    wanted = small[here] & (here != there)
    keys, at = np.unique(here[wanted] * count + there[wanted], return_inverse=True)
    shared = np.bincount(at.reshape(-1), np.concatenate([areas, areas])[wanted], len(keys))
    here, there = keys // count, keys % count
    order = np.lexsort((shared, fixed[here] & fixed[there], here))
    best = np.full(count, -1, dtype=np.int64)
    best[here[order]] = there[order]  # the last one of each cell stays
    return best


def _merged(root: Ints, volume: Floats, cells: Floats, going: Ints, to: Ints) -> tuple[Ints, Floats]:
    """Roots and volumes after the cells `going` have been joined to the cells `to`; the largest cell is the root."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(root)
    graph = coo_array((np.ones(len(going), dtype=np.bool_), (going, to)), shape=(count, count))
    parts, part = connected_components(graph, directed=False)
    order = np.lexsort((cells, part[root]))
    host = np.zeros(parts, dtype=np.int64)
    host[part[root[order]]] = order  # the last, the largest of each part, stays
    new_root: Ints = host[part[root]]
    total = np.bincount(new_root, cells, count)
    return new_root, np.where(new_root == np.arange(count), total, volume)
