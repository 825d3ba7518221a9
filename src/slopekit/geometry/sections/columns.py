"""Columns on a stepped base (Goodman & Bray 1976) in a vertical section: outlines and exact contacts.

Along the base runs e_x = (cos ψ, sin ψ), up the slope; square to it, along the columns, e_y = (-sin ψ, cos ψ), with
ψ = 90° - dip of the columns. Column n stands on base [(n - 1) Δx, n Δx] at height (n - 1) b; between two columns the
bedrock steps up by b (the riser), and the columns touch above the higher of their bases. The bedrock ends behind the
last column.
"""

import math

import numpy as np

from slopekit.core.arrays import Floats, Ints, frozen
from slopekit.geometry.patches import BEDROCK, Assembly, Patches

BASE, SIDE, RISER = range(3)
_BEDROCK_DEPTH = 2.0  # column widths of bedrock drawn below the lowest base


def column_outlines(
    dip_deg: float, width: float, heights: Floats, base_step: float
) -> tuple[list[Floats], Floats]:
    """Return the outlines (x, z) of the columns, (4, 2) anticlockwise from the lower corner, and of the bedrock.

    Parameters
    ----------
    dip_deg : of the columns into the slope, more than 0 to 90
    width : m, along the base; heights : (n,) m, from the toe upward, square to the base
    base_step : m, how much each base lies above the one below, square to it; negative where the base steps down

    Examples
    --------
    >>> columns, bedrock = column_outlines(90.0, 2.0, np.array([3.0, 4.0]), 1.0)
    >>> columns[1].tolist()
    [[2.0, 1.0], [4.0, 1.0], [4.0, 5.0], [2.0, 5.0]]
    >>> bedrock.tolist()
    [[0.0, -4.0], [4.0, -4.0], [4.0, 1.0], [2.0, 1.0], [2.0, 0.0], [0.0, 0.0]]
    """
    frame = _frame(dip_deg)
    foot, low = _feet(len(heights), width, base_step)
    high = low + np.asarray(heights, dtype=np.float64)
    corners = (
        np.stack([foot, low, foot + width, low, foot + width, high, foot, high], axis=1).reshape(
            -1, 4, 2
        )
        @ frame
    )
    steps = np.stack([foot, low, foot + width, low], axis=1).reshape(-1, 2)
    bottom = float(low.min()) - _BEDROCK_DEPTH * width
    below = np.array([[0.0, bottom], [foot[-1] + width, bottom]])
    repeated = base_step == 0.0 and len(foot) > 1  # a plain base has no corners between the columns
    top = steps[[-1, 0]] if repeated else steps[::-1]
    return list(corners), np.concatenate([below, top]) @ frame


def column_assembly(
    dip_deg: float,
    width: float,
    heights: Floats,
    base_step: float,
    thickness: float = 1.0,
    rows: int = 1,
) -> Assembly:
    """Return the columns as blocks 0, 1, ... from the toe upward, with their contacts (bedrock: minus = -1).

    The patches have `joint` BASE (on the bedrock), SIDE (between columns; plus is the upper column) or RISER (a side
    against the step of the bedrock). Rows stand side by side along y, `thickness` apart, and do not touch each other.

    Parameters
    ----------
    dip_deg, width, heights, base_step : see `column_outlines`
    thickness : m, along y; rows : how often the columns are repeated along y

    Examples
    --------
    >>> columns = column_assembly(60.0, 10.0, np.array([4.0, 8.0, 12.0]), 1.0)
    >>> columns.patches.joint.tolist(), columns.patches.areas.tolist()
    ([0, 0, 0, 1, 1, 2, 2], [10.0, 10.0, 10.0, 3.0, 7.0, 1.0, 1.0])
    """
    frame = _frame(dip_deg)
    height = np.asarray(heights, dtype=np.float64)
    count = len(height)
    foot, low = _feet(count, width, base_step)
    high = low + height
    step = np.maximum(low[:-1], low[1:])  # where two neighbours begin to touch
    top = np.minimum(high[:-1], high[1:])
    side = np.flatnonzero(top > step)
    riser_column = np.arange(count - 1) + (
        1 if base_step < 0.0 else 0
    )  # the column whose foot stands against the riser
    riser_top = np.minimum(step, high[riser_column])
    riser = np.flatnonzero(riser_top > low[riser_column])
    wall = foot[1:]
    ends = np.concatenate(
        [
            np.stack([foot, low, foot + width, low], axis=1),
            np.stack([wall[side], step[side], wall[side], top[side]], axis=1),
            np.stack(
                [wall[riser], low[riser_column[riser]], wall[riser], riser_top[riser]], axis=1
            ),
        ]
    ).reshape(-1, 2, 2)
    numbers = [count, len(side), len(riser)]
    away = -1.0 if base_step > 0.0 else 1.0  # from the riser into the column
    normal = np.repeat(np.array([[0.0, 1.0], [1.0, 0.0], [away, 0.0]]), numbers, axis=0)
    plus = np.concatenate([np.arange(count), side + 1, riser_column[riser]])
    minus = np.concatenate([np.full(count, BEDROCK), side, np.full(len(riser), BEDROCK)])
    along = np.arange(rows) * thickness

    def repeated(points: Floats) -> Floats:
        """(m, 2) in the frame of the columns to (rows m, 3), row by row."""
        x, z = (points @ frame).T
        return np.stack([np.tile(x, rows), np.repeat(along, len(x)), np.tile(z, rows)], axis=1)

    row = np.repeat(np.arange(rows), len(plus)) * count
    plus, minus = np.tile(plus, rows), np.tile(minus, rows)
    joint: Ints = np.tile(np.repeat([BASE, SIDE, RISER], numbers), rows)
    normals = np.tile(np.insert(normal @ frame, 1, 0.0, axis=1), (rows, 1))
    areas = np.tile(np.abs(ends[:, 1] - ends[:, 0]).sum(axis=1) * thickness, rows)
    patches = Patches(
        plus + row,
        np.where(minus == BEDROCK, BEDROCK, minus + row),
        joint,
        frozen(normals),
        frozen(areas),
        frozen(repeated(ends.mean(axis=1))),
        frozen(repeated(ends.reshape(-1, 2))),
        2 * np.arange(len(plus) + 1),
    )
    middle = np.stack([foot + width / 2.0, (low + high) / 2.0], axis=1)
    total = rows * count
    return Assembly(
        frozen(np.tile(height * width * thickness, rows)),
        frozen(repeated(middle)),
        np.zeros(total, dtype=bool),
        patches,
        True,
        frozen(np.zeros((0, 3))),
        np.zeros((0, 3), dtype=np.int64),
        np.zeros(0, dtype=np.int64),
    )


