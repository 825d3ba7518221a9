"""Many blocks in arrays: the blocks, their contacts and strengths, the loads on them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import DesignError, Fault, GeometryError, Notice
from slopekit.core.orientation import Line
from slopekit.design.parts import Bolt, Force, Strength
from slopekit.geometry.patches import BEDROCK, Assembly
from slopekit.geometry.rays import line_triangle_intersections
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign, NamedDesign
from slopekit.kinds.sizes import Crest
from slopekit.kinds.solver_inputs import point_force
from slopekit.loads import (
    NO_BOLTS,
    AssemblyLoads,
    BlockLoad,
    PassiveBolts,
    PointForce,
    assembly_loads,
)

#: The number of a block by its name, or by a point in it.
_Finder: TypeAlias = Callable[[str | None, Floats | None], int | None]


@dataclass(frozen=True)
class SceneLoads:
    """The loads on the blocks of a scene in addition to weight and the water between blocks.

    Attributes
    ----------
    seismic : (3,) parts of the weight
    pushes : open water, surcharges, forces and active bolts, these at both ends where two blocks move
    bolts : the passive ones, bolt_names : as the design numbers them
    """

    seismic: Floats = field(default_factory=lambda: np.zeros(3))
    pushes: tuple[BlockLoad, ...] = ()
    bolts: PassiveBolts = NO_BOLTS
    bolt_names: tuple[str, ...] = ()

    def without_blocks(self, removed: Bools) -> "SceneLoads":
        """Return the loads without those on removed blocks (n,), and without the bolts and anchors to them."""
        is_removed = np.append(removed, False)
        bolts = np.flatnonzero(~(is_removed[self.bolts.head] | is_removed[self.bolts.toe]))
        return SceneLoads(
            self.seismic,
            tuple(
                load
                for load in self.pushes
                if not is_removed[load.block] and not is_removed[load.tied]
            ),
            self.bolts.chosen(bolts),
            tuple(self.bolt_names[k] for k in bolts.tolist()),
        )


@dataclass(frozen=True)
class AssemblyScene:
    """An assembly with everything that the analysis needs, in the design's coordinates less `origin`.

    Attributes
    ----------
    names : (n,); joints : names by joint index, strengths : their strengths
    unit_weights : (n,) kN/m³; pressures : (k,) mean kPa on each patch, water_points : (k, 3) where they
        act, None in the middle of each
    outlines : x, z of the blocks of a section by name
    checks : figures of what was checked; left_out : in words
    crest : of the slope, None where it is not known; crest_x : of columns that were made from a slope, m
    """

    assembly: Assembly
    names: tuple[str, ...]
    joints: tuple[str, ...]
    strengths: tuple[Strength, ...]
    unit_weights: Floats
    pressures: Floats
    outlines: Mapping[str, Floats]
    checks: Mapping[str, float]
    left_out: tuple[str, ...]
    notices: tuple[Notice, ...]
    thickness: float | None = None
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    acting: SceneLoads = field(default_factory=SceneLoads)
    water_points: Floats | None = None
    crest: Crest | None = None
    crest_x: float | None = None

    @property
    def polygons(self) -> list[Floats]:
        """The outlines (k, 2) of the blocks of a section, in their order."""
        return [self.outlines[name] for name in self.names]

    @property
    def surface(self) -> tuple[Floats, Ints]:
        """Triangles (t, 3, 3) of the surfaces of blocks, and the block (t,) of each; of a section strips along it."""
        assembly = self.assembly
        if not assembly.in_section:
            return assembly.vertices[assembly.triangles], assembly.triangle_block
        rings = [np.insert(outline, 1, 0.0, axis=1) for outline in self.polygons]
        start, end = (
            np.concatenate(rings),
            np.concatenate([np.roll(ring, -1, axis=0) for ring in rings]),
        )
        half = np.array([0.0, 1.0, 0.0])
        strip = [(start - half, end - half, end + half), (start - half, end + half, start + half)]
        block = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
        return np.concatenate([np.stack(corners, axis=1) for corners in strip]), np.tile(block, 2)

    @property
    def height_m(self) -> float:
        """The height from the lowest to the highest point of all blocks, bedrock among them, m."""
        if self.outlines:
            return float(
                np.ptp(np.concatenate([outline[:, 1] for outline in self.outlines.values()]))
            )
        return float(np.ptp(self.assembly.vertices[self.assembly.triangles.ravel(), 2]))

    def without_blocks(self, removed: Bools) -> "AssemblyScene":
        """Return the scene without removed blocks (n,), the loads on them, and the bolts and anchors to them."""
        if not removed.any():
            return self
        assembly = self.assembly.without_blocks(removed)
        is_open = (assembly.patches.plus != self.assembly.patches.plus) | (
            assembly.patches.minus != self.assembly.patches.minus
        )
        pressures = np.where(is_open, 0.0, self.pressures)
        return replace(
            self, assembly=assembly, pressures=pressures, acting=self.acting.without_blocks(removed)
        )


def with_loads(
    design: AssemblyDesign, scene: AssemblyScene, toward_deg: float, advice: str = ""
) -> AssemblyScene:
    """Return a scene with the loads on its blocks.

    Parameters
    ----------
    toward_deg : the way a seismic load acts without a trend; advice : where no block can move

    Raises
    ------
    GeometryError
        E225 where none of the blocks can move.
    DesignError
        E250 for loads on blocks that are not there, E212 for passive bolts that end in their own block.
    """
    if scene.assembly.fixed.all():
        message = f"none of the {len(scene.assembly)} blocks can move: each reaches bedrock's side of the model"
        raise GeometryError([Fault("E225", message, "", advice)])
    earthquake = design.seismic
    trend = toward_deg if earthquake.trend_deg is None else earthquake.trend_deg
    seismic = (
        earthquake.coefficient * Line(trend, 0.0).vector()
        if earthquake.coefficient
        else np.zeros(3)
    )
    scene = _with_forces_and_bolts(design, scene)
    return replace(scene, acting=replace(scene.acting, seismic=seismic))


def with_ground(design: NamedDesign, scene: AssemblyScene) -> AssemblyScene:
    """A scene of blocks with names with its ground water, distances along x, and its surcharges. Raises E456, E461."""
    if not (design.water.has_table or design.surcharges_kpa):
        return scene
    from slopekit.kinds.assemblies.table_on_patches import with_surcharges, with_water

    return with_surcharges(design, with_water(design, scene, np.array([1.0, 0.0, 0.0])))


def with_pushes(scene: AssemblyScene, pushes: Iterable[BlockLoad]) -> AssemblyScene:
    """Return a scene with further forces on its blocks."""
    return replace(scene, acting=replace(scene.acting, pushes=(*scene.acting.pushes, *pushes)))


def scene_loads(scene: AssemblyScene) -> AssemblyLoads:
    """Return all loads on the blocks of a scene."""
    acting = scene.acting
    return assembly_loads(
        scene.assembly,
        scene.unit_weights,
        acting.seismic,
        scene.pressures,
        acting.pushes,
        acting.bolts,
        scene.water_points,
    )


def least_counted_weight(
    design: AssemblyDesign, scene: AssemblyScene, loads: AssemblyLoads
) -> float:
    """Return the weight of the lightest mechanism that counts, kN."""
    return design.smallest_block * float(np.median(loads.weights[~scene.assembly.fixed]))


def _with_forces_and_bolts(design: AssemblyDesign, scene: AssemblyScene) -> AssemblyScene:
    """Return a scene with forces and active bolts, each on its block, and passive bolts with their names.

    An active bolt that ends in another block which moves pulls that too.
    """
    faults, pushes, far_ends = list[Fault](), list[BlockLoad](), list[BlockLoad]()
    passive, names = list[tuple[int, int, PointForce]](), list[str]()
    finder = _block_finder(scene)
    loads: list[tuple[str, str, Force | Bolt, PointForce]] = []
    for k, force in enumerate(design.forces, 1):
        place = design.place_of("loads", "forces", k, len(design.forces))
        loads.append((f"force {k}", place, force, point_force(force, scene.origin)))
    for k, bolt in enumerate(design.bolts, 1):
        head = None if bolt.head_m is None else np.array(bolt.head_m) - scene.origin
        place = design.place_of("support", "bolts", k, len(design.bolts))
        loads.append(
            (f"bolt {k}", place, bolt, PointForce(bolt.force_kn * bolt.toward.vector(), head))
        )
    for name, place, load, push in loads:
        block, toe = finder(load.block, push.point), BEDROCK
        if block is None:
            reason = (
                f"there is no block {load.block}"
                if load.block is not None
                else "its point lies in no block"
            )
            faults.append(Fault("E250", f"{name} acts on no block: {reason}", place))
            continue
        if scene.assembly.fixed[block]:
            faults.append(
                Fault("E250", f"{name} acts on {scene.names[block]}, which is bedrock", place)
            )
            continue
        if isinstance(load, Bolt):
            toe, wrong = _bolt_toe(scene, load, block, finder)
            if wrong is not None:
                faults.append(Fault(wrong[0], f"{name} {wrong[1]}", place, wrong[2]))
            if load.acts == "passive":
                passive.append((block, toe, push))
                names.append(name)
                continue
        number = f"force {len(pushes) + 1}"
        pushes.append(BlockLoad(number, block, push, toe))
        if toe != BEDROCK:
            far_ends.append(
                BlockLoad(f"{number}, at its end", toe, PointForce(-push.force, push.point), block)
            )
    if faults:
        raise DesignError(faults)
    bolted = replace(scene.acting, bolts=_passive_bolts(scene, passive), bolt_names=tuple(names))
    return with_pushes(replace(scene, acting=bolted), (*pushes, *far_ends))


def _bolt_toe(
    scene: AssemblyScene, bolt: Bolt, block: int, finder: _Finder
) -> tuple[int, tuple[str, str, str] | None]:
    """Return the block in which a bolt ends, and code, message and advice of the fault where it is not anchored.

    The block is -1 for bedrock: outside of all blocks, and for a bolt without a length. Where some blocks are bedrock,
    the space outside of all blocks is air.
    """
    if bolt.head_m is None:
        return BEDROCK, None
    assembly, length, name = scene.assembly, bolt.length_m, scene.names[block]
    head = np.array(bolt.head_m) - scene.origin
    beyond_block_m = 2.0 * (
        float(np.linalg.norm(assembly.centroids[block] - head)) + scene.height_m
    )
    end = head + (beyond_block_m if length is None else length) * bolt.toward.vector()
    ends_in = finder(None, end)
    if last_block_left(scene, head, end, block) < 0 and ends_in != block:
        length_note = "" if length is None else f" within its {length:.4g} m"
        message = f"misses {name}: from its head it does not pass through it{length_note}"
        return BEDROCK, ("E211", message, "Its head stands on a face of the block, or before one.")
    if length is None:
        return BEDROCK, None
    if ends_in == block:
        advice = "It needs its anchorage behind the joint on top of that, or leave length out: rock holds it."
        return BEDROCK, (
            "E212",
            f"is {length:.4g} m long and ends in {name}: it is too short",
            advice,
        )
    if ends_in is not None:
        return (BEDROCK if assembly.fixed[ends_in] else ends_in), None
    last_block = last_block_left(scene, head, end)
    if last_block >= 0 and assembly.fixed.any() and not assembly.fixed[last_block]:
        message = (
            f"comes out of {scene.names[last_block]} and ends in the air: it is anchored in nothing"
        )
        advice = (
            "Leave length out where rock holds it, or let it end in the block that it is tied to."
        )
        return BEDROCK, ("E211", message, advice)
    return BEDROCK, None


def last_block_left(
    scene: AssemblyScene, head: Floats, end: Floats, block: int | None = None
) -> int:
    """Return the block that a line from head to end (3,) leaves last, of all blocks or of one; -1 without any."""
    triangles, block_of_triangle = scene.surface
    if block is not None:
        triangles, block_of_triangle = (
            values[block_of_triangle == block] for values in (triangles, block_of_triangle)
        )
    if scene.assembly.in_section:
        head, end = head * [1.0, 0.0, 1.0], end * [1.0, 0.0, 1.0]
    distances, hits = line_triangle_intersections(head, end - head, triangles)
    is_passed = (distances > 0.0) & (distances <= 1.0)
    return (
        int(block_of_triangle[hits[np.where(is_passed, distances, -1.0).argmax()]])
        if is_passed.any()
        else -1
    )


def _contains(outline: Floats, point: Floats) -> bool:
    """Return whether a polygon (k, 2) contains a point (2,): a ray from it crosses an odd number of times."""
    (x0, z0), (x1, z1) = outline.T, np.roll(outline, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = x0 + (point[1] - z0) * (x1 - x0) / (z1 - z0)
    return bool(np.count_nonzero(((z0 > point[1]) != (z1 > point[1])) & (crossing > point[0])) % 2)


def _passive_bolts(
    scene: AssemblyScene, bolts: Sequence[tuple[int, int, PointForce]]
) -> PassiveBolts:
    """Return passive bolts from their head and toe blocks and forces; without a point they act at the centroid."""
    if not bolts:
        return NO_BOLTS
    points = [
        scene.assembly.centroids[head] if push.point is None else push.point
        for head, _, push in bolts
    ]
    return PassiveBolts(
        np.array([head for head, _, _ in bolts]),
        np.array([toe for _, toe, _ in bolts]),
        frozen(np.array([push.force for _, _, push in bolts])),
        frozen(np.array(points)),
    )


def _block_finder(scene: AssemblyScene) -> _Finder:
    index = {name: k for k, name in enumerate(scene.names)}
    assembly = scene.assembly

    def find(name: str | None, point: Floats | None) -> int | None:
        if name is not None:
            return index.get(name)
        if point is None:
            return None
        if assembly.in_section:
            return next(
                (
                    k
                    for k, outline in enumerate(scene.polygons)
                    if _contains(outline, point[[0, 2]])
                ),
                None,
            )
        a, b, c = (assembly.vertices[assembly.triangles[:, k]] for k in range(3))
        outward = np.cross(b - a, c - a)
        heights = ((point - a) * outward).sum(axis=1)
        inside = np.full(len(assembly), -np.inf)
        np.maximum.at(
            inside,
            assembly.triangle_block,
            heights / np.maximum(np.abs(outward).max(axis=1), 1e-300),
        )
        nearest = int(np.argmin(inside))
        return (
            nearest if inside[nearest] <= 1e-6 * float(np.cbrt(assembly.volumes[nearest])) else None
        )

    return find
