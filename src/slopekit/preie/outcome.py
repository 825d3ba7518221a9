"""The outcome of a limit analysis, and the limit of one block."""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import OPENS


class Outcome(Enum):
    """Outcome of a limit analysis; all are answers but the last, where the search did not settle."""

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
    outcome : of the analysis
    factor : F, None unless something slides or turns
    velocity : (u,) the mechanism, of unit length; normal_force : (n,); bond : (n,) cohesion left, 0 or 1
    steps : factorisations of its path; change : width of the bracket that it lies in, in parts of it (0: a limit state)
    friction : (n, 2) tangential forces and pulls : (b,) those of the bolts, at the reduced strength; None without a
        factor
    """

    outcome: Outcome
    factor: float | None
    velocity: Floats
    normal_force: Floats
    bond: Floats
    steps: int
    change: float
    friction: Floats | None = None
    pulls: Floats | None = None

    def settled_to(self, relative: float) -> bool:
        """Return whether the factor is known to a relative accuracy."""
        return self.outcome is not Outcome.NOT_CONVERGED and self.change <= relative


def opens(model: Model, velocity: Floats, tan_dilation: Floats) -> Bools:
    """Return which node pairs (n,) a motion (u,) opens by more than their dilation."""
    motion = model.relative(velocity)
    opening, slip = motion[:, 0], np.sqrt((motion[:, 1:] * motion[:, 1:]).sum(axis=1))
    is_open: Bools = opening - tan_dilation * slip > OPENS * max(
        float(slip.max()), float(opening.max())
    )
    return is_open


def unit(vector: Floats) -> Floats:
    return vector / math.sqrt(float(vector @ vector))
