"""The same run as text, HTML, JSON and CSV has the same numbers: the tables of all templates, and of a study."""

import csv
import io
import json
import math
import re
from functools import cache
from html.parser import HTMLParser
from typing import Any

import pytest

import slopekit as sk
from slopekit.core.report import Report
from slopekit.core.sheet import Column, Section, Sheet, Table
from slopekit.design.templates import names, path_of
from slopekit.views.pages.report import report_of
from tests.support import result_of

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
#: How many are left out of a line: a count of rows, no number of one.
LEFT_OUT = re.compile(r"\.\.\. and \d+ (?:more|blocks?)")
SWEEP = "sweep of a wedge"


@cache
def shown(name: str) -> Report:
    if name == SWEEP:
        return sk.sweep(sk.load(path_of("wedge")), {"strength.weak.phi": "18:30:4"})
    return result_of(name)


BOLTED: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/180", "upper": "10/180", "height": 18},
    "joints": {
        "J1": {"plane": "45/120", "strength": "clay"},
        "J2": {"plane": "60/245", "strength": "rough"},
    },
    "strength": {"clay": {"c": 10, "phi": 28}, "rough": {"c": 5, "phi": 32}},
    "rock": {"unit_weight": 26},
    "water": {"fill": "50 %"},
    "loads": {"seismic": 0.05},
    "acceptance": {"rules": ["fos >= 1.5"]},
    "support": {
        "bolts": [
            {"force": 200, "head": [x, y, z], "toward": "000/-10", "length": 26, "acts": acts}
            for x, y, z, acts in (
                (0, -2, 5, "active"),
                (2, -3, 7, "active"),
                (-1, -4, 9, "passive"),
            )
        ]
    },
}


@pytest.mark.parametrize(
    ("study", "most"),
    [
        (lambda: result_of("topple"), 407),
        (lambda: result_of("bench"), 455),
        (lambda: sk.run(BOLTED), 282),
        (lambda: sk.prob(path_of("wedge-scatter"), n=500), 270),
    ],
    ids=["topple", "bench", "bolted", "prob"],
)
def test_a_sheet_has_half_the_words_that_it_had(study, most) -> None:
    """815, 911, 564 and 541 words once; a wedge's 120 are counted with the command (`tests/test_cli.py`)."""
    assert 100 < len(str(study().sheet).split()) <= most


def tables(name: str) -> list[Table]:
    sheet = shown(name).sheet
    return [one for section in sheet.sections for one in section.content if isinstance(one, Table)]


def is_rounded(text: str, value: float) -> bool:
    """Whether a text is a number to the digits that it has, which may be a share in per cent."""
    found = NUMBER.findall(text)
    if len(found) != 1:
        return False
    digits, _, exponent = found[0].lower().partition("e")
    half = 0.5000001 * 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
    scaled = value * 100.0 if text.endswith("%") else value
    return math.isclose(float(found[0]), scaled, rel_tol=1e-9, abs_tol=half)


