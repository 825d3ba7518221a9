"""Designs of many blocks: benches cut by joint sets, the user's own blocks, rows of columns."""

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from slopekit.design.common import Bolt, Design, Force, MeshFile, Strength, Water
from slopekit.design.fields import Field, count, group, number, orientation, point, text
from slopekit.design.structure import Leaf, ListOf, Named
from slopekit.orientation import Plane

Point2 = tuple[float, float]
MOST_BLOCKS = 200_000
MOST_SEED = 2**63 - 1


def _water(*pressures: Field) -> Any:
    """Water of blocks, by its pressures; mode and fill are known so that the reader can say why they are not taken."""
    also = (
        Field("mode", "text", example="dry", is_refused=True),
        Field("fill", "ratio", 0.0, 1.0, is_refused=True),
        *pressures,
    )
    keys = type("WaterOfBlocks", (_Keys,), {"ALSO": also})
    return group("water", keys, default=Water(), forms=(Leaf(example="dry"),))


@dataclass(frozen=True, slots=True)
class _Keys:
    """Keys that are read into attributes of another record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AssemblyDesign(Design):
    """What designs of many blocks share.

    Attributes
    ----------
    strengths : by name, in the order of the file
    mechanisms : how many successive mechanisms are wanted: what fails first is taken away, and so on
    seed : of all random numbers
    """

    strengths: tuple[tuple[str, Strength], ...]
    forces: tuple[Force, ...] = group(
        "loads.forces", Force, default=(), many="list",
        forms=(Leaf(example="500 kN@180/10"), ListOf(Leaf(), 3, 3, example="[0, -3, 6]")), coordinates=2,
        or_measures="force",
    )  # fmt: skip
    bolts: tuple[Bolt, ...] = group(
        "support.bolts", Bolt, default=(), many="list", forms=(Leaf(example="200 kN@000/10,passive"),)
    )
    water_unit_weight_kn_m3: float = 9.81
    factors: tuple[float, ...] = ()
    mechanisms: int = count(
        "analysis.mechanisms",
        1,
        1000,
        default=1,
        doc="successive mechanisms: what fails first is taken away, and so on",
    )
    seed: int = 0

    def strength(self, name: str) -> Strength:
        """A strength by its name."""
        return dict(self.strengths)[name]


@dataclass(frozen=True, slots=True)
class BlockInput:
    """A block of the user: a polygon (x, z) in m with the thickness of the section, or a closed mesh.

    `unit_weight_kn_m3` is None where the block has the rock's; `fixed` blocks are bedrock.
    """

    name: str
    polygon_m: tuple[Point2, ...] | None = text(
        "polygon", default=None, coordinates=2, left_out="one of the two",
        doc="corners [x, z] once around, either way; at least three", example="[[0, 0], [2, 0], [2, 1]]",
        forms=(ListOf(ListOf(Leaf(), 2, 2, example="[0, 5]"), 3, example="[[0, 0], [2, 0], [2, 1]]"),),
    )  # fmt: skip
    mesh: MeshFile | None = text(
        "mesh",
        default=None,
        example="block.stl",
        left_out="one of the two",
        doc="a closed mesh file (STL, OBJ, PLY, OFF, GLB, DXF)",
    )
    unit_weight_kn_m3: float | None = number(
        "unit_weight", "unit weight", default=None, least=5.0, most=400.0, code="E110", label="unit weight",
        says="out of range ({least} to {most})",
        left_out="the rock's", advice="A block takes its unit weight in kN/m³: 9.81 times the density in t/m³.",
    )  # fmt: skip
    fixed: bool = text("fixed", default=False, doc="`true` for bedrock; at least one is, at least one is not")


@dataclass(frozen=True, slots=True, kw_only=True)
class BlocksDesign(AssemblyDesign):
    """The user's own blocks: all polygons of one section, or all meshes.

    Attributes
    ----------
    default_strength : of every interface that is not named
    interfaces : (block, block, strength) of those that are
    pressures_kpa : (block, block, mean water pressure) where there is water
    contact_tolerance_m : faces nearer than this touch; None: 1e-5 of the mean size of the blocks
    """

    REQUIRED: ClassVar[tuple[str, ...]] = ("strength",)

    blocks: tuple[BlockInput, ...] = group(
        "blocks", BlockInput, many="names", at_least=1, example="{B1: {polygon: [[0, 0], [2, 0], [2, 1]]}}"
    )
    thickness_m: float = number(
        "section.thickness",
        "length",
        default=1.0,
        above=0.0,
        code="E240",
        taken="section_thickness_m",
        doc="not beside meshes",
    )
    default_strength: str
    interfaces: tuple[tuple[str, str, str], ...] = text(
        "interfaces", default=(), left_out="the only strength", doc="a strength by `default`, and of pairs `A/B`",
        forms=(Named(Leaf(example="joint"), pairs=True, example="{default: joint, B1/B2: smooth}"),),
    )  # fmt: skip
    water: Water = _water(
        Field("pressures", "pressure", 0.0, many="pairs", axis="water pressure", example="{B1/B2: 5 kPa}")
    )
    pressures_kpa: tuple[tuple[str, str, float], ...] = ()
    contact_tolerance_m: float | None = number(
        "contact_tolerance",
        "length",
        default=None,
        left_out="1e-5 of the mean block",
        doc="faces nearer than this touch",
        above=0.0,
        code="E254",
        scatters=False,
        role="setting",
    )

    @property
    def section_thickness_m(self) -> float | None:
        """Of the section; blocks of meshes have none."""
        return self.thickness_m if self.in_section else None

    @property
    def in_section(self) -> bool:
        """Whether the blocks are polygons of a vertical section."""
        return all(block.mesh is None for block in self.blocks)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToppleDesign(AssemblyDesign):
    """Columns on a stepped base (Goodman & Bray 1976), numbered C1, C2, ... from the toe upward; per `thickness_m`.

    Attributes
    ----------
    dip_deg : of the columns, into the slope: the base of each dips 90° less out of it
    width_m : of every column, along the base
    heights_m : from the toe upward, square to the base
    base_step_m : how much the base of each column lies above that of the one below, square to the base
    base, sides : names of the strengths
    pressures_kpa : mean water pressure on the bases and on the sides
    rows : of columns side by side along the strike, all alike; with several, C3 of row 2 is C3-2
    """

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("columns.base", "text", left_out="the only one", doc="strength of the bases"),
        Field("columns.sides", "text", left_out="the only one", doc="strength between the columns"),
    )  # fmt: skip

    dip_deg: float = number(
        "columns.dip", "angle", above=0.0, below=90.0, code="E139", example="60", label="dip of the columns",
        advice="Columns dip into the slope; their base falls out of it, square to them.",
    )  # fmt: skip
    width_m: float = number(
        "columns.width", "length", above=0.0, code="E240", example="10 m", doc="of every column, along the base"
    )
    heights_m: tuple[float, ...] = number(
        "columns.heights", "length", above=0.0, code="E240", many="list", at_least=1, example="[4, 10, 16]",
        label="height of C{k}", doc="from the toe upward, square to the base",
    )  # fmt: skip
    base_step_m: float = number(
        "columns.base_step", "length", default=0.0, least=0.0, code="E241",
        says="it lies from 0 to less than the lowest column",
        doc="how much each base lies above that of the column below, square to it",
    )  # fmt: skip
    thickness_m: float = number("columns.thickness", "length", default=1.0, above=0.0, code="E240")
    rows: int = count("columns.rows", 1, MOST_BLOCKS, default=1, doc="of columns side by side along the strike")
    base: str
    sides: str
    water: Water = _water(
        Field("pressures.base", "pressure", 0.0, axis="water pressure on the bases"),
        Field("pressures.sides", "pressure", 0.0, axis="water pressure on the sides"),
    )
    pressures_kpa: Point2 = (0.0, 0.0)

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The bases of the columns, and their sides."""
        return "base", "sides"

    @property
    def block_names(self) -> tuple[str, ...]:
        """The names of the columns, from the toe upward, row by row."""
        return column_names(len(self.heights_m), self.rows)


