"""Mohr-Coulomb: one straight line.

    τ = c + σ tan φ

Source: Coulomb (1776); for joints Hoek & Bray (1981), Rock Slope Engineering, ch. 5.
"""

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats


@dataclass(frozen=True)
class MohrCoulomb:
    """Cohesion (kPa) and friction angle (degrees)."""

    name: ClassVar[str] = "mohr-coulomb"
    cohesion_kpa: float = field(
        metadata={
            "key": "c",
            "sign": "c",
            "unit": "pressure",
            "least": 0.0,
            "example": "50 kPa",
            "doc": "cohesion",
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
            "example": "20",
            "doc": "friction angle",
        }
    )

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength τ = c + σ tan φ, (n,) kPa."""
        return line(
            self.cohesion_kpa,
            math.tan(math.radians(self.friction_angle_deg)),
            np.maximum(normal, 0.0),
        )

    def slope(self, normal: Floats) -> Floats:
        """Return dτ/dσ = tan φ, (n,)."""
        return np.full_like(normal, math.tan(math.radians(self.friction_angle_deg)))

    def reduced(self, factor: float) -> "MohrCoulomb":
        """Return the law with c / F and tan φ / F, which is the line divided by F."""
        tangent = math.tan(math.radians(self.friction_angle_deg)) / factor
        return MohrCoulomb(self.cohesion_kpa / factor, math.degrees(math.atan(tangent)))

    def in_words(self) -> str:
        """Return c and φ in words."""
        return f"c {self.cohesion_kpa:.6g} kPa  φ {self.friction_angle_deg:.6g}°"


def line(cohesion: "Floats | float", tan_friction: "Floats | float", normal: Floats) -> Floats:
    """c + N tan φ of tractions, or of forces with cohesion as a force: the one place where it is written.

    >>> line(np.array([1.0]), np.array([0.5]), np.array([4.0]))
    array([3.])
    """
    return cohesion + tan_friction * normal
