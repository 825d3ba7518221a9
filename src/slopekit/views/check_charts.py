"""Charts of a checked design (matplotlib), from its JSON: what accuracy costs, and what facets do to a curved surface.

Need the extra `plot`.
"""

from collections.abc import Mapping
from typing import Any

from slopekit.kinds.ladders import METHODS
from slopekit.views.charts import Curve, draw_speed_error
from slopekit.views.drawing import BLUE, BOX, DARK, GREY, PURPLE, RED, Damaged, dressed, nothing, short, title_of
from slopekit.views.entries import factor_text

Document = Mapping[str, Any]
_NORMALS = (
    ("facet", "fos_cohesion_kept", "facet normals, cohesion kept: facets interlock, too high", PURPLE, "^"),
    ("true", "fos", "true normals of the surface", BLUE, "o"),
    ("smoothed", "fos", "smoothed normals of the mesh", BLUE, "o"),
    ("facet", "fos", "facet normals, cohesion lost where they open", RED, "s"),
)


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
            curves.append(
                Curve(
                    name,
                    [seconds for _, seconds in drawn],
                    [rung["error"] for rung, _ in drawn],
                    [_label(rung) for rung, _ in drawn],
                )
            )
    title = f"{short(document['title'] or document['kind'])}: {document['status']}, limit "
    title += factor_text(document["fos"]["limit"]).strip()
    draw_speed_error(figure, curves, title, wanted=document["agree_within"], against=against)


def _label(rung: Document) -> str:
    if rung["method"] == "passes":
        return f"{rung['effort']:.0f}"
    if rung["method"] == "tolerance":
        return f"{rung['effort']:.0e}"
    return f"{rung['node_pairs']}" if rung["method"] == "mesh" else ""


def draw_normals(figure: Any, document: Document) -> None:
    """Factor of safety against mesh edge, by the normals that the node pairs of a curved surface are given.

    Raises
    ------
    DesignError
        E273 where no mesh gave a factor.
    """
    rungs = [rung for rung in document["normals"] if rung["fos"] is not None and rung["edge_m"]]
    if not rungs:
        nothing("no mesh of the slip surface gave a factor of safety")
    axes = figure.subplots()
    for kind, key, name, colour, marker in _NORMALS:
        own = sorted((rung["edge_m"], rung[key]) for rung in rungs
                     if rung["normals"] == kind and rung.get(key) is not None)  # fmt: skip
        if not own:
            continue
        axes.plot(*zip(*own, strict=True), color=colour, marker=marker, linewidth=1.4,
                  label=name)  # fmt: skip
        place: dict[str, Any] = {"xytext": (0, 8), "ha": "center", "va": "bottom"}
        if kind == "facet":  # beside the lines
            place = {"xytext": (8, -3), "ha": "left", "va": "top"} if key != "fos" else (
                {"xytext": (0, -8), "ha": "center", "va": "top"}
            )  # fmt: skip
        for edge, value in own:
            axes.annotate(f"{value:.4g}", (edge, value), textcoords="offset points", fontsize=8, color=colour, bbox=BOX,
                          zorder=2.5, **place)  # fmt: skip
    fos = document["fos"]
    for name, value, style in (("closed form", fos["closed_form"], "-."), ("static bound", fos["static_bound"], "--")):
        if value is not None:
            axes.axhline(value, color=DARK if name == "closed form" else GREY, linestyle=style, linewidth=1.2,
                         label=f"{name}, {value:.4g}")  # fmt: skip
    axes.set_xscale("log", base=2)
    edges = sorted({rung["edge_m"] for rung in rungs})
    apart = [edge for k, edge in enumerate(edges) if k == 0 or edge > 1.25 * edges[k - 1]]
    axes.set_xticks(apart, [f"{edge:.3g}" for edge in apart])
    axes.minorticks_off()
    axes.margins(x=0.12, y=0.12)
    axes.set_xlabel("mean edge of the triangles of the slip surface, m (coarse at the right)")
    axes.set_ylabel("factor of safety (limit, PRE-IE)")
    axes.set_title(title_of(document), fontsize=11)
    dressed(axes)
    figure.legend(fontsize=8.5, loc="outside lower center", ncols=2, frameon=False)
