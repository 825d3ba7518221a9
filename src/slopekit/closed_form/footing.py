"""The footing on a weak plane: a block between a plane and a level load, forces only.

Source: Sheng, Li, Liu & Qi (2023), Applied Sciences 13, 7301, §3.3.
"""

import math

from slopekit.closed_form.tolerances import SMALL
from slopekit.core.records import dataclass


@dataclass(frozen=True, slots=True)
class ClosedFormFooting:
    """What the closed form says of a block under a footing.

    Attributes
    ----------
    status : slides, no_driving_force, lifted (the load pulls the block off) or falls (the plane is vertical)
    factor : factor of safety, None unless the block slides
    normal_kn, driving_kn, resisting_kn : kN per metre, square to the plane and along it
    """

    status: str
    factor: float | None
    normal_kn: float
    driving_kn: float
    resisting_kn: float


def footing(
    load_kn: float,
    dip_deg: float,
    length_m: float,
    cohesion_kpa: float,
    friction_angle_deg: float,
    weight_kn: float = 0.0,
    uplift_kn: float = 0.0,
) -> ClosedFormFooting:
    """Factor of safety of a block on one plane under a vertical load and its own weight.

    Parameters
    ----------
    load_kn, weight_kn : kN per metre, positive downward; length_m : m, along the plane
    uplift_kn : of water on the plane, square to it, kN per metre

    Formula: F = (c L + N tan φ) / T with N = P cos δ - U, T = P sin δ, P load and weight (Sheng et al. 2023, §3.3), U
    uplift.

    >>> block = footing(1500, 45, 5 * 2**0.5, 200, 0)
    >>> block.status, round(block.factor, 4)
    ('slides', 1.3333)
    """
    total = load_kn + weight_kn
    size = abs(load_kn) + abs(weight_kn) + abs(uplift_kn)
    normal = total * math.cos(math.radians(dip_deg)) - uplift_kn
    driving = total * math.sin(math.radians(dip_deg))
    if abs(total) <= SMALL * size:
        return ClosedFormFooting("no_driving_force", None, 0.0, 0.0, cohesion_kpa * length_m)
    if normal <= SMALL * size:
        return ClosedFormFooting("lifted" if total < 0.0 or uplift_kn > 0.0 else "falls", None, 0.0, 0.0, 0.0)
    resisting = cohesion_kpa * length_m + normal * math.tan(math.radians(friction_angle_deg))
    if driving <= SMALL * size:
        return ClosedFormFooting("no_driving_force", None, normal, 0.0, resisting)
    return ClosedFormFooting("slides", resisting / driving, normal, driving, resisting)
