"""The cells of a header whose columns are separated by single blanks, as are the words of their names."""

import re
from collections.abc import Sequence

from slopekit.design.survey.columns import key_of, size_of, way_of

_LONGEST = 3  # words of a name: dip direction (deg) counts two
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)°?")


def headings_by_blanks(header: str, row: str) -> list[str] | None:
    """The headings of a header, the longest names first, or None where they are not as many as the cells of a row.

    >>> headings_by_blanks("Name Dip Dip Direction (deg)", "J1 45 115")
    ['Name', 'Dip', 'Dip Direction (deg)']
    >>> headings_by_blanks("Global orientation is:", "45/115") is None
    True
    """
    words = re.sub(r"\s+([(\[])", r"\0\1", header.strip(" #*")).split()
    headings: list[str] = []
    if any(word[0].isdigit() for word in words):
        return None
    while words:
        count = next((count for count in range(_LONGEST, 1, -1) if _is_name(words[:count])), 1)
        headings.append(" ".join(words[:count]).replace("\0", " "))
        words = words[count:]
    gives_planes = way_of(key for key in map(key_of, headings) if key) is not None
    return headings if gives_planes and len(headings) == len(row.split()) > 1 else None


def is_row_of_numbers(text: str) -> bool:
    """Whether a line is of numbers with blanks between them, two or more.

    >>> is_row_of_numbers("45 115"), is_row_of_numbers("45"), is_row_of_numbers("J1 45")
    (True, False, False)
    """
    words = text.split()
    return len(words) > 1 and all(_NUMBER.fullmatch(word) for word in words)


def _is_name(words: Sequence[str]) -> bool:
    heading = " ".join(words).replace("\0", " ")
    return key_of(heading) is not None or size_of(heading) is not None
