"""`sk.report`: the page of a result; loads its code only when it is called."""

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from slopekit.result import Result


def report(
    result: "Result | str | os.PathLike[str] | Mapping[str, Any]",
    path: "str | os.PathLike[str]" = "report.html",
    *,
    pictures: bool = True,
) -> "Path":
    """Write the report of a result: one page of HTML that needs no network (extra: report).

    Parameters
    ----------
    result : a result, the path of a result.json or of its folder, or its JSON as a dict
    path : of the page, or the folder for report.html
    pictures : draw the still pictures as well (extra: plot); those that cannot be drawn are named in the page

    Returns
    -------
    the path written

    Raises
    ------
    DesignError
        E140 without the extra, E147 to E149, E340, E341, E371 and E372 for what is no result, E129 where the page
        cannot be written.
    """
    from pathlib import Path

    from slopekit.result import Result
    from slopekit.views.plots import read_document
    from slopekit.views.report import write_report
    from slopekit.views.sheet import document_of

    target = Path(path)
    target = target / "report.html" if target.is_dir() else target
    if isinstance(result, Result):
        document: Mapping[str, Any] = document_of(result)
    elif isinstance(result, Mapping):
        document = result
    elif callable(own := getattr(result, "to_dict", None)):  # a study: refused by what it is
        document = own()
    else:
        source = Path(result)
        document = read_document(source / "result.json" if source.is_dir() else source)
    write_report(document, target, with_pictures=pictures)
    return target
