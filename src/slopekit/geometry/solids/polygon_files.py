"""OBJ, OFF and PLY files as vertices and faces of any number of corners (other readers cut all faces as if convex).

Texture, normals, colours and lines are ignored. All readers raise ValueError where a file is not of its format.
"""

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured

from slopekit.core.arrays import Floats

#: Name, vertices (v, 3), and the vertices of each face in order around it.
PolygonBody = tuple[str, Floats, list[list[int]]]


def obj_bodies(path: Path) -> list[PolygonBody]:
    """Read the objects of an OBJ file, or its groups where it has no objects, in their order; materials are ignored."""
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
            face = [
                number - 1 if number >= 0 else number + len(points) for number in numbers
            ]  # -1: the last so far
            objects.setdefault(object_name, []).append(face)
            groups.setdefault(group_name, []).append(face)
        elif word == "o":
            object_name = " ".join(rest)
        elif word == "g":
            group_name = " ".join(rest)
    vertices = _coordinates(points)
    faces_by_name = objects if any(objects) else groups
    return [_body(name or path.name, vertices, faces) for name, faces in faces_by_name.items()]


def off_bodies(path: Path) -> list[PolygonBody]:
    """Read the body of an OFF file in text, with or without colours and normals."""
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    lines = [words for line in text.splitlines() if (words := line.partition("#")[0].split())]
    keyword = lines[0][0].upper() if lines else ""
    if (
        not keyword.endswith("OFF")
        or "4" in keyword
        or "BINARY" in (word.upper() for word in lines[0])
    ):
        raise ValueError("it is no OFF file in text with three coordinates a vertex")
    lines[0] = lines[0][1:]
    lines = lines if lines[0] else lines[1:]
    count, total = (int(word) for word in lines[0][:2])
    rows = lines[1 + count : 1 + count + total]
    faces = [[int(word) for word in words[1 : 1 + int(words[0])]] for words in rows]
    if len(rows) < total or any(
        len(face) < int(words[0]) for face, words in zip(faces, rows, strict=True)
    ):
        raise ValueError(f"it ends before the {total} faces that it announces")
    return [_body(path.name, _coordinates([words[:3] for words in lines[1 : 1 + count]]), faces)]


def _coordinates(points: Sequence[Sequence[str]]) -> Floats:
    if any(len(point) < 3 for point in points):
        raise ValueError("a vertex has fewer than three coordinates")
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _body(name: str, vertices: Floats, faces: list[list[int]]) -> PolygonBody:
    """Return a body with only the vertices that its faces use."""
    corners = np.fromiter(chain.from_iterable(faces), dtype=np.int64)
    if ((corners < 0) | (corners >= len(vertices))).any():
        raise ValueError(f"a face names a vertex that is none of the {len(vertices)}")
    used = np.unique(corners)
    if len(used) == len(vertices):
        return name, vertices, faces
    index = np.searchsorted(used, np.arange(len(vertices))).tolist()
    return name, vertices[used], [[index[corner] for corner in face] for face in faces]


# -- PLY --------------------------------------------------------------------------------------------------------------

#: The letters of numpy for the types of PLY.
_LETTERS = {
    "char": "b",
    "int8": "b",
    "uchar": "B",
    "uint8": "B",
    "short": "h",
    "int16": "h",
    "ushort": "H",
    "uint16": "H",
    "int": "i",
    "int32": "i",
    "uint": "I",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float": "f",
    "float32": "f",
    "double": "d",
    "float64": "d",
}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS = ("vertex_indices", "vertex_index")
#: The values of a property, a row of them for each row of its table: a value, or a list.
_Column = Floats | list[Floats]


#: The properties of an element in their order: the letter of each, of a list those of its length and of its values.
_Properties = dict[str, str]


