"""The water table, the pond at the toe and the surcharge on the upper slope of designs, and how they are read."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, Literal

import numpy as np

from slopekit.core.errors import Notice
from slopekit.core.orientation import number as number_text
from slopekit.core.orientation import parse_plane
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.fields import field_at, number
from slopekit.design.parts import Action, TablePlane, Water
from slopekit.design.reading.nodes import Node, fail
from slopekit.design.reading.reader import Reader

TABLE: Literal["table"] = "table"
WORST = "worst"  # distance of the tension crack that gives the lowest factor of safety
_STEEPEST_DEG = 80.0
_TABLE_KEYS = {
    "depth": "depth: 4 m",
    "points": "points: [[0, 0], [10, 4]]",
    "plane": "plane: 5/180@2m",
}


def surcharge() -> Any:
    """Declare the surcharge on the upper slope (kPa)."""
    return number(
        "loads.surcharge",
        "pressure",
        default=None,
        least=0.0,
        code="E123",
        axis="surcharge",
        says="a surcharge presses: it is never negative",
        example="20 kPa",
        left_out="none",
        doc="on the upper slope, downward, per plan area",
    )


#: The limits of the range of possible cracks (keys as in `worst_crack.WHERE`), in words.
_RANGE_LIMITS = {
    "end": ("begins", ": nearer to it none forms"),
    "back": ("ends", ": farther back none cuts the block"),
}


@dataclass(frozen=True, kw_only=True)
class SlopeDesign(Design):
    """A design of a block in a slope with a toe, a face and an upper slope.

    `crack_searched` describes where the worst tension crack lies in its range; empty if it was not searched.
    """

    ACTIONS: ClassVar[Mapping[str, Action]] = {"surcharge_kpa": "surcharge"}
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("surcharge_kpa",)
    ALONG = " into the slope"
    PLANE_AT = "at the toe"
    CRACK_FROM: ClassVar[str] = "behind the crest"

    surcharge_kpa: float | None = surcharge()
    crack_searched: str = field(default="", compare=False)

    @property
    def is_cut_for_loads(self) -> bool:
        """Whether water pressure or surcharge is integrated over the faces of the block."""
        return self.water.has_table or bool(np.any(self.surcharge_kpa))

    def ponded(self, face: int, upper: int) -> dict[int, str]:
        """Return the names of the free faces that a pond presses on, by their index."""
        return {} if self.water.pond_m is None else {face: "face", upper: "upper slope"}

    @property
    def crack_in_words(self) -> str:
        """The words that follow the distance of the crack on the sheet."""
        return " (the worst place by the closed form)" if self.crack_searched else ""

    def ground_notices(
        self, toe_m: float, crest_m: float, crack_m: float | None
    ) -> Iterator[Notice]:
        """Yield the notices about the pond and about a searched crack; elevations and distances in m."""
        pond = self.water.pond_m
        if pond is not None and pond <= toe_m:
            yield Notice(
                "W419",
                f"the pond stands at {number_text(pond)} m, at or below the toe: it wets nothing",
            )
        elif pond is not None and pond > crest_m:
            height = number_text(round(pond - crest_m, 6))
            yield Notice(
                "W419", f"the pond stands {height} m above the crest: is that a reservoir?"
            )
        if self.crack_searched == "free":
            yield Notice(
                "W421",
                "with the crack here nothing holds the block, by the closed form: worse than any "
                "factor of safety",
            )
        elif self.crack_searched in _RANGE_LIMITS:
            limit_verb, consequence = (
                _RANGE_LIMITS[self.crack_searched] if round(crack_m or 0.0, 2) else ("begins", "")
            )
            yield Notice(
                "W421",
                f"the factor is lowest where the range of the crack {limit_verb}, {crack_m:.2f} m "
                f"{self.CRACK_FROM}{consequence}",
            )
        elif self.crack_searched == "flat":
            yield Notice(
                "W421",
                "the place of the crack does not move the factor: none is worse than another",
            )


def read_table(reader: Reader) -> Water | None:
    """Read a water table or a pond; None where the design has neither.

    Faults: E112 keys that exclude each other, E454 a table without position or with points that do not ascend.
    """
    node = reader.find("water")
    if not node.is_mapping:
        return None
    table_keys = [
        key
        for key in _TABLE_KEYS
        if key != "depth" or field_at(reader.record, "water.depth") is not None
    ]
    table_forms, mode, pond = (
        [key for key in table_keys if node.get(key)],
        node.get("mode"),
        node.get("pond"),
    )
    is_table = mode.text == TABLE
    if not (is_table or table_forms or pond):
        return None
    other_forms = [f"mode: {mode.text}"] if mode and not is_table else []
    other_forms += [key for key in ("fill", "pressures") if node.get(key)]
    if other_forms:
        table = table_forms[0] if table_forms else "pond" if pond else "mode: table"
        message = f"water has {other_forms[0]} and {table}: they exclude each other"
        reader.fault(
            "E112", message, node, "Keep one of them; a table says how high the water stands."
        )
    elif len(table_forms) > 1:
        message = f"the water table has {' and '.join(table_forms)}: they exclude each other"
        reader.fault("E112", message, node.get(table_forms[1]), "Keep one of them.")
    elif not table_forms and not pond:
        advice = f"Add {', '.join(_TABLE_KEYS[key] for key in table_keys)} or pond: 3 m."
        reader.fault("E454", "water is a table, and nothing says where it lies", mode, advice)
    elif table_forms and not is_table:
        in_crack = table_forms[0] == "depth" and reader.find("crack")
        advice = "Add mode: table" + (
            "; a depth in the crack is crack: {water: 2 m}." if in_crack else "."
        )
        reader.fault(
            "E454", f"water.{table_forms[0]} is of a water table", node.get(table_forms[0]), advice
        )
    below = node.get("plane")
    value = reader.value(below)
    plane = None if value is None else reader.faults.of(_plane, value, str(below.place))
    lengths = reader.fields(Water, node, only=("table_depth_m", "pond_m"))
    return Water(
        TABLE, table_points_m=_points(reader, node.get("points")), table_plane=plane, **lengths
    )


def _points(reader: Reader, node: Node) -> tuple[tuple[float, float], ...] | None:
    points = reader.points(node, "the water table")
    for k, (previous, point) in enumerate(pairwise(points), 2):
        if point[0] <= previous[0]:
            message = (
                f"point {k} of the water table lies at {number_text(point[0])} m, "
                f"not beyond {number_text(previous[0])} m"
            )
            advice = "Distances from the toe into the slope ascend from point to point."
            reader.fault("E454", message, node.elements[k - 1], advice)
            return None
    return tuple(points) or None


def _plane(value: Any, location: str) -> TablePlane:
    plane, _, level = str(value).partition("@")
    if isinstance(value, Mapping) or not level:
        message = f"the plane of the water table is {value}, it is written 5/180@2m"
        fail("E454", message, location, "Dip, dip direction, and its elevation over the toe.")
    water_plane = parse_plane(plane, "the water table", location)
    if water_plane.dip_deg > _STEEPEST_DEG:
        fail(
            "E454",
            f"the water table dips {number_text(water_plane.dip_deg)}°, at most {number_text(_STEEPEST_DEG)}° is one",
            location,
        )
    return TablePlane(
        water_plane, quantity(level, "length", "elevation of the water table", location)
    )
