"""Nested dissection (George 1973): an order of blocks in which few entries of a factorised stiffness are not zero.

Blocks are halved recursively by a least separating set of blocks; the halves are eliminated first, separators last.
"""

import itertools

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, maximum_bipartite_matching

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.system.assembly import AssemblyModel, BlockContacts
from slopekit.preie.tolerances import PARALLEL

_MAX_IMBALANCE = 0.15  # distance of a cut from the middle of its piece, as a fraction of the piece
_SAME_SET_COSINE = 0.9  # cosine between normals of one joint set


def touching_blocks(model: BlockContacts) -> Ints:
    """Return the two blocks (2, k) of each contact between moving blocks."""
    both = model.minus >= 0
    return np.stack([model.plus[both], model.minus[both]])


def joint_set_coordinates(model: AssemblyModel) -> Floats:
    """Return the coordinates (d, n) of blocks along the normals of the joint sets, with all their sums and differences.

    The unit is the median spacing of neighbouring blocks. Between blocks cut by joint sets the least separators are
    diagonals: of 7,251 blocks, planes along the sets alone take 36 Gflop, with the diagonals 14 (METIS: 13).
    """
    dimensions = [0, 1, 2] if model.unknowns == 6 else [0, 2]
    n, both = len(model.load), model.minus >= 0
    pairs = np.maximum(np.bincount(model.pair_contact, minlength=len(model.plus)), 1)
    contact_block = np.concatenate([model.plus, model.minus]) + 1
    contacts = np.maximum(np.bincount(contact_block, minlength=n + 1), 1)
    centres = np.empty((n, len(dimensions)))
    for k, axis in enumerate(dimensions):
        middle = np.bincount(model.pair_contact, model.points[:, axis], len(pairs)) / pairs
        centres[:, k] = (np.bincount(contact_block, np.tile(middle, 2), n + 1) / contacts)[1:]
    normals = model.plus_motion[both, 0, : len(dimensions)]
    separation = centres[model.plus[both]] - centres[model.minus[both]]
    axes: list[Floats] = []
    while len(normals) and len(axes) < len(dimensions):
        cosines = normals @ normals[0]
        same_set = np.abs(cosines) > _SAME_SET_COSINE
        normal = (normals[same_set] * np.sign(cosines[same_set])[:, None]).mean(axis=0)
        axes.append(normal / max(float(np.median(np.abs(separation[same_set] @ normal))), PARALLEL))
        normals, separation = normals[~same_set], separation[~same_set]
    axes = axes or [*np.eye(len(dimensions))]
    signs = [
        sign
        for sign in itertools.product((0, 1, -1), repeat=len(axes))
        if sign > tuple(-s for s in sign)
    ]
    return np.array(signs) @ np.array(axes) @ centres.T


