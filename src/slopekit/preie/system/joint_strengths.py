"""Shear strengths of the friction forces of elastic joints, and their slopes by the normal forces of the node pairs.

A straight line has r = Σ c + μ Σ N. A curved law is evaluated at every displacement of the elastic path,

    r = Σ c + Σ A (τ(N / A) - τ(0)),    dr/dN_i = τ'(N_i / A_i),

so that its equilibria and limit states are those of the law, found on one path. Below the least traction, and in
tension, a law is the secant to its strength there: the steepest laws have no finite slope at zero traction.
"""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import LEAST_TRACTION
from slopekit.strength.mohr_coulomb import line
from slopekit.strength.protocol import LEAST_KPA, StrengthLaw


class JointStrengths:
    """Strengths of joints with straight lines: cohesion and tan φ of a model, not reduced."""

    curved = False

    def __init__(self, model: AssemblyModel, group_of_pair: Ints) -> None:
        self.friction, self._group, self._first = (
            model.tan_friction,
            group_of_pair,
            model.group_first,
        )

    def summed(self, pair_values: Floats) -> Floats:
        """Return the sums (g,) of values (m,) over the node pairs of each friction force."""
        return np.bincount(self._group, pair_values, len(self._first)).astype(
            np.float64, copy=False
        )

    def strength(self, normal: Floats, cohesion: Floats) -> Floats:
        """Return the strengths (g,) at normal forces (m,), with the cohesion (g,) that still acts."""
        return line(cohesion, self.friction, self.summed(normal))

    def slopes(self, normal: Floats) -> Floats:
        """Return the slopes of strength by normal force at normal forces (m,): (g,); with curved laws (m,)."""
        return self.friction

    def strength_change(self, slopes: Floats, pressed: Floats) -> Floats:
        """Return the change of strength (g,) for changes of the normal forces (m,)."""
        return slopes * self.summed(pressed)

    def rows(self, slopes: Floats, pressing: Floats) -> Floats:
        """Return the change of strength (g, u) per motion of the contact that presses node pairs by rows (m, u)."""
        return slopes[:, None] * np.add.reduceat(pressing, self._first)


class CurvedStrengths(JointStrengths):
    """Strengths of joints with curved laws; the pairs of one friction force have one law."""

    curved = True

    def __init__(self, model: AssemblyModel, group_of_pair: Ints) -> None:
        super().__init__(model, group_of_pair)
        assert model.lines is not None
        self._straight = model.tan_friction[group_of_pair]
        self._area = model.control_area * (
            model.area_scale / model.force_scale
        )  # normal force at 1 kPa
        self._least = max(
            LEAST_KPA, LEAST_TRACTION * len(model.load) / float(self._area[model.joint_pairs].sum())
        )
        # for each law: its node pairs, its strength at zero traction, its slope below the least traction
        self._curves = list[tuple[StrengthLaw, Ints, float, float]]()
        for key, law in enumerate(model.lines.laws):
            pairs = np.flatnonzero(model.lines.joint == key)
            if law is not None and len(pairs):
                none, least = law.resistance(np.array([0.0, self._least]))
                self._curves.append((law, pairs, float(none), float(least - none) / self._least))
                self._straight[pairs] = 0.0

    def strength(self, normal: Floats, cohesion: Floats) -> Floats:
        """Return the strengths (g,) at normal forces (m,), with the cohesion τ(0) (g,) that still acts."""
        resists = self._straight * normal
        for law, pairs, none, steepest in self._curves:
            area = self._area[pairs]
            traction = normal[pairs] / area
            strength = law.resistance(np.maximum(traction, self._least)) - none
            resists[pairs] = area * np.where(traction < self._least, steepest * traction, strength)
        return cohesion + self.summed(resists)

    def slopes(self, normal: Floats) -> Floats:
        """Return the slopes (m,) of strength by normal force at normal forces (m,)."""
        slopes = self._straight.copy()
        for law, pairs, _, steepest in self._curves:
            traction = normal[pairs] / self._area[pairs]
            slopes[pairs] = np.where(
                traction < self._least, steepest, law.slope(np.maximum(traction, self._least))
            )
        return slopes

    def strength_change(self, slopes: Floats, pressed: Floats) -> Floats:
        """Return the change of strength (g,) for changes of the normal forces (m,)."""
        return self.summed(slopes * pressed)

    def rows(self, slopes: Floats, pressing: Floats) -> Floats:
        """Return the change of strength (g, u) per motion of the contact that presses node pairs by rows (m, u)."""
        return np.add.reduceat(slopes[:, None] * pressing, self._first)


def strengths_of(model: AssemblyModel, group_of_pair: Ints) -> JointStrengths:
    """Return the strengths of a model: those of its curved laws where the path follows them, else of its lines."""
    curved = model.lines is not None and model.lines.follows_laws
    return (CurvedStrengths if curved else JointStrengths)(model, group_of_pair)
