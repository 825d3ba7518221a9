"""A bench cut into blocks by joint sets."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import Notice
from slopekit.core.orientation import Line, Plane, coordinates
from slopekit.core.sheet import Section
from slopekit.design.fields import (
    count,
    declare,
    fields_of,
    group,
    number,
    orientation,
    point,
    text,
)
from slopekit.design.ground_water import surcharge
from slopekit.design.parts import Action, Water
from slopekit.design.reading.reader import Reader
from slopekit.design.sections import strength_names
from slopekit.kinds.assemblies.many_blocks import (
    ManyBlocks,
    contact_areas,
    named_strength,
    no_closed_form,
    water_of_blocks,
)
from slopekit.kinds.assemblies.many_blocks_design import (
    MOST_BLOCKS,
    AssemblyDesign,
    common_attributes,
    read_pressures,
    water_by,
)
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene, with_loads
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.sizes import Crest
from slopekit.kinds.words import BLOCKS_STATUSES, short, slope_sections
from slopekit.preie.many_blocks.ravelling import Failure
from slopekit.result import Result, Words

MOST_SEED = 2**63 - 1
_SLIVER_SHARE = 0.01  # of the rock: pieces that hold more are blocks


@dataclass(frozen=True)
class JointSetInput:
    """A joint set of a bench.

    Attributes
    ----------
    spacing_m : mean distance of its planes, square to them
    offset_m : distance of one of its planes from the toe (middle of the bench), along the upward normal
    scatter_deg : how far the planes' normals scatter about the mean (standard deviation of the angle, Fisher)
    spacing_scatter : standard deviation of the distances, in parts of the spacing
    pressure_kpa : mean water pressure on its joints
    """

    ACTIONS: ClassVar[Mapping[str, Action]] = {"pressure_kpa": "water"}

    name: str
    plane: Plane = orientation("plane", example="45/170")
    spacing_m: float = number(
        "spacing",
        "length",
        above=0.0,
        code="E116",
        example="2 m",
        doc="mean distance of its planes, normal to them",
    )
    strength: str = text(
        "strength", default="", left_out="the only one", doc="a name under strength"
    )
    offset_m: float = number(
        "offset",
        "length",
        default=0.0,
        doc="of one of its planes from the toe, along the upward normal",
    )
    scatter_deg: float = number(
        "scatter",
        "angle",
        default=0.0,
        least=0.0,
        most=45.0,
        code="E186",
        role="scatter",
        doc="standard deviation of the angle of its planes about the mean (Fisher)",
    )
    spacing_scatter: float = number(
        "spacing_scatter",
        "ratio",
        default=0.0,
        least=0.0,
        most=1.0,
        code="E186",
        role="scatter",
        doc="standard deviation of the distances, in parts of the spacing",
    )
    pressure_kpa: float = 0.0


@dataclass(frozen=True, kw_only=True)
class BenchDesign(AssemblyDesign):
    """A bench cut into blocks by joint sets.

    The toe runs through the origin along the strike of the face, `length_m` long, half to each side; the rock is
    modelled from the level of the toe up and to `depth_m` behind the crest. Blocks that reach the ends, the back or
    the bottom go on there: they are bedrock.

    Attributes
    ----------
    seed : of what scatters
    forces, bolts : name their block, or lie in it: a force by `at_m`, a bolt by its head
    max_blocks : more are refused; min_volume_m3 : smaller ones are joined to the neighbour they share most with
    """

    ACTIONS: ClassVar[Mapping[str, Action]] = {"surcharge_kpa": "surcharge"}
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("surcharge_kpa",)
    ANSWERED = "button"

    face: Plane = orientation("slope.face", axis="the face", example="70/180")
    upper: Plane = orientation(
        "slope.upper", axis="the upper slope", default=None, example="60/180", left_out="level"
    )
    height_m: float = number("slope.height", "length", above=0.0, code="E116", example="15 m")
    length_m: float = number(
        "slope.length",
        "length",
        default=None,
        above=0.0,
        code="E116",
        left_out="twice the height",
        doc="along the strike, half to each side of the origin",
    )
    depth_m: float = number(
        "slope.depth",
        "length",
        default=None,
        above=0.0,
        code="E116",
        left_out="the height",
        doc="modelled behind the crest",
    )
    sets: tuple[JointSetInput, ...] = group(
        "sets",
        JointSetInput,
        many="names",
        at_least=1,
        example="{S1: {plane: 45/170, spacing: 2 m}}",
    )
    water: Water = water_by(
        declare(
            "pressures", "pressure", 0.0, many="names", axis="water pressure", example="{S1: 5 kPa}"
        ),
    )
    surcharge_kpa: float | None = surcharge()
    max_blocks: int = count("cut.max_blocks", 1, MOST_BLOCKS, default=20000, doc="more are refused")
    min_volume_m3: float = number(
        "cut.min_volume",
        "volume",
        default=0.0,
        least=0.0,
        code="E116",
        says="a volume is never negative",
        advice="0 keeps every block, however small.",
        scatters=False,
        role="setting",
        label="min_volume",
        doc="smaller blocks join the neighbour they share most with",
    )
    seed: int = count("cut.seed", 0, MOST_SEED, default=0, doc="of what scatters")
    origin_m: tuple[float, float, float] = point(
        "slope.origin", default=(0.0, 0.0, 0.0), doc="map coordinates of the toe"
    )

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The names of the joint sets."""
        return tuple(joint_set.name for joint_set in self.sets)


