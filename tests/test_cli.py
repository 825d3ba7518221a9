"""The command as a user runs it: output, JSON, exit codes, what it loads."""

import inspect
import json
import os
import re
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

import slopekit as sk
from slopekit.cli import main
from slopekit.core.options import declared_option
from tests.commands import slopekit

PAPER = ["wedge", "--dips", "45/115", "45/245"]
QUIET = "slides_on_both  1.557  agree  W379 (face, upper, height, c, phi, density)"


def started(*arguments: str, **more) -> subprocess.CompletedProcess:
    """A process of its own, as a shell starts it."""
    return subprocess.run(
        [sys.executable, "-m", "slopekit.cli", *arguments],
        capture_output=True,
        text=True,
        timeout=120,
        **more,
    )


def test_the_sheet_of_the_papers_wedge() -> None:
    run = started(*PAPER)
    assert run.returncode == 0
    assert run.stderr == ""
    lines = run.stdout.splitlines()
    assert max(map(len, lines)) <= 100
    assert "FoS       1.557  PRE-IE\n" in run.stdout
    assert "1.557  Hoek & Bray closed form, forces only     AGREE within 0.0001 %" in run.stdout
    assert "1.587  upper bound (associated flow), not for design" in run.stdout
    assert "J1 45/115  dips 45° toward 115 (ESE)" in run.stdout
    assert "NOT GIVEN example values used: face, upper, height, c, φ, density" in run.stdout
    assert [line[:10].strip() for line in lines[1:] if not line.startswith(" ")] == [
        "PLANES",
        "SIZE",
        "LOADS",
        "STATUS",
        "FoS",
        "NOT GIVEN",
    ]
    assert len(run.stdout.split()) <= 120
    assert not {"FORCES", "MODEL", "MOVES", "TIME"} & {line[:10].strip() for line in lines}


def test_the_full_sheet_has_the_details() -> None:
    short, full = (slopekit(*PAPER, *option).stdout.splitlines() for option in ((), ("--full",)))
    assert max(map(len, full)) <= 100
    assert set(short[1:]) < set(full)
    assert full[0] == f"{short[0]}   sha 3dfd01"
    labels = [line.split("  ")[0].strip() for line in full[1:] if not line.startswith(" ")]
    assert [label.split()[0] for label in labels] == [
        "PLANES",
        "SIZE",
        "LOADS",
        "FORCES",
        "STATUS",
        "FoS",
        "MODEL",
        "MOVES",
        "TIME",
        "SENSITIVITY",
        "NOT",
    ]
    assert "          face 60/180  dips 60° toward 180 (S)" in full


def test_json_is_one_document_with_the_contracts_keys() -> None:
    document = json.loads(slopekit(*PAPER, "--json").stdout)
    assert set(document) >= {
        "slopekit",
        "kind",
        "status",
        "fos",
        "difference",
        "agree",
        "moments_govern",
        "geometry",
        "forces_kn",
        "model",
        "mechanism",
        "inputs",
        "defaults",
        "warnings",
        "timing_s",
    }
    assert document["fos"].keys() == {
        "limit",
        "closed_form",
        "static_bound",
        "all_pairs_failed",
        "lowest",
        "highest",
    }
    assert document["fos"]["all_pairs_failed"] is None
    assert document["geometry"]["line"] == pytest.approx(
        {"trend_deg": 180.0, "plunge_deg": 22.9098}, abs=1e-4
    )
    assert document["geometry"]["areas_m2"].keys() == {"J1", "J2"}
    assert document["forces_kn"].keys() == {"weight", "normal", "water", "driving", "resisting"}
    assert document["model"]["unknowns"] == 6
    assert document["mechanism"]["blocks"] == ["wedge"]
    assert document["timing_s"].keys() >= {"cut", "mesh", "solve", "total"}


