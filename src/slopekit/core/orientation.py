"""Orientations: planes as dip / dip direction, lines as trend / plunge, both in words.

Frame: x east, y north, z up. Angles are degrees, dips below the horizontal, directions clockwise from north.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault

_COMPASS = (
    "N",
    "NNE",
    "NE",
    "ENE",
    "E",
    "ESE",
    "SE",
    "SSE",
    "S",
    "SSW",
    "SW",
    "WSW",
    "W",
    "WNW",
    "NW",
    "NNW",
)
# texts: re compiles each when it is first used, and keeps it; a plain wedge uses the first
_PAIR = r"^\s*([^/\s]+)\s*/\s*([^/\s]+)\s*$"
_QUADRANT = r"^\s*[NSns]\s*\d+(\.\d+)?\s*[°]?\s*[EWew]|\d\s*[NESWnesw]{1,2}\s*$"
_STRIKE = r"(?i)^\s*(?:([NS])\s*(\d+(?:\.\d+)?)\s*°?\s*([EW])|(\d+(?:\.\d+)?)\s*°?)\s*$"
_DIP_TO_SIDE = r"(?i)^\s*(\d+(?:\.\d+)?)\s*°?\s*([NESW]{1,3})\s*$"
_DECIMALS = r"\.\d\d"
_QUARTER_TURN, _FULL_TURN = math.pi / 2.0 + 1e-4, 2.0 * math.pi + 1e-4  # in radians, rounded up


@dataclass(frozen=True)
class Plane:
    """The orientation of a plane: dip and dip direction in degrees.

    >>> print(Plane(45, 115).in_words())
    dips 45° toward 115 (ESE)
    """

    dip_deg: float
    dip_direction_deg: float

    def normal(self) -> Floats:
        """Upward unit normal, shape (3,): (sin β sin α, sin β cos α, cos β)."""
        normal: Floats = normals(np.array([self.dip_deg]), np.array([self.dip_direction_deg]))[0]
        return normal

    def in_words(self) -> str:
        """The plane as an engineer would say it."""
        direction = self.dip_direction_deg
        return (
            f"dips {number(self.dip_deg)}° toward {bearing(direction)} ({compass_point(direction)})"
        )

    def __str__(self) -> str:
        return f"{number(self.dip_deg)}/{bearing(self.dip_direction_deg)}"


@dataclass(frozen=True)
class Line:
    """The orientation of a line: trend and plunge in degrees, plunge positive downward.

    >>> Line(180.0, 22.9).vector().round(4).tolist()
    [0.0, -0.9212, -0.3891]
    """

    trend_deg: float
    plunge_deg: float

    def vector(self) -> Floats:
        """Unit vector (east, north, up), shape (3,); (n, 3) of angles that are arrays (n,)."""
        trend, plunge = np.radians(self.trend_deg), np.radians(self.plunge_deg)
        level = np.cos(plunge)
        return np.stack(
            np.broadcast_arrays(np.sin(trend) * level, np.cos(trend) * level, -np.sin(plunge)),
            axis=-1,
        )

    def __str__(self) -> str:
        return f"{bearing(self.trend_deg)}/{self.plunge_deg:.1f}"


def upward_axis(suffix: str) -> str:
    """The axis that points up in mesh files of a format: y in glTF by its standard (2.0, 3.4), z in every other.

    >>> upward_axis(".glb"), upward_axis(".obj")
    ('y', 'z')
    """
    return "y" if suffix.lower() in (".glb", ".gltf") else "z"


def normals(dip_deg: Floats, dip_direction_deg: Floats) -> Floats:
    """Upward unit normals of planes.

    Parameters
    ----------
    dip_deg, dip_direction_deg : (...) arrays, degrees

    Returns
    -------
    (..., 3) array

    Source: docs/theory/wedge.md; Wyllie & Mah (2004), appendix I.

    >>> normals(np.array([0.0, 90.0]), np.array([0.0, 90.0])).round(12).tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    dip, direction = np.radians(dip_deg), np.radians(dip_direction_deg)
    sine = np.sin(dip)
    east = sine * np.sin(direction)
    upward = np.empty((*east.shape, 3))  # np.stack takes as long as all the rest
    upward[..., 0], upward[..., 1], upward[..., 2] = east, sine * np.cos(direction), np.cos(dip)
    return upward


