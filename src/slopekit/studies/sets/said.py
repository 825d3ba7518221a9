"""What a reader must know of the sets that were found."""

import math

from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.core.sheet import counted
from slopekit.studies.sets.run import JointSets, is_close, too_few


def notices_of(found: JointSets, ignored: bool) -> list[Notice]:
    """W400 to W409, those that apply."""
    said: list[Notice] = []
    joints, sets = found.joints, found.sets
    if not found.are_given:
        said += _of_number(found)
    elif found.asked is not None:
        message = f"the sets are those of the column set of {joints.name}: --sets {found.asked} is not used"
        said.append(Notice("W405", f"{message}; --ignore-sets finds them anew"))
    if ignored and joints.sets():
        said.append(Notice("W405", f"the column set of {joints.name} is left out, as asked"))
    if sets and found.without_set:
        alone = counted(len(found.without_set), "joint")
        said.append(Notice("W400", f"{alone} of {len(joints)} {_is(found)} of no set, and in no mean and no K"))
    few = [one for one in sets if too_few(one)]
    if few:
        names = ", ".join(f"{one.name} ({len(one.members)})" for one in few)
        said.append(Notice("W401", f"few joints: {names}; K and its cones are those of these few"))
    if found.capped:
        most = 1.0 / math.sin(math.radians(found.bias_angle_deg))
        message = (
            f"{counted(found.capped, 'joint')} within {number(found.bias_angle_deg)}° of the scanline "
            f"{'weighs' if found.capped == 1 else 'weigh'} {most:.2f}, no more: a line says little of joints along it"
        )
        said.append(Notice("W402", message))
    odd = [one.name for one in sets if one.axes.is_elongated]
    if odd:
        message = f"the poles of {', '.join(odd)} scatter more one way than the other: Fisher's K is a mean of the two"
        said.append(Notice("W403", f"{message}, dip and dip direction by themselves say more"))
    if found.scanline is None and any(joint.position_m is not None for joint in joints.joints):
        message = f"positions of {joints.name} give no spacing without the scanline: --scanline TREND/PLUNGE"
        said.append(Notice("W406", message))
    if found.scanline is not None and joints.has_quantities:
        message = f"quantities of {joints.name} count besides the weights of the scanline: leave one of them out"
        said.append(Notice("W407", f"{message} if the quantities are such weights already"))
    return said


def _of_number(found: JointSets) -> list[Notice]:
    if found.girdle is not None:
        message = f"the poles lie along one great circle, about {found.girdle[0]}, as those of folded beds do"
        return [Notice("W409", f"{message}: sets are pieces of it; divide the survey into domains first")]
    if found.asked is None:
        by = {len(one): one.bic for one in found.tried}
        chosen = min(by, key=lambda count: by[count])
        if chosen == 0:
            message = f"the {counted(len(found.joints), 'joint')} of {found.joints.name} show no sets: no number of"
            return [Notice("W408", f"{message} sets is likelier than joints that lie anywhere; --sets N divides them")]
        if near := is_close(by, chosen):
            others = " or ".join(map(str, near))
            message = f"{counted(chosen, 'set')} or {others}: the joints hardly tell which (BIC within 6)"
            return [Notice("W404", f"{message}; look at the stereonet, --sets N takes another number")]
    elif len(found.sets) < found.asked:
        message = f"{found.asked} sets were asked for, {len(found.sets)} hold joints that are likelier theirs than not"
        return [Notice("W408", message)]
    return []


def _is(found: JointSets) -> str:
    return "is" if len(found.without_set) == 1 else "are"
