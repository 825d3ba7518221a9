"""Rests by way of joints that dilate: what they prove, against cone programs, and what they are when none dilates."""

from dataclasses import replace

import numpy as np
import pytest

from slopekit.preie.elastic_path import rests, undilated
from slopekit.preie.elastic_path.bed import Bed, Drive, NewtonStep
from slopekit.preie.elastic_path.flow import Flow, relaxed
from slopekit.preie.elastic_path.rests import JUST, rests_before
from slopekit.preie.elastic_path.undilated import rest_from, rest_of_hundreds, rest_without_dilation
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.solvers.effort import EffortSpentError
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.block_scenes import random_bench
from tests.preie.test_flow import model_of_bench

LIMIT = 0.70020754  # of the benches of `benchmarks.benches` without cohesion, those of every size


def bed_of(model: AssemblyModel) -> Bed:
    return Bed(model, Drive(model.load.ravel()))


def admissible(model: AssemblyModel, factor: float, normal, friction, strength) -> None:
    assert np.abs(model.unbalanced(normal, friction)).max() < 1e-5
    assert (np.hypot(*friction.T) <= strength / factor * (1.0 + 1e-12) + 1e-15).all()
    assert normal.min() >= 0.0


@pytest.mark.parametrize("seed", [3, 5, 8, 12])
def test_joints_that_dilate_by_their_friction_angle_rest_up_to_the_static_bound(seed) -> None:
    """Of a cone program: their forces balance at a factor below it, and none do above."""
    scene, phi = random_bench(seed)
    model = scene.model(phi)
    bound = static_bound(model).factor
    assert bound is not None
    bed = bed_of(model)
    below, above = 0.99 * bound, 1.01 * bound
    at = undilated._dilated(bed, 1.0 / below)
    assert at is not None
    forces = bed.dilating(1.0, 1.0 / below).forces(at, 1.0 / below)
    admissible(model, below, forces.normal, forces.friction, forces.strength)
    assert undilated._dilated(bed, 1.0 / above) is None


@pytest.mark.parametrize("part", [0.3, 1.0])
def test_a_bed_that_dilates_is_one_of_a_model_that_does(part) -> None:
    scene, phi = random_bench(3)
    model = scene.model(phi)
    bed, factor = bed_of(model), 0.8
    other = bed_of(replace(model, tan_dilation=part * model.tan_friction / factor))
    at = 1.3 * bed.elastic_displacement
    found, wanted = bed.dilating(part, 1.0 / factor).forces(at, 1.0 / factor), other.forces(at, 1.0 / factor)
    assert found.unbalanced == pytest.approx(wanted.unbalanced, abs=1e-13 * wanted.largest)
    plain = bed.forces(at, 1.0 / factor)  # and the bed itself does not dilate from then on
    assert np.abs(plain.unbalanced - wanted.unbalanced).max() > 1e-3 * wanted.largest


def test_blocks_rest_without_dilation(monkeypatch) -> None:
    """74 blocks a tenth before their limit: in balance, within their strength, with no dilation left."""
    model = model_of_bench(monkeypatch, 1.6)
    bed = bed_of(model)
    rest = rest_without_dilation(bed, 1.0 / 0.63)
    assert rest is not None
    assert rest.ended == "rest"
    forces = bed.forces(rest.at, 1.0 / 0.63)
    admissible(model, 0.63, forces.normal, forces.friction, forces.strength)
    # what is out of balance by a little more than it may be is no rest yet
    shaken = rest.at + 1e-6 * bed.elastic_displacement
    assert 1.0 < undilated._out(bed, bed.forces(shaken, 1.0 / 0.63)).max() < 30.0
    again = undilated._settled(bed, shaken, 1.0 / 0.63)
    assert again is not None
    assert undilated._out(bed, again.forces).max() < 1.0
    # Newton's method from the rest of the joints that dilate does not get there
    begun = undilated._dilated(bed, 1.0 / 0.63)
    assert begun is not None
    assert not bed.newton(begun, begun, 1.0 / 0.63, 0.0, None, downhill=True).settled


def test_where_nothing_balances_the_loads_there_is_no_rest(monkeypatch) -> None:
    model = model_of_bench(monkeypatch, 1.9)
    assert rest_without_dilation(bed_of(model), 1.0 / 3.0) is None


