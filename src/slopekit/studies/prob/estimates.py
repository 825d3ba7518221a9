"""Statistics of samples: shares with confidence limits, factors of safety in summary, rank correlation."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats

_MIN_CASES_PER_REPLICATE = (
    5  # cases of the rarer kind that each replicate needs for their scatter to mean something
)
_MAX_BINS = 60
_DIRECTIONS = ("dip_direction", "trend")  # the last word of their paths
_QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


@dataclass(frozen=True)
class Share:
    """A share of samples and the confidence limits of the probability behind it.

    Attributes
    ----------
    count, of : number of cases, number of samples
    share : count / of, None without samples
    low, high : confidence limits of the probability; confidence : of both limits together, 0.95
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
        """The share in per cent, None without samples."""
        return None if self.share is None else 100.0 * self.share


def clopper_pearson(count: int, trials: int, confidence: float = 0.95) -> tuple[float, float]:
    """Exact confidence limits of a probability from independent trials (Clopper & Pearson 1934).

    >>> low, high = clopper_pearson(0, 100)
    >>> low, round(high, 5)
    (0.0, 0.03622)
    """
    from scipy.special import betaincinv

    tail = (1.0 - confidence) / 2.0
    low = 0.0 if count == 0 else float(betaincinv(count, trials - count + 1, tail))
    high = 1.0 if count == trials else float(betaincinv(count + 1, trials - count, 1.0 - tail))
    return low, high


def share_of(
    cases: Bools, population: Bools, replicate: Floats | np.ndarray, confidence: float = 0.95
) -> Share:
    """Return the share of `cases` in a population of samples, with its confidence limits.

    Parameters
    ----------
    cases, population : (n,) whether a sample is a case, and whether it counts
    replicate : (n,) number of the independent replicate that a sample belongs to, all 0 where samples are independent

    Samples of a Latin hypercube are not independent: each replicate gives a share of its own, and Student's t
    of those gives the limits. Where cases are too rare for that, the limits are those of independent samples, which
    such samples keep: their scatter is not the larger one (Owen 1997 for Latin hypercubes).

    >>> share_of(np.arange(100) < 20, np.arange(100) < 50, np.zeros(100, dtype=int)).share
    0.4
    """
    count, total = int((cases & population).sum()), int(population.sum())
    if total == 0:
        return Share(0, 0, None, 0.0, 1.0, confidence, "no samples")
    replicates = int(replicate.max()) + 1 if replicate.size else 1
    if replicates > 1 and min(count, total - count) >= _MIN_CASES_PER_REPLICATE * replicates:
        replicate_totals = np.bincount(replicate[population], minlength=replicates)
        replicate_counts = np.bincount(replicate[cases & population], minlength=replicates)
        if replicate_totals.min() > 0:
            low, high = _student_limits(
                replicate_counts / replicate_totals,
                count / total,
                int(replicate_totals.min()),
                confidence,
            )
            return Share(
                count, total, count / total, low, high, confidence, f"{replicates} replicates"
            )
    low, high = clopper_pearson(count, total, confidence)
    return Share(count, total, count / total, low, high, confidence, "Clopper-Pearson")


def _student_limits(
    shares: Floats, share: float, size: int, confidence: float
) -> tuple[float, float]:
    """Return Student's confidence limits of a mean of shares, no nearer than half a sample of a replicate."""
    from scipy.special import stdtrit

    half_width = float(
        stdtrit(len(shares) - 1, 0.5 + confidence / 2.0)
        * np.std(shares, ddof=1)
        / math.sqrt(len(shares))
    )
    half_width = max(half_width, 0.5 / size)
    return max(0.0, share - half_width), min(1.0, share + half_width)


