"""Partial factors: the design with every number factored by hand, the values of EN 1997-1:2004, Annex A."""

import json
import math

import pytest

import slopekit as sk
from slopekit.design.reading.files import load, with_values
from slopekit.design.templates import path_of
from slopekit.kinds import factors_of
from tests.commands import slopekit

H, DIP, FACE = 12.0, math.radians(35.0), math.radians(60.0)
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"bedding": {"c": 30, "phi": 37}},
    "rock": {"unit_weight": 26},
    "water": {"fill": "50 %"},
    "loads": {"surcharge": 20, "seismic": 0.05},
}
#: Tables A.3, A.4 and A.14: permanent and variable, unfavourable and favourable; tan φ and c; earth resistance.
ANNEX_A = {
    "DA1-C1": ((1.35, 1.0), (1.5, 0.0), 1.0, 1.0),
    "DA1-C2": ((1.0, 1.0), (1.3, 0.0), 1.25, 1.0),
    "DA2": ((1.35, 1.0), (1.5, 0.0), 1.0, 1.1),
    "DA3": ((1.0, 1.0), (1.3, 0.0), 1.25, 1.0),
}


def by_hand(
    on_weight=1.0, on_water=1.0, on_surcharge=1.0, on_strength=1.0, c=30.0, fill=0.5, k=0.05, q=20.0
) -> float:
    """Limit equilibrium of the plane: driving and resisting forces with their factors; the seismic one has none."""
    length, top = H / math.sin(DIP), H * (1.0 / math.tan(DIP) - 1.0 / math.tan(FACE))
    weight = 26.0 * H * top / 2.0
    down = on_weight * weight + on_surcharge * q * top
    uplift = on_water * 9.81 * H * fill / 4.0 * length
    normal = down * math.cos(DIP) - k * weight * math.sin(DIP) - uplift
    driving = down * math.sin(DIP) + k * weight * math.cos(DIP)
    return (c * length + normal * math.tan(math.radians(37.0))) / on_strength / driving


def asked(name, **more):
    return {**PLANE, **more, "analysis": {"partial_factors": name}}


@pytest.mark.parametrize("name", ANNEX_A)
def test_the_sets_of_eurocode_7(name) -> None:
    """Both methods against the formula, at the worst of favourable and unfavourable weight and surcharge."""
    permanent, variable, strength, resistance = ANNEX_A[name]
    worst = min(
        by_hand(weight, permanent[0], surcharge, strength * resistance)
        for weight in permanent
        for surcharge in variable
    )
    result = sk.run(asked(name))
    assert result.fos.closed_form == pytest.approx(worst, rel=1e-9)
    assert result.fos.limit == pytest.approx(worst, rel=1e-6)
    assert [str(rule) for rule in result.design.rules] == ["fos >= 1"]
    assert result.accepted is (worst >= 1.0)
    assert sk.run(asked(f"eurocode-7 {name.lower()}")).fos == result.fos


def test_weight_is_favourable_where_it_holds() -> None:
    """Without cohesion under full water more weight is safer: its favourable factor is taken."""
    given = {
        "strength": {"bedding": {"c": 0, "phi": 37}},
        "water": "full",
        "loads": {"surcharge": 20},
    }
    result = sk.run(asked("DA1-C1", **given))
    own = [
        by_hand(weight, 1.35, surcharge, c=0.0, fill=1.0, k=0.0)
        for weight in (1.35, 1.0)
        for surcharge in (1.5, 0.0)
    ]
    assert result.fos.closed_form == pytest.approx(min(own), rel=1e-9)
    assert min(own) == own[3]
    table = {row.what: row for row in result.design.analysis.partial.table}
    assert table["unit weight"].factor == 1.0
    assert table["surcharge, variable"].design == 0.0


def test_a_dry_slope_without_cohesion_has_1_25_of_combination_2() -> None:
    """tan φ / (1.25 tan ψ): the equivalent global factor that Bond & Harris give for Combination 2."""
    dry = {"strength": {"bedding": {"c": 0, "phi": 37}}, "water": "dry", "loads": {}}
    wanted = math.tan(math.radians(37.0)) / math.tan(DIP) / 1.25
    assert sk.run(asked("DA1-C2", **dry)).fos.closed_form == pytest.approx(wanted, rel=1e-12)
    assert sk.run(asked("DA1-C1", **dry)).fos.closed_form == pytest.approx(1.25 * wanted, rel=1e-12)


