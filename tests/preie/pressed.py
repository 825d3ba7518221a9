"""The pressed part of contacts by clipping their polygons: a judge that shares no line with `system.contact_cells`."""

import numpy as np

from slopekit.geometry.patches import Patches
from slopekit.preie.system.assembly import AssemblyModel


def pressed_shares(patches: Patches, model: AssemblyModel, gaps: np.ndarray) -> np.ndarray:
    """Return the share (k,) of each contact that is pressed where its node pairs have these gaps (m,).

    The gap of a contact is the linear function that its pairs have; bolts, which are no patches, have a share of one.
    """
    shares = np.ones(len(model.plus))
    for contact, patch in enumerate(model.patch):
        if patch < 0 or patch >= len(patches):
            continue
        corners = patches.corners[patches.first[patch] : patches.first[patch + 1]]
        middle = corners.mean(axis=0)
        _, _, axes = np.linalg.svd(corners - middle)
        flat = (corners - middle) @ axes[:2].T
        pairs = np.flatnonzero(model.pair_contact == contact)
        at = np.column_stack([np.ones(len(pairs)), (points_of(model, pairs) - middle) @ axes[:2].T])
        plane = np.linalg.lstsq(at, gaps[pairs], rcond=None)[0]
        shares[contact] = pressed_part(flat, plane[0] + flat @ plane[1:])
    return shares


def pressed_shares_of_pairs(patches: Patches, model: AssemblyModel, gaps: np.ndarray) -> np.ndarray:
    """Return the share of its cohesion that each friction force (g,) has.

    In space a contact is cut into triangles about its centroid (a triangle is one): a pair has what is pressed of those
    that it lies in, in parts of the area that it controls there, A/12 at a corner and 3A/4 in the middle; of a
    parallelogram A/6 at its corners and 2A/3 at its own centroid.
    """
    if model.unknowns == 3:
        return pressed_shares(patches, model, gaps)[model.group_contact]
    shares = np.ones(len(model.group_contact))
    for contact, patch in enumerate(model.patch):
        if patch < 0 or patch >= len(patches):
            continue
        corners = patches.corners[patches.first[patch] : patches.first[patch + 1]]
        pairs = np.flatnonzero(model.pair_contact == contact)
        acts, whole = np.zeros(len(pairs)), np.zeros(len(pairs))
        for triangle in (
            [corners] if len(corners) == 3 else fan_of(corners, patches.centroids[patch])
        ):
            places = np.concatenate([triangle, triangle.mean(axis=0)[None]])
            away = ((model.points[pairs] - places[:, None]) ** 2).sum(axis=2)
            near, is_pair = (
                away.argmin(axis=1),
                away.min(axis=1) < 1e-9 * np.ptp(corners, axis=0).max() ** 2,
            )
            weights = (
                np.array([1.0, 1.0, 1.0, 9.0]) if is_pair[3] else np.array([2.0, 2.0, 8.0, 0.0])
            )
            _, _, axes = np.linalg.svd(triangle - triangle.mean(axis=0))
            flat = (triangle - triangle[0]) @ axes[:2].T
            area = shoelace(flat)
            np.add.at(acts, near, weights * area * pressed_part(flat, gaps[pairs[near[:3]]]))
            np.add.at(whole, near, weights * area)
        shares[pairs] = acts / whole
    return shares


def fan_of(corners: np.ndarray, middle: np.ndarray) -> list[np.ndarray]:
    """Return the triangles (3, 3) of a polygon (n, 3) about a point."""
    return [np.array([corners[k - 1], corners[k], middle]) for k in range(len(corners))]


def points_of(model: AssemblyModel, pairs: np.ndarray) -> np.ndarray:
    """Return where node pairs are, m."""
    return model.points[pairs]


def pressed_part(corners: np.ndarray, gaps: np.ndarray) -> float:
    """Return the part of a convex polygon (n, 2), or of a segment, where a linear gap (n,) of its corners is negative.

    Sutherland and Hodgman's clipping by one half plane, and the shoelace formula.
    """
    if len(corners) == 2:
        low, high = np.sort(gaps)
        return 1.0 if high <= 0.0 else 0.0 if low >= 0.0 else float(low / (low - high))
    kept = []
    for k in range(len(corners)):
        here, there, gap, next_gap = corners[k - 1], corners[k], gaps[k - 1], gaps[k]
        if (gap < 0.0) != (next_gap < 0.0):
            kept.append(here + (there - here) * gap / (gap - next_gap))
        if next_gap < 0.0:
            kept.append(there)
    return shoelace(np.array(kept)) / shoelace(corners) if kept else 0.0


def shoelace(corners: np.ndarray) -> float:
    """Return the area of a polygon (n, 2)."""
    x, y = corners.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0
