"""The sheet of a study of probability: the estimate, its samples and inputs, the agreement of the methods."""

from collections.abc import Iterator, Sequence
from operator import itemgetter
from typing import Any

import numpy as np

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, counted
from slopekit.design.fields import UNITS
from slopekit.design.scatter.distributions import Angles, Distribution
from slopekit.evidence import WithoutBasal
from slopekit.kinds.words import short
from slopekit.result import STATUSES
from slopekit.studies.marginals import NEVER, tails
from slopekit.studies.prob.estimates import Share, Summary
from slopekit.studies.prob.run import Probability
from slopekit.studies.words import status_words, study_sheet

_MAX_INPUTS = 20
_MAX_SENSITIVITIES = 5  # of the sensitivities on the short sheet
#: Why planes form no block, in a few words; `slopekit explain CODE` says more.
NO_BLOCK = {
    "E201": "joints parallel",
    "E203": "steeper than the face: does not daylight",
    "E204": "plunges into the slope or not at all: does not daylight",
    "E205": "flatter than the upper slope",
    "E440": "a joint does not bound the block",
    "E441": "no rock above the basal joint",
    "E442": "basal joint does not daylight",
    "E443": "basal joint closes no block",
    "E232": "held by its shape: it cannot leave",
    "E206": "a joint parallel to the face",
    "E207": "crack outside the block",
    "E208": "the crack cuts the block in two, or it has no volume",
    "E209": "face and upper slope make no crest",
    "E211": "a bolt misses the block",
    "E212": "a bolt is too short",
    "E486": "larger than its limits of size",
    "E487": "smaller than the least volume",
    "E213": "strikes across the slope",
    "impossible": "a value that no design can have",
}
#: Mechanisms that are judged beside the block, by the prefix of their outcomes.
_SECOND_MECHANISMS = {WithoutBasal.NAME: WithoutBasal.WHAT}
_SAMPLING = {"monte-carlo": "Monte Carlo", "latin-hypercube": "Latin hypercube"}


def sheet_of(study: Probability) -> Sheet:
    """Return the sheet of a study of probability."""
    options, summary, scaled = study.asked, study.summary, study.scaled_down
    samples = f"{study.samples.count} by {_SAMPLING[options.method]}, seed {options.seed}; {study.judged.evaluator}"
    times = "  ".join(f"{name} {value:.3g} s" for name, value in study.timing_s.items())
    return study_sheet(
        study.design,
        "prob",
        (
            Section(
                "RANDOM",
                _inputs(study),
                details=[
                    f"rank correlation {a} / {b}: {number(value)}"
                    for a, b, value in study.design.correlation
                ],
            ),
            Section("SAMPLES", [samples]),
            Section("OUTCOMES", [_outcomes(study)]),
            Section(f"P(FoS < {options.target:g})", [_probabilities(study)]),
            Section("FoS", [] if summary is None else [_mean_text(summary, options.target)]),
            Section("SENSITIVITY", [_sensitivity_text(study.sensitivities[:_MAX_SENSITIVITIES])]),
            Section(
                "SIZE",
                [f"limits of size: {counted(scaled, 'sample')} made smaller"] if scaled else [],
            ),
            Section("METHODS", _methods(study)),
            Section("ACCEPT", _acceptance(study)),
            Section("TIME", [times]),
            Section("NOTE", [str(notice) for notice in study.warnings]),
        ),
        {"samples.csv": _sample_table(study)},
    )


