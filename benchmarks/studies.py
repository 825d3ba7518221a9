"""What design studies cost and whether they are right: ``python -m benchmarks.studies [docs]``.

Every time is a ratio to something measured in the same run; `docs` writes docs/studies.md.
"""

import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from slopekit.core.arrays import Floats
from slopekit.design.reading.files import load
from slopekit.design.templates import path_of
from slopekit.studies.evaluation.rows import PIECE, PIECE_OF_CLOSED_FORMS, Rows, outcomes_of_part
from slopekit.studies.evaluation.vectorised import Vectorised, vectorised
from slopekit.studies.keys import key_of, values_of
from slopekit.studies.points import point_of
from slopekit.studies.prob import prob
from slopekit.studies.prob.rows import SampleRows
from slopekit.studies.prob.sampling import METHODS, samples
from slopekit.studies.running import ExecutorOptions, checked_crew, run_all
from slopekit.studies.sweep import sweep

_DOCS = Path(__file__).resolve().parent.parent / "docs"
_MEASURED = """
import resource, sys
import slopekit as sk
from slopekit.design.templates import path_of

found = sk.prob(str(path_of("wedge-scatter")), int(sys.argv[1]), by=sys.argv[2])
found.to_dict()
use = resource.getrusage(resource.RUSAGE_SELF)
print(found.all_samples.share, use.ru_utime + use.ru_stime, use.ru_maxrss / 1024)
"""
_PLAN = """
Nobody has run it; the figures are the rates of this page, times 100,000,000.

- **Chunks.** A task is a pair of row numbers: 2,048 rows by both methods, 65,536 by the closed form, so 48,829
  or 1,526 tasks. A worker draws its rows itself from the seed; what travels is the design (some 20 kB with
  every task) and, back, 11 bytes a row by the closed form, 31 by both methods. Results do not depend on who
  does which task.
- **Time.** Closed form: 4.2 µs of processor a row with all that is said of it, 7 minutes of one core. Both
  methods: 0.15 to 0.2 ms a row, 4 to 6 hours of one core, 20 minutes of 16. Samples that are read one by one
  take 10 to 100 ms: 12 to 120 days of one core. Do not.
- **Scheduler.** On an idle machine Dask took 10 ms for a chunk that does nothing (98 chunks, 0.95 s), against
  0.28 s of work in a chunk of 2,048 rows: 48,829 chunks are 8 minutes of the scheduler, which feeds some 30
  workers. For more workers: chunks of 8,192 rows (`_PIECE` in `studies/prob/run.py`), which cost PRE-IE
  nothing. A worker that dies loses the chunk that it had, no more.
- **Disk.** The columns are a temporary file: 1.1 or 3.1 GB; TMPDIR must not be a file system in memory. The
  journal (with `-o`, or after Ctrl-C) is text of the same arrays, a third larger: 1.5 or 4.1 GB. `samples.csv`
  would have some 250 bytes a row, 25 GB, and be written at 35 µs a row, an hour: ask without `-o`, and let
  `--json` say the rest.
- **Memory.** Workers hold one chunk, 100 to 150 MB with Python and NumPy. The process that asks maps the
  columns (pages that the system may drop) and copies the factors for mean and quantiles: some 32 bytes a row,
  3.2 GB.
- **What stops first.** (1) The limits of `-n`: 10,000,000 by the closed form, 1,000,000 by both. (2) The memory
  of the quantiles, on a machine of 4 GB. They would come from two passes: counts in 65,536 classes, then the
  exact values within the seven classes that hold a quantile. (3) `samples.csv`. (4) The scheduler, beyond some
  30 workers.
- **What it tells.** m failures among n samples give the probability to ± 2 / √m: 400 failures are 10 %.
  100,000,000 rows pay for probabilities below 1e-5 alone, and there the tails of the distributions are guesses.
"""
_AT_ONCE = 2048  # wedges of a chunk, as `prob` hands them on


def normal(mean: float, share: float) -> dict[str, Any]:
    """A normal number that scatters by a share of its mean."""
    return {"dist": "normal", "mean": mean, "sd": mean * share}


