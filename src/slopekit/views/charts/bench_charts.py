"""The charts of a study of benches (matplotlib), from its JSON: backbreak. Needs `plot`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from slopekit.core.orientation import number
from slopekit.views.charts.drawing import GREY, RED, finish, short

Document = Mapping[str, Any]
_MOST_CURVES = 24
_STYLES = ("-", "--", ":", "-.")


def draw_backbreak(figure: Any, document: Document) -> None:
    """Backbreak against the share of the length that loses no more, a curve for each bench."""
    axes = _curves(figure, document)
    axes.set_xlabel("backbreak: crest lost, m")
    axes.set_ylabel("length of bench that loses no more, %")
    _wanted(axes, document)
    finish(figure, axes, f"{_title(document)}\nbackbreak along the bench", columns=4, size=10.0)


def _curves(figure: Any, document: Document) -> Any:
    """A curve for each bench: colour by face angle, line style by height."""
    from matplotlib import colormaps

    figure.set_size_inches(9.0, 6.4)
    axes = figure.subplots()
    benches = document["benches"]
    heights = sorted({bench["height_m"] for bench in benches})
    dips = sorted({bench["face_dip_deg"] for bench in benches})
    shades = colormaps["viridis"](np.linspace(0.0, 0.88, len(dips)))
    for bench in benches:
        values = np.array(bench["backbreak_curve_m"], dtype=float)
        share = np.linspace(0.0, 100.0, len(values))
        labelled = len(benches) <= _MOST_CURVES
        axes.step(
            values, share, where="post", linewidth=1.6,
            color=shades[dips.index(bench["face_dip_deg"])],
            linestyle=_STYLES[heights.index(bench["height_m"]) % len(_STYLES)],
            label=f"{number(bench['height_m'])} m, {number(bench['face_dip_deg'])}°" if labelled else None,
        )  # fmt: skip
    axes.set_ylim(0.0, 101.0)
    axes.set_xlim(left=0.0)
    return axes


def _wanted(axes: Any, document: Document) -> None:
    """The reliability that is wanted."""
    wanted = 100.0 * document["inputs"]["reliability"]
    axes.axhline(wanted, color=RED, linewidth=1.0, linestyle="--")
    axes.annotate(f"{number(wanted)} % wanted", (0.995, wanted), xycoords=("axes fraction", "data"), ha="right",
                  va="bottom", fontsize=8, color=GREY)  # fmt: skip


def _title(document: Document) -> str:
    survey, inputs = document["survey"], document["inputs"]
    return (
        f"{short(str(survey['name']), 50)}: {survey['joints']} joints, faces toward "
        f"{inputs['dip_direction_deg']:03.0f} (sha {document['input_sha256'][:6]})"
    )
