"""The sheet of a study of probability, 100 columns: the estimate, what it rests on, what PRE-IE says of it."""

import textwrap

from slopekit._version import __version__
from slopekit.core.sheet import LABEL, WIDTH, block
from slopekit.kinds import status_text
from slopekit.orientation import number
from slopekit.result import STATUSES
from slopekit.studies.confirmation import Confirmation
from slopekit.studies.estimates import QUANTILES, Share, Summary
from slopekit.studies.probability import Probability
from slopekit.studies.probability_records import variable

_ROWS, _BAR, _MOST_INPUTS = 16, 50, 20
#: Why planes form no block, in a few words; the whole is in `slopekit explain CODE`.
NO_BLOCK = {
    "E201": "joints parallel", "E203": "steeper than the face: does not daylight",
    "E204": "plunges into the slope or not at all: does not daylight", "E205": "flatter than the upper slope",
    "E206": "a joint parallel to the face", "E207": "crack outside the block", "E208": "no volume",
    "E209": "face and upper slope make no crest", "E211": "a bolt misses the block", "E212": "a bolt is too short",
    "E213": "strikes across the slope", "impossible": "a value that no design can have",
}  # fmt: skip
_SAMPLING = {"monte-carlo": "Monte Carlo", "latin-hypercube": "Latin hypercube", "sobol": "Sobol"}


def probability_sheet(study: Probability) -> str:
    """The sheet, lines joined, no trailing newline."""
    design, asked = study.design, study.asked
    title = f"   {design.title}" if design.title else ""
    head = f"slopekit {__version__}   prob   {design.kind}   sha {design.input_hash()[:6]}{title}"
    lines = textwrap.wrap(head, WIDTH, subsequent_indent=" " * LABEL)
    lines += block("SCATTERS", _inputs(study))
    lines += block(
        "SAMPLES", [f"{len(study.samples.values)} by {_SAMPLING[asked.method]}, seed {asked.seed}; {study.evaluator}"]
    )
    lines += block("OUTCOMES", _outcomes(study))
    lines += block(f"P(F < {asked.target:g})", _probabilities(study))
    lines += block("AT MEANS", [_at_means(study)])
    if study.summary is not None:
        lines += block("FoS", _factors(study.summary, asked.target))
        lines += block("HISTOGRAM", _histogram(study.summary, asked.target))
    lines += block("MATTERS", [_matters(study)])
    lines += block("PRE-IE", _pre_ie(study))
    lines += block("ACCEPT", _accept(study))
    lines += block("TIME", ["  ".join(f"{name} {value:.3g} s" for name, value in study.timing_s.items())
                            + f"  ({study.crew})"])  # fmt: skip
    lines += block("NOTE", [str(notice) for notice in study.warnings])
    return "\n".join(lines)


def probability_line(study: Probability) -> str:
    """The estimate on one line, with its limits."""
    parts = [f"P(F < {study.asked.target:g})", _percent(study.all_samples.share), _limits(study.all_samples)]
    parts += [] if study.accepted is None else ["met" if study.accepted else "not met"]
    checked = study.confirmation
    if checked is not None:
        parts.append("disagree" if checked.disagree else "agree" if checked.agree else "not compared")
    parts += list(dict.fromkeys(notice.code for notice in study.warnings))
    return "  ".join(parts)


def _inputs(study: Probability) -> list[str]:
    columns = study.samples.names
    lines = [f"{'as drawn':<38}{'mean':>12}{'sd':>12}{'from':>12}{'to':>12}"]
    for column in range(min(len(columns), _MOST_INPUTS)):
        drawn = variable(study, column)
        values = "".join(f"{drawn[key]:>12.5g}" for key in ("mean", "sd", "min", "max"))
        lines.append(f"{drawn['path']:<38}{values}")
    if len(columns) > _MOST_INPUTS:
        lines.append(f"and {len(columns) - _MOST_INPUTS} more: see the JSON")
    lines += [f"rank correlation {a} / {b}: {number(value)}" for a, b, value in study.design.correlation]
    return lines


def _outcomes(study: Probability) -> list[str]:
    lines = []
    for name, count in study.counts.items():
        words = status_text(study.design.kind, name) if name in STATUSES else NO_BLOCK.get(name, "")
        code = f"{name}: " if name.startswith("E") else ""
        lines.append(f"{count:>9}  {count / len(study.samples.values) * 100:6.2f} %  {code}{words or name}")
    return lines


def _probabilities(study: Probability) -> list[str]:
    lines = []
    for share, name in ((study.all_samples, "of all samples"), (study.forming, "of those that form a block")):
        lines.append(f"{_percent(share.share):>11}  {name}: {share.count} of {share.of}; {_limits(share)}")
    return lines


