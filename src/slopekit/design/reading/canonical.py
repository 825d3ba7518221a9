"""Synonyms of keys (`cohesion`, `friction_angle`, `gamma`) become the keys they stand for, before anything is read."""

from dataclasses import replace

from slopekit.core.errors import Fault
from slopekit.core.synonyms import SYNONYMS, folded, synonym
from slopekit.design.fields import record_spec
from slopekit.design.reading.nodes import Node, joined
from slopekit.design.reading.structure import Spec
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
    for place, part in enumerate(parts):
        if spec is None:
            break
        keys = spec.known_keys()
        if part not in keys and spec.names is None and spec.items is None:
            parts[place] = synonym(part, keys) or part
        spec = keys.get(parts[place]) or spec.names or (spec.items if part.isdigit() else None)
    return ".".join(parts)


def _structure(root: Node) -> Spec | None:
    """The keys that a design of its kind may have; None where it names no kind."""
    kind = root.get("kind")
    if kind is None or kind.text is None or kind.text not in KINDS:
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
        inner = spec.known_keys().get(key) or spec.names
        if key in made or (key != word and node.get(key) is not None):
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
    return word if word in spec.known_keys() else synonym(word, spec.known_keys()) or word


def _of_strengths(names: str) -> str:
    """Names of a correlation with the keys of strengths at their ends: `weak.cohesion/weak.friction`."""
    made = []
    for name in names.split("/"):
        above, dot, last = name.strip().rpartition(".")
        made.append(
            f"{above}{dot}{synonym(last, ('c', 'phi', 'tension', 'dilation', 'unit_weight', 'density')) or last}"
        )
    return "/".join(made)
