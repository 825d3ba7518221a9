"""Joint lists for studies of a survey: from a file, a data frame or planes in Python, with all faults at once."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault, Faults
from slopekit.core.orientation import Plane, parse_face, parse_plane
from slopekit.design.reading.nodes import fail
from slopekit.design.survey import JointList as JointList
from slopekit.design.survey import MeasuredJoint, read_frame, read_joints
from slopekit.design.survey.columns import checked_convention
from slopekit.design.survey.joint_list import BadRow, grouped_faults
from slopekit.design.survey.tables import is_frame

_SOURCE_ADVICE = 'Give "joints.csv" or ["45/115", "45/245"].'
MOST_JOINTS = 3000  # 4.5 million pairs


def joint_list(
    source: Any,
    convention: str | None = None,
    skip_bad: bool = False,
    at_least: int = 1,
    option: str = "convention =",
    sizes: bool = False,
    most: int = MOST_JOINTS,
    columns: str | Sequence[str] | None = None,
) -> JointList:
    """Return the joints of a survey.

    Parameters
    ----------
    source : path of a file, see `read_joints`; a frame of pandas or polars with such columns; or planes ("45/115",
        (45, 115), `Plane`, `MeasuredJoint`), an (n, 2) array, or {name: plane}
    convention : of a strike column, see `read_joints`
    skip_bad : whether to skip bad rows of a file and list them
    option : the name of `convention` in messages
    at_least, most : smallest and largest number of joints for the study
    sizes, columns : see `read_joints`

    Raises
    ------
    DesignError
        As `read_joints` for a file; E101 to E105 for planes, E125 too many, E190 too few, E405 no joints at all.

    >>> joint_list(["45/115", (45, 245)]).joints[1].plane
    Plane(dip_deg=45.0, dip_direction_deg=245.0)
    """
    if convention is not None:
        checked_convention(convention, option)
    if isinstance(source, str | os.PathLike):
        joints = read_joints(source, convention, skip_bad, option, sizes, columns)
    elif is_frame(source):
        joints = read_frame(source, convention, skip_bad, option, sizes, columns)
    else:
        joints = JointList("joints", _from_python(source))
    if len(joints) < at_least:
        advice = "Every pair is looked at: two joints make the first."
        fail(
            "E190", f"{joints.name} holds {len(joints)} joint, two are needed", joints.name, advice
        )
    if len(joints) > most:
        pairs = f", {len(joints) * (len(joints) - 1) // 2:,} pairs" if most == MOST_JOINTS else ""
        message = f"{joints.name} holds {len(joints)} joints{pairs}: more than {most} joints are not taken"
        fail("E125", message, joints.name, "Take a domain of the slope, or a sample of each set.")
    return joints


def _from_python(source: Any) -> tuple[MeasuredJoint, ...]:
    values = source.tolist() if hasattr(source, "tolist") else source
    if isinstance(values, Mapping):
        named_planes = [(str(name), value) for name, value in values.items()]
    elif isinstance(values, Sequence):
        named_planes = [(f"J{k}", value) for k, value in enumerate(values, 1)]
    else:
        message = f"joints are {type(source).__name__}, a path, a frame, a list of planes or {{name: plane}} is needed"
        fail("E405", message, "joints", _SOURCE_ADVICE)
    faults, bad = Faults(), list[BadRow]()
    joints: list[MeasuredJoint] = []
    for line, (name, value) in enumerate(named_planes, 1):
        try:
            joint = (
                value
                if isinstance(value, MeasuredJoint)
                else MeasuredJoint(name, parse_plane(value, name), line)
            )
            joints.append(joint)
        except DesignError as error:
            bad.append((line, name, error.faults))
    faults += grouped_faults(bad)
    for name, times in Counter(joint.name for joint in joints).items():
        if times > 1:
            faults.append(Fault("E151", f"{name} is the name of {times} joints", "joints"))
    if not named_planes:
        faults.append(Fault("E405", "there are no joints", "joints", _SOURCE_ADVICE))
    faults.refuse()
    return tuple(joints)


def measured_or_common(
    joints: JointList, key: Literal["c", "phi"], common_value: float | None, option: str
) -> tuple[Floats, int, Fault | None]:
    """Return c (kPa) or φ (degrees) of every joint: measured values, else the common value.

    Returns
    -------
    (n,) values, the number of measured values, and fault E143 if joints have neither
    """
    column = [
        joint.cohesion_kpa if key == "c" else joint.friction_angle_deg for joint in joints.joints
    ]
    missing = [joint for joint, value in zip(joints.joints, column, strict=True) if value is None]
    values = np.array([np.nan if value is None else value for value in column])
    measured = len(column) - len(missing)
    if not missing or common_value is not None:
        return (
            np.where(np.isnan(values), np.nan if common_value is None else common_value, values),
            measured,
            None,
        )
    if measured == 0:
        return (
            values,
            0,
            Fault("E143", f"{key} is missing: {joints.name} has none", option, f"Give {option}."),
        )
    examples = ", ".join(f"{joint.name} (line {joint.line})" for joint in missing[:8])
    more = f" and {len(missing) - 8} more" if len(missing) > 8 else ""
    message = f"{key} is missing for {len(missing)} of {len(column)} joints: {examples}{more}"
    return (
        values,
        measured,
        Fault("E143", message, joints.name, f"Fill in the column {key}, or give {option}."),
    )


def slope_plane(value: object, name: str, option: str) -> Plane:
    """Return a plane of the slope; raise DesignError E143 where the option is missing."""
    if value is None:
        fail("E143", f"{option} is missing", option, f"Give {option} as dip/dip direction: 65/180.")
    return parse_face(value, name, f"{option} {value}")
