"""The benchmark of speed against error, its smallest scene, and the mutations: so that they cannot rot. No timings."""

import json
import math
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import pytest

import benchmarks
import slopekit as sk
from benchmarks import (
    block_speed,
    census,
    elastic_speed,
    moments,
    mutations,
    rivals,
    speed_error,
    speed_pages,
)

_ELSEWHERE = {
    "__init__",
    "__main__",
    "siconos_worker",
}  # the last runs in an environment of its own
_MODULES = sorted(path.stem for path in Path(benchmarks.__file__).parent.glob("*.py"))


@pytest.mark.parametrize("name", [name for name in _MODULES if name not in _ELSEWHERE])
def test_there_is_what_a_benchmark_asks_of_slopekit(name) -> None:
    assert import_module(f"benchmarks.{name}").__doc__


def test_the_cracked_base_is_compared_with_springs(capsys) -> None:
    """The first of the random wedges that moments govern: within 2 %, as nine of ten are (docs/method.md)."""
    moments.main(1, 11)
    assert "1 within 2 % of the springs' bracket" in " ".join(capsys.readouterr().out.split())


@pytest.mark.slow
def test_the_wedge_names_every_solver_and_its_rows_make_sense(monkeypatch, tmp_path):
    monkeypatch.setattr(speed_error, "TURNS", {"quick": 0, "full": 0})
    rows = speed_error.wedge(quick=True)
    solvers = set(speed_error.SOLVERS) - {speed_error.RANGED}  # a range is that of many blocks
    assert {row.solver for row in rows} == solvers
    for row in rows:
        assert row.blocks == 1
        assert row.node_pairs > 0
        if row.solver == speed_error.SICONOS and rivals.siconos_python() is None:
            assert (row.factor, row.seconds) == (None, None)
            assert "not installed" in row.note
            continue
        assert row.factor is not None
        assert row.error is not None
        assert row.error >= 0.0
        assert min(row.seconds, row.to_closed_form, row.to_slopekit) > 0.0
        assert not row.estimated
    error = {(row.solver, row.effort): row.error for row in rows}
    assert error[speed_error.SLOPEKIT, ""] < 1e-12
    assert error[speed_error.SEQUENCE, "to 1e-06"] < 1e-5
    # the static bound of METHOD.md §3 is 1.5868 against 1.5574: normality costs that however well it is solved
    assert math.isclose(error[speed_error.CONIC, "to 1e-06"], 1.5868 / 1.5574 - 1.0, abs_tol=1e-4)
    monkeypatch.setattr(speed_pages, "_DOCS", tmp_path)
    monkeypatch.setattr(speed_pages, "_JSON", tmp_path / "speed.json")
    speed_pages.keep("wedge", rows, quick=True)
    speed_pages.write()
    page = (tmp_path / "speed.md").read_text()
    assert all(f"| {solver} " in page for solver in solvers)
    assert (tmp_path / "images" / "speed-wedge.png").stat().st_size > 10_000


def test_many_blocks_with_and_without_their_range() -> None:
    """The same limit, which the note says what it is; a case of `python -m benchmarks.blocks speed`."""
    contacts = block_speed.scene_of("columns", 16)[0].model(38.15)
    alone, ranged = (speed_error.steps_to_the_limit(contacts, ranged) for ranged in (False, True))
    assert alone == ranged
    assert "limit: bound" in alone.note
    found = block_speed.case("columns", 16, 1)
    assert found["basis"] == "limit"
    assert math.isclose(found["factor"], found["exact"], rel_tol=1e-9)
    assert "limit" in block_speed.printed(found)


def test_elastic_blocks_are_timed_with_the_order_that_is_asked_for() -> None:
    """Eight tetrahedra: 35 nodes of order two, ten of order one, three unknowns each; three of each node pair; six."""
    plain = sk.wedge(("45/115", "45/245"), shear_stiffness=1e5, edge=140)
    for order, nodes in ((1, 10), (2, 35)):
        found, took = elastic_speed.timed(plain, order)
        mesh = found.mesh
        assert (mesh.cells, mesh.order) == (8, order)
        assert mesh.unknowns == 3 * nodes + 3 * mesh.node_pairs + 6
        assert took > 0.0


def test_every_mutation_still_changes_a_line() -> None:
    """Code that moves takes its row of `benchmarks.mutation_table` with it; the tests named there are there."""
    assert mutations.stale() == []
    first = mutations.MUTATIONS[0]
    gone = [
        replace(first, old="no such line"),
        replace(first, file="src/gone.py"),
        replace(first, tests=("tests/no",)),
    ]
    assert len(mutations.stale(gone)) == len(gone)


def test_what_is_run_again_takes_its_row_and_leaves_the_others() -> None:
    """The page is that of the record; one that survives counts as that."""
    rows = json.loads(mutations.RECORD.read_text(encoding="utf-8"))
    page = mutations.PAGE.read_text(encoding="utf-8")
    assert mutations.page(mutations.recorded([], rows)) == page
    assert [(row["group"], row["name"]) for row in rows] == [
        (one.group, one.name) for one in mutations.MUTATIONS
    ]
    one = mutations.MUTATIONS[3]
    again = mutations.recorded([mutations.Outcome(one, ())], rows)
    changed = [row for row, before in zip(again, rows, strict=True) if row != before]
    assert changed == [rows[3] | {"failed": []}]
    assert rows[3]["failed"] != []
    caught = sum(bool(row["failed"]) for row in rows) - 1
    assert f"{caught} of {len(mutations.MUTATIONS)} mutations are caught" in mutations.page(again)
    assert f"**{one.name}: not caught**" in mutations.page(again)


def test_a_count_that_rises_is_named() -> None:
    """Whether the source is within `.ci/limits.json` is asked by `.ci/run`."""
    limits = json.loads(census.LIMITS.read_text(encoding="utf-8"))
    (fault,) = census.exceeded(
        census.census_of(["def own(): pass"]), dict(limits) | {"function_words": 0}
    )
    assert fault == "function_words: 1, limit 0"
