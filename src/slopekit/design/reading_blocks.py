"""Checked designs of the user's own blocks: polygons of a section or meshes, and what holds between them."""

from collections.abc import Mapping, Sequence
from functools import partial

from slopekit.design.blocky import BlockInput, BlocksDesign, Point2
from slopekit.design.inputs import BARE_NUMBER, Inputs
from slopekit.design.inputs_blocky import AssemblyInputs, without_density
from slopekit.design.named_files import mesh_file
from slopekit.design.nodes import Node
from slopekit.design.polygons import fault_of_polygon
from slopekit.design.reader import Reader
from slopekit.errors import DesignError, Fault
from slopekit.units import quantity

_LARGEST = 1e18
_KEYS = ("polygon", "mesh", "unit_weight", "fixed")
_TRUTH = {"true": True, "false": False}
_UNTRUTHS = ("no", "off", "n", "0")  # YAML 1.1, said to be a fault; what it means is clear


def blocks_design(inputs: Inputs) -> BlocksDesign:
    """The user's own blocks.

    Raises
    ------
    DesignError
        With every fault found: E242 to E246 for blocks, E247 to E249 for interfaces, E240 and E254 for sizes, and
        those of every assembly.
    """
    reader = AssemblyInputs(inputs)
    group = inputs.at("blocks")
    nodes = {name: node for name, node in group.items() if node.is_mapping} if group is not None else {}
    fixed = {name: _is_fixed(reader, node) for name, node in nodes.items()}
    _one_kind(reader, nodes)
    own = Reader({}, inputs.spelling, inputs.kind, (), {})
    blocks = [_block(reader, own, name, node, fixed[name]) for name, node in nodes.items()]
    _something_moves(reader, group, fixed)
    _weight(reader, nodes, fixed, blocks)
    default, interfaces = _interfaces(reader, nodes)
    pressures = _pressures(reader, nodes)
    in_section = any(node.get("polygon") is not None for node in nodes.values())
    section, node = inputs.at("section"), inputs.at("section.thickness")
    thickness = reader.above_zero(node, "length", "thickness", "E240", 1.0)
    if section is not None and nodes and all(node.get("mesh") is not None for node in nodes.values()):
        inputs.fault("E243", "section says nothing beside meshes", section, "Leave it out.")
    node = inputs.at("contact_tolerance")
    tolerance = reader.above_zero(node, "length", "contact_tolerance", "E254")
    moves = {name: not is_fixed for name, is_fixed in fixed.items()}
    common = reader.common(moves, in_section, None, [value for _, _, value in pressures])
    sound = [block for block in blocks if block is not None]
    if inputs.faults or thickness is None or default is None or len(sound) != len(nodes):
        raise DesignError(inputs.faults)
    return BlocksDesign(
        blocks=tuple(sound), thickness_m=thickness, default_strength=default, interfaces=interfaces,
        pressures_kpa=pressures, contact_tolerance_m=tolerance, **common,
    )  # fmt: skip


# -- blocks -----------------------------------------------------------------------------------------------------------


def _is_fixed(reader: AssemblyInputs, node: Node) -> bool:
    given = node.get("fixed")
    if given is None or given.text is None:
        return False
    if given.text.lower() not in _TRUTH:
        reader.inputs.fault("E244", f"{given.path} is {given.text}, it is true or false", given)
    return given.text.lower() not in (*_UNTRUTHS, "false")


