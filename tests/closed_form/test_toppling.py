"""Toppling columns against free bodies solved at once, against single columns, and by what holds for every slope."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slopekit.closed_form.search import first_loss
from slopekit.closed_form.toppling import (
    ColumnSlope,
    toe_force_required,
    toppling_factor_of_safety,
    toppling_table,
)
from slopekit.core.errors import DesignError

BOOK = ColumnSlope(
    [4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4], 10.0, 1.0, 30.0, 25.0, 38.15
)
VARIED = [
    BOOK,
    replace(BOOK, friction_angle_deg=30.0, side_friction_angle_deg=35.0),
    replace(
        BOOK, friction_angle_deg=42.0, side_friction_angle_deg=20.0, seismic=0.1, seismic_up=0.05
    ),
    replace(BOOK, cohesion_kpa=15.0, friction_angle_deg=31.0),
    replace(BOOK, toe_force_kn=900.0, toe_force_plunge_deg=20.0, toe_force_height_m=3.0),
    replace(BOOK, step_m=0.0, width_m=6.0),
    ColumnSlope([3.0, 9.0, 7.0, 15.0, 2.5, 11.0], 2.0, 1.5, 22.0, 26.0, 25.0),
]


def tan(degrees: float) -> float:
    return math.tan(math.radians(degrees))


def all_at_once(
    slope: ColumnSlope, modes, outward: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """P_(n-1), R and S from the equilibrium of all columns at once, the mode of each given, in world coordinates.

    Unknowns of column i: P, R, S and R's moment; equations: two forces, the moment about the origin of the world, and
    what the mode says. `outward` is the side to which the slope falls: 1 for +x, -1 for its mirror image.
    """
    count, dip = len(slope.heights_m), math.radians(slope.base_dip_deg)
    up = np.array([-outward * math.cos(dip), math.sin(dip)])  # along the bases, into the slope
    off = np.array([outward * math.sin(dip), math.cos(dip)])
    side = slope.side_friction_angle_deg
    side = tan(slope.friction_angle_deg if side is None else side)
    matrix, right = np.zeros((4 * count, 4 * count)), np.zeros(4 * count)

    def cross(at, force):
        return at[0] * force[1] - at[1] * force[0]

    def add(rows, column, at, force) -> None:
        matrix[rows, column] += force[0]
        matrix[rows + 1, column] += force[1]
        matrix[rows + 2, column] += cross(at, force)

    for i, height in enumerate(slope.heights_m):
        corner = np.array([3.0, -7.0]) + i * (slope.width_m * up + slope.step_m * off)
        weight = slope.unit_weight_kn_m3 * slope.width_m * height
        rows = 4 * i
        loads = [
            (
                corner + (slope.width_m * up + height * off) / 2.0,
                weight * np.array([outward * slope.seismic, slope.seismic_up - 1.0]),
            ),
        ]
        if i == 0:
            plunge = math.radians(slope.toe_force_plunge_deg)
            at = height / 2.0 if slope.toe_force_height_m is None else slope.toe_force_height_m
            pull = slope.toe_force_kn * np.array([-outward * math.cos(plunge), -math.sin(plunge)])
            loads.append((corner + at * off, pull))
        for at, force in loads:
            right[rows : rows + 2] -= force
            right[rows + 2] -= cross(at, force)
        low = (slope.heights_m[i - 1] if i else 0.0) - slope.step_m
        low = min(low, height)
        add(rows, rows, corner + low * off, up + side * off)  # from below: holds back and up
        if i + 1 < count:
            high = (
                corner
                + slope.width_m * up
                + min(height, slope.heights_m[i + 1] + slope.step_m) * off
            )
            add(rows, rows + 4, high, -up - side * off)
        add(rows, rows + 1, corner, off)
        add(rows, rows + 2, corner, up)  # S on the base holds back
        matrix[rows + 2, rows + 3] += cross(up, off)
        if modes[i] == "stable":
            matrix[rows + 3, rows] = 1.0
        elif modes[i] == "topple":
            matrix[rows + 3, rows + 3] = 1.0
        else:
            matrix[rows + 3, rows + 1 : rows + 3] = -tan(slope.friction_angle_deg), 1.0
            right[rows + 3] = slope.cohesion_kpa * slope.width_m
    found = np.linalg.solve(matrix, right).reshape(count, 4)
    return found[:, 0], found[:, 1], found[:, 2]


@pytest.mark.parametrize("outward", [1.0, -1.0], ids=["falls to the right", "mirrored"])
@pytest.mark.parametrize("slope", VARIED)
def test_equilibrium_of_all_columns_at_once(slope, outward) -> None:
    """One linear system of 4 n equations in world coordinates: 1e-9 of the largest force (its condition is 1e5)."""
    table = toppling_table(slope)
    forces, normal, shear = all_at_once(slope, table.modes, outward)
    size = float(normal.max())
    assert table.force_kn == pytest.approx(forces, abs=1e-9 * size)
    assert table.normal_kn == pytest.approx(normal, abs=1e-9 * size)
    assert table.shear_kn == pytest.approx(shear, abs=1e-9 * size)


@pytest.mark.parametrize("slope", VARIED)
def test_strength_divided_by_the_factor_is_just_enough(slope) -> None:
    """P_0 is 0 at the factor; 1e-9 less stands, 1e-9 more does not; a slope of the reduced strength has factor 1."""
    low, _ = toppling_factor_of_safety(slope)
    table = toppling_table(slope, low)
    assert abs(table.toe_force_kn) <= 1e-9 * table.normal_kn.max()
    assert toppling_table(slope, low * (1.0 - 1e-9)).force_kn[0] == 0.0
    assert toppling_table(slope, low * (1.0 + 1e-9)).force_kn[0] > 0.0
    side = (
        slope.friction_angle_deg
        if slope.side_friction_angle_deg is None
        else slope.side_friction_angle_deg
    )
    weaker = replace(
        slope,
        friction_angle_deg=math.degrees(math.atan(tan(slope.friction_angle_deg) / low)),
        side_friction_angle_deg=math.degrees(math.atan(tan(side) / low)),
        cohesion_kpa=slope.cohesion_kpa / low,
    )
    assert toppling_factor_of_safety(weaker)[0] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("slope", VARIED)
def test_scale(slope) -> None:
    """Lengths times k, unit weight times m, cohesion times k m, force times k² m: the same factor, to rounding."""
    k, m = 3.7, 0.61
    at = slope.toe_force_height_m
    scaled = replace(
        slope,
        heights_m=np.array(slope.heights_m) * k,
        width_m=slope.width_m * k,
        step_m=slope.step_m * k,
        unit_weight_kn_m3=slope.unit_weight_kn_m3 * m,
        cohesion_kpa=slope.cohesion_kpa * k * m,
        toe_force_kn=slope.toe_force_kn * k * k * m,
        toe_force_height_m=None if at is None else at * k,
    )
    (one, _), (other, _) = toppling_factor_of_safety(slope), toppling_factor_of_safety(scaled)
    assert other == pytest.approx(one, rel=1e-12)
    assert toppling_table(scaled).modes == toppling_table(slope).modes
    normal = toppling_table(slope, one).normal_kn * k * k * m
    assert toppling_table(scaled, other).normal_kn == pytest.approx(normal, rel=1e-9)


@pytest.mark.parametrize(("level", "up"), [(0.1, 0.0), (0.2, 0.1), (0.05, -0.1)])
def test_an_earthquake_is_a_turned_and_heavier_weight(level, up) -> None:
    """Base dip plus atan(k_h / (1 - k_v)), unit weight times the length of (k_h, 1 - k_v): to rounding."""
    shaken = replace(BOOK, seismic=level, seismic_up=up)
    turn, size = math.degrees(math.atan2(level, 1.0 - up)), math.hypot(level, 1.0 - up)
    turned = replace(BOOK, base_dip_deg=30.0 + turn, unit_weight_kn_m3=25.0 * size)
    assert toppling_table(shaken).force_kn == pytest.approx(
        toppling_table(turned).force_kn, rel=1e-11
    )
    factors = [toppling_factor_of_safety(slope)[0] for slope in (shaken, turned)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-12)
    assert factors[0] < toppling_factor_of_safety(BOOK)[0]


@pytest.mark.parametrize("dip", [20.0, 35.0, 50.0])
def test_one_column_alone(dip) -> None:
    """It slides at tan φ = tan ψ and tips beyond y = Δx / tan ψ whatever its friction."""
    edge = 2.0 / tan(dip)
    for height in (0.5 * edge, edge * (1.0 - 1e-9), edge):
        factor, status = toppling_factor_of_safety(ColumnSlope([height], 2.0, 0.3, dip, 25.0, 40.0))
        assert status == "slides"
        assert factor == pytest.approx(tan(40.0) / tan(dip), rel=1e-12)
    tips = ColumnSlope([edge * (1.0 + 1e-9)], 2.0, 0.3, dip, 25.0, 55.0)
    assert toppling_factor_of_safety(tips) == (0.0, "topples")
    assert toppling_table(tips).toe_force_kn > 0.0
    assert toppling_table(tips).modes == ("topple",)


def test_cohesion_of_one_column() -> None:
    """F = (c Δx + W cos ψ tan φ) / (W sin ψ)."""
    factor, _ = toppling_factor_of_safety(
        ColumnSlope([1.0], 2.0, 0.0, 30.0, 25.0, 20.0, cohesion_kpa=7.0)
    )
    weight, sine, cosine = 50.0, math.sin(math.radians(30.0)), math.cos(math.radians(30.0))
    assert factor == pytest.approx(
        (14.0 + weight * cosine * tan(20.0)) / (weight * sine), rel=1e-12
    )


def test_low_columns_slide_together() -> None:
    """None topples and all slide: each at tan φ / tan ψ on its own."""
    factor, _ = toppling_factor_of_safety(
        ColumnSlope([3.0, 4.0, 5.0, 4.0], 10.0, 1.0, 25.0, 25.0, 33.0)
    )
    assert factor == pytest.approx(tan(33.0) / tan(25.0), rel=1e-12)


def test_smooth_sides_of_two_columns() -> None:
    """By hand: column 2 topples with P = (D y - N Δx) / (2 L), column 1 slides with P + D = N tan φ / F."""
    slope = ColumnSlope([4.0, 14.0], 5.0, 1.0, 30.0, 20.0, 40.0, side_friction_angle_deg=0.0)
    (d1, d2), (n1, n2) = ([20.0 * 5.0 * y * f for y in (4.0, 14.0)] for f in (0.5, math.sqrt(0.75)))
    push = (d2 * 14.0 - n2 * 5.0) / (2.0 * 3.0)
    assert toppling_table(slope).force_kn[1] == pytest.approx(push, rel=1e-12)
    tipping = push * 4.0 + (d1 * 4.0 - n1 * 5.0) / 2.0
    assert tipping > 0.0  # the top of column 1 is pushed over, at any friction
    assert toppling_factor_of_safety(slope) == (0.0, "topples")
    low = replace(slope, heights_m=[4.0, 9.0])
    d2, n2 = (20.0 * 5.0 * 9.0 * f for f in (0.5, math.sqrt(0.75)))
    push = (d2 * 9.0 - n2 * 5.0) / (2.0 * 3.0)
    assert push > 0.0
    assert toppling_factor_of_safety(low)[0] == pytest.approx(
        n1 * tan(40.0) / (push + d1), rel=1e-12
    )


@pytest.mark.parametrize(("plunge", "factor"), [(0.0, 1.0), (15.0, 1.2), (-10.0, 1.1), (40.0, 1.5)])
def test_toe_force_that_gives_a_factor(plunge, factor) -> None:
    """The slope with that force has that factor (to 1e-9: P_0 of some kN among forces of 10⁴), whatever it had."""
    slope = replace(BOOK, friction_angle_deg=33.0, toe_force_plunge_deg=plunge)
    needed = toe_force_required(slope, factor)
    assert toe_force_required(replace(slope, toe_force_kn=500.0), factor) == pytest.approx(
        needed, rel=1e-9
    )
    found, _ = toppling_factor_of_safety(replace(slope, toe_force_kn=needed))
    assert found == pytest.approx(factor, rel=1e-9)


def test_toe_force_that_is_not_needed_or_never_enough() -> None:
    assert toe_force_required(replace(BOOK, friction_angle_deg=50.0)) == 0.0
    upward = replace(BOOK, friction_angle_deg=33.0, toe_force_plunge_deg=-170.0)
    assert toe_force_required(upward) == math.inf
    tips = ColumnSlope([12.0], 2.0, 0.0, 30.0, 25.0, 60.0, toe_force_height_m=6.0)
    assert toe_force_required(replace(tips, toe_force_kn=70.0)) == pytest.approx(
        toe_force_required(tips), rel=1e-12
    )
    table = toppling_table(replace(tips, toe_force_kn=toe_force_required(tips)))
    assert table.toe_force_kn == pytest.approx(0.0, abs=1e-10)


def test_nothing_is_lost() -> None:
    """Level bases stand at any strength, and so does a column held by a force alone."""
    flat = replace(BOOK, base_dip_deg=0.0, friction_angle_deg=0.0)
    assert toppling_factor_of_safety(flat) == (None, "no_driving_force")
    assert set(toppling_table(flat).modes) == {"stable"}
    held = toppling_factor_of_safety(
        ColumnSlope([4.0, 3.0], 10.0, 1.0, 20.0, 25.0, 30.0, toe_force_kn=900.0)
    )
    assert held == (None, "held")
    none = toppling_factor_of_safety(replace(BOOK, friction_angle_deg=0.0))
    assert none == (0.0, "slides")


def test_rough_sides_that_lock() -> None:
    """tan φ tan φ_s ≥ 1: no column slides where base friction alone holds it, and none is held where it does not."""
    steep = ColumnSlope([1.0, 1.2, 1.1], 10.0, 0.5, 60.0, 25.0, 50.0)
    table = toppling_table(steep)
    assert np.isinf(table.force_kn).all()
    assert set(table.modes) == {"slide"}
    assert toppling_factor_of_safety(steep)[0] == pytest.approx(tan(50.0) / tan(60.0), rel=1e-12)
    locked = toppling_table(replace(BOOK, friction_angle_deg=50.0))
    assert np.isneginf(locked.slide_force_kn).all()
    assert locked.force_kn[0] == 0.0


def test_the_base_of_a_toppling_column_need_not_hold() -> None:
    """A tall column on the top of a low one: S points up the base and R is below 0, as the system of all says."""
    slope = ColumnSlope([2.0, 30.0, 20.0], 5.0, 1.0, 30.0, 25.0, 35.0)
    table = toppling_table(slope)
    _, normal, shear = all_at_once(slope, table.modes, 1.0)
    holds = (normal >= -1e-6) & (abs(shear) <= normal * tan(35.0) + 1e-6)
    assert table.base_holds.tolist() == holds.tolist() == [True, False, True]


@settings(max_examples=60, deadline=None)
@given(
    heights=st.lists(st.floats(1.2, 40.0), min_size=1, max_size=12),
    width=st.floats(0.5, 20.0),
    dip=st.floats(5.0, 60.0),
    friction=st.floats(5.0, 44.0),
    step=st.floats(0.0, 1.0),
)
def test_random_columns(heights, width, dip, friction, step) -> None:
    """At the factor they stand, next to it not; sliding of all bounds it; forces as the system of all has them."""
    slope = ColumnSlope(heights, width, step, dip, 25.0, friction)
    factor, _ = toppling_factor_of_safety(slope)
    assert factor is not None
    assert factor <= tan(friction) / tan(dip) * (1.0 + 1e-12)
    if factor > 0.0:
        assert toppling_table(slope, factor).force_kn[0] == 0.0
        assert toppling_table(slope, factor * (1.0 + 1e-12)).force_kn[0] > 0.0
    table = toppling_table(slope)
    if table.modes[0] != "topple":  # column 1 has no column to topple against
        forces, normal, _ = all_at_once(slope, table.modes, 1.0)
        assert table.force_kn == pytest.approx(forces, abs=1e-7 * abs(normal).max())


@pytest.mark.parametrize(
    ("code", "changes", "says"),
    [
        ("E260", {"seismic": -0.1}, "the seismic coefficient is -0.1"),
        ("E260", {"seismic": 2.0}, "lift column 1, 2, 3, 4, 5 off its base"),
        (
            "E260",
            {"toe_force_kn": 5000.0, "toe_force_plunge_deg": -60.0},
            "lift column 1 off its base",
        ),
    ],
)
def test_refusals(code, changes, says) -> None:
    with pytest.raises(DesignError) as error:
        replace(BOOK, **changes)
    assert error.value.codes[0] == code
    assert says in str(error.value)


def test_what_was_given_stays_as_it_was() -> None:
    heights = np.array([4.0, 8.0, 6.0])
    slope = ColumnSlope(heights, 10.0, 1.0, 30.0, 25.0, 30.0)
    heights[0] = 99.0
    assert slope.heights_m[0] == 4.0
    with pytest.raises(ValueError, match="read-only"):
        toppling_table(slope).force_kn[0] = 1.0


@pytest.mark.parametrize("root", [1.0000001e-6, 3.3e-3, 1.0, 7.123456789, 9.9e5])
def test_the_first_loss(root) -> None:
    """Neighbours in floating point, also where strength is regained beyond."""
    low, high = first_loss(lambda factor: (factor <= root) | (factor > 3.0 * root))
    assert low == root
    assert high == np.nextafter(root, math.inf)
    assert first_loss(lambda factor: factor > 0.0) == (1e6, math.inf)
    assert first_loss(lambda factor: factor < 0.0) == (0.0, 1e-6)
