"""The static bound of many blocks in space by one run of the interior-point method, against programs at one λ each."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import populations
from slopekit.geometry.patches import BEDROCK
from slopekit.loads import PassiveBolts
from slopekit.preie.programs import bound_of_many, bounds
from slopekit.preie.programs.bound import StaticBound, is_proved
from slopekit.preie.programs.bound_of_many import bound_in_one_run
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.programs.distance import bound_by_programs
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import BOUND_ACCURACY, BOUND_ROUGHLY
from tests.preie import assembly_oracle, path_oracle
from tests.preie.block_scenes import bench, boxes_in_space, downhill, random_bench

BENCH = bench(
    (("45/170", 6.0), ("80/350", 7.0), ("85/80", 7.0))
)  # 16 blocks, loads from 1 to 4,000
BOXES = boxes_in_space((2, 2, 3), (2.0, 3.0, 1.0), 25.0, 0.3)
SLIVERS, SLIVERS_PHI = random_bench(7)  # 4 blocks, loads from 1 to 50,000; S is 13.8

MODELS: dict[str, Callable[[], AssemblyModel]] = {
    "boxes": lambda: BOXES.model([30.0, 35.0]),
    "boxes with cohesion": lambda: BOXES.model([30.0, 35.0], 0.5),
    "cohesion alone": lambda: BOXES.model(0.0, 20.0),
    "bench": lambda: BENCH.model(30.0),
    "bench with cohesion": lambda: BENCH.model(30.0, 8.0),
    "slivers": lambda: SLIVERS.model(SLIVERS_PHI),
}


def bolted() -> AssemblyModel:
    """The boxes with a bolt up the slope from each into bedrock, and one between two of them."""
    blocks = np.flatnonzero(~BOXES.fixed)
    head, toe = np.append(blocks, blocks[0]), np.append(np.full(len(blocks), BEDROCK), blocks[-1])
    up = np.array([0.0, 0.3, 0.0]) - downhill(20.0)[:, 0]
    forces = np.linspace(5.0, 60.0, len(head))[:, None] * up
    return replace(BOXES, bolts=PassiveBolts(head, toe, forces, BOXES.centroids[head] + 0.1)).model(
        [30.0, 35.0], 0.5
    )


@pytest.mark.parametrize("name", MODELS)
def test_the_bound_is_that_of_bisection(name) -> None:
    """Clarabel and bisection to 1e-6; ours ends where it knows λ to `NEAR`, 1e-5 of it."""
    model = MODELS[name]()
    found = bound_in_one_run(model)
    assert found is not None
    assert found.factor == pytest.approx(
        assembly_oracle.static_bound(model, 1e-6, found.factor), rel=1.5e-5
    )


def test_with_bolts_it_is_that_of_the_programs() -> None:
    """Another program and another search, in which a bolt pulls with 0 <= T <= λ capacity, to 1e-5 of the factor."""
    model = bolted()
    found, programs = bound_in_one_run(model), bound_by_programs(model)
    assert found is not None
    assert programs is not None
    assert found.factor == pytest.approx(programs.factor, rel=1.5e-5)
    without = bound_in_one_run(BOXES.model([30.0, 35.0], 0.5))
    assert without is not None
    assert abs((found.factor or 0.0) / (without.factor or 0.0) - 1.0) > 1e-2


@pytest.mark.parametrize("strength", [0.1, 7.0])
def test_the_strength_divided(strength: float) -> None:
    """S(strength / k) k = S, wherever λ begins: to twice `NEAR`."""
    model = MODELS["bench with cohesion"]()
    weaker = replace(
        model, tan_friction=model.tan_friction / strength, cohesion=model.cohesion / strength
    )
    found, whole = bound_in_one_run(weaker), bound_in_one_run(model)
    assert found is not None
    assert whole is not None
    assert strength * (found.factor or 0.0) == pytest.approx(whole.factor, rel=2e-5)


def test_the_motion_proves_it() -> None:
    """The dual, without cohesion: slip opens every contact by λ tan φ of it, and the load does no work against it.

    So no forces balance at a lower λ. At one higher by a thousandth slip would have to open some contact by more.
    """
    model = BOXES.model(33.0)
    found = bound_in_one_run(model)
    assert found is not None
    opening, slip = model.opening_and_slip(found.velocity)
    size = np.sqrt((slip * slip).sum(axis=1))
    fastest = float(size.max())
    over = opening - model.tan_friction * size / (found.factor or 0.0)
    assert float(over.min()) > -1e-5 * fastest
    assert float(model.load.ravel() @ found.velocity) > -1e-5 * fastest
    higher = opening - 1.001 * model.tan_friction * size / (found.factor or 0.0)
    assert float(higher.min()) < -1e-4 * fastest


@pytest.mark.parametrize(
    ("times", "accuracy", "proved"),
    [
        (0.99, BOUND_ACCURACY, False),
        (1.0, BOUND_ACCURACY, True),
        (1.01, BOUND_ACCURACY, True),
        (0.99, BOUND_ROUGHLY, False),
        (0.9998, BOUND_ACCURACY, False),
        (0.9998, BOUND_ROUGHLY, True),
    ],
)
def test_what_a_motion_proves(times, accuracy, proved) -> None:
    """Beyond the bound, and all the more beyond a higher number, no forces balance; below it some do.

    Of so many blocks that no programs decide a motion may close contacts by more.
    """
    model = MODELS["bench with cohesion"]()
    found = bound_in_one_run(model)
    assert found is not None
    assert (
        is_proved(model, replace(found, factor=times * (found.factor or 0.0)), accuracy) is proved
    )


def test_a_motion_against_the_loads_proves_nothing() -> None:
    """All blocks off their base, as joints that dilate may move."""
    model = BOXES.model(33.0)
    off = np.zeros_like(model.load)
    off[:, :3] = model.plus_motion[np.flatnonzero(model.minus < 0)[0], 0, :3]
    opening, _ = model.opening_and_slip(off.ravel())
    assert float(opening.min()) > -1e-12
    assert not is_proved(model, StaticBound(2.0, False, False, off, opening, 0))
    assert is_proved(
        replace(model, load=-model.load), StaticBound(2.0, False, False, off, opening, 0)
    )


@pytest.mark.parametrize("number", [54, 151])
def test_blocks_locked_in_a_slot_have_no_bound(number) -> None:
    """Between parallel joints forces of any size hold them at any friction: an independent program says so too.

    An interior-point method ended at 597, 2,197 and 5,551, its forces as large as it bears.
    """
    model = path_oracle.model_of(populations.bench(number))
    found = static_bound(model)
    assert (found.factor, found.locked, found.lifted) == (None, True, False)
    assert path_oracle.static_bound(model) == np.inf


@pytest.mark.parametrize(("population", "number"), [("benches", 15), ("sections", 424)])
def test_where_blocks_jam_the_bound_is_that_of_an_independent_program(population, number) -> None:
    """Found to 1e-4; they were 3 %, 0.2 % and 0.07 % low, or the independent one was 0.05 % low."""
    model = path_oracle.model_of(populations.POPULATIONS[population][0](number))
    found = static_bound(model)
    assert found.factor == pytest.approx(path_oracle.static_bound(model), rel=5e-5)


def test_programs_do_not_trust_their_rough_ends() -> None:
    """Where blocks jam a rough program may miss forces that are there: 11.51 for 11.93."""
    blocks = path_oracle.model_of(populations.bench(51))
    part = blocks.restricted_to(np.array([1]))[0]
    found = bound_by_programs(part)
    assert found is not None
    assert found.factor == pytest.approx(path_oracle.static_bound(part), rel=5e-5)


def test_without_an_end_others_say_why() -> None:
    """Pulled off its base nothing balances the boxes."""
    lifted = replace(BOXES, forces=-0.5 * BOXES.forces).model(35.0)
    assert bound_in_one_run(lifted) is None
    assert static_bound(lifted).lifted


def test_without_any_strength_there_is_no_bound_to_run_to() -> None:
    """Nothing falls as λ grows: it divided by that."""
    assert bound_in_one_run(BENCH.model(0.0)) is None


@pytest.mark.parametrize("held_back", [1.0, 0.9])
def test_of_many_parts_say_where_to_begin(held_back, monkeypatch) -> None:
    """What may slide, and what is about it, with all others held: no lower bound, and so a λ that is no higher.

    Also where that λ is a tenth too low, as where what moves lies beyond the parts.
    """
    model = MODELS["bench with cohesion"]()
    whole = bound_in_one_run(model)
    monkeypatch.setattr(bound_of_many, "_MANY", 1)
    monkeypatch.setattr(bound_of_many, "_LAYERS", 1)
    parts, runs, starts = bound_of_many._bound_of_subset, bound_of_many._run, []

    def watched(program: bound_of_many.Shortfall, start: float, known: bool = False):
        starts.append((len(program.model.load), start, known))
        return runs(program, start, known)

    monkeypatch.setattr(bound_of_many, "_run", watched)
    monkeypatch.setattr(bound_of_many, "_bound_of_subset", lambda model: held_back * parts(model))
    found = bound_in_one_run(model)
    assert found is not None
    assert whole is not None
    assert found.factor == pytest.approx(whole.factor, rel=4e-6)
    *of_parts, (blocks, start, known) = starts
    assert known
    assert of_parts
    assert max(part for part, *_ in of_parts) < blocks == len(model.load)
    assert not any(known for *_, known in of_parts)
    assert 0.5 < start * (whole.factor or 0.0) / held_back < 1.0 + 4e-6


def test_parts_lock(monkeypatch) -> None:
    """Blocks jam below the λ that is known: it begins again from the lowest."""
    model = MODELS["bench"]()
    whole = bound_in_one_run(model)
    monkeypatch.setattr(bound_of_many, "_MANY", 1)
    monkeypatch.setattr(bound_of_many, "_bound_of_subset", lambda model: 5.0)
    found = bound_in_one_run(model)
    assert found is not None
    assert whole is not None
    assert found.factor == pytest.approx(whole.factor, rel=4e-6)


def test_programs_that_did_not_close_are_not_run_again(monkeypatch) -> None:
    """Nothing about them has changed."""
    programs: list[AssemblyModel] = []
    monkeypatch.setattr(bounds, "bound_in_one_run", lambda *_: None)
    monkeypatch.setattr(bounds, "bound_by_programs", lambda model, *_, **__: programs.append(model))
    assert static_bound(MODELS["boxes"]()).factor is None
    assert len(programs) == 1
