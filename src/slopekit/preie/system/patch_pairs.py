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

_TRIANGLE_WEIGHTS = np.array([1.0, 1.0, 1.0, 9.0]) / 12.0  # areas of corners and centroid
#: Areas of the corners of a quarter of a parallelogram; the third corner is the parallelogram's centroid.
_QUARTER_WEIGHTS = np.array([1.0, 1.0, 4.0, 0.0]) / 6.0


def segment_pairs(
    patches: Patches, active: Ints, refine: Ints
) -> tuple[Floats, Ints, Floats, ContactCells]:
    """Return Simpson's points on every contact of a section, halved `refine` (k,) times.

    Without cohesion the ends alone would carry any load that the middle can, but not with an elastic distribution.

    Parameters
    ----------
    active : (k,) indices of the patches

    Returns
    -------
    points (m, 3), contacts (m,) as indices into `active`, control areas (m,), a cell of each contact
    """
    ends = patches.corners.reshape(-1, 2, 3)[active]
    counts = 2 ** (refine + 1) + 1
    contact = np.repeat(np.arange(len(active)), counts)
    place = np.arange(len(contact)) - np.repeat(np.cumsum(counts) - counts, counts)
    last = counts[contact] - 1
    fraction = (place / last)[:, None]
    points = ends[contact, 0] * (1.0 - fraction) + ends[contact, 1] * fraction
    weights = np.where((place == 0) | (place == last), 1.0, np.where(place % 2 == 1, 4.0, 2.0))
    contact_numbers, first = np.arange(len(active)), np.cumsum(counts) - counts
    cells = ContactCells(
        contact_numbers,
        np.stack([first, first + counts - 1], axis=1),
        contact_numbers[:, None],
        np.ones((len(active), 1)),
    )
    return points, contact, patches.areas[active][contact] * weights / (3.0 * last), cells


