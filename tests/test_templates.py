"""Every template runs and gives what its source says; the commands around design files as a user runs them."""

import json
import math
from functools import cache

import pytest

import slopekit as sk
from slopekit.design.registry import KINDS
from slopekit.design.templates import names, path_of, summary
from slopekit.result import Result
from tests.commands import slopekit
from tests.support import result_of

# template: status, limit, tolerance, source
ANSWERS = {
    "wedge": ("slides_on_both", 1.557396, 1e-6, "Hoek & Bray at g = 9.81 (METHOD.md §6)"),
    "paper-wedge": ("slides_on_both", 1.557396, 1e-6, "the same"),
    "plane": (
        "slides_on_J1",
        1.24666,
        1e-4,
        "Wyllie & Mah, ch. 6, as recomputed in cases.json 4a_wm6",
    ),
    "paper-footing": ("slides_on_J1", 4.0 / 3.0, 1e-6, "Sheng et al. 2023, §3.3: K* = 1.3333"),
    # N = (2000 + W) cos 40, T = (2000 + W) sin 40, W = 24 · 8² sin 40 cos 40 / 2: by hand
    "footing": ("slides_on_J1", 1.183727, 1e-6, "limit equilibrium by hand"),
    "paper-ellipsoid": ("rotates", 1.3436, 1e-3, "METHOD.md §5: true normals towards 1.3436"),
    "goodman-bray": (
        "topples",
        0.9999568,
        1e-5,
        "Goodman & Bray: φ required 38.1512°, cases.json 5a",
    ),
    "blocks": ("slides", 3.291798, 1e-5, "cases.json 7c_two_block_1, closed form"),
    "wall": (
        "slides",
        math.tan(math.radians(35)) / math.tan(math.radians(20)),
        1e-5,
        "tan 35 / tan 20",
    ),
    "sphere": (
        "rotates",
        1.4016,
        5e-4,
        "Hungr, Salgado & Byrne 1989 as recomputed in cases.json 6d",
    ),
}


@cache
def ran(name: str) -> Result:
    """A template's result, made once."""
    return result_of(name)


@pytest.mark.parametrize("name", names())
def test_every_template_runs(name) -> None:
    result = ran(name)
    assert result.exit_code in (0, 1)
    assert result.fos.limit is not None
    assert (
        result.fos.static_bound is not None or name == "bench"
    )  # dilating joints lock its key block
    assert result.fos.limit <= (result.fos.static_bound or math.inf) * (1 + 1e-9)
    assert result.agree is not False
    assert json.loads(json.dumps(result.to_dict(), allow_nan=False))["kind"] == result.kind
    assert summary(name)
    if name in ANSWERS:
        status, limit, tolerance, _ = ANSWERS[name]
        assert result.status == status
        assert result.fos.limit == pytest.approx(limit, abs=tolerance)


def test_there_is_a_template_for_every_kind_and_every_example_of_the_paper() -> None:
    kinds = {sk.load(path_of(name)).kind for name in names()}
    assert (
        kinds == set(KINDS) >= {"wedge", "plane", "footing", "surface", "bench", "blocks", "topple"}
    )
    assert {"paper-wedge", "paper-footing", "paper-ellipsoid"} <= set(names())


@pytest.mark.slow
def test_a_wedge_from_a_file_is_the_wedge_of_the_command_line(tmp_path) -> None:
    """Everything but the title and the times: one path."""
    command = [
        "--dips",
        "45/105",
        "70/235",
        "--face",
        "65/185",
        "--upper",
        "12/195",
        "--height",
        "30",
        "--c",
        "24,48",
        "--phi",
        "20,30",
        "--unit-weight",
        "25",
        "--water",
        "50%",
        "--seismic",
        "0.08",
        "--crack",
        "80/185@3m",
        "--bolt",
        "800@005/10,passive",
        "--accept",
        "1.3",
    ]
    (tmp_path / "same.yaml").write_text(
        "slopekit: 1\nkind: wedge\nslope: {face: 65/185, upper: 12/195, height: 30}\n"
        "joints: {J1: {plane: 45/105, strength: a}, J2: {plane: 70/235, strength: b}}\n"
        "strength: {a: {c: 24, phi: 20}, b: {c: 0.048 MPa, phi: 30 deg}}\nrock: {unit_weight: 25}\n"
        "water: {fill: 50 %}\nloads: {seismic: 0.08}\ncrack: {plane: 80/185, distance: 3 m}\n"
        "support: {bolts: [{force: 800, toward: 005/10, acts: passive}]}\nacceptance: {rules: [fos >= 1.3]}\n"
    )
    ours, theirs = (
        json.loads(run.stdout)
        for run in (
            slopekit("wedge", *command, "--json"),
            slopekit("run", "same.yaml", "--json", cwd=tmp_path),
        )
    )
    for document in (ours, theirs):
        del document["timing_s"]
    assert ours == theirs


