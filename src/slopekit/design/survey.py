"""Joint lists as surveys and stereonet programs write them: CSV with dip and dip direction, one joint a row."""

import csv
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Literal, NoReturn, TypeAlias, cast

from slopekit.design.on_disk import read_bytes
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Plane, number, parse_plane
from slopekit.units import quantity

Convention: TypeAlias = Literal["right-hand-rule", "left-hand-rule"]
_STRIKE_TO_DIP_DIRECTION: Mapping[str, float] = {"right-hand-rule": 90.0, "left-hand-rule": -90.0}
# what a column may be called, in lower case with _ for blanks and hyphens; the first name given wins
_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "dip": ("dip", "dip_angle", "dip_deg"),
    "dip_direction": (
        "dip_direction", "dipdirection", "dip_dir", "dipdir", "dip_dirn", "dipdirn", "dd", "ddr", "dip_azimuth",
        "dipazimuth", "azimuth", "azi", "direction", "dip_direction_deg",
    ),
    "strike": ("strike", "strike_deg"),
    "name": ("name", "id", "joint", "joint_id"),
    "set": ("set", "joint_set", "set_id", "family"),
    "c": ("c", "cohesion", "c_kpa", "cohesion_kpa"),
    "phi": ("phi", "φ", "friction", "friction_angle", "phi_deg"),
}  # fmt: skip
_DEGREES = ("", "°", "deg", "degree", "degrees", "º")
_NUMBER = re.compile(r"^[+-]?(\d+([.,]\d*)?|[.,]\d+)°?$")
_HEADER = re.compile(r"^(.*?)\s*(?:\(([^)]*)\)|\[([^\]]*)\])?\s*$")


@dataclass(frozen=True, slots=True)
class Joint:
    """One measured joint: its name, its plane, the line of the file it stands in, strength and set where given."""

    name: str
    plane: Plane
    line: int
    cohesion_kpa: float | None = None
    friction_angle_deg: float | None = None
    set_name: str = ""


@dataclass(frozen=True, slots=True)
class Survey:
    """The joints of a list, and in words what of the file was left out."""

    joints: tuple[Joint, ...]
    left_out: tuple[str, ...] = field(default=())


def read_joints(path: str | os.PathLike[str], convention: str | None = None, skip_bad: bool = False) -> Survey:
    """Read a joint list.

    Comma, semicolon or tab between the columns; decimal commas with the latter two; lines that start with # are
    comments. Columns are known by their names in any case; two columns of numbers without a header are dip and dip
    direction. A column of sets serves as the names where no column of names is there and no set stands twice.

    Parameters
    ----------
    convention : what a strike column means: right-hand-rule (dip direction = strike + 90) or left-hand-rule (- 90)
    skip_bad : leave bad rows out, and say so, where they would stop the run

    Raises
    ------
    DesignError
        E101 to E108 and E113 to E115 for the values, E147 to E149 and E159 for the file, E190 no joints, E191
        columns missing, unknown or twice, E192 a strike without its convention, E193 a row that does not fit, E194 a
        name twice: every bad row of the file.
    """
    name = Path(path).name
    lines = re.split(r"\r\n|\n|\r", _decoded(read_bytes(path), name))
    return _Reader(name, lines, convention, skip_bad).survey()


def _decoded(content: bytes, name: str) -> str:
    """The text of UTF-8, UTF-16 or Windows files; what is no text at all is refused."""
    text = None
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encodings: Sequence[str] = ("utf-16",)
    elif b"\x00" in content[:200]:  # UTF-16 without its mark: every other byte of ASCII is zero
        encodings = ("utf-16-le" if content[1:2] == b"\x00" else "utf-16-be",)
    else:
        encodings = ("utf-8-sig", "cp1252", "latin-1")
    for encoding in encodings:
        try:
            text = content.decode(encoding)
            break
        except UnicodeDecodeError:
            continue
    bad = re.search("[\x00-\x08\x0e-\x1f\x7f\ud800-\udfff]", text) if text is not None else None
    if text is None or bad:
        shown = f" (character U+{ord(bad.group()):04X})" if bad else ""
        _fail("E159", f"{name} is not a text file{shown}", name, "Save the list as CSV.")
    return text


@dataclass(frozen=True, slots=True)
class _Column:
    """Where a column stands, and the unit in its header."""

    index: int
    unit: str = ""


