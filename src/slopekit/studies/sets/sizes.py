"""Spacings and trace lengths of a set: mean, scatter, limits of the mean, what orientation and hidden ends change."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import number
from slopekit.design.survey import MeasuredJoint

_MIN_LENGTHS = 2
_MIN_COSINE = 0.26  # cosine between line and normal below which a line meets a set hardly: 15° and less from the set


@dataclass(frozen=True)
class Lengths:
    """The statistics of some lengths.

    Attributes
    ----------
    count : how many; mean_m, sd_m, least_m, most_m : of them; sd_m nan of one
    low_m, high_m : limits of the mean (Student), nan of one; confidence : of them
    how : what they are, in words
    """

    count: int
    mean_m: float
    sd_m: float
    least_m: float
    most_m: float
    low_m: float
    high_m: float
    confidence: float
    how: str


def lengths_of(values: Floats, description: str, confidence: float) -> Lengths:
    """The statistics of lengths (n,), at least one.

    >>> found = lengths_of(np.array([1.0, 2.0, 3.0]), "as measured", 0.95)
    >>> found.mean_m, found.sd_m, round(found.low_m, 2), round(found.high_m, 2)
    (2.0, 1.0, 0.0, 4.48)
    """
    from scipy.special import stdtrit

    count, mean = len(values), float(values.mean())
    sd = float(values.std(ddof=1)) if count >= _MIN_LENGTHS else math.nan
    half_width = (
        float(stdtrit(count - 1, 0.5 + confidence / 2.0)) * sd / math.sqrt(count)
        if count >= _MIN_LENGTHS
        else math.nan
    )
    low = max(0.0, mean - half_width) if count >= _MIN_LENGTHS else math.nan
    return Lengths(
        count,
        mean,
        sd,
        float(values.min()),
        float(values.max()),
        low,
        mean + half_width,
        confidence,
        description,
    )


def spacings_of(
    joints: Sequence[MeasuredJoint], mean: Floats, line: Floats | None, confidence: float
) -> Lengths | None:
    """The spacings of a set, square to its mean plane; None where the list has none.

    A column `spacing` is taken as it is: square to the joints. Else the distances between the positions along a
    scanline times the cosine between it and the normal of the mean plane (Terzaghi 1965; Priest & Hudson 1976).
    """
    measured_spacings = [joint.spacing_m for joint in joints if joint.spacing_m is not None]
    if measured_spacings:
        return lengths_of(
            np.array(measured_spacings), "column spacing, normal to the joints", confidence
        )
    positions = np.sort([joint.position_m for joint in joints if joint.position_m is not None])
    if line is None or len(positions) < _MIN_LENGTHS:
        return None
    cosine = abs(float(mean @ line))
    description = f"along the scanline, times {cosine:.3f}" + (
        "; the line runs nearly along the set" if cosine < _MIN_COSINE else ""
    )
    spacings: Lengths = lengths_of(np.diff(positions) * cosine, description, confidence)
    return spacings if spacings.mean_m > 0.0 else None


def traces_of(joints: Sequence[MeasuredJoint], confidence: float) -> Lengths | None:
    """The traces of a set as they were measured; None where the list has none.

    Long traces meet a scanline more often than short ones: that is not corrected.
    """
    traces = [joint.trace_m for joint in joints if joint.trace_m is not None]
    return lengths_of(np.array(traces), "as measured", confidence) if traces else None


def whole_traces(joints: Sequence[MeasuredJoint]) -> tuple[int | None, float | None]:
    """Return the number of traces with both ends visible, and the mean length corrected for the censored ones.

    Lengths whose ends are hidden are at least so long. With exponential lengths, n of them whole, the likeliest mean
    is Σ l / n (Epstein & Sobel 1953, J. Am. Stat. Assoc. 48, 486-502 (m)). None where nothing is said, none is whole.
    """
    traces = [
        (joint.trace_m, joint.ends)
        for joint in joints
        if joint.trace_m is not None and joint.ends is not None
    ]
    n_whole = sum(ends == 2 for _, ends in traces)
    return n_whole if traces else None, sum(
        trace for trace, _ in traces
    ) / n_whole if n_whole else None


def metres(value: float) -> str:
    """A length to three digits.

    >>> metres(2.3456), metres(12.0)
    ('2.35', '12')
    """
    return number(float(f"{value:.3g}"))
