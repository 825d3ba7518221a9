"""What `slopekit export` refuses and says, and designs that read the meshes it wrote."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.exchange.picking import WrittenBlock
from slopekit.exchange.source import joints_of, pairs_of, source_of
from slopekit.exchange.split import _slab
from tests.commands import slopekit
from tests.exchange.conftest import TEMPLATES


def refused(*arguments, **options) -> sk.Fault:
    with pytest.raises(sk.DesignError) as caught:
        sk.export(*arguments, **options)
    assert len(caught.value.faults) == 1
    return caught.value.faults[0]


@pytest.mark.parametrize(
    ("file", "options", "code", "says"),
    [
        ("x.step", {}, "E141", "the suffix .step is no format"),
        ("x", {}, "E141", "a file without suffix"),
        ("x.stl", {"blocks": ["B1", "B999"]}, "E197", "there is no block B999"),
        ("x.stl", {"what": "pairs"}, "E313", "STL files hold no pairs"),
        ("x.stl", {"what": "blocks,interfaces"}, "E313", "one part at a time"),
        ("x.stl", {"what": "joints"}, "E313", "joints is not a part"),
        ("x.stl", {"what": ","}, "E313", "no part to write"),
        ("x.vtu", {"what": "pairs"}, "E273", "there are no pairs to write"),
        ("x.stl", {"blocks": ["B1"], "moving": True}, "E273", "there are no blocks to write"),
        ("x.obj", {"binary": True}, "E313", "--binary is for STL"),
        (None, {}, "E313", "no file to write"),
        (None, {"split": "here", "split_as": "dxf"}, "E313", "files of a mesh each, not .dxf"),
        ("no/x.stl", {}, "E129", "cannot be written"),
        (None, {"split": "file"}, "E129", "cannot be written"),
    ],
)  # fmt: skip
def test_what_is_refused(result, tmp_path, monkeypatch, file, options, code, says) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    fault = refused(result("bench"), file, **options)
    assert fault.code == code
    assert says in fault.message
    assert not Path("x.stl").exists()


def test_advice_lists_and_guesses(result, tmp_path) -> None:
    assert ".stl .obj .glb .gltf .vtu .dxf" in refused(result("bench"), tmp_path / "x.stp").advice
    assert refused(result("bench"), tmp_path / "x.stl", blocks=["b17"]).advice == "Did you mean B17?"
    assert refused(result("bench"), tmp_path / "x.stl", what="block").advice == "Did you mean blocks?"
    assert ".vtu" in refused(result("bench"), tmp_path / "x.stl", what="pairs").advice


@pytest.mark.parametrize(
    ("content", "code", "says"),
    [
        ("kind: wedge\n", "E340", "it is no JSON"),
        ("[1]", "E340", "no keys"),
        ('{"a": 1}', "E340", "no key slopekit"),
        ('{"slopekit": "0", "errors": []}', "E340", "the faults of a run"),
        ('{"slopekit": "0", "study": "sweep", "points": []}', "E350", "the result of sweep, it holds no blocks"),
        ('{"slopekit": "0", "kind": "wedge", "geometry": {}}', "E350", "holds no scene"),
        ('{"slopekit": "0", "kind": "wedge", "geometry": {}, "scene": {"shapes": 1}}', "E350", "cannot be read"),
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
    sk.export(result("wedge"), tmp_path / "x.vtu", what="blocks,interfaces,pairs")
    design = {
        "slopekit": 1, "kind": "surface", "slip": {"mesh": str(tmp_path / "there.dxf")}, "rock": {"unit_weight": 25},
        "slope": {"profile": [[60, 0], [40, 0], [0, 40], [-20, 40]]}, "strength": {"joint": {"c": 1, "phi": 30}},
    }  # fmt: skip
    with pytest.raises(sk.DesignError, match="extra cad") as caught:
        sk.run(design)
    assert caught.value.codes == ("E140",)


def test_moving_leaves_bedrock_out(result, tmp_path) -> None:
    done = sk.export(result("bench"), tmp_path / "x.obj", what="blocks,interfaces", moving=True)
    assert done.written[0].blocks == 132 - 93
    assert done.written[0].volume_m3 == pytest.approx(987.4750107200935, rel=1e-12)
    one = sk.export(result("bench"), tmp_path / "x.obj", what=["interfaces"], blocks=["B103"])
    assert (one.written[0].interfaces, one.written[0].volume_m3) == (4, None)


def test_curved_bodies_say_what_flat_triangles_leave_out(result, tmp_path) -> None:
    """W376; and no design is written whose slip surface would be facets, W376."""
    done = sk.export(result("sphere"), tmp_path / "x.stl", split=tmp_path / "split")
    codes = [notice.code for notice in done.warnings]
    assert codes == ["W376", "W376"]
    flat, true = done.written[0].volume_m3, result("sphere")["geometry"]["volume_m3"]
    assert f"{(1 - flat / true) * 100:.2g} % less" in done.warnings[0].message
    assert [path.name for path in done.written[1].files] == ["mass.stl"]


@pytest.mark.parametrize(("template", "changes", "tolerance"), [
    ("blocks", {"loads.seismic.k": 0.1, "water.pressures": {"base/B1": "3 kPa"}}, 1e-6),
    ("plane", {}, 1e-6),
    ("wedge", {"loads.seismic.k": 0.1, "water.mode": "full", "loads.forces": ["900kN@200/10"]}, 3e-5),
])  # fmt: skip
def test_the_loop_gives_the_same_factor(tmp_path, template, changes, tolerance) -> None:
    """result -> meshes and blocks.yaml -> run. Two joints of a wedge: single block and assembly agree to 2e-5.

    By forces: the wedge as one block has the bed's limit, 0.764, cohesion of an assembly goes by another rule.
    """
    first = sk.run(TEMPLATES / f"{template}.yaml", set=changes)
    done = sk.export(first, split=tmp_path)
    assert done.warnings == ()
    assert done.files[0].name == "blocks.yaml"
    again = sk.run(done.files[0])
    by_forces = first.forces_only if first.moments_govern else first.fos.limit
    assert again.fos.limit == pytest.approx(by_forces, rel=tolerance)
    assert again.geometry.volume_m3 == pytest.approx(first.geometry.volume_m3, rel=1e-12)


def test_the_loop_of_a_bench(tmp_path) -> None:
    """Rows that slide on one plane between smooth walls: tan φ / tan 45° whatever the node pairs; 1e-6.

    Contacts come back with the same areas, their node pairs do not: quadrilaterals are fanned from their first corner,
    which a mesh does not keep. Where normal forces share themselves out over the pairs, limits mostly differ by 1e-4 to
    7e-3. Where the limit state is not the only one nothing bounds the difference (the template with 3 kPa on S1 and
    k = 0.1 gave 0.688 and 0.497 once), so W376 asks to compare.
    """
    changes = {
        "slope.height": 6, "slope.length": 12, "slope.depth": 5, "slope.origin": [4e6, 5.5e6, 300.0],
        "sets.S1.plane": "45/180", "sets.S2.plane": "90/270", "sets.S3.plane": "80/000", "strength.joint.phi": 0,
    }  # fmt: skip
    first = sk.run(TEMPLATES / "bench.yaml", set=changes)
    done = sk.export(first, split=tmp_path, split_as="obj")
    again = sk.run(done.files[0])
    assert first.fos.limit == pytest.approx(0.9004040442978399, rel=1e-6)  # tan 42°
    assert again.fos.limit == pytest.approx(first.fos.limit, rel=1e-6)
    areas = first.geometry.areas_m2
    assert again.geometry.areas_m2["bedding"] == pytest.approx(areas["S1"], rel=1e-6)
    assert [(notice.code, "compare the factor" in notice.message) for notice in done.warnings] == [("W376", True)]


@pytest.mark.parametrize(("template", "slab"), [("paper-footing", "bedrock_weak_plane"), ("plane", "bedrock_J1")])
def test_slabs_of_bedrock_as_obj(tmp_path, template, slab) -> None:
    """A slab is none of the scene's blocks: its faces have no names, and it is bedrock."""
    first = sk.run(TEMPLATES / f"{template}.yaml")
    sk.export(first, split=tmp_path, split_as="obj")
    groups = [line for line in (tmp_path / f"{slab}.obj").read_text().splitlines() if line.startswith("g ")]
    assert groups == [f"g {slab} bedrock"]


