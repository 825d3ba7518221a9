"""Assemblies of blocks: benches cut by joint sets, the user's own blocks, rows of columns.

scene -> loads -> the mechanisms one after the other -> what they say of each block -> Result.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from slopekit.analysis.assembly_scene import AssemblyScene, assembly_scene, scene_loads
from slopekit.analysis.assembly_states import assembly_arrows, assembly_pair_state, at_full_strength
from slopekit.analysis.motions import mechanism
from slopekit.analysis.secants import left_out_of_laws, secant_of
from slopekit.analysis.stages import Clock, ClosedForm, compare, joint_stiffness, joint_strength
from slopekit.arrays import frozen
from slopekit.block_scene import Contacts
from slopekit.design.blocky import AssemblyDesign, BenchDesign, ToppleDesign
from slopekit.errors import Notice
from slopekit.findings import AssemblyGeometry, Column, Findings, Mechanism
from slopekit.loads import AssemblyLoads
from slopekit.notices import MESH_CHANGE, SQUARE, common_notices
from slopekit.preie.balance import Balance, balance, of_blocks
from slopekit.preie.bed import SHEAR_TO_NORMAL
from slopekit.preie.blocks import STRONGER, Basis, BlocksLimit
from slopekit.preie.passes import Outcome
from slopekit.preie.ravelling import Part, Ravelling, critical_load, ravel, whole_model
from slopekit.preie.untied import AllPairsFailed, all_pairs_failed
from slopekit.result import AllPairs, CurvedStrength, FactorsOfSafety, Forces, ModelSize, Result, SecantLine

_BRACKET = 1e-4  # of the paper's criterion, in parts of its factor
_FAR_ABOVE = 1.1  # a static bound so many times the limit: the limit lives on joints that do not dilate
_ENDS = {
    "count": "more mechanisms were not asked for",
    "stands": "what is left stands without any strength",
    "gone": "nothing is left that could move",
    "not_converged": "the last one did not settle, so what comes after it is not known",
}


@dataclass(frozen=True, slots=True)
class SolvedAssembly:
    """A result with what it was read from."""

    result: Result
    scene: AssemblyScene
    loads: AssemblyLoads
    ravelling: Ravelling


def analyse_assembly(design: AssemblyDesign) -> Result:
    """Analyse a bench, blocks or columns.

    Raises
    ------
    GeometryError, DesignError
        Where no blocks can be formed, or loads act on none.
    """
    return solve_assembly(design).result


def load_multiplier(without: AssemblyDesign, unit: AssemblyDesign, target: float) -> tuple[float, str] | None:
    """The multiplier of what one design has more of loads than another at which its factor is a target; the status.

    None where the blocks do not stand without it, stand with any of it, or the motion does not settle.
    """
    clock = Clock()
    scenes = [assembly_scene(design, clock) for design in (without, unit)]
    loads = [scene_loads(scene) for scene in scenes]
    ramp = (loads[1].forces - loads[0].forces, loads[1].moments - loads[0].moments)
    if not ramp[0].any() and not ramp[1].any():
        return None
    scene = scenes[0]
    found = critical_load(scene.assembly, loads[0], ramp, joint_strength(scene.strengths), 1.0 / target)
    return None if found is None else (found[0], mechanism(found[1], scene).status)


def assembly_factors(design: AssemblyDesign) -> tuple[str, float | None, ClosedForm, bool]:
    """Status, factor of safety, closed form and whether they settled, and nothing that a sheet prints beside them."""
    scene = assembly_scene(design, Clock())
    loads = scene_loads(scene)
    ravelling = ravel(scene.assembly, loads, joint_strength(scene.strengths), ranged=False)
    found = tuple(mechanism(failure, scene) for failure in ravelling.failures)
    status = found[0].status if found else "no_driving_force"
    settled = status != "not_converged" and not (found and found[0].change > design.stop_when)
    return status, found[0].fos if found and settled else None, _closed_form(design, found)[0], settled


def solve_assembly(design: AssemblyDesign) -> SolvedAssembly:
    """The same with its blocks, loads and mechanisms, for studies that go on from there."""
    clock = Clock()
    scene = assembly_scene(design, clock)
    assembly = scene.assembly
    with clock("loads"):
        loads = scene_loads(scene)
    with clock("solve"):
        ravelling = ravel(assembly, loads, joint_strength(scene.strengths), design.mechanisms)
    with clock("mechanisms"):
        found = tuple(mechanism(failure, scene) for failure in ravelling.failures)
    with clock("all_pairs"):
        untied = None
        if design.criterion == "all-pairs" and found and found[0].fos:
            untied = untied_search(design, scene, loads, found[0].fos)
    status = found[0].status if found else "no_driving_force"
    sure = bool(found) and found[0].status != "not_converged"
    limit = found[0].fos if sure else None
    bound = found[0].static_bound if found else None
    governing = ravelling.failures[0].limit if ravelling.failures else None
    low, high = (governing.lowest, governing.highest) if governing is not None and sure else (None, None)
    with clock("displacements"):
        stands = status == "no_driving_force" or (limit is not None and limit > 1.0)
        settled = at_full_strength(design, scene, loads) if stands else None
    with clock("closed_form"):
        closed, table = _closed_form(design, found)
    difference, agree = compare(limit, status, closed, design.agree_within)
    findings = Findings(
        found, _factors(ravelling, scene, found), _standing(ravelling, scene), len(assembly),
        int(assembly.fixed.sum()), len(assembly.patches), len(ravelling.parts), _checks(scene, ravelling), table,
        SHEAR_TO_NORMAL,
    )  # fmt: skip
    parts = ravelling.parts
    balanced = _balance(parts)
    first = ravelling.failures[0].parts if ravelling.failures else ()
    split = [0 if part.refined is None else int(part.refined.max()) for part in first]
    size = ModelSize(
        int((~assembly.fixed).sum()), sum(part.model.load.size for part in parts),
        sum(part.model.joint_pairs.stop for part in parts), max(split, default=0),
        max((part.mesh_change for part in first if part.mesh_change is not None), default=None),
        _left_out(design, scene, parts),
        max((part.limit.steps for part in first), default=0), found[0].change if found else 0.0,
    )  # fmt: skip
    result = Result(
        design=design, status=status,
        fos=FactorsOfSafety(limit, closed.factor, bound, untied.factor if untied else None, low, high),
        difference=difference, agree=agree, moments_govern=False, forces_only=None,
        static_bound_proved=bound is not None,
        geometry=_geometry(scene), forces=_forces(scene, loads, parts),
        model=size, mechanism=None, at_factor_one=settled, governs=(),
        all_pairs=None if untied is None else all_pairs(untied),
        warnings=tuple(_notices(design, scene, ravelling, found, closed)),
        node_pairs=assembly_pair_state(scene, parts), acting=assembly_arrows(scene, loads, parts),
        findings=findings, balance=balanced, curved_strength=_curved(scene, parts), timing_s=clock.done(),
    )  # fmt: skip
    return SolvedAssembly(result, scene, loads, ravelling)


def untied_search(
    design: AssemblyDesign, scene: AssemblyScene, loads: AssemblyLoads, limit: float
) -> AllPairsFailed | None:
    """The paper's criterion for many blocks: the factor at which a block first has no chain of sticking pairs."""
    model = whole_model(scene.assembly, loads, joint_strength(scene.strengths))
    return None if model is None else all_pairs_failed(model, joint_stiffness(design), limit, relative=_BRACKET)


