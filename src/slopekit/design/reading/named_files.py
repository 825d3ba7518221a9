"""Files that a design names, such as meshes and joint lists, relative to the folder of the design."""

import hashlib
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from slopekit.core.errors import DesignError
from slopekit.core.orientation import upward_axis
from slopekit.design.parts import MeshFile, axis_key
from slopekit.design.reading.nodes import Node, cut, fail, printable
from slopekit.design.reading.on_disk import ALLOW_OUTSIDE, read_bytes
from slopekit.design.reading.reader import Reader

_MOST_MESH_BYTES = 200_000_000
_METRES = (1.0, "")
_INSUNITS = re.compile(
    rb"\$INSUNITS(?:\s+70\s+(\d+)|\0\x46\0?(.)\0)", re.DOTALL
)  # in text and in binary DXF files


def path_of_named_file(reader: Reader, node: Node) -> Path:
    """Return the path of a file that the design names, in the folder of the design file or below it.

    A design from Python, without a file, may name any file, and so may a value of `--set`.

    Raises
    ------
    DesignError
        E148 for a file outside that folder (links are followed), where that is not allowed.
    """
    named_path, design = Path(node.text or ""), reader.document.path
    if design is None:
        return named_path
    path = design.parent / named_path
    is_of_file = node.place.file == printable(reader.document.name)
    is_inside = Path(os.path.realpath(path)).is_relative_to(os.path.realpath(design.parent))
    if is_of_file and not is_inside and not reader.document.allows_outside:
        message = f"{cut(printable(node.text or ''))} lies outside the folder of the design"
        advice = "Put it beside the design, or allow it: slopekit --allow-outside, load(..., allow_outside=True)."
        fail("E148", message, str(node.place), advice)
    return path


def mesh_file(reader: Reader, holder: Node) -> MeshFile | None:
    """Read the mesh file that a group of keys names: its path, hash, vertical axis and length unit.

    None where it names none, or with fault E172 where the file cannot be read.
    """
    node, up = holder.get("mesh"), holder.get("up")
    axis: str | None = reader.field(axis_key(up.path), up)
    if node.text is None:
        if up:
            reader.fault("E172", f"{up.path} says nothing without a mesh", up, "Leave it out.")
        return None
    try:
        path = path_of_named_file(reader, node)
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
    except ImportError:  # reported as a fault where the mesh is read
        return _METRES
    match = _INSUNITS.search(content)
    number = int(match[1] or match[2][0]) if match else 0
    if number in (0, InsertUnits.Meters) or number not in InsertUnits.__members__.values():
        return _METRES
    return conversion_factor(InsertUnits(number), InsertUnits.Meters), InsertUnits(
        number
    ).name.lower()


@contextmanager
def files_outside(are_allowed: bool) -> Iterator[None]:
    """Let the designs that are read within name files outside their own folders, where that is allowed."""
    previous = os.environ.get(ALLOW_OUTSIDE)
    if are_allowed:
        os.environ[ALLOW_OUTSIDE] = "1"
    try:
        yield
    finally:
        if are_allowed and previous is None:
            del os.environ[ALLOW_OUTSIDE]
