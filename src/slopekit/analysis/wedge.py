"""One wedge: from its design to its result."""

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
from slopekit.arrays import frozen
from slopekit.closed_form.wedge import ClosedFormWedge, WedgeWater, hoek_bray_wedge
from slopekit.design.common import Strength
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import GeometryError
from slopekit.extents import WedgeGeometry
from slopekit.geometry.cutting import Block, cut_wedge
from slopekit.geometry.interfaces import node_pairs
from slopekit.geometry.rockmass import CRACK, J1, J2, PLANE_NAMES, RockMass, wedge_rock_mass
from slopekit.loads import Loads, WaterPressure, block_loads, check_bolt
from slopekit.notices import Interface, wedge_notices
from slopekit.orientation import Line, Plane, line_of
from slopekit.preie.model import build_model
from slopekit.result import Forces, Result

JOINTS = ((J1, "J1"), (J2, "J2"))
_DILATES = "the closed form knows no dilation: it is printed, not compared"


def analyse_wedge(design: WedgeDesign) -> Result:
    """Cut the wedge, load it, find its factors of safety twice, and compare them.

    Raises
    ------
    GeometryError
        Where the planes cut no such wedge.
    """
    clock = Clock()
    with clock("cut"):
        rock = _rock_mass(design)
        block = cut_wedge(rock)
        loads = _loads(design, rock, block)
    with clock("closed_form"):
        closed = closed_form(design)
    with clock("governs"):
        governs = _governs(design, closed)
    solved = solve(design, lambda refine: _scene(design, block, loads, refine), design.refine, clock)
    status = block_status(solved.limit, solved.analysis, solved.scene, (J1, J2))
    faces = {face: name for face, name in (*JOINTS, (CRACK, "crack")) if face in block.faces}
    forces = Forces(
        float(-loads.parts["weight"][2]), normal_forces(solved, dict(JOINTS)), water_forces(loads, faces),
        *driving_and_resisting(solved),
    )  # fmt: skip
    interfaces = [
        Interface(joint, name, strength) for (joint, name), strength in zip(JOINTS, design.strengths, strict=True)
    ]
    against = ClosedForm(closed.factor, closed.status, _DILATES if any(design.dilation_deg) else "")
    return result(
        design, solved, status, against, _geometry(design, rock, block), forces, interfaces,
        _left_out(design, block), clock, governs=governs, extra=tuple(wedge_notices(design)),
        to_map=np.array(design.origin_m), loads=loads, wet=faces,
    )  # fmt: skip


def scenes(design: WedgeDesign) -> Callable[[int], Scene]:
    """The stages before the solver: the wedge is cut and loaded once, the function makes its node pairs and model.

    The function takes how often the triangles of the joints are split in four.
    """
    rock = _rock_mass(design)
    block = cut_wedge(rock)
    loads = _loads(design, rock, block)
    return lambda refine: _scene(design, block, loads, refine)


def prepare(design: WedgeDesign, refine: int) -> Scene:
    """The stages before the solver, from a design to its node pairs and its model.

    Parameters
    ----------
    refine : how often the triangles of the joints are split in four
    """
    return scenes(design)(refine)


def check_forms(design: WedgeDesign) -> None:
    """Refuse planes that cut no wedge with GeometryError, as `analyse_wedge` does, without cutting one."""
    _rock_mass(design)