def all_pairs(search: AllPairsFailed) -> AllPairs:
    """The search as a result keeps it."""
    return AllPairs(search.bracket, search.lost_equilibrium, search.history)


def _factors(ravelling: Ravelling, scene: AssemblyScene, found: Sequence[Mechanism]) -> dict[str, float | None]:
    """The factor at which each block fails as strength is reduced; None where no strength holds it.

    A block that only the one before it held fails together with it, however low its own factor is then.
    """
    out: dict[str, float | None] = {}
    reached: float | None = None
    for failure, one in zip(ravelling.failures, found, strict=True):
        reached = one.fos if reached is None else max(reached, one.fos or 0.0)
        if one.status == "not_converged":
            break
        for block in failure.blocks.tolist():
            out[scene.names[block]] = reached
    return out


def _standing(ravelling: Ravelling, scene: AssemblyScene) -> str:
    left = int(ravelling.left.sum())
    moving = int((~scene.assembly.fixed).sum())
    if left == 0:
        return f"none of {moving} blocks is left"
    return f"{left} of {moving} blocks are left; {_ENDS[ravelling.ended]}"


def _checks(scene: AssemblyScene, ravelling: Ravelling) -> dict[str, float]:
    """Conservation: what the geometry balanced, and how well the forces at the limit do."""
    checks = dict(scene.checks)
    worst = 0.0
    for part in ravelling.parts:
        model, limit = part.model, part.limit
        if limit.factor is None or len(model.control_area) == 0:
            continue
        off = model.forces_on_blocks(limit.normal_force, limit.friction) + model.load
        worst = max(worst, float(np.abs(off).max()) / float(np.abs(model.load).max()))
    checks["largest_unbalanced_force"] = worst
    return checks


