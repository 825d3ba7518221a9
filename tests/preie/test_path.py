"""The limit of the elastic path: its prototype (docs/method.md), closed forms, invariances, derivatives."""

import math
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise

import numpy as np
import pytest

import slopekit as sk
from benchmarks import populations
from slopekit.geometry.patches import BEDROCK
from slopekit.kinds.assemblies.many_blocks_states import states_of_part
from slopekit.loads import PassiveBolts
from slopekit.preie.elastic_path import path
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState, Drive
from slopekit.preie.elastic_path.flow import Flow
from slopekit.preie.elastic_path.path import (
    first_equilibrium,
    has_crept,
    next_equilibrium,
    trace_limit,
)
from slopekit.preie.elastic_path.path_limit import PathOutcome, limit_state
from slopekit.preie.many_blocks import blocks
from slopekit.preie.many_blocks.blocks import limit_of_blocks, load_limit
from slopekit.preie.many_blocks.blocks_limit import Basis, BlocksLimit
from slopekit.preie.many_blocks.ravelling import SolvedComponent, _too_coarse
from slopekit.preie.one_block.pairs_limit import pairs_limit
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs.bounds import frictionless_equilibrium, static_bound
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import FAR
from tests.preie import load_oracle, path_oracle
from tests.preie.block_scenes import (
    Scene,
    active_passive,
    bench,
    boxes_in_space,
    first_part,
    rectangles,
    stack,
)
from tests.preie.path_oracle import model_of
from tests.preie.pressed import pressed_part, pressed_shares_of_pairs
from tests.preie.sections import paper_wedge
from tests.properties import test_not_unique as designs

BENCH = (("45/170", 7.0), ("80/350", 8.0), ("85/80", 8.0))
GOODMAN_BRAY = 0.99995683510396


def tangent(degrees: float) -> float:
    return math.tan(math.radians(degrees))


def weaker(model: AssemblyModel, by: float) -> AssemblyModel:
    """c and tan φ divided."""
    return replace(model, cohesion=model.cohesion / by, tan_friction=model.tan_friction / by)


@pytest.mark.parametrize(("times", "holds"), [(1.005, True), (0.995, False)])
def test_a_limit_state_has_the_strength_and_the_motion_of_its_modes(times, holds) -> None:
    """Two blocks that slide on 30° together: the joint between them carries tan 30° of its normal force, if it can."""
    model = stack(2, width=6.0, joint_of_base=1).model(
        [math.degrees(math.atan(times * tangent(31.0))), 31.0]
    )
    bed, exact = (
        ElasticContactModel(model, Drive(model.load.ravel())),
        tangent(30.0) / tangent(31.0),
    )
    upper, both = np.zeros((2, 3)), np.zeros((2, 3))
    both[:, :2] = upper[1, :2] = -tangent(60.0) / 2.0, -0.5
    slip = np.abs(bed.motion(bed.elastic_displacement, exact)[1]).max()
    at = bed.elastic_displacement + slip * (100.0 * both - 0.05 * upper).ravel()
    assert bed.forces(at, exact).slips.tolist() == [True, False]
    found = limit_state(bed, at, both.ravel(), exact)
    assert (found is not None) is holds
    assert found is None or found.parameter == pytest.approx(exact, rel=1e-12)
    assert limit_state(bed, at, -both.ravel(), exact) is None  # friction does not push


# -- the table of the prototype of the path ---------------------------------------------------------------------------

#: Limit, range of its mechanism and static bound there; None: not given, or no end (forces jam without one).
TABLE = {
    "two blocks": (designs.TWO_BLOCKS, 0.529555, (0.52049, 0.52955), 0.52956),
    "shards": (designs.SHARDS, 3.749624, (3.7050, 3.7496), 3.74962),
    "bonded row": (designs.BONDED_ROW, 1.531150, (1.5001, 1.5312), 1.53506),
    "rough columns": (designs.ROUGH_COLUMNS, 0.8175, (0.669, 0.971), 1.000),
    "bonded columns": (designs.BONDED_COLUMNS, 0.172230, (None, 0.4144), 0.468),
    "Goodman & Bray": (designs.GOODMAN_BRAY, GOODMAN_BRAY, (0.799, 1.111), 1.19089),
}
NOT_ONE_NUMBER = {
    "rough columns": 5e-4
}  # and what the limit is to be known to: the table has three digits, 0.818


@pytest.fixture(scope="module", params=TABLE)
def tabled(request) -> tuple[str, AssemblyModel, BlocksLimit]:
    model = model_of(TABLE[request.param][0])
    return request.param, model, limit_of_blocks(model)


def test_the_limit_is_that_of_the_table(tabled) -> None:
    name, _, found = tabled
    _, factor, _, bound = TABLE[name]
    assert (found.outcome, found.basis, found.change) == (Outcome.SLIDES, Basis.LIMIT, 0.0)
    assert found.factor == pytest.approx(factor, abs=NOT_ONE_NUMBER.get(name, 1e-6))
    assert found.static_bound == pytest.approx(bound, abs=5e-4)


def test_the_range_is_that_of_the_table(tabled) -> None:
    name, _, found = tabled
    low, high = TABLE[name][2]
    assert found.highest == pytest.approx(high, abs=1e-3)
    if low is not None:
        assert found.lowest == pytest.approx(low, abs=1e-3)
    assert (found.lowest or 0.0) <= found.factor <= found.highest <= found.static_bound


def test_strength_divided_divides_the_limit(tabled) -> None:
    """F(strength/k) k = F: the path starts at 2/S and never sees the strength but through λ."""
    _, model, found = tabled
    other = limit_of_blocks(weaker(model, 3.0), ranged=False)
    assert other.basis is Basis.LIMIT
    assert 3.0 * other.factor == pytest.approx(found.factor, rel=1e-9)


