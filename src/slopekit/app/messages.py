"""Messages of the app's socket: JSON of bounded size; anything else is refused by a fault."""

import json
from collections.abc import Mapping
from typing import Any

from slopekit.core.codec import finite
from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.nodes import cut, printable

Message = dict[str, Any]
LARGEST, LARGEST_SURVEY = 1_000_000, 20_000_000  # letters of a message
_DEEPEST = 12
_MOST_DIGITS = 300  # of a whole number that is still a float
MOST_VALUES = 200  # that one message sets


def message_error(message: str, advice: str = "", code: str = "E541") -> DesignError:
    """A message that is wrong, as it is refused."""
    return DesignError([Fault(code, message, "", advice)])


def parsed(text: str) -> Message:
    """A message, where it is one.

    Raises
    ------
    DesignError
        E541 for what is none, too large or too deep.
    """
    if len(text) > LARGEST_SURVEY or (len(text) > LARGEST and '"survey"' not in text[:400]):
        raise message_error(
            f"the message has {len(text)} letters: too many", f"The most are {LARGEST}.", "E541"
        )
    try:
        message = json.loads(text, parse_constant=finite, parse_float=finite, parse_int=_integer)
    except RecursionError:
        raise message_error("the message is nested too deep", "", "E541") from None
    except ValueError as error:
        raise message_error(f"the message is no JSON: {cut(printable(str(error)))}") from None
    if not isinstance(message, dict):
        raise message_error("the message is no JSON object", 'Send {"id": 1, "do": "set", ...}.')
    _check_depth(message)
    if len(text) > LARGEST and message.get("do") != "survey":
        raise message_error(
            f"the message has {len(text)} letters: too many", f"The most are {LARGEST}.", "E541"
        )
    return message


def _integer(text: str) -> int:
    if len(text) > _MOST_DIGITS:
        raise ValueError(f"{cut(text)} is larger than any number")
    return int(text)


def _check_depth(value: Any) -> None:
    level = [value]
    for _ in range(_DEEPEST):
        level = [
            below
            for value in level
            if isinstance(value, dict | list)
            for below in (value.values() if isinstance(value, dict) else value)
            if isinstance(below, dict | list)
        ]
        if not level:
            return
    raise message_error(f"the message is nested more than {_DEEPEST} deep", "", "E541")


def text_of(message: Mapping[str, Any], key: str, default: str | None = None) -> str:
    """A text of a message. Raises DesignError E541 where there is none."""
    text = message.get(key, default)
    if not isinstance(text, str):
        raise message_error(f"{message.get('do')} needs the text {key}")
    return text


def values_of(message: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a `set`. Raises DesignError E541 where they are none."""
    values = message.get("values")
    if not isinstance(values, dict) or not values or len(values) > MOST_VALUES:
        raise message_error(
            'set needs values: {"values": {path: value}}', f"At most {MOST_VALUES} at once."
        )
    for path, value in values.items():
        if not isinstance(value, int | float | str | None) or isinstance(value, bool):
            raise message_error(f"the value of {cut(printable(path))} is no number, text or null")
    return values


def written(message: Mapping[str, Any]) -> str:
    """A message as it is sent; lone surrogates, which no socket takes, in their escapes."""
    text = json.dumps(
        message, separators=(",", ":"), ensure_ascii=False, allow_nan=False, default=json_of_numpy
    )
    try:
        text.encode()
    except UnicodeEncodeError:
        return json.dumps(message, separators=(",", ":"), allow_nan=False, default=json_of_numpy)
    return text


def json_of_numpy(value: Any) -> Any:
    """Return a value of NumPy as a JSON value. Raises TypeError for anything else."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no JSON")


def fault_of_bug(error: Exception) -> Fault:
    """E599 of what nobody foresaw, as the command line says it."""
    message = f"a bug of ours: {type(error).__name__}: {cut(printable(str(error)))}"
    return Fault("E599", message, "", "Please send us the design with this text.")
