"""Load cases: each is the design with its values set, run by itself; bad ones are refused with their place."""

import json
import math
from pathlib import Path

import pytest

import slopekit as sk
from slopekit.cli.study_command import command_of
from tests.commands import slopekit

ROOT = Path(__file__).parents[2]
FILE = ROOT / "examples/load-cases.yaml"
DESIGN = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"bedding": {"c": 20, "phi": 37}},
    "rock": {"unit_weight": 26},
    "water": {"fill": "50 %"},
    "acceptance": {"rules": ["fos >= 1.3"]},
}
CASES = {
    "static": {"accept": "fos >= 1.5"},
    "quake": {"set": {"loads.seismic.k": 0.1}, "accept": "fos >= 1.1"},
    "drained": {"set": {"water.fill": 0}},
}


def plane_factor(fill: float = 0.5, k: float = 0.0, c: float = 20.0) -> float:
    """Hoek & Bray's plane without a crack, by hand: water highest at mid-length, its mean gamma_w H fill / 4."""
    height, dip, phi = 12.0, math.radians(35.0), math.radians(37.0)
    length = height / math.sin(dip)
    weight = 26.0 * height**2 / 2.0 * (1.0 / math.tan(dip) - 1.0 / math.tan(math.radians(60.0)))
    uplift = 9.81 * height * fill / 4.0 * length
    normal = weight * (math.cos(dip) - k * math.sin(dip)) - uplift
    return (c * length + normal * math.tan(phi)) / (weight * (math.sin(dip) + k * math.cos(dip)))


@pytest.fixture(scope="module")
def found():
    return sk.run(FILE)


def test_each_case_is_the_design_with_its_values(found) -> None:
    """Against the formula of a plane failure, and against `set` by hand."""
    expected = {
        "static": plane_factor(),
        "quake": plane_factor(k=0.1),
        "drained": plane_factor(fill=0.0),
    }
    for name, factor in expected.items():
        assert found.cases[name].fos.closed_form == pytest.approx(factor, rel=1e-9)
        assert found.cases[name].fos.limit == pytest.approx(factor, rel=1e-6)
    alone = sk.run(
        FILE, set={"cases": None, "loads.seismic.k": 0.1, "acceptance.rules": "fos >= 1.1"}
    )
    own, other = found.cases["quake"].to_dict(), alone.to_dict()
    assert own["input_sha256"] == other["input_sha256"]
    assert own.keys() == other.keys()
    assert own["rules"] == other["rules"]
    assert own["fos"] == other["fos"]


def test_the_worst_case_decides_and_the_nearest_to_its_rule_governs(found) -> None:
    ratios = {name: one.fos.limit / one.design.rules[0].value for name, one in found.cases.items()}
    assert found.governing == min(ratios, key=ratios.get) == "static"
    assert (found.exit_code, found.accepted) == (1, False)
    assert [found.cases[name].accepted for name in CASES] == [False, False, True]
    assert found.line.startswith("static governs 3 cases  slides_on_J1  1.280 ")
    assert sk.run({**DESIGN, "cases": {"drained": CASES["drained"]}}).exit_code == 0


def test_it_shows_itself_as_a_result_does(found) -> None:
    frame = found.to_frame()
    assert list(frame["case"]) == list(CASES)
    assert list(frame["accepted"]) == [False, False, True]
    assert "quake" in str(found)
    assert "static governs" in repr(found)
    assert "<table>" in found.sheet._repr_html_()
    record = json.loads(json.dumps(found.to_dict()))
    assert record["study"] == "cases"
    assert record["sets"]["quake"] == {"loads.seismic.k": "0.1"}
    assert record["cases"]["quake"]["title"] == "Road cut, km 12.4, case quake"


def test_one_case_is_a_result_like_any_other(found) -> None:
    by_file, by_design = sk.run(FILE, case="quake"), sk.run(sk.load(FILE), case="quake")
    assert by_file.fos == by_design.fos == found.cases["quake"].fos
    assert sk.run(FILE, case="quake").to_dict().keys() == sk.run(DESIGN).to_dict().keys()


