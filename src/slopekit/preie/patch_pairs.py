"""Node pairs on the contacts of an assembly, with the areas that they control.

The rules are exact to degree two and their hull is the contact, so that overturning about an edge is exact with the
coarsest of them (METHOD.md §5): Simpson's along a segment, 1/12 on each corner and 3/4 on the centroid of a triangle.
"""

from functools import lru_cache

import numpy as np

from slopekit.arrays import Floats, Ints
from slopekit.geometry.patches import Patches

_SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0
_SQUARE_ENOUGH = 1e-9  # a four-cornered patch this near to a parallelogram, in parts of its size, is one


def segment_pairs(patches: Patches, kept: Ints, cohesion: Floats, refine: int = 0) -> tuple[Floats, Ints, Floats]:
    """Ends of every contact of a section, and its inside where there is cohesion to lose.

    A flat contact slips as one, and without cohesion its ends carry whatever its middle could.

    Parameters
    ----------
    kept : (k,) indices of the patches
    cohesion : indexed by `patches.joint`; refine : how often the segments are halved where there is any

    Returns
    -------
    points (m, 3), contacts (m,) as indices into `kept`, control areas (m,)
    """
    ends = patches.corners.reshape(-1, 2, 3)[kept]
    bonded = cohesion[patches.joint[kept]] > 0.0
    parts = 2**refine
    rule = np.zeros(2 * parts + 1)
    for part in range(parts):
        rule[2 * part : 2 * part + 3] += _SIMPSON / parts
    counts = np.where(bonded, len(rule), 2)
    contact = np.repeat(np.arange(len(kept)), counts)
    place = np.arange(len(contact)) - np.repeat(np.cumsum(counts) - counts, counts)
    along = place / (counts[contact] - 1.0)
    points = ends[contact, 0] * (1.0 - along)[:, None] + ends[contact, 1] * along[:, None]
    share = np.where(bonded[contact], rule[np.minimum(place, len(rule) - 1)], 0.5)
    return points, contact, patches.areas[kept][contact] * share


def polygon_pairs(patches: Patches, kept: Ints, refine: int = 0) -> tuple[Floats, Ints, Floats]:
    """Node pairs of flat convex polygons, fanned from the first corner, each triangle split in four `refine` times.

    A parallelogram that is not split needs one pair in its middle instead of two: A/12 on each corner and 2A/3 there
    is exact to degree two as well.

    Returns
    -------
    points (m, 3), contacts (m,) as indices into `kept`, control areas (m,)
    """
    points, contact, areas = [], [], []
    counts = np.diff(patches.first)[kept]
    for count in np.unique(counts).tolist():
        which = np.flatnonzero(counts == count)
        corners = patches.corners[patches.first[kept[which]][:, None] + np.arange(count)]  # (p, count, 3)
        size = np.abs(corners - corners[:, :1]).max(axis=(1, 2))
        skew = np.abs(corners[:, 0] + corners[:, 2] - corners[:, 1] - corners[:, -1]).max(axis=1)
        even = (skew < _SQUARE_ENOUGH * size) & (count == 4) & (refine == 0)
        for chosen, shape, is_even in ((which[even], corners[even], True), (which[~even], corners[~even], False)):
            if len(chosen) == 0:
                continue
            if is_even:
                places = np.vstack([np.eye(4), np.full((1, 4), 0.25)])
                share = np.tile(np.append(np.full(4, 1.0 / 12.0), 2.0 / 3.0), (len(chosen), 1))
            else:
                a, b = shape[:, 1:-1] - shape[:, :1], shape[:, 2:] - shape[:, :1]
                parts = np.sqrt((np.cross(a, b) ** 2).sum(axis=2))  # (p, count - 2), twice the areas
                places, shares = _fan(count, refine)
                share = (parts / parts.sum(axis=1)[:, None]) @ shares
            points.append(np.einsum("kc,pcx->pkx", places, shape).reshape(-1, 3))
            areas.append((share * patches.areas[kept[chosen]][:, None]).ravel())
            contact.append(np.repeat(chosen, len(places)))
    owner = np.concatenate(contact)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(points)[order], owner[order], np.concatenate(areas)[order]


@lru_cache(maxsize=64)
def _fan(count: int, refine: int) -> tuple[Floats, Floats]:
    """The rule on a polygon of `count` corners: points (k, count) as weights of its corners; area shares (count - 2, k)
    of each triangle of the fan on them."""
    n = 2**refine
    lattice = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    upright = [((i, j), (i + 1, j), (i, j + 1)) for i, j in lattice if i + j < n]
    turned = [((i + 1, j), (i, j + 1), (i + 1, j + 1)) for i, j in lattice if i + j < n - 1]
    known: dict[tuple[int, ...], int] = {}  # in thirds of the lattice: shared points are found exactly
    shares: list[tuple[int, int, float]] = []
    for triangle in range(count - 2):
        for corners in (*upright, *turned):
            weights = []
            for i, j in corners:
                at = [0] * count
                at[0], at[triangle + 1], at[triangle + 2] = 3 * (n - i - j), 3 * i, 3 * j
                weights.append(at)
            middle = [sum(column) // 3 for column in zip(*weights, strict=True)]
            for at, part in (*((at, 1.0 / 12.0) for at in weights), (middle, 0.75)):
                place = known.setdefault(tuple(at), len(known))
                shares.append((triangle, place, part / n**2))
    rule = np.zeros((count - 2, len(known)))
    for triangle, place, part in shares:
        rule[triangle, place] += part
    return np.array(list(known), dtype=np.float64) / (3.0 * n), rule
