"""Assemblies of blocks by hand for several tests: walls, stacks and columns in a section, one block in space."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from slopekit.geometry.patches import BEDROCK, Patches
from slopekit.kinds import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.system.assembly import AssemblyModel, build_assembly
from slopekit.preie.system.model import JointStrength, Model

UNIT_WEIGHT = 25.0
GOODMAN_BRAY = [
    4,
    8,
    12,
    16,
    20,
    24,
    28,
    32,
    36,
    40,
    34,
    28,
    22,
    16,
    10,
    4,
]  # heights in m, 10 m wide, base steps 1 m


def strength(phi: float, c: float = 0.0) -> JointStrength:
    return JointStrength(
        np.array([c]), np.array([math.tan(math.radians(phi))]), np.zeros(1), np.zeros(1)
    )


def section(blocks, contacts, dip: float, phi: float, c: float = 0.0) -> AssemblyModel:
    """Blocks (x0, x1, z0, z1) and contacts (plus, minus, end, end, normal) on a base that dips at `dip` toward -x."""
    a = math.radians(dip)
    turn = np.array(
        [[math.cos(a), 0.0, -math.sin(a)], [0.0, 1.0, 0.0], [math.sin(a), 0.0, math.cos(a)]]
    )
    x0, x1, z0, z1 = np.array(blocks, dtype=float).T
    flat = np.zeros(len(blocks))
    centroids = np.stack([(x0 + x1) / 2.0, flat, (z0 + z1) / 2.0], axis=1) @ turn.T
    weights = np.stack([flat, flat, -UNIT_WEIGHT * (x1 - x0) * (z1 - z0)], axis=1)
    ends = (
        np.array([[(e[0], 0.0, e[1]) for e in contact[2:4]] for contact in contacts], dtype=float)
        @ turn.T
    )
    normals = (
        np.array([(contact[4][0], 0.0, contact[4][1]) for contact in contacts], dtype=float)
        @ turn.T
    )
    plus, minus = (np.array([contact[k] for contact in contacts]) for k in (0, 1))
    lengths = np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1))
    patches = Patches(
        plus,
        minus,
        np.zeros_like(plus),
        normals,
        lengths,
        ends.mean(axis=1),
        ends.reshape(-1, 3),
        2 * np.arange(len(plus) + 1),
    )
    fixed = np.zeros(len(blocks), dtype=bool)
    return build_assembly(
        patches, fixed, centroids, weights, np.zeros_like(weights), strength(phi, c), True
    )


def stack(count: int, dip: float, phi: float, width: float = 2.0, c: float = 0.0) -> AssemblyModel:
    """Blocks 1 m high on top of each other."""
    blocks = [(0.0, width, k, k + 1.0) for k in range(count)]
    contacts = [(k, k - 1, (0.0, k), (width, k), (0.0, 1.0)) for k in range(count)]
    return section(blocks, contacts, dip, phi, c)


def wall(courses: int, length: int, dip: float = 20.0, phi: float = 35.0) -> AssemblyModel:
    """Running bond of blocks 2 m x 1 m, half blocks at the ends."""
    end = 2.0 * length
    joints = [
        np.arange(0.0, end + 1.0, 2.0)
        if k % 2 == 0
        else np.array([0.0, *np.arange(1.0, end, 2.0), end])
        for k in range(courses)
    ]
    blocks, contacts, below = [], [], []
    for k, xs in enumerate(joints):
        row = list(enumerate(pairwise(xs), start=len(blocks)))
        blocks += [(a, b, k, k + 1.0) for _, (a, b) in row]
        contacts += [(i, i - 1, (a, k), (a, k + 1.0), (1.0, 0.0)) for i, (a, _) in row[1:]]
        for i, (a, b) in row:
            for j, (from_, to) in below or [(BEDROCK, (0.0, end))]:
                if min(b, to) > max(a, from_):
                    contacts.append((i, j, (max(a, from_), k), (min(b, to), k), (0.0, 1.0)))
        below = row
    return section(blocks, contacts, dip, phi)


def columns(heights: Sequence[float] = GOODMAN_BRAY, phi: float = 38.15) -> AssemblyModel:
    """Goodman and Bray's columns: 10 m wide, on a base that steps up by 1 m a column and dips at 30°."""
    blocks = [
        (10.0 * k, 10.0 * k + 10.0, float(k), k + float(height)) for k, height in enumerate(heights)
    ]
    contacts = [
        (k, BEDROCK, (x0, z0), (x1, z0), (0.0, 1.0)) for k, (x0, x1, z0, _) in enumerate(blocks)
    ]
    for k, ((_, x, _, top), (_, _, bottom, next_top)) in enumerate(pairwise(blocks)):
        contacts.append((k + 1, k, (x, bottom), (x, min(top, next_top)), (1.0, 0.0)))
    return section(blocks, contacts, 30.0, phi)


def polygons(parts, centroid, force, moment, phi: float, c: float = 0.0) -> AssemblyModel:
    """One block in space on flat convex polygons, (corners (p, 3), normal into the block)."""
    corners = [np.asarray(part, dtype=float) for part, _ in parts]
    crossed = [np.cross(part[1:-1] - part[0], part[2:] - part[0]).sum(axis=0) for part in corners]
    areas = np.array([math.sqrt(float(cross @ cross)) / 2.0 for cross in crossed])
    none = np.zeros(len(parts), dtype=np.int64)
    patches = Patches(
        none,
        none + BEDROCK,
        none,
        np.array([normal for _, normal in parts], dtype=float),
        areas,
        np.array([part.mean(axis=0) for part in corners]),
        np.concatenate(corners),
        np.cumsum([0, *(len(part) for part in corners)]),
    )
    one = np.zeros(1, dtype=bool)
    return build_assembly(
        patches,
        one,
        np.array([centroid]),
        np.array([force]),
        np.array([moment]),
        strength(phi, c),
        False,
    )


def block_in_space(
    dip: float, phi: float, side: float = 2.0, height: float = 0.5, c: float = 0.0
) -> AssemblyModel:
    """A box on an incline that dips toward -x."""
    a = math.radians(dip)
    turn = np.array(
        [[math.cos(a), 0.0, -math.sin(a)], [0.0, 1.0, 0.0], [math.sin(a), 0.0, math.cos(a)]]
    )
    base = side * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    weight = np.array([0.0, 0.0, -UNIT_WEIGHT * side * side * height])
    centroid = turn @ np.array([side / 2.0, side / 2.0, height / 2.0])
    return polygons([(base @ turn.T, turn[:, 2])], centroid, weight, np.zeros(3), phi, c)


def paper_wedge() -> tuple[AssemblyModel, Model]:
    """The wedge of the paper's Table 4 as an assembly of one block, and as the model of one block.

    It is a tetrahedron on two triangles, whose corners come first among their node pairs.
    """
    scene = cut(wedge_design({"dips": ("45/115", "45/245")})).scene_at(0)
    pairs, model = scene.pairs, scene.model
    starts = np.flatnonzero(np.diff(pairs.interface, prepend=-1))
    parts = [(pairs.points[k : k + 3], pairs.normals[k]) for k in starts]
    corners = np.unique(np.concatenate([part for part, _ in parts]).round(9), axis=0)
    force = model.load[:3] * model.force_scale
    return polygons(parts, corners.mean(axis=0), force, np.zeros(3), phi=20.0, c=50.0), model
