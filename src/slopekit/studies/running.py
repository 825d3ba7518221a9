"""Run many tasks in one process, in several, or on a Dask cluster, with the same results in the same order.

Results go to a journal, line by line, so that an interrupted study continues where it stopped; no task is lost with a
worker that dies. Tasks of many rows give arrays, which are kept on disk where they are large.
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
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    as_completed,
)
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

_SAVE_INTERVAL_S = 1.0
#: The result of a task: JSON values and arrays, as the journal keeps them.
Record: TypeAlias = Any
Advance = Callable[[int], None]
_MOST_LOSSES = 3  # times that workers may die without a task being finished in between
_CONNECT_S = 10.0
_MOST_JOBS = 512
_RECORD_LAYOUT = (
    5  # version of the layout of records, to be raised with it: since 5 all are arrays of rows
)
_MOST_ROWS_IN_MEMORY = 100_000
_MB = 2**20


class RowArrays(dict[int, Record]):
    """Records of pieces of many rows, by the number of the piece; their arrays are views of arrays of all rows.

    Above 100,000 rows these arrays are mapped to temporary files, of which the system keeps in memory what fits.

    Attributes
    ----------
    pieces : first row and end of each piece; count : number of all rows
    arrays : of all rows (n,), by name; 0 where a piece is not finished

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
            file.write(
                bytes(_MB)
            )  # on a full disk, access to the map of a sparse file ends the process
        return np.memmap(file, dtype, "r+", shape=(count,))


@dataclass
class Journal:
    """A file with the records of finished tasks, by their number.

    Attributes
    ----------
    path : the file; its name depends on the run (inputs, seed, version, layout of records), so that no run reads the
        records of another
    streamed : whether records are written as they come, a second at a time; else only when `save` is called
    records : the records; unwritten : the numbers of those that the file does not have
    """

    path: Path
    key: str
    streamed: bool = True
    records: dict[int, Record] = field(default_factory=dict)
    unwritten: list[int] = field(default_factory=list)
    last: float = field(default_factory=time.monotonic)

    @classmethod
    def for_run(
        cls,
        folder: Path,
        study: str,
        run: Any,
        streamed: bool = True,
        records: dict[int, Record] | None = None,
    ) -> "Journal":
        """Return the journal of a run.

        Parameters
        ----------
        study : its name; run : everything that its records depend on, as JSON values
        """
        text = json.dumps([__version__, _RECORD_LAYOUT, study, run], sort_keys=True, default=str)
        key = hashlib.sha256(text.encode()).hexdigest()
        return cls(
            folder / f"{study}-{key[:12]}.journal",
            key,
            streamed,
            {} if records is None else records,
        )

    def read(self, count: int) -> dict[int, Record]:
        """Return the records of an earlier run of the same `count` tasks; a truncated last line is skipped."""
        if self.path.is_file():
            with self.path.open(encoding="utf-8") as file:
                for line in file:
                    try:
                        entry = json.loads(line, object_hook=_array_from_json)
                        if entry["key"] == self.key and 0 <= entry["index"] < count:
                            self.records[entry["index"]] = entry["record"]
                    except (ValueError, KeyError, TypeError):
                        continue
        return self.records

    def keep(self, indices: Sequence[int], records: Sequence[Record]) -> None:
        """Add the records of finished tasks, and save them where a second has passed."""
        for index, record in zip(indices, records, strict=True):
            self.records[index] = record
        self.unwritten += indices
        if self.streamed and time.monotonic() - self.last > _SAVE_INTERVAL_S:
            self.save()

    def save(self) -> None:
        """Write the records that the file does not have yet.

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
                entry = {"key": self.key, "index": index, "record": self.records[index]}
                file.write(f"{json.dumps(entry, default=_array_to_json)}\n")
        self.unwritten, self.last = [], time.monotonic()

    def remove(self) -> None:
        """Delete the file of a complete run, whose results are written elsewhere."""
        self.path.unlink(missing_ok=True)


def _array_to_json(array: NDArray[Any]) -> dict[str, str]:
    """Return an array (n,) as JSON values."""
    return {"array": array.dtype.str, "base64": base64.b64encode(array.tobytes()).decode()}


def _array_from_json(values: dict[str, Any]) -> Any:
    """Return the array of values that `_array_to_json` made; other values as they are."""
    if "base64" not in values:
        return values
    return np.frombuffer(base64.b64decode(values["base64"], validate=True), values["array"])


@dataclass(frozen=True)
class ExecutorOptions:
    """The workers: processes of this machine, or a Dask cluster.

    Attributes
    ----------
    jobs : processes of this machine; 1 runs the tasks in the calling process
    scheduler : address of a Dask scheduler instead, tls://host:8786 or tcp://host:8786; Dask sends pickles, which run
        code where they are read, and over tcp:// neither encrypted nor signed
    """

    jobs: int = 1
    scheduler: str | None = None


ALONE = ExecutorOptions()


class Interrupted(SlopekitError):
    """The study was interrupted by Ctrl-C; finished tasks are kept in the journal."""

    exit_code = 130


def checked_crew(jobs: object = 1, scheduler: str | None = None) -> ExecutorOptions:
    """Return the workers from the options of a user.

    Raises
    ------
    DesignError
        E313 for a number of jobs that is none, or for more than one kind of workers.

    >>> checked_crew("2")
    ExecutorOptions(jobs=2, scheduler=None)
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
    return ExecutorOptions(int(text), scheduler)


