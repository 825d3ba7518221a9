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
from slopekit.core.errors import Faults, Notice, fail
from slopekit.core.orientation import number
from slopekit.core.sheet import counted
from slopekit.design.reading.on_disk import read_bytes

#: Standard gravity, of which accelerations in g are parts.
GRAVITY = 9.80665
_UNITS = {"g": GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01}
_UNIT_NAMES = "g, m/s2, cm/s2, gal"
_ENDINGS = (".csv", ".txt", ".dat", ".at2", ".acc")
_MAX_BYTES = 50_000_000
_MAX_RECORDS = 500
_MAX_PGA_G = 10.0  # no record of an earthquake has more than half of it
_STEP_TOLERANCE = 0.01  # of a step
_GAP_STEPS = 10.0  # times the usual step
_MAX_STEP_S = (
    1.000001  # s: 1 Hz; no instrument of strong motion takes its samples so far apart, ...
)
_MIN_INSTRUMENT_SAMPLES = 20  # ... and a motion of fewer samples may have been drawn
_MAX_DURATION_S = 3600.0  # s: the longest earthquakes shake for some ten minutes
_MAX_DRIFT = 0.1  # of the highest velocity of the ground
_PULSE_STEPS = 100  # of a rectangular or triangular pulse
_SAMPLES_PER_CYCLE = 2000  # samples of a sine: the displacement is off by some 2e-6
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
    rf"(rectangular|triangular|sine):{_NUMBER}(g|m/s2|cm/s2|gal),{_NUMBER}(s|ms|hz)(?:,(\d+))?",
    re.IGNORECASE,
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
        return float(
            np.pi / (2.0 * GRAVITY) * (np.diff(self.times_s) * (a * a + a * b + b * b) / 3.0).sum()
        )

    def scaled(self, pga_g: float) -> "Record":
        """The record with another peak."""
        return replace(self, accelerations=frozen(self.accelerations * (pga_g / self.pga_g)))


def record_of(
    name: str, times_s: Any, accelerations: Any, unit: str = "m/s2", is_pulse: bool = False
) -> Record:
    """A record from arrays (n,), checked.

    Raises
    ------
    DesignError
        E511 the unit, or an acceleration that none has, E512 no numbers, too few samples or nothing but zeros, E514
        times that do not rise or are not in seconds.
    """
    t, a = (
        np.asarray(times_s, dtype=np.float64).ravel(),
        np.asarray(accelerations, dtype=np.float64).ravel(),
    )
    if len(t) != len(a):
        fail("E512", f"{name}: {len(t)} times and {len(a)} accelerations", name)
    bad = np.flatnonzero(~(np.isfinite(t) & np.isfinite(a)))
    if len(bad):
        fail("E512", f"{name}: sample {bad[0] + 1} is not a finite number", name)
    a = a * _unit_factor(unit, name)
    if len(a) < 2 or not a.any():
        content = counted(len(a), "sample") if len(a) < 2 else "nothing but zeros"
        fail("E512", f"{name} has {content}: no record of an earthquake", name)
    steps = np.diff(t)
    not_rising = np.flatnonzero(steps < 0.0 if is_pulse else steps <= 0.0)
    if len(not_rising):
        fall_time, next_time = (number(time) for time in t[not_rising[0] : not_rising[0] + 2])
        fail(
            "E514",
            f"{name}: time does not rise from sample {not_rising[0] + 1} ({fall_time} s) to the next ({next_time} s)",
            name,
        )
    median_step, duration = float(np.median(steps)), float(steps.sum())
    is_coarse = median_step > _MAX_STEP_S and len(steps) >= _MIN_INSTRUMENT_SAMPLES
    if not is_pulse and (
        is_coarse or duration > _MAX_DURATION_S
    ):  # sliding goes with the square of times
        step_s = number(float(f"{median_step * 1e-3:.6g}"))
        fail(
            "E514",
            f"{name}: the time step is {median_step:.6g} s and it lasts {duration:.6g} s: "
            "no record of an earthquake in seconds",
            name,
            f"Times in ms are written in s, {step_s} s apart; numbers of samples times the step between them.",
        )
    record = Record(name, frozen(t - t[0]), frozen(a), unit, is_pulse)
    if record.pga_g > _MAX_PGA_G:
        limit = f"more than any earthquake's (up to {_MAX_PGA_G:g} g)"
        fail("E511", f"{name}: the peak is {record.pga_g:.4g} g as {unit}, {limit}", name)
    return record if is_pulse else replace(record, notices=tuple(_notices_of(record)))


