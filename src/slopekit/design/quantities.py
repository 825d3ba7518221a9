"""What each number of a design file measures, and the values that a design of that kind takes: one table.

The readers of the kinds say what is wrong with a value and where; here the same limits stand for values that are drawn,
thousands at a time, and never read. A test holds the two together.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

from slopekit.design.strength_laws import LAW_KEYS


@dataclass(frozen=True, slots=True)
class Quantity:
    """What a number measures, as `slopekit.units.quantity` names it, and between which limits it lies.

    `turns` are angles of orientations: what lies beyond their limits is the same plane or line, written otherwise.
    """

    kind: str = "ratio"
    least: float = -inf
    most: float = inf
    turns: bool = False


_PRESSURE, _LENGTH = Quantity("pressure", 0.0), Quantity("length", 0.0)
_FRICTION, _FORCE = Quantity("angle", 0.0, 90.0), Quantity("force", 0.0)
_STIFFNESS, _UNIT_WEIGHT = Quantity("stiffness", 0.0), Quantity("unit weight", 5.0, 400.0)
_PART, _SEISMIC = Quantity("ratio", 0.0, 1.0), Quantity("ratio", 0.0, 2.0)
_DIP, _DIRECTION = Quantity("angle", 0.0, 90.0, turns=True), Quantity("angle", 0.0, 360.0, turns=True)
_PLUNGE = Quantity("angle", -90.0, 90.0, turns=True)

#: By dotted path; * is a name of the user's or the number of a list item; a row of one kind stands before that of all.
_TABLE: Mapping[str, Quantity] = {
    "strength.*.c": _PRESSURE, "strength.*.phi": _FRICTION, "strength.*.dilation": _FRICTION,
    "strength.*.tension": _PRESSURE,
    **{f"strength.*.{key}": Quantity(*measured) for key, measured in LAW_KEYS.items()},
    "strength.*.stiffness.normal": _STIFFNESS,
    "strength.*.stiffness.shear": _STIFFNESS, "strength.*.stiffness.shear.phi": _FRICTION,
    "strength.*.stiffness.shear.k1": Quantity("ratio", 0.0), "strength.*.stiffness.shear.Rf": _PART,
    "strength.*.stiffness.shear.n": Quantity("ratio", 0.0, 2.0),
    "rock.density": Quantity("density", 500.0, 10000.0), "rock.unit_weight": _UNIT_WEIGHT,
    "rock.gravity": Quantity("acceleration", 1.0, 25.0),
    "slope.height": _LENGTH, "wedge:slope.height": Quantity("length", 1e-6, 1e7), "slope.length": _LENGTH,
    "slope.depth": _LENGTH, "*.*.plane.dip": _DIP, "*.*.plane.dip_direction": _DIRECTION, "slope.*.dip": _DIP,
    "slope.*.dip_direction": _DIRECTION, "crack.plane.dip": _DIP, "crack.plane.dip_direction": _DIRECTION,
    "crack.depth": _LENGTH, "crack.distance": _LENGTH, "plane:crack.distance": Quantity("length"),
    "plane:crack.water": _LENGTH,
    "water.fill": _PART, "water.pressures": _PRESSURE, "water.pressures.*": _PRESSURE,
    "water.unit_weight": Quantity("unit weight", 5.0, 15.0),
    "loads.seismic": _SEISMIC, "loads.seismic.k": _SEISMIC, "loads.forces.*.force": Quantity("force"),
    "support.bolts.*.force": _FORCE, "support.bolts.*.length": _LENGTH,
    "*.*.*.toward.plunge": _PLUNGE, "*.*.*.toward.trend": _DIRECTION,
    "footing.load": _FORCE, "footing.at": _LENGTH, "weak_plane.dip": Quantity("angle", 0.0, 89.9),
    "weak_plane.length": _LENGTH, "slip.radius": _LENGTH, "slip.length": _LENGTH,
    "columns.dip": Quantity("angle", 0.0, 90.0), "columns.width": _LENGTH, "columns.heights.*": _LENGTH,
    "columns.base_step": _LENGTH, "columns.thickness": _LENGTH,
    "sets.*.spacing": _LENGTH, "sets.*.offset": Quantity("length"), "sets.*.scatter": Quantity("angle", 0.0, 45.0),
    "sets.*.spacing_scatter": _PART, "section.thickness": _LENGTH, "blocks.*.unit_weight": _UNIT_WEIGHT,
}  # fmt: skip


def quantity_of(path: str, kind: str) -> Quantity:
    """What the number at a dotted path of a design measures, and its limits.

    Parameters
    ----------
    kind : of the design: wedge, plane, ...

    >>> quantity_of("strength.weak.phi", "wedge")
    Quantity(kind='angle', least=0.0, most=90.0, turns=False)
    >>> quantity_of("columns.heights.3", "topple").kind
    'length'
    """
    parts = path.split(".")
    for row in (f"{kind}:", ""):
        for pattern, found in _TABLE.items():
            names = pattern.removeprefix(row).split(".") if pattern.startswith(row) else []
            if len(names) == len(parts) and all(name in ("*", part) for name, part in zip(names, parts, strict=True)):
                return found
    return Quantity()
