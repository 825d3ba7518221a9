"""The last rest of all blocks before a limit: that all carry their loads there, and how near to the limit it is."""

import numpy as np
import pytest

from slopekit.preie.elastic_path import rests
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.rests import (
    CONFIRMATION_GAP,
    equilibrium_at_strength,
    equilibrium_below,
)
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.test_flow import model_of_bench

LIMIT = 0.70020754  # of the benches of `benchmarks.benches` without cohesion, those of every size


def bed_of(model: AssemblyModel) -> ElasticContactModel:
    return ElasticContactModel(model, Drive(model.load.ravel()))


def admissible(model: AssemblyModel, factor: float, normal, friction, strength) -> None:
    assert np.abs(model.unbalanced(normal, friction)).max() < 1e-5
    assert (np.hypot(*friction.T) <= strength / factor * (1.0 + 1e-12) + 1e-15).all()
    assert normal.min() >= 0.0


@pytest.mark.parametrize("spacing", [1.2])
def test_a_hair_before_the_limit_all_blocks_rest(monkeypatch, spacing) -> None:
    """Forces that balance each block, all joints admissible, from a tenth before the limit on.

    The limit is that of the block on the plane at 45 degrees. Beyond it there is no rest to come to.
    """
    model = model_of_bench(monkeypatch, spacing)
    bed = bed_of(model)
    flow, gap = equilibrium_below(bed, LIMIT)
    assert flow.ended == "rest"
    assert gap <= CONFIRMATION_GAP
    factor = (1.0 - gap) * LIMIT
    forces = bed.forces(flow.displacement, 1.0 / factor)
    admissible(model, factor, forces.normal, forces.friction, forces.strength)
    assert equilibrium_at_strength(bed, flow.displacement, 1.0 / (1.01 * LIMIT)) is None


def test_a_rest_is_found_from_one_at_more_strength(monkeypatch) -> None:
    """Of few blocks the one with sharp joints; where many begin, a rounded one. Both balance each block."""
    bed, factor = bed_of(model_of_bench(monkeypatch, 1.2)), 0.99 * LIMIT
    first = equilibrium_at_strength(bed, bed.elastic_displacement, 1.0 / (0.8 * LIMIT))
    assert first is not None
    for many, is_rounded in ((rests._INTERIOR_FROM, False), (0, True)):
        monkeypatch.setattr(rests, "_INTERIOR_FROM", many)
        rest = equilibrium_at_strength(bed, first.displacement, 1.0 / factor)
        assert rest is not None
        assert bool(rest.rounding) is is_rounded
        admissible(
            bed.model, factor, rest.forces.normal, rest.forces.friction, rest.forces.strength
        )


def test_where_nothing_balances_the_loads_there_is_no_rest(monkeypatch) -> None:
    bed = bed_of(model_of_bench(monkeypatch, 1.9))
    assert equilibrium_at_strength(bed, bed.elastic_displacement, 1.0 / 3.0) is None
