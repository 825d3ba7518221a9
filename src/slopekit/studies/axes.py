"""Statistics of weighted poles: mean, scatter and shape, by the orientation tensor and Fisher's distribution.

A pole and its opposite are the same joint: axes, not directions. The mean is the first eigenvector of the orientation
tensor Σ w x xᵀ / Σ w (Woodcock 1977, Geol. Soc. Am. Bull. 88, 1231-1236); about it the axes are taken on its own side
and treated as Fisher (1953, Proc. R. Soc. A 217, 295-305) treats directions.

>>> down = np.array([[0.0, 0.1, -1.0], [0.1, 0.0, -1.0], [-0.1, -0.1, -1.0], [0.0, 0.1, 1.0]])
>>> found = axes_of(down / np.sqrt((down * down).sum(axis=1))[:, None], np.ones(4))
>>> found.joints, found.mean.round(3).tolist(), round(found.k, 1)
(4.0, [0.0, -0.025, -1.0], 127.6)
"""

import math
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import downward

#: Least scatter (rad) of joints: below it K would be a ratio of rounding errors.
_LEAST_SCATTER = 1e-7
_LARGEST_K = 1.0 / _LEAST_SCATTER**2
_LEAST_JOINTS = 3  # least number of joints of a set whose scatter has a shape


@dataclass(frozen=True)
class Axes:
    """The statistics of a set of axes.

    Attributes
    ----------
    joints : how many they count as: (Σ w)² / Σ w² where weights correct a bias (Kish 1965 (m)), so that weights, which
        add no joints, do not narrow the limits
    mean : (3,) downward unit vector; eigenvalues : (3,) of the orientation tensor, largest first, they add up to 1
    resultant : length of the mean of the axes on the side of the mean, 1 where all are alike
    k : Fisher's concentration (N - 1) / (N - R); inf where all are alike, nan of one joint
    k_low, k_high : its limits; cone_deg : half angle of the cone that holds the true mean; both to `confidence`
    """

    joints: float
    mean: Floats
    eigenvalues: Floats
    resultant: float
    k: float
    k_low: float
    k_high: float
    cone_deg: float
    confidence: float

    @property
    def scatter_deg(self) -> float:
        """Root mean square angle to the mean, √(2 / K): what `scatter` of a bench's joint set is; nan of one joint."""
        return math.degrees(math.sqrt(2.0 / self.k)) if self.k > 0.0 else math.nan

    @property
    def is_elongated(self) -> bool:
        """Whether the axes scatter more one way than the other, so that Fisher's K says the mean of two scatters.

        The sphericity of two coordinates about their mean, W = 4 λ1 λ2 / (λ1 + λ2)² with the two lesser eigenvalues,
        has P(W < w) = w^((N - 2) / 2) where they are alike (Mauchly 1940, as in Pillai &
        Nagarsenker 1971, Ann. Math. Stat. 42, 764-767; the tail (m)); less than 1 % is taken as another shape.
        """
        second, third = float(self.eigenvalues[1]), float(max(self.eigenvalues[2], 0.0))
        if self.joints < _LEAST_JOINTS + 1 or second < _LEAST_SCATTER**2:
            return False
        sphericity = 4.0 * second * third / (second + third) ** 2
        return bool(sphericity ** ((self.joints - 2.0) / 2.0) < 0.01)

    def cone_of(self, share: float) -> float:
        """Return the half angle (degrees) of the cone about the mean with a share of the axes; nan of one joint."""
        return cone_of(self.k, share)


def axes_of(
    poles: Floats, weights: Floats, counts: Floats | None = None, confidence: float = 0.95
) -> Axes:
    """Return the statistics of weighted axes, such as the poles of a joint set.

    Parameters
    ----------
    poles : (n, 3) unit vectors of either sign, at least one
    weights : (n,) above 0, of each against its bias; counts : (n,) how often each was measured
    confidence : of K's limits and of the cone of the mean

    With R the length of Σ x of N axes (Fisher 1953; Fisher, Lewis & Embleton 1987, §5.3.2):

        K = (N - 1) / (N - R),    2 K (N - R) ~ χ² of 2 (N - 1),    cos α = 1 - (N - R) / R (p^(-1 / (N - 1)) - 1)
    """
    counts = np.ones(len(poles)) if counts is None else counts
    pole_weights = weights * counts
    weight_sum = float(pole_weights.sum())
    joints = weight_sum**2 / float((weights * pole_weights).sum())
    values, vectors = np.linalg.eigh(
        np.einsum("n,ni,nj->ij", pole_weights, poles, poles) / weight_sum
    )
    mean = downward(vectors[:, -1])
    total = (pole_weights * np.where(poles @ mean < 0.0, -1.0, 1.0)) @ poles / weight_sum
    resultant = min(1.0, math.sqrt(float(total @ total)))
    gap = 1.0 - resultant
    if joints <= 1.0 + 1e-9:
        k = low = high = cone = math.nan
    elif gap <= _LEAST_SCATTER**2:
        k, low, high, cone = math.inf, math.inf, math.inf, 0.0
    else:
        k, low, high = _concentration(joints, gap, confidence)
        shift = gap / resultant * math.expm1(-math.log1p(-confidence) / (joints - 1.0))
        cone = math.degrees(math.acos(max(-1.0, 1.0 - shift)))
    return Axes(
        joints,
        mean,
        np.clip(values[::-1], 0.0, 1.0),
        resultant,
        k,
        low,
        high,
        min(cone, 90.0),
        confidence,
    )


def _concentration(joints: float, gap: float, confidence: float) -> tuple[float, float, float]:
    """Return Fisher's K and its confidence limits from N and 1 - R/N."""
    from scipy.special import gammaincinv

    tail = (1.0 - confidence) / 2.0
    low, high = (
        float(gammaincinv(joints - 1.0, probability)) for probability in (tail, 1.0 - tail)
    )  # χ² / 2 of 2 (N - 1)
    return (joints - 1.0) / (joints * gap), low / (joints * gap), high / (joints * gap)


def cone_of(k: float, share: float) -> float:
    """Return the half angle (degrees) of the cone about the mean that holds a share of axes of Fisher's distribution.

    1 - cos θ = -ln(1 - P (1 - exp(-2K))) / K (Fisher 1953).

    >>> round(cone_of(100.0, 0.5), 2), cone_of(math.inf, 0.95)
    (6.75, 0.0)
    """
    if not k > 0.0 or k >= _LARGEST_K:
        return 0.0 if k > 0.0 else math.nan
    gap = -math.log1p(-share * -math.expm1(-2.0 * k)) / k
    return min(90.0, math.degrees(math.acos(max(-1.0, 1.0 - gap))))


def terzaghi_weights(poles: Floats, line: Floats, least_angle_deg: float) -> Floats:
    """Return weights (n,) of joints met by a scanline: 1 / sin of the angle between joint and line (Terzaghi 1965).

    A line meets joints nearly along it seldom; those nearer to it than `least_angle_deg` get the weight of that angle.

    >>> terzaghi_weights(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]), np.array([1.0, 0.0, 0.0]), 30.0).round(12)
    array([1., 2.])
    """
    return 1.0 / np.maximum(np.abs(poles @ line), math.sin(math.radians(least_angle_deg)))