def _rock_mass(design: WedgeDesign) -> RockMass:
    joints = np.array([plane.normal() for plane in design.joints])
    crack = design.crack
    return wedge_rock_mass(
        joints, design.face.normal(), design.upper.normal(), design.height_m,
        crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip


def _scene(design: WedgeDesign, block: Block, loads: Loads, refine: int) -> Scene:
    polygons = {joint: block.faces[joint] for joint, _ in JOINTS}
    strength = joint_strength(design.strengths)
    bedding = Bedding(polygons, block.centroid, lambda pairs: build_model(pairs, loads, block.centroid, strength))
    return bedding.scene(node_pairs(polygons, refine))


def _loads(design: WedgeDesign, rock: RockMass, block: Block) -> Loads:
    line = line_of(rock.line_of_intersection)
    trend = line.trend_deg if design.seismic.trend_deg is None else design.seismic.trend_deg
    seismic = design.seismic.coefficient * Line(trend, 0.0).vector()
    origin = np.array(design.origin_m)
    active, passive = bolt_forces(
        design,
        origin,
        lambda name, head, way, length, where: check_bolt(block, name, head, way, length, (J1, J2), where),
    )
    return block_loads(
        block, design.unit_weight_kn_m3, _water(design, rock, block), seismic,
        [point_force(force, origin) for force in design.forces], active, passive,
    )  # fmt: skip


def _water(design: WedgeDesign, rock: RockMass, block: Block) -> dict[int, WaterPressure]:
    """Water on the joints and the crack: Hoek & Bray's pyramid, or the mean pressures that the user gave."""
    water, faces = design.water, [J1, J2] + ([CRACK] if CRACK in block.faces else [])
    if water.mode == "dry" and not water.crack_fill:
        return {}
    found: dict[int, WaterPressure] = {}
    if water.mode == "pressures":
        found = {face: WaterPressure(p) for face, p in zip(faces, water.pressures_kpa, strict=False) if p}
    if CRACK in block.faces and (water.mode == "full" or water.crack_fill is not None):
        # mean γ_w h₅/3, highest where the crack meets the line of intersection, h₅ below the upper slope
        bottom = rock.back * float(rock.offsets[CRACK] / (rock.normals[CRACK] @ rock.back))
        depth = float((rock.offsets[3] - rock.normals[3] @ bottom) / rock.normals[3][2])
        full = design.water_unit_weight_kn_m3 * depth / 3.0
        if water.mode == "full":
            found = {face: WaterPressure(water.fill * full, bottom) for face in faces}
        if water.crack_fill is not None:
            found[CRACK] = WaterPressure(water.crack_fill * full, bottom)
        return found
    if water.mode == "pressures":
        return found
    # mean γ_w H/6, highest halfway along the line of intersection
    mean = water.fill * design.water_unit_weight_kn_m3 * float(np.ptp(block.corners[:, 2])) / 6.0
    return {face: WaterPressure(mean, (rock.toe + rock.back) / 2.0) for face in faces}


# -- the closed form ----------------------------------------------------------------------------------


def closed_form(design: WedgeDesign) -> ClosedFormWedge:
    """The design by Hoek & Bray's wedge."""
    water = WedgeWater(
        design.water.fill, design.water.pressures_kpa, design.water_unit_weight_kn_m3, design.water.crack_fill
    )
    active, passive = (
        [(bolt.force_kn * bolt.toward.vector()).tolist() for bolt in design.bolts if bolt.acts == acts]
        for acts in ("active", "passive")
    )

    def of(strengths: Sequence[Strength]) -> ClosedFormWedge:
        one, two = strengths
        cohesion, friction = (one.cohesion_kpa, two.cohesion_kpa), (one.friction_angle_deg, two.friction_angle_deg)
        return hoek_bray_wedge(
        design.joints, design.face, design.upper, design.height_m, cohesion, friction,
        design.unit_weight_kn_m3, water=water, crack=design.crack.plane if design.crack else None,
        crack_distance=design.crack.distance_m if design.crack else 0.0,
        seismic=(design.seismic.coefficient, design.seismic.trend_deg),
        forces=[*(force.components_kn for force in design.forces), *active], passive=passive,
    )  # fmt: skip

    return on_secants(
        design.strengths, of, lambda found: [push / area for push, area in zip(found.normal, found.areas, strict=False)]
    )[0]


def _governs(design: WedgeDesign, closed: ClosedFormWedge) -> tuple[tuple[str, float | None, str], ...]:
    """What a few changes of the input do to the closed form: (change, factor of safety, status)."""
    changes: list[tuple[str, WedgeDesign]] = []
    if design.water.mode == "dry" or (design.water.mode == "full" and design.water.fill < 1.0):
        changes.append(
            ("full water", replace(design, water=replace(design.water, mode="full", fill=1.0, pressures_kpa=())))
        )
    phi, c = design.friction_angle_deg, design.cohesion_kpa
    first, second = design.strengths
    for k, strength in enumerate(dict.fromkeys(design.strengths), 1):
        of = "" if first == second else f" of J{k}"
        for name, other in changed_laws(strength):
            pair = [other if own == strength else own for own in (first, second)]
            changes.append((name + of, design.with_strengths(*pair)))
    straight = not any(design.laws)
    if straight and max(phi) < 88.0:
        changes.append(("φ +1°", replace(design, friction_angle_deg=(phi[0] + 1.0, phi[1] + 1.0))))
    if straight and any(c):
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


# -- reading the answer -------------------------------------------------------------------------------


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


def _left_out(design: WedgeDesign, block: Block) -> tuple[str, ...]:
    left = ["bedrock (no unknowns)", "face and upper slope (free)", "deformation of the rock"]
    if CRACK in block.faces:
        left.append("contact across the tension crack")
    if any(design.tension_kpa):
        left.append("tensile strength at the limit (it is lost where a joint opens)")
    return tuple(left)
