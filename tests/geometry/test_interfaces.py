"""Node pairs: the rule is exact for linear traction (degree two with its moments), on any polygon, refined or not."""

import numpy as np
import pytest

from slopekit.core.orientation import Plane
from slopekit.geometry.interfaces import node_pairs

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


@pytest.mark.parametrize("corners", [TRIANGLE, SQUARE, PENTAGON], ids=["triangle", "square", "pentagon"])
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


def test_normals_point_into_the_block() -> None:
    """The polygon runs anticlockwise seen from outside: its vector area points out of the block."""
    polygon, _, _ = lifted(SQUARE, Plane(20, 300))
    outward = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    pairs = node_pairs({0: polygon})
    assert (pairs.normals @ outward < 0.0).all()
    assert (pairs.plus == 0).all()
    assert (pairs.minus == -1).all()
