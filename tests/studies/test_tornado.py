"""Tornados: the ends by the rule or as given, each end what `run` gives there, ranked by what they do."""

import json
from statistics import NormalDist

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from slopekit.studies.keys import Key
from slopekit.studies.tornado import tornado
from slopekit.studies.tornado.run import ends_of

WEDGE = str(path_of("wedge"))
SCATTERS = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {
        "J1": {"plane": {"dist": "fisher", "mean": "45/115", "k": 400}, "strength": "weak"},
        "J2": {"plane": "45/245", "strength": "weak"},
    },
    "strength": {
        "weak": {
            "c": {"dist": "uniform", "min": 40, "max": 60},
            "phi": {"dist": "normal", "mean": 20, "sd": 2},
        },
    },
    "correlation": {"J1.phi/J1.c": -0.3},
}


@pytest.fixture(scope="module")
def study():
    return tornado(sk.load(WEDGE), {"water.fill": "0:1", "loads.seismic.k": (0.0, 0.1)})


def test_ends_are_what_run_gives_there(study) -> None:
    for bar in study.bars:
        for value, point in ((bar.low, bar.at_low), (bar.high, bar.at_high)):
            result = sk.run(WEDGE, set={bar.key.path: value})
            assert point.factors.limit == result.fos.limit
            assert point.factors.closed_form == result.fos.closed_form
    assert study.base.factors.limit == sk.run(WEDGE).fos.limit


def test_bars_are_ranked_by_their_swing_in_both_methods(study) -> None:
    swings = [bar.swings["pre_ie"] for bar in study.bars]
    assert swings == sorted(swings, reverse=True)
    first = study.bars[0]
    assert (first.key.path, first.how) == ("water.fill", "given")
    factors = [sk.run(WEDGE, set={"water.fill": fill}).fos for fill in (0, 1)]
    assert first.swings["pre_ie"] == pytest.approx(factors[0].limit - factors[1].limit, rel=1e-12)
    assert first.swings["closed_form"] == pytest.approx(
        factors[0].closed_form - factors[1].closed_form, rel=1e-12
    )


def test_every_number_is_there_or_said_to_be_left_out(study) -> None:
    ranges = {bar.key.path: (bar.low, bar.high) for bar in study.bars}
    assert ranges["strength.weak.phi"] == (18.0, 22.0)
    assert ranges["strength.weak.c"] == pytest.approx((45.0, 55.0))
    assert ranges["slope.height"] == pytest.approx((64.89 * 0.9, 64.89 * 1.1))
    assert ranges["joints.J1.plane.dip_direction"] == (113.0, 117.0)
    assert ranges["loads.seismic.k"] == (0.0, 0.1)
    assert "rock.unit_weight" not in ranges  # the density says it
    assert dict(study.left_out)["strength.weak.tension"].startswith("nothing now")
    assert {bar.key.path for bar in study.bars if not bar.swings["pre_ie"]} >= {"slope.upper.dip"}


@pytest.mark.parametrize(
    ("key", "ends"),
    [
        (Key("strength.a.phi", "angle", 1.0, 0.0, 89.99), (0.0, 3.0)),
        (Key("slope.face.dip", "angle", 89.0, 0.0, 90.0), (87.0, 90.0)),
        (Key("slope.face.dip_direction", "angle", 1.0, 0.0, 360.0, period=360.0), (-1.0, 3.0)),
        (Key("water.fill", "ratio", 0.95, 0.0, 1.0), (0.85, 1.0)),
        (Key("loads.seismic.k", "ratio", 0.1, 0.0, 2.0), (0.09, 0.11)),
        (Key("loads.forces.0.force", "force", -10.0, -1e9, 1e9), (-11.0, -9.0)),
        (Key("strength.a.c", "pressure", 0.0, 0.0, 1e5), None),
        (Key("strength.a.c", "pressure", None, 0.0, 1e5), None),
    ],
)
def test_the_rule(key, ends) -> None:
    found = ends_of(key)
    assert (found is None) if ends is None else (found[:2] == pytest.approx(ends))


