"""Blocks as triangles: STL and OBJ as text with every digit of a double, GLB and glTF.

Those hold float32 vertices about each block's own origin, the origins as doubles in the nodes; trimesh writes them.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.block_scene import joined
from slopekit.bolts import nearest, plates, rods
from slopekit.core.arrays import Floats, Ints
from slopekit.exchange.panels import triangles_of
from slopekit.exchange.picking import Picked

_RESERVED = re.compile(r"(?i)solid|facet|normal|vertex|loop")  # readers look for these words, in names as well
_DIGITS = "text, every digit of a double"
#: Colours (red, green, blue, alpha).
_STATES = ((150, 150, 150, 255), (214, 190, 150, 255), (200, 80, 10, 255))  # bedrock, stands, moves
_JOINTS = ((0, 100, 164, 200), (0, 127, 95, 200), (168, 84, 138, 200), (216, 144, 0, 200), (86, 180, 233, 200))
_MODES = ((0, 127, 95, 255), (200, 80, 10, 255), (0, 100, 164, 255))
_BOLTS = ((200, 0, 80, 255), (20, 30, 90, 255))  # active, passive
_ROD = 0.05  # m: the most that the radius of a rod is drawn
#: The nodes of a GLB: the turn from z up to glTF's y up, below it the offset to the user's coordinates.
_Z_UP, _ORIGIN = "slopekit: z is up", "map origin"
#: What a writer returns: the files, and their precision in words.
Files = tuple[list[Path], str]


def write_stl(path: Path, picked: Picked) -> Files:
    """ASCII STL: one `solid` a block, or a joint where interfaces are written."""
    lines: list[str] = []
    for name, vertices, triangles in _surfaces(picked):
        corners = vertices[triangles]
        words = _words(vertices)
        normals = [f"{x:.6g} {y:.6g} {z:.6g}" for x, y, z in _normals(corners).tolist()]
        lines.append(f"solid {stl_name(name)}")
        for (a, b, c), normal in zip(triangles.tolist(), normals, strict=True):
            lines.append(
                f"facet normal {normal}\n outer loop\n  vertex {words[a]}\n  vertex {words[b]}\n  vertex {words[c]}\n"
                " endloop\nendfacet"
            )
        lines.append(f"endsolid {stl_name(name)}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [path], _DIGITS


def _rounding(vertices: Floats) -> float:
    return float(np.abs(vertices - vertices.astype(np.float32)).max(initial=0.0))


def write_obj(path: Path, picked: Picked) -> Files:
    """OBJ: one object a block, its faces by name where they are known, interfaces as polygons, one object a joint."""
    lines = ["# slopekit; metres, x east, y north, z up"]
    at = 1
    solids, fixed = picked.scene.shapes.solids, picked.scene.shapes.fixed
    for body in picked.bodies:
        lines += [f"o {_token(body.name)}", *_vertices(body.vertices)]
        faces = solids.face[solids.block == body.index] if body.index >= 0 else np.full(len(body.triangles), -1)
        is_rock = body.index < 0 or fixed[body.index]
        last = None
        for face, (a, b, c) in zip(faces.tolist(), (body.triangles + at).tolist(), strict=True):
            group = solids.faces[face] if face >= 0 else "bedrock" if is_rock else "moving"
            if group != last:
                lines.append(f"g {_token(body.name)} {_token(group)}")
                last = group
            lines.append(f"f {a} {b} {c}")
        at += len(body.vertices)
    contacts = picked.scene.shapes.contacts
    for _, joint, own in picked.by_joint():
        lines.append(f"o {_token(joint)}")
        for k in own.tolist():
            corners = contacts.corners[contacts.first[k] : contacts.first[k + 1]]
            lines += _vertices(corners)
            lines.append("f " + " ".join(str(at + i) for i in range(len(corners))))
            at += len(corners)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [path], _DIGITS


def stl_name(name: str) -> str:
    """A name that no reader of STL takes for a word of the format.

    >>> stl_name("north solid 1")
    'north s_olid 1'
    """
    return _RESERVED.sub(lambda match: f"{match.group()[0]}_{match.group()[1:]}", " ".join(name.split()))


def _surfaces(picked: Picked) -> Iterator[tuple[str, Floats, Ints]]:
    """Blocks, then the panels of each joint, as triangles."""
    for body in picked.bodies:
        yield body.name, body.vertices, body.triangles
    if len(picked.contacts):
        contacts = picked.scene.shapes.contacts
        triangles, panel = triangles_of(contacts)
        for _, joint, own in picked.by_joint():
            yield joint, contacts.corners, triangles[np.isin(panel, own)]


def _words(vertices: Floats) -> list[str]:
    return [f"{x!r} {y!r} {z!r}" for x, y, z in (vertices + 0.0).tolist()]


def _vertices(vertices: Floats) -> list[str]:
    return [f"v {words}" for words in _words(vertices)]


def _token(name: str) -> str:
    return "_".join(name.split())


def _normals(corners: Floats) -> Any:
    a, b, c = (corners[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.sqrt((normal * normal).sum(axis=1))[:, None]
    return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)


def write_glb(path: Path, picked: Picked) -> Files:
    """A .glb, or a .gltf with its buffers within."""
    import trimesh

    origin, contacts = picked.middle, picked.scene.shapes.contacts
    scene = trimesh.Scene()
    turn = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    scene.graph.update(frame_from=scene.graph.base_frame, frame_to=_Z_UP, matrix=turn)
    scene.graph.update(frame_from=_Z_UP, frame_to=_ORIGIN, matrix=_shift(origin))
    rounding = 0.0
    taken = {scene.graph.base_frame, _Z_UP, _ORIGIN}

    def add(name: str, geometry: Any, at: Floats) -> None:
        while name in taken:
            name += "_"
        taken.add(name)
        scene.geometry[name] = geometry  # add_geometry looks through all that is there: n² of time
        scene.graph.update(frame_from=_ORIGIN, frame_to=name, matrix=_shift(at), geometry=name)

    def add_mesh(name: str, vertices: Floats, triangles: Ints, at: Floats, colour: Any, known: dict[str, Any]) -> None:
        nonlocal rounding
        rounding = max(rounding, _rounding(vertices))
        mesh = trimesh.Trimesh(vertices, triangles, process=False, metadata=known)
        mesh.visual = _painted(colour)
        add(name, mesh, at)

    for body in picked.bodies:
        middle, local = body.middle, body.local
        add_mesh(body.name, local, body.triangles, middle - origin, _STATES[picked.state_of(body)],
                 _of_block(picked, body.index))  # fmt: skip
    triangles, panel = triangles_of(contacts)
    for k, joint, own in picked.by_joint():
        used, index = np.unique(triangles[np.isin(panel, own)], return_inverse=True)
        add_mesh(f"interface {joint}", contacts.corners[used] - origin, index.reshape(-1, 3), np.zeros(3),
                 _JOINTS[k % len(_JOINTS)], {"joint": joint})  # fmt: skip
    for mode, word, points in picked.by_mode():
        colours = np.tile(np.array(_MODES[mode], dtype=np.uint8), (len(points), 1))
        add(f"node pairs, {word}", trimesh.PointCloud(points - origin, colours), np.zeros(3))
    _add_bolts(picked, add_mesh, origin)
    save_gltf(scene, path)
    said = f"float32 about each block's own origin (rounded by up to {rounding:.2g} m)"
    return [path], f"{said}, origins as doubles in the nodes"


def save_gltf(scene: Any, path: Path) -> None:
    """Write a scene of trimesh as .glb, or as .gltf with its buffers within."""
    import trimesh

    if path.suffix.lower() == ".glb":
        path.write_bytes(scene.export(file_type="glb"))
    else:
        path.write_bytes(trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True, embed_buffers=True)["model.gltf"])


def _add_bolts(picked: Picked, add_mesh: Callable[..., None], origin: Floats) -> None:
    """One rod with its plate a bolt, about its head."""
    bolts = picked.scene.known_bolts
    radius = min(_ROD, 0.1 * nearest(bolts.heads_m)) if len(picked.bolts) else 0.0
    for k in picked.bolts.tolist():
        head, end, here = bolts.heads_m[k], bolts.ends_m[k], np.zeros((1, 3))
        rod, plate = rods(here, (end - head)[None, :], radius), plates(here, bolts.plates[k : k + 1], 6.0 * radius)
        vertices, triangles, _ = joined([rod, plate])
        passive, length = bool(bolts.passive[k]), float(bolts.length_m[k])
        known = {
            "part": "bolt", "number": int(bolts.number[k]), "force_kn": float(bolts.force_kn[k]),
            "length_m": length if np.isfinite(length) else None, "acts": "passive" if passive else "active",
            "head": head.tolist(), "end": end.tolist(),
        }  # fmt: skip
        add_mesh(f"bolt {int(bolts.number[k])}", vertices, triangles, head - origin, _BOLTS[passive], known)


def _painted(colour: tuple[int, int, int, int]) -> Any:
    """The look of a mesh; one that is seen through has no back."""
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    clear = colour[3] < 255
    material = PBRMaterial(
        baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.9, doubleSided=clear,
        alphaMode="BLEND" if clear else "OPAQUE",
    )  # fmt: skip
    return TextureVisuals(material=material)


def _of_block(picked: Picked, k: int) -> dict[str, Any]:
    """What is known of a block, as glTF extras."""
    scene = picked.scene
    factor = float(scene.factor[k])
    return {
        "fixed": bool(scene.shapes.fixed[k]), "factor_of_safety": factor if np.isfinite(factor) else None,
        "mechanism_order": int(scene.order[k]), "velocity": scene.velocity[k].tolist(),
    }  # fmt: skip


def _shift(by: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = by
    return matrix
