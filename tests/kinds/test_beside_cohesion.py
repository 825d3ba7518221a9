"""What stands beside the limit of cohesive blocks: the one without any cohesion, and another history."""

import math
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from benchmarks import populations
from slopekit.design.templates import path_of
from slopekit.evidence import History
from slopekit.kinds.assemblies import many_blocks, many_blocks_ladder
from slopekit.kinds.blocks import OWN
from slopekit.preie.solvers import work_limit
from slopekit.studies.check.run import _history

DIP, PHI, COHESION, WEIGHT, LENGTH = math.radians(30.0), math.radians(25.0), 3.0, 50.0, 2.0


def block(**beside):
    """A block of 2 m by 1 m on a bonded plane of 30 degrees, a section 1 m thick."""

    def turned(*points):
        return [[x * math.cos(DIP) - z * math.sin(DIP), x * math.sin(DIP) + z * math.cos(DIP)] for x, z in points]

    return {
        "slopekit": 1, "kind": "blocks",
        "blocks": {
            "base": {"polygon": turned((-2, -2), (6, -2), (6, 0), (-2, 0)), "fixed": True},
            "B1": {"polygon": turned((0, 0), (2, 0), (2, 1), (0, 1))},
        },
        "interfaces": {"default": "joint"}, "strength": {"joint": {"c": COHESION, "phi": 25}},
        "rock": {"unit_weight": 25.0},
    } | beside  # fmt: skip


def said(found: sk.Result) -> str:
    return " ".join(str(found).split())


def test_a_bonded_block_by_hand() -> None:
    """(c A + W cos β tan φ) / (W sin β), tan φ / tan β without cohesion; the history ends there whatever slips."""
    found = sk.run(sk.load(block()))
    whole = (COHESION * LENGTH + WEIGHT * math.cos(DIP) * math.tan(PHI)) / (WEIGHT * math.sin(DIP))
    assert found.fos.limit == pytest.approx(whole, rel=1e-9)
    assert found.without_cohesion.limit == pytest.approx(math.tan(PHI) / math.tan(DIP), rel=1e-9)
    assert found.history.rests < whole < found.history.runs < 1.0035 * found.history.rests
    written = found.to_dict()
    assert written["without_cohesion"] == {"status": "slides", "limit": found.without_cohesion.limit}
    assert written["history"] == {"rests": found.history.rests, "runs": found.history.runs}
    assert "0.8077 without any cohesion (the same blocks, c = 0)" in said(found)
    assert "all blocks rest at the first, run at the second" in said(found)
    assert "W504" not in [notice.code for notice in found.warnings]


def test_a_rule_may_ask_that_the_slope_stands_without_any_cohesion() -> None:
    rules = ["fos >= 1.0", "fos.without_cohesion >= 1.0"]
    found = sk.run(sk.load(block(acceptance={"rules": rules})))
    assert [found.judged(rule) for rule in found.design.rules] == [True, False]
    assert found.exit_code == 1
    assert found.leading == ("without_cohesion", found.without_cohesion.limit)
    assert "0.8077 without any cohesion: the factor that ACCEPT hangs on" in said(found)


def test_blocks_without_cohesion_have_nothing_beside() -> None:
    found = sk.run(sk.load(block(strength={"joint": {"c": 0.0, "phi": 25}})))
    assert (found.without_cohesion, found.history) == (None, None)
    assert not {"without_cohesion", "history"} & found.to_dict().keys()
    assert "without any cohesion" not in said(found)


def test_a_rule_on_what_was_not_computed_is_not_met() -> None:
    found = sk.run(sk.load(path_of("wedge"), set={"acceptance": {"rules": ["fos.without_cohesion >= 0.1"]}}))
    assert found.accepted is False
    assert "no such number here: it is one of many blocks with cohesion; where they have none it is fos" in said(found)


def test_no_more_work_goes_into_it_than_into_the_limit(monkeypatch) -> None:
    monkeypatch.setattr(many_blocks, "_LEAST_WORK", 1.0)
    monkeypatch.setattr(work_limit, "spent", lambda: 0.0)  # the limit took none
    found = sk.run(sk.load(block(acceptance={"rules": ["fos.without_cohesion >= 0.1"]})))
    assert found.without_cohesion.status == "not_converged"
    assert found.without_cohesion.limit is None
    assert "without any cohesion (the same blocks, c = 0): not found with the work that is allowed" in said(found)
    assert found.accepted is False


def test_work_is_counted_within_what_is_allowed() -> None:
    assert work_limit.spent() == 0.0
    with work_limit.allowed(math.inf):
        work_limit.spend(3.0, 2.0)
        with work_limit.allowed(1e3):
            work_limit.spend(4.0)
        assert work_limit.spent() == 10.0


