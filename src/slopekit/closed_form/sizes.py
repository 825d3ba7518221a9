"""Sizes of failures in a bench, over arrays: volume, crest setback, face width, traces, height.

There is one function for each kind: a wedge on two joints, a block on one plane, toppling columns. Sizes depend on no
strength and no load, so that lengths grow with the height, areas with its square, volumes with its cube.

Sources: Hoek & Bray (1981), Rock Slope Engineering, ch. 7 and 8 (corners of plane and wedge); Wyllie & Mah (2004),
ch. 9 (columns). The setback of the crest, also called backbreak or crest loss, is horizontal and square to the crest.
"""

import math
from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from slopekit.closed_form.inputs import Value, float_columns
from slopekit.closed_form.tolerances import PARALLEL_DEG, REACHES
from slopekit.closed_form.wedge import UPPER, planes_cut
from slopekit.closed_form.wedge_sliding import Vector, cross, dot, length, less, rows, times
from slopekit.core.array_types import ArrayLike, Floats

_RADIAN: Final = math.pi / 180.0


@dataclass(frozen=True)
class WedgeSizes:
    """Sizes of n wedges that daylight in a face, each (n,), nan where the planes cut none.

    Attributes
    ----------
    volume_m3 : of the wedge
    height_m : vertical, from its lowest to its highest corner
    face_width_m : between the two points where the joints meet the crest
    setback_m : how far behind the crest it reaches
    trace1_m, trace2_m : of J1 and J2 on the face, from the toe to the crest
    upper_trace1_m, upper_trace2_m : of J1 and J2 on the upper slope, from the crest back
    line_m : length of the line of intersection
    """

    volume_m3: Floats
    height_m: Floats
    face_width_m: Floats
    setback_m: Floats
    trace1_m: Floats
    trace2_m: Floats
    upper_trace1_m: Floats
    upper_trace2_m: Floats
    line_m: Floats

    @property
    def longest1_m(self) -> Floats:
        """The longest edge of the wedge's face on J1, (n,) m: the least persistence that frees the wedge."""
        return np.maximum(np.maximum(self.trace1_m, self.upper_trace1_m), self.line_m)

    @property
    def longest2_m(self) -> Floats:
        """The longest edge of the wedge's face on J2, (n,) m."""
        return np.maximum(np.maximum(self.trace2_m, self.upper_trace2_m), self.line_m)

    def scaled(self, scale: ArrayLike) -> "WedgeSizes":
        """Return the wedges with all lengths times a scale, one or (n,), and volumes times its cube."""
        factor = np.asarray(scale, dtype=np.float64)
        return WedgeSizes(
            *(
                getattr(self, field.name) * factor ** (3 if field.name.endswith("_m3") else 1)
                for field in fields(WedgeSizes)
            )
        )


def wedge_sizes(
    joint1_dip_deg: ArrayLike,
    joint1_dip_direction_deg: ArrayLike,
    joint2_dip_deg: ArrayLike,
    joint2_dip_direction_deg: ArrayLike,
    face_dip_deg: ArrayLike,
    face_dip_direction_deg: ArrayLike,
    upper_dip_deg: ArrayLike,
    upper_dip_direction_deg: ArrayLike,
    height_m: ArrayLike,
    *,
    up_the_face: bool = False,
) -> WedgeSizes:
    """Return the sizes of wedges on two joints without a tension crack; arguments are numbers or (n,), in degrees, m.

    Parameters
    ----------
    height_m : vertical, from the toe to where the trace of J1 meets the crest, as for `hoek_bray_wedges`
    up_the_face : `height_m` is instead the height of the crest straight up the dip of the face, as for benches

    Raises
    ------
    ValueError
        The arrays do not fit together.

    Formula: with the toe at 0, crest points P_i = t_i λ_i on the traces t_i = n_i x n_face, end B = l μ of the line
    l = n_1 x n_2, all three on the upper slope n·x = h: volume |P_1·(P_2 x B)| / 6, setback the part of B - P_1 that is
    horizontal and square to the crest.

    >>> one = wedge_sizes(45, 135, 45, 225, 90, 180, 0, 180, [10.0, 20.0])
    >>> one.setback_m.round(3).tolist(), one.face_width_m.round(3).tolist(), one.volume_m3.round(2).tolist()
    ([14.142, 28.284], [28.284, 56.569], [666.67, 5333.33])
    """
    columns, count = float_columns(
        {
            "joint1_dip_deg": joint1_dip_deg,
            "joint1_dip_direction_deg": joint1_dip_direction_deg,
            "joint2_dip_deg": joint2_dip_deg,
            "joint2_dip_direction_deg": joint2_dip_direction_deg,
            "face_dip_deg": face_dip_deg,
            "face_dip_direction_deg": face_dip_direction_deg,
            "upper_dip_deg": upper_dip_deg,
            "upper_dip_direction_deg": upper_dip_direction_deg,
            "height_m": height_m,
        }
    )
    with np.errstate(all="ignore"):
        cut = planes_cut(columns, count)
        offset = cut.offset
        if up_the_face:
            face = columns["face_dip_deg"], columns["face_dip_direction_deg"]
            offset = dot(rows(cut.normals, UPPER), _up_the_face(*face, columns["height_m"]))
        ends = times(rows(cut.lines, slice(3)), offset / cut.climbs)
        first, second, back = (rows(ends, k) for k in range(3))
        heights = [np.zeros(count), *(point[2] for point in (first, second, back))]
        edge = rows(cut.lines, 3)
        across, behind = -edge[1] / np.hypot(edge[0], edge[1]), edge[0] / np.hypot(edge[0], edge[1])
        upper1, upper2 = less(back, first), less(back, second)
        sizes = (
            abs(dot(first, cross(second, back))) / 6.0,
            np.maximum.reduce(heights) - np.minimum.reduce(heights),
            length(less(first, second)),
            abs(upper1[0] * across + upper1[1] * behind),
            length(first),
            length(second),
            length(upper1),
            length(upper2),
            length(back),
        )
        return WedgeSizes(*(np.where(cut.formed, values, np.nan) for values in sizes))


