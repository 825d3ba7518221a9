"""Values as users write them (points, lines, water, acceptance rules) turned into checked objects or faults."""

import re
from collections.abc import Sequence
from typing import Any

from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.core.orientation import Line, number
from slopekit.core.units import quantity
from slopekit.design.fields import declare
from slopekit.design.parts import Rule

RULE_NAMES = (
    "fos",
    "fos.limit",
    "fos.closed_form",
    "fos.static_bound",
    "fos.all_pairs_failed",
    "fos.lowest",
    "fos.residual",
    "fos.fellenius",
    "fos.janbu",
    "fos.bishop",
)
_RULE = r"^\s*([A-Za-z_.]+)\s*(>=|<=|>|<)\s*(\S+)\s*$"  # texts: compiled when first used
_BARE_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)$"


def measured(value: object, kind: str, name: str, location: str, **limits: Any) -> float:
    """Return a number with a unit, within limits given as to `slopekit.design.fields.declare`."""
    return declare("", kind, **limits).read(value, name, location)


def above_zero(value: object, kind: str, name: str, code: str, location: str) -> float:
    return measured(value, kind, name, location, least=0.0, above=True, code=code)


def point(
    value: object, name: str, location: str, kind: str = "length"
) -> tuple[float, float, float]:
    """Return three coordinates, or three components of another quantity, in its unit."""
    coordinates = re.split(r"\s*,\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(coordinates, Sequence) or len(coordinates) != 3:
        raise DesignError(
            [Fault("E109", f"{name} needs three coordinates: east, north, up", location)]
        )
    east, north, up = (quantity(coordinate, kind, name, location) for coordinate in coordinates)
    return east, north, up


def fill(value: Any, location: str) -> float:
    """Return the fraction of full water pressure from dry, full, 0.5 or 50 %."""
    text = value.strip().lower() if isinstance(value, str) else ""
    if text in ("dry", "full"):
        return 1.0 if text == "full" else 0.0
    if text and not text.endswith("%") and not re.match(_BARE_NUMBER, text):
        advice = "Write dry, full, 50%, u=9.8kPa or u=5kPa,8kPa; in a crack 5 kPa."
        raise DesignError(
            [Fault("E118", f"water is {value!r}, which is not understood", location, advice)]
        )
    fraction = quantity(value, "ratio", "water", location)
    if fraction > 1.0:
        percent = text.endswith("%")
        advice = (
            ""
            if percent
            else f"Write {number(fraction)}% for a percentage, u={number(fraction)}kPa for a pressure."
        )
        raise DesignError(
            [
                Fault(
                    "E118",
                    f"water fills {number(fraction * 100)} % of the joints, more than all",
                    location,
                    advice,
                )
            ]
        )
    if fraction < 0.0:
        raise DesignError(
            [Fault("E118", f"water is {number(fraction * 100)} %, it is never negative", location)]
        )
    return fraction


def line_of_words(value: object, name: str, code: str, location: str) -> Line:
    angles = re.split(r"\s*/\s*", value.strip()) if isinstance(value, str) else value
    if not isinstance(angles, Sequence) or len(angles) != 2:
        raise DesignError(
            [
                Fault(
                    code,
                    f"direction of {name} is {value_text(value)}, it is written trend/plunge",
                    location,
                )
            ]
        )
    says = "it lies between -90 (up) and 90 (down)"
    trend = measured(
        angles[0], "angle", f"trend of {name}", location, least=0.0, most=360.0, code=code
    )
    plunge = measured(
        angles[1],
        "angle",
        f"plunge of {name}",
        location,
        least=-90.0,
        most=90.0,
        code=code,
        says=says,
    )
    return Line(trend, plunge)


def rule(value: object, location: str) -> Rule:
    """Return an acceptance rule from `fos >= 1.5`, or from the smallest allowed factor of safety alone."""
    if isinstance(value, str) and (match := re.match(_RULE, value)):
        name = match.group(1).lower()
        if name not in RULE_NAMES:
            advice = did_you_mean(name, RULE_NAMES, f"Known: {', '.join(RULE_NAMES)}.")
            raise DesignError(
                [
                    Fault(
                        "E169",
                        f"{match.group(1)} is nothing that a rule can judge",
                        location,
                        advice,
                    )
                ]
            )
        relation: Any = match.group(2)
        return Rule(name, relation, above_zero(match.group(3), "ratio", "accept", "E127", location))
    if isinstance(value, str) and not re.match(_BARE_NUMBER, value.strip()):
        advice = "A rule is written fos >= 1.5."
        raise DesignError(
            [Fault("E169", f"the rule {value!r} is not understood", location, advice)]
        )
    return Rule("fos", ">=", above_zero(value, "ratio", "accept", "E127", location))


def is_point(value: Any) -> bool:
    """Return whether a value is three bare numbers: the components of a force, not a list of forces."""
    if isinstance(value, str | dict) or not hasattr(value, "__len__") or len(value) != 3:
        return False
    return all(
        isinstance(coordinate, int | float) or hasattr(coordinate, "dtype") for coordinate in value
    )


def value_text(value: object) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return " ".join(str(item) for item in value)
    return str(value)
