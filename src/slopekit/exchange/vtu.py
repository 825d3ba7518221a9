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

from slopekit.block_scene import MODES, BlockScene, Bolts
from slopekit.core.arrays import Floats, Ints
from slopekit.exchange.bodies import areas_of, block_bodies
from slopekit.exchange.solids import Files
from slopekit.exchange.source import ExportSource

_VERTEX, _LINE, _POLYGON, _POLYHEDRON = 1, 3, 7, 42
_TYPES = {
    "f": ("Float64", "<f8"),
    "i": ("Int64", "<i8"),
    "u": ("UInt8", "|u1"),
    "b": ("UInt8", "|u1"),
}


def write_vtu(path: Path, source: ExportSource) -> Files:
    """NAME.vtu of the blocks, with NAME-interfaces.vtu, NAME-pairs.vtu and NAME-bolts.vtu where there are any."""
    scene = source.scene
    contents = {"": _blocks(scene)}
    if len(scene.shapes.contacts):
        contents["-interfaces"] = _interfaces(scene)
    if len(scene.pairs):
        contents["-pairs"] = _pairs(scene)
    if scene.bolts is not None:
        contents["-bolts"] = _bolts(scene.bolts, scene)
    files = [path.with_name(f"{path.stem}{suffix}{path.suffix}") for suffix in contents]
    for file, content in zip(files, contents.values(), strict=True):
        file.write_bytes(content)
    return files, "float64"


# -- the four files ---------------------------------------------------------------------------------------------------


def _blocks(scene: BlockScene) -> bytes:
    bodies = block_bodies(scene)
    firsts = np.cumsum([0, *(len(body.vertices) for body in bodies)])
    stream, ends = [], []
    length = 0
    for body, first in zip(bodies, firsts.tolist(), strict=False):
        triangles = body.triangles + first
        faces = np.concatenate([np.full((len(triangles), 1), 3), triangles], axis=1).ravel()
        stream += [np.array([len(triangles)]), faces]
        length += 1 + len(faces)
        ends.append(length)
    elastic_displacement = scene.displacement
    none = np.full((len(scene.velocity), 6), np.nan)
    displacement = (
        none
        if elastic_displacement is None or len(elastic_displacement) != len(none)
        else elastic_displacement
    )
    data: dict[str, Any] = {
        "block": np.arange(len(bodies)),
        "fixed": scene.shapes.fixed.astype(np.uint8),
        "factor_of_safety": scene.factor,
        "mechanism_order": scene.order.astype(np.int64),
        "volume_m3": np.array([body.volume for body in bodies]),
        "velocity": scene.velocity[:, :3],
        "rotation": scene.velocity[:, 3:],
        "displacement_m": displacement[:, :3],
        "displacement_rotation_rad": displacement[:, 3:],
    }
    cells = {
        "connectivity": np.arange(firsts[-1]),
        "offsets": firsts[1:],
        "types": np.full(len(bodies), _POLYHEDRON),
        "faces": np.concatenate(stream),
        "faceoffsets": np.array(ends),
    }
    names = {"block_names": scene.shapes.names}
    return _file(np.concatenate([body.vertices for body in bodies]), cells, data, names)


def _interfaces(scene: BlockScene) -> bytes:
    contacts = scene.shapes.contacts
    data: dict[str, Floats | Ints] = {
        "joint": contacts.joint,
        "plus_block": contacts.plus,
        "minus_block": contacts.minus,
        "area_m2": areas_of(contacts),
    }
    cells = {
        "connectivity": np.arange(len(contacts.corners)),
        "offsets": contacts.first[1:],
        "types": np.full(len(contacts), _POLYGON),
    }
    return _file(contacts.corners, cells, data, _names(scene))


def _pairs(scene: BlockScene) -> bytes:
    pairs, count = scene.pairs, len(scene.pairs)
    area = pairs.control_area_m2
    data: dict[str, Floats | Ints] = {
        "joint": pairs.joint,
        "plus_block": pairs.plus,
        "minus_block": pairs.minus,
        "control_area_m2": area,
        "normal": pairs.normals,
        "normal_kn": pairs.normal_kn,
        "shear_kn": pairs.shear_kn,
        "mode": pairs.mode,
        "normal_stress_kpa": np.divide(
            pairs.normal_kn, area, out=np.zeros(count), where=area > 0.0
        ),
    }
    cells = {
        "connectivity": np.arange(count),
        "offsets": np.arange(1, count + 1),
        "types": np.full(count, _VERTEX),
    }
    return _file(pairs.points_m, cells, data, _names(scene))


def _bolts(bolts: Bolts, scene: BlockScene) -> bytes:
    """A line a bolt, its head first."""
    count = len(bolts)
    data = {
        "number": bolts.number,
        "block": bolts.block,
        "force_kn": bolts.force_kn,
        "length_m": bolts.length_m,
        "passive": bolts.passive.astype(np.uint8),
        "plate_normal": bolts.plates,
    }
    points = np.stack([bolts.heads_m, bolts.ends_m], axis=1).reshape(-1, 3)
    cells = {
        "connectivity": np.arange(2 * count),
        "offsets": 2 * np.arange(1, count + 1),
        "types": np.full(count, _LINE),
    }
    return _file(points, cells, data, {"block_names": scene.shapes.names})


def _names(scene: BlockScene) -> dict[str, Sequence[str]]:
    return {
        "joint_names": scene.shapes.joints,
        "block_names": scene.shapes.names,
        "mode_names": MODES,
    }


# -- the format -------------------------------------------------------------------------------------------------------


def _file(
    points: Floats,
    cells: Mapping[str, Any],
    data: Mapping[str, Any],
    names: Mapping[str, Sequence[str]],
) -> bytes:
    types = {"types": np.uint8}
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<UnstructuredGrid>",
        "<FieldData>",
        *(_strings(name, values) for name, values in names.items()),
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells["offsets"])}">',
        "<Points>",
        _array("points", points),
        "</Points>",
        "<Cells>",
        *(
            _array(name, np.asarray(values).astype(types.get(name, np.int64)))
            for name, values in cells.items()
        ),
        "</Cells>",
        "<CellData>",
        *(_array(name, values) for name, values in data.items()),
        "</CellData>",
        "</Piece>",
        "</UnstructuredGrid>",
        "</VTKFile>",
        "",
    ]
    return "\n".join(lines).encode()


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
