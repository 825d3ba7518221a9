"""Assemblies of blocks: benches cut by joint sets, the user's own blocks, rows of columns.

scene -> loads -> the mechanisms one after the other -> what they say of each block -> Result.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from slopekit.block_scene import Contacts
from slopekit.core.arrays import NDArray, frozen
from slopekit.core.errors import Notice
from slopekit.core.onlooker import Clock
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
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene, least_counted_weight, scene_loads
from slopekit.kinds.assemblies.many_blocks_states import (
    assembly_arrows,
    assembly_pair_state,
    at_full_strength,
    gyration,
    mechanisms_of,
)
from slopekit.kinds.protocol import (
    ClosedForm,
    Factors,
    Gain,
    Kind,
    compare,
)
from slopekit.kinds.single_block.secants import left_out_of_laws, secant_at
from slopekit.kinds.solver_inputs import joint_stiffness, joint_strength
from slopekit.kinds.words import (
    short,
    shortened,
    strength_in_words,
)
from slopekit.loads import AssemblyLoads
from slopekit.notices import (
    SQUARE,
    LostCohesion,
    bolt_notices,
    common_notices,
    lost_cohesion_notices,
    mesh_notices,
    those_of_factors,
    undrawn_notice,
)
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.debonding import debonding_limit
from slopekit.preie.many_blocks.ravelling import (
    Failure,
    Part,
    Ravelling,
    critical_load,
    ravel,
)
from slopekit.preie.motion.all_pairs import all_pairs_failed
from slopekit.preie.motion.balance import Balance, balance, of_blocks
from slopekit.preie.outcome import Outcome
from slopekit.preie.solvers import work_limit
from slopekit.preie.solvers.threads import one_thread
from slopekit.preie.system.components import whole_model
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.tolerances import LIMIT_SETTLED, SAME_LIMIT, TINY
from slopekit.result import Result

if TYPE_CHECKING:
    from slopekit.kinds.single_block.ladders import Ladder

A = TypeVar("A", bound=AssemblyDesign)
MOST_FOLLOWED = 24  # cohesive blocks whose history is followed unasked: it takes as long as the limit
_HISTORY = 100.0  # seconds of work that a history may take: of 501 blocks some 60
_DEBONDING = 0.02  # of a limit: a history that ends lower by more than this is its lowest factor (docs/method.md)
_BRACKET = 1e-4  # of the paper's criterion, in parts of its factor
_SAME_K = 1e-2  # of a yield coefficient: the path in the load ends so near to it that its motion is that one
_MODES = {
    "slides": "slide", "topples": "topple", "rotates": "turn", "falls": "fall", "lifts": "lift", None: "stable",
}  # fmt: skip
_ENDS = {
    "count": "",
    "stands": "what is left stands without any strength",
    "gone": "nothing is left that could move",
    "not_converged": "the last one did not settle, so what comes after it is not known",
}


@dataclass(frozen=True)
class SolvedAssembly:
    """A result with what it was read from."""

    result: Result
    scene: AssemblyScene
    ravelling: Ravelling

    @property
    def standing(self) -> AssemblyScene:
        """The scene without the chips."""
        return self.scene.without(self.ravelling.gone())

    def with_all_pairs(self) -> "SolvedAssembly":
        """Return the result with the paper's criterion: where a block first has no chain of sticking pairs."""
        scene, limit = self.standing, self.result.fos.limit
        model = whole_model(scene.assembly, scene_loads(scene), joint_strength(scene.strengths)) if limit else None
        if model is None or not limit:
            return self
        search = all_pairs_failed(model, joint_stiffness(self.result.design), limit, relative=_BRACKET)
        fos = replace(self.result.fos, all_pairs_failed=search.factor)
        displacements = replace(self.result.displacements, all_pairs=search)
        return replace(self, result=replace(self.result, fos=fos, displacements=displacements))

    def with_history(self, most: int) -> "SolvedAssembly":
        """Return the result with what progressive slip and debonding make of so many blocks or fewer (W504).

        Nothing where they take no more than 2 % off the limit.
        """
        fos, limit = self.result.fos, self.result.fos.limit
        factors = None if limit is None else _debonding_factors(self.ravelling.failures[0].parts[0], most)
        stable, fails = factors or (None, None)
        if limit is None or stable is None or fails is None or fails >= limit * (1.0 - _DEBONDING):
            return self
        fos = replace(fos, lowest=min(stable, fos.lowest or stable))
        warnings = (*self.result.warnings, debonding_notice(stable, fails, limit))
        return replace(self, result=replace(self.result, fos=fos, warnings=warnings))


