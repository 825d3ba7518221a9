"""Every pair of a joint survey as a wedge in a slope."""

from slopekit.studies.combos.run import Combos, PairCheck, Target, combos

__all__ = ["Combos", "PairCheck", "Target", "combos"]
