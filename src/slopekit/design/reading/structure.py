"""Which keys a design may have, said once as data, and a checker that finds every key that does not fit."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import SequenceMatcher
from typing import Any, Literal

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import parse_plane
from slopekit.core.synonyms import TANGENTS, folded, is_likely, nearest, synonym
from slopekit.design.reading.nodes import Kept, Node, joined

OrientationKind = Literal["plane", "line"]
#: The angles of a plane and of a line: the steep one, then the direction.
ANGLES: Mapping[OrientationKind, tuple[str, str]] = {"plane": ("dip", "dip_direction"), "line": ("plunge", "trend")}
#: The same in the order in which they are written with a slash.
WRITTEN: Mapping[OrientationKind, tuple[str, str]] = {"plane": ("dip", "dip_direction"), "line": ("trend", "plunge")}
_ORIENTATIONS: Mapping[str, OrientationKind] = {"plane": "plane", "face": "plane", "upper": "plane", "toward": "line"}
_SHOWN_KEYS = 12
_SELDOM = ("analysis", "cases")  # of the groups at the top
MOST_FAULTS = 200  # that are said of one design: nobody reads more, and each is looked up for a likely slip


@dataclass(frozen=True)
class Spec:
    """What may stand at a key: one value, a group of keys, things under names of the user's, a list, as far as given.

    Attributes
    ----------
    value : of a scalar: a number may be a distribution, an orientation also a distribution or a pair of numbers
    keys, required : known keys, and those of them that have to be there
    names : what stands under each name (`weak: ...`); `pairs` allows names such as B1/B2 and J1.phi/J2.phi
    items : what stands in a list
    at_least, at_most : names or items; equal bounds fix the length of a list
    is_anything : a value of any shape, which is looked at where it will stand
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
        """Whether a distribution may stand there."""
        return self.value in ("number", "orientation")

    def may_be_empty(self) -> bool:
        """Whether nothing behind the key says the same as no entries."""
        lists = self.names is not None or self.items is not None
        return self.is_anything or (bool(self.keys) and not self.required) or (lists and not self.at_least)

    def in_words(self) -> str:
        """What is needed, for messages."""
        keys = list(self.keys)
        words = [_VALUES[self.value]] if self.value or self.is_anything else []
        words += ["a list"] if self.items is not None else []
        words += ["a group of names"] if self.names is not None else []
        words += [_listed(keys)] if keys else []
        return " or ".join(words)


_VALUES = {"": "a value", "value": "a value", "number": "a number", "orientation": "an orientation"}
VALUE = Spec("value")


def either(*specs: Spec) -> Spec:
    """One of several that differ in their shape."""
    parts: dict[str, Any] = {}
    for spec in specs:
        parts |= {name: part for name, part in vars(spec).items() if part and name not in parts}
    return Spec(**parts)


def check_structure(root: Node, spec: Spec, kind: str, others: Callable[[], Mapping[str, Spec]] = dict) -> list[Fault]:
    """Every key of a design that is unknown, missing or of the wrong shape.

    Parameters
    ----------
    root : the whole design
    spec : what a design of this kind may have
    kind : its name, for the messages
    others : makes the specs of the other kinds, to say where a key would belong

    Returns
    -------
    list of Fault
        E142 unknown key, E143 missing key, E144 wrong shape or nothing written, E146 a name that cannot be one,
        E109 a list that is too short or too long; E149 behind the last where there are too many to go on.

    >>> from slopekit.design.reading.nodes import document_from
    >>> spec = Spec(keys={"height": Spec("number", example="64.89 m")}, required=("height",))
    >>> print(*check_structure(document_from({"hieght": 5}).root, spec, "wedge"), sep="\\n")
    E142 hieght is not a key of a wedge design
         design: hieght = 5
         Did you mean height?
    """
    checker = _Checker(spec, kind, others)
    checker.check(root, spec)
    faults = list(dict.fromkeys(checker.faults))
    if len(checker.faults) >= MOST_FAULTS:
        message = f"there are {MOST_FAULTS} faults: what stands behind them was not looked at"
        faults.append(Fault("E149", message, str(root.place), "Is this a design file?"))
    return faults