@dataclass(frozen=True)
class Summary:
    """Statistics of the factors of safety of the samples that have one.

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
        """Return the reliability index (mean - target) / sd, None where the factors do not vary."""
        return (self.mean - target) / self.sd if self.sd > 0.0 else None


def summary_of(factors: Sequence[float] | Floats) -> Summary | None:
    """Return the summary of factors of safety without those that are nan; None where no factor is left.

    >>> summary_of([1.0, 2.0, 3.0]).mean
    2.0
    """
    values = np.asarray(factors, dtype=np.float64)
    defined = values[~np.isnan(values)]
    if defined.size == 0:
        return None
    low, high = (float(value) for value in np.quantile(defined, (0.001, 0.999)))
    bins = int(min(_MAX_BINS, max(1, np.sqrt(defined.size))))
    if not high - low > 1e-12 * max(abs(high), 1e-300):
        low, high, bins = float(defined.min()), float(defined.max()), 1
    counts, edges = np.histogram(defined, bins, (low, high))
    return Summary(
        defined.size,
        float(defined.mean()),
        float(defined.std(ddof=1)) if defined.size > 1 else 0.0,
        float(defined.min()),
        float(defined.max()),
        dict(zip(_QUANTILES, np.quantile(defined, _QUANTILES).tolist(), strict=True)),
        tuple(edges.tolist()),
        tuple(counts.tolist()),
        int((defined < edges[0]).sum()),
        int((defined > edges[-1]).sum()),
    )


def rank_correlation(a: Floats, b: Floats) -> float | None:
    """Return Spearman's rank correlation of two samples (n,), None where one of them does not vary.

    >>> rank_correlation(np.array([1.0, 2.0, 3.0]), np.array([1.0, 8.0, 27.0]))
    1.0
    """
    from scipy.stats import rankdata

    first, second = (rankdata(values) - (len(values) + 1) / 2.0 for values in (a, b))
    size = math.sqrt(float(first @ first) * float(second @ second))
    return float(first @ second) / size if size > 0.0 else None


def sample_statistics(
    names: Sequence[str], pieces: Callable[[], Iterable[Floats]]
) -> list[dict[str, str | float]]:
    """Return path, mean, sd, min and max of each drawn number; of a direction the mean direction and the sd about it.

    Parameters
    ----------
    names : paths of the numbers; pieces : gives all values piece by piece (m, k), whenever it is called

    >>> pieces = [np.array([[350.0]]), np.array([[20.0]])]
    >>> (found,) = sample_statistics(["joints.J1.plane.dip_direction"], lambda: pieces)
    >>> [round(found[name], 9) for name in ("mean", "sd", "min", "max")]
    [5.0, 21.213203436, 350.0, 20.0]
    """
    directions = [column for column, name in enumerate(names) if _is_direction(name)]
    mean_direction = _mean_direction(
        sum(_unit_vector_sum(values[:, directions]) for values in pieces())
    )
    counts, piece_statistics = list[int](), list[Sequence[Floats]]()
    for piece in pieces():
        values = piece.copy()
        values[:, directions] = _unwrapped_about(mean_direction, values[:, directions])
        counts.append(len(values))
        piece_statistics.append(
            (values.mean(axis=0), values.var(axis=0), values.min(axis=0), values.max(axis=0))
        )
    means, variances, least, most = np.swapaxes(piece_statistics, 0, 1)
    mean = np.average(means, axis=0, weights=counts)
    variance = np.average(variances + (means - mean) ** 2, axis=0, weights=counts)
    mean_min_max = np.array([mean, least.min(axis=0), most.max(axis=0)])
    mean_min_max[:, directions] %= 360.0
    sd = np.sqrt(variance * (sum(counts) / max(sum(counts) - 1, 1)))
    columns = zip(names, *mean_min_max.tolist(), sd.tolist(), strict=True)
    return [
        {"path": name, "mean": average, "sd": sd, "min": low, "max": high}
        for name, average, low, high, sd in columns
    ]


def unwrapped(path: str, values: Floats) -> Floats:
    """Return directions (n,) within 180° of their mean, without the jump from 360 to 0; other values unchanged."""
    return (
        _unwrapped_about(_mean_direction(_unit_vector_sum(values)), values)
        if _is_direction(path)
        else values
    )


def _unit_vector_sum(directions_deg: Floats) -> Any:
    """Return the sum of directions (n, ...) as points of the unit circle, complex (...)."""
    return np.exp(1j * np.radians(directions_deg)).sum(axis=0)


def _mean_direction(point: Any) -> Any:
    """Return the direction of points of the plane in degrees."""
    return np.degrees(np.angle(point)) % 360.0


def _unwrapped_about(mean_direction_deg: Any, directions_deg: Floats) -> Floats:
    """Return directions in degrees within 180° of a mean direction."""
    unwrapped_deg: Floats = (
        mean_direction_deg + (directions_deg - mean_direction_deg + 180.0) % 360.0 - 180.0
    )
    return unwrapped_deg


def _is_direction(path: str) -> bool:
    return path.rpartition(".")[2] in _DIRECTIONS
