"""The structure of design files: the keys that a design may have, as data, and a check for keys that do not fit."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import SequenceMatcher
from typing import Any, Literal

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import parse_plane
from slopekit.core.synonyms import TANGENTS, folded, is_likely, nearest, synonym
from slopekit.design.reading.nodes import Node, NodeCache, joined

OrientationKind = Literal["plane", "line"]
#: The angles of a plane and of a line: the steep one, then the direction.
ANGLES: Mapping[OrientationKind, tuple[str, str]] = {
    "plane": ("dip", "dip_direction"),
    "line": ("plunge", "trend"),
}
#: The angles of a plane and of a line in the order in which they are written with a slash.
WRITTEN_ANGLES: Mapping[OrientationKind, tuple[str, str]] = {
    "plane": ("dip", "dip_direction"),
    "line": ("trend", "plunge"),
}
_ORIENTATIONS: Mapping[str, OrientationKind] = {
    "plane": "plane",
    "face": "plane",
    "upper": "plane",
    "toward": "line",
}
_SHOWN_KEYS = 12
_RARE_GROUPS = ("analysis", "cases")  # of the groups at the top
MOST_FAULTS = (
    200  # of one design: nobody reads more, and the search for a likely cause of each takes time
)


@dataclass(frozen=True)
class Spec:
    """The forms allowed at a key: a value, a group of keys, entries under users' names, a list; any that are set.

    Attributes
    ----------
    value : kind of scalar; a number may be a distribution, an orientation a distribution or a pair of numbers
    keys, required : the keys of a group, and those of them that are required
    names : specification of the value under each name (`weak: ...`)
    pairs : whether names such as B1/B2 and J1.phi/J2.phi are allowed
    items : specification of the entries of a list
    at_least, at_most : bounds of the number of names or entries; equal bounds fix the length of a list
    is_anything : a value of any shape, which is checked later at the path that it is written to
    example : for messages
    """

    value: Literal["", "value", "number", "orientation"] = ""
    keys: Mapping[str, "Spec"] = field(default_factory=dict)
    required: tuple[str, ...] = ()
    names: "Spec | None" = None
    pairs: bool = False
    items: "Spec | None" = None
    at_least: int = 0
    at_most: int | None = None
    is_anything: bool = False
    example: str = ""

    def may_scatter(self) -> bool:
        """Return whether a distribution is allowed."""
        return self.value in ("number", "orientation")

    def may_be_empty(self) -> bool:
        """Return whether a key without a value is allowed, with the meaning of no entries."""
        lists = self.names is not None or self.items is not None
        return (
            self.is_anything
            or (bool(self.keys) and not self.required)
            or (lists and not self.at_least)
        )

    def in_words(self) -> str:
        """Return the allowed forms in words, for messages."""
        keys = list(self.keys)
        words = [_VALUES[self.value]] if self.value or self.is_anything else []
        words += ["a list"] if self.items is not None else []
        words += ["a group of names"] if self.names is not None else []
        words += [_keys_text(keys)] if keys else []
        return " or ".join(words)


_VALUES = {"": "a value", "value": "a value", "number": "a number", "orientation": "an orientation"}
VALUE = Spec("value")


def either(*specs: Spec) -> Spec:
    """Return the specification that allows any of several forms."""
    attributes: dict[str, Any] = {}
    for spec in specs:
        attributes |= {
            name: value for name, value in vars(spec).items() if value and name not in attributes
        }
    return Spec(**attributes)


def check_structure(
    root: Node, spec: Spec, kind: str, other_specs: Callable[[], Mapping[str, Spec]] = dict
) -> list[Fault]:
    """Return the faults of the keys of a design: unknown, missing, or with a value of the wrong form.

    Parameters
    ----------
    root : the whole design
    spec : the specification of a design of this kind
    kind : the name of the kind, for the messages
    other_specs : returns the specifications of the other kinds, to say where an unknown key belongs

    Returns
    -------
    list of Fault
        E142 unknown key, E143 missing key, E144 wrong form or no value, E146 invalid name, E109 a list too short or
        too long; E149 last, where there are more than MOST_FAULTS.

    >>> from slopekit.design.reading.nodes import document_from
    >>> spec = Spec(keys={"height": Spec("number", example="64.89 m")}, required=("height",))
    >>> print(*check_structure(document_from({"hieght": 5}).root, spec, "wedge"), sep="\\n")
    E142 hieght is not a key of a wedge design
         design: hieght = 5
         Did you mean height?
    """
    checker = _Checker(spec, kind, other_specs)
    checker.check(root, spec)
    faults = list(dict.fromkeys(checker.faults))
    if len(checker.faults) >= MOST_FAULTS:
        message = f"there are {MOST_FAULTS} faults: what stands behind them was not looked at"
        faults.append(Fault("E149", message, str(root.place), "Is this a design file?"))
    return faults


def is_distribution(node: Node) -> bool:
    """Return whether the value is a distribution: a mapping with the key `dist`."""
    return bool(node.get("dist"))


def orientation_kind(node: Node) -> OrientationKind | None:
    """Return whether an orientation (or the mean of its distribution) is a plane or a line; None: no orientation."""
    return _ORIENTATIONS.get(node.path.removesuffix(".mean").rpartition(".")[2])


def has_angles(node: Node) -> bool:
    """Return whether an orientation is written by its two angles: `{dip: 45, dip_direction: 115}`."""
    kind = orientation_kind(node)
    return (
        kind is not None
        and not is_distribution(node)
        and any(node.get(angle) for angle in ANGLES[kind])
    )


#: Entries of lists that were found to have the required form, with their specification.
_SOUND_ENTRIES: NodeCache[Spec] = NodeCache()


class _Checker:
    def __init__(
        self, spec: Spec, kind: str, other_specs: Callable[[], Mapping[str, Spec]]
    ) -> None:
        self.spec, self.kind, self.other_specs = spec, kind, other_specs
        self.faults: list[Fault] = []
        self.places: dict[str, list[str]] = {}

    def places_of(self) -> Mapping[str, list[str]]:
        """Return the paths of the groups that have each known key; built once, when a key is unknown."""
        if not self.places:
            for key, path in _walk(self.spec):
                paths = self.places.setdefault(key, [])
                if path not in paths:
                    paths.append(path)
            for (
                paths
            ) in self.places.values():  # paths of the slope itself before rarely used groups
                paths.sort(
                    key=lambda path: (
                        path.partition(".")[0] in _RARE_GROUPS,
                        path.count(".") - path.count(".<"),
                    )
                )
        return self.places

    def fault(self, code: str, message: str, node: Node, advice: str = "") -> None:
        self.faults.append(Fault(code, message, str(node.key_place), advice))

    def check(self, node: Node, spec: Spec) -> None:
        if len(self.faults) >= MOST_FAULTS:
            return
        if spec.is_anything:
            return
        if node.value is None:
            if not spec.may_be_empty():
                message = f"{node.path or 'the design'} is empty, {spec.in_words()} is needed"
                self.fault("E144", message, node, _example(node, spec))
        elif not _fits(node, spec):
            self.wrong_shape(node, spec)
        elif isinstance(node.value, list):
            self.check_list(node, spec)
        elif node.is_mapping and not (spec.may_scatter() and is_distribution(node)):
            has_keys = spec.keys and any(node.get(key) for key in spec.required)
            if spec.names is not None and not has_keys:
                self.check_names(node, spec, spec.names)
            else:
                self.check_section(node, spec)

    def check_section(self, node: Node, spec: Spec) -> None:
        holder = f"of {node.path}" if node.path else f"of a {self.kind} design"
        remedies = set()
        keys = spec.keys
        for key, below in node.items():
            if key in keys:
                self.check(below, keys[key])
                continue
            if len(self.faults) >= MOST_FAULTS:
                return
            remedy = self.remedy(key, below, node, spec)
            remedies.add(remedy)
            self.fault("E142", f"{key} is not a key {holder}", below, remedy)
        for key in spec.required:
            path = f"{node.path}.{key}" if node.path else key
            is_misplaced = any(
                remedy.endswith((f"mean {key}?", f"under {path}.")) for remedy in remedies
            )
            if not node.get(key) and not is_misplaced:
                example = keys[key].example
                self.fault(
                    "E143", f"{path} is missing", node, f"Add {key}: {example}" if example else ""
                )

    def check_names(self, node: Node, spec: Spec, below_name: Spec) -> None:
        nameless = nameless_keys(node, below_name)
        if nameless:
            message = f"{node.path} has {' and '.join(nameless)} of no name"
            values = ", ".join(f"{key}: {value}" for key, value in nameless.items())
            self.fault("E144", message, node, f"Write {node.path}: {{joint: {{{values}}}}}")
        for name, below in node.items():
            if name in nameless:
                continue
            if not name.strip() or (not spec.pairs and re.search(r"[./]", name)):
                advice = "Dots and slashes join names elsewhere (J1.phi/J2.phi): use letters, digits, - and _."
                self.fault("E146", f"{name!r} under {node.path} cannot be a name", below, advice)
            self.check(below, below_name)
        if len(node.items()) < spec.at_least:
            message = f"{node.path} has {_entries_text(len(node.items()))}, at least {spec.at_least} needed"
            self.fault("E109", message, node, _example(node, spec))

    def check_list(self, node: Node, spec: Spec) -> None:
        item = spec.items
        if item is None:
            return  # the two angles of an orientation
        for below in node.elements:
            if _SOUND_ENTRIES.get(below) is item:
                continue
            faults_before = len(self.faults)
            self.check(below, item)
            if len(self.faults) == faults_before:
                _SOUND_ENTRIES.store(below, item)
        count, least, most = len(node.elements), spec.at_least, spec.at_most
        if count < least or (most is not None and count > most):
            needed = (
                f"{least}"
                if least == most
                else f"at least {least}"
                if count < least
                else f"at most {most}"
            )
            self.fault(
                "E109",
                f"{node.path} has {_entries_text(count)}, {needed} needed",
                node,
                _example(node, spec),
            )

    # -- messages -----------------------------------------------------------------------------------------------------

    def wrong_shape(self, node: Node, spec: Spec) -> None:
        meant = spec.may_scatter() and node.is_mapping
        advice = (
            _distribution_advice(node, spec.value == "number") if meant else _example(node, spec)
        )
        message = f"{node.path or 'the design'} is {_shape_text(node)}, {spec.in_words()} is needed"
        self.faults.append(Fault("E144", message, str(node.place), advice))

    def remedy(self, key: str, node: Node, above: Node, spec: Spec) -> str:
        """Return the advice for an unknown key, from its most likely cause."""
        name, colon, value = key.partition(":")
        keys = spec.keys
        if colon and node.value is None and name.strip() in keys:
            return f"Put a space behind the colon: {name.strip()}: {value.strip()}"
        for group_key, below in keys.items():
            meant = key if key in below.keys else synonym(key, below.keys)
            if above.path and meant is not None:
                return f"{meant} belongs under {above.path}.{group_key}."
        places = [path for path in self.places_of().get(key, ()) if path != above.path]
        close_keys = nearest(key, keys, cutoff=0.65)
        sure = bool(close_keys) and (
            is_likely(key, close_keys[0])
            or SequenceMatcher(None, folded(key), close_keys[0]).ratio() > 0.8
        )
        is_number = node.text is not None and re.fullmatch(r"\d*\.?\d+", node.text) is not None
        if is_number and close_keys == ["rules"]:
            return f'Write rules: "fos >= {node.text}"'
        if is_number and close_keys == ["phi"] and folded(key) in TANGENTS:
            return f"Write phi: {math.degrees(math.atan(float(node.text or 0))):.4g}"
        if (
            places and not sure and not (close_keys and len(key) == 1)
        ):  # a single letter is more likely a typing error than a law's a or b
            return (
                f"{key} belongs under {' or '.join(places[:3])}."
                if all(places)
                else f"{key} belongs at the top."
            )
        # only here the other kinds are imported
        if not (above.path or sure) and (
            kinds := [
                kind for kind, other_spec in self.other_specs().items() if key in other_spec.keys
            ]
        ):
            return f"{key} is a key of kind: {' and of kind: '.join(kinds)}."
        if close_keys:
            return f"Did you mean {close_keys[0]}?"
        elsewhere = nearest(key, list(self.places_of()), cutoff=0.75)
        if elsewhere:
            group_path = self.places_of()[elsewhere[0]][0]
            return f"Did you mean {elsewhere[0]}, {f'under {group_path}' if group_path else 'at the top'}?"
        known_keys = ", ".join(list(keys)[:_SHOWN_KEYS]) + (
            ", …" if len(keys) > _SHOWN_KEYS else ""
        )
        return f"Known here: {known_keys}."


def _fits(node: Node, spec: Spec) -> bool:
    """Return whether a value has a form that the specification allows, without checking its keys and entries."""
    if node.text is not None:
        return spec.value != ""
    if isinstance(node.value, list):
        is_pair = len(node.value) == 2 and all(entry.text is not None for entry in node.value)
        return spec.items is not None or (spec.value == "orientation" and is_pair)
    if is_distribution(node) and spec.may_scatter():
        return True
    if (
        spec.value == "orientation"
    ):  # keys of which none is an angle's are a distribution gone wrong
        return any(key in spec.keys for key, _ in node.items())
    return bool(spec.keys) or spec.names is not None


def _shape_text(node: Node) -> str:
    if node.text is not None:
        return (
            f"the text {node.text!r}" if len(node.text) <= 40 else f"the text {node.text[:39]!r}…"
        )
    if isinstance(node.value, list):
        return f"a list of {len(node.value)}"
    return _keys_text([key for key, _ in node.items()])


def _keys_text(keys: Sequence[str]) -> str:
    return f"a group of keys ({', '.join(keys[:4])}{', …' if len(keys) > 4 else ''})"


def _example(node: Node, spec: Spec) -> str:
    key_text = "" if re.fullmatch(r"\d*", node.name) else f"{node.name}: "
    rewritten = _rewritten(node, spec)
    return f"Write {key_text}{rewritten or spec.example}" if rewritten or spec.example else ""


def _rewritten(node: Node, spec: Spec) -> str:
    """Return the user's value in the required form, such as `{plane: 45/245}` for 45/245; empty if impossible."""
    if spec.names is not None:
        texts = [entry.text or "" for entry in node.elements] or (node.text or "").split()
        rewritten_entries = [_rewritten(replace(node, value=text), spec.names) for text in texts]
        is_pair = node.elements and len(rewritten_entries) == 2 and not all(rewritten_entries)
        return (
            ""
            if is_pair or not rewritten_entries or not all(rewritten_entries)
            else (
                "{"
                + ", ".join(
                    f"J{number}: {entry}" for number, entry in enumerate(rewritten_entries, 1)
                )
                + "}"
            )
        )
    keys = spec.keys
    if len(keys) == 1 and (node.text is not None or node.elements):
        texts = (
            [node.text] if node.text is not None else [entry.text or "" for entry in node.elements]
        )
        listed = ", ".join(f'"{text}"' for text in texts)
        return f"{{{next(iter(keys))}: [{listed}]}}" if all(texts) else ""
    planes = [key for key, below in keys.items() if below.value == "orientation"]
    if not planes or [key for key in spec.required if key not in planes]:
        return ""
    text = (
        node.text
        if node.text is not None
        else "/".join(entry.text or "" for entry in node.elements)
    )
    try:
        parse_plane(text, planes[0])
    except DesignError:
        return ""
    return f"{{{planes[0]}: {text}}}"


