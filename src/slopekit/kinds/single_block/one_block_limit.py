"""One block in arrays, cut and loaded, and its limit: on flat joints and, on its node pairs, on a curved surface.

On flat joints it is the lower of that of the forces alone and that of the block on its elastic bed (`flat_limit` of
`preie`); where the bed settles it, the points of the bed are the node pairs of the result.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from slopekit.block_scene import CLOSED, OPEN, SLIP, SLIPS, STICK, Arrows, NodePairState
from slopekit.core.arrays import Bools, Floats, NDArray, frozen
from slopekit.core.progress import Clock
from slopekit.design.parts import Strength
from slopekit.evidence import Movement, ReductionStep
from slopekit.extents import Geometry
from slopekit.geometry.interfaces import BEDROCK, NodePairs
from slopekit.geometry.polytopes import Block
from slopekit.kinds.single_block.held_bolts import Bounds
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.loads import Loads
from slopekit.preie.motion.equilibrium import Equilibrium, equilibrium
from slopekit.preie.one_block.bed_limits import BedLimits
from slopekit.preie.one_block.flat_limit import (
    FlatLimit,
    factor_on_pressed,
    flat_limit,
    forces_limit,
)
from slopekit.preie.one_block.limit import LimitAnalysis, governing_limit
from slopekit.preie.one_block.polygon_bed import Beds, PointForces
from slopekit.preie.outcome import Limit, Outcome, opens
from slopekit.preie.system.contact import JointStiffness
from slopekit.preie.system.model import Model, build_model, local_axes

_LEAST_RISE = 1e-6  # of a unit motion: a larger rise is sliding up
#: Joints that a block slides on, by the sum of 1 for J1, 2 for J2, 4 for a basal joint; of two, the same but for 3.
_JOINTS = ("J2", "J1", "J2", "J1_and_J2", "basal", "J1_and_basal", "J2_and_basal")


@dataclass(frozen=True)
class Bedding:
    """The flat contacts of a block, on which other node pairs can be placed.

    Attributes
    ----------
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) of the block
    model_of : the model on other node pairs
    """

    polygons: Mapping[int, Floats]
    centroid: Floats
    model_of: Callable[[NodePairs], Model]

    @property
    def size_m(self) -> float:
        """The root mean square distance of the corners from the centroid, m."""
        arms = np.concatenate(list(self.polygons.values())) - self.centroid
        return math.sqrt(float((arms * arms).sum()) / len(arms))

    def scene(self, pairs: NodePairs) -> "ContactModel":
        """Return the contact model of node pairs on these contacts."""
        return ContactModel(pairs, self.model_of(pairs), self)


@dataclass(frozen=True)
class ContactModel:
    """Node pairs and the model made of them; `bedding` where the contacts are flat."""

    pairs: NodePairs
    model: Model
    bedding: Bedding | None = None


def bedding_on(
    polygons: Mapping[int, Floats],
    loads: Loads,
    centroid: Floats,
    strengths: Sequence[Strength],
    in_section: bool,
) -> Bedding:
    """Return the flat contacts of a block under loads; `in_section`: contacts are lines, motion is in the section."""
    strength = joint_strength(strengths)
    return Bedding(
        polygons,
        centroid,
        lambda pairs: build_model(pairs, loads, centroid, strength, in_section=in_section),
    )


def opening_pairs(limit: Limit, model: Model, velocity: Floats, by_motion: bool = False) -> Bools:
    """Return which node pairs (n,) open in the mechanism beyond dilation, or (unless `by_motion`) are already open."""
    reduced = (
        model.tan_friction / limit.factor if limit.factor else np.zeros_like(model.tan_friction)
    )
    is_open = opens(model, velocity, np.minimum(model.tan_dilation, reduced))
    return is_open if by_motion else is_open | (limit.bond == 0.0)


def pair_state(
    pairs: NodePairs,
    model: Model,
    limit: Limit,
    interfaces: Sequence[int],
    origin: Floats,
    axes: Floats,
) -> NodePairState:
    """Return the node pairs of one block at the limit, in the user's axes; without a limit state they carry nothing.

    Parameters
    ----------
    interfaces : their ids, in the order of the result's joints
    origin : (3,) of the local axes; axes : (3, 3) rows are the local axes in those of the user
    """
    velocity = limit.velocity
    slip = model.slip(velocity)
    none = limit.normal_force <= CLOSED * max(float(limit.normal_force.max(initial=0.0)), 1e-300)
    opened = (opening_pairs(limit, model, velocity) if velocity.any() else none) | none
    is_known = limit.factor is not None or limit.outcome is Outcome.NO_DRIVING_FORCE
    normal = limit.normal_force * model.force_scale if is_known else np.zeros(len(pairs))
    mode = np.where(
        opened, OPEN, np.where(slip > SLIPS * max(float(slip.max()), 1e-300), SLIP, STICK)
    )
    shear = np.zeros((len(pairs), 3))
    if limit.friction is not None:
        shear = (
            np.einsum("nt,ntx->nx", limit.friction, local_axes(pairs.normals)[:, 1:])
            * model.force_scale
        )
    index = {key: k for k, key in enumerate(interfaces)}
    return NodePairState(
        frozen(pairs.points @ axes + origin),
        np.array([index[key] for key in pairs.interface.tolist()]),
        pairs.control_areas,
        frozen(pairs.normals @ axes),
        pairs.plus,
        pairs.minus,
        frozen(normal),
        frozen(shear @ axes),
        mode.astype(np.int64),
    )


def arrows(
    loads: Loads,
    names: Mapping[str, str],
    origin: Floats,
    axes: Floats,
    pulls: Floats | None = None,
) -> Arrows:
    """Return the loads on one block as arrows in the user's axes; `names` replaces the labels of some of them.

    Parameters
    ----------
    pulls : (b,) kN of the passive bolts at the limit; None where there is none, and their full capacity is given
    """
    acting = [(names.get(name, name), force, point) for name, force, point in loads.acting]
    first = len(acting) - len(loads.passive_forces)  # passive bolts come last
    for k, capacity in enumerate(loads.passive_forces):
        name, _, point = acting[first + k]
        if pulls is None:
            acting[first + k] = (f"{name}, full capacity", capacity, point)
        else:
            acting[first + k] = (
                name,
                pulls[k] * (capacity / math.sqrt(float(capacity @ capacity))),
                point,
            )
    count = len(acting)
    return Arrows(
        tuple(name for name, _, _ in acting),
        np.arange(count),
        np.zeros(count, dtype=np.int64),
        frozen(np.reshape([force for _, force, _ in acting], (count, 3)) @ axes),
        frozen(np.reshape([point for _, _, point in acting], (count, 3)) @ axes + origin),
    )


def series_of(
    model: Model,
    factors: Sequence[float],
    stiffness: JointStiffness,
    bound: float | None,
    axes: Floats,
) -> Iterator[ReductionStep]:
    """Yield the equilibrium at each strength reduction factor in turn; above the static bound there is none."""
    last_rest: Equilibrium | None = None
    count = len(model.control_area)
    for factor in factors:
        if bound is not None and factor > bound * (1.0 + 1e-7):
            yield ReductionStep(factor, False, None, count)
            continue
        state = equilibrium(model, factor, stiffness, last_rest)
        if state.is_balanced:
            last_rest = state
        movement = rigid_movement(model, state.displacement, axes) if state.is_balanced else None
        yield ReductionStep(
            factor, state.is_balanced, movement, state.failed_pairs if state.is_balanced else count
        )


def rigid_movement(model: Model, displacement: Floats, axes: Floats) -> Movement:
    """Return a displacement (u,) of the model as a movement in m and radians, in the user's axes."""
    translation, rotation = model.rigid_motion(displacement)
    return Movement(frozen(translation @ axes), frozen(rotation @ axes))


