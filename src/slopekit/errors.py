"""Faults with stable codes, and the three exceptions that carry them.

The code of a fault never changes its meaning; its first line is what scripts and tests look for. The long
texts that `slopekit explain CODE` prints stand in `messages.toml` and load only when asked for.
"""

from collections.abc import Iterable
from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong: a stable code, what and why, where it stands, and what to do instead."""

    code: str
    message: str
    where: str = ""
    advice: str = ""

    def __str__(self) -> str:
        lines = [f"{self.code} {self.message}"]
        lines += [f"     {extra}" for extra in (self.where, self.advice) if extra]
        return "\n".join(lines)

    def to_dict(self) -> dict[str, str]:
        """The fault as plain strings, as `--json` prints it."""
        return asdict(self)


class SlopekitError(Exception):
    """Base of slopekit's own exceptions: one or more faults, all that were found.

    >>> error = DesignError([Fault("E101", "dip of J1 is 95, a dip lies between 0 and 90")])
    >>> error.codes
    ('E101',)
    """

    exit_code = 5

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))

    @property
    def codes(self) -> tuple[str, ...]:
        """The codes in the order in which the faults were found."""
        return tuple(fault.code for fault in self.faults)


class DesignError(SlopekitError):
    """The input is wrong: every fault found in it."""

    exit_code = 2


class GeometryError(SlopekitError):
    """The input is sound, but these planes cut no such block."""

    exit_code = 3


class SolverError(SlopekitError):
    """The model cannot be handed to the solver (a bug of ours or a model beyond its reach)."""

    exit_code = 5


@dataclass(frozen=True, slots=True)
class Notice:
    """Something a reader must know although the run goes on: a stable W-code and a sentence."""

    code: str
    message: str

    def __str__(self) -> str:
        return f"{self.code} {self.message}"
