"""Numbers and orientations that scatter: `{dist: normal, mean: 20, sd: 2}`, and the correlation between them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal, cast

from slopekit.design.nodes import Node
from slopekit.design.structure import is_distribution
from slopekit.design.words import line_of_words
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Line, Plane, number, parse_plane
from slopekit.units import quantity

Correlation = dict[tuple[str, str], float]
Name = Literal["normal", "lognormal", "uniform", "triangular"]
# needed and further parameters of each
_PARAMETERS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
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
_EIGENVALUE_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Distribution:
    """A number that scatters: normal or lognormal (with `min` and `max`: truncated), uniform, triangular.

    `parameters` are in the unit of bare numbers of `kind` (kPa for a pressure). Mean and standard deviation are
    those of the value itself before truncation, also for the lognormal.
    """

    name: Name
    parameters: Mapping[str, float]
    kind: str

    @property
    def centre(self) -> float:
        """The value that a single run takes: the mean (of a truncated normal: the one given).

        >>> Distribution("triangular", {"min": 10.0, "mode": 20.0, "max": 36.0}, "angle").centre
        22.0
        """
        if "mean" in self.parameters:
            return self.parameters["mean"]
        return sum(self.parameters.values()) / len(self.parameters)


@dataclass(frozen=True, slots=True)
class Fisher:
    """An orientation that scatters about a mean; `k` is Fisher's concentration (Fisher 1953)."""

    mean: Plane | Line
    k: float

    @property
    def centre(self) -> Plane | Line:
        """The orientation that a single run takes: the mean."""
        return self.mean


def read_distribution(node: Node, kind: str, name: str) -> Distribution:
    """The distribution of a number.

    Parameters
    ----------
    node : a mapping with the key dist
    kind : the kind of quantity, as `slopekit.units.quantity` takes it
    name : what it is, for the messages

    Raises
    ------
    DesignError
        E105 to E108 for a parameter, E165 unknown distribution, E184 parameter missing, E185 parameter that it does
        not have, E186 sd below 0, E187 min not below max, E188 centre outside its bounds, E189 lognormal with a mean
        not above 0, E166 fisher for a number.

    >>> from slopekit.design.nodes import document_from
    >>> node = document_from({"c": {"dist": "uniform", "min": "10 kPa", "max": "0.03 MPa"}}).root.get("c")
    >>> read_distribution(node, "pressure", "c of weak").centre
    20.0
    """
    dist = _dist(node, name)
    if dist == "fisher":
        advice = f"A number takes {_EXAMPLES['normal']}."
        raise DesignError([Fault("E166", f"{name} is a number, fisher is for orientations", str(node.place), advice)])
    faults = _wrong_parameters(node, dist, name)
    values: dict[str, float] = {}
    for key in sum(_PARAMETERS[dist], ()):
        given = node.get(key)
        if given is None:
            continue
        value = _number(given, kind, f"{key} of {name}", faults)
        if value is not None:
            values[key] = value
    faults += _impossible(node, dist, values, name)
    if faults:
        raise DesignError(faults)
    return Distribution(cast(Name, dist), values, kind)


def read_orientation(node: Node, name: str, of: Literal["plane", "line"] = "plane") -> Fisher:
    """The Fisher distribution of a plane or a line.

    Raises
    ------
    DesignError
        E101 to E105 for the mean, E165, E184 and E185 as for numbers, E166 another distribution or k not above 0.

    >>> from slopekit.design.nodes import document_from
    >>> node = document_from({"plane": {"dist": "fisher", "mean": "45/115", "k": 100}}).root.get("plane")
    >>> print(read_orientation(node, "J1").centre)
    45/115
    """
    dist = _dist(node, name)
    if dist != "fisher":
        advice = f"An orientation takes {_EXAMPLES['fisher']}."
        raise DesignError([Fault("E166", f"{name} is an orientation, {dist} is for numbers", str(node.place), advice)])
    faults = _wrong_parameters(node, dist, name)
    mean: Plane | Line | None = None
    k: float | None = None
    given = node.get("mean")
    if given is not None:
        try:
            mean = _orientation(given, f"mean of {name}", of)
        except DesignError as error:
            faults += error.faults
    concentration = node.get("k")
    if concentration is not None:
        where = str(concentration.key_place)
        k = _number(concentration, "ratio", f"k of {name}", faults)
        if k is not None and k <= 0.0:
            advice = "Joint sets have 10 (scattered) to 500 (tight)."
            faults.append(Fault("E166", f"k of {name} is {number(k)}, it must be more than 0", where, advice))
    if faults or mean is None or k is None:
        raise DesignError(faults)
    return Fisher(mean, k)


