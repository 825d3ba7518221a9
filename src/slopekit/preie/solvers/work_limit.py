"""A budget of work for the limit of many blocks: counted, not timed, so that every machine stops at the same place.

The unit is about 0.07 µs of one core: a factorisation of n unknowns counts n^1.5 and 10⁴ of overhead, whatever its
storage; a cone program counts as a hundred factorisations.

>>> with work_budget(3e4):
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

#: Units for one limit of many blocks: some six minutes.
LIMIT_UNITS = 5e9

UNITS_PER_SECOND = 1.5e7  # units of a second of one core
CONE_PROGRAM_FACTORISATIONS = 100.0  # factorisations that a cone program counts as
_FIXED_UNITS = 1e4  # overhead of one factorisation


class WorkSpentError(Exception):
    """The budget of work is spent before the limit was found.

    `rested` is the last factor with an equilibrium of all blocks, None where no factor is known.
    """

    def __init__(self, rested: float | None = None) -> None:
        super().__init__()
        self.rested = rested

    def times(self, factor: float) -> "WorkSpentError":
        """Return this error with its factor in another unit of strength, `factor` times as large."""
        return WorkSpentError(None if self.rested is None else factor * self.rested)


class _Meter:
    """The work spent so far and its limit, in units."""

    __slots__ = ("limit", "spent")

    def __init__(self) -> None:
        self.spent, self.limit = 0.0, math.inf


_METER: ContextVar[_Meter | None] = ContextVar("work", default=None)


def factorisation(unknowns: float) -> float:
    """Return the units that one factorisation of so many unknowns counts."""
    return float(unknowns) * math.sqrt(unknowns) + _FIXED_UNITS


def spend(units: float, times: float = 1.0) -> None:
    """Count `times` times so many units of work that is about to be done.

    Raises
    ------
    WorkSpentError
        The budget is exceeded.
    """
    meter = _METER.get()
    if meter is not None:
        meter.spent += times * units
        if meter.spent > meter.limit:
            raise WorkSpentError


@contextmanager
def work_budget(units: float) -> Iterator[None]:
    """Limit the work of a `with` block to so many units, and to what an enclosing budget has left."""
    meter, token = _METER.get(), None
    if meter is None:
        meter = _Meter()
        token = _METER.set(meter)
    outer_limit = meter.limit
    meter.limit = min(outer_limit, meter.spent + units)
    try:
        yield
    finally:
        meter.limit = outer_limit
        if token is not None:
            _METER.reset(token)


@contextmanager
def budget_fraction(fraction: float) -> Iterator[None]:
    """Limit the work of a `with` block to a fraction of what the budget has left: the rest serves later work."""
    meter = _METER.get()
    if meter is None or meter.limit == math.inf:
        yield
        return
    with work_budget(fraction * max(meter.limit - meter.spent, 0.0)):
        yield
