"""One block on its joints: from what a kind has cut and loaded to its limit, its factors and its result."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import GeometryError, Notice
from slopekit.core.onlooker import Clock
from slopekit.core.sheet import Section
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.design.reading.reader import Reader
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
from slopekit.kinds.single_block.one_block_limit import Cut, FoundLimit, Interface, find_limit
from slopekit.kinds.single_block.one_block_notices import notices as block_notices
from slopekit.kinds.single_block.one_block_states import (
    arrows,
    failure_mechanism,
    motion_statuses,
    opening_pairs,
    pair_state,
    rigid_movement,
    series_of,
)
from slopekit.kinds.single_block.secants import changed_laws, left_out_of_laws, secant_strength
from slopekit.kinds.solver_inputs import joint_stiffness
from slopekit.loads import Loads
from slopekit.notices import those_of_factors
from slopekit.preie.motion.balance import balance, of_one_block
from slopekit.preie.motion.equilibrium import equilibrium
from slopekit.preie.one_block.flat_limit import lowest_factor
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs.bound import static_bound
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.single_block.closed_forms import OnArrays
    from slopekit.kinds.single_block.ladders import Ladder

DILATES = "the closed form knows no dilation: it is printed, not compared"
_OF_THREE = ("J1", "J2", "basal")  # of a wedge with a basal joint


def left_out_of_slope(own: Sequence[str], has_crack: bool, strengths: Sequence[Strength]) -> list[str]:
    """What the model of a block in a slope leaves out: what all do, `own` of its kind, and what its joints have."""
    crack = ["contact across the tension crack"] if has_crack else []
    tensile = ["tensile strength at the limit (it is lost where a joint opens)"]
    tension = tensile if any(one.tension_kpa for one in strengths) else []
    return ["bedrock (no unknowns)", "face and upper slope (free)", *own, *crack, *tension]


def kind_of_one_block(
    record: type[D], read: Callable[[Reader], D], words: Words,
    cut: Callable[[D], Cut], closed_form: Callable[[D], ClosedForm], *,
    changes: Callable[[D], Iterable[tuple[str, D]]], strengths: Callable[[D], Sequence[Strength]],
    slope: Callable[[D, Result], Iterator[Section]], notices: Callable[[D], Iterable[Notice]] = lambda _: (),
    on_arrays: "OnArrays[D] | None" = None,
    without_basal: Callable[[D], WithoutBasal | None] = lambda _: None,
) -> Kind[D]:  # fmt: skip
    """A kind of one block on flat joints with a closed form; what else it says of itself is put in its place.

    Parameters
    ----------
    cut, closed_form : of a design; both raise GeometryError where no block can be formed
    changes : a few changes of the input, by name: SENSITIVITY says what they do to the closed form
    notices : what a reader must know of the design
    on_arrays : the closed form of many designs in one call, where it can be had
    without_basal : a block that the one analysed is part of, and that may fail before it
    """

    def analyse(design: D) -> Result:
        clock = Clock()
        with clock("cut"):
            made = cut(design)
        with clock("closed_form"):
            closed = closed_form(design)
        with clock("governs"):
            governs = tuple((name, *after(other)) for name, other in changes(design))
        found = solve(design, made, clock)
        return result(
            words.of(vars(design)),
            design,
            made,
            found,
            block_status(found, made.joints),
            closed,
            resultant_forces(made, found, water_forces(made.loads, made.faces)),
            clock,
            Comparisons(found.analysis.forces_only.factor, {}, governs, without_basal(design)),
            tuple(notices(design)),
        )

    def after(design: D) -> tuple[float | None, str]:
        try:
            closed = closed_form(design)
        except GeometryError:
            return None, f"no {words.block}"
        return closed.factor, closed.status

    def factors(design: D) -> Factors:
        made, closed = cut(design), closed_form(design)
        found = find_limit(made, Clock())
        status = block_status(found, made.joints)
        difference, agree = compare(found.comparable, status, closed, design.analysis.agree_within)
        said = block_notices(design, made, found, closed.why_not, words.block)
        return Factors(
            status, found.limit.factor or None, closed.status, closed.factor or None, difference, agree,
            found.analysis.moments_govern, notes=those_of_factors((*notices(design), *said)),
            also=without_basal(design),
        )  # fmt: skip

    def ladder(design: D) -> "Ladder":
        from slopekit.kinds.single_block.ladders import ladder_of_block, meshes

        return ladder_of_block(design, analyse, cut, meshes, closed_form)

    return Kind(
        record, read, words, analyse, factors, ladder, strengths,
        lambda design, analysed: tuple(slope(design, analysed)), cut, closed_form, on_arrays,
        without_basal=without_basal,
    )  # fmt: skip


def other_strengths(design: D, strengths: Sequence[Strength]) -> Iterator[tuple[str, D]]:
    """Designs with a little more friction and cohesion, or more of each parameter of their laws, by name.

    Parameters
    ----------
    strengths : of the joints, as the design has them
    """
    distinct = dict.fromkeys(strengths)
    for strength in distinct:
        joints = [joint for joint, own in zip(_OF_THREE, strengths, strict=False) if own == strength]
        of = f" of {' and '.join(joints)}" if len(distinct) > 1 else ""
        for name, other in changed_laws(strength):
            yield name + of, design.each_strength(partial(_exchanged, strength, other))
    if any(strength.named_law for strength in strengths):
        return
    if max(strength.friction_angle_deg for strength in strengths) < 88.0:
        yield "φ +1°", design.each_strength(lambda one: replace(one, friction_angle_deg=one.friction_angle_deg + 1.0))
    if any(strength.cohesion_kpa for strength in strengths):
        yield "c +10 %", design.each_strength(lambda one: replace(one, cohesion_kpa=one.cohesion_kpa * 1.1))


def _exchanged(old: Strength, new: Strength, strength: Strength) -> Strength:
    return new if strength == old else strength


def solve(design: Design, made: Cut, clock: Clock) -> FoundLimit:
    """Mesh, limit, static bound, range, displacements, and what else the design asks for."""
    found = find_limit(made, clock)
    model, limit = found.bounded.model, found.limit
    bound = lowest = at_rest = pairs = None
    with clock("bound"):
        if limit.factor:
            velocity = limit.full_velocity(model)
            bound = static_bound(model, velocity, limit.factor, not found.analysis.moments_govern).factor
    with clock("range"):
        if limit.factor and found.factors is not None:
            lowest = lowest_factor(found.factors)
    stiffness = joint_stiffness(design)
    with clock("displacements"):
        if limit.outcome is Outcome.NO_DRIVING_FORCE or (limit.factor is not None and limit.factor > 1.0):
            at_rest = equilibrium(model, 1.0, stiffness)
    with clock("all_pairs"):
        if design.analysis.criterion == "all-pairs" and limit.factor:
            from slopekit.preie.motion.all_pairs import all_pairs_failed

            pairs = all_pairs_failed(model, stiffness, bound=bound)
    with clock("series"):
        series = tuple(series_of(model, design.analysis.factors, stiffness, bound, made.axes))
    return replace(found, bound=bound, at_rest=at_rest, pairs=pairs, series=series, lowest=lowest)


def result(
    words: Words, design: Design, made: Cut, found: FoundLimit, status: str, closed: ClosedForm, forces: Forces,
    clock: Clock, comparisons: Comparisons, extra: Sequence[Notice] = (),
) -> Result:  # fmt: skip
    """Put the evidence together.

    Parameters
    ----------
    extra : notices of the kind, before the common ones
    """
    analysis, limit, model = found.analysis, found.limit, found.scene.model
    pairs, searched = found.pairs, found.pairs.factor if found.pairs else None
    if pairs and searched and limit.factor and pairs.lost_equilibrium and searched < 0.98 * limit.factor:
        searched = None  # equilibrium was lost on the elastic bed before the last pair failed: no such factor
    difference, agree = compare(found.comparable, status, closed, design.analysis.agree_within)
    rest, origin, axes = found.at_rest, made.origin, made.axes
    of_laws = left_out_of_laws([interface.strength for interface in made.interfaces])
    highest = analysis.forces_only.factor if analysis.moments_govern else None
    size = ModelSize(
        1, model.unknowns, len(found.bounded.pairs), made.refine, found.change, (*made.left_out, *of_laws),
        limit.steps, limit.change,
    )  # fmt: skip
    state = LimitState(
        pair_state(found.scene.pairs, model, limit, made.joints, origin, axes),
        arrows(
            made.loads, {f"water {face}": f"water on {name}" for face, name in made.faces.items()}, origin, axes,
            None if limit.pulls is None else limit.pulls * model.force_scale,
        ),
        failure_mechanism(limit, model, axes), balance(of_one_block(model, analysis)),
        _openings(found, made.interfaces, origin, axes), _curved(found, made.interfaces),
    )  # fmt: skip
    settled = None
    if rest is not None and rest.stands:
        moved = rigid_movement(found.bounded.model, rest.displacement, axes)
        settled = AtFactorOne(moved, rest.failed_pairs, rest.residual)
    return Result(
        design=design, words=words, status=status,
        fos=FactorsOfSafety(
            limit.factor or None, closed.factor or None, found.bound, searched, found.lowest, highest
        ),
        difference=difference, agree=agree, moments_govern=analysis.moments_govern, geometry=made.geometry(),
        forces=forces, model=size,
        warnings=(*extra, *block_notices(design, made, found, closed.why_not, words.block)),
        limit_state=state, displacements=Displacements(settled, pairs, found.series), comparisons=comparisons,
        timing_s=clock.done(),
    )  # fmt: skip


def _curved(found: FoundLimit, interfaces: Sequence[Interface]) -> Mapping[str, Mapping[str, Any]]:
    """Return the line of each curved law at the mean normal traction of its joint; empty where no law is curved."""
    model, limit, lines = found.scene.model, found.limit, dict[str, Mapping[str, Any]]()
    if model.lines is None:
        return lines
    per_area = model.force_scale / model.area_scale
    for interface in interfaces:
        joint = model.interface == interface.key
        traction = float(limit.normal_force[joint].sum() / model.control_area[joint].sum()) * per_area
        if interface.strength.law is not None:
            line = secant_strength(interface.strength, traction)
            pairs = limit.normal_force[joint] / model.control_area[joint] * per_area
            lines[interface.name] = {
                "traction_kpa": max(traction, 0.0), "range_kpa": (float(pairs.min()), float(pairs.max())),
                "cohesion_kpa": line.cohesion_kpa, "friction_angle_deg": line.friction_angle_deg,
            }  # fmt: skip
    return lines


def _openings(
    found: FoundLimit, interfaces: Sequence[Interface], origin: Floats, axes: Floats
) -> Mapping[str, Mapping[str, Any]]:
    """Return where joints are pressed at the limit, by their names and in the user's coordinates."""

    def place(point: Floats | None) -> Floats | None:
        return None if point is None else point @ axes + origin

    return {
        interface.name: {**opening, **{key: place(opening[key]) for key in ("resultant_m", "opens_at_m")}}
        for interface in interfaces
        if (opening := found.openings.get(interface.key)) is not None
    }


