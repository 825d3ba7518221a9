"""Random wedges: the PRE-IE limit against the Hoek & Bray closed form, which shares no code with it."""

from collections import Counter

import numpy as np
import pytest

import slopekit as sk
from tests.support import random_wedge

COUNT = 75


@pytest.fixture(scope="module")
def results() -> list[sk.wedge]:
    rng = np.random.default_rng(20261121)
    return [sk.wedge(**random_wedge(rng)) for _ in range(COUNT)]


def test_every_wedge_ends_with_an_answer(results) -> None:
    statuses = Counter(result.status for result in results)
    assert statuses["not_converged"] == 0
    assert {"slides_on_both", "slides_on_J1", "slides_on_J2", "lifted", "rotates"} <= statuses.keys()


def test_limit_equals_the_closed_form_or_moments_lower_it(results) -> None:
    """To 1e-6, ten times tighter than asked: both sides are exact to rounding where nothing turns."""
    equal = 0
    for result in results:
        limit, closed = result.fos.limit, result.fos.closed_form
        if result.moments_govern:
            assert limit is None or limit < closed
            assert result.forces_only == pytest.approx(closed, rel=1e-6)
        elif closed is None:
            assert limit is None
        else:
            assert limit == pytest.approx(closed, rel=1e-6)
            equal += 1
    assert equal > COUNT / 2


def test_status_is_the_closed_forms_where_forces_govern(results) -> None:
    from slopekit.analysis.wedge import closed_form

    for result in results:
        if not result.moments_govern:
            assert result.status == closed_form(result.design).status


def test_limit_never_exceeds_the_static_bound(results) -> None:
    bounded = [result for result in results if result.fos.static_bound is not None]
    assert len(bounded) > COUNT / 2
    for result in bounded:
        assert result.fos.limit <= result.fos.static_bound * (1.0 + 1e-9)
