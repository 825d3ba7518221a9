"""The sheet of a checked design: what was looked at, what accuracy costs, 100 columns."""

import textwrap

from slopekit._version import __version__
from slopekit.core.sheet import LABEL, WIDTH, Section, block, factor_text
from slopekit.kinds.sheets.many_blocks import limit_in_words
from slopekit.kinds.sheets.shared import accept, methods
from slopekit.studies.check import Check, Finding

_MARKS = {True: "ok", False: "NO", None: "--"}


def check_sheet(checked: Check) -> str:
    """The sheet of a check, lines joined, no trailing newline."""
    result = checked.result
    design = result.design
    title = f"   {design.title}" if design.title else ""
    head = f"slopekit {__version__}   check   {result.kind}   sha {design.input_hash()[:6]}{title}"
    lines = textwrap.wrap(head, WIDTH, subsequent_indent=" " * LABEL)
    lines += block("STATUS", [result.status_text])
    lines += block("FoS", _factors(checked))
    lines += block("LOOKED AT", [_finding(finding) for finding in checked.findings], hang=42)
    lines += Section("COLUMNS", methods(result)).lines()
    lines += block("LADDER", _ladder(checked))
    lines += block("CHEAPEST", _cheapest(checked))
    lines += block("ACCEPT", accept(result))
    lines += block("VERDICT", [_verdict(checked), _MEANING])
    lines += block("NOTE", [str(notice) for notice in result.warnings])
    return "\n".join(lines)


def check_line(checked: Check) -> str:
    """The verdict on one line."""
    fos = checked.result.fos.limit
    factor = "none" if fos is None else f"{fos:.4f}"
    codes = list(dict.fromkeys(notice.code for notice in checked.result.warnings))
    met = [] if checked.result.accepted is None else ["met" if checked.result.accepted else "not met"]
    return "  ".join([checked.result.status, factor, *met, _verdict(checked), *codes])


def _factors(checked: Check) -> list[str]:
    fos = checked.result.fos
    named = [
        (fos.limit, limit_in_words(checked.result)),
        (fos.closed_form, "closed form"),
        (fos.static_bound, "static bound (joints free to dilate; upper bound)"),
    ]
    lines = [f"{factor_text(value)}  {name}" for value, name in named]
    if fos.lowest is not None or fos.highest is not None:
        ends = f"{factor_text(fos.lowest).strip()} .. {factor_text(fos.highest).strip()}"
        lines.insert(2, f"{ends}  same mechanism, whatever forces are locked in")
    if checked.result.moments_govern:
        lines.append("moments govern: the limit is the number to use, the closed form knows no moments")
    if checked.result.words.assumes and fos.limit is not None:
        lines.append(
            "on a curved surface equilibrium alone does not fix the factor: this is that of a rigid mass on an even "
            "elastic bed; judge by all that is given"
        )
    if checked.result.findings is not None and fos.limit is not None:
        moving = len(checked.result.findings.mechanisms[0].blocks)
        lines.append(f"{moving} of {checked.result.model.moving_blocks} blocks move; the ladder is that of their group")
    return lines


def _finding(finding: Finding) -> str:
    value = (
        "" if finding.value is None else f"{finding.value:.4g}" if finding.wanted is None else f"{finding.value:.1e}"
    )
    wanted = "" if finding.wanted is None else f"<= {finding.wanted:g}"
    return f"{_MARKS[finding.met]}  {finding.name:<16} {value:>8} {wanted:<9} {finding.words}"


def _ladder(checked: Check) -> list[str]:
    if not checked.ladder:
        return ["none: there is no factor of safety to come near to"]
    base = next((rung.seconds for rung in checked.ladder if rung.method == "closed form"), None)
    than = "closed form" if base is not None else "quickest"
    base = min(rung.seconds for rung in checked.ladder) if base is None else base
    lines = [
        f"relative errors against {checked.against} ({checked.reference:.10g}); solver times of this run, as multiples "
        f"of the {than}'s; plain passes start cold and keep every bond, the limit lets go what opens"
    ]
    lines.append(f"{'method':<13}{'setting':<23}{'pairs':>6}{'F':>13}{'error':>9}{'ms':>10} {'times':>9}")
    said = ""
    for rung, error in zip(checked.ladder, checked.errors, strict=True):
        method, said = rung.method if rung.method != said else "", rung.method
        factor = "none" if rung.factor is None else f"{rung.factor:.8g}"
        off = "-" if error is None else f"{error:.1e}"
        pairs = "" if rung.node_pairs is None else str(rung.node_pairs)
        lines.append(
            f"{method:<13}{rung.setting:<23}{pairs:>6}{factor:>13}{off:>9}{_brief(rung.seconds * 1e3):>10} "
            f"{_brief(rung.seconds / base):>9}"
        )
    return lines


def _brief(value: float) -> str:
    return f"{value:.0f}" if value >= 1000.0 else f"{value:.3g}"


def _cheapest(checked: Check) -> list[str]:
    within = f"{checked.result.design.agree_within * 100:g} %, agree_within"
    if checked.cheapest is None:
        return [f"no setting that may be used comes within {within}"] if checked.ladder else []
    rung, error = checked.ladder[checked.cheapest], checked.errors[checked.cheapest]
    return [f"{rung.method}, {rung.setting}: {_brief(rung.seconds * 1e3)} ms, error {error:.1e} (wanted {within})"]


def _verdict(checked: Check) -> str:
    judged = [finding for finding in checked.findings if finding.met is not None]
    failed = [finding.name for finding in judged if not finding.met]
    open_ = [finding.name for finding in checked.findings if finding.met is None and finding.name != "all pairs failed"]
    left = f"; not judged: {', '.join(open_)}" if open_ else ""
    if failed:
        counted = f"{', '.join(failed)} ({len(failed)} of {len(judged)})"
        if all(finding.code == "W364" for finding in judged if not finding.met):
            return f"NOT CONSISTENT: {counted}{left}. The factor hangs on the stiffness of the joints (W364)"
        return f"NOT CONSISTENT: {counted}{left}. Do not use the factor before the reason is known"
    if checked.consistent is False:
        return f"NOT CONSISTENT: the methods disagree, or no convergence{left}"
    if checked.consistent is None:
        return f"NOT JUDGED: nothing independent to hold it against{left}"
    return f"CONSISTENT: all {len(judged)} that were judged are met{left}"


_MEANING = (
    "consistent says that the number follows from the model; whether the slope is stable, ACCEPT and the factor say, "
    "whether the model is the slope, no program"
)
