"""Sweeps: every point is what `run` gives there; none is dropped; levels passed, changes of status, files, pictures."""

import csv
import json
import math
from dataclasses import replace
from io import StringIO

import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.templates import path_of
from slopekit.kinds.protocol import Factors
from slopekit.studies.points import Point, factor_at, status_of
from slopekit.studies.protocol import Workplace
from slopekit.studies.sweep import sweep

WEDGE = str(path_of("wedge"))
#: Low on one joint: water takes its contact, then lifts the wedge off.
WET = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": 64.89},
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    "strength": {"weak": {"c": 20, "phi": 20}},
    "water": {"pressures": {"J1": 0, "J2": 0}},
}


@pytest.fixture(scope="module")
def curve():
    """From a face too flat to daylight to a steep one."""
    return sweep(sk.load(WEDGE), {"slope.face.dip": "20:88:5"}, fos=1.6)


@pytest.fixture(scope="module")
def grid():
    return sweep(sk.load(WEDGE), {"slope.face.dip": [20, 60, 40], "water.fill": "0,50 %,1"})


def same_as_run(swept, source) -> None:
    """Each point against the whole analysis of the design with those values set."""
    for place, point in zip(swept.places, swept.points, strict=True):
        values = {key.path: value for key, value in zip(swept.keys, place, strict=True)}
        if point.factors is None:
            with pytest.raises(sk.SlopekitError) as caught:
                sk.run(source, set=values)
            fault = caught.value.faults[0]
            assert (point.code, point.message) == (fault.code, fault.message)
            continue
        result, found = sk.run(source, set=values), point.factors
        assert (found.status, found.agree, found.moments_govern) == (
            result.status,
            result.agree,
            result.moments_govern,
        )
        assert (found.limit, found.closed_form) == (result.fos.limit, result.fos.closed_form)


def test_a_curve_is_run_at_every_point(curve) -> None:
    same_as_run(curve, WEDGE)
    assert len(curve.points) == 5
    assert curve.exit_code == 0


def test_a_grid_is_run_at_every_point(grid) -> None:
    same_as_run(grid, WEDGE)
    assert grid.places[:4] == [(20.0, 0.0), (60.0, 0.0), (40.0, 0.0), (20.0, 0.5)]
    assert [len(points) for _, points in grid.lines()] == [3, 3, 3]
    assert [value for value, _ in grid.lines()[0][1]] == [
        20.0,
        40.0,
        60.0,
    ]  # neighbours are neighbours in value


@pytest.mark.parametrize(
    ("name", "key", "values"),
    [
        ("plane", "crack.water", "1m:4m:3"),
        ("footing", "footing.load", "1 MN,2 MN"),
        ("blocks", "loads.seismic.k", "0.1"),
    ],
)
def test_other_kinds(name, key, values) -> None:
    same_as_run(sweep(sk.load(path_of(name)), {key: values}), path_of(name))


def test_points_without_a_block_are_kept_and_counted(curve) -> None:
    assert curve.points[0].code == "E203"
    assert curve.counts == {"slides_on_both": 4, "E203": 1}
    assert [notice.code for notice in curve.warnings] == ["W359"]
    assert (
        "1 of 5 points have no factor of safety: E203 1 (first at slope.face.dip = "
        in curve.warnings[0].message
    )
    sheet = str(curve)
    assert "E203 the line plunges 22.9°, steeper than the face (20°)" in sheet
    assert len(list(csv.reader(StringIO(curve.sheet.tables["sweep.csv"].csv())))) == 6


def test_levels_that_are_passed_are_interpolated_and_said_to_be(curve) -> None:
    """1, the acceptance rule (1.5) and the target; F straight between neighbours, by both methods."""
    assert curve.levels == (
        (1.0, "FoS 1"),
        (1.5, "acceptance, fos >= 1.5"),
        (1.6, "target, FoS 1.6"),
    )
    found = [one for one in curve.critical if one["fos"] == 1.5]
    assert [one["method"] for one in found] == ["pre_ie", "closed_form"]
    assert found[0]["between"] == (71.0, 88.0)
    assert found[0]["how"] == "interpolated"
    low, high = (
        sk.run(WEDGE, set={"slope.face.dip": dip}).fos.limit for dip in found[0]["between"]
    )
    share = (found[0]["at"] - 71.0) / 17.0
    assert pytest.approx((1.0 - share) * low + share * high, rel=1e-12) == 1.5
    assert abs(found[0]["at"] - 72.9958) < 1.0  # where solve finds it
    assert [one for one in curve.critical if one["fos"] == 1.0] == []
    assert "interpolated between 71° and 88°" in str(curve)
    exact = sweep(
        sk.load(WEDGE), {"strength.weak.phi": [10, 20]}, fos=curve.points[2].factors.limit
    )
    assert exact.critical[0]["how"] in ("interpolated", "at a point")


