"""What `slopekit export` refuses and says, and designs that read the meshes it wrote."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import slopekit as sk
from tests.commands import slopekit
from tests.exchange.conftest import TEMPLATES


def refused(*arguments, **options) -> sk.Fault:
    with pytest.raises(sk.DesignError) as caught:
        sk.export(*arguments, **options)
    assert len(caught.value.faults) == 1
    return caught.value.faults[0]


@pytest.mark.parametrize(
    ("file", "code", "says"),
    [
        ("x.step", "E141", "the suffix .step is no format"),
        ("x", "E141", "a file without suffix"),
        ("no/x.stl", "E129", "cannot be written"),
    ],
)
def test_what_is_refused(result, tmp_path, monkeypatch, file, code, says) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    fault = refused(result("bench"), file)
    assert fault.code == code
    assert says in fault.message
    assert not Path("x.stl").exists()


def test_advice_lists_and_guesses(result, tmp_path) -> None:
    assert ".stl .obj .glb .gltf .vtu .dxf" in refused(result("bench"), tmp_path / "x.stp").advice


@pytest.mark.parametrize(
    ("content", "code", "says"),
    [
        ("kind: wedge\n", "E340", "is not JSON"),
        ("[1]", "E340", "it has no key slopekit"),
        ('{"a": 1}', "E340", "no key slopekit"),
        ('{"slopekit": "0", "errors": []}', "E340", "the faults of a run"),
        (
            '{"slopekit": "0", "study": "sweep", "points": []}',
            "E350",
            "the result of sweep, it holds no blocks",
        ),
        ('{"slopekit": "0", "kind": "wedge", "geometry": {}}', "E350", "holds no scene"),
        (
            '{"slopekit": "0", "kind": "wedge", "geometry": {}, "scene": {"shapes": 1}}',
            "E350",
            "cannot be read",
        ),
    ],
)
def test_files_that_hold_no_scene(tmp_path, content, code, says) -> None:
    (tmp_path / "result.json").write_text(content)
    fault = refused(tmp_path / "result.json", tmp_path / "x.stl")
    assert fault.code == code
    assert says in fault.message
    assert fault.advice


def test_a_result_that_is_not_there(tmp_path) -> None:
    assert refused(tmp_path / "result.json", tmp_path / "x.stl").code == "E147"


def test_missing_extras_are_named(result, tmp_path, monkeypatch) -> None:
    """E140: `cad` to write or read DXF; writing VTU needs none."""
    sk.export(result("wedge"), tmp_path / "there.dxf")
    for module in ("ezdxf", "pyvista"):
        monkeypatch.setitem(sys.modules, module, None)
    fault = refused(result("wedge"), tmp_path / "x.dxf")
    assert (fault.code, "extra cad (ezdxf)" in fault.message) == ("E140", True)
    assert not (tmp_path / "x.dxf").exists()
    sk.export(result("wedge"), tmp_path / "x.vtu")
    design = {
        "slopekit": 1,
        "kind": "surface",
        "slip": {"mesh": str(tmp_path / "there.dxf")},
        "rock": {"unit_weight": 25},
        "slope": {"profile": [[60, 0], [40, 0], [0, 40], [-20, 40]]},
        "strength": {"joint": {"c": 1, "phi": 30}},
    }
    with pytest.raises(sk.DesignError, match="extra cad") as caught:
        sk.run(design)
    assert caught.value.codes == ("E140",)


def test_other_objects_are_taken_by_their_document(result, tmp_path) -> None:
    """What has to_dict is a document; the rest is refused as a file would be."""

    class Stored:
        def to_dict(self):
            return result("wedge")

    assert sk.export(Stored(), tmp_path / "x.stl").written[0].blocks == 1
    sweep = sk.sweep(sk.load(TEMPLATES / "wedge.yaml"), {"slope.height": [20, 30]})
    assert refused(sweep, tmp_path / "x.stl").code == "E350"
    for other in (None, 5, [result("wedge")], Stored):
        assert refused(other, tmp_path / "x.stl").code == "E340"


def test_a_folder_stands_for_the_result_in_it(result, tmp_path) -> None:
    assert refused(tmp_path, tmp_path / "x.stl").code == "E148"
    (tmp_path / "result.json").write_text(json.dumps(result("wedge")))
    assert sk.export(tmp_path, tmp_path / "x.stl").written[0].blocks == 1
    run = slopekit("export", ".", "-o", "y.stl", "--quiet", cwd=tmp_path)
    assert (run.returncode, run.stdout) == (0, "y.stl\n")


@pytest.mark.slow
def test_runs_load_nothing_of_exports() -> None:
    heavy = ["ezdxf", "pyvista", "matplotlib", "slopekit.exchange"]
    program = (
        f"import sys; sys.argv = ['slopekit', 'run', {str(TEMPLATES / 'blocks.yaml')!r}, '--json']\n"
        "from slopekit.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60
    )
    assert run.stdout.splitlines()[-1] == "[]"
    assert "scene" in json.loads(run.stdout.rpartition("[]")[0])


@pytest.fixture(scope="module")
def two_cases():
    """A wedge, dry, and 10 m high in another case."""
    design = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        "cases": {"dry": {"accept": "fos >= 1.5"}, "low": {"set": {"slope.height": 10}}},
    }
    return sk.run(design)


@pytest.mark.parametrize(
    ("case", "code", "says"), [("lo", "E197", "Did you mean low?"), ("wet", "E197", "dry, low")]
)
def test_a_case_that_there_is_not(two_cases, tmp_path, case, code, says) -> None:
    fault = refused(two_cases, tmp_path / "wedge.stl", case=case)
    assert fault.code == code
    assert says in fault.advice
    assert refused(two_cases.cases["dry"], tmp_path / "wedge.stl", case=case).code == "E313"
    study = sk.sweep(
        sk.load(two_cases.design.source.root.plain()), {"slope.height": [10]}, closed_form=True
    )
    assert refused(study, tmp_path / "wedge.stl").code == "E350"


def test_curved_bodies_say_what_flat_triangles_leave_out(result, tmp_path) -> None:
    """W376."""
    done = sk.export(result("sphere"), tmp_path / "x.stl")
    assert [notice.code for notice in done.warnings] == ["W376"]
    flat, true = done.written[0].volume_m3, result("sphere")["geometry"]["volume_m3"]
    assert f"{(1 - flat / true) * 100:.2g} % less" in done.warnings[0].message


def test_the_command(tmp_path) -> None:
    (tmp_path / "result.json").write_text(json.dumps(sk.wedge(dips=("45/115", "45/245")).to_dict()))
    run = slopekit("export", "result.json", "-o", "wedge.stl", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines() == [
        "WROTE     wedge.stl",
        "          STL, metres: 1 block, 209461.496 m³",
        "PRECISION text, every digit of a double",
    ]
    wrong = slopekit("export", "result.json", "-o", "wedge.stp", "--json", cwd=tmp_path)
    assert wrong.returncode == 2
    assert json.loads(wrong.stdout)["errors"][0]["code"] == "E141"


def test_each_load_case_has_a_file_of_its_own(two_cases, tmp_path) -> None:
    """Against the export of each case alone; from the object, its JSON and its folder alike."""
    done = sk.export(two_cases, tmp_path / "wedge.stl")
    assert [(one.case, one.files[0].relative_to(tmp_path).as_posix()) for one in done.written] == [
        ("dry", "wedge-dry.stl"),
        ("low", "wedge-low.stl"),
    ]
    assert not any(notice.code == "W376" for notice in done.warnings)
    for name, one in two_cases.cases.items():
        alone = sk.export(one, tmp_path / "alone.stl").written[0]
        assert (tmp_path / f"wedge-{name}.stl").read_bytes() == alone.files[0].read_bytes()
        assert "case" not in alone.to_dict()
    (tmp_path / "result.json").write_text(json.dumps(two_cases.to_dict()))
    run = slopekit("export", ".", "-o", "low.stl", "--case", "low", "--json", cwd=tmp_path)
    assert (tmp_path / "low.stl").read_bytes() == (tmp_path / "wedge-low.stl").read_bytes()
    assert [(one["case"], one["files"]) for one in json.loads(run.stdout)["written"]] == [
        ("low", ["low.stl"])
    ]
    run = slopekit("export", ".", "-o", "again.obj", cwd=tmp_path)
    assert [line for line in run.stdout.splitlines() if line.startswith("WROTE")] == [
        "WROTE     again-dry.obj",
        "WROTE     again-low.obj",
    ]
