"""A wedge on three joints in vector form, over arrays: two joints that bound it and a basal joint under it.

The block is what lies above the basal joint and on the wedge's side of J1 and J2, in front of a crack, below the face
and the upper slope. Its areas and volume come from its edges: each is a line in which two of the planes meet, clipped
by the others (Cyrus & Beck 1978 (m)); the way it moves is the resultant's projection on the cone of movements that the
joints leave (Warburton 1981; Goodman & Shi 1985, ch. 9): along one plane, along the line of two, or held by all three.
Forces only, zero dilation, cohesion only on planes in contact.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from slopekit.closed_form.inputs import Codes, Columns, selected_columns
from slopekit.closed_form.tolerances import SAME_DIRECTION, SMALL
from slopekit.closed_form.wedge import (
    ClosedFormWedges,
    WedgeArrays,
    mean_pressures,
    wedge_columns,
    with_water_and_forces,
)
from slopekit.closed_form.wedge_sliding import (
    FALLS,
    LIFTED,
    NO_DRIVING_FORCE,
    SLIDES_UP,
    STATUSES,
    Vector,
    WedgeSlide,
    apply_passive_bolts,
    cross,
    dot,
    length,
    plus,
    rows,
    single_wedge,
    times,
)
from slopekit.core.array_types import ArrayLike, Bools, Floats

#: Outcomes of a wedge on three joints; the statuses of a wedge on two joints have the same numbers.
OUTCOMES: Final = (
    "slides_on_J1_and_J2",
    *STATUSES[1:],
    "slides_on_basal",
    "slides_on_J1_and_basal",
    "slides_on_J2_and_basal",
    "E434",
    "E206",
    "E209",
    "E441",
    "E443",
    "E442",
    "E440",
    "E207",
    "E232",
)
_NUMBER: Final = {name: np.int8(number) for number, name in enumerate(OUTCOMES)}
_REFUSED: Final = _NUMBER["E434"]
_CHUNK: Final = 2048  # edges take fifteen rows of each
_RADIAN: Final = math.pi / 180.0
_NO_FACE: Final = (
    1e-12  # area of a face that counts as none, as a fraction of the surface of the block
)

_J1, _J2, _BASAL, _FACE, _UPPER, _CRACK = range(6)
_PLANES: Final = ("joint1", "joint2", "basal", "face", "upper", "crack")
_PAIRS: Final = ((_J1, _J2), (_J1, _BASAL), (_J2, _BASAL))
# modes of sliding: off all, on one, along the line of two, at rest on three; and the outcome of each
_MODES: Final = ((), (_J1,), (_J2,), (_BASAL,), *_PAIRS, (_J1, _J2, _BASAL))
_MODE_OUTCOMES: Final = np.array(
    [
        LIFTED,
        *(
            _NUMBER[f"slides_on_{name}"]
            for name in ("J1", "J2", "basal", "J1_and_J2", "J1_and_basal", "J2_and_basal")
        ),
        NO_DRIVING_FORCE,
    ],
    dtype=np.int8,
)


@dataclass(frozen=True, kw_only=True)
class BasalWedgeArrays(WedgeArrays):
    """Wedges on three joints; what they share with those on two is as there, but for the water and the seismic trend.

    Attributes
    ----------
    basal_dip_deg, basal_dip_direction_deg : the basal joint; the block lies above it
    basal_height_m : vertical, from the point where J1, J2 and the face meet to where the basal joint meets the trace of
        J1 on the face; below 0 the block lies under that point (a socket wedge)
    cohesion3_kpa, friction3_deg : of the basal joint
    pressures_kpa : on J1, J2, the basal joint and maybe the crack
    fill : of γ_w H/6 on the three joints, H the height of the block; with a crack of γ_w h₅/3 on all, h₅ the depth of
        its lowest corner below the upper slope
    seismic_trend_deg : None for the dip direction of the face
    """

    basal_dip_deg: ArrayLike
    basal_dip_direction_deg: ArrayLike
    basal_height_m: ArrayLike
    cohesion3_kpa: ArrayLike
    friction3_deg: ArrayLike


def basal_wedges(wedges: BasalWedgeArrays) -> ClosedFormWedges:
    """Return outcome, factor of safety and forces of wedges on two joints and a basal joint, maybe with a crack.

    Raises
    ------
    ValueError
        The arrays do not fit together.

    Formula: with R the resultant and nᵢ the normals into the block, the block moves along the s of s = R + Σ Nᵢ nᵢ for
    which Nᵢ >= 0, s·nᵢ >= 0 and Nᵢ (s·nᵢ) = 0; F = Σ (cᵢAᵢ + Nᵢ tan φᵢ) / |s| over the planes in contact. Codes are
    those of `kinds.wedge.basal`.

    >>> wedges = BasalWedgeArrays(
    ...     joint1_dip_deg=75.0, joint1_dip_direction_deg=100.0, joint2_dip_deg=75.0, joint2_dip_direction_deg=260.0,
    ...     face_dip_deg=70.0, face_dip_direction_deg=180.0, upper_dip_deg=5.0, upper_dip_direction_deg=180.0,
    ...     height_m=20.0, cohesion1_kpa=0.0, cohesion2_kpa=0.0, friction1_deg=30.0, friction2_deg=30.0,
    ...     unit_weight_kn_m3=26.0, basal_dip_deg=[25.0, 45.0, 25.0], basal_dip_direction_deg=180.0,
    ...     basal_height_m=[5.0, 5.0, 25.0], cohesion3_kpa=0.0, friction3_deg=30.0,
    ... )
    >>> found = basal_wedges(wedges)
    >>> [OUTCOMES[outcome] for outcome in found.outcome], found.factor.round(4).tolist()
    (['slides_on_basal', 'slides_on_J1_and_J2', 'E441'], [1.2381, 2.8886, nan])
    """
    columns, count = wedge_columns(wedges, BasalWedgeArrays, ("J1", "J2", "the basal joint"))
    outcome, numbers = np.empty(count, dtype=np.int8), np.empty((17, count))
    with np.errstate(all="ignore"):
        for first in range(0, count, _CHUNK):
            chunk = slice(first, first + _CHUNK)
            outcome[chunk], chunk_numbers = _solved(
                selected_columns(columns, chunk), outcome[chunk].size
            )
            for row, values in zip(numbers, chunk_numbers, strict=True):
                row[chunk] = values
    numbers[:, outcome >= _REFUSED] = np.nan
    statuses = outcome < _REFUSED
    numbers[
        0, statuses & ((outcome == LIFTED) | (outcome == FALLS) | (outcome == NO_DRIVING_FORCE))
    ] = np.nan
    volume, weight, height = numbers[14:]
    on_joints = numbers[1:4], numbers[4], numbers[5], numbers[6:10], numbers[10:14]
    return ClosedFormWedges(
        outcome, numbers[0], *on_joints, volume, weight, height, np.empty((3, 0))
    )


# -- the block --------------------------------------------------------------------------------------------------------


class _ConvexBlock(NamedTuple):
    """Inward normals of the planes, three of (k, m), and areas (k, m), volume, height and crack depth of the block.

    code : why there is no block, else 0
    """

    inward: Vector
    areas: Floats
    volume: Floats
    height: Floats
    crack_depth: Floats | None
    code: Codes


def _block(columns: Columns, count: int) -> _ConvexBlock:
    names = _PLANES if "crack_dip_deg" in columns else _PLANES[:_CRACK]
    angles = np.empty((2, len(names), count))
    for plane, name in enumerate(names):
        angles[0, plane], angles[1, plane] = (
            columns[f"{name}_dip_deg"],
            columns[f"{name}_dip_direction_deg"],
        )
    angles *= _RADIAN
    sine, cosine = np.sin(angles), np.cos(angles)
    upward = sine[0] * sine[1], sine[0] * cosine[1], cosine[0]
    face, upper, joints = (
        rows(upward, _FACE),
        rows(upward, _UPPER),
        rows(upward, slice(_J1, _BASAL)),
    )

    traces = cross(joints, (face[0][None], face[1][None], face[2][None]))
    squares, line = dot(traces, traces), cross(rows(joints, 0), rows(joints, 1))
    crest_edge = cross(face, upper)
    up1 = times(rows(traces, 0), 1.0 / traces[2][0])  # J1's trace, by a metre of height
    crest1 = times(up1, columns["height_m"])
    offset = dot(upper, crest1)
    climb = dot(upper, rows(traces, 1))
    crest2 = times(rows(traces, 1), offset / climb)
    code = _last_true_code(
        (climb * climb < SAME_DIRECTION**2 * squares[1], "E206"),
        (~(offset > 0.0), "E209"),
        (np.abs(traces[2][0]) < SAME_DIRECTION, "E206"),
        ((squares < SAME_DIRECTION**2).any(axis=0), "E206"),
        (dot(crest_edge, crest_edge) < SAME_DIRECTION**2, "E209"),
        (dot(line, line) < SAME_DIRECTION**2, "E434"),
    )

    # the wedge lies between the traces, above the point in which they meet or, a socket wedge, below it
    basal_point = times(up1, columns["basal_height_m"])
    below = np.where(columns["basal_height_m"] < 0.0, -1.0, 1.0)
    sides = np.ones((len(names), count))
    sides[_J1] = np.copysign(1.0, dot(rows(upward, _J1), crest2)) * below
    sides[_J2] = np.copysign(1.0, dot(rows(upward, _J2), crest1)) * below
    sides[_FACE] = sides[_UPPER] = -1.0
    # offsets from where the basal joint meets J1's trace: of the face, J1 and the basal joint they vanish
    offsets = np.zeros((len(names), count))
    offsets[_J2], offsets[_UPPER] = (
        -dot(rows(upward, _J2), basal_point),
        offset - dot(upper, basal_point),
    )
    if len(names) > _CRACK:
        crack, along = rows(upward, _CRACK), cross(rows(upward, _J1), upper)
        into = np.copysign(1.0, -dot(face, along)) / length(along)
        ahead = dot(crack, times(along, into)) * columns["crack_distance_m"]
        sides[_CRACK] = np.where(ahead > 0.0, -1.0, 1.0)  # the crest lies in front of it
        offsets[_CRACK] = (
            dot(
                crack,
                (
                    crest1[0] - basal_point[0],
                    crest1[1] - basal_point[1],
                    crest1[2] - basal_point[2],
                ),
            )
            + ahead
        )
    inward = times(upward, sides)
    edges = _edges(inward, offsets * sides)
    areas, volume, height = edges.areas, edges.volume, edges.height
    depth = None
    if len(names) > _CRACK:
        on_crack = edges.has & (edges.planes == _CRACK).any(axis=1)[:, None]
        deep = [(offsets[_UPPER] - dot(upper, end)) / upper[2] for end in edges.ends]
        depth = np.where(on_crack, np.maximum(*deep), 0.0).max(axis=0)
    is_absent = areas <= _NO_FACE * areas.sum(axis=0)
    block_code = _last_true_code(
        (~_leads_out(inward, is_absent), "E232"),
        (is_absent[_CRACK] if len(names) > _CRACK else np.zeros(count, dtype=np.bool_), "E207"),
        (is_absent[_J1] | is_absent[_J2] | is_absent[_BASAL], "E440"),
        (is_absent[_FACE], "E442"),
        (edges.endless, "E443"),
        (~edges.endless & ~(volume > 0.0), "E441"),
    )
    return _ConvexBlock(inward, areas, volume, height, depth, np.where(code, code, block_code))


def _leads_out(inward: Vector, is_absent: Bools) -> Bools:
    """Return whether some movement that the joints allow leads out of a free face of the block, (m,)."""
    leaves = np.zeros(is_absent.shape[1], dtype=np.bool_)
    for first, second, third in ((_J1, _J2, _BASAL), (_J1, _BASAL, _J2), (_J2, _BASAL, _J1)):
        line = cross(rows(inward, first), rows(inward, second))
        edge = times(line, np.copysign(1.0, dot(line, rows(inward, third))))
        for free in (_FACE, _UPPER):
            leaves |= ~is_absent[free] & (dot(edge, rows(inward, free)) < -SAME_DIRECTION)
    return leaves


def _last_true_code(*rules: tuple[Bools, str]) -> Codes:
    """Return the number (m,) of the last code whose condition holds for each wedge, 0 where none does."""
    codes = np.zeros(len(rules[0][0]), dtype=np.int8)
    for condition, code in rules:
        codes[condition] = _NUMBER[code]
    return codes


class _BodyEdges(NamedTuple):
    """The edges of a convex body: planes (e, 2), both ends (e, m), a mask of the edges present, and areas."""

    planes: Any
    ends: tuple[Vector, Vector]
    has: Bools
    endless: Bools
    areas: Floats
    volume: Floats
    height: Floats


def _edges(inward: Vector, offsets: Floats) -> _BodyEdges:
    """Return the edges of the body n·x >= offset of k planes (k, m): their lines of intersection, clipped."""
    count = len(offsets)
    planes = np.array([(i, j) for i in range(count) for j in range(i)])
    first, second = planes.T
    first_normal, second_normal = rows(inward, list(first)), rows(inward, list(second))
    along = cross(first_normal, second_normal)
    line_length = length(along)
    along = times(along, 1.0 / line_length)
    # the point of the line next to the origin
    base = times(
        plus(
            times(cross(second_normal, along), offsets[first]),
            times(cross(along, first_normal), offsets[second]),
        ),
        1.0 / line_length,
    )
    low, high = np.full(line_length.shape, -np.inf), np.full(line_length.shape, np.inf)
    for plane in range(count):
        is_other_plane = (planes != plane).all(axis=1)[:, None]
        normal = rows(inward, plane)
        rate, room = dot(normal, along), offsets[plane] - dot(normal, base)
        position = room / rate
        low = np.where(is_other_plane & (rate > SMALL), np.maximum(low, position), low)
        high = np.where(is_other_plane & (rate < -SMALL), np.minimum(high, position), high)
        high = np.where(is_other_plane & (np.abs(rate) <= SMALL) & (room > 0.0), -np.inf, high)
    has = (line_length >= SAME_DIRECTION) & (high > low)
    endless: Bools = (has & ~(np.isfinite(low) & np.isfinite(high))).any(axis=0)
    has &= ~endless
    ends = tuple(plus(base, times(along, np.where(has, position, 0.0))) for position in (low, high))
    # around a face seen from outside the edges run along outward normal x that of the other plane: here inward, twice
    end_products = cross(ends[0], ends[1])
    areas = np.zeros(offsets.shape)
    for plane in range(count):
        for number, sign in ((0, 0.5), (1, -0.5)):
            on_plane = planes[:, number] == plane
            if on_plane.any():
                edge_areas = dot(
                    rows(inward, plane), rows(end_products, list(np.flatnonzero(on_plane)))
                )
                areas[plane] -= sign * np.where(has[on_plane], edge_areas, 0.0).sum(axis=0)
    heights = np.stack([ends[0][2], ends[1][2]])
    top = np.where(has, heights, -np.inf).max(axis=(0, 1))
    bottom = np.where(has, heights, np.inf).min(axis=(0, 1))
    volume = -(offsets * areas).sum(axis=0) / 3.0
    return _BodyEdges(planes, (ends[0], ends[1]), has, endless, areas, volume, top - bottom)


# -- how it moves -----------------------------------------------------------------------------------------------------


class JointTriple(NamedTuple):
    """The three joints (3, m): normals into the block, lines of J1 and J2, J1 and basal, J2 and basal, strength."""

    inward: Vector
    lines: Vector
    bonds: Floats
    tangents: Floats
    size: Floats

    def single(self, number: int) -> "JointTriple":
        """Return the joints of one wedge, (3, 1), for any number of loads."""
        return JointTriple(*(single_wedge(values, number) for values in self))

    def slide(self, load: Vector) -> WedgeSlide:
        """Return the mode of sliding in which no plane is in tension and none is penetrated.

        The block is off all planes, slides on one or two, or rests on three.
        """
        normal_load = dot(load, self.inward)
        count = normal_load.shape[-1]
        normals = np.zeros((len(_MODES), 3, count))
        movements: list[Vector] = []
        violation = np.empty((len(_MODES), count))
        for mode, planes in enumerate(_MODES):
            normal_forces = normals[mode]
            if len(planes) == 1:
                normal_forces[planes[0]] = -normal_load[planes[0]]
            elif len(planes) == 2:
                i, j = planes
                between = dot(rows(self.inward, i), rows(self.inward, j))
                share = 1.0 - between * between
                normal_forces[i], normal_forces[j] = (
                    (normal_load[j] * between - normal_load[i]) / share,
                    (normal_load[i] * between - normal_load[j]) / share,
                )
            elif len(planes) == 3:
                normal_forces[:] = self._three_plane_forces(load)
            movement = (
                load
                if not planes
                else plus(
                    load,
                    tuple((component * normal_forces).sum(axis=0) for component in self.inward),
                )
            )
            if len(planes) == 3:
                movement = times(movement, 0.0)
            movements.append(movement)
            entered = np.zeros(count)
            for plane in set(range(3)) - set(planes):
                entered = np.maximum(entered, -dot(movement, rows(self.inward, plane)))
            violation[mode] = np.maximum(entered, -normal_forces.min(axis=0))
        violation[~np.isfinite(violation)] = np.inf
        best_mode = np.argmin(violation, axis=0)
        wedges = np.arange(count)
        east, north, up = (
            np.stack([np.broadcast_to(movement[axis], count) for movement in movements])[
                best_mode, wedges
            ]
            for axis in range(3)
        )
        normal = normals[best_mode, :, wedges].T
        touching = np.array([[plane in planes for plane in range(3)] for planes in _MODES])[
            best_mode
        ].T
        driving = length((east, north, up))
        resisting = np.where(touching, self.bonds + normal * self.tangents, 0.0).sum(axis=0)
        outcome = _MODE_OUTCOMES[best_mode]
        is_off = outcome == LIFTED
        outcome = np.where((up > 0.0) & ~is_off, SLIDES_UP, outcome)
        highest = np.broadcast_to(np.maximum.reduce(self.inward[2]), is_off.shape)
        outcome = np.where(is_off & (highest <= 0.0), FALLS, outcome)
        outcome = np.where(driving <= SMALL * self.size, NO_DRIVING_FORCE, outcome).astype(np.int8)
        return WedgeSlide(outcome, normal, driving, resisting, (east, north, up))

    def _three_plane_forces(self, load: Vector) -> Floats:
        """Return the normal forces (3, m) on all three planes that balance the load, by Cramer's rule."""
        planes = [rows(self.inward, plane) for plane in range(3)]
        across = [cross(planes[(k + 1) % 3], planes[(k + 2) % 3]) for k in range(3)]
        space = dot(planes[0], across[0])
        return np.stack(
            [np.broadcast_to(-dot(load, normal) / space, np.shape(load[2])) for normal in across]
        )


