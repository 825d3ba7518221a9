"""Charts of the benchmarks, written as PNG: error against time, error along a sweep of one parameter."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from slopekit.views.charts.charts import Curve, check_curves, draw_chart, draw_speed_error
from slopekit.views.charts.drawing import new_figure, save


def speed_error_chart(
    curves: Sequence[Curve], path: Path, title: str, *, wanted: float | None = None, against: str = "the closed form"
) -> None:
    """Error against time, both logarithmic, written as a PNG; see `draw_speed_error`."""
    check_curves(curves, path)
    figure = new_figure(path)
    draw_speed_error(figure, curves, title, wanted=wanted, against=against)
    save(figure, path)


def sweep_chart(
    curves: Sequence[Curve], path: Path, title: str, label: str, *, tolerance: float | None = None,
    logarithmic: bool = True, jumps: Sequence[tuple[float, str]] = (), errors: str = "of the factor of safety",
    tolerances: Sequence[tuple[float, str]] = (), crosses: str = "",
) -> None:  # fmt: skip
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
                text, (0.995, size), xycoords=("axes fraction", "data"), ha="right", va="bottom", fontsize=8,
                color="#555555", zorder=1.9, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
            )  # fmt: skip
        top, kind = (min(size for size, _ in lines) / 2.0, "data") if lines else (0.97, "axes fraction")
        for where, what in jumps:  # beneath the lines and their labels
            axes.axvline(where, color="#c0392b", linestyle=":", linewidth=1.2)
            axes.annotate(
                what, (where, top), xytext=(-3, 0), xycoords=("data", kind), textcoords="offset points",
                rotation=90, ha="right", va="top", fontsize=8, color="#c0392b",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
            )  # fmt: skip

    check_curves(curves, path, logarithmic)
    figure = new_figure(path)
    draw_chart(figure, curves, title, dress, logarithmic=logarithmic, sizes=(5.0, 9.5), crosses=crosses)
    save(figure, path)


def in_short(size: float) -> str:
    """A power of ten as people write it: 1e-9, 2e-6, 0.0005."""
    return f"{size:g}".replace("e-0", "e-").replace("e+0", "e")
