"""What stands above the header of a list, as Dips writes it: orientation format, declination, quantities, traverses.

Declination is added to every azimuth (Rocscience, Dips documentation, Declination: east positive).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from slopekit.design.survey.columns import LEFT, RIGHT

_DIP = r"\bDIP\s*/\s*DIP\s*-?\s*DIR(?:ECTION|N)?\b"
#: Formats of the two orientation columns: how they are written, the columns, the convention of the strike.
FORMATS: tuple[tuple[str, tuple[str, ...], str | None], ...] = (
    (_DIP, ("dip", "dip_direction"), None),
    (r"\bSTRIKE\s*(?:\(?\s*RIGHT\s*\)?)\s*/\s*DIP\b|\bSTRIKE\s*/\s*DIPR\b", ("strike", "dip"), RIGHT),
    (r"\bSTRIKE\s*(?:\(?\s*LEFT\s*\)?)\s*/\s*DIP\b|\bSTRIKE\s*/\s*DIPL\b", ("strike", "dip"), LEFT),
    (r"\bSTRIKE\s*/\s*DIP\b", ("strike", "dip"), None),
    (r"\bTREND\s*/\s*PLUNGE\b", ("trend", "plunge"), None),
)
_NUMBER = r"([+-]?\d+(?:[.,]\d+)?)"
_DECLINATION = re.compile(rf"DECLINATION\b[^\d+\-]*{_NUMBER}|^\s*{_NUMBER}\s*\(?\s*DECLINATION", re.IGNORECASE)
_TRAVERSES = re.compile(r"TRAVERSES\b[^\d]*(\d+)|^\s*(\d+)\s*\(?\s*TRAVERSES", re.IGNORECASE)
_QUANTITY = re.compile(r"\bQUANTIT", re.IGNORECASE)
_NO = re.compile(r"\bNO\b|\bNONE\b|\bOFF\b|\b0\b", re.IGNORECASE)
_CORE = re.compile(r"\bORIENTED\s+CORE\b|\bALPHA\s*/\s*BETA\b", re.IGNORECASE)


@dataclass(frozen=True)
class Preamble:
    """What a preamble says.

    Attributes
    ----------
    columns, convention, written : of the orientation format, and how it is written; () where none is named
    others : further formats, of traverses; core : measured on oriented core
    declination_deg : added to azimuths; has_quantity : a third column of quantities; traverses : how many
    """

    columns: tuple[str, ...] = ()
    convention: str | None = None
    written: str = ""
    others: tuple[str, ...] = ()
    core: bool = False
    declination_deg: float = 0.0
    has_quantity: bool = False
    traverses: int = 0


def preamble_of(lines: Sequence[str]) -> Preamble:
    """Read the lines above a header.

    >>> found = preamble_of(["Global Orientation is:", "STRIKE/DIPR", "Declination: -7.5", "NO QUANTITY"])
    >>> found.columns, found.convention, found.declination_deg, found.has_quantity
    (('strike', 'dip'), 'right-hand-rule', -7.5, False)
    """
    formats: dict[str, tuple[tuple[str, ...], str | None]] = {}
    declination, traverses, has_quantity = 0.0, 0, False
    for line in lines:
        for pattern, columns, convention in FORMATS:
            if match := re.search(pattern, line, re.IGNORECASE):
                formats.setdefault("".join(match.group().split()).upper(), (columns, convention))
                break
        if match := _DECLINATION.search(line):
            declination = float((match.group(1) or match.group(2)).replace(",", "."))
        if match := _TRAVERSES.search(line):
            traverses = int(match.group(1) or match.group(2))
        if _QUANTITY.search(line):
            has_quantity = not _NO.search(line)
    core = any(_CORE.search(line) for line in lines)
    if not formats:
        return Preamble((), None, "", (), core, declination, has_quantity, traverses)
    (written, (columns, convention)), *rest = formats.items()
    others = tuple(word for word, meant in rest if meant != (columns, convention))
    return Preamble(columns, convention, written, others, core, declination, has_quantity, traverses)
