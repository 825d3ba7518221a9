"""Which block a bolt among many blocks comes out of last: behind bedrock there is rock, behind others air."""

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.geometry.patches import Assembly

_ON = 1e-9  # of an edge: a line that passes through it hits a face


def last_left(assembly: Assembly, head: Floats, end: Floats, block: int | None = None) -> int:
    """The block in space that a line from head to end (3,) leaves last, of all or of one; -1 where it leaves none.

    Each face is a triangle that it may pass (Möller & Trumbore 1997, J. Graphics Tools 2, 21-28).
    """
    of = assembly.triangle_block
    own = slice(None) if block is None else np.flatnonzero(of == block)
    a, b, c = (assembly.vertices[assembly.triangles[own, k]] for k in range(3))
    way, one, other = end - head, b - a, c - a
    across = cross(np.broadcast_to(way, other.shape), other)
    size = (one * across).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        first = ((head - a) * across).sum(axis=1) / size
        turned = cross(head - a, one)
        second = turned @ way / size
        at = (other * turned).sum(axis=1) / size
        hits = (first >= -_ON) & (second >= -_ON) & (first + second <= 1.0 + _ON) & (at > 0.0) & (at <= 1.0)
    return int(of[own][np.where(hits, at, -1.0).argmax()]) if hits.any() else -1


def last_left_in_section(outlines: list[Floats], head: Floats, end: Floats) -> int:
    """The polygon (k, 2) of several that a line from head to end (2,) leaves last, by its number; -1: none."""
    last, number = 0.0, -1
    way = end - head
    for k, outline in enumerate(outlines):
        start, edge = outline, np.roll(outline, -1, axis=0) - outline
        size = way[0] * edge[:, 1] - way[1] * edge[:, 0]
        apart = start - head
        with np.errstate(divide="ignore", invalid="ignore"):
            at = (apart[:, 0] * edge[:, 1] - apart[:, 1] * edge[:, 0]) / size
            along = (apart[:, 0] * way[1] - apart[:, 1] * way[0]) / size
        hits = (along >= -_ON) & (along <= 1.0 + _ON) & (at > last) & (at <= 1.0)
        if hits.any():
            last, number = float(at[hits].max()), k
    return number
