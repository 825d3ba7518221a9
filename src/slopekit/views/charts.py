"""Charts (matplotlib, off-screen): error against time, error along a sweep. Needs the extra `plot`."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slopekit.errors import DesignError, Fault

#: What an error that rounds to nothing is drawn as: the bottom of the chart, with an open marker.
FLOOR = 1e-16
_COLOURS = ("#1f5a94", "#c0392b", "#3a8f4d", "#8e5ea2", "#d08a2e", "#4d4d4d", "#2aa3a3", "#b0457b")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
_BESIDE = ((6, 5), (6, -12), (-6, 7), (-6, -14))


@dataclass(frozen=True, slots=True)
class Curve:
    """One line of a chart.

    Attributes
    ----------
    name : as the legend shows it
    at : (n,) abscissae: seconds, or the parameter of a sweep
    errors : (n,) relative errors, 0 where there is none to see
    labels : (n,) what to write beside the points, or nothing
    joined : whether a line joins the points
    """

    name: str
    at: Sequence[float]
    errors: Sequence[float]
    labels: Sequence[str] = ()
    joined: bool = True


def speed_error_chart(
    curves: Sequence[Curve], path: Path, title: str, *, wanted: float | None = None, against: str = "the closed form"
) -> None:
    """Error against time, both logarithmic, written as a PNG.

    Parameters
    ----------
    curves : `at` in seconds
    wanted : the relative error that is good enough, drawn as a line
    against : what the errors are measured against

    Raises
    ------
    DesignError
        E140 where matplotlib is not installed.
    """

    def dress(axes: Any) -> None:
        axes.set_xlabel("time, s")
        axes.set_ylabel(f"relative error against {against}")
        if wanted is not None:
            axes.axhline(wanted, color="#888888", linestyle="--", linewidth=1.0)
            axes.annotate(f"wanted: {wanted:g}", (0.995, wanted), xycoords=("axes fraction", "data"), ha="right",
                          va="bottom", fontsize=8, color="#555555")  # fmt: skip

    _chart(curves, path, title, dress)


def sweep_chart(
    curves: Sequence[Curve], path: Path, title: str, label: str, *, tolerance: float | None = None,
    logarithmic: bool = True, jumps: Sequence[tuple[float, str]] = (),
) -> None:  # fmt: skip
    """Error along a sweep of one parameter, written as a PNG.

    Parameters
    ----------
    label : the parameter with its unit
    tolerance : drawn as a line
    logarithmic : of the parameter; the error always is
    jumps : (where, what) of places where the answer jumps, drawn as upright lines

    Raises
    ------
    DesignError
        E140 where matplotlib is not installed.
    """

    def dress(axes: Any) -> None:
        axes.set_xlabel(label)
        axes.set_ylabel("relative error of the factor of safety")
        if not logarithmic:
            axes.set_xscale("linear")
        if tolerance is not None:
            axes.axhline(tolerance, color="#888888", linestyle="--", linewidth=1.0)
        for where, what in jumps:
            axes.axvline(where, color="#c0392b", linestyle=":", linewidth=1.2)
            axes.annotate(what, (where, 0.97), xycoords=("data", "axes fraction"), rotation=90, ha="right", va="top",
                          fontsize=8, color="#c0392b")  # fmt: skip

    _chart(curves, path, title, dress)


def _chart(curves: Sequence[Curve], path: Path, title: str, dress: Callable[[Any], None]) -> None:
    try:
        import matplotlib as mpl
    except ImportError:
        advice = "In slopekit's folder: pip install '.[plot]'"
        raise DesignError([Fault("E140", "drawing needs the extra plot (matplotlib)", str(path), advice)]) from None
    mpl.use("Agg")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 6.0), dpi=130, layout="constrained")
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    for k, curve in enumerate(curves):
        colour, marker = _COLOURS[k % len(_COLOURS)], _MARKERS[k % len(_MARKERS)]
        drawn = [max(abs(error), FLOOR) for error in curve.errors]
        style = "-" if curve.joined else "none"
        axes.plot(curve.at, drawn, color=colour, linestyle=style, linewidth=1.2, alpha=0.8)
        for x, error, y in zip(curve.at, curve.errors, drawn, strict=True):
            face = colour if abs(error) > FLOOR else "white"
            axes.plot([x], [y], marker=marker, color=colour, markerfacecolor=face, markersize=6.5, linestyle="none")
        for n, (x, y, text) in enumerate(zip(curve.at, drawn, curve.labels, strict=False)):
            dx, dy = _BESIDE[(k + 2 * (n % 2)) % len(_BESIDE)]
            axes.annotate(text, (x, y), xytext=(dx, dy), textcoords="offset points", fontsize=7.5, color=colour,
                          ha="left" if dx > 0 else "right")  # fmt: skip
        axes.plot([], [], color=colour, marker=marker, linestyle=style, label=curve.name)
    dress(axes)
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.set_title(title, fontsize=11)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, FLOOR / 2.0) if any(abs(e) <= FLOOR for c in curves for e in c.errors) else low, high * 2.0)
    axes.margins(x=0.08)
    axes.legend(fontsize=8.5, loc="best", framealpha=0.9)
    figure.savefig(path)