def line_of(study: Probability) -> str:
    """Return the probability of failure with its limits on one line."""
    share, accept = study.all_samples, study.asked.accept
    phrases = [f"P(FoS < {study.asked.target:g})"]
    if accept is not None:  # acceptance goes by the upper limit, so that comes first
        doubt = " (in doubt)" if not study.accepted and share.high <= accept else ""
        phrases.append(
            f"at most {_upper_limit_text(share.high, accept)}, accepted {number(accept * 100)} %"
        )
        phrases += [
            "met" if study.accepted else f"not met{doubt}",
            f"estimate {_percent(share.share)}",
        ]
    else:
        phrases += [_percent(share.share), _limits_text(share)]
    if study.by_closed_form is not None:
        phrases.append(f"closed form {_percent(study.by_closed_form.share)}")
    if study.both is not None and study.design.HAS_CLOSED_FORM:
        phrases.append(
            "disagree"
            if study.methods_disagree
            else "agree"
            if study.both.agree
            else "not compared"
        )
    phrases += list(dict.fromkeys(notice.code for notice in study.warnings))
    return "  ".join(phrases)


def _sample_table(study: Probability) -> Table[tuple[Any, ...]]:
    """Return the table of all samples: number, values, outcome, factors."""
    samples, factor_key = (
        study.samples,
        "fos_closed_form" if study.asked.by == "closed-form" else "fos_limit",
    )
    sizes = study.rows.sizes(0, 1, study.judged.forms[:1])
    titles = [(name, name) for name in ("sample", *samples.names, "outcome", "fails", *sizes)]
    titles.insert(-1 - len(sizes), ("FoS", factor_key))
    if study.closed_form is not None:
        titles += [("closed form", "fos_closed_form"), ("moments govern", "moments_govern")]
    return Table(
        [Column(title, itemgetter(k), key) for k, (title, key) in enumerate(titles)],
        _SampleLines(study),
    )


class _SampleLines(Sequence[tuple[Any, ...]]):
    """The table rows of all samples, made on access."""

    def __init__(self, study: Probability) -> None:
        self.study = study

    def __len__(self) -> int:
        return self.study.samples.count

    def __getitem__(self, row: Any) -> Any:
        if not isinstance(row, slice):
            place = range(len(self))[row]
            return self[place : place + 1][0]
        start, stop, _ = row.indices(len(self))
        rows, study, verdicts, outcomes = (
            slice(start, stop),
            self.study,
            self.study.judged,
            self.study.outcomes,
        )
        names = np.array(verdicts.names, dtype=object)
        columns = [
            np.arange(start, stop),
            *study.samples.rows(start, stop).T,
            names[verdicts.outcome[rows]],
        ]
        columns += [verdicts.factor[rows], verdicts.fails[rows].astype(int)]
        columns += study.rows.sizes(start, stop, verdicts.forms[rows]).values()
        if outcomes is not None and study.closed_form is not None:
            columns += [study.closed_form.factor[rows], outcomes.moments_govern[rows].astype(int)]
        return list(zip(*(column.tolist() for column in columns), strict=True))


def _inputs(study: Probability) -> list[Entry]:
    columns: list[Column[Any]] = [Column("as drawn", itemgetter("path"), "path", width=-38)]
    for name, width in (("mean", 12), ("sd", 12), ("min", 0), ("max", 0)):
        columns.append(Column(name, itemgetter(name), name, show=short, width=width))
    units = {
        name: UNITS[getattr(variable.distribution, "kind", "angle")]
        for variable in study.samples.variables
        for name in variable.columns
    }
    columns.append(Column("unit", lambda row: units[row["path"]], "unit", width=1, about="  {}"))
    hidden_count = len(study.variables) - _MAX_INPUTS
    remark = f"and {hidden_count} more: see the JSON" if hidden_count > 0 else ""
    return [
        Table(columns, study.variables, study.variables[:_MAX_INPUTS], remark),
        *_dips_past_vertical(study),
    ]


def _dips_past_vertical(study: Probability) -> Iterator[str]:
    """Yield a remark for each variable whose dips are drawn beyond 0 to 90°."""
    for variable in study.samples.variables:
        distribution = variable.distribution
        if (
            variable.orientation_kind == "plane"
            and isinstance(distribution, Angles)
            and isinstance(distribution.steep, Distribution)
        ):
            probability = sum(tails(distribution.steep, 0.0, 90.0))
            if probability > NEVER:
                yield (
                    f"{_percent(probability)} of the dips of {variable.path} lie beyond 0 to 90°: "
                    "those dip the other way"
                )


