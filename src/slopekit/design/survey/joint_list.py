"""Measured joints, lists of them with where they come from, and what is said of rows that hold none."""

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
    """One measured joint: its name, its plane, the line of the file it stands in, strength and set where given.

    The declared fields are columns of joint lists.

    quantity : how many like it were measured, or its weight against the bias of a scanline
    spacing_m, position_m, trace_m : to the next of its set, along the scanline, of its trace, where they were asked for
    ends : of its trace that were seen, 0 to 2
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
    quantity: float = number("quantity", "ratio", default=1.0, least=0.0, code="E193", says="it is a number from 0")
    spacing_m: float | None = number("spacing", "length", default=None, above=0.0, code="E193", advice=_EMPTY)
    position_m: float | None = number("position", "length", default=None, code="E193")
    trace_m: float | None = number("trace", "length", default=None, above=0.0, code="E193", advice=_EMPTY)
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
    """Joints with where they come from.

    Attributes
    ----------
    name : of the file, or `joints`; left_out : rows and columns that are not used, in words
    read_as : what was read in another way than it stands there, in words
    shared_names : that stand more than once in the list, so that they name no joint
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
        """(n,) dips."""
        return np.array([joint.plane.dip_deg for joint in self.joints])

    @property
    def dip_directions_deg(self) -> Floats:
        """(n,) dip directions."""
        return np.array([joint.plane.dip_direction_deg for joint in self.joints])

    @property
    def quantities(self) -> Floats:
        """(n,) how often each counts."""
        return np.array([joint.quantity for joint in self.joints])

    @property
    def has_quantities(self) -> bool:
        """Whether any joint counts for more, or less, than one."""
        return any(joint.quantity != 1.0 for joint in self.joints)

    def normals(self) -> Floats:
        """(n, 3) upward unit normals."""
        return normals(self.dips_deg, self.dip_directions_deg)

    def pairs(self) -> tuple[np.ndarray[Any, np.dtype[np.intp]], np.ndarray[Any, np.dtype[np.intp]]]:
        """The first and second joint of every pair, in the order of the list."""
        return np.triu_indices(len(self), 1)

    def rows(self) -> list[tuple[str, str, float, float]]:
        """Name, set, dip and dip direction of each joint, for hashes."""
        return [
            (joint.name, joint.set_name, joint.plane.dip_deg, joint.plane.dip_direction_deg) for joint in self.joints
        ]

    def sets(self) -> tuple[str, ...]:
        """The sets that are named, sorted."""
        return tuple(sorted({joint.set_name for joint in self.joints if joint.set_name}))


# -- bad rows: those of one kind once, with their number and the first three -----------------------------------------

#: The number of a row, what its joint is called, and what is wrong with it.
BadRow: TypeAlias = tuple[int, str, Sequence[Fault]]
_SHOWN = 3
_VALUE = re.compile(r"'[^']*'|\"[^\"]*\"|[+-]?\d+(?:[.,]\d+)?")


def grouped_faults(rows: Sequence[BadRow]) -> list[Fault]:
    """The faults of bad rows, those of one kind as one where more than three rows have it.

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
    for alike in kinds.values():
        if len(alike) > _SHOWN:
            first, places = alike[0], "; ".join(fault.where for fault in alike[:_SHOWN])
            message = f"{first.message}, and {len(alike) - 1} rows more like it"
            alike = [Fault(first.code, message, places, first.advice)]
        grouped += alike
    return grouped


def skipped_rows(noun: str, rows: Sequence[BadRow]) -> list[str]:
    """Bad rows that are left out, in words: those with the same faults together where they are more than three.

    >>> skipped_rows("line", [(4, "C", [Fault("E101", "dip of C is 200")])])
    ['line 4 (E101 dip of C is 200)']
    """
    kinds: dict[tuple[tuple[str, str], ...], list[BadRow]] = {}
    for row in rows:
        kinds.setdefault(tuple(_kind(fault, row[1]) for fault in row[2]), []).append(row)
    parts: list[tuple[int, str]] = []
    for alike in kinds.values():
        together = len(alike) > _SHOWN
        for line, _, faults in alike[:1] if together else alike:
            lines = f"{noun} {line}"
            if together:
                first = ", ".join(str(row[0]) for row in alike[:_SHOWN])
                lines = f"{noun}s {first} and {len(alike) - _SHOWN} more"
            what = "; ".join(f"{fault.code} {fault.message}" for fault in faults)
            parts.append((line, f"{lines} ({what})"))
    return [text for _, text in sorted(parts)]


def _kind(fault: Fault, name: str) -> tuple[str, str]:
    """What faults of one kind have in common: the code, and the message without names and values."""
    return fault.code, _VALUE.sub("#", re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", "@", fault.message))
