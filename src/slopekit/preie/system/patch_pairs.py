"""Node pairs on the contacts of an assembly, with the areas that they control.

The rules are exact to degree two and their hull is the contact, so that overturning about an edge is exact with the
coarsest of them (docs/theory/preie.md): Simpson's along a segment, 1/12 on each corner and 3/4 on the centroid of
a triangle.
"""

from functools import lru_cache

import numpy as np

from slopekit.core.arrays import Floats, Ints, frozen
from slopekit.geometry.patches import Patches
from slopekit.preie.system.contact_cells import ContactCells
from slopekit.preie.tolerances import PARALLEL

_OF_TRIANGLE = np.array([1.0, 1.0, 1.0, 9.0]) / 12.0  # area that corners and centroid control
_OF_QUARTER = np.array([1.0, 1.0, 4.0, 0.0]) / 6.0  # of a parallelogram, whose third corner is its centroid


def segment_pairs(patches: Patches, kept: Ints, refine: Ints) -> tuple[Floats, Ints, Floats, ContactCells]:
    """Simpson's points on every contact of a section, which is halved `refine` (k,) times.

    Without cohesion the ends alone would carry whatever the middle could, but not as an elastic joint does.

    Parameters
    ----------
    kept : (k,) indices of the patches

    Returns
    -------
    points (m, 3), contacts (m,) as indices into `kept`, control areas (m,), a cell of each contact
    """
    ends = patches.corners.reshape(-1, 2, 3)[kept]
    counts = 2 ** (refine + 1) + 1
    contact = np.repeat(np.arange(len(kept)), counts)
    place = np.arange(len(contact)) - np.repeat(np.cumsum(counts) - counts, counts)
    last = counts[contact] - 1
    along = (place / last)[:, None]
    points = ends[contact, 0] * (1.0 - along) + ends[contact, 1] * along
    weights = np.where((place == 0) | (place == last), 1.0, np.where(place % 2 == 1, 4.0, 2.0))
    each, first = np.arange(len(kept)), np.cumsum(counts) - counts
    cells = ContactCells(each, np.stack([first, first + counts - 1], axis=1), each[:, None], np.ones((len(kept), 1)))
    return points, contact, patches.areas[kept][contact] * weights / (3.0 * last), cells