class ManyBlocks(Kind[A]):
    """A kind of many blocks; `cut` gives an `AssemblyScene`."""

    MOVES_MANY = True

    def analyse(self, design: A) -> Result:
        return self.solved(design).result

    def factors(self, design: A) -> Factors:
        result = self._found(design, Clock(), 1, ranged=False).result
        status, fos = result.status, result.fos
        if result.model.residual > LIMIT_SETTLED:  # compared as in a result all the same
            status, fos = "not_converged", replace(fos, limit=None)
        notes = those_of_factors(result.warnings)
        return Factors(status, fos.limit, None, fos.closed_form, result.difference, result.agree, False, notes=notes)

    def reference_notices(self, design: A) -> tuple[Notice, ...]:
        if not any(strength.cohesion_kpa for strength in design.joint_strengths):
            return ()
        solution = self._found(design, Clock(), 1, ranged=False)
        return solution.with_history(MOST_FOLLOWED).result.warnings[len(solution.result.warnings) :]

    def ladder(self, design: A) -> "Ladder":
        from slopekit.kinds.assemblies.many_blocks_ladder import ladder_of_blocks  # only `check` asks

        return ladder_of_blocks(self.solved(design))

    def at_load(self, without: A, unit: A, target: float) -> float | None:
        _, _, critical = self._critical(without, unit, target)
        return None if critical is None else critical[0]

    def _critical(
        self, without: A, unit: A, target: float
    ) -> tuple[AssemblyScene, AssemblyLoads, tuple[float, Failure] | None]:
        """The blocks of a design with their loads, and the critical multiplier of what another has more of them."""
        scene = self.cut(without)
        first, second = scene_loads(scene), scene_loads(self.cut(unit))
        ramp = (second.forces - first.forces, second.moments - first.moments)
        if not ramp[0].any() and not ramp[1].any():
            return scene, first, None
        lightest = least_counted_weight(without, scene, first)
        critical = critical_load(scene.assembly, first, ramp, joint_strength(scene.strengths), 1.0 / target, lightest)
        return scene, first, critical

    def seismic_gain(self, without: A, unit: A, k: float, by_closed_form: bool) -> Gain | None:
        if by_closed_form:
            return self.closed_form(without, None).seismic_gain(k)
        from slopekit.preie.motion.seismic_gain import seismic_gain  # only earthquakes ask

        scene, loads, critical = self._critical(without, unit, 1.0)
        if critical is None or abs(critical[0] / k - 1.0) > _SAME_K:
            return None
        multiplier, failure = critical
        with one_thread():
            gain = seismic_gain(failure.parts[0], multiplier, loads.weights, gyration(scene))
        if gain is None:
            return None
        return Gain(gain.factor, scene.names[gain.block], gain.first)

    def solved(self, design: A) -> SolvedAssembly:
        """The result of a design with its blocks, loads and mechanisms.

        Raises
        ------
        GeometryError, DesignError
            Where no blocks can be formed, or loads act on none.
        """
        clock = Clock()
        with work_limit.allowed(math.inf):
            solution = self._found(design, clock, design.mechanisms, ranged=True)
        with clock("all_pairs"):
            if design.analysis.criterion == "all-pairs":
                solution = solution.with_all_pairs()
        with clock("history"):
            solution = solution.with_history(MOST_FOLLOWED)
        with clock("displacements"):
            result, limit = solution.result, solution.result.fos.limit
            at_one = solution.scene.without(solution.ravelling.gone(1.0))
            stands = result.status == "no_driving_force" or (limit is not None and limit > 1.0)
            settled = at_full_strength(design, at_one, scene_loads(at_one)) if stands else None
        displacements = replace(result.displacements, at_factor_one=settled)
        return replace(solution, result=replace(result, displacements=displacements, timing_s=clock.done()))

    def _found(self, design: A, clock: Clock, count: int, ranged: bool) -> SolvedAssembly:
        """Return the result of so many mechanisms, and how it was found."""
        with clock("cut"):
            scene: AssemblyScene = self.cut(design)
        assembly = scene.assembly
        with clock("loads"):
            loads = scene_loads(scene)
        with clock("solve"):
            lightest, strength = least_counted_weight(design, scene, loads), joint_strength(scene.strengths)
            ravelling = ravel(assembly, loads, strength, count, ranged, lightest)
        with clock("mechanisms"):
            rows = tuple(mechanisms_of(ravelling, scene, design.rock.gravity_m_s2))
            mechanisms = tuple(row for row in rows if row.role != "chip")
        status, fos = "no_driving_force", FactorsOfSafety()
        if mechanisms:
            status, governing = mechanisms[0].status, ravelling.failures[0].limit
            fos = FactorsOfSafety(static_bound=ravelling.static_bound)
            if status != "not_converged":
                fos = replace(fos, limit=mechanisms[0].fos, lowest=governing.lowest, highest=governing.highest)
        with clock("closed_form"):
            closed = self.closed_form(design, scene)
        difference, agree = compare(fos.limit, status, closed, design.analysis.agree_within)
        findings = Findings(
            rows, _standing(ravelling, scene), len(assembly), int(assembly.fixed.sum()), len(assembly.patches),
            len(ravelling.parts), _checks(scene, ravelling), _table(closed, scene, mechanisms), SHEAR_TO_NORMAL,
        )  # fmt: skip
        components = ravelling.parts
        first = ravelling.failures[0].parts if ravelling.failures else ()
        split = [0 if component.refined is None else int(component.refined.max()) for component in first]
        size = ModelSize(
            int((~assembly.fixed).sum()), sum(component.model.load.size for component in components),
            sum(component.model.joint_pairs.stop for component in components), max(split, default=0),
            max((component.mesh_change for component in first if component.mesh_change is not None), default=None),
            _left_out(scene, components, drained=design.mechanisms > 1 or bool(ravelling.chips)),
            max((component.limit.steps for component in first), default=0), mechanisms[0].change if mechanisms else 0.0,
        )  # fmt: skip
        standing = scene.without(ravelling.gone())
        of_kind = self.notices(design, scene, ravelling.failures[0], closed) if mechanisms else ()
        result = Result(
            design=design, words=self.words, status=status, fos=replace(fos, closed_form=closed.factor),
            difference=difference, agree=agree, moments_govern=False,
            geometry=_geometry(scene), forces=_forces(standing, scene_loads(standing), components), model=size,
            warnings=(*notices_of(design, scene, ravelling, mechanisms), *of_kind),
            limit_state=LimitState(
                assembly_pair_state(scene, components), assembly_arrows(scene, loads, components),
                balance=force_balance(components), curved_strength=_curved(scene, components),
            ),
            displacements=Displacements(), comparisons=Comparisons(), findings=findings, timing_s=clock.done(),
        )  # fmt: skip
        return SolvedAssembly(result, scene, ravelling)


