"""Which boxes touch, without looking at all pairs: hashed into grids of cells as large as the boxes, or swept."""

from itertools import pairwise

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.geometry.tolerances import TINY

_AT_ONCE = 2_000_000  # candidate pairs looked at in one go: bounds the memory
_FINEST = 2.0**-20  # cells of a grid along each axis: three axes fit one 64-bit key


def box_pairs(lowest: Floats, highest: Floats) -> tuple[Ints, Ints]:
    """All pairs i < j of boxes that touch or overlap.

    Boxes of one size (to a factor of two) share a grid whose cells are as large as they are, and smaller boxes are
    looked up in it: near-linear however unlike the boxes are, one long base below a thousand blocks included. Where
    sorting along an axis leaves fewer candidates (thin sheets in a pile), that is done instead.

    Parameters
    ----------
    lowest, highest : (n, d) corners of the boxes, d = 2 or 3

    Examples
    --------
    >>> first, second = box_pairs(np.array([[0.0, 0.0], [1.0, 0.0], [5.0, 5.0]]), np.array([[1.0, 1.0], [2.0, 1.0],
    ...                           [6.0, 6.0]]))
    >>> list(zip(first.tolist(), second.tolist()))
    [(0, 1)]
    """
    count, axes = lowest.shape
    if count < 2:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    sweeps = [_Sweep(lowest[:, axis], highest[:, axis]) for axis in range(axes)]
    best = min(sweeps, key=lambda sweep: sweep.candidates)
    if best.candidates > 20 * count:
        grids = _grids(lowest, highest)
        if sum(grid.candidates for grid in grids) < best.candidates:
            pairs = [grid.pairs(lowest, highest) for grid in grids]
            first, second = (np.concatenate([pair[k] for pair in pairs]) for k in range(2))
            return np.minimum(first, second), np.maximum(first, second)
    return best.pairs(lowest, highest)


def ragged(starts: Ints, counts: Ints) -> tuple[Ints, Ints]:
    """Rows of unequal length laid end to end: which row each entry belongs to, and its index start, start + 1, ...

    >>> [part.tolist() for part in ragged(np.array([10, 20]), np.array([2, 1]))]
    [[0, 0, 1], [10, 11, 20]]
    """
    row = np.repeat(np.arange(len(counts)), counts)
    begins = np.cumsum(counts) - counts
    return row, np.arange(len(row)) - begins[row] + starts[row]


def _overlapping(
    lowest: Floats, highest: Floats, first: Ints, second: Ints, row: Ints
) -> tuple[Ints, Ints, Ints]:  # fmt: skip
    """The pairs whose boxes meet, and the rows that they come from."""
    for axis in range(lowest.shape[1]):
        low, high = lowest[:, axis], highest[:, axis]
        meets = (low[first] <= high[second]) & (low[second] <= high[first])
        first, second, row = first[meets], second[meets], row[meets]
    return first, second, row


def chunks(counts: Ints) -> list[slice]:
    """Slices of rows with about `_AT_ONCE` entries each."""
    ends = np.cumsum(counts)
    cuts = np.searchsorted(ends, np.arange(_AT_ONCE, max(int(ends[-1]) if len(ends) else 0, 1), _AT_ONCE)) + 1
    edges = np.unique(np.concatenate([[0], cuts, [len(counts)]]))
    return [slice(a, b) for a, b in pairwise(edges.tolist())]


class _Sweep:
    """Boxes in order of where they begin along an axis; each meets those that begin before it ends."""

    def __init__(self, low: Floats, high: Floats) -> None:
        self.order = np.argsort(low, kind="stable")
        self.after = np.arange(1, len(low) + 1)
        last = np.searchsorted(low[self.order], high[self.order], side="right")
        self.counts = np.maximum(last - self.after, 0)
        self.candidates = int(self.counts.sum())

    def pairs(self, lowest: Floats, highest: Floats) -> tuple[Ints, Ints]:
        found_pairs = []
        for part in chunks(self.counts):
            row, other = ragged(self.after[part], self.counts[part])
            found_pairs.append(_overlapping(lowest, highest, self.order[part][row], self.order[other], row)[:2])
        first, second = (np.concatenate([pair[k] for pair in found_pairs]) for k in range(2))
        return np.minimum(first, second), np.maximum(first, second)


