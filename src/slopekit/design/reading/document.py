"""Design files as documents: reading them from disk or from a mapping, replacing synonyms of keys, overriding values.

Synonyms of keys (`cohesion`, `friction_angle`, `gamma`) are replaced by the keys before any value is read.
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
    find_invalid_character,
    from_python,
    joined,
    printable,
    value_summary,
)
from slopekit.design.reading.on_disk import ALLOW_OUTSIDE, read_bytes
from slopekit.design.reading.structure import (
    ANGLES,
    WRITTEN_ANGLES,
    Spec,
    expand_short_form,
    is_distribution,
    orientation_kind,
)
from slopekit.design.reading.yaml import LINE_END, NULLS, places_in, tree_of
from slopekit.design.registry import KINDS, record_of

#: Keys that exclude each other: setting one with `--set` removes the others from the file's tree.
ALTERNATIVES: Mapping[str, Sequence[str]] = {
    "water": ("mode", "fill", "pressures"),
    "rock": ("density", "unit_weight"),
    "crack": ("depth", "distance"),
}
_DOTTED_KEYS = ("correlation",)  # the keys in these groups are names with dots: J1.phi/J2.phi


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
    """Read a design as `load_document` does, and return it with those faults that leave a usable tree.

    Such faults are duplicate keys and overrides of unknown paths.

    Parameters
    ----------
    source : the path of a file, or its content as a mapping
    overrides : dotted path and value, as `with_overrides` takes them

    Raises
    ------
    DesignError
        If no tree can be read; E151, E160 and E405 for the overrides.
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
    """Read a design from the text of a file and return it with those faults that leave a usable tree.

    Raises
    ------
    DesignError
        If no tree can be read.
    """
    place = places_in(name, text)
    root, broken = tree_of(text, place, key_place=place(0, 0))
    start = str(place(0, 0))
    if root is None:
        advice = "slopekit templates show wedge prints a design to start from."
        fail("E150", f"{name} is empty", str(path or name), advice)
    if root.value is None and not broken:
        fail(
            "E150",
            f"{name} holds no design",
            start,
            "slopekit templates show wedge prints a design.",
        )
    if not root.is_mapping and not broken:
        content_text = (
            "a list" if isinstance(root.value, list) else f"the text {cut(repr(root.value))}"
        )
        advice = "A design starts with keys: slopekit: 1, then kind: wedge."
        fail("E150", f"{name} holds {content_text}, not keys with values", str(root.place), advice)
    root, faults = with_canonical_keys(root)
    document = Document(root, name, path, allows_outside=bool(os.environ.get(ALLOW_OUTSIDE)))
    return document, [*broken, *faults]


def decoded(content: bytes, name: str) -> str:
    """Return the text of a design file. Raises DesignError E159 where it is not text in UTF-8."""
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        fail("E159", f"{name} is UTF-16, a design file is UTF-8", name, "Save it again as UTF-8.")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"line {line} of {name} is not UTF-8 (byte 0x{content[error.start]:02x})"
        fail(
            "E159",
            message,
            f"{name}:{line}",
            "Save it again as UTF-8: ° and φ are written in two bytes there.",
        )
    bad = find_invalid_character(text)
    if bad:
        line = len(LINE_END.findall(text, 0, bad.start())) + 1
        message = (
            f"line {line} of {name} holds the character U+{ord(bad.group()):04X}, which is no text"
        )
        fail(
            "E159", message, f"{name}:{line}", "Is this a design file? Save it again as UTF-8 text."
        )
    return text


# -- synonyms of keys -------------------------------------------------------------------------------------------------


def with_canonical_keys(root: Node) -> tuple[Node, list[Fault]]:
    """Return the tree with every synonym replaced by its key, and faults E151 for keys given by two names."""
    spec, faults = _structure(root), list[Fault]()
    if spec is None or not _has_synonyms(root):
        return root, faults
    return _canonical(root, spec, root, "", faults), faults


def canonical_path(root: Node, path: str) -> str:
    """Return a dotted path of a design with every synonym in it replaced by its key.

    >>> from slopekit.design.reading.nodes import document_from
    >>> root = document_from({"kind": "wedge"}).root
    >>> canonical_path(root, "strength.weak.friction_angle"), canonical_path(root, "loads.kh")
    ('strength.weak.phi', 'loads.seismic')
    """
    path_keys = path.split(".")
    if not any(folded(key) in SYNONYMS for key in path_keys):
        return path
    spec = _structure(root)
    if path_keys[0] == "correlation":
        return (
            ".".join(["correlation", _canonical_pair(".".join(path_keys[1:]))])
            if len(path_keys) > 1
            else path
        )
    for place, key in enumerate(path_keys):
        if spec is None:
            break
        keys = spec.keys
        if key not in keys and spec.names is None and spec.items is None:
            path_keys[place] = synonym(key, keys) or key
        spec = keys.get(path_keys[place]) or spec.names or (spec.items if key.isdigit() else None)
    return ".".join(path_keys)


