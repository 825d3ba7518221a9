"""Which keys a design may have, said once as data, and a checker that finds every key that does not fit."""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from typing import Any, Literal, TypeAlias

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import parse_plane
from slopekit.core.synonyms import TANGENTS, folded, is_likely, nearest, synonym
from slopekit.design.reading.nodes import Kept, Node, joined

Spec: TypeAlias = "Leaf | KeyGroup | Named | ListOf | AnyOf | Anything"
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
class Leaf:
    """One value. A number may be a distribution; an orientation also a pair of numbers; `example` is for messages."""

    number: bool = False
    orientation: bool = False
    example: str = ""


@dataclass(frozen=True)
class KeyGroup:
    """Known keys, some of them required."""

    keys: Mapping[str, Spec]
    required: tuple[str, ...] = ()
    example: str = ""


@dataclass(frozen=True)
class Named:
    """Things under names of the user's choice (`weak: ...`); `pairs` allows names such as B1/B2 and J1.phi/J2.phi."""

    of: Spec
    at_least: int = 0
    pairs: bool = False
    example: str = ""


@dataclass(frozen=True)
class ListOf:
    """A list of like things; equal bounds fix its length."""

    of: Spec
    at_least: int = 0
    at_most: int | None = None
    example: str = ""


@dataclass(frozen=True)
class AnyOf:
    """One of several: the first that fits the value best."""

    of: tuple[Spec, ...]
    example: str = ""


class Anything:
    """A value of any shape: it is looked at where it will stand."""

    example = ""


def check_structure(
    root: Node, spec: KeyGroup, kind: str, others: Callable[[], Mapping[str, KeyGroup]] = dict
) -> list[Fault]:
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
    >>> spec = KeyGroup({"height": Leaf(number=True, example="64.89 m")}, required=("height",))
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
    return node.get("dist") is not None


def orientation_kind(node: Node) -> OrientationKind | None:
    """What an orientation of a design is one of, by its key; None for a key of anything else."""
    return _ORIENTATIONS.get(node.name)


def has_angles(node: Node) -> bool:
    """Whether an orientation is written by its two angles: `{dip: 45, dip_direction: 115}`."""
    kind = orientation_kind(node)
    return kind is not None and not is_distribution(node) and any(node.get(angle) is not None for angle in ANGLES[kind])


#: Items of lists that were found to have the shape that they need, with that shape.
_SOUND: Kept[Any] = Kept()