def dissection(edges: Ints, coordinates: Floats, leaf: int) -> tuple[Ints, Ints]:
    """Return the place (n,) of each block in the order of elimination, and the number of blocks (f,) of each front.

    All pieces of one level are halved at once. A piece is cut where, along one of the coordinates (d, n), the fewest
    blocks on one side have a neighbour on the other; its separator is the least vertex cover of the contacts cut.

    Parameters
    ----------
    edges : (2, k) blocks that touch; coordinates : (d, n); leaf : pieces of at most so many blocks are not halved
    """
    n = coordinates.shape[1]
    piece = np.ones(n, dtype=np.int64)  # numbered as a heap: the halves of i are 2i and 2i + 1
    halving = np.ones(n, dtype=bool)
    a, b = edges
    block_numbers = np.arange(n)
    while True:
        ids, piece_row, sizes = np.unique(piece, return_inverse=True, return_counts=True)
        halving &= sizes[piece_row] > leaf
        if not halving.any():
            break
        inner = halving[a] & halving[b] & (piece[a] == piece[b])
        a, b = a[inner], b[inner]
        first = np.cumsum(sizes) - sizes
        imbalance = np.abs(
            (block_numbers - np.repeat(first, sizes) + 1) / np.repeat(sizes, sizes) - 0.5
        )
        best, in_upper_half = np.full(len(ids), np.inf), np.zeros(n, dtype=bool)
        for coordinate in coordinates:
            order = np.lexsort((coordinate, piece_row))
            rank = np.empty(n, dtype=np.int64)
            rank[order] = block_numbers
            low, high = np.minimum(rank[a], rank[b]), np.maximum(rank[a], rank[b])
            farthest, nearest = block_numbers.copy(), block_numbers.copy()
            np.maximum.at(farthest, low, high)
            np.minimum.at(nearest, high, low)
            # blocks up to a rank that have a neighbour beyond it, and blocks beyond it with a neighbour up to it
            boundary_below = np.cumsum(1 - np.bincount(farthest, minlength=n))
            boundary_above = np.cumsum(np.bincount(nearest, minlength=n) - 1)
            cost = np.where(
                imbalance <= max(_MAX_IMBALANCE, 0.5 / leaf),
                (np.minimum(boundary_below, boundary_above) + 1e-3) * (1.0 + imbalance),
                np.inf,
            )
            least = np.minimum.reduceat(cost, first)
            cut = np.empty(len(ids), dtype=np.int64)
            cheapest = np.flatnonzero(cost == np.repeat(least, sizes))
            cut[piece_row[order[cheapest]]] = cheapest
            better = (least < best)[piece_row]
            best = np.minimum(best, least)
            in_upper_half = np.where(better, rank > cut[piece_row], in_upper_half)
        crossing = in_upper_half[a] != in_upper_half[b]
        lower, upper = (
            np.where(in_upper_half[a], b, a)[crossing],
            np.where(in_upper_half[a], a, b)[crossing],
        )
        halving &= ~_least_vertex_cover(lower, upper, n)
        piece = np.where(halving, 2 * piece + in_upper_half, piece)
    level = np.frexp(piece)[1]
    elimination_key = ((piece + 1) << (level.max() - level)) * 64 - level  # children before parents
    first_neighbour = np.full(n, np.iinfo(np.int64).max)
    for block, neighbour in (edges, edges[::-1]):
        np.minimum.at(first_neighbour, block, elimination_key[neighbour])
    # ties by the first neighbour: the later blocks that a piece touches lie together
    order = np.lexsort((first_neighbour, elimination_key))
    place = np.empty(n, dtype=np.int64)
    place[order] = block_numbers
    return place, np.unique(elimination_key, return_counts=True)[1]


def _least_vertex_cover(lower: Ints, upper: Ints, n: int) -> Bools:
    """Return the least set of blocks (n,) with at least one of each pair lower-upper (König's theorem)."""
    covered = np.zeros(n, dtype=bool)
    if len(lower) == 0:
        return covered
    lower_blocks, row = np.unique(lower, return_inverse=True)
    upper_blocks, column = np.unique(upper, return_inverse=True)
    pairs = sparse.csr_matrix(
        (np.ones(len(row)), (row, column)), shape=(len(lower_blocks), len(upper_blocks))
    )
    partner = maximum_bipartite_matching(pairs, perm_type="column")
    matched, unmatched = np.flatnonzero(partner >= 0), np.flatnonzero(partner < 0)
    # paths from unmatched blocks: over any pair, back along the matching
    root, split = len(lower_blocks) + len(upper_blocks), len(lower_blocks)
    starts = np.concatenate([row, split + partner[matched], np.full(len(unmatched), root)])
    ends = np.concatenate([split + column, matched, unmatched])
    paths = sparse.csr_matrix((np.ones(len(starts)), (starts, ends)), shape=(root + 1, root + 1))
    is_reachable = np.zeros(root + 1, dtype=bool)
    is_reachable[breadth_first_order(paths, root, return_predecessors=False)] = True
    covered[lower_blocks[~is_reachable[:split]]] = True
    covered[upper_blocks[is_reachable[split:root]]] = True
    return covered
