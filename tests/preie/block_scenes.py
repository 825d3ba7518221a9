"""Assemblies of blocks for tests and benchmarks: walls, stacks and columns in a section, boxes and benches in space."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.core.orientation import parse_plane
from slopekit.geometry.patches import BEDROCK, Patches
from slopekit.geometry.rock.bench import bench_body
from slopekit.geometry.rock.joint_sets import JointSet, planes_of_sets
from slopekit.geometry.rock.splitting import cut_bench
from slopekit.geometry.sections.columns import column_assembly
from slopekit.kinds import cut
from slopekit.kinds.solver_inputs import joint_strength
from slopekit.loads import NO_BOLTS, PassiveBolts, assembly_loads
from slopekit.preie.many_blocks.ravelling import SolvedComponent, ravel
from slopekit.preie.system.assembly import AssemblyModel, build_assembly
from slopekit.preie.system.model import JointStrength

UNIT_WEIGHT = 25.0
GOODMAN_BRAY = np.array([4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4], dtype=float)


@dataclass(frozen=True)
class Scene:
    """Blocks under load: patches, centroids (b, 3), forces (b, 3), moments (b, 3) about them, fixed (b,)."""

    patches: Patches
    centroids: np.ndarray
    forces: np.ndarray
    moments: np.ndarray
    fixed: np.ndarray
    in_section: bool
    bolts: PassiveBolts = NO_BOLTS

    def __len__(self) -> int:
        return len(self.centroids)

    def model(
        self, phi: float | Sequence[float], c=0.0, psi: float | Sequence[float] = 0.0, refine=0
    ):
        """Its model; degrees and kPa, one for all joints or one each."""
        each = np.ones(int(self.patches.joint.max()) + 1)
        tangents = (np.tan(np.radians(angle)) * each for angle in (phi, psi))
        strength = JointStrength(np.asarray(c) * each, *tangents, 0.0 * each)
        found: AssemblyModel = build_assembly(
            self.patches,
            self.fixed,
            self.centroids,
            self.forces,
            self.moments,
            strength,
            self.in_section,
            np.full(len(self.patches), refine),
            bolts=self.bolts,
        )
        return found

    def mapped(
        self, matrix=None, shift=(0.0, 0.0, 0.0), length: float = 1.0, force: float = 1.0
    ) -> "Scene":
        """The scene turned or mirrored by an orthogonal matrix (3, 3), in other units, then moved."""
        turn = np.eye(3) if matrix is None else np.asarray(matrix, dtype=float)
        sign = float(np.sign(np.linalg.det(turn)))  # moments are axial vectors

        def points(x: np.ndarray) -> np.ndarray:
            return length * x @ turn.T + np.asarray(shift)

        p = self.patches
        patches = replace(
            p,
            normals=p.normals @ turn.T,
            areas=p.areas * length**2,
            centroids=points(p.centroids),
            corners=points(p.corners),
        )
        return replace(
            self,
            patches=patches,
            centroids=points(self.centroids),
            forces=force * self.forces @ turn.T,
            moments=sign * force * length * self.moments @ turn.T,
        )

    def with_untouched_block(self) -> "Scene":
        """The same with one block more, in front, that touches nothing and carries nothing."""
        return replace(
            self,
            centroids=np.concatenate([[[9.0, 0.0, 9.0]], self.centroids]),
            fixed=np.insert(self.fixed, 0, False),
            forces=np.insert(self.forces, 0, 0.0, axis=0),
            moments=np.insert(self.moments, 0, 0.0, axis=0),
            patches=replace(
                self.patches,
                plus=self.patches.plus + 1,
                minus=np.where(self.patches.minus < 0, -1, self.patches.minus + 1),
            ),
        )


def weighed(
    patches: Patches, volumes, centroids, in_section: bool, fixed=None, unit_weight=UNIT_WEIGHT
) -> Scene:
    """A scene under its own weight."""
    count = len(centroids)
    forces = np.zeros((count, 3))
    forces[:, 2] = -unit_weight * np.asarray(volumes)
    fixed = np.zeros(count, dtype=bool) if fixed is None else fixed
    return Scene(patches, np.asarray(centroids), forces, np.zeros((count, 3)), fixed, in_section)


def section_patches(plus, minus, ends, normals, joint=None) -> Patches:
    """Patches of a section 1 m thick: ends (k, 2, 2) and normals (k, 2) in x and z."""
    ends, normals = np.asarray(ends, dtype=float), np.asarray(normals, dtype=float)
    corners, normal = np.zeros((len(ends), 2, 3)), np.zeros((len(ends), 3))
    corners[:, :, [0, 2]], normal[:, [0, 2]] = ends, normals
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    joint = np.zeros(len(ends), dtype=int) if joint is None else np.asarray(joint)
    return Patches(
        np.asarray(plus),
        np.asarray(minus),
        joint,
        normal,
        lengths,
        corners.mean(axis=1),
        corners.reshape(-1, 3),
        2 * np.arange(len(ends) + 1),
    )


def downhill(dip: float) -> np.ndarray:
    """Turns what lies level so that it dips toward -x, (3, 3)."""
    a = math.radians(dip)
    return np.array(
        [[math.cos(a), 0.0, -math.sin(a)], [0.0, 1.0, 0.0], [math.sin(a), 0.0, math.cos(a)]]
    )


def turned_about_vertical(angle: float) -> np.ndarray:
    """Turns everything about the vertical axis, (3, 3)."""
    a = math.radians(angle)
    return np.array(
        [[math.cos(a), -math.sin(a), 0.0], [math.sin(a), math.cos(a), 0.0], [0.0, 0.0, 1.0]]
    )


def on_incline(scene: Scene, dip: float) -> Scene:
    """A level scene on a base that dips; the loads stay upright."""
    return replace(scene.mapped(downhill(dip)), forces=scene.forces)


def rectangles(boxes, dip: float, joint_of_base: int = 0) -> Scene:
    """Rectangles (x, x', z, z') on a base along z = 0, all touching where their sides meet, turned to dip."""
    boxes = np.asarray(boxes, dtype=float)
    plus, minus, ends, normals = [], [], [], []
    near = 1e-9 * float(np.ptp(boxes))

    def touch(along: int, across: int, normal) -> None:
        low, high, start, end = (
            boxes[:, across],
            boxes[:, across + 1],
            boxes[:, along],
            boxes[:, along + 1],
        )
        order = np.argsort(low, kind="stable")
        by_level = low[order]
        for i in range(len(boxes)):  # what stands with its lower side on the upper side of i
            first, last = np.searchsorted(by_level, (high[i] - near, high[i] + near))
            for k in order[first:last]:
                begins, stops = max(start[i], start[k]), min(end[i], end[k])
                if stops > begins + near:
                    plus.append(k)
                    minus.append(i)
                    segment = [[begins, high[i]], [stops, high[i]]]
                    ends.append(segment if along == 0 else [point[::-1] for point in segment])
                    normals.append(normal)

    for i in np.flatnonzero(np.abs(boxes[:, 2]) < near):
        plus.append(i)
        minus.append(BEDROCK)
        ends.append([[boxes[i, 0], 0.0], [boxes[i, 1], 0.0]])
        normals.append([0.0, 1.0])
    touch(0, 2, [0.0, 1.0])
    touch(2, 0, [1.0, 0.0])
    joint = np.where(np.array(minus) == BEDROCK, joint_of_base, 0)
    patches = section_patches(plus, minus, ends, normals, joint)
    middle = np.zeros((len(boxes), 3))
    middle[:, 0], middle[:, 2] = boxes[:, :2].mean(axis=1), boxes[:, 2:].mean(axis=1)
    volumes = (boxes[:, 1] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 2])
    return on_incline(weighed(patches, volumes, middle, True), dip)


def wall(
    courses: int, per_course: int, dip: float = 20.0, width: float = 2.0, height: float = 1.0
) -> Scene:
    """Running bond: every second course begins and ends with half a block."""
    boxes = []
    for course in range(courses):
        joints = width * np.arange(per_course + 1)
        if course % 2:
            joints = np.concatenate([joints[:1], joints[:-1] + width / 2.0, joints[-1:]])
        low = course * height
        boxes += [(x, y, low, low + height) for x, y in itertools.pairwise(joints)]
    return rectangles(boxes, dip)


def stack(
    count: int, dip: float = 30.0, width: float = 2.0, height: float = 1.0, joint_of_base: int = 0
) -> Scene:
    """Blocks on top of each other."""
    boxes = [(0.0, width, i * height, (i + 1) * height) for i in range(count)]
    return rectangles(boxes, dip, joint_of_base)


def columns(
    heights=GOODMAN_BRAY,
    width: float = 10.0,
    step: float = 1.0,
    dip: float = 60.0,
    risers=True,
    rows=1,
):
    """Columns on a stepped base: `geometry/sections/columns.py`, with or without the contacts against the steps."""
    built = column_assembly(dip, width, np.asarray(heights, dtype=float), step, rows=rows)
    patches = built.patches
    if not risers:
        keep = np.flatnonzero(patches.joint < 2)
        corners = patches.corners.reshape(-1, 2, 3)[keep].reshape(-1, 3)
        patches = Patches(
            patches.plus[keep],
            patches.minus[keep],
            patches.joint[keep],
            patches.normals[keep],
            patches.areas[keep],
            patches.centroids[keep],
            corners,
            2 * np.arange(len(keep) + 1),
        )
    return weighed(patches, built.volumes, built.centroids, True)


def active_passive(passive_dip: float, unit_weight: float = 20.0) -> Scene:
    """`7c_two_block`: a triangle on a 45° base pushes a block 10 m long; joints: active base, passive base, interface.

    All friction angles but that of the interface, which is smooth, are for `model` to give.
    """
    low = -10.0 * math.tan(math.radians(passive_dip))
    outlines = [
        np.array([(0.0, 0.0), (0.0, 5.0), (-5.0, 5.0)]),
        np.array([(0.0, 0.0), (10.0, low), (10.0, 5.0), (0.0, 5.0)]),
    ]
    areas, middles = zip(*(_area_and_centroid(outline) for outline in outlines), strict=True)
    a, half = math.radians(passive_dip), math.sqrt(0.5)
    patches = section_patches(
        [0, 1, 1],
        [BEDROCK, BEDROCK, 0],
        [[(-5, 5), (0, 0)], [(0, 0), (10, low)], [(0, 0), (0, 5)]],
        [(half, half), (math.sin(a), math.cos(a)), (1.0, 0.0)],
        [0, 1, 2],
    )
    centroids = np.array([(x, 0.0, z) for x, z in middles])
    return weighed(patches, areas, centroids, True, unit_weight=unit_weight)


def _area_and_centroid(outline: np.ndarray) -> tuple[float, np.ndarray]:
    x, z = outline.T
    cross = x * np.roll(z, -1) - np.roll(x, -1) * z
    area = cross.sum() / 2.0
    middle = ((outline + np.roll(outline, -1, axis=0)) * cross[:, None]).sum(axis=0) / (6.0 * area)
    return float(area), middle


def boxes_in_space(
    counts: tuple[int, int, int], size: tuple[float, float, float], dip: float, overlap=0.0
) -> Scene:
    """A heap of equal boxes on an incline, nx by ny by nz; every second course is shifted by `overlap` of a box.

    Patches lie between neighbours of one course, between the courses, and below the lowest.
    """
    nx, ny, nz = counts
    index = np.arange(nx * ny * nz).reshape(nx, ny, nz)
    dx, dy, dz = size
    patches: list[tuple[int, int, tuple, tuple, int]] = []
    centroids = np.zeros((index.size, 3))
    for i, j, k in np.ndindex(nx, ny, nz):
        x, y, z = i * dx + (k % 2) * overlap * dx, j * dy, k * dz
        centroids[index[i, j, k]] = x + dx / 2, y + dy / 2, z + dz / 2
        if i:
            patches.append(
                (index[i, j, k], index[i - 1, j, k], (x, x, y, y + dy, z, z + dz), (1, 0, 0), 0)
            )
        if j:
            patches.append(
                (index[i, j, k], index[i, j - 1, k], (x, x + dx, y, y, z, z + dz), (0, 1, 0), 0)
            )
        if k == 0:
            patches.append((index[i, j, k], BEDROCK, (x, x + dx, y, y + dy, 0, 0), (0, 0, 1), 1))
            continue
        for below in range(max(i - 1, 0), min(i + 2, nx)):
            start = below * dx + ((k - 1) % 2) * overlap * dx
            low, high = max(x, start), min(x + dx, start + dx)
            if high - low > 1e-9 * dx:
                patches.append(
                    (
                        index[i, j, k],
                        index[below, j, k - 1],
                        (low, high, y, y + dy, z, z),
                        (0, 0, 1),
                        0,
                    )
                )
    plus, minus, spans, normals, joint = (np.array(part) for part in zip(*patches, strict=True))
    corners = np.empty((len(spans), 4, 3))
    for axis in range(3):
        flat = normals[:, axis] == 1
        first, second = (axis + 1) % 3, (axis + 2) % 3
        corners[flat, :, axis] = spans[flat, 2 * axis, None]
        corners[flat, :, first] = spans[flat][
            :, [2 * first, 2 * first + 1, 2 * first + 1, 2 * first]
        ]
        corners[flat, :, second] = spans[flat][
            :, [2 * second, 2 * second, 2 * second + 1, 2 * second + 1]
        ]
    sides = corners[:, [1, 3]] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    found = Patches(
        plus,
        minus,
        joint,
        normals.astype(float),
        areas,
        corners.mean(axis=1),
        corners.reshape(-1, 3),
        4 * np.arange(len(plus) + 1),
    )
    return on_incline(weighed(found, np.full(index.size, dx * dy * dz), centroids, False), dip)


def bench(
    sets: Sequence[tuple[str, float]],
    face: str = "70/180",
    height: float = 15.0,
    length: float = 30.0,
    depth: float = 15.0,
    scatter: float = 0.0,
    seed: int = 1,
) -> Scene:
    """A bench cut by joint sets (dip/dip direction, spacing)."""
    body = bench_body(
        parse_plane(face, "face").normal(), np.array([0.0, 0.0, 1.0]), height, length, depth
    )
    joints = [
        JointSet(parse_plane(plane, "set").normal(), spacing, 0.3, scatter, 0.0)
        for plane, spacing in sets
    ]
    built = cut_bench(body, planes_of_sets(joints, body, np.random.default_rng(seed))).assembly
    return weighed(built.patches, built.volumes, built.centroids, False, built.fixed)


def random_bench(seed: int) -> tuple[Scene, float]:
    """A bench of 20 to 200 blocks by three random sets, and its friction angle; deterministic by its seed."""
    rng = np.random.default_rng(seed)
    height, face = rng.uniform(8.0, 20.0), f"{rng.uniform(50, 85):.1f}/180"
    planes = [f"{rng.uniform(15, 89):.1f}/{rng.uniform(0, 360):.1f}" for _ in range(3)]
    phi, scatter, wanted = (
        rng.uniform(20.0, 45.0),
        float(rng.choice([0.0, 0.0, 3.0])),
        rng.uniform(20.0, 200.0),
    )
    spacing = 3.0 * height / wanted ** (1 / 3)
    for _ in range(12):
        scene = bench(
            [(plane, spacing) for plane in planes], face, height, 2 * height, height, scatter, seed
        )
        if 20 <= len(scene) <= 200:
            break
        spacing *= (len(scene) / wanted) ** (1 / 3)
    return scene, phi


def first_part(design: Mapping[str, Any], ranged: bool = False) -> SolvedComponent:
    """The component of a bench that fails first, its contacts as fine as its twist asks for, with its limit."""
    scene = cut(sk.load(dict(design)))
    loads = assembly_loads(
        scene.assembly,
        scene.unit_weights,
        scene.acting.seismic,
        scene.pressures,
        scene.acting.pushes,
    )
    return (
        ravel(scene.assembly, loads, joint_strength(scene.strengths), ranged=ranged)
        .failures[0]
        .parts[0]
    )
