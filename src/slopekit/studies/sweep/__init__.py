"""A design at many values of one or two of its numbers."""

from slopekit.studies.sweep.run import Critical, Methods, Sweep, sweep

__all__ = ["Critical", "Methods", "Sweep", "sweep"]