def _notices_of(record: Record) -> Iterator[Notice]:
    """Yield W460 of uneven steps and of the baseline."""
    steps = np.diff(record.times_s)
    median_step, gap = float(np.median(steps)), float(steps.max())
    uneven = int((np.abs(steps - median_step) > _STEP_TOLERANCE * median_step).sum())
    if uneven:
        gap_remark = (
            f"; the longest, {number(gap)} s, is a gap" if gap > _GAP_STEPS * median_step else ""
        )
        yield Notice(
            "W460",
            f"{record.name}: {uneven} of {len(steps)} time steps are not {median_step:.6g} s{gap_remark}; it is "
            "taken as linear between its samples",
        )
    final_velocity = float(record.ground_velocity[-1])
    if abs(final_velocity) > _MAX_DRIFT * record.pgv_m_s:
        yield Notice(
            "W460",
            f"{record.name}: the ground moves at {final_velocity:.3g} m/s at its end "
            f"({abs(final_velocity) / record.pgv_m_s:.0%} of its peak): baseline not corrected, or cut off",
        )


# -- from files ------------------------------------------------------------------------------------------------------


def read_records(sources: Sequence[Any], unit: str | None = None) -> tuple[Record, ...]:
    """Records by their files, folders or names of pulses, all faults at once.

    Parameters
    ----------
    sources : texts, paths, or records that are there already
    unit : of files that name none

    Raises
    ------
    DesignError
        E147 to E149 for the files, E510 nothing there, E511, E512 and E514 what is in them, E517 a pulse.
    """
    if unit is not None:
        _unit_factor(unit, "unit")
    records, paths, faults = list[Record](), list[Any](), Faults()
    for source in sources:
        paths += faults.of(_files_in, source) or []
    if not paths and not faults:
        fail("E510", "no record is given", "RECORD", f"Give files, folders, or a pulse: {_PULSES}")
    if len(paths) > _MAX_RECORDS:
        fail("E510", f"{len(paths)} records are given, at most {_MAX_RECORDS} at a time")
    for source in paths:
        with faults.collecting():
            records.append(source if isinstance(source, Record) else read_record(source, unit))
    faults.refuse()
    names = [record.name for record in records]
    return tuple(
        record
        if names.count(name) == 1
        else replace(record, name=f"{name} ({names[: k + 1].count(name)})")
        for k, (name, record) in enumerate(zip(names, records, strict=True))
    )


def _files_in(path: Any) -> list[Any]:
    """The records of a folder; anything else as it is. E510 where the folder holds none."""
    if (
        not isinstance(path, str | os.PathLike)
        or not os.fspath(path).strip()
        or not os.path.isdir(path)
    ):
        return [path]
    inside = sorted(file for file in Path(path).iterdir() if file.suffix.lower() in _ENDINGS)
    if not inside:
        fail("E510", f"the folder {path} holds no record", str(path), f"Read: {' '.join(_ENDINGS)}")
    return list(inside)


def read_record(path: str | os.PathLike[str], unit: str | None = None) -> Record:
    """A record from a file, or a pulse by its name: rectangular:0.5g,0.3s  triangular:0.5g,0.3s  sine:0.5g,1Hz,5.

    Raises
    ------
    DesignError
        As `read_records`.
    """
    if not isinstance(path, str | os.PathLike):
        advice = "Give a path, the name of a pulse, or record_of(name, times, accelerations, unit)."
        fail("E510", f"{str(path)[:40]!r} is no record", advice=advice)
    text, name = os.fspath(path), Path(path).name
    if re.match(_LIKE_PULSE, text, re.IGNORECASE) and not os.path.exists(path):
        return _pulse(text)
    if not text.strip():
        fail("E510", "a record without a name is given", "RECORD")
    content = read_bytes(path, _MAX_BYTES)
    if b"\0" in content[:4096]:
        fail("E512", f"{name} is no text: it holds bytes that no record has", name)
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        lines = content.decode("latin-1").splitlines()
    if not any(line.strip() for line in lines):
        fail("E512", f"{name} is empty", str(path))
    head = next((k for k, line in enumerate(lines[:8]) if _header_step(line)), None)
    return _columns(name, lines, unit) if head is None else _at2(name, lines, head)


def _header_step(line: str) -> tuple[int, float] | None:
    """Number of points and step of a line of AT2."""
    match = next(filter(None, (pattern.search(line) for pattern in _STEPS)), None)
    return (int(match[1]), float(match[2])) if match is not None and _is_number(match[2]) else None


def _at2(name: str, lines: Sequence[str], head: int) -> Record:
    """PEER's AT2: lines of header, the last of them with NPTS and DT, one before it with the unit; then values."""
    count, step = _header_step(lines[head]) or (0, 0.0)
    if not step > 0.0:
        fail("E512", f"{name}: DT is {step:g}, a time step above 0 is needed", f"{name}:{head + 1}")
    header = " ".join(lines[:head])
    match = re.search(r"UNITS\s+OF\s+([^\s,;]+)", header, re.IGNORECASE)
    if match is None:
        fail("E511", f"{name}: no line says ACCELERATION ... IN UNITS OF G", f"{name}:3")
    if (
        re.search(r"\b(VELOCITY|DISPLACEMENT)\b", header, re.IGNORECASE)
        and "ACCEL" not in header.upper()
    ):
        fail(
            "E512",
            f"{name} is no record of acceleration",
            f"{name}:3",
            "Take the .AT2, not .VT2 or .DT2.",
        )
    values = [
        _value(word, name, k)
        for k, line in enumerate(lines[head + 1 :], head + 2)
        for word in line.split()
    ]
    if len(values) != count:
        fail(
            "E512",
            f"{name}: NPTS is {count}, {len(values)} values follow",
            f"{name}:{head + 1}",
            "The file is cut off, or has been edited.",
        )
    return record_of(name, step * np.arange(count), values, match[1].strip("().").lower())


