"""The tree of a design: every node has its dotted path and the line and column where it is written.

Scalars are texts as the user wrote them, so that 045 stays 045 and no number is rounded here. A file (`yaml.py`) and
a Python mapping (`document_from`) give the same tree.
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


def find_invalid_character(text: str) -> "re.Match[str] | None":
    """Find the first character that YAML does not allow (a control character or half of a surrogate pair).

    >>> find_invalid_character("dip 45°"), find_invalid_character("dip\\x0045").start()
    (None, 3)
    """
    return (
        None if text.isprintable() else re.search(_NO_TEXT, text)
    )  # compiled only when needed: it takes a millisecond


@dataclass(frozen=True)
class Place:
    """The place where a value was written; `line` is 0 for a value from `--set` or from Python.

    Without a file, it is an argument of a call.

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
        """Whether the value comes from `--set`."""
        return not self.line and self.file == "--set"


@dataclass(frozen=True)
class Node:
    """A value of a design: keys with nodes, a list of nodes, the text as written, or None where nothing is written.

    `place` is the place where the value begins, `key_place` that of its key (for a list item, of the item). A missing
    key has the node `NOTHING`, the only one that is false.
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
        """The last element of the path: the key, or the index in a list."""
        return self.path.rpartition(".")[2]

    @property
    def text(self) -> str | None:
        """The text of a scalar; None for anything else."""
        return self.value if isinstance(self.value, str) else None

    @property
    def elements(self) -> tuple["Node", ...]:
        """The nodes of a list's items; empty for anything else."""
        return tuple(self.value) if isinstance(self.value, list) else ()

    def get(self, key: str) -> "Node":
        """Return the node of a key, or of a list item by its number from 0; `NOTHING` where it is missing."""
        if isinstance(self.value, list):
            return (
                self.value[int(key)] if key.isdecimal() and int(key) < len(self.value) else NOTHING
            )
        return self.value.get(key, NOTHING) if isinstance(self.value, dict) else NOTHING

    def find(self, path: str) -> "Node":
        """Return the node at a dotted path, `NOTHING` if missing; keys may contain dots (those of correlations do)."""
        keys = path.split(".")
        for count in range(1, len(keys) + 1):
            below = self.get(".".join(keys[:count]))
            if below:
                return below.find(".".join(keys[count:])) if keys[count:] else below
        return NOTHING

    def items(self) -> "ItemsView[str, Node]":
        """Return keys and their nodes in the order of the file; empty where the value has no keys."""
        return (self.value if isinstance(self.value, dict) else {}).items()

    def walk(self) -> "Iterator[Node]":
        """Yield this node and every node below it."""
        yield self
        for child in self.value.values() if isinstance(self.value, dict) else self.elements:
            yield from child.walk()

    def with_path(self, path: str) -> "Node":
        """Return a copy of this node and of all nodes below it, with their paths moved to `path`."""
        if isinstance(self.value, dict):
            value: Value = {
                key: below.with_path(joined(path, key)) for key, below in self.value.items()
            }
        elif isinstance(self.value, list):
            value = [below.with_path(joined(path, str(k))) for k, below in enumerate(self.value)]
        else:
            value = self.value
        return replace(self, value=value, path=path)

    def plain(self) -> Plain:
        """Return the value as dicts, lists, texts and None.

        >>> document_from({"slope": {"height": 64.89, "face": (60, 180)}}).root.plain()
        {'slope': {'height': '64.89', 'face': ['60', '180']}}
        """
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value


_NO_PLACE = Place("", 0, 0, "")
#: The node of a missing key.
NOTHING = Node(None, _NO_PLACE, "", _NO_PLACE)


class NodeCache(Generic[T]):
    """A cache of results computed from nodes: a tree with one value replaced shares all other nodes.

    Nodes never change, so results stay valid; the cache is cleared when it is full.

    >>> node, cache = document_from({"height": 5}).root, NodeCache()
    >>> cache.get(node) is None, cache.store(node, 5.0), cache.get(node)
    (True, 5.0, 5.0)
    >>> cache.get(document_from({"height": 5}).root) is None
    True
    """

    def __init__(self, most: int = 20_000) -> None:
        self._most = most
        self._by_id: dict[int, tuple[Node, T]] = {}  # a reference to the node keeps its id unique

    def get(self, node: Node) -> T | None:
        """Return the result of a node; None where none is stored."""
        entry = self._by_id.get(id(node))
        return None if entry is None else entry[1]

    def store(self, node: Node, result: T) -> T:
        """Store the result of a node and return it."""
        if len(self._by_id) >= self._most:
            self._by_id.clear()
        self._by_id[id(node)] = node, result
        return result


