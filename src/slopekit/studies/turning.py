"""Orientations that scatter: Fisher's distribution about a mean, and angles folded back to the plane they mean."""

import numpy as np

from slopekit.arrays import Floats
from slopekit.orientation import Line, Plane

_SURELY_CONCENTRATED = 100.0  # k from which exp(-2k) is beyond all digits of any sample


def fisher(mean: Plane | Line, concentration: float, steeper: Floats, clockwise: Floats) -> tuple[Floats, Floats]:
    """Orientations with Fisher's distribution from two standard normals.

    Parameters
    ----------
    steeper, clockwise : (n,), independent of each other: how far the pole (the line) moves to where the dip (the
        plunge) grows, and square to that to where the direction grows

    Returns
    -------
    steep angle and direction, (n,) degrees: dip 0 to 90 and dip direction of a plane, whose pole may pass the
    horizontal; plunge -90 to 90 and trend of a line

    Notes
    -----
    The density on the sphere is k exp(k cos θ) / (4π sinh k), θ the angle to the mean, all azimuths alike (Fisher 1953,
    Dispersion on a sphere, Proc. R. Soc. A 217). So P(1 - cos θ > t) = (exp(-kt) - exp(-2k)) / (1 - exp(-2k)). Of two
    standard normals with the distance r from 0, S = exp(-r²/2) is uniform and their azimuth is, too; hence

        1 - cos θ = -ln(S + (1 - S) exp(-2k)) / k,      r²/2k where k is not small.

    >>> steep, direction = fisher(Plane(85.0, 115.0), 200.0, np.array([0.0, 2.0]), np.array([1.0, 0.0]))
    >>> steep.round(2).tolist(), direction.round(2).tolist()
    ([85.01, 86.89], [119.07, 295.0])
    """
    half_square = 0.5 * (steeper * steeper + clockwise * clockwise)
    if concentration >= _SURELY_CONCENTRATED:
        gap = np.minimum(half_square / concentration, 2.0)
        slope = np.sqrt((1.0 - 0.5 * gap) / concentration)  # sin θ / r
    else:
        # 1 - S where S is near 1, S itself where it is small
        near = np.log1p(np.expm1(-half_square) * -np.expm1(-2.0 * concentration))
        share = np.exp(-half_square)
        far = np.log(share + (1.0 - share) * np.exp(-2.0 * concentration))
        gap = np.minimum(np.where(half_square < 0.5, near, far) / -concentration, 2.0)
        slope = np.sqrt(gap * (1.0 - 0.5 * gap) / (half_square + np.finfo(float).tiny))
    cosine, up_dip, across = 1.0 - gap, slope * steeper, slope * clockwise
    if isinstance(mean, Plane):
        # upward pole: sin β along the dip direction, cos β up
        angle = np.radians(mean.dip_deg)
        along = cosine * np.sin(angle) + up_dip * np.cos(angle)
        up = cosine * np.cos(angle) - up_dip * np.sin(angle)
        steep = np.degrees(np.arctan2(np.sqrt(along * along + across * across), up))
        direction = mean.dip_direction_deg + np.degrees(np.arctan2(across, along))
        return folded_planes(steep, direction)
    angle = np.radians(mean.plunge_deg)
    along = cosine * np.cos(angle) - up_dip * np.sin(angle)
    down = cosine * np.sin(angle) + up_dip * np.cos(angle)
    plunge = np.degrees(np.arctan2(down, np.sqrt(along * along + across * across)))
    return plunge, _round_the_circle(mean.trend_deg + np.degrees(np.arctan2(across, along)))


def folded_planes(dip: Floats, direction: Floats) -> tuple[Floats, Floats]:
    """The same planes with dips of 0 to 90 and directions of 0 to 360 degrees.

    >>> folded_planes(np.array([95.0, -5.0, 45.0]), np.array([10.0, 10.0, 370.0]))
    (array([85.,  5., 45.]), array([190., 190.,  10.]))
    """
    beyond = (dip < 0.0) | (dip > 90.0)
    if beyond.any():
        dip, direction = dip.copy(), direction.copy()
        turned = dip[beyond] % 180.0  # a plane and its other side
        is_over = turned > 90.0
        dip[beyond] = np.where(is_over, 180.0 - turned, turned)
        direction[beyond] += 180.0 * is_over
    return dip, _round_the_circle(direction)


def folded_lines(plunge: Floats, trend: Floats) -> tuple[Floats, Floats]:
    """The same lines, as they point, with plunges of -90 to 90 and trends of 0 to 360 degrees.

    >>> folded_lines(np.array([95.0, -100.0]), np.array([10.0, 200.0]))
    (array([ 85., -80.]), array([190.,  20.]))
    """
    beyond = np.abs(plunge) > 90.0
    if beyond.any():
        plunge, trend = plunge.copy(), trend.copy()
        turned = (plunge[beyond] + 180.0) % 360.0 - 180.0
        is_over = np.abs(turned) > 90.0
        plunge[beyond] = np.where(is_over, np.copysign(180.0, turned) - turned, turned)
        trend[beyond] += 180.0 * is_over
    return plunge, _round_the_circle(trend)


def _round_the_circle(direction: Floats) -> Floats:
    beyond = (direction < 0.0) | (direction > 360.0)
    if not beyond.any():
        return direction
    return np.where(beyond, direction % 360.0, direction)