# -- reading the answer -------------------------------------------------------------------------------


def block_status(found: FoundLimit, interfaces: Sequence[int]) -> str:
    """The status from the mechanism: which joints stay closed, which way the block moves.

    Parameters
    ----------
    interfaces : the ids of J1 and, where there are such, J2 and the basal joint
    """
    limit, scene = found.limit, found.scene
    model = scene.model
    if limit.outcome is Outcome.NOT_CONVERGED:
        return "not_converged"
    if limit.outcome is Outcome.NO_DRIVING_FORCE:
        return "no_driving_force"
    if limit.outcome is Outcome.LIFTED:
        return "falls" if model.normal_rows[:, model.translations - 1].max() <= 0.0 else "lifted"
    if limit.outcome in (Outcome.NO_STRENGTH, Outcome.NO_REST) and found.analysis.moments_govern:
        return "topples"
    velocity = limit.full_velocity(model)
    if found.factors is not None and found.factors.exact is None:  # joints that open have no dilation
        model = replace(model, tan_dilation=np.zeros_like(model.tan_dilation))
    opens = opening_pairs(limit, model, velocity, by_motion=scene.bedding is not None)
    joints = [scene.pairs.interface == joint for joint in interfaces]
    wholly = np.array([[opens[joint].all() for joint in joints]])
    partly = np.array([[opens[joint].any() for joint in joints]]) & ~wholly
    normal = np.array([[limit.normal_force[joint].sum() for joint in joints]])
    if scene.bedding is not None:  # by the size of the block, not of a mesh on it
        velocity[model.translations :] *= scene.bedding.size_m / model.length_scale
    return str(motion_statuses(velocity[None], model.translations, partly, wholly, normal)[0])


