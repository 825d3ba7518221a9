"""Synonyms of keys (`cohesion`, `friction_angle`, `gamma`) become the keys they stand for, before anything is read."""

from dataclasses import replace

from slopekit.core.errors import Fault
from slopekit.core.synonyms import SYNONYMS, folded, synonym
from slopekit.design.fields import structure_of
from slopekit.design.reading.nodes import Node, joined
from slopekit.design.reading.structure import AnyOf, KeyGroup, ListOf, Named, Spec
from slopekit.design.registry import KINDS, record_of


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
    specs: list[Spec] = [] if spec is None else [spec]
    for place, part in enumerate(parts):
        groups = [arm for spec in specs for arm in _arms(spec)]
        known = {key for group in groups if isinstance(group, KeyGroup) for key in group.keys}
        is_free = any(isinstance(group, Named | ListOf) for group in groups) and part not in known
        parts[place] = part if is_free else synonym(part, known) or part
        specs = [below for group in groups for below in _below(group, parts[place])]
    return ".".join(parts)


def _structure(root: Node) -> KeyGroup | None:
    """The keys that a design of its kind may have; None where it names no kind."""
    kind = root.get("kind")
    if kind is None or kind.text is None or kind.text not in KINDS:
        return None
    record = record_of(kind.text)
    return structure_of(record, record.REQUIRED)


def _has_synonyms(node: Node) -> bool:
    """Whether any key could be a synonym: most designs have none, and are left as they are."""
    waiting, keys = [node], set[str]()
    while waiting:
        value = waiting.pop().value
        if isinstance(value, dict):
            keys.update(value)
            waiting += [below for below in value.values() if not isinstance(below.value, str)]
        elif isinstance(value, list):
            waiting += [below for below in value if not isinstance(below.value, str)]
    return any("/" in key or folded(key.rpartition(".")[2]) in SYNONYMS for key in keys)


def _canonical(node: Node, spec: Spec, root: Node, path: str, faults: list[Fault]) -> Node:
    """A value with canonical keys, at its canonical path."""
    node = node if node.path == path else replace(node, path=path)
    for arm in _arms(spec):
        if isinstance(arm, KeyGroup) and isinstance(node.value, dict):
            node = _with_keys(node, arm, root, faults)
        elif isinstance(arm, Named) and isinstance(node.value, dict):
            node = _with_names(node, arm, root, faults)
        elif isinstance(arm, ListOf) and isinstance(node.value, list):
            parts = [
                _canonical(part, arm.of, root, joined(path, str(place)), faults)
                for place, part in enumerate(node.value)
            ]
            node = replace(node, value=parts)
    return node


def _with_keys(node: Node, group: KeyGroup, root: Node, faults: list[Fault]) -> Node:
    made: dict[str, Node] = {}
    for word, below in node.items():
        key = word if word in group.keys else synonym(word, group.keys) or word
        if key in made or (key != word and node.get(key) is not None):
            _refuse_second(node, key, word, below, faults)
        elif key in group.keys:
            made[key] = _canonical(below, group.keys[key], root, joined(node.path, key), faults)
        else:
            made[key] = below
    return replace(node, value=made)


def _with_names(node: Node, names: Named, root: Node, faults: list[Fault]) -> Node:
    made: dict[str, Node] = {}
    for word, below in node.items():
        name = word
        if node.path == "correlation":
            name = _of_strengths(word)
        elif node.name == "set" and node.path.startswith("cases."):
            name = canonical_path(root, word.strip())
        if name in made:
            _refuse_second(node, name, word, below, faults)
        else:
            made[name] = _canonical(below, names.of, root, joined(node.path, name), faults)
    return replace(node, value=made)


def _refuse_second(node: Node, key: str, word: str, below: Node, faults: list[Fault]) -> None:
    message = f"{joined(node.path, key)} is given twice" + (f", here as {word}" if word != key else "")
    faults.append(Fault("E151", message, str(below.key_place), "Leave one of them out."))


def _of_strengths(names: str) -> str:
    """Names of a correlation with the keys of strengths at their ends: `weak.cohesion/weak.friction`."""
    made = []
    for name in names.split("/"):
        above, dot, last = name.strip().rpartition(".")
        made.append(
            f"{above}{dot}{synonym(last, ('c', 'phi', 'tension', 'dilation', 'unit_weight', 'density')) or last}"
        )
    return "/".join(made)


def _arms(spec: Spec) -> list[Spec]:
    return [arm for part in spec.of for arm in _arms(part)] if isinstance(spec, AnyOf) else [spec]


def _below(group: Spec, part: str) -> list[Spec]:
    if isinstance(group, KeyGroup):
        return [group.keys[part]] if part in group.keys else []
    if isinstance(group, ListOf):
        return [group.of] if part.isdigit() else []
    return [group.of] if isinstance(group, Named) else []
