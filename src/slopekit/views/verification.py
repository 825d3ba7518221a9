"""The verification suite on the terminal and as `docs/verification.md`."""

import json
from collections.abc import Iterator
from pathlib import Path

from slopekit.errors import DesignError, Fault
from slopekit.studies.references import QUANTITIES
from slopekit.studies.suite import Row, Verification

WIDTH = 100
#: Errors below this are printed as such: their digits are those of the solver's last pass.
_SMALL = 1e-6
_HEAD = ("case", "quantity", "reference", "slopekit", "error", "ok", "ms")
_WIDTHS = (34, 20, 10, 10, 8, 4, 6)
_COLUMNS = (
    "Case", "Confidence", "Quantity", "Published", "Exact", "slopekit", "Closed form", "PRE-IE limit",
    "Static bound", "Error", "Tolerance and its cause", "Within", "Time",
)  # fmt: skip
_READING = """\
Made by `slopekit check --suite -o docs`, with every number in `verification.json` beside it; not edited by hand. Run it
again and only the times and the versions may change: a test holds this page to that.

## How to read it

- **Published** is the value as the source prints it, **Exact** a value of closed-form statics or of other code, with
  more digits. No reference value comes from slopekit. **slopekit** is what it gives for the quantity of the row;
  **Closed form**, **PRE-IE limit** and **Static bound** are its three factors of safety for the same design.
- **Error** is relative, against the exact value where there is one, else against the published one. A published value
  is met where slopekit agrees to half a unit of its last digit; where a wider tolerance is needed its cause stands
  beside it.
- Every row is also held to the status that its source gives, to a limit that does not lie above its static bound, and
  to the agreement of PRE-IE with the closed form. A design that does not converge is a failed row.
- **Confidence**: A published value, read and reproduced; B value or inputs from memory, reproduced; C exact or
  independent recomputation; D inputs inferred. What "from memory" says was not read again for this page.
- Rows **not judged** are shown with the reason in words, never left out.
- **Time** is the wall time of the whole analysis of the design (cut, mesh, solve, bound, displacements), and how many
  times that of the closed form in it; designs without a closed form have milliseconds alone.
"""


def table(verification: Verification) -> str:
    """The suite for a terminal: at most 100 columns, by source, then what is wrong and the counts."""
    lines = []
    for source, rows in _by_source(verification):
        lines += [f"{source}  {verification.sources[source]}"[:WIDTH], _line(_HEAD)]
        lines += [
            _line((
                row.case.id, _quantity(row), _reference(row), _value(row.value), _error(row), _mark(row),
                f"{1e3 * row.seconds:.0f}",
            ))
            for row in rows
        ]  # fmt: skip
        lines.append("")
    for row in verification.failed:
        lines.append(f"OUTSIDE {row.id}: {row.reason}"[:WIDTH])
    lines.append(summary(verification))
    lines.append(f"{verification.seconds:.1f} s in all; rows with - are not judged, the reasons are in the JSON")
    return "\n".join(lines) + "\n"


def summary(verification: Verification) -> str:
    """The counts on one line."""
    count = verification.counts
    return (
        f"{count['rows']} rows of {count['cases']} designs: {count['within']} within their tolerance, "
        f"{count['outside']} outside, {count['not_judged']} not judged"
    )


def markdown(verification: Verification) -> str:
    """The page docs/verification.md: how to read it, what is outside, the tables by source, what is not judged."""
    parts = ["# Verification", _READING, "## Result", summary(verification)]
    parts.append(_outside(verification))
    for source, rows in _by_source(verification):
        parts += [f"## {source}", verification.sources[source], _grid([_cells(row) for row in rows])]
    if verification.not_judged:
        parts += ["## Rows not judged, and why", _reasons(verification)]
    parts += [
        "## Sources",
        "\n".join(f"- `{key}`: {text}" for key, text in verification.sources.items()),
        "## Versions",
        "Versions: " + ", ".join(f"{name} {found}" for name, found in verification.versions.items()),
    ]
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


