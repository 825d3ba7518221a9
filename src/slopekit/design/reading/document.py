"""A design file as a tree: read from the disk or a mapping, its synonyms replaced, values put over those it has.

Synonyms of keys (`cohesion`, `friction_angle`, `gamma`) become the keys they stand for before anything is read.
"""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from slopekit.core.errors import DesignError, Fault
from slopekit.core.synonyms import SYNONYMS, folded, synonym
from slopekit.design.fields import record_spec
from slopekit.design.reading.nodes import (
    MAX_DEPTH,
    NOTHING,
    Document,
    Node,
    Place,
    cut,
    document_from,
    fail,
    fail_large,
    from_python,
    joined,
    no_text,
    printable,
    shown_of,
)
from slopekit.design.reading.on_disk import ALLOW_OUTSIDE, read_bytes
from slopekit.design.reading.structure import (
    ANGLES,
    WRITTEN,
    Spec,
    is_distribution,
    orientation_kind,
    spread,
)
from slopekit.design.reading.yaml import LINE_END, NULLS, places_in, tree_of
from slopekit.design.registry import KINDS, record_of

#: Keys that exclude each other: a `--set` of one drops the others of the file.
ALTERNATIVES: Mapping[str, Sequence[str]] = {
    "water": ("mode", "fill", "pressures"),
    "rock": ("density", "unit_weight"),
    "crack": ("depth", "distance"),
}
_DOTTED_KEYS = ("correlation",)  # the keys of these mappings are names with dots: J1.phi/J2.phi


# -- from the disk -----------------------------------------------------------------------------------------------------


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
    source: str | os.PathLike[str] | Mapping[str, Any], overrides: Sequence[tuple[str, object]] = ()
) -> tuple[Document, list[Fault]]:
    """What `load_document` reads, and the faults that leave a tree to look at: keys twice, overrides that fit nowhere.

    Parameters
    ----------
    source : the path of a file, or the same as a mapping
    overrides : dotted path and value, as `with_overrides` takes them

    Raises
    ------
    DesignError
        Where there is no tree; E151, E160 and E405 for the overrides.
    """
    if isinstance(source, Mapping):
        document = document_from(source)
        root, faults = with_canonical_keys(document.root)
        document = replace(document, root=root)
    else:
        file = Path(source)
        document, faults = read_text(decoded(read_bytes(source), file.name), file.name, file)
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
    place = places_in(name, text)
    root, broken = tree_of(text, place, key_place=place(0, 0))
    start = str(place(0, 0))
    if root is None:
        advice = "slopekit templates show wedge prints a design to start from."
        fail("E150", f"{name} is empty", str(path or name), advice)
    if root.value is None and not broken:
        fail("E150", f"{name} holds no design", start, "slopekit templates show wedge prints a design.")
    if not root.is_mapping and not broken:
        shown = "a list" if isinstance(root.value, list) else f"the text {cut(repr(root.value))}"
        advice = "A design starts with keys: slopekit: 1, then kind: wedge."
        fail("E150", f"{name} holds {shown}, not keys with values", str(root.place), advice)
    root, faults = with_canonical_keys(root)
    document = Document(root, name, path, allows_outside=bool(os.environ.get(ALLOW_OUTSIDE)))
    return document, [*broken, *faults]


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


# -- synonyms of keys -------------------------------------------------------------------------------------------------


def with_canonical_keys(root: Node) -> tuple[Node, list[Fault]]:
    """The tree of a design with every synonym replaced by its key, and E151 where a key is given by two names."""
    spec, faults = _structure(root), list[Fault]()
    if spec is None or not _has_synonyms(root):
        return root, faults
    return _canonical(root, spec, root, "", faults), faults