def line_of(vector: Floats) -> Line:
    """Trend and plunge of a vector as it points (upward vectors get a negative plunge).

    >>> line_of(np.array([0.0, -1.0, -1.0]))
    Line(trend_deg=180.0, plunge_deg=45.0)
    """
    east, north, up = (float(component) for component in vector)
    trend = math.degrees(math.atan2(east, north)) % 360.0
    return Line(trend, math.degrees(math.atan2(-up, math.hypot(east, north))))


def tenths(plane: Plane) -> Plane:
    """A plane rounded to tenths of a degree."""
    return Plane(round(plane.dip_deg, 1), round(plane.dip_direction_deg, 1) % 360.0)


def downward(vector: Floats) -> Floats:
    """The vector or its opposite, whichever plunges; a horizontal one is returned as it is."""
    return -vector if vector[2] > 0.0 else vector


def number(value: float) -> str:
    """A number without needless zeros: 45, 12.5, 0.02.

    >>> number(45.0), number(12.5)
    ('45', '12.5')
    """
    return f"{value:.10g}"


def millimetre(value: float) -> str:
    """A length or coordinate in m, fixed to the millimetre, without a minus before zero.

    >>> millimetre(4000123.4567), millimetre(-0.0001)
    ('4000123.457', '0.000')
    """
    return f"{round(value, 3) + 0.0:.3f}"


def coordinates(point: Iterable[float]) -> str:
    """The coordinates of a point in m, each fixed to the millimetre as a survey has them.

    >>> coordinates((512300.0, 4187650.25, 1234.5))
    '(512300.000, 4187650.250, 1234.500)'
    """
    return f"({', '.join(map(millimetre, point))})"


def bearing(degrees: float) -> str:
    """A direction in three digits, decimals only where there are any.

    >>> bearing(25.0), bearing(179.9)
    ('025', '179.9')
    """
    integer, _, decimals = number(degrees % 360.0 if degrees != 360.0 else 360.0).partition(".")
    return integer.zfill(3) + (f".{decimals}" if decimals else "")


def compass_point(degrees: float) -> str:
    """The nearest of the sixteen compass points.

    >>> compass_point(115)
    'ESE'
    """
    return _COMPASS[round((degrees % 360.0) / 22.5) % 16]


def azimuth_of(point: str) -> float | None:
    """The direction of one of the sixteen compass points, None for any other word.

    >>> azimuth_of("SE"), azimuth_of("east")
    (135.0, None)
    """
    spelled = point.strip().upper()
    return _COMPASS.index(spelled) * 22.5 if spelled in _COMPASS else None


def parse_strike(text: str) -> float | None:
    """The azimuth of a strike: `N25W` (335), `E-W` (90), or a number from 0 to 360; None for anything else.

    >>> parse_strike("N25W"), parse_strike("S10E"), parse_strike("25"), parse_strike("W25N")
    (335.0, 170.0, 25.0, None)
    >>> parse_strike("N-S"), parse_strike("EW"), parse_strike("NE-SW"), parse_strike("N"), parse_strike("NE")
    (0.0, 90.0, 45.0, 0.0, None)
    """
    match = re.match(_STRIKE, text)
    if match is None:
        return _strike_by_points(text)
    end, angle, turn, plain = match.groups()
    if plain is not None:
        return float(plain) if float(plain) <= 360.0 else None
    if float(angle) > 90.0:
        return None
    clockwise = (end.upper() == "N") == (turn.upper() == "E")
    return (
        (0.0 if end.upper() == "N" else 180.0) + (float(angle) if clockwise else -float(angle))
    ) % 360.0


def _strike_by_points(text: str) -> float | None:
    """The azimuth of a strike between two opposite compass points, or toward one of N, E, S and W."""
    letters = re.sub(r"[\s\-–]", "", text.upper())
    if len(letters) == 1:
        return azimuth_of(letters)
    for cut in range(1, len(letters)):
        first, second = azimuth_of(letters[:cut]), azimuth_of(letters[cut:])
        if first is not None and second is not None and abs(first - second) == 180.0:
            return first
    return None


