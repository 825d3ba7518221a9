"""The still pictures of a page, light: as data URIs, scenes in few colours, charts in few digits."""

import base64
import io
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from slopekit.core.errors import DesignError
from slopekit.findings import counted_rows
from slopekit.views.charts.survey_charts import NETS_OF
from slopekit.views.plots import draw, offers
from slopekit.views.solid.scenes import SCENES

#: Pictures of a result in the order of the page, those of blocks for many blocks only.
_OF_RESULT = (
    "scene",
    "elevation",
    "stereonet",
    "tractions",
    "mechanism",
    "factors",
    "reduction",
)
_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}
_LARGEST_SVG = 110_000  # bytes; beyond that a PNG is smaller and as legible
_COLOURS = 96  # of a scene: shades of few materials
_PATH = re.compile(r'(?<= d=")[^"]+|(?<=[ "]x=")[^"]+|(?<=[ "]y=")[^"]+')
_DIGITS = re.compile(r"-?\d+\.\d{3,}")


def still_pictures(document: Mapping[str, Any]) -> tuple[list[dict[str, Any]], list[str]]:
    """The pictures that can be drawn of a document, and sentences on those that cannot, with the code of each.

    A picture has its word `what`, its `caption`, itself as a data URI, `uri`, and whether it `is_chart`, not a scene.
    """
    offered = offers(document)
    is_result = "fos" in document and "study" not in document
    names = (
        [picture for picture in _OF_RESULT if picture in offered] if is_result else list(offered)
    )
    if document.get("assembly") is not None:
        names = _informative_pictures(names, counted_rows(document))
    requests = [(picture, offered[picture], "") for picture in names]
    if (
        document.get("kind") == "kinematic"
    ):  # a net for each test: four in one have no legible letter on a phone
        requests = [
            (picture, f"{test} {'sliding' if test in ('planar', 'wedge') else 'toppling'}", test)
            for picture, _, _ in requests
            for test in NETS_OF
        ]
    pictures: list[dict[str, Any]] = []
    missing: dict[str, list[str]] = {}
    for picture, caption, test in requests:
        try:
            uri = page_picture(document, picture, test or None)
            pictures.append(
                {"what": picture, "caption": caption, "uri": uri, "is_chart": picture not in SCENES}
            )
        except DesignError as error:
            fault = error.faults[0]
            missing.setdefault(f"{fault.code} {fault.message}", []).append(picture)
    return pictures, [
        f"{', '.join(dict.fromkeys(picture_names))}: {reason}"
        for reason, picture_names in missing.items()
    ]


def _informative_pictures(names: list[str], mechanisms: Sequence[Mapping[str, Any]]) -> list[str]:
    """Without pictures that would show one colour: factors say something where several differ."""
    factors = [
        row["fos"]
        for row in mechanisms
        if row["fos"] is not None and row["status"] != "not_converged"
    ]
    differ = bool(factors) and max(factors) > 1.02 * factors[0]
    shows = {"tractions": False, "factors": differ}
    return [picture for picture in names if shows.get(picture, True)]


def page_picture(document: Mapping[str, Any], picture: str, test: str | None = None) -> str:
    """A picture of a document as a data URI.

    Raises
    ------
    DesignError
        As `slopekit.views.plots.draw`.
    """
    with tempfile.TemporaryDirectory() as folder:
        drawing = Path(folder) / f"{picture}.svg"
        if picture not in SCENES:
            draw(document, picture, drawing, test=test)
            image = light_svg(drawing.read_text(encoding="utf-8")).encode("utf-8")
        if picture in SCENES or len(image) > _LARGEST_SVG:
            drawing = drawing.with_suffix(".png")
            draw(document, picture, drawing, test=test)
            image = light_png(drawing.read_bytes())
    return f"data:{_TYPES[drawing.suffix]};base64,{base64.b64encode(image).decode()}"


def light_svg(text: str) -> str:
    """A drawing with coordinates to a hundredth of a point, which nobody sees.

    >>> light_svg('<path d="M 1.234567 -0.5 L 3 40.996001"/><use x="7.128000" transform="scale(0.015625)"/>')
    '<path d="M 1.23 -0.5 L 3 41"/><use x="7.13" transform="scale(0.015625)"/>'
    """
    return _PATH.sub(
        lambda path: _DIGITS.sub(lambda number: f"{round(float(number[0]), 2):g}", path[0]), text
    )


def light_png(data: bytes) -> bytes:
    """A picture in few colours of its own; as it is where that saves nothing."""
    from PIL import Image

    picture = Image.open(io.BytesIO(data)).convert("RGB")
    written = io.BytesIO()
    picture.quantize(_COLOURS, dither=Image.Dither.NONE).save(written, "PNG", optimize=True)
    return min(data, written.getvalue(), key=len)
