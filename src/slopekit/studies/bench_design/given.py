"""What a study of benches is given: the survey with its strengths and sizes, the benches to look at, what counts."""

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

#: Trials where none are asked for; the most of them, and of benches times trials.
TRIALS, MOST_TRIALS, MOST_IN_ALL = 10_000, 200_000, 20_000_000
MOST_VALUES = 200
_SELDOM = 1e-4  # joints by the metre: sets that strike along the bench never meet it, but for rounding
RELIABILITY, CONFIDENCE = 0.8, 0.95
SWELL, REPOSE_DEG = 1.4, 37.0
TOES = ("anywhere", "bench")
_OF_WEDGE = ("c", "phi", "density", "unit_weight", "water", "seismic")
_VOLUMES = "It is the volume of broken rock by that of solid rock."
_PART = "A part of all is written 0.8 or 80%."
#: Numbers by their parameter.
_NUMBERS: Mapping[str, Field] = {
    "n": declare("n", "ratio", 100.0, MOST_TRIALS, default=TRIALS, whole=True, code="E307"),
    "seed": declare("seed", "ratio", 0.0, MOST_SEED, default=1, whole=True, code="E307"),
    "reliability": declare("reliability", "ratio", 0.5, 0.999, default=RELIABILITY, code="E307", advice=_PART),
    "accept": declare("accept", "ratio", 0.0, 1.0, code="E307", advice=_PART),
    "confidence": declare("confidence", "ratio", 0.5, 0.9999, default=CONFIDENCE, code="E307", advice=_PART),
    "fos": declare("fos", "ratio", 1e-6, 1e6, default=1.0, code="E307"),
    "catch": declare("the catch width", "length", 0.0, 1e4, code="E116"),
    "trace": declare("the trace length", "length", 1e-3, 1e6, code="E116"),
    "spacing": declare("spacing", "length", 1e-3, 1e5, code="E116"),
    "every": declare("every", "length", 1e-2, 1e5, code="E116"),
    **LATERAL_LIMITS,
    "swell": declare("swell", "ratio", 1.0, 3.0, default=SWELL, code="E307", advice=_VOLUMES),
    "repose": declare("repose", "angle", 10.0, 60.0, default=REPOSE_DEG, code="E307"),
}
#: Of the numbers, as a sheet has them.
UNITS = {name: {"length": " m", "angle": "°"}.get(field.measures, "") for name, field in _NUMBERS.items()}


