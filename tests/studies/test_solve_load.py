"""A load of many blocks straight from the path in it."""

import json
import math
from contextlib import suppress
from dataclasses import replace
from types import SimpleNamespace

import pytest

import slopekit as sk
from benchmarks.blocks import multiplier
from slopekit.core.errors import DesignError, Notice
from slopekit.design.reading.files import with_values
from slopekit.design.templates import path_of
from slopekit.kinds import kind_of
from slopekit.kinds.protocol import AtLoad, Factors
from slopekit.notices import lost_cohesion_notices
from slopekit.preie.solvers import work_limit
from slopekit.studies.points import Point
from slopekit.studies.quake import yielding
from slopekit.studies.running import ALONE
from slopekit.studies.solve import by_factor, factor_request
from slopekit.studies.solve.roots import RootSearch, Sample

COLUMN = {
    "slopekit": 1, "kind": "blocks",
    "blocks": {"base": {"polygon": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True},
               "B1": {"polygon": [[0, 0], [1, 0], [1, 2], [0, 2]]}},
    "strength": {"joint": {"c": 0, "phi": 60}}, "rock": {"unit_weight": 25},
    "loads": {"seismic": {"k": 0.1, "toward": "090"}},
}  # fmt: skip


KEY = "loads.seismic.k"
DIP, PHI = math.radians(20.0), math.radians(35.0)
YIELD = math.tan(PHI - DIP)  # of a slab on a plane


def _slab():
    """A slab 20 m long and 1 m high on a plane that dips west by 20°."""
    along, up = (math.cos(DIP), math.sin(DIP)), (-math.sin(DIP), math.cos(DIP))
    at = [[t * along[0] + n * up[0], t * along[1] + n * up[1]] for t, n in ((10, 0), (30, 0), (30, 1), (10, 1))]
    base = [[0, 0], [40 * along[0], 40 * along[1]], [40 * along[0], -5], [0, -5]]
    return sk.load({
        "slopekit": 1, "kind": "blocks", "rock": {"unit_weight": 25},
        "blocks": {"base": {"polygon": base, "fixed": True}, "B1": {"polygon": at}},
        "strength": {"joint": {"c": 0, "phi": 35}}, "loads": {"seismic": {"k": 0, "toward": 270}},
    })  # fmt: skip