def is_distribution(node: Node) -> bool:
    """Whether the value is a mapping that gives a distribution."""
    return bool(node.get("dist"))


def orientation_kind(node: Node) -> OrientationKind | None:
    """What an orientation of a design, or the mean of one that scatters, is one of, by its key; None: no such."""
    return _ORIENTATIONS.get(node.path.removesuffix(".mean").rpartition(".")[2])


def has_angles(node: Node) -> bool:
    """Whether an orientation is written by its two angles: `{dip: 45, dip_direction: 115}`."""
    kind = orientation_kind(node)
    return kind is not None and not is_distribution(node) and any(node.get(angle) for angle in ANGLES[kind])


#: Items of lists that were found to have the shape that they need, with that shape.
_SOUND: Kept[Spec] = Kept()


class _Checker:
    def __init__(self, spec: Spec, kind: str, others: Callable[[], Mapping[str, Spec]]) -> None:
        self.spec, self.kind, self.others = spec, kind, others
        self.faults: list[Fault] = []
        self.places: dict[str, list[str]] = {}

    def places_of(self) -> Mapping[str, list[str]]:
        """Every known key and the paths it stands under: made where a key is not known, once."""
        if not self.places:
            for key, path in _walk(self.spec):
                paths = self.places.setdefault(key, [])
                if path not in paths:
                    paths.append(path)
            for paths in self.places.values():  # the slope itself before what is rarely given
                paths.sort(key=lambda path: (path.partition(".")[0] in _SELDOM, path.count(".") - path.count(".<")))
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
                self.named(node, spec, spec.names)
            else:
                self.section(node, spec)

    def section(self, node: Node, spec: Spec) -> None:
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
            is_misplaced = any(remedy.endswith((f"mean {key}?", f"under {path}.")) for remedy in remedies)
            if not node.get(key) and not is_misplaced:
                example = keys[key].example
                self.fault("E143", f"{path} is missing", node, f"Add {key}: {example}" if example else "")

    def named(self, node: Node, spec: Spec, below_name: Spec) -> None:
        nameless = without_name(node, below_name)
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
            message = f"{node.path} has {_count(len(node.items()))}, at least {spec.at_least} needed"
            self.fault("E109", message, node, _example(node, spec))

    def check_list(self, node: Node, spec: Spec) -> None:
        item = spec.items
        if item is None:
            return  # the two angles of an orientation
        for below in node.elements:
            if _SOUND.of(below) is item:
                continue
            before = len(self.faults)
            self.check(below, item)
            if len(self.faults) == before:
                _SOUND.keep(below, item)
        given, least, most = len(node.elements), spec.at_least, spec.at_most
        if given < least or (most is not None and given > most):
            needed = f"{least}" if least == most else f"at least {least}" if given < least else f"at most {most}"
            self.fault("E109", f"{node.path} has {_count(given)}, {needed} needed", node, _example(node, spec))

    # -- messages -----------------------------------------------------------------------------------------------------

    def wrong_shape(self, node: Node, spec: Spec) -> None:
        meant = spec.may_scatter() and node.is_mapping
        advice = _of_distribution(node, spec.value == "number") if meant else _example(node, spec)
        message = f"{node.path or 'the design'} is {_given(node)}, {spec.in_words()} is needed"
        self.faults.append(Fault("E144", message, str(node.place), advice))

    def remedy(self, key: str, node: Node, above: Node, spec: Spec) -> str:
        """What to type instead of an unknown key: the likeliest slip."""
        name, colon, value = key.partition(":")
        keys = spec.keys
        if colon and node.value is None and name.strip() in keys:
            return f"Put a space behind the colon: {name.strip()}: {value.strip()}"
        for known, below in keys.items():
            meant = key if key in below.keys else synonym(key, below.keys)
            if above.path and meant is not None:
                return f"{meant} belongs under {above.path}.{known}."
        places = [path for path in self.places_of().get(key, ()) if path != above.path]
        near = nearest(key, keys, cutoff=0.65)
        sure = bool(near) and (is_likely(key, near[0]) or SequenceMatcher(None, folded(key), near[0]).ratio() > 0.8)
        is_number = node.text is not None and re.fullmatch(r"\d*\.?\d+", node.text) is not None
        if is_number and near == ["rules"]:
            return f'Write rules: "fos >= {node.text}"'
        if is_number and near == ["phi"] and folded(key) in TANGENTS:
            return f"Write phi: {math.degrees(math.atan(float(node.text or 0))):.4g}"
        if places and not sure and not (near and len(key) == 1):  # one letter is more likely a slip than a law's a or b
            return f"{key} belongs under {' or '.join(places[:3])}." if all(places) else f"{key} belongs at the top."
        # the other kinds are loaded only here
        if not (above.path or sure) and (kinds := [kind for kind, other in self.others().items() if key in other.keys]):
            return f"{key} is a key of kind: {' and of kind: '.join(kinds)}."
        if near:
            return f"Did you mean {near[0]}?"
        elsewhere = nearest(key, list(self.places_of()), cutoff=0.75)
        if elsewhere:
            where = self.places_of()[elsewhere[0]][0]
            return f"Did you mean {elsewhere[0]}, {f'under {where}' if where else 'at the top'}?"
        known = ", ".join(list(keys)[:_SHOWN_KEYS]) + (", …" if len(keys) > _SHOWN_KEYS else "")
        return f"Known here: {known}."


