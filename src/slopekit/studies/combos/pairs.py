"""All pairs of a joint survey: what is given, the wedges that they cut, what becomes of each by the closed form.

One height serves every pair: the slope's own, vertical, from the toe of a wedge to the crest straight up the dip of
the face. Where the crest is level, that is the height of every trace too. Where it is not, the heights of traces differ
(Hoek & Bray's H1 is the height at the trace of joint 1), so that of each trace follows from the one given.

A wedge that a limit makes smaller keeps its shape and its crest: its toe moves up the face.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import numpy as np

from slopekit.closed_form.sizes import wedge_sizes
from slopekit.closed_form.wedge import OUTCOMES, WedgeArrays, hoek_bray_wedges
from slopekit.core.arrays import Bools, Floats, Ints, NDArray
from slopekit.core.codec import digest, json_of
from slopekit.core.errors import Fault, Faults, GeometryError, fail
from slopekit.core.orientation import Plane, number
from slopekit.core.units import quantity
from slopekit.design.fields import declare
from slopekit.design.joint_lists import JointList, joint_list, plane_of
from slopekit.geometry.rock.rockmass import no_crest
from slopekit.geometry.tolerances import SAME_DIRECTION
from slopekit.kinds.wedge.design import SizeLimits, WedgeDesign
from slopekit.kinds.wedge.limits import Fitted, within
from slopekit.studies.protocol import numbers_given
from slopekit.studies.surveys import range_of, slope_of, strengths_of_joints

HEIGHT_M = 15.0
TOP, ALL = 10, "all"
_SLOPE = ("upper", "height", "c", "phi", "density", "unit_weight", "water", "seismic")
#: Why a pair cuts no wedge that could leave the slope, by the code that one wedge would have (`explain CODE`).
NOT_REMOVABLE: Mapping[str, str] = {
    "E201": "parallel", "E203": "too_steep", "E204": "into_the_slope", "E205": "flatter_than_upper_slope",
    "E206": "along_the_face", "E207": "no_crack", "E208": "no_wedge", "E209": "no_crest",
}  # fmt: skip
#: What may become of a pair.
PAIR_OUTCOMES = (*(NOT_REMOVABLE.get(name, name) for name in OUTCOMES), "below_min_volume", "beyond_limits")
TOO_SMALL, TOO_LARGE = len(OUTCOMES), len(OUTCOMES) + 1
_TARGET = {"fos": declare("fos", "ratio", 0.0, above=True, code="E307")}
#: Limits of size by their parameters.
_SIZES = {
    name: declare(
        name.replace("_", " "), "volume" if name.endswith("volume") else "length", 0.0, above=True, code="E116"
    )
    for name in ("persistence", "bench_width", "max_volume", "min_volume", "trace_length", "slope_length")
}
NEVER = ("no_crack", "no_crest")  # pairs have no crack, and the crest is looked at before
_STATUSES = OUTCOMES.index("E201")  # below it: a wedge is there
_SLIDES = tuple(OUTCOMES.index(f"slides_{way}") for way in ("on_both", "on_J1", "on_J2", "up"))
_NO_CORNER = OUTCOMES.index("E206")
_AT_ONCE = 1 << 18  # pairs: 4.5 million at a time would take gigabytes


def crest_offset(face: Plane, upper: Plane, height_m: float) -> float:
    """Offset of the upper slope from the toe of a wedge: normal · x at the crest.

    Raises
    ------
    GeometryError
        E209 face and upper slope make no crest above the toe.
    """
    edge = np.cross(face.normal(), upper.normal())
    if math.sqrt(float(edge @ edge)) < SAME_DIRECTION:
        raise no_crest()
    offset = float(upper.normal() @ _crest_point(face, height_m))
    if not offset > SAME_DIRECTION * height_m or math.hypot(edge[0], edge[1]) < SAME_DIRECTION:
        message = f"the upper slope ({upper}) climbs as fast as the face ({face}): they make no crest above the toe"
        raise GeometryError([Fault("E209", message)])
    return offset


def _ordered(joints: JointList, first: Ints, second: Ints, slope: WedgeDesign) -> tuple[Ints, Ints, Floats]:
    """Pairs (m,) in the order in which the first joint's trace climbs to the crest, where one does, and its height."""
    offset = crest_offset(slope.face, slope.upper, slope.height_m)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        traces = np.cross(joints.normals(), slope.face.normal())
        climb = traces @ slope.upper.normal()
        flat = (np.abs(climb) < SAME_DIRECTION) | (np.abs(traces[:, 2]) < SAME_DIRECTION)
        heights = (traces * np.where(flat, 0.0, offset / climb)[:, None])[:, 2]
    swap = (heights[first] <= 0.0) & (heights[second] > 0.0)
    one, two = np.where(swap, second, first), np.where(swap, first, second)
    return one, two, heights[one]


