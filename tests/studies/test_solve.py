"""The value that gives a target: put back, by both methods; jumps, gaps, several values, none."""

import json
import math
import sys
from dataclasses import replace
from functools import cache
from types import ModuleType

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from slopekit.kinds import factors_of
from slopekit.studies.points import factor_at
from slopekit.studies.running import run_all
from slopekit.studies.solve import factor_request, solve
from slopekit.studies.solve.factor_request import level_of
from slopekit.studies.solve.solutions import notices
from tests.studies.wedge_oracle import wedge_factor
from tests.support import result_of

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": 64.89},
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    "strength": {"weak": {"c": 50, "phi": 20}},
    "rock": {"density": 2600},
    "support": {"bolts": ["200 kN@000/-05"]},
}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12},
    "joints": {"J1": {"plane": "35/180"}},
    "crack": {"depth": 4.35, "water": 3},
    "strength": {"bed": {"c": 25, "phi": 37}},
    "rock": {"unit_weight": 26},
}
#: cases.json, 9_single-plane: slides on J1 alone, where moments govern
ONE_PLANE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/180", "upper": "0/180", "height": 10},
    "joints": {
        "J1": {"plane": "45/160", "strength": "a"},
        "J2": {"plane": "80/240", "strength": "b"},
    },
    "strength": {"a": {"c": 20, "phi": 30}, "b": {"c": 20, "phi": 30}},
    "rock": {"unit_weight": 26},
}


DESIGNS = {
    "wedge": WEDGE,
    "bare": {**WEDGE, "support": {"bolts": []}},
    "plane": PLANE,
    "one plane": ONE_PLANE,
}


@cache
def solved(name: str, key: str, target: float):
    """A solution that several tests look at."""
    return solve(sk.load(DESIGNS[name]), key, fos=target)


def put_back(design: dict, key: str, found, target: float, again: float = 1e-6) -> None:
    """Both methods at their own roots, and the design loaded with the value: not the solver's own evaluations."""
    closed, pre_ie = found.closed_form.roots[0], found.pre_ie.roots[0]
    assert abs(closed.factor - target) <= 1e-9
    assert abs(pre_ie.factor - target) <= 1e-6
    value = found.to_dict()["value"]
    assert abs(factors_of(sk.load(design, {key: value})).limit - target) <= again
    assert (
        abs(factors_of(sk.load(design, {key: closed.value}), pre_ie=False).closed_form - target)
        <= 1e-9
    )
    (a, at_a), (b, at_b) = pre_ie.bracket
    assert a <= pre_ie.value <= b
    assert min(at_a, at_b) - 1e-6 <= target <= max(at_a, at_b) + 1e-6


@pytest.mark.parametrize("key", ["water.fill", "slope.face.dip", "loads.seismic.k"])
def test_values_on_arrays_are_those_of_designs_one_by_one(key, monkeypatch) -> None:
    """Of the same wedge; and where arrays have another factor, designs of their own are asked at once."""
    arrays = factor_request.points_on_arrays

    def off(*given):
        return [
            one and replace(one, factors=one.factors and replace(one.factors, limit=2.0))
            for one in arrays(*given)
        ]

    found = [solved("bare", key, 1.5)]
    monkeypatch.setattr(factor_request, "points_on_arrays", off)
    found.append(solve(sk.load(DESIGNS["bare"]), key, fos=1.5))
    monkeypatch.setattr(factor_request.FactorRequest, "on_arrays", None)
    found.append(solve(sk.load(DESIGNS["bare"]), key, fos=1.5))
    for roots in zip(*(one.pre_ie.roots for one in found), strict=True):
        assert [root.value for root in roots[1:]] == pytest.approx([roots[0].value] * 2, rel=1e-9)
    assert len(found[0].pre_ie.roots) == 1


