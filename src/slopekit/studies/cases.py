"""Run a function for each load case of a design: one table over the cases, in which the worst governs.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
...          "acceptance": {"rules": "fos >= 1.5"}, "cases": {"dry": {"set": {"water.fill": 0}},
...          "wet": {"set": {"water": "full"}, "accept": "fos >= 1.2"}}}
>>> found = sk.run(wedge)
>>> round(found.cases["wet"].fos.limit, 3), found.governing, found.exit_code
(1.006, 'wet', 1)
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

from slopekit._version import FORMAT, __version__
from slopekit.core.errors import DesignError, Fault, GeometryError, Notice, did_you_mean, fail
from slopekit.core.report import Report
from slopekit.core.sheet import Column, Section, Sheet, Table
from slopekit.design.common import Design, LoadCase
from slopekit.studies.words import study_sheet

_LINE_WIDTH, _LAST_COLUMN_WIDTH = (
    88,
    16,
)  # characters of a line without its label; of these, the room of the last column
_EXIT_CODES_BY_SEVERITY = (0, 1, 4, 3, 2, 5)  # from good to bad


CaseResult = TypeVar("CaseResult", bound=Report, covariant=True)


#: A load case and its result.
_CaseRow: TypeAlias = tuple[LoadCase, Report]


@dataclass(frozen=True, repr=False)
class Cases(Report, Generic[CaseResult]):
    """The results of a function for each load case: `Cases[Result]` of `run`, `Cases[Check]` of `check`.

    Attributes
    ----------
    design : the design without the values that a case sets
    what : the function's name
    cases : by the name of the case: results, or outcomes of a study
    keys : of the design, by their paths, to which the study gives values of its own
    """

    name: ClassVar[str] = "cases"
    design: Design
    what: str
    cases: Mapping[str, CaseResult]
    keys: tuple[str, ...] = ()

    @property
    def file_names(self) -> tuple[str, str]:
        """The names of the files, those of a design without cases."""
        return next(iter(self.cases.values())).file_names

    @property
    def parts(self) -> Mapping[str, Report]:
        """The results by case, whose files go into folders named after the cases."""
        return self.cases

    @property
    def exit_code(self) -> int:
        """The exit code of the worst case."""
        return max(
            (int(result.exit_code) for result in self.cases.values()),
            key=_EXIT_CODES_BY_SEVERITY.index,
        )

    @property
    def governing(self) -> str:
        """The case that is nearest to not being accepted, or the farthest from it."""
        ranks = {
            name: (
                -_EXIT_CODES_BY_SEVERITY.index(result.exit_code),
                math.inf if result.margin is None else result.margin,
            )
            for name, result in self.cases.items()
        }
        return min(ranks, key=ranks.__getitem__)

    @property
    def accepted(self) -> bool | None:
        """Whether every case is accepted; None where none has a rule."""
        verdicts = [getattr(result, "accepted", None) for result in self.cases.values()]
        decided = [verdict for verdict in verdicts if verdict is not None]
        return all(decided) if decided else None

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """The notices of all cases, each with the names of its cases where not all have it."""
        case_names: dict[Notice, list[str]] = {}
        for case in self.design.cases:
            for path in self.keys:
                if any(
                    f"{set_path}.".startswith(f"{path}.") or f"{path}.".startswith(f"{set_path}.")
                    for set_path, _ in case.sets
                ):
                    overridden = (
                        f"{path}, which the case sets itself, has the values of the study there"
                    )
                    case_names.setdefault(Notice("W427", overridden), []).append(case.name)
        for name, result in self.cases.items():
            for notice in dict.fromkeys(getattr(result, "warnings", ())):
                case_names.setdefault(notice, []).append(name)
        return tuple(
            notice
            if len(names) == len(self.cases)
            else Notice(notice.code, f"{', '.join(names)}: {notice.message}")
            for notice, names in case_names.items()
        )

    @property
    def line(self) -> str:
        """The governing case and its result on one line."""
        return (
            f"{self.governing} governs {len(self.cases)} cases  {self.cases[self.governing].line}"
        )

    @property
    def sheet(self) -> Sheet:
        """The sheet with the table over all cases."""
        rows: list[_CaseRow] = [(case, self.cases[case.name]) for case in self.design.cases]
        first = next(iter(self.cases.values()))
        result_columns = max(
            (result.case_columns() for result in self.cases.values()), key=len
        )  # not every case has every column
        width = min(max(len(case.name) for case, _ in rows), 24) + 2
        sets_width = (
            _LINE_WIDTH
            - width
            - sum(abs(column.width) for column in result_columns if abs(column.width) > 1)
            - _LAST_COLUMN_WIDTH
        )
        sets_width = max(min(sets_width, max(len(case.in_words) for case, _ in rows) + 2), 8)
        columns: list[Column[_CaseRow]] = [
            Column("case", lambda row: row[0].name, "case", width=-max(width, 6)),
            Column(
                "sets",
                lambda row: row[0].in_words,
                "sets",
                width=-sets_width,
                show=lambda text: (
                    text if len(text) < sets_width - 1 else f"{text[: sets_width - 5]}..."
                ),
            ),
        ]
        columns += [replace(column, of=_case_value(column), text=None) for column in result_columns]
        columns.append(Column("says", lambda row: row[1].line, "line"))
        table = Table(columns, rows)
        file_name = "cases.csv" if self.what == "run" else f"{self.what}-cases.csv"
        shortened = [
            f"{case.name}: {case.in_words}"
            for case, _ in rows
            if len(case.in_words) > sets_width - 2
        ]
        sections = [Section("CASES", [table]), Section("SETS", shortened)]
        if result_columns:
            governing = self.cases[self.governing]
            trials = [
                f"{case.name}, {text}"
                for case, result in rows
                for text in getattr(result, "trial_lines", ())
            ]
            sections.append(Section("GOVERNS", [f"{self.governing}: {governing.line}", *trials]))
        else:
            sections += [
                Section("EACH", [f"{case.name}: {result.line}" for case, result in rows]),
                Section("GOVERNS", [] if first.margin is None else [self.governing]),
            ]
        return study_sheet(
            self.design,
            f"{self.what}, {len(rows)} load case{'s' * (len(rows) != 1)}",
            [*sections, Section("NOTE", [str(notice) for notice in self.warnings])],
            {file_name: table},
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the cases as JSON values, each as it would be without the others."""
        return {
            "slopekit": __version__,
            "format": FORMAT,
            "study": "cases",
            "of": self.what,
            "kind": self.design.kind,
            "title": self.design.title,
            "input_sha256": self.design.input_hash(),
            "inputs": self.design.inputs(),
            **self.design.extra_json(),
            "governing": self.governing,
            "accepted": self.accepted,
            "exit_code": self.exit_code,
            "sets": {case.name: dict(case.sets) for case in self.design.cases},
            "cases": {name: result.to_dict() for name, result in self.cases.items()},
            "warnings": [notice.to_dict() for notice in self.warnings],
            "line": self.line,
            "sheet": self.sheet.to_dict(),
        }


