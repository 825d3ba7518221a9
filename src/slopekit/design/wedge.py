"""The wedge design: everything `slopekit wedge` knows."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from slopekit.design.common import Design, Strength
from slopekit.design.fields import Field, count, group, more_than_nothing, number, orientation, point
from slopekit.design.structure import AnyOf, Leaf, ListOf, Section
from slopekit.orientation import Plane

if TYPE_CHECKING:
    from slopekit.strength.protocol import StrengthLaw

#: The paper's wedge (Sheng et al. 2023, Tables 4 and 5): what is left out of a design takes these values.
PAPER_WEDGE: dict[str, Any] = {
    "face": Plane(60.0, 180.0), "upper": Plane(10.0, 180.0), "height": 64.89, "c": 50.0, "phi": 20.0, "density": 2600.0,
}  # fmt: skip
#: The names of those values as the sheet prints them, and of what else may be taken.
DEFAULT_NAMES = {
    "face": "face", "upper": "upper", "height": "height", "c": "c", "phi": "φ", "density": "density",
    "seismic.trend": "seismic trend",
}  # fmt: skip
#: A joint list in place of joints.
FROM_CSV = Section(
    {"csv": Leaf(example="joints.csv"), "pick": AnyOf((ListOf(Leaf(), 1), Leaf())), "convention": Leaf(),
     "strength": Leaf()},
    required=("csv",),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint by its name: its plane, and the strength it names."""

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field("plane", "plane", is_required=True, example="45/115"),
        Field("strength", "text", left_out="the only one", doc="a name under strength"),
    )


JOINTS = Field(
    "joints", "group", of=Joint, many="names", at_least=1, forms=(FROM_CSV,), is_required=True,
    example="{J1: {plane: 45/115}}", doc="by name (a wedge two, a plane one), or a [list](#joint-lists)",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Crack:
    """A tension crack: its plane, and its distance from the crest along the trace of plane 1 (m)."""

    ALSO: ClassVar[tuple[Field, ...]] = (
        Field(
            "water",
            "ratio",
            0.0,
            1.0,
            or_measures="pressure",
            axis="water in the crack",
            left_out="as the joints",
            doc="`dry`, `full`, `50 %`; a mean pressure with its unit, `5 kPa`",
        ),
    )

    plane: Plane = orientation("plane", axis="the crack", example="80/180")
    distance_m: float = number("distance", "length", above=0.0, code="E121", label="crack distance", example="5 m",
                                doc="from the crest along J1's trace")  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class WedgeDesign(Design):
    """One wedge, complete and checked. Made by `slopekit.design.reading.wedge_design`.

    `laws` are the curved ones of the joints; cohesion and friction angle are those of `Strength.by_law` then.
    """

    ALSO: ClassVar[tuple[Field, ...]] = (JOINTS,)
    REQUIRED: ClassVar[tuple[str, ...]] = ()
    FILLS: ClassVar[bool] = True
    DEFAULTS: ClassVar[Mapping[str, Any]] = PAPER_WEDGE
    INTO: ClassVar[Mapping[str, str]] = {"crack.water": "water.crack_fill"}

    joints: tuple[Plane, Plane]
    face: Plane = orientation("slope.face", axis="the face", default=None, example="60/180")
    upper: Plane = orientation("slope.upper", axis="the upper slope", default=None, example="60/180")
    height_m: float = number(
        "slope.height", "length", default=None, least=1e-6, most=1e7, code="E116", example="64.89 m",
        check=more_than_nothing, says="out of range ({least} to {most})",
        doc="vertical, from the toe to where J1's trace meets the crest",
    )  # fmt: skip
    cohesion_kpa: tuple[float, float]
    friction_angle_deg: tuple[float, float]
    dilation_deg: tuple[float, float] = (0.0, 0.0)
    tension_kpa: tuple[float, float] = (0.0, 0.0)
    crack: Crack | None = group("crack", Crack, default=None, left_out="no crack")
    refine: int = count(
        "analysis.refine", 0, 6, default=0, code="E131", advice="Each step makes four triangles of one.",
    )  # fmt: skip
    origin_m: tuple[float, float, float] = point(
        "slope.origin", default=(0.0, 0.0, 0.0), doc="map coordinates of the toe"
    )
    joint_names: tuple[str, str] = ("J1", "J2")
    laws: "tuple[StrengthLaw | None, StrengthLaw | None]" = (None, None)

    @property
    def strengths(self) -> tuple[Strength, ...]:
        """The strength of each joint."""
        parts = self.cohesion_kpa, self.friction_angle_deg, self.dilation_deg, self.tension_kpa, self.laws
        return tuple(Strength(*values) for values in zip(*parts, strict=True))

    def with_strengths(self, first: Strength, second: Strength) -> "WedgeDesign":
        """The same wedge with other strengths on its joints."""
        return replace(
            self, cohesion_kpa=(first.cohesion_kpa, second.cohesion_kpa),
            friction_angle_deg=(first.friction_angle_deg, second.friction_angle_deg),
            dilation_deg=(first.dilation_deg, second.dilation_deg),
            tension_kpa=(first.tension_kpa, second.tension_kpa), laws=(first.law, second.law),
        )  # fmt: skip

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The joints, and the crack where there is one."""
        return (*self.joint_names, "crack") if self.crack is not None else self.joint_names

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out."""
        document = super(WedgeDesign, self).inputs()
        document["joints"] = {f"J{k}": str(plane) for k, plane in enumerate(self.joints, 1)}
        return document
