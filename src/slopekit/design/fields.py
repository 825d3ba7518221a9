"""Every value of a design, declared once: where it stands, what it measures, which values it takes.

A declaration is the metadata of a dataclass field. The structure of design files, the reader and its messages, what may
scatter, the keys of studies with their limits and the key reference of the documentation all follow from it.

>>> from dataclasses import dataclass
>>> @dataclass
... class Seam:
...     dip_deg: float = number("seam.dip", "angle", above=0.0, most=89.9, code="E101", example="45")
...     pairs: int = count("seam.pairs", 3, 2001, code="E137", default=9)
>>> [field.path for field in fields_of(Seam).values()]
['seam.dip', 'seam.pairs']
>>> fields_of(Seam)["dip_deg"].limits_in_words()
'it lies between 0 and 89.9'
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, make_dataclass, replace
from functools import cache
from inspect import get_annotations
from math import inf, isfinite
from typing import Any, Literal, TypeVar, cast

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import number as shown
from slopekit.core.units import quantity, unit_of
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.structure import ANGLES, VALUE, OrientationKind, Spec, either

#: What a number is: of the slope itself, a coordinate, how something scatters, or how the analysis is done.
Role = Literal["quantity", "coordinate", "scatter", "setting"]
#: How a group of keys repeats: as a list, under names, or under names with slashes (B1/B2).
Many = Literal["", "list", "names", "pairs"]
#: What a value is beside a number: its angles, its coordinates, a word of the language, a name of the user's.
NOT_NUMBERS = ("plane", "line", "point", "text", "group")
UNITS: Mapping[str, str] = {
    "length": "m", "volume": "m³", "pressure": "kPa", "unit weight": "kN/m³", "density": "kg/m³", "force": "kN",
    "angle": "°", "stiffness": "kN/m³", "acceleration": "m/s²", "ratio": "",
}  # fmt: skip
#: The least that is more than nothing, and the most that slopes have, by what a number measures.
_LEAST: Mapping[str, float] = {"length": 1e-3, "force": 1e-6, "stiffness": 1.0, "angle": 1e-3}
_MOST: Mapping[str, float] = {"length": 1e5, "pressure": 1e5, "force": 1e9, "stiffness": 1e12, "volume": 1e5}
_JUST_BELOW = 0.01  # degrees: how near to a limit that it does not reach a study takes an angle
_KEY, _PART = "field", "part"
F = TypeVar("F", bound=Callable[..., Any])

#: A judgement of a number in the words of its own subject: value, name, what was written, how keys are called.
Check = Callable[[float, str, str, Callable[[str], str]], tuple[str, str, str] | None]


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Which numbers a value takes: from `least` to `most`, themselves not where `above`, `below`.

    `whole` says that it counts something, `is_odd` in odd numbers; `turns`, that beyond its limits it is the same plane
    or line, written otherwise. What lies beyond, and what is no number, is refused by `code`, in the words of `says`
    and `advice` or of `check`, which judges a number in the words of its own subject.
    """

    least: float = -inf
    most: float = inf
    above: bool = False
    below: bool = False
    whole: bool = False
    is_odd: bool = False
    turns: bool = False
    code: str = "E105"
    says: str = ""
    advice: str = ""
    check: Check | None = None

    def takes(self, value: float) -> bool:
        """Whether a number lies between them."""
        low = value > self.least if self.above else value >= self.least
        high = value < self.most if self.below else value <= self.most
        return low and high and (not self.whole or (value == int(value) and (value % 2 == 1 or not self.is_odd)))


