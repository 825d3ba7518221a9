"""`slopekit support` for toppling columns: solved by hand, Goodman & Bray's published anchor, forces put back."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import slopekit as sk
from slopekit.closed_form.toppling import ColumnSlope, anchor_force_required, toe_force_required, toppling_table
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from tests.commands import slopekit

HEIGHTS = [4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4]
GOODMAN_BRAY = {
    "slopekit": 1, "kind": "topple", "strength": {"joint": {"c": 0, "phi": 33.0239}}, "rock": {"unit_weight": 25},
    "columns": {"dip": 60, "width": 10, "base_step": 1, "heights": HEIGHTS},
}  # fmt: skip
#: a tall column behind a low one
THREE = {
    "slopekit": 1, "kind": "topple", "strength": {"joint": {"c": 0, "phi": 30}}, "rock": {"unit_weight": 25},
    "columns": {"dip": 70, "width": 2, "base_step": 0.5, "heights": [3, 9, 5]},
}  # fmt: skip


def by_hand(column: int, plunge: float, height: float, factor: float) -> float:
    """The force on C1 or C2 of `THREE` (per metre), column by column: Goodman & Bray (1976), every case tried.

    C3 pushes C2 with P2, C2 pushes C1 with P1. C1 allows so much P1 before it slides or topples; C2 needs the force
    that leaves no more. Each is a straight line in the force.
    """
    dip, width, slope = math.radians(20.0), 2.0, math.tan(math.radians(30.0)) / factor
    down, off = ({y: 25.0 * width * y * turn(dip) for y in (3.0, 9.0, 5.0)} for turn in (math.sin, math.cos))
    along, into = math.cos(dip + math.radians(plunge)), math.sin(dip + math.radians(plunge))
    locks = 1.0 - slope**2
    p2 = max((down[5.0] * 5.0 - off[5.0] * width) / 2.0 / 5.0, (down[5.0] - off[5.0] * slope) / locks, 0.0)
    # C3 pushes C2 at its own top, 5.5 m above the base of C2; C2 pushes C1 at the top of that, 2.5 m above its own base
    own = (down[9.0] * 9.0 - off[9.0] * width) / 2.0
    tipped = (p2 * (5.5 - width * slope) + own) / 2.5
    slid = p2 + (down[9.0] - off[9.0] * slope) / locks
    slide_1 = (down[3.0] - off[3.0] * slope) / locks
    tip_1 = (down[3.0] * 3.0 - off[3.0] * width) / 2.0
    if column == 1:
        p1 = max(tipped, slid, 0.0)
        slides = (p1 + slide_1) * locks / (along + into * slope)
        return max(slides, (p1 * (3.0 - width * slope) + tip_1) / (along * height), 0.0)
    most = min(-slide_1, -tip_1 / (3.0 - width * slope))
    assert most >= 0.0
    return max((tipped - most) * 2.5 / (along * height), (slid - most) * locks / (along + into * slope), 0.0)


@pytest.mark.parametrize("plunge", [0.0, 12.0])
@pytest.mark.parametrize("factor", [1.0, 1.3])
@pytest.mark.parametrize(("column", "height"), [(1, 1.5), (2, 0.5 * (2.5 + 9.0))])
def test_a_row_solved_by_hand(column, height, factor, plunge) -> None:
    """Where the force acts: half way up C1; in the middle of what C2 shows above C1."""
    found = sk.support(sk.load(THREE), factor, acts="active", toward=f"090/{plunge}")
    one = found.held[column - 1]
    assert (one.column, one.where, one.height) == (f"C{column}", ("toe", "crest")[column - 1], height)
    wanted = by_hand(column, plunge, height, factor)
    assert wanted > 0.0
    assert one.closed_form.force == pytest.approx(wanted, rel=2e-6)
    assert one.closed_form.force >= wanted
    assert one.closed_form.fos == pytest.approx(factor, rel=1e-6)
    assert found.columns[column - 1].force == one.closed_form.force


def test_the_published_anchor_of_the_toe_block_by_both_methods() -> None:
    """tan φ = 0.65: 2013 kN per metre on block 1, level (Goodman & Bray 1976; Wyllie & Mah 2004, §9.4.5).

    2012.857 recomputed. PRE-IE has the same: its contacts are those of the method. No force on the crest is enough:
    block 8 and 9 topple by themselves.
    """
    toe, crest = sk.support(sk.load(GOODMAN_BRAY), 1.0, acts="active").held
    assert toe.closed_form.force == pytest.approx(2012.857, abs=1e-3)
    assert round(toe.use_kn) == 2013
    assert toe.pre_ie.force == pytest.approx(toe.closed_form.force, rel=1e-6)
    assert toe.pre_ie.fos >= 1.0
    assert (crest.column, crest.use_kn, crest.bolt) == ("C10", None, None)
    assert {notice.code for notice in crest.notices} == {"E390", "E329"}
    assert crest.closed_form.fos == pytest.approx(crest.pre_ie.fos, rel=1e-4)
    below = GOODMAN_BRAY | {"columns": GOODMAN_BRAY["columns"] | {"heights": HEIGHTS[:9]}}
    assert crest.closed_form.fos == pytest.approx(sk.run(below).fos.closed_form, rel=1e-6)  # C10 leans on them no more


@pytest.mark.parametrize("plunge", [0.0, 20.0])
def test_on_column_1_the_search_is_the_closed_formula(plunge) -> None:
    slope = ColumnSlope(HEIGHTS, 10, 1, 30, 25, 33.0239, toe_force_plunge_deg=plunge, toe_force_height_m=3.0)
    assert anchor_force_required(slope, 1.1) == pytest.approx(toe_force_required(slope, 1.1), rel=1e-12)


def test_a_force_out_of_the_slope_is_never_enough_and_none_is_needed_where_it_stands() -> None:
    slope = ColumnSlope([3, 9, 5], 2, 0.5, 20, 25, 30, toe_force_plunge_deg=180.0 - 1e-9)
    assert anchor_force_required(slope, 1.3) == math.inf
    assert anchor_force_required(ColumnSlope([3, 3], 2, 0.5, 20, 25, 30)) == 0.0
    with pytest.raises(DesignError, match="E260 the force acts on column 4"):
        ColumnSlope([3, 9, 5], 2, 0.5, 20, 25, 30, force_column=4)


def test_what_is_pasted_gives_the_target_and_no_more(tmp_path: Path) -> None:
    """Three metres of slope; a passive anchor has F times the force of an active one."""
    design = THREE | {"columns": THREE["columns"] | {"thickness": 3}}
    found = sk.support(sk.load(design), 1.3)
    assert found.reached
    active, passive = found.least("active"), found.least("passive")
    assert passive.closed_form.force == pytest.approx(1.3 * active.closed_form.force, rel=1e-9)
    assert passive.pre_ie.force == pytest.approx(1.3 * active.pre_ie.force, rel=1e-6)
    files = found.files()
    assert files.keys() == {"support-active.yaml", "support-passive.yaml"}
    for text in files.values():
        limit = sk.run(design | YAML(typ="safe").load(text)).fos.limit
        assert 1.3 <= limit <= 1.3 * 1.0003
    assert active.bolt.force_kn == pytest.approx(3.0 * active.use_kn, rel=1e-4)
    bare = sk.support(sk.load(THREE), 1.3).least("active")
    assert bare.use_kn == pytest.approx(active.use_kn, rel=1e-6)


def test_forces_of_the_table_that_no_base_can_carry_are_said(monkeypatch) -> None:
    def lifted(slope: ColumnSlope, factor: float):
        found = toppling_table(slope, factor)
        return replace(found, base_holds=np.arange(16) != 3)

    monkeypatch.setattr("slopekit.studies.support.columns.run.toppling_table", lifted)
    found = sk.support(sk.load(GOODMAN_BRAY), 1.0, acts="active")
    assert "W445" in {notice.code for one in found.held for notice in one.notices}
    assert "not admissible at C4" in " ".join(str(found).split())


def test_columns_that_stand_need_nothing() -> None:
    found = sk.support(sk.load(path_of("topple")), 1.2)
    assert (found.stands, found.held, found.exit_code, found.files()) == (True, (), 0, {})
    assert "no more support is needed" in str(found)


def test_rules_that_holding_columns_does_not_judge_are_named() -> None:
    """W508: the factor of a rule is reached; nobody looked at the lowest, which another asks for."""
    rules = {"acceptance": {"rules": ["fos >= 0.5", "fos.lowest >= 0.9"]}}
    found = sk.support(sk.load(GOODMAN_BRAY | rules))
    assert (found.target, found.stands) == (0.5, True)
    (said,) = (notice.message for notice in found.warnings if notice.code == "W508")
    assert "fos.lowest >= 0.9" in said


def test_without_the_table_pre_ie_alone_says_the_force() -> None:
    """Cohesion on the sides is not in Goodman & Bray's method."""
    design = THREE | {
        "strength": {"base": {"c": 0, "phi": 30}, "side": {"c": 5, "phi": 30}},
        "columns": THREE["columns"] | {"base": "base", "sides": "side"},
    }
    found = sk.support(sk.load(design), 1.3, acts="active")
    toe = found.held[0]
    assert toe.closed_form is None
    assert 0.0 < toe.use_kn == toe.pre_ie.force
    assert toe.pre_ie.fos >= 1.3
    assert "knows no cohesion on the sides" in " ".join(str(found).split())


