"""The sheet of a sweep: a curve as a table, a grid as a matrix, and a table of all points."""

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from operator import itemgetter
from typing import Any, TypeAlias

from slopekit.core.orientation import number
from slopekit.core.sheet import (
    LABEL,
    WIDTH,
    Column,
    Entry,
    Section,
    Sheet,
    Table,
    counted,
    factor_text,
    is_number,
)
from slopekit.evidence import WithoutBasal
from slopekit.studies.keys import Key, in_words
from slopekit.studies.points import Method, Point, factor_at
from slopekit.studies.sweep.run import Sweep
from slopekit.studies.words import METHODS, cell, check_word, status_words, study_sheet

_CELL_WIDTH = 9
_SHORT_STATUS = {
    "slides_on_both": "both",
    "no_driving_force": "stands",
    "not_converged": "no conv",
    "slides_on_basal": "basal",
    "slides_on_J1_and_J2": "J1, J2",
    "slides_on_J1_and_basal": "J1, B",
    "slides_on_J2_and_basal": "J2, B",
}


def sheet_of(swept: Sweep) -> Sheet:
    """Return the sheet of a sweep."""
    keys = [
        f"{in_words(key)}; {key.value_text(min(values), 6)} to {key.value_text(max(values), 6)}, "
        f"{counted(len(values), 'value')}"
        for key, values in zip(swept.keys, swept.values, strict=True)
    ]
    is_curve = len(swept.keys) == 1
    return study_sheet(
        swept.design,
        "sweep",
        (
            *(Section("KEY", [text]) for text in keys),
            Section("CURVE", [_curve(swept)])
            if is_curve
            else Section("GRID", _grid(swept), hang=0),
            Section("PASSES", _critical(swept) if is_curve else []),
            Section("COUNTED", [_counts_of_statuses(swept)]),
            Section("REASONS", _reasons(swept)),
            Section("TIME", [f"{swept.seconds:.2f} s"]),
            Section("NOTE", [str(notice) for notice in swept.warnings]),
        ),
        {"sweep.csv": _every_point(swept)},
    )


def line_of(swept: Sweep) -> str:
    """Return the number of points, the range of factors, disagreements and codes of notices on one line."""
    entries = [counted(len(swept.points), "point")]
    for method in swept.asked:
        factors = [
            f for p in swept.points if (f := factor_at(p, method)) is not None and is_number(f)
        ]
        span = (
            f"{factor_text(min(factors)).strip()} to {factor_text(max(factors)).strip()}"
            if factors
            else "none"
        )
        entries.append(f"{METHODS[method]} {span}")
    if len(swept.asked) > 1:
        entries.append(f"{swept.disagree} disagree" if swept.disagree else "agree")
    return "  ".join([*entries, *dict.fromkeys(notice.code for notice in swept.warnings)])


def _every_point(swept: Sweep) -> Table[dict[str, Any]]:
    """Return the table of all points, one a row, as CSV has it."""
    columns: list[Column[dict[str, Any]]] = [
        Column(
            key.path, itemgetter(key.path), f"{key.path}{_unit(key)}", key.unit, exact=key.in_csv
        )
        for key in swept.keys
    ]
    columns += [Column(name, itemgetter(name), name) for name in Point(None).to_dict()]
    without_basal = next((point.also for point in swept.points if point.also), None)
    if without_basal is not None:
        columns.append(
            Column(
                without_basal.BRIEF,
                lambda row: row.get(without_basal.NAME, {}).get("closed_form"),
                without_basal.NAME,
            )
        )
    paths = [key.path for key in swept.keys]
    rows = [
        dict(zip(paths, place, strict=True)) | point.to_dict()
        for place, point in zip(swept.places, swept.points, strict=True)
    ]
    return Table(columns, rows)


# -- a curve ----------------------------------------------------------------------------------------------------------


