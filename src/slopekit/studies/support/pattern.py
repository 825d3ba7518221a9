"""Lay out bolts of equal force on the face, in rows and columns at even spacing, and find the length of each.

A head is left out only where its bolt misses the block, or comes out of the ground: elsewhere sound rock anchors it.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.core.errors import Notice
from slopekit.kinds.single_block.held_bolts import bolt_exit
from slopekit.studies.support.search import Site

MOST_BOLTS = 5000
CLOSEST_M = 0.25  # bolts that stand closer hold the same rock
_MARGIN = 0.25  # of the spacing: the least distance of a head from the edge of the face
_SPACING_RATIO, _SPACING_TRIALS = (
    0.98,
    228,
)  # of one trial spacing to the one before, and how many: down to a hundredth of the widest
_GRID_OFFSETS = np.array(
    [(a, b) for a in (0.0, 0.25, 0.5, 0.75) for b in (0.0, 0.25, 0.5, 0.75)]
)  # of the spacing
_SECTION_PLACES = 401  # points along the face of a section at which a bolt is tried
_NO_HEAD_PLACE = Notice(
    "E211",
    "no place on the face is left: bolts that way come out of a free face, anchored in nothing",
)


@dataclass(frozen=True)
class Layout:
    """The pattern of bolts on a face.

    Attributes
    ----------
    heads_m : (n, 3) in east, north, up of the design
    middle_m : their middle from the origin, or the head nearest to it where a bolt from the middle is not anchored
    sound_m : (n,) from the head to where sound rock begins, behind the last joint
    rows, columns : how many
    across_m, up_m : spacing along the rows and from row to row
    left_out : places of the grid on the face whose bolts would miss the block, or come out of the ground
    needed : bolts that the force asks for; a section's: None, its bolts stand along the slope
    """

    heads_m: Floats
    middle_m: Floats
    sound_m: Floats
    rows: int
    columns: int
    across_m: float
    up_m: float
    left_out: int
    needed: int | None

    def __len__(self) -> int:
        return len(self.heads_m)


def layout(
    site: Site, direction: Floats, force: float, capacity: float, spacing: float | None
) -> Layout | Notice:
    """Return the bolts of at most `capacity` (kN) that carry `force` along a direction, or why there are none."""
    if not float(site.inward @ direction) > 1e-6:
        return Notice(
            "E211",
            "the force points out of the face: bolts with their heads on it pull the other way",
        )
    if site.in_section:
        return _section_layout(site, direction, force, capacity, spacing)
    return _face_layout(site, direction, force, capacity, spacing)


def _layout_of_heads(
    site: Site,
    heads: Floats,
    direction: Floats,
    count: tuple[int, int],
    spacing: tuple[float, float],
    left_out: int,
    needed: int | None,
) -> Layout:
    """Return the layout of heads (n, 3), m from the origin, in rows and columns at a spacing across and up the face."""
    middle = heads.mean(axis=0)
    if not bolt_exit(site.bounds, middle[None, :], direction)[1][0]:
        middle = heads[((heads - middle) ** 2).sum(axis=1).argmin()]
    sound, _ = bolt_exit(site.bounds, heads, direction)
    return Layout(
        frozen(heads + site.origin),
        frozen(middle),
        frozen(sound),
        *count,
        *spacing,
        left_out,
        needed,
    )


def _face_layout(
    site: Site, direction: Floats, force: float, capacity: float, spacing: float | None
) -> Layout | Notice:
    needed = max(1, math.ceil(force / capacity * (1.0 - 1e-9)))
    if needed > MOST_BOLTS:
        return Notice(
            "E328",
            f"{force:.6g} kN take {needed} bolts of {capacity:.6g} kN, more than {MOST_BOLTS}: no pattern is laid",
        )
    axes = _face_axes(site)
    polygon = (site.face - centre_of(site.face)) @ axes.T
    at_spacing = partial(_head_choices, site, direction, axes, polygon)

    def layout_of_choice(chosen: _HeadChoice, spacing: float) -> Layout:
        points, left_out, _ = chosen
        columns, rows = (len(np.unique(points[:, k].round(9))) for k in range(2))
        heads = centre_of(site.face) + points @ axes
        return _layout_of_heads(
            site, heads, direction, (rows, columns), (spacing, spacing), left_out, needed
        )

    if spacing is not None:
        if float(np.ptp(polygon, axis=0).max()) / spacing > MOST_BOLTS:
            return Notice(
                "E328",
                f"a spacing of {spacing:.6g} m puts more than {MOST_BOLTS} bolts on a face of {site.area:.6g} m²",
            )
        best = max(at_spacing(spacing), key=partial(_rank, needed=needed))
        if len(best[0]) < needed:
            holds = len(best[0]) * capacity
            return Notice(
                "E328",
                f"at a spacing of {spacing:.6g} m the face holds {len(best[0])} bolts of {capacity:.6g} kN, "
                f"{holds:.6g} kN in all, and {force:.6g} kN are needed",
            )
        return layout_of_choice(best, spacing)
    widest = 2.0 * math.sqrt(site.area / needed)
    for trial_m in dict.fromkeys(
        _rounded_spacing(widest * _SPACING_RATIO**k) for k in range(_SPACING_TRIALS)
    ):
        sufficient = [choice for choice in at_spacing(trial_m) if len(choice[0]) >= needed]
        if sufficient and needed > 1 and trial_m < CLOSEST_M:
            return Notice(
                "E328",
                f"{force:.6g} kN take {needed} bolts of {capacity:.6g} kN, {trial_m:.2g} m apart: no pattern is laid "
                f"closer than {CLOSEST_M} m",
            )
        if sufficient:
            return layout_of_choice(max(sufficient, key=partial(_rank, needed=needed)), trial_m)
    return _NO_HEAD_PLACE


def _rounded_spacing(spacing: float) -> float:
    """Return a spacing as it is set out, rounded down to 0.1 m from 0.3 m on."""
    return math.floor(spacing * 10.0 + 1e-9) / 10.0 if spacing >= 0.3 else spacing


#: Heads (n, 2) in the axes of the face, the number of places left out, the distance of their mean from its middle.
_HeadChoice: TypeAlias = tuple[Floats, int, float]


def _rank(chosen: _HeadChoice, needed: int) -> tuple[int, float]:
    """Return the rank of a choice: enough heads but no more than needed first, then near the middle of the face."""
    points, _, mean_offset = chosen
    count = len(points)
    return (-count if count >= needed else count - 10 * MOST_BOLTS, -mean_offset)


def _face_axes(site: Site) -> Floats:
    """Return the axes (2, 3) of the face: along the strike, and up the dip."""
    outward = -site.inward
    across = np.cross(np.array([0.0, 0.0, 1.0]), outward)
    size = math.sqrt(float(across @ across))
    across = across / size if size > 1e-9 else np.array([1.0, 0.0, 0.0])
    return np.array([across, np.cross(outward, across)])


def _head_choices(
    site: Site, direction: Floats, axes: Floats, polygon: Floats, spacing: float
) -> list[_HeadChoice]:
    """Return the heads at a spacing within the face polygon (k, 2), for each origin of the grid."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    u, v = (
        np.arange(math.floor(low[k] / spacing) - 1, math.ceil(high[k] / spacing) + 2) * spacing
        for k in range(2)
    )
    lattice = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points = (lattice + spacing * _GRID_OFFSETS[:, None, :]).reshape(-1, 2)
    start = np.repeat(np.arange(len(_GRID_OFFSETS)), len(lattice))
    clear = _clear_of_edges(points, polygon, _MARGIN * spacing)
    points, start = points[clear], start[clear]
    _, anchored = bolt_exit(site.bounds, centre_of(site.face) + points @ axes, direction)
    choices: list[_HeadChoice] = []
    for k in range(len(_GRID_OFFSETS)):
        heads = points[anchored & (start == k)]
        mean_offset = float(np.hypot(*heads.mean(axis=0))) if len(heads) else math.inf
        choices.append((heads, int((~anchored & (start == k)).sum()), mean_offset))
    return choices


