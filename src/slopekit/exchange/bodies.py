"""A scene as it is written to files of other programs: bodies, states, line of intersection, interfaces as panels."""

from dataclasses import dataclass

import numpy as np

from slopekit.block_scene import BlockScene, Contacts
from slopekit.core.arrays import Floats, Ints, cross
from slopekit.geometry.solids.sliding_mass import volume_moments


@dataclass(frozen=True)
class WrittenBlock:
    """A block to write: its index in the scene, its name and its surface."""

    index: int
    name: str
    vertices: Floats
    triangles: Ints

    @property
    def middle(self) -> Floats:
        """The middle (3,) of its bounds, m."""
        middle: Floats = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2.0
        return middle

    @property
    def local(self) -> Floats:
        """Its vertices from its own middle, m."""
        return self.vertices - self.middle

    @property
    def volume(self) -> float:
        """m³, about its own middle."""
        return volume_moments(self.vertices, self.triangles)[0]

    @property
    def outline(self) -> Floats:
        """The near end (k, 3) of a block drawn out of a section: `prism` lists it first."""
        return self.vertices[: len(self.vertices) // 2]


def block_bodies(scene: BlockScene) -> tuple[WrittenBlock, ...]:
    """Every block of a scene with its surface."""
    shapes = scene.shapes
    return tuple(
        WrittenBlock(k, name, *shapes.solids.block_surface(k))
        for k, name in enumerate(shapes.names)
    )


def mechanism_state(scene: BlockScene, body: WrittenBlock) -> int:
    """Whether a block is bedrock, 0, stands, 1, or moves in a mechanism, 2."""
    return 0 if scene.shapes.fixed[body.index] else 2 if scene.order[body.index] else 1


def line_of_intersection(scene: BlockScene) -> Floats | None:
    """The two ends (2, 3) of the line of intersection of a wedge: the corners that its joints share; else None."""
    contacts = scene.shapes.contacts
    if len(scene.shapes.names) != 1 or not 2 <= len(contacts) <= 3:
        return None
    first, second = (contacts.corners[contacts.first[k] : contacts.first[k + 1]] for k in range(2))
    size = float(np.ptp(contacts.corners, axis=0).max())
    coincides = np.sqrt(((first[:, None] - second[None]) ** 2).sum(axis=2)) <= 1e-9 * size + 1e-8
    shared = first[coincides.any(axis=1)]
    return shared if len(shared) == 2 else None


# -- interfaces as panels ----------------------------------------------------------------------------------------------


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
    twice = cross(b - a, c - a)
    return np.bincount(panel, np.sqrt((twice * twice).sum(axis=1)) / 2.0, len(contacts)).astype(
        np.float64
    )
