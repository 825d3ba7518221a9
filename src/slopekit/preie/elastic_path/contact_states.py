"""Contact states of elastic joints, the load or strength that drives their path, and the end of a Newton solve."""

from dataclasses import dataclass

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.tolerances import SETTLED


@dataclass(frozen=True)
class PressedShare:
    """The share of its cohesion that each friction group (g,) has: that of the pressed part of its contact.

    `slopes` (g, u) are derivatives by the relative motion of the contact; `by_strength` (g,) by λ, of dilating joints.
    """

    share: Floats
    slopes: Floats
    by_strength: Floats


@dataclass
class ContactState:
    """The forces and contact modes of elastic joints at a displacement.

    Attributes
    ----------
    normal : (m,); friction : (g, t); strength : (g,) r, before it is reduced
    touching : (m,); slips : (g,); direction : (g, t) of the slip; slip : (g,) its size
    unbalanced : (N,) R; largest : of all forces; rounding : unbalanced force that is none
    pressed : the share of the cohesion that acts; None without cohesion, or where bonds are prescribed
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
        """Return the largest unbalanced generalised force."""
        return float(np.abs(self.unbalanced).max())

    def balanced(self, unbalanced: float, tolerance: float = SETTLED) -> bool:
        """Return whether an unbalanced force is within `tolerance` of the largest force, or within its rounding."""
        return unbalanced <= max(tolerance * self.largest, self.rounding)

    def same_modes(self, state: "ContactState") -> bool:
        """Return whether the same pairs touch and the same joints slip in another state."""
        return bool((self.slips == state.slips).all() and (self.touching == state.touching).all())


@dataclass(frozen=True)
class Drive:
    """What a path changes: the strength (`ramp` None, the parameter is λ), or the load P + parameter x ramp.

    `strength` is the λ that stays while the load changes.
    """

    load: Floats
    ramp: Floats | None = None
    strength: float = 1.0

    @property
    def working(self) -> Floats:
        """Return the driving load (N,): the ramp, or, where the strength changes, all loads."""
        return self.load if self.ramp is None else self.ramp

    def strength_and_load(self, parameter: float) -> tuple[float, Floats]:
        """Return the strength λ and the load (N,) at a parameter of the path."""
        if self.ramp is None:
            return parameter, self.load
        return self.strength, self.load + parameter * self.ramp

    def worsened(self, parameter: float, ratio: float) -> float:
        """Return the parameter made worse: `ratio` < 1 times the strength, or the load divided by it."""
        return parameter * ratio if self.ramp is None else parameter / ratio

    def parameter_ratio(self, bad: float, good: float) -> float:
        """Return the ratio of a parameter to a good one: below 1 where it is worse, 1 where they are the same."""
        return bad / good if self.ramp is None else good / bad


@dataclass
class NewtonStep:
    """The end of a Newton solve: displacement (N,), parameter, forces, whether they balance, and number of steps."""

    displacement: Floats
    parameter: float
    forces: ContactState
    settled: bool
    n_steps: int
