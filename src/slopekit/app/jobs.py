"""Jobs of the app, in a process that cancelling ends: analyses of benches, curves, probabilities, bolts.

The process is started anew (spawn: on every system the same) and waits for the next job, so that a job does not pay for
loading. One job runs at a time. What comes of it is text, JSON, made over there.
"""

import contextlib
import json
import math
import multiprocessing
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from multiprocessing.connection import Connection
from typing import Any

from slopekit.app import answers
from slopekit.app.messages import fault_of_bug, json_of_numpy, message_error
from slopekit.app.session import Moment
from slopekit.core.errors import DesignError, Fault, SlopekitError
from slopekit.core.options import Advance, Workplace
from slopekit.core.progress import listening
from slopekit.design.fields import words_of
from slopekit.design.reading.files import with_values
from slopekit.kinds import kind_named
from slopekit.studies.keys import key_of, values_of
from slopekit.studies.running import end_with_parent

Result = dict[str, Any]
#: Told of how much is done, of how much (None: nobody knows), and what is being done.
Tell = Callable[[int, int | None, str], None]
JOBS = ("analyse", "curve", "probability", "support")
MOST_POINTS, MOST_SAMPLES = 400, 200_000
_EVERY_S = 0.1  # how often progress is told
_DISTRIBUTION_KEYS = ("dist", "mean", "sd", "min", "max", "mode", "k")


# -- over there -------------------------------------------------------------------------------------------------------


def run_job(job: str, moment: Moment, options: Mapping[str, Any], tell: Tell) -> Result:
    """Do a job.

    Parameters
    ----------
    job : one of `JOBS`; options : as the page gives them; tell : called with its progress

    Raises
    ------
    DesignError
        E541 for options that are none, and what studies raise. GeometryError where no block can be formed.
    """
    if job not in JOBS:
        raise message_error(f"{job!r} is no job: {', '.join(JOBS)}")
    return {"analyse": _analyse, "curve": _curve, "probability": _probability, "support": _support}[
        job
    ](moment, options, tell)


def _analyse(moment: Moment, options: Mapping[str, Any], tell: Tell) -> Result:
    stages = 0

    def heard(stage: str, value: float | None, head: bool) -> None:
        nonlocal stages
        stages += 1
        tell(stages, None, stage if value is None else f"{stage} {value:.4g}")

    with listening(heard):
        answer, result = answers.analysed_answer(moment)
    document = None if result is None else result.to_dict()
    return {"answer": answer, "document": document}


def _progress_context(tell: Tell) -> Workplace:
    """Return the context by which a study of the app reports its progress."""

    @contextlib.contextmanager
    def bar(label: str, total: int) -> Iterator[Advance]:
        done = 0

        def advance(count: int) -> None:
            nonlocal done
            done += count
            tell(done, total, label)

        tell(0, total, label)
        yield advance

    return Workplace(bar=bar)


def number_in(options: Mapping[str, Any], name: str, default: float | None) -> float | None:
    """A finite number of the options of a job; `default` where it is not given. Raises DesignError E541."""
    value = options.get(name, default)
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise message_error(f"{name} is no number")
    return float(value)


def _integer_in(options: Mapping[str, Any], name: str, default: int, least: int, most: int) -> int:
    value = number_in(options, name, default)
    if value is None or value != int(value) or not least <= value <= most:
        raise message_error(f"{name} is a whole number from {least} to {most}")
    return int(value)


def _curve(moment: Moment, options: Mapping[str, Any], tell: Tell) -> Result:
    from slopekit.app.controls import slider_range
    from slopekit.studies.sweep import Sweep, sweep

    path = options.get("path")
    if not isinstance(path, str):
        raise message_error("curve needs a path")
    key = key_of(moment.design, path)
    least, most = slider_range(key)
    low, high = number_in(options, "low", least), number_in(options, "high", most)
    count = _integer_in(options, "points", 31, 2, MOST_POINTS)
    assert low is not None
    assert high is not None
    if not low < high:
        raise message_error("the curve ends before it begins")
    steps = [low + (high - low) * k / (count - 1) for k in range(count)]
    values = [float(f"{step:.10g}") for step in steps]
    if key.is_integer:
        values = sorted({float(round(value)) for value in values})
    curve = sweep(moment.design, {path: values}, desk=_progress_context(tell))
    assert isinstance(curve, Sweep)
    factors = [point.factors for point in curve.points]
    return {
        "path": path,
        "label": words_of(type(moment.design), path),
        "unit": key.unit,
        "x": list(curve.values[0]),
        "limit": [None if factor is None else factor.limit for factor in factors],
        "closed_form": [None if factor is None else factor.closed_form for factor in factors],
        "status": [
            point.code if factor is None else factor.status
            for factor, point in zip(factors, curve.points, strict=True)
        ],
        "now": key.value,
        "notices": [answers.notice_of(factor) for factor in curve.warnings],
        "line": curve.line,
    }


