"""Sizes of the failing blocks: setback behind the crest, width along it, height, traces, measured on their corners.

All kinds use these functions: the faces of a wedge, the section of a block on a plane, the blocks of a mechanism.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from slopekit.block_scene import Sizes
from slopekit.core.arrays import Floats, cross

_PLANE_TOLERANCE = 1e-7  # of the size of a block: a corner this near to a plane lies on it


@dataclass(frozen=True)
class Crest:
    """A crest: a point of it, and the upward unit normals of the face before it and of the slope behind it, (3,)."""

    point: Floats
    face: Floats
    upper: Floats


def sizes_of_faces(faces: Mapping[str, Floats], joints: Iterable[str], crest: Crest) -> Sizes:
    """Return the sizes of one block by its faces.

    Parameters
    ----------
    faces : (k, 3) polygons by name, among them `face` and `upper slope` where the block reaches them
    joints : names of the faces whose traces are measured
    """
    traces = {}
    for name in joints:
        lengths = {
            short: length_on_plane(faces[name], normal, crest.point)
            for short, normal in (("face", crest.face), ("upper", crest.upper))
        }
        traces[name] = {short: length for short, length in lengths.items() if length}
    return replace(extents_of(np.concatenate(list(faces.values())), crest), trace_lengths_m=traces)


def sizes_of_section(outline: Floats, crest_x: float, lengths: Mapping[str, float]) -> Sizes:
    """Return the sizes of a block by its outline (k, 2) m, x out of the slope; a block per metre has no width.

    >>> triangle = np.array([[0.0, 0.0], [-2.0, 5.0], [-6.0, 5.0]])
    >>> sizes = sizes_of_section(triangle, -2.0, {"J1": 7.81})
    >>> sizes.height_m, sizes.setback_m, sizes.trace_lengths_m
    (5.0, 4.0, {'J1': {'section': 7.81}})
    """
    behind = max(0.0, crest_x - float(outline[:, 0].min()))
    return Sizes(
        float(np.ptp(outline[:, 1])),
        None,
        behind,
        {name: {"section": length} for name, length in lengths.items()},
    )


def extents_of(corners: Floats, crest: Crest) -> Sizes:
    """Return setback, width and height of corners (n, 3); the width on the crest, else of the outermost corners."""
    edge = cross(crest.face, crest.upper)
    edge = edge / math.sqrt(float(edge @ edge))
    behind = np.array([edge[1], -edge[0], 0.0]) / math.hypot(edge[0], edge[1])
    behind = -behind if behind @ crest.face > 0.0 else behind
    arms = corners - crest.point
    tolerance = _PLANE_TOLERANCE * max(float(np.ptp(corners, axis=0).max()), 1e-300)
    on_crest = (np.abs(arms @ crest.face) < tolerance) & (np.abs(arms @ crest.upper) < tolerance)
    along = arms @ edge
    width = float(np.ptp(along[on_crest])) if on_crest.any() else 0.0
    width = width if width > tolerance else float(np.ptp(along))
    return Sizes(float(np.ptp(corners[:, 2])), width, max(0.0, float((arms @ behind).max())), {})


def length_on_plane(polygon: Floats, normal: Floats, point: Floats) -> float:
    """Return the length (m) of the edges of a polygon (k, 3) that lie on a plane."""
    distance = np.abs((polygon - point) @ normal)
    lies_on = distance < _PLANE_TOLERANCE * max(float(np.ptp(polygon, axis=0).max()), 1e-300)
    next_lies_on = np.roll(lies_on, -1)
    edges = np.roll(polygon, -1, axis=0) - polygon
    return float(np.sqrt((edges * edges).sum(axis=1))[lies_on & next_lies_on].sum())
