"""The sheet of a value that was solved for: what both methods say there, other values, or why there is none."""

from collections.abc import Sequence
from operator import itemgetter
from typing import Any

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Section, Sheet, Table, factor_text
from slopekit.design.common import Design
from slopekit.studies.keys import Key, in_words
from slopekit.studies.points import UNSETTLED, Point
from slopekit.studies.solve.solutions import Solution, SolvedValue, shown
from slopekit.studies.words import status_words, study_sheet

_MOST_REFUSED = 6


def sheet_of(solution: Solution) -> Sheet:
    """The sheet of a value that was solved for."""
    values = _values(solution)
    return study_sheet(solution.design, "solve", (
        Section("KEY", [_asked(solution.key, solution.within)]),
        *_sections(solution),
        Section("VALUES", [values] if values.rows else []),
        Section("TIME", [f"{solution.seconds:.2f} s"]),
        Section("NOTE", [str(notice) for notice in solution.warnings]),
    ), {"solve.csv": values})  # fmt: skip


def line_of(solution: Solution) -> str:
    """The value, what it gives, and codes of notices on one line."""
    if solution.answer is None:
        parts = ["none", str(solution.reason).splitlines()[0]]
    else:
        answer, agree = solution.answer, {True: "agree", False: "disagree", None: "not compared"}[solution.agree]
        parts = [solution.key.shown(answer.value), answer.status, factor_text(answer.factor).strip(), agree]
        parts += ["moments_govern"] if solution.moments_govern else []
    return "  ".join([*parts, *dict.fromkeys(notice.code for notice in solution.warnings)])


def _sections(solution: Solution) -> tuple[Section, ...]:
    """Return the target, the value and what both methods say of it."""
    from_rule = " (the design's acceptance rule)" if solution.from_acceptance else ""
    return (
        Section("TARGET", [f"FoS {number(solution.target)}{from_rule}"]),
        Section("NOW", [_now(solution.design, solution.before)]),
        Section("VALUE", _value(solution)),
        Section("REFUSED", _refused(solution.key, (solution.closed_form or solution.pre_ie).refused, False)),
        Section("UNSETTLED", _refused(solution.key, solution.pre_ie.refused, True)),
    )


# -- tables: what the entries say, in rows; text has the entries -----------------------------------------------------


def _values(solution: Solution) -> Table[Any]:
    """Every value by each method: roots, then jumps and gaps; the one nearest to the present value first."""
    key, other = solution.key, {"pre_ie": "closed_form", "closed_form": "limit"}
    rows = [
        (answers.method, crossing)
        for answers in (solution.pre_ie, solution.closed_form)
        if answers is not None
        for crossing in (*answers.roots, *answers.others)
    ]
    columns: list[Column[tuple[str, SolvedValue]]] = [
        Column("method", itemgetter(0), "method"),
        Column(key.path, lambda row: key.reduced(row[1].value), key.path, key.unit, key.shown, exact=key.in_csv),
        Column("FoS", lambda row: row[1].factor, "fos", show=shown),
        Column("status", lambda row: row[1].status, "status"),
        Column("how", lambda row: row[1].how, "how"),
        Column("FoS with it", lambda row: "rises" if row[1].rises else "falls", "fos_with_it"),
        Column(
            "other method",
            lambda row: getattr(row[1].both.factors, other[row[0]], None),
            "fos_other_method",
            show=".6f",
        ),
    ]
    return Table(columns, rows, said="")


# -- entries -----------------------------------------------------------------------------------------------------------


def _asked(key: Key, within: tuple[float, float]) -> str:
    if key.period is not None and within[1] - within[0] >= key.period:
        return f"{in_words(key)}; looked for all round"
    return f"{in_words(key)}; looked for from {key.shown(within[0], 7)} to {key.shown(within[1], 7)}"


def _now(design: Design, point: Point) -> str:
    factors = point.factors
    if factors is None:
        return f"no block: {point.code} {point.message}"
    closed = "" if factors.closed_form is None else f"   {factor_text(factors.closed_form)} closed form"
    govern = "   moments govern" if factors.moments_govern else ""
    return f"{status_words(design, factors.status)}   {factor_text(factors.limit)} PRE-IE{closed}{govern}"


def _value(solution: Solution) -> list[str]:
    key, answer = solution.key, solution.answer
    if answer is None:
        reason = solution.pre_ie.reason
        return ["none"] if reason is None else [f"none. {reason.code} {reason.message}", *filter(None, [reason.advice])]
    way = "rises" if answer.rises else "falls"
    was = "" if key.value is None else f", {_change(key, answer.value)}"
    verdict = {True: "AGREE", False: "DISAGREE", None: "not compared"}[solution.agree]
    return [
        f"{key.shown(answer.value)}{was}; {status_words(solution.design, answer.status)}; FoS {way} with it",
        f"the methods there: {verdict}{', moments govern' if solution.moments_govern else ''}",
    ]


def _change(key: Key, value: float) -> str:
    if key.value is None or value == key.value:
        return "as it is now"
    off = value - key.value
    is_size = key.kind != "angle" and not key.is_place
    share = f" ({off / key.value * 100:+.3g} %)" if key.value and is_size else ""
    unit = key.unit if key.unit in ("", "°") else f" {key.unit}"
    return f"{off:+.6g}{unit}{share} from now"


def _refused(key: Key, stretches: Sequence[tuple[float, float, str, str]], unsettled: bool) -> list[str]:
    """Stretches of values that are refused, or those at which PRE-IE did not converge: they are no wrong input."""
    entries, ours = [], [one for one in stretches if (one[2] == UNSETTLED) == unsettled]
    for low, high, code, message in ours[:_MOST_REFUSED]:
        ends = key.shown(low, 7)
        ends += f" to {key.shown(high, 7)}" if high > low else ""
        entries.append(f"{ends}: {message if unsettled else f'{code} {message}'}".rstrip())
    if len(ours) > _MOST_REFUSED:
        entries.append(f"… {len(ours) - _MOST_REFUSED} more stretches, see the JSON")
    return entries
