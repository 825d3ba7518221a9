"""Inputs of a study of benches, read and checked: survey, strengths and sizes of joints, benches, targets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from slopekit.closed_form.berms import catch_width
from slopekit.core.arrays import Floats
from slopekit.core.codec import digest, json_of
from slopekit.core.errors import Faults, fail
from slopekit.core.orientation import Plane, normals, number
from slopekit.design.fields import Field, declare
from slopekit.design.joint_lists import JointList, joint_list
from slopekit.design.parts import Seismic
from slopekit.design.words import measured
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.studies.keys import Key
from slopekit.studies.protocol import MOST_SEED, numbers_given
from slopekit.studies.ranges import parse_values
from slopekit.studies.surveys import (
    LATERAL_LIMITS,
    range_of,
    slope_of,
    strengths_of_joints,
)

#: Default number of trials; the largest one, and that of benches times trials.
TRIALS, MAX_TRIALS, MAX_BENCH_TRIALS = 10_000, 200_000, 20_000_000
MAX_VALUES = 200
_MIN_FREQUENCY = (
    1e-4  # joints by the metre: sets that strike along the bench never meet it, but for rounding
)
RELIABILITY, CONFIDENCE = 0.8, 0.95
SWELL, REPOSE_DEG = 1.4, 37.0
TOES = ("anywhere", "bench")
_LOAD_OPTIONS = ("c", "phi", "density", "unit_weight", "water", "seismic")
_SWELL_ADVICE = "It is the volume of broken rock by that of solid rock."
_FRACTION_ADVICE = "A part of all is written 0.8 or 80%."
#: Numbers by their parameter.
_NUMBERS: Mapping[str, Field] = {
    "n": declare("n", "ratio", 100.0, MAX_TRIALS, default=TRIALS, is_integer=True, code="E307"),
    "seed": declare("seed", "ratio", 0.0, MOST_SEED, default=1, is_integer=True, code="E307"),
    "reliability": declare(
        "reliability",
        "ratio",
        0.5,
        0.999,
        default=RELIABILITY,
        code="E307",
        advice=_FRACTION_ADVICE,
    ),
    "accept": declare("accept", "ratio", 0.0, 1.0, code="E307", advice=_FRACTION_ADVICE),
    "confidence": declare(
        "confidence", "ratio", 0.5, 0.9999, default=CONFIDENCE, code="E307", advice=_FRACTION_ADVICE
    ),
    "fos": declare("fos", "ratio", 1e-6, 1e6, default=1.0, code="E307"),
    "catch": declare("the catch width", "length", 0.0, 1e4, code="E116"),
    "trace": declare("the trace length", "length", 1e-3, 1e6, code="E116"),
    "spacing": declare("spacing", "length", 1e-3, 1e5, code="E116"),
    "every": declare("every", "length", 1e-2, 1e5, code="E116"),
    **LATERAL_LIMITS,
    "swell": declare("swell", "ratio", 1.0, 3.0, default=SWELL, code="E307", advice=_SWELL_ADVICE),
    "repose": declare("repose", "angle", 10.0, 60.0, default=REPOSE_DEG, code="E307"),
}
#: Units of the numbers, as a sheet shows them.
UNITS = {
    name: {"length": " m", "angle": "°"}.get(field.measures, "") for name, field in _NUMBERS.items()
}


@dataclass(frozen=True)
class BenchInputs:
    """Inputs of a study of benches.

    Attributes
    ----------
    joints : the survey; slope : its loads as a wedge design whose joints and face mean nothing
    heights_m, face_dips_deg : of the benches, each with each; berms_m : of each of those, None: the width needed
    toward_deg : dip direction of the faces; toe : one of `TOES`
    cohesion_kpa, friction_deg, trace_m, spacing_m : (n,) of the joints: strength, how far each runs (inf
        where nothing is known), spacing of its set (nan likewise)
    own_strengths : how many joints have c and φ of their own
    numbers : by name, those of `_NUMBERS`; None where nothing was said
    every_m : along the bench, by the height of a bench where None
    defaults : names of the inputs that were left out
    """

    joints: JointList
    slope: WedgeDesign
    heights_m: tuple[float, ...]
    face_dips_deg: tuple[float, ...]
    berms_m: tuple[float, ...] | None
    toward_deg: float
    toe: str
    cohesion_kpa: Floats
    friction_deg: Floats
    trace_m: Floats
    spacing_m: Floats
    own_strengths: tuple[int, int]
    numbers: Mapping[str, float | None]
    every_m: float | None
    defaults: tuple[str, ...]

    def number(self, name: str) -> float:
        """Return a number that is never missing: the user's, or its default."""
        value = self.numbers[name]
        assert value is not None
        return value

    @property
    def has_cohesion(self) -> bool:
        """Whether any joint has cohesion."""
        return bool((self.cohesion_kpa > 0.0).any())

    def catch_m(self, height_m: float) -> float:
        """Return the catch width in m: the user's, else that of the modified Ritchie criterion."""
        width_m = self.numbers["catch"]
        return float(catch_width(height_m)) if width_m is None else width_m

    def step_m(self, height_m: float) -> float:
        """Return the distance in m between trial places along a bench of a height."""
        return height_m if self.every_m is None else self.every_m

    @property
    def loads(self) -> dict[str, Any]:
        """Unit weight, water and seismic coefficient, as the closed forms take them."""
        slope = self.slope
        return {
            "unit_weight_kn_m3": slope.rock.unit_weight_kn_m3,
            "fill": slope.water.fill,
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3,
            "seismic": slope.seismic.coefficient,
        }

    def to_dict(self) -> dict[str, Any]:
        """Return all inputs but the joints as JSON values."""
        slope, water = self.slope, self.slope.water
        return {
            "heights_m": list(self.heights_m),
            "face_dips_deg": list(self.face_dips_deg),
            "berms_m": None if self.berms_m is None else list(self.berms_m),
            "dip_direction_deg": self.toward_deg,
            "cohesion_kpa": range_of(self.cohesion_kpa, self.own_strengths[0]),
            "friction_deg": range_of(self.friction_deg, self.own_strengths[1]),
            "traces_known": int(np.isfinite(self.trace_m).sum()),
            "spacings_known": int(np.isfinite(self.spacing_m).sum()),
            "unit_weight_kn_m3": slope.rock.unit_weight_kn_m3,
            "density_kg_m3": slope.rock.density_kg_m3,
            "water": {
                "mode": water.mode,
                "fill": water.fill,
                "pressures_kpa": list(water.pressures_kpa[:1]),
            },
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3,
            "seismic": slope.seismic.coefficient,
            "toe": self.toe,
            "every_m": self.every_m,
            "agree_within": slope.analysis.agree_within,
            **json_of(self.numbers),
        }

    def input_hash(self) -> str:
        """Return the SHA-256 of the inputs and the joints with their strengths and sizes."""
        values = [
            self.cohesion_kpa,
            self.friction_deg,
            self.trace_m,
            self.spacing_m,
            self.joints.quantities,
        ]
        exact = [self.to_dict(), self.joints.rows(), [json_of(array.tolist()) for array in values]]
        return digest(exact)


