"""Nested dissection (George 1973): an order of blocks in which few entries of a factorised stiffness are not zero.

Blocks are halved by a least set of blocks between the halves, and so on; halves first, what separates them last.
"""

import itertools

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, maximum_bipartite_matching

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.preie.system.assembly import AssemblyModel, BlockContacts
from slopekit.preie.tolerances import PARALLEL

_UNEVEN = 0.15  # of a piece, how far from its middle it may be cut
_ALIKE = 0.9  # cosine between normals of one joint set


def touching_blocks(model: BlockContacts) -> Ints:
    """The two blocks of each contact between moving blocks, (2, k)."""
    both = model.minus >= 0
    return np.stack([model.plus[both], model.minus[both]])


def along_joints(model: AssemblyModel) -> Floats:
    """Coordinates of blocks along the normals of the joint sets, in blocks, with all their sums and differences.

    (d, n). Between blocks cut by joint sets the least separators are diagonals: of 7,251 blocks, planes along the sets
    alone take 36 Gflop, with the diagonals 14 (METIS: 13).
    """
    dimensions = [0, 1, 2] if model.unknowns == 6 else [0, 2]
    n, both = len(model.load), model.minus >= 0
    pairs = np.maximum(np.bincount(model.pair_contact, minlength=len(model.plus)), 1)
    of_block = np.concatenate([model.plus, model.minus]) + 1
    contacts = np.maximum(np.bincount(of_block, minlength=n + 1), 1)
    centres = np.empty((n, len(dimensions)))
    for k, axis in enumerate(dimensions):
        middle = np.bincount(model.pair_contact, model.points[:, axis], len(pairs)) / pairs
        centres[:, k] = (np.bincount(of_block, np.tile(middle, 2), n + 1) / contacts)[1:]
    normals = model.plus_motion[both, 0, : len(dimensions)]
    apart = centres[model.plus[both]] - centres[model.minus[both]]
    axes: list[Floats] = []
    while len(normals) and len(axes) < len(dimensions):
        cosines = normals @ normals[0]
        alike = np.abs(cosines) > _ALIKE
        normal = (normals[alike] * np.sign(cosines[alike])[:, None]).mean(axis=0)
        axes.append(normal / max(float(np.median(np.abs(apart[alike] @ normal))), PARALLEL))
        normals, apart = normals[~alike], apart[~alike]
    axes = axes or [*np.eye(len(dimensions))]
    signs = [sign for sign in itertools.product((0, 1, -1), repeat=len(axes)) if sign > tuple(-s for s in sign)]
    return np.array(signs) @ np.array(axes) @ centres.T


def dissection(edges: Ints, coordinates: Floats, leaf: int) -> tuple[Ints, Ints]:
    """The place (n,) of each block in the order of elimination, and the blocks (f,) of the fronts in that order.

    All pieces of one level are halved at once. A piece is cut where, along one of the coordinates (d, n), the fewest
    blocks on one side have a neighbour on the other; what separates it is the least cover of the contacts cut.
    """
    n = coordinates.shape[1]
    piece = np.ones(n, dtype=np.int64)  # numbered as a heap: the halves of i are 2i and 2i + 1
    halving = np.ones(n, dtype=bool)
    a, b = edges
    every = np.arange(n)
    while True:
        ids, of, sizes = np.unique(piece, return_inverse=True, return_counts=True)
        halving &= sizes[of] > leaf
        if not halving.any():
            break
        inner = halving[a] & halving[b] & (piece[a] == piece[b])
        a, b = a[inner], b[inner]
        first = np.cumsum(sizes) - sizes
        off = np.abs((every - np.repeat(first, sizes) + 1) / np.repeat(sizes, sizes) - 0.5)
        best, beyond = np.full(len(ids), np.inf), np.zeros(n, dtype=bool)
        for along in coordinates:
            order = np.lexsort((along, of))
            rank = np.empty(n, dtype=np.int64)
            rank[order] = every
            low, high = np.minimum(rank[a], rank[b]), np.maximum(rank[a], rank[b])
            farthest, nearest = every.copy(), every.copy()
            np.maximum.at(farthest, low, high)
            np.minimum.at(nearest, high, low)
            # how many up to a place have a neighbour after it, and the other way round
            before = np.cumsum(1 - np.bincount(farthest, minlength=n))
            after = np.cumsum(np.bincount(nearest, minlength=n) - 1)
            cost = np.where(off <= max(_UNEVEN, 0.5 / leaf), (np.minimum(before, after) + 1e-3) * (1.0 + off), np.inf)
            least = np.minimum.reduceat(cost, first)
            cut = np.empty(len(ids), dtype=np.int64)
            cheapest = np.flatnonzero(cost == np.repeat(least, sizes))
            cut[of[order[cheapest]]] = cheapest
            better = (least < best)[of]
            best = np.minimum(best, least)
            beyond = np.where(better, rank > cut[of], beyond)
        crossing = beyond[a] != beyond[b]
        near, far = np.where(beyond[a], b, a)[crossing], np.where(beyond[a], a, b)[crossing]
        halving &= ~_cover(near, far, n)
        piece = np.where(halving, 2 * piece + beyond, piece)
    level = np.frexp(piece)[1]
    after_all = ((piece + 1) << (level.max() - level)) * 64 - level  # children before parents
    first_neighbour = np.full(n, np.iinfo(np.int64).max)
    for one, other in (edges, edges[::-1]):
        np.minimum.at(first_neighbour, one, after_all[other])
    order = np.lexsort((first_neighbour, after_all))  # so that what a piece touches lies together
    place = np.empty(n, dtype=np.int64)
    place[order] = every
    return place, np.unique(after_all, return_counts=True)[1]


def _cover(near: Ints, far: Ints, n: int) -> Bools:
    """The least set of blocks (n,) with at least one of each pair near-far (König's theorem)."""
    covered = np.zeros(n, dtype=bool)
    if len(near) == 0:
        return covered
    lefts, left = np.unique(near, return_inverse=True)
    rights, right = np.unique(far, return_inverse=True)
    pairs = sparse.csr_matrix((np.ones(len(left)), (left, right)), shape=(len(lefts), len(rights)))
    partner = maximum_bipartite_matching(pairs, perm_type="column")
    matched, alone = np.flatnonzero(partner >= 0), np.flatnonzero(partner < 0)
    # paths from those alone: over any pair, back along the matching
    root, split = len(lefts) + len(rights), len(lefts)
    starts = np.concatenate([left, split + partner[matched], np.full(len(alone), root)])
    ends = np.concatenate([split + right, matched, alone])
    paths = sparse.csr_matrix((np.ones(len(starts)), (starts, ends)), shape=(root + 1, root + 1))
    reached = np.zeros(root + 1, dtype=bool)
    reached[breadth_first_order(paths, root, return_predecessors=False)] = True
    covered[lefts[~reached[:split]]] = True
    covered[rights[reached[split:root]]] = True
    return covered
