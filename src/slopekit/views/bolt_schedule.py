"""The bolts of a design in order, to be set out and drilled: number, place, length, direction, force; table and CSV."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from slopekit.kinds.words import first_and_last

#: The file that `run -o` writes, and its first line.
FILE = "bolts.csv"
COLUMNS = ("number", "east_m", "north_m", "z_m", "length_m", "trend_deg", "plunge_deg", "force_kn", "slice_m", "acts",
           "block")  # fmt: skip
HEAD = ("no.", "E / m", "N / m", "Z / m", "length / m", "trend/plunge", "kN", "acts")
_FIRST, _LAST = 5, 2  # rows of the sheet


@dataclass(frozen=True, slots=True)
class ScheduledBolt:
    """One bolt: `number` as the design lists it, from 1; None where a head or a length is not given; m, degrees, kN.

    `slice_m` is the length of slope that its force stands for in a section, None in space.
    """

    number: int
    head_m: tuple[float, float, float] | None
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
        return f"{_trend(self.trend_deg):05.1f}/{_plain(self.plunge_deg, 1)}"

    def cells(self) -> tuple[str, ...]:
        """As a row of `HEAD`: metres to the millimetre."""
        place = tuple(millimetre(part) for part in self.head_m) if self.head_m else ("-", "-", "-")
        length = "-" if self.length_m is None else millimetre(self.length_m)
        return (str(self.number), *place, length, self.toward, _plain(self.force_kn, 1), self.acts)


def schedule(document: Mapping[str, Any]) -> list[ScheduledBolt]:
    """The bolts of a result's document, in the order of its design."""
    found = []
    thickness = (document.get("geometry") or {}).get("thickness_m")
    for number, bolt in enumerate((document.get("inputs") or {}).get("bolts") or [], 1):
        head, toward = bolt["head_m"], bolt["toward"]
        place = None if head is None else (float(head[0]), float(head[1]), float(head[2]))
        bolted = ScheduledBolt(number, place, bolt["length_m"], toward["trend_deg"], toward["plunge_deg"],
                               bolt["force_kn"], bolt["acts"], bolt["block"] or "", thickness)  # fmt: skip
        found.append(bolted)
    return found


def schedule_csv(bolts: Sequence[ScheduledBolt]) -> str:
    """The schedule as CSV: metres to the millimetre, degrees to a hundredth, kN to a thousandth; empty: not given."""
    import csv
    import io

    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for one in bolts:
        place = [millimetre(part) for part in one.head_m] if one.head_m else ["", "", ""]
        length = "" if one.length_m is None else millimetre(one.length_m)
        trend, plunge = _plain(one.trend_deg % 360.0, 2), _plain(one.plunge_deg, 2)
        force = [_plain(one.force_kn, 3), slice_of_slope(one)]
        rows.writerow([one.number, *place, length, trend, plunge, *force, one.acts, one.block])
    return text.getvalue()


def schedule_lines(bolts: Sequence[ScheduledBolt]) -> list[str]:
    """The schedule as the sheet prints it: the first and the last where they are many; empty without a head."""
    if not any(one.head_m for one in bolts):
        return []
    first, between, last = first_and_last([one.cells() for one in bolts], _FIRST, _LAST)
    wide = [max(len(row[k]) for row in (HEAD, *first, *last)) for k in range(len(HEAD))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, wide, strict=True)) for row in (HEAD, *first)]
    if between:
        lines.append(f"... {between} more, all of them in {FILE} (-o DIR)")
    lines += ["  ".join(cell.rjust(width) for cell, width in zip(row, wide, strict=True)) for row in last]
    return [*lines, *(said for said in (per_slice(bolts), without_head(bolts)) if said)]


def slice_of_slope(bolt: ScheduledBolt) -> str:
    """The length of slope that a force stands for; "" where it is that of one bolt."""
    return "" if bolt.slice_m is None else f"{bolt.slice_m:g}"


def per_slice(bolts: Sequence[ScheduledBolt]) -> str:
    """What forces in a section are, in words; "" in space."""
    slices = dict.fromkeys(filter(None, map(slice_of_slope, bolts)))
    return f"a section: forces are those on {next(iter(slices))} m of slope" if slices else ""


def without_head(bolts: Sequence[ScheduledBolt]) -> str:
    """Which bolts are not drawn, in words; "" where all are."""
    bare = [one.number for one in bolts if one.head_m is None]
    if not bare:
        return ""
    shown, rest, _ = first_and_last([str(number) for number in bare], 6, 0)
    names = ", ".join(shown) + (f" and {rest} more" if rest else "")
    if len(bare) == 1:
        return f"bolt {names} has no head and is not drawn: a force through the centroid"
    return f"bolts {names} have no head and are not drawn: forces through the centroid"


def forces_in_words(values: Sequence[float], each: bool = True) -> str:
    """Forces in kN as one number or a range.

    >>> forces_in_words([96.25, 96.25]), forces_in_words([50.0, 200.0]), forces_in_words([300.0])
    ('96.25 kN each', '50 to 200 kN', '300 kN')
    """
    low, high = f"{min(values):.4g}", f"{max(values):.4g}"
    if low == high:
        return f"{low} kN each" if len(values) > 1 and each else f"{low} kN"
    return f"{low} to {high} kN"


def millimetre(value: float) -> str:
    """A length or coordinate in m, fixed to the millimetre.

    >>> millimetre(4000123.4567), millimetre(-0.0001)
    ('4000123.457', '0.000')
    """
    return _plain(value, 3)


def _plain(value: float, digits: int) -> str:
    """Fixed digits, no minus before zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def _trend(trend: float) -> float:
    return round(trend % 360.0, 1) % 360.0