def test_a_level_on_a_point_is_found_once() -> None:
    design = sk.load(WEDGE)
    here = sk.analyse(design).fos.closed_form
    swept = sweep(design, {"strength.weak.phi": [15, 20, 25]}, closed_form=True, fos=here)
    found = [one for one in swept.critical if one["fos"] == here]
    assert [(one["at"], one["how"]) for one in found] == [(20.0, "at a point")]
    first = sweep(design, {"strength.weak.phi": [20, 25]}, closed_form=True, fos=here)
    assert [(one["at"], one["how"]) for one in first.critical if one["fos"] == here] == [
        (20.0, "at a point")
    ]


def test_changes_of_status_are_marked() -> None:
    """Contact with J1 is lost, then the wedge is lifted off; a level passed over a change is said to be."""
    swept = sweep(
        sk.load(WET),
        {"water.pressures.J1": [0, 300, 360, 900], "water.pressures.J2": [0, 900]},
        closed_form=True,
        fos=0.75,
    )
    same = {change["statuses"] for change in swept.changes}
    assert ("slides_on_both", "slides_on_J2") in same
    assert swept.counts["lifted"] >= 1
    assert any(
        one["how"] == "across a change of status" for one in swept.critical if one["fos"] == 0.75
    )
    over = [one for one in swept.critical if one["how"] == "to where there is no number"]
    assert all(one["at"] is None for one in over)
    assert swept.warnings[0].code == "W359"
    curve = sweep(sk.load(WET), {"water.pressures.J1": [0, 300, 360]}, closed_form=True)
    assert [line[31] for line in str(curve).splitlines()[3:6]] == [" ", " ", ">"]


def test_the_closed_form_alone() -> None:
    design, values = sk.load(WEDGE), {"slope.face.dip": [60]}
    both, closed = (sweep(design, values, closed_form=alone) for alone in (False, True))
    assert both.asked == ("pre_ie", "closed_form")
    assert (closed.asked, closed.points[0].factors.limit) == (("closed_form",), None)
    assert closed.points[0].factors.closed_form == both.points[0].factors.closed_form
    assert (both.to_dict()["methods"], closed.to_dict()["methods"]) == ("both", "closed-form")


def test_exit_codes() -> None:
    swept = sweep(sk.load(WEDGE), {"slope.face.dip": [15, 20]}, closed_form=True)
    assert swept.exit_code == 3
    assert sweep(sk.load(WEDGE), {"water.fill": [-1, 2]}, closed_form=True).exit_code == 2
    good = sweep(sk.load(WEDGE), {"slope.face.dip": [60]})
    assert good.exit_code == 0
    for wrong in ({"agree": False}, {"status": "not_converged", "agree": False}):
        off = replace(good, points=(Point(replace(good.points[0].factors, **wrong)),))
        assert off.exit_code == 4
        assert off.disagree == 1
        assert "1 disagree" in off.line


def test_workers_give_the_same_points(tmp_path) -> None:
    """Two processes, out of order, and what a journal keeps."""
    design, values = sk.load(WEDGE), {"slope.face.dip": [50, 60, 70]}
    serial = sweep(design, values)
    two = sweep(design, values, jobs=2, desk=Workplace(tmp_path))
    assert two.points == serial.points
    assert [path.suffix for path in tmp_path.iterdir()] == [
        ".journal"
    ]  # until the results are written


@pytest.mark.parametrize(
    ("keys", "options", "code"),
    [
        ({}, {}, "E313"),
        ("slope.face.dip=50:80:4", {}, "E313"),
        ({"slope.face.dip": [60], "slope.height": [10], "water.fill": [0]}, {}, "E313"),
        ({"loads.seismic": [0.1], "loads.seismic.k": [0.1]}, {}, "E313"),
        ({"slope.face.dip": [60]}, {"fos": -1.0}, "E314"),
        ({"slope.face": [60]}, {}, "E311"),
        ({"slope.faec.dip": [60]}, {}, "E310"),
        ({"slope.face.dip": "0:90:1000", "slope.height": "1:10:1000"}, {}, "E312"),
    ],
)
def test_what_cannot_be_asked(keys, options, code) -> None:
    with pytest.raises(DesignError) as caught:
        sweep(sk.load(WEDGE), keys, **options)
    assert caught.value.codes == (code,)