def plane_without_side(strike_deg: float, dip: str) -> Plane | None:
    """A vertical or horizontal plane by its strike and dip, whose side need not be said; None for any other dip.

    >>> print(plane_without_side(330.0, "90"), plane_without_side(0.0, "0°"), plane_without_side(0.0, "45"))
    90/060 0/090 None
    """
    match = re.match(r"^\s*(0+|90)(?:[.,]0*)?\s*°?\s*$", dip)
    return None if match is None else Plane(float(match.group(1)), (strike_deg + 90.0) % 360.0)


def overturned_plane(dip_deg: float, dip_direction_deg: float) -> Plane:
    """The plane of a dip beyond 90°, as overturned beds are written: 95° toward 030 is 85/210.

    >>> print(overturned_plane(95.0, 30.0))
    85/210
    """
    return Plane(180.0 - dip_deg, opposite(dip_direction_deg))


def plane_by_side(strike_deg: float, dip: str, side: str = "") -> Plane | None:
    """A plane by its strike, and its dip with the side it dips to: `45SE`, or `45` and `SE`.

    One letter says on which side of the strike the plane dips; two or three name the quadrant or octant it dips to.
    None where there is no such plane, or the side lies along the strike.

    >>> print(plane_by_side(25.0, "45SE"), plane_by_side(205.0, "45", "E"), plane_by_side(25.0, "45NE"))
    45/115 45/115 None
    """
    match = re.match(_DIP_TO_SIDE, f"{dip}{side}")
    toward = None if match is None else azimuth_of(match.group(2))
    if match is None or toward is None or float(match.group(1)) > 90.0:
        return None
    deviation, direction = min(
        (abs((candidate - toward + 180.0) % 360.0 - 180.0), candidate)
        for candidate in ((strike_deg + 90.0) % 360.0, (strike_deg - 90.0) % 360.0)
    )
    largest_deviation = 90.0 - 1e-9 if len(match.group(2)) == 1 else 45.0 + 1e-9
    return Plane(float(match.group(1)), direction) if deviation <= largest_deviation else None


def parse_quadrants(text: str) -> Plane | None:
    """A plane in quadrant notation, `N25E/45SE`, also with a comma or a blank, or `025/45SE`; None for anything else.

    Vertical and horizontal planes need no side where the strike is in letters: `N25E/90`, `E-W/90`.

    >>> print(parse_quadrants("N25E/45SE"), parse_quadrants("N 25 W, 60 SW"), parse_quadrants("45/115"))
    45/115 60/245 None
    >>> print(parse_quadrants("N30W/90"), parse_quadrants("E-W/90"), parse_quadrants("30/90"))
    90/060 90/180 None
    """
    vertical = re.match(r"^(.*[NESWnesw])\s*[\s/,;]\s*(\S+)\s*$", text)
    if vertical is not None and (azimuth := parse_strike(vertical.group(1))) is not None:
        plane = plane_without_side(azimuth, vertical.group(2))
        if plane is not None:
            return plane
    dip = re.search(r"(?:^|[\s/,;°EWew])\s*(\d+(?:\.\d+)?\s*°?\s*[NESWnesw]{1,3})\s*$", text)
    strike = None if dip is None else parse_strike(text[: dip.start(1)].rstrip(" /,;\t"))
    return None if dip is None or strike is None else plane_by_side(strike, dip.group(1))


def look_like_radians(dip: float, direction: float) -> bool:
    """Whether angles could be a plane in radians."""
    return 0.0 <= dip <= _QUARTER_TURN and 0.0 <= direction <= _FULL_TURN


def parse_plane(value: object, name: str, where: str = "") -> Plane:
    """Read `45/115`, a (dip, dip direction) pair or a `Plane`, and refuse what cannot be one.

    Raises
    ------
    DesignError
        E101 dip, E102 dip direction out of range, E103 the two look swapped, E104 not dip/dip direction
        (strike notation among them), E105 not a finite number, E113 a text that looks like radians.
    """
    if isinstance(value, Plane):
        value = (value.dip_deg, value.dip_direction_deg)
    where = where or f"{name} = {value}"
    if isinstance(value, str):
        if "°" in value:
            from slopekit.core.degrees import decimal_degrees  # few planes are in minutes

            value = decimal_degrees(value)
        match = re.match(_PAIR, value)
        if match is None:
            raise DesignError([_not_a_plane(value, name, where)])
        angles: tuple[object, ...] = match.groups()
    elif isinstance(value, list | tuple | np.ndarray) and len(value) == 2:
        angles = tuple(value)
    else:
        raise DesignError([_not_a_plane(value, name, where)])
    numbers = []
    for angle in angles:
        try:
            numbers.append(float(str(angle).rstrip("°")))
        except ValueError:
            raise DesignError([_not_a_plane(value, name, where)]) from None
    plane = _checked_plane(
        numbers[0], numbers[1], name, where, is_written_as_bearing(str(angles[1]))
    )
    if (
        isinstance(value, str)
        and look_like_radians(*numbers)
        and all(re.search(_DECIMALS, str(angle)) for angle in angles)
    ):
        meant = Plane(
            round(math.degrees(numbers[0]), 1), round(math.degrees(numbers[1]) % 360.0, 1)
        )
        advice = f"In degrees that would be {meant}; if degrees are meant, write one decimal."
        raise DesignError(
            [Fault("E113", f"{name} is {value}, that looks like radians", where, advice)]
        )
    return plane