def _distribution_advice(node: Node, is_number: bool) -> str:
    """Return the advice how to write a distribution, with the user's mean and standard deviation if given."""
    example = (
        "{dist: normal, mean: 20, sd: 2}" if is_number else "{dist: fisher, mean: 45/115, k: 100}"
    )
    meant = {
        key: next(iter(nearest(key, ("dist", "mean", "sd", "min", "max", "mode"))), "")
        for key, _ in node.items()
    }
    values = {meant[key] or key: below.text for key, below in node.items()}
    if is_number and values.keys() == {"mean", "sd"} and all(values.values()):
        example = f"{{dist: normal, mean: {values['mean']}, sd: {values['sd']}}}"
    wrong = next((key for key, name in meant.items() if name == "dist"), None)
    return f"{f'Write dist: instead of {wrong}:. ' if wrong else ''}A distribution is written {example}."


def nameless_keys(node: Node, spec: Spec) -> dict[str, str]:
    """Return the keys (with values) written in place of a name, as in `strength: {c: 50, phi: 20}`."""
    keys = spec.keys
    return {
        key: below.text
        for key, below in node.items()
        if below.text is not None and (key in keys or synonym(key, keys) is not None)
    }


def _entries_text(number: int) -> str:
    return f"{number} entry" if number == 1 else f"{number or 'no'} entries"


