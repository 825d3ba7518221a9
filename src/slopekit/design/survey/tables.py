"""The rows of a joint list as cells, whatever it stands in: a text, AGS, a workbook, a frame of pandas or polars."""

import csv
import re
import warnings
from bisect import bisect
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from io import BytesIO
from typing import Any, NoReturn
from zipfile import BadZipFile
from zlib import error as ZlibError

from slopekit.core.degrees import decimal_degrees
from slopekit.core.orientation import number
from slopekit.core.units import is_unit_of, unit_of
from slopekit.design.reading.nodes import fail
from slopekit.design.survey.columns import key_of, plane_columns, unit_in_heading

_LONGEST = 3  # words of a name: dip direction (deg) counts two
_DEGREES = re.compile(r"(deg|°|º)", re.IGNORECASE)
_METRES = ("metre", "metres", "meter", "meters")
_NO_DEGREES = ("radian", "radians", "gon", "grad", "grads")
_NOTHING = ("", "-", "–", "—", "n/a", "none")
_KINDS = ("angle", "length", "pressure")
_TEXTS = ("name", "set", "hole", "reference")  # columns of words, of which any word may stand for the unit
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)°?")


def headings_by_blanks(header: str, row: str) -> list[str] | None:
    """The headings of a header, the longest names first, or None where they are not as many as the cells of a row.

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
        longest_first = [" ".join(words[:count]) for count in range(_LONGEST, 0, -1)]
        name = next((name for name in longest_first if key_of(name.replace("\0", " "))), words[0])
        headings.append(name.replace("\0", " "))
        words = words[len(name.split(" ")) :]
    gives_planes = plane_columns(map(key_of, headings)) is not None
    return headings if gives_planes and len(headings) == len(row.split()) > 1 else None


def is_row_of_numbers(text: str) -> bool:
    """Whether a line is of numbers with blanks between them, two or more.

    >>> is_row_of_numbers("45 115"), is_row_of_numbers("45"), is_row_of_numbers("J1 45")
    (True, False, False)
    """
    words = text.split()
    return len(words) > 1 and all(_NUMBER.fullmatch(word) for word in words)


def headings_with_units(headings: Sequence[str], cells: Sequence[str]) -> list[str] | None:
    """The headings, each with the unit in the row below it, or None where that row holds no units.

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
    known = [(word, unit) for heading, word, unit in columns if key_of(heading) not in (None, *_TEXTS)]
    if any(re.match(r"[+-]?[.,]?\d", word) for _, word, _ in columns):
        return None
    if not any(unit for _, unit in known) or any(word.lower() not in _NOTHING and not unit for word, unit in known):
        return None
    return [_with_unit(heading, unit) for heading, _, unit in columns]


def _unit(word: str) -> str:
    """The unit that a word means, empty where it means none."""
    lower = word.lower()
    if _DEGREES.match(word):
        return "deg"
    if lower in _METRES:
        return "m"
    return word if lower in _NO_DEGREES or any(is_unit_of(unit_of(f"1 {word}"), kind) for kind in _KINDS) else ""


def _with_unit(heading: str, unit: str) -> str:
    written = unit_in_heading(heading)
    if unit and written and _unit(written) not in ("", unit):
        fail("E191", f"the column {heading} is in {unit} by the row of units", heading, "Leave one of the units out.")
    return f"{heading} ({unit})" if unit and not written else heading


#: What zipfile, the parser of XML and openpyxl raise over a part that is broken, missing or encrypted.
_BROKEN = (
    BadZipFile, ZlibError, EOFError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, OSError,
    SyntaxError,
)  # fmt: skip
_EMPTY = ("none", "nan", "nat", "<na>")
_COMMENTS = ("#", "*")
_BLANKS = re.compile(r"\s{2,}|\t")


class SurveyTable:
    """Rows of cells by their number: of a workbook, a frame, AGS; `Text` finds its cells itself.

    Attributes
    ----------
    name : of the list; noun : what a row is called; rows : numbers of those that are neither empty nor comments
    comments : numbers of the comments above the first of them, which may hold the header
    delimiter : between the cells of a text, `,` where there is none; left_out : parts that are not looked at
    read_as : what is read in another way than it stands there
    """

    noun, delimiter = "line", ","

    def __init__(
        self, name: str, by_row: Mapping[int, list[str]], lines: Sequence[str] = (),
        left_out: Sequence[str] = (), read_as: Sequence[str] = (),
    ) -> None:  # fmt: skip
        self.name, self.by_row, self.lines, self.left_out, self.read_as = name, by_row, lines, left_out, read_as
        self.rows = [row for row, cells in by_row.items() if not next(filter(None, cells), "").startswith(_COMMENTS)]
        self.comments = [row for row in by_row if not self.rows or row < self.rows[0]]

    def start(self, row: int, blanks: bool = False) -> None:
        """Take a row for the first: it says what stands between the cells; `blanks` : a single blank may."""

    def cells(self, row: int) -> list[str]:
        """The cells of a row, stripped."""
        return self.by_row[row]

    def shown(self, row: int) -> str:
        """The row as the user has it."""
        return self.lines[row - 1] if self.lines else "; ".join(self.cells(row)).rstrip("; ")


