"""One closed mesh file a block, and the design (kind: blocks) that reads them."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from slopekit.arrays import Floats
from slopekit.errors import DesignError, Fault, Notice
from slopekit.exchange.design_text import design_text
from slopekit.exchange.picking import Body, Picked
from slopekit.exchange.source import Source
from slopekit.exchange.strengths import joints_of
from slopekit.exchange.text import write_obj, write_stl

DESIGN = "blocks.yaml"
_SLAB = 0.25  # thickness of the bedrock behind a joint, in parts of the block's size
_COMPARE = (
    f"run {DESIGN} and compare the factor: the node pairs differ, and the limit state may not be the only one"
)  # fmt: skip
_NOT_IN_FILES = re.compile(r"[^A-Za-z0-9._-]+")


def write_split(folder: Path, source: Source, chosen: Picked, suffix: str) -> tuple[list[Path], list[Notice]]:
    """Write a mesh a block and, where bedrock holds blocks that move, blocks.yaml.

    The bedrock of a wedge, a plane or a footing is a slab behind each joint. Blocks of a section stand in blocks.yaml
    as polygons, which say the same in fewer numbers.

    Returns
    -------
    files, blocks.yaml first; W376 where something does not carry over
    """
    fixed = source.scene.shapes.fixed
    rock = _slabs(source, chosen.bodies)
    bodies = [*chosen.bodies, *rock.values()]
    files = _file_names([body.name for body in bodies], suffix)
    is_fixed = {body.name: bool(fixed[body.index]) for body in chosen.bodies} | {
        slab.name: True for slab in rock.values()
    }
    text, notices = None, []
    why = _why_no_design(source, is_fixed)
    if why:
        notices.append(Notice("W376", f"no {DESIGN} is written: {why}"))
    else:
        behind = {k: slab.name for k, slab in rock.items()}
        if source.document.get("kind") == "topple":
            behind = dict.fromkeys(range(len(source.scene.shapes.contacts)), source.scene.shapes.names[-1])
        polygons = _polygons(source, chosen)
        text, lost = design_text(source, is_fixed, files, behind, polygons)
        if len(chosen.bodies) < len(fixed):
            lost.append(f"{len(fixed) - len(chosen.bodies)} of {len(fixed)} blocks, which were not chosen")
        if lost:
            notices.append(Notice("W376", f"{DESIGN} does not carry over: {'; '.join(lost)}"))
        if not polygons and source.has_many:
            notices.append(Notice("W376", _COMPARE))
    paths = [folder / files[body.name] for body in bodies]
    write = write_obj if suffix == ".obj" else write_stl
    try:
        for path, body in zip(paths, bodies, strict=True):
            write(path, replace(chosen, what=("blocks",), bodies=(body,), contacts=chosen.contacts[:0]))
        if text is not None:
            (folder / DESIGN).write_text(text, encoding="utf-8")
            paths.insert(0, folder / DESIGN)
    except OSError as error:
        reason = error.strerror or str(error)
        raise DesignError([Fault("E129", f"{folder} cannot be written: {reason}", str(folder))]) from None
    return paths, notices


def _polygons(source: Source, chosen: Picked) -> dict[str, Floats]:
    """The polygons (k, 2) of a section of blocks, which say all of it; none where rows of columns stand in space."""
    if source.document.get("kind") not in ("blocks", "topple") or not chosen.outlines:
        return {}
    middles = [float(body.vertices[:, 1].mean()) for body in chosen.bodies]
    if np.ptp(middles) > 0.0:
        return {}
    return {body.name: outline[:, [0, 2]] for body, outline in zip(chosen.bodies, chosen.outlines, strict=True)}


def _why_no_design(source: Source, is_fixed: Mapping[str, bool]) -> str:
    if source.is_curved:
        return "the slip surface is curved, its normals are not those of the triangles (kind surface reads meshes too)"
    if all(is_fixed.values()):
        return "all of these blocks are bedrock"
    return "" if any(is_fixed.values()) else "none of these blocks is bedrock, nothing would hold them"


def _file_names(names: Sequence[str], suffix: str) -> dict[str, str]:
    """A file for every block; what a file name may not hold becomes _, and no two differ by capitals alone."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        stem = base = _NOT_IN_FILES.sub("_", name).strip(".") or "block"
        count = 1
        while stem.lower() in taken:
            count += 1
            stem = f"{base}_{count}"
        taken.add(stem.lower())
        found[name] = stem + suffix
    return found


def _slabs(source: Source, bodies: Sequence[Body]) -> dict[int, Body]:
    """Bedrock behind each joint of a single convex block, by the index of the contact."""
    if source.has_many or source.is_curved or len(bodies) != 1:
        return {}
    shapes = source.scene.shapes
    contacts, joints = shapes.contacts, joints_of(source)
    found = {}
    for k in range(len(contacts)):
        joint = shapes.joints[contacts.joint[k]]
        if joint in joints:
            corners = contacts.corners[contacts.first[k] : contacts.first[k + 1]]
            found[k] = _slab(corners, bodies[0], f"bedrock {joint}")
    return found


def _slab(corners: Floats, body: Body, name: str) -> Body:
    """A convex face of a block, drawn out of it."""
    middle = body.vertices.mean(axis=0)
    turned = np.roll(corners, -1, axis=0)
    out = np.cross(corners - corners[0], turned - corners[0]).sum(axis=0)
    ring = corners
    if out @ (corners[0] - middle) < 0.0:
        out, ring = -out, corners[::-1]
    depth = _SLAB * float(np.ptp(body.vertices, axis=0).max())
    count = len(ring)
    vertices = np.concatenate([ring, ring + depth * out / np.sqrt(out @ out)])
    here, after = np.arange(count), np.roll(np.arange(count), -1)
    fan = np.stack([np.zeros(count - 2, dtype=np.int64), here[1:-1], here[2:]], axis=1)
    sides = [np.stack([here, after, after + count], axis=1), np.stack([here, after + count, here + count], axis=1)]
    return Body(body.index, name, vertices, np.concatenate([fan[:, ::-1], fan + count, *sides]))
