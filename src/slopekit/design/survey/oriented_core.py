"""Joints on oriented core: their planes from alpha, beta, the trend and plunge of the hole and a reference line.

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
    normalized_heading,
    plane_columns,
    unit_in_heading,
)

#: Headings of a column of depths along a hole.
DEPTHS = (
    "depth",
    "depth_m",
    "from",
    "from_m",
    "measured_depth",
    "md",
    "disc_top",
    "tiefe",
    "teufe",
)
#: Steepest plunge (degrees) of a hole whose core has a top and a bottom.
STEEPEST_PLUNGE_DEG = 89.9
_HOLE_COLUMNS = "Call the columns hole_trend and hole_plunge (degrees below the horizontal) where they are the hole's."


def plane_on_core(alpha_deg: float, beta_deg: float, hole: Line, is_from_bottom: bool) -> Plane:
    """Return the plane of a joint on oriented core.

    With a the unit vector down the hole and r the one from the core axis to the reference line, the lower end of the
    ellipse lies towards e = r cos β + (a × r) sin β, and the normal of the joint is a sin α - e cos α.

    Parameters
    ----------
    alpha_deg, beta_deg : angles as defined in the module's docstring
    hole : trend and plunge of the core axis, down the hole
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
    location: str,
) -> dict[str, SurveyColumn]:
    """Return the columns of a list by key; in a list of core, trend and plunge become those of the hole.

    Parameters
    ----------
    name : name of the list
    columns : columns by key
    headings : headings of all columns, used or not
    rows : cells of the rows below the header, as many as headings
    location : place of the header

    Raises
    ------
    DesignError
        E191 missing columns, or columns that may be the hole's or the joint's; E192 no reference line of beta.
    """
    by_key = dict(columns)
    if "alpha" not in by_key and "beta" not in by_key:
        _refuse_ambiguous_trend(name, by_key, headings, location)
        return by_key
    if _gives_planes(by_key):
        return by_key
    for key in ("alpha", "beta"):
        if key not in by_key:
            message = f"{name} has no column for {key}: core that is not oriented gives no planes"
            fail("E191", message, location, "alpha and beta are needed on oriented core.")
    for key, substitutes in (
        ("hole_trend", ("trend", "dip_direction")),
        ("hole_plunge", ("plunge", "dip")),
    ):
        substitute = next((substitute for substitute in substitutes if substitute in by_key), None)
        if key not in by_key and substitute is not None:
            by_key[key] = by_key.pop(substitute)
    if "hole_trend" not in by_key or "hole_plunge" not in by_key:
        message = (
            f"{name} has alpha and beta of core, and no column for trend and plunge of the hole"
        )
        fail("E191", message, location, _HOLE_COLUMNS)
    _refuse_ambiguous_dips(name, by_key, rows, location)
    if "reference" not in by_key and by_key["beta"].convention is None:
        message = (
            f"beta has two meanings: {name} does not say from which line, bottom or top of the core"
        )
        advice = "Add a column reference with bottom or top, or name the column beta (bottom)."
        fail("E192", message, location, advice)
    return by_key


