"""Every value of a design file, declared once: its key, the quantity it measures and the values it may have.

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
from math import degrees, inf, isfinite, pi
from typing import Any, Literal, TypeVar, cast

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import number as number_text
from slopekit.core.units import quantity, unit_of
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.structure import ANGLES, VALUE, OrientationKind, Spec, either

#: What a number describes: the slope itself, a coordinate, a distribution, or a setting of the analysis.
Role = Literal["quantity", "coordinate", "scatter", "setting"]
#: How a group of keys repeats: as a list, under names, or under names with slashes (B1/B2).
Many = Literal["", "list", "names", "pairs"]
#: Values that are no single number: orientations, coordinates, texts (a word of the language or a user's name), groups.
NOT_NUMBERS = ("plane", "line", "point", "text", "group")
UNITS: Mapping[str, str] = {
    "length": "m",
    "volume": "m³",
    "pressure": "kPa",
    "unit weight": "kN/m³",
    "density": "kg/m³",
    "force": "kN",
    "angle": "°",
    "stiffness": "kN/m³",
    "acceleration": "m/s²",
    "ratio": "",
}
#: Smallest positive and largest values that a study searches, by what a number measures (units as in UNITS).
_LEAST: Mapping[str, float] = {"length": 1e-3, "force": 1e-6, "stiffness": 1.0, "angle": 1e-3}
_MOST: Mapping[str, float] = {
    "length": 1e5,
    "pressure": 1e5,
    "force": 1e9,
    "stiffness": 1e12,
    "volume": 1e5,
}
_ANGLE_GAP_DEG = (
    0.01  # how near a study goes to the limit of an angle that the limit itself is excluded from
)
_KEY, _PART = "field", "part"
F = TypeVar("F", bound=Callable[..., Any])

#: A check with messages of its own. Arguments: value, name, text as written, and a function from a key's path to the
#: name under which the user writes it. Returns code, message and advice of the fault, or None.
Check = Callable[[float, str, str, Callable[[str], str]], tuple[str, str, str] | None]


@dataclass(frozen=True, kw_only=True)
class Limits:
    """The interval of numbers that a value may have, and the message for a number outside it.

    The interval runs from `least` to `most`; `above` and `below` exclude these limits themselves. `is_integer` allows
    integers only, `is_odd` odd ones only; `turns` marks an angle for which a value beyond the limits is another way to
    write the same plane or line. The fault has the code `code` and the texts `says` and `advice`, unless `check`
    returns a fault with a text of its own.
    """

    least: float = -inf
    most: float = inf
    above: bool = False
    below: bool = False
    is_integer: bool = False
    is_odd: bool = False
    turns: bool = False
    code: str = "E105"
    says: str = ""
    advice: str = ""
    check: Check | None = None

    def takes(self, value: float) -> bool:
        """Return whether a number lies within these limits."""
        low = value > self.least if self.above else value >= self.least
        high = value < self.most if self.below else value <= self.most
        return (
            low
            and high
            and (
                not self.is_integer or (value == int(value) and (value % 2 == 1 or not self.is_odd))
            )
        )


@dataclass(frozen=True, kw_only=True)
class Shape:
    """The forms in which a design file may write a value, besides a single number, a text or a group of keys.

    Attributes
    ----------
    at_least, at_most : bounds of the number of entries of a list
    forms, omitted_keys : of a group: other ways to write it; keys that it does not have
    per_interface : whether it is one number for all interfaces, or a number per interface as a list or by name
    coordinates : nesting depth of its lists of coordinates: 1 of a point, 2 of a polygon
    or_measures : other quantities that it may measure; the unit written with the value decides
    """

    at_least: int = 0
    at_most: int | None = None
    forms: tuple[Spec, ...] = ()
    omitted_keys: tuple[str, ...] = ()
    per_interface: bool = False
    coordinates: int = 0
    or_measures: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class KeyTexts:
    """The texts about a key, for messages, axes and the key reference.

    Attributes
    ----------
    example, label : an example as a design file has it; the name in messages
    axis : the name on axes and in reports, where it differs from `label`; of an orientation the surface it belongs to
    doc, left_out : the description and the default, for the key reference
    value_attribute : attribute that holds the value in use where the field's own attribute is None
    """

    example: str = ""
    label: str = ""
    axis: str = ""
    doc: str = ""
    left_out: str = ""
    value_attribute: str = ""


@dataclass(frozen=True)
class Field(Limits, Shape, KeyTexts):
    """The declaration of one value of a design, as `declare` makes it.

    Attributes
    ----------
    path : dotted path within its record; * stands for a user's name or the number of a list item
    measures : a kind of `slopekit.core.units.quantity`, or plane, line, point, text, group
    words : texts allowed instead of a number (`middle`)
    is_required, default : whether the key is required, else its default
    may_lack : whether the key may be missing because other keys can replace it
    scatters : whether a distribution is allowed
    role : what the number describes, for studies
    record_type, many : of a group: its record, and how it repeats
    is_attribute : whether the record has an attribute of this name; else the key is read into other attributes
    is_refused : whether the key is known only to explain why it is refused
    """

    path: str
    measures: str = "ratio"
    words: tuple[str, ...] = ()
    is_required: bool = False
    may_lack: bool = False
    default: Any = None
    scatters: bool = True
    role: Role = "quantity"
    record_type: type | None = None
    many: Many = ""
    is_attribute: bool = False
    is_refused: bool = False

    @property
    def key(self) -> str:
        """The last key of the path."""
        return self.path.rpartition(".")[2]

    @property
    def is_number(self) -> bool:
        """Whether the value is a single number with a unit."""
        return self.measures not in NOT_NUMBERS

    @property
    def unit(self) -> str:
        """The unit of a number written without one; empty where the quantity has none."""
        return UNITS[self.measures]

    @property
    def in_words(self) -> str:
        """The name of the value in messages."""
        return self.label or self.key

    @property
    def period(self) -> float | None:
        """The period of a direction in degrees (360); None for any other value."""
        return 360.0 if self.turns and self.most == 360.0 else None

    def limits_in_words(self) -> str:
        """Return the clause of a message that states the limits of this value.

        >>> declare("fill", least=0.0, most=1.0).limits_in_words()
        'it lies between 0 and 1'
        >>> declare("height", "length", 0.0, above=True).limits_in_words()
        'it must be more than 0'
        """
        low, high = number_text(self.least), number_text(self.most)
        if self.says:
            return self.says.format(least=low, most=high)
        if self.is_integer:
            number_kind = "an odd" if self.is_odd else "a whole"
            return f"it must be {number_kind} number from {int(self.least)} to {int(self.most)}"
        if not isfinite(self.most):
            return f"it must be more than {low}" if self.above else "it is never negative"
        return f"it lies between {low} and {high}"

    def checked(
        self,
        value: float,
        name: str,
        location: str,
        written: str = "",
        written_key: Callable[[str], str] = str,
    ) -> float:
        """Return the value if it lies within the limits of this field; an integer if the field counts something.

        Parameters
        ----------
        name : the value's name in the message
        location : line of the file, or option, that the fault points to
        written : the value as the user wrote it
        written_key : gives the name under which the user writes the key of a path

        Raises
        ------
        DesignError
            The field's code, or that of its `check`.
        """
        wrong = None if self.check is None else self.check(value, name, written, written_key)
        if wrong is not None:
            code, message, advice = wrong
            raise DesignError([Fault(code, message, location, advice)])
        if not self.takes(value):
            unit = "" if self.above and not isfinite(self.most) else self.unit
            size = number_text(value) + (unit if unit in ("", "°") else f" {unit}")
            raise DesignError(
                [
                    Fault(
                        self.code,
                        f"{name} is {size}, {self.limits_in_words()}",
                        location,
                        self.advice,
                    )
                ]
            )
        return int(value) if self.is_integer else value

    def read(
        self,
        value: object,
        name: str,
        location: str,
        written: str = "",
        written_key: Callable[[str], str] = str,
    ) -> float:
        """Convert a value with a unit to a number in the field's unit and check its limits as `checked` does."""
        return self.checked(
            quantity(value, self.measures, name, location), name, location, written, written_key
        )

    @property
    def sought(self) -> tuple[float, float]:
        """The interval that a study searches: the limits of the field, cut to sizes that real slopes have."""
        largest = _MOST.get(self.measures, inf)
        low = self.least if isfinite(self.least) else -largest
        if (self.above or low > 0.0) and not self.turns:
            low = max(low, _LEAST.get(self.measures, 0.0))
        high = self.most - _ANGLE_GAP_DEG if self.below and self.measures == "angle" else self.most
        return low, min(high, largest)


