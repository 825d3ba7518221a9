"""Charts of the benchmarks, written as PNG: error against time, error along a sweep of one parameter."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from slopekit.core.errors import DesignError, Fault
from slopekit.views.charts.drawing import finish, new_figure, save

#: What an error that rounds to nothing is drawn as: the bottom of the chart, with an open marker.
FLOOR = 1e-16
_COLOURS = (
    "#0064a4",
    "#c8500a",
    "#007f5f",
    "#a8548a",
    "#d89000",
    "#4d4d4d",
    "#56b4e9",
    "#5b5b9e",
    "#7a6a00",
)
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<")
#: Where a label may stand beside its point, in points, best first.
_BESIDE = (
    (7, 4),
    (7, -11),
    (-7, 4),
    (-7, -11),
    (0, 9),
    (0, -16),
    (12, 14),
    (-12, 14),
    (12, -22),
    (-12, -22),
)
#: A line of the legend, in letters of its size: all of it, and what marker and gap take of an entry.
_LINE, _HANDLE = 125, 7
_OPEN = "open: no error to 16 digits"
_ROOM, _ALONG = (
    4.5,
    4.0,
)  # half the side of the square that a marker takes; from square to square of a line; points


@dataclass(frozen=True)
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
    figure: Any,
    curves: Sequence[Curve],
    title: str,
    *,
    wanted: float | None = None,
    against: str = "the closed form",
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
            axes.annotate(
                f"wanted: {wanted:g}",
                (0.995, wanted),
                xycoords=("axes fraction", "data"),
                ha="right",
                va="bottom",
                fontsize=8,
                color="#555555",
            )

    check_curves(curves, "")
    draw_chart(figure, curves, title, dress)


def check_curves(curves: Sequence[Curve], path: Path | str, logarithmic: bool = True) -> None:
    """Raise E273 where no curve has a point that can be drawn."""
    points = [point for curve in curves for point in zip(curve.at, curve.errors, strict=True)]
    if not any(math.isfinite(x + error) and (x > 0.0 or not logarithmic) for x, error in points):
        message = "there is nothing to draw: no curve has a point"
        raise DesignError(
            [Fault("E273", message, str(path), "Give at least one curve with one point.")]
        )


def draw_chart(
    figure: Any,
    curves: Sequence[Curve],
    title: str,
    dress: Callable[[Any], None],
    *,
    logarithmic: bool = True,
    sizes: tuple[float, float] = (6.5, 6.5),
    crosses: str = "",
) -> None:
    """Draw; `sizes` of the first and the last marker: where they grow the first lie on top, and none is hidden."""
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    names = list(dict.fromkeys(curve.name for curve in curves if len(curve.at)))
    first, last = sizes
    size_of = [
        first + min(1.5, (last - first) / max(1, len(names) - 1)) * k for k in range(len(names))
    ]
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
            axes.plot(
                [x],
                [y],
                marker=shape,
                color=colour,
                markerfacecolor=face,
                markersize=size_of[k],
                markeredgewidth=edge,
                linestyle="none",
                zorder=above,
            )
        labels += [
            (x, y, text, colour)
            for x, y, text in zip(curve.at, drawn, curve.labels, strict=False)
            if text
        ]
    for k, name in enumerate(names):
        style = (
            "-"
            if any(curve.joined and len(curve.at) > 1 for curve in curves if curve.name == name)
            else "none"
        )
        colour, marker = _COLOURS[k % len(_COLOURS)], _MARKERS[k % len(_MARKERS)]
        axes.plot(
            [], [], color=colour, marker=marker, markersize=size_of[k], linestyle=style, label=name
        )
    entries = list(names)
    if crosses and any(any(curve.crossed) for curve in curves):
        axes.plot(
            [],
            [],
            color="#4d4d4d",
            marker="x",
            markeredgewidth=1.5,
            linestyle="none",
            label=crosses,
        )
        entries.append(crosses)
    bare = any(abs(error) <= FLOOR for curve in curves for error in curve.errors)
    if bare:
        axes.plot(
            [],
            [],
            color="#4d4d4d",
            marker="o",
            markerfacecolor="white",
            linestyle="none",
            label=_OPEN,
        )
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
        drawn = [
            (x, max(abs(error), FLOOR)) for x, error in zip(curve.at, curve.errors, strict=True)
        ]
        at = [tuple(point) for point in axes.transData.transform(drawn)] if drawn else []
        taken += [_square(x, y, _ROOM * dots) for x, y in at]
        for (x, y), (u, v) in pairwise(at):
            steps = 1 + int(max(abs(u - x), abs(v - y)) / (_ALONG * dots)) if curve.joined else 1
            taken += [
                _square(x + (u - x) * k / steps, y + (v - y) * k / steps, dots)
                for k in range(1, steps)
            ]
    frame = axes.get_window_extent(renderer)
    for x, y, text, colour in labels:
        tried: list[tuple[float, int, Any, Any]] = []
        for dx, dy in _BESIDE:
            written = axes.annotate(
                text,
                (x, y),
                xytext=(dx, dy),
                textcoords="offset points",
                fontsize=7.5,
                color=colour,
                ha="left" if dx > 0 else "right" if dx < 0 else "center",
            )
            box = written.get_window_extent(renderer)
            covered = sum(
                max(0.0, min(box.x1, right) - max(box.x0, left))
                * max(0.0, min(box.y1, top) - max(box.y0, low))
                for left, low, right, top in taken
            )
            outside = (
                box.x0 < frame.x0 or box.x1 > frame.x1 or box.y0 < frame.y0 or box.y1 > frame.y1
            )
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


def speed_error_chart(
    curves: Sequence[Curve],
    path: Path,
    title: str,
    *,
    wanted: float | None = None,
    against: str = "the closed form",
) -> None:
    """Error against time, both logarithmic, written as a PNG; see `draw_speed_error`."""
    check_curves(curves, path)
    with new_figure(path) as figure:
        draw_speed_error(figure, curves, title, wanted=wanted, against=against)
        save(figure, path)


def sweep_chart(
    curves: Sequence[Curve],
    path: Path,
    title: str,
    label: str,
    *,
    tolerance: float | None = None,
    logarithmic: bool = True,
    jumps: Sequence[tuple[float, str]] = (),
    errors: str = "of the factor of safety",
    tolerances: Sequence[tuple[float, str]] = (),
    crosses: str = "",
) -> None:
    """Error along a sweep of one parameter, written as a PNG.

    Parameters
    ----------
    label : the parameter with its unit
    tolerance : drawn as a line
    logarithmic : of the parameter; the error always is
    jumps : (where, what) of places where the answer jumps, drawn as upright lines
    errors : what the errors are relative errors of
    tolerances : (tolerance, for what) where there is more than one
    crosses : what a cross means, for the legend

    Raises
    ------
    DesignError
        E140 where matplotlib is not installed, E273 without a point to draw.
    """
    lines = [*tolerances, *([] if tolerance is None else [(tolerance, "")])]

    def dress(axes: Any) -> None:
        axes.set_xlabel(label)
        axes.set_ylabel(f"relative error {errors}")
        if not logarithmic:
            axes.set_xscale("linear")
        for size, of in lines:
            axes.axhline(size, color="#888888", linestyle="--", linewidth=1.0)
            text = f"tolerance {in_short(size)}" + (f": {of}" if of else "")
            axes.annotate(
                text,
                (0.995, size),
                xycoords=("axes fraction", "data"),
                ha="right",
                va="bottom",
                fontsize=8,
                color="#555555",
                zorder=1.9,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
            )
        top, kind = (
            (min(size for size, _ in lines) / 2.0, "data") if lines else (0.97, "axes fraction")
        )
        for where, what in jumps:  # beneath the lines and their labels
            axes.axvline(where, color="#c0392b", linestyle=":", linewidth=1.2)
            axes.annotate(
                what,
                (where, top),
                xytext=(-3, 0),
                xycoords=("data", kind),
                textcoords="offset points",
                rotation=90,
                ha="right",
                va="top",
                fontsize=8,
                color="#c0392b",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
            )

    check_curves(curves, path, logarithmic)
    with new_figure(path) as figure:
        draw_chart(
            figure, curves, title, dress, logarithmic=logarithmic, sizes=(5.0, 9.5), crosses=crosses
        )
        save(figure, path)


def in_short(size: float) -> str:
    """A power of ten as people write it: 1e-9, 2e-6, 0.0005."""
    return f"{size:g}".replace("e-0", "e-").replace("e+0", "e")
