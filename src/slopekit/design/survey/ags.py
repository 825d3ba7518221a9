"""The discontinuities in an AGS 4 file, the exchange of site investigations in the UK, Hong Kong and Singapore.

A line is a row of quoted cells whose first says what the row is: GROUP, HEADING, UNIT, TYPE or DATA. Discontinuities
are the group DISC, one a row of DATA. Source: AGS, Electronic transfer of geotechnical and geoenvironmental data,
edition 4.1.1.
"""

import re
from collections.abc import Mapping, Sequence
from typing import NoReturn

from slopekit.design.reading.nodes import fail
from slopekit.design.survey.tables import SurveyTable, Text, headings_with_units, text_or_grid

_DIP, _DIP_DIRECTION = "DISC_DIP", "DISC_DIR"
_DESCRIPTORS = ("GROUP", "HEADING", "UNIT", "TYPE")
_GROUP_NAME = re.compile(r"[A-Z][A-Z0-9]{3}")
_FLAT = re.compile(r"0+(\.0*)?")
_FEW = 8  # lines that are listed one by one


def read_ags_table(name: str, content: bytes) -> SurveyTable:
    """The table in a file, known by how its content begins.

    Raises
    ------
    DesignError
        E140 a workbook without openpyxl, E159 neither a text nor a workbook, E191 AGS without discontinuities.
    """
    table = text_or_grid(name, content)
    return ags_table(table) if isinstance(table, Text) and is_ags(table) else table


def is_ags(table: Text) -> bool:
    """Whether a text is AGS: its first line names a group, as "GROUP","PROJ" does, or "**PROJ" of AGS 3."""
    first = table.cells(table.rows[0]) if table.rows else [""]
    return first[0].startswith("**") or _group_of(first) is not None


def ags_table(table: Text) -> SurveyTable:
    """The rows of the group DISC of a file: its headings with their units, then its data.

    Rows without a dip or a dip direction are left out and listed: in core that is not oriented none is measured. A row
    that has lost its word DATA is taken for data.

    Raises
    ------
    DesignError
        E191 a file of AGS 3, no group DISC, two of them whose headings differ.
    """
    name, title = table.name, ""
    groups: dict[str, dict[int, list[str]]] = {}
    for row in table.rows:
        cells = table.cells(row)
        if cells[0].startswith("**"):
            _refuse(name, f"{name} is a file of AGS 3", row, "Save it as AGS 4.")
        title = _group_of(cells) or title
        groups.setdefault(title, {})[row] = cells
    disc = groups.get("DISC", {})
    heads = [row for row, cells in disc.items() if cells[0] == "HEADING"]
    if not heads:
        advice = f"Discontinuities stand in its group DISC; this file has {', '.join(groups)}."
        _refuse(name, f"{name} has no column for dip and dip direction", 1, advice)
    headings = disc[heads[0]][1:]
    for row in heads:
        if disc[row][1:] != headings:
            _refuse(name, f"{name} has two groups DISC whose headings differ", row, "Leave one of them out.")
    units = next((cells[1:] for cells in disc.values() if cells[0] == "UNIT"), [])
    data = {
        row: cells[1:] if cells[0] == "DATA" else cells
        for row, cells in disc.items()
        if row > heads[0] and cells[0] not in _DESCRIPTORS
    }
    unoriented = _unoriented(headings, data)
    oriented = {row: cells for row, cells in data.items() if row not in unoriented}
    others = [other for other in groups if other != "DISC"]
    left_out = [f"group{'s' if len(others) > 1 else ''} {', '.join(others)}"] if others else []
    if unoriented:
        shown = ", ".join(map(str, unoriented[:_FEW])) + (", ..." if len(unoriented) > _FEW else "")
        many = "s" if len(unoriented) > 1 else ""
        left_out.append(f"{len(unoriented)} row{many} without dip or dip direction (line{many} {shown})")
    bare = sum(disc[row][0] != "DATA" for row in data)
    read_as = [f"{bare} rows of DISC without the word DATA are taken for data"] if bare else []
    with_units = headings_with_units(headings, units) or headings
    return SurveyTable(name, {heads[0]: with_units} | oriented, table.lines, left_out, read_as)


def _unoriented(headings: Sequence[str], data: Mapping[int, list[str]]) -> list[int]:
    """The rows without an orientation; a flat joint, which has none to say but its dip, gets the direction 0."""
    if _DIP not in headings or _DIP_DIRECTION not in headings:
        return []
    dip, direction = headings.index(_DIP), headings.index(_DIP_DIRECTION)
    unoriented = []
    for row, cells in data.items():
        cells += [""] * (len(headings) - len(cells))
        if not cells[direction] and _FLAT.fullmatch(cells[dip]):
            cells[direction] = "0"
        elif not cells[dip] or not cells[direction]:
            unoriented.append(row)
    return unoriented


def _group_of(cells: Sequence[str]) -> str | None:
    named = len(cells) > 1 and cells[0] == "GROUP" and not any(cells[2:])
    return cells[1] if named and _GROUP_NAME.fullmatch(cells[1]) else None


def _refuse(name: str, message: str, row: int, advice: str) -> NoReturn:
    fail("E191", message, f"{name}:{row}", advice)