def test_run_writes_sets_and_judges(tmp_path) -> None:
    assert slopekit("templates", "new", "plane", cwd=tmp_path).stdout == (
        "wrote plane.yaml; try: slopekit run plane.yaml\n"
    )
    assert (
        slopekit("run", "plane.yaml", "--quiet", cwd=tmp_path).stdout
        == "slides_on_J1  1.247  agree  met\n"
    )
    arguments = ("--set", "crack.water=0 m", "--quiet", "--no-pictures", "-o", "out")
    drier = slopekit("run", "plane.yaml", *arguments, cwd=tmp_path)
    assert drier.stdout == "slides_on_J1  1.544  agree  met\n"
    assert (
        json.loads((tmp_path / "out/result.json").read_text())["inputs"]["crack"]["water_m"] == 0.0
    )
    weaker = slopekit("run", "plane.yaml", "--set", "strength.bedding.c=0", "--quiet", cwd=tmp_path)
    assert weaker.returncode == 1
    assert weaker.stdout.endswith("not met\n")
    again = slopekit("templates", "new", "plane", cwd=tmp_path)
    assert again.returncode == 2
    assert again.stderr.startswith("E129 plane.yaml is there already")


@pytest.mark.parametrize(
    ("arguments", "starts"),
    [
        (("run", "wegde.yaml"), "E147 wegde.yaml does not exist"),
        (("run", "wedge.yaml", "--set", "water.fill"), "E160 "),
        (("run", "wedge.yaml", "--set", "strength.weak.phi=0.35"), "E113 "),
        (("run", "wedge.yaml", "--set", "joints.J1.plane=115/45"), "E103 "),
        (("templates", "show", "wegde"), "E197 wegde is not a template\n     Did you mean wedge?"),
        (("templates", "new", "wedge", "no/such/folder.yaml"), "E129 "),
        (("templates", "new", "wedge", "wedge.yaml"), "E129 "),
        (("lint", "wedge.yaml", "--set", "slope.hieght=3"), "E142 hieght is not a key of slope"),
    ],
)
def test_wrong_use_says_what_to_do(tmp_path, arguments, starts) -> None:
    (tmp_path / "wedge.yaml").write_text(path_of("wedge").read_text())
    run = slopekit(*arguments, cwd=tmp_path)
    assert run.returncode == 2
    assert run.stderr.startswith(starts)
    assert run.stdout == ""


def test_lint_reads_and_runs_nothing(tmp_path) -> None:
    good = slopekit("lint", str(path_of("wedge")))
    assert good.returncode == 0
    assert good.stdout.startswith("ok   wedge.yaml: a wedge design, sha ")
    document = json.loads(slopekit("lint", str(path_of("plane")), "--json").stdout)
    assert document["kind"] == "plane"
    assert document["inputs"]["height_m"] == 12.0
    scattered = slopekit(
        "lint", str(path_of("wedge")), "--set", "strength.weak.phi={dist: normal, mean: 20, sd: 2}"
    )
    assert "strength.weak.phi is a distribution: run takes 20" in scattered.stdout