class CoreLog:
    """A log of oriented core: completes the rows of joints with the trend and plunge of their hole.

    A row with trend and plunge, but neither alpha nor beta, is a survey station. A joint without trend and plunge gets
    those of the nearest station in its hole by depth, of the upper one if two are equally near.
    """

    def __init__(self, columns: Mapping[str, SurveyColumn], headings: Sequence[str]) -> None:
        self.columns = columns
        self.depth = next(
            (k for k, heading in enumerate(headings) if normalized_heading(heading) in DEPTHS), None
        )
        self.unit = (unit_in_heading(headings[self.depth]) if self.depth is not None else "") or "m"
        self.stations: dict[str, list[tuple[float, str, str]]] = {}
        self.distances: list[float] = []

    def is_station(self, cells: Sequence[str]) -> bool:
        """Return whether a row is a survey station, and record it if so."""
        alpha, beta, trend, plunge = (cells[self.columns[key].index] for key in CORE[:4])
        depth = self._depth(cells)
        if alpha or beta or not trend or not plunge or depth is None:
            return False
        self.stations.setdefault(self._hole(cells), []).append((depth, trend, plunge))
        return True

    def completed(self, texts: Mapping[str, str], cells: Sequence[str]) -> dict[str, str]:
        """Return the cells of a joint by key, completed from the header and from survey stations."""
        completed_texts = dict(texts)
        completed_texts["reference"] = (
            completed_texts["reference"] or self.columns["beta"].convention or ""
        )
        if not completed_texts["beta"] and re.fullmatch(r"90(\.0*)?°?", completed_texts["alpha"]):
            completed_texts["beta"] = (
                "0"  # the joint is normal to the core axis: its trace has no lower end
            )
        depth, stations = self._depth(cells), self.stations.get(self._hole(cells))
        if (
            not completed_texts["hole_trend"]
            and not completed_texts["hole_plunge"]
            and depth is not None
            and stations
        ):
            distance, _, trend, plunge = min(
                (abs(station_depth - depth), station_depth, trend, plunge)
                for station_depth, trend, plunge in stations
            )
            completed_texts |= {"hole_trend": trend, "hole_plunge": plunge}
            self.distances.append(distance)
        if "dip" in normalized_heading(
            self.columns["hole_plunge"].heading
        ):  # drillers write dips downwards as negative
            completed_texts["hole_plunge"] = completed_texts["hole_plunge"].lstrip("-")
        return completed_texts

    def read_as(self) -> list[str]:
        """Return the notes about the interpretation of the core."""
        convention = self.columns["beta"].convention
        line = (
            f"the {convention} of the core"
            if convention
            else "the reference line (bottom or top of the core)"
        )
        notes = [
            "planes are of oriented core: alpha is the acute angle to the core axis, beta is measured clockwise, "
            f"looking down the hole, from {line} to the lower end of the ellipse"
        ]
        if self.distances:
            stations, joints = sum(map(len, self.stations.values())), len(self.distances)
            notes.append(
                f"{joints} joint{'s have' if joints > 1 else ' has'} the trend and plunge of the nearest of {stations} "
                f"survey stations, at most {number(round(max(self.distances), 3))} {self.unit} away along the hole"
            )
        return notes

    def _hole(self, cells: Sequence[str]) -> str:
        return cells[self.columns["hole"].index] if "hole" in self.columns else ""

    def _depth(self, cells: Sequence[str]) -> float | None:
        text = "" if self.depth is None else cells[self.depth].replace(",", ".")
        return float(text) if re.fullmatch(r"\d+(\.\d*)?", text) else None


def is_from_bottom(reference: str) -> bool | None:
    """Return whether a reference line is the bottom of the core; None for a word that means neither bottom nor top."""
    line = REFERENCE_LINES.get(normalized_heading(reference))
    return None if line is None else line == BOTTOM


def _gives_planes(columns: Mapping[str, SurveyColumn]) -> bool:
    """Return whether columns besides those of core give the planes: an unambiguous dip direction, or poles."""
    direction = columns.get("dip_direction")
    if (
        "dip" in columns
        and direction is not None
        and normalized_heading(direction.heading) not in AMBIGUOUS_DIRECTIONS
    ):
        return True
    plane_keys = plane_columns(key for key in columns if key not in ("dip_direction", *CORE))
    return plane_keys is not None and (plane_keys != ("trend", "plunge") or _are_poles(columns))


def _are_poles(columns: Mapping[str, SurveyColumn]) -> bool:
    return any("pol" in normalized_heading(columns[key].heading) for key in ("trend", "plunge"))


def _refuse_ambiguous_trend(
    name: str, columns: Mapping[str, SurveyColumn], headings: Sequence[str], location: str
) -> None:
    """Raise E191 for trend and plunge in a list with holes or depths: they may be those of the hole or of poles."""
    if (
        plane_columns(columns) != ("trend", "plunge")
        or "hole_trend" in columns
        or _are_poles(columns)
    ):
        return
    core_keys = ("hole", "reference")
    core_heading = next(
        (
            heading
            for heading in headings
            if key_of(heading) in core_keys or normalized_heading(heading) in DEPTHS
        ),
        None,
    )
    if core_heading is None:
        return
    message = (
        f"trend and plunge of {name} may be those of the hole (column {core_heading}) or of poles"
    )
    advice = "Poles are named pole_trend and pole_plunge; core needs alpha, beta and reference (bottom or top) as well."
    fail("E191", message, location, advice)


def _refuse_ambiguous_dips(
    name: str, columns: Mapping[str, SurveyColumn], rows: Iterable[Sequence[str]], location: str
) -> None:
    """Raise E191 for dips that may be the hole's or the joints': only dips that are all negative are a hole's."""
    column = columns["hole_plunge"]
    if "dip" not in normalized_heading(column.heading):
        return
    dips = [row[column.index] for row in rows if row[column.index]]
    negative = sum(dip.startswith("-") for dip in dips)
    if negative != len(dips) and key_of(column.heading) == "dip":
        message = (
            f"{columns['hole_trend'].heading} and {column.heading} of {name} may be "
            "those of the hole or of joints"
        )
        fail("E191", message, location, _HOLE_COLUMNS)
    if 0 < negative < len(dips):
        message = f"{column.heading} of {name} is negative in {negative} of {len(dips)} rows: some holes point upwards"
        fail("E191", message, location, _HOLE_COLUMNS)
