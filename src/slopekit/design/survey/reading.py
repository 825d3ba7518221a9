"""Reading joint lists: the header, then the joints row by row, with all faults at once."""

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
    PLANE_COLUMNS,
    RANKED,
    SIZES,
    STRIKE_WITH_SIDE,
    WORDS,
    Preamble,
    SurveyColumn,
    checked_convention,
    column_of,
    columns_advice,
    headings_in_order,
    key_of,
    names_may_repeat,
    normalized_heading,
    number_in,
    plane_columns,
    preamble_of,
    reason_without_joints,
)
from slopekit.design.survey.joint_list import (
    BadRow,
    JointList,
    MeasuredJoint,
    grouped_faults,
    skipped_rows,
)
from slopekit.design.survey.oriented_core import CoreLog, core_columns
from slopekit.design.survey.planes import (
    CELL_ORDER,
    SHARE_OF_BAD_ROWS,
    DipsBeyond90,
    PlaneReader,
    check_dips_beyond_90,
    dip_and_azimuth,
    swapped_columns,
)
from slopekit.design.survey.tables import SurveyTable, frame_table, headings_with_units, read_table

_PLANE = re.compile(r"^\d+([.,]\d+)?°?\s*/\s*\d+([.,]\d+)?°?$")
_COUNT = re.compile(r"^[+-]?(\d+(\.\d*)?|\.\d+)$")
_THOUSANDS = re.compile(r"^\d{1,3},\d{3}$")
#: Largest size of a list: 100,000 joints with ten columns, with a margin.
MOST_BYTES = 50_000_000
_TOO_LARGE = "Leave out the columns that are not used, or take a domain of the slope."
_MAX_HEADER_ROW = 60  # last row that is searched for the header
_MAX_LISTED_COLUMNS = 4  # unused columns listed one by one
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

    The columns are separated by comma, semicolon, tab or blanks; decimal commas are allowed with all but the comma, or
    in quotes; lines that start with # or * are comments. An .xlsx workbook is read by its first sheet, AGS 4 by its
    group DISC. Columns are known by their English or German names, in any case, in the header, which may be a comment,
    or in `columns`; two columns of numbers without a header are dip and dip direction where the second cannot be a dip.
    Lines above the header are a preamble as of Dips. A column of sets gives the names where no column of names exists
    and every set is unique; a column of names most of which are shared is read as the sets. alpha and beta on oriented
    core give planes with the trend and plunge of the hole, see `oriented_core`.

    Parameters
    ----------
    convention : convention of a strike column: right-hand-rule, RHR (dip direction = strike + 90) or left-hand-rule,
        LHR (- 90)
    skip_bad : skip bad rows and list them, unless more than a tenth of the rows are bad
    option : the name of `convention` in messages
    sizes : read columns of spacing, position, trace length and its visible ends too
    columns : headings of the columns, from the first on, in place of a header

    Raises
    ------
    DesignError
        E101 to E108 and E113 to E115 for the values, E140 openpyxl is missing for a workbook, E147 to E149 and E159
        for the file, E190 no joints, E191 missing, unknown or duplicate columns, E192 a strike without its convention,
        or two formats, E193 a wrong row, quantity or size, or too many bad rows to skip: all bad rows of the file,
        grouped by kind of fault.
    """
    table = read_table(Path(path).name, read_bytes(path, MOST_BYTES, _TOO_LARGE))
    return _Reader(table, convention, skip_bad, option, sizes, columns).survey()


def read_joints_text(
    name: str, text: str, skip_bad: bool = False, columns: str | Sequence[str] | None = None
) -> JointList:
    """Read the text of a joint list as `read_joints` reads a file of that name."""
    return _Reader(
        read_table(name, text.encode()), None, skip_bad, "--convention", False, columns
    ).survey()


def read_frame(
    frame: Any,
    convention: str | None = None,
    skip_bad: bool = False,
    option: str = "convention =",
    sizes: bool = False,
    columns: str | Sequence[str] | None = None,
) -> JointList:
    """Read a frame of pandas or polars with the columns of a joint list as `read_joints` reads a file."""
    return _Reader(frame_table(frame), convention, skip_bad, option, sizes, columns).survey()


class _Reader:
    """Reads a joint list from its table: finds the columns, then reads row by row and collects all faults."""

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
        self.given_headings = headings_in_order(columns)
        self.width = 0
        self.rows: dict[
            int, list[str]
        ] = {}  # rows below the header, each with a cell for every column
        self.columns: dict[str, SurveyColumn] = {}
        self.headings: list[str] = []
        self.plane_keys: tuple[str, ...] = PLANE_COLUMNS[0]
        self.core: CoreLog | None = None
        self.may_repeat = False
        self.header_preamble = Preamble()
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
        self.find_header()
        self.remove_stations()
        dips_beyond_90 = self.check_dips_beyond_90()
        self.planes = PlaneReader(
            self.plane_keys,
            self.convention,
            self.convention_advice(),
            self.header_preamble.declination_deg,
            dips_beyond_90,
        )
        self.assign_names()
        self.values = [
            (name, field)
            for name, field in fields_of(MeasuredJoint).items()
            if field.path in self.columns
        ]
        joints, bad = list[MeasuredJoint](), list[BadRow]()
        for line, cells in self.rows.items():
            joint = self.joint(line, cells)
            if joint is not None:
                joints.append(joint)
                self.names.add(joint.name)
            elif self.faults:
                bad.append((line, self.name_in_row(cells, line), tuple(self.faults)))
                self.faults.clear()
        if bad:
            self.bad_rows(bad, len(joints), dips_beyond_90)
        elif not joints:
            fail(
                "E190",
                f"{self.name} has a header and no joints",
                self.name,
                "Each row below it is one joint.",
            )
        self.faults += self.planes.radians_faults(self.name)
        self.faults.refuse()
        self.read_as += self.planes.read_as()
        self.read_as += self.core.read_as() if self.core is not None else []
        if self.repeated:
            are_several = self.repeated > 1
            names, them = (
                ("names that stand", "them") if are_several else ("name that stands", "it")
            )
            self.read_as.append(
                f"{self.repeated} {names} more than once got a number behind {them}"
            )
        shared = frozenset(name for name, times in self.shared_names.items() if times > 1)
        return JointList(
            self.name, tuple(joints), tuple(self.left_out), tuple(self.read_as), shared
        )

    def bad_rows(self, bad: Sequence[BadRow], good: int, dips_beyond_90: DipsBeyond90) -> None:
        """Skip bad rows where that is allowed and they are few; else record their faults, grouped by kind."""
        too_many = len(bad) > SHARE_OF_BAD_ROWS * (len(bad) + good)
        if self.skip_bad and not too_many:
            self.left_out += skipped_rows(self.table.noun, bad)
            return
        if self.skip_bad:
            message = f"{len(bad)} of {len(bad) + good} rows of {self.name} are bad: more than a tenth is not skipped"
            self.faults.append(
                Fault("E193", message, self.name, "Mend the list: what is wrong with it follows.")
            )
        if dips_beyond_90.columns_are_swapped:
            swapped = {
                fault for _, _, faults in bad for fault in faults if fault.code in ("E101", "E103")
            }
            suspects = [line for line, _, faults in bad if not swapped.isdisjoint(faults)]
            places = "; ".join(map(self.row_location, suspects[:3]))
            self.faults.append(
                swapped_columns(
                    self.name, places, self.headings, self.plane_keys, dips_beyond_90, self.option
                )
            )
            bad = [
                (line, name, [fault for fault in faults if fault not in swapped])
                for line, name, faults in bad
            ]
        self.faults += grouped_faults(bad)

    def check_dips_beyond_90(self) -> DipsBeyond90:
        """Return the evidence of the dips and azimuths of all rows about dips beyond 90°."""
        if self.plane_keys in (STRIKE_WITH_SIDE, CORE):
            return DipsBeyond90()
        indices = [self.columns[key].index for key in self.plane_keys]
        texts = ([cells[index] for index in indices] for cells in self.rows.values())
        return check_dips_beyond_90(dip_and_azimuth(self.plane_keys, row) for row in texts)

    def row_location(self, line: int) -> str:
        text = " ".join(self.table.row_text(line).split())
        return f"{self.name}:{line}  {text if len(text) <= 80 else text[:79] + '…'}"

    def fault(self, code: str, message: str, line: int, advice: str = "") -> None:
        self.faults.append(Fault(code, message, self.row_location(line), advice))

    def refuse(self, code: str, message: str, line: int, advice: str = "") -> NoReturn:
        fail(code, message, self.row_location(line), advice)

    # -- columns -----------------------------------------------------------------------------------------------

    def find_header(self) -> None:
        """Find the header, assign its columns and set the rows below it."""
        rows = self.table.rows
        header_row = next(
            (k for k in range(min(len(rows), _MAX_HEADER_ROW)) if self.is_header(k)), None
        )
        self.header_preamble = preamble_of(
            [self.table.row_text(row) for row in rows[:_MAX_HEADER_ROW][:header_row]]
        )
        bare = (
            self.first_number_row()
            if header_row is None and self.header_preamble.columns and not self.given_headings
            else None
        )
        comment = self.commented_header() if header_row is None and bare is None else None
        k = header_row or bare or 0
        line, below = rows[k], rows[k:]
        self.table.start(line, blanks=bare is not None or comment is not None)
        cells = self.table.cells(line)
        self.width, has_no_header = len(cells), False
        if bare is not None:
            keys = (
                (*self.header_preamble.columns, "quantity")
                if self.header_preamble.has_quantity
                else self.header_preamble.columns
            )
            headings = [WORDS[key] for key in keys[: self.width]]
        elif comment is not None:
            line, headings = comment
        elif k == 0 and self.is_joint_row(cells):
            has_no_header, headings = not self.given_headings, list(PLANE_COLUMNS[0])
        else:
            headings, below = cells, rows[k + 1 :]
        if has_no_header and self.width != len(PLANE_COLUMNS[0]):
            self.refuse(
                "E191",
                f"{self.name} has no header, and {self.width} columns of numbers",
                line,
                f"{_NAME_THE_COLUMNS} Or {columns_advice(self.option, PLANE_COLUMNS[0])}.",
            )
        headings = self.complete_headings(headings, line)
        self.rows = {row: self.padded(self.table.cells(row)) for row in below}
        with_units = headings_with_units(headings, self.rows[below[0]]) if below else None
        if with_units is not None:
            self.read_as.append(f"{self.table.noun} {below[0]} holds units")
            headings = with_units
            del self.rows[below[0]]
        self.assign_columns(headings, line)
        if has_no_header and self.check_dips_beyond_90().fits_both_orders:
            message = f"{self.name} has no header, and no number over 90 says which of its two columns is the dip"
            first, second = (
                columns_advice(self.option, order)
                for order in (PLANE_COLUMNS[0], PLANE_COLUMNS[0][::-1])
            )
            self.refuse("E191", message, line, f"{_NAME_THE_COLUMNS} Or {first}, or {second}.")
        self.apply_preamble(rows[:k])

    def padded(self, cells: list[str]) -> list[str]:
        """Return the cells of a row, with empty cells for missing ones."""
        return [*cells, *[""] * (self.width - len(cells))]

    def is_joint_row(self, cells: Sequence[str]) -> bool:
        """Return whether a row is a joint, not a header: only numbers, or numbers in columns that the user names."""
        if self.given_headings:
            return any(
                NUMBER.match(cell) or _PLANE.match(cell)
                for cell in cells[: len(self.given_headings)]
            )
        return all(NUMBER.match(cell) for cell in cells if cell)

    def complete_headings(self, headings: Sequence[str], line: int) -> list[str]:
        """Return the headings of all columns, the first ones replaced by those that the user gives."""
        if len(self.given_headings) > self.width:
            message = f"{len(self.given_headings)} columns are named, {self.name} has {self.width}"
            self.refuse("E191", message, line, ", ".join(self.given_headings))
        return self.padded([*self.given_headings, *headings[len(self.given_headings) :]])

    def commented_header(self) -> tuple[int, list[str]] | None:
        """Return the line and cells of the nearest comment above the rows whose columns give planes; None without."""
        first_row = self.table.rows[0]
        self.table.start(first_row, blanks=True)
        first = self.table.cells(first_row)
        if not any(
            NUMBER.match(cell) or _PLANE.match(cell) or parse_quadrants(cell) for cell in first
        ):
            return None
        for row in reversed(self.table.comments):
            for blanks in (False, True):
                self.table.start(row, blanks)
                cells = [
                    cell.lstrip("#* ") if k == 0 else cell
                    for k, cell in enumerate(self.table.cells(row))
                ]
                cells = cells[1:] if len(cells) == len(first) + 1 and not cells[0] else cells
                if len(cells) == len(first) and plane_columns(map(key_of, cells)) is not None:
                    return row, cells
        return None

    def is_header(self, k: int) -> bool:
        """Return whether a row is a header whose columns give planes.

        A line DIP/DIPDIRECTION alone is a header only if a plane follows; else it belongs to a preamble.
        """
        row, below = self.table.rows[k], self.table.rows[k + 1 : k + 2]
        self.table.start(row)
        cells = self.table.cells(row)
        if plane_columns(map(key_of, cells)) is None:
            return False
        first = [next(iter(self.table.cells(row)), "") for row in below]
        return len(cells) > 1 or any(_PLANE.match(text) or parse_quadrants(text) for text in first)

    def first_number_row(self) -> int | None:
        """Return the index of the first row that begins with two numbers and has as many cells as all rows below it."""
        rows = self.table.rows
        for k, row in enumerate(rows[:_MAX_HEADER_ROW]):
            self.table.start(row, blanks=True)
            cells = self.table.cells(row)
            begins = len(cells) > 1 and all(NUMBER.match(cell) for cell in cells[:2])
            if begins and all(len(self.table.cells(below)) == len(cells) for below in rows[k:]):
                return k
        return None

    def apply_preamble(self, lines: Sequence[int]) -> None:
        """Apply the preamble above the header: note it, refuse mixed formats, set convention and declination."""
        if lines:
            noun = self.table.noun + ("s" if len(lines) > 1 else "")
            numbers = f"{lines[0]} to {lines[-1]}" if len(lines) > 1 else f"{lines[0]}"
            self.left_out.append(f"{noun} {numbers} (above the columns)")
        preamble, line = self.header_preamble, (lines or self.table.rows)[0]
        if preamble.traverses:
            self.left_out.append(f"{preamble.traverses} traverses (no joint is weighted by them)")
        is_of_core = preamble.core and self.core is None
        if is_of_core or preamble.other_formats:
            mixture = (
                "alpha and beta on core"
                if is_of_core
                else f"{preamble.written} and {', '.join(preamble.other_formats)}"
            )
            advice = "Save the processed file in Dips: one format for all rows."
            self.fault(
                "E192",
                f"the orientations of {self.name} are {mixture}: not all mean the same",
                line,
                advice,
            )
        self.set_strike_convention(line)
        if "trend" in self.plane_keys:
            self.read_as.append(
                "trend and plunge are of poles: dip = 90 - plunge, dip direction = trend + 180"
            )
        if preamble.declination_deg:
            self.read_as.append(
                f"a declination of {number(preamble.declination_deg)}° is added to all azimuths"
            )
        self.faults.refuse()

    def set_strike_convention(self, line: int) -> None:
        """Set the strike convention from header, preamble or user; fault E192 where they contradict each other."""
        if (
            self.plane_keys[0] not in ("strike", "strike/dip")
            or self.plane_keys == STRIKE_WITH_SIDE
        ):
            return
        column = self.columns[self.plane_keys[0]]
        list_convention = column.convention or (
            self.header_preamble.convention if "strike" in self.header_preamble.columns else None
        )
        if list_convention is None:
            return
        if self.convention is not None and self.convention != list_convention:
            message = f"strikes are {list_convention} by {self.name}, {self.convention} by {self.option.rstrip(' =:')}"
            self.fault("E192", message, line, "Leave one of them out.")
        self.convention = list_convention
        self.read_as.append(
            f"strikes are {list_convention}, as {column.heading if column.convention else 'the preamble'} says"
        )

    def assign_columns(self, headings: Sequence[str], line: int) -> None:
        """Assign the columns by their headings, and choose those that give the plane."""
        if reason := reason_without_joints(headings):
            self.refuse("E191", f"the rows of {self.name} {reason}", line)
        self.may_repeat = names_may_repeat(headings)
        ignored: list[str] = []
        for index, heading in enumerate(headings):
            key = key_of(heading)
            if key is not None and (key not in SIZES or (self.sizes and key not in self.columns)):
                self.assign_column(index, key, headings, line)
            elif any(cells[index] for cells in self.rows.values()):
                ignored.append(heading or str(index + 1))
        if len(ignored) > _MAX_LISTED_COLUMNS:
            self.left_out.append(f"{len(ignored)} columns ({', '.join(ignored)})")
        else:
            self.left_out += [f"column {heading}" for heading in ignored]
        self.columns = core_columns(
            self.name, self.columns, headings, self.rows.values(), self.row_location(line)
        )
        plane_keys = plane_columns(self.columns)
        if plane_keys is None:
            names = " and ".join(WORDS[key] for key in PLANE_COLUMNS[0] if key not in self.columns)
            self.fault(
                "E191", f"{self.name} has no column for {names}", line, self.columns_hint(headings)
            )
            raise DesignError(self.faults)
        if plane_keys == PLANE_COLUMNS[0] and "strike" in self.columns:
            sides = self.filled_cells("dip_direction")
            if not sides:
                plane_keys = ("strike", "dip")
                del self.columns["dip_direction"]
            elif all(azimuth_of(side) is not None for side in sides):
                plane_keys = STRIKE_WITH_SIDE
        if plane_keys == CORE[:4]:
            plane_keys, self.core = CORE, CoreLog(self.columns, headings)
        self.plane_keys = plane_keys
        self.headings = [
            key if (key := key_of(heading)) in plane_keys else heading for heading in headings
        ]
        for key in [
            key
            for key in self.columns
            if key not in plane_keys and any(key in plane_keys for plane_keys in PLANE_COLUMNS)
        ]:
            given_columns = (
                WORDS[plane_keys[-1]]
                if plane_keys[-1] == "dip_direction"
                else " and ".join(map(WORDS.__getitem__, plane_keys))
            )
            verb = "are" if " and " in given_columns else "is"
            heading = key if key == "strike" else self.columns.pop(key).heading
            self.left_out.append(f"column {heading} (the {given_columns} {verb} given)")
        if (
            plane_keys == PLANE_COLUMNS[0]
            and normalized_heading(heading := self.columns["dip_direction"].heading)
            in AMBIGUOUS_DIRECTIONS
        ):
            self.read_as.append(f"{heading} is read as the dip direction")
        if (
            plane_keys == ("strike", "dip")
            and self.convention is None
            and self.columns["strike"].convention is None
        ):
            self.require_convention(line)
        self.faults.refuse()

    def filled_cells(self, key: str) -> list[str]:
        """Return the cells of a column that are not empty."""
        index = self.columns[key].index
        return [cells[index] for cells in self.rows.values() if cells[index]]

    def require_convention(self, line: int) -> None:
        """Record fault E192 for strikes without a convention, unless all dips have a side or a preamble gives it."""
        dips = self.filled_cells("dip")
        is_in_preamble = (
            self.header_preamble.convention is not None and "strike" in self.header_preamble.columns
        )
        have_sides = (
            plane_by_side(0.0, dip) or plane_by_side(45.0, dip) or plane_without_side(0.0, dip)
            for dip in dips
        )
        if not is_in_preamble and not (dips and all(have_sides)):
            self.fault(
                "E192",
                "a strike column has two meanings, its convention is not said",
                line,
                self.convention_advice(),
            )

    def convention_advice(self) -> str:
        right_hand, left_hand = (
            "right-hand-rule (RHR: dip direction = strike + 90)",
            "left-hand-rule (LHR: strike - 90)",
        )
        if not self.option:
            return "Say so in the header of the list: strike (RHR) or strike (LHR)."
        return f"Say {self.option} {right_hand} or {left_hand}."

    def assign_column(self, index: int, key: str, headings: Sequence[str], line: int) -> None:
        """Assign a column to its key; of two columns, the one whose name comes first in `COLUMNS`, or fault E191."""
        column = column_of(index, headings[index])
        if key in self.columns:
            previous = self.columns[key]
            if key not in RANKED:
                message = f"{self.name} has two columns for {WORDS[key]}: {previous.heading} and {column.heading}"
                self.fault("E191", message, line, "Leave one of them out.")
                return
            column, second = sorted(
                (column, previous),
                key=lambda candidate: COLUMNS[key].index(normalized_heading(candidate.heading)),
            )
            self.left_out.append(f"column {second.heading}")
        if key in ORIENTATIONS and column.unit:
            message = (
                f"the column {column.heading} is in {column.unit}, an orientation is in degrees"
            )
            self.fault("E191", message, line)
        self.columns[key] = column

    def columns_hint(self, headings: Sequence[str]) -> str:
        known_names = [name for key in PLANE_COLUMNS[0] for name in COLUMNS[key]]
        unused_headings = [heading for heading in headings if key_of(heading) not in self.columns]
        close_names = [
            (heading, names[0])
            for heading in unused_headings
            if (names := get_close_matches(heading.lower(), known_names, n=1))
        ]
        if close_names:
            return f"Did you mean {close_names[0][1]} by {close_names[0][0]}?"
        if any(map(NUMBER.match, headings)):
            return f"{_NAME_THE_COLUMNS} Or {columns_advice(self.option, ('name', *PLANE_COLUMNS[0]))}."
        if len(headings) == 1:
            return "Columns are separated by a comma, a semicolon or a tab: dip,dip_direction."
        return _NAME_THE_COLUMNS

    def assign_names(self) -> None:
        """Choose the column of the joints' names: names, counters, or sets, where they are unique.

        A column of names most of which are shared is read as the sets; other repeated names get numbers.
        """
        name, group = self.columns.get("name"), self.columns.get("set")
        if (
            name is not None
            and normalized_heading(name.heading) in COUNTERS
            and not self.is_unique("name")
        ):
            self.left_out.append(f"column {name.heading} (its numbers stand more than once)")
            del self.columns["name"]
        elif name is None and group is not None and self.is_unique("set"):
            self.columns["name"] = self.columns.pop("set")
        elif name is not None and not self.may_repeat:
            self.shared_names = Counter(self.filled_cells("name"))
            shared_count = sum(times for times in self.shared_names.values() if times > 1)
            if shared_count and group is None and 2 * shared_count > self.shared_names.total():
                self.columns["set"] = self.columns.pop("name")
                self.read_as.append(
                    f"column {name.heading} is taken as the set: its names stand more than once"
                )

    def is_unique(self, key: str) -> bool:
        """Return whether the cells of a column are all different and none is empty."""
        return len(set(self.filled_cells(key))) == len(self.rows)

    def remove_stations(self) -> None:
        """Remove the rows of survey stations, and a position column that runs along several holes."""
        holes = set(self.filled_cells("hole")) if "hole" in self.columns else set()
        if "position" in self.columns and len(holes) > 1:
            heading = self.columns.pop("position").heading
            self.left_out.append(f"column {heading} (it runs along {len(holes)} holes)")
        unused_keys = ["hole", "reference"]
        if self.core is not None:
            joints = {
                line: cells for line, cells in self.rows.items() if not self.core.is_station(cells)
            }
            unused_keys = ["hole"] if len(joints) == len(self.rows) else []
            self.rows = joints
        self.left_out += [
            f"column {self.columns[key].heading}" for key in unused_keys if key in self.columns
        ]

    # -- rows --------------------------------------------------------------------------------------------------

    def joint(self, line: int, cells: Sequence[str]) -> MeasuredJoint | None:
        """Return the joint of a row; None for a row without a joint or with faults."""
        if not any(cells):
            self.left_out.append(f"{self.table.noun} {line} (empty cells)")
            return None
        if any(cells[self.width :]):
            decimal = self.table.delimiter == "," and "." not in self.table.row_text(line)
            advice = (
                "Decimals take a point; decimal commas need ; between the columns."
                if decimal
                else ""
            )
            message = f"{self.table.noun} {line} has {len(cells)} values for {self.width} columns"
            self.fault("E193", message, line, advice)
            return None
        if number_in(self.cell("quantity", cells)) == 0.0:
            self.left_out.append(f"{self.table.noun} {line} (quantity 0)")
            return None
        self.rows_read += 1
        name = self.unique_name(cells, line)
        plane = self.plane(name, cells, line)
        values = {
            attribute: self.value(field, name, cells, line) for attribute, field in self.values
        }
        if plane is None or self.faults:
            return None
        return MeasuredJoint(name, plane, line, set_name=self.written("set", cells), **values)

    def written(self, key: str, cells: Sequence[str]) -> str:
        """Return the cell of a column in a row, empty without such a column."""
        return cells[self.columns[key].index] if key in self.columns else ""

    def cell(self, key: str, cells: Sequence[str]) -> str:
        """Return the cell of a column in a row, with a decimal point and the unit of the header."""
        text = self.written(key, cells)
        if not NUMBER.match(text):
            return text
        # a comma here is a decimal comma: where commas separate the columns, the number was in quotes
        return f"{text.replace(',', '.')} {self.columns[key].unit}".rstrip()

    def value(self, field: Field, name: str, cells: Sequence[str], line: int) -> Any:
        """Return the number of a column in a row, the default for an empty cell, or None with a fault."""
        text, label, location = (
            self.cell(field.path, cells),
            f"{field.path} of {name}",
            self.row_location(line),
        )
        if not text:
            return field.default
        if not field.unit and not _COUNT.match(text):
            message = f"{label} is {text!r}, {field.limits_in_words()}"
            self.fault(field.code, message, line, field.advice)
        elif (
            field.measures == "pressure"
            and self.table.delimiter == ","
            and _THOUSANDS.match(self.written("c", cells))
        ):
            advice = "Write it without the comma, or with a point."
            self.fault(
                "E193", f"{label} has a comma that may part decimals or thousands", line, advice
            )
        else:
            return self.faults.of(field.read, text, label, location, text)
        return None

    def name_in_row(self, cells: Sequence[str], line: int) -> str:
        """Return the name of a row's joint, or J and a number where it has none."""
        return (
            self.written("name", cells) or f"J{line if 'name' in self.columns else self.rows_read}"
        )

    def unique_name(self, cells: Sequence[str], line: int) -> str:
        """Return the name of a row's joint, with a number appended where another joint has that name."""
        name = self.name_in_row(cells, line)
        if name not in self.names:
            return name
        self.repeated += 1
        numbers = range(self.next_number.get(name, 2), line + 3)
        suffix = next(k for k in numbers if f"{name}-{k}" not in self.names)
        self.next_number[name] = suffix + 1
        return f"{name}-{suffix}"

    def plane(self, name: str, cells: Sequence[str], line: int) -> Plane | None:
        texts = {key: self.cell(key, cells) for key in self.plane_keys}
        texts = texts if self.core is None else self.core.completed(texts, cells)
        empty = [key for key in sorted(texts, key=CELL_ORDER) if not texts[key]]
        if empty == ["dip_direction"] and (
            self.plane_keys == STRIKE_WITH_SIDE or number_in(texts["dip"]) == 0.0
        ):
            empty.clear()
        if empty:
            self.fault(
                "E193", f"{name} has no {' and no '.join(WORDS[key] for key in empty)}", line
            )
            return None
        return self.faults.of(
            self.planes.plane, name, tuple(texts.values()), self.row_location(line)
        )
