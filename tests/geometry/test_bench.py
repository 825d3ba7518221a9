"""Benches cut into blocks: counts and sizes by hand and by counting points, and what conserves."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from slopekit.core.errors import GeometryError
from slopekit.geometry.rock.bench import bench_body
from slopekit.geometry.rock.joint_sets import JointSet, SetPlanes, planes_of_sets
from slopekit.geometry.rock.splitting import BenchCut, cut_bench, join_slivers
from tests.geometry.test_joint_sets import BOX, EAST, FLAT, SOUTH, moved, normal, planes

SLOPE = bench_body(normal(70.0, 180.0), normal(5.0, 180.0), 20.0, 40.0, 25.0)


def three_sets(spacing: float, **scatter: float) -> list[JointSet]:
    dips = ((40.0, 175.0), (75.0, 95.0), (70.0, 350.0))
    return [
        JointSet(normal(*dip), spacing, 0.1 * k * spacing, **scatter) for k, dip in enumerate(dips)
    ]


def conserves(cut: BenchCut) -> None:
    """Volumes, areas, closed blocks, corners and centroids of patches, by other ways than the code took."""
    assembly, patches = cut.assembly, cut.assembly.patches
    assert cut.volume_error < 1e-9
    assert cut.area_error < 1e-9
    assert assembly.volumes.sum() + cut.volume_left_out == pytest.approx(cut.body_volume, rel=1e-9)
    assert (cut.blocks, cut.fixed) == (len(assembly), assembly.fixed.sum())
    if not (cut.slivers_joined or cut.slivers_left_out):
        assert patches.areas.sum() == pytest.approx(cut.joint_area, rel=1e-9)
    size = cut.body_volume ** (1.0 / 3.0)
    a, b, c = (
        assembly.vertices[assembly.triangles[:, k]] - assembly.vertices.mean(axis=0)
        for k in range(3)
    )
    vector = np.cross(b - a, c - a) / 2.0
    for k in range(3):
        assert np.abs(np.bincount(assembly.triangle_block, vector[:, k])).max() < 1e-12 * size**2
    volumes = np.bincount(assembly.triangle_block, np.einsum("ti,ti->t", a, vector) / 3.0)
    assert volumes == pytest.approx(assembly.volumes, rel=1e-9, abs=1e-12 * size**3)
    # ∫ x dV of tetrahedra from one point to all triangles
    parts = np.einsum("ti,ti->t", a, vector)[:, None] / 3.0 * (a + b + c) / 4.0
    moments = np.stack(
        [np.bincount(assembly.triangle_block, parts[:, k]) for k in range(3)], axis=1
    )
    about = assembly.centroids - assembly.vertices.mean(axis=0)
    assert moments == pytest.approx(assembly.volumes[:, None] * about, abs=1e-12 * size**4)
    assert (patches.plus != patches.minus).all()
    away = np.einsum(
        "ki,ki->k", assembly.centroids[patches.plus] - patches.centroids, patches.normals
    )
    if not cut.slivers_joined:  # blocks are convex
        assert away.min(initial=1.0) > 0.0
    for k in range(min(len(patches), 60)):
        corners = patches.corners[patches.first[k] : patches.first[k + 1]]
        assert len(corners) >= 3
        arms = corners - patches.centroids[k]
        around = np.cross(arms, np.roll(arms, -1, axis=0)) @ patches.normals[k] / 2.0
        assert around.min() > -1e-9 * size**2  # convex, in order about the normal
        assert around.sum() == pytest.approx(patches.areas[k], rel=1e-8, abs=1e-12 * size**2)
        middles = (arms + np.roll(arms, -1, axis=0)) / 3.0
        assert (around[:, None] * middles).sum(axis=0) == pytest.approx(
            np.zeros(3), abs=1e-9 * size**3
        )


def blocks_by_sampling(body, found: SetPlanes, count: int = 200_000) -> set[bytes]:
    """Different sets of planes that random points of a body lie above: cells of the arrangement."""
    rng = np.random.default_rng(0)
    points = rng.uniform(body.corners.min(axis=0), body.corners.max(axis=0), (count, 3))
    points = points[(points @ body.normals.T < body.offsets).all(axis=1)]
    above = np.packbits(points @ found.normals.T > found.offsets, axis=1)
    return {row.tobytes() for row in above}


def test_bricks() -> None:
    """A box of 30 x 20 x 10 m cut into bricks of 3 x 2 x 1 m: 1,000 of them, 2,700 patches, 8 x 9 x 9 are free.

    Ends (x), back (y, one side) and bottom (z, one side) are far.
    """
    cut = cut_bench(BOX, planes(JointSet(EAST, 3.0), JointSet(SOUTH, 2.0), JointSet(FLAT, 1.0)))
    conserves(cut)
    assert cut.blocks == 1000
    assert cut.assembly.volumes == pytest.approx(np.full(1000, 6.0), rel=1e-12)
    assert cut.blocks - cut.fixed == 8 * 9 * 9
    patches = cut.assembly.patches
    assert len(patches) == 2700
    assert np.bincount(patches.joint).tolist() == [900, 900, 900]
    for joint, area in enumerate((2.0, 3.0, 6.0)):
        assert patches.areas[patches.joint == joint] == pytest.approx(np.full(900, area), rel=1e-12)
    assert np.diff(patches.first).tolist() == [4] * 2700
    step = cut.assembly.centroids[patches.plus] - cut.assembly.centroids[patches.minus]
    assert np.einsum("ki,ki->k", step, patches.normals) == pytest.approx(
        np.array([3.0, 2.0, 1.0])[patches.joint]
    )


@pytest.mark.parametrize(
    "scatter", [{}, {"scatter_deg": 3.0, "spacing_scatter": 0.2}, {"scatter_deg": 20.0}]
)
def test_counts_by_sampling(scatter) -> None:
    """Each cell that random points find is a block, each large block is found, and Euler's count is exact."""
    found = planes_of_sets(three_sets(5.0, **scatter), SLOPE, np.random.default_rng(3))
    cut = cut_bench(SLOPE, found, min_volume=1e-12)
    conserves(cut)
    sampled = len(blocks_by_sampling(SLOPE, found))
    assert (cut.assembly.volumes > 3.0).sum() <= sampled  # 7 points per m³
    assert sampled <= cut.blocks + cut.slivers_joined
    assert cut.assembly.volumes.sum() == pytest.approx(ConvexHull(SLOPE.corners).volume, rel=1e-12)
    assert cut.plane_error < 1e-12 * SLOPE.size
    # Euler: what general planes cut is 1 + planes + lines + points within the body, whatever is small
    assert cut.blocks + cut.slivers_joined == 1 + len(found) + _lines_and_points(SLOPE, found)