@pytest.mark.parametrize(("template", "changes", "said"), [
    ("blocks", {"strength.smooth.stiffness": {"shear": {"law": "clough-duncan", "k1": 1200, "n": 0.4}}}, ""),
    ("plane", {"strength.bedding.stiffness": {"shear": 2.5e6}}, "kind blocks has its own"),
])  # fmt: skip
def test_the_criterion_carries_over(tmp_path, template, changes, said) -> None:
    """The factor that acceptance judges is the lower of two; same node pairs and stiffness: the same to 1e-4."""
    rules = {"acceptance.rules": ["fos >= 1.01", "fos.all_pairs_failed >= 1", "fos.limit >= 1"]}
    first = sk.run(TEMPLATES / f"{template}.yaml", set={"analysis.criterion": "all-pairs", **rules, **changes})
    assert first.fos.all_pairs_failed is not None
    done = sk.export(first, split=tmp_path)
    assert len(done.warnings) == bool(said)
    assert all(said in notice.message for notice in done.warnings)
    again = sk.run(done.files[0])
    assert again.design.criterion == "all-pairs"
    assert again.design.stiffness == first.design.stiffness
    assert again.fos.all_pairs_failed == pytest.approx(first.fos.all_pairs_failed, rel=1e-4)
    assert [str(rule) for rule in again.design.rules] == [str(rule) for rule in first.design.rules]


