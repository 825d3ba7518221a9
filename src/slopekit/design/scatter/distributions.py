"""Random variables of a design: `{dist: normal, mean: 20, sd: 2}`, `{dist: fisher, mean: 45/115, k: 100}`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, ClassVar, Literal, TypeAlias, cast

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.core.orientation import Line, Plane, number, parse_face, parse_plane
from slopekit.design.reading.nodes import Node, fail
from slopekit.design.reading.structure import (
    ANGLES,
    WRITTEN_ANGLES,
    OrientationKind,
    is_distribution,
)
from slopekit.design.words import line_of_words, measured

Scatter: TypeAlias = "Distribution | Fisher | Angles"
Name = Literal["normal", "lognormal", "uniform", "triangular"]
#: Required and optional parameters of each distribution, in the order in which they are written.
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
_STANDARD_DEVIATION: Mapping[str, Any] = {
    "least": 0.0,
    "code": "E186",
    "says": "a standard deviation is never negative",
}
_CONCENTRATION: Mapping[str, Any] = {
    "least": 0.0,
    "above": True,
    "code": "E165",
    "advice": "Joint sets have 10 (scattered) to 500 (tight).",
}


@dataclass(frozen=True)
class Distribution:
    """The distribution of a number: normal or lognormal (truncated if with `min` or `max`), uniform, triangular.

    `parameters` are in the default unit of the quantity `kind` (kPa for a pressure). Mean and standard deviation are
    those of the value itself before truncation, also for the lognormal.
    """

    name: Name
    parameters: Mapping[str, float]
    kind: str
    orientation_kind: ClassVar[None] = None

    @property
    def centre(self) -> float:
        """The value of a deterministic run: the mean (before truncation).

        >>> Distribution("triangular", {"min": 10.0, "mode": 20.0, "max": 36.0}, "angle").centre
        22.0
        """
        if "mean" in self.parameters:
            return self.parameters["mean"]
        return sum(self.parameters.values()) / len(self.parameters)


@dataclass(frozen=True)
class Fisher:
    """The Fisher distribution of an orientation about its mean, with the concentration `k` (Fisher 1953)."""

    mean: Plane | Line
    k: float

    @property
    def orientation_kind(self) -> OrientationKind:
        """Whether the orientation is a plane or a line."""
        return "plane" if isinstance(self.mean, Plane) else "line"

    @property
    def centre(self) -> Plane | Line:
        """The orientation of a deterministic run: the mean."""
        return self.mean


@dataclass(frozen=True)
class Angles:
    """An orientation whose dip or dip direction (plunge or trend of a line), or both, have distributions.

    >>> dip = Distribution("normal", {"mean": 45.0, "sd": 3.0}, "angle")
    >>> print(Angles("plane", dip, 115.0).centre)
    45/115
    """

    orientation_kind: OrientationKind
    steep: Distribution | float
    direction: Distribution | float

    @property
    def middle(self) -> tuple[float, float]:
        """The two angles of a deterministic run, in degrees; the direction between 0 and 360."""
        steep = self.steep if isinstance(self.steep, float) else self.steep.centre
        if isinstance(self.direction, float):
            return steep, self.direction
        direction = self.direction.centre
        return steep, direction if 0.0 <= direction <= 360.0 else direction % 360.0

    @property
    def centre(self) -> Plane | Line:
        """The orientation of a deterministic run."""
        steep, direction = self.middle
        return (
            Plane(steep, direction) if self.orientation_kind == "plane" else Line(direction, steep)
        )


@dataclass(frozen=True)
class Variable:
    """A random variable of a design: its dotted path, its distribution, and the place where it is written.

    >>> plane = Variable("joints.J1.plane", Fisher(Plane(45.0, 115.0), 100.0))
    >>> plane.columns, plane.coordinates
    (('joints.J1.plane.dip', 'joints.J1.plane.dip_direction'), ('joints.J1.plane.dip', 'joints.J1.plane.dip_direction'))
    """

    path: str
    distribution: Scatter
    location: str = field(default="", compare=False)

    @property
    def orientation_kind(self) -> OrientationKind | None:
        """Whether the variable is a plane or a line; None for a number."""
        return self.distribution.orientation_kind

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the variable's columns in samples: one, or two angles of an orientation in written order."""
        if self.orientation_kind is None:
            return (self.path,)
        first, second = (f"{self.path}.{angle}" for angle in WRITTEN_ANGLES[self.orientation_kind])
        return first, second

    @property
    def angles(self) -> tuple[str, str]:
        """The names of an orientation's steep angle and direction; empty for an angle without scatter."""
        if self.orientation_kind is None:
            return ("", "")
        steep, direction = (f"{self.path}.{angle}" for angle in ANGLES[self.orientation_kind])
        if isinstance(self.distribution, Angles):
            steep = "" if isinstance(self.distribution.steep, float) else steep
            direction = "" if isinstance(self.distribution.direction, float) else direction
        return steep, direction

    def assumed(self) -> list[tuple[str, str]]:
        """Return the values of a deterministic run by path; of two named angles only those with a distribution."""
        centre = self.distribution.centre
        if not isinstance(self.distribution, Angles):
            return [(self.path, number(centre) if isinstance(centre, float) else str(centre))]
        named_angles = zip(self.angles, self.distribution.middle, strict=True)
        return [(name, number(angle)) for name, angle in named_angles if name]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the independent coordinates, between which correlations can be given."""
        return (
            (self.path,)
            if self.orientation_kind is None
            else tuple(name for name in self.angles if name)
        )


def read_distribution(
    node: Node, kind: str, name: str, period: float | None = None
) -> Distribution:
    """Read the distribution of a number.

    Parameters
    ----------
    node : a mapping with the key dist
    kind : the kind of quantity, as `slopekit.core.units.quantity` takes it
    name : the name of the number in messages
    period : 360 for a direction, whose range may cross north: from min 350 to max 10 it spans 20 degrees

    Raises
    ------
    DesignError
        E105 to E108 for a parameter, E165 an unknown distribution, an unknown or missing parameter or fisher for a
        number, E186 sd below 0, min not below max, a centre outside its bounds, a lognormal mean not above 0.

    >>> from slopekit.design.reading.nodes import document_from
    >>> node = document_from({"c": {"dist": "uniform", "min": "10 kPa", "max": "0.03 MPa"}}).root.get("c")
    >>> read_distribution(node, "pressure", "c of weak").centre
    20.0
    """
    dist = _distribution_name(node, name)
    if dist == "fisher":
        advice = f"A number takes {_EXAMPLES['normal']}."
        fail("E165", f"{name} is a number, fisher is for orientations", str(node.place), advice)
    faults, values = Faults(_wrong_parameters(node, dist, name)), dict[str, float]()
    for key in sum(PARAMETERS[dist], ()):
        below = node.get(key)
        limits = _STANDARD_DEVIATION if key == "sd" else {}
        value = (
            None if not below else faults.of(node_number, below, kind, f"{key} of {name}", **limits)
        )
        if value is not None:
            values[key] = value
    values = values if period is None else _across_north(values, period)
    faults += _inconsistent_parameters(node, dist, values, name)
    faults.refuse()
    return Distribution(cast(Name, dist), values, kind)


def _across_north(values: dict[str, float], period: float) -> dict[str, float]:
    """Return the parameters of a direction across north, with values above the max reduced by the period.

    >>> _across_north({"min": 350.0, "mode": 355.0, "max": 10.0}, 360.0)
    {'min': -10.0, 'mode': -5.0, 'max': 10.0}
    """
    low, high = values.get("min"), values.get("max")
    if low is None or high is None or low <= high:
        return values
    shifted = [key for key in ("min", "mean", "mode") if values.get(key, high) > high]
    return {key: value - period if key in shifted else value for key, value in values.items()}


def read_orientation(node: Node, name: str, kind: OrientationKind = "plane") -> Fisher:
    """Read the Fisher distribution of a plane or a line.

    Raises
    ------
    DesignError
        E101 to E105 for the mean, E165 as for numbers, and for another distribution or k not above 0.

    >>> from slopekit.design.reading.nodes import document_from
    >>> node = document_from({"plane": {"dist": "fisher", "mean": "45/115", "k": 100}}).root.get("plane")
    >>> print(read_orientation(node, "J1").centre)
    45/115
    """
    dist = _distribution_name(node, name)
    if dist != "fisher":
        advice = f"An orientation takes {_EXAMPLES['fisher']}."
        fail("E165", f"{name} is an orientation, {dist} is for numbers", str(node.place), advice)
    faults = Faults(_wrong_parameters(node, dist, name))
    mean = (
        faults.of(_orientation, node.get("mean"), f"mean of {name}", kind)
        if node.get("mean")
        else None
    )
    k = (
        faults.of(node_number, node.get("k"), "ratio", f"k of {name}", **_CONCENTRATION)
        if node.get("k")
        else None
    )
    if faults or mean is None or k is None:
        raise DesignError(faults)
    return Fisher(mean, k)


def read_angles(node: Node, name: str, kind: OrientationKind = "plane") -> Angles:
    """Read an orientation given by its two angles, each a number or a distribution.

    Raises
    ------
    DesignError
        E105 to E108 for an angle that is no number, and the faults of `read_distribution`.

    >>> from slopekit.design.reading.nodes import document_from
    >>> dip = {"dist": "normal", "mean": 45, "sd": 3}
    >>> node = document_from({"plane": {"dip": dip, "dip_direction": 115}}).root.get("plane")
    >>> print(read_angles(node, "J1").centre)
    45/115
    """
    faults = Faults()
    (steep, direction), periods = ANGLES[kind], (None, 360.0)
    angles = [
        faults.of(_angle, node.get(angle), f"{angle} of {name}", period)
        for angle, period in zip((steep, direction), periods, strict=True)
    ]
    if (
        faults or angles[0] is None or angles[1] is None
    ):  # a missing angle is a fault of the structure, reported there
        raise DesignError(faults)
    return Angles(kind, angles[0], angles[1])


def _angle(node: Node, name: str, period: float | None) -> Distribution | float | None:
    """Read one angle of an orientation (degrees); None where it is missing."""
    if node.value is None:
        return None
    return (
        read_distribution(node, "angle", name, period)
        if is_distribution(node)
        else node_number(node, "angle", name)
    )


def _distribution_name(node: Node, name: str) -> str:
    dist_node = node.get("dist")
    text = (dist_node.text or "").strip()
    if text.lower() in PARAMETERS:
        return text.lower()
    location = str(dist_node.key_place if dist_node else node.place)
    advice = did_you_mean(text.lower(), PARAMETERS, f"Known: {', '.join(PARAMETERS)}.")
    name_text = repr(text) if text else "not named"
    raise DesignError(
        [
            Fault(
                "E165",
                f"the distribution of {name} is {name_text}, which is not known",
                location,
                advice,
            )
        ]
    )


def _wrong_parameters(node: Node, dist: str, name: str) -> Iterator[Fault]:
    needed, further = PARAMETERS[dist]
    for key, parameter_node in node.items():
        if key in (*needed, *further, "dist"):
            continue
        advice = did_you_mean(key, (*needed, *further), f"Write {_EXAMPLES[dist]}.")
        if dist == "normal" and key == "mode":
            advice = f"A mode belongs to {_EXAMPLES['triangular']}."
        yield Fault("E165", f"{dist} has no {key} ({name})", str(parameter_node.key_place), advice)
    for key in needed:
        if not node.get(key):
            message = f"{key} of {name} is missing, {dist} needs {', '.join(needed)}"
            yield Fault("E165", message, str(node.place), f"Write {_EXAMPLES[dist]}.")


def _inconsistent_parameters(
    node: Node, dist: str, values: Mapping[str, float], name: str
) -> Iterator[Fault]:
    """Yield fault E186 for each parameter that is inconsistent with the others."""
    low, high = values.get("min", -inf), values.get("max", inf)
    for key in ("min", "mean", "mode"):
        value, location = values.get(key), str((node.get(key) or node).key_place)
        if value is None:
            continue
        message, bound = f"{key} of {name} is {number(value)}", "max" if value > high else "min"
        if key == "min" and value >= high:
            yield Fault("E186", f"{message}, it must be less than max, {number(high)}", location)
        elif low < high and not low <= value <= high:
            side = "beyond" if bound == "max" else "below"
            message += f", {side} its {bound}, {number(values[bound])}"
            yield Fault("E186", message, location, f"Move the {key} or the {bound}.")
        if dist == "lognormal" and key == "mean" and value <= 0.0:
            advice = "Give the mean of the value itself, not of its logarithm."
            yield Fault(
                "E186", f"{message}, a lognormal value is always more than 0", location, advice
            )


def _value(node: Node) -> object:
    """Return a node's value for `quantity` and `parse_plane`: a text or a list, or a text for their messages."""
    if isinstance(node.value, dict):
        return "a group of keys"
    return [entry.text for entry in node.elements] if isinstance(node.value, list) else node.value


def _orientation(node: Node, name: str, kind: OrientationKind) -> Plane | Line:
    location = str(node.key_place)
    if kind == "plane":
        is_face = {"face", "upper"} & {*node.path.split(".")[-2:]}
        return (parse_face if is_face else parse_plane)(_value(node), name, location)
    return line_of_words(_value(node), name, "E165", location)


def node_number(node: Node, kind: str, name: str, **limits: Any) -> float:
    """Return the number of a node, within limits given as to `slopekit.design.words.measured`."""
    return measured(_value(node), kind, name, str(node.key_place), **limits)