def _balance(parts: Sequence[Part]) -> Balance | None:
    """How well the forces of the parts that have a factor balance the loads."""
    return balance([
        of_blocks(part.model, part.limit.factor, part.limit.normal_force, part.limit.friction, part.limit.bond)
        for part in parts
        if part.limit.factor and part.limit.outcome is Outcome.SLIDES and len(part.model.control_area)
    ])  # fmt: skip


def _left_out(design: AssemblyDesign, scene: AssemblyScene, parts: Sequence[Part]) -> tuple[str, ...]:
    """What was not modelled, with the proof or the check that lets it be."""
    said = ["bedrock and fixed blocks (they do not move), contacts between them, free faces", *scene.left_out]
    if len(parts) > 1:
        said.append(f"{len(parts)} groups of blocks touch only through bedrock: each is solved for itself (exact)")
    for part in parts:
        if part.limit.group:
            said.append(
                f"the limit is that of {part.limit.group} of {len(part.blocks)} blocks that touch, the others held; "
                f"all of them, none held, come to rest at {1.0 - part.limit.width:.4f} of it, and there have used up "
                "95 % of the strength along its motion, or run 1 % beyond it"
            )
    if scene.assembly.in_section:
        ends = "three node pairs a contact (Simpson's rule), its friction one force: a flat contact slips as one"
        said += ["everything repeats along the strike: 3 unknowns a block instead of 6 (exact)", ends]
    said += left_out_of_laws(scene.strengths)
    if design.mechanisms > 1 and scene.pressures.any():
        said.append("water in joints that a block has left: they stand open")
    return tuple(said)


def _geometry(scene: AssemblyScene) -> AssemblyGeometry:
    assembly = scene.assembly
    patches = assembly.patches
    free = ~assembly.fixed
    if scene.outlines:
        heights = np.concatenate([outline[:, 1] for outline in scene.outlines.values()])
    else:
        heights = assembly.vertices[assembly.triangles.ravel(), 2]
    areas = np.bincount(patches.joint, patches.areas, len(scene.joints))
    offset = scene.origin[[0, 2]]
    return AssemblyGeometry(
        float(assembly.volumes[free].sum()), float(np.ptp(heights)),
        dict(zip(scene.joints, areas.tolist(), strict=True)), scene.names, tuple(assembly.fixed.tolist()),
        scene.thickness, frozen(assembly.centroids + scene.origin),
        {name: frozen(outline + offset) for name, outline in scene.outlines.items()},
        frozen(assembly.vertices + scene.origin), assembly.triangles, assembly.triangle_block,
        Contacts(frozen(patches.corners + scene.origin), patches.first, patches.joint, patches.plus, patches.minus),
    )  # fmt: skip