def failure_mechanism(limit: Limit, model: Model, axes: Floats) -> Movement | None:
    """Return the mechanism with a displacement of the centroid of size 1, and the rotation per m of it."""
    if (
        limit.outcome in (Outcome.NO_DRIVING_FORCE, Outcome.NOT_CONVERGED)
        or not limit.velocity.any()
    ):
        return None
    displacement, rotation = model.rigid_motion(limit.velocity)
    rotation = rotation / model.length_scale
    size = math.sqrt(float(displacement @ displacement)) or model.length_scale * math.sqrt(
        float(rotation @ rotation)
    )
    return Movement(frozen(displacement @ axes / size), frozen(rotation @ axes / size))


def motion_statuses(
    velocity: Floats, translations: int, partly: Bools, wholly: Bools, normal: Floats
) -> NDArray[np.str_]:
    """Return the statuses (n,) of blocks that slide or turn.

    Parameters
    ----------
    velocity : (n, u) unit motions, `translations` first, turns times the size of a block
    partly, wholly : (n, k) joints of which they open a part, and all of it; normal : (n, k) forces on them, or none
    """
    count, closed = len(normal[0]), ~wholly & np.isfinite(normal)
    moving, turning = (
        (motion * motion).sum(axis=1) for motion in np.split(velocity, [translations], axis=1)
    )
    pressed_most = np.where(closed, normal, -np.inf).argsort(axis=1, kind="stable")[:, ::-1][
        :, :2
    ]  # of three joints two
    names = np.array(
        [
            "slides_on_" + ("both" if count == 2 and k == 3 else joints)
            for k, joints in enumerate(_JOINTS)
        ]
    )
    joints = (2**pressed_most * np.take_along_axis(closed, pressed_most, axis=1)).sum(axis=1)
    slides = np.where(
        velocity[:, translations - 1] > _LEAST_RISE,
        "slides_up",
        names[joints if count > 1 else np.ones_like(joints)],
    )
    return np.where(partly.any(axis=1) | (turning > moving), "rotates", slides)


