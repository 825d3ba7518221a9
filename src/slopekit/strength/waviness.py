"""Waviness: the large undulations of a joint on top of any law.

    τ = τ_law(σ) + σ tan φ_w

It never changes the geometry: planes stay flat. Source: SWedge and UnWedge, "joint waviness angle" (Rocscience online
help, joint shear strength, eq. 1: τ = c + σ tan φ + σ tan φ_w).
"""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.protocol import StrengthLaw


@dataclass(frozen=True)
class Wavy:
    """A law, and the angle of the waves (degrees)."""

    name: ClassVar[str] = "waviness"
    law: StrengthLaw
    waviness_deg: float = field(
        metadata={
            "key": "waviness",
            "sign": "φ_w",
            "step": 1.0,
            "unit": "angle",
            "least": 0.0,
            "below": 90.0,
            "example": "5",
            "doc": "angle of the large waves, on any law",
        }
    )

    @property
    def straight(self) -> MohrCoulomb | None:
        """The line that it is on one; None where its law is curved.

        >>> float(Wavy(MohrCoulomb(50.0, 45.0), 45.0).straight.friction_angle_deg.round(6))
        63.434949
        """
        below = (
            self.law if isinstance(self.law, MohrCoulomb) else getattr(self.law, "straight", None)
        )
        if below is None:
            return None
        tangent = np.tan(np.radians(below.friction_angle_deg)) + self._tangent
        return MohrCoulomb(below.cohesion_kpa, np.degrees(np.arctan(tangent)))

    @property
    def _tangent(self) -> Floats:
        tangent: Floats = np.tan(np.radians(self.waviness_deg))
        return tangent

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength τ, (n,) kPa."""
        return self.law.resistance(normal) + np.maximum(normal, 0.0) * self._tangent

    def slope(self, normal: Floats) -> Floats:
        """The slope of the law and tan φ_w, (n,)."""
        return self.law.slope(normal) + self._tangent

    def reduced(self, factor: float) -> "Wavy":
        """Both parts over the factor."""
        return Wavy(self.law.reduced(factor), float(np.degrees(np.arctan(self._tangent / factor))))

    def in_words(self) -> str:
        """The law and the waves."""
        return f"{self.law.in_words()}  waviness {self.waviness_deg:.6g}°"