def test_every_fault_of_the_keys_at_once_and_no_closed_form() -> None:
    with pytest.raises(DesignError) as caught:
        sweep(sk.load(WEDGE), {"slope.faec.dip": [60], "slope.height": "10:20"})
    assert caught.value.codes == ("E310", "E312")
    with pytest.raises(DesignError) as caught:
        sweep(sk.load(path_of("wall")), {"strength.joint.phi": [30]}, closed_form=True)
    assert caught.value.codes == ("E313",)


def test_sheets_are_a_hundred_columns_wide(curve, grid) -> None:
    wide = sweep(
        sk.load(WEDGE), {"slope.face.dip": "40:85:12", "water.fill": "0:1:3"}, closed_form=True
    )
    long = sweep(sk.load(WEDGE), {"slope.face.dip": "15:89:300"}, closed_form=True)
    for swept in (curve, grid, wide, long):
        lines = str(swept).splitlines()
        assert max(map(len, lines)) <= 100
        assert swept.line
    assert len(long.tables()["curve"].rows) == 300
    assert "E203" in str(grid)
    assert "1.557" in grid.sheet.full


def test_headings_of_a_grid_stand_apart() -> None:
    """Thirds of a degree, and dips that differ in the sixth digit."""
    keys = {
        "strength.weak.phi": [20 + k / 3 for k in range(8)],
        "joints.J1.plane.dip": [45.0, 45.0001],
    }
    lines = str(sweep(sk.load(WEDGE), keys, closed_form=True)).splitlines()
    heads = next(k for k, line in enumerate(lines) if line.startswith("GRID")) + 1
    assert lines[heads].split() == ["20", "20.33", "20.67", "21", "21.33", "21.67", "22", "22.33"]
    assert [line.split()[0] for line in lines[heads + 1 : heads + 3]] == ["45", "45.0001"]


def test_json_is_strict_and_the_same_twice_but_for_times(curve) -> None:
    first, second = (
        curve.to_dict(),
        sweep(sk.load(WEDGE), {"slope.face.dip": "20:88:5"}, fos=1.6).to_dict(),
    )
    assert json.loads(json.dumps(first, allow_nan=False)) == first
    for document in (first, second):
        del document["timing_s"]
    assert first == second
    assert first.keys() >= {
        "study",
        "keys",
        "methods",
        "levels",
        "points",
        "counts",
        "disagree",
        "changes",
        "critical",
        "warnings",
    }
    assert (
        first["points"][0] | {"code": "E203", "values": [20.0], "limit": None} == first["points"][0]
    )


def test_pictures(tmp_path) -> None:
    pytest.importorskip("matplotlib")
    steep = sweep(
        sk.load(WEDGE, {"support.bolts": [{"force": 1, "toward": "000/-05"}]}),
        {"support.bolts.0.force": [1e5, 2e6, 2.2e6, 9e6]},
        closed_form=True,
        fos=2.0,
    )
    wet = sweep(
        sk.load(WET),
        {"water.pressures.J1": [0, 300, 360, 900], "water.pressures.J2": [0, 450, 900]},
        closed_form=True,
    )
    for k, swept in enumerate((steep, wet)):
        target = tmp_path / f"{k}.png"
        sk.plot(swept, "curve" if len(swept.keys) == 1 else "contour", target)
        assert target.read_bytes().startswith(b"\x89PNG")
        assert target.stat().st_size > 20_000
    with pytest.raises(DesignError) as caught:
        sk.plot(
            sweep(sk.load(WEDGE), {"slope.face.dip": [15, 20]}, closed_form=True),
            "curve",
            tmp_path / "a.png",
        )
    assert caught.value.codes == ("E273",)


# -- the command ------------------------------------------------------------------------------------------------------


