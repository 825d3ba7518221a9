"""The sheet of a study of probability: the estimate, what it rests on, how far the methods agree."""

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

_MOST_INPUTS = 20
_FEW = 5  # of the sensitivities on the short sheet
#: Why planes form no block, in a few words; the whole is in `slopekit explain CODE`.
NO_BLOCK = {
    "E201": "joints parallel", "E203": "steeper than the face: does not daylight",
    "E204": "plunges into the slope or not at all: does not daylight", "E205": "flatter than the upper slope",
    "E440": "a joint does not bound the block", "E441": "no rock above the basal joint",
    "E442": "basal joint does not daylight", "E443": "basal joint closes no block",
    "E232": "held by its shape: it cannot leave",
    "E206": "a joint parallel to the face", "E207": "crack outside the block",
    "E208": "the crack cuts the block in two, or it has no volume",
    "E209": "face and upper slope make no crest", "E211": "a bolt misses the block", "E212": "a bolt is too short",
    "E486": "larger than its limits of size", "E487": "smaller than the least volume",
    "E213": "strikes across the slope", "impossible": "a value that no design can have",
}  # fmt: skip
#: What else acceptance is held against, by what its outcomes begin with.
_ALSO = {WithoutBasal.NAME: WithoutBasal.WHAT}
_SAMPLING = {"monte-carlo": "Monte Carlo", "latin-hypercube": "Latin hypercube"}


def sheet_of(study: Probability) -> Sheet:
    """The sheet of a study of probability."""
    asked, summary, scaled = study.asked, study.summary, study.scaled_down
    samples = f"{study.samples.count} by {_SAMPLING[asked.method]}, seed {asked.seed}; {study.judged.evaluator}"
    times = "  ".join(f"{name} {value:.3g} s" for name, value in study.timing_s.items())
    return study_sheet(study.design, "prob", (
        Section("RANDOM", _inputs(study), details=[
            f"rank correlation {a} / {b}: {number(value)}" for a, b, value in study.design.correlation
        ]),
        Section("SAMPLES", [samples]),
        Section("OUTCOMES", [_outcomes(study)]),
        Section(f"P(FoS < {asked.target:g})", [_probabilities(study)]),
        Section("FoS", [] if summary is None else [_mean(summary, asked.target)]),
        Section("SENSITIVITY", [_matters(study.sensitivities[:_FEW])]),
        Section("SIZE", [f"limits of size: {counted(scaled, 'sample')} made smaller"] if scaled else []),
        Section("METHODS", _methods(study)),
        Section("ACCEPT", _accept(study)),
        Section("TIME", [times]),
        Section("NOTE", [str(notice) for notice in study.warnings]),
    ), {"samples.csv": _every_sample(study)})  # fmt: skip


def line_of(study: Probability) -> str:
    """The estimate on one line, with its limits."""
    share, accept = study.all_samples, study.asked.accept
    parts = [f"P(FoS < {study.asked.target:g})"]
    if accept is not None:  # the upper limit is what acceptance hangs on: it leads
        doubt = " (in doubt)" if not study.accepted and share.high <= accept else ""
        parts.append(f"at most {_against(share.high, accept)}, accepted {number(accept * 100)} %")
        parts += ["met" if study.accepted else f"not met{doubt}", f"estimate {_percent(share.share)}"]
    else:
        parts += [_percent(share.share), _limits(share)]
    if study.by_closed_form is not None:
        parts.append(f"closed form {_percent(study.by_closed_form.share)}")
    if study.both is not None and study.design.HAS_CLOSED_FORM:
        parts.append("disagree" if study.methods_disagree else "agree" if study.both.agree else "not compared")
    parts += list(dict.fromkeys(notice.code for notice in study.warnings))
    return "  ".join(parts)


def _every_sample(study: Probability) -> Table[tuple[Any, ...]]:
    """Every sample on a line of its own, by its number: values, outcome, factors."""
    samples, by = study.samples, "fos_closed_form" if study.asked.by == "closed-form" else "fos_limit"
    sizes = study.rows.sizes(0, 1, study.judged.forms[:1])
    titles = [(name, name) for name in ("sample", *samples.names, "outcome", "fails", *sizes)]
    titles.insert(-1 - len(sizes), ("FoS", by))
    if study.closed_form is not None:
        titles += [("closed form", "fos_closed_form"), ("moments govern", "moments_govern")]
    return Table([Column(title, itemgetter(k), key) for k, (title, key) in enumerate(titles)], _Lines(study))