def test_cohesion_acts_on_what_is_pressed(tabled) -> None:
    """docs/method.md: the share of a contact by the straight line through the closings of its pairs, N / a.

    Where one end alone is pressed that line is not known from its forces.
    """
    name, model, found = tabled
    shares = []
    for contact in np.unique(model.pair_contact[model.cohesion > 0.0]):
        pairs = np.flatnonzero(model.pair_contact == contact)
        closing, along = (
            found.normal_force[pairs] / model.control_area[pairs],
            np.linspace(0.0, 1.0, len(pairs)),
        )
        touching = closing > 0.0
        if touching.sum() == 1:
            continue
        share = 0.0
        if touching.any():
            slope, at_start = np.polyfit(along[touching], closing[touching], 1)
            share = pressed_part(np.array([[0.0], [1.0]]), -np.array([at_start, at_start + slope]))
        assert found.bond[pairs] == pytest.approx(share, abs=1e-6)
        shares.append(share)
    partly = [0.0 < share < 1.0 for share in shares]
    assert sum(partly) == {"bonded row": 3, "bonded columns": 1}.get(name, 0)


@pytest.mark.parametrize("ratio", [0.1, 0.4, 1.0])
def test_columns_have_their_closed_form_whatever_the_stiffness(ratio) -> None:
    """Goodman & Bray to 14 digits (as the prototype of the path): rounding of a hundred factorisations."""
    found = limit_of_blocks(model_of(designs.GOODMAN_BRAY), ranged=False, ratio=ratio)
    assert found.basis is Basis.LIMIT
    assert found.factor == pytest.approx(GOODMAN_BRAY, rel=1e-12)


def test_a_longer_row_of_columns_has_its_closed_form() -> None:
    """32 columns of the same slope, limit equilibrium column by column; 11 digits and more."""
    found = limit_of_blocks(model_of(populations.goodman_bray(32)), ranged=False)
    assert found.basis is Basis.LIMIT
    assert found.factor == pytest.approx(populations.goodman_bray_factor(32), rel=1e-10)


@pytest.mark.parametrize("count", [64])
def test_columns_are_followed_past_their_peak(count) -> None:
    """Elastic columns carry 5 % more than the closed form before they run."""
    found = limit_of_blocks(model_of(populations.goodman_bray(count)), ranged=False)
    assert found.basis is Basis.LIMIT
    assert found.factor == pytest.approx(populations.goodman_bray_factor(count), rel=1e-10)


# -- no factor above the bound, none where nothing rests --------------------------------------------------------------


@pytest.mark.parametrize("number", [0, 2, 5])
def test_no_factor_of_a_wall_is_above_its_bound(number) -> None:
    """Random dry walls under horizontal load; the bound of all blocks by linear programs (HiGHS) and bisection."""
    model = model_of(populations.wall(number))
    found = limit_of_blocks(model, ranged=False)
    bound = path_oracle.static_bound(model, 1e-7, found.static_bound)
    assert found.static_bound == pytest.approx(bound, rel=1e-5)
    assert found.factor is None or found.factor <= bound * (1.0 + 1e-6)
    assert found.outcome in (Outcome.SLIDES, Outcome.NO_REST)
    assert (found.factor is None) is (found.outcome is Outcome.NO_REST)
    if found.tips is not None:  # a part of the horizontal load is too much at any strength
        assert found.factor is None
        assert 0.0 < found.tips[0] < 1.0


def test_a_wall_that_comes_to_rest_at_no_strength() -> None:
    """A history does not come to rest either, at strengths up to 512 times its own; rigid blocks jam at 0.704."""
    model = model_of(populations.wall(5))
    assert path_oracle.history(model, 4.0).end == "no rest at the start"
    found = limit_of_blocks(model, ranged=False)
    assert (found.outcome, found.factor, found.basis) == (Outcome.NO_REST, None, Basis.NONE)
    assert found.static_bound == pytest.approx(
        path_oracle.static_bound(model, 1e-6, found.static_bound), rel=1e-5
    )


@pytest.mark.parametrize("number", [1, 37])
def test_walls_that_tip_are_said_to_do_so_whatever_the_strength(number) -> None:
    """The motion is that of a limit state without slip, at any strength, by a linear program (HiGHS).

    A history carries as much of the load, 0.2 % below it at most, which is its step; rigid blocks would jam.
    """
    model = model_of(populations.wall(number))
    found = limit_of_blocks(model, ranged=False)
    assert (found.outcome, found.factor) == (Outcome.NO_REST, None)
    part, factor = found.tips
    for times in (1.0, 2.0, 1000.0):
        assert load_oracle.tips_whatever_the_strength(model, found.velocity, part, times / factor)
    for other in (0.999 * part, 1.001 * part):
        assert not load_oracle.tips_whatever_the_strength(
            model, found.velocity, other, 1.0 / factor
        )
    assert load_oracle.comes_on(model, 1.0 / factor) == pytest.approx(part - 1e-3, abs=1e-3)


def test_normal_forces_that_hold_blocks_balance_their_load() -> None:
    """One box on another: their weights. Pushed along the joint nothing but friction holds it."""
    model = boxes_in_space((1, 1, 2), (2.0, 2.0, 2.0), 0.0).model(35.0, 5.0)
    normal = frictionless_equilibrium(model, model.load.ravel())
    unbalanced = model.unbalanced(normal, np.zeros(model.slip_rows.shape[:2]))
    assert np.abs(unbalanced).max() < 1e-9
    pushed = model.load.copy()
    pushed[1, 0] = 1e-3 * abs(pushed[1, 2])
    assert frictionless_equilibrium(model, pushed.ravel()) is None