def _value(word: str, name: str, line: int) -> float:
    """A number of a line. E512 for anything else."""
    if not _is_number(word):
        fail(
            "E512", f"{name}: line {line} holds {word[:40]!r}, a number is needed", f"{name}:{line}"
        )
    return float(word)


def _columns(name: str, lines: Sequence[str], unit: str | None) -> Record:
    """Time and acceleration in two columns, below a line that names the unit or, where `unit` says it, without."""
    rows = [
        (k, line.strip())
        for k, line in enumerate(lines, 1)
        if line.strip() and line.strip()[0] not in "#%!*"
    ]
    first = next(
        (k for k, (_, line) in enumerate(rows) if all(map(_is_number, _cells(line)))), None
    )
    if first is None:
        fail(
            "E512", f"{name}: no line holds numbers alone", f"{name}:{rows[0][0]}" if rows else name
        )
    line, head = rows[first - 1] if first else (1, "")
    if any(map(_is_number, _cells(head))):
        _value(next(cell for cell in _cells(head) if not _is_number(cell)), name, line)
    if no_motion := _NO_MOTION.search(head.lower()):
        fail(
            "E512",
            f"{name}: {no_motion[1]} in the head: no acceleration over time",
            f"{name}:{line}",
            "A record is time and acceleration of the ground, no spectrum, velocity or displacement.",
        )
    # the one unit in the head: acceleration (g), acc [m/s²], a in gal, acc_gal
    units = {
        word for word in re.split(r"[\s,;:=()\[\]_\"']+", _normalised_unit(head)) if word in _UNITS
    }
    record_unit = units.pop() if len(units) == 1 else unit
    if record_unit is None:
        fail(
            "E511",
            f"{name}: nothing says the unit of the acceleration",
            f"{name}:{line}",
            f"Name it in the header (time (s), acceleration (g)), or give --unit: {_UNIT_NAMES}.",
        )
    motion = list[list[float]]()
    for line, text in rows[first:]:
        cells = _cells(text)
        if len(cells) != 2:
            message = f"line {line} has {counted(len(cells), 'column')}, two are needed: time and acceleration"
            fail("E512", f"{name}: {message}", f"{name}:{line}")
        motion.append([_value(cell, name, line) for cell in cells])
    times, values = zip(*motion, strict=True)
    return record_of(name, times, values, record_unit)


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


def _normalised_unit(text: str) -> str:
    return text.lower().replace("²", "2").replace("^", "").replace(" /", "/").replace("/ ", "/")


def _unit_factor(unit: str, name: str) -> float:
    spelled = _normalised_unit(unit).strip()
    if spelled not in _UNITS:
        fail("E511", f"{name}: {unit!r} is no unit of acceleration", name, f"Known: {_UNIT_NAMES}.")
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
        fail(
            "E517",
            f"{text} is no pulse (rectangular, triangular or sine), nor a file",
            text,
            _PULSES,
        )
    shape, unit, measure = (match[k].lower() for k in (1, 3, 5))
    peak, length, cycles = _UNITS[unit] * float(match[2]), float(match[4]), int(match[6] or 1)
    if (shape == "sine") != (measure == "hz") or (match[6] and shape != "sine"):
        fail(
            "E517", f"{text}: a sine has a frequency in Hz, other pulses a duration", text, _PULSES
        )
    if peak == 0.0 or not 1e-6 <= length <= 1e6 or not 1 <= cycles <= 100:
        limits = "peaks above 0, 1e-6 to 1e6 s or Hz, 1 to 100 whole cycles are taken"
        fail("E517", f"{text}: a number is out of range: {limits}", text, _PULSES)
    if shape == "sine":
        samples = np.arange(cycles * _SAMPLES_PER_CYCLE + 1)
        values = peak * np.sin(2.0 * np.pi * samples / _SAMPLES_PER_CYCLE)
        values[:: _SAMPLES_PER_CYCLE // 2] = 0.0  # exactly, so that it ends where it began
        return record_of(text, samples / (_SAMPLES_PER_CYCLE * length), values, is_pulse=True)
    duration = length * (0.001 if measure == "ms" else 1.0)
    share = np.linspace(0.0, 1.0, _PULSE_STEPS + 1)
    if shape == "rectangular":
        values = np.concatenate([[0.0], np.full(_PULSE_STEPS + 1, peak), [0.0]])
        return record_of(
            text, duration * np.concatenate([[0.0], share, [1.0]]), values, is_pulse=True
        )
    return record_of(
        text, duration * share, peak * (1.0 - np.abs(2.0 * share - 1.0)), is_pulse=True
    )
