"""What a study of all pairs is given: the joints with their strengths, the slope, limits of size, the target."""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from slopekit.arrays import Floats
from slopekit.design import words
from slopekit.design.joint_lists import JointList, joint_list, own_or_given, plane_of
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Plane, number
from slopekit.studies.pair_shapes import SizeLimits
from slopekit.units import quantity

HEIGHT_M = 15.0
TOP = 10
_SLOPE = (
    "upper", "height", "c", "phi", "density", "unit_weight", "water", "seismic", "gravity", "water_unit_weight",
    "agree_within",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class PairInputs:
    """Everything that the pairs of a list depend on.

    Attributes
    ----------
    slope : face, upper slope, height and loads as a wedge design whose joints mean nothing
    cohesion_kpa, friction_deg : (n,) of the joints; own : how many have their own c and phi
    target : factor of safety, None without; top : how many of the worst PRE-IE looks at
    defaults : names of the inputs that were left out
    """

    joints: JointList
    slope: WedgeDesign
    limits: SizeLimits
    cohesion_kpa: Floats
    friction_deg: Floats
    own: tuple[int, int]
    target: float | None
    top: int
    defaults: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """All but the joints, as JSON values."""
        slope, water = self.slope, self.slope.water
        return {
            "face": str(slope.face), "upper": str(slope.upper), "height_m": slope.height_m,
            "unit_weight_kn_m3": slope.unit_weight_kn_m3, "density_kg_m3": slope.density_kg_m3,
            "water": {"mode": water.mode, "fill": water.fill, "pressures_kpa": list(water.pressures_kpa[:1])},
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3,
            "seismic": {"k": slope.seismic.coefficient, "trend_deg": slope.seismic.trend_deg},
            "agree_within": slope.agree_within,
            "cohesion_kpa": _range(self.cohesion_kpa, self.own[0]),
            "friction_deg": _range(self.friction_deg, self.own[1]),
            "limits": self.limits.to_dict(), "fos": self.target, "top": self.top,
        }  # fmt: skip

    def input_hash(self) -> str:
        """SHA-256 of the inputs and the joints with their strengths."""
        planes = [(plane.dip_deg, plane.dip_direction_deg) for plane in (self.slope.face, self.slope.upper)]
        strengths = [self.cohesion_kpa.tolist(), self.friction_deg.tolist()]
        exact = [self.to_dict(), planes, self.joints.rows(), strengths]
        return hashlib.sha256(json.dumps(exact, sort_keys=True).encode()).hexdigest()


def pair_inputs(
    joints: Any,
    given: Mapping[str, Any],
    limits: Mapping[str, Any],
    convention: str | None,
    skip_bad: bool,
    fos: Any,
    top: Any,
    option: Callable[[str], str],
) -> PairInputs:
    """Read and check what `combos` is given; every fault at once."""
    faults: list[Fault] = []

    def read(convert: Callable[[], Any]) -> Any:
        try:
            return convert()
        except DesignError as error:
            faults.extend(error.faults)
            return None

    listed: JointList | None = read(partial(joint_list, joints, convention, skip_bad, 2))
    face: Plane | None = read(partial(plane_of, given.get("face"), "face", option("face")))
    slope: WedgeDesign | None = read(partial(_slope, given, face, option))
    sizes: SizeLimits | None = read(partial(_limits, limits, option))
    where = f"{option('fos')} {fos}"
    target = None if fos is None else read(partial(words.above_zero, fos, "ratio", "fos", "E336", where))
    most: int | None = TOP if top is None else read(partial(_whole, top, option("top")))
    strengths = []
    if listed is not None:
        for key in ("c", "phi"):
            # where the slope is faulty, what is missing is still said
            common = None if given.get(key) is None else 0.0
            if slope is not None and common is not None:
                common = (slope.cohesion_kpa if key == "c" else slope.friction_angle_deg)[0]
            values, own, fault = own_or_given(listed, "c" if key == "c" else "phi", common, option(key))
            strengths.append((values, own))
            faults += [] if fault is None else [fault]
    if faults:
        raise DesignError(faults)
    # no fault, so nothing is missing: what follows only tells the type checker
    assert listed is not None and slope is not None and sizes is not None and most is not None  # noqa: PT018
    defaults = tuple(
        name for name in ("upper", "height", "density", "seismic.trend")
        if name in slope.defaults or (name in ("upper", "height") and given.get(name) is None)
    )  # fmt: skip
    (cohesion, own_c), (friction, own_phi) = strengths
    return PairInputs(listed, slope, sizes, cohesion, friction, (own_c, own_phi), target, most, defaults)


def _slope(given: Mapping[str, Any], face: Plane | None, option: Callable[[str], str]) -> WedgeDesign:
    """The slope and its loads, read as a wedge whose joints mean nothing."""
    from slopekit.design.reading import wedge_design

    face = face or Plane(60.0, 180.0)
    own = {key: given.get(key) for key in _SLOPE}
    unknown = {key: value for key, value in given.items() if key not in (*_SLOPE, "face")}
    own["upper"] = Plane(0.0, face.dip_direction_deg) if own["upper"] is None else own["upper"]
    own["height"] = HEIGHT_M if own["height"] is None else own["height"]
    joints = (Plane(45.0, face.dip_direction_deg), Plane(45.0, (face.dip_direction_deg + 90.0) % 360.0))
    faults: list[Fault] = []
    for key in ("c", "phi", "water"):
        if _has_two(own[key]):
            message = f"{key} has two values: the joints of a list are no J1 and J2"
            advice = "Give one value for all; columns c and phi of the list give each joint its own."
            faults.append(Fault("E339", message, f"{option(key)} {words.shown(own[key])}", advice))
            own[key] = None
    try:
        slope = wedge_design({"dips": joints, "face": face, **own, **unknown}, option)
    except DesignError as error:
        own_faults = [replace(fault, message=fault.message.replace(" of J1", "")) for fault in error.faults]
        raise DesignError([*faults, *own_faults]) from None
    if faults:
        raise DesignError(faults)
    return slope


def _has_two(value: object) -> bool:
    parts = value.split(",") if isinstance(value, str) else value if isinstance(value, list | tuple) else ()
    return len(parts) > 1 and any(part != parts[0] for part in parts)


def _limits(given: Mapping[str, Any], option: Callable[[str], str]) -> SizeLimits:
    faults: list[Fault] = []
    found: dict[str, float | None] = {}
    for key, kind, unit in (
        ("persistence", "length", "_m"), ("bench_width", "length", "_m"), ("max_volume", "volume", "_m3"),
        ("min_volume", "volume", "_m3"),
    ):  # fmt: skip
        value = given.get(key)
        try:
            where = f"{option(key)} {value}"
            found[key + unit] = (
                None if value is None else words.above_zero(value, kind, key.replace("_", " "), "E334", where)
            )
        except DesignError as error:
            faults += error.faults
    least, most = found.get("min_volume_m3"), found.get("max_volume_m3")
    if least is not None and most is not None and least > most:
        message = f"min volume {number(least)} m³ is more than max volume {number(most)} m³: nothing would be left"
        faults.append(Fault("E334", message, option("min_volume")))
    if faults:
        raise DesignError(faults)
    return SizeLimits(**found)


def _whole(value: object, option: str) -> int:
    found = quantity(value, "ratio", "top", f"{option} {value}")
    if found != int(found) or found < 0:
        advice = "It is how many of the worst pairs PRE-IE looks at; 0 leaves it out."
        raise DesignError(
            [Fault("E335", f"top is {number(found)}, a whole number is needed", f"{option} {value}", advice)]
        )
    return int(found)


def _range(values: Floats, own: int) -> dict[str, float | int]:
    return {"least": float(values.min()), "most": float(values.max()), "own": own, "given": len(values) - own}
