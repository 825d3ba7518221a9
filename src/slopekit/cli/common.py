"""Parts that all commands share: options, reading a design, folders, faults as text or JSON."""

import os
import re
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import typer

from slopekit._version import __version__
from slopekit.cli.progress import aside
from slopekit.core.errors import DesignError, Fault, Faults, SlopekitError, writing
from slopekit.core.sheet import WIDTH
from slopekit.core.synonyms import synonym

if TYPE_CHECKING:
    from slopekit.design.common import Design

JSON = typer.Option("--json", help="One JSON document on stdout, nothing else.")
QUIET = typer.Option("--quiet", help="One line: status, factor, check.")
FOLDER = typer.Option(
    "-o", help="Folder for result.json, sheet.txt, bolts.csv and pictures (extra: plot)."
)
SET = typer.Option(
    "--set", help="key=value, replaces a value of the file; repeat.", metavar="KEY=VALUE"
)
CASE = typer.Option(
    "--case", help="One load case of the design, by name [all of them].", metavar="NAME"
)
#: Two spellings of one option; options that are repeated for more.
_SPELLINGS = {"--accept-fos": "--accept", "--accept-pf": "--accept", "--target": "--fos"}
_OPTION = re.compile(r"--|-[a-z]$")  # no negative number
_REPEATABLE = {"--force", "--bolt", "--limit", "--set", "--project"}
_HANG = " " * 5  # what stands below the first line of a fault
FILE = typer.Argument(help="A design file (YAML).", metavar="DESIGN")


def repeated_options(arguments: Sequence[str]) -> Faults:
    """Options that take one value and are given twice, of which the parser would let the last one win."""
    options = [argument.partition("=")[0] for argument in arguments if _OPTION.match(argument)]
    options = [synonym(name, {*options} - {name}) or name for name in options]
    names = [_SPELLINGS.get(name, name) for name in options]
    twice = sorted({name for name in names if names.count(name) > 1} - _REPEATABLE)
    return Faults(Fault("E100", f"{name} is given twice", name, "Give it once.") for name in twice)


def canonical_options(declared: Iterable[Any], arguments: Sequence[str]) -> list[str]:
    """The arguments of a command with the option in place of what engineers call it: `--c` for `--cohesion`."""
    names = [name for option in declared for name in option.opts if name.startswith("--")]
    canonical = []
    for argument in arguments:
        name, equals, value = argument.partition("=")
        meant = synonym(name, names) if name.startswith("--") else None
        canonical.append(f"{meant or name}{equals}{value}")
    return canonical


def load_design(design: str, sets: list[str] | None, case: str | None = None) -> "Design":
    """The design of a file, with what `--set` replaces in it; the load case that `--case` names."""
    from slopekit.design.reading.document import parse_override
    from slopekit.design.reading.files import load

    faults, overrides = Faults(), list[tuple[str, object]]()
    for text in sets or []:
        with faults.collecting():
            overrides.append(parse_override(text))
    faults.refuse()
    return load(design, overrides, case)


def folder_of(folder: Path) -> Path:
    """Make a folder to write to, before any work is done."""
    import tempfile

    if str(folder) == "." and ("-o", "") in pairwise(
        sys.argv
    ):  # -o "$DIR" of a variable that is not set
        raise DesignError(
            [
                Fault(
                    "E129",
                    "the folder to write to has an empty name",
                    "-o",
                    "Write -o . for this one.",
                )
            ]
        )
    if folder.is_file():
        advice = "Give another name: a folder is made where there is none."
        raise DesignError(
            [Fault("E129", f"{folder} is a file, not a folder to write to", str(folder), advice)]
        )
    with writing(folder, "the folder "):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    return folder


def json_text(document: Any) -> str:
    """A document as every command prints it."""
    import json  # a plain run prints none

    return json.dumps(document, ensure_ascii=False, indent=1, allow_nan=False)


def print_faults(error: SlopekitError, plainly: bool = False) -> None:
    """Faults on stderr, and as JSON on stdout where that was asked for."""
    with aside(), suppress(OSError):  # of a stderr that takes nothing: the exit code says it
        _print_faults(error, plainly)


def _print_faults(error: SlopekitError, plainly: bool) -> None:
    if "--json" in sys.argv[1:] and not plainly:
        typer.echo(
            json_text(
                {"slopekit": __version__, "errors": [fault.to_dict() for fault in error.faults]}
            )
        )
    for fault in error.faults:
        # where it stands, the second part, is the user's own line; the first is whole for scripts, which look for it
        first = (
            folded(f"{fault.code} {fault.message}", _HANG, sys.stderr)
            if sys.stderr and sys.stderr.isatty()
            else ""
        )
        typer.echo(first or f"{fault.code} {fault.message}", err=True)
        if fault.where:
            typer.echo(_HANG + fault.where, err=True)
        if fault.advice:
            typer.echo(folded(_HANG + fault.advice, _HANG, sys.stderr), err=True)


def folded(text: str, hang: str = "", to: TextIO | None = None) -> str:
    """A paragraph in lines as wide as the terminal, 100 columns where that is wider or there is none."""
    import textwrap

    try:
        width = min(max(os.get_terminal_size((to or sys.stdout).fileno()).columns, 40), WIDTH)
    except (AttributeError, OSError, ValueError):  # no terminal, or no file at all
        width = WIDTH
    return textwrap.fill(
        text, width, subsequent_indent=hang, break_long_words=False, break_on_hyphens=False
    )
