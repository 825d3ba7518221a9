"""Joints on oriented core: alpha and beta, the trend and plunge of the hole, and the line that beta is measured from.

alpha is the acute angle between the joint and the core axis, 90° where the joint crosses the core squarely. beta is
measured around the core, clockwise as seen looking down the hole, from the reference line (the bottom or the top of
the core) to the lower end of the ellipse in which the joint cuts the core: the end farthest down the hole. Sources:
Holcombe (2010), Oriented drillcore: measurement and calculation procedures; Stanley & Hooper (2003), POND, Computers &
Geosciences 29, 531-537.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from slopekit.core.orientation import Line, Plane, line_of, number, opposite
from slopekit.design.reading.nodes import fail
from slopekit.design.survey.columns import (
    AMBIGUOUS_DIRECTIONS,
    BOTTOM,
    CORE,
    REFERENCE_LINES,
    SurveyColumn,
    key_of,
    plane_columns,
    spelled,
    unit_in_heading,
)

#: Names of the depth along a hole.
DEPTHS = ("depth", "depth_m", "from", "from_m", "measured_depth", "md", "disc_top", "tiefe", "teufe")
#: Degrees (rounding): a core that plunges more steeply has neither top nor bottom.
STEEPEST_PLUNGE_DEG = 89.9
_NAMES = "Call the columns hole_trend and hole_plunge (degrees below the horizontal) where they are the hole's."


def plane_on_core(alpha_deg: float, beta_deg: float, hole: Line, is_from_bottom: bool) -> Plane:
    """The plane of a joint on oriented core.

    With a the unit vector down the hole and r the one from the core axis to the reference line, the lower end of the
    ellipse lies towards e = r cos β + (a × r) sin β, and the normal of the joint is a sin α - e cos α.

    Parameters
    ----------
    alpha_deg, beta_deg : as the module says; hole : the trend and plunge of the core axis, down the hole
    is_from_bottom : whether beta is measured from the bottom of the core, not from its top

    A hole that plunges 60° to the north cuts flat joints at 60°, with the lower end of the ellipse on top of the core:

    >>> print(plane_on_core(60.0, 0.0, Line(0.0, 60.0), is_from_bottom=False).dip_deg < 1e-9)
    True
    >>> plane = plane_on_core(14.0, 42.0, Line(213.0, 85.0), is_from_bottom=True)
    >>> round(plane.dip_deg, 1), round(plane.dip_direction_deg, 1)
    (79.7, 74.3)
    """
    alpha, beta = math.radians(alpha_deg), math.radians(beta_deg)
    axis = hole.vector()
    toward_top = Line(hole.trend_deg, hole.plunge_deg - 90.0).vector()
    toward_line = -toward_top if is_from_bottom else toward_top
    toward_lower_end = math.cos(beta) * toward_line + math.sin(beta) * np.cross(axis, toward_line)
    normal = math.sin(alpha) * axis - math.cos(alpha) * toward_lower_end
    pole = line_of(normal if normal[2] < 0.0 else -normal)
    return Plane(90.0 - pole.plunge_deg, opposite(pole.trend_deg))


def core_columns(
    name: str,
    columns: Mapping[str, SurveyColumn],
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    where: str,
) -> dict[str, SurveyColumn]:
    """The columns of a list, with those of the hole by their keys where the list is one of core.

    Parameters
    ----------
    name : of the list; columns : by key; headings : of all columns, used or not
    rows : the cells below the header, as many as headings; where : the header stands

    Raises
    ------
    DesignError
        E191 columns that may be the hole's or the joint's, or that lack; E192 no line that beta is measured from.
    """
    found = dict(columns)
    if "alpha" not in found and "beta" not in found:
        _refuse_trend_of_hole(name, found, headings, where)
        return found
    if _gives_planes(found):
        return found
    for key in ("alpha", "beta"):
        if key not in found:
            message = f"{name} has no column for {key}: core that is not oriented gives no planes"
            fail("E191", message, where, "alpha and beta are needed on oriented core.")
    for key, others in (("hole_trend", ("trend", "dip_direction")), ("hole_plunge", ("plunge", "dip"))):
        other = next((other for other in others if other in found), None)
        if key not in found and other is not None:
            found[key] = found.pop(other)
    if "hole_trend" not in found or "hole_plunge" not in found:
        message = f"{name} has alpha and beta of core, and no column for trend and plunge of the hole"
        fail("E191", message, where, _NAMES)
    _refuse_signs(name, found, rows, where)
    if "reference" not in found and found["beta"].convention is None:
        message = f"beta has two meanings: {name} does not say from which line, bottom or top of the core"
        advice = "Add a column reference with bottom or top, or name the column beta (bottom)."
        fail("E192", message, where, advice)
    return found


class CoreLog:
    """The rows of a list of oriented core, each with the trend and plunge of its hole.

    A row with trend and plunge and neither alpha nor beta is a survey station. A joint without trend and plunge has
    those of the station of its hole that is nearest by depth, the upper of two that are equally near.
    """

    def __init__(self, columns: Mapping[str, SurveyColumn], headings: Sequence[str]) -> None:
        self.columns = columns
        self.depth = next((k for k, heading in enumerate(headings) if spelled(heading) in DEPTHS), None)
        self.unit = (unit_in_heading(headings[self.depth]) if self.depth is not None else "") or "m"
        self.stations: dict[str, list[tuple[float, str, str]]] = {}
        self.distances: list[float] = []

    def is_station(self, cells: Sequence[str]) -> bool:
        """Whether a row is a survey station, which is then remembered."""
        alpha, beta, trend, plunge = (cells[self.columns[key].index] for key in CORE[:4])
        depth = self._depth(cells)
        if alpha or beta or not trend or not plunge or depth is None:
            return False
        self.stations.setdefault(self._hole(cells), []).append((depth, trend, plunge))
        return True

    def completed(self, texts: Mapping[str, str], cells: Sequence[str]) -> dict[str, str]:
        """The texts of a joint by key, with what stands in the header or in a survey station."""
        found = dict(texts)
        found["reference"] = found["reference"] or self.columns["beta"].convention or ""
        if not found["beta"] and re.fullmatch(r"90(\.0*)?°?", found["alpha"]):
            found["beta"] = "0"  # the joint crosses the core squarely, and has no lower end
        depth, stations = self._depth(cells), self.stations.get(self._hole(cells))
        if not found["hole_trend"] and not found["hole_plunge"] and depth is not None and stations:
            distance, _, trend, plunge = min((abs(at - depth), at, trend, plunge) for at, trend, plunge in stations)
            found |= {"hole_trend": trend, "hole_plunge": plunge}
            self.distances.append(distance)
        if "dip" in spelled(self.columns["hole_plunge"].heading):  # negative downwards, as drillers write it
            found["hole_plunge"] = found["hole_plunge"].lstrip("-")
        return found

    def read_as(self) -> list[str]:
        """How the planes of core were read, in words."""
        convention = self.columns["beta"].convention
        line = f"the {convention} of the core" if convention else "the reference line (bottom or top of the core)"
        said = [
            "planes are of oriented core: alpha is the acute angle to the core axis, beta is measured clockwise, "
            f"looking down the hole, from {line} to the lower end of the ellipse"
        ]
        if self.distances:
            stations, joints = sum(map(len, self.stations.values())), len(self.distances)
            said.append(
                f"{joints} joint{'s have' if joints > 1 else ' has'} the trend and plunge of the nearest of {stations} "
                f"survey stations, at most {number(round(max(self.distances), 3))} {self.unit} away along the hole"
            )
        return said

    def _hole(self, cells: Sequence[str]) -> str:
        return cells[self.columns["hole"].index] if "hole" in self.columns else ""

    def _depth(self, cells: Sequence[str]) -> float | None:
        text = "" if self.depth is None else cells[self.depth].replace(",", ".")
        return float(text) if re.fullmatch(r"\d+(\.\d*)?", text) else None


def is_from_bottom(reference: str) -> bool | None:
    """Whether a line on the core is its bottom, None for a word that means neither bottom nor top."""
    line = REFERENCE_LINES.get(spelled(reference))
    return None if line is None else line == BOTTOM


def _gives_planes(columns: Mapping[str, SurveyColumn]) -> bool:
    """Whether columns beside those of core give the joints' planes: a dip direction by its full name, a pole."""
    direction = columns.get("dip_direction")
    if "dip" in columns and direction is not None and spelled(direction.heading) not in AMBIGUOUS_DIRECTIONS:
        return True
    way = plane_columns(key for key in columns if key not in ("dip_direction", *CORE))
    return way is not None and (way != ("trend", "plunge") or _are_poles(columns))


