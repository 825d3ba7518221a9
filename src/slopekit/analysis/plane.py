"""Plane failure per metre of slope: from its design to its result."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from slopekit.analysis.scene import Bedding, Scene
from slopekit.analysis.secants import changed_laws, on_secants
from slopekit.analysis.stages import (
    Clock,
    ClosedForm,
    block_status,
    bolt_forces,
    driving_and_resisting,
    joint_strength,
    normal_forces,
    point_force,
    result,
    solve,
    water_forces,
)
from slopekit.arrays import Floats, frozen
from slopekit.closed_form.plane import ClosedFormPlane, plane_failure
from slopekit.design.common import Strength, Water
from slopekit.design.kinds import PlaneDesign
from slopekit.errors import Fault, GeometryError, Notice
from slopekit.extents import SectionGeometry
from slopekit.geometry.section import CRACK, J1, Section, line_pairs, plane_section
from slopekit.loads import Loads, PointForce, block_loads, check_bolt
from slopekit.notices import Interface
from slopekit.orientation import Line, Plane, number
from slopekit.preie.model import build_model
from slopekit.result import Forces, Result

WIDEST_DEG = 20.0  # degrees between the strikes of plane and face (Hoek & Bray 1981, ch. 7)
_STATUSES = {"slides": "slides_on_J1"}
_OUT = 1e-9


def analyse_plane(design: PlaneDesign) -> Result:
    """Cut the section, load it, find its factor of safety twice, and compare.

    Raises
    ------
    GeometryError
        Where the plane forms no block that can slide out; E213 where it strikes across the slope.
    """
    clock = Clock()
    with clock("cut"):
        section = _section(design)
        loads = _loads(design, section)
    with clock("closed_form"):
        closed = _closed_form(design, section)
    with clock("governs"):
        governs = _governs(design)
    solved = solve(design, lambda refine: _scene(design, section, loads, refine), design.refine, clock)
    status = block_status(solved.limit, solved.analysis, solved.scene, (J1,))
    name = design.joint_name
    faces = {J1: name} | ({CRACK: "crack"} if section.crack_depth is not None else {})
    forces = Forces(
        float(-loads.parts["weight"][2]), normal_forces(solved, {J1: name}), water_forces(loads, faces),
        *driving_and_resisting(solved),
    )  # fmt: skip
    why_not = "the closed form knows no dilation: it is printed, not compared" if design.strength.dilation_deg else ""
    against = ClosedForm(closed.factor, _STATUSES.get(closed.status, closed.status), why_not)
    left_out = ["bedrock (no unknowns)", "face and upper slope (free)", "the ends of the slope (per metre)",
                "deformation of the rock"]  # fmt: skip
    left_out += ["contact across the tension crack"] if section.crack_depth is not None else []
    if design.strength.tension_kpa:
        left_out.append("tensile strength at the limit (it is lost where a joint opens)")
    return result(
        design, solved, status, against, section_geometry(section, name, _axes(design.face)), forces,
        [Interface(J1, name, design.strength)], left_out, clock, extra=_notices(design), loads=loads,
        governs=governs, turn=_axes(design.face), wet=faces,
    )  # fmt: skip


def prepare(design: PlaneDesign, refine: int) -> Scene:
    """The stages before the solver, from a design to its node pairs and its model.

    Parameters
    ----------
    refine : how often the plane's parts are halved
    """
    return scenes(design)(refine)


def scenes(design: PlaneDesign) -> Callable[[int], Scene]:
    """The stages before the solver, as `prepare`: cut and loaded once, for any number of parts."""
    section = _section(design)
    loads = _loads(design, section)
    return lambda refine: _scene(design, section, loads, refine)


def section_of(design: PlaneDesign) -> Section:
    """The section of the block. Raises GeometryError where the plane forms none that can slide out."""
    return _section(design)


def closed_form(design: PlaneDesign, section: Section) -> ClosedFormPlane:
    """The design by Hoek & Bray's plane failure."""
    return _closed_form(design, section)


def _scene(design: PlaneDesign, section: Section, loads: Loads, refine: int) -> Scene:
    return section_bedding(section, loads, design.strength).scene(line_pairs(section, 2**refine))


def section_bedding(section: Section, loads: Loads, given: Strength) -> Bedding:
    """The plane of a section as the bed of the block on it."""
    strength, centroid = joint_strength([given]), section.block.centroid
    return Bedding(
        {J1: np.array([np.zeros(3), section.bottom])}, centroid,
        lambda pairs: build_model(pairs, loads, centroid, strength, in_section=True),
    )  # fmt: skip


