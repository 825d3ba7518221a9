"""Tables of cells from joint lists of any format: a text, AGS, a workbook, a frame of pandas or polars."""

import csv
import re
import warnings
import zlib
from bisect import bisect
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from io import BytesIO
from typing import Any, NoReturn
from zipfile import BadZipFile

from slopekit.core.degrees import decimal_degrees
from slopekit.core.orientation import number
from slopekit.core.units import is_unit_of, unit_of
from slopekit.design.reading.nodes import fail
from slopekit.design.survey.columns import key_of, plane_columns, unit_in_heading

_MAX_NAME_WORDS = 3  # words of a heading: dip direction (deg) counts two
_DEGREES = re.compile(r"(deg|°|º)", re.IGNORECASE)
_METRES = ("metre", "metres", "meter", "meters")
_NO_DEGREES = ("radian", "radians", "gon", "grad", "grads")
_NO_UNIT = ("", "-", "–", "—", "n/a", "none")
_KINDS = ("angle", "length", "pressure")
_TEXTS = (
    "name",
    "set",
    "hole",
    "reference",
)  # columns of texts, which may have any word in a row of units
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)°?")


def headings_by_blanks(header: str, row: str) -> list[str] | None:
    """Split a header at blanks into headings, longest names first; None unless there is one for each cell of a row.

    >>> headings_by_blanks("Name Dip Dip Direction (deg)", "J1 45 115")
    ['Name', 'Dip', 'Dip Direction (deg)']
    >>> headings_by_blanks("Global orientation is:", "45/115") is None
    True
    """
    words = re.sub(r"\s+([(\[])", r"\0\1", header.strip(" #*")).split()
    headings: list[str] = []
    if any(word[0].isdigit() for word in words):
        return None
    while words:
        longest_first = [" ".join(words[:count]) for count in range(_MAX_NAME_WORDS, 0, -1)]
        name = next((name for name in longest_first if key_of(name.replace("\0", " "))), words[0])
        headings.append(name.replace("\0", " "))
        words = words[len(name.split(" ")) :]
    gives_planes = plane_columns(map(key_of, headings)) is not None
    return headings if gives_planes and len(headings) == len(row.split()) > 1 else None


def is_row_of_numbers(text: str) -> bool:
    """Return whether a line has two or more numbers, separated by blanks, and nothing else.

    >>> is_row_of_numbers("45 115"), is_row_of_numbers("45"), is_row_of_numbers("J1 45")
    (True, False, False)
    """
    words = text.split()
    return len(words) > 1 and all(_NUMBER.fullmatch(word) for word in words)


def headings_with_units(headings: Sequence[str], cells: Sequence[str]) -> list[str] | None:
    """Return the headings with the units of the row below them; None if that row does not hold units.

    Raises
    ------
    DesignError
        E191 where a heading has another unit.

    >>> headings_with_units(["Dip", "Dip Direction", "c (kPa)", "set"], ["deg", "deg", "kPa", ""])
    ['Dip (deg)', 'Dip Direction (deg)', 'c (kPa)', 'set']
    >>> headings_with_units(["Dip", "Dip Direction"], ["45", "115"]) is None
    True
    """
    words = [cell.strip(" ()[]") for cell in (*cells, *[""] * (len(headings) - len(cells)))]
    columns = list(zip(headings, words, map(_unit, words), strict=False))
    measured_columns = [
        (word, unit) for heading, word, unit in columns if key_of(heading) not in (None, *_TEXTS)
    ]
    if any(re.match(r"[+-]?[.,]?\d", word) for _, word, _ in columns):
        return None
    if not any(unit for _, unit in measured_columns) or any(
        word.lower() not in _NO_UNIT and not unit for word, unit in measured_columns
    ):
        return None
    return [_with_unit(heading, unit) for heading, _, unit in columns]


def _unit(word: str) -> str:
    """Return the unit of a word, empty where it is no unit."""
    lower = word.lower()
    if _DEGREES.match(word):
        return "deg"
    if lower in _METRES:
        return "m"
    return (
        word
        if lower in _NO_DEGREES or any(is_unit_of(unit_of(f"1 {word}"), kind) for kind in _KINDS)
        else ""
    )


