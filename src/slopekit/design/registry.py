"""The registry of the kinds of design, in the order in which they are listed.

A new kind is a file in `slopekit/kinds` with a line `KIND = ...`, and its name here; a kind of another package
registers itself (`slopekit.kinds.register`). A kind is imported when one of its designs is needed.
"""

from importlib import import_module
from typing import Any

from slopekit.design.common import Design

#: The kinds by name: the module that has `KIND`, or the `KIND` of a kind from another package.
KINDS: dict[str, Any] = {
    name: f"slopekit.kinds.{name}"
    for name in ("wedge", "plane", "footing", "surface", "topple", "bench", "blocks")
}


def kind_named(name: str) -> Any:
    """Return the description of a kind (`slopekit.kinds.protocol.Kind`). Raises KeyError for an unknown name."""
    entry = KINDS[name]
    return import_module(entry).KIND if isinstance(entry, str) else entry


def record_of(kind: str) -> type[Design]:
    """Return the dataclass of the designs of a kind."""
    record: type[Design] = kind_named(kind).record
    return record
