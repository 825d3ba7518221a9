"""Assemblies of blocks: benches cut by joint sets, the user's own blocks, rows of columns.

scene -> loads -> the mechanisms one after the other -> what they say of each block -> Result.
"""

import math
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from slopekit.block_scene import Contacts, Sizes
from slopekit.core.arrays import frozen
from slopekit.core.errors import Notice
from slopekit.core.onlooker import Clock
from slopekit.core.sheet import Section, counted
from slopekit.design.reading.reader import Reader
from slopekit.evidence import (
    Comparisons,
    Displacements,
    FactorsOfSafety,
    Forces,
    LimitState,
    ModelSize,
)
from slopekit.findings import AssemblyGeometry, Findings, Mechanism
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign
from slopekit.kinds.assemblies.many_blocks_notices import (
    debonding_notices,
    notices_of,
)
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene, least_counted_weight, scene_loads
from slopekit.kinds.assemblies.many_blocks_states import (
    assembly_arrows,
    assembly_pair_state,
    at_full_strength,
    mechanism,
    mechanisms_of,
)
from slopekit.kinds.protocol import (
    ClosedForm,
    Factors,
    Gain,
    Kind,
    compare,
)
from slopekit.kinds.single_block.secants import left_out_of_laws, secant_strength
from slopekit.kinds.solver_inputs import joint_stiffness, joint_strength
from slopekit.kinds.words import (
    extents_in_words,
    loads_part,
    mass_in_words,
    short,
    shortened,
    strength_in_words,
    unit_weight_in_words,
    weight_in_words,
)
from slopekit.loads import AssemblyLoads
from slopekit.notices import those_of_factors
from slopekit.preie.many_blocks.debonding import debonding_limit
from slopekit.preie.many_blocks.ravelling import (
    Failure,
    Part,
    Ravelling,
    critical_load,
    ravel,
)
from slopekit.preie.motion.all_pairs import AllPairsFailed, all_pairs_failed
from slopekit.preie.motion.balance import Balance, balance, of_blocks
from slopekit.preie.outcome import Outcome
from slopekit.preie.solvers import work_limit
from slopekit.preie.solvers.threads import one_thread
from slopekit.preie.system.components import whole_model
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.tolerances import LIMIT_SETTLED
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.single_block.ladders import Ladder

A = TypeVar("A", bound=AssemblyDesign)
MOST_FOLLOWED = 24  # cohesive blocks whose history is followed unasked: it takes as long as the limit
_HISTORY = 100.0  # seconds of work that a history may take: of 501 blocks some 60
_DEBONDING = 0.02  # of a limit: a history that ends lower by more than this is its lowest factor (METHOD-4, 16)
_BRACKET = 1e-4  # of the paper's criterion, in parts of its factor
_SAME_K = 1e-2  # of a yield coefficient: the path in the load ends so near to it that its motion is that one
_ENDS = {
    "count": "",
    "stands": "what is left stands without any strength",
    "gone": "nothing is left that could move",
    "not_converged": "the last one did not settle, so what comes after it is not known",
}


@dataclass(frozen=True)
class SolvedAssembly:
    """A result with what it was read from; the scene is without the chips."""

    result: Result
    scene: AssemblyScene
    ravelling: Ravelling


@dataclass(frozen=True)
class Blocks(Generic[A]):
    """What a kind of many blocks adds to what they share.

    Attributes
    ----------
    cut : the blocks with their contacts and loads
    closed_form : and its table of columns, for the first mechanism
    notices : what a reader must know of the first mechanism
    closed_gain : (without an earthquake, k_y) the gain of the closed form's mechanism on shaken ground
    """

    words: Words
    cut: Callable[[A], AssemblyScene]
    closed_form: Callable[[A, Mechanism | None], tuple[ClosedForm, tuple[Mapping[str, Any], ...]]]
    notices: Callable[[A, AssemblyScene, Failure, ClosedForm], Iterable[Notice]]
    closed_gain: Callable[[A, float], Gain | None] | None = None


def no_closed_form(_: object, __: Mechanism | None) -> tuple[ClosedForm, tuple[Mapping[str, Any], ...]]:
    """Blocks of any shape have none."""
    return ClosedForm(None, "", "there is no closed form for these blocks"), ()


def no_notices(*_: object) -> tuple[Notice, ...]:
    """Nothing but what is said of all kinds."""
    return ()


