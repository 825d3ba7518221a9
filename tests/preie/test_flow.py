"""Blocks brought to rest: some of them with the others held, and viscous flow."""

import numpy as np
import pytest

from benchmarks.benches import bench as keyed_bench
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.elastic_path.flow import viscous_relaxation, viscous_step
from slopekit.preie.many_blocks import ravelling
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.block_scenes import first_part, random_bench
from tests.preie.test_path import BEDS


def model_of_bench(monkeypatch, scale: float) -> AssemblyModel:
    """All moving blocks of a bench, without its limit."""
    found = []

    class Enough(Exception): ...

    def keep(model, *args, **kwargs):
        found.append(model)
        raise Enough

    monkeypatch.setattr(ravelling, "limit_of_blocks", keep)
    with pytest.raises(Enough):
        first_part(keyed_bench(scale))
    return found[0]


@pytest.mark.parametrize("kernels", ["numpy", None])
@pytest.mark.parametrize("name", BEDS)
def test_forces_on_some_blocks_are_those_on_all(monkeypatch, name, kernels) -> None:
    if kernels:
        monkeypatch.setenv("SLOPEKIT_KERNELS", kernels)
    model, rng = BEDS[name](0.0), np.random.default_rng(1)
    whole = ElasticContactModel(model, Drive(model.load.ravel()))
    at = whole.elastic_displacement * (1.0 + 0.5 * rng.random(whole.size))
    blocks = np.sort(rng.choice(len(model.load), max(len(model.load) // 2, 1), replace=False))
    those = (blocks[:, None] * model.unknowns + np.arange(model.unknowns)).ravel()
    few = whole.restricted_to(blocks, at)
    assert few.size == len(those)
    exact = whole.forces(at, 1.3).unbalanced[those]
    assert few.forces(at[those], 1.3).unbalanced == pytest.approx(
        exact, abs=1e-13 * float(np.abs(exact).max())
    )
    # and their stiffness is that of all where the others do not move
    moved = np.zeros(whole.size)
    moved[those] = rng.normal(size=len(those))
    assert few.viscous(moved[those]) == pytest.approx(
        whole.viscous(moved)[those], rel=1e-9, abs=1e-12
    )


def test_blocks_that_touch() -> None:
    scene, phi = random_bench(3)
    model = scene.model(phi)
    one = np.arange(len(model.load)) == 0
    sides = np.stack([model.plus, model.minus], axis=1)
    touched = np.unique(sides[(sides == 0).any(axis=1)])
    assert np.flatnonzero(model.touching(one)).tolist() == touched[touched >= 0].tolist()


def test_a_few_blocks_keep_newtons_method_from_rest_and_are_settled_by_themselves(
    monkeypatch,
) -> None:
    """74 blocks, from rest at a factor of 0.5 to one of 0.69."""
    model = model_of_bench(monkeypatch, 1.6)
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    start = viscous_relaxation(bed, bed.elastic_displacement, 1.0 / 0.5, 1.0)
    assert start.ended == "rest"
    stuck = bed.newton(start.displacement, start.displacement, 1.0 / 0.69, 0.0, None, downhill=True)
    assert not stuck.settled
    found = viscous_step(bed, start.displacement, start.displacement, 1.0 / 0.69, 0.0)
    assert found.settled
    forces = found.forces
    assert np.abs(model.unbalanced(forces.normal, forces.friction)).max() < 1e-5
    assert (np.hypot(*forces.friction.T) <= forces.strength / 0.69 * (1.0 + 1e-12) + 1e-15).all()
    assert forces.normal.min() >= 0.0


@pytest.mark.slow
def test_blocks_run_by_the_work_that_they_do_from_where_they_are(monkeypatch) -> None:
    """From far down the slope they are at rest, when enough strength holds them there."""
    model = model_of_bench(monkeypatch, 1.6)
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    gone = viscous_relaxation(bed, bed.elastic_displacement, 1.0 / 0.72, 1.0, runs_at=30.0)
    assert gone.ended == "runs"
    assert viscous_relaxation(bed, gone.displacement, 1.0 / 0.4, 1e-2, runs_at=30.0).ended != "runs"
