"""The base of results and study outcomes: text, JSON, notebook and data frame from one sheet."""

from abc import abstractmethod
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

from slopekit.core.errors import DesignError, Fault

if TYPE_CHECKING:
    from slopekit.core.sheet import Column, Sheet, Table


class Report:
    """Has a sheet, and shows it: `print(r)` writes it, a notebook draws it, `r.to_frame()` gives its leading table."""

    __slots__ = ()
    #: Of its files: NAME.json and NAME.txt, or another name of the text.
    name: ClassVar[str]
    text_name: ClassVar[str] = ""

    @property
    @abstractmethod
    def sheet(self) -> "Sheet":
        """The sheet: sections of entries and tables."""

    @property
    @abstractmethod
    def line(self) -> str:
        """The same on one line."""

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Return the outcome as JSON values."""

    @property
    @abstractmethod
    def exit_code(self) -> int:
        """The exit code of a command: 0 done, 1 a criterion is not met, 2 to 4 as those of every command."""

    @property
    def file_names(self) -> tuple[str, str]:
        """The names of its JSON and text files, without endings."""
        return self.name, self.text_name or self.name

    @property
    def parts(self) -> "Mapping[str, Report]":
        """The outcomes of its load cases, each with files of its own, by the names of their folders."""
        return {}

    @property
    def margin(self) -> float | None:
        """The margin by which the least favourable load case is found (less is worse); None where there is none."""
        return None

    def case_columns(self) -> "list[Column[Any]]":
        """The columns that a table over load cases has beside the line of each case."""
        return []

    @classmethod
    def over_cases(cls, outcomes: "Mapping[str, Any]") -> "Mapping[str, Any]":
        """Outcomes by load case, with what one says of the others."""
        return outcomes

    def files(self) -> dict[str, str]:
        """Further files by name, beside its tables."""
        return {}

    def __str__(self) -> str:
        return str(self.sheet)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.line}>"

    def _repr_html_(self) -> str:
        # drawing is floors above; it is asked for by name, and only here
        text: str = import_module("slopekit.views.notebook").html_of(self)
        return text

    def tables(self) -> dict[str, "Table[Any]"]:
        """Its tables by name: those that are written to files, and those of the sheet that have keys."""
        from slopekit.core.sheet import Table

        sheet = self.sheet
        by_name = {name.partition(".")[0]: table for name, table in sheet.tables.items()}
        for section in sheet.sections:
            for entry in section.content:
                if not isinstance(entry, Table) or any(
                    entry is table for table in by_name.values()
                ):
                    continue
                if any(column.key for column in entry.columns):
                    name = label = section.label.lower().replace(" ", "_")
                    while name in by_name:
                        name = f"{label}_{int(name.removeprefix(label).lstrip('_') or 1) + 1}"
                    by_name[name] = entry
        return by_name

    def to_frames(self) -> dict[str, Any]:
        """Its tables as data frames by name (needs pandas).

        Raises
        ------
        DesignError
            E140 where pandas is not installed.
        """
        try:
            pandas = import_module("pandas")
        except ImportError:
            message = "data frames need pandas, which is not installed"
            raise DesignError([Fault("E140", message, "", "pip install pandas")]) from None
        return {
            name: pandas.DataFrame(
                table.records(), columns=[column.key for column in table.columns if column.key]
            )
            for name, table in self.tables().items()
        }

    def to_frame(self) -> Any:
        """The first of its tables as a data frame (needs pandas): of a result its leading numbers, in one row.

        Raises
        ------
        DesignError
            E140 where pandas is not installed, E273 where it has no table.
        """
        frames = self.to_frames()
        if not frames:
            raise DesignError(
                [
                    Fault(
                        "E273",
                        f"{type(self).__name__} has no table",
                        "",
                        "to_dict() has all of it.",
                    )
                ]
            )
        return next(iter(frames.values()))