def _with_unit(heading: str, unit: str) -> str:
    written = unit_in_heading(heading)
    if unit and written and _unit(written) not in ("", unit):
        fail(
            "E191",
            f"the column {heading} is in {unit} by the row of units",
            heading,
            "Leave one of the units out.",
        )
    return f"{heading} ({unit})" if unit and not written else heading


#: Exceptions of zipfile, the XML parser and openpyxl for a workbook that is broken, incomplete or encrypted.
_BROKEN = (
    BadZipFile,
    zlib.error,
    EOFError,
    RuntimeError,
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    OSError,
    SyntaxError,
)
_EMPTY = ("none", "nan", "nat", "<na>")
_COMMENTS = ("#", "*")
_BLANKS = re.compile(r"\s{2,}|\t")


class SurveyTable:
    """The rows of a joint list as cells, by row number: of a workbook, a frame or AGS; `Text` splits lines itself.

    Attributes
    ----------
    name : name of the list
    noun : the word for a row, in messages
    rows : numbers of the rows that are neither empty nor comments
    comments : numbers of the comments above the first of these rows, which may hold the header
    delimiter : delimiter of the cells of a text, `,` where there is none
    left_out : unused parts of the file, in words
    read_as : contents that are interpreted in another way than they are written, in words
    """

    noun, delimiter = "line", ","

    def __init__(
        self,
        name: str,
        by_row: Mapping[int, list[str]],
        lines: Sequence[str] = (),
        left_out: Sequence[str] = (),
        read_as: Sequence[str] = (),
    ) -> None:
        self.name, self.by_row, self.lines, self.left_out, self.read_as = (
            name,
            by_row,
            lines,
            left_out,
            read_as,
        )
        self.rows = [
            row
            for row, cells in by_row.items()
            if not next(filter(None, cells), "").startswith(_COMMENTS)
        ]
        self.comments = [row for row in by_row if not self.rows or row < self.rows[0]]

    def start(self, row: int, blanks: bool = False) -> None:
        """Take a row as the first and find the delimiter from it; `blanks` allows single blanks."""

    def cells(self, row: int) -> list[str]:
        """Return the cells of a row, stripped."""
        return self.by_row[row]

    def row_text(self, row: int) -> str:
        """Return the text of a row as the user wrote it."""
        return self.lines[row - 1] if self.lines else "; ".join(self.cells(row)).rstrip("; ")


class Text(SurveyTable):
    """A text whose cells are separated by semicolons, tabs, commas or blanks; # and * begin comments."""

    def __init__(self, name: str, content: bytes) -> None:
        lines = re.split(r"\r\n|\n|\r", _decoded(content, name))
        super().__init__(
            name, {k: [line.lstrip()] for k, line in enumerate(lines, 1) if line.strip()}, lines
        )
        self.width = 0
        self.headings: dict[
            int, list[str]
        ] = {}  # cells of a header with single blanks between the columns

    def start(self, row: int, blanks: bool = False) -> None:
        text = decimal_degrees(self.lines[row - 1])
        self.delimiter, self.width, self.headings = (
            next((mark for mark in (";", "\t", ",") if mark in text), ","),
            0,
            {},
        )
        if self.delimiter in text:
            return
        cells = text.split() if blanks or is_row_of_numbers(text) else _BLANKS.split(text.strip())
        if len(cells) == 1 and not blanks:
            two = (
                self.lines[k - 1] for k in self.rows[bisect(self.rows, row) :][:2]
            )  # two rows, as the first may hold units
            cells = (
                headings_by_blanks(text, next(filter(re.compile(r"\d").search, two), "")) or cells
            )
            self.headings = {row: cells}
        if len(cells) > 1:
            self.delimiter, self.width = " ", len(cells)

    def cells(self, row: int) -> list[str]:
        text = self.lines[row - 1]
        if self.delimiter == " ":
            cells = self.headings.get(row) or decimal_degrees(text).split()
            return cells if len(cells) == self.width else _BLANKS.split(text.strip())
        try:
            fields = next(
                csv.reader(
                    [text], delimiter=self.delimiter, skipinitialspace=self.delimiter != "\t"
                ),
                [],
            )
        except csv.Error:  # a field longer than csv takes
            fields = text.split(self.delimiter)
        return [decimal_degrees(cell.strip()) for cell in fields]


