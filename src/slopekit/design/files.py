"""From a design file to a checked design: the tree of YAML, its structure, its names, then the reader of its kind.

Every value keeps its place, so that each fault names its line and column, whatever finds it.
"""

import hashlib
import os
import re
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slopekit.design.common import Design, MeshFile
from slopekit.design.document import Document, Node, document_from, load_document, with_overrides
from slopekit.design.reading import wedge_design
from slopekit.design.specs import SPECS, VERSION
from slopekit.design.structure import check_structure, is_distribution
from slopekit.errors import DesignError, Fault
from slopekit.orientation import number

if TYPE_CHECKING:
    from slopekit.design.survey import Joint

Overrides = Sequence[tuple[str, object]]
_NUMBER = re.compile(r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")
_UNITS_OF = {
    "c": "pressure", "phi": "angle", "dilation": "angle", "tension": "pressure", "normal": "stiffness",
    "shear": "stiffness", "density": "density", "unit_weight": "unit weight", "gravity": "acceleration",
    "height": "length", "distance": "length", "depth": "length", "length": "length", "k": "ratio", "fill": "ratio",
    "force": "force", "load": "force", "dip": "angle", "at": "length",
}  # fmt: skip
_LENGTHS = ("centre", "radii", "radius", "edge")


def load(source: str | os.PathLike[str] | Mapping[str, Any], overrides: Overrides = ()) -> Design:
    """Read and check a design file (or the same as a Python mapping).

    Parameters
    ----------
    overrides : dotted paths and values that replace those of the file

    Raises
    ------
    DesignError
        With every fault found.
    """
    if isinstance(source, Mapping):
        return design_of(with_overrides(document_from(source), overrides))
    return design_of(load_document(source, overrides))


def design_of(document: Document) -> Design:
    """The design in a document.

    Raises
    ------
    DesignError
        E174 another version, E175 an unknown kind, and what structure, names and values are wrong.
    """
    root = document.root
    kind = _kind(root)
    faults = check_structure(root, SPECS[kind], kind, {name: spec for name, spec in SPECS.items() if name != kind})
    faults += _version(root)
    builder = _Builder(document, kind)
    unsound = {fault.where for fault in faults}
    try:
        design = builder.design()
    except DesignError as error:
        # what the structure has said of a place is not said again by the reader
        faults += [fault for fault in error.faults if fault.code not in ("E143", "E128") and fault.where not in unsound]
        if not faults:
            faults = list(error.faults)
        raise DesignError(dict.fromkeys(faults)) from None
    if faults:
        raise DesignError(dict.fromkeys(faults))
    return design


def _kind(root: Node) -> str:
    node = root.get("kind")
    known = ", ".join(SPECS)
    if node is None or node.text is None:
        where = str(node.place if node else root.place)
        raise DesignError([Fault("E175", "kind is missing: it says what the design is", where, f"Known: {known}.")])
    if node.text not in SPECS:
        near = get_close_matches(node.text.lower(), SPECS, n=1)
        advice = f"Did you mean {near[0]}?" if near else f"Known: {known}."
        raise DesignError([Fault("E175", f"{node.text} is not a kind of design", str(node.place), advice)])
    return node.text


def _version(root: Node) -> list[Fault]:
    node = root.get("slopekit")
    if node is None or node.text is None or node.text == str(VERSION):
        return []
    message = f"slopekit: {node.text} is not a version of design files that this slopekit reads"
    return [Fault("E174", message, str(node.place), f"Write slopekit: {VERSION}.")]


class _FileSpelling:
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


_NAMES = {
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


class _Builder:
    """Turns the tree into the flat inputs of a kind's reader; collects the faults of names on the way."""

    def __init__(self, document: Document, kind: str) -> None:
        self.document, self.root, self.kind = document, document.root, kind
        self.spelling = _FileSpelling(_NAMES)
        self.given: dict[str, Any] = {}
        self.faults: list[Fault] = []
        self.assumed: list[tuple[str, str]] = []
        self.variables: list[str] = []

    def design(self) -> Design:
        """Read all that is there; the kind's reader raises what is wrong with the values."""
        self.shared()
        made: Callable[[], Design] = getattr(self, self.kind)
        try:
            design = made()
        except DesignError as error:
            self.faults += error.faults
            raise DesignError(self.faults) from None
        self.correlation()
        if self.faults:
            raise DesignError(self.faults)
        return design

    # -- values with their places -----------------------------------------------------------------

    def at(self, path: str) -> Node | None:
        node: Node | None = self.root
        for part in path.split("."):
            node = node.get(part) if node is not None else None
        return node

    def take(self, name: str, path: str | None = None) -> None:
        """One input from its place in the file."""
        node = self.at(path or _NAMES[name])
        if node is not None and node.value is not None:
            self.put(name, node)

    def put(self, name: str, node: Node) -> None:
        self.spelling.places[name] = node
        self.given[name] = self.value(node)

    def value(self, node: Node) -> Any:
        """What a node says, numbers as numbers, distributions by the value a single run takes."""
        if is_distribution(node):
            return self.centre(node)
        if node.is_mapping:
            return {key: self.value(below) for key, below in node.items()}
        if node.elements or isinstance(node.value, list):
            return [self.value(below) for below in node.elements]
        text = node.text
        return float(text) if text is not None and _NUMBER.match(text) else text

    def centre(self, node: Node) -> Any:
        from slopekit.design.distributions import read_distribution, read_orientation  # only where a value scatters

        kind = _UNITS_OF.get(node.name, "ratio")
        try:
            if node.name in ("plane", "face", "upper", "toward"):
                middle = read_orientation(node, node.path).centre
                shown = str(middle)
                value: Any = shown
            else:
                value = read_distribution(node, kind, node.path).centre
                shown = number(value)
        except DesignError as error:
            self.faults += error.faults
            return None
        self.assumed.append((node.path, shown))
        self.variables.append(node.path)
        return value

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
        self.given["assumed"] = self.assumed

    def correlation(self) -> None:
        node = self.at("correlation")
        if node is not None and node.is_mapping:
            from slopekit.design.distributions import check_correlation

            _, faults = check_correlation(node, self.short_names())
            self.faults += faults

    def short_names(self) -> list[str]:
        """Names of the variables for a correlation: their paths, and `J1.phi` for the φ of J1's strength."""
        names = list(self.variables)
        joints = self.at("joints")
        for joint, below in joints.items() if joints is not None else ():
            strength = below.get("strength")
            name = strength.text if strength is not None else self.only_strength()
            for key in ("c", "phi", "dilation", "tension"):
                if f"strength.{name}.{key}" in self.variables:
                    names.append(f"{joint}.{key}")
            names += [f"{joint}.plane"] if f"joints.{joint}.plane" in self.variables else []
        names += [path.removeprefix("strength.") for path in self.variables if path.startswith("strength.")]
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
        if strengths is not None and len(names) > 1:
            for name, node in strengths.items():
                named = any(wanted is not None and wanted.text == name for _, wanted, _ in users)
                if node.path not in used and not named:
                    self.fault("E195", f"the strength {name} is used by no interface", node, "Use it or take it out.")
        return found

    def take_strengths(self, nodes: Sequence[Node | None]) -> None:
        """c, φ and the rest as one value for each interface; the stiffness has to be one for all."""
        for key in ("c", "phi", "dilation", "tension"):
            values = [node.get(key) if node is not None else None for node in nodes]
            present = [value for value in values if value is not None]
            if not present:
                continue
            if len(present) < len(values):
                if key in ("c", "phi"):
                    lacking = next(node for node, value in zip(nodes, values, strict=True) if value is None)
                    if lacking is not None:
                        self.fault("E143", f"{lacking.path}.{key} is missing", lacking, f"Add {key}.")
                    continue
                place = present[0]
                self.given[key] = [0.0 if value is None else self.value(value) for value in values]
                self.spelling.places[key] = [place if value is None else value for value in values]
                continue
            cache: dict[str, Any] = {}
            for value in present:
                if value.path not in cache:
                    cache[value.path] = self.value(value)
            numbers = [cache[value.path] for value in present]
            self.given[key] = numbers if len(nodes) > 1 else numbers[0]
            self.spelling.places[key] = present if len(nodes) > 1 else present[0]
        stiff = [node.get("stiffness") for node in nodes if node is not None]
        said = [None if node is None else str(node.plain()) for node in stiff]
        if len(set(said)) > 1:
            other = next(node for node in reversed(stiff) if node is not None)
            advice = "Give both strengths the same stiffness; the limit factor does not depend on it."
            self.fault("E196", "the strengths have different stiffness: displacements take one for all", other, advice)
        elif stiff and stiff[0] is not None:
            for key, name in (("normal", "normal_stiffness"), ("shear", "shear_stiffness")):
                node = stiff[0].get(key)
                if node is not None and node.value is not None:
                    self.put(name, node)

    # -- joints, water, files ---------------------------------------------------------------------

    def joints(self, count: int) -> list[str]:
        """`dips` or `joint` from the file or a CSV, with their strengths; returns their names."""
        node = self.at("joints")
        if node is None or not node.is_mapping:
            return []
        if node.get("csv") is not None:
            return self.joints_from_csv(node, count)
        entries = [(name, below) for name, below in node.items() if below.is_mapping]
        if len(entries) != count:
            needed = "two joints" if count == 2 else "one joint"
            self.fault("E109", f"a {self.kind} has {needed}, {len(node.items())} are given", node)
            return []
        planes = [below.get("plane") for _, below in entries]
        if all(plane is not None and plane.value is not None for plane in planes):
            sure = [plane for plane in planes if plane is not None]
            values = [self.value(plane) for plane in sure]
            if None not in values:
                self.given["dips" if count == 2 else "joint"] = values if count == 2 else values[0]
                self.spelling.places["dips" if count == 2 else "joint"] = sure if count == 2 else sure[0]
        users = [(name, below.get("strength"), below) for name, below in entries]
        if self.at("strength") is not None:
            self.take_strengths(self.strengths_of(users))
        return [name for name, _ in entries]

    def joints_from_csv(self, node: Node, count: int) -> list[str]:
        from slopekit.design.survey import read_joints

        file, pick, convention = node.get("csv"), node.get("pick"), node.get("convention")
        assert file is not None
        try:
            survey = read_joints(self.beside(file), convention.text if convention is not None else None)
        except DesignError as error:
            self.faults += error.faults
            return []
        names = [joint.name for joint in survey.joints]
        wanted = names if pick is None else [item.text or "" for item in (pick.elements or (pick,))]
        missing = [name for name in wanted if name not in names]
        for name in missing:
            near = get_close_matches(name, names, n=1)
            advice = f"Did you mean {near[0]}?" if near else f"There are: {', '.join(names[:8])}."
            self.fault("E197", f"{file.text} has no joint {name}", pick, advice)
        if missing:
            return []
        if len(wanted) != count:
            needed = "two joints" if count == 2 else "one joint"
            message = f"a {self.kind} takes {needed}, {len(wanted)} come from {file.text}"
            self.fault("E109", message, pick or file, f"Add pick: [{', '.join(names[:count])}].")
            return []
        chosen = [survey.joints[names.index(name)] for name in wanted]
        self.given["dips" if count == 2 else "joint"] = (
            [joint.plane for joint in chosen] if count == 2 else chosen[0].plane
        )
        self.spelling.places["dips" if count == 2 else "joint"] = [file] * count if count == 2 else file
        self.csv_strengths(node, file, chosen)
        return list(wanted)

    def csv_strengths(self, node: Node, file: Node, chosen: "Sequence[Joint]") -> None:
        """Strengths of joints from a CSV: its own columns, or those of the file."""
        for key in ("c", "phi"):
            own = [getattr(joint, key) for joint in chosen]
            if all(value is not None for value in own):
                self.given[key] = own if len(own) > 1 else own[0]
                self.spelling.places[key] = [file] * len(own) if len(own) > 1 else file
        if "c" in self.given and "phi" in self.given and self.at("strength") is None:
            return
        users = [(joint.name, node.get("strength"), file) for joint in chosen]
        if self.at("strength") is not None:
            kept = {key: (self.given[key], self.spelling.places[key]) for key in ("c", "phi") if key in self.given}
            self.take_strengths(self.strengths_of(users))
            for key, (value, place) in kept.items():
                self.given[key], self.spelling.places[key] = value, place

    def beside(self, node: Node) -> Path:
        """A file that the design names, relative to the design's own folder."""
        named = Path(node.text or "")
        return named if named.is_absolute() or self.document.path is None else self.document.path.parent / named

    def mesh(self, node: Node) -> MeshFile | None:
        path = self.beside(node)
        try:
            content = path.read_bytes()
        except (OSError, ValueError):
            folder = path.parent
            try:
                there = sorted(os.listdir(folder))
            except (OSError, ValueError):
                there = []
            near = get_close_matches(path.name, there, n=1)
            advice = f"Did you mean {near[0]}?" if near else "It is looked for beside the design file."
            self.fault("E172", f"the mesh {node.text} cannot be read: there is no such file", node, advice)
            return None
        return MeshFile(path.name, hashlib.sha256(content).hexdigest(), str(path))

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
            said = ["fill"]
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

    # -- the kinds --------------------------------------------------------------------------------

    def wedge(self) -> Design:
        for name in ("face", "upper", "height", "origin", "refine"):
            self.take(name)
        names = self.joints(2)
        if "c" not in self.given and "phi" not in self.given and self.only_strength() and not names:
            self.take_strengths([self.at(f"strength.{self.only_strength()}")] * 2)
        crack = self.at("crack")
        self.water([*(names or ["J1", "J2"]), *(["crack"] if crack is not None else [])])
        if crack is not None and crack.is_mapping:
            self.spelling.places["crack"] = crack
            plane, distance = crack.get("plane"), crack.get("distance")
            if plane is not None and distance is not None:
                self.given["crack"] = {"plane": self.value(plane), "distance": self.value(distance)}
            self.wedge_crack_water(crack)
        return wedge_design(
            self.given | {"joint_names": tuple(names or ("J1", "J2"))}, spelling=self.spelling
        )  # fmt: skip

    def wedge_crack_water(self, crack: Node) -> None:
        """The crack's own word on water has to fit what the joints have; a pressure is the third of theirs."""
        node = crack.get("water")
        if node is None or node.value is None:
            return
        water, value = self.given.get("water", "dry"), self.value(node)
        listed = isinstance(water, list)
        if value == "dry" and (water == "dry" or (listed and len(water) < 3)):
            return
        if value == "full" and (not listed and water not in ("dry", 0.0)):
            return
        if value == "full" and self.at("water") is None:
            self.given["water"] = "full"
            self.spelling.places["water"] = node
            return
        if value not in ("dry", "full") and (listed or water == "dry"):
            joints = (list(water) * 2)[:2] if listed else [0.0, 0.0]
            self.given["water"] = [*joints, value]
            self.spelling.places["water"] = node
            return
        advice = "Full water in the crack goes with full water on the joints (Hoek & Bray); or give pressures."
        self.fault("E198", f"the crack's water is {node.text}, the joints' is not", node, advice)

    def plane(self) -> Design:
        from slopekit.design.reading_kinds import plane_design

        for name in ("face", "upper", "height", "refine", "crack_depth", "crack_distance"):
            self.take(name)
        crack = self.at("crack")
        if crack is not None and not ({"depth", "distance"} & {key for key, _ in crack.items()}):
            self.fault("E143", "crack.depth is missing", crack, "Add depth: 4.35 m, or distance: 4 m from the crest.")
        water = crack.get("water") if crack is not None else None
        if water is not None and water.value is not None:
            if water.text in ("dry", "full"):
                if self.at("water") is None:
                    self.given["water"] = water.text
                    self.spelling.places["water"] = water
                else:
                    self.fault("E198", "crack.water and water both say how full it is", water, "Keep one of them.")
            else:
                self.put("crack_water", water)
        names = self.joints(1)
        self.water([*(names or ["J1"]), *(["crack"] if crack is not None else [])])
        if "crack_water" in self.given and self.given.get("water", "dry") != "dry":
            self.fault("E198", "crack.water and water both say how full it is", water, "Keep one of them.")
        return plane_design(self.given | {"joint_name": names[0] if names else "J1"}, self.spelling)

    def footing(self) -> Design:
        from slopekit.design.reading_kinds import footing_design

        for name in ("load", "dip", "length", "pairs"):
            self.take(name)
        at = self.at("footing.at")
        if at is not None and at.text != "middle":
            self.take("load_at")
        node = self.at("weak_plane")
        if node is not None and self.at("strength") is not None:
            self.take_strengths(self.strengths_of([("weak_plane", node.get("strength"), node)]))
        return footing_design(self.given, self.spelling)

    def surface(self) -> Design:
        from slopekit.design.reading_kinds import surface_design

        slip, slope = self.at("slip"), self.at("slope")
        for name in ("profile", "shape", "centre", "radii", "radius", "slip_length", "edge", "normals"):
            self.take(name)
        for key, holder, other in (("slip_mesh", slip, "shape"), ("ground_mesh", slope, "profile")):
            node = holder.get("mesh") if holder is not None else None
            if node is not None and node.text is not None:
                if holder is not None and holder.get(other) is not None:
                    self.fault("E112", f"{holder.path} has mesh and {other}", node, "Give one of the two.")
                self.given[key] = self.mesh(node)
                self.spelling.places[key] = node
            elif holder is not None and holder.get(other) is None:
                self.fault("E143", f"{holder.path}.{other} is missing", holder, f"Add {other}: or mesh:.")
        if self.at("strength") is not None:
            where = slip if slip is not None else self.root
            self.take_strengths(self.strengths_of([("slip", None, where)]))
        self.water(["slip"])
        return surface_design(self.given, self.spelling)


def _text(value: object) -> str:
    return number(value) if isinstance(value, float) else str(value)


__all__ = ["design_of", "load"]
