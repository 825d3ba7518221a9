"""Tasks on one process, on several, on Dask: the same records; deaths, interruptions and journals lose nothing."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from slopekit.core.errors import DesignError, SolverError
from slopekit.studies import running
from slopekit.studies.running import (
    ExecutorOptions,
    Interrupted,
    Journal,
    RowArrays,
    checked_crew,
    run_all,
)
from tests.studies.workers import (
    DiesAlways,
    DiesOnce,
    InterruptedAt,
    dies,
    one_over,
    slow_square,
    square,
)

SQUARES = [number * number for number in range(60)]


def test_processes_give_what_one_process_gives() -> None:
    assert run_all(square, range(60)) == SQUARES
    assert run_all(square, range(60), checked_crew(2), at_once=7) == SQUARES


def test_a_worker_that_dies_loses_no_task(tmp_path) -> None:
    told: list[int] = []
    work = DiesOnce(str(tmp_path / "died"), 33)
    assert run_all(work, range(60), checked_crew(2), advance=told.append, at_once=5) == SQUARES
    assert (tmp_path / "died").exists()
    assert sum(told) == 60


@pytest.mark.slow
def test_workers_that_always_die_are_an_error_or_cost_their_task_alone(tmp_path) -> None:
    with pytest.raises(SolverError) as caught:
        run_all(dies, range(3), ExecutorOptions(2), at_once=3)
    assert caught.value.codes == ("E303",)
    found = run_all(DiesAlways(4), range(9), ExecutorOptions(2), at_once=3, given_up="lost")
    assert found == ["lost" if number == 4 else number * number for number in range(9)]


def test_what_goes_wrong_does_not_take_along_what_is_done(tmp_path) -> None:
    journal = Journal.for_run(tmp_path, "prob", 3, streamed=False)
    with pytest.raises(ZeroDivisionError):
        run_all(one_over, [3, 2, 1, 0, 5], journal=journal)
    assert len(Journal.for_run(tmp_path, "prob", 3).read(5)) == 3


def test_an_interrupted_run_goes_on_where_it_stopped(tmp_path) -> None:
    journal = Journal.for_run(tmp_path, "prob", {"seed": 1}, streamed=False)
    with pytest.raises(Interrupted) as caught:
        run_all(InterruptedAt(40), range(60), journal=journal)
    assert caught.value.codes == ("E304",)
    assert caught.value.exit_code == 130
    assert "40 of 60" in str(caught.value)
    again, work, told = Journal.for_run(tmp_path, "prob", {"seed": 1}), InterruptedAt(-1), []
    assert run_all(work, range(60), journal=again, advance=told.append) == SQUARES
    assert work.asked == 20
    assert sum(told) == 60
    other = InterruptedAt(-1)  # another seed is another run
    run_all(
        other, range(60), journal=Journal.for_run(tmp_path, "prob", {"seed": 2}, streamed=False)
    )
    assert other.asked == 60


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="Windows has no such signal")
def test_ctrl_c_as_workers_start_is_for_the_one_who_asked(tmp_path) -> None:
    """A terminal sends it to all: a worker that died of it broke the pool, and Python waited for it without end."""
    script = tmp_path / "script.py"
    script.write_text(
        "import os, signal\n"
        "if __name__ != '__main__':\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "from slopekit.studies.running import ExecutorOptions, run_all\n"
        "if __name__ == '__main__':\n"
        "    print(run_all(abs, [-1, 2, -3], ExecutorOptions(2)), "
        "signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))\n"
    )
    run = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert (run.stdout, run.stderr) == ("[1, 2, 3] False\n", "")


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("number", ["SIGKILL"])
@pytest.mark.parametrize("work", ["pool", "app"])
def test_workers_end_with_the_process_that_started_them(work, number, tmp_path) -> None:
    """They stayed, 106 MB each, and who read their output waited without end."""
    script = tmp_path / "script.py"
    pool = "run_all(late, range(1000), ExecutorOptions(2), at_once=1)"
    app = "jobs = Jobs(); jobs.warm('wedge'); print('ready', flush=True); time.sleep(60)"
    script.write_text(
        "import time\n"
        "from slopekit.app.jobs import Jobs\n"
        "from slopekit.studies.running import ExecutorOptions, run_all\n"
        "from tests.studies.workers import late\n"
        f"if __name__ == '__main__':\n    {pool if work == 'pool' else app}\n"
    )
    path = os.pathsep.join(
        [str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])]
    )
    command = [sys.executable, str(script)]
    given = os.environ | {"PYTHONPATH": path}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, env=given, start_new_session=True
    ) as parent:
        parent.stdout.readline()
        parent.send_signal(getattr(signal, number))
        late_end = threading.Timer(20, os.killpg, (parent.pid, signal.SIGKILL))
        late_end.start()
        parent.stdout.read()  # until no process has the pipe open
        assert late_end.is_alive()
        late_end.cancel()


def test_a_journal_of_records_of_another_layout_is_not_taken(tmp_path, monkeypatch) -> None:
    """Points of older ones have no whole wedge above a basal joint: samples that it fails would count as safe."""
    monkeypatch.setattr(running, "_RECORD_LAYOUT", 1)
    older = Journal.for_run(tmp_path, "prob", "x")
    older.keep([0], [SQUARES[0]])
    older.save()
    assert Journal.for_run(tmp_path, "prob", "x").read(1) == {0: SQUARES[0]}
    monkeypatch.undo()
    assert Journal.for_run(tmp_path, "prob", "x").read(1) == {}


def test_a_journal_that_was_cut_short_is_read_as_far_as_it_goes(tmp_path) -> None:
    journal = Journal.for_run(tmp_path, "sweep", "x")
    for number in range(10):
        journal.keep([number], [SQUARES[number]])
        journal.save()
    text = journal.path.read_text()
    journal.path.write_text(text[: text.rindex('"index": 9') + 12])
    again = Journal.for_run(tmp_path, "sweep", "x")
    assert again.read(60) == dict(enumerate(SQUARES[:9]))
    again.keep([9], [81])
    again.save()
    assert Journal.for_run(tmp_path, "sweep", "x").read(60) == dict(enumerate(SQUARES[:10]))
    again.remove()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("most", [2, 3])
def test_arrays_of_pieces_are_parts_of_columns_in_memory_or_on_disk(
    most, tmp_path, monkeypatch
) -> None:
    """The journal gives them back bit by bit; arrays of another length than their piece are passed over."""
    monkeypatch.setattr(running, "_MOST_ROWS_IN_MEMORY", most)
    factor, outcome = np.array([1.5, np.nan, -0.0]), np.array([2, 0, 1], dtype=np.int16)
    journal = Journal.for_run(tmp_path, "prob", "x", records=RowArrays([0, 1, 3]))
    for piece, rows in ((1, slice(1, 3)), (0, slice(0, 1))):
        journal.keep([piece], [{"words": ["a"], "factor": factor[rows], "outcome": outcome[rows]}])
    journal.save()
    again = Journal.for_run(tmp_path, "prob", "x", records=RowArrays([0, 1, 3]))
    assert again.read(2)[1]["words"] == ["a"]
    for columns in (journal.records, again.records):
        assert columns.arrays["factor"].tobytes() == factor.tobytes()
        assert columns.arrays["outcome"].tobytes() == outcome.tobytes()
        assert columns.arrays["outcome"].dtype == outcome.dtype
        assert isinstance(columns.arrays["factor"], np.memmap) == (most == 2)
    journal.path.write_text(journal.path.read_text().replace(f'"index": {1}', '"index": 0'))
    assert list(Journal.for_run(tmp_path, "prob", "x", records=RowArrays([0, 1, 3])).read(2)) == [0]


def test_a_journal_that_cannot_be_written_says_so(tmp_path) -> None:
    journal = Journal.for_run(tmp_path / "gone", "prob", 1)
    journal.keep([0], [0])
    with pytest.raises(DesignError) as caught:
        journal.save()
    assert caught.value.codes == ("E129",)


@pytest.mark.parametrize(
    ("jobs", "scheduler", "code"),
    [
        ("0", None, "E313"),
        ("two", None, "E313"),
        (2, "tcp://a:1", "E313"),
        (1, "a:1", "E313"),
        (1, "tcp://a:1", "E140"),
    ],
)
def test_crews_that_cannot_be(jobs, scheduler, code, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(DesignError) as caught:
        run_all(square, [1, 2], checked_crew(jobs, scheduler))
    assert caught.value.codes == (code,)


@pytest.fixture
def certificates(tmp_path, monkeypatch) -> Iterator[Path]:
    """A certificate of its own authority, and Dask's configuration that names it."""
    config = pytest.importorskip("dask.config")
    command = [
        "openssl",
        "req",
        "-x509",
        "-newkey",
        "rsa:2048",
        "-nodes",
        "-days",
        "2",
        "-subj",
        "/CN=localhost",
    ]
    made = subprocess.run(
        [*command, "-keyout", "key.pem", "-out", "cert.pem"], cwd=tmp_path, capture_output=True
    )
    if made.returncode:
        pytest.skip("openssl makes no certificate here")
    names = {
        "CA_FILE": "cert.pem",
        **{
            f"{who}__{part.upper()}": f"{part}.pem"
            for who in ("CLIENT", "WORKER", "SCHEDULER")
            for part in ("cert", "key")
        },
    }
    with monkeypatch.context() as patch:
        for name, file in names.items():
            patch.setenv(f"DASK_DISTRIBUTED__COMM__TLS__{name}", str(tmp_path / file))
        config.refresh()
        yield tmp_path
    config.refresh()


