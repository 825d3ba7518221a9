"""What a study is: a function whose parameters say how a command line gives them, and an outcome that shows itself.

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
    documented,
    given_by,
)
from slopekit.core.shown import Shown
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.fields import Field

if TYPE_CHECKING:
    from slopekit.core.sheet import Sheet
    from slopekit.design.reading.files import Source
    from slopekit.studies.cases import Cases

#: The functions of studies by the names of their commands, and where they stand.
STUDIES: Mapping[str, str] = {
    "check": "slopekit.studies.check", "prob": "slopekit.studies.prob", "sweep": "slopekit.studies.sweep",
    "combos": "slopekit.studies.combos", "kinematic": "slopekit.studies.kinematic",
    "sets": "slopekit.studies.sets", "solve": "slopekit.studies.solve", "support": "slopekit.studies.support",
    "bench-design": "slopekit.studies.bench_design", "quake": "slopekit.studies.quake",
}  # fmt: skip
#: Studies that are a flag of another command: its name, the flag's, where the function stands.
VARIANTS: Mapping[str, tuple[str, str]] = {
    "suite": ("check", "slopekit.studies.suite"), "tornado": ("sweep", "slopekit.studies.tornado"),
}  # fmt: skip
Asked = ParamSpec("Asked")
Outcome = TypeVar("Outcome", bound="StudyOutcome")


def timed(function: Callable[Asked, Outcome]) -> Callable[Asked, Outcome]:
    """The function of a study, whose outcome knows how long it took."""

    @wraps(function)
    def with_seconds(*values: Asked.args, **named: Asked.kwargs) -> Outcome:
        began = time.perf_counter()
        outcome = function(*values, **named)
        return replace(outcome, seconds=time.perf_counter() - began)

    return with_seconds


def study(
    function: Callable[Concatenate[Design, Asked], Outcome],
) -> "Callable[Concatenate[Source, Asked], Outcome | Cases[Outcome]]":
    """A study of a design: its docstring lists its parameters, and a design with load cases goes through case by case.

    The design may be given by its path, or as a dict.
    What it returns is known when the design is read, not before: hence the two types. A study of something else is
    `timed` and `documented`.
    """
    called: Callable[..., Outcome] = timed(documented(function))
    parameters = inspect.signature(function).parameters
    place = next(key for key, one in parameters.items() if given_by(one) == DESIGN)

    @wraps(function)
    def through_cases(*values: Any, **named: Any) -> "Outcome | Cases[Outcome]":
        from slopekit.design.reading.files import design_from  # which a wedge of options does not need

        given = dict(zip(parameters, values, strict=False)) | named
        design = design_from(given.pop(place, None), function.__name__, place)
        if not design.cases:
            return called(design, **given)
        from slopekit.studies.cases import each_case

        return each_case(called, function.__name__, design, given, place)

    return through_cases


@dataclass(frozen=True, repr=False)
class StudyOutcome(Shown):
    """What a study comes to, and how long it took: see `timed`."""

    seconds: float = field(default=0.0, compare=False, kw_only=True, metadata=NO_JSON)

    @property
    def sheet(self) -> "Sheet":
        """As `sheet_of` makes it, in the module `sheet` beside the study."""
        study_sheet: Sheet = self._said("sheet_of")
        return study_sheet

    @property
    def line(self) -> str:
        """As `line_of` does."""
        text: str = self._said("line_of")
        return text

    def _said(self, function: str) -> Any:
        package = type(self).__module__.rpartition(".")[0]
        return getattr(import_module(f"{package}.sheet"), function)(self)

    @property
    def exit_code(self) -> int:
        """0, whatever was found."""
        return 0

    @property
    def charts(self) -> tuple[str, ...]:
        """The pictures that are drawn of it, the first where one is asked for."""
        return ()

    def head(self, design: Design) -> dict[str, Any]:
        """With what the JSON of every study of a design begins."""
        return {
            "slopekit": __version__, "format": FORMAT, "study": self.name, "kind": design.kind, "title": design.title,
            "input_sha256": design.input_hash(), "inputs": design.inputs(),
            **design.beside(),
        }  # fmt: skip

    def words(self) -> dict[str, Any]:
        """Its warnings, line and sheet as JSON values: what every `to_dict` ends with, and pages are made of."""
        return {"warnings": json_of(getattr(self, "warnings", ())), "line": self.line, "sheet": self.sheet.to_dict()}


# -- what a parameter is given -----------------------------------------------------------------------------------------


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
        fail("E106", f"{option} is {text}, a whole number is needed", f"{option} {text}")
    return int(value)


def numbers_given(
    fields: Mapping[str, Field], given: Mapping[str, object], option: Callable[[str], str], faults: Faults
) -> dict[str, float | None]:
    """The numbers that options give, by their parameters; the default of its field where nothing was said.

    Parameters
    ----------
    fields : what each measures, its limits and its default; option : how a fault names a parameter
    """

    def read(name: str, field: Field) -> float:
        return float(field.read(given[name], field.path, f"{option(name)} {given[name]}"))

    return {
        name: field.default if given[name] is None else faults.of(read, name, field) for name, field in fields.items()
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
Seed = Annotated[int, Option("Seed of the random numbers: the same seed gives the same numbers [1].", whole_number)]


def function_of(name: str) -> Callable[..., StudyOutcome]:
    """The function of a study, loaded when it is asked for."""
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
    "documented",
    "function_of",
    "given_by",
    "number_of",
    "numbers_given",
    "study",
    "timed",
    "whole_number",
]  # fmt: skip
