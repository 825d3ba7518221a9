"""STL and OBJ: triangles as text with every digit of a double, or STL in binary, which has float32 only."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.arrays import Floats, Ints
from slopekit.block_scene import MODES
from slopekit.exchange.panels import triangles_of
from slopekit.exchange.picking import Picked

_RESERVED = re.compile(r"(?i)solid|facet|normal|vertex|loop")  # readers look for these words, in names as well
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_DIGITS = "text, every digit of a double"


def write_stl(path: Path, picked: Picked) -> str:
    """ASCII STL: one `solid` a block, or a joint where interfaces are written; returns the precision in words."""
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
    return _DIGITS


def write_binary_stl(path: Path, picked: Picked) -> str:
    """Binary STL: all in one, without names; returns the precision in words."""
    corners = np.concatenate([vertices[triangles] for _, vertices, triangles in _surfaces(picked)])
    facets = np.zeros(len(corners), dtype=_FACET)
    facets["corners"] = corners
    facets["normal"] = _normals(corners)
    with path.open("wb") as file:
        file.write(b"slopekit, metres".ljust(80))
        file.write(np.uint32(len(facets)).tobytes())
        file.write(facets.tobytes())
    return f"binary float32, coordinates rounded by up to {binary_rounding(picked):.2g} m"


def binary_rounding(picked: Picked) -> float:
    """How far float32 moves the coordinates at most, m."""
    return max(
        float(np.abs(vertices - vertices.astype(np.float32)).max(initial=0.0)) for _, vertices, _ in _surfaces(picked)
    )


def write_obj(path: Path, picked: Picked) -> str:
    """OBJ: one object a block, its faces by name where they are known, interfaces as polygons, one object a joint."""
    lines = ["# slopekit; metres, x east, y north, z up"]
    at = 1
    solids, fixed = picked.scene.shapes.solids, picked.scene.shapes.fixed
    for body in picked.bodies:
        lines += [f"o {_token(body.name)}", *_vertices(body.vertices)]
        faces = solids.face[solids.block == body.index]
        last = None
        for face, (a, b, c) in zip(faces.tolist(), (body.triangles + at).tolist(), strict=True):
            group = solids.faces[face] if face >= 0 else "bedrock" if fixed[body.index] else "moving"
            if group != last:
                lines.append(f"g {_token(body.name)} {_token(group)}")
                last = group
            lines.append(f"f {a} {b} {c}")
        at += len(body.vertices)
    contacts = picked.scene.shapes.contacts
    for joint, own in _by_joint(picked):
        lines.append(f"o {_token(joint)}")
        for k in own:
            corners = contacts.corners[contacts.first[k] : contacts.first[k + 1]]
            lines += _vertices(corners)
            lines.append("f " + " ".join(str(at + i) for i in range(len(corners))))
            at += len(corners)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return _DIGITS


def stl_name(name: str) -> str:
    """A name that no reader of STL takes for a word of the format.

    >>> stl_name("north solid 1")
    'north s_olid 1'
    """
    return _RESERVED.sub(lambda found: f"{found.group()[0]}_{found.group()[1:]}", " ".join(name.split()))


def mode_names(modes: Ints) -> list[str]:
    """Contact modes in words, empty for none."""
    return [MODES[mode] if mode >= 0 else "" for mode in modes.tolist()]


def _surfaces(picked: Picked) -> Iterator[tuple[str, Floats, Ints]]:
    """Blocks, then the panels of each joint, as triangles."""
    for body in picked.bodies:
        yield body.name, body.vertices, body.triangles
    if len(picked.contacts):
        contacts = picked.scene.shapes.contacts
        triangles, panel = triangles_of(contacts)
        for joint, own in _by_joint(picked):
            yield joint, contacts.corners, triangles[np.isin(panel, own)]


def _by_joint(picked: Picked) -> Iterator[tuple[str, list[int]]]:
    joint = picked.scene.shapes.contacts.joint[picked.contacts]
    for k, name in enumerate(picked.scene.shapes.joints):
        own = picked.contacts[joint == k].tolist()
        if own:
            yield name, own


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
