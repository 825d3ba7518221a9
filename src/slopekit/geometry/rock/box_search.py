"""Pairs of boxes that touch, found by a sweep along an axis instead of a comparison of all pairs."""

from itertools import pairwise

import numpy as np

from slopekit.core.arrays import Floats, Ints

_CHUNK_SIZE = 2_000_000  # candidate pairs examined at once: bounds the memory


def box_pairs(lowest: Floats, highest: Floats) -> tuple[Ints, Ints]:
    """Return all pairs i < j of boxes that touch or overlap.

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
    starts = np.arange(1, len(order) + 1)
    touching = []
    for chunk in chunks(counts):
        row, candidate = ragged(starts[chunk], counts[chunk])
        first, second = order[chunk][row], order[candidate]
        for low, high in zip(lowest.T, highest.T, strict=True):
            meets = (low[first] <= high[second]) & (low[second] <= high[first])
            first, second = first[meets], second[meets]
        touching.append((np.minimum(first, second), np.maximum(first, second)))
    return np.concatenate([pair[0] for pair in touching]), np.concatenate(
        [pair[1] for pair in touching]
    )


def _sweep(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Return the boxes (n,) in order of their lower ends along an axis, and how many begin within each of them."""
    order = np.argsort(low, kind="stable")
    last = np.searchsorted(low[order], high[order], side="right")
    return order, np.maximum(last - np.arange(1, len(low) + 1), 0)


def ragged(starts: Ints, counts: Ints) -> tuple[Ints, Ints]:
    """Return the row of each entry of rows of unequal length laid end to end, and its index start, start + 1, ...

    >>> [part.tolist() for part in ragged(np.array([10, 20]), np.array([2, 1]))]
    [[0, 0, 1], [10, 11, 20]]
    """
    row = np.repeat(np.arange(len(counts)), counts)
    begins = np.cumsum(counts) - counts
    return row, np.arange(len(row)) - begins[row] + starts[row]


def chunks(counts: Ints) -> list[slice]:
    """Return slices of rows with about `_CHUNK_SIZE` entries each."""
    ends = np.cumsum(counts)
    cuts = (
        np.searchsorted(
            ends, np.arange(_CHUNK_SIZE, max(int(ends[-1]) if len(ends) else 0, 1), _CHUNK_SIZE)
        )
        + 1
    )
    edges = np.unique(np.concatenate([[0], cuts, [len(counts)]]))
    return [slice(a, b) for a, b in pairwise(edges.tolist())]
