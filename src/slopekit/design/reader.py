"""Reading inputs one key after the other, collecting every fault: what the kinds of design share."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Protocol, TypeVar

from slopekit.design import words
from slopekit.design.common import Criterion, HyperbolaParameters, Seismic, Stiffness, Strength
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Plane, number, parse_plane
from slopekit.units import is_unit_of, quantity, unit_of

T = TypeVar("T")
#: What every kind of design takes.
COMMON_KEYS = (
    "title", "density", "unit_weight", "water", "seismic", "forces", "bolts", "normal_stiffness", "shear_stiffness",
    "criterion", "accept", "agree_within", "stop_when", "gravity", "water_unit_weight", "factors", "assumed",
    "left_out",
)  # fmt: skip
_MAX_REFINE = 6
_IN_DEGREES = re.compile(r"\d\s*(deg|°)")
_MOST_FACTORS = 200


class Spelling(Protocol):
    """How the inputs are called where the user wrote them, and where they stand."""

    def key(self, name: str) -> str:
        """The name of an input in the user's words: `--unit-weight`, `rock.unit_weight`."""
        ...

    def where(self, name: str, value: object, index: int | None = None) -> str:
        """Where a value stands; `index` counts the values of an input that has several."""
        ...


class CallSpelling:
    """Inputs of a call (or of the command line): `--height 10`."""

    def __init__(self, option: Callable[[str], str]) -> None:
        self.option = option

    def key(self, name: str) -> str:
        """The option's name."""
        return self.option(name)

    def where(self, name: str, value: object, index: int | None = None) -> str:
        """The option with its value."""
        return f"{self.option(name)} {words.shown(value)}"