@pytest.mark.parametrize(("number", "times", "path"), [(106, 4.0, 0.21731899832404)])
def test_walls_that_rest_only_at_more_strength_have_their_last_rest(number, times, path) -> None:
    """Within 1 % below the prototype of the path, all loads on at so many times the static bound's strength.

    The motion that runs from the last rest leads to another limit, half as high (0.1093), that is none of the blocks'.
    A history that brings the load on last carries all of it at ten times that strength, and not at twice.
    """
    model = model_of(populations.wall(number))
    found = limit_of_blocks(model)
    assert found.basis is Basis.PEAK
    assert 0.99 * path < found.factor < path
    start, _ = first_equilibrium(
        ElasticContactModel(model, Drive(model.load.ravel())), 2.0 / found.static_bound, 7
    )
    assert start * found.static_bound == pytest.approx(times, rel=1e-9)
    carried = [load_oracle.comes_on(model, times / found.static_bound) for times in (2.0, 10.0)]
    assert carried[0] < 1.0 == carried[1]


def test_a_path_that_creeps_ends_at_the_same_limit_wherever_it_begins(monkeypatch) -> None:
    """Two blocks that move some 2,000 elastic displacements between 1.2 and 5.5, at three strengths to begin with."""
    model, ended = model_of(populations.bench(30)), []
    for times in (1.0, 4.0, 16.0):
        monkeypatch.setattr(blocks, "START", 2.0 * times)
        ended.append(limit_of_blocks(model, ranged=False))
    assert [found.basis for found in ended] == [Basis.LIMIT] * 3
    assert [found.factor for found in ended] == pytest.approx([ended[0].factor] * 3, rel=1e-8)
    assert ended[0].factor < ended[0].static_bound < 1.05 * ended[0].factor


def test_a_last_rest_of_blocks_that_crept_has_the_factor_near_where_they_set_off_as_its_lowest() -> (
    None
):
    """Bench 9: within 30 elastic displacements at its lowest, farther at its factor."""
    model = model_of(populations.bench(9))
    found = limit_of_blocks(model)
    assert found.basis is Basis.PEAK
    assert found.lowest < 0.99 * found.factor
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    _, flow = first_equilibrium(bed, 2.0 / found.static_bound, 7)
    near, beyond = (
        next_equilibrium(bed, flow.displacement, 1.0 / factor)
        for factor in (found.lowest, found.factor)
    )
    assert (near.ended, has_crept(bed, near)) == ("rest", False)
    assert beyond.ended != "rest" or has_crept(bed, beyond)


def cohesive_bench(number: int, cohesion: float) -> AssemblyModel:
    """Bench 3 (one block moves) or 41 (four), all its joints with that cohesion (kPa)."""
    design = populations.bench(number)
    design["strength"]["joint"]["c"] = cohesion
    return model_of(design)


@pytest.mark.parametrize("number", [3, 41])
def test_more_cohesion_never_lowers_a_limit(number) -> None:
    """At the same node pairs, but for the 1e-4 to which a last rest is known.

    Without cohesion the blocks creep past the strength at which they snap with some; where that snap was their end,
    1 kPa lowered 0.645 to 0.539 and 5 kPa 1.69 to 1.58.
    """
    factors = [
        limit_of_blocks(cohesive_bench(number, c), ranged=False).factor
        for c in (0.0, 0.2, 1.0, 5.0, 20.0)
    ]
    assert all(more > less * (1.0 - 2e-4) for less, more in pairwise(factors))


@pytest.mark.parametrize(
    ("number", "cohesion"), [(3, 0.0), (3, 1.0), (41, 0.0), (41, 1.0), (41, 5.0)]
)
def test_blocks_that_run_and_rest_once_more_have_the_limit_of_a_history(number, cohesion) -> None:
    """A history in which slip stays, and cohesion acts at pairs that are pressed, within 3 % (the first mesh).

    At 30 elastic displacements it runs, at less than 0.8 of its limit; its motion then has that limit.
    """
    model = cohesive_bench(number, cohesion)
    found = limit_of_blocks(model, ranged=False)
    joints = path_oracle.PressedJoints(path_oracle.arrays_of(model), 0.4)
    ended = path_oracle.history(model, 2.0 / found.static_bound, bed=joints)
    assert (ended.end, ended.peak < 0.8 * ended.factor) == ("settled", True)
    assert found.factor == pytest.approx(ended.factor, rel=0.03)
    assert found.factor < found.static_bound


@pytest.mark.parametrize(
    ("number", "peak"), [(41, 0.365), (50, 2.13), (79, 0.714), (85, 2.54), (94, 0.992)]
)
def test_a_motion_is_followed_until_its_forces_settle(number, peak) -> None:
    """A history in which slip stays has its peak elsewhere and the same limit, to 1e-6 (the first mesh, no cohesion).

    Bench 50 rests at 2.13, and its motion has a limit of 1.79, some million elastic displacements on.
    """
    model = cohesive_bench(number, 0.0)
    found = limit_of_blocks(model, ranged=False)
    joints = path_oracle.PressedJoints(path_oracle.arrays_of(model), 0.4)
    ended = path_oracle.history(model, 2.0 / found.static_bound, bed=joints)
    assert ended.end == "settled"
    assert ended.peak == pytest.approx(peak, rel=5e-3)
    assert found.basis in (Basis.LIMIT, Basis.SETTLED)
    assert found.factor == pytest.approx(ended.factor, rel=1e-6)


