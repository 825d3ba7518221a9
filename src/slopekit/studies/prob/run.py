"""Probability of failure: samples of the random variables, each evaluated by both methods.

samples -> outcome and factor of each -> shares with their confidence limits.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from operator import attrgetter
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.codec import json_of, record_of
from slopekit.core.errors import Faults, Notice, fail
from slopekit.core.progress import Clock
from slopekit.core.sheet import Column, counted
from slopekit.design.common import Design
from slopekit.design.fields import declare
from slopekit.kinds import implausible_inputs, peak_strength_notice
from slopekit.kinds.single_block.held_bolts import has_heads
from slopekit.notices import defaulted_inputs, new_notices
from slopekit.studies.evaluation.rows import evaluated
from slopekit.studies.marginals import checked_limits
from slopekit.studies.outcomes import BothMethods, Outcomes, agreement_of_methods
from slopekit.studies.points import Point, point_of
from slopekit.studies.prob.estimates import Share, Summary, sample_statistics, share_of, summary_of
from slopekit.studies.prob.rows import SampleRows
from slopekit.studies.prob.sampling import METHODS, Method, Samples, samples
from slopekit.studies.prob.verdicts import (
    SampleVerdicts,
    estimate_notices,
    sensitivities,
    with_second_mechanism,
)
from slopekit.studies.protocol import (
    DESK,
    MOST_SEED,
    ADesign,
    Jobs,
    Option,
    Scheduler,
    Seed,
    StudyOutcome,
    Workplace,
    number_of,
    numbers_given,
    study,
    whole_number,
)
from slopekit.studies.running import checked_crew

FactorMethod = Literal["closed-form", "pre-ie"]
#: Default numbers of samples: on arrays; where each takes milliseconds or is read by itself; with a crack search.
SAMPLES_ON_ARRAYS, SAMPLES_READ_SINGLY, SAMPLES_WITH_CRACK_SEARCH = 20_000, 1_000, 200
_MAX_SAMPLES, _MAX_SAMPLES_BY_PRE_IE = 10_000_000, 1_000_000
#: Limits of numbers by their parameters.
_NUMBER_LIMITS = {
    "seed": declare("seed", "ratio", 0, MOST_SEED, is_integer=True, code="E307"),
    "fos": declare("the target", "ratio", 1e-6, 1e6, code="E307"),
    "confidence": declare(
        "confidence",
        "ratio",
        0.5,
        0.9999,
        code="E307",
        advice="A part of all is written 0.95 or 95%.",
    ),
    "accept": declare(
        "accept",
        "ratio",
        0.0,
        1.0,
        code="E307",
        advice="It is a probability of failure, 0.05 or 5%, no factor of safety.",
    ),
}


@dataclass(frozen=True)
class ProbabilityOptions:
    """Options of a study of probability, checked.

    Attributes
    ----------
    n : number of samples; seed : of all random numbers; method : of sampling
    by : method whose factors count: PRE-IE (with the closed form for comparison), or the closed form alone
    target : a sample with a factor of safety below it fails
    confidence : of the limits; accept : largest accepted probability of failure, None without one
    """

    n: int
    seed: int
    method: Method
    by: FactorMethod
    target: float
    confidence: float
    accept: float | None


@dataclass(frozen=True, repr=False)
class Probability(StudyOutcome):
    """The probability of failure of a design, with the samples and verdicts behind it.

    Attributes
    ----------
    rows : the samples; judged : outcome, factor by the governing method, and failure of each sample
    all_samples, forming : the probability of failure among all possible samples, and among those that form a block
    outcomes : results of both methods; both : their agreement, None with the closed form alone
    closed_form : verdicts of the closed form beside PRE-IE, None with it alone, or where the kind has none
    """

    name: ClassVar[str] = "prob"
    charts: ClassVar[tuple[str, ...]] = ("histogram",)
    design: Design
    asked: ProbabilityOptions
    rows: SampleRows
    judged: SampleVerdicts
    all_samples: Share
    forming: Share
    outcomes: Outcomes
    both: BothMethods | None
    closed_form: SampleVerdicts | None
    of_samples: tuple[Notice, ...]
    timing_s: Mapping[str, float]

    @property
    def samples(self) -> Samples:
        """The drawn samples."""
        return self.rows.samples

    # computed on access: a sheet needs these, the many studies of a range of means do not

    @cached_property
    def variables(self) -> tuple[dict[str, Any], ...]:
        """Path, mean, sd, min and max of each drawn variable."""
        return tuple(sample_statistics(self.samples.names, self.samples.pieces))

    @cached_property
    def sizes(self) -> Mapping[str, Floats]:
        """Volume, height, width and setback of each sample (n,) by their keys; empty where they are not known.

        Where no block forms they are nan.
        """
        return self.rows.sizes(0, self.samples.count, self.judged.forms)

    @cached_property
    def summary(self) -> Summary | None:
        """Statistics of the factors of safety, None where no sample has one."""
        return summary_of(self.judged.factor)

    @cached_property
    def means(self) -> Point:
        """The design at the centres of its distributions."""
        return point_of(self.design, {})

    @cached_property
    def warnings(self) -> tuple[Notice, ...]:
        """Notices of the samples, and those of a run of the design at its means."""
        notes = new_notices(self.means.notes, self.of_samples)
        at_means = (
            Notice(note.code, f"of the design at its means: {note.message}") for note in notes
        )
        peak = peak_strength_notice(self.design, "samples are judged by factors")
        return (*self.of_samples, *at_means, *peak)

    @cached_property
    def sensitivities(self) -> tuple[tuple[str, float], ...]:
        """Column and Spearman's coefficient with the factor, the strongest first."""
        return sensitivities(self.samples, self.judged.factor)

    @cached_property
    def scaled_down(self) -> int:
        """Number of samples whose block the limits of size made smaller."""
        scaled = 0
        for start, stop in pairwise(self.samples.ends):
            scale = self.rows.sizes(start, stop, self.judged.forms[start:stop]).get("scale")
            if scale is None:  # no limits of size
                break
            scaled += int((scale < 1.0).sum())
        return scaled

    @property
    def counts(self) -> dict[str, int]:
        """Number of samples by outcome, the most frequent first."""
        frequencies = np.bincount(self.judged.outcome, minlength=len(self.judged.names)).tolist()
        counts = Counter(dict(zip(self.judged.names, frequencies, strict=True)))
        return {name: count for name, count in counts.most_common() if count}

    @property
    def accepted(self) -> bool | None:
        """Whether the upper confidence limit is not above the accepted probability, and there are no `doubts`."""
        if self.asked.accept is None:
            return None
        return not self.doubts and self.all_samples.high <= self.asked.accept

    @cached_property
    def by_closed_form(self) -> Share | None:
        """The probability of failure by the closed form where PRE-IE governs, else None."""
        closed_form, samples = self.closed_form, self.samples
        if closed_form is None:
            return None
        return share_of(
            closed_form.fails, self.judged.counted, samples.replicate, self.asked.confidence
        )

    @property
    def methods_disagree(self) -> bool:
        """Whether closed form and PRE-IE disagree in a sample, or PRE-IE did not converge."""
        return self.both is not None and bool(self.both.disagree or self.both.without_answer)

    @property
    def doubts(self) -> list[str]:
        """Reasons against acceptance, however low the upper limit is."""
        unjudged = int(self.judged.unjudged.sum())
        doubts = ["the methods disagree"] if self.methods_disagree else []
        if self.forming.of == 0 and not unjudged:
            doubts.append("no sample forms a block")
        if unjudged:
            doubts.append(f"{counted(unjudged, 'sample')} not judged")
        return doubts

    @property
    def margin(self) -> float | None:
        """The probability that the slope does not fail, None without samples."""
        share = self.all_samples.share
        return None if share is None else 1.0 - share

    def case_columns(self) -> list[Column[Any]]:
        """Columns of a table of load cases: the probability of failure and its limits."""
        columns = (
            ("P of failure", "share", "probability", 14),
            ("from", "low", "low", 10),
            ("to", "high", "high", 10),
        )
        return [
            Column(title, attrgetter(f"all_samples.{name}"), key, show=".3g", width=width)
            for title, name, key, width in columns
        ]

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
        options, summary, verdicts = self.asked, self.summary, self.judged
        return {
            **self.head(self.design),
            "n": self.samples.count,
            "replicates": int(self.samples.replicate.max()) + 1,
            "seed": options.seed,
            "sampling": options.method,
            "by": options.by,
            "evaluator": self.judged.evaluator,
            "target": options.target,
            "probability_of_failure": {
                "all_samples": record_of(self.all_samples),
                "samples_that_form_a_block": record_of(self.forming),
                "closed_form": json_of(self.by_closed_form),
            },
            "accept": options.accept,
            "accepted": self.accepted,
            "outcomes": self.counts,
            "fos": None
            if summary is None
            else record_of(summary) | {"beta": summary.beta(options.target)},
            "histogram": None
            if summary is None
            else {
                "edges": list(summary.edges),
                "counts": list(summary.counts),
                "below": summary.below,
                "above": summary.above,
                "failing_without_factor": int((verdicts.fails & np.isnan(verdicts.factor)).sum()),
            },
            "variables": list(self.variables),
            "correlation": [
                {"between": [a, b], "rank": value} for a, b, value in self.design.correlation
            ],
            "sensitivity": [
                {"variable": name, "rank_correlation_with_fos": value}
                for name, value in self.sensitivities
            ],
            "methods": json_of(self.both),
            "scaled_down": self.scaled_down,
            "defaults": list(self.design.reading.defaults),
            "timing_s": dict(self.timing_s),
            **self.words(),
        }


