"""VTU (VTK XML, unstructured grid), float64: blocks as polyhedra, interfaces as polygons, node pairs as vertices.

Written here and not with VTK: VTK 9.7 writes polyhedra in a new layout (file version 2.3) that older readers do not
know, and reads those of version 1.0; and VTK is 100 MB that nothing else of an export needs.
"""

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from slopekit.block_scene import MODES
from slopekit.core.arrays import Floats, Ints
from slopekit.exchange.panels import areas_of
from slopekit.exchange.picking import Picked
from slopekit.exchange.solids import Files

_VERTEX, _LINE, _POLYGON, _POLYHEDRON = 1, 3, 7, 42
_TYPES = {"f": ("Float64", "<f8"), "i": ("Int64", "<i8"), "u": ("UInt8", "|u1"), "b": ("UInt8", "|u1")}


def write_vtu(path: Path, picked: Picked) -> Files:
    """NAME.vtu, with NAME-interfaces.vtu and so on where several are asked for."""
    files = []
    writers = {"blocks": _blocks, "interfaces": _interfaces, "pairs": _pairs, "bolts": _bolts}
    for what in picked.what:
        target = path if what == picked.what[0] else path.with_name(f"{path.stem}-{what}{path.suffix}")
        target.write_bytes(writers[what](picked))
        files.append(target)
    return files, "float64"


# -- the three files --------------------------------------------------------------------------------------------------


def _blocks(picked: Picked) -> bytes:
    scene, bodies = picked.scene, picked.bodies
    index = np.array([body.index for body in bodies])
    firsts = np.cumsum([0, *(len(body.vertices) for body in bodies)])
    stream, ends = [], []
    length = 0
    for body, first in zip(bodies, firsts.tolist(), strict=False):
        own = body.triangles + first
        faces = np.concatenate([np.full((len(own), 1), 3), own], axis=1).ravel()
        stream += [np.array([len(own)]), faces]
        length += 1 + len(faces)
        ends.append(length)
    moved = scene.displacement
    none = np.full((len(scene.velocity), 6), np.nan)
    displacement = none if moved is None or len(moved) != len(none) else moved
    data: dict[str, Floats | Ints] = {
        "block": index.astype(np.int64), "fixed": scene.shapes.fixed[index].astype(np.uint8),
        "factor_of_safety": scene.factor[index], "mechanism_order": scene.order[index].astype(np.int64),
        "volume_m3": np.array([body.volume for body in bodies]),
        "velocity": scene.velocity[index, :3], "rotation": scene.velocity[index, 3:],
        "displacement_m": displacement[index, :3], "displacement_rotation_rad": displacement[index, 3:],
    }  # fmt: skip
    cells = {
        "connectivity": np.arange(firsts[-1]), "offsets": firsts[1:], "types": np.full(len(bodies), _POLYHEDRON),
        "faces": np.concatenate(stream), "faceoffsets": np.array(ends),
    }  # fmt: skip
    names = {"block_names": scene.shapes.names}
    return _file(np.concatenate([body.vertices for body in bodies]), cells, data, names)


def _interfaces(picked: Picked) -> bytes:
    scene, own = picked.scene, picked.contacts
    contacts = scene.shapes.contacts
    sizes = np.diff(contacts.first)[own]
    at = np.repeat(contacts.first[own] - np.cumsum(sizes) + sizes, sizes) + np.arange(sizes.sum())
    data: dict[str, Floats | Ints] = {
        "joint": contacts.joint[own], "plus_block": contacts.plus[own], "minus_block": contacts.minus[own],
        "area_m2": areas_of(contacts)[own],
    }  # fmt: skip
    cells = {"connectivity": np.arange(len(at)), "offsets": np.cumsum(sizes), "types": np.full(len(own), _POLYGON)}
    return _file(contacts.corners[at], cells, data, _names(picked))


def _pairs(picked: Picked) -> bytes:
    pairs, own = picked.scene.pairs, picked.pairs
    area = pairs.control_area_m2[own]
    data: dict[str, Floats | Ints] = {
        "joint": pairs.joint[own], "plus_block": pairs.plus[own], "minus_block": pairs.minus[own],
        "control_area_m2": area, "normal": pairs.normals[own], "normal_kn": pairs.normal_kn[own],
        "shear_kn": pairs.shear_kn[own], "mode": pairs.mode[own],
        "normal_stress_kpa": np.divide(pairs.normal_kn[own], area, out=np.zeros(len(own)), where=area > 0.0),
    }  # fmt: skip
    count = len(own)
    cells = {"connectivity": np.arange(count), "offsets": np.arange(1, count + 1), "types": np.full(count, _VERTEX)}
    return _file(pairs.points_m[own], cells, data, _names(picked))


def _bolts(picked: Picked) -> bytes:
    """A line a bolt, its head first."""
    bolts, own = picked.scene.known_bolts, picked.bolts
    count = len(own)
    data = {
        "number": bolts.number[own], "block": bolts.block[own], "force_kn": bolts.force_kn[own],
        "length_m": bolts.length_m[own], "passive": bolts.passive[own].astype(np.uint8),
        "plate_normal": bolts.plates[own],
    }  # fmt: skip
    points = np.stack([bolts.heads_m[own], bolts.ends_m[own]], axis=1).reshape(-1, 3)
    cells = {
        "connectivity": np.arange(2 * count), "offsets": 2 * np.arange(1, count + 1), "types": np.full(count, _LINE),
    }  # fmt: skip
    return _file(points, cells, data, {"block_names": picked.scene.shapes.names})


def _names(picked: Picked) -> dict[str, Sequence[str]]:
    return {
        "joint_names": picked.scene.shapes.joints, "block_names": picked.scene.shapes.names,
        "mode_names": MODES,
    }  # fmt: skip


# -- the format -------------------------------------------------------------------------------------------------------


def _file(
    points: Floats, cells: Mapping[str, Any], data: Mapping[str, Any], names: Mapping[str, Sequence[str]]
) -> bytes:
    types = {"types": np.uint8}
    parts = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<UnstructuredGrid>", "<FieldData>",
        *(_strings(name, values) for name, values in names.items()), "</FieldData>",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells["offsets"])}">',
        "<Points>", _array("points", points), "</Points>", "<Cells>",
        *(_array(name, np.asarray(values).astype(types.get(name, np.int64))) for name, values in cells.items()),
        "</Cells>", "<CellData>", *(_array(name, values) for name, values in data.items()), "</CellData>",
        "</Piece>", "</UnstructuredGrid>", "</VTKFile>", "",
    ]  # fmt: skip
    return "\n".join(parts).encode()


def _array(name: str, values: Any) -> str:
    word, kind = _TYPES[values.dtype.kind]
    raw = np.ascontiguousarray(values, dtype=kind).tobytes()
    shape = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    packed = base64.b64encode(np.uint64(len(raw)).tobytes() + raw).decode()
    return f'<DataArray type="{word}" Name={quoteattr(name)}{shape} format="binary">{packed}</DataArray>'


def _strings(name: str, values: Sequence[str]) -> str:
    """Texts, each ended by a zero."""
    codes = " ".join(str(code) for value in values for code in (*value.encode(), 0))
    return f'<Array type="String" Name={quoteattr(name)} NumberOfTuples="{len(values)}" format="ascii">{codes}</Array>'
