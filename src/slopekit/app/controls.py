"""The controls of a design: every number, word and name that it has, with slider ends, as its fields declare them.

>>> from slopekit.design.reading.files import load
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> design = load(wedge)
>>> [group["name"] for group in groups_of(design, design)][:3]
['title', 'slope', 'joints']
>>> dip = groups_of(design, design)[2]["controls"][0]
>>> dip["path"], dip["value"], dip["unit"], dip["low"], dip["high"], dip["given"], dip["changed"]
('joints.J1.plane.dip', 45.0, '°', 0.0, 90.0, True, False)
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from slopekit.core.errors import DesignError
from slopekit.core.units import quantity, unit_of
from slopekit.design.common import Design
from slopekit.design.fields import Field, every_field, field_in, in_degrees, words_of
from slopekit.design.reading.document import ALTERNATIVES
from slopekit.design.reading.nodes import Document, Node
from slopekit.design.reading.structure import WRITTEN, orientation_kind, spread
from slopekit.design.scatter.distributions import Distribution, Fisher
from slopekit.studies.keys import Key, keys_of

Control = dict[str, Any]

#: The sections of a design in the order of its file; others come after them as the fields have them.
_ORDER = (
    "title", "slope", "columns", "footing", "weak_plane", "slip", "section", "blocks", "joints", "sets", "crack",
    "basal", "interfaces", "strength", "rock", "water", "loads", "support", "limits", "cut", "analysis",
)  # fmt: skip
#: What sliders reach to from nothing, by what a number measures.
_USUAL: Mapping[str, float] = {
    "length": 20.0, "volume": 10.0, "pressure": 200.0, "force": 1000.0, "angle": 60.0, "acceleration": 20.0,
    "ratio": 1.0, "stiffness": 1e8, "density": 3500.0, "unit weight": 35.0,
}  # fmt: skip
_LEAST_USUAL: Mapping[str, float] = {"density": 1500.0, "unit weight": 5.0}
_TIMES = 3.0  # how far beyond what it is now a slider reaches
_DECADES = 100.0  # the same of a number that goes by its logarithm
_LOGARITHMIC = ("stiffness",)
_OF_LOGARITHMS = ("rock.modulus",)
_STEPS = 200  # of a slider, about
#: Sliders that stop short of what may be typed: it takes too long, or nobody means it.
_FARTHEST: Mapping[str, float] = {"loads.seismic.k": 0.5, "analysis.refine": 2.0, "analysis.agree_within": 0.1}
#: Words that a field does not declare itself.
_WORDS: Mapping[str, tuple[str, ...]] = {
    "acts": ("active", "passive"), "mode": ("dry", "full"), "normals": ("true", "smoothed"),
}  # fmt: skip
_NAMES_STRENGTH = ("strength", "base", "sides")


#: The numbers of the last designs, which never change; put in place at once, whichever thread asks.
_LAST: list[tuple[tuple[Design, Mapping[str, Key]], ...]] = [()]


def groups_of(design: Design, opened: Design) -> list[dict[str, Any]]:
    """The controls in the groups of the file: `{"name", "label", "controls"}` each."""
    before = values_of(opened)
    by_group: dict[str, list[Control]] = {}
    for control in (*_words(design, opened), *_numbers(design, opened, before)):
        by_group.setdefault(control["path"].partition(".")[0], []).append(control)
    names = [*(name for name in _ORDER if name in by_group), *(name for name in by_group if name not in _ORDER)]
    for controls in by_group.values():  # as the file has them, then words and numbers that are left to a default
        controls.sort(key=lambda one: (not one["given"], one["path"].count(".") > 0 and not one["given"]))
    return [{"name": name, "label": name.replace("_", " "), "controls": by_group[name]} for name in names]


def values_of(design: Design) -> Mapping[str, Key]:
    """The numbers of a design by path: a distribution that has a mean stands by that.

    Those of the last designs are kept: what is set asks three times, and hundreds of bolts have thousands of numbers.
    """
    for one, numbers in _LAST[0]:
        if one is design:
            return numbers
    known = {key.path: key for key in keys_of(design)}
    numbers = {
        path: key for path, key in known.items()
        if f"{path}.mean" not in known and not path.startswith("correlation.")
    }  # fmt: skip
    _LAST[0] = ((design, numbers), *_LAST[0][:2])
    return numbers


def tree(design: Design) -> Document:
    """Return the document of a design; every design of the app has one."""
    assert design.source is not None
    return design.source


def text_at(document: Document, path: str) -> str | None:
    """What the file has at a path, an angle of an orientation by its own path; None where nothing stands there.

    >>> from slopekit.design.reading.nodes import document_from
    >>> text_at(document_from({"joints": {"J1": {"plane": "045/115"}}}), "joints.J1.plane.dip")
    '045'
    """
    node = document.root
    parts = path.split(".")
    for k, part in enumerate(parts):
        of = orientation_kind(node)
        if of is not None and k == len(parts) - 1 and part in WRITTEN[of] and not node.is_mapping:
            texts = [one.text or "" for one in node.elements] or [one.strip() for one in (node.text or "").split("/")]
            return texts[WRITTEN[of].index(part)] if len(texts) == 2 else None
        node = spread(node).get(part)
    return node.text


def _at(document: Document, parts: Sequence[str]) -> Node:
    node = document.root
    for part in parts:
        node = spread(node).get(part) or node
    return node


# -- numbers ----------------------------------------------------------------------------------------------------------


def _numbers(design: Design, opened: Design, before: Mapping[str, Key]) -> Iterator[Control]:
    scatter = {key.path: key.scatters for key in keys_of(design)}
    for path, key in values_of(design).items():
        if key.value is None and key.role == "setting":
            continue  # of the elastic blocks, which the app does not ask for
        field = field_in(type(design), tree(design).root, path.removesuffix(".mean"))
        old = before.get(path)
        low, high = ends(key if old is None or old.value is None else old)
        value = key.value
        if value is not None:
            low, high = min(low, key.reduced(value)), max(high, key.reduced(value))
        written = text_at(tree(design), path)
        logarithmic = is_logarithmic(key) and low > 0.0
        yield {
            "path": path, "label": words_of(type(design), path), "doc": _doc(field),
            "example": "" if field is None else field.example, "type": "count" if key.whole else "number",
            "unit": key.with_unit or key.unit, "value": value, "text": shown(key, written),
            "low": low, "high": high, "step": 1.0 if key.whole else _step(low, high, key.kind),
            "log": logarithmic, "words": [], "given": key.given, "is_default": not key.given,
            "changed": is_changed(key, old),
            "opened": None if old is None else shown(old, text_at(tree(opened), path)),
            "scatter": _scatter(scatter.get(path) or scatter.get(path.removesuffix(".mean"))), "period": key.period,
            "place": key.is_place,
        }  # fmt: skip


def is_changed(key: Key, old: Key | None) -> bool:
    """Whether a number is another than when the design was opened; not one that follows from others."""
    if old is None:
        return key.given
    return (key.given or old.given) and (key.value != old.value or key.with_unit != old.with_unit)


def ends(key: Key) -> tuple[float, float]:
    """Round ends of a slider, within what the design takes and about what is there: as `reach`."""
    low, high = (float(f"{end:.6g}") for end in reach(key))
    return max(low, key.low), min(high, key.high)


def reach(key: Key) -> tuple[float, float]:
    """Between what a slider goes: what slopes have about the present value, within what the design takes.

    >>> reach(Key("slope.height", "length", 20.0, 0.001, 1e5))
    (5.0, 60.0)
    >>> reach(Key("strength.weak.c", "pressure", 0.0, 0.0, 1e5))
    (0.0, 200.0)
    """
    value, usual = key.value, _USUAL[key.kind]
    if key.period is not None:
        return 0.0, key.period
    if is_logarithmic(key):
        middle = value or math.sqrt(max(key.low, 1e-9) * min(key.high, usual))
        return max(key.low, middle / _DECADES), min(key.high, middle * _DECADES)
    if key.role == "coordinate" or key.low < 0.0:
        if key.high - key.low <= 2.0 * usual + 60.0:
            return key.low, key.high
        about, far = value or 0.0, usual if key.is_place else max(usual, abs(value or 0.0))
        return max(key.low, about - far), min(key.high, about + far)
    if key.whole:
        return key.low, min(key.high, _FARTHEST.get(key.path, max(10.0, _TIMES * (value or 0.0))))
    low = max(key.low, _LEAST_USUAL.get(key.kind, 0.0))
    if key.kind == "length" and value and key.low > 0.0:
        low = max(key.low, value / 4.0)
    far = max(usual, _TIMES * (value or 0.0)) if key.kind != "length" or not value else _TIMES * value
    if key.kind == "angle":
        far = 90.0 if key.high == 90.0 or (value or 0.0) > usual else usual
    elif key.kind in _LEAST_USUAL:
        far = max(usual, 1.2 * (value or 0.0))
    far = max(_FARTHEST.get(key.path, far), value or 0.0)
    return min(low, key.high if value is None else value), min(key.high, far)


def is_logarithmic(key: Key) -> bool:
    """Whether a slider of it goes by the logarithm."""
    return key.kind in _LOGARITHMIC or key.path in _OF_LOGARITHMS


def _step(low: float, high: float, kind: str) -> float:
    """A round step: 1, 2 or 5 of a power of ten; of angles as compasses are read."""
    if kind == "angle":
        return 0.5 if high - low <= _USUAL["angle"] * 2.0 else 1.0
    raw = max(high - low, 1e-12) / _STEPS
    power = 10.0 ** math.floor(math.log10(raw))
    return float(next(f"{step * power:.6g}" for step in (1, 2, 5, 10) if step * power >= 0.99 * raw))


def shown(key: Key, written: str | None) -> str:
    """As it is written, with its unit; what is edited keeps every digit of a coordinate."""
    if key.value is None:
        return ""
    if key.is_place and round(key.value, 3) != key.value and not (written and unit_of(written)):
        return f"{key.value:.12g} {key.unit}"
    return written if written and unit_of(written) else key.shown(key.value)


def _scatter(of: Distribution | Fisher | None) -> dict[str, Any] | None:
    if of is None:
        return None
    return {"dist": "fisher", "k": of.k} if isinstance(of, Fisher) else {"dist": of.name, **of.parameters}


def _doc(field: Field | None) -> str:
    if field is None:
        return ""
    parts = [field.doc, f"left out: {field.left_out}" if field.left_out else ""]
    if math.isfinite(field.least) and field.is_number:
        parts.append(field.limits_in_words())
    return "; ".join(part for part in parts if part)


def written(design: Design, key: Key | None, path: str, value: float) -> str:
    """A number as the file shall have it: in the unit that stands there, no slip of radians, whole where it counts.

    >>> from slopekit.design.reading.files import load
    >>> wedge = load({"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    ...               "water": "50 %", "slope": {"height": "20 m"}})
    >>> keys = values_of(wedge)
    >>> [written(wedge, keys[path], path, new) for path, new in (("water.fill", 0.25), ("slope.height", 12.5))]
    ['25 %', '12.5 m']
    """
    if key is None:
        return _plain(value)
    if key.whole and value == int(value):
        return str(int(value))
    value = key.reduced(value)
    if key.with_unit:
        return f"{_plain(value)} {key.with_unit}"
    text = text_at(tree(design), path) or ""
    unit = re.sub(r"^\s*[+-]?[\d.]+(?:[eE][+-]?\d+)?\s*", "", text).strip() if unit_of(text) else ""
    if unit:
        try:
            text = f"{value / quantity(f'1 {unit}', key.kind, path):.12g} {unit}"
            if math.isclose(quantity(text, key.kind, path), value, rel_tol=1e-12, abs_tol=1e-300):
                return text
        except DesignError:
            pass
    field = field_in(type(design), tree(design).root, path.removesuffix(".mean"))
    slip = field is not None and field.check is in_degrees and in_degrees(value, path, "", str) is not None
    return f"{_plain(value)} deg" if slip else _plain(value)


def _plain(value: float) -> str:
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


# -- words ------------------------------------------------------------------------------------------------------------


def _words(design: Design, opened: Design) -> Iterator[Control]:
    """The title, the words of the language, and where a name under `strength` stands."""
    strengths = tree(design).root.get("strength")
    names = [name for name, _ in strengths.items()]
    for path, field in _texts(design):
        told = field.words or _WORDS.get(field.key, ())
        if field.key in _NAMES_STRENGTH:
            told = tuple(names) if len(names) > 1 else ()
        if (not told and path != "title") or (field.key in ("strength", "by") and not _is_there(design, path)):
            continue
        value, before = text_at(tree(design), path), text_at(tree(opened), path)
        default = field.default if isinstance(field.default, str) else None
        instead = None if value is not None else _instead(design, path)
        yield {
            "path": path, "label": field.axis or path.rpartition(".")[2].replace("_", " "),
            "doc": field.doc,
            "example": field.example, "type": "words" if told else "text", "unit": "",
            "value": value if value is not None else None if instead else default, "instead": instead,
            "text": value or "", "low": None, "high": None,
            "step": None, "log": False, "words": list(told), "given": value is not None, "is_default": value is None,
            "changed": value != before, "opened": before, "scatter": None, "period": None,
            "place": False,
        }  # fmt: skip


def _instead(design: Design, path: str) -> str | None:
    """The key that the design has in place of one that it excludes: `fill`, where `mode` says nothing then."""
    above, _, key = path.rpartition(".")
    keys, holder = ALTERNATIVES.get(above, ()), tree(design).root.get(above)
    if key not in keys or not holder:
        return None
    others = [one for one in keys if one != key]
    if not holder.is_mapping:  # water: 50 %
        return next((one for one in others if text_at(tree(design), f"{above}.{one}") is not None), None)
    return next((one for one in others if holder.get(one)), None)


def _is_there(design: Design, path: str) -> bool:
    """Whether what a word is said of is there."""
    above = path.split(".")[:-1]
    return not above or _at(tree(design), above).path == ".".join(above)


def _texts(design: Design) -> Iterator[tuple[str, Field]]:
    """Where words can stand, with the names and numbers that this design has in place of stars."""
    for field in every_field(type(design)):
        if field.measures != "text" or field.is_refused or field.many:
            continue
        places = [("", tree(design).root)]
        for part in field.path.split("."):
            places = [
                (f"{path}.{name}" if path else name, below)
                for path, node in places
                for name, below in _named(node, part)
            ]
        yield from ((path, field) for path, _ in places if field.path.count("*") == 0 or path)


def _named(node: Node, part: str) -> list[tuple[str, Node]]:
    if part != "*":
        return [(part, node.get(part))]
    return list(node.items()) if node.is_mapping else [(str(k), one) for k, one in enumerate(node.elements)]