def _one_kind(reader: AssemblyInputs, nodes: Mapping[str, Node]) -> None:
    """Each block is a polygon or a mesh, and all of them are the same; E243, E143."""
    kinds: dict[str, str] = {}
    for name, node in nodes.items():
        said = [key for key in ("polygon", "mesh") if node.get(key) is not None]
        if len(said) == 2:
            reader.inputs.fault("E243", f"{name} has polygon and mesh", node.get("mesh"), "Keep one of them.")
        elif not said and all(key in _KEYS for key, _ in node.items()):  # else a slip in that key is said already
            reader.inputs.fault("E143", f"{node.path}.polygon is missing", node, "Add polygon: or mesh:.")
        elif said:
            kinds[name] = said[0]
    first = next(iter(kinds), "")
    other = [name for name, kind in kinds.items() if kind != kinds[first]]
    if other:
        more = f" (and {len(other) - 1} more)" if len(other) > 1 else ""
        message = f"{other[0]}{more} has a {kinds[other[0]]}, {first} has a {kinds[first]}"
        advice = "Blocks are all polygons of one section, or all meshes."
        reader.inputs.fault("E243", message, nodes[other[0]], advice)


def _block(reader: AssemblyInputs, own: Reader, name: str, node: Node, is_fixed: bool) -> BlockInput | None:
    """One block; None where a fault stands for it."""
    unit_weight, points, mesh = None, None, None
    given = node.get("unit_weight")
    if given is not None and given.value is not None:
        value = reader.inputs.value(given)
        try:
            unit_weight = None if value is None else own.unit_weight(value, str(given.place))
        except DesignError as error:
            reader.faults += [without_density(fault) for fault in error.faults]
    polygon, file = node.get("polygon"), node.get("mesh")
    if polygon is not None and len(polygon.elements) >= 3 and reader.inputs.is_sound(polygon):
        points = _polygon(reader, name, polygon)
    if file is not None and file.text is not None:
        mesh = mesh_file(reader.inputs, file)
    if points is None and mesh is None:
        return None
    return BlockInput(name, points, mesh, unit_weight, is_fixed)


def _polygon(reader: AssemblyInputs, name: str, node: Node) -> tuple[Point2, ...] | None:
    """The points (x, z) of a polygon, the first not repeated; E242."""
    points: list[Point2] = []
    for k, item in enumerate(node.elements, 1):
        parts = [_coordinate(reader, part, k, name) for part in item.elements]
        if len(parts) == 2 and parts[0] is not None and parts[1] is not None:
            points.append((parts[0], parts[1]))
    if len(points) < len(node.elements):
        return None
    if points[0] == points[-1]:
        del points[-1]  # a ring that is closed, as GIS writes it
    wrong = fault_of_polygon(points)
    if wrong is not None:
        advice = "Give the corners once each, in order around the block."
        reader.inputs.fault("E242", f"the polygon of {name} bounds no block: {wrong}", node, advice)
        return None
    return tuple(points)


def _coordinate(reader: AssemblyInputs, node: Node, k: int, name: str) -> float | None:
    text = node.text
    if text is None:
        return None
    if BARE_NUMBER.match(text) and abs(value := float(text)) <= _LARGEST:  # most of ten thousand blocks is this
        return value
    return reader.kept(partial(quantity, text, "length", f"point {k} of {name}", str(node.place)))


def _something_moves(reader: AssemblyInputs, group: Node | None, fixed: Mapping[str, bool]) -> None:
    if not fixed:
        return
    if all(fixed.values()):
        advice = "Leave fixed out of those that may move."
        reader.inputs.fault("E246", "every block is fixed: nothing can move", group, advice)
    elif not any(fixed.values()):
        advice = "Add fixed: true to the block that is bedrock: base: {polygon: [...], fixed: true}."
        reader.inputs.fault("E245", "no block is fixed: nothing holds the others", group, advice)


def _weight(
    reader: AssemblyInputs, nodes: Mapping[str, Node], fixed: Mapping[str, bool], blocks: Sequence[BlockInput | None]
) -> None:
    """Without `rock` every block that moves has a unit weight of its own; the first of them stands for the rock's."""
    given = reader.inputs.given
    rock = reader.inputs.at("rock")
    if "unit_weight" in given or "density" in given or (rock is not None and not rock.is_mapping):
        return
    lacking = [name for name, node in nodes.items() if not fixed[name] and node.get("unit_weight") is None]
    if lacking:
        more = f" (and {len(lacking) - 1} more)" if len(lacking) > 1 else ""
        message = f"{lacking[0]}{more} has no unit weight, and rock gives none"
        reader.inputs.fault("E143", message, nodes[lacking[0]], "Add rock: {unit_weight: 25 kN/m3}.")
    weights = (block.unit_weight_kn_m3 for block in blocks if block is not None and not block.fixed)
    given["unit_weight"] = next((weight for weight in weights if weight is not None), 25.0)


