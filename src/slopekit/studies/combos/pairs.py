"""All pairs of a joint survey: their inputs, the wedges that they cut, and the closed form of each.

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
from slopekit.design.joint_lists import JointList, joint_list, slope_plane
from slopekit.geometry.rock.rockmass import no_crest
from slopekit.geometry.tolerances import SAME_DIRECTION
from slopekit.kinds.wedge.design import SizeLimits, WedgeDesign
from slopekit.kinds.wedge.limits import Fitted, fitted_sizes
from slopekit.studies.protocol import numbers_given
from slopekit.studies.surveys import range_of, slope_of, strengths_of_joints

HEIGHT_M = 15.0
TOP, ALL = 10, "all"
_SLOPE_OPTIONS = ("upper", "height", "c", "phi", "density", "unit_weight", "water", "seismic")
#: Reasons why a pair cuts no removable wedge, by the code of a single wedge (`explain CODE`).
NOT_REMOVABLE: Mapping[str, str] = {
    "E201": "parallel",
    "E203": "too_steep",
    "E204": "into_the_slope",
    "E205": "flatter_than_upper_slope",
    "E206": "along_the_face",
    "E207": "no_crack",
    "E208": "no_wedge",
    "E209": "no_crest",
}
#: Outcomes of a pair.
PAIR_OUTCOMES = (
    *(NOT_REMOVABLE.get(name, name) for name in OUTCOMES),
    "below_min_volume",
    "beyond_limits",
)
TOO_SMALL, TOO_LARGE = len(OUTCOMES), len(OUTCOMES) + 1
_TARGET = {"fos": declare("fos", "ratio", 0.0, above=True, code="E307")}
#: Limits of size by their parameters.
_SIZE_LIMITS = {
    name: declare(
        name.replace("_", " "),
        "volume" if name.endswith("volume") else "length",
        0.0,
        above=True,
        code="E116",
    )
    for name in (
        "persistence",
        "bench_width",
        "max_volume",
        "min_volume",
        "trace_length",
        "slope_length",
    )
}
UNUSED_OUTCOMES = ("no_crack", "no_crest")  # pairs have no crack, and the crest is looked at before
_WEDGE_OUTCOMES = OUTCOMES.index("E201")  # below it: a wedge is there
_SLIDES = tuple(OUTCOMES.index(f"slides_{way}") for way in ("on_both", "on_J1", "on_J2", "up"))
_NO_CORNER = OUTCOMES.index("E206")
_PAIRS_PER_PIECE = 1 << 18  # pairs: 4.5 million at a time would take gigabytes


def crest_offset(face: Plane, upper: Plane, height_m: float) -> float:
    """Return the offset of the upper slope from the toe of a wedge in m: normal · x at the crest.

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


def _ordered_by_trace(
    joints: JointList, first: Ints, second: Ints, slope: WedgeDesign
) -> tuple[Ints, Ints, Floats]:
    """Return the joints of pairs (m,), first the one whose trace climbs to the crest, and that trace's height in m."""
    offset = crest_offset(slope.face, slope.upper, slope.height_m)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        traces = np.cross(joints.normals(), slope.face.normal())
        climb = traces @ slope.upper.normal()
        flat = (np.abs(climb) < SAME_DIRECTION) | (np.abs(traces[:, 2]) < SAME_DIRECTION)
        heights = (traces * np.where(flat, 0.0, offset / climb)[:, None])[:, 2]
    swap = (heights[first] <= 0.0) & (heights[second] > 0.0)
    climbing, partner = np.where(swap, second, first), np.where(swap, first, second)
    return climbing, partner, heights[climbing]


def _crest_point(face: Plane, height_m: float) -> Floats:
    """Return the crest point (3,) straight up the dip of the face from the toe."""
    dip, direction = math.radians(face.dip_deg), math.radians(face.dip_direction_deg)
    back = math.cos(dip) / math.sin(dip) if face.dip_deg > 0.0 else math.inf
    return height_m * np.array([-math.sin(direction) * back, -math.cos(direction) * back, 1.0])