def polygon_pairs(
    patches: Patches, active: Ints, refine: Ints
) -> tuple[Floats, Ints, Floats, ContactCells]:
    """Return node pairs of flat convex polygons, fanned from the area centroid, triangles split `refine` (k,) times.

    The first corner is arbitrary. A triangle is its own fan, and a parallelogram that is not split needs one pair in
    its middle: A/12 on each corner and 2A/3 there is exact to degree two as well.

    Returns
    -------
    points (m, 3), contacts (m,) as indices into `active`, control areas (m,), the triangles of the rule as cells
    """
    points, contact, areas, cells = [], [], [], []
    counts, pairs = np.diff(patches.first)[active], 0
    for count, level in np.unique(np.stack([counts, refine], axis=1), axis=0).tolist():
        polygons = np.flatnonzero((counts == count) & (refine == level))
        corners = patches.corners[
            patches.first[active[polygons]][:, None] + np.arange(count)
        ]  # (p, count, 3)
        size = np.abs(corners - corners[:, :1]).max(axis=(1, 2))
        skew = np.abs(corners[:, 0] + corners[:, 2] - corners[:, 1] - corners[:, -1]).max(axis=1)
        is_parallelogram = (skew < PARALLEL * size) & (count == 4) & (level == 0)
        for rows, outline, all_parallelograms in (
            (polygons[is_parallelogram], corners[is_parallelogram], True),
            (polygons[~is_parallelogram], corners[~is_parallelogram], False),
        ):
            if len(rows) == 0:
                continue
            if all_parallelograms:
                point_weights, shares, nodes, triangle = _parallelogram()
                outline, triangle_shares = (
                    np.concatenate([outline, outline.mean(axis=1, keepdims=True)], axis=1),
                    np.full((1, 4), 0.25),
                )
            elif count == 3:
                point_weights, shares, nodes, triangle = fan_rule(3, level)
                triangle_shares = np.ones((1, 1))
            else:
                outline, triangle_shares = _with_centroid(outline)
                point_weights, shares, nodes, triangle = fan_rule(count, level)
            points.append(np.einsum("kc,pcx->pkx", point_weights, outline).reshape(-1, 3))
            pair_shares = np.broadcast_to(triangle_shares @ shares, (len(rows), len(point_weights)))
            areas.append((pair_shares * patches.areas[active[rows]][:, None]).ravel())
            contact.append(np.repeat(rows, len(point_weights)))
            weights = _QUARTER_WEIGHTS if all_parallelograms else _TRIANGLE_WEIGHTS
            cell_shares = np.broadcast_to(
                triangle_shares[:, triangle] / 4**level, (len(rows), len(nodes))
            )
            controlled = cell_shares[:, :, None] * weights / pair_shares[:, nodes]
            first = pairs + len(point_weights) * np.arange(len(rows))
            cells.append(
                (
                    np.repeat(rows, len(nodes)),
                    (first[:, None, None] + nodes).reshape(-1, 4),
                    controlled.reshape(-1, 4),
                )
            )
            pairs += len(rows) * len(point_weights)
    owner = np.concatenate(contact)
    order = np.argsort(owner, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    cell_contact, nodes, controlled = (
        np.concatenate(arrays) for arrays in zip(*cells, strict=True)
    )
    by_contact = np.argsort(cell_contact, kind="stable")
    nodes = place[nodes[by_contact]]
    contact_cells = ContactCells(
        cell_contact[by_contact], nodes[:, :3], nodes, controlled[by_contact]
    )
    return np.concatenate(points)[order], owner[order], np.concatenate(areas)[order], contact_cells


def _parallelogram() -> tuple[Floats, Floats, Ints, Ints]:
    """Return the rule on a parallelogram, A/12 on its corners and 2A/3 on its centroid, in the form of `fan_rule`."""
    ring = np.arange(4)
    shares = (np.eye(4) + np.roll(np.eye(4), 1, axis=1)) / 6.0
    nodes = np.stack([ring, (ring + 1) % 4, np.full(4, 4), np.full(4, 4)], axis=1)
    return np.eye(5), np.concatenate([shares, np.full((4, 1), 2.0 / 3.0)], axis=1), nodes, ring


def _with_centroid(corners: Floats) -> tuple[Floats, Floats]:
    """Return corners (p, n, 3) followed by the area centroid, (p, n + 1, 3), and the triangles' shares of the area."""
    middle = corners.mean(axis=1, keepdims=True)
    around = corners - middle
    crossed = np.cross(around, np.roll(around, -1, axis=1))
    normal = crossed.sum(axis=1, keepdims=True)
    signed = (crossed * normal).sum(axis=2)
    centroid = middle[:, 0] + (
        (around + np.roll(around, -1, axis=1))
        / 3.0
        * (signed / signed.sum(axis=1)[:, None])[:, :, None]
    ).sum(axis=1)
    around = corners - centroid[:, None]
    triangle_areas = np.sqrt((np.cross(around, np.roll(around, -1, axis=1)) ** 2).sum(axis=2))
    return np.concatenate(
        [corners, centroid[:, None]], axis=1
    ), triangle_areas / triangle_areas.sum(axis=1)[:, None]


@lru_cache(maxsize=64)
def fan_rule(count: int, refine: int) -> tuple[Floats, Floats, Ints, Ints]:
    """Return the quadrature rule on a polygon of `count` corners whose triangles are split `refine` times.

    Returns
    -------
    points as weights of the corners and the centroid after them (none for a triangle, which is its own fan); area
    shares (t, p) of each triangle of the fan on those points; of the triangles they are split into the points at the
    corners and in the middle, (c, 4), and the number (c,) of the triangle that contains each
    """
    n = 2**refine
    fan = [(0, 1, 2)] if count == 3 else [(count, k, (k + 1) % count) for k in range(count)]
    width = 1 + max(max(corners) for corners in fan)
    lattice = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    upright = [((i, j), (i + 1, j), (i, j + 1)) for i, j in lattice if i + j < n]
    inverted = [((i + 1, j), (i, j + 1), (i + 1, j + 1)) for i, j in lattice if i + j < n - 1]
    point_numbers: dict[
        tuple[int, ...], int
    ] = {}  # in thirds of the lattice: shared points are found exactly
    nodes: list[list[int]] = []
    for a, b, c in fan:
        for corners in (*upright, *inverted):
            cell_points = []
            for i, j in corners:
                point = [0] * width
                point[a], point[b], point[c] = 3 * (n - i - j), 3 * i, 3 * j
                cell_points.append(point)
            cell_points.append([sum(column) // 3 for column in zip(*cell_points, strict=True)])
            nodes.append(
                [
                    point_numbers.setdefault(tuple(point), len(point_numbers))
                    for point in cell_points
                ]
            )
    triangle = np.repeat(np.arange(len(fan)), n**2)
    point_weights, area_shares = (
        np.array(list(point_numbers), dtype=np.float64) / (3.0 * n),
        np.zeros((len(fan), len(point_numbers))),
    )
    cell_nodes: Ints = np.array(nodes)
    np.add.at(area_shares, (triangle[:, None], cell_nodes), _TRIANGLE_WEIGHTS / n**2)
    for array in (cell_nodes, triangle):
        array.setflags(write=False)
    return frozen(point_weights), frozen(area_shares), cell_nodes, triangle
