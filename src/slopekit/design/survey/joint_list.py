"""Measured joints, joint lists with their origin, and messages about bad rows."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import Fault
from slopekit.core.orientation import Plane, normals
from slopekit.design.fields import count, in_degrees, number

_EMPTY = "Leave the cell empty."


@dataclass(frozen=True)
class MeasuredJoint:
    """A measured joint: its name, plane, line in the file, and strength and set where the list has them.

    The declared fields are columns of joint lists.

    quantity : number of such joints, or a weight that corrects the bias of a scanline
    spacing_m, position_m, trace_m : spacing in its set, position along the scanline and trace length, if requested
    ends : number of visible ends of its trace, 0 to 2
    """

    name: str
    plane: Plane
    line: int
    cohesion_kpa: float | None = number(
        "c", "pressure", default=None, least=0.0, code="E114", says="cohesion is never negative"
    )
    friction_angle_deg: float | None = number(
        "phi",
        "angle",
        default=None,
        least=0.0,
        below=90.0,
        code="E115",
        check=in_degrees,
        says="a friction angle lies from 0 to below 90",
    )
    set_name: str = ""
    quantity: float = number(
        "quantity", "ratio", default=1.0, least=0.0, code="E193", says="it is a number from 0"
    )
    spacing_m: float | None = number(
        "spacing", "length", default=None, above=0.0, code="E193", advice=_EMPTY
    )
    position_m: float | None = number("position", "length", default=None, code="E193")
    trace_m: float | None = number(
        "trace", "length", default=None, above=0.0, code="E193", advice=_EMPTY
    )
    ends: int | None = count(
        "ends",
        0,
        2,
        default=None,
        code="E193",
        says="of a trace 0, 1 or 2 ends are seen",
        advice="Leave the cell empty where it is not known.",
    )


@dataclass(frozen=True)
class JointList:
    """A list of measured joints with its origin.

    Attributes
    ----------
    name : name of the file, or `joints`
    left_out : unused rows and columns, in words
    read_as : values that were interpreted in another way than they are written, in words
    shared_names : names of more than one joint, which cannot identify a joint
    """

    name: str
    joints: tuple[MeasuredJoint, ...]
    left_out: tuple[str, ...] = ()
    read_as: tuple[str, ...] = ()
    shared_names: frozenset[str] = frozenset()

    def __len__(self) -> int:
        return len(self.joints)

    @property
    def dips_deg(self) -> Floats:
        """The dips, (n,), in degrees."""
        return np.array([joint.plane.dip_deg for joint in self.joints])

    @property
    def dip_directions_deg(self) -> Floats:
        """The dip directions, (n,), in degrees."""
        return np.array([joint.plane.dip_direction_deg for joint in self.joints])

    @property
    def quantities(self) -> Floats:
        """The quantities of the joints, (n,): how often each counts."""
        return np.array([joint.quantity for joint in self.joints])

    @property
    def has_quantities(self) -> bool:
        """Whether any joint has a quantity other than 1."""
        return any(joint.quantity != 1.0 for joint in self.joints)

    def normals(self) -> Floats:
        """Return the upward unit normals of the joints, (n, 3)."""
        return normals(self.dips_deg, self.dip_directions_deg)

    def pairs(
        self,
    ) -> tuple[np.ndarray[Any, np.dtype[np.intp]], np.ndarray[Any, np.dtype[np.intp]]]:
        """Return the indices of the first and of the second joint of every pair, in the order of the list."""
        return np.triu_indices(len(self), 1)

    def rows(self) -> list[tuple[str, str, float, float]]:
        """Return name, set, dip and dip direction of each joint, for hashes."""
        return [
            (joint.name, joint.set_name, joint.plane.dip_deg, joint.plane.dip_direction_deg)
            for joint in self.joints
        ]

    def sets(self) -> tuple[str, ...]:
        """Return the names of the sets, sorted."""
        return tuple(sorted({joint.set_name for joint in self.joints if joint.set_name}))


# -- bad rows, grouped by kind of fault -------------------------------------------------------------------------------

#: The number of a row, the name of its joint, and its faults.
BadRow: TypeAlias = tuple[int, str, Sequence[Fault]]
_MAX_EXAMPLES = 3
_VALUE = re.compile(r"'[^']*'|\"[^\"]*\"|[+-]?\d+(?:[.,]\d+)?")


def grouped_faults(rows: Sequence[BadRow]) -> list[Fault]:
    """Return the faults of bad rows; a kind of fault in more than three rows becomes one fault.

    >>> rows = [(k, f"J{k}", [Fault("E101", f"dip of J{k} is 200", f"joints.csv:{k}  200,1")]) for k in range(2, 8)]
    >>> print(grouped_faults(rows)[0])
    E101 dip of J2 is 200, and 5 rows more like it
         joints.csv:2  200,1; joints.csv:3  200,1; joints.csv:4  200,1
    """
    kinds: dict[tuple[str, str], list[Fault]] = {}
    for _, name, faults in rows:
        for fault in faults:
            kinds.setdefault(_kind(fault, name), []).append(fault)
    grouped: list[Fault] = []
    for kind_faults in kinds.values():
        if len(kind_faults) > _MAX_EXAMPLES:
            first, places = (
                kind_faults[0],
                "; ".join(fault.where for fault in kind_faults[:_MAX_EXAMPLES]),
            )
            message = f"{first.message}, and {len(kind_faults) - 1} rows more like it"
            kind_faults = [Fault(first.code, message, places, first.advice)]
        grouped += kind_faults
    return grouped


def skipped_rows(noun: str, rows: Sequence[BadRow]) -> list[str]:
    """Return the skipped bad rows in words; more than three rows with the same faults become one entry.

    >>> skipped_rows("line", [(4, "C", [Fault("E101", "dip of C is 200")])])
    ['line 4 (E101 dip of C is 200)']
    """
    kinds: dict[tuple[tuple[str, str], ...], list[BadRow]] = {}
    for row in rows:
        kinds.setdefault(tuple(_kind(fault, row[1]) for fault in row[2]), []).append(row)
    entries: list[tuple[int, str]] = []
    for kind_rows in kinds.values():
        are_grouped = len(kind_rows) > _MAX_EXAMPLES
        for line, _, faults in kind_rows[:1] if are_grouped else kind_rows:
            lines = f"{noun} {line}"
            if are_grouped:
                first = ", ".join(str(row[0]) for row in kind_rows[:_MAX_EXAMPLES])
                lines = f"{noun}s {first} and {len(kind_rows) - _MAX_EXAMPLES} more"
            faults_text = "; ".join(f"{fault.code} {fault.message}" for fault in faults)
            entries.append((line, f"{lines} ({faults_text})"))
    return [text for _, text in sorted(entries)]


def _kind(fault: Fault, name: str) -> tuple[str, str]:
    """Return the kind of a fault: its code, and its message without names and values."""
    return fault.code, _VALUE.sub(
        "#", re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", "@", fault.message)
    )
