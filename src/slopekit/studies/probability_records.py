"""A study of probability: what the method that counts says of all samples, its notices, JSON values and CSV."""

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.errors import Notice, writing
from slopekit.studies.confirmation import Confirmation
from slopekit.studies.estimates import QUANTILES, Share, Summary, rank_correlation
from slopekit.studies.points import Point, study_head
from slopekit.studies.sampling import Samples

if TYPE_CHECKING:
    from slopekit.studies.probability import Probability

_MOST_AT_RANDOM = 500  # that a histogram marks
IMPOSSIBLE = "impossible"
#: Outcomes of blocks that form and are not judged: no answer, or bolts that the block does not hold.
UNJUDGED = ("E5", "E211", "E212", "not_converged")
_RARE = 10  # failures: with fewer the estimate says little
_RANKED = 50_000  # samples that sensitivities are taken from: ranks of more take longer than all else


def document(study: "Probability") -> dict[str, Any]:
    """The study as JSON values."""
    asked, summary = study.asked, study.summary
    return {
        **study_head("prob", study.design),
        "n": len(study.samples.values),
        "replicates": int(study.samples.replicate.max()) + 1, "seed": asked.seed, "sampling": asked.method,
        "by": asked.by, "evaluator": study.evaluator, "target": asked.target,
        "probability_of_failure": {
            "all_samples": study.all_samples.to_dict(), "samples_that_form_a_block": study.forming.to_dict(),
        },
        "accept": asked.accept, "accepted": study.accepted, "outcomes": study.counts,
        "fos": None if summary is None else _summary(summary, asked.target),
        "histogram": None if summary is None else {
            "edges": list(summary.edges), "counts": list(summary.counts), "below": summary.below,
            "above": summary.above, "failing_without_factor": int((study.fails & np.isnan(study.factor)).sum()),
        } | _at_random(study),
        "at_means": _point(study.means),
        "lowest": _lowest(study),
        "variables": [variable(study, column) for column in range(len(study.samples.names))],
        "correlation": [
            {"between": [a, b], "rank": value} for a, b, value in study.design.correlation
        ],
        "sensitivity": [{"variable": name, "rank_correlation_with_fos": value} for name, value in study.sensitivities],
        "pre_ie": None if study.confirmation is None else study.confirmation.to_dict(),
        "inputs": study.design.inputs(), "defaults": list(study.design.defaults),
        "warnings": [notice.to_dict() for notice in study.warnings],
        "timing_s": dict(study.timing_s),
    }  # fmt: skip


def _at_random(study: "Probability") -> dict[str, Any]:
    """PRE-IE's factors of samples taken at random, for the histogram: the first ones where they are many."""
    checked = study.confirmation
    points = [] if checked is None else [
        point for point, random in zip(checked.points, checked.at_random.tolist(), strict=True) if random
    ][:_MOST_AT_RANDOM]  # fmt: skip
    judged = [point.factors for point in points if point.factors and point.factors.status != "not_converged"]
    fails = [found for found in judged if found.limit is None and found.status != "no_driving_force"]
    return {
        "pre_ie_at_random": sorted(found.limit for found in judged if found.limit is not None),
        "pre_ie_without_factor": len(fails), "pre_ie_samples": len(judged),
    }  # fmt: skip


def _summary(summary: Summary, target: float) -> dict[str, Any]:
    return {
        "samples": summary.count, "mean": summary.mean, "sd": summary.sd, "min": summary.least, "max": summary.most,
        "quantiles": {f"{share:g}": value for share, value in zip(QUANTILES, summary.quantiles, strict=True)},
        "beta": summary.beta(target),
    }  # fmt: skip


def _point(point: Point) -> dict[str, Any] | None:
    found = point.factors
    if found is None:
        return {"code": point.code, "message": point.message} if point.code else None
    return {
        "status": found.status, "limit": found.limit, "closed_form": found.closed_form, "agree": found.agree,
        "moments_govern": found.moments_govern,
    }  # fmt: skip


def _lowest(study: "Probability") -> dict[str, Any] | None:
    """The sample with the lowest factor, as values to put into the design."""
    found = [(value, row) for row, value in enumerate(study.factor.tolist()) if not math.isnan(value)]
    if not found:
        return None
    factor, row = min(found)
    return {"sample": row, "fos": factor, "values": dict(study.samples.settings(row))}


def variable(study: "Probability", column: int) -> dict[str, Any]:
    """A column of the samples: its path, and what was drawn."""
    drawn = study.samples.values[:, column]
    return {
        "path": study.samples.names[column], "mean": float(drawn.mean()),
        "sd": float(drawn.std(ddof=1)) if len(drawn) > 1 else 0.0, "min": float(drawn.min()),
        "max": float(drawn.max()),
    }  # fmt: skip