def test_an_all_pairs_factor_that_was_not_found_is_said(tmp_path) -> None:
    """Kind blocks finds one, and a design that was not accepted would be."""
    document = sk.run(TEMPLATES / "plane.yaml").to_dict()
    document = {**document, "inputs": {**document["inputs"], "criterion": "all-pairs"}}
    assert "(here none was found)" in sk.export(document, split=tmp_path).warnings[0].message


def test_rules_on_factors_that_blocks_lack_are_said(tmp_path) -> None:
    """A closed form is of wedges; all pairs failed is known only where it is asked for."""
    rules = ["fos >= 1.2", "fos.closed_form >= 1.3", "fos.all_pairs_failed >= 1", "fos.static_bound >= 1"]
    first = sk.run(TEMPLATES / "wedge.yaml", set={"acceptance.rules": rules})
    done = sk.export(first, split=tmp_path)
    (notice,) = done.warnings
    assert notice.code == "W376"
    assert "(fos.closed_form >= 1.3, fos.all_pairs_failed >= 1.0)" in notice.message
    design = sk.load(done.files[0])
    assert [(rule.name, rule.value) for rule in design.rules] == [("fos", 1.2), ("fos.static_bound", 1.0)]
    assert design.criterion == "limit"


def test_bolts_keep_the_numbers_of_the_design(tmp_path) -> None:
    """Active bolts become forces, the second of them is bolt 3; a passive one stays what it is, and the factor too."""
    bolts = ["1e5kN@000/05", "9e5kN@000/05,passive", "2e5kN@000/10"]
    first = sk.wedge(dips=("45/115", "45/245"), bolts=bolts, forces=["50kN@180/00"])
    done = sk.export(first, split=tmp_path)
    assert not done.warnings
    lines = [line for line in done.files[0].read_text().splitlines() if "- {force" in line]
    assert [line.partition("#")[2].strip() for line in lines] == ["force 1", "bolt 1", "bolt 3", "bolt 2"]
    design = sk.load(done.files[0])
    (bolt,) = design.bolts
    assert (bolt.acts, bolt.force_kn, bolt.toward.trend_deg, bolt.toward.plunge_deg) == ("passive", 9e5, 0.0, 5.0)
    assert sk.run(done.files[0]).fos.limit == pytest.approx(first.fos.limit, rel=1e-6)


def test_bolts_of_blocks_keep_their_numbers(tmp_path) -> None:
    """Assemblies number bolts after forces; a block that is not chosen takes its load along."""
    changes = {
        "loads.forces": [{"force": "20 kN", "toward": "090/0", "block": "B2"}],
        "support.bolts": [{"force": "10 kN", "toward": "090/0", "block": block} for block in ("B2", "B1")],
    }
    first = sk.run(TEMPLATES / "blocks.yaml", set=changes)
    done = sk.export(first, split=tmp_path, blocks="base,B2")
    (notice,) = done.warnings
    assert "; 1 of 3 blocks, which were not chosen" in notice.message
    assert "bolt 2, which acts on a block not chosen" in notice.message
    lines = [line for line in done.files[0].read_text().splitlines() if "- {force" in line]
    assert [line.partition("#")[2].strip() for line in lines] == ["force 1", "bolt 1"]


def test_water_of_blocks_that_were_not_chosen_is_left_out(tmp_path) -> None:
    """blocks.yaml names no interface it lacks: it can be run."""
    changes = {"water.pressures": {"base/B1": "3 kPa", "base/B2": "2 kPa"}}
    done = sk.export(sk.run(TEMPLATES / "blocks.yaml", set=changes), split=tmp_path, blocks="base,B2")
    assert sk.load(done.files[0]).pressures_kpa == (("base", "B2", 2.0),)


