"""Writing the page of a result."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from slopekit.errors import DesignError, Fault
from slopekit.views.plots import checked_document, read_document
from slopekit.views.report import Report, report_of

__all__ = ["read_document", "write_report"]


def write_report(document: Mapping[str, Any], path: Path, name: str = "", with_pictures: bool = True) -> Report:
    """Make the page of a document and write it.

    Raises
    ------
    DesignError
        As `report_of`; E341 where it is none of slopekit's, E129 where the file cannot be written.
    """
    made = report_of(checked_document(document, name or "the document"), name or str(path), with_pictures)
    try:
        path.write_text(made.html, encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise DesignError([Fault("E129", f"{path} cannot be written: {reason}", str(path))]) from None
    return made
