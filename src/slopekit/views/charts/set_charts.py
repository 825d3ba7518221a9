"""The stereonet of joint sets (matplotlib), from the JSON of the study: poles by set, contours, means, cones.

Needs the extra `plot`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import Line, Plane, normals
from slopekit.studies.sets.density import density
from slopekit.views.charts.drawing import RED, short
from slopekit.views.charts.stereonet import NET, Stereonet, arrange, lower, set_marks, unproject

Document = Mapping[str, Any]
_ACROSS = 121  # points of the grid that contours are drawn through
_KAMB = (2.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0)
_MANY = 600  # poles beyond which they are small
_LEAST_DEG = 0.3  # a cone that is seen


def draw_sets(figure: Any, document: Document) -> None:
    """One net with all of it."""
    rows, inputs = document["orientations"], document["inputs"]
    planes = np.array([(row["dip_deg"], row["dip_direction_deg"]) for row in rows], dtype=float).reshape(-1, 2)
    poles = -normals(planes[:, 0], planes[:, 1])
    weights = np.array([row["weight"] for row in rows], dtype=float)
    own = np.array([str(row["set"] or "") for row in rows])
    named = [str(one["set"]) for one in document["sets"]]
    on = Stereonet(figure.subplots())
    on.start("")
    _contours(on, poles, weights, float(document["survey"].get("quantity", len(rows))))
    marks, size = set_marks(named), 4.2 if len(own) <= _MANY else 2.2
    for name in [*named, ""]:
        some = poles[own == name]
        colour, marker = marks[name]
        said = short(name, 14) if name else "of no set"
        on.points(some, marker=marker, color=colour, markersize=size, markeredgecolor="white",
                  markeredgewidth=0.35, zorder=3, label=f"{said} ({len(some)})")  # fmt: skip
    for one in document["sets"]:
        _mean(on, one, marks[str(one["set"])], inputs["confidence"])
    if named:
        for style, said in (
            ("-", f"holds the true mean ({inputs['confidence']:.0%})"),
            ("--", "holds 95 % of its joints"),
        ):
            on.axes.plot([], [], color="black", linestyle=style, linewidth=1.2, label=f"cone that {said}")
    if inputs["scanline"] is not None:
        line = Line(float(inputs["scanline"]["trend_deg"]), float(inputs["scanline"]["plunge_deg"]))
        on.points(lower(line.vector()[None]), marker="*", color=RED, markersize=11, zorder=4.6,
                  label=f"scanline {line}")  # fmt: skip
    name = short(str(document["survey"]["name"]), 40)
    head = f"{name}: poles of {len(rows)} joint{'s' * (len(rows) != 1)}, {len(named)} set{'s' * (len(named) != 1)}"
    arrange(figure, [on.axes], 1, f"{head}\n(lower hemisphere, {NET}; sha {document['input_sha256'][:6]})")


def _contours(on: Stereonet, poles: Floats, weights: Floats, joints: float) -> None:
    axes, middle = on.axes, np.linspace(-1.0, 1.0, _ACROSS)
    x, y = np.meshgrid(middle, middle)
    square = x * x + y * y
    # on the rim and beyond it stands the nearest direction of the rim, so that contours reach it; the rim cuts them
    inward = np.minimum(1.0, (1.0 - 1e-9) / np.sqrt(np.maximum(square, 1e-12)))
    at = unproject(np.column_stack([(x * inward).ravel(), (y * inward).ravel()]))
    values = density(at, poles, weights, joints).reshape(x.shape)
    levels = [level for level in _KAMB if level < values.max()]
    if not levels:
        return
    from matplotlib.patches import Circle

    rim = Circle((0.0, 0.0), 1.0, transform=axes.transData)
    most = float(values.max())
    shades = axes.contourf(
        x, y, values, levels=[*levels, most], cmap="Greys", alpha=0.5, zorder=0.5, vmin=0.0, vmax=1.4 * most
    )
    lines = axes.contour(x, y, values, levels=levels, colors="#8a8a8a", linewidths=0.6, zorder=0.6)
    for drawn in (shades, lines):
        drawn.set_clip_path(rim)
    axes.plot(
        [],
        [],
        color="#8a8a8a",
        linewidth=1.0,
        label=f"{', '.join(f'{level:g}' for level in levels)} σ above uniform (Kamb)",
    )
    axes.set_xlim(-1.14, 1.14)
    axes.set_ylim(-1.14, 1.14)


def _mean(on: Stereonet, one: Mapping[str, Any], mark: tuple[str, str], confidence: float) -> None:
    """The mean pole of a set, the cone that holds the true mean, and that which holds 95 % of its joints."""
    plane = Plane(float(one["dip_deg"]), float(one["dip_direction_deg"]))
    pole, (colour, marker) = -plane.normal(), mark
    k = "" if one["k"] is None else f", K {one['k']:.3g}"
    mean = f"{plane.dip_deg:.0f}/{round(plane.dip_direction_deg) % 360:03d}{k}"
    on.points(pole[None], marker=marker, color=colour, markeredgecolor="black", markersize=10,
              markeredgewidth=1.3, zorder=4.5,
              label=f"mean {short(str(one['set']), 10)} {mean}")  # fmt: skip
    for angle, style, width in (
        (one["cone_of_mean_deg"], "-", 1.6), (one["variability_deg"].get("95%"), "--", 1.1),
    ):  # fmt: skip
        if angle is not None and _LEAST_DEG < angle < 90.0:
            on.cone_circle(pole, float(angle), color=colour, linewidth=width, linestyle=style)