def test_what_scatters_goes_from_its_5_to_its_95_percent_quantile() -> None:
    """Normal: mean ± 1.6449 sd; uniform: 5 % of the width from its ends; Fisher: 1.6449/√k radians about the pole."""
    found = tornado(sk.load(SCATTERS), closed_form=True)
    ranges = {bar.key.path: (bar.low, bar.high) for bar in found.bars}
    tail = NormalDist().inv_cdf(0.95)
    assert ranges["strength.weak.phi"] == pytest.approx((20 - 2 * tail, 20 + 2 * tail), rel=1e-9)
    assert ranges["strength.weak.c"] == pytest.approx((41.0, 59.0), rel=1e-12)
    reach = tail / 400**0.5 * 57.29577951308232
    assert ranges["joints.J1.plane.mean.dip"] == pytest.approx((45 - reach, 45 + reach), rel=1e-9)
    wide = reach / 0.5**0.5
    assert ranges["joints.J1.plane.mean.dip_direction"] == pytest.approx(
        (115 - wide, 115 + wide), rel=1e-9
    )
    assert (
        not {"strength.weak.phi.mean", "strength.weak.phi.sd", "joints.J1.plane.k"} & ranges.keys()
    )
    assert all(
        bar.at_low.factors is not None for bar in found.bars
    )  # the correlation does not stand in the way


def test_ends_without_a_number_are_told() -> None:
    """A face down to 20° does not daylight; a bolt up to where nothing drives."""
    found = tornado(
        sk.load(WEDGE),
        {"slope.face.dip": "20:60", "water.pressures.J1": "0:5000"},
        closed_form=True,
    )
    ends = {bar.key.path: bar for bar in found.bars}
    assert ends["slope.face.dip"].at_low.code == "E203"
    assert ends["slope.face.dip"].swings["closed_form"] is None
    assert found.bars[-1].key.path == "slope.face.dip"  # behind those that have a swing
    assert "E203 1 (first at slope.face.dip = 20°)" in " ".join(str(found).split())
    assert found.exit_code == 0
    lifted = tornado(
        sk.load(WEDGE, {"water": {"pressures": {"J1": 10, "J2": 900}}}),
        {"water.pressures.J1": "0:900"},
        closed_form=True,
    )
    assert [notice.code for notice in lifted.warnings] == ["W359"]
    json.dumps(lifted.to_dict(), allow_nan=False)


def test_a_design_that_forms_no_block() -> None:
    found = tornado(
        sk.load(WEDGE, {"slope.face": "15/180"}), {"slope.height": "10:20"}, closed_form=True
    )
    assert found.exit_code == 3
    assert "no block: E203" in str(found)


def test_other_kinds_and_workers() -> None:
    plane = tornado(sk.load(path_of("plane")))
    assert plane.bars[0].key.path == "joints.J1.plane.dip"
    assert plane.exit_code == 0
    ranges = {"strength.joint.phi": "28:32"}
    blocks = tornado(sk.load(path_of("blocks")), ranges)
    assert blocks.asked == ("pre_ie",)
    assert any(why == "a coordinate" for _, why in blocks.left_out)


@pytest.mark.parametrize(
    ("ranges", "code"),
    [
        ({"phi": "1:2"}, "E310"),
        ({"slope.face": "1:2"}, "E311"),
        ({"slope.height": "2:1"}, "E312"),
        ({"slope.height": ""}, "E312"),
        ({"slope.height": "10:20:3"}, "E312"),
    ],
)
def test_what_cannot_be_asked(ranges, code) -> None:
    with pytest.raises(DesignError) as caught:
        tornado(sk.load(WEDGE), ranges)
    assert caught.value.codes == (code,)


def test_sheet_json_and_line(study) -> None:
    sheet = str(study)
    assert max(map(len, sheet.splitlines())) <= 100
    assert "angles ±2°" in sheet
    assert "NO EFFECT " in sheet
    assert study.line.startswith("water.fill 0.5514")
    document = study.to_dict()
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert document.keys() >= {"study", "rule", "base", "bars", "left_out", "disagree", "warnings"}
    assert document["bars"][0]["swing"].keys() == {"pre_ie", "closed_form"}


