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

from slopekit.closed_form.given import BlockLoads, Codes, Columns, Value, columns_of, counted, with_passive
from slopekit.closed_form.tolerances import PARALLEL_DEG, SMALL
from slopekit.closed_form.wedge_sliding import (
    FALLS,
    LIFTED,
    SLIDES_ON_J1,
    SLIDES_UP,
    STILL,
    Vector,
    WedgeSlide,
    with_bolts,
)
from slopekit.core.array_types import ArrayLike, Floats

#: What may become of a block: it slides, it loses contact, nothing drives it, or the plane cuts none (`explain CODE`).
OUTCOMES: Final = ("slides", "slides_up", "lifted", "falls", "no_driving_force", "E203", "E204", "E205", "E207", "E209")
_NUMBER: Final = {name: np.int8(number) for number, name in enumerate(OUTCOMES)}
#: Of the numbers that `wedge_sliding` has for how a block moves, those here.
_NUMBERS: Final = np.array([0, 0, 0, 1, 2, 3, 4], dtype=np.int8)
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
    """What the closed form says of each of n blocks, per metre of slope; numbers are nan where the plane cuts none.

    Attributes
    ----------
    outcome : (n,) int8, an index into `OUTCOMES`
    factor : (n,) factor of safety, nan unless the block slides (or where passive bolts hold it whatever its strength)
    normal_kn : (n,) effective normal force on the plane: what its own strength carries, 0 off the plane
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
        """How many blocks there are of each outcome, in the order of `OUTCOMES`, the absent ones left out."""
        return counted(self.outcome, OUTCOMES)


def plane_failures(planes: PlaneArrays) -> ClosedFormPlanes:
    """Outcome, factor of safety and forces of blocks that may slide on a plane.

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
    given = {field.name: getattr(planes, field.name) for field in fields(PlaneArrays)}
    bolts, force = given.pop("passive_kn"), given.pop("force_kn")
    if force is not None:
        given |= dict(zip(("force_out_kn", "force_up_kn"), force, strict=True))
    columns, count = with_passive(*columns_of(given), bolts)
    numbers = np.empty((9, count))
    with np.errstate(all="ignore"):
        block = _block(columns, count)
        bed, load = _bed(columns, block)
        slide = bed.slide(load)
        factor = np.where(slide.outcome <= SLIDES_UP, slide.resisting / slide.driving, np.nan)
        held = (block.code == 0) & (slide.outcome != STILL) & columns["passive_kn"].any(axis=(1, 2))
        for one in np.flatnonzero(held).tolist():
            plane = bed.of(one)
            ways = [plane.on_plane(*bolt) for bolt in columns["passive_kn"][one].tolist()]
            pulls = [(float(along[0]), 0.0, float(off[0])) for along, off in ways]
            factor[one], last = with_bolts(plane, [float(part[one]) for part in load], pulls)
            slide.outcome[one], slide.normal[:, one] = last.outcome[0], last.normal[:, 0]
            slide.driving[one], slide.resisting[one] = last.driving[0], last.resisting[0]
        outcome = _NUMBERS[slide.outcome]
        rows = [factor, slide.normal[0], slide.driving, slide.resisting, block.length, block.pressure, block.thrust,
                 block.depth, block.weight]  # fmt: skip
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
    """The block of each slope, its plane and its crack, and the water in them."""
    code = np.zeros(count, dtype=np.int8)

    def refuse(name: str, where: Value) -> None:
        """The first test that fails counts."""
        code[(code == 0) & where] = _NUMBER[name]

    face_dip, upper_dip, plane_dip = (columns[f"{name}_dip_deg"] for name in ("face", "upper", "plane"))
    refuse("E204", plane_dip <= PARALLEL_DEG)
    refuse("E203", plane_dip >= face_dip - PARALLEL_DEG)
    refuse("E209", upper_dip >= face_dip - PARALLEL_DEG)
    face, upper, plane = map(_tangent, (face_dip, upper_dip, plane_dip))
    height, weighs = columns["height_m"], columns["water_unit_weight_kn_m3"]
    crest = -height * np.cos(face_dip * _RADIAN) / np.sin(face_dip * _RADIAN), height
    meets = np.greater(plane_dip, upper_dip + PARALLEL_DEG)
    end_x = crest[0] - (height + crest[0] * plane) / (plane - upper)  # where the plane comes out of the upper slope
    end = end_x, -end_x * plane

    if "crack_depth_m" not in columns and "crack_distance_m" not in columns:
        refuse("E205", ~meets)
        refuse("E207", np.greater(columns.get("water_in_crack_m", 0.0), 0.0))
        twice, depth = np.abs(_turned(crest, end)), 0.0
        peak = 0.5 * columns["fill"] * weighs * np.maximum(height, end[1])
        pressure, thrust = columns.get("pressure_kpa", 0.5 * peak), 0.0
    else:
        before = np.where(np.less(face_dip, 90.0), -height / face, 0.0)  # the crest where the face is just upright
        distance, misses = _crack(columns, upper, plane, before, np.where(meets, end[0], -np.inf))
        refuse("E207", misses)
        at = crest[0] - distance
        top = at, np.where(distance >= 0.0, height + distance * upper, -at * face)
        end = at, -at * plane
        depth = top[1] - end[1]
        twice = np.abs(np.where(distance > 0.0, _turned(crest, top), 0.0) + _turned(top, end))
        if "pressure_kpa" in columns:
            pressure, thrust = columns["pressure_kpa"], columns.get("crack_pressure_kpa", 0.0) * depth
        else:
            deep = columns.get("water_in_crack_m", depth)
            refuse("E207", deep > depth * (1.0 + 1e-9))
            pressure = 0.5 * weighs * deep * (1.0 if "water_in_crack_m" in columns else columns["fill"])
            thrust = pressure * deep
        refuse("E207", ~((depth > 0.0) & (at < 0.0)))
    return _PlaneBlock(code, columns["unit_weight_kn_m3"] * (0.5 * twice), np.hypot(*end), depth, pressure, thrust)


