"""Charts of one design (matplotlib): what accuracy costs, what facets do to a curved surface, what reducing does.

Error against time and the curves of a check come from its JSON, as does figure 7 of Sheng et al. (2023). Need the extra
`plot`.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from slopekit.core.errors import DesignError, Fault
from slopekit.core.records import dataclass
from slopekit.core.sheet import factor_text
from slopekit.kinds.single_block.ladders import METHODS
from slopekit.views.charts.drawing import (
    BLUE,
    DARK,
    FOS,
    GREY,
    NUMBER,
    RED,
    Damaged,
    finish,
    needs,
    note,
    nothing,
    short,
    title_of,
)

#: What an error that rounds to nothing is drawn as: the bottom of the chart, with an open marker.
FLOOR = 1e-16
_COLOURS = ("#0064a4", "#c8500a", "#007f5f", "#a8548a", "#d89000", "#4d4d4d", "#56b4e9", "#5b5b9e", "#7a6a00")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<")
#: Where a label may stand beside its point, in points, best first.
_BESIDE = ((7, 4), (7, -11), (-7, 4), (-7, -11), (0, 9), (0, -16), (12, 14), (-12, 14), (12, -22), (-12, -22))
#: A line of the legend, in letters of its size: all of it, and what marker and gap take of an entry.
_LINE, _HANDLE = 125, 7
_OPEN = "open: no error to 16 digits"
_ROOM, _ALONG = 4.5, 4.0  # half the side of the square that a marker takes; from square to square of a line; points
Document = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Curve:
    """One line of a chart; lines of one name share a colour and an entry of the legend.

    Attributes
    ----------
    name : as the legend shows it
    at : (n,) abscissae: seconds, or the parameter of a sweep
    errors : (n,) relative errors, 0 where there is none to see
    labels : (n,) what to write beside the points, or nothing
    joined : whether a line joins the points
    crossed : (n,) points to draw as crosses in place of the marker, or nothing
    """

    name: str
    at: Sequence[float]
    errors: Sequence[float]
    labels: Sequence[str] = ()
    joined: bool = True
    crossed: Sequence[bool] = ()


def draw_speed_error(
    figure: Any, curves: Sequence[Curve], title: str, *, wanted: float | None = None, against: str = "the closed form"
) -> None:
    """Error against time, both logarithmic.

    Parameters
    ----------
    curves : `at` in seconds
    wanted : the relative error that is good enough, drawn as a line
    against : what the errors are measured against

    Raises
    ------
    DesignError
        E273 without a point to draw.
    """

    def dress(axes: Any) -> None:
        axes.set_xlabel("time, s")
        axes.set_ylabel(f"relative error against {against}")
        if wanted is not None:
            axes.axhline(wanted, color="#888888", linestyle="--", linewidth=1.0)
            axes.annotate(f"wanted: {wanted:g}", (0.995, wanted), xycoords=("axes fraction", "data"), ha="right",
                          va="bottom", fontsize=8, color="#555555")  # fmt: skip

    check_curves(curves, "")
    draw_chart(figure, curves, title, dress)


def check_curves(curves: Sequence[Curve], path: Path | str, logarithmic: bool = True) -> None:
    """Raise E273 where no curve has a point that can be drawn."""
    points = [point for curve in curves for point in zip(curve.at, curve.errors, strict=True)]
    if not any(math.isfinite(x + error) and (x > 0.0 or not logarithmic) for x, error in points):
        message = "there is nothing to draw: no curve has a point"
        raise DesignError([Fault("E273", message, str(path), "Give at least one curve with one point.")])


def draw_chart(
    figure: Any, curves: Sequence[Curve], title: str, dress: Callable[[Any], None], *, logarithmic: bool = True,
    sizes: tuple[float, float] = (6.5, 6.5), crosses: str = "",
) -> None:  # fmt: skip
    """Draw; `sizes` of the first and the last marker: where they grow the first lie on top, and none is hidden."""
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    names = list(dict.fromkeys(curve.name for curve in curves if len(curve.at)))
    first, last = sizes
    size_of = [first + min(1.5, (last - first) / max(1, len(names) - 1)) * k for k in range(len(names))]
    labels: list[tuple[float, float, str, str]] = []
    for curve in curves:
        if not len(curve.at):
            continue
        k = names.index(curve.name)
        colour, marker = _COLOURS[k % len(_COLOURS)], _MARKERS[k % len(_MARKERS)]
        drawn = [max(abs(error), FLOOR) for error in curve.errors]
        style = "-" if curve.joined else "none"
        above = 3.0 - (k + 1) / (len(names) + 1) if last > first else 2.0
        axes.plot(curve.at, drawn, color=colour, linestyle=style, linewidth=1.2, alpha=0.8)
        crossed = curve.crossed or [False] * len(drawn)
        for x, error, y, cross in zip(curve.at, curve.errors, drawn, crossed, strict=True):
            face = colour if abs(error) > FLOOR else "none" if last > first else "white"
            shape, edge = ("x", 1.5) if cross else (marker, 1.0)
            axes.plot([x], [y], marker=shape, color=colour, markerfacecolor=face, markersize=size_of[k],
                      markeredgewidth=edge, linestyle="none", zorder=above)  # fmt: skip
        labels += [(x, y, text, colour) for x, y, text in zip(curve.at, drawn, curve.labels, strict=False) if text]
    for k, name in enumerate(names):
        style = "-" if any(curve.joined and len(curve.at) > 1 for curve in curves if curve.name == name) else "none"
        colour, marker = _COLOURS[k % len(_COLOURS)], _MARKERS[k % len(_MARKERS)]
        axes.plot([], [], color=colour, marker=marker, markersize=size_of[k], linestyle=style, label=name)
    entries = list(names)
    if crosses and any(any(curve.crossed) for curve in curves):
        axes.plot([], [], color="#4d4d4d", marker="x", markeredgewidth=1.5, linestyle="none", label=crosses)
        entries.append(crosses)
    bare = any(abs(error) <= FLOOR for curve in curves for error in curve.errors)
    if bare:
        axes.plot([], [], color="#4d4d4d", marker="o", markerfacecolor="white", linestyle="none", label=_OPEN)
        entries.append(_OPEN)
    dress(axes)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, FLOOR / 2.0) if bare else low, high * 2.0)
    axes.margins(x=0.08)
    finish(figure, axes, title, _columns(map(len, entries)))
    figure.draw_without_rendering()  # the layout settles where points and labels come to lie
    _write_labels(figure, axes, labels, curves)


def _columns(letters: Iterable[int]) -> int:
    """Into how many columns entries of so many letters go; the first columns hold one entry more than the last."""
    widths = [_HANDLE + many for many in letters]
    for columns in range(len(widths), 1, -1):
        rows, longer = divmod(len(widths), columns)
        ends = [rows * k + min(k, longer) for k in range(columns + 1)]
        if sum(max(widths[begin:end]) for begin, end in pairwise(ends)) <= _LINE:
            return columns
    return 1


def _write_labels(
    figure: Any, axes: Any, labels: Sequence[tuple[float, float, str, str]], curves: Sequence[Curve]
) -> None:
    """Write (x, y, text, colour) beside their points where they cover no point, no line and no other label."""
    renderer, dots = figure.canvas.get_renderer(), figure.dpi / 72.0
    taken: list[tuple[float, float, float, float]] = []
    for curve in curves:
        drawn = [(x, max(abs(error), FLOOR)) for x, error in zip(curve.at, curve.errors, strict=True)]
        at = [tuple(point) for point in axes.transData.transform(drawn)] if drawn else []
        taken += [_square(x, y, _ROOM * dots) for x, y in at]
        for (x, y), (u, v) in pairwise(at):
            steps = 1 + int(max(abs(u - x), abs(v - y)) / (_ALONG * dots)) if curve.joined else 1
            taken += [_square(x + (u - x) * k / steps, y + (v - y) * k / steps, dots) for k in range(1, steps)]
    frame = axes.get_window_extent(renderer)
    for x, y, text, colour in labels:
        tried: list[tuple[float, int, Any, Any]] = []
        for dx, dy in _BESIDE:
            written = axes.annotate(
                text, (x, y), xytext=(dx, dy), textcoords="offset points", fontsize=7.5, color=colour,
                ha="left" if dx > 0 else "right" if dx < 0 else "center",
            )  # fmt: skip
            box = written.get_window_extent(renderer)
            covered = sum(
                max(0.0, min(box.x1, right) - max(box.x0, left)) * max(0.0, min(box.y1, top) - max(box.y0, low))
                for left, low, right, top in taken
            )
            outside = box.x0 < frame.x0 or box.x1 > frame.x1 or box.y0 < frame.y0 or box.y1 > frame.y1
            tried.append((covered + outside * box.width * box.height, len(tried), written, box))
            if not covered and not outside:
                break
        _, best, written, box = min(tried, key=lambda candidate: candidate[:2])
        for _, place, other, _ in tried:
            if place != best:
                other.remove()
        taken.append((box.x0, box.y0, box.x1, box.y1))


def _square(x: float, y: float, half: float) -> tuple[float, float, float, float]:
    return x - half, y - half, x + half, y + half


@needs({
    "ladder": [{"method": str, "error": NUMBER, "fos": NUMBER, "effort": NUMBER, "node_pairs": NUMBER}],
    "timing_s": {"ladder": [{"seconds": float}]},
    "reference": {"value": NUMBER, "what": str}, "agree_within": NUMBER, "fos": FOS, "status": str,
})  # fmt: skip
def draw_speed_errors(figure: Any, document: Document) -> None:
    """Time against error of the ladder of a check.

    Raises
    ------
    DesignError
        E273 where the design has no factor of safety.
    """
    reference, against = document["reference"]["value"], document["reference"]["what"]
    if reference is None:
        nothing("the design has no factor of safety")
    own = None if against == "the closed form" else reference  # a rung against itself has no error
    if len(document["ladder"]) != len(document["timing_s"]["ladder"]):
        raise Damaged("has a ladder with other times")
    rungs = list(zip(document["ladder"], document["timing_s"]["ladder"], strict=True))
    curves = []
    for method, name in METHODS.items():
        drawn = [
            (rung, time["seconds"]) for rung, time in rungs
            if rung["method"] == method and rung["error"] is not None
            and not (rung["error"] == 0.0 and rung["fos"] == own)
        ]  # fmt: skip
        if drawn:
            rows = [(seconds, rung["error"], _label(rung)) for rung, seconds in drawn]
            at, errors, labels = zip(*rows, strict=True)
            curves.append(Curve(name, at, errors, labels))
    title = f"{short(document['title'] or document['kind'])}: {document['status']}, limit "
    title += factor_text(document["fos"]["limit"]).strip()
    draw_speed_error(figure, curves, title, wanted=document["agree_within"], against=against)


def _label(rung: Document) -> str:
    return f"{rung['node_pairs']}" if rung["method"] == "mesh" else ""


def _failed(steps: Sequence[Document]) -> tuple[list[float], list[float]]:
    """Factors, and how many node pairs failed at them."""
    return [step["factor"] for step in steps], [step["failed_pairs"] for step in steps]


@needs({
    "series": ([{
        "factor": float, "stands": bool, "failed_pairs": float, "displacement_m": ([float], None),
    }], None),
    "all_pairs": ({"history": ([{"factor": float, "failed_pairs": float}], None)}, None),
    "fos": FOS, "model": {"node_pairs": float},
})  # fmt: skip
def draw_reduction(figure: Any, document: Document) -> None:
    """Displacement (left) and failed node pairs (right) against the strength reduction factor; the limit upright.

    Raises
    ------
    DesignError
        E273 where no factor was looked at.
    """
    series, searched = document.get("series") or [], (document.get("all_pairs") or {}).get("history") or []
    if not series and not searched:
        nothing("no strength reduction factor was looked at")
    from matplotlib.ticker import MaxNLocator

    every = document["model"]["node_pairs"]
    axes = figure.subplots()
    right = axes.twinx()
    moved = [(step["factor"], _size(step["displacement_m"])) for step in series if step["displacement_m"]]
    if moved:
        in_mm = max(size for _, size in moved) < 1.0
        axes.plot([at for at, _ in moved], [size * (1e3 if in_mm else 1.0) for _, size in moved], color=BLUE,
                  marker="o", linewidth=1.5, label="displacement of the centroid", zorder=3)  # fmt: skip
        axes.set_ylabel(f"displacement of the centroid, {'mm' if in_mm else 'm'}", color=BLUE)
        axes.set_ylim(bottom=0.0)
        axes.margins(y=0.12)
    else:
        axes.set_yticks([])
    if searched:
        right.plot(*_failed(searched), color=DARK, marker=".", markersize=8, linewidth=1.1, linestyle=":",
                   label="failed node pairs, all-pairs search")  # fmt: skip
    stands = [step for step in series if step["stands"]]
    falls = [step for step in series if not step["stands"]]
    if stands:
        right.plot(*_failed(stands), color=RED, marker="s", linewidth=1.5, linestyle="--", label="failed node pairs")
    if falls:
        right.plot(*_failed(falls), color=RED, marker="x", markersize=8, markeredgewidth=1.8, linestyle="none",
                   label="no longer stands: all count as failed")  # fmt: skip
    right.axhline(every, color=GREY, linestyle=":", linewidth=1.0)
    right.set_ylim(0.0, 1.12 * every)
    right.set_ylabel(f"failed node pairs, of {every}", color=RED if series else DARK)
    right.set_yticks([tick for tick in MaxNLocator(integer=True).tick_values(0, every) if 0 <= tick <= every])
    _upright(axes, document)
    axes.set_xlabel("strength reduction factor")
    finish(figure, axes, title_of(document))


def _upright(axes: Any, document: Document) -> None:
    """The limit and the factor at which all pairs fail; the label of the smaller at the left of its line."""
    fos = document["fos"]
    lines = [("limit", fos["limit"], "-"), ("all pairs failed", fos["all_pairs_failed"], "-.")]
    known = sorted((line for line in lines if line[1] is not None), key=lambda line: float(line[1]))
    for k, (name, value, style) in enumerate(known):
        left = k == 0
        axes.axvline(value, color=DARK, linestyle=style, linewidth=1.3)
        note(axes, f"{name} {value:.4g}", (value, 0.04), (-4 if left else 4, 0), xycoords=("data", "axes fraction"),
             rotation=90, va="bottom", ha="right" if left else "left", fontsize=8.5, color=DARK)  # fmt: skip


def _size(vector: Any) -> float:
    return math.sqrt(sum(part * part for part in vector))
