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
    """Return the share of its cohesion that each friction force (g,) has: of rectangles in space, and in sections.

    A rectangle is cut by its diagonals; a corner has what is pressed of its two triangles, the middle of all four.
    """
    if model.unknowns == 3:
        return pressed_shares(patches, model, gaps)[model.group_contact]
    shares = np.ones(len(model.group_contact))
    for contact, patch in enumerate(model.patch):
        if patch < 0 or patch >= len(patches):
            continue
        corners = patches.corners[patches.first[patch] : patches.first[patch + 1]]
        pairs = np.flatnonzero(model.pair_contact == contact)
        assert (len(corners), len(pairs)) == (4, 5)
        places = np.concatenate([corners, corners.mean(axis=0)[None]])
        at = [pairs[np.argmin(((model.points[pairs] - place) ** 2).sum(axis=1))] for place in places]
        of_triangles = []
        for k in range(4):
            three = [k, (k + 1) % 4, 4]
            along, other = places[three[1]] - places[three[0]], places[4] - places[three[0]]
            across = other - along * (other @ along) / (along @ along)
            arms = places[three] - places[three[0]]
            flat = np.stack([arms @ along / np.sqrt(along @ along), arms @ across / np.sqrt(across @ across)], axis=1)
            of_triangles.append(pressed_part(flat, gaps[[at[j] for j in three]]))
        for k in range(4):
            shares[at[k]] = (of_triangles[k] + of_triangles[k - 1]) / 2.0
        shares[at[4]] = np.mean(of_triangles)
    return shares


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
