"""Which kinds of design there are: the dataclass of each, and what reads it; loaded when a kind is asked for."""

from collections.abc import Callable
from importlib import import_module

from slopekit.design.common import Design
from slopekit.design.reader import Reader

Read = Callable[[Reader], Design]
#: Where the kinds are: module of the dataclass, its name, module of the reader; both themselves of a kind from outside.
KINDS: dict[str, tuple[str, str, str] | tuple[type[Design], Read]] = {
    "wedge": ("wedge", "WedgeDesign", "reading"), "plane": ("kinds", "PlaneDesign", "reading_kinds"),
    "footing": ("kinds", "FootingDesign", "reading_kinds"), "surface": ("kinds", "SurfaceDesign", "reading_kinds"),
    "topple": ("blocky", "ToppleDesign", "reading_blocky"), "bench": ("blocky", "BenchDesign", "reading_blocky"),
    "blocks": ("blocky", "BlocksDesign", "reading_blocks"),
}  # fmt: skip


def entry_of(kind: str) -> tuple[type[Design], Read]:
    """The dataclass of a kind and its reader."""
    entry = KINDS[kind]
    if len(entry) == 2:
        return entry
    module, name, reading = entry
    record: type[Design] = getattr(import_module(f"slopekit.design.{module}"), name)
    read: Read = getattr(import_module(f"slopekit.design.{reading}"), f"read_{kind}")
    return record, read


def record_of(kind: str) -> type[Design]:
    """The dataclass of a kind of design."""
    return entry_of(kind)[0]
