"""What designs of every kind share, in m, kN, kPa, kN/m³ and degrees."""

import hashlib
import json
import math
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from slopekit.orientation import Line, Plane, number

if TYPE_CHECKING:
    from slopekit.design.distributions import Variable
    from slopekit.design.nodes import Document
    from slopekit.strength.protocol import StrengthLaw

Criterion = Literal["limit", "all-pairs"]
#: Two coordinates of what scatters, by `Variable.coordinates`, and their rank correlation.
Pair: TypeAlias = tuple[str, str, float]


_FOR_PICTURES_KPA = 100.0


@dataclass(frozen=True, slots=True)
class Water:
    """Water on the joints: dry, full (scaled by `fill`) or mean pressures in kPa, one for each interface.

    `crack_fill` is what fills a wedge's tension crack, None where it has what the joints have.
    """

    mode: Literal["dry", "full", "pressures"] = "dry"
    fill: float = 0.0
    pressures_kpa: tuple[float, ...] = ()
    crack_fill: float | None = None

    def in_words(self) -> str:
        """The water as the sheet prints it."""
        if self.crack_fill is not None:
            return f"{replace(self, crack_fill=None).in_words()}, the crack {self.crack_fill * 100:g} % full"
        if self.mode == "dry":
            return "dry"
        if self.mode == "full":
            return "full" if self.fill == 1.0 else f"{self.fill * 100:g} % of full"
        return "u = " + ", ".join(f"{pressure:g}" for pressure in self.pressures_kpa) + " kPa"


@dataclass(frozen=True, slots=True)
class Seismic:
    """Pseudo-static coefficient, and the trend it acts toward (None: the way the block would slide)."""

    coefficient: float = 0.0
    trend_deg: float | None = None


@dataclass(frozen=True, slots=True)
class Force:
    """A force on the block: east, north, up (kN), and the point it acts at (None: the centroid).

    `block` names the block of an assembly.
    """

    components_kn: tuple[float, float, float]
    at_m: tuple[float, float, float] | None = None
    block: str | None = None


@dataclass(frozen=True, slots=True)
class Bolt:
    """A bolt: its force (kN) and direction on the block; its head and length (m) where they are known.

    An active bolt is a load. A passive bolt is strength: its capacity is divided by the strength
    reduction factor, and it pulls only if the block moves against it.
    """

    force_kn: float
    toward: Line
    acts: Literal["active", "passive"] = "active"
    head_m: tuple[float, float, float] | None = None
    length_m: float | None = None
    block: str | None = None