@dataclass(frozen=True)
class BenchInputs:
    """Everything that a study of benches depends on.

    Attributes
    ----------
    joints : the survey; slope : its loads as a wedge design whose joints and face mean nothing
    heights_m, face_dips_deg : of the benches, each with each; berms_m : of each of those, None: the width needed
    toward_deg : dip direction of the faces; toe : one of `TOES`
    cohesion_kpa, friction_deg, trace_m, spacing_m : (n,) of the joints: strength, how far each runs (inf
        where nothing is known), spacing of its set (nan likewise)
    own : how many joints have c and φ of their own
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
    own: tuple[int, int]
    numbers: Mapping[str, float | None]
    every_m: float | None
    defaults: tuple[str, ...]

    def number(self, name: str) -> float:
        """A number that is there, given or its default."""
        value = self.numbers[name]
        assert value is not None
        return value

    @property
    def has_cohesion(self) -> bool:
        """Whether any joint has some."""
        return bool((self.cohesion_kpa > 0.0).any())

    def catch_m(self, height_m: float) -> float:
        """The berm width wanted: what was given, else the modified Ritchie criterion."""
        width_m = self.numbers["catch"]
        return float(catch_width(height_m)) if width_m is None else width_m

    def step_m(self, height_m: float) -> float:
        """How far it is from place to place along a bench of a height."""
        return height_m if self.every_m is None else self.every_m

    @property
    def loads(self) -> dict[str, Any]:
        """Weight, fill of the joints and earthquake, as the closed forms take them."""
        slope = self.slope
        return {
            "unit_weight_kn_m3": slope.rock.unit_weight_kn_m3, "fill": slope.water.fill,
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3, "seismic": slope.seismic.coefficient,
        }  # fmt: skip

    def to_dict(self) -> dict[str, Any]:
        """All but the joints, as JSON values."""
        slope, water = self.slope, self.slope.water
        return {
            "heights_m": list(self.heights_m), "face_dips_deg": list(self.face_dips_deg),
            "berms_m": None if self.berms_m is None else list(self.berms_m), "dip_direction_deg": self.toward_deg,
            "cohesion_kpa": range_of(self.cohesion_kpa, self.own[0]),
            "friction_deg": range_of(self.friction_deg, self.own[1]),
            "traces_known": int(np.isfinite(self.trace_m).sum()),
            "spacings_known": int(np.isfinite(self.spacing_m).sum()),
            "unit_weight_kn_m3": slope.rock.unit_weight_kn_m3, "density_kg_m3": slope.rock.density_kg_m3,
            "water": {"mode": water.mode, "fill": water.fill, "pressures_kpa": list(water.pressures_kpa[:1])},
            "water_unit_weight_kn_m3": slope.water_unit_weight_kn_m3, "seismic": slope.seismic.coefficient,
            "toe": self.toe, "every_m": self.every_m, "agree_within": slope.analysis.agree_within,
            **json_of(self.numbers),
        }  # fmt: skip

    def input_hash(self) -> str:
        """SHA-256 of the inputs and the joints with their strengths and sizes."""
        values = [self.cohesion_kpa, self.friction_deg, self.trace_m, self.spacing_m, self.joints.quantities]
        exact = [self.to_dict(), self.joints.rows(), [json_of(part.tolist()) for part in values]]
        return digest(exact)


def bench_inputs(given: Mapping[str, Any], option: Callable[[str], str]) -> BenchInputs:
    """Read and check what `bench_design` is given, by the names of its parameters; every fault at once."""
    faults = Faults()
    numbers = numbers_given(_NUMBERS, given, option, faults)
    reading = partial(
        joint_list,
        given["joints"],
        given["convention"],
        given["skip_bad"],
        2,
        option("convention"),
        True,
        columns=given["columns"],
    )
    listed: JointList | None = faults.of(reading)
    read = {
        name: faults.of(partial(_values, name, given[name], option))
        for name in ("height", "face", "berm")
    }  # fmt: skip
    toward = faults.of(partial(_toward, given["dip_direction"], option("dip_direction")))
    toe = given["toe"] or TOES[0]
    if toe not in TOES:
        faults.add("E126", f"{toe} is not a place of the toe", f"{option('toe')} {toe}", f"Known: {', '.join(TOES)}.")
    slope: WedgeDesign | None = faults.of(partial(_slope, given, toward or 0.0, option))
    strengths: list[tuple[Floats, int]] = []
    if listed is not None:
        strengths, missing = strengths_of_joints(listed, given, slope, option)
        faults += missing
    heights, dips, trials = read["height"], read["face"], numbers["n"]
    if heights and dips and trials and len(heights) * len(dips) * trials > MOST_IN_ALL:
        faults.add(
            "E125",
            f"{len(heights)} heights x {len(dips)} faces x {number(trials)} trials are more than {MOST_IN_ALL:,}",
            option("n"),
            "Ask for fewer benches at once, or for fewer trials.",
        )
    faults.refuse()
    # no fault, so nothing is missing: what follows only tells the type checker
    assert listed is not None and slope is not None and heights and dips and toward is not None  # noqa: PT018
    traces = _sizes([joint.trace_m for joint in listed.joints], numbers["trace"], np.inf)
    spacings = _sizes([joint.spacing_m for joint in listed.joints], numbers["spacing"], np.nan)
    every = numbers["every"]
    if every is None:
        every = _apart(listed, spacings, toward)
    (cohesion, own_c), (friction, own_phi) = strengths
    may_be_left = (
        "berm", "catch", "every", "density", "n", "reliability", "fos", "lateral", "lateral_toppling", "swell",
        "repose", "toe",
    )  # fmt: skip
    defaults = [name for name in may_be_left if given[name] is None]
    if given["unit_weight"] is not None:
        defaults.remove("density")
    return BenchInputs(
        listed, slope, heights, dips, read["berm"] or None, toward, toe, cohesion, friction, traces, spacings,
        (own_c, own_phi), numbers, every, tuple(defaults),
    )  # fmt: skip


#: What is given in several values: its kind and limits, the code beyond them and what they are.
_RANGED = {
    "height": ("length", 1e-3, 1e4, "E116", "a bench is more than 0 m high"),
    "face": ("angle", 1.0, 90.0, "E101", "the face of a bench dips from 1 to 90°"),
    "berm": ("length", 0.0, 1e4, "E116", "a berm is 0 m wide or more"),
}


def _key(name: str) -> Key:
    kind, low, high, *_ = _RANGED[name]
    return Key(name, kind, None, low, high)


def _values(name: str, given: object, option: Callable[[str], str]) -> tuple[float, ...]:
    """Heights, dips of faces, widths of berms; none of the last where nothing is given."""
    where = option(name)
    if given is None:
        if name == "berm":
            return ()
        example = {"height": "10,15", "face": "60:80:+5"}[name]
        fail("E143", f"{where} is missing", where, f"Give {where} {example}.")
    key, (*_, code, said) = _key(name), _RANGED[name]
    values = parse_values(key, given, MOST_VALUES)
    bad = [value for value in values if not key.low <= value <= key.high]
    if bad:
        fail(code, f"{name} is {number(bad[0])}: {said}", f"{where} {given}")
    return values


def _toward(given: object, where: str) -> float:
    if given is None:
        fail("E143", f"{where} is missing", where, f"Give the dip direction of the faces: {where} 180.")
    return measured(given, "angle", "the dip direction", f"{where} {given}", least=0.0, most=360.0, code="E102") % 360.0


def _slope(given: Mapping[str, Any], toward: float, option: Callable[[str], str]) -> WedgeDesign:
    """The loads, on a slope that means nothing."""
    joints = Plane(45.0, (toward + 315.0) % 360.0), Plane(45.0, (toward + 45.0) % 360.0)
    planes = {"dips": joints, "face": Plane(65.0, toward), "upper": Plane(0.0, toward), "height": 10.0}
    slope, faults = slope_of({**planes, **{key: given[key] for key in _OF_WEDGE}}, option)
    trend = slope.seismic.trend_deg
    if trend is not None and trend % 360.0 != toward:
        faults.add(
            "E122",
            f"the earthquake acts toward {number(trend)}, here it acts out of the face",
            f"{option('seismic')} {given['seismic']}",
            "Give the coefficient alone.",
        )
    faults.refuse()
    coefficient = slope.seismic.coefficient
    return replace(slope, seismic=Seismic(coefficient, toward if coefficient else None))


def _sizes(own: Sequence[float | None], given: float | None, unknown: float) -> Floats:
    """A size of every joint (n,): its own, else what is given for all."""
    other = unknown if given is None else given
    return np.array([other if value is None else value for value in own])


def _apart(joints: JointList, spacings: Floats, toward: float) -> float | None:
    """How far it is along the bench from joint to joint, by the spacings of the sets; None where they do not say it.

    A set with the spacing s is met |n · t| / s times a metre along the direction t.
    """
    if not np.isfinite(spacings).any():
        return None
    along = np.array([np.cos(np.radians(toward)), -np.sin(np.radians(toward)), 0.0])
    meets = np.abs(normals(joints.dips_deg, joints.dip_directions_deg) @ along)
    names = np.array([joint.set_name for joint in joints.joints])
    often = 0.0
    for name in dict.fromkeys(names.tolist()):
        some = (names == name) & np.isfinite(spacings)
        if some.any():
            often += float(meets[some].mean() / spacings[some].mean())
    return 1.0 / often if often > _SELDOM else None