def largest_scale(sizes: WedgeSizes, reach1_m: ArrayLike, reach2_m: ArrayLike) -> Floats:
    """Return the scale (n,), at most 1, of the largest wedges that joints of limited persistence can form.

    Parameters
    ----------
    reach1_m, reach2_m : one number or (n,), m, the longest edge that the wedge's face on J1 and on J2 can have

    >>> sizes = wedge_sizes(45, 135, 45, 225, 90, 180, 0, 180, 10.0)
    >>> largest_scale(sizes, 10.0, np.inf).round(4).tolist()
    [0.5]
    """
    with np.errstate(invalid="ignore"):
        scale1 = np.asarray(reach1_m, dtype=np.float64) / sizes.longest1_m
        scale2 = np.asarray(reach2_m, dtype=np.float64) / sizes.longest2_m
        scale: Floats = np.minimum(1.0, np.minimum(scale1, scale2))
    return scale


@dataclass(frozen=True)
class PlaneSizes:
    """Sizes of n blocks on one plane, per metre of slope, each (n,), nan where the plane cuts none.

    Attributes
    ----------
    area_m2 : of the section: the volume per metre; length_m : of the plane
    height_m : vertical, from the toe to the highest corner; setback_m : how far behind the crest it reaches
    """

    area_m2: Floats
    length_m: Floats
    height_m: Floats
    setback_m: Floats


def plane_sizes(
    plane_dip_deg: ArrayLike,
    face_dip_deg: ArrayLike,
    upper_dip_deg: ArrayLike,
    height_m: ArrayLike,
    crack_distance_m: ArrayLike | None = None,
) -> PlaneSizes:
    """Return the sizes of blocks on a plane that daylights at the toe; arguments are numbers or (n,), in degrees, m.

    Parameters
    ----------
    plane_dip_deg, face_dip_deg, upper_dip_deg : positive out of the slope
    height_m : vertical, from the toe to the crest
    crack_distance_m : of a vertical crack behind the crest, None without one

    Formula: b = H (cot ψ_p - cot ψ_f) / (1 - tan ψ_s cot ψ_p), with a level upper slope and no crack an area of H b / 2
    (Hoek & Bray 1981, ch. 7).

    >>> block = plane_sizes(35.0, 60.0, 0.0, 12.0)
    >>> block.setback_m.round(4).tolist(), block.area_m2.round(3).tolist()
    ([10.2096], [61.257])
    """
    columns, count = float_columns(
        {
            "plane": plane_dip_deg,
            "face": face_dip_deg,
            "upper": upper_dip_deg,
            "height_m": height_m,
            "crack": crack_distance_m,
        }
    )
    none, height = np.zeros(count), columns["height_m"] + np.zeros(count)
    plane, face, upper = (columns[name] + none for name in ("plane", "face", "upper"))
    with np.errstate(all="ignore"):
        run = height / np.tan(face * _RADIAN)  # from the toe to the crest
        slope, rise = np.tan(plane * _RADIAN), np.tan(upper * _RADIAN)
        exit_distance = (height - run * slope) / (slope - rise)  # where the plane comes out
        back = np.minimum(columns["crack"], exit_distance) if "crack" in columns else exit_distance
        crest_depth, crack_depth = (
            (height + distance * rise) - (run + distance) * slope for distance in (0.0, back)
        )  # under the crest, of the crack
        area = 0.5 * crest_depth * (run + exit_distance) - 0.5 * crack_depth * (
            exit_distance - back
        )
        top = height + back * rise
        cuts = (
            (plane > PARALLEL_DEG)
            & (plane < face - PARALLEL_DEG)
            & (plane > upper + PARALLEL_DEG)
            & (back > 0.0)
        )
        lengths = (run + back) / np.cos(plane * _RADIAN)
        sizes = area, lengths, np.maximum(height, top), back
        return PlaneSizes(*(np.where(cuts, values, np.nan) for values in sizes))


