"""Which boxes touch, without looking at all pairs: swept along an axis."""

from itertools import pairwise

import numpy as np

from slopekit.core.arrays import Floats, Ints

_AT_ONCE = 2_000_000  # candidate pairs looked at in one go: bounds the memory


def box_pairs(lowest: Floats, highest: Floats) -> tuple[Ints, Ints]:
    """All pairs i < j of boxes that touch or overlap.

    In order of where they begin along an axis, each box meets those that begin before it ends; of the axes that one
    which leaves the fewest candidates.

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
    if len(lowest) < 2:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    sweeps = [_sweep(low, high) for low, high in zip(lowest.T, highest.T, strict=True)]
    order, counts = min(sweeps, key=lambda sweep: int(sweep[1].sum()))
    after = np.arange(1, len(order) + 1)
    found_pairs = []
    for part in chunks(counts):
        row, other = ragged(after[part], counts[part])
        first, second = order[part][row], order[other]
        for low, high in zip(lowest.T, highest.T, strict=True):
            meets = (low[first] <= high[second]) & (low[second] <= high[first])
            first, second = first[meets], second[meets]
        found_pairs.append((np.minimum(first, second), np.maximum(first, second)))
    return np.concatenate([pair[0] for pair in found_pairs]), np.concatenate([pair[1] for pair in found_pairs])


def _sweep(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Boxes (n,) in order of where they begin along an axis, and how many begin behind each before it ends."""
    order = np.argsort(low, kind="stable")
    last = np.searchsorted(low[order], high[order], side="right")
    return order, np.maximum(last - np.arange(1, len(low) + 1), 0)


def ragged(starts: Ints, counts: Ints) -> tuple[Ints, Ints]:
    """Rows of unequal length laid end to end: which row each entry belongs to, and its index start, start + 1, ...

    >>> [part.tolist() for part in ragged(np.array([10, 20]), np.array([2, 1]))]
    [[0, 0, 1], [10, 11, 20]]
    """
    row = np.repeat(np.arange(len(counts)), counts)
    begins = np.cumsum(counts) - counts
    return row, np.arange(len(row)) - begins[row] + starts[row]


def chunks(counts: Ints) -> list[slice]:
    """Slices of rows with about `_AT_ONCE` entries each."""
    ends = np.cumsum(counts)
    cuts = np.searchsorted(ends, np.arange(_AT_ONCE, max(int(ends[-1]) if len(ends) else 0, 1), _AT_ONCE)) + 1
    edges = np.unique(np.concatenate([[0], cuts, [len(counts)]]))
    return [slice(a, b) for a, b in pairwise(edges.tolist())]