def _scatter_values(moment: Moment, options: Mapping[str, Any]) -> dict[str, object]:
    """Return the overrides of the design by which its numbers scatter as the page says."""
    request = options.get("scatter") or {}
    if not isinstance(request, Mapping):
        raise message_error("scatter is {path: {dist: normal, sd: 2}}")
    scatter: dict[str, object] = {}
    for path_of_mean, scatter_options in request.items():
        path = str(path_of_mean).removesuffix(".mean")
        if scatter_options is None:
            key = key_of(moment.design, path)
            scatter |= values_of(moment.design, [key], [key.value or 0.0])
            continue
        if not isinstance(scatter_options, Mapping) or not set(scatter_options) <= set(
            _DISTRIBUTION_KEYS
        ):
            raise message_error(
                f"the scatter of {path} has other keys than {', '.join(_DISTRIBUTION_KEYS)}"
            )
        key = key_of(moment.design, path)
        distribution = {name: value for name, value in scatter_options.items() if value is not None}
        if (
            distribution.get("dist") in ("normal", "lognormal")
            and "mean" not in distribution
            and key.value is not None
        ):
            distribution["mean"] = key.value
        scatter |= dict(key.written_out)
        scatter[path] = distribution
    return scatter


def _probability(moment: Moment, options: Mapping[str, Any], tell: Tell) -> Result:
    from slopekit.studies.prob import Probability, prob

    count = _integer_in(options, "samples", 20_000, 10, MOST_SAMPLES)
    seed = _integer_in(options, "seed", 1, 0, 2**31)
    scatter = _scatter_values(moment, options)
    design = with_values(moment.design, scatter) if scatter else moment.design
    target = number_in(options, "fos", 1.0)
    assert target is not None
    tell(0, None, "samples")
    study = prob(design, count, seed=seed, fos=target, desk=_progress_context(tell))
    assert isinstance(study, Probability)
    share, closed_form_share, histogram = (
        study.all_samples,
        study.by_closed_form,
        study.to_dict()["histogram"],
    )
    if histogram is not None:
        histogram["limit"] = histogram["counts"]
    return {
        "samples": study.samples.count,
        "pf": share.share,
        "low": share.low,
        "high": share.high,
        "pf_closed_form": None if closed_form_share is None else closed_form_share.share,
        "confidence": study.asked.confidence,
        "target": target,
        "histogram": histogram,
        "outcomes": study.counts,
        "sensitivity": [
            {"label": name, "rank_correlation": value} for name, value in study.sensitivities
        ],
        "notices": [answers.notice_of(notice) for notice in study.warnings],
        "line": study.line,
    }


def _support(moment: Moment, options: Mapping[str, Any], tell: Tell) -> Result:
    from slopekit.core.sheet import Verbatim
    from slopekit.studies.support import Support, support

    target = number_in(options, "fos", 1.5)
    acts = options.get("acts", "active")
    arguments = {
        name: options[name]
        for name in ("bolt_capacity", "spacing", "bond", "length", "toward", "plunge")
        if isinstance(options.get(name), int | float | str)
    }
    tell(0, None, "force and direction")
    study: Any = support(
        moment.design, target, acts=acts, desk=_progress_context(tell), **arguments
    )
    words = [
        entry
        for section in study.sheet.sections
        if section.label not in ("PASTE", "TIME")
        for entry in section.content
        if isinstance(entry, str) and not isinstance(entry, Verbatim)
    ]
    cases = study.cases if isinstance(study, Support) else ()  # load cases have no bolts in common
    built = next((case for case in cases if case.bolts), next(iter(cases), None))
    toward = getattr(built, "toward", None)
    return {
        "words": words,
        "line": study.line,
        "reached": bool(getattr(study, "reached", False)),
        "stands": bool(getattr(study, "stands", False)),
        "target": target,
        "force": getattr(built, "force", None),
        "unit": getattr(study, "unit", "kN"),
        "direction": None
        if toward is None
        else {"trend": toward.trend_deg, "plunge": toward.plunge_deg},
        "pattern": getattr(built, "pattern", None),
        "bolts": None if built is None or built.support is None else built.support["bolts"],
        "notices": [answers.notice_of(notice) for notice in getattr(study, "warnings", ())],
    }