def polygon_pairs(patches: Patches, kept: Ints, refine: Ints) -> tuple[Floats, Ints, Floats, ContactCells]:
    """Node pairs of flat convex polygons, fanned from the area centroid, each triangle split `refine` (k,) times.

    Which corner comes first does not matter. A triangle is its own fan, and a parallelogram that is not split needs
    one pair in its middle: A/12 on each corner and 2A/3 there is exact to degree two as well.

    Returns
    -------
    points (m, 3), contacts (m,) as indices into `kept`, control areas (m,), the triangles of the rule as cells
    """
    points, contact, areas, cells = [], [], [], []
    counts, pairs = np.diff(patches.first)[kept], 0
    for count, level in np.unique(np.stack([counts, refine], axis=1), axis=0).tolist():
        which = np.flatnonzero((counts == count) & (refine == level))
        corners = patches.corners[patches.first[kept[which]][:, None] + np.arange(count)]  # (p, count, 3)
        size = np.abs(corners - corners[:, :1]).max(axis=(1, 2))
        skew = np.abs(corners[:, 0] + corners[:, 2] - corners[:, 1] - corners[:, -1]).max(axis=1)
        even = (skew < PARALLEL * size) & (count == 4) & (level == 0)
        for chosen, shape, is_even in ((which[even], corners[even], True), (which[~even], corners[~even], False)):
            if len(chosen) == 0:
                continue
            if is_even:
                places, shares, nodes, triangle = _parallelogram()
                shape, parts = np.concatenate([shape, shape.mean(axis=1, keepdims=True)], axis=1), np.full((1, 4), 0.25)
            elif count == 3:
                places, shares, nodes, triangle = fan_rule(3, level)
                parts = np.ones((1, 1))
            else:
                shape, parts = _with_centroid(shape)
                places, shares, nodes, triangle = fan_rule(count, level)
            points.append(np.einsum("kc,pcx->pkx", places, shape).reshape(-1, 3))
            of_pairs = np.broadcast_to(parts @ shares, (len(chosen), len(places)))
            areas.append((of_pairs * patches.areas[kept[chosen]][:, None]).ravel())
            contact.append(np.repeat(chosen, len(places)))
            weights = _OF_QUARTER if is_even else _OF_TRIANGLE
            of_cells = np.broadcast_to(parts[:, triangle] / 4**level, (len(chosen), len(nodes)))
            controlled = of_cells[:, :, None] * weights / of_pairs[:, nodes]
            first = pairs + len(places) * np.arange(len(chosen))
            cells.append(
                (
                    np.repeat(chosen, len(nodes)),
                    (first[:, None, None] + nodes).reshape(-1, 4),
                    controlled.reshape(-1, 4),
                )
            )
            pairs += len(chosen) * len(places)
    owner = np.concatenate(contact)
    order = np.argsort(owner, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    of_contact, nodes, controlled = (np.concatenate(arrays) for arrays in zip(*cells, strict=True))
    by_contact = np.argsort(of_contact, kind="stable")
    nodes = place[nodes[by_contact]]
    found = ContactCells(of_contact[by_contact], nodes[:, :3], nodes, controlled[by_contact])
    return np.concatenate(points)[order], owner[order], np.concatenate(areas)[order], found


def _parallelogram() -> tuple[Floats, Floats, Ints, Ints]:
    """The rule on a parallelogram with its centroid as fifth corner, as that of `fan_rule`: A/12 and 2A/3."""
    ring = np.arange(4)
    shares = (np.eye(4) + np.roll(np.eye(4), 1, axis=1)) / 6.0
    nodes = np.stack([ring, (ring + 1) % 4, np.full(4, 4), np.full(4, 4)], axis=1)
    return np.eye(5), np.concatenate([shares, np.full((4, 1), 2.0 / 3.0)], axis=1), nodes, ring


def _with_centroid(corners: Floats) -> tuple[Floats, Floats]:
    """Corners (p, n, 3) with the area centroid behind them, (p, n + 1, 3), and the triangles' share of the area."""
    middle = corners.mean(axis=1, keepdims=True)
    around = corners - middle
    crossed = np.cross(around, np.roll(around, -1, axis=1))
    normal = crossed.sum(axis=1, keepdims=True)
    signed = (crossed * normal).sum(axis=2)
    centroid = middle[:, 0] + (
        (around + np.roll(around, -1, axis=1)) / 3.0 * (signed / signed.sum(axis=1)[:, None])[:, :, None]
    ).sum(axis=1)
    around = corners - centroid[:, None]
    parts = np.sqrt((np.cross(around, np.roll(around, -1, axis=1)) ** 2).sum(axis=2))
    return np.concatenate([corners, centroid[:, None]], axis=1), parts / parts.sum(axis=1)[:, None]


@lru_cache(maxsize=64)
def fan_rule(count: int, refine: int) -> tuple[Floats, Floats, Ints, Ints]:
    """The rule on a polygon whose triangles are split `refine` times.

    Returns
    -------
    points as weights of its corners and of the centroid behind them (not on a triangle, which is its own fan); area
    shares of each triangle of the fan on those points; of the triangles they are split into the points at the corners
    and in the middle, (c, 4), and which triangle each is part of
    """
    n = 2**refine
    fan = [(0, 1, 2)] if count == 3 else [(count, k, (k + 1) % count) for k in range(count)]
    width = 1 + max(max(corners) for corners in fan)
    lattice = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    upright = [((i, j), (i + 1, j), (i, j + 1)) for i, j in lattice if i + j < n]
    turned = [((i + 1, j), (i, j + 1), (i + 1, j + 1)) for i, j in lattice if i + j < n - 1]
    known: dict[tuple[int, ...], int] = {}  # in thirds of the lattice: shared points are found exactly
    nodes: list[list[int]] = []
    for a, b, c in fan:
        for corners in (*upright, *turned):
            weights = []
            for i, j in corners:
                at = [0] * width
                at[a], at[b], at[c] = 3 * (n - i - j), 3 * i, 3 * j
                weights.append(at)
            weights.append([sum(column) // 3 for column in zip(*weights, strict=True)])
            nodes.append([known.setdefault(tuple(at), len(known)) for at in weights])
    triangle = np.repeat(np.arange(len(fan)), n**2)
    places, rule = np.array(list(known), dtype=np.float64) / (3.0 * n), np.zeros((len(fan), len(known)))
    places_of_cells: Ints = np.array(nodes)
    np.add.at(rule, (triangle[:, None], places_of_cells), _OF_TRIANGLE / n**2)
    for array in (places_of_cells, triangle):
        array.setflags(write=False)
    return frozen(places), frozen(rule), places_of_cells, triangle
