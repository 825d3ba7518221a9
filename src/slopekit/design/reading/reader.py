"""The reader of designs: turns the tree of a document into the values of fields and collects all faults."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.core.orientation import Plane, parse_face, parse_plane
from slopekit.core.units import LARGEST, is_unit_of, unit_of
from slopekit.design import words
from slopekit.design.common import Design, Reading
from slopekit.design.fields import (
    Field,
    declare,
    every_field,
    field_in,
    fields_of,
    with_nested_records,
)
from slopekit.design.parts import Strength
from slopekit.design.reading.nodes import NOTHING, Document, Node, NodeCache, as_text
from slopekit.design.reading.structure import (
    MOST_FAULTS,
    has_angles,
    is_distribution,
    orientation_kind,
)

if TYPE_CHECKING:
    from slopekit.design.common import Pair
    from slopekit.design.scatter.correlation import CorrelatedValue
    from slopekit.design.scatter.distributions import Variable

T = TypeVar("T")
D = TypeVar("D", bound=Design)
_BARE_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$"  # a text: compiled when first used
_SAMPLING_ORDER = (
    "rock",
    "analysis",
    "loads.seismic",
    "loads.forces",
    "support",
    "slope",
    "joints",
    "strength",
    "water",
    "crack",
)
_COORDINATE = declare("", "length")
_STRENGTH_KEYS = [field.path for field in fields_of(Strength).values() if field.is_number]
#: List entries that were read before, with the function that read them: a study seldom changes any of many bolts.
_ENTRY_CACHE: NodeCache[tuple[Any, Any]] = NodeCache()
_MOST_GUESSES = 10  # a did-you-mean search among ten thousand names is slow


class Reader:
    """Reads the fields of a design from its document, and collects all their faults.

    A value that is missing or wrong is returned as None, with a fault.

    Parameters
    ----------
    record : the dataclass of the design
    wrong : faults already found in the structure of the document
    other_values : whether this is a sound design with some values replaced
    """

    def __init__(
        self,
        document: Document,
        record: type[Design],
        wrong: Sequence[Fault] = (),
        other_values: bool = False,
    ) -> None:
        self.document, self.root, self.record, self.other_values = (
            document,
            document.root,
            record,
            other_values,
        )
        self.kind = record.__name__.removesuffix("Design").lower()
        self.wrong = tuple(wrong)
        self.misshapen = frozenset(fault.where for fault in wrong if fault.code in ("E144", "E109"))
        self.faults = Faults()
        self.variables: dict[str, Variable] = {}
        self.left_out: list[str] = []
        self.read_as: list[str] = []
        self.defaults: list[str] = []
        self.guesses = 0
        self._number_cache: NodeCache[Any] = (
            NodeCache()
        )  # False for a value that is no valid number

    # -- the tree -----------------------------------------------------------------------------------------------------

    def find(self, path: str) -> Node:
        """Return the node at a dotted path."""
        return self.root.find(path)

    def names(self, path: str) -> list[tuple[str, Node]]:
        """Return the groups of keys under users' names at a path, as pairs of name and node."""
        return [(name, below) for name, below in self.find(path).items() if below.is_mapping]

    def fault(self, code: str, message: str, node: Node, advice: str = "") -> None:
        """Record a fault at the place of a node, or of the whole design where the node is missing."""
        self.faults.append(Fault(code, message, str((node or self.root).place), advice))

    def nearest(self, name: str, choices: Collection[str]) -> str:
        """Return the advice for an unknown name: the nearest of the choices, or the first few."""
        self.guesses += 1
        first = list(choices)[:8]
        there_are = (
            f"There are: {', '.join(first)}{', …' if len(choices) > len(first) else ''}."
            if first
            else ""
        )
        return (
            did_you_mean(name, choices, there_are) if self.guesses <= _MOST_GUESSES else there_are
        )

    def is_sound(self, node: Node) -> bool:
        """Return whether a node and all nodes below it have the required structure."""
        misshapen = self.misshapen
        return not misshapen or all(
            misshapen.isdisjoint((str(descendant.place), str(descendant.key_place)))
            for descendant in node.walk()
        )

    def value(self, node: Node) -> Any:
        """Return the value of a node: bare numbers as floats, distributions by their centre; None if malformed."""
        if not self.is_sound(node):
            return None
        if is_distribution(node) or has_angles(node):
            return self.centre(node)
        if node.is_mapping:
            return {key: self.value(below) for key, below in node.items()}
        if node.elements or isinstance(node.value, list):
            return [self.value(below) for below in node.elements]
        written = node.text
        return (
            float(written) if written is not None and re.match(_BARE_NUMBER, written) else written
        )

    def written(self, node: Node) -> Any:
        """Return the text of a node as the user wrote it, or its value if it is no text."""
        return node.text if node.text is not None and self.is_sound(node) else self.value(node)

    def centre(self, node: Node) -> Any:
        """Return the centre of a distribution or of an orientation given by its two angles, for a deterministic run."""
        from slopekit.design.scatter import distributions  # only where a value scatters

        kind = orientation_kind(node)
        scatter: distributions.Scatter
        try:
            if kind is None:
                field = field_in(self.record, self.root, node.path)
                measures = "ratio" if field is None else field.measures
                scatter = distributions.read_distribution(
                    node, measures, node.path, None if field is None else field.period
                )
            elif is_distribution(node):
                scatter = distributions.read_orientation(node, node.path, kind)
            else:
                scatter = distributions.read_angles(node, node.path, kind)
        except DesignError as error:
            self.faults += error.faults
            return None
        variable = distributions.Variable(node.path, scatter, str(node.place))
        if variable.coordinates and node.path not in self.variables:
            self.variables[node.path] = variable
        return (
            scatter.centre
            if isinstance(scatter, distributions.Distribution)
            else as_text(scatter.centre)
        )

    # -- fields -------------------------------------------------------------------------------------------------------

    def fields(
        self, record: Any, holder: Node | None = None, owner: str = "", only: Iterable[str] = ()
    ) -> dict[str, Any]:
        """Return the values of a record's own fields by attribute, with defaults for missing keys.

        Parameters
        ----------
        holder : the node of the record; None for the whole design
        owner : the user's name of the record, for messages: spacing of S1
        only : the attributes to read; all if empty
        """
        attributes, holder = tuple(only), self.root if holder is None else holder
        return {
            name: self.field(field, holder.find(field.path), owner)
            for name, field in _plain_fields(record)
            if not attributes or name in attributes
        }

    def field(self, field: Field, node: Node, owner: str = "") -> Any:
        """Return the value of one field from its node, or its default where the node is empty."""
        if node.value is None or (node.text or "").lower() in field.words:
            if field.measures == "text" and node.text is not None:
                return node.text.lower()
            if "." in field.path and field.key in self.record.DEFAULTS and node.value is None:
                return self.default(field.key, self.record.DEFAULTS[field.key])
            return field.default
        if field.many:
            entries = node.elements if isinstance(node.value, list) else (node,)
            numbers = [
                self.number(field, entry, field.in_words.format(k=k))
                for k, entry in enumerate(entries, 1)
                if self.is_sound(entry)
            ]
            return tuple(value for value in numbers if value is not None)
        if field.is_number:
            return self.number(
                field, node, f"{field.in_words} of {owner}" if owner else field.in_words
            )
        value = self.written(node)
        if value is None:
            return None
        if field.measures == "plane":
            return self.plane(node, owner or field.in_words)
        if field.measures == "line":
            return self.faults.of(
                words.line_of_words, value, owner or field.in_words, field.code, str(node.place)
            )
        if field.measures == "point":
            return self.faults.of(words.point, value, field.in_words, str(node.place))
        return self.word(field, node)

    def default(self, key: str, value: T) -> T:
        """Return the default of a missing key and note it, so that the sheet lists it."""
        self.defaults.append(key)
        return value

    def number(self, field: Field, node: Node, name: str = "") -> float | None:
        """Return a number in the unit of its field, checked against the field's limits; None with a fault."""
        written, name = node.text, name or field.in_words
        if written is not None and re.match(_BARE_NUMBER, written) and not self.misshapen:
            bare_number = float(written)  # most numbers of ten thousand blocks are this
            if abs(bare_number) <= LARGEST and field.takes(bare_number) and field.check is None:
                return int(bare_number) if field.is_integer else bare_number
        value = self.value(node)
        if value is None:
            return None
        if is_distribution(node):
            written = node.get("mean").text
        location = str(node.place)
        cached = self._number_cache.get(node)
        if cached is not None:
            return (
                None if cached is False else float(cached)
            )  # one value shared by several interfaces is checked once

        def read() -> float:
            number = _refuse_other_quantity(value, field, name, location, self.document.written_key)
            return field.read(number, name, location, written or "", self.document.written_key)

        checked = self.faults.of(read)
        self._number_cache.store(node, False if checked is None else checked)
        return checked

    def per_interface(self, field: Field, node: Node, names: Sequence[str]) -> list[float | None]:
        """Return a number of each interface, given once for all, as a list, or by name; None where it is not given.

        Faults: E197 an unknown interface, E109 more numbers than interfaces.
        """
        if node.value is None:
            return []
        if node.is_mapping and not is_distribution(node):
            for name, below in node.items():
                if name not in names:
                    message = f"{field.in_words} on {name}: there is no such interface"
                    self.fault("E197", message, below, self.nearest(name, names))
            numbers = {
                name: self.number(field, below, f"{field.in_words} on {name}")
                for name, below in node.items()
            }
            return [numbers.get(name) for name in names]
        if len(node.elements) > len(names):
            interfaces_text = (
                f"are {', '.join(names[:-1])} and {names[-1]}"
                if names[1:]
                else f"is {[*names, 'none'][0]} alone"
            )
            self.fault(
                "E109",
                f"{len(node.elements)} {field.in_words}s given, there {interfaces_text}",
                node,
            )
            return []
        if not node.elements:
            return [self.number(field, node)]
        named_nodes = zip(names, node.elements, strict=False)
        return [
            self.number(field, below, f"{field.in_words} on {name}") for name, below in named_nodes
        ]

    def points(self, node: Node, polyline_name: str) -> list[tuple[float, float]]:
        """Return the points of a polyline in a section, (distance, elevation) in m; empty if any has a fault."""
        if not self.is_sound(node):
            return []
        points = list[tuple[float, float]]()
        for k, item in enumerate(node.elements, 1):
            place, elevation = (
                self.number(_COORDINATE, below, f"point {k} of {polyline_name}")
                for below in item.elements
            )
            if place is not None and elevation is not None:
                points.append((place, elevation))
        return points if len(points) == len(node.elements) else []

    def plane(self, node: Node, name: str) -> Plane | None:
        """Return an orientation as a plane; None with a fault."""
        value = self.written(node)
        parse = parse_face if node.name in ("face", "upper") else parse_plane
        return None if value is None else self.faults.of(parse, value, name, str(node.place))

    def word(self, field: Field, node: Node) -> str | None:
        """Return a text, which is one of the field's words if it has any; None with a fault."""
        written = node.text
        if written is None or not field.words:
            return written
        if written.lower() not in field.words:
            allowed = " or ".join(field.words)
            self.fault(
                field.code,
                f"{field.in_words} is {written!r}, it is {allowed}",
                node,
                did_you_mean(written, field.words),
            )
            return None
        return written.lower()

    def items(self, path: str) -> tuple[Node, ...]:
        """Return the nodes of a list's entries; a value that is no list counts as its only entry."""
        node = self.find(path)
        if node.value is None:
            return ()
        return node.elements if isinstance(node.value, list) else (node,)

    def many(self, path: str, read: "Callable[[Reader, Node], T | None]") -> tuple[T, ...]:
        """Return the entries of a list as `read` reads them, without those that have faults."""
        entries = []
        for item in self.items(path):
            cached = _ENTRY_CACHE.get(item)
            if cached is not None and cached[0] is read and not self.misshapen:
                entries.append(cached[1])
                continue
            scattering = len(self.variables)
            entry = read(self, item) if item.value is not None and self.is_sound(item) else None
            if entry is not None:
                entries.append(entry)
                if len(self.variables) == scattering and not self.faults and not self.misshapen:
                    _ENTRY_CACHE.store(item, (read, entry))
        return tuple(entries)

    def build(self, record: type[D], *values: Mapping[str, Any], **more: Any) -> D:
        """Return the design record of these values.

        Raises
        ------
        DesignError
            With every fault found.
        """
        correlation = self.correlation()
        if self.faults or self.wrong:
            if len(self.faults) > MOST_FAULTS:
                message = f"there are {len(self.faults)} faults: these are the first {MOST_FAULTS}"
                self.faults[MOST_FAULTS:] = [
                    Fault("E149", message, str(self.root.place), "Is this a design file?")
                ]
            raise DesignError(self.faults)
        arguments: dict[str, Any] = {}
        for group in (*values, more):
            arguments |= group
        variables = sorted(self.variables.values(), key=_sampling_position)
        return record(
            **with_nested_records(record, arguments),
            reading=Reading(
                defaults=tuple(self.defaults),
                left_out=tuple(self.left_out),
                read_as=tuple(self.read_as),
            ),
            variables=tuple(variables),
            correlation=correlation,
        )

    # -- correlation --------------------------------------------------------------------------------------------------

    def correlation(self) -> "tuple[Pair, ...]":
        """Return the rank correlations of the random variables, as pairs of coordinates; errors become faults."""
        node = self.find("correlation")
        if not node.is_mapping:
            return ()
        from slopekit.design.scatter.correlation import check_correlation

        names = self.short_names()
        if self.other_values:
            entries = {
                key: below
                for key, below in node.items()
                if all(name.strip() in names for name in key.split("/"))
            }
            node = replace(node, value=entries)
        pairs, faults = check_correlation(node, names)
        self.faults += faults
        return pairs

    def short_names(self) -> "dict[str, CorrelatedValue]":
        """Return the names that a correlation may use: paths, and short names such as `J1.phi` for J1's strength."""
        names: dict[str, CorrelatedValue] = {}
        for path, variable in self.variables.items():
            names[path] = path if variable.orientation_kind is None else variable
            names |= {angle: angle for angle in variable.angles if angle}
        joints = self.find("joints") or self.find("sets")
        for joint, _ in joints.items():
            name = strength_of(self.root, joint)
            for path in _strength_paths():
                if (strength_path := f"strength.{name}.{path}") in self.variables:
                    names[f"{joint}.{path}"] = strength_path
        for group in ("joints.", "strength.", "sets."):
            names |= {
                path.removeprefix(group): coordinate
                for path, coordinate in names.items()
                if path.startswith(group)
            }
        return names


