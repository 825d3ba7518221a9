"""Plane failure over arrays of designs: outcomes and factors as the scalar functions find them, one by one.

For Monte Carlo and sweeps. `geometry.section.plane_section` decides whether there is a block and where its crack
stands, `analysis.plane` what the water does, `closed_form.plane` how it moves (sources there); this follows them step
by step, so that the answers are theirs also where rounding decides.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from slopekit.closed_form.as_math import each
from slopekit.closed_form.given import Codes, Columns, Floats, Value, chunks, columns_of, selected

#: What may become of a block: the statuses of `plane_failure`, and the codes of planes that cut none.
OUTCOMES: Final = ("slides", "slides_up", "lifted", "falls", "no_driving_force", "E203", "E204", "E205", "E207", "E209")
_NUMBER: Final = {name: np.int8(number) for number, name in enumerate(OUTCOMES)}
_PARALLEL_DEG: Final = 1e-4  # as geometry.section
_SMALL: Final = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneArrays:
    """Blocks on one plane, each value one number for all of them or an (n,) array; per metre of slope.

    Attributes
    ----------
    face_dip_deg, upper_dip_deg, plane_dip_deg : positive out of the slope
    height_m : vertical, from the toe to the crest
    cohesion_kpa, friction_deg : of the plane
    unit_weight_kn_m3 : of the rock
    crack_depth_m, crack_distance_m : of a vertical crack, one of the two, or both where they agree; the distance counts
        back from the crest (negative: in the face). Neither without a crack
    fill : part of full water: of the crack's depth, without a crack of γ_w H/2 at mid-length of the plane
    water_in_crack_m : the water in the crack, instead of `fill`
    pressure_kpa, crack_pressure_kpa : mean pressures on the plane and in the crack, instead of both
    water_unit_weight_kn_m3 : of the water
    seismic : coefficient, out of the slope
    force_kn : out of the slope and up, kN/m: the sum of the forces and the active bolts; None without any
    """

    face_dip_deg: ArrayLike
    upper_dip_deg: ArrayLike
    plane_dip_deg: ArrayLike
    height_m: ArrayLike
    cohesion_kpa: ArrayLike
    friction_deg: ArrayLike
    unit_weight_kn_m3: ArrayLike
    crack_depth_m: ArrayLike | None = None
    crack_distance_m: ArrayLike | None = None
    fill: ArrayLike = 0.0
    water_in_crack_m: ArrayLike | None = None
    pressure_kpa: ArrayLike | None = None
    crack_pressure_kpa: ArrayLike | None = None
    water_unit_weight_kn_m3: ArrayLike = 9.81
    seismic: ArrayLike = 0.0
    force_kn: Sequence[ArrayLike] | None = None


@dataclass(frozen=True, slots=True)
class ClosedFormPlanes:
    """What the closed form says of many blocks.

    Attributes
    ----------
    outcome : (n,) int8, an index into `OUTCOMES`
    factor : (n,) factor of safety, nan unless the block slides
    weight_kn, length_m, crack_depth_m : (n,) of the block, its plane and its crack (0 without one); nan without a block
    """

    outcome: Codes
    factor: Floats
    weight_kn: Floats
    length_m: Floats
    crack_depth_m: Floats

    def counts(self) -> dict[str, int]:
        """How many blocks there are of each outcome, in the order of `OUTCOMES`, the absent ones left out."""
        found = np.bincount(self.outcome, minlength=len(OUTCOMES))
        return {name: int(number) for name, number in zip(OUTCOMES, found, strict=True) if number}


def plane_failures(planes: PlaneArrays) -> ClosedFormPlanes:
    """Outcome and factor of safety of many blocks that may slide on a plane.

    Raises
    ------
    ValueError
        The arrays do not fit together.

    Outcomes are those of `geometry.section.plane_section` and then `plane_failure`; factors equal the scalar ones to
    1e-12. Formula and sources: `plane`.

    >>> found = plane_failures(PlaneArrays(
    ...     face_dip_deg=60, upper_dip_deg=0, plane_dip_deg=[35, 35, 65], height_m=12, cohesion_kpa=25, friction_deg=37,
    ...     unit_weight_kn_m3=26, crack_distance_m=4, water_in_crack_m=[0, 3, 3]))
    >>> [OUTCOMES[outcome] for outcome in found.outcome], found.factor.round(4).tolist()
    (['slides', 'slides', 'E203'], [1.5445, 1.2467, nan])
    """
    if planes.crack_pressure_kpa is not None and planes.pressure_kpa is None:
        raise ValueError("crack_pressure_kpa goes with pressure_kpa")
    given = {field.name: getattr(planes, field.name) for field in fields(PlaneArrays) if field.name != "force_kn"}
    if planes.force_kn is not None:
        given |= dict(zip(("force_out_kn", "force_up_kn"), planes.force_kn, strict=True))
    columns, count = columns_of(given)
    outcome = np.empty(count, dtype=np.int8)
    numbers = np.empty((4, count))
    with np.errstate(all="ignore"):
        for some in chunks(np.arange(count)):
            outcome[some], numbers[:, some] = _failures(selected(columns, some), some.size)
    return ClosedFormPlanes(outcome, *numbers)


@dataclass(frozen=True, slots=True)
class _Slope:
    """Tangents of the dips; height; x of the crest."""

    face: Value
    upper: Value
    plane: Value
    height: Value
    crest: Value


def _failures(columns: Columns, count: int) -> tuple[Codes, Floats]:
    """Outcomes; factors, weights, lengths of the plane and depths of the crack, (4, m)."""
    outcome = np.full(count, -1, dtype=np.int8)

    def refuse(code: str, where: Value) -> None:
        """The first test that fails counts."""
        outcome[(outcome < 0) & where] = _NUMBER[code]

    face_dip, upper_dip, plane_dip = (columns[f"{name}_dip_deg"] for name in ("face", "upper", "plane"))
    refuse("E204", plane_dip <= _PARALLEL_DEG)
    refuse("E203", plane_dip >= face_dip - _PARALLEL_DEG)
    refuse("E209", upper_dip >= face_dip - _PARALLEL_DEG)
    face, upper, plane = (each(math.tan, np.radians(dip)) for dip in (face_dip, upper_dip, plane_dip))
    height = columns["height_m"]
    slope = _Slope(face, upper, plane, height, np.where(np.less(face_dip, 90.0), -height / face, 0.0))
    meets = np.greater(plane_dip, upper_dip + _PARALLEL_DEG)
    back = _back(columns, slope)

    distance: Value = None
    deep: Value = 0.0
    peak: Value = 0.0
    weighs, by_height = columns["water_unit_weight_kn_m3"], "pressure_kpa" not in columns
    if "crack_depth_m" in columns or "crack_distance_m" in columns:
        distance, misses = _crack(columns, slope, np.where(meets, back[0], -np.inf))
        refuse("E207", misses)
        depth = _depth(slope, distance)
        if by_height:
            given = "water_in_crack_m" in columns
            deep = columns["water_in_crack_m"] if given else columns["fill"] * depth
            refuse("E207", deep > depth * (1.0 + 1e-9))
    else:
        refuse("E205", ~meets)
        if by_height:
            peak = columns["fill"] * weighs * np.maximum(height, back[1]) / 2.0

    area, end, depth = _block(columns, slope, distance)
    if distance is not None:
        refuse("E207", ~((depth > 0.0) & (end[0] < 0.0)))
    weight = columns["unit_weight_kn_m3"] * area
    length = each(math.hypot, *end)
    mean = weighs * deep / 2.0 if by_height else columns["pressure_kpa"]
    uplift, thrust = (mean + peak / 2.0) * length, weighs * (deep * deep) / 2.0
    status, factor = _slide(columns, weight, length, uplift, thrust, depth)
    formed = outcome < 0
    outcome[formed] = np.broadcast_to(status, count)[formed]
    return outcome, np.array([np.where(formed, value, np.nan) for value in (factor, weight, length, depth)])


def _back(columns: Columns, slope: _Slope) -> tuple[Value, Value]:
    """Where the plane comes out of the upper slope, x and z."""
    upper, plane = (np.radians(columns[f"{name}_dip_deg"]) for name in ("upper", "plane"))
    sine, cosine = each(math.sin, upper), each(math.cos, upper)
    along = -each(math.cos, plane), each(math.sin, plane)
    reach = (sine * slope.crest + cosine * slope.height) / (sine * along[0] + cosine * along[1])
    return along[0] * reach, along[1] * reach


def _crack(columns: Columns, slope: _Slope, back: Value) -> tuple[Value, Value]:
    """Distance of the crack behind the crest, and where there is no such crack."""
    misses: Value = False
    distance = columns.get("crack_distance_m")
    if "crack_depth_m" in columns:
        depth = columns["crack_depth_m"]
        less = slope.plane - slope.upper
        behind = (slope.height + slope.crest * slope.plane - depth) / less
        misses = ~((np.abs(less) > _SMALL) & (behind >= 0.0) & (behind < np.inf) & np.greater(depth, 0.0))
        if distance is not None:
            misses = misses | (np.abs(distance - behind) > 0.02 * np.maximum(np.abs(behind), slope.height))
        distance = behind
    reach = -back + slope.crest
    return distance, misses | (distance >= reach * (1.0 - 1e-9)) | (distance <= slope.crest * (1.0 - 1e-9))


def _depth(slope: _Slope, distance: Value) -> Value:
    """From the ground down to the plane, where the crack stands."""
    at = slope.crest - distance
    ground = np.where(at > slope.crest, -at * slope.face, slope.height + (slope.crest - at) * slope.upper)
    return ground - -at * slope.plane


def _block(columns: Columns, slope: _Slope, distance: Value | None) -> tuple[Value, tuple[Value, Value], Value]:
    """Area of the block, m²; the upper end of its plane, x and z; the depth of the crack (closed_form.plane)."""
    face = np.radians(columns["face_dip_deg"])
    crest = -slope.height * each(math.cos, face) / each(math.sin, face), slope.height
    if distance is None:
        behind = crest[0] - (slope.height + crest[0] * slope.plane) / (slope.plane - slope.upper)
        end = behind, -behind * slope.plane
        return abs(_cross(crest, end)) / 2.0, end, 0.0
    at = crest[0] - distance
    top = at, np.where(distance >= 0.0, slope.height + distance * slope.upper, -at * slope.face)
    end = at, -at * slope.plane
    twice = np.where(np.greater(distance, 0.0), _cross(crest, top), 0.0) + _cross(top, end)
    return abs(twice) / 2.0, end, top[1] - end[1]


def _slide(
    columns: Columns, weight: Value, length: Value, uplift: Value, thrust: Value, depth: Value
) -> tuple[Value, Value]:
    """Mode of sliding from the resultant, down the plane or off it, and its factor."""
    dip = np.radians(columns["plane_dip_deg"])
    sine, cosine = each(math.sin, dip), each(math.cos, dip)
    out, up = columns.get("force_out_kn", 0.0), columns.get("force_up_kn", 0.0)
    push = columns["crack_pressure_kpa"] * depth if "crack_pressure_kpa" in columns else 0.0
    x, z = thrust + columns["seismic"] * weight + (out + push), up - weight
    along, off = x * cosine - z * sine, x * sine + z * cosine + uplift
    nothing = _SMALL * (weight + abs(uplift) + thrust + np.hypot(out, up) + abs(push))

    still = np.where(off >= -nothing, np.hypot(along, off), abs(along)) <= nothing
    lost = np.where(cosine <= _SMALL, _NUMBER["falls"], _NUMBER["lifted"])
    slides = np.where(along > 0.0, _NUMBER["slides"], _NUMBER["slides_up"])
    status = np.where(still, _NUMBER["no_driving_force"], np.where(off >= -nothing, lost, slides))
    resisting = columns["cohesion_kpa"] * length - off * np.tan(np.radians(columns["friction_deg"]))
    return status, np.where(still | (off >= -nothing), np.nan, resisting / abs(along))


def _cross(a: tuple[Value, Value], b: tuple[Value, Value]) -> Value:
    return a[0] * b[1] - a[1] * b[0]