def slope_heights(
    height: float, face_deg: float, upper_deg: float, base_deg: float, width: float, step: float
) -> tuple[float, ...]:
    """Return the heights (m) of the columns of a slope, from the toe upward (Goodman & Bray 1976).

    Along the base a column rises by a₁ = Δx tan(ψ_f - ψ_p) below the crest and falls by a₂ = Δx tan(ψ_p - ψ_s) above
    it: y_n = n (a₁ - b) to the crest, y_n = y_(n-1) - a₂ - b from there (Wyllie & Mah 2004, ch. 9 (m)). The crest is at
    the column whose upper corner is next to it; the last column is the last that is higher than its step.

    Parameters
    ----------
    height : m, vertical, from the foot of the lowest column to the crest
    face_deg, upper_deg, base_deg : dips of the face, the upper slope and the base of each column
    width, step : m, Δx and b

    Goodman & Bray's own, whose a₁ and a₂ are 5 m:

    >>> face, upper = 30.0 + math.degrees(math.atan(0.5)), 30.0 - math.degrees(math.atan(0.5))
    >>> [round(y, 9) for y in slope_heights(92.5, face, upper, 30.0, 10.0, 1.0)]
    [4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0, 32.0, 36.0, 40.0, 34.0, 28.0, 22.0, 16.0, 10.0, 4.0]
    """
    crest, rises, falls = _crest(height, face_deg, upper_deg, base_deg, width, step)
    heights = [n * rises for n in range(1, crest + 1)]
    while heights[-1] - falls > step:
        heights.append(heights[-1] - falls)
    return tuple(heights) if heights[0] > step else ()


def too_many_columns(
    height: float,
    face_deg: float,
    upper_deg: float,
    base_deg: float,
    width: float,
    step: float,
    most: int,
) -> bool:
    """Return whether a slope has more than `most` columns, see `slope_heights`."""
    crest, rises, falls = _crest(height, face_deg, upper_deg, base_deg, width, step)
    return crest + crest * rises / falls > most


def _crest(
    height: float, face_deg: float, upper_deg: float, base_deg: float, width: float, step: float
) -> tuple[int, float, float]:
    """Return the number of the crest column, and by how much (m) the columns grow below it and shrink above it."""
    face, upper, base = (math.radians(angle) for angle in (face_deg, upper_deg, base_deg))
    along = height * (math.cos(face) * math.cos(base) / math.sin(face) + math.sin(base))
    rises, falls = width * math.tan(face - base) - step, width * math.tan(base - upper) + step
    return max(round(along / width), 1), rises, falls


def _frame(dip_deg: float) -> Floats:
    """Return the axes e_x and e_y of the columns as rows (x, z)."""
    sine, cosine = math.cos(math.radians(dip_deg)), math.sin(math.radians(dip_deg))
    if dip_deg == 90.0:
        sine = 0.0  # upright columns have level bases to the last digit
    return np.array([[cosine, sine], [-sine, cosine]])


def _feet(count: int, width: float, base_step: float) -> tuple[Floats, Floats]:
    """Return the positions of the columns along the base, and the heights of their bases, m."""
    number = np.arange(count, dtype=np.float64)
    return number * width, number * base_step