def _outcomes(study: Probability) -> Table[tuple[str, int]]:
    def words(outcome: tuple[str, int]) -> str:
        name = outcome[0]
        for prefix, mechanism in _SECOND_MECHANISMS.items():
            if name.startswith(prefix):
                return (
                    f"  {mechanism}: {status_words(study.design, name.removeprefix(f'{prefix}_'))}"
                )
        description = (
            status_words(study.design, name) if name in STATUSES else NO_BLOCK.get(name, "")
        )
        return f"  {f'{name}: ' if name.startswith('E') else ''}{description or name}"

    n_samples = study.samples.count
    columns: list[Column[tuple[str, int]]] = [
        Column("samples", itemgetter(1), "samples", width=9),
        Column(
            "share",
            lambda outcome: outcome[1] / n_samples * 100,
            "share",
            "%",
            lambda share: f"{share:.3g} %",
            10,
        ),
        Column("outcome", itemgetter(0), "outcome", text=words, width=-1),
    ]
    return Table(columns, list(study.counts.items()), headless=True)


def _probabilities(study: Probability) -> Table[tuple[Share, str]]:
    def words(row: tuple[Share, str]) -> str:
        share, population = row
        return f"  {population}: {share.count} of {share.of}; {_limits_text(share)}"

    columns: list[Column[tuple[Share, str]]] = [
        Column("probability", lambda row: row[0].share, "probability", show=_percent, width=11),
        Column("among", itemgetter(1), "among", text=words, width=-1),
    ]
    rows = [(study.all_samples, "of all samples")]
    if study.forming.of != study.all_samples.of:
        rows.append((study.forming, "of those that form a block"))
    if study.by_closed_form is not None:
        rows.append((study.by_closed_form, "by the closed form, forces only"))
    return Table(columns, rows, headless=True)


def _percent(share: float | None) -> str:
    return "none" if share is None else f"{share * 100:.3g} %"


def _upper_limit_text(share: float, accept: float) -> str:
    """Return an upper limit in per cent, with six digits where three would read the same as the accepted one."""
    return f"{share * 100:.6g} %" if _percent(share) == _percent(accept) else _percent(share)


def _limits_text(share: Share) -> str:
    if share.share is None:
        return "no sample to judge by"
    low, high = _percent(share.low), _percent(share.high)
    return f"{share.confidence * 100:g} % limits {low} to {high} ({share.limits_by})"


def _mean_text(summary: Summary, target: float) -> str:
    beta = summary.beta(target)
    reliability = "" if beta is None else f"  beta {beta:.3g}"
    ends = f"from {summary.least:.3f} to {summary.most:.3f}"
    return f"mean {summary.mean:.3f}  sd {summary.sd:.3f}  {ends}{reliability}"


def _sensitivity_text(coefficients: Sequence[tuple[str, float]]) -> str:
    if not coefficients:
        return "fewer than three samples have a factor"
    return (
        " | ".join(f"{name} {value:+.2f}" for name, value in coefficients)
        + " (rank correlation with FoS)"
    )


def _methods(study: Probability) -> list[str]:
    if study.both is None:
        return ["the closed form alone: it balances no moments"]
    if study.design.HAS_CLOSED_FORM:
        return study.both.in_words()
    lost = study.both.without_answer
    return [f"there is no closed form to compare with{f'; {lost} WITHOUT ANSWER' if lost else ''}"]


def _acceptance(study: Probability) -> list[str]:
    accept, verdict = study.asked.accept, "met" if study.accepted else "NOT MET"
    if accept is None:
        return []
    high = _upper_limit_text(study.all_samples.high, accept)
    return [
        f"upper limit {high} <= {number(accept * 100)} %: {', '.join([verdict, *study.doubts])}"
    ]
