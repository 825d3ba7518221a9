"""A load of many blocks straight from the path in it."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

import slopekit as sk
from benchmarks import populations
from benchmarks.blocks import multiplier
from slopekit.core.errors import Notice
from slopekit.design.reading.files import with_values
from slopekit.design.templates import path_of
from slopekit.kinds import kind_of
from slopekit.kinds.assemblies.many_blocks import ManyBlocks
from slopekit.kinds.protocol import Factors
from slopekit.notices import lost_cohesion_notices
from slopekit.studies.outcomes import Outcomes, outcomes_from_points
from slopekit.studies.points import Point
from slopekit.studies.running import ALONE, RowArrays
from slopekit.studies.solve import factor_request

COLUMN = {
    "slopekit": 1,
    "kind": "blocks",
    "blocks": {
        "base": {"polygon": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True},
        "B1": {"polygon": [[0, 0], [1, 0], [1, 2], [0, 2]]},
    },
    "strength": {"joint": {"c": 0, "phi": 60}},
    "rock": {"unit_weight": 25},
    "loads": {"seismic": {"k": 0.1, "toward": "090"}},
}


KEY = "loads.seismic.k"
DIP, PHI = math.radians(20.0), math.radians(35.0)
YIELD = math.tan(PHI - DIP)  # of a slab on a plane


def _slab():
    """A slab 20 m long and 1 m high on a plane that dips west by 20°."""
    along, up = (math.cos(DIP), math.sin(DIP)), (-math.sin(DIP), math.cos(DIP))
    at = [
        [t * along[0] + n * up[0], t * along[1] + n * up[1]]
        for t, n in ((10, 0), (30, 0), (30, 1), (10, 1))
    ]
    base = [[0, 0], [40 * along[0], 40 * along[1]], [40 * along[0], -5], [0, -5]]
    return sk.load(
        {
            "slopekit": 1,
            "kind": "blocks",
            "rock": {"unit_weight": 25},
            "blocks": {"base": {"polygon": base, "fixed": True}, "B1": {"polygon": at}},
            "strength": {"joint": {"c": 0, "phi": 35}},
            "loads": {"seismic": {"k": 0, "toward": 270}},
        }
    )


def test_a_column_tips_at_its_slenderness_and_what_it_holds_there_is_said() -> None:
    """1 m by 2 m tips at k = 1/2 whatever its friction: there it would slide at F = tan 60° / k, and jumps to none."""
    found = sk.solve(sk.load(COLUMN), KEY, fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(0.5, rel=1e-9)
    assert found.answer.how == "jump"
    assert found.answer.factor == pytest.approx(math.tan(math.radians(60.0)) / 0.5, rel=1e-9)
    assert [notice.code for notice in found.warnings] == ["W356"]
    assert "from 3.4641 to none (nothing holds it)" in str(found)


def test_both_ways_to_the_yield_of_a_slab_are_one() -> None:
    """k = tan(φ - β), by the path in the load, and its factor put back is the target: nothing is searched."""
    found = sk.solve(_slab(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(YIELD, rel=1e-9)
    assert found.answer.factor == pytest.approx(1.0, rel=1e-9)
    assert found.pre_ie.evaluations == 1
    assert found.warnings == ()


def path_ends(monkeypatch, at: float) -> None:
    """The path in a load of a design ends there, whatever its blocks do."""
    monkeypatch.setattr(ManyBlocks, "at_load", lambda *_: at)


@pytest.mark.parametrize("part", [0.8, 1.3])
def test_where_the_ways_differ_the_value_is_that_of_the_strength(monkeypatch, part) -> None:
    """Wherever the path in the load ended, k is where the factor is the target."""
    path_ends(monkeypatch, part * YIELD)
    found = sk.solve(_slab(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(YIELD, rel=2e-6)
    assert found.answer.factor == pytest.approx(1.0, rel=1e-6)
    assert found.pre_ie.evaluations <= 9
    assert found.warnings == ()


@pytest.mark.parametrize("part", [0.8, 1.3])
def test_a_force_is_looked_for_from_none_upwards(monkeypatch, part) -> None:
    """W (sin β + k cos β) with k W the force, which could also be negative and a million times as large."""
    pushed = with_values(
        _slab(), {"loads.forces": [{"force": "10 kN", "block": "B1", "toward": "270/0"}]}
    )
    weight = 20.0 * 25.0
    path_ends(monkeypatch, part * YIELD * weight)
    found = sk.solve(pushed, "loads.forces.0.force", fos=1.0)
    assert found.answer.value == pytest.approx(YIELD * weight, rel=2e-6)
    assert found.pre_ie.evaluations <= 9


def test_the_end_of_the_path_stands_where_no_factor_is_found_beyond_it(monkeypatch) -> None:
    """As for the published wall W3, refused with E319: 1.83 at its multiplier, not converged above, then none."""
    own = factor_request.FactorRequest.samples

    def samples(self, method, values):
        lost = {"level": None, "label": "not_converged"}
        return [
            replace(one, **lost) if 0.5 < one.place < 0.55 else one
            for one in own(self, method, values)
        ]

    monkeypatch.setattr(factor_request.FactorRequest, "samples", samples)
    found = sk.solve(sk.load(COLUMN), KEY, fos=1.0)
    assert found.answer is not None
    assert found.answer.value == pytest.approx(0.5, rel=1e-9)
    assert found.answer.factor == pytest.approx(math.tan(math.radians(60.0)) / 0.5, rel=1e-9)
    assert [notice.code for notice in found.warnings] == ["W356"]


def test_a_jump_beyond_the_end_of_the_path_is_found(monkeypatch) -> None:
    """The column that tips at 1/2, where the path in the load is said to end before."""
    path_ends(monkeypatch, 0.45)
    found = sk.solve(sk.load(COLUMN), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(0.5, rel=1e-4)
    assert found.answer.value <= 0.5
    assert [notice.code for notice in found.warnings] == ["W356"]


@pytest.mark.parametrize("number", [2, 4])
def test_a_load_is_found_on_node_pairs_as_fine_as_those_of_a_run(number) -> None:
    """Two benches whose contacts open in part at 2 kPa: at the load on the first node pairs a run says 1.023, 1.014."""
    design = populations.bench(number)
    design["strength"]["joint"]["c"] = 2.0
    still, shaken = (sk.load(design, set={KEY: k}) for k in (0.0, 1.0))
    at = kind_of(still).at_load(still, shaken, 1.0)
    assert sk.run(design, set={KEY: at}).fos.limit == pytest.approx(1.0, rel=1e-6)


def test_finer_node_pairs_do_not_rest_past_the_load_that_ends_a_motion() -> None:
    """Bench 20 at 2 kPa falls below 1 at k 0.1848, is above it once more from 0.25 to 0.26: the first is the answer."""
    design = populations.bench(20)
    design["strength"]["joint"]["c"] = 2.0
    at = sk.solve(sk.load(design, set={KEY: 0.0}), KEY, fos=1.0).answer.value
    before, after = (sk.run(design, set={KEY: by * at}).fos.limit for by in (0.99, 1.01))
    assert after < 1.0 < before
    assert at < 0.19
    assert sk.run(design, set={KEY: 0.19}).fos.limit < 1.0


@pytest.mark.slow
def test_blocks_that_fail_without_the_load_are_said_to_at_once() -> None:
    """Goodman & Bray's columns hold 0.99996 without an earthquake, though they rest elastically to k 0.018."""
    found = sk.solve(sk.load(path_of("goodman-bray")), KEY, fos=1.0)
    assert found.answer is None
    assert found.reason.code == "E315"
    assert "at most 0.999957, at 0 " in found.reason.message