@pytest.mark.parametrize(("forces", "factor"), [("permanent", 1.35), ("variable", 1.5)])
def test_forces_are_permanent_or_variable(forces, factor) -> None:
    """A push out of the slope, by its design value in a design without factors on it."""
    push = {"loads": {"forces": ["100kN@180/00"]}, "water": "dry"}
    found = sk.run(
        {**PLANE, **push, "analysis": {"partial_factors": {"set": "DA1-C1", "forces": forces}}}
    )
    plain = {"forces": [f"{100 * factor}kN@180/00"]}
    alone = sk.run({**PLANE, "water": "dry", "loads": plain, "rock": {"unit_weight": 26 * 1.35}})
    assert found.fos.closed_form == pytest.approx(alone.fos.closed_form, rel=1e-9)


def test_a_wedge_with_a_curved_strength_is_divided_as_a_whole() -> None:
    """τ / 1.25 on every joint divides the factor by 1.25, of the closed form and of PRE-IE."""
    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        "strength": {"rough": {"law": "barton-bandis", "jrc": 8, "jcs": "50 MPa", "phi_r": 25}},
    }
    before, after = (
        factors_of(sk.load(one))
        for one in (wedge, {**wedge, "analysis": {"partial_factors": "DA3"}})
    )
    assert after.closed_form == pytest.approx(before.closed_form / 1.25, rel=1e-9)
    assert after.limit == pytest.approx(before.limit / 1.25, rel=1e-6)
    with pytest.raises(sk.DesignError) as error:
        sk.load({**wedge, "analysis": {"partial_factors": {"tan_phi": 1.25, "c": 1.6}}})
    assert error.value.codes == ("E112",)


def test_many_blocks_are_factored_too() -> None:
    """A block on a slope: tan φ / (1.25 tan 30°)."""
    block = {
        "slopekit": 1,
        "kind": "blocks",
        "rock": {"unit_weight": 25},
        "strength": {"s": {"c": 0, "phi": 35}},
        "blocks": {
            "base": {"polygon": [[0, 0], [10, 0], [10, 10 * math.tan(math.pi / 6)]], "fixed": True},
            "B1": {
                "polygon": [
                    [4, 4 * math.tan(math.pi / 6)],
                    [6, 6 * math.tan(math.pi / 6)],
                    [6 - 0.5, 6 * math.tan(math.pi / 6) + 0.5 * math.sqrt(3.0)],
                    [4 - 0.5, 4 * math.tan(math.pi / 6) + 0.5 * math.sqrt(3.0)],
                ],
                "unit_weight": 20,
            },
        },
        "analysis": {"partial_factors": {"set": "DA2", "tan_phi": 1.25}},
    }
    result = sk.run(block)
    wanted = math.tan(math.radians(35.0)) / math.tan(math.pi / 6) / 1.25 / 1.1
    assert result.fos.limit == pytest.approx(wanted, rel=1e-6)
    assert result.design.blocks[1].unit_weight_kn_m3 == pytest.approx(27.0)


@pytest.mark.parametrize(
    ("template", "water"),
    [
        ("bench", {"S1": "10 kPa"}),
        ("topple", {"base": "10 kPa"}),
        ("wedge", {"J1": "10 kPa"}),
        ("sphere", "10 kPa"),
    ],
)
def test_water_pressures_of_every_kind_are_multiplied(template, water) -> None:
    """Whatever records a kind keeps them in, what analyses see is what 13.5 kPa written into the design gives."""
    own = {"analysis.partial_factors": {"permanent_unfavourable": 1.35}}
    factored = load(path_of(template), [("water", {"pressures": water}), *own.items()])
    more = (
        str(water).replace("10", "13.5")
        if isinstance(water, str)
        else dict.fromkeys(water, "13.5 kPa")
    )
    by_hand = load(path_of(template), [("water", {"pressures": more})])
    assert pressures_in(factored) == pytest.approx(pressures_in(by_hand), rel=1e-12)
    assert 13.5 in [round(one, 9) for one in pressures_in(factored)]


def pressures_in(design) -> list[float]:
    """Every pressure of the inputs, in their order."""

    def walk(value, key=""):
        if isinstance(value, dict):
            return [one for name, below in value.items() for one in walk(below, name)]
        if isinstance(value, list):
            return [one for below in value for one in walk(below, key)]
        return [value] if key.startswith("pressure") and isinstance(value, float) else []

    return walk(design.inputs())


