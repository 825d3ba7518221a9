"""What the methods say of samples: the one that counts of all of them, PRE-IE of some that a closed form has judged.

Those that PRE-IE looks at besides are a random part, and all near the target.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, TypeAlias

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.evidence import WithoutBasal
from slopekit.kinds.single_block.closed_forms import ClosedForms
from slopekit.studies.points import Point, falls_short
from slopekit.studies.prob.estimates import Share, clopper_pearson, rank_correlation, unwrapped
from slopekit.studies.prob.sampling import Samples

IMPOSSIBLE = "impossible"
#: Outcomes of blocks that form and are not judged: no answer, or bolts that the block does not hold.
UNJUDGED = ("E5", "E211", "E212", "not_converged")
_RARE = 10  # failures: with fewer the estimate says little
_RANKED = 50_000  # samples that sensitivities are taken from: ranks of more take longer than all else
_OWN_STREAM = 0x5E1EC7  # apart from the stream that draws the samples


@dataclass(frozen=True)
class Judged:
    """What the method that counts says of the samples.

    Attributes
    ----------
    names, outcome, factor : by the lower of the block and what acceptance is held against besides
    alone : what is said of the block; None where it is judged by nothing else
    also : in words, what else fails first, and of how many samples that block alone would not have failed
    """

    names: tuple[str, ...]
    outcome: np.ndarray
    factor: Floats
    fails: Bools
    evaluator: str
    points: tuple[Point, ...] = ()
    alone: "Judged | None" = None
    also: tuple[str, int] = ("", 0)

    def among(self, *beginnings: str) -> Bools:
        """Samples whose outcome begins with one of these."""
        matches: Bools = np.array([name.startswith(beginnings) for name in self.names])[self.outcome]
        return matches

    @property
    def forms(self) -> Bools:
        """Samples that form a block, as far as is known."""
        return ~self.among("E", IMPOSSIBLE) | self.unjudged

    @property
    def possible(self) -> Bools:
        """Samples that a design can have."""
        return ~self.among("E1", IMPOSSIBLE)

    @property
    def counted(self) -> Bools:
        """Samples that a probability is taken of: where none has an answer, none."""
        return self.possible if (self.possible & ~self.unjudged).any() else self.possible & ~self.unjudged

    @property
    def unjudged(self) -> Bools:
        """Samples without an answer: they count as failures."""
        return self.among(*UNJUDGED)

    @property
    def disagree(self) -> int:
        """Samples on which the methods disagree or PRE-IE did not converge, where PRE-IE looked at all."""
        return sum(point.is_in_doubt for point in self.points)


def with_also(judged: Judged, also: ClosedForms, called: str, what: str, target: float) -> Judged:
    """The same with what acceptance is held against besides: of each sample the lower of the two counts.

    Parameters
    ----------
    also : of every sample, with the outcome "" where there is nothing else; called : what its outcomes begin with
    what : what it is, in words
    """
    ours, other = (
        _levels(names, outcome, factor)
        for names, outcome, factor in (
            (judged.names, judged.outcome, judged.factor), (also.names, also.outcome, also.factor),
        )
    )  # fmt: skip
    first = (other < ours) & judged.possible & ~judged.unjudged
    first &= judged.forms | (other < target)  # where it does not fail no block is no block
    if not first.any():
        return judged
    names = (*judged.names, *(f"{called}_{name}" for name in also.names))
    outcome = np.where(first, also.outcome + len(judged.names), judged.outcome).astype(np.int16)
    factor = np.where(first, also.factor, judged.factor)
    fails = judged.fails | (first & (other < target))
    only = int((fails & ~judged.fails).sum())
    return replace(judged, names=names, outcome=outcome, factor=factor, fails=fails, alone=judged, also=(what, only))


def also_of(
    points: Sequence[Point], without_block: Callable[[int], WithoutBasal | None]
) -> tuple[ClosedForms, str, str] | None:  # fmt: skip
    """What acceptance of points is held against besides, what its outcomes begin with, and what it is in words.

    Parameters
    ----------
    without_block : the same of a point, by its number, at which no block forms
    """
    every = [
        point.also if point.factors is not None
        else without_block(row) if point.code.startswith(("E2", "E44")) and point.code not in UNJUDGED else None
        for row, point in enumerate(points)
    ]  # fmt: skip
    known = next((one for one in every if one is not None), None)
    if known is None:
        return None
    words = ["" if one is None else one.status for one in every]
    names = tuple(dict.fromkeys(words))
    outcome = np.array([names.index(word) for word in words], dtype=np.int8)
    factor = np.array([np.nan if one is None or one.factor is None else one.factor for one in every])
    return ClosedForms(names, outcome, factor), known.NAME, known.WHAT


def _levels(names: Sequence[str], outcome: np.ndarray, factor: Floats) -> Floats:
    """Factors to compare: infinite where nothing drives or no block forms, 0 where nothing holds."""
    above = ("E", IMPOSSIBLE, "no_driving_force")
    stands = np.array([not name or name.startswith(above) for name in names])[outcome]
    levels: Floats = np.where(stands, np.inf, np.nan_to_num(factor, nan=0.0))
    return levels


def nowhere(judged: Judged, those: Bools) -> Judged:
    """The same, with those samples (n,) refused in which no place of the crack gives a factor (E459)."""
    if not those.any():
        return judged
    outcome, factor = judged.outcome.copy(), judged.factor.copy()
    outcome[those], factor[those] = len(judged.names), np.nan
    return replace(judged, names=(*judged.names, "E459"), outcome=outcome, factor=factor, fails=judged.fails & ~those)


def failing(names: Sequence[str], outcome: np.ndarray, factor: Floats, target: float) -> Bools:
    """Whether each sample falls short of the target: `falls_short` for arrays; without an answer it does."""
    stays = [name.startswith(("E", IMPOSSIBLE, "no_driving_force")) and not name.startswith(UNJUDGED) for name in names]
    with np.errstate(invalid="ignore"):
        fails: Bools = ~np.array(stays)[outcome] & ~(factor >= target)
    return fails


def sensitivities(samples: Samples, factor: Floats) -> tuple[tuple[str, float], ...]:
    """Spearman's coefficient of each column with the factor, the strongest first."""
    has_one = np.flatnonzero(~np.isnan(factor))
    if len(has_one) < 3:
        return ()
    has_one = has_one[:: -(-len(has_one) // _RANKED)]
    coefficients = [
        (path, rank_correlation(unwrapped(path, samples.values[has_one, column]), factor[has_one]))
        for column, path in enumerate(samples.names)
    ]
    known = [(path, value) for path, value in coefficients if value is not None]
    return tuple(sorted(known, key=lambda entry: -abs(entry[1])))


# -- PRE-IE beside a closed form ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Confirmation:
    """What PRE-IE says of some samples, beside the closed form.

    Attributes
    ----------
    index : (m,) the samples looked at; random : (m,) those of the random part; points : what came of each
    near : how many lie within the part `within` of the target
    largest : the largest relative difference among those that have two factors on the same assumptions
    governed : samples at random where moments govern, so that the closed form is too high
    unsafe, safe : samples that fail by PRE-IE and not by the closed form, and the other way round
    other_at_random : samples of the random part judged otherwise than by the closed form; other_at_most : upper
        confidence limit of their share among all samples
    probability : of failure, PRE-IE's judgement in place of the closed form's: where it was asked, and for the rest
        what the random part says of it; None where nothing was settled
    change_low, change_high : confidence limits of what PRE-IE changes of the closed form's share
    """

    index: np.ndarray = field(metadata={"json": None})
    random: Bools = field(metadata={"json": None})
    points: tuple[Point, ...] = field(metadata={"json": None})
    near: int = field(metadata={"json": "near_target"})
    within: float
    largest: float | None = field(metadata={"json": "largest_difference"})
    governed: int = field(metadata={"json": "moments_govern_at_random"})
    unsafe: int = field(metadata={"json": "fails_by_pre_ie_only"})
    safe: int = field(metadata={"json": "fails_by_closed_form_only"})
    other_at_random: int = field(metadata={"json": "judged_otherwise_at_random"})
    other_at_most: float = field(metadata={"json": "judged_otherwise_at_most"})
    probability: float | None
    change_low: float
    change_high: float

    JSON_ALSO: ClassVar = ("samples", "at_random", "agree", "disagree", "not_compared", "settled")

    @property
    def samples(self) -> int:
        """How many were looked at."""
        return len(self.index)

    @property
    def at_random(self) -> int:
        """How many of them at random."""
        return int(self.random.sum())

    @property
    def agree(self) -> int:
        """On how many the methods agree: the same assumptions, both with a factor or both with the same status."""
        return self._verdicts().count(True)

    @property
    def disagree(self) -> int:
        """On how many they disagree."""
        return self._verdicts().count(False)

    @property
    def not_compared(self) -> int:
        """On how many nothing is said of that."""
        return self._verdicts().count(None)

    def _verdicts(self) -> list[bool | None]:
        return [point.agree for point in self.points]

    @property
    def settled(self) -> int:
        """How many samples looked at PRE-IE could judge."""
        return self.samples - len(self.unsettled)

    @property
    def unsettled(self) -> tuple[Point, ...]:
        """What PRE-IE gave no answer for."""
        return tuple(point for point in self.points if not _settled(point))


#: The samples that PRE-IE is asked about, sorted (m,), and which of them are at random and near the target (m,).
Chosen: TypeAlias = tuple[Ints, Bools, Bools]


def chosen(forms: Bools, factor: Floats, target: float, count: int, within: float, seed: int) -> Chosen:
    """`count` samples at random among those that form a block, and all near the target.

    Parameters
    ----------
    forms, factor : (n,) of the closed form
    within : the part of the target that counts as near it
    """
    forming = np.flatnonzero(forms)
    with np.errstate(invalid="ignore"):
        close = forming[np.abs(factor[forming] / target - 1.0) <= within]
    rng = np.random.default_rng([seed, _OWN_STREAM])
    random = rng.choice(forming, min(count, len(forming)), replace=False) if len(forming) else forming
    index = np.union1d(random, close)
    return index, np.isin(index, random), np.isin(index, close)


def confirmation_of(
    asked: Chosen, points: tuple[Point, ...], forms: Bools, possible: Bools, fails: Bools, target: float,
    within: float, confidence: float,
) -> Confirmation:  # fmt: skip
    """What PRE-IE's points of the samples chosen say of the closed form's judgement of all samples.

    Parameters
    ----------
    forms, possible, fails : (n,) of the closed form
    """
    index, random, near = asked
    judged = np.array([_settled(point) for point in points], dtype=bool)
    fails_too = np.array([_fails(point, target) for point in points], dtype=bool)
    before = fails[index]
    other = judged & (fails_too != before)
    asked_at_random = int((random & judged).sum())
    other_at_random = int((other & random).sum())
    factors = [point.factors for point in points if point.factors is not None]
    differences = [both.difference for both in factors if both.difference is not None]
    governed = np.array([point.moments_govern for point in points], dtype=bool)
    # one-sided: only the upper limit is of interest
    at_most = clopper_pearson(other_at_random, asked_at_random, 2.0 * confidence - 1.0)[1] if asked_at_random else 1.0
    return Confirmation(
        index, random, points, int(near.sum()), within,
        max(differences, default=None), int((governed & random).sum()), int((other & fails_too).sum()),
        int((other & before).sum()), other_at_random, at_most,
        *_probability(asked, forms, fails, judged, fails_too, int(possible.sum()), confidence),
    )  # fmt: skip


def _settled(point: Point) -> bool:
    return point.factors is not None and point.factors.status != "not_converged"


def _fails(point: Point, target: float) -> bool:
    factors = point.factors
    if factors is None or not _settled(point):
        return False
    besides = factors.also is not None and factors.also.falls_short(target)
    return besides or falls_short(factors.status, factors.limit, target)


def _probability(
    asked: Chosen, forms: Bools, fails: Bools, judged: Bools, fails_too: Bools, possible: int, confidence: float
) -> tuple[float | None, float, float]:
    """The share of failures with PRE-IE's judgement, and limits of what it changes: two strata, their differences.

    Near the target all are asked, so that what changes there is counted; elsewhere the random part stands for the
    rest, in proportion (Cochran 1977, ch. 5 and 7). The limits take each kind of change at its own (Bonferroni), and
    the upper one takes samples without an answer for failures.
    """
    index, random, near = asked
    change = fails_too.astype(float) - fails[index]
    elsewhere = judged & random & ~near
    rest = int(forms.sum()) - int(near.sum())
    if not judged.any() or (rest and not elsewhere.any()) or possible == 0:
        return None, -1.0, 1.0
    changed = low = float(change[judged & near].sum())
    stood = ~judged & ~fails[index]  # by the closed form; PRE-IE has no answer
    high = changed + float((stood & near).sum())
    if rest:
        each, both = int(elsewhere.sum()), (1.0 + confidence) / 2.0
        unknown, away = int((stood & random & ~near).sum()), int((random & ~near).sum())
        worse = clopper_pearson(int((change[elsewhere] == 1.0).sum()), each, both)
        better = clopper_pearson(int((change[elsewhere] == -1.0).sum()), each, both)
        if unknown:
            worse = (worse[0], clopper_pearson(int((change[elsewhere] == 1.0).sum()) + unknown, away, both)[1])
        changed += float(change[elsewhere].mean()) * rest
        low, high = low + (worse[0] - better[1]) * rest, high + (worse[1] - better[0]) * rest
    share = min(1.0, max(0.0, (float(fails.sum()) + changed) / possible))
    return share, low / possible, high / possible


# -- notices ----------------------------------------------------------------------------------------------------------


def notices_of(
    target: float, judged: Judged, samples: Samples, share: Share, confirmation: Confirmation | None
) -> Iterator[Notice]:
    """Yield what a reader must know: W350, W353 and W507."""
    impossible = int(judged.among("E1", IMPOSSIBLE).sum())
    if impossible:
        yield Notice("W350", f"{impossible} of {len(samples.values)} samples have a value that no design can have, "
                     "and count nowhere: bound the distribution with min or max")  # fmt: skip
    unsolved = int(judged.unjudged.sum())
    if unsolved:
        said = "counted as failures, but may be none" if judged.counted.any() else "there is no probability"
        yield Notice("W350", f"{unsolved} of {len(samples.values)} samples gave no answer (not_converged, an error, "
                     f"or a bolt that misses the block or is too short): {said}")  # fmt: skip
    what, only = judged.also
    if only:
        yield Notice("W507", f"in {only} of {len(samples.values)} samples {what} falls short of {target:g}, and what "
                     "is analysed does not, or forms no block: they count as failures, as acceptance of a run is not "
                     "met")  # fmt: skip
    if share.count < _RARE and share.of:
        yield Notice("W350", f"{share.count} failures among {share.of} samples: judge by the upper limit, or draw more")
    if confirmation is None:
        governed = sum(point.moments_govern for point in judged.points)
        if governed:
            yield Notice(
                "W353",
                f"moments govern in {governed} of {len(samples.values)} samples: the closed form would be too high",
            )
        return
    yield from confirmation_notices(confirmation, "samples")
    if confirmation.governed:
        yield Notice(
            "W353",
            f"moments govern in {confirmation.governed} of {confirmation.at_random} samples at random: there the "
            "closed form is too high; --by pre-ie asks PRE-IE of every sample",
        )


def confirmation_notices(confirmation: Confirmation, called: str) -> Iterator[Notice]:
    """Yield W350 and W353 of what PRE-IE says beside the closed form; `called`: what it was asked of."""
    open_ones = confirmation.samples - confirmation.settled
    if open_ones:
        codes = ", ".join(dict.fromkeys(point.code or "not_converged" for point in confirmation.unsettled))
        yield Notice("W350", f"PRE-IE gave no answer for {open_ones} of the {confirmation.samples} {called} it was "
                     f"asked of ({codes}): they confirm nothing; the upper limit with PRE-IE's judgement takes "
                     "them for failures")  # fmt: skip
    if confirmation.unsafe:
        yield Notice("W353", f"{confirmation.unsafe} of {confirmation.samples} {called} fail by PRE-IE and stand by "
                     "the closed form: judge by PRE-IE")  # fmt: skip


def confirmation_words(checked: Confirmation, called: str, target: float) -> list[str]:
    """What PRE-IE was asked of, how far the methods agree, and what it judges otherwise than the closed form."""
    words = [f"{checked.agree} agree", f"{checked.disagree} DISAGREE" if checked.disagree else "0 disagree"]
    words += [f"{checked.not_compared} not compared"] if checked.not_compared else []
    words += [f"{checked.samples - checked.settled} WITHOUT ANSWER"] if checked.unsettled else []
    largest = "" if checked.largest is None else f"; largest difference {checked.largest * 100:.2g} %"
    most = number(float(f"{100.0 * checked.other_at_most:.2g}"))
    return [
        f"{checked.samples} {called}: {checked.at_random} at random, all {checked.near} within "
        f"{checked.within * 100:g} % of F = {target:g}",
        f"{', '.join(words)}{largest}; moments govern in {checked.governed} of {checked.at_random} at random",
        f"judged otherwise: {checked.unsafe} fail by PRE-IE only, {checked.safe} by the closed form only; of all "
        f"{called} at most {most} % (upper limit, from those at random)",
    ]