def bench_inputs(options: Mapping[str, Any], option_name: Callable[[str], str]) -> BenchInputs:
    """Read and check the options of `bench_design`, by the names of its parameters; every fault at once."""
    faults = Faults()
    numbers = numbers_given(_NUMBERS, options, option_name, faults)
    reading = partial(
        joint_list,
        options["joints"],
        options["convention"],
        options["skip_bad"],
        2,
        option_name("convention"),
        True,
        columns=options["columns"],
    )
    listed: JointList | None = faults.of(reading)
    ranges = {
        name: faults.of(partial(_range_values, name, options[name], option_name))
        for name in ("height", "face", "berm")
    }
    toward = faults.of(
        partial(_dip_direction, options["dip_direction"], option_name("dip_direction"))
    )
    toe = options["toe"] or TOES[0]
    if toe not in TOES:
        faults.add(
            "E126",
            f"{toe} is not a place of the toe",
            f"{option_name('toe')} {toe}",
            f"Known: {', '.join(TOES)}.",
        )
    slope: WedgeDesign | None = faults.of(partial(_slope, options, toward or 0.0, option_name))
    strengths: list[tuple[Floats, int]] = []
    if listed is not None:
        strengths, missing = strengths_of_joints(listed, options, slope, option_name)
        faults += missing
    heights, dips, trials = ranges["height"], ranges["face"], numbers["n"]
    if heights and dips and trials and len(heights) * len(dips) * trials > MAX_BENCH_TRIALS:
        faults.add(
            "E125",
            f"{len(heights)} heights x {len(dips)} faces x {number(trials)} trials are more than {MAX_BENCH_TRIALS:,}",
            option_name("n"),
            "Ask for fewer benches at once, or for fewer trials.",
        )
    faults.refuse()
    # no fault, so nothing is missing: what follows only tells the type checker
    assert listed is not None and slope is not None and heights and dips and toward is not None  # noqa: PT018
    traces = _joint_sizes([joint.trace_m for joint in listed.joints], numbers["trace"], np.inf)
    spacings = _joint_sizes(
        [joint.spacing_m for joint in listed.joints], numbers["spacing"], np.nan
    )
    place_spacing = numbers["every"]
    if place_spacing is None:
        place_spacing = _mean_place_spacing(listed, spacings, toward)
    (cohesion, own_cohesions), (friction, own_frictions) = strengths
    optional_names = (
        "berm",
        "catch",
        "every",
        "density",
        "n",
        "reliability",
        "fos",
        "lateral",
        "lateral_toppling",
        "swell",
        "repose",
        "toe",
    )
    defaults = [name for name in optional_names if options[name] is None]
    if options["unit_weight"] is not None:
        defaults.remove("density")
    return BenchInputs(
        listed,
        slope,
        heights,
        dips,
        ranges["berm"] or None,
        toward,
        toe,
        cohesion,
        friction,
        traces,
        spacings,
        (own_cohesions, own_frictions),
        numbers,
        place_spacing,
        tuple(defaults),
    )


