"""The springs that one step of the interior-point method sees in every contact.

Normal springs p, and those of friction, which couple to them where strength follows the normal forces. Friction is
eliminated first. With Nesterov & Todd's W⁻² = η⁻² (2 w wᵀ - J), w = (w0, -w1), and the elastic give e, what remains
of its first row has a closed form free of cancellation. That decides how far the method gets: along a sliding pair
W⁻² is nearly singular.

    κ0 = η⁻² (1 + e η² (2 w0² - 1)) / (2 w0² - 1 + e η²),    b = -2 w0 w1 / (2 w0² - 1 + e η²)
"""

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.records import dataclass
from slopekit.preie.programs.cones import Scaling, along_rows
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.patterns import ContactPattern
from slopekit.preie.tolerances import TINY


@dataclass(frozen=True, slots=True)
class Coupling:
    """How strength, normal force and opening hang together at an iterate, all (g,).

    Attributes
    ----------
    strength : what a load factor of 1 lets friction carry
    primal : how much more it carries per normal force; dual : how much slip opens the contact
    work, opening_work : what the load factor does to `primal` and `dual`, times the slip
    """

    strength: Floats
    primal: Floats
    dual: Floats
    work: Floats
    opening_work: Floats


@dataclass(frozen=True, slots=True)
class Springs:
    """The springs at one iterate.

    Attributes
    ----------
    p : (m,); sigma : (g,) sums of p; over : (g,) 1 / (1 + κ σ) with κ = primal dual κ0
    kappa0 : (g,); tilt : (g, t) b; inverse : (g, t, t) what remains of friction alone
    bare, bare_tilt : κ0 and b without the elastic give
    of_factor : normal (m,) and friction (g, t) forces per unit of the load factor; row : their transpose
    corner : stiffness of the load factor itself
    """

    model: AssemblyModel
    of_pair: Ints
    coupling: Coupling
    give: Floats
    p: Floats
    sigma: Floats
    over: Floats
    kappa0: Floats
    tilt: Floats
    inverse: Floats
    bare: Floats
    bare_tilt: Floats
    of_factor: tuple[Floats, Floats]
    row: tuple[Floats, Floats]
    corner: float

    @classmethod
    def of(
        cls, model: AssemblyModel, of_pair: Ints, normal_springs: Floats, give: Floats, scale: Scaling, at: Coupling
    ) -> "Springs":
        """The springs of an iterate.

        Parameters
        ----------
        of_pair : (m,) the friction force that each node pair shares in
        normal_springs : (m,) p; give : (g,) e
        """
        sigma = model.by_group(normal_springs)
        w0, w1 = scale.direction[:, 0], scale.direction[:, 1:]
        eta2 = scale.size * scale.size
        bent = 2.0 * w0 * w0 - 1.0
        soft = give * eta2
        kappa0 = (1.0 + soft * bent) / (eta2 * (bent + soft))
        tilt = -2.0 * (w0 / (bent + soft))[:, None] * w1
        unit = w1 / np.maximum(np.sqrt(along_rows(w1, w1)), TINY)[:, None]
        across, along = eta2 / (1.0 + soft), eta2 / (bent + soft)
        inverse = (along - across)[:, None, None] * unit[:, :, None] * unit[:, None, :]
        k = np.arange(w1.shape[1])
        inverse[:, k, k] += across[:, None]
        over = 1.0 / (1.0 + at.primal * at.dual * kappa0 * sigma)
        pull = (at.dual * kappa0 * at.strength - at.opening_work) * over
        pulled = (at.primal * kappa0 * at.strength - at.work) * over
        mixed = (at.dual * at.work + at.primal * at.opening_work) * kappa0 * at.strength - at.work * at.opening_work
        return cls(
            model, of_pair, at, give, normal_springs, sigma, over, kappa0, tilt, inverse,
            bare=1.0 / (eta2 * bent), bare_tilt=-2.0 * (w0 / bent)[:, None] * w1,
            of_factor=(normal_springs * pull[of_pair], tilt * (at.strength - at.primal * sigma * pull)[:, None]),
            row=(normal_springs * pulled[of_pair], tilt * (at.strength - at.dual * sigma * pulled)[:, None]),
            corner=float(((at.strength * kappa0 * at.strength + mixed * sigma) * over).sum()),
        )  # fmt: skip

    def _normal(self, source: Floats) -> tuple[Floats, Floats]:
        """Normal forces (m,) of sources (m,) that friction is eliminated from, and their sums (g,)."""
        px = self.p * source
        total = self.model.by_group(px) * self.over
        share = self.coupling.primal * self.coupling.dual * self.kappa0 * total
        return px - self.p * share[self.of_pair], total

    def times(self, opens: Floats, slips: Floats) -> tuple[Floats, Floats]:
        """Forces of openings (m,) and slips (g, t)."""
        along = self.coupling.dual * along_rows(self.tilt, slips)
        normal, total = self._normal(opens - along[self.of_pair])
        friction = np.matmul(self.inverse, slips[:, :, None])[:, :, 0]
        return normal, friction - self.tilt * (self.coupling.primal * total)[:, None]

    def sources(self, of_normal: Floats, x: Floats, off_slip: Floats) -> tuple[Floats, Floats, float]:
        """Forces of what is off: at the normals (m,), at the friction cones (x, scaled back), at the slips (g, t).

        The third value is what they do to the load factor's own equation.
        """
        at = self.coupling
        less = self.give * along_rows(self.tilt, x[:, 1:]) + along_rows(self.tilt, off_slip)
        of_cone = self.kappa0 * x[:, 0] + less
        normal, total = self._normal(of_normal + (at.dual * of_cone)[self.of_pair])
        soft = self.give[:, None] * x[:, 1:] + off_slip
        friction = self.tilt * (x[:, 0] - at.primal * total)[:, None] + x[:, 1:]
        friction = friction - np.matmul(self.inverse, soft[:, :, None])[:, :, 0]
        pull = at.primal * self.kappa0 * at.strength - at.work
        return normal, friction, float((at.strength * of_cone - pull * total).sum())

    def slip_allowed(self, left: Floats, slips: Floats) -> Floats:
        """First component (g,) of a cone's multiplier, of what is left at the cone (g,) and its slip (g, t)."""
        allowed: Floats = self.bare * left + along_rows(self.bare_tilt, slips)
        return allowed

    def stiffness(self, pattern: ContactPattern) -> Floats:
        """Stiffness (k, u, u) against the motion of each contact."""
        at = self.coupling
        out = pattern.stiffness(self.p, self.inverse)
        if at.primal.any():
            product = at.primal * at.dual * self.over
            weights = product * self.kappa0, at.dual * self.over, at.primal * self.over, product * self.sigma
            pattern.couple(out, self.p, self.tilt, weights)
        return out
