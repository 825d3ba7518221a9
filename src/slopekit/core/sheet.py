"""The sheet: sections of entries and tables, made once and written as text, CSV, JSON and HTML.

A table knows its rows as they are and, by column, what a cell holds, its unit and how many digits are shown; no
writing reads what another has written.

>>> rows = [{"name": "J1", "fos": 1.234}, {"name": "J2", "fos": None}]
>>> table = Table((Column("joint", "name", width=-8), Column("FoS", "fos", "fos", show=".2f", width=6)), rows)
>>> print(Sheet("slopekit   demo", (Section("JOINTS", (table,)),)))
slopekit   demo
JOINTS    joint      FoS
          J1        1.23
          J2
>>> table.csv()
'fos\\n1.234\\n""\\n'
"""

import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from io import StringIO
from typing import Any, Generic, TextIO, TypeAlias, TypeVar

from slopekit.core.codec import json_of

WIDTH = 100
LABEL = 10
TIME = "TIME"  # a section of the full text alone: no two runs have the same
Row = TypeVar("Row")

_ROUNDING = 1e-6  # below 1 by less than this is 1
_TO_THREE = 5e-4  # below 1 by less than this three decimals say 1
_AT_ONCE = 8192  # rows of a CSV whose columns are made at once


@dataclass(frozen=True)
class Column(Generic[Row]):
    """One column of a table, declared once for every writing of it.

    Attributes
    ----------
    title : its head, in text with the blanks that set it off
    of : what a cell of a row holds, a number, words, None where there is nothing: a function of the row, the path of an
        attribute or of an entry of it (`axes.k`), or the values of all rows, which are then numbered
    key : its name in CSV and JSON; empty: it is not there
    unit : of its numbers
    show : how a cell is written for a person: a format of its numbers (`.1f`, `{:.1f}°`), or a function of the cell
    blank : what stands for None, and for what is not a number
    text : or a function of the row, where more than the cell is shown
    width : characters in text, negative to the left; 1: as it comes; 0: not there; a title alone puts it in JSON
    exact : format of its numbers in CSV, empty for every digit
    timed : measured, another one in every run: it stands in text and files, not in the JSON of the sheet
    about : what stands about a cell and the title in text
    """

    title: str
    of: Any
    key: str = ""
    unit: str = ""
    show: str | Callable[[Any], str] = ""
    width: int = 0
    exact: str = ""
    text: Callable[[Row], str] | None = None
    timed: bool = False
    about: str = "{}"
    blank: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "of", _reader(self.of))

    def shown(self, row: Row) -> str:
        """The cell of a row for a person."""
        if self.text is not None:
            return self.text(row)
        value = self.of(row)
        if (value is None or value != value) and (self.blank or not callable(self.show)):
            return self.blank
        if callable(self.show):
            return self.show(value)
        if "{" in self.show:
            return self.show.format(value)
        return format(value, self.show) if isinstance(value, int | float) else str(value)

    def _csv_cell(self, value: Any) -> str:
        """A cell in CSV."""
        if not isinstance(value, float):  # most are
            value = json_of(value)
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            return ""
        if isinstance(value, float):
            return format(value, self.exact) if self.exact else float.__repr__(value)
        return without_formula(value) if isinstance(value, str) else str(value)

    def cells(self, rows: Sequence[Row]) -> list[str | float]:
        """The cells of many rows in CSV; floats that are written with every digit as they are."""
        values, exact, finite = [self.of(row) for row in rows], self.exact, math.isfinite
        return [
            value if type(value) is float and finite(value) and not exact else self._csv_cell(value)
            for value in values
        ]

    def padded(self, text: str) -> str:
        """A cell or the head as wide as the column, with what stands about it."""
        text = self.about.format(text) if text else text
        if abs(self.width) == 1:
            return text
        return f"{text:<{-self.width}}" if self.width < 0 else f"{text:>{self.width}}"


def _reader(source: Any) -> Callable[[Any], Any]:
    """Return the function that reads a cell from a row: from the path of its value, or from the values of all rows.

    >>> _reader("axes.k")({"axes": {"k": 3.0}}), _reader("axes.k")({"axes": None}), _reader([1.0, 2.0])(1)
    (3.0, None, 2.0)
    """
    if isinstance(source, str):
        return partial(value_at, source.split("."))
    values = source.tolist() if hasattr(source, "tolist") else source
    read: Callable[[Any], Any] = source if callable(source) else values.__getitem__
    return read


def value_at(path: Sequence[str], row: Any) -> Any:
    """Return the value at a path below a row, None where something on the way is."""
    for name in path:
        if row is not None:
            row = row.get(name) if isinstance(row, Mapping) else getattr(row, name)
    return row


