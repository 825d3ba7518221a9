"""The face as one stands before it, to scale, with the bolts by their numbers: elevations are true."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, Ints, cross
from slopekit.core.orientation import line_of, millimetre
from slopekit.kinds.sheets.bolts import (
    FILE,
    ScheduledBolt,
    forces_in_words,
    per_slice,
    schedule,
    without_head,
)
from slopekit.views.charts.drawing import (
    BOX,
    finish,
    place_label,
    refuse_empty_chart,
    short,
    title_of,
)
from slopekit.views.solid.layers import ACTIVE_BOLT, PASSIVE_BOLT
from slopekit.views.solid.rendering import Camera, pixels_of, shade
from slopekit.views.solid.scene_parts import Scenery
from slopekit.views.solid.stage import Stage

_ROW_TOLERANCE = 2e-3  # of the height of the face: heads this near in elevation are one row
_MOST_BOLTS_OVERVIEW = (
    60  # bolts: more than that are looked at from nearer, for their numbers' sake
)
_LABEL_OFFSETS = (
    (0, 8),
    (10, 0),
    (0, -8),
    (-10, 0),
)  # points: where the number of a head may stand
_MARKS = (("active", ACTIVE_BOLT, "o"), ("passive", PASSIVE_BOLT, "s"))


def draw_elevation(figure: Any, document: Any) -> None:
    """The scene from before the face with the heads of the bolts; numbers where there is room.

    Raises
    ------
    DesignError
        E140 where pyvista is not installed, E273 where no bolt has a head, E350 without a scene.
    """
    stage, listed = Stage.from_document(document), schedule(document)
    bolts = stage.scene.bolts
    if bolts is None:
        refuse_empty_chart(without_head(listed) or "the design has no bolts")
    scenery, right = Scenery(stage), cross(np.array([0.0, 0.0, 1.0]), stage.outward)
    scenery.rock()
    scenery.legend += scenery.block_legend(bool(scenery.layers))
    scenery.blocks("blocks", stage.free)
    picture = replace(scenery.picture("elevation"), eye=stage.outward)
    points = np.concatenate(
        [stage.scene.shapes.solids.vertices, bolts.heads_m]
    )  # without the rock about them
    zero, is_closeup = points[np.argmin(points @ right)], len(bolts) > _MOST_BOLTS_OVERVIEW
    camera = Camera.about(bolts.heads_m if is_closeup else points, stage.outward)

    def projected(points_m: Floats) -> Floats:
        return np.stack([(points_m - zero) @ right, points_m[..., 2]], axis=-1)

    axes, heads, middle = figure.subplots(), projected(bolts.heads_m), projected(camera.middle)
    wide, high = camera.half
    extent = (middle[0] - wide, middle[0] + wide, middle[1] - high, middle[1] + high)
    axes.imshow(pixels_of(picture, camera), extent=extent, zorder=1)
    for acts, colour, mark in _MARKS:
        is_of_type = bolts.passive == (acts == "passive")
        if is_of_type.any():
            chosen = [listed[number - 1] for number in bolts.number[is_of_type].tolist()]
            axes.scatter(
                *heads[is_of_type].T,
                s=12 if is_closeup else 26,
                marker=mark,
                color=shade(colour),
                edgecolors="white",
                zorder=5,
                label=_bolts_summary(chosen, acts),
            )
    from_where = f"0 is at E {millimetre(float(zero[0]))}, N {millimetre(float(zero[1]))}"
    axes.set(
        xlabel=f"along the face toward {line_of(right).trend_deg:03.0f} / m   ({from_where})",
        ylabel="elevation Z / m",
    )
    rows, count = _rows(heads, float(np.ptp(points[:, 2]))), len(bolts)
    levels = int(rows.max()) + 1
    head = f"face elevation: {count} bolt{'s' * (count > 1)} in {levels} row{'s' * (levels > 1)}"
    notes = [
        "the part of the face that has bolts" if is_closeup else "",
        per_slice(listed),
        without_head(listed),
    ]
    for name, colour, _ in scenery.legend:
        axes.fill([], [], facecolor=shade(colour), edgecolor="black", label=short(name))
    finish(
        figure,
        axes,
        "\n".join([title_of(document), head, *(message for message in notes if message)]),
        2,
    )
    figure.draw_without_rendering()  # the layout settles where heads come to lie
    label_boxes, style = (
        list[Any](),
        {"fontsize": 6 if is_closeup else 8, "zorder": 6, "gid": "number"},
    )
    for k in np.lexsort((heads[:, 0], rows)).tolist():
        place_label(
            axes,
            str(bolts.number[k]),
            heads[k],
            _LABEL_OFFSETS,
            label_boxes,
            axes.transData.transform(heads),
            **style,
        )
    if len(label_boxes) < count:
        message = f"{len(label_boxes)} of {count} numbers are written: for more there is no room, {FILE} has all"
        axes.annotate(
            message,
            (1.0, 0.0),
            xycoords="axes fraction",
            xytext=(-4, 4),
            textcoords="offset points",
            ha="right",
            va="bottom",
            zorder=7,
            bbox=BOX,
        )


def _rows(heads: Floats, height: float) -> Ints:
    """The row (b,) of each head, from 0, the lowest: heads of one elevation."""
    order = np.argsort(heads[:, 1], kind="stable")
    steps = np.diff(heads[order, 1]) > _ROW_TOLERANCE * height
    rows = np.zeros(len(heads), dtype=np.int64)
    rows[order[1:]] = np.cumsum(steps)
    return rows


def _bolts_summary(bolts: Sequence[ScheduledBolt], acts: str) -> str:
    """Bolts of one sort in the legend: how many, how strong, how long, which way."""
    phrases = [
        f"{len(bolts)} {acts} bolt{'s' * (len(bolts) > 1)}: {forces_in_words([bolt.force_kn for bolt in bolts])}"
    ]
    lengths = [bolt.length_m for bolt in bolts if bolt.length_m is not None]
    if len(lengths) == len(bolts):
        low, high = f"{min(lengths):.2f}", f"{max(lengths):.2f}"
        phrases.append(f"{low} m long" if low == high else f"{low} to {high} m long")
    directions = {bolt.toward for bolt in bolts}
    phrases.append(
        f"toward {next(iter(directions))}"
        if len(directions) == 1
        else f"{len(directions)} directions"
    )
    return ", ".join(phrases)
