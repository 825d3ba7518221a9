"""The sheet of a checked design: what was looked at, what accuracy costs, 100 columns."""

from collections.abc import Iterator
from operator import itemgetter
from typing import TypeAlias

from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, factor_text
from slopekit.kinds.single_block.ladders import Rung
from slopekit.result import RULE_QUANTITIES
from slopekit.studies.check.run import Check, Finding
from slopekit.studies.words import study_sheet

_MARKS = {True: "ok", False: "NO", None: "--"}


def sheet_of(checked: Check) -> Sheet:
    """The sheet of a check."""
    result = checked.result
    run = {section.label: section for section in result.sheet.sections}
    return study_sheet(
        result.design,
        "check",
        (
            *(run[label] for label in ("STATUS", "FoS", "COLUMNS", "MOMENTS")),
            Section("LOOKED AT", [Table(_FINDING, checked.findings, headless=True)], hang=42),
            Section("LADDER", _ladder(checked)),
            run["ACCEPT"],
            Section("VERDICT", [_verdict(checked), _CONSISTENCY_MEANING]),
            Section("TIME", [f"{checked.seconds:.2f} s"], timed=True),
            Section("NOTE", [str(notice) for notice in result.warnings]),
        ),
    )


def line_of(checked: Check) -> str:
    """The verdict on one line."""
    fos, leading = checked.result.fos.limit, checked.result.leading
    factor = factor_text(fos).strip()
    if leading is not None:  # what acceptance hangs on
        factor = f"{RULE_QUANTITIES[leading[0]]} {factor_text(leading[1])}, limit {factor}"
    codes = list(dict.fromkeys(notice.code for notice in checked.result.warnings))
    acceptance = (
        [] if checked.result.accepted is None else ["met" if checked.result.accepted else "not met"]
    )
    return "  ".join([checked.result.status, factor, *acceptance, _verdict(checked), *codes])


def _figure(finding: Finding) -> str:
    if finding.value is None:
        return ""
    return f"{finding.value:.4g}" if finding.wanted is None else f"{finding.value:.1e}"


_FINDING: tuple[Column[Finding], ...] = (
    Column("met", "met", "met", show=_MARKS.__getitem__, width=-4),
    Column("what", "name", "name", width=-17),
    Column("figure", "value", "value", text=_figure, width=8),
    Column(
        "wanted",
        "wanted",
        "wanted",
        show=lambda most: "" if most is None else f" <= {most:g}",
        width=-11,
    ),
    Column("words", "words", "words", width=-1),
)


#: A rung of the ladder, its error, how many times the seconds of the base, and whether its method is said here.
_LadderRow: TypeAlias = tuple[Rung, float | None, float, bool]

_LADDER: tuple[Column[_LadderRow], ...] = (
    Column(
        "method",
        lambda step: step[0].method,
        "method",
        text=lambda step: step[0].method * step[3],
        width=-13,
    ),
    Column("setting", lambda step: step[0].setting, "setting", width=-23),
    Column("pairs", lambda step: step[0].node_pairs, "node_pairs", width=6),
    Column(
        "F",
        lambda step: step[0].factor,
        "fos",
        show=lambda fos: "none" if fos is None else f"{fos:.8g}",
        width=13,
    ),
    Column(
        "error",
        itemgetter(1),
        "error",
        show=lambda off: "-" if off is None else f"{off:.1e}",
        width=9,
    ),
    Column(
        "ms",
        lambda step: step[0].seconds,
        "seconds",
        "s",
        lambda s: _short_number(s * 1e3),
        10,
        timed=True,
    ),
    Column(
        "times",
        itemgetter(2),
        "times",
        show=lambda times: _short_number(times),
        width=10,
        timed=True,
    ),
)


def _ladder(checked: Check) -> list[Entry]:
    if not checked.ladder:
        return ["none: there is no factor of safety to come near to"]
    base = next((rung.seconds for rung in checked.ladder if rung.method == "closed form"), None)
    base_method = "closed form" if base is not None else "quickest"
    legend = (
        f"relative errors against {checked.against} ({checked.reference:.10g}); solver times of this run, as multiples "
        f"of the {base_method}'s"
    )
    least = min(rung.seconds for rung in checked.ladder)
    if checked.result.findings is not None and (first := checked.result.findings.first):
        group_size = f"{len(first.blocks)} of {checked.result.model.moving_blocks} blocks"
        legend += f"; of the group of {group_size} that moves"
    return [legend, Table(_LADDER, list(_ladder_rows(checked, least if base is None else base)))]


def _ladder_rows(checked: Check, base: float) -> Iterator[_LadderRow]:
    previous_method = ""
    for rung, error in zip(checked.ladder, checked.errors, strict=True):
        yield rung, error, rung.seconds / base, rung.method != previous_method
        previous_method = rung.method


def _short_number(value: float) -> str:
    return f"{value:.0f}" if value >= 1000.0 else f"{value:.3g}"


def _verdict(checked: Check) -> str:
    rated = [finding for finding in checked.findings if finding.met is not None]
    failed = [finding.name for finding in rated if not finding.met]
    open_ = [
        finding.name
        for finding in checked.findings
        if finding.met is None and finding.name != "all pairs failed"
    ]
    unrated = f"; not judged: {', '.join(open_)}" if open_ else ""
    if failed:
        counted = f"{', '.join(failed)} ({len(failed)} of {len(rated)})"
        if all(finding.code == "W364" for finding in rated if not finding.met):
            return f"NOT CONSISTENT: {counted}{unrated}. The factor depends on the stiffness of the joints (W364)"
        return (
            f"NOT CONSISTENT: {counted}{unrated}. Do not use the factor before the reason is known"
        )
    if checked.consistent is False:
        return f"NOT CONSISTENT: the methods disagree, or no convergence{unrated}"
    if checked.consistent is None:
        return f"NOT JUDGED: nothing independent to hold it against{unrated}"
    return f"CONSISTENT: all {len(rated)} that were judged are met{unrated}"


_CONSISTENCY_MEANING = (
    "consistent says that the number follows from the model; whether the slope is stable, ACCEPT and the factor say, "
    "whether the model is the slope, no program"
)
