"""The plane of a joint from the cells that give it: dip direction, strike, quadrants, Clar's notation, poles."""

import re
from collections.abc import Callable, Mapping, Sequence

from slopekit.core.errors import Fault
from slopekit.core.orientation import (
    Line,
    Plane,
    bearing,
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
from slopekit.design.survey.beyond_vertical import BeyondVertical
from slopekit.design.survey.columns import (
    CORE,
    STRIKE_TO_DIP_DIRECTION,
    STRIKE_WITH_SIDE,
    WORDS,
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
