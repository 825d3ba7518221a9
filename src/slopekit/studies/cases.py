"""The load cases of a design, each through the same function: one table over them, the worst of them the answer.

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
from slopekit.core.sheet import Column, Section, Sheet, Table
from slopekit.core.shown import Shown
from slopekit.design.common import Design, LoadCase
from slopekit.studies.words import study_sheet

_ROOM, _LAST = 88, 16  # characters of a line beside its label; of those its last column, as it comes
_EXITS = (0, 1, 4, 3, 2, 5)  # from good to bad


Found = TypeVar("Found", bound=Shown, covariant=True)


#: A case and what came of it.
_CaseRow: TypeAlias = tuple[LoadCase, Shown]


@dataclass(frozen=True, repr=False)
class Cases(Shown, Generic[Found]):
    """What a function came to, case by case: `Cases[Result]` of `run`, `Cases[Check]` of `check`.

    Attributes
    ----------
    design : without what a case sets
    what : the function's name
    cases : by the name of the case: results, or outcomes of a study
    keys : of the design, by their paths, to which the study gives values of its own
    """

    name: ClassVar[str] = "cases"
    design: Design
    what: str
    cases: Mapping[str, Found]
    keys: tuple[str, ...] = ()

    @property
    def file_names(self) -> tuple[str, str]:
        """As of a design without cases."""
        return next(iter(self.cases.values())).file_names

    @property
    def parts(self) -> Mapping[str, Shown]:
        """The cases, whose files stand in folders of their names."""
        return self.cases

    @property
    def exit_code(self) -> int:
        """That of the worst case."""
        return max((int(one.exit_code) for one in self.cases.values()), key=_EXITS.index)

    @property
    def governing(self) -> str:
        """The case that is nearest to not being accepted, or the farthest from it."""
        ranks = {
            name: (-_EXITS.index(one.exit_code), math.inf if one.margin is None else one.margin)
            for name, one in self.cases.items()
        }
        return min(ranks, key=ranks.__getitem__)

    @property
    def accepted(self) -> bool | None:
        """Whether every case is accepted; None where none has a rule."""
        verdicts = [getattr(one, "accepted", None) for one in self.cases.values()]
        said = [one for one in verdicts if one is not None]
        return all(said) if said else None

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What a reader must know, and of which cases."""
        whose: dict[Notice, list[str]] = {}
        for case in self.design.cases:
            for path in self.keys:
                if any(f"{own}.".startswith(f"{path}.") or f"{path}.".startswith(f"{own}.") for own, _ in case.sets):
                    own_key = f"{path}, which the case sets itself, has the values of the study there"
                    whose.setdefault(Notice("W427", own_key), []).append(case.name)
        for name, one in self.cases.items():
            for notice in dict.fromkeys(getattr(one, "warnings", ())):
                whose.setdefault(notice, []).append(name)
        return tuple(
            notice if len(names) == len(self.cases) else Notice(notice.code, f"{', '.join(names)}: {notice.message}")
            for notice, names in whose.items()
        )

    @property
    def line(self) -> str:
        """The governing case, and what is said of it."""
        return f"{self.governing} governs {len(self.cases)} cases  {self.cases[self.governing].line}"

    @property
    def sheet(self) -> Sheet:
        """The table over the cases."""
        rows: list[_CaseRow] = [(case, self.cases[case.name]) for case in self.design.cases]
        first = next(iter(self.cases.values()))
        more = max((one.case_columns() for one in self.cases.values()), key=len)  # not every case has every column
        width = min(max(len(case.name) for case, _ in rows), 24) + 2
        room = _ROOM - width - sum(abs(column.width) for column in more if abs(column.width) > 1) - _LAST
        room = max(min(room, max(len(case.in_words) for case, _ in rows) + 2), 8)
        own: list[Column[_CaseRow]] = [
            Column("case", lambda row: row[0].name, "case", width=-max(width, 6)),
            Column("sets", lambda row: row[0].in_words, "sets", width=-room,
                   show=lambda text: text if len(text) < room - 1 else f"{text[: room - 5]}..."),
        ]  # fmt: skip
        own += [replace(column, of=_of(column), text=None) for column in more]
        own.append(Column("says", lambda row: row[1].line, "line"))
        table = Table(own, rows)
        own_name = "cases.csv" if self.what == "run" else f"{self.what}-cases.csv"
        cut = [f"{case.name}: {case.in_words}" for case, _ in rows if len(case.in_words) > room - 2]
        sections = [Section("CASES", [table]), Section("SETS", cut)]
        if more:
            governing = self.cases[self.governing]
            trials = [f"{case.name}, {text}" for case, found in rows for text in getattr(found, "trial_lines", ())]
            sections.append(Section("GOVERNS", [f"{self.governing}: {governing.line}", *trials]))
        else:
            sections += [
                Section("EACH", [f"{case.name}: {found.line}" for case, found in rows]),
                Section("GOVERNS", [] if first.margin is None else [self.governing]),
            ]
        return study_sheet(
            self.design,
            f"{self.what}, {len(rows)} load case{'s' * (len(rows) != 1)}",
            [*sections, Section("NOTE", [str(notice) for notice in self.warnings])],
            {own_name: table},
        )

    def to_dict(self) -> dict[str, Any]:
        """The cases as JSON values: each as it would stand alone."""
        return {
            "slopekit": __version__, "format": FORMAT, "study": "cases", "of": self.what, "kind": self.design.kind,
            "title": self.design.title, "input_sha256": self.design.input_hash(), "inputs": self.design.inputs(),
            **self.design.beside(),
            "governing": self.governing, "accepted": self.accepted, "exit_code": self.exit_code,
            "sets": {case.name: dict(case.sets) for case in self.design.cases},
            "cases": {name: one.to_dict() for name, one in self.cases.items()},
            "warnings": [notice.to_dict() for notice in self.warnings],
            "line": self.line, "sheet": self.sheet.to_dict(),
        }  # fmt: skip