def _structure(root: Node) -> Spec | None:
    """Return the specification of the keys of the design's kind; None where it names no known kind."""
    kind = root.get("kind")
    if kind.text is None or kind.text not in KINDS:
        return None
    record = record_of(kind.text)
    return record_spec(record, record.REQUIRED)


def _has_synonyms(node: Node) -> bool:
    """Return whether any key could be a synonym (most designs have none and need no copy)."""
    keys = {key for below in node.walk() for key, _ in below.items()}
    return any("/" in key or folded(key.rpartition(".")[2]) in SYNONYMS for key in keys)


def _canonical(node: Node, spec: Spec, root: Node, path: str, faults: list[Fault]) -> Node:
    """Return a node with canonical keys and a canonical path; duplicate keys are added to `faults`."""
    node = node if node.path == path else replace(node, path=path)
    if isinstance(node.value, list) and spec.items is not None:
        items = enumerate(node.value)
        nodes = [
            _canonical(item, spec.items, root, joined(path, str(k)), faults) for k, item in items
        ]
        return replace(node, value=nodes)
    if not node.is_mapping:
        return node
    entries: dict[str, Node] = {}
    for word, below in node.items():
        key = _key(word, spec, node, root)
        inner = spec.keys.get(key) or spec.names
        if key in entries or (key != word and node.get(key)):
            message = f"{joined(path, key)} is given twice" + (
                f", here as {word}" if word != key else ""
            )
            faults.append(Fault("E151", message, str(below.key_place), "Leave one of them out."))
        else:
            entries[key] = (
                below
                if inner is None
                else _canonical(below, inner, root, joined(path, key), faults)
            )
    return replace(node, value=entries)


def _key(word: str, spec: Spec, node: Node, root: Node) -> str:
    """Return the canonical key of a word written under a node."""
    if node.path == "correlation":
        return _canonical_pair(word)
    if node.name == "set" and node.path.startswith("cases."):
        return canonical_path(root, word.strip())
    return word if word in spec.keys else synonym(word, spec.keys) or word


def _canonical_pair(names: str) -> str:
    """Return the pair of names of a correlation with canonical strength keys, as of `weak.cohesion/weak.friction`."""
    canonical_names = []
    for name in names.split("/"):
        above, dot, last = name.strip().rpartition(".")
        canonical_names.append(
            f"{above}{dot}{synonym(last, ('c', 'phi', 'tension', 'dilation', 'unit_weight', 'density')) or last}"
        )
    return "/".join(canonical_names)


