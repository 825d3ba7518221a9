"""What friction forces of elastic joints may be at most, and how that follows the normal forces of their node pairs.

Lines have r = Σ c + μ Σ N. Of curved laws the elastic path asks the law itself at every displacement,

    r = Σ c + Σ A (τ(N / A) - τ(0)),    dr/dN_i = τ'(N_i / A_i),

so that its rests, limit states and peaks are those of the law, found on one path. Below the least traction, and where
a state that is tried pulls, a law is the line to its strength there: the steepest have no slope at none.
"""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import LEAST_TRACTION
from slopekit.strength.mohr_coulomb import line
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw


class JointStrengths:
    """Of joints with the lines of a model; strengths are not reduced."""

    curved = False

    def __init__(self, model: AssemblyModel, group_of_pair: Ints) -> None:
        self.friction, self._group, self._first = model.tan_friction, group_of_pair, model.group_first

    def summed(self, of_pairs: Floats) -> Floats:
        """Sums over the node pairs of each friction force: (m,) to (g,)."""
        return np.bincount(self._group, of_pairs, len(self._first)).astype(np.float64, copy=False)

    def at(self, normal: Floats, cohesion: Floats) -> Floats:
        """(g,) at normal forces (m,), with the cohesion (g,) that is left."""
        return line(cohesion, self.friction, self.summed(normal))

    def slopes(self, normal: Floats) -> Floats:
        """How strength follows normal forces (m,): of each friction force, (g,); where laws are curved of each pair."""
        return self.friction

    def followed(self, slopes: Floats, pressed: Floats) -> Floats:
        """What changes of the normal forces (m,) are worth, (g,)."""
        return slopes * self.summed(pressed)

    def rows(self, slopes: Floats, pressing: Floats) -> Floats:
        """What motions of the contact are worth that press node pairs by rows (m, u): (g, u)."""
        return slopes[:, None] * np.add.reduceat(pressing, self._first)


class CurvedStrengths(JointStrengths):
    """Of joints some of whose laws are curved; a friction force has one law."""

    curved = True

    def __init__(self, model: AssemblyModel, group_of_pair: Ints) -> None:
        super().__init__(model, group_of_pair)
        assert model.lines is not None
        self._straight = model.tan_friction[group_of_pair]
        self._area = model.control_area * (model.area_scale / model.force_scale)  # a traction of one kPa
        self._least = max(LEAST_KPA, LEAST_TRACTION * len(model.load) / float(self._area[model.joint_pairs].sum()))
        # of each law: the node pairs that have it, its strength at no traction, its slope below the least traction
        self._curves = list[tuple[StrengthLaw, Ints, float, float]]()
        for key, law in enumerate(model.lines.laws):
            pairs = np.flatnonzero(model.lines.joint == key)
            if law is not None and len(pairs):
                none, least = law.resistance(np.array([0.0, self._least]))
                self._curves.append((law, pairs, float(none), float(least - none) / self._least))
                self._straight[pairs] = 0.0

    def at(self, normal: Floats, cohesion: Floats) -> Floats:
        """(g,) at normal forces (m,), with the cohesion τ(0) (g,) that is left."""
        resists = self._straight * normal
        for law, pairs, none, steepest in self._curves:
            area = self._area[pairs]
            traction = normal[pairs] / area
            strength = law.resistance(np.maximum(traction, self._least)) - none
            resists[pairs] = area * np.where(traction < self._least, steepest * traction, strength)
        return cohesion + self.summed(resists)

    def slopes(self, normal: Floats) -> Floats:
        """How strength follows normal forces (m,), (m,)."""
        slopes = self._straight.copy()
        for law, pairs, _, steepest in self._curves:
            traction = normal[pairs] / self._area[pairs]
            slopes[pairs] = np.where(traction < self._least, steepest, law.slope(np.maximum(traction, self._least)))
        return slopes

    def followed(self, slopes: Floats, pressed: Floats) -> Floats:
        """What changes of the normal forces (m,) are worth, (g,)."""
        return self.summed(slopes * pressed)

    def rows(self, slopes: Floats, pressing: Floats) -> Floats:
        """What motions of the contact are worth that press node pairs by rows (m, u): (g, u)."""
        return np.add.reduceat(slopes[:, None] * pressing, self._first)


def strengths_of(model: AssemblyModel, group_of_pair: Ints) -> JointStrengths:
    """Of the laws of a model where the path follows them, else of its lines."""
    curved = model.lines is not None and model.lines.followed
    return (CurvedStrengths if curved else JointStrengths)(model, group_of_pair)
