"""Studies: functions whose parameters declare their command line options, and outcomes with a sheet and JSON.

The command of a study is made of its function (`slopekit.cli.study_command`): every parameter with an `Option` or an
`Argument` in its type is one of the command. A new study is a folder with such a function and a line of `STUDIES`.
"""

import inspect
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import wraps
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Any, Concatenate, ParamSpec, TypeVar

from slopekit._version import FORMAT, __version__
from slopekit.core.codec import NO_JSON, json_of
from slopekit.core.errors import Faults, fail
from slopekit.core.options import (
    DESIGN,
    DESK,
    Advance,
    Argument,
    Bar,
    Option,
    Workplace,
    as_it_is,
    declared_option,
    documented,
)
from slopekit.core.report import Report
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.fields import Field

if TYPE_CHECKING:
    from slopekit.core.sheet import Sheet
    from slopekit.design.reading.files import Source
    from slopekit.studies.cases import Cases

#: The packages of the functions of studies, by the names of their commands.
STUDIES: Mapping[str, str] = {
    "check": "slopekit.studies.check",
    "prob": "slopekit.studies.prob",
    "sweep": "slopekit.studies.sweep",
    "combos": "slopekit.studies.combos",
    "kinematic": "slopekit.studies.kinematic",
    "sets": "slopekit.studies.sets",
    "solve": "slopekit.studies.solve",
    "support": "slopekit.studies.support",
    "bench-design": "slopekit.studies.bench_design",
    "quake": "slopekit.studies.quake",
}
#: Studies that are a flag of another command: by the flag's name, that command and the package of the function.
VARIANTS: Mapping[str, tuple[str, str]] = {
    "suite": ("check", "slopekit.studies.suite"),
    "tornado": ("sweep", "slopekit.studies.tornado"),
}
StudyArguments = ParamSpec("StudyArguments")
Outcome = TypeVar("Outcome", bound="StudyOutcome")


def timed(function: Callable[StudyArguments, Outcome]) -> Callable[StudyArguments, Outcome]:
    """Return the function of a study with its duration (s) added to the outcome."""

    @wraps(function)
    def with_seconds(*values: StudyArguments.args, **options: StudyArguments.kwargs) -> Outcome:
        began = time.perf_counter()
        outcome = function(*values, **options)
        return replace(outcome, seconds=time.perf_counter() - began)

    return with_seconds


def study(
    function: Callable[Concatenate[Design, StudyArguments], Outcome],
) -> "Callable[Concatenate[Source, StudyArguments], Outcome | Cases[Outcome]]":
    """A study of a design: its docstring lists its parameters, and a design with load cases goes through case by case.

    The design may be given by its path, or as a dict.
    What it returns is known when the design is read, not before: hence the two types. A study of something else is
    `timed` and `documented`.
    """
    timed_function: Callable[..., Outcome] = timed(documented(function))
    parameters = inspect.signature(function).parameters
    place = next(
        key for key, parameter in parameters.items() if declared_option(parameter) == DESIGN
    )

    @wraps(function)
    def through_cases(*values: Any, **options: Any) -> "Outcome | Cases[Outcome]":
        from slopekit.design.reading.files import (
            design_from,
        )  # imported here: a wedge from options does not need it

        arguments = dict(zip(parameters, values, strict=False)) | options
        design = design_from(arguments.pop(place, None), function.__name__, place)
        if not design.cases:
            return timed_function(design, **arguments)
        from slopekit.studies.cases import each_case

        return each_case(timed_function, function.__name__, design, arguments, place)

    return through_cases


