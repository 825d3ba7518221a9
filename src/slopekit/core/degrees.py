"""Angles in degrees, minutes and seconds."""

import re

# a text, which is compiled when it is first used
_MINUTES = r"(\d+)\s*°\s*([0-5]?\d(?:\.\d+)?)\s*['′’´](?:\s*([0-5]?\d(?:\.\d+)?)\s*(?:[\"″”]|''))?"


def decimal_degrees(text: str) -> str:
    """A text whose degrees, minutes and seconds are in decimals; minutes from 60 are none, and stay as they are.

    >>> decimal_degrees("45°30'"), decimal_degrees("45°30'/115° 15' 36\\""), decimal_degrees("45°75'")
    ('45.5', '45.5/115.26', "45°75'")
    """
    return re.sub(_MINUTES, _in_decimals, text) if "°" in text else text


def _in_decimals(match: re.Match[str]) -> str:
    degrees, minutes, seconds = (float(group or 0.0) for group in match.groups())
    return f"{degrees + minutes / 60.0 + seconds / 3600.0:.10g}"
