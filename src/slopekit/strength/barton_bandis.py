"""Barton-Bandis: the peak strength of a rough joint.

    τ = σ tan(φ_r + JRC log10(JCS / σ))
    JRC_n = JRC (L_n / L_0)^(-0.02 JRC),   JCS_n = JCS (L_n / L_0)^(-0.03 JRC)

The angle is 70° at the most (Barton 1976, for the low tractions where the logarithm has no bound) and φ_r at the
least, which it comes down to at σ = JCS.

Sources: Barton & Choubey (1977), Rock Mechanics 10, 1-54 (the law with φ_r); Barton & Bandis (1982), 23rd US Symp. on
Rock Mechanics, 739-760 (the scale); Hoek, Practical Rock Engineering, ch. 4, where both are worked through.
"""

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.reduced import Reduced

STEEPEST_DEG = 70.0
_WALLS_KPA = (1e2, 1e6)  # weaker is soil, and nothing is stronger


def _wall_strength_fault(
    value: float, name: str, written: str, key: object
) -> tuple[str, str, str] | None:
    """A wall strength that is typed in another unit: code, message, advice; None where it may be one."""
    if value <= 0.0:
        return "E114", f"{name} is {value:.10g}, it must be more than 0", ""
    if _WALLS_KPA[0] <= value <= _WALLS_KPA[1]:
        return None
    low, high = (f"{end / 1e3:g} MPa" for end in _WALLS_KPA)
    meant, in_kpa = ("MPa", 1e3) if value < _WALLS_KPA[0] else ("Pa", 1e-3)
    advice = ""
    if written.strip()[-1:].isdigit() and _WALLS_KPA[0] <= value * in_kpa <= _WALLS_KPA[1]:
        advice = f"A bare number is kPa. If {meant} are meant, write {value:.10g} {meant}."
    return "E553", f"{name} is {value:.10g} kPa, joint walls have {low} to {high}", advice


@dataclass(frozen=True)
class BartonBandis:
    """Roughness JRC, wall strength JCS (kPa) and residual angle φ_r (degrees), those of a sample `length_0_m` long.

    `length_m` is the length of the joint in the field, None for no correction of scale.
    """

    name: ClassVar[str] = "barton-bandis"
    jrc: float = field(
        metadata={
            "key": "jrc",
            "sign": "JRC",
            "step": 1.0,
            "unit": "ratio",
            "least": 0.0,
            "most": 25.0,
            "example": "8",
            "doc": "joint roughness coefficient, 0 (smooth) to 20 (rough)",
        }
    )
    jcs_kpa: float = field(
        metadata={
            "key": "jcs",
            "sign": "JCS",
            "unit": "pressure",
            "least": _WALLS_KPA[0],
            "most": _WALLS_KPA[1],
            "example": "50 MPa",
            "doc": "compressive strength of the joint wall",
            "check": _wall_strength_fault,
        }
    )
    phi_r_deg: float = field(
        metadata={
            "key": "phi_r",
            "sign": "φ_r",
            "step": 1.0,
            "unit": "angle",
            "least": 0.0,
            "below": STEEPEST_DEG,
            "example": "25",
            "doc": "residual friction angle",
        }
    )
    length_m: float | None = field(
        default=None,
        metadata={
            "key": "length",
            "unit": "length",
            "above": 0.0,
            "example": "5 m",
            "doc": "length of the joint in the field; left out, no correction of scale",
        },
    )
    length_0_m: float = field(
        default=0.1,
        metadata={
            "key": "length_0",
            "unit": "length",
            "above": 0.0,
            "example": "0.1 m",
            "doc": "length of the sample that JRC and JCS were found on",
        },
    )

    @property
    def straight(self) -> MohrCoulomb | None:
        """The line that it is at JRC 0; None where it is curved."""
        return None if self.jrc else MohrCoulomb(0.0, self.phi_r_deg)

    @property
    def scaled(self) -> tuple[float, float]:
        """JRC_n and JCS_n (kPa) at the length of the joint.

        >>> [round(value, 2) for value in BartonBandis(10.0, 100e3, 30.0, length_m=1.0).scaled]
        [6.31, 50118.72]
        """
        if self.length_m is None:
            return self.jrc, self.jcs_kpa
        ratio = self.length_m / self.length_0_m
        return self.jrc * ratio ** (-0.02 * self.jrc), self.jcs_kpa * ratio ** (-0.03 * self.jrc)

    def resistance(self, normal: Floats) -> Floats:
        """Return the shear strength τ, (n,) kPa.

        >>> BartonBandis(16.9, 96e3, 29.0).resistance(np.array([1440.0])).round()
        array([2477.])
        """
        return np.maximum(normal, 0.0) * np.tan(self._angle(normal)[0])

    def slope(self, normal: Floats) -> Floats:
        """Return dτ/dσ = tan φ - JRC / (ln 10 cos² φ), or tan φ where the angle is cut off, (n,)."""
        angle, curved = self._angle(normal)
        falls = np.radians(self.scaled[0]) / math.log(10.0)
        return np.tan(angle) - np.where(curved, falls / np.cos(angle) ** 2, 0.0)

    def _angle(self, normal: Floats) -> tuple[Floats, Floats]:
        roughness, wall = self.scaled
        with np.errstate(divide="ignore"):
            degrees = self.phi_r_deg + roughness * np.log10(
                wall / np.maximum(normal, 1e-300 * np.maximum(1.0, wall))
            )
        limited = np.clip(degrees, self.phi_r_deg, STEEPEST_DEG)
        return np.radians(limited), limited == degrees

    def reduced(self, factor: float) -> Reduced:
        """The strength over a factor: no other JRC gives that."""
        return Reduced(self, factor)

    def in_words(self) -> str:
        """The parameters, with those at the joint's length."""
        roughness, wall = self.scaled
        words = f"Barton-Bandis JRC {self.jrc:.6g}  JCS {self.jcs_kpa / 1e3:.6g} MPa  φ_r {self.phi_r_deg:.6g}°"
        if self.length_m is None:
            return words
        return f"{words}, at {self.length_m:.6g} m JRC {roughness:.4g}  JCS {wall / 1e3:.4g} MPa"
