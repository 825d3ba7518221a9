"""Progress of a long analysis for a listener, such as a line on a terminal, and its times.

>>> heard = []
>>> with listening(lambda stage, value, head: heard.append((stage, value))):
...     report_stage("upper bound")
...     report_stage("path: strength divided by", 1.5)
>>> report_stage("nobody looks on")
>>> heard
[('upper bound', None), ('path: strength divided by', 1.5)]
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

#: Told of a stage, a figure of it, and whether it is one of the whole (what comes after is part of it).
ProgressListener = Callable[[str, float | None, bool], None]

_ONLOOKER: ContextVar[ProgressListener | None] = ContextVar("onlooker", default=None)


def report_stage(stage: str, value: float | None = None, head: bool = False) -> None:
    """Tell who looks on what is done next; without anybody this takes a tenth of a microsecond."""
    onlooker = _ONLOOKER.get()
    if onlooker is not None:
        onlooker(stage, value, head)


@contextmanager
def listening(listener: ProgressListener) -> Iterator[None]:
    """Have someone told of every stage within."""
    token = _ONLOOKER.set(listener)
    try:
        yield
    finally:
        _ONLOOKER.reset(token)


@contextmanager
def scaled_values(unit: float, suffix: str) -> Iterator[None]:
    """Multiply the values of the stages reported within whose names end with a suffix.

    >>> heard = []
    >>> with listening(lambda stage, value, head: heard.append(value)), scaled_values(2.0, "divided by"):
    ...     report_stage("path, strength divided by", 1.5)
    ...     report_stage("path, load times", 1.5)
    >>> heard
    [3.0, 1.5]
    """
    listener = _ONLOOKER.get()
    if listener is None:
        yield
        return

    def scaled(stage: str, value: float | None, head: bool) -> None:
        listener(
            stage, unit * value if value is not None and stage.endswith(suffix) else value, head
        )

    with listening(scaled):
        yield


class Clock:
    """Times by stage, each told to who looks on; wall clock, and nothing else depends on it."""

    def __init__(self) -> None:
        self.times: dict[str, float] = {}
        self.began = time.perf_counter()

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        report_stage(stage.replace("_", " "), head=True)
        began = time.perf_counter()
        yield
        self.times[stage] = self.times.get(stage, 0.0) + time.perf_counter() - began

    def done(self) -> dict[str, float]:
        """Seconds by stage, and in all."""
        return self.times | {"total": time.perf_counter() - self.began}