# -- what holds between them ------------------------------------------------------------------------------------------


def _interfaces(
    reader: AssemblyInputs, nodes: Mapping[str, Node]
) -> tuple[str | None, tuple[tuple[str, str, str], ...]]:
    """The strength of every interface: the default, and those of the pairs that are named; E247 to E249, E176."""
    inputs = reader.inputs
    group, strengths = inputs.at("interfaces"), inputs.at("strength")
    named = {key: node for key, node in group.items() if node.text is not None} if group is not None else {}
    default = named.pop("default", None)
    pairs = _pairs(reader, list(named.items()), nodes)
    if strengths is None:
        return None, ()
    users: list[tuple[str, Node | None, Node]] = [("/".join(pair), node, node) for pair, node in pairs.items()]
    has_default = default is not None or len(strengths.items()) < 2
    if has_default:
        users.append(("interfaces.default", default, group or strengths))
    else:
        names = [name for name, _ in strengths.items()]
        message = f"interfaces.default is missing, and there are {len(names)} strengths"
        inputs.fault("E249", message, group or strengths, f"Add default: {' or '.join(names[:4])}.")
    before = len(inputs.faults)
    found = [None if one is None else one.name for one in inputs.strengths_of(users)]
    if not has_default or len(pairs) < len(named):  # a strength that none of the others has may be meant there
        inputs.faults[before:] = [fault for fault in inputs.faults[before:] if fault.code != "E195"]
    interfaces = tuple((*pair, one) for pair, one in zip(pairs, found, strict=False) if one is not None)
    return (found[-1] if has_default else None), interfaces


def _pairs(
    reader: AssemblyInputs, keys: Sequence[tuple[str, Node]], nodes: Mapping[str, Node]
) -> dict[tuple[str, str], Node]:
    """Keys such as B1/B2 as pairs of blocks: E247 what is none, E248 the same twice."""
    found: dict[tuple[str, str], Node] = {}
    seen: dict[frozenset[str], str] = {}

    def wrong(node: Node, message: str, advice: str) -> None:
        reader.faults.append(Fault("E247", message, str(node.key_place), advice))

    for key, node in keys:
        names = tuple(part.strip() for part in key.split("/"))
        unknown = [name for name in dict.fromkeys(names) if name not in nodes]
        if len(names) != 2 or not all(names):
            wrong(node, f"{key} is not a pair of blocks", "Write the two names with a slash: B1/B2.")
        elif unknown:
            for name in unknown:
                wrong(node, f"{key}: there is no block {name}", reader.nearest(name, nodes))
        elif names[0] == names[1]:
            wrong(node, f"{key}: a block has no interface with itself", "Name two blocks.")
        elif frozenset(names) in seen:
            message = f"{key} is the same interface as {seen[frozenset(names)]}"
            reader.faults.append(Fault("E248", message, str(node.key_place), "Leave one of them out."))
        else:
            found[names[0], names[1]] = node
        seen.setdefault(frozenset(names), key)
    return found


def _pressures(reader: AssemblyInputs, nodes: Mapping[str, Node]) -> tuple[tuple[str, str, float], ...]:
    given = reader.pressures("{B1/B2: 5 kPa}")
    values = {id(node): value for _, node, value in given}
    pairs = _pairs(reader, [(name, node) for name, node, _ in given], nodes)
    return tuple((*pair, values[id(node)]) for pair, node in pairs.items())
