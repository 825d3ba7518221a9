"""Work is counted and bounded: a status with what is known in place of a wait without end."""

import math
from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from benchmarks import fuzz, populations
from benchmarks.benches import bench
from benchmarks.fuzz_mutations import case
from benchmarks.fuzz_seeds import write_files
from slopekit.design.templates import path_of
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.outcome import Outcome
from slopekit.preie.programs import bound
from slopekit.preie.solvers.work_limit import (
    WorkSpentError,
    budget_fraction,
    factorisation,
    spend,
    work_budget,
)
from tests.preie.path_oracle import model_of

FACTOR, BOUND = populations.goodman_bray_factor(16), 1.19089


def test_a_factorisation_counts_by_its_size() -> None:
    assert factorisation(10_000) - factorisation(0) == pytest.approx(1e6)


def test_what_is_spent_within_counts_outside_and_a_part_is_of_what_is_left() -> None:
    with (
        work_budget(10.0),
        work_budget(100.0),
        pytest.raises(WorkSpentError),
    ):  # no more than is left outside
        spend(11.0)
    with work_budget(10.0):
        spend(6.0)
        with budget_fraction(0.5):
            spend(1.5)
            with pytest.raises(WorkSpentError):
                spend(1.0)
        spend(1.0)  # 9.5 of 10
        with pytest.raises(WorkSpentError):
            spend(1.0)
    spend(math.inf)  # nothing is counted


@pytest.mark.parametrize("units", [2e5, 2e6, 6e6])
def test_without_enough_work_there_is_no_number_but_what_is_known(units: float) -> None:
    model = model_of(populations.goodman_bray(16))
    found = []
    for _ in range(2):
        with work_budget(units):
            found.append(limit_of_blocks(model))
    one, again = found
    assert one.outcome is Outcome.NOT_CONVERGED
    assert one.spent
    assert (one.factor, one.lowest, one.highest) == (None, None, None)
    assert one.static_bound is None or one.static_bound == pytest.approx(BOUND, rel=1e-4)
    assert (one.rested, one.static_bound) == (
        again.rested,
        again.static_bound,
    )  # counted, not timed
    if one.rested is not None:
        assert FACTOR is not None
        assert 0.4 < one.rested < BOUND


def test_where_blocks_rested_is_in_the_strength_that_they_have() -> None:
    """With twice the friction they were last at rest at twice the factor, after the same work."""
    model = model_of(populations.goodman_bray(16))
    with work_budget(6e6):
        one = limit_of_blocks(model)
    with work_budget(6e6):
        other = limit_of_blocks(replace(model, tan_friction=2.0 * model.tan_friction))
    assert one.rested is not None
    assert other.rested == pytest.approx(2.0 * one.rested, rel=1e-9)
    assert WorkSpentError(0.8).times(0.5).rested == 0.4
    assert WorkSpentError().times(0.5).rested is None


def test_with_enough_work_nothing_changes() -> None:
    model = model_of(populations.goodman_bray(16))
    with work_budget(1e9):
        found = limit_of_blocks(model)
    assert found.factor == pytest.approx(FACTOR, rel=1e-9)
    assert not found.spent
    assert found.rested is None


@pytest.mark.parametrize(
    ("units", "static_bound", "known"),
    [
        (
            4e6,
            0.965924,
            [
                "were last at rest with their strength divided by 0.5682",
                "beyond 0.9659, the upper bound",
            ],
        ),
        (
            1e6,
            None,
            ["no rest of all blocks that would say anything was seen", "no upper bound was found"],
        ),
    ],
)
def test_the_sheet_says_what_is_known(
    units: float, static_bound: float | None, known: list[str]
) -> None:
    with work_budget(units):
        result = sk.run(bench(1.9))
    said = {notice.code: notice.message for notice in result.warnings}
    assert result.status == "not_converged"
    assert result.fos.limit is None
    assert result.fos.static_bound == (
        None if static_bound is None else pytest.approx(static_bound, rel=1e-5)
    )
    assert all(one in said["W360"] for one in known)


def test_nothing_is_said_of_a_rest_of_cohesive_blocks() -> None:
    """All blocks rest at 1.23 of this bench, and one alone fails by forces at 0.88."""
    with work_budget(8e6):
        result = sk.run(bench(1.9, 5.0))
    said = {notice.code: notice.message for notice in result.warnings}
    assert result.status == "not_converged"
    assert "divided by" not in said["W360"]
    assert result.fos.static_bound == pytest.approx(1.24858, rel=1e-4)
    assert "beyond 1.249, the upper bound" in said["W360"]


@pytest.mark.parametrize("number", [1187])
def test_benches_of_the_fuzz_that_took_a_minute_end_with_their_work(tmp_path, number) -> None:
    """File 1187 of seed 777: 39 blocks under a seismic coefficient of 1."""
    write_files(tmp_path)
    outcome = fuzz.run(case(number, 777), tmp_path, work=1e7)
    assert outcome.escaped == ""
    assert outcome.status == "bench not_converged"
    assert "W360" in outcome.notices
    assert outcome.seconds < 0.5 * fuzz.LIMIT_S


def test_the_bound_of_one_block_has_its_work_too(monkeypatch) -> None:
    """959 pairs of a curved surface: their programs count by the pairs, not by the six unknowns; the limit stays."""
    bounded = sk.run(path_of("surface"))
    monkeypatch.setattr(bound, "_WORK", 1e6)
    result = sk.run(path_of("surface"))
    assert bounded.fos.static_bound is not None
    assert result.fos.static_bound is None
    assert "upper bound: not found" in str(result.sheet)
    assert result.fos.limit == bounded.fos.limit


def test_without_work_for_one_factorisation_nothing_is_said_of_blocks_without_strength() -> None:
    """Their joints were factorised before anyone looked at what is left of the work."""
    model = model_of(populations.goodman_bray(16))
    with work_budget(1.0):
        found = limit_of_blocks(replace(model, tan_friction=np.zeros_like(model.tan_friction)))
    assert (found.outcome, found.spent) == (Outcome.NOT_CONVERGED, True)
