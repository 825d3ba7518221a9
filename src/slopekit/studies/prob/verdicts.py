"""Verdicts on samples: outcome, factor of safety and failure, by the governing method and a second mechanism."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.errors import Notice
from slopekit.core.sheet import counted
from slopekit.evidence import WithoutBasal
from slopekit.studies.outcomes import NO_BLOCK, STANDS, ByMethod
from slopekit.studies.prob.estimates import Share, rank_correlation, unwrapped
from slopekit.studies.prob.sampling import Samples

IMPOSSIBLE = "impossible"
_MIN_FAILURES = 10  # failures: with fewer the estimate says little
_MAX_RANKED = (
    50_000  # samples that sensitivities are taken from: ranks of more take longer than all else
)


@dataclass(frozen=True)
class SampleVerdicts(ByMethod):
    """Outcome, factor of safety and failure of each sample by the governing method.

    Attributes
    ----------
    names, outcome, factor : of the block, or of the second mechanism (the whole wedge without the basal joint) where
        that has the lower factor
    evaluator : the method, in words
    block_only : the verdicts on the block without the second mechanism; None where that governs no sample
    second_only : number of samples that fail by the second mechanism alone
    """

    fails: Bools
    evaluator: str
    block_only: "SampleVerdicts | None" = None
    second_only: int = 0

    @classmethod
    def from_method(cls, method: ByMethod, target: float, evaluator: str) -> "SampleVerdicts":
        """Return the verdicts of a method: a sample fails whose factor of safety is below the target."""
        return cls(
            method.names, method.outcome, method.factor, method.falls_short(target), evaluator
        )

    @property
    def possible(self) -> Bools:
        """Samples whose values a design can have, (n,)."""
        return ~self.starts_with("E1", IMPOSSIBLE)

    @property
    def counted(self) -> Bools:
        """Samples that the probability of failure is taken of, (n,): the possible ones; none if none has an answer."""
        return (
            self.possible
            if (self.possible & ~self.unjudged).any()
            else self.possible & ~self.unjudged
        )


def with_second_mechanism(
    verdicts: SampleVerdicts, second: ByMethod | None, target: float
) -> SampleVerdicts:
    """Return the verdicts with the lower factor of safety of block and second mechanism in each sample.

    Parameters
    ----------
    second : the second mechanism in every sample, as `Outcomes.whole`; None where the design has none
    """
    if second is None:
        return verdicts
    levels, second_levels = _comparable_factors(verdicts), _comparable_factors(second)
    second_governs = (second_levels < levels) & verdicts.possible & ~verdicts.unjudged
    second_governs &= verdicts.forms | (
        second_levels < target
    )  # without a block it counts only where it fails
    if not second_governs.any():
        return verdicts
    names = (*verdicts.names, *(f"{WithoutBasal.NAME}_{name}" for name in second.names))
    outcome = np.where(
        second_governs, second.outcome + len(verdicts.names), verdicts.outcome
    ).astype(np.int16)
    factor = np.where(second_governs, second.factor, verdicts.factor)
    fails = verdicts.fails | (second_governs & (second_levels < target))
    second_only = int((fails & ~verdicts.fails).sum())
    return replace(
        verdicts,
        names=names,
        outcome=outcome,
        factor=factor,
        fails=fails,
        block_only=verdicts,
        second_only=second_only,
    )


def _comparable_factors(method: ByMethod) -> Floats:
    """Return factors of safety (n,) to compare: infinite without driving force or block, 0 without a factor."""
    is_stable = np.array(
        [not name or name.startswith((*NO_BLOCK, STANDS)) for name in method.names]
    )[method.outcome]
    return np.where(is_stable, np.inf, np.nan_to_num(method.factor, nan=0.0))


def sensitivities(samples: Samples, factor: Floats) -> tuple[tuple[str, float], ...]:
    """Return Spearman's rank correlation of each variable with the factor of safety, the strongest first."""
    with_factor = np.flatnonzero(~np.isnan(factor))
    if len(with_factor) < 3:
        return ()
    with_factor = with_factor[:: -(-len(with_factor) // _MAX_RANKED)]
    values = samples.select(with_factor)
    coefficients = [
        (path, rank_correlation(unwrapped(path, values[:, column]), factor[with_factor]))
        for column, path in enumerate(samples.names)
    ]
    varying = [(path, value) for path, value in coefficients if value is not None]
    return tuple(sorted(varying, key=lambda entry: -abs(entry[1])))


# -- notices ----------------------------------------------------------------------------------------------------------


def estimate_notices(
    target: float, verdicts: SampleVerdicts, samples: Samples, share: Share
) -> Iterator[Notice]:
    """Yield the notices of an estimate: W350 impossible, unsolved or few samples, W507 the second mechanism governs."""
    impossible = int(verdicts.starts_with("E1", IMPOSSIBLE).sum())
    if impossible:
        yield Notice(
            "W350",
            f"{impossible} of {samples.count} samples have a value that no design can have, "
            "and count nowhere: bound the distribution with min or max",
        )
    unsolved = int(verdicts.unjudged.sum())
    if unsolved:
        consequence = (
            "counted as failures, but may be none"
            if verdicts.counted.any()
            else "there is no probability"
        )
        yield Notice(
            "W350",
            f"{unsolved} of {samples.count} samples gave no answer (not_converged, an error, a "
            f"crack that cuts the block in two, a bolt that misses it or is too short): {consequence}",
        )
    if verdicts.second_only:
        yield Notice(
            "W507",
            f"in {verdicts.second_only} of {samples.count} samples {WithoutBasal.WHAT} falls short of "
            f"{target:g}, and what is analysed does not, or forms no block: they count as failures, as "
            "acceptance of a run is not met",
        )
    if share.count < _MIN_FAILURES and share.of:
        yield Notice(
            "W350",
            f"{counted(share.count, 'failure')} among {share.of} samples: judge by the upper limit, "
            "or draw more",
        )