def test_a_last_rest_on_finer_pairs_raises_no_limit_of_a_motion() -> None:
    """Bench 50: on finer node pairs only a rest is found, 18.6 % higher than the limit of the motion; it is said."""
    found = sk.run(populations.bench(50))
    assert found.fos.limit == pytest.approx(1.7917646, rel=1e-6)
    assert "by 18.6 %" in {notice.code: notice.message for notice in found.warnings}["W312"]
    assert found.fos.lowest == pytest.approx(
        1.5135651, rel=1e-6
    )  # a block that others press on, by forces alone
    assert found.fos.highest == pytest.approx(found.fos.limit, rel=5e-4)


def test_a_rest_beyond_ten_thousand_elastic_displacements_is_none() -> None:
    """The block of bench 28 creeps on without end as its strength falls: the path ends where it is that far off."""
    model = cohesive_bench(28, 1.0)
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    found = trace_limit(bed, 2.0 / static_bound(model).factor)
    assert found.outcome is PathOutcome.BRACKET
    assert 0.8 * FAR < bed.relative_work(found.displacement) <= FAR
    onward = next_equilibrium(bed, found.displacement, found.parameter / 1.01)
    assert onward.ended == "runs" or bed.relative_work(onward.displacement) > FAR


@pytest.mark.parametrize("part", [0.01, 0.1])
def test_the_factor_tends_to_that_without_cohesion_as_cohesion_goes(part) -> None:
    """Section 103, whose motion after a snap has a limit ten times lower: no other motion's limit is its factor."""
    none, some = (populations.section(103) for _ in range(2))
    for design, times in ((none, 0.0), (some, part)):
        for strength in design["strength"].values():
            strength["c"] = times * strength["c"]
    limits = [limit_of_blocks(model_of(design), ranged=False).factor for design in (none, some)]
    assert limits[0] <= limits[1] < limits[0] * (1.0 + 0.1 * part)


@pytest.mark.parametrize("number", [104, 419])
def test_columns_that_rest_only_at_more_strength_have_the_limit_of_the_path(number) -> None:
    """Sections 59, 104, 419: a history of all loads at once, cohesion lost where contacts open."""
    model = model_of(populations.section(number))
    found = limit_of_blocks(model, ranged=False)
    ended, _ = path_oracle.with_bonds(model, 2.0 / found.static_bound)
    assert (found.basis, ended.end) == (Basis.LIMIT, "settled")
    assert found.factor == pytest.approx(ended.factor, rel=1e-7)


def test_a_push_that_holds_columns_up_comes_on_with_their_weight() -> None:
    """Section 369: weight alone does not rest. A history of all loads at once, cohesion lost where contacts open."""
    model = model_of(populations.section(369))
    assert load_oracle.comes_on(model, 4.0) == 0.0
    found = limit_of_blocks(model, ranged=False)
    ended, _ = path_oracle.with_bonds(model, 2.0 / found.static_bound)
    assert ended.end == "settled"
    assert found.factor == pytest.approx(ended.factor, rel=1e-7)


def test_no_friction_holds_an_arch_too_thin_to_stand() -> None:
    """t/R = 0.1 is below Milankovitch's 0.1075: no forces balance its weight."""
    found = limit_of_blocks(model_of(populations.arch(0.1, 0.7)))
    assert (found.outcome, found.factor, found.static_bound) == (Outcome.LIFTED, None, None)


def test_an_arch_that_stands_has_the_factor_of_its_least_friction() -> None:
    """Cocchetti & Rizzi (2020), six digits of μ: 0.309215 at t/R = 0.200637."""
    found = limit_of_blocks(model_of(populations.arch()), ranged=False)
    assert found.factor == pytest.approx(0.6 / 0.309215, rel=3e-6)


@pytest.mark.parametrize("phi", [20.0, 60.0, 85.0])
def test_a_column_that_topples_has_no_factor_at_any_friction(phi) -> None:
    """1 m by 3 m on 30°: its weight acts outside its base, no force on the base balances it."""
    model = rectangles([(0, 1, 0, 3)], 30.0).model(phi)
    found = limit_of_blocks(model)
    assert (found.outcome, found.factor, found.static_bound) == (Outcome.LIFTED, None, None)
    assert path_oracle.static_bound(model) is None


def test_columns_that_lean_on_each_other_are_not_said_to_rest_at_no_strength() -> None:
    """Two columns 3 m and 2 m high, 1 m wide, on 30°: each topples alone, side by side they jam.

    Histories begun at three strengths come to rest and end at 1.592 to 1.595, below the bound of 2.21.
    """
    model = rectangles([(0, 1, 0, 3), (1, 2, 0, 2)], 30.0).model(60.0)
    assert path_oracle.history(model, 1.0).end == "settled"
    found = limit_of_blocks(model, ranged=False)
    assert found.static_bound == pytest.approx(
        path_oracle.static_bound(model, 1e-6, found.static_bound), rel=1e-5
    )
    assert found.outcome is not Outcome.NO_REST
    assert found.factor is None or found.factor <= found.static_bound


def test_columns_twice_as_wide_stand_on_their_own() -> None:
    """tan 60° / tan 30°, exactly."""
    found = limit_of_blocks(rectangles([(0, 2, 0, 3), (2, 4, 0, 2)], 30.0).model(60.0))
    assert found.factor == pytest.approx(tangent(60) / tangent(30), rel=1e-9)


def test_the_static_bound_of_a_frame_is_one_at_its_published_associated_multiplier() -> None:
    """None of its 14 blocks is held: with some held it was 1.24 (by the global solver)."""
    assert static_bound(model_of(populations.frame())).factor == pytest.approx(1.0, rel=1e-6)


