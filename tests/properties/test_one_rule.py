"""The limit of one wedge is one smooth number: more strength never lowers it, and independent beds give the same."""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import slopekit as sk
from benchmarks.ordinary_cuts import (
    LEAST_FALL,
    above_bound,
    broken_rules,
    sheets_of_cuts,
    with_less_load,
    with_strength_divided,
)

CASES = json.loads(
    (Path(__file__).parents[1] / "preie" / "moments.json").read_text(encoding="utf-8")
)["cases"]

#: Wedges whose factor jumped, or fell with more strength, while the lower of three cohesion rules was printed.
RISING_WATER: dict[str, Any] = {
    "dips": ("38.7/185.8", "46.9/106.4"),
    "face": "58.9/180",
    "upper": "12.2/180",
    "height": 63.4,
    "c": (56.4, 22.4),
    "phi": (17.6, 29.7),
    "unit_weight": 26.5,
}
WATER_AND_CRACK: dict[str, Any] = {
    "dips": ("55.0/148.5", "53.9/233.0"),
    "face": "70/180",
    "upper": "5.3/180",
    "height": 14.3,
    "c": (53.9, 46.0),
    "phi": (41.0, 39.0),
    "unit_weight": 26.0,
    "crack": "80/180@2.5m",
}
MORE_COHESION: dict[str, Any] = {
    "dips": ("34.79/131.07", "49.36/212.91"),
    "face": "60.38/180",
    "upper": "10.6/180",
    "height": 21.42,
    "phi": (28.02, 31.77),
    "unit_weight": 24.61,
    "water": "34.4%",
    "seismic": "0.242@180",
    "crack": "66.3/156.6@4.07m",
}
SNAP: dict[str, Any] = {
    "dips": ("69.854/231.907", "27.591/206.146"),
    "face": "69.113/214.09",
    "upper": "16.7/214.09",
    "height": 97.07,
    "phi": (5.588, 36.775),
    "unit_weight": 25.446,
}
TWO_RESTS: dict[str, Any] = {
    "dips": ("64.1665/162.3389", "70.6841/235.7764"),
    "face": "71.1272/180",
    "upper": "14.9323/180",
    "height": 19.0663,
    "c": (40.0728, 56.2273),
    "unit_weight": 26.7532,
    "water": "32.75%",
}
#: Flowing while it sticks the first comes to a rest, the second to none; Newton's method found one of the first by
#: chance, and of the second one that it does not come back to.
STICKS: dict[str, Any] = {
    "dips": ("62.6766/175.4116", "56.0103/200.3259"),
    "face": "70.2125/180",
    "upper": "7.4847/180",
    "height": 25.9183,
    "c": (29.2414, 6.3515),
    "phi": (21.3384, 27.8679),
    "unit_weight": 24.3566,
}
TIPS: dict[str, Any] = {
    "dips": ((47.45159093165458, 173.9519811788936), (45.718311607193456, 189.28036230709355)),
    "face": (76.9317182875105, 180.0),
    "upper": (6.229757068392599, 180.0),
    "height": 21.67288849579461,
    "c": (19.229410426052, 37.34170949393074),
    "phi": (38.17735468117479, 44.442750970693055),
    "unit_weight": 23.214370193902155,
    "crack": "89.33/180@4.13m",
}


def limits(inputs: dict[str, Any], key: str, values: list[Any]) -> list[float]:
    return [sk.wedge(**inputs, **{key: value}).fos.limit for value in values]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inputs", "percents"),
    [
        (RISING_WATER, [82.0, 83.0, 83.5, 84.0, 84.5, 86.0]),
        (WATER_AND_CRACK, [45.0, 47.0, 48.0, 50.0, 55.0]),
    ],
)
def test_more_water_lowers_the_limit_without_a_jump(inputs, percents) -> None:
    """Once 0.783 at 83.5 % and 0.246 at 84 %; 1.559 at 47 %, 0.3725 at 48 % and 0.4647 at 55 %."""
    found = limits(inputs, "water", [f"{percent}%" for percent in percents])
    for (wet, before), (wetter, after) in pairwise(zip(percents, found, strict=True)):
        assert 0.0 < before - after < 0.02 * before * (wetter - wet)


