"""The path of rounded joints: its linearised equations, and limits against histories and closed forms."""

import math
from dataclasses import replace
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

import slopekit as sk
from benchmarks import populations
from benchmarks.benches import bench
from slopekit.preie.elastic_path import traced as traced_room
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.flow import stepped
from slopekit.preie.elastic_path.path import follow
from slopekit.preie.elastic_path.path_limit import PathLimit, PathOutcome
from slopekit.preie.elastic_path.rounded import RoundedPath
from slopekit.preie.elastic_path.traced import traced_in_section
from slopekit.preie.many_blocks import ravelling
from slopekit.preie.many_blocks.blocks_limit import Basis
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie import path_oracle
from tests.preie.block_scenes import boxes_in_space, first_part, wall

SECTIONS = [("wall", 0), ("section", 42)]


def bed_of(model: AssemblyModel) -> Bed:
    return Bed(model, Drive(model.load.ravel()))


def limit_of(model: AssemblyModel) -> float:
    """F of the path, which has to have settled."""
    found = follow(bed_of(model), 2.0 / static_bound(model).factor)
    assert found.outcome is PathOutcome.SETTLED
    return 1.0 / found.parameter


def begun(counts):
    """The bed of boxes in space, and its rounded path from rest at twice the strength of the static bound."""
    model = boxes_in_space(counts, (2.0, 3.0, 1.0), 25.0, 0.3).model(35.0, 1.0)
    bed = bed_of(model)
    path = RoundedPath(bed, 1e-2)
    strength = 2.0 / static_bound(model).factor
    step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, strength, 0.0)
    assert path.begin(step.at, strength)
    return bed, path


def test_the_equations_are_solved_by_newtons_method() -> None:
    """What is off after a step in a small part of what Newton's equations say falls by that part: first order."""
    _, path = begun((2, 1, 2))
    work, product = path._work + 0.3, path._product(path._work, path._rounding)
    off, solve = path._linear(path._at, work, product)
    change = solve(off)
    for part in (1e-3, 1e-4):
        left, _ = path._linear(path._at.plus(change, part), work, product)
        for name in ("balance", "opening", "shear", "pressing", "sliding", "across", "work"):
            before, after = np.asarray(getattr(off, name)), np.asarray(getattr(left, name))
            slope = (after - before) / part
            scale = max(float(np.abs(before).max()), product)
            assert slope == pytest.approx(-before, abs=200.0 * part * scale), name


def test_sharpened_states_are_those_of_the_joints() -> None:
    """Newton's method on the joints of `elastic_path.bed` changes λ by no more than what the rounding has left."""
    bed, path = begun((2, 2, 2))
    assert path.onto(1e3, 400)
    sharp = path.sharpened(400)
    assert sharp is not None
    at = sharp.displacement
    exact = stepped(bed, at, at, sharp.reduction, 0.0, float(bed.working @ at))
    assert exact.settled
    assert exact.parameter == pytest.approx(sharp.reduction, rel=1e-7)


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
    assert found.factor == pytest.approx(math.tan(math.radians(35.0)) / math.tan(math.radians(45.0)), rel=1e-8)


def test_a_wall_of_many_blocks_that_slides_on_its_base() -> None:
    """105 blocks in running bond: tan φ / tan β by hand."""
    model = wall(10, 10, 20.0).model(35.0)
    found = follow(bed_of(model), 2.0 / static_bound(model).factor)
    assert found.found
    exact = math.tan(math.radians(35.0)) / math.tan(math.radians(20.0))
    assert 1.0 / found.parameter == pytest.approx(exact, rel=1e-8)


def traced(model: AssemblyModel, rounding: float) -> PathLimit | None:
    """The limit with joints so much rounded, from rest at twice the strength of the static bound."""
    bed, strength = bed_of(model), 2.0 / static_bound(model).factor
    step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, strength, 0.0)
    assert step.settled
    return traced_in_section(bed, step.at, strength, (rounding,))


@pytest.mark.parametrize(("population", "number"), SECTIONS)
def test_limits_of_rounded_sections_are_those_of_sharp_ones(population, number) -> None:
    """The limit state of the sharp path, and a history of incremental slip, that locks in other forces: half a percent.

    Section 42 has its limit 4 % below the static bound.
    """
    model = path_oracle.model_of(getattr(populations, population)(number))
    strength = 2.0 / static_bound(model).factor
    found, exact = traced(model, 1e-2), follow(bed_of(model), strength)
    assert found is not None
    assert exact.outcome is PathOutcome.LIMIT
    assert found.parameter == pytest.approx(exact.parameter, rel=1e-7)
    history = path_oracle.history(model, strength)
    assert history.end == "settled"
    assert 1.0 / found.parameter == pytest.approx(history.factor, rel=5e-3)