@dataclass(frozen=True)
class PairInputs:
    """Inputs of the pairs of a joint list.

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
    own_strengths: tuple[int, int]
    target: float | None
    top: int | None
    defaults: tuple[str, ...]

    @property
    def limits_of_all(self) -> dict[str, Any]:
        """The limits of size by name, with one value for both joints."""
        return {
            name: limit[0] if isinstance(limit, list) else limit
            for name, limit in json_of(self.limits).items()
        }

    def to_dict(self) -> dict[str, Any]:
        """Return all inputs but the joints as JSON values."""
        slope, water = self.slope, self.slope.water
        return {
            "face": str(slope.face),
            "upper": str(slope.upper),
            "height_m": slope.height_m,
            "unit_weight_kn_m3": slope.rock.unit_weight_kn_m3,
            "density_kg_m3": slope.rock.density_kg_m3,
            "water": {
                "mode": water.mode,
                "fill": water.fill,
                "pressures_kpa": list(water.pressures_kpa[:1]),
            },
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3,
            "seismic": {"k": slope.seismic.coefficient, "trend_deg": slope.seismic.trend_deg},
            "agree_within": slope.analysis.agree_within,
            "cohesion_kpa": range_of(self.cohesion_kpa, self.own_strengths[0]),
            "friction_deg": range_of(self.friction_deg, self.own_strengths[1]),
            "limits": self.limits_of_all,
            "fos": self.target,
            "top": ALL if self.top is None else self.top,
        }

    def input_hash(self) -> str:
        """Return the SHA-256 of the inputs and the joints with their strengths."""
        planes = [
            (plane.dip_deg, plane.dip_direction_deg)
            for plane in (self.slope.face, self.slope.upper)
        ]
        strengths = [self.cohesion_kpa.tolist(), self.friction_deg.tolist()]
        inputs = self.to_dict()
        for key, default in (("trace_length_m", None), ("slope_length_m", None), ("by", "scale")):
            if inputs["limits"][key] == default:
                del inputs["limits"][key]
        exact = [inputs, planes, self.joints.rows(), strengths]
        return digest(exact)


def pair_inputs(options: Mapping[str, Any], option_name: Callable[[str], str]) -> PairInputs:
    """Read and check the options of `combos`, by the names of its parameters; every fault at once."""
    faults = Faults()
    listed: JointList | None = faults.of(
        partial(
            joint_list,
            options["joints"],
            options["convention"],
            options["skip_bad"],
            2,
            option_name("convention"),
            columns=options["columns"],
        )
    )
    face: Plane | None = faults.of(
        partial(slope_plane, options["face"], "face", option_name("face"))
    )
    slope: WedgeDesign | None = faults.of(partial(_slope, options, face, option_name))
    sizes: SizeLimits | None = faults.of(partial(_size_limits, options, option_name))
    target = numbers_given(_TARGET, options, option_name, faults)["fos"]
    top = faults.of(partial(_top, options["top"], option_name("top")))
    strengths: list[tuple[Floats, int]] = []
    if listed is not None:
        strengths, missing = strengths_of_joints(listed, options, slope, option_name)
        faults += missing
    faults.refuse()
    # no fault, so nothing is missing: what follows only tells the type checker
    assert listed is not None and slope is not None and sizes is not None  # noqa: PT018
    defaults = tuple(
        name
        for name in ("upper", "height", "density", "seismic.trend")
        if name in slope.reading.defaults
        or (name in ("upper", "height") and options.get(name) is None)
    )
    (cohesion, own_cohesions), (friction, own_frictions) = strengths
    return PairInputs(
        listed,
        slope,
        sizes,
        cohesion,
        friction,
        (own_cohesions, own_frictions),
        target,
        top,
        defaults,
    )


def _slope(
    options: Mapping[str, Any], face: Plane | None, option_name: Callable[[str], str]
) -> WedgeDesign:
    """Return face, upper slope, height and loads as a wedge design with placeholder joints."""
    face = face or Plane(60.0, 180.0)
    slope_options = {key: options[key] for key in _SLOPE_OPTIONS}
    slope_options["upper"] = (
        Plane(0.0, face.dip_direction_deg)
        if slope_options["upper"] is None
        else slope_options["upper"]
    )
    slope_options["height"] = (
        HEIGHT_M if slope_options["height"] is None else slope_options["height"]
    )
    joints = (
        Plane(45.0, face.dip_direction_deg),
        Plane(45.0, (face.dip_direction_deg + 90.0) % 360.0),
    )
    slope, faults = slope_of({"dips": joints, "face": face, **slope_options}, option_name)
    faults.refuse()
    return slope


def _size_limits(options: Mapping[str, Any], option_name: Callable[[str], str]) -> SizeLimits:
    faults = Faults()
    limits: dict[str, Any] = {
        f"{name}_m3" if name.endswith("volume") else f"{name}_m": value
        for name, value in numbers_given(_SIZE_LIMITS, options, option_name, faults).items()
    }
    least, most = limits.get("min_volume_m3"), limits.get("max_volume_m3")
    if least is not None and most is not None and least > most:
        faults.add(
            "E116",
            f"min volume {number(least)} m³ is more than max volume {number(most)} m³: nothing would be left",
            option_name("min_volume"),
        )
    limit_rule = (
        "scale" if options.get("limit_by") is None else str(options["limit_by"]).strip().lower()
    )
    if limit_rule not in ("scale", "filter"):
        faults.add(
            "E126",
            f"limits of size go by {limit_rule!r}, it is scale or filter",
            option_name("limit_by"),
            "scale makes larger wedges smaller, filter leaves them out.",
        )
    faults.refuse()
    joint_limits = {name: (limits.get(name),) * 2 for name in ("trace_length_m", "persistence_m")}
    return SizeLimits(**{**limits, **joint_limits}, by=limit_rule)


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
        """Pairs that form a removable wedge of at least the least volume, (m,)."""
        return self.outcome < _WEDGE_OUTCOMES


def joint_pairs(
    joints: JointList, slope: WedgeDesign, limits: SizeLimits, cohesion: Floats, friction: Floats
) -> JointPairs:
    """Return all pairs by the closed form on arrays, each wedge scaled to the limits of size."""
    first, second = joints.pairs()
    pieces = [
        _pair_wedges(
            joints,
            slope,
            limits,
            cohesion,
            friction,
            first[start : start + _PAIRS_PER_PIECE],
            second[start : start + _PAIRS_PER_PIECE],
        )
        for start in range(0, len(first), _PAIRS_PER_PIECE)
    ]
    return pieces[0] if len(pieces) == 1 else _concatenated(pieces)


def _concatenated(pieces: Sequence[Any]) -> Any:
    """Concatenate arrays, or records of arrays field by field."""
    kind = type(pieces[0])
    if kind is np.ndarray:
        return np.concatenate(pieces)
    return kind(
        **{
            column.name: _concatenated([getattr(piece, column.name) for piece in pieces])
            for column in fields(kind)
        }
    )


def _pair_wedges(
    joints: JointList,
    slope: WedgeDesign,
    limits: SizeLimits,
    cohesion: Floats,
    friction: Floats,
    first: Ints,
    second: Ints,
) -> JointPairs:
    joint1, joint2, height = _ordered_by_trace(joints, first, second, slope)
    dips, dip_directions, face, upper = (
        joints.dips_deg,
        joints.dip_directions_deg,
        slope.face,
        slope.upper,
    )
    sizes = wedge_sizes(
        dips[joint1],
        dip_directions[joint1],
        dips[joint2],
        dip_directions[joint2],
        face.dip_deg,
        face.dip_direction_deg,
        upper.dip_deg,
        upper.dip_direction_deg,
        slope.height_m,
        up_the_face=True,
    )
    fitted = fitted_sizes(limits, sizes)
    height = height * fitted.scale
    climbs = height > 0.0
    wedges = hoek_bray_wedges(
        WedgeArrays(
            joint1_dip_deg=dips[joint1],
            joint1_dip_direction_deg=dip_directions[joint1],
            joint2_dip_deg=dips[joint2],
            joint2_dip_direction_deg=dip_directions[joint2],
            face_dip_deg=slope.face.dip_deg,
            face_dip_direction_deg=slope.face.dip_direction_deg,
            upper_dip_deg=slope.upper.dip_deg,
            upper_dip_direction_deg=slope.upper.dip_direction_deg,
            height_m=np.where(climbs, height, 1.0),
            cohesion1_kpa=cohesion[joint1],
            cohesion2_kpa=cohesion[joint2],
            friction1_deg=friction[joint1],
            friction2_deg=friction[joint2],
            unit_weight_kn_m3=slope.rock.unit_weight_kn_m3,
            fill=slope.water.fill,
            pressures_kpa=slope.water.pressures_kpa[:2],
            water_unit_weight_kn_m3=slope.water_unit_weight_kn_m3,
            seismic=slope.seismic.coefficient,
            seismic_trend_deg=slope.seismic.trend_deg,
        ),
    )
    outcome, volume = wedges.outcome.copy(), wedges.volume_m3
    outcome[~climbs & (outcome < _WEDGE_OUTCOMES)] = _NO_CORNER
    for size_reason, size_outcome in ((1, TOO_LARGE), (2, TOO_SMALL)):
        outcome[(outcome < _WEDGE_OUTCOMES) & (fitted.refusal == size_reason)] = size_outcome
    factor = np.where(np.isin(outcome, _SLIDES), wedges.factor, np.nan)
    return JointPairs(
        fitted.sizes,
        fitted.scale,
        fitted.by,
        fitted.refusal,
        joint1,
        joint2,
        height,
        outcome,
        factor,
        volume,
        *wedges.line_trend_plunge_deg(),
    )
