"""The scene of a result as the rotatable view of the report takes it: local float32 about the middle, edges, motions.

Map coordinates have seven digits before the point, float32 has seven in all: the middle is taken off in float64 first.
"""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.block_scene import MODES, BlockScene, Contacts, Shapes, Solids, joined, unreadable
from slopekit.core.arrays import Floats, Ints
from slopekit.core.codec import MISREAD, is_of_document
from slopekit.core.orientation import line_of
from slopekit.exchange.bodies import triangles_of
from slopekit.views.solid.layers import (
    ACTIVE_BOLT,
    BLOCK,
    FALLS,
    JOINTS,
    MODE_COLOURS,
    PASSIVE_BOLT,
    ROCK,
    STANDS,
    UNSETTLED,
)
from slopekit.views.solid.stage import Stage

_SMOOTH = np.radians(30.0)  # triangles of one face that bend by less have no edge between them
_FLAT = np.radians(1.0)
_LARGEST_MOTION = 0.25  # of the scene's size: the most that the mechanism's slider moves a block
_EXPLOSION = 0.7  # of its distance from the others: how far the exploded view moves a block


def viewer_data(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of the viewer as JSON values; arrays are `{"type": ..., "base64": ...}`, little-endian, C order.

    Parameters
    ----------
    document : the JSON of a result

    Raises
    ------
    DesignError
        E350 where its scene cannot be read. KeyError, TypeError, ValueError, IndexError where it is damaged.
    """
    return data_of(read_stage(document))


def data_of(stage: Stage) -> dict[str, Any]:
    """Return the data of the viewer for a stage."""
    scene = _with_rock(stage)
    rock = len(scene.shapes.names) - len(
        stage.scene.shapes.names
    )  # drawn about a lone block, without a colour of its own
    shapes, pairs, loads, bolts = scene.shapes, scene.pairs, scene.loads, scene.known_bolts
    vertices, triangles, owner = _split_by_block(shapes.solids)
    middle, size = _middle(vertices if len(vertices) else shapes.contacts.corners)
    displacement = _velocities(vertices, shapes.centroids, scene.velocity, owner)
    fastest = float(np.linalg.norm(displacement, axis=1).max(initial=0.0))
    scale = _LARGEST_MOTION * size / fastest if fastest > 0.0 else 0.0
    corners, joint, minus, outline = _surfaces(shapes.contacts)
    area = np.where(pairs.control_area_m2 > 0.0, pairs.control_area_m2, np.nan)
    return {
        "middle_m": [float(value) for value in middle],
        "size_m": size,
        "look_from": _look_from(stage.eye),
        "names": list(shapes.names),
        "faces": list(shapes.solids.faces),
        "joints": list(shapes.joints),
        "palette": [_hex(colour) for colour in JOINTS],
        "block_colour": _hex(BLOCK),
        "rock_colour": _hex(ROCK),
        "falls_colour": _hex(FALLS),
        "unsettled_colour": _hex(UNSETTLED),
        "stands_colour": _hex(STANDS),
        "plain": [_hex(colour) for colour in stage.block_colours().tolist()] + [_hex(ROCK)] * rock,
        "falls": [*stage.without_strength.astype(int).tolist(), *[0] * rock],
        "unsettled": [*stage.unsettled.astype(int).tolist(), *[0] * rock],
        "mode_colours": [_hex(MODE_COLOURS[mode]) for mode in MODES],
        "modes": list(MODES),
        "load_names": list(loads.names),
        "fixed": shapes.fixed.astype(int).tolist(),
        "order": scene.order.astype(int).tolist(),
        "factor": [float(value) if np.isfinite(value) else None for value in scene.factor],
        "centroids": _packed_float32(shapes.centroids - middle),
        "explode": _packed_float32(
            np.append(_EXPLOSION * stage.explosion_vectors, np.zeros((rock, 3)), axis=0)
        ),
        "velocity": _packed_float32(scene.velocity * scale),
        "vertices": _packed_float32(vertices - middle),
        "triangles": _packed_int32(triangles),
        "triangle_block": _packed_int32(shapes.solids.block),
        "triangle_face": _packed_int32(shapes.solids.face),
        "edges": _packed_int32(_edges(vertices, triangles, shapes.solids.face)),
        "joint_corners": _packed_float32(corners - middle),
        "joint_of": _packed_int32(joint),
        "joint_block": _packed_int32(minus),
        "joint_outline": _packed_float32(outline - middle),
        "pairs": _packed_float32(pairs.points_m - middle),
        "pair_mode": _packed_int32(pairs.mode),
        "pair_block": _packed_int32(np.where(pairs.plus >= 0, pairs.plus, pairs.minus)),
        "pair_kpa": _packed_float32(pairs.normal_kn / area),
        "pair_kn": _packed_float32(pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn),
        "load_what": _packed_int32(loads.what),
        "load_block": _packed_int32(loads.block),
        "load_kn": _packed_float32(loads.force_kn),
        "load_at": _packed_float32(loads.at_m - middle),
        "bolt_number": _packed_int32(bolts.number),
        "bolt_block": _packed_int32(bolts.block),
        "bolt_passive": _packed_int32(bolts.passive.astype(np.int64)),
        "bolt_kn": _packed_float32(bolts.force_kn),
        "bolt_heads": _packed_float32(bolts.heads_m - middle),
        "bolt_ends": _packed_float32(bolts.ends_m - middle),
        "bolt_plates": _packed_float32(bolts.plates),
        "bolt_colours": [_hex(ACTIVE_BOLT), _hex(PASSIVE_BOLT)],
        "bolt_plate_m": stage.plate_width,
    }


def read_stage(document: Mapping[str, Any]) -> Stage:
    """The stage of a document, its arrays fitting each other.

    Raises
    ------
    DesignError
        E350 where its scene cannot be read, or its arrays do not fit.
    """
    stage = Stage.from_document(document)
    try:
        fits = _fits(stage.scene) and all(
            isinstance(name, str) for name in stage.scene.shapes.names
        )
        eye, inputs = stage.eye, document.get("inputs") or {}
        fits = fits and eye.shape == (3,)
        np.asarray(inputs.get("profile_m") or [], dtype=np.float64).reshape(-1, 2)
    except MISREAD as error:
        if not is_of_document(error):
            raise
        raise unreadable(f"{type(error).__name__}: {error}") from None
    if not fits:
        raise unreadable("its arrays do not fit each other")
    return stage


def _fits(scene: BlockScene) -> bool:
    """Whether all arrays have the sizes and hold the indices that they need."""
    shapes, pairs, loads = scene.shapes, scene.pairs, scene.loads
    solids, contacts = shapes.solids, shapes.contacts
    n, t, p, k, c = (
        len(shapes.names),
        len(solids.triangles),
        len(pairs.joint),
        len(loads.what),
        len(contacts.joint),
    )
    bolts = scene.known_bolts
    b = len(bolts)
    sizes: list[tuple[Any, tuple[int, ...]]] = [
        (shapes.fixed, (n,)),
        (shapes.centroids, (n, 3)),
        (scene.velocity, (n, 6)),
        (scene.order, (n,)),
        (scene.factor, (n,)),
        (solids.vertices, (len(solids.vertices), 3)),
        (solids.triangles, (t, 3)),
        (solids.block, (t,)),
        (solids.face, (t,)),
        (contacts.corners, (len(contacts.corners), 3)),
        (contacts.first, (c + 1,)),
        (contacts.minus, (c,)),
        (contacts.joint, (c,)),
        (pairs.points_m, (p, 3)),
        (pairs.control_area_m2, (p,)),
        (pairs.normals, (p, 3)),
        (pairs.plus, (p,)),
        (pairs.minus, (p,)),
        (pairs.normal_kn, (p,)),
        (pairs.shear_kn, (p, 3)),
        (pairs.mode, (p,)),
        (loads.block, (k,)),
        (loads.force_kn, (k, 3)),
        (loads.at_m, (k, 3)),
        (bolts.number, (b,)),
        (bolts.block, (b,)),
        (bolts.heads_m, (b, 3)),
        (bolts.ends_m, (b, 3)),
        (bolts.plates, (b, 3)),
        (bolts.passive, (b,)),
        (bolts.force_kn, (b,)),
        (bolts.length_m, (b,)),
    ]
    indices: list[tuple[Any, int, int]] = [
        (solids.triangles, 0, len(solids.vertices)),
        (solids.block, 0, n),
        (solids.face, -1, len(solids.faces)),
        (contacts.minus, -1, n),
        (contacts.joint, 0, len(shapes.joints)),
        (contacts.first, 0, len(contacts.corners) + 1),
        (pairs.plus, -1, n),
        (pairs.minus, -1, n),
        (pairs.mode, 0, len(MODES)),
        (loads.block, -1, n),
        (loads.what, 0, len(loads.names)),
        (bolts.block, -1, n),
        (bolts.number, 1, 1 << 31),
    ]
    return all(np.shape(values) == size for values, size in sizes) and all(
        not values.size or (values.min() >= low and values.max() < high)
        for values, low, high in indices
    )


def _with_rock(stage: Stage) -> BlockScene:
    """The scene with the rock about a lone block, which the analysis needs no block for, as one of bedrock."""
    scene, shapes = stage.scene, stage.scene.shapes
    rock_layers = stage.rock() if stage.has_single_block else []
    if not rock_layers:
        return scene
    body = rock_layers[0].vertices, rock_layers[0].triangles
    solids = shapes.solids
    vertices, triangles, body_of_triangle = joined([(solids.vertices, solids.triangles), body])
    block = np.where(
        body_of_triangle == 0,
        np.append(solids.block, np.zeros(len(body[1]), dtype=np.int64)),
        len(shapes.names),
    )
    face = np.append(solids.face, np.full(len(body[1]), -1))
    none = np.zeros((1, 6))
    return replace(
        scene,
        shapes=Shapes(
            (*shapes.names, "rock"),
            np.append(shapes.fixed, True),
            np.concatenate([shapes.centroids, body[0].mean(axis=0)[None, :]]),
            shapes.joints,
            Solids(vertices, triangles, block, face, solids.faces),
            shapes.contacts,
        ),
        velocity=np.concatenate([scene.velocity, none]),
        order=np.append(scene.order, 0),
        factor=np.append(scene.factor, np.nan),
    )


def _hex(colour: Sequence[int]) -> str:
    return "#" + "".join(f"{component:02x}" for component in colour)


def _packed_float32(values: Floats) -> dict[str, str]:
    return {
        "type": "f32",
        "base64": base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode(),
    }


def _packed_int32(values: Ints) -> dict[str, str]:
    return {
        "type": "i32",
        "base64": base64.b64encode(np.ascontiguousarray(values, dtype="<i4").tobytes()).decode(),
    }


def _middle(points: Floats) -> tuple[Floats, float]:
    """The middle of the box about points (n, 3), and its diagonal."""
    if not len(points):
        return np.zeros(3), 1.0
    low, high = points.min(axis=0), points.max(axis=0)
    return (low + high) / 2.0, max(float(np.linalg.norm(high - low)), 1e-9)


def _split_by_block(solids: Solids) -> tuple[Floats, Ints, Ints]:
    """Vertices (v, 3) that belong to one block each, triangles (t, 3), and the block of each vertex (v,)."""
    if not len(solids.triangles):
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64)
    keys = np.stack([np.repeat(solids.block, 3), solids.triangles.ravel()], axis=1)
    used, index = np.unique(keys, axis=0, return_inverse=True)
    return solids.vertices[used[:, 1]], index.reshape(-1, 3), used[:, 0]


def _velocities(points: Floats, centroids: Floats, velocity: Floats, block: Ints) -> Floats:
    """Return the displacements of points (n, 3) of blocks (n,): u + ω × (x - c), small rotations."""
    if not len(points):
        return np.zeros((0, 3))
    return velocity[block, :3] + np.cross(velocity[block, 3:], points - centroids[block])


def _edges(vertices: Floats, triangles: Ints, face: Ints) -> Ints:
    """Edges (e, 2) worth drawing: where faces meet at an angle, or a triangle has no neighbour.

    Triangles of one known face are a curved surface: there only bends of more than 30° count.
    """
    from trimesh import Trimesh
    from trimesh.grouping import group_rows

    mesh = Trimesh(vertices, triangles, process=False)
    sound = mesh.area_faces > 0.0
    mesh, face = Trimesh(vertices, triangles[sound], process=False), face[sound]
    first, second = mesh.face_adjacency.T
    is_curved = (face[first] == face[second]) & (face[first] >= 0)
    bends = mesh.face_adjacency_angles > np.where(is_curved, _SMOOTH, _FLAT)
    free_edges = group_rows(mesh.edges_sorted, require_count=1)
    return np.concatenate([mesh.face_adjacency_edges[bends], mesh.edges_sorted[free_edges]]).astype(
        np.int64
    )


def _surfaces(contacts: Contacts) -> tuple[Floats, Ints, Ints, Floats]:
    """The interfaces as triangles: corners (3t, 3), joint (t,), block they stay with (t,), outlines (2o, 3)."""
    triangles, panel = triangles_of(contacts)
    outline = np.zeros((0, 2), dtype=np.int64)
    if (
        len(contacts) <= 60 or np.ptp(contacts.joint) > 0
    ):  # hundreds of triangles of a curved surface say nothing
        next_corner = np.arange(1, len(contacts.corners) + 1)
        next_corner[contacts.first[1:] - 1] = contacts.first[:-1]
        outline = np.stack([np.arange(len(next_corner)), next_corner], axis=1)
    corners, lines = (contacts.corners[index].reshape(-1, 3) for index in (triangles, outline))
    return corners, contacts.joint[panel], contacts.minus[panel], lines


def _look_from(eye: Floats) -> list[float]:
    """Bearing of the eye and its height above the horizon, degrees."""
    line = line_of(eye)
    return [line.trend_deg, -line.plunge_deg]
