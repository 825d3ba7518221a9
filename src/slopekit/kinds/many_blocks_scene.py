"""From a design of many blocks to arrays: the blocks, their contacts and strengths, the loads on them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from slopekit.arrays import Bools, Floats, Ints, frozen
from slopekit.design.blocky import AssemblyDesign, BenchDesign, BlocksDesign, ToppleDesign
from slopekit.design.common import Bolt, Force, Strength
from slopekit.errors import DesignError, Fault, GeometryError, Notice
from slopekit.geometry.patches import BEDROCK, Assembly
from slopekit.kinds.one_block import Clock, point_force
from slopekit.loads import NO_BOLTS, AssemblyLoads, PassiveBolts, PointForce, assembly_loads
from slopekit.orientation import Line

_OVERLAP = 1e-3  # of the smaller block: a larger overlap is refused
_NAMED = 5  # blocks that a notice names


@dataclass(frozen=True, slots=True)
class AssemblyScene:
    """An assembly with everything that the analysis needs, in the design's coordinates less `origin`.

    Attributes
    ----------
    names : (n,); joints : names by joint index, strengths : their strengths
    unit_weights : (n,) kN/m³; pressures : (k,) kPa on each patch
    seismic : (3,) parts of the weight; pushes : forces and active bolts on blocks by index
    bolts : the passive ones, bolt_names : as the design numbers them
    outlines : x, z of the blocks of a section by name
    checks : figures of what was checked; left_out : in words
    """

    assembly: Assembly
    names: tuple[str, ...]
    joints: tuple[str, ...]
    strengths: tuple[Strength, ...]
    unit_weights: Floats
    pressures: Floats
    seismic: Floats
    pushes: tuple[tuple[int, PointForce], ...]
    outlines: Mapping[str, Floats]
    checks: Mapping[str, float]
    left_out: tuple[str, ...]
    notices: tuple[Notice, ...]
    thickness: float | None = None
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    bolts: PassiveBolts = NO_BOLTS
    bolt_names: tuple[str, ...] = ()


def assembly_scene(design: AssemblyDesign, clock: Clock) -> AssemblyScene:
    """The scene of a design.

    Raises
    ------
    GeometryError
        Where no blocks can be formed, E256 where none of them can move.
    DesignError
        E250, E251 for loads on blocks that are not there, E212 for passive bolts that end in their own block.
    """
    with clock("cut"):
        if isinstance(design, BenchDesign):
            scene = _bench(design)
        elif isinstance(design, ToppleDesign):
            scene = _topple(design)
        elif isinstance(design, BlocksDesign):
            scene = _blocks(design)
        else:
            raise TypeError(f"no assembly for {type(design).__name__}")
    if scene.assembly.fixed.all():
        advice = "Take closer joints or a longer and deeper bench." if isinstance(design, BenchDesign) else ""
        message = f"none of the {len(scene.assembly)} blocks can move: each reaches bedrock's side of the model"
        raise GeometryError([Fault("E256", message, "", advice)])
    pushes, bolts, names = _pushes(design, scene)
    return replace(scene, pushes=pushes, bolts=bolts, bolt_names=names, seismic=_seismic(design))


def scene_loads(scene: AssemblyScene) -> AssemblyLoads:
    """All loads on the blocks of a scene."""
    return assembly_loads(scene.assembly, scene.unit_weights, scene.seismic, scene.pressures, scene.pushes, scene.bolts)


# -- the kinds --------------------------------------------------------------------------------------------------------


def _bench(design: BenchDesign) -> AssemblyScene:
    from slopekit.geometry.bench import bench_body
    from slopekit.geometry.joint_sets import JointSet, planes_of_sets
    from slopekit.geometry.splitting import cut_bench

    body = bench_body(design.face.normal(), design.upper.normal(), design.height_m, design.length_m, design.depth_m)
    sets = [
        JointSet(given.plane.normal(), given.spacing_m, given.offset_m, given.scatter_deg, given.spacing_scatter)
        for given in design.sets
    ]
    planes = planes_of_sets(sets, body, np.random.default_rng(design.seed))
    cut = cut_bench(body, planes, design.max_blocks, design.min_volume_m3)
    assembly = cut.assembly
    notices = []
    if cut.planes_merged or cut.planes_on_body_faces:
        notices.append(Notice("W337", f"{cut.planes_merged} joint planes that coincide were merged, "
                              f"{cut.planes_on_body_faces} lie on a face of the bench and cut nothing"))  # fmt: skip
    if cut.slivers_joined or cut.slivers_left_out:
        left = f", {cut.slivers_left_out} without a neighbour left out ({cut.volume_left_out:.3g} m³)"
        notices.append(Notice("W336", f"{cut.slivers_joined} slivers below {cut.min_volume:.3g} m³ were joined to the "
                              f"neighbour they share most with{left if cut.slivers_left_out else ''}"))  # fmt: skip
    return AssemblyScene(
        assembly, tuple(f"B{k}" for k in range(1, len(assembly) + 1)), tuple(given.name for given in design.sets),
        tuple(design.strength(given.strength) for given in design.sets),
        np.full(len(assembly), design.unit_weight_kn_m3),
        np.array([given.pressure_kpa for given in design.sets])[assembly.patches.joint],
        np.zeros(3), (), {},
        {"volume_error": cut.volume_error, "area_error": cut.area_error, "plane_error_m": cut.plane_error,
         "joint_area_m2": cut.joint_area},
        (f"{cut.fixed} of {cut.blocks} blocks reach the ends, the back or the bottom of the bench, where the rock goes "
         "on: bedrock, no unknowns",),
        tuple(notices), origin=np.array(design.origin_m),
    )  # fmt: skip


def _topple(design: ToppleDesign) -> AssemblyScene:
    from slopekit.geometry.columns import BASE, RISER, column_assembly, column_outlines

    heights = np.array(design.heights_m)
    assembly = column_assembly(
        design.dip_deg, design.width_m, heights, design.base_step_m, design.thickness_m, design.rows
    )
    outlines, bedrock = column_outlines(design.dip_deg, design.width_m, heights, design.base_step_m)
    base, sides = design.strength(design.base), design.strength(design.sides)
    joint = assembly.patches.joint
    shown = dict(zip(design.block_names[: len(heights)], outlines, strict=True)) | {"bedrock": np.asarray(bedrock)}
    left_out = ["the rows do not touch: each is solved for itself"] if design.rows > 1 else []
    return AssemblyScene(
        assembly, design.block_names, ("base", "sides", "riser"), (base, sides, base),
        np.full(len(assembly), design.unit_weight_kn_m3),
        np.where(joint == BASE, design.pressures_kpa[0], np.where(joint == RISER, 0.0, design.pressures_kpa[1])),
        np.zeros(3), (), shown, {}, tuple(left_out), (), thickness=design.thickness_m,
    )  # fmt: skip


def _blocks(design: BlocksDesign) -> AssemblyScene:
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
    for named, values, take in (
        (design.interfaces, joint, lambda name: kinds.index(str(name))),
        (design.pressures_kpa, pressures, float),
    ):
        for first, second, value in named:
            a, b = sorted((index[first], index[second]))
            at = key == a * len(names) + b
            values[at] = take(value)
            if not at.any():
                unmet.append(f"{first}/{second}")
    if unmet:
        notices.append(Notice("W335", f"interfaces are named between blocks that do not touch: {_some(unmet)}"))
    return replace(
        scene, assembly=replace(scene.assembly, patches=replace(patches, joint=joint)), joints=kinds,
        strengths=tuple(strength for _, strength in design.strengths), pressures=frozen(pressures),
        unit_weights=np.array([
            design.unit_weight_kn_m3 if block.unit_weight_kn_m3 is None else block.unit_weight_kn_m3
            for block in design.blocks
        ]), notices=tuple(notices),
    )  # fmt: skip


def _section(design: BlocksDesign, names: tuple[str, ...], fixed: Bools) -> AssemblyScene:
    from slopekit.geometry.section_blocks import section_assembly

    polygons = [np.array(block.polygon_m) for block in design.blocks]
    cut = section_assembly(polygons, fixed, design.thickness_m, design.contact_tolerance_m, names)
    _refuse_overlaps(names, cut.overlaps.pairs, cut.overlaps.amounts, cut.assembly.volumes / design.thickness_m, "m²")
    notices = _fit(names, cut.overlaps.amounts, cut.overlaps.pairs, cut.gaps, cut.untouching, "m", "m²")
    if cut.point_contacts:
        text = f"{cut.point_contacts} pairs of blocks touch at a corner only, which carries nothing"
        notices.append(Notice("W342", text))
    return AssemblyScene(
        cut.assembly, names, (), (), np.zeros(0), np.zeros(0), np.zeros(3), (),
        dict(zip(names, cut.outlines, strict=True)),
        {"contact_tolerance_m": cut.tolerance, "contact_length_m": cut.contact_length},
        (), tuple(notices), thickness=design.thickness_m,
    )  # fmt: skip


def _solids(design: BlocksDesign, names: tuple[str, ...], fixed: Bools) -> AssemblyScene:
    from slopekit.geometry.meshes import read_mesh
    from slopekit.geometry.solids import mesh_assembly

    meshes: list[tuple[Floats, Ints]] = []
    faults: list[Fault] = []
    for block in design.blocks:
        assert block.mesh is not None
        try:
            vertices, triangles, _ = read_mesh(Path(block.mesh.path), block.mesh.name, block.mesh.where, turn=False)
            meshes.append((vertices, triangles))
        except DesignError as error:
            faults += error.faults
    if faults:
        raise DesignError(faults)
    cut = mesh_assembly(meshes, fixed, design.contact_tolerance_m, names)
    _refuse_overlaps(names, cut.overlaps.pairs, cut.overlaps.amounts, cut.assembly.volumes, "m³")
    notices = _fit(names, cut.overlaps.amounts, cut.overlaps.pairs, cut.gaps, cut.untouching, "m²", "m³")
    if len(cut.turned):
        notices.append(Notice("W343", f"meshes that were inside out have been turned: {_listed(names, cut.turned)}"))
    several = np.flatnonzero(cut.shells > 1)
    if len(several):
        text = f"files that hold several closed surfaces, taken as one rigid block each: {_listed(names, several)}"
        notices.append(Notice("W344", text))
    if len(cut.unchecked):
        pairs = [f"{names[a]}/{names[b]}" for a, b in cut.unchecked.tolist()]
        notices.append(Notice("W345", f"whether these blocks overlap could not be computed: {_some(pairs)}"))
    return AssemblyScene(
        cut.assembly, names, (), (), np.zeros(0), np.zeros(0), np.zeros(3), (), {},
        {"contact_tolerance_m": cut.tolerance, "contact_area_m2": cut.contact_area}, (), tuple(notices),
    )  # fmt: skip


def _refuse_overlaps(names: Sequence[str], pairs: Ints, amounts: Floats, sizes: Floats, unit: str) -> None:
    """E257 for blocks that lie in each other by more than a thousandth of the smaller one."""
    faults = [
        Fault("E257", f"{names[a]} and {names[b]} overlap by {amount:.4g} {unit}", "",
              "Blocks may touch, not lie in each other: move one, or give contact_tolerance.")
        for (a, b), amount in zip(pairs.tolist(), amounts.tolist(), strict=True)
        if amount > _OVERLAP * min(sizes[a], sizes[b])
    ]  # fmt: skip
    if faults:
        raise GeometryError(faults[:20])


def _fit(
    names: Sequence[str], overlaps: Floats, pairs: Ints, gaps: "object", untouching: Ints, along: str, amount: str
) -> list[Notice]:
    """What a reader must know of overlaps, gaps and blocks that touch nothing."""
    notices = []
    if len(overlaps):
        found = [
            f"{names[a]}/{names[b]} {size:.2g} {amount}"
            for (a, b), size in zip(pairs.tolist(), overlaps.tolist(), strict=True)
        ]
        notices.append(Notice("W333", f"{len(found)} pairs of blocks overlap a little: {_some(found)}"))
    places = getattr(gaps, "pairs").tolist()  # noqa: B009  (Gaps of geometry.fit)
    if places:
        most, long = getattr(gaps, "most").tolist(), getattr(gaps, "amounts").tolist()  # noqa: B009
        found = [
            f"{names[a]} and {names[b]} are {1e3 * apart:.3g} mm apart over {size:.3g} {along}"
            for (a, b), apart, size in zip(places, most, long, strict=True)
        ]
        notices.append(Notice("W334", f"faces that do not touch: {_some(found)}; they carry nothing "
                              "(contact_tolerance closes such gaps)"))  # fmt: skip
    if len(untouching):
        notices.append(Notice("W346", f"blocks that touch no other: {_listed(names, untouching)}"))
    return notices


def _listed(names: Sequence[str], which: Ints) -> str:
    return _some([names[k] for k in which.tolist()])


def _some(words: Sequence[str]) -> str:
    more = f" and {len(words) - _NAMED} more" if len(words) > _NAMED else ""
    return ", ".join(words[:_NAMED]) + more


# -- loads ------------------------------------------------------------------------------------------------------------


def _seismic(design: AssemblyDesign) -> Floats:
    given = design.seismic
    if not given.coefficient:
        return np.zeros(3)
    trend = given.trend_deg
    if trend is None:
        trend = design.face.dip_direction_deg if isinstance(design, BenchDesign) else 270.0
    return given.coefficient * Line(trend, 0.0).vector()


def _pushes(
    design: AssemblyDesign, scene: AssemblyScene
) -> tuple[tuple[tuple[int, PointForce], ...], PassiveBolts, tuple[str, ...]]:
    """Forces and active bolts with the index of the block that each acts on, and passive bolts with their names."""
    found, faults = [], []
    passive: list[tuple[int, int, PointForce]] = []
    names: list[str] = []
    finder = _finder(scene)
    loads: list[tuple[str, Force | Bolt, PointForce]] = []
    for k, force in enumerate(design.forces, 1):
        loads.append((f"force {k}", force, point_force(force, scene.origin)))
    for k, bolt in enumerate(design.bolts, 1):
        head = None if bolt.head_m is None else np.array(bolt.head_m) - scene.origin
        loads.append((f"bolt {k}", bolt, PointForce(bolt.force_kn * bolt.toward.vector(), head)))
    for name, given, push in loads:
        block = finder(given.block, push.at)
        if block is None:
            where = f"there is no block {given.block}" if given.block is not None else "its point lies in no block"
            faults.append(Fault("E250", f"{name} acts on no block: {where}"))
        elif scene.assembly.fixed[block]:
            faults.append(Fault("E250", f"{name} acts on {scene.names[block]}, which is bedrock"))
        elif isinstance(given, Force) or given.acts == "active":
            found.append((block, push))
        else:
            toe = _toe(scene, given, block, finder)
            if toe == block:
                advice = "It needs its anchorage behind the joint on top of that, or leave length out: rock holds it."
                message = f"{name} is {given.length_m:.4g} m long and ends in {scene.names[block]}: it is too short"
                faults.append(Fault("E212", message, "", advice))
            passive.append((block, toe, push))
            names.append(name)
    if faults:
        raise DesignError(faults)
    return tuple(found), _passive(scene, passive), tuple(names)


def _toe(scene: AssemblyScene, bolt: Bolt, head: int, finder: Callable[[str | None, Floats | None], int | None]) -> int:
    """The block in which a bolt ends, -1 for bedrock: all that is none of the blocks, and where no length is given."""
    if bolt.head_m is None or bolt.length_m is None:
        return BEDROCK
    end = np.array(bolt.head_m) + bolt.length_m * bolt.toward.vector() - scene.origin
    found = finder(None, end)
    if scene.assembly.in_section:
        shown = [outline for name, outline in scene.outlines.items() if name != "bedrock"]
        inside = [k for k, outline in enumerate(shown) if _holds(outline, end[[0, 2]])]
        found = inside[0] + head // len(shown) * len(shown) if inside else None  # of its own row of columns
    return BEDROCK if found is None or scene.assembly.fixed[found] else found


def _holds(outline: Floats, point: Floats) -> bool:
    """Whether a polygon (k, 2) holds a point (2,): a ray from it crosses the outline an odd number of times."""
    (x0, z0), (x1, z1) = outline.T, np.roll(outline, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = x0 + (point[1] - z0) * (x1 - x0) / (z1 - z0)
    return bool(np.count_nonzero(((z0 > point[1]) != (z1 > point[1])) & (crossing > point[0])) % 2)


def _passive(scene: AssemblyScene, found: Sequence[tuple[int, int, PointForce]]) -> PassiveBolts:
    """Passive bolts of blocks of their heads and toes, capacities and points; without a point through the centroid."""
    if not found:
        return NO_BOLTS
    points = [scene.assembly.centroids[head] if push.at is None else push.at for head, _, push in found]
    return PassiveBolts(
        np.array([head for head, _, _ in found]), np.array([toe for _, toe, _ in found]),
        frozen(np.array([push.force for _, _, push in found])), frozen(np.array(points)),
    )  # fmt: skip


def _finder(scene: AssemblyScene) -> Callable[[str | None, Floats | None], int | None]:
    index = {name: k for k, name in enumerate(scene.names)}
    assembly = scene.assembly

    def find(name: str | None, at: Floats | None) -> int | None:
        if name is not None:
            return index.get(name)
        if at is None or len(assembly.triangles) == 0:
            return None
        a, b, c = (assembly.vertices[assembly.triangles[:, k]] for k in range(3))
        outward = np.cross(b - a, c - a)
        beyond = ((at - a) * outward).sum(axis=1)
        inside = np.full(len(assembly), -np.inf)
        np.maximum.at(inside, assembly.triangle_block, beyond / np.maximum(np.abs(outward).max(axis=1), 1e-300))
        nearest = int(np.argmin(inside))
        return nearest if inside[nearest] <= 1e-6 * float(np.cbrt(assembly.volumes[nearest])) else None

    return find