def _of(column: Column[Any]) -> Callable[[_CaseRow], Any]:
    return lambda row: column.of(row[1])


def each_case(
    function: Callable[..., Found], name: str, design: Design, given: Mapping[str, Any], place: str = "design"
) -> Cases[Found]:
    """What a function comes to for each load case of a design.

    Parameters
    ----------
    name : of the function; given : what else it takes; place : the name of its parameter for the design

    Raises
    ------
    DesignError, GeometryError
        With the faults of all cases: those that not all of them have say whose they are.
    """
    by_case, wrong = dict[str, Found](), dict[str, DesignError | GeometryError]()
    for case in design.cases:
        try:
            by_case[case.name] = function(**{place: case.design}, **given)
        except (DesignError, GeometryError) as error:
            wrong[case.name] = error
    if wrong:
        _refuse(wrong, len(design.cases))
    varied = given.get("keys", given.get("key")) or ()
    keys = (varied.partition("=")[0],) if isinstance(varied, str) else tuple(varied)
    return Cases(design, name, type(by_case[design.cases[0].name]).over_cases(by_case), keys)


def of_cases(document: Mapping[str, Any], case: str | None = None, name: str = "") -> dict[str, Mapping[str, Any]]:
    """The JSON of each load case by its name, of one where it is named; {"": itself} of a document without any.

    Raises
    ------
    DesignError
        E197 for a name that is none of them, E313 where there are no cases, E340 where they are damaged.
    """
    called, cases = name or "the document", document.get("cases")
    if document.get("study") != "cases":
        if case is not None:
            fail("E313", f"{called} has no load cases, {case} is none", f"--case {case}", "Leave --case out.")
        return {"": document}
    if not isinstance(cases, Mapping) or not cases:
        fail("E340", f"{called} has lost its load cases", name)
    if case is None:
        return {str(own): below for own, below in cases.items()}
    if case not in cases:
        advice = did_you_mean(case, map(str, cases), f"There are: {', '.join(map(str, cases))}.")
        fail("E197", f"{case} is no load case of {called}", f"--case {case}", advice)
    return {case: cases[case]}


def _refuse(wrong: Mapping[str, DesignError | GeometryError], count: int) -> None:
    """Raise the faults of several cases as one error, each with its cases."""
    whose: dict[Fault, list[str]] = {}
    for name, error in wrong.items():
        for fault in error.faults:
            whose.setdefault(fault, []).append(name)
    every = [
        fault if len(names) == count else
        replace(fault, message=f"{fault.message} (load case{'s' * (len(names) > 1)} {', '.join(names)})")
        for fault, names in whose.items()
    ]  # fmt: skip
    raise (DesignError if any(isinstance(one, DesignError) for one in wrong.values()) else GeometryError)(every)
