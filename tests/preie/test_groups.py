"""Limits that are proposed: by a group, for all blocks to vouch for; at once, where the path ends in a peak."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.benches import bench
from slopekit.preie.many_blocks import blocks, groups, ravelling
from slopekit.preie.many_blocks.blocks_limit import Basis
from tests.preie.block_scenes import first_part

EXACT = math.tan(math.radians(35.0)) / math.tan(math.radians(45.0))


def key_part(scale: float = 1.9):
    """The part of 41 moving blocks of a bench of 149 (27 at 2.1); its key block slides down a plane of 45 degrees."""
    return first_part(bench(scale), ranged=True)


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


def test_a_range_is_that_of_the_motion_that_is_asked_about(monkeypatch) -> None:
    """The limit may be that of an earlier search, where cohesion breaks in between: the last group has another."""
    asked, span = [], groups.Groups.span

    def watched(own, motion, top):
        asked.append((own, motion, span(own, motion, None)))
        return span(own, motion, top)

    monkeypatch.setattr(groups.Groups, "span", watched)
    limit = key_part().limit
    (own, motion, (low, high)) = asked[0]
    np.testing.assert_array_equal(motion, limit.velocity)
    assert (min(low, limit.factor), min(high, limit.static_bound)) == pytest.approx(
        (limit.lowest, limit.highest), rel=1e-9
    )
    assert span(own, motion[::-1], None) is None


def test_a_rest_that_is_not_near_enough_is_a_peak(monkeypatch) -> None:
    monkeypatch.setattr(groups, "CONFIRMATION_GAP", 1e-4)
    limit = key_part().limit
    assert limit.basis is Basis.PEAK
    assert 0.99 * EXACT < limit.factor < (1.0 - 1e-4) * EXACT
    assert limit.factor * (1.0 + limit.change) == pytest.approx(EXACT, rel=1e-8)
    assert limit.width == 0.0


def test_a_group_a_hair_above_the_static_bound(monkeypatch) -> None:
    """The rest is looked for below the bound; what is said of it, in parts of the factor, is what was seen."""
    bound, rests, seen = blocks.static_bound, groups.equilibrium_below, []

    def lower(model):
        found = bound(model)
        unit = math.tan(math.radians(35.0))  # in which the bound is looked for
        return (
            replace(found, factor=(1.0 - 9e-5) * EXACT / unit) if len(model.load) == 41 else found
        )

    def watched(bed, factor, near):
        flow, gap = rests(bed, factor, near)
        seen.append((flow, factor * (1.0 - gap)))
        return flow, gap

    monkeypatch.setattr(blocks, "static_bound", lower)
    monkeypatch.setattr(groups, "equilibrium_below", watched)
    part = key_part()
    limit = part.limit
    assert limit.group > 0
    assert limit.factor == pytest.approx(EXACT, rel=1e-8)
    ((flow, rested),) = seen
    assert rested < (1.0 - 9e-5) * EXACT
    assert limit.factor * (1.0 - limit.width) == pytest.approx(rested, rel=1e-9)
    assert limit.normal_force == pytest.approx(flow.forces.normal, abs=1e-6)


def test_blocks_that_are_not_at_their_limit_are_not_said_to_be(monkeypatch) -> None:
    """A limit of a group a fifth too low: all blocks rest there, and have strength to spare."""
    whole = groups.first_limit
    seen = []

    def lower(*group, **options):
        found = whole(*group, **options)
        return replace(found, parameter=found.parameter / 0.8)

    def judged(*args):
        seen.append(original(*args))
        return seen[-1]

    class Watched(groups.Groups):
        def __init__(self, *scene):
            super().__init__(*scene)
            made.append(self)

    original, made = groups.is_at_limit, []
    monkeypatch.setattr(ravelling, "Groups", Watched)
    monkeypatch.setattr(groups, "first_limit", lower)
    monkeypatch.setattr(groups, "is_at_limit", judged)
    limit = key_part(2.1).limit
    assert set(seen) == {False}
    assert (limit.group, limit.factor) == (0, pytest.approx(EXACT, rel=1e-3))
    assert {one.solution for one in made} == {None}  # what was refused has no range to give
