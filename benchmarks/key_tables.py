"""The key reference of design files, from the declared fields: what docs/design-files.md prints, held by a test."""

from collections.abc import Iterator
from math import isfinite
from typing import Any

from slopekit.core.orientation import Line, Plane, number
from slopekit.design.common import Design
from slopekit.design.fields import UNITS, Field, every_field

_NAMES = {"*": "NAME"}
_HEAD = "| key | unit | left out | takes |\n|---|---|---|---|\n"


def key_table(record: Any, beside: Any = None) -> str:
    """A Markdown table of the keys of a design: one row each.

    Parameters
    ----------
    beside : a record whose keys are told elsewhere: the same rows are left out
    """
    told = set(_rows(beside)) if beside is not None else set()
    return _HEAD + "".join(f"{row}\n" for row in dict.fromkeys(_rows(record)) if row not in told)


def tables() -> dict[str, str]:
    """The tables of the reference by their names: what every kind has, then each kind."""
    from slopekit.design.registry import KINDS, record_of

    return {"every kind": key_table(Design)} | {
        kind: key_table(record_of(kind), Design) for kind in KINDS
    }


def _rows(record: Any) -> Iterator[str]:
    defaults = getattr(record, "DEFAULTS", {})
    for field in every_field(record):
        is_angle = field.turns and field.key in ("dip", "dip_direction", "plunge", "trend")
        if is_angle or field.is_refused or field.path.endswith("*"):
            continue
        path = ".".join(_NAMES.get(part, part) for part in field.path.split("."))
        yield f"| `{path}` | {_unit(field)} | {_left_out(field, defaults)} | {_takes(field)} |"


def _unit(field: Field) -> str:
    if field.is_number:
        units = [field.unit, *(UNITS[other] for other in field.or_measures)]
        return ", or ".join(unit or "part" for unit in units) if field.or_measures else field.unit
    return field.measures if field.measures in ("plane", "line", "point") else ""


def _left_out(field: Field, defaults: Any) -> str:
    if field.left_out:
        return field.left_out
    of_kind = field.path.count(".") == 1 or field.path in (
        "strength.*.c",
        "strength.*.phi",
    )  # else a namesake
    value = defaults.get(field.key, field.default) if of_kind else field.default
    if field.is_required or (field.may_lack and value is None):
        return "required"
    if value in (None, "", ()) or field.record_type is not None:
        return "none"
    if isinstance(value, float | int) and not isinstance(value, bool):
        return _limit(value)
    if isinstance(value, tuple):
        return f"[{', '.join(number(part) for part in value)}]"
    return str(value).lower() if isinstance(value, Plane | Line | bool | str) else "none"


def _takes(field: Field) -> str:
    parts = []
    if field.is_number and (field.least > -1e300 or field.most < 1e300):
        parts.append(_range(field))
    if field.words:
        parts.append(", ".join(f"`{word}`" for word in field.words))
    if field.doc:
        parts.append(field.doc)
    if field.example and not field.is_number and not field.words:
        parts.append(f"`{field.example}`")
    return "; ".join(parts)


def _limit(value: float) -> str:
    """A number as a design may have it: 1e7 and 1e-6, not 10000000 and 1e-06."""
    short, e, exponent = f"{value:g}".partition("e")
    return f"{short}e{int(exponent)}" if e and float(f"{value:g}") == value else number(value)


def _range(field: Field) -> str:
    if field.is_integer:
        return f"{'odd' if field.is_odd else 'whole'}, {_limit(field.least)} to {int(field.most)}"
    low, high = (_limit(one) if isfinite(one) else "" for one in (field.least, field.most))
    if field.most > 1e300:
        return f"{'above' if field.above else 'from'} {low}"
    return f"{'above ' if field.above else ''}{low} to {'below ' if field.below else ''}{high}"
