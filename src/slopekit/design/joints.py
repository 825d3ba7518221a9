"""Reading the joints of a wedge or a plane failure and their strengths, from the design or from a joint list."""

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
from slopekit.design.sections import default_strength_values, read_strength, strength_names

#: The form of `joints` that names a joint list.
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
#: The keys of one joint: its plane and the name of its strength.
_JOINT = keys_of(
    "Joint",
    declare("plane", "plane", is_required=True, example="45/115"),
    declare("strength", "text", left_out="the only one", doc="a name under strength"),
)

JOINTS = declare(
    "joints",
    "group",
    record_type=_JOINT,
    many="names",
    at_least=1,
    forms=(FROM_CSV,),
    is_required=True,
    example="{J1: {plane: 45/115}}",
    doc="by name (a wedge two, a plane one), or a [list](#joint-lists)",
)


def refinements() -> Any:
    """Declare the number of initial refinements of the joints' triangles."""
    return count(
        "analysis.refine",
        0,
        6,
        default=0,
        code="E137",
        advice="Each step makes four triangles of one.",
    )


@dataclass(frozen=True)
class JointEntry:
    """A joint as a design or a joint list gives it.

    Attributes
    ----------
    plane : None where it is missing or wrong
    strength : node of its `strength` key
    node : node of the joint, or of the joint list's file
    listed : c (kPa) and φ (degrees) by key, if the joint list has such columns; None for an empty cell
    """

    name: str
    plane: Plane | None
    strength: Node
    node: Node
    listed: Mapping[str, float | None]


def joints_of(reader: Reader, count: int) -> list[JointEntry]:
    """Read the joints of a single-block design; empty if there are not `count` of them.

    Faults: E109 another number of joints, E197 a joint missing in the list, and those of the planes.
    """
    node = reader.find("joints")
    if not node.is_mapping:
        return []
    if node.get("csv"):
        return _from_csv(reader, node, count)
    entries = reader.names("joints")
    if count not in (len(entries), len(node.items())):
        third = count == 2 and len(node.items()) == 3
        advice = (
            "A third joint under the block stands by itself: basal: {plane: 20/180, height: 4 m}."
            if third
            else ""
        )
        message = f"a {reader.kind} has {_NEEDED[count]}, {len(node.items())} are given"
        reader.fault("E109", message, node, advice)
    joints = []
    for name, below in entries if len(entries) == count else ():
        plane = below.get("plane")
        orientation = None if plane.value is None else reader.plane(plane, name)
        joints.append(JointEntry(name, orientation, below.get("strength"), below, {}))
    return joints


def _from_csv(reader: Reader, node: Node, count: int) -> list[JointEntry]:
    from slopekit.design.reading.named_files import path_of_named_file
    from slopekit.design.survey import read_joints

    file, pick, convention, order = (
        node.get(key) for key in ("csv", "pick", "convention", "columns")
    )
    try:
        survey = read_joints(
            path_of_named_file(reader, file),
            convention.text,
            columns=order.text or [item.text or "" for item in order.elements] if order else None,
        )
    except DesignError as error:
        # an unreadable list or an unknown convention is a fault at the design's key; a bad row is one of the list
        node_of_code = dict.fromkeys(("E147", "E148", "E149"), file) | (
            {"E192": convention} if convention else {}
        )
        for fault in error.faults:
            fault_node = node_of_code.get(fault.code)
            reader.faults.append(
                fault if fault_node is None else replace(fault, where=str(fault_node.place))
            )
        return []
    reader.left_out += [f"{content} of {file.text}" for content in survey.left_out]
    if survey.has_quantities:
        reader.left_out.append(f"quantities of {file.text}")
    reader.read_as += [f"{file.text}: {interpretation}" for interpretation in survey.read_as]
    names = [joint.name for joint in survey.joints]
    selected = [item.text or "" for item in (pick.elements or (pick,))] if pick else names
    shared = [name for name in selected if pick and name in survey.shared_names]
    for name in shared:
        advice = "Give each joint a name of its own, in a column called name or id."
        reader.fault("E151", f"{name} names more than one joint of {file.text}", pick, advice)
    missing = [name for name in selected if name not in names and name not in shared]
    for name in missing:
        reader.fault("E197", f"{file.text} has no joint {name}", pick, reader.nearest(name, names))
    if missing or shared:
        return []
    if len(selected) != count:
        message = f"a {reader.kind} takes {_NEEDED[count]}, {len(selected)} come from {file.text}"
        reader.fault("E109", message, pick or file, f"Add pick: [{', '.join(names[:count])}].")
        return []
    chosen = [survey.joints[names.index(name)] for name in selected]
    columns = {
        "c": [joint.cohesion_kpa for joint in chosen],
        "phi": [joint.friction_angle_deg for joint in chosen],
    }
    measured = [
        key for key, values in columns.items() if any(value is not None for value in values)
    ]
    return [
        JointEntry(
            joint.name,
            joint.plane,
            node.get("strength"),
            file,
            {key: columns[key][k] for key in measured},
        )
        for k, joint in enumerate(chosen)
    ]


def strengths_of(reader: Reader, joints: Sequence[JointEntry]) -> list[Strength | None]:
    """Read the strength of each joint: from the columns of a joint list where filled, else from the design."""
    names = strength_names(reader, [(joint.name, joint.strength, joint.node) for joint in joints])
    strengths_node = reader.find("strength")
    strength_nodes = [NOTHING if name is None else strengths_node.get(name) for name in names]
    measured = {key for joint in joints for key in joint.listed}
    defaults = default_strength_values(
        reader, [node for node in strength_nodes if node], measured_keys=measured
    )
    strengths: list[Strength | None] = []
    for joint, name, strength_node in zip(joints, names, strength_nodes, strict=True):
        if name is None and strengths_node and not joint.listed:
            strengths.append(None)
            continue
        listed = {key: value for key, value in joint.listed.items() if value is not None}
        for key in joint.listed:
            key_node = strength_node.get(key)
            if key in listed and key_node:
                reader.left_out.append(
                    f"{key} of the design for {joint.name}: {joint.node.text} has its own"
                )
            elif key not in listed and not key_node:
                advice = f"Fill in the column {key}, or give a strength in the design."
                reader.fault(
                    "E143",
                    f"{key} of {joint.name} is missing in {joint.node.text}",
                    joint.node,
                    advice,
                )
        strengths.append(
            read_strength(reader, strength_node, name or joint.name, defaults, listed, joint.node)
        )
    return strengths
