"""Normal tractions of elastic blocks beside those of rigid ones (matplotlib), from the JSON of a result.

In space a map of each plane, seen from above; in a section each contact along its length, or where there are many of
them all in their places. Needs the extra `plot`.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.records import dataclass
from slopekit.views.charts.drawing import BLUE, DARK, GREY, RED, dressed, needs, nothing, short

_MOST = 4  # planes that are drawn, the largest
_FLAT = 1e-6  # of the extent: a plane no wider is a line
_ALIKE = 1e-4  # of the extent: planes that lie no farther apart are one
_NOTHING = 1e-6  # of the largest traction
_COLOURS = "viridis"
_OPEN = {"linestyle": "none", "marker": "x", "markersize": 4.5, "markeredgewidth": 1.0, "color": RED}


@dataclass(frozen=True, slots=True)
class _PlaneMap:
    """The node pairs of one plane: places in it (n, 2) m, the second up dip; towards which azimuth the first goes.

    `where` is the middle of its pairs, where a joint has more planes than one.
    """

    name: str
    own: Ints
    places: Floats
    azimuth_deg: float
    where: str = ""

    @property
    def is_line(self) -> bool:
        """Whether its pairs lie on a line, as in a section."""
        return len(self.own) < 3 or bool(np.ptp(self.places, axis=0).min() <= _FLAT * np.ptp(self.places, axis=0).max())


@needs({"elastic": {
    "factor": float, "opened_share": float, "pairs": {
        "points_m": [[float]], "joint": [str], "normals": [[float]], "control_areas_m2": [float],
        "elastic_kpa": [float], "rigid_kpa": [float], "opened": [bool],
    },
}})  # fmt: skip
def draw_elastic_tractions(figure: Any, document: Mapping[str, Any]) -> None:
    """Rigid at the left, elastic at the right, one scale; what is open is marked."""
    elastic = document["elastic"]
    pairs = elastic["pairs"]
    area = np.array(pairs["control_areas_m2"], dtype=float)
    every = list(_faces(pairs))
    if not every:
        nothing("the elastic blocks have no contact")
    faces = sorted(every, key=lambda face: -float(area[face.own].sum()))[:_MOST]
    faces.sort(key=lambda face: face.name)
    tractions = {side: _without_rounding(np.array(pairs[f"{side}_kpa"], dtype=float)) for side in ("rigid", "elastic")}
    opened = np.array(pairs["opened"], dtype=bool)
    in_section = all(face.is_line for face in every)
    more = ""
    if in_section and len(every) > _MOST:
        _section(figure, np.array(pairs["points_m"], dtype=float), area, tractions, opened)
    elif in_section:
        _along(figure, faces, tractions, opened)
    else:
        _maps(figure, [face for face in faces if not face.is_line], area, tractions, opened)
        more = "" if len(every) <= _MOST else f"; the largest {_MOST} of {len(every)} planes"
    bed = " on elastic bedrock" if elastic.get("bedrock") == "elastic" else ""
    said = f"normal tractions at F = {elastic['factor']:.4g}, rigid beside elastic{bed}"
    figure.suptitle(f"{said}; {100.0 * elastic['opened_share']:.2g} % of the contact area open{more}", fontsize=10.5)


def _faces(pairs: Mapping[str, Any]) -> Iterator[_PlaneMap]:
    """The planes on which pairs lie, by joint, normal and distance."""
    points, normals = (np.array(pairs[key], dtype=float).reshape(-1, 3) for key in ("points_m", "normals"))
    around = points - points.mean(axis=0) if len(points) else points
    extent = float(np.abs(around).max(initial=0.0)) or 1.0
    planes = np.column_stack([normals, (around * normals).sum(axis=1) / extent])
    planes *= np.where(planes[:, 2] < 0.0, -1.0, 1.0)[:, None]  # seen from above
    by_joint: dict[str, list[list[int]]] = {}
    for k, name in enumerate(pairs["joint"]):
        groups = by_joint.setdefault(str(name), [])
        for group in groups:
            if float(np.abs(planes[group[0]] - planes[k]).max()) <= _ALIKE:
                group.append(k)
                break
        else:
            groups.append([k])
    for name, groups in by_joint.items():
        for k, group in enumerate(groups, 1):
            own, normal = np.array(group), planes[group[0], :3]
            up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 1.0 - _FLAT else np.array([0.0, 1.0, 0.0])
            up = up - (up @ normal) * normal
            up /= np.sqrt(up @ up)
            along = np.cross(up, normal)
            places = points[own] @ np.column_stack([along, up])
            called = name if len(groups) == 1 else f"{name}, plane {k}"
            azimuth = float(np.degrees(np.arctan2(along[0], along[1])) % 360.0)
            east, north, above = (points[own].mean(axis=0).round(1) + 0.0).tolist()
            where = "" if len(groups) == 1 else f"middle {east:.1f} E, {north:.1f} N, {above:.1f} m up"
            yield _PlaneMap(called, own, places - places.min(axis=0), azimuth, where)


def _without_rounding(values: Floats) -> Floats:
    """Tractions; those that are nothing beside the largest are 0."""
    tractions: Floats = np.where(np.abs(values) <= _NOTHING * np.abs(values).max(initial=0.0), 0.0, values)
    return tractions


def _levels(tractions: Mapping[str, Floats], own: Ints) -> Floats:
    from matplotlib.ticker import MaxNLocator

    values = np.concatenate([one[own] for one in tractions.values()])
    return np.array(MaxNLocator(12).tick_values(float(values.min()), float(values.max())))


def _maps(
    figure: Any, faces: list[_PlaneMap], area: Floats, tractions: Mapping[str, Floats], opened: Any
) -> None:  # fmt: skip
    """A row for each plane: contours of the traction over the plane, seen from above."""
    from matplotlib.tri import Triangulation

    heights = [max(2.0, min(4.2, 4.2 * np.ptp(face.places[:, 1]) / np.ptp(face.places[:, 0]))) for face in faces]
    two = any(face.where for face in faces)  # lines of a title
    figure.set_size_inches(10.0, 1.0 + sum(heights) + 0.5 * two * len(faces))
    grid = figure.subplots(len(faces), 2, squeeze=False, height_ratios=heights)
    levels = _levels(tractions, np.concatenate([face.own for face in faces]))
    for face, row in zip(faces, grid, strict=True):
        triangles = Triangulation(*face.places.T)
        triangles.set_mask(_beyond(face.places, triangles.triangles, float(area[face.own].sum())))
        for axes, (side, values) in zip(row, tractions.items(), strict=True):
            own = values[face.own]
            shown = axes.tricontourf(triangles, own, levels=levels, cmap=_COLOURS)
            share = float(area[face.own] @ opened[face.own]) / float(area[face.own].sum())
            middle = f", {face.where}\n" if face.where else ", "
            said = f"{short(face.name, 30)}{middle}{side}: {own.min():.4g} .. {own.max():.4g} kPa"
            if side == "elastic":
                at = face.places[opened[face.own]]
                axes.plot(*at.T, **_OPEN, label="open", clip_on=False)
                said += f", {100.0 * share:.2g} % open"
            axes.set_title(said, fontsize=9.5)
            axes.set_aspect("equal")
            axes.set_xlabel(f"along strike towards {face.azimuth_deg:03.0f}°, m", fontsize=8.5)
            axes.tick_params(labelsize=8)
        row[0].set_ylabel("up dip, m", fontsize=8.5)
    figure.colorbar(shown, ax=grid, label="normal traction, kPa (effective, compression +)", shrink=0.8)
    _legend(figure, grid[0, 1])


def _beyond(places: Floats, triangles: Ints, area: float) -> Bools:
    """Triangles (k,) between pairs (n, 2) that bridge gaps of the contacts: the longest, as much as is above `area`."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    own = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    longest = np.max([((one - other) ** 2).sum(axis=1) for one, other in ((a, b), (b, c), (c, a))], axis=0)
    order = np.argsort(-longest)
    beyond = np.zeros(len(own), dtype=bool)
    beyond[order] = np.cumsum(own[order]) <= own.sum() - area * (1.0 - _ALIKE)
    return beyond & (float(own.sum()) > area * (1.0 + _ALIKE))