def _forces(scene: AssemblyScene, loads: AssemblyLoads, parts: Sequence[Part]) -> Forces:
    """Weight of the moving blocks; normal forces at the limit and water by joint."""
    patches = scene.assembly.patches
    count = len(scene.joints)
    normal = np.zeros(count)
    known = True
    for part in parts:
        if len(part.model.control_area) == 0:
            continue
        known = known and part.limit.factor is not None
        real = part.model.joint_pairs
        joint = patches.joint[part.patch][part.model.pair_contact[real]]
        normal += np.bincount(joint, part.limit.normal_force[real] * part.model.force_scale, count)
    water = np.bincount(patches.joint, loads.water, count)
    return Forces(
        float(loads.weights[~scene.assembly.fixed].sum()),
        {name: float(value) if known else None for name, value in zip(scene.joints, normal, strict=True)},
        dict(zip(scene.joints, water.tolist(), strict=True)), None, None,
    )  # fmt: skip


def _curved(scene: AssemblyScene, parts: Sequence[Part]) -> CurvedStrength | None:
    """The line of each curved joint at the mean normal traction of its node pairs that carry any."""
    solved = [part for part in parts if part.model.lines is not None and part.limit.factor]
    if not solved:
        return None
    kinds = [part.model.lines.joint[part.model.joint_pairs] for part in solved if part.model.lines is not None]
    joint = np.concatenate(kinds)
    areas = [part.model.control_area[part.model.joint_pairs] * part.model.area_scale for part in solved]
    area = np.concatenate(areas)
    normals = [part.limit.normal_force[part.model.joint_pairs] * part.model.force_scale for part in solved]
    normal = np.concatenate(normals)
    lines = {}
    for key, (name, strength) in enumerate(zip(scene.joints, scene.strengths, strict=True)):
        on = (joint == key) & (normal > 0.0)
        if on.any() and (line := secant_of(strength, float(normal[on].sum() / area[on].sum()))) is not None:
            tractions = normal[on] / area[on]
            lines[name] = SecantLine(
                line.traction_kpa, (float(tractions.min()), float(tractions.max())), line.cohesion_kpa,
                line.friction_angle_deg,
            )  # fmt: skip
    rounds = max(part.model.lines.rounds for part in solved if part.model.lines is not None)
    return CurvedStrength(None, None, rounds, lines)


def _drawn_out(part: Part) -> bool:
    """Whether a mechanism draws out a passive bolt."""
    _, slip = part.model.opening_and_slip(part.limit.velocity)
    return bool((slip[part.model.bolted, 0] < -SQUARE).any())


def _closed_form(design: AssemblyDesign, found: Sequence[Mechanism]) -> tuple[ClosedForm, tuple[Column, ...]]:
    """Goodman & Bray's columns, where their method applies."""
    if not isinstance(design, ToppleDesign):
        return ClosedForm(None, "", "there is no closed form for these blocks"), ()
    from slopekit.analysis.columns import goodman_bray

    return goodman_bray(design, found[0] if found else None)


