"""How large it is what fails: setback of the crest, width along it, height, traces, measured on its own corners.

One for every kind: the faces of a wedge, the section of a block on a plane, the moving blocks of a mechanism.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from slopekit.block_scene import Sizes
from slopekit.core.arrays import Floats, cross

_ON = 1e-7  # of the size of a block: a corner this near to a plane lies on it


@dataclass(frozen=True)
class Crest:
    """A crest: a point of it, and the upward unit normals of the face before it and of the slope behind it, (3,)."""

    point: Floats
    face: Floats
    upper: Floats


def sizes_of_faces(faces: Mapping[str, Floats], joints: Iterable[str], crest: Crest) -> Sizes:
    """Sizes of one block by its faces.

    Parameters
    ----------
    faces : (k, 3) polygons by name, among them `face` and `upper slope` where the block reaches them
    joints : names of those whose traces are wanted
    """
    traces = {}
    for name in joints:
        lengths = {
            short: on_plane(faces[name], normal, crest.point)
            for short, normal in (("face", crest.face), ("upper", crest.upper))
        }
        traces[name] = {short: length for short, length in lengths.items() if length}
    return replace(extents_of(np.concatenate(list(faces.values())), crest), trace_lengths_m=traces)


def sizes_of_section(outline: Floats, crest_x: float, lengths: Mapping[str, float]) -> Sizes:
    """Sizes of a block by its outline (k, 2), x out of the slope; what it has per metre has no width.

    >>> triangle = np.array([[0.0, 0.0], [-2.0, 5.0], [-6.0, 5.0]])
    >>> sizes = sizes_of_section(triangle, -2.0, {"J1": 7.81})
    >>> sizes.height_m, sizes.setback_m, sizes.trace_lengths_m
    (5.0, 4.0, {'J1': {'section': 7.81}})
    """
    behind = max(0.0, crest_x - float(outline[:, 0].min()))
    return Sizes(
        float(np.ptp(outline[:, 1])), None, behind, {name: {"section": length} for name, length in lengths.items()}
    )


def extents_of(corners: Floats, crest: Crest) -> Sizes:
    """Behind the crest, along it and up: along it where corners lie on it, else between the outermost."""
    edge = cross(crest.face, crest.upper)
    edge = edge / math.sqrt(float(edge @ edge))
    behind = np.array([edge[1], -edge[0], 0.0]) / math.hypot(edge[0], edge[1])
    behind = -behind if behind @ crest.face > 0.0 else behind
    away = corners - crest.point
    near = _ON * max(float(np.ptp(corners, axis=0).max()), 1e-300)
    on_crest = (np.abs(away @ crest.face) < near) & (np.abs(away @ crest.upper) < near)
    along = away @ edge
    width = float(np.ptp(along[on_crest])) if on_crest.any() else 0.0
    width = width if width > near else float(np.ptp(along))
    return Sizes(float(np.ptp(corners[:, 2])), width, max(0.0, float((away @ behind).max())), {})


def on_plane(polygon: Floats, normal: Floats, point: Floats) -> float:
    """Length of the edges of a polygon (k, 3) that lie on a plane."""
    away = np.abs((polygon - point) @ normal)
    near = away < _ON * max(float(np.ptp(polygon, axis=0).max()), 1e-300)
    after = np.roll(near, -1)
    edges = np.roll(polygon, -1, axis=0) - polygon
    return float(np.sqrt((edges * edges).sum(axis=1))[near & after].sum())
