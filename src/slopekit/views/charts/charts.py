"""Charts of one design (matplotlib): what accuracy costs, what reducing does.

Error against time comes from the JSON of a check, as does figure 7 of Sheng et al. (2023) from that of a run. Need the
extra `plot`.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from slopekit.core.sheet import factor_text
from slopekit.kinds.single_block.ladders import METHODS
from slopekit.views.charts.drawing import BLUE, DARK, GREY, RED, finish, note, nothing, short, title_of

#: What an error that rounds to nothing is drawn as: the bottom of the chart, with an open marker.
FLOOR = 1e-16
_COLOURS = ("#0064a4", "#c8500a", "#007f5f", "#a8548a", "#d89000", "#4d4d4d", "#56b4e9", "#5b5b9e", "#7a6a00")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<")
Document = Mapping[str, Any]


def draw_speed_errors(figure: Any, document: Document) -> None:
    """Time against error of the ladder of a check, both logarithmic, a line for each method.

    Raises
    ------
    DesignError
        E273 where the design has no factor of safety, or no rung an error.
    """
    reference, against = document["reference"]["value"], document["reference"]["what"]
    if reference is None:
        nothing("the design has no factor of safety")
    own = None if against == "the closed form" else reference  # a rung against itself has no error
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    rungs = list(zip(document["ladder"], document["timing_s"]["ladder"], strict=True))
    for (method, name), colour, marker in zip(METHODS.items(), _COLOURS, _MARKERS, strict=False):
        drawn = [
            (time["seconds"], max(abs(rung["error"]), FLOOR), rung) for rung, time in rungs
            if rung["method"] == method and rung["error"] is not None
            and not (rung["error"] == 0.0 and rung["fos"] == own)
        ]  # fmt: skip
        if not drawn:
            continue
        seconds, errors, _ = zip(*drawn, strict=True)
        axes.plot(seconds, errors, color=colour, linewidth=1.2, alpha=0.8)
        for x, y, rung in drawn:
            face = colour if y > FLOOR else "white"
            axes.plot([x], [y], marker=marker, color=colour, markerfacecolor=face, markersize=6.5, linestyle="none")
            if method == "mesh":
                note(axes, f"{rung['node_pairs']}", (x, y), (7, 4), fontsize=7.5, color=colour)
        axes.plot([], [], color=colour, marker=marker, markersize=6.5, label=name)
    if not axes.lines:
        nothing("no rung of the ladder has an error")
    axes.set_xlabel("time, s")
    axes.set_ylabel(f"relative error against {against} (open: none to 16 digits)")
    wanted = document["agree_within"]
    axes.axhline(wanted, color=GREY, linestyle="--", linewidth=1.0)
    axes.annotate(f"wanted: {wanted:g}", (0.995, wanted), xycoords=("axes fraction", "data"), ha="right", va="bottom",
                  fontsize=8, color="#555555")  # fmt: skip
    axes.margins(x=0.08, y=0.08)
    factor = factor_text(document["fos"]["limit"]).strip()
    finish(figure, axes, f"{short(document['title'] or document['kind'])}: {document['status']}, limit {factor}")


def _failed(steps: Sequence[Document]) -> tuple[list[float], list[float]]:
    """Factors, and how many node pairs failed at them."""
    return [step["factor"] for step in steps], [step["failed_pairs"] for step in steps]


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
    moved = [(step["factor"], math.hypot(*step["displacement_m"])) for step in series if step["displacement_m"]]
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