@dataclass(frozen=True, kw_only=True)
class Shape:
    """How a value is written beside a number, a text or a group of keys.

    Attributes
    ----------
    at_least, at_most : entries of a list; forms, without : of a group: other ways to write it, keys that it lacks
    each : a number for all, or one for each as a list or by name
    coordinates : how deep its lists of coordinates are: 1 of a point, 2 of a polygon
    or_measures : what else it measures where its unit says so
    """

    at_least: int = 0
    at_most: int | None = None
    forms: tuple[Spec, ...] = ()
    without: tuple[str, ...] = ()
    each: bool = False
    coordinates: int = 0
    or_measures: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class KeyTexts:
    """What is said of a key.

    Attributes
    ----------
    example, label : as it is written; in words for messages
    axis : in words for axes and reports, where that is another; of an orientation what it is one of
    doc, left_out : what it is, and what is taken where it is left out, for the key reference
    taken : attribute that says what is taken where its own is None
    """

    example: str = ""
    label: str = ""
    axis: str = ""
    doc: str = ""
    left_out: str = ""
    taken: str = ""


@dataclass(frozen=True)
class Field(Limits, Shape, KeyTexts):
    """One value of a design, as `declare` makes it.

    Attributes
    ----------
    path : dotted, within its record; * is a name of the user's or the number of a list item
    measures : a kind of `slopekit.core.units.quantity`, or plane, line, point, text, group
    words : that may stand for a number (`middle`)
    is_required, default : whether it has to be given, else what it is; `may_lack`: other values may stand for it
    scatters : whether a distribution may stand there; role : for studies
    of, many : a group: its record, how it repeats
    is_attribute : of its record; else it is read into others; `is_refused`: known so that the reader can say why not
    """

    path: str
    measures: str = "ratio"
    words: tuple[str, ...] = ()
    is_required: bool = False
    may_lack: bool = False
    default: Any = None
    scatters: bool = True
    role: Role = "quantity"
    of: type | None = None
    many: Many = ""
    is_attribute: bool = False
    is_refused: bool = False

    @property
    def key(self) -> str:
        """The last part of the path."""
        return self.path.rpartition(".")[2]

    @property
    def is_number(self) -> bool:
        """Whether it is one number with a unit."""
        return self.measures not in NOT_NUMBERS

    @property
    def unit(self) -> str:
        """The unit of bare numbers, empty where there is none."""
        return UNITS[self.measures]

    @property
    def in_words(self) -> str:
        """What it is, for messages."""
        return self.label or self.key

    @property
    def period(self) -> float | None:
        """After which it is the same again; None of all but directions."""
        return 360.0 if self.turns and self.most == 360.0 else None

    def limits_in_words(self) -> str:
        """What a value has to be.

        >>> declare("fill", least=0.0, most=1.0).limits_in_words()
        'it lies between 0 and 1'
        >>> declare("height", "length", 0.0, above=True).limits_in_words()
        'it must be more than 0'
        """
        low, high = shown(self.least), shown(self.most)
        if self.says:
            return self.says.format(least=low, most=high)
        if self.whole:
            what = "an odd" if self.is_odd else "a whole"
            return f"it must be {what} number from {int(self.least)} to {int(self.most)}"
        if not isfinite(self.most):
            return f"it must be more than {low}" if self.above else "it is never negative"
        return f"it lies between {low} and {high}"

    def checked(
        self, value: float, name: str, where: str, written: str = "", called: Callable[[str], str] = str
    ) -> float:
        """The value, where it is one that a design takes.

        Parameters
        ----------
        name : what it is, for the message
        where : its place
        written : as the user wrote it; called : how a path is called where it was written

        Raises
        ------
        DesignError
            The field's code, or that of its `check`.
        """
        wrong = None if self.check is None else self.check(value, name, written, called)
        if wrong is not None:
            code, message, advice = wrong
            raise DesignError([Fault(code, message, where, advice)])
        if not self.takes(value):
            unit = "" if self.above and not isfinite(self.most) else self.unit
            size = shown(value) + (unit if unit in ("", "°") else f" {unit}")
            raise DesignError([Fault(self.code, f"{name} is {size}, {self.limits_in_words()}", where, self.advice)])
        return int(value) if self.whole else value

    def read(
        self, value: object, name: str, where: str, written: str = "", called: Callable[[str], str] = str
    ) -> float:
        """The number that a value with a unit says, where it is one that a design takes: see `checked`."""
        return self.checked(quantity(value, self.measures, name, where), name, where, written, called)

    @property
    def sought(self) -> tuple[float, float]:
        """Between what a study looks for it: what it may be, and what slopes have."""
        far = _MOST.get(self.measures, inf)
        low = self.least if isfinite(self.least) else -far
        if (self.above or low > 0.0) and not self.turns:
            low = max(low, _LEAST.get(self.measures, 0.0))
        high = self.most - _JUST_BELOW if self.below and self.measures == "angle" else self.most
        return low, min(high, far)


