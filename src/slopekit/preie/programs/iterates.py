"""Points of the interior-point method of `programs.program`, and steps between them."""

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.programs.cones import longest_step, longest_step_to_zero

_TO_BOUNDARY = 0.99  # part of the way to where a force or its multiplier is nothing


@dataclass(frozen=True, slots=True)
class Iterate:
    """A point of the method.

    Attributes
    ----------
    normal : (m,) normal forces N; friction : (g, t) friction forces T
    load_factor : λ; shed : σ
    strength : (g, 1 + t) points of the friction cones: what is allowed, and T
    velocity : (n u,) of the blocks
    gap : (m,) multipliers of N; slip : (g, 1 + t) of the cones; shed_slack : of σ
    """

    normal: Floats
    friction: Floats
    load_factor: float
    shed: float
    strength: Floats
    velocity: Floats
    gap: Floats
    slip: Floats
    shed_slack: float

    @property
    def complementarity(self) -> float:
        """What the multipliers still earn: bounds the error of the load factor."""
        return float(self.normal @ self.gap + (self.strength * self.slip).sum() + self.shed * self.shed_slack)


@dataclass(frozen=True, slots=True)
class IterateStep(Iterate):
    """A change of every part of an iterate."""

    def longest(self, at: Iterate, most: float | None = None) -> float:
        """How far the step may go, at most 1; `most` where it is known what its pairs and cones allow."""
        ends = [most] if most is not None else [
            longest_step_to_zero(at.normal, self.normal), longest_step_to_zero(at.gap, self.gap),
            longest_step(at.strength, self.strength), longest_step(at.slip, self.slip),
        ]  # fmt: skip
        singles = (
            (at.shed, self.shed),
            (at.shed_slack, self.shed_slack),
            (at.load_factor, self.load_factor),
        )
        ends += [-value / change for value, change in singles if change < 0.0]
        return min(1.0, _TO_BOUNDARY * min(ends))

    def taken(self, at: Iterate, length: float) -> Iterate:
        """The iterate after so much of the step."""
        return Iterate(
            at.normal + length * self.normal, at.friction + length * self.friction,
            at.load_factor + length * self.load_factor, at.shed + length * self.shed,
            at.strength + length * self.strength, at.velocity + length * self.velocity, at.gap + length * self.gap,
            at.slip + length * self.slip, at.shed_slack + length * self.shed_slack,
        )  # fmt: skip
