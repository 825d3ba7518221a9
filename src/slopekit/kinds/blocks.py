"""Blocks of any shape that the user gives: polygons of a section, or closed meshes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import Fault, Faults, GeometryError, Notice
from slopekit.core.sheet import Section, counted
from slopekit.design.fields import Field, declare, fields_of, group, number, text
from slopekit.design.parts import Action, MeshFile, Water, axis_key
from slopekit.design.reading.named_files import mesh_file
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import VALUE, Spec
from slopekit.design.sections import strength_names
from slopekit.geometry.fit import BlocksCut, ContactTolerance, Misfits
from slopekit.geometry.patches import Patches
from slopekit.geometry.sections.polygons import fault_of_polygon
from slopekit.kinds.assemblies.many_blocks import (
    ManyBlocks,
    contact_areas,
    no_closed_form,
    water_of_blocks,
)
from slopekit.kinds.assemblies.many_blocks_design import (
    NamedDesign,
    Point2,
    common_attributes,
    named_pressures,
    read_pressures,
    read_surcharges,
    water_by,
)
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene, with_ground, with_loads
from slopekit.kinds.words import (
    BLOCKS_STATUSES,
    first_and_last,
    names_in_runs,
    shortened,
    slope_sections,
    strength_in_words,
)
from slopekit.result import Result, Words

_OVERLAP = 1e-3  # of the smaller block: a larger overlap is refused
_COARSEST_ROUNDING_M = (
    0.1  # m: corners of a file with one decimal or none are exact as a rule, not rounded
)
_MOST_NAMED_BLOCKS = 5  # blocks that a notice names
_MOST_INTERFACES = 3


_KEYS = ("polygon", "mesh", "up", "unit_weight", "fixed")


@dataclass(frozen=True)
class BlockInput:
    """A block of the user: a polygon (x, z) in m with the thickness of the section, or a closed mesh.

    `unit_weight_kn_m3` is None where the block has the rock's; `fixed` blocks are bedrock.
    """

    ACTIONS: ClassVar[Mapping[str, Action]] = {"unit_weight_kn_m3": "weight"}
    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (axis_key("up"),)

    name: str
    polygon_m: tuple[Point2, ...] | None = text(
        "polygon",
        default=None,
        coordinates=2,
        left_out="one of the two",
        doc="corners [x, z] once around, either way; at least three",
        example="[[0, 0], [2, 0], [2, 1]]",
        forms=(Spec(items=Spec(items=VALUE, at_least=2, at_most=2, example="[0, 5]"), at_least=3),),
    )
    mesh: MeshFile | None = text(
        "mesh",
        default=None,
        example="block.stl",
        left_out="one of the two",
        doc="a closed mesh file (STL, OBJ, PLY, OFF, GLB, DXF)",
    )
    unit_weight_kn_m3: float | None = number(
        "unit_weight",
        "unit weight",
        default=None,
        least=5.0,
        most=400.0,
        code="E110",
        label="unit weight",
        says="out of range ({least} to {most})",
        left_out="the rock's",
        advice="A block takes its unit weight in kN/m³: 9.81 times the density in t/m³.",
    )
    fixed: bool = text(
        "fixed",
        default=False,
        words=("true", "false"),
        code="E126",
        doc="`true` for bedrock; at least one is, at least one is not",
    )


@dataclass(frozen=True, kw_only=True)
class BlocksDesign(NamedDesign):
    """The user's own blocks: all polygons of one section, or all meshes.

    Attributes
    ----------
    default_strength : of every interface that is not named
    interfaces : (block, block, strength) of those that are
    pressures_kpa : (block, block, mean water pressure) where there is water
    contact_tolerance_m : faces nearer than this touch; None: 1e-5 of the mean size of the blocks, or what their corners
        are rounded to
    """

    REQUIRED: ClassVar[tuple[str, ...]] = ("strength",)
    ACTIONS: ClassVar[Mapping[str, Action]] = {"pressures_kpa": "water"}

    blocks: tuple[BlockInput, ...] = group(
        "blocks",
        BlockInput,
        many="names",
        at_least=1,
        example="{B1: {polygon: [[0, 0], [2, 0], [2, 1]]}}",
    )
    thickness_m: float = number(
        "section.thickness",
        "length",
        default=1.0,
        above=0.0,
        code="E240",
        value_attribute="section_thickness_m",
        doc="not beside meshes",
    )
    default_strength: str
    interfaces: tuple[tuple[str, str, str], ...] = text(
        "interfaces",
        default=(),
        left_out="the only strength",
        doc="a strength by `default`, and of pairs `A/B`",
        forms=(Spec(names=Spec("value", example="joint"), pairs=True),),
    )
    water: Water = water_by(
        declare(
            "pressures",
            "pressure",
            0.0,
            many="pairs",
            axis="water pressure",
            example="{B1/B2: 5 kPa}",
        ),
        excluded_keys=("depth",),
    )
    pressures_kpa: tuple[tuple[str, str, float], ...] = ()
    contact_tolerance_m: float | None = number(
        "contact_tolerance",
        "length",
        default=None,
        left_out="1e-5 of the mean block, or as the corners are rounded",
        doc="faces nearer than this touch",
        above=0.0,
        code="E116",
        scatters=False,
        role="setting",
    )

    @property
    def section_thickness_m(self) -> float | None:
        """The thickness of the section, m; None for meshes."""
        return self.thickness_m if self.in_section else None

    @property
    def in_section(self) -> bool:
        """Whether the blocks are polygons of a vertical section."""
        return all(block.mesh is None for block in self.blocks)


def read_blocks(reader: Reader) -> BlocksDesign:
    """Read the design of blocks of any shape.

    Raises
    ------
    DesignError
        With every fault found: E112, E126, E242 and E245 for blocks, E151, E176 and E247 for interfaces, E116 and
        E240 for sizes, and those of every assembly.
    """
    group = reader.find("blocks")
    nodes = dict(reader.names("blocks"))
    is_bedrock = fields_of(BlockInput)["fixed"]
    fixed = {
        name: reader.field(is_bedrock, node.get("fixed")) not in (False, "false")
        for name, node in nodes.items()
    }
    _check_same_shape(reader, nodes)
    blocks = [_block(reader, name, node, fixed[name]) for name, node in nodes.items()]
    _check_some_block_moves(reader, group, fixed)
    default, interfaces = _interfaces(reader, nodes)
    water = read_pressures(reader, [name for name, _ in named_pressures(reader)])
    in_section = any(node.get("polygon") for node in nodes.values())
    section = reader.find("section")
    if section and nodes and all(node.get("mesh") for node in nodes.values()):
        reader.fault("E112", "section says nothing beside meshes", section, "Leave it out.")
    block_values = reader.fields(
        BlocksDesign, only=("thickness_m", "contact_tolerance_m", "mechanisms", "smallest_block")
    )
    moves = {name: not is_fixed for name, is_fixed in fixed.items()}
    shared = common_attributes(reader, moves, in_section, None, water)
    sound = tuple(block for block in blocks if block is not None)
    if shared["unit_weight_kn_m3"] is None:
        shared["unit_weight_kn_m3"] = _weight(reader, nodes, fixed, blocks)
    return reader.build(
        BlocksDesign,
        block_values,
        shared,
        blocks=sound,
        surcharges_kpa=tuple(read_surcharges(reader, moves)),
        default_strength=default,
        interfaces=interfaces,
        pressures_kpa=_pressures_between(reader, water, nodes),
    )


# -- blocks -----------------------------------------------------------------------------------------------------------


def _check_same_shape(reader: Reader, nodes: Mapping[str, Node]) -> None:
    """Check that every block is a polygon or a mesh, and that all blocks are of the same sort; E112, E143."""
    kinds: dict[str, str] = {}
    for name, node in nodes.items():
        shapes = [key for key in ("polygon", "mesh") if node.get(key)]
        if len(shapes) == 2:
            reader.fault(
                "E112", f"{name} has polygon and mesh", node.get("mesh"), "Keep one of them."
            )
        elif not shapes and all(
            key in _KEYS for key, _ in node.items()
        ):  # else a slip in that key is said already
            reader.fault("E143", f"{node.path}.polygon is missing", node, "Add polygon: or mesh:.")
        elif shapes:
            kinds[name] = shapes[0]
    first = next(iter(kinds), "")
    others_kind = [name for name, kind in kinds.items() if kind != kinds[first]]
    if others_kind:
        more = f" (and {len(others_kind) - 1} more)" if len(others_kind) > 1 else ""
        message = (
            f"{others_kind[0]}{more} has a {kinds[others_kind[0]]}, {first} has a {kinds[first]}"
        )
        reader.fault(
            "E112",
            message,
            nodes[others_kind[0]],
            "Blocks are all polygons of one section, or all meshes.",
        )


def _block(reader: Reader, name: str, node: Node, is_fixed: bool) -> BlockInput | None:
    """Read one block; None where it has faults."""
    weight = reader.field(fields_of(BlockInput)["unit_weight_kn_m3"], node.get("unit_weight"))
    points, polygon = None, node.get("polygon")
    if len(polygon.elements) >= 3 and reader.is_sound(polygon):
        points = _polygon(reader, name, polygon)
    mesh = mesh_file(reader, node)
    return (
        None
        if points is None and mesh is None
        else BlockInput(name, points, mesh, weight, is_fixed)
    )


def _polygon(reader: Reader, name: str, node: Node) -> tuple[Point2, ...] | None:
    """Read the points (x, z) of a polygon, the first not repeated; E242."""
    points = reader.points(node, name)
    if not points:
        return None
    if points[0] == points[-1]:
        del points[-1]  # a ring that is closed, as GIS writes it
    wrong = fault_of_polygon(points)
    if wrong is not None:
        advice = "Give the corners once each, in order around the block."
        reader.fault("E242", f"the polygon of {name} bounds no block: {wrong}", node, advice)
        return None
    return tuple(points)


def _check_some_block_moves(reader: Reader, group: Node, fixed: Mapping[str, bool]) -> None:
    if not fixed:
        return
    if all(fixed.values()):
        advice = "Leave fixed out of those that may move."
        reader.fault("E245", "every block is fixed: nothing can move", group, advice)
    elif not any(fixed.values()):
        advice = (
            "Add fixed: true to the block that is bedrock: base: {polygon: [...], fixed: true}."
        )
        reader.fault("E245", "no block is fixed: nothing holds the others", group, advice)


def _weight(
    reader: Reader,
    nodes: Mapping[str, Node],
    fixed: Mapping[str, bool],
    blocks: Sequence[BlockInput | None],
) -> float | None:
    """Return the unit weight (kN/m³) of the rock, without `rock` that of the first moving block; E143 without one."""
    rock = reader.find("rock")
    if rock and (not rock.is_mapping or rock.get("unit_weight") or rock.get("density")):
        return None
    lacking = [
        name for name, node in nodes.items() if not fixed[name] and not node.get("unit_weight")
    ]
    if lacking:
        more = f" (and {len(lacking) - 1} more)" if len(lacking) > 1 else ""
        message = f"{lacking[0]}{more} has no unit weight, and rock gives none"
        reader.fault("E143", message, nodes[lacking[0]], "Add rock: {unit_weight: 25 kN/m3}.")
    weights = (block.unit_weight_kn_m3 for block in blocks if block is not None and not block.fixed)
    return next((weight for weight in weights if weight is not None), 25.0)


# -- interfaces -------------------------------------------------------------------------------------------------------


def _interfaces(
    reader: Reader, nodes: Mapping[str, Node]
) -> tuple[str | None, tuple[tuple[str, str, str], ...]]:
    """Read the strengths of the interfaces: the default, and those of named pairs; E151, E176, E247."""
    group, strengths = reader.find("interfaces"), reader.find("strength")
    nodes_of_pairs = {key: node for key, node in group.items() if node.text is not None}
    default = nodes_of_pairs.pop("default", NOTHING)
    pairs = _pairs(reader, list(nodes_of_pairs.items()), nodes)
    if not strengths:
        return None, ()
    users: list[tuple[str, Node, Node]] = [
        ("/".join(pair), node, node) for pair, node in pairs.items()
    ]
    has_default = bool(default) or len(strengths.items()) < 2
    if has_default:
        users.append(("interfaces.default", default, group or strengths))
    else:
        names = [name for name, _ in strengths.items()]
        message = f"interfaces.default is missing, and there are {len(names)} strengths"
        reader.fault("E176", message, group or strengths, f"Add default: {' or '.join(names[:4])}.")
    faults_before = len(reader.faults)
    assigned = strength_names(reader, users)
    if not has_default or len(pairs) < len(
        nodes_of_pairs
    ):  # a strength that none of the others has may be meant there
        reader.faults[faults_before:] = [
            fault for fault in reader.faults[faults_before:] if fault.code != "E195"
        ]
    interfaces = tuple(
        (*pair, strength)
        for pair, strength in zip(pairs, assigned, strict=False)
        if strength is not None
    )
    return (assigned[-1] if has_default else None), interfaces


def _pairs(
    reader: Reader, keys: Sequence[tuple[str, Node]], nodes: Mapping[str, Node]
) -> dict[tuple[str, str], Node]:
    """Return keys such as B1/B2 as pairs of blocks; E247 for other keys, E151 for the same pair twice."""
    pairs: dict[tuple[str, str], Node] = {}
    keys_by_pair: dict[frozenset[str], str] = {}

    def wrong(node: Node, message: str, advice: str) -> None:
        reader.faults.append(Fault("E247", message, str(node.key_place), advice))

    for key, node in keys:
        names = tuple(name.strip() for name in key.split("/"))
        unknown = [name for name in dict.fromkeys(names) if name not in nodes]
        if len(names) != 2 or not all(names):
            wrong(
                node, f"{key} is not a pair of blocks", "Write the two names with a slash: B1/B2."
            )
        elif unknown:
            for name in unknown:
                wrong(node, f"{key}: there is no block {name}", reader.nearest(name, nodes))
        elif names[0] == names[1]:
            wrong(node, f"{key}: a block has no interface with itself", "Name two blocks.")
        elif frozenset(names) in keys_by_pair:
            message = f"{key} is the same interface as {keys_by_pair[frozenset(names)]}"
            reader.faults.append(
                Fault("E151", message, str(node.key_place), "Leave one of them out.")
            )
        else:
            pairs[names[0], names[1]] = node
        keys_by_pair.setdefault(frozenset(names), key)
    return pairs


def _pressures_between(
    reader: Reader, water: Water, nodes: Mapping[str, Node]
) -> tuple[tuple[str, str, float], ...]:
    pairs = _pairs(reader, named_pressures(reader), nodes)
    return tuple((*pair, value) for pair, value in zip(pairs, water.pressures_kpa, strict=False))


def cut(design: BlocksDesign) -> AssemblyScene:
    """Return the blocks with their loads. Raises GeometryError and DesignError as `with_loads`."""
    names = tuple(block.name for block in design.blocks)
    fixed = np.array([block.fixed for block in design.blocks])
    scene = (_section if design.in_section else _solids)(design, names, fixed)
    kinds = tuple(name for name, _ in design.strengths)
    patches = scene.assembly.patches
    joint = np.full(len(patches), kinds.index(design.default_strength))
    pressures = np.zeros(len(patches))
    index = {name: k for k, name in enumerate(names)}
    low, high = np.minimum(patches.plus, patches.minus), np.maximum(patches.plus, patches.minus)
    key = low * len(names) + high
    notices = list(scene.notices)
    unmet = []
    for named_pairs, values, take in (
        (design.interfaces, joint, lambda name: kinds.index(str(name))),
        (design.pressures_kpa, pressures, float),
    ):
        for first, second, value in named_pairs:
            a, b = sorted((index[first], index[second]))
            is_pair = key == a * len(names) + b
            values[is_pair] = take(value)
            if not is_pair.any():
                unmet.append(f"{first}/{second}")
    if unmet:
        notices.append(
            Notice(
                "W334",
                f"interfaces are named between blocks that do not touch: {_shortened_list(unmet)}",
            )
        )
    scene = replace(
        scene,
        assembly=replace(scene.assembly, patches=replace(patches, joint=joint)),
        joints=kinds,
        strengths=tuple(strength for _, strength in design.strengths),
        pressures=frozen(pressures),
        unit_weights=np.array(
            [
                design.rock.unit_weight_kn_m3
                if block.unit_weight_kn_m3 is None
                else block.unit_weight_kn_m3
                for block in design.blocks
            ]
        ),
        notices=tuple(notices),
    )
    return with_loads(design, with_ground(design, scene), 270.0)


def _section(design: BlocksDesign, names: tuple[str, ...], fixed: Bools) -> AssemblyScene:
    from slopekit.geometry.sections.section_blocks import section_assembly

    polygons = [np.array(block.polygon_m) for block in design.blocks]
    cut = section_assembly(polygons, fixed, design.thickness_m, design.contact_tolerance_m, names)
    _refuse_overlaps(
        names,
        cut.overlaps.pairs,
        cut.overlaps.amounts,
        cut.assembly.volumes / design.thickness_m,
        "m²",
    )
    _refuse_floating(names, fixed, cut.assembly.patches, cut.gaps)
    notices = list(_fit_notices(names, cut, "m", "m²"))
    if cut.point_contacts:
        text = f"{cut.point_contacts} pairs of blocks touch at a corner only, which carries nothing"
        notices.append(Notice("W334", text))
    return AssemblyScene(
        cut.assembly,
        names,
        (),
        (),
        np.zeros(0),
        np.zeros(0),
        dict(zip(names, cut.outlines, strict=True)),
        {**_tolerance(cut.tolerance), "contact_length_m": cut.contact},
        (),
        tuple(notices),
        thickness=design.thickness_m,
    )


def _solids(design: BlocksDesign, names: tuple[str, ...], fixed: Bools) -> AssemblyScene:
    from slopekit.geometry.solids.mesh_rounding import file_rounding
    from slopekit.geometry.solids.meshes import read_mesh
    from slopekit.geometry.solids.solids import mesh_assembly

    meshes: list[tuple[Floats, Ints]] = []
    units = []
    faults = Faults()
    for block in design.blocks:
        assert block.mesh is not None
        with faults.collecting():
            vertices, triangles, _ = read_mesh(
                Path(block.mesh.path), block.mesh.name, block.mesh.where, block.mesh.up
            )
            meshes.append((vertices, triangles))
            units.append(file_rounding(Path(block.mesh.path), vertices, block.mesh.length_unit)[0])
    faults.refuse()
    # a file of whole numbers or halves is exact, beside others that are rounded
    unit = max((unit for unit in units if unit < _COARSEST_ROUNDING_M), default=min(units))
    cut = mesh_assembly(meshes, fixed, design.contact_tolerance_m, names, unit)
    _refuse_overlaps(names, cut.overlaps.pairs, cut.overlaps.amounts, cut.assembly.volumes, "m³")
    _refuse_floating(names, fixed, cut.assembly.patches, cut.gaps)
    notices = list(_fit_notices(names, cut, "m²", "m³"))
    several = np.flatnonzero(cut.shells > 1)
    if len(several):
        text = f"files that hold several closed surfaces, taken as one rigid block each: {_block_list(names, several)}"
        notices.append(Notice("W334", text))
    if len(cut.unchecked):
        pairs = [f"{names[a]}/{names[b]}" for a, b in cut.unchecked.tolist()]
        notices.append(
            Notice(
                "W334",
                f"whether these blocks overlap could not be computed: {_shortened_list(pairs)}",
            )
        )
    return AssemblyScene(
        cut.assembly,
        names,
        (),
        (),
        np.zeros(0),
        np.zeros(0),
        {},
        {**_tolerance(cut.tolerance), "contact_area_m2": cut.contact},
        (),
        tuple(notices),
    )


def _refuse_overlaps(
    names: Sequence[str], pairs: Ints, amounts: Floats, sizes: Floats, unit: str
) -> None:
    """Raise E257 for blocks that overlap by more than a thousandth of the smaller block."""
    faults = [
        Fault(
            "E257",
            f"{names[a]} and {names[b]} overlap by {amount:.4g} {unit}",
            "",
            "Blocks may touch, not lie in each other: move one, or give contact_tolerance.",
        )
        for (a, b), amount in zip(pairs.tolist(), amounts.tolist(), strict=True)
        if amount > _OVERLAP * min(sizes[a], sizes[b])
    ]
    if faults:
        raise GeometryError(faults[:20])


def _refuse_floating(names: Sequence[str], fixed: Bools, patches: Patches, gaps: Misfits) -> None:
    """Raise E257 for blocks that are not connected to bedrock by contacts."""
    links = coo_array(
        (np.ones(len(patches)), (patches.plus, patches.minus)), shape=(len(names), len(names))
    )
    group = connected_components(links, directed=False)[1]
    floating = np.flatnonzero(~np.isin(group, group[fixed]))
    if not len(floating):
        return
    ends = np.isin(gaps.pairs, floating)
    gaps_in_words = [
        f"{names[a]} and {names[b]} are {1e3 * most:.3g} mm apart"
        for (a, b), most in zip(
            gaps.pairs[ends.any(axis=1)].tolist(), gaps.distances[ends.any(axis=1)], strict=True
        )
    ]
    advice = "Move their corners until faces meet, or give contact_tolerance" + (
        f": {_shortened_list(gaps_in_words)}." if gaps_in_words else "."
    )
    verb = (
        "has no contact and"
        if len(floating) == 1
        else "have no contact with bedrock, their own or through others, and"
    )
    fault = Fault(
        "E257",
        f"{_block_list(names, floating)} {verb} would fall whatever the strength",
        "",
        advice,
    )
    raise GeometryError([fault])


def _tolerance(contact: ContactTolerance) -> dict[str, float]:
    """Return the contact tolerance, and the rounding of the corners where the tolerance follows from it, m."""
    rounding = {"corner_rounding_m": contact.corner_rounding} if contact.corner_rounding else {}
    return {"contact_tolerance_m": contact.distance, **rounding}


def _fit_notices(names: Sequence[str], cut: BlocksCut, along: str, amount: str) -> Iterator[Notice]:
    """Yield the notices about overlaps, gaps, blocks without contacts, and contacts that depend on the tolerance."""
    overlaps, gaps, contact = cut.overlaps, cut.gaps, cut.tolerance
    if len(overlaps):
        misfit_texts = [
            f"{names[a]}/{names[b]} {size:.2g} {amount}"
            for (a, b), size in zip(overlaps.pairs.tolist(), overlaps.amounts.tolist(), strict=True)
        ]
        yield Notice(
            "W334",
            f"{len(misfit_texts)} pairs of blocks overlap a little: {_shortened_list(misfit_texts)}",
        )
    if len(gaps):
        misfit_texts = [
            f"{names[a]} and {names[b]} are {1e3 * distance:.3g} mm apart over {size:.3g} {along}"
            for (a, b), distance, size in zip(
                gaps.pairs.tolist(), gaps.distances.tolist(), gaps.amounts.tolist(), strict=True
            )
        ]
        yield Notice(
            "W334",
            f"faces that do not touch: {_shortened_list(misfit_texts)}; they carry nothing "
            "(contact_tolerance closes such gaps)",
        )
    for pairs, times, change in (
        (contact.lost, "a third of", "lost"),
        (contact.gained, "three times", "gained"),
    ):
        if len(pairs):
            blocks = _shortened_list([f"{names[a]}/{names[b]}" for a, b in pairs.tolist()])
            tolerance_text = f"{1e3 * contact.distance:.3g} mm"
            yield Notice(
                "W334",
                f"with {times} the contact tolerance ({tolerance_text}) contacts are {change}: {blocks}",
            )
    if len(cut.untouching):
        yield Notice("W334", f"blocks that touch no other: {_block_list(names, cut.untouching)}")


def _block_list(names: Sequence[str], indices: Ints) -> str:
    return _shortened_list([names[k] for k in indices.tolist()])


def _shortened_list(words: Sequence[str]) -> str:
    more = f" and {len(words) - _MOST_NAMED_BLOCKS} more" if len(words) > _MOST_NAMED_BLOCKS else ""
    return ", ".join(words[:_MOST_NAMED_BLOCKS]) + more


def _slope(design: BlocksDesign, result: Result) -> list[Section]:
    moving = [block.name for block in design.blocks if not block.fixed]
    fixed = [block.name for block in design.blocks if block.fixed]
    shape = (
        f"polygons of a section {design.thickness_m:.6g} m thick"
        if design.in_section
        else "closed meshes"
    )
    scaled = [
        block.mesh.label
        for block in design.blocks
        if block.mesh is not None and block.mesh.unit_name
    ]
    if scaled:
        shape += f"; {_shortened_list(list(dict.fromkeys(scaled)))}"
    y_up = [
        block.name for block in design.blocks if block.mesh is not None and block.mesh.up == "y"
    ]
    shape += f", y is up in the files of {names_in_runs(y_up)}" if y_up else ""
    tolerance = design.contact_tolerance_m
    touch = "" if tolerance is None else f"; faces nearer than {tolerance * 1e3:.6g} mm touch"
    entries = [
        f"{shape}{touch}",
        f"can move: {names_in_runs(moving)}; bedrock: {names_in_runs(fixed) or 'none'}",
    ]
    for name, strength in design.strengths:
        pairs = [
            f"{first}/{second}"
            for first, second, strength_name in design.interfaces
            if strength_name == name
        ]
        listed = ", ".join(shortened(pairs, _MOST_INTERFACES))
        places = [f"on {counted(len(pairs), 'named interface')} ({listed})"] if pairs else []
        if name == design.default_strength:
            places.insert(
                0, "on every other interface" if design.interfaces else "on every interface"
            )
        entries.append(
            f"{name}  {strength_in_words(strength, '.6g')}  {' and '.join(places) or 'on no interface'}"
        )
    made_from = Section("BLOCKS", entries + _block_weights_text(design))
    wet = [(f"{block}/{second}", pressure) for block, second, pressure in design.pressures_kpa]
    return slope_sections(
        result, made_from, water_of_blocks(wet), contact_areas(result.geometry.areas_m2)
    )


def _block_weights_text(design: BlocksDesign) -> list[str]:
    """Return the blocks with unit weights that differ from the rock's in words, lightest first."""
    by_weight: dict[float, list[str]] = {}
    for block in design.blocks:
        weight = block.unit_weight_kn_m3
        if weight is not None and not block.fixed and weight != design.rock.unit_weight_kn_m3:
            by_weight.setdefault(weight, []).append(block.name)
    if not by_weight:
        return []
    listed = [
        f"{weight:.5g} kN/m³ {names_in_runs(names)}" for weight, names in sorted(by_weight.items())
    ]
    first_weights, between, last = first_and_last(listed, 3, 1)
    more = [f"... {between} more ..."] if between else []
    return ["own unit weights: " + "; ".join([*first_weights, *more, *last])]


KIND = ManyBlocks(
    BlocksDesign,
    read_blocks,
    Words(
        "blocks of any shape",
        "blocks",
        "the way the file says",
        "closed form",
        "",
        BLOCKS_STATUSES,
        "there is none for blocks of any shape",
    ),
    cut,
    no_closed_form,
    _slope,
)
