"""Files that a design names, looked for beside it."""

import hashlib
from pathlib import Path

from slopekit.core.errors import DesignError
from slopekit.design.parts import MeshFile
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.on_disk import read_bytes
from slopekit.design.reading.reader import Reader

_MOST_MESH_BYTES = 200_000_000


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
    return MeshFile(path.name, hashlib.sha256(content).hexdigest(), str(path), str(node.place))
