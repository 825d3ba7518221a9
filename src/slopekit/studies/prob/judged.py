"""What is judged of samples: by the method that counts, and by what acceptance is held against besides."""

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
_RARE = 10  # failures: with fewer the estimate says little
_RANKED = 50_000  # samples that sensitivities are taken from: ranks of more take longer than all else


@dataclass(frozen=True)
class Judged(ByMethod):
    """What the method that counts says of the samples.

    Attributes
    ----------
    names, outcome, factor : by the lower of the block and what acceptance is held against besides
    evaluator : who says it, in words
    alone : what is said of the block; None where it is judged by nothing else
    also : how many samples fail by that alone
    """

    fails: Bools
    evaluator: str
    alone: "Judged | None" = None
    also: int = 0

    @classmethod
    def by(cls, method: ByMethod, target: float, evaluator: str) -> "Judged":
        """Return the judgement of a method against a target."""
        return cls(method.names, method.outcome, method.factor, method.falls_short(target), evaluator)

    @property
    def possible(self) -> Bools:
        """Samples that a design can have."""
        return ~self.among("E1", IMPOSSIBLE)

    @property
    def counted(self) -> Bools:
        """Samples that a probability is taken of: where none has an answer, none."""
        return self.possible if (self.possible & ~self.unjudged).any() else self.possible & ~self.unjudged


def with_whole(judged: Judged, whole: ByMethod | None, target: float) -> Judged:
    """The same with what acceptance is held against too: of each sample the lower of the two counts.

    Parameters
    ----------
    whole : of every sample, as `Outcomes` has it
    """
    if whole is None:
        return judged
    ours, other = _levels(judged), _levels(whole)
    first = (other < ours) & judged.possible & ~judged.unjudged
    first &= judged.forms | (other < target)  # where it does not fail no block is no block
    if not first.any():
        return judged
    names = (*judged.names, *(f"{WithoutBasal.NAME}_{name}" for name in whole.names))
    outcome = np.where(first, whole.outcome + len(judged.names), judged.outcome).astype(np.int16)
    factor = np.where(first, whole.factor, judged.factor)
    fails = judged.fails | (first & (other < target))
    only = int((fails & ~judged.fails).sum())
    return replace(judged, names=names, outcome=outcome, factor=factor, fails=fails, alone=judged, also=only)


def _levels(method: ByMethod) -> Floats:
    """Factors to compare: infinite where nothing drives or no block forms, 0 where nothing holds."""
    stands = np.array([not name or name.startswith((*NO_BLOCK, STANDS)) for name in method.names])[method.outcome]
    return np.where(stands, np.inf, np.nan_to_num(method.factor, nan=0.0))


def sensitivities(samples: Samples, factor: Floats) -> tuple[tuple[str, float], ...]:
    """Spearman's coefficient of each column with the factor, the strongest first."""
    has_one = np.flatnonzero(~np.isnan(factor))
    if len(has_one) < 3:
        return ()
    has_one = has_one[:: -(-len(has_one) // _RANKED)]
    values = samples.at(has_one)
    coefficients = [
        (path, rank_correlation(unwrapped(path, values[:, column]), factor[has_one]))
        for column, path in enumerate(samples.names)
    ]
    known = [(path, value) for path, value in coefficients if value is not None]
    return tuple(sorted(known, key=lambda entry: -abs(entry[1])))


# -- notices ----------------------------------------------------------------------------------------------------------


def notices_of(target: float, judged: Judged, samples: Samples, share: Share) -> Iterator[Notice]:
    """Yield what a reader must know: W350 and W507."""
    impossible = int(judged.among("E1", IMPOSSIBLE).sum())
    if impossible:
        yield Notice("W350", f"{impossible} of {samples.count} samples have a value that no design can have, "
                     "and count nowhere: bound the distribution with min or max")  # fmt: skip
    unsolved = int(judged.unjudged.sum())
    if unsolved:
        said = "counted as failures, but may be none" if judged.counted.any() else "there is no probability"
        yield Notice("W350", f"{unsolved} of {samples.count} samples gave no answer (not_converged, an error, a "
                     f"crack that cuts the block in two, a bolt that misses it or is too short): {said}")  # fmt: skip
    if judged.also:
        yield Notice("W507", f"in {judged.also} of {samples.count} samples {WithoutBasal.WHAT} falls short of "
                     f"{target:g}, and what is analysed does not, or forms no block: they count as failures, as "
                     "acceptance of a run is not met")  # fmt: skip
    if share.count < _RARE and share.of:
        yield Notice("W350", f"{counted(share.count, 'failure')} among {share.of} samples: judge by the upper limit, "
                     "or draw more")  # fmt: skip
