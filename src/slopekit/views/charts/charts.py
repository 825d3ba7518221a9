"""Charts of a design and of its studies (matplotlib), each from their JSON. Need the extra `plot`.

What accuracy costs, what reducing does (figure 7 of Sheng et al. 2023), how factors scatter, what a bench loses, how a
block slides in an earthquake.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import number
from slopekit.core.sheet import factor_text
from slopekit.kinds.single_block.ladders import METHODS
from slopekit.views.charts.drawing import (
    BLUE,
    COLOURS,
    DARK,
    GREEN,
    GREY,
    MARKERS,
    RED,
    draw_level,
    draw_upright,
    finish,
    note,
    refuse_empty_chart,
    short,
    title_of,
)

Document = Mapping[str, Any]
#: What an error that rounds to nothing is drawn as: the bottom of the chart, with an open marker.
FLOOR = 1e-16
_EQUAL_FACTORS = 1e-9  # of the largest factor: all are the same
_METHOD_NAMES = {"closed-form": "closed form", "pre-ie": "PRE-IE"}
_MOST_CURVES = 24
_DASHES = ("-", "--", ":", "-.")
_TIME_MARGIN = 1.15  # of the time until the block is at rest: what is shown of a long quiet end


def draw_speed_errors(figure: Any, document: Document) -> None:
    """Time against error of the ladder of a check, both logarithmic, a line for each method.

    Raises
    ------
    DesignError
        E273 where the design has no factor of safety, or no rung an error.
    """
    reference, against = document["reference"]["value"], document["reference"]["what"]
    if reference is None:
        refuse_empty_chart("the design has no factor of safety")
    reference_factor = (
        None if against == "the closed form" else reference
    )  # a rung against itself has no error
    axes = figure.subplots()
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="time, s",
        ylabel=f"relative error against {against} (open: none to 16 digits)",
    )
    rungs = list(zip(document["ladder"], document["timing_s"]["ladder"], strict=True))
    for (method, name), colour, marker in zip(METHODS.items(), COLOURS, MARKERS, strict=False):
        points = [
            (time["seconds"], max(abs(rung["error"]), FLOOR), rung["node_pairs"])
            for rung, time in rungs
            if rung["method"] == method
            and rung["error"] is not None
            and not (rung["error"] == 0.0 and rung["fos"] == reference_factor)
        ]
        if points:
            axes.plot(*list(zip(*points, strict=True))[:2], color=colour, marker=marker, label=name)
        for x, y, pairs in points:
            if y <= FLOOR:
                axes.plot(
                    [x], [y], color=colour, marker=marker, markerfacecolor="white", linestyle="none"
                )
            if method == "mesh":
                note(axes, f"{pairs}", (x, y), (7, 4), color=colour)
    if not axes.lines:
        refuse_empty_chart("no rung of the ladder has an error")
    draw_level(axes, document["agree_within"], f"wanted: {document['agree_within']:g}")
    factor = factor_text(document["fos"]["limit"]).strip()
    finish(
        figure,
        axes,
        f"{short(document['title'] or document['kind'])}: {document['status']}, limit {factor}",
    )


def _failed_pair_curve(steps: Sequence[Document]) -> tuple[list[float], list[float]]:
    """Factors, and how many node pairs failed at them."""
    return [step["factor"] for step in steps], [step["failed_pairs"] for step in steps]


def draw_reduction(figure: Any, document: Document) -> None:
    """Displacement (left) and failed node pairs (right) against the strength reduction factor; the limit upright.

    Raises
    ------
    DesignError
        E273 where no factor was looked at.
    """
    series, all_pairs_steps = (
        document.get("series") or [],
        (document.get("all_pairs") or {}).get("history") or [],
    )
    if not series and not all_pairs_steps:
        refuse_empty_chart("no strength reduction factor was looked at")
    from matplotlib.ticker import MaxNLocator

    pair_count = document["model"]["node_pairs"]
    axes = figure.subplots()
    right = axes.twinx()
    right.grid(visible=False)
    displacements = [
        (step["factor"], math.hypot(*step["displacement_m"]))
        for step in series
        if step["displacement_m"]
    ]
    if displacements:
        in_mm = max(size for _, size in displacements) < 1.0
        axes.plot(
            [factor for factor, _ in displacements],
            [size * (1e3 if in_mm else 1.0) for _, size in displacements],
            color=BLUE,
            marker="o",
            label="displacement of the centroid",
            zorder=3,
        )
        axes.set_ylabel(f"displacement of the centroid, {'mm' if in_mm else 'm'}", color=BLUE)
        axes.set_ylim(bottom=0.0)
    else:
        axes.set_yticks([])
    stable_steps = [step for step in series if step["stands"]]
    unstable_steps = [step for step in series if not step["stands"]]
    for steps, style, label in (
        (
            all_pairs_steps,
            {"color": DARK, "marker": ".", "linestyle": ":"},
            "failed node pairs, all-pairs search",
        ),
        (stable_steps, {"color": RED, "marker": "s", "linestyle": "--"}, "failed node pairs"),
        (
            unstable_steps,
            {"color": RED, "marker": "x", "linestyle": "none"},
            "no longer stands: all count as failed",
        ),
    ):
        if steps:
            right.plot(*_failed_pair_curve(steps), label=label, **style)
    right.axhline(pair_count, color=GREY, linestyle=":")
    right.set_ylim(0.0, 1.12 * pair_count)
    right.set_ylabel(f"failed node pairs, of {pair_count}", color=RED if series else DARK)
    right.set_yticks(
        [
            tick
            for tick in MaxNLocator(integer=True).tick_values(0, pair_count)
            if 0 <= tick <= pair_count
        ]
    )
    fos = document["fos"]
    lines = [("limit", fos["limit"], "-"), ("all pairs failed", fos["all_pairs_failed"], "-.")]
    limit_lines = sorted(
        (line for line in lines if line[1] is not None), key=lambda line: float(line[1])
    )
    for k, (name, value, dashes) in enumerate(
        limit_lines
    ):  # the label of the smaller at the left of its line
        draw_upright(axes, value, f"{name} {value:.4g}", style=dashes, on_left=k == 0)
    axes.set_xlabel("strength reduction factor")
    finish(figure, axes, title_of(document))


# -- of samples -------------------------------------------------------------------------------------------------------


def draw_histogram(figure: Any, document: Document) -> None:
    """Factors of safety as bars and cumulated, the probability of failure with its confidence limits.

    Raises
    ------
    DesignError
        E273 where no sample has a factor of safety.
    """
    bins, share = document["histogram"], document["probability_of_failure"]["all_samples"]
    if bins is None:
        words = ", ".join(f"{name} {count}" for name, count in document["outcomes"].items())
        refuse_empty_chart(
            f"no sample has a factor of safety: {words}; the probability is {_percent(share)}"
        )
    edges, counts = np.array(bins["edges"], dtype=float), np.array(bins["counts"], dtype=float)
    target, fos = document["target"], document["fos"]
    if fos["max"] - fos["min"] <= _EQUAL_FACTORS * abs(fos["max"]):
        edges, counts = (
            np.full(2, fos["min"]),
            np.array([fos["samples"] - bins["below"]], dtype=float),
        )
    axes = figure.subplots()
    _bars(axes, edges, counts, target)
    axes.axvline(target, color=DARK, label=f"target, FoS {number(target)}")
    axes.set(
        xlabel=f"factor of safety ({_METHOD_NAMES.get(document['by'], document['by'])})",
        ylabel="samples in a bar",
    )
    right = axes.twinx()
    right.grid(visible=False)
    right.set_ylabel("samples with a lower factor, % of all (line)")
    if share["of"]:
        failing = (bins.get("failing_without_factor") or 0) + bins["below"]
        passed = 100.0 * (failing + np.concatenate([[0.0], np.cumsum(counts)])) / share["of"]
        right.plot(edges, passed, color=BLUE, label="cumulated")
    if share["probability"] is not None:
        middle, low, high = (100.0 * share[key] for key in ("probability", "low", "high"))
        right.errorbar(
            [target],
            [middle],
            yerr=[[max(0.0, middle - low)], [max(0.0, high - middle)]],
            color=RED,
            marker="D",
            markerfacecolor="white",
            zorder=5,
            label=f"P(FoS < {number(target)}), {share['confidence'] * 100:.4g} % limits",
        )
    right.set_ylim(0.0, 108.0)
    finish(figure, axes, f"{title_of(document)}\n{_probability_summary(document)}")


def _bars(axes: Any, edges: Floats, counts: Floats, target: float) -> None:
    """Bars, in two colours on both sides of the target; equal factors as one narrow bar."""
    low, high = edges[:-1], edges[1:]
    if low[0] == high[-1]:
        value, reach = float(low[0]), 0.02 * max(abs(float(low[0])), 1e-3)
        low, high = low - reach / 4.0, high + reach / 4.0
        axes.set_xlim(min(value, target) - 5.0 * reach, max(value, target) + 5.0 * reach)
    for start, end, colour, name in (
        (low, np.minimum(high, target), RED, "below the target"),
        (np.maximum(low, target), high, BLUE, "above"),
    ):
        is_filled = (end > start) & (counts > 0)
        axes.bar(
            start[is_filled],
            counts[is_filled],
            width=(end - start)[is_filled],
            align="edge",
            color=colour,
            edgecolor="white",
            alpha=0.5,
            label=name if is_filled.any() else None,
        )


def _probability_summary(document: Document) -> str:
    estimates, bins = document["probability_of_failure"], document["histogram"]
    all_samples, forming = estimates["all_samples"], estimates["samples_that_form_a_block"]
    lines = [
        f"P(FoS < {number(document['target'])}) = {_percent(all_samples)}, {all_samples['limits_by']}"
    ]
    closed_form = estimates.get("closed_form")
    if closed_form is not None and closed_form["probability"] != all_samples["probability"]:
        lines.append(f"by the closed form, forces only: {_percent(closed_form)}")
    if forming["of"] != all_samples["of"]:
        lines.append(f"of those that form a block: {_percent(forming)}")
    lines.append(f"{document['n']} samples, {document['fos']['samples']} with a factor of safety")
    if bins["below"] or bins["above"]:
        lines[-1] += f"; beyond the bars: {bins['below']} lower, {bins['above']} higher"
    return "\n".join(lines)


def _percent(share: Document) -> str:
    if share["probability"] is None or not math.isfinite(share["probability"]):
        return "unknown (no samples)"
    middle, low, high = (f"{100.0 * share[key]:.3g}" for key in ("probability", "low", "high"))
    return f"{middle} % ({low} to {high} % at {share['confidence'] * 100:.4g} % confidence)"


# -- of benches -------------------------------------------------------------------------------------------------------


def draw_backbreak(figure: Any, document: Document) -> None:
    """Backbreak against the share of the length that loses no more, a curve for each bench.

    The colour stands for the face angle, the style of the line for the height.
    """
    from matplotlib import colormaps

    axes = figure.subplots()
    survey, inputs, benches = document["survey"], document["inputs"], document["benches"]
    heights = sorted({bench["height_m"] for bench in benches})
    dips = sorted({bench["face_dip_deg"] for bench in benches})
    shades = colormaps["viridis"](np.linspace(0.0, 0.88, len(dips)))
    for bench in benches:
        height, dip = bench["height_m"], bench["face_dip_deg"]
        values = np.array(bench["backbreak_curve_m"], dtype=float)
        label = f"{number(height)} m, {number(dip)}°" if len(benches) <= _MOST_CURVES else None
        axes.step(
            values,
            np.linspace(0.0, 100.0, len(values)),
            where="post",
            color=shades[dips.index(dip)],
            linestyle=_DASHES[heights.index(height) % len(_DASHES)],
            label=label,
        )
    axes.set(
        xlabel="backbreak: crest lost, m",
        ylabel="length of bench that loses no more, %",
        ylim=(0.0, 101.0),
    )
    axes.set_xlim(left=0.0)
    draw_level(
        axes,
        100.0 * inputs["reliability"],
        f"{number(100.0 * inputs['reliability'])} % wanted",
        RED,
    )
    title = (
        f"{short(str(survey['name']), 50)}: {survey['joints']} joints, faces toward "
        f"{inputs['dip_direction_deg']:03.0f}"
    )
    finish(
        figure,
        axes,
        f"{title} (sha {document['input_sha256'][:6]})\nbackbreak along the bench",
        columns=4,
    )


# -- of earthquakes ---------------------------------------------------------------------------------------------------


def draw_motion(figure: Any, document: Document) -> None:
    """Acceleration against k_y, sliding velocity and displacement in the record that moves the block most."""
    motion = document["motion"]
    t, a = np.array(motion["t_s"], dtype=float), np.array(motion["a_g"], dtype=float)
    v, d = np.array(motion["v_m_s"], dtype=float), 100.0 * np.array(motion["d_m"], dtype=float)
    above, middle, below = figure.subplots(3, 1, sharex=True)
    for axes, values, colour, label in (
        (above, a, DARK, "acceleration\nout of the slope, g"),
        (middle, v, BLUE, "sliding, m/s"),
        (below, d, GREEN, "displacement, cm"),
    ):
        axes.plot(t, values, color=colour)
        axes.set_ylabel(label)
    k = document["yield"][0]["coefficient"]
    if k is not None:
        draw_level(above, k, f"k_y {k:.4g}", RED)
        above.fill_between(
            t, a, k, where=a > k, color=RED, alpha=0.25, linewidth=0.0, interpolate=True
        )
    below.set_xlabel("time, s")
    moving = np.flatnonzero(v > 0.0)
    if len(moving):
        below.set_xlim(t[0], min(t[-1], t[0] + _TIME_MARGIN * (t[moving[-1]] - t[0])))
    factor = document["yield"][0]["factor"]
    factor_words = "factor 1 (plain Newmark)" if factor is None else f"factor {factor:.3f}"
    above.set_title(f"{short(str(motion['record']), 60)}, {motion['way']}: {factor_words}")
    most = max(
        (max(record["as_recorded_m"], record["reversed_m"]) for record in document["records"]),
        default=0.0,
    )
    note(
        below,
        f"{100.0 * most:.4g} cm in all",
        (0.0, 1.0),
        (5, -5),
        xycoords="axes fraction",
        va="top",
    )
