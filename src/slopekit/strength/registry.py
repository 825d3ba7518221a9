"""The strength laws by the names that design files write: the files of this folder. A new law is its file."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from slopekit.strength.mohr_coulomb import MohrCoulomb


def _laws() -> Iterator[Any]:
    """The laws every number of which is a key of design files: what changes another law is none of its own."""
    for module in iter_modules([str(Path(__file__).parent)]):
        if module.name == "registry":
            continue
        for one in vars(import_module(f"slopekit.strength.{module.name}")).values():
            is_own = isinstance(one, type) and one.__module__.endswith(f".{module.name}") and is_dataclass(one)
            if is_own and hasattr(one, "resistance") and all(part.metadata for part in fields(one)):
                yield one


def _by_name(laws: Iterable[Any]) -> Mapping[str, Any]:
    """The laws by their names; a copy of a file beside it (`power_old.py`) is refused, not taken in its place."""
    named: dict[str, Any] = {}
    for law in laws:
        first = named.setdefault(law.name, law)
        if first is not law:
            raise ValueError(f"the strength law {law.name} stands in {first.__module__} and in {law.__module__}")
    return named


LAWS: Mapping[str, Any] = _by_name((MohrCoulomb, *_laws()))
