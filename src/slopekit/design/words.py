"""Loads and points as a user writes them: one function a word, each value to a checked object or its faults."""

import re
from collections.abc import Sequence
from typing import Any

from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.core.orientation import Line, number
from slopekit.core.units import quantity
from slopekit.design.fields import declare
from slopekit.design.parts import Rule

RULE_NAMES = (
    "fos", "fos.limit", "fos.closed_form", "fos.static_bound", "fos.all_pairs_failed", "fos.lowest", "fos.residual",
    "fos.fellenius", "fos.janbu", "fos.bishop",
)  # fmt: skip
_RULE = r"^\s*([A-Za-z_.]+)\s*(>=|<=|>|<)\s*(\S+)\s*$"  # texts: compiled when first used
_BARE_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)$"


def measured(value: object, kind: str, name: str, where: str, **limits: Any) -> float:
    """A number with a unit, between limits as `slopekit.design.fields.declare` takes them."""
    return declare("", kind, **limits).read(value, name, where)


def above_zero(value: object, kind: str, name: str, code: str, where: str) -> float:
    return measured(value, kind, name, where, least=0.0, above=True, code=code)


def point(value: object, name: str, where: str, kind: str = "length") -> tuple[float, float, float]:
    """Three coordinates, or components of another kind."""
    parts = re.split(r"\s*,\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 3:
        raise DesignError([Fault("E109", f"{name} needs three coordinates: east, north, up", where)])
    east, north, up = (quantity(part, kind, name, where) for part in parts)
    return east, north, up


def fill(value: Any, where: str) -> float:
    """A part of the pressure of full water: dry, full, 0.5 or 50 %."""
    text = value.strip().lower() if isinstance(value, str) else ""
    if text in ("dry", "full"):
        return 1.0 if text == "full" else 0.0
    if text and not text.endswith("%") and not re.match(_BARE_NUMBER, text):
        advice = "Write dry, full, 50%, u=9.8kPa or u=5kPa,8kPa; in a crack 5 kPa."
        raise DesignError([Fault("E118", f"water is {value!r}, which is not understood", where, advice)])
    part = quantity(value, "ratio", "water", where)
    if part > 1.0:
        percent = text.endswith("%")
        advice = "" if percent else f"Write {number(part)}% for a percentage, u={number(part)}kPa for a pressure."
        raise DesignError(
            [Fault("E118", f"water fills {number(part * 100)} % of the joints, more than all", where, advice)]
        )
    if part < 0.0:
        raise DesignError([Fault("E118", f"water is {number(part * 100)} %, it is never negative", where)])
    return part


def line_of_words(value: object, name: str, code: str, where: str) -> Line:
    parts = re.split(r"\s*/\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 2:
        raise DesignError([Fault(code, f"direction of {name} is {shown(value)}, it is written trend/plunge", where)])
    says = "it lies between -90 (up) and 90 (down)"
    trend = measured(parts[0], "angle", f"trend of {name}", where, least=0.0, most=360.0, code=code)
    plunge = measured(parts[1], "angle", f"plunge of {name}", where, least=-90.0, most=90.0, code=code, says=says)
    return Line(trend, plunge)


def rule(value: object, where: str) -> Rule:
    """An acceptance rule: `fos >= 1.5`, or the smallest factor of safety alone."""
    if isinstance(value, str) and (match := re.match(_RULE, value)):
        name = match.group(1).lower()
        if name not in RULE_NAMES:
            advice = did_you_mean(name, RULE_NAMES, f"Known: {', '.join(RULE_NAMES)}.")
            raise DesignError([Fault("E169", f"{match.group(1)} is nothing that a rule can judge", where, advice)])
        relation: Any = match.group(2)
        return Rule(name, relation, above_zero(match.group(3), "ratio", "accept", "E127", where))
    if isinstance(value, str) and not re.match(_BARE_NUMBER, value.strip()):
        advice = "A rule is written fos >= 1.5."
        raise DesignError([Fault("E169", f"the rule {value!r} is not understood", where, advice)])
    return Rule("fos", ">=", above_zero(value, "ratio", "accept", "E127", where))


def is_point(value: Any) -> bool:
    """Three bare numbers: one force, not a list of forces."""
    if isinstance(value, str | dict) or not hasattr(value, "__len__") or len(value) != 3:
        return False
    return all(isinstance(part, int | float) or hasattr(part, "dtype") for part in value)


def shown(value: object) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return " ".join(str(item) for item in value)
    return str(value)