def _curve(swept: Sweep) -> Table[dict[str, Any]]:
    """Return the table of a curve: values, statuses, factors by each method, and whether the methods agree."""
    key, (_, points) = swept.keys[0], swept.lines()[0]
    statuses = [swept.status(point) for _, point in points]
    title = key.path if len(key.path) <= 21 else "…" + key.path[-20:]
    without_basal = next((point.also for _, point in points if point.also), None)
    least, indent = (
        (17, "   ") if without_basal is None else (9, " ")
    )  # a narrower status column makes room for the further one
    width = max([least, *(len(status) for status in statuses if status.startswith("slides_on_"))])
    columns: list[Column[dict[str, Any]]] = [
        Column(
            title,
            "value",
            key.path,
            key.unit,
            lambda value: key.value_text(value, 8) + (" now" if value == key.value else ""),
            -21,
        ),
        Column("", "changed", "changed", show=lambda changed: ">" if changed else "", width=-2),
        Column("status", "status", "status", width=-width),
        *(
            Column(METHODS[method], method, method, show=_factor_text, width=12)
            for method in swept.asked
        ),
    ]
    if without_basal is not None:
        columns.append(
            Column(
                without_basal.BRIEF,
                without_basal.NAME,
                without_basal.NAME,
                show=_factor_text,
                width=12,
            )
        )
    if len(swept.asked) > 1:
        columns.append(
            Column(
                f"{indent}check", "check", "check", width=-1, text=lambda row: indent + row["check"]
            )
        )
    rows = [
        {
            "value": value,
            "changed": status != previous,
            "status": _reason(point) or status,
            "check": check_word(point),
        }
        | {method: _factor_or_none(point, method) for method in swept.asked}
        | ({} if point.also is None else {point.also.NAME: _factor_without_basal(point.also)})
        for (value, point), status, previous in zip(
            points, statuses, [statuses[0], *statuses], strict=False
        )
    ]
    return Table(columns, rows)


def _reason(point: Point) -> str:
    """Return the reason why there is no block; empty where there is one."""
    reason = textwrap.shorten(f"{point.code} {point.message}", WIDTH - LABEL - 23, placeholder=" …")
    return reason if point.factors is None else ""


def _factor_or_none(point: Point, method: Method) -> float | str | None:
    """Return the factor by a method, `none` where the block has no factor, None where there is no block."""
    if point.factors is None:
        return None
    factor = factor_at(point, method)
    return factor if is_number(factor) else "none"


def _factor_without_basal(without_basal: WithoutBasal) -> float | str:
    """Return the factor of the wedge without its basal plane, or how it moves where it has none."""
    return without_basal.in_words() if without_basal.factor is None else without_basal.factor


def _factor_text(factor: float | str | None) -> str:
    return factor_text(factor).strip() if isinstance(factor, float) else factor or ""


# -- a grid -----------------------------------------------------------------------------------------------------------


def _grid(swept: Sweep) -> list[Entry]:
    """Return the factors of a grid by the governing method; columns are values of the first key, rows of the second."""
    (first, second), method, lines = swept.keys, swept.asked[0], swept.lines()
    across = [value for value, _ in lines[0][1]]
    rows = sorted(lines, key=lambda line: line[0] or 0.0)
    down = [value for value, _ in rows if value is not None]
    heads, labels = _headings(across), dict(zip(down, _headings(down), strict=True))
    width, label_width = (
        max(_CELL_WIDTH - 1, *map(len, heads)) + 1,
        max(12, *map(len, labels.values())),
    )
    columns_per_table = (WIDTH - LABEL - label_width - 2) // width
    entries: list[Entry] = [
        f"{METHODS[method]}; across {first.path}{_unit(first)}, down {second.path}{_unit(second)}"
    ]
    for begin in range(0, len(across), columns_per_table):
        columns: list[Column[_Line]] = [
            Column("", itemgetter(0), show=labels.__getitem__, width=label_width)
        ]
        columns += [
            _grid_column(swept, method, k, heads[k], width)
            for k in range(len(across))[begin : begin + columns_per_table]
        ]
        entries.append(Table(columns, rows))
    if any(point.moments_govern for point in swept.points):
        entries.append("* moments govern")
    without_basal = next((point.also for point in swept.points if point.also), None)
    if without_basal is not None:
        entries.append(
            f"of what is analysed, not of {without_basal.WHAT}: W507 says where that falls short"
        )
    if swept.disagree:
        entries.append("! the methods disagree, or no convergence")
    return entries


#: A row of a grid: the value of the second key, and the points by the first.
_Line: TypeAlias = tuple[float | None, list[tuple[float, Point]]]