# -- declaring --------------------------------------------------------------------------------------------------------


def declare(
    path: str, measures: str = "ratio", least: float = -inf, most: float = inf, **attributes: Any
) -> Field:
    """Declare a field; `attributes` are those of `Field`.

    >>> declare("fill", "ratio", 0.0, 1.0, code="E118").most
    1.0
    """
    return Field(path, measures, least=least, most=most, **attributes)


def _declared(
    path: str, measures: str, default: Any, *, may_lack: bool = False, **attributes: Any
) -> Any:
    if default is MISSING:
        declaration = declare(
            path,
            measures,
            is_attribute=True,
            is_required=not may_lack,
            may_lack=may_lack,
            **attributes,
        )
        return field(metadata={_KEY: declaration})
    declaration = declare(
        path, measures, is_attribute=True, default=default, may_lack=may_lack, **attributes
    )
    return field(default=default, metadata={_KEY: declaration})


def number(
    path: str,
    measures: str,
    *,
    default: Any = MISSING,
    least: float = -inf,
    above: float | None = None,
    most: float = inf,
    below: float | None = None,
    **overrides: Any,
) -> Any:
    """Declare a number with a unit; `above`, `below` are limits that are excluded. `overrides`: as of `Field`."""
    low = least if above is None else above
    attributes = (
        {
            "least": low,
            "most": most if below is None else below,
            "above": above is not None,
            "below": below is not None,
        }
        | ({"role": "coordinate"} if low == -inf else {})
        | overrides
    )
    return _declared(path, measures, default, **attributes)