@pytest.mark.parametrize("changes", [
    {"columns.base_step": 0}, {"loads.seismic": {"k": 0.05, "toward": 90}},
])  # fmt: skip
def test_columns_and_the_blocks_they_are_written_as_have_one_factor(tmp_path, changes) -> None:
    """With and without risers, with loads on single columns or an earthquake into the slope: the same model, 1e-6."""
    first = sk.run(TEMPLATES / "topple.yaml", set={"columns.heights": [3, 5, 4], **changes})
    done = sk.export(first, split=tmp_path)
    assert done.warnings == ()
    assert sk.run(done.files[0]).fos.limit == pytest.approx(first.fos.limit, rel=1e-6)


def test_wet_bases_beside_dry_risers_are_said(tmp_path) -> None:
    changes = {"columns.heights": [3, 5, 4], "water.pressures": {"base": "5 kPa", "sides": "3 kPa"}}
    first = sk.run(TEMPLATES / "topple.yaml", set=changes)
    done = sk.export(first, split=tmp_path)
    assert "dry risers beside wet bases" in done.warnings[0].message
    assert "(C1/bedrock 5 kPa, C2/bedrock 5 kPa)" in done.warnings[0].message
    assert sk.run(done.files[0]).fos.limit < first.fos.limit  # water on the risers pushes the columns out


def test_rows_of_columns_do_not_hold_each_other(tmp_path) -> None:
    """A bolt in row 1 leaves the factor of row 2, the lower one, as it is: no friction between rows.

    Rough rows would share the bolt. The tolerance is that of node pairs in space.
    """
    bolt = [{"force": "60 kN", "toward": "090/20", "block": "C2-1"}]
    changes = {"columns.rows": 2, "columns.heights": [3, 5, 4], "columns.base_step": 0, "support.bolts": bolt}
    first = sk.run(TEMPLATES / "topple.yaml", set=changes)
    done = sk.export(first, split=tmp_path)
    assert "here smooth joints lie between them" in done.warnings[0].message
    assert "compare the factor" in done.warnings[1].message
    assert '"C2-1/C2-2": "between rows"' in done.files[0].read_text()
    again = sk.run(done.files[0])
    assert again.fos.limit == pytest.approx(first.fos.limit, rel=1e-3)


def test_blocks_as_a_text(result, tmp_path) -> None:
    """ "B9" is one block, not B and 9; with commas several, as on the command line."""
    assert sk.export(result("bench"), tmp_path / "x.stl", blocks="B9").written[0].blocks == 1
    assert sk.export(result("bench"), tmp_path / "x.stl", blocks="B1, B7").written[0].blocks == 2
    assert refused(result("bench"), tmp_path / "x.stl", blocks=",").advice.startswith("No block is named")
    assert refused(result("bench"), tmp_path / "x.stl", blocks=[9]).code == "E197"


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


def test_runs_load_nothing_of_exports() -> None:
    heavy = ["ezdxf", "pyvista", "matplotlib", "slopekit.exchange"]
    program = (
        f"import sys; sys.argv = ['slopekit', 'run', {str(TEMPLATES / 'blocks.yaml')!r}, '--json']\n"
        "from slopekit.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert run.stdout.splitlines()[-1] == "[]"
    assert "scene" in json.loads(run.stdout.rpartition("[]")[0])


def test_split_of_some_blocks_says_so(result, tmp_path) -> None:
    done = sk.export(result("bench"), split=tmp_path, moving=True)
    assert "none of these blocks is bedrock" in done.warnings[0].message
    assert len(done.files) == 39


def test_the_command(tmp_path) -> None:
    (tmp_path / "result.json").write_text(json.dumps(sk.wedge(dips=("45/115", "45/245")).to_dict()))
    run = slopekit("export", "result.json", "-o", "wedge.stl", "--split", "parts", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines() == [
        "WROTE     wedge.stl",
        "          STL, metres: 1 block, 209461.496 m³",
        "PRECISION text, every digit of a double",
        "WROTE     parts/blocks.yaml, parts/wedge.stl, parts/bedrock_J1.stl, parts/bedrock_J2.stl",
        "          STL, metres: 1 block, 209461.496 m³",
        "PRECISION text, every digit of a double",
        "try: slopekit run parts/blocks.yaml",
    ]
    wrong = slopekit("export", "result.json", "-o", "wedge.stp", "--json", cwd=tmp_path)
    assert wrong.returncode == 2
    assert json.loads(wrong.stdout)["errors"][0]["code"] == "E141"


@pytest.mark.parametrize("turn", [1, -1])
def test_slabs_of_bedrock_lie_behind_their_joint(turn) -> None:
    """Either way round the joint's corners: 0.25 of 2 m thick, outside the block, not inside out."""
    box = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 2.0) for z in (0.0, 2.0)])
    floor = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])[::turn]
    slab = _slab(floor, WrittenBlock(0, "box", box, np.zeros((0, 3), dtype=np.int64)), "bedrock")
    assert slab.volume == pytest.approx(2.0, rel=1e-12)
    assert (slab.vertices[:, 2].min(), slab.vertices[:, 2].max()) == (-0.5, 0.0)