@pytest.mark.parametrize(("population", "number"), SECTIONS)
def test_a_section_too_large_for_its_modes_settles_where_they_are_exact(population, number, monkeypatch) -> None:
    """λ goes like the limit plus a part of 1 / work: beside the limit state that a smaller section gets."""
    model = path_oracle.model_of(getattr(populations, population)(number))
    exact = traced(model, 1e-2)
    monkeypatch.setattr(traced_room, "BORDERED", 0)
    found = traced(model, 1e-2)
    assert (exact.outcome, found.outcome) == (PathOutcome.LIMIT, PathOutcome.SETTLED)
    assert found.parameter == pytest.approx(exact.parameter, rel=3e-6)


@pytest.mark.parametrize(("drift", "settles"), [(1e-8, True), (1e-5, False)])
def test_sharp_states_that_do_not_agree_are_no_limit(drift, settles, monkeypatch) -> None:
    """λ that still moves to and fro by 1e-5 from one mark to the next."""
    calls = count()

    class Drifting(RoundedPath):
        def sharpened(self, *args):
            sharp = super().sharpened(*args)
            moved = sharp.reduction * (1.0 + drift * (-1.0) ** next(calls))
            return SimpleNamespace(
                reduction=moved, displacement=sharp.displacement, work=sharp.work, forces=sharp.forces, bed=sharp.bed
            )

    monkeypatch.setattr(traced_room, "BORDERED", 0)
    monkeypatch.setattr(traced_room, "RoundedPath", Drifting)
    assert (traced(path_oracle.model_of(populations.wall(0)), 1e-2) is not None) == settles


def test_rounding_that_leads_to_another_motion_is_found_out() -> None:
    """Two blocks: with corners rounded by all of their elastic displacement they do not settle, sharp at 1.35387."""
    model = path_oracle.model_of(populations.section(42))
    history = path_oracle.history(model, 2.0 / static_bound(model).factor)
    found = traced(model, 1e-4)
    assert found is not None
    assert 1.0 / found.parameter == pytest.approx(history.factor, rel=5e-3)
    assert traced(model, 1.0) is None


def test_slips_in_a_section_may_turn_round() -> None:
    """A step is taken as it is where every factor of the products stays above zero, else each keeps a tenth."""
    bed = bed_of(wall(3, 3).model(35.0))
    path = RoundedPath(bed, 1e-2)
    assert path.begin(bed.elastic_displacement, 1.0)
    at, product = path._at, path._product(path._work, path._rounding)
    none = at.times(0.0)
    turned = replace(none, slip=-2.0 * at.slip, friction=-2.0 * at.friction)  # z and T both change sides
    after = path._moved(at, turned, product)
    allowed, carried, slip = at.reduction * path._strength(at.normal), np.abs(at.friction), np.abs(at.slip)
    free = (at.size[:, None] - slip > 0.1 * (at.size[:, None] + slip)) & (slip > 0.0)
    free &= allowed[:, None] - carried > 0.1 * (allowed[:, None] + carried)
    assert free.any()
    assert after.slip[free] == pytest.approx(-at.slip[free])
    assert after.friction[free] == pytest.approx(-at.friction[free])
    far = path._moved(at, replace(none, slip=at.slip - 1e3 * at.size[:, None], friction=1e3 * at.friction), product)
    for sign in (1.0, -1.0):
        assert (allowed + sign * far.friction[:, 0] > 0.0).all()
        assert (far.size + sign * far.slip[:, 0] > 0.0).all()


def reordered(model: AssemblyModel) -> AssemblyModel:
    """The same blocks in another order."""
    order = np.random.default_rng(3).permutation(len(model.load))
    place = np.append(np.argsort(order), -1)
    columns = (order[:, None] * model.unknowns + np.arange(model.unknowns)).ravel()
    return replace(
        model, plus=place[model.plus], minus=place[model.minus], load=model.load[order], moving=model.moving[order],
        live=model.live[order], kinematics=model.kinematics[:, columns].tocsr(),
        statics=model.statics[columns].tocsr(),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("size", "reached", "tried"), [(99, False, 2), (100, False, 2), (101, False, 1), (101, True, 2)]
)
def test_of_many_blocks_no_other_rounding_is_tried_where_the_least_gets_nowhere(
    size, reached, tried, monkeypatch
) -> None:
    begun = []

    class Curve:
        reduction = 1.0

        def __init__(self, bed, rounding):
            begun.append(rounding)

        def begin(self, at, parameter):
            return True

        def onto(self, mark, most):
            return reached

        def sharpened(self, most):
            return None

    monkeypatch.setattr(traced_room, "RoundedPath", Curve)
    assert traced_room.traced(SimpleNamespace(size=size), np.zeros(6), 1.0) is None
    assert len(begun) == tried


def test_a_path_that_is_thrown_far_off_is_none(monkeypatch) -> None:
    """Bench 619: Newton's method went to slips of 1e270, where strength does no work, and there divided by zero.

    That was on contacts split twice; splitting them once more says nothing of it.
    """
    monkeypatch.setattr(ravelling, "_MOST_SPLIT", 2)
    design = populations.bench(619, 40)
    design["strength"]["joint"]["c"] = 0.0
    found = sk.run(design)
    assert "W317" in [notice.code for notice in found.warnings]
    assert 0.0 < found.fos.limit <= found.fos.static_bound
