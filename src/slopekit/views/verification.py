"""The verification suite on the terminal and as `docs/verification.md`."""

import json
import textwrap
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from slopekit.errors import DesignError, Fault
from slopekit.studies.references import QUANTITIES
from slopekit.studies.suite import Row, Verification

WIDTH = 100
#: Errors below this are printed as such: their digits are those of the solver's last pass.
_SMALL = 1e-6
_HEAD = ("source", "quantity", "against", "slopekit", "error", "ok")
_WIDTHS = (18, 24, 18, 18, 8, 3)
_COLUMNS = (
    "Case", "Source of the value", "Confidence", "Quantity", "Published", "Exact or other code", "slopekit",
    "Closed form", "PRE-IE limit", "Static bound", "Error", "Tolerance and its cause", "Within", "Time",
)  # fmt: skip
_SINGLE_PLANE = "9_single-plane 40/160 + 80/220 c=20"
_READING = """\
Made by `slopekit check --suite -o docs`, with every number in `verification.json` beside it; not edited by hand. Run it
again and only the times and the versions may change: a test holds this page to that.

## How to read it

- **Published** is the value as its source prints it. **Exact or other code** is a value of closed-form statics, of a
  source's formula or of other code, with more digits. No reference value comes from slopekit. **slopekit** is what it
  gives for the quantity of the row; **Closed form**, **PRE-IE limit** and **Static bound** are its three factors of
  safety for the same design. Cases stand under the source of their inputs; **Source of the value** names that of the
  row, and the list of sources at the end says what it is.
- **Error** is relative (absolute where the reference is 0), against the exact value where there is one, else against
  the published one. A published value is met where slopekit agrees to half a unit of its last digit; where a wider
  tolerance is needed its cause stands beside it.
- Every row is also held to the status that its source gives, to a limit that does not lie above its static bound, and
  to the agreement of PRE-IE with the closed form. A design that does not converge is a failed row.
- **Confidence** is in the source and in the inputs, whatever slopekit gives; **Within** alone says how it compares.
  - A: the value was read, in the source, in one that quotes it, or in the tests of another program.
  - B: the value, or inputs that it hangs on, are from memory and were not read again for this page.
  - C: nobody else's printed value: exact, a formula worked out, or recomputed by other code on the same inputs.
  - D: an input that the value hangs on is not in the source and was inferred. Such a row is judged only where what was
    inferred does not decide it (the footing's failed pairs past 4/3), or where an exact value for the inputs as
    inferred stands beside it. That says nothing new of the source: the base of the footing was inferred from its own
    4/3, which is circular, and the slope and the centre of Hungr's sphere were inferred as well.
- Rows **not judged** are shown with the reason in words, never left out.
- **Time** is the wall time of the whole analysis of the design, with all that this design asks for: cut, mesh, solve,
  finer meshes, static bound, displacements, the changed inputs of GOVERNS, and where it asks for them the reduction
  steps and the factor at which all pairs have failed. Beside it stands how many times that of the closed form alone it
  is; designs without a closed form have milliseconds alone. Rows of one design share one analysis.
"""


def table(verification: Verification) -> str:
    """The suite for a terminal: at most 100 columns, by case, then what is wrong and the counts."""
    lines = []
    for source, rows in _by_source(verification):
        lines += textwrap.wrap(f"{source}: {verification.sources[source]}", WIDTH, subsequent_indent="  ")
        lines.append(_line(_HEAD))
        for _, group in groupby(rows, key=lambda row: row.case.id):
            of_case = list(group)
            case, spent = of_case[0].case, f"{1e3 * of_case[0].seconds:.0f} ms"
            heading = f"{case.id}: {case.title}, {spent}"
            lines += textwrap.wrap(heading, WIDTH, initial_indent="  ", subsequent_indent="    ")
            lines += [
                _line((row.reference.source, _quantity(row), _against(row), _value(row.value), _error(row), _mark(row)))
                for row in of_case
            ]
        lines.append("")
    for row in verification.failed:
        lines += textwrap.wrap(f"OUTSIDE {row.id}: {row.reason}", WIDTH, subsequent_indent="  ")
    lines.append(summary(verification))
    lines += textwrap.wrap(_standing(verification).replace("`", ""), WIDTH)
    lines.append(
        f"{verification.seconds:.1f} s in all; rows with - are not judged, verification.md says why (-o FOLDER)"
    )
    return "\n".join(lines)