def _fits(node: Node, spec: Spec) -> bool:
    """Whether a value has the shape of the spec, its own keys and items not looked at."""
    if node.text is not None:
        return spec.value != ""
    if isinstance(node.value, list):
        is_pair = len(node.value) == 2 and all(part.text is not None for part in node.value)
        return spec.items is not None or (spec.value == "orientation" and is_pair)
    if is_distribution(node) and spec.may_scatter():
        return True
    if spec.value == "orientation":  # keys of which none is an angle's are a distribution gone wrong
        return any(key in spec.keys for key, _ in node.items())
    return bool(spec.keys) or spec.names is not None


def _given(node: Node) -> str:
    if node.text is not None:
        return f"the text {node.text!r}" if len(node.text) <= 40 else f"the text {node.text[:39]!r}…"
    if isinstance(node.value, list):
        return f"a list of {len(node.value)}"
    return _listed([key for key, _ in node.items()])


def _listed(keys: Sequence[str]) -> str:
    return f"a group of keys ({', '.join(keys[:4])}{', …' if len(keys) > 4 else ''})"


def _example(node: Node, spec: Spec) -> str:
    own = "" if re.fullmatch(r"\d*", node.name) else f"{node.name}: "
    rewritten = _rewritten(node, spec)
    return f"Write {own}{rewritten or spec.example}" if rewritten or spec.example else ""


def _rewritten(node: Node, spec: Spec) -> str:
    """The user's value in the shape that is needed: `{plane: 45/245}` of a plane alone; empty where it does not fit."""
    if spec.names is not None:
        texts = [part.text or "" for part in node.elements] or (node.text or "").split()
        parts = [_rewritten(replace(node, value=text), spec.names) for text in texts]
        is_pair = node.elements and len(parts) == 2 and not all(parts)
        return "" if is_pair or not parts or not all(parts) else (
            "{" + ", ".join(f"J{number}: {part}" for number, part in enumerate(parts, 1)) + "}"
        )  # fmt: skip
    keys = spec.keys
    if len(keys) == 1 and (node.text is not None or node.elements):
        texts = [node.text] if node.text is not None else [part.text or "" for part in node.elements]
        listed = ", ".join(f'"{text}"' for text in texts)
        return f"{{{next(iter(keys))}: [{listed}]}}" if all(texts) else ""
    planes = [key for key, below in keys.items() if below.value == "orientation"]
    if not planes or [key for key in spec.required if key not in planes]:
        return ""
    text = node.text if node.text is not None else "/".join(part.text or "" for part in node.elements)
    try:
        parse_plane(text, planes[0])
    except DesignError:
        return ""
    return f"{{{planes[0]}: {text}}}"


