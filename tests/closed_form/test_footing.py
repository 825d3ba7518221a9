"""The footing on a weak plane against the paper and against two equations solved by hand."""

import math

import numpy as np
import pytest

from slopekit.closed_form.footing import footing


def test_the_paper() -> None:
    """K* = 200 · 5√2 / (1500 sin 45°) = 4/3 (Sheng et al. 2023, §3.3)."""
    block = footing(1500.0, 45.0, 5.0 * math.sqrt(2.0), 200.0, 0.0)
    assert block.status == "slides"
    assert block.factor == pytest.approx(4.0 / 3.0, rel=1e-14)


@pytest.mark.parametrize(("dip", "friction", "weight"), [(20.0, 0.0, 0.0), (45.0, 30.0, 250.0), (70.0, 10.0, 900.0)])
def test_two_equations_of_a_free_body(dip, friction, weight) -> None:
    """N and T from horizontal and vertical equilibrium, to rounding."""
    angle = math.radians(dip)
    # the plane pushes along (sin, cos) and holds along (-cos, sin)
    columns = np.array([[math.sin(angle), -math.cos(angle)], [math.cos(angle), math.sin(angle)]])
    normal, shear = np.linalg.solve(columns, [0.0, 700.0 + weight])
    block = footing(700.0, dip, 6.0, 40.0, friction, weight)
    assert (block.normal_kn, block.driving_kn) == pytest.approx((normal, shear), rel=1e-12)
    assert block.resisting_kn == pytest.approx(240.0 + normal * math.tan(math.radians(friction)), rel=1e-12)
    assert block.factor == pytest.approx(block.resisting_kn / shear, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "dip", "weight", "status"),
    [
        (100.0, 0.0, 0.0, "no_driving_force"),
        (0.0, 45.0, 0.0, "no_driving_force"),
        (-50.0, 45.0, 50.0, "no_driving_force"),
        (-60.0, 45.0, 50.0, "lifted"),
        (100.0, 90.0, 0.0, "falls"),
    ],
)
def test_no_number_where_nothing_slides(load, dip, weight, status) -> None:
    block = footing(load, dip, 5.0, 100.0, 30.0, weight)
    assert (block.status, block.factor) == (status, None)


def test_no_strength_is_a_factor_of_zero() -> None:
    assert footing(100.0, 30.0, 5.0, 0.0, 0.0).factor == 0.0
