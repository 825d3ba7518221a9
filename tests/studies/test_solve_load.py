"""A load of many blocks straight from the path in it."""

import pytest

import slopekit as sk
from slopekit.views.solve_sheet import solve_sheet

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
    assert "not put back" in solve_sheet(found)
    assert "misses by" not in solve_sheet(found)