@dataclass(frozen=True, slots=True)
class HyperbolaParameters:
    """Clough and Duncan's hyperbola (eq. 31), the paper's parameters where none are given."""

    modulus_number: float = 4800.0
    exponent: float = 0.56
    failure_ratio: float = 0.74
    friction_angle_deg: float = 36.0


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Joint stiffness for displacements and the all-pairs criterion (the limit factor does not need it).

    `shear_kn_m3` is a constant, or None for Clough and Duncan's hyperbola with `hyperbola`.
    """

    normal_kn_m3: float = 1.0e7
    shear_kn_m3: float | None = None
    hyperbola: HyperbolaParameters = HyperbolaParameters()

    def in_words(self) -> str:
        """Both stiffnesses as the sheet prints them."""
        if self.shear_kn_m3 is not None:
            shear = f"{self.shear_kn_m3:.4g} kN/m³"
        else:
            shear = "Clough-Duncan"
            if self.hyperbola != HyperbolaParameters():
                law = self.hyperbola
                shear += f" (k₁ {law.modulus_number:g}, n {law.exponent:g}, R_f {law.failure_ratio:g})"
        return f"k_n {self.normal_kn_m3:.4g} kN/m³, k_t {shear}"


@dataclass(frozen=True, slots=True)
class Strength:
    """Strength of an interface at full strength: kPa and degrees.

    Mohr-Coulomb, or the curved `law`; then the cohesion is its strength at no normal traction, and the friction angle
    that of the line from there to its strength at 100 kPa: for pictures and checks, the solvers ask the law.
    """

    cohesion_kpa: float
    friction_angle_deg: float
    dilation_deg: float = 0.0
    tension_kpa: float = 0.0
    law: "StrengthLaw | None" = None

    @classmethod
    def by_law(cls, law: "StrengthLaw", dilation_deg: float = 0.0, tension_kpa: float = 0.0) -> "Strength":
        """The strength of a curved law.

        >>> from slopekit.strength.power import PowerCurve
        >>> Strength.by_law(PowerCurve(2.0, 0.5)).friction_angle_deg
        11.309932474020213
        """
        import numpy as np

        from slopekit.strength.protocol import secant

        cohesion, tangent = secant(law, np.array([_FOR_PICTURES_KPA]))
        return cls(float(cohesion[0]), math.degrees(math.atan(float(tangent[0]))), dilation_deg, tension_kpa, law)


@dataclass(frozen=True, slots=True)
class MeshFile:
    """A mesh file that a design names; two of the same content are the same, wherever they lie."""

    name: str
    sha256: str
    path: str = field(compare=False, repr=False)
    where: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Rule:
    """An acceptance rule: what is held against a value, `fos >= 1.5`.

    `fos` is the factor of the design's criterion; `fos.limit`, `fos.closed_form`, `fos.static_bound` and
    `fos.all_pairs_failed` are the factors by name.
    """

    name: str
    relation: Literal[">=", ">", "<=", "<"]
    value: float

    def met(self, found: float | None) -> bool:
        """Whether a value meets the rule; no value meets none."""
        if found is None:
            return False
        if self.relation in (">=", ">"):
            return found > self.value or (self.relation == ">=" and found == self.value)
        return found < self.value or (self.relation == "<=" and found == self.value)

    def __str__(self) -> str:
        return f"{self.name} {self.relation} {number(self.value)}"


_OF_STUDIES = ("variables", "correlation", "source")


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """A complete and checked design: what every kind has.

    Attributes
    ----------
    stop_when : a factor that still moved by more than this part in the last pass is not settled
    factors : strength reduction factors at which the displacements and failed pairs are wanted (the paper's Table 3)
    assumed : inputs that were given as distributions, with the value a deterministic run takes
    defaults : names of the inputs that were left out
    left_out : what of the files that the design names is not used, in words
    variables : what scatters: numbers and orientations that were given as distributions
    correlation : pairs of them with their rank correlation
    source : the document it was read from, which studies read again with other values; None where it was not
    """

    title: str = ""
    unit_weight_kn_m3: float
    density_kg_m3: float | None = None
    gravity_m_s2: float = 9.81
    water_unit_weight_kn_m3: float = 9.81
    water: Water = Water()
    seismic: Seismic = Seismic()
    forces: tuple[Force, ...] = ()
    bolts: tuple[Bolt, ...] = ()
    stiffness: Stiffness = Stiffness()
    criterion: Criterion = "limit"
    rules: tuple[Rule, ...] = ()
    agree_within: float = 0.01
    stop_when: float = 1e-4
    factors: tuple[float, ...] = ()
    assumed: tuple[tuple[str, str], ...] = field(default=(), compare=False)
    defaults: tuple[str, ...] = field(default=(), compare=False)
    left_out: tuple[str, ...] = field(default=(), compare=False)
    variables: "tuple[Variable, ...]" = field(default=(), compare=False)
    correlation: tuple[Pair, ...] = field(default=(), compare=False)
    source: "Document | None" = field(default=None, compare=False, repr=False)

    @property
    def kind(self) -> str:
        """The kind as design files write it."""
        return type(self).__name__.removesuffix("Design").lower()

    def _single(self) -> "Design":
        """The design without what only studies use."""
        return replace(self, source=None, variables=(), correlation=())

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out; of what scatters the value that a run takes."""
        document: dict[str, Any] = _plain(self._single())
        for key in ("defaults", "assumed", "left_out", *_OF_STUDIES):
            del document[key]
        return document

    def input_hash(self) -> str:
        """SHA-256 of the kind and the inputs: equal designs give equal hashes.

        It is the hash of a single run: a design whose φ is a distribution of mean 20 has the hash of the one whose φ is
        20. What a study draws depends on `variables` and `correlation` too.
        """
        exact = _plain(self._single(), exact=True) | {"kind": self.kind}
        for key in _OF_STUDIES:
            del exact[key]
        exact |= dict.fromkeys(("defaults", "assumed", "left_out", "title"))
        return hashlib.sha256(json.dumps(exact, sort_keys=True).encode()).hexdigest()


_LAWS = ("law", "laws")


def _laws(given: Any) -> tuple[Any, ...]:
    return given if isinstance(given, tuple) else (given,)


def _plain(value: Any, exact: bool = False) -> Any:
    """Dataclasses and tuples as JSON values, planes in the way they are written unless every digit counts."""
    if isinstance(value, MeshFile):
        return {"sha256": value.sha256} if exact else {"file": value.name, "sha256": value.sha256}
    if isinstance(value, Plane) and not exact:
        return str(value)
    if is_dataclass(value):
        found = {
            part.name: _plain(getattr(value, part.name), exact) for part in fields(value)
            if part.name not in _LAWS or any(_laws(getattr(value, part.name)))
        }  # fmt: skip
        if hasattr(value, "resistance"):  # a law is written with its name, waves beside it
            inner = found.pop("law", {"law": getattr(value, "name", "")})
            found = inner | found
        return found
    if isinstance(value, tuple):
        return [_plain(item, exact) for item in value]
    return value