def kind_of_many_blocks(
    record: type[A], read: Callable[[Reader], A], own: Blocks[A], slope: Callable[[A, Result], Section],
    pressures: Callable[[A], Sequence[tuple[str, float]]], *, with_areas: Callable[[A], Container[str]] = lambda _: (),
    figures: Mapping[str, Callable[[A, Any], float]] | None = None,
) -> Kind[A]:  # fmt: skip
    """A kind of many blocks.

    Parameters
    ----------
    slope : what the blocks are made from, with the label of that; `with_areas`: the joints whose areas it has
    pressures : mean water pressures (kPa) by what they act on
    """

    def factors(design: A) -> Factors:
        scene = own.cut(design)
        ravelling = _ravelled(design, scene, scene_loads(scene), 1, ranged=False)
        mechanisms = tuple(mechanism(failure, scene) for failure in ravelling.failures)
        status = mechanisms[0].status if mechanisms else "no_driving_force"
        factor = mechanisms[0].fos if mechanisms else None
        closed, _ = own.closed_form(design, mechanisms[0] if mechanisms else None)
        difference, agree = compare(factor, status, closed, design.analysis.agree_within)
        if mechanisms and mechanisms[0].change > LIMIT_SETTLED:  # compared as in a result all the same
            status, factor = "not_converged", None
        of_kind = own.notices(design, scene, ravelling.failures[0], closed) if mechanisms else ()
        notes = those_of_factors((*notices_of(design, scene, ravelling, mechanisms), *of_kind))
        return Factors(status, factor, None, closed.factor, difference, agree, False, notes=notes)

    def beside(design: A) -> tuple[Notice, ...]:
        if not any(strength.cohesion_kpa for _, strength in design.strengths):
            return ()
        scene = own.cut(design)
        ravelling = _ravelled(design, scene, scene_loads(scene), 1, ranged=False)
        limit = ravelling.failures[0].limit.factor if ravelling.failures else None
        return () if limit is None else debonding(ravelling.failures[0].parts[0], MOST_FOLLOWED, limit)[1]

    def ladder(design: A) -> "Ladder":
        from slopekit.kinds.assemblies.many_blocks_ladder import ladder_of_blocks  # only `check` asks

        return ladder_of_blocks(design, solved(own, design))

    def parts(design: A, result: Result) -> tuple[Section, ...]:
        geometry = result.geometry
        assert isinstance(geometry, AssemblyGeometry)
        wet, in_section = [*_water(pressures(design)), *design.ground_in_words()], geometry.thickness_m is not None
        return (
            slope(design, result),
            _size(result, with_areas(design)),
            loads_part(wet, result, in_section),
        )

    return Kind(
        record, read, own.words, lambda design: solved(own, design).result, factors,
        ladder, lambda design: [strength for _, strength in design.strengths], parts,
        own.cut, beside=beside, at_load=lambda *asked: _at_load(own, *asked),
        seismic_gain=lambda *asked: _seismic_gain(own, *asked), figures=figures or {},
    )  # fmt: skip


def _at_load(own: Blocks[A], without: A, unit: A, target: float) -> float | None:
    """The multiplier of what one design has more of loads than another at which its factor is a target.

    None where the blocks do not stand without it, or stand with any of it.
    """
    _, _, critical = _critical(own, without, unit, target)
    return None if critical is None else critical[0]


def _critical(
    own: Blocks[A], without: A, unit: A, target: float
) -> tuple[AssemblyScene, AssemblyLoads, tuple[float, Failure] | None]:
    """The blocks of a design with their loads, and the critical multiplier of what another has more of them."""
    scene = own.cut(without)
    first, second = scene_loads(scene), scene_loads(own.cut(unit))
    ramp = (second.forces - first.forces, second.moments - first.moments)
    if not ramp[0].any() and not ramp[1].any():
        return scene, first, None
    lightest = least_counted_weight(without, scene, first)
    critical = critical_load(scene.assembly, first, ramp, joint_strength(scene.strengths), 1.0 / target, lightest)
    return scene, first, critical


