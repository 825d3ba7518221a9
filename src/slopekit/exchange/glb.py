"""GLB and glTF with trimesh: float32 vertices about each block's own origin, the origins as doubles in the nodes."""

from pathlib import Path
from typing import Any

import numpy as np

from slopekit.arrays import Floats
from slopekit.block_scene import MODES
from slopekit.exchange.panels import triangles_of
from slopekit.exchange.picking import Picked
from slopekit.geometry.meshes import Z_UP

#: Colours (red, green, blue, alpha).
_BEDROCK, _STANDS, _MOVES = (150, 150, 150, 255), (214, 190, 150, 255), (200, 80, 10, 255)
_JOINTS = ((0, 100, 164, 200), (0, 127, 95, 200), (168, 84, 138, 200), (216, 144, 0, 200), (86, 180, 233, 200))
_MODES = ((0, 127, 95, 255), (200, 80, 10, 255), (0, 100, 164, 255))
_ORIGIN = "map origin"


def write_glb(path: Path, picked: Picked) -> str:
    """Write a .glb, or a .gltf with its buffers within; returns the precision in words."""
    import trimesh

    origin = picked.middle
    scene = trimesh.Scene()
    turn = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    scene.graph.update(frame_from=scene.graph.base_frame, frame_to=Z_UP, matrix=turn)
    scene.graph.update(frame_from=Z_UP, frame_to=_ORIGIN, matrix=_shift(origin))
    rounding = 0.0
    taken = {scene.graph.base_frame, Z_UP, _ORIGIN}

    def add(name: str, geometry: Any, at: Floats) -> None:
        while name in taken:
            name += "_"
        taken.add(name)
        scene.geometry[name] = geometry  # add_geometry looks through all that is there: n² of time
        scene.graph.update(frame_from=_ORIGIN, frame_to=name, matrix=_shift(at), geometry=name)

    for body in picked.bodies:
        middle, local = body.middle, body.local
        rounding = max(rounding, float(np.abs(local - local.astype(np.float32)).max()))
        mesh = trimesh.Trimesh(local, body.triangles, process=False, metadata=_of_block(picked, body.index))
        mesh.visual = _painted(_colour(picked, body.index))
        add(body.name, mesh, middle - origin)
    if len(picked.contacts):
        rounding = max(rounding, _add_interfaces(picked, add, origin))
    if len(picked.pairs):
        pairs = picked.scene.pairs
        for mode in range(len(MODES)):
            own = picked.pairs[pairs.mode[picked.pairs] == mode]
            if len(own):
                local = pairs.points_m[own] - origin
                colours = np.tile(np.array(_MODES[mode], dtype=np.uint8), (len(own), 1))
                add(f"node pairs, {MODES[mode]}", trimesh.PointCloud(local, colours), np.zeros(3))
    if path.suffix.lower() == ".glb":
        path.write_bytes(scene.export(file_type="glb"))
    else:
        path.write_bytes(trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True, embed_buffers=True)["model.gltf"])
    return f"float32 about each block's own origin (rounded by up to {rounding:.2g} m), origins as doubles in the nodes"


def _add_interfaces(picked: Picked, add: Any, origin: Floats) -> float:
    """One mesh a joint; returns the rounding."""
    import trimesh

    contacts = picked.scene.shapes.contacts
    triangles, panel = triangles_of(contacts)
    rounding = 0.0
    for k, joint in enumerate(picked.scene.shapes.joints):
        own = np.isin(panel, picked.contacts[contacts.joint[picked.contacts] == k])
        if own.any():
            used, index = np.unique(triangles[own], return_inverse=True)
            local = contacts.corners[used] - origin
            rounding = max(rounding, float(np.abs(local - local.astype(np.float32)).max()))
            mesh = trimesh.Trimesh(local, index.reshape(-1, 3), process=False, metadata={"joint": joint})
            mesh.visual = _painted(_JOINTS[k % len(_JOINTS)], double_sided=True)
            add(f"interface {joint}", mesh, np.zeros(3))
    return rounding


def _painted(colour: tuple[int, int, int, int], double_sided: bool = False) -> Any:
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    material = PBRMaterial(
        baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.9, doubleSided=double_sided,
        alphaMode="BLEND" if colour[3] < 255 else "OPAQUE",
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


def _colour(picked: Picked, k: int) -> tuple[int, int, int, int]:
    if picked.scene.shapes.fixed[k]:
        return _BEDROCK
    return _MOVES if picked.scene.order[k] else _STANDS


def _shift(by: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, 3] = by
    return matrix
