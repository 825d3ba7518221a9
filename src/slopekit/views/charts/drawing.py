"""What all charts share (matplotlib): figures, colours, names in short, files. Needs the extra `plot`."""

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.whole_files import whole_file

#: Colours that the colour-blind tell apart (Okabe & Ito 2008), darkened where they stand on white.
BLUE, RED, GREEN, PURPLE, ORANGE, SKY = "#0064a4", "#c8500a", "#007f5f", "#a8548a", "#d89000", "#56b4e9"
DARK, GREY = "#4d4d4d", "#888888"
#: Behind a label that may come to lie on a line.
BOX = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8}
#: What charts are written as.
FORMATS = (".png", ".svg", ".pdf")
_DPI = 130


def require_matplotlib(path: Path | str) -> None:
    """Raise E140 where no picture can be drawn, before the work is done."""
    if find_spec("matplotlib") is None:
        advice = "pip install 'slopekit[plot]'"
        raise DesignError([Fault("E140", "drawing needs the extra plot (matplotlib)", str(path), advice)])


def new_figure(path: Path | str) -> Any:
    """An empty figure that no window knows.

    Raises
    ------
    DesignError
        E140 where matplotlib is not installed.
    """
    require_matplotlib(path)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 6.0), dpi=_DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def plain_numbers() -> AbstractContextManager[Any]:
    """The setting under which axes are made: ticks in full, map coordinates without an offset or an exponent."""
    import matplotlib as mpl

    return mpl.rc_context({"axes.formatter.useoffset": False, "axes.formatter.limits": (-5, 9)})


def save(figure: Any, path: Path) -> None:
    """Write a figure, the same bytes every time.

    Raises
    ------
    DesignError
        E129 where the file cannot be written.
    """
    import matplotlib as mpl

    stamps = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix.lower())
    with writing(path), mpl.rc_context({"svg.hashsalt": "slopekit"}), whole_file(path) as file:
        figure.savefig(file) if stamps is None else figure.savefig(file, metadata=stamps)


def nothing(why: str) -> NoReturn:
    """Raise E273: there is nothing to draw, and why."""
    raise DesignError([Fault("E273", f"there is nothing to draw: {why}")])


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


def finish(figure: Any, axes: Any, title: str, columns: int = 3, size: float = 11.0) -> None:
    """A title of `size` points, a quiet grid, and the legend of all axes beneath, in `columns`."""
    axes.set_title(title, fontsize=size)
    dressed(axes)
    if any(each.get_legend_handles_labels()[1] for each in figure.axes):
        figure.legend(fontsize=8.5, loc="outside lower center", ncols=columns, frameon=False)


def note(axes: Any, text: str, at: tuple[float, float], offset: tuple[float, float], **style: Any) -> Any:
    """A text beside a point, `offset` points from it, which stays legible where it comes to lie on a line."""
    return axes.annotate(text, at, xytext=offset, textcoords="offset points", **{"fontsize": 8, "bbox": BOX} | style)


def dressed(axes: Any) -> None:
    """A quiet grid beneath the data."""
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)


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
    renderer, frame = figure.canvas.get_renderer(), axes.get_window_extent(figure.canvas.get_renderer())
    for label in labels:
        box = label.get_window_extent(renderer)
        label.set_visible(frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1)


def stretches(line: Sequence[tuple[float, float | None]]) -> list[list[tuple[float, float]]]:
    """Runs of neighbours that have a number."""
    runs: list[list[tuple[float, float]]] = [[]]
    for value, factor in line:
        if factor is not None and 0.0 < factor < math.inf:
            runs[-1].append((value, factor))
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if run]
