"""Results, studies and pictures as HTML of a notebook."""

import os
from base64 import b64encode
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slopekit.core.errors import DesignError
from slopekit.core.report import Report
from slopekit.views.pages.page_pictures import page_picture

if TYPE_CHECKING or os.name != "nt":  # not one expression: a class needs a base that is known
    from pathlib import PosixPath as _PlatformPath
else:
    from pathlib import WindowsPath as _PlatformPath
_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}


class Drawing(_PlatformPath):
    """The file of a picture, a path like any other; in a notebook it shows what it holds."""

    @property
    def path(self) -> Path:
        """The file of the picture."""
        return Path(self)

    def _repr_html_(self) -> str:
        kind = _TYPES.get(self.suffix.lower())
        if kind is None:
            return f"<code>{escape(str(self))}</code>"
        data = b64encode(self.read_bytes()).decode()
        return f'<img src="data:{kind};base64,{data}" alt="{escape(self.stem)}" style="max-width: 820px; width: 100%">'


def html_of(result: Report) -> str:
    """A picture and the sheet as HTML."""
    return f"{_picture(result.to_dict())}\n{result.sheet._repr_html_()}"


def _picture(document: dict[str, Any]) -> str:
    """The first picture that the document can give, nothing where it cannot be drawn."""
    from slopekit.views.plots import offers

    for picture, caption in offers(document).items():
        try:
            uri = page_picture(document, picture)
        except DesignError:
            continue
        return f'<img src="{uri}" alt="{escape(caption)}" style="max-width: 720px; width: 100%">'
    return ""
