"""Tables for spreadsheets: what a joint is called must not be worked out as a formula."""

import csv
import io

import pytest

from slopekit.core.sheet import Column, Table


@pytest.mark.parametrize("name", ["=cmd|' /C calc'!A0", "+1+1", "-2+3", "@SUM(A1)", "\t=1"])
def test_a_name_is_no_formula_in_a_table_for_spreadsheets(name) -> None:
    table = Table(
        (Column("", lambda row: row[0], "name"), Column("", lambda row: row[1], "value")),
        [(name, -1.5)],
    )
    rows = list(csv.reader(io.StringIO(table.csv(), newline="")))
    assert rows == [["name", "value"], [f"'{name}", "-1.5"]]
    assert Table((Column("", lambda row: row, "name"),), ["-45"]).csv() == "name\n-45\n"
