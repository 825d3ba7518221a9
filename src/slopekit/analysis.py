"""From a design to a result: the only module that knows the order of the stages."""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from slopekit.arrays import Floats, frozen
from slopekit.closed_form.wedge import ClosedFormWedge, WedgeWater, hoek_bray_wedge
from slopekit.design.wedge import Force, WedgeDesign
from slopekit.errors import GeometryError
from slopekit.geometry.cutting import Block, cut_wedge
from slopekit.geometry.interfaces import NodePairs, node_pairs
from slopekit.geometry.rockmass import CRACK, J1, J2, PLANE_NAMES, RockMass, wedge_rock_mass
from slopekit.loads import Loads, PointForce, WaterPressure, block_loads, check_bolt
from slopekit.notices import MESH_CHANGE, notices
from slopekit.orientation import Line, Plane, line_of
from slopekit.preie.bound import static_bound
from slopekit.preie.contact import CloughDuncan, JointStiffness
from slopekit.preie.equilibrium import equilibrium
from slopekit.preie.limit import Limit, LimitAnalysis, Outcome, limit_analysis
from slopekit.preie.model import JointStrength, Model, build_model
from slopekit.preie.reduction import all_pairs_failed
from slopekit.result import (
    AllPairs,
    AtFactorOne,
    FactorsOfSafety,
    ModelSize,
    Movement,
    NodePairState,
    WedgeForces,
    WedgeGeometry,
    WedgeResult,
)  # fmt: skip

JOINTS = ((J1, "J1"), (J2, "J2"))
_MOST_REFINED = 3
_TURNS = 1e-5  # opening beyond this part of the slip counts as opening
_NEARLY_NONE = 1e-6


def analyse_wedge(design: WedgeDesign) -> WedgeResult:
    """Cut the wedge, load it, find its factors of safety twice, and compare them.

    Raises
    ------
    GeometryError
        Where the planes cut no such wedge.
    """
    clock = _Clock()
    with clock("cut"):
        rock = _rock_mass(design)
        block = cut_wedge(rock)
        loads = _loads(design, rock, block)
    with clock("closed_form"):
        closed = closed_form(design)
        governs = _governs(design, closed)
    with clock("mesh"):
        scene = _scene(design, block, loads, design.refine)
    with clock("solve"):
        analysis = limit_analysis(scene.model)
    scene, analysis, refined, change = _refine_where_needed(design, block, loads, scene, analysis, clock)
    limit, model = analysis.governing, scene.model
    with clock("bound"):
        bound, proved = None, False
        if limit.factor:
            found = static_bound(model, limit.velocity_of(model), limit.factor)
            bound, proved = found.factor, found.proved
    stiffness = _stiffness(design)
    with clock("displacements"):
        at_rest = None
        if limit.outcome is Outcome.NO_DRIVING_FORCE or (limit.factor is not None and limit.factor > 1.0):
            at_rest = equilibrium(model, 1.0, stiffness)
    pairs = None
    with clock("all_pairs"):
        if design.criterion == "all-pairs" and limit.factor:
            pairs = all_pairs_failed(model, stiffness)

    searched = pairs.factor if pairs else None
    if pairs and searched and limit.factor and pairs.lost_equilibrium and searched < 0.98 * limit.factor:
        searched = None  # equilibrium was lost on the elastic bed before the last pair failed: no such factor
    status = _status(limit, analysis, scene)
    alone = analysis.forces_only.factor
    compared = alone if analysis.moments_govern or limit.outcome is Outcome.NOT_CONVERGED else limit.factor
    difference, agree = _compare(compared, status, closed, design)
    factors = FactorsOfSafety(limit.factor or None, closed.factor or None, bound, searched)
    warnings = tuple(
        notices(design, status, analysis, scene.pairs, scene.model, proved or not limit.factor, change,
                at_rest is not None and not at_rest.stands)
    )  # fmt: skip
    return WedgeResult(
        design=design, status=status, fos=factors, difference=difference, agree=agree,
        moments_govern=analysis.moments_govern, forces_only=alone, static_bound_proved=proved,
        geometry=_geometry(design, rock, block), forces=_forces(analysis, scene, block, loads, rock),
        model=ModelSize(
            1, model.unknowns, len(scene.pairs), refined, change, _left_out(design, block), limit.passes, limit.change
        ),
        mechanism=_movement(limit, model),
        at_factor_one=None if at_rest is None or not at_rest.stands else AtFactorOne(
            Movement(frozen(at_rest.displacement[:3]), frozen(at_rest.displacement[3:])),
            at_rest.failed_pairs, at_rest.residual,
        ),
        all_pairs=None if pairs is None else AllPairs(pairs.bracket, pairs.lost_equilibrium, pairs.history),
        governs=governs, warnings=warnings,
        node_pairs=NodePairState(
            frozen(scene.pairs.points + np.array(design.origin_m)), scene.pairs.interface, scene.pairs.control_areas,
            frozen(limit.normal_force * model.force_scale),
        ),
        timing_s=clock.done(),
    )  # fmt: skip


