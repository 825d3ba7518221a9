"""The plane of a joint from the cells that give it: dip direction, strike, quadrants, Clar's notation, poles."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from slopekit.core.errors import Fault
from slopekit.core.orientation import (
    Line,
    Plane,
    bearing,
    is_written_as_bearing,
    look_like_radians,
    number,
    opposite,
    overturned_plane,
    parse_plane,
    parse_quadrants,
    parse_strike,
    plane_by_side,
    plane_without_side,
)
from slopekit.core.sheet import counted
from slopekit.design.fields import Field, declare
from slopekit.design.reading.nodes import fail
from slopekit.design.survey.columns import (
    CORE,
    STRIKE_TO_DIP_DIRECTION,
    STRIKE_WITH_SIDE,
    WORDS,
    columns_advice,
    number_in,
)
from slopekit.design.survey.oriented_core import STEEPEST_PLUNGE_DEG, is_from_bottom, plane_on_core

POLE = ("trend", "plunge")
#: What the angles of planes may be, where they are not dip and dip direction.
_DIRECTION = declare("", "angle", 0.0, 360.0, code="E102", says="a direction lies between 0 and 360")
_ANGLES: Mapping[str, Field] = {
    "strike": _DIRECTION,
    "trend": _DIRECTION,
    "beta": _DIRECTION,
    "hole_trend": _DIRECTION,
    "plunge": declare("", "angle", 0.0, 90.0, code="E101", says="a pole points down by 0 to 90"),
    "hole_plunge": declare("", "angle", 0.0, 90.0, code="E101", says="a hole points down by 0 to 90"),
    "alpha": declare("", "angle", 0.0, 90.0, code="E101", says="an angle to the core axis lies between 0 and 90"),
}
#: The order in which missing cells are named.
DIP_FIRST = ("dip", "dip_direction", "strike", "plane", "clar", "strike/dip", "trend", "plunge", *CORE).index
_SHOWN = 3  # overturned planes that are named
_CORE_DECIMALS = 4  # of a degree (rounding): alpha and beta are measured to whole degrees
_NO_SIDE = "the side it dips to is not said"
_BESIDE = "Write the side it dips to, beside the strike: N25E/45SE is 45/115."

# -- dips beyond 90° --------------------------------------------------------------------------------------------------

# A row such as 95, 30 may be an overturned plane, or have its columns swapped. What decides is the whole list: a column
# of dip directions that never exceeds 90° beside dips that do is one of dips. An overturned plane is read where its
# direction can be no dip: it exceeds 90°, or it is written as directions are, 030, in a list that writes its dips
# otherwise and swaps none of them.

SHARE_OF_BAD_ROWS = 0.1  # up to which bad rows are faults of their own, and can be skipped
#: How two columns are exchanged, by the way that they give planes.
_EXCHANGED = {
    ("dip", "dip_direction"): ("dip_direction", "dip"),
    ("strike", "dip"): ("dip", "strike"),
    ("trend", "plunge"): ("plunge", "trend"),
    ("plane",): ("clar",),
    ("clar",): ("plane",),
}


@dataclass(frozen=True)
class BeyondVertical:
    """What the dips and azimuths of all rows say of dips beyond 90°.

    Attributes
    ----------
    rows : with two numbers; swapped : of them with a dip beyond 90° and an azimuth up to 90° as a number
    columns_are_swapped : whether so many rows fit only with dip and azimuth exchanged that their columns are
    order_is_sure : whether azimuths that can be no dip say which column is which, and no row contradicts them
    fits_both_orders : whether every number of either column could be a dip
    bearings_count : whether 030 is a direction in this list by its notation
    """

    rows: int = 0
    swapped: int = 0
    columns_are_swapped: bool = False
    order_is_sure: bool = False
    fits_both_orders: bool = False
    bearings_count: bool = False

    def is_overturned(self, dip_deg: float, azimuth: str) -> bool:
        """Whether a row is an overturned plane for certain."""
        azimuth_deg = number_in(azimuth)
        if not 90.0 < dip_deg <= 180.0 or azimuth_deg is None or not 0.0 <= azimuth_deg <= 360.0:
            return False
        return azimuth_deg > 90.0 or (self.bearings_count and is_written_as_bearing(azimuth))


def beyond_vertical(pairs: Iterable[tuple[str, str]]) -> BeyondVertical:
    """What the texts of dips and azimuths say together.

    >>> swapped = beyond_vertical([("196", "76"), ("178", "68"), ("62", "53")])
    >>> swapped.columns_are_swapped, swapped.is_overturned(178.0, "68")
    (True, False)
    >>> overturned = beyond_vertical([("95", "030"), ("110", "028"), ("85", "205")])
    >>> overturned.columns_are_swapped, overturned.is_overturned(95.0, "030")
    (False, True)
    """
    rows = [
        (dip, azimuth, dip_deg, azimuth_deg)
        for dip, azimuth in pairs
        if (dip_deg := number_in(dip)) is not None and (azimuth_deg := number_in(azimuth)) is not None
    ]
    suspects = [row for row in rows if row[2] > 90.0 and row[3] <= 90.0]
    beyond_half_turn = any(row[2] > 180.0 for row in suspects)
    bearings_count = (
        len(suspects) < len(rows) and not beyond_half_turn and not any(is_written_as_bearing(row[0]) for row in rows)
    )
    swapped = sum(not (bearings_count and is_written_as_bearing(row[1])) for row in suspects)
    azimuths_beyond, tenth = sum(row[3] > 90.0 for row in rows), SHARE_OF_BAD_ROWS * len(rows)
    are_swapped = swapped > tenth and swapped > 1 and azimuths_beyond <= tenth
    is_sure = azimuths_beyond > 0 and not beyond_half_turn and not are_swapped
    fits_both = bool(rows) and not azimuths_beyond and all(row[2] <= 90.0 for row in rows)
    return BeyondVertical(len(rows), swapped, are_swapped, is_sure, fits_both, bearings_count)


def swapped_columns(
    name: str, where: str, headings: Sequence[str], way: Sequence[str], beyond: BeyondVertical, option: str
) -> Fault:
    """The fault of a list whose dips and azimuths stand in each other's columns.

    Parameters
    ----------
    headings : of the columns in their order in the list, all of them; way : those that give the plane
    """
    azimuth = "dip directions" if way[0] in ("dip", "plane", "clar") else f"{way[0]}s"
    column = "plunge" if way[0] == "trend" else "dip"
    at = f"the column {column}" if len(way) > 1 else f"front in the column {WORDS[way[0]]}"
    if way[0] in ("clar", "strike/dip"):
        at = f"the place of dips in the column {WORDS[way[0]]}"
    message = f"{azimuth} over 90 stand in {at}: columns swapped? ({beyond.swapped} of {beyond.rows} rows of {name})"
    exchange = dict(zip(way, _EXCHANGED.get(tuple(way), tuple(way)), strict=True))
    advice = f"If so: {columns_advice(option, [exchange.get(heading, heading) for heading in headings])}."
    return Fault("E103", message, where, advice)


# -- planes of rows ---------------------------------------------------------------------------------------------------


class PlaneReader:
    """Planes of a list, all by the same columns.

    Parameters
    ----------
    way : those columns; convention : of strikes; conventions : what is said where it is missing
    declination_deg : added to every azimuth; beyond : which dips beyond 90° are overturned planes
    """

    def __init__(
        self,
        way: tuple[str, ...],
        convention: str | None,
        conventions: str,
        declination_deg: float,
        beyond: BeyondVertical,
    ) -> None:
        self.way, self.beyond = way, beyond
        self.overturned: list[str] = []
        self.convention, self.conventions, self.declination_deg = convention, conventions, declination_deg
        self.angles: list[tuple[float, float]] = []  # as they stand in the list

    def plane(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """The plane of the texts of one row.

        Raises
        ------
        DesignError
            E101 to E105 for what is no plane, E192 a strike that needs a convention.
        """
        plane = _PLANE_BY[self.way](self, name, texts, where)
        turn = self.declination_deg
        return Plane(plane.dip_deg, (plane.dip_direction_deg + turn) % 360.0) if turn else plane

    def by_dip_direction(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A dip and its direction, which a horizontal plane does without."""
        return self.checked(texts[0], texts[1] or "0", name, where)

    def by_strike(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A strike and a dip, each with or without a side."""
        strike, dip = texts
        azimuth, sided = parse_strike(strike), re.search(r"[NESWnesw]$", dip) is not None
        in_letters = azimuth is not None and re.search("[A-Za-z]", strike) is not None
        if azimuth is not None:
            plane = plane_by_side(azimuth, dip)
            if plane is None and (self.convention is None or in_letters):
                plane = plane_without_side(azimuth, dip)
            if plane is not None:
                return plane
        if sided or in_letters:
            what = f"{name} strikes {strike} and dips {dip}: the side it dips to"
            fail("E104", f"{what} {'does not lie beside the strike' if sided else 'is not said'}", where, _BESIDE)
        if azimuth is None:
            azimuth = _angle("strike", strike, name, where)
        if self.convention is None:
            message = f"strike {strike} of {name} has two meanings, its convention is not said"
            fail("E192", message, where, self.conventions)
        turned = (azimuth + STRIKE_TO_DIP_DIRECTION[self.convention]) % 360.0
        return self.checked(dip, f"{turned!r}", name, where, strike)

    def by_side(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A strike, a dip, and the side it dips to in a column of its own."""
        strike, dip, side = texts
        azimuth = parse_strike(strike)
        plane = None if azimuth is None else plane_by_side(azimuth, dip, side) or plane_without_side(azimuth, dip)
        if plane is None:
            what = f", dips {dip} toward {side}: that is no plane" if side else f" and dips {dip}: {_NO_SIDE}"
            fail("E104", f"{name} strikes {strike}{what}", where, _BESIDE)
        return plane

    def by_word(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A plane in one word: `45/115`, `115/45` as Clar wrote it, a strike and a dip, or in quadrants."""
        plane, (first, slash, second) = parse_quadrants(texts[0]), map(str.strip, texts[0].partition("/"))
        if plane is not None:
            return plane
        if self.way == ("strike/dip",):
            return self.by_strike(name, (first, second), where)
        if not slash:
            return parse_plane(texts[0], name, where)
        dip, direction = (first, second) if self.way == ("plane",) else (second, first)
        return self.checked(dip, direction, name, where)

    def by_pole(self, name: str, texts: Sequence[str], where: str) -> Plane:
        trend, plunge = (_angle(key, text, name, where) for key, text in zip(POLE, texts, strict=True))
        self.angles.append((plunge, trend))
        return Plane(90.0 - plunge, opposite(trend))

    def by_core(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A plane by alpha, beta, trend and plunge of the hole, and the line on the core that beta is measured from."""
        alpha, beta, trend, plunge = (
            _angle(key, text, name, where) for key, text in zip(CORE, texts[:4], strict=False)
        )
        bottom = is_from_bottom(texts[4])
        if bottom is None:
            message = f"beta of {name} is measured from {texts[4]!r}, it is the bottom or the top of the core"
            fail("E192", message, where)
        if plunge > STEEPEST_PLUNGE_DEG:
            fail("E101", f"the hole of {name} is vertical: its core has neither bottom nor top", where)
        self.angles.append((alpha, beta))
        plane = plane_on_core(alpha, beta, Line(trend, plunge), bottom)
        return Plane(round(plane.dip_deg, _CORE_DECIMALS), round(plane.dip_direction_deg, _CORE_DECIMALS) % 360.0)

    def checked(self, dip: str, direction: str, name: str, where: str, strike: str = "") -> Plane:
        """A plane of two texts; the angles as they are written are kept, to be looked at for radians.

        `strike` : that stands in the list where the direction follows from it
        """
        dip_deg, direction_deg, written = number_in(dip), number_in(direction), strike or direction
        if dip_deg is None or direction_deg is None:
            return parse_plane(f"{dip}/{direction}", name, where)
        overturned = overturned_plane(dip_deg, direction_deg)
        if self.beyond.is_overturned(dip_deg, written):
            plane = overturned
            self.overturned.append(f"{number(dip_deg)}/{bearing(direction_deg)} is {plane}")
        elif self.beyond.order_is_sure and 90.0 < dip_deg <= 180.0 and 0.0 <= direction_deg <= 90.0:
            advice = (
                f"A plane that dips {number(dip_deg)}° toward {bearing(direction_deg)} is written {overturned}; "
                f"with dip and dip direction exchanged it is {number(direction_deg)}/{bearing(dip_deg)}."
            )
            message = f"dip of {name} is {number(dip_deg)}, a dip lies between 0 and 90"
            fail("E101", message, where, advice)
        else:
            plane = parse_plane((dip_deg, direction_deg), name, where)
        azimuth = number_in(written)
        self.angles.append((dip_deg, direction_deg if azimuth is None else azimuth))
        return plane

    def read_as(self) -> list[str]:
        """How dips beyond 90° were read, in words."""
        if not self.overturned:
            return []
        many = len(self.overturned)
        more = f" and {many - _SHOWN} more" if many > _SHOWN else ""
        verb = "is of an overturned plane" if many == 1 else "are of overturned planes"
        return [f"{counted(many, 'dip')} beyond 90° {verb}: {', '.join(self.overturned[:_SHOWN])}{more}"]

    def radians(self, name: str) -> list[Fault]:
        """The fault of a list all of whose angles are those of planes in radians."""
        whole = all(angle.is_integer() for pair in self.angles for angle in pair)
        if not self.angles or whole or not all(look_like_radians(*pair) for pair in self.angles):
            return []
        steepest, last = (number(max(angles)) for angles in zip(*self.angles, strict=True))
        message = f"no angle of {name} is beyond {steepest} and {last}: that looks like radians"
        return [Fault("E113", message, name, "Degrees are needed: multiply them by 57.29578.")]


def _angle(key: str, text: str, name: str, where: str) -> float:
    """An angle of a plane, of its pole, or of core."""
    return _ANGLES[key].read(text, f"{WORDS[key]} of {name}", where)


def dip_and_azimuth(way: tuple[str, ...], texts: Sequence[str]) -> tuple[str, str]:
    """The texts of the dip and the azimuth (dip direction, strike or trend) among those of one row.

    >>> dip_and_azimuth(("strike", "dip"), ("25", "45")), dip_and_azimuth(("plane",), ("45/115",))
    (('45', '25'), ('45', '115'))
    """
    if len(texts) == 1:
        first, _, second = texts[0].partition("/")
    else:
        first, second = texts[0], texts[1]
    return (first, second) if way[0] in ("dip", "plane") else (second, first)


#: How the columns of each way make a plane.
_PLANE_BY: Mapping[tuple[str, ...], Callable[[PlaneReader, str, Sequence[str], str], Plane]] = {
    ("dip", "dip_direction"): PlaneReader.by_dip_direction,
    ("strike", "dip"): PlaneReader.by_strike,
    STRIKE_WITH_SIDE: PlaneReader.by_side,
    ("plane",): PlaneReader.by_word,
    ("clar",): PlaneReader.by_word,
    ("strike/dip",): PlaneReader.by_word,
    ("trend", "plunge"): PlaneReader.by_pole,
    CORE: PlaneReader.by_core,
}