def test_more_cohesion_raises_the_limit_without_a_jump() -> None:
    """Once 0.8844 at c 30, 26.4 and 0.6684 at 32, 28.2."""
    found = limits(MORE_COHESION, "c", [(c, 0.88 * c) for c in (28.0, 30.0, 31.0, 32.0, 34.0)])
    assert all(0.0 < after - before < 0.1 * before for before, after in pairwise(found))


def test_a_snap_that_comes_to_rest_again_is_no_limit() -> None:
    """A snap of 0.3 elastic displacements at 4.3 times the strength was printed as 0.2319; it rests up to 1.725."""
    found = limits(SNAP, "c", [(84.07 * part, 99.58 * part) for part in (0.98, 1.0, 1.02)])
    assert found[1] == pytest.approx(1.725, rel=0.01)
    assert found == sorted(found)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_the_limit_is_the_lower_of_hoek_and_bray_and_an_independent_bed(case) -> None:
    """Beds of 450 points a joint by another program: within 2 %, what a path that creeps about an edge leaves.

    Its static bound has the same points, none of them at a corner: to 0.6 %.
    """
    found = sk.wedge(**case["inputs"])
    expected = min(case["hoek_bray"], case["bed_limit"][0])
    assert found.fos.limit == pytest.approx(expected, rel=0.02)
    assert found.fos.static_bound == pytest.approx(case["static_bound"], rel=6e-3)
    assert found.fos.limit <= found.fos.static_bound


def test_more_strength_does_not_lower_the_limits_of_ordinary_cuts() -> None:
    """Some 500 random cuts, every change of `stronger`; of 8,026 the bed itself lowers 15 (`test_falling_limits`)."""
    looked_at, broken = broken_rules(500, 7)
    assert looked_at > 400
    assert {change for change, _, _ in broken} <= {"water - 0.1 %"}
    assert len(broken) <= 0.01 * looked_at


def test_strength_divided_by_a_number_has_the_limit_divided_by_it() -> None:
    """Some 200 random cuts, c and tan φ over 1.3; one of 2,001 is off, by 2e-4 (`benchmarks.ordinary_cuts`)."""
    off = with_strength_divided(200, 7)
    assert len(off) > 150
    assert float(off.max()) < LEAST_FALL


def test_less_water_or_shaking_hardly_ever_lowers_the_limit() -> None:
    """Some 200 random cuts: where the moments of water hold the block, as of 10 of 4,507 (docs/method.md)."""
    count, fell = with_less_load(200, 7)
    assert count > 300
    assert len(fell) <= 0.01 * count


@pytest.mark.slow
def test_no_limit_lies_above_its_upper_bound() -> None:
    count, above = above_bound(sheets_of_cuts(60, 7))
    assert count > 50
    assert above == []


def test_a_block_that_does_not_stick_starts_from_the_rest_that_it_flows_to() -> None:
    """Newton's method found one of two states of rest, as it happened: 0.5763, 0.9745, 0.9757, 0.5804."""
    found = [
        sk.wedge(**TWO_RESTS, phi=(38.363 + more, 23.0541 + more)).fos.limit
        for more in (-1.0, -0.1, 0.5, 2.0)
    ]
    assert found == sorted(found)
    assert found[0] == pytest.approx(0.9727, abs=2e-3)


def test_a_block_has_a_limit_where_it_comes_to_rest_while_it_sticks() -> None:
    """Once 0.1513, none, 0.1020, none; and none, 0.1596, none: more water takes a limit away once, or leaves none."""
    found = limits(STICKS, "water", [0.3282, 0.3364, 0.361, 0.3692])
    assert all(0.6 * before < after < before for before, after in pairwise(found))
    water = 0.47222750784769046
    assert limits(TIPS, "water", [0.9 * water, water, 1.05 * water]) == [None] * 3