def _lines_and_points(body, found: SetPlanes) -> int:
    """Pairs and triples of planes that meet within a convex body, by linear algebra on every one of them."""
    from itertools import combinations

    inside = 0
    for i, j in combinations(range(len(found)), 2):
        along = np.cross(found.normals[i], found.normals[j])
        if along @ along < 1e-20:
            continue
        start = np.linalg.lstsq(found.normals[[i, j]], found.offsets[[i, j]], rcond=None)[0]
        rate, room = body.normals @ along, body.offsets - body.normals @ start
        low, high = (room[rate < 0] / rate[rate < 0]).max(), (room[rate > 0] / rate[rate > 0]).min()
        if low < high:
            with np.errstate(divide="ignore"):  # planes of one set meet the line nowhere
                at = (found.offsets[j + 1 :] - found.normals[j + 1 :] @ start) / (
                    found.normals[j + 1 :] @ along
                )
            inside += 1 + int(((at > low) & (at < high)).sum())
    return inside


def test_planes_through_one_line_and_one_point() -> None:
    """Upright planes at 60° through one line make 6 wedges, a level plane through the line 12.

    A plane through the same point, dipping 30°, is cut in 8 by the 4 lines in which it meets the others, and each of
    its 8 parts cuts a cell in two: 20.
    """
    body = bench_body(SOUTH, FLAT, 10.0, 40.0, 20.0)
    centre = np.array([0.0, 10.0, 5.0])
    normals = np.array(
        [[math.cos(a), math.sin(a), 0.0] for a in (0.1, 0.1 + math.pi / 3, 0.1 + 2 * math.pi / 3)]
    )
    for extra, count in (([], 6), ([FLAT], 12), ([FLAT, normal(30.0, 40.0)], 20)):
        together = np.array([*normals, *extra])
        sets = [JointSet(one, 1000.0, float(one @ centre)) for one in together]
        cut = cut_bench(body, planes_of_sets(sets, body, np.random.default_rng(0)))
        conserves(cut)
        assert cut.blocks == count