# -- its limit --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Interface:
    """An interface by its id in the node pairs, its name, and its strength."""

    key: int
    name: str
    strength: Strength


@dataclass(frozen=True)
class Cut:
    """A block, cut and loaded, in local axes: the input of its limit, its result and its support.

    Attributes
    ----------
    scene_at : its node pairs and their model, by how often the parts of the joints are split; `refine` times here
    interfaces : its joints; faces : names of those that water can press on
    geometry : made where a result asks for it; left_out : what is not modelled
    face : the free face that bolts go into, None where support is not looked for; bounds : the planes that they meet
    origin : (3,) what takes local coordinates back to the user's
    axes : (3, 3) rows are the local axes in those of the user
    """

    block: Block
    loads: Loads
    scene_at: Callable[[int], ContactModel]
    interfaces: Sequence[Interface]
    geometry: Callable[[], Geometry]
    left_out: Sequence[str]
    faces: Mapping[int, str] = field(default_factory=dict)
    face: int | None = None
    bounds: Bounds | None = None
    refine: int = 0
    origin: Floats = field(default_factory=lambda: np.zeros(3))
    axes: Floats = field(default_factory=lambda: np.eye(3))

    @property
    def height_m(self) -> float:
        """The height of the block from its lowest to its highest point, m."""
        return self.geometry().total_height_m

    @property
    def water_kn(self) -> dict[str, float]:
        """The thrust of the water on each face by name, kN."""
        pushes = {
            name: self.loads.components.get(f"water {face}", np.zeros(3))
            for face, name in self.faces.items()
        }
        return {name: float(np.sqrt(push @ push)) for name, push in pushes.items()}

    @property
    def joints(self) -> tuple[int, ...]:
        """The ids of the joints."""
        return tuple(interface.key for interface in self.interfaces)


@dataclass(frozen=True)
class FoundLimit:
    """The limit of a scene on the node pairs that carry it.

    Attributes
    ----------
    bounded : the plain node pairs, which static bound and displacements are asked of: finer ones hardly move the bound
    change : what finer points of the bed would do to the limit, None where it is exact or not known
    factors : of forces and bed, None on a curved surface
    openings : interface -> where the joint is pressed, in local axes; empty where the bed did not settle the limit
    on_pressed : the factor of the forces alone with the pressed part of each joint, None where that is not asked
    """

    scene: ContactModel
    bounded: ContactModel
    analysis: LimitAnalysis
    change: float | None = None
    factors: FlatLimit | None = None
    openings: dict[int, Mapping[str, Any]] = field(default_factory=dict)
    on_pressed: float | None = None

    @property
    def limit(self) -> Limit:
        """The governing limit."""
        return self.analysis.governing

    @property
    def comparable(self) -> float | None:
        """The factor on the closed form's assumptions: forces with forces, one traction a plane."""
        return self.limit.factor if self.factors is None else self.factors.forces.factor


def moment_limit(scene: ContactModel) -> FoundLimit:
    """Return the limit of one block on flat joints.

    Parameters
    ----------
    scene : with its bedding
    """
    model, bedding = scene.model, scene.bedding
    assert bedding is not None
    factors = flat_limit(model, bedding.polygons, bedding.centroid)
    forces, bed, by_forces, state = factors.forces, factors.bed, factors.by_forces, factors.state
    if factors.exact is not None:
        exact = factors.exact
        scene = replace(scene, model=_with_lines(model, exact.normal_force))
        return FoundLimit(
            scene,
            scene,
            LimitAnalysis(exact, exact, exact, False, _curved(scene.model)),
            factors=factors,
        )
    if bed is None or by_forces is None or state is None:
        return FoundLimit(
            scene, scene, LimitAnalysis(forces, forces, forces, False), factors=factors
        )
    bounded = _with_lines_at_limit(scene, factors)
    if factors.factor is None:
        limit = Limit(
            Outcome.NO_REST,
            None,
            np.zeros(model.unknowns),
            0.0 * forces.normal_force,
            forces.bond,
            0,
            0.0,
        )
        return FoundLimit(
            scene, bounded, LimitAnalysis(limit, forces, limit, True), factors=factors
        )
    point_forces = state.point_forces(bed)
    on_bed, limit = _on_bed_points(bedding, bed, state, point_forces, model)
    analysis = governing_limit(forces_limit(on_bed.model, by_forces), limit)
    change = float(state.change[0]) if analysis.moments_govern else None
    analysis = replace(analysis, model=_curved(on_bed.model))
    openings, on_pressed = _openings(bed, state, point_forces, scene), None
    if analysis.moments_govern:
        on_pressed = factor_on_pressed(
            bed, np.array([opening["pressed_share"] for opening in openings.values()])
        )
    return FoundLimit(on_bed, bounded, analysis, change, factors, openings, on_pressed)