def without_formula(text: str) -> str:
    """Return a text that a spreadsheet takes for no formula: an apostrophe stands before `=`, `+`, `-`, `@`, tab.

    >>> without_formula("=cmd|' /C calc'!A0"), without_formula("J1"), without_formula("-3.5")
    ("'=cmd|' /C calc'!A0", 'J1', '-3.5')
    """
    if text[:1] not in ("=", "+", "-", "@", "\t", "\r"):
        return text
    try:
        float(text)
    except ValueError:
        return f"'{text}"
    return text


@dataclass(frozen=True)
class Table(Generic[Row]):
    """Rows of any kind, and the columns that are made of them.

    Attributes
    ----------
    rows : in order, all of them
    shown : those that a person is shown, all where None; `rest` says where the others are
    headless : without a line of titles in text
    ends : so many of the first and of the last are in text, `rest` between them; other writings have them all
    said : what stands for it in text, where its rows are a few words each
    """

    columns: Sequence[Column[Row]]
    rows: Sequence[Row]
    shown: Sequence[Row] | None = None
    rest: str = ""
    headless: bool = False
    ends: tuple[int, int] | None = None
    said: str | None = None

    def lines(self) -> list[str]:
        """The table in text."""
        if self.said is not None:
            return [self.said] if self.said else []
        columns = [column for column in self.columns if column.width]
        lines = [
            "".join(column.padded(column.shown(row)) for column in columns).rstrip()
            for row in self._visible_rows
        ]
        if self.ends is None:
            lines += [self.rest] if self.rest else []
        elif self.left_out:
            lines[self.ends[0] : len(lines) - self.ends[1]] = [self.rest]
        return (
            lines
            if self.headless
            else ["".join(column.padded(column.title) for column in columns).rstrip(), *lines]
        )

    @property
    def left_out(self) -> Sequence[Row]:
        """The rows between the ends; none where the line that says so would save nothing."""
        between = (
            () if self.ends is None else self.rows[self.ends[0] : len(self.rows) - self.ends[1]]
        )
        return between if len(between) > 1 else ()

    def csv(self) -> str:
        """Every row, with every digit; a cell that does not apply is empty."""
        text = StringIO()
        self.write(text)
        return text.getvalue()

    def write(self, file: TextIO) -> None:
        """The same to a file, row by row."""
        import csv

        columns = [column for column in self.columns if column.key]
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([without_formula(column.key) for column in columns])
        for rows in self._row_chunks():
            writer.writerows(zip(*(column.cells(rows) for column in columns), strict=True))

    def records(self) -> list[dict[str, Any]]:
        """Every row by the keys of its columns: what data frames are made of."""
        columns = [column for column in self.columns if column.key]
        return [
            {column.key: json_of(column.of(row)) for column in columns}
            for rows in self._row_chunks()
            for row in rows
        ]

    def _row_chunks(self) -> Iterator[Sequence[Row]]:
        return (self.rows[start : start + _AT_ONCE] for start in range(0, len(self.rows), _AT_ONCE))

    def to_dict(self) -> dict[str, Any]:
        """Return the table as JSON values: heads with units, cells as numbers and as text."""
        columns = [
            column for column in self.columns if (column.width or column.title) and not column.timed
        ]
        return {
            "columns": [
                {"title": column.title.strip(), "key": column.key or None, "unit": column.unit}
                for column in columns
            ],
            "rows": [[json_of(column.of(row)) for column in columns] for row in self._visible_rows],
            "shown": [
                [column.shown(row).strip() for column in columns] for row in self._visible_rows
            ],
            "rest": "" if self.ends else self.rest,
        }

    @property
    def _visible_rows(self) -> Sequence[Row]:
        return self.rows if self.shown is None else self.shown


class Verbatim(str):
    """A text to be copied as it is: its lines stand at the left margin, whatever their length."""

    __slots__ = ()


Entry: TypeAlias = str | Table[Any]


@dataclass(frozen=True)
class Section:
    """A label and its entries.

    Attributes
    ----------
    details : entries of the full sheet, behind the others; JSON and pages have them always
    hang : indent of folded lines of text
    timed : as of a column
    """

    label: str
    entries: Sequence[Entry]
    hang: int = 3
    timed: bool = False
    details: Sequence[Entry] = ()

    @property
    def content(self) -> Sequence[Entry]:
        """The entries of the full sheet."""
        return [*self.entries, *self.details]

    def lines(self, is_full: bool = False) -> list[str]:
        """The section in text; without entries it is nothing."""
        lines: list[str] = []
        for entry in self.content if is_full else self.entries:
            if isinstance(entry, Verbatim):
                lines += entry.rstrip().splitlines()
            else:
                texts = [entry] if isinstance(entry, str) else entry.lines()
                lines += block("" if lines else self.label, texts, self.hang)
        return lines

    def to_list(self) -> list[Any]:
        """The entries as JSON values."""
        return [_entry_json(entry) for entry in self.content]