def no_closed_form(*_: object) -> ClosedForm:
    """Blocks of any shape have none."""
    return ClosedForm(None, "", "there is no closed form for these blocks")


def _table(closed: ClosedForm, scene: AssemblyScene, mechanisms: Sequence[Mechanism]) -> tuple[Mapping[str, Any], ...]:
    """The columns of the closed form, each with its mode in the first mechanism."""
    ways = dict(zip(mechanisms[0].blocks, mechanisms[0].how, strict=True)) if mechanisms else {}
    return tuple(dict(row) | {"mode_preie": _MODES[ways.get(scene.names[row["n"] - 1])]} for row in closed.table)


def _debonding_factors(component: Part, most: int) -> tuple[float, float | None] | None:
    """Return the last stable and the first unstable factor of all blocks whose slip and lost cohesion stay.

    Only cohesion needs such a history, without dilation and curved laws: else None.
    """
    model, limit = component.model, component.limit
    is_without_history = model.lines is not None or bool(model.tan_dilation.any())
    if is_without_history or not model.has_cohesion or not limit.factor or len(model.load) > most:
        return None
    try:
        with one_thread(), work_limit.allowed(_HISTORY * work_limit.SECOND):
            return debonding_limit(model, limit.factor)
    except work_limit.WorkSpentError:
        return None


