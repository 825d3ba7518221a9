"""Goodman & Bray (1976): sixteen columns on a stepped base, the table and its four factors of safety.

The table is recomputed from the method (with a₂ = 5.0 m for the step at the crest; Wyllie & Mah 2004, ch. 9, print the
same example); factors 1.00, 1.00, 1.02 and 1.23 are published, 1.0185 and 1.2308 those of njones61/xslope.
"""

import math
from dataclasses import replace

import pytest

import slopekit as sk
from slopekit.closed_form.toppling import (
    ColumnSlope,
    toe_force_required,
    toppling_factor_of_safety,
    toppling_table,
)

SLOPE = ColumnSlope(
    [4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4], 10.0, 1.0, 30.0, 25.0, 38.15
)
# n, y, M, L, P to stop toppling, P to stop sliding, P, mode; None where the method has no such number
TABLE = [
    (16, 4, None, 4.0, -832.53, -470.72, 0.0, "stable"),
    (15, 10, 5.0, 10.0, -457.53, -1176.79, 0.0, "stable"),
    (14, 16, 11.0, 16.0, -82.53, -1882.87, 0.0, "stable"),
    (13, 22, 17.0, 22.0, 292.47, -2588.94, 292.47, "topple"),
    (12, 28, 23.0, 28.0, 825.66, -3002.55, 825.66, "topple"),
    (11, 34, 29.0, 34.0, 1555.95, -3175.43, 1555.95, "topple"),
    (10, 40, 35.0, 35.0, 2826.71, -3151.21, 2826.71, "topple"),
    (9, 36, 36.0, 31.0, 3922.14, -1409.73, 3922.14, "topple"),
    (8, 32, 32.0, 27.0, 4594.77, 156.41, 4594.77, "topple"),
    (7, 28, 28.0, 23.0, 4836.97, 1299.75, 4836.97, "topple"),
    (6, 24, 24.0, 19.0, 4637.45, 2012.67, 4637.45, "topple"),
    (5, 20, 20.0, 15.0, 3978.05, 2283.87, 3978.05, "topple"),
    (4, 16, 16.0, 11.0, 2825.48, 2095.18, 2825.48, "topple"),
    (3, 12, 12.0, 7.0, 1102.99, 1413.33, 1413.33, "slide"),
    (2, 8, 8.0, 3.0, -1485.16, 471.9, 471.9, "slide"),
    (1, 4, 4.0, -1.0, None, 1.18, 1.18, "slide"),
]


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"column {row[0]}")
def test_the_table(row) -> None:
    """Every number to the two decimals printed."""
    table, i = toppling_table(SLOPE), row[0] - 1
    found = (
        table.heights_m,
        table.upper_contact_m,
        table.lower_contact_m,
        table.topple_force_kn,
        table.slide_force_kn,
        table.force_kn,
    )
    for value, printed in zip(found, row[1:7], strict=True):
        assert float(value[i]) == pytest.approx(
            float("nan") if printed is None else printed, abs=0.00501, nan_ok=True
        )
    assert table.modes[i] == row[7]


def test_the_toe_force_and_the_bases() -> None:
    """P_0 = 1.182 kN with a₂ = 5.0; the bases hold everywhere, as the book's check of R and S says."""
    table = toppling_table(SLOPE)
    assert table.toe_force_kn == pytest.approx(1.182, abs=5e-4)
    assert table.base_holds.all()
    assert table.normal_kn[15] == pytest.approx(
        866.0, abs=0.5
    )  # Wyllie & Mah, table 9.1: R and S of column 16
    assert table.shear_kn[15] == pytest.approx(500.0, abs=0.5)


@pytest.mark.parametrize(
    ("friction", "toe_force", "recomputed", "published"),
    [
        (38.15, 0.0, 0.99996, 1.0),
        (33.0239, 2012.857, 1.0, 1.0),
        (38.6598, 0.0, 1.0184, 1.02),
        (38.6598, 2013.0, 1.2308, 1.23),
    ],
)
def test_factors_of_safety(friction, toe_force, recomputed, published) -> None:
    """To the four decimals recomputed (the second to 1e-6, its force has seven digits), and the two published."""
    factor, status = toppling_factor_of_safety(
        replace(SLOPE, friction_angle_deg=friction, toe_force_kn=toe_force)
    )
    assert status == "slides"
    assert factor == pytest.approx(recomputed, abs=1e-6 if friction == 33.0239 else 5e-5)
    assert factor == pytest.approx(published, abs=0.006)


def test_required_friction_and_toe_force() -> None:
    """φ = 38.1512° for limit equilibrium, T = 2012.857 kN per metre at φ = 33.0239° (2013 in print)."""
    factor, _ = toppling_factor_of_safety(SLOPE)
    required = math.degrees(math.atan(math.tan(math.radians(SLOPE.friction_angle_deg)) / factor))
    assert required == pytest.approx(38.1512, abs=5e-5)
    needed = toe_force_required(replace(SLOPE, friction_angle_deg=33.0239))
    assert needed == pytest.approx(2012.857, abs=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("friction", "toe_force"), [(38.15, 0.0), (33.0239, 2013.0), (38.6598, 0.0)]
)
def test_the_limit_of_the_columns_is_that_of_the_method(friction, toe_force) -> None:
    """The same contact modes: PRE-IE and the closed form differ by rounding. The force pushes into C1 half-way up."""
    half = math.radians(30.0)
    pushed = {
        "force": toe_force,
        "toward": "090/00",
        "block": "C1",
        "at": [-2 * math.sin(half), 0, 2 * math.cos(half)],
    }
    found = sk.run(
        {
            "slopekit": 1,
            "kind": "topple",
            "strength": {"joint": {"c": 0, "phi": friction}},
            "rock": {"unit_weight": 25},
            "columns": {
                "dip": 60,
                "width": 10,
                "base_step": 1,
                "heights": SLOPE.heights_m.tolist(),
            },
            "loads": {"forces": [pushed] if toe_force else []},
        }
    )
    slope = replace(
        SLOPE, friction_angle_deg=friction, toe_force_kn=toe_force, toe_force_height_m=2.0
    )
    assert found.fos.limit == pytest.approx(toppling_factor_of_safety(slope)[0], rel=1e-10)