# -- declaring --------------------------------------------------------------------------------------------------------


def declare(path: str, measures: str = "ratio", least: float = -inf, most: float = inf, **said: Any) -> Field:
    """A field; `said` as its attributes.

    >>> declare("fill", "ratio", 0.0, 1.0, code="E118").most
    1.0
    """
    return Field(path, measures, least=least, most=most, **said)


def _declared(path: str, measures: str, default: Any, *, may_lack: bool = False, **more: Any) -> Any:
    if default is MISSING:
        made = declare(path, measures, is_attribute=True, is_required=not may_lack, may_lack=may_lack, **more)
        return field(metadata={_KEY: made})
    made = declare(path, measures, is_attribute=True, default=default, may_lack=may_lack, **more)
    return field(default=default, metadata={_KEY: made})


def number(
    path: str,
    measures: str,
    *,
    default: Any = MISSING,
    least: float = -inf,
    above: float | None = None,
    most: float = inf,
    below: float | None = None,
    **more: Any,
) -> Any:
    """A number with a unit; `above`, `below` are limits that are not taken themselves. `more` as `Field`."""
    low = least if above is None else above
    given = {"least": low, "most": most if below is None else below, "above": above is not None,
             "below": below is not None} | ({"role": "coordinate"} if low == -inf else {}) | more  # fmt: skip
    return _declared(path, measures, default, **given)


def count(path: str, least: float, most: float, *, default: Any = MISSING, **more: Any) -> Any:
    """A whole number, which cannot scatter."""
    given = {"code": "E137", "role": "setting"} | more
    return _declared(path, "ratio", default, least=least, most=most, whole=True, scatters=False, **given)


def orientation(path: str, of: OrientationKind = "plane", *, default: Any = MISSING, **more: Any) -> Any:
    """A plane (dip / dip direction) or a line (trend / plunge)."""
    return _declared(path, of, default, **more)


def point(path: str, *, default: Any = MISSING, **more: Any) -> Any:
    """East, north, up in m."""
    given = {"example": "[0, -3, 6]"} | more
    return _declared(path, "point", default, role="coordinate", coordinates=1, **given)


def text(path: str, *, default: Any = MISSING, **more: Any) -> Any:
    """A word: a name, a file, one of `words`."""
    return _declared(path, "text", default, **more)


def group(path: str, of: type | None = None, *, default: Any = MISSING, **more: Any) -> Any:
    """A record of its own, or many of them; `forms` are other ways of writing one."""
    return _declared(path, "group", default, of=of, **more)


def keys_of(name: str, *declared: Field) -> type:
    """A group of keys that are read into attributes of other records."""
    return make_dataclass(name, (), namespace={"ALSO": declared})


def part(of: type) -> Any:
    """A record that holds some of the fields of its holder, whose paths are those from the holder."""
    return field(default=of(), metadata={_PART: of})


def _remembered(function: F) -> F:
    """`functools.cache` that keeps the signature."""
    return cast(F, cache(function))


# -- looking up -------------------------------------------------------------------------------------------------------


@_remembered
def parts_of(record: Any) -> Mapping[str, type]:
    """The records that hold some of the fields of a dataclass, by attribute: `rock` and `analysis` of a design."""
    return {one.name: one.metadata[_PART] for one in fields(record) if _PART in one.metadata}