def _walk(spec: Spec, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield every known key with the path of its group; users' names as <name>."""
    for key, below in spec.keys.items():
        yield key, path
        yield from _walk(below, joined(path, key))
    if spec.names is not None:
        yield from _walk(spec.names, f"{path}.<name>")
    if spec.items is not None:
        yield from _walk(spec.items, path)


def expand_short_form(node: Node, path: str = "") -> Node:
    """Return a value in short form as a group of keys: `water: dry`, `seismic: 0.1@180`, `200 kN@000/10,passive`.

    Parameters
    ----------
    path : the path in a design that decides about the short form, if it is not the node's own (values of a call)

    >>> from slopekit.design.reading.nodes import document_from
    >>> expand_short_form(document_from({"water": "50 %"}).root.get("water")).plain()
    {'fill': '50 %'}
    """
    entries = _short_form_entries(path or node.path, node.text or "")
    if not entries:
        return node
    return replace(
        node,
        value={
            key: _node_of_text(value, joined(node.path, key), node)
            for key, value in entries.items()
        },
    )


#: The key of the distance in the short form of a plane with its position, 80/180@5m.
_DISTANCES = {"crack": "distance", "basal": "height"}


def _short_form_entries(path: str, text: str) -> Mapping[str, str | list[str]]:
    first, at_sign, second = (word.strip() for word in text.partition("@"))
    holder, _, last = path.rpartition(".")
    if path == "water" and text.lower().startswith("u="):
        return {"pressures": re.split(r"\s*,\s*", text[2:].strip())}
    if path == "water" and text:
        return {"mode" if text.strip().lower() in ("dry", "full") else "fill": text}
    if path in _DISTANCES and at_sign:
        return {"plane": first, _DISTANCES[path]: second}
    if path == "loads.seismic" and text:
        return {"k": first, "toward": second} if at_sign else {"k": first}
    if holder == "loads.forces" and last.isdigit() and at_sign:
        return {"force": first, "toward": second}
    if holder == "support.bolts" and last.isdigit() and at_sign:
        toward, comma, acts = (word.strip() for word in second.partition(","))
        return {"force": first, "toward": toward} | ({"acts": acts} if comma else {})
    return {}


def _node_of_text(value: str | list[str], path: str, node: Node) -> Node:
    if isinstance(value, str):
        return Node(value, node.place, path, node.key_place)
    entries = [_node_of_text(entry, joined(path, str(k)), node) for k, entry in enumerate(value)]
    return Node(entries, node.place, path, node.key_place)
