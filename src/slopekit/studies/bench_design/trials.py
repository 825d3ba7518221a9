"""Trial places along a bench where two joints of a survey meet, drawn from the survey with its weights.

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
_STREAM_KEY = 0xBE7C
_MAX_WEIGHTS = 4_000_000  # weights held at a time


@dataclass(frozen=True)
class Trials:
    """Trial places along a bench.

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
    """Draw trial places: two different joints each, with the product of their quantities.

    Parameters
    ----------
    anywhere : the toe is drawn along the face, all heights alike; else it is that of the bench
    """
    rng = np.random.default_rng([seed, _STREAM_KEY])
    weights = joints.quantities / joints.quantities.sum()
    first, second = (rng.choice(len(joints), count, p=weights) for _ in range(2))
    while (repeated := np.flatnonzero(first == second)).size:
        first[repeated], second[repeated] = (
            rng.choice(len(joints), repeated.size, p=weights) for _ in range(2)
        )
    toe = rng.random(count)
    return Trials(first, second, toe if anywhere else np.zeros(count))


def bootstrapped_shares(
    joints: JointList, trials: Trials, cases: Floats, seed: int, lengths: Floats | None = None
) -> Floats:
    """Return the shares (SURVEYS, k) of cases (n, k) in surveys that are drawn from this one.

    `lengths` (n,): shares of length in place of shares of trials.

    A survey in which joint j stands m_j times has the pair a, b with m_a m_b in place of w_a w_b.
    """
    rng = np.random.default_rng([seed, _STREAM_KEY, 1])
    weights = joints.quantities / joints.quantities.sum()
    survey_weights = rng.multinomial(len(joints), weights, SURVEYS) / (weights * len(joints))
    shares = np.empty((SURVEYS, cases.shape[1]))
    step = max(1, _MAX_WEIGHTS // max(1, len(trials)))
    for start in range(0, SURVEYS, step):
        joint_weights = survey_weights[start : start + step]
        trial_weights = joint_weights[:, trials.first] * joint_weights[:, trials.second]
        if lengths is not None:
            trial_weights *= lengths
        with np.errstate(invalid="ignore", divide="ignore"):
            shares[start : start + step] = (trial_weights @ cases) / trial_weights.sum(axis=1)[
                :, None
            ]
    return shares


def survey_share(
    cases: Bools,
    population: Bools | None,
    surveys: Floats,
    confidence: float,
    lengths: Floats | None = None,
) -> Share:
    """Return a share of trials with its limits: the wider of Wilson's (trials) and the bootstrap's (survey).

    Parameters
    ----------
    population : (n,) trials that the share is taken of, all where None; surveys : (s,) the share in drawn surveys
    lengths : (n,) for a share of length; the effective number of trials is then that of Kish (1965 (m))
    """
    total = len(cases) if population is None else int(population.sum())
    count = int(cases.sum()) if population is None else int((cases & population).sum())
    if total == 0:
        return Share(0, 0, None, 0.0, 1.0, confidence, "no samples")
    share, effective_trials = count / total, float(total)
    if lengths is not None:
        share, effective_trials = (
            float(lengths[cases].sum() / lengths.sum()),
            float(lengths.sum() ** 2 / (lengths**2).sum()),
        )
    low, high = wilson(share * effective_trials, effective_trials, confidence)
    finite_surveys = surveys[np.isfinite(surveys)]
    if finite_surveys.size:
        tail = (1.0 - confidence) / 2.0
        survey_limits = np.quantile(finite_surveys, [tail, 1.0 - tail])
        low, high = min(low, float(survey_limits[0])), max(high, float(survey_limits[1]))
    return Share(
        count,
        total,
        share,
        max(0.0, low),
        min(1.0, high),
        confidence,
        "Wilson and bootstrap of the survey",
    )


def wilson(count: float, trials: float, confidence: float = 0.95) -> tuple[float, float]:
    """Return confidence limits of a probability from independent trials (Wilson 1927).

    >>> low, high = wilson(8, 10)
    >>> round(low, 4), round(high, 4)
    (0.4902, 0.9433)
    """
    from scipy.special import ndtri

    z = float(ndtri(0.5 + confidence / 2.0))
    share, spread = count / trials, z * z / trials
    middle = (share + spread / 2.0) / (1.0 + spread)
    half_width = (
        z
        / (1.0 + spread)
        * float(np.sqrt(share * (1.0 - share) / trials + spread / (4.0 * trials)))
    )
    return max(0.0, middle - half_width), min(1.0, middle + half_width)
