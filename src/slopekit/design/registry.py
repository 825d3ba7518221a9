"""Which kinds of design there are: the files of `slopekit/kinds` with a line `KIND = ...`. A new kind is its file.

Each is loaded when a design of it is asked for; to know that it is there takes a look at its text.
"""

import os
from collections.abc import Iterator, MutableMapping
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from slopekit.design.common import Design

_FOLDER = Path(__file__).parents[1] / "kinds"
#: The order in which the first are told; the others follow by their names.
_TOLD_FIRST = ("wedge", "plane", "footing", "surface", "topple", "bench", "blocks")


class _Kinds(MutableMapping[str, Any]):
    """The kinds by name: the module that has `KIND`, or itself for one from outside (`slopekit.kinds.register`)."""

    def __init__(self) -> None:
        self._from_outside: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name in self._from_outside:
            return self._from_outside[name]
        if _is_shipped(name):
            return f"slopekit.kinds.{name}"
        raise KeyError(name)

    def __setitem__(self, name: str, kind: Any) -> None:
        self._from_outside[name] = kind

    def __delitem__(self, name: str) -> None:
        del self._from_outside[name]

    def __iter__(self) -> Iterator[str]:
        shipped = {name for name in _files() or _of_byte_code() if _is_shipped(name)}
        yield from sorted(shipped, key=_place)
        yield from (name for name in self._from_outside if name not in shipped)

    def __len__(self) -> int:
        return sum(1 for _ in self)


@cache
def _files() -> dict[str, Path]:
    """Where the modules of the folder stand, by their names; none in a zip, or of byte code alone."""
    names = os.listdir(_FOLDER) if _FOLDER.is_dir() else []
    if not any(name.endswith(".py") for name in names):
        return {}
    folders = {name: _FOLDER / name / "__init__.py" for name in names if "." not in name}
    files = {name.removesuffix(".py"): _FOLDER / name for name in names if name.endswith(".py")}
    return {name: path for name, path in (folders | files).items() if name.isidentifier()}  # none of an editor's own


@cache
def _is_shipped(name: str) -> bool:
    if not _files():
        return name in _of_byte_code()
    path = _files().get(name)
    return path is not None and path.is_file() and b"\nKIND = " in path.read_bytes()


@cache
def _of_byte_code() -> frozenset[str]:
    """The kinds of a package without files of text, by what the code of its modules binds: none of them is loaded."""
    from dis import get_instructions
    from pkgutil import iter_modules

    found = set[str]()
    for module in iter_modules([str(_FOLDER)]):
        spec: Any = module.module_finder.find_spec(f"slopekit.kinds.{module.name}", None)
        code = spec.loader.get_code(spec.name)
        if any(step.opname == "STORE_NAME" and step.argval == "KIND" for step in get_instructions(code)):
            found.add(module.name)
    return frozenset(found)


def _place(name: str) -> tuple[int, str]:
    return (_TOLD_FIRST.index(name) if name in _TOLD_FIRST else len(_TOLD_FIRST)), name


#: The kinds that ship, and those from outside that were registered.
KINDS = _Kinds()


def kind_named(name: str) -> Any:
    """What a kind says of itself: `slopekit.kinds.protocol.Kind`. Raises KeyError for a name that is none."""
    entry = KINDS[name]
    return import_module(entry).KIND if isinstance(entry, str) else entry


def record_of(kind: str) -> type[Design]:
    """The dataclass of a kind of design."""
    record: type[Design] = kind_named(kind).record
    return record