@pytest.mark.slow
def test_a_snap_on_the_way_is_no_limit() -> None:
    """A bench that snaps to another rest at k 0.2763 is at its limit at 0.2767, by either history."""
    changes = {"slope.height": 7, "slope.length": 12, "slope.face": "75/180", "sets.S2.spacing": 3}
    found = sk.solve(sk.load(path_of("bench"), set=changes), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(0.276668, rel=1e-5)
    assert found.answer.factor == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("target", [1.0, 1.3])
@pytest.mark.parametrize(
    "law",
    [
        {"law": "power", "a": 2.0, "b": 0.8},
        {"law": "barton-bandis", "jrc": 8, "jcs": "50 MPa", "phi_r": 28},
    ],
)
def test_curved_strength_is_that_of_the_tractions_under_the_load(law, target) -> None:
    """Two blocks of other heights on a plane: put back, the factor is the target; a power of 1 is a friction angle."""
    assert _yield_of(law, target) == pytest.approx(target, rel=1e-9)


def test_a_power_of_one_is_a_friction_angle() -> None:
    design = _two({"law": "power", "a": math.tan(PHI), "b": 1.0})
    at = kind_of(design).at_load(*(with_values(design, {KEY: k}) for k in (0.0, 1.0)), 1.0)
    assert at == pytest.approx(YIELD, rel=1e-9)


def _two(law: dict):
    """Two blocks, 1 m and 3 m high, one behind the other on a plane that dips west by 20°."""
    along, up = (math.cos(DIP), math.sin(DIP)), (-math.sin(DIP), math.cos(DIP))
    boxes = [[(a, 0), (b, 0), (b, high), (a, high)] for a, b, high in ((10, 14, 1), (14, 20, 3))]
    at = [[[t * along[0] + n * up[0], t * along[1] + n * up[1]] for t, n in box] for box in boxes]
    base = [[0, 0], [40 * along[0], 40 * along[1]], [40 * along[0], -5], [0, -5]]
    return sk.load(
        {
            "slopekit": 1,
            "kind": "blocks",
            "rock": {"unit_weight": 25},
            "blocks": {
                "base": {"polygon": base, "fixed": True},
                "B1": {"polygon": at[0]},
                "B2": {"polygon": at[1]},
            },
            "strength": {"joint": law},
            "loads": {"seismic": {"k": 0, "toward": 270}},
        }
    )


def _yield_of(law: dict, target: float) -> float:
    """The factor at the load that the path in it finds."""
    design = _two(law)
    at = kind_of(design).at_load(*(with_values(design, {KEY: k}) for k in (0.0, 1.0)), target)
    return sk.run(with_values(design, {KEY: at})).fos.limit


def test_the_benchmark_takes_the_way_of_solve() -> None:
    """`python -m benchmarks.blocks multipliers`: the column's 1/2, and no number where no load moves it."""
    assert multiplier(_column(0.0), _column(1.0))[:2] == (pytest.approx(0.5, rel=1e-9), "found")
    assert multiplier(_column(0.0), _column(0.0))[:2] == (None, "none")


def _column(k: float) -> dict:
    return COLUMN | {"loads": {"seismic": {"k": k, "toward": "090"}}}


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


def _bonded():
    """A block of 1 m by 1 m with cohesion on level ground: its base opens before it slides, where k > 1/3.

    F = (c s b + W tan φ) / (k W) with the pressed share s = 3 (1 - k) / 2 of its base.
    """
    blocks = COLUMN["blocks"] | {"B1": {"polygon": [[0, 0], [1, 0], [1, 1], [0, 1]]}}
    return sk.load(COLUMN | {"blocks": blocks, "strength": {"joint": {"c": 5, "phi": 30}}})


#: k = tan φ + (c b / W) 3 (1 - k) / 2, and the share of the base that is open there.
BONDED = (math.tan(math.radians(30.0)) + 0.3) / 1.3
OPEN = 1.0 - 1.5 * (1.0 - BONDED)


def test_a_load_on_a_cohesive_block_says_what_it_has_to_do_with_cohesion() -> None:
    """W307 of the factor at the load, on the sheet of `solve` and of `quake`: contacts that open lose their bonds."""
    found = sk.solve(_bonded(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(BONDED, rel=5e-4)  # three pairs of nodes
    (said,) = [notice.message for notice in found.warnings if notice.code == "W307"]
    assert "1 of 1 contacts with cohesion are open or partly open" in said
    assert said.endswith(f"{100.0 * OPEN:.0f} % of the cohesion does not act")
    shaken = sk.quake(with_values(_bonded(), {KEY: 0.0}), "sine:0.5g,1Hz")
    (of_load,) = [notice.message for notice in shaken.warnings if notice.code == "W307"]
    assert "in the state that gives the factor of safety, and carry none there" in of_load
    assert "notes" not in shaken.to_dict()["yield"][0]


def test_a_load_that_is_not_limited_by_its_own_path_says_what_the_factor_there_does(
    monkeypatch,
) -> None:
    """Its strength divided last has the value, and what the design there says of its cohesion is said."""
    path_ends(monkeypatch, 0.9 * BONDED)
    found = sk.solve(_bonded(), KEY, fos=1.0)
    assert found.answer.value == pytest.approx(BONDED, rel=5e-4)
    there = sk.run(with_values(_bonded(), {KEY: found.answer.value}))
    at = f"of the factor of safety at {KEY} = {found.answer.value:.4g}: "  # a factor there is no coefficient
    of_bonds = [at + notice.message for notice in there.warnings if notice.code in ("W307",)]
    assert of_bonds
    said = [notice.message for notice in found.warnings]
    assert [message for message in said if message in of_bonds] == of_bonds


def test_what_is_said_of_the_factor_at_a_load_never_reads_as_a_load() -> None:
    """Whatever the factor there has to do with cohesion, of the path in strength and of finer node pairs as well."""
    notes = tuple(lost_cohesion_notices((0.2, 1, 2), "factor of safety"))
    assert {notice.code for notice in notes} == {"W307"}
    point = Point(Factors("slides", 1.5, None, math.inf, None, None, False, notes=notes))
    for key, at in ((KEY, f"of the factor of safety at {KEY} = 0.2: "), ("strength.joint.phi", "")):
        shown = SimpleNamespace(path=key, value_text=lambda value, _: f"{value:g}")
        asked = factor_request.FactorRequest(None, shown, 0.0, 1.0, 1.5, ALONE, lambda _: None)
        said = [notice.message for notice in factor_request.factor_notices(asked, 0.2, point)]
        assert said == [at + notice.message for notice in notes]


def test_notes_of_a_point_go_through_a_journal_and_may_be_left_out() -> None:
    notes = (Notice("W307", "cohesion lost"), Notice("W317", "not settled"))
    point = Point(Factors("slides", 1.5, None, math.inf, None, None, False, notes=notes))
    outcomes = outcomes_from_points([point], [None], True)
    columns = RowArrays([0, 1])
    columns[0] = outcomes.record()
    assert Outcomes.joined(columns, True).points == [point]
    assert Point.from_record(point.to_dict()) == Point(
        replace(point.factors, closed_form=None, notes=())
    )
    assert point.to_dict().keys() == Point(None, "E1", "").to_dict().keys()