def _of_distribution(node: Node, is_number: bool) -> str:
    """How a distribution is written: with the user's mean and standard deviation where they are there."""
    example = "{dist: normal, mean: 20, sd: 2}" if is_number else "{dist: fisher, mean: 45/115, k: 100}"
    meant = {key: next(iter(nearest(key, ("dist", "mean", "sd", "min", "max", "mode"))), "") for key, _ in node.items()}
    values = {meant[key] or key: below.text for key, below in node.items()}
    if is_number and values.keys() == {"mean", "sd"} and all(values.values()):
        example = f"{{dist: normal, mean: {values['mean']}, sd: {values['sd']}}}"
    wrong = next((key for key, name in meant.items() if name == "dist"), None)
    return f"{f'Write dist: instead of {wrong}:. ' if wrong else ''}A distribution is written {example}."


def without_name(node: Node, spec: Spec) -> dict[str, str]:
    """The keys of a thing, with their values, that stand where its name should: `strength: {c: 50, phi: 20}`."""
    keys = spec.keys
    return {key: below.text for key, below in node.items() if below.text is not None and (
        key in keys or synonym(key, keys) is not None
    )}  # fmt: skip


def _count(number: int) -> str:
    return f"{number} entry" if number == 1 else f"{number or 'no'} entries"


def _walk(spec: Spec, path: str = "") -> Iterator[tuple[str, str]]:
    """Every known key with the path it stands under; free names as <name>."""
    for key, below in spec.keys.items():
        yield key, path
        yield from _walk(below, joined(path, key))
    if spec.names is not None:
        yield from _walk(spec.names, f"{path}.<name>")
    if spec.items is not None:
        yield from _walk(spec.items, path)


def spread(node: Node, path: str = "") -> Node:
    """What a value in short stands for, with its keys: `water: dry`, `seismic: 0.1@180`, `200 kN@000/10,passive`.

    Parameters
    ----------
    path : where it stands in a design, if not where the node does: a call has another

    >>> from slopekit.design.reading.nodes import document_from
    >>> spread(document_from({"water": "50 %"}).root.get("water")).plain()
    {'fill': '50 %'}
    """
    entries = _in_full(path or node.path, node.text or "")
    if not entries:
        return node
    return replace(node, value={key: _made(value, joined(node.path, key), node) for key, value in entries.items()})


#: Of planes that are written with their place, 80/180@5m: what it is.
_DISTANCES = {"crack": "distance", "basal": "height"}


def _in_full(path: str, text: str) -> Mapping[str, str | list[str]]:
    first, at, second = (part.strip() for part in text.partition("@"))
    holder, _, last = path.rpartition(".")
    if path == "water" and text.lower().startswith("u="):
        return {"pressures": re.split(r"\s*,\s*", text[2:].strip())}
    if path == "water" and text:
        return {"mode" if text.strip().lower() in ("dry", "full") else "fill": text}
    if path in _DISTANCES and at:
        return {"plane": first, _DISTANCES[path]: second}
    if path == "loads.seismic" and text:
        return {"k": first, "toward": second} if at else {"k": first}
    if holder == "loads.forces" and last.isdigit() and at:
        return {"force": first, "toward": second}
    if holder == "support.bolts" and last.isdigit() and at:
        toward, comma, acts = (part.strip() for part in second.partition(","))
        return {"force": first, "toward": toward} | ({"acts": acts} if comma else {})
    return {}


def _made(value: str | list[str], path: str, node: Node) -> Node:
    if isinstance(value, str):
        return Node(value, node.place, path, node.key_place)
    parts = [_made(part, joined(path, str(k)), node) for k, part in enumerate(value)]
    return Node(parts, node.place, path, node.key_place)
