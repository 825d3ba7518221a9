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

from slopekit.closed_form.inputs import (
    BlockLoads,
    Codes,
    Columns,
    Value,
    counted,
    float_columns,
    selected_columns,
    with_passive,
)
from slopekit.closed_form.tolerances import ALONG, DAYLIGHTS, SAME_DIRECTION, SMALL
from slopekit.closed_form.wedge_sliding import (
    J1,
    J2,
    SLIDES_UP,
    STATUSES,
    JointPair,
    Vector,
    apply_passive_bolts,
    cross,
    dot,
    length,
    less,
    plus,
    rows,
    times,
)
from slopekit.core.array_types import ArrayLike, Bools, Floats, NDArray

#: Outcomes of a wedge: it slides, it loses contact, nothing drives it, or the planes form none (`explain CODE`).
OUTCOMES: Final = (*STATUSES, "E201", "E203", "E204", "E205", "E206", "E207", "E208", "E209")
_NUMBER: Final = {name: np.int8(number) for number, name in enumerate(OUTCOMES)}
_E207, _E208 = _NUMBER["E207"], _NUMBER["E208"]
_REFUSED: Final = _NUMBER["E201"]  # this code and those behind it: there is no wedge

#: Wedges in a chunk: with fewer the overhead of calls dominates, with more the rows do not fit into the cache.
CHUNK: Final = 16384
_HEAP_FLOATS: Final = 1 << 21  # 16 MB
_RADIAN: Final = math.pi / 180.0
_MIN_FORMED_SHARE: Final = 0.8  # of a chunk: where fewer cut a wedge, those are picked out first
_PLANES: Final = tuple(
    (f"{name}_dip_deg", f"{name}_dip_direction_deg")
    for name in ("joint1", "joint2", "face", "upper", "crack")
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
    """Wedges with their strength and loads; forces and bolts have the components east, north and up, in kN.

    Attributes
    ----------
    cohesion1_kpa, cohesion2_kpa, friction1_deg, friction2_deg : of J1 and J2
    fill : of γ_w H/6 on J1 and J2, H the total height; with a crack of γ_w h₅/3 on all three, h₅ its depth
    pressures_kpa : mean pressures on J1, J2 and maybe the crack, instead of `fill`
    crack_fill : the crack's own fraction of full pressure, None for that of the joints
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
    """Results of a closed form for n wedges on k joints; numbers are nan where the planes form none.

    Attributes
    ----------
    outcome : (n,) int8, an index into the `OUTCOMES` of the closed form
    factor : (n,) factor of safety, nan unless the block slides (or where passive bolts hold it whatever its strength)
    normal_kn : (k, n) effective normal forces on the joints, 0 without contact
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
        """Return the number of wedges on two joints of each outcome, without outcomes that do not occur."""
        return counted(self.outcome, OUTCOMES)

    def line_trend_plunge_deg(self) -> tuple[Floats, Floats]:
        """Return the trend and plunge (n,) of the lines of intersection, degrees."""
        east, north, up = self.line_m
        return np.degrees(np.arctan2(-east, -north)) % 360.0, np.degrees(
            np.arctan2(up, np.hypot(east, north))
        )


def hoek_bray_wedges(wedges: WedgeArrays, *, forces: bool = True) -> ClosedFormWedges:
    """Return outcome, factor of safety and forces of wedges on two joints, maybe with a tension crack.

    Parameters
    ----------
    wedges : planes, strength and loads
    forces : False returns outcomes and factors only: the other arrays are empty

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
    columns, count = wedge_columns(wedges, WedgeArrays, ("J1", "J2"))
    outcome = np.empty(count, dtype=np.int8)
    numbers = np.empty((17 if forces else 1, count))
    # glibc hands what a chunk frees back to the system, to get it again page by page, which takes as long as to compute
    # with it: but not once a larger block was freed
    np.empty(_HEAP_FLOATS if count > CHUNK else 0)
    with np.errstate(all="ignore"):
        for first in range(0, count, CHUNK):
            chunk = slice(first, first + CHUNK)
            _solve(selected_columns(columns, chunk), outcome[chunk], numbers[:, chunk])
    rest = numbers if forces else np.empty((17, 0))
    return ClosedFormWedges(
        outcome,
        numbers[0],
        rest[1:3],
        rest[3],
        rest[4],
        rest[5:8],
        rest[8:11],
        rest[11],
        rest[12],
        rest[13],
        rest[14:],
    )


def wedge_columns(
    wedges: WedgeArrays, array_class: type[WedgeArrays], joints: Sequence[str]
) -> tuple[Columns, int]:
    """Return the inputs of wedges on these joints by name, the fields of `array_class`, and the number of wedges.

    Raises
    ------
    ValueError
        The arrays do not fit together.
    """
    inputs: dict[str, ArrayLike | None] = {
        field.name: getattr(wedges, field.name) for field in fields(array_class)
    }
    for name in ("pressures_kpa", "force_kn", "passive_kn"):
        del inputs[name]
    if (count := len(wedges.pressures_kpa)) not in (0, len(joints), len(joints) + 1):
        raise ValueError(
            f"pressures_kpa holds {count} values: {', '.join(joints)} and maybe the crack"
        )
    inputs |= {f"pressure{k}_kpa": value for k, value in enumerate(wedges.pressures_kpa, 1)}
    if wedges.force_kn is not None:
        inputs |= dict(zip(_FORCE, wedges.force_kn, strict=True))
    if (wedges.crack_dip_deg is None) != (wedges.crack_dip_direction_deg is None):
        raise ValueError("crack_dip_deg and crack_dip_direction_deg: give both or neither")
    return with_passive(*float_columns(inputs), wedges.passive_kn)


def _solve(columns: Columns, outcome: Codes, numbers: Floats) -> None:
    """Write outcomes and numbers of a chunk of wedges into the arrays."""
    cut = planes_cut(columns, outcome.size)
    formed: Any = slice(None)
    if np.count_nonzero(cut.formed) < _MIN_FORMED_SHARE * outcome.size:
        formed = np.flatnonzero(cut.formed)
        columns = selected_columns(columns, formed)
    formed_cut = cut if isinstance(formed, slice) else cut.selected(formed)
    outcome[formed], formed_numbers = _slides(columns, formed_cut)
    for row, values in zip(numbers, formed_numbers, strict=False):
        row[formed] = values
    unformed = np.flatnonzero(~cut.formed)
    if unformed.size:
        outcome[unformed] = _refusal_codes(cut.selected(unformed))
    refused = np.flatnonzero(outcome >= _REFUSED)
    if refused.size:
        for row in numbers:
            row[refused] = np.nan


# -- whether the planes form a wedge (the tests of geometry.rock.rockmass, in its order) -----------------------------


class PlanesCut(NamedTuple):
    """Geometry that follows from the normals of the planes of wedges, (k, m) of k planes or lines.

    `lines` are cross products of normals: the traces of J1 and J2 on the face, the line of intersection, the crest;
    `squares` of their lengths, `length` that of the line of intersection; `climbs` are n_upper · line of the first
    three, `outward` is n_face · line of intersection, `offset` of the upper slope.
    """

    normals: Vector
    lines: Vector
    squares: Floats
    length: Floats
    climbs: Floats
    outward: Floats
    high: Floats
    offset: Floats
    formed: Bools

    def selected(self, numbers: NDArray[np.intp]) -> "PlanesCut":
        def select(values: Any) -> Any:
            return (
                tuple(map(select, values))
                if isinstance(values, tuple)
                else values.take(numbers, axis=-1)
            )

        return PlanesCut(*map(select, self))


def planes_cut(columns: Columns, count: int) -> PlanesCut:
    """Return the geometry that follows from the normals of the planes of wedges."""
    names = _PLANES if "crack_dip_deg" in columns else _PLANES[:_CRACK]
    angles = np.empty((2, len(names), count))
    for plane, (dip, direction) in enumerate(names):
        angles[0, plane], angles[1, plane] = columns[dip], columns[direction]
    angles *= _RADIAN
    sine, cosine = np.sin(angles), np.cos(angles)
    normals = sine[0] * sine[1], sine[0] * cosine[1], cosine[0]

    buffer = np.empty((3, 4, count))
    lines = buffer[0], buffer[1], buffer[2]
    cross(rows(normals, slice(2)), rows(normals, _FACE), rows(lines, slice(2)))
    cross(
        rows(normals, slice(J1, 4, 2)), rows(normals, slice(J2, 4, 2)), rows(lines, slice(_LINE, 4))
    )
    squares = dot(lines, lines)
    long = np.sqrt(squares[_LINE])
    climbs = dot(rows(normals, UPPER), rows(lines, slice(_CREST)))
    outward = dot(rows(normals, _FACE), rows(lines, _LINE))
    trace1, rise = lines[2][J1], lines[2][_LINE]
    high = columns["height_m"] / trace1
    offset = dot(rows(normals, UPPER), times(rows(lines, J1), high))
    # into the rock the line climbs, out of the face and to the upper slope
    least, toward = DAYLIGHTS * long, np.copysign(1.0, outward)
    formed = (
        (np.minimum.reduce(squares) >= SAME_DIRECTION**2)
        & (np.abs(outward) > least)
        & (rise * toward < -least)
    )
    formed &= (
        (climbs[_LINE] * toward < -least) & (np.abs(trace1) >= SAME_DIRECTION) & (offset > 0.0)
    )
    formed &= climbs[J2] * climbs[J2] >= SAME_DIRECTION**2 * squares[J2]
    return PlanesCut(normals, lines, squares, long, climbs, outward, high, offset, formed)


def _refusal_codes(cut: PlanesCut) -> Codes:
    """Return the code of why planes form no wedge, (m,): that of the first test that fails."""
    climbs, outward, rise = cut.climbs, cut.outward, cut.lines[2][_LINE]
    least, toward, parallel = (
        DAYLIGHTS * cut.length,
        np.copysign(1.0, outward),
        cut.squares < SAME_DIRECTION**2,
    )
    daylights = (
        (np.abs(outward) > least) & (rise * toward < -least) & (climbs[_LINE] * toward < -least)
    )
    codes = np.full(outward.size, _E208)
    for condition, code in (
        (climbs[J2] * climbs[J2] < SAME_DIRECTION**2 * cut.squares[J2], _NUMBER["E206"]),
        (cut.offset <= 0.0, _NUMBER["E209"]),
        (np.abs(cut.lines[2][J1]) < SAME_DIRECTION, _NUMBER["E206"]),
        (~daylights, _daylight_codes(rows(cut.lines, _LINE), rows(cut.normals, _FACE))),
        (parallel[J1] | parallel[J2], _NUMBER["E206"]),
        (parallel[_CREST], _NUMBER["E209"]),
        (parallel[_LINE], _NUMBER["E201"]),
    ):
        codes = np.where(condition, code, codes)
    return codes


def _daylight_codes(line: Vector, face: Vector) -> Codes:
    """Return why lines of intersection do not daylight, (m,): E204 into the slope, E203 too steep, E205 too flat."""
    down = np.where(line[2] > 0.0, -1.0, 1.0)
    level, flat = np.hypot(line[0], line[1]), np.hypot(face[0], face[1])
    plunge = np.arctan2(np.abs(line[2]), level)
    ahead = np.where(
        flat < SMALL,
        line[1],
        (line[0] * face[0] + line[1] * face[1]) * np.copysign(1.0, face[2]) / flat,
    )
    cosine = down * ahead / level
    apparent = np.arctan(flat / np.abs(face[2]) * cosine)
    codes = np.where(plunge >= apparent - math.radians(ALONG), _NUMBER["E203"], _NUMBER["E205"])
    codes[(plunge < math.radians(ALONG)) | (cosine <= 0.0)] = _NUMBER["E204"]
    for number in np.flatnonzero(np.abs(cosine) < ALONG):
        codes[number] = _along_the_slope(
            np.array([component[number] for component in line]),
            [float(component[number]) for component in face],
        )
    return codes


def _along_the_slope(across: Floats, face: Sequence[float]) -> np.int8:
    """Return E203, E204 or E205 for a line just along the slope, as round angles give it: the last bit decides.

    The computation repeats that of the geometry exactly, with the length of the line by BLAS.
    """
    line = across / math.sqrt(float(across @ across))
    east, north, up = (-line if line[2] > 0.0 else line).tolist()
    plunge = math.degrees(math.atan2(-up, math.hypot(east, north)))
    flat = math.hypot(face[0], face[1])
    dip = (
        (0.0, 1.0, 0.0)
        if flat < SMALL
        else (face[0] * face[2] / flat, face[1] * face[2] / flat, -flat)
    )
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
    code: (
        Codes | None
    )  # where the volume vanishes E208, where the crack misses the wedge E207, else 0; None for all 0


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
        return _cracked(
            columns, cut, _Shape(areas, inward, volume, volume, None, back, code), crests
        )
    return _Shape(areas, inward, volume, _height_range(points[2]), None, back, code)


def _cracked(columns: Columns, cut: PlanesCut, uncut: _Shape, crests: Vector) -> _Shape:
    """Return the shape of the wedge in front of the crack."""
    crack, upper, back = rows(cut.normals, _CRACK), rows(cut.normals, UPPER), uncut.line
    crest1, distance = rows(crests, 0), columns["crack_distance_m"]
    trace = less(back, crest1)
    long = length(trace)
    offset, crossing = dot(crack, plus(crest1, times(trace, distance / long))), dot(crack, back)
    share = offset / crossing
    meets = (share > 1e-9) & (share < 1.0 - 1e-9) & (distance < long)
    meets &= np.abs(crossing) >= SAME_DIRECTION * length(back)
    meets &= (
        np.minimum.reduce(length(cross(crack, rows(cut.normals, [J1, J2, UPPER]))))
        >= SAME_DIRECTION
    )

    bottom, directions = times(back, share), less(back, crests)
    tops = plus(crests, times(directions, (offset - dot(crack, crests)) / dot(crack, directions)))
    deep, high = less(bottom, back), less(tops, back)
    behind = np.abs(dot(deep, cross(rows(high, 0), rows(high, 1)))) / 6.0
    sides = less(tops, bottom)
    crack_area = length(cross(rows(sides, 0), rows(sides, 1))) / 2.0
    turn = np.where(offset > 0.0, -1.0, 1.0)
    inward = tuple(
        np.vstack([joints, row * turn]) for joints, row in zip(uncut.inward, crack, strict=True)
    )
    code = np.where(meets, 0 if uncut.code is None else uncut.code, _E207).astype(np.int8)
    return _Shape(
        np.vstack([uncut.areas - length(cross(deep, high)) / 2.0, crack_area]),
        (inward[0], inward[1], inward[2]),
        uncut.volume - behind,
        _height_range(np.vstack([crests[2], bottom[2], tops[2]])),
        (cut.offset - dot(upper, bottom)) / upper[2],
        bottom,
        code,
    )


def _height_range(heights: Floats) -> Floats:
    """Return the height from the lowest to the highest of the corners (k, m), with the toe at 0."""
    reach: Floats = np.maximum(np.maximum.reduce(heights), 0.0) - np.minimum(
        np.minimum.reduce(heights), 0.0
    )
    return reach


# -- how it moves -------------------------------------------------------------------------------------


def _slides(columns: Columns, cut: PlanesCut) -> tuple[Codes, Sequence[Floats | float]]:
    """Return outcomes and the numbers of `ClosedFormWedges`, of wedges that the planes form."""
    shape = _shape(columns, cut)
    weight = columns["unit_weight_kn_m3"] * shape.volume
    pressures = mean_pressures(columns, 2, shape.total_height, shape.crack_depth)
    load, size = _load(columns, cut, shape, weight, pressures)
    line = times(rows(cut.lines, _LINE), 1.0 / cut.length)
    joints = rows(shape.inward, slice(2))
    between = dot(rows(joints, J1), rows(joints, J2))
    strength = np.empty((2, 2, weight.size))
    for joint, number in ((J1, 1), (J2, 2)):
        strength[0, joint], strength[1, joint] = (
            columns[f"cohesion{number}_kpa"],
            columns[f"friction{number}_deg"],
        )
    pair = JointPair(
        joints,
        line,
        between,
        1.0 - between * between,
        strength[0] * shape.areas[:2],
        np.tan(strength[1] * _RADIAN),
        size,
    )

    slide = pair.slide(load)
    outcome, normal, driving, resisting, _ = slide
    factor = resisting / driving
    is_stable = outcome > SLIDES_UP
    if is_stable.any():
        factor[is_stable], driving[is_stable] = np.nan, 0.0
    apply_passive_bolts(pair, load, columns, cut.formed, slide, factor)
    driving[outcome > SLIDES_UP] = 0.0
    if shape.code is not None:
        outcome = np.where(shape.code, shape.code, outcome)
    areas = shape.areas if len(shape.areas) == 3 else [*shape.areas, 0.0]
    return outcome, [
        factor,
        *normal,
        driving,
        resisting,
        *areas,
        *pressures,
        shape.volume,
        weight,
        shape.total_height,
        *shape.line,
    ]


def mean_pressures(
    columns: Columns, joints: int, height: Floats, crack_depth: Floats | None
) -> list[Value]:
    """Return the mean pressures (kPa) on so many joints and the crack: γ_w H/6, with a crack γ_w h₅/3 on all."""
    water = columns["water_unit_weight_kn_m3"]
    full = 0.0 if crack_depth is None else water * crack_depth / 3.0
    crack_pressure = columns["crack_fill"] * full if "crack_fill" in columns else None
    if "pressure1_kpa" in columns:
        crack_input = columns.get(f"pressure{joints + 1}_kpa", 0.0)
        return [
            *(columns[f"pressure{k}_kpa"] for k in range(1, joints + 1)),
            crack_input if crack_pressure is None else crack_pressure,
        ]
    if crack_depth is None:
        return [*[columns["fill"] * water * height / 6.0] * joints, 0.0]
    mean = columns["fill"] * full
    return [*[mean] * joints, mean if crack_pressure is None else crack_pressure]


def _load(
    columns: Columns, cut: PlanesCut, shape: _Shape, weight: Floats, pressures: list[Value]
) -> tuple[Vector, Floats]:
    """Return the resultant of all loads (kN), and the sum of their magnitudes."""
    load: Vector = (0.0, 0.0, -weight)
    if not _is_zero(columns["seismic"]):
        if "seismic_trend_deg" in columns:
            trend = np.radians(columns["seismic_trend_deg"])
        else:
            down = np.where(cut.lines[2][_LINE] < 0.0, 1.0, -1.0)
            trend = np.arctan2(cut.lines[0][_LINE] * down, cut.lines[1][_LINE] * down)
        push = weight * columns["seismic"]
        load = push * np.sin(trend), push * np.cos(trend), -weight
    return with_water_and_forces(columns, load, weight, pressures, shape.areas, shape.inward)


def with_water_and_forces(
    columns: Columns,
    load: Vector,
    size: Floats,
    pressures: list[Value],
    areas: Floats,
    inward: Vector,
) -> tuple[Vector, Floats]:
    """Return a load plus the water on each plane and the forces, and the sum of all their magnitudes (kN)."""
    for pressure, area, *normal in zip(pressures, areas, *inward, strict=False):
        if not _is_zero(pressure):
            push = pressure * area
            load = plus(load, times((normal[0], normal[1], normal[2]), push))
            size = size + np.abs(push)
    if _FORCE[0] in columns:
        force = columns[_FORCE[0]], columns[_FORCE[1]], columns[_FORCE[2]]
        load, size = plus(load, force), size + length(force)
    return load, size


def _is_zero(value: Value) -> bool:
    return isinstance(value, float) and value == 0.0
