"""The pressed part of contacts: against random points, central differences, and clipping of their polygons."""

import math

import numpy as np
import pytest

from slopekit.geometry.patches import BEDROCK, Patches
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.many_blocks.debonding import debonding_limit
from slopekit.preie.system.contact_cells import pressed_fraction
from slopekit.preie.system.patch_pairs import polygon_pairs
from tests.preie.block_scenes import Scene, boxes_in_space, rectangles, stack
from tests.preie.pressed import pressed_part, pressed_shares, pressed_shares_of_pairs

POINTS = 200_000  # random ones of a cell: a share is known to four standard deviations, 0.0045


def random_gaps(corners: int) -> np.ndarray:
    """Gaps (60, corners) of which some are all negative, some all positive, and of most one corner differs."""
    gaps = np.random.default_rng(3).normal(size=(60, corners))
    gaps[0], gaps[1] = np.abs(gaps[0]), -np.abs(gaps[1])
    return gaps


@pytest.mark.parametrize("corners", [2, 3])
def test_the_pressed_part_of_a_cell_is_that_of_random_points_in_it(corners) -> None:
    """Barycentric coordinates of points spread evenly are those of sorted random numbers' gaps."""
    rng, gaps = np.random.default_rng(7), random_gaps(corners)
    weights = np.diff(
        np.sort(rng.random((POINTS, corners - 1)), axis=1), prepend=0.0, append=1.0, axis=1
    )
    fraction, _ = pressed_fraction(gaps)
    assert (fraction[0], fraction[1]) == (0.0, 1.0)
    counted = (weights @ gaps.T < 0.0).mean(axis=0)
    assert fraction == pytest.approx(counted, abs=4.0 * 0.5 / math.sqrt(POINTS))


@pytest.mark.parametrize("corners", [2, 3])
def test_the_slopes_of_the_pressed_part_are_its_derivatives(corners) -> None:
    gaps, step = random_gaps(corners), 1e-6
    _, slopes = pressed_fraction(gaps)
    for corner in range(corners):
        moved = step * (np.arange(corners) == corner)
        ahead, behind = (pressed_fraction(gaps + sign * moved)[0] for sign in (1.0, -1.0))
        smooth = np.abs(gaps).min(axis=1) > 1e-3
        assert slopes[smooth, corner] == pytest.approx(
            ((ahead - behind) / (2.0 * step))[smooth], rel=1e-5, abs=1e-8
        )
    assert (slopes[:2] == 0.0).all()


def test_a_corner_that_just_touches_has_finite_slopes() -> None:
    fraction, slopes = pressed_fraction(
        np.array([[0.0, 1.0, 2.0], [0.0, -1.0, -2.0], [0.0, 0.0, -1.0], [0.0] * 3])
    )
    assert fraction.tolist() == [0.0, 1.0, 1.0, 0.0]
    assert np.isfinite(slopes).all()


def polygon(corners: int, normal: np.ndarray) -> Patches:
    """A contact whose corners lie on an ellipse at uneven angles, in a plane of any normal."""
    rng = np.random.default_rng(corners)
    angles = np.sort(rng.random(corners)) * 2.0 * math.pi
    first = np.cross(normal, [0.3, 1.0, 0.2])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    at = (
        3.0 * np.cos(angles)[:, None] * first
        + 2.0 * np.sin(angles)[:, None] * second
        + np.array([5.0, -2.0, 1.0])
    )
    one = np.zeros(1, dtype=np.int64)
    area = pressed_area(at, normal)
    return Patches(
        one,
        one + BEDROCK,
        one,
        normal[None],
        np.array([area]),
        at.mean(axis=0)[None],
        at,
        np.array([0, corners]),
    )


def pressed_area(corners: np.ndarray, normal: np.ndarray) -> float:
    crossed = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)
    return abs(float(crossed @ normal)) / 2.0