def _crack(columns: Columns, upper: Value, plane: Value, crest: Value, back: Value) -> tuple[Value, Value]:
    """Distance of the crack behind the crest, and where there is no such crack.

    Formula: z = H (1 - cot ψ_f tan ψ_p) - b (tan ψ_p - tan ψ_s) (Wyllie & Mah 2004, eq. 6.1 and 6.2, solved for b).
    """
    misses: Value = False
    distance = columns.get("crack_distance_m")
    if "crack_depth_m" in columns:
        depth, height, lost = columns["crack_depth_m"], columns["height_m"], plane - upper
        behind = (height + crest * plane - depth) / lost
        misses = ~((np.abs(lost) > SMALL) & (behind >= 0.0) & (behind < np.inf) & np.greater(depth, 0.0))
        if distance is not None:
            misses = misses | (np.abs(distance - behind) > 0.02 * np.maximum(np.abs(behind), height))
        distance = behind
    reach = crest - back
    return distance, misses | (distance >= reach * (1.0 - 1e-9)) | (distance <= crest * (1.0 - 1e-9))


def _tangent(dip_deg: Value) -> Floats:
    """As geometry takes it, to the last bit: the depth of a crack is a difference."""
    return np.asarray(_TAN(np.asarray(dip_deg) * _RADIAN), dtype=np.float64)


def _turned(a: Sequence[Value], b: Sequence[Value]) -> Value:
    """Twice the area between two points and the toe."""
    return a[0] * b[1] - a[1] * b[0]


# -- how it moves -----------------------------------------------------------------------------------------------------


class _Bed(NamedTuple):
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
        """The normal into the block."""
        return np.zeros((1, 1)), np.zeros((1, 1)), np.ones((1, 1))

    @property
    def lines(self) -> Vector:
        """No line of two joints."""
        return np.zeros((0, 1)), np.zeros((0, 1)), np.zeros((0, 1))

    def of(self, one: int) -> "_Bed":
        """One block's, for any number of loads."""
        return _Bed(*(np.broadcast_to(values, self.size.shape)[one : one + 1] for values in self))

    def on_plane(self, x: Value, z: Value) -> tuple[Value, Value]:
        """Down the plane, and off it."""
        return x * self.cosine - z * self.sine, x * self.sine + z * self.cosine

    def slide(self, load: Vector) -> WedgeSlide:
        """Mode of sliding from the resultant."""
        along, _, off = load
        nothing = SMALL * self.size
        lost = off >= -nothing
        still = np.where(lost, np.hypot(along, off), np.abs(along)) <= nothing
        off_it, on_it = np.where(self.cosine <= SMALL, FALLS, LIFTED), np.where(along > 0.0, SLIDES_ON_J1, SLIDES_UP)
        outcome = np.where(still, STILL, np.where(lost, off_it, on_it))
        normal = np.where(lost, 0.0, -off)
        resisting = np.where(lost, 0.0, self.bond + normal * self.tangent)
        driving = np.where(lost | still, 0.0, np.abs(along))
        return WedgeSlide(outcome, normal[None], driving, resisting, (along, 0.0, np.where(lost, off, 0.0)))


def _bed(columns: Columns, block: _PlaneBlock) -> tuple[_Bed, Vector]:
    """The plane, and the resultant of all loads down it and off it."""
    dip = columns["plane_dip_deg"] * _RADIAN
    out, up = columns.get("force_out_kn", 0.0), columns.get("force_up_kn", 0.0)
    uplift = block.pressure * block.length
    size = block.weight + np.abs(uplift) + np.abs(block.thrust) + np.hypot(out, up)
    bed = _Bed(
        np.sin(dip), np.cos(dip), columns["cohesion_kpa"] * block.length, np.tan(columns["friction_deg"] * _RADIAN),
        np.broadcast_to(size, block.code.shape),
    )  # fmt: skip
    along, off = bed.on_plane(block.thrust + columns["seismic"] * block.weight + out, up - block.weight)
    along, off = (np.broadcast_to(part, bed.size.shape) for part in (along, off + uplift))
    return bed, (along, np.zeros(bed.size.shape), off)