@pytest.mark.parametrize("key", ["rock.unit_weight", "strength.weak.phi", "loads.seismic.k"])
def test_a_crack_is_looked_for_at_all_values_at_once(key, monkeypatch) -> None:
    """The values of designs that are each loaded with their worst crack, none of which the grid asks for."""
    cracked = {**WEDGE, "support": {"bolts": []}, "crack": {"plane": "80/180", "distance": "worst"}}
    design, single = sk.load(cracked), list[object]()
    target = 0.97 * sk.run(cracked).fos.limit

    def counted(work, tasks, *given, **more):
        single.extend(tasks)
        return run_all(work, tasks, *given, **more)

    monkeypatch.setattr(factor_request, "run_all", counted)
    found = solve(design, key, fos=target)
    assert len(single) < 10
    assert factors_of(sk.load(cracked, {key: found.answer.value})).limit == pytest.approx(
        target, rel=1e-6
    )
    monkeypatch.setattr(factor_request.FactorRequest, "on_arrays", None)
    assert solve(design, key, fos=target).answer.value == pytest.approx(
        found.answer.value, rel=1e-6
    )


OF_A_WEDGE = [
    ("strength.weak.phi", 1.3),
    ("water.fill", 1.2),
    ("loads.seismic.k", 1.2),
    ("support.bolts.0.force", 2.0),
    ("rock.density", 1.7),
    ("joints.J1.plane.dip", 1.7),
]


@pytest.mark.parametrize(("key", "target"), OF_A_WEDGE)
def test_a_wedge(key, target) -> None:
    found = solved("wedge", key, target)
    put_back(WEDGE, key, found, target)
    assert sk.run(WEDGE, set={key: found.answer.value}).fos.limit == pytest.approx(target, abs=1e-6)
    assert found.exit_code == 0
    assert found.agree
    assert found.moments_govern == (key == "water.fill")  # uplift opens the joints
    assert found.seconds < 30.0  # 0.3 to 0.6 s on a free core


@pytest.mark.parametrize(
    ("key", "target"),
    [("strength.weak.phi", 1.3), ("slope.face.dip", 1.5)],
)
def test_a_wedge_against_corner_points_and_vectors(key, target) -> None:
    """tests/studies/wedge_oracle.py, which shares no line with slopekit."""
    value = solved("bare", key, target).answer.value
    given = {
        "strength.weak.phi": 20,
        "strength.weak.c": 50,
        "slope.height": 64.89,
        "slope.face.dip": 60,
    } | {key: value}
    oracle = wedge_factor(
        ((45, 115), (45, 245)),
        (given["slope.face.dip"], 180),
        (10, 180),
        given["slope.height"],
        (given["strength.weak.c"],) * 2,
        (given["strength.weak.phi"],) * 2,
        2600 * 9.81e-3,
    )
    assert oracle["factor"] == pytest.approx(target, abs=1e-9)


def by_hand() -> dict[str, float]:
    """Wyllie & Mah (2004), eq. 6.1 to 6.8, of PLANE: forces per metre along and square to the plane, its length."""
    face, plane = math.radians(60.0), math.radians(35.0)
    crest = 12.0 / math.tan(face)
    back = crest + (12.0 * (1.0 - math.tan(plane) / math.tan(face)) - 4.35) / math.tan(plane)
    corners = [(0.0, 0.0), (crest, 12.0), (back, 12.0), (back, back * math.tan(plane))]
    area = 0.5 * abs(
        sum(
            x * v - u * y for (x, y), (u, v) in zip(corners, corners[1:] + corners[:1], strict=True)
        )
    )
    weight, length = 26.0 * area, back / math.cos(plane)
    uplift, thrust = 9.81 * 3.0 / 2.0 * length, 9.81 * 9.0 / 2.0
    return {
        "length": length,
        "weight": weight,
        "plane": plane,
        "normal": weight * math.cos(plane) - uplift - thrust * math.sin(plane),
        "driving": weight * math.sin(plane) + thrust * math.cos(plane),
    }


