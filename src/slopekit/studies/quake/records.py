"""Records of ground acceleration: two columns, PEER's AT2, folders of them, and pulses by their names.

A record is linear between its samples. Accelerations are in m/s²; 1 g of a record is 9.80665 m/s².

>>> pulse = read_record("sine:0.5g,1Hz")
>>> pulse.name, round(pulse.pga_g, 6), round(pulse.duration_s, 6)
('sine:0.5g,1Hz', 0.5, 1.0)
"""

import math
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, frozen
from slopekit.core.errors import DesignError, Fault, Faults, Notice
from slopekit.core.orientation import number
from slopekit.core.sheet import counted
from slopekit.design.reading.on_disk import read_bytes

#: Standard gravity, of which accelerations in g are parts.
GRAVITY = 9.80665
_UNITS = {"g": GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01}
_KNOWN = "g, m/s2, cm/s2, gal"
_ENDINGS = (".csv", ".txt", ".dat", ".at2", ".acc")
_MOST_BYTES = 50_000_000
_MOST_RECORDS = 500
_LARGEST_G = 10.0  # no record of an earthquake has more than half of it
_UNEVEN = 0.01  # of a step
_GAP = 10.0  # times the usual step
_COARSEST = 1.000001  # s: 1 Hz; no instrument of strong motion takes its samples so far apart, ...
_MADE_BY_HAND = 20  # ... and a motion of fewer samples may have been drawn
_LONGEST = 3600.0  # s: the longest earthquakes shake for some ten minutes
_DRIFTS = 0.1  # of the highest velocity of the ground
_PARTS = 100  # of a rectangular or triangular pulse
_CYCLE = 2000  # samples of a sine: the displacement is off by some 2e-6
_NO_MOTION = re.compile(
    r"(?<![a-z])(freq|frequency|period|vel|velocity|disp|displ|displacement|spectral|sa|psa|sv|sd)(?![a-z])"
)
_NUMBER = r"(\d+\.?\d*|\.\d+)"
_STEPS = (
    re.compile(r"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*([\d.eEdD+-]+)(?!\d|,\d)", re.IGNORECASE),
    re.compile(r"^\s*(\d+)\s+([\d.eEdD+-]+)\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
_LIKE_PULSE = (
    r"(rect|rectangular|rectangle|square|half[-_ ]?sine|sine|sin|tri|triangular|triangle)(?![\w.-])"
    r"|[a-z][a-z_ -]+:[^/\\]*$"
)
_PULSES = "rectangular:0.5g,0.3s  triangular:0.5g,0.3s  sine:0.5g,1Hz  sine:0.5g,1Hz,5 (cycles)"
_PULSE = re.compile(
    rf"(rectangular|triangular|sine):{_NUMBER}(g|m/s2|cm/s2|gal),{_NUMBER}(s|ms|hz)(?:,(\d+))?", re.IGNORECASE
)


@dataclass(frozen=True)
class Record:
    """Ground acceleration, linear between its samples.

    Attributes
    ----------
    name : as it is called; times_s : (n,) from 0 on, never falling (two at one time are a jump)
    accelerations : (n,) m/s²
    unit : of the file; is_pulse : one of the built-in ones
    notices : what is to be known of it
    """

    name: str
    times_s: Floats
    accelerations: Floats
    unit: str = "m/s2"
    is_pulse: bool = False
    notices: tuple[Notice, ...] = ()

    @property
    def pga_g(self) -> float:
        """Peak ground acceleration, g."""
        return float(np.abs(self.accelerations).max()) / GRAVITY

    @property
    def duration_s(self) -> float:
        """From the first sample to the last."""
        return float(self.times_s[-1] - self.times_s[0])

    @property
    def ground_velocity(self) -> Floats:
        """Velocity of the ground at the samples (n,) m/s, at rest at first: exact for the record as it is."""
        steps = np.diff(self.times_s) * 0.5 * (self.accelerations[1:] + self.accelerations[:-1])
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def pgv_m_s(self) -> float:
        """Peak ground velocity, m/s."""
        return float(np.abs(self.ground_velocity).max())

    @property
    def arias_m_s(self) -> float:
        """Arias intensity π / 2g ∫ a² dt, m/s: exact for the record as it is."""
        a, b = self.accelerations[:-1], self.accelerations[1:]
        return float(np.pi / (2.0 * GRAVITY) * (np.diff(self.times_s) * (a * a + a * b + b * b) / 3.0).sum())

    def scaled(self, pga_g: float) -> "Record":
        """The record with another peak."""
        return replace(self, accelerations=frozen(self.accelerations * (pga_g / self.pga_g)))


def record_of(name: str, times_s: Any, accelerations: Any, unit: str = "m/s2", is_pulse: bool = False) -> Record:
    """A record from arrays (n,), checked.

    Raises
    ------
    DesignError
        E511 the unit, or an acceleration that none has, E512 no numbers, too few samples or nothing but zeros, E514
        times that do not rise or are not in seconds.
    """
    t, a = np.asarray(times_s, dtype=np.float64).ravel(), np.asarray(accelerations, dtype=np.float64).ravel()
    if len(t) != len(a):
        raise _refused(name, "E512", f"{len(t)} times and {len(a)} accelerations")
    if not (np.isfinite(t).all() and np.isfinite(a).all()):
        at = int(np.flatnonzero(~(np.isfinite(t) & np.isfinite(a)))[0])
        raise _refused(name, "E512", f"sample {at + 1} is not a finite number")
    a = a * _factor_of(unit, name)
    if len(a) < 2 or not a.any():
        what = counted(len(a), "sample") if len(a) < 2 else "nothing but zeros"
        raise DesignError([Fault("E512", f"{name} has {what}: no record of an earthquake", name)])
    steps = np.diff(t)
    falls = np.flatnonzero(steps < 0.0 if is_pulse else steps <= 0.0)
    if len(falls):
        k = int(falls[0])
        message = f"time does not rise from sample {k + 1} ({number(t[k])} s) to the next ({number(t[k + 1])} s)"
        raise _refused(name, "E514", message)
    if not is_pulse:
        _are_seconds(name, steps)
    largest = float(np.abs(a).max()) / GRAVITY
    if largest > _LARGEST_G:
        message = f"the peak is {largest:.4g} g as {unit}, more than any earthquake's (up to {_LARGEST_G:g} g)"
        raise _refused(name, "E511", message)
    record = Record(name, frozen(t - t[0]), frozen(a), unit, is_pulse)
    return record if is_pulse else replace(record, notices=tuple(_said_of(record)))


def _are_seconds(name: str, steps: Floats) -> None:
    """Whether times with these steps may be those of an earthquake in seconds: sliding goes with their square."""
    usual, long = float(np.median(steps)), float(steps.sum())
    if not (usual > _COARSEST and len(steps) >= _MADE_BY_HAND) and long <= _LONGEST:
        return
    what = f"the time step is {usual:.6g} s and it lasts {long:.6g} s: no record of an earthquake in seconds"
    apart = number(float(f"{usual * 1e-3:.6g}"))
    advice = f"Times in ms are written in s, {apart} s apart; numbers of samples times the step between them."
    raise _refused(name, "E514", what, advice=advice)


def _refused(name: str, code: str, what: str, line: int | None = None, advice: str = "") -> DesignError:
    """What is wrong with a record, at a line of it."""
    return DesignError([Fault(code, f"{name}: {what}", name if line is None else f"{name}:{line}", advice)])


def _said_of(record: Record) -> Iterator[Notice]:
    """Yield W460 of uneven steps and of the baseline."""
    steps = np.diff(record.times_s)
    usual = float(np.median(steps))
    uneven = int((np.abs(steps - usual) > _UNEVEN * usual).sum())
    if uneven:
        gap = float(steps.max())
        more = f"; the longest, {number(gap)} s, is a gap" if gap > _GAP * usual else ""
        yield Notice("W460", f"{record.name}: {uneven} of {len(steps)} time steps are not {usual:.6g} s{more}; it is "
                     "taken as linear between its samples")  # fmt: skip
    velocity = record.ground_velocity
    most, left = float(np.abs(velocity).max()), float(velocity[-1])
    if abs(left) > _DRIFTS * most:
        yield Notice("W460", f"{record.name}: the ground moves at {left:.3g} m/s at its end "
                     f"({abs(left) / most:.0%} of its peak): baseline not corrected, or cut off")  # fmt: skip


# -- from files ------------------------------------------------------------------------------------------------------


def read_records(given: Sequence[Any], unit: str | None = None) -> tuple[Record, ...]:
    """Records by their files, folders or names of pulses, all faults at once.

    Parameters
    ----------
    given : texts, paths, or records that are there already
    unit : of files that name none

    Raises
    ------
    DesignError
        E147 to E149 for the files, E510 nothing there, E511, E512 and E514 what is in them, E517 a pulse.
    """
    if unit is not None:
        _factor_of(unit, "unit")
    records: list[Record] = []
    faults = Faults()
    paths: list[Any] = []
    for one in given:
        if isinstance(one, str | os.PathLike) and os.fspath(one).strip() and os.path.isdir(one):
            inside = sorted(path for path in Path(one).iterdir() if path.suffix.lower() in _ENDINGS)
            if not inside:
                faults.append(
                    Fault("E510", f"the folder {one} holds no record", str(one), f"Read: {' '.join(_ENDINGS)}")
                )
            paths += inside
        else:
            paths.append(one)
    if not paths and not faults:
        advice = "Give files, folders, or a pulse: sine:0.5g,1Hz rectangular:0.5g,0.3s triangular:0.5g,0.3s"
        faults.append(Fault("E510", "no record is given", "RECORD", advice))
    if len(paths) > _MOST_RECORDS:
        faults.append(Fault("E510", f"{len(paths)} records are given, at most {_MOST_RECORDS} at a time", ""))
        paths = []
    for one in paths:
        with faults.kept():
            records.append(one if isinstance(one, Record) else read_record(one, unit))
    faults.refuse()
    names = [record.name for record in records]
    called = [
        record
        if names.count(record.name) == 1
        else replace(record, name=f"{record.name} ({names[: k + 1].count(record.name)})")
        for k, record in enumerate(records)
    ]
    return tuple(called)


def read_record(path: str | os.PathLike[str], unit: str | None = None) -> Record:
    """A record from a file, or a pulse by its name: rectangular:0.5g,0.3s  triangular:0.5g,0.3s  sine:0.5g,1Hz,5.

    Raises
    ------
    DesignError
        As `read_records`.
    """
    if not isinstance(path, str | os.PathLike):
        advice = "Give a path, the name of a pulse, or record_of(name, times, accelerations, unit)."
        raise DesignError([Fault("E510", f"{str(path)[:40]!r} is no record", "", advice)])
    text = os.fspath(path)
    if re.match(_LIKE_PULSE, text, re.IGNORECASE) and not os.path.exists(path):
        return _pulse(text)
    if not text.strip():
        raise DesignError([Fault("E510", "a record without a name is given", "RECORD")])
    name = Path(path).name
    lines = _text_of(read_bytes(path, _MOST_BYTES), name).splitlines()
    if not any(line.strip() for line in lines):
        raise DesignError([Fault("E512", f"{name} is empty", str(path))])
    return _at2(name, lines) if any(_step_in(line) for line in lines[:8]) else _columns(name, lines, unit)


def _text_of(content: bytes, name: str) -> str:
    if b"\0" in content[:4096]:
        raise DesignError([Fault("E512", f"{name} is no text: it holds bytes that no record has", name)])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _step_in(line: str) -> tuple[int, float] | None:
    """Number of points and step of a line of AT2."""
    for pattern in _STEPS:
        if match := pattern.search(line):
            try:
                return int(match[1]), float(match[2])
            except ValueError:
                return None
    return None


def _at2(name: str, lines: Sequence[str]) -> Record:
    """PEER's AT2: four lines of header, the third with the unit, the fourth with NPTS and DT, then values."""
    head = next(k for k, line in enumerate(lines) if _step_in(line))
    count, step = _step_in(lines[head]) or (0, 0.0)
    if not (step > 0.0 and math.isfinite(step)):
        raise _refused(name, "E512", f"DT is {step:g}, a time step above 0 is needed", head + 1)
    said = " ".join(lines[:head])
    match = re.search(r"UNITS\s+OF\s+([^\s,;]+)", said, re.IGNORECASE)
    if match is None:
        raise _refused(name, "E511", "no line says ACCELERATION ... IN UNITS OF G", 3)
    if re.search(r"\b(VELOCITY|DISPLACEMENT)\b", said, re.IGNORECASE) and not re.search(
        r"\bACCEL", said, re.IGNORECASE
    ):
        raise DesignError(
            [Fault("E512", f"{name} is no record of acceleration", f"{name}:3", "Take the .AT2, not .VT2 or .DT2.")]
        )
    values: list[float] = []
    for k, line in enumerate(lines[head + 1 :], head + 2):
        values += [_value(word, name, k) for word in line.split()]
    if len(values) != count:
        message = f"NPTS is {count}, {len(values)} values follow"
        raise _refused(name, "E512", message, head + 1, "The file is cut off, or has been edited.")
    return record_of(name, step * np.arange(count), values, match[1].strip("().").lower())


def _value(word: str, name: str, line: int) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _no_number(name, line, word)
    return value


def _no_number(name: str, line: int, word: str) -> DesignError:
    return _refused(name, "E512", f"line {line} holds {word[:40]!r}, a number is needed", line)


def _columns(name: str, lines: Sequence[str], unit: str | None) -> Record:
    """Time and acceleration in two columns, below a line that names the unit or, where `unit` says it, without."""
    rows = [(k, line.strip()) for k, line in enumerate(lines, 1) if line.strip() and line.strip()[0] not in "#%!*"]
    first = next((k for k, (_, line) in enumerate(rows) if all(map(_is_number, _cells(line)))), None)
    if first is None:
        raise _refused(name, "E512", "no line holds numbers alone", rows[0][0] if rows else None)
    line, head = rows[first - 1] if first else (1, "")
    if head and any(map(_is_number, _cells(head))):
        raise _no_number(name, line, next(cell for cell in _cells(head) if not _is_number(cell)))
    if no_motion := _NO_MOTION.search(head.lower()):
        advice = "A record is time and acceleration of the ground, no spectrum, velocity or displacement."
        raise _refused(name, "E512", f"{no_motion[1]} in the head: no acceleration over time", line, advice)
    stated = _unit_of_head(head) or unit
    if stated is None:
        advice = f"Name it in the header (time (s), acceleration (g)), or give --unit: {_KNOWN}."
        raise _refused(name, "E511", "nothing says the unit of the acceleration", line, advice)
    motion = list[list[float]]()
    for line, text in rows[first:]:
        cells = _cells(text)
        if len(cells) != 2:
            message = f"line {line} has {counted(len(cells), 'column')}, two are needed: time and acceleration"
            raise _refused(name, "E512", message, line)
        motion.append([_value(cell, name, line) for cell in cells])
    times, values = zip(*motion, strict=True)
    return record_of(name, times, values, stated)


def _cells(line: str) -> list[str]:
    """The cells of a line: with semicolons or tabs between them a comma is that of a decimal."""
    if ";" in line or "\t" in line:
        return re.split(r"[;\s]+", line.replace(",", ".").strip("; "))
    return re.split(r"[,\s]+", line.strip(", "))


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _unit_of_head(head: str) -> str | None:
    """The one unit in a head: acceleration (g), acc [m/s²], a in gal, acc_gal; None where it names none, or several."""
    units = {word for word in re.split(r"[\s,;:=()\[\]_\"']+", _spelled(head)) if word in _UNITS}
    return units.pop() if len(units) == 1 else None


def _spelled(text: str) -> str:
    return text.lower().replace("²", "2").replace("^", "").replace(" /", "/").replace("/ ", "/")


def _factor_of(unit: str, name: str) -> float:
    spelled = _spelled(unit).strip()
    if spelled not in _UNITS:
        raise _refused(name, "E511", f"{unit!r} is no unit of acceleration", advice=f"Known: {_KNOWN}.")
    return _UNITS[spelled]


# -- pulses -----------------------------------------------------------------------------------------------------------


def _pulse(text: str) -> Record:
    """A pulse by its name.

    Raises
    ------
    DesignError
        E517 where the name is none of a pulse.
    """
    match = _PULSE.fullmatch(text.replace(" ", ""))
    if match is None:
        message = f"{text} is no pulse (rectangular, triangular or sine), nor a file"
        raise DesignError([Fault("E517", message, text, _PULSES)])
    shape, unit, measure = (match[k].lower() for k in (1, 3, 5))
    peak, length, cycles = _UNITS[unit] * float(match[2]), float(match[4]), int(match[6] or 1)
    if (shape == "sine") != (measure == "hz") or (match[6] and shape != "sine"):
        raise _refused(text, "E517", "a sine has a frequency in Hz, other pulses a duration", advice=_PULSES)
    if peak == 0.0 or not 1e-6 <= length <= 1e6 or not 1 <= cycles <= 100:
        message = "a number is out of range: peaks above 0, 1e-6 to 1e6 s or Hz, 1 to 100 whole cycles are taken"
        raise _refused(text, "E517", message, advice=_PULSES)
    if shape == "sine":
        parts = np.arange(cycles * _CYCLE + 1)
        values = peak * np.sin(2.0 * np.pi * parts / _CYCLE)
        values[:: _CYCLE // 2] = 0.0  # exactly, so that it ends where it began
        return record_of(text, parts / (_CYCLE * length), values, is_pulse=True)
    duration = length * (0.001 if measure == "ms" else 1.0)
    share = np.linspace(0.0, 1.0, _PARTS + 1)
    if shape == "rectangular":
        values = np.concatenate([[0.0], np.full(_PARTS + 1, peak), [0.0]])
        return record_of(text, duration * np.concatenate([[0.0], share, [1.0]]), values, is_pulse=True)
    return record_of(text, duration * share, peak * (1.0 - np.abs(2.0 * share - 1.0)), is_pulse=True)