def _percent(share: float | None) -> str:
    if share is None:
        return "none"
    return f"{share * 100:.4g} %"


def _limits(share: Share) -> str:
    if share.share is None:
        return "no sample to judge by"
    low, high = _percent(share.low), _percent(share.high)
    return f"{share.confidence * 100:g} % limits {low} to {high} ({share.limits_by})"


def _at_means(study: Probability) -> str:
    found = study.means.factors
    if found is None:
        return f"{study.means.code} {study.means.message}".strip() or "not asked"
    named = ((found.limit, "PRE-IE"), (found.closed_form, "closed form"))
    factors = [f"{value:.4f} {name}" for value, name in named if value is not None]
    words = status_text(study.design.kind, found.status)
    return f"{words}: F {', '.join(factors)}" if factors else words


def _factors(summary: Summary, target: float) -> list[str]:
    beta = summary.beta(target)
    return [
        f"mean {summary.mean:.4f}  sd {summary.sd:.4f}  from {summary.least:.4f} to {summary.most:.4f}"
        + ("" if beta is None else f"  beta {beta:.3g} (mean above the target, in sd)"),
        "  ".join(f"{share * 100:g} %: {value:.4f}" for share, value in zip(QUANTILES, summary.quantiles, strict=True)),
    ]


def _histogram(summary: Summary, target: float) -> list[str]:
    """Bars of neighbouring bins together, so that a sheet holds them."""
    together = -(-len(summary.counts) // _ROWS)
    starts = range(0, len(summary.counts), together)
    counts = [sum(summary.counts[start : start + together]) for start in starts]
    lines = [f"{'':>9}   {summary.below} lower"] if summary.below else []
    for start, count in zip(starts, counts, strict=True):
        low, high = summary.edges[start], summary.edges[min(start + together, len(summary.counts))]
        mark = "|" if low <= target < high else " "
        lines.append(f"{low:>9.4f} {mark} {'#' * round(_BAR * count / max(*counts, 1))} {count}")
    return lines + ([f"{'':>9}   {summary.above} higher"] if summary.above else [])


def _matters(study: Probability) -> str:
    found = [f"{name} {value:+.2f}" for name, value in study.sensitivities[:8]]
    return " | ".join(found) + " (rank correlation with F)" if found else "fewer than three samples have a factor"


def _pre_ie(study: Probability) -> list[str]:
    checked = study.confirmation
    if study.asked.by == "pre-ie":
        return ["every sample is PRE-IE's own"]
    if checked is None:
        return ["not asked: no sample forms a block, or --confirm 0 and none near the target"]
    return [_asked(checked, study.asked.target), _agreement(checked), *_judgement(checked, study)]


def _asked(checked: Confirmation, target: float) -> str:
    return (
        f"{len(checked.index)} samples: {int(checked.at_random.sum())} at random, all {checked.near} within "
        f"{checked.within * 100:g} % of F = {target:g}"
    )


def _agreement(checked: Confirmation) -> str:
    words = [f"{checked.agree} agree", f"{checked.disagree} DISAGREE" if checked.disagree else "0 disagree"]
    words += [f"{checked.not_compared} not compared"] if checked.not_compared else []
    words += [f"{len(checked.index) - checked.settled} WITHOUT ANSWER"] if checked.unsettled else []
    largest = "" if checked.largest is None else f"; largest difference {checked.largest * 100:.2g} %"
    governed = int(checked.at_random.sum())
    return f"{', '.join(words)}{largest}; moments govern in {checked.governed} of {governed} at random"


def _judgement(checked: Confirmation, study: Probability) -> list[str]:
    told = (
        f"judged otherwise: {checked.unsafe} fail by PRE-IE only, {checked.safe} by the closed form only; of all "
        f"samples at most {checked.other_at_most * 100:.2g} % ({study.asked.confidence * 100:g} % confidence, from "
        "those at random)"
    )
    if checked.probability is None:
        return [told]
    share, own = _percent(checked.probability), study.all_samples
    low, high = max(0.0, own.low + checked.change_low), min(1.0, own.high + checked.change_high)
    return [told, f"P(F < {study.asked.target:g}) with PRE-IE's judgement: {share} of all samples; limits "
                  f"{_percent(low)} to {_percent(high)}, which more --confirm narrows"]  # fmt: skip


def _accept(study: Probability) -> list[str]:
    if study.asked.accept is None:
        return []
    met = "met" if study.accepted else "NOT MET"
    high = _percent(study.all_samples.high)
    return [f"upper limit {high} <= {_percent(study.asked.accept)}: {met}"]
