"""From the tree of a design to the values of its fields: each read once, all faults collected with their places."""

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
from slopekit.design.fields import Field, declare, every_field, field_in, fields_of, with_parts
from slopekit.design.parts import Strength
from slopekit.design.reading.nodes import NOTHING, Document, Kept, Node, as_text
from slopekit.design.reading.structure import MOST_FAULTS, has_angles, is_distribution, orientation_kind

if TYPE_CHECKING:
    from slopekit.design.common import Pair
    from slopekit.design.scatter.correlation import Named
    from slopekit.design.scatter.distributions import Variable

T = TypeVar("T")
D = TypeVar("D", bound=Design)
_BARE_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$"  # a text: compiled when first used
_DRAWN = (
    "rock", "analysis", "loads.seismic", "loads.forces", "support", "slope", "joints", "strength", "water", "crack",
)  # fmt: skip
_COORDINATE = declare("", "length")
_STRENGTH_KEYS = [field.path for field in fields_of(Strength).values() if field.is_number]
#: Items of lists that were read before, with what read them: of hundreds of bolts a study changes none.
_READ: Kept[tuple[Any, Any]] = Kept()
_MOST_GUESSES = 10  # did-you-mean among ten thousand names takes its time


class Reader:
    """Reads the fields of a design from its document, and collects the faults of all.

    What is missing or wrong comes back as None; a fault stands for each.

    Parameters
    ----------
    record : the dataclass of the design
    wrong : what the structure of the document has already been found wrong in
    other_values : whether values were put over those of a sound design
    """

    def __init__(
        self, document: Document, record: type[Design], wrong: Sequence[Fault] = (), other_values: bool = False
    ) -> None:
        self.document, self.root, self.record, self.other_values = document, document.root, record, other_values
        self.kind = record.__name__.removesuffix("Design").lower()
        self.wrong = tuple(wrong)
        self.misshapen = frozenset(fault.where for fault in wrong if fault.code in ("E144", "E109"))
        self.faults = Faults()
        self.variables: dict[str, Variable] = {}
        self.left_out: list[str] = []
        self.read_as: list[str] = []
        self.defaults: list[str] = []
        self.guesses = 0
        self._found: Kept[Any] = Kept()  # numbers, False for those that are none

    # -- the tree -----------------------------------------------------------------------------------------------------

    def at(self, path: str) -> Node:
        """The node of a dotted path."""
        return self.root.at(path)

    def names(self, path: str) -> list[tuple[str, Node]]:
        """What stands under names of the user's, where each is a group of keys."""
        return [(name, below) for name, below in self.at(path).items() if below.is_mapping]

    def fault(self, code: str, message: str, node: Node, advice: str = "") -> None:
        """Keep a fault of a value; of the whole design where that is not there."""
        self.faults.append(Fault(code, message, str((node or self.root).place), advice))

    def nearest(self, name: str, known: Collection[str]) -> str:
        """An advice for a name that is not known."""
        self.guesses += 1
        first = list(known)[:8]
        there_are = f"There are: {', '.join(first)}{', …' if len(known) > len(first) else ''}." if first else ""
        return did_you_mean(name, known, there_are) if self.guesses <= _MOST_GUESSES else there_are

    def is_sound(self, node: Node) -> bool:
        """Whether a value and all in it have the shape they need."""
        misshapen = self.misshapen
        return not misshapen or all(
            misshapen.isdisjoint((str(part.place), str(part.key_place))) for part in node.walk()
        )

    def value(self, node: Node) -> Any:
        """What a node says, numbers as numbers, distributions by the value a single run takes; None: misshapen."""
        if not self.is_sound(node):
            return None
        if is_distribution(node) or has_angles(node):
            return self.centre(node)
        if node.is_mapping:
            return {key: self.value(below) for key, below in node.items()}
        if node.elements or isinstance(node.value, list):
            return [self.value(below) for below in node.elements]
        written = node.text
        return float(written) if written is not None and re.match(_BARE_NUMBER, written) else written

    def written(self, node: Node) -> Any:
        """What a node says in the user's own words where it is a text, else its value."""
        return node.text if node.text is not None and self.is_sound(node) else self.value(node)

    def centre(self, node: Node) -> Any:
        """What a single run takes of a number that scatters, or of an orientation that is not written in one word."""
        from slopekit.design.scatter import distributions  # only where a value scatters

        of = orientation_kind(node)
        scatter: distributions.Scatter
        try:
            if of is None:
                field = field_in(self.record, self.root, node.path)
                measures = "ratio" if field is None else field.measures
                scatter = distributions.read_distribution(
                    node, measures, node.path, None if field is None else field.period
                )
            elif is_distribution(node):
                scatter = distributions.read_orientation(node, node.path, of)
            else:
                scatter = distributions.read_angles(node, node.path, of)
        except DesignError as error:
            self.faults += error.faults
            return None
        variable = distributions.Variable(node.path, scatter, str(node.place))
        if variable.coordinates and node.path not in self.variables:
            self.variables[node.path] = variable
        return scatter.centre if isinstance(scatter, distributions.Distribution) else as_text(scatter.centre)

    # -- fields -------------------------------------------------------------------------------------------------------

    def fields(
        self, record: Any, holder: Node | None = None, owner: str = "", only: Iterable[str] = ()
    ) -> dict[str, Any]:
        """The values of a record's own fields by attribute: numbers, planes, points, texts; defaults where none stands.

        Parameters
        ----------
        holder : the node of the record, None for the whole design
        owner : the user's name for it, for messages: spacing of S1
        only : attributes, where not all
        """
        wanted, holder = tuple(only), self.root if holder is None else holder
        return {
            name: self.field(field, holder.at(field.path), owner)
            for name, field in _plain_fields(record)
            if not wanted or name in wanted
        }

    def field(self, field: Field, node: Node, owner: str = "") -> Any:
        """The value of one field where `node` gives it, else its default."""
        if node.value is None or (node.text or "").lower() in field.words:
            if field.measures == "text" and node.text is not None:
                return node.text.lower()
            if "." in field.path and field.key in self.record.DEFAULTS and node.value is None:
                return self.default(field.key, self.record.DEFAULTS[field.key])
            return field.default
        if field.many:
            parts = node.elements if isinstance(node.value, list) else (node,)
            each = [
                self.number(field, part, field.in_words.format(k=k))
                for k, part in enumerate(parts, 1) if self.is_sound(part)
            ]  # fmt: skip
            return tuple(value for value in each if value is not None)
        if field.is_number:
            return self.number(field, node, f"{field.in_words} of {owner}" if owner else field.in_words)
        value = self.written(node)
        if value is None:
            return None
        if field.measures == "plane":
            return self.plane(node, owner or field.in_words)
        if field.measures == "line":
            return self.faults.of(words.line_of_words, value, owner or field.in_words, field.code, str(node.place))
        if field.measures == "point":
            return self.faults.of(words.point, value, field.in_words, str(node.place))
        return self.word(field, node)

    def default(self, key: str, value: T) -> T:
        """What is taken where a key is left out; the sheet says so."""
        self.defaults.append(key)
        return value

    def number(self, field: Field, node: Node, name: str = "") -> float | None:
        """A number with a unit, between the limits of its field."""
        written, name = node.text, name or field.in_words
        if written is not None and re.match(_BARE_NUMBER, written) and not self.misshapen:
            bare_number = float(written)  # most numbers of ten thousand blocks are this
            if abs(bare_number) <= LARGEST and field.takes(bare_number) and field.check is None:
                return int(bare_number) if field.whole else bare_number
        value = self.value(node)
        if value is None:
            return None
        if is_distribution(node):
            written = node.get("mean").text
        where = str(node.place)
        known = self._found.of(node)
        if known is not None:
            return None if known is False else float(known)  # one value of several interfaces is judged once

        def read() -> float:
            number = _other_kind(value, field, name, where, self.document.called)
            return field.read(number, name, where, written or "", self.document.called)

        checked = self.faults.of(read)
        self._found.keep(node, False if checked is None else checked)
        return checked

    def each(self, field: Field, node: Node, names: Sequence[str]) -> list[float | None]:
        """One number for all of these interfaces, or one for each of them as a list or by name: None for the others.

        Faults: E197 an interface that is none of them, E109 more numbers than interfaces.
        """
        if node.value is None:
            return []
        if node.is_mapping and not is_distribution(node):
            for name, below in node.items():
                if name not in names:
                    message = f"{field.in_words} on {name}: there is no such interface"
                    self.fault("E197", message, below, self.nearest(name, names))
            given = {name: self.number(field, below, f"{field.in_words} on {name}") for name, below in node.items()}
            return [given.get(name) for name in names]
        if len(node.elements) > len(names):
            there = f"are {', '.join(names[:-1])} and {names[-1]}" if names[1:] else f"is {[*names, 'none'][0]} alone"
            self.fault("E109", f"{len(node.elements)} {field.in_words}s given, there {there}", node)
            return []
        if not node.elements:
            return [self.number(field, node)]
        named = zip(names, node.elements, strict=False)
        return [self.number(field, below, f"{field.in_words} on {name}") for name, below in named]

    def points(self, node: Node, of: str) -> list[tuple[float, float]]:
        """Points of a section, place and elevation in m; none where there is a fault in any."""
        if not self.is_sound(node):
            return []
        points = list[tuple[float, float]]()
        for k, item in enumerate(node.elements, 1):
            place, elevation = (self.number(_COORDINATE, below, f"point {k} of {of}") for below in item.elements)
            if place is not None and elevation is not None:
                points.append((place, elevation))
        return points if len(points) == len(node.elements) else []

    def plane(self, node: Node, name: str) -> Plane | None:
        """An orientation as a plane."""
        value = self.written(node)
        parse = parse_face if node.name in ("face", "upper") else parse_plane
        return None if value is None else self.faults.of(parse, value, name, str(node.place))

    def word(self, field: Field, node: Node) -> str | None:
        """A text; one of the words that the field knows."""
        written = node.text
        if written is None or not field.words:
            return written
        if written.lower() not in field.words:
            known = " or ".join(field.words)
            self.fault(
                field.code,
                f"{field.in_words} is {written!r}, it is {known}",
                node,
                did_you_mean(written, field.words),
            )
            return None
        return written.lower()

    def items(self, path: str) -> tuple[Node, ...]:
        """The items of a list; one thing alone counts as a list of one."""
        node = self.at(path)
        if node.value is None:
            return ()
        return node.elements if isinstance(node.value, list) else (node,)

    def many(self, path: str, read: "Callable[[Reader, Node], T | None]") -> tuple[T, ...]:
        """A list of things in words of their own, each with its faults."""
        entries = []
        for item in self.items(path):
            known = _READ.of(item)
            if known is not None and known[0] is read and not self.misshapen:
                entries.append(known[1])
                continue
            scattering = len(self.variables)
            made = read(self, item) if item.value is not None and self.is_sound(item) else None
            if made is not None:
                entries.append(made)
                if len(self.variables) == scattering and not self.faults and not self.misshapen:
                    _READ.keep(item, (read, made))
        return tuple(entries)

    def made(self, record: type[D], *values: Mapping[str, Any], **more: Any) -> D:
        """The design of these values.

        Raises
        ------
        DesignError
            With every fault found.
        """
        correlation = self.correlation()
        if self.faults or self.wrong:
            if len(self.faults) > MOST_FAULTS:
                message = f"there are {len(self.faults)} faults: these are the first {MOST_FAULTS}"
                self.faults[MOST_FAULTS:] = [Fault("E149", message, str(self.root.place), "Is this a design file?")]
            raise DesignError(self.faults)
        given: dict[str, Any] = {}
        for part in (*values, more):
            given |= part
        variables = sorted(self.variables.values(), key=_drawn_order)
        return record(
            **with_parts(record, given),
            reading=Reading(defaults=tuple(self.defaults), left_out=tuple(self.left_out), read_as=tuple(self.read_as)),
            variables=tuple(variables),
            correlation=correlation,
        )

    # -- what scatters together ---------------------------------------------------------------------------------------

    def correlation(self) -> "tuple[Pair, ...]":
        """The correlation between what scatters, by its coordinates; what is wrong with it becomes faults."""
        node = self.at("correlation")
        if not node.is_mapping:
            return ()
        from slopekit.design.scatter.correlation import check_correlation

        names = self.short_names()
        if self.other_values:
            kept = {key: below for key, below in node.items() if all(part.strip() in names for part in key.split("/"))}
            node = replace(node, value=kept)
        pairs, faults = check_correlation(node, names)
        self.faults += faults
        return pairs

    def short_names(self) -> "dict[str, Named]":
        """What a correlation may name: paths, and `J1.phi` for the φ of J1's strength."""
        names: dict[str, Named] = {}
        for path, variable in self.variables.items():
            names[path] = path if variable.of is None else variable
            names |= {angle: angle for angle in variable.angles if angle}
        joints = self.at("joints") or self.at("sets")
        for joint, _ in joints.items():
            name = strength_of(self.root, joint)
            for path in _strength_paths():
                if (own := f"strength.{name}.{path}") in self.variables:
                    names[f"{joint}.{path}"] = own
        for group in ("joints.", "strength.", "sets."):
            names |= {path.removeprefix(group): own for path, own in names.items() if path.startswith(group)}
        return names