@pytest.mark.parametrize("refine", [0, 1])
@pytest.mark.parametrize("corners", [3, 4, 5, 7])
def test_a_contact_that_turns_is_pressed_on_the_part_that_clipping_leaves(corners, refine) -> None:
    """Its gap is a closing at the centroid and a rotation about two axes; of all node pairs together."""
    rng = np.random.default_rng(11)
    normal = np.array([0.48, 0.6, 0.64])
    patches = polygon(corners, normal)
    first = np.cross(normal, [1.0, 0.0, 0.0])
    first /= np.linalg.norm(first)
    axes = np.stack([normal, first, np.cross(normal, first)])
    points, _, areas, cells = polygon_pairs(patches, np.array([0]), np.array([refine]))
    assert np.bincount(cells.groups.ravel(), cells.cohesion_shares.ravel()) == pytest.approx(
        1.0, rel=1e-12
    )
    flat, at = ((there - patches.centroids[0]) @ axes[1:].T for there in (patches.corners, points))
    none = np.zeros(len(at))
    rows = np.stack([none + 1.0, none, none, none, at[:, 1] / 2.0, -at[:, 0] / 2.0], axis=1)

    def pressed(motion: np.ndarray) -> tuple[float, np.ndarray]:
        share, slopes = cells.pressed_share(
            rows @ motion - 1e-9, rows, len(points)
        )  # what just touches is pressed
        return areas @ share / areas.sum(), areas @ slopes / areas.sum()

    partly = 0
    for _ in range(40):
        motion = np.zeros(6)
        motion[[0, 4, 5]] = rng.normal(size=3) * [0.5, 1.0, 1.0]
        motion[[1, 2, 3]] = rng.normal(size=3)  # slip and drilling open nothing
        # a rotation (θ1, θ2) about the tangents, of arms (y1, y2): the gap is n + θ1 y2 - θ2 y1
        gaps = motion[0] + (motion[4] * flat[:, 1] - motion[5] * flat[:, 0]) / 2.0
        share, slopes = pressed(motion)
        exact = pressed_part(flat, gaps - 1e-9)
        partly += 0.0 < exact < 1.0
        assert share == pytest.approx(exact, abs=1e-9)
        step = 1e-6
        for unknown in range(6):
            moved = step * (np.arange(6) == unknown)
            ahead, behind = (pressed(motion + sign * moved)[0] for sign in (1.0, -1.0))
            assert slopes[unknown] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-5)
    assert partly > 10


@pytest.mark.parametrize("refine", [1, 2])
def test_node_pairs_have_cohesion_where_the_contact_is_pressed_near_them(refine) -> None:
    """A square lifted on one half, in numbers: the cohesive force acts in the middle of the pressed half."""
    square = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]])
    one = np.zeros(1, dtype=np.int64)
    patches = Patches(
        one,
        one + BEDROCK,
        one,
        np.array([[0.0, 0.0, 1.0]]),
        np.array([4.0]),
        square.mean(axis=0)[None],
        square,
        np.array([0, 4]),
    )
    points, _, areas, cells = polygon_pairs(patches, np.array([0]), np.array([refine]))
    share, _ = cells.pressed_share(points[:, 0] - 1.0, np.zeros((len(points), 6)), len(points))
    acts = areas * share
    assert acts.sum() == pytest.approx(2.0, rel=1e-9)
    assert points[:, 0] @ acts / acts.sum() == pytest.approx(0.5, abs=0.4 * 0.5 ** (2 * refine))
    open_ones = (
        points[:, 0] >= 1.0 + 2.0 * 0.5**refine
    )  # no cell reaches so far from what is pressed
    assert open_ones.any()
    assert (share[open_ones] == 0.0).all()


