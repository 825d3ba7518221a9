"""A water table, a pond at the toe and a load on the upper slope: what designs say of them, and how it is read."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, Literal

import numpy as np

from slopekit.core.errors import Notice
from slopekit.core.orientation import number as shown
from slopekit.core.orientation import parse_plane
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.fields import field_at, number
from slopekit.design.parts import Action, TablePlane, Water
from slopekit.design.reading.nodes import Node, fail
from slopekit.design.reading.reader import Reader

TABLE: Literal["table"] = "table"
WORST = "worst"  # of places of a crack
_STEEPEST_DEG = 80.0
_TABLE_KEYS = {"depth": "depth: 4 m", "points": "points: [[0, 0], [10, 4]]", "plane": "plane: 5/180@2m"}


def surcharge() -> Any:
    """A load on the upper slope."""
    return number(
        "loads.surcharge", "pressure", default=None, least=0.0, code="E123", axis="surcharge",
        says="a surcharge presses: it is never negative", example="20 kPa", left_out="none",
        doc="on the upper slope, downward, per plan area",
    )  # fmt: skip


#: Ends of the range of a crack, as `worst_crack.WHERE` has them, in words.
_ENDS = {"end": ("begins", ": nearer to it none forms"), "back": ("ends", ": farther back none cuts the block")}


@dataclass(frozen=True, kw_only=True)
class SlopeDesign(Design):
    """A block in a slope with a toe, a face and an upper slope.

    `crack_searched` says how the worst place of a crack lies in its range, where it was looked for.
    """

    ACTIONS: ClassVar[Mapping[str, Action]] = {"surcharge_kpa": "surcharge"}
    UNSAID: ClassVar[tuple[str, ...]] = ("surcharge_kpa",)
    ALONG = " into the slope"
    PLANE_AT = "at the toe"
    CRACK_FROM: ClassVar[str] = "behind the crest"

    surcharge_kpa: float | None = surcharge()
    crack_searched: str = field(default="", compare=False)

    @property
    def is_cut_for_loads(self) -> bool:
        """Whether water or surcharge are integrated over the faces of the block."""
        return self.water.has_table or bool(np.any(self.surcharge_kpa))

    def ponded(self, face: int, upper: int) -> dict[int, str]:
        """The free faces that a pond presses on, by name."""
        return {} if self.water.pond_m is None else {face: "face", upper: "upper slope"}

    @property
    def crack_in_words(self) -> str:
        """Behind the place of the crack on the sheet."""
        return " (the worst place by the closed form)" if self.crack_searched else ""

    def ground_notices(self, toe_m: float, crest_m: float, crack_m: float | None) -> Iterator[Notice]:
        """What to know of the pond, by the elevations of toe and crest, and of a crack that was looked for."""
        pond = self.water.pond_m
        if pond is not None and pond <= toe_m:
            yield Notice("W419", f"the pond stands at {shown(pond)} m, at or below the toe: it wets nothing")
        elif pond is not None and pond > crest_m:
            over = shown(round(pond - crest_m, 6))
            yield Notice("W419", f"the pond stands {over} m above the crest: is that a reservoir?")
        if self.crack_searched == "free":
            yield Notice("W421", "with the crack here nothing holds the block, by the closed form: worse than any "
                         "factor of safety")  # fmt: skip
        elif self.crack_searched in _ENDS:
            ends, beyond = _ENDS[self.crack_searched] if round(crack_m or 0.0, 2) else ("begins", "")
            yield Notice("W421", f"the factor is lowest where the range of the crack {ends}, {crack_m:.2f} m "
                         f"{self.CRACK_FROM}{beyond}")  # fmt: skip
        elif self.crack_searched == "flat":
            yield Notice("W421", "the place of the crack does not move the factor: none is worse than another")


def read_table(reader: Reader) -> Water | None:
    """The water of a table or a pond; None where the design gives none.

    E112 for what excludes each other, E454 for a table that is not given or points that do not ascend.
    """
    node = reader.at("water")
    if not node.is_mapping:
        return None
    known = [key for key in _TABLE_KEYS if key != "depth" or field_at(reader.record, "water.depth") is not None]
    said, mode, pond = [key for key in known if node.get(key)], node.get("mode"), node.get("pond")
    is_table = mode.text == TABLE
    if not (is_table or said or pond):
        return None
    others = [f"mode: {mode.text}"] if mode and not is_table else []
    others += [key for key in ("fill", "pressures") if node.get(key)]
    if others:
        table = said[0] if said else "pond" if pond else "mode: table"
        message = f"water has {others[0]} and {table}: they exclude each other"
        reader.fault("E112", message, node, "Keep one of them; a table says how high the water stands.")
    elif len(said) > 1:
        message = f"the water table has {' and '.join(said)}: they exclude each other"
        reader.fault("E112", message, node.get(said[1]), "Keep one of them.")
    elif not said and not pond:
        advice = f"Add {', '.join(_TABLE_KEYS[key] for key in known)} or pond: 3 m."
        reader.fault("E454", "water is a table, and nothing says where it lies", mode, advice)
    elif said and not is_table:
        in_crack = said[0] == "depth" and reader.at("crack")
        advice = "Add mode: table" + ("; a depth in the crack is crack: {water: 2 m}." if in_crack else ".")
        reader.fault("E454", f"water.{said[0]} is of a water table", node.get(said[0]), advice)
    below = node.get("plane")
    value = reader.value(below)
    plane = None if value is None else reader.faults.of(_plane, value, str(below.place))
    lengths = reader.fields(Water, node, only=("table_depth_m", "pond_m"))
    return Water(TABLE, table_points_m=_points(reader, node.get("points")), table_plane=plane, **lengths)


def _points(reader: Reader, node: Node) -> tuple[tuple[float, float], ...] | None:
    points = reader.points(node, "the water table")
    for k, (before, after) in enumerate(pairwise(points), 2):
        if after[0] <= before[0]:
            message = f"point {k} of the water table lies at {shown(after[0])} m, not beyond {shown(before[0])} m"
            advice = "Distances from the toe into the slope ascend from point to point."
            reader.fault("E454", message, node.elements[k - 1], advice)
            return None
    return tuple(points) or None


def _plane(value: Any, where: str) -> TablePlane:
    plane, _, level = str(value).partition("@")
    if isinstance(value, Mapping) or not level:
        message = f"the plane of the water table is {value}, it is written 5/180@2m"
        fail("E454", message, where, "Dip, dip direction, and its elevation over the toe.")
    water_plane = parse_plane(plane, "the water table", where)
    if water_plane.dip_deg > _STEEPEST_DEG:
        fail(
            "E454", f"the water table dips {shown(water_plane.dip_deg)}°, at most {shown(_STEEPEST_DEG)}° is one", where
        )
    return TablePlane(water_plane, quantity(level, "length", "elevation of the water table", where))