def test_interfaces_with_several_strengths_have_that_of_the_largest_part() -> None:
    """B1 lies on the base with 7.07 m² of `joint`; 5 m² of `smooth` are put beside it."""
    source = source_of(sk.run(TEMPLATES / "blocks.yaml"))
    shapes = source.scene.shapes
    contacts = shapes.contacts
    first = next(k for k in range(3) if {contacts.plus[k], contacts.minus[k]} == {0, 1})
    other = next(k for k in range(3) if {contacts.plus[k], contacts.minus[k]} == {1, 2})
    plus, minus = contacts.plus.copy(), contacts.minus.copy()
    plus[other], minus[other] = plus[first], minus[first]
    contacts = replace(contacts, plus=plus, minus=minus)
    mixed = replace(source, scene=replace(source.scene, shapes=replace(shapes, contacts=contacts)))
    found = pairs_of(mixed, {}, joints_of(mixed))
    assert found.mixed == ("B1/base",)
    assert found.joint["B1", "base"] == "joint"


@pytest.fixture(scope="module")
def two_cases():
    """A wedge, dry, and 10 m high in another case."""
    design = {
        "slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
        "cases": {"dry": {"accept": "fos >= 1.5"}, "low": {"set": {"slope.height": 10}}},
    }  # fmt: skip
    return sk.run(design)


def test_each_load_case_has_a_file_of_its_own(two_cases, tmp_path) -> None:
    """Against the export of each case alone; from the object, its JSON and its folder alike."""
    done = sk.export(two_cases, tmp_path / "wedge.stl", split=tmp_path / "parts")
    assert [(one.case, one.files[0].relative_to(tmp_path).as_posix()) for one in done.written] == [
        ("dry", "wedge-dry.stl"), ("dry", "parts/dry/blocks.yaml"), ("low", "wedge-low.stl"),
        ("low", "parts/low/blocks.yaml"),
    ]  # fmt: skip
    assert not any(notice.code == "W376" for notice in done.warnings)
    for name, one in two_cases.cases.items():
        alone = sk.export(one, tmp_path / "alone.stl").written[0]
        assert (tmp_path / f"wedge-{name}.stl").read_bytes() == alone.files[0].read_bytes()
        assert "case" not in alone.to_dict()
    (tmp_path / "result.json").write_text(json.dumps(two_cases.to_dict()))
    run = slopekit("export", ".", "-o", "low.stl", "--case", "low", "--json", cwd=tmp_path)
    assert (tmp_path / "low.stl").read_bytes() == (tmp_path / "wedge-low.stl").read_bytes()
    assert [(one["case"], one["files"]) for one in json.loads(run.stdout)["written"]] == [("low", ["low.stl"])]
    run = slopekit("export", ".", "-o", "again.obj", cwd=tmp_path)
    assert [line for line in run.stdout.splitlines() if line.startswith("WROTE")] == [
        "WROTE     again-dry.obj", "WROTE     again-low.obj",
    ]  # fmt: skip


def test_cases_of_one_shape_say_so(two_cases, tmp_path) -> None:
    both = two_cases.to_dict()
    both["cases"]["low"] = both["cases"]["dry"]
    done = sk.export(both, tmp_path / "wedge.stl")
    assert [(notice.code, notice.message) for notice in done.warnings] == [
        ("W376", "the blocks are the same in dry and low: --case NAME writes one")
    ]


@pytest.mark.parametrize(("case", "code", "says"), [("lo", "E197", "Did you mean low?"), ("wet", "E197", "dry, low")])
def test_a_case_that_there_is_not(two_cases, tmp_path, case, code, says) -> None:
    fault = refused(two_cases, tmp_path / "wedge.stl", case=case)
    assert fault.code == code
    assert says in fault.advice
    assert refused(two_cases.cases["dry"], tmp_path / "wedge.stl", case=case).code == "E313"
    assert refused(two_cases, tmp_path / "wedge.stl", blocks="B9").code == "E197"
    study = sk.sweep(sk.load(two_cases.design.source.root.plain()), {"slope.height": [10]}, methods="closed-form")
    assert refused(study, tmp_path / "wedge.stl").code == "E350"