def _are_poles(columns: Mapping[str, SurveyColumn]) -> bool:
    return any("pol" in spelled(columns[key].heading) for key in ("trend", "plunge"))


def _refuse_trend_of_hole(name: str, columns: Mapping[str, SurveyColumn], headings: Sequence[str], where: str) -> None:
    """Refuse trend and plunge beside a hole or a depth: they may be those of the hole as well as of poles."""
    if plane_columns(columns) != ("trend", "plunge") or "hole_trend" in columns or _are_poles(columns):
        return
    of_core = ("hole", "reference")
    sign = next((one for one in headings if key_of(one) in of_core or spelled(one) in DEPTHS), None)
    if sign is None:
        return
    message = f"trend and plunge of {name} may be those of the hole (column {sign}) or of poles"
    advice = "Poles are named pole_trend and pole_plunge; core needs alpha, beta and reference (bottom or top) as well."
    fail("E191", message, where, advice)


def _refuse_signs(name: str, columns: Mapping[str, SurveyColumn], rows: Iterable[Sequence[str]], where: str) -> None:
    """Refuse dips that may be the hole's or the joints': only those that are all negative are a hole's for certain."""
    column = columns["hole_plunge"]
    if "dip" not in spelled(column.heading):
        return
    dips = [row[column.index] for row in rows if row[column.index]]
    negative = sum(dip.startswith("-") for dip in dips)
    if negative != len(dips) and key_of(column.heading) == "dip":
        message = (
            f"{columns['hole_trend'].heading} and {column.heading} of {name} may be those of the hole or of joints"
        )
        fail("E191", message, where, _NAMES)
    if 0 < negative < len(dips):
        message = f"{column.heading} of {name} is negative in {negative} of {len(dips)} rows: some holes point upwards"
        fail("E191", message, where, _NAMES)