def test_the_same_command_gives_the_same_numbers() -> None:
    def run() -> dict:
        return {
            key: value
            for key, value in json.loads(slopekit(*PAPER, "--json").stdout).items()
            if key != "timing_s"
        }

    assert run() == run()


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((), 0),
        (("--accept", "1.5"), 0),
        (("--accept", "1.6"), 1),
        (("--accept", "1.5", "--water", "full"), 1),
        (("--accept-fos", "1.5"), 0),
        (("--accept-fos", "1.6"), 1),
        (("--accept-fos", "1.5", "--accept", "1.6"), 2),
        (("--phi", "0.35"), 2),
        (("--nonsense", "1"), 2),
        (("--c", "5", "--c", "6"), 2),
        (("--picture", "no/such/folder.png"), 2),
        (("--picture", "wedge.jpg"), 2),
        (("--face", "20/180"), 3),
        (("--c", "0", "--phi", "5"), 0),
    ],
)
def test_exit_codes(arguments, code) -> None:
    assert slopekit(*PAPER, *arguments).returncode == code


def test_the_package_is_the_command_too() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "slopekit", "--version"], capture_output=True, text=True, timeout=60
    )
    assert (run.returncode, run.stdout) == (0, f"slopekit {sk.__version__}\n")


def test_a_slope_that_fails_is_an_answer() -> None:
    run = slopekit(*PAPER, "--water", "u=200kPa", "--c", "0", "--json")
    assert run.returncode == 0
    assert json.loads(run.stdout)["fos"]["limit"] < 1.0


def test_lifted_has_no_number() -> None:
    document = json.loads(slopekit(*PAPER, "--water", "u=400kPa", "--json").stdout)
    assert document["status"] == "lifted"
    assert document["agree"] is True
    assert set(document["fos"].values()) == {None}


def test_faults_go_to_stderr_and_into_the_json() -> None:
    run = started(*PAPER, "--phi", "0.35", "--height", "-3", "--json")
    assert run.returncode == 2
    assert [fault["code"] for fault in json.loads(run.stdout)["errors"]] == ["E116", "E113"]
    assert "E113 phi of J1 is 0.35°, that looks like radians\n     --phi 0.35\n" in run.stderr


def test_options_and_parameters_of_a_wedge_are_declared_once() -> None:
    """What the command takes is what `sk.wedge` takes, in its order; a fault names each as its user wrote it."""
    taken = [
        name
        for name, one in inspect.signature(sk.wedge).parameters.items()
        if declared_option(one) is not None
    ]
    shown = re.findall(r"^  --([\w-]+)", slopekit("wedge", "--help").stdout, re.MULTILINE)
    names = {"forces": "force", "bolts": "bolt", "limits": "limit", "accept": "accept-fos"}
    assert shown[: len(taken)] == [names.get(name, name).replace("_", "-") for name in taken]
    assert shown[len(taken) :] == ["picture", "no-pictures", "json", "full", "quiet", "help"]
    ran = slopekit(*PAPER, "--unit-weight", "2650", "--force", "much", "--force", "500kN@180/10")
    assert "\n     --unit-weight 2650\n" in ran.stderr
    assert "\n     --force much\n" in ran.stderr
    with pytest.raises(sk.DesignError) as refused:
        sk.wedge(("45/115", "45/245"), unit_weight=2650, forces=["much", "500kN@180/10"])
    assert [fault.where for fault in refused.value.faults] == [
        "unit_weight = 2650",
        "forces = much",
    ]


def test_quiet_and_output_folder(tmp_path) -> None:
    run = slopekit(*PAPER, "--quiet", "--no-pictures", "-o", str(tmp_path / "new"))
    assert run.stdout == QUIET + "\n"
    assert json.loads((tmp_path / "new/result.json").read_text())["status"] == "slides_on_both"
    assert (tmp_path / "new/sheet.txt").read_text().startswith("slopekit ")