class Text(SurveyTable):
    """Lines with a semicolon, a tab, a comma or blanks between the cells; # and * begin comments."""

    def __init__(self, name: str, content: bytes) -> None:
        lines = re.split(r"\r\n|\n|\r", _decoded(content, name))
        super().__init__(name, {k: [line.lstrip()] for k, line in enumerate(lines, 1) if line.strip()}, lines)
        self.width = 0
        self.headings: dict[int, list[str]] = {}  # of a header whose columns are separated by single blanks

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
            two = (self.lines[k - 1] for k in self.rows[bisect(self.rows, row) :][:2])  # the first may hold units
            cells = headings_by_blanks(text, next(filter(re.compile(r"\d").search, two), "")) or cells
            self.headings = {row: cells}
        if len(cells) > 1:
            self.delimiter, self.width = " ", len(cells)

    def cells(self, row: int) -> list[str]:
        text = self.lines[row - 1]
        if self.delimiter == " ":
            cells = self.headings.get(row) or decimal_degrees(text).split()
            return cells if len(cells) == self.width else _BLANKS.split(text.strip())
        try:
            fields = next(csv.reader([text], delimiter=self.delimiter, skipinitialspace=self.delimiter != "\t"), [])
        except csv.Error:  # a field longer than csv takes
            fields = text.split(self.delimiter)
        return [decimal_degrees(cell.strip()) for cell in fields]


class Grid(SurveyTable):
    """Rows of values: of a sheet of a workbook, or of a frame, whose columns' names are its row 0."""

    noun, delimiter = "row", "\t"

    def __init__(self, name: str, values: Iterable[Sequence[Any]], first: int, left_out: Sequence[str] = ()) -> None:
        texts = ([_text(value) for value in row] for row in values)
        super().__init__(name, {k: row for k, row in enumerate(texts, first) if any(row)}, (), left_out)


def read_table(name: str, content: bytes) -> SurveyTable:
    """The table in a file, known by how its content begins.

    Raises
    ------
    DesignError
        E140 a workbook without openpyxl, E159 neither a text nor a workbook, E191 AGS without discontinuities.
    """
    for mark, read in _KNOWN_BY.items():
        if content.startswith(mark):
            return read(name, content)
    table = Text(name, content)
    return ags_table(table) if is_ags(table) else table


def frame_table(frame: Any) -> SurveyTable:
    """The table of a frame of pandas or polars, or of whatever has `columns` and gives each by its name."""
    names = list(frame.columns)
    columns = [list(frame[column]) for column in names]
    index = getattr(getattr(frame, "index", None), "name", None)
    left_out = () if index is None else (f"index {index}",)
    return Grid("joints", [names, *zip(*columns, strict=True)], 0, left_out)


def is_frame(source: Any) -> bool:
    """Whether something has columns by name, as frames of pandas and polars have."""
    return hasattr(source, "columns") and hasattr(source, "__getitem__") and not isinstance(source, Mapping)


def _workbook(name: str, content: bytes) -> SurveyTable:
    try:
        from openpyxl import load_workbook
    except ImportError:
        advice = "pip install 'slopekit[survey]', or save the sheet as CSV."
        fail("E140", f"reading {name} needs the extra survey (openpyxl)", name, advice)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of styles and extensions, which hold no joints
            sheets = load_workbook(BytesIO(content), read_only=True, data_only=True).worksheets
            values = [list(row) for row in sheets[0].iter_rows(values_only=True)]
    except _BROKEN:
        fail("E159", f"{name} is no workbook that can be read", name, "Save the sheet as .xlsx again, or as CSV.")
    others = [sheet.title for sheet in sheets[1:]]
    left_out = [f"{'sheet' if len(others) == 1 else 'sheets'} {', '.join(others)}"] if others else []
    return Grid(name, values, 1, left_out)


def _old_workbook(name: str, _: bytes) -> SurveyTable:
    fail("E159", f"{name} is a workbook of before 2007", name, "Save it as .xlsx, or the sheet as CSV.")


_KNOWN_BY: Mapping[bytes, Callable[[str, bytes], SurveyTable]] = {
    b"PK\x03\x04": _workbook,
    b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1": _old_workbook,
}


def _text(value: Any) -> str:
    """A cell as it would stand in a CSV; what stands for nothing is empty."""
    if isinstance(value, float) and value.is_integer():
        return number(value)
    text = decimal_degrees(str(value).strip())
    return "" if text.lower() in _EMPTY else text


def _decoded(content: bytes, name: str) -> str:
    """The text of UTF-8, UTF-16 or Windows files; what is no text at all is refused."""
    encoding = "utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    if b"\x00" in content[:200] and encoding != "utf-16":  # without its mark: every other byte of ASCII is zero
        encoding = "utf-16-le" if content[1:2] == b"\x00" else "utf-16-be"
    text = None
    for name_of_encoding in (encoding, *(("cp1252", "latin-1") if encoding == "utf-8-sig" else ())):
        if text is None:
            with suppress(UnicodeDecodeError):
                text = content.decode(name_of_encoding)
    bad = re.search("[\x00-\x08\x0e-\x1f\x7f\ud800-\udfff]", text) if text is not None else None
    if text is None or bad:
        shown = f" (character U+{ord(bad.group()):04X})" if bad else ""
        fail("E159", f"{name} is not a text file{shown}", name, "Save the list as CSV.")
    return text


# -- the discontinuities in an AGS 4 file -----------------------------------------------------------------------------

# A line is a row of quoted cells whose first says what the row is: GROUP, HEADING, UNIT, TYPE or DATA. Discontinuities
# are the group DISC, one a row of DATA. Source: AGS, Electronic transfer of geotechnical and geoenvironmental data,
# edition 4.1.1.
_DIP, _DIP_DIRECTION = "DISC_DIP", "DISC_DIR"
_DESCRIPTORS = ("GROUP", "HEADING", "UNIT", "TYPE")
_GROUP_NAME = re.compile(r"[A-Z][A-Z0-9]{3}")
_FLAT = re.compile(r"0+(\.0*)?")
_FEW = 8  # lines that are listed one by one


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
