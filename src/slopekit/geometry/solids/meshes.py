"""Mesh files (STL, OBJ, PLY, OFF, GLB, DXF) as closed bodies or open sheets, read in double precision."""

from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import DesignError, Fault

#: The node of slopekit's own GLB files that turns z upward into glTF's y upward; below it are the user's axes.
Z_UP = "slopekit: z is up"
_METRES = 6  # $INSUNITS

MeshBody = tuple[str, Floats, Ints]
_MOST_TRIANGLES = 400_000


def mesh_bodies(path: Path) -> list[MeshBody]:
    """Name, vertices (v, 3) and triangles (t, 3) of every solid, object, group or node of a file, in its order.

    Vertices at one place are one. GLB files of slopekit come back in the user's axes and without their bolts, others as
    they are written.

    Raises
    ------
    DesignError
        E140 a DXF without the extra `cad`. Other exceptions, of the readers, where the file is no mesh.
    """
    suffix = path.suffix.lower()
    if suffix == ".dxf":
        return [merged(body) for body in _of_dxf(path)]
    import trimesh

    options, names = _of_objects(path) if suffix == ".obj" else ({}, [])
    # of the bytes alone: an OBJ or a glTF may name further files, anywhere
    content = BytesIO(path.read_bytes())
    scene = trimesh.load_scene(content, file_type=suffix.lstrip("."), process=False, **options)
    base = Z_UP if Z_UP in scene.graph.nodes else scene.graph.base_frame
    rank = {name: k for k, name in enumerate([*names, *(name for name in scene.geometry if name not in names)])}
    bodies = []
    for node in sorted(scene.graph.nodes_geometry, key=lambda node: (rank[scene.graph[node][1]], str(node))):
        matrix, name = scene.graph.get(node, frame_from=base)
        mesh = scene.geometry[name]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces) and mesh.metadata.get("part") != "bolt":
            points = np.asarray(mesh.vertices, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            bodies.append(merged((str(node), points, np.asarray(mesh.faces, dtype=np.int64))))
    return bodies


def _of_objects(path: Path) -> tuple[dict[str, bool], list[str]]:
    """What an OBJ's bodies are, objects, or groups where it has none, but never materials; their names in order."""
    with path.open(encoding="utf-8", errors="replace") as lines:
        marked = [line for line in lines if line.startswith(("o ", "g "))]
    objects = [line[2:].strip() for line in marked if line.startswith("o ")]
    names = objects or [line[2:].strip() for line in marked]
    options = {"group_material": False, "split_objects": bool(objects), "split_groups": not objects}
    return options, list(dict.fromkeys(names))


def one_mesh(bodies: Sequence[MeshBody]) -> tuple[Floats, Ints]:
    """Bodies as one set of vertices and triangles."""
    if not bodies:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    if len(bodies) == 1:
        return bodies[0][1:]
    firsts = np.cumsum([0, *(len(vertices) for _, vertices, _ in bodies)])
    triangles = [triangles + first for (_, _, triangles), first in zip(bodies, firsts, strict=False)]
    return np.concatenate([vertices for _, vertices, _ in bodies]), np.concatenate(triangles)


def merged(body: MeshBody) -> MeshBody:
    """A body whose vertices at one place are one; triangles that lose a corner by that go.

    One place: within 1e-8 m, or at map coordinates what doubles can tell apart. Without a place it stays as it is.
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


def _of_dxf(path: Path) -> list[MeshBody]:
    """Polyface meshes and MESH entities one by one, and the 3DFACEs of each layer together; in metres."""
    try:
        import ezdxf
        from ezdxf.render import MeshBuilder, MeshVertexMerger
    except ImportError:
        advice = "pip install 'slopekit[cad]'"
        raise DesignError([Fault("E140", "DXF files need the extra cad (ezdxf)", str(path), advice)]) from None
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
        vertices = np.array([tuple(vertex) for vertex in mesh.vertices], dtype=np.float64).reshape(-1, 3) * scale
        triangles = [(face[0], face[k], face[k + 1]) for face in mesh.faces for k in range(1, len(face) - 1)]
        if triangles:
            bodies.append((name, vertices, np.array(triangles, dtype=np.int64)))
    return bodies


def _name_of(entity: Any) -> str:
    """What slopekit wrote beside the entity, else its layer and handle."""
    if entity.has_xdata("SLOPEKIT"):
        return str(entity.get_xdata("SLOPEKIT")[0].value)
    return f"{entity.dxf.layer}-{entity.dxf.handle}"


def read_mesh(path: Path, name: str, where: str = "") -> tuple[Floats, Ints, bool]:
    """Vertices (n, 3), triangles (m, 3) and whether they close a body; duplicate vertices are merged.

    Parameters
    ----------
    name, where : how the mesh is called in messages, and where the design names it

    Raises
    ------
    DesignError
        E172 the file is no mesh that can be read; E140 a DXF without the extra `cad`.
    """
    import trimesh

    try:
        _, vertices, triangles = merged((name, *one_mesh(mesh_bodies(path))))  # a body may be spread over groups
    except DesignError as error:
        raise DesignError([replace(fault, where=where or name) for fault in error.faults]) from None
    except Exception as error:  # trimesh's readers raise whatever their format makes them stumble over
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:120]
        advice = "STL, OBJ, PLY, OFF, GLB and DXF are read."
        raise DesignError(
            [Fault("E172", f"the mesh {name} cannot be read ({reason})", where or name, advice)]
        ) from None
    if len(triangles) == 0 or not np.isfinite(vertices).all():
        raise DesignError([Fault("E172", f"the mesh {name} has no triangles that can be used", where or name)])
    if len(triangles) > _MOST_TRIANGLES:
        message = f"the mesh {name} has {len(triangles)} triangles, more than {_MOST_TRIANGLES}"
        raise DesignError([Fault("E172", message, where or name, "Decimate it: the answer does not need them.")])
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    closed = bool(mesh.is_watertight and mesh.is_winding_consistent)
    return vertices, np.ascontiguousarray(triangles), closed


def outward(vertices: Floats, triangles: Ints) -> Ints:
    """The triangles (m, 3) of a closed mesh, turned where it is inside out."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = float(np.einsum("ij,ij->", a - vertices.mean(axis=0), np.cross(b - a, c - a)))
    return np.ascontiguousarray(triangles[:, ::-1] if volume < 0.0 else triangles)
