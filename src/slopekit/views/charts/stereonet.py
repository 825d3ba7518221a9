"""The stereonet: lower-hemisphere projections of lines and planes, equal area (Schmidt).

Vectors are (east, north, up); the net has the radius 1, its x points east, its y north.

>>> project(np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])).tolist()
[[0.0, -1.0], [0.0, 0.0]]
"""

import math
import textwrap
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.core.orientation import Plane, number
from slopekit.views.charts.drawing import COLOURS, GREY, MARKERS, short

NET = "equal area (Schmidt)"
_TINY = 1e-15
UP = np.array([0.0, 0.0, -1.0])  # the vertical, as a downward line: the middle of the net
#: What lies on what: points that are many, lines, points that are marked, the rim.
MANY, LINES, MARKED, _RIM = 3, 4, 5, 6
_SMALL = 600  # points: beyond that they are small
FRAME = (-1.14, 1.14)  # of the net's radius: the rim with its letters
_CELLS = 450  # of a zone, from rim to rim
_DOTS = 350  # of points that stand so close that they cover each other
FACE, SHADE, LIGHT = "#7a4a1e", "#f2b48a", "#f8ddc8"
#: Inches: a net with its letters, an entry of the legend; letters of a title above a net, of a short entry.
_NET, _ENTRY = 4.9, 0.185
_WIDE, _SHORT = 62, 27


def lower(vectors: Floats) -> Floats:
    """The vectors (n, 3), those that point up turned round."""
    return np.asarray(np.where(vectors[:, 2:] > 0.0, -vectors, vectors))


def project(vectors: Floats) -> Floats:
    """Unit vectors (n, 3) as points (n, 2) of the net; upward ones stand for their opposites.

    With d the downward component the points lie at (east, north) / √(1 + d): equal area (Snyder 1987, §24).
    """
    down = lower(vectors)
    return down[:, :2] / np.sqrt(1.0 - down[:, 2])[:, None]


def unproject(points: Floats) -> Floats:
    """The downward unit vectors (n, 3) of points (n, 2) in the net: the inverse of `project`.

    >>> points = np.array([[0.3, -0.4], [0.0, 0.99]])
    >>> bool(np.allclose(project(unproject(points)), points, rtol=0, atol=1e-15))
    True
    """
    square = (points * points).sum(axis=1)
    return np.asarray(np.column_stack([points * np.sqrt(2.0 - square)[:, None], square - 1.0]))


def great_circle(plane: Plane, count: int = 181) -> Floats:
    """Vectors (count, 3) from one end of the strike down the dip to the other: evenly spaced in the plane."""
    dip, direction = math.radians(plane.dip_deg), math.radians(plane.dip_direction_deg)
    along = np.array([-math.cos(direction), math.sin(direction), 0.0])
    down = np.array(
        [math.sin(direction) * math.cos(dip), math.cos(direction) * math.cos(dip), -math.sin(dip)]
    )
    pitch = np.linspace(0.0, math.pi, count)[:, None]
    return np.asarray(np.cos(pitch) * along + np.sin(pitch) * down)