def read_bench(reader: Reader) -> BenchDesign:
    """Read the design of a bench cut by joint sets.

    Raises
    ------
    DesignError
        With every fault found: E116, E137, E151 and E186 for the slope, sets and cut, and those of every assembly.
    """
    values = reader.fields(BenchDesign)
    face, height = values["face"], values["height_m"]
    if values["upper"] is None and not reader.find("slope.upper") and face is not None:
        values["upper"] = reader.default("upper", Plane(0.0, face.dip_direction_deg))
    for key, factor in (("length", 2.0), ("depth", 1.0)):
        node = reader.find(f"slope.{key}")
        if node.value is None:
            values[f"{key}_m"] = reader.default(key, None if height is None else factor * height)
    names = [name for name, _ in reader.find("sets").items()]
    water = read_pressures(reader, names)
    values["sets"] = tuple(_sets(reader, dict(zip(names, water.pressures_kpa, strict=False))))
    toward = 0.0 if face is None else face.dip_direction_deg
    return reader.build(BenchDesign, common_attributes(reader, None, False, toward, water), values)


def _sets(reader: Reader, by_name: dict[str, float]) -> Iterator[JointSetInput]:
    """Yield the joint sets that can be read: E116 spacing, E186 scatter, E151 the same set twice."""
    nodes = reader.names("sets")
    strengths = strength_names(reader, [(name, node.get("strength"), node) for name, node in nodes])
    seen: dict[tuple[float, ...], str] = {}
    attributes_read = [name for name in fields_of(JointSetInput) if name != "strength"]
    for (name, node), strength in zip(nodes, strengths, strict=True):
        attributes = reader.fields(JointSetInput, node, name, only=attributes_read)
        if None in attributes.values():
            continue
        plane: Plane = attributes["plane"]
        key = (
            plane.dip_deg,
            plane.dip_direction_deg % 360.0,
            attributes["spacing_m"],
            attributes["offset_m"],
        )
        if key in seen:
            message = (
                f"{name} has the planes of {seen[key]}: the same orientation, spacing and offset"
            )
            reader.fault("E151", message, node, "Leave it out, or give it an offset.")
        seen.setdefault(key, name)
        yield JointSetInput(
            name=name, strength=strength or "", pressure_kpa=by_name.get(name, 0.0), **attributes
        )


def cut(design: BenchDesign) -> AssemblyScene:
    """Return the blocks of the bench with their loads. Raises GeometryError and DesignError as `with_loads`."""
    from slopekit.geometry.rock.bench import bench_body
    from slopekit.geometry.rock.joint_sets import JointSet, planes_of_sets
    from slopekit.geometry.rock.splitting import cut_bench

    body = bench_body(
        design.face.normal(),
        design.upper.normal(),
        design.height_m,
        design.length_m,
        design.depth_m,
    )
    sets = [
        JointSet(
            joint_set.plane.normal(),
            joint_set.spacing_m,
            joint_set.offset_m,
            joint_set.scatter_deg,
            joint_set.spacing_scatter,
        )
        for joint_set in design.sets
    ]
    planes = planes_of_sets(sets, body, np.random.default_rng(design.seed))
    cut = cut_bench(body, planes, design.max_blocks, design.min_volume_m3)
    assembly = cut.assembly
    small = f"slivers below {cut.min_volume:.3g} m³"
    slivers = [f"{cut.slivers_joined} {small} joined to the neighbour they share most with"] * bool(
        cut.slivers_joined
    )
    notices = [
        Notice(
            "W505", f"{cut.volume_left_out:.3g} m³ of rock is left out: {small} without a neighbour"
        )
    ] * bool(cut.slivers_left_out)
    share = cut.volume_joined / cut.body_volume
    if share > _SLIVER_SHARE:
        piece_count = cut.blocks + cut.slivers_joined + cut.slivers_left_out
        notices.append(
            Notice(
                "W505",
                f"pieces below cut.min_volume = {cut.min_volume:.3g} m³ hold {share * 100.0:.3g} "
                f"% of the rock and were joined to neighbours: {cut.blocks} of {piece_count} blocks are left, "
                "not those that the joints cut; take less",
            )
        )
    scene = AssemblyScene(
        assembly,
        tuple(f"B{k}" for k in range(1, len(assembly) + 1)),
        design.wet_interfaces,
        tuple(design.strength(joint_set.strength) for joint_set in design.sets),
        np.full(len(assembly), design.rock.unit_weight_kn_m3),
        np.array([joint_set.pressure_kpa for joint_set in design.sets])[assembly.patches.joint],
        {},
        {
            "volume_error": cut.volume_error,
            "area_error": cut.area_error,
            "plane_error_m": cut.plane_error,
            "joint_area_m2": cut.joint_area,
        },
        (
            f"{cut.fixed} of {cut.blocks} blocks reach the ends, the back or the bottom of "
            "the bench, where the rock goes "
            "on: bedrock, no unknowns",
            *slivers,
        ),
        tuple(notices),
        origin=np.array(design.origin_m),
        crest=Crest(_crest_point(design), design.face.normal(), design.upper.normal()),
    )
    smaller = (
        f", or a cut.min_volume below {cut.min_volume:.3g} m3" if share > _SLIVER_SHARE else ""
    )
    advice = f"Take closer joints or a longer and deeper bench{smaller}."
    if design.water.has_table or design.surcharge_kpa:
        from slopekit.kinds.assemblies.table_on_patches import with_surcharge, with_water

        into = -Line(design.face.dip_direction_deg, 0.0).vector()
        scene = with_surcharge(with_water(design, scene, into, body), design.surcharge_kpa, body)
    return with_loads(design, scene, design.face.dip_direction_deg, advice)