def is_written_as_bearing(text: str) -> bool:
    """Whether a text is a direction by its notation, three digits from 000 to 099: no dip is written so.

    >>> is_written_as_bearing("030"), is_written_as_bearing("30"), is_written_as_bearing("115")
    (True, False, False)
    """
    return re.match(r"^\s*0\d\d(?:[.,]\d*)?\s*°?\s*$", text) is not None


def _checked_plane(dip: float, direction: float, name: str, where: str, is_bearing: bool) -> Plane:
    """A plane of two numbers that can be one; `is_bearing` : the second is a direction by its notation."""
    if not (math.isfinite(dip) and math.isfinite(direction)):
        raise DesignError([Fault("E105", f"orientation of {name} is not a finite number", where)])
    if not 0.0 <= dip <= 90.0:
        if dip > 90.0 and 0.0 <= direction <= 90.0 and dip <= 360.0 and not is_bearing:
            struck = Plane(direction, (dip + 90.0) % 360.0)
            overturned = (
                f" An overturned plane is written {overturned_plane(dip, direction)}."
                if dip <= 180.0
                else ""
            )
            advice = (
                f"Dip comes first: did you mean {number(direction)}/{bearing(dip)}? If {bearing(dip)} is a "
                f"strike by the right-hand rule, it is {struck}.{overturned}"
            )
            message = (
                f"{name} is {number(dip)}/{number(direction)}: dip and dip direction look swapped"
            )
            raise DesignError([Fault("E103", message, where, advice)])
        advice = ""
        if 90.0 < dip <= 180.0:
            meant = overturned_plane(dip, direction)
            advice = (
                f"A plane that dips {number(dip)}° toward {bearing(direction)} is written {meant}."
            )
        message = f"dip of {name} is {number(dip)}, a dip lies between 0 and 90"
        raise DesignError([Fault("E101", message, where, advice)])
    if not 0.0 <= direction <= 360.0:
        message = (
            f"dip direction of {name} is {number(direction)}, a direction lies between 0 and 360"
        )
        advice = f"{number(direction)} is the same direction as {bearing(direction % 360.0)}."
        raise DesignError([Fault("E102", message, where, advice)])
    return Plane(dip, direction)


def _not_a_plane(value: object, name: str, where: str) -> Fault:
    text = str(value)
    message = f"{name} is {text!r}, a plane is written dip/dip direction, for example 45/115"
    advice = ""
    meant = parse_quadrants(text)
    if meant is not None or re.search(_QUADRANT, text) or "strike" in text.lower():
        advice = (
            "This looks like a strike: dip direction = strike + 90 by the right-hand rule, - 90 by the left-hand rule."
            if meant is None
            else f"This looks like a strike and the side of the dip: write {meant}."
        )
    return Fault("E104", message, where, _spelling_advice(text) or advice)


