"""The records of a design, in m, kN, kPa and degrees: water, loads, bolts, strength, stiffness, partial factors."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from slopekit.core.orientation import Line, Plane
from slopekit.core.orientation import number as number_text
from slopekit.design.fields import (
    Field,
    declare,
    group,
    in_degrees,
    keys_of,
    number,
    orientation,
    point,
    text,
)
from slopekit.design.reading.structure import VALUE, Spec

if TYPE_CHECKING:
    from slopekit.strength.protocol import StrengthLaw

_FOR_PICTURES_KPA = 100.0


#: The kind of action of a number: weight, water, a force, or a load on the upper slope. `ACTIONS` of a record has the
#: attributes that partial factors multiply, with their kind.
Action = Literal["weight", "water", "force", "surcharge"]


def listed(record: type, name: str) -> Iterator[Any]:
    """Yield the values of a class attribute of a record and its bases, those of the bases first."""
    return (vars(base)[name] for base in reversed(record.__mro__) if name in vars(base))


@dataclass(frozen=True)
class Project:
    """The project data shown on report pages; no number depends on them."""

    name: str = text(
        "name", default="", example="Route 7, km 12.4", left_out="not shown", doc="of the project"
    )
    client: str = text("client", default="", left_out="not shown", doc="for whom")
    number: str = text("number", default="", left_out="not shown", doc="of the project")
    author: str = text("author", default="", left_out="not shown", doc="who made it")
    checker: str = text("checker", default="", left_out="not shown", doc="who checked it")
    revision: str = text("revision", default="", left_out="not shown", doc="of the design")
    date: str = text(
        "date", default="", example="2026-11-22", left_out="not shown", doc="as it is written"
    )

    def filled_keys(self) -> dict[str, str]:
        """Return the keys that are not empty, with their values."""
        return {key: value for key, value in asdict(self).items() if value}


@dataclass(frozen=True)
class TablePlane:
    """A planar water table: its orientation, and its elevation above the toe in m."""

    plane: Plane
    level_m: float

    def __str__(self) -> str:
        return f"{self.plane}@{number_text(self.level_m)}m"


@dataclass(frozen=True)
class Water:
    """The water pressure on the joints: dry, full (times `fill`), mean pressures in kPa, or below a water table.

    There is one mean pressure for each interface. A water table is given by its depth `table_depth_m` below the ground,
    by `table_points_m` (distance and elevation) or by `table_plane`; the others are None. `pond_m` is the level of open
    water. A tension crack has water of depth `crack_water_m`, or the fraction `crack_fill` of full water pressure; None
    where it has the water of the joints.
    """

    ACTIONS: ClassVar[Mapping[str, Action]] = {"pressures_kpa": "water"}
    #: Attributes that JSON has next to the water of the design, where they are not None.
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = (
        "table_depth_m",
        "table_points_m",
        "table_plane",
        "pond_m",
        "crack_water_m",
    )

    mode: Literal["dry", "full", "pressures", "table"] = text(
        "mode", default="dry", example="dry", doc="`dry`, `full`"
    )
    fill: float = number(
        "fill",
        "ratio",
        default=0.0,
        least=0.0,
        most=1.0,
        example="50 %",
        left_out="dry",
        axis="part of full water",
        doc="part of full pressure; one of mode, fill, pressures (E112)",
    )
    pressures_kpa: tuple[float, ...] = number(
        "pressures",
        "pressure",
        default=(),
        least=0.0,
        per_interface=True,
        code="E118",
        label="water pressure",
        doc="mean pressures: one, a list, or by the names of the interfaces",
    )
    crack_fill: float | None = None
    table_depth_m: float | None = number(
        "depth",
        "length",
        default=None,
        least=0.0,
        code="E454",
        axis="depth of the water table",
        says="a table lies at or below the ground",
        example="4 m",
        left_out="no table",
        doc="with `mode: table`: of the table below the ground, vertical",
    )
    table_points_m: tuple[tuple[float, float], ...] | None = text(
        "points",
        default=None,
        coordinates=2,
        left_out="no table",
        doc="with `mode: table`: distance from the toe into the slope (surfaces, blocks: x), ascending, and elevation; "
        "level beyond its ends",
        forms=(Spec(items=Spec(items=VALUE, at_least=2, at_most=2), at_least=2),),
        example="[[0, 0], [10, 4], [30, 9]]",
    )
    table_plane: TablePlane | None = text(
        "plane",
        default=None,
        left_out="no table",
        example="5/180@2m",
        doc="with `mode: table`: a plane, and its elevation over the toe (surfaces, blocks: the origin)",
    )
    pond_m: float | None = number(
        "pond",
        "length",
        default=None,
        axis="level of the pond",
        example="3 m",
        left_out="no pond",
        doc="elevation of open water at the toe; the table is as high at least",
    )
    crack_water_m: float | None = None

    @property
    def is_wet(self) -> bool:
        """Whether there is water, at least in the crack or in one of several rows."""
        return self.mode != "dry" or any(
            map(np.any, (self.fill, self.crack_fill, self.crack_water_m))
        )

    @property
    def has_table(self) -> bool:
        """Whether the water is given by a water table or a pond."""
        return self.mode == "table"

    def in_words(self) -> str:
        """Return the water as the sheet prints it."""
        if self.crack_fill is not None:
            crack = f"the crack {self.crack_fill * 100:g} % of full pressure"
            return f"{replace(self, crack_fill=None).in_words()}, {crack}"
        if self.mode in ("dry", "table"):
            return self.mode
        if self.mode == "full":
            return "full" if self.fill == 1.0 else f"{self.fill * 100:g} % of full pressure"
        return "u = " + ", ".join(f"{pressure:g}" for pressure in self.pressures_kpa) + " kPa"

    def table_in_words(self, along: str, elevation_reference: str) -> list[str]:
        """Return the lines of the sheet about the water table and the pond.

        Parameters
        ----------
        along : the axis of the points' distances, in words
        elevation_reference : the point where a plane has its elevation, in words
        """
        entries = []
        if self.table_depth_m is not None:
            entries.append(f"water table {number_text(self.table_depth_m)} m below the ground")
        if self.table_points_m is not None:
            first, last = self.table_points_m[0], self.table_points_m[-1]
            entries.append(
                f"water table through {len(self.table_points_m)} points, from {number_text(first[1])} m at "
                f"{number_text(first[0])} m to {number_text(last[1])} m at {number_text(last[0])} m{along}"
            )
        elif self.table_plane is not None:
            entries.append(
                f"water table {self.table_plane.plane}, {number_text(self.table_plane.level_m)} m {elevation_reference}"
            )
        if self.pond_m is not None:
            entries.append(f"pond to {number_text(self.pond_m)} m")
        return entries


@dataclass(frozen=True)
class Seismic:
    """The pseudo-static seismic coefficient and the trend it acts toward, degrees (None: the sliding direction)."""

    coefficient: float = number(
        "k",
        "ratio",
        default=0.0,
        least=0.0,
        most=2.0,
        code="E122",
        label="seismic coefficient",
        says="it lies between {least} and {most} (parts of gravity)",
        doc="parts of gravity",
    )
    trend_deg: float | None = number(
        "toward",
        "angle",
        default=None,
        least=0.0,
        most=360.0,
        turns=True,
        code="E122",
        scatters=False,
        label="trend of seismic",
        axis="trend of the seismic load",
        left_out="the way of the slope",
        doc="trend it acts toward",
    )


@dataclass(frozen=True)
class Force:
    """A force on the block: components east, north, up (kN) and its point of application (None: the centroid).

    `block` is the name of the block in an assembly; `toward` the direction given in the file, None for components.
    """

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare("toward", "line", label="force", code="E123", example="000/10", doc="trend/plunge"),
    )
    ACTIONS: ClassVar[Mapping[str, Action]] = {"components_kn": "force"}

    components_kn: tuple[float, float, float] = number(
        "force",
        "force",
        code="E123",
        coordinates=1,
        axis="size",
        forms=(Spec(items=VALUE, at_least=3, at_most=3, example="[0, -3, 6]"),),
        doc="size, or its components",
    )
    at_m: tuple[float, float, float] | None = point(
        "at",
        default=None,
        label="point of the force",
        axis="place",
        left_out="the centroid",
        doc="where it acts",
    )
    block: str | None = text(
        "block",
        default=None,
        example="B1",
        left_out="the one it lies in, or the only one",
        doc="the block it acts on",
    )
    toward: Line | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Bolt:
    """A bolt: its force on the block (kN), the direction, and optionally the point of its head and its length (m).

    An active bolt is a load. A passive bolt is strength: its capacity is divided by the strength reduction factor, and
    it acts only if the block moves against it.
    """

    force_kn: float = number(
        "force", "force", above=0.0, code="E124", label="force of the bolt", axis="force"
    )
    toward: Line = orientation(
        "toward",
        "line",
        label="bolt",
        axis="toward",
        code="E124",
        example="000/10",
        doc="direction of its force on the block",
    )
    acts: Literal["active", "passive"] = text(
        "acts", default="active", words=("active", "passive"), code="E124", label="a bolt"
    )
    head_m: tuple[float, float, float] | None = point(
        "head",
        default=None,
        label="head of the bolt",
        axis="head",
        left_out="the centroid",
        doc="where its head is",
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
    block: str | None = text(
        "block",
        default=None,
        example="B1",
        left_out="the one its head lies in",
        doc="the block its force acts on",
    )


def forces_without(*keys: str) -> Any:
    """Declare a list of forces, by keys (without those of `keys`) or in short form."""
    return group(
        "loads.forces",
        Force,
        default=(),
        many="list",
        omitted_keys=keys,
        coordinates=2,
        or_measures=("force",),
        forms=(Spec("value", items=VALUE, at_least=3, at_most=3, example="500 kN@180/10"),),
    )


def bolts_without(*keys: str) -> Any:
    """Declare a list of bolts, by keys (without those of `keys`) or in short form."""
    return group(
        "support.bolts",
        Bolt,
        default=(),
        many="list",
        omitted_keys=keys,
        forms=(Spec("value", example="200 kN@000/10,passive"),),
    )


@dataclass(frozen=True)
class HyperbolaParameters:
    """The parameters of Clough and Duncan's hyperbola (eq. 31), with the paper's values as defaults."""

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare("law", "text", example="clough-duncan", left_out="clough-duncan"),
    )

    modulus_number: float = number(
        "k1", "ratio", default=4800.0, above=0.0, code="E127", role="setting"
    )
    exponent: float = number(
        "n", "ratio", default=0.56, least=0.0, most=2.0, code="E127", role="setting"
    )
    failure_ratio: float = number(
        "Rf", "ratio", default=0.74, least=0.0, most=1.0, code="E127", role="setting"
    )
    friction_angle_deg: float = number(
        "phi", "angle", default=36.0, above=0.0, below=90.0, code="E127", role="setting"
    )


@dataclass(frozen=True)
class Stiffness:
    """The joint stiffness for displacements and the all-pairs criterion (the limit factor does not depend on it).

    `shear_kn_m3` is a constant, or None for Clough and Duncan's hyperbola with `hyperbola`.
    """

    normal_kn_m3: float = number(
        "normal",
        "stiffness",
        default=1.0e7,
        above=0.0,
        code="E127",
        example="1e7",
        role="setting",
        label="normal stiffness",
    )
    shear_kn_m3: float | None = number(
        "shear",
        "stiffness",
        default=None,
        above=0.0,
        code="E127",
        words=("clough-duncan",),
        record_type=HyperbolaParameters,
        example="clough-duncan",
        role="setting",
        label="shear stiffness",
    )
    hyperbola: HyperbolaParameters = HyperbolaParameters()

    def in_words(self) -> str:
        """Return the normal and shear stiffness as the sheet prints them."""
        if self.shear_kn_m3 is not None:
            shear = f"{self.shear_kn_m3:.4g} kN/m³"
        else:
            shear = "Clough-Duncan"
            if self.hyperbola != HyperbolaParameters():
                law = self.hyperbola
                shear += (
                    f" (k₁ {law.modulus_number:g}, n {law.exponent:g}, R_f {law.failure_ratio:g})"
                )
        return f"k_n {self.normal_kn_m3:.4g} kN/m³, k_t {shear}"


@dataclass(frozen=True)
class Residual:
    """The strength of an interface after slip (kPa, degrees), without dilation and tensile strength."""

    cohesion_kpa: float = number(
        "c",
        "pressure",
        least=0.0,
        code="E114",
        axis="residual cohesion",
        says="cohesion is never negative",
        example="0 kPa",
        doc="up to the peak's",
    )
    friction_angle_deg: float = number(
        "phi",
        "angle",
        least=0.0,
        below=90.0,
        code="E115",
        check=in_degrees,
        example="25",
        axis="residual friction angle",
        says="a friction angle lies from 0 to below 90",
        doc="up to the peak's (E453)",
    )

    def in_words(self) -> str:
        """Return cohesion and friction angle as the sheet prints them."""
        return f"residual c {self.cohesion_kpa:.6g} kPa  φ {self.friction_angle_deg:.6g}°"


@dataclass(frozen=True)
class Strength:
    """The unreduced strength of an interface, kPa and degrees.

    Mohr-Coulomb, or the curved `law`. For a curved law, cohesion and friction angle are those of the secant between the
    normal tractions 0 and 100 kPa; they serve pictures and checks, the solvers use the law itself. `made_of` is a law
    with a linear envelope, whose cohesion and friction angle the record has; `law` is None then.
    """

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare("stiffness", "group", record_type=Stiffness),
        declare(
            "residual",
            "group",
            record_type=Residual,
            left_out="none",
            doc="strength after slip: both factors are given",
        ),
        declare(
            "law",
            "text",
            example="barton-bandis",
            left_out="mohr-coulomb",
            doc="`mohr-coulomb`, or one of [curved strength](#curved-strength), whose keys then stand for c and phi",
        ),
    )

    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("law", "made_of", "residual")

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
        "phi",
        "angle",
        least=0.0,
        below=90.0,
        code="E115",
        check=in_degrees,
        example="20",
        may_lack=True,
        axis="friction angle",
        says="a friction angle lies from 0 to below 90",
        doc="broken numbers below 1.57 are taken for radians (E113) unless written with `deg`",
    )
    dilation_deg: float = number(
        "dilation",
        "angle",
        default=0.0,
        least=0.0,
        below=90.0,
        code="E115",
        says="it lies between 0 and the friction angle",
        axis="dilation angle",
        doc="up to phi",
    )
    tension_kpa: float = number(
        "tension",
        "pressure",
        default=0.0,
        least=0.0,
        code="E114",
        says="a strength is never negative",
        axis="tensile strength",
        doc="tensile strength; not in the limit (W329)",
    )
    law: "StrengthLaw | None" = None
    made_of: "StrengthLaw | None" = None
    residual: Residual | None = None

    @property
    def named_law(self) -> "StrengthLaw | None":
        """The law given in the design, curved or linear; None if the design gives c and φ."""
        return self.law or self.made_of

    def at_residual(self) -> "Strength":
        """Return the residual strength, or the strength itself where it has none."""
        residual = self.residual
        return (
            self
            if residual is None
            else Strength(residual.cohesion_kpa, residual.friction_angle_deg)
        )

    @classmethod
    def by_law(
        cls, law: "StrengthLaw", dilation_deg: float = 0.0, tension_kpa: float = 0.0
    ) -> "Strength":
        """Return the strength of a law, curved or linear.

        >>> from slopekit.strength.power import PowerCurve
        >>> round(Strength.by_law(PowerCurve(2.0, 0.5)).friction_angle_deg, 9)
        11.309932474
        """
        from slopekit.strength.protocol import secant

        line = getattr(law, "straight", None)
        if line is not None:
            return cls(
                line.cohesion_kpa, line.friction_angle_deg, dilation_deg, tension_kpa, made_of=law
            )
        cohesion, tangent = secant(law, np.array([_FOR_PICTURES_KPA]))
        return cls(
            float(cohesion[0]),
            math.degrees(math.atan(float(tangent[0]))),
            dilation_deg,
            tension_kpa,
            law,
        )

    @staticmethod
    def more_fields() -> "tuple[Field, ...]":
        """Return the keys of the curved laws, which only design files have."""
        from slopekit.design.strength_laws import KEYS

        return tuple(KEYS.values())


@dataclass(frozen=True)
class MeshFile:
    """A mesh file that a design names; files with the same name and content are equal, in whatever folder.

    `up` is the vertical axis of the file, y or z; `length_unit` (in m) and `unit_name` are those of a DXF file that is
    not in metres.
    """

    name: str
    sha256: str
    path: str = field(compare=False, repr=False)
    where: str = field(default="", compare=False, repr=False)
    up: str = "z"
    length_unit: float = field(default=1.0, compare=False, repr=False)
    unit_name: str = field(default="", compare=False, repr=False)

    @property
    def label(self) -> str:
        """The file's name, with its vertical axis if that is y, and its length unit if that is not the metre."""
        axis = " (y is up there)" if self.up == "y" else ""
        unit = f" ($INSUNITS {self.unit_name}, scaled to m)" if self.unit_name else ""
        return f"{self.name}{axis}{unit}"