class _Checker:
    def __init__(self, spec: KeyGroup, kind: str, others: Callable[[], Mapping[str, KeyGroup]]) -> None:
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
        if isinstance(spec, AnyOf):
            self.any_of(node, spec)
        elif node.value is None and (isinstance(spec, Leaf) or not _may_be_empty(spec)):
            self.empty(node, spec)
        elif node.value is not None and not _fits(node, spec):
            self.wrong_shape(node, spec)
        elif isinstance(spec, KeyGroup):
            self.section(node, spec)
        elif isinstance(spec, Named):
            self.named(node, spec)
        elif isinstance(spec, ListOf):
            self.list_of(node, spec)

    def section(self, node: Node, spec: KeyGroup) -> None:
        holder = f"of {node.path}" if node.path else f"of a {self.kind} design"
        remedies = set()
        for key, below in node.items():
            if key in spec.keys:
                self.check(below, spec.keys[key])
                continue
            if len(self.faults) >= MOST_FAULTS:
                return
            remedy = self.remedy(key, below, node, spec)
            remedies.add(remedy)
            self.fault("E142", f"{key} is not a key {holder}", below, remedy)
        for key in spec.required:
            path = f"{node.path}.{key}" if node.path else key
            is_misplaced = any(remedy.endswith((f"mean {key}?", f"under {path}.")) for remedy in remedies)
            if node.get(key) is None and not is_misplaced:
                example = spec.keys[key].example
                self.fault("E143", f"{path} is missing", node, f"Add {key}: {example}" if example else "")

    def named(self, node: Node, spec: Named) -> None:
        nameless = without_name(node, spec.of)
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
            self.check(below, spec.of)
        if len(node.items()) < spec.at_least:
            message = f"{node.path} has {_count(len(node.items()))}, at least {spec.at_least} needed"
            self.fault("E109", message, node, _example(node, spec))

    def list_of(self, node: Node, spec: ListOf) -> None:
        for below in node.elements:
            if _SOUND.of(below) is spec.of:
                continue
            before = len(self.faults)
            self.check(below, spec.of)
            if len(self.faults) == before:
                _SOUND.keep(below, spec.of)
        given, least, most = len(node.elements), spec.at_least, spec.at_most
        if given < least or (most is not None and given > most):
            needed = f"{least}" if least == most else f"at least {least}" if given < least else f"at most {most}"
            self.fault("E109", f"{node.path} has {_count(given)}, {needed} needed", node, _example(node, spec))

    def any_of(self, node: Node, spec: AnyOf) -> None:
        fitting = [one for one in spec.of if _fits(node, one)] if node.value is not None else []
        if node.is_mapping and not is_distribution(node) and any(_is_orientation(one) for one in spec.of):
            # keys of which none is an angle's are a distribution gone wrong
            fitting = [
                one for one in fitting if isinstance(one, KeyGroup) and {key for key, _ in node.items()} & set(one.keys)
            ]
        if not fitting:
            if node.value is not None:
                self.wrong_shape(node, spec)
            elif not any(_may_be_empty(one) for one in spec.of):
                self.empty(node, spec)
            return
        best: list[Fault] | None = None
        for one in fitting:
            trial = _Checker(self.spec, self.kind, self.others)
            trial.check(node, one)
            if not trial.faults:
                return
            if best is None or len(trial.faults) < len(best):
                best = trial.faults
        self.faults += best or []

    # -- messages -----------------------------------------------------------------------------------------------------

    def empty(self, node: Node, spec: Spec) -> None:
        needed = _needed(spec)
        self.fault("E144", f"{node.path or 'the design'} is empty, {needed} is needed", node, _example(node, spec))

    def wrong_shape(self, node: Node, spec: Spec) -> None:
        advice = _example(node, spec)
        number = isinstance(spec, Leaf) and spec.number
        orientation = isinstance(spec, AnyOf) and any(_is_orientation(one) for one in spec.of)
        if (number or orientation) and node.is_mapping:
            advice = _of_distribution(node, number)
        message = f"{node.path or 'the design'} is {_given(node)}, {_needed(spec)} is needed"
        self.faults.append(Fault("E144", message, str(node.place), advice))

    def remedy(self, key: str, node: Node, above: Node, spec: KeyGroup) -> str:
        """What to type instead of an unknown key: the likeliest slip."""
        name, colon, value = key.partition(":")
        if colon and node.value is None and name.strip() in spec.keys:
            return f"Put a space behind the colon: {name.strip()}: {value.strip()}"
        for known, below in spec.keys.items():
            inner = [arm for arm in (below.of if isinstance(below, AnyOf) else (below,)) if isinstance(arm, KeyGroup)]
            meant = next((key if key in arm.keys else synonym(key, arm.keys) for arm in inner), None)
            if above.path and meant is not None:
                return f"{meant} belongs under {above.path}.{known}."
        places = [path for path in self.places_of().get(key, ()) if path != above.path]
        near = nearest(key, spec.keys, cutoff=0.65)
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
        known = ", ".join(list(spec.keys)[:_SHOWN_KEYS]) + (", …" if len(spec.keys) > _SHOWN_KEYS else "")
        return f"Known here: {known}."


def _is_orientation(spec: Spec) -> bool:
    return isinstance(spec, Leaf) and spec.orientation


def _fits(node: Node, spec: Spec) -> bool:
    """Whether the value has the shape of the spec, its own keys and items not looked at."""
    if isinstance(spec, Anything):
        return True
    if isinstance(spec, AnyOf):
        return any(_fits(node, one) for one in spec.of)
    if isinstance(spec, Leaf):
        pair = len(node.elements) == 2 and all(part.text is not None for part in node.elements)
        is_special = (spec.number or spec.orientation) and is_distribution(node)
        return node.text is not None or is_special or (spec.orientation and pair)
    return isinstance(node.value, list) if isinstance(spec, ListOf) else node.is_mapping


def _may_be_empty(spec: Spec) -> bool:
    """Whether nothing behind the key says the same as no entries."""
    if isinstance(spec, Anything):
        return True
    if isinstance(spec, KeyGroup):
        return not spec.required
    if isinstance(spec, AnyOf):
        return any(_may_be_empty(one) for one in spec.of)
    return isinstance(spec, Named | ListOf) and not spec.at_least


def _given(node: Node) -> str:
    if node.text is not None:
        return f"the text {node.text!r}" if len(node.text) <= 40 else f"the text {node.text[:39]!r}…"
    if isinstance(node.value, list):
        return f"a list of {len(node.value)}"
    keys = [key for key, _ in node.items()]
    return f"a group of keys ({', '.join(keys[:4])}{', …' if len(keys) > 4 else ''})"


