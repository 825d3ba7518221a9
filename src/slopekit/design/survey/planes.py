"""The plane of a joint from the cells that give it: dip direction, strike, quadrants, Clar's notation, poles."""

import re
from collections.abc import Callable, Mapping, Sequence

from slopekit.core.errors import DesignError, Fault
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
from slopekit.core.units import quantity
from slopekit.design.survey.beyond_vertical import BeyondVertical
from slopekit.design.survey.columns import CORE, STRIKE_TO_DIP_DIRECTION, STRIKE_WITH_SIDE, WORDS
from slopekit.design.survey.oriented_core import STEEPEST_PLUNGE_DEG, is_from_bottom, plane_on_core

#: The order in which missing cells are named.
DIP_FIRST = ("dip", "dip_direction", "strike", "plane", "clar", "strike/dip", "trend", "plunge", *CORE).index
_NUMBER = re.compile(r"^[+-]?(\d+([.,]\d*)?|[.,]\d+)°?$")
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
        self.read, self.beyond = _PLANE_BY[way], beyond
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
        plane = self.read(self, name, texts, where)
        turn = self.declination_deg
        return Plane(plane.dip_deg, (plane.dip_direction_deg + turn) % 360.0) if turn else plane

    def by_dip_direction(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A dip and its direction, which a horizontal plane does without."""
        return self.checked(texts[0], texts[1] or "0", name, where)

    def by_strike(self, name: str, texts: Sequence[str], where: str) -> Plane:
        strike, dip = texts
        azimuth = parse_strike(strike)
        plane = None if azimuth is None else plane_by_side(azimuth, dip)
        if plane is None and azimuth is not None and (self.convention is None or re.search("[A-Za-z]", strike)):
            plane = plane_without_side(azimuth, dip)
        if plane is not None:
            return plane
        sided = re.search(r"[NESWnesw]$", dip) is not None
        if sided or (azimuth is not None and re.match(r"[NSEWnsew]", strike)):
            message = f"{name} strikes {strike} and dips {dip}: the side it dips to " + (
                "does not lie beside the strike" if sided else "is not said"
            )
            raise DesignError([Fault("E104", message, where, _BESIDE)])
        if azimuth is None:
            azimuth = quantity(strike, "angle", f"strike of {name}", where)
            if not 0.0 <= azimuth <= 360.0:
                message = f"strike of {name} is {number(azimuth)}, a direction lies between 0 and 360"
                raise DesignError([Fault("E102", message, where)])
        if self.convention is None:
            message = f"strike {strike} of {name} has two meanings, its convention is not said"
            raise DesignError([Fault("E192", message, where, self.conventions)])
        turned = (azimuth + STRIKE_TO_DIP_DIRECTION[self.convention]) % 360.0
        return self.checked(dip, f"{turned!r}", name, where, strike)

    def by_side(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A strike, a dip, and the side it dips to in a column of its own."""
        strike, dip, side = texts
        azimuth = parse_strike(strike)
        plane = None if azimuth is None else plane_by_side(azimuth, dip, side) or plane_without_side(azimuth, dip)
        if plane is None and azimuth is not None and not side:
            raise DesignError([Fault("E104", f"{name} strikes {strike} and dips {dip}: {_NO_SIDE}", where, _BESIDE)])
        if plane is None:
            message = f"{name} strikes {strike}, dips {dip} toward {side}: that is no plane"
            raise DesignError([Fault("E104", message, where, _BESIDE)])
        return plane

    def by_word(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """`45/115` or `N25E/45SE`."""
        plane = parse_quadrants(texts[0])
        if plane is not None:
            return plane
        dip, slash, direction = texts[0].partition("/")
        return self.checked(dip, direction, name, where) if slash else parse_plane(texts[0], name, where)

    def by_clar(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """`115/45`, as Clar wrote it."""
        direction, _slash, dip = texts[0].partition("/")
        return self.checked(dip, direction, name, where)

    def by_strike_word(self, name: str, texts: Sequence[str], where: str) -> Plane:
        plane = parse_quadrants(texts[0])
        strike, _slash, dip = texts[0].partition("/")
        return plane or self.by_strike(name, (strike.strip(), dip.strip()), where)

    def by_pole(self, name: str, texts: Sequence[str], where: str) -> Plane:
        trend, plunge = (
            quantity(text, "angle", f"{key} of {name}", where)
            for key, text in zip(("trend", "plunge"), texts, strict=True)
        )
        if not 0.0 <= plunge <= 90.0:
            message = f"the pole of {name} plunges {number(plunge)}, a pole points down by 0 to 90"
            raise DesignError([Fault("E101", message, where)])
        if not 0.0 <= trend <= 360.0:
            message = f"trend of {name} is {number(trend)}, a direction lies between 0 and 360"
            raise DesignError([Fault("E102", message, where)])
        self.angles.append((plunge, trend))
        return Plane(90.0 - plunge, opposite(trend))

    def by_core(self, name: str, texts: Sequence[str], where: str) -> Plane:
        """A plane by alpha, beta, trend and plunge of the hole, and the line on the core that beta is measured from."""
        alpha, beta, trend, plunge = (
            quantity(text, "angle", f"{WORDS[key]} of {name}", where)
            for key, text in zip(CORE, texts[:4], strict=False)
        )
        bottom = is_from_bottom(texts[4])
        if not 0.0 <= alpha <= 90.0:
            message = f"alpha of {name} is {number(alpha)}, an angle to the core axis lies between 0 and 90"
            raise DesignError([Fault("E101", message, where)])
        if not 0.0 <= plunge <= 90.0:
            message = f"the hole of {name} plunges {number(plunge)}, a hole points down by 0 to 90"
            raise DesignError([Fault("E101", message, where)])
        for key, value in (("beta", beta), ("trend of the hole", trend)):
            if not 0.0 <= value <= 360.0:
                message = f"{key} of {name} is {number(value)}, a direction lies between 0 and 360"
                raise DesignError([Fault("E102", message, where)])
        if bottom is None:
            message = f"beta of {name} is measured from {texts[4]!r}, it is the bottom or the top of the core"
            raise DesignError([Fault("E192", message, where)])
        if plunge > STEEPEST_PLUNGE_DEG:
            message = f"the hole of {name} is vertical: its core has neither bottom nor top"
            raise DesignError([Fault("E101", message, where)])
        self.angles.append((alpha, beta))
        plane = plane_on_core(alpha, beta, Line(trend, plunge), bottom)
        return Plane(round(plane.dip_deg, _CORE_DECIMALS), round(plane.dip_direction_deg, _CORE_DECIMALS) % 360.0)

    def checked(self, dip: str, direction: str, name: str, where: str, strike: str = "") -> Plane:
        """A plane of two texts; the angles as they are written are kept, to be looked at for radians.

        `strike` : that stands in the list where the direction follows from it
        """
        dip, direction = (
            text.strip().rstrip("°").replace(",", ".") if _NUMBER.match(text.strip()) else text
            for text in (dip, direction)
        )
        try:
            pair = (float(dip), float(direction))
        except ValueError:
            return parse_plane(f"{dip}/{direction}", name, where)
        written = strike or direction
        if self.beyond.is_overturned(pair[0], written):
            plane = overturned_plane(*pair)
            self.overturned.append(f"{number(pair[0])}/{bearing(pair[1])} is {plane}")
        elif self.beyond.order_is_sure and 90.0 < pair[0] <= 180.0 and 0.0 <= pair[1] <= 90.0:
            advice = (
                f"A plane that dips {number(pair[0])}° toward {bearing(pair[1])} is written {overturned_plane(*pair)}; "
                f"with dip and dip direction exchanged it is {number(pair[1])}/{bearing(pair[0])}."
            )
            message = f"dip of {name} is {number(pair[0])}, a dip lies between 0 and 90"
            raise DesignError([Fault("E101", message, where, advice)])
        else:
            plane = parse_plane(pair, name, where)
        azimuth = float(written.replace(",", ".").rstrip("°")) if _NUMBER.match(written) else pair[1]
        self.angles.append((pair[0], azimuth))
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


def is_horizontal(dip: str) -> bool:
    """Whether a dip is 0, so that it has no direction."""
    return re.match(r"^0+([.,]0*)?\s*°?$", dip.strip()) is not None


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
    ("clar",): PlaneReader.by_clar,
    ("strike/dip",): PlaneReader.by_strike_word,
    ("trend", "plunge"): PlaneReader.by_pole,
    CORE: PlaneReader.by_core,
}