def test_the_command_line_writes_every_case(tmp_path) -> None:
    ran = slopekit("run", str(FILE), "-o", "out", "--no-pictures", "--json", cwd=tmp_path)
    assert ran.returncode == 1
    assert json.loads(ran.stdout)["governing"] == "static"
    written = {
        str(path.relative_to(tmp_path / "out"))
        for path in (tmp_path / "out").rglob("*")
        if path.is_file()
    }
    each = {f"{case}/{file}" for case in CASES for file in ("result.json", "sheet.txt")}
    assert written == each | {"result.json", "sheet.txt", "cases.csv"}
    assert (
        json.loads((tmp_path / "out/quake/result.json").read_text())["fos"]
        == json.loads(ran.stdout)["cases"]["quake"]["fos"]
    )
    page = sk.report(tmp_path / "out", tmp_path / "page.html", pictures=False).read_text(
        encoding="utf-8"
    )
    assert page.index("Load cases") < page.index("Result, static") < page.index("Result, drained")
    listed = slopekit("plot", "out", "--case", "quak", cwd=tmp_path)
    assert listed.returncode == 2
    assert "E197" in listed.stderr
    assert "quake" in listed.stderr
    assert slopekit("run", str(FILE), "--case", "drained", "--quiet").returncode == 0


def test_every_study_of_a_design_takes_cases() -> None:
    for name in ("run", "check", "prob", "sweep", "solve", "support"):
        assert "case" in command_of(name).__annotations__
    checked = sk.check(sk.load(FILE))
    assert {name: one.result.fos.limit for name, one in checked.cases.items()} == {
        name: one.fos.limit for name, one in sk.run(FILE).cases.items()
    }
    swept = sk.sweep(sk.load(FILE), {"loads.seismic.k": [0, 0.1]}, closed_form=True)
    assert [notice.code for notice in swept.warnings] == ["W427"]
    assert swept.cases["static"].points[1].factors.closed_form == pytest.approx(
        plane_factor(k=0.1), rel=1e-9
    )


def test_the_bolts_of_the_case_that_governs_satisfy_every_case() -> None:
    """The bolts that are written, put into the design by hand, and every case run with them."""
    found = sk.support(sk.load(FILE), acts="active")
    assert (found.exit_code, found.governing) == (0, "static")
    assert [one.target for one in found.cases.values()] == [1.5, 1.1, 1.3]
    rows = found.to_frame()
    assert list(rows["bolts"]) == ["reached", "reached", "none needed"]
    needed = [one.cases[0].force for one in found.cases.values() if one.cases]
    assert rows["active_kn"].dropna().tolist() == needed
    assert needed[0] > needed[1]
    bolts = [
        {
            "force": bolt.force_kn,
            "toward": f"{bolt.toward.trend_deg}/{bolt.toward.plunge_deg}",
            "head": bolt.head_m,
            "length": bolt.length_m,
        }
        for bolt in found.cases["static"].cases[0].bolts
    ]
    again = sk.run(FILE, set={"support.bolts": bolts})
    assert again.accepted
    tried = found.to_dict()["cases"]["static"]["bolts"][0]["other_cases"]
    assert list(tried) == ["quake", "drained"]
    for name, trial in tried.items():
        factor = again.cases[name].fos.limit
        assert (trial["met"], trial["fos"]["limit"]) == (True, pytest.approx(factor, rel=1e-9))
        assert f"{name} FoS {factor:.4f}" in str(found)
    assert again.exit_code == 0
    less = [bolt | {"force": bolt["force"] * 0.95} for bolt in bolts]
    assert not sk.run(FILE, set={"support.bolts": less}).accepted


