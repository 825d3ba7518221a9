"""The verification suite as `docs/verification.md`, with its JSON beside it.

    python -m benchmarks.verification_page [FOLDER]

runs the suite (some minutes) and writes both into the folder [docs].
"""

import json
import platform
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

from slopekit._version import __version__
from slopekit.studies.suite import suite
from slopekit.studies.suite.run import Row, Verification
from slopekit.studies.suite.sheet import (
    MARKS,
    against,
    by_source,
    error_text,
    line_of,
    quantity,
    value_text,
)

_BED = "bed"  # the source of wedges governed by moments
_READING = """\
Made by `python -m benchmarks.verification_page`, with every number in `verification.json` beside it; not edited by
hand. Run it again and only the times and the versions may change: a test holds this page to that.

## How to read it

- **Published** is the value as its source prints it. **Exact or other code** is a value of closed-form statics, of a
  source's formula or of other code, with more digits. No reference value comes from slopekit. **slopekit** is what it
  gives for the quantity of the row; **Closed form**, **PRE-IE limit** and **Upper bound** are its three factors of
  safety for the same design. Cases stand under the source of their inputs; **Source of the value** names that of the
  row, and the list of sources at the end says what it is.
- **Error** is relative (absolute where the reference is 0), against the exact value where there is one, else against
  the published one. A published value is met where slopekit agrees to half a unit of its last digit; where a wider
  tolerance is needed its cause stands beside it.
- Every row is also held to the status that its source gives, to a limit that does not lie above its upper bound, and
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
  finer meshes, upper bound, displacements, the changed inputs of SENSITIVITY, and where it asks for them the reduction
  steps and the factor at which all pairs have failed. Beside it stands how many times that of the closed form alone it
  is; designs without a closed form have milliseconds alone. Rows of one design share one analysis.
"""


def page_of(verification: Verification) -> str:
    """The page docs/verification.md: what it rests on, how to read it, the tables by source, what is not judged."""
    head, _, reading = _READING.partition("\n\n")
    parts = [
        "# Verification",
        head,
        "## Result",
        line_of(verification) + ".",
        _outside(verification),
        _standing(verification),
        *_moments(verification),
        reading,
    ]
    for source, rows in by_source(verification):
        parts += [f"## {source}", verification.sources[source], _grid(rows)]
    if verification.not_judged:
        parts += ["## Rows not judged, and why", _reasons(verification)]
    parts += [
        "## Sources",
        "\n".join(f"- `{key}`: {text}" for key, text in verification.sources.items()),
        "## Versions",
        f"Versions: slopekit {__version__}, python {platform.python_version()}, "
        + ", ".join(
            f"{name} {version(name)}" for name in ("numpy", "scipy", "clarabel", "manifold3d")
        ),
    ]
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


# -- parts ------------------------------------------------------------------------------------------------------------


def _moments(verification: Verification) -> Iterator[str]:
    """What stands behind limits that moments decide; nothing where the case is not among the rows."""
    rows = [
        row
        for row in verification.rows
        if row.reference.source == _BED and row.reference.quantity == "limit"
    ]
    if rows:
        held = ", ".join(
            f"`{row.case.id}` {value_text(against(row))} against {row.limit or 0.0:.4g}"
            for row in rows
        )
        yield (
            "Where moments govern, the limit of a wedge that its closed form does not see (it balances forces) is held "
            f"against an independent program: {held}. "
            "Surfaces that turn with friction rest on the "
            "prototype as well (`6a_ellipsoid_li`, `sphere-phi-20`). What else turns or tips: the columns of Goodman & "
            "Bray, published to two decimals (`5a_goodman_bray`, `goodman-bray-b`, `-c`, `-d`); exact "
            "limits of surfaces with φ = 0 (`6d_sphere_phi0`, `sphere-cap-6-30`, `sphere-cap-7-40`, `cylinder-corner`, "
            "`cylinder-segment`); and tipping at an exact threshold, a status and no number (from `cube-44.9` to "
            "`cube-45.1`, `cube-45.1-bonded`, `column-alone`, `block-pushed-over`)."
        )


