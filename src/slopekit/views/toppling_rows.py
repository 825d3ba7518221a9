"""Goodman & Bray's table of columns on the sheet."""

from collections.abc import Sequence

import numpy as np

from slopekit.findings import Column
from slopekit.kinds.words import first_and_last, names_in_runs
from slopekit.result import Result
from slopekit.views.entries import factor_text

_MOST_ROWS, _FIRST_ROWS, _LAST_ROWS = 40, 20, 10


def toppling_rows(result: Result, table: Sequence[Column]) -> list[str]:
    """Goodman & Bray's rows from the highest column down to the toe, with PRE-IE's mode beside theirs."""
    if not table:
        return []
    factor = result.fos.limit or result.fos.closed_form
    at = f"strength divided by {factor_text(factor)}" if factor else "strength as given"
    by_number = sorted(table, key=lambda column: column.n)
    rows = [_row(column) for column in reversed(by_number)]
    shown, between, last = (rows, 0, ()) if len(rows) <= _MOST_ROWS else first_and_last(rows, _FIRST_ROWS, _LAST_ROWS)
    entries = [
        f"Goodman & Bray's columns, {at}; y, M, L in m, P in kN (R and S on the bases: --json)",
        f"{'n':>4}{'y':>8}{'M':>8}{'L':>8}{'P_topple':>12}{'P_slide':>12}{'P':>12}  {'mode':<7} | PRE-IE",
        *shown,
    ]
    if between:
        entries.append(f" ... {between} columns left out here (--json has them) ...")
    alike = sum(column.mode == column.mode_preie for column in table)
    different = [f"C{column.n}" for column in by_number if column.mode != column.mode_preie]
    where = f"; not in {names_in_runs(different)}" if different else ""
    words = f"the modes are the same in {alike} of {len(table)} columns{where}"
    unbounded = any(abs(value) == np.inf for column in table for value in (column.p_topple, column.p_slide) if value)
    note = ["∞: with sides that rough no force between two columns makes a difference"] if unbounded else []
    return [*entries, *last, words, *note]


def _row(column: Column) -> str:
    lengths = "".join(f"{_cell(value, 2):>8}" for value in (column.y, column.m, column.l))
    forces = "".join(f"{_cell(value, 2):>12}" for value in (column.p_topple, column.p_slide, column.p))
    differs = "" if column.mode == column.mode_preie else "  <"
    return f"{column.n:>4}{lengths}{forces}  {column.mode:<7} | {column.mode_preie}{differs}"


def _cell(value: float | None, digits: int) -> str:
    if value is None or np.isnan(value):
        return "-"
    if np.isinf(value):
        return "∞" if value > 0.0 else "-∞"
    return f"{value:.{digits}f}" if abs(value) < 1e8 else f"{value:.5g}"