def write(verification: Verification, folder: Path) -> tuple[Path, Path]:
    """Write `verification.md` and `verification.json` into a folder, made where it is missing.

    Raises
    ------
    DesignError
        E129 where that cannot be written.
    """
    page, data = folder / "verification.md", folder / "verification.json"
    text = json.dumps(verification.to_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        page.write_text(markdown(verification), encoding="utf-8")
        data.write_text(text, encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        fault = Fault(
            "E129", f"the folder {folder} cannot be written: {reason}", f"-o {folder}", "Choose another folder."
        )
        raise DesignError([fault]) from None
    return page, data


# -- parts ------------------------------------------------------------------------------------------------------------


def _by_source(verification: Verification) -> Iterator[tuple[str, list[Row]]]:
    """Sources in their order, each with its rows."""
    for source in verification.sources:
        rows = [row for row in verification.rows if row.reference.source == source]
        if rows:
            yield source, rows


def _line(cells: tuple[str, ...]) -> str:
    """A row of the terminal's table: the first two columns to the left, the others to the right."""
    left = [f"{cell[:width]:<{width}}" for cell, width in zip(cells[:2], _WIDTHS[:2], strict=True)]
    right = [f"{cell[:width]:>{width}}" for cell, width in zip(cells[2:], _WIDTHS[2:], strict=True)]
    return ("  " + " ".join(left + right)).rstrip()


def _grid(rows: list[tuple[str, ...]]) -> str:
    """A table in Markdown."""
    lines = [" | ".join(_COLUMNS), " | ".join("---" for _ in _COLUMNS), *(" | ".join(row) for row in rows)]
    return "\n".join(f"| {line} |" for line in lines)


def _cells(row: Row) -> tuple[str, ...]:
    reference, case = row.reference, row.case
    tolerance = "" if reference.tolerance is None else f"{reference.tolerance:.2g}: {reference.why}"
    formula = f" = {reference.formula}" if reference.formula and len(reference.formula) <= 60 else ""
    exact = "" if reference.exact is None else _value(reference.exact) + formula.replace("*", r"\*")
    return (
        f"{case.title} (`{case.id}`)".replace("|", r"\|"), reference.confidence, _quantity(row),
        reference.published or "", exact, _value(row.value),
        _value(row.closed_form), _value(row.limit), _value(row.static_bound), _error(row), tolerance, _mark(row),
        _time(row),
    )  # fmt: skip


def _outside(verification: Verification) -> str:
    if not verification.failed:
        return "No judged row is outside its tolerance."
    return "Outside their tolerance:\n\n" + "\n".join(f"- {row.id}: {row.reason}" for row in verification.failed)


def _reasons(verification: Verification) -> str:
    """The reasons, each with the rows that it holds for."""
    rows_by_reason: dict[str, list[str]] = {}
    for row in verification.not_judged:
        rows_by_reason.setdefault(row.reason, []).append(row.id)
    return "\n".join(
        f"- {reason}: " + ", ".join(f"`{name}`" for name in dict.fromkeys(names))
        for reason, names in rows_by_reason.items()
    )


def _quantity(row: Row) -> str:
    of = row.reference.of
    said = QUANTITIES[row.reference.quantity]
    return said if of is None or row.reference.quantity == "critical_friction_deg" else f"{said} {of:g}"


def _reference(row: Row) -> str:
    return row.reference.published or _value(row.reference.exact)


def _value(value: float | str | None) -> str:
    """A number to six digits, a status in words."""
    if value is None:
        return ""
    return value.replace("_", " ") if isinstance(value, str) else f"{value:.6g}"


def _error(row: Row) -> str:
    if row.error is None:
        return ""
    return f"{row.error:+.1e}" if abs(row.error) >= _SMALL else f"< {_SMALL:.0e}".replace("e-0", "e-")


def _mark(row: Row) -> str:
    return {True: "yes", False: "NO", None: "-"}[row.ok]


def _time(row: Row) -> str:
    spent = f"{1e3 * row.seconds:.1f} ms"
    if not row.closed_form_seconds or row.closed_form is None:
        return spent
    times = row.seconds / row.closed_form_seconds
    return f"{spent}, {times:.0f}×" if times >= 10.0 else f"{spent}, {times:.1f}×"
