"""The bolts of a design in order, to be set out and drilled: number, place, length, direction, force; table and CSV."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from typing import Any

from slopekit.core.orientation import millimetre
from slopekit.core.sheet import Column, Entry, Table
from slopekit.kinds.words import first_and_last

#: The file that `run -o` writes.
FILE = "bolts.csv"
_FIRST, _LAST = 5, 2  # rows of the sheet


@dataclass(frozen=True)
class ScheduledBolt:
    """One bolt: `number` as the design lists it, from 1; None where a head or a length is not given; m, degrees, kN.

    `slice_m` is the length of slope that its force stands for in a section, None in space.
    """

    number: int
    head_m: tuple[float, ...] | None
    length_m: float | None
    trend_deg: float
    plunge_deg: float
    force_kn: float
    acts: str
    block: str
    slice_m: float | None = None

    @property
    def toward(self) -> str:
        """Trend and plunge."""
        return f"{round(self.trend_deg % 360.0, 1) % 360.0:05.1f}/{_one_decimal(self.plunge_deg)}"


def schedule(document: Mapping[str, Any]) -> list[ScheduledBolt]:
    """The bolts of a result's document, in the order of its design."""
    thickness = (document.get("geometry") or {}).get("thickness_m")
    return [
        ScheduledBolt(
            number,
            None if bolt["head_m"] is None else tuple(map(float, bolt["head_m"])),
            bolt["length_m"],
            bolt["toward"]["trend_deg"],
            bolt["toward"]["plunge_deg"],
            bolt["force_kn"],
            bolt["acts"],
            bolt["block"] or "",
            thickness,
        )
        for number, bolt in enumerate((document.get("inputs") or {}).get("bolts") or [], 1)
    ]


def schedule_table(bolts: Sequence[ScheduledBolt]) -> Table[ScheduledBolt]:
    """The schedule: metres to the millimetre; CSV has degrees to a hundredth, kN to a thousandth; empty: not given."""
    columns: list[Column[ScheduledBolt]] = [
        Column("no.", attrgetter("number"), "number", width=1),
        *(
            Column(
                f"{letter} / m", partial(_coordinate, k=k), key, "m", _millimetre_or_dash, 1, ".3f"
            )
            for k, (letter, key) in enumerate((("E", "east_m"), ("N", "north_m"), ("Z", "z_m")))
        ),
        Column(
            "length / m", attrgetter("length_m"), "length_m", "m", _millimetre_or_dash, 1, ".3f"
        ),
        Column(
            "",
            lambda column: round(column.trend_deg % 360.0, 2) % 360.0,
            "trend_deg",
            "°",
            exact=".2f",
        ),
        Column(
            "", lambda column: round(column.plunge_deg, 2) + 0.0, "plunge_deg", "°", exact=".2f"
        ),
        Column("trend/plunge", attrgetter("toward"), width=1),
        Column("kN", attrgetter("force_kn"), "force_kn", "kN", _one_decimal, 1, ".3f"),
        Column("", attrgetter("slice_m"), "slice_m", "m", exact="g"),
        Column("acts", attrgetter("acts"), "acts", width=1),
        Column("block", attrgetter("block"), "block", width=int(any(bolt.block for bolt in bolts))),
    ]
    table = Table(columns, bolts, ends=(_FIRST, _LAST))
    hidden = table.left_out
    listed_bolts = [*bolts[:_FIRST], *bolts[-_LAST:]] if hidden else bolts
    widths = [
        max(map(len, (column.title, *map(column.shown, listed_bolts)))) + 2 * (k > 0)
        if column.width
        else 0
        for k, column in enumerate(columns)
    ]
    columns = [replace(column, width=width) for column, width in zip(columns, widths, strict=True)]
    return replace(
        table, columns=columns, rest=f"... {len(hidden)} more, all of them in {FILE} (-o DIR)"
    )


def _coordinate(bolt: ScheduledBolt, k: int) -> float | None:
    """A coordinate of its head to the millimetre."""
    return None if bolt.head_m is None else round(bolt.head_m[k], 3) + 0.0


def _millimetre_or_dash(value: float | None) -> str:
    return "-" if value is None else millimetre(value)


def schedule_entries(bolts: Sequence[ScheduledBolt]) -> list[Entry]:
    """Return the entries of the bolts: schedule and remarks; empty without bolt heads."""
    if not any(bolt.head_m for bolt in bolts):
        return []
    return [
        schedule_table(bolts),
        *(text for text in (per_slice(bolts), without_head(bolts)) if text),
    ]


def per_slice(bolts: Sequence[ScheduledBolt]) -> str:
    """Return the words that say to what width of a section forces belong; "" in space."""
    slices = [bolt.slice_m for bolt in bolts if bolt.slice_m is not None]
    return f"a section: forces are those on {slices[0]:g} m of slope" if slices else ""


def without_head(bolts: Sequence[ScheduledBolt]) -> str:
    """Which bolts are not drawn, in words; "" where all are."""
    headless = [bolt.number for bolt in bolts if bolt.head_m is None]
    if not headless:
        return ""
    first, rest, _ = first_and_last([str(number) for number in headless], 6, 0)
    names = ", ".join(first) + (f" and {rest} more" if rest else "")
    if len(headless) == 1:
        return f"bolt {names} has no head and is not drawn: a force through the centroid"
    return f"bolts {names} have no head and are not drawn: forces through the centroid"


def forces_in_words(values: Sequence[float]) -> str:
    """Forces in kN as one number or a range.

    >>> forces_in_words([96.25, 96.25]), forces_in_words([50.0, 200.0]), forces_in_words([300.0])
    ('96.25 kN each', '50 to 200 kN', '300 kN')
    """
    low, high = f"{min(values):.4g}", f"{max(values):.4g}"
    if low == high:
        return f"{low} kN each" if len(values) > 1 else f"{low} kN"
    return f"{low} to {high} kN"


def _one_decimal(value: float) -> str:
    """One digit, no minus before zero."""
    return f"{round(value, 1) + 0.0:.1f}"
