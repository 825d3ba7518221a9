"""What every result and study has in common: line, sheet, frames, a notebook's HTML; and how a sheet is written."""

import json
import sys
from dataclasses import dataclass, field
from operator import itemgetter
from typing import Any

import pytest

import slopekit as sk
from slopekit.core.codec import from_json, json_of
from slopekit.core.errors import DesignError
from slopekit.core.sheet import Column, Section, Sheet, Table, sheet_html
from slopekit.design.templates import path_of


@pytest.fixture(scope="module")
def swept() -> Any:
    return sk.sweep(sk.load(path_of("wedge")), {"slope.face.dip": [60, 70]})


def test_a_study_shows_itself_everywhere_with_the_same_numbers(swept) -> None:
    (table,) = (entry for entry in swept.sheet.sections[1].entries if isinstance(entry, Table))
    text, record, page = str(swept), json.loads(json.dumps(swept.to_dict())), swept._repr_html_()
    assert repr(swept) == f"<Sweep: {swept.line}>"
    assert record["line"] == swept.line
    (kept,) = record["sheet"]["CURVE"]
    for row, cells, shown in zip(table.rows, kept["rows"], kept["shown"], strict=True):
        assert cells == [json_of(column.of(row)) for column in table.columns]
        for cell in shown:
            assert cell in text
            assert cell.replace(">", "&gt;") in page
    rows = swept.sheet.tables["sweep.csv"].csv().splitlines()
    assert rows[0].startswith("slope.face.dip (°),")
    assert [float(line.split(",")[0]) for line in rows[1:]] == [60.0, 70.0]


def test_tables_are_data_frames(swept) -> None:
    pandas = pytest.importorskip("pandas")
    frames = swept.to_frames()
    assert list(frames) == ["sweep", "curve"]
    assert frames["curve"]["pre_ie"].tolist() == [point.factors.limit for point in swept.points]
    pandas.testing.assert_frame_equal(swept.to_frame(), frames["sweep"])


def test_without_pandas_it_is_said(swept, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(DesignError, match="need pandas") as caught:
        swept.to_frame()
    assert caught.value.codes == ("E140",)


def test_an_outcome_without_a_table_has_no_frame(monkeypatch, swept) -> None:
    pytest.importorskip("pandas")
    monkeypatch.setattr(type(swept), "tables", lambda self: {})
    with pytest.raises(DesignError) as caught:
        swept.to_frame()
    assert caught.value.codes == ("E273",)


def test_a_sheet_folds_at_a_hundred_columns_and_escapes_html() -> None:
    long = "word " * 40 + "<b>"
    sheet = Sheet("slopekit   demo", (Section("ONE", [long, "two"]), Section("NONE", [])))
    lines = str(sheet).splitlines()
    assert max(map(len, lines)) <= 100
    assert "NONE" not in str(sheet)
    assert [line[:10].strip() for line in lines] == ["slopekit", "ONE", "", "", ""]
    assert "&lt;b&gt;" in sheet_html("head", sheet.to_dict())
    assert "<b>" not in sheet_html("head", sheet.to_dict())


def test_a_table_writes_what_it_holds_and_shows_what_fits() -> None:
    table = Table(
        (
            Column("name", itemgetter(0), "name", width=-6),
            Column("length", itemgetter(1), "length_m", "m", ".1f", 8, ".3f"),
            Column("", itemgetter(1), "exact"),
        ),
        [("a", 1.23456), ("b", None)],
        shown=[("a", 1.23456)],
        rest="1 more",
    )
    assert table.lines() == ["name    length", "a          1.2", "1 more"]
    assert table.csv() == "name,length_m,exact\na,1.235,1.23456\nb,,\n"
    assert table.records() == [
        {"name": "a", "length_m": 1.23456, "exact": 1.23456},
        {"name": "b", "length_m": None, "exact": None},
    ]
    assert table.to_dict()["rows"] == [["a", 1.23456]]


def test_heads_in_a_notebook_have_their_unit() -> None:
    forces = Table(
        [
            Column("force", lambda row: row, "force_kn", "kN"),
            Column("Z / m", lambda row: row, "z_m", "m"),
        ],
        [1.0],
    )
    page = Sheet("a head", (Section("FORCES", [forces]),))._repr_html_()
    assert "<th>force / kN</th><th>Z / m</th>" in page


@dataclass(frozen=True)
class Part:
    """A dataclass in another."""

    low: float
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Whole:
    """What is written to JSON and read again."""

    parts: tuple[Part, ...]
    by_name: dict[str, Part]
    best: Part | None = field(default=None, metadata={"json": "best_m"})
    secret: int = field(default=3, metadata={"json": None})


def test_dataclasses_go_to_json_and_back() -> None:
    whole = Whole((Part(1.0, ("a",)), Part(2.0)), {"x": Part(3.0)}, Part(4.0))
    record = json.loads(json.dumps(json_of(whole)))
    assert set(record) == {"parts", "by_name", "best_m"}
    assert from_json(Whole, record) == whole
    assert json_of(float("inf")) is None
    for wrong in ({"parts": None}, {"parts": [{"low": "x"}], "by_name": {}}):
        with pytest.raises((TypeError, KeyError, ValueError)):
            from_json(Whole, record | wrong)
