"""Many pairs of convex polygons in a plane at once: whether they overlap, and the polygon that they share."""

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints


def polygon_sums(polygons: Floats, counts: Ints) -> tuple[Floats, Floats, Floats]:
    """Areas, centroids and perimeters of polygons given anticlockwise.

    Parameters
    ----------
    polygons : (n, k, 2); counts : (n,) how many of the k corners each has

    Returns
    -------
    (n,) areas (0 below three corners), (n, 2) centroids (the first corner where there is no area), (n,) perimeters
    """
    base = polygons[:, :1]
    here = np.where(_there(polygons, counts)[:, :, None], polygons, base) - base
    after = np.roll(here, -1, axis=1)
    cross = here[:, :, 0] * after[:, :, 1] - here[:, :, 1] * after[:, :, 0]
    doubled = cross.sum(axis=1)
    moment = ((here + after) * cross[:, :, None]).sum(axis=1) / 3.0
    area = np.maximum(doubled, 0.0)
    centre = np.where(area[:, None] > 0.0, moment / np.where(area > 0.0, area, 1.0)[:, None], 0.0) + base[:, 0]
    sides = after - here
    return area / 2.0, centre, np.sqrt((sides * sides).sum(axis=2)).sum(axis=1)


def are_apart(first: Floats, second: Floats, depth: float) -> Bools:
    """Whether convex polygons overlap by less than `depth` across some edge of one of them (separating axes).

    Parameters
    ----------
    first : (n, k, 2), second : (n, m, 2) anticlockwise, short ones filled up with their last corner
    """
    return np.asarray(_beyond(first, second, depth) | _beyond(second, first, depth))


def clip_convex(subject: Floats, counts: Ints, clip: Floats) -> tuple[Floats, Ints]:
    """The polygons that pairs of convex polygons share (Sutherland & Hodgman 1974, all pairs at once).

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
        away = along[:, None, 0] * (shared[:, :, 1] - start[:, None, 1]) - along[:, None, 1] * (
            shared[:, :, 0] - start[:, None, 0]
        )
        there = _there(shared, counts)
        following = np.arange(1, shared.shape[1] + 1) * np.ones((len(shared), 1), dtype=np.int64)
        following[following >= counts[:, None]] = 0
        next_away = np.take_along_axis(away, following, axis=1)
        inside, next_inside = away >= 0.0, next_away >= 0.0
        crosses = there & (inside != next_inside)
        share = np.where(crosses, away / np.where(crosses, away - next_away, 1.0), 0.0)
        ahead = np.take_along_axis(shared, following[:, :, None], axis=1)
        cut = shared + share[:, :, None] * (ahead - shared)
        doubled = 2 * shared.shape[1]
        kept = np.stack([there & inside, crosses], axis=2).reshape(len(shared), doubled)
        corners = np.stack([shared, cut], axis=2).reshape(len(shared), doubled, 2)
        shared, counts = _packed(corners, kept)
    return shared, counts


def without_near(polygons: Floats, counts: Ints, distance: float) -> tuple[Floats, Ints]:
    """Polygons without the corners that lie nearer than `distance` to the next one."""
    following = np.arange(1, polygons.shape[1] + 1) * np.ones((len(polygons), 1), dtype=np.int64)
    following[following >= counts[:, None]] = 0
    step = np.take_along_axis(polygons, following[:, :, None], axis=1) - polygons
    return _packed(polygons, _there(polygons, counts) & ((step * step).sum(axis=2) > distance * distance))


def _there(polygons: Floats, counts: Ints) -> Bools:
    return np.asarray(np.arange(polygons.shape[1]) < counts[:, None])


def _packed(corners: Floats, kept: Bools) -> tuple[Floats, Ints]:
    """The kept corners of each row, moved together."""
    counts = kept.sum(axis=1)
    packed = np.zeros((len(corners), int(counts.max(initial=1)), 2))
    row, column = np.nonzero(kept)
    place = (np.cumsum(kept, axis=1) - 1)[row, column]
    packed[row, place] = corners[row, column]
    return packed, counts.astype(np.int64)


def _beyond(first: Floats, second: Floats, depth: float) -> Bools:
    """Whether all corners of `second` lie less than `depth` inside one of the edges of `first`."""
    along = np.roll(first, -1, axis=1) - first
    length = np.sqrt((along * along).sum(axis=2))
    with np.errstate(invalid="ignore", divide="ignore"):
        out = np.stack([along[:, :, 1], -along[:, :, 0]], axis=2) / length[:, :, None]
    nearest = np.full(length.shape, np.inf)
    for corner in range(second.shape[1]):
        step = second[:, corner, None] - first
        nearest = np.minimum(nearest, step[:, :, 0] * out[:, :, 0] + step[:, :, 1] * out[:, :, 1])
    return np.asarray((np.where(length > 0.0, nearest, -np.inf) > -depth).any(axis=1))