def resultant_forces(made: Cut, found: FoundLimit, water: Mapping[str, float], driven: bool = True) -> Forces:
    """Weight, normal force on each joint at the limit, water, and if `driven` what drives along the movement."""
    normal: dict[str, float | None] = {}
    for interface in made.interfaces:
        on = found.scene.pairs.interface == interface.key
        carried = float(found.limit.normal_force[on].sum() * found.scene.model.force_scale)
        normal[interface.name] = None if found.limit.outcome is Outcome.NOT_CONVERGED else carried
    along = _driving_and_resisting(found) if driven else (None, None)
    return Forces(float(-made.loads.parts["weight"][2]), normal, water, *along)


def _driving_and_resisting(found: FoundLimit) -> tuple[float | None, float | None]:
    """What drives along the movement of the forces alone and what resists it (kN)."""
    model, alone = found.scene.model, found.analysis.forces_only
    if alone.factor is None or model.dilates:  # a dilating joint works on the load as it opens
        return None, None
    along = alone.velocity[: model.translations]
    driving = float(model.load[: model.translations] @ along) / math.sqrt(float(along @ along)) * model.force_scale
    return driving, driving * alone.factor


def water_forces(loads: Loads, names: Mapping[int, str]) -> dict[str, float]:
    """Size (kN) of the water's push on each face."""
    pushes = {name: loads.parts.get(f"water {face}", np.zeros(3)) for face, name in names.items()}
    return {name: math.sqrt(float(push @ push)) for name, push in pushes.items()}
