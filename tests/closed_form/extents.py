"""Extents of any block from its corners, by projection alone: what the formulas of sizes are held against."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, slots=True)
class BlockExtents:
    """Extents of one block from its corners: behind the crest, along it, and up."""

    setback_m: float
    face_width_m: float
    height_m: float


def block_extents(
    corners_m: ArrayLike, face_dip_direction_deg: float, crest_m: ArrayLike
) -> BlockExtents:
    """How far the corners of any block reach behind a level crest, along it and in height.

    Parameters
    ----------
    corners_m : (k, 3) east, north and up; crest_m : (3,) a point of the crest
    face_dip_direction_deg : of the face, whose strike the crest has

    >>> block_extents([[0, 0, 0], [4, 3, 5], [-2, 1, 5]], 0.0, [0, 3.5, 5])
    BlockExtents(setback_m=3.5, face_width_m=6.0, height_m=5.0)
    """
    corners, crest = np.asarray(corners_m, dtype=np.float64), np.asarray(crest_m, dtype=np.float64)
    to = math.radians(face_dip_direction_deg)
    behind = (corners - crest) @ np.array([-math.sin(to), -math.cos(to), 0.0])
    along = corners @ np.array([math.cos(to), -math.sin(to), 0.0])
    return BlockExtents(
        max(0.0, float(behind.max())), float(np.ptp(along)), float(np.ptp(corners[:, 2]))
    )