def _crest_point(design: BenchDesign) -> Floats:
    """Return the point (3,) m of the crest straight up the dip of the face from the middle of the toe."""
    dip, direction = math.radians(design.face.dip_deg), math.radians(design.face.dip_direction_deg)
    back = -design.height_m / math.tan(dip)
    return np.array([math.sin(direction) * back, math.cos(direction) * back, design.height_m])


def _notices(
    design: BenchDesign, scene: AssemblyScene, first: Failure, _: ClosedForm
) -> Iterator[Notice]:
    patches, fixed = scene.assembly.patches, np.append(scene.assembly.fixed, True)
    moves = np.zeros(len(fixed), dtype=bool)
    moves[first.blocks] = True
    if (
        (moves[patches.plus] & fixed[patches.minus]) | (moves[patches.minus] & fixed[patches.plus])
    ).any():
        yield Notice(
            "W338",
            "the first mechanism touches blocks that are bedrock only because the model ends "
            "there: see whether a longer or deeper bench changes the factor",
        )


def _slope(design: BenchDesign, result: Result) -> list[Section]:
    entries, areas = [], result.geometry.areas_m2
    for joint_set in design.sets:
        area = f"  area {short(areas[joint_set.name])} m²" if joint_set.name in areas else ""
        plane = f"{joint_set.name} {joint_set.plane}  {joint_set.plane.in_words()}"
        spacing = f"every {joint_set.spacing_m:.6g} m{_regularity(design, joint_set)}"
        entries.append(f"{plane}, {spacing}  {named_strength(design, joint_set.strength)}{area}")
    entries += [_surface("face", design.face), _surface("upper", design.upper)]
    toe = "" if not any(design.origin_m) else f" (mid-toe at {coordinates(design.origin_m)[1:-1]})"
    entries.append(
        f"bench {design.length_m:.6g} m along the strike{toe}, rock modelled to {design.depth_m:.6g} m behind the crest"
    )
    wet = [(joint_set.name, joint_set.pressure_kpa) for joint_set in design.sets]
    contacts = contact_areas(
        {name: area for name, area in areas.items() if name not in design.wet_interfaces}
    )
    return slope_sections(result, Section("SETS", entries), water_of_blocks(wet), contacts)


def _regularity(design: BenchDesign, joint_set: JointSetInput) -> str:
    """Return the offset and the scatter of a joint set in words."""
    words = ""
    if joint_set.offset_m:
        side = "above" if joint_set.offset_m > 0.0 else "below"
        words += f" (one plane {abs(joint_set.offset_m):.6g} m {side} mid-toe)"
    orientation_scatter = (
        f"normals scatter by {joint_set.scatter_deg:.4g}°" if joint_set.scatter_deg else ""
    )
    uneven = (
        f"distances scatter by {joint_set.spacing_scatter * 100:.4g} %"
        if joint_set.spacing_scatter
        else ""
    )
    if orientation_scatter or uneven:
        words += (
            f", {' and '.join(filter(None, (orientation_scatter, uneven)))} (seed {design.seed})"
        )
    return words


def _surface(name: str, plane: Plane) -> str:
    return f"{name} {plane}  " + (plane.in_words() if plane.dip_deg else "level")


KIND = ManyBlocks(
    BenchDesign,
    read_bench,
    Words(
        "bench cut by joint sets",
        "bench",
        "the way the face dips",
        "closed form",
        "",
        BLOCKS_STATUSES,
        "there is none for blocks cut by joint sets",
    ),
    cut,
    no_closed_form,
    _slope,
    _notices,
)
