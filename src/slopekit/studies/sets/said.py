"""What a reader must know of the sets that were found."""

import math

from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.core.sheet import counted
from slopekit.studies.sets.run import JointSets

_FEW = 10  # joints of a set below which its K says little
_CLOSE = 6.0  # difference of BIC up to which two numbers of sets are hard to tell apart (Kass & Raftery 1995: strong)


def notices_of(joint_sets: JointSets) -> list[Notice]:
    """Return those of W401, W402 and W404 that apply."""
    said: list[Notice] = []
    joints, sets = joint_sets.joints, joint_sets.sets
    if not joint_sets.are_given:
        said += _of_number(joint_sets)
    elif joint_sets.asked is not None:
        message = f"the sets are those of the column set of {joints.name}: --sets {joint_sets.asked} is not used"
        said.append(Notice("W404", f"{message}; --ignore-sets finds them anew"))
    few = [one for one in sets if len(one.members) < _FEW]
    if few:
        names = ", ".join(f"{one.name} ({len(one.members)})" for one in few)
        said.append(Notice("W401", f"few joints: {names}; K and its cones are those of these few"))
    if joint_sets.capped:
        most = 1.0 / math.sin(math.radians(joint_sets.bias_angle_deg))
        message = (
            f"{counted(joint_sets.capped, 'joint')} within {number(joint_sets.bias_angle_deg)}° of the scanline "
            f"{'weighs' if joint_sets.capped == 1 else 'weigh'} {most:.2f}, no more: "
            "a line says little of joints along it"
        )
        said.append(Notice("W402", message))
    odd = [one.name for one in sets if one.axes.is_elongated]
    if odd:
        message = f"the poles of {', '.join(odd)} scatter more one way than the other: Fisher's K is a mean of the two"
        said.append(Notice("W401", f"{message}, dip and dip direction by themselves say more"))
    if joint_sets.scanline is None and any(joint.position_m is not None for joint in joints.joints):
        message = f"positions of {joints.name} give no spacing without the scanline: --scanline TREND/PLUNGE"
        said.append(Notice("W402", message))
    if joint_sets.scanline is not None and joints.has_quantities:
        message = f"quantities of {joints.name} count besides the weights of the scanline: leave one of them out"
        said.append(Notice("W402", f"{message} if the quantities are such weights already"))
    return said


def _of_number(joint_sets: JointSets) -> list[Notice]:
    if joint_sets.asked is None:
        by = {len(one): one.bic for one in joint_sets.tried}
        chosen = min(by, key=lambda count: by[count])
        if chosen == 0:
            message = f"no sets among the {counted(len(joint_sets.joints), 'joint')} of {joint_sets.joints.name}"
            likelier = "no number of sets is likelier than uniform directions; --sets N divides them"
            return [Notice("W404", f"{message}: {likelier}")]
        near = [count for count, bic in by.items() if count != chosen and bic - by[chosen] < _CLOSE]
        if near:
            others = " or ".join(map(str, near))
            message = f"{counted(chosen, 'set')} or {others}: the joints hardly tell which (BIC within 6)"
            return [Notice("W404", f"{message}; look at the stereonet, --sets N takes another number")]
    return []