def _clear_of_edges(points: Floats, polygon: Floats, margin: float) -> Bools:
    """Return which points (n, 2) lie in a convex anticlockwise polygon, at least `margin` from its edges."""
    inside = np.ones(len(points), dtype=bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        edge = b - a
        length = math.hypot(edge[0], edge[1])
        distance = (edge[0] * (points[:, 1] - a[1]) - edge[1] * (points[:, 0] - a[0])) / max(
            length, 1e-300
        )
        inside &= distance >= margin
    return inside


def _section_layout(
    site: Site, direction: Floats, force: float, capacity: float, spacing: float | None
) -> Layout | Notice:
    """Return rows of bolts on the face of a section; `spacing` (m) is that along the slope."""
    flat = site.across(site.face)
    foot, top = flat[flat[:, 2].argmin()], flat[flat[:, 2].argmax()]
    length = math.sqrt(float((top - foot) @ (top - foot)))
    shares = np.linspace(0.0, 1.0, _SECTION_PLACES)[1:-1]
    _, anchored = bolt_exit(site.bounds, foot + shares[:, None] * (top - foot), direction)
    if not anchored.any():
        return _NO_HEAD_PLACE
    step = 1.0 / (_SECTION_PLACES - 1)
    low, high = float(shares[anchored][0]), float(shares[anchored][-1])
    reach = (high - low) * length
    if spacing is None:
        even = math.sqrt(reach * capacity / force)
        rows = max(1, math.ceil(reach / even * (1.0 - 1e-9)))
        across = _rounded_spacing(min(rows * capacity / force, reach))
    else:
        across = spacing
        rows = max(1, math.ceil(across * force / capacity * (1.0 - 1e-9)))
    if rows > MOST_BOLTS or (rows > 1 and min(across, reach / rows) < CLOSEST_M):
        return Notice(
            "E328",
            f"{force:.6g} kN/m take {rows} rows of bolts of {capacity:.6g} kN, {reach / rows:.2g} m from row to row "
            f"and one every {across:.2g} m: no pattern is laid closer than {CLOSEST_M} m",
        )
    shares = low + (np.arange(rows) + 0.5) / rows * (high - low)
    heads = foot + shares[:, None] * (top - foot)
    if not bolt_exit(site.bounds, heads, direction)[1].all():
        return Notice("E211", "bolts that way come out of a free face from some of the rows")
    left_out = (
        round((length - reach) / (reach / rows)) if reach < length * (1.0 - 3.0 * step) else 0
    )
    return _layout_of_heads(
        site, heads, direction, (rows, 1), (across, reach / rows), left_out, None
    )


def centre_of(polygon: Floats) -> Floats:
    """Return the centroid (3,) of a plane polygon (k, 3)."""
    vectors = np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0])
    sizes = vectors @ vectors.sum(axis=0)
    centre: Floats = sizes @ ((polygon[0] + polygon[1:-1] + polygon[2:]) / 3.0) / sizes.sum()
    return centre