def _along(figure: Any, faces: list[_PlaneMap], tractions: Mapping[str, Floats], opened: Any) -> None:
    """A row for each line: both tractions along it."""
    figure.set_size_inches(9.0, 1.0 + 2.8 * len(faces))
    for axes, face in zip(figure.subplots(len(faces), 1, squeeze=False)[:, 0], faces, strict=True):
        along = face.places[:, int(np.argmax(np.ptp(face.places, axis=0)))]
        order = np.argsort(along)
        for (side, values), style in zip(tractions.items(), ({"color": DARK, "linestyle": "--"}, {"color": BLUE}),
                                         strict=True):  # fmt: skip
            axes.plot(along[order], values[face.own][order], marker=".", label=side, **style)
        out = opened[face.own]
        if out.any():
            axes.plot(along[out], tractions["elastic"][face.own][out], **_OPEN, label="open")
        axes.set_title(short(face.name, 40), fontsize=9.5)
        axes.set_ylabel("normal traction, kPa", fontsize=8.5)
        axes.set_xlabel("from the lower end, m", fontsize=8.5)
        axes.legend(fontsize=8)
        dressed(axes)


def _section(figure: Any, points: Floats, area: Floats, tractions: Mapping[str, Floats], opened: Any) -> None:
    """All contacts of a section in their places, larger where more area stands behind a pair."""
    spread = points - points.mean(axis=0)
    across = int(np.argmax(np.ptp(spread[:, :2], axis=0)))
    levels = _levels(tractions, np.arange(len(points)))
    figure.set_size_inches(11.0, 5.5)
    both = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (side, values) in zip(both, tractions.items(), strict=True):
        shown = axes.scatter(points[:, across], points[:, 2], c=values, s=8.0 + 40.0 * area / area.max(),
                             cmap=_COLOURS, vmin=levels[0], vmax=levels[-1])  # fmt: skip
        if side == "elastic" and opened.any():
            axes.plot(points[opened, across], points[opened, 2], **_OPEN, label="open")
        axes.set_title(f"{side}: {values.min():.4g} .. {values.max():.4g} kPa", fontsize=9.5)
        axes.set_aspect("equal")
        axes.set_xlabel("m", color=GREY)
        dressed(axes)
    figure.colorbar(shown, ax=both, label="normal traction, kPa (effective, compression +)", shrink=0.8)
    _legend(figure, both[1])


def _legend(figure: Any, axes: Any) -> None:
    """What the crosses are, beneath, where nothing is hidden."""
    if axes.lines and len(axes.lines[0].get_xdata()):
        figure.legend(handles=axes.lines[:1], fontsize=8.5, loc="outside lower center", frameon=False)