def _seismic_gain(own: Blocks[A], without: A, unit: A, k: float, by_closed_form: bool) -> Gain | None:
    """How fast the blocks gain on the ground above k_y; None where their motion is none that settled."""
    if by_closed_form:
        return None if own.closed_gain is None else own.closed_gain(without, k)
    from slopekit.kinds.assemblies.many_blocks_shaking import gyration  # only earthquakes ask
    from slopekit.preie.motion.seismic_gain import seismic_gain

    scene, loads, critical = _critical(own, without, unit, 1.0)
    if critical is None or abs(critical[0] / k - 1.0) > _SAME_K:
        return None
    multiplier, failure = critical
    with one_thread():
        gain = seismic_gain(failure.parts[0], multiplier, loads.weights, gyration(scene))
    if gain is None:
        return None
    return Gain(gain.factor, scene.names[gain.block], gain.multiplier if gain.alone else None, gain.first)


def solved(own: Blocks[A], design: A) -> SolvedAssembly:
    """The result of a design with its blocks, loads and mechanisms.

    Raises
    ------
    GeometryError, DesignError
        Where no blocks can be formed, or loads act on none.
    """
    clock = Clock()
    with clock("cut"):
        scene = own.cut(design)
    assembly = scene.assembly
    with clock("loads"):
        loads = scene_loads(scene)
    with clock("solve"), work_limit.allowed(math.inf):
        ravelling = _ravelled(design, scene, loads, design.mechanisms)
    standing = scene.without(ravelling.gone())
    with clock("mechanisms"):
        rows = tuple(mechanisms_of(ravelling, scene, design.rock.gravity_m_s2))
        mechanisms = tuple(row for row in rows if row.role != "chip")
    with clock("all_pairs"):
        all_pairs = None
        if design.analysis.criterion == "all-pairs" and mechanisms and mechanisms[0].fos:
            all_pairs = search_of_all_pairs(design, standing, mechanisms[0].fos)
    status = mechanisms[0].status if mechanisms else "no_driving_force"
    sure = bool(mechanisms) and mechanisms[0].status != "not_converged"
    limit = mechanisms[0].fos if sure else None
    bound = ravelling.static_bound if mechanisms else None
    governing = ravelling.failures[0].limit if ravelling.failures else None
    low, high = (governing.lowest, governing.highest) if governing is not None and sure else (None, None)
    lower: tuple[Notice, ...] = ()
    with clock("history"):
        if limit is not None:
            stable, lower = debonding(ravelling.failures[0].parts[0], MOST_FOLLOWED, limit)
            low = low if stable is None else min(stable, low or stable)
    with clock("displacements"):
        stands = status == "no_driving_force" or (limit is not None and limit > 1.0)
        at_one = scene.without(ravelling.gone(1.0))
        settled = at_full_strength(design, at_one, scene_loads(at_one)) if stands else None
    with clock("closed_form"):
        closed, table = own.closed_form(design, mechanisms[0] if mechanisms else None)
    difference, agree = compare(limit, status, closed, design.analysis.agree_within)
    findings = Findings(
        rows, _standing(ravelling, scene), len(assembly), int(assembly.fixed.sum()), len(assembly.patches),
        len(ravelling.parts), _checks(scene, ravelling), table, SHEAR_TO_NORMAL,
    )  # fmt: skip
    parts = ravelling.parts
    first = ravelling.failures[0].parts if ravelling.failures else ()
    split = [0 if part.refined is None else int(part.refined.max()) for part in first]
    size = ModelSize(
        int((~assembly.fixed).sum()), sum(part.model.load.size for part in parts),
        sum(part.model.joint_pairs.stop for part in parts), max(split, default=0),
        max((part.mesh_change for part in first if part.mesh_change is not None), default=None),
        _left_out(design, scene, parts, drained=design.mechanisms > 1 or bool(ravelling.chips)),
        max((part.limit.steps for part in first), default=0), mechanisms[0].change if mechanisms else 0.0,
    )  # fmt: skip
    of_kind = own.notices(design, scene, ravelling.failures[0], closed) if mechanisms else ()
    result = Result(
        design=design, words=own.words, status=status,
        fos=FactorsOfSafety(limit, closed.factor, bound, all_pairs.factor if all_pairs else None, low, high),
        difference=difference, agree=agree, moments_govern=False,
        geometry=_geometry(scene), forces=_forces(standing, scene_loads(standing), parts), model=size,
        warnings=(*notices_of(design, scene, ravelling, mechanisms), *lower, *of_kind),
        limit_state=LimitState(
            assembly_pair_state(scene, parts), assembly_arrows(scene, loads, parts), balance=balance_of(parts),
            curved_strength=_curved(scene, parts),
        ),
        displacements=Displacements(settled, all_pairs), comparisons=Comparisons(), findings=findings,
        timing_s=clock.done(),
    )  # fmt: skip
    return SolvedAssembly(result, standing, ravelling)


