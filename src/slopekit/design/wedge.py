"""The wedge design: everything `slopekit wedge` knows."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from slopekit.design.common import Design, Strength
from slopekit.orientation import Plane

if TYPE_CHECKING:
    from slopekit.strength.protocol import StrengthLaw

#: The paper's wedge (Sheng et al. 2023, Tables 4 and 5): what is left out of a design takes these values.
PAPER_WEDGE: dict[str, Any] = {
    "face": Plane(60.0, 180.0),
    "upper": Plane(10.0, 180.0),
    "height": 64.89,
    "c": (50.0, 50.0),
    "phi": (20.0, 20.0),
    "density": 2600.0,
}
#: The names of those values as the sheet prints them, and of what else may be taken.
DEFAULT_NAMES = {
    "face": "face", "upper": "upper", "height": "height", "c": "c", "phi": "φ", "density": "density",
    "seismic.trend": "seismic trend",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Crack:
    """A tension crack: its plane, and its distance from the crest along the trace of plane 1 (m)."""

    plane: Plane
    distance_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WedgeDesign(Design):
    """One wedge, complete and checked. Made by `slopekit.design.reading.wedge_design`.

    `laws` are the curved ones of the joints; cohesion and friction angle are those of `Strength.by_law` then.
    """

    joints: tuple[Plane, Plane]
    face: Plane
    upper: Plane
    height_m: float
    cohesion_kpa: tuple[float, float]
    friction_angle_deg: tuple[float, float]
    dilation_deg: tuple[float, float] = (0.0, 0.0)
    tension_kpa: tuple[float, float] = (0.0, 0.0)
    crack: Crack | None = None
    refine: int = 0
    origin_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
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

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out."""
        document = super(WedgeDesign, self).inputs()
        document["joints"] = {f"J{k}": str(plane) for k, plane in enumerate(self.joints, 1)}
        return document
