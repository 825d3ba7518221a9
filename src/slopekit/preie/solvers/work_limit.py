"""How much work the limit of many blocks may take: counted, not timed, so that every machine ends at the same place.

The unit is about 0.07 µs of one core: a factorisation of n unknowns counts n^1.5 and 10⁴ for what stands about it,
whichever way it is done; a cone program counts as a hundred of them.

>>> with allowed(3e4):
...     spend(factorisation(1.0), 2.0)
...     spend(factorisation(1.0), 2.0)
Traceback (most recent call last):
    ...
slopekit.preie.solvers.work_limit.WorkSpentError
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

#: Of one round of many blocks: some six minutes.
MOST = 5e9

SECOND = 1.5e7  # units of a second
PROGRAM = 100.0  # factorisations that a cone program counts as
_ABOUT = 1e4  # units that stand about a factorisation


class WorkSpentError(Exception):
    """The work that was allowed is done, and what was asked is not found.

    `rested` is the factor at which all blocks were at rest last, None where that is not known.
    """

    def __init__(self, rested: float | None = None) -> None:
        super().__init__()
        self.rested = rested

    def times(self, by: float) -> "WorkSpentError":
        """The same in another unit of strength."""
        return WorkSpentError(None if self.rested is None else by * self.rested)


class _Meter:
    """What has been spent, and how far it may go."""

    __slots__ = ("most", "spent")

    def __init__(self) -> None:
        self.spent, self.most = 0.0, math.inf


_METER: ContextVar[_Meter | None] = ContextVar("work", default=None)


def factorisation(unknowns: float) -> float:
    """Units of one factorisation."""
    return float(unknowns) * math.sqrt(unknowns) + _ABOUT


def spend(units: float, times: float = 1.0) -> None:
    """Count work that is about to be done.

    Raises
    ------
    WorkSpentError
        It is more than is allowed.
    """
    meter = _METER.get()
    if meter is not None:
        meter.spent += times * units
        if meter.spent > meter.most:
            raise WorkSpentError


@contextmanager
def allowed(units: float) -> Iterator[None]:
    """Allow so much work within; where less is left of what is allowed about it, that."""
    meter, token = _METER.get(), None
    if meter is None:
        meter = _Meter()
        token = _METER.set(meter)
    before = meter.most
    meter.most = min(before, meter.spent + units)
    try:
        yield
    finally:
        meter.most = before
        if token is not None:
            _METER.reset(token)


@contextmanager
def part(of_left: float) -> Iterator[None]:
    """Allow a part of what is left within: the rest is for what comes after."""
    meter = _METER.get()
    if meter is None or meter.most == math.inf:
        yield
        return
    with allowed(of_left * max(meter.most - meter.spent, 0.0)):
        yield