def test_cells_of_some_blocks_keep_their_shares() -> None:
    model = boxes_in_space((2, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3).model(30.0, 1.0)
    few, _, pairs, groups = model.restricted_to(np.array([0, 3]))
    gaps = np.random.default_rng(2).normal(size=len(model.control_area))
    share, slopes = model.cells.pressed_share(gaps, model.normal_rows, len(model.group_first))
    of_some, slopes_of_some = few.cells.pressed_share(gaps[pairs], few.normal_rows, len(groups))
    np.testing.assert_array_equal(of_some, share[groups])
    np.testing.assert_array_equal(slopes_of_some, slopes[groups])


SCENES = {
    "section": lambda: stack(3, 25.0, 4.0),
    "columns": lambda: rectangles([(0, 1, 0, 2), (1, 3, 0, 3), (3, 4, 0, 1)], 30.0),
    "space": lambda: boxes_in_space((2, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3),
}


def partly_open(scene: Scene, cohesion: float) -> tuple[ElasticContactModel, np.ndarray]:
    """Joints with cohesion, and a displacement at which contacts that slip are pressed in part."""
    model = scene.model(30.0, cohesion)
    bed, rng = ElasticContactModel(model, Drive(model.load.ravel())), np.random.default_rng(4)
    mean = np.abs(bed.elastic_displacement).mean()
    step = 1e-5 * mean
    for _ in range(400):
        at = bed.elastic_displacement + 1.5 * mean * rng.normal(size=bed.size)
        there = bed.forces(at, 0.6)
        share = there.pressed.share
        slips = there.slips
        near = [bed.forces(at + 10.0 * step * rng.normal(size=bed.size), 0.6) for _ in range(20)]
        if (slips & (share > 0.05) & (share < 0.95)).sum() > 1 and all(
            there.same_modes(other) for other in near
        ):
            return bed, at
    raise AssertionError("no such displacement")


@pytest.mark.parametrize("cohesion", [1.0, 100.0])
@pytest.mark.parametrize("name", SCENES)
def test_the_tangent_with_cohesion_of_a_part_is_the_derivative_of_the_forces(
    name, cohesion, kernels
) -> None:
    """Central differences; with 100 kPa nearly all of the friction is cohesion of the pressed parts."""
    bed, at = partly_open(SCENES[name](), cohesion)
    there, step = bed.forces(at, 0.6), 1e-5 * np.abs(bed.elastic_displacement).mean()
    matrix, rng = bed.stiffness.dense(bed.tangent(there, 0.6)), np.random.default_rng(5)
    for _ in range(6):
        way = rng.normal(size=bed.size)
        ahead, behind = (bed.forces(at + sign * step * way, 0.6).unbalanced for sign in (1.0, -1.0))
        slope = (ahead - behind) / (2.0 * step)
        assert -matrix @ way == pytest.approx(slope, abs=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize("name", SCENES)
def test_forces_have_the_cohesion_of_what_clipping_leaves(name, kernels) -> None:
    scene = SCENES[name]()
    bed, at = partly_open(scene, 5.0)
    there = bed.forces(at, 0.6)
    opening, _ = bed.model.opening_and_slip(at)
    exact, model = pressed_shares(scene.patches, bed.model, opening - 1e-9), bed.model
    of_pairs = pressed_shares_of_pairs(scene.patches, model, opening - 1e-9)
    assert there.pressed.share == pytest.approx(of_pairs, abs=1e-9)
    areas = model.by_group(model.control_area)
    parts = [
        np.bincount(model.group_contact, weights)
        for weights in (areas * there.pressed.share, areas)
    ]
    assert parts[0] / parts[1] == pytest.approx(exact, abs=1e-9)


def test_cohesion_that_is_kept_acts_wherever_the_blocks_go() -> None:
    bed, at = partly_open(SCENES["space"](), 5.0)
    share = bed.forces(at, 0.6).pressed.share
    kept = bed.with_pressed_cohesion(at, 0.6)
    for displacement in (at, 3.0 * at, -at):
        there = kept.forces(displacement, 0.6)
        friction = bed.model.tan_friction * bed.model.by_group(there.normal)
        cohesive = bed.model.by_group(bed.model.cohesion) * share
        assert there.strength == pytest.approx(friction + cohesive, rel=1e-12, abs=1e-15)
    assert kept.forces(at, 0.6).unbalanced == pytest.approx(
        bed.forces(at, 0.6).unbalanced, rel=1e-9, abs=1e-12
    )


# -- progressive slip and debonding ------------------------------------------------------------------------------------


@pytest.mark.parametrize("space", [False, True])
def test_a_bonded_block_debonds_nowhere_and_slides_at_its_closed_form(space) -> None:
    """(c A + W cos β tan φ) / (W sin β): a flat block on 20° is pressed all over until it slides."""
    scene = boxes_in_space((1, 1, 1), (6.0, 6.0, 0.5), 20.0) if space else stack(1, 20.0, 6.0, 0.5)
    weight, area = -float(scene.forces[0, 2]), float(scene.patches.areas[0])
    dip, cohesion = math.radians(20.0), 3.0
    exact = (cohesion * area + weight * math.cos(dip) * math.tan(math.radians(35.0))) / (
        weight * math.sin(dip)
    )
    stable, fails = debonding_limit(scene.model(35.0, cohesion), exact)
    assert stable < exact < fails < 1.0035 * stable


@pytest.mark.parametrize("cohesion", [5.0, 500.0])
def test_a_face_that_nothing_presses_holds_no_block_back(cohesion) -> None:
    """Two blocks beside each other slide down 20° together: nothing presses the bonded face between."""
    model = rectangles([(0, 2, 0, 1), (2, 4, 0, 1)], 20.0, joint_of_base=1).model(
        [30.0, 25.0], [cohesion, 0.0]
    )
    exact = math.tan(math.radians(25.0)) / math.tan(math.radians(20.0))
    stable, fails = debonding_limit(model, exact)
    assert stable < exact < fails < 1.0035 * stable


def test_contacts_that_have_opened_have_no_cohesion_where_they_are_pressed_again() -> None:
    bed, at = partly_open(SCENES["space"](), 5.0)
    share, contact = bed.forces(at, 0.6).pressed.share, bed.model.group_contact
    gone = np.bincount(contact, share) > 0.5 * np.bincount(contact)
    of_gone = gone[contact]
    assert gone.any()
    assert (share[~of_gone] > 0.0).any()
    there = bed.without_cohesion_where(gone).forces(at, 0.6)
    assert there.pressed.share == pytest.approx(np.where(of_gone, 0.0, share), abs=1e-15)
    friction = bed.model.tan_friction * bed.model.by_group(there.normal)
    assert there.strength[of_gone] == pytest.approx(friction[of_gone], rel=1e-12)
    assert (there.pressed.slopes[of_gone] == 0.0).all()
