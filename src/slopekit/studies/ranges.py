"""Values of a key as users write them: `60,70,80`, `10m:20m:5` (how many), `10m:20m:+5m` (steps), `lo:hi`."""

import math
import re
from collections.abc import Sequence
from typing import NoReturn, TypeAlias

from slopekit.core.errors import fail
from slopekit.core.orientation import number
from slopekit.core.units import unit_of
from slopekit.studies.keys import Key

#: Two ends: a pair, or a text `lo:hi`.
Within: TypeAlias = str | Sequence[float | str]
MOST = 100_000
_DASHED = re.compile(r"\d[\d.]*\s*(-|–|\.\.\.?|to)\s*\d[\d.]*")  # 50-80
_LAST = 1e-9  # of a step: so near its end the last value is the end


def parse_values(key: Key, given: object, most: int = MOST) -> tuple[float, ...]:
    """The values that a key shall take, in the order given.

    Parameters
    ----------
    given : `a:b:n` (how many), `a:b:+s` (in steps), `a,b,c`, one number, or a sequence of numbers or texts

    Raises
    ------
    DesignError
        E312 where that is not understood, too many, or a value twice; E105 to E108 for a number.

    >>> parse_values(Key("slope.height", "length", 10.0, 0.001, 1e5), "10m:2000cm:3")
    (10.0, 15.0, 20.0)
    >>> parse_values(Key("slope.face.dip", "angle", 65.0, 0.0, 90.0), "60:75:+5")
    (60.0, 65.0, 70.0, 75.0)
    """
    if isinstance(given, str) and ":" in given:
        values = _evenly(key, given, most)
    else:
        if isinstance(given, str) and _DASHED.fullmatch(given.strip()):
            message = f"{key.path}: {given} is no range, ends are separated by a colon"
            first, last = re.findall(r"\d+(?:\.\d+)?", given)
            fail("E312", message, f"{key.path}={given}", f"Write {key.path}={first}:{last}:5 (from, to, how many).")
        parts = _parts(given)
        _one_spelling(key, parts, given)
        values = tuple(key.read(part) for part in parts)
    if not values:
        fail("E312", f"{key.path} has no values", f"{key.path}={given}", how_written(key.path))
    if len(values) > most:
        fail("E312", f"{key.path} has {len(values)} values, more than {most}", key.path)
    twice = next((value for k, value in enumerate(values) if value in values[:k]), None)
    if twice is not None:
        fail("E312", f"{key.path} has the value {key.shown(twice)} twice", f"{key.path}={given}")
    return values


def parse_within(key: Key, given: Within | None) -> tuple[float, float]:
    """The two ends of a range; None: what such a number can be, of a direction half a turn to both sides.

    Raises
    ------
    DesignError
        E312 where that is not two ends, the lower first; E105 to E108 for a number.

    >>> parse_within(Key("slope.height", "length", 10.0, 0.001, 1e5), "5:20")
    (5.0, 20.0)
    >>> parse_within(Key("joints.J1.plane.dip_direction", "angle", 0.0, 0.0, 360.0, period=360.0), "350:10")
    (350.0, 370.0)
    """
    if given is None:
        if key.period is not None and key.value is not None:
            return key.value - key.period / 2.0, key.value + key.period / 2.0
        return key.low, key.high
    parts = [part.strip() for part in given.split(":")] if isinstance(given, str) else list(given)
    where = f"{key.path}={given}" if isinstance(given, str) else key.path
    if len(parts) != 2 or any(part == "" for part in parts):
        fail(
            "E312",
            f"{given} is no range of {key.path}: two ends are needed",
            where,
            "Write KEY=lo:hi, for example strength.weak.phi=10:40.",
        )
    _one_spelling(key, parts, given)
    low, high = (key.read(part) for part in parts)
    high += _turn(key, low, high)
    if not low < high:
        fail("E312", f"{key.path} runs from {key.shown(low)} to {key.shown(high)}: the lower end comes first", where)
    return low, high


def _turn(key: Key, low: float, high: float) -> float:
    """What a range of directions across north, 350:10, has to be turned on so that it ends above where it begins."""
    return key.period if key.period is not None and high < low else 0.0


def how_written(path: str) -> str:
    """How values are written, for advice."""
    return f"Write {path}=60:80:5 (from, to, how many), {path}=60:80:+5 (in steps of 5), or {path}=60,70,80."


def _evenly(key: Key, given: str, most: int) -> tuple[float, ...]:
    """`a:b:n` or `a:b:+s`."""
    parts = [part.strip() for part in given.split(":")]

    def refuse(message: str) -> NoReturn:
        fail("E312", f"{key.path}: {message}", f"{key.path}={given}", how_written(key.path))

    if len(parts) != 3 or any(part == "" for part in parts):
        refuse(f"{given} is not from:to:how many, nor from:to:+step")
    in_steps = parts[2].startswith(("+", "-"))
    _one_spelling(key, [*parts[:2], parts[2][1:]] if in_steps else parts[:2], given)
    low, high = key.read(parts[0]), key.read(parts[1])
    high += 0.0 if parts[2].startswith("-") else _turn(key, low, high)
    if low == high:
        refuse(f"from {key.shown(low)} to the same")
    if in_steps:
        step = key.read(parts[2])
        if not 0.0 < step / (high - low) <= 1.0 + _LAST:
            refuse(f"steps of {parts[2]} do not lead from {key.shown(low)} to {key.shown(high)}")
        count = math.floor((high - low) / step + _LAST) + 1
        if count > most:
            refuse(f"{count} values are more than {most}")
    else:
        if not re.fullmatch(r"[0-9]{1,7}", parts[2]) or not 2 <= int(parts[2]) <= most:
            refuse(f"{parts[2]} is no number of values from 2 to {most}; steps are written with +")
        count = int(parts[2])
        step = (high - low) / (count - 1)
    values = [low + step * k for k in range(count)]
    if not in_steps or abs(values[-1] - high) <= _LAST * abs(step):
        values[-1] = high
    tidy = [float(number(value)) for value in values]  # 0.30000000000000004 is 0.3
    return tuple(round_ if math.isclose(round_, value, rel_tol=1e-12, abs_tol=1e-15) else value
                 for round_, value in zip(tidy, values, strict=True))  # fmt: skip


def _parts(given: object) -> list[object]:
    if isinstance(given, str):
        return [part.strip() for part in given.split(",")]
    if hasattr(given, "tolist"):
        given = given.tolist()
    return list(given) if isinstance(given, Sequence) else [given]


def _one_spelling(key: Key, parts: Sequence[object], given: object) -> None:
    """Refuse 10:20ft, of which nobody knows whether the ten are feet: nought alone needs no unit, nor does a part."""
    if key.kind == "ratio":
        return
    units = {unit_of(part) for part in parts if str(part).strip() not in ("0", "0.0")}
    if len(units) > 1 and "" in units:
        fail(
            "E312",
            f"{key.path}: some values carry a unit and others do not",
            f"{key.path}={given}",
            "Write the unit with each of them.",
        )
