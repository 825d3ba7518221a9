"""Bilinear (Patton): the joint rides over its asperities at low tractions and shears through them at high ones.

    τ = σ tan(φ + i)                          σ <= σ_t
    τ = σ_t tan(φ + i) + (σ - σ_t) tan φ      σ > σ_t

Source: Patton (1966), Proc. 1st Congress ISRM, Lisbon, 1, 509-513.
"""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.reduced import Reduced


@dataclass(frozen=True)
class Bilinear:
    """Friction angle φ, angle of the asperities i (degrees) and the traction σ_t (kPa) that shears them."""

    name: ClassVar[str] = "bilinear"
    phi_deg: float = field(
        metadata={
            "key": "phi",
            "sign": "φ",
            "step": 1.0,
            "unit": "angle",
            "least": 0.0,
            "below": 90.0,
            "example": "25",
            "doc": "friction angle of a flat joint",
        }
    )
    i_deg: float = field(
        metadata={
            "key": "i",
            "sign": "i",
            "step": 1.0,
            "unit": "angle",
            "least": 0.0,
            "below": 90.0,
            "example": "15",
            "doc": "angle of the asperities; phi + i is below 90",
        }
    )
    sigma_t_kpa: float = field(
        metadata={
            "key": "sigma_t",
            "sign": "σ_t",
            "unit": "pressure",
            "above": 0.0,
            "example": "300 kPa",
            "doc": "normal traction above which the asperities are sheared",
        }
    )

    @property
    def straight(self) -> MohrCoulomb | None:
        """The line that it is without asperities; None where it is curved."""
        return None if self.i_deg else MohrCoulomb(0.0, self.phi_deg)

    @property
    def _slopes(self) -> tuple[Floats, Floats]:
        return np.tan(np.radians(self.phi_deg + self.i_deg)), np.tan(np.radians(self.phi_deg))

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength τ, (n,) kPa.

        >>> Bilinear(0.0, 45.0, 300.0).resistance(np.array([100.0, 300.0, 900.0])).round(9)
        array([100., 300., 300.])
        """
        steep, flat = self._slopes
        pressure = np.maximum(normal, 0.0)
        return steep * np.minimum(pressure, self.sigma_t_kpa) + flat * np.maximum(
            pressure - self.sigma_t_kpa, 0.0
        )

    def slope(self, normal: Floats) -> Floats:
        """Return dτ/dσ: tan(φ + i) below σ_t, tan φ above, (n,)."""
        steep, flat = self._slopes
        return np.where(normal <= self.sigma_t_kpa, steep, flat)

    def reduced(self, factor: float) -> Reduced:
        """The strength over a factor; σ_t stays."""
        return Reduced(self, factor)

    def in_words(self) -> str:
        """The angles and σ_t."""
        return f"bilinear φ {self.phi_deg:.6g}°  i {self.i_deg:.6g}° below σ_t {self.sigma_t_kpa:.6g} kPa"