def test_large_assemblies_come_to_rest_that_way(monkeypatch) -> None:
    """As thousands of blocks do: from that first rest on to a thousandth before the limit."""
    model = model_of_bench(monkeypatch, 1.6)
    bed = bed_of(model)
    monkeypatch.setattr(rests, "_THOUSANDS", 0)
    monkeypatch.setattr(rests, "relaxed", lambda *_, **__: pytest.fail("viscous flow from the start"))
    flow, gap = rests_before(bed, LIMIT, 5e-2)
    assert flow.ended == "rest"
    assert gap <= JUST


def test_smaller_steps_where_larger_ones_lose_their_way(monkeypatch) -> None:
    """What more than a fifth of the blocks are out of balance at is not settled block by block."""
    model = model_of_bench(monkeypatch, 1.6)
    bed, hasty, calm = bed_of(model), (0.2, 3, 1), undilated._CALMER[-1]
    seen = []
    settled = undilated._settled
    monkeypatch.setattr(undilated, "_settled", lambda *args: seen.append(1) or settled(*args))
    monkeypatch.setattr(undilated, "_CALMER", (hasty,))
    assert rest_without_dilation(bed, 1.0 / 0.63) is None
    assert seen == []
    monkeypatch.setattr(undilated, "_CALMER", (hasty, calm))
    rest = rest_without_dilation(bed, 1.0 / 0.63)
    assert rest is not None
    assert len(seen) == 1
    forces = bed.forces(rest.at, 1.0 / 0.63)
    admissible(model, 0.63, forces.normal, forces.friction, forces.strength)


@pytest.mark.parametrize("spacing", [1.6, 1.2])
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


@pytest.mark.parametrize("spacing", [1.6, 1.2])
def test_from_joints_that_stick_straight_to_a_rest(monkeypatch, spacing) -> None:
    """A hair before the limit at once, and none beyond it."""
    model = model_of_bench(monkeypatch, spacing)
    bed, factor = bed_of(model), (1.0 - JUST) * LIMIT
    rest = rest_of_hundreds(bed, bed.elastic_displacement, 1.0 / factor)
    assert rest is not None
    forces = bed.forces(rest.at, 1.0 / factor)
    admissible(model, factor, forces.normal, forces.friction, forces.strength)
    assert rest_of_hundreds(bed, bed.elastic_displacement, 1.0 / (1.01 * LIMIT)) is None


def test_hundreds_of_blocks_come_to_rest_without_viscous_flow(monkeypatch) -> None:
    """A tenth before the limit, and from there a thousandth."""
    bed = bed_of(model_of_bench(monkeypatch, 1.2))
    for name in ("relaxed", "stepped", "rest_without_dilation"):
        monkeypatch.setattr(rests, name, lambda *_, **__: pytest.fail("another way"))
    flow, gap = rests_before(bed, LIMIT)
    assert flow.ended == "rest"
    assert gap <= JUST


def watched_rests(monkeypatch, first=None) -> list[float]:
    """The strengths at which a rest of hundreds is looked for; `first` is called with the first that is found."""
    strengths: list[float] = []

    def looked_for(bed, at, parameter):
        strengths.append(parameter)
        found = rest_of_hundreds(bed, at, parameter)
        return found if first is None or len(strengths) > 1 else first(found)

    monkeypatch.setattr(rests, "rest_of_hundreds", looked_for)
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
    raise EffortSpentError


@pytest.mark.parametrize("first", [far_away, too_long, lambda _: None])
def test_a_last_rest_not_found_at_once_is_led_to_by_the_first(monkeypatch, first) -> None:
    """One with five times the work of the joints that stick is another; and the search may take a part of all work."""
    strengths = watched_rests(monkeypatch, first)
    flow, gap = rests_before(bed_of(model_of_bench(monkeypatch, 1.2)), LIMIT)
    assert strengths[:3] == pytest.approx([1.0 / (LIMIT * (1.0 - gap)) for gap in (JUST, 0.1, JUST)])
    assert flow.ended == "rest"
    assert gap <= JUST


def pushed(bed: Bed, at, block: int, by: float):
    """A block out of its place by so many of its elastic displacements."""
    at = at.reshape(-1, 6).copy()
    at[block, :3] += by * np.abs(bed.elastic_displacement).max()
    return at.ravel()