@cache
def _plain_fields(record: Any) -> tuple[tuple[str, Field], ...]:
    """The fields of a record itself that are read by their kind alone, by attribute."""
    shared = fields_of(Design) if record is not Design and issubclass(record, Design) else {}
    return tuple(
        (name, field)
        for name, field in fields_of(record).items()
        if field.measures != "group"
        and field.of is None
        and not field.each
        and field.is_attribute
        and field.many != "names"
        and shared.get(name) is not field
    )


@cache
def _strength_paths() -> tuple[str, ...]:
    """Of all fields of a strength: a study reads its design thousands of times."""
    return tuple(field.path for field in every_field(Strength))


def strength_of(root: Node, joint: str) -> str | None:
    """The strength that a joint (a set; all of a joint list) names, or the only one there is."""
    joints, strengths = root.get("joints") or root.get("sets"), root.get("strength")
    of_basal = root.get("basal") if joint == "basal" and joints else NOTHING
    own = (joints.get(joint) or of_basal or joints).get("strength")
    names = [name for name, _ in strengths.items()]
    return own.text if own else names[0] if len(names) == 1 else None


def _drawn_order(variable: "Variable") -> tuple[int, int]:
    """Where a variable stands among those that a study draws: a seed gives the same samples as ever."""
    parts = variable.path.split(".")
    top = ".".join(parts[:2]) if parts[0] == "loads" else parts[0]
    key = _STRENGTH_KEYS.index(parts[2]) if top == "strength" and parts[2] in _STRENGTH_KEYS else 0
    return (_DRAWN.index(top) if top in _DRAWN else len(_DRAWN)), key


def _other_kind(value: Any, field: Field, name: str, where: str, called: Callable[[str], str]) -> Any:
    """The value; E107 where a unit weight is written as a density, or the other way round."""
    for other, path in (("density", "rock.density"), ("unit weight", "rock.unit_weight")):
        both = field.measures in ("density", "unit weight") and field.measures != other
        if both and is_unit_of(unit_of(value), other):
            that = "a density" if other == "density" else "a unit weight"
            message = f"{name} is {value}: that is {that}"
            raise DesignError([Fault("E107", message, where, f"Write {called(path)} {value}.")])
    return value
