"""A block that slides one way on a shaken base, integrated exactly (Newmark 1965).

While it slides its acceleration against the base is κ (a(t) - a_y). The record is linear between its samples, so the
velocity is a quadratic there and the displacement a cubic. With V the integral of κ (a - a_y), the velocity is

    v(t) = V(t) - min over s <= t of V(s)

(a block at rest starts where V is at its lowest, and stops where V is back there): nothing is stepped.
"""

import math

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass


@dataclass(frozen=True, slots=True)
class RecordSlide:
    """What comes of one record.

    Attributes
    ----------
    displacement_m : in all, what it slides on after the end of the record too
    after_m : of that after the end
    velocity, displacement : (n,) m/s and m at the samples
    """

    displacement_m: float
    after_m: float
    velocity: Floats
    displacement: Floats


def slide(times: Floats, accelerations: Floats, yield_acceleration: float) -> RecordSlide:
    """Sliding of a block with κ = 1; with another κ velocity and displacement are κ times as large.

    Parameters
    ----------
    times : (n,) s, never falling; accelerations : (n,) m/s² as they push the block, linear between
    yield_acceleration : a_y > 0, m/s²

    >>> pulse = np.array([0.0, 0.0, 0.3, 0.3]), np.array([0.0, 0.5, 0.5, 0.0]) * 9.80665
    >>> round(slide(*pulse, 0.1 * 9.80665).displacement_m, 6)  # V²/(2 g N) (1 - N/A), Newmark 1965
    0.882598
    """
    drive = accelerations - yield_acceleration
    steps = np.diff(times)
    first, last = drive[:-1], drive[1:]
    turns = np.flatnonzero(first * last < 0.0)
    share = first[turns] / (first[turns] - last[turns])
    t = np.insert(times, turns + 1, times[turns] + share * steps[turns])
    r = np.insert(drive, turns + 1, 0.0)
    sample = np.arange(len(times)) + np.searchsorted(turns, np.arange(len(times)))  # where the samples went
    h, r0, r1 = np.diff(t), r[:-1], r[1:]
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (r0 + r1) * h)])
    v = gained - np.minimum.accumulate(gained)
    v0, slows = v[:-1], (r0 <= 0.0) & (r1 <= 0.0)
    x = np.where(slows & (v[1:] <= 0.0), np.minimum(_until_rest(v0, r0, r1, h), h), h)
    bend = np.divide(r1 - r0, h, out=np.zeros_like(h), where=h > 0.0)
    moved = np.where(slows & (v0 <= 0.0), 0.0, x * (v0 + x * (0.5 * r0 + x * bend / 6.0)))
    d = np.concatenate([[0.0], np.cumsum(moved)])
    after = float(v[-1]) ** 2 / (2.0 * yield_acceleration)
    return RecordSlide(float(d[-1]) + after, after, v[sample], d[sample])


def _until_rest(v0: Floats, r0: Floats, r1: Floats, h: Floats) -> Floats:
    """First x > 0 where v0 + r0 x + (r1 - r0) x² / 2h is 0, with r0, r1 <= 0; by the form that does not cancel."""
    bend = np.divide(r1 - r0, h, out=np.zeros_like(h), where=h > 0.0)
    root = np.sqrt(np.maximum(r0 * r0 - 2.0 * bend * v0, 0.0)) - r0
    return np.divide(2.0 * v0, root, out=np.full_like(h, math.inf), where=root > 0.0)
