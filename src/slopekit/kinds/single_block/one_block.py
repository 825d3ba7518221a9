"""One block on its joints: from what a kind has cut and loaded to its limit, its factors and its result."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import GeometryError, Notice
from slopekit.core.onlooker import Clock
from slopekit.core.records import dataclass
from slopekit.core.sheet import Section
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.design.reading.reader import Reader
from slopekit.evidence import (
    AllPairs,
    AtFactorOne,
    ContactOpening,
    FactorsOfSafety,
    Forces,
    ModelSize,
    ReductionStep,
    SecantLine,
    WithoutBasal,
)
from slopekit.extents import Geometry
from slopekit.geometry.rock.cutting import Block
from slopekit.kinds.protocol import ClosedForm, D, Factors, Kind, WhenRead, compare, one_or_error
from slopekit.kinds.single_block.one_block_limit import FoundLimit, comparable, find_limit
from slopekit.kinds.single_block.one_block_states import (
    ContactModel,
    arrows,
    mechanism_of,
    movement_of,
    opening_pairs,
    pair_state,
    series_of,
    turned,
    turned_back,
)
from slopekit.kinds.single_block.secants import changed_laws, left_out_of_laws, secant_strength
from slopekit.kinds.solver_inputs import joint_stiffness
from slopekit.loads import Hull, Loads
from slopekit.notices import Facts, Interface, notices_of_factor
from slopekit.notices import notices as common_notices
from slopekit.preie.motion.balance import balance, of_one_block
from slopekit.preie.motion.equilibrium import Equilibrium, equilibrium
from slopekit.preie.one_block.flat_limit import lowest_factor
from slopekit.preie.one_block.limit import LimitAnalysis, limit_analysis
from slopekit.preie.one_block.passes import Limit, Outcome
from slopekit.preie.programs.bound import static_bound
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import PASSES_SETTLED
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.single_block.closed_forms import OnArrays
    from slopekit.kinds.single_block.ladders import Ladder
    from slopekit.preie.motion.all_pairs import AllPairsFailed

DILATES = "the closed form knows no dilation: it is printed, not compared"
_OF_THREE = ("J1", "J2", "basal")  # of a wedge with a basal joint
_NEARLY_NONE = 1e-6


@dataclass(frozen=True, slots=True)
class Solved:
    """Everything that PRE-IE says of one scene.

    Attributes
    ----------
    found : the limit with the node pairs that carry it
    bound : the static bound; at_rest : the equilibrium at full strength
    lowest : the limit with other joint stiffness, or soon after it begins to creep, where that is lower
    """

    found: FoundLimit
    bound: float | None = None
    at_rest: Equilibrium | None = None
    pairs: "AllPairsFailed | None" = None
    series: tuple[ReductionStep, ...] = ()
    lowest: float | None = None

    @property
    def scene(self) -> ContactModel:
        """The node pairs with their model."""
        return self.found.scene

    @property
    def analysis(self) -> LimitAnalysis:
        """The limit on them, and whether moments govern."""
        return self.found.analysis

    @property
    def limit(self) -> Limit:
        """The limit that governs."""
        return self.analysis.governing


@dataclass(frozen=True, slots=True)
class Cut:
    """A block, cut and loaded, in local axes: what its limit, its result and its support are made from.

    Attributes
    ----------
    scene_at : its node pairs and their model, by how often the parts of the joints are split; `refine` times here
    interfaces : its joints; faces : names of those that water can press on
    geometry : made where a result asks for it; left_out : what is not modelled
    face : the free face that bolts go into, None where support is not looked for; hull : the planes that they meet
    limit : how a model is solved
    origin : (3,) what takes local coordinates back to the user's
    axes : (3, 3) rows are the local axes in those of the user, None where they are the same
    """

    block: Block
    loads: Loads
    scene_at: Callable[[int], ContactModel]
    interfaces: Sequence[Interface]
    geometry: Callable[[], Geometry]
    left_out: Sequence[str]
    faces: Mapping[int, str] = field(default_factory=dict)
    face: int | None = None
    hull: Callable[[], Hull] | None = None
    refine: int = 0
    limit: Callable[[Model], LimitAnalysis] = limit_analysis
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    axes: Floats | None = None

    @property
    def height_m(self) -> float:
        """From its lowest to its highest point."""
        return self.geometry().total_height_m

    @property
    def joints(self) -> tuple[int, ...]:
        """The ids of its joints."""
        return tuple(interface.key for interface in self.interfaces)


def left_out_of_slope(own: Sequence[str], has_crack: bool, strengths: Sequence[Strength]) -> list[str]:
    """What the model of a block in a slope leaves out: what all do, `own` of its kind, and what its joints have."""
    crack = ["contact across the tension crack"] if has_crack else []
    tensile = ["tensile strength at the limit (it is lost where a joint opens)"]
    tension = tensile if any(one.tension_kpa for one in strengths) else []
    return ["bedrock (no unknowns)", "face and upper slope (free)", *own, *crack, *tension]


def kind_of_one_block(
    name: str, record: type[D], read: Callable[[Reader], D], words: Words,
    cut: Callable[[D], Cut], closed_form: Callable[[D], ClosedForm], *,
    changes: Callable[[D], Iterable[tuple[str, D]]], strengths: Callable[[D], Sequence[Strength]],
    slope: Callable[[D, Result], Iterator[Section]], notices: Callable[[D], Iterable[Notice]] = lambda _: (),
    on_arrays: "OnArrays[D] | None" = None, variants: Mapping[str, Words] = MappingProxyType({}),
    without_basal: Callable[[D], WithoutBasal | None] = lambda _: None,
) -> Kind[D]:  # fmt: skip
    """A kind of one block on flat joints with a closed form; what else it says of itself is put in its place.

    Parameters
    ----------
    cut, closed_form : of a design; both raise GeometryError where no block can be formed
    changes : a few changes of the input, by name: SENSITIVITY says what they do to the closed form
    notices : what a reader must know of the design
    on_arrays : the closed form of many designs in one call, where it can be had
    variants : what designs call things that have the input of that name, where it is not as the kind does
    without_basal : a block that the one analysed is part of, and that may fail before it
    """

    def analyse(design: D) -> Result:
        clock = Clock()
        with clock("cut"):
            made = cut(design)
        with clock("closed_form"):
            closed = closed_form(design)
        with clock("governs"):
            forms = [(name, one_or_error(closed_form, other)) for name, other in changes(design)]
            none = None, f"no {words.block}"
            governs = tuple(
                (name, *(none if isinstance(form, GeometryError) else (form.factor, form.status)))
                for name, form in forms
            )
        solved = solve(design, made, clock)
        status = block_status(solved.limit, solved.analysis, solved.scene, made.joints)
        forces = forces_of(made, solved, water_forces(made.loads, made.faces))
        of_design = tuple(notices(design))
        answer = result(
            own_words(design), design, made, solved, status, closed, forces, clock, governs=governs, extra=of_design
        )
        return replace(answer, without_basal=without_basal(design))

    def own_words(design: D) -> Words:
        return next((said for key, said in variants.items() if getattr(design, key) is not None), words)

    def factors(design: D) -> Factors:
        made, closed = cut(design), closed_form(design)
        found_limit = find_limit(made.scene_at, made.refine, Clock())
        limit, governs = found_limit.analysis.governing, found_limit.analysis.moments_govern
        status = block_status(limit, found_limit.analysis, found_limit.scene, made.joints)
        compared = comparable(found_limit)
        difference, agree = compare(compared, status, closed, design.agree_within)

        def facts() -> Facts:
            return facts_of(own_words(design), made, Solved(found_limit), status, closed)

        return Factors(
            status, limit.factor or None, closed.status, closed.factor or None, difference, agree, governs,
            limit.settled_to(PASSES_SETTLED),
            notes=WhenRead(lambda: (*notices(design), *notices_of_factor(design, made.interfaces, facts()))),
            also=without_basal(design),
        )  # fmt: skip

    def ladder(design: D) -> "Ladder":
        from slopekit.kinds.single_block.ladders import ladder_of_block, meshes

        return ladder_of_block(design, analyse, cut, meshes, closed_form)

    return Kind(
        name, record, read, words, analyse, factors, ladder, strengths,
        lambda design, analysed: tuple(slope(design, analysed)), cut, closed_form, on_arrays,
        answered="drag", variants=variants, without_basal=without_basal,
    )  # fmt: skip


def on_one_plane(factor: float | None, status: str, strength: Strength) -> ClosedForm:
    """The closed form of a block on one plane, as PRE-IE is compared with it."""
    return ClosedForm(
        factor, "slides_on_J1" if status == "slides" else status, DILATES if strength.dilation_deg else ""
    )


def other_strengths(strength: Strength) -> Iterator[tuple[str, Strength]]:
    """A little more friction and cohesion, or a little more of each parameter of a curved law, by name."""
    yield from changed_laws(strength)
    if strength.named_law is not None:
        return
    if strength.friction_angle_deg < 88.0:
        yield "φ +1°", replace(strength, friction_angle_deg=strength.friction_angle_deg + 1.0)
    if strength.cohesion_kpa:
        yield "c +10 %", replace(strength, cohesion_kpa=strength.cohesion_kpa * 1.1)


def solve(design: Design, made: Cut, clock: Clock) -> Solved:
    """Mesh, limit, static bound, range, displacements, and what else the design asks for."""
    found_limit = find_limit(made.scene_at, made.refine, clock, made.limit)
    model, analysis = found_limit.bounded.model, found_limit.analysis
    limit = analysis.governing
    bound = lowest = at_rest = pairs = None
    with clock("bound"):
        if limit.factor:
            velocity = limit.velocity_of(model)
            bound = static_bound(model, velocity, limit.factor, not analysis.moments_govern).factor
    with clock("range"):
        if limit.factor and found_limit.factors is not None:
            lowest = lowest_factor(found_limit.factors)
    stiffness = joint_stiffness(design)
    with clock("displacements"):
        if limit.outcome is Outcome.NO_DRIVING_FORCE or (limit.factor is not None and limit.factor > 1.0):
            at_rest = equilibrium(model, 1.0, stiffness)
    with clock("all_pairs"):
        if design.criterion == "all-pairs" and limit.factor:
            from slopekit.preie.motion.all_pairs import all_pairs_failed

            pairs = all_pairs_failed(model, stiffness)
    with clock("series"):
        series = tuple(series_of(model, design.factors, stiffness, bound))
    return Solved(found_limit, bound, at_rest, pairs, series, lowest)


def limit_alone(_: Design, made: Cut, clock: Clock) -> Solved:
    """`solve` without the static bound and what else does not change the limit."""
    return Solved(find_limit(made.scene_at, made.refine, clock, made.limit))


def facts_of(words: Words, made: Cut, solved: Solved, status: str, closed: ClosedForm) -> Facts:
    """What was found, for the notices to judge."""
    shaking = made.loads.parts["seismic"]
    return Facts(
        status, solved.analysis, solved.scene.pairs, solved.scene.model,
        solved.found.change, closed.why_not, words.block, shaking if shaking.any() else None,
    )  # fmt: skip


def result(
    words: Words, design: Design, made: Cut, solved: Solved, status: str, closed: ClosedForm, forces: Forces,
    clock: Clock, *, governs: tuple[tuple[str, float | None, str], ...] = (),
    methods: Mapping[str, float | None] | None = None, extra: Sequence[Notice] = (),
) -> Result:  # fmt: skip
    """Put the evidence together.

    Parameters
    ----------
    extra : notices of the kind, before the common ones
    """
    analysis, limit, model = solved.analysis, solved.limit, solved.scene.model
    alone = analysis.forces_only.factor
    pairs, searched = solved.pairs, solved.pairs.factor if solved.pairs else None
    if pairs and searched and limit.factor and pairs.lost_equilibrium and searched < 0.98 * limit.factor:
        searched = None  # equilibrium was lost on the elastic bed before the last pair failed: no such factor
    compared = comparable(solved.found)
    difference, agree = compare(compared, status, closed, design.agree_within)
    rest = solved.at_rest
    facts = facts_of(words, made, solved, status, closed)
    origin, turn = made.origin, made.axes
    of_laws = left_out_of_laws([interface.strength for interface in made.interfaces])
    plain = solved.found.bounded
    size = ModelSize(
        1, model.unknowns, len(plain.pairs), made.refine, solved.found.change, (*made.left_out, *of_laws),
        limit.passes,
        limit.change,
    )  # fmt: skip
    return Result(
        design=design, words=words, status=status,
        fos=FactorsOfSafety(
            limit.factor or None, closed.factor or None, solved.bound, searched, solved.lowest, _highest(solved)
        ),
        difference=difference, agree=agree, moments_govern=analysis.moments_govern, forces_only=alone,
        static_bound_proved=solved.bound is not None, geometry=made.geometry(), forces=forces, model=size,
        mechanism=turned(mechanism_of(limit, model), turn),
        at_factor_one=None if rest is None or not rest.stands else AtFactorOne(
            turned_back(movement_of(plain.model, rest.displacement), turn), rest.failed_pairs, rest.residual
        ),
        all_pairs=None if pairs is None else AllPairs(pairs.bracket, pairs.lost_equilibrium, pairs.history),
        governs=governs, warnings=(*extra, *common_notices(design, made.interfaces, facts)),
        node_pairs=pair_state(solved.scene.pairs, model, limit, made.joints, origin, turn),
        acting=arrows(
            made.loads, {f"water {face}": f"water on {name}" for face, name in made.faces.items()}, origin, turn,
            None if limit.pulls is None else limit.pulls * model.force_scale,
        ),
        methods=methods or {},
        series=tuple(replace(step, movement=turned(step.movement, turn)) for step in solved.series),
        balance=balance(of_one_block(model, analysis)),
        openings=_openings(solved, made.interfaces, origin, turn),
        turns_over=turns_over(limit, model) if status == "topples" else "",
        curved_strength=_curved(solved, made.interfaces), timing_s=clock.done(),
    )  # fmt: skip


def _highest(solved: Solved) -> float | None:
    """Return the factor of the forces alone where moments govern."""
    return solved.analysis.forces_only.factor if solved.analysis.moments_govern else None


def _curved(solved: Solved, interfaces: Sequence[Interface]) -> Mapping[str, SecantLine]:
    """Return the line of each curved law at the mean normal traction of its joint; empty where no law is curved."""
    model, limit, lines = solved.scene.model, solved.limit, dict[str, SecantLine]()
    if model.lines is None:
        return lines
    per_area = model.force_scale / model.area_scale
    for interface in interfaces:
        joint = model.interface == interface.key
        traction = float(limit.normal_force[joint].sum() / model.control_area[joint].sum()) * per_area
        if interface.strength.law is not None:
            line = secant_strength(interface.strength, traction)
            pairs = limit.normal_force[joint] / model.control_area[joint] * per_area
            lines[interface.name] = SecantLine(
                max(traction, 0.0), (float(pairs.min()), float(pairs.max())), line.cohesion_kpa, line.friction_angle_deg
            )
    return lines


def _openings(
    solved: Solved, interfaces: Sequence[Interface], origin: Floats, turn: Floats | None
) -> Mapping[str, ContactOpening]:
    """Return where joints are pressed at the limit, by their names and in the user's coordinates."""
    axes = np.eye(3) if turn is None else turn

    def place(point: Floats | None) -> Floats | None:
        return None if point is None else point @ axes + origin

    return {
        interface.name: replace(opening, resultant_m=place(opening.resultant_m), opens_at_m=place(opening.opens_at_m))
        for interface in interfaces
        if (opening := solved.found.openings.get(interface.key)) is not None
    }


