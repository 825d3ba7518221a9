"""A design at many values of one or two of its numbers."""

from slopekit.studies.sweep.run import Sweep, sweep

__all__ = ["Sweep", "sweep"]