def run_all(
    work: Callable[[Any], Record],
    tasks: Sequence[Any],
    crew: ExecutorOptions = ALONE,
    *,
    journal: Journal | None = None,
    advance: Advance = lambda _: None,
    at_once: int = 8,
    given_up: Record | None = None,
) -> list[Record]:
    """Return the record of every task, in the order of the tasks.

    Parameters
    ----------
    work : a function that pickles (of a module, or an instance with `__call__`); returns JSON values and arrays
    journal : keeps records as they come; tasks whose records it has are not run again
    advance : called with the number of tasks that were finished
    at_once : tasks that a worker takes at a time; results do not depend on it
    given_up : the record of a task over which workers die three times; None raises an error then

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
        if open_tasks and crew == ExecutorOptions():
            for index in open_tasks:
                keep([index], [work(tasks[index])])
        elif open_tasks:
            chunks = [
                open_tasks[start : start + at_once] for start in range(0, len(open_tasks), at_once)
            ]
            _on_workers(work, tasks, chunks, crew, done, keep, given_up)
    except KeyboardInterrupt:
        raise Interrupted([_interrupted(len(done), len(tasks), journal)]) from None
    except BaseException:
        if journal is not None:
            journal.save()  # finished tasks are kept whatever the error
        raise
    if journal is not None and journal.streamed:
        journal.save()
    return [done[index] for index in range(len(tasks))]


def _interrupted(done: int, total: int, journal: Journal | None) -> Fault:
    if journal is None:
        return Fault(
            "E304", f"interrupted after {done} of {total}", "", "Nothing was asked to be kept."
        )
    if not done:
        return Fault(
            "E304",
            f"interrupted before the first of {total} was done",
            "",
            "The same command starts anew.",
        )
    journal.save()
    message = f"interrupted: {done} of {total} are done and kept"
    return Fault("E304", message, str(journal.path), "The same command goes on from there.")


def _on_workers(
    work: Callable[[Any], Record],
    tasks: Sequence[Any],
    chunks: list[list[int]],
    crew: ExecutorOptions,
    done: Mapping[int, Record],
    keep: Callable[[Sequence[int], Sequence[Record]], None],
    given_up: Record | None,
) -> None:
    """Give the chunks to workers; where workers die, repeat the tasks that they had not finished."""
    remaining, losses = chunks, 0
    while remaining:
        lost_chunks: list[list[int]] = []
        with _executor(crew) as executor:
            futures: dict[Future[list[Record]], list[int]] = {}
            try:
                for chunk in remaining:
                    futures[
                        executor.submit(_work_on_chunk, work, [tasks[index] for index in chunk])
                    ] = chunk
                for future in as_completed(futures):
                    chunk = futures.pop(future)  # frees the results, which `keep` has
                    try:
                        keep(chunk, future.result())
                    except BrokenExecutor:
                        lost_chunks.append(chunk)
                    except CancelledError:
                        advice = "What is done is kept: the same command goes on."
                        fault = Fault(
                            "E301", "the scheduler went away in the middle of the work", "", advice
                        )
                        raise DesignError([fault]) from None
                    except Exception as error:
                        if (
                            type(error).__name__ != "KilledWorker"
                        ):  # Dask's, which need not be installed
                            raise
                        lost_chunks.append(chunk)
            except BrokenExecutor:  # the pool takes no more tasks
                lost_chunks = [chunk for chunk in remaining if chunk[0] not in done]
            except BaseException:
                for future in futures:
                    future.cancel()
                raise
        losses = losses + 1 if len(lost_chunks) == len(remaining) else 0
        # one by one, so that a task that kills its worker loses no others
        remaining = [[index] for chunk in lost_chunks for index in chunk if index not in done]
        if losses == _MOST_LOSSES:
            first = remaining.pop(0)
            if given_up is None:
                message = f"workers died {losses} times over the same tasks, the first of them number {first[0]}"
                advice = "Not enough memory? In a script of your own, call studies below if __name__ == '__main__'."
                raise SolverError([Fault("E303", message, "", advice)])
            keep(first, [given_up])
            losses = 0


def _work_on_chunk(work: Callable[[Any], Record], tasks: Sequence[Any]) -> list[Record]:
    return [work(task) for task in tasks]


@contextmanager
def _executor(crew: ExecutorOptions) -> Iterator[Executor]:
    with ExitStack() as stack:
        if crew.scheduler is not None:
            yield stack.enter_context(_dask_executor(crew.scheduler))
            return
        # spawned, not forked: the same on every system, and no threads are copied in the middle of their work
        pool = _ProcessPool(crew.jobs, multiprocessing.get_context("spawn"), _quiet_worker)
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


class _ProcessPool(ProcessPoolExecutor):
    """A process pool whose workers ignore Ctrl-C, which a terminal sends to all processes, while they start.

    A worker that died then would break the pool whose tasks were just cancelled, and Python would wait without end.
    """

    def submit(self, fn: Callable[..., Any], /, *args: Any, **keys: Any) -> Future[Any]:
        """Submit a task; workers are started here and inherit the blocked signals of their parent."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            return super().submit(fn, *args, **keys)
        from multiprocessing import resource_tracker

        resource_tracker.ensure_running()  # as it starts it lets Ctrl-C through again
        previous_mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            return super().submit(fn, *args, **keys)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, previous_mask)