def _crest_point(face: Plane, height_m: float) -> Floats:
    """The crest straight up the dip of the face from the toe, (3,)."""
    dip, direction = math.radians(face.dip_deg), math.radians(face.dip_direction_deg)
    back = math.cos(dip) / math.sin(dip) if face.dip_deg > 0.0 else math.inf
    return height_m * np.array([-math.sin(direction) * back, -math.cos(direction) * back, 1.0])


@dataclass(frozen=True)
class PairInputs:
    """Everything that the pairs of a list depend on.

    Attributes
    ----------
    slope : face, upper slope, height and loads as a wedge design whose joints mean nothing
    cohesion_kpa, friction_deg : (n,) of the joints; own : how many have their own c and phi
    target : factor of safety, None without; top : how many of the worst are listed, None: all
    defaults : names of the inputs that were left out
    """

    joints: JointList
    slope: WedgeDesign
    limits: SizeLimits
    cohesion_kpa: Floats
    friction_deg: Floats
    own: tuple[int, int]
    target: float | None
    top: int | None
    defaults: tuple[str, ...]

    @property
    def limits_of_all(self) -> dict[str, Any]:
        """The limits of size by their names: of a joint that for all joints."""
        return {name: one[0] if isinstance(one, list) else one for name, one in json_of(self.limits).items()}

    def to_dict(self) -> dict[str, Any]:
        """All but the joints, as JSON values."""
        slope, water = self.slope, self.slope.water
        return {
            "face": str(slope.face), "upper": str(slope.upper), "height_m": slope.height_m,
            "unit_weight_kn_m3": slope.rock.unit_weight_kn_m3, "density_kg_m3": slope.rock.density_kg_m3,
            "water": {"mode": water.mode, "fill": water.fill, "pressures_kpa": list(water.pressures_kpa[:1])},
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3,
            "seismic": {"k": slope.seismic.coefficient, "trend_deg": slope.seismic.trend_deg},
            "agree_within": slope.analysis.agree_within,
            "cohesion_kpa": range_of(self.cohesion_kpa, self.own[0]),
            "friction_deg": range_of(self.friction_deg, self.own[1]),
            "limits": self.limits_of_all, "fos": self.target, "top": ALL if self.top is None else self.top,
        }  # fmt: skip

    def input_hash(self) -> str:
        """SHA-256 of the inputs and the joints with their strengths."""
        planes = [(plane.dip_deg, plane.dip_direction_deg) for plane in (self.slope.face, self.slope.upper)]
        strengths = [self.cohesion_kpa.tolist(), self.friction_deg.tolist()]
        inputs = self.to_dict()
        for key, unsaid in (("trace_length_m", None), ("slope_length_m", None), ("by", "scale")):
            if inputs["limits"][key] == unsaid:
                del inputs["limits"][key]
        exact = [inputs, planes, self.joints.rows(), strengths]
        return digest(exact)