def scattering(correlation: bool = False) -> dict[str, Any]:
    """The paper's wedge with 15 numbers that scatter: planes, face, upper slope, height, strengths, weight, water."""

    def plane(dip: float, direction: float) -> dict[str, Any]:
        return {
            "dip": {"dist": "normal", "mean": dip, "sd": 2},
            "dip_direction": {"dist": "normal", "mean": direction, "sd": 3},
        }

    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "joints": {
            "J1": {"plane": plane(45, 115), "strength": "a"},
            "J2": {"plane": plane(45, 245), "strength": "b"},
        },
        "slope": {"face": plane(60, 180), "upper": plane(10, 180), "height": normal(64.89, 0.05)},
        "strength": {
            "a": {"c": normal(50, 0.2), "phi": normal(20, 0.1)},
            "b": {"c": normal(50, 0.2), "phi": normal(20, 0.1)},
        },
        "rock": {"density": normal(2600, 0.02)},
        "water": {"fill": {"dist": "uniform", "min": 0, "max": 1}},
    }
    both = {"J1.phi/J2.phi": 0.5, "J1.c/J1.phi": -0.3, "J2.c/J2.phi": -0.3}
    return wedge | ({"correlation": both} if correlation else {})


def best(work: Callable[[], Any], times: int = 5) -> float:
    """The shortest of a few runs, seconds."""
    taken = []
    for _ in range(times):
        began = time.perf_counter()
        work()
        taken.append(time.perf_counter() - began)
    return min(taken)


def closed_forms(columns: Vectorised, values: Floats) -> None:
    """The closed form of all samples, so many at once as a study takes."""
    for start in range(0, len(values), PIECE_OF_CLOSED_FORMS):
        assert columns.rows(values[start : start + PIECE_OF_CLOSED_FORMS]).closed_form.names


def sampling_rows(n: int = 200_000) -> list[str]:
    """What drawing costs beside evaluating, for every method, with and without correlation."""
    rows = [
        "| samples of 15 numbers | draw, ns | evaluate, ns | draw / evaluate |",
        "|---|---|---|---|",
    ]
    for correlation in (False, True):
        design = load(scattering(correlation))
        for method in METHODS:
            draw = partial(samples, design.variables, design.correlation, n, 1, method)
            drawn = draw()
            fast = vectorised(design, drawn.values, drawn.settings)
            assert fast is not None
            drawing, judging = best(draw), best(partial(closed_forms, fast, drawn.values))
            name = method + (", 3 correlations" if correlation else "")
            rows.append(
                f"| {name} | {drawing / n * 1e9:.0f} | {judging / n * 1e9:.0f} | {drawing / judging:.2f} |"
            )
    return rows


@contextmanager
def cluster(workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A Dask scheduler and its workers on this machine, as a user starts them; these processes, the scheduler first."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        quiet: dict[str, Any] = {
            "stdout": subprocess.DEVNULL,
            "stderr": subprocess.DEVNULL,
            "cwd": folder,
        }
        dask = [sys.executable, "-m", "dask"]
        started = [
            subprocess.Popen(
                [
                    *dask,
                    "scheduler",
                    "--host",
                    "127.0.0.1",
                    "--port",
                    "0",
                    "--no-dashboard",
                    "--scheduler-file",
                    str(file),
                ],
                **quiet,
            )
        ]
        started += [
            subprocess.Popen(
                [
                    *dask,
                    "worker",
                    "--scheduler-file",
                    str(file),
                    "--nthreads",
                    "1",
                    "--no-nanny",
                    "--no-dashboard",
                ],
                **quiet,
            )
            for _ in range(workers)
        ]
        try:
            while not (file.exists() and file.stat().st_size):
                time.sleep(0.05)
            time.sleep(3.0)  # the workers import
            yield json.loads(file.read_text())["address"], started
        finally:
            for process in reversed(started):
                process.kill()
                process.wait()


def wedge_crew_rows(n: int = 200_000) -> list[str]:
    """Samples by both methods, in pieces that each worker draws itself."""
    design = load(scattering())
    rows = SampleRows(design, samples(design.variables, design.correlation, n, 1))
    ends = [*range(0, n, PIECE), n]
    return crew_rows(
        partial(outcomes_of_part, True), [rows.piece(*piece) for piece in pairwise(ends)], n, 1
    )


def bench_crew_rows() -> list[str]:
    """2,000 benches of two blocks, read, cut and solved by itself each: 40 friction angles x 50 earthquakes."""
    design = load(str(path_of("blocks")))
    places = product(np.linspace(25.0, 45.0, 40).tolist(), np.linspace(0.0, 0.2, 50).tolist())
    tasks = [{"strength.joint.phi": phi, "loads.seismic.k": k} for phi, k in places]
    rows = Rows(design, tasks)
    return crew_rows(
        partial(outcomes_of_part, True),
        [rows.piece(k, k + 1) for k in range(len(rows))],
        len(rows),
        8,
    )


