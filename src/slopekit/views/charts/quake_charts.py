"""The charts of a study of earthquakes (matplotlib), from its JSON: motion over time.

Needs the extra `plot`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from slopekit.views.charts.drawing import BLUE, DARK, GREEN, GREY, RED, dressed, short

_MORE = 1.15  # of the time until the block is at rest: what is shown of a long quiet end


def draw_motion(figure: Any, document: Mapping[str, Any]) -> None:
    """Acceleration against k_y, sliding velocity and displacement in the record that moves the block most."""
    motion = document["motion"]
    t, a = np.array(motion["t_s"], dtype=float), np.array(motion["a_g"], dtype=float)
    v, d = np.array(motion["v_m_s"], dtype=float), 100.0 * np.array(motion["d_m"], dtype=float)
    figure.set_size_inches(9.0, 7.2)
    above, middle, below = figure.subplots(3, 1, sharex=True)
    above.plot(t, a, color=DARK, linewidth=0.8)
    k = document["yield"][0]["coefficient"]
    if k is not None:
        above.axhline(k, color=RED, linewidth=1.0, linestyle="--")
        above.annotate(f"k_y {k:.4g}", (0.995, k), xycoords=("axes fraction", "data"), ha="right", va="bottom",
                       fontsize=8, color=RED)  # fmt: skip
        above.fill_between(t, a, k, where=a > k, color=RED, alpha=0.25, linewidth=0.0, interpolate=True)
    above.set_ylabel("acceleration out of the slope, g")
    middle.plot(t, v, color=BLUE, linewidth=1.1)
    middle.set_ylabel("sliding, m/s")
    below.plot(t, d, color=GREEN, linewidth=1.4)
    below.set_ylabel("displacement, cm")
    below.set_xlabel("time, s")
    for axes in (above, middle, below):
        dressed(axes)
    moving = np.flatnonzero(v > 0.0)
    if len(moving):
        below.set_xlim(t[0], min(t[-1], t[0] + _MORE * (t[moving[-1]] - t[0])))
    factor = document["yield"][0]["factor"]
    said = "factor 1 (plain Newmark)" if factor is None else f"factor {factor:.3f}"
    above.set_title(f"{short(str(motion['record']), 60)}, {motion['way']}: {said}", fontsize=10.5)
    most = max((max(one["as_recorded_m"], one["reversed_m"]) for one in document["records"]), default=0.0)
    below.annotate(f"{100.0 * most:.4g} cm in all", (0.01, 0.92), xycoords="axes fraction", va="top", fontsize=8.5,
                   color=GREY)  # fmt: skip
