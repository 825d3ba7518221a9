"""A design as located nodes: every value knows its dotted path and the line and column it stands at.

Scalars are texts, kept as the user wrote them, so that 045 stays 045 and no number is rounded here. The same tree is
made of a file (`yaml.py`) and of a Python mapping (`document_from`).
"""

import os
import re
from collections.abc import Callable, ItemsView, Iterator, Mapping
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import Any, Generic, NoReturn, TypeAlias, TypeVar

from slopekit.core.errors import DesignError, Fault
from slopekit.core.errors import fail as fail
from slopekit.core.orientation import Line, Plane

Value: TypeAlias = "dict[str, Node] | list[Node] | str | None"
Plain: TypeAlias = "dict[str, Plain] | list[Plain] | str | None"

T = TypeVar("T")

MAX_VALUES = 200_000
MAX_DEPTH = 100
WIDTH = 80
_NO_TEXT = "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]"


def no_text(text: str) -> "re.Match[str] | None":
    """The first character that YAML has not: a control character, half of a surrogate pair; None where all are text.

    >>> no_text("dip 45°"), no_text("dip\\x0045").start()
    (None, 3)
    """
    return None if text.isprintable() else re.search(_NO_TEXT, text)  # a millisecond to compile, for text with a slip


@dataclass(frozen=True)
class Place:
    """Where something was written; `line` 0 is a value from `--set` or from Python, without a file one of a call.

    >>> print(Place("north-wall.yaml", 6, 8, "J1: {plane: 95/115, strength: weak}"))
    north-wall.yaml:6:8  J1: {plane: 95/115, strength: weak}
    >>> print(Place("--set", 0, 0, "strength.weak.phi=25"))
    --set strength.weak.phi=25
    """

    file: str
    line: int
    column: int
    source: str

    def __str__(self) -> str:
        if not self.file:
            return self.source
        if self.line:
            return f"{self.file}:{self.line}:{self.column}  {self.source}".rstrip()
        return f"{self.file}{' ' if self.is_set else ': '}{self.source}"

    @property
    def is_set(self) -> bool:
        """Whether the value came by `--set`."""
        return not self.line and self.file == "--set"


@dataclass(frozen=True)
class Node:
    """A value of a design: keys with nodes, a list of nodes, the text as written, or None where nothing was written.

    `place` is where the value begins, `key_place` where its key stands (for a list item, the item itself). A key that
    is not there has the node `NOTHING`, which alone is false.
    """

    value: Value
    place: Place
    path: str
    key_place: Place

    def __bool__(self) -> bool:
        return self is not NOTHING

    @property
    def is_mapping(self) -> bool:
        """Whether the value has keys."""
        return isinstance(self.value, dict)

    @property
    def name(self) -> str:
        """The last part of the path: the key, or the index in a list."""
        return self.path.rpartition(".")[2]

    @property
    def text(self) -> str | None:
        """The text of a scalar; None for anything else."""
        return self.value if isinstance(self.value, str) else None

    @property
    def elements(self) -> tuple["Node", ...]:
        """The items of a list; nothing for anything else."""
        return tuple(self.value) if isinstance(self.value, list) else ()

    def get(self, key: str) -> "Node":
        """The node of a key, of a list that of an item by its number from 0; `NOTHING` where there is none."""
        if isinstance(self.value, list):
            return self.value[int(key)] if key.isdecimal() and int(key) < len(self.value) else NOTHING
        return self.value.get(key, NOTHING) if isinstance(self.value, dict) else NOTHING

    def at(self, path: str) -> "Node":
        """The node at a dotted path; keys may have dots (of correlations)."""
        parts = path.split(".")
        for count in range(1, len(parts) + 1):
            below = self.get(".".join(parts[:count]))
            if below:
                return below.at(".".join(parts[count:])) if parts[count:] else below
        return NOTHING

    def items(self) -> "ItemsView[str, Node]":
        """Keys and their nodes, in the order of the file; nothing where the value has no keys."""
        return (self.value if isinstance(self.value, dict) else {}).items()

    def walk(self) -> "Iterator[Node]":
        """The node and every node below it."""
        yield self
        for part in self.value.values() if isinstance(self.value, dict) else self.elements:
            yield from part.walk()

    def at_path(self, path: str) -> "Node":
        """The value as it stands at another path."""
        if isinstance(self.value, dict):
            made: Value = {key: below.at_path(joined(path, key)) for key, below in self.value.items()}
        elif isinstance(self.value, list):
            made = [below.at_path(joined(path, str(k))) for k, below in enumerate(self.value)]
        else:
            made = self.value
        return replace(self, value=made, path=path)

    def plain(self) -> Plain:
        """The value as dicts, lists, texts and None.

        >>> document_from({"slope": {"height": 64.89, "face": (60, 180)}}).root.plain()
        {'slope': {'height': '64.89', 'face': ['60', '180']}}
        """
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value


_NOWHERE = Place("", 0, 0, "")
#: What stands at a key that is not there.
NOTHING = Node(None, _NOWHERE, "", _NOWHERE)