def _solved(columns: Columns, count: int) -> tuple[Codes, Sequence[Any]]:
    """Return outcomes and the numbers of `ClosedFormWedges`, of a chunk."""
    block = _block(columns, count)
    weight = columns["unit_weight_kn_m3"] * block.volume
    pressures = mean_pressures(columns, 3, block.height, block.crack_depth)
    load, size = _load(columns, block, weight, pressures)
    joints = rows(block.inward, slice(3))
    lines = cross(rows(joints, [_J1, _J1, _J2]), rows(joints, [_J2, _BASAL, _BASAL]))
    strength = np.empty((2, 3, count))
    for joint in range(3):
        strength[0, joint] = columns[f"cohesion{joint + 1}_kpa"]
        strength[1, joint] = columns[f"friction{joint + 1}_deg"]
    triple = JointTriple(
        joints,
        times(lines, 1.0 / length(lines)),
        strength[0] * block.areas[:3],
        np.tan(strength[1] * _RADIAN),
        size,
    )
    slide = triple.slide(load)
    outcome, normal, driving, resisting, _ = slide
    factor = resisting / driving
    apply_passive_bolts(triple, load, columns, block.code == 0, slide, factor)
    driving = np.where(
        (outcome == LIFTED) | (outcome == FALLS) | (outcome == NO_DRIVING_FORCE), 0.0, driving
    )
    outcome = np.where(block.code, block.code, outcome)
    crack = block.areas[_CRACK] if len(block.areas) > _CRACK else 0.0
    return outcome, [
        factor,
        *normal,
        driving,
        resisting,
        *block.areas[:3],
        crack,
        *pressures,
        block.volume,
        weight,
        block.height,
    ]


def _load(
    columns: Columns, block: _ConvexBlock, weight: Floats, pressures: list[Any]
) -> tuple[Vector, Floats]:
    """Return the resultant of all loads (m,) kN, and the sum of their magnitudes."""
    trend = np.radians(
        columns["seismic_trend_deg" if "seismic_trend_deg" in columns else "face_dip_direction_deg"]
    )
    push = weight * columns["seismic"]
    load: Vector = (push * np.sin(trend), push * np.cos(trend), -weight)
    wet = [_J1, _J2, _BASAL, _CRACK][: 3 if block.crack_depth is None else 4]
    return with_water_and_forces(
        columns, load, weight, pressures, block.areas[wet], rows(block.inward, wet)
    )
