"""Files that a design names, looked for beside it."""

import hashlib
import re
from pathlib import Path

from slopekit.core.errors import DesignError
from slopekit.core.orientation import upward_axis
from slopekit.design.parts import MeshFile, axis_key
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.on_disk import read_bytes
from slopekit.design.reading.reader import Reader

_MOST_MESH_BYTES = 200_000_000
_METRES = (1.0, "")
_INSUNITS = re.compile(rb"\$INSUNITS(?:\s+70\s+(\d+)|\0\x46\0?(.)\0)", re.DOTALL)  # of text and of binary files


def beside(reader: Reader, node: Node) -> Path:
    """A file that the design names, relative to the design's own folder."""
    named = Path(node.text or "")
    return named if named.is_absolute() or reader.document.path is None else reader.document.path.parent / named


def mesh_file(reader: Reader, holder: Node) -> MeshFile | None:
    """The mesh that a group of keys names, known by its content, and the axis that points up in it.

    None where it names none, or with the fault E172 where it cannot be read.
    """
    node, up = holder.get("mesh"), holder.get("up")
    axis: str | None = None if up is None else reader.field(axis_key(up.path), up)
    if node is None or node.text is None:
        if up is not None:
            reader.fault("E172", f"{up.path} says nothing without a mesh", up, "Leave it out.")
        return None
    path = beside(reader, node)
    try:
        content = read_bytes(path, _MOST_MESH_BYTES)
    except DesignError as error:
        fault = error.faults[0]
        advice = fault.advice or "It is looked for beside the design file."
        reader.fault("E172", f"the mesh {node.text} cannot be read: {fault.message}", node, advice)
        return None
    digest = hashlib.sha256(content).hexdigest()
    length, unit = _dxf_unit(content) if path.suffix.lower() == ".dxf" else _METRES
    return MeshFile(
        path.name,
        digest,
        str(path),
        str(node.place),
        axis or upward_axis(path.suffix),
        length_unit=length,
        unit_name=unit,
    )


def _dxf_unit(content: bytes) -> tuple[float, str]:
    """Return the unit (m) that a DXF names for its lengths, and its name where that is not the metre."""
    try:
        from ezdxf.units import InsertUnits, conversion_factor
    except ImportError:  # which is a fault where the mesh is read
        return _METRES
    found = _INSUNITS.search(content)
    number = int(found[1] or found[2][0]) if found else 0
    if number in (0, InsertUnits.Meters) or number not in InsertUnits.__members__.values():
        return _METRES
    return conversion_factor(InsertUnits(number), InsertUnits.Meters), InsertUnits(number).name.lower()
