"""Rests of joints whose law is rounded: their forces against balance and strength, their end against sharp rests."""

from dataclasses import replace

import pytest

from slopekit.preie.elastic_path import rests
from slopekit.preie.elastic_path.bed import Bed, Drive
from slopekit.preie.elastic_path.lagged import lagged_rest
from slopekit.preie.elastic_path.local_viscosity import rest_from
from slopekit.preie.elastic_path.rests import rests_before
from slopekit.preie.kernels import compiled
from slopekit.preie.tolerances import LAGGED_ROUNDING, RESTS_NEAR
from tests.preie.test_flow import model_of_bench
from tests.preie.test_local_viscosity import LIMIT, admissible

pytestmark = pytest.mark.skipif(compiled() is None, reason="its steps are compiled")


@pytest.fixture(scope="module")
def bed() -> Bed:
    """A bench of 501 moving blocks without cohesion."""
    with pytest.MonkeyPatch.context() as patch:
        model = model_of_bench(patch, 0.85)
    return Bed(model, Drive(model.load.ravel()))


def test_it_is_near_a_sharp_rest(bed):
    """Forces that balance every block within strength, and the work of the rest that Newton's method finds."""
    factor = 0.95 * LIMIT
    rest = lagged_rest(bed, 1.0 / factor)
    sharp = rest_from(bed, bed.elastic_displacement, 1.0 / factor)
    assert rest is not None
    assert sharp is not None
    assert 0.0 < rest.rounding < LAGGED_ROUNDING
    admissible(bed.model, factor, rest.forces.normal, rest.forces.friction, rest.forces.strength)
    work, of_sharp = (float(bed.drive.load @ one.at) for one in (rest, sharp))
    assert work == pytest.approx(of_sharp, rel=LAGGED_ROUNDING)


@pytest.mark.parametrize(("part", "rests_there"), [(0.998, True), (1.002, False), (1.02, False)])
def test_beyond_a_limit_there_is_none(bed, part, rests_there):
    assert (lagged_rest(bed, 1.0 / (part * LIMIT)) is not None) == rests_there


def test_joints_that_dilate_have_none(bed):
    model = replace(bed.model, tan_dilation=0.5 * bed.friction)
    assert lagged_rest(Bed(model, bed.drive), 1.0) is None


def test_thousands_of_blocks_rest_so(bed, monkeypatch):
    """Where Newton's method is not tried: as near to the factor as is asked, with its rounding."""
    monkeypatch.setattr(rests, "_LAGGED", 0)
    monkeypatch.setattr(rests, "_LAGGED_FAR", 1)
    flow, gap = rests_before(bed, LIMIT, RESTS_NEAR)
    assert flow.ended == "rest"
    assert gap == RESTS_NEAR
    assert flow.rounding > 0.0
