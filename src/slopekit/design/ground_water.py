"""A water table, a pond at the toe and a load on the upper slope: what designs say of them, and how it is read."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import Any, ClassVar

from slopekit.core.errors import DesignError, Fault, Notice
from slopekit.core.orientation import Plane, parse_plane
from slopekit.core.orientation import number as shown
from slopekit.core.records import dataclass
from slopekit.core.units import quantity
from slopekit.design.common import Design
from slopekit.design.fields import fields_of, number, text
from slopekit.design.parts import Action, Water
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import Leaf, ListOf

TABLE = "table"
WORST = "worst"  # of places of a crack
_STEEPEST_DEG = 80.0
_TABLE_KEYS = {"depth": "depth: 4 m", "points": "points: [[0, 0], [10, 4]]", "plane": "plane: 5/180@2m"}


@dataclass(frozen=True, slots=True)
class TablePlane:
    """A water table that is a plane: its orientation, and its elevation above the toe, m."""

    plane: Plane
    level_m: float

    def __str__(self) -> str:
        return f"{self.plane}@{shown(self.level_m)}m"


def surcharge() -> Any:
    """A load on the upper slope."""
    return number(
        "loads.surcharge", "pressure", default=None, least=0.0, code="E123", axis="surcharge",
        says="a surcharge presses: it is never negative", example="20 kPa", left_out="none",
        doc="on the upper slope, downward, per plan area",
    )  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class WetDesign(Design):
    """A design that a water table and a pond may wet.

    The table stands `table_depth_m` below the ground, through `table_points_m` (place and elevation) or in
    `table_plane`; the others are None. `water.mode` of one block is "table" where one of them or `pond_m` is given.
    """

    UNSAID: ClassVar[tuple[str, ...]] = ("table_depth_m", "table_points_m", "table_plane", "pond_m")
    #: Along what places of points are counted, and where a plane has its elevation, in words.
    ALONG: ClassVar[str] = ""
    PLANE_AT: ClassVar[str] = "at the origin"

    table_depth_m: float | None = number(
        "water.depth", "length", default=None, least=0.0, code="E454", axis="depth of the water table",
        says="a table lies at or below the ground", example="4 m", left_out="no table",
        doc="with `mode: table`: of the table below the ground, vertical",
    )  # fmt: skip
    table_points_m: tuple[tuple[float, float], ...] | None = text(
        "water.points", default=None, coordinates=2, left_out="no table",
        doc="with `mode: table`: distance from the toe into the slope (surfaces, blocks: x), ascending, and elevation; "
        "level beyond its ends",
        forms=(ListOf(ListOf(Leaf(), 2, 2), 2, example="[[0, 0], [10, 4], [30, 9]]"),),
        example="[[0, 0], [10, 4], [30, 9]]",
    )  # fmt: skip
    table_plane: TablePlane | None = text(
        "water.plane", default=None, left_out="no table", example="5/180@2m",
        doc="with `mode: table`: a plane, and its elevation over the toe (surfaces, blocks: the origin)",
    )  # fmt: skip
    pond_m: float | None = number(
        "water.pond", "length", default=None, axis="level of the pond", example="3 m", left_out="no pond",
        doc="elevation of open water at the toe; the table is as high at least",
    )  # fmt: skip

    @property
    def has_table(self) -> bool:
        """Whether it has a table, or a pond."""
        ground = (self.table_depth_m, self.table_points_m, self.table_plane, self.pond_m)
        return any(one is not None for one in ground)

    def ground_in_words(self) -> list[str]:
        """Table, pond and surcharge as the sheet prints them."""
        entries, load = [], getattr(self, "surcharge_kpa", None)
        if self.table_depth_m is not None:
            entries.append(f"water table {shown(self.table_depth_m)} m below the ground")
        if self.table_points_m is not None:
            first, last = self.table_points_m[0], self.table_points_m[-1]
            entries.append(
                f"water table through {len(self.table_points_m)} points, from {shown(first[1])} m at "
                f"{shown(first[0])} m to {shown(last[1])} m at {shown(last[0])} m{self.ALONG}"
            )
        elif self.table_plane is not None:
            plane = self.table_plane
            entries.append(f"water table {plane.plane}, {shown(plane.level_m)} m {self.PLANE_AT}")
        if self.pond_m is not None:
            entries.append(f"pond to {shown(self.pond_m)} m")
        if load:
            entries.append(f"surcharge {shown(load)} kPa on the plan of the upper slope")
        return entries


_AT_CREST_M = 0.01  # nearer than that a crack is at the crest


@dataclass(frozen=True, slots=True, kw_only=True)
class SlopeDesign(WetDesign):
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
        return self.water.mode == TABLE or bool(self.surcharge_kpa) or self.is_wet_by_crack

    @property
    def is_wet_by_crack(self) -> bool:
        """Whether the depth of water in the crack says what is on the joints, by the faces of the block."""
        return False

    def ponded(self, face: int, upper: int) -> dict[int, str]:
        """The free faces that a pond presses on, by name."""
        wet = self.water.mode == TABLE and self.pond_m is not None
        return {face: "face", upper: "upper slope"} if wet else {}

    @property
    def crack_in_words(self) -> str:
        """Behind the place of the crack on the sheet."""
        return " (the worst place by the closed form)" if self.crack_searched else ""

    def ground_notices(self, toe_m: float, crest_m: float) -> Iterator[Notice]:
        """What to know of the pond, by the elevations of toe and crest, and of a crack that was looked for."""
        if self.water.mode == TABLE and self.pond_m is not None:
            if self.pond_m <= toe_m:
                yield Notice("W419", f"the pond stands at {shown(self.pond_m)} m, at or below the toe: it wets nothing")
            elif self.pond_m > crest_m:
                over = shown(round(self.pond_m - crest_m, 6))
                yield Notice("W419", f"the pond stands {over} m above the crest: is that a reservoir?")
        if self.crack_searched == "free":
            yield Notice("W421", "with the crack here nothing holds the block, by the closed form: worse than any "
                         "factor of safety")  # fmt: skip
        elif self.crack_searched == "end":
            said = "at an end of the range of the crack: a crack there is at the crest itself"
            if (behind := _behind_crest(self)) > _AT_CREST_M:
                said = f"where the range of the crack begins, {behind:.2f} m {self.CRACK_FROM}: nearer to it none forms"
            yield Notice("W421", f"the factor is lowest {said}")
        elif self.crack_searched == "back":
            yield Notice("W421", f"the factor is lowest where the range of the crack ends, {_behind_crest(self):.2f} m "
                         f"{self.CRACK_FROM}: farther back none cuts the block")  # fmt: skip
        elif self.crack_searched == "flat":
            yield Notice("W421", "the place of the crack does not move the factor: none is worse than another")


def _behind_crest(design: SlopeDesign) -> float:
    """The distance of the crack from the crest, m."""
    return float(getattr(getattr(design, "crack", None), "distance_m", None) or 0.0)


def read_ground_water(reader: Reader) -> tuple[dict[str, Any], Water | None]:
    """The table, the pond and the surcharge by attribute, and the water where they say it all; None where they do not.

    Of the keys those that the kind has. E112 for what excludes each other, E454 for a table that is not given or
    points that do not ascend.
    """
    own = fields_of(reader.record)
    node = reader.at("water")
    attributes: dict[str, Any] = {}
    if "surcharge_kpa" in own:
        attributes["surcharge_kpa"] = reader.field(own["surcharge_kpa"], reader.at("loads.surcharge"))
    if node is None or not node.is_mapping:
        return attributes, None
    known = [key for key in _TABLE_KEYS if any(one.path == f"water.{key}" for one in own.values())]
    said = [key for key in known if node.get(key) is not None]
    mode = node.get("mode")
    pond = node.get("pond")
    is_table = mode is not None and mode.text == TABLE
    if not (is_table or said or pond is not None):
        return attributes, None
    others = [key for key in ("fill", "pressures") if node.get(key) is not None]
    if mode is not None and not is_table:
        others.insert(0, f"mode: {mode.text}")
    if others:
        beside = said[0] if said else "pond" if pond is not None else "mode: table"
        message = f"water has {others[0]} and {beside}: they exclude each other"
        reader.fault("E112", message, node, "Keep one of them; a table says how high the water stands.")
    elif len(said) > 1:
        message = f"the water table has {' and '.join(said)}: they exclude each other"
        reader.fault("E112", message, node.get(said[1]), "Keep one of them.")
    elif not said and pond is None:
        message = "water is a table, and nothing says where it lies"
        first = ", ".join(_TABLE_KEYS[key] for key in known)
        reader.fault("E454", message, mode, f"Add {first} or pond: 3 m.")
    elif said and not is_table:
        in_crack = said[0] == "depth" and reader.at("crack") is not None
        advice = "Add mode: table" + ("; a depth in the crack is crack: {water: 2 m}." if in_crack else ".")
        reader.fault("E454", f"water.{said[0]} is of a water table", node.get(said[0]), advice)
    if "table_depth_m" in own:
        attributes["table_depth_m"] = reader.field(own["table_depth_m"], node.get("depth"))
    attributes["pond_m"] = reader.field(own["pond_m"], pond)
    attributes["table_points_m"] = _points(reader, node.get("points"))
    below = node.get("plane")
    value = None if below is None else reader.value(below)
    attributes["table_plane"] = None if value is None or below is None else reader.kept(_plane, value, str(below.place))
    return attributes, Water("table")


def _points(reader: Reader, node: Node | None) -> tuple[tuple[float, float], ...] | None:
    if node is None or reader.value(node) is None:
        return None
    points: list[tuple[float, float]] = []
    for k, item in enumerate(node.elements, 1):
        point = reader.kept(_lengths, reader.value(item), f"point {k} of the water table", str(item.place))
        if point is None:
            return None
        if points and point[0] <= points[-1][0]:
            message = f"point {k} of the water table lies at {shown(point[0])} m, not beyond {shown(points[-1][0])} m"
            reader.fault("E454", message, item, "Distances from the toe into the slope ascend from point to point.")
            return None
        points.append(point)
    return tuple(points)


def _lengths(value: Any, name: str, where: str) -> tuple[float, float]:
    x, z = (quantity(part, "length", name, where) for part in value)
    return x, z


def _plane(value: Any, where: str) -> TablePlane:
    plane, _, level = str(value).partition("@")
    if isinstance(value, Mapping) or not level:
        message = f"the plane of the water table is {value}, it is written 5/180@2m"
        raise DesignError([Fault("E454", message, where, "Dip, dip direction, and its elevation over the toe.")])
    water_plane = parse_plane(plane, "the water table", where)
    if water_plane.dip_deg > _STEEPEST_DEG:
        message = f"the water table dips {shown(water_plane.dip_deg)}°, at most {shown(_STEEPEST_DEG)}° is one"
        raise DesignError([Fault("E454", message, where)])
    return TablePlane(water_plane, quantity(level, "length", "elevation of the water table", where))
