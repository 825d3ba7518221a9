"""Mesh files (STL, OBJ, PLY, OFF, GLB, DXF) as closed bodies or open sheets, read in double precision."""

import json
from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import upward_axis
from slopekit.geometry.solids.mesh_rounding import file_rounding
from slopekit.geometry.solids.polygon_files import PolygonBody, obj_bodies, off_bodies, ply_bodies
from slopekit.geometry.tolerances import COARSEST_SINGLE

_AREA_TOLERANCE = (
    1e-6  # of the square of a face's size: areas that differ by less are rounding of its corners
)
_ZERO_AREA = (
    1e-12  # of the same square: outlines that cross themselves can have a vector area of zero
)


#: The corners of a face in the order in which it is cut, and whether that is backward in the file.
_Outline = tuple[list[int], bool]


class CrossedFaceError(ValueError):
    """A face whose outline crosses itself bounds no area."""


def triangulated(vertices: Floats, faces: Sequence[Sequence[int]]) -> Ints:
    """Return the triangles (t, 3) of faces, convex or not, in their order and with their sense of rotation.

    A face is cut in the plane of its Newell normal, from the corner and in the direction that the coordinates of its
    corners decide: a warped face that two blocks share has the same diagonals in both.

    Parameters
    ----------
    vertices : (v, 3) m; faces : the vertices of each face, in order around it

    Raises
    ------
    CrossedFaceError
        A face crosses itself. ValueError a face has fewer than three corners, or a coordinate is no number.

    >>> ell = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]], dtype=float)
    >>> a, b, c = ell[triangulated(ell, [[0, 1, 2, 3, 4, 5]])].transpose(1, 0, 2)
    >>> (np.cross(b - a, c - a) / 2.0).sum(axis=0).tolist()
    [0.0, 0.0, 5.0]
    """
    sizes = np.fromiter(map(len, faces), dtype=np.int64, count=len(faces))
    if (sizes < 3).any():
        raise ValueError(f"face {int((sizes < 3).argmax()) + 1} has fewer than three corners")
    if not np.isfinite(vertices).all():
        raise ValueError("a coordinate is no number")
    plain = np.flatnonzero(sizes == 3)
    triangles = [np.array([faces[k] for k in plain.tolist()], dtype=np.int64).reshape(-1, 3)]
    owners = [plain]
    polygons = np.flatnonzero(sizes > 3).tolist()
    place = _coordinate_ranks(vertices).tolist() if polygons else []
    by_size: dict[int, list[tuple[int, _Outline]]] = {}
    for k in polygons:
        outline = _from_least_corner(faces[k], place)
        by_size.setdefault(len(outline[0]), []).append((k, outline))
    for size, group in by_size.items():
        if size >= 3:  # fewer are left of a face whose corners lie at two places
            triangles.append(_cut_faces(vertices, [outline for _, outline in group]))
            owners.append(np.repeat([k for k, _ in group], size - 2))
    return np.concatenate(triangles)[np.argsort(np.concatenate(owners), kind="stable")]


def _cut_faces(vertices: Floats, outlines: Sequence[_Outline]) -> Ints:
    """Return the triangles (t, 3) of faces of n corners, n - 2 of each face."""
    from manifold3d import triangulate

    corners = np.array([ordered for ordered, _ in outlines])
    backward = np.array([is_backward for _, is_backward in outlines])
    flat = _in_newell_plane(vertices[corners])
    if (crossed := _crossed(flat)).any():
        raise CrossedFaceError(_face_text(vertices[corners[crossed.argmax()]]))
    cuts = np.array([triangulate([outline]) for outline in flat], dtype=np.int64)
    cuts[backward] = cuts[backward, :, ::-1]
    return np.take_along_axis(corners, cuts.reshape(len(corners), -1), axis=1).reshape(-1, 3)


def _coordinate_ranks(vertices: Floats) -> Ints:
    """Return the rank (v,) of each vertex, sorted by x, y and z; vertices with equal coordinates share it."""
    order = np.lexsort(vertices.T[::-1])
    place = np.zeros(len(vertices), dtype=np.int64)
    place[order[1:]] = np.cumsum((np.diff(vertices[order], axis=0) != 0.0).any(axis=1))
    return place