def _standing(ravelling: Ravelling, scene: AssemblyScene) -> str:
    remaining = int(ravelling.left.sum())
    moving = int((~scene.assembly.fixed).sum())
    if remaining == 0:
        return f"none of {moving} blocks is left"
    return "; ".join(filter(None, (f"{remaining} of {moving} blocks are left", _ENDS[ravelling.ended])))


def _checks(scene: AssemblyScene, ravelling: Ravelling) -> dict[str, float]:
    """Conservation: what the geometry balanced, and how well the forces at the limit do."""
    checks = dict(scene.checks)
    worst = 0.0
    for component in ravelling.parts:
        model, limit = component.model, component.limit
        if limit.factor is None or len(model.control_area) == 0:
            continue
        unbalanced = model.forces_on_blocks(limit.normal_force, limit.friction) + model.load
        worst = max(worst, float(np.abs(unbalanced).max()) / float(np.abs(model.load).max()))
    checks["largest_unbalanced_force"] = worst
    return checks


def force_balance(components: Sequence[Part], at_rest: bool = False) -> Balance | None:
    """How well the forces of the parts that have a factor balance the loads.

    Where the limit is that of a group of blocks, the forces are those of all blocks at their last rest, just before it:
    `at_rest` holds them against the strength there.
    """
    return balance(
        [
            of_blocks(
                component.model,
                component.limit.factor * (1.0 - component.limit.width * at_rest),
                component.limit.normal_force,
                component.limit.friction,
                component.limit.bond,
            )
            for component in components
            if component.limit.factor
            and component.limit.outcome is Outcome.SLIDES
            and len(component.model.control_area)
        ]
    )


def _left_out(scene: AssemblyScene, components: Sequence[Part], drained: bool) -> tuple[str, ...]:
    """What was not modelled, with the proof or the check that lets it be."""
    assumptions = ["bedrock and fixed blocks (they do not move), contacts between them, free faces", *scene.left_out]
    if len(components) > 1:
        assumptions.append(
            f"{len(components)} groups of blocks touch only through bedrock: each is solved for itself (exact)"
        )
    for component in components:
        if component.limit.group:
            assumptions.append(
                f"the limit is that of a group of {component.limit.group} of {len(component.blocks)} blocks that "
                f"touch, the others fixed; check with none fixed: all rest at {1.0 - component.limit.width:.4f} of it, "
                "where 95 % of the strength along the motion is used up, or fail 1 % above it"
            )
    if scene.assembly.in_section:
        ends = "three node pairs a contact (Simpson's rule), its friction one force: a flat contact slips as one"
        assumptions += ["everything repeats along the strike: 3 unknowns a block instead of 6 (exact)", ends]
    assumptions += left_out_of_laws(scene.strengths)
    if drained and scene.pressures.any():
        assumptions.append("water in joints that a block has left: they stand open")
    return tuple(assumptions)


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


def _forces(scene: AssemblyScene, loads: AssemblyLoads, components: Sequence[Part]) -> Forces:
    """Weight of the moving blocks; normal forces at the limit and water by joint."""
    patches = scene.assembly.patches
    count = len(scene.joints)
    normal = np.zeros(count)
    is_known = True
    for component in components:
        if len(component.model.control_area) == 0:
            continue
        is_known = is_known and component.limit.factor is not None
        of_joints = component.model.joint_pairs
        joint = patches.joint[component.patch][component.model.pair_contact[of_joints]]
        normal += np.bincount(joint, component.limit.normal_force[of_joints] * component.model.force_scale, count)
    water = dict(zip(scene.joints, np.bincount(patches.joint, loads.water, count).tolist(), strict=True))
    open_water = [float(np.linalg.norm(load.push.force)) for load in scene.acting.pushes if not load.is_live]
    if open_water:
        water["free faces"] = sum(open_water)
    return Forces(
        float(loads.weights[~scene.assembly.fixed].sum()),
        {name: float(value) if is_known else None for name, value in zip(scene.joints, normal, strict=True)},
        water, None, None,
    )  # fmt: skip


