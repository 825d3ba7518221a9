"""A design at many values of one or two of its numbers."""

from slopekit.studies.points import Methods
from slopekit.studies.sweep.run import Critical, Sweep, sweep

__all__ = ["Critical", "Methods", "Sweep", "sweep"]
