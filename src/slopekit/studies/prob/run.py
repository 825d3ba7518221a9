"""Probability of failure: samples of what scatters, the closed form of all of them, PRE-IE of some of them or of all.

samples -> outcome and factor of each -> PRE-IE where it matters -> shares with their confidence limits.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.codec import json_of, record_of
from slopekit.core.errors import DesignError, Fault, Faults, Notice, SlopekitError
from slopekit.core.onlooker import Clock
from slopekit.core.orientation import number
from slopekit.core.sheet import Column, counted
from slopekit.design.common import Design
from slopekit.design.fields import field_in
from slopekit.design.reading.files import with_values
from slopekit.evidence import WithoutBasal
from slopekit.kinds import dilates, kind_of, likely_slips, peak_only
from slopekit.notices import new_notices, not_as_given
from slopekit.studies.marginals import checked_limits
from slopekit.studies.points import Point, kept_points, point_of
from slopekit.studies.prob.bolts import (
    as_laid_out,
    has_heads,
    holding,
    sample_record,
    standing,
    without_force,
)
from slopekit.studies.prob.cracks import checked_alone, cracked
from slopekit.studies.prob.estimates import Share, Summary, sample_statistics, share_of, summary_of
from slopekit.studies.prob.judged import (
    IMPOSSIBLE,
    Confirmation,
    Judged,
    also_of,
    chosen,
    confirmation_of,
    failing,
    notices_of,
    nowhere,
    sensitivities,
    with_also,
)
from slopekit.studies.prob.sampling import METHODS, Method, Samples
from slopekit.studies.prob.sampling import samples as drawn
from slopekit.studies.prob.vectorised import Vectorised, vectorised
from slopekit.studies.protocol import (
    DESK,
    ADesign,
    Jobs,
    Option,
    Scheduler,
    Seed,
    StudyOutcome,
    Workplace,
    number_of,
    study,
    whole_number,
)
from slopekit.studies.running import Crew, Journal, checked_crew

By = Literal["closed-form", "pre-ie"]
#: Samples where the closed form does the work, and where PRE-IE has to.
MANY, FEW = 20_000, 1_000
_MOST, _MOST_BY_PRE_IE = 5_000_000, 1_000_000


@dataclass(frozen=True)
class ProbabilityOptions:
    """What a study of probability was asked for.

    Attributes
    ----------
    n : samples; seed : of all random numbers; method : of sampling
    by : whose factors count: the closed form's, or PRE-IE's of every sample
    target : what fails has a factor of safety below it
    confirm : samples taken at random that PRE-IE looks at too
    near : those within this part of the target are looked at besides
    confidence : of the limits; accept : largest probability that is accepted, None where none is given
    """

    n: int
    seed: int
    method: Method
    by: By
    target: float
    confirm: int
    near: float
    confidence: float
    accept: float | None


@dataclass(frozen=True, repr=False)
class Probability(StudyOutcome):
    """What came of it.

    Attributes
    ----------
    samples : what was drawn; judged : the outcome of each, its factor by the method that counts, whether it fails
    all_samples, forming : the probability of failure among all possible samples, and among those that form a block
    confirmation : what PRE-IE says, None where it was not asked apart
    journals : of a run with a folder, kept until its results are written
    sizes : volume, height, width and setback of each sample (n,) by their keys, nan where none forms; empty where they
        are not known
    """

    name: ClassVar[str] = "prob"
    design: Design
    asked: ProbabilityOptions
    samples: Samples
    judged: Judged
    all_samples: Share
    forming: Share
    confirmation: Confirmation | None
    of_samples: tuple[Notice, ...]
    timing_s: Mapping[str, float]
    journals: tuple[Journal, ...] = field(default=(), compare=False)
    sizes: Mapping[str, Floats] = field(default_factory=dict)

    @property
    def charts(self) -> tuple[str, ...]:
        """Its histogram."""
        return ("histogram",)

    # what is asked of a study that is shown, and of none of the many that a range of means makes

    @cached_property
    def variables(self) -> tuple[dict[str, Any], ...]:
        """What was drawn of each number, in short."""
        samples = self.samples
        return tuple(sample_statistics(*column) for column in zip(samples.names, samples.values.T, strict=True))

    @cached_property
    def summary(self) -> Summary | None:
        """The factors in short, None where there is none."""
        return summary_of(self.judged.factor)

    @cached_property
    def means(self) -> Point:
        """The design at the centres of its distributions."""
        return point_of(self.design, {})

    @cached_property
    def warnings(self) -> tuple[Notice, ...]:
        """What a reader must know: of the samples, and what a run says of the design at its means."""
        notes = new_notices(self.means.notes, self.of_samples)
        at_means = (Notice(note.code, f"of the design at its means: {note.message}") for note in notes)
        peak = peak_only(self.design, "samples are judged by factors")
        return (*self.of_samples, *at_means, *peak)

    @cached_property
    def sensitivities(self) -> tuple[tuple[str, float], ...]:
        """Column and Spearman's coefficient with the factor, the strongest first."""
        return sensitivities(self.samples, self.judged.factor)

    @property
    def scaled_down(self) -> int:
        """How many samples limits of size made smaller."""
        return int((self.sizes["scale"] < 1.0).sum()) if "scale" in self.sizes else 0

    def done(self) -> None:
        """Remove what was kept for an interruption: the results are written."""
        for journal in self.journals:
            journal.remove()

    @property
    def counts(self) -> dict[str, int]:
        """How many samples there are of each outcome, the most frequent first."""
        frequencies = np.bincount(self.judged.outcome, minlength=len(self.judged.names)).tolist()
        counts = Counter(dict(zip(self.judged.names, frequencies, strict=True)))
        return {name: count for name, count in counts.most_common() if count}

    @property
    def accepted(self) -> bool | None:
        """Whether the upper confidence limit is not above the probability accepted, and nothing speaks against it.

        What `doubts` has speaks against it.
        """
        if self.asked.accept is None:
            return None
        return not self.doubts and self.all_samples.high <= self.asked.accept

    @property
    def methods_disagree(self) -> bool:
        """Whether closed form and PRE-IE disagree at the means or in a sample."""
        return bool(self.judged.disagree or (self.confirmation is not None and self.confirmation.disagree))

    @property
    def doubts(self) -> list[str]:
        """Why nothing is accepted, however low the limit is."""
        checked, doubts = self.confirmation, []
        if self.methods_disagree:
            doubts.append("the methods disagree")
        unjudged = int(self.judged.unjudged.sum())
        if self.forming.of == 0 and not unjudged:
            doubts.append("no sample forms a block")
        if unjudged:
            doubts.append(f"{counted(unjudged, 'sample')} not judged")
        if checked is not None and checked.unsafe:
            doubts.append(f"{checked.unsafe} fail by PRE-IE only")
        if checked is not None and checked.settled < checked.samples:
            doubts.append(f"PRE-IE answers for {checked.settled} of the {checked.samples} samples it was asked of")
        return doubts

    @property
    def margin(self) -> float | None:
        """The probability that it does not fail."""
        share = self.leading["probability"]
        return None if share is None else 1.0 - share

    def case_columns(self) -> list[Column[Any]]:
        """The probability of failure to lead with, its limits."""
        columns = (("P of failure", "probability", 14), ("from", "low", 10), ("to", "high", 10))
        return [
            Column(title, _leading_figure(name), name, show=".3g", width=width)
            for title, name, width in columns
        ]  # fmt: skip

    @property
    def leading(self) -> dict[str, Any]:
        """The probability to lead with, its limits `low` and `high`, and by whom.

        That of the method that counts, PRE-IE's judgement where that is higher.
        """
        own, checked = self.all_samples, self.confirmation
        by = "PRE-IE" if self.asked.by == "pre-ie" else "closed form"
        if checked is None or checked.probability is None or own.share is None or checked.probability <= own.share:
            return {"probability": own.share, "low": own.low, "high": own.high, "by": by}
        low, high = max(0.0, own.low + checked.change_low), min(1.0, own.high + checked.change_high)
        return {"probability": checked.probability, "low": low, "high": high, "by": "PRE-IE's judgement"}

    @property
    def exit_code(self) -> int:
        """0 done, 1 not accepted, 3 no sample forms a block, 4 the methods disagree, or no convergence."""
        if self.methods_disagree:
            return 4
        if self.forming.of == 0 and not self.judged.unjudged.any():
            return 3
        return 1 if self.accepted is False else 0

    def to_dict(self) -> dict[str, Any]:
        """The study as JSON values; the samples themselves are in the CSV."""
        asked, summary, judged = self.asked, self.summary, self.judged
        return {
            **self.head(self.design),
            "n": len(self.samples.values), "replicates": int(self.samples.replicate.max()) + 1, "seed": asked.seed,
            "sampling": asked.method, "by": asked.by, "evaluator": self.judged.evaluator, "target": asked.target,
            "probability_of_failure": {
                "all_samples": record_of(self.all_samples), "samples_that_form_a_block": record_of(self.forming),
            },
            "leading": json_of(self.leading),
            "accept": asked.accept, "accepted": self.accepted, "outcomes": self.counts,
            "fos": None if summary is None else record_of(summary) | {"beta": summary.beta(asked.target)},
            "histogram": None if summary is None else {
                "edges": list(summary.edges), "counts": list(summary.counts), "below": summary.below,
                "above": summary.above, "failing_without_factor": int((judged.fails & np.isnan(judged.factor)).sum()),
            },
            "variables": list(self.variables),
            "correlation": [{"between": [a, b], "rank": value} for a, b, value in self.design.correlation],
            "sensitivity": [
                {"variable": name, "rank_correlation_with_fos": value} for name, value in self.sensitivities
            ],
            "pre_ie": json_of(self.confirmation),
            "scaled_down": self.scaled_down,
            "defaults": list(self.design.reading.defaults),
            "timing_s": dict(self.timing_s),
            **self.words(),
        }  # fmt: skip


