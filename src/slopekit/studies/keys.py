"""The numbers of a design by their dotted paths: what each measures, what it is now, between what it can lie.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> key = key_of(sk.load(wedge), "joints.J1.plane.dip")
>>> key.value, key.unit, key.read("50 deg"), key.shown(50.0)
(45.0, '°', 50.0, '50°')
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
from slopekit.design.fields import UNITS, Field, Role, declare, field_at, field_in, fields_of, value_of
from slopekit.design.parts import Strength
from slopekit.design.reading.document import canonical_path
from slopekit.design.reading.files import with_values
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.structure import WRITTEN, OrientationKind, is_distribution, orientation_kind, spread
from slopekit.design.scatter.distributions import Distribution, Fisher, read_distribution, read_orientation

_NO_NUMBERS = ("slopekit", "kind", "title", "project", "acceptance")
_MOST_LISTED = 12
_FISHER_K = declare("k", "ratio", 0.1, 1e6, role="scatter")


@dataclass(frozen=True)
class Key:
    """One number of a design.

    Attributes
    ----------
    path : as `--set` takes it
    kind, role : what it measures, what it is for
    value : the present one in the unit of bare numbers; None where the design says nothing of it
    low, high : between which it can lie; period : after which it is the same again, None of all but directions
    whole : whether it counts something
    given : whether it stands in the file
    scatters : how it scatters, None where it does not
    written_out : values to be written first, so that the path leads somewhere
    with_unit : the unit that has to be written with it, where a bare number would be another thing
    """

    path: str
    kind: str
    value: float | None
    low: float
    high: float
    role: Role = "quantity"
    whole: bool = False
    period: float | None = None
    given: bool = True
    scatters: Distribution | Fisher | None = None
    written_out: tuple[tuple[str, str], ...] = ()
    with_unit: str = ""

    @property
    def is_place(self) -> bool:
        """Whether it is a coordinate of a place, which is read to the millimetre."""
        return self.role == "coordinate" and self.kind == "length"

    @property
    def in_csv(self) -> str:
        """How its values are written in CSV: a coordinate to the millimetre, others with every digit."""
        return ".3f" if self.is_place else ""

    @property
    def unit(self) -> str:
        """The unit of bare numbers, empty where there is none."""
        return UNITS[self.kind]

    def read(self, value: object) -> float:
        """A number that may carry a unit. Raises DesignError E105 to E108 as `slopekit.core.units.quantity`."""
        return quantity(value, self.kind, self.path)

    def written(self, value: float) -> str:
        """The value as the file would have it, every digit of it."""
        if self.whole and value == int(value):
            return str(int(value))
        return f"{self.reduced(value)!r} {self.with_unit}".strip()

    def reduced(self, value: float) -> float:
        """A direction within the circle; any other value as it is."""
        return value % self.period if self.period is not None and not 0.0 <= value <= self.period else value

    def shown(self, value: float, digits: int = 10) -> str:
        """The value with its unit, as the sheet prints it; a coordinate to the millimetre."""
        text = millimetre(value) if self.is_place else f"{self.reduced(value):.{digits}g}"
        return f"{text}°" if self.unit == "°" else f"{text} {self.unit}".strip()

    def apart(self, a: float, b: float) -> float:
        """The distance of two values, the shorter way round where it is a direction."""
        off = abs(a - b)
        return off if self.period is None else min(off % self.period, -off % self.period)


def values_of(design: Design, keys: Sequence[Key], values: Sequence[float]) -> dict[str, object]:
    """What `with_values` takes to give some keys of a design other values."""
    settings: dict[str, object] = {path: text for key in keys for path, text in key.written_out}
    root = design.source.root if design.source is not None else None
    named = [key.path for key in keys]
    if any(key.scatters is not None for key in keys) and root is not None and root.get("correlation"):
        settings["correlation"] = None  # one of those that it names scatters no longer
    return settings | {path: key.written(value) for path, key, value in zip(named, keys, values, strict=True)}


def key_of(design: Design, path: str) -> Key:
    """The key of a path.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 no such key, with the nearest one, E311 a key that names no number.
    """
    path = path.strip() if design.source is None else canonical_path(design.source.root, path.strip())
    known = {key.path: key for key in keys_of(design)}
    path = "loads.seismic.k" if path == "loads.seismic" else path
    if path in known:
        return known[path]
    node = _at(design, path)
    below = [name for name in known if name.startswith(f"{path}.")]
    if node or below:
        what = _what(node, below)
        advice = f"Name one of {listed(below)}." if below else _as_number(design, node)
        fail("E311", f"{path} is {what}: a study changes one number", path, advice)
    advice = _nearest(path, known)
    raise DesignError(
        [Fault("E310", f"{path or 'an empty text'} is no number of this {design.kind} design", "", advice)]
    )


def keys_of(design: Design) -> tuple[Key, ...]:
    """Every number of a design, those that it leaves to a default among them.

    Raises
    ------
    DesignError
        E280 where the design was not read from a file or a dict.
    """
    if design.source is None:
        with_values(design, {})
    assert design.source is not None
    by_path = {key.path: key for key in _present(design, design.source.root)}
    for path, value, out in _absent(design):
        field = field_in(type(design), design.source.root, path)
        if path not in by_path and field is not None:
            by_path[path] = _key(path, field, value, given=False, out=out)
    return tuple(by_path.values())


# -- what stands in the file ------------------------------------------------------------------------------------------


def _present(design: Design, node: Node) -> Iterator[Key]:
    node = spread(node)
    if node.path.partition(".")[0] in _NO_NUMBERS:
        return
    of = orientation_kind(node)
    if is_distribution(node):
        yield from _scattering(design, node)
    elif of is not None and (node.text is not None or len(node.elements) == 2):
        yield from _angles(design, node, of)
    elif node.is_mapping:
        for _, below in node.items():
            yield from _present(design, below)
    elif node.elements:
        for below in node.elements:
            yield from _present(design, below)
    elif node.text is not None and (field := _field(design, node.path, node.text)) is not None:
        value = _number(node.text, field.measures)
        if value is not None:
            own, bare = _key(node.path, field, value), field_in(type(design), _root(design), node.path)
            yield replace(own, with_unit=own.unit) if bare is not None and bare.measures != own.kind else own


def _angles(design: Design, node: Node, of: OrientationKind) -> Iterator[Key]:
    """The two angles of an orientation that is written with a slash or as a pair."""
    texts = [part.text or "" for part in node.elements] if node.elements else (node.text or "").split("/")
    if len(texts) != 2:
        if node.name == "toward" and (value := _number(node.text or "", "angle")) is not None:
            yield _key(node.path, _field(design, node.path), value)  # of a seismic load
        return
    for angle, text in zip(WRITTEN[of], texts, strict=True):
        path = f"{node.path}.{angle}"
        value, field = _number(text, "angle"), _field(design, path)
        if value is not None and field is not None:
            yield _key(path, field, value)


def _scattering(design: Design, node: Node) -> Iterator[Key]:
    """The value of a distribution as one number, then the numbers that it is made of."""
    of = orientation_kind(node)
    if of is not None:
        fisher = read_orientation(node, node.path, of)
        mean = node.get("mean")
        if mean is not None:
            for key, value in zip(_angles(design, mean, of), astuple(fisher.mean), strict=True):
                yield replace(key, value=value, scatters=fisher)
        yield _key(f"{node.path}.k", _FISHER_K, fisher.k)
        return
    field = _field(design, node.path)
    if field is None:
        return
    distribution = read_distribution(node, field.measures, node.path, field.period)
    own = _key(node.path, field, distribution.centre)
    yield replace(own, scatters=distribution)
    for name, value in distribution.parameters.items():
        path = f"{node.path}.{name}"
        if name == "sd":
            yield replace(own, path=path, value=value, role="scatter", low=0.0, high=own.high - own.low, period=None)
        else:
            yield replace(own, path=path, value=value, role=own.role if name == "mean" else "scatter")


# -- what the design leaves to a default ------------------------------------------------------------------------------

_Absent = tuple[str, float | None, tuple[tuple[str, str], ...]]


def _absent(design: Design) -> Iterator[_Absent]:
    """Paths that the file may not have, the value that they take then, and what is to be written first."""
    weight = design.rock.unit_weight_kn_m3 or None
    yield "rock.unit_weight", weight, ()
    yield "rock.density", None if weight is None else weight / design.rock.gravity_m_s2 * 1e3, ()
    for name, field in fields_of(type(design)).items():
        value = value_of(design, field.taken or name) if field.is_attribute else None
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
        elif field.of is not None and field.many == "names" and isinstance(value, tuple):
            yield from _of_named(field, value, weight)
    yield from _strengths(design)
    yield from _water(design)


def _of_named(field: Field, records: Sequence[Any], weight: float | None) -> Iterator[_Absent]:
    """What the records of a group, under names of the user's, leave to a default."""
    for record in records:
        for name, below in fields_of(type(record)).items():
            if below.is_number and below.is_attribute and not getattr(record, "fixed", False):
                value = getattr(record, name)
                yield f"{field.path}.{record.name}.{below.path}", weight if value is None else value, ()


