"""Cut a rock mass along planes with manifold3d, in double precision, every face knowing its plane.

A body is cut in a frame of its own: moved to the block's box and scaled by it along each axis, so that a wedge
48 km long and 10 m wide is as easy as a cube. manifold3d gives the pieces and, by provenance (`face_id`), which
plane made each face. The corners are then computed again from the planes that meet in them: they are as exact as
the input, whatever the kernel's tolerance was.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from slopekit.core.arrays import Floats, Ints, cross, frozen
from slopekit.core.errors import Fault, GeometryError
from slopekit.geometry.rock.rockmass import CRACK, FACE, J1, J2, RockMass

_FAR = 1000  # ids of the six outer faces of the body, 1000 to 1005: the rock goes on behind them
_REMEMBERED = 64  # wedges
_ON = 1e-12  # of the size of a wedge: its crest is on the crack
_SHAPES = ((-1, 3), (-1,), (-1, 3))  # of normals, offsets and corners
_REACH = 12.0  # of a half-space
_CUTTER_BACK = 2000  # id of the faces of a cutter that lie outside the body and cut nothing
#: The triangles of a box whose corners are numbered around the first face, then around the opposite one.
BOX_TRIANGLES = np.array(
    [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
     [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]], dtype=np.int64,
)  # fmt: skip
_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_SQUARE_BOX = np.array([[x, y, z] for z in (-1.0, 1.0) for x, y in _SQUARE.tolist()])


@dataclass(frozen=True)
class Block:
    """A block: its faces as polygons by the plane that made them.

    Attributes
    ----------
    faces : plane id -> (k, 3) corners in m, anticlockwise seen from outside
    areas : plane id -> area in m²
    volume : m³
    centroid : (3,) m
    """

    faces: Mapping[int, Floats]
    areas: Mapping[int, float]
    volume: float
    centroid: Floats

    @property
    def corners(self) -> Floats:
        """All corners of all faces, (n, 3), repeated where faces share them."""
        return np.concatenate(list(self.faces.values()))


def cut_wedge(rock: RockMass) -> Block:
    """The removable wedge of a rock mass.

    Raises
    ------
    GeometryError
        E208 the planes enclose none, or two; E207 the crack does not bound it.
    """
    return _wedge_of(rock.normals.tobytes(), rock.offsets.tobytes(), rock.corners.tobytes())


@lru_cache(maxsize=_REMEMBERED)
def _wedge_of(*rock: bytes) -> Block:
    """The wedge of a rock mass by its normals, offsets and corners: a study changes the strength of one more often."""
    normals, offsets, corners = (np.frombuffer(part).reshape(shape) for part, shape in zip(rock, _SHAPES, strict=True))
    sides = np.copysign(1.0, offsets - normals @ corners.mean(axis=0))
    sides[CRACK:] = np.copysign(1.0, offsets[CRACK:])  # the toe lies in front of the crack
    behind = (corners[2:] @ normals[CRACK:].T - offsets[CRACK:]) * sides[CRACK:]
    if (behind > _ON * np.abs(corners).max()).any():
        message = "the crack cuts the wedge in two below its crest: both parts are free to leave the rock"
        raise GeometryError([Fault("E208", message)])
    block = cut_convex(normals * sides[:, None], offsets * sides, corners)
    if not {J1, J2, FACE} <= block.faces.keys():
        raise GeometryError([Fault("E208", "joints and face bound no wedge: one of them does not reach it")])
    if len(normals) > CRACK and CRACK not in block.faces:
        raise GeometryError([Fault("E207", "the crack does not bound the wedge between the toe and its back")])
    return block


def cut_convex(normals: Floats, offsets: Floats, outline: Floats) -> Block:
    """The block below all the planes `normal · x <= offset`, its faces by the number of their plane.

    Parameters
    ----------
    outline : (n, 3) points between which the block lies

    Raises
    ------
    GeometryError
        E208 nothing lies below all of them.
    """
    block = half_spaces_cut(dict(enumerate(normals)), dict(enumerate(offsets)), outline)
    if block is None:
        raise GeometryError([Fault("E208", "the planes enclose no block")])
    return block


def half_spaces_cut(normals: Mapping[int, Floats], offsets: Mapping[int, float], outline: Floats) -> Block | None:
    """The block below all of some planes `normal · x <= offset`, faces by their ids; None where it has no end.

    Parameters
    ----------
    outline : (n, 3) its corners

    Raises
    ------
    GeometryError
        E208 nothing lies below all of them.
    """
    lowest, highest = outline.min(axis=0), outline.max(axis=0)
    centre, half = (lowest + highest) / 2.0, (highest - lowest) / 2.0
    planes, rows, at = list(normals), np.zeros((max(normals) + 1, 3)), np.zeros(max(normals) + 1)
    rows[planes], at[planes] = list(normals.values()), [offsets[plane] for plane in planes]
    scaled = rows[planes] * half
    lengths = np.sqrt((scaled**2).sum(axis=1))
    away = (at[planes] - rows[planes] @ centre) / lengths
    piece = far_box(1.5, _FAR)
    for plane, normal, offset in zip(planes, scaled / lengths[:, None], away, strict=True):
        piece = piece.split(half_space(normal, float(offset), plane, _CUTTER_BACK))[1]
    if piece.is_empty():
        raise GeometryError([Fault("E208", "the planes enclose no block")])
    mesh = piece.to_mesh64()
    return None if int(np.asarray(mesh.face_id).max()) >= _FAR else _block(mesh, rows, at, centre, half)


def _block(mesh: Mesh64, normals: Floats, offsets: Floats, centre: Floats, half: Floats) -> Block:
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    made_by = np.asarray(mesh.face_id, dtype=np.int64)
    rough = np.asarray(mesh.vert_properties) * half + centre
    meeting: list[set[int]] = [set() for _ in range(len(rough))]
    for corners, plane in zip(triangles.tolist(), made_by.tolist(), strict=True):
        for corner in corners:
            meeting[corner].add(plane)
    exact = np.array(
        [
            _corner(normals[sorted(planes)], offsets[sorted(planes)], point)
            for planes, point in zip(meeting, rough, strict=True)
        ]
    )
    faces = {int(plane): frozen(exact[_outline(triangles[made_by == plane])]) for plane in sorted(set(mesh.face_id))}
    volume = 0.0
    moment: Floats = np.zeros(3)
    apex = exact[0]
    areas = {}
    for plane, polygon in faces.items():
        vector: Floats = np.zeros(3)
        for b, c in zip(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0], strict=True):
            vector = np.asarray(vector + cross(b, c) / 2.0, dtype=np.float64)
        areas[plane] = math.sqrt(float(vector @ vector))
        a = polygon[0] - apex
        for b, c in zip(polygon[1:-1] - apex, polygon[2:] - apex, strict=True):
            part = float(np.linalg.det(np.array([a, b, c]))) / 6.0
            volume += part
            moment = np.asarray(moment + part * (a + b + c) / 4.0, dtype=np.float64)
    if not volume > 0.0:
        raise GeometryError([Fault("E208", "the block has no volume")])
    return Block(faces, areas, volume, frozen(apex + moment / volume))


def _corner(normals: Floats, offsets: Floats, rough: Floats) -> Floats:
    """The point in which the planes meet, from the planes themselves."""
    if len(normals) == 3:
        return np.asarray(np.linalg.solve(normals, offsets), dtype=np.float64)
    # more planes than three through one point: the nearest point to all; fewer: a vertex on an edge
    return rough + np.asarray(np.linalg.lstsq(normals, offsets - normals @ rough, rcond=None)[0])


def _outline(triangles: Ints) -> list[int]:
    """The closed outline of a patch of triangles as vertex indices, in the triangles' own sense."""
    edges = {
        (a, b) for triangle in triangles.tolist() for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True)
    }
    following = {a: b for a, b in edges if (b, a) not in edges}
    start = min(following)
    outline, vertex = [start], following[start]
    while vertex != start:
        outline.append(vertex)
        vertex = following[vertex]
    return outline


