"""What designs of every kind share, in m, kN, kPa, kN/m³ and degrees."""

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, field, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias

from slopekit.core.orientation import Line, Plane
from slopekit.core.orientation import number as shown
from slopekit.core.records import dataclass
from slopekit.design.fields import Field, group, in_degrees, number, orientation, point, text
from slopekit.design.structure import Anything, Leaf, ListOf, Named

if TYPE_CHECKING:
    from slopekit.design.distributions import Variable
    from slopekit.design.nodes import Document
    from slopekit.strength.protocol import StrengthLaw

Criterion = Literal["limit", "all-pairs"]
#: Two coordinates of what scatters, by `Variable.coordinates`, and their rank correlation.
Pair: TypeAlias = tuple[str, str, float]


@dataclass(frozen=True, slots=True)
class Project:
    """Whose design it is, as pages show it: no number depends on it."""

    name: str = text("name", default="", example="Route 7, km 12.4", left_out="not shown", doc="of the project")
    client: str = text("client", default="", left_out="not shown", doc="for whom")
    number: str = text("number", default="", left_out="not shown", doc="of the project")
    author: str = text("author", default="", left_out="not shown", doc="who made it")
    checker: str = text("checker", default="", left_out="not shown", doc="who checked it")
    revision: str = text("revision", default="", left_out="not shown", doc="of the design")
    date: str = text("date", default="", example="2026-11-22", left_out="not shown", doc="as it is written")

    def given(self) -> dict[str, str]:
        """What is known of it, by key."""
        return {key: value for key, value in asdict(self).items() if value}


@dataclass(frozen=True, slots=True)
class Water:
    """Water on the joints: dry, full (scaled by `fill`) or mean pressures in kPa, one for each interface.

    `crack_fill` is what fills a wedge's tension crack, None where it has what the joints have.
    """

    mode: Literal["dry", "full", "pressures", "table"] = text("mode", default="dry", example="dry", doc="`dry`, `full`")
    fill: float = number(
        "fill",
        "ratio",
        default=0.0,
        least=0.0,
        most=1.0,
        example="50 %",
        left_out="dry",
        axis="part of full water",
        doc="part of full; one of mode, fill, pressures (E198)",
    )
    pressures_kpa: tuple[float, ...] = number(
        "pressures",
        "pressure",
        default=(),
        least=0.0,
        each=True,
        label="water pressure",
        doc="mean pressures: one, a list, or by the names of the interfaces",
    )
    crack_fill: float | None = None

    def in_words(self) -> str:
        """The water as the sheet prints it."""
        if self.crack_fill is not None:
            return f"{replace(self, crack_fill=None).in_words()}, the crack {self.crack_fill * 100:g} % full"
        if self.mode in ("dry", "table"):
            return self.mode
        if self.mode == "full":
            return "full" if self.fill == 1.0 else f"{self.fill * 100:g} % of full"
        return "u = " + ", ".join(f"{pressure:g}" for pressure in self.pressures_kpa) + " kPa"


