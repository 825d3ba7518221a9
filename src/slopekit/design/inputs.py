"""The tree of a design file as the flat inputs that the readers take: values with their places, strengths, water.

What concerns names is settled here: which strength an interface has, which of two words on water counts.
"""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from slopekit.design.nodes import Document, Node, as_text
from slopekit.design.strength_laws import LAW_KEYS, Bent, bent, named_law
from slopekit.design.structure import has_angles, is_distribution, orientation_kind
from slopekit.errors import DesignError, Fault

if TYPE_CHECKING:
    from slopekit.design.common import Pair
    from slopekit.design.correlation import Named
    from slopekit.design.distributions import Variable

BARE_NUMBER = re.compile(r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")


class FileSpelling:
    """The reader's names as dotted paths, and where their values stand in the file."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self.names = dict(names)
        self.places: dict[str, Node | list[Node]] = {}

    def key(self, name: str) -> str:
        """The dotted path of an input."""
        return self.names.get(name, name)

    def where(self, name: str, value: object, index: int | None = None) -> str:
        """The place of an input, or of one of its values."""
        at = self.places.get(name)
        if isinstance(at, list):
            at = at[min(index or 0, len(at) - 1)] if at else None
        elif at is not None and index is not None and index < len(at.elements):
            at = at.elements[index]
        return str(at.place) if at is not None else self.key(name)


NAMES = {
    "dips": "joints", "joint": "joints", "face": "slope.face", "upper": "slope.upper", "height": "slope.height",
    "origin": "slope.origin", "c": "strength.<name>.c", "phi": "strength.<name>.phi",
    "dilation": "strength.<name>.dilation", "tension": "strength.<name>.tension",
    "normal_stiffness": "strength.<name>.stiffness.normal", "shear_stiffness": "strength.<name>.stiffness.shear",
    "density": "rock.density", "unit_weight": "rock.unit_weight", "gravity": "rock.gravity",
    "water_unit_weight": "water.unit_weight", "seismic": "loads.seismic", "forces": "loads.forces",
    "bolts": "support.bolts", "criterion": "analysis.criterion", "agree_within": "analysis.agree_within",
    "stop_when": "analysis.stop_when", "refine": "analysis.refine", "factors": "analysis.factors",
    "accept": "acceptance.rules", "load": "footing.load", "load_at": "footing.at", "dip": "weak_plane.dip",
    "length": "weak_plane.length", "pairs": "weak_plane.pairs", "profile": "slope.profile",
    "crack_depth": "crack.depth", "crack_distance": "crack.distance", "crack_water": "crack.water",
    "shape": "slip.shape", "centre": "slip.centre", "radii": "slip.radii", "radius": "slip.radius",
    "slip_length": "slip.length", "edge": "slip.edge", "normals": "slip.normals",
}  # fmt: skip


_SEVERAL = ("forces", "bolts", "factors", "accept")  # inputs whose items are read each on its own


class Inputs:
    """Turns the tree into the flat inputs of a kind's reader; collects the faults of names on the way.

    Parameters
    ----------
    misshapen : places of values whose shape is wrong: those are not read
    other_values : whether values were put over those of a sound design
    """

    def __init__(
        self, document: Document, kind: str, misshapen: Collection[str] = (), other_values: bool = False
    ) -> None:
        self.document, self.root, self.kind = document, document.root, kind
        self.misshapen, self.other_values = frozenset(misshapen), other_values
        self.spelling = FileSpelling(NAMES)
        self.given: dict[str, Any] = {}
        self.faults: list[Fault] = []
        self.assumed: list[tuple[str, str]] = []
        self.variables: dict[str, Variable] = {}
        self.left_out: list[str] = []
        self.laws: list[Bent] = []

    # -- values with their places -----------------------------------------------------------------

    def at(self, path: str) -> Node | None:
        node: Node | None = self.root
        for part in path.split("."):
            node = node.get(part) if node is not None else None
        return node

    def take(self, name: str, path: str | None = None) -> None:
        """One input from its place in the file."""
        node = self.at(path or NAMES[name])
        if node is not None and node.value is not None:
            self.put(name, node)

    def put(self, name: str, node: Node) -> None:
        if name in _SEVERAL and isinstance(node.value, list):
            items = [item for item in node.elements if self.is_sound(item)]
            self.spelling.places[name] = items
            self.given[name] = [self.value(item) for item in items]
            return
        value = self.value(node)
        if value is not None:  # else it is a fault already
            self.spelling.places[name], self.given[name] = node, value

    def is_sound(self, node: Node) -> bool:
        """Whether a value and all in it have the shape they need."""
        if not self.misshapen:
            return True
        parts = node.elements or tuple(below for _, below in node.items())
        own = {str(node.place), str(node.key_place)}
        return self.misshapen.isdisjoint(own) and all(self.is_sound(part) for part in parts)

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
        text = node.text
        return float(text) if text is not None and BARE_NUMBER.match(text) else text

    def centre(self, node: Node) -> Any:
        """What a single run takes of a number that scatters, or of an orientation that is not written in one word."""
        from slopekit.design import distributions  # only where a value scatters
        from slopekit.design.quantities import quantity_of

        of = orientation_kind(node)
        found: distributions.Scatter
        try:
            if of is None:
                found = distributions.read_distribution(node, quantity_of(node.path, self.kind).kind, node.path)
            elif is_distribution(node):
                found = distributions.read_orientation(node, node.path, of)
            else:
                found = distributions.read_angles(node, node.path, of)
        except DesignError as error:
            self.faults += error.faults
            return None
        variable = distributions.Variable(node.path, found, str(node.place))
        if variable.coordinates and node.path not in self.variables:
            self.variables[node.path] = variable
            self.assumed += variable.assumed()
        return found.centre if isinstance(found, distributions.Distribution) else as_text(found.centre)

    def fault(self, code: str, message: str, node: Node | None, advice: str = "") -> None:
        self.faults.append(Fault(code, message, str((node or self.root).place), advice))

    # -- what every kind has ----------------------------------------------------------------------

    def shared(self) -> None:
        title = self.at("title")
        self.given["title"] = title.text if title is not None and title.text else ""
        for name in ("density", "unit_weight", "gravity", "criterion", "agree_within", "stop_when", "factors"):
            self.take(name)
        if self.kind != "footing":
            self.take("seismic")
            self.take("forces")
            self.take("bolts")
            seismic = self.given.get("seismic")
            if isinstance(seismic, dict):
                toward = seismic.get("toward")
                self.given["seismic"] = _text(seismic.get("k", 0)) + ("" if toward is None else f"@{_text(toward)}")
        self.take("accept")
        self.given["assumed"], self.given["left_out"] = self.assumed, self.left_out

    def correlation(self) -> "tuple[Pair, ...]":
        """The correlation between what scatters, by its coordinates; what is wrong with it becomes faults."""
        node = self.at("correlation")
        if node is None or not node.is_mapping:
            return ()
        from slopekit.design.correlation import check_correlation

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
        for joint, below in joints.items() if joints is not None else ():
            strength = below.get("strength")
            name = strength.text if strength is not None else self.only_strength()
            for key in ("c", "phi", "dilation", "tension", *LAW_KEYS):
                if (own := f"strength.{name}.{key}") in self.variables:
                    names[f"{joint}.{key}"] = own
        for group in ("joints.", "strength.", "sets."):
            names |= {path.removeprefix(group): own for path, own in names.items() if path.startswith(group)}
        return names

    def only_strength(self) -> str | None:
        node = self.at("strength")
        names = [name for name, _ in node.items()] if node is not None else []
        return names[0] if len(names) == 1 else None

    def strengths_of(self, users: Sequence[tuple[str, Node | None, Node]]) -> list[Node | None]:
        """The strength of each interface: the one it names, or the only one there is.

        Parameters
        ----------
        users : name of the interface, the node of its `strength` key, the node of the interface itself
        """
        strengths = self.at("strength")
        names = [name for name, _ in strengths.items()] if strengths is not None else []
        found: list[Node | None] = []
        for user, wanted, own in users:
            if wanted is not None and wanted.text is not None:
                if wanted.text not in names:
                    near = get_close_matches(wanted.text, names, n=1)
                    advice = f"Did you mean {near[0]}?" if near else f"There are: {', '.join(names)}." if names else ""
                    message = f"{user} has the strength {wanted.text}, which is not under strength"
                    self.fault("E176", message, wanted, advice)
                    found.append(None)
                    continue
                found.append(strengths.get(wanted.text) if strengths is not None else None)
            elif len(names) > 1:
                message = f"{user} names no strength, and there are {len(names)}"
                self.fault("E176", message, own, f"Add strength: {' or '.join(names[:4])}.")
                found.append(None)
            else:
                found.append(strengths.get(names[0]) if strengths is not None and names else None)
        used = {node.path for node in found if node is not None}
        if strengths is not None and len(names) > 1 and None not in found:
            for name, node in strengths.items():
                named = any(wanted is not None and wanted.text == name for _, wanted, _ in users)
                if node.path not in used and not named:
                    self.fault("E195", f"the strength {name} is used by no interface", node, "Use it or take it out.")
        return found

    def take_strengths(self, nodes: Sequence[Node | None]) -> None:
        """c, φ and the rest as one value for each interface; the stiffness has to be one for all.

        Parameters
        ----------
        nodes : of the interfaces' strengths; None where that is a fault already
        """
        sound = [node for node in nodes if node is not None]
        if not sound:
            return
        used = [sound[0] if node is None else node for node in nodes]  # the values of the others are read all the same
        of_path = {node.path: bent(self, node) for node in used}
        self.laws = [of_path[node.path] for node in used]
        if any(named_law(node) for node in used):
            self._beside_laws(used)
            return
        for key in ("c", "phi", "dilation", "tension"):
            values = [node.get(key) for node in used]
            present = [value for value in values if value is not None]
            # a wedge without any takes the paper's, and says so
            if key in ("c", "phi") and len(present) < len(values) and (present or self.kind != "wedge"):
                for path in dict.fromkeys(node.path for node in used if node.get(key) is None):
                    self.fault("E143", f"{path}.{key} is missing", self.at(path), f"Add {key}.")
                continue
            if not present:
                continue
            if len(present) < len(values):
                place = present[0]
                self.given[key] = [0.0 if value is None else self.value(value) for value in values]
                self.spelling.places[key] = [place if value is None else value for value in values]
                continue
            cache: dict[str, Any] = {}
            for value in present:
                if value.path not in cache:
                    cache[value.path] = self.value(value)
            numbers = [cache[value.path] for value in present]
            self.given[key] = numbers if len(used) > 1 else numbers[0]
            self.spelling.places[key] = present if len(used) > 1 else present[0]
        self.take_stiffness(used)

    def _beside_laws(self, used: Sequence[Node]) -> None:
        """The straight strengths beside curved ones, whose c and φ stand for nothing; each value has its place."""
        for key in ("c", "phi", "dilation", "tension"):
            read: dict[str, Any] = {}
            for node in used:
                own, of_law = node.get(key), key in ("c", "phi") and named_law(node) is not None
                if node.path in read:
                    continue
                if of_law or (own is None and key in ("dilation", "tension")):
                    read[node.path] = 45.0 if key == "phi" else 0.0
                elif own is None:
                    self.fault("E143", f"{node.path}.{key} is missing", node, f"Add {key}.")
                    read[node.path] = 0.0
                else:
                    read[node.path] = self.value(own)
            values = [read[node.path] for node in used]
            self.given[key] = values if len(used) > 1 else values[0]
            places = [node.get(key) or node for node in used]
            self.spelling.places[key] = places if len(used) > 1 else places[0]
        self.take_stiffness(used)

    def take_stiffness(self, strengths: Sequence[Node]) -> None:
        """The stiffness that is one for all of these strengths; E196 where it is not."""
        stiff = [node for own in strengths if (node := own.get("stiffness")) is not None]
        if len({str(node.plain()) for node in stiff}) > 1:
            other = stiff[-1]
            advice = "Give both strengths the same stiffness; the limit factor does not depend on it."
            self.fault("E196", "the strengths have different stiffness: displacements take one for all", other, advice)
        elif stiff:
            for key, name in (("normal", "normal_stiffness"), ("shear", "shear_stiffness")):
                node = stiff[0].get(key)
                if node is not None and node.value is not None:
                    self.put(name, node)

    def water(self, order: Sequence[str]) -> None:
        """Water of the interfaces in `order`, as the reader's word: dry, a fraction of full, or pressures."""
        node = self.at("water")
        if node is None or node.value is None:
            return
        self.spelling.places["water"] = node
        if not node.is_mapping:
            self.given["water"] = self.value(node)
            return
        weight = node.get("unit_weight")
        if weight is not None and weight.value is not None:
            self.put("water_unit_weight", weight)
        said = [key for key in ("mode", "fill", "pressures") if node.get(key) is not None]
        mode = node.get("mode")
        if mode is not None and mode.text == "full" and said == ["mode", "fill"]:
            said = ["fill"]  # so much of full
        if len(said) > 1:
            other = node.get(said[1])
            self.fault("E198", f"water has {' and '.join(said)}: they exclude each other", other, "Keep one of them.")
            return
        if not said:
            return
        only = node.get(said[0])
        assert only is not None
        self.spelling.places["water"] = only
        if said[0] != "pressures" or not only.is_mapping:
            self.given["water"] = self.value(only)
            if said[0] == "pressures" and not only.elements:
                self.given["water"] = [self.given["water"]]
            return
        unknown = [name for name, _ in only.items() if name not in order]
        for name in unknown:
            near = get_close_matches(name, order, n=1)
            advice = f"Did you mean {near[0]}?" if near else f"There are: {', '.join(order)}."
            self.fault("E197", f"water pressure on {name}: there is no such interface", only.get(name), advice)
        if not unknown:
            values = {name: self.value(below) for name, below in only.items()}
            last = max(order.index(name) for name in values)
            self.given["water"] = [values.get(name, 0.0) for name in order[: max(last + 1, min(2, len(order)))]]


def _text(value: object) -> str:
    return repr(value) if isinstance(value, float) else str(value)  # every digit: studies change the last of them
