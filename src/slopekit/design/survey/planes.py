"""The plane of a joint from the cells of its row: dip direction, strike, quadrants, Clar's notation, poles, core."""

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
#: The limits of angles other than dip and dip direction.
_DIRECTION = declare(
    "", "angle", 0.0, 360.0, code="E102", says="a direction lies between 0 and 360"
)
_ANGLES: Mapping[str, Field] = {
    "strike": _DIRECTION,
    "trend": _DIRECTION,
    "beta": _DIRECTION,
    "hole_trend": _DIRECTION,
    "plunge": declare("", "angle", 0.0, 90.0, code="E101", says="a pole points down by 0 to 90"),
    "hole_plunge": declare(
        "", "angle", 0.0, 90.0, code="E101", says="a hole points down by 0 to 90"
    ),
    "alpha": declare(
        "", "angle", 0.0, 90.0, code="E101", says="an angle to the core axis lies between 0 and 90"
    ),
}
#: The order in which missing cells are named.
CELL_ORDER = (
    "dip",
    "dip_direction",
    "strike",
    "plane",
    "clar",
    "strike/dip",
    "trend",
    "plunge",
    *CORE,
).index
_MAX_EXAMPLES = 3  # overturned planes listed in a note
_CORE_DECIMALS = 4  # of a degree (rounding): alpha and beta are measured to whole degrees
_NO_SIDE = "the side it dips to is not said"
_SIDE_ADVICE = "Write the side it dips to, beside the strike: N25E/45SE is 45/115."

# -- dips beyond 90° --------------------------------------------------------------------------------------------------

# A row such as 95, 30 may be an overturned plane, or its columns may be swapped. The whole list decides: if no value of
# the dip directions exceeds 90° but dips do, the columns are swapped. A row is an overturned plane if its direction
# cannot be a dip: it exceeds 90°, or it has the notation of a direction, 030, in a list whose dips do not have it.

SHARE_OF_BAD_ROWS = 0.1  # largest fraction of bad rows that can be skipped
#: The columns of a plane with dip and azimuth exchanged.
_SWAPPED_COLUMNS = {
    ("dip", "dip_direction"): ("dip_direction", "dip"),
    ("strike", "dip"): ("dip", "strike"),
    ("trend", "plunge"): ("plunge", "trend"),
    ("plane",): ("clar",),
    ("clar",): ("plane",),
}


@dataclass(frozen=True)
class DipsBeyond90:
    """The evidence of all rows of a list about dips beyond 90°: overturned planes, or swapped columns.

    Attributes
    ----------
    rows : number of rows with two numbers
    swapped : number of rows with a dip beyond 90° and an azimuth up to 90°, which is not marked as a direction
    columns_are_swapped : whether so many rows fit only with dip and azimuth exchanged that the columns are swapped
    is_order_certain : whether azimuths beyond 90° prove the order of the columns, and no row contradicts it
    fits_both_orders : whether every number of either column could be a dip
    bearings_are_directions : whether the notation 030 marks a direction in this list
    """

    rows: int = 0
    swapped: int = 0
    columns_are_swapped: bool = False
    is_order_certain: bool = False
    fits_both_orders: bool = False
    bearings_are_directions: bool = False

    def is_overturned(self, dip_deg: float, azimuth: str) -> bool:
        """Return whether a row is certainly an overturned plane."""
        azimuth_deg = number_in(azimuth)
        if not 90.0 < dip_deg <= 180.0 or azimuth_deg is None or not 0.0 <= azimuth_deg <= 360.0:
            return False
        return azimuth_deg > 90.0 or (
            self.bearings_are_directions and is_written_as_bearing(azimuth)
        )