def column_names(columns: int, rows: int = 1) -> tuple[str, ...]:
    """Names of columns: C1, C2, ...; with several rows C1-1, C2-1, ..., C1-2, ...

    >>> column_names(2), column_names(2, 2)
    (('C1', 'C2'), ('C1-1', 'C2-1', 'C1-2', 'C2-2'))
    """
    if rows == 1:
        return tuple(f"C{column}" for column in range(1, columns + 1))
    return tuple(f"C{column}-{row}" for row in range(1, rows + 1) for column in range(1, columns + 1))


@dataclass(frozen=True, slots=True)
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

    name: str
    plane: Plane = orientation("plane", example="45/170")
    spacing_m: float = number(
        "spacing", "length", above=0.0, code="E134", example="2 m", doc="mean distance of its planes, square to them"
    )
    strength: str = text("strength", default="", left_out="the only one", doc="a name under strength")
    offset_m: float = number(
        "offset", "length", default=0.0, doc="of one of its planes from the toe, along the upward normal"
    )
    scatter_deg: float = number(
        "scatter",
        "angle",
        default=0.0,
        least=0.0,
        most=45.0,
        code="E135",
        role="scatter",
        doc="standard deviation of the angle of its planes about the mean (Fisher)",
    )
    spacing_scatter: float = number(
        "spacing_scatter",
        "ratio",
        default=0.0,
        least=0.0,
        most=1.0,
        code="E135",
        role="scatter",
        doc="standard deviation of the distances, in parts of the spacing",
    )
    pressure_kpa: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
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

    face: Plane = orientation("slope.face", axis="the face", example="70/180")
    upper: Plane = orientation("slope.upper", axis="the upper slope", default=None, example="60/180", left_out="level")
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
        "sets", JointSetInput, many="names", at_least=1, example="{S1: {plane: 45/170, spacing: 2 m}}"
    )
    water: Water = _water(
        Field("pressures", "pressure", 0.0, many="names", axis="water pressure", example="{S1: 5 kPa}")
    )
    max_blocks: int = count("cut.max_blocks", 1, MOST_BLOCKS, default=20000, doc="more are refused")
    min_volume_m3: float = number(
        "cut.min_volume", "volume", default=0.0, least=0.0, code="E138", says="a volume is never negative",
        advice="0 keeps every block, however small.", scatters=False, role="setting", label="min_volume",
        doc="smaller blocks join the neighbour they share most with",
    )  # fmt: skip
    seed: int = count("cut.seed", 0, MOST_SEED, default=0, doc="of what scatters")
    origin_m: tuple[float, float, float] = point(
        "slope.origin", default=(0.0, 0.0, 0.0), doc="map coordinates of the toe"
    )

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The joint sets."""
        return tuple(one.name for one in self.sets)


#: The kinds of many blocks by name.
AssemblyKind = Literal["bench", "blocks", "topple"]
