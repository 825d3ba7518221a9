"""The inputs of a document as tables: numbers with their units, planes in words, what was not given left out."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from slopekit.core.orientation import Line, Plane, millimetre, number
from slopekit.core.records import dataclass
from slopekit.design.parts import Water
from slopekit.kinds.words import line_in_words

_PLANE = re.compile(r"^(\d+(?:\.\d+)?)/(\d+(?:\.\d+)?)$")
_UNITS = {
    "_kn_m3": "kN/m³", "_kg_m3": "kg/m³", "_m_s2": "m/s²", "_m3": "m³", "_m2": "m²", "_kpa": "kPa", "_deg": "°",
    "_kn": "kN", "_m": "m",
}  # fmt: skip
_COORDINATES = ("origin_m", "head_m", "at_m", "centre_m", "polygon_m", "profile_m", "table_points_m")
_ROUNDING = 1e-12  # of the largest of several values: what is left of 0
_PERCENT = ("agree_within", "fill", "crack_fill", "spacing_scatter")
_SYMBOLS = {
    "cohesion_kpa": "cohesion c", "friction_angle_deg": "friction angle φ", "dilation_deg": "dilation ψ",
    "tension_kpa": "tensile strength", "water_unit_weight_kn_m3": "unit weight of water", "gravity_m_s2": "gravity",
    "unit_weight_kn_m3": "unit weight of rock", "density_kg_m3": "density of rock", "normal_kn_m3": "normal stiffness",
    "shear_kn_m3": "shear stiffness", "agree_within": "methods agree within",
    "factors": "strength reduction factors", "rules": "acceptance rules", "origin_m": "map coordinates of the toe",
    "height_m": "height", "refine": "splits of the triangles asked for", "pairs": "node pairs along the plane",
}  # fmt: skip
_GROUPS = {
    "Rock and water": ("unit_weight_kn_m3", "density_kg_m3", "gravity_m_s2", "water", "water_unit_weight_kn_m3",
                       "table_depth_m", "table_points_m", "table_plane", "pond_m", "pressures_kpa"),
    "Loads and support": ("seismic", "surcharge_kpa", "surcharges_kpa", "forces", "bolts", "load_kn", "load_at_m"),
    "Analysis": ("criterion", "rules", "agree_within", "factors", "mechanisms", "seed", "refine", "pairs",
                 "stiffness", "max_blocks", "min_volume_m3", "contact_tolerance_m"),
}  # fmt: skip
_STRENGTH = (
    ("cohesion_kpa", "c / kPa"), ("friction_angle_deg", "φ / °"), ("dilation_deg", "ψ / °"),
    ("tension_kpa", "σt / kPa"),
)  # fmt: skip
_MOST = 24  # rows or values of one kind


@dataclass(frozen=True, slots=True)
class InputTable:
    """A table: its title, heads, rows of texts, and what has to be said beneath; `left` columns are texts."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    left: int = 1


def input_tables(inputs: Mapping[str, Any], with_schedule: bool = False) -> Iterator[InputTable]:
    """Planes, strengths, and everything else by groups.

    Parameters
    ----------
    with_schedule : a schedule has the bolts: here they are counted

    Raises
    ------
    KeyError, TypeError, ValueError, AttributeError
        Where the inputs are not those of a result.
    """
    used: set[str] = {"title", "joint_names", "joint_name"}
    if planes := tuple(_planes(inputs, used)):
        yield InputTable("Planes", ("", "dip / direction", "in words"), planes, left=3)
    if strengths := tuple(_strengths(inputs, used)):
        yield InputTable("Strength", ("", *(name for _, name in _STRENGTH)), strengths)
    shape = [key for key in inputs if key not in used and not any(key in keys for keys in _GROUPS.values())]
    for title, keys in {"Shape": tuple(shape), **_GROUPS}.items():
        rows: list[tuple[str, ...]] = []
        for key in (key for key in keys if key in inputs and key not in used):
            if key == "bolts" and with_schedule:
                rows.append(("bolts", f"{len(inputs[key])}, in the schedule"))
                continue
            rows += input_rows(key, inputs)
        if rows:
            yield InputTable(title, ("", "value"), tuple(rows), left=2)