@dataclass(frozen=True, slots=True)
class Seismic:
    """Pseudo-static coefficient, and the trend it acts toward (None: the way the block would slide)."""

    coefficient: float = number(
        "k", "ratio", default=0.0, least=0.0, most=2.0, code="E122", label="seismic coefficient", doc="parts of gravity"
    )
    trend_deg: float | None = number(
        "toward", "angle", default=None, least=0.0, most=360.0, turns=True, code="E122", scatters=False,
        label="trend of seismic", axis="trend of the seismic load",
        left_out="the way of the slope", doc="trend it acts toward",
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Force:
    """A force on the block: east, north, up (kN), and the point it acts at (None: the centroid).

    `block` names the block of an assembly.
    """

    ALSO: ClassVar[tuple[Field, ...]] = (Field("toward", "line", example="000/10", doc="trend/plunge"),)

    components_kn: tuple[float, float, float] = number(
        "force", "force", code="E123", coordinates=1, axis="size", forms=(ListOf(Leaf(), 3, 3, example="[0, -3, 6]"),),
        doc="size, or its components",
    )  # fmt: skip
    at_m: tuple[float, float, float] | None = point("at", default=None, axis="place", left_out="the centroid",
                                                           doc="where it acts")  # fmt: skip
    block: str | None = text("block", default=None, example="B1", left_out="the one it lies in, or the only one",
                             doc="the block it acts on")  # fmt: skip


@dataclass(frozen=True, slots=True)
class Bolt:
    """A bolt: its force (kN) and direction on the block; its head and length (m) where they are known.

    An active bolt is a load. A passive bolt is strength: its capacity is divided by the strength
    reduction factor, and it pulls only if the block moves against it.
    """

    force_kn: float = number("force", "force", above=0.0, code="E124", label="force of the bolt", axis="force")
    toward: Line = orientation("toward", "line", example="000/10", doc="direction of its force on the block")
    acts: Literal["active", "passive"] = text("acts", default="active", doc="active or passive")
    head_m: tuple[float, float, float] | None = point(
        "head", default=None, left_out="the centroid", doc="where its head is"
    )
    length_m: float | None = number(
        "length",
        "length",
        default=None,
        above=0.0,
        code="E124",
        label="length of the bolt",
        axis="length",
        left_out="not known",
        doc="needs a head (E124)",
    )
    block: str | None = text("block", default=None, example="B1", left_out="the one its head lies in",
                             doc="the block its force acts on")  # fmt: skip


def forces_without(*keys: str) -> Any:
    """A list of forces, by their keys but for these, or in words."""
    return group(
        "loads.forces", Force, default=(), many="list", without=keys, coordinates=2, or_measures=("force",),
        forms=(Leaf(example="500 kN@180/10"), ListOf(Leaf(), 3, 3, example="[0, -3, 6]")),
    )  # fmt: skip


def bolts_without(*keys: str) -> Any:
    """A list of bolts, by their keys but for these, or in words."""
    forms = (Leaf(example="200 kN@000/10,passive"),)
    return group("support.bolts", Bolt, default=(), many="list", without=keys, forms=forms)


@dataclass(frozen=True, slots=True)
class HyperbolaParameters:
    """Clough and Duncan's hyperbola (eq. 31), the paper's parameters where none are given."""

    ALSO: ClassVar[tuple[Field, ...]] = (Field("law", "text", example="clough-duncan", left_out="clough-duncan"),)

    modulus_number: float = number("k1", "ratio", default=4800.0, above=0.0, code="E132", role="setting")
    exponent: float = number("n", "ratio", default=0.56, least=0.0, most=2.0, code="E132", role="setting")
    failure_ratio: float = number("Rf", "ratio", default=0.74, least=0.0, most=1.0, code="E132", role="setting")
    friction_angle_deg: float = number("phi", "angle", default=36.0, above=0.0, below=90.0, code="E132", role="setting")


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Joint stiffness for displacements and the all-pairs criterion (the limit factor does not need it).

    `shear_kn_m3` is a constant, or None for Clough and Duncan's hyperbola with `hyperbola`.
    """

    normal_kn_m3: float = number(
        "normal", "stiffness", default=1.0e7, above=0.0, code="E132", example="1e7", role="setting",
        label="normal_stiffness",
    )  # fmt: skip
    shear_kn_m3: float | None = number(
        "shear", "stiffness", default=None, above=0.0, code="E132", words=("clough-duncan",), of=HyperbolaParameters,
        example="clough-duncan", role="setting", label="shear_stiffness",
    )  # fmt: skip
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
class Residual:
    """Strength of an interface that has slipped: kPa and degrees. It neither dilates nor holds tension."""

    cohesion_kpa: float = number("c", "pressure", least=0.0, code="E114", axis="residual cohesion",
                                 says="cohesion is never negative", example="0 kPa",
                                 doc="up to the peak's")  # fmt: skip
    friction_angle_deg: float = number(
        "phi", "angle", least=0.0, below=90.0, code="E115", check=in_degrees, example="25",
        axis="residual friction angle", says="a friction angle lies from 0 to below 90", doc="up to the peak's (E453)",
    )  # fmt: skip

    def in_words(self) -> str:
        """Cohesion and friction as the sheet prints them."""
        return f"residual c {self.cohesion_kpa:.6g} kPa  φ {self.friction_angle_deg:.6g}°"


@dataclass(frozen=True, slots=True)
class Strength:
    """Strength of an interface at full strength: kPa and degrees.

    Mohr-Coulomb, or the curved `law`; then the cohesion is its strength at no normal traction, and the friction angle
    that of the line from there to its strength at 100 kPa: for pictures and checks, the solvers ask the law.
    `made_of` is a law that is a straight line: cohesion and friction angle are its own then, and there is no `law`.
    """

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("stiffness", "group", of=Stiffness),
        Field("residual", "group", of=Residual, left_out="none",
              doc="strength after slip: both factors are given"),
        Field("law", "text", example="barton-bandis", left_out="mohr-coulomb",
              doc="`mohr-coulomb`, or one of [curved strength](#curved-strength), whose keys then stand for c and phi"),
    )  # fmt: skip

    cohesion_kpa: float = number(
        "c",
        "pressure",
        least=0.0,
        code="E114",
        says="cohesion is never negative",
        example="50 kPa",
        may_lack=True,
        axis="cohesion",
        doc="cohesion",
    )
    friction_angle_deg: float = number(
        "phi", "angle", least=0.0, below=90.0, code="E115", check=in_degrees, example="20", may_lack=True,
        axis="friction angle",
        says="a friction angle lies from 0 to below 90",
        doc="broken numbers below 1.57 are taken for radians (E113) unless written with `deg`",
    )  # fmt: skip
    dilation_deg: float = number("dilation", "angle", default=0.0, least=0.0, below=90.0, code="E117",
                                 says="it lies between 0 and the friction angle", axis="dilation angle",
                                 doc="up to phi")  # fmt: skip
    tension_kpa: float = number(
        "tension", "pressure", default=0.0, least=0.0, code="E114", says="a strength is never negative",
        axis="tensile strength", doc="tensile strength; not in the limit (W329)",
    )  # fmt: skip
    law: "StrengthLaw | None" = None
    made_of: "StrengthLaw | None" = None
    residual: Residual | None = None

    @property
    def named_law(self) -> "StrengthLaw | None":
        """The law it was given by, curved or straight; None where that is c and φ themselves."""
        return self.law or self.made_of

    def at_residual(self) -> "Strength":
        """The strength after slip: the residual one, where there is one."""
        left = self.residual
        return self if left is None else Strength(left.cohesion_kpa, left.friction_angle_deg)

    @classmethod
    def by_law(cls, law: "StrengthLaw", dilation_deg: float = 0.0, tension_kpa: float = 0.0) -> "Strength":
        """The strength of a law, curved or straight.

        >>> from slopekit.strength.power import PowerCurve
        >>> round(Strength.by_law(PowerCurve(2.0, 0.5)).friction_angle_deg, 9)
        11.309932474
        """
        import numpy as np

        from slopekit.strength.protocol import secant

        line = getattr(law, "straight", None)
        if line is not None:
            return cls(line.cohesion_kpa, line.friction_angle_deg, dilation_deg, tension_kpa, made_of=law)
        cohesion, tangent = secant(law, np.array([_FOR_PICTURES_KPA]))
        return cls(float(cohesion[0]), math.degrees(math.atan(float(tangent[0]))), dilation_deg, tension_kpa, law)

    @staticmethod
    def more_fields() -> "tuple[Field, ...]":
        """The keys of the curved laws, which are looked at in files alone."""
        from slopekit.design.strength_laws import KEYS

        return tuple(KEYS.values())


@dataclass(frozen=True, slots=True)
class MeshFile:
    """A mesh file that a design names; two of the same content are the same, wherever they lie."""

    name: str
    sha256: str
    path: str = field(compare=False, repr=False)
    where: str = field(default="", compare=False, repr=False)


def _factor(path: str, doc: str, least: bool = False) -> Any:
    limits: dict[str, Any] = {"least": 0.0} if least else {"above": 0.0}
    return number(path, "ratio", default=1.0, most=10.0, code="E478", role="setting", scatters=False, doc=doc, **limits)


@dataclass(frozen=True, slots=True)
class FactoredNumber:
    """A number of a design with a partial factor: characteristic, factor (None: it follows), design value.

    `divided` says that the factor divides, as those of strength do.
    """

    what: str
    characteristic: float | None
    factor: float | None
    design: float | None
    unit: str
    divided: bool = False


@dataclass(frozen=True, slots=True)
class PartialFactors:
    """Factors on actions, strengths and resistance; `called` and `source` say whose, `table` what they made."""

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("set", "text", example="DA1-C2", left_out="all 1", doc="a set whose other factors are taken"),
        Field("forces", "text", example="variable", left_out="permanent",
              doc="what `loads.forces`, and the load of a footing, are: `permanent` or `variable`"),
    )  # fmt: skip

    permanent_unfavourable: float = _factor("permanent_unfavourable", "weight and forces that drive; all water")
    permanent_favourable: float = _factor("permanent_favourable", "weight and forces that hold", least=True)
    variable_unfavourable: float = _factor("variable_unfavourable", "surcharge that drives")
    variable_favourable: float = _factor("variable_favourable", "surcharge that holds", least=True)
    tan_phi: float = _factor("tan_phi", "divides tan φ, and τ of a curved law")
    c: float = _factor("c", "divides c and tension")
    unit_weight: float = _factor("unit_weight", "of the rock")
    resistance: float = _factor("resistance", "divides the strength of all joints once more, not that of bolts")
    forces: str = "permanent"
    called: str = ""
    source: str = ""
    table: tuple[FactoredNumber, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        return asdict(self) | {"table": [asdict(row) for row in self.table]}


@dataclass(frozen=True, slots=True)
class CaseKeys:
    """What a load case says: which keys of the design it sets, by their paths, and what is accepted."""

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("set", "group", forms=(Named(Anything(), pairs=True),), example="{loads.seismic.k: 0.1}",
              left_out="the design as it is", doc="keys by their paths, as `--set` takes them; `null` takes one out"),
        Field("accept", "text", forms=(ListOf(Leaf(example='"fos >= 1.1"')), Leaf(example='"fos >= 1.1"')),
              example='"fos >= 1.1"', left_out="the design's rules", doc="one or a list, as `acceptance.rules`"),
    )  # fmt: skip


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
        return f"{self.name} {self.relation} {shown(self.value)}"


_FOR_PICTURES_KPA = 100.0
_RANGE = "out of range ({least} to {most})"


def _slips_of_unit_weight(
    value: float, name: str, written: str, called: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """E110 with the likely slip of units."""
    message = f"{name} is {shown(value)} kN/m³, out of range (5 to 400)"
    if 500.0 <= value <= 10000.0:
        return "E110", message, f"{shown(value)} looks like a density: write {called('rock.density')} {shown(value)}."
    if 10000.0 < value <= 50000.0:
        return "E110", message, f"{shown(value)} looks like N/m³: write '{shown(value)} N/m3'."
    if 0.5 <= value < 5.0:
        return "E110", message, f"{shown(value)} looks like t/m³: write {called('rock.density')} '{shown(value)} t/m3'."
    return None


def _slips_of_density(
    value: float, name: str, written: str, called: Callable[[str], str]
) -> tuple[str, str, str] | None:
    """E111 with the likely slip of units."""
    message = f"{name} is {shown(value)} kg/m³, out of range (500 to 10000)"
    if 0.5 <= value <= 10.0:
        return "E111", message, f"{shown(value)} looks like t/m³: write '{shown(value)} t/m3'."
    if 10.0 < value <= 60.0:
        other = called("rock.unit_weight")
        return "E111", message, f"{shown(value)} looks like a unit weight: write {other} {shown(value)}."
    return None


_OF_STUDIES = ("variables", "correlation", "source", "cases")
_OF_PAGES = ("project",)
_BESIDE = ("partial",)
_OF_READING = ("crack_searched", "defaults", "assumed", "left_out", "read_as")


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
    read_as : what of them was read in another way than it stands there, in words
    variables : what scatters: numbers and orientations that were given as distributions
    correlation : pairs of them with their rank correlation
    source : the document it was read from, which studies read again with other values; None where it was not
    cases : its load cases, each a design of its own
    """

    #: Whether water may be said as a part of full.
    FILLS: ClassVar[bool] = False
    #: Beside the attributes: keys that are read into several, top keys that must be there, and those that are not;
    #: what a design takes where they are left out, which the sheet says.
    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("slopekit", "text", is_required=True, example="1", doc="version of the language"),
        Field("kind", "text", is_required=True, example="wedge", doc="what the design is"),
        Field(
            "strength",
            "group",
            of=Strength,
            many="names",
            at_least=1,
            example="{joint: {c: 50 kPa, phi: 20}}",
            left_out="required (a wedge: the paper's)",
        ),
        Field(
            "correlation",
            "ratio",
            -1.0,
            1.0,
            many="pairs",
            scatters=False,
            role="scatter",
            example="{J1.phi/J2.phi: 0.8}",
        ),
        Field("cases", "group", of=CaseKeys, many="names", at_least=1, left_out="the design alone",
              example="{quake: {set: {loads.seismic.k: 0.1}}}", doc="[load cases](cases.md) by name"),
    )  # fmt: skip
    REQUIRED: ClassVar[tuple[str, ...]] = ("strength", "rock")
    WITHOUT: ClassVar[tuple[str, ...]] = ()
    DEFAULTS: ClassVar[Mapping[str, Any]] = {}
    #: Attributes that hold what stands at a key of another path.
    INTO: ClassVar[Mapping[str, str]] = {}
    #: Attributes that inputs and their hash leave out where they are None: younger than the hashes that users keep.
    UNSAID: ClassVar[tuple[str, ...]] = ()

    title: str = text("title", default="", doc="text")
    project: Project = group("project", Project, default=Project(), left_out="nothing", doc="on pages only")
    unit_weight_kn_m3: float = number(
        "rock.unit_weight", "unit weight", default=None, least=5.0, most=400.0, code="E110", label="unit weight",
        axis="unit weight of the rock", says=_RANGE, advice="Rock weighs 20 to 30 kN/m³.", check=_slips_of_unit_weight,
        left_out="by the density", doc="or density (E112)",
    )  # fmt: skip
    density_kg_m3: float | None = number(
        "rock.density", "density", default=None, least=500.0, most=10000.0, code="E111", example="2600 kg/m3",
        says=_RANGE, advice="Rock has 2000 to 3000 kg/m³.", check=_slips_of_density,
        left_out="required (a footing: no weight; blocks: each its own)", doc="or unit_weight (E112)",
    )  # fmt: skip
    gravity_m_s2: float = number(
        "rock.gravity", "acceleration", default=9.81, least=1.0, most=25.0, code="E130", says=_RANGE, axis="gravity",
        advice="9.81 m/s² is Earth's.",
    )  # fmt: skip
    modulus_kpa: float | None = number(
        "rock.modulus", "pressure", default=None, least=1e3, most=1e9, code="E284", example="20 GPa", role="setting",
        scatters=False, label="modulus", says="it lies between 1 MPa and 1000 GPa", left_out="20 GPa with --elastic",
        advice="Rock has 1 to 100 GPa: write '20 GPa'. A bare number is kPa.", doc="Young's modulus, for --elastic",
    )  # fmt: skip
    poisson: float | None = number(
        "rock.poisson", "ratio", default=None, least=0.0, most=0.49, code="E285", example="0.25", role="setting",
        scatters=False, label="Poisson's ratio", left_out="0.25 with --elastic", advice="Rock has 0.15 to 0.35.",
        doc="Poisson's ratio, for --elastic",
    )  # fmt: skip
    elastic_edge_m: float | None = number(
        "analysis.elastic.edge", "length", default=None, above=0.0, code="E287", words=("auto",), example="auto",
        role="setting", scatters=False, label="edge", left_out="auto", advice="The longest edge of a finite element.",
        doc="longest edge of an element at contacts, for --elastic; `auto`: an eighth of the longest of the block",
    )  # fmt: skip
    elastic_bedrock: str | None = text(
        "analysis.elastic.bedrock", default=None, words=("rigid", "elastic"), code="E291", left_out="rigid",
        example="rigid", doc="`elastic`: a body of the same rock around one block, for --elastic",
    )  # fmt: skip
    water_unit_weight_kn_m3: float = number(
        "water.unit_weight", "unit weight", default=9.81, least=5.0, most=15.0, code="E110", says=_RANGE,
        advice="Water weighs 9.81 kN/m³ (62.4 pcf).", label="unit weight of water",
    )  # fmt: skip
    water: Water = group("water", Water, default=Water(), forms=(Leaf(example="dry"),), left_out="dry",
                         doc="`dry`, `full`, `50 %`, or by its keys")  # fmt: skip
    seismic: Seismic = number(
        "loads.seismic", "ratio", default=Seismic(), least=0.0, most=2.0, code="E122", of=Seismic, example="0.1",
        label="seismic coefficient", left_out="0", doc="part of gravity: `0.1`, `0.1@180`, or by its keys",
    )  # fmt: skip
    forces: tuple[Force, ...] = forces_without("block")
    bolts: tuple[Bolt, ...] = bolts_without("block")
    stiffness: Stiffness = Stiffness()
    criterion: Criterion = text(
        "analysis.criterion",
        default="limit",
        code="E126",
        words=("limit", "all-pairs"),
        left_out="limit",
        example="limit",
    )
    rules: tuple[Rule, ...] = text(
        "acceptance.rules", default=(), example='["fos >= 1.5"]',
        doc="one or a list; `>=`, `>`, `<=`, `<` on `fos`, `fos.limit`, `fos.lowest`, `fos.closed_form`, "
        "`fos.static_bound`, `fos.all_pairs_failed`, `fos.residual`, on surfaces "
        "`fos.fellenius`, `fos.janbu`, `fos.bishop`, "
        "`fos.all_equilibrium`",
        forms=(ListOf(Leaf(example='"fos >= 1.5"')), Leaf()),
    )  # fmt: skip
    agree_within: float = number("analysis.agree_within", "ratio", default=0.01, above=0.0, below=1.0, code="E127",
                                 scatters=False, role="setting",
                                 doc="largest relative difference of the methods")  # fmt: skip
    stop_when: float = number("analysis.stop_when", "ratio", default=1e-4, least=1e-12, most=0.1, code="E127",
                              scatters=False, role="setting",
                              doc="change of the factor at which passes have settled")  # fmt: skip
    factors: tuple[float, ...] = number(
        "analysis.factors", "ratio", default=(), above=0.0, code="E127", many="list", scatters=False, role="setting",
        example="[1.0, 1.1, 1.2]", label="factor",
        doc="reduction factors, at most 200: displacements and failed pairs at each",
    )  # fmt: skip
    partial: PartialFactors | None = group(
        "analysis.partial_factors", PartialFactors, default=None, forms=(Leaf(example="DA1-C2"),), left_out="none",
        doc="[partial factors](cases.md#partial-factors): `DA1-C1`, `DA1-C2`, `DA2`, `DA3`, a file, or its keys",
    )  # fmt: skip
    assumed: tuple[tuple[str, str], ...] = field(default=(), compare=False)
    defaults: tuple[str, ...] = field(default=(), compare=False)
    left_out: tuple[str, ...] = field(default=(), compare=False)
    read_as: tuple[str, ...] = field(default=(), compare=False)
    variables: "tuple[Variable, ...]" = field(default=(), compare=False)
    correlation: tuple[Pair, ...] = field(default=(), compare=False)
    source: "Document | None" = field(default=None, compare=False, repr=False)
    cases: "tuple[LoadCase, ...]" = field(default=(), compare=False, repr=False)

    @property
    def is_cut_for_loads(self) -> bool:
        """Whether loads are integrated over the faces of the block: closed forms need it cut, too."""
        return False

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The interfaces that may have a water pressure of their own, by the names of the file."""
        return ()

    @property
    def kind(self) -> str:
        """The kind as design files write it."""
        return type(self).__name__.removesuffix("Design").lower()

    def _single(self) -> "Design":
        """The design without what only studies use."""
        return replace(self, source=None, variables=(), correlation=(), cases=())

    @property
    def invented(self) -> tuple[str, ...]:
        """Numbers of the slope that were left out and taken from elsewhere, by name."""
        return tuple(name for name in self.defaults if name in self.DEFAULTS)

    def in_own_names(self, sentence: str) -> str:
        """A sentence on what happens, joints by the names that the user gave them."""
        return sentence

    def at_residual(self) -> "Design":
        """The design with residual strength wherever there is one."""
        return self.each_strength(Strength.at_residual)

    def each_strength(self, change: Callable[[Strength], Strength]) -> "Design":
        """The design with every strength changed."""
        found = {part.name: _changed(getattr(self, part.name), change) for part in fields(self)}
        return replace(self, **found)

    def beside(self) -> dict[str, Any]:
        """What JSON has beside the inputs: whose design it is, its partial factors; nothing without them."""
        project = self.project.given()
        found: dict[str, Any] = {"project": project} if project else {}
        return found if self.partial is None else found | {"partial_factors": self.partial.to_dict()}

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out; of what scatters the value that a run takes."""
        document: dict[str, Any] = _plain(self._single())
        for key in (*_OF_READING, *_OF_STUDIES, *_OF_PAGES, *_BESIDE):
            document.pop(key, None)
        for key in self.UNSAID:
            if document.get(key, "") is None:
                del document[key]
        return document

    def input_hash(self) -> str:
        """SHA-256 of the kind and the inputs: equal designs give equal hashes.

        It is the hash of a single run: a design whose φ is a distribution of mean 20 has the hash of the one whose φ is
        20. What a study draws depends on `variables` and `correlation` too.
        """
        exact = _plain(self._single(), exact=True) | {"kind": self.kind}
        for key in (*_OF_STUDIES, *_OF_PAGES):
            del exact[key]
        for key in ("read_as", "crack_searched"):
            exact.pop(key, None)
        for key in self.UNSAID:
            if exact.get(key, "") is None:
                del exact[key]
        exact |= dict.fromkeys(("defaults", "assumed", "left_out", "title"))
        return hashlib.sha256(json.dumps(exact, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class LoadCase:
    """A load case: its name, what it sets (paths and what was written), the design with that, without cases."""

    name: str
    sets: tuple[tuple[str, str], ...]
    design: Design

    @property
    def in_words(self) -> str:
        """What it sets, for a table."""
        return ", ".join(f"{path} {value}" for path, value in self.sets)


def _changed(value: Any, change: Callable[[Strength], Strength]) -> Any:
    if isinstance(value, Strength):
        return change(value)
    return tuple(_changed(item, change) for item in value) if type(value) is tuple else value


_IF_GIVEN = (
    "law", "laws", "made_of", "residual", "residuals", "table_depth_m", "table_points_m", "table_plane", "pond_m",
    "surcharge_kpa", "surcharges_kpa", "partial", "modulus_kpa", "poisson", "elastic_edge_m", "elastic_bedrock",
)  # fmt: skip


def _parts(given: Any) -> tuple[Any, ...]:
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
            if part.name not in _IF_GIVEN or any(one is not None for one in _parts(getattr(value, part.name)))
        }  # fmt: skip
        if hasattr(value, "resistance"):  # a law is written with its name, waves beside it
            inner = found.pop("law", {"law": getattr(value, "name", "")})
            found = inner | found
        return found
    if isinstance(value, tuple):
        return [_plain(item, exact) for item in value]
    return value
