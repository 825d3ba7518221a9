"""Every pair of a joint survey as a wedge in a slope."""

from slopekit.studies.combos.run import Combos, PairCheck, combos

__all__ = ["Combos", "PairCheck", "combos"]
