"""Joints on oriented core: alpha and beta, the trend and plunge of the hole, and the line that beta is measured from.

alpha is the acute angle between the joint and the core axis, 90° where the joint crosses the core squarely. beta is
measured around the core, clockwise as one looks down the hole, from the reference line (the bottom or the top of the
core) to the lower end of the ellipse in which the joint cuts the core: the end farthest down the hole. Sources: Holcombe
(2010), Oriented drillcore: measurement and calculation procedures; Stanley & Hooper (2003), POND, Computers &
Geosciences 29, 531-537.
"""

import math
import re
from collections.abc import Mapping, Sequence

import numpy as np

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import Line, Plane, line_of, number
from slopekit.core.records import dataclass
from slopekit.design.survey.columns import BOTTOM, CORE, REFERENCE_LINES, SurveyColumn, key_of, spelled

#: Names of the depth along a hole.
DEPTHS = ("depth", "depth_m", "from", "from_m", "measured_depth", "md", "disc_top", "tiefe", "teufe")
#: Degrees (rounding): a core that plunges more steeply has neither top nor bottom.
STEEPEST_PLUNGE_DEG = 89.9
#: Headings of a dip direction that in a list of core may be the hole's azimuth.
_OF_THE_HOLE = ("azimuth", "azi", "azimut", "direction")
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
    return Plane(90.0 - pole.plunge_deg, (pole.trend_deg + 180.0) % 360.0)
