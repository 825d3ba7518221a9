"""Words and columns that the sheets of studies share."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from slopekit._version import __version__
from slopekit.core.sheet import Section, Sheet, Table, factor_text, is_number
from slopekit.design.common import Design
from slopekit.kinds import status_text
from slopekit.result import STATUSES
from slopekit.studies.points import Method, Point

METHODS: dict[Method, str] = {"pre_ie": "PRE-IE", "closed_form": "closed form"}


def study_sheet(
    design: Design,
    study: str,
    sections: Sequence[Section],
    tables: Mapping[str, Table[Any]] = MappingProxyType({}),
) -> Sheet:
    """Return the sheet of a study, whose first line has version, study, kind and title."""
    title = f"   {design.title}" if design.title else ""
    return Sheet(
        f"slopekit {__version__}   {study}   {design.kind}{title}",
        sections,
        tables,
        design.input_hash(),
    )


def status_words(design: Design, status: str) -> str:
    """Return a status as a sentence with the user's names of joints, or a code unchanged."""
    return design.in_own_names(status_text(design.kind, status)) if status in STATUSES else status


def cell(factor: float | None) -> str:
    """Return a factor as text for a table, `none` where the status tells why there is none."""
    return factor_text(factor).strip() if is_number(factor) else "none"


def check_word(point: Point) -> str:
    """Return whether the methods agree at a point, and whether moments govern, in words."""
    factors = point.factors
    if factors is None:
        return ""
    if factors.status == "not_converged":
        return "no convergence"
    word = {True: "agree", False: "DISAGREE", None: ""}[factors.agree]
    return ", ".join(
        [*([word] if word else []), *(["moments govern"] if factors.moments_govern else [])]
    )