def _ravelled(
    design: AssemblyDesign, scene: AssemblyScene, loads: AssemblyLoads, count: int, ranged: bool = True
) -> Ravelling:
    """The first mechanisms of a scene that are no chips."""
    lightest = least_counted_weight(design, scene, loads)
    return ravel(scene.assembly, loads, joint_strength(scene.strengths), count, ranged, lightest)


def debonding(part: Part, most: int, limit: float) -> tuple[float | None, tuple[Notice, ...]]:
    """Return the lowest factor of a part with progressive slip and debonding, and the notice of it (W504).

    None and no notice where it is no more than 2 % below the limit, or was not looked for.

    Parameters
    ----------
    most : of blocks for which it is looked for
    """
    stable, fails = _debonding_factors(part, most) or (None, None)
    if stable is None or fails is None or fails >= limit * (1.0 - _DEBONDING):
        return None, ()
    return stable, tuple(debonding_notices(stable, fails, limit))


def _debonding_factors(part: Part, most: int) -> tuple[float, float | None] | None:
    """Return the last stable and the first unstable factor of all blocks whose slip and lost cohesion stay.

    Only cohesion needs such a history, without dilation and curved laws: else None.
    """
    model, limit = part.model, part.limit
    left_out = model.lines is not None or bool(model.tan_dilation.any())
    if left_out or not model.has_cohesion or not limit.factor or len(model.load) > most:
        return None
    try:
        with one_thread(), work_limit.allowed(_HISTORY * work_limit.SECOND):
            return debonding_limit(model, limit.factor)
    except work_limit.WorkSpentError:
        return None


def search_of_all_pairs(design: AssemblyDesign, scene: AssemblyScene, limit: float) -> AllPairsFailed | None:
    """The paper's criterion for many blocks: the factor at which a block first has no chain of sticking pairs."""
    model = whole_model(scene.assembly, scene_loads(scene), joint_strength(scene.strengths))
    return None if model is None else all_pairs_failed(model, joint_stiffness(design), limit, relative=_BRACKET)


def _standing(ravelling: Ravelling, scene: AssemblyScene) -> str:
    left = int(ravelling.left.sum())
    moving = int((~scene.assembly.fixed).sum())
    if left == 0:
        return f"none of {moving} blocks is left"
    return "; ".join(filter(None, (f"{left} of {moving} blocks are left", _ENDS[ravelling.ended])))


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


def balance_of(parts: Sequence[Part], at_rest: bool = False) -> Balance | None:
    """How well the forces of the parts that have a factor balance the loads.

    Where the limit is that of a group of blocks, the forces are those of all blocks at their last rest, just before it:
    `at_rest` holds them against the strength there.
    """
    return balance([
        of_blocks(
            part.model, part.limit.factor * (1.0 - part.limit.width * at_rest), part.limit.normal_force,
            part.limit.friction, part.limit.bond,
        )
        for part in parts
        if part.limit.factor and part.limit.outcome is Outcome.SLIDES and len(part.model.control_area)
    ])  # fmt: skip


def _left_out(
    design: AssemblyDesign, scene: AssemblyScene, parts: Sequence[Part], drained: bool = False
) -> tuple[str, ...]:
    """What was not modelled, with the proof or the check that lets it be."""
    said = ["bedrock and fixed blocks (they do not move), contacts between them, free faces", *scene.left_out]
    if len(parts) > 1:
        said.append(f"{len(parts)} groups of blocks touch only through bedrock: each is solved for itself (exact)")
    for part in parts:
        if part.limit.group:
            said.append(
                f"the limit is that of a group of {part.limit.group} of {len(part.blocks)} blocks that touch, the "
                f"others fixed; check with none fixed: all rest at {1.0 - part.limit.width:.4f} of it, where 95 % of "
                "the strength along the motion is used up, or fail 1 % above it"
            )
    if scene.assembly.in_section:
        ends = "three node pairs a contact (Simpson's rule), its friction one force: a flat contact slips as one"
        said += ["everything repeats along the strike: 3 unknowns a block instead of 6 (exact)", ends]
    said += left_out_of_laws(scene.strengths)
    if drained and scene.pressures.any():
        said.append("water in joints that a block has left: they stand open")
    return tuple(said)


