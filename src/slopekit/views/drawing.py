"""What all charts share (matplotlib): figures, colours, names in short, files. Needs the extra `plot`."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

from slopekit.errors import DesignError, Fault

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
        advice = "In slopekit's folder: pip install '.[plot]'"
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


def save(figure: Any, path: Path) -> None:
    """Write a figure, the same bytes every time.

    Raises
    ------
    DesignError
        E129 where the file cannot be written.
    """
    import matplotlib as mpl

    stamps = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix.lower())
    try:
        with mpl.rc_context({"svg.hashsalt": "slopekit"}):
            figure.savefig(path) if stamps is None else figure.savefig(path, metadata=stamps)
    except OSError as error:
        reason = error.strerror or str(error)
        raise DesignError([Fault("E129", f"{path} cannot be written: {reason}", str(path))]) from None


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


def dressed(axes: Any) -> None:
    """A quiet grid beneath the data."""
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
