"""Many tasks, one after the other, on several processes or on a Dask cluster: the same results in the same order.

What is done goes to a journal, line by line, so that an interrupted study goes on where it stopped; a worker that dies
loses no task. Tasks of many rows give arrays, which stand on disk where there are many.
"""

import base64
import hashlib
import json
import multiprocessing
import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from slopekit._version import __version__
from slopekit.core.arrays import NDArray
from slopekit.core.errors import DesignError, Fault, SlopekitError, SolverError, fail, writing

if TYPE_CHECKING:
    from distributed import Client
    from distributed import Future as DaskFuture

_EVERY_S = 1.0
#: What a task gives: JSON values and arrays, as the journal keeps them.
Record: TypeAlias = Any
Advance = Callable[[int], None]
_MOST_LOSSES = 3  # times that workers may die without a task being finished in between
_CONNECT_S = 10.0
_MOST_JOBS = 512
_LAYOUT = 5  # of records, to be raised with them: since 5 all are arrays of rows
_MOST_ROWS_IN_MEMORY = 100_000
_MB = 2**20


class RowArrays(dict[int, Record]):
    """Records of pieces of many rows, by the number of the piece: their arrays are parts of one array of all rows.

    Above 100,000 rows these arrays are files without a name, which end with them: the system keeps in memory what fits.

    Attributes
    ----------
    ends : of the pieces, from 0; pieces : first row and end of each
    arrays : of all rows (n,), by name; 0 where a piece is not done

    >>> columns = RowArrays([0, 2, 3])
    >>> columns[1], columns[0] = {"factor": np.array([1.5])}, {"factor": np.array([1.0, 2.0])}
    >>> columns.arrays["factor"].tolist(), columns[1]["factor"].tolist()
    ([1.0, 2.0, 1.5], [1.5])
    """

    def __init__(self, ends: Sequence[int]) -> None:
        super().__init__()
        self.count, self.pieces = ends[-1], list(pairwise(ends))
        self.arrays: dict[str, NDArray[Any]] = {}

    def __setitem__(self, piece: int, record: Record) -> None:
        rows, views = slice(*self.pieces[piece]), dict(record)
        for name, values in record.items():
            if isinstance(values, np.ndarray):
                if name not in self.arrays:
                    self.arrays[name] = _empty(self.count, values.dtype)
                self.arrays[name][rows] = values
                views[name] = self.arrays[name][rows]
        super().__setitem__(piece, views)


def _empty(count: int, dtype: Any) -> NDArray[Any]:
    """Return an array (n,) of zeros, on disk where there are many.

    Raises
    ------
    DesignError
        E129 where the disk is full.
    """
    if count <= _MOST_ROWS_IN_MEMORY:
        return np.zeros(count, dtype)
    with writing(Path(tempfile.gettempdir())), tempfile.TemporaryFile() as file:
        for _ in range(0, count * dtype.itemsize, _MB):
            file.write(bytes(_MB))  # a map of a file with holes ends the process where the disk is full
        return np.memmap(file, dtype, "r+", shape=(count,))