def _curved(scene: AssemblyScene, components: Sequence[Part]) -> dict[str, Mapping[str, Any]]:
    """The line of each curved joint at the mean normal traction of its node pairs that carry any."""
    none: list[NDArray[Any]] = [np.zeros(0)]
    joint, area, normal = none.copy(), none.copy(), none.copy()
    for component in components:
        model, real = component.model, component.model.joint_pairs
        if model.lines is not None and component.limit.factor:
            joint.append(model.lines.joint[real])
            area.append(model.control_area[real] * model.area_scale)
            normal.append(component.limit.normal_force[real] * model.force_scale)
    joint_of_pair, area_m2, normal_kn = map(np.concatenate, (joint, area, normal))
    loaded = [(joint_of_pair == key) & (normal_kn > 0.0) for key in range(len(scene.joints))]
    return {
        name: secant_at(strength, normal_kn[pairs], area_m2[pairs])
        for name, strength, pairs in zip(scene.joints, scene.strengths, loaded, strict=True)
        if pairs.any() and strength.law is not None
    }


# -- words ------------------------------------------------------------------------------------------------------------


def contact_areas(areas_m2: Mapping[str, float]) -> list[str]:
    """The areas of joints in one line."""
    areas = [f"{name} {short(area)} m²" for name, area in areas_m2.items()]
    return [f"contact area  {', '.join(shortened(areas, 6))}"] if areas else []


def water_of_blocks(pressures: Sequence[tuple[str, float]]) -> list[str]:
    """Mean water pressures by what they act on."""
    wet = [f"u = {pressure:g} kPa on {name}" for name, pressure in pressures if pressure]
    return ["water " + ", ".join(shortened(wet, 6))] if wet else []


def named_strength(design: AssemblyDesign, name: str) -> str:
    """A strength with its name, where there are several to tell apart."""
    words = strength_in_words(design.strength(name), ".6g")
    return words if len(design.strengths) == 1 else f"{name}: {words}"


# -- what a reader must know of the limit and of how it was found -----------------------------------------------------


def notices_of(
    design: AssemblyDesign, scene: AssemblyScene, ravelling: Ravelling, mechanisms: Sequence[Mechanism]
) -> Iterator[Notice]:
    """What a reader must know of the design, of how its first mechanism was found, and of what it depends on."""
    yield from scene.notices
    yield from common_notices(design, scene.strengths)
    if not mechanisms:
        return
    first, limit = mechanisms[0], ravelling.failures[0].limit
    yield from bolt_notices(design)
    if (
        first.fos
        and scene.acting.bolt_names
        and not any(_drawn_out(component) for component in ravelling.failures[0].parts)
    ):
        yield undrawn_notice()
    if limit.outcome is Outcome.NO_STRENGTH:
        yield Notice("W308", "the joints have no strength: nothing holds the blocks, there is no factor of safety")
    yield from mesh_notices(
        max((component.mesh_change or 0.0 for component in ravelling.failures[0].parts), default=0.0)
    )
    if limit.basis is Basis.PEAK and first.fos:
        yield Notice("W317", "the motion did not settle into a limit state: the factor is that of the last stable "
                     "state of the elastic path; the limit may lie lower (up to 4 % in random sections)")  # fmt: skip
    if first.fos and limit.change > LIMIT_SETTLED and any(strength.law for strength in scene.strengths):
        yield Notice("W317", "strength at the tractions of one limit state leads to another, and back: the lowest "
                     f"factor is printed, others lie up to {limit.change * 100:.2g} % above it")  # fmt: skip
    if limit.rounding and first.fos:
        where = "at" if limit.basis is Basis.PEAK else "just before"
        yield Notice("W317", f"all blocks rest {where} the factor but for a rounding of the law of their joints: "
                     "forces balance within strength, and what joints give, open and slip fits them but for "
                     f"{limit.rounding * 100.0:.1g} % of the elastic energy")  # fmt: skip
    if limit.outcome is Outcome.NO_REST:
        yield _without_rest(limit, design.seismic.coefficient)
    if limit.spent:
        yield _unsettled(limit)
    elif limit.outcome is Outcome.NOT_CONVERGED:
        above = "" if limit.static_bound is None else f"; the upper bound is {limit.static_bound:.4g}"
        yield Notice("W308", "the search for the limit of these blocks gave up: the motion that was followed led to no "
                     f"state whose forces balance within strength{above}")  # fmt: skip
    yield from lost_cohesion_notices(lost_cohesion(ravelling.failures[0]), "factor of safety")