class Cells(HTMLParser):
    """The cells of every row of every table."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.inside = False
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.inside = True
            self.rows[-1].append("")

    def handle_endtag(self, tag) -> None:
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data) -> None:
        if self.inside:
            self.rows[-1][-1] += data


@pytest.mark.parametrize("name", [*names(), SWEEP])
def test_what_is_shown_is_the_number_that_json_has(name) -> None:
    found = tables(name)
    assert found
    for table in found:
        record = json.loads(json.dumps(table.to_dict(), allow_nan=False))
        assert record == table.to_dict()
        for row, texts in zip(record["rows"], record["shown"], strict=True):
            assert len(row) == len(texts) == len(record["columns"])
            for value, text in zip(row, texts, strict=True):
                if isinstance(value, float | int) and not isinstance(value, bool):
                    assert is_rounded(text.removesuffix(" now").rstrip("°"), value), (text, value)


@pytest.mark.parametrize("name", [*names(), SWEEP])
def test_text_has_the_cells_of_the_table_or_numbers_of_its_section(name) -> None:
    for section in shown(name).sheet.sections:
        own = [one for one in section.content if isinstance(one, Table)]
        known = {number for table in own for number in numbers(table)}
        for table in own:
            if table.said is None:
                cells_stand_in_lines(table)
            for one in NUMBER.findall(LEFT_OUT.sub("", table.said or "")):
                assert any(is_rounded(one, value) for value in known), (one, table.said)


def numbers(table: Table) -> set[float]:
    """Every number of a table, those in its words and heads too."""
    record = table.to_dict()
    cells = [cell for row in record["rows"] for cell in row] + [
        one["title"] for one in record["columns"]
    ]
    found = {float(one) for text in cells if isinstance(text, str) for one in NUMBER.findall(text)}
    return found | {float(one) for one in cells if isinstance(one, float | int)}


def cells_stand_in_lines(table: Table) -> None:
    """Each line of text has the cells of its row, in their order, and there are no other lines."""
    in_text = [one.width != 0 for one in table.columns if one.width or one.title]
    cells = [
        [cell for cell, here in zip(row, in_text, strict=True) if here and cell]
        for row in table.to_dict()["shown"]
    ]
    lines = table.lines()[0 if table.headless else 1 :]
    if table.ends and table.left_out:
        cells[table.ends[0] : -table.ends[1]] = []
        assert lines.pop(table.ends[0]) == table.rest
    elif table.rest and not table.ends:
        assert lines.pop() == table.rest
    for row, line in zip(cells, lines, strict=True):
        assert re.search(".*?".join(map(re.escape, row)), line), (row, line)


def head_of(column: dict[str, Any]) -> str:
    """A number in a notebook has its unit above it."""
    return (
        f"{column['title']} / {column['unit']}"
        if column["unit"] not in column["title"]
        else column["title"]
    )


@pytest.mark.parametrize("name", [*names(), SWEEP])
def test_html_has_the_cells_of_the_table(name) -> None:
    one = shown(name)
    rows = Cells(one.sheet._repr_html_()).rows
    wanted = [
        row
        for table in tables(name)
        for row in ([head_of(c) for c in table.to_dict()["columns"]], *table.to_dict()["shown"])
    ]
    assert rows == wanted
    pytest.importorskip("jinja2")
    page = [
        [cell for cell in row if cell]
        for row in Cells(report_of(one.to_dict(), with_pictures=False).html).rows
    ]
    for row in (row for table in tables(name) for row in table.to_dict()["shown"]):
        assert [cell for cell in row if cell] in page


@pytest.mark.parametrize("name", [*names(), SWEEP])
def test_csv_and_records_have_every_row(name) -> None:
    one = shown(name)
    for table in one.tables().values():
        records, rows = table.records(), list(csv.DictReader(io.StringIO(table.csv())))
        assert len(records) == len(rows) == len(table.rows)
        exact = {column.key: column.exact for column in table.columns}
        for record, row in zip(records, rows, strict=True):
            assert list(record) == list(row)
            for key, value in record.items():
                if isinstance(value, float):
                    assert is_rounded(row[key], value) if exact[key] else float(row[key]) == value
                elif not isinstance(value, list):
                    assert row[key] == ("" if value is None else str(value))


def test_a_result_shows_itself() -> None:
    result = shown("wedge")
    assert (
        repr(result) == f"<Result: {result.line}>" == "<Result: slides_on_both  1.557  agree  met>"
    )
    assert str(result) == str(result.sheet)
    assert list(result.to_dict())[-1] == "sheet"
    assert [name for name in dir(sk) if name.startswith("_")] == ["__version__"]
    assert isinstance(result, sk.Result)


class Bare(Report):
    """Something that is shown and has no table."""

    sheet = Sheet("bare", (Section("WORD", ["nothing but a word"]),))
    line = "bare"

    def to_dict(self) -> dict:
        return {}


def test_data_frames(monkeypatch) -> None:
    """With a pandas of our own: what is asked of it; without any, and without a table, codes that say so."""

    class Pandas:
        @staticmethod
        def DataFrame(records, columns):
            return [[record[key] for key in columns] for record in records]

    monkeypatch.setitem(__import__("sys").modules, "pandas", Pandas)
    frames = shown("wedge").to_frames()
    assert frames["fos"][0][0] == shown("wedge").fos.limit
    result = shown("wedge")
    assert next(iter(frames)) == "result"
    (leading,) = result.to_frame()
    assert leading[:4] == ["wedge", result.status, result.fos.limit, result.fos.closed_form]
    assert {"forces", "fos"} < set(frames)
    with pytest.raises(sk.DesignError) as caught:
        Bare().to_frame()
    assert caught.value.codes == ("E273",)
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(sk.DesignError) as caught:
        shown("wedge").to_frames()
    assert caught.value.codes == ("E140",)


def test_ends_and_what_stands_about_a_cell() -> None:
    columns = (
        Column("n", int, "n", width=3),
        Column("square", lambda n: n * n, width=1, about=" = {}"),
    )
    table = Table(columns, range(1, 8), ends=(2, 1), rest="... 4 more")
    assert table.lines() == ["  n = square", "  1 = 1", "  2 = 4", "... 4 more", "  7 = 49"]
    assert table.to_dict()["rows"] == [[n, n * n] for n in range(1, 8)]
    assert table.to_dict()["rest"] == ""
    short = Table(columns, range(1, 5), ends=(2, 1), rest="... 1 more")
    assert len(short.lines()) == 5
    assert Table(columns, [1], said="one squared is 1").lines() == ["one squared is 1"]
    assert Table(columns, [1], said="").lines() == []
