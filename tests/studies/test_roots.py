"""Crossings of made-up functions whose zeros, jumps and gaps are known."""

import math
from itertools import pairwise

import pytest

from slopekit.studies.roots import RootSearch, Sample, refined_grid


def search(function, low, high, count=30, labels=None, **options):
    """A search over an even grid; the function returns None where it is undefined."""
    calls = []
    found = RootSearch(asked(function, calls, labels), high - low, **options)
    found.search_grid(low + (high - low) * k / (count - 1) for k in range(count))
    return found, calls


def asked(function, calls, labels=None):
    """A function that is asked at several places at once, and notes them."""

    def ask(places):
        calls.append(list(places))
        return [Sample(x, function(x), labels(x) if labels else "", None) for x in places]

    return ask


@pytest.mark.parametrize(
    ("function", "low", "high", "roots"),
    [
        (lambda x: x - 1.0 / 3.0, 0.0, 1.0, [1.0 / 3.0]),
        (lambda x: x**3 - 2.0, 0.0, 10.0, [2.0 ** (1.0 / 3.0)]),
        (math.sin, 1.0, 10.0, [math.pi, 2 * math.pi, 3 * math.pi]),
        (lambda x: math.tanh(1e3 * (x - 0.77)), 0.0, 1.0, [0.77]),
        (lambda x: math.exp(-x) - 1e-9, 0.0, 100.0, [9.0 * math.log(10.0)]),
        (lambda x: 1.0 - x * x, -2.0, 2.0, [-1.0, 1.0]),
        (lambda x: (x - 0.5) ** 9, 0.0, 1.0, [0.5]),
    ],
)
def test_roots_to_the_last_digits(function, low, high, roots) -> None:
    found, calls = search(function, low, high)
    crossings = found.crossings()
    assert [crossing.how for crossing in crossings] == ["root"] * len(roots)
    for crossing, root in zip(crossings, roots, strict=True):
        assert crossing.best.place == pytest.approx(
            root, rel=1e-14 if function(root) < 1e-12 else 1e-6, abs=1e-14
        )
        assert crossing.lower.place <= root * (1 + 1e-14) + 1e-14
    every = [place for places in calls for place in places]
    assert len(every) == len(set(every))  # each place once


def test_brackets_are_narrowed_together() -> None:
    """Three roots take hardly more rounds than the slowest of them."""
    _, calls = search(math.sin, 1.0, 10.0)
    assert len(calls) < 12
    assert all(
        len(places) in (3, 7) for places in calls[1:-2]
    )  # 7: the only stretch in eight parts


def test_jumps_are_no_roots() -> None:
    found, _ = search(lambda x: 0.3 if x < 0.123456 else -0.2, 0.0, 1.0)
    (crossing,) = found.crossings()
    assert crossing.how == "jump"
    assert not crossing.rises
    assert crossing.upper.place - crossing.lower.place < 1e-15
    assert (crossing.lower.level, crossing.upper.level) == (0.3, -0.2)


def test_poles_are_jumps_of_a_bounded_level() -> None:
    """1 / x changes its sign at 0 without being near zero."""
    found, _ = search(lambda x: math.copysign(1.0, x) if x else 1.0, -1.0, 1.0, count=20)
    assert [crossing.how for crossing in found.crossings()] == ["jump"]


def test_gaps_are_named_and_what_lies_beside_them_is_found() -> None:
    def function(x):
        return None if 0.4 < x < 0.6 else x - 0.5

    found, _ = search(function, 0.0, 1.0, edge=1e-12)
    (crossing,) = found.crossings()
    assert crossing.how == "gap"
    assert (crossing.lower.place, crossing.upper.place) == pytest.approx((0.4, 0.6), abs=1e-11)
    near, _ = search(
        lambda x: None if x < 0.3 else 1e-4 - (x - 0.3), 0.0, 1.0
    )  # a root next to an edge
    (crossing,) = near.crossings()
    assert crossing.how == "root"
    assert crossing.best.place == pytest.approx(0.3001, abs=1e-13)


