"""Loads and points as a user writes them: one function a word, each value to a checked object or its faults."""

import re
from collections.abc import Sequence
from typing import Any

from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.core.orientation import Line, number
from slopekit.core.units import quantity
from slopekit.design.parts import Bolt, Force, Rule

RULE_NAMES = (
    "fos", "fos.limit", "fos.closed_form", "fos.static_bound", "fos.all_pairs_failed", "fos.lowest", "fos.residual",
    "fos.fellenius", "fos.janbu", "fos.bishop",
)  # fmt: skip
_RULE = r"^\s*([A-Za-z_.]+)\s*(>=|<=|>|<)\s*(\S+)\s*$"  # texts: compiled when first used
_BARE_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)$"


def above_zero(value: object, kind: str, name: str, code: str, where: str) -> float:
    result = quantity(value, kind, name, where)
    if result <= 0.0:
        raise DesignError([Fault(code, f"{name} is {number(result)}, it must be more than 0", where)])
    return result


def between(
    value: object, kind: str, ends: tuple[float, float], code: str, what: str, where: str, advice: str = "",
    unit: str = "",
) -> float:  # fmt: skip
    result = quantity(value, kind, what.removeprefix("the "), where)
    if not ends[0] <= result <= ends[1]:
        message = f"{what} is {number(result)}{unit}, it lies between {number(ends[0])} and {number(ends[1])}"
        raise DesignError([Fault(code, message, where, advice)])
    return result


def point(value: object, name: str, where: str) -> tuple[float, float, float]:
    parts = re.split(r"\s*,\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 3:
        raise DesignError([Fault("E109", f"{name} needs three coordinates: east, north, up", where)])
    east, north, up = (quantity(part, "length", name, where) for part in parts)
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


def trend(value: object, name: str, code: str, where: str) -> float:
    trend = quantity(value, "angle", f"trend of {name}", where)
    if not 0.0 <= trend <= 360.0:
        raise DesignError([Fault(code, f"trend of {name} is {number(trend)}, it lies between 0 and 360", where)])
    return trend


def line_of_words(value: object, name: str, code: str, where: str) -> Line:
    parts = re.split(r"\s*/\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(parts, Sequence) or len(parts) != 2:
        raise DesignError([Fault(code, f"direction of {name} is {shown(value)}, it is written trend/plunge", where)])
    toward = trend(parts[0], name, code, where)
    plunge = quantity(parts[1], "angle", f"plunge of {name}", where)
    if not -90.0 <= plunge <= 90.0:
        message = f"plunge of {name} is {number(plunge)}, it lies between -90 (up) and 90 (down)"
        raise DesignError([Fault(code, message, where)])
    return Line(toward, plunge)


def force(value: Any, where: str) -> Force:
    at = None
    if isinstance(value, dict):
        unknown = value.keys() - {"force", "toward", "at"}
        if unknown or "force" not in value:
            raise DesignError([Fault("E123", "a force has the keys force, toward, at", where)])
        at = point(value["at"], "point of the force", where) if "at" in value else None
        value = f"{value['force']}@{value['toward']}" if "toward" in value else value["force"]
    if isinstance(value, str) and "@" in value:
        size, _, toward = value.partition("@")
        amount = quantity(size, "force", "force", where)
        east, north, up = (amount * line_of_words(toward, "force", "E123", where).vector()).tolist()
    elif is_point(value):
        east, north, up = (quantity(part, "force", "force", where) for part in value)
    else:
        message = f"force is {shown(value)}, it is written 500kN@180/10 or (east, north, up)"
        raise DesignError([Fault("E123", message, where)])
    return Force((east, north, up), at)


def bolt(value: object, where: str) -> Bolt:
    head = length = None
    acts: Any = "active"
    if isinstance(value, str) and "@" in value:
        text, _, word = value.partition(",")
        size, _, toward = text.partition("@")
        acts = word.strip() or acts
    elif isinstance(value, dict) and {"force", "toward"} <= value.keys() <= {
        "force",
        "toward",
        "acts",
        "head",
        "length",
    }:
        size, toward, acts = value["force"], value["toward"], value.get("acts", acts)
        head = point(value["head"], "head of the bolt", where) if "head" in value else None
        if "length" in value:
            length = above_zero(value["length"], "length", "length of the bolt", "E124", where)
    else:
        message = f"bolt is {shown(value)}, it is written 200kN@000/10,passive or as force, toward, acts, head, length"
        raise DesignError([Fault("E124", message, where)])
    if acts not in ("active", "passive"):
        raise DesignError([Fault("E124", f"a bolt is active or passive, not {acts!r}", where)])
    if length is not None and head is None:
        raise DesignError([Fault("E124", "a bolt with a length needs its head", where)])
    force = above_zero(size, "force", "force of the bolt", "E124", where)
    return Bolt(force, line_of_words(toward, "bolt", "E124", where), acts, head, length)


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