# -- bodies whose faces know the planes they lie on ------------------------------------------------------------------


def tagged(vertices: Floats, triangles: Ints, face_ids: Ints) -> Manifold:
    """A closed body of (n, 3) vertices and (m, 3) outward triangles, each with its id (m,).

    Raises
    ------
    GeometryError
        E208 the triangles do not close.
    """
    mesh = Mesh64(np.ascontiguousarray(vertices), triangles.astype(np.uint64), face_id=face_ids.astype(np.uint64))
    manifold = Manifold(mesh)
    if manifold.status() != Error.NoError:
        raise GeometryError([Fault("E208", f"the cutter is not a closed body ({manifold.status()})")])
    return manifold


def far_box(half_width: float, first_id: int) -> Manifold:
    """A cube about the origin; its faces carry the ids `first_id` to `first_id + 5`."""
    return tagged(_SQUARE_BOX * half_width, BOX_TRIANGLES, np.repeat(np.arange(first_id, first_id + 6), 2))


def half_space(normal: Floats, offset: float, plane: int, back: int) -> Manifold:
    """The half-space above a plane as a box whose first face lies on it and carries the plane's id.

    The other faces carry the id `back`; they lie outside whatever is within `_REACH` of the origin.
    """
    other = np.zeros(3)
    other[np.argmin(np.abs(normal))] = 1.0
    across = cross(normal, other)
    across /= math.sqrt(float(across @ across))
    axes = np.array([across, cross(normal, across)])
    base = normal * offset + _REACH * (_SQUARE @ axes)
    ids = np.full(12, back)
    ids[:2] = plane
    return tagged(np.concatenate([base, base + _REACH * normal]), BOX_TRIANGLES, ids)