class _BoxGrid:
    """Boxes of one size in cells of that size, and the boxes that are not larger looked up there."""

    def __init__(self, own: Ints, others: Ints, lowest: Floats, highest: Floats, size: float) -> None:
        self.size, self.origin = size, lowest.min(axis=0)
        self.shape = self._cell(highest.max(axis=0)[None])[0] + 2
        entries = np.concatenate([own, others])
        begin, end = self._cell(lowest[entries]), self._cell(highest[entries])
        keys, boxes = [], []
        for step in np.ndindex(*(2,) * lowest.shape[1]):  # a box is no larger than a cell: at most two along an axis
            there = (begin + np.array(step) <= end).all(axis=1)
            keys.append(self._key(begin[there] + np.array(step)))
            boxes.append(entries[there])
        key, box = np.concatenate(keys), np.concatenate(boxes)
        self.is_own = np.zeros(len(lowest), dtype=bool)
        self.is_own[own] = True
        mine = self.is_own[box]
        order = np.argsort(key[mine], kind="stable")
        sorted_keys, self.owned = key[mine][order], box[mine][order]
        # within one size each pair once: a box meets those behind it in its cell, a smaller box all
        first = np.searchsorted(sorted_keys, key[~mine], side="left")
        last = np.searchsorted(sorted_keys, key[~mine], side="right")
        behind = np.searchsorted(sorted_keys, sorted_keys, side="right")
        after = np.arange(1, len(sorted_keys) + 1)
        self.key = np.concatenate([sorted_keys, key[~mine]])
        self.box = np.concatenate([self.owned, box[~mine]])
        self.first = np.concatenate([after, first])
        self.counts = np.concatenate([behind - after, last - first])
        self.candidates = int(self.counts.sum())

    def pairs(self, lowest: Floats, highest: Floats) -> tuple[Ints, Ints]:
        found_pairs = []
        for part in chunks(self.counts):
            row, other = ragged(self.first[part], self.counts[part])
            a, b = self.box[part][row], self.owned[other]
            a, b, row = _overlapping(lowest, highest, a, b, row)
            # two boxes may share several cells: they are a pair in the one where their overlap begins
            here = self._key(self._cell(np.maximum(lowest[a], lowest[b]))) == self.key[part][row]
            found_pairs.append((a[here], b[here]))
        first, second = (np.concatenate([pair[k] for pair in found_pairs]) for k in range(2))
        return first, second

    def _cell(self, points: Floats) -> Ints:
        cells: Ints = np.floor((points - self.origin) / self.size).astype(np.int64)
        return cells

    def _key(self, cells: Ints) -> Ints:
        key: Ints = cells[:, 0]
        for axis in range(1, cells.shape[1]):
            key = key * self.shape[axis] + cells[:, axis]
        return key


def _grids(lowest: Floats, highest: Floats) -> list[_BoxGrid]:
    extent = (highest - lowest).max(axis=1)
    domain = float((highest.max(axis=0) - lowest.min(axis=0)).max())
    extent = np.maximum(extent, max(float(np.median(extent)), domain * _FINEST, TINY))
    # a hair more: boxes of one size by design would fall on both sides of a power of two by rounding
    level = np.ceil(np.log2(extent / float(extent.min())) - 1e-6).astype(np.int64)
    grids = []
    for step in np.unique(level):
        size = float(extent.min()) * 2.0 ** float(step) * (1.0 + 1e-5)
        grids.append(_BoxGrid(np.flatnonzero(level == step), np.flatnonzero(level < step), lowest, highest, size))
    return grids
