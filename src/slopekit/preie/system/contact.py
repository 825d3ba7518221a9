"""The contact law of a node pair: modes, stiffness, strength and its reduction (Tables 1 and 2, eqs. 31-33).

Tractions are compression positive, openings positive; all arrays run over the node pairs.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.strength.mohr_coulomb import line

#: k_t / k_n of elastic joints on the path to the limit (docs/method.md): from 0.1 to 1 the limit is the same to 1 % in
#: 635 of 683 sections.
SHEAR_TO_NORMAL = 0.4


class ContactMode(IntEnum):
    """Contact modes of Table 1; a pair in SLIP or DEBOND has failed."""

    STICK = 0
    SLIP = 1
    DEBOND = 2


_STICK, _SLIP, _DEBOND = (np.int64(mode) for mode in ContactMode)
_EYE2 = np.eye(2)


@dataclass(frozen=True)
class CloughDuncan:
    """Clough and Duncan's hyperbola (eq. 31) with the paper's parameters.

    The printed k = k₁ γ_w (σ_n/P_a)ⁿ (1 - R_f τ/(σ_n tan φ₁))² is the tangent of the hyperbola
    τ = s / (1/K + R_f s/(σ_n tan φ₁)), K = k₁ γ_w (σ_n/P_a)ⁿ: the law is integrated, not stepped.
    `floor_kpa` keeps K from vanishing with the normal traction.
    """

    modulus_number: float = 4800.0
    exponent: float = 0.56
    failure_ratio: float = 0.74
    friction_angle_deg: float = 36.0
    water_unit_weight: float = 9.81
    atmospheric_kpa: float = 101.325
    floor_kpa: float = 1.0

    def hyperbola(self, normal: Floats) -> tuple[Floats, Floats, Floats, Bools]:
        """Return K and R_f / (σ_n tan φ₁) of the hyperbola at normal tractions (n,) kPa.

        The last two values are the tractions raised to the floor and a mask of those above it.
        """
        pressed = np.maximum(normal, self.floor_kpa)
        initial = (
            self.modulus_number
            * self.water_unit_weight
            * (pressed / self.atmospheric_kpa) ** self.exponent
        )
        inverse_asymptote = self.failure_ratio / (
            pressed * math.tan(math.radians(self.friction_angle_deg))
        )
        return initial, inverse_asymptote, pressed, normal > self.floor_kpa


@dataclass(frozen=True)
class JointStiffness:
    """Joint stiffness, kN/m³: normal of closed and of debonded pairs, and tangential (constant, or Clough-Duncan)."""

    normal: float = 1.0e7
    debonded: float = 10.0
    tangential: float | CloughDuncan = CloughDuncan()


@dataclass(frozen=True)
class Tractions:
    """Tractions (n, 3) kPa on the plus side of the node pairs, their modes (n,) and their derivatives."""

    tractions: Floats
    modes: Ints
    slope_function: Callable[[], Floats]

    @property
    def slopes(self) -> Floats:
        """Derivatives (n, 3, 3) kN/m³ by relative displacement, computed only where a Newton step needs them."""
        return self.slope_function()


def tractions(
    relative: Floats,
    stiffness: JointStiffness,
    cohesion: Floats,
    tan_friction: Floats,
    tan_dilation: Floats,
    reduction: float,
    debonded: Bools,
) -> Tractions:
    """Return the tractions of node pairs at their relative displacements.

    Parameters
    ----------
    relative : (n, 3) m; opening, and two tangents
    cohesion : (n,) kPa; tan_friction, tan_dilation : (n,); all at full strength
    reduction : strength reduction factor F; c and tan φ are divided by it (eqs. 32, 33)
    debonded : (n,) pairs that have lost their bond: no cohesion and no tension, contact only where they close.
        A bonded pair carries any tension during Newton's method; `breaks` tells afterwards which bonds break.

    Joints that dilate have a constant k_t (k₁ γ_w instead of Clough-Duncan): on the hyperbola more normal traction
    would mean less elastic slip, so more dilation, so more normal traction, without end.
    """
    return reduced_law(stiffness, cohesion, tan_friction, tan_dilation, reduction, debonded)(
        relative
    )


def reduced_law(
    stiffness: JointStiffness,
    cohesion: Floats,
    tan_friction: Floats,
    tan_dilation: Floats,
    reduction: float,
    debonded: Bools,
) -> Callable[[Floats], Tractions]:
    """Return the contact law at one strength reduction factor: tractions as a function of relative displacement."""
    law, k_n = stiffness.tangential, stiffness.normal
    mu, c = tan_friction / reduction, np.where(debonded, 0.0, cohesion / reduction)
    psi = np.minimum(tan_dilation, mu) if tan_dilation.any() else None
    shear_stiffness = (
        law.modulus_number * law.water_unit_weight if isinstance(law, CloughDuncan) else law
    )

    def evaluate(relative: Floats) -> Tractions:
        return _tractions(
            relative,
            stiffness.debonded,
            law if psi is None else shear_stiffness,
            shear_stiffness,
            k_n,
            mu,
            c,
            psi,
            debonded,
        )

    return evaluate


def _tractions(
    relative: Floats,
    open_spring: float,
    law: float | CloughDuncan,
    shear_stiffness: float,
    k_n: float,
    mu: Floats,
    c: Floats,
    psi: Floats | None,
    debonded: Bools,
) -> Tractions:
    opening, tangential = relative[:, 0], relative[:, 1:]
    slip = np.sqrt((tangential * tangential).sum(axis=1))
    distance = np.where(slip > 0.0, slip, 1.0)
    direction = tangential / distance[:, None]

    normal = -k_n * opening
    is_open: Bools = debonded & (normal < 0.0)
    shear, elastic_slopes = _tangential(slip, np.maximum(normal, 0.0), law)
    strength = np.maximum(line(c, mu, normal), 0.0)
    yields: Bools = (shear > strength) & ~is_open
    softer: Floats | float = 1.0
    lifting: Floats | float = 0.0
    if psi is not None:
        # plastic slip closes the joint: σ = σ_elastic + k_n tan ψ (s - strength(σ) / k_t), linear in σ
        softer = np.where(yields, 1.0 / (1.0 + k_n * psi * mu / shear_stiffness), 1.0)
        lifting = np.where(yields, k_n * psi * softer, 0.0)
        normal = np.where(
            yields, (normal + k_n * psi * (slip - c / shear_stiffness)) * softer, normal
        )
        strength = np.maximum(line(c, mu, normal), 0.0)
    # shear as a function of normal traction and slip: the strength where the pair yields, else the elastic law
    force = np.where(is_open, 0.0, np.where(yields, strength, shear))
    traction = np.empty_like(relative)
    traction[:, 0] = np.where(is_open, -open_spring * opening, normal)
    traction[:, 1:] = -force[:, None] * direction

    def slope_function() -> Floats:
        by_slip, by_normal = elastic_slopes()
        slope_normal = np.where(
            is_open, 0.0, np.where(yields, np.where(strength > 0.0, mu, 0.0), by_normal)
        )
        slope_slip = np.where(is_open | yields, 0.0, by_slip) + slope_normal * lifting
        by_opening = np.where(is_open, -open_spring, -k_n * softer)
        secant = np.where(is_open, 0.0, np.where(slip > 0.0, force / distance, by_slip))
        slopes = np.empty((len(slip), 3, 3))
        slopes[:, 0, 0] = by_opening
        slopes[:, 0, 1:] = (
            lifting[:, None] * direction if isinstance(lifting, np.ndarray) else lifting
        )
        slopes[:, 1:, 0] = -(slope_normal * by_opening)[:, None] * direction
        across = direction[:, :, None] * direction[:, None, :]
        slopes[:, 1:, 1:] = (
            -secant[:, None, None] * (_EYE2 - across) - slope_slip[:, None, None] * across
        )
        return slopes

    return Tractions(
        traction, np.where(is_open, _DEBOND, np.where(yields, _SLIP, _STICK)), slope_function
    )


def breaks(law: Tractions, tension: Floats, reduction: float, rounding: float) -> Bools:
    """Return the pairs (n,) whose tensile strength is exceeded (Table 1): σ < -σ_t / F - `rounding`, kPa."""
    return law.tractions[:, 0] < -tension / reduction - rounding


def _tangential(
    slip: Floats, normal: Floats, law: float | CloughDuncan
) -> tuple[Floats, Callable[[], tuple[Floats | float, Floats | float]]]:
    """Return the elastic shear traction (kPa) at a slip (m) and normal traction (kPa), and a function of its slopes."""
    if not isinstance(law, CloughDuncan):
        return law * slip, lambda: (law, 0.0)
    initial, inverse_asymptote, pressed, above = law.hyperbola(normal)
    hyperbolic_reduction = 1.0 / (1.0 + initial * slip * inverse_asymptote)
    shear = initial * slip * hyperbolic_reduction

    def slopes() -> tuple[Floats, Floats]:
        by_normal = (
            hyperbolic_reduction * hyperbolic_reduction * law.exponent * initial * slip
            + shear * shear * inverse_asymptote
        ) / pressed
        return initial * hyperbolic_reduction * hyperbolic_reduction, np.where(
            above, by_normal, 0.0
        )

    return shear, slopes
