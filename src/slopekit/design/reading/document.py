"""A design file from the disk: its bytes, its text, its tree, and the values put over it."""

import os
from collections.abc import Sequence
from pathlib import Path

from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.canonical import with_canonical_keys
from slopekit.design.reading.nodes import Document, cut, fail, no_text
from slopekit.design.reading.on_disk import ALLOW_OUTSIDE, read_bytes
from slopekit.design.reading.overrides import with_overrides
from slopekit.design.reading.yaml import LINE_END, SourceLines, TreeBuilder, composed


def load_document(path: str | os.PathLike[str]) -> Document:
    """Read a design file.

    Raises
    ------
    DesignError
        E147 to E149 and E159 for the file, E150 and E151 for its YAML: every fault that could be found.
    """
    document, faults = read_document(path)
    if faults:
        raise DesignError(faults)
    return document


def read_document(
    path: str | os.PathLike[str], overrides: Sequence[tuple[str, object]] = ()
) -> tuple[Document, list[Fault]]:
    """What `load_document` reads, and the faults that leave a tree to look at: keys twice, overrides that fit nowhere.

    Parameters
    ----------
    overrides : dotted path and value, as `with_overrides` takes them

    Raises
    ------
    DesignError
        Where there is no tree; E151, E160 and E405 for the overrides.
    """
    file = Path(path)
    document, faults = read_text(decoded(read_bytes(path), file.name), file.name, file)
    try:
        document = with_overrides(document, overrides)
    except DesignError as error:
        faults += error.faults
    if faults and not document.root.is_mapping:
        raise DesignError(dict.fromkeys(faults))
    return document, list(dict.fromkeys(faults))


def read_text(text: str, name: str, path: Path | None = None) -> tuple[Document, list[Fault]]:
    """What `read_document` reads, of the text of a file: its tree, and the faults that leave one.

    Raises
    ------
    DesignError
        Where there is no tree.
    """
    source = SourceLines(name, text)
    builder = TreeBuilder(source.place)
    top = composed(text, source)
    start = source.place(0, 0)
    if top is None:
        fail(
            "E150",
            f"{name} is empty",
            str(path or name),
            "slopekit templates show wedge prints a design to start from.",
        )
    root = builder.build(top, "", start)
    if root.value is None and not builder.faults:
        fail("E150", f"{name} holds no design", str(start), "slopekit templates show wedge prints a design.")
    if not root.is_mapping and not builder.faults:
        shown = "a list" if isinstance(root.value, list) else f"the text {cut(repr(root.value))}"
        advice = "A design starts with keys: slopekit: 1, then kind: wedge."
        fail("E150", f"{name} holds {shown}, not keys with values", str(root.place), advice)
    root, faults = with_canonical_keys(root)
    document = Document(root, name, path, allows_outside=bool(os.environ.get(ALLOW_OUTSIDE)))
    return document, [*builder.faults, *faults]


def decoded(content: bytes, name: str) -> str:
    """The text of a design file. Raises DesignError E159 where it is none in UTF-8."""
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        fail("E159", f"{name} is UTF-16, a design file is UTF-8", name, "Save it again as UTF-8.")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"line {line} of {name} is not UTF-8 (byte 0x{content[error.start]:02x})"
        fail("E159", message, f"{name}:{line}", "Save it again as UTF-8: ° and φ are written in two bytes there.")
    bad = no_text(text)
    if bad:
        line = len(LINE_END.findall(text, 0, bad.start())) + 1
        message = f"line {line} of {name} holds the character U+{ord(bad.group()):04X}, which is no text"
        fail("E159", message, f"{name}:{line}", "Is this a design file? Save it again as UTF-8 text.")
    return text
