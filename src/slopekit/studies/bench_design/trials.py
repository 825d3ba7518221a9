"""Places along a bench where two joints of a survey meet: drawn from the survey itself, with its own weights.

A trial is such a place: two different joints, each drawn as often as it was measured, and where on the face their line
daylights. The survey's own luck is bootstrapped (Efron 1979, Ann. Stat. 7, 1-26 (m)): the joints are drawn again from
the joints, which weighs the trials anew and needs no new ones.
"""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.design.joint_lists import JointList
from slopekit.studies.prob.estimates import Share

#: Surveys that are drawn from the survey.
SURVEYS = 200
_OWN_STREAM = 0xBE7C
_AT_ONCE = 4_000_000  # weights held at a time


@dataclass(frozen=True)
class Trials:
    """Places along a bench.

    Attributes
    ----------
    first, second : (n,) numbers of the joints; toe : (n,) where on the face they daylight, 0 at its toe, below 1
    """

    first: Ints
    second: Ints
    toe: Floats

    def __len__(self) -> int:
        return len(self.first)


def drawn_trials(joints: JointList, count: int, seed: int, anywhere: bool) -> Trials:
    """So many places; two joints are drawn with the product of their quantities, never one twice.

    Parameters
    ----------
    anywhere : the toe is drawn along the face, all heights alike; else it is that of the bench
    """
    rng = np.random.default_rng([seed, _OWN_STREAM])
    weights = joints.quantities / joints.quantities.sum()
    first, second = (rng.choice(len(joints), count, p=weights) for _ in range(2))
    while (same := np.flatnonzero(first == second)).size:
        first[same], second[same] = (rng.choice(len(joints), same.size, p=weights) for _ in range(2))
    toe = rng.random(count)
    return Trials(first, second, toe if anywhere else np.zeros(count))


def bootstrapped(
    joints: JointList, trials: Trials, cases: Floats, seed: int, lengths: Floats | None = None
) -> Floats:  # fmt: skip
    """Shares (SURVEYS, k) of cases (n, k) as surveys drawn from this one would have them.

    `lengths` (n,): shares of length in place of shares of trials.

    A survey in which joint j stands m_j times has the pair a, b with m_a m_b in place of w_a w_b.
    """
    rng = np.random.default_rng([seed, _OWN_STREAM, 1])
    weights = joints.quantities / joints.quantities.sum()
    drawn = rng.multinomial(len(joints), weights, SURVEYS) / (weights * len(joints))
    shares = np.empty((SURVEYS, cases.shape[1]))
    step = max(1, _AT_ONCE // max(1, len(trials)))
    for at in range(0, SURVEYS, step):
        part = drawn[at : at + step]
        each = part[:, trials.first] * part[:, trials.second]
        if lengths is not None:
            each *= lengths
        with np.errstate(invalid="ignore", divide="ignore"):
            shares[at : at + step] = (each @ cases) / each.sum(axis=1)[:, None]
    return shares


def share_of(
    cases: Bools, among: Bools | None, surveys: Floats, confidence: float, lengths: Floats | None = None
) -> Share:  # fmt: skip
    """A share of trials with its limits: the wider of Wilson's (of the trials) and the bootstrap's (of the survey).

    Parameters
    ----------
    among : of which it is a share, all where None; surveys : (s,) the same share in other surveys
    lengths : (n,) makes it a share of length; as many trials count then as would scatter alike (Kish 1965 (m))
    """
    of = len(cases) if among is None else int(among.sum())
    count = int(cases.sum()) if among is None else int((cases & among).sum())
    if of == 0:
        return Share(0, 0, None, 0.0, 1.0, confidence, "no samples")
    share, alike = count / of, float(of)
    if lengths is not None:
        share, alike = float(lengths[cases].sum() / lengths.sum()), float(lengths.sum() ** 2 / (lengths**2).sum())
    low, high = wilson(share * alike, alike, confidence)
    kept = surveys[np.isfinite(surveys)]
    if kept.size:
        tail = (1.0 - confidence) / 2.0
        own = np.quantile(kept, [tail, 1.0 - tail])
        low, high = min(low, float(own[0])), max(high, float(own[1]))
    return Share(count, of, share, max(0.0, low), min(1.0, high), confidence, "Wilson and bootstrap of the survey")


def wilson(count: float, of: float, confidence: float = 0.95) -> tuple[float, float]:
    """Confidence limits of a probability from independent trials (Wilson 1927).

    >>> low, high = wilson(8, 10)
    >>> round(low, 4), round(high, 4)
    (0.4902, 0.9433)
    """
    from scipy.special import ndtri

    z = float(ndtri(0.5 + confidence / 2.0))
    share, spread = count / of, z * z / of
    middle = (share + spread / 2.0) / (1.0 + spread)
    reach = z / (1.0 + spread) * float(np.sqrt(share * (1.0 - share) / of + spread / (4.0 * of)))
    return max(0.0, middle - reach), min(1.0, middle + reach)