def crew_rows(
    work: Callable[[Any], Any], tasks: Sequence[Any], count: int, at_once: int
) -> list[str]:
    """The same tasks by one process, two, Dask with two workers, one of them killed half-way; tasks that do nothing."""
    rows = [
        "| crew | rows | seconds | against one process | seconds of processor |",
        "|---|---|---|---|---|",
    ]
    alone, base, processes = "", 0.0, list[subprocess.Popen[bytes]]()

    def row(
        name: str, crew: ExecutorOptions, advance: Callable[[int], None] = lambda _: None
    ) -> None:
        nonlocal alone, base
        began, processor = time.perf_counter(), _processor(processes)
        records = run_all(work, tasks, crew, advance=advance, at_once=at_once)
        taken = time.perf_counter() - began
        found = json.dumps(records, default=lambda array: array.tobytes().hex())
        alone, base = alone or found, base or taken
        assert found == alone, "another crew, other numbers"
        used = _processor(processes) - processor
        rows.append(f"| {name} | {count:,} | {taken:.1f} | {base / taken:.2f} | {used:.1f} |")

    row("one process", ExecutorOptions())
    row("two processes (their start included)", checked_crew(2))
    with cluster(2) as (address, started):
        processes, workers = started, started[1:]
        dask = checked_crew(1, address)
        run_all(work, tasks[: 4 * at_once], dask, at_once=at_once)  # the workers import
        row("Dask, two workers", dask)
        began = _processor(started)
        run_all(id, tasks, dask, at_once=at_once)
        idle = _processor(started) - began
        done = 0

        def kill_half_way(finished: int) -> None:
            nonlocal done
            done += finished
            if done > len(tasks) / 2 and workers[0].poll() is None:
                workers[0].send_signal(signal.SIGKILL)

        processes = [started[0], started[2]]
        row("Dask, one of two killed half-way (its processor time left out)", dask, kill_half_way)
        assert workers[0].wait(10) == -signal.SIGKILL
    chunks = -(-len(tasks) // at_once)
    said = f"{chunks} chunks that do nothing took {idle:.2f} s of processor: {idle / chunks * 1e3:.2g} ms each, "
    load_average = os.getloadavg()[0]
    return [
        *rows,
        "",
        f"{said}{idle / count * 1e6:.2g} µs a row. Load average at the end: {load_average:.0f}.",
    ]


def memory_rows() -> list[str]:
    """Processor time and most memory of a process for samples of a template and all that is said of them."""
    rows = [
        "| by | samples | P(FoS < 1) | seconds of processor | most memory, MB |",
        "|---|---|---|---|---|",
    ]
    for n, by in ((1_000_000, "closed-form"), (10_000_000, "closed-form"), (100_000, "pre-ie")):
        command = [sys.executable, "-c", _MEASURED, str(n), by]
        share, seconds, most = subprocess.run(
            command, capture_output=True, text=True, check=True
        ).stdout.split()
        rows.append(
            f"| {by} | {n:,} | {float(share):.5f} | {float(seconds):.0f} | {float(most):.0f} |"
        )
    return rows


def plan_rows() -> list[str]:
    """What 100,000,000 rows would take, by the rates above; on paper."""
    return _PLAN.strip().splitlines()


def prob_rows() -> list[str]:
    """P(F < target) of the default wedge with φ = N(20, 2) against quadrature."""
    from tests.studies.test_probability import by_quadrature, default_wedge

    rows = [
        "| rank correlation | target | quadrature | estimate | 95 % limits | within |",
        "|---|---|---|---|---|---|",
    ]
    for rank in (0.0, 0.8, 1.0):
        for target in (1.0, 1.4, 1.5):
            exact = by_quadrature(target, rank)
            for method in METHODS:
                study = prob(
                    load(default_wedge(rank)), 100_000, method=method, fos=target, by="closed-form"
                )
                found = study.all_samples
                within = found.low <= exact <= found.high
                rows.append(
                    f"| {rank:g} | {target:g} | {exact:.4g} | {found.share:.5f} ({method}) | "
                    f"{found.low:.5f} to {found.high:.5f} | {'yes' if within else 'NO'} |"
                )
    return rows


def both_rows(n: int = 20_000) -> list[str]:
    """Samples of a template by the closed form alone and by both methods, all at once in one process."""
    design = load(str(path_of("wedge-scatter")))
    rows = [
        "| by | samples | P(FoS < 1) | by the closed form | seconds of processor |",
        "|---|---|---|---|---|",
    ]
    for words, by in (("closed form", "closed-form"), ("both methods", "pre-ie")):
        began = _processor()
        study = prob(design, n, by=by)
        other = study.by_closed_form or study.all_samples
        rows.append(
            f"| {words} | {n:,} | {study.all_samples.share:.4f} | {other.share:.4f} | {_processor() - began:.2f} |"
        )
    return rows


def sweep_rows() -> list[str]:
    """Points of a grid all at once, and each as a design of its own."""
    design = load(str(path_of("wedge")))
    keys = [key_of(design, path) for path in ("water.fill", "strength.weak.phi")]
    rows = ["| points | ms of processor each | each by itself | ratio |", "|---|---|---|---|"]
    for side in (20, 100):
        grid = {
            key.path: np.linspace(*ends, side).tolist()
            for key, ends in zip(keys, ((0, 1), (15, 35)), strict=True)
        }
        began = _processor()
        swept = sweep(design, grid)
        taken, began = (_processor() - began) / len(swept.points), _processor()
        some = swept.places[:: len(swept.points) // 100]
        for place in some:
            point_of(design, values_of(design, keys, place))
        alone = (_processor() - began) / len(some)
        rows.append(
            f"| {side * side:,} | {taken * 1e3:.2f} | {alone * 1e3:.2f} | {alone / taken:.0f} |"
        )
    return rows


def set_rows(surveys: int = 20) -> list[str]:
    """How often the number of drawn joint sets is found, by BIC, and what it costs."""
    from scipy.stats import vonmises_fisher

    from slopekit.core.orientation import normals
    from slopekit.studies.sets.clustering import clusters_of, least_bic

    rows = [
        "| drawn sets (K) | joints | anywhere | by BIC | s each, one core |",
        "|---|---|---|---|---|",
    ]
    planes = ((45, 120), (80, 20), (60, 270), (85, 310), (10, 180))
    rng = np.random.default_rng(5)
    cases = [(), (30,), (40, 40), (40, 40, 40), (12, 12, 12), (60, 10, 25), (40,) * 4, (40,) * 5]
    for concentrations, each, anywhere, times in [
        *((some, 30, 10, surveys) for some in cases),
        ((40, 30, 25), 3000, 1000, 1),
    ]:
        by_bic, began, sets = 0, 0.0, len(concentrations)
        anywhere = anywhere if sets else 60
        for _ in range(times):
            loose = rng.normal(size=(anywhere, 3))
            parts = [loose / np.linalg.norm(loose, axis=1)[:, None]]
            for (dip, way), k in zip(planes, concentrations, strict=False):
                parts.append(
                    vonmises_fisher(normals(np.array(dip), np.array(way)), k).rvs(
                        each, random_state=rng
                    )
                )
            poles = np.concatenate(parts)
            start = time.process_time()
            found = clusters_of(poles, np.ones(len(poles)), None, np.random.default_rng(1))
            began += time.process_time() - start
            by_bic += least_bic(found) == sets
        said = f"{sets} ({', '.join(map(str, concentrations))})" if sets else "0"
        rows.append(
            f"| {said} | {sets * each + anywhere} | {anywhere} | {by_bic} of {times} | {began / times:.2g} |"
        )
    return rows


def bench_rows(count: int = 300) -> list[str]:
    """Bench design of 300 joints x 7 faces x 3 heights: processor time of the parts of one process, wall of two."""
    from slopekit.studies.bench_design import bench_design

    rng = np.random.default_rng(4)
    mean = np.array([(54, 142), (60, 226), (78, 4), (24, 176)], dtype=float)[
        rng.integers(0, 4, count)
    ]
    planes = [
        (float(np.clip(dip + 7.0 * one, 1.0, 90.0)), float((direction + 9.0 * two) % 360.0))
        for (dip, direction), one, two in zip(
            mean, rng.standard_normal(count), rng.standard_normal(count), strict=True
        )
    ]
    given: dict[str, Any] = {
        "height": [10, 15, 20],
        "face": "60:90:7",
        "dip_direction": 180,
        "berm": [7, 9],
        "c": 10,
        "phi": 30,
        "spacing": 2,
        "trace": 15,
        "n": 2_000,
    }
    rows = [
        "| both methods | trials in 21 benches | blocks by PRE-IE | moments govern | seconds of processor | seconds |",
        "|---|---|---|---|---|---|",
    ]
    for words, jobs in (("one process", 1), ("two processes (their start included)", 2)):
        began, processor = time.perf_counter(), _processor()
        found = bench_design(planes, jobs=jobs, **given)
        seconds, processor = time.perf_counter() - began, _processor() - processor
        said = found.both
        rows.append(
            f"| {words} | {21 * 2_000:,} | {said.looked_at:,} | {said.governed:,} | {processor:.1f} | {seconds:.1f} |"
        )
    return [*rows, "", f"Load average of the machine at the end: {os.getloadavg()[0]:.0f}."]


def quake_rows(records: int = 20, samples: int = 4000) -> list[str]:
    """Records of 40 s on three slopes, each both ways; a sampled sine against its formula; six degrees of freedom."""
    import slopekit as sk
    from slopekit.studies.quake.records import record_of
    from slopekit.studies.quake.six import slide

    rng, t = np.random.default_rng(2), 0.01 * np.arange(samples)
    made = []
    for k in range(records):
        noise = np.convolve(rng.normal(size=samples), np.hanning(9), "same") * np.exp(
            -(((t - 12.0) / 6.0) ** 2)
        )
        made.append(
            record_of(f"made {k + 1}", t, noise * (0.2 + 0.03 * k) * 9.81 / np.abs(noise).max())
        )
    rows = ["| what | seconds of processor | seconds |", "|---|---|---|"]
    for words, names, given, more in (
        (
            f"{records} records of {samples:,} samples, wedge, plane and blocks",
            ("wedge", "plane", "blocks"),
            made,
            {},
        ),
        (
            "one of them in six degrees of freedom, both ways, wedge",
            ("wedge",),
            made[-1],
            {"six": True},
        ),
    ):
        began, processor = time.perf_counter(), _processor()
        for name in names:
            sk.quake(sk.load(str(path_of(name))), given, **more)
        seconds, processor = time.perf_counter() - began, _processor() - processor
        rows.append(f"| {words} | {processor:.1f} | {seconds:.1f} |")
    rows += [
        "",
        "| samples of one cycle of 1 Hz, 0.5 g, k_y 0.2 | displacement, m | off its formula, 0.2333261 m |",
        "|---|---|---|",
    ]
    for count in (50, 200, 1000, 4000):
        cycle = np.arange(count + 1) / count
        found = slide(cycle, 0.5 * 9.81 * np.sin(2.0 * np.pi * cycle), 0.2 * 9.81).displacement_m
        rows.append(f"| {count:,} | {found:.7f} | {found / 0.23332612669886 - 1.0:.1e} |")
    return rows


def _processor(processes: Sequence[subprocess.Popen[bytes]] = ()) -> float:
    """Seconds of processor of this process, of those that it started and that have ended, and of some that run."""
    own = os.times()
    running = (psutil.Process(process.pid).cpu_times() for process in processes)
    return sum(own[:4]) + sum(times.user + times.system for times in running)


def machine() -> str:
    """The machine in words."""
    return f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, NumPy {np.__version__}"


def main(words: list[str]) -> None:
    chapters: list[tuple[str, Callable[[], list[str]]]] = [
        ("Drawing samples beside evaluating them, one core", sampling_rows),
        ("Wedges by both methods a second, the same numbers from every crew", wedge_crew_rows),
        ("Benches a second, the same numbers from every crew", bench_crew_rows),
        (
            "Memory: samples of templates/wedge-scatter with quantiles, histogram and sensitivities",
            memory_rows,
        ),
        ("A plan for 100,000,000 rows", plan_rows),
        (
            "Probability of failure against quadrature: the default wedge, φ = N(20, 2) on both planes",
            prob_rows,
        ),
        ("Samples of templates/wedge-scatter by both methods", both_rows),
        ("Points of a sweep of templates/wedge by both methods", sweep_rows),
        ("Joint sets: is the number that was drawn found?", set_rows),
        ("Bench design: 300 joints x 7 faces x 3 heights", bench_rows),
        ("Earthquakes: 20 records x 3 slopes, the sliding against its formula", quake_rows),
    ]
    text = [
        "# Design studies: what they cost and whether they are right",
        "",
        f"Made by `python -m benchmarks.studies docs` on {machine()}.",
    ]
    for title, rows in chapters:
        chapter = ["", f"## {title}", "", *rows()]
        print("\n".join(chapter), flush=True)
        text += chapter
    if "docs" in words:
        (_DOCS / "studies.md").write_text("\n".join(text) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
