"""Elastic bedrock around a block: a box cut by the slope and by the block's own planes, without a mesher.

All planes cut the whole box, so its cells share whole faces; the one that is the block is left out, and what lies in
the air. Cells are cut into elements from their lowest-numbered corner (`meshing`), and elements are halved where they
are longer than their distance from the contacts allows. The joints are unions of faces of elements: node pairs lie on
the elements' own faces. The far faces of the box are held:

    d = B γ + (D + D_r) f,   D_r = L_r K_r⁻¹ L_rᵀ

Its own weight has done its work before the block moves, and is left out.
"""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.records import dataclass
from slopekit.elastic.flexibility import Elements, Rock
from slopekit.elastic.meshing import cells_of, edges_of, fanned, mesh_of

_ON = 1e-9  # of the size: corners nearer to a plane lie on it
_ROUNDS = 60  # of halving
#: How far the box reaches beyond the block on all sides, in parts of the block's size. With 1, 2 and 4 the limit of the
#: paper's wedge is the same; its largest traction is 0.9 % higher with 1 and 0.4 % lower with 4 than with 2.
MARGIN = 2.0
#: How fast elements may grow with their distance from the contacts: 0.7, 1 and 1.5 give the same to 0.1 %.
GROWTH = 1.5

#: A convex cell: its faces by the numbers of their corners; in the plane one polygon.
Cell = list[list[int]]


def cut_cells(points: Floats, cells: Sequence[Cell], normal: Floats, offset: float) -> tuple[Floats, list[Cell]]:
    """Convex cells cut by the plane `normal · x = offset`; corners on shared edges are made once.

    Parameters
    ----------
    points : (n, d) corners, those that the cut makes come behind them

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> points, cells = cut_cells(square, [[[0, 1, 2, 3]]], np.array([1.0, 0.0]), 0.5)
    >>> points[4:].tolist(), cells
    ([[0.5, 0.0], [0.5, 2.0]], [[[0, 4, 5, 3]], [[4, 1, 2, 5]]])
    """
    near = _ON * float(np.ptp(points, axis=0).max())
    heights = (points @ normal - offset).tolist()
    side = [0 if abs(height) <= near else 1 if height > 0.0 else -1 for height in heights]
    made: dict[tuple[int, int], int] = {}
    new: list[Floats] = []

    def between(a: int, b: int) -> int:
        a, b = min(a, b), max(a, b)
        if (a, b) not in made:
            made[a, b] = len(points) + len(new)
            part = heights[a] / (heights[a] - heights[b])
            new.append(points[a] + part * (points[b] - points[a]))
        return made[a, b]

    out: list[Cell] = []
    for cell in cells:
        if len({side[k] for polygon in cell for k in polygon} - {0}) < 2:
            out.append(cell)
            continue
        halves: tuple[Cell, Cell] = [], []
        cap = list[int]()
        for polygon in cell:
            parts: tuple[list[int], list[int]] = [], []
            for a, b in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
                for half, sign in zip(parts, (-1, 1), strict=True):
                    if side[a] != -sign:
                        half.append(a)
                if side[a] == 0:
                    cap.append(a)
                if side[a] * side[b] < 0:
                    corner = between(a, b)
                    cap.append(corner)
                    for half in parts:
                        half.append(corner)
            for half, whole, sign in zip(parts, halves, (-1, 1), strict=True):
                if any(k < len(side) and side[k] == sign for k in half):
                    whole.append(half)
        out += [[*half, _around([*points, *new], cap, normal)] if len(normal) == 3 else half for half in halves]
    return np.array([*points, *new]), out


def _around(points: Sequence[Floats], corners: Sequence[int], normal: Floats) -> list[int]:
    """Corners of a convex polygon in the order in which they follow."""
    own = list(dict.fromkeys(corners))
    away = np.array([points[k] for k in own])
    away = away - away.mean(axis=0)
    first = away[0] / np.sqrt(away[0] @ away[0])
    turn = np.arctan2(away @ np.cross(normal, first), away @ first)
    return [own[k] for k in np.argsort(turn)]


def box_of(lowest: Floats, highest: Floats) -> tuple[Floats, Cell]:
    """Corners (2ᵈ, d) of a box along the axes, and its one cell."""
    d = len(lowest)
    pick = np.array([[k >> i & 1 for i in range(d)] for k in range(2**d)], dtype=bool)
    points = np.where(pick, highest, lowest)
    if d == 2:
        return points, [[0, 1, 3, 2]]
    return points, [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]


