"""A load of many blocks straight from the path in it."""

import pytest

import slopekit as sk
from benchmarks.blocks import multiplier

COLUMN = {
    "slopekit": 1, "kind": "blocks",
    "blocks": {"base": {"polygon": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True},
               "B1": {"polygon": [[0, 0], [1, 0], [1, 2], [0, 2]]}},
    "strength": {"joint": {"c": 0, "phi": 60}}, "rock": {"unit_weight": 25},
    "loads": {"seismic": {"k": 0.1, "toward": "090"}},
}  # fmt: skip


def test_a_column_tips_at_its_slenderness_and_nothing_is_said_to_be_put_back() -> None:
    """1 m by 2 m tips at k = 1/2 whatever its friction; no factor is shown that was not computed there."""
    found = sk.solve(sk.load(COLUMN), "loads.seismic.k", fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(0.5, rel=1e-9)
    root = found.to_dict()["pre_ie"]["roots"][0]
    assert (root["fos"], root["misses_by"], root["put_back"]) == (None, None, None)
    sheet = str(found)
    assert "not put back" in sheet
    for claim in ("misses by", "BRACKET", "REACH", "the methods at"):  # there was no search, and no second method
        assert claim not in sheet


def test_the_benchmark_takes_the_way_of_solve() -> None:
    """`python -m benchmarks.blocks multipliers`: the column's 1/2, and no number where no load moves it."""
    assert multiplier(_column(0.0), _column(1.0))[:2] == (pytest.approx(0.5, rel=1e-9), "topples")
    assert multiplier(_column(0.0), _column(0.0))[:2] == (None, "none")


def _column(k: float) -> dict:
    return COLUMN | {"loads": {"seismic": {"k": k, "toward": "090"}}}
