"""Progress: what an analysis says of its stages, and the line on a terminal."""

import io
import json
import os
import subprocess
import sys
import time
from contextlib import redirect_stderr

import pytest

import slopekit as sk
from slopekit.cli import progress as room
from slopekit.cli.progress import aside, progress, watched
from slopekit.core.progress import listening, report_stage
from tests.properties.test_not_unique import TWO_BLOCKS


class Terminal(io.StringIO):
    """A terminal that keeps what is written to it."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch) -> Terminal:
    found = Terminal()
    monkeypatch.setattr(sys, "argv", ["slopekit", "run", "bench.yaml"])
    monkeypatch.setattr(room, "_FIRST_S", 0.02)
    monkeypatch.setattr(room, "_EVERY_S", 0.01)
    return found


def test_an_analysis_of_many_blocks_names_its_stages_in_their_order() -> None:
    heard: list[tuple[str, bool]] = []
    factors: list[float] = []

    def hear(stage: str, value: float | None, head: bool) -> None:
        heard.append((stage, head))
        factors.extend([value] if value is not None else [])

    with listening(hear):
        found = sk.run(TWO_BLOCKS)
    heads = [stage for stage, head in heard if head]
    assert heads[0] == "cut"
    assert heads.index("loads") < heads.index("solve") < heads.index("closed form")
    inner = list(dict.fromkeys(stage for stage, head in heard if not head))
    assert inner == ["static bound", "path, strength divided by", "range of the mechanism"]
    assert (
        min(factors) < found.fos.limit < max(factors)
    )  # from a strong start to where the blocks run
    assert factors[0] == pytest.approx(
        found.fos.static_bound / 1.7, rel=1e-6
    )  # in the strength of the design
    report_stage("nobody hears")
    assert heard[-1][0] != "nobody hears"


def test_the_line_has_time_and_stage_and_is_wiped(terminal) -> None:
    with redirect_stderr(terminal), watched():
        report_stage("solve", head=True)
        report_stage("path, strength divided by", 1.23456)
        time.sleep(0.2)
    frames = terminal.getvalue().split("\r")
    assert frames[1].strip() == "0 s  solve: path, strength divided by 1.235"
    assert frames[-1] == ""
    assert frames[-2].strip() == ""
    assert len(frames[-2]) == len(frames[1])  # nothing is left of it


@pytest.mark.parametrize(
    ("label", "said"), [("cases", "cases: 3 of 10"), ("evaluations", "evaluations: 3")]
)
def test_what_is_counted_stands_in_the_line_within_the_terminal(
    terminal, monkeypatch, label, said
) -> None:
    """Of a total that is guessed no share is told: 15 minutes by a first evaluation of 150 guessed took 20 s."""
    monkeypatch.setattr(room, "_columns", lambda _: 40)
    with redirect_stderr(terminal), watched("reading"), progress(label, 10) as advance:
        advance(1)
        advance(2)
        report_stage("path, strength divided by", 1.23456)
        time.sleep(0.2)
    frames = [frame.strip() for frame in terminal.getvalue().split("\r")]
    whole = f"0 s  {said}  reading: path, strength divided by 1.235"
    assert whole[:35] in frames  # of 40 columns, less the last and the blanks before the time
    assert max(map(len, terminal.getvalue().split("\r"))) == 39


def test_what_is_printed_aside_stands_on_a_line_of_its_own(terminal) -> None:
    with redirect_stderr(terminal), watched("pictures"):
        time.sleep(0.1)
        with aside():
            before = terminal.getvalue()
            terminal.write("E140 no plot\n")
        time.sleep(0.1)
    assert before.split("\r")[-2:] == [" " * len(before.split("\r")[-2]), ""]
    after = terminal.getvalue().removeprefix(before).removeprefix("E140 no plot\n")
    assert after.startswith("\r    0 s  pictures")
    with redirect_stderr(terminal), aside():
        pass
    assert terminal.getvalue() == before + "E140 no plot\n" + after


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "templates/wedge.yaml", "--no-pictures"],
        ["plot", "RESULT", "stereonet", "-o", "FOLDER/a.png"],
        ["export", "RESULT", "-o", "FOLDER/a.stl"],
        ["doctor"],
    ],
    ids=lambda given: given[0],
)
def test_every_command_that_may_take_long_is_watched(arguments, monkeypatch, tmp_path) -> None:
    """Reading, drawing, exporting and the self test, not the analysis alone."""
    from contextlib import contextmanager

    from slopekit.cli import common, main, outputs, study_command, tools

    seen = []

    @contextmanager
    def noted(stage: str = ""):
        seen.append(stage)
        yield

    for module in (outputs, study_command, tools):
        monkeypatch.setattr(module, "watched", noted)
    monkeypatch.setattr("slopekit.views.doctor.examination", lambda: ([], True))
    assert common.aside is aside
    if "RESULT" in arguments:
        (tmp_path / "result.json").write_text(
            json.dumps(sk.wedge(dips=("45/115", "45/245")).to_dict())
        )
    argv = [
        word.replace("RESULT", str(tmp_path / "result.json")).replace("FOLDER", str(tmp_path))
        for word in arguments
    ]
    monkeypatch.setattr(sys, "argv", ["slopekit", *argv])
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 0
    assert (
        seen
        == {
            "run": ["reading", ""],
            "plot": ["stereonet"],
            "export": ["export"],
            "doctor": ["self test"],
        }[argv[0]]
    )


def test_what_is_quick_shows_nothing(terminal) -> None:
    with redirect_stderr(terminal), watched():
        report_stage("solve", head=True)
    assert terminal.getvalue() == ""


def test_an_error_wipes_the_line_too(terminal) -> None:
    def fails() -> None:
        with watched():
            time.sleep(0.1)
            raise ZeroDivisionError

    with redirect_stderr(terminal), pytest.raises(ZeroDivisionError):
        fails()
    assert terminal.getvalue().endswith("\r")


@pytest.mark.parametrize("option", ["--json", "--quiet"])
def test_nothing_is_shown_with(option, terminal, monkeypatch) -> None:
    monkeypatch.setattr(sys, "argv", ["slopekit", "run", "bench.yaml", option])
    with redirect_stderr(terminal), watched(), progress("samples", 10) as advance:
        report_stage("solve", head=True)
        advance(5)
        time.sleep(0.1)
    assert terminal.getvalue() == ""


def test_what_is_quick_shows_nothing_where_stderr_is_no_terminal_either() -> None:
    found = subprocess.run(
        [sys.executable, "-m", "slopekit.cli", "run", "templates/wedge.yaml"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=os.path.dirname(os.path.dirname(__file__)),
    )
    assert found.stderr == ""


def test_where_stderr_is_no_terminal_nothing_is_said(monkeypatch) -> None:
    log = io.StringIO()
    monkeypatch.setattr(sys, "argv", ["slopekit", "solve", "bench.yaml"])
    monkeypatch.setattr(room, "_FIRST_S", 0.01)
    with redirect_stderr(log), watched(), progress("samples", 10) as advance:
        advance(5)
        time.sleep(0.1)
    assert log.getvalue() == ""


def test_a_terminal_that_goes_away_does_not_stop_the_numbers(terminal, monkeypatch) -> None:
    def gone(text: str) -> int:
        raise OSError

    monkeypatch.setattr(terminal, "write", gone)
    with redirect_stderr(terminal), watched():
        time.sleep(0.1)
