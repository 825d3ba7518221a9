"""What a long analysis is at, for whoever looks on: a line on a terminal, or nobody; and how long it takes.

>>> heard = []
>>> with onlooker(lambda stage, value, head: heard.append((stage, value))):
...     say("upper bound")
...     say("path: strength divided by", 1.5)
>>> say("nobody looks on")
>>> heard
[('upper bound', None), ('path: strength divided by', 1.5)]
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

#: Told of a stage, a figure of it, and whether it is one of the whole (what comes after is part of it).
Onlooker = Callable[[str, float | None, bool], None]

_ONLOOKER: ContextVar[Onlooker | None] = ContextVar("onlooker", default=None)


def say(stage: str, value: float | None = None, head: bool = False) -> None:
    """Tell who looks on what is done next; without anybody this takes a tenth of a microsecond."""
    onlooker = _ONLOOKER.get()
    if onlooker is not None:
        onlooker(stage, value, head)


@contextmanager
def onlooker(told: Onlooker) -> Iterator[None]:
    """Have someone told of every stage within."""
    token = _ONLOOKER.set(told)
    try:
        yield
    finally:
        _ONLOOKER.reset(token)


@contextmanager
def told_times(unit: float, of: str) -> Iterator[None]:
    """What is told within of stages that end with some words has its figure multiplied.

    >>> heard = []
    >>> with onlooker(lambda stage, value, head: heard.append(value)), told_times(2.0, "divided by"):
    ...     say("path, strength divided by", 1.5)
    ...     say("path, load times", 1.5)
    >>> heard
    [3.0, 1.5]
    """
    told = _ONLOOKER.get()
    if told is None:
        yield
        return

    def times(stage: str, value: float | None, head: bool) -> None:
        told(stage, unit * value if value is not None and stage.endswith(of) else value, head)

    with onlooker(times):
        yield


class Clock:
    """Times by stage, each told to who looks on; wall clock, and nothing else depends on it."""

    def __init__(self) -> None:
        self.times: dict[str, float] = {}
        self.began = time.perf_counter()

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        say(stage.replace("_", " "), head=True)
        began = time.perf_counter()
        yield
        self.times[stage] = self.times.get(stage, 0.0) + time.perf_counter() - began

    def done(self) -> dict[str, float]:
        """Seconds by stage, and in all."""
        return self.times | {"total": time.perf_counter() - self.began}