def _from_least_corner(face: Sequence[int], place: Sequence[int]) -> _Outline:
    """Return the corners of a face from its lowest rank on toward the lower neighbour, and whether that runs backward.

    Corners that repeat the one before them are dropped. An outline that passes its least place twice, as around a hole
    that a slit joins to the rim, begins with the lesser of the sequences of places.
    """
    corners = [corner for k, corner in enumerate(face) if place[corner] != place[face[k - 1]]]
    places = [place[corner] for corner in corners]
    least = min(places, default=0)
    orders = [
        (
            corners[k::step] + corners[:k:step] if step > 0 else corners[k::-1] + corners[:k:-1],
            step < 0,
        )
        for k, number in enumerate(places)
        if number == least
        for step in (1, -1)
    ]
    return min(
        orders, key=lambda order: [place[corner] for corner in order[0]], default=([], False)
    )


def _face_text(corners: Floats) -> str:
    """Return the number of corners (n, 3) of a face and the first of them in words, to identify it in its file."""
    coordinates = ", ".join(
        "({:.3f}, {:.3f}, {:.3f})".format(*corner) for corner in corners[:4].tolist()
    )
    return f"{len(corners)} corners, {coordinates}{', …' if len(corners) > 4 else ''}"


def _in_newell_plane(points: Floats) -> Floats:
    """Return the corners (f, n, 2) of faces (f, n, 3) in the planes of their Newell normals, scaled to size 1."""
    local = points - points[:, :1]
    local = local / np.maximum(np.abs(local).max(axis=(1, 2), keepdims=True), np.finfo(float).tiny)
    fan = np.cross(local[:, 1:-1], local[:, 2:])
    total, largest = fan.sum(axis=1), np.abs(fan).max(axis=2).argmax(axis=1)
    is_zero = np.abs(total).max(axis=1, keepdims=True) <= _ZERO_AREA
    normal = _unit(np.where(is_zero, fan[np.arange(len(fan)), largest], total))
    across = _unit(np.cross(np.eye(3)[np.abs(normal).argmin(axis=1)], normal))
    upward = np.cross(normal, across)
    return np.stack([(local * axis[:, None]).sum(axis=2) for axis in (across, upward)], axis=2)


def _unit(vectors: Floats) -> Floats:
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    unit: Floats = vectors / np.maximum(length, np.finfo(float).tiny)
    return unit


def _crossed(outlines: Floats) -> Bools:
    """Return which anticlockwise outlines (f, n, 2) of size 1 cross themselves.

    The signed area counts a region as often as the outline winds around it. It differs from the areas by the nonzero or
    by the even-odd rule where that is not once.
    """
    from manifold3d import CrossSection, FillRule

    x, y = np.moveaxis(outlines - outlines[:, :1], 2, 0)
    signed = (x[:, 1:-1] * y[:, 2:] - x[:, 2:] * y[:, 1:-1]).sum(axis=1) / 2.0
    rules = (FillRule.NonZero, FillRule.EvenOdd)
    covered = np.array(
        [[CrossSection([outline], rule).area() for rule in rules] for outline in outlines]
    )
    crossed: Bools = np.abs(covered - signed[:, None]).max(axis=1) > _AREA_TOLERANCE
    return crossed


_METRES = 6  # $INSUNITS
_TRIANGLE_FAN = 6  # mode of a primitive of glTF
MeshBody = tuple[str, Floats, Ints]
_MOST_TRIANGLES = 400_000


def mesh_bodies(path: Path, up: str = "") -> list[MeshBody]:
    """Read the name, vertices (v, 3) and triangles (t, 3) of every solid, object, group or node of a mesh file.

    Axes are x east, y north, z up. Coinciding vertices are merged. GLB files of slopekit are read without their bolts.

    Parameters
    ----------
    up : the axis of the file that points up, y or z; empty for that of its format

    Raises
    ------
    DesignError
        E140 a DXF without the extra `cad`. Other exceptions, of the readers, where the file is no mesh.
    """
    suffix = path.suffix.lower()
    readers = {".dxf": _dxf_bodies, ".obj": obj_bodies, ".off": off_bodies, ".ply": ply_bodies}
    if suffix in readers:
        bodies = [
            (name, vertices, triangulated(vertices, faces))
            for name, vertices, faces in readers[suffix](path)
        ]
    elif suffix in (".stl", ".glb", ".gltf"):
        bodies = _scene_bodies(path)
    else:
        raise ValueError(f"its suffix is {suffix or 'missing'}")
    if (up or upward_axis(suffix)) == "y":
        bodies = [
            (name, vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0] + 0.0, triangles)
            for name, vertices, triangles in bodies
        ]
    return [merged(body) for body in bodies]


