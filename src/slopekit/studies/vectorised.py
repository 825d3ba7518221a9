"""The closed forms of a design over arrays of samples: which of their arguments follow which column of the samples.

The arguments are found by reading the design at some samples: each has to be the same at all of them, or a straight
line in one column. Where one is neither (a force whose direction scatters, a density times a gravity that both
scatter), there is no such evaluator, and the samples are read one by one.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from slopekit.analysis.plane import WIDEST_DEG
from slopekit.arrays import Floats
from slopekit.design.common import Design
from slopekit.design.files import with_values
from slopekit.design.kinds import PlaneDesign
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import DesignError

#: The flat arguments of a closed form; None for what a design does not have.
Arguments: TypeAlias = dict[str, float | None]
#: A design's values at a sample: what `with_values` takes.
ValuesAt = Callable[[int], Mapping[str, object]]
_EXACT = 1e-12
_PROBES, _FEWEST = 24, 6


@dataclass(frozen=True, slots=True)
class Line:
    """An argument that follows one column of the samples: constant + slope x."""

    column: int
    constant: float
    slope: float

    def at(self, values: Floats) -> Floats:
        """The argument at samples (n, k)."""
        x: Floats = values[:, self.column]
        return x if (self.constant, self.slope) == (0.0, 1.0) else self.constant + self.slope * x


@dataclass(frozen=True, slots=True)
class Answers:
    """What a closed form says of samples: names of outcomes, the number of each sample's (n,), factors (n,) or nan."""

    names: tuple[str, ...]
    outcome: np.ndarray
    factor: Floats


@dataclass(frozen=True, slots=True)
class Vectorised:
    """A closed form over samples (n, k): arguments that are the same for all, and those that follow a column."""

    closed_form: Callable[[Mapping[str, Any]], Answers]
    fixed: Arguments
    lines: Mapping[str, Line]

    def __call__(self, values: Floats) -> Answers:
        """Outcome and factor of every sample."""
        found = self.closed_form(self.fixed | {name: line.at(values) for name, line in self.lines.items()})
        if len(found.factor) == len(values):
            return found
        # nothing that scatters is an argument: all samples are alike
        return Answers(found.names, np.repeat(found.outcome, len(values)), np.repeat(found.factor, len(values)))


def vectorised(design: Design, values: Floats, values_at: ValuesAt) -> Vectorised | None:
    """The evaluator of a design over its samples, None where there is none.

    Parameters
    ----------
    values : (n, k) samples; values_at : the values of the design's file at one of them, by its number
    """
    kind = next((known for known in _KINDS if isinstance(design, known)), None)
    if kind is None or any(bolt.acts == "passive" for bolt in design.bolts) or _curved(design):
        return None
    arguments_of, closed_form = _KINDS[kind]
    rows, read = [], []
    for row in _probes(values):
        try:
            changed = with_values(design, values_at(row))
        except DesignError:
            continue  # a sample that no design can have
        rows.append(row)
        read.append(arguments_of(changed))
    if len(rows) < min(_FEWEST, len(values)):
        return None
    fixed: Arguments = {}
    lines: dict[str, Line] = {}
    for name, first in read[0].items():
        found = [arguments[name] for arguments in read]
        if all(value == first for value in found):
            fixed[name] = first
            continue
        line = None if None in found else _line(values[rows], np.array(found, dtype=np.float64))
        if line is None:
            return None
        lines[name] = line
    return Vectorised(closed_form, fixed, lines)


def _curved(design: Design) -> bool:
    """Whether strength is curved: the closed form is asked again and again then, sample by sample."""
    if isinstance(design, WedgeDesign):
        return any(design.laws)
    return isinstance(design, PlaneDesign) and design.strength.law is not None


def _probes(values: Floats) -> Iterable[int]:
    """Samples to look at: the first ones, and the extremes of each column, where a line would first show its bend."""
    extremes = [*values.argmin(axis=0).tolist(), *values.argmax(axis=0).tolist()]
    return dict.fromkeys([*range(min(_PROBES, len(values))), *extremes])


def _line(values: Floats, found: Floats) -> Line | None:
    """The column (m, k) that an argument (m,) follows, exactly or in a straight line."""
    for column, x in enumerate(values.T):
        if np.array_equal(x, found):
            return Line(column, 0.0, 1.0)
    for column, x in enumerate(values.T):
        low, high = int(x.argmin()), int(x.argmax())
        if x[low] == x[high]:
            continue
        slope = float((found[high] - found[low]) / (x[high] - x[low]))
        constant = float(found[low] - slope * x[low])
        if abs(constant) <= _EXACT * float(np.abs(found).max()):
            constant, slope = 0.0, float(found[high] / x[high]) if x[high] else slope
        if np.allclose(constant + slope * x, found, rtol=_EXACT, atol=_EXACT * float(np.abs(found).max())):
            return Line(column, constant, slope)
    return None


# -- wedges ---------------------------------------------------------------------------------------------------------