def small_circle(axis: Floats, angle_deg: float, count: int = 361) -> list[Floats]:
    """The cone about a downward axis: one or two arcs (k, 3) in the lower hemisphere, cut where they leave it.

    What the cone has above the horizon stands for the opposite directions, and is an arc of its own.
    """
    circle = cone(axis, angle_deg, np.linspace(0.0, 2.0 * math.pi, count))
    heights = circle[:, 2]
    if (heights <= _TINY).all() or (heights >= -_TINY).all():
        return [lower(circle)]
    # height = A cos t + B: it is level at ± acos(-B / A), as `cone` starts at the top
    top, bottom = float(heights[0]), float(heights[count // 2])
    middle, swing = (top + bottom) / 2.0, (top - bottom) / 2.0
    level = math.acos(min(1.0, max(-1.0, -middle / swing)))
    above = cone(axis, angle_deg, np.linspace(-level, level, count))
    below = cone(axis, angle_deg, np.linspace(level, 2.0 * math.pi - level, count))
    above[:, 2], below[:, 2] = np.maximum(above[:, 2], 0.0), np.minimum(below[:, 2], 0.0)
    return [below, -above]


def cone(axis: Floats, angle_deg: float, turns: Floats) -> Floats:
    """Vectors (n, 3) at an angle about an axis, turned by `turns` (n,) radians from its highest one."""
    up = np.array([0.0, 0.0, 1.0])
    steep = up - axis * axis[2]
    size = float(np.sqrt(steep @ steep))
    steep = steep / size if size > 1e-9 else np.array([0.0, 1.0, 0.0])
    side = np.cross(axis, steep)
    angle, turn = math.radians(angle_deg), turns[:, None]
    return np.asarray(
        math.cos(angle) * axis + math.sin(angle) * (np.cos(turn) * steep + np.sin(turn) * side)
    )


def daylight_envelope(face: Plane, count: int = 181) -> Floats:
    """Poles (count, 3), downward, of the planes whose dip vector lies in the face: within it planes daylight.

    At an angle θ from the dip direction of the face such a plane has its apparent dip: tan δ = tan β cos θ. The curve
    starts and ends at the middle of the net.
    """
    dip = math.radians(face.dip_deg)
    azimuth_offset = (
        math.pi / 2.0 * np.sin(np.linspace(-math.pi / 2.0, math.pi / 2.0, count))
    )  # dense where it leaves the middle
    apparent = np.arctan2(math.sin(dip) * np.maximum(np.cos(azimuth_offset), 0.0), math.cos(dip))
    toward = math.radians(face.dip_direction_deg) + azimuth_offset
    return -np.stack(
        [np.sin(apparent) * np.sin(toward), np.sin(apparent) * np.cos(toward), np.cos(apparent)],
        axis=-1,
    )


@cache
def cells() -> tuple[Floats, Bools]:
    """Downward vectors of the middles of the cells within the rim, and which cells those are (rows from south)."""
    middle = (np.arange(_CELLS) + 0.5) / _CELLS * 2.0 - 1.0
    x, y = np.meshgrid(middle, middle)
    inside = x * x + y * y < 1.0
    inside.setflags(write=False)
    return frozen(unproject(np.column_stack([x[inside], y[inside]]))), inside


class Stereonet:
    """A stereonet on the axes of matplotlib."""

    def __init__(self, axes: Any) -> None:
        self.axes = axes

    def start(self, title: str) -> None:
        """The empty net: rim, ticks every ten degrees, north."""
        turn = np.linspace(0.0, 2.0 * math.pi, 361)
        self.axes.plot(np.sin(turn), np.cos(turn), color="black", zorder=_RIM)
        ticks = np.radians(np.arange(0, 360, 10))
        ends = np.array([[1.0], [1.02]])
        self.axes.plot(ends * np.sin(ticks), ends * np.cos(ticks), color="black", zorder=_RIM)
        for k, text in enumerate("NESW"):
            x, y = math.sin(k * math.pi / 2.0), math.cos(k * math.pi / 2.0)
            self.axes.annotate(
                text, (1.08 * x, 1.08 * y), ha="center", va="center", fontsize="large"
            )
        self.axes.plot([0.0], [0.0], marker="+", color="black", zorder=_RIM)
        self.axes.set(aspect="equal", xlim=FRAME, ylim=FRAME)
        self.axes.axis("off")
        self.axes.set_title(title, pad=0.0)

    def arc(self, vectors: Floats, **style: Any) -> None:
        """A curve through downward vectors (n, 3)."""
        self.axes.plot(*project(vectors).T, zorder=LINES, **style)

    def cone_circle(self, axis: Floats, angle_deg: float, **style: Any) -> None:
        """The small circle of a cone about a downward axis; one entry in the legend."""
        label = style.pop("label", None)
        for k, arc_vectors in enumerate(small_circle(axis, angle_deg)):
            self.arc(arc_vectors, label=label if k == 0 else None, **style)

    def steeper_than(self, plunge_deg: float, **style: Any) -> None:
        """The circle of the lines of one plunge: what lies within is steeper."""
        self.cone_circle(UP, 90.0 - plunge_deg, **style)

    def spokes(self, trend_deg: float, within_deg: float) -> None:
        """Lateral limits on both sides of a trend, from the middle to the rim; none at 90° and more."""
        if within_deg >= 90.0:
            return
        for azimuth_offset, label in (
            (-within_deg, f"lateral limits ±{number(within_deg)}°"),
            (within_deg, None),
        ):
            toward = math.radians(trend_deg + azimuth_offset)
            self.axes.plot(
                [0.0, math.sin(toward)],
                [0.0, math.cos(toward)],
                color=GREY,
                linestyle="--",
                label=label,
                zorder=LINES,
            )

    def points(self, vectors: Floats, **style: Any) -> None:
        """Lines (n, 3) as points; where many stand so close that they cover each other, one for all of them."""
        if not len(vectors):
            return
        positions = project(vectors)
        if len(positions) > 2000:
            cell = np.round(positions * _DOTS).astype(np.int64) @ np.array([4 * _DOTS, 1])
            positions = positions[np.unique(cell, return_index=True)[1]]
        usual = {"markersize": 4 if len(positions) <= _SMALL else 2, "zorder": MANY}
        self.axes.plot(*positions.T, linestyle="none", **usual | style)

    def shade(self, zone: Bools, colour: str, label: str) -> None:
        """A zone, given for each cell within the rim, as a coloured area."""
        from matplotlib.colors import to_rgba

        if not zone.any():
            return
        inside = cells()[1]
        image = np.zeros((*inside.shape, 4))
        image[..., :3] = to_rgba(colour)[:3]
        image[inside, 3] = zone
        self.axes.imshow(
            image,
            extent=(-1.0, 1.0, -1.0, 1.0),
            origin="lower",
            interpolation="nearest",
            zorder=0.5,
        )
        self.axes.fill([], [], color=colour, linewidth=0.0, label=label)
        self.axes.set(xlim=FRAME, ylim=FRAME)


def arrange(figure: Any, panels: Sequence[Any], across: int, title: str) -> None:
    """Give the figure the size of its nets (in rows of `across`) with a legend beneath each, and its title."""
    labels = [axes.get_legend_handles_labels()[1] for axes in panels]
    columns = [2 if max(map(len, entries), default=0) <= _SHORT else 1 for entries in labels]
    lines = max(-(-len(entries) // count) for entries, count in zip(labels, columns, strict=True))
    title = "\n".join(textwrap.fill(line, across * _WIDE) for line in title.split("\n"))
    height = len(panels) // across * (_NET + _ENTRY * (lines + 1)) + _ENTRY * (
        title.count("\n") + 1
    )
    figure.set_size_inches(across * _NET, height)
    figure.suptitle(title)
    for axes, count in zip(panels, columns, strict=True):
        axes.set_anchor("N")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=count)


def poles_by_set(
    net: Stereonet, poles: Floats, sets: Sequence[str], set_names: Sequence[str]
) -> dict[str, tuple[str, str]]:
    """Draw poles (n, 3), each set with a colour and a marker of its own; these by the name of the set."""
    set_of_pole = np.array(sets)
    marks = dict.fromkeys([*set_names, ""], (GREY, "o")) | dict(
        zip(set_names, zip(COLOURS, MARKERS, strict=True), strict=False)
    )
    for name in (*set_names, ""):
        set_poles, (colour, marker) = poles[set_of_pole == name], marks[name]
        label = f"set {short(name, 18)}" if name else "of no set" if set_names else "poles"
        net.points(set_poles, marker=marker, color=colour, label=f"{label} ({len(set_poles)})")
    return marks
