"""What reducing the strength does to a block (matplotlib), from its JSON: figure 7 of Sheng et al. (2023).

Needs the extra `plot`.
"""

import math
from collections.abc import Mapping
from typing import Any

from slopekit.views.drawing import BLUE, BOX, DARK, GREY, RED, dressed, nothing, title_of

Document = Mapping[str, Any]


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
        right.plot(
            [step["factor"] for step in searched],
            [step["failed_pairs"] for step in searched],
            color=DARK,
            marker=".",
            markersize=8,
            linewidth=1.1,
            linestyle=":",
            label="failed node pairs, all-pairs search",
        )
    stands = [step for step in series if step["stands"]]
    falls = [step for step in series if not step["stands"]]
    if stands:
        right.plot([step["factor"] for step in stands], [step["failed_pairs"] for step in stands], color=RED,
                   marker="s", linewidth=1.5, linestyle="--", label="failed node pairs")  # fmt: skip
    if falls:
        right.plot(
            [step["factor"] for step in falls],
            [step["failed_pairs"] for step in falls],
            color=RED,
            marker="x",
            markersize=8,
            markeredgewidth=1.8,
            linestyle="none",
            label="no longer stands: all count as failed",
        )
    right.axhline(every, color=GREY, linestyle=":", linewidth=1.0)
    right.set_ylim(0.0, 1.12 * every)
    right.set_ylabel(f"failed node pairs, of {every}", color=RED if series else DARK)
    right.set_yticks([tick for tick in MaxNLocator(integer=True).tick_values(0, every) if 0 <= tick <= every])
    _upright(axes, document)
    axes.set_xlabel("strength reduction factor")
    axes.set_title(title_of(document), fontsize=11)
    dressed(axes)
    figure.legend(fontsize=8.5, loc="outside lower center", ncols=3, frameon=False)


def _upright(axes: Any, document: Document) -> None:
    """The limit and the factor at which all pairs fail; the label of the smaller at the left of its line."""
    fos = document["fos"]
    lines = [("limit", fos["limit"], "-"), ("all pairs failed", fos["all_pairs_failed"], "-.")]
    known = sorted((line for line in lines if line[1] is not None), key=lambda line: float(line[1]))
    for k, (name, value, style) in enumerate(known):
        left = k == 0
        axes.axvline(value, color=DARK, linestyle=style, linewidth=1.3)
        axes.annotate(f"{name} {value:.4g}", (value, 0.04), xytext=(-4 if left else 4, 0), rotation=90,
                      xycoords=("data", "axes fraction"), textcoords="offset points", va="bottom",
                      ha="right" if left else "left", fontsize=8.5, color=DARK, bbox=BOX)  # fmt: skip


def _size(vector: Any) -> float:
    return math.sqrt(sum(part * part for part in vector))
