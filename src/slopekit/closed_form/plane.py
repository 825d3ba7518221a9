"""Plane failure per metre of slope, over arrays: forces only, zero dilation, cohesion only on a plane in contact.

Sources: Hoek & Bray (1981), Rock Slope Engineering, ch. 7; Wyllie & Mah (2004), Rock Slope Engineering, ch. 6.
The weight comes from the corners of the block, so that the upper slope may dip and the crack stand in the face.

Section: x out of the slope, z up, the toe at (0, 0). One block is an array of length one, as in `wedge`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Final, NamedTuple

import numpy as np

from slopekit.closed_form.inputs import (
    BlockLoads,
    Codes,
    Columns,
    Value,
    counted,
    float_columns,
    with_passive,
)
from slopekit.closed_form.tolerances import PARALLEL_DEG, SMALL
from slopekit.closed_form.wedge_sliding import (
    FALLS,
    LIFTED,
    NO_DRIVING_FORCE,
    SLIDES_ON_J1,
    SLIDES_UP,
    Vector,
    WedgeSlide,
    factor_with_bolts,
)
from slopekit.core.array_types import ArrayLike, Floats

#: Outcomes of a block: it slides, it loses contact, nothing drives it, or the plane forms none (`explain CODE`).
OUTCOMES: Final = (
    "slides",
    "slides_up",
    "lifted",
    "falls",
    "no_driving_force",
    "E203",
    "E204",
    "E205",
    "E207",
    "E209",
)
_NUMBER: Final = {name: np.int8(number) for number, name in enumerate(OUTCOMES)}
#: The outcome here of each number of a sliding mode in `wedge_sliding`.
_OUTCOME_OF_SLIDE: Final = np.array([0, 0, 0, 1, 2, 3, 4], dtype=np.int8)
_RADIAN: Final = math.pi / 180.0
_TAN: Final = np.frompyfunc(math.tan, 1, 1)


@dataclass(frozen=True, kw_only=True)
class PlaneArrays(BlockLoads):
    """Blocks on one plane that daylights at the toe, each value one number for all of them or an (n,) array.

    Attributes
    ----------
    face_dip_deg, upper_dip_deg, plane_dip_deg : positive out of the slope
    height_m : vertical, from the toe to the crest
    cohesion_kpa, friction_deg : of the plane
    crack_depth_m, crack_distance_m : of a vertical crack, one of the two, or both where they agree; the distance counts
        back from the crest (negative: in the face). Neither without a crack
    fill : part of the pressure of full water: of a crack full to the top, without a crack of γ_w H/2 at mid-length of
        the plane, where nothing stands at both ends
    water_in_crack_m : the water in the crack, instead of `fill`; U = γ_w z_w L / 2 on the plane (nothing at the toe),
        V = γ_w z_w² / 2 in the crack
    pressure_kpa, crack_pressure_kpa : mean pressures on the plane and in the crack, instead of both
    seismic : out of the slope; force_kn, passive_kn : out of the slope and up, kN/m
    """

    face_dip_deg: ArrayLike
    upper_dip_deg: ArrayLike
    plane_dip_deg: ArrayLike
    height_m: ArrayLike
    cohesion_kpa: ArrayLike
    friction_deg: ArrayLike
    crack_depth_m: ArrayLike | None = None
    crack_distance_m: ArrayLike | None = None
    water_in_crack_m: ArrayLike | None = None
    pressure_kpa: ArrayLike | None = None
    crack_pressure_kpa: ArrayLike | None = None


@dataclass(frozen=True)
class ClosedFormPlanes:
    """Results of the closed form for n blocks, per metre of slope; numbers are nan where the plane forms none.

    Attributes
    ----------
    outcome : (n,) int8, an index into `OUTCOMES`
    factor : (n,) factor of safety, nan unless the block slides (or where passive bolts hold it whatever its strength)
    normal_kn : (n,) effective normal force on the plane, 0 without contact
    driving_kn, resisting_kn : (n,) along the plane; with passive bolts under the pull they have at that factor
    length_m, pressure_kpa : (n,) of the plane: its length, and the mean pressure of the water
    thrust_kn, crack_depth_m : (n,) of the crack: the push V of its water, its depth (0 without one)
    weight_kn : (n,)
    """

    outcome: Codes
    factor: Floats
    normal_kn: Floats
    driving_kn: Floats
    resisting_kn: Floats
    length_m: Floats
    pressure_kpa: Floats
    thrust_kn: Floats
    crack_depth_m: Floats
    weight_kn: Floats

    def counts(self) -> dict[str, int]:
        """Return the number of blocks of each outcome, in the order of `OUTCOMES`, without those that do not occur."""
        return counted(self.outcome, OUTCOMES)


def plane_failures(planes: PlaneArrays) -> ClosedFormPlanes:
    """Return outcome, factor of safety and forces of blocks that may slide on a plane.

    Raises
    ------
    ValueError
        The arrays do not fit together.

    Formula: F = (c L + (W (cos ψ - k sin ψ) - U - V sin ψ + T_n) tan φ) / (W (sin ψ + k cos ψ) + V cos ψ - T_s)
    (Wyllie & Mah 2004, eq. 6.4 and 6.11-6.22). Codes are those of `geometry.sections.section.plane_section`.

    >>> found = plane_failures(PlaneArrays(
    ...     face_dip_deg=60, upper_dip_deg=0, plane_dip_deg=[35, 35, 65], height_m=12, cohesion_kpa=25, friction_deg=37,
    ...     unit_weight_kn_m3=26, crack_distance_m=4, water_in_crack_m=[0, 3, 3]))
    >>> [OUTCOMES[outcome] for outcome in found.outcome], found.factor.round(4).tolist()
    (['slides', 'slides', 'E203'], [1.5445, 1.2467, nan])
    """
    if planes.crack_pressure_kpa is not None and planes.pressure_kpa is None:
        raise ValueError("crack_pressure_kpa goes with pressure_kpa")
    inputs = {field.name: getattr(planes, field.name) for field in fields(PlaneArrays)}
    bolts, force = inputs.pop("passive_kn"), inputs.pop("force_kn")
    if force is not None:
        inputs |= dict(zip(("force_out_kn", "force_up_kn"), force, strict=True))
    columns, count = with_passive(*float_columns(inputs), bolts)
    numbers = np.empty((9, count))
    with np.errstate(all="ignore"):
        block = _block(columns, count)
        joint, load = _joint_and_load(columns, block)
        slide = joint.slide(load)
        factor = np.where(slide.outcome <= SLIDES_UP, slide.resisting / slide.driving, np.nan)
        bolted = (
            (block.code == 0)
            & (slide.outcome != NO_DRIVING_FORCE)
            & columns["passive_kn"].any(axis=(1, 2))
        )
        for number in np.flatnonzero(bolted).tolist():
            plane = joint.single(number)
            components = [plane.on_plane(*bolt) for bolt in columns["passive_kn"][number].tolist()]
            pulls = [(float(along[0]), 0.0, float(outward[0])) for along, outward in components]
            factor[number], first_loss = factor_with_bolts(
                plane, [float(component[number]) for component in load], pulls
            )
            slide.outcome[number], slide.normal[:, number] = (
                first_loss.outcome[0],
                first_loss.normal[:, 0],
            )
            slide.driving[number], slide.resisting[number] = (
                first_loss.driving[0],
                first_loss.resisting[0],
            )
        outcome = _OUTCOME_OF_SLIDE[slide.outcome]
        rows = [
            factor,
            slide.normal[0],
            slide.driving,
            slide.resisting,
            block.length,
            block.pressure,
            block.thrust,
            block.depth,
            block.weight,
        ]
        for row, values in zip(numbers, rows, strict=True):
            row[:] = values
    refused = np.flatnonzero(block.code)
    outcome[refused] = block.code[refused]
    numbers[:, refused] = np.nan
    return ClosedFormPlanes(outcome, *numbers)


# -- the block (the tests of geometry.sections.section, in its order) -------------------------------------------------


class _PlaneBlock(NamedTuple):
    code: Codes  # 0 where there is a block
    weight: Floats
    length: Floats
    depth: Value
    pressure: Value
    thrust: Value


def _block(columns: Columns, count: int) -> _PlaneBlock:
    """Return the block of each slope: its plane, its crack, and the water in them."""
    code = np.zeros(count, dtype=np.int8)

    def refuse(name: str, condition: Value) -> None:
        """Set the code of a failed test where no earlier test has failed."""
        code[(code == 0) & condition] = _NUMBER[name]

    face_dip, upper_dip, plane_dip = (
        columns[f"{name}_dip_deg"] for name in ("face", "upper", "plane")
    )
    refuse("E204", plane_dip <= PARALLEL_DEG)
    refuse("E203", plane_dip >= face_dip - PARALLEL_DEG)
    refuse("E209", upper_dip >= face_dip - PARALLEL_DEG)
    face, upper, plane = map(_tangent, (face_dip, upper_dip, plane_dip))
    height, water_weight = columns["height_m"], columns["water_unit_weight_kn_m3"]
    crest = -height * np.cos(face_dip * _RADIAN) / np.sin(face_dip * _RADIAN), height
    meets = np.greater(plane_dip, upper_dip + PARALLEL_DEG)
    end_x = crest[0] - (height + crest[0] * plane) / (
        plane - upper
    )  # where the plane comes out of the upper slope
    end = end_x, -end_x * plane

    if "crack_depth_m" not in columns and "crack_distance_m" not in columns:
        refuse("E205", ~meets)
        refuse("E207", np.greater(columns.get("water_in_crack_m", 0.0), 0.0))
        twice_area, depth = np.abs(_twice_triangle_area(crest, end)), 0.0
        peak = 0.5 * columns["fill"] * water_weight * np.maximum(height, end[1])
        pressure, thrust = columns.get("pressure_kpa", 0.5 * peak), 0.0
    else:
        upright_crest = np.where(
            np.less(face_dip, 90.0), -height / face, 0.0
        )  # the crest where the face is just upright
        distance, misses = _crack(
            columns, upper, plane, upright_crest, np.where(meets, end[0], -np.inf)
        )
        refuse("E207", misses)
        crack_x = crest[0] - distance
        top = crack_x, np.where(distance >= 0.0, height + distance * upper, -crack_x * face)
        end = crack_x, -crack_x * plane
        depth = top[1] - end[1]
        twice_area = np.abs(
            np.where(distance > 0.0, _twice_triangle_area(crest, top), 0.0)
            + _twice_triangle_area(top, end)
        )
        if "pressure_kpa" in columns:
            pressure, thrust = (
                columns["pressure_kpa"],
                columns.get("crack_pressure_kpa", 0.0) * depth,
            )
        else:
            water_depth = columns.get("water_in_crack_m", depth)
            refuse("E207", water_depth > depth * (1.0 + 1e-9))
            pressure = (
                0.5
                * water_weight
                * water_depth
                * (1.0 if "water_in_crack_m" in columns else columns["fill"])
            )
            thrust = pressure * water_depth
        refuse("E207", ~((depth > 0.0) & (crack_x < 0.0)))
    return _PlaneBlock(
        code,
        columns["unit_weight_kn_m3"] * (0.5 * twice_area),
        np.hypot(*end),
        depth,
        pressure,
        thrust,
    )


def _crack(
    columns: Columns, upper: Value, plane: Value, crest: Value, back: Value
) -> tuple[Value, Value]:
    """Return the distance (m) of the crack behind the crest, and where there is no such crack.

    Formula: z = H (1 - cot ψ_f tan ψ_p) - b (tan ψ_p - tan ψ_s) (Wyllie & Mah 2004, eq. 6.1 and 6.2, solved for b).
    """
    misses: Value = False
    distance = columns.get("crack_distance_m")
    if "crack_depth_m" in columns:
        depth, height, lost = columns["crack_depth_m"], columns["height_m"], plane - upper
        behind = (height + crest * plane - depth) / lost
        misses = ~(
            (np.abs(lost) > SMALL) & (behind >= 0.0) & (behind < np.inf) & np.greater(depth, 0.0)
        )
        if distance is not None:
            misses = misses | (
                np.abs(distance - behind) > 0.02 * np.maximum(np.abs(behind), height)
            )
        distance = behind
    reach = crest - back
    return distance, misses | (distance >= reach * (1.0 - 1e-9)) | (
        distance <= crest * (1.0 - 1e-9)
    )


def _tangent(dip_deg: Value) -> Floats:
    """Return tan(dip) to the last bit as the geometry computes it: the depth of a crack is a difference."""
    return np.asarray(_TAN(np.asarray(dip_deg) * _RADIAN), dtype=np.float64)


def _twice_triangle_area(a: Sequence[Value], b: Sequence[Value]) -> Value:
    """Return twice the signed area of the triangle of the toe and two points."""
    return a[0] * b[1] - a[1] * b[0]


# -- how it moves -----------------------------------------------------------------------------------------------------


class _PlaneJoint(NamedTuple):
    """The plane, (n,): sine and cosine of its dip, its strength, and the sum of the loads' sizes.

    Vectors are down the plane, along its strike and off it.
    """

    sine: Floats
    cosine: Floats
    bond: Floats
    tangent: Floats
    size: Floats

    @property
    def inward(self) -> Vector:
        """The normal into the block, in the axes of the plane."""
        return np.zeros((1, 1)), np.zeros((1, 1)), np.ones((1, 1))

    @property
    def lines(self) -> Vector:
        """The lines of intersection of joints: none, as there is one plane."""
        return np.zeros((0, 1)), np.zeros((0, 1)), np.zeros((0, 1))

    def single(self, number: int) -> "_PlaneJoint":
        """Return the joint of one block, for any number of loads."""
        return _PlaneJoint(
            *(np.broadcast_to(values, self.size.shape)[number : number + 1] for values in self)
        )

    def on_plane(self, x: Value, z: Value) -> tuple[Value, Value]:
        """Return the components of a vector (x, z) down the plane and off it."""
        return x * self.cosine - z * self.sine, x * self.sine + z * self.cosine

    def slide(self, load: Vector) -> WedgeSlide:
        """Return the mode of sliding under a resultant."""
        along, _, outward = load
        tolerance = SMALL * self.size
        no_contact = outward >= -tolerance
        no_drive = np.where(no_contact, np.hypot(along, outward), np.abs(along)) <= tolerance
        uplift_mode, sliding_mode = (
            np.where(self.cosine <= SMALL, FALLS, LIFTED),
            np.where(along > 0.0, SLIDES_ON_J1, SLIDES_UP),
        )
        outcome = np.where(
            no_drive, NO_DRIVING_FORCE, np.where(no_contact, uplift_mode, sliding_mode)
        )
        normal = np.where(no_contact, 0.0, -outward)
        resisting = np.where(no_contact, 0.0, self.bond + normal * self.tangent)
        driving = np.where(no_contact | no_drive, 0.0, np.abs(along))
        return WedgeSlide(
            outcome,
            normal[None],
            driving,
            resisting,
            (along, 0.0, np.where(no_contact, outward, 0.0)),
        )


def _joint_and_load(columns: Columns, block: _PlaneBlock) -> tuple[_PlaneJoint, Vector]:
    """Return the joint plane, and the resultant of all loads down it and off it (kN/m)."""
    dip = columns["plane_dip_deg"] * _RADIAN
    force_out, force_up = columns.get("force_out_kn", 0.0), columns.get("force_up_kn", 0.0)
    uplift = block.pressure * block.length
    size = block.weight + np.abs(uplift) + np.abs(block.thrust) + np.hypot(force_out, force_up)
    joint = _PlaneJoint(
        np.sin(dip),
        np.cos(dip),
        columns["cohesion_kpa"] * block.length,
        np.tan(columns["friction_deg"] * _RADIAN),
        np.broadcast_to(size, block.code.shape),
    )
    along, outward = joint.on_plane(
        block.thrust + columns["seismic"] * block.weight + force_out, force_up - block.weight
    )
    along, outward = (
        np.broadcast_to(component, joint.size.shape) for component in (along, outward + uplift)
    )
    return joint, (along, np.zeros(joint.size.shape), outward)
