"""One row of anchors from the crest of a plane failure: where their heads stand, and which plunges hold the block.

With an anchor of T per metre at an angle θ off the normal of the plane, Hoek & Bray (1981, ch. 7) have

    F = (c A + (W cos ψ_p - U - V sin ψ_p + T cos θ) tan φ) / (W sin ψ_p + V cos ψ_p - T sin θ)

which needs least T where the plunge is tan⁻¹(tan φ / F) - ψ_p. From the crest all anchors cross the plane that are
steeper than the upper slope, some of them behind a tension crack, where rock hangs on the same plane.
"""

import math

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.kinds import kind_of
from slopekit.studies.support.search import Site

_CLEAR_DEG = 0.1  # off the upper slope
_ON = 1e-9  # of the size of the block


@dataclass(frozen=True, slots=True)
class PlaneCrest:
    """The crest of a plane failure in local axes.

    Attributes
    ----------
    head : (3,) m; low, high : plunges that cross the plane, degrees
    normal, offset : of the plane, `normal · x = offset`
    """

    head: Floats
    low: float
    high: float
    normal: Floats
    offset: float

    def plunge(self, direction: Floats) -> float:
        """Of a direction (3,) in the section, into the slope; beyond 90 it points out of it."""
        return math.degrees(math.atan2(-float(direction[2]), -float(direction[0])))

    def reach(self, direction: Floats) -> float:
        """How far along a direction (3,) the plane lies from the head, m."""
        flat = direction * [1.0, 0.0, 1.0]
        return (self.offset - float(self.normal @ self.head)) / float(self.normal @ flat)


def crest_of(site: Site) -> PlaneCrest | None:
    """The crest of a site; None of a wedge, and where it is no part of the block (a crack in the face)."""
    crest_point = kind_of(site.design).crest_point
    if crest_point is None:
        return None
    head, joint = crest_point(site.design), site.joints[0]
    polygon, size = site.block.faces[joint], site.hull.size
    inside = (float(normal @ (site.block.faces[face][0] - head)) for face, normal in site.outward.items())
    if min(inside) < -_ON * size:
        return None
    ground = site.hull.outward[~site.hull.is_joint & ~site.hull.is_crack & (site.hull.outward[:, 2] > _ON)]
    flattest = -math.degrees(float(np.arctan2(ground[:, 0], ground[:, 2]).min()))
    low = math.ceil(flattest / _CLEAR_DEG + 1.0) * _CLEAR_DEG
    normal = site.outward[joint]
    return PlaneCrest(head, round(low, 6), 90.0, normal, float(normal @ polygon[0]))
