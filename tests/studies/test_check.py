"""`slopekit check`: ladders, verdicts, on every kind; and that a wrong number is not called sound."""

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.codec import record_of
from slopekit.design.templates import path_of
from slopekit.kinds.assemblies import many_blocks, many_blocks_ladder
from slopekit.kinds.single_block import ladders
from slopekit.kinds.single_block.ladders import Rung, timed
from slopekit.preie.elastic_path.rests import CONFIRMATION_GAP
from slopekit.studies.check import Check, Finding, check
from tests.closed_form.scalar_wedge import hoek_bray_wedge
from tests.properties.test_not_unique import BONDED_ROW, ROUGH_COLUMNS, TWO_BLOCKS, two_paths

ONE_PLANE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/180", "upper": "0/180", "height": 10},
    "joints": {"J1": {"plane": "45/160"}, "J2": {"plane": "80/240"}},
    "strength": {"s": {"c": 20, "phi": 30}},
    "rock": {"unit_weight": 26},
}


def checked(name: str, **values) -> Check:
    return check(sk.load(path_of(name), set=values))


@cache
def plain(name: str) -> Check:
    """The check of a template as it is, once for all tests."""
    return checked(name)


@cache
def rough_columns() -> Check:
    return check(sk.load(ROUGH_COLUMNS))


def finding(found: Check, name: str) -> Finding:
    return next(one for one in found.findings if one.name == name)


def rungs(found: Check, method: str) -> list[tuple[Rung, float | None]]:
    return [
        (rung, error)
        for rung, error in zip(found.ladder, found.errors, strict=True)
        if rung.method == method
    ]


@pytest.mark.parametrize(("phi", "consistent"), [(20.6, False), (20.7, False), (21.2, True)])
def test_two_limit_states_close_together_are_not_consistent(phi, consistent) -> None:
    """1 % of the strength of one joint moves the limit by 12 % where two paths of the bed cross."""
    found = check(sk.load(two_paths(phi)))
    assert found.consistent is finding(found, "neighbours").met is consistent


def test_meshes_that_flip_are_not_consistent(monkeypatch) -> None:
    """The last two agree, but finer ones have moved the limit by more than coarser ones did."""
    monkeypatch.setattr(ladders, "_split_factor", lambda _, level: 0.53 if level < 2 else 0.4712)
    assert finding(check(sk.load(two_paths(21.2))), "node pairs").met is False


def test_a_neighbour_without_a_factor_is_said_and_no_zero(monkeypatch) -> None:
    monkeypatch.setattr(ladders, "_neighbours", lambda *_: iter([None, 0.5]))
    found = finding(check(sk.load(two_paths(21.2))), "neighbours")
    assert (found.value, found.met) == (None, False)
    assert found.words == "with 1% more or less strength of one joint none is found"


def test_the_paper_wedge() -> None:
    """Against Hoek & Bray: flat joints, so node pairs do not matter."""
    found = plain("paper-wedge")
    assert found.consistent
    assert found.exit_code == 0
    assert found.against == "the closed form"
    assert found.reference == pytest.approx(1.5573963527, abs=1e-9)
    assert all(error < 1e-12 for _, error in rungs(found, "mesh"))
    assert found.result.fos.all_pairs_failed == pytest.approx(1.554, abs=5e-4)  # the paper's own
    assert finding(found, "upper bound").met


@pytest.mark.parametrize("name", ["plane", "footing", "topple"])
def test_kinds_with_a_closed_form_agree(name) -> None:
    found = plain(name)
    assert found.consistent
    assert found.against == "the closed form"
    assert finding(found, "closed form").met
    assert min(error for error in found.errors if error is not None) < 1e-4


@pytest.mark.parametrize(
    ("name", "values"), [("paper-ellipsoid", {"slip.edge": 20}), ("blocks", {}), ("wall", {})]
)
def test_kinds_without_a_closed_form_say_so(name, values) -> None:
    """They are judged by finer node pairs where there are any, and by the bound."""
    found = checked(name, **values) if values else plain(name)
    assert found.consistent
    assert finding(found, "closed form").met is None
    assert "there is none" in finding(found, "closed form").words
    assert found.against != "the closed form"
    assert finding(found, "upper bound").met
    assert finding(found, "admissible").met


def test_curved_surfaces_converge_with_their_mesh() -> None:
    """φ = 0 on a sphere has an exact answer: the error falls with every halving, by four (second order) or more."""
    found = checked("sphere", **{"slip.edge": 3})
    errors = [error for _, error in rungs(found, "mesh")]
    assert len(errors) >= 2
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < errors[0] / 4.0
    factors = [rung.factor for rung, _ in rungs(found, "mesh")]
    steps = np.abs(np.diff(factors))
    assert (np.log2(steps[:-1] / steps[1:]) > 1.5).all()


def test_moments_govern_is_judged_by_the_mesh() -> None:
    """METHOD.md §3: 1.502 against 1.538. Forces alone are held against the closed form, the limit against itself."""
    found = check(sk.load(ONE_PLANE))
    assert found.result.moments_govern
    assert found.against.startswith("the finest node pairs")
    assert finding(found, "closed form").met
    assert "forces alone" in finding(found, "closed form").words
    alone = rungs(found, "forces alone")[0][0].factor
    assert alone == pytest.approx(hoek_bray_of(found), rel=1e-9)
    assert finding(found, "node pairs").met
    assert found.consistent