@pytest.mark.slow
@pytest.mark.parametrize("target", [1.1, 1.5])
def test_a_plane_against_exact_expressions(target) -> None:
    """F = (c L + N tan φ) / D is linear in c and tan φ; a bolt up the plane takes from D (active) or adds to R."""
    hand, rough = by_hand(), math.tan(math.radians(37.0))
    resisting = 25.0 * hand["length"] + hand["normal"] * rough
    plane = hand["plane"]
    k = (resisting - target * hand["driving"]) / (
        hand["weight"] * (target * math.cos(plane) + math.sin(plane) * rough)
    )  # from c L + (N - k W sin ψ) tan φ = F (D + k W cos ψ)
    exact = {}
    if target < 1.2466:
        exact["strength.bed.c"] = (target * hand["driving"] - hand["normal"] * rough) / hand[
            "length"
        ]
        exact["loads.seismic.k"] = k
    else:
        steep = (target * hand["driving"] - 25.0 * hand["length"]) / hand["normal"]
        exact["strength.bed.phi"] = math.degrees(math.atan(steep))
        exact["active"] = hand["driving"] - resisting / target
        exact["passive"] = target * hand["driving"] - resisting
    for key, value in exact.items():
        design, path = PLANE, key
        if key in ("active", "passive"):
            design = PLANE | {
                "support": {"bolts": [{"force": 50, "toward": "000/-35", "acts": key}]}
            }
            path = "support.bolts.0.force"
        within = (10, 1000) if path != key else (0, 0.5) if path == "loads.seismic.k" else (5, 80)
        found = solve(sk.load(design), path, fos=target, within=within)
        put_back(design, path, found, target)
        assert found.answer.value == pytest.approx(value, rel=1e-11)
        assert found.closed_form.roots[0].value == pytest.approx(value, rel=1e-11)


def test_a_plane_put_back() -> None:
    key = "joints.J1.plane.dip"
    put_back(PLANE, key, solve(sk.load(PLANE), key, fos=1.5), 1.5)


def test_a_footing_and_a_range_with_units() -> None:
    """Without weight F = (c L + P cos β tan φ) / (P sin β): linear in c."""
    footing = {
        "slopekit": 1,
        "kind": "footing",
        "footing": {"load": 1500, "at": "middle"},
        "weak_plane": {"dip": 45, "length": 5.0 * math.sqrt(2.0)},
        "strength": {"seam": {"c": 200, "phi": 0}},
    }
    found = solve(sk.load(footing), "strength.seam.c=0.1MPa:0.4MPa", fos=1.5)
    assert found.within == (100.0, 400.0)
    assert found.answer.value == pytest.approx(
        1.5 * 1500 * math.sin(math.pi / 4) / (5 * math.sqrt(2.0)), rel=1e-12
    )
    put_back(footing, "strength.seam.c", found, 1.5)


def test_where_moments_govern_both_values_are_given() -> None:
    """Each method at its own root; the notice says which to use."""
    found = solved("one plane", "strength.a.phi", 1.5)
    put_back(ONE_PLANE, "strength.a.phi", found, 1.5)
    assert found.moments_govern
    assert found.answer.value != pytest.approx(found.closed_form.roots[0].value, rel=1e-3)
    assert [notice.code for notice in found.warnings] == ["W353"]
    assert f"use {found.key.value_text(found.answer.value)}" in found.warnings[0].message
    assert "moments govern" in str(found)


def test_several_values_are_all_given_the_nearest_first() -> None:
    """A bolt that holds, and one so strong that it pushes the wedge uphill: two roots of the same target."""
    found = solved("wedge", "support.bolts.0.force", 2.0)
    assert [root.status for root in found.pre_ie.roots] == ["slides_on_both", "slides_up"]
    assert [root.rises for root in found.pre_ie.roots] == [True, False]
    for root, own in zip(found.pre_ie.roots, found.closed_form.roots, strict=True):
        assert root.value == pytest.approx(own.value, rel=1e-9)
        assert abs(sk.run(WEDGE, set={"support.bolts.0.force": root.value}).fos.limit - 2.0) <= 1e-6
    assert [notice.code for notice in found.warnings] == ["W311", "W356"]
    far = solve(
        sk.load(WEDGE | {"support": {"bolts": ["4e6 kN@000/-05"]}}),
        "support.bolts.0.force",
        fos=2.0,
    )
    assert far.answer.status == "slides_up"


def test_directions_are_looked_for_all_round(monkeypatch) -> None:
    """North is no end: the scene turned by 180° has its roots turned by 180°.

    By the closed form, which answers for PRE-IE too: both are looked for in the same way.
    """
    own = factor_request.FactorRequest.samples

    def samples(self, _, values):
        found = own(self, "closed_form", values)
        self.points.update({one.place: one.evaluation for one in found})
        return found

    monkeypatch.setattr(factor_request.FactorRequest, "samples", samples)
    bare = {**WEDGE, "support": {"bolts": []}}
    turned = {
        **bare,
        "slope": {"face": "60/000", "upper": "10/000", "height": 64.89},
        "joints": {"J1": {"plane": "45/295"}, "J2": {"plane": "45/065"}},
    }
    one, other = (
        solve(sk.load(given), "slope.face.dip_direction", fos=1.5) for given in (bare, turned)
    )
    values = [[root.value % 360.0 for root in found.closed_form.roots] for found in (one, other)]
    assert len(values[0]) == len(values[1]) >= 1
    assert sorted(
        value - 180.0 if value > 180.0 else value + 180.0 for value in values[1]
    ) == pytest.approx(sorted(values[0]), rel=1e-9)
    assert 0.0 <= other.to_dict()["value"] < 360.0