def _curved(model: Model) -> Model | None:
    return None if model.lines is None else model


def _on_bed_points(
    bedding: Bedding, bed: Beds, state: BedLimits, forces: PointForces, model: Model
) -> tuple[ContactModel, Limit]:
    """Return the points of the bed as node pairs, with the model on them, and the limit there."""
    keys, count = np.array(sorted(bedding.polygons))[forces.contact], len(forces.area)
    pairs = NodePairs(
        points=frozen(forces.points + bedding.centroid),
        normals=frozen(bed.axes[forces.contact, 0]),
        control_areas=frozen(forces.area * model.area_scale),
        interface=keys,
        plus=np.zeros(count, dtype=np.int64),
        minus=np.full(count, BEDROCK),
    )
    on_points = _with_lines(bedding.model_of(pairs), forces.normal)
    motion = bed.in_units_of(on_points, state.velocity[0])
    limit = Limit(
        outcome=Outcome.SLIDES,
        factor=float(state.factor[0]),
        velocity=motion / np.sqrt(motion @ motion),
        normal_force=forces.normal,
        bond=forces.pressed.astype(np.float64),
        steps=int(state.steps[0]),
        change=0.0,
        friction=forces.shear,
        pulls=forces.pulls,
    )
    return ContactModel(pairs, on_points, bedding), limit


def _openings(
    bed: Beds, state: BedLimits, forces: PointForces, scene: ContactModel
) -> dict[int, Mapping[str, Any]]:
    """Return by interface what is pressed, its force and where that acts, and the corner that opens most."""
    assert scene.bedding is not None
    openings, centroid = dict[int, Mapping[str, Any]](), scene.bedding.centroid
    gaps = bed.motions(state.displacement, 1)[:, 0]
    for k, key in enumerate(sorted(scene.bedding.polygons)):
        contact = forces.contact == k
        push, area = forces.normal[contact], forces.area[contact]
        total, pressed = float(push.sum()), float(area[forces.pressed[contact]].sum())
        corner_gaps = gaps[bed.corner[k] : bed.corner[k + 1]]
        widest = int(np.argmax(corner_gaps))
        place = (push @ forces.points[contact]) / total + centroid if total > 0.0 else None
        corner = (
            np.asarray(scene.bedding.polygons[key])[widest] if corner_gaps[widest] > 0.0 else None
        )
        openings[key] = {
            "pressed_share": pressed / float(area.sum()),
            "normal_kn": total * scene.model.force_scale,
            "resultant_m": place,
            "opens_at_m": corner,
        }
    return openings


def find_limit(cut: Cut, clock: Clock) -> FoundLimit:
    """Return the limit of a block: mesh and factor of safety, nothing else."""
    with clock("mesh"):
        scene = cut.scene_at(cut.refine)
    with clock("solve"):
        if scene.bedding is None:
            from slopekit.preie.one_block.pairs_limit import (
                pairs_limit,
            )  # only curved surfaces pay for the path

            analysis = pairs_limit(scene.model)
            scene = scene if analysis.model is None else replace(scene, model=analysis.model)
            return FoundLimit(scene, scene, analysis)
        return moment_limit(scene)


def _with_lines_at_limit(scene: ContactModel, factors: FlatLimit) -> ContactModel:
    """Return the scene with the lines of curved laws at the tractions of the limit on the bed."""
    model, bed, state = scene.model, factors.bed, factors.state
    if model.lines is None or bed is None or state is None or factors.factor is None:
        return scene
    normal = model.control_area * (
        -model.normal_rows @ bed.in_units_of(model, state.displacement[0])
    ).clip(0.0)
    return replace(scene, model=_with_lines(model, normal))


def _with_lines(model: Model, normal: Floats) -> Model:
    """Return the model with the lines of curved laws at such normal forces of its node pairs."""
    if model.lines is None:
        return model
    from slopekit.preie.system.strength_lines import with_secants  # only curved laws pay for it

    return with_secants(model, normal)