# -- reading the answer -------------------------------------------------------------------------------


def block_status(limit: Limit, analysis: LimitAnalysis, scene: ContactModel, interfaces: Sequence[int]) -> str:
    """The status from the mechanism: which joints stay closed, which way the block moves.

    Parameters
    ----------
    interfaces : the ids of J1 and, where there are such, J2 and the basal joint
    """
    model = scene.model
    if limit.outcome is Outcome.NOT_CONVERGED:
        return "not_converged"
    if limit.outcome is Outcome.NO_DRIVING_FORCE:
        return "no_driving_force"
    if limit.outcome is Outcome.LIFTED:
        return "falls" if model.normal_rows[:, model.translations - 1].max() <= 0.0 else "lifted"
    if limit.outcome in (Outcome.NO_STRENGTH, Outcome.NO_REST) and analysis.moments_govern:
        return "topples"
    velocity = limit.velocity_of(model)
    opens = opening_pairs(limit, model, velocity, by_motion=scene.bedding is not None)
    partly = [bool(opens[scene.pairs.interface == joint].any()) for joint in interfaces]
    wholly = [bool(opens[scene.pairs.interface == joint].all()) for joint in interfaces]
    moving, turning = velocity[: model.translations], velocity[model.translations :]
    if any(p and not w for p, w in zip(partly, wholly, strict=True)) or float(turning @ turning) > float(
        moving @ moving
    ):
        return "rotates"
    if moving[-1] > _NEARLY_NONE:
        return "slides_up"
    if len(interfaces) == 1:
        return "slides_on_J1"
    if len(interfaces) > 2:
        return _slides_on(limit, scene, interfaces, wholly)
    if any(wholly):
        return "slides_on_J2" if wholly[0] else "slides_on_J1"
    return "slides_on_both"


