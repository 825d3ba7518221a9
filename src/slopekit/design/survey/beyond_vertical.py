"""Dips beyond 90° in a list: planes that are overturned, or the dip directions of swapped columns.

A row such as 95, 30 may be either. What decides is the whole list: a column of dip directions that never exceeds 90°
beside dips that do is one of dips. An overturned plane is read where its direction can be no dip: it exceeds 90°, or
it is written as directions are, 030, in a list that writes its dips otherwise and swaps none of them.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from slopekit.core.errors import Fault
from slopekit.core.orientation import is_written_as_bearing
from slopekit.design.survey.columns import WORDS, columns_advice, number_in

SHARE_OF_BAD_ROWS = 0.1  # up to which bad rows are faults of their own, and can be skipped
#: How two columns are exchanged, by the way that they give planes.
_EXCHANGED = {
    ("dip", "dip_direction"): ("dip_direction", "dip"),
    ("strike", "dip"): ("dip", "strike"),
    ("trend", "plunge"): ("plunge", "trend"),
    ("plane",): ("clar",),
    ("clar",): ("plane",),
}


@dataclass(frozen=True)
class BeyondVertical:
    """What the dips and azimuths of all rows say of dips beyond 90°.

    Attributes
    ----------
    rows : with two numbers; swapped : of them with a dip beyond 90° and an azimuth up to 90° as a number
    dips_beyond, azimuths_beyond : rows with a dip, and with an azimuth, beyond 90°
    beyond_half_turn : rows with a dip beyond 180° and an azimuth that can be a dip
    bearings_count : whether 030 is a direction in this list by its notation
    """

    rows: int = 0
    swapped: int = 0
    dips_beyond: int = 0
    azimuths_beyond: int = 0
    beyond_half_turn: int = 0
    bearings_count: bool = False

    def is_overturned(self, dip_deg: float, azimuth: str) -> bool:
        """Whether a row is an overturned plane for certain."""
        azimuth_deg = number_in(azimuth)
        if not 90.0 < dip_deg <= 180.0 or azimuth_deg is None or not 0.0 <= azimuth_deg <= 360.0:
            return False
        return azimuth_deg > 90.0 or (self.bearings_count and is_written_as_bearing(azimuth))

    @property
    def columns_are_swapped(self) -> bool:
        """Whether so many rows fit only with dip and azimuth exchanged that their columns are."""
        tenth = SHARE_OF_BAD_ROWS * self.rows
        return self.swapped > tenth and self.swapped > 1 and self.azimuths_beyond <= tenth

    @property
    def order_is_sure(self) -> bool:
        """Whether azimuths that can be no dip say which column is which, and no row contradicts them."""
        return self.azimuths_beyond > 0 and not self.beyond_half_turn and not self.columns_are_swapped

    @property
    def fits_both_orders(self) -> bool:
        """Whether every number of either column could be a dip."""
        return self.rows > 0 and not self.dips_beyond and not self.azimuths_beyond


def beyond_vertical(pairs: Iterable[tuple[str, str]]) -> BeyondVertical:
    """What the texts of dips and azimuths say together.

    >>> swapped = beyond_vertical([("196", "76"), ("178", "68"), ("62", "53")])
    >>> swapped.columns_are_swapped, swapped.is_overturned(178.0, "68")
    (True, False)
    >>> overturned = beyond_vertical([("95", "030"), ("110", "028"), ("85", "205")])
    >>> overturned.columns_are_swapped, overturned.is_overturned(95.0, "030")
    (False, True)
    """
    rows = [
        (dip, azimuth, dip_deg, azimuth_deg)
        for dip, azimuth in pairs
        if (dip_deg := number_in(dip)) is not None and (azimuth_deg := number_in(azimuth)) is not None
    ]
    suspects = [row for row in rows if row[2] > 90.0 and row[3] <= 90.0]
    beyond_half_turn = sum(row[2] > 180.0 for row in suspects)
    bearings_count = (
        len(suspects) < len(rows) and not beyond_half_turn and not any(is_written_as_bearing(row[0]) for row in rows)
    )
    swapped = [row for row in suspects if not (bearings_count and is_written_as_bearing(row[1]))]
    dips_beyond = sum(row[2] > 90.0 for row in rows)
    azimuths_beyond = sum(row[3] > 90.0 for row in rows)
    return BeyondVertical(len(rows), len(swapped), dips_beyond, azimuths_beyond, beyond_half_turn, bearings_count)


def swapped_columns(
    name: str, where: str, headings: Sequence[str], way: Sequence[str], beyond: BeyondVertical, option: str
) -> Fault:
    """The fault of a list whose dips and azimuths stand in each other's columns.

    Parameters
    ----------
    headings : of the columns in their order in the list, all of them; way : those that give the plane
    """
    azimuth = "dip directions" if way[0] in ("dip", "plane", "clar") else f"{way[0]}s"
    column = "plunge" if way[0] == "trend" else "dip"
    at = f"the column {column}" if len(way) > 1 else f"front in the column {WORDS[way[0]]}"
    if way[0] in ("clar", "strike/dip"):
        at = f"the place of dips in the column {WORDS[way[0]]}"
    message = f"{azimuth} over 90 stand in {at}: columns swapped? ({beyond.swapped} of {beyond.rows} rows of {name})"
    exchange = dict(zip(way, _EXCHANGED.get(tuple(way), tuple(way)), strict=True))
    advice = f"If so: {columns_advice(option, [exchange.get(heading, heading) for heading in headings])}."
    return Fault("E103", message, where, advice)
