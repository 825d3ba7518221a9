"""Assemblies of blocks: benches cut by joint sets, the user's own blocks, rows of columns.

The steps are scene, loads, successive mechanisms, state of each block, Result.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from slopekit.block_scene import Contacts
from slopekit.core.arrays import NDArray, frozen
from slopekit.core.errors import Notice
from slopekit.core.progress import Clock
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
from slopekit.kinds.assemblies.many_blocks_scene import (
    AssemblyScene,
    least_counted_weight,
    scene_loads,
)
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
    PERPENDICULAR,
    LostCohesion,
    bolt_notices,
    common_notices,
    factor_notices,
    lost_cohesion_notices,
    mesh_notices,
    undrawn_notice,
)
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.debonding import debonding_limit
from slopekit.preie.many_blocks.ravelling import (
    Failure,
    Ravelling,
    SolvedComponent,
    critical_load,
    ravel,
)
from slopekit.preie.motion.all_pairs import all_pairs_failed
from slopekit.preie.motion.balance import Balance, balance_of_assembly, worst_balance
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
MOST_HISTORY_BLOCKS = (
    24  # cohesive blocks whose history is followed unasked: it takes as long as the limit
)
_HISTORY_SECONDS = 100.0  # seconds of work that a history may take: of 501 blocks some 60
_DEBONDING = 0.02  # of a limit: a history that ends lower by more than this is its lowest factor (docs/method.md)
_BRACKET = 1e-4  # of the paper's criterion, in parts of its factor
_YIELD_TOLERANCE = 1e-2  # of a yield coefficient: the path in the load ends so near to it that its motion is that one
_MODES = {
    "slides": "slide",
    "topples": "topple",
    "rotates": "turn",
    "falls": "fall",
    "lifts": "lift",
    None: "stable",
}
_SEQUENCE_ENDS = {
    "count": "",
    "stands": "what is left stands without any strength",
    "gone": "nothing is left that could move",
    "not_converged": "the last one did not settle, so what comes after it is not known",
}


@dataclass(frozen=True)
class SolvedAssembly:
    """A result with the scene and the sequence of failures that it was made from."""

    result: Result
    scene: AssemblyScene
    ravelling: Ravelling

    @property
    def counted_scene(self) -> AssemblyScene:
        """The scene without the blocks too light to count (chips)."""
        return self.scene.without_blocks(self.ravelling.gone())

    def with_all_pairs(self) -> "SolvedAssembly":
        """Return the result with the paper's criterion: where a block first has no chain of sticking pairs."""
        scene, limit = self.counted_scene, self.result.fos.limit
        model = (
            whole_model(scene.assembly, scene_loads(scene), joint_strength(scene.strengths))
            if limit
            else None
        )
        if model is None or not limit:
            return self
        search = all_pairs_failed(
            model, joint_stiffness(self.result.design), limit, relative=_BRACKET
        )
        fos = replace(self.result.fos, all_pairs_failed=search.factor)
        displacements = replace(self.result.displacements, all_pairs=search)
        return replace(self, result=replace(self.result, fos=fos, displacements=displacements))

    def with_history(self, most: int) -> "SolvedAssembly":
        """Return the result with the limit under progressive slip and debonding (W504), of at most so many blocks.

        The result is unchanged where debonding lowers the limit by no more than 2 %.
        """
        fos, limit = self.result.fos, self.result.fos.limit
        factors = (
            None if limit is None else _debonding_factors(self.ravelling.failures[0].parts[0], most)
        )
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
        result = self._solved_assembly(design, Clock(), 1, ranged=False).result
        status, fos = result.status, result.fos
        if result.model.residual > LIMIT_SETTLED:  # compared as in a result all the same
            status, fos = "not_converged", replace(fos, limit=None)
        notes = factor_notices(result.warnings)
        return Factors(
            status,
            fos.limit,
            None,
            fos.closed_form,
            result.difference,
            result.agree,
            False,
            notes=notes,
        )

    def reference_notices(self, design: A) -> tuple[Notice, ...]:
        if not any(strength.cohesion_kpa for strength in design.joint_strengths):
            return ()
        solution = self._solved_assembly(design, Clock(), 1, ranged=False)
        return solution.with_history(MOST_HISTORY_BLOCKS).result.warnings[
            len(solution.result.warnings) :
        ]

    def ladder(self, design: A) -> "Ladder":
        from slopekit.kinds.assemblies.many_blocks_ladder import (
            ladder_of_blocks,
        )  # only `check` asks

        return ladder_of_blocks(self.solved(design))

    def at_load(self, unloaded: A, unit: A, target: float) -> float | None:
        _, _, critical = self._critical(unloaded, unit, target)
        return None if critical is None else critical[0]

    def _critical(
        self, unloaded: A, unit: A, target: float
    ) -> tuple[AssemblyScene, AssemblyLoads, tuple[float, Failure] | None]:
        """Return the scene, its loads, and the critical multiplier of the load difference with its failure."""
        scene = self.cut(unloaded)
        first, second = scene_loads(scene), scene_loads(self.cut(unit))
        ramp = (second.forces - first.forces, second.moments - first.moments)
        if not ramp[0].any() and not ramp[1].any():
            return scene, first, None
        lightest = least_counted_weight(unloaded, scene, first)
        critical = critical_load(
            scene.assembly, first, ramp, joint_strength(scene.strengths), 1.0 / target, lightest
        )
        return scene, first, critical

    def seismic_gain(self, unloaded: A, unit: A, k: float, by_closed_form: bool) -> Gain | None:
        if by_closed_form:
            return self.closed_form(unloaded, None).seismic_gain(k)
        from slopekit.preie.motion.seismic_gain import seismic_gain  # only earthquakes ask

        scene, loads, critical = self._critical(unloaded, unit, 1.0)
        if critical is None or abs(critical[0] / k - 1.0) > _YIELD_TOLERANCE:
            return None
        multiplier, failure = critical
        with one_thread():
            gain = seismic_gain(failure.parts[0], multiplier, loads.weights, gyration(scene))
        if gain is None:
            return None
        return Gain(gain.factor, scene.names[gain.block], gain.first)

    def solved(self, design: A) -> SolvedAssembly:
        """Return the result of a design with its blocks, loads and mechanisms.

        Raises
        ------
        GeometryError, DesignError
            Where no blocks can be formed, or loads act on none.
        """
        clock = Clock()
        with work_limit.work_budget(math.inf):
            solution = self._solved_assembly(design, clock, design.mechanisms, ranged=True)
        with clock("all_pairs"):
            if design.analysis.criterion == "all-pairs":
                solution = solution.with_all_pairs()
        with clock("history"):
            solution = solution.with_history(MOST_HISTORY_BLOCKS)
        with clock("displacements"):
            result, limit = solution.result, solution.result.fos.limit
            scene_at_one = solution.scene.without_blocks(solution.ravelling.gone(1.0))
            is_stable = result.status == "no_driving_force" or (limit is not None and limit > 1.0)
            settled = (
                at_full_strength(design, scene_at_one, scene_loads(scene_at_one))
                if is_stable
                else None
            )
        displacements = replace(result.displacements, at_factor_one=settled)
        return replace(
            solution, result=replace(result, displacements=displacements, timing_s=clock.done())
        )

    def _solved_assembly(self, design: A, clock: Clock, count: int, ranged: bool) -> SolvedAssembly:
        """Return the solved assembly of a design with `count` successive mechanisms."""
        with clock("cut"):
            scene: AssemblyScene = self.cut(design)
        assembly = scene.assembly
        with clock("loads"):
            loads = scene_loads(scene)
        with clock("solve"):
            lightest, strength = (
                least_counted_weight(design, scene, loads),
                joint_strength(scene.strengths),
            )
            ravelling = ravel(assembly, loads, strength, count, ranged, lightest)
        with clock("mechanisms"):
            rows = tuple(mechanisms_of(ravelling, scene, design.rock.gravity_m_s2))
            mechanisms = tuple(row for row in rows if row.role != "chip")
        status, fos = "no_driving_force", FactorsOfSafety()
        if mechanisms:
            status, governing = mechanisms[0].status, ravelling.failures[0].limit
            fos = FactorsOfSafety(static_bound=ravelling.static_bound)
            if status != "not_converged":
                fos = replace(
                    fos, limit=mechanisms[0].fos, lowest=governing.lowest, highest=governing.highest
                )
        with clock("closed_form"):
            closed = self.closed_form(design, scene)
        difference, agree = compare(fos.limit, status, closed, design.analysis.agree_within)
        findings = Findings(
            rows,
            _remaining_text(ravelling, scene),
            len(assembly),
            int(assembly.fixed.sum()),
            len(assembly.patches),
            len(ravelling.parts),
            _checks(scene, ravelling),
            _table(closed, scene, mechanisms),
            SHEAR_TO_NORMAL,
        )
        components = ravelling.parts
        first = ravelling.failures[0].parts if ravelling.failures else ()
        split = [
            0 if component.refined is None else int(component.refined.max()) for component in first
        ]
        size = ModelSize(
            int((~assembly.fixed).sum()),
            sum(component.model.load.size for component in components),
            sum(component.model.joint_pairs.stop for component in components),
            max(split, default=0),
            max(
                (component.mesh_change for component in first if component.mesh_change is not None),
                default=None,
            ),
            _left_out(scene, components, drained=design.mechanisms > 1 or bool(ravelling.chips)),
            max((component.limit.steps for component in first), default=0),
            mechanisms[0].change if mechanisms else 0.0,
        )
        counted_scene = scene.without_blocks(ravelling.gone())
        kind_notices = (
            self.notices(design, scene, ravelling.failures[0], closed) if mechanisms else ()
        )
        result = Result(
            design=design,
            words=self.words,
            status=status,
            fos=replace(fos, closed_form=closed.factor),
            difference=difference,
            agree=agree,
            moments_govern=False,
            geometry=_geometry(scene),
            forces=_forces(counted_scene, scene_loads(counted_scene), components),
            model=size,
            warnings=(*notices_of(design, scene, ravelling, mechanisms), *kind_notices),
            limit_state=LimitState(
                assembly_pair_state(scene, components),
                assembly_arrows(scene, loads, components),
                balance=force_balance(components),
                curved_strength=_curved(scene, components),
            ),
            displacements=Displacements(),
            comparisons=Comparisons(),
            findings=findings,
            timing_s=clock.done(),
        )
        return SolvedAssembly(result, scene, ravelling)


