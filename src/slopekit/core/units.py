"""Numbers with units: "5 kPa", "2600 kg/m3", "64.89 m" to floats in m, kN, kPa, kN/m³, degrees."""

import math
import re
from collections.abc import Mapping
from typing import SupportsFloat

from slopekit.core.errors import DesignError, Fault

# factor to the unit that a bare number has; None marks angles in radians, which are refused by name
_UNITS: Mapping[str, Mapping[str, float]] = {
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": 0.3048, "in": 0.0254},
    "volume": {"m3": 1.0, "cm3": 1e-6, "dm3": 1e-3, "ft3": 0.028316846592},
    "pressure": {
        "kpa": 1.0,
        "pa": 1e-3,
        "mpa": 1e3,
        "gpa": 1e6,
        "kn/m2": 1.0,
        "psf": 0.04788025898,
        "psi": 6.894757293,
    },
    "unit weight": {
        "kn/m3": 1.0,
        "n/m3": 1e-3,
        "mn/m3": 1e3,
        "pcf": 0.1570874638,
        "lbf/ft3": 0.1570874638,
    },
    "density": {"kg/m3": 1.0, "t/m3": 1e3, "g/cm3": 1e3},
    "force": {
        "kn": 1.0,
        "n": 1e-3,
        "mn": 1e3,
        "tf": 9.80665,
        "lbf": 4.4482216e-3,
        "kip": 4.4482216,
    },
    "angle": {"deg": 1.0, "°": 1.0, "degrees": 1.0, "rad": math.degrees(1.0)},
    "stiffness": {"kn/m3": 1.0, "kpa/m": 1.0, "mpa/m": 1e3, "gpa/m": 1e6},
    "acceleration": {"m/s2": 1.0},
    "ratio": {"%": 1e-2, "g": 1.0},
}
_BARE = {
    "length": "m",
    "volume": "m3",
    "pressure": "kPa",
    "unit weight": "kN/m3",
    "density": "kg/m3",
    "force": "kN",
    "angle": "degrees",
    "stiffness": "kN/m3",
    "acceleration": "m/s2",
    "ratio": "no unit",
}
#: A larger number is no quantity of anything on Earth.
LARGEST = 1e18
_SPELLED = {
    "kpa": "kPa",
    "pa": "Pa",
    "mpa": "MPa",
    "gpa": "GPa",
    "kn/m2": "kN/m2",
    "kn/m3": "kN/m3",
    "n/m3": "N/m3",
    "mn/m3": "MN/m3",
    "kn": "kN",
    "n": "N",
    "mn": "MN",
    "kpa/m": "kPa/m",
    "mpa/m": "MPa/m",
    "gpa/m": "GPa/m",
}
_QUANTITY = r"(?i)^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?inf|nan)\s*(.*?)\s*$"  # compiled when first used


def quantity(value: object, kind: str, name: str, where: str = "") -> float:
    """Read a number that may carry a unit of the given kind.

    Parameters
    ----------
    value : number or str
    kind : one of length, volume, pressure, unit weight, density, force, angle, stiffness, acceleration, ratio
    name : what it is, for the message

    Raises
    ------
    DesignError
        E105 not finite, E106 text for a number, E107 a unit of the wrong kind, E108 an unknown unit.

    >>> quantity("50 Pa", "pressure", "c of J1"), quantity(2, "pressure", "c of J1")
    (0.05, 2.0)
    """
    where = where or f"{name} = {value}"
    if isinstance(value, bool) or value is None:
        raise DesignError([Fault("E106", f"{name} is {value!r}, a number is needed", where)])
    text = value if isinstance(value, str) else _written(value)
    if kind == "angle" and "°" in text:
        from slopekit.core.degrees import decimal_degrees  # few angles are in minutes

        text = decimal_degrees(text)
    match = re.match(_QUANTITY, text)
    if match is None or re.match(r"^,\d", match.group(2)):
        comma = re.match(r"^\s*[+-]?\d+,\d+", text)
        advice = f"Decimals take a point: {text.replace(',', '.')}" if comma else ""
        raise DesignError([Fault("E106", f"{name} is {text!r}, a number is needed", where, advice)])
    result = float(match.group(1)) * _factor(match.group(2), kind, name, where)
    if abs(result) > LARGEST and math.isfinite(result):
        raise DesignError(
            [Fault("E105", f"{name} is {text.strip()}, larger than anything on Earth", where)]
        )
    if not math.isfinite(result):
        raise DesignError([Fault("E105", f"{name} is {text.strip()}, not a finite number", where)])
    return result


def _written(value: object) -> str:
    """A bare value as text; what float() refuses is left for the message to show."""
    try:
        return repr(float(value)) if isinstance(value, SupportsFloat) else str(value)
    except OverflowError:
        return "inf"
    except (TypeError, ValueError):
        return str(value)


def _a(kind: str) -> str:
    return ("an " if kind[0] in "aeio" else "a ") + kind


def unit_of(value: object) -> str:
    """The unit written behind a number, lower case, or an empty text.

    >>> unit_of("2600 kg/m3"), unit_of(26)
    ('kg/m3', '')
    """
    match = re.match(_QUANTITY, value) if isinstance(value, str) else None
    return _spelled(match.group(2)) if match else ""


def is_unit_of(unit: str, kind: str) -> bool:
    """Whether `unit` (as `unit_of` gives it) measures that kind of thing."""
    return unit in _UNITS[kind]


def _spelled(unit: str) -> str:
    return unit.replace("³", "3").replace("²", "2").replace("^", "").replace(" ", "").lower()


def _factor(unit: str, kind: str, name: str, where: str) -> float:
    spelled = _spelled(unit)
    if not spelled:
        return 1.0
    if spelled in _UNITS[kind]:
        return _UNITS[kind][spelled]
    kinds = [kinds for kinds, units in _UNITS.items() if spelled in units]
    if kinds:
        message = f"{name} has the unit {unit}, which measures {_a(kinds[0])}, not {_a(kind)}"
        raise DesignError(
            [Fault("E107", message, where, f"A bare number here is in {_BARE[kind]}.")]
        )
    unit_names = ", ".join(_SPELLED.get(unit, unit) for unit in _UNITS[kind])
    raise DesignError(
        [
            Fault(
                "E108",
                f"{name} has the unknown unit {unit!r}",
                where,
                f"Known for {_a(kind)}: {unit_names}.",
            )
        ]
    )
