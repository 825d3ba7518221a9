"""Validity of a polygon in a section: it bounds one piece of area, or the fault of its points in words."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from slopekit.core.arrays import Floats

Point2 = tuple[float, float]
_SMALLEST_AREA = 1e-12  # of the square of the perimeter: below that the points lie in one line


def fault_of_polygon(points: Sequence[Point2]) -> str | None:
    """Return in words why the points do not bound one piece of area, None where they do.

    Parameters
    ----------
    points : in order, either way round, the first not repeated at the end

    >>> fault_of_polygon([(0, 0), (2, 0), (2, 1), (0, 1)])
    >>> fault_of_polygon([(0, 0), (2, 1), (2, 0), (0, 1)])
    'its sides 1 and 3 cross or touch'
    """
    closed = [*points, points[0]]
    for k, (first, second) in enumerate(pairwise(closed), 1):
        if first == second:
            return f"its points {k} and {k % len(points) + 1} are the same"
    if len(points) < 3:
        return "it has fewer than three points"
    edges = [(x1 - x0, z1 - z0) for (x0, z0), (x1, z1) in pairwise(closed)]
    x, z = points[0]
    local = [(a - x, b - z) for a, b in closed]
    area = sum(x0 * z1 - x1 * z0 for (x0, z0), (x1, z1) in pairwise(local)) / 2.0
    perimeter = sum((dx * dx + dz * dz) ** 0.5 for dx, dz in edges)
    crossing = None if _is_convex(edges) else _crossing(np.array(local[:-1]))
    thin = _SMALLEST_AREA * perimeter**2
    far_x, far_z = max(local, key=lambda point: point[0] ** 2 + point[1] ** 2)
    in_line = all(abs(far_x * z - far_z * x) <= thin for x, z in local)
    if in_line or (crossing is None and abs(area) <= thin):
        return "it has no area"
    return (
        None
        if crossing is None
        else f"its sides {crossing[0] + 1} and {crossing[1] + 1} cross or touch"
    )


def _is_convex(edges: Sequence[Point2]) -> bool:
    """Return whether the sides turn one way only and once around (collinear sides are allowed)."""
    sign = 0.0
    for (ax, az), (bx, bz) in pairwise([*edges, edges[0]]):
        turn = ax * bz - az * bx
        if turn * sign < 0.0 or (turn == 0.0 and ax * bx + az * bz < 0.0):
            return False
        sign = sign or turn
    eastward = [dx > 0.0 for dx, _ in edges if dx]
    return sum(a != b for a, b in pairwise([*eastward, *eastward[:1]])) == 2


def _crossing(points: Floats) -> tuple[int, int] | None:
    """Return the first two sides that meet outside a common corner; O(n²), each side against all later ones."""
    count = len(points)
    start, end = points, np.roll(points, -1, axis=0)

    for k in range(count):
        later = np.arange(k + 1, count)
        a, b, c, d = start[k], end[k], start[later], end[later]
        c_side, d_side, a_side, b_side = (
            _side(a, b, c),
            _side(a, b, d),
            _side(c, d, a),
            _side(c, d, b),
        )
        in_line = (c_side == 0.0) & (d_side == 0.0)
        span = b - a
        from_c, from_d = (c - a) @ span, (d - a) @ span
        overlaps = (
            in_line
            & (np.minimum(from_c, from_d) < span @ span)
            & (np.maximum(from_c, from_d) > 0.0)
        )
        meets = ~in_line & (c_side * d_side <= 0.0) & (a_side * b_side <= 0.0)
        meets &= (later != k + 1) & (later != (k - 1) % count)  # neighbours share a point
        crossed = np.flatnonzero(meets | overlaps)
        if len(crossed):
            return k, int(later[crossed[0]])
    return None


def _side(a: Floats, b: Floats, point: Floats) -> Floats:
    """Return the side of the line through a and b on which a point lies: 1 left, -1 right, 0 on the line."""
    along, arm = b - a, point - a
    return np.sign(along[..., 0] * arm[..., 1] - along[..., 1] * arm[..., 0])
