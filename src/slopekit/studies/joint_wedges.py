"""PRE-IE of wedges on pairs of joints of a survey, many at once."""

from dataclasses import replace
from typing import Any

from slopekit.core.arrays import Floats, Ints
from slopekit.core.orientation import Plane
from slopekit.design.joint_lists import JointList
from slopekit.design.parts import Strength
from slopekit.kinds.single_block.blocks_on_arrays import LimitsOfMany, limits_on_arrays
from slopekit.kinds.wedge import ON_ARRAYS
from slopekit.kinds.wedge.design import WedgeDesign


def limits_of_wedges(
    slope: WedgeDesign, joints: JointList, strengths: tuple[Floats, Floats], first: Ints, second: Ints, height: Floats
) -> LimitsOfMany:
    """Return PRE-IE's limits of wedges that all form.

    Parameters
    ----------
    slope : whose joints and height mean nothing; strengths : cohesion and friction of the joints of the list
    first, second : (m,) joints by their numbers; height : (m,) m at the trace of the first
    """
    planes: list[Any] = [(joints.dips_deg[joint], joints.dip_directions_deg[joint]) for joint in (first, second)]
    own: list[Any] = [tuple(of[joint] for of in strengths) for joint in (first, second)]
    high: Any = height
    design = replace(slope, joints=(Plane(*planes[0]), Plane(*planes[1])), height_m=high)
    return limits_on_arrays(design, ON_ARRAYS, [Strength(*one) for one in own], len(first))
