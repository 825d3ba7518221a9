"""Joints from the rows of a list: its header, then row after row, every fault at once."""

import os
import re
from collections import Counter
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal

from slopekit.core.errors import DesignError, Fault, Faults
from slopekit.core.orientation import (
    Plane,
    azimuth_of,
    number,
    parse_quadrants,
    plane_by_side,
    plane_without_side,
)
from slopekit.core.units import quantity
from slopekit.design.reading.nodes import fail
from slopekit.design.reading.on_disk import read_bytes
from slopekit.design.survey.ags import read_ags_table
from slopekit.design.survey.bad_rows import BadRow, grouped_faults, skipped_rows
from slopekit.design.survey.beyond_vertical import SHARE_OF_BAD_ROWS, BeyondVertical, beyond_vertical, swapped_columns
from slopekit.design.survey.columns import (
    AMBIGUOUS_DIRECTIONS,
    COLUMNS,
    CORE,
    COUNTERS,
    ORIENTATIONS,
    RANKED,
    STRIKE_WITH_SIDE,
    WAYS,
    WORDS,
    SurveyColumn,
    checked_convention,
    column_of,
    columns_advice,
    key_of,
    named_in_order,
    names_may_repeat,
    size_of,
    spelled,
    way_of,
    why_no_joints,
)
from slopekit.design.survey.joint_list import JointList, MeasuredJoint
from slopekit.design.survey.oriented_core import CoreLog, core_columns
from slopekit.design.survey.planes import DIP_FIRST, PlaneReader, dip_and_azimuth, is_horizontal
from slopekit.design.survey.preamble import Preamble, preamble_of
from slopekit.design.survey.tables import SurveyTable, frame_table, headings_with_units

_NUMBER = re.compile(r"^[+-]?(\d+([.,]\d*)?|[.,]\d+)°?$")
_PLANE = re.compile(r"^\d+([.,]\d+)?°?\s*/\s*\d+([.,]\d+)?°?$")
_THOUSANDS = re.compile(r"^\d{1,3},\d{3}$")
#: Bytes of a list: 100,000 joints with ten columns, and room.
MOST_BYTES = 50_000_000
_TOO_LARGE = "Leave out the columns that are not used, or take a domain of the slope."
_HIGHEST_HEADER = 60  # rows among which the header is looked for
_FEW = 4  # columns that are listed one by one
_NAME_THE_COLUMNS = "Name the columns in the first line: name,dip,dip_direction."


def read_joints(
    path: str | os.PathLike[str],
    convention: str | None = None,
    skip_bad: bool = False,
    option: str = "convention:",
    sizes: bool = False,
    columns: str | Sequence[str] | None = None,
) -> JointList:
    """Read a joint list.

    Comma, semicolon, tab or blanks between the columns; decimal commas with all but the comma, or in quotes; lines that
    start with # or * are comments; or the first sheet of an .xlsx workbook. Columns are known by their names in any
    case, in English and German, in the header, which may be a comment, or in `columns`; two columns of numbers without
    either are dip and dip direction where the second cannot be a dip. Lines above the header are a preamble as Dips
    writes it. A column of sets serves as the names where no column of names is there and no set stands twice; a column
    of names most of which are shared is taken as one of sets. AGS 4 is read by its group DISC. alpha and beta on
    oriented core give planes with the trend and plunge of the hole, see `oriented_core`.

    Parameters
    ----------
    convention : what a strike column means: right-hand-rule, RHR (dip direction = strike + 90) or left-hand-rule, LHR
        (- 90)
    skip_bad : leave bad rows out, and say so, where they would stop the run; not where more than a tenth are bad
    option : how `convention` is called where the user can give it
    sizes : read columns of spacing, position, trace and its ends too
    columns : what the columns hold, from the first on, in place of a header

    Raises
    ------
    DesignError
        E101 to E108 and E113 to E115 for the values, E140 a workbook without openpyxl, E147 to E149 and E159 for the
        file, E190 no joints, E191 columns missing, unknown or twice, E192 a strike without its
        convention, or two formats, E193 a row, quantity or size that does not fit, or too many to be skipped: every bad
        row of the file, those of one kind together.
    """
    table = read_ags_table(Path(path).name, read_bytes(path, MOST_BYTES, _TOO_LARGE))
    return _Reader(table, convention, skip_bad, option, sizes, columns).survey()