def write_samples(study: "Probability", path: Path) -> None:
    """Every sample as a row of CSV: its values, outcome and factor, whether it fails, and what PRE-IE says of it.

    Raises
    ------
    DesignError
        E129 where the file cannot be written.
    """
    checked = study.confirmation
    also = {} if checked is None else dict(zip(checked.index.tolist(), checked.points, strict=True))
    by = "closed_form" if study.asked.by == "closed-form" else "limit"
    head = ["sample", *study.samples.names, "outcome", f"fos_{by}", "fails"]
    head += ["pre_ie_outcome", "fos_limit", "moments_govern"] if checked is not None else []
    with writing(path), path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(head)
        values, outcomes = study.samples.values.tolist(), study.outcome.tolist()
        fails, factors = study.fails.tolist(), study.factor.tolist()
        for row, (given, outcome, factor, fall) in enumerate(zip(values, outcomes, factors, fails, strict=True)):
            own = [row, *given, study.names[outcome], "" if math.isnan(factor) else factor, int(fall)]
            rows.writerow(own + (_also(also.get(row)) if checked is not None else []))


def _also(point: Point | None) -> list[Any]:
    if point is None:
        return ["", "", ""]
    if point.factors is None:
        return [point.code, "", ""]
    limit = point.factors.limit
    return [point.factors.status, "" if limit is None else limit, int(point.factors.moments_govern)]


@dataclass(frozen=True, slots=True)
class Judged:
    """What the method that counts says of the samples."""

    names: tuple[str, ...]
    outcome: np.ndarray
    factor: Floats
    fails: Bools
    evaluator: str
    points: tuple[Point, ...] = ()

    def among(self, *beginnings: str) -> Bools:
        """Samples whose outcome begins with one of these."""
        found: Bools = np.array([name.startswith(beginnings) for name in self.names])[self.outcome]
        return found

    @property
    def forms(self) -> Bools:
        """Samples that form a block."""
        return ~self.among("E", IMPOSSIBLE) | self.among("E211", "E212")

    @property
    def possible(self) -> Bools:
        """Samples that a design can have and whose outcome is known."""
        return ~self.among("E1", IMPOSSIBLE, *UNJUDGED)

    @property
    def disagree(self) -> int:
        """Samples on which the methods disagree or PRE-IE did not converge, where PRE-IE looked at all."""
        return sum(point.is_in_doubt for point in self.points)


def failing(names: Sequence[str], outcome: np.ndarray, factor: Floats, target: float) -> Bools:
    """Whether each sample falls short of the target: `falls_short` for arrays."""
    stays = [name.startswith(("E", IMPOSSIBLE)) or name in ("no_driving_force", "not_converged") for name in names]
    with np.errstate(invalid="ignore"):
        fails: Bools = ~np.array(stays)[outcome] & ~(factor >= target)
    return fails


def sensitivities(samples: Samples, factor: Floats) -> tuple[tuple[str, float], ...]:
    """Spearman's coefficient of each column with the factor, the strongest first."""
    has_one = np.flatnonzero(~np.isnan(factor))
    if len(has_one) < 3:
        return ()
    has_one = has_one[:: -(-len(has_one) // _RANKED)]
    found = [
        (path, rank_correlation(samples.values[has_one, column], factor[has_one]))
        for column, path in enumerate(samples.names)
    ]
    known = [(path, value) for path, value in found if value is not None]
    return tuple(sorted(known, key=lambda entry: -abs(entry[1])))


def notices_of(
    target: float, judged: Judged, samples: Samples, share: Share, confirmation: Confirmation | None
) -> Iterator[Notice]:
    impossible = int(judged.among("E1", IMPOSSIBLE).sum())
    if impossible:
        yield Notice("W350", f"{impossible} of {len(samples.values)} samples have a value that no design can have, "
                     "and count nowhere: bound the distribution with min or max")  # fmt: skip
    unsolved = int(judged.among(*UNJUDGED).sum())
    if unsolved:
        yield Notice("W351", f"{unsolved} of {len(samples.values)} samples gave no answer (not_converged, an error, "
                     "or a bolt that misses the block or is too short): left out of the probability, which may be off "
                     "by as much")  # fmt: skip
    if share.count < _RARE and share.of:
        yield Notice("W352", f"{share.count} failures among {share.of} samples: judge by the upper limit, or draw more")
    if confirmation is None:
        governed = sum(point.factors is not None and point.factors.moments_govern for point in judged.points)
        if governed:
            yield Notice(
                "W353",
                f"moments govern in {governed} of {len(samples.values)} samples: the closed form would be too high",
            )
        return
    open_ones = len(confirmation.index) - confirmation.settled
    if open_ones:
        codes = ", ".join(dict.fromkeys(point.code or "not_converged" for point in confirmation.unsettled))
        yield Notice("W351", f"PRE-IE gave no answer for {open_ones} of the {len(confirmation.index)} samples it was "
                     f"asked of ({codes}): they confirm nothing")  # fmt: skip
    if confirmation.governed:
        of = int(confirmation.at_random.sum())
        yield Notice("W353", f"moments govern in {confirmation.governed} of {of} samples at random: there the closed "
                     "form is too high; --by pre-ie asks PRE-IE of every sample")  # fmt: skip
    if confirmation.unsafe:
        yield Notice("W354", f"{confirmation.unsafe} of {len(confirmation.index)} samples fail by PRE-IE and stand by "
                     "the closed form: judge by PRE-IE")  # fmt: skip
