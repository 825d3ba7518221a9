"""Rests of joints whose law is rounded: their forces against balance and strength, their end against sharp rests."""

from dataclasses import replace

import numpy as np
import pytest

from slopekit.preie.elastic_path import rests
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.flow import Flow, viscous_relaxation
from slopekit.preie.elastic_path.interior_point import interior_point_equilibrium
from slopekit.preie.elastic_path.path_limit import PathOutcome, result_of
from slopekit.preie.elastic_path.rests import equilibrium_below
from slopekit.preie.kernels import compiled
from slopekit.preie.tolerances import LAGGED_ROUNDING, RESTS_NEAR
from tests.preie.test_flow import model_of_bench
from tests.preie.test_rests import LIMIT, admissible

pytestmark = pytest.mark.skipif(compiled() is None, reason="its steps are compiled")


@pytest.fixture(scope="module")
def bed() -> ElasticContactModel:
    """A bench of 501 moving blocks without cohesion."""
    with pytest.MonkeyPatch.context() as patch:
        model = model_of_bench(patch, 0.85)
    return ElasticContactModel(model, Drive(model.load.ravel()))


@pytest.fixture(scope="module")
def both(bed) -> tuple[Flow, Flow]:
    """A rounded rest and a sharp one at the same strength."""
    parameter = 1.0 / (0.95 * LIMIT)
    rest, sharp = (
        interior_point_equilibrium(bed, parameter),
        viscous_relaxation(bed, bed.elastic_displacement, parameter, 1.0),
    )
    assert rest is not None
    assert sharp.ended == "rest"
    return rest, sharp


@pytest.mark.slow
def test_it_is_near_a_sharp_rest(bed, both):
    """Forces that balance every block within strength, and the work of the rest that Newton's method finds."""
    factor, (rest, sharp) = 0.95 * LIMIT, both
    assert 0.0 < rest.rounding < LAGGED_ROUNDING
    admissible(bed.model, factor, rest.forces.normal, rest.forces.friction, rest.forces.strength)
    work, of_sharp = (float(bed.drive.load @ one.displacement) for one in (rest, sharp))
    assert work == pytest.approx(of_sharp, rel=LAGGED_ROUNDING)


def test_slivers_do_not_hold_up_all_others(bed):
    """Their forces go to the nearest that balance: it took 238 steps until they did by themselves."""
    begun = bed.factorisations
    rest = interior_point_equilibrium(bed, 1.0 / (0.99 * LIMIT))
    assert rest is not None
    assert bed.factorisations - begun < 60
    admissible(
        bed.model, 0.99 * LIMIT, rest.forces.normal, rest.forces.friction, rest.forces.strength
    )


@pytest.mark.slow
def test_contacts_that_lie_open_are_those_of_a_sharp_rest(bed, both):
    """Every force of a rounded rest is above nothing: a bond of an open contact would count."""
    contact = bed.model.pair_contact
    lies_open = [np.bincount(contact, one.forces.touching, bed.contacts) == 0 for one in both]
    area = np.bincount(contact, bed.area, bed.contacts)
    assert lies_open[1].sum() > 100
    assert area[lies_open[0] != lies_open[1]].sum() < 0.05 * area[lies_open[1]].sum()


def test_beyond_a_limit_there_is_none(bed):
    """Just before it there is one: below."""
    assert interior_point_equilibrium(bed, 1.0 / (1.0005 * LIMIT)) is None


@pytest.mark.slow
@pytest.mark.parametrize(("part", "is_one"), [(1.0, True), (0.97, False)])
def test_blocks_are_at_a_limit_where_they_run_beyond_it(bed, monkeypatch, part, is_one):
    """Whatever a rounded rest says of the strength that a few of them use."""
    monkeypatch.setattr(rests, "MOBILISED", 0.0)
    flow = interior_point_equilibrium(bed, 1.0 / (0.999 * part * LIMIT))
    assert flow is not None
    limit = result_of(
        bed,
        PathOutcome.SETTLED,
        1.0 / (part * LIMIT),
        None,
        flow.displacement,
        flow.displacement,
        flow.forces,
    )
    assert rests.is_at_limit(bed, flow, limit) == is_one


def test_joints_that_dilate_have_none(bed):
    model = replace(bed.model, tan_dilation=0.5 * bed.friction)
    assert interior_point_equilibrium(ElasticContactModel(model, bed.drive), 1.0) is None


def test_thousands_of_blocks_rest_so(bed, monkeypatch):
    """Where Newton's method is not tried: as near to the factor as is asked, with its rounding."""
    monkeypatch.setattr(rests, "_INTERIOR_FROM", 0)
    monkeypatch.setattr(rests, "_INTERIOR_NEAR_UP_TO", 1)
    flow, gap = equilibrium_below(bed, LIMIT, RESTS_NEAR)
    assert flow.ended == "rest"
    assert gap == RESTS_NEAR
    assert flow.rounding > 0.0
