"""What designs of many blocks share in their files: named strengths, water by pressures, loads on named blocks."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any, TypeVar

from slopekit.design import words
from slopekit.design.common import Bolt, Force, Seismic, Strength, Water
from slopekit.design.inputs import Inputs
from slopekit.design.nodes import Node
from slopekit.design.reader import Reader
from slopekit.design.strength_laws import bent, named_law
from slopekit.errors import DesignError, Fault
from slopekit.orientation import number
from slopekit.units import quantity

MOST_BLOCKS = 200_000
_MOST_MECHANISMS = 1000
_MOST_GUESSES = 10  # did-you-mean among ten thousand names takes its time
_SECTION_TRENDS = (90.0, 270.0)
_TREND_TOLERANCE = 1e-6
_OFF_SECTION = 1e-9  # of a force, across the section: what rounding leaves of toward: 270/00

T = TypeVar("T")


class AssemblyInputs:
    """Reads values straight from the tree, each with its place, and collects the faults of all.

    Numbers that are missing or wrong come back as None; a fault stands for each.
    """

    def __init__(self, inputs: Inputs) -> None:
        self.inputs = inputs
        self.faults = inputs.faults
        self.guesses = 0
        self.loads: dict[str, list[tuple[Any, Node]]] = {}
        for key in ("forces", "bolts"):
            values, nodes = inputs.given.pop(key, []), inputs.spelling.places.pop(key, [])
            self.loads[key] = list(zip(values, nodes, strict=True)) if isinstance(nodes, list) else []

    # -- numbers ----------------------------------------------------------------------------------

    def number(self, node: Node | None, kind: str, name: str, default: float | None = None) -> float | None:
        """A number with a unit of its kind; the default where it is not given."""
        if node is None or node.value is None:
            return default
        value = self.inputs.value(node)
        return None if value is None else self.kept(lambda: quantity(value, kind, name, str(node.place)))

    def above_zero(
        self, node: Node | None, kind: str, name: str, code: str, default: float | None = None
    ) -> float | None:
        """A number that must be more than 0."""
        found = self.number(node, kind, name, default)
        if found is not None and found <= 0.0:
            self.inputs.fault(code, f"{name} is {number(found)}, it must be more than 0", node)
            return None
        return found

    def whole(self, path: str, name: str, within: tuple[int, int], default: int) -> int | None:
        """A whole number within bounds; E137."""
        node = self.inputs.at(path)
        found = self.number(node, "ratio", name, float(default))
        if found is not None and (found != int(found) or not within[0] <= found <= within[1]):
            message = f"{name} is {number(found)}, it must be a whole number from {within[0]} to {within[1]}"
            self.inputs.fault("E137", message, node)
            return None
        return None if found is None else int(found)

    def kept(self, read: Callable[[], T]) -> T | None:
        """What a reading function returns; its faults are kept, and None returned, where it raises them."""
        try:
            return read()
        except DesignError as error:
            self.faults += error.faults
            return None

    def nearest(self, name: str, known: Collection[str]) -> str:
        """An advice for a name that is not known."""
        self.guesses += 1
        near = get_close_matches(name, known, n=1) if self.guesses <= _MOST_GUESSES else []
        if near:
            return f"Did you mean {near[0]}?"
        shown = list(known)[:8]
        return f"There are: {', '.join(shown)}{', …' if len(known) > len(shown) else ''}."

    # -- strengths and water ----------------------------------------------------------------------

    def strengths(self) -> tuple[tuple[str, Strength], ...]:
        """Every strength by its name; one stiffness for all."""
        node = self.inputs.at("strength")
        named = [(name, below) for name, below in node.items() if below.is_mapping] if node is not None else []
        self.inputs.take_stiffness([below for _, below in named])
        read = [(name, self.strength(name, below)) for name, below in named]
        return tuple((name, strength) for name, strength in read if strength is not None)

    def strength(self, name: str, node: Node) -> Strength | None:
        """One strength: E143, E113 to E115, E117."""
        checks = {
            "c": ("pressure", Reader.check_cohesion), "phi": ("angle", Reader.check_friction),
            "dilation": ("angle", None), "tension": ("pressure", Reader.check_tension),
        }  # fmt: skip
        found: dict[str, float | None] = {}
        by_law, curved = bent(self.inputs, node), named_law(node) is not None
        for key, (kind, check) in checks.items():
            if curved and key in ("c", "phi"):
                found[key] = 45.0 if key == "phi" else 0.0
                continue
            below = node.get(key)
            if below is None and key in ("c", "phi"):
                self.inputs.fault("E143", f"{node.path}.{key} is missing", node, f"Add {key}.")
            shown = f"{key} of {name}"
            value = self.number(below, kind, shown, None if key in ("c", "phi") else 0.0)
            if value is not None and check is not None and below is not None:
                place, sure = str(below.place), value
                self.kept(lambda check=check, sure=sure, shown=shown, place=place: check(sure, shown, place))  # type: ignore[misc]
            found[key] = value
        friction, dilation = found["phi"], found["dilation"]
        if friction is not None and dilation is not None and not 0.0 <= dilation <= max(friction, 0.0):
            message = f"dilation of {name} is {number(dilation)}°, it lies between 0 and the friction angle"
            self.inputs.fault("E117", f"{message} {number(friction)}°", node.get("dilation") or node)
        if None in found.values():
            return None
        cohesion, friction, dilation, tension = (value for value in found.values() if value is not None)
        return by_law.of(Strength(cohesion, friction, dilation, tension))

    def pressures(self, example: str) -> list[tuple[str, Node, float]]:
        """Mean water pressures as the file names them; E179 for water said in another way, E119 below 0."""
        node = self.inputs.at("water")
        if node is None or node.value is None:
            return []
        said = [key for key in ("mode", "fill", "pressures") if node.get(key) is not None]
        other = node if not node.is_mapping else node.get(said[0]) if said and said[0] != "pressures" else None
        if other is not None and (other.name == "fill" or other.text not in ("dry", None)):
            message = f"water is {other.text}: in a {self.inputs.kind} design it is dry, or given by its pressures"
            self.inputs.fault("E179", message, other, f"Write water: {{pressures: {example}}}.")
        if len(said) > 1:
            message = f"water has {' and '.join(said)}: they exclude each other"
            self.inputs.fault("E198", message, node.get(said[1]), "Keep one of them.")
        given = node.get("pressures")
        found = []
        for name, below in given.items() if given is not None else ():
            value = self.number(below, "pressure", f"water pressure on {name}")
            if value is not None and value < 0.0:
                message = f"water pressure on {name} is {number(value)} kPa, it is never negative"
                self.inputs.fault("E119", message, below)
            elif value is not None:
                found.append((name, below, value))
        return found

    def named_pressures(self, known: Sequence[str], example: str) -> dict[str, float]:
        """Pressures on interfaces of these names; E197 on others."""
        found = self.pressures(example)
        for name, node, _ in found:
            if name not in known:
                message = f"water pressure on {name}: there is no such interface"
                self.inputs.fault("E197", message, node, self.nearest(name, known))
        return {name: value for name, _, value in found}

    # -- loads ------------------------------------------------------------------------------------

    def common(
        self, blocks: Mapping[str, bool] | None, in_section: bool, toward: float | None, pressures: Sequence[float]
    ) -> dict[str, Any]:
        """What every design takes, as arguments; call it last.

        Parameters
        ----------
        blocks : whether each moves, by name; None where they are not cut yet
        toward : what a seismic load acts toward where the file does not say
        pressures : of the water, in the order of the interfaces
        """
        strengths = self.strengths()  # with their stiffness, which the reader takes
        reader = Reader(self.inputs.given, self.inputs.spelling, self.inputs.kind, (), {})
        found = reader.common()
        self.faults += reader.faults
        found["seismic"] = self.seismic(found["seismic"], in_section, toward)
        found["forces"] = self.on_blocks("forces", "force", words.force, blocks, in_section)
        found["bolts"] = self.on_blocks("bolts", "bolt", words.bolt, blocks, in_section)
        found["mechanisms"] = self.whole("analysis.mechanisms", "mechanisms", (1, _MOST_MECHANISMS), 1)
        found["strengths"] = strengths
        if any(pressures):
            found["water"] = Water("pressures", 0.0, tuple(pressures))
        return found

    def seismic(self, found: Seismic, in_section: bool, toward: float | None) -> Seismic:
        """The seismic load with its direction; E253 where that is missing or leaves the section."""
        trend = toward if found.trend_deg is None else found.trend_deg
        node = self.inputs.at("loads.seismic")
        if not found.coefficient or node is None:
            return found
        if trend is None:
            message = "the seismic load has no direction, and the blocks do not say which way the slope falls"
            self.inputs.fault("E253", message, node, "Write seismic: {k: 0.1, toward: 270}.")
        elif in_section and min(abs(trend - known) for known in _SECTION_TRENDS) > _TREND_TOLERANCE:
            message = f"the seismic load acts toward {number(trend)}, in a section it acts toward 090 or 270"
            self.inputs.fault("E253", message, node.get("toward") or node, "x is east (090), -x west (270).")
        return replace(found, trend_deg=trend)

    def on_blocks(
        self, key: str, what: str, read: Callable[[Any, str], Any], blocks: Mapping[str, bool] | None, in_section: bool
    ) -> tuple[Any, ...]:
        """Forces or bolts with the blocks they act on; E252 for one that leaves the section."""
        found: list[Force | Bolt] = []
        for value, node in self.loads[key]:
            bare = {part: own for part, own in value.items() if part != "block"} if isinstance(value, dict) else value
            where = str(node.place)
            load = self.kept(lambda bare=bare, where=where: read(bare, where))  # type: ignore[misc]
            block = self.block_of(node, what, blocks)
            if load is None:
                continue
            vector = load.components_kn if isinstance(load, Force) else tuple(load.toward.vector().tolist())
            if in_section and abs(vector[1]) > _OFF_SECTION * sum(part * part for part in vector) ** 0.5:
                message = f"a {what} leaves the section: x is east, z is up, and nothing acts along y"
                advice = "Point it toward 090 or 270 (any plunge), or give [x, 0, z]."
                self.inputs.fault("E252", message, node.get("toward") or node, advice)
            found.append(replace(load, block=block))
        return tuple(found)

    def block_of(self, node: Node, what: str, blocks: Mapping[str, bool] | None) -> str | None:
        """The block of a load: the one it names, or the only one that moves; E250, E251."""
        named = node.get("block")
        moving = [name for name, moves in (blocks or {}).items() if moves]
        if named is not None and named.text is not None:
            if blocks and not blocks.get(named.text, False):
                is_fixed = named.text in blocks
                message = f"a {what} acts on {named.text}, {'which is fixed' if is_fixed else 'there is no such block'}"
                self.inputs.fault("E250", message, named, self.nearest(named.text, moving))
            return named.text
        if len(moving) == 1:
            return moving[0]
        at = "head" if what == "bolt" else "at"
        if blocks is None and node.get(at) is None:
            message = f"a {what} does not say where it acts: the bench has many blocks"
            self.inputs.fault("E251", message, node, f"Add {at}: a point in its block (or block: its name).")
        elif blocks is not None and moving:
            advice = f"Add block: {moving[0]}." if node.is_mapping else f"Write {{force: …, block: {moving[0]}}}."
            self.inputs.fault("E251", f"a {what} names no block, and {len(moving)} can move", node, advice)
        return None


def without_density(fault: Fault) -> Fault:
    """An advice to give a density, for a place that takes none."""
    if "density" not in fault.advice:
        return fault
    return replace(fault, advice="A block takes its unit weight in kN/m³: 9.81 times the density in t/m³.")
