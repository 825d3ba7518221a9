"""Contacts of polygons in a section against lengths counted by hand: walls, L shapes, T-junctions, overlaps, gaps."""

import itertools
import math

import numpy as np
import pytest

from slopekit.core.errors import GeometryError
from slopekit.geometry.rock import box_search
from slopekit.geometry.rock.box_search import box_pairs
from slopekit.geometry.sections.clipping import clip_convex, polygon_sums
from slopekit.geometry.sections.section_blocks import section_assembly

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
L_SHAPE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])


def rectangle(x0: float, z0: float, x1: float, z1: float):
    return np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])


def running_bond(courses: int, per_course: int):
    """A base one block longer than the wall at each end; blocks 2 m x 1 m, half blocks at the ends of odd courses."""
    blocks = [rectangle(-2.0, -1.0, 2.0 * per_course + 2.0, 0.0)]
    for course in range(courses):
        joints = np.arange(0.0, 2.0 * per_course + 1.0, 2.0)
        if course % 2:
            joints = np.concatenate([[0.0], joints[:-1] + 1.0, [2.0 * per_course]])
        blocks += [rectangle(a, course, b, course + 1.0) for a, b in itertools.pairwise(joints)]
    return blocks


def turned(polygons, degrees: float, shift):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [polygon @ np.array([[c, s], [-s, c]]) + shift for polygon in polygons]


def assemble(polygons, thickness: float = 1.0, tolerance: float | None = None):
    return section_assembly(polygons, np.arange(len(polygons)) == 0, thickness, tolerance)


@pytest.mark.parametrize("degrees", [0.0, 20.0])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (500000.0, 4.0e6)], ids=["local", "UTM"])
def test_running_bond_wall(degrees, shift) -> None:
    """Ten courses of ten: heads 5 x 9 + 5 x 10, beds 10 on the base and 9 x 20 half blocks; UTM is exact to 5e-10 m."""
    thickness = 1.5
    cut = assemble(turned(running_bond(10, 10), degrees, shift), thickness)
    patches, digits = cut.assembly.patches, 1e-9 if shift[0] else 1e-12
    heads, beds = 5 * 9 + 5 * 10, 10 + 9 * 20
    assert len(patches) == heads + beds
    assert cut.contact == pytest.approx(heads + 20.0 * 10, rel=digits)
    assert patches.areas.sum() == pytest.approx(thickness * (heads + 200.0), rel=digits)
    assert cut.assembly.volumes == pytest.approx(
        thickness * np.array([24.0] + ([2.0] * 10 + [1.0] + [2.0] * 9 + [1.0]) * 5), rel=digits * 10
    )
    assert (len(cut.overlaps), len(cut.gaps), cut.point_contacts, len(cut.untouching)) == (
        0,
        0,
        0,
        0,
    )


def test_length_of_internal_edges_is_that_of_the_contacts() -> None:
    """All edges less twice the contacts is what is open to the air: base 24 + 2 x 1 + 4, wall 20 + 2 x 10."""
    cut = assemble(turned(running_bond(10, 10), 20.0, (3.0, -2.0)))
    edges = sum(
        float(np.linalg.norm(one - np.roll(one, 1, axis=0), axis=1).sum()) for one in cut.outlines
    )
    assert edges - 2.0 * cut.contact == pytest.approx(24.0 + 2.0 + 4.0 + 20.0 + 20.0, rel=1e-12)


