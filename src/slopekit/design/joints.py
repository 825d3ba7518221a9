"""The joints of a wedge or a plane failure: from the design itself or from a joint list, with their strengths."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane
from slopekit.design.fields import count, declare, keys_of
from slopekit.design.parts import Strength
from slopekit.design.reading.nodes import NOTHING, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import VALUE, Spec
from slopekit.design.sections import read_strength, standard_strength, strength_names

#: A joint list in place of joints.
FROM_CSV = Spec(
    keys={
        "csv": Spec("value", example="joints.csv"),
        "pick": Spec("value", items=VALUE, at_least=1),
        "convention": VALUE,
        "columns": Spec("value", items=VALUE, at_least=1),
        "strength": VALUE,
    },
    required=("csv",),
)


_NEEDED = {1: "one joint", 2: "two joints"}
#: A joint by its name: its plane, and the strength it names.
_JOINT = keys_of(
    "Joint",
    declare("plane", "plane", is_required=True, example="45/115"),
    declare("strength", "text", left_out="the only one", doc="a name under strength"),
)

JOINTS = declare(
    "joints", "group", of=_JOINT, many="names", at_least=1, forms=(FROM_CSV,), is_required=True,
    example="{J1: {plane: 45/115}}", doc="by name (a wedge two, a plane one), or a [list](#joint-lists)",
)  # fmt: skip


def refinements() -> Any:
    """How often the triangles of the joints are split to begin with."""
    return count("analysis.refine", 0, 6, default=0, code="E137", advice="Each step makes four triangles of one.")


@dataclass(frozen=True)
class GivenJoint:
    """A joint as a design has it.

    Attributes
    ----------
    plane : None where it is wrong, or not given
    strength : node of its `strength` key; at : its own node
    listed : c and φ of a joint list, where that has such columns: None in a cell that is empty
    """

    name: str
    plane: Plane | None
    strength: Node
    at: Node
    listed: Mapping[str, float | None]


def joints_of(reader: Reader, count: int) -> list[GivenJoint]:
    """The joints of a design of one block: as many as its kind takes, else none.

    Faults: E109 another number of joints, E197 no such joint in the list, and those of the planes.
    """
    node = reader.at("joints")
    if not node.is_mapping:
        return []
    if node.get("csv"):
        return _from_csv(reader, node, count)
    entries = reader.names("joints")
    if count not in (len(entries), len(node.items())):
        third = count == 2 and len(node.items()) == 3
        advice = "A third joint under the block stands by itself: basal: {plane: 20/180, height: 4 m}." if third else ""
        message = f"a {reader.kind} has {_NEEDED[count]}, {len(node.items())} are given"
        reader.fault("E109", message, node, advice)
    joints = []
    for name, below in entries if len(entries) == count else ():
        plane = below.get("plane")
        orientation = None if plane.value is None else reader.plane(plane, name)
        joints.append(GivenJoint(name, orientation, below.get("strength"), below, {}))
    return joints


def _from_csv(reader: Reader, node: Node, count: int) -> list[GivenJoint]:
    from slopekit.design.reading.named_files import beside
    from slopekit.design.survey import read_joints

    file, pick, convention, order = (node.get(key) for key in ("csv", "pick", "convention", "columns"))
    try:
        survey = read_joints(
            beside(reader, file),
            convention.text,
            columns=order.text or [item.text or "" for item in order.elements] if order else None,
        )
    except DesignError as error:
        # a list that cannot be opened, or a convention that is none, is a slip in the design; a bad row is the list's
        slips = dict.fromkeys(("E147", "E148", "E149"), file) | ({"E192": convention} if convention else {})
        for fault in error.faults:
            at = slips.get(fault.code)
            reader.faults.append(fault if at is None else replace(fault, where=str(at.place)))
        return []
    reader.left_out += [f"{part} of {file.text}" for part in survey.left_out]
    if survey.has_quantities:
        reader.left_out.append(f"quantities of {file.text}")
    reader.read_as += [f"{file.text}: {part}" for part in survey.read_as]
    names = [joint.name for joint in survey.joints]
    wanted = [item.text or "" for item in (pick.elements or (pick,))] if pick else names
    shared = [name for name in wanted if pick and name in survey.shared_names]
    for name in shared:
        advice = "Give each joint a name of its own, in a column called name or id."
        reader.fault("E151", f"{name} names more than one joint of {file.text}", pick, advice)
    missing = [name for name in wanted if name not in names and name not in shared]
    for name in missing:
        reader.fault("E197", f"{file.text} has no joint {name}", pick, reader.nearest(name, names))
    if missing or shared:
        return []
    if len(wanted) != count:
        message = f"a {reader.kind} takes {_NEEDED[count]}, {len(wanted)} come from {file.text}"
        reader.fault("E109", message, pick or file, f"Add pick: [{', '.join(names[:count])}].")
        return []
    chosen = [survey.joints[names.index(name)] for name in wanted]
    columns = {"c": [joint.cohesion_kpa for joint in chosen], "phi": [joint.friction_angle_deg for joint in chosen]}
    measured = [key for key, values in columns.items() if any(value is not None for value in values)]
    return [
        GivenJoint(joint.name, joint.plane, node.get("strength"), file, {key: columns[key][k] for key in measured})
        for k, joint in enumerate(chosen)
    ]


def strengths_of(reader: Reader, joints: Sequence[GivenJoint]) -> list[Strength | None]:
    """The strength of each joint: columns of a joint list where they are filled, else those of the design."""
    names = strength_names(reader, [(joint.name, joint.strength, joint.at) for joint in joints])
    in_design = reader.at("strength")
    of_design = [NOTHING if name is None else in_design.get(name) for name in names]
    measured = {key for joint in joints for key in joint.listed}
    standard = standard_strength(reader, [own for own in of_design if own], beside=measured)
    strengths: list[Strength | None] = []
    for joint, name, own in zip(joints, names, of_design, strict=True):
        if name is None and in_design and not joint.listed:
            strengths.append(None)
            continue
        listed = {key: value for key, value in joint.listed.items() if value is not None}
        for key in joint.listed:
            given = own.get(key)
            if key in listed and given:
                reader.left_out.append(f"{key} of the design for {joint.name}: {joint.at.text} has its own")
            elif key not in listed and not given:
                advice = f"Fill in the column {key}, or give a strength in the design."
                reader.fault("E143", f"{key} of {joint.name} is missing in {joint.at.text}", joint.at, advice)
        strengths.append(read_strength(reader, own, name or joint.name, standard, listed, joint.at))
    return strengths
