"""Read values of a key as users write them: `60,70,80`, `10m:20m:5` (count), `10m:20m:+5m` (steps), `lo:hi`."""

import math
import re
from collections.abc import Sequence
from typing import NoReturn, TypeAlias

from slopekit.core.errors import fail
from slopekit.core.orientation import number
from slopekit.core.units import unit_of
from slopekit.studies.keys import Key

#: The two ends of a range: a pair, or a text `lo:hi`.
SearchRange: TypeAlias = str | Sequence[float | str]
MOST = 100_000
_DASHED_RANGE = re.compile(r"\d[\d.]*\s*(-|–|\.\.\.?|to)\s*\d[\d.]*")  # 50-80
_END_TOLERANCE = 1e-9  # in steps: within this distance of the end the last value is the end


def parse_values(key: Key, user_values: object, most: int = MOST) -> tuple[float, ...]:
    """Return the values of a key from what a user wrote, in the same order.

    Parameters
    ----------
    user_values : `a:b:n` (how many), `a:b:+s` (in steps), `a,b,c`, one number, or a sequence of numbers or texts

    Raises
    ------
    DesignError
        E312 where that is not understood, too many, or a value twice; E105 to E108 for a number.

    >>> parse_values(Key("slope.height", "length", 10.0, 0.001, 1e5), "10m:2000cm:3")
    (10.0, 15.0, 20.0)
    >>> parse_values(Key("slope.face.dip", "angle", 65.0, 0.0, 90.0), "60:75:+5")
    (60.0, 65.0, 70.0, 75.0)
    """
    if isinstance(user_values, str) and ":" in user_values:
        values = _evenly_spaced(key, user_values, most)
    else:
        if isinstance(user_values, str) and _DASHED_RANGE.fullmatch(user_values.strip()):
            message = f"{key.path}: {user_values} is no range, ends are separated by a colon"
            first, last = re.findall(r"\d+(?:\.\d+)?", user_values)
            fail(
                "E312",
                message,
                f"{key.path}={user_values}",
                f"Write {key.path}={first}:{last}:5 (from, to, how many).",
            )
        entries = _separate_entries(user_values)
        _check_units(key, entries, user_values)
        values = tuple(key.read(entry) for entry in entries)
    if not values:
        fail(
            "E312", f"{key.path} has no values", f"{key.path}={user_values}", how_written(key.path)
        )
    if len(values) > most:
        fail("E312", f"{key.path} has {len(values)} values, more than {most}", key.path)
    repeated = next((value for k, value in enumerate(values) if value in values[:k]), None)
    if repeated is not None:
        fail(
            "E312",
            f"{key.path} has the value {key.value_text(repeated)} twice",
            f"{key.path}={user_values}",
        )
    return values


def parse_within(key: Key, user_range: SearchRange | None) -> tuple[float, float]:
    """Return the two ends of a range; of None the limits of the key, of a direction half a turn to both sides.

    Raises
    ------
    DesignError
        E312 where that is not two ends, the lower first; E105 to E108 for a number.

    >>> parse_within(Key("slope.height", "length", 10.0, 0.001, 1e5), "5:20")
    (5.0, 20.0)
    >>> parse_within(Key("joints.J1.plane.dip_direction", "angle", 0.0, 0.0, 360.0, period=360.0), "350:10")
    (350.0, 370.0)
    """
    if user_range is None:
        if key.period is not None and key.value is not None:
            return key.value - key.period / 2.0, key.value + key.period / 2.0
        return key.low, key.high
    ends = (
        [end.strip() for end in user_range.split(":")]
        if isinstance(user_range, str)
        else list(user_range)
    )
    location = f"{key.path}={user_range}" if isinstance(user_range, str) else key.path
    if len(ends) != 2 or any(end == "" for end in ends):
        fail(
            "E312",
            f"{user_range} is no range of {key.path}: two ends are needed",
            location,
            "Write KEY=lo:hi, for example strength.weak.phi=10:40.",
        )
    _check_units(key, ends, user_range)
    low, high = (key.read(end) for end in ends)
    high += _turn(key, low, high)
    if not low < high:
        fail(
            "E312",
            f"{key.path} runs from {key.value_text(low)} to {key.value_text(high)}: the lower end comes first",
            location,
        )
    return low, high


def _turn(key: Key, low: float, high: float) -> float:
    """Return the angle to add to the upper end of a range of directions across north, such as 350:10."""
    return key.period if key.period is not None and high < low else 0.0


def how_written(path: str) -> str:
    """Return the advice how to write values of a key."""
    return f"Write {path}=60:80:5 (from, to, how many), {path}=60:80:+5 (in steps of 5), or {path}=60,70,80."


def _evenly_spaced(key: Key, range_text: str, most: int) -> tuple[float, ...]:
    """Return the values of `a:b:n` or `a:b:+s`."""
    entries = [entry.strip() for entry in range_text.split(":")]

    def refuse(message: str) -> NoReturn:
        fail("E312", f"{key.path}: {message}", f"{key.path}={range_text}", how_written(key.path))

    if len(entries) != 3 or any(entry == "" for entry in entries):
        refuse(f"{range_text} is not from:to:how many, nor from:to:+step")
    in_steps = entries[2].startswith(("+", "-"))
    _check_units(key, [*entries[:2], entries[2][1:]] if in_steps else entries[:2], range_text)
    low, high = key.read(entries[0]), key.read(entries[1])
    high += 0.0 if entries[2].startswith("-") else _turn(key, low, high)
    if low == high:
        refuse(f"from {key.value_text(low)} to the same")
    if in_steps:
        step = key.read(entries[2])
        if not 0.0 < step / (high - low) <= 1.0 + _END_TOLERANCE:
            refuse(
                f"steps of {entries[2]} do not lead from {key.value_text(low)} to {key.value_text(high)}"
            )
        count = math.floor((high - low) / step + _END_TOLERANCE) + 1
        if count > most:
            refuse(f"{count} values are more than {most}")
    else:
        if not re.fullmatch(r"[0-9]{1,7}", entries[2]) or not 2 <= int(entries[2]) <= most:
            refuse(
                f"{entries[2]} is no number of values from 2 to {most}; steps are written with +"
            )
        count = int(entries[2])
        step = (high - low) / (count - 1)
    values = [low + step * k for k in range(count)]
    if not in_steps or abs(values[-1] - high) <= _END_TOLERANCE * abs(step):
        values[-1] = high
    tidy = [float(number(value)) for value in values]  # 0.30000000000000004 is 0.3
    return tuple(
        round_ if math.isclose(round_, value, rel_tol=1e-12, abs_tol=1e-15) else value
        for round_, value in zip(tidy, values, strict=True)
    )


def _separate_entries(user_values: object) -> list[object]:
    if isinstance(user_values, str):
        return [entry.strip() for entry in user_values.split(",")]
    if hasattr(user_values, "tolist"):
        user_values = user_values.tolist()
    return list(user_values) if isinstance(user_values, Sequence) else [user_values]


def _check_units(key: Key, entries: Sequence[object], user_values: object) -> None:
    """Refuse 10:20ft, where the unit of 10 is ambiguous; zero and ratios need no unit."""
    if key.kind == "ratio":
        return
    units = {unit_of(entry) for entry in entries if str(entry).strip() not in ("0", "0.0")}
    if len(units) > 1 and "" in units:
        fail(
            "E312",
            f"{key.path}: some values carry a unit and others do not",
            f"{key.path}={user_values}",
            "Write the unit with each of them.",
        )
