"""Bridged: a joint of limited persistence, interrupted by bridges of intact rock in its own plane.

    c   = k c_joint + (1 - k) c_rock
    tan φ = k tan φ_joint + (1 - k) tan φ_rock        k: persistence, the jointed part of the area

Joint and rock are taken to reach their strength at the same slip, and the bridges to be sheared in the plane: both are
kind to the slope, for intact rock breaks at a smaller slip. Source: Jennings (1970), A mathematical theory for the
calculation of the stability of slopes in open cast mines, Planning Open Pit Mines, Johannesburg, 87-102; k as a part of
the area: Einstein, Veneziano, Baecher & O'Reilly (1983), Int. J. Rock Mech. Min. Sci. 20, 227-236.
"""

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.strength.mohr_coulomb import MohrCoulomb, line


@dataclass(frozen=True)
class Bridged:
    """Joint and rock (kPa, degrees), and the part of the plane that is joint."""

    name: ClassVar[str] = "bridged"
    cohesion_kpa: float = field(
        metadata={
            "key": "c",
            "sign": "c",
            "unit": "pressure",
            "least": 0.0,
            "example": "0 kPa",
            "doc": "cohesion of the joint",
        }
    )
    friction_angle_deg: float = field(
        metadata={
            "key": "phi",
            "sign": "φ",
            "step": 1.0,
            "unit": "angle",
            "least": 0.0,
            "below": 90.0,
            "example": "30",
            "doc": "friction angle of the joint",
        }
    )
    rock_cohesion_kpa: float = field(
        metadata={
            "key": "c_rock",
            "sign": "c_rock",
            "unit": "pressure",
            "least": 0.0,
            "example": "5 MPa",
            "doc": "cohesion of the intact rock in the bridges",
        }
    )
    rock_friction_deg: float = field(
        metadata={
            "key": "phi_rock",
            "sign": "φ_rock",
            "step": 1.0,
            "unit": "angle",
            "least": 0.0,
            "below": 90.0,
            "example": "45",
            "doc": "friction angle of the intact rock in the bridges",
        }
    )
    persistence: float = field(
        metadata={
            "key": "persistence",
            "sign": "k",
            "step": 0.01,
            "unit": "ratio",
            "least": 0.0,
            "most": 1.0,
            "example": "98 %",
            "doc": "jointed part of the plane; the rest is bridges",
        }
    )

    @property
    def straight(self) -> MohrCoulomb:
        """The line that it is.

        >>> found = Bridged(0.0, 30.0, 5000.0, 45.0, 0.98).straight
        >>> round(found.cohesion_kpa, 6), float(np.tan(np.radians(found.friction_angle_deg)).round(6))
        (100.0, 0.585803)
        """
        cohesion, tangent = self._line
        return MohrCoulomb(cohesion, np.degrees(np.arctan(tangent)))

    @property
    def _line(self) -> tuple[float, Any]:
        joint, rock = (
            np.tan(np.radians(angle)) for angle in (self.friction_angle_deg, self.rock_friction_deg)
        )
        k = self.persistence
        return k * self.cohesion_kpa + (1.0 - k) * self.rock_cohesion_kpa, k * joint + (
            1.0 - k
        ) * rock

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength τ, (n,) kPa."""
        cohesion, tangent = self._line
        return line(cohesion, tangent, np.maximum(normal, 0.0))

    def slope(self, normal: Floats) -> Floats:
        """The weighted tan φ, (n,)."""
        return np.broadcast_to(self._line[1], np.shape(normal))

    def reduced(self, factor: float) -> MohrCoulomb:
        """The line over the factor."""
        return self.straight.reduced(factor)

    def in_words(self) -> str:
        """The line, and what it is made of."""
        mean_line = self.straight
        return (
            f"{mean_line.in_words()} (bridged: {self.persistence * 100:.6g} % joint c {self.cohesion_kpa:.6g} kPa "
            f"φ {self.friction_angle_deg:.6g}°, rest rock c {self.rock_cohesion_kpa:.6g} kPa "
            f"φ {self.rock_friction_deg:.6g}°)"
        )
