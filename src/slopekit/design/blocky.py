"""Designs of many blocks: benches cut by joint sets, the user's own blocks, rows of columns."""

from dataclasses import dataclass
from typing import Literal

from slopekit.design.common import Design, MeshFile, Strength
from slopekit.orientation import Plane

Point2 = tuple[float, float]


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
    mechanisms: int = 1
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
    polygon_m: tuple[Point2, ...] | None = None
    mesh: MeshFile | None = None
    unit_weight_kn_m3: float | None = None
    fixed: bool = False


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

    blocks: tuple[BlockInput, ...]
    thickness_m: float = 1.0
    default_strength: str
    interfaces: tuple[tuple[str, str, str], ...] = ()
    pressures_kpa: tuple[tuple[str, str, float], ...] = ()
    contact_tolerance_m: float | None = None

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

    dip_deg: float
    width_m: float
    heights_m: tuple[float, ...]
    base_step_m: float = 0.0
    thickness_m: float = 1.0
    rows: int = 1
    base: str
    sides: str
    pressures_kpa: Point2 = (0.0, 0.0)

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
    plane: Plane
    spacing_m: float
    strength: str
    offset_m: float = 0.0
    scatter_deg: float = 0.0
    spacing_scatter: float = 0.0
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

    face: Plane
    upper: Plane
    height_m: float
    length_m: float
    depth_m: float
    sets: tuple[JointSetInput, ...]
    max_blocks: int = 20000
    min_volume_m3: float = 0.0
    origin_m: tuple[float, float, float] = (0.0, 0.0, 0.0)


#: The kinds of many blocks by name.
AssemblyKind = Literal["bench", "blocks", "topple"]