def check_dips_beyond_90(pairs: Iterable[tuple[str, str]]) -> DipsBeyond90:
    """Collect the evidence of pairs of dip and azimuth, as texts, about dips beyond 90°.

    >>> swapped = check_dips_beyond_90([("196", "76"), ("178", "68"), ("62", "53")])
    >>> swapped.columns_are_swapped, swapped.is_overturned(178.0, "68")
    (True, False)
    >>> overturned = check_dips_beyond_90([("95", "030"), ("110", "028"), ("85", "205")])
    >>> overturned.columns_are_swapped, overturned.is_overturned(95.0, "030")
    (False, True)
    """
    rows = [
        (dip, azimuth, dip_deg, azimuth_deg)
        for dip, azimuth in pairs
        if (dip_deg := number_in(dip)) is not None
        and (azimuth_deg := number_in(azimuth)) is not None
    ]
    suspects = [row for row in rows if row[2] > 90.0 and row[3] <= 90.0]
    beyond_half_turn = any(row[2] > 180.0 for row in suspects)
    bearings_count = (
        len(suspects) < len(rows)
        and not beyond_half_turn
        and not any(is_written_as_bearing(row[0]) for row in rows)
    )
    swapped = sum(not (bearings_count and is_written_as_bearing(row[1])) for row in suspects)
    azimuths_beyond, tenth = sum(row[3] > 90.0 for row in rows), SHARE_OF_BAD_ROWS * len(rows)
    are_swapped = swapped > tenth and swapped > 1 and azimuths_beyond <= tenth
    is_sure = azimuths_beyond > 0 and not beyond_half_turn and not are_swapped
    fits_both = bool(rows) and not azimuths_beyond and all(row[2] <= 90.0 for row in rows)
    return DipsBeyond90(len(rows), swapped, are_swapped, is_sure, fits_both, bearings_count)


def swapped_columns(
    name: str,
    location: str,
    headings: Sequence[str],
    plane_keys: Sequence[str],
    dips_beyond_90: DipsBeyond90,
    option: str,
) -> Fault:
    """Return fault E103 for a list whose columns of dips and azimuths are swapped.

    Parameters
    ----------
    headings : headings of all columns in the order of the list
    plane_keys : keys of the columns that give the plane
    """
    azimuth = "dip directions" if plane_keys[0] in ("dip", "plane", "clar") else f"{plane_keys[0]}s"
    column = "plunge" if plane_keys[0] == "trend" else "dip"
    place_text = (
        f"the column {column}"
        if len(plane_keys) > 1
        else f"front in the column {WORDS[plane_keys[0]]}"
    )
    if plane_keys[0] in ("clar", "strike/dip"):
        place_text = f"the place of dips in the column {WORDS[plane_keys[0]]}"
    message = (
        f"{azimuth} over 90 stand in {place_text}: columns swapped? "
        f"({dips_beyond_90.swapped} of {dips_beyond_90.rows} rows of {name})"
    )
    exchange = dict(
        zip(plane_keys, _SWAPPED_COLUMNS.get(tuple(plane_keys), tuple(plane_keys)), strict=True)
    )
    advice = f"If so: {columns_advice(option, [exchange.get(heading, heading) for heading in headings])}."
    return Fault("E103", message, location, advice)


# -- planes of rows ---------------------------------------------------------------------------------------------------