def section_geometry(section: Section, name: str, axes: Floats | None = None) -> SectionGeometry:
    """The geometry of a block in its section; `axes` (3, 3) rows are its axes in those of the user."""
    areas = {name: section.length}
    if section.crack_depth is not None:
        areas["crack"] = section.crack_depth
    height = float(np.ptp(section.outline[:, 1]))
    return SectionGeometry(
        section.block.volume, height, areas, section.outline, frozen(section.block.centroid[[0, 2]]),
        section.crack_depth, section.crack_distance, frozen(np.eye(3) if axes is None else axes),
    )  # fmt: skip


def _signed_dip(plane: Plane, face: Plane) -> float:
    """Dip, positive where the plane dips the way of the face."""
    same = math.cos(math.radians(plane.dip_direction_deg - face.dip_direction_deg)) >= 0.0
    return plane.dip_deg if same else -plane.dip_deg


def _section(design: PlaneDesign) -> Section:
    for name, plane in ((design.joint_name, design.joint), ("the upper slope", design.upper)):
        apart = _strikes_apart(plane, design.face)
        if apart > WIDEST_DEG and plane.dip_deg > 0.0:
            message = f"{name} strikes {apart:.1f}° from the face: plane failure needs {WIDEST_DEG:.0f}° or less"
            advice = "With a second joint it may form a wedge: kind: wedge."
            raise GeometryError([Fault("E213", message, "", advice)])
    crack = design.crack
    return plane_section(
        _signed_dip(design.joint, design.face), design.face.dip_deg, _signed_dip(design.upper, design.face),
        design.height_m, crack.depth_m if crack else None, crack.distance_m if crack else None,
    )  # fmt: skip


def _strikes_apart(plane: Plane, face: Plane) -> float:
    apart = abs(plane.dip_direction_deg - face.dip_direction_deg) % 180.0
    return min(apart, 180.0 - apart)


def _axes(face: Plane) -> Floats:
    """Rows: out of the slope, along it, up, in east, north, up."""
    out = Line(face.dip_direction_deg, 0.0).vector()
    up = np.array([0.0, 0.0, 1.0])
    return np.array([out, np.cross(up, out), up])


def _water(design: PlaneDesign, section: Section) -> tuple[dict[str, PointForce], float, float]:
    """The pushes on the plane and the crack; the water's height in the crack; the peak on a plane without one."""
    water, depth = design.water, section.crack_depth
    along = section.bottom / section.length
    up = np.array([along[2], 0.0, -along[0]])
    if water.mode == "pressures":
        pressures = water.pressures_kpa
        pushes = {f"water {J1}": PointForce(pressures[0] * section.length * up, section.bottom / 2.0)}
        if depth is not None and len(pressures) > 1:
            middle = section.bottom + np.array([0.0, 0.0, depth / 2.0])
            pushes[f"water {CRACK}"] = PointForce(np.array([pressures[1] * depth, 0.0, 0.0]), middle)
        return pushes, 0.0, 0.0
    weight = design.water_unit_weight_kn_m3
    if depth is None:
        peak = water.fill * weight * float(np.ptp(section.outline[:, 1])) / 2.0
        push = PointForce(0.5 * peak * section.length * up, section.bottom / 2.0)
        return ({f"water {J1}": push} if peak else {}), 0.0, peak
    deep = _water_depth(design, depth)
    if not deep:
        return {}, 0.0, 0.0
    thrust = PointForce(
        np.array([0.5 * weight * deep * deep, 0.0, 0.0]), section.bottom + np.array([0.0, 0.0, deep / 3.0])
    )
    uplift = PointForce(0.5 * weight * deep * section.length * up, section.bottom * (2.0 / 3.0))
    return {f"water {J1}": uplift, f"water {CRACK}": thrust}, deep, 0.0


def _water_depth(design: PlaneDesign, depth: float) -> float:
    given = design.crack.water_m if design.crack else None
    if given is None:
        return design.water.fill * depth
    if given > depth * (1.0 + 1e-9):
        message = f"the water stands {given:.6g} m deep in a crack of {depth:.6g} m"
        raise GeometryError([Fault("E207", message, "", "Give at most the depth of the crack.")])
    return given


def _seismic(design: PlaneDesign) -> float:
    """The coefficient out of the slope."""
    trend = design.seismic.trend_deg
    turned = 0.0 if trend is None else math.radians(trend - design.face.dip_direction_deg)
    return design.seismic.coefficient * math.cos(turned)


def _loads(design: PlaneDesign, section: Section) -> Loads:
    axes, origin = _axes(design.face) * [[1.0], [0.0], [1.0]], np.zeros(3)  # where along the slope says nothing
    active, passive = bolt_forces(
        design, origin,
        lambda name, head, way, length, where: check_bolt(section.block, name, head, way, length, (J1,), where), axes,
    )  # fmt: skip
    return block_loads(
        section.block, design.unit_weight_kn_m3, {}, np.array([_seismic(design), 0.0, 0.0]),
        [point_force(force, origin, axes) for force in design.forces], active,
        [bolt for bolt in passive if float(np.abs(bolt.force).max()) > _OUT * _strongest(design)],
        _water(design, section)[0],
    )  # fmt: skip