@dataclass
class Journal:
    """Records of finished tasks by their number.

    Attributes
    ----------
    path : the file; another run (other inputs, seed, version, layout of records) has another name, so that none takes
        what is not its own
    streamed : whether records are written as they come, a second at a time; else only when `save` is called
    held : the records; unwritten : the numbers of those that the file does not have
    """

    path: Path
    key: str
    streamed: bool = True
    held: dict[int, Record] = field(default_factory=dict)
    unwritten: list[int] = field(default_factory=list)
    last: float = field(default_factory=time.monotonic)

    @classmethod
    def of(
        cls, folder: Path, study: str, run: Any, streamed: bool = True, held: dict[int, Record] | None = None
    ) -> "Journal":
        """The journal of a run.

        Parameters
        ----------
        study : its name; run : everything that its records depend on, as JSON values
        """
        text = json.dumps([__version__, _LAYOUT, study, run], sort_keys=True, default=str)
        key = hashlib.sha256(text.encode()).hexdigest()
        return cls(folder / f"{study}-{key[:12]}.journal", key, streamed, {} if held is None else held)

    def read(self, count: int) -> dict[int, Record]:
        """What an earlier run of the same name has done of so many tasks; a last line cut short is passed over."""
        if self.path.is_file():
            with self.path.open(encoding="utf-8") as file:
                for line in file:
                    try:
                        entry = json.loads(line, object_hook=_array_of)
                        if entry["key"] == self.key and 0 <= entry["index"] < count:
                            self.held[entry["index"]] = entry["record"]
                    except (ValueError, KeyError, TypeError):
                        continue
        return self.held

    def keep(self, indices: Sequence[int], records: Sequence[Record]) -> None:
        """Take records in, as they come."""
        for index, record in zip(indices, records, strict=True):
            self.held[index] = record
        self.unwritten += indices
        if self.streamed and time.monotonic() - self.last > _EVERY_S:
            self.save()

    def save(self) -> None:
        """Write what is not yet written.

        Raises
        ------
        DesignError
            E129 where the file cannot be written.
        """
        if not self.unwritten:
            return
        with writing(self.path), self.path.open("a", encoding="utf-8") as file:
            file.write("\n")  # a line that an interruption cut short ends here
            for index in self.unwritten:
                entry = {"key": self.key, "index": index, "record": self.held[index]}
                file.write(f"{json.dumps(entry, default=_text_of)}\n")
        self.unwritten, self.last = [], time.monotonic()

    def remove(self) -> None:
        """The run is complete: its results are written elsewhere."""
        self.path.unlink(missing_ok=True)


def _text_of(array: NDArray[Any]) -> dict[str, str]:
    """Return an array (n,) as JSON values."""
    return {"array": array.dtype.str, "base64": base64.b64encode(array.tobytes()).decode()}


def _array_of(values: dict[str, Any]) -> Any:
    """Return the array that `_text_of` made such values of, other values as they are."""
    if "base64" not in values:
        return values
    return np.frombuffer(base64.b64decode(values["base64"], validate=True), values["array"])


@dataclass(frozen=True)
class Crew:
    """Who does the work.

    Attributes
    ----------
    jobs : processes of this machine; 1 works in the process that asks
    scheduler : address of a Dask scheduler instead, tls://host:8786 or tcp://host:8786; Dask sends pickles, which run
        code where they are read, and over tcp:// neither encrypted nor signed
    """

    jobs: int = 1
    scheduler: str | None = None


ALONE = Crew()


class Interrupted(SlopekitError):
    """Ctrl-C: what is done is kept."""

    exit_code = 130


def checked_crew(jobs: object = 1, scheduler: str | None = None) -> Crew:
    """A crew from what a user gave.

    Raises
    ------
    DesignError
        E313 for a number of jobs that is none, or for more than one kind of workers.

    >>> checked_crew("2")
    Crew(jobs=2, scheduler=None)
    """
    text = str(jobs).strip()
    if not text.isdigit() or not 1 <= int(text) <= _MOST_JOBS:
        message = f"--jobs is {text}, a whole number from 1 to {_MOST_JOBS} is needed"
        fail("E313", message, "", "As many as there are cores is a good choice.")
    if scheduler is not None and int(text) > 1:
        fail("E313", "--jobs and --scheduler exclude each other", "", "Keep one of them.")
    if scheduler is not None and "://" not in scheduler:
        message = f"{scheduler} is not the address of a scheduler"
        fail("E313", message, "", "Write --scheduler tcp://host:8786.")
    return Crew(int(text), scheduler)


