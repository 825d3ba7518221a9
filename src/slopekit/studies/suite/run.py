"""The verification suite: what books, papers and other programs say, beside what slopekit finds.

The cases stand in `verification.json`: a design, where it comes from, and rows, each with a published value, an exact
value or both. Every design is analysed once.
"""

import json
import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeAlias

from slopekit._version import __version__
from slopekit.core.codec import record_of
from slopekit.core.errors import SlopekitError
from slopekit.core.sheet import value_at
from slopekit.design.reading.files import load
from slopekit.kinds import analyse, kind_of
from slopekit.result import METHODS, Result
from slopekit.studies.protocol import DESK, StudyOutcome, Workplace, documented, timed
from slopekit.studies.suite.references import (
    Reference,
    ReferenceCase,
    document,
    half_unit,
    selected_cases,
)

#: A limit above its static bound by more than this part is no limit: rounding of two programs.
BOUND_SLACK = 1e-6


@dataclass(frozen=True)
class Row:
    """One line of the suite's table.

    Attributes
    ----------
    value : what slopekit gives for the quantity; None where it gives none
    closed_form, limit, static_bound : the factors of the same design
    error : of the value, relative to the exact value where there is one, else to the published; None for a status
    ok : None where the row is not judged
    reason : why it is not judged, or what is wrong with it; empty where all is well
    seconds, closed_form_seconds : of the analysis of the design and of the closed form in it
    """

    JSON_ALSO: ClassVar = ("id",)
    case: ReferenceCase = field(metadata={"json": None})
    reference: Reference = field(metadata={"json": None})
    value: float | str | None
    status: str
    closed_form: float | None
    limit: float | None
    static_bound: float | None
    error: float | None
    ok: bool | None
    reason: str
    seconds: float = field(metadata={"json": None})
    closed_form_seconds: float | None = field(metadata={"json": None})

    @property
    def id(self) -> str:
        """The case, the quantity, and what it is meant for."""
        condition = "" if self.reference.of is None else f"@{self.reference.of:g}"
        return f"{self.case.id}: {self.reference.quantity}{condition}"

    def to_dict(self) -> dict[str, Any]:
        """The row as JSON values; what is measured in time stands in a block of its own."""
        case = self.case
        record = {
            "case": case.id,
            "kind": case.kind,
            "title": case.title,
            **record_of(self.reference),
            **record_of(self),
            "timing_s": {"total": self.seconds, "closed_form": self.closed_form_seconds},
        }
        return record | {name: record[name] or None for name in ("formula", "why", "reason")}


@dataclass(frozen=True, repr=False)
class Verification(StudyOutcome):
    """The whole suite: rows in the order of their sources, the sources by key."""

    name: ClassVar[str] = "verification"
    rows: tuple[Row, ...]
    sources: Mapping[str, str]

    @property
    def failed(self) -> tuple[Row, ...]:
        """Rows outside their tolerance, or wrong in another way."""
        return tuple(row for row in self.rows if row.ok is False)

    @property
    def not_judged(self) -> tuple[Row, ...]:
        """Rows that are shown only."""
        return tuple(row for row in self.rows if row.ok is None)

    @property
    def counts(self) -> dict[str, int]:
        """Cases, rows, and how many are within their tolerance, outside it and not judged."""
        return {
            "cases": len({row.case.id for row in self.rows}),
            "rows": len(self.rows),
            "within": sum(row.ok is True for row in self.rows),
            "outside": len(self.failed),
            "not_judged": len(self.not_judged),
        }

    @property
    def exit_code(self) -> int:
        """0 where every judged row is within its tolerance, else 4: the methods disagree."""
        return 4 if self.failed else 0

    def to_dict(self) -> dict[str, Any]:
        """The suite as JSON values: null where there is none."""
        return {
            "slopekit": __version__,
            "counts": self.counts,
            "exit_code": self.exit_code,
            "sources": dict(self.sources),
            "rows": [row.to_dict() for row in self.rows],
            "timing_s": {"total": self.seconds},
        }


#: Where a result has a quantity; others are computed, or asked of the closed form.
_PATHS = {
    "status": "status",
    "forces_only": "comparisons.forces_only",
    "volume_m3": "geometry.volume_m3",
    "weight_kn": "forces.weight",
    **{name: f"methods.{name}" for name in METHODS},
    **{
        name: f"fos.{name}" for name in ("limit", "closed_form", "static_bound", "all_pairs_failed")
    },
}
_AXES = {"displacement_x_mm": 0, "displacement_z_mm": 2}
#: What one design gave: a result, or the words of what went wrong, and the seconds it took.
_CaseAnalysis: TypeAlias = tuple[Result | None, str, float]


