"""Limits of size of wedges: the scale of a wedge that is larger than its limits, or the reason why it is ignored.

Planes without an end cut the largest wedge that the slope has room for. What is known of the joints and of the bench
makes it smaller: it keeps its shape and its crest, and its toe moves up the face, so that all lengths shrink alike.

Words and meaning as in SWedge (Rocscience, help pages Slope Length, Bench Width, Scale Wedge): the slope length runs
along the crest, the bench width is horizontal and square to it, a trace length is the longer of a joint's two traces,
persistence the longest edge of its face; of several limits the one that leaves the smallest wedge counts.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.closed_form.sizes import WedgeSizes, wedge_sizes
from slopekit.core.arrays import Floats, NDArray
from slopekit.core.errors import Fault, GeometryError
from slopekit.core.orientation import number
from slopekit.design.fields import fields_of
from slopekit.kinds.words import short, size_number

#: The limit that governs the size of a wedge.
LIMITED_BY = ("", "trace length", "persistence", "slope length", "bench width", "max volume")
#: Codes of wedges that are ignored: larger than their limits, too small.
CODES = ("E486", "E487")
_LENGTH_ROUNDING = 1e-12  # of a length: a smaller excess over a limit is rounding


@dataclass(frozen=True)
class Fitted:
    """Wedges within their limits of size, (n,) each.

    Attributes
    ----------
    sizes : at that size, nan where the planes cut no wedge
    scale : of lengths, 1 of the largest wedge in the slope; by : index into `LIMITED_BY`
    refusal : 0 where the wedge stays, 1 where it is larger than its limits (E486), 2 where it is too small (E487)
    """

    sizes: WedgeSizes
    scale: Floats
    by: NDArray[np.int8]
    refusal: NDArray[np.int8]


def fitted(design: Any) -> Fitted:
    """Return the wedges of a design, whose numbers may be arrays, within its limits of size."""
    planes = {
        "joint1": design.joints[0],
        "joint2": design.joints[1],
        "face": design.face,
        "upper": design.upper,
    }
    angles = {
        f"{name}_{key}": getattr(plane, key)
        for name, plane in planes.items()
        for key in ("dip_deg", "dip_direction_deg")
    }
    limits, numbers = design.limits, [*angles.values(), design.height_m]
    if limits is not None:
        numbers += [
            *limits.trace_length_m,
            *limits.persistence_m,
            limits.slope_length_m,
            limits.bench_width_m,
            limits.max_volume_m3,
            limits.min_volume_m3,
        ]
    count = max(np.size(number_of_rows) for number_of_rows in numbers)
    heights = np.broadcast_to(np.asarray(design.height_m, dtype=np.float64), count)
    return fitted_sizes(limits, wedge_sizes(**angles, height_m=heights))


def fitted_sizes(limits: Any, sizes: WedgeSizes) -> Fitted:
    """Return wedges of given sizes (n,) within limits of size (`SizeLimits`), unchanged where there are no limits.

    Parameters
    ----------
    limits : each a number, (n,), or None; of trace length and persistence those of J1 and J2

    >>> from types import SimpleNamespace
    >>> none = dict.fromkeys(("trace_length_m", "persistence_m", "slope_length_m", "min_volume_m3", "by"))
    >>> limits = SimpleNamespace(**none, bench_width_m=5.0, max_volume_m3=80.0)
    >>> fit = fitted_sizes(limits, wedge_sizes(45, 135, 45, 225, 90, 180, 0, 180, 10.0))
    >>> fit.scale.round(4).tolist(), LIMITED_BY[fit.by[0]]
    ([0.3536], 'bench width')
    """
    count = len(sizes.volume_m3)
    refusal, scale, governing = (
        np.zeros(count, dtype=np.int8),
        np.ones(count),
        np.zeros(count, dtype=np.int8),
    )
    if limits is None:
        return Fitted(sizes, scale, governing, refusal)
    trace_m, persistence_m = (
        limits.trace_length_m or (None, None),
        limits.persistence_m or (None, None),
    )
    limited_sizes = (
        (trace_m[0], np.maximum(sizes.trace1_m, sizes.upper_trace1_m), 1),
        (trace_m[1], np.maximum(sizes.trace2_m, sizes.upper_trace2_m), 1),
        (persistence_m[0], sizes.longest1_m, 2),
        (persistence_m[1], sizes.longest2_m, 2),
        (limits.slope_length_m, sizes.face_width_m, 3),
        (limits.bench_width_m, sizes.setback_m, 4),
        (limits.max_volume_m3, sizes.volume_m3, 5),
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        for limit, size, kind in limited_sizes:
            if limit is None:
                continue
            factor = np.asarray(limit, dtype=np.float64) / size
            factor = np.cbrt(factor) if kind == LIMITED_BY.index("max volume") else factor
            is_smaller = factor < scale * (1.0 - _LENGTH_ROUNDING)
            scale, governing = (
                np.where(is_smaller, factor, scale),
                np.where(is_smaller, np.int8(kind), governing),
            )
        if limits.by == "filter":
            refusal[scale < 1.0] = 1
            scale = np.ones(count)
        sizes = sizes.scaled(scale)
        if limits.min_volume_m3 is not None:
            refusal[(refusal == 0) & (sizes.volume_m3 < limits.min_volume_m3)] = 2
    return Fitted(sizes, scale, governing, refusal)


def slope_height(design: Any) -> float:
    """Return the height (m) of one wedge, less than that of the slope where limits of size make it smaller.

    Raises
    ------
    GeometryError
        E486 larger than its limits where these filter, E487 smaller than its least volume.
    """
    if design.limits is None:
        return float(design.height_m)
    fit = fitted(design)
    if fit.refusal[0]:
        raise GeometryError([_fault(design, fit)])
    return float(design.height_m * fit.scale[0])


def scaled(design: Any) -> dict[str, Any] | None:
    """Return the factor of the lengths of one wedge and the limit that governs it; None without limits."""
    if design.limits is None:
        return None
    fit = fitted(design)
    return {"factor": float(fit.scale[0]), "by": LIMITED_BY[fit.by[0]] or None}


def in_words(design: Any) -> list[str]:
    """Return the effect of the limits of size on one wedge, as the sheet prints it."""
    fit, listed = fitted(design), limits_in_words(design)
    if not fit.by[0]:
        return [f"within its limits of size: {listed}"]
    limit_name, scale = LIMITED_BY[fit.by[0]], fit.scale[0]
    higher = short(design.height_m * (1.0 - scale))
    return [
        f"made smaller by the limit of {limit_name}: lengths times {scale:.4g}, same shape, at the crest, "
        f"its toe {higher} m higher ({listed})"
    ]


def limits_in_words(design: Any) -> str:
    """Return the limits of size of a design in words."""
    limits, texts = design.limits, []
    for name, values in (
        ("trace length", limits.trace_length_m),
        ("persistence", limits.persistence_m),
    ):
        stated = [
            (joint, value)
            for joint, value in zip(design.joint_names, values, strict=False)
            if value is not None
        ]
        if stated and len({value for _, value in stated}) == 1 and len(stated) == 2:
            texts.append(f"{name} {number(stated[0][1])} m")
        elif stated:
            texts.append(
                f"{name} {', '.join(f'{joint} {number(value)} m' for joint, value in stated)}"
            )
    for name, field in fields_of(type(limits)).items():
        value = getattr(limits, name)
        if field.is_number and not field.per_interface and value is not None:
            texts.append(f"{field.in_words} {number(value)} {field.unit}")
    return ", ".join(texts) + (": larger ones are left out" if limits.by == "filter" else "")


def _fault(design: Any, fit: Fitted) -> Fault:
    if fit.refusal[0] == 1:
        limit_name, advice = LIMITED_BY[fit.by[0]], "limits.by: scale makes it smaller instead."
        message = f"the wedge is larger than the limit of {limit_name} ({limits_in_words(design)})"
        return Fault("E486", message, "limits", advice)
    volume = size_number(fit.sizes.volume_m3[0])
    least = number(design.limits.min_volume_m3)
    return Fault(
        "E487", f"the wedge has {volume} m³, less than the min volume of {least} m³", "limits"
    )