def test_a_folder_that_cannot_be_written_is_refused_first(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    run = slopekit(*PAPER, "-o", str(tmp_path / "file"))
    assert run.returncode == 2
    assert run.stderr.startswith("E129 ")


def test_explain_and_version() -> None:
    assert slopekit("explain", "e203").stdout.startswith("E203\n")
    assert max(map(len, slopekit("explain", "E113").stdout.splitlines())) <= 100
    unknown = slopekit("explain", "E2O3")
    assert unknown.returncode == 2
    assert "Did you mean E203?" in unknown.stderr
    several = slopekit("explain", "E2O3", "w307", "W999").stderr
    assert several.startswith("E142 E2O3 ")
    assert "\nE142 W999 " in several  # all faults at once
    assert slopekit("--version").stdout == "slopekit 0.1.0\n"


@pytest.mark.parametrize(("columns", "widest"), [(30, 40), (60, 60), (300, 100)])
def test_text_is_folded_to_the_terminal(columns, widest, monkeypatch) -> None:
    """Texts of messages and faults as wide as the terminal, between 40 and the 100 columns of a sheet."""

    class Terminal(StringIO):
        def isatty(self) -> bool:
            return True

        def fileno(self) -> int:
            return 1

    text, faults = Terminal(), Terminal()
    monkeypatch.setattr("os.get_terminal_size", lambda _: os.terminal_size((columns, 24)))
    with redirect_stdout(text), redirect_stderr(faults):
        for arguments in (["explain", "E113"], ["explain", "E2O3" + "3" * 30]):
            monkeypatch.setattr("sys.argv", ["slopekit", *arguments])
            with pytest.raises(SystemExit):
                main()
    lines = [*text.getvalue().splitlines(), *faults.getvalue().splitlines()]
    assert widest - 12 < max(map(len, lines)) <= widest
    assert faults.getvalue().startswith("E142 ")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("typed", "wanted"),
    [
        ("kin", ["kinematic"]),
        ("templates show wedge-", ["wedge-basal", "wedge-scatter"]),
        ("plot result.json ex", ["exploded"]),
    ],
)
def test_the_shell_completes(typed, wanted) -> None:
    words = f"slopekit {typed}"
    asked = {
        "_SLOPEKIT_COMPLETE": "complete_bash",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split()) - 1),
    }
    start = "import sys; sys.argv = ['slopekit']; from slopekit.cli import main; main()"
    ran = subprocess.run(
        [sys.executable, "-c", start],
        env=os.environ | asked,
        capture_output=True,
        text=True,
        check=True,
    )
    assert ran.stdout.split() == wanted


def test_a_wedge_loads_nothing_that_it_does_not_use() -> None:
    """Heavy imports sit inside the functions that need them."""
    heavy = [
        "trimesh",
        "pyvista",
        "matplotlib",
        "ezdxf",
        "scipy",
        "clarabel",
        "pydantic",
        "ruamel",
        "shapely",
        "yaml",
    ]
    heavy.append("_hashlib")  # OpenSSL
    program = (
        "import sys\n"
        "from slopekit.cli import main\n"
        "for how in (['--quiet'], []):\n"
        "    sys.argv = ['slopekit', 'wedge', '--dips', '45/115', '45/245', *how]\n"
        "    try: main()\n"
        "    except SystemExit: pass\n"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60
    )
    assert run.stdout.splitlines()[:1] + run.stdout.splitlines()[-1:] == [QUIET, "[]"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "is_ended_by_python"),
    [
        ("", False),
        ("import cProfile", True),
        ("threading.Thread(target=threading.main_thread().join).start()", True),
    ],
)
def test_a_process_ends_when_all_is_written(before, is_ended_by_python) -> None:
    """Nothing is taken down first, but where something waits for that; output and exit code are the same."""
    program = (
        f"import atexit, sys, threading\n{before}\n"
        "atexit.register(print, 'ended by Python')\n"
        "sys.argv = ['slopekit', 'wedge', '--dips', '45/115', '45/245', '--quiet', '--accept-fos', '3']\n"
        "from slopekit.cli import start\n"
        "start()"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60
    )
    said = ["ended by Python"] if is_ended_by_python else []
    assert (run.returncode, run.stderr) == (1, "")
    assert run.stdout.splitlines()[1:] == said
    assert run.stdout.startswith(QUIET.partition("  W")[0].replace("agree", "agree  not met"))


