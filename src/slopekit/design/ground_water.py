"""A water table, a pond at the toe and a load on the upper slope: what designs of one block in a slope say of them."""

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import Plane, parse_plane
from slopekit.core.orientation import number as shown
from slopekit.core.records import dataclass
from slopekit.core.units import quantity
from slopekit.design.common import Design, Water
from slopekit.design.fields import fields_of, number, text
from slopekit.design.nodes import Node
from slopekit.design.reader import Reader
from slopekit.design.structure import Leaf, ListOf

TABLE = "table"
_STEEPEST_DEG = 80.0
_TABLE_KEYS = ("depth", "points", "plane")


@dataclass(frozen=True, slots=True)
class TablePlane:
    """A water table that is a plane: its orientation, and its elevation above the toe, m."""

    plane: Plane
    level_m: float

    def __str__(self) -> str:
        return f"{self.plane}@{shown(self.level_m)}m"


@dataclass(frozen=True, slots=True, kw_only=True)
class SlopeDesign(Design):
    """A block in a slope with a toe, a face and an upper slope.

    `water.mode` is "table" where one of `table_depth_m`, `table_points_m` (distance into the slope from the toe, and
    elevation), `table_plane` is given, or `pond_m` alone; the others are None. `crack_searched` says how the worst
    place of a crack lies in its range, where it was looked for.
    """

    table_depth_m: float | None = number(
        "water.depth", "length", default=None, least=0.0, code="E454", axis="depth of the water table",
        says="a table lies at or below the ground", example="4 m", left_out="no table",
        doc="with `mode: table`: of the table below the ground, vertical",
    )  # fmt: skip
    table_points_m: tuple[tuple[float, float], ...] | None = text(
        "water.points", default=None, coordinates=2, left_out="no table",
        doc="with `mode: table`: distance from the toe into the slope, ascending, and elevation; level beyond its ends",
        forms=(ListOf(ListOf(Leaf(), 2, 2), 2, example="[[0, 0], [10, 4], [30, 9]]"),),
        example="[[0, 0], [10, 4], [30, 9]]",
    )  # fmt: skip
    table_plane: TablePlane | None = text(
        "water.plane", default=None, left_out="no table", example="5/180@2m",
        doc="with `mode: table`: a plane, and its elevation over the toe",
    )  # fmt: skip
    pond_m: float | None = number(
        "water.pond", "length", default=None, axis="level of the pond", example="3 m", left_out="no pond",
        doc="elevation of open water at the toe; the table is as high at least",
    )  # fmt: skip
    surcharge_kpa: float | None = number(
        "loads.surcharge", "pressure", default=None, least=0.0, code="E458", axis="surcharge",
        says="a surcharge presses: it is never negative", example="20 kPa", left_out="none",
        doc="on the upper slope, downward, per plan area",
    )  # fmt: skip
    crack_searched: str = field(default="", compare=False)

    @property
    def is_cut_for_loads(self) -> bool:
        """Whether water or surcharge are integrated over the faces of the block."""
        return self.water.mode == TABLE or bool(self.surcharge_kpa)


def read_ground_water(reader: Reader) -> tuple[dict[str, Any], Water | None]:
    """The table, the pond and the surcharge by attribute, and the water where they say it all; None where they do not.

    E198 for what excludes each other, E454 for a table that is not given, E455 for points that do not ascend.
    """
    own = fields_of(SlopeDesign)
    node = reader.at("water")
    found: dict[str, Any] = {"surcharge_kpa": reader.field(own["surcharge_kpa"], reader.at("loads.surcharge"))}
    if node is None or not node.is_mapping:
        return found, None
    said = [key for key in _TABLE_KEYS if node.get(key) is not None]
    mode, pond = node.get("mode"), node.get("pond")
    is_table = mode is not None and mode.text == TABLE
    if not (is_table or said or pond is not None):
        return found, None
    others = [key for key in ("fill", "pressures") if node.get(key) is not None]
    if mode is not None and not is_table:
        others.insert(0, f"mode: {mode.text}")
    if others:
        beside = said[0] if said else "pond" if pond is not None else "mode: table"
        message = f"water has {others[0]} and {beside}: they exclude each other"
        reader.fault("E198", message, node, "Keep one of them; a table says how high the water stands.")
    elif len(said) > 1:
        message = f"the water table has {' and '.join(said)}: they exclude each other"
        reader.fault("E198", message, node.get(said[1]), "Keep one of them.")
    elif not said and pond is None:
        message = "water is a table, and nothing says where it lies"
        reader.fault("E454", message, mode, "Add depth: 4 m, points: [[0, 0], [10, 4]], plane: 5/180@2m or pond: 3 m.")
    elif said and not is_table:
        reader.fault("E454", f"water.{said[0]} is of a water table", node.get(said[0]), "Add mode: table.")
    found["table_depth_m"] = reader.field(own["table_depth_m"], node.get("depth"))
    found["pond_m"] = reader.field(own["pond_m"], pond)
    found["table_points_m"] = _points(reader, node.get("points"))
    below = node.get("plane")
    value = None if below is None else reader.value(below)
    found["table_plane"] = None if value is None or below is None else reader.kept(_plane, value, str(below.place))
    return found, Water("table")


def _points(reader: Reader, node: Node | None) -> tuple[tuple[float, float], ...] | None:
    if node is None or reader.value(node) is None:
        return None
    points: list[tuple[float, float]] = []
    for k, item in enumerate(node.elements, 1):
        found = reader.kept(_lengths, reader.value(item), f"point {k} of the water table", str(item.place))
        if found is None:
            return None
        if points and found[0] <= points[-1][0]:
            message = f"point {k} of the water table lies at {shown(found[0])} m, not beyond {shown(points[-1][0])} m"
            reader.fault("E455", message, item, "Distances from the toe into the slope ascend from point to point.")
            return None
        points.append(found)
    return tuple(points)


def _lengths(value: Any, name: str, where: str) -> tuple[float, float]:
    x, z = (quantity(part, "length", name, where) for part in value)
    return x, z


def _plane(value: Any, where: str) -> TablePlane:
    plane, _, level = str(value).partition("@")
    if isinstance(value, Mapping) or not level:
        message = f"the plane of the water table is {value}, it is written 5/180@2m"
        advice = "Dip, dip direction, and its elevation over the toe."
        raise DesignError([Fault("E454", message, where, advice)])
    found = parse_plane(plane, "the water table", where)
    if found.dip_deg > _STEEPEST_DEG:
        message = f"the water table dips {shown(found.dip_deg)}°, at most {shown(_STEEPEST_DEG)}° is one"
        raise DesignError([Fault("E454", message, where)])
    return TablePlane(found, quantity(level, "length", "elevation of the water table", where))
