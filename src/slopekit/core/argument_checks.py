"""Checks of the arguments of public functions, by their signatures, before the functions begin.

A parameter whose type is made of plain ones (numbers, texts, paths, mappings, classes) takes nothing else; one that is
`Any` is tested by the function. A number may be a text, "5%", where the option of the command reads it so. What no
function takes is refused of every parameter: bytes, complex numbers, a list with None in it, a number beyond floats.
"""

import inspect
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache, wraps
from numbers import Complex, Integral, Real
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin

from slopekit.core.errors import DesignError, Fault, Faults
from slopekit.core.options import DESIGN, Argument, Option, as_it_is, declared_option
from slopekit.core.synonyms import synonym

Function = TypeVar("Function", bound=Callable[..., Any])

_PLAIN = {
    str: "a text",
    float: "a number",
    int: "a whole number",
    bool: "True or False",
    os.PathLike: "a path",
    Mapping: "a mapping",
}
_BYTES = (bytes, bytearray, memoryview)
_MISSING = ("nan", "NaN", "None", "NaT", "<NA>")  # what an empty cell of a table is as a text
_MAX_BITS = 1023  # of a whole number that is still a float
_MAX_DEPTH = 2  # lists in lists, (dip, dip direction) of joints: what lies below is a design's, which is read by itself


@cache
def with_checked_arguments(function: Function) -> Function:
    """The function, which says what it takes where it is given something else.

    Raises
    ------
    DesignError
        E405 a value of another type, or values that do not fit the signature, E105 a number beyond floats.
    """

    @wraps(function)
    def call(*values: Any, **keywords: Any) -> Any:
        signature = inspect.signature(function)
        parameters, faults = signature.parameters, Faults()
        for name in set(keywords) - set(parameters):
            meant = synonym(name, parameters)
            if meant is not None and meant not in keywords:
                keywords[meant] = keywords.pop(name)
        try:
            arguments = signature.bind(*values, **keywords).arguments
        except TypeError as error:
            raise DesignError([_signature_fault(function.__name__, parameters, error)]) from None
        open_ended = any(
            parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in parameters.values()
        )
        for name, value in arguments.items():
            with faults.collecting():
                _refuse_impossible(function, name, value)
                # one that takes any name reads most values itself, and says all faults at once
                if not open_ended or _is_of_another_shape(parameters[name], value):
                    arguments[name] = _converted(function, parameters[name], value)
        faults.refuse()
        bound = inspect.BoundArguments(signature, arguments)
        return function(*bound.args, **bound.kwargs)

    return cast(Function, call)


def wrong_kind(
    function: str, name: str, takes: str, value: object, advice: str = ""
) -> DesignError:
    """E405: what a function takes, and what it was given.

    >>> print(wrong_kind("run", "source", "a path", 5))
    E405 run takes a path, not 5
         source=5
    """
    text = f"a {type(value).__name__}"
    with suppress(Exception):  # what cannot even be shown: a number of 5,000 digits
        text = "the module slopekit" if inspect.ismodule(value) else repr(value).partition("\n")[0]
    value_text = text if len(text) <= 40 else f"a {type(value).__name__}"
    location = f"{name}={text if len(text) <= 40 else '…'}"
    return DesignError(
        [Fault("E405", f"{function} takes {takes}, not {value_text}", location, advice)]
    )


def _signature_fault(
    function_name: str, parameters: Mapping[str, inspect.Parameter], error: TypeError
) -> Fault:
    """E405 with Python's own words of what does not fit a signature, and all that it takes."""
    needed = {
        name: parameter.default is inspect.Parameter.empty
        for name, parameter in parameters.items()
        if name != "desk"
    }
    takes = [name if is_needed else f"{name}=" for name, is_needed in needed.items()]
    return Fault("E405", f"{function_name}: {error}", "", f"It takes {', '.join(takes)}.")