def _slides_on(limit: Limit, scene: ContactModel, interfaces: Sequence[int], opens: Sequence[bool]) -> str:
    """On which of three joints a block slides: on the two that carry most, where none of them opens."""
    closed = [joint for joint, is_open in zip(interfaces, opens, strict=True) if not is_open]
    carried = {joint: float(limit.normal_force[scene.pairs.interface == joint].sum()) for joint in closed}
    two = sorted(carried, key=lambda joint: -carried[joint])[:2]
    return "slides_on_" + "_and_".join(_OF_THREE[joint] for joint in closed if joint in two)


def turns_over(limit: Limit, model: Model) -> str:
    """At which strengths a block that topples does so, in words.

    Where the motion opens pairs and makes none slip, neither normal forces nor friction do work against the loads:
    there is no balance at any friction (virtual work), and what opens has lost its cohesion.
    """
    if limit.outcome is Outcome.NO_REST:
        from slopekit.preie.one_block.cracked import STRONGEST

        return f"at every strength tried (up to {STRONGEST:g} times what forces in balance need)"
    velocity = limit.velocity_of(model)
    opening, slip = model.relative(velocity)[:, 0], model.slip(velocity)
    none = _NEARLY_NONE * float(np.abs(opening).max())
    freely = slip.max() <= none and opening.min() >= -none and float(model.load @ velocity) > 0.0
    return "whatever the strength" if freely and not len(model.bolt_capacity) else "and no strength is called on"