@timed
@documented
def suite(only: str | Iterable[str] | None = None, *, desk: Workplace = DESK) -> Verification:
    """The verification suite: published and exact cases.

    All of them; or those that `only` names: ids of cases, keys of sources, kinds of designs.

    Raises
    ------
    DesignError
        E197 for a name that is none of these.

    >>> suite("6c_footing").counts["outside"]
    0
    """
    sources, _ = document()
    cases = selected_cases(only)
    outcomes: dict[str, _CaseAnalysis] = {}
    rows: list[Row] = []
    with desk.bar("cases", len(cases)) as advance:
        for case in cases:
            key = json.dumps(case.design, sort_keys=True)
            if key not in outcomes:
                outcomes[key] = _case_analysis(case.design)
            rows += [_row(case, reference, outcomes[key]) for reference in case.references]
            advance(1)
    quoted = {row.reference.source for row in rows} | {case.source for case in cases}
    quoted_sources = {key: text for key, text in sources.items() if key in quoted}
    return Verification(tuple(rows), quoted_sources)


# -- a case -----------------------------------------------------------------------------------------------------------


def _case_analysis(mapping: Mapping[str, Any]) -> _CaseAnalysis:
    """A design's result; a design that is refused or breaks is a failed row with its words, never a crash."""
    started = time.perf_counter()
    try:
        result = analyse(load(mapping))
    except SlopekitError as error:
        return None, str(error.faults[0]).splitlines()[0], time.perf_counter() - started
    return result, "", time.perf_counter() - started


def _row(case: ReferenceCase, reference: Reference, outcome: _CaseAnalysis) -> Row:
    """A row, judged: the status and the bound hold for every row of a case, whatever its quantity."""
    result, trouble, seconds = outcome
    if result is None:
        return Row(
            case,
            reference,
            None,
            "",
            None,
            None,
            None,
            None,
            False,
            f"no analysis: {trouble}",
            seconds,
            None,
        )
    fos = result.fos
    value = _value(result, reference)
    error = _error(value, reference)
    wrong = _result_faults(case, result) + _reference_faults(value, error, reference)
    ok = False if wrong else None if reference.not_judged else True
    reason = "; ".join(wrong) if wrong else reference.not_judged
    return Row(
        case,
        reference,
        value,
        result.status,
        fos.closed_form,
        fos.limit,
        fos.static_bound,
        error,
        ok,
        reason,
        seconds,
        result.timing_s.get("closed_form"),
    )


def _result_faults(case: ReferenceCase, result: Result) -> list[str]:
    """Return the faults of a result as a whole, apart from the number of the row."""
    wrong = []
    if result.status == "not_converged":
        wrong.append("the analysis did not converge")
    if case.status is not None and result.status != case.status:
        wrong.append(f"status {result.status}, the source has {case.status}")
    limit, bound = result.fos.limit, result.fos.static_bound
    if limit is not None and bound is not None and limit > bound * (1.0 + BOUND_SLACK):
        wrong.append("the limit lies above its upper bound")
    if result.agree is False:
        wrong.append("PRE-IE and the closed form of the kind disagree")
    return wrong


def _reference_faults(
    value: float | str | None, error: float | None, reference: Reference
) -> list[str]:
    """Return the faults of a value that misses its reference; none for rows that are not judged."""
    if reference.not_judged:
        return []
    if isinstance(value, str):
        return [] if value == reference.published else [f"{value} instead of {reference.published}"]
    if value is None or error is None:
        return ["slopekit gives no such value"]
    misses = []
    if reference.tolerance is None or not abs(error) <= reference.tolerance:
        misses.append(f"off by {error:.2g}, outside its tolerance")
    # the exact value is the closer judge; what is printed has to hold as well, to its last digit
    printed = reference.published if reference.exact is not None else None
    if printed is not None and abs(value - float(printed)) > half_unit(printed) * (1.0 + 1e-9):
        misses.append("not the printed value to its last digit")
    return misses


def _error(value: float | str | None, reference: Reference) -> float | None:
    """Relative error against the exact value where there is one, else the published; absolute where that is 0."""
    if (
        value is None
        or isinstance(value, str)
        or (reference.exact is None and reference.published is None)
    ):
        return None
    expected = reference.exact if reference.exact is not None else float(str(reference.published))
    return value - expected if expected == 0.0 else (value - expected) / abs(expected)


def _value(result: Result, reference: Reference) -> float | str | None:
    """Return slopekit's value of a quantity."""
    quantity, condition = reference.quantity, reference.of
    if quantity in _PATHS:
        value: float | str | None = value_at(_PATHS[quantity].split("."), result)
        return value
    if (
        quantity == "critical_friction_deg"
    ):  # c = 0 and one φ: strength divided by F is friction of tan φ / F
        factor = result.fos.limit
        return (
            None
            if not factor
            else math.degrees(math.atan(math.tan(math.radians(condition or 0.0)) / factor))
        )
    step = next((step for step in result.series if step.factor == condition), None)
    if quantity == "failed_pairs":
        return None if step is None else float(step.failed_pairs)
    if quantity in _AXES:
        movement = None if step is None else step.movement
        return None if movement is None else 1e3 * float(movement.displacement[_AXES[quantity]])
    kind = kind_of(result.design)
    return kind.closed_form(result.design, kind.cut(result.design)).figure(quantity, condition)
