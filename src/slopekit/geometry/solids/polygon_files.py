"""OBJ files as vertices and faces of any number of corners, which other readers cut as if all were convex.

Texture, normals, colours and lines are passed over. ValueError where a file is none of its format.
"""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from slopekit.core.arrays import Floats

#: Name, vertices (v, 3), and the vertices of each face in order around it.
PolygonBody = tuple[str, Floats, list[list[int]]]


def obj_bodies(path: Path) -> list[PolygonBody]:
    """The objects of an OBJ file, or its groups where it has none, but never its materials; in their order."""
    points: list[list[str]] = []
    objects: dict[str, list[list[int]]] = {}
    groups: dict[str, list[list[int]]] = {}
    object_name, group_name = "", ""
    text = path.read_text(encoding="utf-8-sig", errors="replace").replace("\\\n", " ")
    for line in text.splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append(rest[:3])
        elif word == "f":
            entries = line.partition("#")[0].split()[1:] if "#" in line else rest
            numbers = [int(entry.partition("/")[0]) for entry in entries]
            face = [number - 1 if number >= 0 else number + len(points) for number in numbers]  # -1: the last so far
            objects.setdefault(object_name, []).append(face)
            groups.setdefault(group_name, []).append(face)
        elif word == "o":
            object_name = " ".join(rest)
        elif word == "g":
            group_name = " ".join(rest)
    vertices = _coordinates(points)
    named = objects if any(objects) else groups
    return [_body(name or path.name, vertices, faces) for name, faces in named.items()]


def _coordinates(points: Sequence[Sequence[str]]) -> Floats:
    if any(len(point) < 3 for point in points):
        raise ValueError("a vertex has fewer than three coordinates")
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _body(name: str, vertices: Floats, faces: list[list[int]]) -> PolygonBody:
    """A body with the vertices alone that its faces name."""
    corners = np.fromiter(chain.from_iterable(faces), dtype=np.int64)
    if ((corners < 0) | (corners >= len(vertices))).any():
        raise ValueError(f"a face names a vertex that is none of the {len(vertices)}")
    used = np.unique(corners)
    if len(used) == len(vertices):
        return name, vertices, faces
    index = np.searchsorted(used, np.arange(len(vertices))).tolist()
    return name, vertices[used], [[index[corner] for corner in face] for face in faces]
