"""Joints from the rows of a list: its header, then row after row, every fault at once."""

import os
import re
from collections import Counter
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

from slopekit.core.errors import DesignError, Fault, Faults
from slopekit.core.orientation import (
    Plane,
    azimuth_of,
    number,
    parse_quadrants,
    plane_by_side,
    plane_without_side,
)
from slopekit.design.fields import Field, fields_of
from slopekit.design.reading.nodes import fail
from slopekit.design.reading.on_disk import read_bytes
from slopekit.design.survey.columns import (
    AMBIGUOUS_DIRECTIONS,
    COLUMNS,
    CORE,
    COUNTERS,
    NUMBER,
    ORIENTATIONS,
    RANKED,
    SIZES,
    STRIKE_WITH_SIDE,
    WAYS,
    WORDS,
    Preamble,
    SurveyColumn,
    checked_convention,
    column_of,
    columns_advice,
    key_of,
    named_in_order,
    names_may_repeat,
    number_in,
    plane_columns,
    preamble_of,
    spelled,
    why_no_joints,
)
from slopekit.design.survey.joint_list import BadRow, JointList, MeasuredJoint, grouped_faults, skipped_rows
from slopekit.design.survey.oriented_core import CoreLog, core_columns
from slopekit.design.survey.planes import (
    DIP_FIRST,
    SHARE_OF_BAD_ROWS,
    BeyondVertical,
    PlaneReader,
    beyond_vertical,
    dip_and_azimuth,
    swapped_columns,
)
from slopekit.design.survey.tables import SurveyTable, frame_table, headings_with_units, read_table

_PLANE = re.compile(r"^\d+([.,]\d+)?°?\s*/\s*\d+([.,]\d+)?°?$")
_COUNT = re.compile(r"^[+-]?(\d+(\.\d*)?|\.\d+)$")
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
    table = read_table(Path(path).name, read_bytes(path, MOST_BYTES, _TOO_LARGE))
    return _Reader(table, convention, skip_bad, option, sizes, columns).survey()