@pytest.mark.parametrize("fill", [False, True])
def test_uplift_of_a_footing_is_water(fill) -> None:
    """F = (c L + (P cos δ - U) tan φ) / (P sin δ) with load and uplift 1.35 times as large, however that is given."""
    dip, length = math.radians(40.0), 7.0
    toe = 9.81 * length * math.sin(dip)  # full, linear to nothing
    design = {
        "slopekit": 1,
        "kind": "footing",
        "footing": {"load": 1500},
        "weak_plane": {"dip": 40, "length": length},
        "strength": {"seam": {"c": 100, "phi": 20}},
        "uplift": {"fill": 1} if fill else {"toe": toe},
        "analysis": {"partial_factors": "DA1-C1"},
    }
    found = sk.run(design)
    load_kn, uplift = 1.35 * 1500.0, 1.35 * toe / 2.0 * length
    normal = load_kn * math.cos(dip) - uplift
    factor = (100.0 * length + normal * math.tan(math.radians(20.0))) / (load_kn * math.sin(dip))
    assert found.fos.closed_form == pytest.approx(factor, rel=1e-12)
    assert found.fos.limit == pytest.approx(factor, rel=1e-6)
    said = [row["what"] for row in found.to_dict()["partial_factors"]["table"]]
    assert "unit weight of water, and its pressures" in said


@pytest.mark.parametrize(("depth", "on_weight"), [("full", 1.0), ("3 m", 1.35)])
def test_water_in_the_crack_alone_stands_in_the_table(depth, on_weight) -> None:
    """The table had no row for it. Loads all in parts of the 1.35 on water, and c too, give the same factor.

    Weight takes 1.35 or 1, whichever is worse: before a full crack it holds.
    """
    design = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {"face": "65/185", "upper": "12/195", "height": 30},
        "joints": {
            "J1": {"plane": "45/105", "strength": "a"},
            "J2": {"plane": "70/235", "strength": "a"},
        },
        "crack": {"plane": "80/185", "distance": "5 m", "water": depth},
        "strength": {"a": {"c": 24, "phi": 25}},
        "rock": {"unit_weight": 25},
    }
    found = sk.run(design | {"analysis": {"partial_factors": "DA1-C1"}})
    strength, rock = {"a": {"c": 24 / 1.35, "phi": 25}}, {"unit_weight": 25 * on_weight / 1.35}
    weaker = sk.run(design | {"strength": strength, "rock": rock})
    assert found.fos.limit == pytest.approx(weaker.fos.limit, rel=1e-9)
    said = [row["what"] for row in found.to_dict()["partial_factors"]["table"]]
    assert "unit weight of water, and its pressures" in said


def test_studies_see_the_design_values() -> None:
    design = sk.load(asked("DA1-C2"))
    assert with_values(design, {"strength.bedding.c": 40}).strength.cohesion_kpa == pytest.approx(
        32.0
    )
    found = sk.solve(design, "strength.bedding.c")
    none, one = (by_hand(1.0, 1.0, 1.3, 1.25, c=c) for c in (0.0, 1.0))
    assert found.answer.value == pytest.approx((1.0 - none) / (one - none), rel=1e-6)
    assert found.to_dict()["partial_factors"]["called"].endswith("DA1-C2")
    with pytest.raises(sk.DesignError) as error:
        sk.prob(design, n=10)
    assert error.value.codes == ("E313",)


def test_the_factored_numbers_are_shown(tmp_path) -> None:
    result = sk.run(asked("DA1-C1"))
    sheet = str(result)
    assert "EN 1997-1:2004 Annex A" in sheet
    record = json.loads(json.dumps(result.to_dict()))
    rows = {row["what"]: row for row in record["partial_factors"]["table"]}
    for row in rows.values():
        if row["factor"] is not None:
            by = 1.0 / row["factor"] if row["divided"] else row["factor"]
            assert row["design"] == pytest.approx(row["characteristic"] * by)
    assert rows["unit weight"]["design"] == pytest.approx(35.1)
    assert record["inputs"]["unit_weight_kn_m3"] == pytest.approx(35.1)
    assert "partial_factors" not in sk.run(PLANE).to_dict()
    page = sk.report(result, tmp_path / "page.html", pictures=False).read_text(encoding="utf-8")
    assert "Partial factors" in page
    assert "35.1" in page


def test_a_case_with_factors_asks_for_one_unless_it_says_more() -> None:
    cases = {
        "static": {"accept": "fos >= 1.3"},
        "ec7": {"set": {"analysis.partial_factors": "DA1-C2"}},
        "more": {"set": {"analysis.partial_factors": "DA1-C2"}, "accept": "fos >= 1.4"},
    }
    found = sk.run({**PLANE, "acceptance": {"rules": "fos >= 1.3"}, "cases": cases})
    assert {name: str(one.design.rules[0]) for name, one in found.cases.items()} == {
        "static": "fos >= 1.3",
        "ec7": "fos >= 1",
        "more": "fos >= 1.4",
    }
    assert [notice.code for notice in found.warnings] == ["W332"]


