"""Between what the numbers of a design can lie for a study that looks for one of them, and what they are for.

What they measure and which values a design takes `slopekit.design.quantities` says; here are the limits of slopes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Literal

from slopekit.design.quantities import Quantity, quantity_of
from slopekit.units import unit_of

#: What a number is: of the slope itself, a coordinate, how something scatters, or how the analysis is done.
Role = Literal["quantity", "coordinate", "scatter", "setting"]


@dataclass(frozen=True, slots=True)
class Measure:
    """What a number stands for: kind of quantity, least and greatest value, role; `whole` where it counts something."""

    kind: str
    low: float
    high: float
    role: Role = "quantity"
    whole: bool = False
    period: float | None = None


DIRECTION = Measure("angle", 0.0, 360.0, period=360.0)
#: The least that is more than nothing, and the most that slopes have, by kind of quantity.
_LEAST: Mapping[str, float] = {"length": 1e-3, "force": 1e-6, "stiffness": 1.0}
_MOST: Mapping[str, float] = {"length": 1e5, "pressure": 1e5, "force": 1e9, "stiffness": 1e12, "volume": 1e5}
_FROM_ZERO = ("columns.base_step", "crack.water", "footing.at")  # lengths that may be nothing
_PLACE = Measure("length", -1e5, 1e5, "coordinate")
_COMPONENT = Measure("force", -1e9, 1e9, "coordinate")
_STEEPEST = 89.99  # of friction: below 90
_SCATTER = ("scatter", "spacing_scatter")
_OWN: Mapping[str, Measure] = {
    "head": _PLACE, "at": _PLACE, "origin": _PLACE, "centre": _PLACE, "profile": _PLACE, "polygon": _PLACE,
    "radii": Measure("length", 1e-3, 1e5), "correlation": Measure("ratio", -1.0, 1.0, "scatter"),
    "factors": Measure("ratio", 1e-3, 1e6, "setting"),
}  # fmt: skip
_SETTINGS: Mapping[str, Measure] = {
    "edge": Measure("length", 1e-3, 1e5, "setting"), "contact_tolerance": Measure("length", 1e-9, 1e5, "setting"),
    "min_volume": Measure("volume", 0.0, 1e5, "setting"), "agree_within": Measure("ratio", 0.0, 1.0, "setting"),
    "stop_when": Measure("ratio", 0.0, 1.0, "setting"), "pairs": Measure("ratio", 3.0, 2001.0, "setting", whole=True),
    "refine": Measure("ratio", 0.0, 6.0, "setting", whole=True),
    "mechanisms": Measure("ratio", 1.0, 1000.0, "setting", whole=True),
    "rows": Measure("ratio", 1.0, 1000.0, "setting", whole=True),
    "max_blocks": Measure("ratio", 1.0, 200000.0, "setting", whole=True),
    "seed": Measure("ratio", 0.0, 2.0**32, "setting", whole=True),
}  # fmt: skip


def measure_of(kind: str, path: str, text: str = "") -> Measure | None:
    """What a path of a design of that kind stands for; None where it is no number.

    Parameters
    ----------
    text : what the file says there, where that decides

    >>> measure_of("wedge", "strength.weak.phi")
    Measure(kind='angle', low=0.0, high=89.99, role='quantity', whole=False, period=None)
    """
    parts = path.replace(".mean.", ".").split(".")
    name = parts[-1]
    if path == "crack.water" and kind == "wedge":  # a part of full, or a pressure
        is_pressure = unit_of(text) not in ("", "%")
        return Measure("pressure", 0.0, _MOST["pressure"]) if is_pressure else Measure("ratio", 0.0, 1.0)
    if path == "loads.seismic.toward":
        return DIRECTION
    if path.startswith("loads.forces.") and name.isdigit() and "at" not in parts:
        return _COMPONENT
    holder = next((part for part in parts[:-1] if part in _OWN), "")
    if holder and (name.isdigit() or holder == "correlation"):
        return _OWN[holder]
    if name in _SETTINGS:
        return _SETTINGS[name]
    found = quantity_of(".".join(parts), kind)
    return None if found == Quantity() else _within_slopes(".".join(parts), found)


def _within_slopes(path: str, found: Quantity) -> Measure:
    name = path.rpartition(".")[2]
    low, high = found.least, found.most
    if low >= 0.0 and path not in _FROM_ZERO:
        low = max(low, _LEAST.get(found.kind, 0.0))
    if name in ("phi", "dilation") and high == 90.0:
        high = _STEEPEST
    if path == "weak_plane.dip":
        low = 1e-3
    far = _MOST.get(found.kind, inf)
    low, high = (low if isfinite(low) else -far), min(high, far)
    role: Role = "quantity"
    if "stiffness" in path.split("."):
        role = "setting"
    elif name in _SCATTER:
        role = "scatter"
    elif found.least == -inf:
        role = "coordinate"
    made = Measure(found.kind, low, high, role)
    return replace(made, period=360.0) if found.turns and high == 360.0 else made