@pytest.mark.parametrize("apart_deg", [1.0, 0.01, 1e-4])
def test_nearly_parallel_sets(apart_deg) -> None:
    """Two sets that cross at a small angle in the middle of the bench, and one across: nothing is lost."""
    first, second = normal(60.0, 180.0), normal(60.0 + apart_deg, 180.0)
    at = np.array([0.0, 12.0, 8.0])
    sets = [JointSet(one, 3.0, float(one @ at)) for one in (first, second)]
    found = planes_of_sets(
        [*sets, JointSet(normal(80.0, 90.0), 4.0)], SLOPE, np.random.default_rng(0)
    )
    cut = cut_bench(SLOPE, found)
    conserves(cut)
    assert cut.blocks > 100


def test_the_same_twice_is_the_same() -> None:
    sets = three_sets(5.0, scatter_deg=3.0)
    rng = np.random.default_rng
    first, again = (cut_bench(SLOPE, planes_of_sets(sets, SLOPE, rng(3))) for _ in range(2))
    other = cut_bench(SLOPE, planes_of_sets(sets, SLOPE, rng(4)))
    assert (first.assembly.volumes == again.assembly.volumes).all()
    assert (first.assembly.patches.corners == again.assembly.patches.corners).all()
    assert first.blocks != other.blocks


def test_duplicate_sets() -> None:
    sets = three_sets(5.0)
    alone = cut_bench(SLOPE, planes(*sets, body=SLOPE))
    twice = cut_bench(
        SLOPE,
        planes(*sets, replace(sets[1], normal=-sets[1].normal, offset=-sets[1].offset), body=SLOPE),
    )
    assert twice.blocks == alone.blocks
    assert twice.assembly.volumes == pytest.approx(alone.assembly.volumes, rel=1e-12)


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_moved_and_scaled(factor) -> None:
    """Map coordinates and another unit of length change nothing; 4e6 m carry 1e-9 m, blocks are 5 m."""
    sets = three_sets(5.0)
    here = cut_bench(SLOPE, planes(*sets, body=SLOPE))
    by = np.array([5e5, 4e6, 300.0])
    body = bench_body(
        normal(70.0, 180.0), normal(5.0, 180.0), 20.0 * factor, 40.0 * factor, 25.0 * factor
    )
    scaled = [
        replace(
            one,
            spacing=one.spacing * factor,
            offset=one.offset * factor + float(one.normal @ by) * (factor == 1.0),
        )
        for one in sets
    ]
    there = cut_bench(
        moved(body, by) if factor == 1.0 else body,
        planes(*scaled, body=moved(body, by) if factor == 1.0 else body),
    )
    assert there.blocks == here.blocks
    assert (there.assembly.fixed == here.assembly.fixed).all()
    assert there.assembly.volumes == pytest.approx(here.assembly.volumes * factor**3, rel=1e-6)
    assert (there.assembly.patches.plus == here.assembly.patches.plus).all()


def test_slivers() -> None:
    """Three columns, cut level, with a sheet of 1 cm (2 m³) between: it goes to the block above or below."""
    sets = [JointSet(FLAT, 100.0, 5.0), JointSet(FLAT, 100.0, 5.01), JointSet(EAST, 10.0, 5.0)]
    found = planes(*sets)
    whole = cut_bench(BOX, found)
    assert (whole.blocks, whole.slivers_joined) == (9, 0)
    assert cut_bench(BOX, found, min_volume=1.99).blocks == 9
    cut = cut_bench(BOX, found, min_volume=2.01)
    conserves(cut)
    assert (cut.blocks, cut.slivers_joined, cut.slivers_left_out) == (6, 3, 0)
    patches = cut.assembly.patches
    level = patches.joint < 2
    assert level.sum() == 3  # one of the two joints has vanished within a block of each column
    assert patches.areas[level] == pytest.approx([200.0] * 3)
    by_column = (
        cut.assembly.volumes[patches.plus[level]] + cut.assembly.volumes[patches.minus[level]]
    )
    assert by_column == pytest.approx([2000.0] * 3)
    assert patches.areas[~level].sum() == pytest.approx(2 * 200.0)
    with pytest.raises(GeometryError, match="E225"):
        cut_bench(BOX, found, min_volume=1e6)
    with pytest.raises(
        GeometryError, match="E225 min_volume = 5000 m³ joins all 9 blocks into one, on no"
    ):
        cut_bench(
            BOX, found, min_volume=5000.0
        )  # of 6000: it was a block that falls, with no contact