def _grid_column(swept: Sweep, method: Method, k: int, head: str, width: int) -> Column[_Line]:
    """Return the column of a grid at one value of the first key."""

    def cell_of(line: _Line) -> float | str:
        factor, status = factor_at(line[1][k][1], method), swept.status(line[1][k][1])
        return (
            factor
            if factor is not None and is_number(factor)
            else _SHORT_STATUS.get(status, status)[: _CELL_WIDTH - 2]
        )

    def cell_text(line: _Line) -> str:
        content, point = cell_of(line), line[1][k][1]
        text = cell(content) if isinstance(content, float) else content
        return f"{text:>{width - 1}}{'!' if point.is_in_doubt else '*' if point.moments_govern else ' '}"

    return Column(head, cell_of, width=width, text=cell_text)


def _headings(values: Sequence[float]) -> list[str]:
    """Write values with the fewest decimals: rounded by at most 2 % of themselves and of the least step.

    >>> _headings([20.0, 21.818181818, 23.636363636]), _headings([4000123.457, 4000123.462]), _headings([2e-05, 0.5])
    (['20', '21.8', '23.6'], ['4000123.457', '4000123.462'], ['2e-05', '0.5'])
    """
    least = min((b - a for a, b in pairwise(sorted(set(values)))), default=0.0)
    texts = (
        rounded
        for rounded in ([round(value, digits) for value in values] for digits in range(16))
        if all(abs(a - b) * 50 <= min(least, abs(b)) for a, b in zip(rounded, values, strict=True))
    )
    return list(map(number, next(texts, values)))


def _unit(key: Key) -> str:
    return f" ({key.unit})" if key.unit else ""


# -- crossings, counts and reasons ------------------------------------------------------------------------------------


def _critical(swept: Sweep) -> list[str]:
    critical = swept.critical
    entries = []
    for level, description in swept.levels:
        crossings = [crossing for crossing in critical if crossing["fos"] == level]
        if not crossings:
            entries.append(f"{description}: not crossed between neighbouring points")
        entries += list(_crossing_texts(swept, description, crossings))
    if any(crossing["at"] is not None and crossing["how"] != "at a point" for crossing in critical):
        entries.append(
            f"interpolated values are rough: slopekit solve finds {swept.keys[0].path} to every digit"
        )
    return entries


def _crossing_texts(
    swept: Sweep, description: str, critical: Sequence[Mapping[str, Any]]
) -> Iterator[str]:
    """Yield each crossing of a level once, with all methods that have it at the same values."""
    methods_by_text: dict[str, list[str]] = {}
    for crossing in critical:
        methods_by_text.setdefault(_crossing_text(swept, crossing), []).append(
            METHODS[crossing["method"]]
        )
    for text, methods in methods_by_text.items():
        yield f"{description}: {text}, by {' and '.join(methods)}"


def _crossing_text(swept: Sweep, crossing: Mapping[str, Any]) -> str:
    key, value, basis = swept.keys[0], crossing["at"], crossing["how"]
    a, b = (key.value_text(end, 6) for end in crossing["between"])
    if value is None:
        return f"between {a} and {b}, {basis}"
    return f"{key.value_text(value, 5)}, {basis if basis == 'at a point' else f'{basis} between {a} and {b}'}"


def _counts_of_statuses(swept: Sweep) -> str:
    counts = ", ".join(
        f"{status_words(swept.design, name)} {count}" for name, count in swept.counts.items()
    )
    end = (
        f"; {swept.disagree} disagree or did not converge"
        if len(swept.asked) > 1 or swept.disagree
        else ""
    )
    return f"{counted(len(swept.points), 'point')}: {counts}{end}"


def _reasons(swept: Sweep) -> list[str]:
    """Return the first message of each code, for points without a block."""
    reasons: dict[str, str] = {}
    for place, point in zip(swept.places, swept.points, strict=True):
        if point.factors is None:
            values_text = ", ".join(
                key.value_text(value, 6) for key, value in zip(swept.keys, place, strict=True)
            )
            reasons.setdefault(point.code, f"{point.code} at {values_text}: {point.message}")
    return list(reasons.values())