@pytest.mark.slow
def test_the_static_bound_of_two_hundred_columns() -> None:
    """Rough programs have the wrong sign there: the bound closed at 0.9577, with a twentieth of the load to spare."""
    model = model_of(populations.goodman_bray(200))
    found = static_bound(model).factor
    assert found == pytest.approx(path_oracle.static_bound(model, 1e-6, found), rel=1e-5)


def test_what_a_bound_is_not() -> None:
    """Lifted: no strength balances the load. Locked: any does. Else a factor, here of a stack: tan 35° / tan 30°."""
    scene = stack(2, width=9.0)
    lifted = static_bound(replace(scene, forces=-scene.forces).model(35.0))
    assert (lifted.factor, lifted.lifted, lifted.locked) == (None, True, False)
    level = static_bound(stack(2, dip=0.0, width=9.0).model(35.0))
    assert (level.factor, level.lifted, level.locked) == (None, False, True)
    found = static_bound(scene.model(35.0))
    assert found.factor == pytest.approx(tangent(35) / tangent(30), rel=1e-6)
    assert (found.lifted, found.locked) == (False, False)


# -- space ------------------------------------------------------------------------------------------------------------


def rolled(scene: Scene, by: int) -> Scene:
    """Every polygon from another corner on."""
    patches = scene.patches
    parts = np.split(patches.corners, patches.first[1:-1])
    return replace(
        scene,
        patches=replace(
            patches, corners=np.concatenate([np.roll(part, by, axis=0) for part in parts])
        ),
    )


@cache
def limit_in_space(name: str) -> BlocksLimit:
    return limit_of_blocks(SPACE[name](), ranged=False)


@pytest.mark.parametrize("by", [2])
def test_the_first_corner_does_not_matter(by) -> None:
    """A bench of scattered joints: contacts of three to seven corners."""
    scene = bench(BENCH, scatter=3.0, seed=4)
    assert len(set(np.diff(scene.patches.first))) > 2
    one, other = (
        limit_in_space("bench"),
        limit_of_blocks(rolled(scene, by).model(30.0), ranged=False),
    )
    assert one.factor is not None
    assert other.factor == pytest.approx(one.factor, rel=1e-8)
    assert other.static_bound == pytest.approx(one.static_bound, rel=1e-6)


SPACE = {
    "boxes": lambda: boxes_in_space((2, 2, 2), (2.0, 3.0, 1.0), 25.0, 0.3).model(35.0, 1.0),
    "bench": lambda: bench(BENCH, scatter=3.0, seed=4).model(30.0),
}


@pytest.mark.parametrize("by", [3.0])
def test_the_strength_does_not_move_the_static_bound_of_blocks_that_jam(by) -> None:
    """Bench 15: its bound is flat towards where blocks jam, and searches from λ = 1 ended up to 5 % apart."""
    model = first_part(populations.bench(15)).model
    one, other = (limit_of_blocks(given, ranged=False) for given in (model, weaker(model, by)))
    assert by * other.factor == pytest.approx(one.factor, rel=1e-9)
    assert by * other.static_bound == pytest.approx(one.static_bound, rel=1e-6)


@pytest.mark.slow
def test_contacts_that_twist_are_told_by_what_they_carry_at_the_limit() -> None:
    """c and F a million times as high: the same contacts, though c alone would be all that they carry."""
    part = first_part(populations.bench(9))
    model, limit = part.model, part.limit
    stronger = replace(model, cohesion=1e6 * model.cohesion)
    twists = _too_coarse(
        replace(part, model=stronger, limit=replace(limit, factor=1e6 * limit.factor))
    )
    assert twists.any()
    assert (twists == _too_coarse(part)).all()


@pytest.mark.parametrize("name", SPACE)
def test_strength_divided_divides_the_limit_in_space(name) -> None:
    model = SPACE[name]()
    one, other = limit_in_space(name), limit_of_blocks(weaker(model, 3.0), ranged=False)
    assert 3.0 * other.factor == pytest.approx(one.factor, rel=1e-9)


@pytest.mark.parametrize("psi", [0.0, 10.0])
def test_one_wedge_has_its_exact_limit_state(psi) -> None:
    """The paper's Table 4 by the limit state of one block, which is another method; 1e-6 as space is settled to."""
    assembly, model = paper_wedge()
    dilation = tangent(psi)
    exact = pairs_limit(
        replace(model, tan_dilation=np.full_like(model.tan_dilation, dilation))
    ).governing
    found = limit_of_blocks(
        replace(assembly, tan_dilation=np.full_like(assembly.tan_dilation, dilation))
    )
    assert found.factor == pytest.approx(exact.factor, rel=3e-6)


def test_a_square_block_in_torsion() -> None:
    """2.2956 = μ W a 0.3826 / M, friction about the middle of a square; 4 x 4 pairs leave 0.11 %."""
    scene = boxes_in_space((1, 1, 1), (2.0, 2.0, 2.0), 0.0)
    weight = -scene.forces[0, 2]
    mean = (math.sqrt(2.0) + math.log(1.0 + math.sqrt(2.0))) / 6.0
    twisted = replace(
        scene, moments=np.array([[0.0, 0.0, tangent(35.0) * weight * 2.0 * mean / 2.2956]])
    )
    found = [
        limit_of_blocks(twisted.model(35.0, refine=refine), ranged=False).factor
        for refine in (1, 2, 3)
    ]
    off = np.abs(np.array(found) / 2.2956 - 1.0)
    assert off[2] < 2e-3
    assert off[2] < off[1] < off[0]


# -- work that is not done twice --------------------------------------------------------------------------------------