def forces_of(made: Cut, solved: Solved, water: Mapping[str, float], driven: bool = True) -> Forces:
    """Weight, normal force on each joint at the limit, water, and if `driven` what drives along the movement."""
    normal: dict[str, float | None] = {}
    for interface in made.interfaces:
        on = solved.scene.pairs.interface == interface.key
        carried = float(solved.limit.normal_force[on].sum() * solved.scene.model.force_scale)
        normal[interface.name] = None if solved.limit.outcome is Outcome.NOT_CONVERGED else carried
    along = _driving_and_resisting(solved) if driven else (None, None)
    return Forces(float(-made.loads.parts["weight"][2]), normal, water, *along)


def _driving_and_resisting(solved: Solved) -> tuple[float | None, float | None]:
    """What drives along the movement of the forces alone and what resists it (kN)."""
    model, alone = solved.scene.model, solved.analysis.forces_only
    if alone.factor is None or model.dilates:  # a dilating joint works on the load as it opens
        return None, None
    along = alone.velocity[: model.translations]
    driving = float(model.load[: model.translations] @ along) / math.sqrt(float(along @ along)) * model.force_scale
    return driving, driving * alone.factor


def water_forces(loads: Loads, names: Mapping[int, str]) -> dict[str, float]:
    """Size (kN) of the water's push on each face."""
    pushes = {name: loads.parts.get(f"water {face}", np.zeros(3)) for face, name in names.items()}
    return {name: math.sqrt(float(push @ push)) for name, push in pushes.items()}