def _entry_json(entry: Entry) -> Any:
    """An entry as JSON values; a key tells a text to be copied from a table."""
    if isinstance(entry, Verbatim):
        return {"verbatim": str(entry)}
    return entry if isinstance(entry, str) else entry.to_dict()


@dataclass(frozen=True)
class Sheet:
    """The sheet of a result or a study: sections of entries and tables.

    Attributes
    ----------
    head : version, what it is, title
    sections : those without entries are not written
    tables : whole tables by the name of their file, for CSV and data frames
    sha : hash of the input, in the full text
    """

    head: str
    sections: Sequence[Section]
    tables: Mapping[str, Table[Any]] = field(default_factory=dict)
    sha: str = ""

    def __str__(self) -> str:
        return self._text(is_full=False)

    @property
    def full(self) -> str:
        """The text with the details of every section."""
        return self._text(is_full=True)

    def _text(self, is_full: bool) -> str:
        lines = _folded(
            self.head + (f"   sha {self.sha[:6]}" if is_full and self.sha else ""), " " * LABEL
        )
        for section in self.sections:
            if is_full or section.label != TIME:
                lines += section.lines(is_full)
        return "\n".join(lines)

    def to_dict(self) -> dict[str, Any]:
        """Entries by label as JSON values; times stand in their own block."""
        entries: dict[str, list[Any]] = {}
        for section in self.sections:
            if section.content and not section.timed and section.label != TIME:
                entries.setdefault(section.label, []).extend(section.to_list())
        return entries

    def _repr_html_(self) -> str:
        return sheet_html(self.head, self.to_dict())


def sheet_html(head: str, sections: Mapping[str, Sequence[Any]]) -> str:
    """A sheet as HTML of its JSON values: sections with a heading, entries as paragraphs, tables as tables."""
    from html import escape

    blocks = [f'<div class="slopekit-sheet"><p><code>{escape(head)}</code></p>']
    for label, entries in sections.items():
        blocks.append(f"<h4>{escape(label)}</h4>")
        blocks += [
            f"<p>{escape(entry)}</p>" if isinstance(entry, str) else _entry_html(entry)
            for entry in entries
        ]
    return "\n".join([*blocks, "</div>"])


def _entry_html(table: Mapping[str, Any]) -> str:
    from html import escape

    if "verbatim" in table:
        return f"<pre>{escape(table['verbatim'])}</pre>"
    heads = "".join(f"<th>{escape(head_of(column))}</th>" for column in table["columns"])
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"
        for cells in table["shown"]
    )
    rest = f"<p>{escape(table['rest'])}</p>" if table["rest"] else ""
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>{rest}"


def head_of(column: Mapping[str, Any]) -> str:
    """The title of a column of a table's JSON, with its unit."""
    title, unit = str(column["title"]), str(column["unit"])
    return f"{title} / {unit}" if unit and unit not in title else title


def block(label: str, entries: Sequence[str], hang: int = 3) -> list[str]:
    """A label and its entries, folded to the width of the sheet; what is folded hangs in by `hang`."""
    lines: list[str] = []
    for k, entry in enumerate(entries):
        head = f"{label if k == 0 else '':<{LABEL - 1}} "
        indent = " " * (LABEL + hang)
        lines += _folded(head + entry, indent) or [head]
    return lines


def _folded(text: str, indent: str) -> list[str]:
    """A text in lines no wider than a sheet; nothing for a blank one."""
    if (
        len(text) <= WIDTH and text.isprintable()
    ):  # most lines: no tabs, no ends of lines, nothing to fold
        return [text.rstrip(" ")] if text.strip() else []
    return textwrap.wrap(text, WIDTH, subsequent_indent=indent)


def factor_text(value: float | None) -> str:
    """A factor of safety with three decimals, five columns wide below 10; below 1 with as many as show it.

    >>> factor_text(1.5574), factor_text(0.9996), factor_text(1.0 - 1e-12)
    ('1.557', '0.9996', '1.000')
    """
    if value is None:
        return " none"
    below_one = 1.0 - value
    digits = math.ceil(-math.log10(below_one)) if _ROUNDING < below_one <= _TO_THREE else 3
    return f"{value:.{digits}f}" if value < 1e3 else f"{value:.4g}"


def counted(count: int, singular: str, plural: str = "") -> str:
    """A count with its word.

    >>> counted(1, "block"), counted(3, "block"), counted(2, "mass", "masses")
    ('1 block', '3 blocks', '2 masses')
    """
    return f"{count} {singular if count == 1 else plural or singular + 's'}"


def is_number(value: float | None) -> bool:
    """Whether a factor is one: neither infinite, where nothing drives, nor 0, where nothing holds."""
    return value is not None and 0.0 < value < math.inf