@pytest.mark.parametrize(
    ("rock", "ends"),
    [
        ({"unit_weight": "25.5 kN/m3"}, "22.95 kN/m³ 28.05 kN/m³"),
        ({"density": 2600}, "2340 kg/m³ 2860 kg/m³"),
    ],
)
def test_every_end_has_its_unit(rock, ends) -> None:
    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    }
    found = str(tornado(sk.load(wedge | {"rock": rock}), closed_form=True))
    assert f"rock.{next(iter(rock))} {ends} " in " ".join(found.split())


@pytest.mark.slow
def test_picture(study, tmp_path) -> None:
    pytest.importorskip("matplotlib")
    sk.plot(study, "tornado", tmp_path / "tornado.png")
    assert (tmp_path / "tornado.png").stat().st_size > 20_000
    lifted = tornado(
        sk.load(WEDGE, {"water": {"pressures": {"J1": 10, "J2": 900}}}),
        {"water.pressures.J1": "0:900"},
        closed_form=True,
    )
    sk.plot(lifted, "tornado", tmp_path / "lifted.png")
    no_block = tornado(sk.load(WEDGE, {"slope.face": "15/180"}), closed_form=True)
    with pytest.raises(DesignError) as caught:
        sk.plot(no_block, "tornado", tmp_path / "none.png")
    assert caught.value.codes == ("E273",)


@pytest.mark.slow
def test_the_command(monkeypatch, capsys, tmp_path) -> None:
    pytest.importorskip("matplotlib")
    from slopekit.cli import main

    arguments = [
        "sweep",
        WEDGE,
        "--tornado",
        "water.fill=0:1",
        "--closed-form",
        "--quiet",
        "-o",
        str(tmp_path),
    ]
    monkeypatch.setattr("sys.argv", ["slopekit", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    assert (left.value.code or 0) == 0
    assert capsys.readouterr().out.startswith("water.fill 0.5184")
    assert {path.name for path in tmp_path.iterdir()} == {
        "tornado.json",
        "tornado.txt",
        "tornado.png",
    }


BOLTED = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 30},
    "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
    "strength": {"s": {"c": 5, "phi": 30}},
    "rock": {"unit_weight": 26},
    "support": {
        "bolts": [{"force": 20000, "toward": "005/10", "head": [0.125, -5.0, 10.5], "length": 12}]
    },
}


def test_bolts_stay_where_they_are_when_the_geometry_moves() -> None:
    """With a face of 63° the bolt misses the wedge: no force by both methods, as without it, where a run is E211."""
    with pytest.raises(sk.GeometryError) as caught:
        sk.run(BOLTED, set={"slope.face.dip": 63})
    assert caught.value.codes == ("E211",)
    study = tornado(sk.load(BOLTED))
    bars = {bar.key.path: bar for bar in study.bars}
    without = sk.run(BOLTED | {"support": {}}, set={"slope.face.dip": 63}).fos
    assert bars["slope.face.dip"].at_low.factors.limit == pytest.approx(without.limit, rel=1e-9)
    assert bars["slope.face.dip"].at_low.factors.closed_form == pytest.approx(
        without.closed_form, rel=1e-9
    )
    held = sk.run(BOLTED, set={"slope.face.dip": 67}).fos
    assert bars["slope.face.dip"].at_high.factors.limit == pytest.approx(held.limit, rel=1e-9)
    assert "W311" in [notice.code for notice in study.warnings]
    swept = sk.sweep(sk.load(BOLTED), {"slope.face.dip": [63, 67]})
    assert swept.points[0].factors.limit == pytest.approx(without.limit, rel=1e-9)
    own = sk.sweep(
        sk.load(BOLTED), {"support.bolts.0.length": [1, 12]}
    )  # values of the bolts are as they are
    assert own.points[0].code == "E212"


def test_an_end_without_an_answer_is_no_swing() -> None:
    """A bar of which one end forms no block has a dash and null, and stands behind those with a swing."""
    study = tornado(sk.load(WEDGE), {"slope.face.dip": "20:60"}, closed_form=True)
    assert study.bars[-1].swings["closed_form"] is None
    line = next(
        line for line in str(study).splitlines() if line.strip().startswith("slope.face.dip ")
    )
    assert line.split()[-1] == "-"
    assert study.to_dict()["bars"][-1]["swing"] == {"closed_form": None}
    assert "slope.face.dip" not in study.line
