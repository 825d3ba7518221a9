"""Files that a design names, looked for beside it."""

import hashlib
import re
from pathlib import Path

from slopekit.core.errors import DesignError
from slopekit.design.parts import MeshFile
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


def mesh_file(reader: Reader, node: Node) -> MeshFile | None:
    """A mesh that the design names, known by its content; None with the fault E172 where it cannot be read."""
    path = beside(reader, node)
    try:
        content = read_bytes(path, _MOST_MESH_BYTES)
    except DesignError as error:
        fault = error.faults[0]
        advice = fault.advice or "It is looked for beside the design file."
        reader.fault("E172", f"the mesh {node.text} cannot be read: {fault.message}", node, advice)
        return None
    unit = _dxf_unit(content) if path.suffix.lower() == ".dxf" else _METRES
    return MeshFile(path.name, hashlib.sha256(content).hexdigest(), str(path), str(node.place), *unit)


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