def check_correlation(node: Node, known_keys: Iterable[str]) -> tuple[Correlation, list[Fault]]:
    """The correlation coefficients of a design, and what is wrong with them.

    Parameters
    ----------
    node : mapping of A/B to a coefficient
    known_keys : the names that scatter in this design

    Returns
    -------
    coefficients by pair, as written, and faults: E105 to E108 for a coefficient, E144 no mapping, E167 a key that is
    no pair, E168 an unknown name, E180 a coefficient beyond -1 to 1, E181 a pair twice, E182 a name with itself,
    E183 coefficients that contradict each other.

    The matrix R must have no negative eigenvalue; with the smallest, λ < 0, the largest s for which I + s (R - I)
    has none is 1 / (1 - λ).

    >>> from slopekit.design.nodes import document_from
    >>> check_correlation(document_from({"J1.phi/J2.phi": 0.8}).root, ["J1.phi", "J2.phi"])
    ({('J1.phi', 'J2.phi'): 0.8}, [])
    """
    known = list(known_keys)
    pairs: Correlation = {}
    faults: list[Fault] = []
    seen: dict[frozenset[str], str] = {}
    if not node.is_mapping and node.value is not None:
        advice = "Write correlation: {J1.phi/J2.phi: 0.8}"
        return {}, [Fault("E144", "correlation is not a group of pairs", str(node.place), advice)]
    for key, given in node.items():
        where = str(given.key_place)
        names = tuple(part.strip() for part in key.split("/"))
        if len(names) != 2 or not all(names):
            advice = "A pair is written J1.phi/J2.phi."
            faults.append(Fault("E167", f"{key} is not a pair of two names", where, advice))
            continue
        a, b = names
        unknown = [name for name in dict.fromkeys(names) if name not in known]
        faults += [_unknown_name(name, known, where) for name in unknown]
        if a == b:
            faults.append(Fault("E182", f"{a} is correlated with itself, that is always 1", where, "Leave it out."))
            continue
        if frozenset(names) in seen:
            message = f"{a}/{b} is the same pair as {seen[frozenset(names)]}"
            faults.append(Fault("E181", message, where, "Leave one of them out."))
            continue
        seen[frozenset(names)] = key
        value = _number(given, "ratio", f"correlation {key}", faults)
        if value is not None and not -1.0 <= value <= 1.0:
            faults.append(Fault("E180", f"correlation {key} is {number(value)}, it lies between -1 and 1", where))
        elif value is not None and not unknown:
            pairs[a, b] = value
    if not faults:
        faults += _contradiction(pairs, node)
    return pairs, faults


def _contradiction(pairs: Correlation, node: Node) -> list[Fault]:
    import numpy as np

    names = list(dict.fromkeys(name for pair in pairs for name in pair))
    matrix = np.eye(len(names))
    for (a, b), value in pairs.items():
        i, j = names.index(a), names.index(b)
        matrix[i, j] = matrix[j, i] = value
    if not names:
        return []
    values, vectors = np.linalg.eigh(matrix)
    smallest = float(values[0])
    if smallest >= -_EIGENVALUE_TOLERANCE:
        return []
    involved = [name for name, part in zip(names, vectors[:, 0], strict=True) if abs(part) > 1e-6]
    scale = int(1e4 / (1.0 - smallest)) / 1e4
    message = (
        f"the correlations of {', '.join(involved)} contradict each other: "
        f"the smallest eigenvalue is {smallest:.4g}, it must not be negative"
    )
    advice = f"Multiply the correlations by {number(scale)} or less."
    return [Fault("E183", message, str(node.key_place), advice)]


