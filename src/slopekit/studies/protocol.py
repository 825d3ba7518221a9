"""What a study is: a function whose parameters say how a command line gives them, and an outcome that shows itself.

The command of a study is made of its function (`slopekit.cli.study_command`): every parameter with an `Option` or an
`Argument` in its type is one of the command. A new study is a folder with such a function and a line of `STUDIES`.
"""

import inspect
from abc import abstractmethod
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeAlias, TypeVar, get_args

from slopekit._version import __version__
from slopekit.core.shown import Shown
from slopekit.design.common import Design
from slopekit.errors import DesignError, Fault
from slopekit.units import quantity

if TYPE_CHECKING:
    from slopekit.core.sheet import Sheet

Advance = Callable[[int], None]
#: A progress bar: its label and how much there is to do.
Bar: TypeAlias = Callable[[str, int], AbstractContextManager[Advance]]
#: The functions of studies by the names of their commands, and where they stand.
STUDIES: Mapping[str, str] = {
    "check": "slopekit.studies.check", "prob": "slopekit.studies.prob", "sweep": "slopekit.studies.sweep",
    "combos": "slopekit.studies.combos", "kinematic": "slopekit.studies.kinematic",
    "solve": "slopekit.studies.solve", "support": "slopekit.studies.support",
}  # fmt: skip
#: Studies that are a flag of another command: its name, the flag's, where the function stands.
VARIANTS: Mapping[str, tuple[str, str]] = {
    "suite": ("check", "slopekit.studies.suite"), "tornado": ("sweep", "slopekit.studies.tornado"),
}  # fmt: skip
Function = TypeVar("Function", bound=Callable[..., Any])


class Outcome(Shown):
    """What a study comes to.

    Attributes
    ----------
    name : of its files, NAME.json and NAME.txt
    exit_code : 0 done, 1 a criterion is not met, 2 to 4 as those of every command
    """

    __slots__ = ()
    name: ClassVar[str]

    @property
    def sheet(self) -> "Sheet":
        """As `sheet_of` makes it, in the module `sheet` beside the study."""
        found: Sheet = self._said("sheet_of")
        return found

    @property
    def line(self) -> str:
        """As `line_of` does."""
        found: str = self._said("line_of")
        return found

    def _said(self, function: str) -> Any:
        package = type(self).__module__.rpartition(".")[0]
        return getattr(import_module(f"{package}.sheet"), function)(self)

    @property
    @abstractmethod
    def exit_code(self) -> int:
        """What the command ends with."""

    @property
    def charts(self) -> tuple[str, ...]:
        """The pictures that are drawn of it, the first where one is asked for."""
        return ()

    def head(self, design: Design) -> dict[str, Any]:
        """With what the JSON of every study of a design begins."""
        return {
            "slopekit": __version__, "study": self.name, "kind": design.kind, "title": design.title,
            "input_sha256": design.input_hash(),
            **({"project": project} if (project := design.project.given()) else {}),
        }  # fmt: skip

    def words(self) -> dict[str, Any]:
        """Its line and its sheet as JSON values: what every `to_dict` ends with, and pages are made of."""
        return {"line": self.line, "sheet": self.sheet.to_dict()}

    def files(self) -> dict[str, str]:
        """Further files by name, beside its tables."""
        return {}

    def done(self) -> None:
        """Called when all of it is written: what was kept for an interruption goes."""
        return


# -- how a parameter is given -----------------------------------------------------------------------------------------


def as_it_is(text: str, _option: str) -> Any:
    """The text: whoever takes it reads it."""
    return text


def number_of(text: str, option: str) -> float:
    """The number that an option was given; a part may be written in per cent."""
    return quantity(text, "ratio", option, f"{option} {text}")


def whole_number(text: str, option: str) -> int:
    """The whole number that an option was given.

    Raises
    ------
    DesignError
        E106 for anything else.
    """
    value = number_of(text, option)
    if value != int(value):
        raise DesignError([Fault("E106", f"{option} is {text}, a whole number is needed", f"{option} {text}")])
    return int(value)


@dataclass(frozen=True, slots=True)
class Option:
    """An option of a command; a parameter that is a bool is a flag.

    Attributes
    ----------
    help : what it is, what is taken without it in brackets
    reads : makes the value of the text and the option's name
    flag : its name on the command line where that is not the parameter's own
    metavar : what stands for the text
    choices : flags in place of one option: the value of each, and its help
    completes : the words that begin as the shell has them
    also : older spellings of the flag, still understood
    """

    help: str = ""
    reads: Callable[[str, str], Any] = as_it_is
    flag: str = ""
    metavar: str = ""
    choices: Mapping[str, tuple[Any, str]] = field(default_factory=dict)
    completes: Callable[[str], list[str]] | None = None
    also: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a command, in the order of the parameters.

    Attributes
    ----------
    many : takes all that follow; `reads` then gets the list of them
    called : its name where a variant calls it otherwise
    """

    help: str
    metavar: str
    reads: Callable[[Any, str], Any] = as_it_is
    many: bool = False
    called: str = ""


#: A design: a file on the command line, with `--set`.
ADesign = Annotated[Design, Argument("A design file (YAML).", "DESIGN")]
Jobs = Annotated[Any, Option("Processes that work at once [1].")]
Scheduler = Annotated[str | None, Option("A Dask scheduler, tcp://host:8786 (extra: dask).", metavar="ADDRESS")]
Seed = Annotated[int, Option("Seed of the random numbers: the same seed gives the same numbers [1].", whole_number)]


def _silent(_done: int) -> None:
    """Progress that nobody looks at."""


@dataclass(frozen=True, slots=True)
class Desk:
    """Where a study works: the folder of its journal, None for the present one; how progress is shown."""

    folder: Path | None = None
    bar: Bar = lambda _label, _total: nullcontext(_silent)
    #: How a parameter is called where a fault names it.
    named: Callable[[str], str] = str


DESK = Desk()


def given_by(parameter: inspect.Parameter) -> Option | Argument | None:
    """How a command line gives a parameter; None where it does not."""
    return next((one for one in get_args(parameter.annotation)[1:] if isinstance(one, Option | Argument)), None)


def study(function: Function) -> Function:
    """Add to a study's docstring what its parameters are, as they say themselves."""
    rows = []
    for name, parameter in inspect.signature(function).parameters.items():
        how = given_by(parameter)
        if how is not None:
            said = how.help or ", ".join(f"{value}: {text}" for value, text in getattr(how, "choices", {}).values())
            rows.append(f"    {name} : {said}")
    head, raises, rest = (function.__doc__ or "").partition("\n    Raises\n")
    parameters = "\n".join(["    Parameters", "    ----------", *rows, ""])
    function.__doc__ = f"{head}\n{parameters}{raises}{rest}" if raises else f"{head.rstrip()}\n\n{parameters}"
    return function


def function_of(name: str) -> Callable[..., Outcome]:
    """The function of a study, loaded when it is asked for."""
    place = STUDIES[name] if name in STUDIES else VARIANTS[name][1]
    found: Callable[..., Outcome] = getattr(import_module(place), name)
    return found