class Reader:
    """Collects faults while it reads one key after the other."""

    def __init__(
        self, given: Mapping[str, Any], spelling: Spelling, kind: str, known: Sequence[str], standard: Mapping[str, Any]
    ) -> None:
        self.given = {
            key: value.tolist() if hasattr(value, "tolist") else value
            for key, value in given.items() if value is not None
        }  # fmt: skip
        self.spelling = spelling
        self.standard = standard
        self.faults: list[Fault] = []
        self.defaults: list[str] = []
        for key in self.given:
            if key not in known and key not in COMMON_KEYS:
                near = get_close_matches(key, (*known, *COMMON_KEYS), n=1)
                advice = f"Did you mean {near[0]}?" if near else f"Known: {', '.join((*known, *COMMON_KEYS))}."
                self.faults.append(Fault("E128", f"{key} is not an input of a {kind}", key, advice))

    # -- the frame: read one key, keep its faults -------------------------------------------------

    def where(self, key: str, value: object, index: int | None = None) -> str:
        return self.spelling.where(key, value, index)

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

    def many(self, key: str, convert: Callable[[Any, str], T], may_be_point: bool = False) -> tuple[T, ...]:
        """A list of things, each with its own faults; one thing alone (maybe a point) counts as a list of one."""
        values = self.given.get(key, ())
        if (
            isinstance(values, str | dict)
            or (may_be_point and words.is_point(values))
            or not isinstance(values, Sequence)
        ):
            values = [values]
        found = []
        for k, value in enumerate(values):
            try:
                found.append(convert(value, self.where(key, value, k)))
            except DesignError as error:
                self.faults += error.faults
        return tuple(found)

    def default(self, key: str) -> Any:
        """The value that a left-out input takes, or None with a fault where it has to be given."""
        if key in self.standard:
            self.defaults.append(key)
            return self.standard[key]
        name = self.spelling.key(key)
        self.faults.append(Fault("E143", f"{name} is missing", self.spelling.where(key, ""), f"Give {name}."))
        return None

    def common(self) -> dict[str, Any]:
        """The inputs that every kind of design has, as arguments of `Design`; call it after the kind's own."""
        gravity = self.ranged("gravity", "acceleration", "E130", 9.81, (1.0, 25.0), "m/s²", "9.81 m/s² is Earth's.")
        unit_weight, density = self.weight(gravity)
        seismic = self.read("seismic", words.seismic) or Seismic()
        if seismic.coefficient and seismic.trend_deg is None:
            self.defaults.append("seismic.trend")
        forces = self.many("forces", words.force, may_be_point=True)
        bolts = self.many("bolts", words.bolt)
        stiffness = self.stiffness()
        criterion = self.read("criterion", self.criterion) or "limit"
        rules = self.many("accept", words.rule)
        agree = self.read("agree_within", self.agree_within) or 0.01
        stop = self.read("stop_when", self.stop_when) or 1e-4
        water_unit_weight = self.ranged(
            "water_unit_weight",
            "unit weight",
            "E110",
            9.81,
            (5.0, 15.0),
            "kN/m³",
            "Water weighs 9.81 kN/m³ (62.4 pcf).",
        )
        return {
            "title": str(self.given.get("title", "")), "unit_weight_kn_m3": unit_weight, "density_kg_m3": density,
            "gravity_m_s2": gravity, "water_unit_weight_kn_m3": water_unit_weight, "seismic": seismic,
            "forces": forces, "bolts": bolts, "stiffness": stiffness, "criterion": criterion, "rules": rules,
            "agree_within": agree, "stop_when": stop, "factors": self.factors(),
            "assumed": tuple(self.given.get("assumed", ())), "left_out": tuple(self.given.get("left_out", ())),
            "defaults": tuple(self.defaults),
        }  # fmt: skip

    def ranged(
        self, key: str, kind: str, code: str, default: float, within: tuple[float, float], unit: str, advice: str
    ) -> float:
        """A quantity that hardly varies: far from its value it is a slip of units."""
        found = self.positive(key, kind, code, default)
        if found is not None and not within[0] <= found <= within[1]:
            message = f"{key} is {number(found)} {unit}, out of range ({number(within[0])} to {number(within[1])})"
            self.faults.append(Fault(code, message, self.where(key, self.given.get(key)), advice))
        return found or default

    def factors(self) -> tuple[float, ...]:
        """Strength reduction factors of the series, sorted."""
        found = self.many("factors", lambda value, where: words.above_zero(value, "ratio", "factor", "E127", where))
        if len(found) > _MOST_FACTORS:
            message = f"{len(found)} factors are too many for one series (most: {_MOST_FACTORS})"
            self.faults.append(Fault("E127", message, self.spelling.where("factors", "")))
        return tuple(sorted(set(found)))

    def strength(self) -> Strength | None:
        """The one strength of a design with one interface."""
        at = {key: self.where(key, self.given.get(key)) for key in ("c", "phi", "dilation", "tension")}
        cohesion = self.one("c", "pressure", self.check_cohesion)
        friction = self.one("phi", "angle", self.check_friction)
        dilation = self.one("dilation", "angle", None) if "dilation" in self.given else 0.0
        tension = self.one("tension", "pressure", self.check_tension) if "tension" in self.given else 0.0
        if friction is not None and dilation is not None and not 0.0 <= dilation <= friction:
            message = f"dilation is {number(dilation)}°, it lies between 0 and the friction angle {number(friction)}°"
            self.faults.append(Fault("E117", message, at["dilation"]))
        if cohesion is None or friction is None or dilation is None or tension is None:
            return None
        return Strength(cohesion, friction, dilation, tension)

    def one(self, key: str, kind: str, check: Callable[[float, str, str], None] | None) -> float | None:
        """One number."""
        if key not in self.given:
            value: float | None = self.default(key)
            return value

        def convert(value: Any, where: str) -> float:
            found = quantity(value, kind, key, where)
            if check is not None:
                check(found, key, where)
            return found

        return self.read(key, convert)

    # -- orientations and sizes -------------------------------------------------------------------

    def plane(self, key: str) -> Plane | None:
        if key not in self.given:
            plane: Plane | None = self.default(key)
            return plane
        return self.read(key, lambda value, where: parse_plane(value, key, where))

    def positive(self, key: str, kind: str, code: str, default: float | None = None) -> float | None:
        if key not in self.given:
            found: float | None = default if default is not None else self.default(key)
            return found
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
            values: tuple[float, float] | None = self.default(key)
            return values
        value = self.given[key]
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
            self.faults.append(Fault("E109", message, self.where(key, value)))
            return None
        numbers: list[float] = []
        seen: set[str] = set()
        for k, part in enumerate(parts, 1):
            name, where = f"{key} of J{k}", self.where(key, value, k - 1)
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
        # the place shows the value as it is written: who writes deg means degrees
        if 0.0 < value < math.pi / 2 and value != int(value) and not _IN_DEGREES.search(where):
            message = f"{name} is {number(value)}°, that looks like radians"
            advice = (
                f"{number(value)} rad is {math.degrees(value):.1f}°; write {number(value)} deg if degrees are meant."
            )
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
            default: float | None = self.default("density")
            return (None, None) if default is None else (default * gravity / 1e3, default)
        density = self.read("density", self.density)
        return (None if density is None else density * gravity / 1e3), density

    def unit_weight(self, value: object, where: str) -> float:
        if is_unit_of(unit_of(value), "density"):
            message = f"unit weight is {value}: that is a density"
            raise DesignError([Fault("E107", message, where, f"Write {self.spelling.key('density')} {value}.")])
        result = quantity(value, "unit weight", "unit weight", where)
        if not 5.0 <= result <= 400.0:
            advice = "Rock weighs 20 to 30 kN/m³."
            if 500.0 <= result <= 10000.0:
                advice = (
                    f"{number(result)} looks like a density: write {self.spelling.key('density')} {number(result)}."
                )
            elif 10000.0 < result <= 50000.0:
                advice = f"{number(result)} looks like N/m³: write '{number(result)} N/m3'."
            elif 0.5 <= result < 5.0:
                advice = (
                    f"{number(result)} looks like t/m³: write {self.spelling.key('density')} '{number(result)} t/m3'."
                )
            message = f"unit weight is {number(result)} kN/m³, out of range (5 to 400)"
            raise DesignError([Fault("E110", message, where, advice)])
        return result

    def density(self, value: object, where: str) -> float:
        if is_unit_of(unit_of(value), "unit weight"):
            message = f"density is {value}: that is a unit weight"
            raise DesignError([Fault("E107", message, where, f"Write {self.spelling.key('unit_weight')} {value}.")])
        result = quantity(value, "density", "density", where)
        if not 500.0 <= result <= 10000.0:
            advice = "Rock has 2000 to 3000 kg/m³."
            if 0.5 <= result <= 10.0:
                advice = f"{number(result)} looks like t/m³: write '{number(result)} t/m3'."
            elif 10.0 < result <= 60.0:
                other = self.spelling.key("unit_weight")
                advice = f"{number(result)} looks like a unit weight: write {other} {number(result)}."
            raise DesignError(
                [Fault("E111", f"density is {number(result)} kg/m³, out of range (500 to 10000)", where, advice)]
            )
        return result

    # -- analysis ---------------------------------------------------------------------------------

    def stiffness(self) -> Stiffness:
        normal = self.positive("normal_stiffness", "stiffness", "E132", default=Stiffness().normal_kn_m3)
        given = self.given.get("shear_stiffness", "clough-duncan")
        if isinstance(given, Mapping):
            law = self.read("shear_stiffness", words.hyperbola)
            return Stiffness(normal or 1e7, None, law or HyperbolaParameters())
        shear: float | None = None
        if str(given).lower() != "clough-duncan":
            shear = self.positive("shear_stiffness", "stiffness", "E132")
        return Stiffness(normal or 1e7, shear)

    @staticmethod
    def agree_within(value: object, where: str) -> float:
        part = words.above_zero(value, "ratio", "agree_within", "E127", where)
        if part >= 1.0:
            raise DesignError([Fault("E127", f"agree_within is {number(part * 100)} %, it is less than 100 %", where)])
        return part

    @staticmethod
    def stop_when(value: object, where: str) -> float:
        part = words.above_zero(value, "ratio", "stop_when", "E127", where)
        if not 1e-12 <= part <= 0.1:
            raise DesignError([Fault("E127", f"stop_when is {number(part)}, it lies between 1e-12 and 0.1", where)])
        return part

    def criterion(self, value: object, where: str) -> Criterion:
        value = value.lower() if isinstance(value, str) else value
        if value not in ("limit", "all-pairs"):
            near = get_close_matches(str(value), ("limit", "all-pairs"), n=1)
            advice = f"Did you mean {near[0]}?" if near else ""
            raise DesignError([Fault("E126", f"criterion is {value!r}, it is limit or all-pairs", where, advice)])
        return value
