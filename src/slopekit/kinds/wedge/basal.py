"""A wedge with a basal joint: how it is cut, loaded and closed, and what a reader must know of it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.closed_form.basal import OUTCOMES, BasalWedgeArrays, basal_wedges
from slopekit.core.arrays import Floats, frozen
from slopekit.core.errors import GeometryError, Notice
from slopekit.core.orientation import Line, Plane, line_of
from slopekit.evidence import WithoutBasal
from slopekit.extents import WedgeGeometry
from slopekit.geometry.basal import (
    BASAL,
    CRACK,
    FACE,
    J1,
    J2,
    PLANE_NAMES,
    UPPER,
    BasalRockMass,
    basal_rock_mass,
    cut_basal_wedge,
    trace_behind,
)
from slopekit.geometry.cutting import Block
from slopekit.geometry.interfaces import node_pairs
from slopekit.kinds.closed_forms import ClosedForms
from slopekit.kinds.held_bolts import Bounds, upward
from slopekit.kinds.one_block import Cut, left_out_of_slope
from slopekit.kinds.one_block_states import Bedding
from slopekit.kinds.sizes import Crest, sizes_of_faces
from slopekit.kinds.solver_inputs import bolt_forces, joint_strength, point_force
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.kinds.words import line_in_words, size_number
from slopekit.loads import Hull, Loads, PointForce, WaterPressure, block_loads, check_bolt
from slopekit.notices import Interface
from slopekit.preie.model import build_model

if TYPE_CHECKING:
    from slopekit.kinds import ground_water

JOINTS = ((J1, "J1"), (J2, "J2"), (BASAL, "basal"))
_IDS = tuple(joint for joint, _ in JOINTS)
_ACROSS = 1e-9  # a cosine: along the strike of the face it dips neither way


def cut(design: WedgeDesign) -> Cut:
    """Cut the wedge above its basal joint and load it.

    Raises
    ------
    GeometryError
        Where the planes cut no such wedge, see `geometry.basal`.
    """
    rock = _rock_mass(design)
    block = cut_basal_wedge(rock)
    acting = _loads(design, rock, block)
    polygons = {joint: block.faces[joint] for joint in _IDS}
    strength = joint_strength(design.strengths)
    bedding = Bedding(polygons, block.centroid, lambda pairs: build_model(pairs, acting, block.centroid, strength))
    left = ["deformation of the rock", "the rock below the basal joint (it stays)"]
    return Cut(
        block, acting, lambda refine: bedding.scene(node_pairs(polygons, refine)),
        [Interface(joint, name, own) for (joint, name), own in zip(JOINTS, design.strengths, strict=True)],
        lambda: _geometry(design, rock, block), left_out_of_slope(left, CRACK in block.faces, design.strengths),
        {face: name for face, name in (*JOINTS, (CRACK, "crack")) if face in block.faces}
        | design.ponded(FACE, UPPER),
        FACE, design.refine, origin=np.array(design.origin_m),
    )  # fmt: skip


def block_of(design: WedgeDesign) -> Block:
    """The block alone. Raises GeometryError as `cut`."""
    return cut_basal_wedge(_rock_mass(design))


def crack_reach(design: WedgeDesign, crack: Plane) -> float:
    """How far from the crest along J1's trace a crack still cuts the block of a design without one, m.

    Raises
    ------
    GeometryError
        As `cut`.
    """
    rock = _rock_mass(design)
    corners = cut_basal_wedge(rock).corners
    trace, normal = trace_behind(rock), crack.normal()
    along = float(normal @ trace)
    return float(((corners - rock.crest1) @ normal / along).max()) if abs(along) > _ACROSS else 0.0


def _rock_mass(design: WedgeDesign) -> BasalRockMass:
    basal, crack = design.basal, design.crack
    assert basal is not None
    return basal_rock_mass(
        np.array([plane.normal() for plane in design.joints]), design.face.normal(), design.upper.normal(),
        design.height_m, basal.plane.normal(), basal.height_m,
        crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip


def _loads(design: WedgeDesign, rock: BasalRockMass, block: Block) -> Loads:
    given = design.seismic
    trend = design.face.dip_direction_deg if given.trend_deg is None else given.trend_deg
    origin = np.array(design.origin_m)
    hull = cache(lambda: Hull.of(block))  # which a block without bolts does not need
    active, passive = bolt_forces(
        design, origin, lambda name, head, way, length, where: check_bolt(hull(), name, head, way, length, _IDS, where)
    )
    return block_loads(
        block, design.unit_weight_kn_m3, _water(design, rock, block), given.coefficient * Line(trend, 0.0).vector(),
        [point_force(force, origin) for force in design.forces], active, passive,
        _pushes(design, rock, block),
    )  # fmt: skip


def _pushes(design: WedgeDesign, rock: BasalRockMass, block: Block) -> dict[str, PointForce]:
    if not design.is_cut_for_loads:
        return {}
    from slopekit.kinds import ground_water
    from slopekit.kinds.wedge import in_crack

    return ground_water.pushes(design, _ground(design, rock, block), in_crack(design, block, _IDS, CRACK))


def ground_of(design: WedgeDesign) -> "ground_water.LocalSlope":
    """The block in its slope, for water and surcharge on its faces."""
    rock = _rock_mass(design)
    return _ground(design, rock, cut_basal_wedge(rock))


def _ground(design: WedgeDesign, rock: BasalRockMass, block: Block) -> "ground_water.LocalSlope":
    from slopekit.kinds import ground_water

    return ground_water.LocalSlope(
        block, (*_IDS, CRACK), (FACE, UPPER), np.array([rock.outward[face] for face in (FACE, UPPER)]),
        np.array([rock.offsets[face] for face in (FACE, UPPER)]), np.eye(3),
        -Line(design.face.dip_direction_deg, 0.0).vector(), design.origin_m[2],
    )  # fmt: skip


def _water(design: WedgeDesign, rock: BasalRockMass, block: Block) -> dict[int, WaterPressure]:
    """Mean pressures, even over each joint: γ_w H/6, with a crack γ_w h₅/3 on all, or those that the user gave."""
    water, joints = design.water, list(_IDS)
    if water.mode == "table" or (water.mode == "dry" and not water.crack_fill):
        return {}
    faces = [*joints, CRACK] if CRACK in block.faces else joints
    pressures: dict[int, float] = {}
    if water.mode == "pressures":
        pressures = dict(zip(faces, water.pressures_kpa, strict=False))
    elif water.mode == "full":
        full = _full(design, rock, block) * water.fill
        pressures = dict.fromkeys(faces, full)
    if CRACK in block.faces and water.crack_fill is not None:
        pressures[CRACK] = water.crack_fill * _full(design, rock, block)
    return {face: WaterPressure(pressure) for face, pressure in pressures.items() if pressure}


def _full(design: WedgeDesign, rock: BasalRockMass, block: Block) -> float:
    if CRACK not in block.faces:
        return design.water_unit_weight_kn_m3 * float(np.ptp(block.corners[:, 2])) / 6.0
    upper = rock.outward[UPPER]
    depths = (rock.offsets[UPPER] - block.faces[CRACK] @ upper) / upper[2]
    return design.water_unit_weight_kn_m3 * float(depths.max()) / 3.0


def _geometry(design: WedgeDesign, rock: BasalRockMass, block: Block) -> WedgeGeometry:
    line, origin = line_of(rock.line), np.array(design.origin_m)
    corners = {"toe": np.zeros(3), "basal_J1": rock.basal_at, "crest_J1": rock.crest1, "crest_J2": rock.crest2}
    areas = {name: block.areas[face] for face, name in (*JOINTS, (CRACK, "crack")) if face in block.areas}
    return WedgeGeometry(
        block.volume, float(np.ptp(block.corners[:, 2])), areas, line.trend_deg, line.plunge_deg,
        _shared_edge(block.faces[J1], block.faces[J2]), {name: frozen(at + origin) for name, at in corners.items()},
        frozen(block.centroid + origin),
        {PLANE_NAMES[plane]: frozen(polygon + origin) for plane, polygon in block.faces.items()},
        sizes_of_faces({PLANE_NAMES[plane]: polygon for plane, polygon in block.faces.items()}, areas,
                       Crest(rock.crest1, design.face.normal(), design.upper.normal())),
    )  # fmt: skip


def bounds(design: WedgeDesign) -> Bounds:
    """The planes that bound the block, of one design or of one whose numbers are arrays; see `geometry.basal`."""
    basal, crack = design.basal, design.crack
    assert basal is not None
    planes = [*design.joints, basal.plane, design.face, design.upper, *([] if crack is None else [crack.plane])]
    normals = [upward(plane.dip_deg, plane.dip_direction_deg) for plane in planes]
    first, second, under, face, upper = normals[:5]
    height, low = np.atleast_1d(design.height_m), np.atleast_1d(basal.height_m)
    with np.errstate(divide="ignore", invalid="ignore"):
        traces = [np.cross(joint, face) for joint in (first, second)]
        crest1 = traces[0] * (height / traces[0][:, 2])[:, None]
        offset = _dots(upper, crest1)
        crest2 = traces[1] * (offset / _dots(upper, traces[1]))[:, None]
        below = np.where(low < 0.0, -1.0, 1.0)
        sides = [np.copysign(1.0, _dots(first, crest2)) * below, np.copysign(1.0, _dots(second, crest1)) * below]
        outward = [-sides[0][:, None] * first, -sides[1][:, None] * second, -under, face, upper]
        offsets: list[Any] = [0.0, 0.0, -_dots(under, crest1 * (low / height)[:, None]), 0.0, offset]
        if crack is not None:
            trace = np.cross(first, upper)
            trace /= (np.copysign(np.sqrt(_dots(trace, trace)), -_dots(face, trace)))[:, None]
            ahead = _dots(normals[5], trace) * crack.distance_m
            sign = np.where(ahead > 0.0, 1.0, -1.0)
            outward.append(sign[:, None] * normals[5])
            offsets.append(sign * (_dots(normals[5], crest1) + ahead))
    size = np.sqrt(np.maximum(_dots(crest1, crest1), _dots(crest2, crest2)))
    count = max(len(size), *map(len, outward), *(np.size(np.asarray(one)) for one in offsets))
    faces = np.stack([np.broadcast_to(one, (count, 3)) for one in outward])
    at = np.stack([np.broadcast_to(np.asarray(one, dtype=np.float64), count) for one in offsets]) + faces @ np.array(
        design.origin_m
    )
    return Bounds(faces, at, (0, 1, 2), (3, 4), np.broadcast_to(size, count))


def _dots(one: Floats, other: Floats) -> Floats:
    products: Floats = (one * other).sum(axis=-1)
    return products


def _shared_edge(one: Floats, other: Floats) -> float:
    """Length of the edge that two faces of a block share: their corners are the same numbers."""
    both = [np.array(corner) for corner in set(map(tuple, one.tolist())) & set(map(tuple, other.tolist()))]
    return math.sqrt(float(((both[0] - both[1]) ** 2).sum())) if len(both) == 2 else 0.0


# -- the closed form ----------------------------------------------------------------------------------


def closed_forms(arguments: Mapping[str, Any], bolts: Sequence[Sequence[float]]) -> ClosedForms:
    """Designs by the closed form of three joints; see `kinds.wedge.closed_forms`."""
    given = dict(arguments)
    del given["left_out"]  # of limits of size, which it has not
    pressures = [given.pop(name) for name in ("pressure1", "pressure2", "pressure3", "pressure5")]
    force = [given.pop(name) for name in ("force_east", "force_north", "force_up")]
    wedges = basal_wedges(
        BasalWedgeArrays(
            **given, passive_kn=bolts, pressures_kpa=() if pressures[0] is None else pressures,
            force_kn=None if force[0] is None else force,
        )
    )  # fmt: skip
    return ClosedForms(OUTCOMES, wedges.outcome, wedges.factor, list(wedges.normal_kn), list(wedges.areas_m2[:3]))


# -- words ----------------------------------------------------------------------------------------------------------


def plane_entry(design: WedgeDesign, area_m2: float, strength: str) -> str:
    """The basal joint as the sheet has it."""
    assert design.basal is not None
    plane, height = design.basal.plane, design.basal.height_m
    where = f"{abs(height):.4g} m {'above' if height >= 0.0 else 'below'} the toe along J1's trace"
    return f"basal {plane}  {plane.in_words()}, {where}  {strength}  area {size_number(area_m2)} m²"


def line_entry(geometry: WedgeGeometry) -> str:
    """The line of intersection of J1 and J2 as the sheet has it."""
    line = line_in_words(Line(geometry.line_trend_deg, geometry.line_plunge_deg))
    if not geometry.line_length_m:
        return f"line of intersection of J1 and J2 {line}, no edge of the block"
    length = size_number(geometry.line_length_m)
    return f"line of intersection of J1 and J2 {line}, {length} m of it above the basal joint"


def notices(design: WedgeDesign) -> Iterator[Notice]:
    """What a reader must know of a basal joint."""
    basal = design.basal
    assert basal is not None
    if basal.height_m < 0.0:
        yield Notice("W411", "a socket wedge: it lies below the point where J1, J2 and the face meet")
    elif (whole := without_basal(design)) is not None:
        held = "; acceptance is held against it too" if design.rules else ""
        yield Notice(
            "W410",
            "the basal joint cuts the toe off the wedge on J1 and J2, and what lies below it is taken to stay; the "
            f"whole wedge, without basal: {whole.in_words()} by the closed form{held}",
        )
    apart = math.radians(basal.plane.dip_direction_deg - design.face.dip_direction_deg)
    if basal.plane.dip_deg > 0.0 and math.cos(apart) < -_ACROSS:
        turned = Plane(basal.plane.dip_deg, (basal.plane.dip_direction_deg + 180.0) % 360.0)
        yield Notice(
            "W424",
            f"the basal joint ({basal.plane}) dips into the slope: the block does not slide out on it, it would have "
            f"to climb; is {turned} meant?",
        )
    if basal.plane.dip_deg == 0.0:
        yield Notice("W412", "the basal joint is level: on it alone nothing drives the block but other loads")


def without_basal(design: WedgeDesign) -> WithoutBasal | None:
    """What the wedge on J1 and J2 alone does by its closed form, where the basal joint cuts its toe off.

    The rock below the basal joint is part of it, and no part of the block that is analysed. None where J1 and J2 make
    no wedge that daylights, or the basal joint leaves its toe.
    """
    from slopekit.kinds.wedge import closed_form

    basal = design.basal
    if basal is None or basal.height_m < 0.0:
        return None
    if float(basal.plane.normal() @ _rock_mass(design).basal_at) <= 0.0:
        return None
    water = replace(design.water, pressures_kpa=(*design.water.pressures_kpa[:2], *design.water.pressures_kpa[3:]))
    whole = replace(design.with_strengths(design.strengths[:2]), basal=None, water=water)
    try:
        solution = closed_form(whole)
    except GeometryError:
        if whole.crack is None:
            return None
        try:  # the crack may lie behind it
            solution = closed_form(replace(whole, crack=None, water=replace(water, crack_fill=None)))
        except GeometryError:
            return None
    return WithoutBasal(solution.status, solution.factor)