def test_patch_between_base_and_block() -> None:
    """Both ends, normal into the block that is not fixed, at the user's coordinates."""
    (base, block), origin = (
        turned([rectangle(-5.0, -1.0, 5.0, 0.0), SQUARE], 30.0, (7.0, 9.0)),
        np.array([7.0, 9.0]),
    )
    e_x = np.array([math.cos(math.pi / 6), math.sin(math.pi / 6)])
    for blocks, fixed in (((base, block), (True, False)), ((block, base), (False, True))):
        patches = section_assembly(blocks, np.array(fixed), 1.0).assembly.patches
        assert (patches.plus.tolist(), patches.minus.tolist()) == (
            [fixed.index(False)],
            [fixed.index(True)],
        )
        assert patches.normals[0] == pytest.approx([-0.5, 0.0, math.sqrt(0.75)])
        corners = sorted(patches.corners[:, [0, 2]].tolist())
        assert corners == pytest.approx(np.array([origin, origin + e_x]))
        assert patches.centroids[0, [0, 2]] == pytest.approx(origin + e_x / 2.0)
        assert patches.first.tolist() == [0, 2]


def test_both_ways_round_and_needless_corners_are_the_same() -> None:
    """Corners repeated, on a straight line, or out and back along a spike change nothing."""
    plain = [rectangle(-3.0, -1.0, 3.0, 0.0), SQUARE, SQUARE + np.array([1.0, 0.0])]
    needless = np.array(
        [
            [0.0, 0.0],
            [0.0, 0.0],
            [0.3, 0.0],
            [0.6, 0.0],
            [1.0, 0.0],
            [1.0, 0.5],
            [1.5, 0.5],
            [1.0, 0.5],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.0, 0.0],
        ]
    )
    expected = assemble(plain).assembly
    for other in (
        [polygon[::-1] for polygon in plain],
        [plain[0], needless, plain[2]],
        [plain[0], needless[::-1], plain[2][::-1]],
        [np.roll(polygon, 2, axis=0) for polygon in plain],
    ):
        found = assemble(other).assembly
        for name in ("plus", "minus", "normals", "areas", "centroids"):
            assert getattr(found.patches, name) == pytest.approx(
                getattr(expected.patches, name), abs=1e-12
            ), name
        assert found.volumes == pytest.approx(expected.volumes)
        assert found.centroids == pytest.approx(expected.centroids)


def test_l_shapes() -> None:
    """Area 3, centroid 5/6 (two rectangles by hand); a block between two of them touches each along 2 m."""
    other = np.array([3.0, 3.0]) - L_SHAPE
    filler = np.array([[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]])
    cut = assemble([L_SHAPE, filler, other])
    assert cut.assembly.volumes == pytest.approx([3.0, 1.0, 3.0])
    assert cut.assembly.centroids[0] == pytest.approx([5.0 / 6.0, 0.0, 5.0 / 6.0])
    assert (cut.contact, cut.point_contacts, len(cut.overlaps)) == (pytest.approx(4.0), 1, 0)
    locked = assemble([L_SHAPE, L_SHAPE + np.array([1.0, 1.0])])
    assert locked.contact == pytest.approx(2.0)
    assert len(locked.assembly.patches) == 2
    assert len(locked.overlaps) == 0


def test_t_junction_and_corners() -> None:
    """Two blocks on a third; a fourth touches the second with a corner only and the others not at all."""
    blocks = [
        rectangle(0.0, -1.0, 2.0, 0.0),
        SQUARE,
        SQUARE + np.array([1.0, 0.0]),
        SQUARE + np.array([2.0, 1.0]),
        SQUARE + np.array([9.0, 9.0]),
    ]
    cut = assemble(blocks)
    assert sorted(
        zip(cut.assembly.patches.minus.tolist(), cut.assembly.patches.plus.tolist(), strict=True)
    ) == [
        (0, 1),
        (0, 2),
        (1, 2),
    ]
    assert cut.point_contacts == 1
    assert cut.untouching.tolist() == [3, 4]


