"""The verification suite as `docs/verification.md`, with its JSON beside it.

    python -m benchmarks.verification_page [FOLDER]

runs the suite (some minutes) and writes both into the folder [docs].
"""

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from slopekit.studies.suite import suite
from slopekit.studies.suite.run import Row, Verification
from slopekit.studies.suite.sheet import COLUMNS, against, by_source, line_of, standing, value_text

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
        standing(verification),
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
        "Versions: " + ", ".join(f"{name} {version}" for name, version in verification.versions.items()),
    ]
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


# -- parts ------------------------------------------------------------------------------------------------------------


def _moments(verification: Verification) -> Iterator[str]:
    """What stands behind limits that moments decide; nothing where the case is not among the rows."""
    rows = [
        row for row in verification.rows if row.reference.source == _BED and row.reference.quantity == "limit"
    ]  # fmt: skip
    if rows:
        held = ", ".join(f"`{row.case.id}` {value_text(against(row))} against {row.limit or 0.0:.4g}" for row in rows)
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


def _grid(rows: Sequence[Row]) -> str:
    """A table in Markdown."""
    lines = [[column.title for column in COLUMNS], ["---"] * len(COLUMNS)]
    lines += [[column.shown(row) for column in COLUMNS] for row in rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


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


def main(folder: str = "docs") -> None:
    """Run the suite and write the page and its JSON."""
    verification = suite()
    (Path(folder) / "verification.md").write_text(page_of(verification), encoding="utf-8")
    document = json.dumps(verification.to_dict(), ensure_ascii=False, indent=1) + "\n"
    (Path(folder) / "verification.json").write_text(document, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
