"""A design file from the disk: its bytes, its text, its tree, and the values put over it."""

import os
from collections.abc import Sequence
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path

from slopekit.design.nodes import NO_TEXT, Document, cut, fail, printable
from slopekit.design.overrides import ALTERNATIVES, Exclusive, with_overrides
from slopekit.design.yaml import LINE_END, Source, TreeBuilder, composed
from slopekit.errors import DesignError, Fault

MAX_BYTES = 5_000_000


def load_document(
    path: str | os.PathLike[str],
    overrides: Sequence[tuple[str, object]] = (),
    alternatives: Exclusive = ALTERNATIVES,
) -> Document:
    """Read a design file and put the overrides in.

    Parameters
    ----------
    path : the file
    overrides : dotted path and value, as `with_overrides` takes them
    alternatives : keys that exclude each other, by the path of their mapping

    Raises
    ------
    DesignError
        E147 to E149 and E159 for the file, E150 to E158 for its YAML, E160 to E163 for the overrides: every fault
        that could be found.
    """
    document, faults = read_document(path, overrides, alternatives)
    if faults:
        raise DesignError(faults)
    return document


def read_document(
    path: str | os.PathLike[str], overrides: Sequence[tuple[str, object]] = (), alternatives: Exclusive = ALTERNATIVES
) -> tuple[Document, list[Fault]]:
    """What `load_document` reads, and the faults that leave a tree to look at: keys twice, overrides that fit nowhere.

    Raises
    ------
    DesignError
        Where there is no tree.
    """
    file = Path(path)
    text = _decoded(read_bytes(path), file.name)
    source = Source(file.name, text)
    builder = TreeBuilder(source.place)
    top = composed(text, source)
    start = source.place(0, 0)
    if top is None:
        fail("E156", f"{file.name} is empty", str(path), "slopekit templates show wedge prints a design to start from.")
    root = builder.build(top, "", start)
    if root.value is None and not builder.faults:
        fail("E156", f"{file.name} holds no design", str(start), "slopekit templates show wedge prints a design.")
    if not root.is_mapping and not builder.faults:
        shown = "a list" if isinstance(root.value, list) else f"the text {cut(repr(root.value))}"
        advice = "A design starts with keys: slopekit: 1, then kind: wedge."
        fail("E157", f"{file.name} holds {shown}, not keys with values", str(root.place), advice)
    document = Document(root, file.name, file)
    faults = list(builder.faults)
    try:
        document = with_overrides(document, overrides, alternatives)
    except DesignError as error:
        faults += error.faults
    if faults and not document.root.is_mapping:
        raise DesignError(dict.fromkeys(faults))
    return document, list(dict.fromkeys(faults))


def read_bytes(path: str | os.PathLike[str], most: int = MAX_BYTES) -> bytes:
    """The bytes of a file that has at most so many.

    Raises
    ------
    DesignError
        E147 no such file (with the nearest name), E148 a folder or unreadable, E149 too large.
    """
    shown, name = cut(printable(str(path))), cut(printable(Path(path).name or str(path)))
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)
    except (FileNotFoundError, NotADirectoryError, ValueError):  # ValueError: a NUL or a surrogate in the name
        raise DesignError([Fault("E147", f"{name} does not exist", shown, _nearest_file(Path(path)))]) from None
    except IsADirectoryError:
        inside = sorted(name for name in _names_in(Path(path)) if name.endswith((".yaml", ".yml", ".csv")))[:5]
        advice = f"It holds {', '.join(inside)}." if inside else ""
        raise DesignError([Fault("E148", f"{name} is a folder, a file is needed", shown, advice)]) from None
    except OSError as error:
        message = f"{name} cannot be read: {(error.strerror or 'the system refuses').lower()}"
        raise DesignError([Fault("E148", message, shown)]) from None
    if len(content) > most:
        what = ", that is no design or joint list" if most == MAX_BYTES else ""
        advice = "Meshes stand in files of their own: mesh: slip.stl." if what else "Decimate it."
        fail("E149", f"{name} is larger than {most / 1e6:g} MB{what}", shown, advice)
    return content


def _names_in(folder: Path) -> list[str]:
    with suppress(OSError, ValueError):
        return os.listdir(folder)
    return []


def _nearest_file(path: Path) -> str:
    with suppress(OSError, ValueError):
        if not path.parent.is_dir():
            return f"There is no folder {printable(str(path.parent))}."
    names = {name.lower(): name for name in sorted(_names_in(path.parent))}
    near = get_close_matches(path.name.lower(), names, n=1) or [
        name for name in names if name.startswith(path.name.lower() + ".")
    ]
    return f"Did you mean {printable(str(path.parent / names[near[0]]))}?" if near else ""


def _decoded(content: bytes, name: str) -> str:
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        fail("E159", f"{name} is UTF-16, a design file is UTF-8", name, "Save it again as UTF-8.")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"line {line} of {name} is not UTF-8 (byte 0x{content[error.start]:02x})"
        fail("E159", message, f"{name}:{line}", "Save it again as UTF-8: ° and φ are written in two bytes there.")
    bad = NO_TEXT.search(text)
    if bad:
        line = len(LINE_END.findall(text, 0, bad.start())) + 1
        message = f"line {line} of {name} holds the character U+{ord(bad.group()):04X}, which is no text"
        fail("E159", message, f"{name}:{line}", "Is this a design file? Save it again as UTF-8 text.")
    return text