@dataclass(frozen=True)
class ColumnSizes:
    """Sizes of toppling columns behind a crest, per metre of slope, each (n,).

    Attributes
    ----------
    columns : how many of them, from the face back, turn over on their own
    height_m : of the first, along its side from the base to the top; 0 where none reaches the crest
    setback_m, area_m2 : of all that turn over: behind the crest, and of their section
    slenderness : of the first, overturning by restoring moment of its weight about its toe: above 1 it topples
    """

    columns: Floats
    height_m: Floats
    setback_m: Floats
    area_m2: Floats
    slenderness: Floats


def column_sizes(
    joint_dip_deg: ArrayLike,
    base_dip_deg: ArrayLike,
    face_dip_deg: ArrayLike,
    height_m: ArrayLike,
    width_m: ArrayLike,
    reach_m: ArrayLike = math.inf,
) -> ColumnSizes:
    """Return the sizes of columns between joints that dip into the slope, on a base that daylights at the toe.

    The push of the columns behind is neglected, as in the first test of Goodman & Bray.

    Parameters
    ----------
    joint_dip_deg : of the joints, into the slope; base_dip_deg : of the base, out of it; both in the section
    height_m : vertical, from where the base daylights to the level crest; width_m : of a column, square to its sides
    reach_m : columns farther behind the crest than this stay

    Formula: a column of height y and base b on ψ_b between sides that dip ψ_d turns over where y cos ψ_d > b cos ψ_b,
    b = Δx / sin(ψ_d + ψ_b); where the base is square to the sides that is Δx / y < tan ψ_b (Goodman & Bray 1976; Wyllie
    & Mah 2004, §9.3).

    >>> found = column_sizes(60.0, 30.0, 70.0, 15.0, [1.0, 3.0, 8.0])
    >>> found.columns.tolist(), found.slenderness.round(3).tolist()
    ([15.0, 3.0, 0.0], [5.924, 1.975, 0.74])
    """
    columns, count = float_columns(
        {
            "joint": joint_dip_deg,
            "base": base_dip_deg,
            "face": face_dip_deg,
            "height_m": height_m,
            "width_m": width_m,
            "reach_m": reach_m,
        }
    )
    none = np.zeros(count)
    joint, base, face = ((columns[name] + none) * _RADIAN for name in ("joint", "base", "face"))
    height, width = columns["height_m"] + none, columns["width_m"] + none
    with np.errstate(all="ignore"):
        climb = np.tan(base)
        # down the side of a column whose top lies s behind the crest: d = (h - (h cot ψ_f + s) tan ψ_b) / share
        share = (1.0 + climb / np.tan(joint)) * np.sin(joint)
        first = np.maximum(0.0, (height - height / np.tan(face) * climb) / share)
        needed = (
            width / np.sin(joint + base) * np.cos(base) / np.cos(joint)
        )  # the height that just turns over
        spacing = width / np.sin(joint)
        height_step = spacing * climb / share  # of height from one column to the next
        toppling_count = np.where(first > needed, np.ceil((first - needed) / height_step), 0.0)
        toppling_count = np.minimum(
            toppling_count, np.floor(columns["reach_m"] / spacing * (1.0 + REACHES))
        )
        last = np.maximum(0.0, first - height_step * toppling_count)
        area = toppling_count * width * (first + last) / 2.0  # between sides that are that high
        setback, slender = toppling_count * spacing, first / needed
    return ColumnSizes(toppling_count, first, setback, area, slender)


def _up_the_face(dip_deg: Value, direction_deg: Value, height: Value) -> Vector:
    """Return the point of the crest straight up the dip of the face from the toe, m."""
    back, to = height / np.tan(dip_deg * _RADIAN), direction_deg * _RADIAN
    return -np.sin(to) * back, -np.cos(to) * back, height
