"""The face as one stands before it, to scale, with the bolts by their numbers: elevations are true."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.core.orientation import millimetre, parse_plane
from slopekit.kinds.sheets.bolts import (
    FILE,
    ScheduledBolt,
    forces_in_words,
    per_slice,
    schedule,
    without_head,
)
from slopekit.views.charts.drawing import DARK, finish, nothing, short, title_of
from slopekit.views.solid.layers import (
    ACTIVE_BOLT,
    BLOCK,
    PASSIVE_BOLT,
    ROCK,
    STANDS,
    Colour,
    free_triangles,
)
from slopekit.views.solid.stage import Stage

_FLAT = 1e-6  # of a cosine, and of the size: triangles in one plane
_ROW = 2e-3  # of the height of the face: heads this near in elevation are one row
_EDGE_ON = 0.02  # of a unit normal: a face turned farther aside is seen edge-on
_MANY = 60  # bolts: more than that are looked at from nearer, for their numbers' sake
_SLENDER = 0.6  # of its height: the least width that is shown
_FAINT = 0.55  # what the upper slope keeps of its colour
_MARKS = (("active", ACTIVE_BOLT, "o"), ("passive", PASSIVE_BOLT, "s"))


@dataclass(frozen=True)
class _FlatPiece:
    """A flat piece of the surface: triangles (t, 3, 3) m, its outline as lines (e, 2, 3), its colour; 1: in full."""

    triangles: Floats
    outline: Floats
    colour: Colour
    share: float = 1.0


def draw_elevation(figure: Any, document: Any) -> None:
    """The face with the heads of the bolts; numbers where there is room.

    Raises
    ------
    DesignError
        E273 where no bolt has a head, E350 without a scene.
    """
    stage, listed = Stage.of(document), schedule(document)
    bolts = stage.scene.bolts
    if bolts is None:
        nothing(without_head(listed) or "the design has no bolts")
    right = cross(np.array([0.0, 0.0, 1.0]), stage.out)
    faces = list(_faces(stage))
    points = np.concatenate([*(face.triangles.reshape(-1, 3) for face in faces), bolts.heads_m])
    zero = points[np.argmin(points @ right)]

    def flat(places: Floats) -> Floats:
        return np.stack([(places - zero) @ right, places[..., 2]], axis=-1)

    axes = figure.subplots()
    _fill(axes, faces, [flat(face.triangles) for face in faces], [flat(face.outline) for face in faces])
    heads = flat(bolts.heads_m)
    rows = _rows(heads, float(np.ptp(points[:, 2])))
    closer = len(bolts) > _MANY
    for acts, colour, mark in _MARKS:
        own = bolts.passive == (acts == "passive")
        if own.any():
            chosen = [listed[number - 1] for number in bolts.number[own].tolist()]
            axes.scatter(*heads[own].T, s=12.0 if closer else 26.0, marker=mark, color=_rgb(colour),
                         edgecolors="white", linewidths=0.5, zorder=5, label=_in_words(chosen, acts))  # fmt: skip
    bearing = math.degrees(math.atan2(float(right[0]), float(right[1]))) % 360.0
    _frame(axes, heads if closer else flat(points))
    axes.set_xlabel(f"along the face toward {bearing:03.0f} / m   (0 is at E {millimetre(float(zero[0]))}, "
                    f"N {millimetre(float(zero[1]))})")  # fmt: skip
    axes.set_ylabel("elevation Z / m")
    count, levels = len(bolts), int(rows.max()) + 1
    head = f"face elevation: {count} bolt{'s' * (count > 1)} in {levels} row{'s' * (levels > 1)}"
    notes = ["the part of the face that has bolts" if closer else "", per_slice(listed), without_head(listed)]
    for name, colour in _blocks(stage, faces):
        axes.fill([], [], facecolor=_rgb(colour), edgecolor=DARK, linewidth=0.6, label=short(name))
    finish(figure, axes, "\n".join([title_of(document), head, *(said for said in notes if said)]), 2, 10.5)
    left = _number(figure, axes, heads, bolts.number, np.lexsort((heads[:, 0], rows)).tolist())
    if left:
        said = f"{count - left} of {count} numbers are written: for more there is no room, {FILE} has all"
        axes.annotate(said, (1.0, 0.0), xycoords="axes fraction", xytext=(-4, 4), textcoords="offset points",
                      ha="right", va="bottom", fontsize=7.5, color=DARK, zorder=7,
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.0})  # fmt: skip


# -- the face ---------------------------------------------------------------------------------------------------------


def _faces(stage: Stage) -> Iterator[_FlatPiece]:
    """What is seen of the surface from before the slope, the farthest first."""
    shapes = stage.scene.shapes
    solids = shapes.solids
    corners = solids.vertices[solids.triangles]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.sqrt((normals * normals).sum(axis=1))
    normals = normals / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    free = (free_triangles(shapes) if stage.alone else np.ones(len(sizes), dtype=bool)) & (sizes > 0.0)
    toward: Bools = free & (normals @ stage.out > _EDGE_ON)
    inputs = stage.document.get("inputs") or {}
    size = float(np.ptp(solids.vertices, axis=0).max())
    found = False
    for key, share in (("upper", _FAINT), ("face", 1.0)):
        if isinstance(inputs.get(key), str):
            outward = parse_plane(inputs[key], key).normal()
            along = toward & (normals @ outward > 1.0 - _FLAT)
            far = (corners.mean(axis=1) - solids.vertices.mean(axis=0)) @ outward
            own = along & (far > far[along].max(initial=-math.inf) - _FLAT * size)
            found = found or (key == "face" and bool(own.any()))
            yield from _pieces(stage, own, np.zeros(len(own), dtype=np.int64), share)
    if not found:
        _, kind = np.unique(normals.round(5), axis=0, return_inverse=True)
        yield from _pieces(stage, toward, kind.ravel(), 1.0)


def _pieces(stage: Stage, own: Bools, kind: Ints, share: float) -> Iterator[_FlatPiece]:
    """The triangles `own` (t,) by block and kind (t,), the farthest first."""
    shapes = stage.scene.shapes
    solids, colours = shapes.solids, stage.block_colours()
    colours[shapes.fixed] = ROCK
    chosen = np.flatnonzero(own)
    if len(chosen) == 0:
        return
    _, of = np.unique(np.stack([solids.block[chosen], kind[chosen]], axis=1), axis=0, return_inverse=True)
    of = of.ravel()
    near = np.bincount(of, solids.vertices[solids.triangles[chosen]].mean(axis=1) @ stage.out) / np.bincount(of)
    for piece in np.argsort(near, kind="stable").tolist():
        mine = chosen[of == piece]
        triangles = solids.triangles[mine]
        sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, often = np.unique(sides, axis=0, return_counts=True)
        red, green, blue = colours[solids.block[mine[0]]].tolist()
        yield _FlatPiece(
            solids.vertices[triangles], solids.vertices[edges[often == 1]], (int(red), int(green), int(blue)), share
        )


def _fill(axes: Any, faces: Sequence[_FlatPiece], triangles: Sequence[Floats], outlines: Sequence[Floats]) -> None:
    from matplotlib.collections import LineCollection, PolyCollection

    for k, (face, own, outline) in enumerate(zip(faces, triangles, outlines, strict=True)):
        colour = tuple(1.0 - face.share * (1.0 - part) for part in _rgb(face.colour))
        below = 1.0 + k / len(faces)
        axes.add_collection(PolyCollection(list(own), facecolor=colour, edgecolor=colour, linewidth=0.8, zorder=below))
        axes.add_collection(LineCollection(list(outline), colors="#6b5a48", linewidths=0.8, zorder=below))


def _frame(axes: Any, points: Floats) -> None:
    """All of it to scale, with a margin; a slender slice has room at its sides."""
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall = (float(part) for part in high - low)
    side = max(0.06 * max(wide, tall), 0.5 * (_SLENDER * tall - wide))
    axes.set_xlim(low[0] - side, high[0] + side)
    axes.set_ylim(low[1] - 0.06 * max(wide, tall), high[1] + 0.06 * max(wide, tall))
    axes.set_aspect("equal")


def _blocks(stage: Stage, faces: Sequence[_FlatPiece]) -> list[tuple[str, Colour]]:
    """What the colours mean."""
    if stage.alone:
        return [(stage.scene.shapes.names[0], BLOCK)]
    shown = {face.colour for face in faces}
    named = [("moves first", BLOCK), ("other blocks", STANDS), ("bedrock", ROCK)]
    return [(name, colour) for name, colour in named if colour in shown]


# -- the bolts --------------------------------------------------------------------------------------------------------


def _rows(heads: Floats, height: float) -> Ints:
    """The row (b,) of each head, from 0, the lowest: heads of one elevation."""
    order = np.argsort(heads[:, 1], kind="stable")
    steps = np.diff(heads[order, 1]) > _ROW * height
    rows = np.zeros(len(heads), dtype=np.int64)
    rows[order[1:]] = np.cumsum(steps)
    return rows


def _in_words(bolts: Sequence[ScheduledBolt], acts: str) -> str:
    """Bolts of one sort in the legend: how many, how strong, how long, which way."""
    parts = [f"{len(bolts)} {acts} bolt{'s' * (len(bolts) > 1)}: {forces_in_words([one.force_kn for one in bolts])}"]
    lengths = [one.length_m for one in bolts if one.length_m is not None]
    if len(lengths) == len(bolts):
        low, high = f"{min(lengths):.2f}", f"{max(lengths):.2f}"
        parts.append(f"{low} m long" if low == high else f"{low} to {high} m long")
    ways = {one.toward for one in bolts}
    parts.append(f"toward {next(iter(ways))}" if len(ways) == 1 else f"{len(ways)} directions")
    return ", ".join(parts)


def _number(figure: Any, axes: Any, heads: Floats, numbers: Ints, order: Sequence[int]) -> int:
    """Write the numbers beside their heads where they cover no other and no head; how many find no room."""
    size, mark = 8 if len(heads) <= _MANY else 6, 3 * figure.dpi / 72  # points, pixels
    figure.draw_without_rendering()  # the layout settles where heads come to lie
    places, kept = axes.transData.transform(heads), list[Any]()
    for k in order:
        for x, y in ((0, 8), (10, 0), (0, -8), (-10, 0)):
            text = axes.annotate(str(numbers[k]), heads[k], (x, y), textcoords="offset points", fontsize=size,
                                 ha="center", va="center", zorder=6, gid="number", in_layout=False)  # fmt: skip
            box = text.get_window_extent()
            is_free = not box.count_overlaps(kept) and not box.padded(mark).count_contains(places)
            if is_free and axes.bbox.containsx(box.x0) and axes.bbox.containsx(box.x1):
                kept.append(box)
                break
            text.remove()
    return len(heads) - len(kept)


def _rgb(colour: Colour) -> tuple[float, float, float]:
    red, green, blue = colour
    return red / 255.0, green / 255.0, blue / 255.0