def test_a_flow_that_did_not_settle_is_not_tried_again(monkeypatch) -> None:
    """The bracket gets narrower from the side at rest: what runs is the same flow as before."""
    model = boxes_in_space((2, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3).model(35.0)
    flows: list[Flow] = []
    monkeypatch.setattr(path, "_COARSE_BRACKETS", (3e-3, 3e-4))
    monkeypatch.setattr(path, "_remove_viscosity", lambda _, flow, __: flows.append(flow))
    found = trace_limit(
        ElasticContactModel(model, Drive(model.load.ravel())), 2.0 / static_bound(model).factor
    )
    assert found.outcome is PathOutcome.BRACKET
    assert len(flows) == len({id(flow) for flow in flows}) == 2
    assert 1.0 - found.peak[1] / found.peak[0] < 3e-4


def modes_tried(
    monkeypatch, model: AssemblyModel, refuses: bool = False
) -> tuple[list[ContactState], BlocksLimit]:
    """The modes with which a limit state is looked for on the path of a model, and its limit."""
    tried: list[ContactState] = []
    whole = path.limit_state

    def watched(bed, at, moved, parameter):
        tried.append(bed.forces(at, parameter))
        return None if refuses else whole(bed, at, moved, parameter)

    with monkeypatch.context() as patched:
        patched.setattr(path, "limit_state", watched)
        return tried, limit_of_blocks(model, ranged=False)


def test_a_limit_state_is_not_looked_for_with_the_same_modes_in_space(monkeypatch) -> None:
    """But once more where the path has settled."""
    model = boxes_in_space((3, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3).model(35.0)
    often, found = modes_tried(monkeypatch, model, refuses=True)
    monkeypatch.setattr(path, "_BORDERED_AGAIN", model.load.size - 1)
    seldom, again = modes_tried(monkeypatch, model, refuses=True)
    assert any(a.same_modes(b) for a, b in pairwise(often[:-1]))
    assert not any(a.same_modes(b) for a, b in pairwise(seldom[:-1]))
    assert len(often) > len(seldom) > 1
    assert (again.factor, again.basis) == (found.factor, Basis.SETTLED)


def test_a_limit_state_of_many_modes_is_looked_for_where_the_path_has_settled(monkeypatch) -> None:
    model = boxes_in_space((4, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3).model(35.0)
    often, found = modes_tried(monkeypatch, model)
    monkeypatch.setattr(path, "_BORDERED_EARLY", model.load.size - 1)
    once, again = modes_tried(monkeypatch, model)
    assert (len(often), len(once)) == (2, 1)
    assert again.factor == pytest.approx(found.factor, rel=1e-9)
    assert again.basis is found.basis is Basis.LIMIT


@pytest.mark.parametrize("number", [15, 36])
def test_the_range_is_that_of_the_part_that_fails_first_alone(number, monkeypatch) -> None:
    """Not of other components, nor with node pairs that are too coarse for its twist."""
    ranges, whole = [], blocks.mechanism_range

    def watched(model, velocity, factor, bond, forces, top):
        low, high = whole(model, velocity, factor, bond, forces)
        ranges.append((low / factor, high / factor))
        return low, high

    monkeypatch.setattr(blocks, "mechanism_range", watched)
    result = sk.run(sk.load(populations.bench(number)))
    assert len(ranges) == 1
    (low, high), fos = ranges[0], result.fos
    assert fos.highest / fos.limit == pytest.approx(high, rel=1e-9)
    assert fos.lowest / fos.limit == pytest.approx(low, rel=1e-9)


# -- dilation ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("psi", [0.0, 5.0, 15.0])
@pytest.mark.parametrize("space", [False, True])
def test_a_block_that_dilates_slides_where_one_that_does_not_slides(psi, space) -> None:
    """tan 35° / tan 20°: one plane, forces by hand. It rises by tan ψ of its slip."""
    scene = boxes_in_space((1, 1, 1), (6.0, 6.0, 0.5), 20.0) if space else stack(1, 20.0, 6.0)
    model = scene.model(35.0, 0.0, psi)
    found = limit_of_blocks(model)
    assert found.factor == pytest.approx(tangent(35) / tangent(20), rel=3e-6 if space else 1e-9)
    opening, slip = model.opening_and_slip(found.velocity)
    size = np.sqrt((slip * slip).sum(axis=1))
    assert opening == pytest.approx(tangent(psi) * size[model.group_of_pair], abs=1e-4 * size.max())


@pytest.mark.parametrize(
    ("dip", "c", "factor"), [(0.0, 0.0, 3.291798), (10.0, 0.0, 1.941039), (0.0, 10.0, 4.070999)]
)
def test_dilation_does_not_matter_where_forces_are_statically_determined(dip, c, factor) -> None:
    """7c_two_block 1, 2 and 6: both bases slip, the smooth interface presses; seven digits."""
    model = active_passive(dip).model([30.0, 30.0, 0.0], [c, c, 0.0], [4.0, 2.0, 0.0])
    assert limit_of_blocks(model).factor == pytest.approx(factor, rel=5e-7)


DILATING = {
    "section": model_of(populations.section(12)),
    "bench": model_of(populations.bench(36)),
}  # F of 4.9, 9.4


@pytest.mark.parametrize("name", DILATING)
def test_with_normality_a_mechanism_has_one_factor(name) -> None:
    """ψ = 20° is more than the reduced friction angle: no normal force works on what slip opens by just that.

    So the work of the loads gives the factor, whatever forces are locked in. What a joint opens by more than its
    reduced friction angle is open, if by less than tan ψ: counted as closed, ranges began at 4.868 and at 2.562.
    """
    model = DILATING[name]
    found = limit_of_blocks(
        replace(model, tan_dilation=np.full_like(model.tan_dilation, tangent(20)))
    )
    assert found.basis is Basis.LIMIT
    assert found.factor > float(model.tan_friction.max()) / tangent(20)
    assert found.lowest == pytest.approx(found.factor, rel=1e-7)
    assert found.highest == pytest.approx(found.factor, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    "model", [DILATING["section"], model_of(populations.bench(94))], ids=["section", "turns"]
)
def test_dilation_beyond_the_friction_angle_says_no_more(model) -> None:
    """Friction is reduced all along the path: tan ψ = tan φ and five times that are one law, and one state."""
    one, other = (
        limit_of_blocks(replace(model, tan_dilation=k * model.tan_friction)) for k in (1.0, 5.0)
    )
    assert (one.highest is None) == (other.highest is None)
    ours, same = (
        [x for x in (found.factor, found.lowest, found.highest) if x is not None]
        for found in (one, other)
    )
    assert same == pytest.approx(ours, rel=1e-9)
    none = np.zeros(0, dtype=np.int64)
    states = [
        states_of_part(
            SolvedComponent(replace(model, tan_dilation=k * model.tan_friction), limit, none, none)
        )
        for k, limit in ((1.0, one), (5.0, other), (1.0 / one.factor, one))
    ]
    for state in states[1:]:
        for ours, same in zip(states[0], state, strict=True):
            np.testing.assert_allclose(ours, same, rtol=0.0, atol=1e-9)
    opened, slips, _ = states[0]
    assert opened.any()
    assert slips.any()


# -- the path in the load ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "path"), [("W3", 0.35582), ("W4", 0.26374)])
def test_published_walls_by_their_load(name, path) -> None:
    """Ferris & Tin-Loi (2001) without association, 0.5 %; the prototype of the path to its digits."""
    wall = populations.WALLS[name]
    model = model_of(wall.design(1.0))
    weight, push = (model.load - model.live).ravel(), model.live.ravel()
    assert np.abs(weight.reshape(model.load.shape)[:, 0]).max() == 0.0
    found = trace_limit(ElasticContactModel(model, Drive(weight, push, 1.0)), 1e-3)
    assert found.is_limit
    assert found.parameter == pytest.approx(wall.multiplier, rel=5e-3)
    assert found.parameter == pytest.approx(path, rel=1e-4)


@pytest.mark.parametrize("strength", [0.5, 1.0])
@pytest.mark.parametrize(("width", "tips"), [(1.0, True), (4.0, False)])
def test_a_block_pushed_along_level_ground(width, tips, strength) -> None:
    """It slides at λ tan φ times its weight or tips at b / h, whichever is less; 2 m high, φ = 40°."""
    scene = stack(1, 0.0, width, 2.0)
    model = scene.model(40.0)
    push = np.zeros_like(model.load)
    push[0, 0] = -model.load[0, 1]  # its weight, sideways
    exact = min(strength * tangent(40), width / 2.0)
    assert (exact == width / 2.0) is (tips and strength == 1.0)
    limit = load_limit(model, push, strength)
    assert limit.basis is Basis.LIMIT
    assert limit.multiplier == pytest.approx(exact, rel=1e-9)
    assert limit.factor == 1.0 / strength


# -- Newton's derivatives ---------------------------------------------------------------------------------------------

SCENES = {  # and the cohesion of their joints
    "section": (lambda: stack(3, 25.0, 4.0), 2.0),
    "columns": (lambda: rectangles([(0, 1, 0, 2), (1, 3, 0, 3), (3, 4, 0, 1)], 30.0), 1.0),
    "space": (lambda: boxes_in_space((2, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3), 1.0),
    "bench": (lambda: bench(BENCH, scatter=3.0, seed=4), 0.0),
    "bolted section": (lambda: bolted(stack(3, 25.0, 4.0)), 2.0),
    "bolted space": (lambda: bolted(boxes_in_space((2, 1, 2), (2.0, 3.0, 1.0), 25.0, 0.3)), 1.0),
}


def _model_of_scene(name: str, psi: float) -> AssemblyModel:
    scene, cohesion = SCENES[name]
    return scene().model(30.0, cohesion, psi)


BEDS = {name: partial(_model_of_scene, name) for name in SCENES}


def bolted(scene: Scene) -> Scene:
    """With a bolt on each block, every other one to the block before it, off their centroids."""
    rng, blocks = np.random.default_rng(9), np.flatnonzero(~scene.fixed)
    forces = rng.normal(size=(len(blocks), 3)) * np.abs(scene.forces).max()
    if scene.in_section:
        forces[:, 1] = 0.0
    toes = np.where(np.arange(len(blocks)) % 2, np.roll(blocks, 1), BEDROCK)
    return replace(
        scene, bolts=PassiveBolts(blocks, toes, 0.2 * forces, scene.centroids[blocks] + 0.3)
    )


def away_from_kinks(
    bed: ElasticContactModel, reduction: float, size: float
) -> tuple[np.ndarray, ContactState]:
    """A displacement near which no pair opens and no joint starts to slip, some touch, and some slip of those."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        at = (
            bed.elastic_displacement
            + 0.7 * rng.normal(size=bed.size) * np.abs(bed.elastic_displacement).mean()
        )
        there = bed.forces(at, reduction)
        near = [bed.forces(at + size * rng.normal(size=bed.size), reduction) for _ in range(20)]
        pressed = bed._summed(there.touching * 1.0) > 0.0
        some = (there.slips & pressed).any() and not there.slips.all() and not there.touching.all()
        if some and all(there.same_modes(other) for other in near):
            return at, there
    raise AssertionError("no such displacement")


@pytest.mark.parametrize("psi", [0.0, 8.0, 29.0])
@pytest.mark.parametrize("name", BEDS)
def test_the_tangent_is_the_derivative_of_the_forces(name, psi, kernels) -> None:
    """Central differences, whose error is the square of a step of 1e-5 of the displacements."""
    model = BEDS[name](psi)
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    reduction, step = 0.6, 1e-5 * np.abs(bed.elastic_displacement).mean()
    at, there = away_from_kinks(bed, reduction, 10.0 * step)
    matrix = bed.stiffness.dense(bed.tangent(there, reduction))
    rng = np.random.default_rng(5)
    for _ in range(6):
        way = rng.normal(size=bed.size)
        ahead, behind = (
            bed.forces(at + sign * step * way, reduction).unbalanced for sign in (1.0, -1.0)
        )
        slope = (ahead - behind) / (2.0 * step)
        assert -matrix @ way == pytest.approx(slope, abs=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize("psi", [0.0, 8.0])
@pytest.mark.parametrize("name", BEDS)
def test_the_slope_in_the_strength_is_a_derivative(name, psi, kernels) -> None:
    slopes_agree(BEDS[name](psi))


@pytest.mark.parametrize("name", BEDS)
def test_the_slope_in_the_strength_counts_dilation_held_to_the_reduced_friction(name) -> None:
    """ψ = 29°, λ tan φ = tan 19°: dilation is λ tan φ and goes with λ."""
    slopes_agree(BEDS[name](29.0))


def slopes_agree(model: AssemblyModel) -> None:
    """Central differences in λ."""
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    reduction, step = 0.6, 1e-6
    at, there = away_from_kinks(bed, reduction, 1e-4 * np.abs(bed.elastic_displacement).mean())
    ahead, behind = (bed.forces(at, reduction + sign * step) for sign in (1.0, -1.0))
    assert ahead.same_modes(behind)
    slope = (ahead.unbalanced - behind.unbalanced) / (2.0 * step)
    assert bed.parameter_derivative(there, reduction) == pytest.approx(
        slope, abs=1e-6 * np.abs(slope).max()
    )


def test_the_slope_in_the_load_is_the_load() -> None:
    model = BEDS["space"](0.0)
    ramp = np.random.default_rng(6).normal(size=model.load.size)
    bed = ElasticContactModel(model, Drive(model.load.ravel(), ramp, 0.6))
    ahead, behind = (bed.forces(bed.elastic_displacement, k).unbalanced for k in (1.0, 0.0))
    assert bed.parameter_derivative(
        bed.forces(bed.elastic_displacement, 0.5), 0.5
    ) == pytest.approx(ahead - behind)


def test_some_blocks_of_a_bed_are_driven_by_their_part_of_the_ramp() -> None:
    """A bench that was pushed by an earthquake ended in an error of shapes here."""
    model, rng = BEDS["space"](0.0), np.random.default_rng(7)
    ramp = rng.normal(size=model.load.size)
    whole = ElasticContactModel(model, Drive(model.load.ravel(), ramp, 0.6))
    at = whole.elastic_displacement * (1.0 + 0.5 * rng.random(whole.size))
    blocks = np.arange(0, len(model.load), 2)
    those = (blocks[:, None] * model.unknowns + np.arange(model.unknowns)).ravel()
    exact = whole.forces(at, 0.7).unbalanced[those]
    few = whole.restricted_to(blocks, at).forces(at[those], 0.7).unbalanced
    assert few == pytest.approx(exact, abs=1e-13 * float(np.abs(exact).max()))


@pytest.mark.parametrize("psi", [0.0, 8.0, 29.0])
@pytest.mark.parametrize("name", BEDS)
def test_the_law_holds_at_any_displacement(name, psi, kernels) -> None:
    """N >= 0 and |T| <= λ r; T against the slip, at λ r where it slips and k_t A s below; pairs press as they close.
    Bolts do not push.

    N = a <-opening + tan ψ p>, p the slip beyond the elastic one; c on the part of a contact whose gap, less tan ψ
    times all the slip at its centroid, is negative, by clipping its polygon: equation by equation.
    """
    model = BEDS[name](psi)
    bed = ElasticContactModel(model, Drive(model.load.ravel()))
    at, there = away_from_kinks(bed, 0.6, 1e-6 * np.abs(bed.elastic_displacement).mean())
    opening, slip = model.opening_and_slip(at)
    size, carried = (np.sqrt((of * of).sum(axis=1)) for of in (slip, there.friction))
    spring = 0.4 * model.by_group(model.control_area)
    beyond = size - carried / spring
    dilation = np.minimum(model.tan_dilation, 0.6 * model.tan_friction)
    rises = dilation * beyond
    pressed = model.control_area * np.maximum(rises[model.group_of_pair] - opening, 0.0)
    assert there.normal == pytest.approx(pressed, abs=1e-9 * pressed.max())
    areas, contacts = model.by_group(model.control_area), len(model.plus)
    middle = np.stack(
        [np.bincount(model.group_contact, areas * along, contacts) for along in slip.T]
    )
    middle = np.sqrt((middle**2).sum(axis=0)) / np.bincount(model.group_contact, areas, contacts)
    gaps = opening - dilation[model.group_of_pair] * middle[model.pair_contact]
    strength = model.by_group(model.cohesion) * pressed_shares_of_pairs(
        SCENES[name][0]().patches, model, gaps
    )
    strength += model.tan_friction * model.by_group(there.normal)
    strength[model.bolted & (slip[:, 0] > 0.0)] = 0.0  # a bolt that gets shorter
    assert there.strength == pytest.approx(strength)
    assert carried == pytest.approx(
        np.minimum(spring * size, 0.6 * strength), abs=1e-9 * strength.max()
    )
    assert (there.friction * slip).sum(axis=1) == pytest.approx(-carried * size)
