"""Shares counted in samples, with their confidence limits; what is said of a sample of numbers."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats

_LEAST_IN_REPLICATES = 5  # cases of the rarer kind that each replicate needs for their scatter to mean something
_MOST_BINS = 60
_DIRECTIONS = ("dip_direction", "trend")  # the last word of their paths
_QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


@dataclass(frozen=True)
class Share:
    """A share of samples and its confidence limits.

    Attributes
    ----------
    count, of : so many of so many
    share : None where there is no sample to take a share of
    low, high : confidence limits of the probability behind it; confidence : of both together, 0.95
    limits_by : Clopper-Pearson, or the scatter of replicates
    """

    count: int
    of: int
    share: float | None = field(metadata={"json": "probability"})
    low: float
    high: float
    confidence: float
    limits_by: str

    @property
    def percent(self) -> float | None:
        """The share in per cent."""
        return None if self.share is None else 100.0 * self.share


def clopper_pearson(count: int, of: int, confidence: float = 0.95) -> tuple[float, float]:
    """Exact confidence limits of a probability from independent trials (Clopper & Pearson 1934).

    >>> low, high = clopper_pearson(0, 100)
    >>> low, round(high, 5)
    (0.0, 0.03622)
    """
    from scipy.special import betaincinv

    tail = (1.0 - confidence) / 2.0
    low = 0.0 if count == 0 else float(betaincinv(count, of - count + 1, tail))
    high = 1.0 if count == of else float(betaincinv(count + 1, of - count, 1.0 - tail))
    return low, high


def share_of(cases: Bools, among: Bools, replicate: Floats | np.ndarray, confidence: float = 0.95) -> Share:
    """The share of `cases` among the samples `among`.

    Parameters
    ----------
    cases, among : (n,) statements about the samples
    replicate : (n,) number of the independent replicate that a sample belongs to, all 0 where samples are independent

    Samples of a Latin hypercube are not independent: each replicate gives a share of its own, and Student's t
    of those gives the limits. Where cases are too rare for that, the limits are those of independent samples, which
    such samples keep: their scatter is not the larger one (Owen 1997 for Latin hypercubes).

    >>> share_of(np.arange(100) < 20, np.arange(100) < 50, np.zeros(100, dtype=int)).share
    0.4
    """
    count, of = int((cases & among).sum()), int(among.sum())
    if of == 0:
        return Share(0, 0, None, 0.0, 1.0, confidence, "no samples")
    replicates = int(replicate.max()) + 1 if replicate.size else 1
    if replicates > 1 and min(count, of - count) >= _LEAST_IN_REPLICATES * replicates:
        each = np.bincount(replicate[among], minlength=replicates)
        own = np.bincount(replicate[cases & among], minlength=replicates)
        if each.min() > 0:
            low, high = _by_student(own / each, count / of, int(each.min()), confidence)
            return Share(count, of, count / of, low, high, confidence, f"{replicates} replicates")
    low, high = clopper_pearson(count, of, confidence)
    return Share(count, of, count / of, low, high, confidence, "Clopper-Pearson")


def _by_student(shares: Floats, share: float, size: int, confidence: float) -> tuple[float, float]:
    """Student's limits of a mean; no nearer than half of what one sample of a replicate makes."""
    from scipy.special import stdtrit

    reach = float(stdtrit(len(shares) - 1, 0.5 + confidence / 2.0) * np.std(shares, ddof=1) / math.sqrt(len(shares)))
    reach = max(reach, 0.5 / size)
    return max(0.0, share - reach), min(1.0, share + reach)


@dataclass(frozen=True)
class Summary:
    """What is said of the factors of safety of the samples that have one.

    Attributes
    ----------
    count : samples with a factor; mean, sd, least, most : of them
    quantiles : by the share of samples that lie below
    edges, counts : (b + 1,), (b,) histogram between the 0.1 % and 99.9 % quantiles; below, above : samples beyond it
    """

    count: int = field(metadata={"json": "samples"})
    mean: float
    sd: float
    least: float = field(metadata={"json": "min"})
    most: float = field(metadata={"json": "max"})
    quantiles: Mapping[float, float]
    edges: tuple[float, ...] = field(metadata={"json": None})
    counts: tuple[int, ...] = field(metadata={"json": None})
    below: int = field(metadata={"json": None})
    above: int = field(metadata={"json": None})

    def beta(self, target: float = 1.0) -> float | None:
        """(mean - target) / sd: how many standard deviations the mean lies above the target."""
        return (self.mean - target) / self.sd if self.sd > 0.0 else None


