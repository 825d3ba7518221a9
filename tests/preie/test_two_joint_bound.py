"""The static bound of a wedge by three equations, without the cone program that would stand in for them."""

import pytest

from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.programs import bound
from tests.preie.test_limit import paper_model


def test_two_joints_need_no_cone_program(monkeypatch) -> None:
    """METHOD.md §3: 1.5868 on the wedge of Table 4, to the digits given; wrong equations would fail their proof."""
    model = paper_model()
    limit = pairs_limit(model).governing

    def unwanted(*_: object) -> None:
        raise AssertionError("the three equations gave no bound")

    monkeypatch.setattr(bound, "_by_programs", unwanted)
    found = bound.static_bound(model, limit.velocity, limit.factor)
    assert found.factor == pytest.approx(1.5868, abs=5e-5)
