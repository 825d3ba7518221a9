"""The charts of a study of benches (matplotlib), from its JSON: backbreak, reliability. Need `plot`."""

from collections.abc import Mapping, Sequence
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


def draw_reliability(figure: Any, document: Document) -> None:
    """Height against face angle, a cell for each bench, coloured by reliability; a panel for each berm."""
    from matplotlib.colors import LinearSegmentedColormap

    benches, wanted = document["benches"], 100.0 * document["inputs"]["reliability"]
    heights = sorted({bench["height_m"] for bench in benches})
    dips = sorted({bench["face_dip_deg"] for bench in benches})
    given, asked = document["inputs"]["berms_m"], document.get("accepted") is not None
    panels: Sequence[int] = range(len(benches[0]["reliability"]) if given else 1)
    figure.set_size_inches(max(7.0, 2.4 + 1.15 * len(dips)), 1.7 + len(panels) * (1.5 + 0.72 * len(heights)))
    every = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
    colours = LinearSegmentedColormap.from_list("kept", ["#b5402a", "#f2c57c", "#f7f4e3", "#8fbf9f", "#1f6f54"])
    image = None
    for axes, panel in zip(every, panels, strict=True):
        cells = np.full((len(heights), len(dips)), np.nan)
        for bench in benches:
            berm = bench["reliability"][panel]
            row, column = heights.index(bench["height_m"]), dips.index(bench["face_dip_deg"])
            share = 100.0 * berm["reliability"]["probability"]
            cells[row, column] = share
            lines = [f"{share:.0f} %", f"{berm['inter_ramp_deg']:.1f}°"]
            needs = f"needs {bench['berm_needed_m']:.1f} m" if given else f"berm {berm['berm_m']:.1f} m"
            inverse = share < 25.0 or share > 92.0
            axes.text(column, row, "\n".join([*lines, needs]), ha="center", va="center", fontsize=8.0,
                      color="white" if inverse else "black")  # fmt: skip
            if berm.get("accepted") if asked else share >= wanted:
                axes.add_patch(_frame(column, row))
        image = axes.imshow(cells, cmap=colours, vmin=0.0, vmax=100.0, aspect="auto", origin="lower")
        axes.set_xticks(range(len(dips)), [f"{number(dip)}°" for dip in dips])
        axes.set_yticks(range(len(heights)), [f"{number(height)} m" for height in heights])
        axes.set_ylabel("bench height")
        said = f"berm {number(given[panel])} m" if given else f"with the berm needed for {number(wanted)} %"
        axes.set_title(said, fontsize=9.5)
    framed = "accepted" if asked else "reached"
    every[-1].set_xlabel("face angle")
    figure.colorbar(image, ax=list(every), label="length that keeps the catch width, %")
    figure.suptitle(
        f"{_title(document)}\nreliability, inter-ramp angle, berm for {number(wanted)} %; framed: {framed}",
        fontsize=10.0,
    )


def _frame(column: int, row: int) -> Any:
    """What marks a bench that reaches the reliability wanted."""
    from matplotlib.patches import Rectangle

    return Rectangle((column - 0.47, row - 0.47), 0.94, 0.94, fill=False, edgecolor="black", linewidth=1.8)


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