#: Largest probability accepted; the old word is still understood.
Accept = Annotated[
    float | None,
    Option(
        "Largest probability of failure accepted; exit code 1 where the upper limit lies above.",
        number_of,
        "--accept-pf",
        also=("--accept",),
    ),
]


@study
def prob(
    design: ADesign,
    n: Annotated[
        int | None,
        Option("Samples [20000; 1000 where each takes milliseconds].", whole_number, "-n"),
    ] = None,
    *,
    method: Annotated[
        Method, Option("monte-carlo or latin-hypercube [monte-carlo].")
    ] = "monte-carlo",
    by: Annotated[
        FactorMethod, Option("pre-ie, beside the closed form, or closed-form alone [pre-ie].")
    ] = "pre-ie",
    fos: Annotated[
        float,
        Option("What fails has a factor of safety below this [1].", number_of, also=("--target",)),
    ] = 1.0,
    confidence: Annotated[float, Option("Of the confidence limits [95%].", number_of)] = 0.95,
    accept: Accept = None,
    seed: Seed = 1,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Probability:
    """Probability of failure: Monte Carlo or Latin hypercube on the distributions of a design.

    Both methods judge every sample, and PRE-IE's limit counts. Ctrl-C keeps what is done: the same command goes on from
    there. Exit codes: 0 done, 1 not accepted, 4 the methods disagree.

    Raises
    ------
    DesignError
        E302 nothing scatters, E307 a number out of range, E126 a word that is none of those known, and those of
        `run_all`.

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
    >>> found = sk.prob(design, n=1000, fos=1.2)
    >>> share = found.all_samples
    >>> share.count, share.of, round(share.low, 3), round(share.high, 3)
    (75, 1000, 0.059, 0.093)
    """
    crew = checked_crew(jobs, scheduler)
    if design.analysis.partial is not None:
        fail(
            "E313",
            "partial factors allow for the scatter that a probability draws: with both it would count twice",
            "analysis.partial_factors",
            "Take analysis.partial_factors out for it, or: --set analysis.partial_factors=null",
        )
    options = _checked_options(design, n, seed, method, by, fos, confidence, accept, desk.named)
    clock = Clock()
    pre_ie = options.by == "pre-ie"
    with clock("draw"):
        sample_set = samples(design.variables, design.correlation, options.n, options.seed, method)
        rows = SampleRows(design, sample_set)
        # milliseconds each; where a crack was looked for, every place of it may cut a block for its loads
        is_dear = getattr(design, "crack_searched", "") and getattr(
            design, "is_cut_for_loads", False
        )
        laws = [strength.law for strength in design.joint_strengths]
        is_slow = any(laws) or any(bolt.acts == "passive" for bolt in design.bolts)
        if n is None and rows.is_on_arrays and not (is_dear or is_slow):
            options = replace(options, n=SAMPLES_ON_ARRAYS)
            rows = SampleRows(design, replace(sample_set, count=SAMPLES_ON_ARRAYS))
    with clock("factors"):
        outcomes = evaluated(rows, "prob", crew, desk, pre_ie, "samples")
        has_closed_form = design.HAS_CLOSED_FORM
        methods = " and ".join(["closed form"] * has_closed_form + ["PRE-IE"] * pre_ie)
        evaluator = f"{methods} of every sample{', all at once' if rows.is_on_arrays else ''}"
        verdicts = with_second_mechanism(
            SampleVerdicts.from_method(outcomes.limit, fos, evaluator), outcomes.whole, fos
        )
        bolt_notices = tuple(_bolt_notices(rows, outcomes, verdicts.forms))
    closed_form_verdicts = (
        with_second_mechanism(
            SampleVerdicts.from_method(outcomes.closed_form, fos, ""), outcomes.whole, fos
        )
        if pre_ie and has_closed_form
        else None
    )
    both = (
        agreement_of_methods(outcomes, verdicts.fails, (closed_form_verdicts or verdicts).fails)
        if pre_ie
        else None
    )
    replicate, counted_samples = rows.samples.replicate, verdicts.counted
    all_samples = share_of(verdicts.fails, counted_samples, replicate, confidence)
    forming = share_of(verdicts.fails, counted_samples & verdicts.forms, replicate, confidence)
    method_notices = () if both is None else tuple(both.notices("samples", options.n))
    return Probability(
        design,
        options,
        rows,
        verdicts,
        all_samples,
        forming,
        outcomes,
        both,
        closed_form_verdicts,
        (
            *estimate_notices(fos, verdicts, rows.samples, all_samples),
            *method_notices,
            *bolt_notices,
            *defaulted_inputs(design),
            *implausible_inputs(design),
        ),
        clock.done(),
    )


def _bolt_notices(rows: SampleRows, outcomes: Outcomes, forms: Bools) -> Iterator[Notice]:
    """Yield W311 where bolts with heads give no force to the block of some sample."""
    if not has_heads(rows.design.bolts):
        return
    bolts, forming_samples = (
        rows.without_force(outcomes, forms),
        counted(int(forms.sum()), "sample"),
    )
    if bolts.any():
        up_to = (
            f" (up to {int(bolts.max())} of {sum(bolt.head_m is not None for bolt in rows.design.bolts)})"
            * rows.is_on_arrays  # samples read one by one do not count their bolts
        )
        heads = ". Heads stand on each sample's own face" * rows.is_on_arrays
        yield Notice(
            "W311",
            f"bolts give no force in {int((bolts > 0).sum())} of {forming_samples} that form a block{up_to}: "
            f"there they miss it, or end within it{heads}",
        )


def _checked_options(
    design: Design,
    n: int | None,
    seed: int,
    method: Method,
    factor_method: FactorMethod,
    target: float,
    confidence: float,
    accept: float | None,
    option_name: Callable[[str], str],
) -> ProbabilityOptions:
    """Check the options of `prob`, and return them; every fault at once."""
    faults = Faults()
    if not design.variables:
        faults.add(
            "E302",
            "nothing in this design scatters: no number is a distribution",
            "",
            "Write one: phi: {dist: normal, mean: 20, sd: 2}.",
        )
    if method not in METHODS:
        faults.add(
            "E126", f"{method} is not a way to draw samples", "", f"Known: {', '.join(METHODS)}."
        )
    if factor_method not in ("closed-form", "pre-ie"):
        faults.add("E126", f"{factor_method} is not a method", "", "Known: closed-form, pre-ie.")
    if factor_method == "closed-form" and not design.HAS_CLOSED_FORM:
        faults.add("E126", f"a {design.kind} has no closed form to sample", "", "Take pre-ie.")
    default_count = (
        SAMPLES_WITH_CRACK_SEARCH if getattr(design, "crack_searched", "") else SAMPLES_READ_SINGLY
    )
    count = default_count if n is None else n
    max_samples, advice = (
        _MAX_SAMPLES if factor_method == "closed-form" else _MAX_SAMPLES_BY_PRE_IE,
        "",
    )
    if max_samples < count <= _MAX_SAMPLES:
        advice = f"--by closed-form takes up to {_MAX_SAMPLES}."
    samples_limit = declare(
        "n", "ratio", 1, max_samples, is_integer=True, code="E307", advice=advice
    )
    values = {"n": count, "seed": seed, "fos": target, "confidence": confidence, "accept": accept}
    numbers_given({"n": samples_limit} | _NUMBER_LIMITS, values, option_name, faults)
    faults.refuse()
    checked_limits(design)
    return ProbabilityOptions(count, seed, method, factor_method, target, confidence, accept)