def test_a_narrow_gap_met_while_polishing() -> None:
    """Undefined only between the grid points, to one side of the root."""
    found, _ = search(lambda x: None if 0.50 < x < 0.51 else x - 0.515, 0.0, 1.0, count=11)
    crossings = found.crossings()
    assert [crossing.how for crossing in crossings] == ["root"]
    assert crossings[0].best.place == pytest.approx(0.515, abs=1e-14)
    found, _ = search(lambda x: None if 0.50 < x < 0.52 else x - 0.515, 0.0, 1.0, count=11)
    crossings = found.crossings()
    assert [crossing.how for crossing in crossings] == ["gap"]
    assert (crossings[0].lower.place, crossings[0].upper.place) == pytest.approx(
        (0.50, 0.52), abs=1e-8
    )


def test_two_roots_between_grid_points_are_found_by_the_turning_point() -> None:
    found, _ = search(lambda x: (x - 0.521) ** 2 - 1e-4, 0.0, 1.0, count=11)
    assert [crossing.best.place for crossing in found.crossings()] == pytest.approx(
        [0.511, 0.531], abs=1e-12
    )


def test_a_root_hidden_by_a_jump_is_found_by_the_label() -> None:
    """Above zero at both grid points: it falls through zero, then jumps up again."""

    def function(x):
        return 0.5 - x if x < 0.52 else 1.0

    found, _ = search(function, 0.0, 1.0, count=11, labels=lambda x: "a" if x < 0.52 else "b")
    assert [crossing.how for crossing in found.crossings()] == ["root"]  # 0.5 itself is on the grid
    found, _ = search(function, 0.013, 1.0, count=11, labels=lambda x: "a" if x < 0.52 else "b")
    assert [crossing.how for crossing in found.crossings()] == ["root", "jump"]


def test_a_level_of_zero_on_the_grid_is_a_root() -> None:
    found, _ = search(lambda x: max(x - 0.5, 0.0) ** 2, 0.0, 1.0, count=3)
    assert 0.5 in [crossing.best.place for crossing in found.crossings()]


def test_it_stops_where_it_is_near_enough() -> None:
    found, calls = search(lambda x: x - 0.123, 0.0, 1.0, near=1e-3)
    (crossing,) = found.crossings()
    assert abs(crossing.best.level) <= 1e-3
    assert sum(map(len, calls)) < 42


@pytest.mark.parametrize("start", [0.2, 0.9])
def test_outwards_it_ends_where_zero_is_passed(start) -> None:
    """Whatever side it lies on: no place of the grid beyond it is asked for."""
    grid, calls = [k / 20 for k in range(21)], []
    found = RootSearch(asked(lambda x: x - 0.523, calls), 1.0, near=1e-6)
    found.search_outwards(grid, start)
    assert found.crossings()[0].best.place == pytest.approx(0.523, abs=1e-6)
    assert sum(map(len, calls)) < 13
    never = RootSearch(asked(lambda x: 1.0 + x, calls), 1.0)
    never.search_outwards(grid, start)
    assert {sample.place for sample in never.samples} >= set(grid)
    assert never.crossings() == []


def test_places_are_fine_near_the_present_value() -> None:
    even = refined_grid(0.0, 90.0, 20.0, even=33, close=2e-3)
    assert {0.0, 20.0, 90.0} <= set(even)
    assert min(abs(place - 20.0) for place in even if place != 20.0) < 0.05
    decades = refined_grid(0.0, 1e5, 50.0, even=33, close=2e-3)
    assert {0.0, 50.0, 1e5} <= set(decades)
    assert max(b / a for a, b in pairwise(decades[1:])) < 10.0 ** (1 / 3) + 1e-9
    around = refined_grid(-1e5, 1e5, 3.0, even=9, close=0.2)
    assert min(around) == -1e5
    assert any(abs(place - 3.0) <= 0.2 * 3.0 for place in around if place != 3.0)
    assert refined_grid(0.0, 1.0, None, even=3, close=1.0) == [0.0, 0.5, 1.0]


def test_rounding_beside_an_edge_is_not_looked_at_for_ever() -> None:
    """Within 1e-7 of the edge the sign is a matter of chance, as where a wedge has no end: few places are asked."""

    def function(x):
        if x < 1.0:
            return None
        return math.copysign(0.5, math.sin(1e12 * x)) if x < 1.0 + 1e-7 else 1.5 - x

    found, calls = search(
        function, 0.0, 2.0, labels=lambda x: f"{math.sin(1e12 * x) > 0}" if x < 1.0 + 1e-7 else ""
    )
    roots = [crossing.best.place for crossing in found.crossings() if crossing.how == "root"]
    assert roots == pytest.approx([1.5], abs=1e-14)
    assert sum(map(len, calls)) < 1000
