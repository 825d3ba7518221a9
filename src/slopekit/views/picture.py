"""A scene before it is drawn: layers, legend, colour bar, words; and the colours that all scenes share."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from slopekit.arrays import Floats, Ints
from slopekit.views.layers import Colour, Layer

ROCK: Colour = (201, 199, 194)
BLOCK: Colour = (222, 165, 105)
STANDS: Colour = (236, 226, 207)
DARK: Colour = (64, 48, 36)
FALLS: Colour = (150, 40, 80)
UNSETTLED: Colour = (196, 150, 196)
#: Joints, in the order of the result; loads; contact modes; how blocks move. Told apart without red and green.
JOINTS: tuple[Colour, ...] = (
    (66, 114, 176), (146, 84, 156), (72, 152, 84), (42, 163, 163), (191, 91, 91), (228, 145, 47), (122, 106, 0),
)  # fmt: skip
LOADS: tuple[Colour, ...] = (
    (60, 60, 60), (206, 92, 24), (23, 150, 130), (188, 140, 20), (214, 96, 148), (120, 70, 50), (110, 130, 40),
)  # fmt: skip
MODE_COLOURS: Mapping[str, Colour] = {"stick": (49, 99, 149), "slip": (224, 122, 31), "open": (150, 150, 150)}
MOTION_COLOURS: Mapping[str, Colour] = {
    "slides": (224, 122, 31), "topples": (150, 40, 80), "rotates": (128, 110, 190), "falls": (90, 90, 90),
    "lifts": (42, 163, 163),
}  # fmt: skip
# from dark to light, even steps to the eye (viridis, ten of its colours)
_SCALE = np.array([
    (68, 1, 84), (72, 40, 120), (62, 74, 137), (49, 104, 142), (38, 130, 142), (31, 158, 137), (53, 183, 121),
    (109, 205, 89), (180, 222, 44), (253, 231, 37),
])  # fmt: skip


@dataclass(frozen=True, slots=True)
class Bar:
    """A colour bar: what it shows and the values at its ends; `whole`: they are numbers of something."""

    label: str
    low: float
    high: float
    whole: bool = False

    def colours(self, values: Floats) -> Ints:
        """Colours (n, 3) of values (n,), those beyond the ends as the ends."""
        span = self.high - self.low
        part = np.clip((values - self.low) / span if span > 0.0 else np.zeros_like(values), 0.0, 1.0)
        place = part * (len(_SCALE) - 1)
        lower = np.minimum(place.astype(np.int64), len(_SCALE) - 2)
        share = (place - lower)[:, None]
        mixed = _SCALE[lower] * (1.0 - share) + _SCALE[lower + 1] * share
        found: Ints = np.rint(mixed).astype(np.int64)
        return found


@dataclass(frozen=True, slots=True)
class Picture:
    """A scene before it is drawn.

    Attributes
    ----------
    title, subtitle : above it; notes : beneath it
    layers : what is seen; legend : (text, colour, opacity)
    eye : (3,) unit, from the scene toward the eye; bar : of what is coloured by value
    labels : (point (3,), text); beside : they stand beside their points, with a line there
    """

    title: str
    subtitle: str
    layers: tuple[Layer, ...]
    legend: tuple[tuple[str, Colour, float], ...]
    eye: Floats
    notes: tuple[str, ...] = ()
    bar: Bar | None = None
    labels: tuple[tuple[Floats, str], ...] = ()
    beside: bool = False