def pair_inputs(given: Mapping[str, Any], option: Callable[[str], str]) -> PairInputs:
    """Read and check what `combos` is given, by the names of its parameters; every fault at once."""
    faults = Faults()
    listed: JointList | None = faults.of(
        partial(
            joint_list,
            given["joints"],
            given["convention"],
            given["skip_bad"],
            2,
            option("convention"),
            columns=given["columns"],
        )
    )
    face: Plane | None = faults.of(partial(plane_of, given["face"], "face", option("face")))
    slope: WedgeDesign | None = faults.of(partial(_slope, given, face, option))
    sizes: SizeLimits | None = faults.of(partial(_limits, given, option))
    target = numbers_given(_TARGET, given, option, faults)["fos"]
    top = faults.of(partial(_top, given["top"], option("top")))
    strengths: list[tuple[Floats, int]] = []
    if listed is not None:
        strengths, missing = strengths_of_joints(listed, given, slope, option)
        faults += missing
    faults.refuse()
    # no fault, so nothing is missing: what follows only tells the type checker
    assert listed is not None and slope is not None and sizes is not None  # noqa: PT018
    defaults = tuple(
        name for name in ("upper", "height", "density", "seismic.trend")
        if name in slope.reading.defaults or (name in ("upper", "height") and given.get(name) is None)
    )  # fmt: skip
    (cohesion, own_c), (friction, own_phi) = strengths
    return PairInputs(listed, slope, sizes, cohesion, friction, (own_c, own_phi), target, top, defaults)


def _slope(given: Mapping[str, Any], face: Plane | None, option: Callable[[str], str]) -> WedgeDesign:
    """The slope and its loads."""
    face = face or Plane(60.0, 180.0)
    own = {key: given[key] for key in _SLOPE}
    own["upper"] = Plane(0.0, face.dip_direction_deg) if own["upper"] is None else own["upper"]
    own["height"] = HEIGHT_M if own["height"] is None else own["height"]
    joints = Plane(45.0, face.dip_direction_deg), Plane(45.0, (face.dip_direction_deg + 90.0) % 360.0)
    slope, faults = slope_of({"dips": joints, "face": face, **own}, option)
    faults.refuse()
    return slope


def _limits(given: Mapping[str, Any], option: Callable[[str], str]) -> SizeLimits:
    faults = Faults()
    limits: dict[str, Any] = {
        f"{name}_m3" if name.endswith("volume") else f"{name}_m": value
        for name, value in numbers_given(_SIZES, given, option, faults).items()
    }
    least, most = limits.get("min_volume_m3"), limits.get("max_volume_m3")
    if least is not None and most is not None and least > most:
        faults.add(
            "E116",
            f"min volume {number(least)} m³ is more than max volume {number(most)} m³: nothing would be left",
            option("min_volume"),
        )
    by = "scale" if given.get("limit_by") is None else str(given["limit_by"]).strip().lower()
    if by not in ("scale", "filter"):
        faults.add(
            "E126",
            f"limits of size go by {by!r}, it is scale or filter",
            option("limit_by"),
            "scale makes larger wedges smaller, filter leaves them out.",
        )
    faults.refuse()
    each = {name: (limits.get(name),) * 2 for name in ("trace_length_m", "persistence_m")}
    return SizeLimits(**{**limits, **each}, by=by)


def _top(value: object, option: str) -> int | None:
    if value is None:
        return TOP
    if value == ALL:
        return None
    top = quantity(value, "ratio", "top", f"{option} {value}")
    if top != int(top) or top < 0:
        fail(
            "E126",
            f"top is {number(top)}, a whole number is needed",
            f"{option} {value}",
            "It is how many of the worst pairs are listed, or all.",
        )
    return int(top)


