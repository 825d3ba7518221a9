"""Many wedges step by step as `geometry.rockmass` and `closed_form.wedge` take one: slow, sure, and every load.

Every product and sum stands in the order of the scalar functions, every sine comes from `math`: the answers are
theirs to the last bit also where a wedge is so badly conditioned that the last bit decides. `wedges` hands over what
it cannot vouch for.
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.closed_form.as_math import each
from slopekit.closed_form.given import Codes, Columns, Floats, Indices, Value, selected
from slopekit.closed_form.wedge_arrays import NUMBER_OF, WedgeShapes
from slopekit.orientation import normals

Vector = tuple[Value, Value, Value]
_PLANES = ("joint1", "joint2", "face", "upper")
_PARALLEL = 1e-6  # sine of the angle below which two planes are one, as in geometry.rockmass
_DAYLIGHTS = 1e-12
_SMALL = 1e-12


def wedges_in_steps(columns: Columns, count: int) -> tuple[Codes, Floats]:
    """Outcome (m,) and factor (m,) of each wedge, as the scalar functions find them.

    Parameters
    ----------
    columns : each value a float or an (m,) array; count : m
    """
    outcome, factor = _refused(columns, count), np.full(count, np.nan)
    formed = np.flatnonzero(outcome < 0)
    if formed.size:
        part = selected(columns, formed)
        outcome[formed], factor[formed] = _solved(part, _shape(part), formed.size)
    return outcome, factor


def shapes_in_steps(columns: Columns, count: int) -> WedgeShapes:
    """The shapes of wedges that the planes do cut.

    Parameters
    ----------
    columns : each value a float or an (m,) array; count : m
    """
    shape = _shape(columns)
    trend, plunge = _trend_and_plunge(shape.down)
    parts = (
        shape.volume, columns["unit_weight_kn_m3"] * shape.volume, shape.total_height, trend, plunge,
        _length(shape.back), *shape.areas,
    )  # fmt: skip
    volume, weight, height, trend, plunge, length, *areas = (np.broadcast_to(part, count) for part in parts)
    return WedgeShapes(volume, weight, height, np.stack(areas, axis=1), trend, plunge, length)


# -- do the planes cut a wedge at all (geometry.rockmass) ---------------------------------------------


def _refused(columns: Columns, count: int) -> Codes:
    """The code of the planes that cut no wedge, -1 where they cut one: the first test that fails counts."""
    codes = np.full(count, -1, dtype=np.int8)

    def refuse(code: str, where: Value) -> None:
        codes[(codes < 0) & where] = NUMBER_OF[code]

    joint1, joint2, face, upper = (_unit(columns, name) for name in _PLANES)
    across = _cross(joint1, joint2)
    sine = _length(across)
    refuse("E201", sine < _PARALLEL)
    refuse("E209", _length(_cross(face, upper)) < _PARALLEL)
    line = (across[0] / sine, across[1] / sine, across[2] / sine)
    into_rock = _scaled(line, np.where(_dot(face, line) > 0.0, -1.0, 1.0))
    trace1, trace2 = _cross(joint1, face), _cross(joint2, face)
    refuse("E206", (_length(trace1) < _PARALLEL) | (_length(trace2) < _PARALLEL))

    daylights = (
        (_dot(upper, into_rock) > _DAYLIGHTS) & (into_rock[2] > _DAYLIGHTS) & (_dot(face, into_rock) < -_DAYLIGHTS)
    )
    hidden = np.flatnonzero((codes < 0) & ~daylights)
    if hidden.size:
        codes[hidden] = _why_hidden(*(_at(vector, hidden, count) for vector in (across, face)))

    refuse("E206", np.abs(trace1[2]) < _PARALLEL)
    crest1 = _scaled(trace1, columns["height_m"] / trace1[2])
    offset = _dot(upper, crest1)
    refuse("E209", offset <= 0.0)
    refuse("E206", np.abs(_dot(upper, trace2)) < _PARALLEL * _length(trace2))
    if "crack_dip_deg" in columns:
        back = _scaled(into_rock, offset / _dot(upper, into_rock))
        refuse("E207", _crack_misses(columns, back, crest1, (joint1, joint2, upper)))
    return codes


def _why_hidden(across: Vector, face: Vector) -> Codes:
    """Why a line of intersection does not daylight: E204 into the slope, E203 too steep, E205 too flat.

    Between E204 and E203 the last bit decides where the line runs just along the slope, as those of round angles may:
    its length is taken as geometry takes it, by BLAS.
    """
    rows = np.stack(across, axis=1)
    sine = np.sqrt(np.fromiter((row @ row for row in rows), dtype=np.float64, count=len(rows)))
    line = (across[0] / sine, across[1] / sine, across[2] / sine)
    down = _scaled(line, np.where(line[2] > 0.0, -1.0, 1.0))
    trend, plunge = _trend_and_plunge(down)
    flat = each(math.hypot, face[0], face[1])
    level = np.less(flat, _SMALL)
    east, north, up = face[0] * face[2] / flat, face[1] * face[2] / flat, -flat
    dip_vector = (np.where(level, 0.0, east), np.where(level, 1.0, north), np.where(level, 0.0, up))
    face_trend, face_plunge = _trend_and_plunge(dip_vector)
    cosine = each(math.cos, np.radians(trend - face_trend))
    apparent = np.degrees(each(math.atan, each(math.tan, np.radians(face_plunge)) * cosine))
    code = np.where(plunge >= apparent - 1e-9, NUMBER_OF["E203"], NUMBER_OF["E205"])
    code[(np.abs(plunge) < 1e-9) | (cosine <= 0.0)] = NUMBER_OF["E204"]
    return code.astype(np.int8)


def _crack_misses(columns: Columns, back: Vector, crest1: Vector, planes: tuple[Vector, ...]) -> Value:
    crack = _unit(columns, "crack")
    misses: Value = False
    for plane in planes:
        misses = misses | (_length(_cross(crack, plane)) < _PARALLEL)
    trace = _add(back, crest1, -1.0)
    length = _length(trace)
    distance = columns["crack_distance_m"]
    offset = _dot(crack, _add(crest1, trace, distance / length))
    crossing = _dot(crack, back)
    share = offset / crossing
    misses = misses | (distance >= length) | (np.abs(crossing) < _PARALLEL * _length(back))
    return misses | ~((share > 1e-9) & (share < 1.0 - 1e-9))


# -- the closed form (closed_form.wedge) --------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Shape:
    areas: Vector
    encloses: Value  # a volume, before the crack cuts some off
    volume: Value
    total_height: Value
    crack_depth: Value
    inward: tuple[Vector, Vector, Vector]
    back: Vector
    down: Vector


def _solved(columns: Columns, shape: _Shape, count: int) -> tuple[Codes, Floats]:
    """Statuses and factors of wedges."""
    weight = columns["unit_weight_kn_m3"] * shape.volume
    pushes = [pressure * area for pressure, area in zip(_pressures(columns, shape), shape.areas, strict=True)]
    load = _load(columns, shape, weight, pushes)
    size = weight + sum(abs(push) for push in pushes)
    if "force_east_kn" in columns:
        size = size + _length(_force(columns))
    tangents = [np.tan(np.radians(columns[f"friction{k}_deg"])) for k in (1, 2)]
    bonds = [columns[f"cohesion{k}_kpa"] * area for k, area in zip((1, 2), shape.areas, strict=False)]
    status, factor = _slide(load, shape.inward, size, bonds, tangents, count)
    empty = np.broadcast_to(~shape.encloses, count)
    status[empty], factor[empty] = NUMBER_OF["E208"], np.nan
    return status, factor


def _shape(columns: Columns) -> _Shape:
    n1, n2, nf, nu = (_normal(columns, name) for name in _PLANES)
    trace1, trace2, line = _cross(n1, nf), _cross(n2, nf), _cross(n1, n2)
    crest1 = _scaled(trace1, columns["height_m"] / trace1[2])
    offset = _dot(nu, crest1)
    crest2 = _scaled(trace2, offset / _dot(nu, trace2))
    back = _scaled(line, offset / _dot(nu, line))
    volume = abs(_dot(crest1, _cross(crest2, back))) / 6.0
    encloses = np.greater(volume, 0.0)
    area1, area2, area5 = _length(_cross(crest1, back)) / 2.0, _length(_cross(crest2, back)) / 2.0, 0.0
    inward1 = _scaled(n1, np.where(_dot(n1, crest2) > 0.0, 1.0, -1.0))
    inward2 = _scaled(n2, np.where(_dot(n2, crest1) > 0.0, 1.0, -1.0))
    down = _scaled(line, np.where(line[2] < 0.0, 1.0, -1.0))
    if "crack_dip_deg" not in columns:
        total = _reach(crest1, crest2, back)
        return _Shape(
            (area1, area2, area5), encloses, volume, total, 0.0, (inward1, inward2, (0.0, 0.0, 0.0)), back, down
        )
    n5 = _normal(columns, "crack")
    along = _add(back, crest1, -1.0)
    offset5 = _dot(n5, _add(crest1, along, columns["crack_distance_m"] / _length(along)))
    bottom = _scaled(back, offset5 / _dot(n5, back))
    top1, top2 = (_where(crest, back, n5, offset5) for crest in (crest1, crest2))
    to_bottom, to_1, to_2 = (_add(point, back, -1.0) for point in (bottom, top1, top2))
    volume = volume - abs(_dot(to_bottom, _cross(to_1, to_2))) / 6.0
    area1 = area1 - _length(_cross(to_bottom, to_1)) / 2.0
    area2 = area2 - _length(_cross(to_bottom, to_2)) / 2.0
    area5 = _length(_cross(_add(top1, bottom, -1.0), _add(top2, bottom, -1.0))) / 2.0
    depth = (offset - _dot(nu, bottom)) / nu[2]
    inward5 = _scaled(n5, np.where(np.greater(offset5, 0.0), -1.0, 1.0))
    total = _reach(crest1, crest2, bottom, top1, top2)
    return _Shape((area1, area2, area5), encloses, volume, total, depth, (inward1, inward2, inward5), bottom, down)


def _reach(*corners: Vector) -> Value:
    """Height from the lowest to the highest corner, the toe at 0 among them."""
    high: Value = 0.0
    low: Value = 0.0
    for corner in corners:
        high, low = np.maximum(high, corner[2]), np.minimum(low, corner[2])
    return high - low


def _pressures(columns: Columns, shape: _Shape) -> tuple[Value, Value, Value]:
    full = columns["water_unit_weight_kn_m3"] * shape.crack_depth / 3.0
    own = columns["crack_fill"] * full if "crack_fill" in columns else None
    if "pressure1_kpa" in columns:
        given = columns.get("pressure3_kpa", 0.0)
        return columns["pressure1_kpa"], columns["pressure2_kpa"], given if own is None else own
    if "crack_dip_deg" in columns:
        mean = columns["fill"] * full
        return mean, mean, mean if own is None else own
    mean = columns["fill"] * columns["water_unit_weight_kn_m3"] * shape.total_height / 6.0
    return mean, mean, 0.0


def _load(columns: Columns, shape: _Shape, weight: Value, pushes: list[Value]) -> Vector:
    load: Vector = (0.0, 0.0, -weight)
    if "seismic" in columns:
        if "seismic_trend_deg" in columns:
            trend = np.radians(columns["seismic_trend_deg"])
        else:
            trend = each(math.atan2, shape.down[0], shape.down[1])
        push = weight * columns["seismic"]
        load = (push * each(math.sin, trend), push * each(math.cos, trend), -weight)
    for push, normal in zip(pushes, shape.inward, strict=True):
        load = _add(load, normal, push)
    return _add(load, _force(columns), 1.0) if "force_east_kn" in columns else load


def _force(columns: Columns) -> Vector:
    return columns["force_east_kn"], columns["force_north_kn"], columns["force_up_kn"]


def _slide(
    load: Vector, inward: tuple[Vector, Vector, Vector], size: Value, bonds: list[Value], tangents: list[Value],
    count: int,
) -> tuple[Codes, Floats]:  # fmt: skip
    """Mode of sliding from the resultant: off both, along one, along both joints; its factor."""
    n1, n2, _ = inward
    on1, on2, between = _dot(load, n1), _dot(load, n2), _dot(n1, n2)
    status = np.full(count, -1, dtype=np.int8)
    factor = np.full(count, np.nan)

    def decide(where: Value, names: tuple[str, str], up: Value, driving: Value, resisting: Value) -> None:
        """Those of `where` that nothing was decided about: still, up or along, with their factor."""
        fresh = (status < 0) & where
        still = fresh & np.less_equal(driving, _SMALL * size)
        status[fresh] = np.where(up, NUMBER_OF[names[1]], NUMBER_OF[names[0]] + np.zeros(count))[fresh]
        status[still] = NUMBER_OF["no_driving_force"]
        moves = fresh & ~still
        factor[moves] = np.broadcast_to(resisting / driving, count)[moves]

    off = np.greater_equal(on1, 0.0) & np.greater_equal(on2, 0.0)
    hangs_over = np.maximum(n1[2], n2[2]) <= 0.0
    decide(off, ("lifted", "falls"), hangs_over, _length(load), np.nan)
    for k, (own, other, n) in enumerate(((on1, on2, n1), (on2, on1, n2))):
        along = _add(load, n, -own)
        alone = np.less(own, 0.0) & (other - own * between >= 0.0)
        resisting = bonds[k] + -own * tangents[k]
        decide(alone, (f"slides_on_J{k + 1}", "slides_up"), np.greater(along[2], 0.0), _length(along), resisting)
    line = _cross(n1, n2)
    line = _scaled(line, 1.0 / _length(line))
    driving = _dot(load, line)
    share = 1.0 - between * between
    on_both = ((on2 * between - on1) / share, (on1 * between - on2) / share)
    resisting = (bonds[0] + on_both[0] * tangents[0]) + (bonds[1] + on_both[1] * tangents[1])
    up = np.where(np.greater(driving, 0.0), line[2], -line[2]) > 0.0
    decide(True, ("slides_on_both", "slides_up"), up, np.abs(driving), resisting)
    return status, factor


# -- vectors ------------------------------------------------------------------------------------------


def _unit(columns: Columns, plane: str) -> Vector:
    """Upward unit normal as geometry gets it, from `orientation`."""
    normal = normals(*np.broadcast_arrays(columns[f"{plane}_dip_deg"], columns[f"{plane}_dip_direction_deg"]))
    return normal[..., 0], normal[..., 1], normal[..., 2]


def _normal(columns: Columns, plane: str) -> Vector:
    """Upward unit normal as the scalar closed form makes it."""
    dip, direction = (np.radians(columns[f"{plane}_{angle}_deg"]) for angle in ("dip", "dip_direction"))
    sine = each(math.sin, dip)
    return sine * each(math.sin, direction), sine * each(math.cos, direction), each(math.cos, dip)


def _trend_and_plunge(vector: Vector) -> tuple[Floats, Floats]:
    """As `orientation.line_of`, degrees."""
    trend = np.degrees(each(math.atan2, vector[0], vector[1])) % 360.0
    return trend, np.degrees(each(math.atan2, -vector[2], each(math.hypot, vector[0], vector[1])))


def _where(start: Vector, end: Vector, normal: Vector, offset: Value) -> Vector:
    """Where the line from start to end crosses a plane."""
    way = _add(end, start, -1.0)
    return _add(start, way, (offset - _dot(normal, start)) / _dot(normal, way))


def _at(vector: Vector, where: Indices, count: int) -> Vector:
    east, north, up = (np.broadcast_to(part, count)[where] for part in vector)
    return east, north, up


def _dot(a: Vector, b: Vector) -> Value:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _add(a: Vector, b: Vector, times: Value) -> Vector:
    return a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]


def _scaled(a: Vector, by: Value) -> Vector:
    return a[0] * by, a[1] * by, a[2] * by


def _length(a: Vector) -> Value:
    length: Value = np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    return length
