"""What stands on elastic joints: their forces, what drives their path, and where Newton's method ended."""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.tolerances import SETTLED


@dataclass(frozen=True)
class PressedShare:
    """The share of its cohesion that each friction force (g,) has, as what is pressed where it acts.

    Slopes (g, u) by the relative motion of its contact, and, dilating, by λ (g,).
    """

    share: Floats
    slopes: Floats
    by_strength: Floats


@dataclass
class BedForces:
    """What the joints carry at a displacement.

    Attributes
    ----------
    normal : (m,); friction : (g, t); strength : (g,) r, before it is reduced
    touching : (m,); slips : (g,); direction : (g, t) of the slip; slip : (g,) its size
    unbalanced : (N,) R; largest : of all forces; rounding : unbalanced force that is none
    pressed : of what the cohesion acts on; None without cohesion
    """

    normal: Floats
    friction: Floats
    strength: Floats
    touching: Bools
    slips: Bools
    direction: Floats
    slip: Floats
    unbalanced: Floats
    largest: float
    rounding: float
    pressed: PressedShare | None = None

    @property
    def residual(self) -> float:
        """Largest unbalanced generalised force."""
        return float(np.abs(self.unbalanced).max())

    def balanced(self, off: float, part: float = SETTLED) -> bool:
        """Whether an unbalanced force is as small as it should be."""
        return off <= max(part * self.largest, self.rounding)

    def same_modes(self, other: "BedForces") -> bool:
        """Whether the same pairs touch and the same joints slip."""
        return bool((self.slips == other.slips).all() and (self.touching == other.touching).all())


@dataclass(frozen=True)
class Drive:
    """What the path changes: the strength (`ramp` None, the parameter is λ), or the load P + parameter x ramp.

    `strength` is the λ that stays while the load changes.
    """

    load: Floats
    ramp: Floats | None = None
    strength: float = 1.0

    @property
    def working(self) -> Floats:
        """The load whose work drives, (N,)."""
        return self.load if self.ramp is None else self.ramp

    def at(self, parameter: float) -> tuple[float, Floats]:
        """λ and the load (N,)."""
        if self.ramp is None:
            return parameter, self.load
        return self.strength, self.load + parameter * self.ramp

    def harder(self, parameter: float, ratio: float) -> float:
        """The parameter made worse: `ratio` < 1 times the strength, or the load divided by it."""
        return parameter * ratio if self.ramp is None else parameter / ratio

    def gap(self, bad: float, good: float) -> float:
        """How far apart a good and a worse parameter are, 1 where they are the same."""
        return bad / good if self.ramp is None else good / bad


@dataclass
class NewtonStep:
    """Where Newton's method ended: displacement (N,), parameter, forces, whether they balance, steps taken."""

    at: Floats
    parameter: float
    forces: BedForces
    settled: bool
    taken: int
