"""Pictures of sweeps (matplotlib), from their JSON: a curve, a contour, a tornado. Need the extra `plot`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from slopekit.core.orientation import millimetre
from slopekit.core.sheet import is_number
from slopekit.design.fields import words_of
from slopekit.design.registry import KINDS, record_of
from slopekit.studies.points import Line, Method, Point, asked_of, factor_at, lines_of, lower_of
from slopekit.studies.words import METHODS, cell
from slopekit.views.charts.drawing import (
    BLUE,
    BOX,
    DARK,
    GREY,
    RED,
    finish,
    hide_cut,
    logarithmic,
    note,
    nothing,
    short,
    stretches,
    title_of,
)  # fmt: skip

Document = Mapping[str, Any]
_LOW, _HIGH = "#8fb8de", "#1f5a94"
_WIDE = 10.0  # factors that span more are drawn on a logarithmic axis
_MOST_MARKED = 8  # changes of status that are labelled
_MOST_BARS = 25
_MAP_M = 1e5  # lengths from here on are coordinates of a map
_MOST_DOTS = 900  # points of a grid that are marked
_FEWEST = 3  # values of each key that bands can be drawn between
_TOO_FEW = "too few points have a factor of safety"
_NOW: dict[str, Any] = {
    "marker": "*", "markersize": 13, "color": DARK, "markerfacecolor": "white", "linestyle": "none", "clip_on": False,
    "zorder": 5, "label": "the design as it is",
}  # fmt: skip
_BRIEF = {
    "slides_on_both": "both planes", "slides_on_J1": "J1", "slides_on_J2": "J2", "no_driving_force": "nothing drives",
    "slides_up": "up", "not_converged": "no convergence", "slides_on_basal": "basal", "slides_on_J1_and_J2": "J1, J2",
    "slides_on_J1_and_basal": "J1, basal", "slides_on_J2_and_basal": "J2, basal",
}  # fmt: skip


def _read(document: Document) -> tuple[list[Line], tuple[Method, ...]]:
    """The points of a sweep as `lines_of` has them, and the methods that were asked and are there."""
    points, values = [Point.from_record(one) for one in document["points"]], [key["values"] for key in document["keys"]]
    needed = math.prod(map(len, values))
    if len(points) != needed:
        raise ValueError(f"{len(points)} points for {needed} values")
    return lines_of(points, *values), asked_of(document["methods"], points)


def draw_curve(figure: Any, document: Document) -> None:
    """Factors against the value of one key; changes of status upright, levels across, points without a number below.

    Raises
    ------
    DesignError
        E273 without a point to draw; so do the others.
    """
    ((_, points),), asked = _read(document)
    (key,) = document["keys"]
    drawn = {method: [(value, factor_at(point, method)) for value, point in points] for method in asked}
    besides = [(value, point.also) for value, point in points]
    known = next((also for _, also in besides if also is not None), None)
    of_also = [(value, None if also is None else also.factor) for value, also in besides]
    axes = _axes(figure, [factor for line in (*drawn.values(), of_also) for _, factor in line])
    both = len(asked) > 1  # the closed form lies under PRE-IE, wider: where they agree both are seen
    styles: dict[Method, dict[str, Any]] = {
        "closed_form": {"color": RED, "linewidth": 6.0 if both else 1.4, "alpha": 0.35 if both else 1.0,
                        "marker": "" if both else "o", "markersize": 5.0, "solid_capstyle": "round"},
        "pre_ie": {"color": BLUE, "linewidth": 1.4, "marker": "o", "markersize": 5.0},
    }  # fmt: skip
    for method in reversed(asked):
        for stretch in stretches(drawn[method]):
            axes.plot(*zip(*stretch, strict=True), **styles[method])
        axes.plot([], [], **styles[method], label=METHODS[method])
    if known is not None:
        style = {"color": DARK, "linewidth": 1.4, "linestyle": "--", "marker": "s", "markersize": 4.0}
        for stretch in stretches(of_also):
            axes.plot(*zip(*stretch, strict=True), **style)
        axes.plot([], [], **style, label=f"{known.BRIEF} (W507)")
    _moments(axes, points)
    _levels(axes, document)
    _bare(axes, [(value, factor_at(point, asked[0]), point) for value, point in points])
    _statuses(axes, document)
    passes = [one for one in document["critical"] if one["method"] == asked[0] and one["at"] is not None]
    for one in passes:
        at, level = one["at"], one["fos"]
        axes.plot([at], [level], marker="D", color=DARK, markerfacecolor="white", markersize=7.0, zorder=4)
        note(axes, _with_unit(at, key["unit"], 4), (at, level), (6, 7), fontsize=8.5, color=DARK, zorder=4)
    if passes:
        axes.plot([], [], color=DARK, marker="D", markerfacecolor="white", linestyle="none",
                  label="passes the level (interpolated)")  # fmt: skip
    own = dict(drawn[asked[0]]).get(key["now"])
    if own is not None and is_number(own):
        axes.plot([key["now"]], [own], **_NOW)
    axes.set_xlabel(_name(document, key))
    axes.set_ylabel("factor of safety")
    _finish(figure, axes, document, f"factor of safety over {_words(document, key)}")


def draw_contour(figure: Any, document: Document) -> None:
    """The factor over two keys: contours, the levels as thick lines, points without a number as crosses.

    With less than three values of a key there is nothing to draw bands from: a curve for each of them is drawn instead.
    """
    import numpy as np

    first, second = document["keys"]
    if min(len(key["values"]) for key in (first, second)) < _FEWEST:
        nothing("contours need three values of each key: give more, or sweep one key")
    lines, (method, *_) = _read(document)
    lines.sort(key=lambda line: line[0] or 0.0)
    across, down = [value for value, _ in lines[0][1]], [line or 0.0 for line, _ in lines]
    factors = np.array(
        [[np.nan if (f := lower_of(point, method)) is None else f for _, point in points] for _, points in lines]
    )
    finite = factors[np.isfinite(factors) & (factors > 0.0)]
    if finite.size < _FEWEST:
        nothing(_TOO_FEW)
    axes = figure.subplots()
    from matplotlib.colors import Normalize, TwoSlopeNorm
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import MaxNLocator

    wanted = [level["fos"] for level in document["levels"]]
    low, high = float(finite.min()), min(float(finite.max()), 3.0 * max(*wanted, float(np.median(finite))))
    shown = np.clip(np.where(np.isinf(factors), high * 1.01, factors), low * 0.99, high * 1.01)
    steps: Any = MaxNLocator(nbins=14).tick_values(low, high)
    if not (len(steps) > 1 and high > low):
        steps = np.array([low - 0.1, low, low + 0.1])
    norm = TwoSlopeNorm(1.0, low, high) if low < 1.0 < high else Normalize(low, high)
    colours = "RdYlBu" if low < 1.0 < high else "YlGnBu" if low >= 1.0 else "YlOrRd_r"
    filled = axes.contourf(across, down, shown, levels=steps, cmap=colours, norm=norm, extend="both")
    between = [step for step in steps if all(abs(step - level) > 0.01 * level for level in wanted)]
    thin = axes.contour(across, down, shown, levels=between, colors="#555555", linewidths=0.5)
    labels = axes.clabel(thin, fontsize=7.5, fmt="%.4g", colors="black")
    for label in labels:
        label.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
    for level, colour in zip(document["levels"], (RED, DARK, BLUE, GREY), strict=False):
        if low < level["fos"] < high:
            axes.contour(across, down, shown, levels=[level["fos"]], colors=[colour], linewidths=2.2)
            axes.plot([], [], color=colour, linewidth=2.2, label=level["what"])
    known = next((point.also for _, points in lines for _, point in points if point.also), None)
    also = "" if known is None else f", or {known.BRIEF} where lower"
    figure.colorbar(filled, ax=axes, label=f"factor of safety ({METHODS[method]}{also})")
    _grid_points(axes, method, down, lines)
    if _inside(first["now"], across) and _inside(second["now"], down):
        axes.plot([first["now"]], [second["now"]], **_NOW)
    axes.set_xlabel(_name(document, first))
    axes.set_ylabel(_name(document, second))
    axes.set_xlim(min(across), max(across))
    axes.set_ylim(min(down), max(down))
    what = f"factor of safety over {_words(document, first, 40)} and {_words(document, second, 40)}"
    _finish(figure, axes, document, what, margins=False)
    hide_cut(figure, axes, labels)


#: A number in words, its two ends as they are shown, the points there, and the swing by each method.
_TornadoBar: TypeAlias = tuple[str, Sequence[str], list[Point], Document]


def draw_tornado(figure: Any, document: Document) -> None:
    """A bar for each number from its factor at one end to that at the other, the longest on top."""
    own = Point.from_record(document["base"])
    asked = asked_of(document["methods"], [own])
    method = asked[0]
    base = factor_at(own, method)
    every: list[_TornadoBar] = [
        (_words(document, bar, 40), _shown(bar), [Point.from_record(bar[end]) for end in ("at_low", "at_high")],
         bar["swing"])
        for bar in document["bars"]
    ]  # fmt: skip
    moving = [bar for bar in every if bar[3][method] != 0.0]
    bars = moving[:_MOST_BARS]
    ends = [f for bar in bars for point in bar[2] if (f := factor_at(point, method)) is not None]
    finite = [f for f in ends if math.isfinite(f)]
    if base is None or not math.isfinite(base) or not bars or not finite:
        nothing(_TOO_FEW)
    figure.set_size_inches(9.0, 2.6 + 0.36 * len(bars))
    axes = figure.subplots()
    low, high = min([base, *finite]), max([base, *finite])
    room = (high - low) or 0.1
    for row, bar in enumerate(bars):
        _tornado_bar(axes, bar, row, method, base, (low - 0.05 * room, high + 0.05 * room))
    if len(asked) > 1:
        for row, bar in enumerate(bars):
            ticks = [factor_at(point, "closed_form") for point in bar[2]]
            drawn = [f for f in ticks if f is not None and math.isfinite(f) and f > 0.0]
            axes.plot(drawn, [row] * len(drawn), marker="|", markersize=17, color=RED, linestyle="none", zorder=4)
        axes.plot([], [], marker="|", markersize=12, color=RED, linestyle="none", label="closed form")
    axes.plot([], [], color=_LOW, linewidth=8, label="at the lower end")
    axes.plot([], [], color=_HIGH, linewidth=8, label="at the upper end")
    axes.axvline(base, color=DARK, linewidth=1.2)
    axes.axvline(1.0, color=GREY, linestyle="--", linewidth=1.0) if low - room < 1.0 < high + room else None
    axes.set_yticks(range(len(bars)), [bar[0] for bar in bars])
    axes.set_ylim(len(bars) - 0.4, -0.6)
    axes.set_xlim(low - 0.22 * room, high + 0.22 * room)
    left = len(moving) - len(bars)
    more = f"; {left} smaller ones left out" if left > 0 else ""
    said = f"factor of safety ({METHODS[method]}); upright line: {cell(base)} now{more}"
    axes.set_xlabel(f"{said}\n{document['rule']}", fontsize=8.5, loc="right")  # under the names, too
    _finish(figure, axes, document, "what each number does to the factor of safety", margins=False)


# -- parts ------------------------------------------------------------------------------------------------------------


def _axes(figure: Any, factors: Sequence[float | None]) -> Any:
    """Axes for factors, logarithmic where they span much."""
    numbers = [factor for factor in factors if factor is not None and 0.0 < factor < math.inf]
    if not numbers:
        nothing(_TOO_FEW)
    axes = figure.subplots()
    if max(numbers) > _WIDE * min(numbers):
        logarithmic(axes)
    return axes


def _finish(figure: Any, axes: Any, document: Document, what: str, margins: bool = True) -> None:
    if margins:
        axes.margins(x=0.04, y=0.08)
    finish(figure, axes, f"{title_of(document)}\n{what}", 4, 10)


def _words(document: Document, key: Document, most: int = 60) -> str:
    """What a key is, `friction angle of weak`; the key itself of a kind that is not known here."""
    kind = str(document.get("kind"))
    return short(words_of(record_of(kind), key["key"]) if kind in KINDS else key["key"], most)


def _name(document: Document, key: Document) -> str:
    name = _words(document, key)
    return f"{name} ({key['unit']})" if key["unit"] else name


def _shown(bar: Document) -> Sequence[str]:
    """The ends with their unit."""
    return bar.get("shown") or [_with_unit(bar[end], bar["unit"], 5) for end in ("low", "high")]


def _with_unit(value: float, unit: str, digits: int) -> str:
    """A value of a key; lengths of so many digits are map coordinates."""
    text = millimetre(value) if unit == "m" and abs(value) >= _MAP_M else f"{value:.{digits}g}"
    return f"{text}°" if unit == "°" else f"{text} {unit}".strip()


def _moments(axes: Any, points: Sequence[tuple[float, Point]]) -> None:
    governed = [(v, p.factors.limit) for v, p in points if p.factors and p.moments_govern and p.factors.limit]
    if governed:
        axes.plot(*zip(*governed, strict=True), marker="o", markersize=9.0, markerfacecolor="none", color=BLUE,
                  linestyle="none", label="moments govern")  # fmt: skip
    wrong = [(v, p.factors.factor) for v, p in points if p.factors and p.factors.agree is False and p.factors.factor]
    if wrong:
        axes.plot(*zip(*wrong, strict=True), marker="o", markersize=13.0, markerfacecolor="none", color=RED,
                  markeredgewidth=1.6, linestyle="none", label="the methods disagree")  # fmt: skip


def _levels(axes: Any, document: Document) -> None:
    scale = math.log10 if axes.get_yscale() == "log" else float
    low, high = (scale(end) for end in axes.get_ylim())
    room, last, on_left = high - low, -math.inf, False
    for level, what in sorted((level["fos"], level["what"]) for level in document["levels"]):
        if low - 0.15 * room <= scale(level) <= high + 0.15 * room:
            on_left = not on_left if scale(level) - last < 0.05 * room else False  # labels of near ones on either side
            axes.axhline(level, color=GREY, linestyle="--", linewidth=1.0, zorder=1)
            axes.annotate(what, (0.005 if on_left else 0.995, level), xycoords=("axes fraction", "data"),
                          ha="left" if on_left else "right", va="bottom", fontsize=8, color="#555555", bbox=BOX,
                          zorder=1.9)  # fmt: skip
            last = scale(level)


def _bare(axes: Any, points: Sequence[tuple[float, float | None, Point]]) -> None:
    """Points without a number: at the top where nothing drives, at the bottom where nothing holds or there is none."""
    kinds = [
        ([v for v, f, _ in points if f is not None and math.isinf(f)], 0.98, "^", BLUE, "nothing drives: no number"),
        ([v for v, f, _ in points if f == 0.0], 0.02, "v", RED, "nothing holds: no number"),
        ([v for v, f, p in points if f is None and p.factors is None], 0.02, "x", DARK, "no block, or bad input"),
        ([v for v, f, p in points if f is None and p.factors is not None], 0.02, "P", RED, "no convergence"),
    ]
    for values, height, marker, colour, label in kinds:
        if values:
            axes.plot(values, [height] * len(values), marker=marker, color=colour, linestyle="none", clip_on=False,
                      transform=axes.get_xaxis_transform(), label=label)  # fmt: skip


def _statuses(axes: Any, document: Document) -> None:
    """The changes of status, upright, with what lies on both sides."""
    changes = document["changes"]
    for change in changes[:_MOST_MARKED]:
        at = 0.5 * sum(change["between"])
        one, other = (_BRIEF.get(status, status) for status in change["statuses"])
        axes.axvline(at, color=RED, linestyle=":", linewidth=1.2)
        note(axes, f"{one} | {other}", (at, 0.98), (-3, 0), xycoords=("data", "axes fraction"), rotation=90,
             ha="right", va="top", color=RED)  # fmt: skip
    if len(changes) > _MOST_MARKED:
        axes.plot([], [], color=RED, linestyle=":", label=f"status changes (first {_MOST_MARKED} of {len(changes)})")


def _grid_points(axes: Any, method: Method, down: Sequence[float], lines: Sequence[Line]) -> None:
    every = [(x, y, point) for y, (_, points) in zip(down, lines, strict=True) for x, point in points]
    if len(every) <= _MOST_DOTS:
        axes.plot([x for x, _, _ in every], [y for _, y, _ in every], "o", color="white", markersize=3.4, zorder=3,
                  markeredgecolor=DARK, markeredgewidth=0.8, clip_on=False, label="computed")  # fmt: skip
    bare = [(x, y) for x, y, point in every if (f := factor_at(point, method)) is None or f == 0.0 or math.isinf(f)]
    if bare:
        axes.plot(*zip(*bare, strict=True), "x", color=DARK, markersize=5.0, clip_on=False,
                  label="no factor: status or code")  # fmt: skip
    moments = [(x, y) for x, y, point in every if point.moments_govern]
    if moments:
        axes.plot(*zip(*moments, strict=True), "o", color=BLUE, markerfacecolor="none", label="moments govern")
    wrong = [(x, y) for x, y, point in every if point.agree is False]
    if wrong:
        axes.plot(*zip(*wrong, strict=True), "s", color=RED, markerfacecolor="none", markersize=9.0,
                  label="the methods disagree")  # fmt: skip


def _inside(value: float | None, values: Sequence[float]) -> bool:
    return value is not None and min(values) <= value <= max(values)


def _tornado_bar(
    axes: Any, bar: _TornadoBar, row: int, method: Method, base: float, room: tuple[float, float]
) -> None:  # fmt: skip
    """One bar; an end without a number runs to the edge of the chart and says why."""
    _, texts, points, _ = bar
    ends = []
    for point in points:
        factor = factor_at(point, method)
        ends.append(base if factor is None else min(max(factor, room[0]), room[1]))
    for k, (shown, point, colour) in enumerate(zip(texts, points, (_LOW, _HIGH), strict=True)):
        factor, end, other = factor_at(point, method), ends[k], ends[1 - k]
        bare = factor is None or not math.isfinite(factor) or factor == 0.0
        above = 2.1 if abs(end - base) < abs(other - base) else 2.0  # the longer of two to one side lies beneath
        axes.barh([row], [end - base], left=base, color=colour, height=0.62, zorder=above)
        left = end < base or (end == base and (other > base or (other == base and k == 0)))
        said = shown + (f"  {_said(point, method)}" if bare else "")
        note(axes, said, (end, row), (-4 if left else 4, 0), fontsize=7.5, ha="right" if left else "left",
             va="center", color=DARK, zorder=3)  # fmt: skip


def _said(point: Point, method: Method) -> str:
    factors = point.factors
    if factors is None:
        return point.code
    status = factors.status if method == "pre_ie" else factors.closed_status or ""
    return _BRIEF.get(status, status)