def run_all(
    work: Callable[[Any], Record],
    tasks: Sequence[Any],
    crew: Crew = ALONE,
    *,
    journal: Journal | None = None,
    advance: Advance = lambda _: None,
    at_once: int = 8,
    given_up: Record | None = None,
) -> list[Record]:
    """The record of every task, in the order of the tasks, whoever did them.

    Parameters
    ----------
    work : a function that pickles (of a module, or an instance with `__call__`); returns JSON values and arrays
    journal : where records are kept as they come; those that it holds already are not asked for again
    advance : told how many tasks are done
    at_once : tasks that a worker takes at a time; results do not depend on it
    given_up : the record of a task over which workers die again and again; without one that is an error

    Raises
    ------
    Interrupted
        Ctrl-C: E304, with what is done in the journal.
    DesignError
        E301 no connection to the scheduler or workers with another slopekit, E140 Dask is not installed.
    SolverError
        E303 workers die again and again.

    >>> run_all(abs, [-1, 2, -3])
    [1, 2, 3]
    """
    done: dict[int, Record] = {} if journal is None else journal.read(len(tasks))
    advance(len(done))
    open_tasks = [index for index in range(len(tasks)) if index not in done]

    def keep(indices: Sequence[int], records: Sequence[Record]) -> None:
        if journal is None:
            done.update(zip(indices, records, strict=True))
        else:
            journal.keep(indices, records)
        advance(len(indices))

    try:
        if open_tasks and crew == Crew():
            for index in open_tasks:
                keep([index], [work(tasks[index])])
        elif open_tasks:
            chunks = [open_tasks[at : at + at_once] for at in range(0, len(open_tasks), at_once)]
            _on_workers(work, tasks, chunks, crew, done, keep, given_up)
    except KeyboardInterrupt:
        raise Interrupted([_interrupted(len(done), len(tasks), journal)]) from None
    except BaseException:
        if journal is not None:
            journal.save()  # what is done is not lost with what went wrong
        raise
    if journal is not None and journal.streamed:
        journal.save()
    return [done[index] for index in range(len(tasks))]


def _interrupted(done: int, total: int, journal: Journal | None) -> Fault:
    if journal is None:
        return Fault("E304", f"interrupted after {done} of {total}", "", "Nothing was asked to be kept.")
    if not done:
        return Fault("E304", f"interrupted before the first of {total} was done", "", "The same command starts anew.")
    journal.save()
    message = f"interrupted: {done} of {total} are done and kept"
    return Fault("E304", message, str(journal.path), "The same command goes on from there.")


def _on_workers(
    work: Callable[[Any], Record], tasks: Sequence[Any], chunks: list[list[int]], crew: Crew,
    done: Mapping[int, Record], keep: Callable[[Sequence[int], Sequence[Record]], None], given_up: Record | None,
) -> None:  # fmt: skip
    """Hand out the chunks; where workers die, hand out once more what they had not finished."""
    left, losses = chunks, 0
    while left:
        lost: list[list[int]] = []
        with _executor(crew) as executor:
            futures: dict[Future[list[Record]], list[int]] = {}
            try:
                for chunk in left:
                    futures[executor.submit(_several, work, [tasks[index] for index in chunk])] = chunk
                for future in as_completed(futures):
                    chunk = futures.pop(future)  # with its results, which are kept elsewhere
                    try:
                        keep(chunk, future.result())
                    except BrokenExecutor:
                        lost.append(chunk)
                    except CancelledError:
                        advice = "What is done is kept: the same command goes on."
                        fault = Fault("E301", "the scheduler went away in the middle of the work", "", advice)
                        raise DesignError([fault]) from None
                    except Exception as error:
                        if type(error).__name__ != "KilledWorker":  # Dask's, which need not be installed
                            raise
                        lost.append(chunk)
            except BrokenExecutor:  # no more can be handed in
                lost = [chunk for chunk in left if chunk[0] not in done]
            except BaseException:
                for future in futures:
                    future.cancel()
                raise
        losses = losses + 1 if len(lost) == len(left) else 0
        # one by one: what kills its worker does not take others along
        left = [[index] for chunk in lost for index in chunk if index not in done]
        if losses == _MOST_LOSSES:
            first = left.pop(0)
            if given_up is None:
                message = f"workers died {losses} times over the same tasks, the first of them number {first[0]}"
                advice = "Not enough memory? In a script of your own, call studies below if __name__ == '__main__'."
                raise SolverError([Fault("E303", message, "", advice)])
            keep(first, [given_up])
            losses = 0


