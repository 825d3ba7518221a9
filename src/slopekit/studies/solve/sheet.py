"""The sheet of a solve study: the value, both methods there, further values, or the reason for none."""

from collections.abc import Sequence
from operator import itemgetter
from typing import Any

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Section, Sheet, Table, factor_text
from slopekit.design.common import Design
from slopekit.studies.keys import Key, in_words
from slopekit.studies.points import UNSETTLED, Point
from slopekit.studies.solve.solutions import Solution, SolvedValue, factor_in_words
from slopekit.studies.words import status_words, study_sheet

_MOST_REFUSED = 6


def sheet_of(solution: Solution) -> Sheet:
    """Return the sheet of a solve study."""
    values = _values(solution)
    return study_sheet(
        solution.design,
        "solve",
        (
            Section("KEY", [_key_text(solution.key, solution.within)]),
            *_sections(solution),
            Section("VALUES", [values] if values.rows else []),
            Section("TIME", [f"{solution.seconds:.2f} s"]),
            Section("NOTE", [str(notice) for notice in solution.warnings]),
        ),
        {"solve.csv": values},
    )


def line_of(solution: Solution) -> str:
    """Return the value, its status and factor, and the codes of notices on one line."""
    if solution.answer is None:
        entries = ["none", str(solution.reason).splitlines()[0]]
    else:
        answer, agree = (
            solution.answer,
            {True: "agree", False: "disagree", None: "not compared"}[solution.agree],
        )
        entries = [
            solution.key.value_text(answer.value),
            answer.status,
            factor_text(answer.factor).strip(),
            agree,
        ]
        entries += ["moments_govern"] if solution.moments_govern else []
    return "  ".join([*entries, *dict.fromkeys(notice.code for notice in solution.warnings)])


def _sections(solution: Solution) -> tuple[Section, ...]:
    """Return the sections of the target, the value, and values that are refused or unsettled."""
    from_rule = " (the design's acceptance rule)" if solution.from_acceptance else ""
    return (
        Section("TARGET", [f"FoS {number(solution.target)}{from_rule}"]),
        Section("NOW", [_present_state(solution.design, solution.before)]),
        Section("VALUE", _value(solution)),
        Section(
            "REFUSED",
            _refused(solution.key, (solution.closed_form or solution.pre_ie).refused, False),
        ),
        Section("UNSETTLED", _refused(solution.key, solution.pre_ie.refused, True)),
    )


# -- table for CSV and JSON; the text has entries -----------------------------------------------------


def _values(solution: Solution) -> Table[Any]:
    """Return the table of all solutions by each method: roots, then jumps and gaps."""
    key, other_fields = solution.key, {"pre_ie": "closed_form", "closed_form": "limit"}
    rows = [
        (answers.method, crossing)
        for answers in (solution.pre_ie, solution.closed_form)
        if answers is not None
        for crossing in (*answers.roots, *answers.others)
    ]
    columns: list[Column[tuple[str, SolvedValue]]] = [
        Column("method", itemgetter(0), "method"),
        Column(
            key.path,
            lambda row: key.reduced(row[1].value),
            key.path,
            key.unit,
            key.value_text,
            exact=key.in_csv,
        ),
        Column("FoS", lambda row: row[1].factor, "fos", show=factor_in_words),
        Column("status", lambda row: row[1].status, "status"),
        Column("how", lambda row: row[1].how, "how"),
        Column("FoS with it", lambda row: "rises" if row[1].rises else "falls", "fos_with_it"),
        Column(
            "other method",
            lambda row: getattr(row[1].both.factors, other_fields[row[0]], None),
            "fos_other_method",
            show=".6f",
        ),
    ]
    return Table(columns, rows, said="")


# -- entries -----------------------------------------------------------------------------------------------------------


def _key_text(key: Key, search_range: tuple[float, float]) -> str:
    if key.period is not None and search_range[1] - search_range[0] >= key.period:
        return f"{in_words(key)}; looked for all round"
    return (
        f"{in_words(key)}; looked for from {key.value_text(search_range[0], 7)} "
        f"to {key.value_text(search_range[1], 7)}"
    )


def _present_state(design: Design, point: Point) -> str:
    factors = point.factors
    if factors is None:
        return f"no block: {point.code} {point.message}"
    closed = (
        "" if factors.closed_form is None else f"   {factor_text(factors.closed_form)} closed form"
    )
    govern = "   moments govern" if factors.moments_govern else ""
    return f"{status_words(design, factors.status)}   {factor_text(factors.limit)} PRE-IE{closed}{govern}"


def _value(solution: Solution) -> list[str]:
    key, answer = solution.key, solution.answer
    if answer is None:
        reason = solution.pre_ie.reason
        return (
            ["none"]
            if reason is None
            else [f"none. {reason.code} {reason.message}", *filter(None, [reason.advice])]
        )
    way = "rises" if answer.rises else "falls"
    was = "" if key.value is None else f", {_change(key, answer.value)}"
    verdict = {True: "AGREE", False: "DISAGREE", None: "not compared"}[solution.agree]
    return [
        f"{key.value_text(answer.value)}{was}; {status_words(solution.design, answer.status)}; FoS {way} with it",
        f"the methods there: {verdict}{', moments govern' if solution.moments_govern else ''}",
    ]


def _change(key: Key, value: float) -> str:
    if key.value is None or value == key.value:
        return "as it is now"
    difference = value - key.value
    is_size = key.kind != "angle" and not key.is_place
    share = f" ({difference / key.value * 100:+.3g} %)" if key.value and is_size else ""
    unit = key.unit if key.unit in ("", "°") else f" {key.unit}"
    return f"{difference:+.6g}{unit}{share} from now"


def _refused(
    key: Key, stretches: Sequence[tuple[float, float, str, str]], unsettled: bool
) -> list[str]:
    """Return stretches of values that are refused, or those at which PRE-IE did not converge, in words."""
    entries, chosen = (
        [],
        [stretch for stretch in stretches if (stretch[2] == UNSETTLED) == unsettled],
    )
    for low, high, code, message in chosen[:_MOST_REFUSED]:
        ends = key.value_text(low, 7)
        ends += f" to {key.value_text(high, 7)}" if high > low else ""
        entries.append(f"{ends}: {message if unsettled else f'{code} {message}'}".rstrip())
    if len(chosen) > _MOST_REFUSED:
        entries.append(f"… {len(chosen) - _MOST_REFUSED} more stretches, see the JSON")
    return entries
