"""Overlaps of many pairs of convex polygons in a plane at once, and the polygons that they share."""

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints


def polygon_sums(polygons: Floats, counts: Ints) -> tuple[Floats, Floats, Floats]:
    """Return the areas, centroids and perimeters of anticlockwise polygons.

    Parameters
    ----------
    polygons : (n, k, 2); counts : (n,) how many of the k corners each has

    Returns
    -------
    (n,) areas (0 below three corners), (n, 2) centroids (the first corner where there is no area), (n,) perimeters
    """
    base = polygons[:, :1]
    corners = np.where(_is_corner(polygons, counts)[:, :, None], polygons, base) - base
    following = np.roll(corners, -1, axis=1)
    cross = corners[:, :, 0] * following[:, :, 1] - corners[:, :, 1] * following[:, :, 0]
    doubled = cross.sum(axis=1)
    moment = ((corners + following) * cross[:, :, None]).sum(axis=1) / 3.0
    area = np.maximum(doubled, 0.0)
    centre = (
        np.where(area[:, None] > 0.0, moment / np.where(area > 0.0, area, 1.0)[:, None], 0.0)
        + base[:, 0]
    )
    sides = following - corners
    return area / 2.0, centre, np.sqrt((sides * sides).sum(axis=2)).sum(axis=1)


def are_separate(first: Floats, second: Floats, depth: float) -> Bools:
    """Return which pairs of convex polygons overlap by less than `depth` across an edge of either (separating axes).

    Parameters
    ----------
    first : (n, k, 2), second : (n, m, 2) anticlockwise, short ones filled up with their last corner
    """
    return np.asarray(_is_separated(first, second, depth) | _is_separated(second, first, depth))


def clip_convex(subject: Floats, counts: Ints, clip: Floats) -> tuple[Floats, Ints]:
    """Return the polygons that pairs of convex polygons share (Sutherland & Hodgman 1974, all pairs at once).

    Parameters
    ----------
    subject : (n, k, 2) anticlockwise; counts : (n,) how many of the k corners each has
    clip : (n, m, 2) anticlockwise, short ones filled up with their last corner

    Returns
    -------
    (n, p, 2) polygons, short ones filled up with zeros, and the number of their corners: 0 where they share nothing

    Examples
    --------
    >>> square = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]])
    >>> shared, count = clip_convex(square, np.array([4]), square + 0.5)
    >>> float(polygon_sums(shared, count)[0][0])
    0.25
    """
    shared = subject
    for edge in range(clip.shape[1]):
        start = clip[:, edge]
        along = clip[:, (edge + 1) % clip.shape[1]] - start
        distance = along[:, None, 0] * (shared[:, :, 1] - start[:, None, 1]) - along[:, None, 1] * (
            shared[:, :, 0] - start[:, None, 0]
        )
        is_corner = _is_corner(shared, counts)
        following = np.arange(1, shared.shape[1] + 1) * np.ones((len(shared), 1), dtype=np.int64)
        following[following >= counts[:, None]] = 0
        next_distance = np.take_along_axis(distance, following, axis=1)
        inside, next_inside = distance >= 0.0, next_distance >= 0.0
        crosses = is_corner & (inside != next_inside)
        fraction = np.where(
            crosses, distance / np.where(crosses, distance - next_distance, 1.0), 0.0
        )
        next_corner = np.take_along_axis(shared, following[:, :, None], axis=1)
        cut = shared + fraction[:, :, None] * (next_corner - shared)
        doubled = 2 * shared.shape[1]
        is_kept = np.stack([is_corner & inside, crosses], axis=2).reshape(len(shared), doubled)
        corners = np.stack([shared, cut], axis=2).reshape(len(shared), doubled, 2)
        shared, counts = _packed(corners, is_kept)
    return shared, counts


def without_repeated_corners(
    polygons: Floats, counts: Ints, distance: float
) -> tuple[Floats, Ints]:
    """Return polygons without the corners that lie nearer than `distance` to the next corner."""
    following = np.arange(1, polygons.shape[1] + 1) * np.ones((len(polygons), 1), dtype=np.int64)
    following[following >= counts[:, None]] = 0
    step = np.take_along_axis(polygons, following[:, :, None], axis=1) - polygons
    return _packed(
        polygons, _is_corner(polygons, counts) & ((step * step).sum(axis=2) > distance * distance)
    )


def _is_corner(polygons: Floats, counts: Ints) -> Bools:
    return np.asarray(np.arange(polygons.shape[1]) < counts[:, None])


def _packed(corners: Floats, is_kept: Bools) -> tuple[Floats, Ints]:
    """Return the corners of each row that are kept, moved to its front, and how many there are."""
    counts = is_kept.sum(axis=1)
    packed = np.zeros((len(corners), int(counts.max(initial=1)), 2))
    row, column = np.nonzero(is_kept)
    place = (np.cumsum(is_kept, axis=1) - 1)[row, column]
    packed[row, place] = corners[row, column]
    return packed, counts.astype(np.int64)


def _is_separated(first: Floats, second: Floats, depth: float) -> Bools:
    """Return whether all corners of `second` lie less than `depth` inside one of the edges of `first`."""
    along = np.roll(first, -1, axis=1) - first
    length = np.sqrt((along * along).sum(axis=2))
    with np.errstate(invalid="ignore", divide="ignore"):
        outward = np.stack([along[:, :, 1], -along[:, :, 0]], axis=2) / length[:, :, None]
    nearest = np.full(length.shape, np.inf)
    for corner in range(second.shape[1]):
        step = second[:, corner, None] - first
        nearest = np.minimum(
            nearest, step[:, :, 0] * outward[:, :, 0] + step[:, :, 1] * outward[:, :, 1]
        )
    return np.asarray((np.where(length > 0.0, nearest, -np.inf) > -depth).any(axis=1))