def _wedge_arguments(design: Design) -> Arguments:
    assert isinstance(design, WedgeDesign)
    found: Arguments = {}
    planes = {"joint1": design.joints[0], "joint2": design.joints[1], "face": design.face, "upper": design.upper}
    for name, plane in planes.items():
        found |= {f"{name}_dip_deg": plane.dip_deg, f"{name}_dip_direction_deg": plane.dip_direction_deg}
    water, crack = design.water, design.crack
    given = water.mode == "pressures"
    pressures = [*water.pressures_kpa, 0.0, 0.0, 0.0] if given else [None] * 3
    found |= {
        "height_m": design.height_m, "cohesion1_kpa": design.cohesion_kpa[0], "cohesion2_kpa": design.cohesion_kpa[1],
        "friction1_deg": design.friction_angle_deg[0], "friction2_deg": design.friction_angle_deg[1],
        "unit_weight_kn_m3": design.unit_weight_kn_m3, "fill": 0.0 if given else water.fill,
        "water_unit_weight_kn_m3": design.water_unit_weight_kn_m3, "crack_fill": water.crack_fill,
        "pressure1": pressures[0], "pressure2": pressures[1], "pressure5": pressures[2],
        "crack_dip_deg": None if crack is None else crack.plane.dip_deg,
        "crack_dip_direction_deg": None if crack is None else crack.plane.dip_direction_deg,
        "crack_distance_m": 0.0 if crack is None else crack.distance_m,
        "seismic": design.seismic.coefficient, "seismic_trend_deg": design.seismic.trend_deg,
    }  # fmt: skip
    return found | _force(design)


def _force(design: Design) -> Arguments:
    """The sum of the forces and the active bolts: east, north, up; None without any."""
    pulls: list[Sequence[float]] = [force.components_kn for force in design.forces]
    pulls += [(bolt.force_kn * bolt.toward.vector()).tolist() for bolt in design.bolts if bolt.acts == "active"]
    if not pulls:
        return dict.fromkeys(("force_east", "force_north", "force_up"))
    return dict(zip(("force_east", "force_north", "force_up"), np.sum(pulls, axis=0).tolist(), strict=True))


def _wedges(arguments: Mapping[str, Any]) -> Answers:
    from slopekit.closed_form.wedges import OUTCOMES, WedgeArrays, hoek_bray_wedges

    given = dict(arguments)
    pressures = [given.pop(name) for name in ("pressure1", "pressure2", "pressure5")]
    force = [given.pop(name) for name in ("force_east", "force_north", "force_up")]
    wedges = WedgeArrays(
        **given,
        pressures_kpa=() if pressures[0] is None else pressures,
        force_kn=None if force[0] is None else force,
    )
    found = hoek_bray_wedges(wedges)
    return Answers(OUTCOMES, found.outcome, found.factor)


# -- planes ---------------------------------------------------------------------------------------------------------


def _plane_arguments(design: Design) -> Arguments:
    assert isinstance(design, PlaneDesign)
    found: Arguments = {}
    for name, plane in {"plane": design.joint, "face": design.face, "upper": design.upper}.items():
        found |= {f"{name}_dip_deg": plane.dip_deg, f"{name}_direction": plane.dip_direction_deg}
    water, crack = design.water, design.crack
    given = water.mode == "pressures"
    pressures = [*water.pressures_kpa, 0.0] if given else [None, None]
    return found | _force(design) | {
        "height_m": design.height_m, "cohesion_kpa": design.strength.cohesion_kpa,
        "friction_deg": design.strength.friction_angle_deg, "unit_weight_kn_m3": design.unit_weight_kn_m3,
        "crack_depth_m": None if crack is None else crack.depth_m,
        "crack_distance_m": None if crack is None else crack.distance_m,
        "water_in_crack_m": None if crack is None or given else crack.water_m,
        "fill": 0.0 if given else water.fill, "pressure_kpa": pressures[0], "crack_pressure_kpa": pressures[1],
        "water_unit_weight_kn_m3": design.water_unit_weight_kn_m3, "k": design.seismic.coefficient,
        "trend": design.seismic.trend_deg,
    }  # fmt: skip


def _planes(arguments: Mapping[str, Any]) -> Answers:
    from slopekit.closed_form.planes import OUTCOMES, PlaneArrays, plane_failures

    given = dict(arguments)
    plane, face, upper = (given.pop(f"{name}_direction") for name in ("plane", "face", "upper"))
    across = _strikes_across(given["plane_dip_deg"], plane, face) | _strikes_across(given["upper_dip_deg"], upper, face)
    for name, direction in (("plane", plane), ("upper", upper)):
        given[f"{name}_dip_deg"] = _signed(given[f"{name}_dip_deg"], direction, face)
    k, trend = given.pop("k"), given.pop("trend")
    given["seismic"] = k if trend is None else k * np.cos(np.radians(np.subtract(trend, face)))
    east, north, up = (given.pop(f"force_{name}") for name in ("east", "north", "up"))
    turned = np.radians(face)
    given["force_kn"] = None if up is None else (east * np.sin(turned) + north * np.cos(turned), up)
    found = plane_failures(PlaneArrays(**given))
    count = max(found.outcome.size, np.size(across))
    names = tuple("slides_on_J1" if name == "slides" else name for name in OUTCOMES)
    outcome: np.ndarray = np.broadcast_to(found.outcome, count).copy()
    factor: Floats = np.broadcast_to(found.factor, count).copy()
    outcome[np.broadcast_to(across, count)], factor[np.broadcast_to(across, count)] = len(names), np.nan
    return Answers((*names, "E213"), outcome, factor)


def _strikes_across(dip: Any, direction: Any, face: Any) -> Any:
    """Whether a plane strikes too far from the face for plane failure (Hoek & Bray 1981, ch. 7)."""
    apart = np.abs(np.subtract(direction, face)) % 180.0
    return (np.minimum(apart, 180.0 - apart) > WIDEST_DEG) & (np.asarray(dip) > 0.0)


def _signed(dip: Any, direction: Any, face: Any) -> Any:
    """Dip, positive where the plane dips the way of the face."""
    return np.where(np.cos(np.radians(np.subtract(direction, face))) >= 0.0, dip, -np.asarray(dip))


_KINDS: Mapping[type[Design], tuple[Callable[[Design], Arguments], Callable[..., Answers]]] = {
    WedgeDesign: (_wedge_arguments, _wedges),
    PlaneDesign: (_plane_arguments, _planes),
}