def prepare(design: WedgeDesign, refine: int) -> "Scene":
    """The stages before the solver, from a design to its node pairs and its model.

    Parameters
    ----------
    refine : how often the triangles of the joints are split in four
    """
    rock = _rock_mass(design)
    block = cut_wedge(rock)
    return _scene(design, block, _loads(design, rock, block), refine)


class _Clock:
    """Times by stage; wall clock, and nothing else depends on it."""

    def __init__(self) -> None:
        self.times: dict[str, float] = {}
        self.began = time.perf_counter()

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        self.times[stage] = self.times.get(stage, 0.0) + time.perf_counter() - began

    def done(self) -> dict[str, float]:
        return self.times | {"total": time.perf_counter() - self.began}


@dataclass(frozen=True, slots=True)
class Scene:
    """Node pairs and the model made of them."""

    pairs: NodePairs
    model: Model


def _rock_mass(design: WedgeDesign) -> RockMass:
    joints = np.array([plane.normal() for plane in design.joints])
    crack = design.crack
    return wedge_rock_mass(
        joints, design.face.normal(), design.upper.normal(), design.height_m,
        crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip


def _scene(design: WedgeDesign, block: Block, loads: Loads, refine: int) -> Scene:
    pairs = node_pairs({joint: block.faces[joint] for joint, _ in JOINTS}, refine)
    strength = JointStrength(
        np.array(design.cohesion_kpa), np.tan(np.radians(design.friction_angle_deg)),
        np.tan(np.radians(design.dilation_deg)), np.array(design.tension_kpa),
    )  # fmt: skip
    return Scene(pairs, build_model(pairs, loads, block.centroid, strength))


def _refine_where_needed(
    design: WedgeDesign, block: Block, loads: Loads, scene: Scene, analysis: LimitAnalysis, clock: "_Clock"
) -> tuple[Scene, LimitAnalysis, int, float | None]:
    """Split the triangles while moments govern and the limit still moves, or where the passes did not settle.

    A plain wedge never comes here.
    """
    refined, change = design.refine, None
    while refined < _MOST_REFINED:
        before = analysis.governing
        if before.settled and not (analysis.moments_govern and before.factor):
            break
        with clock("mesh"):
            finer = _scene(design, block, loads, refined + 1)
        with clock("solve"):
            again = limit_analysis(finer.model)
        after = again.governing
        change = abs(after.factor / before.factor - 1.0) if after.factor and before.factor else None
        if before.settled and not after.settled:
            break  # the coarser answer stands, and `change` says what the finer one made of it
        scene, analysis, refined = finer, again, refined + 1
        if change is not None and change < MESH_CHANGE:
            break
    return scene, analysis, refined, change


def _loads(design: WedgeDesign, rock: RockMass, block: Block) -> Loads:
    line = line_of(rock.line_of_intersection)
    trend = line.trend_deg if design.seismic.trend_deg is None else design.seismic.trend_deg
    seismic = design.seismic.coefficient * Line(trend, 0.0).vector()
    origin = np.array(design.origin_m)
    active: list[PointForce] = []
    passive: list[PointForce] = []
    for k, bolt in enumerate(design.bolts, 1):
        direction = bolt.toward.vector()
        head = None if bolt.head_m is None else np.array(bolt.head_m) - origin
        if head is not None:
            check_bolt(block, f"bolt {k}", head, direction, bolt.length_m, (J1, J2))
        (active if bolt.acts == "active" else passive).append(PointForce(bolt.force_kn * direction, head))
    return block_loads(
        block, design.unit_weight_kn_m3, _water(design, rock, block), seismic,
        [_point_force(force, origin) for force in design.forces], active, passive,
    )  # fmt: skip


def _point_force(force: Force, origin: Floats) -> PointForce:
    return PointForce(np.array(force.components_kn), None if force.at_m is None else np.array(force.at_m) - origin)


def _water(design: WedgeDesign, rock: RockMass, block: Block) -> dict[int, WaterPressure]:
    """Water on the joints and the crack: Hoek & Bray's pyramid, or the mean pressures that the user gave."""
    water, faces = design.water, [J1, J2] + ([CRACK] if CRACK in block.faces else [])
    if water.mode == "dry":
        return {}
    if water.mode == "pressures":
        return {face: WaterPressure(p) for face, p in zip(faces, water.pressures_kpa, strict=False) if p}
    if CRACK in block.faces:
        # mean γ_w h₅/3, highest where the crack meets the line of intersection, h₅ below the upper slope
        bottom = rock.back * float(rock.offsets[CRACK] / (rock.normals[CRACK] @ rock.back))
        depth = float((rock.offsets[3] - rock.normals[3] @ bottom) / rock.normals[3][2])
        return {
            face: WaterPressure(water.fill * design.water_unit_weight_kn_m3 * depth / 3.0, bottom) for face in faces
        }
    # mean γ_w H/6, highest halfway along the line of intersection
    mean = water.fill * design.water_unit_weight_kn_m3 * float(np.ptp(block.corners[:, 2])) / 6.0
    return {face: WaterPressure(mean, (rock.toe + rock.back) / 2.0) for face in faces}


def _stiffness(design: WedgeDesign) -> JointStiffness:
    law = design.stiffness.shear_kn_m3
    tangential = CloughDuncan(water_unit_weight=design.water_unit_weight_kn_m3) if law is None else law
    return JointStiffness(normal=design.stiffness.normal_kn_m3, tangential=tangential)


# -- the closed form ----------------------------------------------------------------------------------


def closed_form(design: WedgeDesign) -> ClosedFormWedge:
    """The design by Hoek & Bray's wedge."""
    water = WedgeWater(design.water.fill, design.water.pressures_kpa, design.water_unit_weight_kn_m3)
    active, passive = (
        [(bolt.force_kn * bolt.toward.vector()).tolist() for bolt in design.bolts if bolt.acts == acts]
        for acts in ("active", "passive")
    )
    return hoek_bray_wedge(
        design.joints, design.face, design.upper, design.height_m, design.cohesion_kpa, design.friction_angle_deg,
        design.unit_weight_kn_m3, water=water, crack=design.crack.plane if design.crack else None,
        crack_distance=design.crack.distance_m if design.crack else 0.0,
        seismic=(design.seismic.coefficient, design.seismic.trend_deg),
        forces=[*(force.components_kn for force in design.forces), *active], passive=passive,
    )  # fmt: skip


def _governs(design: WedgeDesign, closed: ClosedFormWedge) -> tuple[tuple[str, float | None, str], ...]:
    """What a few changes of the input do to the closed form: (change, factor of safety, status)."""
    changes: list[tuple[str, WedgeDesign]] = []
    if design.water.mode == "dry" or (design.water.mode == "full" and design.water.fill < 1.0):
        changes.append(
            ("full water", replace(design, water=replace(design.water, mode="full", fill=1.0, pressures_kpa=())))
        )
    phi, c = design.friction_angle_deg, design.cohesion_kpa
    if max(phi) < 88.0:
        changes.append(("φ +1°", replace(design, friction_angle_deg=(phi[0] + 1.0, phi[1] + 1.0))))
    if any(c):
        changes.append(("c +10 %", replace(design, cohesion_kpa=(c[0] * 1.1, c[1] * 1.1))))
    for k, joint in enumerate(design.joints):
        if joint.dip_deg <= 89.0:
            steeper = Plane(joint.dip_deg + 1.0, joint.dip_direction_deg)
            joints = (steeper, design.joints[1]) if k == 0 else (design.joints[0], steeper)
            changes.append((f"dip of J{k + 1} +1°", replace(design, joints=joints)))
    found: list[tuple[str, float | None, str]] = []
    for name, changed in changes:
        try:
            _rock_mass(changed)
            answer = closed_form(changed)
        except GeometryError:
            found.append((name, None, "no wedge"))
            continue
        found.append((name, answer.factor, answer.status))
    return tuple(found)


def _compare(
    factor: float | None, status: str, closed: ClosedFormWedge, design: WedgeDesign
) -> tuple[float | None, bool | None]:
    """Relative difference of the two methods on the same assumptions, and whether they agree."""
    if any(design.dilation_deg):
        return None, None
    if status == "not_converged":
        return None, False
    if not factor and not closed.factor:
        factor = None  # no strength at all: a status on both sides, no number (UX.md rule 2)
    if factor is None or closed.factor is None:
        return None, factor is None and not closed.factor and (status == closed.status or status == "topples")
    if closed.factor == 0.0:
        return None, False
    difference = abs(factor / closed.factor - 1.0)
    return difference, difference <= design.agree_within


# -- reading the answer -------------------------------------------------------------------------------


def _status(limit: Limit, analysis: LimitAnalysis, scene: Scene) -> str:
    """The status from the mechanism: which joints stay closed, which way the wedge moves."""
    if limit.outcome is Outcome.NOT_CONVERGED:
        return "not_converged"
    if limit.outcome is Outcome.NO_DRIVING_FORCE:
        return "no_driving_force"
    if limit.outcome is Outcome.LIFTED:
        return "falls" if scene.model.normal_rows[:, 2].max() <= 0.0 else "lifted"
    if limit.outcome is Outcome.NO_STRENGTH and analysis.moments_govern:
        return "topples"
    velocity = limit.velocity_of(scene.model)
    opening, slip = scene.model.relative(velocity)[:, 0], scene.model.slip(velocity)
    if scene.model.dilates and limit.factor:  # beyond what dilation opens
        opening = opening - np.minimum(scene.model.tan_dilation, scene.model.tan_friction / limit.factor) * slip
    opens = opening > _TURNS * max(float(slip.max()), float(opening.max()))
    opens = opens | (limit.bond == 0.0)
    partly = [bool(opens[scene.pairs.interface == joint].any()) for joint, _ in JOINTS]
    wholly = [bool(opens[scene.pairs.interface == joint].all()) for joint, _ in JOINTS]
    turning, moving = velocity[3:], velocity[:3]
    if any(p and not w for p, w in zip(partly, wholly, strict=True)) or float(turning @ turning) > float(
        moving @ moving
    ):
        return "rotates"
    if moving[2] > _NEARLY_NONE:
        return "slides_up"
    if any(wholly):
        return "slides_on_J2" if wholly[0] else "slides_on_J1"
    return "slides_on_both"


def _movement(limit: Limit, model: Model) -> Movement | None:
    """The mechanism in true proportions: displacement of the centroid in m, rotation in radians, largest size 1."""
    if limit.outcome in (Outcome.NO_DRIVING_FORCE, Outcome.NOT_CONVERGED):
        return None
    velocity = limit.velocity_of(model)
    displacement, rotation = velocity[:3], velocity[3:] / model.length_scale
    size = math.sqrt(float(displacement @ displacement)) or model.length_scale * math.sqrt(float(rotation @ rotation))
    return Movement(frozen(displacement / size), frozen(rotation / size))


def _geometry(design: WedgeDesign, rock: RockMass, block: Block) -> WedgeGeometry:
    line = line_of(rock.line_of_intersection)
    origin = np.array(design.origin_m)
    back = rock.back
    if CRACK in block.faces:
        back = rock.back * float(rock.offsets[CRACK] / (rock.normals[CRACK] @ rock.back))
    corners = {"toe": rock.toe, "back": back, "crest_J1": rock.crest1, "crest_J2": rock.crest2}
    areas = {name: block.areas[joint] for joint, name in JOINTS}
    if CRACK in block.faces:
        areas["crack"] = block.areas[CRACK]
    return WedgeGeometry(
        block.volume, float(np.ptp(block.corners[:, 2])), areas, line.trend_deg, line.plunge_deg,
        math.sqrt(float(back @ back)), {name: frozen(point + origin) for name, point in corners.items()},
        frozen(block.centroid + origin),
        {PLANE_NAMES[plane]: frozen(polygon + origin) for plane, polygon in block.faces.items()},
    )  # fmt: skip


def _forces(analysis: LimitAnalysis, scene: Scene, block: Block, loads: Loads, rock: RockMass) -> WedgeForces:
    limit, model, alone = analysis.governing, scene.model, analysis.forces_only
    normal: dict[str, float | None] = {}
    for joint, name in JOINTS:
        carried = float(limit.normal_force[scene.pairs.interface == joint].sum() * model.force_scale)
        normal[name] = None if limit.outcome is Outcome.NOT_CONVERGED else carried
    water = {}
    for face, name in (*JOINTS, (CRACK, "crack")):
        if face in block.faces:
            push = loads.parts.get(f"water {face}", np.zeros(3))
            water[name] = math.sqrt(float(push @ push))
    driving = resisting = None
    if alone.factor is not None and not model.dilates:  # a dilating joint works on the load as it opens
        along = alone.velocity[:3]
        driving = float(model.load[:3] @ along) / math.sqrt(float(along @ along)) * model.force_scale
        resisting = driving * alone.factor
    return WedgeForces(float(-loads.parts["weight"][2]), normal, water, driving, resisting)


def _left_out(design: WedgeDesign, block: Block) -> tuple[str, ...]:
    left = ["bedrock (no unknowns)", "face and upper slope (free)", "deformation of the rock"]
    if CRACK in block.faces:
        left.append("contact across the tension crack")
    if any(design.tension_kpa):
        left.append("tensile strength at the limit (it is lost where a joint opens)")
    return tuple(left)