def hoek_bray_of(found: Check) -> float:
    design = found.result.design
    factor = hoek_bray_wedge(
        design.joints,
        design.face,
        design.upper,
        design.height_m,
        design.cohesion_kpa,
        design.friction_angle_deg,
        design.rock.unit_weight_kn_m3,
    ).factor
    assert factor is not None
    return factor


@pytest.mark.parametrize(
    ("values", "status"),
    [
        ({"water": {"pressures": {"L-WSP": 2000, "R-WSP": 2000}}}, "lifted"),
        ({"strength.structural plane.c": 0, "strength.structural plane.phi": 0}, "slides_on_both"),
    ],
)
def test_without_a_factor_there_is_no_ladder(values, status) -> None:
    """The statuses of both methods are compared."""
    found = checked("paper-wedge", **values)
    assert found.result.status == status
    assert found.result.fos.limit is None
    assert found.ladder == ()
    assert found.reference is None
    assert finding(found, "closed form").met
    assert found.consistent


@pytest.mark.parametrize("cohesion", [0, 5])
def test_blocks_of_a_section_are_not_refined(cohesion) -> None:
    """Three node pairs a contact carry every linear traction, with cohesion too; the check says so."""
    found = checked("wall", **{"strength.joint.c": cohesion}) if cohesion else plain("wall")
    assert "ends" in finding(found, "node pairs").words
    assert len(rungs(found, "mesh")) == 1


@pytest.mark.parametrize(
    ("design", "stiff", "soft"),
    [
        (ROUGH_COLUMNS, 0.905, 0.670),
        (TWO_BLOCKS, 0.529555, 0.529555),
        (BONDED_ROW, 1.532417, 1.532347),
    ],
    ids=["rough columns", "two blocks", "bonded row"],
)
def test_the_shear_stiffness_of_the_elastic_joints_has_its_rungs(design, stiff, soft) -> None:
    """The prototype of the path with k_t/k_n 1 and 0.1, to its digits; of the bonded row on finer pairs."""
    found = rough_columns() if design is ROUGH_COLUMNS else check(sk.load(design))
    by_ratio = {rung.setting_value: rung.factor for rung, _ in rungs(found, "stiffness")}
    assert by_ratio.keys() == {0.1, 1.0}
    for ratio, wanted in ((1.0, stiff), (0.1, soft)):
        assert by_ratio[ratio] == pytest.approx(
            wanted, abs=10.0 ** -len(str(wanted).partition(".")[2])
        )


def test_a_limit_that_hangs_on_the_stiffness_of_the_joints_is_not_consistent() -> None:
    """Rough columns: 0.905 with k_t/k_n 1 and 0.670 with 0.1, the limit 0.8175 (the prototype of the path)."""
    found = check(sk.load(ROUGH_COLUMNS))
    one = finding(found, "stiffness ratio")
    assert one.value == pytest.approx(1.0 - 0.670 / 0.8175, abs=2e-3)
    assert (one.met, one.code, record_of(one)["code"]) == (False, "W364", "W364")
    assert "0.6698 with k_t/k_n 0.1, 0.9048 with k_t/k_n 1" in one.words
    assert "judge by the range of its mechanism, 0.6689 .. 0.9715" in one.words
    assert [other.name for other in found.findings if other.met is False] == ["stiffness ratio"]
    assert found.consistent is False
    assert found.exit_code == 4
    assert "depends on the stiffness of the joints" in found.line


def test_a_limit_that_is_the_same_on_all_joints_is_consistent() -> None:
    found = check(sk.load(TWO_BLOCKS))
    one = finding(found, "stiffness ratio")
    assert one.value < 1e-6
    assert (one.met, record_of(one)["code"]) == (True, None)
    assert found.consistent


def test_forces_of_a_group_s_limit_are_held_against_the_strength_at_which_all_blocks_rest(
    monkeypatch,
) -> None:
    """The bench's limit is that of five blocks, its forces are those of all just before it: admissible there only."""
    monkeypatch.setattr(many_blocks.SolvedAssembly, "with_all_pairs", lambda solution: solution)
    for name, nothing in (("_rungs", ()), ("_factors_at_other_strengths", ())):
        monkeypatch.setattr(many_blocks_ladder, name, lambda *_, nothing=nothing: nothing)
    found = checked("bench")
    beyond = found.result.limit_state.balance.friction_excess
    assert beyond > 1e-4  # against the strength at the limit itself
    assert finding(found, "admissible").value < 1e-9
    holds = finding(found, "holds at limit")
    assert 1e-4 < holds.value <= (1.0 + 1e-9) * CONFIRMATION_GAP
    assert holds.met
    assert f"F = {found.result.fos.limit * (1.0 - holds.value):.6g}" in holds.words
    assert found.consistent


