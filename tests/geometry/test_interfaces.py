"""Node pairs: the rule is exact for linear traction (degree two with its moments), on any polygon, refined or not."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from slopekit.core.orientation import Plane
from slopekit.geometry import interfaces
from slopekit.geometry.interfaces import node_pairs
from slopekit.preie.system.patch_pairs import fan_rule
from slopekit.views.charts.stereonet import cells

TRIANGLE = [(0.0, 0.0), (4.0, 0.0), (1.0, 3.0)]
SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
PENTAGON = [(0.0, 0.0), (4.0, -1.0), (6.0, 2.0), (3.0, 5.0), (-1.0, 3.0)]


def moment(corners, p: int, q: int) -> float:
    """∫ xᵖ yᑫ over a polygon, p + q <= 2 (Steger 1996, closed formulas by edges)."""
    total = 0.0
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        cross = x0 * y1 - x1 * y0
        total += (
            cross
            * {
                (0, 0): 1 / 2,
                (1, 0): (x0 + x1) / 6,
                (0, 1): (y0 + y1) / 6,
                (2, 0): (x0 * x0 + x0 * x1 + x1 * x1) / 12,
                (0, 2): (y0 * y0 + y0 * y1 + y1 * y1) / 12,
                (1, 1): (2 * x0 * y0 + x0 * y1 + x1 * y0 + 2 * x1 * y1) / 24,
            }[p, q]
        )
    return total


def lifted(corners, plane: Plane):
    """The polygon laid on a plane, and the plane's two axes."""
    normal = plane.normal()
    first = np.cross(normal, [0.3, 0.5, 0.7])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    return np.array([x * first + y * second for x, y in corners]), first, second


@pytest.mark.parametrize(
    "corners", [TRIANGLE, SQUARE, PENTAGON], ids=["triangle", "square", "pentagon"]
)
@pytest.mark.parametrize("refine", [0, 1, 3])
@pytest.mark.parametrize("powers", [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)])
def test_exact_to_degree_two(corners, refine, powers) -> None:
    polygon, first, second = lifted(corners, Plane(37, 211))
    pairs = node_pairs({0: polygon}, refine)
    x, y = pairs.points @ first, pairs.points @ second
    p, q = powers
    assert pairs.control_areas @ (x**p * y**q) == pytest.approx(moment(corners, p, q), rel=1e-12)


@pytest.mark.parametrize("refine", [0, 2])
def test_corners_carry_pairs_so_that_hinges_are_exact(refine) -> None:
    polygon, _, _ = lifted(PENTAGON, Plane(60, 100))
    pairs = node_pairs({0: polygon}, refine)
    for corner in polygon:
        assert np.abs(pairs.points - corner).sum(axis=1).min() < 1e-12
    assert pairs.control_areas.min() > 0.0


@pytest.mark.parametrize("refine", [0, 1, 2, 3])
def test_each_refinement_splits_a_triangle_in_four(refine) -> None:
    """Corners of the small triangles, shared by them, and a middle of each."""
    polygon, _, _ = lifted(TRIANGLE, Plane(60, 100))
    n = 2**refine
    assert len(node_pairs({0: polygon}, refine)) == (n + 1) * (n + 2) // 2 + n * n


def test_normals_point_into_the_block() -> None:
    """The polygon runs anticlockwise seen from outside: its vector area points out of the block."""
    polygon, _, _ = lifted(SQUARE, Plane(20, 300))
    outward = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    pairs = node_pairs({0: polygon})
    assert (pairs.normals @ outward < 0.0).all()
    assert (pairs.plus == 0).all()
    assert (pairs.minus == -1).all()


def test_pairs_that_are_remembered_are_those_of_their_corners() -> None:
    """Moved by the last digit they are others, with other ids too; what several hold cannot be written on."""
    polygon, _, _ = lifted(PENTAGON, Plane(60, 100))
    pairs = node_pairs({3: polygon}, 1)
    moved = np.nextafter(polygon, np.inf)
    for others in (
        node_pairs({3: moved}, 1),
        node_pairs({3: polygon}),
        node_pairs({4: polygon}, 1),
    ):
        same = others.points.shape == pairs.points.shape and (others.points == pairs.points).all()
        assert not same or (others.interface != pairs.interface).all()
    polygon += 1.0  # the caller's own array
    again = node_pairs({3: polygon - 1.0}, 1)
    assert np.abs(again.points - pairs.points).max() < 1e-15
    assert node_pairs({3: polygon}, 1).points - pairs.points == pytest.approx(1.0, abs=1e-14)
    for values in (
        pairs.points,
        pairs.normals,
        pairs.control_areas,
        pairs.interface,
        pairs.plus,
        pairs.minus,
    ):
        assert not values.flags.writeable


def bytes_of(polygons, pairs_on) -> list[bytes]:
    """Every number of the node pairs on faces."""
    pairs = pairs_on(polygons)
    return [
        array.tobytes()
        for array in (pairs.points, pairs.normals, pairs.control_areas, pairs.interface)
    ]


def as_new(polygons):
    return interfaces._pairs_of_faces.__wrapped__(
        tuple((key, face.tobytes()) for key, face in polygons.items()), 0
    )


def nearly(polygons, change: str):
    """The same faces but for the least that could be told apart, or not even that."""
    one, two = (face.copy() for face in polygons.values())
    if change == "a picometre":
        one[1, 0] += 1e-12
    elif change == "last digit":
        two[0, 1] = np.nextafter(two[0, 1], 2.0)
    elif change == "zeros":
        one = np.where(one == 0.0, -0.0, one)
    else:
        one, two = two, one
    return {0: one, 1: two}


@pytest.mark.parametrize("change", ["a picometre", "last digit", "zeros", "faces swapped"])
def test_faces_that_are_nearly_equal_are_never_taken_for_each_other(change) -> None:
    """Each to the last bit as without memory, one after the other and by several threads at once."""
    rng = np.random.default_rng(7)
    turns = [
        Plane(dip, direction) for dip, direction in rng.uniform([5.0, 0.0], [85.0, 360.0], (6, 2))
    ]
    faces = [{0: lifted(SQUARE, turn)[0], 1: lifted(PENTAGON, turn)[0]} for turn in turns]
    asked = [polygons for one in faces for polygons in (one, nearly(one, change))] * 2
    new = [bytes_of(polygons, as_new) for polygons in asked]
    assert [bytes_of(polygons, node_pairs) for polygons in asked] == new
    assert change == "zeros" or all(
        one != other for one, other in zip(new[:12:2], new[1:12:2], strict=True)
    )
    with ThreadPoolExecutor(4) as threads:
        assert (
            list(threads.map(lambda polygons: bytes_of(polygons, node_pairs), asked[::-1]))
            == new[::-1]
        )


def test_no_array_that_is_remembered_can_be_written() -> None:
    """Several designs, studies and threads hold the same one."""
    for array in (*fan_rule(4, 1), *cells()):
        assert not array.flags.writeable
