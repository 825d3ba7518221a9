"""Files come whole or not at all: a limit of the file size (`ulimit -f`) stands for a full disk."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from slopekit.core.whole_files import whole_file, whole_files
from tests.commands import slopekit


def test_a_set_of_files_comes_together_or_not_at_all(tmp_path) -> None:
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(ZeroDivisionError), whole_files(tmp_path) as staging:  # noqa: PT012
        (staging / "a.txt").write_text("new")
        raise ZeroDivisionError
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("a.txt", "old")]
    with whole_files(tmp_path) as staging:
        (staging / "a.txt").write_text("new")
        (staging / "case").mkdir()
        (staging / "case" / "b.txt").write_text("new")
        assert (tmp_path / "a.txt").read_text() == "old"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a.txt", "b.txt", "case"]
    assert (tmp_path / "a.txt").read_text() == "new"


def test_what_cannot_be_replaced_leaves_the_whole_set_as_it_was(tmp_path) -> None:
    (tmp_path / "b.txt").mkdir()
    with pytest.raises(IsADirectoryError), whole_files(tmp_path) as staging:  # noqa: PT012
        (staging / "a.txt").write_text("new")
        (staging / "b.txt").write_text("new")
    assert [path.name for path in tmp_path.iterdir()] == ["b.txt"]


@pytest.mark.skipif(os.name == "nt", reason="links and permissions")
def test_links_permissions_and_devices_stay_what_they_are(tmp_path) -> None:
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    real.chmod(0o640)
    link.symlink_to(real)
    with whole_file(link) as file:
        file.write_text("new")
    assert link.is_symlink()
    assert (real.read_text(), real.stat().st_mode & 0o777) == ("new", 0o640)
    with whole_file(tmp_path / "fresh.txt") as file:
        file.write_text("new")
    (tmp_path / "plain.txt").touch()
    assert (tmp_path / "fresh.txt").stat().st_mode == (tmp_path / "plain.txt").stat().st_mode
    with whole_file(tmp_path / "null.txt") as file:
        (tmp_path / "null.txt").symlink_to(os.devnull)
        file.write_text("gone")
    assert (tmp_path / "null.txt").is_symlink()


def test_a_new_file_replaces_none_that_came_in_the_meantime(tmp_path) -> None:
    target = tmp_path / "a.txt"
    with pytest.raises(FileExistsError), whole_file(target, new=True) as file:  # noqa: PT012
        file.write_text("new")
        target.write_text("another")
    assert target.read_text() == "another"


@pytest.fixture(scope="module")
def worked(tmp_path_factory) -> Path:
    """A folder with a design, its results, and an old file in each place that a command writes to."""
    folder = tmp_path_factory.mktemp("worked")
    (folder / "out").mkdir()
    for suffix in ("stl", "vtu", "dxf", "html", "svg"):
        (folder / "out" / f"a.{suffix}").write_text("old")
    assert slopekit("templates", "new", "wedge", cwd=folder).returncode == 0
    assert (
        slopekit(
            *["run", "wedge.yaml", "-o", "results", "--quiet", "--no-pictures"], cwd=folder
        ).returncode
        == 0
    )
    return folder


@contextmanager
def full_disk() -> Iterator[None]:
    """No byte goes into a file; what commands print is no file here."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="ulimit")
@pytest.mark.parametrize(
    ("command", "kept"),
    [
        ("run wedge.yaml -o results --quiet --no-pictures", "results"),
        ("export results -o out/a.stl", "out"),
        ("export results -o out/a.vtu", "out"),
        ("export results -o out/a.dxf", "out"),
        ("report results -o out/a.html --no-pictures", "out"),
        ("run wedge.yaml --picture out/a.png --quiet", "out"),
        ("plot results stereonet -o out/a.svg", "out"),
        ("templates new wedge out/b.yaml", "out"),
    ],
)
def test_a_disk_that_is_full_leaves_what_was_there(command, kept, worked, tmp_path) -> None:
    """`ulimit -f` cut a sound result.json to 4096 bytes."""
    folder = shutil.copytree(worked, tmp_path / "worked")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with full_disk():
        full = slopekit(*command.split(), cwd=folder)
    assert full.returncode == 2
    assert "E129" in full.stderr
    after = {
        path: path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".journal"
    }
    assert after == before
    assert list(folder.rglob(".slopekit-*")) == []
    assert slopekit(*command.split(), cwd=folder).returncode == 0
    assert {
        path: path.read_bytes() for path in (folder / kept).rglob("*") if path.is_file()
    } != before


@pytest.mark.skipif(os.name == "nt", reason="ulimit")
def test_a_process_of_its_own_meets_a_full_disk(worked, tmp_path) -> None:
    """As the shell starts it, with `ulimit -f`."""
    folder = shutil.copytree(worked, tmp_path / "worked")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    unspoilt = os.environ | {
        "PYTHONDONTWRITEBYTECODE": "1"
    }  # Python itself would leave its own files cut short
    printed = f"ulimit -f 4; exec {sys.executable} -u -m slopekit run wedge.yaml --json > {tmp_path / 'cut.json'}"
    cut = subprocess.run(
        ["bash", "-c", printed], cwd=folder, capture_output=True, text=True, env=unspoilt
    )
    assert cut.returncode == 2
    assert "E129" in cut.stderr
    program = f"ulimit -f 0; exec {sys.executable} -m slopekit run wedge.yaml -o results --quiet --no-pictures"
    full = subprocess.run(
        ["bash", "-c", program], cwd=folder, capture_output=True, text=True, env=unspoilt
    )
    assert full.returncode == 2
    assert "E129" in full.stderr
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
