"""Limits of many blocks, in space and in a section, against histories and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import populations
from benchmarks.benches import bench
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.path import trace_limit
from slopekit.preie.many_blocks.blocks_limit import Basis
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie import path_oracle
from tests.preie.block_scenes import first_part, wall


def bed_of(model: AssemblyModel) -> ElasticContactModel:
    return ElasticContactModel(model, Drive(model.load.ravel()))


def limit_of(model: AssemblyModel) -> float:
    """F of the path, which has to have settled."""
    found = trace_limit(bed_of(model), 2.0 / static_bound(model).factor)
    assert found.is_limit
    return 1.0 / found.parameter


def reordered(model: AssemblyModel) -> AssemblyModel:
    """The same blocks in another order."""
    order = np.random.default_rng(3).permutation(len(model.load))
    place = np.append(np.argsort(order), -1)
    columns = (order[:, None] * model.unknowns + np.arange(model.unknowns)).ravel()
    return replace(
        model,
        plus=place[model.plus],
        minus=place[model.minus],
        load=model.load[order],
        moving=model.moving[order],
        live=model.live[order],
        kinematics=model.kinematics[:, columns].tocsr(),
        statics=model.statics[columns].tocsr(),
    )


@pytest.mark.slow
@pytest.mark.parametrize("number", [8, 20])
def test_limits_are_those_of_histories(number) -> None:
    """Benches of 11 and 6 blocks without cohesion, whose limits lie far below the static bound.

    A history has incremental slip and slowly lowered strength; both are settled to 1e-6 of λ.
    """
    part = first_part(populations.bench(number))
    model, found = part.model, part.limit
    assert found.basis in (Basis.LIMIT, Basis.SETTLED)
    history = path_oracle.history(model, 2.0 / found.static_bound, cohesion=model.cohesion)
    assert history.end == "settled"
    assert found.factor == pytest.approx(history.factor, rel=3e-6)


@pytest.mark.parametrize("number", [20])
def test_the_order_of_blocks_does_not_matter(number) -> None:
    part = first_part(populations.bench(number))
    model = part.model
    assert len(model.load) > 1
    assert limit_of(reordered(model)) == pytest.approx(limit_of(model), rel=1e-8)


def test_blocks_that_all_slide_at_one_strength() -> None:
    """41 blocks of which several slide on one set: tan 35° / tan 45°, by hand, however fast each of them is."""
    found = first_part(bench(1.9)).limit
    assert found.basis is Basis.SETTLED
    assert found.factor == pytest.approx(
        math.tan(math.radians(35.0)) / math.tan(math.radians(45.0)), rel=1e-8
    )


def test_a_wall_of_many_blocks_that_slides_on_its_base() -> None:
    """105 blocks in running bond: tan φ / tan β by hand."""
    model = wall(10, 10, 20.0).model(35.0)
    found = trace_limit(bed_of(model), 2.0 / static_bound(model).factor)
    assert found.is_limit
    exact = math.tan(math.radians(35.0)) / math.tan(math.radians(20.0))
    assert 1.0 / found.parameter == pytest.approx(exact, rel=1e-8)
