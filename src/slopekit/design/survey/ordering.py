"""The order of columns that have no header, or the wrong one: named by the user, doubted by their numbers."""

import re
from collections.abc import Sequence

from slopekit.core.errors import DesignError, Fault
from slopekit.design.survey.beyond_vertical import BeyondVertical
from slopekit.design.survey.columns import WORDS

#: How two columns are exchanged, by the way that they give planes.
_EXCHANGED = {
    ("dip", "dip_direction"): ("dip_direction", "dip"),
    ("strike", "dip"): ("dip", "strike"),
    ("trend", "plunge"): ("plunge", "trend"),
    ("plane",): ("clar",),
    ("clar",): ("plane",),
}


def named_in_order(columns: str | Sequence[str] | None) -> tuple[str, ...]:
    """The names of columns as the user lists them, () where none are: `dip_direction,dip`, or a list.

    >>> named_in_order("dip_direction, dip"), named_in_order(["dip", "dip direction"]), named_in_order(None)
    (('dip_direction', 'dip'), ('dip', 'dip direction'), ())
    """
    if columns is None:
        return ()
    parts = re.split("[,;]", columns) if isinstance(columns, str) else columns
    if not isinstance(parts, Sequence) or not all(isinstance(part, str) for part in parts):
        message = f"columns are {type(columns).__name__}, their names in order are needed"
        raise DesignError([Fault("E191", message, "columns", 'Give "dip_direction,dip".')])
    return tuple(part.strip() for part in parts)


def columns_advice(option: str, columns: Sequence[str]) -> str:
    """How the user names columns, by what a convention is given by: an option, a key, an argument, nothing.

    >>> columns_advice("--convention", ["dip", "dip_direction"]), columns_advice("convention:", ["clar"])
    ('--columns dip,dip_direction', 'columns: [clar]')
    """
    if not option:
        return f"name its columns {','.join(columns)}"
    if option.startswith("--"):
        return f"--columns {','.join(columns)}"
    if option.endswith(":"):
        return f"columns: [{', '.join(columns)}]"
    return f'columns = "{",".join(columns)}"'


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
