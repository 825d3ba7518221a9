"""The limit of one wedge is one smooth number: more strength never lowers it, and independent beds give the same."""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import slopekit as sk
from benchmarks.ordinary_cuts import broken_rules, cuts, stronger

CASES = json.loads((Path(__file__).parents[1] / "preie" / "moments.json").read_text(encoding="utf-8"))["cases"]

#: Wedges whose factor jumped, or fell with more strength, while the lower of three cohesion rules was printed.
RISING_WATER: dict[str, Any] = {
    "dips": ("38.7/185.8", "46.9/106.4"), "face": "58.9/180", "upper": "12.2/180", "height": 63.4, "c": (56.4, 22.4),
    "phi": (17.6, 29.7), "unit_weight": 26.5,
}  # fmt: skip
WATER_AND_CRACK: dict[str, Any] = {
    "dips": ("55.0/148.5", "53.9/233.0"), "face": "70/180", "upper": "5.3/180", "height": 14.3, "c": (53.9, 46.0),
    "phi": (41.0, 39.0), "unit_weight": 26.0, "crack": "80/180@2.5m",
}  # fmt: skip
MORE_COHESION: dict[str, Any] = {
    "dips": ("34.79/131.07", "49.36/212.91"), "face": "60.38/180", "upper": "10.6/180", "height": 21.42,
    "phi": (28.02, 31.77), "unit_weight": 24.61, "water": "34.4%", "seismic": "0.242@180",
    "crack": "66.3/156.6@4.07m",
}  # fmt: skip
SNAP: dict[str, Any] = {
    "dips": ("69.854/231.907", "27.591/206.146"), "face": "69.113/214.09", "upper": "16.7/214.09", "height": 97.07,
    "phi": (5.588, 36.775), "unit_weight": 25.446,
}  # fmt: skip


def limits(inputs: dict[str, Any], key: str, values: list[Any]) -> list[float]:
    return [sk.wedge(**inputs, **{key: value}).fos.limit for value in values]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inputs", "percents"),
    [(RISING_WATER, [82.0, 83.0, 83.5, 84.0, 84.5, 86.0]), (WATER_AND_CRACK, [45.0, 47.0, 48.0, 50.0, 55.0])],
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


def test_more_strength_never_lowers_the_limit_of_ordinary_cuts() -> None:
    """70 random cuts, one change of `stronger` each; all on 2,000: `python -m benchmarks.ordinary_cuts`."""
    broken = {}
    for number, (inputs, found) in enumerate(cuts(70, 7)):
        changes = list(stronger(inputs))
        said = broken_rules(inputs, found, [changes[number % len(changes)]])
        if said:
            broken[number] = said
    assert broken == {}
