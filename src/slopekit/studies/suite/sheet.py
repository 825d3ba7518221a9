"""The verification suite in columns: 100 of a terminal, and those of its page and its CSV."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import attrgetter

from slopekit._version import __version__
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table
from slopekit.studies.suite.references import QUANTITIES
from slopekit.studies.suite.run import Row, Verification

#: Errors below this are printed as such: their digits are those of the solver's last pass.
_SMALL = 1e-6
_MARKS = {True: "yes", False: "NO", None: "-"}


def sheet_of(verification: Verification) -> Sheet:
    """Source by source the cases and their rows, then what is wrong and the counts."""
    return Sheet(f"slopekit {__version__}   verification", (
        *(Section("SOURCE", _cases(f"{source}: {verification.sources[source]}", rows))
          for source, rows in by_source(verification)),
        Section("OUTSIDE", [f"{row.id}: {row.reason}" for row in verification.failed]),
        Section("COUNTED", [
            line_of(verification), standing(verification).replace("`", ""),
            "rows with - are not judged, their JSON says why (-o FOLDER)",
        ]),
        Section("TIME", [f"{verification.seconds:.1f} s"]),
    ), {"verification.csv": Table(COLUMNS, verification.rows)})  # fmt: skip


def line_of(verification: Verification) -> str:
    """The counts on one line."""
    count = verification.counts
    return (
        f"{count['rows']} rows of {count['cases']} designs: {count['within']} within their tolerance, "
        f"{count['outside']} outside, {count['not_judged']} not judged"
    )


def _cases(source: str, rows: Sequence[Row]) -> list[Entry]:
    entries: list[Entry] = [source]
    for _, group in groupby(rows, key=lambda row: row.case.id):
        of_case = list(group)
        case = of_case[0].case
        entries += [f"{case.id}: {case.title}", Table(_SHORT, of_case, headless=len(entries) > 1)]
    return entries


def by_source(verification: Verification) -> Iterator[tuple[str, list[Row]]]:
    """Sources of cases in their order, each with all rows of its cases: a case stands in one place."""
    for source in verification.sources:
        rows = [row for row in verification.rows if row.case.source == source]
        if rows:
            yield source, rows


def standing(verification: Verification) -> str:
    """What the judged rows are held against, and how far the others are off, in words."""
    of, judged = verification.judged_by, verification.counts["within"] + verification.counts["outside"]
    said = (
        f"Of the {judged} judged rows {of['published']} have a value published by somebody else; "
        f"{of['published_alone']} of these rest on it alone, the others have an exact or recomputed one beside it that "
        f"decides, and {of['published_inferred']} have inputs that were inferred. {of['own']} come from the project's "
        f"own lists and other code (cases, prototype, lem, exact, conic), {of['recomputed']} from a source's formula "
        "worked out or from the tests of another program."
    )
    unmet = verification.unmet
    if not unmet:
        return said
    low, high = unmet[0], unmet[-1]
    return (
        f"{said} Of the {len(verification.not_judged)} rows not judged {len(unmet)} have a published factor of safety: "
        f"slopekit differs from it by {_percent(low)} (`{low.id}`, {low.reference.source}) to {_percent(high)} "
        f"(`{high.id}`, {high.reference.source})."
    )


def _percent(row: Row) -> str:
    return f"{100.0 * (row.error or 0.0):+.1f} %"


# -- columns ----------------------------------------------------------------------------------------------------------


def quantity(row: Row) -> str:
    """What is compared, in words."""
    of = row.reference.of
    return QUANTITIES[row.reference.quantity].format(of="" if of is None else f"{of:g}")


def against(row: Row) -> float | str | None:
    """What the error is against: the exact value where there is one, else the published one."""
    return row.reference.published if row.reference.exact is None else row.reference.exact


def value_text(value: float | str | None) -> str:
    """A number to six digits, a status in words."""
    if value is None:
        return ""
    return value.replace("_", " ") if isinstance(value, str) else f"{value:.6g}"


def _error(row: Row) -> str:
    if row.error is None:
        return ""
    return f"{row.error:+.1e}" if abs(row.error) >= _SMALL else f"< {_SMALL:.0e}".replace("e-0", "e-")


def _time(row: Row) -> str:
    spent = f"{1e3 * row.seconds:.1f} ms"
    if not row.closed_form_seconds or row.closed_form is None:
        return spent
    times = row.seconds / row.closed_form_seconds
    return f"{spent}, {times:.0f}×" if times >= 10.0 else f"{spent}, {times:.1f}×"


def _exact(row: Row) -> str:
    """The exact value and a short formula of it; of an own source a status."""
    reference = row.reference
    if reference.exact is None:
        return value_text(reference.published) if reference.own else ""
    formula = f" = {reference.formula}" if reference.formula and len(reference.formula) <= 60 else ""
    return value_text(reference.exact) + formula.replace("*", r"\*")


def _tolerance(row: Row) -> str:
    reference = row.reference
    return "" if reference.tolerance is None else f"{reference.tolerance:.2g}: {reference.why}"


def _case(row: Row) -> str:
    return f"{row.case.title} (`{row.case.id}`)".replace("|", r"\|")


#: On a terminal.
_SHORT: tuple[Column[Row], ...] = (
    Column("  source", attrgetter("reference.source"), show="  {}".format, width=-18),
    Column("quantity", quantity, width=-25),
    Column("against", against, show=value_text, width=17),
    Column("slopekit", attrgetter("value"), show=value_text, width=17),
    Column("error", attrgetter("error"), text=_error, width=9),
    Column("ok", attrgetter("ok"), show=_MARKS.__getitem__, width=4),
)
#: Of the page, and of the CSV.
COLUMNS: tuple[Column[Row], ...] = (
    Column("Case", attrgetter("case.id"), "case", text=_case),
    Column("Source of the value", attrgetter("reference.source"), "source"),
    Column("Confidence", attrgetter("reference.confidence"), "confidence"),
    Column("Quantity", quantity, "quantity"),
    Column("Published", attrgetter("reference.printed"), "published"),
    Column("Exact or other code", attrgetter("reference.exact"), "exact", text=_exact),
    Column("slopekit", attrgetter("value"), "value", show=value_text),
    Column("Closed form", attrgetter("closed_form"), "closed_form", show=value_text),
    Column("PRE-IE limit", attrgetter("limit"), "limit", show=value_text),
    Column("Upper bound", attrgetter("static_bound"), "static_bound", show=value_text),
    Column("Error", attrgetter("error"), "error", text=_error),
    Column("Tolerance and its cause", attrgetter("reference.tolerance"), "tolerance", text=_tolerance),
    Column("Within", attrgetter("ok"), "ok", text=lambda row: "not judged" if row.ok is None else _MARKS[row.ok]),
    Column("Time", attrgetter("seconds"), "seconds", "s", text=_time, timed=True),
)
