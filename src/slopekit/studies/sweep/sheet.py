"""The sheet of a sweep: a curve as a table, a grid as a matrix; both with all their points."""

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from operator import itemgetter
from typing import Any, TypeAlias

from slopekit.core.orientation import number
from slopekit.core.sheet import LABEL, WIDTH, Column, Entry, Section, Sheet, Table, counted, factor_text, is_number
from slopekit.evidence import WithoutBasal
from slopekit.studies.keys import Key, in_words
from slopekit.studies.points import Method, Point, factor_at
from slopekit.studies.sweep.run import Sweep
from slopekit.studies.words import METHODS, cell, check_word, status_words, study_sheet

_CELL = 9
_BRIEFLY = {
    "slides_on_both": "both", "no_driving_force": "stands", "not_converged": "no conv", "slides_on_basal": "basal",
    "slides_on_J1_and_J2": "J1, J2", "slides_on_J1_and_basal": "J1, B", "slides_on_J2_and_basal": "J2, B",
}  # fmt: skip


def sheet_of(swept: Sweep) -> Sheet:
    """The sheet of a sweep."""
    keys = [
        f"{in_words(key)}; {key.shown(min(values), 6)} to {key.shown(max(values), 6)}, {counted(len(values), 'value')}"
        for key, values in zip(swept.keys, swept.values, strict=True)
    ]
    one = len(swept.keys) == 1
    return study_sheet(swept.design, "sweep", (
        *(Section("KEY", [text]) for text in keys),
        Section("CURVE", [_curve(swept)]) if one else Section("GRID", _grid(swept), hang=0),
        Section("PASSES", _critical(swept) if one else []),
        Section("COUNTED", [_counted(swept)]),
        Section("REASONS", _reasons(swept)),
        Section("TIME", [f"{swept.seconds:.2f} s"]),
        Section("NOTE", [str(notice) for notice in swept.warnings]),
    ), {"sweep.csv": _every_point(swept)})  # fmt: skip


def line_of(swept: Sweep) -> str:
    """Points, factors between which they lie, disagreements and notices on one line."""
    parts = [counted(len(swept.points), "point")]
    for method in swept.asked:
        factors = [f for p in swept.points if (f := factor_at(p, method)) is not None and is_number(f)]
        span = f"{factor_text(min(factors)).strip()} to {factor_text(max(factors)).strip()}" if factors else "none"
        parts.append(f"{METHODS[method]} {span}")
    if len(swept.asked) > 1:
        parts.append(f"{swept.disagree} disagree" if swept.disagree else "agree")
    return "  ".join([*parts, *dict.fromkeys(notice.code for notice in swept.warnings)])


def _every_point(swept: Sweep) -> Table[dict[str, Any]]:
    """Every point on a line of its own."""
    columns: list[Column[dict[str, Any]]] = [
        Column(key.path, itemgetter(key.path), f"{key.path}{_unit(key)}", key.unit, exact=key.in_csv)
        for key in swept.keys
    ]
    columns += [Column(name, itemgetter(name), name) for name in Point(None).to_dict()]
    also = next((one.also for one in swept.points if one.also), None)
    if also is not None:
        columns.append(Column(also.BRIEF, lambda row: row.get(also.NAME, {}).get("closed_form"), also.NAME))
    paths = [key.path for key in swept.keys]
    rows = [
        dict(zip(paths, place, strict=True)) | point.to_dict()
        for place, point in zip(swept.places, swept.points, strict=True)
    ]
    return Table(columns, rows)


# -- a curve ----------------------------------------------------------------------------------------------------------


def _curve(swept: Sweep) -> Table[dict[str, Any]]:
    """The points of a curve: values, statuses, factors by each method, and what these make of each other."""
    key, (_, points) = swept.keys[0], swept.lines()[0]
    statuses = [swept.status(point) for _, point in points]
    title = key.path if len(key.path) <= 21 else "…" + key.path[-20:]
    known = next((one.also for _, one in points if one.also), None)
    least, before = (17, "   ") if known is None else (9, " ")  # with a column more the lines are as long
    width = max([least, *(len(status) for status in statuses if status.startswith("slides_on_"))])
    columns: list[Column[dict[str, Any]]] = [
        Column(title, "value", key.path, key.unit,
               lambda value: key.shown(value, 8) + (" now" if value == key.value else ""), -21),
        Column("", "changed", "changed", show=lambda changed: ">" if changed else "", width=-2),
        Column("status", "status", "status", width=-width),
        *(Column(METHODS[method], method, method, show=_factor_text, width=12) for method in swept.asked),
    ]  # fmt: skip
    if known is not None:
        columns.append(Column(known.BRIEF, known.NAME, known.NAME, show=_factor_text, width=12))
    if len(swept.asked) > 1:
        columns.append(Column(f"{before}check", "check", "check", width=-1, text=lambda row: before + row["check"]))
    rows = [
        {"value": value, "changed": status != previous, "status": _reason(point) or status, "check": check_word(point)}
        | {method: _factor_or_none(point, method) for method in swept.asked}
        | ({} if point.also is None else {point.also.NAME: _also(point.also)})
        for (value, point), status, previous in zip(points, statuses, [statuses[0], *statuses], strict=False)
    ]
    return Table(columns, rows)