@cache
def _plain_fields(record: Any) -> tuple[tuple[str, Field], ...]:
    """Return the fields that `Reader.fields` reads: the record's own attributes that are no groups, by name."""
    shared = fields_of(Design) if record is not Design and issubclass(record, Design) else {}
    return tuple(
        (name, field)
        for name, field in fields_of(record).items()
        if field.measures != "group"
        and field.record_type is None
        and not field.per_interface
        and field.is_attribute
        and field.many != "names"
        and shared.get(name) is not field
    )


@cache
def _strength_paths() -> tuple[str, ...]:
    """Return the paths of all fields of a strength (cached, as studies read a design thousands of times)."""
    return tuple(field.path for field in every_field(Strength))


def strength_of(root: Node, joint: str) -> str | None:
    """Return the name of the strength of a joint, joint set or joint list; the only strength if none is named."""
    joints, strengths = root.get("joints") or root.get("sets"), root.get("strength")
    of_basal = root.get("basal") if joint == "basal" and joints else NOTHING
    strength = (joints.get(joint) or of_basal or joints).get("strength")
    names = [name for name, _ in strengths.items()]
    return strength.text if strength else names[0] if len(names) == 1 else None


def _sampling_position(variable: "Variable") -> tuple[int, int]:
    """Return the sort key of a variable in sampling; fixed, so that a seed always gives the same samples."""
    keys = variable.path.split(".")
    top = ".".join(keys[:2]) if keys[0] == "loads" else keys[0]
    key = _STRENGTH_KEYS.index(keys[2]) if top == "strength" and keys[2] in _STRENGTH_KEYS else 0
    return (_SAMPLING_ORDER.index(top) if top in _SAMPLING_ORDER else len(_SAMPLING_ORDER)), key


def _refuse_other_quantity(
    value: Any, field: Field, name: str, location: str, written_key: Callable[[str], str]
) -> Any:
    """Return the value, or raise E107 where a unit weight has the unit of a density or the other way round."""
    for quantity, path in (("density", "rock.density"), ("unit weight", "rock.unit_weight")):
        is_confused = field.measures in ("density", "unit weight") and field.measures != quantity
        if is_confused and is_unit_of(unit_of(value), quantity):
            quantity_text = "a density" if quantity == "density" else "a unit weight"
            message = f"{name} is {value}: that is {quantity_text}"
            raise DesignError(
                [Fault("E107", message, location, f"Write {written_key(path)} {value}.")]
            )
    return value
