"""The still pictures of a report as data URIs: what the extra `plot` draws, and why what is missing is missing."""

import base64
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slopekit.errors import DesignError

#: Pictures of a result in the order of the page, those of blocks for many blocks only.
_OF_RESULT = ("scene", "stereonet", "tractions", "mechanism", "factors", "ravelling", "reduction")
_SCENES = ("scene", "exploded", "tractions", "forces", "displacement", "mechanism", "factors", "ravelling")
_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}
_LARGEST_SVG = 250_000  # bytes; beyond that a PNG is smaller and as legible


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture: its word, what it shows, and itself as a data URI."""

    what: str
    caption: str
    uri: str

    @property
    def is_chart(self) -> bool:
        """Whether it is a chart, in place of a scene."""
        return self.what not in _SCENES


def still_pictures(document: Mapping[str, Any]) -> tuple[list[Picture], list[str]]:
    """The pictures that can be drawn of a document, and sentences on those that cannot, with the code of each."""
    from slopekit.views.plots import offers

    offered = offers(document)
    names = [what for what in _OF_RESULT if what in offered] if "fos" in document else list(offered)
    if document.get("assembly") is not None:
        names = _of_many(names, document["assembly"])
    found: list[Picture] = []
    missing: dict[str, list[str]] = {}
    for what in names:
        try:
            found.append(Picture(what, offered[what], _drawn(document, what)))
        except DesignError as error:
            fault = error.faults[0]
            missing.setdefault(f"{fault.code} {fault.message}", []).append(what)
    return found, [f"{', '.join(whats)}: {why}" for why, whats in missing.items()]


def _of_many(names: list[str], assembly: Mapping[str, Any]) -> list[str]:
    """Without pictures that would show one colour: factors and order say something where several differ."""
    factors = [value for value in assembly["factor_by_block"].values() if value is not None]
    left = {"tractions"}
    left |= set() if factors and max(factors) > 1.02 * min(factors) else {"factors"}
    left |= set() if len(assembly["mechanisms"]) > 1 else {"ravelling"}
    return [what for what in names if what not in left]


def _drawn(document: Mapping[str, Any], what: str) -> str:
    from slopekit.views.plots import draw

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{what}.{'png' if what in _SCENES else 'svg'}"
        draw(document, what, path)
        if path.suffix == ".svg" and path.stat().st_size > _LARGEST_SVG:
            path = path.with_suffix(".png")
            draw(document, what, path)
        data = base64.b64encode(path.read_bytes()).decode()
    return f"data:{_TYPES[path.suffix]};base64,{data}"