class _Numbers:
    """The numbers of a PLY file, in text or in binary, read from its start on."""

    def __init__(self, data: bytes, form: str) -> None:
        self.order = _ORDERS.get(form, "")
        self.data: Any = data if self.order else np.array(data.split(), dtype=np.float64)
        self.position = 0

    def size(self, letters: str) -> int:
        """Return the size of a row with the types of `letters`: bytes of a binary file, numbers of a text."""
        return sum(np.dtype(letter).itemsize for letter in letters) if self.order else len(letters)

    def rows(self, letters: str, count: int) -> Floats:
        """Read the next numbers as rows (count, len(letters)) with the types of `letters`."""
        begin = self.position
        self.position += self.size(letters) * count
        if self.position > len(self.data):
            raise ValueError("it ends before all that its header announces")
        if not self.order:
            return np.asarray(self.data[begin : self.position]).reshape(count, -1)
        if len(set(letters)) == 1:
            table = np.frombuffer(self.data, self.order + letters[0], count * len(letters), begin)
            return table.reshape(count, -1).astype(np.float64)
        kind = np.dtype([(str(k), self.order + letter) for k, letter in enumerate(letters)])
        return structured_to_unstructured(
            np.frombuffer(self.data, kind, count, begin), dtype=np.float64
        )


def ply_bodies(path: Path) -> list[PolygonBody]:
    """Read the body of a PLY file, in text or in binary."""
    header, mark, content = path.read_bytes().partition(b"end_header")
    form, elements = _header(header.decode("ascii", errors="replace"))
    if not mark or not header.startswith(b"ply") or form not in ("ascii", *_ORDERS):
        raise ValueError("it has no header of a PLY file")
    numbers = _Numbers(content.partition(b"\n")[2], form)
    columns = {
        name: _columns(count, properties, numbers)
        for name, (count, properties) in elements.items()
        if count
    }
    if "vertex" not in columns or "face" not in columns:
        raise ValueError("it has no vertices, or no faces")
    points = np.concatenate([_column(columns["vertex"], axis) for axis in "xyz"], axis=1)
    corners = _column(columns["face"], *_CORNERS)
    tables = [corners] if isinstance(corners, np.ndarray) else [row[None] for row in corners]
    return [
        _body(
            path.name, points, [face for rows in tables for face in rows.astype(np.int64).tolist()]
        )
    ]


def _header(text: str) -> tuple[str, dict[str, tuple[int, _Properties]]]:
    """Read the form of a PLY file, and the number of rows and the properties of its tables by name."""
    form = ""
    elements: dict[str, tuple[int, _Properties]] = {}
    properties: _Properties | None = None
    for line in text.splitlines():
        match line.split():
            case ["format", word, *_]:
                form = word
            case ["element", name, count]:
                properties = {}
                elements[name] = max(int(count), 0), properties
            case ["property", "list", count_type, kind, name] if properties is not None:
                properties[name] = _letter(count_type) + _letter(kind)
            case ["property", kind, name] if properties is not None:
                properties[name] = _letter(kind)
    return form, elements


def _letter(kind: str) -> str:
    if kind not in _LETTERS:
        raise ValueError(f"its header has a type {kind}")
    return _LETTERS[kind]


def _column(columns: Mapping[str, _Column], *names: str) -> _Column:
    """Return the first of the named columns that the table has."""
    for name in names:
        if name in columns:
            return columns[name]
    raise ValueError(f"it has no property {' or '.join(names)}")


def _columns(count: int, properties: _Properties, numbers: _Numbers) -> Mapping[str, _Column]:
    """Read the columns of a table by name, a value or a list a row.

    All rows are read at once where their lists are as long as those of the first row, else row by row.
    """
    begin = numbers.position
    first = _row(properties, numbers)
    numbers.position = begin
    letters, spans = "", {}
    for name, kind in properties.items():
        letters += kind[:-1] + kind[-1] * len(first[name])
        spans[name] = len(letters) - len(first[name]), len(letters)
    if begin + numbers.size(letters) * count <= len(numbers.data):
        table = numbers.rows(letters, count)
        lists = [spans[name] for name, kind in properties.items() if len(kind) > 1]
        if all((table[:, start - 1] == end - start).all() for start, end in lists):
            return {name: table[:, start:end] for name, (start, end) in spans.items()}
    numbers.position = begin
    rows = [_row(properties, numbers) for _ in range(count)]
    return {name: [row[name] for row in rows] for name in first}


def _row(properties: _Properties, numbers: _Numbers) -> dict[str, Floats]:
    """Read the values of the next row by the names of their properties."""
    row = {}
    for name, kind in properties.items():
        count = int(numbers.rows(kind[0], 1)[0, 0]) if len(kind) > 1 else 1
        if not 0 <= count <= len(numbers.data):
            raise ValueError(f"it has a list of {count} entries")
        row[name] = numbers.rows(kind[-1] * count, 1)[0] if count else np.zeros(0)
    return row