def test_factors_of_the_users_own(tmp_path) -> None:
    """A file of several sets, of one, and a set with a number of its own."""
    (tmp_path / "own.yaml").write_text(
        "title: Our office\nsource: note 7\ndate: 2026-01-01\nsets:\n  ULS: {tan_phi: 1.2, c: 1.4}\n  SLS: {c: 1.1}\n"
    )
    (tmp_path / "one.yaml").write_text("tan_phi: 1.2\nc: 1.4\n")
    for name in ("own.yaml ULS", "one.yaml", {"set": "own.yaml SLS", "tan_phi": 1.2, "c": 1.4}):
        design = tmp_path / "cut.yaml"
        design.write_text(json.dumps({**PLANE, "analysis": {"partial_factors": name}}))
        made = sk.load(design)
        assert made.strength.cohesion_kpa == pytest.approx(30.0 / 1.4)
        assert math.tan(math.radians(made.strength.friction_angle_deg)) == pytest.approx(
            math.tan(math.radians(37.0)) / 1.2
        )
    assert slopekit("lint", str(design)).stdout.count("partial factors: Our office: SLS") == 1


@pytest.mark.parametrize(
    ("given", "code", "said"),
    [
        ("DA1", "E197", "DA1 is no set"),
        ("DA1-C3", "E197", "Did you mean DA1-C"),
        ("eurocode-7", "E197", "several sets"),
        ("none.yaml", "E147", "none.yaml does not exist"),
        ("bad.yaml", "E480", "tanphi is no partial factor"),
        ("empty.yaml", "E480", "holds no partial factor"),
        ({"tan_phi": 0}, "E127", "the partial factor tan_phi is 0"),
        ({"c": -1}, "E127", "the partial factor c is -1"),
        ({"c": "many"}, "E106", "c"),
        ({"c": {"dist": "normal", "mean": 1, "sd": 1}}, "E144", "partial_factors.c"),
        ({"tan": 1.2}, "E142", "tan is not a key"),
        ({"friction": 1.2}, "E142", "Did you mean tan_phi?"),
        ({"forces": "often", "set": "DA9"}, "E127", "forces are often"),
        (["DA1-C1"], "E144", "partial_factors"),
    ],
)
def test_bad_factors_are_refused(given, code, said, tmp_path) -> None:
    (tmp_path / "bad.yaml").write_text("sets: {ULS: {tanphi: 1.2}}\n")
    (tmp_path / "empty.yaml").write_text("title: nothing\n")
    (tmp_path / "cut.yaml").write_text(
        json.dumps({**PLANE, "analysis": {"partial_factors": given}})
    )
    with pytest.raises(sk.DesignError) as error:
        sk.load(tmp_path / "cut.yaml")
    assert code in error.value.codes
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("of", "on_load", "on_strength"),
    [
        ("DA1-C1", 1.35, 1.0),
        ({"set": "DA1-C1", "forces": "variable"}, 1.5, 1.0),
        ("DA1-C2", 1.0, 1.25),
        ({"set": "DA1-C2", "forces": "variable"}, 1.3, 1.25),
        ("DA2", 1.35, 1.1),
    ],
)
def test_the_load_of_a_footing_is_one_of_the_forces(of, on_load, on_strength) -> None:
    """F = (c L + P cos δ tan φ) / (P sin δ) with design values by hand; the rock above the plane has no weight."""
    design = {
        "slopekit": 1,
        "kind": "footing",
        "footing": {"load": 1500},
        "weak_plane": {"dip": 40, "length": 7},
        "strength": {"seam": {"c": 100, "phi": 20}},
        "analysis": {"partial_factors": of},
    }
    found, dip = sk.run(design), math.radians(40.0)
    load, weak = 1500.0 * on_load, math.tan(math.radians(20.0)) / on_strength
    factor = (100.0 / on_strength * 7.0 + load * math.cos(dip) * weak) / (load * math.sin(dip))
    assert found.fos.closed_form == pytest.approx(factor, rel=1e-12)
    assert found.fos.limit == pytest.approx(factor, rel=1e-6)
    said = found.to_dict()["partial_factors"]
    how = "variable" if isinstance(of, dict) else "permanent"
    row = next(row for row in said["table"] if "footing" in row["what"])
    assert (row["what"], row["design"]) == (f"footing load, {how}", pytest.approx(load))
    assert not any(row["what"] == "unit weight" for row in said["table"])


def test_the_worst_crack_is_that_of_the_characteristic_values() -> None:
    dry = {"water": "dry", "loads": {}, "crack": {"distance": "worst"}}
    said = {notice.code for notice in sk.run(asked("DA1-C2", **dry)).warnings}
    assert "W332" in said
    assert "W332" not in {notice.code for notice in sk.run({**PLANE, **dry}).warnings}