@dataclass(frozen=True)
class JointPairs(Fitted):
    """Every pair of the list as a wedge within the limits of size, (m,) each; where it cuts none they mean nothing.

    Attributes
    ----------
    first, second : indices of the joints, in the order in which the height is that of the first one's trace
    height_m : of that trace at the wedge's own size, 0 or less where neither trace climbs to the crest
    outcome : index into `PAIR_OUTCOMES`; factor : of the closed form, nan unless the wedge slides
    volume_m3, trend_deg, plunge_deg : of the wedge at its size and its line of intersection, nan where there is none
    """

    first: Ints
    second: Ints
    height_m: Floats
    outcome: NDArray[np.int8]
    factor: Floats
    volume_m3: Floats
    trend_deg: Floats
    plunge_deg: Floats

    def __len__(self) -> int:
        return len(self.outcome)

    @property
    def is_removable(self) -> Bools:
        """Which pairs form a wedge that could leave the slope, and is large enough to count."""
        return self.outcome < _STATUSES


def joint_pairs(
    joints: JointList, slope: WedgeDesign, limits: SizeLimits, cohesion: Floats, friction: Floats
) -> JointPairs:
    """All pairs by the vectorised closed form, each wedge at the size that the limits leave it."""
    first, second = joints.pairs()
    parts = [
        _part(joints, slope, limits, cohesion, friction, first[at : at + _AT_ONCE], second[at : at + _AT_ONCE])
        for at in range(0, len(first), _AT_ONCE)
    ]
    return parts[0] if len(parts) == 1 else _joined(parts)


def _joined(parts: Sequence[Any]) -> Any:
    """Arrays, or records of them, one behind the other."""
    kind = type(parts[0])
    if kind is np.ndarray:
        return np.concatenate(parts)
    return kind(**{own.name: _joined([getattr(part, own.name) for part in parts]) for own in fields(kind)})


def _part(
    joints: JointList, slope: WedgeDesign, limits: SizeLimits, cohesion: Floats, friction: Floats, first: Ints,
    second: Ints,
) -> JointPairs:  # fmt: skip
    one, two, height = _ordered(joints, first, second, slope)
    dips, ways, face, upper = joints.dips_deg, joints.dip_directions_deg, slope.face, slope.upper
    sizes = wedge_sizes(
        dips[one], ways[one], dips[two], ways[two], face.dip_deg, face.dip_direction_deg, upper.dip_deg,
        upper.dip_direction_deg, slope.height_m, up_the_face=True,
    )  # fmt: skip
    fitted = within(limits, sizes)
    height = height * fitted.scale
    climbs = height > 0.0
    wedges = hoek_bray_wedges(
        WedgeArrays(
            joint1_dip_deg=dips[one], joint1_dip_direction_deg=ways[one], joint2_dip_deg=dips[two],
            joint2_dip_direction_deg=ways[two], face_dip_deg=slope.face.dip_deg,
            face_dip_direction_deg=slope.face.dip_direction_deg, upper_dip_deg=slope.upper.dip_deg,
            upper_dip_direction_deg=slope.upper.dip_direction_deg, height_m=np.where(climbs, height, 1.0),
            cohesion1_kpa=cohesion[one], cohesion2_kpa=cohesion[two], friction1_deg=friction[one],
            friction2_deg=friction[two], unit_weight_kn_m3=slope.rock.unit_weight_kn_m3, fill=slope.water.fill,
            pressures_kpa=slope.water.pressures_kpa[:2], water_unit_weight_kn_m3=slope.water_unit_weight_kn_m3,
            seismic=slope.seismic.coefficient, seismic_trend_deg=slope.seismic.trend_deg,
        ),
    )  # fmt: skip
    outcome, volume = wedges.outcome.copy(), wedges.volume_m3
    outcome[~climbs & (outcome < _STATUSES)] = _NO_CORNER
    for why, becomes in ((1, TOO_LARGE), (2, TOO_SMALL)):
        outcome[(outcome < _STATUSES) & (fitted.why == why)] = becomes
    factor = np.where(np.isin(outcome, _SLIDES), wedges.factor, np.nan)
    return JointPairs(
        fitted.sizes, fitted.scale, fitted.by, fitted.why, one, two, height, outcome, factor, volume,
        *wedges.line_trend_plunge_deg(),
    )  # fmt: skip
