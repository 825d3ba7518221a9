"""From what a user wrote (command line, Python, later YAML) to a checked design: all faults at once."""

import math
import re
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

from slopekit.design import words
from slopekit.design.wedge import PAPER_WEDGE, Criterion, Seismic, Stiffness, Water, WedgeDesign
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Plane, number, parse_plane
from slopekit.units import is_unit_of, quantity, unit_of

T = TypeVar("T")
_KEYS = (
    "dips", "face", "upper", "height", "c", "phi", "density", "unit_weight", "dilation", "tension", "water",
    "crack", "seismic", "forces", "bolts", "normal_stiffness", "shear_stiffness", "criterion", "accept",
    "agree_within", "gravity", "water_unit_weight", "refine", "origin",
)  # fmt: skip
_MAX_REFINE = 6


def wedge_design(given: dict[str, Any], option: Callable[[str], str] = lambda key: f"{key} =") -> WedgeDesign:
    """Check and convert the inputs of one wedge.

    Parameters
    ----------
    given : what the user gave, by the Python names of `slopekit.wedge`; None means not given
    option : how a key is called where the user wrote it (`--dips` on the command line)

    Raises
    ------
    DesignError
        With every fault found, not only the first.
    """
    reader = _Reader({key: value for key, value in given.items() if value is not None}, option)
    return reader.design()


