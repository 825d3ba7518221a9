"""Limits by PRE-IE of many wedges at once, each on a pair of joints of a survey."""

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
    slope: WedgeDesign,
    joints: JointList,
    strengths: tuple[Floats, Floats],
    first: Ints,
    second: Ints,
    height: Floats,
) -> LimitsOfMany:
    """Return the limits by PRE-IE of wedges on pairs of joints, all of which form.

    Parameters
    ----------
    slope : the design, with placeholders for joints and height
    strengths : cohesion (kPa) and friction angle (degrees) of all joints of the list
    first, second : (m,) joints by their numbers; height : (m,) m at the trace of the first
    """
    planes: list[Any] = [
        (joints.dips_deg[joint], joints.dip_directions_deg[joint]) for joint in (first, second)
    ]
    joint_strengths: list[Any] = [
        tuple(values[joint] for values in strengths) for joint in (first, second)
    ]
    high: Any = height
    design = replace(slope, joints=(Plane(*planes[0]), Plane(*planes[1])), height_m=high)
    return limits_on_arrays(
        design, ON_ARRAYS, [Strength(*strength) for strength in joint_strengths], len(first)
    )