def _unknown_name(name: str, known: list[str], where: str) -> Fault:
    near = get_close_matches(name, known, n=1)
    scattering = f"These scatter: {', '.join(known[:12])}." if known else "Nothing in this design is a distribution."
    advice = f"Did you mean {near[0]}?" if near else scattering
    return Fault("E168", f"{name} is not a value that scatters in this design", where, advice)


def _dist(node: Node, name: str) -> str:
    given = node.get("dist")
    text = (given.text or "").strip() if given is not None else ""
    if text.lower() in _PARAMETERS:
        return text.lower()
    where = str(given.key_place if given is not None else node.place)
    near = get_close_matches(text.lower(), _PARAMETERS, n=1)
    advice = f"Did you mean {near[0]}?" if near else f"Known: {', '.join(_PARAMETERS)}."
    shown = repr(text) if text else "not named"
    raise DesignError([Fault("E165", f"the distribution of {name} is {shown}, which is not known", where, advice)])


def _wrong_parameters(node: Node, dist: str, name: str) -> list[Fault]:
    needed, further = _PARAMETERS[dist]
    faults = []
    for key, given in node.items():
        if key in (*needed, *further, "dist"):
            continue
        near = get_close_matches(key, (*needed, *further), n=1)
        advice = f"Did you mean {near[0]}?" if near else f"Write {_EXAMPLES[dist]}."
        if dist == "normal" and key == "mode":
            advice = f"A mode belongs to {_EXAMPLES['triangular']}."
        faults.append(Fault("E185", f"{dist} has no {key} ({name})", str(given.key_place), advice))
    for key in needed:
        if node.get(key) is None:
            message = f"{key} of {name} is missing, {dist} needs {', '.join(needed)}"
            faults.append(Fault("E184", message, str(node.place), f"Write {_EXAMPLES[dist]}."))
    return faults


def _impossible(node: Node, dist: str, values: Mapping[str, float], name: str) -> list[Fault]:
    """Parameters that each are numbers but cannot stand together."""
    faults: list[Fault] = []

    def fault(code: str, key: str, message: str, advice: str = "") -> None:
        given = node.get(key) or node
        faults.append(Fault(code, message, str(given.key_place), advice))

    low, high = values.get("min"), values.get("max")
    if values.get("sd", 0.0) < 0.0:
        fault("E186", "sd", f"sd of {name} is {number(values['sd'])}, a standard deviation is never negative")
    if low is not None and high is not None and low >= high:
        fault("E187", "min", f"min of {name} is {number(low)}, it must be less than max, {number(high)}")
    else:
        for key in ("mean", "mode"):
            centre = values.get(key)
            if centre is None or ((low is None or low <= centre) and (high is None or centre <= high)):
                continue
            bound, side = ("max", high) if high is not None and centre > high else ("min", low)
            message = f"{key} of {name} is {number(centre)}, {'beyond' if bound == 'max' else 'below'} its {bound}"
            fault("E188", key, f"{message}, {number(side or 0.0)}", f"Move the {key} or the {bound}.")
    if dist == "lognormal" and values.get("mean", 1.0) <= 0.0:
        message = f"mean of {name} is {number(values['mean'])}, a lognormal value is always more than 0"
        fault("E189", "mean", message, "Give the mean of the value itself, not of its logarithm.")
    return faults


def _value(node: Node) -> object:
    """What `quantity` and `parse_plane` read: a text, or what their message shall show."""
    if isinstance(node.value, dict):
        return "a group of keys"
    return [part.text for part in node.elements] if isinstance(node.value, list) else node.value


def _orientation(node: Node, name: str, of: Literal["plane", "line"]) -> Plane | Line:
    where = str(node.key_place)
    if of == "plane":
        return parse_plane(_value(node), name, where)
    return line_of_words(_value(node), name, "E166", where)


def _number(node: Node, kind: str, name: str, faults: list[Fault]) -> float | None:
    """The number of a node, or None and its faults kept."""
    try:
        return quantity(_value(node), kind, name, str(node.key_place))
    except DesignError as error:
        faults += error.faults
        return None


__all__ = ["Distribution", "Fisher", "check_correlation", "is_distribution", "read_distribution", "read_orientation"]
