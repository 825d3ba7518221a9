"""The density of poles on the hemisphere, by Kamb's method, smoothed.

Kamb (1959, J. Geophys. Res. 64, 1891-1909) with exponential smoothing as by Vollmer (1995, Computers & Geosciences 21,
31-49): with n poles and f = 2 (1 + n/σ²),

    (Σ w exp(f (|cos θ| - 1)) - 1/2) / √(n (f/2 - 1) / f²),

in standard deviations of what as many poles without order would give; σ = 3. mplstereonet draws it alike.
"""

import math

import numpy as np

from slopekit.core.arrays import Floats

_SIGMA = 3.0
_MAX_COSINES = 4_000_000  # cosines


def density(directions: Floats, poles: Floats, weights: Floats, joints: float) -> Floats:
    """Return Kamb's pole density (m,) in standard deviations, at least 0, at unit vectors `directions` (m, 3).

    Parameters
    ----------
    poles : (n, 3); weights : (n,); joints : how many they count as

    >>> up = np.array([[0.0, 0.0, 1.0]])
    >>> density(up, np.repeat(up, 10, axis=0), np.ones(10), 10.0).round(2).tolist()
    [12.03]
    """
    densities = np.zeros(len(directions))
    pole_weights = weights / weights.sum()
    step = max(1, _MAX_COSINES // max(1, len(poles)))
    for begin in range(0, len(directions), step):
        piece = slice(begin, begin + step)
        cosine = np.abs(directions[piece] @ poles.T)
        f = 2.0 * (1.0 + joints / _SIGMA**2)
        unit = math.sqrt(joints * (f / 2.0 - 1.0) / f**2)
        densities[piece] = (np.exp(f * (cosine - 1.0)) @ pole_weights * joints - 0.5) / unit
    return np.maximum(densities, 0.0)