class _Reader:
    """Collects faults while it reads one key after the other."""

    def __init__(self, given: dict[str, Any], option: Callable[[str], str]) -> None:
        self.given = {key: value.tolist() if hasattr(value, "tolist") else value for key, value in given.items()}
        self.option = option
        self.faults: list[Fault] = []
        self.defaults: list[str] = []

    def design(self) -> WedgeDesign:
        for key in self.given:
            if key not in _KEYS:
                near = get_close_matches(key, _KEYS, n=1)
                advice = f"Did you mean {near[0]}?" if near else f"Known: {', '.join(_KEYS)}."
                self.faults.append(Fault("E128", f"{key} is not an input of a wedge", f"{key}", advice))
        joints = self.joints()
        face, upper = self.plane("face"), self.plane("upper")
        height = self.positive("height", "length", "E116")
        if height is not None and not 1e-6 <= height <= 1e7:
            message = f"height is {number(height)} m, out of range (1e-6 to 1e7)"
            self.faults.append(Fault("E116", message, self.where("height", self.given["height"])))
        cohesion = self.pair("c", "pressure", self.check_cohesion)
        friction = self.pair("phi", "angle", self.check_friction)
        dilation = self.pair("dilation", "angle", None) if "dilation" in self.given else (0.0, 0.0)
        if "dilation" in self.given:
            self.check_dilation(dilation, friction)
        tension = self.pair("tension", "pressure", self.check_tension) if "tension" in self.given else (0.0, 0.0)
        gravity = self.positive("gravity", "acceleration", "E130", default=9.81)
        unit_weight, density = self.weight(gravity or 9.81)
        crack = self.read("crack", words.crack)
        water = self.read("water", lambda value, where: words.water(value, where, crack is not None)) or Water()
        seismic = self.read("seismic", words.seismic) or Seismic()
        if seismic.coefficient and seismic.trend_deg is None:
            self.defaults.append("seismic.trend")
        forces = self.many("forces", words.force)
        bolts = self.many("bolts", words.bolt)
        stiffness = self.stiffness()
        criterion = self.read("criterion", self.criterion) or "limit"
        accept = self.read("accept", lambda value, where: words.above_zero(value, "ratio", "accept", "E127", where))
        agree = self.read("agree_within", self.agree_within) or 0.01
        water_unit_weight = self.positive("water_unit_weight", "unit weight", "E110", default=9.81)
        refine = self.read("refine", self.refine) or 0
        origin = self.read("origin", lambda value, where: words.point(value, "origin", where)) or (0.0, 0.0, 0.0)
        if self.faults:
            raise DesignError(self.faults)
        # no fault, so nothing is missing: what follows only tells the type checker
        assert joints is not None and face is not None and upper is not None and height is not None  # noqa: PT018
        assert cohesion is not None and friction is not None and dilation is not None  # noqa: PT018
        assert tension is not None and unit_weight is not None  # noqa: PT018
        return WedgeDesign(
            joints=joints, face=face, upper=upper, height_m=height, cohesion_kpa=cohesion,
            friction_angle_deg=friction, unit_weight_kn_m3=unit_weight, density_kg_m3=density,
            gravity_m_s2=gravity or 9.81, water_unit_weight_kn_m3=water_unit_weight or 9.81, dilation_deg=dilation,
            tension_kpa=tension, water=water, crack=crack, seismic=seismic, forces=forces, bolts=bolts,
            stiffness=stiffness, criterion=criterion, accept=accept, agree_within=agree, refine=refine,
            origin_m=origin, defaults=tuple(self.defaults),
        )  # fmt: skip

    # -- the frame: read one key, keep its faults -------------------------------------------------

    def where(self, key: str, value: object) -> str:
        return f"{self.option(key)} {words.shown(value)}"

    def read(self, key: str, convert: Callable[[Any, str], T]) -> T | None:
        """The converted value of a key, or None where it is not given or faulty."""
        if key not in self.given:
            return None
        value = self.given[key]
        try:
            return convert(value, self.where(key, value))
        except DesignError as error:
            self.faults += error.faults
            return None

    def many(self, key: str, convert: Callable[[Any, str], T]) -> tuple[T, ...]:
        """A list of things, each with its own faults; one thing alone counts as a list of one."""
        values = self.given.get(key, ())
        if isinstance(values, str | dict) or words.is_point(values) or not isinstance(values, Sequence):
            values = [values]
        found = []
        for value in values:
            try:
                found.append(convert(value, self.where(key, value)))
            except DesignError as error:
                self.faults += error.faults
        return tuple(found)

    def default(self, key: str) -> Any:
        self.defaults.append(key)
        return PAPER_WEDGE[key]

    # -- orientations and sizes -------------------------------------------------------------------

    def joints(self) -> tuple[Plane, Plane] | None:
        if "dips" not in self.given:
            self.faults.append(Fault("E109", "the two joints are missing", self.option("dips"), "Give 45/115 45/245."))
            return None
        value = self.given["dips"]
        if isinstance(value, str) or not isinstance(value, Sequence) or len(value) != 2:
            message = f"a wedge has two joints, {words.shown(value)} is not two orientations"
            self.faults.append(Fault("E109", message, self.where("dips", value), "Give 45/115 45/245."))
            return None
        planes = []
        for k, item in enumerate(value, 1):
            try:
                planes.append(parse_plane(item, f"J{k}", self.where("dips", item)))
            except DesignError as error:
                self.faults += error.faults
        return (planes[0], planes[1]) if len(planes) == 2 else None

    def plane(self, key: str) -> Plane | None:
        if key not in self.given:
            plane: Plane = self.default(key)
            return plane
        return self.read(key, lambda value, where: parse_plane(value, key, where))

    def positive(self, key: str, kind: str, code: str, default: float | None = None) -> float | None:
        if key not in self.given:
            return default if default is not None else float(self.default(key))
        return self.read(key, lambda value, where: words.above_zero(value, kind, key, code, where))

    def refine(self, value: object, where: str) -> int:
        level = quantity(value, "ratio", "refine", where)
        if level != int(level) or not 0 <= level <= _MAX_REFINE:
            message = f"refine is {number(level)}, it must be a whole number from 0 to {_MAX_REFINE}"
            raise DesignError([Fault("E131", message, where, "Each step makes four triangles of one.")])
        return int(level)

    # -- strength and weight ----------------------------------------------------------------------

    def pair(self, key: str, kind: str, check: Callable[[float, str, str], None] | None) -> tuple[float, float] | None:
        """One value for both joints, or one for each."""
        if key not in self.given:
            values: tuple[float, float] = self.default(key)
            return values
        value = self.given[key]
        where = self.where(key, value)
        parts: Sequence[Any]
        if isinstance(value, str):
            parts = re.split(r"\s*,\s*", value.strip())
        elif isinstance(value, Sequence):
            parts = value
        else:
            parts = [value]
        if len(parts) == 1:
            parts = [parts[0], parts[0]]
        if len(parts) != 2:
            message = f"{key} has {len(parts)} values, a wedge has two joints: give one value or two"
            self.faults.append(Fault("E109", message, where))
            return None
        numbers: list[float] = []
        seen: set[str] = set()
        for k, part in enumerate(parts, 1):
            name = f"{key} of J{k}"
            try:
                numbers.append(quantity(part, kind, name, where))
                if check is not None and not (k == 2 and parts[0] == parts[1] and seen):
                    check(numbers[-1], name, where)
            except DesignError as error:
                if not (k == 2 and parts[0] == parts[1] and seen):
                    self.faults += error.faults
                seen.update(error.codes)
        return (numbers[0], numbers[1]) if len(numbers) == 2 else None

    @staticmethod
    def check_cohesion(value: float, name: str, where: str) -> None:
        if value < 0.0:
            raise DesignError([Fault("E114", f"{name} is {number(value)} kPa, cohesion is never negative", where)])

    @staticmethod
    def check_tension(value: float, name: str, where: str) -> None:
        if value < 0.0:
            raise DesignError([Fault("E114", f"{name} is {number(value)} kPa, a strength is never negative", where)])

    @staticmethod
    def check_friction(value: float, name: str, where: str) -> None:
        if 0.0 < value < math.pi / 2 and value != int(value):
            message = f"{name} is {number(value)}°, that looks like radians"
            advice = f"{number(value)} rad is {math.degrees(value):.1f}°; write 0 for a joint without friction."
            raise DesignError([Fault("E113", message, where, advice)])
        if not 0.0 <= value < 90.0:
            message = f"{name} is {number(value)}°, a friction angle lies from 0 to below 90"
            raise DesignError([Fault("E115", message, where)])

    def check_dilation(self, dilation: tuple[float, float] | None, friction: tuple[float, float] | None) -> None:
        for k, (psi, phi) in enumerate(zip(dilation or (), friction or (), strict=False), 1):
            if not 0.0 <= psi <= phi:
                message = f"dilation of J{k} is {number(psi)}°, it lies between 0 and the friction angle {number(phi)}°"
                self.faults.append(Fault("E117", message, self.where("dilation", self.given.get("dilation"))))

    def weight(self, gravity: float) -> tuple[float | None, float | None]:
        """Unit weight (kN/m³) and, where that was given, the density (kg/m³)."""
        if "unit_weight" in self.given and "density" in self.given:
            where = ", ".join(self.where(key, self.given[key]) for key in ("density", "unit_weight"))
            self.faults.append(Fault("E112", "density and unit weight are both given", where, "Give one of the two."))
            return None, None
        if "unit_weight" in self.given:
            return self.read("unit_weight", self.unit_weight), None
        if "density" not in self.given:
            default = float(self.default("density"))
            return default * gravity / 1e3, default
        density = self.read("density", self.density)
        return (None if density is None else density * gravity / 1e3), density

    def unit_weight(self, value: object, where: str) -> float:
        if is_unit_of(unit_of(value), "density"):
            message = f"unit weight is {value}: that is a density"
            raise DesignError([Fault("E107", message, where, f"Write {self.option('density')} {value}.")])
        result = quantity(value, "unit weight", "unit weight", where)
        if not 5.0 <= result <= 400.0:
            advice = "Rock weighs 20 to 30 kN/m³."
            if 500.0 <= result <= 10000.0:
                advice = f"{number(result)} looks like a density: write {self.option('density')} {number(result)}."
            elif 0.5 <= result < 5.0:
                advice = f"{number(result)} looks like t/m³: write {self.option('density')} '{number(result)} t/m3'."
            message = f"unit weight is {number(result)} kN/m³, out of range (5 to 400)"
            raise DesignError([Fault("E110", message, where, advice)])
        return result

    def density(self, value: object, where: str) -> float:
        if is_unit_of(unit_of(value), "unit weight"):
            message = f"density is {value}: that is a unit weight"
            raise DesignError([Fault("E107", message, where, f"Write {self.option('unit_weight')} {value}.")])
        result = quantity(value, "density", "density", where)
        if not 500.0 <= result <= 10000.0:
            advice = "Rock has 2000 to 3000 kg/m³."
            if 0.5 <= result <= 10.0:
                advice = f"{number(result)} looks like t/m³: write '{number(result)} t/m3'."
            elif 10.0 < result <= 60.0:
                advice = (
                    f"{number(result)} looks like a unit weight: write {self.option('unit_weight')} {number(result)}."
                )
            raise DesignError(
                [Fault("E111", f"density is {number(result)} kg/m³, out of range (500 to 10000)", where, advice)]
            )
        return result

    # -- analysis ---------------------------------------------------------------------------------

    def stiffness(self) -> Stiffness:
        normal = self.positive("normal_stiffness", "stiffness", "E132", default=Stiffness().normal_kn_m3)
        shear: float | None = None
        if str(self.given.get("shear_stiffness", "clough-duncan")).lower() != "clough-duncan":
            shear = self.positive("shear_stiffness", "stiffness", "E132")
        return Stiffness(normal or 1e7, shear)

    @staticmethod
    def agree_within(value: object, where: str) -> float:
        part = words.above_zero(value, "ratio", "agree_within", "E127", where)
        if part >= 1.0:
            raise DesignError([Fault("E127", f"agree_within is {number(part * 100)} %, it is less than 100 %", where)])
        return part

    def criterion(self, value: object, where: str) -> Criterion:
        value = value.lower() if isinstance(value, str) else value
        if value not in ("limit", "all-pairs"):
            near = get_close_matches(str(value), ("limit", "all-pairs"), n=1)
            advice = f"Did you mean {near[0]}?" if near else ""
            raise DesignError([Fault("E126", f"criterion is {value!r}, it is limit or all-pairs", where, advice)])
        return value