def _geometry(scene: AssemblyScene) -> AssemblyGeometry:
    assembly = scene.assembly
    patches = assembly.patches
    areas = np.bincount(patches.joint, patches.areas, len(scene.joints))
    offset = scene.origin[[0, 2]]
    return AssemblyGeometry(
        float(assembly.volumes[~assembly.fixed].sum()), scene.height_m,
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
    water = dict(zip(scene.joints, np.bincount(patches.joint, loads.water, count).tolist(), strict=True))
    if scene.acting.pond:
        water["free faces"] = sum(float(np.linalg.norm(push.force)) for _, push in scene.acting.pond)
    return Forces(
        float(loads.weights[~scene.assembly.fixed].sum()),
        {name: float(value) if known else None for name, value in zip(scene.joints, normal, strict=True)},
        water, None, None,
    )  # fmt: skip


def _curved(scene: AssemblyScene, parts: Sequence[Part]) -> dict[str, Mapping[str, Any]]:
    """The line of each curved joint at the mean normal traction of its node pairs that carry any."""
    solved = [part for part in parts if part.model.lines is not None and part.limit.factor]
    if not solved:
        return {}
    kinds = [part.model.lines.joint[part.model.joint_pairs] for part in solved if part.model.lines is not None]
    joint = np.concatenate(kinds)
    areas = [part.model.control_area[part.model.joint_pairs] * part.model.area_scale for part in solved]
    area = np.concatenate(areas)
    normals = [part.limit.normal_force[part.model.joint_pairs] * part.model.force_scale for part in solved]
    normal = np.concatenate(normals)
    lines = dict[str, Mapping[str, Any]]()
    for key, (name, strength) in enumerate(zip(scene.joints, scene.strengths, strict=True)):
        on = (joint == key) & (normal > 0.0)
        if on.any() and strength.law is not None:
            tractions, mean = normal[on] / area[on], float(normal[on].sum() / area[on].sum())
            line = secant_strength(strength, mean)
            lines[name] = {
                "traction_kpa": mean, "range_kpa": (float(tractions.min()), float(tractions.max())),
                "cohesion_kpa": line.cohesion_kpa, "friction_angle_deg": line.friction_angle_deg,
            }  # fmt: skip
    return lines


# -- what check looks at ----------------------------------------------------------------------------------------------


# -- words ------------------------------------------------------------------------------------------------------------


def _size(result: Result, with_areas: Container[str]) -> Section:
    """Blocks, height, volume and weight, and the areas of the joints that it does not have yet."""
    geometry, findings = result.geometry, result.findings
    assert findings is not None
    moving = findings.blocks - findings.fixed
    bedrock = f" and {findings.fixed} of bedrock" if findings.fixed else ""
    groups = f", in {findings.components} groups that touch only through bedrock" if findings.components > 1 else ""
    areas = [f"{name} {short(area)} m²" for name, area in geometry.areas_m2.items() if name not in with_areas]
    listed = ", ".join(shortened(areas, 6))
    height, volume = short(geometry.total_height_m), short(geometry.volume_m3)
    return Section("SIZE", [
        f"{counted(moving, 'block')} that can move{bedrock}, {counted(findings.contacts, 'contact')}{groups}",
        f"height {height} m  volume {volume} m³  {weight_in_words(result)}",
        *_fails_first(result.size),
        *([f"contact area  {listed}"] if listed else []),
    ], details=unit_weight_in_words(result))  # fmt: skip


def _fails_first(size: Sizes | None) -> list[str]:
    """The size of the first mechanism."""
    if size is None:
        return []
    of_all = f"height {short(size.height_m)} m  volume {short(size.volume_m3)} m³"
    return [
        "  ".join([f"critical block or group: {of_all}", f"mass {mass_in_words(size.mass_t)}", *extents_in_words(size)])
    ]


def _water(pressures: Sequence[tuple[str, float]]) -> list[str]:
    """Mean water pressures by what they act on."""
    wet = [f"u = {pressure:g} kPa on {name}" for name, pressure in pressures if pressure]
    return ["water " + ", ".join(shortened(wet, 6))] if wet else []


def named_strength(design: AssemblyDesign, name: str) -> str:
    """A strength with its name, where there are several to tell apart."""
    words = strength_in_words(design.strength(name), ".6g")
    return words if len(design.strengths) == 1 else f"{name}: {words}"
