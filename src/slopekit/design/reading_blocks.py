"""Checked designs of the user's own blocks: polygons of a section or meshes, and what holds between them."""

from collections.abc import Mapping, Sequence

from slopekit.design.assemblies import common, pressures
from slopekit.design.blocky import BlockInput, BlocksDesign, Point2
from slopekit.design.fields import Field, fields_of
from slopekit.design.named_files import mesh_file
from slopekit.design.nodes import Node
from slopekit.design.polygons import fault_of_polygon
from slopekit.design.reader import Reader
from slopekit.design.sections import strength_names
from slopekit.errors import Fault

_COORDINATE = Field("polygon", "length")
_KEYS = ("polygon", "mesh", "unit_weight", "fixed")
_TRUTH = {"true": True, "false": False}
_UNTRUTHS = ("no", "off", "n", "0")  # YAML 1.1, said to be a fault; what it means is clear


def read_blocks(reader: Reader) -> BlocksDesign:
    """The user's own blocks.

    Raises
    ------
    DesignError
        With every fault found: E242 to E246 for blocks, E247 to E249 for interfaces, E240 and E254 for sizes, and
        those of every assembly.
    """
    group = reader.at("blocks")
    nodes = dict(reader.names("blocks"))
    fixed = {name: _is_fixed(reader, node) for name, node in nodes.items()}
    _one_kind(reader, nodes)
    blocks = [_block(reader, name, node, fixed[name]) for name, node in nodes.items()]
    _something_moves(reader, group, fixed)
    default, interfaces = _interfaces(reader, nodes)
    water = _pressures(reader, nodes)
    in_section = any(node.get("polygon") is not None for node in nodes.values())
    section = reader.at("section")
    if section is not None and nodes and all(node.get("mesh") is not None for node in nodes.values()):
        reader.fault("E243", "section says nothing beside meshes", section, "Leave it out.")
    own = reader.fields(BlocksDesign, only=("thickness_m", "contact_tolerance_m", "mechanisms"))
    moves = {name: not is_fixed for name, is_fixed in fixed.items()}
    shared = common(reader, moves, in_section, None, [value for _, _, value in water])
    sound = tuple(block for block in blocks if block is not None)
    if shared["unit_weight_kn_m3"] is None:
        shared["unit_weight_kn_m3"] = _weight(reader, nodes, fixed, blocks)
    return reader.made(
        BlocksDesign, own, shared, blocks=sound, default_strength=default, interfaces=interfaces, pressures_kpa=water
    )


# -- blocks -----------------------------------------------------------------------------------------------------------


def _is_fixed(reader: Reader, node: Node) -> bool:
    given = node.get("fixed")
    if given is None or given.text is None:
        return False
    if given.text.lower() not in _TRUTH:
        reader.fault("E244", f"{given.path} is {given.text}, it is true or false", given)
    return given.text.lower() not in (*_UNTRUTHS, "false")


def _one_kind(reader: Reader, nodes: Mapping[str, Node]) -> None:
    """Each block is a polygon or a mesh, and all of them are the same; E243, E143."""
    kinds: dict[str, str] = {}
    for name, node in nodes.items():
        said = [key for key in ("polygon", "mesh") if node.get(key) is not None]
        if len(said) == 2:
            reader.fault("E243", f"{name} has polygon and mesh", node.get("mesh"), "Keep one of them.")
        elif not said and all(key in _KEYS for key, _ in node.items()):  # else a slip in that key is said already
            reader.fault("E143", f"{node.path}.polygon is missing", node, "Add polygon: or mesh:.")
        elif said:
            kinds[name] = said[0]
    first = next(iter(kinds), "")
    other = [name for name, kind in kinds.items() if kind != kinds[first]]
    if other:
        more = f" (and {len(other) - 1} more)" if len(other) > 1 else ""
        message = f"{other[0]}{more} has a {kinds[other[0]]}, {first} has a {kinds[first]}"
        advice = "Blocks are all polygons of one section, or all meshes."
        reader.fault("E243", message, nodes[other[0]], advice)