@dataclass(frozen=True)
class Document:
    """A design as it was written: its tree, its name, and the path of its file, if any.

    `option` gives the name of a key in a call as the caller wrote it (`--unit-weight`); None for a file, whose keys are
    named by their paths. `allows_outside` permits names of files outside its own folder.
    """

    root: Node
    name: str
    path: Path | None = None
    option: Callable[[str], str] | None = None
    allows_outside: bool = False

    def written_key(self, path: str) -> str:
        """Return the name of a path's key as the user wrote it: the path in a file, the option in a call."""
        return path if self.option is None else self.option(path.rpartition(".")[2])


def document_from(mapping: Mapping[str, Any], name: str = "design") -> Document:
    """Return the document of a Python mapping, equal to that of its YAML; keys with the value None are left out.

    Raises
    ------
    DesignError
        E405 for a value that no design file could hold, E150 for a mapping that contains itself.

    >>> print(document_from({"strength": {"weak": {"phi": 25}}}).root.get("strength").get("weak").get("phi").place)
    design: strength.weak.phi = 25
    """
    faults: list[Fault] = []

    def place(path: str, value: object) -> Place:
        return Place(
            name, 0, 0, cut(f"{path} = {value_summary(value)}" if path else value_summary(value))
        )

    root = from_python(mapping, "", place, faults)
    if not root.is_mapping and not faults:
        faults.append(
            Fault("E150", f"{name} is {type(mapping).__name__}, not keys with values", name)
        )
    if faults:
        raise DesignError(faults)
    return Document(root, name)


def from_python(
    value: Any,
    path: str,
    place_of: Callable[[str, Any], Place],
    faults: list[Fault],
    ancestor_ids: tuple[int, ...] = (),
) -> Node:
    place = place_of(path, value)
    content: Value = None
    if id(value) in ancestor_ids:
        faults.append(Fault("E150", f"{path or 'the design'} contains itself", str(place)))
    elif len(ancestor_ids) > MAX_DEPTH:
        fail_large(place, deep=True)
    elif hasattr(value, "tolist") and hasattr(value, "dtype"):
        return from_python(value.tolist(), path, place_of, faults, ancestor_ids)
    elif isinstance(value, Mapping):
        content = {}
        for key, entry in value.items():
            if entry is None:
                continue
            name = str(key)
            if name in content:
                faults.append(Fault("E151", f"{joined(path, name)} is given twice", str(place)))
            content[name] = from_python(
                entry, joined(path, name), place_of, faults, (*ancestor_ids, id(value))
            )
    elif isinstance(value, list | tuple):
        content = [
            from_python(entry, joined(path, str(k)), place_of, faults, (*ancestor_ids, id(value)))
            for k, entry in enumerate(value)
        ]
    elif value is not None:
        content = _text_of(value)
        if content is None or find_invalid_character(content):
            description = (
                f"of the type {type(value).__name__}" if content is None else repr(content)
            )
            advice = "Give numbers, texts, lists and dicts."
            faults.append(
                Fault(
                    "E405",
                    f"{path or 'the value'} is {description}, no design holds that",
                    str(place),
                    advice,
                )
            )
    return Node(content, place, path, place)


def as_text(orientation: Plane | Line) -> str:
    """Return an orientation as a design file writes it, with all digits.

    >>> as_text(Plane(45.0, 115.0))
    '45.0/115.0'
    """
    if isinstance(orientation, Plane):
        return f"{orientation.dip_deg!r}/{orientation.dip_direction_deg!r}"
    return f"{orientation.trend_deg!r}/{orientation.plunge_deg!r}"


def _text_of(value: object) -> str | None:
    """Return the text of a scalar Python value in a design file; None if no design file can hold the value."""
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


def value_summary(value: object) -> str:
    if isinstance(value, Mapping):
        return f"{{{cut(', '.join(f'{key}: …' for key in list(value)[:9]))}}}"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    text = _text_of(value)
    return printable(text) if text is not None else f"a {type(value).__name__}"


# -- texts ------------------------------------------------------------------------------------------------------------


def joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def fail_large(place: Place, deep: bool) -> NoReturn:
    if deep:
        fail(
            "E149",
            f"values are nested more than {MAX_DEPTH} deep",
            str(place),
            "Is there a bracket left open?",
        )
    advice = "Large meshes stand in files of their own: mesh: slip.stl."
    fail("E149", f"there are more than {MAX_VALUES} values", str(place), advice)


def cut(text: str) -> str:
    return text if len(text) <= WIDTH else text[: WIDTH - 1].rstrip() + "…"


def printable(text: str) -> str:
    return (
        text
        if text.isprintable()
        else "".join(c if c.isprintable() else " " if c.isspace() else "�" for c in text)
    )
