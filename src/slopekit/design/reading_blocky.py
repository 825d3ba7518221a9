"""Columns and benches from their documents: all faults at once."""

from slopekit.design.assemblies import common, named_pressures, pressures
from slopekit.design.blocky import MOST_BLOCKS, BenchDesign, JointSetInput, ToppleDesign, column_names
from slopekit.design.fields import fields_of
from slopekit.design.reader import Reader
from slopekit.design.sections import strength_names
from slopekit.orientation import Plane, number

_WESTWARD = 270.0  # columns rise toward +x and fall toward -x


def read_topple(reader: Reader) -> ToppleDesign:
    """Columns on a stepped base.

    Raises
    ------
    DesignError
        With every fault found: E139 a dip, E240 a size, E241 a step that cannot be, and those of every assembly.
    """
    node = reader.at("columns")
    own = reader.fields(ToppleDesign)
    heights, step, below = own["heights_m"] or (), own["base_step_m"], reader.at("columns.base_step")
    shortest = min(heights, default=None)
    if step is not None and shortest is not None and step >= shortest:
        limits = f"from 0 to less than the lowest column ({number(shortest)} m)"
        reader.fault("E241", f"base_step is {number(step)}, it lies {limits}", below)
    most = max(MOST_BLOCKS // max(len(heights), 1), 1)
    rows = own["rows"] or 1
    if rows > most:
        rows = 1
        message = f"rows is {own['rows']}, it must be a whole number from 1 to {most}"
        reader.fault("E137", message, reader.at("columns.rows"))
    strengths: list[str | None] = [None, None]
    if reader.at("strength") is not None and node is not None:
        strengths = strength_names(reader, [(name, node.get(name), node) for name in ("base", "sides")])
    by_name = {name: value for name, _, value in pressures(reader, "{base: 5 kPa, sides: 3 kPa}")}
    water = (by_name.get("base", 0.0), by_name.get("sides", 0.0))
    names = dict.fromkeys(column_names(len(heights), rows), True)
    shared = common(reader, names, True, _WESTWARD, water)
    return reader.made(
        ToppleDesign, own, shared, base=strengths[0], sides=strengths[1], pressures_kpa=water
    )  # fmt: skip


def read_bench(reader: Reader) -> BenchDesign:
    """A bench cut by joint sets.

    Raises
    ------
    DesignError
        With every fault found: E134 to E138 for sets and cut, E116 for the slope, and those of every assembly.
    """
    own = reader.fields(BenchDesign)
    face, height = own["face"], own["height_m"]
    if own["upper"] is None and reader.at("slope.upper") is None and face is not None:
        own["upper"] = reader.default("upper", Plane(0.0, face.dip_direction_deg))
    for key, factor in (("length", 2.0), ("depth", 1.0)):
        node = reader.at(f"slope.{key}")
        if node is None or node.value is None:
            own[f"{key}_m"] = reader.default(key, None if height is None else factor * height)
    sets = reader.at("sets")
    names = [name for name, _ in sets.items()] if sets is not None else []
    by_name = named_pressures(reader, names, "{S1: 5 kPa}")
    own["sets"] = _sets(reader, by_name)
    toward = 0.0 if face is None else face.dip_direction_deg
    shared = common(reader, None, False, toward, [one.pressure_kpa for one in own["sets"]])
    return reader.made(BenchDesign, shared, own)


def _sets(reader: Reader, by_name: dict[str, float]) -> tuple[JointSetInput, ...]:
    """The joint sets that can be read: E134 spacing, E135 scatter, E136 the same set twice."""
    named = reader.names("sets")
    strengths: list[str | None] = [None] * len(named)
    if reader.at("strength") is not None and named:
        strengths = strength_names(reader, [(name, below.get("strength"), below) for name, below in named])
    sets: list[JointSetInput] = []
    seen: dict[tuple[float, ...], str] = {}
    wanted = [name for name in fields_of(JointSetInput) if name != "strength"]
    for (name, below), strength in zip(named, strengths, strict=True):
        found = reader.fields(JointSetInput, below, name, only=wanted)
        if None in found.values():
            continue
        plane: Plane = found["plane"]
        key = (plane.dip_deg, plane.dip_direction_deg % 360.0, found["spacing_m"], found["offset_m"])
        if key in seen:
            message = f"{name} has the planes of {seen[key]}: the same orientation, spacing and offset"
            reader.fault("E136", message, below, "Leave it out, or give it an offset.")
        seen.setdefault(key, name)
        sets.append(JointSetInput(name=name, strength=strength or "", pressure_kpa=by_name.get(name, 0.0), **found))
    return tuple(sets)