def _block(reader: Reader, name: str, node: Node, is_fixed: bool) -> BlockInput | None:
    """One block; None where a fault stands for it."""
    weight = reader.field(fields_of(BlockInput)["unit_weight_kn_m3"], node.get("unit_weight"))
    points, mesh = None, None
    polygon, file = node.get("polygon"), node.get("mesh")
    if polygon is not None and len(polygon.elements) >= 3 and reader.is_sound(polygon):
        points = _polygon(reader, name, polygon)
    if file is not None and file.text is not None:
        mesh = mesh_file(reader, file)
    return None if points is None and mesh is None else BlockInput(name, points, mesh, weight, is_fixed)


def _polygon(reader: Reader, name: str, node: Node) -> tuple[Point2, ...] | None:
    """The points (x, z) of a polygon, the first not repeated; E242."""
    points: list[Point2] = []
    for k, item in enumerate(node.elements, 1):
        own = f"point {k} of {name}"
        parts = [None if part.text is None else reader.number(_COORDINATE, part, own) for part in item.elements]
        if len(parts) == 2 and parts[0] is not None and parts[1] is not None:
            points.append((parts[0], parts[1]))
    if len(points) < len(node.elements):
        return None
    if points[0] == points[-1]:
        del points[-1]  # a ring that is closed, as GIS writes it
    wrong = fault_of_polygon(points)
    if wrong is not None:
        advice = "Give the corners once each, in order around the block."
        reader.fault("E242", f"the polygon of {name} bounds no block: {wrong}", node, advice)
        return None
    return tuple(points)


def _something_moves(reader: Reader, group: Node | None, fixed: Mapping[str, bool]) -> None:
    if not fixed:
        return
    if all(fixed.values()):
        advice = "Leave fixed out of those that may move."
        reader.fault("E246", "every block is fixed: nothing can move", group, advice)
    elif not any(fixed.values()):
        advice = "Add fixed: true to the block that is bedrock: base: {polygon: [...], fixed: true}."
        reader.fault("E245", "no block is fixed: nothing holds the others", group, advice)


def _weight(
    reader: Reader, nodes: Mapping[str, Node], fixed: Mapping[str, bool], blocks: Sequence[BlockInput | None]
) -> float | None:
    """Without `rock` every block that moves has a unit weight of its own; the first of them stands for the rock's."""
    rock = reader.at("rock")
    if rock is not None and (not rock.is_mapping or {"unit_weight", "density"} & {key for key, _ in rock.items()}):
        return None
    lacking = [name for name, node in nodes.items() if not fixed[name] and node.get("unit_weight") is None]
    if lacking:
        more = f" (and {len(lacking) - 1} more)" if len(lacking) > 1 else ""
        message = f"{lacking[0]}{more} has no unit weight, and rock gives none"
        reader.fault("E143", message, nodes[lacking[0]], "Add rock: {unit_weight: 25 kN/m3}.")
    weights = (block.unit_weight_kn_m3 for block in blocks if block is not None and not block.fixed)
    return next((weight for weight in weights if weight is not None), 25.0)


# -- what holds between them ------------------------------------------------------------------------------------------


def _interfaces(reader: Reader, nodes: Mapping[str, Node]) -> tuple[str | None, tuple[tuple[str, str, str], ...]]:
    """The strength of every interface: the default, and those of the pairs that are named; E247 to E249, E176."""
    group, strengths = reader.at("interfaces"), reader.at("strength")
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
        reader.fault("E249", message, group or strengths, f"Add default: {' or '.join(names[:4])}.")
    before = len(reader.faults)
    found = strength_names(reader, users)
    if not has_default or len(pairs) < len(named):  # a strength that none of the others has may be meant there
        reader.faults[before:] = [fault for fault in reader.faults[before:] if fault.code != "E195"]
    interfaces = tuple((*pair, one) for pair, one in zip(pairs, found, strict=False) if one is not None)
    return (found[-1] if has_default else None), interfaces


def _pairs(reader: Reader, keys: Sequence[tuple[str, Node]], nodes: Mapping[str, Node]) -> dict[tuple[str, str], Node]:
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


def _pressures(reader: Reader, nodes: Mapping[str, Node]) -> tuple[tuple[str, str, float], ...]:
    given = pressures(reader, "{B1/B2: 5 kPa}")
    values = {id(node): value for _, node, value in given}
    pairs = _pairs(reader, [(name, node) for name, node, _ in given], nodes)
    return tuple((*pair, values[id(node)]) for pair, node in pairs.items())
