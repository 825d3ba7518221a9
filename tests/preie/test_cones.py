"""Cone algebra against its definitions: matrices written out, membership by brute force, and known ends."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from slopekit.preie.programs.cones import determinant, longest_step, longest_step_to_zero, product, quotient, scaling

seeds = st.integers(0, 2**32 - 1)
widths = st.sampled_from([1, 2, 3])


def inside(rng: np.random.Generator, count: int, width: int, nearness: float) -> np.ndarray:
    """Rows in the inside of the cone, some as near to its boundary as 10^-nearness, of sizes 10^±3."""
    rest = rng.normal(size=(count, width))
    length = np.sqrt((rest * rest).sum(axis=1))
    first = length * (1.0 + 10.0 ** rng.uniform(-nearness, 1.0, count))
    return np.concatenate([first[:, None], rest], axis=1) * 10.0 ** rng.uniform(-3, 3, (count, 1))


def belongs(points: np.ndarray) -> bool:
    """Whether every row lies in its cone."""
    return bool((points[:, 0] >= np.sqrt((points[:, 1:] ** 2).sum(axis=1))).all())


def applied(matrices: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.matmul(matrices, x[:, :, None])[:, :, 0]


def matrix_of(apply, count: int, width: int) -> np.ndarray:
    """The matrices (g, 1 + t, 1 + t) of a linear map of rows."""
    columns = [apply(np.tile(np.eye(1 + width)[k], (count, 1))) for k in range(1 + width)]
    return np.stack(columns, axis=2)


@given(seeds, widths)
@settings(max_examples=60, deadline=None)
def test_the_scaling_takes_dual_and_primal_to_one_point(seed, width) -> None:
    """W z = W⁻¹ q: Nesterov and Todd's definition. Rows 1e-4 from the boundary lose four digits of sixteen, twice."""
    rng = np.random.default_rng(seed)
    q, z = inside(rng, 6, width, 4), inside(rng, 6, width, 4)
    w = scaling(q, z)
    for a, b in zip(w.times(z), w.over(q), strict=True):
        assert a == pytest.approx(b, rel=1e-7, abs=1e-7 * np.abs(a).max())


@given(seeds, widths)
@settings(max_examples=60, deadline=None)
def test_the_scaling_is_a_symmetric_matrix_that_keeps_the_cone(seed, width) -> None:
    """W = Wᵀ, W W⁻¹ = 1; W is η times a map of the cone onto itself: det(W x) = η² det x."""
    rng = np.random.default_rng(seed)
    q, z, x = (inside(rng, 5, width, 2) for _ in range(3))
    w = scaling(q, z)
    forth, back = matrix_of(w.times, 5, width), matrix_of(w.over, 5, width)
    size = np.abs(forth).max(axis=(1, 2))[:, None, None]
    assert forth / size == pytest.approx(forth.transpose(0, 2, 1) / size, abs=1e-14)
    assert np.matmul(forth, back) == pytest.approx(np.tile(np.eye(1 + width), (5, 1, 1)), abs=1e-8)
    turned = w.times(x)
    assert belongs(turned * np.concatenate([[1.0 + 1e-9], np.ones(width)]))
    assert determinant(turned) == pytest.approx(w.size**2 * determinant(x), rel=1e-6)


@given(seeds, widths)
@settings(max_examples=60, deadline=None)
def test_product_and_quotient(seed, width) -> None:
    """a ∘ b = arrow(a) b with the arrow matrix [[a0, a1ᵀ], [a1, a0 I]]; the quotient undoes it."""
    rng = np.random.default_rng(seed)
    a, b = inside(rng, 4, width, 2), rng.normal(size=(4, 1 + width))
    arrow = a[:, :1, None] * np.eye(1 + width)
    arrow[:, 0, 1:] = arrow[:, 1:, 0] = a[:, 1:]
    assert product(a, b) == pytest.approx(applied(arrow, b), rel=1e-12, abs=1e-12 * np.abs(a).max())
    assert product(a, b) == pytest.approx(product(b, a), rel=1e-14)
    for found, exact in zip(quotient(a, b), np.linalg.solve(arrow, b[:, :, None])[:, :, 0], strict=True):
        assert found == pytest.approx(exact, rel=1e-8, abs=1e-8 * np.abs(exact).max())


def reach_by_halving(points: np.ndarray, steps: np.ndarray) -> float:
    """The same as `longest_step` by trying: the step may go as far as every row stays in its (convex) cone."""
    low, high = 0.0, 1.0
    while belongs(points + high * steps):
        low, high = high, 2.0 * high
        if high > 1e9:
            return math.inf
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if belongs(points + middle * steps) else (low, middle)
    return low


@given(seeds, widths, st.floats(-3.0, 3.0))
@settings(max_examples=150, deadline=None)
def test_longest_step_against_trying(seed, width, size) -> None:
    """1e-7: where a step leaves the cone at a grazing angle, the root of the quadratic loses half its digits."""
    rng = np.random.default_rng(seed)
    points = inside(rng, int(rng.integers(1, 5)), width, 3)
    steps = rng.normal(size=points.shape) * 10.0**size
    exact = reach_by_halving(points, steps)
    found = longest_step(points, steps)
    if exact == math.inf:
        assert found > 1e8
    else:
        assert found == pytest.approx(exact, rel=1e-6)


@given(seeds, widths)
@settings(max_examples=40, deadline=None)
def test_steps_along_known_directions(seed, width) -> None:
    """Straight to the tip of the cone: 1. Along the axis down: x0 - |x1|. Deeper into the cone: no end."""
    points = inside(np.random.default_rng(seed), 1, width, 2)
    assume(points[0, 0] < 1e3)
    size = math.sqrt(float((points[0, 1:] ** 2).sum()))
    axis = np.eye(1 + width)[:1]
    assert longest_step(points, -points) == pytest.approx(1.0, rel=1e-7)
    assert longest_step(points, -axis) == pytest.approx(points[0, 0] - size, rel=1e-7)
    assert longest_step(points, points + axis) == math.inf


def test_steps_of_nothing() -> None:
    assert longest_step(np.zeros((0, 3)), np.zeros((0, 3))) == math.inf
    assert longest_step(np.array([[1.0, 0.5]]), np.zeros((1, 2))) == math.inf
    assert longest_step_to_zero(np.ones(3), np.array([0.0, 1.0, 2.0])) == math.inf


def test_longest_step_to_zero_is_the_first_to_fall() -> None:
    assert longest_step_to_zero(np.array([1.0, 6.0, 2.0]), np.array([-0.1, -2.0, 5.0])) == pytest.approx(3.0)


def test_the_determinant_stays_above_zero() -> None:
    assert (determinant(np.array([[1.0, 2.0], [1.0, 1.0], [3.0, 0.0]])) > 0.0).all()
    assert determinant(np.array([[5.0, 3.0, 0.0]])).tolist() == [16.0]