def test_a_column_tips_at_its_slenderness_and_what_it_holds_there_is_said() -> None:
    """1 m by 2 m tips at k = 1/2 whatever its friction: there it would slide at F = tan 60° / k, and jumps to none."""
    found = sk.solve(sk.load(COLUMN), KEY, fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(0.5, rel=1e-9)
    assert found.answer.strength_last == pytest.approx(math.tan(math.radians(60.0)) / 0.5, rel=1e-9)
    root = found.to_dict()["pre_ie"]["roots"][0]
    assert (root["fos"], root["misses_by"], root["put_back"]) == (None, None, None)
    assert [notice.code for notice in found.warnings] == ["W356"]
    sheet = str(found)
    assert "put back its FoS is 3.4641" in sheet
    for claim in ("misses by", "BRACKET", "REACH", "the methods at"):  # there was no search, and no second method
        assert claim not in sheet


def test_both_ways_to_the_yield_of_a_slab_are_one() -> None:
    """k = tan(φ - β), by the path in the load, and its factor put back is the target: nothing is searched."""
    found = sk.solve(_slab(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(YIELD, rel=1e-9)
    assert found.answer.factor == pytest.approx(1.0, rel=1e-9)
    assert found.answer.load_last == (found.answer.value, None)
    assert found.pre_ie.evaluations == 2
    assert found.warnings == ()


@pytest.mark.parametrize(("part", "runs"), [(1.3, None), (0.8, 0.9), (1.3, 1.31)])
def test_where_the_ways_differ_the_value_is_that_of_the_strength(monkeypatch, part, runs) -> None:
    """Wherever another history ended, k is where the factor is the target; the other end is said."""
    other = AtLoad(part * YIELD, "slides", None if runs is None else runs * YIELD)
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: other)
    found = sk.solve(_slab(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(YIELD, rel=2e-6)
    assert found.answer.factor == pytest.approx(1.0, rel=1e-6)
    assert found.answer.load_last == (other.multiplier, other.runs)
    assert found.to_dict()["pre_ie"]["roots"][0]["load_last"] == {"value": other.multiplier, "runs": other.runs}
    assert found.pre_ie.evaluations <= 9
    assert [notice.code for notice in found.warnings] == ["W477"]
    assert "load last" in str(found)


@pytest.mark.parametrize("part", [0.8, 1.3])
def test_a_force_is_looked_for_from_none_upwards(monkeypatch, part) -> None:
    """W (sin β + k cos β) with k W the force, which could also be negative and a million times as large."""
    pushed = with_values(_slab(), {"loads.forces": [{"force": "10 kN", "block": "B1", "toward": "270/0"}]})
    weight = 20.0 * 25.0
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: AtLoad(part * YIELD * weight, "slides", None))
    found = sk.solve(pushed, "loads.forces.0.force", fos=1.0)
    assert found.answer.value == pytest.approx(YIELD * weight, rel=2e-6)
    assert found.pre_ie.evaluations <= 9


def test_the_end_of_the_path_stands_where_no_factor_is_found_beyond_it(monkeypatch) -> None:
    """As for the published wall W3, refused with E319: 1.83 at its multiplier, not converged above, then none."""
    own = factor_request.FactorRequest.samples

    def samples(self, method, values):
        lost = {"level": None, "label": "not_converged"}
        return [replace(one, **lost) if 0.5 < one.at < 0.55 else one for one in own(self, method, values)]

    monkeypatch.setattr(factor_request.FactorRequest, "samples", samples)
    found = sk.solve(sk.load(COLUMN), KEY, fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(0.5, rel=1e-9)
    assert found.answer.strength_last == pytest.approx(math.tan(math.radians(60.0)) / 0.5, rel=1e-9)
    assert [notice.code for notice in found.warnings] == ["W356"]


def test_a_jump_beyond_the_end_of_the_other_history_says_both(monkeypatch) -> None:
    """The column that tips at 1/2, where another history is said to end before: both stand on the sheet."""
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: AtLoad(0.45, "topples", None))
    found = sk.solve(sk.load(COLUMN), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(0.5, rel=1e-4)
    assert found.answer.value <= 0.5
    assert found.answer.load_last == (0.45, None)
    assert [notice.code for notice in found.warnings] == ["W356", "W477"]


@pytest.mark.parametrize(
    ("part", "runs", "taken"), [(0.8, None, 0.8), (1.3, None, 1.0), (0.8, 0.81, 0.8), (1.3, 1.31, 1.0)]
)
def test_an_earthquake_takes_the_lower_of_two_histories(monkeypatch, part, runs, taken) -> None:
    """Where the load comes on last, or where the factor is 1 with the strength divided last, limit or rest."""
    other = AtLoad(part * YIELD, "slides", None if runs is None else runs * YIELD)
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: other)
    found = by_factor.for_factor(_slab(), KEY, 1.0, None, ALONE, lambda _: None, lower=True)
    assert found.answer.value == pytest.approx(taken * YIELD, rel=2e-6)


def test_blocks_that_fail_without_the_load_are_said_to_at_once() -> None:
    """Goodman & Bray's columns hold 0.99996 without an earthquake, though they rest elastically to k 0.018."""
    found = sk.solve(sk.load(path_of("goodman-bray")), KEY, fos=1.0)
    assert found.answer is None
    assert found.reason.code == "E315"
    assert "at most 0.999957, at 0 " in found.reason.message
    assert found.pre_ie.evaluations == 2


def test_a_slab_that_slides_by_itself_is_looked_at_at_three_places() -> None:
    found = sk.solve(with_values(_slab(), {"strength.joint.phi": 15.0}), KEY, fos=1.0)
    assert found.reason.code == "E315"
    assert found.pre_ie.evaluations == 3


def test_work_of_one_answer_ends(monkeypatch) -> None:
    """What is known by then is said, and that it is cut short; no value is claimed not to exist."""
    monkeypatch.setattr(work_limit, "MOST", 3e4)
    found = sk.solve(sk.load(path_of("bench")), KEY, fos=1.0)
    assert found.answer is None
    assert found.reason.code == "E319"
    assert "before a factor of 1 was found" in found.reason.message
    assert "W360" in [notice.code for notice in found.warnings]
    assert found.exit_code == 4


@pytest.mark.parametrize("work", [1e5, 1e6])
def test_an_earthquake_that_was_not_looked_at_to_the_end_has_no_yield(monkeypatch, work) -> None:
    """It said that no k up to 2 moves the blocks, and 0 cm in every record, or ended in an IndexError."""
    monkeypatch.setattr(work_limit, "MOST", work)
    monkeypatch.setattr(yielding, "check_stands", lambda _: None)
    with pytest.raises(DesignError) as refused:
        yielding.yields_of(with_values(sk.load(path_of("blocks")), {KEY: 0.0, "loads.seismic.toward": 90.0}), ALONE,
                           lambda _: None)  # fmt: skip
    assert [fault.code for fault in refused.value.faults] == ["E319"]


def test_a_yield_of_another_history_has_no_factor_of_the_motion(monkeypatch) -> None:
    """The path in the load is said to end beyond the k at which the factor is 1: its motion is none of that k."""
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: AtLoad(1.3 * YIELD, "slides", None))
    (ours,) = yielding.yields_of(_slab(), ALONE, lambda _: None)
    assert ours.coefficient == pytest.approx(YIELD, rel=2e-6)
    assert ours.factor is None
    assert ours.why_not == "k_y is of another history than the motion as the shaking comes on last"


def test_no_jump_is_claimed_where_none_was_seen(monkeypatch) -> None:
    """A path in the load that ends where the factor, put back, stays above the target: the other history, W477."""
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: AtLoad(0.2, "slides", None))
    found = sk.solve(with_values(_slab(), {"strength.joint.phi": 75.0, "loads.seismic.toward": 90.0}), KEY, fos=1.0)
    (said,) = found.warnings
    assert said.code == "W477"
    assert "which is given; with the strength divided last their factor there is" in said.message
    assert "none below 1 was seen" in said.message


def test_a_snap_on_the_way_is_no_limit() -> None:
    """A bench that snaps to another rest at k 0.2763 is at its limit at 0.2767, by either history."""
    changes = {"slope.height": 7, "slope.length": 12, "slope.face": "75/180", "sets.S2.spacing": 3}
    found = sk.solve(sk.load(path_of("bench"), set=changes), KEY, fos=1.0)
    assert found.answer.load_last == (found.answer.value, None)
    assert found.answer.value == pytest.approx(0.276668, rel=1e-5)
    assert found.answer.factor == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("target", [1.0, 1.3])
@pytest.mark.parametrize("law", [{"law": "power", "a": 2.0, "b": 0.8},
                                 {"law": "barton-bandis", "jrc": 8, "jcs": "50 MPa", "phi_r": 28}])  # fmt: skip
def test_curved_strength_is_that_of_the_tractions_under_the_load(law, target) -> None:
    """Two blocks of other heights on a plane: put back, the factor is the target; a power of 1 is a friction angle."""
    assert _yield_of(law, target) == pytest.approx(target, rel=1e-9)


def test_a_power_of_one_is_a_friction_angle() -> None:
    design = _two({"law": "power", "a": math.tan(PHI), "b": 1.0})
    at = kind_of(design).at_load(*(with_values(design, {KEY: k}) for k in (0.0, 1.0)), 1.0)
    assert at.multiplier == pytest.approx(YIELD, rel=1e-9)


def _two(law: dict):
    """Two blocks, 1 m and 3 m high, one behind the other on a plane that dips west by 20°."""
    along, up = (math.cos(DIP), math.sin(DIP)), (-math.sin(DIP), math.cos(DIP))
    boxes = [[(a, 0), (b, 0), (b, high), (a, high)] for a, b, high in ((10, 14, 1), (14, 20, 3))]
    at = [[[t * along[0] + n * up[0], t * along[1] + n * up[1]] for t, n in box] for box in boxes]
    base = [[0, 0], [40 * along[0], 40 * along[1]], [40 * along[0], -5], [0, -5]]
    return sk.load({
        "slopekit": 1, "kind": "blocks", "rock": {"unit_weight": 25},
        "blocks": {"base": {"polygon": base, "fixed": True}, "B1": {"polygon": at[0]}, "B2": {"polygon": at[1]}},
        "strength": {"joint": law}, "loads": {"seismic": {"k": 0, "toward": 270}},
    })  # fmt: skip


def _yield_of(law: dict, target: float) -> float:
    """The factor at the load that the path in it finds."""
    design = _two(law)
    at = kind_of(design).at_load(*(with_values(design, {KEY: k}) for k in (0.0, 1.0)), target)
    return sk.run(with_values(design, {KEY: at.multiplier})).fos.limit


def test_the_benchmark_takes_the_way_of_solve() -> None:
    """`python -m benchmarks.blocks multipliers`: the column's 1/2, and no number where no load moves it."""
    assert multiplier(_column(0.0), _column(1.0))[:2] == (pytest.approx(0.5, rel=1e-9), "topples")
    assert multiplier(_column(0.0), _column(0.0))[:2] == (None, "none")


def _column(k: float) -> dict:
    return COLUMN | {"loads": {"seismic": {"k": k, "toward": "090"}}}


def _cut_short(_: object) -> None:
    """The path in the load, which uses up the work that it may take."""
    with suppress(work_limit.WorkSpentError):
        work_limit.spend(0.6 * work_limit.MOST)  # a half is for the path


@pytest.mark.parametrize("lower", [False, True])
def test_a_history_cut_short_is_said_not_to_be_compared(monkeypatch, lower) -> None:
    """W477: the value is right, but only one of the two histories was followed to its end."""
    monkeypatch.setattr(by_factor, "_path_in_load", _cut_short)
    found = by_factor.for_factor(_slab(), KEY, 1.0, None, ALONE, lambda _: None, lower=lower)
    assert found.answer.value == pytest.approx(YIELD, rel=2e-6)
    (said,) = found.warnings
    assert said.code == "W477"
    assert "the work for the load coming on last was done" in said.message
    assert found.to_dict()["pre_ie"]["roots"][0]["not_compared"] in said.message


def test_a_factor_that_was_not_found_is_said_not_to_be_compared(monkeypatch) -> None:
    """The path in the load has its limit state; its factor with the strength divided last would take too much."""
    monkeypatch.setattr(by_factor, "_PUT_BACK", 1.0)
    found = sk.solve(_slab(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(YIELD, rel=1e-9)
    assert [notice.code for notice in found.warnings] == ["W477", "W360"]
    assert "their factor with the strength divided last" in found.warnings[0].message


def test_an_earthquake_says_that_histories_were_not_compared(monkeypatch) -> None:
    """W477 on the sheet of `quake`, and none where both histories have ended."""
    records = "sine:0.5g,1Hz"
    assert "W477" not in str(sk.quake(_slab(), records))
    monkeypatch.setattr(by_factor, "_path_in_load", _cut_short)
    found = sk.quake(_slab(), records)
    assert "W477 the order of loads was not compared" in str(found)
    assert found.to_dict()["yield"][0]["not_compared"]


def test_a_path_that_ends_beyond_the_range_is_said(monkeypatch) -> None:
    """Blocks that lock, and fail at k 6.2 only: no value up to 2 gives the target, and why is said (W302)."""
    monkeypatch.setattr(by_factor, "_path_in_load", lambda _: AtLoad(6.2, "slides_up", None))
    locked = with_values(_slab(), {"loads.seismic.toward": 90.0, "strength.joint.phi": 75.0})
    found = sk.solve(locked, KEY, fos=1.0)
    assert found.answer is None
    assert found.reason.code == "E315"
    assert [notice.code for notice in found.warnings] == ["W302"]
    assert "fail at k 6.2 only" in found.warnings[0].message
    assert found.to_dict()["load_last_beyond"] == 6.2
    shaken = sk.quake(locked, "sine:3g,1Hz")
    assert [notice.code for notice in shaken.warnings] == ["W462", "W302"]


@pytest.mark.parametrize(("height", "said"), [(0.995, True), (1.005, False)])
def test_a_coefficient_beyond_any_earthquake_is_said(height, said) -> None:
    """A block 1 m wide tips at 1 / height: more than 1 g is no earthquake's."""
    blocks = COLUMN["blocks"] | {"B1": {"polygon": [[0, 0], [1, 0], [1, height], [0, height]]}}
    flat = sk.load(COLUMN | {"blocks": blocks})
    found = sk.solve(flat, KEY, fos=1.0)
    assert found.answer.value == pytest.approx(1.0 / height, rel=1e-9)
    assert ("W302" in [notice.code for notice in found.warnings]) == said
    assert ("W302" in str(sk.quake(flat, "sine:1g,1Hz"))) == said


# -- cohesion ---------------------------------------------------------------------------------------------------------


def _bonded(height: float, phi: float):
    """A block 1 m wide with cohesion on level ground."""
    blocks = COLUMN["blocks"] | {"B1": {"polygon": [[0, 0], [1, 0], [1, height], [0, height]]}}
    return sk.load(COLUMN | {"blocks": blocks, "strength": {"joint": {"c": 5, "phi": phi}}})


def test_a_load_on_a_cohesive_block_says_what_it_has_to_do_with_cohesion() -> None:
    """W307 in the load's own terms, on the sheet of `solve` and of `quake`: contacts that it opens lose their bonds.

    2 m high it tips at k = 1/2 about its toe, where all of its base is open but the edge.
    """
    found = sk.solve(_bonded(2.0, 60.0), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(0.5, rel=1e-9)
    (said,) = [notice.message for notice in found.warnings if notice.code == "W307"]
    assert "1 of 1 contacts with cohesion are open or partly open" in said
    assert said.endswith("100 % of the cohesion does not act")
    shaken = sk.quake(with_values(_bonded(2.0, 60.0), {KEY: 0.0}), "sine:0.5g,1Hz")
    (of_load,) = [notice.message for notice in shaken.warnings if notice.code == "W307"]
    assert "in the state that gives the load, and carry none there" in of_load
    assert "notes" not in shaken.to_dict()["yield"][0]


def test_a_load_that_is_not_limited_by_its_own_path_says_what_the_factor_there_does() -> None:
    """Its strength divided last has the value (W477), and what the design there says of its cohesion.

    1 m high it slides on the pressed part of its base, a share of 3 (1 - k) / 2: k = tan φ + (c b / W) 3 (1 - k) / 2,
    with three pairs of nodes to 1e-3. With the load last it holds 2 % more.
    """
    design, alone = _bonded(1.0, 30.0), math.tan(math.radians(30.0))
    found = sk.solve(design, KEY, fos=1.0)
    assert found.answer.value == pytest.approx((alone + 0.3) / 1.3, rel=1e-3)
    there = sk.run(with_values(design, {KEY: found.answer.value}))
    at = f"of the factor of safety at {KEY} = {found.answer.value:.4g}: "  # a factor there is no coefficient
    of_bonds = [at + notice.message for notice in there.warnings if notice.code in ("W307",)]
    assert of_bonds
    said = [notice.message for notice in found.warnings]
    assert "W477" in [notice.code for notice in found.warnings]
    assert [message for message in said if message in of_bonds] == of_bonds


def test_what_is_said_of_the_factor_at_a_load_never_reads_as_a_load() -> None:
    """Whatever the factor there has to do with cohesion, of the path in strength and of finer node pairs as well."""
    notes = tuple(lost_cohesion_notices((0.2, 1, 2), "factor of safety"))
    assert {notice.code for notice in notes} == {"W307"}
    point = Point(Factors("slides", 1.5, None, math.inf, None, None, False, True, notes=notes))
    for key, at in ((KEY, f"of the factor of safety at {KEY} = 0.2: "), ("strength.joint.phi", "")):
        shown = SimpleNamespace(path=key, shown=lambda value, _: f"{value:g}")
        asked = factor_request.FactorRequest(None, shown, 0.0, 1.0, 1.5, ALONE, lambda _: None)
        said = [notice.message for notice in factor_request.said_of_factor(asked, 0.2, point)]
        assert said == [at + notice.message for notice in notes]


def test_notes_of_a_point_go_through_a_journal_and_may_be_left_out() -> None:
    notes = (Notice("W307", "cohesion lost"), Notice("W317", "not settled"))
    point = Point(Factors("slides", 1.5, None, math.inf, None, None, False, True, notes=notes))
    assert Point.from_record(json.loads(json.dumps(point.to_record()))) == point
    assert Point.from_record(point.to_record()[:-1]) == Point(replace(point.factors, notes=()))
    assert point.to_dict().keys() == Point(None, "E1", "").to_dict().keys()


def test_from_both_ends_of_a_load_it_is_looked_for_where_they_point_and_not_half_way() -> None:
    """Half way up to a load there may be no factor (the template bench at k 0.13): seconds for each place beside it.

    The level falls in a straight line from 0.1 to -0.01, so that its root is known.
    """
    asked: list[float] = []

    def sample(places):
        asked.extend(places)
        return [Sample(x, None if 0.4 < x < 0.6 else 0.1 - 0.11 * x, "", Point(None)) for x in places]

    search = RootSearch(sample, 1.0, resolution=1e-7, near=4e-7)
    one, other = search.add([0.0, 1.0])
    by_factor._close_in(search, one, other)
    (crossing,) = factor_request.crossings_of(search)
    assert (crossing.how, round(crossing.best.at, 6)) == ("root", round(0.1 / 0.11, 6))
    assert len(asked) <= 4
    assert not any(0.4 < place < 0.6 for place in asked)
