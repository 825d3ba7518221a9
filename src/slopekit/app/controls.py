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
from slopekit.design.reading.structure import WRITTEN_ANGLES, expand_short_form, orientation_kind
from slopekit.design.scatter.distributions import Distribution, Fisher
from slopekit.studies.keys import Key, keys_of

Control = dict[str, Any]

#: The sections of a design in the order of its file; others come after them as the fields have them.
_ORDER = (
    "title",
    "slope",
    "columns",
    "footing",
    "weak_plane",
    "slip",
    "section",
    "blocks",
    "joints",
    "sets",
    "crack",
    "basal",
    "interfaces",
    "strength",
    "rock",
    "water",
    "loads",
    "support",
    "limits",
    "cut",
    "analysis",
)
#: What sliders reach to from nothing, by what a number measures.
_USUAL: Mapping[str, float] = {
    "length": 20.0,
    "volume": 10.0,
    "pressure": 200.0,
    "force": 1000.0,
    "angle": 60.0,
    "acceleration": 20.0,
    "ratio": 1.0,
    "stiffness": 1e8,
    "density": 3500.0,
    "unit weight": 35.0,
}
_LEAST_USUAL: Mapping[str, float] = {"density": 1500.0, "unit weight": 5.0}
_TIMES = 3.0  # the high end of a slider, in parts of the present value
_DECADES = 100.0  # the same of a logarithmic slider, up and down
_LOGARITHMIC = ("stiffness",)
_LOGARITHMIC_PATHS = ("rock.modulus",)
_STEPS = 200  # of a slider, about
#: Sliders that stop short of what may be typed: it takes too long, or nobody means it.
_SLIDER_LIMITS: Mapping[str, float] = {
    "loads.seismic.k": 0.5,
    "analysis.refine": 2.0,
    "analysis.agree_within": 0.1,
}
#: Words that a field does not declare itself.
_WORDS: Mapping[str, tuple[str, ...]] = {
    "acts": ("active", "passive"),
    "mode": ("dry", "full"),
    "normals": ("true", "smoothed"),
}
_NAMES_STRENGTH = ("strength", "base", "sides")


#: The numbers of the last designs, which never change; put in place at once, whichever thread asks.
_RECENT: list[tuple[tuple[Design, Mapping[str, Key]], ...]] = [()]


def groups_of(design: Design, opened: Design) -> list[dict[str, Any]]:
    """The controls in the groups of the file: `{"name", "label", "controls"}` each."""
    opened_values = values_of(opened)
    by_group: dict[str, list[Control]] = {}
    for control in (*_words(design, opened), *_numbers(design, opened, opened_values)):
        by_group.setdefault(control["path"].partition(".")[0], []).append(control)
    names = [
        *(name for name in _ORDER if name in by_group),
        *(name for name in by_group if name not in _ORDER),
    ]
    for controls in (
        by_group.values()
    ):  # as the file has them, then words and numbers that are left to a default
        controls.sort(
            key=lambda control: (
                not control["given"],
                control["path"].count(".") > 0 and not control["given"],
            )
        )
    return [
        {"name": name, "label": name.replace("_", " "), "controls": by_group[name]}
        for name in names
    ]


def values_of(design: Design) -> Mapping[str, Key]:
    """The numbers of a design by path: a distribution that has a mean stands by that.

    Those of the last designs are kept: what is set asks three times, and hundreds of bolts have thousands of numbers.
    """
    for recent_design, numbers in _RECENT[0]:
        if recent_design is design:
            return numbers
    keys_by_path = {key.path: key for key in keys_of(design)}
    numbers = {
        path: key
        for path, key in keys_by_path.items()
        if f"{path}.mean" not in keys_by_path and not path.startswith("correlation.")
    }
    _RECENT[0] = ((design, numbers), *_RECENT[0][:2])
    return numbers


def tree(design: Design) -> Document:
    """Return the document of a design; every design of the app has one."""
    assert design.source is not None
    return design.source


def text_at(document: Document, path: str) -> str | None:
    """Return the text of the file at a path, an angle of an orientation by its own path; None where there is none.

    >>> from slopekit.design.reading.nodes import document_from
    >>> text_at(document_from({"joints": {"J1": {"plane": "045/115"}}}), "joints.J1.plane.dip")
    '045'
    """
    node = document.root
    keys = path.split(".")
    for k, key in enumerate(keys):
        kind = orientation_kind(node)
        if (
            kind is not None
            and k == len(keys) - 1
            and key in WRITTEN_ANGLES[kind]
            and not node.is_mapping
        ):
            texts = [element.text or "" for element in node.elements] or [
                element.strip() for element in (node.text or "").split("/")
            ]
            return texts[WRITTEN_ANGLES[kind].index(key)] if len(texts) == 2 else None
        node = expand_short_form(node).get(key)
    return node.text