# -- overrides --------------------------------------------------------------------------------------------------------


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
    """Return a copy of the document with some values replaced.

    Setting one key of `ALTERNATIVES` removes the keys it excludes, unless they are set in the same call.

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
    places_set = set[Place]()
    for path, value in overrides:
        if isinstance(value, Node):  # from a load case of the design itself: it keeps its place
            place = value.key_place
            places_set |= {place, value.place}
        else:
            value_text = value if isinstance(value, str) else value_summary(value)
            place = Place("--set", 0, 0, cut(f"{path}={value_text}"))
            places_set.add(place)
        path = canonical_path(root, path)
        if path in seen:
            faults.append(
                Fault("E151", f"{path} is set twice", str(place), "Leave one of them out.")
            )
            continue
        seen.add(path)
        try:
            keys = _keys_of_path(path, place)
            new = _override_value(value, path, place)
            root = _with_value_replaced(root, keys, new, place)
            if new.is_mapping or new.elements:
                root, twice = with_canonical_keys(root)
                faults += twice
        except DesignError as error:
            faults += error.faults
            continue
        if new.value is not None:
            root = _without_alternatives(root, path, places_set)
    if faults:
        raise DesignError(faults)
    return replace(document, root=root)


def _override_value(value: object, path: str, place: Place) -> Node:
    faults: list[Fault] = []
    if isinstance(value, Node):
        return value.with_path(path)
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
        if find_invalid_character(text):
            fail("E160", f"the value of --set {path} is no text", printable(str(place)))
        node = Node(None if text in NULLS else text, place, path, place)
    if faults:
        raise DesignError(faults)
    return node


def _setting_text(path: str, place: Place) -> str:
    """Return how to set the value of a path, for advice: by `--set`, or as a line of a file or load case."""
    return f"--set {path}=…" if place.is_set else f"{path}: …"


def _keys_of_path(path: str, place: Place) -> list[str]:
    keys = path.split(".")
    if not all(key.strip() for key in keys) or find_invalid_character(path):
        advice = f"Write {_setting_text('strength.weak.phi', place)[:-1].strip()}{'' if place.is_set else ' '}25."
        fail("E160", f"{cut(printable(path))!r} is no path to a key", printable(str(place)), advice)
    if len(keys) > MAX_DEPTH:
        fail_large(place, deep=True)
    if keys[0] in _DOTTED_KEYS and len(keys) > 2:
        keys[1:] = [".".join(keys[1:])]
    if keys[0] == "cases" and keys[2:3] == ["set"] and len(keys) > 4:
        keys[3:] = [".".join(keys[3:])]  # the keys that a load case sets are dotted paths
    return keys


def _with_angle_replaced(node: Node, keys: list[str], new: Node, place: Place) -> Node | None:
    """Return an orientation written `45/115` or `[45, 115]` with one angle replaced; None if it is anything else.

    A line is written trend/plunge. The other angle keeps its text; a distribution gives the form with named angles.
    """
    kind = orientation_kind(node)
    order = WRITTEN_ANGLES[kind or "plane"]
    if kind is None or new.value is None or keys not in ([order[0]], [order[1]]):
        return None
    if isinstance(node.value, str):
        first, slash, second = node.value.partition("/")
        angles = [first.strip(), second.strip()] if slash else []
    else:
        angles = [item.text or "" for item in node.elements]
    if len(angles) != 2:
        return None
    if new.text is not None:
        angles[order.index(keys[0])] = new.text
        return replace(node, value="/".join(angles), place=place)
    angle_nodes = {
        angle: Node(text, node.place, joined(node.path, angle), node.key_place)
        for angle, text in zip(order, angles, strict=True)
    }
    angle_nodes[keys[0]] = replace(new, path=joined(node.path, keys[0]))
    return replace(node, value=angle_nodes, place=place)


def _with_value_replaced(node: Node, keys: list[str], new: Node, place: Place) -> Node:
    """Return a copy of `node` with the value at `keys` replaced, or removed where `new` has no value."""
    with_angle = _with_angle_replaced(node, keys, new, place)
    if with_angle is not None:
        return with_angle
    if (
        is_distribution(node)
        and orientation_kind(node) is not None
        and keys[0] in sum(ANGLES.values(), ())
    ):
        message = f"{node.path} is a distribution, it has no {keys[0]} of its own"
        mean, orientation = (
            _setting_text(f"{node.path}.mean", place),
            _setting_text(node.path, place),
        )
        fail(
            "E160",
            message,
            str(place),
            f"Set its mean: {mean}, or the whole orientation: {orientation}",
        )
    if isinstance(node.value, list):
        return replace(node, value=_with_entry_replaced(node, node.value, keys, new, place))
    node = expand_short_form(node)
    if isinstance(node.value, str):
        message = f"{node.path} is the value {cut(node.value)}, it has no {keys[0]}"
        fail("E160", message, str(place), f"Set it as a whole: {_setting_text(node.path, place)}")
    entries = dict(node.items())
    key = keys[0]
    if len(keys) == 1:
        if new.value is None:
            entries.pop(key, None)
        else:
            old = entries.get(key)
            entries[key] = new if old is None else replace(new, path=old.path)
    else:
        below = entries.get(key) or Node(None, place, joined(node.path, key), place)
        if new.value is None and below.value is None:
            return node
        entries[key] = _with_value_replaced(below, keys[1:], new, place)
    return replace(node, value=entries)


def _with_entry_replaced(
    node: Node, items: list[Node], keys: list[str], new: Node, place: Place
) -> list[Node]:
    if not re.fullmatch(r"[0-9]{1,9}", keys[0]):
        message = f"{node.path} is a list, {keys[0]} is no number of an item"
        fail(
            "E160",
            message,
            str(place),
            f"Its items are {node.path}.0 to {node.path}.{max(len(items) - 1, 0)}.",
        )
    index = int(keys[0])
    if index >= len(items):
        items_are = (
            f"Its items are {node.path}.0 to {node.path}.{len(items) - 1}."
            if items
            else "It is empty."
        )
        fail(
            "E160",
            f"{node.path} has {len(items)} items, there is no item {index}",
            str(place),
            items_are,
        )
    copy = list(items)
    if len(keys) > 1:
        copy[index] = _with_value_replaced(items[index], keys[1:], new, place)
    elif new.value is None:
        advice = f"Set the whole list: {_setting_text(node.path, place)}"
        fail("E160", f"{node.path}.{index} cannot be taken out of its list", str(place), advice)
    else:
        copy[index] = new
    return copy


def _without_alternatives(root: Node, path: str, places_set: set[Place]) -> Node:
    """Return the tree without the keys that exclude `path`, except those at `places_set` (set in the same call)."""
    parent, chosen = (f"{path}.".split(".", 2))[:2]
    keys, above = ALTERNATIVES.get(parent, ()), root.get(parent)
    for key in keys if chosen in keys else ():
        alternative = above.get(key) if key != chosen else NOTHING
        if alternative and places_set.isdisjoint(
            {alternative.key_place, *(descendant.place for descendant in alternative.walk())}
        ):
            root = _with_value_replaced(root, [parent, key], NOTHING, alternative.place)
    return root
