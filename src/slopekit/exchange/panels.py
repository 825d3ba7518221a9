"""Interfaces as panels: triangles for formats that know nothing else, and what the node pairs say of each panel."""

import numpy as np

from slopekit.block_scene import BlockScene, Contacts
from slopekit.core.arrays import Floats, Ints
from slopekit.core.records import dataclass

_NEAREST = 12  # panels that a node pair may lie on, by the distance of their triangles' middles


@dataclass(frozen=True, slots=True)
class PanelStates:
    """What the node pairs on each panel (k) add up to; nan and -1 where none lies on it.

    Attributes
    ----------
    area_m2 : of the panels; normal_stress_kpa, shear_stress_kpa : means over the pairs' control areas
    mode : the contact mode of the largest part of the control area
    """

    area_m2: Floats
    normal_stress_kpa: Floats
    shear_stress_kpa: Floats
    mode: Ints


def triangles_of(contacts: Contacts) -> tuple[Ints, Ints]:
    """Triangles (t, 3), indices into the corners, and the panel (t,) of each: fans, for every panel is convex."""
    sizes = np.diff(contacts.first)
    fans = np.maximum(sizes - 2, 0)
    panel = np.repeat(np.arange(len(sizes)), fans)
    step = np.arange(len(panel)) - np.repeat(np.cumsum(fans) - fans, fans)
    start = contacts.first[panel]
    triangles = np.stack([start, start + step + 1, start + step + 2], axis=1)
    return triangles.astype(np.int64), panel.astype(np.int64)


def areas_of(contacts: Contacts) -> Floats:
    """The areas (k,) of the panels, m²."""
    triangles, panel = triangles_of(contacts)
    a, b, c = (contacts.corners[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    return np.bincount(panel, np.sqrt((cross * cross).sum(axis=1)) / 2.0, len(contacts)).astype(np.float64)


def panel_states(scene: BlockScene) -> PanelStates:
    """The stresses on every panel of a scene, from the node pairs that lie on it."""
    contacts, pairs = scene.shapes.contacts, scene.pairs
    count = len(contacts)
    area = areas_of(contacts)
    at = _panel_of_pair(scene)
    on, at = np.flatnonzero(at >= 0), at[at >= 0]
    control = np.bincount(at, pairs.control_area_m2[on], count)
    normal = np.bincount(at, pairs.normal_kn[on], count)
    shear = np.stack([np.bincount(at, pairs.shear_kn[on, k], count) for k in range(3)], axis=1)
    by_mode = np.zeros((count, 3))
    np.add.at(by_mode, (at, pairs.mode[on]), pairs.control_area_m2[on])
    bare = control <= 0.0
    over = np.where(bare, np.nan, control)
    mode = np.where(bare, -1, by_mode.argmax(axis=1))
    return PanelStates(area, normal / over, np.sqrt((shear * shear).sum(axis=1)) / over, mode.astype(np.int64))


def _panel_of_pair(scene: BlockScene) -> Ints:
    """The panel that each node pair lies on: the nearest of the same joint and blocks; -1 where there is none."""
    from scipy.spatial import cKDTree

    contacts, pairs = scene.shapes.contacts, scene.pairs
    result = np.full(len(pairs), -1, dtype=np.int64)
    if not len(pairs) or not len(contacts):
        return result
    keys = np.concatenate([_keys(contacts.joint, contacts.plus, contacts.minus, len(scene.shapes.names)),
                           _keys(pairs.joint, pairs.plus, pairs.minus, len(scene.shapes.names))])  # fmt: skip
    of_panel, of_pair = keys[: len(contacts)], keys[len(contacts) :]
    order = np.argsort(of_panel, kind="stable")
    begin, end = np.searchsorted(of_panel[order], of_pair), np.searchsorted(of_panel[order], of_pair, side="right")
    alone = end - begin == 1
    result[alone] = order[begin[alone]]
    several = np.flatnonzero(end - begin > 1)
    if not len(several):
        return result
    origin = contacts.corners.mean(axis=0)
    triangles, panel = triangles_of(contacts)
    corners = (contacts.corners - origin)[triangles]
    middles = corners.mean(axis=1)
    for key in np.unique(of_pair[several]).tolist():
        own = np.flatnonzero(of_panel[panel] == key)
        here = several[of_pair[several] == key]
        points = pairs.points_m[here] - origin
        _, near = cKDTree(middles[own]).query(points, k=min(_NEAREST, len(own)))
        near = own[near.reshape(len(here), -1)]
        away = _distances(corners[near], points)
        result[here] = panel[near[np.arange(len(here)), away.argmin(axis=1)]]
    return result


def _keys(joint: Ints, plus: Ints, minus: Ints, blocks: int) -> Ints:
    low, high = np.minimum(plus, minus) + 1, np.maximum(plus, minus) + 1
    keys: Ints = (joint * (blocks + 1) + low) * (blocks + 1) + high
    return keys


def _distances(triangles: Floats, points: Floats) -> Floats:
    """Distances (n, k) of points (n, 3) to triangles (n, k, 3, 3)."""
    from trimesh.triangles import closest_point

    count, near = triangles.shape[:2]
    spread = np.repeat(points, near, axis=0)
    apart = closest_point(triangles.reshape(-1, 3, 3), spread) - spread
    distances: Floats = np.sqrt((apart * apart).sum(axis=1)).reshape(count, near)
    return distances