def read_joints_text(
    name: str, text: str, skip_bad: bool = False, columns: str | Sequence[str] | None = None
) -> JointList:
    """Read the text of a joint list as `read_joints` reads a file of that name."""
    return _Reader(read_ags_table(name, text.encode()), None, skip_bad, "--convention", False, columns).survey()


def read_frame(
    frame: Any,
    convention: str | None = None,
    skip_bad: bool = False,
    option: str = "convention =",
    sizes: bool = False,
    columns: str | Sequence[str] | None = None,
) -> JointList:
    """Read a frame of pandas or polars as `read_joints` reads a file; its columns are named likewise."""
    return _Reader(frame_table(frame), convention, skip_bad, option, sizes, columns).survey()


class _Reader:
    """Reads the rows one after the other and collects their faults."""

    def __init__(
        self,
        table: SurveyTable,
        convention: str | None,
        skip_bad: bool,
        option: str,
        sizes: bool,
        columns: str | Sequence[str] | None,
    ) -> None:
        self.sizes = sizes
        self.table, self.name, self.skip_bad, self.option = table, table.name, skip_bad, option
        self.given = self.convention = convention
        self.order = named_in_order(columns)
        self.width = 2
        self.columns: dict[str, SurveyColumn] = {}
        self.headings: list[str] = list(WAYS[0])
        self.way: tuple[str, ...] = ("dip", "dip_direction")
        self.core: CoreLog | None = None
        self.may_repeat = False
        self.said = Preamble()
        self.faults = Faults()
        self.left_out: list[str] = list(table.left_out)
        self.read_as: list[str] = list(table.read_as)
        self.taken_names = set[str]()
        self.shared_names = Counter[str]()
        self.next_number: dict[str, int] = {}
        self.repeated = self.rows_read = 0

    def survey(self) -> JointList:
        if self.given is not None:
            self.convention = checked_convention(self.given, self.name)
        if not self.table.rows:
            advice = "The first line names the columns: name,dip,dip_direction."
            fail("E190", f"{self.name} holds no joints", self.name, advice)
        rows = self.along_holes(self.header())
        beyond = self.beyond_vertical(rows)
        self.planes = PlaneReader(self.way, self.convention, self.conventions(), self.said.declination_deg, beyond)
        self.names_of_rows(rows)
        joints, bad, names_of_bad = list[MeasuredJoint](), list[BadRow](), list[str]()
        for line in rows:
            joint = self.joint(line)
            if joint is not None:
                joints.append(joint)
                self.taken_names.add(joint.name)
            elif self.faults:
                bad.append((line, tuple(self.faults)))
                names_of_bad.append(self.name_in(self.table.cells(line), line))
                self.faults.clear()
        if bad:
            self.bad_rows(bad, names_of_bad, len(joints), beyond)
        elif not joints:
            fail("E190", f"{self.name} has a header and no joints", self.name, "Each row below it is one joint.")
        self.faults += self.planes.radians(self.name)
        self.faults.refuse()
        self.read_as += self.planes.read_as()
        self.read_as += self.core.read_as() if self.core is not None else []
        if self.repeated:
            many = self.repeated > 1
            names, them = ("names that stand", "them") if many else ("name that stands", "it")
            self.read_as.append(f"{self.repeated} {names} more than once got a number behind {them}")
        shared = frozenset(name for name, times in self.shared_names.items() if times > 1)
        return JointList(self.name, tuple(joints), tuple(self.left_out), tuple(self.read_as), shared)

    def bad_rows(self, bad: Sequence[BadRow], names: Sequence[str], good: int, beyond: BeyondVertical) -> None:
        """Leave bad rows out where that is allowed and they are few; else keep their faults, by kind."""
        too_many = len(bad) > SHARE_OF_BAD_ROWS * (len(bad) + good)
        if self.skip_bad and not too_many:
            self.left_out += skipped_rows(self.table.noun, bad, names)
            return
        if self.skip_bad:
            message = f"{len(bad)} of {len(bad) + good} rows of {self.name} are bad: more than a tenth is not skipped"
            self.faults.append(Fault("E193", message, self.name, "Mend the list: what is wrong with it follows."))
        if beyond.columns_are_swapped:
            suspects = [
                (line, faults) for line, faults in bad if any(fault.code in ("E101", "E103") for fault in faults)
            ]
            where = "; ".join(self.where(line) for line, _ in suspects[:3])
            self.faults.append(swapped_columns(self.name, where, self.headings, self.way, beyond, self.option))
            bad = [(line, [fault for fault in faults if fault.code not in ("E101", "E103")]) for line, faults in bad]
        self.faults += grouped_faults(bad, names)

    def beyond_vertical(self, rows: Sequence[int]) -> BeyondVertical:
        """What the dips and azimuths of the rows say of dips beyond 90°."""
        if self.way in (STRIKE_WITH_SIDE, CORE):
            return BeyondVertical()
        places = [self.columns[key].index for key in self.way]
        cells = [row for row in map(self.table.cells, rows) if len(row) > max(places)]
        return beyond_vertical(dip_and_azimuth(self.way, [row[place] for place in places]) for row in cells)

    def where(self, line: int) -> str:
        text = " ".join(self.table.shown(line).split())
        return f"{self.name}:{line}  {text if len(text) <= 80 else text[:79] + '…'}"

    def fault(self, code: str, message: str, line: int, advice: str = "") -> None:
        self.faults.append(Fault(code, message, self.where(line), advice))

    # -- columns -----------------------------------------------------------------------------------------------

    def header(self) -> list[int]:
        """Find the columns; returns the rows below the header."""
        rows = self.table.rows
        at = next((k for k in range(min(len(rows), _HIGHEST_HEADER)) if self.is_header(k)), None)
        above = rows if at is None else rows[:at]
        self.said = preamble_of([self.table.shown(row) for row in above[:_HIGHEST_HEADER]])
        if at is None and self.said.columns and not self.order:
            at = self.first_of_numbers(rows)
            if at is not None:
                if self.way == ("strike", "dip") and self.convention is None:
                    self.without_convention(rows[at], rows[at:])
                self.preamble(rows[:at])
                return list(rows[at:])
        commented = self.commented_header(rows) if at is None else None
        at = at or 0
        self.table.start(rows[at], blanks=commented is not None)
        cells = self.table.cells(rows[at])
        self.width = len(cells)
        below = list(rows[at + 1 :])
        header = rows[at]
        if commented is not None:
            below = list(rows)
            header, cells = commented
        elif at == 0 and self.is_bare(cells):
            if not self.order:
                self.bare_columns(cells, rows)
                return list(rows)
            below, cells = list(rows), [""] * self.width
        if self.order:
            cells = self.ordered(cells, header)
        with_units = headings_with_units(cells, self.table.cells(below[0])) if below else None
        if with_units is not None:
            self.read_as.append(f"{self.table.noun} {below[0]} holds units")
            cells, below = with_units, below[1:]
        self.named_columns(cells, header, below)
        self.preamble(rows[:at])
        return below

    def is_bare(self, cells: Sequence[str]) -> bool:
        """Whether the first row holds a joint in place of a header: numbers alone, or in the columns that are named."""
        if self.order:
            return any(_NUMBER.match(cell) or _PLANE.match(cell) for cell in cells[: len(self.order)])
        return all(_NUMBER.match(cell) for cell in cells if cell)

    def ordered(self, cells: Sequence[str], line: int) -> list[str]:
        """The headings with those that the user gives in their place."""
        if len(self.order) > len(cells):
            message = f"{len(self.order)} columns are named, {self.name} has {len(cells)}"
            raise DesignError([Fault("E191", message, self.where(line), ", ".join(self.order))])
        return [*self.order, *cells[len(self.order) :]]

    def bare_columns(self, cells: Sequence[str], rows: Sequence[int]) -> None:
        """Two columns of numbers without a header: dip and dip direction, where only the first can be a dip."""
        name_them = f"{_NAME_THE_COLUMNS} Or {columns_advice(self.option, WAYS[0])}."
        if len(cells) != 2:
            message = f"{self.name} has no header, and {len(cells)} columns of numbers"
            raise DesignError([Fault("E191", message, self.where(rows[0]), name_them)])
        self.columns = {"dip": SurveyColumn(0), "dip_direction": SurveyColumn(1)}
        if self.beyond_vertical(rows).fits_both_orders:
            message = f"{self.name} has no header, and no number over 90 says which of its two columns is the dip"
            exchanged = columns_advice(self.option, WAYS[0][::-1])
            raise DesignError([Fault("E191", message, self.where(rows[0]), f"{name_them[:-1]}, or {exchanged}.")])

    def commented_header(self, rows: Sequence[int]) -> tuple[int, list[str]] | None:
        """The nearest comment above the rows that names columns which give planes, and its cells."""
        self.table.start(rows[0], blanks=True)
        first = self.table.cells(rows[0])
        if not any(_NUMBER.match(cell) or _PLANE.match(cell) or parse_quadrants(cell) for cell in first):
            return None
        for row in reversed(self.table.comments):
            for blanks in (False, True):
                self.table.start(row, blanks)
                cells = [cell.lstrip("#* ") if k == 0 else cell for k, cell in enumerate(self.table.cells(row))]
                cells = cells[1:] if len(cells) == len(first) + 1 and not cells[0] else cells
                if len(cells) == len(first) and way_of(key for key in map(key_of, cells) if key) is not None:
                    return row, cells
        return None

    def is_header(self, k: int) -> bool:
        """Whether the columns of a row give planes; a line DIP/DIPDIRECTION may be a preamble's: planes stand below."""
        row, below = self.table.rows[k], self.table.rows[k + 1 : k + 2]
        self.table.start(row)
        cells = self.table.cells(row)
        if way_of(key for key in map(key_of, cells) if key) is None:
            return False
        first = [next(iter(self.table.cells(row)), "") for row in below]
        return len(cells) > 1 or any(_PLANE.match(text) or parse_quadrants(text) for text in first)

    def first_of_numbers(self, rows: Sequence[int]) -> int | None:
        """The first row that begins with two numbers, and as many cells as all rows below it."""
        for k, row in enumerate(rows[:_HIGHEST_HEADER]):
            self.table.start(row, blanks=True)
            cells = self.table.cells(row)
            begins = len(cells) > 1 and all(_NUMBER.match(cell) for cell in cells[:2])
            if begins and all(len(self.table.cells(below)) == len(cells) for below in rows[k:]):
                self.width, self.way = len(cells), self.said.columns
                keys = [*self.way, *(["quantity"] if self.said.has_quantity and len(cells) > 2 else [])]
                self.columns = {key: SurveyColumn(index, WORDS[key]) for index, key in enumerate(keys)}
                more = len(cells) - len(keys)
                self.left_out += [f"{more} column{'s' if more > 1 else ''} without a name"] if more else []
                return k
        return None

    def preamble(self, above: Sequence[int]) -> None:
        """What the lines above the header say of the orientations."""
        if above:
            noun = self.table.noun + ("s" if len(above) > 1 else "")
            lines = f"{above[0]} to {above[-1]}" if len(above) > 1 else f"{above[0]}"
            self.left_out.append(f"{noun} {lines} (above the columns)")
        said = self.said
        if said.traverses:
            self.left_out.append(f"{said.traverses} traverses (no joint is weighted by them)")
        is_of_core = said.core and self.core is None
        if is_of_core or said.others:
            what = "alpha and beta on core" if is_of_core else f"{said.written} and {', '.join(said.others)}"
            advice = "Save the processed file in Dips: one format for all rows."
            self.fault("E192", f"the orientations of {self.name} are {what}: not all mean the same", above[0], advice)
        self.strikes(above[0] if above else self.table.rows[0])
        self.poles()
        if said.declination_deg:
            self.read_as.append(f"a declination of {number(said.declination_deg)}° is added to all azimuths")
        self.faults.refuse()

    def strikes(self, line: int) -> None:
        """The convention of a strike: of the header, the preamble or the user, who must not contradict each other."""
        if self.way[0] not in ("strike", "strike/dip") or self.way == STRIKE_WITH_SIDE:
            return
        column = self.columns[self.way[0]]
        of_list = column.convention or (self.said.convention if "strike" in self.said.columns else None)
        if of_list is None:
            return
        if self.convention is not None and self.convention != of_list:
            message = f"strikes are {of_list} by {self.name}, {self.convention} by {self.option.rstrip(' =:')}"
            self.fault("E192", message, line, "Leave one of them out.")
        self.convention = of_list
        self.read_as.append(f"strikes are {of_list}, as {column.heading if column.convention else 'the preamble'} says")

    def poles(self) -> None:
        if "trend" in self.way:
            self.read_as.append("trend and plunge are of poles: dip = 90 - plunge, dip direction = trend + 180")

    def named_columns(self, cells: Sequence[str], line: int, below: Sequence[int]) -> None:
        """The columns by their headings, and how they give a plane."""
        if why := why_no_joints(cells):
            raise DesignError([Fault("E191", f"the rows of {self.name} {why}", self.where(line))])
        self.may_repeat = names_may_repeat(cells)
        ignored: list[str] = []
        for index, cell in enumerate(cells):
            size = size_of(cell) if self.sizes else None
            if key_of(cell) is not None:
                self.column(index, cell, cells, line)
            elif size is not None and size not in self.columns:
                self.columns[size] = column_of(index, cell)
            elif any(len(row) > index and row[index] for row in map(self.table.cells, below)):
                ignored.append(cell or str(index + 1))
        if len(ignored) > _FEW:
            self.left_out.append(f"{len(ignored)} columns ({', '.join(ignored)})")
        else:
            self.left_out += [f"column {cell}" for cell in ignored]
        self.columns = core_columns(self.name, self.columns, cells, map(self.table.cells, below), self.where(line))
        way = way_of(self.columns)
        if way is None:
            missing = [key for key in WAYS[0] if key not in self.columns]
            names = " and ".join(WORDS[key] for key in missing)
            self.fault("E191", f"{self.name} has no column for {names}", line, self.near_columns(cells))
            raise DesignError(self.faults)
        if way == WAYS[0] and "strike" in self.columns:
            column = self.columns["dip_direction"].index
            sides = [row[column] for row in map(self.table.cells, below) if len(row) > column and row[column]]
            if not sides:
                way = ("strike", "dip")
                del self.columns["dip_direction"]
            elif all(azimuth_of(side) is not None for side in sides):
                self.way = STRIKE_WITH_SIDE
        if way == CORE[:4]:
            way, self.core = CORE, CoreLog(self.columns, cells)
        self.way = self.way if self.way == STRIKE_WITH_SIDE else way
        self.headings = [key if (key := key_of(cell)) in self.way else cell for cell in cells]
        for key in [key for key in self.columns if key not in self.way and any(key in way for way in WAYS)]:
            given = WORDS[way[-1]] if way == WAYS[0] else " and ".join(WORDS[part] for part in way)
            verb = "is" if way == WAYS[0] or len(way) == 1 else "are"
            self.left_out.append(
                f"column {key if key == 'strike' else self.columns[key].heading} (the {given} {verb} given)"
            )
            del self.columns[key]
        if self.way == WAYS[0] and spelled(heading := self.columns["dip_direction"].heading) in AMBIGUOUS_DIRECTIONS:
            self.read_as.append(f"{heading} is read as the dip direction")
        if way == ("strike", "dip") and self.convention is None and self.columns["strike"].convention is None:
            self.without_convention(line, below)
        self.faults.refuse()

    def without_convention(self, line: int, below: Sequence[int]) -> None:
        """A strike needs its convention, but where every dip says which side it dips to, or a preamble says it."""
        column = self.columns["dip"].index
        dips = [row[column] for row in map(self.table.cells, below) if len(row) > column and row[column]]
        says = self.said.convention is not None and "strike" in self.said.columns
        sided = (plane_by_side(0.0, dip) or plane_by_side(45.0, dip) or plane_without_side(0.0, dip) for dip in dips)
        if not says and not (dips and all(sided)):
            self.fault("E192", "a strike column has two meanings, its convention is not said", line, self.conventions())

    def conventions(self) -> str:
        right, left = "right-hand-rule (RHR: dip direction = strike + 90)", "left-hand-rule (LHR: strike - 90)"
        if not self.option:
            return "Say so in the header of the list: strike (RHR) or strike (LHR)."
        return f"Say {self.option} {right} or {left}."

    def column(self, index: int, cell: str, cells: Sequence[str], line: int) -> None:
        column = column_of(index, cell)
        key = key_of(cell)
        assert key is not None
        if key in self.columns:
            other = cells[self.columns[key].index]
            if key not in RANKED:
                message = f"{self.name} has two columns for {WORDS[key]}: {other} and {cell}"
                self.fault("E191", message, line, "Leave one of them out.")
                return
            names = COLUMNS[key]
            if names.index(spelled(cell)) > names.index(spelled(other)):
                self.left_out.append(f"column {cell}")
                return
            self.left_out.append(f"column {other}")
        if key in ORIENTATIONS and column.unit:
            self.fault("E191", f"the column {cell} is in {column.unit}, an orientation is in degrees", line)
        self.columns[key] = column

    def near_columns(self, cells: Sequence[str]) -> str:
        known = [name for key in WAYS[0] for name in COLUMNS[key]]
        free = [cell for k, cell in enumerate(cells) if k not in {column.index for column in self.columns.values()}]
        near = [(cell, matches[0]) for cell in free if (matches := get_close_matches(cell.lower(), known, n=1))]
        if near:
            return f"Did you mean {near[0][1]} by {near[0][0]}?"
        if any(map(_NUMBER.match, cells)):
            return f"{_NAME_THE_COLUMNS} Or {columns_advice(self.option, ('name', *WAYS[0]))}."
        if len(cells) == 1:
            return "Columns are separated by a comma, a semicolon or a tab: dip,dip_direction."
        return _NAME_THE_COLUMNS

    def names_of_rows(self, rows: Sequence[int]) -> None:
        """Where only sets are given and each stands once, they are what the joints are called; so are counters."""
        name, group = self.columns.get("name"), self.columns.get("set")
        if name is not None and spelled(name.heading) in COUNTERS and not self.once(name, rows):
            self.left_out.append(f"column {name.heading} (its numbers stand more than once)")
            del self.columns["name"]
        elif name is None and group is not None and self.once(group, rows):
            self.columns["name"] = self.columns.pop("set")
        elif name is not None and not self.may_repeat:
            self.shared(name, rows)

    def shared(self, column: SurveyColumn, rows: Sequence[int]) -> None:
        """Take a column of names most of which are shared for the sets; else names may repeat, and are numbered."""
        cells = (row[column.index] for row in map(self.table.cells, rows) if len(row) > column.index)
        self.shared_names = Counter(name for name in cells if name)
        alike = sum(times for times in self.shared_names.values() if times > 1)
        if alike and "set" not in self.columns and 2 * alike > self.shared_names.total():
            self.columns["set"] = self.columns.pop("name")
            self.read_as.append(f"column {column.heading} is taken as the set: its names stand more than once")

    def along_holes(self, rows: list[int]) -> list[int]:
        """The rows of joints, without survey stations; depths in several holes are no positions along one line."""
        hole, position = self.columns.get("hole"), self.columns.get("position")
        holes = (
            set()
            if hole is None
            else {cells[hole.index] for cells in map(self.table.cells, rows) if cells[hole.index :]}
        )
        if position is not None and len(holes) > 1:
            del self.columns["position"]
            self.left_out.append(f"column {position.heading} (it runs along {len(holes)} holes)")
        joints = rows if self.core is None else [row for row in rows if not self.core.is_station(self.table.cells(row))]
        used = {"reference"} if self.core is not None else set()
        used |= {"hole"} if len(joints) < len(rows) else set()
        self.left_out += [
            f"column {self.columns[key].heading}"
            for key in ("hole", "reference")
            if key in self.columns and key not in used
        ]
        return joints

    def once(self, column: SurveyColumn, rows: Sequence[int]) -> bool:
        entries = [cells[column.index] for cells in map(self.table.cells, rows) if len(cells) > column.index]
        return len(set(entries)) == len(rows)

    # -- rows --------------------------------------------------------------------------------------------------

    def joint(self, line: int) -> MeasuredJoint | None:
        cells = self.table.cells(line)
        if not any(cells):
            self.left_out.append(f"{self.table.noun} {line} (empty cells)")
            return None
        if len(cells) > self.width and not any(cells[self.width :]):
            cells = cells[: self.width]
        if len(cells) > self.width:
            decimal = self.table.delimiter == "," and "." not in self.table.shown(line)
            advice = "Decimals take a point; decimal commas need ; between the columns." if decimal else ""
            message = f"{self.table.noun} {line} has {len(cells)} values for {self.width} columns"
            self.fault("E193", message, line, advice)
            return None
        cells = [*cells, *[""] * (self.width - len(cells))]
        weight = self.quantity(cells, line)
        if weight == 0.0:
            self.left_out.append(f"{self.table.noun} {line} (quantity 0)")
            return None
        faults_before = len(self.faults) - (weight is None)
        self.rows_read += 1
        name = self.joint_name(cells, line)
        plane = self.plane(name, cells, line)
        cohesion = self.strength("c", name, cells, line)
        friction = self.strength("phi", name, cells, line)
        spacing, position, trace = (self.size(key, name, cells, line) for key in ("spacing", "position", "trace"))
        ends = self.ends(name, cells, line)
        if plane is None or weight is None or len(self.faults) > faults_before:
            return None
        column = self.columns.get("set")
        of = cells[column.index] if column else ""
        return MeasuredJoint(name, plane, line, cohesion, friction, of, weight, spacing, position, trace, ends)

    def cell(self, key: str, cells: Sequence[str]) -> str:
        """The text of a column in a row, with a decimal point and the unit of the header."""
        column = self.columns.get(key)
        text = cells[column.index] if column else ""
        if _NUMBER.match(text):  # a comma between the columns is none here: the number stands in quotes
            text = text.replace(",", ".")
        return f"{text} {column.unit}" if column and column.unit and _NUMBER.match(text) else text

    def quantity(self, cells: Sequence[str], line: int) -> float | None:
        """How often a row counts; 1 where nothing is given, None where that is no number."""
        text = self.cell("quantity", cells)
        if not text:
            return 1.0
        value = float(text) if _NUMBER.match(text) and "°" not in text else -1.0
        if value < 0.0:
            heading = self.columns["quantity"].heading
            self.fault("E193", f"{heading} of {self.table.noun} {line} is {text!r}, it is a number from 0", line)
            return None
        return value

    def name_in(self, cells: Sequence[str], line: int) -> str:
        """What a row calls its joint, or J and a number where it has no name."""
        column = self.columns.get("name")
        name = cells[column.index] if column and len(cells) > column.index else ""
        return name or f"J{line if column else self.rows_read}"

    def joint_name(self, cells: Sequence[str], line: int) -> str:
        """The name of a joint, with a number behind it where another joint has it already."""
        name = self.name_in(cells, line)
        if name not in self.taken_names:
            return name
        self.repeated += 1
        numbers = range(self.next_number.get(name, 2), line + 3)
        number_behind = next(k for k in numbers if f"{name}-{k}" not in self.taken_names)
        self.next_number[name] = number_behind + 1
        return f"{name}-{number_behind}"

    def plane(self, name: str, cells: Sequence[str], line: int) -> Plane | None:
        texts = {key: self.cell(key, cells) for key in self.way}
        texts = texts if self.core is None else self.core.completed(texts, cells)
        empty = [key for key in sorted(texts, key=DIP_FIRST) if not texts[key]]
        if empty == ["dip_direction"] and (self.way == STRIKE_WITH_SIDE or is_horizontal(texts["dip"])):
            empty.clear()
        if empty:
            self.fault("E193", f"{name} has no {' and no '.join(WORDS[key] for key in empty)}", line)
            return None
        return self.faults.of(self.planes.plane, name, tuple(texts.values()), self.where(line))

    # -- sizes -------------------------------------------------------------------------------------------------

    def size(self, key: str, name: str, cells: Sequence[str], line: int) -> float | None:
        """A length, None where the cell is empty."""
        text = self.cell(key, cells)
        if not text:
            return None
        what = f"{key} of {name}"
        value = self.faults.of(quantity, text, "length", what, self.where(line))
        if value is not None and key != "position" and value <= 0.0:
            self.fault("E193", f"{what} is {number(value)} m, it must be more than 0", line, "Leave the cell empty.")
            return None
        return value

    def ends(self, name: str, cells: Sequence[str], line: int) -> int | None:
        """How many ends of the trace were seen."""
        text = self.cell("ends", cells)
        if text and text not in ("0", "1", "2"):
            message = f"ends of {name} is {text!r}, of a trace 0, 1 or 2 ends are seen"
            self.fault("E193", message, line, "Leave the cell empty where it is not known.")
            return None
        return int(text) if text else None

    # -- strength ----------------------------------------------------------------------------------------------

    def strength(self, key: Literal["c", "phi"], name: str, cells: Sequence[str], line: int) -> float | None:
        text = self.cell(key, cells)
        if not text:
            return None
        if key == "c" and self.table.delimiter == "," and _THOUSANDS.match(cells[self.columns[key].index]):
            advice = "Write it without the comma, or with a point."
            self.fault("E193", f"c of {name} has a comma that may part decimals or thousands", line, advice)
            return None
        kind = "pressure" if key == "c" else "angle"
        value = self.faults.of(quantity, text, kind, f"{key} of {name}", self.where(line))
        if value is None:
            return None
        if key == "c" and value < 0.0:
            self.fault("E114", f"c of {name} is {number(value)} kPa, cohesion is never negative", line)
        elif key == "phi" and not 0.0 <= value < 90.0:
            self.fault("E115", f"phi of {name} is {number(value)}°, a friction angle lies from 0 to below 90", line)
        elif key == "phi" and 0.0 < value < 1.571 and value != int(value):
            advice = "Degrees are needed; write 0 for a joint without friction."
            self.fault("E113", f"phi of {name} is {number(value)}°, that looks like radians", line, advice)
        return value
