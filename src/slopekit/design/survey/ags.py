"""The discontinuities in an AGS 4 file, the exchange of site investigations in the UK, Hong Kong and Singapore.

A line is a row of quoted cells whose first says what the row is: GROUP, HEADING, UNIT, TYPE or DATA. Discontinuities
are the group DISC, one a row of DATA. Source: AGS, Electronic transfer of geotechnical and geoenvironmental data,
edition 4.1.1.
"""

import csv
import re
from collections.abc import Iterator, Sequence

from slopekit.core.degrees import decimal_degrees
from slopekit.core.errors import DesignError, Fault
from slopekit.design.survey.units_row import headings_with_units

_DIP, _DIP_DIRECTION = "DISC_DIP", "DISC_DIR"
_DESCRIPTORS = ("HEADING", "UNIT", "TYPE", "DATA")
_GROUP_NAME = re.compile(r"[A-Z][A-Z0-9]{3}")
_FLAT = re.compile(r"0+(\.0*)?")
_FEW = 8  # lines that are listed one by one


class AgsTable:
    """The group DISC as a `SurveyTable`: the row of its headings with their units, then its data."""

    noun, delimiter, comments = "line", ",", ()

    def __init__(self, name: str, lines: Sequence[str]) -> None:
        self.name, self.lines = name, lines
        self.rows: list[int] = []
        self.headings: list[str] = []
        self.left_out: list[str] = []
        self.read_as: list[str] = []
        self.cells_by_row: dict[int, list[str]] = {}

    def start(self, row: int, blanks: bool = False) -> None:
        """There is always a comma between the cells."""

    def cells(self, row: int) -> list[str]:
        return self.cells_by_row[row]

    def shown(self, row: int) -> str:
        return self.lines[row - 1]

    def add(self, row: int, cells: list[str]) -> None:
        """Append a row below the others."""
        self.rows.append(row)
        self.cells_by_row[row] = cells


def is_ags(lines: Sequence[str]) -> bool:
    """Whether lines are of AGS: the first names a group, as "GROUP","PROJ" does, or "**PROJ" of AGS 3."""
    first = next((line.lstrip() for line in lines if line.strip()), "")
    begins = first.startswith(('"**', '"GROUP"', "GROUP,"))
    return begins and (first.startswith('"**') or _group_of(_cells(first)) is not None)


def ags_table(name: str, lines: Sequence[str]) -> AgsTable:
    """The rows of the group DISC of a file.

    Rows without a dip or a dip direction are left out and listed: in core that is not oriented none is measured. A row
    that has lost its word DATA is taken for data.

    Raises
    ------
    DesignError
        E191 a file of AGS 3, no group DISC, two of them whose headings differ.
    """
    table, groups, group, bare = AgsTable(name, lines), dict[str, int](), "", 0
    for row, cells in _rows(lines):
        if cells[0].startswith("**"):
            _refuse(name, f"{name} is a file of AGS 3", row, "Save it as AGS 4.")
        named = _group_of(cells)
        if named is not None:
            group = named
            groups.setdefault(group, row)
        elif group == "DISC":
            bare += cells[0] not in _DESCRIPTORS
            _add(table, row, cells)
    if not table.rows:
        advice = f"Discontinuities stand in its group DISC; this file has {', '.join(groups)}."
        _refuse(name, f"{name} has no column for dip and dip direction", 1, advice)
    others = [other for other in groups if other != "DISC"]
    table.left_out += [f"group{'s' if len(others) > 1 else ''} {', '.join(others)}"] if others else []
    table.read_as += [f"{bare} rows of DISC without the word DATA are taken for data"] if bare else []
    _leave_out_unoriented(table)
    return table


def _add(table: AgsTable, row: int, cells: list[str]) -> None:
    """Add a row of DISC: its headings, which its units go into, and its data."""
    kind = cells[0]
    if kind == "HEADING" and not table.rows:
        table.headings = cells[1:]
        table.add(row, cells[1:])
    elif kind == "HEADING" and cells[1:] != table.headings:
        _refuse(table.name, f"{table.name} has two groups DISC whose headings differ", row, "Leave one of them out.")
    elif kind == "UNIT" and len(table.rows) == 1:
        table.cells_by_row[table.rows[0]] = headings_with_units(table.headings, cells[1:]) or table.headings
    elif table.rows and kind not in ("HEADING", "UNIT", "TYPE"):
        table.add(row, cells[1:] if kind == "DATA" else cells)


def _leave_out_unoriented(table: AgsTable) -> None:
    """Take out rows without an orientation; a flat joint has none to say but its dip."""
    headings = table.headings
    if _DIP not in headings or _DIP_DIRECTION not in headings:
        return
    dip, direction = headings.index(_DIP), headings.index(_DIP_DIRECTION)
    unoriented: dict[int, None] = {}
    for row in table.rows[1:]:
        cells = table.cells(row)
        cells += [""] * (len(headings) - len(cells))
        if not cells[direction] and _FLAT.fullmatch(cells[dip]):
            cells[direction] = "0"
        elif not cells[dip] or not cells[direction]:
            unoriented[row] = None
    table.rows = [row for row in table.rows if row not in unoriented]
    if unoriented:
        lines = ", ".join(map(str, list(unoriented)[:_FEW])) + (", ..." if len(unoriented) > _FEW else "")
        many = "s" if len(unoriented) > 1 else ""
        table.left_out.append(f"{len(unoriented)} row{many} without dip or dip direction (line{many} {lines})")


def _rows(lines: Sequence[str]) -> Iterator[tuple[int, list[str]]]:
    """The lines that are not empty, by their numbers, as cells; no cell goes on in the next line."""
    for row, line in enumerate(lines, 1):
        if line.strip():
            yield row, _cells(line)


def _cells(line: str) -> list[str]:
    try:
        fields = next(csv.reader([line], skipinitialspace=True))
    except csv.Error:  # a field longer than csv takes
        fields = line.split(",")
    return [decimal_degrees(field.strip()) for field in fields]


def _group_of(cells: Sequence[str]) -> str | None:
    named = len(cells) > 1 and cells[0] == "GROUP" and not any(cells[2:])
    return cells[1] if named and _GROUP_NAME.fullmatch(cells[1]) else None


def _refuse(name: str, message: str, row: int, advice: str) -> None:
    raise DesignError([Fault("E191", message, f"{name}:{row}", advice)])
