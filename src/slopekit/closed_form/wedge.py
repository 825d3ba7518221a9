"""The Hoek & Bray wedge in vector form, over arrays: forces only, zero dilation, cohesion only on planes in contact.

Sources: Hoek & Bray (1981), Rock Slope Engineering, ch. 8 and appendix 2 (geometry, water, tension crack);
Wyllie & Mah (2004), ch. 7; how it moves, `wedge_sliding`.

One wedge is an array of length one, and no line is shared with the solver that this judges.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Final, NamedTuple

import numpy as np

from slopekit.closed_form.given import BlockLoads, Codes, Columns, Value, columns_of, counted, of_chunk, with_passive
from slopekit.closed_form.tolerances import ALONG, DAYLIGHTS, SAME_DIRECTION, SMALL
from slopekit.closed_form.wedge_sliding import (
    J1,
    J2,
    SLIDES_UP,
    STATUSES,
    JointPair,
    Vector,
    cross,
    dot,
    length,
    less,
    plus,
    rows,
    times,
    under_bolts,
)  # fmt: skip
from slopekit.core.array_types import ArrayLike, Bools, Floats, NDArray

#: What may become of a wedge: it slides, it loses contact, nothing drives it, or the planes cut none (`explain CODE`).
OUTCOMES: Final = (*STATUSES, "E201", "E203", "E204", "E205", "E206", "E207", "E208", "E209")
_NUMBER: Final = {name: np.int8(number) for number, name in enumerate(OUTCOMES)}
_E207, _E208 = _NUMBER["E207"], _NUMBER["E208"]
_REFUSED: Final = _NUMBER["E201"]  # this code and those behind it: there is no wedge

#: How many are taken at a time: of fewer the calls take the time, of more the cache does not hold the rows.
CHUNK: Final = 16384
_KEPT: Final = 1 << 21  # 16 MB
_RADIAN: Final = math.pi / 180.0
_MOST: Final = 0.8  # of a chunk: where fewer cut a wedge, those are picked out first
_PLANES: Final = tuple(
    (f"{name}_dip_deg", f"{name}_dip_direction_deg") for name in ("joint1", "joint2", "face", "upper", "crack")
)
_FORCE: Final = ("force_east_kn", "force_north_kn", "force_up_kn")

# rows of the normals
_FACE, UPPER, _CRACK = 2, 3, 4
# rows of their cross products, behind the traces of J1 and J2 on the face: line of intersection, crest
_LINE, _CREST = 2, 3


@dataclass(frozen=True, kw_only=True)
class WedgePlanes:
    """The planes of wedges, each value one number for all of them or an (n,) array; in degrees and m.

    Attributes
    ----------
    joint1_dip_deg, joint1_dip_direction_deg, joint2_..., face_..., upper_... : the planes
    height_m : vertical, from the toe to where the trace of J1 meets the crest
    crack_dip_deg, crack_dip_direction_deg : None without a tension crack
    crack_distance_m : from the crest along the trace of J1
    """

    joint1_dip_deg: ArrayLike
    joint1_dip_direction_deg: ArrayLike
    joint2_dip_deg: ArrayLike
    joint2_dip_direction_deg: ArrayLike
    face_dip_deg: ArrayLike
    face_dip_direction_deg: ArrayLike
    upper_dip_deg: ArrayLike
    upper_dip_direction_deg: ArrayLike
    height_m: ArrayLike
    crack_dip_deg: ArrayLike | None = None
    crack_dip_direction_deg: ArrayLike | None = None
    crack_distance_m: ArrayLike = 0.0


@dataclass(frozen=True, kw_only=True)
class WedgeArrays(WedgePlanes, BlockLoads):
    """Wedges with their strength and loads; forces and bolts have the parts east, north and up, in kN.

    Attributes
    ----------
    cohesion1_kpa, cohesion2_kpa, friction1_deg, friction2_deg : of J1 and J2
    fill : of γ_w H/6 on J1 and J2, H the total height; with a crack of γ_w h₅/3 on all three, h₅ its depth
    pressures_kpa : mean pressures on J1, J2 and maybe the crack, instead of `fill`
    crack_fill : the crack's own part of full pressure, None where it has what the joints have
    seismic_trend_deg : None for the trend of the line of intersection
    """

    cohesion1_kpa: ArrayLike
    cohesion2_kpa: ArrayLike
    friction1_deg: ArrayLike
    friction2_deg: ArrayLike
    pressures_kpa: Sequence[ArrayLike] = ()
    crack_fill: ArrayLike | None = None
    seismic_trend_deg: ArrayLike | None = None


@dataclass(frozen=True)
class ClosedFormWedges:
    """What a closed form says of each of n wedges on k joints; numbers are nan where the planes cut none.

    Attributes
    ----------
    outcome : (n,) int8, an index into the `OUTCOMES` of the closed form
    factor : (n,) factor of safety, nan unless the block slides (or where passive bolts hold it whatever its strength)
    normal_kn : (k, n) effective normal forces: what the joints' own strength carries, 0 off the joint
    driving_kn, resisting_kn : (n,) along the direction of sliding; with passive bolts under their pull at that factor
    areas_m2, pressures_kpa : (k + 1, n) of the joints and the crack: areas, and mean pressures of the water
    volume_m3, weight_kn, total_height_m : (n,)
    line_m : (3, n) on two joints, the line of intersection from the toe up, as far as it bounds the wedge
    """

    outcome: Codes
    factor: Floats
    normal_kn: Floats
    driving_kn: Floats
    resisting_kn: Floats
    areas_m2: Floats
    pressures_kpa: Floats
    volume_m3: Floats
    weight_kn: Floats
    total_height_m: Floats
    line_m: Floats

    def counts(self) -> dict[str, int]:
        """How many wedges on two joints there are of each outcome, the absent ones left out."""
        return counted(self.outcome, OUTCOMES)

    def line_trend_plunge_deg(self) -> tuple[Floats, Floats]:
        """Trend and plunge (n,) of the lines of intersection, degrees."""
        east, north, up = self.line_m
        return np.degrees(np.arctan2(-east, -north)) % 360.0, np.degrees(np.arctan2(up, np.hypot(east, north)))


def hoek_bray_wedges(wedges: WedgeArrays, *, forces: bool = True) -> ClosedFormWedges:
    """Outcome, factor of safety and forces of wedges on two joints, maybe with a tension crack.

    Parameters
    ----------
    wedges : what is given of them
    forces : False leaves out all but outcomes and factors: the other arrays are empty

    Raises
    ------
    ValueError
        The arrays do not fit together.

    Formula: F = (c₁A₁ + c₂A₂ + N₁ tan φ₁ + N₂ tan φ₂) / |R·l| on both planes; on plane i alone
    F = (cᵢAᵢ + Nᵢ tan φᵢ) / |R - (R·nᵢ) nᵢ|. Codes are those of `geometry.rock.rockmass.wedge_corners`.

    >>> wedges = WedgeArrays(
    ...     joint1_dip_deg=[45.0, 45.0, 80.0], joint1_dip_direction_deg=115.0,
    ...     joint2_dip_deg=[45.0, 45.0, 80.0], joint2_dip_direction_deg=245.0,
    ...     face_dip_deg=60.0, face_dip_direction_deg=180.0, upper_dip_deg=10.0, upper_dip_direction_deg=180.0,
    ...     height_m=64.89, cohesion1_kpa=50.0, cohesion2_kpa=50.0, friction1_deg=20.0, friction2_deg=20.0,
    ...     unit_weight_kn_m3=25.506, fill=[0.0, 1.0, 0.0],
    ... )
    >>> found = hoek_bray_wedges(wedges)
    >>> [OUTCOMES[outcome] for outcome in found.outcome], found.factor.round(4).tolist()
    (['slides_on_both', 'slides_on_both', 'E203'], [1.5574, 1.039, nan])
    """
    columns, count = columns_of_wedges(wedges, WedgeArrays, ("J1", "J2"))
    outcome = np.empty(count, dtype=np.int8)
    numbers = np.empty((17 if forces else 1, count))
    # glibc hands what a chunk frees back to the system, to get it again page by page, which takes as long as to compute
    # with it: but not once a larger block was freed
    np.empty(_KEPT if count > CHUNK else 0)
    with np.errstate(all="ignore"):
        for first in range(0, count, CHUNK):
            part = slice(first, first + CHUNK)
            _solve(of_chunk(columns, part), outcome[part], numbers[:, part])
    rest = numbers if forces else np.empty((17, 0))
    return ClosedFormWedges(
        outcome, numbers[0], rest[1:3], rest[3], rest[4], rest[5:8], rest[8:11], rest[11], rest[12], rest[13],
        rest[14:],
    )  # fmt: skip


def columns_of_wedges(wedges: WedgeArrays, of: type[WedgeArrays], joints: Sequence[str]) -> tuple[Columns, int]:
    """What is given of wedges on these joints, the values of class `of`, by name; and how many there are.

    Raises
    ------
    ValueError
        The arrays do not fit together.
    """
    given: dict[str, ArrayLike | None] = {field.name: getattr(wedges, field.name) for field in fields(of)}
    for several in ("pressures_kpa", "force_kn", "passive_kn"):
        del given[several]
    if (count := len(wedges.pressures_kpa)) not in (0, len(joints), len(joints) + 1):
        raise ValueError(f"pressures_kpa holds {count} values: {', '.join(joints)} and maybe the crack")
    given |= {f"pressure{k}_kpa": value for k, value in enumerate(wedges.pressures_kpa, 1)}
    if wedges.force_kn is not None:
        given |= dict(zip(_FORCE, wedges.force_kn, strict=True))
    if (wedges.crack_dip_deg is None) != (wedges.crack_dip_direction_deg is None):
        raise ValueError("crack_dip_deg and crack_dip_direction_deg: give both or neither")
    return with_passive(*columns_of(given), wedges.passive_kn)


def _solve(columns: Columns, outcome: Codes, numbers: Floats) -> None:
    """Fill in what is asked of a chunk."""
    cut = planes_cut(columns, outcome.size)
    those: Any = slice(None)
    if np.count_nonzero(cut.formed) < _MOST * outcome.size:
        those = np.flatnonzero(cut.formed)
        columns = of_chunk(columns, those)
    kept = cut if isinstance(those, slice) else cut.of(those)
    outcome[those], kept_numbers = _moved(columns, kept)
    for row, values in zip(numbers, kept_numbers, strict=False):
        row[those] = values
    others = np.flatnonzero(~cut.formed)
    if others.size:
        outcome[others] = _refused(cut.of(others))
    refused = np.flatnonzero(outcome >= _REFUSED)
    if refused.size:
        for row in numbers:
            row[refused] = np.nan


# -- do the planes cut a wedge at all (the tests of geometry.rock.rockmass, in its order) ----------------------------


class PlanesCut(NamedTuple):
    """What the planes' normals say, (k, m) of k planes or lines.

    `lines` are cross products of normals: the traces of J1 and J2 on the face, the line of intersection, the crest;
    `squares` of their lengths, `length` that of the line of intersection; `climbs` are n_upper · line of the first
    three, `out` is n_face · line of intersection, `offset` of the upper slope.
    """

    normals: Vector
    lines: Vector
    squares: Floats
    length: Floats
    climbs: Floats
    out: Floats
    high: Floats
    offset: Floats
    formed: Bools

    def of(self, some: NDArray[np.intp]) -> "PlanesCut":
        def part(values: Any) -> Any:
            return tuple(map(part, values)) if isinstance(values, tuple) else values.take(some, axis=-1)

        return PlanesCut(*map(part, self))


def planes_cut(columns: Columns, count: int) -> PlanesCut:
    """What the normals of the planes of wedges say."""
    names = _PLANES if "crack_dip_deg" in columns else _PLANES[:_CRACK]
    angles = np.empty((2, len(names), count))
    for plane, (dip, direction) in enumerate(names):
        angles[0, plane], angles[1, plane] = columns[dip], columns[direction]
    angles *= _RADIAN
    sine, cosine = np.sin(angles), np.cos(angles)
    normals = sine[0] * sine[1], sine[0] * cosine[1], cosine[0]

    room = np.empty((3, 4, count))
    lines = room[0], room[1], room[2]
    cross(rows(normals, slice(2)), rows(normals, _FACE), rows(lines, slice(2)))
    cross(rows(normals, slice(J1, 4, 2)), rows(normals, slice(J2, 4, 2)), rows(lines, slice(_LINE, 4)))
    squares = dot(lines, lines)
    long = np.sqrt(squares[_LINE])
    climbs = dot(rows(normals, UPPER), rows(lines, slice(_CREST)))
    out = dot(rows(normals, _FACE), rows(lines, _LINE))
    trace1, rise = lines[2][J1], lines[2][_LINE]
    high = columns["height_m"] / trace1
    offset = dot(rows(normals, UPPER), times(rows(lines, J1), high))
    # into the rock the line climbs, out of the face and to the upper slope
    least, toward = DAYLIGHTS * long, np.copysign(1.0, out)
    formed = (np.minimum.reduce(squares) >= SAME_DIRECTION**2) & (np.abs(out) > least) & (rise * toward < -least)
    formed &= (climbs[_LINE] * toward < -least) & (np.abs(trace1) >= SAME_DIRECTION) & (offset > 0.0)
    formed &= climbs[J2] * climbs[J2] >= SAME_DIRECTION**2 * squares[J2]
    return PlanesCut(normals, lines, squares, long, climbs, out, high, offset, formed)


def _refused(cut: PlanesCut) -> Codes:
    """Why planes cut no wedge: the first test that fails counts."""
    climbs, out, rise = cut.climbs, cut.out, cut.lines[2][_LINE]
    least, toward, parallel = DAYLIGHTS * cut.length, np.copysign(1.0, out), cut.squares < SAME_DIRECTION**2
    daylights = (np.abs(out) > least) & (rise * toward < -least) & (climbs[_LINE] * toward < -least)
    codes = np.full(out.size, _E208)
    for where, code in (
        (climbs[J2] * climbs[J2] < SAME_DIRECTION**2 * cut.squares[J2], _NUMBER["E206"]),
        (cut.offset <= 0.0, _NUMBER["E209"]),
        (np.abs(cut.lines[2][J1]) < SAME_DIRECTION, _NUMBER["E206"]),
        (~daylights, _hidden(rows(cut.lines, _LINE), rows(cut.normals, _FACE))),
        (parallel[J1] | parallel[J2], _NUMBER["E206"]),
        (parallel[_CREST], _NUMBER["E209"]),
        (parallel[_LINE], _NUMBER["E201"]),
    ):
        codes = np.where(where, code, codes)
    return codes


def _hidden(line: Vector, face: Vector) -> Codes:
    """Why lines of intersection do not daylight: E204 into the slope, E203 too steep, E205 too flat."""
    down = np.where(line[2] > 0.0, -1.0, 1.0)
    level, flat = np.hypot(line[0], line[1]), np.hypot(face[0], face[1])
    plunge = np.arctan2(np.abs(line[2]), level)
    ahead = np.where(flat < SMALL, line[1], (line[0] * face[0] + line[1] * face[1]) * np.copysign(1.0, face[2]) / flat)
    cosine = down * ahead / level
    apparent = np.arctan(flat / np.abs(face[2]) * cosine)
    codes = np.where(plunge >= apparent - math.radians(ALONG), _NUMBER["E203"], _NUMBER["E205"])
    codes[(plunge < math.radians(ALONG)) | (cosine <= 0.0)] = _NUMBER["E204"]
    for one in np.flatnonzero(np.abs(cosine) < ALONG):
        codes[one] = _along_the_slope(np.array([part[one] for part in line]), [float(part[one]) for part in face])
    return codes


def _along_the_slope(across: Floats, face: Sequence[float]) -> np.int8:
    """E203 or E204 (or E205) of a line just along the slope, as those of round angles are: the last bit decides.

    All is taken as geometry takes it, the length of the line by BLAS.
    """
    line = across / math.sqrt(float(across @ across))
    east, north, up = (-line if line[2] > 0.0 else line).tolist()
    plunge = math.degrees(math.atan2(-up, math.hypot(east, north)))
    flat = math.hypot(face[0], face[1])
    dip = (0.0, 1.0, 0.0) if flat < SMALL else (face[0] * face[2] / flat, face[1] * face[2] / flat, -flat)
    steep = math.degrees(math.atan2(-dip[2], math.hypot(dip[0], dip[1])))
    trend, facing = (math.degrees(math.atan2(a, b)) % 360.0 for a, b in ((east, north), dip[:2]))
    cosine = math.cos(math.radians(trend - facing))
    if abs(plunge) < ALONG or cosine <= 0.0:
        return _NUMBER["E204"]
    apparent = math.degrees(math.atan(math.tan(math.radians(steep)) * cosine))
    return _NUMBER["E203" if plunge >= apparent - ALONG else "E205"]


# -- the wedge ----------------------------------------------------------------------------------------


class _Shape(NamedTuple):
    """Areas (2, m) or with a crack (3, m), and the normals of those planes that point into the wedge."""

    areas: Floats
    inward: Vector
    volume: Floats
    total_height: Floats
    crack_depth: Floats | None
    line: Vector
    code: Codes | None  # where the volume vanishes E208, where the crack misses the wedge E207, else 0; None for all 0


def _shape(columns: Columns, cut: PlanesCut) -> _Shape:
    scales = np.empty_like(cut.climbs)
    scales[J1] = cut.high
    np.divide(cut.offset, cut.climbs[J2:], scales[J2:])
    points = times(rows(cut.lines, slice(_CREST)), scales)
    crests, back = rows(points, slice(2)), rows(points, 2)
    spans = cross(crests, back)
    areas = length(spans) / 2.0
    volume = np.abs(dot(rows(crests, J1), rows(spans, J2))) / 6.0
    joints = rows(cut.normals, slice(2))
    inward = times(joints, np.copysign(1.0, dot(joints, rows(crests, slice(None, None, -1)))))
    code = None if (volume > 0.0).all() else np.where(volume > 0.0, 0, _E208).astype(np.int8)
    if "crack_dip_deg" in columns:
        return _cracked(columns, cut, _Shape(areas, inward, volume, volume, None, back, code), crests)
    return _Shape(areas, inward, volume, _reach(points[2]), None, back, code)


def _cracked(columns: Columns, cut: PlanesCut, whole: _Shape, crests: Vector) -> _Shape:
    """What is left in front of the crack."""
    crack, upper, back = rows(cut.normals, _CRACK), rows(cut.normals, UPPER), whole.line
    crest1, distance = rows(crests, 0), columns["crack_distance_m"]
    trace = less(back, crest1)
    long = length(trace)
    offset, crossing = dot(crack, plus(crest1, times(trace, distance / long))), dot(crack, back)
    share = offset / crossing
    meets = (share > 1e-9) & (share < 1.0 - 1e-9) & (distance < long)
    meets &= np.abs(crossing) >= SAME_DIRECTION * length(back)
    meets &= np.minimum.reduce(length(cross(crack, rows(cut.normals, [J1, J2, UPPER])))) >= SAME_DIRECTION

    bottom, ways = times(back, share), less(back, crests)
    tops = plus(crests, times(ways, (offset - dot(crack, crests)) / dot(crack, ways)))
    deep, high = less(bottom, back), less(tops, back)
    behind = np.abs(dot(deep, cross(rows(high, 0), rows(high, 1)))) / 6.0
    sides = less(tops, bottom)
    own = length(cross(rows(sides, 0), rows(sides, 1))) / 2.0
    turn = np.where(offset > 0.0, -1.0, 1.0)
    inward = tuple(np.vstack([joints, row * turn]) for joints, row in zip(whole.inward, crack, strict=True))
    code = np.where(meets, 0 if whole.code is None else whole.code, _E207).astype(np.int8)
    return _Shape(
        np.vstack([whole.areas - length(cross(deep, high)) / 2.0, own]), (inward[0], inward[1], inward[2]),
        whole.volume - behind, _reach(np.vstack([crests[2], bottom[2], tops[2]])),
        (cut.offset - dot(upper, bottom)) / upper[2], bottom, code,
    )  # fmt: skip


def _reach(heights: Floats) -> Floats:
    """From the lowest to the highest of the corners (k, m), the toe at 0 among them."""
    reach: Floats = np.maximum(np.maximum.reduce(heights), 0.0) - np.minimum(np.minimum.reduce(heights), 0.0)
    return reach


# -- how it moves -------------------------------------------------------------------------------------


def _moved(columns: Columns, cut: PlanesCut) -> tuple[Codes, Sequence[Floats | float]]:
    """Outcomes, and the numbers of `ClosedFormWedges`, of wedges that the planes cut."""
    shape = _shape(columns, cut)
    weight = columns["unit_weight_kn_m3"] * shape.volume
    pressures = mean_pressures(columns, 2, shape.total_height, shape.crack_depth)
    load, size = _load(columns, cut, shape, weight, pressures)
    line = times(rows(cut.lines, _LINE), 1.0 / cut.length)
    joints = rows(shape.inward, slice(2))
    between = dot(rows(joints, J1), rows(joints, J2))
    strength = np.empty((2, 2, weight.size))
    for joint, number in ((J1, 1), (J2, 2)):
        strength[0, joint], strength[1, joint] = columns[f"cohesion{number}_kpa"], columns[f"friction{number}_deg"]
    bed = JointPair(
        joints, line, between, 1.0 - between * between, strength[0] * shape.areas[:2], np.tan(strength[1] * _RADIAN),
        size,
    )  # fmt: skip

    slide = bed.slide(load)
    outcome, normal, driving, resisting, _ = slide
    factor = resisting / driving
    none = outcome > SLIDES_UP
    if none.any():
        factor[none], driving[none] = np.nan, 0.0
    under_bolts(bed, load, columns, cut.formed, slide, factor)
    driving[outcome > SLIDES_UP] = 0.0
    if shape.code is not None:
        outcome = np.where(shape.code, shape.code, outcome)
    areas = shape.areas if len(shape.areas) == 3 else [*shape.areas, 0.0]
    return outcome, [factor, *normal, driving, resisting, *areas, *pressures, shape.volume, weight, shape.total_height,
                     *shape.line]  # fmt: skip


def mean_pressures(columns: Columns, joints: int, height: Floats, crack_depth: Floats | None) -> list[Value]:
    """Mean pressures on so many joints and the crack: γ_w H/6, with a crack γ_w h₅/3 on all."""
    water = columns["water_unit_weight_kn_m3"]
    full = 0.0 if crack_depth is None else water * crack_depth / 3.0
    own = columns["crack_fill"] * full if "crack_fill" in columns else None
    if "pressure1_kpa" in columns:
        given = columns.get(f"pressure{joints + 1}_kpa", 0.0)
        return [*(columns[f"pressure{k}_kpa"] for k in range(1, joints + 1)), given if own is None else own]
    if crack_depth is None:
        return [*[columns["fill"] * water * height / 6.0] * joints, 0.0]
    mean = columns["fill"] * full
    return [*[mean] * joints, mean if own is None else own]


def _load(
    columns: Columns, cut: PlanesCut, shape: _Shape, weight: Floats, pressures: list[Value]
) -> tuple[Vector, Floats]:
    """The resultant of all loads, and the sum of their sizes."""
    load: Vector = (0.0, 0.0, -weight)
    if not _is_none(columns["seismic"]):
        if "seismic_trend_deg" in columns:
            trend = np.radians(columns["seismic_trend_deg"])
        else:
            down = np.where(cut.lines[2][_LINE] < 0.0, 1.0, -1.0)
            trend = np.arctan2(cut.lines[0][_LINE] * down, cut.lines[1][_LINE] * down)
        push = weight * columns["seismic"]
        load = push * np.sin(trend), push * np.cos(trend), -weight
    return with_water_and_forces(columns, load, weight, pressures, shape.areas, shape.inward)


def with_water_and_forces(
    columns: Columns, load: Vector, size: Floats, pressures: list[Value], areas: Floats, inward: Vector
) -> tuple[Vector, Floats]:
    """A load with the water on each plane and the forces, and the sum of their sizes with its own."""
    for pressure, area, *normal in zip(pressures, areas, *inward, strict=False):
        if not _is_none(pressure):
            push = pressure * area
            load = plus(load, times((normal[0], normal[1], normal[2]), push))
            size = size + np.abs(push)
    if _FORCE[0] in columns:
        force = columns[_FORCE[0]], columns[_FORCE[1]], columns[_FORCE[2]]
        load, size = plus(load, force), size + length(force)
    return load, size


def _is_none(value: Value) -> bool:
    return isinstance(value, float) and value == 0.0
