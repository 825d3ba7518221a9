"""The verification suite in columns: 100 of a terminal, and those of its CSV."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from slopekit._version import __version__
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table
from slopekit.studies.suite.references import QUANTITIES
from slopekit.studies.suite.run import Row, Verification

#: Errors below this are printed as such: their digits are those of the solver's last step.
_SMALL = 1e-6
MARKS = {True: "yes", False: "NO", None: "-"}


def sheet_of(verification: Verification) -> Sheet:
    """Source by source the cases and their rows, then what is wrong and the counts."""
    return Sheet(
        f"slopekit {__version__}   verification",
        (
            *(
                Section("SOURCE", _cases(f"{source}: {verification.sources[source]}", rows))
                for source, rows in by_source(verification)
            ),
            Section("OUTSIDE", [f"{row.id}: {row.reason}" for row in verification.failed]),
            Section(
                "COUNTED",
                [
                    line_of(verification),
                    "rows with - are not judged, their JSON says why (-o FOLDER)",
                ],
            ),
            Section("TIME", [f"{verification.seconds:.1f} s"]),
        ),
        {"verification.csv": Table(_COLUMNS, verification.rows)},
    )


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


# -- columns ----------------------------------------------------------------------------------------------------------


def quantity(row: Row) -> str:
    """Return the name of the quantity that is compared."""
    condition = row.reference.of
    return QUANTITIES[row.reference.quantity].format(
        of="" if condition is None else f"{condition:g}"
    )


def against(row: Row) -> float | str | None:
    """Return the value that the error refers to: the exact one where there is one, else the published one."""
    return row.reference.published if row.reference.exact is None else row.reference.exact


def value_text(value: float | str | None) -> str:
    """A number to six digits, a status in words."""
    if value is None:
        return ""
    return value.replace("_", " ") if isinstance(value, str) else f"{value:.6g}"


def error_text(row: Row) -> str:
    if row.error is None:
        return ""
    return (
        f"{row.error:+.1e}" if abs(row.error) >= _SMALL else f"< {_SMALL:.0e}".replace("e-0", "e-")
    )


#: On a terminal.
_SHORT: tuple[Column[Row], ...] = (
    Column("  source", "reference.source", show="  {}".format, width=-18),
    Column("quantity", quantity, width=-25),
    Column("against", against, show=value_text, width=17),
    Column("slopekit", "value", show=value_text, width=17),
    Column("error", "error", text=error_text, width=9),
    Column("ok", "ok", show=MARKS.__getitem__, width=4),
)
#: Of the CSV.
_COLUMNS: tuple[Column[Row], ...] = (
    Column("case", "case.id", "case"),
    Column("source", "reference.source", "source"),
    Column("confidence", "reference.confidence", "confidence"),
    Column("quantity", quantity, "quantity"),
    Column("published", "reference.printed", "published"),
    Column("exact", "reference.exact", "exact"),
    Column("slopekit", "value", "value"),
    Column("closed form", "closed_form", "closed_form"),
    Column("PRE-IE limit", "limit", "limit"),
    Column("upper bound", "static_bound", "static_bound"),
    Column("error", "error", "error"),
    Column("tolerance", "reference.tolerance", "tolerance"),
    Column("within", "ok", "ok"),
    Column("time", "seconds", "seconds", "s", timed=True),
)