def test_slivers_that_choose() -> None:
    """Two slivers beside each other go together to the cell behind; one without neighbours is left out."""
    volumes = np.array([1.0, 1e-12, 2e-12, 1e-12])
    first, second, areas = np.array([0, 1]), np.array([1, 2]), np.array([1.0, 5.0])
    block, fixed = join_slivers(
        volumes, np.array([False, True, True, True]), first, second, areas, 1e-9
    )
    assert block.tolist() == [0, 0, 0, -1]
    assert fixed.tolist() == [False]


def test_fixed_slivers_stay_fixed() -> None:
    """A sliver at the end of the model belongs to the rock there, though it shares more with a free block."""
    first, second, areas = np.array([0, 1]), np.array([1, 2]), np.array([5.0, 1.0])
    block, _ = join_slivers(
        np.array([1.0, 1e-12, 1.0]), np.array([False, True, True]), first, second, areas, 1e-9
    )
    assert block.tolist() == [0, 1, 1]


def test_slivers_that_are_no_sliver_together_stay_bedrock() -> None:
    """Two ends on a larger free piece: rock that goes on where they hold what is asked, or half of what they make."""
    ends = np.array([True, False, True])
    first, second, areas = np.array([0, 1]), np.array([1, 2]), np.array([1.0, 1.0])
    for end, least, bedrock in (
        (24.0, 48.0, True),
        (24.0, 48.1, False),
        (24.9, 60.0, False),
        (25.1, 60.0, True),
    ):
        volumes = np.array([end, 100.0 - 2.0 * end, end])
        block, fixed = join_slivers(volumes, ends, first, second, areas, least)
        assert (block.tolist(), fixed.tolist()) == ([0, 0, 0], [bedrock])
    block, fixed = join_slivers(np.array([0.3, 40.0, 0.3]), ends, first, second, areas, 1.0)
    assert (block.tolist(), fixed.tolist()) == ([0, 0, 0], [False])


def test_max_blocks() -> None:
    sets = (JointSet(EAST, 3.0), JointSet(SOUTH, 2.0), JointSet(FLAT, 1.0))
    assert cut_bench(BOX, planes(*sets), max_blocks=1000).blocks == 1000
    with pytest.raises(GeometryError, match=r"E220 .* 1,000 blocks, more than max_blocks = 999"):
        cut_bench(BOX, planes(*sets), max_blocks=999)
    fine = [replace(one, spacing=one.spacing / 5.0, offset=0.01) for one in sets]
    with pytest.raises(
        GeometryError, match=r"about 1\d\d,\d\d\d blocks, more than max_blocks = 20,000"
    ):
        cut_bench(BOX, planes(*fine))


def test_no_joint_in_the_bench() -> None:
    cut = cut_bench(BOX, planes(JointSet(EAST, 1000.0, 500.0)))
    assert (cut.blocks, cut.fixed, len(cut.assembly.patches), cut.area_error) == (1, 1, 0, 0.0)
    assert cut.assembly.centroids[0] == pytest.approx([0.0, 10.0, 5.0])


orientations = st.tuples(st.floats(0.0, 90.0), st.floats(0.0, 360.0))


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.tuples(orientations, st.floats(4.0, 30.0), st.floats(-10.0, 10.0)),
        min_size=1,
        max_size=5,
    ),
    st.sampled_from([0.0, 0.0, 2.0, 10.0]),
    st.sampled_from([0.0, 1.0, 50.0]),
    st.integers(0, 5),
)
def test_nothing_is_lost(sets, scatter_deg, min_volume, seed) -> None:
    joints = [JointSet(normal(*dip), spacing, offset, scatter_deg) for dip, spacing, offset in sets]
    found = planes_of_sets(joints, SLOPE, np.random.default_rng(seed))
    try:
        cut = cut_bench(SLOPE, found, min_volume=min_volume)
    except (
        GeometryError
    ) as refused:  # one joint alone, that cuts off less than min_volume: no joint is left
        if min_volume == 0.0 or refused.codes != ("E225",):
            raise
    else:
        conserves(cut)


def test_blocks_that_do_not_add_up_are_refused(monkeypatch) -> None:
    """E224 is the last line of defence: faces that lie off their planes are noticed."""
    from slopekit.geometry.rock import splitting

    body = bench_body(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 9.0, 9.0, 9.0)
    planes = planes_of_sets([JointSet(np.eye(3)[2], spacing=3.0)], body, np.random.default_rng(0))
    monkeypatch.setattr(splitting, "OFF_PLANE", -1.0)
    with pytest.raises(GeometryError) as error:
        cut_bench(body, planes)
    assert error.value.faults[0].code == "E224"
