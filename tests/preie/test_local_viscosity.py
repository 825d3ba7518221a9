"""Rests found with a viscosity of each block: what they are, how blocks and places settle by themselves."""

from dataclasses import replace

import numpy as np
import pytest

from slopekit.preie.elastic_path import local_viscosity, rests
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.flow import Flow, relaxed
from slopekit.preie.elastic_path.local_viscosity import rest_from
from slopekit.preie.elastic_path.rests import JUST, rests_before
from slopekit.preie.solvers.work_limit import WorkSpentError
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.test_flow import model_of_bench

LIMIT = 0.70020754  # of the benches of `benchmarks.benches` without cohesion, those of every size


def bed_of(model: AssemblyModel) -> Bed:
    return Bed(model, Drive(model.load.ravel()))


def admissible(model: AssemblyModel, factor: float, normal, friction, strength) -> None:
    assert np.abs(model.unbalanced(normal, friction)).max() < 1e-5
    assert (np.hypot(*friction.T) <= strength / factor * (1.0 + 1e-12) + 1e-15).all()
    assert normal.min() >= 0.0


@pytest.mark.parametrize("spacing", [1.2])
def test_from_one_rest_straight_to_another(monkeypatch, spacing) -> None:
    """A hair before the limit by steps from a tenth before it: forces that balance each block, all joints admissible.

    The limit is that of the block on the plane at 45 degrees. Beyond it there is no rest to come to.
    """
    model = model_of_bench(monkeypatch, spacing)
    bed = bed_of(model)
    first = relaxed(bed, bed.elastic_displacement, 1.0 / (0.9 * LIMIT), 1.0)
    factor = (1.0 - JUST) * LIMIT
    rest = rest_from(bed, first.at, 1.0 / factor)
    assert first.ended == "rest"
    assert rest is not None
    forces = bed.forces(rest.at, 1.0 / factor)
    admissible(model, factor, forces.normal, forces.friction, forces.strength)
    assert rest_from(bed, first.at, 1.0 / (1.01 * LIMIT)) is None


@pytest.mark.parametrize("spacing", [1.2])
def test_from_joints_that_stick_straight_to_a_rest(monkeypatch, spacing) -> None:
    """A hair before the limit at once, and none beyond it."""
    model = model_of_bench(monkeypatch, spacing)
    bed, factor = bed_of(model), (1.0 - JUST) * LIMIT
    rest = rest_from(bed, bed.elastic_displacement, 1.0 / factor)
    assert rest is not None
    forces = bed.forces(rest.at, 1.0 / factor)
    admissible(model, factor, forces.normal, forces.friction, forces.strength)
    assert rest_from(bed, bed.elastic_displacement, 1.0 / (1.01 * LIMIT)) is None


def test_hundreds_of_blocks_come_to_rest_without_viscous_flow(monkeypatch) -> None:
    """A tenth before the limit, and from there a thousandth."""
    bed = bed_of(model_of_bench(monkeypatch, 1.2))
    for name in ("relaxed", "stepped"):
        monkeypatch.setattr(rests, name, lambda *_, **__: pytest.fail("another way"))
    flow, gap = rests_before(bed, LIMIT)
    assert flow.ended == "rest"
    assert gap <= JUST


def watched_rests(monkeypatch, first=None) -> list[float]:
    """The strengths at which a rest of hundreds is looked for; `first` is called with the first that is found."""
    strengths: list[float] = []

    def looked_for(bed, at, parameter):
        strengths.append(parameter)
        found = rest_from(bed, at, parameter)
        return found if first is None or len(strengths) > 1 else first(found)

    monkeypatch.setattr(rests, "rest_from", looked_for)
    monkeypatch.setattr(rests, "_AT_ONCE", 0)
    return strengths


def test_of_a_thousand_blocks_and_more_the_last_rest_is_looked_for_at_once(monkeypatch) -> None:
    """It is the one that the first rest and a leap from it lead to."""
    model = model_of_bench(monkeypatch, 1.2)
    by_leap, _ = rests_before(bed_of(model), LIMIT)
    strengths = watched_rests(monkeypatch)
    at_once, gap = rests_before(bed_of(model), LIMIT)
    assert strengths == [1.0 / (LIMIT * (1.0 - JUST))]
    assert gap == JUST
    forces = at_once.forces
    admissible(model, LIMIT * (1.0 - JUST), forces.normal, forces.friction, forces.strength)
    size = float(np.abs(by_leap.at).max())
    assert at_once.at == pytest.approx(by_leap.at, abs=1e-3 * size)


def far_away(found: Flow) -> Flow:
    return replace(found, at=4.0 * found.at)


def too_long(found: Flow) -> None:
    raise WorkSpentError


@pytest.mark.parametrize("first", [far_away, too_long, lambda _: None])
def test_a_last_rest_not_found_at_once_is_led_to_by_the_first(monkeypatch, first) -> None:
    """One with five times the work of the joints that stick is another; and the search may take a part of all work."""
    strengths = watched_rests(monkeypatch, first)
    flow, gap = rests_before(bed_of(model_of_bench(monkeypatch, 1.2)), LIMIT)
    assert strengths[:3] == pytest.approx([1.0 / (LIMIT * (1.0 - gap)) for gap in (JUST, 0.1, JUST)])
    assert flow.ended == "rest"
    assert gap <= JUST