def canonical_path(root: Node, path: str) -> str:
    """A dotted path with every synonym in it replaced, in a design with this tree.

    >>> from slopekit.design.reading.nodes import document_from
    >>> root = document_from({"kind": "wedge"}).root
    >>> canonical_path(root, "strength.weak.friction_angle"), canonical_path(root, "loads.kh")
    ('strength.weak.phi', 'loads.seismic')
    """
    parts = path.split(".")
    if not any(folded(part) in SYNONYMS for part in parts):
        return path
    spec = _structure(root)
    if parts[0] == "correlation":
        return ".".join(["correlation", _of_strengths(".".join(parts[1:]))]) if len(parts) > 1 else path
    for place, part in enumerate(parts):
        if spec is None:
            break
        keys = spec.keys
        if part not in keys and spec.names is None and spec.items is None:
            parts[place] = synonym(part, keys) or part
        spec = keys.get(parts[place]) or spec.names or (spec.items if part.isdigit() else None)
    return ".".join(parts)


def _structure(root: Node) -> Spec | None:
    """The keys that a design of its kind may have; None where it names no kind."""
    kind = root.get("kind")
    if kind.text is None or kind.text not in KINDS:
        return None
    record = record_of(kind.text)
    return record_spec(record, record.REQUIRED)


def _has_synonyms(node: Node) -> bool:
    """Whether any key could be a synonym: most designs have none, and are left as they are."""
    keys = {key for below in node.walk() for key, _ in below.items()}
    return any("/" in key or folded(key.rpartition(".")[2]) in SYNONYMS for key in keys)


def _canonical(node: Node, spec: Spec, root: Node, path: str, faults: list[Fault]) -> Node:
    """A value with canonical keys, at its canonical path."""
    node = node if node.path == path else replace(node, path=path)
    if isinstance(node.value, list) and spec.items is not None:
        items = enumerate(node.value)
        parts = [_canonical(item, spec.items, root, joined(path, str(k)), faults) for k, item in items]
        return replace(node, value=parts)
    if not node.is_mapping:
        return node
    made: dict[str, Node] = {}
    for word, below in node.items():
        key = _key(word, spec, node, root)
        inner = spec.keys.get(key) or spec.names
        if key in made or (key != word and node.get(key)):
            message = f"{joined(path, key)} is given twice" + (f", here as {word}" if word != key else "")
            faults.append(Fault("E151", message, str(below.key_place), "Leave one of them out."))
        else:
            made[key] = below if inner is None else _canonical(below, inner, root, joined(path, key), faults)
    return replace(node, value=made)


def _key(word: str, spec: Spec, node: Node, root: Node) -> str:
    """The key that a word under a node stands for."""
    if node.path == "correlation":
        return _of_strengths(word)
    if node.name == "set" and node.path.startswith("cases."):
        return canonical_path(root, word.strip())
    return word if word in spec.keys else synonym(word, spec.keys) or word


def _of_strengths(names: str) -> str:
    """Names of a correlation with the keys of strengths at their ends: `weak.cohesion/weak.friction`."""
    made = []
    for name in names.split("/"):
        above, dot, last = name.strip().rpartition(".")
        made.append(
            f"{above}{dot}{synonym(last, ('c', 'phi', 'tension', 'dilation', 'unit_weight', 'density')) or last}"
        )
    return "/".join(made)


# -- values put over those of a design --------------------------------------------------------------------------------


def parse_override(text: str) -> tuple[str, str]:
    """Split what follows `--set` into its dotted path and its value.

    Raises
    ------
    DesignError
        E160 without an equals sign or without a path.

    >>> parse_override("strength.weak.phi=25")
    ('strength.weak.phi', '25')
    """
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        advice = "Write --set key=value, for example --set strength.weak.phi=25."
        fail("E160", f"--set {cut(text)} is not key=value", f"--set {cut(text)}", advice)
    return path.strip(), value.strip()