def _case_value(column: Column[Any]) -> Callable[[_CaseRow], Any]:
    return lambda row: column.of(row[1])


def each_case(
    function: Callable[..., CaseResult],
    name: str,
    design: Design,
    arguments: Mapping[str, Any],
    place: str = "design",
) -> Cases[CaseResult]:
    """Return the results of a function for each load case of a design.

    Parameters
    ----------
    name : of the function; arguments : its other arguments; place : the name of its parameter for the design

    Raises
    ------
    DesignError, GeometryError
        With the faults of all cases, each with the names of its cases where not all have it.
    """
    by_case, errors = dict[str, CaseResult](), dict[str, DesignError | GeometryError]()
    for case in design.cases:
        try:
            by_case[case.name] = function(**{place: case.design}, **arguments)
        except (DesignError, GeometryError) as error:
            errors[case.name] = error
    if errors:
        _refuse(errors, len(design.cases))
    varied = arguments.get("keys", arguments.get("key")) or ()
    keys = (varied.partition("=")[0],) if isinstance(varied, str) else tuple(varied)
    return Cases(design, name, type(by_case[design.cases[0].name]).over_cases(by_case), keys)


def of_cases(
    document: Mapping[str, Any], case: str | None = None, name: str = ""
) -> dict[str, Mapping[str, Any]]:
    """Return the JSON of each load case by name, or of the one named; {"": document} where there are no cases.

    Raises
    ------
    DesignError
        E197 for a name that is none of them, E313 where there are no cases, E340 where they are damaged.
    """
    document_name, cases = name or "the document", document.get("cases")
    if document.get("study") != "cases":
        if case is not None:
            fail(
                "E313",
                f"{document_name} has no load cases, {case} is none",
                f"--case {case}",
                "Leave --case out.",
            )
        return {"": document}
    if not isinstance(cases, Mapping) or not cases:
        fail("E340", f"{document_name} has lost its load cases", name)
    if case is None:
        return {str(case_name): case_document for case_name, case_document in cases.items()}
    if case not in cases:
        advice = did_you_mean(case, map(str, cases), f"There are: {', '.join(map(str, cases))}.")
        fail("E197", f"{case} is no load case of {document_name}", f"--case {case}", advice)
    return {case: cases[case]}


def _refuse(errors: Mapping[str, DesignError | GeometryError], count: int) -> None:
    """Raise the faults of several cases as one error, each with its cases."""
    case_names: dict[Fault, list[str]] = {}
    for name, error in errors.items():
        for fault in error.faults:
            case_names.setdefault(fault, []).append(name)
    faults = [
        fault
        if len(names) == count
        else replace(
            fault, message=f"{fault.message} (load case{'s' * (len(names) > 1)} {', '.join(names)})"
        )
        for fault, names in case_names.items()
    ]
    raise (
        DesignError
        if any(isinstance(error, DesignError) for error in errors.values())
        else GeometryError
    )(faults)
