"""Which kinds of design there are, in the order in which they are told.

A new kind is its file in `slopekit/kinds` with a line `KIND = ...`, and its name here; from outside it registers
itself (`slopekit.kinds.register`). Each is loaded when a design of it is asked for.
"""

from importlib import import_module
from typing import Any

from slopekit.design.common import Design

#: The kinds by name: the module that has `KIND`, or what one from outside says of itself.
KINDS: dict[str, Any] = {
    name: f"slopekit.kinds.{name}" for name in ("wedge", "plane", "footing", "surface", "topple", "bench", "blocks")
}


def kind_named(name: str) -> Any:
    """What a kind says of itself: `slopekit.kinds.protocol.Kind`. Raises KeyError for a name that is none."""
    entry = KINDS[name]
    return import_module(entry).KIND if isinstance(entry, str) else entry


def record_of(kind: str) -> type[Design]:
    """The dataclass of a kind of design."""
    record: type[Design] = kind_named(kind).record
    return record