def _scene_bodies(path: Path) -> list[MeshBody]:
    """Read the solids of an STL, or the nodes of a glTF scene placed by its matrices, along the axes of the file."""
    import trimesh

    if path.suffix.lower() != ".stl":
        _refuse_unread_gltf(path)
    # of the bytes alone: a glTF may name further files, anywhere
    content = BytesIO(path.read_bytes())
    scene = trimesh.load_scene(content, file_type=path.suffix.lower().lstrip("."), process=False)
    rank = {name: k for k, name in enumerate(scene.geometry)}
    bodies = []
    for node in sorted(
        scene.graph.nodes_geometry, key=lambda node: (rank[scene.graph[node][1]], str(node))
    ):
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name]
        if (
            isinstance(mesh, trimesh.Trimesh)
            and len(mesh.faces)
            and mesh.metadata.get("part") != "bolt"
        ):
            points = np.asarray(mesh.vertices, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            triangles = np.asarray(mesh.faces, dtype=np.int64)
            is_mirrored = np.linalg.det(matrix[:3, :3]) < 0.0
            bodies.append((str(node), points, triangles[:, ::-1] if is_mirrored else triangles))
    return bodies


def _refuse_unread_gltf(path: Path) -> None:
    """Raise ValueError for what trimesh ignores in glTF: normalized integer coordinates, and fans of triangles."""
    content = path.read_bytes()
    if content.startswith(b"glTF"):
        content = content[20 : 20 + int.from_bytes(content[12:16], "little")]
    document = json.loads(content)
    for primitive in (
        primitive_entry
        for mesh in document.get("meshes", ())
        for primitive_entry in mesh["primitives"]
    ):
        if primitive.get("mode") == _TRIANGLE_FAN:
            raise ValueError("it has fans of triangles; save it with triangles")
        if document["accessors"][primitive["attributes"]["POSITION"]].get("normalized"):
            raise ValueError("its coordinates are normalized whole numbers; save it with floats")


def one_mesh(bodies: Sequence[MeshBody]) -> tuple[Floats, Ints]:
    """Return several bodies as one set of vertices (v, 3) and triangles (t, 3)."""
    if not bodies:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    if len(bodies) == 1:
        return bodies[0][1:]
    firsts = np.cumsum([0, *(len(vertices) for _, vertices, _ in bodies)])
    triangles = [
        triangles + first for (_, _, triangles), first in zip(bodies, firsts, strict=False)
    ]
    return np.concatenate([vertices for _, vertices, _ in bodies]), np.concatenate(triangles)


def merged(body: MeshBody) -> MeshBody:
    """Return a body with coinciding vertices merged, and without the triangles that lose a corner by that.

    Vertices coincide within 1e-8 m, or, at map coordinates, within double precision. A body with coordinates that are
    not finite is returned unchanged.
    """
    import trimesh

    name, vertices, triangles = body
    if not np.isfinite(vertices).all():
        return body
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices()
    faces = np.asarray(mesh.faces, dtype=np.int64)
    a, b, c = faces.T
    return name, np.asarray(mesh.vertices, dtype=np.float64), faces[(a != b) & (b != c) & (c != a)]


# -- DXF --------------------------------------------------------------------------------------------------------------


def _dxf_bodies(path: Path) -> list[PolygonBody]:
    """Read the polyface meshes and MESH entities of a DXF one by one, and the 3DFACEs of each layer together; in m."""
    try:
        import ezdxf
        from ezdxf.render import MeshBuilder, MeshVertexMerger
    except ImportError:
        advice = "pip install 'slopekit[cad]'"
        raise DesignError(
            [Fault("E140", "DXF files need the extra cad (ezdxf)", str(path), advice)]
        ) from None
    from ezdxf.units import conversion_factor

    drawing = ezdxf.readfile(path)
    scale = 1.0 if drawing.units in (0, _METRES) else conversion_factor(drawing.units, _METRES)
    named_meshes: list[tuple[str, Any]] = []
    faces: dict[str, Any] = {}
    for entity in drawing.modelspace():
        kind = entity.dxftype()
        if kind == "POLYLINE" and entity.is_poly_face_mesh:
            named_meshes.append((_name_of(entity), MeshBuilder.from_polyface(entity)))
        elif kind == "MESH":
            named_meshes.append((_name_of(entity), MeshBuilder.from_mesh(entity)))
        elif kind == "3DFACE":
            layer = entity.dxf.layer
            if layer not in faces:
                faces[layer] = MeshVertexMerger()
                named_meshes.append((layer, faces[layer]))
            faces[layer].add_face(entity.wcs_vertices())
    bodies = []
    for name, mesh in named_meshes:
        vertices = (
            np.array([tuple(vertex) for vertex in mesh.vertices], dtype=np.float64).reshape(-1, 3)
            * scale
        )
        if len(mesh.faces):
            bodies.append((name, vertices, [list(face) for face in mesh.faces]))
    return bodies


def _name_of(entity: Any) -> str:
    """Return the name that slopekit wrote into an entity's extended data, else its layer and handle."""
    if entity.has_xdata("SLOPEKIT"):
        return str(entity.get_xdata("SLOPEKIT")[0].value)
    return f"{entity.dxf.layer}-{entity.dxf.handle}"


def read_mesh(path: Path, name: str, location: str = "", up: str = "") -> tuple[Floats, Ints, bool]:
    """Read the vertices (n, 3) and triangles (m, 3) of a mesh file, and whether they close a body.

    Parameters
    ----------
    name, location : the name of the mesh in messages, and the place in the design that names it
    up : the axis of the file that points up, as for `mesh_bodies`

    Raises
    ------
    DesignError
        E172 the file is no mesh that can be read, a face of it crosses itself, or it is in single precision too far
        from the origin; E140 a DXF without the extra `cad`.
    """
    import trimesh

    try:
        _, vertices, triangles = merged(
            (name, *one_mesh(mesh_bodies(path, up)))
        )  # a body may be spread over groups
    except DesignError as error:
        raise DesignError(
            [replace(fault, where=location or name) for fault in error.faults]
        ) from None
    except CrossedFaceError as error:
        message = f"the mesh {name} has a face that crosses itself: {error}"
        raise DesignError(
            [Fault("E172", message, location or name, "Split it, or order its corners.")]
        ) from None
    except (
        Exception
    ) as error:  # trimesh's readers raise whatever their format makes them stumble over
        words = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
        reason = words.splitlines()[0][:120] if words else type(error).__name__
        advice = "STL, OBJ, PLY, OFF, GLB and DXF are read."
        raise DesignError(
            [Fault("E172", f"the mesh {name} cannot be read ({reason})", location or name, advice)]
        ) from None
    if len(triangles) == 0 or not np.isfinite(vertices).all():
        raise DesignError(
            [Fault("E172", f"the mesh {name} has no triangles that can be used", location or name)]
        )
    if len(triangles) > _MOST_TRIANGLES:
        message = f"the mesh {name} has {len(triangles)} triangles, more than {_MOST_TRIANGLES}"
        raise DesignError(
            [
                Fault(
                    "E172", message, location or name, "Decimate it: the answer does not need them."
                )
            ]
        )
    _refuse_coarse(path, name, location, vertices)
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    return (
        vertices,
        np.ascontiguousarray(triangles),
        bool(mesh.is_watertight and mesh.is_winding_consistent),
    )


def _refuse_coarse(path: Path, name: str, location: str, vertices: Floats) -> None:
    """Raise E172 for a body whose corners single precision has moved by more than a thousandth of its size.

    Map coordinates in float32 do that.
    """
    largest, size = float(np.abs(vertices).max()), float(np.ptp(vertices, axis=0).max())
    if np.spacing(np.float32(largest)) <= COARSEST_SINGLE * size:
        return
    resolution = file_rounding(path, vertices)[1]
    if resolution > COARSEST_SINGLE * size:
        message = (
            f"the mesh {name} has coordinates up to {largest:.0f} m in single precision (float32), which rounds them "
            f"to {resolution:.2g} m: too coarse for a body of {size:.3g} m"
        )
        advice = (
            "Shift the origin in the program that wrote it (the same whole kilometres off every file), or write text "
            "or doubles: OBJ, ASCII STL or PLY, DXF."
        )
        raise DesignError([Fault("E172", message, location or name, advice)])


def outward(vertices: Floats, triangles: Ints) -> Ints:
    """Return the triangles (m, 3) of a closed mesh, reversed where the mesh is inside out."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = float(np.einsum("ij,ij->", a - vertices.mean(axis=0), np.cross(b - a, c - a)))
    return np.ascontiguousarray(triangles[:, ::-1] if volume < 0.0 else triangles)