class Grid(SurveyTable):
    """A table of the values of a workbook's sheet or of a frame, whose column names are row 0."""

    noun, delimiter = "row", "\t"

    def __init__(
        self, name: str, values: Iterable[Sequence[Any]], first: int, left_out: Sequence[str] = ()
    ) -> None:
        texts = ([_text(value) for value in row] for row in values)
        super().__init__(
            name, {k: row for k, row in enumerate(texts, first) if any(row)}, (), left_out
        )


def read_table(name: str, content: bytes) -> SurveyTable:
    """Return the table of a file; its format is known by the first bytes.

    Raises
    ------
    DesignError
        E140 openpyxl is missing for a workbook, E159 neither a text nor a workbook, E191 AGS without discontinuities.
    """
    for mark, read in _READER_BY_SIGNATURE.items():
        if content.startswith(mark):
            return read(name, content)
    table = Text(name, content)
    return ags_table(table) if is_ags(table) else table


def frame_table(frame: Any) -> SurveyTable:
    """Return the table of a frame of pandas or polars, or of any object with `columns` and access by their names."""
    names = list(frame.columns)
    columns = [list(frame[column]) for column in names]
    index = getattr(getattr(frame, "index", None), "name", None)
    left_out = () if index is None else (f"index {index}",)
    return Grid("joints", [names, *zip(*columns, strict=True)], 0, left_out)


def is_frame(source: Any) -> bool:
    """Return whether an object has columns by name, as frames of pandas and polars have."""
    return (
        hasattr(source, "columns")
        and hasattr(source, "__getitem__")
        and not isinstance(source, Mapping)
    )


def _workbook(name: str, content: bytes) -> SurveyTable:
    try:
        from openpyxl import load_workbook
    except ImportError:
        advice = "pip install 'slopekit[survey]', or save the sheet as CSV."
        fail("E140", f"reading {name} needs the extra survey (openpyxl)", name, advice)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings about styles and extensions
            sheets = load_workbook(BytesIO(content), read_only=True, data_only=True).worksheets
            values = [list(row) for row in sheets[0].iter_rows(values_only=True)]
    except _BROKEN:
        fail(
            "E159",
            f"{name} is no workbook that can be read",
            name,
            "Save the sheet as .xlsx again, or as CSV.",
        )
    other_sheets = [sheet.title for sheet in sheets[1:]]
    left_out = (
        [f"{'sheet' if len(other_sheets) == 1 else 'sheets'} {', '.join(other_sheets)}"]
        if other_sheets
        else []
    )
    return Grid(name, values, 1, left_out)


def _old_workbook(name: str, _: bytes) -> SurveyTable:
    fail(
        "E159",
        f"{name} is a workbook of before 2007",
        name,
        "Save it as .xlsx, or the sheet as CSV.",
    )


_READER_BY_SIGNATURE: Mapping[bytes, Callable[[str, bytes], SurveyTable]] = {
    b"PK\x03\x04": _workbook,
    b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1": _old_workbook,
}


def _text(value: Any) -> str:
    """Return a cell's value as the text it would have in a CSV file; empty for missing values."""
    if isinstance(value, float) and value.is_integer():
        return number(value)
    text = decimal_degrees(str(value).strip())
    return "" if text.lower() in _EMPTY else text


def _decoded(content: bytes, name: str) -> str:
    """Return the text of a file in UTF-8, UTF-16 or a Windows encoding; raise E159 where it is no text."""
    encoding = "utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    if (
        b"\x00" in content[:200] and encoding != "utf-16"
    ):  # UTF-16 without a byte order mark: every other byte of ASCII is zero
        encoding = "utf-16-le" if content[1:2] == b"\x00" else "utf-16-be"
    text = None
    for name_of_encoding in (encoding, *(("cp1252", "latin-1") if encoding == "utf-8-sig" else ())):
        if text is None:
            with suppress(UnicodeDecodeError):
                text = content.decode(name_of_encoding)
    bad = re.search("[\x00-\x08\x0e-\x1f\x7f\ud800-\udfff]", text) if text is not None else None
    if text is None or bad:
        character_text = f" (character U+{ord(bad.group()):04X})" if bad else ""
        fail("E159", f"{name} is not a text file{character_text}", name, "Save the list as CSV.")
    return text