def test_without_a_limit_at_another_stiffness_it_is_not_judged(monkeypatch) -> None:
    """And what the other ratio says counts still."""
    lost = {"factor": 1.0}

    def ladder(solved):
        limit = solved.result.fos.limit
        return (
            Rung("stiffness", "", 1, 0.1, None, 0.0),
            Rung("stiffness", "", 1, 1.0, limit * lost["factor"], 0.0),
        )

    monkeypatch.setattr(many_blocks_ladder, "_rungs", ladder)
    one = finding(check(sk.load(BONDED_ROW)), "stiffness ratio")
    assert (one.met, one.value) == (None, None)
    assert "none with k_t/k_n 0.1" in one.words
    lost["factor"] = 1.02
    one = finding(check(sk.load(BONDED_ROW)), "stiffness ratio")
    assert (one.met, one.value) == (False, pytest.approx(0.02))


@pytest.mark.parametrize(("by", "seen"), [(1.015, {"holds at limit"}), (0.95, set())])
def test_a_limit_that_its_forces_do_not_carry_is_not_consistent(by, seen, monkeypatch) -> None:
    """Even where agree_within is wide: forces that balance at one factor prove nothing of a higher one.

    A limit that is too low is one that more than its forces would hold: said by the closed form and the node pairs.
    """
    from slopekit.kinds.single_block.one_block import SingleBlock

    honest = SingleBlock.analyse

    def off(*given):
        result = honest(*given)
        return replace(
            result, fos=replace(result.fos, limit=result.fos.limit * by), difference=abs(by - 1.0)
        )

    monkeypatch.setattr(SingleBlock, "analyse", off)
    found = checked("paper-wedge", **{"analysis.agree_within": 0.1})
    failed = {one.name for one in found.findings if one.met is False}
    assert failed >= seen
    assert bool(failed) == bool(seen)
    assert found.exit_code == (4 if seen else 0)
    if seen:
        return
    narrow = checked("paper-wedge", **{"analysis.agree_within": 0.001})
    assert "node pairs" in {one.name for one in narrow.findings if one.met is False}
    assert narrow.exit_code == 4


def test_nothing_independent_is_not_judged() -> None:
    """A block at rest on a base: a status, and nothing to hold it against."""
    resting = check(
        sk.load(
            {
                "slopekit": 1,
                "kind": "blocks",
                "section": {"thickness": 1},
                "blocks": {
                    "base": {"polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]], "fixed": True},
                    "B": {"polygon": [[0, 0], [1, 0], [1, 1], [0, 1]]},
                },
                "strength": {"joint": {"c": 0, "phi": 30}},
                "rock": {"unit_weight": 25},
            }
        )
    )
    assert resting.result.status == "no_driving_force"
    assert resting.consistent is None
    assert resting.exit_code == 0


def test_another_strength_leads_to_the_same_limit_state() -> None:
    """Rough columns have many limit states (`tests/properties/test_not_unique.py`); the elastic path ends in one."""
    found = rough_columns()
    assert finding(found, "other strengths").value < 1e-6
    assert finding(found, "other strengths").met


def test_a_limit_that_is_not_the_only_one_is_found_out(monkeypatch) -> None:
    """Half the strength with less than half the factor: the number hangs on the way there."""
    monkeypatch.setattr(
        many_blocks_ladder,
        "_factors_at_other_strengths",
        lambda solved: (0.9 * solved.result.fos.limit,) * 2,
    )
    found = check(sk.load(ROUGH_COLUMNS))
    assert finding(found, "other strengths").value > 0.05
    assert "not unique" in finding(found, "other strengths").words
    assert found.exit_code == 4


def test_acceptance_is_judged() -> None:
    """The road cut at 1.2467 does not meet 1.5: consistent, exit code 1."""
    found = checked("plane", acceptance={"rules": ["fos >= 1.5"]})
    assert found.consistent
    assert found.exit_code == 1
    assert found.to_dict()["accepted"] is False


def test_a_surface_without_finer_pairs_is_not_judged_by_its_own(monkeypatch) -> None:
    """Beyond so many pairs no finer mesh is tried: nothing is said of convergence."""
    monkeypatch.setattr(ladders, "MOST_PAIRS", 150)
    found = checked("sphere", **{"slip.edge": 8})
    assert finding(found, "node pairs").met is None
    assert "finer" in finding(found, "node pairs").words


def test_json_is_strict_and_the_same_twice_but_for_times() -> None:
    first, second = plain("plane").to_dict(), checked("plane").to_dict()
    assert json.loads(json.dumps(first, allow_nan=False)) == first
    for document in (first, second):
        del document["timing_s"]  # and which setting was the quickest
    assert first == second
    assert {"consistent", "findings", "ladder", "reference", "fos", "balance"} <= first.keys()
    assert first["input_sha256"] == sk.load(path_of("plane")).input_hash()


def test_timed_takes_a_middle_one(monkeypatch) -> None:
    monkeypatch.setattr(ladders, "_REPEATS", 5)
    calls = []
    found, seconds = timed(lambda: calls.append(1) or len(calls))
    assert found == len(calls) >= 2
    assert 0.0 < seconds < math.inf