def test_a_history_that_ends_lower_lowers_the_lowest_factor() -> None:
    """A block jammed between three faces at 14: it rests and runs anywhere from 11.9 to 19, by stiffness and mesh."""
    design = populations.bench(414) | {"acceptance": {"rules": ["fos >= 12.5", "fos.lowest >= 12.5"]}}
    design["strength"]["joint"]["c"] = 5.0
    found = sk.run(sk.load(design))
    assert found.history.runs < 0.99 * found.fos.limit
    assert found.fos.lowest == found.history.rests
    assert [found.judged(rule) for rule in found.design.rules] == [True, False]
    (notice,) = [notice for notice in found.warnings if notice.code == "W504"]
    above = (found.fos.limit / found.history.runs - 1.0) * 100.0
    assert f"run at {found.history.runs:.4f}" in notice.message
    assert f"lies {above:.2g} % above that" in notice.message
    assert "the low end no higher than of motions where slip stays (W504)" in said(found)


@pytest.mark.parametrize(("runs", "excess", "short"), [
    (2.0, 0.0, False), (1.0, 0.0, False), (0.995, 1.0 / 0.995 - 1.0, False), (0.9, 1.0 / 0.9 - 1.0, True),
    (None, None, False),
])  # fmt: skip
def test_how_far_a_factor_lies_above_a_history(runs, excess, short) -> None:
    history = History(0.8, runs)
    assert history.falls_short(1.0) is short
    assert history.excess(1.0) == (None if excess is None else pytest.approx(excess, rel=1e-12))


@pytest.mark.parametrize(("history", "met"), [
    (History(1.0, 1.2), True), (History(0.8, 0.9), False), (History(0.8, None), None),
])  # fmt: skip
def test_check_holds_the_limit_against_the_history(history, met) -> None:
    found = replace(sk.run(sk.load(block())), history=history)
    (finding,) = _history(found, 1.0)
    assert (finding.name, finding.met, finding.code) == ("history", met, "W504")
    assert list(_history(replace(found, history=None), 1.0)) == []


def test_check_follows_the_history_of_more_blocks(monkeypatch) -> None:
    for module in (many_blocks, many_blocks_ladder):
        monkeypatch.setattr(module, "MOST_FOLLOWED", 0)
    assert sk.run(sk.load(block())).history is None
    checked = sk.check(sk.load(block()))
    assert checked.result.history.rests < checked.result.fos.limit < checked.result.history.runs
    assert [finding.met for finding in checked.findings if finding.name == "history"] == [True]


def test_a_history_that_only_check_follows_lowers_the_lowest_factor_as_well(monkeypatch) -> None:
    monkeypatch.setattr(many_blocks_ladder, "MOST_FOLLOWED", 0)
    monkeypatch.setattr(many_blocks_ladder, "history_of", lambda part, most: History(0.8, 0.81))
    found = sk.check(sk.load(block())).result
    assert found.fos.limit > 0.82
    assert found.fos.lowest == found.history.rests == 0.8
    assert "run at 0.8100" in next(notice.message for notice in found.warnings if notice.code == "W504")


def test_no_history_is_followed_where_it_would_be_of_other_blocks(monkeypatch) -> None:
    """Loads that come on last, dilation, and work that is not allowed."""
    design = sk.load(block())
    solution = many_blocks.solved(OWN, design)
    part = solution.ravelling.failures[0].parts[0]
    assert many_blocks.history_of(part, 1) is not None
    assert many_blocks.history_of(part, 0) is None
    last = replace(part, limit=replace(part.limit, loads_last=True))
    dilates = replace(part, model=replace(part.model, tan_dilation=np.full_like(part.model.tan_dilation, 0.1)))
    assert many_blocks.history_of(last, 1) is None
    assert many_blocks.history_of(dilates, 1) is None
    monkeypatch.setattr(many_blocks, "_HISTORY", 1e-9)
    assert many_blocks.history_of(part, 1) is None


def test_a_value_that_is_solved_for_says_the_other_history(monkeypatch) -> None:
    """W504 of the factor at the value found, as `run` says it there; of a load by its value, to earthquakes too."""
    design = sk.load(block(), set={"loads.seismic": {"k": 0.0, "toward": 270}})
    monkeypatch.setattr(many_blocks, "history_of", lambda part, most: History(0.8, 0.81))
    found = sk.solve(design, "strength.joint.c", fos=3.0)
    (notice,) = [notice for notice in found.warnings if notice.code == "W504"]
    at = sk.run(block(), set={"strength.joint.c": found.answer.value})
    assert notice in at.warnings
    shaken = sk.quake(design, "sine:0.5g,1Hz")
    (notice,) = [notice for notice in shaken.warnings if notice.code == "W504"]
    assert notice.message.startswith("of the factor of safety at loads.seismic.k = ")
    bare = sk.solve(sk.load(block(), set={"strength.joint.c": 0}), "strength.joint.phi", fos=3.0)
    assert "W504" not in [notice.code for notice in bare.warnings]
