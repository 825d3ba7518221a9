"""What results and studies look like in a notebook: a picture, where the extra `plot` is there, and the sheet."""

from html import escape
from typing import Any

from slopekit.core.shown import Shown
from slopekit.errors import DesignError
from slopekit.views.report import picture_of


def html_of(shown: Shown) -> str:
    """A picture and the sheet as HTML."""
    return f"{_picture(shown.to_dict())}\n{shown.sheet._repr_html_()}"


def _picture(document: dict[str, Any]) -> str:
    """The first picture that the document can give, nothing where it cannot be drawn."""
    from slopekit.views.plots import offers

    for what, caption in offers(document).items():
        try:
            uri = picture_of(document, what)
        except DesignError:
            continue
        return f'<img src="{uri}" alt="{escape(caption)}" style="max-width: 720px; width: 100%">'
    return ""