def count(path: str, least: float, most: float, *, default: Any = MISSING, **overrides: Any) -> Any:
    """Declare an integer, which cannot have a distribution."""
    attributes = {"code": "E137", "role": "setting"} | overrides
    return _declared(
        path,
        "ratio",
        default,
        least=least,
        most=most,
        is_integer=True,
        scatters=False,
        **attributes,
    )


def orientation(
    path: str, kind: OrientationKind = "plane", *, default: Any = MISSING, **overrides: Any
) -> Any:
    """Declare a plane (dip / dip direction) or a line (trend / plunge), in degrees."""
    return _declared(path, kind, default, **overrides)


def point(path: str, *, default: Any = MISSING, **overrides: Any) -> Any:
    """Declare a point: east, north, up in m."""
    attributes = {"example": "[0, -3, 6]"} | overrides
    return _declared(path, "point", default, role="coordinate", coordinates=1, **attributes)


def text(path: str, *, default: Any = MISSING, **overrides: Any) -> Any:
    """Declare a text: a name, a file, or one of `words`."""
    return _declared(path, "text", default, **overrides)


def group(
    path: str, record_type: type | None = None, *, default: Any = MISSING, **overrides: Any
) -> Any:
    """Declare a group of keys that is read into a record, or several of them; `forms` are other ways to write it."""
    return _declared(path, "group", default, record_type=record_type, **overrides)


def keys_of(name: str, *declared: Field) -> type:
    """Return a record type for a group of keys whose values are read into attributes of other records."""
    return make_dataclass(name, (), namespace={"EXTRA_KEYS": declared})


def nested_record(record_type: type) -> Any:
    """Declare an attribute whose record holds some of the keys of its holder; their paths start at the holder."""
    return field(default=record_type(), metadata={_PART: record_type})


def _cached(function: F) -> F:
    """Cache a function as `functools.cache` does, but keep its signature for type checkers."""
    return cast(F, cache(function))


# -- looking up -------------------------------------------------------------------------------------------------------


@_cached
def nested_records(record: Any) -> Mapping[str, type]:
    """Return the nested record types of a dataclass by attribute: `rock` and `analysis` of a design."""
    return {
        attribute.name: attribute.metadata[_PART]
        for attribute in fields(record)
        if _PART in attribute.metadata
    }


def value_of(record: Any, name: str) -> Any:
    """Return the value of a declared field by its name, from the record itself or from its nested records."""
    attribute = next(
        (
            attribute
            for attribute, record_type in nested_records(type(record)).items()
            if name in fields_of(record_type)
        ),
        None,
    )
    return getattr(record if attribute is None else getattr(record, attribute), name)


