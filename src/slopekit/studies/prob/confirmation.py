"""PRE-IE on some of the samples that a closed form has judged: a random part, and all near the target."""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.studies.points import Point, falls_short
from slopekit.studies.prob.estimates import clopper_pearson

_OWN_STREAM = 0x5E1EC7  # apart from the stream that draws the samples


@dataclass(frozen=True, slots=True)
class Confirmation:
    """What PRE-IE says of some samples, beside the closed form.

    Attributes
    ----------
    index : (m,) the samples looked at; random : (m,) those of the random part; points : what came of each
    near : how many lie within the part `within` of the target
    agree, disagree, not_compared : on the same assumptions, both with a factor or both with the same status
    largest : the largest relative difference among those that have two factors on the same assumptions
    governed : samples at random where moments govern, so that the closed form is too high
    unsafe, safe : samples that fail by PRE-IE and not by the closed form, and the other way round
    settled : samples looked at that PRE-IE could judge
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
    agree: int
    disagree: int
    not_compared: int
    largest: float | None = field(metadata={"json": "largest_difference"})
    governed: int = field(metadata={"json": "moments_govern_at_random"})
    unsafe: int = field(metadata={"json": "fails_by_pre_ie_only"})
    safe: int = field(metadata={"json": "fails_by_closed_form_only"})
    settled: int
    other_at_random: int = field(metadata={"json": "judged_otherwise_at_random"})
    other_at_most: float = field(metadata={"json": "judged_otherwise_at_most"})
    probability: float | None
    change_low: float
    change_high: float

    JSON_ALSO: ClassVar = ("samples", "at_random")

    @property
    def samples(self) -> int:
        """How many were looked at."""
        return len(self.index)

    @property
    def at_random(self) -> int:
        """How many of them at random."""
        return int(self.random.sum())

    @property
    def unsettled(self) -> tuple[Point, ...]:
        """What PRE-IE gave no answer for."""
        return tuple(point for point in self.points if not _settled(point))


@dataclass(frozen=True, slots=True)
class Chosen:
    """The samples that PRE-IE is asked about, sorted (m,), and which of them are at random and near the target (m,)."""

    all: np.ndarray
    at_random: Bools
    near: Bools


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
    return Chosen(index, np.isin(index, random), np.isin(index, close))


def confirmation_of(
    asked: Chosen, points: tuple[Point, ...], forms: Bools, possible: Bools, fails: Bools, target: float,
    within: float, confidence: float,
) -> Confirmation:  # fmt: skip
    """What PRE-IE's points of the samples chosen say of the closed form's judgement of all samples.

    Parameters
    ----------
    forms, possible, fails : (n,) of the closed form
    """
    judged = np.array([_settled(point) for point in points])
    fails_too = np.array([_fails(point, target) for point in points])
    before = fails[asked.all]
    other = judged & (fails_too != before)
    asked_at_random = int((asked.at_random & judged).sum())
    other_at_random = int((other & asked.at_random).sum())
    factors = [point.factors for point in points if point.factors is not None]
    differences = [found.difference for found in factors if found.difference is not None]
    governed = np.array([point.factors is not None and point.factors.moments_govern for point in points])
    # one-sided: only the upper limit is of interest
    at_most = clopper_pearson(other_at_random, asked_at_random, 2.0 * confidence - 1.0)[1] if asked_at_random else 1.0
    return Confirmation(
        asked.all, asked.at_random, points, int(asked.near.sum()), within,
        sum(found.agree is True for found in factors), sum(found.agree is False for found in factors),
        len(points) - sum(found.agree is not None for found in factors), max(differences, default=None),
        int((governed & asked.at_random).sum()), int((other & fails_too).sum()), int((other & before).sum()),
        int(judged.sum()), other_at_random, at_most,
        *_probability(asked, forms, fails, judged, fails_too, int(possible.sum()), confidence),
    )  # fmt: skip


def _settled(point: Point) -> bool:
    return point.factors is not None and point.factors.status != "not_converged"


def _fails(point: Point, target: float) -> bool:
    found = point.factors
    return found is not None and _settled(point) and falls_short(found.status, found.limit, target)


def _probability(
    asked: Chosen, forms: Bools, fails: Bools, judged: Bools, fails_too: Bools, possible: int, confidence: float
) -> tuple[float | None, float, float]:
    """The share of failures with PRE-IE's judgement, and limits of what it changes: two strata, their differences.

    Near the target all are asked, so that what changes there is counted; elsewhere the random part stands for the
    rest, in proportion (Cochran 1977, ch. 5 and 7). The limits take each kind of change at its own (Bonferroni).
    """
    change = fails_too.astype(float) - fails[asked.all]
    elsewhere = judged & asked.at_random & ~asked.near
    rest = int(forms.sum()) - int(asked.near.sum())
    if not judged.any() or (rest and not elsewhere.any()) or possible == 0:
        return None, -1.0, 1.0
    changed = low = high = float(change[judged & asked.near].sum())
    if rest:
        worse, better = (
            clopper_pearson(int((change[elsewhere] == sign).sum()), int(elsewhere.sum()), (1.0 + confidence) / 2.0)
            for sign in (1.0, -1.0)
        )
        changed += float(change[elsewhere].mean()) * rest
        low, high = low + (worse[0] - better[1]) * rest, high + (worse[1] - better[0]) * rest
    share = min(1.0, max(0.0, (float(fails.sum()) + changed) / possible))
    return share, low / possible, high / possible