# -- none -------------------------------------------------------------------------------------------------------------

#: J2 carries nothing.
UNLOADED = ONE_PLANE | {
    "joints": {
        "J1": {"plane": "40/160", "strength": "a"},
        "J2": {"plane": "80/220", "strength": "b"},
    },
    "strength": {"a": {"c": 0, "phi": 40}, "b": {"c": 0, "phi": 40}},
}
REASONS = [
    ("E315", WEDGE, "water.fill", 0.9, "the factor is at least 1.006"),
    ("E315", WEDGE, "slope.height=60:70", 1.9, "at most 1.59"),
    (
        "E316",
        WEDGE | {"strength": {"weak": {"c": 0, "phi": 20}}, "support": {"bolts": []}},
        "rock.density",
        1.2,
        "does not depend on rock.density: it is 1.12188",
    ),
    ("E316", UNLOADED, "strength.b.phi", 1.2, "does not depend on strength.b.phi"),
    ("E316", WEDGE, "strength.weak.tension", 2.0, "does not depend on"),
    (
        "E318",
        WEDGE,
        "slope.face.dip=5:15",
        2.0,
        "E203 the line plunges 22.9°, steeper than the face",
    ),
    ("E319", WEDGE, "strength.weak.phi", 0.47, "where the input is refused: E113"),
]


@pytest.mark.parametrize(
    ("code", "given", "key", "target", "says"), REASONS, ids=lambda value: str(value)[:30]
)
def test_where_there_is_none_the_reason_is_given(code, given, key, target, says) -> None:
    found = solve(sk.load(given), key, fos=target)
    assert found.answer is None
    assert found.exit_code == 1
    assert found.reason.code == code
    assert says in found.reason.message
    assert says.split()[0] in str(found)
    assert found.line.startswith(f"none  {code}")
    if code == "E315":
        least, most = found.pre_ie.least, found.pre_ie.most
        path = found.key.path
        assert sk.run(given, set={path: least[0]}).fos.limit == pytest.approx(least[1], rel=1e-9)
        assert sk.run(given, set={path: most[0]}).fos.limit == pytest.approx(most[1], rel=1e-9)
        assert not least[1] <= target <= most[1]


def test_a_jump_is_no_root() -> None:
    """Water on J1 until it loses contact: by forces its cohesion goes with it, on its bed J1 opens little by little."""
    design = sk.load(WEDGE | {"support": {"bolts": []}})
    found = solve(design, "water.pressures.J1", fos=0.9)
    (jump,) = found.closed_form.others
    (a, below), (b, above) = jump.bracket
    assert b - a < 1e-12 * b
    assert below > 0.99 > 0.78 > above
    for value, factor in jump.bracket:
        again = sk.run(design.source.root.plain(), set={"water.pressures.J1": value}).fos
        assert again.closed_form == pytest.approx(factor, rel=1e-9)
    assert found.answer.status == "rotates"
    opened = sk.run(design.source.root.plain(), set={"water.pressures.J1": found.answer.value})
    assert opened.fos.limit == pytest.approx(0.9, abs=1e-6)


#: J1 loses contact at 10.307 kPa: F by forces falls from 2.518 to 1.614, on the bed from 1.851 to 1.75
LOSES_CONTACT = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "59/180", "upper": "0/180", "height": 20},
    "joints": {
        "J1": {"plane": "78/119", "strength": "a"},
        "J2": {"plane": "62/239", "strength": "b"},
    },
    "strength": {"a": {"c": 18, "phi": 42}, "b": {"c": 19, "phi": 35}},
    "rock": {"unit_weight": 26},
}


