"""Jumps: the same place and the same values on both sides as in 50 digits. All of them: `benchmarks/hard_cases.py`."""

import math

import pytest

from tests.hard_cases import exact
from tests.hard_cases.cases import WYLLIE, wedge
from tests.hard_cases.jumps import (
    EDGE,
    JUMPS,
    exact_place,
    located,
    side_of,
    sides,
    triangle_centroid,
)
from tests.hard_cases.sweeps import point

TESTED = [jump for jump in JUMPS if jump.tested]


@pytest.mark.parametrize("jump", TESTED, ids=lambda jump: jump.name)
def test_the_jump_lies_where_the_reference_has_it(jump) -> None:
    """Its place to the tolerance that the jump names with its cause, its values to 1e-6 or better."""
    wanted = exact_place(jump)
    below, above = sides(jump, wanted)
    is_before = side_of(jump, wanted)
    assert is_before(below)
    assert not is_before(above)
    for found in (below, above):
        assert found.status != "not_converged"
        if found.exact is None:
            assert found.limit is None
            continue
        assert found.error <= jump.error
        assert found.limit is None or found.limit <= found.exact * (1.0 + jump.error)
        if found.limit is None:
            assert found.status == "topples"


def test_a_jump_bisected_in_both() -> None:
    """Off by 1e-13: the balance of a wedge that an earthquake lifts is one sign."""
    jump = next(jump for jump in JUMPS if jump.name == "steep wedge, earthquake: it is lifted")
    assert located(jump).off < 1e-11


@pytest.mark.parametrize(
    "jump", [jump for jump in JUMPS if jump.tolerance is EDGE], ids=lambda jump: jump.name
)
def test_beyond_the_exact_tipping_point_there_is_no_number(jump) -> None:
    """Nothing balances these loads."""
    found = point(jump.at(exact_place(jump) * (1.0 + EDGE[0])))
    assert found.exact is None
    assert found.refused == ""
    assert found.status == "topples"
    assert found.limit is None


def test_lost_contact_drops_the_cohesion_and_no_more() -> None:
    """At the jump F falls by c₂ A₂ / T (Hoek & Bray 1981, ch. 8); the friction on J2 is nothing already."""
    jump = JUMPS[0]
    wanted = exact_place(jump)
    below, above = (
        wedge(WYLLIE, water=(u, u)).answer() for u in (wanted * (1 - 1e-15), wanted * (1 + 1e-9))
    )
    fall = 48 * below.areas[1] / below.driving
    assert float(below.factor - above.factor) == pytest.approx(float(fall), rel=1e-6)
    number = point(wedge(WYLLIE, water=(wanted * (1 + 1e-9),) * 2)).limit
    assert number == pytest.approx(float(below.factor - fall), rel=1e-6)


def test_places_by_hand() -> None:
    """A block tips at b/h = tan β; a plane block tips about its toe at k = |x|/z of its centroid."""
    places = {
        jump.name: exact_place(jump) for jump in JUMPS if "tip" in jump.name or "edge" in jump.name
    }
    lifted = next(jump for jump in JUMPS if jump.name == "plane, earthquake: it is lifted")
    assert exact_place(lifted) == pytest.approx(
        1 / math.tan(math.radians(35)), rel=1e-14
    )  # cos β = k sin β
    assert places["block of 1 m by 2 m: its centre of gravity passes its edge"] == pytest.approx(
        math.degrees(math.atan(0.5)), rel=1e-14
    )
    x, z = triangle_centroid(60.0, 35.0, 12.0)
    assert places["plane, earthquake, c = 0: it tips about its toe"] == pytest.approx(
        float(-x / z), rel=1e-14
    )
    # (W cos β - u b) b / 2 = W sin β h / 2 with W = 100 kN, b = 4 m, h = 1 m, β = 20°
    wet = (100 * exact.cosine(20) - 100 * exact.sine(20) / 4) / 4
    assert places["block on wet ground: the pressure lets it tip"] == pytest.approx(
        float(wet), rel=1e-14
    )