def with_overrides(document: Document, overrides: Sequence[tuple[str, object]]) -> Document:
    """A copy of the document with some values replaced: one of `ALTERNATIVES` drops the others that were not set too.

    Parameters
    ----------
    overrides : dotted path (list items by their number from 0) and value: text is read as YAML reads it inside
        brackets, other Python values as `document_from` takes them; null or None removes the key

    Raises
    ------
    DesignError
        E151 a path set twice, E160 no path, broken YAML, a path through a value, or no such list item.

    >>> from slopekit.design.reading.nodes import document_from
    >>> design = document_from({"water": {"mode": "full"}, "support": {"bolts": [{"force": "200 kN"}]}})
    >>> changed = with_overrides(design, [("water.fill", "50 %"), ("support.bolts.0.acts", "passive")])
    >>> changed.root.plain()
    {'water': {'fill': '50 %'}, 'support': {'bolts': [{'force': '200 kN', 'acts': 'passive'}]}}
    """
    root, faults, seen = document.root, list[Fault](), set[str]()
    own = set[Place]()
    for path, value in overrides:
        if isinstance(value, Node):  # of the design itself, a load case: it keeps its place
            place = value.key_place
            own |= {place, value.place}
        else:
            shown = value if isinstance(value, str) else shown_of(value)
            place = Place("--set", 0, 0, cut(f"{path}={shown}"))
            own.add(place)
        path = canonical_path(root, path)
        if path in seen:
            faults.append(Fault("E151", f"{path} is set twice", str(place), "Leave one of them out."))
            continue
        seen.add(path)
        try:
            parts = _parts(path, place)
            new = _override_value(value, path, place)
            root = _replaced(root, parts, new, place)
            if new.is_mapping or new.elements:
                root, twice = with_canonical_keys(root)
                faults += twice
        except DesignError as error:
            faults += error.faults
            continue
        if new.value is not None:
            root = _without_alternatives(root, path, own)
    if faults:
        raise DesignError(faults)
    return replace(document, root=root)


def _override_value(value: object, path: str, place: Place) -> Node:
    faults: list[Fault] = []
    if isinstance(value, Node):
        return value.at_path(path)
    if not isinstance(value, str):
        node = from_python(value, path, lambda _path, _value: place, faults)
    elif value.lstrip()[:1] in ("[", "{", "'", '"'):
        try:
            tree, faults = tree_of(value.strip(), lambda _line, _column: place, path, place)
        except DesignError as error:
            fault = error.faults[0]
            message = f"the value of --set {path} is {fault.message}"
            raise DesignError([Fault("E160", message, str(place), fault.advice)]) from None
        node = tree or Node(None, place, path, place)
    else:
        text = value.strip()
        if no_text(text):
            fail("E160", f"the value of --set {path} is no text", printable(str(place)))
        node = Node(None if text in NULLS else text, place, path, place)
    if faults:
        raise DesignError(faults)
    return node


def _written(path: str, place: Place) -> str:
    """How a value is put over a path: as it was done there."""
    return f"--set {path}=…" if place.is_set else f"{path}: …"


def _parts(path: str, place: Place) -> list[str]:
    parts = path.split(".")
    if not all(part.strip() for part in parts) or no_text(path):
        advice = f"Write {_written('strength.weak.phi', place)[:-1].strip()}{'' if place.is_set else ' '}25."
        fail("E160", f"{cut(printable(path))!r} is no path to a key", printable(str(place)), advice)
    if len(parts) > MAX_DEPTH:
        fail_large(place, deep=True)
    if parts[0] in _DOTTED_KEYS and len(parts) > 2:
        parts[1:] = [".".join(parts[1:])]
    if parts[0] == "cases" and parts[2:3] == ["set"] and len(parts) > 4:
        parts[3:] = [".".join(parts[3:])]  # what a case sets goes by its path
    return parts


