"""The limit of the elastic path of one block against its exact limit state, and against an incremental history."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from benchmarks.wedge_paths import as_assembly, compared
from slopekit.core.arrays import frozen
from slopekit.core.onlooker import Clock
from slopekit.kinds import analyse, cut
from slopekit.kinds.single_block.moments import _bond_gone
from slopekit.kinds.single_block.one_block_limit import find_limit
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.one_block.limit import limit_analysis
from slopekit.preie.one_block.one_path import by_path, path_limit, range_of
from slopekit.preie.one_block.passes import Outcome
from slopekit.preie.system.assembly import one_block
from slopekit.preie.system.model import Model
from slopekit.result import Result
from tests.preie import path_oracle
from tests.support import random_wedge


def test_single_wedges_have_the_limit_of_the_path() -> None:
    """Where the limit state opens no joint with cohesion the two are one: to 1e-6, the path's own steadiness."""
    rng = np.random.default_rng(20)
    words = Counter(compared(rng)[0] for _ in range(40))
    assert words["alike"] >= 15
    assert words["DIFFER"] == 0


def without_cohesion(seed: int, numbers: set[int]) -> list:
    """Designs of random wedges whose joints have friction alone."""
    rng = np.random.default_rng(seed)
    wedges = [random_wedge(rng) for _ in range(max(numbers) + 1)]
    return [wedge_design({**wedges[number], "c": [0.0, 0.0]}) for number in sorted(numbers)]


def history(model: Model, start: float) -> path_oracle.History:
    return path_oracle.history(one_block(model), start)


#: Wedges of seed 5: the passes come to another limit state than an elastic block (30, 70; 47: to no strength at all).
@pytest.mark.parametrize(("number", "passes"), [(30, True), (47, False), (70, True)])
def test_of_several_limit_states_the_one_that_a_history_comes_to(number: int, passes: bool) -> None:
    """To 1e-5 on the coarsest node pairs: the history slips step by step, and shares no line with the path."""
    model = cut(without_cohesion(5, {number})[0]).scene_at(0).model
    first = limit_analysis(model)
    limit = by_path(model, first).governing
    told = history(model, 2.0 / limit.factor)
    assert told.end == "settled"
    assert limit.factor == pytest.approx(told.factor, rel=1e-5)
    assert (first.governing.factor is not None) == passes
    assert not passes or abs(first.governing.factor / told.factor - 1.0) > 0.01
    lowest, highest = range_of(model, limit)
    assert lowest <= limit.factor <= highest
    assert not passes or highest > first.governing.factor * (1.0 - 1e-6)


@pytest.mark.parametrize(("number", "wide"), [(70, True), (17, False)])
def test_the_sheet_has_the_range_of_a_mechanism_that_locks_in_forces(number: int, wide: bool) -> None:
    (design,) = without_cohesion(5, {number})
    result = analyse(design)
    (table,) = result.to_dict()["sheet"]["FoS"]
    rows = [row for row in table["rows"] if "locked in" in row[2]]
    lowest, highest = result.fos.lowest, result.fos.highest
    assert (highest > 1.002 * lowest) == wide
    assert [row[:2] for row in rows] == ([[lowest, highest]] if wide else [])
    said = f"{lowest:.4f} .. {highest:.4f}  same mechanism, whatever forces are locked in"
    assert (said in str(result)) == wide


def test_the_number_of_a_wedge_that_moments_govern_is_that_of_the_path() -> None:
    """To 1e-3: the number stands on finer node pairs than the path was asked on."""
    governed = 0
    for design in without_cohesion(5, {4, 15, 17, 21, 30, 39, 55, 106}):
        found = find_limit(design, cut(design).scene_at, 0, Clock())
        factor = found.analysis.governing.factor
        told = history(found.bounded.model, 2.0 / factor)
        assert told.end == "settled"
        assert factor == pytest.approx(told.factor, rel=1e-2 if found.bounded is not found.scene else 1e-3)
        governed += found.analysis.moments_govern
    assert governed >= 6


def test_a_block_that_rests_at_no_strength_topples() -> None:
    """Wedge 92 of seed 5: forces that balance exist (the passes find some), but no elastic block comes to them."""
    (design,) = without_cohesion(5, {92})
    found = find_limit(design, cut(design).scene_at, 0, Clock())
    assert found.analysis.governing.outcome is Outcome.NO_REST
    model = found.scene.model
    assert limit_analysis(model).governing.factor
    assert history(model, 2.0).end == "no rest at the start"