def judged_by(verification: Verification) -> dict[str, int]:
    """What the judged rows are held against: the first, `own` and `recomputed` make up all of them.

    `published` has a printed value of somebody else, `published_alone` no closer value beside it, and
    `published_inferred` inputs that were inferred; `own` comes from the project's own lists and other code, and
    `recomputed` from a source's formula, or to more digits from the tests of another program.
    """
    judged = [row.reference for row in verification.rows if row.ok is not None]
    published = [one for one in judged if one.printed is not None]
    own = sum(one.is_own_source for one in judged)
    return {
        "published": len(published),
        "published_alone": sum(one.exact is None for one in published),
        "published_inferred": sum(one.confidence.startswith("D") for one in published),
        "own": own,
        "recomputed": len(judged) - len(published) - own,
    }


def unmet(verification: Verification) -> list[Row]:
    """Rows that are not judged and have a published factor of safety, from the lowest error to the highest."""
    rows = [
        row
        for row in verification.not_judged
        if row.reference.printed is not None and row.error is not None
    ]
    return sorted(
        (row for row in rows if row.reference.is_factor), key=lambda row: row.error or 0.0
    )


def _standing(verification: Verification) -> str:
    """What the judged rows are held against, and how far the others are off, in words."""
    of, judged = (
        judged_by(verification),
        verification.counts["within"] + verification.counts["outside"],
    )
    said = (
        f"Of the {judged} judged rows {of['published']} have a value published by somebody else; "
        f"{of['published_alone']} of these rest on it alone, the others have an exact or recomputed one beside it that "
        f"decides, and {of['published_inferred']} have inputs that were inferred. {of['own']} come from the project's "
        f"own lists and other code (cases, prototype, lem, exact, conic), {of['recomputed']} from a source's formula "
        "worked out or from the tests of another program."
    )
    rows = unmet(verification)
    if not rows:
        return said
    low, high = rows[0], rows[-1]
    return (
        f"{said} Of the {len(verification.not_judged)} rows not judged {len(rows)} have a published factor of safety: "
        f"slopekit differs from it by {_percent(low)} (`{low.id}`, {low.reference.source}) to {_percent(high)} "
        f"(`{high.id}`, {high.reference.source})."
    )


def _percent(row: Row) -> str:
    return f"{100.0 * (row.error or 0.0):+.1f} %"


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
        return value_text(reference.published) if reference.is_own_source else ""
    formula = (
        f" = {reference.formula}" if reference.formula and len(reference.formula) <= 60 else ""
    )
    return value_text(reference.exact) + formula.replace("*", r"\*")


def _tolerance(row: Row) -> str:
    reference = row.reference
    return "" if reference.tolerance is None else f"{reference.tolerance:.2g}: {reference.why}"


def _case(row: Row) -> str:
    return f"{row.case.title} (`{row.case.id}`)".replace("|", r"\|")


_CELLS: dict[str, Callable[[Row], str]] = {
    "Case": _case,
    "Source of the value": lambda row: row.reference.source,
    "Confidence": lambda row: row.reference.confidence,
    "Quantity": quantity,
    "Published": lambda row: row.reference.printed or "",
    "Exact or other code": _exact,
    "slopekit": lambda row: value_text(row.value),
    "Closed form": lambda row: value_text(row.closed_form),
    "PRE-IE limit": lambda row: value_text(row.limit),
    "Upper bound": lambda row: value_text(row.static_bound),
    "Error": error_text,
    "Tolerance and its cause": _tolerance,
    "Within": lambda row: "not judged" if row.ok is None else MARKS[row.ok],
    "Time": _time,
}


def _grid(rows: Sequence[Row]) -> str:
    """A table in Markdown."""
    lines = [list(_CELLS), ["---"] * len(_CELLS)]
    lines += [[cell(row) for cell in _CELLS.values()] for row in rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _outside(verification: Verification) -> str:
    if not verification.failed:
        return "No judged row is outside its tolerance."
    return "Outside their tolerance:\n\n" + "\n".join(
        f"- {row.id}: {row.reason}" for row in verification.failed
    )


def _reasons(verification: Verification) -> str:
    """The reasons, each with the rows that it holds for."""
    rows_by_reason: dict[str, list[str]] = {}
    for row in verification.not_judged:
        rows_by_reason.setdefault(row.reason, []).append(row.id)
    return "\n".join(
        f"- {reason}: " + ", ".join(f"`{name}`" for name in dict.fromkeys(names))
        for reason, names in rows_by_reason.items()
    )


def main(folder: str = "docs") -> None:
    """Run the suite and write the page and its JSON."""
    verification = suite()
    (Path(folder) / "verification.md").write_text(page_of(verification), encoding="utf-8")
    document = json.dumps(verification.to_dict(), ensure_ascii=False, indent=1) + "\n"
    (Path(folder) / "verification.json").write_text(document, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
