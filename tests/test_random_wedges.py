"""Random wedges: the PRE-IE limit against the Hoek & Bray closed form, which shares no code with it."""

from collections import Counter

import numpy as np
import pytest

import slopekit as sk
from slopekit.result import Result
from tests.kinds.test_factors import same
from tests.support import random_wedge

COUNT = 48


@pytest.fixture(scope="module")
def results() -> list[Result]:
    rng = np.random.default_rng(20261121)
    return [sk.wedge(**random_wedge(rng)) for _ in range(COUNT)]


def test_every_wedge_ends_with_an_answer(results) -> None:
    statuses = Counter(result.status for result in results)
    assert statuses["not_converged"] == 0
    assert {
        "slides_on_both",
        "slides_on_J1",
        "slides_on_J2",
        "lifted",
        "rotates",
    } <= statuses.keys()


def test_limit_equals_the_closed_form_or_moments_lower_it(results) -> None:
    """To 1e-6, ten times tighter than asked: both sides are exact to rounding where nothing turns."""
    equal = 0
    for result in results:
        limit, closed = result.fos.limit, result.fos.closed_form
        if result.moments_govern:
            assert limit is None or limit < closed
            assert result.comparisons.forces_only == pytest.approx(closed, rel=1e-6)
        elif closed is None:
            assert limit is None
        else:
            assert limit == pytest.approx(closed, rel=1e-6)
            equal += 1
    assert equal > COUNT / 10  # these wedges are of any shape: moments govern most


def test_status_is_the_closed_forms_where_forces_govern(results) -> None:
    from slopekit.kinds.wedge import closed_form

    for result in results:
        if not result.moments_govern:
            assert result.status == closed_form(result.design).status


def test_limit_never_exceeds_the_static_bound(results) -> None:
    bounded = [result for result in results if result.fos.static_bound is not None]
    assert len(bounded) > COUNT / 2
    for result in bounded:
        assert result.fos.limit <= result.fos.static_bound * (1.0 + 1e-9)


def test_forces_balance(results) -> None:
    """All that have a factor; 2e-5 where many passes ended still in motion (W317 and `residual` say so)."""
    balanced = 0
    for result in results:
        if result.limit_state.balance is None:
            assert result.fos.limit is None or result.model.residual > 0.0
            continue
        allowed = max(1e-6, 10.0 * result.model.residual)
        assert result.limit_state.balance.force < allowed
        assert result.limit_state.balance.moment < allowed
        assert result.limit_state.balance.admissible_within(max(1e-4, allowed))
        balanced += result.limit_state.balance.moment < allowed
    assert balanced > COUNT / 2


def test_control_areas_sum_to_the_joints_and_normal_forces_are_pushes(results) -> None:
    for result in results:
        for joint, name in enumerate(("J1", "J2")):
            area = result.limit_state.node_pairs.control_area_m2[
                result.limit_state.node_pairs.joint == joint
            ].sum()
            assert area == pytest.approx(result.geometry.areas_m2[name], rel=1e-9)
        assert result.limit_state.node_pairs.normal_kn.min() >= 0.0


def test_the_quick_evaluation_gives_the_same(results) -> None:
    """Moments and lost contact among them."""
    some = results[:12]
    for result in some:
        same(result.design, result)
    assert any(result.moments_govern for result in some)