@pytest.mark.parametrize("number", [2, 12, 16])
def test_where_the_path_settles_the_limit_state_there_is_exact(number: int) -> None:
    """Joints that open have lost their cohesion: it is the limit of the passes, which settle to 1e-8."""
    rng = np.random.default_rng(7)
    model = cut(wedge_design([random_wedge(rng) for _ in range(number + 1)][-1])).scene_at(0).model
    gone, _ = _bond_gone(model)
    bare = replace(model, cohesion=model.cohesion * gone.bond)
    passes = limit_analysis(bare).governing
    found = path_limit(bare, passes.factor)
    assert found.change == 0.0
    assert found.factor == pytest.approx(passes.factor, rel=1e-7)


#: 52 on coarse pairs, 133 on finer ones; 70 with its cohesion, by the rule that the bond is gone
@pytest.mark.parametrize(("seed", "number", "cohesion"), [(20, 52, False), (20, 133, False), (20, 70, True)])
def test_a_number_that_the_path_does_not_vouch_for_says_so(seed: int, number: int, cohesion: bool) -> None:
    rng = np.random.default_rng(seed)
    wedge = [random_wedge(rng) for _ in range(number + 1)][-1]
    design = wedge_design(wedge if cohesion else {**wedge, "c": [0.0, 0.0]})
    result = analyse(design)
    assert result.moments_govern
    (said,) = [notice.message for notice in result.warnings if notice.code == "W304"]
    assert said.startswith("the elastic path gave no limit: the factor is that of a limit state which the search found")
    ends = f"the same mechanism has {result.fos.lowest:.4g} to {result.fos.highest:.4g}" if result.fos.highest else ""
    assert said.endswith(ends or "there may be others")
    assert bool(ends) != cohesion


@pytest.mark.parametrize("number", [30, 92])
def test_a_wedge_that_the_path_vouches_for_is_told_nothing_of_it(number: int) -> None:
    (design,) = without_cohesion(5, {number})
    assert "W304" not in [notice.code for notice in analyse(design).warnings]


def rotation(result: Result) -> list[str]:
    lines: list[str] = result.to_dict()["sheet"]["ROTATION"]
    return lines


def test_the_sheet_says_at_which_strengths_a_block_turns_over() -> None:
    """Wedge 92 at those that were tried, 16 by a motion with slip; a block shaken about its toe opens all its base."""
    called, tried = (analyse(design) for design in without_cohesion(5, {16, 92}))
    plane = {
        "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
        "joints": {"J1": {"plane": "35/180", "strength": "J"}}, "strength": {"J": {"c": 0, "phi": 60}},
        "loads": {"seismic": "1.2@180"}, "rock": {"density": 2600},
    }  # fmt: skip
    assert rotation(tried) == [
        "first: moments turn the wedge over, at every strength tried (up to 256 times what forces in balance need)"
    ]
    assert rotation(called) == ["first: moments turn the wedge over, and no strength is called on"]
    assert rotation(sk.run(plane)) == ["first: moments turn the block over, whatever the strength"]


def test_bolts_and_joints_are_the_rows_of_the_model() -> None:
    """The contacts' own axes give back every opening, slip and shortening of the rows that they were made from."""
    rng = np.random.default_rng(3)
    while "bolts" not in (wedge := random_wedge(rng)) or wedge["bolts"][0]["acts"] != "passive":
        pass
    model = cut(wedge_design(wedge)).scene_at(0).model
    whole = one_block(model)
    motion = frozen(rng.normal(size=6))
    contacts = whole.plus_motion @ motion
    at = contacts[whole.pair_contact]
    relative = model.relative(motion)
    pairs = len(relative)
    assert np.einsum("mu,mu->m", whole.normal_rows, at)[:pairs] == pytest.approx(relative[:, 0], abs=1e-12)
    slips = np.einsum("mtu,mu->mt", whole.slip_rows, at)
    assert slips[:pairs] == pytest.approx(relative[:, 1:], abs=1e-12)
    assert slips[pairs:, 0] == pytest.approx(model.bolt_rows @ motion, abs=1e-12)
    # a pair opens by the first and the turns of its contact, and slips by the others: what the stiffness is made of
    assert np.abs(whole.normal_rows[:, 1:4]).max() < 1e-12
    assert np.abs(whole.slip_rows[:, :, [0, 4, 5]]).max() < 1e-12


def test_a_block_that_only_cohesion_holds_which_its_motion_opens_has_no_factor() -> None:
    """Nearly afloat (number 105 of seed 20): all work of the motion was left out: 8e-302 and a crash."""
    wedge = {
        "dips": [[57.58, 359.13], [41.85, 99.09]], "face": [74.4, 74.49], "upper": [16.92, 74.49], "height": 22.0,
        "c": [16.5, 2.0], "phi": [24.1, 49.8], "unit_weight": 22.77, "water": [25.5, 81.8],
    }  # fmt: skip
    whole, _ = as_assembly(cut(wedge_design(wedge)).scene_at(0))
    found = limit_of_blocks(whole)
    assert (found.outcome, found.factor, found.lowest) == (Outcome.NO_REST, None, None)
    assert found.bonded > 0.01
