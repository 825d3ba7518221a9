"""How the limit analysis of one block ends: the factor with its evidence, or why there is none."""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.preie.system.model import Model


class Outcome(Enum):
    """How a limit analysis ended; every one of them is an answer but the last."""

    SLIDES = "the blocks slide, or slide and turn, when the strength is divided by the factor"
    NO_STRENGTH = "the blocks move with nothing to hold them: no strength is called on"
    LIFTED = "the loads pull the blocks off every joint"
    NO_REST = "the blocks come to rest at no strength: they topple whatever the friction"
    NO_DRIVING_FORCE = "nothing drives the blocks: they stand without strength"
    NOT_CONVERGED = "the search did not settle"


@dataclass(frozen=True)
class Limit:
    """A limit factor with its evidence.

    Attributes
    ----------
    outcome : how it ended
    factor : F, None unless something slides or turns
    velocity : (u,) the mechanism, of unit length; normal_force : (n,); bond : (n,) cohesion left, 0 or 1
    passes : work done; change : relative change of the factor in the last pass (0: solved exactly)
    friction : (n, 2) tangential forces and pulls : (b,) those of the bolts, at the reduced strength; None without a
        factor
    """

    outcome: Outcome
    factor: float | None
    velocity: Floats
    normal_force: Floats
    bond: Floats
    passes: int
    change: float
    friction: Floats | None = None
    pulls: Floats | None = None

    def settled_to(self, relative: float) -> bool:
        """Whether the factor is one number to that part: not a range that the passes swung through, nor none."""
        return self.outcome is not Outcome.NOT_CONVERGED and self.change <= relative

    def velocity_of(self, model: Model) -> Floats:
        """The mechanism in the unknowns of `model`: a limit of forces alone does not turn."""
        return np.concatenate([self.velocity, np.zeros(model.unknowns - len(self.velocity))])


def unit(vector: Floats) -> Floats:
    unit: Floats = vector / math.sqrt(float(vector @ vector))
    return unit
