"""The kinematic tests: what could slide or topple by orientation and friction alone.

No cohesion, no water, no size; the ground behind the crest is taken as horizontal. What each test asks:

planar sliding
    The dip vector of a joint daylights in the face, dips at least at the friction angle, and lies within the lateral
    limit of the face's dip direction (Hoek & Bray 1981, ch. 2 and 7; Wyllie & Mah 2004, §2.6 and 6.2). Daylighting is
    that of the daylight envelope: flatter than the face along the joint's own dip direction, as in Dips; hand tests
    that compare true dips (Norrish & Wyllie 1996) count a little more beside the dip direction of the face.
wedge sliding
    The line of intersection daylights. primary: it plunges at least at the friction angle (Markland 1972; Hoek & Bray
    1981, ch. 8). secondary: it plunges less, but one joint loses contact and the wedge slides on the other alone,
    which dips at least at its friction angle (Hocking 1976; Goodman & Shi 1985, ch. 9). No lateral limits: two joints
    release the wedge on both sides. Dips draws its secondary zone otherwise, between the friction circle and a plane
    that dips at the friction angle with the face: lines there need not slide on one joint, and others that do lie
    outside. Its count is given beside ours.
flexural toppling
    Layers dip into the slope, and the normal to them plunges less than the apparent dip of a plane that dips with the
    face at the face's dip less the friction angle: (90 - dip) + friction angle <= dip of the face, square to the face
    (Goodman & Bray 1976; Goodman 1980, ch. 8; Wyllie & Mah 2004, §9.2). The lateral limit is Goodman's 30°; 10° is
    that of Goodman & Bray and of Wyllie & Mah.
direct toppling
    Lines of intersection that plunge into the slope within the lateral limit, and steeper than the normal to the face,
    cut columns; joints that dip out of the slope, flatter than the face, are their base (Goodman & Bray 1976; Hudson &
    Harrison 1997, ch. 18, as drawn by Dips). Base planes steeper than the friction angle let the columns slide as
    well. oblique: within 90° of the way into the slope but beyond the lateral limit, and nearer to the vertical than
    the friction angle. Either needs lines and bases: alone they are no mechanism.

Limits are met where they are reached (to 1e-9°): a joint at the friction angle slides. Only daylighting is strict, as
everywhere in slopekit: a joint parallel to the face does not daylight.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, NDArray
from slopekit.core.orientation import Plane, normals
from slopekit.design.joint_lists import JointList
from slopekit.geometry.tolerances import SAME_DIRECTION

#: Wedges by how they would slide: primary on both joints or on one, secondary.
NO_WEDGE, PRIMARY_BOTH, PRIMARY_ONE, SECONDARY = range(4)
#: Lines of intersection as the edges of columns.
NO_COLUMN, DIRECT, OBLIQUE = range(3)
#: Base planes, numbered as the zones of Dips: columns may slide on them; they release; they release obliquely.
NO_BASE, SLIDING_BASE, RELEASE, OBLIQUE_RELEASE = range(4)
#: What is counted of joints and of lines of intersection, in the order of the sheet.
JOINT_MODES = (
    "planar",
    "planar_without_limits",
    "flexural",
    "base_sliding",
    "base_release",
    "base_oblique",
)
LINE_MODES = (
    "wedge",
    "wedge_primary",
    "wedge_secondary",
    "wedge_on_both",
    "wedge_by_friction",
    "direct",
    "oblique",
)
#: Pairs up to which all are tested: those of 3000 joints; of more a sample is, its shares within 0.1 % (95 %).
MAX_PAIRS, DRAWN_PAIRS = 4_498_500, 1_000_000
_ANGLE_TOLERANCE_DEG = 1e-9  # degrees
_COSINE_TOLERANCE = 1e-12  # cosine, as in geometry.rock.rockmass

ModeCodes = NDArray[np.int8]


@dataclass(frozen=True)
class Lines:
    """The lines of intersection of all pairs of joints.

    Attributes
    ----------
    first, second : (m,) indices of the joints; parallel ones meet in no line and are not among them
    down : (m, 3) unit vectors, pointing down; trend_deg, plunge_deg : (m,)
    cosine : (m,) between the upward normals of the two; turn : (m,) 1 where their cross product points down, else -1
    """

    first: Ints
    second: Ints
    down: Floats
    trend_deg: Floats
    plunge_deg: Floats
    cosine: Floats
    turn: Floats


@dataclass(frozen=True)
class Modes:
    """Critical joints and lines of intersection in a slope of one face.

    Attributes
    ----------
    planar, planar_without_limits, flexural : (n,) of joints; base : (n,) SLIDING_BASE, RELEASE, OBLIQUE_RELEASE
    wedge : (m,) of lines, PRIMARY_BOTH, PRIMARY_ONE, SECONDARY; column : (m,) DIRECT, OBLIQUE
    by_friction : (m,) wedges whose weight friction on the joints that keep contact does not hold (F <= 1, c = 0, dry)
    secondary_of_dips : (m,) lines in the secondary zone as Dips draws it
    """

    planar: Bools
    planar_without_limits: Bools
    flexural: Bools
    base: ModeCodes
    wedge: ModeCodes
    by_friction: Bools
    secondary_of_dips: Bools
    column: ModeCodes

    def of_joints(self) -> dict[str, Bools]:
        """Return the critical joints (n,) by mode, in the order of `JOINT_MODES`."""
        return {
            "planar": self.planar,
            "planar_without_limits": self.planar_without_limits,
            "flexural": self.flexural,
            "base_sliding": self.base == SLIDING_BASE,
            "base_release": self.base == RELEASE,
            "base_oblique": self.base == OBLIQUE_RELEASE,
        }

    def of_lines(self) -> dict[str, Bools]:
        """Return the critical lines of intersection (m,) by mode, in the order of `LINE_MODES`."""
        primary = (self.wedge == PRIMARY_BOTH) | (self.wedge == PRIMARY_ONE)
        return {
            "wedge": self.wedge != NO_WEDGE,
            "wedge_primary": primary,
            "wedge_secondary": self.wedge == SECONDARY,
            "wedge_on_both": self.wedge == PRIMARY_BOTH,
            "wedge_by_friction": self.by_friction,
            "direct": self.column == DIRECT,
            "oblique": self.column == OBLIQUE,
        }

    def counts(self) -> dict[str, int]:
        """Return the number of critical joints and lines by mode."""
        return {
            name: int(critical.sum())
            for name, critical in (self.of_joints() | self.of_lines()).items()
        }

    def shares(self, of_joints: Floats, of_lines: Floats) -> dict[str, float | None]:
        """Return the weighted share of critical joints or lines by mode, per cent; None where all weights are 0."""
        return {
            name: 100.0 * float(weights[critical].sum()) / total_weight
            if (total_weight := float(weights.sum()))
            else None
            for weights, kinds in ((of_joints, self.of_joints()), (of_lines, self.of_lines()))
            for name, critical in kinds.items()
        }


def tested_pairs(joints: "JointList | Planes", rng: np.random.Generator) -> tuple[Ints, Ints]:
    """Return the joints of every pair, or of `DRAWN_PAIRS` different pairs drawn at random above `MAX_PAIRS`.

    >>> planes = Planes(np.full(4000, 45.0), np.linspace(0.0, 359.0, 4000))
    >>> first, second = tested_pairs(planes, np.random.default_rng(1))
    >>> len(first), bool((first < second).all())
    (1000000, True)
    """
    count = len(joints)
    if count * (count - 1) // 2 <= MAX_PAIRS:
        return joints.pairs()
    pairs = np.zeros(0, dtype=np.int64)
    while len(pairs) < DRAWN_PAIRS:
        joint1, joint2 = (
            rng.integers(0, count, DRAWN_PAIRS),
            rng.integers(0, count - 1, DRAWN_PAIRS),
        )
        joint2 += joint2 >= joint1
        pairs = np.sort(
            np.concatenate([pairs, np.minimum(joint1, joint2) * count + np.maximum(joint1, joint2)])
        )
        pairs = pairs[np.diff(pairs, prepend=-1) > 0]
    pairs = np.sort(rng.permutation(pairs)[:DRAWN_PAIRS])
    return pairs // count, pairs % count


def lines_of(joints: "JointList | Planes", pairs: tuple[Ints, Ints]) -> Lines:
    """The lines of intersection of pairs of joints that are not parallel."""
    normals = joints.normals()
    first, second = pairs
    a, b = normals[first], normals[second]
    line = np.cross(a, b)
    sine = np.sqrt(np.einsum("ij,ij->i", line, line))
    crossing = sine >= SAME_DIRECTION
    first, second, line = first[crossing], second[crossing], line[crossing] / sine[crossing, None]
    turn = np.where(line[:, 2] > 0.0, -1.0, 1.0)
    line *= turn[:, None]
    return Lines(
        first,
        second,
        line,
        *_trend_plunge(line),
        np.einsum("ij,ij->i", a[crossing], b[crossing]),
        turn,
    )


def modes_of(
    joints: "JointList | Planes",
    lines: Lines,
    face: Plane,
    friction_deg: Floats,
    lateral_deg: float,
    lateral_toppling_deg: float,
) -> Modes:
    """Return the critical joints and lines in a slope with this face, by the criteria in the head of this file."""
    dip, direction, normals = joints.dips_deg, joints.dip_directions_deg, joints.normals()
    face_normal, friction = face.normal(), friction_deg
    deviation = direction_difference_deg(direction, face.dip_direction_deg)

    # planar sliding
    down = np.stack(
        [
            np.sin(np.radians(direction)) * np.cos(np.radians(dip)),
            np.cos(np.radians(direction)) * np.cos(np.radians(dip)),
            -np.sin(np.radians(dip)),
        ],
        axis=-1,
    )
    slides = (
        (down @ face_normal > _COSINE_TOLERANCE)
        & (down[:, 2] < -_COSINE_TOLERANCE)
        & (dip >= friction - _ANGLE_TOLERANCE_DEG)
    )
    planar = slides & (deviation <= lateral_deg + _ANGLE_TOLERANCE_DEG)

    # flexural toppling: a vertical joint dips into the slope as much as out of it
    vertical = dip >= 90.0 - _ANGLE_TOLERANCE_DEG
    pole_deviation = np.where(vertical, np.minimum(deviation, 180.0 - deviation), 180.0 - deviation)
    slip_limit = np.radians(face.dip_deg - friction)
    plunge = np.radians(90.0 - dip)
    plunge_margin = np.sin(slip_limit) * np.cos(plunge) * np.cos(
        np.radians(pole_deviation)
    ) - np.cos(slip_limit) * np.sin(plunge)
    flexural = (
        (slip_limit >= -np.radians(_ANGLE_TOLERANCE_DEG))
        & (plunge_margin >= -_COSINE_TOLERANCE)
        & (pole_deviation <= lateral_toppling_deg + _ANGLE_TOLERANCE_DEG)
    )

    # base planes of columns
    base_deviation = np.where(dip <= _ANGLE_TOLERANCE_DEG, 0.0, deviation)
    is_flatter = dip <= face.dip_deg + _ANGLE_TOLERANCE_DEG
    is_lateral = is_flatter & (base_deviation <= lateral_toppling_deg + _ANGLE_TOLERANCE_DEG)
    is_oblique = is_flatter & ~is_lateral & (base_deviation <= 90.0 + _ANGLE_TOLERANCE_DEG)
    friction_holds = dip < friction - _ANGLE_TOLERANCE_DEG
    base = np.zeros(len(dip), dtype=np.int8)
    base[is_lateral & ~friction_holds] = SLIDING_BASE
    base[is_lateral & friction_holds] = RELEASE
    base[is_oblique & friction_holds] = OBLIQUE_RELEASE

    wedge, by_friction, dips_secondary = _wedges(lines, normals, face_normal, face, friction, dip)

    # edges of columns
    line_deviation = np.where(
        lines.plunge_deg >= 90.0 - _ANGLE_TOLERANCE_DEG,
        0.0,
        direction_difference_deg(lines.trend_deg, face.dip_direction_deg + 180.0),
    )
    is_lateral = line_deviation <= lateral_toppling_deg + _ANGLE_TOLERANCE_DEG
    plunges = lines.down[:, 2] < -_COSINE_TOLERANCE
    column = np.zeros(len(lines.first), dtype=np.int8)
    column[
        is_lateral & plunges & (lines.plunge_deg >= 90.0 - face.dip_deg - _ANGLE_TOLERANCE_DEG)
    ] = DIRECT
    upright = lines.plunge_deg >= 90.0 - float(friction.max()) - _ANGLE_TOLERANCE_DEG
    column[~is_lateral & (line_deviation <= 90.0 + _ANGLE_TOLERANCE_DEG) & plunges & upright] = (
        OBLIQUE
    )
    return Modes(planar, slides, flexural, base, wedge, by_friction, dips_secondary, column)


def _wedges(
    lines: Lines, normals: Floats, face_normal: Floats, face: Plane, friction: Floats, dip: Floats
) -> tuple[ModeCodes, Bools, Bools]:
    """Return of each line (m,) how its wedge slides, whether friction alone fails, and Dips' secondary zone."""
    daylight = np.flatnonzero(
        (lines.down @ face_normal > _COSINE_TOLERANCE) & (lines.down[:, 2] < -_COSINE_TOLERANCE)
    )
    first, second, down = lines.first[daylight], lines.second[daylight], lines.down[daylight]
    plunge = lines.plunge_deg[daylight]
    # the wedge lies on the side of each joint on which the trace of the other climbs up the face
    climb, turn = np.cross(normals, face_normal)[:, 2], lines.turn[daylight]
    climb = np.where(np.abs(climb) < SAME_DIRECTION, 0.0, np.sign(climb))
    side1, side2 = turn * climb[second], -turn * climb[first]
    up1, up2, cosine = normals[first, 2], normals[second, 2], lines.cosine[daylight]
    # a joint that strikes with the face ends nowhere: the other only releases one end, and the block may part from it
    side1 = np.where(side1 == 0.0, np.where(up2 * cosine >= up1, 1.0, -1.0), side1)
    side2 = np.where(side2 == 0.0, np.where(up1 * cosine >= up2, 1.0, -1.0), side2)
    weight1, weight2, cosine_inward = (
        -side1 * up1,
        -side2 * up2,
        side1 * side2 * cosine,
    )  # the weight along the inward normals
    slides_on1 = (weight1 < 0.0) & (weight2 - weight1 * cosine_inward >= 0.0)
    slides_on2 = (weight2 < 0.0) & (weight1 - weight2 * cosine_inward >= 0.0) & ~slides_on1
    on_both = ~(slides_on1 | slides_on2)
    steep = dip >= friction - _ANGLE_TOLERANCE_DEG
    slides_on_single = (slides_on1 & steep[first]) | (slides_on2 & steep[second])

    least = np.minimum(friction[first], friction[second])
    primary = plunge >= least - _ANGLE_TOLERANCE_DEG
    wedge = np.zeros(len(lines.first), dtype=np.int8)
    wedge[daylight] = np.where(
        primary,
        np.where(on_both, PRIMARY_BOTH, PRIMARY_ONE),
        np.where(slides_on_single, SECONDARY, NO_WEDGE),
    )
    # on both: N1 tan φ1 + N2 tan φ2 against the weight along the line
    tangent = np.tan(np.radians(friction))
    friction_resistance = (weight2 * cosine_inward - weight1) * tangent[first] + (
        weight1 * cosine_inward - weight2
    ) * tangent[second]
    exceeds_friction = friction_resistance <= -down[:, 2] * (
        1.0 - cosine_inward * cosine_inward
    ) * (1.0 + _COSINE_TOLERANCE)
    by_friction = np.zeros(len(wedge), dtype=np.bool_)
    by_friction[daylight] = np.where(on_both, exceeds_friction, slides_on_single)

    # outside the great circle of the plane that dips at the friction angle with the face
    slope, deviation = (
        np.radians(least),
        np.radians(direction_difference_deg(lines.trend_deg[daylight], face.dip_direction_deg)),
    )
    is_outside = np.tan(slope) * np.cos(deviation) < np.tan(np.radians(plunge)) * (
        1.0 - _COSINE_TOLERANCE
    )
    dips_secondary = np.zeros(len(wedge), dtype=np.bool_)
    dips_secondary[daylight] = ~primary & is_outside
    return wedge, by_friction, dips_secondary