# -- the discontinuities in an AGS 4 file -----------------------------------------------------------------------------

# A line is a row of quoted cells; the first is the type of the row: GROUP, HEADING, UNIT, TYPE or DATA. Discontinuities
# are the group DISC, one in each DATA row. Source: AGS, Electronic transfer of geotechnical and geoenvironmental data,
# edition 4.1.1.
_DIP, _DIP_DIRECTION = "DISC_DIP", "DISC_DIR"
_DESCRIPTORS = ("GROUP", "HEADING", "UNIT", "TYPE")
_GROUP_NAME = re.compile(r"[A-Z][A-Z0-9]{3}")
_FLAT = re.compile(r"0+(\.0*)?")
_MAX_LISTED_LINES = 8  # line numbers listed in a note


def is_ags(table: Text) -> bool:
    """Return whether a text is AGS: its first line names a group, as "GROUP","PROJ", or "**PROJ" of AGS 3."""
    first = table.cells(table.rows[0]) if table.rows else [""]
    return first[0].startswith("**") or _group_of(first) is not None


def ags_table(table: Text) -> SurveyTable:
    """Return the group DISC of a file as a table: its headings with their units, then its data.

    Rows without a dip or a dip direction, as from core that is not oriented, are left out and listed. A row without its
    word DATA is read as data.

    Raises
    ------
    DesignError
        E191 a file of AGS 3, no group DISC, or two groups DISC with different headings.
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
    heading_rows = [row for row, cells in disc.items() if cells[0] == "HEADING"]
    if not heading_rows:
        advice = f"Discontinuities stand in its group DISC; this file has {', '.join(groups)}."
        _refuse(name, f"{name} has no column for dip and dip direction", 1, advice)
    headings = disc[heading_rows[0]][1:]
    for row in heading_rows:
        if disc[row][1:] != headings:
            _refuse(
                name,
                f"{name} has two groups DISC whose headings differ",
                row,
                "Leave one of them out.",
            )
    units = next((cells[1:] for cells in disc.values() if cells[0] == "UNIT"), [])
    data = {
        row: cells[1:] if cells[0] == "DATA" else cells
        for row, cells in disc.items()
        if row > heading_rows[0] and cells[0] not in _DESCRIPTORS
    }
    unoriented = _unoriented(headings, data)
    oriented = {row: cells for row, cells in data.items() if row not in unoriented}
    other_groups = [group for group in groups if group != "DISC"]
    left_out = (
        [f"group{'s' if len(other_groups) > 1 else ''} {', '.join(other_groups)}"]
        if other_groups
        else []
    )
    if unoriented:
        lines_text = ", ".join(map(str, unoriented[:_MAX_LISTED_LINES])) + (
            ", ..." if len(unoriented) > _MAX_LISTED_LINES else ""
        )
        plural = "s" if len(unoriented) > 1 else ""
        left_out.append(
            f"{len(unoriented)} row{plural} without dip or dip direction (line{plural} {lines_text})"
        )
    untagged = sum(disc[row][0] != "DATA" for row in data)
    read_as = (
        [f"{untagged} rows of DISC without the word DATA are taken for data"] if untagged else []
    )
    with_units = headings_with_units(headings, units) or headings
    return SurveyTable(
        name, {heading_rows[0]: with_units} | oriented, table.lines, left_out, read_as
    )


def _unoriented(headings: Sequence[str], data: Mapping[int, list[str]]) -> list[int]:
    """Return the rows without an orientation; horizontal joints without a direction get the direction 0."""
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
    is_group_row = len(cells) > 1 and cells[0] == "GROUP" and not any(cells[2:])
    return cells[1] if is_group_row and _GROUP_NAME.fullmatch(cells[1]) else None


def _refuse(name: str, message: str, row: int, advice: str) -> NoReturn:
    fail("E191", message, f"{name}:{row}", advice)
