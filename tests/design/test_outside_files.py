"""What a design may read (SECURITY.md): files of its own folder; no pipe and no device is waited for."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import slopekit as sk
from slopekit.design.reading.on_disk import read_bytes

pytestmark = pytest.mark.skipif(os.name == "nt", reason="links and pipes")
SLAB = """\
slopekit: 1
kind: blocks
rock: {unit_weight: 25}
blocks:
  base: {box: [0, 0, 0, 10, 1, 1], fixed: true}
  slab: {mesh: FILE}
"""
LIST = "slopekit: 1\nkind: wedge\njoints: {csv: FILE}\n"
JOINTS = "name,dip,dip_direction\nJ1,45,115\nJ2,45,245\n"


@pytest.fixture
def folders(tmp_path) -> Path:
    """A folder for the design, with links to a mesh and a list that lie in another."""
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "slab.obj").write_text("o slab\nv 0 0 0\n")
    (tmp_path / "there" / "joints.csv").write_text(JOINTS)
    (tmp_path / "here" / "link.obj").symlink_to("../there/slab.obj")
    (tmp_path / "here" / "link.csv").symlink_to("../there/joints.csv")
    (tmp_path / "here" / "folder").symlink_to("../there")
    return tmp_path


def _faults(path: Path, text: str) -> sk.DesignError:
    path.write_text(text)
    with pytest.raises(sk.DesignError) as caught:
        sk.load(path)
    return caught.value


@pytest.mark.parametrize(
    "file", ["../there/slab.obj", "TMP/there/slab.obj", "link.obj", "folder/slab.obj"]
)
def test_a_mesh_outside_the_folder_of_the_design_is_not_read(file, folders) -> None:
    path = folders / "here" / "slab.yaml"
    error = _faults(path, SLAB.replace("FILE", file.replace("TMP", str(folders))))
    (fault,) = [
        fault for fault in error.faults if "outside the folder of the design" in fault.message
    ]
    assert fault.code == "E172"
    assert "--allow-outside" in fault.advice


@pytest.mark.parametrize("file", ["TMP/there/joints.csv", "link.csv"])
def test_a_joint_list_outside_is_read_where_that_is_allowed(file, folders) -> None:
    path = folders / "here" / "wedge.yaml"
    error = _faults(path, LIST.replace("FILE", file.replace("TMP", str(folders))))
    assert error.codes == ("E148",)
    limit = sk.analyse(sk.load(path, allow_outside=True)).fos.limit
    assert limit == pytest.approx(sk.wedge(dips=("45/115", "45/245")).fos.limit, rel=1e-12)
    assert "SLOPEKIT_ALLOW_OUTSIDE" not in os.environ
    lines = ["--allow-outside", "run", str(path)], ["run", str(path), "--allow-outside"]
    for line in lines if file == "link.csv" else ():
        done = subprocess.run(
            [sys.executable, "-m", "slopekit", *line, "--quiet"], capture_output=True, text=True
        )
        assert f"{limit:.3f}" in done.stdout


def test_studies_of_a_design_with_files_outside_read_them_again(folders) -> None:
    path = folders / "here" / "wedge.yaml"
    path.write_text(LIST.replace("FILE", "../there/joints.csv"))
    design = sk.load(path, allow_outside=True)
    limits = [
        point.factors.limit for point in sk.sweep(design, {"strength.joints.phi": [30, 35]}).points
    ]
    assert limits == [
        pytest.approx(sk.wedge(dips=("45/115", "45/245"), phi=phi).fos.limit) for phi in (30, 35)
    ]
    assert not sk.solve(design, "strength.joints.phi", fos=1.5).line.startswith("none")


def test_what_the_command_line_names_may_lie_anywhere(folders) -> None:
    path = folders / "here" / "wedge.yaml"
    path.write_text(LIST.replace("FILE", "joints.csv"))
    (folders / "here" / "joints.csv").write_text(JOINTS)
    sk.load(path)
    sk.load(path, set={"joints.csv": str(folders / "there" / "joints.csv")})


def test_a_mesh_leads_to_no_further_file(folders) -> None:
    """An OBJ names its materials in files of their own: none is opened."""
    from slopekit.geometry.solids.meshes import mesh_bodies

    mesh = folders / "here" / "one.obj"
    os.mkfifo(folders / "there" / "material.mtl")
    mesh.write_text("mtllib ../there/material.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
    assert len(mesh_bodies(mesh)) == 1


def test_pipes_and_devices_are_not_waited_for(tmp_path) -> None:
    pipe = tmp_path / "pipe.yaml"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero"), Path("/dev/null")):
        with pytest.raises(sk.DesignError, match="is a pipe or a device") as caught:
            read_bytes(path)
        assert caught.value.codes == ("E148",)
    (tmp_path / "slab.yaml").write_text(SLAB.replace("FILE", "pipe.yaml"))
    with pytest.raises(sk.DesignError, match="is a pipe or a device"):
        sk.load(tmp_path / "slab.yaml")
    with pytest.raises(sk.DesignError, match="is a pipe or a device"):
        sk.sets(pipe)


@pytest.mark.slow
def test_what_the_shell_hands_over_is_read(tmp_path) -> None:
    """`<(...)` and /dev/stdin are open already: they are read, up to the size that a file may have."""
    (tmp_path / "wedge.yaml").write_text(
        "slopekit: 1\nkind: wedge\njoints: {J1: {plane: 45/115}, J2: {plane: 45/245}}\n"
    )
    for line in (
        "run <(cat wedge.yaml) --quiet",
        "run /dev/stdin --quiet < wedge.yaml",
        "run /dev/stdin < <(yes)",
    ):
        program = f"{sys.executable} -m slopekit {line}"
        done = subprocess.run(
            ["bash", "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60
        )
        assert "larger than 5 MB" in done.stderr if "yes" in line else "1.557" in done.stdout
