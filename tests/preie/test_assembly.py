"""The arrays of many blocks against geometry: rigid motions, virtual work, areas, integrals, dense matrices."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from slopekit.core.errors import SolverError
from slopekit.geometry.patches import BEDROCK, Patches
from slopekit.preie.system.assembly import AssemblyModel, build_assembly
from slopekit.preie.system.model import JointStrength
from tests.preie.block_scenes import (
    Scene,
    active_passive,
    bench,
    boxes_in_space,
    columns,
    wall,
    weighed,
)

BENCH = (("45/170", 6.0), ("80/350", 7.0), ("85/80", 7.0))
SCENES = {
    "wall": (lambda: wall(3, 3), 1.0),
    "columns": (lambda: columns(), 0.0),
    "two blocks": (lambda: active_passive(10.0), 0.0),
    "boxes": (lambda: boxes_in_space((2, 2, 3), (2.0, 3.0, 1.0), 25.0, 0.3), 1.0),
    "bench": (lambda: bench(BENCH, scatter=3.0), 0.0),
}


@pytest.fixture(scope="module", params=SCENES)
def case(request) -> tuple[Scene, AssemblyModel]:
    """A scene and its model."""
    build, c = SCENES[request.param]
    scene = build()
    return scene, scene.model(30.0, c)


def as_vectors(model: AssemblyModel, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Motions (n, u) in parts of the length scale as translations, m, and rotation vectors, (n, 3) each."""
    if model.unknowns == 6:
        return model.length_scale * velocity[:, :3], velocity[:, 3:]
    translation, rotation = np.zeros((len(velocity), 3)), np.zeros((len(velocity), 3))
    translation[:, [0, 2]], rotation[:, 1] = model.length_scale * velocity[:, :2], velocity[:, 2]
    return translation, rotation


def placed(
    scene: Scene, model: AssemblyModel, velocity: np.ndarray, time: float, side: np.ndarray
) -> np.ndarray:
    """Where the node pairs (m, 3) are at a time, carried by the blocks (m,) of one side (bedrock stays)."""
    block = np.full(len(scene) + 1, -1)
    block[model.moving] = np.arange(len(model.moving))
    translation, rotation = as_vectors(model, velocity)
    moves = side >= 0
    at = block[side[moves]]
    still = at < 0
    points = model.points.copy()
    centre = scene.centroids[side[moves]]
    turned = (
        Rotation.from_rotvec(time * rotation[at]).apply(points[moves] - centre)
        + centre
        + time * translation[at]
    )
    points[moves] = np.where(still[:, None], points[moves], turned)
    return points


def test_openings_and_slips_are_those_of_rigid_motion(case) -> None:
    """Blocks turned about their centroids and moved; central differences in time, whose error is the step squared."""
    scene, model = case
    rng, h = np.random.default_rng(1), 1e-4
    patches = scene.patches
    of_pair = model.patch[model.pair_contact]
    normal = patches.normals[of_pair]
    for _ in range(4):
        velocity = rng.normal(size=model.load.shape)
        relative = np.zeros_like(model.points)
        for side, sign in ((patches.plus[of_pair], 1.0), (patches.minus[of_pair], -1.0)):
            ahead, behind = (placed(scene, model, velocity, t, side) for t in (h, -h))
            relative += sign * (ahead - behind) / (2.0 * h) / model.length_scale
        opening, slip = model.opening_and_slip(velocity)
        out = (relative * normal).sum(axis=1)
        along = relative - out[:, None] * normal
        assert opening == pytest.approx(out, abs=1e-6)
        size = np.sqrt((slip * slip).sum(axis=1))[model.group_of_pair]
        assert size == pytest.approx(np.sqrt((along * along).sum(axis=1)), abs=1e-6)


def test_statics_is_the_transpose_of_kinematics(case) -> None:
    """Virtual work: forces at the pairs do on them what the forces on the blocks do on their motions."""
    _, model = case
    rng = np.random.default_rng(2)
    velocity = rng.normal(size=model.load.shape)
    opening, slip = model.opening_and_slip(velocity)
    normal, friction = rng.normal(size=opening.shape), rng.normal(size=slip.shape)
    work = float((normal * opening).sum() + (friction * slip).sum())
    assert float((model.forces_on_blocks(normal, friction) * velocity).sum()) == pytest.approx(
        work, rel=1e-12
    )


