"""Large benches: a group proposes, all blocks vouch."""

import math

import numpy as np
import pytest

from benchmarks.benches import bench
from slopekit.preie import ravelling
from slopekit.preie.blocks import Basis
from tests.preie.block_scenes import first_part

EXACT = math.tan(math.radians(35.0)) / math.tan(math.radians(45.0))


def key_part():
    """The part of 41 moving blocks of a bench of 149; its key block slides down a plane of 45 degrees."""
    return first_part(bench(1.9), ranged=True)


def test_the_limit_of_a_group_that_all_blocks_vouch_for() -> None:
    part = key_part()
    limit = part.limit
    assert 0 < limit.group < len(part.blocks) == 41
    assert limit.basis is Basis.SETTLED
    assert limit.factor == pytest.approx(EXACT, rel=1e-8)
    assert limit.lowest <= limit.factor <= limit.highest <= limit.static_bound
    # all blocks, none held, carry their loads at a thousandth more strength
    rested = limit.factor * (1.0 - limit.width)
    assert 0.999 * limit.factor <= rested < limit.factor
    assert np.abs(part.model.unbalanced(limit.normal_force, limit.friction)).max() < 1e-5
    strength = part.model.tan_friction * part.model.by_group(limit.normal_force) / rested
    assert (np.hypot(*limit.friction.T) <= strength * (1.0 + 1e-9) + 1e-12).all()
    assert limit.normal_force.min() >= 0.0


def test_a_rest_that_is_not_near_enough_is_a_peak(monkeypatch) -> None:
    monkeypatch.setattr(ravelling, "JUST", 1e-4)
    limit = key_part().limit
    assert limit.basis is Basis.PEAK
    assert 0.99 * EXACT < limit.factor < (1.0 - 1e-4) * EXACT
    assert limit.factor * (1.0 + limit.change) == pytest.approx(EXACT, rel=1e-8)
    assert limit.width == 0.0


def test_blocks_that_are_not_at_their_limit_are_not_said_to_be(monkeypatch) -> None:
    """A limit of a group a fifth too low: all blocks rest there, and have strength to spare."""
    whole = ravelling.first_limit
    seen = []

    def lower(model, bond):
        found = whole(model, bond)
        return ravelling.replace(found, parameter=found.parameter / 0.8)

    def judged(*args):
        seen.append(original(*args))
        return seen[-1]

    original = ravelling.at_their_limit
    monkeypatch.setattr(ravelling, "first_limit", lower)
    monkeypatch.setattr(ravelling, "at_their_limit", judged)
    limit = key_part().limit
    assert seen == [False]
    assert (limit.group, limit.factor) == (0, pytest.approx(EXACT, rel=1e-3))
