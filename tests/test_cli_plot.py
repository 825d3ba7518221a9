"""The command plot as a user runs it: what it writes, what it refuses and says instead."""

import json
import math
from pathlib import Path

import pytest

import slopekit as sk
from slopekit.cli import main
from slopekit.core.errors import DesignError
from slopekit.core.explanations import explanation
from slopekit.design.templates import path_of

pytest.importorskip("matplotlib")

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}


@pytest.fixture
def run(monkeypatch, capsys):
    """Run the command: exit code, stdout, stderr."""

    def plot(*arguments: str | Path) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["slopekit", "plot", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        out = capsys.readouterr()
        return int(left.value.code or 0), out.out, out.err

    return plot


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A folder with a sweep, a result and a kinematic study."""
    made = tmp_path_factory.mktemp("plot")
    swept = sk.sweep(sk.load(WEDGE), {"slope.face.dip": [60, 80]}, closed_form=True)
    for name, study in (
        ("sweep", swept),
        ("result", sk.run(WEDGE)),
        ("kinematic", sk.kinematic(["40/175", "35/090"], face="65/180")),
    ):
        (made / f"{name}.json").write_text(json.dumps(study.to_dict()))
    return made


@pytest.mark.slow
def test_it_lists_and_draws(run, folder) -> None:
    code, out, _ = run(folder / "sweep.json")
    assert (code, out.splitlines()[0]) == (0, "sweep.json can give")
    assert out.splitlines()[1].split()[0] == "curve"
    code, out, _ = run(folder / "sweep.json", "curve")
    assert (code, out.strip()) == (0, f"wrote {folder / 'sweep-curve.png'}")
    assert (folder / "sweep-curve.png").read_bytes().startswith(b"\x89PNG")
    target = folder / "a.svg"
    assert run(folder / "kinematic.json", "stereonet", "--test", "planar", "-o", target)[0] == 0
    assert "<svg" in target.read_text(encoding="utf-8")


def test_it_says_what_the_studies_draw(run, folder, tmp_path) -> None:
    """`sweep --picture` and `plot sweep.json curve` are one function: the same bytes."""
    assert run(folder / "sweep.json", "curve", "-o", tmp_path / "a.png")[0] == 0
    sk.plot(
        sk.sweep(sk.load(WEDGE), {"slope.face.dip": [60, 80]}, closed_form=True),
        "curve",
        tmp_path / "b.png",
    )
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (("swep.json",), "E147", "Did you mean {folder}/sweep.json?"),
        (("sweep.json", "curves"), "E197", "Did you mean curve? sweep.json can give curve."),
        (("sweep.json", "histogram"), "E273", "prob.json: slopekit prob design.yaml -o DIR"),
        (("sweep.json", "scene"), "E273", "result.json: slopekit run design.yaml -o DIR"),
        (("result.json", "contour"), "E273", "contour wants sweep.json of two keys"),
        (("sweep.json", "curve", "-o", "a.gif"), "E141", "Known: .png, .svg, .pdf."),
        (("sweep.json", "curve", "-o", "a.glb"), "E141", "curve cannot be written as .glb"),
        (("sweep.json", "curve", "-o", "/proc/nowhere/a.png"), "E129", "cannot be written"),
        (
            ("result.json", "factors"),
            "E273",
            "factors wants result.json of many blocks: bench, blocks, topple",
        ),
        (
            ("result.json", "displacement", "--step", "2"),
            "E313",
            "--step says nothing of this displacement",
        ),
        (("sweep.json", "curve", "--test", "planar"), "E313", "--test says nothing of this curve"),
        (
            ("result.json", "stereonet", "--test", "planar"),
            "E313",
            "--test says nothing of this stereonet",
        ),
        (
            ("kinematic.json", "stereonet", "--test", "planer"),
            "E313",
            "Known: planar, wedge, toppling, flexural",
        ),
        (("sweep.json", "curve", "--step", "x"), "E106", "--step is 'x'"),
    ],
)
def test_wrong_use(arguments, code, says, run, folder) -> None:
    given = [folder / arguments[0], *arguments[1:]]
    left, out, err = run(*given)
    assert (left, out) == (2, "")
    assert err.startswith(f"{code} ")
    assert says.format(folder=folder) in " ".join(err.split())
    assert explanation(code)
    assert (
        code == "E147" or max(map(len, err.splitlines())) <= 100
    )  # E147 names a folder of the test


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("", "E340", "x.json is empty"),
        ("\n ", "E340", "x.json is empty"),
        ('{"slopekit": "0.1.0", "kin', "E340", "x.json is not JSON"),
        ('{"slopekit": "0.1.0",\n', "E340", "x.json is not JSON"),
        ("name,dip,dip_direction\na,40,175\n", "E340", "x.json is not JSON"),
        ("slopekit: 1\nkind: wedge\n", "E340", "is not JSON"),
        ('{"slopekit": "0.1.0", "kind": "wedge", "fos": NaN}', "E340", "NaN is no number of JSON"),
        (
            '{"slopekit": "0.1.0", "kind": "wedge", "fos": 1e999}',
            "E340",
            "1e999 is no number of JSON",
        ),
        ("[1, 2]", "E340", "is not of slopekit"),
        ('{"kind": "wedge"}', "E340", "it has no key slopekit"),
        (
            '{"slopekit": "0.1.0", "errors": [{"code": "E101"}]}',
            "E340",
            "faults of a run that failed (E101)",
        ),
        (
            '{"slopekit": "0.1.0", "study": "sweep", "keys": [{}]}',
            "E340",
            "x.json cannot be drawn as curve",
        ),
        (
            '{"slopekit": "0.1.0", "study": "sweep", "keys": [7], "points": 3}',
            "E340",
            "Make it again",
        ),
    ],
)
def test_wrong_files(text, code, says, run, tmp_path) -> None:
    """Never a traceback: what is wrong with the file, on one line."""
    file = tmp_path / "x.json"
    file.write_text(text)
    left, _, err = run(file, "curve")
    assert left == 2
    assert err.startswith(f"{code} ")
    assert says in err
    assert explanation(code)


@pytest.mark.slow
def test_a_key_that_is_missing_is_named(run, folder, tmp_path) -> None:
    """Any one key left out of a document is E340 or does not matter; nothing else happens."""
    whole = json.loads((folder / "sweep.json").read_text())
    codes = set()
    for key in whole:
        if key in ("slopekit", "timing_s", "warnings", "counts", "shape", "disagree"):
            continue
        file = tmp_path / "x.json"
        file.write_text(json.dumps({name: value for name, value in whole.items() if name != key}))
        left, _, err = run(file, "curve", "-o", tmp_path / "x.svg")
        assert left in (0, 2)
        codes.add(err[:4])
    assert codes == {"", "E273", "E340"}


def test_scenes_are_handed_on(run, tmp_path, monkeypatch) -> None:
    """The eight 3-D words go to `solid.scenes` with the options."""
    called = []
    from slopekit.views.solid import scenes

    monkeypatch.setattr(scenes, "draw", lambda *what, **options: called.append((what[1:], options)))
    file = tmp_path / "r.json"
    file.write_text(json.dumps({"slopekit": "0.1.0", "kind": "wedge", "scene": {}}))
    assert run(file, "exploded", "-o", tmp_path / "r.glb")[0] == 0
    assert called == [
        (("exploded", tmp_path / "r.glb", 1), {}),
    ]


def test_folders(run, folder, tmp_path) -> None:
    """Of a folder its result.json, else its only JSON of slopekit; the folder of the picture is made."""
    target = tmp_path / "new" / "deep" / "a.svg"
    assert run(folder, "stereonet", "-o", target)[:2] == (0, f"wrote {target}\n")
    assert run(folder)[1].startswith("result.json can give")
    own = tmp_path / "own"
    own.mkdir()
    left, _, err = run(own)
    assert (left, err[:5], "It holds no JSON." in err) == (2, "E148 ", True)
    (own / "other.json").write_text("{}")
    assert "It holds other.json." in run(own)[2]
    (own / "sweep.json").write_bytes((folder / "sweep.json").read_bytes())
    assert run(own, "curve")[:2] == (0, f"wrote {own / 'sweep-curve.png'}\n")
    (own / "more.json").write_bytes((folder / "sweep.json").read_bytes())
    left, _, err = run(own, "curve")
    assert (left, err[:5], "It holds more.json, sweep.json." in err) == (2, "E148 ", True)


@pytest.mark.parametrize("what", ["curve", "scene"])
def test_our_own_faults_are_not_the_document_s(what, run, folder, tmp_path, monkeypatch) -> None:
    """An attribute that nothing has is a bug of ours: it goes through (exit 5), as in reports."""
    from slopekit.views.charts import sweep_charts
    from slopekit.views.solid import scenes

    def fails(*_given: object, **_options: object) -> None:
        math.pie  # noqa: B018

    monkeypatch.setattr(sweep_charts, "draw_curve", fails)
    monkeypatch.setattr(scenes, "draw", fails)
    source = folder / ("sweep.json" if what == "curve" else "result.json")
    with pytest.raises(AttributeError, match="pie"):
        sk.plot(source, what, tmp_path / "a.png")
    assert run(source, what, "-o", tmp_path / "a.png")[0] == 5


def test_a_changed_document_is_named(folder, tmp_path) -> None:
    """E340 says where the document has another form, for charts, nets and scenes."""
    result = json.loads((folder / "result.json").read_text())
    swept = json.loads((folder / "sweep.json").read_text())
    faces = result["inputs"] | {"friction_angle_deg": ["a", 20.0]}
    for document, what, says in (
        (swept | {"points": swept["points"][:1]}, "curve", "ValueError: 1 points for 2 values"),
        (swept | {"points": 3}, "curve", "TypeError: "),
        (
            swept | {"levels": [{"fos": "x", "what": "y"}]},
            "curve",
            "could not convert string to float: 'x'",
        ),
        (result | {"inputs": faces}, "stereonet", "Error: "),
        (
            result
            | {
                "fos": 3,
                "series": [
                    {"factor": 1.0, "stands": True, "failed_pairs": 0, "displacement_m": None}
                ],
            },
            "reduction",
            "TypeError: ",
        ),
    ):
        with pytest.raises(DesignError) as caught:
            sk.plot(document, what, tmp_path / "a.png")
        assert caught.value.codes == ("E340",)
        assert says in str(caught.value)


def test_a_strength_without_friction_is_no_net() -> None:
    """Where a document lacks the angle of a joint, the net is not offered, and the rest is."""
    bench = {"name": "S1", "plane": "30/175", "strength": "a"}
    document = {
        "slopekit": "0.1.0",
        "kind": "bench",
        "inputs": {"sets": [bench], "strengths": [["a", {}]]},
    }
    assert sk.plot(document) == {}
    document["inputs"]["strengths"] = [["a", {"friction_angle_deg": 40.0}]]
    assert list(sk.plot(document)) == ["stereonet"]


def test_options_that_are_no_numbers(folder, tmp_path) -> None:
    """From Python too: E405, never E340."""
    for step in (1.5, float("inf"), float("nan"), "x"):
        with pytest.raises(DesignError, match="step") as caught:
            sk.plot(folder / "result.json", "mechanism", tmp_path / "a.png", step=step)
        assert caught.value.codes == ("E405",)


def test_without_a_picture_the_words(folder) -> None:
    assert list(sk.plot(folder / "sweep.json")) == ["curve"]
    assert "stereonet" in sk.plot(sk.run(WEDGE))


@pytest.mark.slow
@pytest.mark.parametrize(("ending", "begins"), [("pdf", b"%PDF")])
def test_pictures_of_studies_take_every_ending(ending, begins, monkeypatch, tmp_path) -> None:
    target = tmp_path / f"a.{ending}"
    arguments = [
        "kinematic",
        "examples/joints.csv",
        "--face",
        "65/180",
        "--phi",
        "30",
        "--quiet",
        "--picture",
        target,
    ]
    monkeypatch.setattr("sys.argv", ["slopekit", *map(str, arguments)])
    with pytest.raises(SystemExit) as left:
        main()
    assert not left.value.code
    assert target.read_bytes().startswith(begins)


def test_without_the_extra(run, folder, monkeypatch) -> None:
    monkeypatch.setattr("slopekit.core.extras.find_spec", lambda name: None)
    left, _, err = run(folder / "sweep.json", "curve")
    assert left == 2
    assert err.startswith("E140 drawing needs the extra plot")


@pytest.mark.slow
def test_prob_and_kinematic_draw_with_their_folder(monkeypatch, capsys, tmp_path) -> None:
    """histogram.png lies beside prob.json, which keeps what it draws."""
    arguments = ["prob", path_of("wedge-scatter"), "-n", "200", "--quiet"]
    monkeypatch.setattr("sys.argv", ["slopekit", *map(str, arguments), "-o", str(tmp_path / "p")])
    with pytest.raises(SystemExit):
        main()
    assert capsys.readouterr().err == ""
    assert {file.name for file in (tmp_path / "p").iterdir()} == {
        "prob.json",
        "prob.txt",
        "samples.csv",
        "histogram.png",
    }
    assert sum(json.loads((tmp_path / "p" / "prob.json").read_text())["histogram"]["counts"]) > 190