def _turned(node: Node, parts: list[str], new: Node, place: Place) -> Node | None:
    """An orientation `dip/dip direction` or `[dip, dip direction]` with one of the two replaced.

    A line is trend/plunge. A number stays in the spelling of the file; a distribution makes it the two angles by name.
    """
    of = orientation_kind(node)
    order = WRITTEN[of or "plane"]
    if of is None or new.value is None or parts not in ([order[0]], [order[1]]):
        return None
    if isinstance(node.value, str):
        first, slash, second = node.value.partition("/")
        angles = [first.strip(), second.strip()] if slash else []
    else:
        angles = [item.text or "" for item in node.elements]
    if len(angles) != 2:
        return None
    if new.text is not None:
        angles[order.index(parts[0])] = new.text
        return replace(node, value="/".join(angles), place=place)
    made = {
        angle: Node(text, node.place, joined(node.path, angle), node.key_place)
        for angle, text in zip(order, angles, strict=True)
    }
    made[parts[0]] = replace(new, path=joined(node.path, parts[0]))
    return replace(node, value=made, place=place)


def _replaced(node: Node, parts: list[str], new: Node, place: Place) -> Node:
    """A copy of `node` with the value at `parts` replaced, or removed where `new` holds nothing."""
    turned = _turned(node, parts, new, place)
    if turned is not None:
        return turned
    if is_distribution(node) and orientation_kind(node) is not None and parts[0] in sum(ANGLES.values(), ()):
        message = f"{node.path} is a distribution, it has no {parts[0]} of its own"
        mean, whole = _written(f"{node.path}.mean", place), _written(node.path, place)
        fail("E160", message, str(place), f"Set its mean: {mean}, or the whole orientation: {whole}")
    if isinstance(node.value, list):
        return replace(node, value=_replaced_item(node, node.value, parts, new, place))
    node = spread(node)
    if isinstance(node.value, str):
        message = f"{node.path} is the value {cut(node.value)}, it has no {parts[0]}"
        fail("E160", message, str(place), f"Set it as a whole: {_written(node.path, place)}")
    entries = dict(node.items())
    key = parts[0]
    if len(parts) == 1:
        if new.value is None:
            entries.pop(key, None)
        else:
            old = entries.get(key)
            entries[key] = new if old is None else replace(new, path=old.path)
    else:
        below = entries.get(key) or Node(None, place, joined(node.path, key), place)
        if new.value is None and below.value is None:
            return node
        entries[key] = _replaced(below, parts[1:], new, place)
    return replace(node, value=entries)


def _replaced_item(node: Node, items: list[Node], parts: list[str], new: Node, place: Place) -> list[Node]:
    if not re.fullmatch(r"[0-9]{1,9}", parts[0]):
        message = f"{node.path} is a list, {parts[0]} is no number of an item"
        fail("E160", message, str(place), f"Its items are {node.path}.0 to {node.path}.{max(len(items) - 1, 0)}.")
    index = int(parts[0])
    if index >= len(items):
        items_are = f"Its items are {node.path}.0 to {node.path}.{len(items) - 1}." if items else "It is empty."
        fail("E160", f"{node.path} has {len(items)} items, there is no item {index}", str(place), items_are)
    copy = list(items)
    if len(parts) > 1:
        copy[index] = _replaced(items[index], parts[1:], new, place)
    elif new.value is None:
        advice = f"Set the whole list: {_written(node.path, place)}"
        fail("E160", f"{node.path}.{index} cannot be taken out of its list", str(place), advice)
    else:
        copy[index] = new
    return copy


def _without_alternatives(root: Node, path: str, own: set[Place]) -> Node:
    """The tree without what excludes `path`, unless that was set in the same call."""
    parent, chosen = (f"{path}.".split(".", 2))[:2]
    keys, above = ALTERNATIVES.get(parent, ()), root.get(parent)
    for key in keys if chosen in keys else ():
        other = above.get(key) if key != chosen else NOTHING
        if other and own.isdisjoint({other.key_place, *(part.place for part in other.walk())}):
            root = _replaced(root, [parent, key], NOTHING, other.place)
    return root