@dataclass(frozen=True, slots=True)
class Box:
    """A box of rock with the block taken out of it, in coarse elements.

    Attributes
    ----------
    mesh : of elements; lowest, highest : (d,) its ends, where it is held
    """

    mesh: Any
    lowest: Floats
    highest: Floats


@dataclass(frozen=True, slots=True)
class Bedrock:
    """How bedrock gives at the node pairs of a block.

    Attributes
    ----------
    by_force : (3m, 3m) relative displacement per force, m/kN; degrees, cells : unknowns and finite elements
    """

    by_force: Floats
    degrees: int
    cells: int


def box_around(faces: Mapping[int, Floats], free: Sequence[int], floor: float, margin: float = MARGIN) -> Box:
    """The rock around a convex block.

    Parameters
    ----------
    faces : (k, d) corners of each face of the block, the last of their coordinates up; in the plane its sides (2, 2)
    free : those of the faces that are the surface of the slope, which goes on beyond the block
    floor : level of the ground in front of the slope, not above the block's lowest corner
    """
    corners = np.concatenate(list(faces.values()))
    centre = corners.mean(axis=0)
    planes = {key: _plane(np.asarray(face), centre) for key, face in faces.items()}
    lowest, highest = corners.min(axis=0), corners.max(axis=0)
    reach = margin * float((highest - lowest).max())
    lowest, highest = lowest - reach, highest + reach
    points, cell = box_of(lowest, highest)
    cells = [cell]
    level = np.eye(len(centre))[-1]
    for normal, offset in (*(planes[key] for key in free), (level, floor), *planes.values()):
        points, cells = cut_cells(points, cells, normal, offset)

    def is_rock(cell: Cell) -> bool:
        at = points[sorted({k for polygon in cell for k in polygon})].mean(axis=0)
        if at[-1] > floor and any(planes[key][0] @ at > planes[key][1] for key in free):
            return False
        return any(normal @ at > offset for normal, offset in planes.values())

    kept = [cell for cell in cells if is_rock(cell)]
    parts = [fanned(cell) if len(centre) == 2 else cells_of(points, fanned(cell)) for cell in kept]
    return Box(mesh_of(points, np.concatenate(parts)), lowest, highest)


def _plane(face: Floats, inside: Floats) -> tuple[Floats, float]:
    """Outward normal and offset of a face of a body."""
    middle = face.mean(axis=0)
    normal = np.linalg.svd(face - middle)[2][-1]
    if normal @ (inside - middle) > 0.0:
        normal = -normal
    return normal, float(normal @ middle)


def graded(mesh: Any, near: Floats, edge: float, most: int, growth: float = GROWTH) -> Any:
    """Elements halved until none is longer than `edge + growth * its distance` from points (q, d).

    What has more than `most` elements is given back as it is.
    """
    tree = cKDTree(near)
    told = logging.getLogger("skfem")
    level = told.level
    told.setLevel(logging.ERROR)  # else it says of every mesh of its own how its arrays lie
    try:
        for _ in range(_ROUNDS):
            corners = np.asarray(mesh.p).T[np.asarray(mesh.t).T]
            places = np.concatenate([corners, corners.mean(axis=1, keepdims=True)], axis=1)
            allowed = edge + growth * tree.query(places)[0].min(axis=1)
            long = np.flatnonzero(edges_of(mesh) > allowed * (1.0 + 1e-9))
            if not len(long) or mesh.t.shape[1] > most:
                break
            mesh = mesh.refined(long)
    finally:
        told.setLevel(level)
    return mesh


def bedrock(box: Box, mesh: Any, rock: Rock, points: Floats, axes: Floats, thickness: float = 1.0) -> Bedrock:
    """How a box of rock, in a `mesh` of its own, gives at node pairs.

    Parameters
    ----------
    points : (m, 3) on its faces; axes : (m, 3, 3) local axes, one a row
    """
    elements = Elements(mesh, rock, thickness)
    by_force = elements.held_at(_far(elements, box), points, axes)
    return Bedrock(frozen(by_force), elements.degrees, int(mesh.t.shape[1]))


def _far(elements: Elements, box: Box) -> Ints:
    """Degrees of freedom on the far faces of a box."""
    near = 1e-6 * float((box.highest - box.lowest).max())
    dim = len(box.lowest)

    def is_far(at: Floats) -> Bools:
        ends = [np.abs(at[i] - end[i]) < near for i in range(dim) for end in (box.lowest, box.highest)]
        far: Bools = np.logical_or.reduce(ends)
        return far

    nodes = np.asarray(elements.basis.get_dofs(is_far).all())
    held: Ints = (dim * nodes[:, None] + np.arange(dim)).ravel()
    return held