def test_bolts_that_do_not_hold_another_case_are_not_reached(tmp_path) -> None:
    """Bolts best for little friction point 30° upward; with much they are 20° off the best direction, and too few.

    Against the formula of an active bolt on a dry plane, its force and direction as they are written.
    """
    dry = {key: value for key, value in DESIGN.items() if key != "water"}
    design = dry | {
        "strength": {"bedding": {"c": 20, "phi": 45}},
        "cases": {
            "rock": {"accept": "fos >= 2.2"},
            "soaked": {
                "set": {"strength.bedding.phi": 5, "strength.bedding.c": 55},
                "accept": "fos >= 1.6",
            },
        },
    }
    found = sk.support(sk.load(design), plunge=(-45, 30), acts="active")
    case = found.cases["soaked"].cases[0]
    height, dip, force = 12.0, math.radians(35.0), sum(bolt.force_kn for bolt in case.bolts)
    weight = 26.0 * height**2 / 2.0 * (1.0 / math.tan(dip) - 1.0 / math.tan(math.radians(60.0)))
    off = dip + math.radians(case.toward.plunge_deg)  # between the bolts and the plane
    normal = weight * math.cos(dip) + force * math.sin(off)
    factor = (20.0 * height / math.sin(dip) + normal) / (
        weight * math.sin(dip) - force * math.cos(off)
    )
    assert factor < 2.2
    trial = case.other_cases["rock"]
    assert (trial["met"], trial["fos"]) == (
        False,
        pytest.approx({"limit": factor, "closed_form": factor}, rel=1e-6),
    )
    assert (case.reached, found.governing, found.exit_code) == (True, "soaked", 1)
    assert "NOT REACHED in rock" in found.line
    assert f"rock NOT REACHED, FoS 2.2: solved again with these bolts FoS {factor:.4f}" in " ".join(
        str(found).split()
    )
    assert case.yaml.startswith("# in rock NOT REACHED, FoS 2.2")
    lower = sk.support(
        sk.load(design, set={"cases.rock.accept": "fos >= 2.19"}), plunge=(-45, 30), acts="active"
    )
    assert (lower.governing, lower.exit_code) == ("soaked", 0)


def test_bolts_that_have_no_place_in_another_case_are_not_reached() -> None:
    """The highest bolt of a cut 12 m high has its head above one of 10 m: E211 there, as `run` says."""
    cases = {
        "high": {"accept": "fos >= 2"},
        "low": {"set": {"slope.height": 10}, "accept": "fos >= 1.2"},
    }
    found = sk.support(sk.load(DESIGN | {"cases": cases}), acts="passive")
    assert found.exit_code == 1
    assert "low NOT REACHED, FoS 1.2: E211 bolt" in " ".join(str(found).split())
    assert found.cases["high"].cases[0].other_cases == {"low": None}


def test_solve_gives_the_value_of_each_case() -> None:
    """c of each case from the formula, linear in c; the largest governs."""

    def needed(target: float, **case: float) -> float:
        none, one = plane_factor(c=0.0, **case), plane_factor(c=1.0, **case)
        return (target - none) / (one - none)

    own = {"static": needed(1.5), "quake": needed(1.1, k=0.1), "drained": needed(1.3, fill=0.0)}
    found = sk.solve(sk.load(FILE), "strength.bedding.c")
    assert {name: one.answer.value for name, one in found.cases.items()} == pytest.approx(
        own, rel=1e-6
    )
    assert (found.governing, found.exit_code) == ("static", 0)
    rows = found.to_frame()
    assert dict(zip(rows["case"], rows["value"], strict=True)) == pytest.approx(own, rel=1e-6)
    assert set(rows["bound"]) == {"at least"}
    wet = sk.solve(
        sk.load({**DESIGN, "cases": {name: CASES[name] for name in ("static", "quake")}}),
        "water.fill",
    )
    assert wet.cases[wet.governing].answer.value == min(
        one.answer.value for one in wet.cases.values()
    )


def test_prob_answers_case_by_case() -> None:
    scatter = {
        **DESIGN,
        "strength": {"bedding": {"c": 20, "phi": {"dist": "normal", "mean": 37, "sd": 4}}},
    }
    cases = {
        "dry": {"set": {"water.fill": 0}},
        "fixed": {"set": {"strength.bedding.phi": 30, "strength.bedding.c": 1}},
    }
    found = sk.prob(sk.load({**scatter, "cases": {"dry": cases["dry"]}}), n=200, by="closed-form")
    alone = sk.prob(sk.load(scatter, {"water.fill": 0}), n=200, by="closed-form")
    assert found.cases["dry"].all_samples == alone.all_samples
    with pytest.raises(sk.DesignError, match="fixed"):
        sk.prob(sk.load({**scatter, "cases": cases}), n=200)