def _strongest(design: PlaneDesign) -> float:
    return max(bolt.force_kn for bolt in design.bolts)


def _closed_form(design: PlaneDesign, section: Section) -> ClosedFormPlane:
    _, deep, peak = _water(design, section)
    axes = _axes(design.face)

    def in_plane(vector: Floats) -> tuple[float, float]:
        local = axes @ vector
        return float(local[0]), float(local[2])

    pressures = design.water.pressures_kpa if design.water.mode == "pressures" else ()
    forces = [in_plane(np.array(force.components_kn)) for force in design.forces]
    if len(pressures) > 1 and section.crack_depth is not None:
        forces.append((pressures[1] * section.crack_depth, 0.0))
    forces += [in_plane(b.force_kn * b.toward.vector()) for b in design.bolts if b.acts == "active"]

    def of(strengths: Sequence[Strength]) -> ClosedFormPlane:
        return plane_failure(
        design.face.dip_deg, _signed_dip(design.upper, design.face), _signed_dip(design.joint, design.face),
        design.height_m, strengths[0].cohesion_kpa, strengths[0].friction_angle_deg, design.unit_weight_kn_m3,
        crack_distance_m=section.crack_distance, water_in_crack_m=deep,
        water_unit_weight_kn_m3=design.water_unit_weight_kn_m3,
        mean_pressure_kpa=pressures[0] if pressures else None, plane_water_peak_mid_kpa=peak,
        seismic=_seismic(design), forces=forces,
        passive=[in_plane(b.force_kn * b.toward.vector()) for b in design.bolts if b.acts == "passive"],
    )  # fmt: skip

    return on_secants([design.strength], of, lambda found: [found.normal_kn / found.length_m])[0]


def _governs(design: PlaneDesign) -> tuple[tuple[str, float | None, str], ...]:
    """What a few changes of the input do to the closed form."""
    strength, found = design.strength, list[tuple[str, float | None, str]]()
    changes = []
    if design.water.mode == "dry" or design.water.fill < 1.0:
        crack = None if design.crack is None else replace(design.crack, water_m=None)
        changes.append(("full water", replace(design, water=Water("full", 1.0), crack=crack)))
    changes += [(name, replace(design, strength=other)) for name, other in changed_laws(strength)]
    if strength.law is None and strength.friction_angle_deg < 88.0:
        steeper = replace(strength, friction_angle_deg=strength.friction_angle_deg + 1.0)
        changes.append(("φ +1°", replace(design, strength=steeper)))
    if strength.law is None and strength.cohesion_kpa:
        firmer = replace(strength, cohesion_kpa=strength.cohesion_kpa * 1.1)
        changes.append(("c +10 %", replace(design, strength=firmer)))
    if design.joint.dip_deg <= 89.0:
        dipping = replace(design.joint, dip_deg=design.joint.dip_deg + 1.0)
        changes.append((f"dip of {design.joint_name} +1°", replace(design, joint=dipping)))
    for name, changed in changes:
        try:
            answer = _closed_form(changed, _section(changed))
        except GeometryError:
            found.append((name, None, "no block"))
            continue
        found.append((name, answer.factor, _STATUSES.get(answer.status, answer.status)))
    return tuple(found)


def _notices(design: PlaneDesign) -> tuple[Notice, ...]:
    found = []
    for name, plane in ((design.joint_name, design.joint), ("the upper slope", design.upper)):
        apart = _strikes_apart(plane, design.face)
        if apart > _OUT and plane.dip_deg > 0.0:
            message = f"{name} strikes {number(round(apart, 1))}° from the face: taken as parallel to it"
            found.append(Notice("W321", message))
    if design.seismic.coefficient and abs(_seismic(design)) < design.seismic.coefficient * (1.0 - 1e-6):
        share = _seismic(design) / design.seismic.coefficient * 100
        message = (
            f"the seismic load acts off the section: {share:.0f} % of it acts out of the slope, the rest is left out"
        )
        found.append(Notice("W323", message))
    along = _axes(design.face)[1]
    aside = [bolt.toward.vector() @ along for bolt in design.bolts]
    aside += [np.array(force.components_kn) @ along / np.linalg.norm(force.components_kn) for force in design.forces
              if any(force.components_kn)]  # fmt: skip
    most = max((abs(float(part)) for part in aside), default=0.0)
    if most > 1e-6:
        message = f"bolts or forces act along the slope (up to {most * 100:.0f} % of one): that part is left out"
        found.append(Notice("W323", message))
    return tuple(found)