def test_what_is_a_little_out_of_balance_is_no_rest_yet(monkeypatch) -> None:
    """By a little more than it may be: the blocks settle, each and all within their strength."""
    model = model_of_bench(monkeypatch, 1.6)
    bed, parameter = bed_of(model), 1.0 / 0.63
    rest = rest_from(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    shaken = rest.at + 1e-6 * bed.elastic_displacement
    assert 1.0 < local_viscosity._out(bed, bed.forces(shaken, parameter)).max() < 30.0
    again = local_viscosity._settled(bed, shaken, parameter)
    assert again is not None
    assert local_viscosity._out(bed, again.forces).max() < 1.0
    admissible(model, 0.63, again.forces.normal, again.forces.friction, again.forces.strength)


def test_where_nothing_balances_the_loads_there_is_no_rest(monkeypatch) -> None:
    bed = bed_of(model_of_bench(monkeypatch, 1.9))
    assert rest_from(bed, bed.elastic_displacement, 1.0 / 3.0) is None


def pushed(bed: Bed, at, block: int, by: float):
    """A block out of its place by so many of its elastic displacements."""
    at = at.reshape(-1, 6).copy()
    at[block, :3] += by * np.abs(bed.elastic_displacement).max()
    return at.ravel()


def test_a_block_out_of_its_place_is_settled_by_itself(monkeypatch) -> None:
    """The others stay where they are, or, where it takes them, its neighbours settle too; all is better then."""
    bed, parameter = bed_of(model_of_bench(monkeypatch, 1.6)), 1.0 / 0.63
    rest = rest_from(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    moved = 0
    for block in range(0, len(bed.model.load), 7):
        begun = local_viscosity._State.at(bed, pushed(bed, rest.at, block, 1e-3), parameter)
        found = local_viscosity._spots_settled(bed, begun, parameter, 0.05)
        near = bed.model.touching(begun.out > local_viscosity._FAR_OUT)
        stays = (found.displacement == begun.displacement).reshape(-1, 6).all(axis=1)
        assert stays[~near].all()
        if not stays.all():
            moved += 1
            assert found.total < 0.5 * begun.total
    assert moved > 3


def test_a_place_out_of_balance_is_calmed_by_itself(monkeypatch) -> None:
    """Two blocks pushed out of their places: they and what is around them come back, all others stay."""
    bed, parameter = bed_of(model_of_bench(monkeypatch, 1.2)), 1.0 / 0.63
    rest = rest_from(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    last = len(bed.model.load) - 1
    at = pushed(bed, pushed(bed, rest.at, 3, 1e-4), last, 1e-4)
    begun = local_viscosity._State.at(bed, at, parameter)
    monkeypatch.setattr(local_viscosity, "_PLACES", 0.001)
    assert local_viscosity._parts_calmed(bed, begun, parameter) is begun  # too much of the bench
    monkeypatch.setattr(local_viscosity, "_PLACES", 0.2)
    found = local_viscosity._parts_calmed(bed, begun, parameter)
    assert found.total < 1e-3 * begun.total
    assert found.out[[3, last]].max() < local_viscosity._NEARLY
    near = begun.out > local_viscosity._NEARLY
    for _ in range(local_viscosity._RINGS):
        near = bed.model.touching(near)
    stays = (found.displacement == at).reshape(-1, 6).all(axis=1)
    assert stays[~near].all()
    assert not stays[[3, last]].any()


def test_each_spot_takes_steps_of_its_own_length(monkeypatch) -> None:
    """Two blocks that do not touch: a step to their rest is taken whole, one far beyond it is cut; a third is best."""
    bed, parameter = bed_of(model_of_bench(monkeypatch, 1.6)), 1.0 / 0.63
    rest = rest_from(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    one = 0
    other = int(np.flatnonzero(~bed.model.touching(np.arange(len(bed.model.load)) == one))[-1])
    few = bed.among(np.array([one, other]), rest.at)
    label = local_viscosity._labels(bed.model, np.isin(np.arange(len(bed.model.load)), [one, other]))
    assert label.tolist() == [0, 1]
    goal = rest.at.reshape(-1, 6)[[one, other]]
    away = np.full((2, 6), 1e-3 * np.abs(goal).max()) * [[1.0], [-1.0]]
    here = local_viscosity._State.at(few, (goal + away).ravel(), parameter)
    way = -away * [[1.0], [10.0]]
    found = local_viscosity._cut_short(few, here, way.ravel(), parameter, label)
    assert found.displacement.reshape(2, 6) == pytest.approx(goal, abs=1e-12 * np.abs(goal).max())
    assert found.off(label) == pytest.approx(np.zeros(2), abs=1e-3)


def test_where_no_leap_lands_the_way_is_shorter_steps(monkeypatch) -> None:
    """Newton's method and viscous flow come as near, if in more steps."""
    model = model_of_bench(monkeypatch, 1.6)
    leapt, work = rests_before(bed_of(model), LIMIT), []
    monkeypatch.setattr(rests, "rest_from", lambda *args: work.append(1))
    stepwise = rests_before(bed_of(model), LIMIT)
    assert [way[0].ended for way in (leapt, stepwise)] == ["rest", "rest"]
    assert max(leapt[1], stepwise[1]) <= JUST
    assert len(work) == 4  # the first rest, and leaps to 1e-3, 1e-2 and 3e-2