def axis_key(path: str) -> Field:
    """Declare the key of the vertical axis of a mesh file."""
    return declare(
        path,
        "text",
        words=("y", "z"),
        code="E172",
        label=path,
        example="y",
        left_out="y of GLB, else z",
        doc="which axis of the mesh file points up",
    )


def _factor(path: str, doc: str, least: bool = False) -> Any:
    limits: dict[str, Any] = {"least": 0.0} if least else {"above": 0.0}
    return number(
        path,
        "ratio",
        default=1.0,
        most=10.0,
        code="E127",
        role="setting",
        scatters=False,
        doc=doc,
        **limits,
    )


@dataclass(frozen=True)
class FactoredNumber:
    """A number with its partial factor: characteristic value, factor (None: a derived number) and design value.

    `divided` marks factors that divide, as those of strength do.
    """

    what: str
    characteristic: float | None
    factor: float | None
    design: float | None
    unit: str
    divided: bool = False


@dataclass(frozen=True)
class PartialFactors:
    """The partial factors of actions, strengths and resistance.

    `called` and `source` are the name and the source of the set; `table` has the factored numbers of the design.
    """

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare(
            "set",
            "text",
            example="DA1-C2",
            left_out="all 1",
            doc="a set whose other factors are taken",
        ),
        declare(
            "forces",
            "text",
            example="variable",
            left_out="permanent",
            doc="what `loads.forces`, and the load of a footing, are: `permanent` or `variable`",
        ),
    )

    permanent_unfavourable: float = _factor(
        "permanent_unfavourable", "weight and forces that drive; all water"
    )
    permanent_favourable: float = _factor(
        "permanent_favourable", "weight and forces that hold", least=True
    )
    variable_unfavourable: float = _factor("variable_unfavourable", "surcharge that drives")
    variable_favourable: float = _factor("variable_favourable", "surcharge that holds", least=True)
    tan_phi: float = _factor("tan_phi", "divides tan φ, and τ of a curved law")
    c: float = _factor("c", "divides c and tension")
    unit_weight: float = _factor("unit_weight", "of the rock")
    resistance: float = _factor(
        "resistance", "divides the strength of all joints once more, not that of bolts"
    )
    forces: str = "permanent"
    called: str = ""
    source: str = ""
    table: tuple[FactoredNumber, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the factors and their table as JSON values."""
        return asdict(self) | {"table": [asdict(row) for row in self.table]}


#: The keys of a load case: values of the design that it sets, by their paths, and its acceptance rules.
CASE_KEYS = keys_of(
    "CaseKeys",
    declare(
        "set",
        "group",
        forms=(Spec(names=Spec(is_anything=True), pairs=True),),
        example="{loads.seismic.k: 0.1}",
        left_out="the design as it is",
        doc="keys by their paths, as `--set` takes them; `null` takes one out",
    ),
    declare(
        "accept",
        "text",
        forms=(Spec("value", items=Spec("value", example='"fos >= 1.1"')),),
        example='"fos >= 1.1"',
        left_out="the design's rules",
        doc="one or a list, as `acceptance.rules`",
    ),
)


#: Names of the acceptance rules on the factor of safety itself.
ON_FACTOR = ("fos", "fos.limit")


ROUNDING = 1e-9  # relative, of a factor of safety that a study has solved for


@dataclass(frozen=True)
class Rule:
    """An acceptance rule, a comparison of a value with a number: `fos >= 1.5`.

    `fos` is the factor of the design's criterion; `fos.limit`, `fos.closed_form`, `fos.static_bound` and
    `fos.all_pairs_failed` are the factors by name.
    """

    name: str
    relation: Literal[">=", ">", "<=", "<"]
    value: float

    @property
    def is_on_factor(self) -> bool:
        """Whether the rule is about the governing factor of safety, not about another factor by its name."""
        return self.name in ON_FACTOR

    @property
    def is_least(self) -> bool:
        """Whether the rule gives a lower limit."""
        return self.relation in (">=", ">")

    def is_met_by(self, value: float | None) -> bool:
        """Return whether a value meets the rule, within rounding for >= and <=; None does not."""
        if value is None:
            return False
        if abs(value - self.value) <= ROUNDING * abs(self.value):
            return self.relation in (">=", "<=")
        return value > self.value if self.is_least else value < self.value

    def __str__(self) -> str:
        return f"{self.name} {self.relation} {number_text(self.value)}"
