"""Any law with its strength divided by a factor."""

from dataclasses import dataclass
from typing import ClassVar

from slopekit.core.arrays import Floats
from slopekit.strength.protocol import StrengthLaw


@dataclass(frozen=True)
class Reduced:
    """τ(σ) / F."""

    name: ClassVar[str] = "reduced"
    law: StrengthLaw
    factor: float

    def resistance(self, normal: Floats) -> Floats:
        """Return the reduced shear strength τ / F, (n,) kPa."""
        return self.law.resistance(normal) / self.factor

    def slope(self, normal: Floats) -> Floats:
        """Return dτ/dσ / F, (n,)."""
        return self.law.slope(normal) / self.factor

    def reduced(self, factor: float) -> "Reduced":
        """Return the law reduced by both factors."""
        return Reduced(self.law, self.factor * factor)

    def in_words(self) -> str:
        """The law and what divides it."""
        return f"{self.law.in_words()}, over {self.factor:.6g}"