def _strengths(design: Design) -> Iterator[_Absent]:
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


def _plane(path: str, plane: Plane) -> Iterator[_Absent]:
    text = f"{plane.dip_deg!r}/{plane.dip_direction_deg!r}"
    yield f"{path}.dip", plane.dip_deg, ((path, text),)
    yield f"{path}.dip_direction", plane.dip_direction_deg, ((path, text),)


def _water(design: Design) -> Iterator[_Absent]:
    """How full the joints are, or the pressures on them: the one that is not given, or given to some of them only."""
    assert design.source is not None
    root, water = design.source.root, design.water
    if "water_unit_weight_kn_m3" in fields_of(type(design)):
        yield "water.unit_weight", design.water_unit_weight_kn_m3, ()
    if field_at(type(design), "crack.depth") is not None and root.at("crack.water"):
        return  # which says it all
    if design.FILLS:
        yield "water.fill", {"dry": 0.0, "full": water.fill}.get(water.mode), ()
    given = spread(root.get("water")).get("pressures")
    if not given or given.is_mapping:
        dry = water.mode == "dry" or given
        for name in design.wet_interfaces:
            yield f"water.pressures.{name}", 0.0 if dry else None, ()


# -- names ------------------------------------------------------------------------------------------------------------


def _field(design: Design, path: str, text: str = "") -> Field | None:
    """The field of a path, with what it measures where its unit says so: a crack's water, a part of full, kPa or m."""
    field = field_in(type(design), _root(design), path.replace(".mean.", "."))
    unit = unit_of(text)
    if field is None or unit in ("", "%"):
        return field
    other = next((other for other in field.or_measures if is_unit_of(unit, other)), None)
    return field if other is None else replace(field, measures=other, most=math.inf)