def with_nested_records(record: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keyword arguments of a dataclass's constructor: `values` by field, grouped into its nested records."""
    arguments = dict(values)
    for name, record_type in nested_records(record).items():
        arguments[name] = record_type(
            **{
                field_name: arguments.pop(field_name)
                for field_name in fields_of(record_type)
                if field_name in arguments
            }
        )
    return arguments


@_cached
def fields_of(record: Any) -> Mapping[str, Field]:
    """Return the declared fields of a dataclass by attribute, its own before the inherited ones.

    `EXTRA_KEYS` of a class adds keys that are read into attributes of other names, `WITHOUT` removes inherited keys.
    """
    extra_keys: dict[str, Field] = {}
    for base in reversed(record.__mro__):
        extra_keys |= {
            declaration.path: declaration for declaration in base.__dict__.get("EXTRA_KEYS", ())
        }
    declared_of_attribute = {
        name: fields_of(record_type) for name, record_type in nested_records(record).items()
    }
    declared_of_attribute |= {
        attribute.name: {attribute.name: attribute.metadata[_KEY]}
        for attribute in fields(record)
        if _KEY in attribute.metadata
    }
    declared = {
        name: declaration
        for attribute in fields(record)
        for name, declaration in declared_of_attribute.get(attribute.name, {}).items()
    }
    annotated = [
        name
        for attribute in get_annotations(record)
        for name in declared_of_attribute.get(attribute, ())
    ]
    order = {name: (declared | extra_keys)[name] for name in (*annotated, *extra_keys, *declared)}
    omitted_paths = set(getattr(record, "WITHOUT", ()))
    return {
        name: declaration
        for name, declaration in order.items()
        if omitted_paths.isdisjoint((declaration.path, declaration.path.partition(".")[0]))
    }


def _angle(orientation_field: Field, key: str) -> Field:
    low, high = {"dip": (0.0, 90.0), "plunge": (-90.0, 90.0)}.get(key, (0.0, 360.0))
    subject = f" of {orientation_field.axis}" if orientation_field.axis else ""
    return replace(
        orientation_field,
        path=f"{orientation_field.path}.{key}",
        measures="angle",
        least=low,
        most=high,
        turns=True,
        label="",
        axis=f"{key.replace('_', ' ')}{subject}",
    )


def every_field(record: Any, path: str = "") -> Iterator[Field]:
    """Yield the fields of a record and of its groups with their full paths; planes and lines also by their angles."""
    law_fields = getattr(record, "more_fields", None)
    for declaration in (*fields_of(record).values(), *(() if law_fields is None else law_fields())):
        full_declaration = replace(
            declaration, path=f"{path}.{declaration.path}" if path else declaration.path
        )
        yield full_declaration
        if declaration.measures in ANGLES:
            angles = ANGLES[declaration.measures]
            yield from (_angle(full_declaration, key) for key in angles)
        if declaration.is_number and (declaration.many or declaration.per_interface):
            yield replace(full_declaration, path=f"{full_declaration.path}.*")
        if declaration.coordinates:
            measures = (
                declaration.measures
                if declaration.is_number
                else next(iter(declaration.or_measures), "length")
            )
            member_path = full_declaration.path + ".*" * declaration.coordinates
            yield replace(
                full_declaration,
                path=member_path,
                measures=measures,
                role="coordinate",
                coordinates=0,
                scatters=False,
            )
        if declaration.record_type is not None:
            member_path = (
                full_declaration.path
                + {"": "", "list": ".*", "names": ".*", "pairs": ".*"}[declaration.many]
            )
            yield from (
                member
                for member in every_field(declaration.record_type, member_path)
                if member.key not in declaration.omitted_keys
            )


@_cached
def _paths(record: Any) -> Mapping[tuple[str, ...], Field]:
    numbers = (
        declaration
        for declaration in every_field(record)
        if declaration.is_number and (not declaration.many or declaration.path.endswith("*"))
    )
    return {tuple(declaration.path.split(".")): declaration for declaration in numbers}


@_cached
def field_at(record: Any, path: str) -> Field | None:
    """Return the declaration of the number at a dotted path of a design; None where the path is no number.

    Parameters
    ----------
    record : the dataclass of the design

    >>> from slopekit.design.common import Design
    >>> field_at(Design, "strength.weak.phi").measures
    'angle'
    """
    keys = ("correlation", "*") if path.startswith("correlation.") else tuple(path.split("."))
    numbers = _paths(record)
    if keys in numbers:
        return numbers[keys]
    fitting = [
        (names.count("*"), declaration)
        for names, declaration in numbers.items()
        if len(names) == len(keys)
        and all(name in ("*", key) for name, key in zip(names, keys, strict=True))
    ]
    return min(fitting, key=lambda pair: pair[0])[1] if fitting else None


def field_in(record: Any, root: Node | None, path: str) -> Field | None:
    """Return the declaration of the number at a dotted path, for a strength that of the strength law in `root`.

    `field_at` knows only the kind of design; two strength laws may have the same key with different limits.
    """
    keys = path.split(".")
    law = NOTHING if root is None or len(keys) != 3 else root.find(f"strength.{keys[1]}.law")
    if law and keys[0] == "strength":
        from slopekit.design.strength_laws import key_of_law  # most designs name no law

        declared = key_of_law(law.text, keys[2])
        if declared is not None:
            return replace(declared, path=f"strength.*.{keys[2]}")
    return field_at(record, path)


#: The word for an entry, of lists whose entries have no names.
_LIST_ENTRY_WORDS = {"bolts": "bolt", "forces": "force"}
_MAX_SPACES_BEFORE_OF = 2  # a label with more spaces is followed by a comma, not by "of"
#: The parameters of a distribution, in words.
_DISTRIBUTION_WORDS = {
    "mean": "mean",
    "sd": "standard deviation of",
    "min": "least",
    "max": "largest",
    "mode": "mode of",
}


def words_of(record: Any, path: str) -> str:
    """Return the label of a number on axes and in reports, by its dotted path; the path itself if it is no number.

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
        angle = next(
            (
                angle
                for angle in ("dip", "plunge")
                if field_at(record, f"{above}.{angle}") is not None
            ),
            "",
        )
        if last == "k" and angle:
            return f"concentration of {words_of(record, f'{above}.{angle}').removeprefix(f'{angle} of ')}"
        is_known = last in _DISTRIBUTION_WORDS and field_at(record, above) is not None
        return f"{_DISTRIBUTION_WORDS[last]} {words_of(record, above)}" if is_known else path
    names, numbers = declared.path.split("."), list[int]()
    keys = path.split(".", 1 if names[0] == "correlation" else -1)
    while names[-1] == "*" and keys[-1].isdigit():  # of a list of numbers, of a point
        numbers.insert(0, int(keys.pop()) + 1)
        names.pop()
    last_name = next(name for name in reversed(names) if name != "*").replace("_", " ")
    label = (
        declared.axis
        or declared.label.format(k=str(numbers[:1])[1:-1]).replace("_", " ")
        or last_name
    )
    first = names.index("*") if "*" in names else 0
    if first:
        owner, item = keys[first], _LIST_ENTRY_WORDS.get(keys[first - 1])
        owner = f"{item} {int(owner) + 1}" if item and owner.isdigit() else owner
        label += f"{', ' if ' of ' in label or label.count(' ') > _MAX_SPACES_BEFORE_OF else ' of '}{owner}"
    elif (
        len(keys) > 1
        and not (declared.axis or declared.label)
        and (declared.role == "quantity" or numbers)
    ):
        label += f" of the {keys[-2].replace('_', ' ')}"
    if not numbers or "{k}" in declared.label:
        return label
    coordinate_words = (
        ("point", "coordinate") if declared.role == "coordinate" else ("number", "number")
    )
    return label + "".join(
        f", {word} {k}" for word, k in zip(coordinate_words[-len(numbers) :], numbers, strict=True)
    )


# -- the structure of a design file -----------------------------------------------------------------------------------


@_cached
def record_spec(
    record: Any, required: tuple[str, ...] = (), omitted_paths: tuple[str, ...] = ()
) -> Spec:
    """Return the specification of the keys that a record may have, for `check_structure`.

    Parameters
    ----------
    required : top-level keys that are required in addition to those of required fields
    omitted_paths : paths of fields that the record does not have here
    """
    law_fields = getattr(record, "more_fields", None)
    declarations = (*fields_of(record).values(), *(() if law_fields is None else law_fields()))
    key_paths = [
        ([key for key in declaration.path.split(".") if key != "*"], declaration)
        for declaration in declarations
        if declaration.path not in omitted_paths
    ]
    needed = dict.fromkeys(
        (*required, *(path[0] for path, declaration in key_paths if declaration.is_required))
    )
    group = _section(
        key_paths
    )  # no example for an optional group: it would read as if that key were required
    return replace(group, required=tuple(needed), example=group.example if group.required else "")


def _section(key_paths: Sequence[tuple[Sequence[str], Field]]) -> Spec:
    """Return the specification of a group of keys from the paths (split at dots) and declarations of its fields."""
    members: dict[str, list[tuple[Sequence[str], Field]]] = {}
    for (key, *below), declaration in key_paths:
        members.setdefault(key, []).append((below, declaration))
    keys, required, examples = dict[str, Spec](), list[str](), dict[str, str]()
    for key, fields_below in members.items():
        inner = _section([(below, declaration) for below, declaration in fields_below if below])
        keys[key] = inner
        for declaration in [declaration for below, declaration in fields_below if not below]:
            spec = _spec(declaration)
            keys[key] = replace(spec, keys={**spec.keys, **inner.keys}) if inner.keys else spec
            required += [key] if declaration.is_required else []
            examples |= {key: f"{key}: {declaration.example}"} if declaration.example else {}
    entries = [examples[key] for key in required if key in examples] or list(examples.values())[:1]
    return Spec(
        keys=keys,
        required=tuple(required),
        example=f"{{{', '.join(entries)}}}" if entries else "",
    )


def _spec(declaration: Field) -> Spec:
    """Return the specification of what a design file may write at the key of a field."""
    forms = declaration.forms if declaration.many not in ("names", "pairs") else ()
    if declaration.measures in ANGLES:
        return orientation_spec(declaration)
    if declaration.measures == "point":
        return Spec(items=VALUE, at_least=3, at_most=3, example=declaration.example)
    spec = Spec()
    if declaration.is_number:
        spec = Spec("number" if declaration.scatters else "value")
    elif declaration.record_type is None and not declaration.forms:
        spec = VALUE
    record_keys = (
        Spec()
        if declaration.record_type is None
        else record_spec(declaration.record_type, omitted_paths=declaration.omitted_keys)
    )
    spec = either(spec, *forms, record_keys)
    if declaration.per_interface:
        spec = replace(spec, names=spec, items=spec, at_least=1)
    elif declaration.many == "list":
        spec = Spec(items=spec, at_least=declaration.at_least, at_most=declaration.at_most)
    elif declaration.many:
        spec = Spec(names=spec, at_least=declaration.at_least, pairs=declaration.many == "pairs")
        spec = either(spec, *declaration.forms)
    return replace(spec, example=declaration.example) if declaration.example else spec


def orientation_spec(declaration: Field) -> Spec:
    """Return the specification of an orientation: `45/115`, a pair, a distribution, or the two angles by name."""
    kind: OrientationKind = "plane" if declaration.measures == "plane" else "line"
    first, _, second = declaration.example.partition("/")
    examples = (first, second) if kind == "plane" else (second, first)
    angles = {
        key: Spec("number", example=value)
        for key, value in zip(ANGLES[kind], examples, strict=True)
    }
    return Spec("orientation", keys=angles, required=ANGLES[kind], example=declaration.example)


# -- checks that several fields share ---------------------------------------------------------------------------------

_DEGREES = ("deg", "°", "degrees", "rad")


def in_degrees(
    value: float, name: str, written: str, written_key: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """Return fault E113 for an angle that looks like radians, unless its unit is written."""
    if not 0.0 < value < pi / 2 or value == int(value) or unit_of(written) in _DEGREES:
        return None
    advice = f"{number_text(value)} rad is {degrees(value):.1f}°; write {number_text(value)} deg if degrees are meant."
    return "E113", f"{name} is {number_text(value)}°, that looks like radians", advice


def more_than_nothing(
    value: float, name: str, written: str, written_key: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """Return fault E116 for a size of a block that is not positive."""
    return (
        None
        if value > 0.0
        else ("E116", f"{name} is {number_text(value)}, it must be more than 0", "")
    )
