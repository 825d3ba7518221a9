"""Checked designs of columns and of benches from their files: all faults at once."""

from slopekit.design.blocky import BenchDesign, JointSetInput, ToppleDesign, column_names
from slopekit.design.inputs import Inputs
from slopekit.design.inputs_blocky import MOST_BLOCKS, AssemblyInputs
from slopekit.design.nodes import Node
from slopekit.design.words import point
from slopekit.errors import DesignError
from slopekit.orientation import Plane, number, parse_plane

_MOST_SCATTER_DEG = 45.0
_MOST_SEED = 2**63 - 1
_WESTWARD = 270.0  # columns rise toward +x and fall toward -x


def topple_design(inputs: Inputs) -> ToppleDesign:
    """Columns on a stepped base.

    Raises
    ------
    DesignError
        With every fault found: E139 a dip, E240 a size, E241 a step that cannot be, and those of every assembly.
    """
    reader = AssemblyInputs(inputs)
    columns = inputs.at("columns")
    node = columns if columns is not None and columns.is_mapping else inputs.root
    dip = reader.number(node.get("dip"), "angle", "dip of the columns")
    if dip is not None and not 0.0 < dip < 90.0:
        message = f"dip of the columns is {number(dip)}, it lies between 0 and 90"
        advice = "Columns dip into the slope; their base falls out of it, square to them."
        inputs.fault("E139", message, node.get("dip"), advice)
    width = reader.above_zero(node.get("width"), "length", "width", "E240")
    thickness = reader.above_zero(node.get("thickness"), "length", "thickness", "E240", 1.0)
    heights = _heights(reader, node.get("heights"))
    step = reader.number(node.get("base_step"), "length", "base_step", 0.0)
    shortest = min((height for height in heights if height > 0.0), default=None)
    if step is not None and (step < 0.0 or (shortest is not None and step >= shortest)):
        limits = "from 0" if shortest is None else f"from 0 to less than the lowest column ({number(shortest)} m)"
        inputs.fault("E241", f"base_step is {number(step)}, it lies {limits}", node.get("base_step"))
    rows = reader.whole("columns.rows", "rows", (1, max(MOST_BLOCKS // max(len(heights), 1), 1)), 1)
    strengths = ["", ""]
    if inputs.at("strength") is not None and columns is not None:
        users = [(name, node.get(name), columns) for name in ("base", "sides")]
        strengths = ["" if found is None else found.name for found in inputs.strengths_of(users)]
    pressures = {name: value for name, _, value in reader.pressures("{base: 5 kPa, sides: 3 kPa}")}
    water = (pressures.get("base", 0.0), pressures.get("sides", 0.0))
    names = dict.fromkeys(column_names(len(heights), rows or 1), True)
    common = reader.common(names, True, _WESTWARD, water)
    if inputs.faults or dip is None or width is None or thickness is None or step is None or rows is None:
        raise DesignError(inputs.faults)
    return ToppleDesign(
        dip_deg=dip, width_m=width, heights_m=heights, base_step_m=step, thickness_m=thickness, rows=rows,
        base=strengths[0], sides=strengths[1], pressures_kpa=water, **common,
    )  # fmt: skip


def _heights(reader: AssemblyInputs, node: Node | None) -> tuple[float, ...]:
    """The heights of the columns; one that is wrong is 0."""
    found = [
        reader.above_zero(item, "length", f"height of C{k}", "E240")
        for k, item in enumerate(node.elements if node is not None else (), 1)
    ]
    return tuple(0.0 if height is None else height for height in found)


def bench_design(inputs: Inputs) -> BenchDesign:
    """A bench cut by joint sets.

    Raises
    ------
    DesignError
        With every fault found: E134 to E138 for sets and cut, E116 for the slope, and those of every assembly.
    """
    reader = AssemblyInputs(inputs)
    defaults = []
    face, upper = _plane(reader, "slope.face", "face"), _plane(reader, "slope.upper", "upper")
    if upper is None and face is not None:
        upper = Plane(0.0, face.dip_direction_deg)
        defaults.append("upper")
    height = reader.above_zero(inputs.at("slope.height"), "length", "height", "E116")
    sizes: dict[str, float | None] = {}
    for key, factor in (("length", 2.0), ("depth", 1.0)):
        node = inputs.at(f"slope.{key}")
        if node is None or node.value is None:
            defaults.append(key)
        standard = None if height is None else factor * height
        sizes[key] = reader.above_zero(node, "length", key, "E116", standard)
    origin: tuple[float, float, float] | None = (0.0, 0.0, 0.0)
    if (at := inputs.at("slope.origin")) is not None and isinstance(at.value, list):
        origin = reader.kept(lambda: point(inputs.value(at), "origin", str(at.place)))
    pressures = reader.named_pressures(_names(inputs.at("sets")), "{S1: 5 kPa}")
    sets = _sets(reader, pressures)
    most = reader.whole("cut.max_blocks", "max_blocks", (1, MOST_BLOCKS), 20_000)
    seed = reader.whole("cut.seed", "seed", (0, _MOST_SEED), 0)
    node = inputs.at("cut.min_volume")
    smallest = reader.number(node, "volume", "min_volume", 0.0)
    if smallest is not None and smallest < 0.0:
        message = f"min_volume is {number(smallest)} m³, a volume is never negative"
        inputs.fault("E138", message, node, "0 keeps every block, however small.")
    toward = None if face is None else face.dip_direction_deg
    common = reader.common(None, False, 0.0 if toward is None else toward, [one.pressure_kpa for one in sets])
    common["defaults"] = (*defaults, *common["defaults"])
    length, depth = sizes["length"], sizes["depth"]
    if inputs.faults or face is None or upper is None or height is None or length is None or depth is None:
        raise DesignError(inputs.faults)
    if (
        most is None
        or seed is None
        or smallest is None
        or origin is None
        or len(sets) != len(_names(inputs.at("sets")))
    ):
        raise DesignError(inputs.faults)
    return BenchDesign(
        face=face, upper=upper, height_m=height, length_m=length, depth_m=depth, sets=sets, max_blocks=most,
        min_volume_m3=smallest, origin_m=origin, seed=seed, **common,
    )  # fmt: skip


def _names(node: Node | None) -> list[str]:
    return [name for name, _ in node.items()] if node is not None else []


def _plane(reader: AssemblyInputs, path: str, name: str) -> Plane | None:
    node = reader.inputs.at(path)
    return None if node is None else _orientation(reader, node, name)


def _orientation(reader: AssemblyInputs, node: Node, name: str) -> Plane | None:
    value = reader.inputs.value(node)
    return None if value is None else reader.kept(lambda: parse_plane(value, name, str(node.place)))


def _sets(reader: AssemblyInputs, pressures: dict[str, float]) -> tuple[JointSetInput, ...]:
    """The joint sets that can be read: E134 spacing, E135 scatter, E136 the same set twice."""
    inputs = reader.inputs
    node = inputs.at("sets")
    named = [(name, below) for name, below in node.items() if below.is_mapping] if node is not None else []
    strengths = ["" for _ in named]
    if inputs.at("strength") is not None and named:
        found = inputs.strengths_of([(name, below.get("strength"), below) for name, below in named])
        strengths = ["" if one is None else one.name for one in found]
    sets: list[JointSetInput] = []
    seen: dict[tuple[float, ...], str] = {}
    for (name, below), strength in zip(named, strengths, strict=True):
        given = below.get("plane")
        plane = None if given is None else _orientation(reader, given, name)
        spacing = reader.above_zero(below.get("spacing"), "length", f"spacing of {name}", "E134")
        offset = reader.number(below.get("offset"), "length", f"offset of {name}", 0.0)
        scatter = _within(reader, below.get("scatter"), "angle", f"scatter of {name}", _MOST_SCATTER_DEG, "°")
        uneven = _within(reader, below.get("spacing_scatter"), "ratio", f"spacing_scatter of {name}", 1.0, "")
        if plane is None or spacing is None or offset is None or scatter is None or uneven is None:
            continue
        key = (plane.dip_deg, plane.dip_direction_deg % 360.0, spacing, offset)
        if key in seen:
            message = f"{name} has the planes of {seen[key]}: the same orientation, spacing and offset"
            inputs.fault("E136", message, below, "Leave it out, or give it an offset.")
        seen.setdefault(key, name)
        sets.append(
            JointSetInput(name, plane, spacing, strength, offset, scatter, uneven, pressures.get(name, 0.0))
        )  # fmt: skip
    return tuple(sets)


def _within(reader: AssemblyInputs, node: Node | None, kind: str, name: str, most: float, unit: str) -> float | None:
    found = reader.number(node, kind, name, 0.0)
    if found is not None and not 0.0 <= found <= most:
        shown = f"{number(found)}{unit}, it lies between 0 and {number(most)}{unit}"
        advice = "" if unit or found < 0.0 else f"Write {number(found)} % for a percentage."
        reader.inputs.fault("E135", f"{name} is {shown}", node, advice)
    return found
