"""Layers of a scene: coloured triangles as plain arrays, which PNG, GLB and windows draw alike."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.block_scene import Shapes, prism
from slopekit.bolts import revolved
from slopekit.core.arrays import Bools, Floats, Ints, cross

Colour = tuple[int, int, int]
_MOST_SMOOTH_BALLS = 3000  # balls: beyond that they are rough
_ROCK_MARGIN = 0.28  # about a block, of its largest extent: the rock that is drawn
_COPLANAR_TOLERANCE = 1e-7  # of the size: a point this near to a plane lies on it
ROCK: Colour = (201, 199, 194)
BLOCK: Colour = (222, 165, 105)
STANDS: Colour = (236, 226, 207)
DARK: Colour = (64, 48, 36)
#: Bolts by how they act: a load, strength.
ACTIVE_BOLT: Colour = (200, 0, 80)
PASSIVE_BOLT: Colour = (20, 30, 90)
FALLS: Colour = (150, 40, 80)
UNSETTLED: Colour = (196, 150, 196)
#: Joints, in the order of the result; loads; contact modes; how blocks move. Told apart without red and green.
JOINTS: tuple[Colour, ...] = (
    (66, 114, 176),
    (146, 84, 156),
    (72, 152, 84),
    (42, 163, 163),
    (191, 91, 91),
    (228, 145, 47),
    (122, 106, 0),
)
LOADS: tuple[Colour, ...] = (
    (60, 60, 60),
    (206, 92, 24),
    (23, 150, 130),
    (188, 140, 20),
    (214, 96, 148),
    (120, 70, 50),
    (110, 130, 40),
)
MODE_COLOURS: Mapping[str, Colour] = {
    "stick": (49, 99, 149),
    "slip": (224, 122, 31),
    "open": (150, 150, 150),
}
MOTION_COLOURS: Mapping[str, Colour] = {
    "slides": (224, 122, 31),
    "topples": (150, 40, 80),
    "rotates": (128, 110, 190),
    "falls": (90, 90, 90),
    "lifts": (42, 163, 163),
}
# from dark to light, even steps to the eye (viridis, ten of its colours)
_SCALE = np.array(
    [
        (68, 1, 84),
        (72, 40, 120),
        (62, 74, 137),
        (49, 104, 142),
        (38, 130, 142),
        (31, 158, 137),
        (53, 183, 121),
        (109, 205, 89),
        (180, 222, 44),
        (253, 231, 37),
    ]
)


@dataclass(frozen=True)
class Layer:
    """Triangles of one kind.

    Attributes
    ----------
    name : what they are; vertices : (v, 3) m; triangles : (t, 3); colours : (t, 3) 0 to 255
    opacity : 0 to 1; outlined : whether their edges are drawn, those longer than `shortest` (m)
    front : how far before the rest a still draws them: 0 where they are, 1, 2, ... on top of each other
    """

    name: str
    vertices: Floats
    triangles: Ints
    colours: Ints
    opacity: float = 1.0
    outlined: bool = False
    front: int = 0
    shortest: float = 0.0


def layer(
    name: str,
    body: tuple[Floats, Ints],
    colour: Colour,
    opacity: float = 1.0,
    outlined: bool = False,
    front: int = 0,
    shortest: float = 0.0,
) -> Layer:
    """A layer of one colour."""
    vertices, triangles = body
    colours = np.tile(np.array(colour), (len(triangles), 1))
    return Layer(name, vertices, triangles, colours, opacity, outlined, front, shortest)


def blocks_layer(
    name: str,
    shapes: Shapes,
    chosen: Bools,
    colours: Ints,
    offset: Floats | None = None,
    opacity: float = 1.0,
) -> Layer:
    """Some blocks, outlined, each vertex where `offset` takes it, or in place.

    Parameters
    ----------
    chosen : (n,) blocks; colours : (n, 3); offset : (v, 3) m of every vertex of the solids
    """
    solids = shapes.solids
    is_chosen = chosen[solids.block]
    used, index = np.unique(solids.triangles[is_chosen], return_inverse=True)
    vertices = solids.vertices[used] if offset is None else (solids.vertices + offset)[used]
    return Layer(
        name,
        vertices,
        index.reshape(-1, 3),
        colours[solids.block[is_chosen]],
        opacity,
        outlined=True,
    )


def block_of_vertex(shapes: Shapes) -> Ints:
    """The block of each vertex of the solids, (v,)."""
    vertex_block = np.zeros(len(shapes.solids.vertices), dtype=np.int64)
    vertex_block[shapes.solids.triangles.ravel()] = np.repeat(shapes.solids.block, 3)
    return vertex_block


def rigid_displacement(shapes: Shapes, motion: Floats, points: Floats, point_block: Ints) -> Floats:
    """Return the displacements of points (p, 3) of blocks `point_block` (p,) under rigid motions (n, 6); -1: none.

    Rotations are carried out in full (Rodrigues), so that magnified blocks keep their shape.
    """
    displacement = np.zeros_like(points)
    on_block = np.flatnonzero(point_block >= 0)
    translation, rotation_vector = (
        motion[point_block[on_block], :3],
        motion[point_block[on_block], 3:],
    )
    arms = points[on_block] - shapes.centroids[point_block[on_block]]
    angle = np.sqrt((rotation_vector * rotation_vector).sum(axis=1))
    axis = rotation_vector / np.where(angle > 0.0, angle, 1.0)[:, None]
    about = cross(axis, arms)
    rotation = np.sin(angle)[:, None] * about + (1.0 - np.cos(angle))[:, None] * cross(axis, about)
    displacement[on_block] = translation + rotation
    return displacement


def spheres(centres: Floats, radius: float) -> tuple[Floats, Ints]:
    """Balls of one radius as vertices and triangles, rougher where there are many."""
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=1 if len(centres) <= _MOST_SMOOTH_BALLS else 0)
    count, size = len(centres), len(ball.vertices)
    points = (centres[:, None, :] + radius * ball.vertices).reshape(-1, 3)
    return points, (np.arange(count)[:, None, None] * size + ball.faces).reshape(-1, 3)


def arrows(starts: Floats, vectors: Floats, width: float) -> tuple[Floats, Ints]:
    """Arrows (k) as vertices and triangles, those without a length left out.

    Parameters
    ----------
    starts, vectors : (k, 3) m; width : m across the shafts of the longest (short ones are thinner)
    """
    lengths = np.sqrt((vectors * vectors).sum(axis=1))
    has_length = lengths > 0.0
    length, starts = lengths[has_length], starts[has_length]
    thick = np.minimum(width, 0.12 * length)
    neck = np.maximum(length - 3.6 * thick, 0.55 * length)
    along = np.stack([np.zeros_like(neck), neck, neck], axis=1)
    return revolved(starts, starts + vectors[has_length], along, np.outer(thick, [0.5, 0.5, 1.3]))


# -- the rock about one block -----------------------------------------------------------------------------------------


def free_triangles(shapes: Shapes) -> Bools:
    """Which triangles of the solids lie on no contact plane (t,), for one block."""
    solids, contacts = shapes.solids, shapes.contacts
    if solids.faces:
        joints = [k for k, name in enumerate(solids.faces) if name in shapes.joints]
        return ~np.isin(solids.face, joints)
    middle = solids.vertices.mean(axis=0)
    size = float(np.ptp(solids.vertices, axis=0).max())
    corners, normals = solids.vertices[solids.triangles] - middle, _double_area_vectors(shapes)
    lengths = np.sqrt((normals * normals).sum(axis=1))
    free: Bools = lengths > 1e-12 * size * size
    normals = normals / np.where(free, lengths, 1.0)[:, None]
    for k in range(len(contacts)):
        polygon = contacts.corners[contacts.first[k] : contacts.first[k + 1]] - middle
        normal = _unit_normal(polygon)
        on_contact = (
            np.abs((corners - polygon[0]) @ normal).max(axis=1) < _COPLANAR_TOLERANCE * size
        )
        free &= ~(on_contact & (np.abs(normals @ normal) > 0.999))
    return free


def free_normal(shapes: Shapes) -> Floats:
    """Out of the slope: the mean outward normal of the free faces, (3,) unit."""
    total = _double_area_vectors(shapes)[free_triangles(shapes)].sum(axis=0)
    size = math.sqrt(float(total @ total))
    return total / size if size > 0.0 else np.array([0.0, 0.0, 1.0])


def _double_area_vectors(shapes: Shapes) -> Floats:
    """Twice the areas of the triangles of the solids as vectors (t, 3) out of them."""
    corners = shapes.solids.vertices[shapes.solids.triangles]
    return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _unit_normal(polygon: Floats) -> Floats:
    normal = cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0]).sum(axis=0)
    unit: Floats = normal / math.sqrt(float(normal @ normal))
    return unit


def rock_around(shapes: Shapes) -> tuple[Floats, Ints] | None:
    """The rock that a convex block lies in, with the place of the block left open; None where there is none to draw.

    A box about the block, cut off along the block's free faces. In a section it is as thick as the block.
    """
    from manifold3d import Manifold

    free = free_triangles(shapes)
    if not free.any():
        return None
    vertices, _ = shapes.solids.block_surface(0)
    middle = vertices.mean(axis=0)
    low, high = vertices.min(axis=0) - middle, vertices.max(axis=0) - middle
    reach = _ROCK_MARGIN * float((high - low).max())
    low, high = low - reach, high + np.array([reach, reach, 0.3 * reach])
    body = Manifold.cube(tuple(high - low)).translate(tuple(low))
    corners, normals = (
        shapes.solids.vertices[shapes.solids.triangles[free, 0]] - middle,
        _double_area_vectors(shapes)[free],
    )
    normals = normals / np.sqrt((normals * normals).sum(axis=1))[:, None]
    for outward, corner in zip(normals, corners, strict=True):
        body = body.trim_by_plane(tuple(-outward), float(-outward @ corner))
    # the place of the block stays open a little beyond its free faces: faces that coincide would leave a film
    ends = normals[(normals @ normals.T < -1.0 + _COPLANAR_TOLERANCE).any(axis=1)]  # of a section
    offsets = [np.zeros(3), free_normal(shapes), *np.unique(np.round(ends, 6), axis=0)]
    swept_vertices = np.concatenate(
        [vertices - middle + 0.01 * float((high - low).max()) * offset for offset in offsets]
    )
    return _mesh_of_body(body - Manifold.hull_points(swept_vertices), middle)


def _body_of_mesh(vertices: Floats, triangles: Ints) -> Any:
    """A closed mesh as a body of manifold3d."""
    from manifold3d import Manifold, Mesh64

    return Manifold(
        Mesh64(np.array(vertices, order="C"), np.array(triangles, dtype=np.uint64, order="C"))
    )


def _mesh_of_body(body: Any, middle: Floats) -> tuple[Floats, Ints] | None:
    """The mesh of a body moved by `middle`, None where nothing is left of it."""
    mesh = body.to_mesh64()
    if len(mesh.tri_verts) == 0:
        return None
    return np.asarray(mesh.vert_properties)[:, :3] + middle, np.asarray(
        mesh.tri_verts, dtype=np.int64
    )


def ground_below(shapes: Shapes, profile: Sequence[Sequence[float]]) -> tuple[Floats, Ints] | None:
    """The ground below a profile (x, z) about a mass on a curved surface, with the place of the mass left open."""
    from manifold3d import Manifold

    vertices, triangles = shapes.solids.block_surface(0)
    middle = vertices.mean(axis=0)
    low, high = vertices.min(axis=0) - middle, vertices.max(axis=0) - middle
    reach = 0.25 * float((high - low).max())
    low, high = low - reach, high + reach
    line = np.asarray(profile, dtype=np.float64) - middle[[0, 2]]
    line = line if line[0, 0] < line[-1, 0] else line[::-1]
    begin, end = min(float(low[0]), float(line[0, 0])), max(float(high[0]), float(line[-1, 0]))
    bottom = min(float(low[2]), float(line[:, 1].min()) - reach)
    outline = np.array(
        [[begin, bottom], [end, bottom], [end, line[-1, 1]], *line[::-1], [begin, line[0, 1]]]
    )
    width = 2.0 * float(max(-low[1], high[1]))
    box = Manifold.cube((high[0] - low[0], width, 2.0 * (high[2] - low[2]))).translate(
        (low[0], -width / 2.0, low[2])
    )
    body = _body_of_mesh(*prism(outline, width)) ^ box
    inner = _mesh_of_body(body - _body_of_mesh(vertices - middle, triangles), np.zeros(3))
    # once more, a little out of the slope: faces that coincide would leave a film
    clearance = 0.004 * float((high - low).max()) * free_normal(shapes)
    return (
        None
        if inner is None
        else _mesh_of_body(
            _body_of_mesh(*inner) - _body_of_mesh(vertices - middle + clearance, triangles), middle
        )
    )


@dataclass(frozen=True)
class Bar:
    """A colour bar: what it shows and the values at its ends."""

    label: str
    low: float
    high: float

    def colours(self, values: Floats) -> Ints:
        """Colours (n, 3) of values (n,), those beyond the ends as the ends."""
        span = self.high - self.low
        fraction = np.clip(
            (values - self.low) / span if span > 0.0 else np.zeros_like(values), 0.0, 1.0
        )
        position = fraction * (len(_SCALE) - 1)
        lower = np.minimum(position.astype(np.int64), len(_SCALE) - 2)
        weight = (position - lower)[:, None]
        mixed = _SCALE[lower] * (1.0 - weight) + _SCALE[lower + 1] * weight
        rounded: Ints = np.rint(mixed).astype(np.int64)
        return rounded


@dataclass(frozen=True)
class Picture:
    """A scene before it is drawn.

    Attributes
    ----------
    title, subtitle : above it; notes : beneath it
    layers : what is seen; legend : (text, colour, opacity)
    eye : (3,) unit, from the scene toward the eye; bar : of what is coloured by value
    labels : (point (3,), text); has_label_lines : they stand beside their points, with a line to each
    """

    title: str
    subtitle: str
    layers: tuple[Layer, ...]
    legend: tuple[tuple[str, Colour, float], ...]
    eye: Floats
    notes: tuple[str, ...] = ()
    bar: Bar | None = None
    labels: tuple[tuple[Floats, str], ...] = ()
    has_label_lines: bool = False

    @property
    def points(self) -> Floats:
        """The corners (n, 3) of all that is seen, m."""
        return np.concatenate([layer.vertices[layer.triangles.ravel()] for layer in self.layers])
