"""Parts that all charts share (matplotlib): style, colours, labelled lines, short names, files. Extra: `plot`."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.extras import require_extra
from slopekit.core.whole_files import whole_file

#: Sizes, widths and margins of all charts.
STYLE = Path(__file__).with_name("slopekit.mplstyle")
#: Colours that the colour-blind tell apart (Okabe & Ito 2008), darkened where they stand on white.
BLUE, RED, GREEN, PURPLE, ORANGE, SKY = (
    "#0064a4",
    "#c8500a",
    "#007f5f",
    "#a8548a",
    "#d89000",
    "#56b4e9",
)
DARK, GREY = "#4d4d4d", "#888888"
#: Of sets, joints and methods, in their order; the mean of what is many is RED.
COLOURS = (BLUE, GREEN, PURPLE, ORANGE, SKY, "#8c6d1f", "#5b5b9e", "#3d3d3d")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "p")
#: Behind a label that may come to lie on a line.
BOX = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8}
#: What charts are written as.
FORMATS = (".png", ".svg", ".pdf")
_MARKER_RADIUS = 6  # pixels: half of what a marker takes


def require_matplotlib(path: Path | str) -> None:
    """Raise E140 where no picture can be drawn, before the work is done."""
    require_extra("plot", "drawing needs", "matplotlib", where=path)


@contextmanager
def new_figure(path: Path | str) -> Iterator[Any]:
    """An empty figure that no window knows; what is drawn within has the style of `STYLE`.

    Raises
    ------
    DesignError
        E140 where matplotlib is not installed.
    """
    require_matplotlib(path)
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with mpl.rc_context(fname=STYLE):
        figure = Figure(layout="constrained")
        FigureCanvasAgg(figure)
        yield figure


def save(figure: Any, path: Path) -> None:
    """Write a figure within its style, the same bytes every time.

    Raises
    ------
    DesignError
        E129 where the file cannot be written.
    """
    stamps = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix.lower())
    with writing(path), whole_file(path) as file:
        figure.savefig(file, metadata=stamps)


def refuse_empty_chart(reason: str) -> NoReturn:
    """Raise E273: there is nothing to draw, and why."""
    raise DesignError([Fault("E273", f"there is nothing to draw: {reason}")])


def short(text: str, most: int = 60) -> str:
    """A text that fits, its beginning and its end, in signs that matplotlib leaves as they are.

    >>> short("strength.weathered_sandstone.phi", 21)
    'strength....stone.phi'
    """
    if len(text) > most:
        tail = (most - 3) // 2
        text = f"{text[: most - 3 - tail]}...{text[-tail:]}"
    plain = " ".join(text.split()).replace("$", r"\$")  # else a formula
    return f" {plain}" if plain.startswith("_") else plain  # else no entry of a legend


def title_of(document: Any) -> str:
    """Title, or kind, and the first of the hash, as over every chart."""
    name = str(document.get("title") or document.get("kind") or "")
    return f"{short(name, 70)}  (sha {str(document.get('input_sha256') or '-')[:6]})"


def finish(figure: Any, axes: Any, title: str, columns: int = 3) -> None:
    """A title, and the legend of all axes beneath, in `columns`."""
    axes.set_title(title)
    if any(panel.get_legend_handles_labels()[1] for panel in figure.axes):
        figure.legend(loc="outside lower center", ncols=columns)


def note(
    axes: Any, text: str, point: tuple[float, float], offset: tuple[float, float], **style: Any
) -> Any:
    """A text beside a point, `offset` points from it, which stays legible where it comes to lie on a line."""
    return axes.annotate(
        text, point, xytext=offset, textcoords="offset points", **{"bbox": BOX} | style
    )


def place_label(
    axes: Any,
    text: str,
    point: Any,
    offsets: Sequence[tuple[int, int]],
    occupied: list[Any],
    marked_points: Any = (),
    **style: Any,
) -> bool:
    """Write a text about a point where it finds room, once the layout is settled; return whether it did.

    Parameters
    ----------
    offsets : where it may stand, in points from the point, best first
    occupied : the boxes of texts that it shall not cover; its own joins them
    marked_points : (n, 2) pixels that it shall not cover either
    """
    for offset in offsets:
        label = axes.annotate(
            text,
            point,
            offset,
            textcoords="offset points",
            ha="center",
            va="center",
            in_layout=False,
            **style,
        )
        box = label.get_window_extent()
        is_free = not box.count_overlaps(occupied) and not (
            len(marked_points) and box.padded(_MARKER_RADIUS).count_contains(marked_points)
        )
        if is_free and axes.bbox.containsx(box.x0) and axes.bbox.containsx(box.x1):
            occupied.append(box)
            return True
        label.remove()
    return False


def draw_level(
    axes: Any, value: float, text: str, colour: str = GREY, *, on_left: bool = False
) -> None:
    """A dashed line across at a value, beneath the data, labelled at one of its ends."""
    axes.axhline(value, color=colour, linestyle="--", linewidth=1.0, zorder=1)
    side, offset = ("left", 3) if on_left else ("right", -3)
    note(
        axes,
        text,
        (0.0 if on_left else 1.0, value),
        (offset, 0),
        xycoords=axes.get_yaxis_transform(),
        ha=side,
        va="bottom",
        color=colour if colour != GREY else DARK,
        zorder=1.9,
    )


def draw_upright(
    axes: Any,
    value: float,
    text: str,
    colour: str = DARK,
    *,
    style: str = "-",
    on_left: bool = True,
    foot: bool = True,
) -> None:
    """An upright line at a value, its label along it at the foot or the head, on one side of it."""
    axes.axvline(value, color=colour, linestyle=style)
    height, va = (0.04, "bottom") if foot else (0.98, "top")
    offset, ha = (-4, "right") if on_left else (4, "left")
    note(
        axes,
        text,
        (value, height),
        (offset, 0),
        xycoords=axes.get_xaxis_transform(),
        rotation=90,
        va=va,
        ha=ha,
        color=colour,
    )


def logarithmic(axes: Any) -> None:
    """A logarithmic axis with numbers as people write them."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def hide_cut(figure: Any, axes: Any, labels: Any) -> None:
    """Take labels of contours away that the frame would cut."""
    figure.draw_without_rendering()  # the layout settles where labels come to lie
    frame = axes.get_window_extent()
    for label in labels:
        box = label.get_window_extent()
        label.set_visible(
            frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1
        )
