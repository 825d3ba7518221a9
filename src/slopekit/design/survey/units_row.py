"""A row of units between the header of a list and its joints: `Dip,Dip Direction,Spacing`, then `deg,deg,m`."""

import re
from collections.abc import Sequence

from slopekit.core.errors import DesignError, Fault
from slopekit.core.units import is_unit_of, unit_of
from slopekit.design.survey.columns import key_of, size_of, unit_in_heading

_DEGREES = re.compile(r"(deg|°|º)", re.IGNORECASE)
_METRES = ("metre", "metres", "meter", "meters")
_NO_DEGREES = ("radian", "radians", "gon", "grad", "grads")
_NOTHING = ("", "-", "–", "—", "n/a", "none")
_KINDS = ("angle", "length", "pressure")
_TEXTS = ("name", "set", "hole", "reference")  # columns of words, of which any word may stand for the unit


def headings_with_units(headings: Sequence[str], cells: Sequence[str]) -> list[str] | None:
    """The headings, each with the unit in the row below it, or None where that row holds no units.

    Raises
    ------
    DesignError
        E191 where a heading has another unit.

    >>> headings_with_units(["Dip", "Dip Direction", "c (kPa)", "set"], ["deg", "deg", "kPa", ""])
    ['Dip (deg)', 'Dip Direction (deg)', 'c (kPa)', 'set']
    >>> headings_with_units(["Dip", "Dip Direction"], ["45", "115"]) is None
    True
    """
    units = [cell.strip(" ()[]") for cell in cells]
    found = False
    for heading, unit in zip(headings, units, strict=False):
        is_known = key_of(heading) not in (None, *_TEXTS) or size_of(heading) is not None
        if re.match(r"[+-]?[.,]?\d", unit) or (is_known and unit.lower() not in _NOTHING and not _unit(unit)):
            return None
        found = found or (is_known and _unit(unit) != "")
    if not found:
        return None
    units += [""] * (len(headings) - len(units))
    return [_with_unit(heading, _unit(unit)) for heading, unit in zip(headings, units, strict=False)]


def _unit(word: str) -> str:
    """The unit that a word means, empty where it means none."""
    lower = word.lower()
    if _DEGREES.match(word):
        return "deg"
    if lower in _METRES:
        return "m"
    return word if lower in _NO_DEGREES or any(is_unit_of(unit_of(f"1 {word}"), kind) for kind in _KINDS) else ""


def _with_unit(heading: str, unit: str) -> str:
    written = unit_in_heading(heading)
    if unit and written and _unit(written) not in ("", unit):
        message = f"the column {heading} is in {unit} by the row of units"
        raise DesignError([Fault("E191", message, heading, "Leave one of the units out.")])
    return f"{heading} ({unit})" if unit and not written else heading
