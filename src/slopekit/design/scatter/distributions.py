"""Numbers and orientations that scatter: `{dist: normal, mean: 20, sd: 2}`, `{dist: fisher, mean: 45/115, k: 100}`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, ClassVar, Literal, TypeAlias, cast

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.core.orientation import Line, Plane, number, parse_face, parse_plane
from slopekit.design.reading.nodes import Node, fail
from slopekit.design.reading.structure import ANGLES, WRITTEN, OrientationKind, is_distribution
from slopekit.design.words import line_of_words, measured

Scatter: TypeAlias = "Distribution | Fisher | Angles"
Name = Literal["normal", "lognormal", "uniform", "triangular"]
#: Needed and further parameters of each distribution, in the order in which they are written.
PARAMETERS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "normal": (("mean", "sd"), ("min", "max")),
    "lognormal": (("mean", "sd"), ("min", "max")),
    "uniform": (("min", "max"), ()),
    "triangular": (("min", "mode", "max"), ()),
    "fisher": (("mean", "k"), ()),
}
_EXAMPLES = {
    "normal": "{dist: normal, mean: 20, sd: 2}",
    "lognormal": "{dist: lognormal, mean: 20, sd: 5}",
    "uniform": "{dist: uniform, min: 10, max: 30}",
    "triangular": "{dist: triangular, min: 10, mode: 20, max: 30}",
    "fisher": "{dist: fisher, mean: 45/115, k: 100}",
}
_SPREAD: Mapping[str, Any] = {"least": 0.0, "code": "E186", "says": "a standard deviation is never negative"}
_CONCENTRATION: Mapping[str, Any] = {
    "least": 0.0,
    "above": True,
    "code": "E165",
    "advice": "Joint sets have 10 (scattered) to 500 (tight).",
}


@dataclass(frozen=True)
class Distribution:
    """A number that scatters: normal or lognormal (with `min` and `max`: truncated), uniform, triangular.

    `parameters` are in the unit of bare numbers of `kind` (kPa for a pressure). Mean and standard deviation are
    those of the value itself before truncation, also for the lognormal.
    """

    name: Name
    parameters: Mapping[str, float]
    kind: str
    of: ClassVar[None] = None

    @property
    def centre(self) -> float:
        """The value that a single run takes: the mean (of a truncated normal: the one given).

        >>> Distribution("triangular", {"min": 10.0, "mode": 20.0, "max": 36.0}, "angle").centre
        22.0
        """
        if "mean" in self.parameters:
            return self.parameters["mean"]
        return sum(self.parameters.values()) / len(self.parameters)


@dataclass(frozen=True)
class Fisher:
    """An orientation that scatters about a mean; `k` is Fisher's concentration (Fisher 1953)."""

    mean: Plane | Line
    k: float

    @property
    def of(self) -> OrientationKind:
        """What it is one of."""
        return "plane" if isinstance(self.mean, Plane) else "line"

    @property
    def centre(self) -> Plane | Line:
        """The orientation that a single run takes: the mean."""
        return self.mean


@dataclass(frozen=True)
class Angles:
    """An orientation whose dip and dip direction (plunge and trend of a line) scatter as numbers, or one of the two.

    >>> dip = Distribution("normal", {"mean": 45.0, "sd": 3.0}, "angle")
    >>> print(Angles("plane", dip, 115.0).centre)
    45/115
    """

    of: OrientationKind
    steep: Distribution | float
    direction: Distribution | float

    @property
    def middle(self) -> tuple[float, float]:
        """The two angles that a single run takes; a mean direction beyond the circle is turned back into it."""
        steep = self.steep if isinstance(self.steep, float) else self.steep.centre
        if isinstance(self.direction, float):
            return steep, self.direction
        direction = self.direction.centre
        return steep, direction if 0.0 <= direction <= 360.0 else direction % 360.0

    @property
    def centre(self) -> Plane | Line:
        """The orientation that a single run takes."""
        steep, direction = self.middle
        return Plane(steep, direction) if self.of == "plane" else Line(direction, steep)