#: Largest probability accepted; the old word is still understood.
Accept = Annotated[float | None, Option(
    "Largest probability of failure accepted; exit code 1 where the upper limit lies above.", number_of,
    "--accept-pf", also=("--accept",),
)]  # fmt: skip


@study
def prob(
    design: ADesign,
    n: Annotated[int | None, Option("Samples [20000; 1000 where PRE-IE does them all].", whole_number, "-n")] = None,
    *,
    method: Annotated[Method, Option("monte-carlo or latin-hypercube [monte-carlo].")] = "monte-carlo",
    by: Annotated[By | None, Option("closed-form or pre-ie: whose factors count.")] = None,
    fos: Annotated[
        float, Option("What fails has a factor of safety below this [1].", number_of, also=("--target",))
    ] = 1.0,
    confirm: Annotated[int, Option("Samples at random that PRE-IE looks at too [200].", whole_number)] = 200,
    near: Annotated[float | None, Option("It looks at all within this of the target [1%].", number_of)] = None,
    confidence: Annotated[float, Option("Of the confidence limits [95%].", number_of)] = 0.95,
    accept: Accept = None,
    seed: Seed = 1,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Probability:
    """Probability of failure: Monte Carlo or Latin hypercube on the distributions of a design.

    The closed form judges every sample; PRE-IE looks at some at random and at all near the target. Ctrl-C keeps what
    is done: the same command goes on from there. Exit codes: 0 done, 1 not accepted, 4 the methods disagree.

    Raises
    ------
    DesignError
        E302 nothing scatters, E307 a number out of range, E126 a word that is none of those known, E125 a worst
        crack of many samples that is looked for in each by itself, and those of `run_all`.

    Notes
    -----
    Of n samples m fail (F below the target, or no equilibrium): p = m / n. Monte Carlo has limits by Clopper & Pearson,
    a Latin hypercube by replicates; the standard error of plain sampling is √(p (1 - p) / n). Correlations are those of
    ranks, by a Gaussian copula.

    References
    ----------
    Clopper & Pearson (1934), Biometrika 26, 404-413 (from memory).

    Examples
    --------
    >>> import slopekit as sk
    >>> design = sk.load({
    ...     "slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    ...     "strength": {"weak": {"c": 50, "phi": {"dist": "normal", "mean": 20, "sd": 4}}}})
    >>> found = sk.prob(design, n=1000, fos=1.2, confirm=2, near=0)
    >>> share = found.all_samples
    >>> share.count, share.of, round(share.low, 3), round(share.high, 3)
    (75, 1000, 0.059, 0.093)
    """
    crew = checked_crew(jobs, scheduler)
    if design.analysis.partial is not None:
        message = "partial factors allow for the scatter that a probability draws: with both it would count twice"
        advice = "Take analysis.partial_factors out for it, or: --set analysis.partial_factors=null"
        raise DesignError([Fault("E313", message, "analysis.partial_factors", advice)])
    asked = _asked(design, n, seed, method, by, fos, confirm, near, confidence, accept)
    clock = Clock()
    with clock("draw"):
        samples = drawn(design.variables, design.correlation, asked.n, asked.seed, asked.method)
    with clock("factors"):
        # a crack that is looked for is at a place of its own in each sample, as if that had been drawn
        cracks = cracked(design, samples)
        if cracks is None and bool(getattr(design, "crack_searched", "")):
            checked_alone(design, asked.n)
        placed, those = (design, samples) if cracks is None else cracks[:2]
        journals = list[Journal]()
        ask = partial(_points, placed, asked, crew, desk, journals)
        fast = vectorised(placed, those.values, those.settings)
        if fast is None and cracks is None:
            checked_alone(design, asked.n)  # no block at the mean values
        judged = _judge(those, placed, asked, ask, fast)
        if cracks is not None:
            judged = nowhere(judged, cracks[2])
        of_bolts = without_force(placed, _holding(those, placed, fast), judged.forms)
        sizes = {} if fast is None else fast.sizes(those.values, judged.forms)
    confirmation = None
    if asked.by == "closed-form":
        with clock("confirm"):
            confirmation = _confirmed(those, judged, asked, ask)
    all_samples = share_of(judged.fails, judged.counted, samples.replicate, confidence)
    forming = share_of(judged.fails, judged.counted & judged.forms, samples.replicate, confidence)
    probability = Probability(
        design, asked, samples, judged, all_samples, forming, confirmation,
        (*notices_of(asked.target, judged, samples, all_samples, confirmation), *of_bolts,
         *not_as_given(design), *likely_slips(design)), clock.done(), tuple(journals), sizes,
    )  # fmt: skip
    if desk.folder is None:
        probability.done()
    return probability


def _leading_figure(name: str) -> Callable[[Probability], float | None]:
    return lambda study: study.leading[name]


class _Settings(Sequence[Mapping[str, object]]):
    """The samples as settings, each made when it is asked for."""

    def __init__(self, samples: Samples) -> None:
        self.samples = samples

    def __len__(self) -> int:
        return len(self.samples.values)

    def __getitem__(self, row: Any) -> Any:
        return self.samples.settings(row)


def _points(
    design: Design, asked: ProbabilityOptions, crew: Crew, desk: Workplace, journals: list[Journal], label: str,
    tasks: Sequence[Mapping[str, object]], part: Sequence[object], pre_ie: bool = True,
) -> tuple[Point, ...]:  # fmt: skip
    """The points of some samples, kept by the name of the part in a journal, which is added to those that there are."""
    plain = design.source.root.plain() if design.source is not None else None
    run: list[object] = [plain, design.input_hash(), repr(design.variables), repr(design.correlation)]
    run += ["heads on the face"] if has_heads(design) else []
    run += [asked.n, asked.seed, asked.method, asked.by, *part]
    work = partial(sample_record, design, pre_ie, tuple(as_laid_out(design).tolist()))
    points, journal = kept_points(work, tasks, crew, desk, "prob", label, run)
    journals.append(journal)
    return points


def _asked(
    design: Design, n: int | None, seed: int, method: Method, by: By | None, target: float, confirm_count: int,
    near: float | None, confidence: float, accept: float | None,
) -> ProbabilityOptions:  # fmt: skip
    """What was asked for, checked."""
    faults = Faults()
    if not design.variables:
        advice = "Write one: phi: {dist: normal, mean: 20, sd: 2}."
        faults.append(Fault("E302", "nothing in this design scatters: no number is a distribution", "", advice))
    if method not in METHODS:
        faults.append(Fault("E126", f"{method} is not a way to draw samples", "", f"Known: {', '.join(METHODS)}."))
    if by not in (None, "closed-form", "pre-ie"):
        faults.append(Fault("E126", f"{by} is not a method", "", "Known: closed-form, pre-ie."))
    known = kind_of(design).closed_form is not None
    if by == "closed-form" and not known:
        faults.append(Fault("E126", f"a {design.kind} has no closed form to sample", "", "Take pre-ie."))
    may_dilate = dilates(design) or any(variable.path.endswith(".dilation") for variable in design.variables)
    chosen: By = "pre-ie" if by == "pre-ie" or not known or (by is None and may_dilate) else "closed-form"
    most = _MOST if chosen == "closed-form" else _MOST_BY_PRE_IE
    n = (MANY if chosen == "closed-form" else FEW) if n is None else n
    near = design.analysis.agree_within if near is None else near
    for name, value, low, high in (
        ("n", n, 1, most), ("seed", seed, 0, 2**63 - 1), ("the target", target, 1e-6, 1e6),
        ("confirm", confirm_count, 0, most), ("near", near, 0.0, 10.0), ("confidence", confidence, 0.5, 0.9999),
        ("accept", 0.0 if accept is None else accept, 0.0, 1.0),
    ):  # fmt: skip
        if not low <= value <= high:
            message = f"{name} is {number(value)}, it lies between {number(low)} and {number(high)}"
            advice = "A part of all is written 0.95 or 95%." if name in ("confidence", "near") else ""
            advice = "It is a probability of failure, 0.05 or 5%, no factor of safety." if name == "accept" else advice
            faults.append(Fault("E307", message, "", advice))
    faults.refuse()
    checked_limits(design)
    return ProbabilityOptions(n, seed, method, chosen, target, confirm_count, near, confidence, accept)


def _judge(
    samples: Samples, design: Design, asked: ProbabilityOptions, ask: Callable[..., tuple[Point, ...]],
    fast: Vectorised | None,
) -> Judged:  # fmt: skip
    """Outcome and factor of every sample."""
    # passive bolts are searched for wedge by wedge: that is for the crew
    alone = asked.by == "pre-ie" or any(bolt.acts == "passive" for bolt in design.bolts)
    if fast is not None and not alone:
        closed_forms = fast(samples.values)
        names, outcome, factor = (
            (*closed_forms.names, IMPOSSIBLE),
            closed_forms.outcome.astype(np.int16),
            closed_forms.factor,
        )
        impossible = _impossible(design, samples)
        outcome[impossible], factor[impossible] = len(names) - 1, np.nan
        factor[factor == 0.0] = np.nan  # no strength at all: a status, no number (UX.md rule 2)
        fails = failing(names, outcome, factor, asked.target)
        at_once = Judged(names, outcome, factor, fails, "closed form, all at once")
        also = fast.also(samples.values)
        if also is None:
            return at_once
        basal = WithoutBasal  # the only one that closed forms know
        return with_also(at_once, also, basal.NAME, basal.WHAT, asked.target)
    by_pre_ie = asked.by == "pre-ie"
    points = ask("samples", _Settings(samples), ["all"], by_pre_ie)
    words = [point.code if point.factors is None else point.factors.status for point in points]
    names = tuple(dict.fromkeys(words))
    outcome = np.array([names.index(word) for word in words], dtype=np.int16)
    factors = [None if p.factors is None else p.factors.limit if by_pre_ie else p.factors.closed_form for p in points]
    factor = np.array([np.nan if value is None else value for value in factors])
    fails = failing(names, outcome, factor, asked.target)
    evaluator = "PRE-IE of every sample" if by_pre_ie else "closed form, sample by sample"
    judged = Judged(names, outcome, factor, fails, evaluator, points)
    besides = also_of(points, partial(_without_block, design, samples))
    return judged if besides is None else with_also(judged, *besides, asked.target)


def _without_block(design: Design, samples: Samples, row: int) -> WithoutBasal | None:
    """What acceptance is held against besides, of a sample that forms no block."""
    try:
        sample = with_values(design, samples.settings(row))
        return kind_of(sample).without_basal(standing(sample, as_laid_out(design)))
    except SlopekitError:
        return None


def _holding(samples: Samples, design: Design, fast: Vectorised | None) -> Bools:
    """Which bolts (b, n) hold the block of each sample."""
    if not has_heads(design):
        return np.ones((len(design.bolts), len(samples.values)), dtype=bool)
    return holding(design, _Settings(samples)) if fast is None else fast.holds(samples.values)


def _impossible(design: Design, samples: Samples) -> Bools:
    """Samples with a value that no design can have."""
    impossible = np.zeros(len(samples.values), dtype=bool)
    root = None if design.source is None else design.source.root
    for column, path in enumerate(samples.names):
        field = field_in(type(design), root, path)
        if field is not None and not field.limits.turns:
            drawn = samples.values[:, column]
            impossible |= (drawn < field.limits.least) | (drawn > field.limits.most)
    return impossible


def _confirmed(
    samples: Samples, judged: Judged, asked: ProbabilityOptions, ask: Callable[..., tuple[Point, ...]]
) -> Confirmation | None:
    own = judged if judged.alone is None else judged.alone  # PRE-IE says nothing of what else is judged
    index = chosen(own.forms, own.factor, asked.target, asked.confirm, asked.near, asked.seed)
    if not len(index[0]):
        return None
    tasks = [samples.settings(int(row)) for row in index[0]]
    points = ask("PRE-IE", tasks, ["confirm", asked.confirm, asked.near, asked.target])
    return confirmation_of(
        index, points, own.forms, judged.possible, judged.fails, asked.target, asked.near, asked.confidence
    )