def no_closed_form(*_: object) -> ClosedForm:
    """Return the empty closed form of blocks of any shape."""
    return ClosedForm(None, "", "there is no closed form for these blocks")


def _table(
    closed: ClosedForm, scene: AssemblyScene, mechanisms: Sequence[Mechanism]
) -> tuple[Mapping[str, Any], ...]:
    """Return the table of the closed form, each column with its mode in the first mechanism."""
    motions = dict(zip(mechanisms[0].blocks, mechanisms[0].how, strict=True)) if mechanisms else {}
    return tuple(
        dict(row) | {"mode_preie": _MODES[motions.get(scene.names[row["n"] - 1])]}
        for row in closed.table
    )


def _debonding_factors(component: SolvedComponent, most: int) -> tuple[float, float | None] | None:
    """Return the last stable and the first unstable factor under progressive slip and debonding.

    The history matters with cohesion, without dilation and curved laws only: else None.
    """
    model, limit = component.model, component.limit
    is_without_history = model.lines is not None or bool(model.tan_dilation.any())
    if is_without_history or not model.has_cohesion or not limit.factor or len(model.load) > most:
        return None
    try:
        with one_thread(), work_limit.work_budget(_HISTORY_SECONDS * work_limit.UNITS_PER_SECOND):
            return debonding_limit(model, limit.factor)
    except work_limit.WorkSpentError:
        return None


def _remaining_text(ravelling: Ravelling, scene: AssemblyScene) -> str:
    remaining = int(ravelling.blocks_left.sum())
    moving = int((~scene.assembly.fixed).sum())
    if remaining == 0:
        return f"none of {moving} blocks is left"
    return "; ".join(
        filter(None, (f"{remaining} of {moving} blocks are left", _SEQUENCE_ENDS[ravelling.ended]))
    )


def _checks(scene: AssemblyScene, ravelling: Ravelling) -> dict[str, float]:
    """Return the checks of the geometry, and the largest unbalanced force at the limit in parts of the largest load."""
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


def force_balance(components: Sequence[SolvedComponent], at_rest: bool = False) -> Balance | None:
    """Return how well the forces of the components that have a factor balance the loads.

    Where a group of blocks has the limit, the forces are those of all blocks at their last equilibrium just before it;
    `at_rest` compares them with the strength there.
    """
    return worst_balance(
        [
            balance_of_assembly(
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


def _left_out(
    scene: AssemblyScene, components: Sequence[SolvedComponent], drained: bool
) -> tuple[str, ...]:
    """Return the assumptions of the model in words, each with its proof or check."""
    assumptions = [
        "bedrock and fixed blocks (they do not move), contacts between them, free faces",
        *scene.left_out,
    ]
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
        assumptions += [
            "everything repeats along the strike: 3 unknowns a block instead of 6 (exact)",
            ends,
        ]
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
        float(assembly.volumes[~assembly.fixed].sum()),
        scene.height_m,
        dict(zip(scene.joints, areas.tolist(), strict=True)),
        scene.names,
        tuple(assembly.fixed.tolist()),
        scene.thickness,
        frozen(assembly.centroids + scene.origin),
        {name: frozen(outline + offset) for name, outline in scene.outlines.items()},
        frozen(assembly.vertices + scene.origin),
        assembly.triangles,
        assembly.triangle_block,
        Contacts(
            frozen(patches.corners + scene.origin),
            patches.first,
            patches.joint,
            patches.plus,
            patches.minus,
        ),
    )


def _forces(
    scene: AssemblyScene, loads: AssemblyLoads, components: Sequence[SolvedComponent]
) -> Forces:
    """Return the weight of the moving blocks, and normal forces at the limit and water thrusts by joint, kN."""
    patches = scene.assembly.patches
    count = len(scene.joints)
    normal = np.zeros(count)
    is_known = True
    for component in components:
        if len(component.model.control_area) == 0:
            continue
        is_known = is_known and component.limit.factor is not None
        joint_pairs = component.model.joint_pairs
        joint = patches.joint[component.patch][component.model.pair_contact[joint_pairs]]
        normal += np.bincount(
            joint, component.limit.normal_force[joint_pairs] * component.model.force_scale, count
        )
    water = dict(
        zip(scene.joints, np.bincount(patches.joint, loads.water, count).tolist(), strict=True)
    )
    open_water = [
        float(np.linalg.norm(load.push.force)) for load in scene.acting.pushes if not load.is_live
    ]
    if open_water:
        water["free faces"] = sum(open_water)
    return Forces(
        float(loads.weights[~scene.assembly.fixed].sum()),
        {
            name: float(value) if is_known else None
            for name, value in zip(scene.joints, normal, strict=True)
        },
        water,
        None,
        None,
    )


def _curved(
    scene: AssemblyScene, components: Sequence[SolvedComponent]
) -> dict[str, Mapping[str, Any]]:
    """Return the secant of each curved law at the mean normal traction of the loaded node pairs of its joint."""
    none: list[NDArray[Any]] = [np.zeros(0)]
    joint, area, normal = none.copy(), none.copy(), none.copy()
    for component in components:
        model, joint_pairs = component.model, component.model.joint_pairs
        if model.lines is not None and component.limit.factor:
            joint.append(model.lines.joint[joint_pairs])
            area.append(model.control_area[joint_pairs] * model.area_scale)
            normal.append(component.limit.normal_force[joint_pairs] * model.force_scale)
    joint_of_pair, area_m2, normal_kn = map(np.concatenate, (joint, area, normal))
    loaded = [(joint_of_pair == key) & (normal_kn > 0.0) for key in range(len(scene.joints))]
    return {
        name: secant_at(strength, normal_kn[pairs], area_m2[pairs])
        for name, strength, pairs in zip(scene.joints, scene.strengths, loaded, strict=True)
        if pairs.any() and strength.law is not None
    }


# -- words ------------------------------------------------------------------------------------------------------------


def contact_areas(areas_m2: Mapping[str, float]) -> list[str]:
    """Return the contact areas of joints as a line of text."""
    areas = [f"{name} {short(area)} m²" for name, area in areas_m2.items()]
    return [f"contact area  {', '.join(shortened(areas, 6))}"] if areas else []


def water_of_blocks(pressures: Sequence[tuple[str, float]]) -> list[str]:
    """Return the mean water pressures by interface as a line of text."""
    wet = [f"u = {pressure:g} kPa on {name}" for name, pressure in pressures if pressure]
    return ["water " + ", ".join(shortened(wet, 6))] if wet else []


def named_strength(design: AssemblyDesign, name: str) -> str:
    """Return a strength in words, with its name where the design has several."""
    words = strength_in_words(design.strength(name), ".6g")
    return words if len(design.strengths) == 1 else f"{name}: {words}"


# -- what a reader must know of the limit and of how it was found -----------------------------------------------------


def notices_of(
    design: AssemblyDesign,
    scene: AssemblyScene,
    ravelling: Ravelling,
    mechanisms: Sequence[Mechanism],
) -> Iterator[Notice]:
    """Yield the notices of an assembly: of its inputs, of the search for its first mechanism, of its sensitivity."""
    yield from scene.notices
    yield from common_notices(design, scene.strengths)
    if not mechanisms:
        return
    first, limit = mechanisms[0], ravelling.failures[0].limit
    yield from bolt_notices(design)
    if (
        first.fos
        and scene.acting.bolt_names
        and not any(_draws_bolt(component) for component in ravelling.failures[0].parts)
    ):
        yield undrawn_notice()
    if limit.outcome is Outcome.NO_STRENGTH:
        yield Notice(
            "W308",
            "the joints have no strength: nothing holds the blocks, there is no factor of safety",
        )
    yield from mesh_notices(
        max(
            (component.mesh_change or 0.0 for component in ravelling.failures[0].parts), default=0.0
        )
    )
    if limit.basis is Basis.PEAK and first.fos:
        yield Notice(
            "W317",
            "the motion did not settle into a limit state: the factor is that of the last stable "
            "state of the elastic path; the limit may lie lower (up to 4 % in random sections)",
        )
    if (
        first.fos
        and limit.change > LIMIT_SETTLED
        and any(strength.law for strength in scene.strengths)
    ):
        yield Notice(
            "W317",
            "strength at the tractions of one limit state leads to another, and back: the lowest "
            f"factor is printed, others lie up to {limit.change * 100:.2g} % above it",
        )
    if limit.rounding and first.fos:
        position = "at" if limit.basis is Basis.PEAK else "just before"
        yield Notice(
            "W317",
            f"all blocks rest {position} the factor but for a rounding of the law of their joints: "
            "forces balance within strength, and what joints give, open and slip fits them but for "
            f"{limit.rounding * 100.0:.1g} % of the elastic energy",
        )
    if limit.outcome is Outcome.NO_REST:
        yield _no_rest_notice(limit, design.seismic.coefficient)
    if limit.spent:
        yield _unsettled_notice(limit)
    elif limit.outcome is Outcome.NOT_CONVERGED:
        above = (
            "" if limit.static_bound is None else f"; the upper bound is {limit.static_bound:.4g}"
        )
        yield Notice(
            "W308",
            "the search for the limit of these blocks gave up: the motion that was followed led to no "
            f"state whose forces balance within strength{above}",
        )
    yield from lost_cohesion_notices(lost_cohesion(ravelling.failures[0]), "factor of safety")


def debonding_notice(stable: float, fails: float, limit: float) -> Notice:
    """Return W504: with progressive slip and debonding the blocks fail below the limit."""
    below = (1.0 - fails / limit) * 100.0
    return Notice(
        "W504",
        f"with progressive slip and debonding the blocks are stable at {stable:.4f} and fail at "
        f"{fails:.4f}, {below:.2g} % below the factor of safety: rely on the lower",
    )


def lost_cohesion(failure: Failure) -> LostCohesion:
    """Return the fraction of the cohesion that does not act at a limit, and the numbers of such contacts and of all."""
    limit, model = failure.limit, failure.parts[0].model
    joints = model.joint_pairs
    full, contact = model.cohesion[joints], model.pair_contact[joints]
    acting = full * limit.bond[joints]
    open_somewhere = acting < full * (1.0 - SAME_LIMIT)
    lost = 1.0 - float(acting.sum()) / max(float(full.sum()), TINY) if full.any() else 0.0
    return lost, len(np.unique(contact[open_somewhere])), len(np.unique(contact[full > 0.0]))


def _unsettled_notice(limit: BlocksLimit) -> Notice:
    """Return W360 for blocks whose limit takes more work than one analysis does, with what is known of it."""
    rests = "no rest of all blocks that would say anything was seen"
    if limit.rested is not None:
        rests = (
            f"all blocks were last at rest with their strength divided by {limit.rested:.4g} (limits of random "
            "sections lay up to 4 % below such a rest)"
        )
    above = ", and no upper bound was found"
    if limit.static_bound is not None:
        above = (
            f", and no forces balance the loads beyond {limit.static_bound:.4g}, the upper bound"
        )
    return Notice(
        "W360",
        "the limit of these blocks was not settled within the effort of one analysis (work is "
        f"counted, not timed: every machine ends here): {rests}{above}",
    )


def _no_rest_notice(limit: BlocksLimit, seismic: float) -> Notice:
    """Return W362 for blocks that come to rest at no strength; `seismic` is the coefficient, or 0."""

    def earthquake(share: float) -> str:
        return f" (k {share * seismic:.4g})" if seismic else ""

    if limit.tips is not None:
        share, factor = limit.tips
        topple = f"with their strength divided by {factor:.4g} or less the blocks topple at {share:.4g} of the loads"
        return Notice(
            "W362",
            f"{topple} beside weight and water{earthquake(share)} without slipping anywhere: a wider "
            "base or bolts would hold them; no factor of safety is given",
        )
    exist = (
        ""
        if limit.static_bound is None
        else "; the upper bound says that forces in balance exist, not that they arise"
    )
    tip = " (mostly such blocks tip: a wider base or bolts hold them, more strength does not)"
    return Notice(
        "W362",
        f"on elastic joints the blocks came to rest at none of the strengths that were tried{tip}: "
        f"no factor of safety is given{exist}",
    )


def _draws_bolt(component: SolvedComponent) -> bool:
    """Return whether a mechanism draws out a passive bolt."""
    _, slip = component.model.opening_and_slip(component.limit.velocity)
    return bool((slip[component.model.bolted, 0] < -PERPENDICULAR).any())