def read_joints_text(
    name: str, text: str, skip_bad: bool = False, columns: str | Sequence[str] | None = None
) -> JointList:
    """Read the text of a joint list as `read_joints` reads a file of that name."""
    return _Reader(read_table(name, text.encode()), None, skip_bad, "--convention", False, columns).survey()


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
        self.convention = None if convention is None else checked_convention(convention, self.name)
        self.order = named_in_order(columns)
        self.width = 0
        self.rows: dict[int, list[str]] = {}  # below the header, as many cells in each as there are columns
        self.columns: dict[str, SurveyColumn] = {}
        self.headings: list[str] = []
        self.way: tuple[str, ...] = WAYS[0]
        self.core: CoreLog | None = None
        self.may_repeat = False
        self.above = Preamble()
        self.faults = Faults()
        self.left_out: list[str] = list(table.left_out)
        self.read_as: list[str] = list(table.read_as)
        self.names = set[str]()
        self.shared_names = Counter[str]()
        self.next_number: dict[str, int] = {}
        self.repeated = self.rows_read = 0

    def survey(self) -> JointList:
        if not self.table.rows:
            advice = "The first line names the columns: name,dip,dip_direction."
            fail("E190", f"{self.name} holds no joints", self.name, advice)
        self.header()
        self.along_holes()
        beyond = self.beyond_vertical()
        self.planes = PlaneReader(self.way, self.convention, self.conventions(), self.above.declination_deg, beyond)
        self.names_of_rows()
        self.values = [(name, field) for name, field in fields_of(MeasuredJoint).items() if field.path in self.columns]
        joints, bad = list[MeasuredJoint](), list[BadRow]()
        for line, cells in self.rows.items():
            joint = self.joint(line, cells)
            if joint is not None:
                joints.append(joint)
                self.names.add(joint.name)
            elif self.faults:
                bad.append((line, self.name_in(cells, line), tuple(self.faults)))
                self.faults.clear()
        if bad:
            self.bad_rows(bad, len(joints), beyond)
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

    def bad_rows(self, bad: Sequence[BadRow], good: int, beyond: BeyondVertical) -> None:
        """Leave bad rows out where that is allowed and they are few; else keep their faults, by kind."""
        too_many = len(bad) > SHARE_OF_BAD_ROWS * (len(bad) + good)
        if self.skip_bad and not too_many:
            self.left_out += skipped_rows(self.table.noun, bad)
            return
        if self.skip_bad:
            message = f"{len(bad)} of {len(bad) + good} rows of {self.name} are bad: more than a tenth is not skipped"
            self.faults.append(Fault("E193", message, self.name, "Mend the list: what is wrong with it follows."))
        if beyond.columns_are_swapped:
            swapped = {fault for _, _, faults in bad for fault in faults if fault.code in ("E101", "E103")}
            suspects = [line for line, _, faults in bad if not swapped.isdisjoint(faults)]
            places = "; ".join(map(self.where, suspects[:3]))
            self.faults.append(swapped_columns(self.name, places, self.headings, self.way, beyond, self.option))
            bad = [(line, name, [fault for fault in faults if fault not in swapped]) for line, name, faults in bad]
        self.faults += grouped_faults(bad)

    def beyond_vertical(self) -> BeyondVertical:
        """What the dips and azimuths of the rows say of dips beyond 90°."""
        if self.way in (STRIKE_WITH_SIDE, CORE):
            return BeyondVertical()
        indices = [self.columns[key].index for key in self.way]
        texts = ([cells[index] for index in indices] for cells in self.rows.values())
        return beyond_vertical(dip_and_azimuth(self.way, row) for row in texts)

    def where(self, line: int) -> str:
        text = " ".join(self.table.shown(line).split())
        return f"{self.name}:{line}  {text if len(text) <= 80 else text[:79] + '…'}"

    def fault(self, code: str, message: str, line: int, advice: str = "") -> None:
        self.faults.append(Fault(code, message, self.where(line), advice))

    def refuse(self, code: str, message: str, line: int, advice: str = "") -> NoReturn:
        fail(code, message, self.where(line), advice)

    # -- columns -----------------------------------------------------------------------------------------------

    def header(self) -> None:
        """Find the columns, and the rows below them."""
        rows = self.table.rows
        named = next((k for k in range(min(len(rows), _HIGHEST_HEADER)) if self.is_header(k)), None)
        self.above = preamble_of([self.table.shown(row) for row in rows[:_HIGHEST_HEADER][:named]])
        bare = self.first_of_numbers() if named is None and self.above.columns and not self.order else None
        comment = self.commented_header() if named is None and bare is None else None
        k = named or bare or 0
        line, below = rows[k], rows[k:]
        self.table.start(line, blanks=bare is not None or comment is not None)
        cells = self.table.cells(line)
        self.width, has_no_header = len(cells), False
        if bare is not None:
            keys = (*self.above.columns, "quantity") if self.above.has_quantity else self.above.columns
            headings = [WORDS[key] for key in keys[: self.width]]
        elif comment is not None:
            line, headings = comment
        elif k == 0 and self.is_bare(cells):
            has_no_header, headings = not self.order, list(WAYS[0])
        else:
            headings, below = cells, rows[k + 1 :]
        if has_no_header and self.width != len(WAYS[0]):
            self.refuse(
                "E191",
                f"{self.name} has no header, and {self.width} columns of numbers",
                line,
                f"{_NAME_THE_COLUMNS} Or {columns_advice(self.option, WAYS[0])}.",
            )
        headings = self.ordered(headings, line)
        self.rows = {row: self.padded(self.table.cells(row)) for row in below}
        with_units = headings_with_units(headings, self.rows[below[0]]) if below else None
        if with_units is not None:
            self.read_as.append(f"{self.table.noun} {below[0]} holds units")
            headings = with_units
            del self.rows[below[0]]
        self.named_columns(headings, line)
        if has_no_header and self.beyond_vertical().fits_both_orders:
            message = f"{self.name} has no header, and no number over 90 says which of its two columns is the dip"
            first, second = (columns_advice(self.option, order) for order in (WAYS[0], WAYS[0][::-1]))
            self.refuse("E191", message, line, f"{_NAME_THE_COLUMNS} Or {first}, or {second}.")
        self.preamble(rows[:k])

    def padded(self, cells: list[str]) -> list[str]:
        """The cells of a row with empty ones for those that it lacks."""
        return [*cells, *[""] * (self.width - len(cells))]

    def is_bare(self, cells: Sequence[str]) -> bool:
        """Whether the first row holds a joint in place of a header: numbers alone, or in the columns that are named."""
        if self.order:
            return any(NUMBER.match(cell) or _PLANE.match(cell) for cell in cells[: len(self.order)])
        return all(NUMBER.match(cell) for cell in cells if cell)

    def ordered(self, headings: Sequence[str], line: int) -> list[str]:
        """The headings of all columns, with those that the user gives in their place."""
        if len(self.order) > self.width:
            message = f"{len(self.order)} columns are named, {self.name} has {self.width}"
            self.refuse("E191", message, line, ", ".join(self.order))
        return self.padded([*self.order, *headings[len(self.order) :]])

    def commented_header(self) -> tuple[int, list[str]] | None:
        """The nearest comment above the rows that names columns which give planes, and its cells."""
        first_row = self.table.rows[0]
        self.table.start(first_row, blanks=True)
        first = self.table.cells(first_row)
        if not any(NUMBER.match(cell) or _PLANE.match(cell) or parse_quadrants(cell) for cell in first):
            return None
        for row in reversed(self.table.comments):
            for blanks in (False, True):
                self.table.start(row, blanks)
                cells = [cell.lstrip("#* ") if k == 0 else cell for k, cell in enumerate(self.table.cells(row))]
                cells = cells[1:] if len(cells) == len(first) + 1 and not cells[0] else cells
                if len(cells) == len(first) and plane_columns(map(key_of, cells)) is not None:
                    return row, cells
        return None

    def is_header(self, k: int) -> bool:
        """Whether the columns of a row give planes; a line DIP/DIPDIRECTION may be a preamble's: planes stand below."""
        row, below = self.table.rows[k], self.table.rows[k + 1 : k + 2]
        self.table.start(row)
        cells = self.table.cells(row)
        if plane_columns(map(key_of, cells)) is None:
            return False
        first = [next(iter(self.table.cells(row)), "") for row in below]
        return len(cells) > 1 or any(_PLANE.match(text) or parse_quadrants(text) for text in first)

    def first_of_numbers(self) -> int | None:
        """The first row that begins with two numbers, and has as many cells as all rows below it."""
        rows = self.table.rows
        for k, row in enumerate(rows[:_HIGHEST_HEADER]):
            self.table.start(row, blanks=True)
            cells = self.table.cells(row)
            begins = len(cells) > 1 and all(NUMBER.match(cell) for cell in cells[:2])
            if begins and all(len(self.table.cells(below)) == len(cells) for below in rows[k:]):
                return k
        return None

    def preamble(self, lines: Sequence[int]) -> None:
        """What the lines above the header say of the orientations."""
        if lines:
            noun = self.table.noun + ("s" if len(lines) > 1 else "")
            numbers = f"{lines[0]} to {lines[-1]}" if len(lines) > 1 else f"{lines[0]}"
            self.left_out.append(f"{noun} {numbers} (above the columns)")
        above, line = self.above, (lines or self.table.rows)[0]
        if above.traverses:
            self.left_out.append(f"{above.traverses} traverses (no joint is weighted by them)")
        is_of_core = above.core and self.core is None
        if is_of_core or above.others:
            what = "alpha and beta on core" if is_of_core else f"{above.written} and {', '.join(above.others)}"
            advice = "Save the processed file in Dips: one format for all rows."
            self.fault("E192", f"the orientations of {self.name} are {what}: not all mean the same", line, advice)
        self.strikes(line)
        if "trend" in self.way:
            self.read_as.append("trend and plunge are of poles: dip = 90 - plunge, dip direction = trend + 180")
        if above.declination_deg:
            self.read_as.append(f"a declination of {number(above.declination_deg)}° is added to all azimuths")
        self.faults.refuse()

    def strikes(self, line: int) -> None:
        """The convention of a strike: of the header, the preamble or the user, who must not contradict each other."""
        if self.way[0] not in ("strike", "strike/dip") or self.way == STRIKE_WITH_SIDE:
            return
        column = self.columns[self.way[0]]
        of_list = column.convention or (self.above.convention if "strike" in self.above.columns else None)
        if of_list is None:
            return
        if self.convention is not None and self.convention != of_list:
            message = f"strikes are {of_list} by {self.name}, {self.convention} by {self.option.rstrip(' =:')}"
            self.fault("E192", message, line, "Leave one of them out.")
        self.convention = of_list
        self.read_as.append(f"strikes are {of_list}, as {column.heading if column.convention else 'the preamble'} says")

    def named_columns(self, headings: Sequence[str], line: int) -> None:
        """The columns by their headings, and how they give a plane."""
        if why := why_no_joints(headings):
            self.refuse("E191", f"the rows of {self.name} {why}", line)
        self.may_repeat = names_may_repeat(headings)
        ignored: list[str] = []
        for index, heading in enumerate(headings):
            key = key_of(heading)
            if key is not None and (key not in SIZES or (self.sizes and key not in self.columns)):
                self.column(index, key, headings, line)
            elif any(cells[index] for cells in self.rows.values()):
                ignored.append(heading or str(index + 1))
        if len(ignored) > _FEW:
            self.left_out.append(f"{len(ignored)} columns ({', '.join(ignored)})")
        else:
            self.left_out += [f"column {heading}" for heading in ignored]
        self.columns = core_columns(self.name, self.columns, headings, self.rows.values(), self.where(line))
        way = plane_columns(self.columns)
        if way is None:
            names = " and ".join(WORDS[key] for key in WAYS[0] if key not in self.columns)
            self.fault("E191", f"{self.name} has no column for {names}", line, self.near_columns(headings))
            raise DesignError(self.faults)
        if way == WAYS[0] and "strike" in self.columns:
            sides = self.filled("dip_direction")
            if not sides:
                way = ("strike", "dip")
                del self.columns["dip_direction"]
            elif all(azimuth_of(side) is not None for side in sides):
                way = STRIKE_WITH_SIDE
        if way == CORE[:4]:
            way, self.core = CORE, CoreLog(self.columns, headings)
        self.way = way
        self.headings = [key if (key := key_of(heading)) in way else heading for heading in headings]
        for key in [key for key in self.columns if key not in way and any(key in way for way in WAYS)]:
            by = WORDS[way[-1]] if way[-1] == "dip_direction" else " and ".join(map(WORDS.__getitem__, way))
            verb = "are" if " and " in by else "is"
            heading = key if key == "strike" else self.columns.pop(key).heading
            self.left_out.append(f"column {heading} (the {by} {verb} given)")
        if way == WAYS[0] and spelled(heading := self.columns["dip_direction"].heading) in AMBIGUOUS_DIRECTIONS:
            self.read_as.append(f"{heading} is read as the dip direction")
        if way == ("strike", "dip") and self.convention is None and self.columns["strike"].convention is None:
            self.without_convention(line)
        self.faults.refuse()

    def filled(self, key: str) -> list[str]:
        """What stands in a column, empty cells left out."""
        index = self.columns[key].index
        return [cells[index] for cells in self.rows.values() if cells[index]]

    def without_convention(self, line: int) -> None:
        """A strike needs its convention, but where every dip says which side it dips to, or a preamble says it."""
        dips = self.filled("dip")
        says = self.above.convention is not None and "strike" in self.above.columns
        sided = (plane_by_side(0.0, dip) or plane_by_side(45.0, dip) or plane_without_side(0.0, dip) for dip in dips)
        if not says and not (dips and all(sided)):
            self.fault("E192", "a strike column has two meanings, its convention is not said", line, self.conventions())

    def conventions(self) -> str:
        right, left = "right-hand-rule (RHR: dip direction = strike + 90)", "left-hand-rule (LHR: strike - 90)"
        if not self.option:
            return "Say so in the header of the list: strike (RHR) or strike (LHR)."
        return f"Say {self.option} {right} or {left}."

    def column(self, index: int, key: str, headings: Sequence[str], line: int) -> None:
        """Take a column for what its heading says; of two for the same, the one whose name comes first in `COLUMNS`."""
        column = column_of(index, headings[index])
        if key in self.columns:
            other = self.columns[key]
            if key not in RANKED:
                message = f"{self.name} has two columns for {WORDS[key]}: {other.heading} and {column.heading}"
                self.fault("E191", message, line, "Leave one of them out.")
                return
            column, second = sorted((column, other), key=lambda each: COLUMNS[key].index(spelled(each.heading)))
            self.left_out.append(f"column {second.heading}")
        if key in ORIENTATIONS and column.unit:
            message = f"the column {column.heading} is in {column.unit}, an orientation is in degrees"
            self.fault("E191", message, line)
        self.columns[key] = column

    def near_columns(self, headings: Sequence[str]) -> str:
        known = [name for key in WAYS[0] for name in COLUMNS[key]]
        free = [heading for heading in headings if key_of(heading) not in self.columns]
        near = [(heading, names[0]) for heading in free if (names := get_close_matches(heading.lower(), known, n=1))]
        if near:
            return f"Did you mean {near[0][1]} by {near[0][0]}?"
        if any(map(NUMBER.match, headings)):
            return f"{_NAME_THE_COLUMNS} Or {columns_advice(self.option, ('name', *WAYS[0]))}."
        if len(headings) == 1:
            return "Columns are separated by a comma, a semicolon or a tab: dip,dip_direction."
        return _NAME_THE_COLUMNS

    def names_of_rows(self) -> None:
        """Where only sets are given and each stands once, they are what the joints are called; so are counters.

        A column of names most of which are shared is taken for the sets; else names may repeat, and are numbered.
        """
        name, group = self.columns.get("name"), self.columns.get("set")
        if name is not None and spelled(name.heading) in COUNTERS and not self.is_unique("name"):
            self.left_out.append(f"column {name.heading} (its numbers stand more than once)")
            del self.columns["name"]
        elif name is None and group is not None and self.is_unique("set"):
            self.columns["name"] = self.columns.pop("set")
        elif name is not None and not self.may_repeat:
            self.shared_names = Counter(self.filled("name"))
            alike = sum(times for times in self.shared_names.values() if times > 1)
            if alike and group is None and 2 * alike > self.shared_names.total():
                self.columns["set"] = self.columns.pop("name")
                self.read_as.append(f"column {name.heading} is taken as the set: its names stand more than once")

    def is_unique(self, key: str) -> bool:
        """Whether every row has a name of its own in a column."""
        return len(set(self.filled(key))) == len(self.rows)

    def along_holes(self) -> None:
        """Leave survey stations out; depths in several holes are no positions along one line."""
        holes = set(self.filled("hole")) if "hole" in self.columns else set()
        if "position" in self.columns and len(holes) > 1:
            heading = self.columns.pop("position").heading
            self.left_out.append(f"column {heading} (it runs along {len(holes)} holes)")
        idle = ["hole", "reference"]
        if self.core is not None:
            joints = {line: cells for line, cells in self.rows.items() if not self.core.is_station(cells)}
            idle = ["hole"] if len(joints) == len(self.rows) else []
            self.rows = joints
        self.left_out += [f"column {self.columns[key].heading}" for key in idle if key in self.columns]

    # -- rows --------------------------------------------------------------------------------------------------

    def joint(self, line: int, cells: Sequence[str]) -> MeasuredJoint | None:
        """The joint of a row; None where it has none, or faults stand for it."""
        if not any(cells):
            self.left_out.append(f"{self.table.noun} {line} (empty cells)")
            return None
        if any(cells[self.width :]):
            decimal = self.table.delimiter == "," and "." not in self.table.shown(line)
            advice = "Decimals take a point; decimal commas need ; between the columns." if decimal else ""
            message = f"{self.table.noun} {line} has {len(cells)} values for {self.width} columns"
            self.fault("E193", message, line, advice)
            return None
        if number_in(self.cell("quantity", cells)) == 0.0:
            self.left_out.append(f"{self.table.noun} {line} (quantity 0)")
            return None
        self.rows_read += 1
        name = self.joint_name(cells, line)
        plane = self.plane(name, cells, line)
        values = {attribute: self.value(field, name, cells, line) for attribute, field in self.values}
        if plane is None or self.faults:
            return None
        return MeasuredJoint(name, plane, line, set_name=self.written("set", cells), **values)

    def written(self, key: str, cells: Sequence[str]) -> str:
        """What stands in a column of a row, empty where there is no such column."""
        return cells[self.columns[key].index] if key in self.columns else ""

    def cell(self, key: str, cells: Sequence[str]) -> str:
        """The text of a column in a row, with a decimal point and the unit of the header."""
        text = self.written(key, cells)
        if not NUMBER.match(text):
            return text
        # a comma between the columns is none here: the number stands in quotes
        return f"{text.replace(',', '.')} {self.columns[key].unit}".rstrip()

    def value(self, field: Field, name: str, cells: Sequence[str], line: int) -> Any:
        """The number of a column in a row, what it is where the cell is empty; None with a fault where it is wrong."""
        text, what, where = self.cell(field.path, cells), f"{field.path} of {name}", self.where(line)
        if not text:
            return field.default
        if not field.unit and not _COUNT.match(text):
            message = f"{what} is {text!r}, {field.limits_in_words()}"
            self.fault(field.code, message, line, field.advice)
        elif (
            field.measures == "pressure" and self.table.delimiter == "," and _THOUSANDS.match(self.written("c", cells))
        ):
            advice = "Write it without the comma, or with a point."
            self.fault("E193", f"{what} has a comma that may part decimals or thousands", line, advice)
        else:
            return self.faults.of(field.read, text, what, where, text)
        return None

    def name_in(self, cells: Sequence[str], line: int) -> str:
        """What a row calls its joint, or J and a number where it has no name."""
        return self.written("name", cells) or f"J{line if 'name' in self.columns else self.rows_read}"

    def joint_name(self, cells: Sequence[str], line: int) -> str:
        """The name of a joint, with a number behind it where another joint has it already."""
        name = self.name_in(cells, line)
        if name not in self.names:
            return name
        self.repeated += 1
        numbers = range(self.next_number.get(name, 2), line + 3)
        number_behind = next(k for k in numbers if f"{name}-{k}" not in self.names)
        self.next_number[name] = number_behind + 1
        return f"{name}-{number_behind}"

    def plane(self, name: str, cells: Sequence[str], line: int) -> Plane | None:
        texts = {key: self.cell(key, cells) for key in self.way}
        texts = texts if self.core is None else self.core.completed(texts, cells)
        empty = [key for key in sorted(texts, key=DIP_FIRST) if not texts[key]]
        if empty == ["dip_direction"] and (self.way == STRIKE_WITH_SIDE or number_in(texts["dip"]) == 0.0):
            empty.clear()
        if empty:
            self.fault("E193", f"{name} has no {' and no '.join(WORDS[key] for key in empty)}", line)
            return None
        return self.faults.of(self.planes.plane, name, tuple(texts.values()), self.where(line))