def debonding_notice(stable: float, fails: float, limit: float) -> Notice:
    """W504: with progressive slip and debonding the blocks fail at less than the limit."""
    below = (1.0 - fails / limit) * 100.0
    return Notice("W504", f"with progressive slip and debonding the blocks are stable at {stable:.4f} and fail at "
                  f"{fails:.4f}, {below:.2g} % below the factor of safety: rely on the lower")  # fmt: skip


def lost_cohesion(failure: Failure) -> LostCohesion:
    """Return the part of the cohesion that does not act at a limit, and the numbers of such contacts and of all."""
    limit, model = failure.limit, failure.parts[0].model
    joints = model.joint_pairs
    full, contact = model.cohesion[joints], model.pair_contact[joints]
    acts = full * limit.bond[joints]
    open_somewhere = acts < full * (1.0 - SAME_LIMIT)
    lost = 1.0 - float(acts.sum()) / max(float(full.sum()), TINY) if full.any() else 0.0
    return lost, len(np.unique(contact[open_somewhere])), len(np.unique(contact[full > 0.0]))


def _unsettled(limit: BlocksLimit) -> Notice:
    """What is known of blocks whose limit takes more work than an analysis does."""
    rests = "no rest of all blocks that would say anything was seen"
    if limit.rested is not None:
        rests = (
            f"all blocks were last at rest with their strength divided by {limit.rested:.4g} (limits of random "
            "sections lay up to 4 % below such a rest)"
        )
    above = ", and no upper bound was found"
    if limit.static_bound is not None:
        above = f", and no forces balance the loads beyond {limit.static_bound:.4g}, the upper bound"
    return Notice("W360", "the limit of these blocks was not settled within the effort of one analysis (work is "
                  f"counted, not timed: every machine ends here): {rests}{above}")  # fmt: skip


def _without_rest(limit: BlocksLimit, seismic: float) -> Notice:
    """Why blocks that forces could balance have no factor, with what was tried; `seismic`: the coefficient, or 0."""

    def earthquake(share: float) -> str:
        return f" (k {share * seismic:.4g})" if seismic else ""

    if limit.tips is not None:
        share, factor = limit.tips
        topple = f"with their strength divided by {factor:.4g} or less the blocks topple at {share:.4g} of the loads"
        return Notice("W362", f"{topple} beside weight and water{earthquake(share)} without slipping anywhere: a wider "
                      "base or bolts would hold them; no factor of safety is given")  # fmt: skip
    exist = (
        "" if limit.static_bound is None else "; the upper bound says that forces in balance exist, not that they arise"
    )
    tip = " (mostly such blocks tip: a wider base or bolts hold them, more strength does not)"
    return Notice("W362", f"on elastic joints the blocks came to rest at none of the strengths that were tried{tip}: "
                  f"no factor of safety is given{exist}")  # fmt: skip


def _drawn_out(component: Part) -> bool:
    """Whether a mechanism draws out a passive bolt."""
    _, slip = component.model.opening_and_slip(component.limit.velocity)
    return bool((slip[component.model.bolted, 0] < -SQUARE).any())
