"""Declarations of command line options, written once on the parameters of a function.

A parameter with an `Option` or an `Argument` in its type is one of the command (`slopekit.cli.study_command`); the
docstring lists them as they say themselves.
"""

import inspect
import re
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, get_args

Advance = Callable[[int], None]
#: A progress bar: its label and how much there is to do.
Bar: TypeAlias = Callable[[str, int], AbstractContextManager[Advance]]
Function = TypeVar("Function", bound=Callable[..., Any])


def as_it_is(text: Any, _option: str) -> Any:
    """The text: whoever takes it reads it."""
    return text


@dataclass(frozen=True)
class Option:
    """An option of a command; a parameter that is a bool is a flag.

    Attributes
    ----------
    help : what it is, what is taken without it in brackets
    reads : makes the value of the text and the option's name
    flag : its name on the command line where that is not the parameter's own
    metavar : what stands for the text
    texts : how many it takes; 0: it is repeated for more
    needed : on a command line, although a script that leaves it out is told by the function
    completes : the words that begin as the shell has them
    also : older spellings of the flag, still understood
    """

    help: str = ""
    reads: Callable[[Any, str], Any] = as_it_is
    flag: str = ""
    metavar: str = ""
    texts: int = 1
    needed: bool = False
    completes: Callable[[str], list[str]] | None = None
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class Argument:
    """An argument of a command, in the order of the parameters.

    Attributes
    ----------
    many : takes all that follow; `reads` then gets the list of them
    called : its name where a variant calls it otherwise
    takes : what a script gives for it, where that is more than its type says
    """

    help: str
    metavar: str
    reads: Callable[[Any, str], Any] = as_it_is
    many: bool = False
    called: str = ""
    takes: str = ""


#: A design: a file on the command line, with `--set`.
DESIGN = Argument(
    "A design file (YAML).",
    "DESIGN",
    takes="the path of a design file, the same as a dict, or a design",
)


def _silent(_done: int) -> None:
    """Progress that nobody looks at."""


@dataclass(frozen=True)
class Workplace:
    """The context in which a study runs: the folder of its results, None without one, and its progress display.

    Once results are written what `when_written` has is called: what was kept for an interruption goes.
    """

    folder: Path | None = None
    bar: Bar = lambda _label, _total: nullcontext(_silent)
    #: How a parameter is called where a fault names it.
    named: Callable[[str], str] = str
    when_written: list[Callable[[], None]] = field(default_factory=list)


DESK = Workplace()


def declared_option(parameter: inspect.Parameter) -> Option | Argument | None:
    """Return the command line declaration of a parameter; None where it has none."""
    return next(
        (
            declaration
            for declaration in get_args(parameter.annotation)[1:]
            if isinstance(declaration, Option | Argument)
        ),
        None,
    )


def documented(function: Function) -> Function:
    """Add to the docstring what the parameters are, as they say themselves."""
    rows = []
    for name, parameter in inspect.signature(function).parameters.items():
        declaration = declared_option(parameter)
        if declaration is not None:
            rows.append(f"{name} : {declaration.help}")
    head, *sections = re.split(
        r"\n(?=(?:Returns|Raises)\n)", inspect.cleandoc(function.__doc__ or ""), maxsplit=1
    )
    listed = "\n".join(["Parameters", "----------", *rows])
    function.__doc__ = "\n".join([f"{head.rstrip()}\n", f"{listed}\n", *sections])
    return function
