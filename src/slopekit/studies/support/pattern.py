"""Where bolts of one force stand on the face, and how long each must be: rows and columns at even spacing.

A head is left out only where its bolt misses the block, or comes out of the ground: elsewhere sound rock holds it.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.core.errors import Notice
from slopekit.kinds.single_block.held_bolts import through
from slopekit.studies.support.search import Site

MOST_BOLTS = 5000
CLOSEST_M = 0.25  # bolts that stand closer hold the same rock
_MARGIN = 0.25  # of the spacing: the least distance of a head from the edge of the face
_FINER, _TRIES = 0.98, 228  # of the spacing, from one try to the next; down to a hundredth of the widest
_STARTS = np.array([(a, b) for a in (0.0, 0.25, 0.5, 0.75) for b in (0.0, 0.25, 0.5, 0.75)])  # of the spacing
_PLACES = 401  # along the face of a section that are looked at
_NO_PLACE = Notice(
    "E211", "no place on the face is left: bolts that way come out of a free face, anchored in nothing"
)  # fmt: skip


@dataclass(frozen=True)
class Layout:
    """Bolts on a face.

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


def layout(site: Site, direction: Floats, force: float, capacity: float, spacing: float | None) -> Layout | Notice:
    """Bolts of at most `capacity` that carry `force` along a direction, or why there are none."""
    if not float(site.inward @ direction) > 1e-6:
        return Notice("E211", "the force points out of the face: bolts with their heads on it pull the other way")
    if site.in_section:
        return _section_layout(site, direction, force, capacity, spacing)
    return _face_layout(site, direction, force, capacity, spacing)


def _laid(
    site: Site, heads: Floats, direction: Floats, count: tuple[int, int], spacing: tuple[float, float], left_out: int,
    needed: int | None,
) -> Layout:  # fmt: skip
    """Bolts with their heads (n, 3) from the origin, in rows and columns, at a spacing across and up the face."""
    middle = heads.mean(axis=0)
    if not through(site.bounds, middle[None, :], direction)[1][0]:
        middle = heads[((heads - middle) ** 2).sum(axis=1).argmin()]
    sound, _ = through(site.bounds, heads, direction)
    return Layout(frozen(heads + site.origin), frozen(middle), frozen(sound), *count, *spacing, left_out, needed)


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
    at_spacing = partial(_grids, site, direction, axes, polygon)

    def laid(chosen: _Chosen, spacing: float) -> Layout:
        points, left_out, _ = chosen
        columns, rows = (len(np.unique(points[:, k].round(9))) for k in range(2))
        heads = centre_of(site.face) + points @ axes
        return _laid(site, heads, direction, (rows, columns), (spacing, spacing), left_out, needed)

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
        return laid(best, spacing)
    widest = 2.0 * math.sqrt(site.area / needed)
    for tried in dict.fromkeys(_set_out(widest * _FINER**k) for k in range(_TRIES)):
        enough = [one for one in at_spacing(tried) if len(one[0]) >= needed]
        if enough and needed > 1 and tried < CLOSEST_M:
            return Notice(
                "E328",
                f"{force:.6g} kN take {needed} bolts of {capacity:.6g} kN, {tried:.2g} m apart: no pattern is laid "
                f"closer than {CLOSEST_M} m",
            )
        if enough:
            return laid(max(enough, key=partial(_rank, needed=needed)), tried)
    return _NO_PLACE


def _set_out(spacing: float) -> float:
    """A spacing as it is set out: down to 0.1 m, where it is that wide."""
    return math.floor(spacing * 10.0 + 1e-9) / 10.0 if spacing >= 0.3 else spacing


#: Heads (n, 2) in the axes of the face, how many places are left out, how far their mean lies from its middle.
_Chosen: TypeAlias = tuple[Floats, int, float]


def _rank(chosen: _Chosen, needed: int) -> tuple[int, float]:
    """Enough heads and no more than that, near the middle of the face."""
    points, _, off = chosen
    count = len(points)
    return (-count if count >= needed else count - 10 * MOST_BOLTS, -off)


def _face_axes(site: Site) -> Floats:
    """The axes (2, 3) of the face: along the strike, and up the dip."""
    out = -site.inward
    across = np.cross(np.array([0.0, 0.0, 1.0]), out)
    size = math.sqrt(float(across @ across))
    across = across / size if size > 1e-9 else np.array([1.0, 0.0, 0.0])
    return np.array([across, np.cross(out, across)])


def _grids(site: Site, direction: Floats, axes: Floats, polygon: Floats, spacing: float) -> list[_Chosen]:
    """Heads at a spacing within the face (k, 2), for each place where rows and columns may begin."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    u, v = (np.arange(math.floor(low[k] / spacing) - 1, math.ceil(high[k] / spacing) + 2) * spacing for k in range(2))
    lattice = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points = (lattice + spacing * _STARTS[:, None, :]).reshape(-1, 2)
    start = np.repeat(np.arange(len(_STARTS)), len(lattice))
    clear = _clear_of_edges(points, polygon, _MARGIN * spacing)
    points, start = points[clear], start[clear]
    _, anchored = through(site.bounds, centre_of(site.face) + points @ axes, direction)
    choices: list[_Chosen] = []
    for k in range(len(_STARTS)):
        kept = points[anchored & (start == k)]
        off = float(np.hypot(*kept.mean(axis=0))) if len(kept) else math.inf
        choices.append((kept, int((~anchored & (start == k)).sum()), off))
    return choices


def _clear_of_edges(points: Floats, polygon: Floats, margin: float) -> Bools:
    """Which points (n, 2) lie in a convex polygon, anticlockwise, and at least so far from its edges."""
    inside = np.ones(len(points), dtype=bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        edge = b - a
        length = math.hypot(edge[0], edge[1])
        away = (edge[0] * (points[:, 1] - a[1]) - edge[1] * (points[:, 0] - a[0])) / max(length, 1e-300)
        inside &= away >= margin
    return inside


def _section_layout(
    site: Site, direction: Floats, force: float, capacity: float, spacing: float | None
) -> Layout | Notice:
    """Rows on the face of a section; `spacing` is that along the slope, else it is that from row to row."""
    flat = site.across(site.face)
    foot, top = flat[flat[:, 2].argmin()], flat[flat[:, 2].argmax()]
    length = math.sqrt(float((top - foot) @ (top - foot)))
    shares = np.linspace(0.0, 1.0, _PLACES)[1:-1]
    _, anchored = through(site.bounds, foot + shares[:, None] * (top - foot), direction)
    if not anchored.any():
        return _NO_PLACE
    step = 1.0 / (_PLACES - 1)
    low, high = float(shares[anchored][0]), float(shares[anchored][-1])
    reach = (high - low) * length
    if spacing is None:
        even = math.sqrt(reach * capacity / force)
        rows = max(1, math.ceil(reach / even * (1.0 - 1e-9)))
        across = _set_out(min(rows * capacity / force, reach))
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
    if not through(site.bounds, heads, direction)[1].all():
        return Notice("E211", "bolts that way come out of a free face from some of the rows")
    left_out = round((length - reach) / (reach / rows)) if reach < length * (1.0 - 3.0 * step) else 0
    return _laid(site, heads, direction, (rows, 1), (across, reach / rows), left_out, None)


def centre_of(polygon: Floats) -> Floats:
    """Centroid (3,) of a plane polygon (k, 3)."""
    vectors = np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0])
    sizes = vectors @ vectors.sum(axis=0)
    centre: Floats = sizes @ ((polygon[0] + polygon[1:-1] + polygon[2:]) / 3.0) / sizes.sum()
    return centre