def _notices(
    design: AssemblyDesign, scene: AssemblyScene, ravelling: Ravelling, found: Sequence[Mechanism],
    closed: ClosedForm,
) -> Iterator[Notice]:  # fmt: skip
    yield from scene.notices
    yield from common_notices(design, scene.strengths)
    if not found:
        return
    first, limit = found[0], ravelling.failures[0].limit
    limit = replace(limit, bond=limit.bond[ravelling.failures[0].parts[0].model.joint_pairs])
    if any(bolt.head_m is None for bolt in design.bolts):
        yield Notice("W311", "bolts without a head act through the centroid: their moments are not checked")
    if first.fos and scene.bolt_names and not any(_drawn_out(part) for part in ravelling.failures[0].parts):
        yield Notice("W315", "the passive bolts add nothing: the movement does not draw them out")
    if limit.outcome is Outcome.NO_STRENGTH:
        yield Notice("W308", "the joints have no strength: nothing holds the blocks, there is no factor of safety")
    moved = max((part.mesh_change or 0.0 for part in ravelling.failures[0].parts), default=0.0)
    if moved > MESH_CHANGE:
        yield Notice("W312", f"the last refinement of the node pairs still moved the limit by {moved * 100:.1f} %")
    if limit.basis is Basis.PEAK and first.fos:
        yield Notice("W317", "the motion did not settle into a limit state: the factor is that of the last state at "
                     "rest, the peak of the elastic path; where limits of random sections were found they lay up to 4 "
                     "% below their peaks, which is no bound on this one")  # fmt: skip
    if first.fos and limit.change > design.stop_when and any(strength.law for strength in scene.strengths):
        yield Notice("W317", "strength at the tractions of one limit state leads to another, and back: the lowest "
                     f"factor is printed, others lie up to {limit.change * 100:.2g} % above it")  # fmt: skip
    if limit.loads_last and first.fos:
        yield Notice("W361", "with all loads on at once no limit state was found: weight and water came first, the "
                     "other loads after them, and F is the strength found at which they just all fit on")  # fmt: skip
    if limit.outcome is Outcome.NO_REST:
        yield _without_rest(limit)
    if first.fos and first.static_bound is None:
        yield Notice("W309", "no static bound was found: its search gave up, the blocks are too many for it, or "
                     "joints free to dilate would lock them; nothing stands above the limit")  # fmt: skip
    if first.fos and first.static_bound and first.static_bound > _FAR_ABOVE * first.fos:
        more = (first.static_bound / first.fos - 1.0) * 100.0
        yield Notice("W341", f"with joints free to dilate the blocks would stand {more:.0f} % more: methods that take "
                     "normality (limit analysis by linear or cone programs) are unsafe by as much")  # fmt: skip
    if (limit.bond == 0.0).any():
        share = float(1.0 - limit.bond.mean())
        before = f"; with all of it the first motion begins at {limit.bonded:.4f}" if limit.bonded else ""
        yield Notice("W307", "contacts that the mechanism opens, or that motions on the way to it opened twice, have "
                     f"lost their cohesion ({share * 100:.2g} % of the node pairs): the factor of safety jumps where "
                     f"that happens{before}")  # fmt: skip
    if isinstance(design, BenchDesign):
        patches, fixed = scene.assembly.patches, np.append(scene.assembly.fixed, True)
        moves = np.zeros(len(fixed), dtype=bool)
        moves[ravelling.failures[0].blocks] = True
        if ((moves[patches.plus] & fixed[patches.minus]) | (moves[patches.minus] & fixed[patches.plus])).any():
            yield Notice("W338", "the first mechanism touches blocks that are bedrock only because the model ends "
                         "there: see whether a longer or deeper bench changes the factor")  # fmt: skip
    if isinstance(design, ToppleDesign) and closed.why_not:
        yield Notice("W340", closed.why_not)


def _without_rest(limit: BlocksLimit) -> Notice:
    """Why blocks that forces could balance have no factor, with what was tried."""
    most = f"{STRONGER[-1]:g} times the strength of the static bound"
    if limit.loads_last and limit.carried is not None and limit.carried < 1.0:
        tried = f"up to {most}" if limit.static_bound else "at any strength that was tried"
        return Notice("W362", f"at full strength the blocks fail at {limit.carried:.4g} of the loads beside weight and "
                      f"water, and {tried} they did not carry all of them: no factor of safety is given")  # fmt: skip
    exist = (
        ""
        if limit.static_bound is None
        else "; the static bound says that forces in balance exist, not that they arise"
    )
    return Notice("W363", "on elastic joints the blocks came to rest at none of the strengths that were tried: no "
                  f"factor of safety is given{exist}")  # fmt: skip
