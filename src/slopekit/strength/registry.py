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
        for law in vars(import_module(f"slopekit.strength.{module.name}")).values():
            is_own = (
                isinstance(law, type)
                and law.__module__.endswith(f".{module.name}")
                and is_dataclass(law)
            )
            if (
                is_own
                and hasattr(law, "resistance")
                and all(parameter.metadata for parameter in fields(law))
            ):
                yield law


def _by_name(laws: Iterable[Any]) -> Mapping[str, Any]:
    """The laws by their names; a copy of a file beside it (`power_old.py`) is refused, not taken in its place."""
    by_name: dict[str, Any] = {}
    for law in laws:
        first = by_name.setdefault(law.name, law)
        if first is not law:
            raise ValueError(
                f"the strength law {law.name} stands in {first.__module__} and in {law.__module__}"
            )
    return by_name


LAWS: Mapping[str, Any] = _by_name((MohrCoulomb, *_laws()))
