"""Faults with stable codes, and the three exceptions that carry them.

The code of a fault never changes its meaning; its first line is what scripts and tests look for. The long
texts that `slopekit explain CODE` prints stand in `messages.toml` and load only when asked for.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import NoReturn, ParamSpec, TypeVar

T = TypeVar("T")
P = ParamSpec("P")


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong: a stable code, what and why, where it stands, and what to do instead.

    Attributes
    ----------
    code : E100 to E599, what `slopekit explain` takes; its meaning never changes
    message : what is wrong, the value, the range
    where : file, line and column, or the option or key; empty where there is none
    advice : what to type instead, where that can be said

    Examples
    --------
    >>> from slopekit import Fault
    >>> print(Fault("E101", "dip of J1 is 95, a dip lies between 0 and 90", "--dips 95/115", "Write 85/295."))
    E101 dip of J1 is 95, a dip lies between 0 and 90
         --dips 95/115
         Write 85/295.
    """

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

    Attributes
    ----------
    faults : in the order in which they were found
    codes : of each
    exit_code : what a command ends with: 2 bad input, 3 no block, 4 no convergence, 5 a bug of ours

    Examples
    --------
    >>> error = DesignError([Fault("E101", "dip of J1 is 95, a dip lies between 0 and 90")])
    >>> error.codes, error.exit_code
    (('E101',), 2)
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
    """The input is wrong: every fault found in it, not the first alone. Exit code 2.

    Examples
    --------
    >>> import slopekit as sk
    >>> try:
    ...     sk.wedge(dips=("115/45", "45/245"), phi=0.35)
    ... except sk.DesignError as error:
    ...     error.codes
    ('E103', 'E113')
    """

    exit_code = 2


class GeometryError(SlopekitError):
    """The input is sound, but these planes cut no such block. Exit code 3.

    Examples
    --------
    >>> import slopekit as sk
    >>> try:
    ...     sk.wedge(dips=("80/150", "80/210"))
    ... except sk.GeometryError as error:
    ...     print(error.faults[0].message)
    the line plunges 78.5°, steeper than the face (60°): it does not daylight
    """

    exit_code = 3


class MisfitError(GeometryError):
    """The planes form a block, and a value does not fit it: water deeper than its crack, a bolt that misses it.

    Studies leave such a point out as they do one without a block; alone it is bad input. Exit code 2.

    Examples
    --------
    >>> import slopekit as sk
    >>> beside = {"force": 200, "toward": "000/10", "head": (500, 0, 0)}
    >>> try:
    ...     sk.wedge(dips=("45/115", "45/245"), bolts=beside)
    ... except sk.GeometryError as error:
    ...     error.codes, error.exit_code
    (('E211',), 2)
    """

    exit_code = 2


class NoConvergenceError(DesignError):
    """The input is sound, and what a study needs of it first was not found: PRE-IE did not converge. Exit code 4.

    Examples
    --------
    >>> NoConvergenceError([Fault("E520", "the design has no factor of safety without an earthquake")]).exit_code
    4
    """

    exit_code = 4


class SolverError(SlopekitError):
    """The model cannot be handed to the solver (a bug of ours or a model beyond its reach). Exit code 5.

    A search that finds no factor is no error: the status of the result is `not_converged`, the exit code 4.

    Examples
    --------
    >>> from slopekit import Fault, SolverError
    >>> SolverError([Fault("E599", "the model has no node pairs")]).exit_code
    5
    """

    exit_code = 5


@dataclass(frozen=True)
class Notice:
    """Something a reader must know although the run goes on: a stable W-code and a sentence."""

    code: str
    message: str

    def __str__(self) -> str:
        return f"{self.code} {self.message}"

    def to_dict(self) -> dict[str, str]:
        """As JSON values."""
        return {"code": self.code, "message": self.message}


class Faults(list[Fault]):
    """Faults gathered while the rest is read: all of them are said at once."""

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Keep the faults of what is raised within, and go on behind it."""
        try:
            yield
        except DesignError as error:
            self += error.faults

    def of(self, read: Callable[P, T], *args: P.args, **more: P.kwargs) -> T | None:
        """Return what `read` returns for these arguments; None where it raises, its faults collected."""
        try:
            return read(*args, **more)
        except DesignError as error:
            self += error.faults
            return None

    def add(self, code: str, message: str, where: str = "", advice: str = "") -> None:
        """Add a fault."""
        self.append(Fault(code, message, where, advice))

    def refuse(self) -> None:
        """Raise DesignError with all of them, if there are any."""
        if self:
            raise DesignError(self)


def fail(code: str, message: str, where: str = "", advice: str = "") -> NoReturn:
    """Raise DesignError with one fault.

    >>> fail("E101", "dip of J1 is 95, a dip lies between 0 and 90")
    Traceback (most recent call last):
    slopekit.core.errors.DesignError: E101 dip of J1 is 95, a dip lies between 0 and 90
    """
    raise DesignError([Fault(code, message, where, advice)])


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "", cutoff: float = 0.6) -> str:
    """An advice for a name that is not known: the nearest that is, else another.

    >>> did_you_mean("hieght", ["height", "face"]), did_you_mean("x", ["height"], "Known: height.")
    ('Did you mean height?', 'Known: height.')
    """
    from slopekit.core.synonyms import nearest  # what has no slip does not pay for it

    matches = nearest(name, known, cutoff=cutoff)
    return f"Did you mean {matches[0]}?" if matches else otherwise


@contextmanager
def writing(path: object, label: str = "") -> Iterator[None]:
    """E129 where what is done within cannot write to a path, or to `label` it is."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise DesignError(
            [Fault("E129", f"{label}{path} cannot be written: {reason}", str(path))]
        ) from None