@pytest.fixture
def scheduler(certificates):
    """A Dask scheduler with two workers, as a user starts them, over TLS; the workers can be killed."""
    root = Path(__file__).parents[2]
    env = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(root), os.environ.get("PYTHONPATH", "")])
    }
    address = certificates / "scheduler.json"
    quiet = {
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
        "env": env,
        "cwd": certificates,
    }
    dask = [sys.executable, "-m", "dask"]
    place = ["--protocol", "tls", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    started = [
        subprocess.Popen([*dask, "scheduler", *place, "--scheduler-file", str(address)], **quiet)
    ]
    started += [
        subprocess.Popen(
            [
                *dask,
                "worker",
                "--scheduler-file",
                str(address),
                "--nthreads",
                "1",
                "--no-nanny",
                "--no-dashboard",
            ],
            **quiet,
        )
        for _ in range(2)
    ]
    try:
        yield address, started[1:]
    finally:
        for process in reversed(started):
            process.kill()
            process.wait()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("openssl") is None, reason="no openssl")
def test_dask_over_tls_with_a_killed_worker_and_with_none(scheduler, monkeypatch) -> None:
    """The scheduler takes no connection without the certificate; the client finds it by Dask's rules."""

    from slopekit.studies import running

    file, workers = scheduler
    until = time.monotonic() + 30.0
    while not (file.exists() and file.stat().st_size) and time.monotonic() < until:
        time.sleep(0.05)
    address = json.loads(file.read_text())["address"]
    assert address.startswith("tls://")
    killed = threading.Timer(0.5, lambda: workers[0].send_signal(signal.SIGKILL))
    told: list[int] = []

    def advance(count: int) -> None:
        if not told:
            killed.start()  # in the middle of the work
        told.append(count)

    from distributed import Client

    gathered, lost = Client._gather, []

    async def gather_and_lose(self, futures, *args, **keys):
        """The worker dies after its result is there, and before anyone asks how the task is."""
        results = await gathered(self, futures, *args, **keys)
        if not lost and told and len(futures) == 1:
            lost.append(futures[0])
            futures[0]._state.lose()
        return results

    monkeypatch.setattr(Client, "_gather", gather_and_lose)
    crew = checked_crew(1, address)
    assert run_all(slow_square, range(120), crew, advance=advance, at_once=2) == [
        n * n for n in range(120)
    ]
    killed.join()
    assert workers[0].wait(10) == -9
    assert sum(told) == 120
    assert lost
    monkeypatch.setattr(running, "__version__", "another")
    with pytest.raises(DesignError) as caught:
        run_all(square, [1], crew)
    assert caught.value.codes == ("E301",)
    workers[1].kill()
    workers[1].wait()
    monkeypatch.setattr(running, "_CONNECT_S", 1.0)
    with pytest.raises(DesignError) as caught:
        run_all(square, [1], crew)
    assert caught.value.codes == ("E301",)


@pytest.mark.slow
@pytest.mark.parametrize("guard", [False, True])
def test_a_script_without_a_main_guard_is_told_so(tmp_path, guard) -> None:
    """Its workers begin it anew and die; below the guard that the message names it runs."""
    calls = (
        "from slopekit.studies.running import ExecutorOptions, run_all\n"
        "{}print(run_all(abs, [-3, 4], ExecutorOptions(2)))\n"
    )
    script = tmp_path / "my.py"
    script.write_text(calls.format('if __name__ == "__main__":\n    ' if guard else ""))
    ran = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120)
    if guard:
        assert (ran.returncode, ran.stdout, ran.stderr) == (0, "[3, 4]\n", "")
        return
    assert ran.returncode == 1
    assert "E303 workers died" in ran.stderr
    assert "call studies below if __name__ == '__main__'" in ran.stderr
