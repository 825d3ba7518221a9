"""The value of one number of a design that gives a factor of safety."""

from slopekit.studies.solve.run import solve
from slopekit.studies.solve.solutions import Solution

__all__ = ["Solution", "solve"]