def _deepest_node(document: Document, keys: Sequence[str]) -> Node:
    node = document.root
    for key in keys:
        node = expand_short_form(node).get(key) or node
    return node


# -- numbers ----------------------------------------------------------------------------------------------------------


def _numbers(design: Design, opened: Design, opened_values: Mapping[str, Key]) -> Iterator[Control]:
    scatter = {key.path: key.scatters for key in keys_of(design)}
    for path, key in values_of(design).items():
        if key.value is None and key.role == "setting":
            continue  # of the elastic blocks, which the app does not ask for
        field = field_in(type(design), tree(design).root, path.removesuffix(".mean"))
        old = opened_values.get(path)
        low, high = rounded_slider_range(key if old is None or old.value is None else old)
        value = key.value
        if value is not None:
            low, high = min(low, key.reduced(value)), max(high, key.reduced(value))
        written = text_at(tree(design), path)
        logarithmic = is_logarithmic(key) and low > 0.0
        yield {
            "path": path,
            "label": words_of(type(design), path),
            "doc": _doc(field),
            "example": "" if field is None else field.example,
            "type": "count" if key.is_integer else "number",
            "unit": key.with_unit or key.unit,
            "value": value,
            "text": text_of_number(key, written),
            "low": low,
            "high": high,
            "step": 1.0 if key.is_integer else _step(low, high, key.kind),
            "log": logarithmic,
            "words": [],
            "given": key.given,
            "is_default": not key.given,
            "changed": is_changed(key, old),
            "opened": None if old is None else text_of_number(old, text_at(tree(opened), path)),
            "scatter": _scatter(scatter.get(path) or scatter.get(path.removesuffix(".mean"))),
            "period": key.period,
            "place": key.is_place,
        }


def is_changed(key: Key, old: Key | None) -> bool:
    """Whether a number differs from that of the opened design; numbers that follow from others do not count."""
    if old is None:
        return key.given
    return (key.given or old.given) and (key.value != old.value or key.with_unit != old.with_unit)


def rounded_slider_range(key: Key) -> tuple[float, float]:
    """Return the range of a slider, rounded, within the limits of the design."""
    low, high = (float(f"{end:.6g}") for end in slider_range(key))
    return max(low, key.low), min(high, key.high)


