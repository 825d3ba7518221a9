"""What is said of bad rows: faults of one kind once, with their number and the first three rows."""

import re
from collections.abc import Sequence
from typing import TypeAlias

from slopekit.core.errors import Fault

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