def _serve(pipe: Connection) -> None:
    """Run in the job process: wait for jobs, do them, send their outcomes; end where nobody listens any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the server, which ends this
    end_with_parent()
    import slopekit.views.solid.viewer_data  # noqa: F401

    try:
        while (task := pipe.recv()) is not None:
            job, moment, options = task
            if job == "warm":
                kind_named(options["kind"])
                continue
            pipe.send_bytes(_job_outcome(job, moment, options, pipe))
    except (EOFError, OSError):
        return


def _job_outcome(job: str, moment: Moment, options: Mapping[str, Any], pipe: Connection) -> bytes:
    last = 0.0

    def tell(done: int, total: int | None, words: str) -> None:
        nonlocal last
        time_s = time.monotonic()
        if time_s - last > _EVERY_S or done == total:
            last = time_s
            pipe.send_bytes(json.dumps({"done": done, "total": total, "words": words}).encode())

    def encoded(end: Mapping[str, Any]) -> bytes:
        return json.dumps({"end": end}, default=json_of_numpy, allow_nan=False).encode()

    try:
        return encoded({"result": run_job(job, moment, options, tell)})
    except SlopekitError as error:
        return encoded(
            {"faults": [answers.fault_of(fault, moment.document.root) for fault in error.faults]}
        )
    except Exception as error:  # a bug of ours: the page says so
        return encoded({"faults": [answers.fault_of(fault_of_bug(error))]})


# -- here -------------------------------------------------------------------------------------------------------------


#: Told of every event of a job: progress, then its end once.
Heard = Callable[[dict[str, Any]], None]


class Jobs:
    """The jobs of a server: one at a time, in a helper that waits for the next.

    `running` is the number of the job that runs, 0 for none.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.process: Any = None
        self.pipe: Connection | None = None
        self.number = 0
        self.running = 0
        self.cancelled: set[int] = set()
        self.closed = False

    def warm(self, kind: str) -> None:
        """Have a helper ready that has loaded what a kind of design needs."""
        with self.lock:
            if self.running or self.closed:
                return
            self._ready().send(("warm", None, {"kind": kind}))

    def start(self, job: str, moment: Moment, options: Mapping[str, Any], heard: Heard) -> int:
        """Begin a job; its number.

        Parameters
        ----------
        heard : told of its events, in a thread of its own

        Raises
        ------
        DesignError
            E544 while another runs, E541 for what is no job.
        """
        if job not in JOBS:
            raise message_error(f"{job!r} is no job: {', '.join(JOBS)}")
        with self.lock:
            if self.running:
                raise DesignError(
                    [Fault("E544", "another job runs already", "", "Wait for it, or cancel it.")]
                )
            self.number += 1
            self.running = number = self.number
            pipe = self._ready()
            pipe.send((job, moment, dict(options)))
        threading.Thread(
            target=self._listen, args=(pipe, number, heard), daemon=True, name="job"
        ).start()
        return number

    def _ready(self) -> Connection:
        """The way to a process that waits for a job: the one that is there, or a new one."""
        if self.pipe is None or not self.process.is_alive():
            spawn = multiprocessing.get_context("spawn")
            self.pipe, child_pipe = spawn.Pipe()
            self.process = spawn.Process(
                target=_serve, args=(child_pipe,), name="slopekit job", daemon=True
            )
            self.process.start()
            child_pipe.close()
        return self.pipe

    def _end(self) -> None:
        """End the process, whatever it does."""
        if self.pipe is None:
            return
        self.process.kill()
        self.process.join(5.0)
        with contextlib.suppress(OSError):
            self.pipe.close()
        self.pipe = None

    def cancel(self, number: int) -> None:
        """End a job: its process is ended, whatever it does.

        Raises
        ------
        DesignError
            E544 for a job that does not run.
        """
        with self.lock:
            if not number or number != self.running:
                raise DesignError([Fault("E544", "this job does not run")])
            self.cancelled.add(number)
            self._end()

    def close(self) -> None:
        """End everything."""
        with self.lock:
            self.closed = True
            self.cancelled.add(self.running)
            self._end()

    def _listen(self, pipe: Connection, number: int, heard: Heard) -> None:
        end: dict[str, Any] | None = None
        try:
            while end is None:
                report = json.loads(pipe.recv_bytes())
                end = report.get("end")
                if end is None:
                    heard({"of": "progress", "job": number, **report})
        except (EOFError, OSError):
            message = "the process that did the job ended before it was done"
            end = {
                "faults": [
                    answers.fault_of(
                        Fault("E544", message, "", "Start it again; has memory run out?")
                    )
                ]
            }
        with self.lock:
            self.running = 0
            if number in self.cancelled:
                self.cancelled.discard(number)
                end = {"cancelled": True}
        heard({"of": "done", "job": number, **end})
