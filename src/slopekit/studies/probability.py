"""Probability of failure: samples of what scatters, the closed form of all of them, PRE-IE of some of them or of all.

samples -> outcome and factor of each -> PRE-IE where it matters -> shares with their confidence limits.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.design.common import Design
from slopekit.design.fields import field_at
from slopekit.errors import DesignError, Fault, Notice
from slopekit.kinds import kind_of
from slopekit.kinds.one_block import Clock
from slopekit.orientation import number
from slopekit.studies.confirmation import Confirmation, chosen, confirmation_of
from slopekit.studies.estimates import Share, Summary, share_of, summary_of
from slopekit.studies.marginals import checked_limits
from slopekit.studies.points import GIVEN_UP, Evaluation, Point, point_of
from slopekit.studies.probability_records import IMPOSSIBLE, UNJUDGED, Judged, failing, notices_of, sensitivities
from slopekit.studies.running import ALONE, Advance, Crew, Journal, crew_in_words, run_all
from slopekit.studies.sampling import METHODS, Samples
from slopekit.studies.sampling import samples as drawn
from slopekit.studies.vectorised import vectorised

By = Literal["closed-form", "pre-ie"]
#: A progress bar: its label and how much there is to do.
Bar: TypeAlias = Callable[[str, int], AbstractContextManager[Advance]]
#: Samples where the closed form does the work, and where PRE-IE has to.
MANY, FEW = 20_000, 1_000
_MOST, _MOST_BY_PRE_IE = 5_000_000, 1_000_000
_CONFIRMED = 200


@dataclass(frozen=True, slots=True)
class Asked:
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
    method: str
    by: By
    target: float
    confirm: int
    near: float
    confidence: float
    accept: float | None


@dataclass(frozen=True, slots=True)
class Probability:
    """What came of it.

    Attributes
    ----------
    samples : what was drawn
    names, outcome : the outcomes there are, and the number of each sample's (n,)
    factor : (n,) by the method that counts, nan where there is none
    fails : (n,) whether the sample fails
    all_samples, forming : the probability of failure among all possible samples, and among those that form a block
    means : the design at the centres of its distributions
    sensitivities : column and Spearman's coefficient with the factor, the strongest first
    confirmation : what PRE-IE says, None where it was not asked apart
    evaluator : how the factors were found, in words
    unjudged : samples that form a block and were not judged; disagree : those on which the methods disagree, or PRE-IE
        did not converge, where it was asked of all
    journals : of a run with a folder, kept until its results are written
    """

    design: Design
    asked: Asked
    samples: Samples
    names: tuple[str, ...]
    outcome: np.ndarray
    factor: Floats
    fails: Bools
    all_samples: Share
    forming: Share
    summary: Summary | None
    means: Point
    sensitivities: tuple[tuple[str, float], ...]
    confirmation: Confirmation | None
    evaluator: str
    crew: str
    warnings: tuple[Notice, ...]
    timing_s: Mapping[str, float]
    unjudged: int = 0
    disagree: int = 0
    journals: tuple[Journal, ...] = field(default=(), compare=False, repr=False)

    def discard_journals(self) -> None:
        """Remove what was kept for an interruption: the results are written."""
        for journal in self.journals:
            journal.remove()

    @property
    def counts(self) -> dict[str, int]:
        """How many samples there are of each outcome, the most frequent first."""
        found = np.bincount(self.outcome, minlength=len(self.names))
        return dict(Counter({name: int(count) for name, count in zip(self.names, found, strict=True) if count})
                    .most_common())  # fmt: skip

    @property
    def accepted(self) -> bool | None:
        """Whether the upper confidence limit is not above the probability accepted, and nothing speaks against it.

        Samples that fail by PRE-IE only, or that were not judged, do.
        """
        if self.asked.accept is None:
            return None
        checked = self.confirmation
        doubted = self.unjudged or (checked is not None and (checked.unsafe or checked.settled < len(checked.index)))
        return not doubted and self.all_samples.high <= self.asked.accept

    @property
    def exit_code(self) -> int:
        """0 done, 1 not accepted, 3 no sample forms a block, 4 the methods disagree, or no convergence."""
        if self.disagree or (self.confirmation is not None and self.confirmation.disagree):
            return 4
        if self.forming.of == 0 and not self.unjudged:
            return 3
        return 1 if self.accepted is False else 0

    def to_dict(self) -> dict[str, Any]:
        """The study as JSON values; the samples themselves are in the CSV."""
        from slopekit.studies.probability_records import document

        return document(self)


def probability(
    design: Design,
    n: int | None = None,
    *,
    seed: int = 1,
    method: str = "monte-carlo",
    by: By | None = None,
    target: float = 1.0,
    confirm_count: int = _CONFIRMED,
    near: float | None = None,
    confidence: float = 0.95,
    accept: float | None = None,
    crew: Crew = ALONE,
    folder: Path | None = None,
    bar: Bar = lambda _label, _total: nullcontext(_silent),
) -> Probability:
    """The probability that the factor of safety of a design lies below a target.

    Parameters
    ----------
    n : samples: 20,000 by the closed form, 1,000 where PRE-IE has to be asked
    seed : the same seed gives the same numbers, whoever does the work
    method : monte-carlo, latin-hypercube or sobol
    by : closed-form or pre-ie; None takes the closed form where the kind has one that knows all of the design
    confirm_count : samples at random that PRE-IE looks at; near : besides all whose factor lies within this part of
        the target (None: the design's agree_within)
    crew : who does the work; folder : where its journal is kept; bar : how progress is shown

    Raises
    ------
    DesignError
        E302 nothing scatters, E307 a number out of range, E308 a word that is none of those known, and those of
        `run_all`.
    """
    asked = _asked(design, n, seed, method, by, target, confirm_count, near, confidence, accept)
    clock = Clock()
    with clock("draw"):
        samples = drawn(design.variables, design.correlation, asked.n, asked.seed, asked.method)
    journals = _Journals(design, asked, folder)
    with clock("factors"):
        judged = _judge(design, asked, samples, crew, journals, bar)
    confirmation = None
    if asked.by == "closed-form":
        with clock("confirm"):
            confirmation = _confirmed(design, asked, samples, judged, crew, journals, bar)
    all_samples = share_of(judged.fails, judged.possible, samples.replicate, confidence)
    forming = share_of(judged.fails, judged.possible & judged.forms, samples.replicate, confidence)
    means = point_of(design, {}) if design.source is not None else Point(None)
    study = Probability(
        design, asked, samples, judged.names, judged.outcome, judged.factor, judged.fails, all_samples, forming,
        summary_of(judged.factor), means, sensitivities(samples, judged.factor), confirmation, judged.evaluator,
        crew_in_words(crew), tuple(notices_of(asked.target, judged, samples, all_samples, confirmation)), clock.done(),
        int(judged.among(*UNJUDGED).sum()), judged.disagree, tuple(journals.kept),
    )  # fmt: skip
    if folder is None:
        study.discard_journals()
    return study


def _silent(_done: int) -> None:
    """Progress that nobody looks at."""


class _Settings(Sequence[Mapping[str, object]]):
    """The samples as settings, each made when it is asked for."""

    def __init__(self, samples: Samples) -> None:
        self.samples = samples

    def __len__(self) -> int:
        return len(self.samples.values)

    def __getitem__(self, row: Any) -> Any:
        return self.samples.settings(row)


class _Journals:
    """The journals of a run: one for each part of it that takes long."""

    def __init__(self, design: Design, asked: Asked, folder: Path | None) -> None:
        plain = design.source.root.plain() if design.source is not None else None
        drawn_from = [plain, design.input_hash(), repr(design.variables), repr(design.correlation)]
        self.run = [*drawn_from, asked.n, asked.seed, asked.method, asked.by]
        self.folder, self.streamed = (Path.cwd(), False) if folder is None else (folder, True)
        self.kept: list[Journal] = []

    def of(self, *part: Any) -> Journal:
        self.kept.append(Journal.of(self.folder, "prob", [*self.run, *part], self.streamed))
        return self.kept[-1]


def _asked(
    design: Design, n: int | None, seed: int, method: str, by: str | None, target: float, confirm_count: int,
    near: float | None, confidence: float, accept: float | None,
) -> Asked:  # fmt: skip
    """What was asked for, checked."""
    faults = []
    if not design.variables:
        advice = "Write one: phi: {dist: normal, mean: 20, sd: 2}."
        faults.append(Fault("E302", "nothing in this design scatters: no number is a distribution", "", advice))
    if method not in METHODS:
        faults.append(Fault("E308", f"{method} is not a way to draw samples", "", f"Known: {', '.join(METHODS)}."))
    if by not in (None, "closed-form", "pre-ie"):
        faults.append(Fault("E308", f"{by} is not a method", "", "Known: closed-form, pre-ie."))
    known = kind_of(design).closed_form is not None
    if by == "closed-form" and not known:
        faults.append(Fault("E308", f"a {design.kind} has no closed form to sample", "", "Take pre-ie."))
    chosen: By = "pre-ie" if by == "pre-ie" or not known or (by is None and _dilates(design)) else "closed-form"
    most = _MOST if chosen == "closed-form" else _MOST_BY_PRE_IE
    n = (MANY if chosen == "closed-form" else FEW) if n is None else n
    near = design.agree_within if near is None else near
    for name, value, low, high in (
        ("n", n, 1, most), ("seed", seed, 0, 2**63 - 1), ("the target", target, 1e-6, 1e6),
        ("confirm", confirm_count, 0, most), ("near", near, 0.0, 10.0), ("confidence", confidence, 0.5, 0.9999),
        ("accept", 0.0 if accept is None else accept, 0.0, 1.0),
    ):  # fmt: skip
        if not low <= value <= high:
            message = f"{name} is {number(value)}, it lies between {number(low)} and {number(high)}"
            advice = "A part of all is written 0.95 or 95%." if name in ("confidence", "accept", "near") else ""
            faults.append(Fault("E307", message, "", advice))
    if faults:
        raise DesignError(faults)
    checked_limits(design)
    return Asked(n, seed, method, chosen, target, confirm_count, near, confidence, accept)


def _dilates(design: Design) -> bool:
    """Whether the closed form leaves something out that the design has."""
    strength = getattr(design, "strength", None)
    angles = getattr(design, "dilation_deg", None) or (getattr(strength, "dilation_deg", 0.0),)
    return any(angles) or any(variable.path.endswith(".dilation") for variable in design.variables)


def _judge(
    design: Design, asked: Asked, samples: Samples, crew: Crew, journals: _Journals, bar: Bar
) -> Judged:  # fmt: skip
    """Outcome and factor of every sample."""
    fast = vectorised(design, samples.values, samples.settings) if asked.by == "closed-form" else None
    if fast is not None:
        found = fast(samples.values)
        names, outcome, factor = (*found.names, IMPOSSIBLE), found.outcome.astype(np.int16), found.factor
        impossible = _impossible(design, samples)
        outcome[impossible], factor[impossible] = len(names) - 1, np.nan
        factor[factor == 0.0] = np.nan  # no strength at all: a status, no number (UX.md rule 2)
        fails = failing(names, outcome, factor, asked.target)
        return Judged(names, outcome, factor, fails, "closed form, all at once")
    by_pre_ie = asked.by == "pre-ie"
    with bar("samples", len(samples.values)) as advance:
        records = run_all(
            Evaluation(design, by_pre_ie),
            _Settings(samples),
            crew,
            journal=journals.of("all"),
            advance=advance,
            given_up=GIVEN_UP,
        )
    points = tuple(Point.from_record(record) for record in records)
    words = [point.code if point.factors is None else point.factors.status for point in points]
    names = tuple(dict.fromkeys(words))
    outcome = np.array([names.index(word) for word in words], dtype=np.int16)
    factors = [None if p.factors is None else p.factors.limit if by_pre_ie else p.factors.closed_form for p in points]
    factor = np.array([np.nan if value is None else value for value in factors])
    fails = failing(names, outcome, factor, asked.target)
    evaluator = "PRE-IE of every sample" if by_pre_ie else "closed form, sample by sample"
    return Judged(names, outcome, factor, fails, evaluator, points)


def _impossible(design: Design, samples: Samples) -> Bools:
    """Samples with a value that no design can have."""
    found = np.zeros(len(samples.values), dtype=bool)
    for column, path in enumerate(samples.names):
        limits = field_at(type(design), path)
        if limits is not None and not limits.turns:
            found |= (samples.values[:, column] < limits.least) | (samples.values[:, column] > limits.most)
    return found


def _confirmed(
    design: Design, asked: Asked, samples: Samples, judged: Judged, crew: Crew, journals: _Journals, bar: Bar
) -> Confirmation | None:
    index = chosen(judged.forms, judged.factor, asked.target, asked.confirm, asked.near, asked.seed)
    if not len(index.all):
        return None
    with bar("PRE-IE", len(index.all)) as advance:
        records = run_all(
            Evaluation(design), [samples.settings(int(row)) for row in index.all], crew,
            journal=journals.of("confirm", asked.confirm, asked.near, asked.target), advance=advance, given_up=GIVEN_UP,
        )  # fmt: skip
    points = tuple(Point.from_record(record) for record in records)
    return confirmation_of(
        index, points, judged.forms, judged.possible, judged.fails, asked.target, asked.near, asked.confidence
    )
