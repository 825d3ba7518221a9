"""Blocks as triangles: STL and OBJ as text with every digit of a double, GLB and glTF.

Those hold float32 vertices about each block's own origin, the origins as doubles in the nodes; trimesh writes them.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.block_scene import BlockScene, joined
from slopekit.bolts import nearest, plates, rods
from slopekit.core.arrays import Floats, Ints
from slopekit.exchange.bodies import block_bodies, mechanism_state
from slopekit.exchange.source import ExportSource

_RESERVED = re.compile(
    r"(?i)solid|facet|normal|vertex|loop"
)  # readers look for these words, in names as well
_DIGITS = "text, every digit of a double"
#: Colours (red, green, blue, alpha).
_STATES = ((150, 150, 150, 255), (214, 190, 150, 255), (200, 80, 10, 255))  # bedrock, stands, moves
_BOLTS = ((200, 0, 80, 255), (20, 30, 90, 255))  # active, passive
_ROD = 0.05  # m: the most that the radius of a rod is drawn
#: The nodes of a GLB: the turn from z up to glTF's y up, below it the offset to the user's coordinates.
_Z_UP, _ORIGIN = "slopekit: z is up", "map origin"
#: What a writer returns: the files, and their precision in words.
Files = tuple[list[Path], str]


def write_stl(path: Path, source: ExportSource) -> Files:
    """ASCII STL: one `solid` a block."""
    from trimesh import Trimesh
    from trimesh.exchange.stl import export_stl_ascii

    bodies = [
        Trimesh(
            body.vertices,
            body.triangles,
            process=False,
            metadata={"name": stl_name(body.name)[:80]},
        )
        for body in block_bodies(source.scene)
    ]
    path.write_text("".join(map(export_stl_ascii, bodies)), encoding="utf-8")
    return [path], _DIGITS


def write_obj(path: Path, source: ExportSource) -> Files:
    """OBJ: one object a block, its faces by name where they are known."""
    lines = ["# slopekit; metres, x east, y north, z up"]
    first_vertex = 1
    solids, fixed = source.scene.shapes.solids, source.scene.shapes.fixed
    for body in block_bodies(source.scene):
        lines += [
            f"o {_token(body.name)}",
            *(f"v {x!r} {y!r} {z!r}" for x, y, z in (body.vertices + 0.0).tolist()),
        ]
        unnamed, last = "bedrock" if fixed[body.index] else "moving", None
        faces = solids.face[solids.block == body.index]
        for face, (a, b, c) in zip(
            faces.tolist(), (body.triangles + first_vertex).tolist(), strict=True
        ):
            group = solids.faces[face] if face >= 0 else unnamed
            if group != last:
                lines.append(f"g {_token(body.name)} {_token(group)}")
                last = group
            lines.append(f"f {a} {b} {c}")
        first_vertex += len(body.vertices)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [path], _DIGITS


def stl_name(name: str) -> str:
    """A name that no reader of STL takes for a word of the format.

    >>> stl_name("north solid 1")
    'north s_olid 1'
    """
    return _RESERVED.sub(
        lambda match: f"{match.group()[0]}_{match.group()[1:]}", " ".join(name.split())
    )


def _token(name: str) -> str:
    return "_".join(name.split())


def write_glb(path: Path, source: ExportSource) -> Files:
    """Write blocks and bolts as a .glb, or as a .gltf with its buffers within."""
    import trimesh

    blocks, bodies = source.scene, block_bodies(source.scene)
    vertices = blocks.shapes.solids.vertices
    origin = np.round((vertices.min(axis=0) + vertices.max(axis=0)) / 2.0)
    scene = trimesh.Scene()
    turn = np.array(
        [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    )
    scene.graph.update(frame_from=scene.graph.base_frame, frame_to=_Z_UP, matrix=turn)
    scene.graph.update(frame_from=_Z_UP, frame_to=_ORIGIN, matrix=_translation(origin))
    node_names = {scene.graph.base_frame, _Z_UP, _ORIGIN}

    def add(
        name: str,
        vertices: Floats,
        triangles: Ints,
        origin_m: Floats,
        colour: Any,
        extras: dict[str, Any],
    ) -> None:
        while name in node_names:
            name += "_"
        node_names.add(name)
        mesh = trimesh.Trimesh(vertices, triangles, process=False, metadata=extras)
        mesh.visual = _painted(colour)
        scene.geometry[name] = mesh  # add_geometry looks through all that is there: n² of time
        scene.graph.update(
            frame_from=_ORIGIN, frame_to=name, matrix=_translation(origin_m - origin), geometry=name
        )

    for body in bodies:
        colour = _STATES[mechanism_state(blocks, body)]
        add(
            body.name,
            body.local,
            body.triangles,
            body.middle,
            colour,
            _block_extras(blocks, body.index),
        )
    _add_bolts(blocks, add)
    save_gltf(scene, path)
    rounding = max(
        np.abs(body.local - body.local.astype(np.float32)).max(initial=0.0) for body in bodies
    )
    precision = f"float32 about each block's own origin (rounded by up to {rounding:.2g} m)"
    return [path], f"{precision}, origins as doubles in the nodes"


def save_gltf(scene: Any, path: Path) -> None:
    """Write a scene of trimesh as .glb, or as .gltf with its buffers within."""
    import trimesh

    if path.suffix.lower() == ".glb":
        path.write_bytes(scene.export(file_type="glb"))
    else:
        path.write_bytes(
            trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True, embed_buffers=True)[
                "model.gltf"
            ]
        )


def _add_bolts(scene: BlockScene, add: Callable[..., None]) -> None:
    """One rod with its plate a bolt, about its head."""
    bolts = scene.known_bolts
    radius = min(_ROD, 0.1 * nearest(bolts.heads_m)) if len(bolts) else 0.0
    for k in range(len(bolts)):
        head, end, local_origin = bolts.heads_m[k], bolts.ends_m[k], np.zeros((1, 3))
        rod, plate = (
            rods(local_origin, (end - head)[None, :], radius),
            plates(local_origin, bolts.plates[k : k + 1], 6.0 * radius),
        )
        vertices, triangles, _ = joined([rod, plate])
        passive, length = bool(bolts.passive[k]), float(bolts.length_m[k])
        extras = {
            "part": "bolt",
            "number": int(bolts.number[k]),
            "force_kn": float(bolts.force_kn[k]),
            "length_m": length if np.isfinite(length) else None,
            "acts": "passive" if passive else "active",
            "head": head.tolist(),
            "end": end.tolist(),
        }
        add(f"bolt {int(bolts.number[k])}", vertices, triangles, head, _BOLTS[passive], extras)


def _painted(colour: tuple[int, int, int, int]) -> Any:
    """The look of a mesh."""
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    material = PBRMaterial(
        baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.9, alphaMode="OPAQUE"
    )
    return TextureVisuals(material=material)


def _block_extras(scene: BlockScene, k: int) -> dict[str, Any]:
    """Return the properties of a block as glTF extras."""
    factor = float(scene.factor[k])
    return {
        "fixed": bool(scene.shapes.fixed[k]),
        "factor_of_safety": factor if np.isfinite(factor) else None,
        "mechanism_order": int(scene.order[k]),
        "velocity": scene.velocity[k].tolist(),
    }


def _translation(offset: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix
