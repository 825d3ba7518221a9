"""One block on its joints: from the cut and loaded block to its limit, its factors, its result, its notices."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import GeometryError, Notice
from slopekit.core.progress import Clock
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.evidence import (
    AtFactorOne,
    Comparisons,
    Displacements,
    FactorsOfSafety,
    Forces,
    LimitState,
    ModelSize,
    WithoutBasal,
)
from slopekit.kinds.protocol import ClosedForm, D, Factors, Kind, compare
from slopekit.kinds.single_block.one_block_limit import (
    Cut,
    FoundLimit,
    Interface,
    arrows,
    failure_mechanism,
    find_limit,
    motion_statuses,
    opening_pairs,
    pair_state,
    rigid_movement,
    series_of,
)
from slopekit.kinds.single_block.secants import left_out_of_laws, secant_at
from slopekit.kinds.solver_inputs import joint_stiffness
from slopekit.notices import (
    PERPENDICULAR,
    bolt_notices,
    common_notices,
    factor_notices,
    mesh_notices,
    undrawn_notice,
)
from slopekit.preie.motion.balance import balances_of_block, worst_balance
from slopekit.preie.motion.equilibrium import equilibrium
from slopekit.preie.one_block.flat_limit import lowest_factor
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs.bound import static_bound
from slopekit.preie.tolerances import LIMIT_SETTLED
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.single_block.ladders import Ladder, Rung
    from slopekit.preie.motion.all_pairs import AllPairsFailed

_LOST_EQUILIBRIUM = 0.98  # of the limit
_ACROSS_COSINE, _AGAINST_COSINE = 0.34, 0.1  # cosines of 70°, and of 84° the other way
_WHOLE_AREA = 0.999999  # of an interface
_ROTATION_SHARE = 1e-6  # of the square of a motion on a curved surface


def left_out_of_slope(
    assumptions: Sequence[str], has_crack: bool, strengths: Sequence[Strength]
) -> list[str]:
    """Return the assumptions of the model of a block in a slope: those of its kind, of all kinds, and of its joints."""
    crack = ["contact across the tension crack"] if has_crack else []
    tensile = ["tensile strength at the limit (it is lost where a joint opens)"]
    tension = tensile if any(strength.tension_kpa for strength in strengths) else []
    return ["bedrock (no unknowns)", "face and upper slope (free)", *assumptions, *crack, *tension]


class SingleBlock(Kind[D]):
    """A kind of one block on its joints.

    `cut` gives a `Cut`, and raises GeometryError where no block can be formed; so does `closed_form`.
    """

    MOVES_MANY = False

    def analyse(self, design: D) -> Result:
        clock = Clock()
        with clock("cut"):
            cut: Cut = self.cut(design)
        with clock("closed_form"):
            closed = self.closed_form(design, cut)
        with clock("governs"):
            governs = tuple(
                (name, *self._changed_factor(changed)) for name, changed in design.changes()
            )
        solution = find_limit(cut, clock)
        fos = _factors_of_safety(solution, closed, clock)
        displacements = _displacements(design, cut, solution, fos.static_bound, clock)
        if displacements.all_pairs is not None and not _is_lost_before(
            displacements.all_pairs, fos.limit
        ):
            fos = replace(fos, all_pairs_failed=displacements.all_pairs.factor)
        analysis, status, words = (
            solution.analysis,
            block_status(solution, cut.joints),
            self.words.for_inputs(vars(design)),
        )
        difference, agree = compare(
            solution.comparable, status, closed, design.analysis.agree_within
        )
        law_assumptions = left_out_of_laws([interface.strength for interface in cut.interfaces])
        size = ModelSize(
            1,
            solution.scene.model.unknowns,
            len(solution.bounded.pairs),
            cut.refine,
            solution.change,
            (*cut.left_out, *law_assumptions),
            solution.limit.steps,
            solution.limit.change,
        )
        notices = (
            *self.notices(design, cut, solution, closed),
            *block_notices(design, cut, solution, closed, words),
        )
        return Result(
            design=design,
            words=words,
            status=status,
            fos=fos,
            difference=difference,
            agree=agree,
            moments_govern=analysis.moments_govern,
            geometry=cut.geometry(),
            forces=resultant_forces(cut, solution, status),
            model=size,
            warnings=notices,
            limit_state=_limit_state(cut, solution),
            displacements=displacements,
            comparisons=Comparisons(
                analysis.forces_only.factor,
                closed.methods,
                governs,
                self.without_basal(design),
                on_pressed=solution.on_pressed,
            ),
            timing_s=clock.done(),
        )

    def factors(self, design: D) -> Factors:
        cut: Cut = self.cut(design)
        closed, solution = self.closed_form(design, cut), find_limit(cut, Clock())
        status = block_status(solution, cut.joints)
        difference, agree = compare(
            solution.comparable, status, closed, design.analysis.agree_within
        )
        notices = (
            *self.notices(design, cut, solution, closed),
            *block_notices(design, cut, solution, closed, self.words),
        )
        return Factors(
            status,
            solution.limit.factor or None,
            closed.status if design.HAS_CLOSED_FORM else None,
            closed.factor or None,
            difference,
            agree,
            solution.analysis.moments_govern,
            notes=factor_notices(notices),
            also=self.without_basal(design),
        )

    def _changed_factor(self, changed: D) -> tuple[float | None, str]:
        try:
            closed = self.closed_form(changed, None)
        except GeometryError:
            return None, f"no {self.words.block}"
        return closed.factor, closed.status

    def without_basal(self, design: D) -> WithoutBasal | None:
        whole_wedges = None if self.on_arrays is None else self.on_arrays.whole_wedges
        if whole_wedges is None:
            return None
        closed = whole_wedges(design, design.joint_strengths, None).form()
        return WithoutBasal(closed.status, closed.factor) if closed.status else None

    def ladder(self, design: D) -> "Ladder":
        from slopekit.kinds.single_block.ladders import ladder_of_block

        return ladder_of_block(self, design)

    def finer(self, design: D, result: Result, cut: Cut) -> "Iterator[Rung]":
        """Yield the limit on coarser and finer node pairs."""
        from slopekit.kinds.single_block.ladders import meshes

        return meshes(cut)


def _factors_of_safety(solution: FoundLimit, closed: ClosedForm, clock: Clock) -> FactorsOfSafety:
    """Return the factors of safety: limit, closed form, static bound and range."""
    limit, analysis = solution.limit, solution.analysis
    highest = analysis.forces_only.factor if analysis.moments_govern else None
    fos = FactorsOfSafety(limit.factor or None, closed.factor or None, highest=highest)
    with clock("bound"):
        if limit.factor:
            model = solution.bounded.model
            bound = static_bound(model, limit.velocity, limit.factor, not analysis.moments_govern)
            fos = replace(fos, static_bound=bound.factor)
    with clock("range"):
        if limit.factor and solution.factors is not None:
            fos = replace(fos, lowest=lowest_factor(solution.factors))
    return fos


def _displacements(
    design: Design, cut: Cut, solution: FoundLimit, bound: float | None, clock: Clock
) -> Displacements:
    """Return the displacements at full strength, and those by all pairs and along the series where the design asks."""
    model, limit, stiffness = solution.bounded.model, solution.limit, joint_stiffness(design)
    settled = pairs = None
    with clock("displacements"):
        if limit.outcome is Outcome.NO_DRIVING_FORCE or (
            limit.factor is not None and limit.factor > 1.0
        ):
            rest = equilibrium(model, 1.0, stiffness)
            if rest.is_balanced:
                movement = rigid_movement(model, rest.displacement, cut.axes)
                settled = AtFactorOne(movement, rest.failed_pairs, rest.residual)
    with clock("all_pairs"):
        if design.analysis.criterion == "all-pairs" and limit.factor:
            from slopekit.preie.motion.all_pairs import all_pairs_failed

            pairs = all_pairs_failed(model, stiffness, bound=bound)
    with clock("series"):
        series = tuple(series_of(model, design.analysis.factors, stiffness, bound, cut.axes))
    return Displacements(settled, pairs, series)


def _is_lost_before(pairs: "AllPairsFailed", limit: float | None) -> bool:
    """Return whether equilibrium was lost well below the limit, so that all pairs failed gives no factor."""
    return bool(
        pairs.factor
        and limit
        and pairs.lost_equilibrium
        and pairs.factor < _LOST_EQUILIBRIUM * limit
    )


def _limit_state(cut: Cut, solution: FoundLimit) -> LimitState:
    limit, model, origin, axes = solution.limit, solution.scene.model, cut.origin, cut.axes
    return LimitState(
        pair_state(solution.scene.pairs, model, limit, cut.joints, origin, axes),
        arrows(
            cut.loads,
            {f"water {face}": f"water on {name}" for face, name in cut.faces.items()},
            origin,
            axes,
            None if limit.pulls is None else limit.pulls * model.force_scale,
        ),
        failure_mechanism(limit, model, axes),
        worst_balance(balances_of_block(model, solution.analysis)),
        _openings(solution, cut.interfaces, origin, axes),
        _curved(solution, cut.interfaces),
    )


def _curved(
    solution: FoundLimit, interfaces: Sequence[Interface]
) -> Mapping[str, Mapping[str, Any]]:
    """Return the line of each curved law at the mean normal traction of its joint; empty where no law is curved."""
    model = solution.scene.model
    normal_kn, area_m2 = (
        solution.limit.normal_force * model.force_scale,
        model.control_area * model.area_scale,
    )
    joints = [
        (interface, model.interface == interface.key)
        for interface in interfaces
        if interface.strength.law
    ]
    return {
        interface.name: secant_at(interface.strength, normal_kn[pairs], area_m2[pairs])
        for interface, pairs in joints
    }


def _openings(
    solution: FoundLimit, interfaces: Sequence[Interface], origin: Floats, axes: Floats
) -> Mapping[str, Mapping[str, Any]]:
    """Return the pressed share, force, resultant and widest opening of each joint, in the user's coordinates."""

    def place(point: Floats | None) -> Floats | None:
        return None if point is None else point @ axes + origin

    return {
        interface.name: {
            **opening,
            **{key: place(opening[key]) for key in ("resultant_m", "opens_at_m")},
        }
        for interface in interfaces
        if (opening := solution.openings.get(interface.key)) is not None
    }


# -- reading the answer -------------------------------------------------------------------------------


def block_status(solution: FoundLimit, interfaces: Sequence[int]) -> str:
    """Return the status of a block from its mechanism: the joints that stay closed, and the direction of movement.

    Parameters
    ----------
    interfaces : the ids of J1 and, where there are such, J2 and the basal joint
    """
    limit, scene = solution.limit, solution.scene
    model = scene.model
    if limit.outcome is Outcome.NOT_CONVERGED:
        return "not_converged"
    if limit.outcome is Outcome.NO_DRIVING_FORCE:
        return "no_driving_force"
    if limit.outcome is Outcome.LIFTED:
        return "falls" if model.normal_rows[:, model.translations - 1].max() <= 0.0 else "lifted"
    if limit.outcome in (Outcome.NO_STRENGTH, Outcome.NO_REST) and solution.analysis.moments_govern:
        return "topples"
    velocity = limit.velocity.copy()
    if (
        solution.factors is not None and solution.factors.exact is None
    ):  # joints that open have no dilation
        model = replace(model, tan_dilation=np.zeros_like(model.tan_dilation))
    opens = opening_pairs(limit, model, velocity, by_motion=scene.bedding is not None)
    joints = [scene.pairs.interface == joint for joint in interfaces]
    wholly = np.array([[opens[joint].all() for joint in joints]])
    partly = np.array([[opens[joint].any() for joint in joints]]) & ~wholly
    normal = np.array([[limit.normal_force[joint].sum() for joint in joints]])
    if scene.bedding is not None:  # by the size of the block, not of a mesh on it
        velocity[model.translations :] *= scene.bedding.size_m / model.length_scale
    status = str(motion_statuses(velocity[None], model.translations, partly, wholly, normal)[0])
    turns = float(limit.velocity[3:] @ limit.velocity[3:]) > _ROTATION_SHARE * float(
        limit.velocity @ limit.velocity
    )
    return "rotates" if scene.bedding is None and turns and status.startswith("slides") else status


def resultant_forces(cut: Cut, solution: FoundLimit, status: str) -> Forces:
    """Return weight, normal forces at the limit, water, and the driving and resisting forces along the movement, kN.

    A block that turns on a curved surface has no driving and resisting force.
    """
    normal: dict[str, float | None] = {}
    for interface in cut.interfaces:
        pairs = solution.scene.pairs.interface == interface.key
        normal_kn = float(
            solution.limit.normal_force[pairs].sum() * solution.scene.model.force_scale
        )
        normal[interface.name] = (
            None if solution.limit.outcome is Outcome.NOT_CONVERGED else normal_kn
        )
    turns_on_curve = status == "rotates" and solution.scene.bedding is None
    along = (None, None) if turns_on_curve else _driving_and_resisting(solution)
    return Forces(float(-cut.loads.components["weight"][2]), normal, cut.water_kn, *along)


def _driving_and_resisting(solution: FoundLimit) -> tuple[float | None, float | None]:
    """Return the driving and the resisting force (kN) along the movement of the forces alone."""
    model, forces_only = solution.scene.model, solution.analysis.forces_only
    if (
        forces_only.factor is None or model.dilates
    ):  # a dilating joint works on the load as it opens
        return None, None
    along = forces_only.velocity[: model.translations]
    driving = (
        float(model.load[: model.translations] @ along)
        / math.sqrt(float(along @ along))
        * model.force_scale
    )
    return driving, driving * forces_only.factor


# -- what a reader must know of the factor, of what it rests on, and how it was found ---------------------------------


def block_notices(
    design: Design, cut: Cut, solution: FoundLimit, closed: ClosedForm, words: Words
) -> Iterator[Notice]:
    """Yield the notices of one analysed block."""
    strengths = [interface.strength for interface in cut.interfaces]
    limit, model = solution.limit, solution.scene.model
    yield from common_notices(design, strengths)
    if limit.factor and not limit.settled_to(LIMIT_SETTLED):
        runs = f"the block rests at {limit.factor:.4g} and runs at {limit.factor * (1.0 + limit.change):.4g}"
        yield Notice(
            "W317", f"the motion did not settle into a limit state: {runs}; the lower is printed"
        )
    if limit.factor is not None or limit.outcome is Outcome.NO_STRENGTH:
        yield from _lost_contact_notices(design, cut, solution)
    if limit.factor is not None:
        yield from _seismic_notices(cut, solution)
        passive = any(bolt.acts == "passive" for bolt in design.bolts)
        if passive and not (-model.bolt_rows @ limit.velocity > PERPENDICULAR).any():
            yield undrawn_notice()
    has_strength = any(
        strength.cohesion_kpa or strength.friction_angle_deg for strength in strengths
    )
    if not has_strength and not len(model.bolt_capacity):
        yield without_strength(words.block)
    if closed.why_not and any(strength.dilation_deg for strength in strengths):
        yield dilating(
            closed.why_not, solution.factors is None or solution.factors.exact is not None
        )
    yield from bolt_notices(design)
    yield from mesh_notices(solution.change or 0.0)


def _lost_contact_notices(design: Design, cut: Cut, solution: FoundLimit) -> Iterator[Notice]:
    """W307: joints that have lost contact where the forces alone govern, or that a curved surface opens on.

    A flat joint that opens on a part of its area alone has the limit of its bed, which does not jump.
    """
    if solution.analysis.moments_govern:
        return
    area, least = (
        solution.scene.model.control_area,
        0.0 if solution.factors is None else _WHOLE_AREA,
    )
    for interface in cut.interfaces:
        joint = solution.scene.pairs.interface == interface.key
        lost = float(area[joint & (solution.limit.bond == 0.0)].sum() / area[joint].sum())
        if interface.strength.cohesion_kpa > 0.0 and lost > least:
            yield lost_contact(design.in_own_names(interface.name), lost)


def _seismic_notices(cut: Cut, solution: FoundLimit) -> Iterator[Notice]:
    """W328: a seismic load that does not drive the movement."""
    seismic, model = cut.loads.components["seismic"], solution.scene.model
    motion = model.rigid_motion(solution.limit.velocity)[0]
    size = float(np.linalg.norm(seismic) * np.linalg.norm(motion))
    if size:
        yield from shaking(float(seismic @ motion) / size)


def without_strength(block: str) -> Notice:
    """W308: nothing holds what moves."""
    return Notice(
        "W308",
        f"the joints have no strength: nothing holds the {block}, there is no factor of safety",
    )


def dilating(why_not: str, dilates: bool) -> Notice:
    """W310: joints that dilate, which the closed form does not know; whether the limit is one with dilation."""
    assumption = (
        "" if dilates else "; a joint opens or has a curved law: the limit is that without dilation"
    )
    return Notice("W310", why_not + assumption)


def lost_contact(joint: str, lost: float = 1.0) -> Notice:
    """W307: a joint that has lost contact, or opens on a part of its area."""
    opens = (
        "has lost contact"
        if lost > _WHOLE_AREA
        else f"opens on {max(lost * 100, 1.0):.0f} % of its area"
    )
    jumps = "with a little less water or seismic load it may, and the factor of safety jumps"
    return Notice("W307", f"{joint} {opens}, so its cohesion there does not act: {jumps}")


def shaking(along: float) -> Iterator[Notice]:
    """W328, where a seismic load does not drive the movement; `along`: cosine of the angle between the two."""
    if along < -_AGAINST_COSINE:
        yield Notice(
            "W328", "the seismic load acts against the movement: it raises the factor of safety"
        )
    elif along < _ACROSS_COSINE:
        angle_deg = math.degrees(math.acos(along))
        yield Notice(
            "W328",
            f"the seismic load acts across the movement, {angle_deg:.0f}° off it: is its trend right?",
        )
