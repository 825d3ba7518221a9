"""Values put over those of a design: `--set a.b.c=value` and `sk.run(set=...)`."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.canonical import canonical_path, with_canonical_keys
from slopekit.design.reading.nodes import (
    MAX_DEPTH,
    Document,
    Node,
    Place,
    cut,
    fail,
    fail_large,
    from_python,
    joined,
    no_text,
    printable,
    shown_of,
)
from slopekit.design.reading.structure import (
    ANGLES,
    WRITTEN,
    OrientationKind,
    is_distribution,
    orientation_kind,
    spread,
)
from slopekit.design.reading.yaml import NULLS, SourceLines, TreeBuilder, composed

#: Keys that exclude each other: a `--set` of one drops the others of the file.
ALTERNATIVES: Mapping[str, Sequence[str]] = {
    "water": ("mode", "fill", "pressures"),
    "rock": ("density", "unit_weight"),
    "crack": ("depth", "distance"),
}
_DOTTED_KEYS = ("correlation",)  # the keys of these mappings are names with dots: J1.phi/J2.phi


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
            root = _replaced(root, parts, new if new.value is not None else None, place)
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
        return _moved(value, path)
    if not isinstance(value, str):
        node = from_python(value, path, lambda _path, _value: place, faults)
    elif value.lstrip()[:1] in ("[", "{", "'", '"'):
        try:
            item = composed(value.strip(), SourceLines("--set", value.strip()))
        except DesignError as error:
            fault = error.faults[0]
            message = f"the value of --set {path} is {fault.message}"
            raise DesignError([Fault("E160", message, str(place), fault.advice)]) from None
        builder = TreeBuilder(lambda _line, _column: place)
        node, faults = builder.build(item, path, place), builder.faults
    else:
        text = value.strip()
        if no_text(text):
            fail("E160", f"the value of --set {path} is no text", printable(str(place)))
        node = Node(None if text in NULLS else text, place, path, place)
    if faults:
        raise DesignError(faults)
    return node


def _moved(node: Node, path: str) -> Node:
    """A value as it stands at another path: `null` in text as nothing."""
    if isinstance(node.value, dict):
        made = {key: _moved(below, joined(path, key)) for key, below in node.value.items()}
        return replace(node, value=made, path=path)
    if isinstance(node.value, list):
        parts = [_moved(below, joined(path, str(k))) for k, below in enumerate(node.value)]
        return replace(node, value=parts, path=path)
    return replace(node, path=path)


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


def _turned(node: Node, parts: list[str], new: Node | None, place: Place) -> Node | None:
    """An orientation `dip/dip direction` or `[dip, dip direction]` with one of the two replaced.

    A line is trend/plunge. A number stays in the spelling of the file; a distribution makes it the two angles by name.
    """
    of = orientation_kind(node) or _of_mean(node)
    order = WRITTEN[of or "plane"]
    if of is None or new is None or parts not in ([order[0]], [order[1]]):
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


def _of_mean(node: Node) -> OrientationKind | None:
    """What the mean of an orientation that scatters is one of."""
    above, _, name = node.path.rpartition(".")
    return orientation_kind(replace(node, path=above)) if name == "mean" else None


def _replaced(node: Node, parts: list[str], new: Node | None, place: Place) -> Node:
    """A copy of `node` with the value at `parts` replaced, or removed where `new` is None."""
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
        if new is None:
            entries.pop(key, None)
        else:
            old = entries.get(key)
            entries[key] = new if old is None else replace(new, path=old.path)
    else:
        below = entries.get(key) or Node(None, place, joined(node.path, key), place)
        if new is None and below.value is None:
            return node
        entries[key] = _replaced(below, parts[1:], new, place)
    return replace(node, value=entries)


def _replaced_item(node: Node, items: list[Node], parts: list[str], new: Node | None, place: Place) -> list[Node]:
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
    elif new is None:
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
        other = above.get(key) if above is not None and key != chosen else None
        if other is not None and own.isdisjoint({other.key_place, *(part.place for part in other.walk())}):
            root = _replaced(root, [parent, key], None, other.place)
    return root