class PlaneReader:
    """Computes the planes of a list, all from the same columns, and keeps their angles as written.

    Parameters
    ----------
    plane_keys : keys of these columns
    convention : convention of strikes; None if it is not known
    convention_advice : advice where the convention is missing
    declination_deg : declination, added to every azimuth
    dips_beyond_90 : evidence which dips beyond 90° are overturned planes
    """

    def __init__(
        self,
        plane_keys: tuple[str, ...],
        convention: str | None,
        convention_advice: str,
        declination_deg: float,
        dips_beyond_90: DipsBeyond90,
    ) -> None:
        self.plane_keys, self.dips_beyond_90 = plane_keys, dips_beyond_90
        self.overturned: list[str] = []
        self.convention, self.convention_advice, self.declination_deg = (
            convention,
            convention_advice,
            declination_deg,
        )
        self.angles: list[tuple[float, float]] = []  # as written in the list

    def plane(self, name: str, texts: Sequence[str], location: str) -> Plane:
        """Return the plane of the texts of one row.

        Raises
        ------
        DesignError
            E101 to E105 for texts that give no plane, E192 a strike without its convention.
        """
        plane = _PLANE_BY[self.plane_keys](self, name, texts, location)
        turn = self.declination_deg
        return Plane(plane.dip_deg, (plane.dip_direction_deg + turn) % 360.0) if turn else plane

    def by_dip_direction(self, name: str, texts: Sequence[str], location: str) -> Plane:
        """Return a plane from dip and dip direction; a horizontal plane needs no direction."""
        return self.checked(texts[0], texts[1] or "0", name, location)

    def by_strike(self, name: str, texts: Sequence[str], location: str) -> Plane:
        """Return a plane from strike and dip; either may have the letters of a side."""
        strike, dip = texts
        azimuth, has_side = parse_strike(strike), re.search(r"[NESWnesw]$", dip) is not None
        has_letters = azimuth is not None and re.search("[A-Za-z]", strike) is not None
        if azimuth is not None:
            plane = plane_by_side(azimuth, dip)
            if plane is None and (self.convention is None or has_letters):
                plane = plane_without_side(azimuth, dip)
            if plane is not None:
                return plane
        if has_side or has_letters:
            subject = f"{name} strikes {strike} and dips {dip}: the side it dips to"
            fail(
                "E104",
                f"{subject} {'does not lie beside the strike' if has_side else 'is not said'}",
                location,
                _SIDE_ADVICE,
            )
        if azimuth is None:
            azimuth = _angle("strike", strike, name, location)
        if self.convention is None:
            message = f"strike {strike} of {name} has two meanings, its convention is not said"
            fail("E192", message, location, self.convention_advice)
        dip_direction = (azimuth + STRIKE_TO_DIP_DIRECTION[self.convention]) % 360.0
        return self.checked(dip, f"{dip_direction!r}", name, location, strike)

    def by_side(self, name: str, texts: Sequence[str], location: str) -> Plane:
        """Return a plane from strike, dip, and the side it dips to in a column of its own."""
        strike, dip, side = texts
        azimuth = parse_strike(strike)
        plane = (
            None
            if azimuth is None
            else plane_by_side(azimuth, dip, side) or plane_without_side(azimuth, dip)
        )
        if plane is None:
            problem = (
                f", dips {dip} toward {side}: that is no plane"
                if side
                else f" and dips {dip}: {_NO_SIDE}"
            )
            fail("E104", f"{name} strikes {strike}{problem}", location, _SIDE_ADVICE)
        return plane

    def by_word(self, name: str, texts: Sequence[str], location: str) -> Plane:
        """Return a plane from a single cell: `45/115`, Clar's `115/45`, strike and dip, or quadrants."""
        plane, (first, slash, second) = (
            parse_quadrants(texts[0]),
            map(str.strip, texts[0].partition("/")),
        )
        if plane is not None:
            return plane
        if self.plane_keys == ("strike/dip",):
            return self.by_strike(name, (first, second), location)
        if not slash:
            return parse_plane(texts[0], name, location)
        dip, direction = (first, second) if self.plane_keys == ("plane",) else (second, first)
        return self.checked(dip, direction, name, location)

    def by_pole(self, name: str, texts: Sequence[str], location: str) -> Plane:
        trend, plunge = (
            _angle(key, text, name, location) for key, text in zip(POLE, texts, strict=True)
        )
        self.angles.append((plunge, trend))
        return Plane(90.0 - plunge, opposite(trend))

    def by_core(self, name: str, texts: Sequence[str], location: str) -> Plane:
        """Return a plane from alpha, beta, trend and plunge of the hole, and the reference line of beta."""
        alpha, beta, trend, plunge = (
            _angle(key, text, name, location) for key, text in zip(CORE, texts[:4], strict=False)
        )
        bottom = is_from_bottom(texts[4])
        if bottom is None:
            message = f"beta of {name} is measured from {texts[4]!r}, it is the bottom or the top of the core"
            fail("E192", message, location)
        if plunge > STEEPEST_PLUNGE_DEG:
            fail(
                "E101",
                f"the hole of {name} is vertical: its core has neither bottom nor top",
                location,
            )
        self.angles.append((alpha, beta))
        plane = plane_on_core(alpha, beta, Line(trend, plunge), bottom)
        return Plane(
            round(plane.dip_deg, _CORE_DECIMALS),
            round(plane.dip_direction_deg, _CORE_DECIMALS) % 360.0,
        )

    def checked(
        self, dip: str, direction: str, name: str, location: str, strike: str = ""
    ) -> Plane:
        """Return a plane from the texts of dip and dip direction; the written angles are kept for the radians check.

        `strike` is the text in the list, where the dip direction was computed from it.
        """
        dip_deg, direction_deg, written = number_in(dip), number_in(direction), strike or direction
        if dip_deg is None or direction_deg is None:
            return parse_plane(f"{dip}/{direction}", name, location)
        overturned = overturned_plane(dip_deg, direction_deg)
        if self.dips_beyond_90.is_overturned(dip_deg, written):
            plane = overturned
            self.overturned.append(f"{number(dip_deg)}/{bearing(direction_deg)} is {plane}")
        elif (
            self.dips_beyond_90.is_order_certain
            and 90.0 < dip_deg <= 180.0
            and 0.0 <= direction_deg <= 90.0
        ):
            advice = (
                f"A plane that dips {number(dip_deg)}° toward {bearing(direction_deg)} is written {overturned}; "
                f"with dip and dip direction exchanged it is {number(direction_deg)}/{bearing(dip_deg)}."
            )
            message = f"dip of {name} is {number(dip_deg)}, a dip lies between 0 and 90"
            fail("E101", message, location, advice)
        else:
            plane = parse_plane((dip_deg, direction_deg), name, location)
        azimuth = number_in(written)
        self.angles.append((dip_deg, direction_deg if azimuth is None else azimuth))
        return plane

    def read_as(self) -> list[str]:
        """Return the notes about dips beyond 90° that were read as overturned planes."""
        if not self.overturned:
            return []
        many = len(self.overturned)
        more = f" and {many - _MAX_EXAMPLES} more" if many > _MAX_EXAMPLES else ""
        verb = "is of an overturned plane" if many == 1 else "are of overturned planes"
        return [
            f"{counted(many, 'dip')} beyond 90° {verb}: {', '.join(self.overturned[:_MAX_EXAMPLES])}{more}"
        ]

    def radians_faults(self, name: str) -> list[Fault]:
        """Return fault E113 for a list all of whose angles look like radians."""
        are_integers = all(angle.is_integer() for pair in self.angles for angle in pair)
        if (
            not self.angles
            or are_integers
            or not all(look_like_radians(*pair) for pair in self.angles)
        ):
            return []
        steepest, last = (number(max(angles)) for angles in zip(*self.angles, strict=True))
        message = f"no angle of {name} is beyond {steepest} and {last}: that looks like radians"
        return [Fault("E113", message, name, "Degrees are needed: multiply them by 57.29578.")]


def _angle(key: str, text: str, name: str, location: str) -> float:
    """Return an angle of a plane, its pole or oriented core in degrees, checked against its limits."""
    return _ANGLES[key].read(text, f"{WORDS[key]} of {name}", location)


def dip_and_azimuth(plane_keys: tuple[str, ...], texts: Sequence[str]) -> tuple[str, str]:
    """Return the texts of the dip and of the azimuth (dip direction, strike or trend) of one row.

    >>> dip_and_azimuth(("strike", "dip"), ("25", "45")), dip_and_azimuth(("plane",), ("45/115",))
    (('45', '25'), ('45', '115'))
    """
    if len(texts) == 1:
        first, _, second = texts[0].partition("/")
    else:
        first, second = texts[0], texts[1]
    return (first, second) if plane_keys[0] in ("dip", "plane") else (second, first)


#: The function that gives the plane, by the keys of the columns.
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
