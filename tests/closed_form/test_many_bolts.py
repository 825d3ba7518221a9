"""Hundreds of passive bolts in the closed forms: those of one direction are one, and cost as much."""

import pytest

import slopekit as sk
from slopekit.closed_form import wedge_sliding
from slopekit.closed_form.search import merged_bolts
from slopekit.kinds import kind_of

SLOPES = {
    "wedge": {
        "slope": {"face": "60/180", "upper": "10/180", "height": "30 m"},
        "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    },
    "basal": {
        "slope": {"face": "70/180", "upper": "5/180", "height": "20 m"},
        "joints": {"J1": {"plane": "80/100"}, "J2": {"plane": "78/262"}},
        "basal": {"plane": "28/185", "height": "4 m"},
        "crack": {"plane": "85/180", "distance": "8 m"},
    },
    "plane": {"slope": {"face": "60/180", "height": "12 m"}, "joints": {"J1": {"plane": "35/180"}}},
}
COUNT = 240


def factor_of(slope: str, bolts: list[tuple[float, str]]) -> float | None:
    design = sk.load(
        {
            "slopekit": 1,
            "kind": "wedge" if slope == "basal" else slope,
            **SLOPES[slope],
            "strength": {"s": {"c": 5, "phi": 24}},
            "rock": {"unit_weight": 26},
            "support": {
                "bolts": [
                    {"force": force, "toward": toward, "acts": "passive"} for force, toward in bolts
                ]
            },
        }
    )
    return kind_of(design).closed_form(design, None).factor


@pytest.mark.parametrize("slope", SLOPES)
def test_bolts_of_two_directions_are_two_however_many_they_are(slope) -> None:
    """Forces alone: n bolts of one direction hold what one of n times the capacity does."""
    many = [(1.0 + 0.01 * (k % 7), ("000/10", "350/-5")[k % 2]) for k in range(COUNT)]
    sums = [
        (sum(force for force, toward in many if toward == one), one) for one in ("000/10", "350/-5")
    ]
    assert factor_of(slope, many) == pytest.approx(factor_of(slope, sums), rel=1e-12)
    assert factor_of(slope, many) > factor_of(slope, sums[:1]) > factor_of(slope, [])


@pytest.mark.parametrize("slope", ["wedge", "basal"])
def test_they_cost_as_much_as_two(slope, monkeypatch) -> None:
    """How often a pull is looked for: it was in proportion to the number of bolts."""
    asked = [0]
    best = wedge_sliding._best_pull

    def counted(*given):
        asked[0] += 1
        return best(*given)

    monkeypatch.setattr(wedge_sliding, "_best_pull", counted)
    factor_of(slope, [(1.0, "000/10"), (1.0, "350/-5")] * (COUNT // 2))
    many, asked[0] = asked[0], 0
    factor_of(slope, [(COUNT / 2.0, "000/10"), (COUNT / 2.0, "350/-5")])
    assert many == asked[0] > 0


@pytest.mark.slow
@pytest.mark.parametrize("slope", SLOPES)
def test_directions_of_their_own_hold_a_little_less_than_their_mean(slope) -> None:
    """A fan of 20 about one direction beside one bolt: the resultant of a fan of ± 2° is shorter by 0.03 % or so."""
    fan = [
        (10.0, f"{bearing:03.1f}/{10 + 0.1 * k:.1f}")
        for k in range(-10, 11)
        for bearing in (1.0 + 0.01 * k,)
    ]
    alone = factor_of(slope, [(210.0, "001/10")])
    assert alone * (1.0 - 2e-3) < factor_of(slope, fan) < alone * (1.0 + 1e-3)


def test_opposite_ones_and_none_stay_apart() -> None:
    bolts = [(3.0, 0.0, 4.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, -1.0, 0.0), (0.0, 0.0, 0.0)]
    assert merged_bolts(bolts) == [
        (3.6, 0.0, 4.8),
        (0.0, 1.0, 0.0),
        (0.0, -1.0, 0.0),
        (0.0, 0.0, 0.0),
    ]
    assert merged_bolts([(1.0, 0.0), (1.0, 1e-9)]) == [(1.0, 0.0), (1.0, 1e-9)]
