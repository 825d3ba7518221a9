"""Interfaces as panels: triangles for formats that know nothing else."""

import numpy as np

from slopekit.block_scene import Contacts
from slopekit.core.arrays import Floats, Ints


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