def summary(verification: Verification) -> str:
    """The counts on one line."""
    count = verification.counts
    return (
        f"{count['rows']} rows of {count['cases']} designs: {count['within']} within their tolerance, "
        f"{count['outside']} outside, {count['not_judged']} not judged"
    )


def markdown(verification: Verification) -> str:
    """The page docs/verification.md: what it rests on, how to read it, the tables by source, what is not judged."""
    head, _, reading = _READING.partition("\n\n")
    parts = ["# Verification", head, "## Result", summary(verification) + ".", _outside(verification)]
    parts += [_standing(verification), *_moments(verification), reading]
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
    """Sources of cases in their order, each with all rows of its cases: a case stands in one place."""
    for source in verification.sources:
        rows = [row for row in verification.rows if row.case.source == source]
        if rows:
            yield source, rows


def _standing(verification: Verification) -> str:
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


def _moments(verification: Verification) -> Iterator[str]:
    """What stands behind limits that moments decide; nothing where the case is not among the rows."""
    rows = [
        row for row in verification.rows if row.case.id == _SINGLE_PLANE and row.reference.source == "prototype"
    ]  # fmt: skip
    for row in rows:
        yield (
            "Where moments govern, the limit of a wedge that its closed form does not see (it balances forces) rests "
            f"on one row, and that of a throw-away prototype: `{row.case.id}`, {_against(row)} against "
            f"{row.limit or 0.0:.4g}, tolerance {100.0 * (row.reference.tolerance or 0.0):.0f} %. "
            "Surfaces that turn with friction rest on the "
            "prototype as well (`6a_ellipsoid_li`, `sphere-phi-20`). What else turns or tips: the columns of Goodman & "
            "Bray, published to two decimals (`5a_goodman_bray`, `goodman-bray-b`, `-c`, `-d`); exact "
            "limits of surfaces with φ = 0 (`6d_sphere_phi0`, `sphere-cap-6-30`, `sphere-cap-7-40`, `cylinder-corner`, "
            "`cylinder-segment`); and tipping at an exact threshold, a status and no number (from `cube-44.9` to "
            "`cube-45.1`, `cube-45.1-bonded`, `column-alone`, `block-pushed-over`)."
        )


def _percent(row: Row) -> str:
    return f"{100.0 * (row.error or 0.0):+.1f} %"


def _line(cells: tuple[str, ...]) -> str:
    """A row of the terminal's table: the first two columns to the left, the others to the right."""
    left = [f"{cell:<{width}}" for cell, width in zip(cells[:2], _WIDTHS[:2], strict=True)]
    right = [f"{cell:>{width}}" for cell, width in zip(cells[2:], _WIDTHS[2:], strict=True)]
    return ("    " + " ".join(left + right)).rstrip()


def _grid(rows: list[tuple[str, ...]]) -> str:
    """A table in Markdown."""
    lines = [" | ".join(_COLUMNS), " | ".join("---" for _ in _COLUMNS), *(" | ".join(row) for row in rows)]
    return "\n".join(f"| {line} |" for line in lines)


def _cells(row: Row) -> tuple[str, ...]:
    reference, case = row.reference, row.case
    tolerance = "" if reference.tolerance is None else f"{reference.tolerance:.2g}: {reference.why}"
    formula = f" = {reference.formula}" if reference.formula and len(reference.formula) <= 60 else ""
    own = _value(reference.published) if reference.own else ""  # a status
    exact = own if reference.exact is None else _value(reference.exact) + formula.replace("*", r"\*")
    return (
        f"{case.title} (`{case.id}`)".replace("|", r"\|"), reference.source, reference.confidence, _quantity(row),
        reference.printed or "", exact, _value(row.value),
        _value(row.closed_form), _value(row.limit), _value(row.static_bound), _error(row), tolerance,
        "not judged" if row.ok is None else _mark(row), _time(row),
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
    return QUANTITIES[row.reference.quantity].format(of="" if of is None else f"{of:g}")


def _against(row: Row) -> str:
    """What the error is against: the exact value where there is one, else the published one."""
    return _value(row.reference.published if row.reference.exact is None else row.reference.exact)


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