def _quiet_worker() -> None:
    """Initialise a worker: it ends with its parent, leaves Ctrl-C to it, and uses one thread."""
    from threadpoolctl import threadpool_limits

    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)


@contextmanager
def _dask_executor(address: str) -> Iterator[Executor]:
    try:
        from distributed import Client
    except ImportError:
        raise DesignError(
            [
                Fault(
                    "E140",
                    "--scheduler needs Dask, which is not installed",
                    "",
                    "pip install 'slopekit[dask]'",
                )
            ]
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
            raise DesignError(
                [Fault("E301", f"the scheduler at {address} has no worker", "", advice)]
            ) from None
        answers = client.run(_version_here, on_error="return").values()
        # a worker that has just left has no version; the others do its work
        other_versions = sorted(
            {
                str(answer)
                for answer in answers
                if answer != __version__ and not isinstance(answer, OSError)
            }
        )
        if other_versions:
            message = f"workers of {address} have not this slopekit ({__version__}): {', '.join(other_versions)}"
            fail("E301", message, "", "Install the same slopekit on every worker.")
        yield _DaskExecutor(client)


class _DaskExecutor(Executor):
    """An executor on the workers of a Dask client.

    Dask's own executor asks for the state of a task after its result, and fails where the worker died in between.
    """

    def __init__(self, client: "Client") -> None:
        self.client = client

    def submit(self, fn: Callable[..., Any], /, *args: Any, **keys: Any) -> Future[Any]:
        """Submit a task; what a dead worker had finished is repeated by another."""
        result: Future[Any] = Future()
        dask_future = self.client.submit(fn, *args, pure=False, **keys)
        result.add_done_callback(
            lambda future: dask_future.cancel() if future.cancelled() else None
        )
        dask_future.add_done_callback(lambda future: _copy_result(future, result))
        return result


def _copy_result(dask_future: "DaskFuture", result: Future[Any]) -> None:
    """Copy the result or the error of a task of Dask to the future that the caller waits for."""
    if not result.set_running_or_notify_cancel():
        return
    try:
        result.set_result(dask_future.result())
    except BaseException as error:  # any error of the task is passed to the caller
        result.set_exception(CancelledError() if dask_future.cancelled() else error)


def _version_here() -> str:
    return __version__
