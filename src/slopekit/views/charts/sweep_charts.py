"""Pictures of sweeps (matplotlib), from their JSON: a curve, a contour, a tornado. Need the extra `plot`."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import millimetre
from slopekit.core.sheet import is_number
from slopekit.design.fields import words_of
from slopekit.design.registry import KINDS, record_of
from slopekit.studies.points import (
    Line,
    Method,
    Point,
    evaluated_methods,
    factor_at,
    governing_factor,
    lines_of,
    status_of,
)
from slopekit.studies.words import METHODS, cell
from slopekit.views.charts.drawing import (
    BLUE,
    DARK,
    GREY,
    RED,
    SKY,
    draw_level,
    draw_upright,
    finish,
    hide_cut,
    logarithmic,
    note,
    refuse_empty_chart,
    short,
    title_of,
)

Document = Mapping[str, Any]
_WIDE = 10.0  # factors that span more are drawn on a logarithmic axis
_NEAR, _CLOSE = (
    0.15,
    0.05,
)  # of the height of a chart: levels farther off are left out; labels nearer would touch
_EDGES = (0.03, 0.97)  # of the height of a chart: where points without a number stand
_MOST_MARKED = 8  # changes of status that are labelled
_MOST_BARS = 25
_MAP_M = 1e5  # lengths from here on are coordinates of a map
_MOST_DOTS = 900  # points of a grid that are marked
_FEWEST = 3  # values of each key that bands can be drawn between
_TOO_FEW = "too few points have a factor of safety"
_STAR = {
    "marker": "*",
    "markersize": 13,
    "color": DARK,
    "markerfacecolor": "white",
    "linestyle": "none",
    "clip_on": False,
    "zorder": 5,
    "label": "the design as it is",
}
_DIAMOND = {
    "marker": "D",
    "color": DARK,
    "markerfacecolor": "white",
    "linestyle": "none",
    "zorder": 4,
    "label": "passes the level (interpolated)",
}
#: What is marked of a point by what is said of it: one without a number, one that asks for a look.
_MARKS: Mapping[str, Mapping[str, Any]] = {
    "nothing drives: no number": {"marker": "^", "color": BLUE},
    "nothing holds: no number": {"marker": "v", "color": RED},
    "no block, or bad input": {"marker": "x", "color": DARK},
    "no convergence": {"marker": "P", "color": RED},
    "moments govern": {"marker": "o", "color": BLUE, "markerfacecolor": "none", "markersize": 9},
    "the methods disagree": {
        "marker": "o",
        "color": RED,
        "markerfacecolor": "none",
        "markersize": 13,
    },
}
_BRIEF = {
    "slides_on_both": "both planes",
    "slides_on_J1": "J1",
    "slides_on_J2": "J2",
    "no_driving_force": "nothing drives",
    "slides_up": "up",
    "not_converged": "no convergence",
    "slides_on_basal": "basal",
    "slides_on_J1_and_J2": "J1, J2",
    "slides_on_J1_and_basal": "J1, basal",
    "slides_on_J2_and_basal": "J2, basal",
}


def _read_sweep(document: Document) -> tuple[list[Line], tuple[Method, ...]]:
    """The points of a sweep as `lines_of` has them, and the methods that were asked and are there."""
    points, values = (
        [Point.from_record(record) for record in document["points"]],
        [key["values"] for key in document["keys"]],
    )
    needed = math.prod(map(len, values))
    if len(points) != needed:
        raise ValueError(f"{len(points)} points for {needed} values")
    return lines_of(points, *values), evaluated_methods(document["methods"], points)


def draw_curve(figure: Any, document: Document) -> None:
    """Factors against the value of one key; changes of status upright, levels across, points without a number below.

    Raises
    ------
    DesignError
        E273 without a point to draw; so do the others.
    """
    ((_, points),), methods = _read_sweep(document)
    (key,) = document["keys"]
    values = [value for value, _ in points]
    curves = {
        method: _plottable(factor_at(point, method) for _, point in points) for method in methods
    }
    mechanism = next((point.also for _, point in points if point.also is not None), None)
    mechanism_factors = _plottable(
        None if point.also is None else point.also.factor for _, point in points
    )
    all_factors = np.concatenate([*curves.values(), mechanism_factors])
    if np.isnan(all_factors).all():
        refuse_empty_chart(_TOO_FEW)
    axes = figure.subplots()
    if np.nanmax(all_factors) > _WIDE * np.nanmin(all_factors):
        logarithmic(axes)
    if len(methods) > 1:  # beneath PRE-IE, wider: where they agree both are seen
        axes.plot(
            values,
            curves["closed_form"],
            color=RED,
            linewidth=6,
            alpha=0.35,
            label=METHODS["closed_form"],
        )
    colour = BLUE if methods[0] == "pre_ie" else RED
    axes.plot(values, curves[methods[0]], color=colour, marker="o", label=METHODS[methods[0]])
    if mechanism is not None:
        axes.plot(
            values,
            mechanism_factors,
            color=DARK,
            linestyle="--",
            marker="s",
            label=f"{mechanism.BRIEF} (W507)",
        )
    _draw_levels(axes, document)
    _draw_status_changes(axes, document)
    crossings = [
        crossing
        for crossing in document["critical"]
        if crossing["method"] == methods[0] and crossing["at"] is not None
    ]
    if crossings:
        axes.plot(
            [crossing["at"] for crossing in crossings],
            [crossing["fos"] for crossing in crossings],
            **_DIAMOND,
        )
    for crossing in crossings:
        note(
            axes,
            _with_unit(crossing["at"], key["unit"], 4),
            (crossing["at"], crossing["fos"]),
            (6, 7),
            zorder=4,
        )
    design_factor = next(
        (factor_at(point, methods[0]) for value, point in points if value == key["now"]), None
    )
    if is_number(design_factor):
        axes.plot([key["now"]], [design_factor], **_STAR)
    axes.set_ylim(axes.get_ylim())
    low, high = axes.transLimits.inverted().transform([(0.0, edge) for edge in _EDGES])[:, 1]
    if axes.get_yscale() == "log":
        low, high = 10.0**low, 10.0**high
    marked_points = [
        (value, low if factor is None else min(max(factor, low), high), point)
        for value, point in points
        for factor in [factor_at(point, methods[0])]
    ]
    _draw_marks(axes, marked_points, methods[0])
    axes.set(xlabel=_axis_name(document, key), ylabel="factor of safety")
    finish(
        figure, axes, f"{title_of(document)}\nfactor of safety over {_key_words(document, key)}", 4
    )


def draw_contour(figure: Any, document: Document) -> None:
    """The factor over two keys: contours, the levels as thick lines, points without a number marked.

    With less than three values of a key there is nothing to draw bands from: a curve for each of them is drawn instead.
    """
    first, second = document["keys"]
    if min(len(key["values"]) for key in (first, second)) < _FEWEST:
        refuse_empty_chart("contours need three values of each key: give more, or sweep one key")
    lines, (method, *_) = _read_sweep(document)
    lines.sort(key=lambda line: line[0] or 0.0)
    across, down = [value for value, _ in lines[0][1]], [line or 0.0 for line, _ in lines]
    factors = np.array(
        [[governing_factor(point, method) for _, point in points] for _, points in lines],
        dtype=float,
    )
    finite = factors[np.isfinite(factors) & (factors > 0.0)]
    if finite.size < _FEWEST:
        refuse_empty_chart(_TOO_FEW)
    from matplotlib.colors import Normalize, TwoSlopeNorm
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import MaxNLocator

    axes = figure.subplots()
    level_factors = [level["fos"] for level in document["levels"]]
    low, high = (
        float(finite.min()),
        min(float(finite.max()), 3.0 * max(*level_factors, float(np.median(finite)))),
    )
    clipped_factors = np.clip(factors, 0.99 * low, 1.01 * high)
    steps: Any = MaxNLocator(nbins=14).tick_values(low, high)
    if not (len(steps) > 1 and high > low):
        steps = np.array([low - 0.1, low, low + 0.1])
    norm = TwoSlopeNorm(1.0, low, high) if low < 1.0 < high else Normalize(low, high)
    colours = "RdYlBu" if low < 1.0 < high else "YlGnBu" if low >= 1.0 else "YlOrRd_r"
    filled = axes.contourf(
        across, down, clipped_factors, levels=steps, cmap=colours, norm=norm, extend="both"
    )
    between = [
        step for step in steps if all(abs(step - value) > 0.01 * value for value in level_factors)
    ]
    thin = axes.contour(across, down, clipped_factors, levels=between, colors=DARK, linewidths=0.5)
    labels = axes.clabel(thin, fmt="%.4g", colors="black")
    for label in labels:
        label.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
    for level, colour in zip(document["levels"], (RED, DARK, BLUE, GREY), strict=False):
        if low < level["fos"] < high:
            axes.contour(
                across,
                down,
                clipped_factors,
                levels=[level["fos"]],
                colors=[colour],
                linewidths=2.0,
            )
            axes.plot([], [], color=colour, linewidth=2.0, label=level["what"])
    places = [
        (x, y, point) for y, (_, points) in zip(down, lines, strict=True) for x, point in points
    ]
    mechanism = next((point.also for _, _, point in places if point.also), None)
    mechanism_note = "" if mechanism is None else f", or {mechanism.BRIEF} where lower"
    figure.colorbar(filled, ax=axes, label=f"factor of safety ({METHODS[method]}{mechanism_note})")
    if len(places) <= _MOST_DOTS:
        axes.plot(
            *zip(*((x, y) for x, y, _ in places), strict=True),
            marker="o",
            color="white",
            markersize=3,
            markeredgecolor=DARK,
            linestyle="none",
            clip_on=False,
            label="computed",
        )
    _draw_marks(axes, places, method)
    if _inside(first["now"], across) and _inside(second["now"], down):
        axes.plot([first["now"]], [second["now"]], **_STAR)
    axes.set(
        xlabel=_axis_name(document, first),
        ylabel=_axis_name(document, second),
        xlim=(min(across), max(across)),
        ylim=(min(down), max(down)),
    )
    subject = f"factor of safety over {_key_words(document, first, 40)} and {_key_words(document, second, 40)}"
    finish(figure, axes, f"{title_of(document)}\n{subject}", 4)
    hide_cut(figure, axes, labels)


def draw_tornado(figure: Any, document: Document) -> None:
    """A bar for each number from its factor at one end to that at the other, the longest on top."""
    base_point = Point.from_record(document["base"])
    methods = evaluated_methods(document["methods"], [base_point])
    base = factor_at(base_point, methods[0])
    moving = [bar for bar in document["bars"] if bar["swing"][methods[0]] != 0.0]
    bars = moving[:_MOST_BARS]
    ends = [[Point.from_record(bar[end]) for end in ("at_low", "at_high")] for bar in bars]
    finite = [
        f
        for end_points in ends
        for point in end_points
        if (f := factor_at(point, methods[0])) is not None and f < math.inf
    ]
    if base is None or not math.isfinite(base) or not finite:
        refuse_empty_chart(_TOO_FEW)
    figure.set_size_inches(9.0, 2.6 + 0.36 * len(bars))
    axes = figure.subplots()
    low, high = min([base, *finite]), max([base, *finite])
    room = (high - low) or 0.1
    for row, (bar, end_points) in enumerate(zip(bars, ends, strict=True)):
        texts = bar.get("shown") or [
            _with_unit(bar[end], bar["unit"], 5) for end in ("low", "high")
        ]
        bar_ends = [
            _bar_end(point, methods[0], base, (low - 0.05 * room, high + 0.05 * room))
            for point in end_points
        ]
        _draw_bar(
            axes, row, [(text, *end) for text, end in zip(texts, bar_ends, strict=True)], base
        )
    if len(methods) > 1:
        closed = [
            (f, row)
            for row, end_points in enumerate(ends)
            for point in end_points
            if (f := factor_at(point, "closed_form")) is not None and 0.0 < f < math.inf
        ]
        axes.plot(
            *zip(*closed, strict=True),
            marker="|",
            markersize=17,
            color=RED,
            linestyle="none",
            zorder=4,
            label=METHODS["closed_form"],
        )
    axes.plot([], [], color=SKY, linewidth=8, label="at the lower end")
    axes.plot([], [], color=BLUE, linewidth=8, label="at the upper end")
    axes.axvline(base, color=DARK)
    if low - room < 1.0 < high + room:
        axes.axvline(1.0, color=GREY, linestyle="--")
    axes.set_yticks(range(len(bars)), [_key_words(document, bar, 40) for bar in bars])
    axes.set(ylim=(len(bars) - 0.4, -0.6), xlim=(low - 0.22 * room, high + 0.22 * room))
    omitted = len(moving) - len(bars)
    more = f"; {omitted} smaller ones left out" if omitted > 0 else ""
    axis_label = f"factor of safety ({METHODS[methods[0]]}); upright line: {cell(base)} now{more}"
    axes.set_xlabel(
        f"{axis_label}\n{document['rule']}", loc="right", fontsize="medium"
    )  # under the names, too
    finish(figure, axes, f"{title_of(document)}\nwhat each number does to the factor of safety", 4)


# -- parts ------------------------------------------------------------------------------------------------------------


def _plottable(factors: Iterable[float | None]) -> Floats:
    """Factors (n,) as they can be drawn: nan, where a line breaks, for none, none that is finite, and 0."""
    values = np.array(list(factors), dtype=float)
    return np.where((values > 0.0) & (values < math.inf), values, np.nan)


def _mark_labels(point: Point, method: Method) -> list[str]:
    """Return the keys of `_MARKS` that apply to a point."""
    factor, labels = factor_at(point, method), list[str]()
    if point.factors is None:
        labels.append("no block, or bad input")
    elif factor is None:
        labels.append("no convergence")
    elif factor == 0.0 or factor == math.inf:
        labels.append("nothing holds: no number" if factor == 0.0 else "nothing drives: no number")
    labels += ["moments govern"] if point.moments_govern else []
    return labels + (["the methods disagree"] if point.agree is False else [])


def _draw_marks(axes: Any, places: Sequence[tuple[float, float, Point]], method: Method) -> None:
    """Mark what is said of points, each where it stands in the chart."""
    for label, style in _MARKS.items():
        positions = [(x, y) for x, y, point in places if label in _mark_labels(point, method)]
        if positions:
            axes.plot(
                *zip(*positions, strict=True), linestyle="none", clip_on=False, label=label, **style
            )


def _key_words(document: Document, key: Document, most: int = 60) -> str:
    """Return a key in words, `friction angle of weak`; the key itself for unknown kinds."""
    kind = str(document.get("kind"))
    return short(words_of(record_of(kind), key["key"]) if kind in KINDS else key["key"], most)


def _axis_name(document: Document, key: Document) -> str:
    name = _key_words(document, key)
    return f"{name} ({key['unit']})" if key["unit"] else name


def _with_unit(value: float, unit: str, digits: int) -> str:
    """A value of a key; lengths of so many digits are map coordinates."""
    text = millimetre(value) if unit == "m" and abs(value) >= _MAP_M else f"{value:.{digits}g}"
    return f"{text}°" if unit == "°" else f"{text} {unit}".strip()


def _draw_levels(axes: Any, document: Document) -> None:
    """The levels that lie near the factors, labelled at their ends."""
    scale = math.log10 if axes.get_yscale() == "log" else float
    low, high = (scale(end) for end in axes.get_ylim())
    levels = sorted((level["fos"], level["what"]) for level in document["levels"])
    visible_levels = [
        level
        for level in levels
        if abs(scale(level[0]) - (low + high) / 2.0) <= (0.5 + _NEAR) * (high - low)
    ]
    on_left = False
    for k, (value, label) in enumerate(visible_levels):  # labels of near ones on either side
        on_left = (
            not on_left
            and k > 0
            and scale(value) - scale(visible_levels[k - 1][0]) < _CLOSE * (high - low)
        )
        draw_level(axes, value, label, on_left=on_left)


def _draw_status_changes(axes: Any, document: Document) -> None:
    """The changes of status, upright, with what lies on both sides."""
    changes = document["changes"]
    for change in changes[:_MOST_MARKED]:
        lower_status, upper_status = (_BRIEF.get(status, status) for status in change["statuses"])
        draw_upright(
            axes,
            0.5 * sum(change["between"]),
            f"{lower_status} | {upper_status}",
            RED,
            style=":",
            foot=False,
        )
    if len(changes) > _MOST_MARKED:
        axes.plot(
            [],
            [],
            color=RED,
            linestyle=":",
            label=f"status changes (first {_MOST_MARKED} of {len(changes)})",
        )


def _inside(value: float | None, values: Sequence[float]) -> bool:
    return value is not None and min(values) <= value <= max(values)


def _bar_end(
    point: Point, method: Method, base: float, edges: tuple[float, float]
) -> tuple[float, str]:
    """Return the end of a bar and, where it has no number, why: the bar runs to an edge of the chart then."""
    factor, status = factor_at(point, method), status_of(point, method)
    if factor is not None and 0.0 < factor < math.inf:
        return factor, ""
    end = base if factor is None else min(max(factor, edges[0]), edges[1])
    return end, f"  {_BRIEF.get(status, status)}"


def _draw_bar(axes: Any, row: int, ends: Sequence[tuple[str, float, str]], base: float) -> None:
    """One bar: of its two ends what is written, where it lies, and why it has no number."""
    lengths = [end - base for _, end, _ in ends]
    for k, (text, end, reason) in enumerate(ends):
        above = (
            2.1 if abs(lengths[k]) < abs(lengths[1 - k]) else 2.0
        )  # the longer of two to one side lies beneath
        axes.barh([row], [lengths[k]], left=base, color=(SKY, BLUE)[k], height=0.62, zorder=above)
        is_leftward = lengths[k] < 0.0 or (lengths[k] == 0.0 and lengths[1 - k] > 0.0)
        note(
            axes,
            f"{text}{reason}",
            (end, row),
            (-4 if is_leftward else 4, 0),
            ha="right" if is_leftward else "left",
            va="center",
            zorder=3,
        )