def _reason(point: Point) -> str:
    """Why there is no block; empty where there is one."""
    reason = textwrap.shorten(f"{point.code} {point.message}", WIDTH - LABEL - 23, placeholder=" …")
    return reason if point.factors is None else ""


def _factor_or_none(point: Point, method: Method) -> float | str | None:
    """The factor by a method, `none` where the block has none, nothing where there is no block."""
    if point.factors is None:
        return None
    factor = factor_at(point, method)
    return factor if is_number(factor) else "none"


def _also(also: WithoutBasal) -> float | str:
    """The factor of what acceptance is held against besides, or how it moves without one."""
    return also.in_words() if also.factor is None else also.factor


def _factor_text(factor: float | str | None) -> str:
    return factor_text(factor).strip() if isinstance(factor, float) else factor or ""


# -- a grid -----------------------------------------------------------------------------------------------------------


def _grid(swept: Sweep) -> list[Entry]:
    """Factors by the method that counts; columns are the first key, rows the second."""
    (first, second), method, lines = swept.keys, swept.asked[0], swept.lines()
    across = [value for value, _ in lines[0][1]]
    rows = sorted(lines, key=lambda line: line[0] or 0.0)
    down = [value for value, _ in rows if value is not None]
    heads, labels = _headings(across), dict(zip(down, _headings(down), strict=True))
    width, wide = max(_CELL - 1, *map(len, heads)) + 1, max(12, *map(len, labels.values()))
    many = (WIDTH - LABEL - wide - 2) // width
    entries: list[Entry] = [f"{METHODS[method]}; across {first.path}{_unit(first)}, down {second.path}{_unit(second)}"]
    for begin in range(0, len(across), many):
        columns: list[Column[_Line]] = [Column("", itemgetter(0), show=labels.__getitem__, width=wide)]
        columns += [_across(swept, method, k, heads[k], width) for k in range(len(across))[begin : begin + many]]
        entries.append(Table(columns, rows))
    if any(point.moments_govern for point in swept.points):
        entries.append("* moments govern")
    known = next((one.also for one in swept.points if one.also), None)
    if known is not None:
        entries.append(f"of what is analysed, not of {known.WHAT}: W507 says where that falls short")
    if swept.disagree:
        entries.append("! the methods disagree, or no convergence")
    return entries


#: Of a grid: the value of the second key, and the points by the first.
_Line: TypeAlias = tuple[float | None, list[tuple[float, Point]]]


def _across(swept: Sweep, method: Method, k: int, head: str, width: int) -> Column[_Line]:
    """The points of a grid at one value of the first key."""

    def cell_of(line: _Line) -> float | str:
        factor, status = factor_at(line[1][k][1], method), swept.status(line[1][k][1])
        return factor if factor is not None and is_number(factor) else _BRIEFLY.get(status, status)[: _CELL - 2]

    def marked(line: _Line) -> str:
        content, point = cell_of(line), line[1][k][1]
        text = cell(content) if isinstance(content, float) else content
        return f"{text:>{width - 1}}{'!' if point.is_in_doubt else '*' if point.moments_govern else ' '}"

    return Column(head, cell_of, width=width, text=marked)


def _headings(values: Sequence[float]) -> list[str]:
    """Write values as briefly as tells them apart: rounded by 2 % of themselves and of the least step at most.

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


# -- what it comes to -------------------------------------------------------------------------------------------------


def _critical(swept: Sweep) -> list[str]:
    critical = swept.critical
    entries = []
    for level, what in swept.levels:
        own = [one for one in critical if one["fos"] == level]
        if not own:
            entries.append(f"{what}: not crossed between neighbouring points")
        entries += list(_together(swept, what, own))
    if any(one["at"] is not None and one["how"] != "at a point" for one in critical):
        entries.append(f"interpolated values are rough: slopekit solve finds {swept.keys[0].path} to every digit")
    return entries


def _together(swept: Sweep, what: str, critical: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Each place once, with the methods that pass the level there alike."""
    said: dict[str, list[str]] = {}
    for one in critical:
        said.setdefault(_passed(swept, one), []).append(METHODS[one["method"]])
    for text, methods in said.items():
        yield f"{what}: {text}, by {' and '.join(methods)}"


def _passed(swept: Sweep, one: Mapping[str, Any]) -> str:
    key, at, how = swept.keys[0], one["at"], one["how"]
    a, b = (key.shown(end, 6) for end in one["between"])
    if at is None:
        return f"between {a} and {b}, {how}"
    return f"{key.shown(at, 5)}, {how if how == 'at a point' else f'{how} between {a} and {b}'}"


def _counted(swept: Sweep) -> str:
    parts = ", ".join(f"{status_words(swept.design, name)} {count}" for name, count in swept.counts.items())
    end = f"; {swept.disagree} disagree or did not converge" if len(swept.asked) > 1 or swept.disagree else ""
    return f"{counted(len(swept.points), 'point')}: {parts}{end}"


def _reasons(swept: Sweep) -> list[str]:
    """The first message of each code, for points without a block."""
    reasons: dict[str, str] = {}
    for place, point in zip(swept.places, swept.points, strict=True):
        if point.factors is None:
            at = ", ".join(key.shown(value, 6) for key, value in zip(swept.keys, place, strict=True))
            reasons.setdefault(point.code, f"{point.code} at {at}: {point.message}")
    return list(reasons.values())