def value_of(record: Any, name: str) -> Any:
    """The value of a declared field by its name, of a record or of the part that holds it."""
    part = next((part for part, of in parts_of(type(record)).items() if name in fields_of(of)), None)
    return getattr(record if part is None else getattr(record, part), name)


def with_parts(record: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of the declared fields of a dataclass by name, put into its parts as its constructor takes them."""
    given = dict(values)
    for name, of in parts_of(record).items():
        given[name] = of(**{own: given.pop(own) for own in fields_of(of) if own in given})
    return given


@_remembered
def fields_of(record: Any) -> Mapping[str, Field]:
    """The declared fields of a dataclass by attribute, its own before those that it inherits.

    `ALSO` of a class are keys that are read into attributes of other names, `WITHOUT` keys that it lacks.
    """
    also: dict[str, Field] = {}
    for one in reversed(record.__mro__):
        also |= {made.path: made for made in one.__dict__.get("ALSO", ())}
    held = {name: fields_of(of) for name, of in parts_of(record).items()}
    held |= {one.name: {one.name: one.metadata[_KEY]} for one in fields(record) if _KEY in one.metadata}
    declared = {name: made for one in fields(record) for name, made in held.get(one.name, {}).items()}
    own = [name for one in get_annotations(record) for name in held.get(one, ())]
    order = {name: (declared | also)[name] for name in (*own, *also, *declared)}
    without = set(getattr(record, "WITHOUT", ()))
    return {name: one for name, one in order.items() if without.isdisjoint((one.path, one.path.partition(".")[0]))}


def _angle(above: Field, key: str) -> Field:
    low, high = {"dip": (0.0, 90.0), "plunge": (-90.0, 90.0)}.get(key, (0.0, 360.0))
    of = f" of {above.axis}" if above.axis else ""
    return replace(above, path=f"{above.path}.{key}", measures="angle", least=low, most=high, turns=True, label="",
                   axis=f"{key.replace('_', ' ')}{of}")  # fmt: skip


def every_field(record: Any, path: str = "") -> Iterator[Field]:
    """All fields of a record and of the groups in it, by their full paths; planes and lines by their angles too."""
    more = getattr(record, "more_fields", None)
    for one in (*fields_of(record).values(), *(() if more is None else more())):
        own = replace(one, path=f"{path}.{one.path}" if path else one.path)
        yield own
        if one.measures in ANGLES:
            angles = ANGLES[one.measures]
            yield from (_angle(own, key) for key in angles)
        if one.is_number and (one.many or one.each):
            yield replace(own, path=f"{own.path}.*")
        if one.coordinates:
            measures = one.measures if one.is_number else next(iter(one.or_measures), "length")
            below = own.path + ".*" * one.coordinates
            yield replace(own, path=below, measures=measures, role="coordinate", coordinates=0, scatters=False)
        if one.of is not None:
            below = own.path + {"": "", "list": ".*", "names": ".*", "pairs": ".*"}[one.many]
            yield from (part for part in every_field(one.of, below) if part.key not in one.without)


@_remembered
def _paths(record: Any) -> Mapping[tuple[str, ...], Field]:
    numbers = (one for one in every_field(record) if one.is_number and (not one.many or one.path.endswith("*")))
    return {tuple(one.path.split(".")): one for one in numbers}


@_remembered
def field_at(record: Any, path: str) -> Field | None:
    """The number that stands at a dotted path of a design; None where there is none.

    Parameters
    ----------
    record : the dataclass of the design

    >>> from slopekit.design.common import Design
    >>> field_at(Design, "strength.weak.phi").measures
    'angle'
    """
    parts = ("correlation", "*") if path.startswith("correlation.") else tuple(path.split("."))
    known = _paths(record)
    if parts in known:
        return known[parts]
    fitting = [
        (names.count("*"), one) for names, one in known.items()
        if len(names) == len(parts) and all(name in ("*", part) for name, part in zip(names, parts, strict=True))
    ]  # fmt: skip
    return min(fitting, key=lambda pair: pair[0])[1] if fitting else None


def field_in(record: Any, root: Node | None, path: str) -> Field | None:
    """The number that stands at a dotted path of a design with this tree; of a strength, as the law it names has it.

    `field_at` knows the kind of a design alone: two laws may have a key of one name with limits of their own.
    """
    parts = path.split(".")
    law = NOTHING if root is None or len(parts) != 3 else root.at(f"strength.{parts[1]}.law")
    if law and parts[0] == "strength":
        from slopekit.design.strength_laws import key_of_law  # most designs name no law

        declared = key_of_law(law.text, parts[2])
        if declared is not None:
            return replace(declared, path=f"strength.*.{parts[2]}")
    return field_at(record, path)


#: What an item is called, of lists that have no names.
_LISTED = {"bolts": "bolt", "forces": "force"}
_SHORT = 2  # spaces in what a number is, that "of" may follow
#: What the numbers of a distribution are, in words.
_OF_SCATTER = {"mean": "mean", "sd": "standard deviation of", "min": "least", "max": "largest", "mode": "mode of"}


def words_of(record: Any, path: str) -> str:
    """A number by its dotted path as axes and reports have it: what it is, and of what; the path where it is none.

    >>> from slopekit.kinds.wedge.design import WedgeDesign
    >>> words_of(WedgeDesign, "strength.weak.phi"), words_of(WedgeDesign, "slope.upper.dip")
    ('friction angle of weak', 'dip of the upper slope')
    >>> words_of(WedgeDesign, "support.bolts.0.force"), words_of(WedgeDesign, "slope.height.sd")
    ('force of bolt 1', 'standard deviation of height of the slope')
    """
    path = path.replace(".mean.", ".")
    above, _, last = path.rpartition(".")
    declared = field_at(record, path)
    if declared is None:
        angle = next((angle for angle in ("dip", "plunge") if field_at(record, f"{above}.{angle}") is not None), "")
        if last == "k" and angle:
            return f"concentration of {words_of(record, f'{above}.{angle}').removeprefix(f'{angle} of ')}"
        known = last in _OF_SCATTER and field_at(record, above) is not None
        return f"{_OF_SCATTER[last]} {words_of(record, above)}" if known else path
    names, numbers = declared.path.split("."), list[int]()
    parts = path.split(".", 1 if names[0] == "correlation" else -1)
    while names[-1] == "*" and parts[-1].isdigit():  # of a list of numbers, of a point
        numbers.insert(0, int(parts.pop()) + 1)
        names.pop()
    what = next(name for name in reversed(names) if name != "*").replace("_", " ")
    said = declared.axis or declared.label.format(k=str(numbers[:1])[1:-1]).replace("_", " ") or what
    first = names.index("*") if "*" in names else 0
    if first:
        own, item = parts[first], _LISTED.get(parts[first - 1])
        own = f"{item} {int(own) + 1}" if item and own.isdigit() else own
        said += f"{', ' if ' of ' in said or said.count(' ') > _SHORT else ' of '}{own}"
    elif len(parts) > 1 and not (declared.axis or declared.label) and (declared.role == "quantity" or numbers):
        said += f" of the {parts[-2].replace('_', ' ')}"
    if not numbers or "{k}" in declared.label:
        return said
    each = ("point", "coordinate") if declared.role == "coordinate" else ("number", "number")
    return said + "".join(f", {one} {k}" for one, k in zip(each[-len(numbers) :], numbers, strict=True))


# -- the structure of a design file -----------------------------------------------------------------------------------


@_remembered
def record_spec(record: Any, required: tuple[str, ...] = (), without: tuple[str, ...] = ()) -> Spec:
    """Which keys a record may have: what `check_structure` goes by.

    Parameters
    ----------
    required : top keys that must be there beside those of required fields
    """
    more = getattr(record, "more_fields", None)
    every = (*fields_of(record).values(), *(() if more is None else more()))
    parts = [([part for part in one.path.split(".") if part != "*"], one) for one in every if one.path not in without]
    needed = dict.fromkeys((*required, *(path[0] for path, one in parts if one.is_required)))
    group = _section(parts)  # an example of one key of many would be taken for all that is needed
    return replace(group, required=tuple(needed), example=group.example if group.required else "")


def _section(parts: Sequence[tuple[Sequence[str], Field]]) -> Spec:
    """The group of keys of fields with the parts of their paths in it: a key may be a field, and hold further ones."""
    members: dict[str, list[tuple[Sequence[str], Field]]] = {}
    for (key, *below), one in parts:
        members.setdefault(key, []).append((below, one))
    keys, required, examples = dict[str, Spec](), list[str](), dict[str, str]()
    for key, fields_below in members.items():
        inner = _section([(below, one) for below, one in fields_below if below])
        keys[key] = inner
        for one in [one for below, one in fields_below if not below]:
            spec = _spec(one)
            keys[key] = replace(spec, keys={**spec.keys, **inner.keys}) if inner.keys else spec
            required += [key] if one.is_required else []
            examples |= {key: f"{key}: {one.example}"} if one.example else {}
    shown_ones = [examples[key] for key in required if key in examples] or list(examples.values())[:1]
    return Spec(keys=keys, required=tuple(required), example=f"{{{', '.join(shown_ones)}}}" if shown_ones else "")


def _spec(one: Field) -> Spec:
    """What may stand at the key of a field."""
    forms = one.forms if one.many not in ("names", "pairs") else ()
    if one.measures in ANGLES:
        return orientation_spec(one)
    if one.measures == "point":
        return Spec(items=VALUE, at_least=3, at_most=3, example=one.example)
    spec = Spec()
    if one.is_number:
        spec = Spec("number" if one.scatters else "value")
    elif one.of is None and not one.forms:
        spec = VALUE
    own = Spec() if one.of is None else record_spec(one.of, without=one.without)
    spec = either(spec, *forms, own)
    if one.each:
        spec = replace(spec, names=spec, items=spec, at_least=1)
    elif one.many == "list":
        spec = Spec(items=spec, at_least=one.at_least, at_most=one.at_most)
    elif one.many:
        spec = Spec(names=spec, at_least=one.at_least, pairs=one.many == "pairs")
        spec = either(spec, *one.forms)
    return replace(spec, example=one.example) if one.example else spec


def orientation_spec(one: Field) -> Spec:
    """Two angles with a slash, a pair, a distribution, or the two angles by name, each a number or a distribution."""
    of: OrientationKind = "plane" if one.measures == "plane" else "line"
    first, _, second = one.example.partition("/")
    examples = (first, second) if of == "plane" else (second, first)
    angles = {key: Spec("number", example=value) for key, value in zip(ANGLES[of], examples, strict=True)}
    return Spec("orientation", keys=angles, required=ANGLES[of], example=one.example)


# -- checks that several fields share ---------------------------------------------------------------------------------

_DEGREES = ("deg", "°", "degrees", "rad")


def in_degrees(value: float, name: str, written: str, called: Callable[[str], str]) -> tuple[str, str, str] | None:
    """E113: a friction angle that was written in radians; who writes the unit means it."""
    from math import degrees, pi

    if not 0.0 < value < pi / 2 or value == int(value) or unit_of(written) in _DEGREES:
        return None
    advice = f"{shown(value)} rad is {degrees(value):.1f}°; write {shown(value)} deg if degrees are meant."
    return "E113", f"{name} is {shown(value)}°, that looks like radians", advice


def more_than_nothing(
    value: float, name: str, written: str, called: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """E116: a size of a block."""
    return None if value > 0.0 else ("E116", f"{name} is {shown(value)}, it must be more than 0", "")
