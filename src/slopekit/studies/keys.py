"""The numbers of a design by their dotted paths: their kind and unit, present value and limits.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> key = key_of(sk.load(wedge), "joints.J1.plane.dip")
>>> key.value, key.unit, key.read("50 deg")
(45.0, '°', 50.0)
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any

from slopekit.core.errors import DesignError, Fault, fail
from slopekit.core.orientation import Plane, millimetre
from slopekit.core.synonyms import nearest
from slopekit.core.units import is_unit_of, quantity, unit_of
from slopekit.design.common import Design
from slopekit.design.fields import (
    UNITS,
    Field,
    Role,
    declare,
    field_at,
    field_in,
    fields_of,
    value_of,
)
from slopekit.design.parts import Strength
from slopekit.design.reading.document import canonical_path
from slopekit.design.reading.files import with_values
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.structure import (
    WRITTEN_ANGLES,
    OrientationKind,
    expand_short_form,
    is_distribution,
    orientation_kind,
)
from slopekit.design.scatter.distributions import (
    Distribution,
    Fisher,
    read_distribution,
    read_orientation,
)

_NO_NUMBERS = ("slopekit", "kind", "title", "project", "acceptance")
_MOST_LISTED = 12
_FISHER_K = declare("k", "ratio", 0.1, 1e6, role="scatter")


@dataclass(frozen=True)
class Key:
    """One number of a design, with its kind, its present value and its limits.

    Attributes
    ----------
    path : dotted path, as `--set` takes it
    kind : the quantity that it measures (length, angle ...); role : its purpose (quantity, coordinate, setting ...)
    value : the present value in the unit of bare numbers; None where the design has none
    low, high : limits; period : of a direction, after which its values repeat, else None
    is_integer : whether it is a count
    given : whether it is written in the file, not left to its default
    scatters : its distribution, None where it is no random variable
    written_out : (path, text) of values to write first, so that the path exists
    with_unit : the unit that has to be written with it, where a bare number would be another quantity
    """

    path: str
    kind: str
    value: float | None
    low: float
    high: float
    role: Role = "quantity"
    is_integer: bool = False
    period: float | None = None
    given: bool = True
    scatters: Distribution | Fisher | None = None
    written_out: tuple[tuple[str, str], ...] = ()
    with_unit: str = ""

    @property
    def is_place(self) -> bool:
        """Whether the number is a coordinate of a point, which is read to the millimetre."""
        return self.role == "coordinate" and self.kind == "length"

    @property
    def in_csv(self) -> str:
        """The format of values in CSV: coordinates to the millimetre, others with every digit."""
        return ".3f" if self.is_place else ""

    @property
    def unit(self) -> str:
        """The unit of bare numbers, empty where there is none."""
        return UNITS[self.kind]

    def read(self, value: object) -> float:
        """Return the value of a number that may carry a unit; DesignError E105 to E108 as `core.units.quantity`."""
        return quantity(value, self.kind, self.path)

    def written(self, value: float) -> str:
        """Return a value as text for a design file, with every digit."""
        if self.is_integer and value == int(value):
            return str(int(value))
        return f"{self.reduced(value)!r} {self.with_unit}".strip()

    def reduced(self, value: float) -> float:
        """Return a direction within the full circle, any other value unchanged."""
        return (
            value % self.period
            if self.period is not None and not 0.0 <= value <= self.period
            else value
        )

    def value_text(self, value: float, digits: int = 10) -> str:
        """Return a value as text with its unit, as the sheet prints it; a coordinate to the millimetre."""
        text = millimetre(value) if self.is_place else f"{self.reduced(value):.{digits}g}"
        return f"{text}°" if self.unit == "°" else f"{text} {self.unit}".strip()

    def distance(self, a: float, b: float) -> float:
        """Return the difference of two values, the smaller angle of two directions."""
        difference = abs(a - b)
        return (
            difference
            if self.period is None
            else min(difference % self.period, -difference % self.period)
        )


def values_of(design: Design, keys: Sequence[Key], values: Sequence[float]) -> dict[str, object]:
    """Return the settings for `with_values` that give some keys of a design other values."""
    settings: dict[str, object] = {path: text for key in keys for path, text in key.written_out}
    root = design.source.root if design.source is not None else None
    paths = [key.path for key in keys]
    if (
        any(key.scatters is not None for key in keys)
        and root is not None
        and root.get("correlation")
    ):
        settings["correlation"] = None  # one of the variables that it names has a fixed value now
    return settings | {
        path: key.written(value) for path, key, value in zip(paths, keys, values, strict=True)
    }


def key_of(design: Design, path: str) -> Key:
    """Return the key of a path.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 no such key, with the nearest one, E311 a key that names no number.
    """
    path = (
        path.strip() if design.source is None else canonical_path(design.source.root, path.strip())
    )
    keys_by_path = {key.path: key for key in keys_of(design)}
    path = "loads.seismic.k" if path == "loads.seismic" else path
    if path in keys_by_path:
        return keys_by_path[path]
    node = _node_at(design, path)
    below = [name for name in keys_by_path if name.startswith(f"{path}.")]
    if node or below:
        description = _node_in_words(node, below)
        advice = f"Name one of {listed(below)}." if below else _unit_advice(design, node)
        fail("E311", f"{path} is {description}: a study changes one number", path, advice)
    advice = _nearest_keys_advice(path, keys_by_path)
    raise DesignError(
        [
            Fault(
                "E310",
                f"{path or 'an empty text'} is no number of this {design.kind} design",
                "",
                advice,
            )
        ]
    )


def keys_of(design: Design) -> tuple[Key, ...]:
    """Return the keys of all numbers of a design, those left to a default included.

    Raises
    ------
    DesignError
        E280 where the design was not read from a file or a dict.
    """
    if design.source is None:
        with_values(design, {})
    assert design.source is not None
    by_path = {key.path: key for key in _present(design, design.source.root)}
    for path, value, written_out in _absent(design):
        field = field_in(type(design), design.source.root, path)
        if path not in by_path and field is not None:
            by_path[path] = _key(path, field, value, is_given=False, written_out=written_out)
    return tuple(by_path.values())


# -- numbers in the file ------------------------------------------------------------------------------------------


def _present(design: Design, node: Node) -> Iterator[Key]:
    node = expand_short_form(node)
    if node.path.partition(".")[0] in _NO_NUMBERS:
        return
    orientation = orientation_kind(node)
    if is_distribution(node):
        yield from _scattering(design, node)
    elif orientation is not None and (node.text is not None or len(node.elements) == 2):
        yield from _angles(design, node, orientation)
    elif node.is_mapping:
        for _, below in node.items():
            yield from _present(design, below)
    elif node.elements:
        for below in node.elements:
            yield from _present(design, below)
    elif node.text is not None and (field := _field(design, node.path, node.text)) is not None:
        value = _number(node.text, field.measures)
        if value is not None:
            key, bare_field = (
                _key(node.path, field, value),
                field_in(type(design), _root(design), node.path),
            )
            yield (
                replace(key, with_unit=key.unit)
                if bare_field is not None and bare_field.measures != key.kind
                else key
            )


def _angles(design: Design, node: Node, orientation: OrientationKind) -> Iterator[Key]:
    """Yield the two angles of an orientation that is written with a slash or as a pair."""
    texts = (
        [element.text or "" for element in node.elements]
        if node.elements
        else (node.text or "").split("/")
    )
    if len(texts) != 2:
        if node.name == "toward" and (value := _number(node.text or "", "angle")) is not None:
            yield _key(node.path, _field(design, node.path), value)  # of a seismic load
        return
    for angle, text in zip(WRITTEN_ANGLES[orientation], texts, strict=True):
        path = f"{node.path}.{angle}"
        value, field = _number(text, "angle"), _field(design, path)
        if value is not None and field is not None:
            yield _key(path, field, value)


def _scattering(design: Design, node: Node) -> Iterator[Key]:
    """Yield the key of a distributed number itself, then those of the parameters of its distribution."""
    orientation = orientation_kind(node)
    if orientation is not None:
        fisher = read_orientation(node, node.path, orientation)
        mean = node.get("mean")
        if mean is not None:
            for key, value in zip(
                _angles(design, mean, orientation), astuple(fisher.mean), strict=True
            ):
                yield replace(key, value=value, scatters=fisher)
        yield _key(f"{node.path}.k", _FISHER_K, fisher.k)
        return
    field = _field(design, node.path)
    if field is None:
        return
    distribution = read_distribution(node, field.measures, node.path, field.period)
    centre_key = _key(node.path, field, distribution.centre)
    yield replace(centre_key, scatters=distribution)
    for name, value in distribution.parameters.items():
        path = f"{node.path}.{name}"
        if name == "sd":
            yield replace(
                centre_key,
                path=path,
                value=value,
                role="scatter",
                low=0.0,
                high=centre_key.high - centre_key.low,
                period=None,
            )
        else:
            yield replace(
                centre_key,
                path=path,
                value=value,
                role=centre_key.role if name == "mean" else "scatter",
            )


# -- numbers left to a default ------------------------------------------------------------------------------

_AbsentNumber = tuple[str, float | None, tuple[tuple[str, str], ...]]


def _absent(design: Design) -> Iterator[_AbsentNumber]:
    """Yield paths that the file may lack, with the default value and the texts to write first."""
    weight = design.rock.unit_weight_kn_m3 or None
    yield "rock.unit_weight", weight, ()
    yield "rock.density", None if weight is None else weight / design.rock.gravity_m_s2 * 1e3, ()
    for name, field in fields_of(type(design)).items():
        value = value_of(design, field.value_attribute or name) if field.is_attribute else None
        if field.path == "loads.seismic":
            yield "loads.seismic.k", design.seismic.coefficient, ()
        elif field.path == "loads.surcharge":
            yield field.path, value or 0.0, ()
        elif field.path.startswith(("rock.d", "rock.u", "water")):
            continue
        elif isinstance(value, Plane):
            yield from _plane(field.path, value)
        elif field.is_number and field.is_attribute and not field.many:
            yield field.path, value, ()
        elif field.record_type is not None and field.many == "names" and isinstance(value, tuple):
            yield from _absent_in_records(field, value, weight)
    yield from _strengths(design)
    yield from _water(design)


def _absent_in_records(
    field: Field, records: Sequence[Any], weight: float | None
) -> Iterator[_AbsentNumber]:
    """Yield the numbers that the named records of a group leave to a default."""
    for record in records:
        for name, below in fields_of(type(record)).items():
            if below.is_number and below.is_attribute and not getattr(record, "fixed", False):
                value = getattr(record, name)
                yield (
                    f"{field.path}.{record.name}.{below.path}",
                    weight if value is None else value,
                    (),
                )


def _strengths(design: Design) -> Iterator[_AbsentNumber]:
    assert design.source is not None
    strengths = design.source.root.get("strength")
    names = [name for name, _ in strengths.items()]
    for name in names or ["joints"]:
        curved = strengths.get(name).get("law")
        for field in fields_of(Strength).values():
            if field.is_number and not (field.may_lack and curved):
                value = design.DEFAULTS.get(field.path, None if field.may_lack else field.default)
                if value is not None and (names or field.may_lack):
                    yield f"strength.{name}.{field.path}", value, ()


def _plane(path: str, plane: Plane) -> Iterator[_AbsentNumber]:
    text = f"{plane.dip_deg!r}/{plane.dip_direction_deg!r}"
    yield f"{path}.dip", plane.dip_deg, ((path, text),)
    yield f"{path}.dip_direction", plane.dip_direction_deg, ((path, text),)


def _water(design: Design) -> Iterator[_AbsentNumber]:
    """Yield the water fill and the pressures of joints that the file does not have, or only for some joints."""
    assert design.source is not None
    root, water = design.source.root, design.water
    if "water_unit_weight_kn_m3" in fields_of(type(design)):
        yield "water.unit_weight", design.water_unit_weight_kn_m3, ()
    if field_at(type(design), "crack.depth") is not None and root.find("crack.water"):
        return  # the water of a crack replaces the other values
    if design.ALLOWS_FILL:
        yield "water.fill", {"dry": 0.0, "full": water.fill}.get(water.mode), ()
    pressures = expand_short_form(root.get("water")).get("pressures")
    if not pressures or pressures.is_mapping:
        dry = water.mode == "dry" or pressures
        for name in design.wet_interfaces:
            yield f"water.pressures.{name}", 0.0 if dry else None, ()


# -- names ------------------------------------------------------------------------------------------------------------


def _field(design: Design, path: str, text: str = "") -> Field | None:
    """Return the field of a path, with the kind of its unit: water of a crack may be a fraction of full, kPa or m."""
    field = field_in(type(design), _root(design), path.replace(".mean.", "."))
    unit = unit_of(text)
    if field is None or unit in ("", "%"):
        return field
    measure = next((measure for measure in field.or_measures if is_unit_of(unit, measure)), None)
    return field if measure is None else replace(field, measures=measure, most=math.inf)


def _root(design: Design) -> Node | None:
    return None if design.source is None else design.source.root


def _key(
    path: str,
    field: Field | None,
    value: float | None,
    is_given: bool = True,
    written_out: tuple[tuple[str, str], ...] = (),
) -> Key:
    assert field is not None
    low, high = field.sought
    return Key(
        path,
        field.measures,
        value,
        low,
        high,
        field.role,
        field.is_integer,
        field.period,
        is_given,
        None,
        written_out,
    )


def _number(text: str, kind: str) -> float | None:
    try:
        return quantity(text, kind, "")
    except DesignError:
        return None


def _node_at(design: Design, path: str) -> Node:
    return NOTHING if design.source is None else design.source.root.find(path)


def _node_in_words(node: Node, below: Sequence[str]) -> str:
    if not node or node.is_mapping:
        return "a group"
    if isinstance(node.value, list):
        return f"a list of {len(node.value)}"
    if below and below[0].endswith((".dip", ".trend")):
        return "an orientation"
    return f"the text {node.text!r}"


def _unit_advice(design: Design, node: Node) -> str:
    """Return the advice to write a text as a number with unit: for `50 %` or `full` where metres are allowed too."""
    field = _field(design, node.path) if node.text is not None else None
    units = (
        [UNITS[measure] for measure in (field.measures, *field.or_measures)]
        if field is not None
        else []
    )
    if not units or not all(units):
        return ""
    return f"Write it in {' or '.join(units)} in the design, then a study can change it."


def listed(names: Sequence[str]) -> str:
    """Return names as a list in words, the first twelve of them and their number where there are more."""
    more = f", … ({len(names)} in all)" if len(names) > _MOST_LISTED else ""
    return ", ".join(names[:_MOST_LISTED]) + more


def _nearest_keys_advice(path: str, keys_by_path: Mapping[str, Key]) -> str:
    """Return the advice with the nearest keys: those with the same ending, similar spelling, or the same group."""
    above, _, last = path.rpartition(".")
    last = next(
        iter(nearest(last, {name.rpartition(".")[2] for name in keys_by_path}, cutoff=0.7)), last
    )
    path = f"{above}.{last}" if above else last
    ends = [name for name in keys_by_path if path and f".{path}." in f".{name}."] or nearest(
        path, keys_by_path, cutoff=0.8
    )
    ends = ends or [name for name in keys_by_path if name.endswith(f".{last}")]
    ends = ends or [name for name in keys_by_path if name.startswith(f"{path.partition('.')[0]}.")]
    if ends:
        return (
            f"Did you mean {ends[0]}?" if len(ends) == 1 else f"Did you mean one of {listed(ends)}?"
        )
    numbers = [name for name, key in keys_by_path.items() if key.role == "quantity"]
    missing = "It has no bolts. " if path.startswith("support") else ""
    return f"{missing}There are {listed(numbers)}."


def in_words(key: Key) -> str:
    """Return a key in words with its present value.

    >>> in_words(Key("slope.height", "length", 64.89, 0.001, 1e5))
    'slope.height, now 64.89 m'
    """
    if key.value is None:
        return f"{key.path}, not given now"
    prefix = "by default" if not key.given else "now"
    return f"{key.path}, {prefix} {key.value_text(key.value)}" + (
        " (its mean)" if key.scatters is not None else ""
    )
