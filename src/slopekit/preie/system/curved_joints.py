"""Curved strength at the normal forces that act: what node pairs resist, and how that follows their normal forces.

The elastic path asks the law itself at every displacement, so that rests, limit states and peaks are those of the law,
found in one path. Below the least traction a law is the line to its strength there: the steepest have no slope at
none.
"""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.records import dataclass
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import LEAST_TRACTION
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """One law, the node pairs that have it, its strength at no traction, and the line below the least traction."""

    law: StrengthLaw
    pairs: Ints
    none: float
    steepest: float


class PairStrengths:
    """What friction makes of the normal forces (m,) of node pairs, cohesion apart; straight joints by tan φ."""

    def __init__(self, model: AssemblyModel) -> None:
        assert model.lines is not None
        self._straight = model.tan_friction[model.group_of_pair].copy()
        self._area = model.control_area * (model.area_scale / model.force_scale)  # a traction of one kPa
        real = model.joint_pairs
        mean = len(model.load) / float(self._area[real].sum())
        self._least = max(LEAST_KPA, LEAST_TRACTION * mean)
        self._curves: list[_Curve] = []
        for key, law in enumerate(model.lines.laws):
            pairs = np.flatnonzero(model.lines.joint == key)
            if law is not None and len(pairs):
                none, least = law.resistance(np.array([0.0, self._least]))
                self._curves.append(_Curve(law, pairs, float(none), float(least - none) / self._least))
                self._straight[pairs] = 0.0

    def resistance(self, normal: Floats) -> Floats:
        """(m,) of normal forces; of less than the least traction, and of pulls, on the line there."""
        resists = self._straight * normal
        for curve in self._curves:
            area = self._area[curve.pairs]
            traction = normal[curve.pairs] / area
            strength = curve.law.resistance(np.maximum(traction, self._least)) - curve.none
            resists[curve.pairs] = area * np.where(traction < self._least, curve.steepest * traction, strength)
        return resists

    def slope(self, normal: Floats) -> Floats:
        """How that changes with them, (m,)."""
        slopes = self._straight.copy()
        for curve in self._curves:
            traction = normal[curve.pairs] / self._area[curve.pairs]
            slope = curve.law.slope(np.maximum(traction, self._least))
            slopes[curve.pairs] = np.where(traction < self._least, curve.steepest, slope)
        return slopes