def test_what_columns_do_not_take_is_named_at_once() -> None:
    rows = sk.load(THREE, set={"columns.rows": 2})
    with pytest.raises(DesignError) as caught:
        sk.support(rows, 1.3, toward="045/10", plunge="0,10", spacing=2, length="9 m")
    assert caught.value.codes == ("E387", "E388", "E389", "E389", "E389")


def test_the_command_writes_sheet_json_and_files(tmp_path: Path) -> None:
    design = tmp_path / "three.yaml"
    design.write_text("".join(f"{key}: {json.dumps(value)}\n" for key, value in THREE.items()), encoding="utf-8")
    run = slopekit("support", str(design), "--fos", "1.3", "--acts", "active", "--json", "-o", str(tmp_path / "out"))
    assert (run.returncode, run.stderr) == (0, "")
    document = json.loads(run.stdout)
    assert document["held"][0].keys() == {
        "acts", "column", "where", "height_m", "at_m", "toward", "closed_form", "pre_ie", "notices", "reached",
        "use_kn", "support",
    }  # fmt: skip
    assert [row["column"] for row in document["columns"]] == ["C1", "C2", "C3"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "support-active.yaml", "support.csv", "support.json", "support.txt",
    ]  # fmt: skip
    sheet = (tmp_path / "out" / "support.txt").read_text(encoding="utf-8")
    assert max(map(len, sheet.splitlines())) <= 100
    short = slopekit("support", str(design), "--fos", "1.3", "--acts", "active", "--toward", "270/0", "--quiet")
    assert (short.returncode, short.stdout) == (1, "active  not reached  E390  E329\n")
