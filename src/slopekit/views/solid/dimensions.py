"""Dimension lines of what fails: setback behind the crest, width along it, height, with their numbers."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from slopekit.bolts import rods
from slopekit.core.arrays import Floats, cross
from slopekit.core.orientation import parse_plane
from slopekit.core.records import dataclass
from slopekit.views.solid.layers import DARK, Layer, layer, spheres
from slopekit.views.solid.stage import Stage

_THIN, _END = 1.6e-3, 4.5e-3  # of the size: radius of the lines, of the balls at their ends
_ASIDE = 0.05  # of the size: how far before the block the height stands
_SAME = 1e-4  # of the size: what was measured, found again


@dataclass(frozen=True, slots=True)
class Dimension:
    """A length from one point (3,) to another, as it is called; `at` (3,) is where its number stands."""

    name: str
    length_m: float
    start: Floats
    end: Floats
    at: Floats

    @property
    def text(self) -> str:
        """Its number."""
        return f"{self.name} {self.length_m:.4g} m"


def dimensions(stage: Stage) -> list[Dimension]:
    """Setback, face width and height of the block, of many blocks of those that move first, as far as they are known.

    The numbers are those of the result; the ends are corners of the blocks, or lie square to the crest from one.
    """
    given: Mapping[str, Any] = stage.document.get("geometry" if stage.alone else "mechanism") or {}
    own = stage.free if stage.alone else stage.scene.order == 1
    corners = stage.scene.shapes.solids.vertices[own[stage.of_vertex]]
    height, width, setback = (given.get(key) for key in ("height_m", "face_width_m", "setback_m"))
    if height is None or not len(corners):
        return []
    out, size = _square_to_crest(stage), float(np.ptp(corners, axis=0).max())
    depth, measures = corners @ out, []
    if setback:
        behind = depth.min() if (crest := _crest_of_columns(stage)) is None else -crest - setback
        back = corners[np.abs(depth - behind) < _SAME * size]
        back = back[back[:, 2] > back[:, 2].max() - _SAME * size].mean(axis=0)
        measures.append(Dimension("setback", setback, back, back + setback * out, back + 0.55 * setback * out))
    if width:
        start, end = _across(corners, out, depth.min() + (setback or 0.0), width, size)
        measures.append(Dimension("width", width, start, end, start + 0.3 * (end - start)))
    foot = corners[np.argmin(corners[:, 2])] + _ASIDE * size * out
    top = foot + np.array([0.0, 0.0, height])
    return [*measures, Dimension("height", height, foot, top, foot + 0.45 * (top - foot))]


def _across(corners: Floats, out: Floats, crest: float, width: float, size: float) -> tuple[Floats, Floats]:
    """The ends of the width: corners on the crest, or else square to it from the outermost ones."""
    along = cross(np.array([0.0, 0.0, 1.0]), out)
    across, near = corners @ along, np.abs(corners @ out - crest) < _SAME * size
    if near.any():
        start, end = (corners[near][pick(across[near])] for pick in (np.argmin, np.argmax))
        if abs(float(np.sqrt(((end - start) ** 2).sum())) - width) < _SAME * size:
            return start, end
    low = corners[np.argmin(across)]
    return low, low + np.ptp(across) * along


def lines(stage: Stage, measures: Sequence[Dimension]) -> list[Layer]:
    """Dimensions as thin lines with their ends."""
    if not measures:
        return []
    starts, ends = np.array([one.start for one in measures]), np.array([one.end for one in measures])
    size = min(stage.size, 2.0 * float(np.sqrt(((ends - starts) ** 2).sum(axis=1)).max()))
    balls = spheres(np.concatenate([starts, ends]), _END * size)
    return [
        layer("dimensions", rods(starts, ends, _THIN * size), DARK, front=2),
        layer("dimensions: ends", (balls[0], balls[1]), DARK, front=2),
    ]


def _crest_of_columns(stage: Stage) -> float | None:
    """How far into the slope from the foot of C1 the crest is, of columns: their bases reach behind their tops."""
    inputs = stage.document.get("inputs") or {}
    height, face = inputs.get("slope_height_m"), inputs.get("slope_face_deg")
    return None if height is None or face is None else height / math.tan(math.radians(face))


def _square_to_crest(stage: Stage) -> Floats:
    """(3,) unit and level, out of the slope and square to its crest."""
    inputs = stage.document.get("inputs") or {}
    face, upper = inputs.get("face"), inputs.get("upper")
    if isinstance(face, str) and isinstance(upper, str):
        edge = cross(parse_plane(face, "face").normal(), parse_plane(upper, "upper").normal())
        flat = np.array([-edge[1], edge[0], 0.0])
        if flat.any():
            level: Floats = flat / np.sqrt(flat @ flat) * np.copysign(1.0, flat @ stage.out)
            return level
    return stage.out