def _several(work: Callable[[Any], Record], tasks: Sequence[Any]) -> list[Record]:
    return [work(task) for task in tasks]


@contextmanager
def _executor(crew: Crew) -> Iterator[Executor]:
    with ExitStack() as stack:
        if crew.scheduler is not None:
            yield stack.enter_context(_dask(crew.scheduler))
            return
        # spawned: the same on every system, and no threads of ours are copied half-way
        pool = _Pool(crew.jobs, multiprocessing.get_context("spawn"), _quiet_worker)
        try:
            yield pool
        except BaseException:
            processes = list((pool._processes or {}).values())
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            raise
        pool.shutdown()


def end_with_parent() -> None:
    """End this worker process as soon as the process that started it is gone, however that was ended.

    A worker waits for tasks on a pipe that it holds open itself: it would wait without end, with its memory and with
    the output of the process that is gone.
    """

    def watch(process: Any) -> None:
        process.join()
        os._exit(1)

    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=watch, args=(parent,), name="end with parent", daemon=True).start()


class _Pool(ProcessPoolExecutor):
    """Workers that Ctrl-C, which a terminal sends to all, does not end while they start.

    One that died then broke the pool whose tasks were just called off, and Python waited for it without end.
    """

    def submit(self, fn: Callable[..., Any], /, *args: Any, **keys: Any) -> Future[Any]:
        """A task more; workers begin here, and with the signals that their parent holds back."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            return super().submit(fn, *args, **keys)
        from multiprocessing import resource_tracker

        resource_tracker.ensure_running()  # as it starts it lets Ctrl-C through again
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            return super().submit(fn, *args, **keys)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _quiet_worker() -> None:
    """In a worker: Ctrl-C is for the one who asked, and one core is one core."""
    from threadpoolctl import threadpool_limits

    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)


@contextmanager
def _dask(address: str) -> Iterator[Executor]:
    try:
        from distributed import Client
    except ImportError:
        raise DesignError(
            [Fault("E140", "--scheduler needs Dask, which is not installed", "", "pip install 'slopekit[dask]'")]
        ) from None
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        message = f"no Dask scheduler answers at {address}: {str(error).splitlines()[0] if str(error) else error!r}"
        advice = "Start one with dask scheduler, and workers with dask worker tcp://host:8786."
        raise DesignError([Fault("E301", message, "", advice)]) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_CONNECT_S)
        except TimeoutError:
            advice = "Start workers with dask worker and the address of the scheduler."
            raise DesignError([Fault("E301", f"the scheduler at {address} has no worker", "", advice)]) from None
        answers = client.run(_version_here, on_error="return").values()
        # a worker that went away just now has no version; the others do its work
        wrong = sorted({str(answer) for answer in answers if answer != __version__ and not isinstance(answer, OSError)})
        if wrong:
            message = f"workers of {address} have not this slopekit ({__version__}): {', '.join(wrong)}"
            fail("E301", message, "", "Install the same slopekit on every worker.")
        yield _Cluster(client)


class _Cluster(Executor):
    """Workers of a Dask client.

    Dask's own executor asks how a task is after it has the result, and stops with an error of its own where the worker
    died in between.
    """

    def __init__(self, client: "Client") -> None:
        self.client = client

    def submit(self, fn: Callable[..., Any], /, *args: Any, **keys: Any) -> Future[Any]:
        """A task more; what a dead worker had finished is done again by another."""
        given: Future[Any] = Future()
        asked = self.client.submit(fn, *args, pure=False, **keys)
        given.add_done_callback(lambda one: asked.cancel() if one.cancelled() else None)
        asked.add_done_callback(lambda one: _pass_on(one, given))
        return given


def _pass_on(asked: "DaskFuture", given: Future[Any]) -> None:
    """What became of a task of Dask, to who waits for it."""
    if not given.set_running_or_notify_cancel():
        return
    try:
        given.set_result(asked.result())
    except BaseException as error:  # what went wrong there is for who asked
        given.set_exception(CancelledError() if asked.cancelled() else error)


def _version_here() -> str:
    return __version__