def _refuse_impossible(function: Callable[..., Any], name: str, value: Any, depth: int = 0) -> None:
    """Refuse a value, or a part of it, that no parameter takes.

    Raises
    ------
    DesignError
        E405 bytes, a complex number, None in a list; E105 a whole number that is no float.
    """
    function_name = function.__name__
    if isinstance(value, int) and value.bit_length() > _MAX_BITS:
        message = f"{name} is a whole number of {value.bit_length()} bits, beyond the largest float"
        raise DesignError([Fault("E105", message, f"{name}=")])
    is_complex = isinstance(value, Complex) and not isinstance(value, Real)
    if (
        isinstance(value, _BYTES)
        or is_complex
        or getattr(getattr(value, "dtype", None), "kind", "") in ("S", "c")
    ):
        raise wrong_kind(function_name, name, f"numbers and texts for {name}", value)
    if isinstance(value, list | tuple):
        if depth == 0 and any(element is None for element in value):
            raise wrong_kind(function_name, name, f"a value in each place of {name}", value)
    elif not isinstance(value, Mapping):
        return
    if depth < _MAX_DEPTH:
        for below in value.values() if isinstance(value, Mapping) else value:
            _refuse_impossible(function, name, below, depth + 1)


def _kinds_of(parameter: inspect.Parameter) -> list[Any]:
    """The types that a parameter takes; a word of a few is a text, whose spelling the function tests."""
    type_ = parameter.annotation
    if get_origin(type_) is Annotated:
        type_ = get_args(type_)[0]
    arms = get_args(type_) if get_origin(type_) in (Union, UnionType) else (type_,)
    return [str if get_origin(arm) is Literal else get_origin(arm) or arm for arm in arms]


def _is_of_another_shape(parameter: inspect.Parameter, value: Any) -> bool:
    """Whether it is a list, mapping or array for a single number or text, or no workplace at all."""
    kinds = {kind for kind in _kinds_of(parameter) if kind is not type(None)}
    if not kinds or not all(isinstance(kind, type) for kind in kinds):
        return False
    return (
        not kinds <= {str, int, float, bool}
        or isinstance(value, list | tuple | Mapping)
        or hasattr(value, "tolist")
    )


def _is_path(value: Any) -> bool:
    """Whether a system could have a file of that name, and the name is not the text of a missing value."""
    try:
        return b"\0" not in os.fsencode(value) and os.fspath(value) not in _MISSING
    except (TypeError, ValueError):
        return False


def _converted(function: Callable[..., Any], parameter: inspect.Parameter, value: Any) -> Any:
    """The value where it is of the type of the parameter, as its option reads it where it is a text."""
    declaration, kinds = declared_option(parameter), _kinds_of(parameter)
    if Any in kinds or not all(isinstance(kind, type) for kind in kinds):
        return value
    if type(None) in kinds and value is None:
        return value
    if declaration == DESIGN and isinstance(value, str | os.PathLike | Mapping):
        return value  # the function reads it
    for kind in kinds:
        if kind in (int, float):
            if isinstance(value, bool) or not isinstance(value, Real):
                continue
            if isinstance(value, Integral):
                return int(value)  # of NumPy's a Python number
            if kind is float or value == value // 1:
                return kind(float(value))
        elif os.PathLike in kinds and isinstance(value, str | os.PathLike) and not _is_path(value):
            break
        elif isinstance(value, Mapping) and not all(isinstance(key, str) for key in value):
            raise wrong_kind(
                function.__name__, parameter.name, f"texts for the keys of {parameter.name}", value
            )
        elif isinstance(value, kind) or (
            kind is bool and type(value).__name__.startswith("bool")
        ):  # NumPy's own
            return value
    if (
        isinstance(value, str)
        and isinstance(declaration, Option)
        and declaration.reads is not as_it_is
    ):
        return declaration.reads(value, parameter.name)
    kind_words = [
        _PLAIN.get(kind, f"a {kind.__name__.lower()}") for kind in kinds if kind is not type(None)
    ]
    takes = (
        f"{', '.join(kind_words[:-1])} or {kind_words[-1]}"
        if len(kind_words) > 1
        else kind_words[0]
    )
    takes = (
        isinstance(declaration, Argument) and declaration.takes
    ) or f"{takes} for {parameter.name}"
    raise wrong_kind(function.__name__, parameter.name, takes, value)
