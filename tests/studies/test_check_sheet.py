"""The sheet and the picture of a check, and the command as a user runs it."""

import json
from functools import cache

import pytest

import slopekit as sk
from slopekit.design.templates import path_of
from slopekit.studies.check import Check, check
from tests.commands import slopekit


@cache
def checked_plane() -> Check:
    """The check of a template, once for what is looked at of it."""
    return check(sk.load(path_of("plane")))


@pytest.mark.parametrize("name", ["plane", "wall"])
def test_the_sheet(name) -> None:
    """Never a bare number: status, factors, what was looked at, ladder, verdict, within 100 columns."""
    checked = checked_plane() if name == "plane" else check(sk.load(path_of(name)))
    sheet = str(checked)
    lines = sheet.splitlines()
    assert max(map(len, lines)) <= 100
    labels = [line[:10].strip() for line in lines[1:] if not line.startswith(" ")]
    assert labels[:4] == ["STATUS", "FoS", "LOOKED AT", "LADDER"]
    assert "VERDICT   CONSISTENT" in sheet
    what = (
        "PRE-IE" if checked.result.findings is None else "limit of the elastic path (k_t/k_n 0.4)"
    )
    digits = 5 if name == "goodman-bray" else 3  # 0.99996 is no 1.000
    assert f"{checked.result.fos.limit:.{digits}f}  {what}" in sheet
    for finding in checked.findings:
        assert finding.name in sheet
    if checked.result.findings is None:
        assert sum("parts split" in line or "edges of" in line for line in lines) >= 3
    else:  # two ratios of the joints' stiffness, and the node pairs
        assert [
            sum(rung in line for line in lines) for rung in ("k_t / k_n 0.1", "k_t / k_n 1 ")
        ] == [1, 1]
        assert any("as analysed" in line for line in lines)
    assert checked.line.startswith(checked.result.status)


def test_what_is_measured_in_time_stands_in_the_text_alone() -> None:
    """The same design gives the same JSON but for `timing_s`; data frames have the seconds."""
    checked = checked_plane()
    assert {"ms", "times"} <= set(str(checked).split())
    shown = checked.to_dict()["sheet"]
    assert shown.keys().isdisjoint({"TIME"})
    (ladder,) = (entry for entry in shown["LADDER"] if not isinstance(entry, str))
    assert [column["title"] for column in ladder["columns"]] == [
        "method",
        "setting",
        "pairs",
        "F",
        "error",
    ]
    rows = checked.tables()["ladder"].records()
    assert [(row["fos"], row["seconds"]) for row in rows] == [
        (rung.factor, rung.seconds) for rung in checked.ladder
    ]


def test_without_a_factor_the_sheet_says_why() -> None:
    lifted = check(
        sk.load(path_of("wedge"), set={"water": {"pressures": {"J1": 2000, "J2": 2000}}})
    )
    sheet = str(lifted)
    assert "none: there is no factor of safety to come near to" in sheet
    assert "the same status from both" in sheet


def test_without_a_factor_there_is_no_picture(tmp_path) -> None:
    lifted = check(
        sk.load(path_of("wedge"), set={"water": {"pressures": {"J1": 2000, "J2": 2000}}})
    )
    with pytest.raises(sk.DesignError) as caught:
        sk.plot(lifted, "speed-error", tmp_path / "none.png")
    assert caught.value.codes == ("E273",)


def test_without_matplotlib_the_rest_is_written(tmp_path, monkeypatch) -> None:
    """E140 before any work where a picture is all that is asked for."""
    from slopekit.views.charts import drawing as room

    monkeypatch.setattr("slopekit.core.extras.find_spec", lambda name: None)
    with pytest.raises(sk.DesignError) as caught:
        room.require_matplotlib(tmp_path / "a.png")
    assert caught.value.codes == ("E140",)


def test_the_command(tmp_path) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    run = slopekit("check", str(path_of("plane")), "-o", str(tmp_path), "--json")
    assert run.returncode == 0
    document = json.loads(run.stdout)
    assert document == json.loads((tmp_path / "check.json").read_text())
    assert document["consistent"] is True
    assert "VERDICT" in (tmp_path / "check.txt").read_text()
    assert (tmp_path / "speed-error.png").stat().st_size > 10_000
    image = imread(tmp_path / "speed-error.png")
    assert min(image.shape[:2]) > 500
    assert image[..., :3].std() > 0.02  # something is drawn


def test_disagreement_is_exit_code_4() -> None:
    """A dispute of the methods is one: agreement is asked for beyond what the solver settles to."""
    settings = (
        "--set",
        "analysis.agree_within=1e-9",
        "--set",
        "slip.edge=16",
    )  # a coarse mesh is quick
    run = slopekit("check", str(path_of("sphere")), *settings, "--quiet")
    assert run.returncode == 4
    assert "NOT CONSISTENT: closed form" in run.stdout


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((), "E143"),
        ((str(path_of("plane")), "--suite"), "E143"),
        (("--suite", "--set", "rock.density=2600"), "E313"),
        (("nowhere.yaml",), "E147"),
        ((str(path_of("plane")), "--picture", "chart.gif"), "E141"),
    ],
)
def test_wrong_use(arguments, code) -> None:
    run = slopekit("check", *arguments)
    assert run.returncode == 2
    assert run.stderr.startswith(code)