@dataclass(frozen=True)
class Variable:
    """A value of a design that scatters: its dotted path in the file, how it scatters, and where that stands.

    >>> plane = Variable("joints.J1.plane", Fisher(Plane(45.0, 115.0), 100.0))
    >>> plane.columns, plane.coordinates
    (('joints.J1.plane.dip', 'joints.J1.plane.dip_direction'), ('joints.J1.plane.dip', 'joints.J1.plane.dip_direction'))
    """

    path: str
    distribution: Scatter
    where: str = field(default="", compare=False)

    @property
    def of(self) -> OrientationKind | None:
        """What an orientation is one of; None for a number."""
        return self.distribution.of

    @property
    def columns(self) -> tuple[str, ...]:
        """The numbers that a sample has of it: one, or the two angles of an orientation as they are written."""
        if self.of is None:
            return (self.path,)
        first, second = (f"{self.path}.{angle}" for angle in WRITTEN[self.of])
        return first, second

    @property
    def angles(self) -> tuple[str, str]:
        """Of an orientation: the names of what scatters of the steep angle and of the direction, empty where fixed."""
        if self.of is None:
            return ("", "")
        steep, direction = (f"{self.path}.{angle}" for angle in ANGLES[self.of])
        if isinstance(self.distribution, Angles):
            steep = "" if isinstance(self.distribution.steep, float) else steep
            direction = "" if isinstance(self.distribution.direction, float) else direction
        return steep, direction

    def assumed(self) -> list[tuple[str, str]]:
        """What a single run takes, by path; of an orientation by its angles only the angle that scatters."""
        centre = self.distribution.centre
        if not isinstance(self.distribution, Angles):
            return [(self.path, number(centre) if isinstance(centre, float) else str(centre))]
        named = zip(self.angles, self.distribution.middle, strict=True)
        return [(name, number(angle)) for name, angle in named if name]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """What scatters on its own account, and so what correlations are between."""
        return (self.path,) if self.of is None else tuple(name for name in self.angles if name)


def read_distribution(node: Node, kind: str, name: str, period: float | None = None) -> Distribution:
    """The distribution of a number.

    Parameters
    ----------
    node : a mapping with the key dist
    kind : the kind of quantity, as `slopekit.core.units.quantity` takes it
    name : what it is, for the messages
    period : of a direction, whose range may lie across north: from min 350 to max 10 it goes the short way

    Raises
    ------
    DesignError
        E105 to E108 for a parameter, E165 a distribution or parameter that it does not have, or lacks, or fisher for
        a number, E186 sd below 0, min not below max, a centre outside its bounds, a lognormal mean not above 0.

    >>> from slopekit.design.reading.nodes import document_from
    >>> node = document_from({"c": {"dist": "uniform", "min": "10 kPa", "max": "0.03 MPa"}}).root.get("c")
    >>> read_distribution(node, "pressure", "c of weak").centre
    20.0
    """
    dist = _dist(node, name)
    if dist == "fisher":
        advice = f"A number takes {_EXAMPLES['normal']}."
        fail("E165", f"{name} is a number, fisher is for orientations", str(node.place), advice)
    faults, values = Faults(_wrong_parameters(node, dist, name)), dict[str, float]()
    for key in sum(PARAMETERS[dist], ()):
        below = node.get(key)
        limits = _SPREAD if key == "sd" else {}
        value = None if not below else faults.of(node_number, below, kind, f"{key} of {name}", **limits)
        if value is not None:
            values[key] = value
    values = values if period is None else _across_north(values, period)
    faults += _impossible(node, dist, values, name)
    faults.refuse()
    return Distribution(cast(Name, dist), values, kind)


def _across_north(values: dict[str, float], period: float) -> dict[str, float]:
    """Parameters of a direction whose min is beyond its max: that and a centre beyond the max are turned back.

    >>> _across_north({"min": 350.0, "mode": 355.0, "max": 10.0}, 360.0)
    {'min': -10.0, 'mode': -5.0, 'max': 10.0}
    """
    low, high = values.get("min"), values.get("max")
    if low is None or high is None or low <= high:
        return values
    turned = [key for key in ("min", "mean", "mode") if values.get(key, high) > high]
    return {key: value - period if key in turned else value for key, value in values.items()}


def read_orientation(node: Node, name: str, of: OrientationKind = "plane") -> Fisher:
    """The Fisher distribution of a plane or a line.

    Raises
    ------
    DesignError
        E101 to E105 for the mean, E165 as for numbers, another distribution, or k not above 0.

    >>> from slopekit.design.reading.nodes import document_from
    >>> node = document_from({"plane": {"dist": "fisher", "mean": "45/115", "k": 100}}).root.get("plane")
    >>> print(read_orientation(node, "J1").centre)
    45/115
    """
    dist = _dist(node, name)
    if dist != "fisher":
        advice = f"An orientation takes {_EXAMPLES['fisher']}."
        fail("E165", f"{name} is an orientation, {dist} is for numbers", str(node.place), advice)
    faults = Faults(_wrong_parameters(node, dist, name))
    mean = faults.of(_orientation, node.get("mean"), f"mean of {name}", of) if node.get("mean") else None
    k = faults.of(node_number, node.get("k"), "ratio", f"k of {name}", **_CONCENTRATION) if node.get("k") else None
    if faults or mean is None or k is None:
        raise DesignError(faults)
    return Fisher(mean, k)