def _needed(spec: Spec) -> str:
    if isinstance(spec, AnyOf):
        return " or ".join(dict.fromkeys(_needed(one) for one in spec.of))
    if isinstance(spec, Anything):
        return "a value"
    if isinstance(spec, Leaf):
        return "a number" if spec.number else "an orientation" if spec.orientation else "a value"
    if isinstance(spec, KeyGroup):
        keys = list(spec.keys)
        return f"a group of keys ({', '.join(keys[:4])}{', …' if len(keys) > 4 else ''})"
    return "a list" if isinstance(spec, ListOf) else "a group of names"


def _example(node: Node, spec: Spec) -> str:
    own = "" if re.fullmatch(r"\d*", node.name) else f"{node.name}: "
    if isinstance(spec, AnyOf):
        spec = next((arm for arm in spec.of if _rewritten(node, arm)), spec)
    rewritten = _rewritten(node, spec)
    return f"Write {own}{rewritten or spec.example}" if rewritten or spec.example else ""


def _rewritten(node: Node, spec: Spec) -> str:
    """The user's value in the shape that is needed: `{plane: 45/245}` of a plane alone; empty where it does not fit."""
    if isinstance(spec, Named):
        texts = [part.text or "" for part in node.elements] or (node.text or "").split()
        parts = [_rewritten(replace(node, value=text), spec.of) for text in texts]
        is_pair = node.elements and len(parts) == 2 and not all(parts)
        return "" if is_pair or not parts or not all(parts) else (
            "{" + ", ".join(f"J{number}: {part}" for number, part in enumerate(parts, 1)) + "}"
        )  # fmt: skip
    if not isinstance(spec, KeyGroup):
        return ""
    if len(spec.keys) == 1 and (node.text is not None or node.elements):
        texts = [node.text] if node.text is not None else [part.text or "" for part in node.elements]
        listed = ", ".join(f'"{text}"' for text in texts)
        return f"{{{next(iter(spec.keys))}: [{listed}]}}" if all(texts) else ""
    planes = [
        key for key, below in spec.keys.items() if isinstance(below, AnyOf) and any(map(_is_orientation, below.of))
    ]
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
    if not isinstance(spec, KeyGroup):
        return {}
    return {key: below.text for key, below in node.items() if below.text is not None and (
        key in spec.keys or synonym(key, spec.keys) is not None
    )}  # fmt: skip


def _count(number: int) -> str:
    return f"{number} entry" if number == 1 else f"{number or 'no'} entries"


def _walk(spec: Spec, path: str = "") -> Iterator[tuple[str, str]]:
    """Every known key with the path it stands under; free names as <name>."""
    if isinstance(spec, KeyGroup):
        for key, below in spec.keys.items():
            yield key, path
            yield from _walk(below, f"{path}.{key}" if path else key)
    elif isinstance(spec, Named):
        yield from _walk(spec.of, f"{path}.<name>")
    elif isinstance(spec, ListOf):
        yield from _walk(spec.of, path)
    elif isinstance(spec, AnyOf):
        for one in spec.of:
            yield from _walk(one, path)


def spread(node: Node) -> Node:
    """What a value in short stands for, with its keys: `water: dry`, `seismic: 0.1@180`, `200 kN@000/10,passive`.

    >>> from slopekit.design.reading.nodes import document_from
    >>> spread(document_from({"water": "50 %"}).root.get("water")).plain()
    {'fill': '50 %'}
    """
    entries = _in_full(node.path, node.text or "")
    if not entries:
        return node
    return replace(node, value={key: _made(value, joined(node.path, key), node) for key, value in entries.items()})


def _in_full(path: str, text: str) -> Mapping[str, str | list[str]]:
    first, at, second = (part.strip() for part in text.partition("@"))
    holder, _, last = path.rpartition(".")
    if path == "water" and text.lower().startswith("u="):
        return {"pressures": re.split(r"\s*,\s*", text[2:].strip())}
    if path == "water" and text:
        return {"mode" if text.strip().lower() in ("dry", "full") else "fill": text}
    if path == "loads.seismic" and text:
        return {"k": first, "toward": second} if at else {"k": first}
    if holder in ("support.bolts", "loads.forces") and last.isdigit() and at:
        toward, comma, acts = (part.strip() for part in second.partition(","))
        return {"force": first, "toward": toward} | ({"acts": acts} if comma else {})
    return {}


def _made(value: str | list[str], path: str, node: Node) -> Node:
    if isinstance(value, str):
        return Node(value, node.place, path, node.key_place)
    parts = [_made(part, joined(path, str(k)), node) for k, part in enumerate(value)]
    return Node(parts, node.place, path, node.key_place)
