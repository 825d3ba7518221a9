"""What the method that counts says of samples: outcome, factor, whether each fails; what goes with it, and notices."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.errors import Notice
from slopekit.studies.points import Point
from slopekit.studies.prob.confirmation import Confirmation
from slopekit.studies.prob.estimates import Share, rank_correlation
from slopekit.studies.prob.sampling import Samples

IMPOSSIBLE = "impossible"
#: Outcomes of blocks that form and are not judged: no answer, or bolts that the block does not hold.
UNJUDGED = ("E5", "E211", "E212", "not_converged")
_RARE = 10  # failures: with fewer the estimate says little
_RANKED = 50_000  # samples that sensitivities are taken from: ranks of more take longer than all else


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
    """What a reader must know: W350 to W354."""
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
    open_ones = confirmation.samples - confirmation.settled
    if open_ones:
        codes = ", ".join(dict.fromkeys(point.code or "not_converged" for point in confirmation.unsettled))
        yield Notice("W351", f"PRE-IE gave no answer for {open_ones} of the {confirmation.samples} samples it was "
                     f"asked of ({codes}): they confirm nothing")  # fmt: skip
    if confirmation.governed:
        yield Notice(
            "W353",
            f"moments govern in {confirmation.governed} of {confirmation.at_random} samples at random: there the "
            "closed form is too high; --by pre-ie asks PRE-IE of every sample",
        )
    if confirmation.unsafe:
        yield Notice("W354", f"{confirmation.unsafe} of {confirmation.samples} samples fail by PRE-IE and stand by "
                     "the closed form: judge by PRE-IE")  # fmt: skip