def test_templates_alone_shows_its_help() -> None:
    ran = slopekit("templates")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout == slopekit("templates", "--help").stdout
    assert "  new   Write a template" in ran.stdout


@pytest.mark.slow
def test_picture(tmp_path, monkeypatch) -> None:
    pytest.importorskip("pyvista")
    target = tmp_path / "wedge.png"
    monkeypatch.delenv("DISPLAY", raising=False)
    run = slopekit(*PAPER, "--picture", str(target), "--quiet")
    assert run.returncode == 0, run.stderr
    assert target.read_bytes().startswith(b"\x89PNG")
    assert target.stat().st_size > 10_000


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@pytest.mark.parametrize(
    ("redirected", "code", "says"),
    [
        (
            "wedge --dips 45/115 45/245 --json > /dev/full",
            2,
            "E129 the output cannot be written: No space left on device",
        ),
        ("wedge --dips 45/115 45/245 >&-", 2, "E129 the output cannot be written: it is closed"),
        ("wedge --dips 45/115 45/245 --quiet 2>&-", 0, ""),
        ("wedge --dips 45/115 2> /dev/full", 2, ""),
    ],
)
def test_streams_that_take_nothing(redirected, code, says, tmp_path) -> None:
    """A full disk is no bug of ours, a closed stdout bad input, a closed stderr no reason to stop."""
    line = f"{sys.executable} -m slopekit.cli {redirected}"
    run = subprocess.run(
        ["bash", "-c", line], capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    assert run.returncode == code
    assert run.stderr.startswith(says)
    assert "Traceback" not in run.stderr
    assert "E599" not in run.stderr


def test_a_file_in_place_of_the_folder_is_said_to_be_one(tmp_path) -> None:
    there = tmp_path / "my.yaml"
    there.write_text("kept", encoding="utf-8")
    run = slopekit("wedge", "--dips", "45/115", "45/245", "-o", str(there))
    assert run.returncode == 2
    assert "my.yaml is a file, not a folder to write to" in run.stderr
    assert there.read_text(encoding="utf-8") == "kept"


def test_without_a_command_the_help_is_printed_as_it_is() -> None:
    run = slopekit()
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr.startswith("Usage: ")
    assert "Try --help" not in run.stderr


@pytest.mark.parametrize("dash", ["–", "—", "−"])
def test_a_dash_that_is_no_hyphen_is_told_apart(dash) -> None:
    """As mail and text programs put them for two hyphens."""
    run = slopekit("wedge", f"{dash}dips", "45/115", "45/245")
    assert run.returncode == 2
    assert f"{dash}dips begins with a dash that is no hyphen: type --dips" in run.stderr


def test_an_empty_name_of_a_folder_is_refused(tmp_path) -> None:
    """`-o "$DIR"` of a variable that is not set wrote into the folder one stood in."""
    run = slopekit(*PAPER, "-o", "", cwd=tmp_path)
    assert run.returncode == 2
    assert run.stderr.startswith("E129 the folder to write to has an empty name")
    assert not list(tmp_path.iterdir())
    assert slopekit(*PAPER, "-o", ".", "--no-pictures", cwd=tmp_path).returncode == 0
    assert (tmp_path / "result.json").is_file()


def test_a_link_that_leads_nowhere_is_said_to(tmp_path) -> None:
    (tmp_path / "wall.yaml").symlink_to("gone.yaml")
    run = slopekit("run", "wall.yaml", cwd=tmp_path)
    assert run.stderr.startswith("E147 wall.yaml leads to gone.yaml, which does not exist")


def test_a_dash_and_an_empty_name_are_no_files(tmp_path) -> None:
    """`run -` said that `- does not exist`, and `run "$FILE"` of a variable that is not set began with two spaces."""
    assert "is read as /dev/stdin" in slopekit("run", "-", cwd=tmp_path).stderr
    assert slopekit("run", "", cwd=tmp_path).stderr.startswith("E147 the name of a file is empty")


def test_a_name_with_a_gap_is_quoted_to_be_typed(tmp_path) -> None:
    run = slopekit("templates", "new", "plane", "my cut.yaml", cwd=tmp_path)
    assert run.stdout == "wrote my cut.yaml; try: slopekit run 'my cut.yaml'\n"


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("library", ["contextlib", "typer", "numpy", "shellingham"])
def test_a_command_that_is_stopped_while_it_loads_ends_quietly(library, tmp_path) -> None:
    """Ctrl-C before the libraries are there: 130 and no traceback, whichever loads just then.

    Some end the process where a KeyboardInterrupt comes up while they load, as the stand-in does.
    """
    stand_in = (
        "import os, time\n"
        "try:\n"
        "    os.kill(os.getpid(), 2)\n"
        "    time.sleep(5)\n"
        "except KeyboardInterrupt:\n"
        "    os.abort()\n"
    )
    (tmp_path / f"{library}.py").write_text(stand_in)
    program = (
        "import sys, runpy\n"
        f"sys.modules.pop({library!r}, None)\n"
        f"sys.path.insert(0, {str(tmp_path)!r})\n"
        "sys.argv = ['slopekit', 'wedge', '--dips', '45/115', '45/245']\n"
        "runpy.run_module('slopekit', run_name='__main__')\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")


@pytest.mark.parametrize("command", ["wedge --dips 45/115 45/245 --json"])
def test_a_pipe_that_closes_is_no_criterion(command, tmp_path) -> None:
    """`slopekit ... | head -1`: 141 as of other programs in a shell, not 1, which says that a criterion is not met."""
    line = f"{sys.executable} -m slopekit.cli {command} | true; exit ${{PIPESTATUS[0]}}"
    run = subprocess.run(
        ["bash", "-c", line], capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    assert (run.returncode, run.stderr) == (141, "")


@pytest.mark.parametrize(
    ("arguments", "codes"),
    [
        (
            ("wedge", "--dips", "45/115", "95/245", "--phi", "30", "--phi", "95", "--c", "-3"),
            ["E100", "E101", "E114", "E115"],
        ),
        (("wedge", "--phi", "3", "--phi", "4"), ["E100", "E100"]),  # no --dips
        (
            ("wedge", "--dips", "45/115", "45/245", "--phi", "30", "--phi", "40", "--hight", "3"),
            ["E100", "E100"],
        ),
        (
            (
                "run",
                "templates/wedge.yaml",
                "--case",
                "a",
                "--case",
                "b",
                "--set",
                "slope.height=-1",
            ),
            ["E100", "E116"],
        ),
        (
            ("run", "nowhere.yaml", "--case", "a", "--case", "b", "--picture", "out.txt"),
            ["E100", "E141", "E147"],
        ),
        (
            (
                "prob",
                "templates/wedge-scatter.yaml",
                "-n",
                "x",
                "--seed",
                "1",
                "--seed",
                "2",
                "--fos",
                "y",
            ),
            ["E100", "E106", "E106"],
        ),
        (("lint", "templates/wedge.yaml", "--case", "a", "--case", "b"), ["E100"]),
        (("run", "templates/wedge.yaml", "-o", "a", "-o", "b"), ["E100"]),
        (("wedge", "--dips", "45/115", "45/245", "--force", "1@180/-5", "--force", "2@180/-5"), []),
    ],
)
def test_an_option_given_twice_hides_no_other_fault(arguments, codes) -> None:
    """Every fault at once; nothing is analysed, and what may be repeated is no fault."""
    done = slopekit(*arguments, cwd=Path(__file__).parents[1])
    assert [
        line.split()[0] for line in done.stderr.splitlines() if re.match(r"E\d{3} ", line)
    ] == codes
    assert (done.returncode, bool(done.stdout)) == ((2, False) if codes else (0, True))
