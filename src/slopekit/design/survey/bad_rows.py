"""What is said of bad rows: faults of one kind once, with their number and the first three rows."""

import re
from collections.abc import Sequence
from typing import TypeAlias

from slopekit.core.errors import Fault

#: The number of a row, and what is wrong with it.
BadRow: TypeAlias = tuple[int, Sequence[Fault]]
_SHOWN = 3
_VALUE = re.compile(r"'[^']*'|\"[^\"]*\"|[+-]?\d+(?:[.,]\d+)?")


def grouped_faults(rows: Sequence[BadRow], names: Sequence[str]) -> list[Fault]:
    """The faults of bad rows, those of one kind as one where more than three rows have it.

    Parameters
    ----------
    names : what the joint of each row is called: messages differ by it and by their numbers

    >>> rows = [(k, [Fault("E101", f"dip of J{k} is 200", f"joints.csv:{k}  200,1")]) for k in range(2, 8)]
    >>> print(grouped_faults(rows, [f"J{k}" for k in range(2, 8)])[0])
    E101 dip of J2 is 200, and 5 rows more like it
         joints.csv:2  200,1; joints.csv:3  200,1; joints.csv:4  200,1
    """
    kinds: dict[tuple[str, str], list[Fault]] = {}
    for (_, faults), name in zip(rows, names, strict=True):
        for fault in faults:
            kinds.setdefault(_kind(fault, name), []).append(fault)
    return [fault for faults in kinds.values() for fault in _as_one(faults)]


def skipped_rows(noun: str, rows: Sequence[BadRow], names: Sequence[str]) -> list[str]:
    """Bad rows that are left out, in words: those with the same faults together where they are more than three.

    >>> skipped_rows("line", [(4, [Fault("E101", "dip of C is 200")])], ["C"])
    ['line 4 (E101 dip of C is 200)']
    """
    kinds: dict[tuple[tuple[str, str], ...], list[BadRow]] = {}
    for row, name in zip(rows, names, strict=True):
        kinds.setdefault(tuple(_kind(fault, name) for fault in row[1]), []).append(row)
    parts: list[tuple[int, str]] = []
    for alike in kinds.values():
        together = len(alike) > _SHOWN
        for line, faults in alike[:1] if together else alike:
            what = "; ".join(f"{fault.code} {fault.message}" for fault in faults)
            lines = f"{noun} {line}"
            if together:
                first = ", ".join(str(row[0]) for row in alike[:_SHOWN])
                lines = f"{noun}s {first} and {len(alike) - _SHOWN} more"
            parts.append((line, f"{lines} ({what})"))
    return [text for _, text in sorted(parts)]


def _kind(fault: Fault, name: str) -> tuple[str, str]:
    """What faults of one kind have in common: the code, and the message without names and values."""
    return fault.code, _VALUE.sub("#", re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", "@", fault.message))


def _as_one(faults: Sequence[Fault]) -> list[Fault]:
    if len(faults) <= _SHOWN:
        return list(faults)
    first = faults[0]
    message = f"{first.message}, and {len(faults) - 1} rows more like it"
    return [Fault(first.code, message, "; ".join(fault.where for fault in faults[:_SHOWN]), first.advice)]