class _Reader:
    """Reads the rows one after the other and collects their faults."""

    def __init__(self, name: str, lines: Sequence[str], convention: str | None, skip_bad: bool = False) -> None:
        self.name, self.lines, self.convention, self.skip_bad = name, lines, convention, skip_bad
        self.delimiter = ","
        self.width = 2
        self.columns: dict[str, _Column] = {}
        self.faults: list[Fault] = []
        self.left_out: list[str] = []
        self.first_lines: dict[str, int] = {}

    def survey(self) -> Survey:
        if self.convention is not None and self.convention not in _STRIKE_TO_DIP_DIRECTION:
            near = get_close_matches(self.convention.lower(), _STRIKE_TO_DIP_DIRECTION, n=1)
            advice = f"Did you mean {near[0]}?" if near else "It is right-hand-rule or left-hand-rule."
            _fail("E192", f"the strike convention {self.convention!r} is not known", self.name, advice)
        rows = [k for k, line in enumerate(self.lines, 1) if line.strip() and not line.lstrip().startswith("#")]
        if not rows:
            advice = "The first line names the columns: name,dip,dip_direction."
            _fail("E190", f"{self.name} holds no joints", self.name, advice)
        rows = rows[self.header(rows[0]) :]
        self.sets_as_names(rows)
        joints = []
        for line in rows:
            joint = self.joint(line)
            if joint is not None:
                joints.append(joint)
            elif self.skip_bad and self.faults:
                said = "; ".join(f"{part.code} {part.message}" for part in self.faults)
                self.left_out.append(f"line {line} ({said})")
                self.faults = []
                if "name" in self.columns:  # a name that went with its row may be used again
                    self.first_lines = {name: at for name, at in self.first_lines.items() if at != line}
        if not joints and not self.faults:
            bad = sum(part.startswith("line ") for part in self.left_out)
            if self.skip_bad and bad:
                message = f"{self.name} holds no joints: {bad} rows are bad"
                _fail("E190", message, self.name, f"The first: {self.left_out[-bad]}")
            _fail("E190", f"{self.name} has a header and no joints", self.name, "Each row below it is one joint.")
        if self.faults:
            raise DesignError(self.faults)
        return Survey(tuple(joints), tuple(self.left_out))

    def where(self, line: int) -> str:
        text = " ".join(self.lines[line - 1].split())
        return f"{self.name}:{line}  {text if len(text) <= 80 else text[:79] + '…'}"

    def fault(self, code: str, message: str, line: int, advice: str = "") -> None:
        self.faults.append(Fault(code, message, self.where(line), advice))

    def cells(self, line: int) -> list[str]:
        text = self.lines[line - 1]
        try:
            row = next(csv.reader([text], delimiter=self.delimiter, skipinitialspace=self.delimiter != "\t"), [])
        except csv.Error:  # a field longer than csv takes
            row = text.split(self.delimiter)
        return [cell.strip() for cell in row]

    # -- columns -----------------------------------------------------------------------------------------------

    def header(self, line: int) -> int:
        """Find the columns; returns how many lines the header took."""
        text = self.lines[line - 1]
        self.delimiter = next((mark for mark in (";", "\t") if mark in text), ",")
        cells = self.cells(line)
        self.width = len(cells)
        if all(_NUMBER.match(cell) for cell in cells if cell):
            if len(cells) != 2:
                message = f"{self.name} has no header, and {len(cells)} columns of numbers"
                advice = "Name the columns in the first line: name,dip,dip_direction."
                raise DesignError([Fault("E191", message, self.where(line), advice)])
            self.columns = {"dip": _Column(0), "dip_direction": _Column(1)}
            return 0
        for index, cell in enumerate(cells):
            self.column(index, cell, cells, line)
        if "dip_direction" in self.columns and "strike" in self.columns:
            del self.columns["strike"]
            self.left_out.append("column strike (the dip direction is given)")
        missing = [key for key in ("dip", "dip_direction") if key not in self.columns]
        if missing == ["dip_direction"] and "strike" in self.columns:
            if self.convention is None:
                advice = "Say convention right-hand-rule (dip direction = strike + 90) or left-hand-rule (strike - 90)."
                self.fault("E192", "a strike column has two meanings, its convention is not said", line, advice)
        elif missing:
            names = " and ".join(key.replace("_", " ") for key in missing)
            self.fault("E191", f"{self.name} has no column for {names}", line, self.near_columns(cells))
        if self.faults:
            raise DesignError(self.faults)
        return 1

    def column(self, index: int, cell: str, cells: Sequence[str], line: int) -> None:
        match = cast("re.Match[str]", _HEADER.match(cell))
        unit = (match.group(2) or match.group(3) or "").strip()
        spelled = re.sub(r"[\s\-]+", "_", match.group(1).strip().lower())
        key = next((key for key, names in _COLUMNS.items() if spelled in names), None)
        if key is None:
            if any(len(row) > index and row[index] for row in map(self.cells, range(line + 1, len(self.lines) + 1))):
                self.left_out.append(f"column {cell or index + 1}")
            return
        if key in self.columns:
            other = cells[self.columns[key].index]
            if key != "name":
                advice = "Leave one of them out."
                self.fault("E191", f"{self.name} has two columns for {key.replace('_', ' ')}: {other} and {cell}",
                           line, advice)  # fmt: skip
                return
            names = _COLUMNS["name"]
            if names.index(spelled) > names.index(re.sub(r"[\s\-]+", "_", other.lower())):
                self.left_out.append(f"column {cell}")
                return
            self.left_out.append(f"column {other}")
        if key in ("dip", "dip_direction", "strike") and unit.lower() not in _DEGREES:
            self.fault("E191", f"the column {cell} is in {unit}, an orientation is in degrees", line)
        self.columns[key] = _Column(index, "" if unit.lower() in _DEGREES else unit)

    def near_columns(self, cells: Sequence[str]) -> str:
        known = [name for key in ("dip", "dip_direction") for name in _COLUMNS[key]]
        free = [cell for k, cell in enumerate(cells) if k not in {column.index for column in self.columns.values()}]
        near = [(cell, found[0]) for cell in free if (found := get_close_matches(cell.lower(), known, n=1))]
        if near:
            return f"Did you mean {near[0][1]} by {near[0][0]}?"
        if len(cells) == 1:
            return "Columns are separated by a comma, a semicolon or a tab: dip,dip_direction."
        return "Name the columns in the first line: name,dip,dip_direction."

    def sets_as_names(self, rows: Sequence[int]) -> None:
        """Where only sets are given and each stands once, they are what the joints are called."""
        column = self.columns.get("set")
        if column is None or "name" in self.columns:
            return
        found = [cells[column.index] for cells in map(self.cells, rows) if len(cells) > column.index]
        if len(set(found)) == len(rows):
            self.columns["name"] = self.columns.pop("set")

    # -- rows --------------------------------------------------------------------------------------------------

    def joint(self, line: int) -> Joint | None:
        cells = self.cells(line)
        if not any(cells):
            self.left_out.append(f"line {line} (empty cells)")
            return None
        if len(cells) > self.width and not any(cells[self.width :]):
            cells = cells[: self.width]
        if len(cells) > self.width:
            decimal = self.delimiter == "," and "." not in self.lines[line - 1]
            advice = "Decimals take a point; decimal commas need ; between the columns." if decimal else ""
            self.fault("E193", f"line {line} has {len(cells)} values for {self.width} columns", line, advice)
            return None
        cells += [""] * (self.width - len(cells))
        found = len(self.faults)
        name = self.joint_name(cells, line)
        plane = self.plane(name, cells, line)
        cohesion = self.strength("c", name, cells, line)
        friction = self.strength("phi", name, cells, line)
        if plane is None or len(self.faults) > found:
            return None
        column = self.columns.get("set")
        return Joint(name, plane, line, cohesion, friction, cells[column.index] if column else "")

    def cell(self, key: str, cells: Sequence[str]) -> str:
        """The text of a column in a row, with a decimal point and the unit of the header."""
        column = self.columns.get(key)
        text = cells[column.index] if column else ""
        if self.delimiter != "," and _NUMBER.match(text):
            text = text.replace(",", ".")
        return f"{text} {column.unit}" if column and column.unit and _NUMBER.match(text) else text

    def joint_name(self, cells: Sequence[str], line: int) -> str:
        column = self.columns.get("name")
        name = (cells[column.index] if column else "") or f"J{line if column else len(self.first_lines) + 1}"
        if name in self.first_lines:
            advice = "Give each joint a name of its own, in a column called name or id."
            self.fault("E194", f"{name} stands in the lines {self.first_lines[name]} and {line}", line, advice)
        self.first_lines.setdefault(name, line)
        return name

    def plane(self, name: str, cells: Sequence[str], line: int) -> Plane | None:
        second = "dip_direction" if "dip_direction" in self.columns else "strike"
        dip, direction = self.cell("dip", cells), self.cell(second, cells)
        empty = [key.replace("_", " ") for key, text in (("dip", dip), (second, direction)) if not text]
        if empty:
            self.fault("E193", f"{name} has no {' and no '.join(empty)}", line)
            return None
        where = self.where(line)
        try:
            if second == "dip_direction":
                return parse_plane(f"{dip}/{direction}", name, where)
            strike = quantity(direction, "angle", f"strike of {name}", where)
            if not 0.0 <= strike <= 360.0:
                message = f"strike of {name} is {number(strike)}, a direction lies between 0 and 360"
                raise DesignError([Fault("E102", message, where)])
            turn = _STRIKE_TO_DIP_DIRECTION[self.convention or ""]
            return parse_plane(f"{dip}/{(strike + turn) % 360.0!r}", name, where)
        except DesignError as error:
            self.faults += error.faults
            return None

    def strength(self, key: Literal["c", "phi"], name: str, cells: Sequence[str], line: int) -> float | None:
        text = self.cell(key, cells)
        if not text:
            return None
        try:
            value = quantity(text, "pressure" if key == "c" else "angle", f"{key} of {name}", self.where(line))
        except DesignError as error:
            self.faults += error.faults
            return None
        if key == "c" and value < 0.0:
            self.fault("E114", f"c of {name} is {number(value)} kPa, cohesion is never negative", line)
        elif key == "phi" and not 0.0 <= value < 90.0:
            self.fault("E115", f"phi of {name} is {number(value)}°, a friction angle lies from 0 to below 90", line)
        elif key == "phi" and 0.0 < value < 1.571 and value != int(value):
            advice = "Degrees are needed; write 0 for a joint without friction."
            self.fault("E113", f"phi of {name} is {number(value)}°, that looks like radians", line, advice)
        return value


def _fail(code: str, message: str, where: str, advice: str) -> NoReturn:
    raise DesignError([Fault(code, message, where, advice)])
