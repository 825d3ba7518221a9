"""Water that stands so many metres deep in the tension crack of a wedge, as a plane failure has it.

In the crack it is still water. On a joint the pressure falls from the wet edge that it shares with the crack to nothing
on its other edges, linearly over the triangles from the lower end of that edge: uplift of a plane failure, and of a
full crack whose upper edge is level Hoek & Bray's pyramids (mean γ_w h₅/3 on all three; 1981, ch. 8).
"""

from collections.abc import Sequence

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import Fault, MisfitError
from slopekit.geometry.pressure import Pressure, fan
from slopekit.geometry.rock.cutting import Block
from slopekit.kinds.single_block.ground_water import outward_of
from slopekit.loads import PointForce

_ON = 1e-9  # of the size of the block: a corner this near to a plane lies on it
_BRIM = 1e-9  # of the depth of the crack: water that stands no higher does not run out


def pushes(block: Block, joints: Sequence[int], crack: int, depth: float, unit_weight: float) -> dict[str, PointForce]:
    """What the water does to the block, by the names that loads have for it: `water 0`.

    Parameters
    ----------
    joints : faces that the water runs into; crack : the one that it stands in
    depth : over the lowest point of the crack, m; unit_weight : of the water, kN/m³

    Raises
    ------
    GeometryError
        E207 the crack is not so deep, E456 a joint has a corner inside the rock away from the crack, or the crack has
        no edge on the slope.
    """
    if not depth:
        return {}
    polygon = block.faces[crack]
    size = float(np.ptp(block.corners, axis=0).max())
    free = np.array([
        any(_on(block.faces[other], corner, size) for other in block.faces if other not in (*joints, crack))
        for corner in polygon
    ])  # fmt: skip
    if not free.any():
        message = "the crack ends inside the rock, below the slope: how high water stands in it is not told"
        raise MisfitError([Fault("E456", message, "", "Give the mean pressures: water: {pressures: ...}.")])
    lowest = float(polygon[:, 2].min())
    holds = float(polygon[free, 2].min()) - lowest
    if depth > holds * (1.0 + _BRIM):
        message = f"the water stands {depth:.6g} m deep in a crack that holds {holds:.6g} m"
        raise MisfitError([Fault("E207", message, "", "Give at most its depth where its upper edge is lowest.")])
    level = lowest + depth
    thrust, at = Pressure((), level, unit_weight).on(polygon)
    loads = {f"water {crack}": PointForce(-thrust * outward_of(polygon), at)}
    for joint in joints:
        push = _on_joint(block, joint, joints, crack, level, unit_weight, size)
        if push is not None:
            loads[f"water {joint}"] = push
    return loads


def _on_joint(
    block: Block, joint: int, joints: Sequence[int], crack: int, level: float, unit_weight: float, size: float
) -> PointForce | None:
    """The push on one joint, None where its edge at the crack is dry."""
    polygon = block.faces[joint]
    at_crack = np.array([_on(block.faces[crack], corner, size) for corner in polygon])
    inside = [
        not any(_on(block.faces[other], corner, size) for other in block.faces if other not in joints)
        for corner in polygon
    ]
    if any(inside):
        message = "the joints meet inside the rock, away from the crack: how high its water stands there is not told"
        raise MisfitError([Fault("E456", message, "", "Give the mean pressures: water: {pressures: ...}.")])
    heads = np.where(at_crack, level - polygon[:, 2], 0.0)
    if at_crack.sum() != 2 or float(heads.max()) <= 0.0:
        return None
    low, high = sorted(np.flatnonzero(at_crack).tolist(), key=lambda k: float(polygon[k, 2]))
    if heads[high] < 0.0:  # the water ends on the edge: above it the joint is dry
        share = heads[low] / (heads[low] - heads[high])
        polygon, heads = polygon.copy(), heads.copy()
        polygon[high], heads[high] = polygon[low] + share * (polygon[high] - polygon[low]), 0.0
    thrust, moment = fan(np.roll(polygon, -low, axis=0), unit_weight * np.roll(heads, -low))
    return PointForce(-thrust * outward_of(block.faces[joint]), moment / thrust) if thrust > 0.0 else None


def _on(polygon: Floats, corner: Floats, size: float) -> bool:
    """Whether a point lies on the plane of a face of the block."""
    return abs(float((corner - polygon[0]) @ outward_of(polygon))) <= _ON * size
