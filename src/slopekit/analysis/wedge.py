"""One wedge: from its design to its result."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from slopekit.analysis.closed_forms import Arguments, ClosedForms, answers, force_on, passive_bolts
from slopekit.analysis.scene import Bedding, Scene
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
from slopekit.closed_form.wedge import OUTCOMES, WedgeArrays, hoek_bray_wedges
from slopekit.design.common import Strength
from slopekit.design.wedge import WedgeDesign
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
        closed, governs = _closed_and_governs(design)
    solved = solve(design, lambda refine: _scene(design, block, loads, refine), design.refine, clock)
    status = block_status(solved.limit, solved.analysis, solved.scene, (J1, J2))
    faces = {face: name for face, name in (*JOINTS, (CRACK, "crack")) if face in block.faces}
    forces = Forces(
        float(-loads.parts["weight"][2]), normal_forces(solved, dict(JOINTS)), water_forces(loads, faces),
        *driving_and_resisting(solved),
    )  # fmt: skip
    interfaces = [
        Interface(joint, name, strength) for (joint, name), strength in zip(JOINTS, _strengths(design), strict=True)
    ]
    against = ClosedForm(*closed, _DILATES if any(design.dilation_deg) else "")
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


def _strengths(design: WedgeDesign) -> list[Strength]:
    parts = (design.cohesion_kpa, design.friction_angle_deg, design.dilation_deg, design.tension_kpa)
    return [Strength(*values) for values in zip(*parts, strict=True)]


def _scene(design: WedgeDesign, block: Block, loads: Loads, refine: int) -> Scene:
    polygons = {joint: block.faces[joint] for joint, _ in JOINTS}
    strength = joint_strength(_strengths(design))
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


def arguments(design: WedgeDesign) -> Arguments:
    """What Hoek & Bray's wedge is given of a design, but for its passive bolts."""
    found: Arguments = {}
    planes = {"joint1": design.joints[0], "joint2": design.joints[1], "face": design.face, "upper": design.upper}
    for name, plane in planes.items():
        found |= {f"{name}_dip_deg": plane.dip_deg, f"{name}_dip_direction_deg": plane.dip_direction_deg}
    water, crack = design.water, design.crack
    given = water.mode == "pressures"
    pressures = [*water.pressures_kpa, 0.0, 0.0, 0.0] if given else [None] * 3
    return found | force_on(design) | {
        "height_m": design.height_m, "cohesion1_kpa": design.cohesion_kpa[0], "cohesion2_kpa": design.cohesion_kpa[1],
        "friction1_deg": design.friction_angle_deg[0], "friction2_deg": design.friction_angle_deg[1],
        "unit_weight_kn_m3": design.unit_weight_kn_m3, "fill": 0.0 if given else water.fill,
        "water_unit_weight_kn_m3": design.water_unit_weight_kn_m3, "crack_fill": water.crack_fill,
        "pressure1": pressures[0], "pressure2": pressures[1], "pressure5": pressures[2],
        "crack_dip_deg": None if crack is None else crack.plane.dip_deg,
        "crack_dip_direction_deg": None if crack is None else crack.plane.dip_direction_deg,
        "crack_distance_m": 0.0 if crack is None else crack.distance_m,
        "seismic": design.seismic.coefficient, "seismic_trend_deg": design.seismic.trend_deg,
    }  # fmt: skip


def closed_forms(arguments: Mapping[str, Any], bolts: Sequence[Sequence[float]] = ()) -> ClosedForms:
    """Designs by Hoek & Bray's wedge; each of the arguments is one number for all of them or an array.

    Parameters
    ----------
    bolts : east, north and up of the passive ones
    """
    given = dict(arguments)
    pressures = [given.pop(name) for name in ("pressure1", "pressure2", "pressure5")]
    force = [given.pop(name) for name in ("force_east", "force_north", "force_up")]
    found = hoek_bray_wedges(
        WedgeArrays(
            **given, passive_kn=bolts,
            pressures_kpa=() if pressures[0] is None else pressures,
            force_kn=None if force[0] is None else force,
        ),
        forces=False,
    )  # fmt: skip
    return ClosedForms(OUTCOMES, found.outcome, found.factor)


def closed_form(design: WedgeDesign) -> ClosedForm:
    """The design by Hoek & Bray's wedge.

    Raises
    ------
    GeometryError
        Where the planes cut no wedge.
    """
    return closed_forms(arguments(design), passive_bolts(design)).of()


def _closed_and_governs(
    design: WedgeDesign,
) -> tuple[tuple[float | None, str], tuple[tuple[str, float | None, str], ...]]:
    """Factor and status by the closed form, and what a few changes of the input do to them: (change, factor, status).

    All in one call: one wedge takes as long as six.
    """
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
    bolts = passive_bolts(design)
    all_arguments = [arguments(design), *(arguments(changed) for _, changed in changes)]
    closed, *found = answers(all_arguments, partial(closed_forms, bolts=bolts), "no wedge")
    return closed, tuple((name, *answer) for (name, _), answer in zip(changes, found, strict=True))


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