def summary_of(factors: Sequence[float] | Floats) -> Summary | None:
    """The summary of factors of safety, nan among them left out; None where there are none.

    >>> summary_of([1.0, 2.0, 3.0]).mean
    2.0
    """
    all_of_them = np.asarray(factors, dtype=np.float64)
    known = all_of_them[~np.isnan(all_of_them)]
    if known.size == 0:
        return None
    low, high = (float(value) for value in np.quantile(known, (0.001, 0.999)))
    bins = int(min(_MOST_BINS, max(1, np.sqrt(known.size))))
    if not high - low > 1e-12 * max(abs(high), 1e-300):
        low, high, bins = float(known.min()), float(known.max()), 1
    counts, edges = np.histogram(known, bins, (low, high))
    return Summary(
        known.size, float(known.mean()), float(known.std(ddof=1)) if known.size > 1 else 0.0, float(known.min()),
        float(known.max()), dict(zip(_QUANTILES, np.quantile(known, _QUANTILES).tolist(), strict=True)),
        tuple(edges.tolist()),
        tuple(counts.tolist()), int((known < edges[0]).sum()), int((known > edges[-1]).sum()),
    )  # fmt: skip


def rank_correlation(a: Floats, b: Floats) -> float | None:
    """Spearman's coefficient of two samples, None where one of them does not vary.

    >>> rank_correlation(np.array([1.0, 2.0, 3.0]), np.array([1.0, 8.0, 27.0]))
    1.0
    """
    from scipy.stats import rankdata

    first, second = (rankdata(values) - (len(values) + 1) / 2.0 for values in (a, b))
    size = math.sqrt(float(first @ first) * float(second @ second))
    return float(first @ second) / size if size > 0.0 else None


def sample_statistics(names: Sequence[str], pieces: Callable[[], Iterable[Floats]]) -> list[dict[str, str | float]]:
    """What was drawn of some numbers. Of a direction the mean is the mean direction, the sd about it.

    Parameters
    ----------
    names : paths of the numbers; pieces : gives all values piece by piece (m, k), whenever it is called

    >>> pieces = [np.array([[350.0]]), np.array([[20.0]])]
    >>> (found,) = sample_statistics(["joints.J1.plane.dip_direction"], lambda: pieces)
    >>> [round(found[name], 9) for name in ("mean", "sd", "min", "max")]
    [5.0, 21.213203436, 350.0, 20.0]
    """
    turned = [column for column, name in enumerate(names) if _is_direction(name)]
    middle = _middle(sum(_on_the_circle(values[:, turned]) for values in pieces()))
    counts, parts = list[int](), list[Sequence[Floats]]()
    for piece in pieces():
        values = piece.copy()
        values[:, turned] = _about(middle, values[:, turned])
        counts.append(len(values))
        parts.append((values.mean(axis=0), values.var(axis=0), values.min(axis=0), values.max(axis=0)))
    means, variances, least, most = np.swapaxes(parts, 0, 1)
    mean = np.average(means, axis=0, weights=counts)
    variance = np.average(variances + (means - mean) ** 2, axis=0, weights=counts)
    of = np.array([mean, least.min(axis=0), most.max(axis=0)])
    of[:, turned] %= 360.0
    sd = np.sqrt(variance * (sum(counts) / max(sum(counts) - 1, 1)))
    columns = zip(names, *of.tolist(), sd.tolist(), strict=True)
    return [{"path": name, "mean": own, "sd": sd, "min": low, "max": high} for name, own, low, high, sd in columns]


def unwrapped(path: str, values: Floats) -> Floats:
    """Values (n,) of a direction without the jump from 360 to 0, within 180° of their mean; others as they are."""
    return _about(_middle(_on_the_circle(values)), values) if _is_direction(path) else values


def _on_the_circle(directions_deg: Floats) -> Any:
    """Return the sum of directions (n, ...) as points of the unit circle, complex (...)."""
    return np.exp(1j * np.radians(directions_deg)).sum(axis=0)


def _middle(point: Any) -> Any:
    """Return the direction of points of the plane in degrees."""
    return np.degrees(np.angle(point)) % 360.0


def _about(middle_deg: Any, directions_deg: Floats) -> Floats:
    """Return directions within 180° of others."""
    turned: Floats = middle_deg + (directions_deg - middle_deg + 180.0) % 360.0 - 180.0
    return turned


def _is_direction(path: str) -> bool:
    return path.rpartition(".")[2] in _DIRECTIONS
