"""Mutated design files: each must end in a result or a message with a code, never in a traceback.

Run by hand: ``python -m benchmarks.fuzz [count] [seed]`` (10 000 files and seed 20260 where left out). File k of a seed
is always the same file; ``python -m benchmarks.fuzz show K [seed]`` prints it. Each takes the path of `slopekit run`
in process, with every warning an error. ``python -m benchmarks.fuzz studies [count] [seed]`` does the same with surveys
and options of `sets` and `bench-design`.
"""

import json
import multiprocessing
import os
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from benchmarks.fuzz_mutations import Case, case
from benchmarks.fuzz_seeds import SEEDS, write_files
from slopekit.api import analyse
from slopekit.cli.common import load_design as _load
from slopekit.core.errors import SlopekitError
from slopekit.preie.solvers.work_limit import UNITS_PER_SECOND, work_budget

COUNT, SEED = 10_000, 20260
LIMIT_S = 30.0  # of the processor: a run that takes longer is stopped and counts as a failure
#: Units of work that a run may take: what goes on to the limit for all that does work that nobody counts.
WORK = 0.5 * LIMIT_S * UNITS_PER_SECOND


@dataclass(frozen=True)
class Outcome:
    """What became of a case: exit code, codes, status; `stage` is how far it came; `seconds` are of the processor;
    `escaped` must be empty."""

    index: int
    origin: str
    stage: str
    exit_code: int
    codes: tuple[str, ...] = ()
    status: str = ""
    notices: tuple[str, ...] = ()
    seconds: float = 0.0
    escaped: str = field(default="", repr=False)


# -- running ----------------------------------------------------------------------------------------------------------


class TooSlowError(Exception):
    """A run was stopped."""


def _stop(*_: object) -> NoReturn:
    raise TooSlowError(f"still running after {LIMIT_S:g} s")


@contextmanager
def limited() -> Iterator[None]:
    """Stop what takes longer than the limit."""
    signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def run(made: Case, folder: Path, work: float = WORK) -> Outcome:
    """One file through the path of `slopekit run FILE --set …`, with so many units of work allowed."""
    file = folder / f"case-{os.getpid()}.yaml"
    file.write_bytes(made.content)
    began = time.process_time()
    stage, code = "read", 0
    try:
        with limited(), work_budget(work), warnings.catch_warnings():
            warnings.simplefilter("error")
            design = _load(str(file), list(made.sets))
            stage = "analysed"
            result = analyse(design)
            stage = "result"
            json.dumps(result.to_dict(), ensure_ascii=False, indent=1, allow_nan=False)
            str(result)
            code = result.exit_code
    except SlopekitError as error:
        codes = error.codes
        if stage == "read":
            stage = "YAML" if {*codes} & _OF_YAML else "names and values"
        escaped = ""
        if error.exit_code not in (2, 3) or not codes or (stage == "result"):
            escaped = f"{type(error).__name__}: {error}\n{traceback.format_exc(limit=-4)}"
        return Outcome(
            made.index,
            made.origin,
            stage,
            error.exit_code,
            codes,
            seconds=time.process_time() - began,
            escaped=escaped,
        )
    except Exception:  # what the command would call a bug of ours
        return Outcome(
            made.index,
            made.origin,
            stage,
            5,
            ("E599",),
            seconds=time.process_time() - began,
            escaped=traceback.format_exc(limit=-6),
        )
    notices = tuple(notice.code for notice in result.warnings)
    seconds = time.process_time() - began
    status = f"{design.kind} {getattr(result, 'status', 'load cases')}"
    return Outcome(made.index, made.origin, stage, code, (), status, notices, seconds)


_OF_YAML = {"E149", "E150", "E151", "E159", "E160"}


def _work(arguments: tuple[int, int, str, Sequence[str]]) -> Outcome:
    index, seed, folder, names = arguments
    return run(case(index, seed, names), Path(folder))


def outcomes(
    count: int, seed: int = SEED, jobs: int = 1, names: Sequence[str] = tuple(SEEDS)
) -> list[Outcome]:
    """What became of `count` files, made of the designs `names`."""
    with tempfile.TemporaryDirectory() as name:
        write_files(Path(name))
        work = [(index, seed, name, names) for index in range(count)]
        if jobs == 1:
            return [_work(each) for each in work]
        with multiprocessing.Pool(jobs) as pool:
            return pool.map(_work, work, chunksize=20)


def shares(found: Sequence[Outcome]) -> dict[str, float]:
    """Parts of the files: built as a tree (not as text), past YAML, past names and values, with a result."""
    count = len(found)
    return {
        "built as a tree": sum("text:" not in each.origin for each in found) / count,
        "past YAML": sum(each.stage != "YAML" for each in found) / count,
        "to the analysis": sum(each.stage in ("analysed", "result") for each in found) / count,
        "to a result": sum(each.stage == "result" for each in found) / count,
    }


def report(found: Sequence[Outcome]) -> str:
    """The table: exit codes, message codes, statuses, slowest, what escaped."""
    lines = [f"{len(found)} files in {sum(each.seconds for each in found):.0f} s of work"]
    lines += [f"{name:24s}{100 * share:5.1f} %" for name, share in shares(found).items()]
    for title, counts in (
        ("exit codes", Counter(each.exit_code for each in found)),
        ("files by code", Counter(code for each in found for code in set(each.codes))),
        ("notices", Counter(code for each in found for code in set(each.notices))),
        ("statuses", Counter(each.status for each in found if each.status)),
    ):
        cells = [
            f"{key} {number}"
            for key, number in sorted(counts.items(), key=lambda item: str(item[0]))
        ]
        lines += ["", title]
        lines += ["  " + "   ".join(cells[k : k + 8]) for k in range(0, len(cells), 8)]
    lines += ["", "slowest"]
    slow = sorted(found, key=lambda each: -each.seconds)[:8]
    lines += [
        f"  {each.seconds:6.2f} s  {each.index:6d}  {each.origin}  {each.status}" for each in slow
    ]
    failures = [each for each in found if each.escaped]
    lines += ["", f"{len(failures)} escaped"]
    for each in failures:
        last = each.escaped.strip().splitlines()
        lines.append(f"  {each.index:6d}  {each.origin}  {last[-1][:140]}")
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Run, print, and return how many escaped."""
    if arguments and arguments[0] == "show":
        made = case(int(arguments[1]), int(arguments[2]) if len(arguments) > 2 else SEED)
        print(made.content.decode("utf-8", "replace"), *made.sets, sep="\n")
        with tempfile.TemporaryDirectory() as name:
            write_files(Path(name))
            outcome = run(made, Path(name))
        print(outcome, outcome.escaped, sep="\n")
        return 0
    if arguments and arguments[0] == "studies":
        from benchmarks.fuzz_studies import study_outcomes  # which takes `Outcome` from here

        count, seed = ([int(word) for word in arguments[1:]] + [COUNT, SEED][len(arguments) - 1 :])[
            :2
        ]
        with tempfile.TemporaryDirectory() as name:
            done = study_outcomes(count, seed, Path(name))
        print(report(done))
        return sum(bool(each.escaped) for each in done)
    count = int(arguments[0]) if arguments else COUNT
    seed = int(arguments[1]) if len(arguments) > 1 else SEED
    found = outcomes(count, seed, jobs=len(os.sched_getaffinity(0)))
    print(report(found))
    return sum(bool(each.escaped) for each in found)


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1:]) else 0)