class _Lines(Sequence[tuple[Any, ...]]):
    """The lines of all samples, made when they are asked for."""

    def __init__(self, study: Probability) -> None:
        self.study = study

    def __len__(self) -> int:
        return self.study.samples.count

    def __getitem__(self, row: Any) -> Any:
        if not isinstance(row, slice):
            place = range(len(self))[row]
            return self[place : place + 1][0]
        start, stop, _ = row.indices(len(self))
        rows, study, judged, outcomes = slice(start, stop), self.study, self.study.judged, self.study.outcomes
        names = np.array(judged.names, dtype=object)
        columns = [np.arange(start, stop), *study.samples.rows(start, stop).T, names[judged.outcome[rows]]]
        columns += [judged.factor[rows], judged.fails[rows].astype(int)]
        columns += study.rows.sizes(start, stop, judged.forms[rows]).values()
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
    left = len(study.variables) - _MOST_INPUTS
    rest = f"and {left} more: see the JSON" if left > 0 else ""
    return [Table(columns, study.variables, study.variables[:_MOST_INPUTS], rest), *_beyond_the_vertical(study)]


def _beyond_the_vertical(study: Probability) -> Iterator[str]:
    """Which dips are drawn beyond 0 to 90°, and what becomes of their planes."""
    for variable in study.samples.variables:
        own = variable.distribution
        if variable.of == "plane" and isinstance(own, Angles) and isinstance(own.steep, Distribution):
            beyond = sum(tails(own.steep, 0.0, 90.0))
            if beyond > NEVER:
                yield f"{_percent(beyond)} of the dips of {variable.path} lie beyond 0 to 90°: those dip the other way"


def _outcomes(study: Probability) -> Table[tuple[str, int]]:
    def words(outcome: tuple[str, int]) -> str:
        name = outcome[0]
        for called, what in _ALSO.items():
            if name.startswith(called):
                return f"  {what}: {status_words(study.design, name.removeprefix(f'{called}_'))}"
        said = status_words(study.design, name) if name in STATUSES else NO_BLOCK.get(name, "")
        return f"  {f'{name}: ' if name.startswith('E') else ''}{said or name}"

    of = study.samples.count
    columns: list[Column[tuple[str, int]]] = [
        Column("samples", itemgetter(1), "samples", width=9),
        Column("share", lambda outcome: outcome[1] / of * 100, "share", "%", lambda share: f"{share:.3g} %", 10),
        Column("outcome", itemgetter(0), "outcome", text=words, width=-1),
    ]
    return Table(columns, list(study.counts.items()), headless=True)


def _probabilities(study: Probability) -> Table[tuple[Share, str]]:
    def words(row: tuple[Share, str]) -> str:
        share, among = row
        return f"  {among}: {share.count} of {share.of}; {_limits(share)}"

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


def _against(share: float, accept: float) -> str:
    """An upper limit in per cent, in six digits where three would hide on which side of the accepted one it lies."""
    return f"{share * 100:.6g} %" if _percent(share) == _percent(accept) else _percent(share)


def _limits(share: Share) -> str:
    if share.share is None:
        return "no sample to judge by"
    low, high = _percent(share.low), _percent(share.high)
    return f"{share.confidence * 100:g} % limits {low} to {high} ({share.limits_by})"


def _mean(summary: Summary, target: float) -> str:
    beta = summary.beta(target)
    reliability = "" if beta is None else f"  beta {beta:.3g}"
    ends = f"from {summary.least:.3f} to {summary.most:.3f}"
    return f"mean {summary.mean:.3f}  sd {summary.sd:.3f}  {ends}{reliability}"


def _matters(coefficients: Sequence[tuple[str, float]]) -> str:
    if not coefficients:
        return "fewer than three samples have a factor"
    return " | ".join(f"{name} {value:+.2f}" for name, value in coefficients) + " (rank correlation with FoS)"


def _methods(study: Probability) -> list[str]:
    if study.both is None:
        return ["the closed form alone: it balances no moments"]
    if study.design.HAS_CLOSED_FORM:
        return study.both.in_words()
    lost = study.both.without_answer
    return [f"there is no closed form to compare with{f'; {lost} WITHOUT ANSWER' if lost else ''}"]


def _accept(study: Probability) -> list[str]:
    accept, met = study.asked.accept, "met" if study.accepted else "NOT MET"
    if accept is None:
        return []
    high = _against(study.all_samples.high, accept)
    return [f"upper limit {high} <= {number(accept * 100)} %: {', '.join([met, *study.doubts])}"]