@dataclass(frozen=True, repr=False)
class StudyOutcome(Report):
    """The outcome of a study, with its duration (s): see `timed`."""

    seconds: float = field(default=0.0, compare=False, kw_only=True, metadata=NO_JSON)

    @property
    def sheet(self) -> "Sheet":
        """The sheet, by `sheet_of` of the module `sheet` of the study."""
        study_sheet: Sheet = self._from_sheet_module("sheet_of")
        return study_sheet

    @property
    def line(self) -> str:
        """The outcome on one line, by `line_of` of the module `sheet` of the study."""
        text: str = self._from_sheet_module("line_of")
        return text

    def _from_sheet_module(self, function: str) -> Any:
        package = type(self).__module__.rpartition(".")[0]
        return getattr(import_module(f"{package}.sheet"), function)(self)

    @property
    def exit_code(self) -> int:
        """0 unless the study has other exit codes."""
        return 0

    @property
    def charts(self) -> tuple[str, ...]:
        """The names of its charts, the first of which is the default."""
        return ()

    def head(self, design: Design) -> dict[str, Any]:
        """Return the first entries of the JSON of every study of a design."""
        return {
            "slopekit": __version__,
            "format": FORMAT,
            "study": self.name,
            "kind": design.kind,
            "title": design.title,
            "input_sha256": design.input_hash(),
            "inputs": design.inputs(),
            **design.extra_json(),
        }

    def words(self) -> dict[str, Any]:
        """Return warnings, line and sheet as JSON values: the last entries of every `to_dict`."""
        return {
            "warnings": json_of(getattr(self, "warnings", ())),
            "line": self.line,
            "sheet": self.sheet.to_dict(),
        }


# -- values of parameters -----------------------------------------------------------------------------------------


def number_of(text: str, option: str) -> float:
    """Return the number of an option; a fraction may be written in per cent."""
    return quantity(text, "ratio", option, f"{option} {text}")


def whole_number(text: str, option: str) -> int:
    """Return the whole number of an option.

    Raises
    ------
    DesignError
        E106 for anything else.
    """
    value = number_of(text, option)
    if value != int(value):
        fail("E106", f"{option} is {text}, a whole number is needed", f"{option} {text}")
    return int(value)


def numbers_given(
    fields: Mapping[str, Field],
    values: Mapping[str, object],
    option: Callable[[str], str],
    faults: Faults,
) -> dict[str, float | None]:
    """Return the numbers of options by their parameters, the default of the field where an option is None.

    Parameters
    ----------
    fields : kind, limits and default of each; values : by parameter; option : the name of a parameter in messages
    """

    def read(name: str, field: Field) -> float:
        return float(field.read(values[name], field.path, f"{option(name)} {values[name]}"))

    return {
        name: field.default if values[name] is None else faults.of(read, name, field)
        for name, field in fields.items()
    }


ADesign = Annotated[Design, DESIGN]
ClosedFormAlone = Annotated[bool, Option("The closed form alone: quick.")]
Jobs = Annotated[Any, Option("Processes that work at once [1].")]
Scheduler = Annotated[
    str | None,
    Option(
        "A Dask scheduler, tls://host:8786, or tcp:// in a network that you trust: it runs any code (extra: dask).",
        metavar="ADDRESS",
    ),
]
MOST_SEED = 10**18
Seed = Annotated[
    int,
    Option("Seed of the random numbers: the same seed gives the same numbers [1].", whole_number),
]


def function_of(name: str) -> Callable[..., StudyOutcome]:
    """Return the function of a study, which is imported on demand."""
    place = STUDIES[name] if name in STUDIES else VARIANTS[name][1]
    function: Callable[..., StudyOutcome] = getattr(import_module(place), name.replace("-", "_"))
    return function


__all__ = [
    "DESK",
    "STUDIES",
    "VARIANTS",
    "ADesign",
    "Advance",
    "Argument",
    "Bar",
    "Jobs",
    "Option",
    "Scheduler",
    "Seed",
    "StudyOutcome",
    "Workplace",
    "as_it_is",
    "declared_option",
    "documented",
    "function_of",
    "number_of",
    "numbers_given",
    "study",
    "timed",
    "whole_number",
]