def _root(design: Design) -> Node | None:
    return None if design.source is None else design.source.root


def _key(
    path: str, field: Field | None, value: float | None, given: bool = True, out: tuple[tuple[str, str], ...] = ()
) -> Key:
    assert field is not None
    low, high = field.sought
    return Key(path, field.measures, value, low, high, field.role, field.whole, field.period, given, None, out)


def _number(text: str, kind: str) -> float | None:
    try:
        return quantity(text, kind, "")
    except DesignError:
        return None


def _at(design: Design, path: str) -> Node:
    return NOTHING if design.source is None else design.source.root.at(path)


def _what(node: Node, below: Sequence[str]) -> str:
    if not node or node.is_mapping:
        return "a group"
    if isinstance(node.value, list):
        return f"a list of {len(node.value)}"
    if below and below[0].endswith((".dip", ".trend")):
        return "an orientation"
    return f"the text {node.text!r}"


def _as_number(design: Design, node: Node) -> str:
    """Return the advice for a text that stands where a number may: `50 %` or `full` where metres are meant too."""
    field = _field(design, node.path) if node.text is not None else None
    units = [UNITS[measure] for measure in (field.measures, *field.or_measures)] if field is not None else []
    if not units or not all(units):
        return ""
    return f"Write it in {' or '.join(units)} in the design, then a study can change it."


def listed(names: Sequence[str]) -> str:
    """Names, or the first of them and how many there are."""
    more = f", … ({len(names)} in all)" if len(names) > _MOST_LISTED else ""
    return ", ".join(names[:_MOST_LISTED]) + more


def _nearest(path: str, known: Mapping[str, Key]) -> str:
    """The keys that may have been meant: those that end so, are written nearly so, or stand beside it."""
    above, _, last = path.rpartition(".")
    last = next(iter(nearest(last, {name.rpartition(".")[2] for name in known}, cutoff=0.7)), last)
    path = f"{above}.{last}" if above else last
    ends = [name for name in known if path and f".{path}." in f".{name}."] or nearest(path, known, cutoff=0.8)
    ends = ends or [name for name in known if name.endswith(f".{last}")]
    ends = ends or [name for name in known if name.startswith(f"{path.partition('.')[0]}.")]
    if ends:
        return f"Did you mean {ends[0]}?" if len(ends) == 1 else f"Did you mean one of {listed(ends)}?"
    numbers = [name for name, key in known.items() if key.role == "quantity"]
    missing = "It has no bolts. " if path.startswith("support") else ""
    return f"{missing}There are {listed(numbers)}."


def in_words(key: Key) -> str:
    """A key with what it is now.

    >>> in_words(Key("slope.height", "length", 64.89, 0.001, 1e5))
    'slope.height, now 64.89 m'
    """
    if key.value is None:
        return f"{key.path}, not given now"
    now = "by default" if not key.given else "now"
    return f"{key.path}, {now} {key.shown(key.value)}" + (" (its mean)" if key.scatters is not None else "")