class Kept(Generic[T]):
    """What was made of nodes, by the nodes themselves: a tree with one value replaced has all other nodes in common.

    A node never changes, so that what was made of it stays true; where there are too many, all are forgotten.

    >>> node, kept = document_from({"height": 5}).root, Kept()
    >>> kept.of(node) is None, kept.keep(node, 5.0), kept.of(node), kept.of(document_from({"height": 5}).root) is None
    (True, 5.0, 5.0, True)
    """

    def __init__(self, most: int = 20_000) -> None:
        self._most = most
        self._by_id: dict[int, tuple[Node, T]] = {}  # the node is held: its number is no other's

    def of(self, node: Node) -> T | None:
        """What was made of a node; None where nothing was."""
        kept = self._by_id.get(id(node))
        return None if kept is None else kept[1]

    def keep(self, node: Node, made: T) -> T:
        """Note what was made of a node."""
        if len(self._by_id) >= self._most:
            self._by_id.clear()
        self._by_id[id(node)] = node, made
        return made


@dataclass(frozen=True)
class Document:
    """A design as it was written: its tree, its name, and its file where it came from one.

    `option` names a key of a call as its caller wrote it (`--unit-weight`); in a file keys go by their paths.
    `allows_outside` lets it name files outside its own folder, whenever it is read again with other values.
    """

    root: Node
    name: str
    path: Path | None = None
    option: Callable[[str], str] | None = None
    allows_outside: bool = False

    def called(self, path: str) -> str:
        """How the key of a path is called where the design was written."""
        return path if self.option is None else self.option(path.rpartition(".")[2])


def document_from(mapping: Mapping[str, Any], name: str = "design") -> Document:
    """The tree of a Python mapping, the same as its YAML would give; None means not given.

    Raises
    ------
    DesignError
        E405 for a value that no design file could hold, E150 for a mapping that contains itself.

    >>> print(document_from({"strength": {"weak": {"phi": 25}}}).root.get("strength").get("weak").get("phi").place)
    design: strength.weak.phi = 25
    """
    faults: list[Fault] = []

    def place(path: str, value: object) -> Place:
        return Place(name, 0, 0, cut(f"{path} = {shown_of(value)}" if path else shown_of(value)))

    root = from_python(mapping, "", place, faults)
    if not root.is_mapping and not faults:
        faults.append(Fault("E150", f"{name} is {type(mapping).__name__}, not keys with values", name))
    if faults:
        raise DesignError(faults)
    return Document(root, name)


def from_python(
    value: Any, path: str, place_of: Callable[[str, Any], Place], faults: list[Fault], above: tuple[int, ...] = ()
) -> Node:
    place = place_of(path, value)
    made: Value = None
    if id(value) in above:
        faults.append(Fault("E150", f"{path or 'the design'} contains itself", str(place)))
    elif len(above) > MAX_DEPTH:
        fail_large(place, deep=True)
    elif hasattr(value, "tolist") and hasattr(value, "dtype"):
        return from_python(value.tolist(), path, place_of, faults, above)
    elif isinstance(value, Mapping):
        made = {}
        for key, part in value.items():
            if part is None:
                continue
            name = str(key)
            if name in made:
                faults.append(Fault("E151", f"{joined(path, name)} is given twice", str(place)))
            made[name] = from_python(part, joined(path, name), place_of, faults, (*above, id(value)))
    elif isinstance(value, list | tuple):
        made = [
            from_python(part, joined(path, str(k)), place_of, faults, (*above, id(value)))
            for k, part in enumerate(value)
        ]
    elif value is not None:
        made = _text_of(value)
        if made is None or no_text(made):
            shown = f"of the type {type(value).__name__}" if made is None else repr(made)
            advice = "Give numbers, texts, lists and dicts."
            faults.append(Fault("E405", f"{path or 'the value'} is {shown}, no design holds that", str(place), advice))
    return Node(made, place, path, place)


def as_text(orientation: Plane | Line) -> str:
    """An orientation as a design file has it, with every digit.

    >>> as_text(Plane(45.0, 115.0))
    '45.0/115.0'
    """
    if isinstance(orientation, Plane):
        return f"{orientation.dip_deg!r}/{orientation.dip_direction_deg!r}"
    return f"{orientation.trend_deg!r}/{orientation.plunge_deg!r}"


def _text_of(value: object) -> str | None:
    """What a design file would have for this value; None where it could have nothing."""
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Plane | Line):
        return as_text(value)
    if isinstance(value, os.PathLike):
        path = os.fspath(value)
        return path if isinstance(path, str) else None
    if isinstance(value, int):
        return str(value) if value.bit_length() < 1024 else ("inf" if value > 0 else "-inf")
    return repr(float(value)) if isinstance(value, Real) else None


def shown_of(value: object) -> str:
    if isinstance(value, Mapping):
        return f"{{{cut(', '.join(f'{key}: …' for key in list(value)[:9]))}}}"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    text = _text_of(value)
    return printable(text) if text is not None else f"a {type(value).__name__}"


# -- small things -----------------------------------------------------------------------------------------------------


def joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def fail_large(place: Place, deep: bool) -> NoReturn:
    if deep:
        fail("E149", f"values are nested more than {MAX_DEPTH} deep", str(place), "Is there a bracket left open?")
    advice = "Large meshes stand in files of their own: mesh: slip.stl."
    fail("E149", f"there are more than {MAX_VALUES} values", str(place), advice)


def cut(text: str) -> str:
    return text if len(text) <= WIDTH else text[: WIDTH - 1].rstrip() + "…"


def printable(text: str) -> str:
    return text if text.isprintable() else "".join(c if c.isprintable() else " " if c.isspace() else "�" for c in text)