def command(monkeypatch, capsys, *arguments: str) -> tuple[int, str, str]:
    from slopekit.cli import main

    monkeypatch.setattr("sys.argv", ["slopekit", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    out = capsys.readouterr()
    return int(left.value.code or 0), out.out, out.err


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (
            ("slope.face.dip=60,80", "--closed-form", "--quiet"),
            0,
            "2 points  closed form 1.478 to 1.557",
        ),
        (
            ("slope.face.dip=60", "--quiet"),
            0,
            "1 point  PRE-IE 1.557 to 1.557  closed form 1.557 to 1.557  agree",
        ),
        (("slope.face.dip=15,20", "--closed-form", "--quiet"), 3, "W359"),
        (("slope.face.dip",), 2, "E312 slope.face.dip has no values"),
        ((), 2, "E313 no key is given"),
        (("slope.height=10,20", "slope.height=30"), 2, "E313 slope.height is given twice"),
        (("--tornado", "--fos", "1.5"), 2, "E313 --fos says nothing of a tornado"),
        (("slope.height=10,20", "--fos", "x"), 2, "E106 --fos is 'x'"),
        (("slope.height=10,20", "--picture", "x.jpg"), 2, "E141"),
    ],
)
def test_the_command(arguments, code, says, monkeypatch, capsys) -> None:
    left, out, err = command(monkeypatch, capsys, "sweep", WEDGE, *arguments)
    assert left == code
    assert says in (err if code == 2 else out)


def test_the_command_writes_its_files(monkeypatch, capsys, tmp_path) -> None:
    pytest.importorskip("matplotlib")
    code, out, _ = command(
        monkeypatch,
        capsys,
        "sweep",
        WEDGE,
        "slope.face.dip=20,60,70",
        "--closed-form",
        "--json",
        "-o",
        str(tmp_path),
    )
    assert code == 0
    assert json.loads(out) == json.loads((tmp_path / "sweep.json").read_text())
    assert {path.name for path in tmp_path.iterdir()} == {
        "sweep.json",
        "sweep.txt",
        "sweep.csv",
        "curve.png",
    }
    rows = list(csv.DictReader(StringIO((tmp_path / "sweep.csv").read_text())))
    assert [row["code"] for row in rows] == ["E203", "", ""]
    assert math.isclose(float(rows[1]["closed_form"]), 1.5573963527, rel_tol=1e-9)


# -- what scatters ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("varied", "named"),
    [
        ("slope.face.dip=70,80", ["strength.weak.c", "strength.weak.phi"]),
        ("strength.weak.phi.mean=18,22", ["strength.weak.c"]),
        (
            "strength.weak.phi.sd=1,2",
            ["strength.weak.c", "strength.weak.phi"],
        ),  # its mean is taken all the same
    ],
)
def test_means_that_are_taken_are_said_by_every_study(varied, named) -> None:
    """W320, as a run says it; not of the number that the study changes."""
    scatters = {
        "strength.weak.c": {"dist": "uniform", "min": 40, "max": 60},
        "strength.weak.phi": {"dist": "normal", "mean": 20, "sd": 1},
    }
    design, (key, _, values) = sk.load(WEDGE, scatters), varied.partition("=")
    swept = sweep(design, {key: values}, closed_form=True)
    solved = sk.solve(
        design, key, fos=1.0 if "face" in key else 1.4, within=tuple(map(float, values.split(",")))
    )
    for found in (swept, solved):
        said = [notice for notice in found.warnings if notice.code == "W320"]
        taken = [
            notice.message.removeprefix("distributions are taken at their means: ")
            for notice in said
        ]
        assert [name.split()[0] for text in taken for name in text.split(", ")] == named
        assert f"W320 distributions are taken at their means: {named[0]}" in str(found)
        assert found.line.count("W320") == 1
        assert found.to_dict()["warnings"][-1]["code"] == "W320"
    if "face" in key:
        told = [notice.message for notice in sk.run(design).warnings if notice.code == "W320"]
        assert [notice.message for notice in swept.warnings] == told
        tornado = sk.tornado(design, closed_form=True)
        assert [notice.message for notice in tornado.warnings if notice.code == "W320"] == told
        assert tornado.line.endswith("W320")


def test_what_did_not_settle_is_no_slope_that_nothing_holds() -> None:
    """Many blocks whose motion did not settle have no factor in a study; without strength theirs is 0."""
    unsettled, loose = (
        Point(Factors(status, None, None, None, None, None, False))
        for status in ("not_converged", "slides")
    )
    assert factor_at(unsettled, "pre_ie") is None
    assert status_of(unsettled, "pre_ie") == "not_converged"
    assert factor_at(loose, "pre_ie") == 0.0
    assert status_of(loose, "pre_ie") == "slides"
