"""`dataclass` for the house's frozen records: what dataclasses gives, made at a tenth of its cost.

A command loads some 120 records and makes a third of them. dataclasses compiles six functions for each frozen one with
slots (0.9 ms, Python 3.11): half of what a cold `slopekit wedge` took beyond the packages it imports. Here comparison,
text and the guard against writing are shared by all records, and ``__init__`` is compiled when many of a record are
made: that takes as long as filling thirty from their fields.
`dataclasses.fields`, ``replace``, ``asdict``, pickle, copy and `inspect.signature` work as they do there. There are no
slots: ``slots=True`` is taken and means nothing.
"""

from __future__ import annotations

import dataclasses
import reprlib
from typing import TYPE_CHECKING, Any

_FEW = 20  # records of a class that are made before its __init__ is compiled

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, *, frozen=False, eq=True, repr=True, kw_only=False, slots=False):
        """A class's record, as `dataclasses.dataclass` makes it; one that is not frozen is made there."""

        def record(cls):
            if not frozen:
                return dataclasses.dataclass(cls, eq=eq, repr=repr, kw_only=kw_only)
            if cls.__doc__ is None:  # dataclasses would write the signature, and compile __init__ for it
                cls.__doc__ = cls.__name__
            frozen_bases = [
                base.__dataclass_params__ for base in cls.__mro__[1:] if "__dataclass_params__" in vars(base)
            ]
            _say_frozen(frozen_bases, False)  # dataclasses would compile the guards that records share
            cls = dataclasses.dataclass(cls, init=False, eq=False, repr=False, kw_only=kw_only)
            _say_frozen([*frozen_bases, cls.__dataclass_params__], True)
            if "__init__" not in cls.__dict__:
                cls.__init__ = _first_init(cls)
                cls.__signature__ = _SIGNATURE
            if eq and "__eq__" not in cls.__dict__:
                cls.__eq__, cls.__hash__ = _equal, _hash
            if repr and "__repr__" not in cls.__dict__:
                cls.__repr__ = _text
            cls.__setattr__, cls.__delattr__ = _no_writing, _no_deleting
            return cls

        return record if cls is None else record(cls)


def _say_frozen(of: list[Any], frozen: bool) -> None:
    """What `dataclasses` reads of a class before another is derived from it."""
    for one in of:
        one.frozen = frozen


def names_of(record: type) -> tuple[str, ...]:
    """The names of a record's fields, in order."""
    return tuple(one.name for one in dataclasses.fields(record))


def _first_init(cls: type) -> Any:
    """An ``__init__`` for the first few records of ``cls``, that puts the compiled one in its place for the others."""
    plan, left = list[Any](), _FEW

    def __init__(self: Any, *args: Any, **named: Any) -> None:
        nonlocal plan, left
        if left == _FEW:  # put in its place whole: another thread may be at it
            plan = [(f.name, f.init, f.kw_only, f.default, f.default_factory) for f in dataclasses.fields(cls)]
        left -= 1
        if left < 0 or not _filled(self.__dict__, plan, args, named):
            _compiled(cls)(self, *args, **named)
        elif hasattr(cls, "__post_init__"):
            self.__post_init__()

    vars(__init__)["waits_for"] = cls
    return __init__


def _filled(values: dict[str, Any], plan: list[Any], args: tuple[Any, ...], named: dict[str, Any]) -> bool:
    """Write the values of a record by its fields; False where what is given does not fit: ``__init__`` says why."""
    missing, placed, by_name = dataclasses.MISSING, 0, 0
    for name, is_given, kw_only, default, factory in plan:
        if is_given and not kw_only and placed < len(args):
            values[name] = args[placed]
            placed += 1
        elif is_given and name in named:
            values[name] = named[name]
            by_name += 1
        elif factory is not missing:
            values[name] = factory()
        elif default is not missing:
            values[name] = default
        elif is_given:
            return False
    return placed == len(args) and by_name == len(named)


def _compiled(cls: Any) -> Any:
    """The ``__init__`` of a record, compiled and put in its place: one write to the instance's dictionary a field."""
    known: dict[str, Any] = {"_missing": dataclasses.MISSING, "_annotations": {}}
    plain, named, body = ["self"], list[str](), ["    d = self.__dict__"]
    for one in dataclasses.fields(cls):
        default = f"_default_{one.name}"
        made = one.default_factory is not dataclasses.MISSING
        given = made or one.default is not dataclasses.MISSING
        if given:
            known[default] = one.default_factory if made else one.default
        if one.init:
            written = f"{one.name}=_missing" if made else f"{one.name}={default}" if given else one.name
            (named if one.kw_only else plain).append(written)
            value = f"{default}() if {one.name} is _missing else {one.name}" if made else one.name
        elif given:
            value = f"{default}()" if made else default
        else:
            continue  # __post_init__ writes it
        body.append(f'    d["{one.name}"] = {value}')
    if hasattr(cls, "__post_init__"):
        body.append("    self.__post_init__()")
    parameters = ", ".join(plain + (["*", *named] if named else []))
    exec("\n".join([f"def __init__({parameters}):", *body]), known)
    init = known["__init__"]
    init.__qualname__ = f"{cls.__qualname__}.__init__"
    init.__annotations__ = {one.name: one.type for one in dataclasses.fields(cls) if one.init} | {"return": None}
    cls.__init__ = init
    return init


class _Signature:
    """``__signature__`` of a record: that of its compiled ``__init__``, asked for by `inspect.signature` and help()."""

    def __get__(self, instance: object, cls: Any) -> Any:
        import inspect

        init = cls.__init__
        whole = inspect.signature(_compiled(init.waits_for) if hasattr(init, "waits_for") else init)
        return whole.replace(parameters=list(whole.parameters.values())[1:])


_SIGNATURE = _Signature()


def _values(record: Any) -> tuple[Any, ...]:
    return tuple(getattr(record, one.name) for one in dataclasses.fields(record) if one.compare)


def _equal(self: Any, other: object) -> Any:
    return _values(self) == _values(other) if other.__class__ is self.__class__ else NotImplemented


def _hash(self: Any) -> int:
    return hash(_values(self))


@reprlib.recursive_repr()
def _text(self: Any) -> str:
    parts = (f"{one.name}={getattr(self, one.name)!r}" for one in dataclasses.fields(self) if one.repr)
    return f"{self.__class__.__qualname__}({', '.join(parts)})"


def _no_writing(self: object, name: str, value: object) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")


def _no_deleting(self: object, name: str) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