def test_a_corner_of_the_ground_on_the_circle() -> None:
    """The paper's slope meets the cylinder of 40 m about (40, 40) in its toe and its crest.

    By hand: the arc is π R / 2; a segment has its area times the distance of its centroid = chord³ / 12 (textbooks).
    """
    radius, c, weight = 40.0, 30.0, 20.0
    found = sk.run(
        path_of("cylinder"),
        set={
            "slip.radius": radius,
            "strength.shear zone": {"c": c, "phi": 0},
            "rock": {"unit_weight": weight},
        },
    )
    moment = weight * (radius * math.sqrt(2.0)) ** 3 / 12.0 * math.cos(math.pi / 4.0)
    assert found.fos.closed_form == pytest.approx(c * radius**2 * math.pi / 2.0 / moment, rel=1e-9)
    assert found.fos.limit == pytest.approx(found.fos.closed_form, rel=1e-4)


def test_list_and_show() -> None:
    listed = slopekit("templates", "list").stdout.splitlines()
    assert [line.split()[0] for line in listed] == names()
    assert slopekit("templates", "show", "wedge").stdout == path_of("wedge").read_text()


@pytest.mark.slow
def test_doctor_finds_a_sound_machine() -> None:
    run = slopekit("doctor")
    assert run.returncode == 0, run.stdout
    assert run.stdout.endswith("all is well\n")
    assert "1.55739635 and 1.55739635" in run.stdout


def test_sheets_fit_the_page_and_name_what_they_give() -> None:
    for name in names():
        short, full = str(ran(name)), ran(name).sheet.full
        assert max(map(len, full.splitlines())) <= 100
        for label in ("SIZE", "LOADS", "STATUS", "FoS"):
            assert f"\n{label}" in short
            assert f"\n{label}" in full
        for label in ("FORCES", "MODEL", "TIME"):
            assert f"\n{label}" not in short
            assert f"\n{label}" in full
        assert "left out:" in full


@pytest.mark.parametrize("name", ["plane", "bench", "rough"])
def test_a_column_of_forces_has_one_number_of_decimals(name) -> None:
    rows = ran(name).sheet.full.split("\nFORCES")[1].split("\nSTATUS")[0].splitlines()[1:]
    table = [
        row[28:].split()
        for row in rows
        if not row.strip().startswith(("weight", "driving", "resisting"))
    ]
    for column in zip(*table, strict=True):
        assert len({len(cell.partition(".")[2]) for cell in column if cell != "-"}) == 1


def test_half_an_orientation_can_be_set() -> None:
    """`slope.face.dip` is a key of the sweeps of docs/howto/sweep.md."""
    halves = sk.run(
        path_of("wedge"), set={"slope.face.dip": 65, "joints.J1.plane.dip_direction": 110}
    )
    whole = sk.run(path_of("wedge"), set={"slope.face": "65/180", "joints.J1.plane": "45/110"})
    assert halves.fos == whole.fos
    assert halves.design == whole.design


def test_faults_of_yaml_structure_and_values_come_together(tmp_path) -> None:
    (tmp_path / "bad.yaml").write_text(
        "slopekit: 1\nkind: wedge\nkind: wedge\nslope: {hieght: 3}\n"
        "joints: {J1: {plane: 95/115}, J2: {plane: 45/245}}\n"
    )
    with pytest.raises(sk.DesignError) as caught:
        sk.load(tmp_path / "bad.yaml")
    assert caught.value.codes == ("E151", "E142", "E101")
    assert [fault.where.split()[0] for fault in caught.value.faults] == [
        "bad.yaml:3:1",
        "bad.yaml:4:9",
        "bad.yaml:5:22",
    ]


@pytest.mark.parametrize(
    ("bolt", "code"),
    [
        ({"head": [500, 0, 500]}, "E211"),  # in the air, beside the mass
        ({"head": [30, 0, 10], "length": 1}, "E212"),  # ends within the mass
        ({"head": [30, 0, 10], "toward": "090/-10"}, "E211"),  # comes out at the ground surface
    ],
)
def test_bolts_of_a_curved_surface_are_checked(bolt, code) -> None:
    bolts = [{"force": 1000, "toward": "270/10", **bolt}]
    with pytest.raises(sk.GeometryError) as caught:
        sk.run(path_of("paper-ellipsoid"), set={"support": {"bolts": bolts}})
    assert caught.value.codes == (code,)


def test_templates_alone_shows_its_help() -> None:
    alone = slopekit("templates")
    assert (alone.returncode, alone.stderr) == (0, "")
    assert alone.stdout == slopekit("templates", "--help").stdout
