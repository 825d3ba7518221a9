"""Charts of one design (matplotlib): what accuracy costs.

Error against time comes from the JSON of a check, as does figure 7 of Sheng et al. (2023) from that of a run. Need the
extra `plot`.
"""

from collections.abc import Mapping
from typing import Any

from slopekit.core.sheet import factor_text
from slopekit.kinds.single_block.ladders import METHODS
from slopekit.views.charts.drawing import GREY, finish, note, nothing, short

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
