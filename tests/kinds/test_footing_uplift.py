"""Uplift on the weak plane under a footing, by the hand calculation of a dam on its base: sliding and overturning.

N = P cos δ - U, T = P sin δ, F = (c L + N tan φ) / T; the block overturns about the toe where the moments of load and
weight about it no longer exceed that of the uplift, whatever the strength.
"""

import math

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError

LOAD, DIP, LENGTH, WATER = 1500.0, 30.0, 8.0, 9.81


def run(uplift, *, at="middle", c=100.0, phi=25.0, unit_weight=None, scale=1.0):
    rock = {} if unit_weight is None else {"rock": {"unit_weight": unit_weight}}
    return sk.run(
        {
            "slopekit": 1,
            "kind": "footing",
            "footing": {"load": LOAD * scale**2, "at": at},
            "weak_plane": {"dip": DIP, "length": LENGTH * scale},
            "strength": {"seam": {"c": c, "phi": phi}},
            "uplift": uplift,
            **rock,
        }
    )


def factor(force, load=LOAD, c=100.0, phi=25.0):
    dip = math.radians(DIP)
    normal = load * math.cos(dip) - force
    return (c * LENGTH + normal * math.tan(math.radians(phi))) / (load * math.sin(dip))


@pytest.mark.parametrize(
    ("uplift", "ends"),
    [
        ({"toe": 40, "heel": 10}, (40.0, 10.0)),
        ({"heel": 60}, (0.0, 60.0)),
        ({"toe": 40, "heel": 10, "drain": "25 %"}, (30.0, 7.5)),
        ({"fill": 1}, (WATER * LENGTH * math.sin(math.radians(DIP)), 0.0)),
        ({"fill": "50 %", "drain": 0.5}, (WATER * LENGTH * math.sin(math.radians(DIP)) / 4.0, 0.0)),
    ],
)
def test_both_methods_are_the_hand_formula(uplift, ends) -> None:
    """With weight: that of the triangle above the plane."""
    force = 0.5 * sum(ends) * LENGTH
    for unit_weight in (None, 25.0):
        height, width = LENGTH * math.sin(math.radians(DIP)), LENGTH * math.cos(math.radians(DIP))
        expected = factor(force, LOAD + (unit_weight or 0.0) * 0.5 * height * width)
        result = run(uplift, unit_weight=unit_weight)
        assert result.fos.closed_form == pytest.approx(expected, rel=1e-12)
        assert result.fos.limit == pytest.approx(expected, rel=1e-9)
        assert result.forces.water["weak plane"] == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize("at", [1.0])
@pytest.mark.parametrize("toe_part", [0.0, 0.4])
def test_it_overturns_where_the_moments_about_the_toe_say_so(at, toe_part) -> None:
    """P a = (p_toe + 2 p_heel) L² / 6 at the brink; a load of 1500 kN, no cohesion, φ = 40°."""
    brink = 6.0 * LOAD * at / LENGTH**2 / (toe_part + 2.0)
    assert 0.5 * brink * (1.0 + toe_part) * LENGTH < LOAD * math.cos(
        math.radians(DIP)
    )  # it is not lifted there
    for share in (0.98, 1.02):
        heel = share * brink
        result = run({"toe": toe_part * heel, "heel": heel}, at=at, c=0, phi=40)
        expected = factor(0.5 * heel * (1.0 + toe_part) * LENGTH, c=0.0, phi=40.0)
        assert result.fos.closed_form == pytest.approx(expected, rel=1e-12)
        if share < 1.0:
            assert result.fos.limit == pytest.approx(expected, rel=1e-9)
        else:
            assert (result.status, result.fos.limit, result.moments_govern) == (
                "topples",
                None,
                True,
            )


def test_uplift_above_what_presses_lifts_the_block() -> None:
    heel = 2.0 * LOAD * math.cos(math.radians(DIP)) / LENGTH
    assert run({"heel": 1.01 * heel}).status == "lifted"


def test_without_cohesion_a_larger_block_has_the_same_factor() -> None:
    """Loads per metre grow with the square of lengths where pressures stay: c = 0 and pressures with the length."""
    one, other = run({"toe": 20}, c=0, phi=40), run({"toe": 60}, c=0, phi=40, scale=3.0)
    assert other.fos.limit == pytest.approx(one.fos.limit, rel=1e-9)
    assert other.forces.water["weak plane"] == pytest.approx(
        9.0 * one.forces.water["weak plane"], rel=1e-9
    )


def test_a_design_without_it_says_nothing_of_it() -> None:
    assert (
        "uplift"
        not in sk.load(
            {
                "slopekit": 1,
                "kind": "footing",
                "footing": {"load": 1500},
                "weak_plane": {"dip": 30, "length": 8},
                "strength": {"s": {"c": 100, "phi": 25}},
            }
        ).inputs()
    )


@pytest.mark.parametrize(
    ("uplift", "code"),
    [
        ({"fill": 1, "toe": 3}, "E112"),
        ({"drain": 0.5}, "E118"),
        ({"toe": -3}, "E118"),
        ({"fill": 1.5}, "E118"),
        ({"toe": 3, "drain": 2}, "E118"),
        ("full", "E144"),
        ({"toe": "3 m"}, "E107"),
    ],
)
def test_what_is_no_uplift_is_refused(uplift, code) -> None:
    with pytest.raises(DesignError) as refused:
        run(uplift)
    assert code in refused.value.codes