def test_a_jump_of_both_is_no_root() -> None:
    """Just before J1 loses contact the bed is the lower, just after it the forces without its cohesion."""
    found = solve(sk.load(LOSES_CONTACT), "water.pressures.J1", fos=1.7)
    assert found.answer is None
    assert found.reason.code == "E317"
    (jump,) = found.pre_ie.others
    for value, factor in jump.bracket:
        again = sk.run(LOSES_CONTACT, set={"water.pressures.J1": value}).fos.limit
        assert again == pytest.approx(factor, rel=1e-6)
    assert max(factor for _, factor in jump.bracket) > 1.8
    assert "jump" in str(found)


def test_a_jump_beside_a_root_is_told() -> None:
    """A root, and further on a jump across the same target: the slope is on the other side of it there."""
    found = solved("wedge", "strength.weak.c", 1.3)
    for how, says in (
        ("jump", "also jumps across 1.3 at 70 kPa: 1.4 below, 1.1 above"),
        ("gap", "also passes (where there is no factor) 1.3"),
    ):
        other = replace(found.answer, how=how, value=70.0, bracket=((70.0, 1.4), (70.1, 1.1)))
        with_jump = replace(found, pre_ie=replace(found.pre_ie, others=(other,)))
        (notice,) = (one for one in notices(with_jump) if one not in found.warnings)
        assert notice.code == "W356"
        assert says in notice.message


def test_roots_at_the_edge_of_validity_are_found() -> None:
    """Down to where the line no longer daylights F grows beyond all bounds: any target is met, ever nearer to it."""
    design = sk.load(WEDGE | {"support": {"bolts": []}})
    found = solve(design, "slope.face.dip", fos=1e4)
    assert abs(found.closed_form.roots[0].factor / 1e4 - 1.0) < 1e-9
    assert 0.0 < found.answer.value - 22.909807 < 0.5
    steep = solve(
        design, "slope.face.dip", fos=1e6
    )  # neighbouring floats miss it: said, not hidden
    assert [notice.code for notice in steep.warnings] == ["W356", "W356"]
    edges = [(high, code) for _, high, code, _ in steep.closed_form.refused]
    assert edges[-1] == (pytest.approx(22.909807125, abs=1e-8), "E203")


def test_water_that_its_crack_does_not_hold_is_no_missing_block() -> None:
    (refused,) = solve(sk.load(path_of("plane")), "crack.water", fos=1.0).closed_form.refused
    assert refused[0] == pytest.approx(4.35, rel=1e-6)
    assert refused[2:] == ("E207", "the crack or its water does not fit the block")


# -- kinds without a quick closed form --------------------------------------------------------------------------------


def test_a_sphere_by_pre_ie_alone() -> None:
    """φ = 0: F is proportional to c (Hungr, Salgado & Byrne 1989: 1.4016 at 20 kPa)."""
    found = solve(sk.load(path_of("sphere")), "strength.clay.c=10:40", fos=1.5)
    assert found.closed_form is None
    assert abs(found.answer.factor - 1.5) <= 1e-6
    assert found.answer.value == pytest.approx(20.0 * 1.5 / result_of("sphere").fos.limit, rel=1e-6)
    assert found.pre_ie.evaluations < 20
    assert "PRE-IE" in str(found)


# -- the target, the key ----------------------------------------------------------------------------------------------


def test_the_target_may_be_the_acceptance_rule() -> None:
    found = solve(
        sk.load(WEDGE | {"acceptance": {"rules": ["fos >= 1.4", "fos >= 1.3"]}}), "strength.weak.c"
    )
    assert (found.target, found.from_acceptance) == (1.4, True)


@pytest.mark.parametrize(
    ("key", "options", "code"),
    [
        ("strength.weak.c", {}, "E314"),
        ("strength.weak.c", {"fos": 0.0}, "E314"),
        ("strength.weak.c", {"fos": math.nan}, "E314"),
        ("strength.weak.c", {"fos": math.inf}, "E314"),
        ("analysis.refine", {"fos": 1.2}, "E311"),
        ("strength.weak", {"fos": 1.2}, "E311"),
        ("c", {"fos": 1.2}, "E310"),
        ("slope.height=1:2", {"fos": 1.2, "within": (1, 2)}, "E312"),
        ("slope.height=2:1", {"fos": 1.2}, "E312"),
    ],
)
def test_what_cannot_be_asked(key, options, code) -> None:
    with pytest.raises(DesignError) as caught:
        solve(sk.load(WEDGE), key, **options)
    assert caught.value.codes == (code,)