def test_forces_on_blocks_are_wrenches(case) -> None:
    """Normal forces as vectors at their points: force and moment about the centroid of every block."""
    scene, model = case
    normal = np.random.default_rng(3).uniform(0.5, 1.5, len(model.points))
    found = model.forces_on_blocks(
        normal, np.zeros((len(model.group_first), model.slip_rows.shape[1]))
    )
    of_pair = model.patch[model.pair_contact]
    pushes = normal[:, None] * scene.patches.normals[of_pair]
    wrenches = np.zeros((len(scene), 6))
    for side, sign in ((scene.patches.plus, 1.0), (scene.patches.minus, -1.0)):
        at = side[of_pair]
        ok = at >= 0
        arms = model.points[ok] - scene.centroids[at[ok]]
        moments = np.cross(arms, sign * pushes[ok]) / model.length_scale
        np.add.at(wrenches, at[ok], np.concatenate([sign * pushes[ok], moments], axis=1))
    wrenches = wrenches[model.moving]
    assert found == pytest.approx(
        wrenches if model.unknowns == 6 else wrenches[:, [0, 2, 4]], abs=1e-9
    )


def test_all_moving_as_one_body_opens_no_joint_between_blocks(case) -> None:
    """Translation and turning about one point, of all moving blocks; bedrock alone is left behind."""
    scene, model = case
    rng = np.random.default_rng(4)
    spin, shift = rng.normal(size=3), rng.normal(size=3)
    if model.unknowns == 3:
        spin, shift = spin * [0, 1, 0], shift * [1, 0, 1]
    arms = (scene.centroids[model.moving] - scene.centroids.mean(axis=0)) / model.length_scale
    velocity = np.concatenate([shift + np.cross(spin, arms), np.tile(spin, (len(arms), 1))], axis=1)
    opening, slip = model.opening_and_slip(
        velocity if model.unknowns == 6 else velocity[:, [0, 2, 4]]
    )
    between = model.minus >= 0
    assert opening[between[model.pair_contact]] == pytest.approx(0.0, abs=1e-10)
    assert slip[between[model.group_contact]] == pytest.approx(0.0, abs=1e-10)
    at = model.pair_contact[~between[model.pair_contact]]
    arms = (model.points - scene.centroids.mean(axis=0))[
        ~between[model.pair_contact]
    ] / model.length_scale
    into_plus = np.where(scene.fixed[scene.patches.plus] & (scene.patches.minus >= 0), -1.0, 1.0)[
        model.patch[at], None
    ]
    normals = scene.patches.normals[model.patch[at]] * into_plus
    exact = (normals * (shift + np.cross(spin, arms))).sum(axis=1)
    assert opening[~between[model.pair_contact]] == pytest.approx(exact, abs=1e-10)


def test_control_areas_sum_to_the_patches(case) -> None:
    scene, model = case
    sums = np.bincount(model.pair_contact, model.control_area * model.area_scale)
    assert sums == pytest.approx(scene.patches.areas[model.patch], rel=1e-12)
    assert (model.control_area > 0.0).all()
    assert float(model.control_area.mean()) == pytest.approx(1.0)
    moves = ~np.append(scene.fixed, True)
    assert len(model.patch) == int((moves[scene.patches.plus] | moves[scene.patches.minus]).sum())


def test_cohesion_load_and_strength(case) -> None:
    scene, model = case
    areas, moments = (
        scene.patches.areas[model.patch],
        np.random.default_rng(9).normal(size=scene.forces.shape),
    )
    loaded = replace(scene, moments=moments).model(30.0, 7.5, 12.0)
    size = float(np.sqrt((scene.forces[model.moving] ** 2).sum(axis=1).mean()))
    assert loaded.force_scale == pytest.approx(size)
    assert loaded.cohesion.sum() * size == pytest.approx(7.5 * areas.sum())
    wrench = (
        np.concatenate([scene.forces, moments / model.length_scale], axis=1)[model.moving] / size
    )
    assert loaded.load == pytest.approx(
        wrench if model.unknowns == 6 else wrench[:, [0, 2, 4]], abs=1e-12
    )
    assert loaded.tan_friction == pytest.approx(np.tan(np.radians(30.0)))
    assert loaded.tan_dilation == pytest.approx(np.tan(np.radians(12.0)))
    assert model.length_scale == pytest.approx(np.sqrt(areas.mean()))


