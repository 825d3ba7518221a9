"""What stereonets are drawn with: rim, circles, cones, zones, points. Needs the extra `plot`."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.orientation import Plane
from slopekit.views.drawing import BLUE, DARK, GREEN, GREY, ORANGE, PURPLE, RED, SKY
from slopekit.views.stereonet import Net, daylight_envelope, great_circle, project, small_circle, unproject

UP = np.array([0.0, 0.0, -1.0])  # the vertical, as a downward line: the middle of the net
FACE, SHADE, LIGHT = "#7a4a1e", "#f2b48a", "#f8ddc8"
SETS = (BLUE, GREEN, PURPLE, ORANGE, SKY, "#8c6d1f", "#5b5b9e", "#3d3d3d")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "p")
_LINES = 3.6  # order: above lines and poles that are many, below those that are marked
_CELLS = 450  # of a zone, from rim to rim
_NET, _TITLE, _HEAD, _ENTRY = 6.6, 0.35, 0.195, 0.185  # inches: a net, its title, a line above all, one of the legend
_SPARE = 0.1  # inches of a net above its N that a title may use
_DOTS = 350  # of points that stand so close that they cover each other


def start(axes: Any, title: str) -> None:
    """The empty net: rim, ticks every ten degrees, north."""
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    axes.plot(np.sin(turn), np.cos(turn), color="black", linewidth=1.2, zorder=5)
    for degrees in range(0, 360, 10):
        x, y = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        out = 1.03 if degrees % 90 == 0 else 1.018
        axes.plot([x, out * x], [y, out * y], color="black", linewidth=0.9, zorder=5)
    for x, y, text in ((0.0, 1.0, "N"), (1.0, 0.0, "E"), (0.0, -1.0, "S"), (-1.0, 0.0, "W")):
        axes.annotate(text, (1.085 * x, 1.085 * y), ha="center", va="center", fontsize=10)
    axes.plot([0.0], [0.0], marker="+", color="black", markersize=7, zorder=5)
    axes.set_aspect("equal")
    axes.set_xlim(-1.14, 1.14)
    axes.set_ylim(-1.14, 1.14)
    axes.axis("off")
    axes.set_title(title, fontsize=10.5, pad=0.0)


def arc(axes: Any, vectors: Floats, net: Net, **style: Any) -> None:
    """A curve through downward vectors (n, 3)."""
    axes.plot(*project(vectors, net).T, **{"zorder": _LINES} | style)


def plane_circle(axes: Any, plane: Plane, net: Net, **style: Any) -> None:
    """The great circle of a plane."""
    arc(axes, great_circle(plane), net, **style)


def cone_circle(axes: Any, axis: Floats, angle_deg: float, net: Net, **style: Any) -> None:
    """The small circle of a cone about a downward axis; one entry in the legend."""
    label = style.pop("label", None)
    for k, part in enumerate(small_circle(axis, angle_deg)):
        arc(axes, part, net, label=label if k == 0 else None, **style)


def steeper_than(axes: Any, plunge_deg: float, net: Net, **style: Any) -> None:
    """The circle of the lines of one plunge: what lies within is steeper."""
    cone_circle(axes, UP, 90.0 - plunge_deg, net, **style)


def envelope(axes: Any, face: Plane, net: Net, **style: Any) -> None:
    """The daylight envelope of a face, for poles."""
    arc(axes, daylight_envelope(face), net, **style)


def spokes(axes: Any, trend_deg: float, within_deg: float, **style: Any) -> None:
    """Lateral limits on both sides of a trend, from the middle to the rim; none at 90° and more."""
    label = style.pop("label", None)
    if within_deg >= 90.0:
        return
    for k, off in enumerate((-within_deg, within_deg)):
        toward = math.radians(trend_deg + off)
        axes.plot([0.0, math.sin(toward)], [0.0, math.cos(toward)], label=label if k == 0 else None,
                  **{"zorder": _LINES} | style)  # fmt: skip


def points(axes: Any, vectors: Floats, net: Net, **style: Any) -> None:
    """Lines (n, 3) as points; where many stand so close that they cover each other, one for all of them."""
    if not len(vectors):
        return
    at = project(vectors, net)
    if len(at) > 2000:
        cell = np.round(at * _DOTS).astype(np.int64) @ np.array([4 * _DOTS, 1])
        at = at[np.unique(cell, return_index=True)[1]]
    axes.plot(*at.T, linestyle="none", **style)


@lru_cache(maxsize=4)
def cells(net: Net) -> tuple[Floats, Bools]:
    """Downward vectors of the middles of the cells within the rim, and which cells those are (rows from south)."""
    middle = (np.arange(_CELLS) + 0.5) / _CELLS * 2.0 - 1.0
    x, y = np.meshgrid(middle, middle)
    inside = x * x + y * y < 1.0
    return unproject(np.column_stack([x[inside], y[inside]]), net), inside


def shade(axes: Any, zone: Bools, net: Net, colour: str, label: str) -> None:
    """A zone, given for each cell within the rim, as a coloured area."""
    from matplotlib.colors import to_rgba

    if not zone.any():
        return
    inside = cells(net)[1]
    image = np.zeros((*inside.shape, 4))
    image[..., :] = (*to_rgba(colour)[:3], 0.0)
    found = np.zeros(inside.shape, dtype=bool)
    found[inside] = zone
    image[found, 3] = 1.0
    axes.imshow(image, extent=(-1.0, 1.0, -1.0, 1.0), origin="lower", interpolation="nearest", zorder=0.5)
    axes.fill([], [], color=colour, linewidth=0.0, label=label)
    axes.set_xlim(-1.14, 1.14)
    axes.set_ylim(-1.14, 1.14)


def arrange(figure: Any, panels: Sequence[Any], across: int, title: str) -> None:
    """Give the nets (in rows of `across`) and their legends the room that they take, and the figure its size."""
    figure.set_layout_engine(None)
    entries = [len(axes.get_legend_handles_labels()[1]) for axes in panels]
    rows = [max(entries[k : k + across]) for k in range(0, len(panels), across)]
    above = _TITLE if any(axes.get_title() for axes in panels) else 0.0
    heights = [above + _NET - _SPARE + 0.2 + _ENTRY * ((most + 1) // 2) for most in rows]
    head = 0.12 + _HEAD * (1 + title.count("\n"))
    width, height = across * _NET, head + sum(heights)
    figure.set_size_inches(width, height)
    figure.text(0.5, 1.0 - 0.12 / height, title, ha="center", va="top", fontsize=11)
    top = height - head
    for k, axes in enumerate(panels):
        row, column = divmod(k, across)
        bottom = top - sum(heights[:row]) - above + _SPARE - _NET
        axes.set_position((column / across, bottom / height, 1.0 / across, _NET / height))
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.01), ncols=2, fontsize=8, frameon=False,
                    handlelength=2.2, columnspacing=1.4)  # fmt: skip


def set_marks(names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each set; what has no set, or comes after the eighth, is grey."""
    found = {name: (SETS[k], MARKERS[k]) for k, name in enumerate(names[: len(SETS)])}
    return dict.fromkeys(names, (GREY, "o")) | found | {"": (GREY, "o")}


__all__ = [
    "BLUE", "DARK", "FACE", "GREEN", "GREY", "LIGHT", "ORANGE", "PURPLE", "RED", "SHADE", "UP", "arc", "arrange",
    "cells", "cone_circle", "envelope", "plane_circle", "points", "set_marks", "shade", "spokes", "start",
    "steeper_than",
]  # fmt: skip
