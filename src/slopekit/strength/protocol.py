"""The protocol of a strength law, and the straight lines that the solvers take in its place.

A law gives the shear strength τ(σ) of a joint at the effective normal traction σ (kPa, compression positive). The
factor of safety divides τ, never the parameters of the law: JRC 8 at F = 2 is half the strength, not JRC 4.

The solvers of one block know lines c + σ tan φ alone. A curved law is the line through its own strength at no traction
and at the traction that acts (the secant), found again where the traction has changed, until it no longer does. There
the limit state is that of the law itself: forces, moments and τ(σ) / F agree in every node pair. The elastic path of
many blocks asks the law itself (`preie.system.joint_strengths`), and ends in such a state.
"""

from dataclasses import fields, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from slopekit.core.arrays import Floats, NDArray

#: Least normal traction, kPa, at which a line is drawn: 1e-6 of the weight of a metre of rock.
LEAST_KPA = 2.5e-5


@runtime_checkable
class StrengthLaw(Protocol):
    """The shear strength of a joint by its normal traction."""

    @property
    def name(self) -> str:
        """The law as design files write it: `barton-bandis`."""
        ...

    def resistance(self, normal: Floats) -> Floats:
        """Shear strength τ (n,) kPa at normal tractions (n,) kPa; negative ones count as none."""
        ...

    def slope(self, normal: Floats) -> Floats:
        """dτ/dσ (n,) at normal tractions (n,) above zero."""
        ...

    def reduced(self, factor: float) -> "StrengthLaw":
        """The law with its strength divided by a factor."""
        ...

    def in_words(self) -> str:
        """The law with its parameters as the sheet prints it."""
        ...


def row_laws(law: Any, count: int) -> NDArray[np.object_]:
    """The laws (n,) of n joints, of one whose numbers may be arrays; Nones of none.

    >>> from slopekit.strength.power import PowerCurve
    >>> [float(law.a) for law in row_laws(PowerCurve(np.array([2.0, 3.0]), 0.5), 2)]
    [2.0, 3.0]
    """
    numbers = (
        {}
        if law is None
        else {parameter.name: getattr(law, parameter.name) for parameter in fields(law)}
    )
    row_values = {
        name: row_laws(number, count)
        for name, number in numbers.items()
        if hasattr(number, "resistance")
    }
    row_values |= {
        name: number for name, number in numbers.items() if isinstance(number, np.ndarray)
    }
    laws = np.full(count, law, dtype=object)
    for row in range(count if row_values else 0):
        laws[row] = replace(law, **{name: values[row] for name, values in row_values.items()})
    return laws


def secant(law: StrengthLaw, normal: Floats, least: float = LEAST_KPA) -> tuple[Floats, Floats]:
    """Cohesion and tan φ (n,) of the lines through τ(0) and τ(σ).

    Parameters
    ----------
    normal : (n,) kPa
    least : kPa; lower tractions are taken as this one, where the steepest laws have no slope

    >>> from slopekit.strength.power import PowerCurve
    >>> secant(PowerCurve(2.0, 0.5), np.array([100.0]))
    (array([0.]), array([0.2]))
    """
    traction = np.maximum(normal, least)
    cohesion = law.resistance(np.zeros_like(traction))
    tangent: Floats = (law.resistance(traction) - cohesion) / traction
    return cohesion, tangent


def tangent(law: StrengthLaw, normal: Floats, least: float = LEAST_KPA) -> tuple[Floats, Floats]:
    """Cohesion and tan φ (n,) of the tangents at normal tractions (n,): of a concave law nowhere below it.

    >>> from slopekit.strength.power import PowerCurve
    >>> tangent(PowerCurve(2.0, 0.5), np.array([100.0]))
    (array([10.]), array([0.1]))
    """
    traction = np.maximum(normal, least)
    slope = law.slope(traction)
    return law.resistance(traction) - traction * slope, slope