def slider_range(key: Key) -> tuple[float, float]:
    """Return the range of a slider: usual values about the present one, within the limits of the design.

    >>> slider_range(Key("slope.height", "length", 20.0, 0.001, 1e5))
    (5.0, 60.0)
    >>> slider_range(Key("strength.weak.c", "pressure", 0.0, 0.0, 1e5))
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
        about, distance = value or 0.0, usual if key.is_place else max(usual, abs(value or 0.0))
        return max(key.low, about - distance), min(key.high, about + distance)
    if key.is_integer:
        return key.low, min(
            key.high, _SLIDER_LIMITS.get(key.path, max(10.0, _TIMES * (value or 0.0)))
        )
    low = max(key.low, _LEAST_USUAL.get(key.kind, 0.0))
    if key.kind == "length" and value and key.low > 0.0:
        low = max(key.low, value / 4.0)
    distance = (
        max(usual, _TIMES * (value or 0.0)) if key.kind != "length" or not value else _TIMES * value
    )
    if key.kind == "angle":
        distance = 90.0 if key.high == 90.0 or (value or 0.0) > usual else usual
    elif key.kind in _LEAST_USUAL:
        distance = max(usual, 1.2 * (value or 0.0))
    distance = max(_SLIDER_LIMITS.get(key.path, distance), value or 0.0)
    return min(low, key.high if value is None else value), min(key.high, distance)


def is_logarithmic(key: Key) -> bool:
    """Whether a slider of it goes by the logarithm."""
    return key.kind in _LOGARITHMIC or key.path in _LOGARITHMIC_PATHS


def _step(low: float, high: float, kind: str) -> float:
    """A round step: 1, 2 or 5 of a power of ten; of angles as compasses are read."""
    if kind == "angle":
        return 0.5 if high - low <= _USUAL["angle"] * 2.0 else 1.0
    raw = max(high - low, 1e-12) / _STEPS
    power = 10.0 ** math.floor(math.log10(raw))
    return float(
        next(f"{step * power:.6g}" for step in (1, 2, 5, 10) if step * power >= 0.99 * raw)
    )


def text_of_number(key: Key, written: str | None) -> str:
    """Return the text of a number with its unit; a coordinate keeps every digit."""
    if key.value is None:
        return ""
    if key.is_place and round(key.value, 3) != key.value and not (written and unit_of(written)):
        return f"{key.value:.12g} {key.unit}"
    return written if written and unit_of(written) else key.value_text(key.value)


def _scatter(distribution: Distribution | Fisher | None) -> dict[str, Any] | None:
    if distribution is None:
        return None
    return (
        {"dist": "fisher", "k": distribution.k}
        if isinstance(distribution, Fisher)
        else {"dist": distribution.name, **distribution.parameters}
    )


def _doc(field: Field | None) -> str:
    if field is None:
        return ""
    sentences = [field.doc, f"left out: {field.left_out}" if field.left_out else ""]
    if math.isfinite(field.least) and field.is_number:
        sentences.append(field.limits_in_words())
    return "; ".join(sentence for sentence in sentences if sentence)


def text_for_file(design: Design, key: Key | None, path: str, value: float) -> str:
    """Return a number as the file writes it: in the unit that stands there, marked `deg` where it could be radians.

    >>> from slopekit.design.reading.files import load
    >>> wedge = load({"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    ...               "water": "50 %", "slope": {"height": "20 m"}})
    >>> keys = values_of(wedge)
    >>> [text_for_file(wedge, keys[path], path, new) for path, new in (("water.fill", 0.25), ("slope.height", 12.5))]
    ['25 %', '12.5 m']
    """
    if key is None:
        return _plain(value)
    if key.is_integer and value == int(value):
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
    slip = (
        field is not None
        and field.check is in_degrees
        and in_degrees(value, path, "", str) is not None
    )
    return f"{_plain(value)} deg" if slip else _plain(value)


def _plain(value: float) -> str:
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


# -- words ------------------------------------------------------------------------------------------------------------


def _words(design: Design, opened: Design) -> Iterator[Control]:
    """Iterate over the controls of words: the title, closed vocabularies, names of strengths."""
    strengths = tree(design).root.get("strength")
    names = [name for name, _ in strengths.items()]
    for path, field in _text_fields(design):
        choices = field.words or _WORDS.get(field.key, ())
        if field.key in _NAMES_STRENGTH:
            choices = tuple(names) if len(names) > 1 else ()
        if (not choices and path != "title") or (
            field.key in ("strength", "by") and not _has_parent(design, path)
        ):
            continue
        value, opened_value = text_at(tree(design), path), text_at(tree(opened), path)
        default = field.default if isinstance(field.default, str) else None
        instead = None if value is not None else _alternative_in_use(design, path)
        yield {
            "path": path,
            "label": field.axis or path.rpartition(".")[2].replace("_", " "),
            "doc": field.doc,
            "example": field.example,
            "type": "words" if choices else "text",
            "unit": "",
            "value": value if value is not None else None if instead else default,
            "instead": instead,
            "text": value or "",
            "low": None,
            "high": None,
            "step": None,
            "log": False,
            "words": list(choices),
            "given": value is not None,
            "is_default": value is None,
            "changed": value != opened_value,
            "opened": opened_value,
            "scatter": None,
            "period": None,
            "place": False,
        }


def _alternative_in_use(design: Design, path: str) -> str | None:
    """Return the key in use that excludes this one: `fill`, beside which `mode` does not apply."""
    above, _, key = path.rpartition(".")
    keys, holder = ALTERNATIVES.get(above, ()), tree(design).root.get(above)
    if key not in keys or not holder:
        return None
    alternatives = [alternative for alternative in keys if alternative != key]
    if not holder.is_mapping:  # water: 50 %
        return next(
            (
                alternative
                for alternative in alternatives
                if text_at(tree(design), f"{above}.{alternative}") is not None
            ),
            None,
        )
    return next((alternative for alternative in alternatives if holder.get(alternative)), None)


def _has_parent(design: Design, path: str) -> bool:
    """Whether the section that holds a word stands in the design."""
    above = path.split(".")[:-1]
    return not above or _deepest_node(tree(design), above).path == ".".join(above)


def _text_fields(design: Design) -> Iterator[tuple[str, Field]]:
    """Iterate over the paths of words, the stars of the schema replaced by this design's names and numbers."""
    for field in every_field(type(design)):
        if field.measures != "text" or field.is_refused or field.many:
            continue
        places = [("", tree(design).root)]
        for key in field.path.split("."):
            places = [
                (f"{path}.{name}" if path else name, below)
                for path, node in places
                for name, below in _matching_children(node, key)
            ]
        yield from ((path, field) for path, _ in places if field.path.count("*") == 0 or path)


def _matching_children(node: Node, key: str) -> list[tuple[str, Node]]:
    if key != "*":
        return [(key, node.get(key))]
    return (
        list(node.items())
        if node.is_mapping
        else [(str(k), element) for k, element in enumerate(node.elements)]
    )