def test_corner_on_an_edge_is_a_point_contact() -> None:
    tip = np.array([[1.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    cut = assemble([rectangle(0.0, -1.0, 2.0, 0.0), tip])
    assert (len(cut.assembly.patches), cut.point_contacts, len(cut.overlaps)) == (0, 1, 0)


@pytest.mark.parametrize("degrees", [0.0, 37.0])
def test_overlaps_have_their_area(degrees) -> None:
    """2 mm along 1 m, a corner 0.3 x 0.4 m, and a block within another."""
    blocks = [
        rectangle(0.0, 0.0, 3.0, 1.0),
        rectangle(3.0 - 0.002, 0.0, 5.0, 1.0),
        rectangle(-0.7, 0.6, 0.3, 1.6),
        rectangle(1.0, 0.25, 1.5, 0.75),
    ]
    cut = assemble(turned(blocks, degrees, (100.0, 5.0)), 3.0)
    assert cut.overlaps.pairs.tolist() == [[0, 1], [0, 2], [0, 3]]
    assert cut.overlaps.amounts == pytest.approx([0.002, 0.12, 0.25], rel=1e-9)
    assert cut.overlaps.distances[0] == pytest.approx(0.002, rel=3e-3)


def test_overlap_of_blocks_that_are_not_convex() -> None:
    """A bar through a comb with five teeth: 5 x 0.5 x 0.2."""
    comb = [[0.0, 0.0], [9.5, 0.0], [9.5, 0.5]]
    for x in (8.5, 6.5, 4.5, 2.5, 0.5):
        comb += [[x + 0.5, 0.5], [x + 0.5, 3.0], [x, 3.0], [x, 0.5]]
    comb += [[0.0, 0.5]]
    cut = assemble([np.array(comb), rectangle(-1.0, 2.0, 11.0, 2.2)])
    assert cut.overlaps.amounts == pytest.approx([5 * 0.5 * 0.2])


def test_gaps_have_their_width_and_length() -> None:
    """2 mm along 3 m; opening from 0 to 4 mm along 2 m; 0.5 m is none, and a joint that a thin block fills is none."""
    wedge = np.array([[3.002, 0.0], [5.0, 0.0], [5.0, 3.0], [3.002, 3.0]])
    cut = assemble([rectangle(0.0, 0.0, 3.0, 3.0), wedge, rectangle(5.5, 0.0, 8.0, 3.0)])
    assert cut.gaps.pairs.tolist() == [[0, 1]]
    assert cut.gaps.distances[0] == pytest.approx(0.002)
    assert cut.gaps.amounts == pytest.approx([3.0])
    tilted = np.array([[0.0, 1.0], [2.0, 1.004], [2.0, 2.0], [0.0, 2.0]])
    cut = assemble([rectangle(0.0, 0.0, 2.0, 1.0), tilted])
    assert cut.gaps.distances[0] == pytest.approx(0.004, abs=1e-5)
    assert cut.gaps.amounts == pytest.approx([2.0], rel=1e-5)
    assert len(cut.assembly.patches) == 0
    filled = assemble([rectangle(0.0, 0.0, 3.0, 3.0), wedge, rectangle(3.0, 0.0, 3.002, 3.0)])
    assert len(filled.gaps) == 0
    assert filled.contact == pytest.approx(6.0)


def test_tolerance_decides_what_touches() -> None:
    """Blocks 2 mm apart touch at 3 mm, halfway between; the normal of edges out of parallel lies between theirs."""
    blocks = [
        rectangle(0.0, 0.0, 2.0, 1.0),
        np.array([[0.0, 1.0], [2.0, 1.004], [2.0, 2.0], [0.0, 2.0]]),
    ]
    assert len(assemble(blocks, tolerance=0.003).assembly.patches) == 0
    patches = assemble(blocks, tolerance=0.005).assembly.patches
    assert len(patches) == 1
    angle = math.atan(0.002) / 2.0
    assert patches.normals[0] == pytest.approx([-math.sin(angle), 0.0, math.cos(angle)], abs=1e-8)
    assert patches.centroids[0] == pytest.approx([1.0, 0.0, 1.001], abs=2e-6)
    apart = [SQUARE, SQUARE + np.array([0.0, 1.002])]
    assert len(assemble(apart).assembly.patches) == 0
    closed = assemble(apart, tolerance=0.003).assembly.patches
    assert closed.centroids[0] == pytest.approx([0.5, 0.0, 1.001])
    within = assemble([SQUARE, SQUARE + np.array([0.0, 0.998])], tolerance=0.003)
    assert len(within.assembly.patches) == 1
    assert len(within.overlaps) == 0


@pytest.mark.parametrize(
    ("polygon", "code"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "E227"),
        ([[0, 0], [4, 0], [4, 2], [1, -1], [0, 2]], "E227"),
        ([[0, 0], [4, 0], [4, 2], [2, 0], [0, 2]], "E227"),
        (
            [[math.cos(4 * math.pi * k / 5), math.sin(4 * math.pi * k / 5)] for k in range(5)],
            "E227",
        ),
        ([[0, 0], [1, 1], [2, 2]], "E227"),
        ([[0, 0], [1e-7, 0], [0, 1e-7]], "E227"),
        ([[0, 0], [3e-4, 0], [0, 3e-4]], "E230"),
    ],
)
def test_outlines_that_are_no_blocks(polygon, code) -> None:
    with pytest.raises(GeometryError) as caught:
        section_assembly(
            [SQUARE * 10.0, polygon], np.array([True, False]), 1.0, names=["base", "B7"]
        )
    assert caught.value.codes == (code,)
    assert "B7" in caught.value.faults[0].message


def test_a_long_base_below_a_thousand_blocks() -> None:
    """One edge touches them all; so do two bases with a pile of sheets between them."""
    row = [SQUARE + np.array([float(k), 0.0]) for k in range(1000)]
    cut = assemble(turned([rectangle(0.0, -1.0, 1000.0, 0.0), *row], 20.0, (0.0, 0.0)))
    assert len(cut.assembly.patches) == 1000 + 999
    assert cut.contact == pytest.approx(1999.0, rel=1e-12)
    sheets = assemble([rectangle(0.0, 0.01 * k, 100.0, 0.01 * (k + 1)) for k in range(1000)])
    assert sheets.contact == pytest.approx(99900.0, rel=1e-9)


@pytest.mark.parametrize("axes", [2, 3])
@pytest.mark.parametrize("at_once", [2_000_000, 500])
def test_boxes_against_all_pairs(axes, at_once, monkeypatch) -> None:
    """Sizes over four decades, many of them alike; against a comparison of each with each."""
    monkeypatch.setattr(box_search, "_CHUNK_SIZE", at_once)
    rng = np.random.default_rng(5)
    lowest = rng.uniform(0.0, 10.0, (700, axes))
    highest = lowest + np.where(
        rng.random((700, axes)) < 0.7, 0.4, 10.0 ** rng.uniform(-3.0, 1.0, (700, axes))
    )
    meets = (lowest[:, None] <= highest[None]).all(axis=2)
    expected = np.argwhere(np.triu(meets & meets.T, 1))
    first, second = box_pairs(lowest, highest)
    assert sorted(map(list, zip(first.tolist(), second.tolist(), strict=True))) == expected.tolist()


def test_clipping_against_half_planes() -> None:
    """Regular polygons about one centre, turned against each other: area by the incircle of 2n sides of one radius."""
    angles = 2.0 * np.pi * np.arange(6) / 6.0
    one = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    two = np.stack([np.cos(angles + np.pi / 6.0), np.sin(angles + np.pi / 6.0)], axis=1)
    shared, counts = clip_convex(one[None], np.array([6]), two[None])
    incircle = math.cos(math.pi / 6.0)
    area, centre, around = polygon_sums(shared, counts)
    assert counts.tolist() == [12]
    assert area[0] == pytest.approx(12.0 * incircle**2 * math.tan(math.pi / 12.0), rel=1e-12)
    assert around[0] == pytest.approx(24.0 * incircle * math.tan(math.pi / 12.0), rel=1e-12)
    assert centre[0] == pytest.approx([0.0, 0.0], abs=1e-15)