@pytest.mark.parametrize(
    ("cases", "code", "said"),
    [
        ({}, "E109", "cases has no entries"),
        ({"a": {}}, "E471", "the load case a is empty"),
        ({"a": {"set": {}}}, "E471", "the load case a is empty"),
        ({"a": 5}, "E144", "cases.a is the text"),
        ({"a": {"set": 5}}, "E144", "cases.a.set"),
        ({"a": {"accept": "fos >= 1", "sets": {}}}, "E142", "sets is not a key of cases.a"),
        ({"a": CASES["static"], "A": CASES["static"]}, "E146", "differ in capitals alone"),
        ({"a\tb": CASES["static"]}, "E146", "cannot be the name"),
        ({"a.b": CASES["static"]}, "E146", "cannot be a name"),
        ({"a": {"set": {"kind": "wedge"}}}, "E471", "cannot set kind"),
        ({"a": {"set": {"cases.b.set": {"c": 1}}}}, "E471", "cases within a case"),
        ({"a": {"set": {"loads.seismc.k": 0.1}}}, "E142", "seismc is not a key of loads"),
        ({"a": {"set": {"loads.seismic.k": 9}}}, "E122", "seismic coefficient is 9"),
        ({"a": {"set": {"water..fill": 0}}}, "E160", "no path to a key"),
        ({"a": {"set": {"slope.height.m": 0}}}, "E160", "it has no m"),
        ({"a": {"set": {"support.bolts.0.force": 1}}}, "E144", "a list is needed"),
        ({"a": {"accept": "fs >= 1"}}, "E169", "fs is nothing that a rule can judge"),
        ({"a": {"accept": {"fos": 1}}}, "E144", "cases.a.accept"),
        (
            {"a": {"accept": "fos >= 1", "set": {"acceptance.rules": "fos >= 2"}}},
            "E151",
            "set twice",
        ),
    ],
)
def test_bad_cases_are_refused(cases, code, said) -> None:
    with pytest.raises(sk.DesignError) as error:
        sk.load({**DESIGN, "cases": cases})
    assert code in error.value.codes
    assert said in str(error.value)


def test_all_faults_of_all_cases_come_at_once_with_their_places(tmp_path) -> None:
    text = FILE.read_text(encoding="utf-8")
    text = (
        text.replace("k: 0.1", "k: 9")
        .replace("water.fill: 0}", "water.fill: 7}")
        .replace("phi: 37", "phi: 97")
    )
    path = tmp_path / "cut.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(sk.DesignError) as error:
        sk.load(path)
    assert [(fault.code, fault.where.split(":")[1]) for fault in error.value.faults] == [
        ("E115", "7"),
        ("E122", "13"),
        ("E118", "14"),
    ]


def test_a_fault_that_only_a_case_has_says_whose_it_is() -> None:
    """A face that is flatter than the joint in one case alone."""
    with pytest.raises(sk.GeometryError, match=r"\(load case flat\)"):
        sk.run(
            {
                **DESIGN,
                "cases": {"flat": {"set": {"slope.face": "30/180"}}, "quake": CASES["quake"]},
            }
        )


@pytest.mark.parametrize(("name", "code"), [("quak", "E197"), ("Static", "E197"), ("", "E197")])
def test_an_unknown_case_is_refused_with_the_nearest(name, code) -> None:
    with pytest.raises(sk.DesignError) as error:
        sk.load(FILE, case=name)
    assert error.value.codes == (code,)
    with pytest.raises(sk.DesignError) as error:
        sk.load(DESIGN, case=name)
    assert error.value.codes == ("E313",)


def test_a_picture_is_of_one_case(found) -> None:
    with pytest.raises(sk.DesignError) as error:
        sk.plot(found, "scene")
    assert error.value.codes == ("E313",)
    assert sk.plot(found.cases["quake"])