def input_rows(key: str, inputs: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return the rows of an input; water that stands in a crack is not `dry`."""
    if key == "water" and _crack_only(inputs):
        return [("water", "in the crack only, falling to nothing at the toe")]
    if key == "water" and inputs.get("crack_water_m"):
        return [("water", "as the crack has it, on the joints falling to nothing at their other edges")]
    return list(rows_of(key, inputs[key], words(key)))


def plane_of(text: Any) -> Plane | None:
    """The plane that a text such as 45/115 names, None for anything else."""
    match = _PLANE.match(text) if isinstance(text, str) else None
    return Plane(float(match[1]), float(match[2])) if match else None


def plane_in_words(plane: Plane) -> str:
    """A plane in words; one without a dip is level."""
    return plane.in_words() if plane.dip_deg else "level"


def words(key: str) -> str:
    """The name of an input without its unit.

    >>> words("spacing_m"), words("cohesion_kpa")
    ('spacing', 'cohesion c')
    """
    if key in _SYMBOLS:
        return _SYMBOLS[key]
    return key.removesuffix(_suffix(key)).replace("_", " ")


def value_text(key: str, value: Any) -> str:
    """A value with its unit.

    >>> value_text("spacing_m", 3.5), value_text("agree_within", 0.01), value_text("normal_kpa", [1.0, 2.0])
    ('3.5 m', '1 %', '1, 2 kPa')
    >>> value_text("head_m", [512300.25, 4187650.0, 1234.5])
    '512300.250, 4187650.000, 1234.500 m'
    """
    if value is None:
        return "not given"
    if isinstance(value, bool):
        return "yes" if value else "no"
    unit = _UNITS.get(_suffix(key), "")
    gap = "" if unit in ("", "°") else " "
    if isinstance(value, int | float):
        return f"{_plain(value * 100)} %" if key in _PERCENT else f"{_plain(value)}{gap}{unit}"
    if isinstance(value, list):
        if not value:
            return "none"
        if all(isinstance(one, int | float) for one in value):
            return f"{_listed(key, value[:_MOST])}{_more(value)}{gap}{unit}"
        if all(isinstance(one, list) and all(isinstance(part, int | float) for part in one) for one in value):
            shown = " ".join(f"({_listed(key, one)})" for one in value[:_MOST])
            return f"{shown}{_more(value)}{gap}{unit}"
        return ", ".join(str(one) for one in value[:_MOST]) + _more(value)
    if isinstance(value, Mapping):
        if set(value) == {"trend_deg", "plunge_deg"}:
            return line_in_words(Line(value["trend_deg"], value["plunge_deg"]))
        return ", ".join(f"{words(part)} {value_text(part, own)}" for part, own in value.items() if own is not None)
    plane = plane_of(value)
    return f"{plane}, {plane_in_words(plane)}" if plane else str(value)


def _listed(key: str, values: Sequence[float]) -> str:
    """Numbers with commas between, coordinates to the millimetre; the rounding of the others is 0."""
    if key in _COORDINATES:
        return ", ".join(map(millimetre, values))
    least = _ROUNDING * max(map(abs, values), default=0.0)
    return ", ".join(_plain(one if abs(one) > least else 0.0) for one in values)


def _more(values: Sequence[Any]) -> str:
    return f", ... and {len(values) - _MOST} more (in the JSON)" if len(values) > _MOST else ""


def _plain(value: float) -> str:
    return number(float(value))  # as it was given, map coordinates too


def _suffix(key: str) -> str:
    return next((suffix for suffix in _UNITS if key.endswith(suffix)), "")


def _planes(inputs: Mapping[str, Any], used: set[str]) -> Iterator[tuple[str, ...]]:
    """Joints, joint sets, face, upper slope and crack."""
    own = {"joint": str(inputs.get("joint_name", "joint"))}
    names = inputs.get("joint_names") or []
    for key in ("joints", "joint", "sets", "face", "upper"):
        value = inputs.get(key)
        if isinstance(value, Mapping):  # a wedge's
            for k, (name, plane) in enumerate(value.items()):
                said = f"{name} ({names[k]})" if k < len(names) and names[k] != name else name
                yield _plane_row(said, plane)
        elif isinstance(value, list):  # a bench's
            for one in value:
                head, where, said = _plane_row(one["name"], one["plane"])
                rest = [f"{words(name)} {value_text(name, part)}" for name, part in one.items()
                        if name not in ("name", "plane")]  # fmt: skip
                yield head, where, "; ".join([said, *rest])
        elif plane_of(value):
            yield _plane_row(own.get(key, "upper slope" if key == "upper" else key), value)
        else:
            continue
        used.add(key)
    for own_name in ("basal", "crack"):
        one = inputs.get(own_name)
        if isinstance(one, Mapping) and plane_of(one.get("plane")):
            head, where, said = _plane_row(own_name, one["plane"])
            rest = [f"{words(name)} {value_text(name, part)}" for name, part in one.items() if name != "plane"]
            yield head, where, "; ".join([said, *rest])
            used.add(own_name)


def _crack_only(inputs: Mapping[str, Any]) -> bool:
    """Whether a plane is dry but for the water in its crack."""
    crack = inputs.get("crack")
    return inputs["water"]["mode"] == "dry" and isinstance(crack, Mapping) and bool(crack.get("water_m"))


def _plane_row(name: str, text: Any) -> tuple[str, str, str]:
    plane = plane_of(text)
    return str(name), str(text), plane_in_words(plane) if plane else str(text)


def _strengths(inputs: Mapping[str, Any], used: set[str]) -> Iterator[tuple[str, ...]]:
    keys = [key for key, _ in _STRENGTH]
    if isinstance(inputs.get("strengths"), list):
        used.add("strengths")
        for name, strength in inputs["strengths"]:
            yield str(name), *(_plain(strength[key]) for key in keys)
    elif isinstance(inputs.get("strength"), Mapping):
        used.add("strength")
        yield "joint", *(_plain(inputs["strength"][key]) for key in keys)
    elif isinstance(inputs.get(keys[0]), list):
        used.update(keys)
        for k, values in enumerate(zip(*(inputs[key] for key in keys), strict=True)):
            yield ("J1", "J2", "basal")[k], *(_plain(value) for value in values)


def rows_of(key: str, value: Any, name: str) -> list[tuple[str, ...]]:
    """A value as rows; groups and lists of groups take several."""
    if value is None:
        return []
    if key == "refine" and value == 0:
        return []  # the size of the model says what was split
    if key == "water":
        given = Water(value["mode"], value["fill"], tuple(value["pressures_kpa"]), value.get("crack_fill"))
        if len(given.pressures_kpa) > _MOST:
            given = replace(given, pressures_kpa=given.pressures_kpa[:_MOST])
            return [(name, f"{given.in_words()}{_more(value['pressures_kpa'])}")]
        return [(name, given.in_words())]
    if key == "seismic":
        coefficient, trend = (
            (value["coefficient"], value["trend_deg"]) if isinstance(value, Mapping) else (value, None)  # of benches
        )
        toward = "" if trend is None else f" toward {trend:03.0f}"
        return [("seismic coefficient", f"{coefficient:.4g} g{toward}" if coefficient else "none")]
    if isinstance(value, Mapping):
        parts = [(part, own) for part, own in value.items() if own not in (None, [])]
        return [row for part, own in parts for row in rows_of(part, own, f"{name}: {words(part)}")]
    if key == "rules" and value:
        return [(name, ", ".join(f"{one['name']} {one['relation']} {_plain(one['value'])}" for one in value))]
    if isinstance(value, list) and any(value) and all(one is None or isinstance(one, Mapping) for one in value):
        rows: list[tuple[str, ...]] = []
        for k, one in enumerate(value[:_MOST]):
            if one is None:
                continue
            said = "; ".join(f"{words(part)} {value_text(part, own)}" for part, own in one.items()
                             if own is not None and part != "name")  # fmt: skip
            rows.append((f"{name} {one.get('name', k + 1)}", said))
        left = len(value) - _MOST
        return [*rows, (f"... {left} more", "in the JSON")] if left > 0 else rows
    return [(name, value_text(key, value))]