def test_levels_and_factors() -> None:
    assert [level_of(factor, 2.0) for factor in (0.0, 2.0, math.inf)] == [-1.0, 0.0, 1.0]
    found = solved("wedge", "support.bolts.0.force", 2.0)
    assert factor_at(found.before, "pre_ie") == pytest.approx(1.5575, abs=1e-3)


def test_json_is_strict_and_the_same_twice_but_for_times() -> None:
    again = solve(sk.load(WEDGE), "support.bolts.0.force", fos=2.0)
    first, second = solved("wedge", "support.bolts.0.force", 2.0).to_dict(), again.to_dict()
    assert json.loads(json.dumps(first, allow_nan=False)) == first
    for document in (first, second):
        del document["timing_s"]
    assert first == second
    assert first.keys() >= {
        "study",
        "key",
        "unit",
        "target",
        "before",
        "value",
        "closed_form",
        "pre_ie",
        "agree",
        "moments_govern",
        "reason",
        "warnings",
    }
    assert first["pre_ie"]["roots"][0]["put_back"]["limit"] == pytest.approx(2.0, abs=1e-6)
    infinite = solve(
        sk.load(WEDGE), "support.bolts.0.force", fos=1e6
    ).to_dict()  # past the force that nothing drives
    json.dumps(infinite, allow_nan=False)


def test_sheets_are_a_hundred_columns_wide() -> None:
    for key, target in (
        ("support.bolts.0.force", 2.0),
        ("slope.face.dip", 1.5),
        ("water.fill", 1.2),
    ):
        assert max(map(len, str(solved("wedge", key, target)).splitlines())) <= 100


def test_data_frames_need_pandas(monkeypatch) -> None:
    """The answer by each method is a row, the one that counts first."""
    found = solved("wedge", "strength.weak.c", 1.3)
    pandas = ModuleType("pandas")
    pandas.DataFrame = lambda records, columns: records
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    assert [row["method"] for row in found.to_frame()] == ["pre_ie", "closed_form"]
    assert found.to_frame()[0]["strength.weak.c"] == found.answer.value
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(DesignError) as caught:
        found.to_frame()
    assert caught.value.codes == ("E140",)
    assert repr(found) == f"<Solution: {found.line}>"


# -- the command ------------------------------------------------------------------------------------------------------


def command(monkeypatch, capsys, *arguments: str) -> tuple[int, str, str]:
    """Exit code, stdout, stderr of the command, in this process."""
    from slopekit.cli import main

    monkeypatch.setattr("sys.argv", ["slopekit", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    out = capsys.readouterr()
    return int(left.value.code or 0), out.out, out.err


WEDGE_FILE = str(path_of("wedge"))


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (("slope.face.dip", "--quiet"), 0, "72.99584753°  slides_on_both  1.500  agree"),
        (
            ("water.fill", "--fos", "0.9"),
            1,
            "none. E315 no value of water.fill from 0 to 1 gives 0.9",
        ),
        (
            ("phi", "--fos", "1.2"),
            2,
            "E310 phi is no number of this wedge design\n     Did you mean strength.weak.phi?",
        ),
        (("slope.face", "--fos", "1.2"), 2, "E311 slope.face is an orientation"),
        (
            ("slope.height=10:20ft", "--fos", "1.2"),
            2,
            "E312 slope.height: some values carry a unit",
        ),
        (("slope.height", "--fos", "none"), 2, "E106 --fos is 'none'"),
        (("slope.height", "--jobs", "0"), 2, "E313 --jobs is 0"),
    ],
)
def test_the_command(arguments, code, says, monkeypatch, capsys) -> None:
    left, out, err = command(monkeypatch, capsys, "solve", WEDGE_FILE, *arguments)
    assert left == code
    assert says in (out if code < 2 else err)


def test_the_command_writes_its_files(monkeypatch, capsys, tmp_path) -> None:
    code, out, _ = command(
        monkeypatch,
        capsys,
        "solve",
        WEDGE_FILE,
        "strength.weak.phi",
        "--fos",
        "1.3",
        "--json",
        "-o",
        str(tmp_path / "new"),
    )
    assert code == 0
    document = json.loads(out)
    assert document == json.loads((tmp_path / "new/solve.json").read_text())
    assert (tmp_path / "new/solve.txt").read_text().startswith("slopekit ")
    assert document["value"] == pytest.approx(15.66688463, abs=1e-7)