def polygon_patch(corners: np.ndarray) -> Scene:
    """One block on bedrock over one flat polygon (k, 3)."""
    cross = (
        np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0) / 2.0
    )
    area = float(np.linalg.norm(cross))
    first, last = corners[1:-1] - corners[0], corners[2:] - corners[0]
    parts = np.linalg.norm(np.cross(first, last), axis=1) / 2.0
    centroid = corners[0] + (parts[:, None] * (first + last) / 3.0).sum(axis=0) / area
    patches = Patches(
        np.array([0]),
        np.array([BEDROCK]),
        np.array([0]),
        cross[None] / area,
        np.array([area]),
        centroid[None],
        corners,
        np.array([0, len(corners)]),
    )
    return weighed(patches, [1.0], np.add(centroid, [[0.1, 0.2, 0.7]]), False)


def integral(corners: np.ndarray, function) -> float:
    """A quadratic over a flat convex polygon: mid-sides of the triangles about its first corner, exact to degree 2."""
    total = 0.0
    for b, c in itertools.pairwise(corners[1:]):
        a = corners[0]
        area = float(np.linalg.norm(np.cross(b - a, c - a))) / 2.0
        total += area / 3.0 * sum(function(0.5 * (p + q)) for p, q in ((a, b), (b, c), (c, a)))
    return total


POLYGONS = {
    "parallelogram": [(0, 0), (3, 0.5), (4, 3), (1, 2.5)],
    "rectangle": [(0, 0), (2, 0), (2, 1), (0, 1)],
    "triangle": [(0, 0), (3, 0.5), (1, 2)],
    "nearly a parallelogram": [(0, 0), (3, 0.5), (4, 3.01), (1, 2.5)],
    "pentagon": [(0, 0), (2, -0.5), (3, 1), (2, 2), (0, 1.5)],
    "hexagon": [(0, 0), (2, -0.5), (3, 1), (2.5, 2), (1, 2.4), (-0.2, 1.5)],
}


def in_space(shape) -> np.ndarray:
    """A flat polygon (k, 2) turned and moved, (k, 3)."""
    turn = Rotation.from_rotvec([0.4, -0.3, 0.8]).as_matrix()
    return np.column_stack([np.array(shape, dtype=float), np.zeros(len(shape))]) @ turn.T + [
        3.0,
        -2.0,
        5.0,
    ]


@pytest.mark.parametrize("refine", [0, 1, 3])
@pytest.mark.parametrize("name", POLYGONS)
def test_pairs_integrate_quadratics_over_a_patch(name, refine) -> None:
    """METHOD.md §5: exact to degree two, positive, hull = polygon; a rule of another kind as reference.

    A fan of k triangles about the area centroid (a triangle is its own), each split into n² with n = 2^refine: n² more
    pairs on their centroids; k n (n + 1) / 2 + 1 on the corners of a fan. A parallelogram as it is has five.
    """
    corners = in_space(POLYGONS[name])
    model = polygon_patch(corners).model(30.0, refine=refine)
    areas = model.control_area * model.area_scale
    n, k = 2**refine, len(corners)
    fan = (n + 1) * (n + 2) // 2 + n * n if k == 3 else k * n * (n + 1) // 2 + 1 + k * n * n
    assert len(areas) == (5 if name in ("parallelogram", "rectangle") and refine == 0 else fan)
    assert (areas > 0.0).all()
    rng = np.random.default_rng(5)
    for _ in range(5):
        matrix, vector, one = rng.normal(size=(3, 3)), rng.normal(size=3), rng.normal()

        def quadratic(x, matrix=matrix, vector=vector, one=one) -> float:
            return float(x @ matrix @ x + vector @ x + one)

        exact = integral(corners, quadratic)
        found = sum(a * quadratic(p) for a, p in zip(areas, model.points, strict=True))
        assert found == pytest.approx(exact, rel=1e-11)
    if k > 3:
        corners = np.concatenate(
            [corners, polygon_patch(corners).patches.centroids]
        )  # the fan is about it
    for corner in corners:
        assert float(np.abs(model.points - corner).sum(axis=1).min()) == pytest.approx(
            0.0, abs=1e-12
        )