def test_a_block_out_of_its_place_is_settled_by_itself(monkeypatch) -> None:
    """The others stay where they are, or, where it takes them, its neighbours settle too; all is better then."""
    bed, parameter = bed_of(model_of_bench(monkeypatch, 1.6)), 1.0 / 0.63
    rest = rest_of_hundreds(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    moved = 0
    for block in range(0, len(bed.model.load), 7):
        begun = undilated._State.at(bed, pushed(bed, rest.at, block, 1e-3), parameter)
        found = undilated._spots_settled(bed, begun, parameter, 0.05)
        near = bed.model.touching(begun.out > undilated._FAR_OUT)
        stays = (found.displacement == begun.displacement).reshape(-1, 6).all(axis=1)
        assert stays[~near].all()
        if not stays.all():
            moved += 1
            assert found.total < 0.5 * begun.total
    assert moved > 3


def test_a_place_out_of_balance_is_calmed_by_itself(monkeypatch) -> None:
    """Two blocks pushed out of their places: they and what is around them come back, all others stay."""
    bed, parameter = bed_of(model_of_bench(monkeypatch, 1.2)), 1.0 / 0.63
    rest = rest_of_hundreds(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    last = len(bed.model.load) - 1
    at = pushed(bed, pushed(bed, rest.at, 3, 1e-4), last, 1e-4)
    begun = undilated._State.at(bed, at, parameter)
    monkeypatch.setattr(undilated, "_PLACES", 0.001)
    assert undilated._parts_calmed(bed, begun, parameter) is begun  # too much of the bench
    monkeypatch.setattr(undilated, "_PLACES", 0.2)
    found = undilated._parts_calmed(bed, begun, parameter)
    assert found.total < 1e-3 * begun.total
    assert found.out[[3, last]].max() < undilated._NEARLY
    near = begun.out > undilated._NEARLY
    for _ in range(undilated._RINGS):
        near = bed.model.touching(near)
    stays = (found.displacement == at).reshape(-1, 6).all(axis=1)
    assert stays[~near].all()
    assert not stays[[3, last]].any()


def test_each_spot_takes_steps_of_its_own_length(monkeypatch) -> None:
    """Two blocks that do not touch: a step to their rest is taken whole, one far beyond it is cut; a third is best."""
    bed, parameter = bed_of(model_of_bench(monkeypatch, 1.6)), 1.0 / 0.63
    rest = rest_of_hundreds(bed, bed.elastic_displacement, parameter)
    assert rest is not None
    one = 0
    other = int(np.flatnonzero(~bed.model.touching(np.arange(len(bed.model.load)) == one))[-1])
    few = bed.among(np.array([one, other]), rest.at)
    label = undilated._labels(bed.model, np.isin(np.arange(len(bed.model.load)), [one, other]))
    assert label.tolist() == [0, 1]
    goal = rest.at.reshape(-1, 6)[[one, other]]
    away = np.full((2, 6), 1e-3 * np.abs(goal).max()) * [[1.0], [-1.0]]
    here = undilated._State.at(few, (goal + away).ravel(), parameter)
    way = -away * [[1.0], [10.0]]
    found = undilated._cut_short(few, here, way.ravel(), parameter, label)
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
    assert len(work) == 2


def test_a_rest_of_its_own_near_a_limit_where_no_way_leads_there(monkeypatch) -> None:
    """Blocks in thousands that do not come from a tenth before a limit to nearer than a twentieth."""
    model = model_of_bench(monkeypatch, 1.6)
    bed = bed_of(model)
    monkeypatch.setattr(rests, "_THOUSANDS", 0)
    nowhere = Flow(bed.elastic_displacement, bed.forces(bed.elastic_displacement, 1.0), "slow", np.zeros(bed.size), 1.0)
    monkeypatch.setattr(rests, "relaxed", lambda *args, **kwargs: nowhere)
    monkeypatch.setattr(rests, "rest_from", lambda *args: None)
    monkeypatch.setattr(rests, "stepped", lambda bed, at, *rest: NewtonStep(at, 1.0, nowhere.forces, False, 0))
    flow, gap = rests_before(bed, LIMIT, 0.05)
    assert flow.ended == "rest"
    assert gap == pytest.approx(0.04)
    factor = LIMIT * (1.0 - gap)
    forces = bed.forces(flow.at, 1.0 / factor)
    admissible(model, factor, forces.normal, forces.friction, forces.strength)