def read_angles(node: Node, name: str, of: OrientationKind = "plane") -> Angles:
    """An orientation by its two angles, each a number or a distribution.

    Raises
    ------
    DesignError
        E105 to E108 for an angle that is no number, and what `read_distribution` raises.

    >>> from slopekit.design.reading.nodes import document_from
    >>> dip = {"dist": "normal", "mean": 45, "sd": 3}
    >>> node = document_from({"plane": {"dip": dip, "dip_direction": 115}}).root.get("plane")
    >>> print(read_angles(node, "J1").centre)
    45/115
    """
    faults = Faults()
    (steep, direction), periods = ANGLES[of], (None, 360.0)
    angles = [
        faults.of(_angle, node.get(angle), f"{angle} of {name}", period)
        for angle, period in zip((steep, direction), periods, strict=True)
    ]
    if faults or angles[0] is None or angles[1] is None:  # the checker of the structure says so
        raise DesignError(faults)
    return Angles(of, angles[0], angles[1])


def _angle(node: Node, name: str, period: float | None) -> Distribution | float | None:
    """One angle of an orientation; None where it is missing."""
    if node.value is None:
        return None
    return read_distribution(node, "angle", name, period) if is_distribution(node) else node_number(node, "angle", name)


def _dist(node: Node, name: str) -> str:
    given = node.get("dist")
    text = (given.text or "").strip()
    if text.lower() in PARAMETERS:
        return text.lower()
    where = str(given.key_place if given else node.place)
    advice = did_you_mean(text.lower(), PARAMETERS, f"Known: {', '.join(PARAMETERS)}.")
    shown = repr(text) if text else "not named"
    raise DesignError([Fault("E165", f"the distribution of {name} is {shown}, which is not known", where, advice)])


def _wrong_parameters(node: Node, dist: str, name: str) -> Iterator[Fault]:
    needed, further = PARAMETERS[dist]
    for key, given in node.items():
        if key in (*needed, *further, "dist"):
            continue
        advice = did_you_mean(key, (*needed, *further), f"Write {_EXAMPLES[dist]}.")
        if dist == "normal" and key == "mode":
            advice = f"A mode belongs to {_EXAMPLES['triangular']}."
        yield Fault("E165", f"{dist} has no {key} ({name})", str(given.key_place), advice)
    for key in needed:
        if not node.get(key):
            message = f"{key} of {name} is missing, {dist} needs {', '.join(needed)}"
            yield Fault("E165", message, str(node.place), f"Write {_EXAMPLES[dist]}.")


def _impossible(node: Node, dist: str, values: Mapping[str, float], name: str) -> Iterator[Fault]:
    """Parameters that each are numbers but cannot stand together."""
    low, high = values.get("min", -inf), values.get("max", inf)
    for key in ("min", "mean", "mode"):
        value, where = values.get(key), str((node.get(key) or node).key_place)
        if value is None:
            continue
        message, bound = f"{key} of {name} is {number(value)}", "max" if value > high else "min"
        if key == "min" and value >= high:
            yield Fault("E186", f"{message}, it must be less than max, {number(high)}", where)
        elif low < high and not low <= value <= high:
            side = "beyond" if bound == "max" else "below"
            message += f", {side} its {bound}, {number(values[bound])}"
            yield Fault("E186", message, where, f"Move the {key} or the {bound}.")
        if dist == "lognormal" and key == "mean" and value <= 0.0:
            advice = "Give the mean of the value itself, not of its logarithm."
            yield Fault("E186", f"{message}, a lognormal value is always more than 0", where, advice)


def _value(node: Node) -> object:
    """What `quantity` and `parse_plane` read: a text, or what their message shall show."""
    if isinstance(node.value, dict):
        return "a group of keys"
    return [part.text for part in node.elements] if isinstance(node.value, list) else node.value


def _orientation(node: Node, name: str, of: OrientationKind) -> Plane | Line:
    where = str(node.key_place)
    if of == "plane":
        is_face = {"face", "upper"} & {*node.path.split(".")[-2:]}
        return (parse_face if is_face else parse_plane)(_value(node), name, where)
    return line_of_words(_value(node), name, "E165", where)


def node_number(node: Node, kind: str, name: str, **limits: Any) -> float:
    """The number of a node, between limits as `slopekit.design.words.measured` takes them."""
    return measured(_value(node), kind, name, str(node.key_place), **limits)