#: Options with several values: kind and limits of a value, the fault's code and the requirement.
_RANGE_LIMITS = {
    "height": ("length", 1e-3, 1e4, "E116", "a bench is more than 0 m high"),
    "face": ("angle", 1.0, 90.0, "E101", "the face of a bench dips from 1 to 90°"),
    "berm": ("length", 0.0, 1e4, "E116", "a berm is 0 m wide or more"),
}


def _key(name: str) -> Key:
    kind, low, high, *_ = _RANGE_LIMITS[name]
    return Key(name, kind, None, low, high)


def _range_values(name: str, text: object, option_name: Callable[[str], str]) -> tuple[float, ...]:
    """Return heights, face dips or berm widths from the text or numbers of an option; no berms without it."""
    option = option_name(name)
    if text is None:
        if name == "berm":
            return ()
        example = {"height": "10,15", "face": "60:80:+5"}[name]
        fail("E143", f"{option} is missing", option, f"Give {option} {example}.")
    key, (*_, code, requirement) = _key(name), _RANGE_LIMITS[name]
    values = parse_values(key, text, MAX_VALUES)
    bad = [value for value in values if not key.low <= value <= key.high]
    if bad:
        fail(code, f"{name} is {number(bad[0])}: {requirement}", f"{option} {text}")
    return values


def _dip_direction(value: object, option: str) -> float:
    if value is None:
        fail(
            "E143",
            f"{option} is missing",
            option,
            f"Give the dip direction of the faces: {option} 180.",
        )
    return (
        measured(
            value,
            "angle",
            "the dip direction",
            f"{option} {value}",
            least=0.0,
            most=360.0,
            code="E102",
        )
        % 360.0
    )


def _slope(
    options: Mapping[str, Any], toward: float, option_name: Callable[[str], str]
) -> WedgeDesign:
    """Return the loads as a wedge design with placeholder joints, face and height."""
    joints = Plane(45.0, (toward + 315.0) % 360.0), Plane(45.0, (toward + 45.0) % 360.0)
    planes = {
        "dips": joints,
        "face": Plane(65.0, toward),
        "upper": Plane(0.0, toward),
        "height": 10.0,
    }
    slope, faults = slope_of(
        {**planes, **{key: options[key] for key in _LOAD_OPTIONS}}, option_name
    )
    trend = slope.seismic.trend_deg
    if trend is not None and trend % 360.0 != toward:
        faults.add(
            "E122",
            f"the earthquake acts toward {number(trend)}, here it acts out of the face",
            f"{option_name('seismic')} {options['seismic']}",
            "Give the coefficient alone.",
        )
    faults.refuse()
    coefficient = slope.seismic.coefficient
    return replace(slope, seismic=Seismic(coefficient, toward if coefficient else None))


def _joint_sizes(
    measured_sizes: Sequence[float | None], default: float | None, unknown: float
) -> Floats:
    """Return a size of every joint (n,) in m: the measured one, else the default, else `unknown`."""
    substitute = unknown if default is None else default
    return np.array([substitute if value is None else value for value in measured_sizes])


def _mean_place_spacing(joints: JointList, spacings: Floats, toward: float) -> float | None:
    """Return the mean distance in m of joints along the bench by the spacings of the sets; None without spacings.

    A set with the spacing s is met |n · t| / s times a metre along the direction t.
    """
    if not np.isfinite(spacings).any():
        return None
    along = np.array([np.cos(np.radians(toward)), -np.sin(np.radians(toward)), 0.0])
    meets = np.abs(normals(joints.dips_deg, joints.dip_directions_deg) @ along)
    names = np.array([joint.set_name for joint in joints.joints])
    frequency = 0.0
    for name in dict.fromkeys(names.tolist()):
        in_set = (names == name) & np.isfinite(spacings)
        if in_set.any():
            frequency += float(meets[in_set].mean() / spacings[in_set].mean())
    return 1.0 / frequency if frequency > _MIN_FREQUENCY else None