def _trend_plunge(down: Floats) -> tuple[Floats, Floats]:
    """Trend and plunge (m,) of downward vectors (m, 3), degrees."""
    trend: Floats = np.degrees(np.arctan2(down[:, 0], down[:, 1])) % 360.0
    return trend, np.degrees(np.arctan2(-down[:, 2], np.hypot(down[:, 0], down[:, 1])))


def direction_difference_deg(directions_deg: Floats, toward_deg: float) -> Floats:
    """Return the angle in degrees between dip directions (n,) and another direction, 0 to 180."""
    return np.abs((directions_deg - toward_deg + 180.0) % 360.0 - 180.0)


@dataclass(frozen=True)
class Planes:
    """Orientations (n,) in degrees, as the criteria take them."""

    dips_deg: Floats
    dip_directions_deg: Floats

    def __len__(self) -> int:
        return len(self.dips_deg)

    def normals(self) -> Floats:
        """(n, 3) upward unit normals."""
        return normals(self.dips_deg, self.dip_directions_deg)

    def pairs(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """The first and second of every pair."""
        return np.triu_indices(len(self), 1)


def planes_of_poles(poles: Floats) -> Planes:
    """The planes of downward poles (n, 3).

    >>> found = planes_of_poles(np.array([[0.0, 0.6, -0.8]]))
    >>> found.dips_deg.round(4).tolist(), found.dip_directions_deg.tolist()
    ([36.8699], [180.0])
    """
    dips = np.degrees(np.arctan2(np.hypot(poles[:, 0], poles[:, 1]), -poles[:, 2]))
    return Planes(dips, np.degrees(np.arctan2(-poles[:, 0], -poles[:, 1])) % 360.0)


def zones_of_poles(
    poles: Floats, face: Plane, friction_deg: float, lateral_deg: float, lateral_toppling_deg: float
) -> dict[str, Bools]:
    """Return whether joints with downward poles (n, 3) could move: (n,) for each of `JOINT_MODES`."""
    planes = planes_of_poles(poles)
    none = np.zeros(0)
    no_lines = Lines(
        none.astype(np.intp), none.astype(np.intp), np.zeros((0, 3)), none, none, none, none
    )
    friction = np.full(len(planes), friction_deg)
    return modes_of(planes, no_lines, face, friction, lateral_deg, lateral_toppling_deg).of_joints()


def zones_of_lines(
    down: Floats, face: Plane, friction_deg: float, lateral_deg: float, lateral_toppling_deg: float
) -> dict[str, Bools]:
    """Return whether downward lines of intersection (n, 3) could guide a wedge or edge a column: (n,) each.

    wedge_primary, wedge_secondary_of_dips, direct, oblique: what depends on the line alone. Whether a wedge slides in
    the secondary zone depends on its joints.
    """
    placeholder, count = Planes(np.array([45.0, 45.0]), np.array([115.0, 245.0])), len(down)
    first = np.zeros(count, dtype=np.intp)
    lines = Lines(first, first + 1, down, *_trend_plunge(down), np.zeros(count), np.ones(count))
    modes: Modes = modes_of(
        placeholder, lines, face, np.full(2, friction_deg), lateral_deg, lateral_toppling_deg
    )
    critical = modes.of_lines()
    return {
        **{kind: critical[kind] for kind in ("wedge_primary", "direct", "oblique")},
        "wedge_secondary_of_dips": modes.secondary_of_dips,
    }
