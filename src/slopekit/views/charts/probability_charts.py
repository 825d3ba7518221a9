"""The histogram of a study of probability (matplotlib), from its JSON. Needs the extra `plot`."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.orientation import number
from slopekit.views.charts.drawing import BLUE, DARK, RED, finish, nothing, title_of

Document = Mapping[str, Any]
_EQUAL = 1e-9
_LOW, _HIGH = "#e6a57e", "#a9c9e6"
_METHODS = {"closed-form": "closed form", "pre-ie": "PRE-IE"}


def draw_histogram(figure: Any, document: Document) -> None:
    """Factors of safety as bars and cumulated, the probability of failure with its confidence limits.

    Raises
    ------
    DesignError
        E273 where no sample has a factor of safety.
    """
    bins, asked = document["histogram"], document["probability_of_failure"]
    if bins is None:
        words = ", ".join(f"{name} {count}" for name, count in document["outcomes"].items())
        nothing(f"no sample has a factor of safety: {words}; the probability is {_percent(asked['all_samples'])}")
    edges, counts = np.array(bins["edges"], dtype=float), np.array(bins["counts"], dtype=float)
    target, share, fos = document["target"], asked["all_samples"], document["fos"]
    if fos["max"] - fos["min"] <= _EQUAL * abs(fos["max"]):
        edges, counts = np.full(2, fos["min"]), np.array([fos["samples"] - bins["below"]], dtype=float)
    figure.set_size_inches(9.0, 6.4)
    axes = figure.subplots()
    _bars(axes, edges, counts, target)
    axes.axvline(target, color=DARK, linewidth=1.6, label=f"target, FoS {number(target)}")
    axes.set_xlabel(f"factor of safety ({_METHODS.get(document['by'], document['by'])})")
    axes.set_ylabel("samples in a bar")
    axes.set_ylim(0.0, 1.08 * max(1.0, counts.max()))
    right = axes.twinx()
    _cumulated(right, bins, edges, counts, share, target)
    right.set_ylim(0.0, 108.0)
    right.set_ylabel("samples with a lower factor, % of all (line)")
    finish(figure, axes, f"{title_of(document)}\n{_words(document)}", size=9.5)


def _bars(axes: Any, edges: Floats, counts: Floats, target: float) -> None:
    """Bars, in two colours on both sides of the target; equal factors as one narrow bar."""
    low, high = edges[:-1], edges[1:]
    if low[0] == high[-1]:
        value, reach = float(low[0]), 0.02 * max(abs(float(low[0])), 1e-3)
        low, high = low - reach / 4.0, high + reach / 4.0
        axes.set_xlim(min(value, target) - 5.0 * reach, max(value, target) + 5.0 * reach)
    for start, end, colour, name in (
        (low, np.minimum(high, target), _LOW, "below the target"), (np.maximum(low, target), high, _HIGH, "above"),
    ):  # fmt: skip
        some = (end > start) & (counts > 0)
        axes.bar(start[some], counts[some], width=(end - start)[some], align="edge", color=colour, edgecolor="white",
                 linewidth=0.4, label=name if some.any() else None, zorder=1.5)  # fmt: skip


def _cumulated(
    axes: Any, bins: Document, edges: Floats, counts: Floats, share: Document, target: float
) -> None:  # fmt: skip
    """The share of samples that fail at a lower factor, from the bins, and the probability with its limits on it."""
    if share["of"]:
        without = bins.get("failing_without_factor") or 0
        passed = 100.0 * (without + bins["below"] + np.concatenate([[0.0], np.cumsum(counts)])) / share["of"]
        axes.plot(edges, passed, color=BLUE, linewidth=1.6, label="cumulated")
    if share["probability"] is not None:
        middle, low, high = (100.0 * share[key] for key in ("probability", "low", "high"))
        axes.errorbar([target], [middle], yerr=[[max(0.0, middle - low)], [max(0.0, high - middle)]], color=RED,
                      marker="D", markersize=6, markerfacecolor="white", capsize=6, linewidth=1.8, zorder=5,
                      label=f"P(FoS < {number(target)}), {share['confidence'] * 100:.4g} % limits")  # fmt: skip


def _words(document: Document) -> str:
    asked, bins = document["probability_of_failure"], document["histogram"]
    every, forming = asked["all_samples"], asked["samples_that_form_a_block"]
    lines = [f"P(FoS < {number(document['target'])}) = {_percent(every)}, {every['limits_by']}"]
    lead = document.get("leading")
    if lead is not None and lead["probability"] != every["probability"]:
        shown = (f"{100.0 * lead[key]:.3g}" for key in ("probability", "low", "high"))
        lines.insert(0, "{} % ({} to {} %), {}; by the closed form".format(*shown, lead["by"]))
    if forming["of"] != every["of"]:
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
