"""The lowest factor of cohesive blocks: no more than with progressive slip and debonding."""

import math
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from benchmarks import populations
from slopekit.kinds.assemblies import many_blocks, many_blocks_ladder
from slopekit.kinds.blocks import KIND

DIP, PHI, COHESION, WEIGHT, LENGTH = math.radians(30.0), math.radians(25.0), 3.0, 50.0, 2.0


def block(**beside):
    """A block of 2 m by 1 m on a bonded plane of 30 degrees, a section 1 m thick."""

    def turned(*points):
        return [
            [x * math.cos(DIP) - z * math.sin(DIP), x * math.sin(DIP) + z * math.cos(DIP)]
            for x, z in points
        ]

    return {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": {
            "base": {"polygon": turned((-2, -2), (6, -2), (6, 0), (-2, 0)), "fixed": True},
            "B1": {"polygon": turned((0, 0), (2, 0), (2, 1), (0, 1))},
        },
        "interfaces": {"default": "joint"},
        "strength": {"joint": {"c": COHESION, "phi": 25}},
        "rock": {"unit_weight": 25.0},
    } | beside


def said(found: sk.Result) -> str:
    return " ".join(str(found).split())


def test_a_bonded_block_by_hand() -> None:
    """(c A + W cos β tan φ) / (W sin β); the history ends there whatever slips, so there is no lower number."""
    found = sk.run(sk.load(block()))
    whole = (COHESION * LENGTH + WEIGHT * math.cos(DIP) * math.tan(PHI)) / (WEIGHT * math.sin(DIP))
    assert found.fos.limit == pytest.approx(whole, rel=1e-9)
    assert "W504" not in [notice.code for notice in found.warnings]
    assert (
        not {"without_cohesion", "history", "without_turning", "lowest_limit"}
        & found.to_dict().keys()
    )
    part = KIND.solved(sk.load(block())).ravelling.failures[0].parts[0]
    stable, fails = many_blocks._debonding_factors(part, 1)
    assert stable < whole < fails < 1.0035 * stable


def test_a_rule_on_a_number_that_went_is_refused() -> None:
    with pytest.raises(sk.DesignError, match=r"fos\.without_cohesion"):
        sk.load(block(acceptance={"rules": ["fos.without_cohesion >= 1.0"]}))


def test_a_history_that_ends_lower_lowers_the_lowest_factor() -> None:
    """Bench 113: its limit is 4.08, and with slip and lost bonds that stay it fails 8 % lower."""
    design = populations.bench(113) | {"acceptance": {"rules": ["fos >= 4.0", "fos.lowest >= 4.0"]}}
    found = sk.run(sk.load(design))
    assert found.fos.lowest < 0.98 * found.fos.limit
    assert [found.meets(rule) for rule in found.design.rules] == [True, False]
    (notice,) = [notice for notice in found.warnings if notice.code == "W504"]
    assert f"are stable at {found.fos.lowest:.4f} and fail at" in notice.message


@pytest.mark.parametrize(
    ("fails", "is_lower"), [(2.0, False), (1.0, False), (0.985, False), (0.97, True), (None, False)]
)
def test_a_history_counts_where_it_is_more_than_2_percent_lower(
    monkeypatch, fails, is_lower
) -> None:
    solution = KIND.solved(sk.load(block()))
    limit, lowest = solution.result.fos.limit, solution.result.fos.lowest
    monkeypatch.setattr(
        many_blocks, "_debonding_factors", lambda part, most: (0.8, fails and fails * limit)
    )
    found = solution.with_history(1).result
    assert found.fos.lowest == (0.8 if is_lower else lowest)
    assert ("W504" in [notice.code for notice in found.warnings]) == is_lower


def test_check_follows_the_history_of_more_blocks(monkeypatch) -> None:
    """It lowers the lowest factor as well, and is a finding that is not met."""
    monkeypatch.setattr(
        many_blocks, "_debonding_factors", lambda part, most: (0.8, 0.81) if most == 1 else None
    )
    for module in (many_blocks, many_blocks_ladder):
        monkeypatch.setattr(module, "MOST_HISTORY_BLOCKS", 0)
    assert sk.run(sk.load(block())).fos.lowest != 0.8
    checked = sk.check(sk.load(block()))
    assert checked.result.fos.lowest == 0.8
    (finding,) = [finding for finding in checked.findings if finding.name == "debonding"]
    assert (finding.met, finding.code) == (False, "W504")
    assert "fail at 0.8100" in finding.words


def test_no_history_is_followed_where_it_would_be_of_other_blocks(monkeypatch) -> None:
    """Dilation, and work that is not allowed."""
    design = sk.load(block())
    solution = KIND.solved(design)
    part = solution.ravelling.failures[0].parts[0]
    assert many_blocks._debonding_factors(part, 1) is not None
    assert many_blocks._debonding_factors(part, 0) is None
    dilates = replace(
        part, model=replace(part.model, tan_dilation=np.full_like(part.model.tan_dilation, 0.1))
    )
    assert many_blocks._debonding_factors(dilates, 1) is None
    monkeypatch.setattr(many_blocks, "_HISTORY_SECONDS", 1e-9)
    assert many_blocks._debonding_factors(part, 1) is None


def test_a_value_that_is_solved_for_says_the_other_history(monkeypatch) -> None:
    """W504 of the factor at the value found, as `run` says it there; of a load by its value, to earthquakes too."""
    design = sk.load(block(), set={"loads.seismic": {"k": 0.0, "toward": 270}})
    monkeypatch.setattr(
        many_blocks,
        "_debonding_factors",
        lambda part, most: (0.8, 0.81) if part.model.has_cohesion else None,
    )
    found = sk.solve(design, "strength.joint.c", fos=3.0)
    (notice,) = [notice for notice in found.warnings if notice.code == "W504"]
    at = sk.run(block(), set={"strength.joint.c": found.answer.value})
    assert notice in at.warnings
    shaken = sk.quake(design, "sine:0.5g,1Hz")
    (notice,) = [notice for notice in shaken.warnings if notice.code == "W504"]
    assert notice.message.startswith("of the factor of safety at loads.seismic.k = ")
    bare = sk.solve(sk.load(block(), set={"strength.joint.c": 0}), "strength.joint.phi", fos=3.0)
    assert "W504" not in [notice.code for notice in bare.warnings]
