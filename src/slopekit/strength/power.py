"""Power curve: a fit to shear tests.

    τ = a σ^b + d   (kPa)

Source: Jaeger (1971), Géotechnique 21, 97-134; in SWedge, RocPlane and UnWedge as "power curve".
"""

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.strength.mohr_coulomb import MohrCoulomb


@dataclass(frozen=True)
class PowerCurve:
    """Factor a and exponent b of tractions in kPa, and the strength d (kPa) at none."""

    name: ClassVar[str] = "power"
    a: float = field(
        metadata={
            "key": "a",
            "sign": "a",
            "unit": "ratio",
            "least": 0.0,
            "most": 1e3,
            "example": "2",
            "doc": "factor, of tractions in kPa",
        }
    )
    b: float = field(
        metadata={
            "key": "b",
            "unit": "ratio",
            "above": 0.0,
            "most": 1.0,
            "example": "0.75",
            "doc": "exponent; 1 is a straight line",
        }
    )
    d_kpa: float = field(
        default=0.0,
        metadata={
            "key": "d",
            "unit": "pressure",
            "least": 0.0,
            "example": "10 kPa",
            "doc": "strength at no normal traction; lost where the joint opens, as cohesion",
        },
    )

    @property
    def straight(self) -> MohrCoulomb | None:
        """The line that it is at b = 1; None where it is curved."""
        return MohrCoulomb(self.d_kpa, math.degrees(math.atan(self.a))) if self.b == 1.0 else None

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength τ = a σ^b + d, (n,) kPa.

        >>> PowerCurve(2.0, 0.5, 3.0).resistance(np.array([0.0, 100.0]))
        array([ 3., 23.])
        """
        return self.a * np.maximum(normal, 0.0) ** self.b + self.d_kpa

    def slope(self, normal: Floats) -> Floats:
        """Return dτ/dσ = a b σ^(b - 1), (n,)."""
        return self.a * self.b * normal ** (self.b - 1.0)

    def reduced(self, factor: float) -> "PowerCurve":
        """Return the law with a and d divided by the factor."""
        return PowerCurve(self.a / factor, self.b, self.d_kpa / factor)

    def in_words(self) -> str:
        """The formula with its numbers."""
        added = f" + {self.d_kpa:.6g}" if self.d_kpa else ""
        return f"power curve {self.a:.6g} σ^{self.b:.6g}{added} kPa"
