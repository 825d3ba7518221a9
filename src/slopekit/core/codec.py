"""Dataclasses as JSON values and back, by the types of their fields.

>>> @dataclass(frozen=True)
... class Bracket:
...     low: float
...     high: float = field(metadata={"json": "high_m"})
...     note: str = field(default="", metadata={"json": None})
>>> json_of(Bracket(1.0, math.inf)), from_json(Bracket, {"low": 1, "high_m": 2.0})
({'low': 1.0, 'high_m': None}, Bracket(low=1.0, high=2.0, note=''))
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, is_dataclass
from importlib import import_module
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")
#: Metadata of a field that JSON has not.
NO_JSON: Mapping[str, Any] = {"json": None}
_PLAIN = (str, bool, int, NoneType)
_JSON = (NoneType, str, int, float, list, tuple, dict)
_ARRAY_ATTRIBUTES = (
    "astype",
    "shape",
    "size",
    "ndim",
    "reshape",
    "tolist",
    "any",
    "all",
    "min",
    "max",
    "sum",
    "copy",
    "T",
)
#: What reading a document can raise where its values are not what they should be; see `is_of_document`.
MISREAD = (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError)


def digest(document: Any) -> str:
    """SHA-256 of a document of JSON values: equal ones give equal texts, whatever the order of their keys.

    >>> digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    True
    """
    import json

    text: str = _sha256()(json.dumps(document, sort_keys=True).encode()).hexdigest()
    return text


def _sha256() -> Any:
    """SHA-256 as Python has it built in (3.12 and later, 3.11): hashlib loads OpenSSL, 2 % of a cold wedge."""
    for module in ("_sha2", "_sha256", "hashlib"):
        with suppress(ImportError):
            return import_module(module).sha256
    raise ImportError("no SHA-256 in this Python")


def json_of(value: Any) -> Any:
    """Anything of slopekit as JSON values.

    A dataclass gives its fields by name, or by the name in their metadata (`json`; None: left out), and what its class
    lists in `JSON_ALSO`, properties. What has a `to_dict` of its own gives that. Numbers that are not finite are null.
    """
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, Mapping):
        return {str(name): json_of(item) for name, item in value.items()}
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if is_dataclass(value) and not isinstance(value, type):
        return record_of(value)
    if hasattr(value, "tolist"):  # NumPy's arrays and numbers
        return json_of(value.tolist())
    if isinstance(value, tuple | list | set | frozenset):
        return [json_of(item) for item in value]
    raise TypeError(f"{type(value).__name__} has no JSON")


def finite(text: str) -> float:
    """A number of JSON, for `parse_float` and `parse_constant`. Raises ValueError for one beyond floats, and for NaN.

    >>> finite("1.5e3")
    1500.0
    """
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no number of JSON")
    return value


def record_of(value: Any) -> dict[str, Any]:
    """The fields of a dataclass as JSON values, and what it lists besides."""
    record = {
        name: json_of(getattr(value, field_name)) for field_name, name in _json_names(type(value))
    }
    return record | {
        name: json_of(getattr(value, name)) for name in getattr(type(value), "JSON_ALSO", ())
    }


def _json_names(kind: Any) -> tuple[tuple[str, str], ...]:
    pairs = (
        (record_field.name, record_field.metadata.get("json", record_field.name))
        for record_field in fields(kind)
    )
    return tuple((record_field, name) for record_field, name in pairs if name is not None)


def from_json(kind: type[T], value: Mapping[str, Any]) -> T:
    """A dataclass of what `json_of` made of it; fields that are not there take their defaults.

    Raises
    ------
    KeyError, TypeError, ValueError
        Where the values are not those of such a dataclass.
    """
    hints = get_type_hints(kind)
    return kind(
        **{
            field_name: _value_from_json(hints[field_name], value[name])
            for field_name, name in _json_names(kind)
            if name in value
        }
    )


def _value_from_json(hint: Any, value: Any) -> Any:
    origin, inner = get_origin(hint), get_args(hint)
    if value is None:
        if hint is NoneType or NoneType in inner or hint is Any:
            return None
        raise TypeError(f"null where {hint} is needed")
    if origin in (Union, UnionType):
        return _value_from_json(next(kind for kind in inner if kind is not NoneType), value)
    if origin in (tuple, list):
        kinds = [inner[0]] * len(value) if origin is list or inner[-1] is ... else inner
        return origin(_value_from_json(kind, item) for kind, item in zip(kinds, value, strict=True))
    if origin is not None and issubclass(origin, Mapping):
        return {name: _value_from_json(inner[1], item) for name, item in value.items()}
    if is_dataclass(hint) and isinstance(hint, type):
        return from_json(hint, value)
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if isinstance(hint, type) and not isinstance(value, hint):
        raise TypeError(f"{value!r} where {hint.__name__} is needed")
    return value


def is_of_document(error: Exception) -> bool:
    """Whether values of a document that are missing or of another type can raise an error where they are read.

    An attribute is missing from a JSON value only where that should be another JSON value, or an array: all other
    attributes that are missing are faults of the program.

    >>> def raised(read):
    ...     try:
    ...         read()
    ...     except Exception as error:
    ...         return error
    >>> is_of_document(raised(lambda: {}["fos"])), is_of_document(raised(lambda: None.items()))
    (True, True)
    >>> is_of_document(raised(lambda: {}.itmes())), is_of_document(raised(lambda: math.pie))
    (False, False)
    """
    if isinstance(error, AttributeError):
        name = str(error.name)
        is_of_other = name in _ARRAY_ATTRIBUTES or any(
            hasattr(kind, name) for kind in (dict, list, str, float)
        )
        return isinstance(error.obj, _JSON) and is_of_other
    return isinstance(error, MISREAD)


__all__ = [
    "MISREAD",
    "NO_JSON",
    "dataclass",
    "field",
    "finite",
    "from_json",
    "is_of_document",
    "json_of",
    "record_of",
]