@pytest.mark.parametrize("refine", [0, 1, 2])
@pytest.mark.parametrize("name", POLYGONS)
def test_pairs_do_not_depend_on_the_first_corner(name, refine) -> None:
    """The same points with the same areas, in another order; 1e-12 of the coordinates is their rounding."""
    corners = in_space(POLYGONS[name])

    def listed(by: int) -> np.ndarray:
        model = polygon_patch(np.roll(corners, by, axis=0)).model(30.0, refine=refine)
        rows = np.column_stack([model.points, model.control_area * model.area_scale])
        return rows[np.argsort(rows[:, :3] @ np.array([1.0, math.sqrt(2.0), math.pi]))]

    for by in range(1, len(corners)):
        assert listed(by) == pytest.approx(listed(0), abs=1e-12)


@pytest.mark.parametrize(("refine", "weights"), [(0, [1, 4, 1]), (1, [1, 4, 2, 4, 1])])
@pytest.mark.parametrize("c", [0.0, 1.0])
def test_pairs_of_a_segment(c, refine, weights) -> None:
    """Simpson's rule with cohesion and without, on one friction force."""
    scene = wall(1, 1)
    model = scene.model(30.0, c, refine=refine)
    assert model.control_area * model.area_scale == pytest.approx(
        2.0 * np.array(weights) / sum(weights)
    )
    assert model.points == pytest.approx(np.linspace(*scene.patches.corners, len(weights)))
    assert len(model.group_first) == 1


def test_live_loads_are_those_given_as_such() -> None:
    """In the units of the load, of the moving blocks alone; none where none are given."""
    scene = bench(BENCH)
    rng = np.random.default_rng(8)
    live = 0.2 * rng.normal(size=scene.forces.shape), 0.2 * rng.normal(size=scene.forces.shape)
    each = np.ones(int(scene.patches.joint.max()) + 1)
    model = build_assembly(
        scene.patches,
        scene.fixed,
        scene.centroids,
        scene.forces + live[0],
        scene.moments + live[1],
        JointStrength(0.0 * each, each, 0.0 * each, 0.0 * each),
        False,
        live=live,
    )
    free = ~scene.fixed
    assert model.live[:, :3] * model.force_scale == pytest.approx(live[0][free])
    assert model.live[:, 3:] * model.force_scale * model.length_scale == pytest.approx(
        live[1][free]
    )
    dead = (model.load - model.live)[:, :3] * model.force_scale
    assert dead == pytest.approx(scene.forces[free], abs=1e-9 * np.abs(scene.forces).max())
    assert (scene.model(30.0).live == 0.0).all()


def test_fixed_blocks_and_bedrock_are_the_same() -> None:
    """A fixed block on the plus side of a patch: the moving side becomes the plus side, its opening stays."""
    scene = wall(2, 2)
    base = np.flatnonzero(scene.patches.minus == BEDROCK)
    on_block = replace(
        scene,
        centroids=np.concatenate([scene.centroids, [[0.0, 0.0, -5.0]]]),
        fixed=np.append(scene.fixed, True),
        forces=np.concatenate([scene.forces, [[0.0, 0.0, -1e6]]]),
        moments=np.zeros((len(scene) + 1, 3)),
        patches=replace(
            scene.patches,
            plus=np.where(
                np.isin(np.arange(len(scene.patches)), base), len(scene), scene.patches.plus
            ),
            minus=np.where(
                np.isin(np.arange(len(scene.patches)), base),
                scene.patches.plus,
                scene.patches.minus,
            ),
            normals=np.where(
                scene.patches.minus[:, None] == BEDROCK,
                -scene.patches.normals,
                scene.patches.normals,
            ),
        ),
    )
    one, other = scene.model(30.0, 2.0), on_block.model(30.0, 2.0)
    velocity = np.random.default_rng(6).normal(size=one.load.shape)
    for a, b in zip(one.opening_and_slip(velocity), other.opening_and_slip(velocity), strict=True):
        assert a == pytest.approx(b, abs=1e-12)
    assert one.load == pytest.approx(other.load)


def test_nothing_to_solve() -> None:
    scene = wall(2, 2)
    for changed in (replace(scene, fixed=~scene.fixed), replace(scene, forces=0.0 * scene.forces)):
        with pytest.raises(SolverError, match="E599"):
            changed.model(30.0)