def _spelling_advice(text: str) -> str:
    """Return what to type for a plane whose two angles are not separated by a slash; empty where unclear.

    >>> _spelling_advice("45-115"), _spelling_advice("45,5/115"), _spelling_advice("45SE"), _spelling_advice("115 45")
    ('Write 45/115.', 'Write 45.5/115.', 'Write 45/135.', 'Write 45/115: the dip comes first.')
    >>> _spelling_advice("S45E/45")
    'Where S45E is the dip direction, write 45/135; where it is the strike, 45/045 or 45/225, by the side it dips to.'
    """
    if parse_quadrants(text) is not None:
        return ""
    plain = re.sub(r"(?i)°|\bdeg(?:rees?)?\b|^\s*\w+\s*=", " ", text)
    pair = re.match(
        r"(?i)^\s*(?:dip\s*[:=]?)?\s*(\d+(?:\.\d+)?)(?:\s*[-–,;:/|@>→]\s*|\s+(?:to|towards?)\s+|\s+)"
        r"(?:(?:dd|dip[ _]?dir(?:ection)?|azimuth)\s*[:=]?\s*)?(\d+(?:\.\d+)?)\s*$",
        plain,
    ) or re.match(r"^\s*(\d+,\d+|\d+(?=/\d+,))\s*/\s*(\d+(?:,\d+)?)\s*$", plain)
    if pair is not None:
        dip, direction = (float(angle.replace(",", ".")) for angle in pair.groups())
        is_swapped = dip > 90.0 >= direction
        dip, direction = (direction, dip) if is_swapped else (dip, direction)
        if dip > 90.0 or direction > 360.0:
            return ""
        return f"Write {Plane(dip, direction)}{': the dip comes first' if is_swapped else ''}."
    side = re.match(r"(?i)^\s*(\d+(?:\.\d+)?)\s*/?\s*([NESW]{1,3})\s*$", plain)
    toward = None if side is None else azimuth_of(side.group(2))
    if side is not None and toward is not None and float(side.group(1)) <= 90.0:
        return f"Write {Plane(float(side.group(1)), toward)}."
    return _quadrant_advice(plain)


def _quadrant_advice(text: str) -> str:
    """Return what to type for a bearing in quadrants with a dip of unknown side: `S45E/45`, `45/S45E`."""
    quadrant = r"([NSns]\s*\d+(?:\.\d+)?\s*[EWew])"
    match = re.match(rf"^\s*{quadrant}[\s/,;]+(\d+(?:\.\d+)?)\s*$", text)
    bearing_text, dip_text = match.groups() if match is not None else ("", "")
    if (
        match is None
        and (match := re.match(rf"^\s*(\d+(?:\.\d+)?)[\s/,;]+{quadrant}\s*$", text)) is not None
    ):
        dip_text, bearing_text = match.groups()
    azimuth = parse_strike(bearing_text) if match is not None else None
    if azimuth is None or float(dip_text) > 90.0:
        return ""
    dip = float(dip_text)
    sides = " or ".join(
        str(Plane(dip, direction))
        for direction in sorted(((azimuth + 90) % 360, (azimuth - 90) % 360))
    )
    return (
        f"Where {bearing_text.strip()} is the dip direction, write {Plane(dip, azimuth)}; "
        f"where it is the strike, {sides}, by the side it dips to."
    )


def parse_face(value: object, name: str, where: str = "") -> Plane:
    """Read the plane of a slope face or an upper slope as `parse_plane` does; one beyond 90° overhangs.

    The rock lies below a face: 95/180 is an overhang, and no face of 85/000, whose rock lies on the other side.

    Raises
    ------
    DesignError
        E101 a face that overhangs, and what `parse_plane` raises.
    """
    try:
        return parse_plane(value, name, where)
    except DesignError as error:
        raise DesignError([_face_fault(fault, value, name) for fault in error.faults]) from None


def _face_fault(fault: Fault, value: object, name: str) -> Fault:
    """Return the fault of a face, with an advice that keeps its rock on the same side."""
    angles = (
        value.split("/")
        if isinstance(value, str)
        else list(value)
        if isinstance(value, list | tuple)
        else []
    )
    if fault.code not in ("E101", "E103") or len(angles) != 2:
        return fault
    dip, direction = (float(str(angle).strip().rstrip("°")) for angle in angles)
    if not 90.0 < dip <= 180.0:
        return fault
    overhang = "A slope whose face overhangs is given by meshes, kind: blocks."
    if fault.code == "E103":
        return Fault(
            "E103",
            fault.message,
            fault.where,
            f"Dip comes first: did you mean {Plane(direction, dip)}?",
        )
    return Fault(
        "E101", f"dip of {name} is {number(dip)}, more than 90: it overhangs", fault.where, overhang
    )


def opposite(trend_deg: float) -> float:
    """Return the trend that points the other way, 0 to 360°.

    >>> opposite(200.0)
    20.0
    """
    return (trend_deg + 180.0) % 360.0
